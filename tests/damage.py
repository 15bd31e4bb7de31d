"""Damaged files: bytes that were changed, and contents that were changed and sealed anew."""

from __future__ import annotations

import copy
import gzip
import hashlib
import io
import json
import zipfile
from collections.abc import Callable
from random import Random
from typing import Any

import numpy as np

HOSTILE = (
    None, True, -1, 0, 10**400, 1e308, -1e308, 5e-324, "x", "", [], {}, [{}], [None],
    {"lower": "x"}, float("nan"), float("inf"),
)  # fmt: skip
"""What stands in a file where something else should."""


def harm(raw: bytes, chance: Random) -> bytes:
    """Bytes changed, cut, doubled, put in or left out; never the same."""
    at = chance.randrange(len(raw))
    piece = raw[at : at + chance.randrange(1, 200)]
    return chance.choice(
        (
            raw[:at] + bytes([raw[at] ^ 1 << chance.randrange(8)]) + raw[at + 1 :],
            raw[:at],
            raw[:at] + piece + raw[at:],
            raw[:at] + raw[at + len(piece) :],
            raw[:at] + bytes(max(len(piece), 1)) + b"\xff" + raw[at + len(piece) :],
            b"",
            bytes(len(raw)),
            raw + b"\n",
        )
    )


def harm_json(content: Any, chance: Random) -> Any:
    """One value anywhere replaced by something else, left out, or given twice."""
    changed = copy.deepcopy(content)
    where: list[tuple[Any, Any]] = []

    def walk(value: Any) -> None:
        for key in value if isinstance(value, dict) else range(len(value)):
            where.append((value, key))
            if isinstance(value[key], dict | list):
                walk(value[key])

    walk(changed)
    holder, key = chance.choice(where)
    action = chance.randrange(4)
    if action == 0:
        del holder[key]
    elif action == 1 and isinstance(holder, list):
        holder.append(copy.deepcopy(holder[key]))
    else:
        holder[key] = chance.choice([value for value in HOSTILE if value is not holder[key]])
    return changed


def resealed(content: bytes, kind: str) -> bytes:
    """A sealed file of numerics.files.sealed with this content."""
    seal = f"\n{kind}, sha256 {hashlib.sha256(content).hexdigest()}\n"
    return content + seal.encode()


def unsealed(raw: bytes, kind: str) -> bytes:
    """The content of such a file."""
    return raw[: -len(resealed(b"", kind))]


def harm_array(array: np.ndarray, chance: Random) -> np.ndarray:
    """Another shape, another type, or a value that is none."""
    worst = chance.choice((np.nan, np.inf, -np.inf, -5.0, 1e200, -0.1))
    flat = array.ravel()
    changes: list[Callable[[], Any]] = [
        lambda: array[:-1] if array.ndim else np.array([array, array]),
        lambda: np.concatenate([flat, flat]),
        lambda: array.astype("f4" if array.dtype.kind == "f" else "S8"),
        lambda: array.astype(">f8" if array.dtype.kind in "fib" else "S3"),
        lambda: array[None],
        lambda: np.zeros(0),
        lambda: np.array("words"),
        lambda: np.array([None, 1], object),
    ]
    if array.dtype.kind in "fi" and array.size:

        def one() -> np.ndarray:
            spoilt = array.astype(float)
            spoilt.flat[chance.randrange(array.size)] = worst
            return spoilt if np.isnan(worst) or np.isinf(worst) else spoilt.astype(array.dtype)

        changes += [one] * 8
    return np.asarray(chance.choice(changes)())


def harm_npz(content: bytes, chance: Random) -> bytes:
    """An array harmed, left out, renamed, added, or all of them compressed; or a bomb."""
    with np.load(io.BytesIO(content)) as found:
        arrays = dict(found)
    name = chance.choice(sorted(arrays))
    action = chance.randrange(12)
    out = io.BytesIO()
    if action == 0:
        del arrays[name]
    elif action == 1:
        arrays[name + "s"] = arrays.pop(name)
    elif action == 2:
        arrays["more"] = np.zeros(3)
    elif action == 3:
        np.savez_compressed(out, **arrays)
        return out.getvalue()
    elif action == 4:  # a header that promises more than there is, or than there can be
        header = io.BytesIO()
        shape = (chance.choice((10**6, 10**12, 10**30, -1)),)
        np.lib.format.write_array_header_1_0(
            header, {"descr": "<f8", "fortran_order": False, "shape": shape}
        )
        return _with_member(content, name, header.getvalue() + bytes(64), zipfile.ZIP_STORED)
    elif action == 5:  # a bomb
        packed = io.BytesIO()
        np.save(packed, np.zeros(10**6))
        return _with_member(content, name, packed.getvalue(), zipfile.ZIP_DEFLATED)
    else:
        arrays[name] = harm_array(arrays[name], chance)
    np.savez(out, allow_pickle=True, **arrays)
    return out.getvalue()


def _with_member(content: bytes, name: str, data: bytes, packing: int) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(out, "w") as new:
        for member in old.infolist():
            mine = member.filename == f"{name}.npy"
            new.writestr(
                member.filename,
                data if mine else old.read(member),
                packing if mine else zipfile.ZIP_STORED,
            )
    return out.getvalue()


def harm_hdf5(content: bytes, chance: Random) -> bytes:
    """A variable or an attribute harmed, left out or renamed; or a variable that is a bomb."""
    import h5py

    stream = io.BytesIO(content)
    with h5py.File(stream, "r+") as file:
        name = chance.choice(sorted(file))
        action = chance.randrange(8)
        if action == 0:
            del file[name]
        elif action == 1:
            file.move(name, name + "s")
        elif action in (2, 3):
            attribute = chance.choice(sorted(set(file.attrs) - {"_NCProperties"}))
            value = chance.choice((None, "x", -1.0, np.nan, np.zeros(3), "[" * 5000))
            if value is None:
                del file.attrs[attribute]
            else:
                file.attrs[attribute] = value
        elif action == 4:
            del file[name]
            file.create_dataset(name, (chance.choice((10**6, 10**11)),), "f8", chunks=(10**4,))
        else:
            before = file[name][()]
            array = harm_array(before, chance)
            if array.dtype.kind in "OU":
                array = array.astype("S")
            if array.shape == before.shape and array.dtype == before.dtype:
                file[name][...] = array
            else:
                del file[name]
                file[name] = array
    return stream.getvalue()


def harm_gzip(raw: bytes, chance: Random) -> bytes:
    """A bomb, or JSON that no reader expects."""
    texts = (
        b"[" * 100_000,
        b'{"a":' * 100_000,
        b"9" * 10**6,
        b"null",
        b'{"format": NaN}',
        b" " * 10**7,
        b"\xff\xfe",
        gzip.decompress(raw)[: chance.randrange(1, 100)],
    )
    return gzip.compress(chance.choice(texts))


def spelled(content: Any) -> bytes:
    """JSON as Python writes it, NaN included."""
    return json.dumps(content).encode()
