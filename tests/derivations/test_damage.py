"""Files that are not what was written, and sealed ones that are not true: one clear error each."""

from __future__ import annotations

import importlib.util
import io
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

from derivations import clash
from derivations.figure2 import data as figure2
from derivations.figure2.points import check_points
from numerics.errors import FileError, InputError
from numerics.files import checkpoint
from numerics.files import runs as run_files
from numerics.files.sealed import LARGEST_JSON, read_json
from numerics.problems.drive import ramped_cosine
from numerics.problems.problem import RopeProblem
from numerics.simulation.contact import Simulator
from numerics.simulation.run import follow
from numerics.simulation.semi_discrete import Grid
from numerics.sweeps.sweep import _name, _seal, sweep
from tests.damage import harm, harm_hdf5, harm_json, harm_npz, resealed, spelled, unsealed

PROBLEM = RopeProblem(0.04, ramped_cosine(2.5, 0.3, 2), damping=0.01)
GRID = Grid(0.05)
DATA = Path(__file__).parents[2] / "docs" / "figure2.json"
CASES = 30


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A checkpoint and a run."""
    folder = tmp_path_factory.mktemp("whole")
    simulator = Simulator(PROBLEM, GRID)
    run = follow(simulator, 8.0, 0.0, 0.5)
    checkpoint.save_checkpoint(simulator, folder / "state.npz")
    run_files.save(run, folder / "run.nc")
    return folder


def resume(path: Path) -> None:
    """Read it, and go on: what is read must be fit to compute with."""
    simulator = checkpoint.resume(path, PROBLEM, GRID)
    step = simulator.step
    for block in simulator.blocks(simulator.time + 2.0):
        assert np.isfinite(block.rows[:, 6:]).all()
    assert (simulator.step - step) * simulator.dt == pytest.approx(2.0)


def load(path: Path) -> None:
    data = run_files.load(path)
    assert all(np.isfinite(data[name]).all() for name in ("time", "W", "energy", "work", "V_end"))
    json.loads(data.attrs["specification"])


def read_points(path: Path) -> None:
    points, _ = figure2.read_collected(path)
    figure2.collected(points, False)


FORMATS: dict[str, tuple[str, str | None, Callable[[Path], None]]] = {
    "checkpoint": ("state.npz", checkpoint.KIND, resume),
    "run": ("run.nc", run_files.KIND, load),
    "collected": (str(DATA), None, read_points),
}


def refused(read: Callable[[], object]) -> bool:
    """Whether there was an error, which must be one line."""
    try:
        read()
    except FileError as error:
        return check_line(str(error))
    return False


def check_line(message: str) -> bool:
    assert message.count("\n") == 0
    assert len(message) < 1000
    return True


@pytest.mark.parametrize("name", FORMATS)
def test_whole_files_are_read(name: str, folder: Path) -> None:
    file, kind, read = FORMATS[name]
    path = folder / file
    read(path)
    if kind is not None:
        assert resealed(unsealed(path.read_bytes(), kind), kind) == path.read_bytes()


@pytest.mark.parametrize("name", FORMATS)
def test_changed_bytes(name: str, folder: Path, tmp_path: Path) -> None:
    file, kind, read = FORMATS[name]
    raw, chance = (folder / file).read_bytes(), Random(8)
    path, count = tmp_path / "file.json", 0
    for _ in range(CASES):
        path.write_bytes(harm(raw, chance))
        count += refused(lambda: read(path))
    # A number of a file without a seal may have become another that is possible.
    assert count == CASES if kind is not None else count > CASES / 2


@pytest.mark.slow
@pytest.mark.parametrize(("name", "change"), [("checkpoint", harm_npz), ("run", harm_hdf5)])
def test_changed_contents_with_a_new_seal(
    name: str, change: Callable[[bytes, Random], bytes], folder: Path, tmp_path: Path
) -> None:
    file, kind, read = FORMATS[name]
    assert kind is not None
    content, chance = unsealed((folder / file).read_bytes(), kind), Random(8)
    path, count = tmp_path / file, 0
    for _ in range(CASES):
        path.write_bytes(resealed(change(content, chance), kind))
        before = path.read_bytes()
        count += refused(lambda: read(path))
        assert path.read_bytes() == before
    assert count > CASES / 2


def test_changed_points(tmp_path: Path) -> None:
    content, chance, count = json.loads(DATA.read_text(encoding="utf-8")), Random(8), 0
    content["points"] = content["points"][::12]
    path = tmp_path / "points.json"
    for _ in range(4 * CASES):
        path.write_bytes(spelled(harm_json(content, chance)))
        count += refused(lambda: read_points(path))
    assert count > 2 * CASES


def _seal_of(parts: list[Any]) -> str:
    """The seal of a result; a NaN, which no sweep writes, is refused before its seal counts."""
    try:
        return _seal(*parts)
    except InputError:
        return "0" * 64


def test_changed_results_of_a_sweep(tmp_path: Path) -> None:
    """With a new seal a result is what it says; where it is used as a point it is looked at."""
    task = figure2.tasks(True)[0]
    wanted = figure2.specification(True)
    points, _ = figure2.read_collected(DATA)
    point = next(point for point in points if point["beta"] == task["beta"])
    content = {"specification": wanted, "task": task, "result": point}
    path, chance, count = tmp_path / _name(task), Random(8), 0
    for number in range(2 * CASES):
        changed = harm_json(content, chance)
        parts = [changed.get(name) for name in ("specification", "task", "result")]
        changed["seal"] = _seal_of(parts)
        raw = spelled(changed)
        path.write_bytes(harm(raw, chance) if number % 2 else raw)
        count += refused(lambda: figure2.compute(True, tmp_path, wanted=[task]))
    assert count > CASES


HOSTILE = {
    "deep": b"[" * 10**5,
    "deeper, closed": b"[" * 10**5 + b"]" * 10**5,
    "NaN": b'{"points": [NaN]}',
    "infinite": b'{"points": [1e999]}',
    "digits": b"9" * 10**6,
    "letters": b"\xff\xfe\x00",
    "nothing": b"",
}


@pytest.mark.parametrize("name", HOSTILE)
def test_json_that_is_none(name: str, tmp_path: Path) -> None:
    path = tmp_path / "points.json"
    path.write_bytes(HOSTILE[name])
    for read in (lambda: read_json(path, "Go away"), lambda: figure2.read_collected(path)):
        with pytest.raises(FileError, match=r"points.json is damaged, or no JSON file"):
            read()


def test_json_that_is_too_large(tmp_path: Path) -> None:
    path = tmp_path / "points.json"
    with path.open("wb") as stream:
        stream.truncate(LARGEST_JSON)  # a hole: no disk is filled
        stream.seek(0)
        stream.write(b"[1]")
    with pytest.raises(FileError, match="Extra data"):
        read_json(path, "")
    with path.open("r+b") as stream:
        stream.truncate(LARGEST_JSON + 1)
    with pytest.raises(FileError, match=f"more than {LARGEST_JSON} bytes"):
        read_json(path, "")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda point: point.update(beta=0.02), r"in number 2, beta is 0\.02"),
        (lambda point: point.update(beta=True), "beta is True"),
        (lambda point: point.update(omega=-2.0), r"omega is -2\.0"),
        (lambda point: point.update(omega=10.0), r"omega is 10\.0"),
        (lambda point: point.update(lower="x"), "the point is from 'x' to"),
        (lambda point: point.update(lower=point["upper"]), "no interval of amplitudes"),
        (lambda point: point.update(lower=0.0), "no interval of amplitudes"),
        (lambda point: point.update(upper=1.0), "no interval of amplitudes"),
        (lambda point: point.update(lower=0.5 * point["lower"]), "do not span the interval"),
        (lambda point: point.update(upper=1.1 * point["upper"]), "do not span the interval"),
        (lambda point: point.update(mechanism="magic"), "mechanism is 'magic'"),
        (lambda point: point.update(brackets=[]), "brackets are missing"),
        (lambda point: point.update(brackets=None), "brackets are missing"),
        (lambda point: point["brackets"].append(1), "a bracket is none"),
        (lambda point: point["brackets"][0].update(change=3), "a bracket is none"),
        (lambda point: point["brackets"][0].update(lower=-1), "the bracket 'base' is from -1"),
        (lambda point: point["brackets"][0].update(growth="x"), "growth is 'x'"),
        (lambda point: point["brackets"][0].update(growth=float("nan")), "growth is nan"),
        (lambda point: point.update(circle=[0.1, 0.2]), r"circle is \[0.1, 0.2\], with beta > 0"),
        (lambda point: point.update(beta=0.0), "circle is None"),
        (lambda point: point.update(beta=0.0, circle=[0.2, 0.1]), "circle is from 0.2 to 0.1"),
        (lambda point: point.update(beta=0.0, circle=[0.1]), r"circle is \[0.1\]"),
    ],
)
def test_points_edited_by_hand(change: Callable[[dict[str, Any]], None], message: str) -> None:
    points, _ = figure2.read_collected(DATA)
    change(points[1])
    with pytest.raises(FileError, match=message):
        check_points(points, "file")


@pytest.mark.parametrize("points", [None, [], {}, "x", [{}], [None]])
def test_points_that_are_none(points: Any) -> None:
    with pytest.raises(FileError, match=r"^file does not hold points.*Compute them anew$"):
        check_points(points, "file")


def test_a_point_given_twice() -> None:
    points, _ = figure2.read_collected(DATA)
    with pytest.raises(FileError, match="two are of the same"):
        check_points([*points, points[3]], "file")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"coarse": "x"}, "coarse = 'x'"),
        ({"coarse": True}, "coarse = True"),
        ({"specification": None}, "holds None"),
        ({"points": None}, "a list of them is missing"),
    ],
)
def test_collected_data_of_another_kind(
    changes: dict[str, Any], message: str, tmp_path: Path
) -> None:
    content = json.loads(DATA.read_text(encoding="utf-8")) | changes
    path = tmp_path / "points.json"
    path.write_bytes(spelled(content))
    with pytest.raises(FileError, match=message):
        figure2.read_collected(path)
    path.write_bytes(b"[]")
    with pytest.raises(FileError, match="is not collected data"):
        figure2.read_collected(path)


def edit(folder: Path, tmp_path: Path, **changes: Any) -> Path:
    """The checkpoint with some arrays changed, sealed anew."""
    raw = (folder / "state.npz").read_bytes()
    with np.load(io.BytesIO(raw)) as found:
        arrays = dict(found)
    for name, change in changes.items():
        arrays[name] = change(arrays[name].copy())
    out = io.BytesIO()
    np.savez(out, **arrays)
    path = tmp_path / "state.npz"
    path.write_bytes(resealed(out.getvalue(), checkpoint.KIND))
    return path


def put(index: int, value: float) -> Callable[[np.ndarray], np.ndarray]:
    def change(array: np.ndarray) -> np.ndarray:
        array[index] = value
        return array

    return change


ON_GROUND = 100


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"height": lambda a: a[:5]}, r"height is float64 of shape \(5,\), not float64 of \(159,"),
        ({"velocity": lambda a: a[:-1]}, "velocity is float64 of shape"),
        ({"active": lambda a: a.astype(float)}, "active is float64"),
        ({"active": lambda a: (a * np.uint8(3)).view(bool)}, "neither true nor false"),
        ({"ledger": lambda a: a[:1]}, "ledger is float64 of shape"),
        ({"worst": lambda a: a[:2]}, "worst is float64 of shape"),
        ({"drive_times": lambda a: a[:9]}, "drive_times is float64 of shape"),
        ({"drive_heights": lambda a: a[:9]}, "drive_heights is float64 of shape"),
        ({"height": lambda a: a.astype("f4")}, "height is float32"),
        ({"step": lambda a: a.astype(float)}, "step is float64"),
        ({"step": lambda a: np.array(-5)}, "step = -5"),
        ({"step": lambda a: np.array(2**53 + 1)}, "step = 9007199254740993"),
        ({"step": lambda a: a + 1}, "drive_times are not those of step 161"),
        ({"drive_times": put(7, np.nan)}, "drive_times are not those"),
        ({"drive_heights": put(7, np.nan)}, "is another motion of the same name"),
        ({"height": put(3, np.nan)}, "height holds nan"),
        ({"velocity": put(3, -np.inf)}, "velocity holds -inf"),
        ({"ledger": put(1, np.nan)}, "ledger holds nan"),
        ({"worst": put(0, -1.0)}, "the worst of its steps are -1.0"),
        ({"worst": put(0, np.inf)}, "the worst of its steps are inf"),
        ({"worst": put(0, np.nan)}, "the worst of its steps are nan"),
        ({"worst": put(1, np.nan)}, "the worst of its steps are"),
        ({"worst": put(2, -np.inf)}, "the worst of its steps are"),
        ({"height": put(3, -1e-9)}, "a height is -1e-09"),
        ({"height": put(ON_GROUND, 1e-9)}, "a node that the ground holds is above it"),
        ({"height": put(3, 1e200)}, "the energy of its state is inf"),
        ({"velocity": put(3, 1e-3)}, "the energy of its state is"),
        ({"ledger": lambda a: a * (1 + 1e-6)}, "the energy of its state is"),
        ({"ledger": put(1, 7.0)}, "does not close"),
        ({"ledger": put(2, 7.0)}, "does not close"),
        ({"ledger": put(3, 7.0)}, "does not close"),
        ({"specification": lambda a: np.array("[1]")}, "its specification is no object"),
        ({"specification": lambda a: np.array("[" * 10**5)}, "ropewave has written"),
    ],
)
def test_checkpoints_with_a_right_seal_and_a_false_content(
    changes: dict[str, Any], message: str, folder: Path, tmp_path: Path
) -> None:
    path = edit(folder, tmp_path, **changes)
    before = path.read_bytes()
    with pytest.raises(FileError, match=message):
        checkpoint.resume(path, PROBLEM, GRID)
    assert path.read_bytes() == before


def test_a_checkpoint_that_is_only_sealed_anew_is_read(folder: Path, tmp_path: Path) -> None:
    resume(edit(folder, tmp_path, height=lambda a: a))


def test_a_device_is_no_file() -> None:
    for read in (
        lambda: checkpoint.start_or_resume("/dev/zero", PROBLEM, GRID),
        lambda: run_files.load("/dev/zero"),
        lambda: figure2.read_collected(Path("/dev/zero")),
    ):
        with pytest.raises(FileError, match="cannot read /dev/zero: it is not an ordinary file"):
            read()


def test_a_folder_of_another_sweep_says_so(tmp_path: Path) -> None:
    shutil.copy(DATA, tmp_path / _name({"x": 1}))
    with pytest.raises(FileError, match="is damaged"):
        sweep(lambda task: task, [{"x": 1}], tmp_path)


def test_another_package_in_other_letters(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "asymptotics" / "__init__.py"
    file.parent.mkdir()
    file.write_bytes(b"# r\xe9sum\xe9\n")
    spec = importlib.util.spec_from_file_location("asymptotics", file)
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: spec)
    monkeypatch.setattr(clash, "__file__", str(tmp_path / "derivations" / "clash.py"))
    assert str(clash.find_clash()).startswith("another package has overwritten")
