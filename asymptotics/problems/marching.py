"""Impedances of any linear equation in doubles, at many points at once.  NumPy only.

This file is also copied as it stands into the modules that ropewave writes.

A harmonic's solutions that meet the driven end are a plane that grows along the rope: it is carried
from there to the contact point in short steps, made orthonormal after each (Godunov's method), so
that no layer, however thin, hides one solution behind another. Arrays of points are the leading
axis of everything; derivatives are scaled by a rate of each point.

nan is no result: at a resonance, or where no static contact point is found.
"""

from typing import Any

import numpy as np

STEP = 3.0
"""Of the marching, in units of the matrix norm: e^STEP of a double's digits is lost, no more."""

SCAN = 0.5
"""The same while the static contact point is looked for."""

FARTHEST = 1e3
"""Where no contact point is looked for any more, in units of x0."""

MOST_STEPS = 100_000


def impedances(equation: Any, ends: Any, amplitudes: Any, length: Any, data: int) -> Any:
    """What one harmonic's derivatives at the contact point are, per contact datum and per drive.

    Parameters
    ----------
    equation
        (points, r + 1): the coefficient of each derivative in xi, at this harmonic.
    ends
        (points, n, r): the conditions at the driven end, n = r - data.
    amplitudes
        (points, n): what drives them.
    length
        (points,): the static contact point.
    data
        m - 1, the number of contact data w, w', ...

    Returns
    -------
    Y, S
        (points, r, data) and (points, r): derivatives 0 ... r - 1 per datum, and of the drive.
    """
    plane, driven, powers, known = _at_contact(equation, ends, amplitudes, length, data)
    upper, lower = plane[:, :data], plane[:, data:]
    singular = np.linalg.svd(upper, compute_uv=False)
    regular = singular[:, -1] > 2.0**-26  # else half the digits are gone
    upper = np.where(regular[:, None, None], upper, np.eye(data))
    by_datum = lower @ np.linalg.inv(upper)
    by_drive = driven[:, data:] - (by_datum @ driven[:, :data, None])[..., 0]
    points = len(powers)
    table = np.concatenate([np.broadcast_to(np.eye(data), (points, data, data)), by_datum], axis=1)
    table = table * powers[:, :, None] / powers[:, None, :data]
    source = np.concatenate([np.zeros((points, data)), by_drive], axis=1) * powers
    lost = np.where(regular & known, 0.0, np.nan)
    return table + lost[:, None, None], source + lost[:, None]


def characteristic(equation: Any, ends: Any, length: Any, data: int) -> Any:
    """Two determinants: the first vanishes at a resonance, and over the second is analytic.

    Arguments as in :func:`impedances`. Their quotient is 1/Y of the first further derivative per
    last contact datum. The first is continuous where the equation is real.
    """
    nothing = np.zeros(ends.shape[:2])
    plane, _, powers, known = _at_contact(equation, ends, nothing, length, data)
    upper = plane[:, :data]
    exchanged = np.concatenate([upper[:, :-1], plane[:, data : data + 1]], axis=1)
    lost = np.where(known, 0.0, np.nan)
    return np.linalg.det(upper) + lost, np.linalg.det(exchanged) * powers[:, 1]


def _at_contact(equation: Any, ends: Any, amplitudes: Any, length: Any, data: int) -> Any:
    """What meets the driven end, at the contact point: a basis, a driven state, the units."""
    matrix, rate = _scaled(equation)
    known = np.isfinite(length) & np.isfinite(rate)
    matrix = np.where(known[:, None, None], matrix, 0.0)
    rate, length = np.where(known, rate, 1.0), np.where(known, length, 1.0)
    powers = rate[:, None] ** np.arange(matrix.shape[-1])
    plane, driven = _driven_end(ends * powers[:, None, :], amplitudes, data)
    size = np.abs(matrix).sum(axis=-1).max(axis=-1)
    reach = rate * length * size
    steps = int(np.ceil(reach.max(initial=1.0) / STEP))
    if steps > MOST_STEPS:
        raise ValueError(f"{steps} steps through layers this thin; give less extreme parameters")
    step = _exponential(matrix * (rate * length / steps)[:, None, None])
    for _ in range(steps):
        plane, driven, _, _ = _carried(step, plane, driven)
    return plane, driven, powers, known


def towers(equation: Any, first: Any, depth: int, load: Any = None) -> Any:
    """Derivatives 0 ... depth - 1 at one place from the first r, by the equation differentiated.

    ``first`` is (points, r, ...), ``load`` (points, p) the derivatives of the right-hand side.
    """
    order = equation.shape[-1] - 1
    found = [first[:, k] for k in range(order)]
    shape = (len(equation), *(1,) * (first.ndim - 2))
    leading = equation[:, order].reshape(shape)
    while len(found) < depth:
        lowest = len(found) - order
        total = sum(equation[:, k].reshape(shape) * found[lowest + k] for k in range(order))
        if load is not None and lowest < load.shape[1]:
            total = total - load[:, lowest].reshape(shape)
        found.append(-total / leading)
    return np.stack(found[:depth], axis=1)


def rest(equation: Any, ends: Any, heights: Any, load: Any, contacts: int) -> Any:
    """The static contact point, the shape's derivatives there, and the load's.

    Parameters
    ----------
    equation, ends
        As in :func:`impedances`, at rest.
    heights
        (points, n): the constants of the conditions at the driven end.
    load
        (points, p): the coefficients of 1, xi, xi**2, ... on the equation's right-hand side.
    contacts
        m.

    Returns
    -------
    place, derivatives, load
        (points,), (points, r) and (points, p). The place is the first where the shape can meet the
        ground, if the rope leaves the ground upwards there; that it lies above the ground
        everywhere is not looked at.
    """
    points, order = len(equation), equation.shape[-1] - 1
    full, rate, units, plane, driven = _with_load(equation, ends, heights, load, contacts)
    size = np.abs(full).sum(axis=-1).max(axis=-1)
    stride = SCAN / size
    step = _exponential(full * stride[:, None, None])
    place = np.full(points, np.nan)
    state = np.full((points, full.shape[-1]), np.nan)
    done = np.zeros(points)
    before = _meeting(plane, driven, contacts)
    open_ = np.isfinite(before)
    for _ in range(MOST_STEPS):
        open_ = open_ & (done < FARTHEST * rate)
        if not open_.any():
            break
        new_plane, new_driven, _, _ = _carried(step, plane, driven)
        after = _meeting(new_plane, new_driven, contacts)
        met = open_ & (before * after <= 0)
        if met.any():
            at, there = _root(full[met], plane[met], driven[met], stride[met], contacts)
            # W is about a_m s^m/m! next to the contact point, s < 0: above the ground there?
            above = there[:, contacts] * (-1.0) ** contacts > 0
            index = np.flatnonzero(met)[above]
            place[index] = ((done[met] + at) / rate[met])[above]
            state[index] = there[above]
            open_[index] = False
        plane, driven, before = new_plane, new_driven, after
        done = done + stride
    state = state * units
    return place, state[:, :order], state[:, order:]


def along(
    equation: Any, ends: Any, amplitudes: Any, length: Any, values: Any, places: Any, depth: int
) -> Any:
    """One harmonic and its derivatives at many places, from its data at the contact point.

    Parameters
    ----------
    equation, ends, amplitudes
        As in :func:`impedances`, of one point.
    length
        The static contact point.
    values
        The m - 1 contact data.
    places
        xi, any shape; slightly beyond the ends is continued.
    depth
        How many derivatives, w among them; the leading axis of the result.
    """
    matrix, rate = _scaled(equation[None])
    units = rate[0] ** np.arange(matrix.shape[-1])
    plane, driven = _driven_end(ends[None] * units, amplitudes[None], len(values))
    scaled = values / units[: len(values)]
    states = _followed(matrix, rate, plane, driven, length, scaled, places) * units
    return _deep(equation, states, depth, places, None)


def static_shape(
    equation: Any,
    ends: Any,
    heights: Any,
    load: Any,
    length: Any,
    contacts: int,
    places: Any,
    depth: int,
) -> Any:
    """The same of the rope at rest; arguments as in :func:`rest`, of one point."""
    full, rate, units, plane, driven = _with_load(
        equation[None], ends[None], heights[None], load[None], contacts
    )
    states = _followed(full, rate, plane, driven, length, np.zeros(contacts), places) * units[0]
    order = equation.shape[-1] - 1
    return _deep(equation, states[:, :order], depth, places, states[:, order:])


def _deep(equation: Any, states: Any, depth: int, places: Any, load: Any) -> Any:
    """As many derivatives as asked for, from the first r at each place."""
    rows = np.broadcast_to(equation, (len(states), len(equation)))
    found = towers(rows, states, max(depth, states.shape[1]), load)[:, :depth]
    return np.moveaxis(found, 0, -1).reshape(depth, *np.shape(places))


def _with_load(equation: Any, ends: Any, heights: Any, load: Any, contacts: int) -> Any:
    """The companion matrix with the load's derivatives as further states, and the driven end."""
    points, order = len(equation), equation.shape[-1] - 1
    matrix, rate = _scaled(equation)
    p = load.shape[1]
    full = np.zeros((points, order + p, order + p))
    full[:, :order, :order] = matrix
    full[:, order - 1, order] = 1.0
    for q in range(p - 1):
        full[:, order + q, order + q + 1] = 1.0
    # The load's derivatives in units in which each is the next one's rate.
    units = rate[:, None] ** np.arange(order + p)
    units[:, order:] = units[:, order:] * equation[:, order, None]
    factorials = np.cumprod([1.0, *range(1, p)])[:p]
    plane, driven = _driven_end(ends * units[:, None, :order], heights, contacts - 1)
    plane = np.concatenate([plane, np.zeros((points, p, contacts - 1))], axis=1)
    driven = np.concatenate([driven, load * factorials / units[:, order:]], axis=1)
    return full, rate, units, plane, driven


def _followed(
    matrix: Any, rate: Any, plane: Any, driven: Any, length: Any, values: Any, places: Any
) -> Any:
    """The states at places, a row each, from the first derivatives at the contact point."""
    size = np.abs(matrix).sum(axis=-1).max()
    steps = max(1, int(np.ceil(rate[0] * length * size / STEP)))
    if steps > MOST_STEPS:
        raise ValueError(f"{steps} steps through layers this thin; give less extreme parameters")
    stride = length / steps
    step = _exponential(matrix * rate[0] * stride)
    nodes = [(plane, driven)]
    links = []
    for _ in range(steps):
        plane, driven, triangle, shift = _carried(step, plane, driven)
        nodes.append((plane, driven))
        links.append((triangle[0], shift[0]))
    known = len(values)
    weight = np.linalg.pinv(plane[0, :known]) @ (values - driven[0, :known])
    states = np.empty((steps + 1, matrix.shape[-1]), dtype=np.result_type(plane, driven, weight))
    for k in range(steps, -1, -1):
        plane, driven = nodes[k]
        states[k] = plane[0] @ weight + driven[0]
        if k:
            triangle, shift = links[k - 1]
            weight = np.linalg.solve(triangle, weight - shift)
    places = np.asarray(places, dtype=float)
    nearest = np.clip(np.rint(places.ravel() / stride), 0, steps).astype(int)
    away = rate[0] * (places.ravel() - nearest * stride)
    moved = _exponential(matrix * away[:, None, None]) @ states[nearest][..., None]
    return moved[..., 0]


def _scaled(equation: Any) -> Any:
    """The companion matrix in units of a rate, and the rate: all its entries are 1 or less."""
    order = equation.shape[-1] - 1
    ratio = equation[:, :order] / equation[:, order, None]
    roots = np.abs(ratio) ** (1.0 / (order - np.arange(order)))
    rate = np.maximum(roots.max(axis=-1), 0.5)
    matrix = np.zeros((len(equation), order, order), dtype=ratio.dtype)
    for k in range(order - 1):
        matrix[:, k, k + 1] = 1.0
    matrix[:, order - 1, :] = -ratio / rate[:, None] ** (order - np.arange(order))
    return matrix, rate


def _driven_end(rows: Any, amplitudes: Any, data: int) -> Any:
    """An orthonormal basis of what the conditions leave free, and one state that meets them."""
    size = np.abs(rows).max(axis=-1)
    size = np.where(size > 0, size, 1.0)
    rows, amplitudes = rows / size[:, :, None], amplitudes / size
    dual = np.conj(np.swapaxes(rows, -1, -2))
    basis = np.linalg.qr(dual, mode="complete")[0]
    free = basis[..., basis.shape[-1] - data :]
    gram = rows @ dual
    driven = (dual @ np.linalg.solve(gram, amplitudes[..., None]))[..., 0]
    return free, driven


def _carried(step: Any, plane: Any, driven: Any) -> Any:
    """One step on, the basis orthonormal again and oriented as before.

    Returns basis and state there, and T and t: what was ``basis c + state`` before is
    ``basis (T c + t) + state`` now.
    """
    plane, driven = step @ plane, (step @ driven[..., None])[..., 0]
    plane, triangle = np.linalg.qr(plane)
    diagonal = np.diagonal(triangle, axis1=-2, axis2=-1)
    size = np.abs(diagonal)
    turn = diagonal / np.where(size > 0, size, 1.0)
    plane, triangle = plane * turn[:, None, :], triangle / turn[..., None]
    inside = np.conj(np.swapaxes(plane, -1, -2)) @ driven[..., None]
    return plane, driven - (plane @ inside)[..., 0], triangle, inside[..., 0]


def _meeting(plane: Any, driven: Any, contacts: int) -> Any:
    """The determinant that vanishes where the first ``contacts`` derivatives can."""
    columns = np.concatenate([plane, driven[..., None]], axis=-1)
    return np.linalg.det(columns[:, :contacts])


def _root(matrix: Any, plane: Any, driven: Any, stride: Any, contacts: int) -> Any:
    """The zero of :func:`_meeting` within a step, by bisection and secants, and the state there."""
    columns = np.concatenate([plane, driven[..., None]], axis=-1)
    terms = [columns]
    for k in range(1, 24):
        terms.append(matrix @ terms[-1] / k)

    def at(t: Any) -> Any:
        total = terms[-1]
        for term in terms[-2::-1]:
            total = total * t[:, None, None] + term
        return total

    def value(t: Any) -> Any:
        return np.linalg.det(at(t)[:, :contacts])

    low, high = np.zeros(len(stride)), stride.copy()
    f_low, f_high = value(low), value(high)
    for _ in range(200):
        slope = np.where(f_high != f_low, f_high - f_low, 1.0)
        t = np.clip(high - f_high * (high - low) / slope, low, high)
        f = value(t)
        upper = f * f_high > 0
        # Illinois: the end that stays loses half its weight, so that both ends close in.
        f_low = np.where(upper, 0.5 * f_low, f)
        f_high = np.where(upper, f, 0.5 * f_high)
        low, high = np.where(upper, low, t), np.where(upper, t, high)
        exact = f == 0
        low, high = np.where(exact, t, low), np.where(exact, t, high)
        if np.all(high - low <= 4e-16 * stride) or np.all((np.abs(f) < 1e-300) | exact):
            break
    # The end of the bracket that the last secant came from is the better one.
    t = np.where(np.abs(value(low)) < np.abs(value(high)), low, high)
    columns = at(t)
    free, forced = columns[..., :-1], columns[..., -1]
    weights = np.linalg.pinv(free[:, :contacts]) @ forced[:, :contacts, None]
    state = forced - (free @ weights)[..., 0]
    state[:, :contacts] = 0.0
    return t, state


def _exponential(matrix: Any) -> Any:
    """exp of each matrix, of norm about STEP at most: Taylor's series of its eighth, squared."""
    small = matrix / 8.0
    total = np.broadcast_to(np.eye(matrix.shape[-1]), matrix.shape)
    for k in range(16, 0, -1):
        total = np.eye(matrix.shape[-1]) + small @ total / k
    for _ in range(3):
        total = total @ total
    return total
