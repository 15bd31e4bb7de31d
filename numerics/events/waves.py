r"""Waves that have left: their height, length, energy and, followed over snapshots, their speed.

A wave is a run of lifted nodes beyond the first contact point, with nodes on the ground at either
end. Its energy is that of its own nodes, as if the rest of the rope were flat:

.. math:: E = \sum ½ m_i V_i^2 + ½ W·KW + f·W .

For β > 0 a wave that runs along the ground without change is the travelling pulse, whose height
PULSE β/(c² − 1)² falls with its speed; for β = 0 any shape runs at c = 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from numerics.problems.drive import positive
from numerics.problems.pulses import pulse_speed
from numerics.simulation.contact import Simulator, stride
from numerics.simulation.semi_discrete import SemiDiscrete, State


@dataclass(frozen=True)
class Wave:
    """One wave at one time.

    Attributes
    ----------
    time
        τ.
    left, right
        The nodes on the ground at its ends: ξ.
    height, crest
        Of the highest point, from a parabola through three nodes, and its ξ.
    centre
        Σ W ξ/Σ W.
    energy
        E, in units of TZ₀²/x₀.
    kinetic
        The kinetic part of it.
    """

    time: float
    left: float
    right: float
    height: float
    crest: float
    centre: float
    energy: float
    kinetic: float

    @property
    def length(self) -> float:
        """Of the lifted interval."""
        return self.right - self.left


def lifted_waves(system: SemiDiscrete, state: State, time: float, height: float) -> list[Wave]:
    """The waves higher than ``height`` in a state, from the driven end outwards.

    Raises
    ------
    InputError
        ``height`` not positive.

    Examples
    --------
    >>> from numerics.problems.drive import at_rest
    >>> from numerics.problems.problem import RopeProblem
    >>> from numerics.simulation.semi_discrete import Grid
    >>> simulator = Simulator(RopeProblem(0.0, at_rest()), Grid(dx=0.01))
    >>> x = simulator.system.positions - 3
    >>> simulator.state.height[:] += np.maximum(0.2 - x * x, 0)
    >>> [wave] = lifted_waves(simulator.system, simulator.state, 0.0, 1e-3)
    >>> round(wave.height, 12), round(wave.crest, 12), round(wave.length, 2)
    (0.2, 3.0, 0.9)
    """
    level = positive("height", height)
    lifted = state.height > 0
    ground = np.flatnonzero(~lifted)
    if not len(ground):
        return []
    edges = np.diff(lifted[ground[0] :].astype(np.int8))
    starts, ends = (ground[0] + np.flatnonzero(edges == step) for step in (1, -1))
    # A wave that reaches the end of the domain has no right edge there, and is left out.
    pairs = zip(starts, ends + 1, strict=False)
    return [
        _wave(system, state, time, left, right)
        for left, right in pairs
        if state.height[left:right].max() > level
    ]


def _wave(system: SemiDiscrete, state: State, time: float, left: int, right: int) -> Wave:
    alone = np.zeros_like(state.height)
    alone[left + 1 : right] = state.height[left + 1 : right]
    speed = state.velocity[left + 1 : right]
    kinetic = 0.5 * float(system.mass[left + 1 : right] @ speed**2)
    energy = kinetic + 0.5 * float(alone @ (system.force(alone) + system.load))
    top = int(alone.argmax())
    below, middle, above = alone[top - 1], alone[top], alone[top + 1]
    shift = 0.5 * (below - above) / (below - 2 * middle + above)
    return Wave(
        time,
        float(system.positions[left]),
        float(system.positions[right]),
        float(middle - 0.25 * (below - above) * shift),
        float(system.positions[top] + shift * system.dx),
        float(alone @ system.positions / alone.sum()),
        energy,
        kinetic,
    )


@dataclass(frozen=True)
class WaveTrack:
    """One wave at several times.

    Attributes
    ----------
    waves
        In the order of time, two at least.
    """

    waves: tuple[Wave, ...]

    def _line(self) -> tuple[float, float]:
        time = np.array([wave.time for wave in self.waves])
        place = np.array([wave.centre for wave in self.waves])
        time -= time.mean()
        slope = float(time @ place / (time @ time))
        rest = place - place.mean() - slope * time
        return slope, math.sqrt(rest @ rest / max(len(time) - 2, 1) / (time @ time))

    @property
    def speed(self) -> float:
        """dξ/dτ of its centre: the slope of a least-squares line."""
        return self._line()[0]

    @property
    def speed_error(self) -> float:
        """The standard error of the slope."""
        return self._line()[1]

    @property
    def height(self) -> float:
        """The mean of its heights."""
        return float(np.mean([wave.height for wave in self.waves]))

    @property
    def energy(self) -> float:
        """The mean of its energies."""
        return float(np.mean([wave.energy for wave in self.waves]))

    @property
    def breathing(self) -> float:
        """(Largest − smallest height)/mean: 0 for a pulse that runs without change."""
        heights = [wave.height for wave in self.waves]
        return (max(heights) - min(heights)) / self.height


class WaveTracker:
    """Follows waves outwards from snapshot to snapshot: each to the nearest its speed allows.

    Parameters
    ----------
    height
        Lower waves are not followed.
    beta
        β: a wave of this height cannot be faster than its pulse, or twice the string's waves.

    Attributes
    ----------
    tracks
        The waves seen so far, each a list of snapshots.
    """

    def __init__(self, height: float, beta: float) -> None:
        self._height = positive("height", height)
        self._fastest = max(pulse_speed(beta, height), 2.0)
        self.tracks: list[list[Wave]] = []
        self._time = -math.inf

    def feed(self, system: SemiDiscrete, state: State, time: float) -> None:
        """Look at a state."""
        open_tracks = [track for track in self.tracks if track[-1].time == self._time]
        reach = self._fastest * (time - self._time) + system.dx
        for wave in lifted_waves(system, state, time, self._height):
            near = [
                track
                for track in open_tracks
                if -system.dx <= wave.centre - track[-1].centre <= reach
            ]
            if near:
                track = min(near, key=lambda track: abs(_ahead(track, time) - wave.centre))
                open_tracks.remove(track)
                track.append(wave)
            else:
                self.tracks.append([wave])
        self._time = time


def _ahead(track: list[Wave], time: float) -> float:
    if len(track) < 2:
        return track[-1].centre + (time - track[-1].time)
    first, last = track[-2:]
    speed = (last.centre - first.centre) / (last.time - first.time)
    return last.centre + speed * (time - last.time)


def track_waves(simulator: Simulator, until: float, every: float, height: float) -> list[WaveTrack]:
    """Run on to ``until`` and follow all waves, with a snapshot ``every`` so often.

    Only waves seen twice or more are returned. Memory grows with the number of their snapshots.

    Raises
    ------
    InputError
        ``every`` or ``height`` not positive, or ``until`` not after the simulator's time.

    Examples
    --------
    The travelling pulse, put on a rope at rest.

    >>> from numerics.problems.drive import at_rest
    >>> from numerics.exact_solutions.index import travelling_pulse
    >>> from numerics.problems.problem import RopeProblem
    >>> simulator, pulse = Simulator(RopeProblem(0.01, at_rest())), travelling_pulse(0.01, 1.5)
    >>> place = simulator.system.positions - 3
    >>> simulator.state.height[:] += pulse.shape(place)
    >>> simulator.state.velocity[:] += pulse.velocity(place)
    >>> simulator.state.active[simulator.state.height > 0] = False
    >>> [track] = track_waves(simulator, 1.0, 0.1, 1e-2)
    >>> bool(1.49 < track.speed < 1.51)
    True
    """
    simulator.last_step(until)
    tracker = WaveTracker(height, simulator.problem.beta)
    frame = stride("every", every, simulator.dt)
    for _ in simulator.blocks(until, frame):
        if simulator.step % frame == 0:
            tracker.feed(simulator.system, simulator.state, simulator.time)
    return [WaveTrack(tuple(track)) for track in tracker.tracks if len(track) > 1]
