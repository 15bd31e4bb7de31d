"""The forced rope in MoorDyn-C: lumped masses, seabed springs, RK4.

Without damping RK2, MoorDyn's default, grows at any step; RK4 is stable, and none of the other
schemes was cheaper. The driven end is given anew at each step: MoorDyn extends its motion linearly
in between, and every correction is a kick that rings in the rope. The solver for the initial state
does not get close enough, so the profile is written into the program's saved state. The far end is
held, so that EA = ``rigid`` T must be low: the tension varies by EA × O(SLOPE²). The unstretched
length makes it 1 with the extra length ½Z₀²∫W_ξ² ≈ ⅔ SLOPE² of the rope at rest.
"""

from __future__ import annotations

import math
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from tests.benchmarks.forced_rope import (
    BETA,
    GROUND,
    LENGTH,
    SLOPE,
    Array,
    Outcome,
    contact_of,
    driven,
    need,
    profile,
    steps_in_sample,
    timed,
)

DEPTH, DIAMETER = 10.0, 0.01

INPUT = """--- MoorDyn input ---
a rope on flat ground
--- LINE TYPES ---
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
rope {diameter} {mass} {EA} 0 {EI} 0 0 0 0
--- POINTS ---
ID Attachment X Y Z Mass Volume CdA CA
(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Coupled 0 0 {top} 0 0 0 0
2 Fixed {length} 0 -{depth} 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 rope 1 2 {unstretched} {links} -
--- OPTIONS ---
0 writeLog
1 disableOutput
{dt} dtM
RK4 tScheme
{g} g
0 rho
{depth} WtrDpth
{spring} kBot
{dashpot} cBot
0 FrictionCoefficient
1 TmaxIC
--- end ---
"""


def moordyn(
    dx: float, ground: float = GROUND, rigid: float = 30.0, slope: float = SLOPE
) -> Outcome:
    """One run with spacing dx; LENGTH/dx is rounded."""
    program = need("moordyn", "moordyn")
    n = round(LENGTH / dx)
    dx, spring = LENGTH / n, ground * BETA / dx**4
    fastest = math.hypot(4 * math.sqrt(BETA) / dx**2 + 2 / dx, math.sqrt(spring))
    fastest = max(fastest, 2 * math.sqrt(rigid) / dx)
    steps, dt = steps_in_sample(0.9 * math.sqrt(8) / fastest)
    system = _system(program, _input(n, dt, spring, rigid, slope), slope)
    line = program.GetLine(system, 1)

    def nodes() -> Array:
        return np.array([program.GetLineNodePos(line, i) for i in range(n + 1)])

    xi = np.linspace(0.0, LENGTH, n + 1)
    wanted = np.array([xi, 0 * xi, slope * profile(xi, 0.0) - DEPTH]).T
    _place(program, system, nodes()[1:-1], wanted[1:-1])
    # MoorDyn rounds positions of size DEPTH.
    if not np.allclose(nodes()[1:-1], wanted[1:-1], rtol=0, atol=1e-14 * DEPTH):
        raise AssertionError("MoorDyn did not take the initial profile")
    clock = [0.0]

    def advance() -> None:
        for _ in range(steps):
            height, velocity = driven(clock[0])
            place = [0.0, 0.0, slope * height - DEPTH]
            program.Step(system, place, [0.0, 0.0, slope * velocity], clock[0], dt)
            clock[0] += dt

    def look() -> float:
        place = nodes()
        return contact_of(place[:, 0], (place[:, 2] + DEPTH) / slope)

    outcome = Outcome("MoorDyn", n + 1, dt, *timed(advance, look))
    program.Close(system)
    return outcome


def _input(n: int, dt: float, spring: float, rigid: float, slope: float) -> str:
    stretch = 1 + 1 / rigid
    unstretched = (LENGTH + 2 / 3 * slope**2) / stretch
    return INPUT.format(
        diameter=DIAMETER,
        mass=LENGTH / unstretched,
        EA=rigid,
        EI=BETA,
        top=slope * driven(0.0)[0] - DEPTH,
        length=LENGTH,
        depth=DEPTH,
        unstretched=unstretched,
        links=n,
        dt=1.0001 * dt,  # its upper limit: the steps asked for are dt
        g=2 * slope,
        spring=spring * stretch / DIAMETER,
        dashpot=math.sqrt(spring) * stretch / DIAMETER,
    )


def _system(program: Any, text: str, slope: float) -> Any:
    with tempfile.TemporaryDirectory() as folder, _silence():
        path = Path(folder) / "rope.txt"
        path.write_text(text)
        system = program.Create(str(path))
        program.SetVerbosity(system, 2)  # warnings and errors
        program.Init(system, [0.0, 0.0, slope * driven(0.0)[0] - DEPTH], [0.0, 0.0, 0.0])
    return system


def _place(program: Any, system: Any, found: Array, wanted: Array) -> None:
    """Move the nodes by replacing their coordinates wherever the saved state has them."""
    saved = np.frombuffer(bytearray(program.Serialize(system)))
    for old, new in zip(found, wanted, strict=True):
        for place in np.flatnonzero(saved[:-2] == old[0]):
            if (saved[place : place + 3] == old).all():
                saved[place : place + 3] = new
    program.Deserialize(system, saved.tobytes())


@contextmanager
def _silence() -> Iterator[None]:
    """Send what compiled code prints nowhere."""
    sys.stdout.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)
