"""Periodic wave-less states of the pinned rope that bends, by harmonic balance.

Nothing is expanded in ε and nothing of the package is used: each harmonic of W is written with the
two solutions of the full equation that meet the driven end,

    sin kξ and sinh pξ,  βz⁴ − z² = (jΩ)² at z = ik, p;     ξ and sinh(ξ/√β) for the mean,

the load and the drive with particular solutions, and W = W_ξ = W_ξξ = 0 is asked for at the moving
contact point ξ_c(θ) = Σ c_j cos jθ, at as many phases as there are harmonics. The amplitude c_q of
one harmonic is given instead of ε, which is found: past a fold in ε the family simply goes on.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass
class BeamStates:
    """States of one rope at one Ω; ``q`` names the harmonic whose amplitude is given."""

    beta: float
    omega: float
    q: int
    harmonics: int = 16
    length: float = 1.0  # set by __post_init__

    def __post_init__(self) -> None:
        j = np.arange(self.harmonics + 1)
        root = np.sqrt(1 + 4 * self.beta * (j * self.omega) ** 2)
        self.k = np.sqrt((root - 1) / (2 * self.beta))
        self.p = np.sqrt((root + 1) / (2 * self.beta))
        phase = np.pi * (j + 0.5) / j.size
        self.cosines = np.cos(np.outer(phase, j))
        self.length = self._static_contact_point()
        self.rest = np.zeros(3 * j.size + 1)
        self.rest[[0, j.size]], self.rest[2 * j.size] = self._static(self.length)[0], self.length

    def _static(self, place: float) -> tuple[Array, float]:
        """The mean's two coefficients from W = W_ξ = 0 at a place, and the W_ξξ that is left."""
        x = np.array([place])
        basis = [[b[0, 0] for b in self._basis(x, e)] for e in range(3)]
        load = [self._given(x, e)[0][0] for e in range(3)]
        found = np.linalg.solve(np.array(basis[:2]), -np.array(load[:2]))
        return found, float(basis[2] @ found + load[2])

    def _static_contact_point(self) -> float:
        low, high = 1.0, 1 + 2 * np.sqrt(self.beta)
        for _ in range(60):
            middle = (low + high) / 2
            same = self._static(middle)[1] * self._static(low)[1] > 0
            low, high = (middle, high) if same else (low, middle)
        return low

    def _basis(self, x: Array, e: int) -> tuple[Array, Array]:
        """∂^e of the two solutions of each harmonic at each phase; the second is 1 at ξ₀."""
        quarter = e * np.pi / 2
        wave = self.k**e * np.sin(np.outer(x, self.k) + quarter)
        wave[:, 0] = x if e == 0 else float(e == 1)
        rising = np.exp(np.outer(x - self.length, self.p))
        falling = np.exp(-np.outer(x + self.length, self.p))
        return wave, self.p**e * (rising - (-1) ** e * falling)

    def _given(self, x: Array, e: int) -> tuple[Array, Array]:
        """∂^e of the loaded shape 1 + 2β + ξ² − 2βe^{−ξ/√β}, and of a unit drive's harmonic."""
        k, p = self.k[1], self.p[1]
        power = [1 + 2 * self.beta + x * x, 2 * x, 2 + 0 * x, 0 * x][e]
        load = power - 2 * self.beta * (-self.p[0]) ** e * np.exp(-self.p[0] * x)
        quarter = e * np.pi / 2
        drive = p * p * k**e * np.cos(k * x + quarter) + k * k * (-p) ** e * np.exp(-p * x)
        return load, drive / (p * p + k * k)

    def state(self, start: Array, given: int, value: float) -> Array:
        """The state (u, v, c, ε) near ``start`` whose entry number ``given`` has that value."""
        n, unknown = self.harmonics + 1, start.copy()
        for _ in range(30):
            u, v, c, epsilon = np.split(unknown, [n, 2 * n, 3 * n])
            x = self.cosines @ c
            levels = []
            for e in range(4):
                one, two = (basis * self.cosines for basis in self._basis(x, e))
                load, drive = self._given(x, e)
                drive = drive * self.cosines[:, 1]
                levels.append((one @ u + two @ v + load + epsilon * drive, one, two, drive))
            rows = [
                np.hstack([one, two, levels[e + 1][0][:, None] * self.cosines, drive[:, None]])
                for e, (_, one, two, drive) in enumerate(levels[:3])
            ]
            last = np.zeros(3 * n + 1)
            last[given] = 1.0
            residual = [*(level[0] for level in levels[:3]), [unknown[given] - value]]
            step = np.linalg.solve(np.vstack([*rows, last]), np.concatenate(residual))
            unknown = unknown - step
            if abs(step[2 * n :]).max() > 0.5:
                break
            if abs(step[2 * n :]).max() < 1e-11:
                return unknown
        raise ArithmeticError(f"no state with entry {given} = {value} at Omega = {self.omega}")

    def amplitude_entry(self) -> int:
        """Where c_q stands in a state; ε is its last entry."""
        return 2 * (self.harmonics + 1) + self.q

    def family(self, start: Array, amplitudes: Array) -> Array:
        """(c_q, ε) of the states with c_q = each amplitude in turn, up to where Newton is lost."""
        found = []
        for amplitude in amplitudes:
            try:
                start = self.state(start, self.amplitude_entry(), float(amplitude))
            except (ArithmeticError, np.linalg.LinAlgError):
                break
            found.append([amplitude, start[-1]])
        return np.array(found)

    def raised(self, epsilons: Array) -> Array:
        """(c_q, ε) of the branch from rest at each ε in turn, up to where Newton is lost."""
        found, state = [], self.rest
        for epsilon in epsilons:
            try:
                state = self.state(state, -1, float(epsilon))
            except (ArithmeticError, np.linalg.LinAlgError):
                break
            found.append([state[self.amplitude_entry()], epsilon])
        return np.array(found)


def extremum(family: Array) -> float:
    """The extremal ε of a family, by the parabola through the largest (or smallest) three."""
    epsilon = family[:, 1]
    for i in range(1, len(epsilon) - 1):
        if (epsilon[i] - epsilon[i - 1]) * (epsilon[i + 1] - epsilon[i]) <= 0:
            a, b, c = np.polyfit(family[i - 1 : i + 2, 0] - family[i, 0], epsilon[i - 1 : i + 2], 2)
            return float(c - b * b / (4 * a))
    raise ArithmeticError("the family has no fold")
