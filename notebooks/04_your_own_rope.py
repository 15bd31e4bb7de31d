# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Your own rope
#
# The paper's rope obeys the wave equation. Yours may lie on springs, travel through a guide, resist
# bending, lose energy, or climb a slope. Write its equation down; the same loop expands it, each
# order is substituted back, and a periodic state that knows nothing of the expansion is its judge.

# %%
import matplotlib.pyplot as plt
import numpy as np
import sympy as sp

import ropewave as rw
from derivations.cross_check.validation import validate_rope
from ropewave import Omega, W, epsilon, tau, xi

kappa, beta, v, gamma, zeta = sp.symbols("kappa beta v gamma zeta")
shaken = epsilon * sp.cos(Omega * tau)

# %% [markdown]
# ## Five ropes
#
# **An elastic foundation** under the lifted part as well,
# $W_{\tau\tau} = W_{\xi\xi} - 2 - \kappa W$:

# %%
foundation = rw.moving_contact(
    equation=sp.Eq(W.diff(tau, 2), W.diff(xi, 2) - 2 - kappa * W),
    driven_end=[sp.Eq(W, 1 + shaken)],
    contact=[W, W.diff(xi)],
)

# %% [markdown]
# **A guided end**: the height of the driven end is free, its slope is held, and the force on it is
# shaken; bending, so three contact conditions and two at the driven end.

# %%
bent = W.diff(xi, 2) - 2 - beta * W.diff(xi, 4)
smooth = [W, W.diff(xi), W.diff(xi, 2)]
guided = rw.moving_contact(
    equation=sp.Eq(W.diff(tau, 2), bent),
    driven_end=[sp.Eq(W.diff(xi), 0), sp.Eq(W.diff(xi, 3), 20 * (1 + shaken))],
    contact=smooth,
)

# %% [markdown]
# **A travelling cable**, paid out at the speed $v$ (of waves: 1). The mixed derivative makes
# forth and back unequal, and the coefficients complex.

# %%
travelling = rw.moving_contact(
    equation=sp.Eq(W.diff(tau, 2) + 2 * v * W.diff(xi, tau) - (1 - v**2) * W.diff(xi, 2), -2),
    driven_end=[sp.Eq(W, 1 + shaken)],
    contact=[W, W.diff(xi)],
)

# %% [markdown]
# **A clamped beam on a slope** $g = \gamma\xi$, and **a damped clamped one, two frequencies**,
# which needs no equation, since `beam` writes it down:

# %%
slope = rw.moving_contact(
    equation=sp.Eq(W.diff(tau, 2), bent),
    driven_end=[sp.Eq(W, 1 + shaken), sp.Eq(W.diff(xi), 0)],
    contact=smooth,
    ground=gamma * xi,
)
damped = rw.beam(driven_end="clamped", damping=zeta, drive={1: (1, 0), 2: (0.3, 0.5)})

ropes = {
    "foundation": (foundation, {kappa: 1.7, Omega: 2.2}),
    "guided end": (guided, {beta: 0.05, Omega: 2.2}),
    "travelling": (travelling, {v: 0.3, Omega: 2.2}),
    "on a slope": (slope, {beta: 0.05, gamma: 0.3, Omega: 2.2}),
    "damped, two frequencies": (damped, {"beta": 0.05, "zeta": 0.1, "Omega": 1.3}),
}

# %% [markdown]
# ## Derived and proved
#
# Numbers in, doubles out, rounded from balls that are as tight as it takes. `prove` substitutes
# every order into the equation, the driven end and the moving contact.

# %%
for name, (rope, at) in ropes.items():
    series = rw.expand(rope, 3, at=at)
    rest = complex(series.problem.rest).real
    first = complex(2 * series.contact(1)[1])
    print(f"{name:24s} rests at {rest:.6f}, moves by {abs(first):.6f} epsilon")
    print("   ", rw.prove(series)[3])

# %% [markdown]
# ## As formulas
#
# The contact point of every rope with $m$ contact conditions is the same polynomial in impedances
# $Y$ and sources $S$; what tells ropes apart are their values. So the rope on a foundation and the
# travelling one share this line, and both beams the next.

# %%
rw.derive(2, ropes["foundation"][0])

# %%
derived = rw.derive(3, ropes["guided end"][0])
module = {}
exec(derived.numpy(), module)  # it needs NumPy only, and computes its own impedances
betas = np.linspace(0.02, 0.2, 5)
print(np.round(module["contact"](0.0, 2.2, 0.02, beta=betas), 6))
print(derived.javascript().splitlines()[0])

# %% [markdown]
# ## Judged
#
# The periodic state is a sum of solutions of each harmonic, their weights and the contact point
# unknown; nothing in it is expanded in $\epsilon$. The error of order $N$ has to fall like
# $\epsilon^{N+1}$. (Order 1 only with bending, to be quick.)

# %%
for name, (rope, at) in ropes.items():
    found = validate_rope(rope, at, 2 if rope.order == 2 else 1, quick=True)
    verdicts = [
        f"{judged.order}: {judged.verdict}"
        + ("" if judged.slope is None else f" ({judged.slope:.2f} ± {judged.uncertainty:.2f})")
        for judged in found.orders
    ]
    print(f"{name:24s}", ", ".join(verdicts))

# %% [markdown]
# ## Drawn
#
# Half a period of each, at an amplitude where the series still falls off.

# %%
figure, panels = plt.subplots(1, 5, figsize=(13, 2.8), layout="constrained", sharey=True)
for axes, (name, (rope, at)) in zip(panels, ropes.items(), strict=True):
    omega = float(rope.values(at)["Omega"])
    times = np.pi / omega * np.linspace(0, 1, 5)
    contact = rw.evaluate_rope(rope, at, 0.03, 3, [], times).contact
    s = contact[:, None] * np.linspace(-1, 0, 201)
    state = rw.evaluate_rope(rope, at, 0.03, 3, s, times)
    for i, colour in enumerate(plt.get_cmap("cividis")(np.linspace(0, 0.9, 5))):
        axes.plot(state.contact[i] + state.s[i], state.profile[i], color=colour, lw=1.2)
        axes.plot(state.contact[i], state.profile[i, -1], "o", color=colour, ms=3)
    place = np.array([0.0, 1.1 * state.contact.max()])
    ground = 0.3 * place if name == "on a slope" else 0 * place
    axes.plot(place, ground, color="0.6", lw=0.7, zorder=0)
    axes.set(title=name, xlabel=r"$x/x_0$")
    axes.title.set_fontsize(9)
panels[0].set_ylabel(r"$w/Z_0$")
plt.show()

# %% [markdown]
# ## A ground that gives way
#
# On springs $\kappa$ the rope moves beyond the contact point, too: below $\Omega = \sqrt\kappa$ it
# sinks and rises with it, above waves run away, and the contact point lags behind the drive.

# %%
figure, axes = plt.subplots(figsize=(5, 2.8), layout="constrained")
kappas = np.geomspace(1, 1e4, 60)
responses = []
for value in kappas:
    series = rw.expand(rw.string(springs=sp.Symbol("kappa")), 1, at={"kappa": value, "Omega": 2.2})
    responses.append(2 * complex(series.contact(1)[1]))
axes.semilogx(kappas, np.abs(responses), color="black", label=r"$|\xi_1|$")
axes.semilogx(kappas, -np.angle(responses), color="C0", label="lag (rad)")
axes.axhline(1.1 / np.sin(2.2), color="0.6", lw=0.8, label="rigid ground")
axes.axvline(2.2**2, color="0.8", lw=0.8)
axes.set(xlabel=r"$\kappa$", ylabel=r"response at $\Omega=2.2$")
axes.legend(fontsize=8)
plt.show()
