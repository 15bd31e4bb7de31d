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
# # From a rope that follows to a rope that sheds a wave
#
# The closed forms of notebook 1 say what the rope does as long as it touches the ground from one
# moving point on. Here we confront them with simulations that know nothing of the algebra: the
# full problem with a ground that only pushes, solved step by step. Then we shake harder, until a
# wave leaves.
#
# (`pip install -e '.[sim]'` brings what this notebook needs.)

# %% [markdown]
# ## A rope that follows
#
# $\beta = B/(Tx_0^2) = 0.01$ as in the paper's Fig. 2, $\Omega = 2.5$ between two resonances, and
# an amplitude $\epsilon = 0.03$ that is reached along a smooth ramp.

# %%
import math

import numpy as np

from numerics.problems.drive import ramped_cosine
from numerics.problems.problem import RopeProblem
from numerics.simulation.observables import Column
from numerics.simulation.run import simulate
from numerics.simulation.semi_discrete import Grid

beta, omega, epsilon = 0.01, 2.5, 0.03
drive = ramped_cosine(omega, epsilon, periods=30)
follows = simulate(RopeProblem(beta, drive), until=32 * drive.period, grid=Grid(dx=0.01))
contact, wave = follows.column(Column.CONTACT), follows.column(Column.BUMP)
print(f"contact point between {contact.min():.4f} and {contact.max():.4f}")
print(f"highest wave beyond it: {wave.max()}")

# %% [markdown]
# Every run brings its own evidence. The energy balance of the implicit scheme is exact, so what no
# entry of the ledger explains is rounding; both halves of the contact law, $W \ge 0$ and
# $\lambda \ge 0$, are looked at in every step.

# %%
energy, work, damped, lost = follows.ledger
print(f"stored {energy:.6f}, work done {work:.6f}, lost in contact {lost:.1e}")
print(f"unexplained in any step: {follows.unexplained:.0e}")
print(f"smallest height {follows.lowest}, smallest reaction {follows.reaction:.1e}")

# %% [markdown]
# ## The closed form says the same
#
# `derivations/generated` holds the series as NumPy modules. The one with bending, through
# $\epsilon^3$, against the last period of the simulation:

# %%
import matplotlib.pyplot as plt

from derivations.generated import beam_order3_pinned as series

blue, orange, grey = "#0072B2", "#D55E00", "0.45"
period = follows.times >= follows.times[-1] - drive.period
tau, simulated = follows.times[period], follows.column(Column.CONTACT)[period]
predicted = series.contact(tau, omega, epsilon, beta)
figure, axes = plt.subplots(figsize=(5.6, 3.2), layout="constrained")
axes.plot(omega * tau / (2 * math.pi), simulated, color=blue, label="simulation")
axes.plot(omega * tau / (2 * math.pi), predicted, "--", color=orange, label=r"series, $\epsilon^3$")
axes.set(xlabel=r"time $\omega t/2\pi$", ylabel=r"contact point $x_c/x_0$")
axes.legend(frameon=False)
difference = float(np.sqrt(np.mean((simulated - predicted) ** 2)))
print(f"rms difference {difference:.1e}")

# %% [markdown]
# What is left is the grid's error, of the order $dx^2/\sqrt\beta = 10^{-3}$, and a remnant of the
# ramp: nothing damps the free oscillations that it excites.

# %% [markdown]
# A grid cannot show that the series is right to $\epsilon^4$. The string can: for $\beta = 0$ its
# motion from rest is iterated exactly, a map from the times at which waves leave the driven end to
# those at which they return. The error of the series truncated after $\epsilon^N$ must fall like
# $\epsilon^{N+1}$:

# %%
from asymptotics.values.evaluate import evaluate
from numerics.exact_string.characteristics import exact_string_motion

golden = 1.941611038725466
errors = []
for amplitude in (0.01, 0.02, 0.04):
    exact_drive = ramped_cosine(golden, amplitude, periods=40)
    motion = exact_string_motion(exact_drive, until=42 * exact_drive.period)
    tau = exact_drive.period * (40 + np.linspace(0, 1, 33))
    exact = motion.contact(tau)
    errors.append(
        [
            np.abs(evaluate(golden, amplitude, N, [0.0], tau).contact - exact).max()
            for N in (1, 2, 3, 4)
        ]
    )
slopes = np.diff(np.log2(errors), axis=0)
for amplitude, row in zip((0.01, 0.02, 0.04), errors, strict=True):
    print(f"epsilon = {amplitude}: errors for N = 1 … 4:", "  ".join(f"{e:.1e}" for e in row))
print("observed powers of epsilon:", "  ".join(f"{s:.2f}" for s in slopes[-1]))

# %% [markdown]
# ## Where it ends
#
# Raise the amplitude at $\Omega = 3.1$, a little below the first resonance
# $\Omega_1(\beta) = 3.25$. `threshold` ramps and bisects. With `quick` it uses one grid, one step,
# one ramp and one integrator; without, it varies each of them and returns the interval that covers
# all.

# %%
from numerics.thresholds.threshold import threshold

critical = threshold(3.1, beta, quick=True, relative=0.02)
print(
    f"epsilon_c between {critical.lower:.4f} and {critical.upper:.4f}: {critical.mechanism.value}"
)

# %% [markdown]
# ## A rope that sheds a wave
#
# At four times that amplitude the rope comes down ahead of its contact point, once a period. What
# it cuts off runs away along the ground.

# %%
strong = ramped_cosine(3.1, 4 * critical.upper, periods=20)
sheds = simulate(
    RopeProblem(beta, strong), until=24 * strong.period, grid=Grid(dx=0.005),
    record_from=20 * strong.period, snapshots=strong.period / 64,
)  # fmt: skip
late = sheds.snapshot_times >= 20 * strong.period
figure, axes = plt.subplots(figsize=(5.6, 3.6), layout="constrained")
heights = np.where(sheds.heights[late] > 1e-5, sheds.heights[late], np.nan)
picture = axes.pcolormesh(
    sheds.snapshot_times[late] / strong.period, sheds.positions, np.log10(heights.T),
    cmap="cividis_r", vmin=-4, vmax=0, rasterized=True,
)  # fmt: skip
axes.plot(sheds.times / strong.period, sheds.column(Column.CONTACT), color="black", lw=0.8)
axes.set(xlabel=r"time $\omega t/2\pi$", ylabel=r"position $x/x_0$", ylim=(0, 5))
figure.colorbar(picture, label=r"$\log_{10}$ height $w/Z_0$")

# %% [markdown]
# On the ground the wave is free, and there is an exact solution for it: a pulse of height
# $31.397\,\beta/(c^2-1)^2$ runs at the speed $c > 1$. Height and speed of the waves are measured
# independently, on two grids:

# %%
from numerics.events.waves import track_waves
from numerics.problems.pulses import pulse_speed
from numerics.simulation.contact import Simulator

for dx in (0.01, 0.005):
    simulator = Simulator(RopeProblem(beta, strong), Grid(dx=dx))
    for _ in simulator.blocks(until=20 * strong.period):
        pass
    tracks = track_waves(simulator, 24 * strong.period, every=0.05, height=1e-3)
    print(f"dx = {dx}")
    for track in sorted(tracks, key=lambda track: -len(track.waves))[:2]:
        # From where it has left to where the absorbing end begins.
        free = [wave for wave in track.waves if 2 < wave.centre < 5]
        lasting = free[-1].energy / free[0].energy
        print(
            f"  height {track.height:.4f}: speed {track.speed:.3f} ± {track.speed_error:.3f},"
            f" that of its pulse {pulse_speed(beta, track.height):.3f};"
            f" {lasting:.0%} of its energy left after {free[-1].centre - free[0].centre:.1f} x_0"
        )

# %% [markdown]
# Wave and pulse agree to about a per cent on the finer grid. The waves fade as they run, and less
# so on the finer grid: every node they touch down on is a small impact that takes energy.
