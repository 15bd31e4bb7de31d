"""The rope W_tautau - W_xixi + kappa*W = -2, through order 2 in epsilon.

Order 2 of this rope is written by hand; asymptotics.printing.rope_modules puts in others.

    contact(tau, omega, epsilon, **parameters)      x_c/x0
    shape(xi, tau, omega, epsilon, **parameters)    w/Z0 at xi = x/x0, from the driven end on
    profile(s, tau, omega, epsilon, **parameters)   w/Z0 at s = (x - x_c)/x0 <= 0
    harmonics(omega, **parameters)                  {(n, j): c}, x_c/x0 = static_contact_point
                                                    + Re sum c epsilon**n exp(i j omega tau)
    static_contact_point(**parameters)              x_c/x0 at rest

All arguments are dimensionless: omega is the angular frequency times x0/c, epsilon the forcing
amplitude in units of Z0, tau = c t/x0; the parameters' names are PARAMETERS. They broadcast against
one another in contact, harmonics and static_contact_point; shape and profile take one rope, and
arrays of xi or s and tau. profile is the series in epsilon at fixed s: it meets the ground
smoothly, to rounding; shape is the one at fixed xi, and meets the driven end. The amplitudes are
polynomials in impedances, which are computed here from the equation.

nan is no result. It says that there is none:

    at a resonance, or so near that less than half the digits of the impedances are right
    where no static contact point is found, or the rope would not leave the ground upwards there
    where so much cancels that less than half the digits of the oscillation are right
    where an argument is not finite; behind the driven end, xi < 0 or s < -x_c/x0

What it does not look at: whether the rope at rest stays above the ground between its ends.
"""

from typing import Any

import numpy as np

from asymptotics.problems.marching import along, impedances, rest, static_shape, towers

ORDER = 2
CONTACTS = 2
EVEN = True
PARAMETERS = ("kappa",)
DRIVE = (1,)
GENERATORS = ("S1_1", "S1_2", "alpha3", "Y0_1_0", "Y2_1_0")

# Half the digits of a double.
RESOLUTION = 2.0**-26


def contact(tau: Any, omega: Any, epsilon: Any, /, **parameters: Any) -> Any:
    """x_c/x0 at the times tau, through epsilon**ORDER."""
    tau, omega, epsilon = (np.asarray(a, dtype=float) for a in (tau, omega, epsilon))
    point = _Point(omega, parameters)
    total = point.shaped(point.place)
    for (n, j), amplitude in _harmonics(point).items():
        total = total + epsilon**n * np.real(amplitude * np.exp(1j * j * omega * tau))
    return total[()]


def static_contact_point(**parameters: Any) -> Any:
    """x_c/x0 at rest."""
    point = _Point(0.0, parameters)
    return point.shaped(point.place)[()]


def harmonics(omega: Any, /, **parameters: Any) -> Any:
    """{(n, j): amplitude of epsilon**n exp(i j omega tau) in x_c/x0}; its real part counts."""
    return _harmonics(_Point(omega, parameters))


def _harmonics(point: Any) -> Any:
    values = point.values()
    found, sizes = _amplitudes(values, -1.0), _amplitudes(_magnitudes(values), 1.0)
    result = {}
    for (n, j), amplitude in found.items():
        order = sum(np.abs(x) for (other, _), x in found.items() if other == n)
        sure = 2.0**-48 * sizes[n, j] <= RESOLUTION * order
        result[n, j] = point.shaped(np.where(sure, amplitude, np.nan) / point.leading**n)
    return result


def shape(xi: Any, tau: Any, omega: Any, epsilon: Any, /, **parameters: Any) -> Any:
    """w/Z0 at xi and the times tau, through epsilon**ORDER; 0 on the ground."""
    xi, tau = np.broadcast_arrays(np.asarray(xi, dtype=float), np.asarray(tau, dtype=float))
    point = _Point(omega, parameters)
    if point.size != 1:
        raise ValueError("shape takes one omega and one value of each parameter")
    omega, place = float(np.ravel(omega)[0]), contact(tau, omega, epsilon, **parameters)
    if not np.isfinite(place).all() or not np.isfinite(xi).all():
        return np.full(xi.shape, np.nan)[()]
    inside = np.clip(xi, 0.0, place)
    length = point.place[0]
    heights, load = point.constants[0], point.load[0]
    equation, ends, _ = point.harmonic(0)
    total = static_shape(
        equation[0].real, ends[0].real, heights, load, length, CONTACTS, inside, 1
    )[0].astype(float)
    weights = {j: [np.zeros(CONTACTS - 1, dtype=complex), 0.0] for j in DRIVE}
    for j in DRIVE:
        weights[j][1] = epsilon
    for (n, j), data in _contact_data(point.values(), -1.0).items():
        scale = point.leading[0] * (epsilon / point.leading[0]) ** n
        entry = weights.setdefault(j, [np.zeros(CONTACTS - 1, dtype=complex), 0.0])
        entry[0] = entry[0] + scale * np.array([complex(np.ravel(u)[0]) for u in data])
    for j, (data, small) in weights.items():
        equation, ends, amplitudes = point.harmonic(j)
        found = along(equation[0], ends[0], small * amplitudes[0], length, data, inside, 1)[0]
        total = total + np.real(found * np.exp(1j * j * omega * tau))
    total = np.where(xi > place, 0.0, total) + _ground(xi, point.parameters)
    return np.where(xi < -RESOLUTION, np.nan, total)[()]


def profile(s: Any, tau: Any, omega: Any, epsilon: Any, /, **parameters: Any) -> Any:
    """w/Z0 at the distance s from the contact point and the times tau; 0 on the ground, s > 0."""
    s, tau = np.broadcast_arrays(np.asarray(s, dtype=float), np.asarray(tau, dtype=float))
    point = _Point(omega, parameters)
    if point.size != 1:
        raise ValueError("profile takes one omega and one value of each parameter")
    omega, length = float(np.ravel(omega)[0]), float(point.place[0])
    if not np.isfinite(length) or not (np.isfinite(s).all() and np.isfinite(tau).all()):
        return np.full(s.shape, np.nan)[()]
    moved = [0.0 * tau] + [0.0 * tau for _ in range(ORDER)]
    for (n, j), amplitude in _harmonics(point).items():
        moved[n] = moved[n] + np.real(amplitude * np.exp(1j * j * omega * tau))
    place = length + sum(epsilon**n * moved[n] for n in range(1, ORDER + 1))
    lifted = length + np.minimum(s, 0.0)
    # delta**d/d! as a series in epsilon, from d = 0 on.
    power = [np.ones_like(tau)] + [0.0 * tau for _ in range(ORDER)]
    data = _contact_data(point.values(), -1.0)
    orders = [_order(point, k, data, lifted, tau, ORDER + 1 - k) for k in range(ORDER + 1)]
    total = 0.0 * s
    for d in range(ORDER + 1):
        for k in range(ORDER + 1 - d):
            for n in range(d, ORDER + 1 - k):
                total = total + epsilon ** (n + k) * power[n] * orders[k][d]
        power = [
            sum((power[i] * moved[n - i] for i in range(n)), 0.0 * tau) / (d + 1)
            for n in range(ORDER + 1)
        ]
    total = np.where(s > 0.0, 0.0, total) + _ground(place + s, point.parameters)
    return np.where(s < -place - RESOLUTION, np.nan, total)[()]


def _order(point: Any, k: int, contact_data: Any, places: Any, tau: Any, depth: int) -> Any:
    """w_k and its derivatives in xi at fixed places, order k of epsilon."""
    length, omega = point.place[0], point.omega[0]
    if k == 0:
        equation, ends, _ = point.harmonic(0)
        heights, load = point.constants[0], point.load[0]
        return static_shape(
            equation[0].real, ends[0].real, heights, load, length, CONTACTS, places, depth
        )
    data = dict.fromkeys(DRIVE, (0.0,) * (CONTACTS - 1)) if k == 1 else {}
    for (n, j), values in contact_data.items():
        if n == k:
            scale = point.leading[0] ** (1 - k)
            data[j] = tuple(scale * complex(np.ravel(u)[0]) for u in values)
    total = np.zeros((depth, *np.shape(places)))
    for j, values in data.items():
        equation, ends, amplitudes = point.harmonic(j)
        drive = amplitudes[0] if k == 1 else 0.0 * amplitudes[0]
        start = np.array(values, dtype=complex)
        found = along(equation[0], ends[0], drive, length, start, places, depth)
        total = total + np.real(found * np.exp(1j * j * omega * tau))
    return total


class _Point:
    """All points of (omega, parameters) in one row, and the rope at rest there."""

    def __init__(self, omega: Any, parameters: Any) -> None:
        if sorted(parameters) != sorted(PARAMETERS):
            names = ", ".join(PARAMETERS) or "none"
            raise TypeError(f"the parameters of this rope are {names}; given: {sorted(parameters)}")
        arrays = [np.asarray(parameters[name], dtype=float) for name in PARAMETERS]
        omega, *arrays = np.broadcast_arrays(np.asarray(omega, dtype=float), *arrays)
        self.shape, self.size = omega.shape, omega.size
        # An argument that is no number takes its point's result with it, not the others'.
        finite = np.isfinite([omega, *arrays]).all(axis=0).ravel()
        self.missing = np.where(finite, 0.0, np.nan)
        omega, *arrays = (np.where(finite, a.ravel(), 1.0) for a in (omega, *arrays))
        self.omega = omega
        self.parameters = dict(zip(PARAMETERS, arrays, strict=True))
        self.load = self.columns(_load(self.parameters)).real
        self.constants = self.columns(_constants(self.parameters)).real
        self.equation, ends, _ = self.harmonic(0)
        found = rest(self.equation.real, ends.real, self.constants, self.load, CONTACTS)
        self.place, self.first, self.pull = found[0] + self.missing, found[1], found[2]
        self.leading = self.static(CONTACTS + 1)[:, CONTACTS]

    def columns(self, entries: Any) -> Any:
        full = [np.broadcast_to(np.asarray(x), (self.size,)) for x in entries]
        return np.stack(full, axis=-1).astype(complex)

    def shaped(self, values: Any) -> Any:
        return np.reshape(values, self.shape)

    def static(self, depth: int) -> Any:
        return towers(self.equation.real, self.first, depth, self.pull)

    def harmonic(self, j: int) -> Any:
        """Equation, conditions and drive at harmonic j."""
        x = j * self.omega
        equation = self.columns(_equation(x, self.parameters))
        rows = [self.columns(row) for row in _conditions(x, self.parameters)]
        ends = np.stack(rows, axis=1)
        amplitudes = self.columns(_drive(j, self.parameters))
        if EVEN:
            return equation.real, ends.real, amplitudes.real
        return equation, ends, amplitudes

    def values(self) -> Any:
        """The generators."""
        depth = ORDER + CONTACTS
        static = self.static(depth)
        found = {f"alpha{d}": static[:, d] / self.leading for d in range(CONTACTS + 1, depth)}
        harmonic = {int(name[1:].split("_")[0]) for name in GENERATORS if name[0] in "SY"}
        for j in sorted(harmonic):
            equation, ends, amplitudes = self.harmonic(j)
            table, source = impedances(equation, ends, amplitudes, self.place, CONTACTS - 1)
            both = np.concatenate([table, source[:, :, None]], axis=-1)
            tower = towers(equation, both, depth)
            for d in range(CONTACTS - 1, depth - 1):
                for i in range(CONTACTS - 1):
                    found[f"Y{j}_{d}_{i}"] = tower[:, d, i]
                found[f"S{j}_{d}"] = tower[:, d, -1]
        conjugates = [name for name in GENERATORS if name.endswith("_")]
        return found | {name: np.conj(found[name[:-1]]) for name in conjugates}


def _magnitudes(values: Any) -> Any:
    return {name: np.abs(value) for name, value in values.items()}


def _amplitudes(v: Any, minus: Any) -> Any:
    """x_c's in units of 1/a_m**n; with magnitudes and minus = 1 the sum of their terms' sizes."""
    S1_1, S1_2, alpha3, Y0_1_0, Y2_1_0 = (v[name] for name in GENERATORS)
    x1_1 = minus * S1_1
    x2_0 = S1_1**2 / 4 * (minus * alpha3 + minus * Y0_1_0)
    x2_0 = x2_0 + S1_1 / 2 * (S1_2)
    x2_2 = S1_1**2 / 4 * (minus * alpha3 + minus * Y2_1_0)
    x2_2 = x2_2 + S1_1 / 2 * (S1_2)
    return {(1, 1): x1_1, (2, 0): x2_0, (2, 2): x2_2}


def _contact_data(v: Any, minus: Any) -> Any:
    """W's values and slopes at the static contact point, in units of a_m**(1 - n)."""
    S1_1, S1_2, alpha3, Y0_1_0, Y2_1_0 = (v[name] for name in GENERATORS)
    u2_0_0 = minus * S1_1**2 / 4
    u2_2_0 = minus * S1_1**2 / 4
    return {(2, 0): (u2_0_0,), (2, 2): (u2_2_0,)}


def _equation(x: Any, p: Any) -> Any:
    """The coefficients of W, W_xi, ... at exp(i x tau)."""
    return p["kappa"] - x**2, 0.0, -1.0


def _load(p: Any) -> Any:
    """The right-hand side's coefficients of 1, xi, ..."""
    return (-2.0,)


def _conditions(x: Any, p: Any) -> Any:
    """The same of each condition at the driven end."""
    return ((1.0, 0.0),)


def _constants(p: Any) -> Any:
    """What each equals at rest."""
    return (1.0,)


def _drive(j: int, p: Any) -> Any:
    """The amplitude of epsilon exp(i j omega tau) in each condition; its real part counts."""
    return {1: (1.0,)}.get(j, (0.0,))


def _ground(xi: Any, p: Any) -> Any:
    return 0.0 * xi
