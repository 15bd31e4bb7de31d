"""The forced rope in PyElastica: a Cosserat rod, position Verlet, ``RodPlaneContact``.

The rod must be given what the rope has not, extension, shear and rotary inertia, and they limit
the step. EA = GA = ``rigid`` β/dx², so that T/EA and T/GA fall like dx²; the links have the rotary
inertia of rigid links, ρdx²/12 per length, since that of a real section would be far smaller and
its shear vibrations too fast to step over. The plane acts from 10⁻⁴ length units above itself, an
absolute number that is set to zero here. The far end is pulled, not held.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tests.benchmarks.forced_rope import (
    BETA,
    GROUND,
    LENGTH,
    SLOPE,
    Outcome,
    contact_of,
    driven,
    need,
    profile,
    steps_in_sample,
    timed,
)

X, Y, Z = np.eye(3)


def pyelastica(
    dx: float, ground: float = GROUND, rigid: float = 12.0, slope: float = SLOPE
) -> Outcome:
    """One run with spacing dx; LENGTH/dx is rounded."""
    elastica = need("elastica", "pyelastica")
    n = round(LENGTH / dx)
    dx = LENGTH / n
    stiffness, spring = rigid * BETA / dx**2, ground * BETA / dx**4
    rod = _rod(elastica, n, stiffness, slope)
    assembly = _assembly(elastica, rod, spring, slope)
    fastest = math.sqrt(16 * stiffness / dx**2 + 48 * BETA / dx**4 + spring)
    steps, dt = steps_in_sample(0.9 * 2 / fastest)
    stepper, clock = elastica.PositionVerlet(), [np.float64(0.0)]
    stepper.step(assembly, clock[0], 1e-12)  # compiles

    def advance() -> None:
        for _ in range(steps):
            clock[0] = stepper.step(assembly, clock[0], dt)

    def look() -> float:
        return contact_of(rod.position_collection[0], rod.position_collection[2] / slope)

    return Outcome("PyElastica", n + 1, dt, *timed(advance, look))


def _rod(elastica: Any, n: int, stiffness: float, slope: float) -> Any:
    """The rod under unit tension, stretched to its initial place."""
    along = np.linspace(0.0, LENGTH, n + 1)
    height = slope * profile(along, 0.0)
    # Links of equal length, to O(slope⁴): unequal ones would start with unequal tension.
    across = np.sqrt((LENGTH / n) ** 2 - np.diff(height) ** 2)
    position = np.array([np.concatenate([[0.0], np.cumsum(across)]), 0 * along, height])
    links = np.diff(position)
    directors = np.zeros((3, 3, n))
    directors[0, 1] = 1.0
    directors[2] = links / np.linalg.norm(links, axis=0)
    directors[1] = np.cross(directors[2].T, directors[0].T).T
    rod = elastica.CosseratRod.straight_rod(
        n, 0 * X, X, Y, LENGTH, 1.0, 1.0,
        youngs_modulus=1.0, position=position, directors=directors,
    )  # fmt: skip
    dx, stretch = LENGTH / n, 1 + 1 / stiffness
    inertia = dx**3 / 12
    rod.rest_lengths[:] = rod.rest_voronoi_lengths[:] = dx / stretch
    rod.volume[:] = math.pi * 1e-18 * dx  # a radius of 1e-9: the centreline meets the plane
    rod.mass[:] = dx
    rod.mass[[0, -1]] /= 2
    rod.mass_second_moment_of_inertia[:] = inertia * np.eye(3)[:, :, None]
    rod.inv_mass_second_moment_of_inertia[:] = np.eye(3)[:, :, None] / inertia
    rod.bend_matrix[:] = BETA * stretch**2 * np.eye(3)[:, :, None]
    rod.shear_matrix[:] = stiffness * np.eye(3)[:, :, None]
    return rod


def _assembly(elastica: Any, rod: Any, spring: float, slope: float) -> Any:
    """Rod, plane, weight, pull and drive."""

    class Driven(elastica.ConstraintBase):
        def constrain_values(self, system: Any, time: float) -> None:
            system.position_collection[:, 0] = slope * driven(time)[0] * Z

        def constrain_rates(self, system: Any, time: float) -> None:
            system.velocity_collection[:, 0] = slope * driven(time)[1] * Z

    class SharpPlane(elastica.RodPlaneContact):
        def __init__(self, k: float, nu: float) -> None:
            super().__init__(k, nu)
            self.surface_tol = np.float64(0.0)

    parts = (
        elastica.BaseSystemCollection,
        elastica.Constraints,
        elastica.Forcing,
        elastica.Contact,
    )
    assembly = type("Assembly", parts, {})()
    plane = elastica.Plane(0 * X, Z)
    assembly.append(rod)
    assembly.append(plane)
    assembly.constrain(rod).using(Driven)
    assembly.add_forcing_to(rod).using(elastica.GravityForces, acc_gravity=-2 * slope * Z)
    pull = {"start_force": 0 * X, "end_force": X, "ramp_up_time": 1e-12}
    assembly.add_forcing_to(rod).using(elastica.EndpointForces, **pull)
    dx = LENGTH / rod.n_elems
    contact = {"k": spring * dx, "nu": math.sqrt(spring) * dx}
    assembly.detect_contact_between(rod, plane).using(SharpPlane, **contact)
    assembly.finalize()
    return assembly
