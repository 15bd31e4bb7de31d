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
# # The rope is the standard map
#
# Without bending a wave that leaves the shaken end comes back after it has met the contact point.
# The times $t_k$ of its returns obey $t_{k+1} - 2t_k + t_{k-1} = 2Z'(t_k)$, and for
# $Z = 1 + \varepsilon\cos\Omega\tau$ that is Chirikov's standard map in $\varphi = \Omega t$,
#
# $$\varphi_{k+1} - 2\varphi_k + \varphi_{k-1} = -K\sin\varphi_k, \qquad K = 2\varepsilon\Omega^2.$$
#
# A periodic state of the rope is an invariant circle of the map. When the circle breaks, the state
# is gone.

# %%
import math

import matplotlib.pyplot as plt
import numpy as np

from numerics.exact_string.break_up import break_up
from numerics.exact_string.greene import periodic_orbit
from numerics.exact_string.invariant_circle import circle_at_rotation, invariant_circle
from numerics.exact_string.rotation import Noble, noble

golden = (math.sqrt(5) - 1) / 2

# %% [markdown]
# ## Orbits and a circle
#
# Jumps $\varphi_{k+1} - \varphi_k$, that is $2\Omega\xi_c$, against $\varphi$: the golden circle at
# $K = 0.95$ among orbits that are on none.

# %%
K = 0.95
phi = np.linspace(0, 2 * math.pi, 25, endpoint=False)
jump = np.full_like(phi, 2 * math.pi * golden) + np.linspace(-1.2, 1.2, 25)
places, jumps = [], []
for _ in range(400):
    phi = phi + jump
    places.append(phi % (2 * math.pi))
    jumps.append(jump.copy())
    jump = jump - K * np.sin(phi)

circle = circle_at_rotation(golden, K)
psi = np.linspace(0, 2 * math.pi, 801)
k = np.arange(1, len(circle.sines) + 1)


def angle(x):
    """φ = ψ + U(ψ) on the circle."""
    return x + np.sin(np.outer(x, k)) @ circle.sines


turn = circle.rotation_number
plt.figure(figsize=(6, 4))
plt.plot(np.ravel(places), np.ravel(jumps), ",", color="0.4")
plt.plot(angle(psi) % (2 * math.pi), angle(psi) - angle(psi - turn), ".", ms=1.5, color="#D55E00")
plt.xlabel(r"$\varphi$")
plt.ylabel(r"jump to $\varphi$")
plt.title(f"K = {K}; the golden circle at Ω = {circle.omega:.5f}, ε = {circle.epsilon:.5f}")
plt.show()

# %% [markdown]
# The same state is found at fixed $\Omega$ and $\varepsilon$, and the map itself keeps to it.

# %%
again = invariant_circle(circle.omega, circle.epsilon)
print("rotation number:", again.rotation_number / (2 * math.pi), "against", golden)
assert abs(again.rotation_number / (2 * math.pi) - golden) < 1e-12
x, y = angle(np.array([0.3 - turn, 0.3]))
for _ in range(200):
    x, y = y, 2 * y - x - K * math.sin(y)
off = abs(y - angle(np.array([0.3 + 200 * turn]))[0])
print("off the circle after 200 returns:", off)
assert off < 1e-9

# %% [markdown]
# ## Greene's residue
#
# The orbits of the convergents 1/2, 2/3, 3/5, 5/8, … approach the circle. While it lasts their
# residues fall to 0, beyond they grow; at the break-up they settle at 0.25.

# %%
pairs = [(13, 21), (34, 55), (89, 144), (233, 377), (610, 987)]
strengths = np.linspace(0.95, 0.99, 33)
plt.figure(figsize=(6, 3.5))
for p, q in pairs:
    residues = [periodic_orbit(p, q, float(value)).residue for value in strengths]
    plt.plot(strengths, residues, label=f"{p}/{q}")
plt.ylim(0, 1)
plt.xlabel("K")
plt.ylabel("residue")
plt.legend()
plt.show()

end = break_up(Noble((0,)))
print(f"K = {end.strength:.10f} ± {end.strength_error:.0e}")
print(
    f"Ω = {end.omega:.9f} ± {end.omega_error:.0e}, ε = {end.epsilon:.9f} ± {end.epsilon_error:.0e}"
)
print("by the norms of the circles below:", round(end.by_norms, 5))
assert abs(end.strength - 0.971635406) < 1e-9

# %% [markdown]
# ## The boundary is a fractal
#
# Every noble number has its own end. At a rational one, $\Omega \approx \pi p/q$, there is a
# tongue, and ever smaller ones between.

# %%
sides = ((3,), (2, 1), (2,), (1, 1), (1, 2), (1, 1, 1))  # of 1/3, 1/2 and 2/3, below and above
heads = [(0, *side, a) for side in sides for a in (2, 3, 4, 6, 9)]
ends = [break_up(Noble(head)) for head in heads]
ends += [end, break_up(noble(math.sqrt(2) - 1))]
plt.figure(figsize=(6, 3.5))
plt.semilogy([one.omega for one in ends], [one.epsilon for one in ends], "o", ms=4)
for p, q in ((1, 3), (1, 2), (2, 3)):
    plt.axvline(math.pi * p / q, color="0.8", lw=0.8)
plt.xlabel("Ω")
plt.ylabel("ε at which the circle breaks up")
plt.show()
