r"""Where the exact string's contact point first reaches the wave speed.

ξ_c′ = −1 where D_{k+1} = dt_{k+1}/dt_0 = 0 on the way from t_k. The departures, ordered by
s = t_0 + 2ak, are searched for the first zero of D. Two neighbouring zeros can hide between two
labels, so the local *minima* of D are followed into the gaps between labels; the zero is then the
first one to the left of the first minimum that is not positive. What a grid of labels can miss is a
minimum that does not show on it at all: hence the doubling in ``exact_string_motion``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from numerics.exact_string.orbits import Array, ReturnMap


@dataclass(frozen=True)
class SonicContact:
    """The first instant at which the contact point moves as fast as waves do, ξ_c′ = −1.

    Attributes
    ----------
    time, place
        τ* and ξ_c*.
    bracket
        Two times around τ*; at the first |ξ_c′| < 1 still.
    label, returns
        t_0 and k of the characteristic that leaves ξ = 0 and meets ξ_c* at τ*; D_{k+1} = 0.
    monotone_until
        τ*, or the earlier time from which on the profile may fail to be monotone (on the labels'
        grid): a drive so violent may bring the string down in front of the contact point.
    """

    time: float
    place: float
    bracket: tuple[float, float]
    label: float
    returns: int
    monotone_until: float


@dataclass(frozen=True)
class Nodes:
    """Departures in order: k, label, and a value that increases along them, t_k or the midpoint."""

    returns: NDArray[np.int64]
    labels: Array
    values: Array


@dataclass(frozen=True)
class Search:
    """What one grid of labels gives: the zero, the least D, and brackets for inversions."""

    sonic: SonicContact | None
    least_stretch: float
    departures: Nodes
    contacts: Nodes

    def change(self, other: Search) -> float:
        """The difference of the two sonic times, or of the least D where there are none."""
        if self.sonic is not None and other.sonic is not None:
            return abs(self.sonic.time - other.sonic.time)
        if self.sonic is None and other.sonic is None:
            return abs(self.least_stretch - other.least_stretch)
        return math.inf


def search(the_map: ReturnMap, until: float, count: int) -> Search:
    """Follow ``count`` labels per 2a up to ``until`` and look for D = 0."""
    labels = the_map.reach * (np.arange(1, count + 1) / count - 1)
    times, stretches = (rows.ravel() for rows in the_map.table(labels, until))
    middles = (times[:-count] + times[count:]) / 2
    late = np.flatnonzero(middles > until)
    size = len(times) if late.size == 0 else count + int(late[0]) + 1
    cell, bracket, least = _first_zero(the_map, labels, stretches[:size])
    end = size if cell is None else cell
    returns = np.arange(end) // count
    departures = Nodes(returns, np.tile(labels, len(returns) // count + 1)[:end], times[:end])
    inner = end - count
    contacts = Nodes(departures.returns[:inner], departures.labels[:inner], middles[:inner])
    if cell is None:
        return Search(None, least, departures, contacts)
    sonic = _sonic(the_map, labels, cell, bracket)
    departures = _extend(departures, cell // count, bracket[0], the_map, half=False)
    contacts = _extend(contacts, cell // count - 1, bracket[0], the_map, half=True)
    return Search(sonic if sonic.time <= until else None, least, departures, contacts)


def _first_zero(
    the_map: ReturnMap, labels: Array, stretches: Array
) -> tuple[int | None, tuple[float, float], float]:
    """The gap between labels with the first zero of D, the zero's bracket, and the least D.

    Gap i ends at node i and starts one label before, within the same return.
    """
    count = len(labels)
    width = the_map.reach / count
    down = np.flatnonzero(stretches <= 0)
    size = len(stretches) if down.size == 0 else int(down[0])
    seen = stretches[:size]
    before, after = np.r_[np.inf, seen[:-1]], np.r_[seen[1:], np.inf]
    # A parabola through three labels dips below the middle one by at most 1/8 of the larger step
    # to its neighbours: only minima that a dip eight times that could bring to zero are followed.
    rise = (
        np.fmax(np.where(np.isinf(before), 0, before), np.where(np.isinf(after), 0, after)) - seen
    )
    deep = (seen <= rise) | (seen == seen.min())
    minima = np.flatnonzero((seen <= before) & (seen <= after) & deep)
    gaps = np.unique(np.r_[minima, minima + 1])
    gaps = gaps[(gaps >= count) & (gaps < size)]
    ends = labels[gaps % count]
    places, lowest = the_map.lowest_stretch(gaps // count, ends - width, ends)
    least = min(float(seen.min()), float(lowest.min(initial=math.inf)))
    dips = np.flatnonzero(lowest <= 0)
    if dips.size:
        cell, high = int(gaps[dips[0]]), float(places[dips[0]])
    elif down.size:
        cell, high = size, float(labels[size % count])
    else:
        return None, (math.nan, math.nan), least
    low = float(labels[cell % count]) - width
    return cell, the_map.first_zero(cell // count, low, high), min(least, 0.0)


def _sonic(
    the_map: ReturnMap, labels: Array, cell: int, bracket: tuple[float, float]
) -> SonicContact:
    count = len(labels)
    returns = cell // count - 1
    around = the_map.orbit(np.array(returns), np.array(bracket))
    before, after = the_map.midpoint(around).tolist()
    # All characteristics on the string at that moment: departures from t_k to τ*.
    follow = np.arange(cell - count, cell + 1)
    behind = the_map.orbit(follow // count, labels[follow % count])
    second = the_map.midpoint(behind)[behind.time <= after]
    return SonicContact(
        time=after,
        place=float(the_map.contact(around)[1]),
        bracket=(before, after),
        label=bracket[1],
        returns=returns,
        monotone_until=min(after, float(second.min(initial=math.inf))),
    )


def _extend(nodes: Nodes, returns: int, label: float, the_map: ReturnMap, half: bool) -> Nodes:
    """One more node, the last before the zero of D."""
    orbit = the_map.orbit(np.array(returns), np.array([label]))
    value = the_map.midpoint(orbit) if half else orbit.time
    return Nodes(
        np.r_[nodes.returns, returns],
        np.r_[nodes.labels, label],
        np.r_[nodes.values, np.maximum(value, nodes.values[-1])],
    )
