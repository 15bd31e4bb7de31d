"""Runs as Datasets and netCDF files: nothing lost, everything labelled, nothing overwritten."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray

from numerics.errors import FileError, InputError, MissingPackageError
from numerics.files.checkpoint import save_checkpoint
from numerics.files.runs import dataset, load, save
from numerics.files.sealed import replace_file
from numerics.problems.drive import at_rest, cosine
from numerics.problems.problem import DrivenEnd, RopeProblem
from numerics.simulation.contact import Simulator
from numerics.simulation.observables import Column
from numerics.simulation.run import Run, simulate
from numerics.simulation.semi_discrete import Grid

PROBLEM = RopeProblem(0.01, cosine(3.5, 0.5), DrivenEnd.CLAMPED, damping=0.02, restitution=0.25)
GRID = Grid(0.025, length=7.0, sponge=2.5, strength=2.0)


@pytest.fixture(scope="module")
def run() -> Run:
    return simulate(PROBLEM, 12.0, GRID, 0.02, record_from=0.0, snapshots=0.5)


@pytest.fixture(scope="module")
def written(run: Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("runs") / "run.nc"
    save(run, path)
    return path


@pytest.fixture
def kept(written: Path, tmp_path: Path) -> Iterator[Path]:
    """A copy of the file, which must be the same afterwards, and alone."""
    path = tmp_path / "run.nc"
    shutil.copy(written, path)
    yield path
    assert path.read_bytes() == written.read_bytes()
    assert list(tmp_path.iterdir()) == [path]


def test_every_array_of_the_run_is_in_the_file(run: Run, written: Path) -> None:
    data = load(written)
    assert data.W.dims == data.held.dims == ("snapshot_time", "xi")
    assert dict(data.sizes) == {"time": 600, "snapshot_time": 25, "xi": 279}
    pairs = {
        "W": run.heights,
        "V": run.velocities,
        "held": run.held,
        "Z": PROBLEM.drive.height(run.times),
        "Z_snapshot": PROBLEM.drive.height(run.snapshot_times),
        "W_end": run.end.height,
        "V_end": run.end.velocity,
        "held_end": run.end.active,
        "time": run.times,
        "snapshot_time": run.snapshot_times,
        "xi": run.positions,
    }
    for name, values in pairs.items():
        assert data[name].dtype == values.dtype, name
        assert data[name].values.tobytes() == values.tobytes(), name
        assert np.count_nonzero(values) > 20, name
    columns = "contact_point contact_force bump bump_at gap gap_at energy work damped lost "
    names = (columns + "unexplained rounds lowest reaction").split()
    assert len(names) == len(Column)
    for column, name in zip(Column, names, strict=True):
        np.testing.assert_array_equal(data[name].values, run.rows[:, column], name)
        assert data[name].dims == ("time",)
    assert set(data.variables) == set(pairs) | set(names)
    # Minima and waves come and go: not all of it is missing, nor all there.
    assert 0 < int(data.gap.isnull().sum()) < 600
    assert 0 < int(data.bump_at.isnull().sum()) < 600
    assert float(data.bump.max()) > 0.05


def test_every_variable_has_units_and_a_name(written: Path) -> None:
    data = load(written)
    names = [variable.attrs["long_name"] for variable in data.variables.values()]
    assert all(variable.attrs["units"] == "1" for variable in data.variables.values())
    # The two times and the two series of Z share theirs.
    assert len(set(names)) == len(names) - 2
    assert data.contact_point.long_name == "contact point x_c/x_0"


def test_every_parameter_is_an_attribute(run: Run, written: Path) -> None:
    attributes = load(written).attrs
    expected = {
        "beta": 0.01,
        "driven_end": "clamped",
        "damping": 0.02,
        "restitution": 0.25,
        "drive": "cosine 3.5 0.5",
        "omega": 3.5,
        "dx": 0.025,
        "length": 7.0,
        "sponge": 2.5,
        "strength": 2.0,
        "dt": 0.02,
        "scheme": "trapezoidal",
        "final_energy": run.ledger[0],
        "final_work": run.ledger[1],
        "final_damped": run.ledger[2],
        "final_lost": run.ledger[3],
        "largest_unexplained": run.unexplained,
        "smallest_height": run.lowest,
        "smallest_reaction": run.reaction,
    }
    assert {name: attributes[name] for name in expected} == expected
    specification = json.loads(attributes["specification"])
    assert specification.items() <= expected.items()
    assert len(specification) == 12
    assert attributes["source"].startswith("ropewave ")
    # The ledger closes, which it would not with two of its entries exchanged.
    change = run.ledger[0] - run.rows[0, Column.ENERGY]
    first = run.rows[0, [Column.WORK, Column.DAMPED, Column.LOST]]
    explained = (run.ledger[1:] - first) @ [1, -1, -1]
    assert abs(change - explained) <= 600 * run.unexplained
    assert min(run.ledger) > 0.01


def test_a_run_without_rows_or_snapshots(tmp_path: Path) -> None:
    run = simulate(RopeProblem(0.01, at_rest()), 1.0, Grid(0.025), scheme="verlet", record_from=2.0)
    save(run, tmp_path / "run.nc")
    data = load(tmp_path / "run.nc")
    assert data.identical(dataset(run))
    assert "omega" not in data.attrs
    assert json.loads(data.specification)["omega"] is None
    assert dict(data.sizes) == {"snapshot_time": 0, "xi": 319, "time": 0}
    assert data.W_end.values.tobytes() == run.end.height.tobytes()
    assert "half a time step earlier" in data.V.long_name


def test_equal_runs_give_equal_bytes(run: Run, written: Path, tmp_path: Path) -> None:
    before = written.stat().st_mtime
    while time.time() < before + 1.1:  # the clock that HDF5 might write down counts seconds
        time.sleep(0.05)
    save(dataset(run), tmp_path / "again.nc")
    assert (tmp_path / "again.nc").read_bytes() == written.read_bytes()


def test_other_readers_see_the_same_compressed(run: Run, written: Path) -> None:
    with xarray.open_dataset(written, engine="h5netcdf") as data:
        assert data.load().identical(dataset(run))
    with h5py.File(written) as file:
        assert file["W"].id.get_storage_size() < 0.6 * run.heights.nbytes


def test_additions_are_kept(run: Run, tmp_path: Path) -> None:
    data = dataset(run).assign(note=("xi", np.arange(279)), word=((), "text"))
    data.attrs["remark"] = "ε grows"
    save(data, tmp_path / "run.nc")
    assert load(tmp_path / "run.nc").identical(data)


def test_any_changed_byte_is_noticed(written: Path, tmp_path: Path) -> None:
    raw, path = written.read_bytes(), tmp_path / "run.nc"
    places = [*range(0, len(raw), len(raw) // 150), *range(len(raw) - 95, len(raw))]
    for place in places:
        path.write_bytes(raw[:place] + bytes([raw[place] ^ 4]) + raw[place + 1 :])
        with pytest.raises(FileError, match=r"damaged|is not a .* or it is truncated"):
            load(path)


@pytest.mark.parametrize("length", [0, 10, 60_000, -1])
def test_truncated_files_are_refused(length: int, run: Run, written: Path, tmp_path: Path) -> None:
    path = tmp_path / "run.nc"
    path.write_bytes(written.read_bytes()[:length])
    before = path.read_bytes()
    with pytest.raises(FileError, match="truncated"):
        load(path)
    with pytest.raises(FileError, match=r"truncated.*force=True"):
        save(run, path)
    assert path.read_bytes() == before
    save(run, path, force=True)
    assert path.read_bytes() == written.read_bytes()


def test_foreign_and_missing_files_are_refused(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "file"
    for write in (
        lambda: path.write_text("notes\n" * 50),
        lambda: dataset(run).to_netcdf(path, engine="h5netcdf"),
        lambda: replace_file(path, b"notes"),
        lambda: save_checkpoint(Simulator(PROBLEM, GRID), path),
    ):
        path.unlink(missing_ok=True)
        write()
        before = path.read_bytes()
        with pytest.raises(FileError, match="is not a ropewave run"):
            load(path)
        with pytest.raises(FileError, match=r"is not a ropewave run.*force=True"):
            save(run, path)
        assert path.read_bytes() == before
    with pytest.raises(FileError, match=r"cannot read .*No such file"):
        load(tmp_path / "none.nc")
    with pytest.raises(FileError, match=r"cannot write .*No such file"):
        save(run, tmp_path / "none" / "run.nc")
    with pytest.raises(InputError, match="this is no Dataset of a run: time is missing"):
        save(xarray.Dataset({"a": 1}), tmp_path / "a.nc")


def test_another_run_does_not_replace_it(kept: Path) -> None:
    other = simulate(replace(PROBLEM, beta=0.02), 1.0, GRID, 0.02)
    with pytest.raises(FileError, match=r"another run: beta = 0.01 there, 0.02 here\..*force=True"):
        save(other, kept)


@pytest.mark.slow
def test_a_longer_run_of_the_same_specification_replaces_it(kept: Path, run: Run) -> None:
    short = simulate(PROBLEM, 2.0, GRID, 0.02)
    with pytest.raises(FileError, match=r"up to tau = 12, longer than to 2.*left as it is"):
        save(short, kept)
    save(short, kept, force=True)
    assert load(kept).sizes["snapshot_time"] == 0
    save(run, kept)
    assert load(kept).attrs["end_time"] == 12.0


def test_a_failed_write_leaves_the_old_file(
    kept: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(handle: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(FileError, match=r"cannot write .*run.nc: No space left"):
        save(run, kept)


@pytest.mark.parametrize("package", ["xarray", "h5netcdf", "h5py"])
def test_a_missing_package_is_named(
    package: str, kept: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    for attempt in lambda: save(run, kept), lambda: load(kept):
        with pytest.raises(MissingPackageError, match=rf"{package}.*pip install 'ropewave\[sim\]'"):
            attempt()


@pytest.mark.slow
def test_xarray_is_imported_when_it_is_needed() -> None:
    code = "import sys, numerics.files.runs; print({'xarray', 'h5py'} & set(sys.modules))"
    root = Path(__file__).parents[2]
    done = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True)
    assert done.stdout.strip() == "set()", done.stderr
