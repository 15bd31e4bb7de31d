"""Saved derivations: resumed, sealed, and refused when they are not what was written."""

from __future__ import annotations

import copy
import gzip
import json
import os
import random
import signal
import subprocess
import sys
import time
import tracemalloc
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from asymptotics import Expansion, exact_string, expand, float_string, prove, string_problem
from asymptotics.errors import DamagedFileError, ForeignFileError, InputError, StorageError
from asymptotics.expansion.proof import RefutedError
from asymptotics.expansion.saved_orders import largest_size, order_to
from asymptotics.expansion.storage import Store, _seal, saved_expansion
from asymptotics.rings.cotangent import CotangentRing


def orders_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_what_is_read_is_what_was_written(tmp_path: Path, sixth: Expansion) -> None:
    saved_expansion(exact_string(), 6, tmp_path)
    read, _ = Store(tmp_path, exact_string()).load(6)
    assert read.orders == sixth.orders
    assert all(proof.holds for proof in prove(read))


def test_a_later_call_continues(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    saved_expansion(exact_string(), 4, tmp_path)
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    computed: list[int] = []
    import asymptotics.expansion.order_loop as engine

    original, exact = engine._next_order, exact_string()

    def spy(problem, orders, towers):  # type: ignore[no-untyped-def]
        if problem.ring is exact.ring:  # not the image that checks what was loaded
            computed.append(len(orders) + 1)
        return original(problem, orders, towers)

    monkeypatch.setattr(engine, "_next_order", spy)
    reports: list[int] = []
    assert saved_expansion(exact, 6, tmp_path, reports.append).order == 6
    assert computed == [5, 6]
    assert reports == [4, 5, 6]
    assert saved_expansion(exact, 3, tmp_path).order == 3
    assert computed == [5, 6]
    for name, content in before.items():
        assert (tmp_path / name).read_bytes() == content


def test_a_killed_process_loses_at_most_the_order_under_way(tmp_path: Path) -> None:
    program = (
        "import sys; from pathlib import Path; from asymptotics import exact_string;"
        "from asymptotics.expansion.storage import saved_expansion;"
        "saved_expansion(exact_string(), 30, Path(sys.argv[1]))"
    )
    process = subprocess.Popen([sys.executable, "-c", program, str(tmp_path)])
    deadline = time.monotonic() + 60
    while not (tmp_path / "order-0009.json.gz").exists() and time.monotonic() < deadline:
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    saved = [path for path in tmp_path.iterdir() if path.name.startswith("order-")]
    assert len(saved) >= 9
    resumed = saved_expansion(exact_string(), 9, tmp_path)
    assert [o.contact for o in resumed.orders] == [
        o.contact for o in expand(exact_string(), 9).orders
    ]


@pytest.mark.parametrize("cut", [0, 10, 200])
def test_a_truncated_file_is_refused_and_left_alone(tmp_path: Path, cut: int) -> None:
    saved_expansion(exact_string(), 3, tmp_path)
    victim = tmp_path / "order-0002.json.gz"
    victim.write_bytes(victim.read_bytes()[:cut])
    damaged = victim.read_bytes()
    with pytest.raises(DamagedFileError, match=r"order-0002.json.gz is damaged.*move"):
        saved_expansion(exact_string(), 4, tmp_path)
    assert victim.read_bytes() == damaged
    assert len(orders_in(tmp_path)) == 3


def rewrite(path: Path, **changes: object) -> None:
    content = json.loads(gzip.decompress(path.read_bytes()))
    content.update(changes)
    path.write_bytes(gzip.compress(json.dumps(content).encode()))


def test_a_changed_number_is_refused(tmp_path: Path) -> None:
    saved_expansion(exact_string(), 3, tmp_path)
    path = tmp_path / "order-0003.json.gz"
    content = json.loads(gzip.decompress(path.read_bytes()))
    content["order"]["contact"]["1"][0] += 1
    rewrite(path, order=content["order"])
    with pytest.raises(DamagedFileError, match="its content has changed"):
        saved_expansion(exact_string(), 3, tmp_path)


def test_a_sealed_lie_is_refused(tmp_path: Path, sixth: Expansion) -> None:
    """The seal says that nothing changed since, not that it is true."""
    contact = dict(sixth.contact(1))
    contact[1] = contact[1] * CotangentRing().rational(2)
    lie = Expansion(sixth.problem, (replace(sixth.orders[0], contact=contact),))
    Store(tmp_path, exact_string()).append(lie, "")
    with pytest.raises(DamagedFileError, match="its numbers are not what 'string' yields"):
        saved_expansion(exact_string(), 2, tmp_path)
    with pytest.raises(RefutedError, match="discard it, and any saved copy"):
        prove(lie)


def test_another_problem_of_the_same_name_is_refused(tmp_path: Path) -> None:
    saved_expansion(exact_string(), 2, tmp_path)
    ring = CotangentRing()
    drive = {1: ring.rational(1, 3)}
    other = string_problem(ring, ring.omega, ring.cot, name="string", drive=drive)
    with pytest.raises(DamagedFileError, match=r"order-0001.json.gz is damaged: its numbers"):
        saved_expansion(other, 2, tmp_path)


def test_what_is_there_is_compared_before_it_is_continued(tmp_path: Path) -> None:
    """Order 2 was lost, order 3 is another's: found when order 2 has been derived again."""
    saved_expansion(exact_string(), 3, tmp_path)
    (tmp_path / "order-0002.json.gz").unlink()
    assert saved_expansion(exact_string(), 3, tmp_path).order == 3
    (tmp_path / "order-0002.json.gz").unlink()
    reseal(tmp_path, {3: lambda content: content["order"]["contact"].pop("1")}, last=3)
    with pytest.raises(DamagedFileError, match=r"order-0003.json.gz is damaged: its numbers"):
        saved_expansion(exact_string(), 3, tmp_path)


def test_files_of_another_origin_are_refused(tmp_path: Path) -> None:
    saved_expansion(exact_string(), 2, tmp_path)
    path = tmp_path / "order-0001.json.gz"
    whole = path.read_bytes()
    rewrite(path, problem="beam")
    with pytest.raises(ForeignFileError, match="holds order 1 of 'beam'"):
        saved_expansion(exact_string(), 2, tmp_path)
    rewrite(path, format="something else")
    with pytest.raises(ForeignFileError, match="it says 'something else'"):
        saved_expansion(exact_string(), 2, tmp_path)
    path.write_bytes(gzip.compress(b"[1, 2]"))
    with pytest.raises(ForeignFileError, match="it says 'list'"):
        saved_expansion(exact_string(), 2, tmp_path)
    path.write_bytes((tmp_path / "order-0002.json.gz").read_bytes())
    with pytest.raises(ForeignFileError, match="holds order 2"):
        saved_expansion(exact_string(), 2, tmp_path)
    path.write_bytes(whole)
    assert saved_expansion(exact_string(), 2, tmp_path).order == 2


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
        saved_expansion(exact_string(), 2, blocked / "cache")


# -- damage ----------------------------------------------------------------------------------------

LAST = 4


def contents(folder: Path, last: int = LAST) -> dict[int, Any]:
    paths = {n: folder / f"order-{n:04d}.json.gz" for n in range(1, last + 1)}
    return {
        n: json.loads(gzip.decompress(path.read_bytes()))
        for n, path in paths.items()
        if path.exists()
    }


def write(folder: Path, found: dict[int, Any]) -> None:
    """All seals made good, whatever the files say."""
    seal = ""
    for n, content in sorted(found.items()):
        if isinstance(content, dict):
            if n > 1 and n - 1 in found:
                content["after"] = seal
            seal = content["seal"] = _seal(content)
        path = folder / f"order-{n:04d}.json.gz"
        path.write_bytes(gzip.compress(json.dumps(content).encode(), 1))


def reseal(folder: Path, changes: dict[int, Callable[[Any], Any]], last: int = LAST) -> None:
    found = contents(folder, last)
    for n, change in changes.items():
        change(found[n])
    write(folder, found)


def outcome(folder: Path, order: int = LAST) -> str:
    """A clear refusal in words, or nothing when what is read, and continued, is right."""
    try:
        expansion = saved_expansion(exact_string(), order, folder)
    except StorageError as error:
        words = str(error)
        assert str(folder) in words and len(words) < 1500  # noqa: PT018
        return words
    assert expand(exact_string(), order + 1, start=expansion).orders == TRUE.orders[: order + 1]
    return ""


TRUE = expand(exact_string(), LAST + 1)
SAVED = {
    n: {
        "format": "ropewave expansion, version 1",
        "problem": "string",
        "n": n,
        "after": "",
        "order": order_to(order),
        "seal": "",
    }
    for n, order in enumerate(TRUE.orders[:LAST], start=1)
}


def set_at(*keys: Any) -> Callable[[Any], Callable[[Any], None]]:
    """value ↦ (content ↦ the value put at the end of the path)."""

    def with_value(value: Any) -> Callable[[Any], None]:
        def change(content: Any) -> None:
            for key in keys[:-1]:
                content = content[key]
            content[keys[-1]] = value

        return change

    return with_value


ELEMENT = ("order", "contact", "2")
TERM = (*ELEMENT, 2, 0)
HUGE = 10**4000
JUNK: list[Any] = [
    None, True, False, 0, -1, 1, 2, 7, 2**31, 2**61 - 1, -(2**64), HUGE, "", "x", "1", "0", "∞",
    [], [[]], [0], [1, 2], [1, 2, 3], [None], [{}], [[0, 0, 0]], {}, {"1": 1}, {"-1": [1, [], []]},
    {"": []}, [[1, [], [[0, 0, 1]]]], {"0": [1, [], [[0, 0, 1]]]}, [1, [], []],
]  # fmt: skip
PLACES: list[tuple[Any, ...]] = [
    ("order",), ("order", "contact"), ("order", "shape"), ("order", "tails"), ELEMENT,
    (*ELEMENT, 0), (*ELEMENT, 1), (*ELEMENT, 2), TERM, (*TERM, 0), (*TERM, 1), (*TERM, 2),
    ("order", "shape", "2"), ("order", "shape", "2", 1), ("order", "tails", 0),
    ("order", "tails", 1, 0), ("format",), ("problem",), ("n",), ("extra",), ("order", "extra"),
]  # fmt: skip
MADE = [set_at(*place)(value) for place in PLACES for value in JUNK]


@pytest.mark.slow
def test_every_value_at_every_place(tmp_path: Path) -> None:
    """Junk in a resealed order 2: refused in one error, or without effect."""
    assert len(MADE) > 600
    words = []
    for change in MADE:
        found = copy.deepcopy(SAVED)
        change(found[2])
        write(tmp_path, found)
        words.append(outcome(tmp_path, 2))
    # What is as it was, such as 1 for the denominator 1.
    assert sum(not word for word in words) < 30
    assert len({word.split(":")[1] for word in words if ":" in word}) > 15


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda content: content.pop("after"), "a saved order should have format, problem, n"),
        (lambda content: content.update(more=1), "a saved order should have format, problem, n"),
        (lambda content: content["order"].pop("tails"), "an order should have contact, shape"),
        (lambda content: content["order"].update(more=1), "an order should have contact, shape"),
        (
            lambda content: content["order"]["contact"].update(
                {"02": content["order"]["contact"].pop("2")}
            ),
            "'02' is not the index of a harmonic",
        ),
    ],
)
def test_names_that_are_missing_or_too_many(
    tmp_path: Path, change: Callable[[Any], Any], said: str
) -> None:
    found = copy.deepcopy(SAVED)
    write(tmp_path, found)
    change(found[2])
    found[2]["seal"] = _seal(found[2])
    path = tmp_path / "order-0002.json.gz"
    path.write_bytes(gzip.compress(json.dumps(found[2]).encode(), 1))
    assert said in outcome(tmp_path, 2)


def nodes(data: Any, place: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    here = [place] if place else []
    items: Any = ()
    if isinstance(data, dict):
        items = data.items()
    elif isinstance(data, list):
        items = enumerate(data)
    return here + [node for key, value in items for node in nodes(value, (*place, key))]


def damage(content: Any, rng: random.Random) -> None:
    """One change somewhere: junk, another part of the file, one less, one more, a new name."""
    places = nodes(content)
    place = rng.choice(places)
    for key in place[:-1]:
        content_at = content[key] if key == place[0] else content_at[key]  # noqa: F821
    parent = content if len(place) == 1 else content_at
    key, kind = place[-1], rng.randrange(6)
    value = parent[key]
    if kind == 0:
        parent[key] = copy.deepcopy(rng.choice(JUNK))
    elif kind == 1:
        other: Any = content
        for step in rng.choice(places):
            other = other[step]
        parent[key] = copy.deepcopy(other)
    elif kind == 2:
        del parent[key]
    elif kind == 3 and isinstance(value, int):
        parent[key] = value + rng.choice([1, -1, 2, -value, 61, 2**61])
    elif kind == 4 and isinstance(value, list) and value:
        value.append(copy.deepcopy(rng.choice(value)))
    elif isinstance(parent, dict):
        parent[rng.choice(["-1", "0", "1", "3", "00", "2.0", "99999999999", "x"])] = value
    else:
        parent.reverse()


@pytest.mark.slow
def test_random_damage_is_refused_or_without_effect(tmp_path: Path) -> None:
    """400 resealed files, one or two changes each."""
    rng, refused = random.Random(11), 0
    for case in range(400):
        found = copy.deepcopy(SAVED)
        for _ in range(1 + case % 2):
            damage(found[rng.randint(1, LAST)], rng)
        write(tmp_path, found)
        refused += bool(outcome(tmp_path))
    assert refused > 300


def test_random_bytes(tmp_path: Path) -> None:
    """Bits turned and parts lost, in the compressed file and in the text, seals not made good."""
    rng = random.Random(5)
    write(tmp_path, copy.deepcopy(SAVED))
    path = tmp_path / "order-0003.json.gz"
    whole = path.read_bytes()
    for case in range(200):
        data = bytearray(whole if case % 2 else gzip.decompress(whole))
        for _ in range(rng.randint(1, 3)):
            data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
        if case % 5 == 0:
            del data[rng.randrange(len(data)) :]
        path.write_bytes(data if case % 2 else gzip.compress(bytes(data), 1))
        # A few bits of gzip's header mean nothing.
        word = outcome(tmp_path, 3)
        assert word or case % 2


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b"", "Expecting value"),
        (b"[" * 60_000, "nested too deeply|Expecting value"),
        (b'{"a":' * 12_000, "nested too deeply|Expecting"),
        (b"[" * 20_000 + b"]" * 20_000, "nested too deeply"),
        (b'{"n": NaN}', "holds NaN, which is not a whole number"),
        (b'{"n": -Infinity}', "holds -Infinity"),
        (b'{"n": 1.0}', "holds 1.0"),
        (b'{"n": 1e400}', "holds 1e400"),
        (b'{"n": 1, "n": 1}', "names something twice"),
        (b'{"n": ' + b"9" * 10_000 + b"}", "digits"),
        (b"\xff\xfe{}", "decode|codec"),
        (b'{"n": "\xff"}', "decode|codec"),
        (b"\0" * 60_000, "Expecting value"),
        (b" " * 66_000, "holds more than 65590 bytes"),
    ],
)
def test_texts_that_are_no_order(tmp_path: Path, text: bytes, said: str) -> None:
    write(tmp_path, copy.deepcopy(SAVED))
    (tmp_path / "order-0003.json.gz").write_bytes(gzip.compress(text))
    with pytest.raises(DamagedFileError, match=rf"order-0003.json.gz is damaged: .*({said})"):
        saved_expansion(exact_string(), 4, tmp_path)


def test_a_bomb_is_not_inflated(tmp_path: Path) -> None:
    """A gigabyte in a megabyte, plain and doubly packed; and a hundred megabytes as they are."""
    write(tmp_path, copy.deepcopy(SAVED))
    path = tmp_path / "order-0002.json.gz"
    bomb = gzip.compress(b"0" * (1 << 24), 9)
    saved_expansion(exact_string(), 1, tmp_path)
    for data, said in (
        (bomb * 64, "holds more than 65539 bytes"),
        (gzip.compress(bomb), "Expecting value|decode"),
        (b"\x1f\x8b" + b"\0" * 10_000_000, "not compressed as it should be"),
        (b'{"order":' + b"0" * 100_000_000, "not compressed as it should be"),
    ):
        path.write_bytes(data)
        tracemalloc.start()
        try:
            with pytest.raises(DamagedFileError, match=said):
                saved_expansion(exact_string(), 2, tmp_path)
            assert tracemalloc.get_traced_memory()[1] < 5_000_000
        finally:
            tracemalloc.stop()


def test_a_sound_file_with_more_behind_it_is_refused(tmp_path: Path) -> None:
    write(tmp_path, copy.deepcopy(SAVED))
    path = tmp_path / "order-0002.json.gz"
    whole = path.read_bytes()
    for more in (b"x", b"\0", whole):
        path.write_bytes(whole + more)
        with pytest.raises(DamagedFileError, match="something follows its end"):
            saved_expansion(exact_string(), 2, tmp_path)


def test_poles_and_exponents_that_would_take_for_ever(tmp_path: Path) -> None:
    """Ψ_2 = c: the same value with c^m above and below is turned down at once when m is large."""
    cases = {
        "c over c": ((1, 1), True),
        "m = 3": ((3, 3), True),
        "m = 5, more than order 2 can have": ((5, 5), False),
        "m = 10^6": ((10**6, 10**6), False),
        "only above": ((1, 0), False),
        "only below": ((0, 1), False),
    }
    for name, ((above, below), good) in cases.items():
        found = copy.deepcopy(SAVED)
        denominator, poles, terms = found[2]["order"]["contact"]["2"]
        terms = [[a, i + above, v] for a, i, v in terms]
        found[2]["order"]["contact"]["2"] = [denominator, [poles[0] + below], terms]
        write(tmp_path, found)
        assert (outcome(tmp_path, 2) == "") == good, name


def test_fermat_is_no_help(tmp_path: Path) -> None:
    """What equals a coefficient modulo a known prime, or at a known point, is not it."""
    prime = 2**61 - 1
    for place, value in (((*TERM, 2), prime), ((*TERM, 0), prime - 1), ((*TERM, 1), prime - 1)):
        found = copy.deepcopy(SAVED)
        row: Any = found[2]
        for key in place[:-1]:
            row = row[key]
        row[place[-1]] += value
        write(tmp_path, found)
        assert "damaged" in outcome(tmp_path, 2)


@pytest.mark.parametrize("kind", ["folder", "pipe", "loop"])
def test_what_is_no_file(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "order-0001.json.gz"
    if kind == "folder":
        path.mkdir()
    elif kind == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to(path)
    words = outcome(tmp_path, 2)
    # A link that leads nowhere is replaced.
    assert (words == "") if kind == "loop" else ("is not a file" in words)


def test_sizes_have_room_for_what_is_derived() -> None:
    """The largest orders known are a third of what is let through; two harmonics too."""
    ring = CotangentRing()
    drive = {1: ring.rational(1, 2), 2: ring.rational(1, 3)}
    two = expand(string_problem(ring, ring.omega, ring.cot, name="two", drive=drive), 5)
    for expansion, per_order in ((two, 2), (expand(exact_string(), 10), 1)):
        for n, order in enumerate(expansion.orders, start=1):
            size = len(json.dumps(order_to(order), separators=(",", ":"))) + 400
            assert size < 0.4 * largest_size(per_order * n)
