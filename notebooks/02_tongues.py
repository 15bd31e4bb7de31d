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
# # Tongues
#
# Close to a resonance $\Omega = p\pi/q$ the rope starts to radiate waves at a small forcing
# amplitude: the stability boundary dips, and the dips are the paper's Arnold tongues. Here we
# derive their laws for any $p/q$ and any order, see why the exponents march towards $2/q$ as the
# order grows, and what bending makes of them.

# %% [markdown]
# ## One engine, another ring
#
# The order loop of notebook 1 never divides. Give it truncated Laurent series in
# $\mu = \Omega - p\pi/q$ as numbers, and the *unchanged* loop returns the singular part of the
# expansion, exactly. At $\Omega = p\pi + \mu$ and third order this is the paper's eq. (expandw2):

# %%
from asymptotics.resonances.tongues import singular_part, tongue

part = singular_part(1, 1, 3)
print(f"x_c/x0 ~ 1 + epsilon^{part.order} mu^-{part.pole} *", part.text())

# %% [markdown]
# The profile with these harmonics touches the ground on $\epsilon = C|\mu|^{5/3}$. Only this last
# step, a minimum over place and time, is numerical. The paper prints $0.309/p^2$ and
# $s = -1.13/(p\pi)$ near $\Omega = p\pi$, and $1.815\,\mu^{3/4}$ near $\pi/2$:

# %%
import math

for p, q, order in [(1, 1, 3), (2, 1, 3), (1, 2, 2), (1, 2, 4)]:
    result = tongue(p, q, order)
    side = result.sides["+"]
    print(
        f"p/q = {p}/{q}, order {order}: epsilon = {side.coefficient:.5f} |mu|^({result.exponent})"
        f",  s Omega = {side.s * p * math.pi / q:.4f},  bump {side.height:.5f}"
    )

# %% [markdown]
# ## Why the exponents march to 2/q
#
# At order $N = qn$ the leading pole is $\epsilon^{qn}/\mu^{2n-1}$, so the exponent is
# $(2n-1)/(qn)$: 1, 3/2, 5/3, 7/4 … for $q = 1$. None of them is *the* exponent. All these leading
# terms are one function of $\epsilon^q/\mu^2$, expanded: close to the resonance the contact point
# moves like a pendulum, $\tfrac12 P^2 - V\cos q\psi$ with $V = v_q\epsilon^q$, that rotates with a
# mean speed set by $\mu$. Such a motion exists up to the separatrix,
#
# $$\epsilon = \left(\frac{\pi^2\mu^2}{4 v_q}\right)^{1/q},$$
#
# which has the exponent $2/q$. For the plain resonances it reads $\epsilon = \mu^2/(8p^2)$.

# %%
import matplotlib.pyplot as plt
import numpy as np

mu = np.geomspace(3e-3, 0.6, 200)
colours = plt.colormaps["cividis"](np.linspace(0, 0.85, 5))
figure, axes = plt.subplots(figsize=(5.6, 3.6), layout="constrained")
for n, colour in zip(range(1, 6), colours, strict=True):
    result = tongue(1, 1, n)
    side = result.sides["-"]
    axes.loglog(
        mu, side.coefficient * mu ** float(result.exponent), color=colour,
        label=f"order {n}: {result.exponent}",
    )  # fmt: skip
limit = result.limit
axes.loglog(mu, limit.coefficient * mu ** float(limit.exponent), "k--", label="pendulum: 2")
axes.set(xlabel=r"$|\mu| = |\Omega - \pi|$", ylabel=r"$\epsilon$ where the form touches ground")
axes.legend(title="exponent", frameon=False)
# %% [markdown]
# The dashed line is a statement about the true rope without bending, not about a truncated series.
# The exact periodic state is an invariant circle; the largest $\epsilon$ with a circle near
# $\Omega = \pi$ is found by bisection, without any of the algebra above. (A circle may exist again
# beyond a gap, and one that exists may not be found; what is bisected here is the first failure.)

# %%
from numerics.errors import CircleNotFoundError
from numerics.exact_string.invariant_circle import invariant_circle


def last_circle(omega, low, high, steps=9):
    """Bisect for the largest ε in [low, high] at which the invariant circle is found."""
    for _ in range(steps):
        middle = math.sqrt(low * high)
        try:
            invariant_circle(omega, middle)
            low = middle
        except CircleNotFoundError:
            high = middle
    return low


for distance in (-0.35, -0.25, -0.15):
    law = distance**2 / 8
    found = last_circle(math.pi + distance, law / 3, 4 * law)
    print(f"mu = {distance}: circles up to epsilon = {found:.5f}, the law says {law:.5f}")

# %% [markdown]
# ## What bending makes of them
#
# With bending stiffness $\beta = B/(Tx_0^2) > 0$ the resonances move to the spectrum of a beam, and
# the wave-less state ends differently: next to the *true* resonance $\Omega_p(\beta)/q$ two small
# solutions of the amplitude equation $(q\mu - \gamma\epsilon^2)a = F\epsilon^q + \alpha a^3$
# meet in a fold. Its exponent is $3/(2q)$, on one side only. The law is a first term; how far it
# holds tells the reduced equation of higher order.

# %%
from asymptotics.resonances.folds import fold

for beta in (1e-1, 1e-2, 1e-3, 1e-4):
    result = fold(1, 1, beta)
    print(
        f"beta = {beta:g}: Omega_1 = {result.resonance:.6f}, alpha = {result.alpha.value:.5g}, "
        f"epsilon_fold = {result.coefficient.value:.5f} |mu|^({result.exponent}), {result.side}, "
        f"to 10 % for |mu| <= {result.range.mu:.2g}"
    )

# %% [markdown]
# As $\beta \to 0$ the coefficient $\alpha$ diverges and the range in which the fold's law holds
# shrinks to nothing. The laws of the string, $\beta = 0$, are laws of another rope: they do not
# take over at its end, and the truncated one has no range for the string either.

# %%
result = fold(1, 1, 0.01)
mu = np.geomspace(1e-3, 0.3, 200)
near = np.geomspace(1e-3, result.range.mu, 200)
figure, axes = plt.subplots(figsize=(5.6, 3.6), layout="constrained")
axes.loglog(near, result.epsilon(-near), color="#0072B2", label=r"fold, $|\mu|^{3/2}$, its range")
axes.loglog(mu, mu**2 / 8, "k--", label=r"string, $\mu^2/8$")
axes.loglog(
    mu, tongue(1, 1, 3).sides["-"].coefficient * mu ** (5 / 3), color="#D55E00", ls="-.",
    label=r"truncated at order 3, $|\mu|^{5/3}$",
)  # fmt: skip
axes.set(xlabel=r"distance from the resonance $|\mu|$", ylabel=r"$\epsilon$")
axes.legend(frameon=False, title=r"$\beta = 0.01$, $p/q = 1/1$")

# %% [markdown]
# Not every fold ends something. At $\beta = 0.01$ above $\Omega_1/3$ the shift $\gamma\epsilon^2$
# outweighs the cubic term: raised from rest the state passes through, and a pair of other states is
# born beside it. It is by sweeping the frequency that such a fold is met.

# %%
for p, q in ((1, 2), (1, 3), (2, 3), (1, 4)):
    result = fold(p, q, 0.01)
    print(f"{p}/{q}: {result.kind.value}, {result.mu_side} Omega_{p}/{q}")
