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
# # Derive to your own order
#
# A long rope lies on the ground. One end is held at the height $Z_0$ and shaken vertically,
# $w/Z_0 = 1 + \epsilon\cos\Omega\tau$. The lifted part obeys the wave equation, and where it meets
# the ground, $x_c(t)$, is unknown. The expansion in $\epsilon$ of the shape and of the contact
# point is a long calculation by hand; here it is one line.

# %%
from asymptotics import ClosedForms, exact_string, expand, moving_frame, prove

solution = expand(exact_string(), order=5)

# %% [markdown]
# ## Each order proves itself
#
# The result is substituted back into the wave equation, the driven end and both contact conditions
# at the *moving* contact point. Everything is exact, so zero means zero for every $\Omega$.

# %%
frame = moving_frame(solution)
print(*prove(solution, frame), sep="\n")

# %% [markdown]
# ## Look at it
#
# `ClosedForms` is the SymPy face. The contact point's first harmonic is the paper's
# eq. (linresponse1); $F_2$ is the one of eq. (expandw).

# %%
forms = ClosedForms(solution, frame)
forms.contact(1).expression

# %%
forms.profile(2).expression

# %% [markdown]
# Each coefficient is written in one way only, as a partial fraction in $\cot q\Omega$: the
# resonances $\Omega = p\pi/q$ can be read off. Prefer the paper's sines and cosines? They are a
# style, not another calculation, and both are equal by an exact zero test:

# %%
from asymptotics.formulas.zero_test import are_equal

circular = ClosedForms(solution, frame, style="circular")
assert are_equal(forms.contact(3).expression, circular.contact(3).expression)
circular.contact_harmonic(3, 3)

# %% [markdown]
# The paper's printed formulas, proved equal to what was derived:

# %%
from asymptotics.paper.check import compare

for comparison in compare(forms):
    print(comparison)

# %% [markdown]
# ## Paste it in a paper
#
# The LaTeX is broken to the column it is for: `two` for a two-column REVTeX page, `one` for a full
# page. `formula_sets` gives the files of a whole supplement.

# %%
from asymptotics.printing.latex import profile_equation

print(profile_equation(forms, 2, column="two"))

# %% [markdown]
# ## Use it
#
# The NumPy module needs NumPy only. Write it to a file, or use it on the spot.

# %%
import types

import numpy as np

from asymptotics.printing.numpy_code import numpy_module

source = numpy_module(forms)
rope = types.ModuleType("rope")
exec(source, rope.__dict__)
print(source[: source.index('"""', 3) + 3])

# %% [markdown]
# All arguments broadcast. Times down, positions across:

# %%
omega, epsilon = 1.9416, 0.1
tau = np.linspace(0, np.pi / omega, 5)[:, None]
s = np.linspace(-1.2, 0, 200)
w = rope.profile(s, tau, omega, epsilon)
x_c = rope.contact(tau, omega, epsilon)
w.shape, x_c.ravel().round(4)

# %%
import matplotlib.pyplot as plt

figure, axes = plt.subplots(figsize=(6, 2.8), layout="constrained")
for time, place, row in zip(tau[:, 0], x_c[:, 0], w, strict=True):
    lifted = place + s >= 0
    axes.plot((place + s)[lifted], row[lifted], label=f"{omega * time / (2 * np.pi):.3f}")
axes.set(xlabel=r"position $x/x_0$", ylabel=r"height $w/Z_0$")
axes.legend(title=r"time $\omega t/2\pi$", frameon=False)
# %% [markdown]
# How far can these numbers be trusted? Rounding is bounded by `profile_error`; truncation is not
# small print either. The exact periodic state of the string is an invariant circle of the standard
# map, computed by `numerics` without any of the algebra above. The error of the order-$N$ series
# falls like $\epsilon^{N+1}$:

# %%
from numerics.exact_string.invariant_circle import invariant_circle

print(
    "largest rounding error of w/Z0 here:", float(rope.profile_error(s, tau, omega, epsilon).max())
)
for amplitude in (0.02, 0.01, 0.005):
    circle = invariant_circle(omega, amplitude)
    error = np.abs(rope.contact(tau[:, 0], omega, amplitude) - circle.contact(tau[:, 0])).max()
    print(f"epsilon = {amplitude}: order-5 series against the exact circle {error:.1e}")

# %% [markdown]
# ## Go on
#
# Nothing computed is computed again: order 7 continues order 5.

# %%
longer = expand(exact_string(), order=7, start=solution)
longer.orders[:5] == solution.orders, [p.holds for p in prove(longer)]
