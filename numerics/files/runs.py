"""Runs as labelled data: an xarray Dataset with units and attributes; netCDF in and out.

Dimensions are ``time`` (rows kept), ``snapshot_time`` and ``xi`` (the free nodes; the driven end,
ξ = 0, is the series Z). Everything is nondimensional: each variable's ``long_name`` names the scale
it was divided by. Files are sealed (:mod:`numerics.files.sealed`), equal runs give equal bytes.
"""

from __future__ import annotations

import io
import json
import warnings
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from numerics.errors import FileError, InputError, MissingPackageError
from numerics.files.sealed import (
    Specification,
    differences,
    is_there,
    not_written_here,
    read_sealed,
    release,
    specification,
    write_sealed,
)
from numerics.simulation.contact import Scheme
from numerics.simulation.observables import Column
from numerics.simulation.run import Run

if TYPE_CHECKING:
    from xarray import Dataset

KIND = "ropewave run, version 1"

_SPECIFICATION = "specification"
_SERIES = {
    Column.CONTACT: ("contact_point", "contact point x_c/x_0"),
    Column.FORCE: ("contact_force", "point force at the contact point, P x_0/(T Z_0)"),
    Column.BUMP: ("bump", "largest height beyond the contact point, w/Z_0"),
    Column.BUMP_AT: ("bump_at", "place of the largest height beyond the contact point, x/x_0"),
    Column.GAP: ("gap", "smallest local minimum of the height before the contact point, w/Z_0"),
    Column.GAP_AT: ("gap_at", "place of the smallest local minimum of the height, x/x_0"),
    Column.ENERGY: ("energy", "energy of the rope, E x_0/(T Z_0^2)"),
    Column.WORK: ("work", "work of the driven end since the start, over T Z_0^2/x_0"),
    Column.DAMPED: ("damped", "energy that damping took since the start, over T Z_0^2/x_0"),
    Column.LOST: ("lost", "energy that contact took since the start, over T Z_0^2/x_0"),
    Column.UNEXPLAINED: ("unexplained", "change of energy in a step left over, over T Z_0^2/x_0"),
    Column.ROUNDS: ("rounds", "rounds of the active-set iteration in a step"),
    Column.LOWEST: ("lowest", "smallest height of all nodes, w/Z_0"),
    Column.REACTION: ("reaction", "smallest reaction of the ground, over T Z_0/x_0^2"),
}
_TIME = "time c t/x_0"
_FRAME = ("snapshot_time", "xi")
_LAYOUT = {
    "time": (("time",), "f"),
    "snapshot_time": (_FRAME[:1], "f"),
    "xi": (_FRAME[1:], "f"),
    "W": (_FRAME, "f"),
    "V": (_FRAME, "f"),
    "held": (_FRAME, "b"),
    "Z_snapshot": (_FRAME[:1], "f"),
    "Z": (("time",), "f"),
    "W_end": (_FRAME[1:], "f"),
    "V_end": (_FRAME[1:], "f"),
    "held_end": (_FRAME[1:], "b"),
    **{name: (("time",), "f") for name, _ in _SERIES.values()},
    "rounds": (("time",), "i"),
}
"""Dimensions and kind of type of every variable."""
_MISSING = ("contact_point", "contact_force", "bump", "bump_at", "gap", "gap_at", "reaction")
"""Those that are NaN, or infinite, where there is no contact, wave or minimum."""
_NUMBERS = ("final_energy", "final_work", "final_damped", "final_lost", "largest_unexplained")
# Deflate makes nothing smaller than this part of it.
_DEFLATE = 1032


def dataset(run: Run) -> Dataset:
    """A run as an xarray Dataset; the arrays are the run's own.

    Variables: W, V and ``held`` (the contact set) over (snapshot_time, xi); Z_snapshot over
    snapshot_time; Z and every :class:`~numerics.simulation.observables.Column` over time, as
    ``contact_point``, ``contact_force``, ``bump``, …; W_end, V_end, held_end over xi, the state at
    the end. The attributes hold every parameter, the energies at the end and the residuals.

    Raises
    ------
    MissingPackageError
        xarray is not installed.

    Examples
    --------
    >>> from numerics.simulation.run import simulate
    >>> from numerics.problems.drive import ramped_cosine
    >>> from numerics.problems.problem import RopeProblem
    >>> drive = ramped_cosine(2.5, 0.05, periods=5)
    >>> run = simulate(RopeProblem(0.01, drive), 6 * drive.period, snapshots=drive.period / 8)
    >>> data = dataset(run)
    >>> data.W.dims, data.W.shape, data.sizes["time"]
    (('snapshot_time', 'xi'), (49, 799), 252)
    >>> data.contact_point.long_name, data.contact_point.units, data.beta
    ('contact point x_c/x_0', '1', 0.01)
    """
    xarray = _xarray()
    height = run.problem.drive.height
    frame = _FRAME
    staggered = " half a time step earlier" if run.scheme is Scheme.VERLET else ""
    speed = f"vertical velocity over c Z_0/x_0{staggered}"
    on_ground = "node held by the ground (the contact set)"
    variables = {
        "W": (frame, run.heights, "height w/Z_0"),
        "V": (frame, run.velocities, speed),
        "held": (frame, run.held, on_ground),
        "Z_snapshot": (frame[:1], height(run.snapshot_times), "height of the driven end, w/Z_0"),
        "Z": (("time",), height(run.times), "height of the driven end, w/Z_0"),
        "W_end": (frame[1:], run.end.height, "height at the end of the run, w/Z_0"),
        "V_end": (frame[1:], run.end.velocity, f"at the end of the run: {speed}"),
        "held_end": (frame[1:], run.end.active, f"at the end of the run: {on_ground}"),
    }
    for column, (name, meaning) in _SERIES.items():
        values = run.column(column)
        counts = column is Column.ROUNDS
        variables[name] = (("time",), values.astype("i4") if counts else values, meaning)
    coordinates = {
        "time": (("time",), run.times, _TIME),
        "snapshot_time": (frame[:1], run.snapshot_times, _TIME),
        "xi": (frame[1:], run.positions, "distance from the driven end, x/x_0"),
    }
    return xarray.Dataset(
        {name: _variable(*entry) for name, entry in variables.items()},
        {name: _variable(*entry) for name, entry in coordinates.items()},
        _attributes(run),
    )


def save(run: Run | Dataset, path: Path | str, force: bool = False) -> None:
    """Write a run, or the Dataset of one, as a compressed netCDF file, whole or not at all.

    Parameters
    ----------
    run
        A Dataset may have got further variables and attributes.
    path
        A file of the same specification is replaced, if it holds no longer run.
    force
        Replace any other file too.

    Raises
    ------
    FileError
        There is a file that is not a run, is damaged, is of another specification or longer; or
        the place cannot be written.
    InputError
        A Dataset that did not come from here.
    MissingPackageError
        xarray, h5netcdf or h5py is not installed.

    Examples
    --------
    >>> import tempfile
    >>> from numerics.simulation.run import simulate
    >>> from numerics.problems.drive import ramped_cosine
    >>> from numerics.problems.problem import RopeProblem
    >>> run = simulate(RopeProblem(0.01, ramped_cosine(2.5, 0.05, 5)), 15.0)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save(run, Path(folder) / "run.nc")
    ...     again = load(Path(folder) / "run.nc")
    >>> again.identical(dataset(run))
    True
    """
    _netcdf()
    data = dataset(run) if isinstance(run, Run) else run
    path = Path(path)
    what = _foreign(data) or _impossible(data)
    if what:
        raise InputError(
            f"this is no Dataset of a run: {what}. Save a Run, or what dataset() made of one; for "
            "other data there is Dataset.to_netcdf"
        )
    if is_there(path) and not force:
        check_replaceable(path, json.loads(data.attrs[_SPECIFICATION]), data.attrs["end_time"])
    write_sealed(path, KIND, _netcdf_bytes(data))


def _netcdf_bytes(data: Dataset) -> bytes:
    """The file in memory: HDF5 ends the process when a disk that it writes to is full."""
    import h5netcdf
    from xarray.backends import H5NetCDFStore

    packed = {"zlib": True, "complevel": 4, "shuffle": True}
    # Without NaN no fill value: coordinates and flags have no missing values.
    whole = {"_FillValue": None}
    encoding: dict[Any, Any] = {
        name: packed | ({} if np.issubdtype(value.dtype, np.floating) else whole)
        for name, value in data.data_vars.items()
        if value.ndim and value.dtype.kind in "fiub"
    }
    encoding |= dict.fromkeys(data.coords, whole)
    content = io.BytesIO()
    with h5netcdf.File(content, "w") as file:
        data.dump_to_store(H5NetCDFStore(file), encoding=encoding)
    return content.getvalue()


def load(path: Path | str) -> Dataset:
    """Read a saved run, all of it, after checking that it is what was written.

    Raises
    ------
    FileError
        The file is missing, damaged, truncated, or not one that :func:`save` wrote.
    MissingPackageError
        xarray, h5netcdf or h5py is not installed.
    """
    xarray = _netcdf()
    path = Path(path)
    content = read_sealed(path, KIND)
    try:
        with (
            warnings.catch_warnings(action="ignore"),
            xarray.open_dataset(io.BytesIO(content), engine="h5netcdf") as lazy,
        ):
            what: str | Exception = _foreign(lazy)
            if not what and lazy.nbytes > _DEFLATE * len(content):
                what = f"it would unpack to {lazy.nbytes} bytes"
            what = what or _impossible(lazy.load())
    except Exception as error:  # of HDF5 and xarray, in bytes that are not theirs: any
        what = error
    if what:
        raise not_written_here(path, KIND, what)
    data: Dataset = lazy
    return data


def _foreign(data: Dataset) -> str:
    """What of a run's layout is missing or otherwise, in words, or nothing; no values are read."""
    for name, (dims, kind) in _LAYOUT.items():
        if name not in data.variables:
            return f"{name} is missing"
        found = data.variables[name]
        if found.dims != dims or found.dtype.kind != kind:
            return f"{name} is {found.dtype} over {found.dims}, not {kind!r} over {dims}"
    try:
        specified = json.loads(data.attrs[_SPECIFICATION])
        parameters = {name: value for name, value in specified.items() if value is not None}
        numbers = [float(data.attrs[name]) for name in (*_NUMBERS, "end_time")]
        for name, value in parameters.items():
            if data.attrs[name] != value:
                return f"{name} = {data.attrs[name]} there, {value} in its specification"
    except (KeyError, TypeError, ValueError, AttributeError, RecursionError) as error:
        return f"of its attributes, {type(error).__name__}: {error}"
    if not np.isfinite(numbers).all():
        return f"{(*_NUMBERS, 'end_time')} = {numbers}"
    return ""


def _impossible(data: Dataset) -> str:
    """Which values are none of a run, in words, or nothing."""
    for name in _LAYOUT:
        values = data.variables[name].values
        if values.dtype.kind == "f" and name not in _MISSING and not np.isfinite(values).all():
            return f"{name} holds {values[~np.isfinite(values)][0]}"
    for name in ("time", "snapshot_time", "xi"):
        values = data.variables[name].values
        if (values < 0).any() or (np.diff(values) <= 0).any():
            return f"{name} does not increase"
    return ""


def _variable(
    dims: tuple[str, ...], values: Any, meaning: str
) -> tuple[tuple[str, ...], Any, dict[str, str]]:
    return dims, values, {"units": "1", "long_name": meaning}


def _attributes(run: Run) -> dict[str, str | float]:
    """Plain numbers and words; what there is not (Ω of a drive without one) is left out."""
    parameters = specification(run)
    energy, work, damped, lost = (float(value) for value in run.ledger)
    return {
        "title": "a rope in contact with the ground",
        "Conventions": "CF-1.10",
        "source": f"ropewave {release()}",
        "comment": "nondimensional: x_0^2 = 2 T Z_0/(rho g), c^2 = T/rho, beta = B/(T x_0^2)",
        **{name: value for name, value in parameters.items() if value is not None},
        "end_time": float(run.end_time),
        "final_energy": energy,
        "final_work": work,
        "final_damped": damped,
        "final_lost": lost,
        "largest_unexplained": float(run.unexplained),
        "smallest_height": float(run.lowest),
        "smallest_reaction": float(run.reaction),
        _SPECIFICATION: json.dumps(parameters),
    }


def check_replaceable(path: Path, wanted: Specification, end_time: float) -> None:
    """That the run in a file is the one specified and no longer than to ``end_time``.

    Raises
    ------
    FileError
        It is another or a longer run, damaged, or no run.
    """
    remedy = "choose another name, or delete it (in Python: force=True)"
    try:
        attributes = load(path).attrs
    except FileError as error:
        raise FileError(f"{error}; {remedy}") from error
    what = differences(json.loads(attributes[_SPECIFICATION]), wanted)
    if what:
        raise FileError(f"{path} holds another run: {what}. It is left as it is; {remedy}")
    if attributes["end_time"] > end_time * (1 + 1e-9):
        raise FileError(
            f"{path} holds this run up to tau = {attributes['end_time']:.6g}, longer than to "
            f"{end_time:.6g}. It is left as it is; {remedy}"
        )


def _xarray() -> ModuleType:
    try:
        import xarray
    except ImportError as error:
        raise _missing(error) from error
    return xarray


def _netcdf() -> ModuleType:
    xarray = _xarray()
    try:
        import h5netcdf
        import h5py  # noqa: F401  h5netcdf comes without it
    except ImportError as error:
        raise _missing(error) from error
    del h5netcdf
    return xarray


def _missing(error: ImportError) -> MissingPackageError:
    return MissingPackageError(
        f"{error.name} is needed for Datasets and netCDF files; pip install 'ropewave[sim]'"
    )
