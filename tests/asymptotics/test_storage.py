"""Saved derivations: resumed, sealed, and refused when they are not what was written."""

from __future__ import annotations

import gzip
import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from asymptotics import Expansion, exact_string, expand, float_string, prove
from asymptotics.errors import DamagedFileError, ForeignFileError, InputError, StorageError
from asymptotics.storage import Store, derive


def orders_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_what_is_read_is_what_was_written(tmp_path: Path, sixth: Expansion) -> None:
    derive(exact_string(), 6, tmp_path)
    read, _ = Store(tmp_path, exact_string()).load(6)
    assert read.orders == sixth.orders
    assert all(proof.holds for proof in prove(read))


def test_a_later_call_continues(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    derive(exact_string(), 4, tmp_path)
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    computed: list[int] = []
    import asymptotics.expansion as engine

    original = engine._next_order

    def spy(problem, orders, towers):  # type: ignore[no-untyped-def]
        computed.append(len(orders) + 1)
        return original(problem, orders, towers)

    monkeypatch.setattr(engine, "_next_order", spy)
    reports: list[int] = []
    assert derive(exact_string(), 6, tmp_path, reports.append).order == 6
    assert computed == [5, 6]
    assert reports == [4, 5, 6]
    assert derive(exact_string(), 3, tmp_path).order == 3
    assert computed == [5, 6]
    for name, content in before.items():
        assert (tmp_path / name).read_bytes() == content


def test_a_killed_process_loses_at_most_the_order_under_way(tmp_path: Path) -> None:
    program = (
        "import sys; from pathlib import Path; from asymptotics import exact_string;"
        "from asymptotics.storage import derive; derive(exact_string(), 30, Path(sys.argv[1]))"
    )
    process = subprocess.Popen([sys.executable, "-c", program, str(tmp_path)])
    deadline = time.monotonic() + 60
    while not (tmp_path / "order-0009.json.gz").exists() and time.monotonic() < deadline:
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    saved = [path for path in tmp_path.iterdir() if path.name.startswith("order-")]
    assert len(saved) >= 9
    resumed = derive(exact_string(), 9, tmp_path)
    assert [o.contact for o in resumed.orders] == [
        o.contact for o in expand(exact_string(), 9).orders
    ]


@pytest.mark.parametrize("cut", [0, 10, 200])
def test_a_truncated_file_is_refused_and_left_alone(tmp_path: Path, cut: int) -> None:
    derive(exact_string(), 3, tmp_path)
    victim = tmp_path / "order-0002.json.gz"
    victim.write_bytes(victim.read_bytes()[:cut])
    damaged = victim.read_bytes()
    with pytest.raises(DamagedFileError, match=r"order-0002.json.gz is damaged.*move"):
        derive(exact_string(), 4, tmp_path)
    assert victim.read_bytes() == damaged
    assert len(orders_in(tmp_path)) == 3


def rewrite(path: Path, **changes: object) -> None:
    content = json.loads(gzip.decompress(path.read_bytes()))
    content.update(changes)
    path.write_bytes(gzip.compress(json.dumps(content).encode()))


def test_a_changed_number_is_refused(tmp_path: Path) -> None:
    derive(exact_string(), 3, tmp_path)
    path = tmp_path / "order-0003.json.gz"
    content = json.loads(gzip.decompress(path.read_bytes()))
    content["order"]["contact"]["1"][0] += 1
    rewrite(path, order=content["order"])
    with pytest.raises(DamagedFileError, match="its content has changed"):
        derive(exact_string(), 3, tmp_path)


def test_a_sealed_lie_is_refuted_by_the_proof(tmp_path: Path, sixth: Expansion) -> None:
    """The seal says who wrote a file, the proof whether it is true."""
    from asymptotics.cotangent import CotangentRing
    from asymptotics.proof import RefutedError

    contact = dict(sixth.contact(1))
    contact[1] = contact[1] * CotangentRing().rational(2)
    lie = Expansion(sixth.problem, (replace(sixth.orders[0], contact=contact),))
    Store(tmp_path, exact_string()).append(lie, "")
    with pytest.raises(RefutedError, match="discard it, and any saved copy"):
        prove(derive(exact_string(), 2, tmp_path))


def test_files_of_another_origin_are_refused(tmp_path: Path) -> None:
    derive(exact_string(), 2, tmp_path)
    path = tmp_path / "order-0001.json.gz"
    whole = path.read_bytes()
    rewrite(path, problem="beam")
    with pytest.raises(ForeignFileError, match="holds order 1 of 'beam'"):
        derive(exact_string(), 2, tmp_path)
    rewrite(path, format="something else")
    with pytest.raises(ForeignFileError, match="it says 'something else'"):
        derive(exact_string(), 2, tmp_path)
    path.write_bytes(gzip.compress(b"[1, 2]"))
    with pytest.raises(ForeignFileError, match="it says 'list'"):
        derive(exact_string(), 2, tmp_path)
    path.write_bytes((tmp_path / "order-0002.json.gz").read_bytes())
    with pytest.raises(ForeignFileError, match="holds order 2"):
        derive(exact_string(), 2, tmp_path)
    path.write_bytes(whole)
    assert derive(exact_string(), 2, tmp_path).order == 2


def test_a_file_that_continues_another_history_is_refused(tmp_path: Path) -> None:
    store = Store(tmp_path, exact_string())
    expansion = expand(exact_string(), 2)
    seal = store.append(Expansion(expansion.problem, expansion.orders[:1]), "")
    assert len(seal) == 64
    store.append(expansion, "0" * 64)
    with pytest.raises(DamagedFileError, match="does not continue the order before it"):
        store.load(2)


def test_only_exact_expansions_are_saved(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="exact ring"):
        Store(tmp_path, float_string(0.8, 2))


def test_an_unwritable_folder(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("in the way", encoding="utf-8")
    with pytest.raises(StorageError, match=r"cannot write in .*ROPEWAVE_CACHE"):
        derive(exact_string(), 2, blocked / "cache")
