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
# # How a rope starts to shed waves
#
# A rope that bends a little, $\beta = 0.01$, follows its driven end without a wave as long as there
# is a periodic state to follow, and as long as that is stable. Two tools know nothing of each
# other: the *normal form*, the expansion's own equation for the amplitude of a resonant mode, and
# *branches* of periodic states computed without any expansion.

# %%
import matplotlib.pyplot as plt
import numpy as np

import ropewave as rw
from asymptotics.errors import InputError
from asymptotics.resonances.normal_form import normal_form
from derivations.cross_check.ropes import in_numbers
from numerics.periodic.branches import follow, switched
from numerics.periodic.loci import locus
from numerics.periodic.stability import stability
from numerics.periodic.states import periodic_state
from numerics.thresholds.from_state import departure

rope, at = rw.beam(), {"beta": "0.01"}


def stated(omega):
    """The rope in numbers, without the algebra."""
    values = {"beta": 0.01, "Omega": omega}
    return in_numbers(rope, rope.values(values), complex(rope.at(values).rest or 0).real)


# %% [markdown]
# ## A fold
#
# Below the first resonance $\Omega_1 = 3.25$ the response grows, turns round and comes back: beyond
# the fold there is no state.

# %%
form = normal_form(rope, at, 1, 1, 3.2, order=9)
(fold,) = form.folds()
start = periodic_state(stated(3.2), 3e-4)
points = list(follow(stated, start, "epsilon", 1e-4, (0, 2e-3), points=8))
seen = next(point for point in points if point.kind == "fold")

epsilon, amplitude = form.branch()
plt.figure(figsize=(6, 3.5))
plt.plot(epsilon, abs(amplitude), label="normal form of order 9")
harmonic = [abs(point.state.waves[1]) for point in points]
plt.plot([point.epsilon for point in points], harmonic, "o", ms=4, label="periodic states")
plt.xlabel("ε")
plt.ylabel(r"amplitude of $\cos\Omega\tau$ in $\xi_c$")
plt.legend()
plt.show()
print(
    f"fold: {fold.epsilon:.7f} ± {fold.error:.0e} by the normal form, {seen.epsilon:.7f} by states"
)
assert abs(fold.epsilon - seen.epsilon) < fold.error

# %% [markdown]
# Farther from the resonance the orders no longer agree, and then there is no number:

# %%
try:
    normal_form(rope, at, 1, 1, 3.1, order=9).folds()
except InputError as error:
    print(error)

# %% [markdown]
# ## The tongue at twice the first frequency
#
# At $\Omega \approx 2\Omega_1$ the state goes on, but waves of twice the period grow on it: a
# multiplier passes $-1$. The state of twice the period branches off towards *smaller* ε, unstable:
# so nothing catches the rope when it leaves.

# %%
edge = normal_form(rope, at, 1, 1, 6.45, order=8, subharmonic=2).edge()
start = periodic_state(stated(6.45), 2e-3)
points = list(follow(stated, start, "epsilon", 2e-4, (0, 3e-3), points=6))
doubling = next(point for point in points if point.kind == "period doubling")
state, way = switched(doubling)
doubled = list(
    follow(stated, state, "epsilon", 2e-4, (0, 3e-3), points=12, tangent=way, longest=64.0)
)
print(f"edge: {edge.epsilon:.8f} ± {edge.error:.0e}; period doubling at {doubling.epsilon:.8f}")
assert abs(edge.epsilon - doubling.epsilon) < edge.error

plt.figure(figsize=(6, 3.5))
for branch, label in ((points, "period of the drive"), (doubled, "twice the period")):
    verdicts = [stability(point.state).verdict for point in branch]
    places = np.array([(point.epsilon, point.amplitude) for point in branch])
    (line,) = plt.plot(*places.T, "-", lw=0.8, label=label)
    unstable = np.array([verdict == "unstable" for verdict in verdicts])
    plt.plot(*places[~unstable].T, "o", color=line.get_color())
    plt.plot(*places[unstable].T, "x", color=line.get_color())
plt.xlabel("ε")
plt.ylabel(r"amplitude of $\xi_c$")
plt.title("dots: stable; crosses: unstable")
plt.legend()
plt.show()

# %% [markdown]
# ## Both in the plane
#
# A fold and a period doubling are points of curves in the plane of Ω and ε. The curve of folds ends
# at $\Omega_1$, the edge of the tongue at $2\Omega_1$.

# %%
folds = list(locus(stated, seen, 0.01, (3.2, 3.245)))
edges = list(locus(stated, doubling, 0.012, (6.45, 6.49)))
figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3), layout="constrained")
for axes, curve, label in ((left, folds, "folds"), (right, edges, "period doublings")):
    axes.plot([p.omega for p in curve], [p.epsilon for p in curve], "o-", ms=4, label=label)
    axes.set(xlabel="Ω", ylabel="ε")
form = normal_form(rope, at, 1, 1, 3.24, order=9).folds()[0]
left.plot(3.24, form.epsilon, "k*", ms=9, label="normal form")
edge = normal_form(rope, at, 1, 1, 6.48, order=8, subharmonic=2).edge()
right.plot(6.48, edge.epsilon, "k*", ms=9, label="normal form")
left.legend()
right.legend()
plt.show()
last = list(locus(stated, seen, 0.01, (3.2, 3.24)))[-1]
print(f"fold at Ω = 3.24: {last.epsilon:.8f} on the curve, {form.epsilon:.8f} by the normal form")
assert abs(last.epsilon - form.epsilon) < 2 * form.error

# %% [markdown]
# ## Simulations that start on the state
#
# No ramp: the simulator begins on a periodic state with a small push, and what is seen is how far
# its contact point is from the state's. On the tongue the disturbance grows at the rate that the
# multiplier says; below the fold it stays, above it does not.

# %%
runs = {
    "Ω = 6.5, ε = 0.005": departure(periodic_state(stated(6.5), 0.005), 80),
    "Ω = 3.2, below the fold": departure(periodic_state(stated(3.2), 0.9 * seen.epsilon), 80),
    "Ω = 3.2, above it": departure(
        periodic_state(stated(3.2), 0.9 * seen.epsilon), 80, epsilon=1.1 * seen.epsilon
    ),
}
plt.figure(figsize=(6, 3.5))
for name, run in runs.items():
    plt.semilogy(run.times, run.distance, label=f"{name}: {run.outcome.value}")
growth = stability(periodic_state(stated(6.5), 0.005)).growth
time = runs["Ω = 6.5, ε = 0.005"].times
plt.semilogy(time, 3e-4 * np.exp(growth * time), "k:", label="slope of the multiplier")
plt.xlabel("τ")
plt.ylabel(r"distance of $\xi_c$ from the state's")
plt.legend(loc="upper left", fontsize=8)
plt.show()
rate = runs["Ω = 6.5, ε = 0.005"].rate
print(f"growth {rate:.4f} simulated (a grid damps), {growth:.4f} by the multiplier")
assert 0.9 * growth < rate < growth
assert [run.outcome.value for run in runs.values()] == ["leaves", "stays", "leaves"]
