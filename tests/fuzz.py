"""Command lines at random: none may crash, hang without a word, or call a NaN a result.

A few in the tests; many by hand::

    python -m tests.fuzz --count 2000 --made 300 --seed 1

Every line runs in a fork of this process, under a limit of memory and of time.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import random
import re
import resource
import shlex
import signal
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator
from contextlib import redirect_stdout, suppress
from pathlib import Path
from typing import Any, NamedTuple

MEMORY = 6 * 2**30
SECONDS = 30.0

# No number, no finite number, or one that few formulas expect.
EXTREMES = ("nan", "inf", "-inf", "1e308", "-1e308", "1e-308", "5e-324", "0", "-0.0", "-1", "1e400",
            "1e16", "1e5", "1e-9", "abc", "", "1,2", "0:1:0.1", "99999999999999999999")  # fmt: skip
OMEGA = ("2.5", "0.83", "1.1", "2.9", "3.14159265358979", "1.5707963267948966", "0.01", "50", "1e3")
EPSILON = ("0.05", "0.01", "-0.02", "0.3", "0.9", "1", "1e-12")
BETA = ("0", "0.01", "0.001", "1e-6", "0.3", "1", "1e3", "1e-12")
ORDER = ("1", "2", "3", "4", "7", "12", "60", "200")
RATIO = ("1/1", "1/2", "2/3", "3/1", "7/5", "1/9", "2/4", "0/1", "-1/2", "1/0", "1", "1/50", "x/y",
         "1e3/1", "1/1/1")  # fmt: skip
FLAG = (None,)
END = ("pinned", "clamped", "loose")


def _files(*suffixes: str) -> tuple[str, ...]:
    names = [f"fuzz.{suffix}" for suffix in suffixes]
    return (*names, "new/folder/x." + suffixes[0], "/dev/full", "/nonexistent/x.bmp", ".", "")


DRIVEN = 'driven_end = ["W = 1 + epsilon*cos(Omega*tau)"]\n'
PROBLEMS = {
    "founded.toml": 'equation = "W_tautau = W_xixi - 2 - kappa*W"\ncontact = ["W", "W_xi"]\n'
    f"{DRIVEN}[parameters]\nkappa = 1.7\n",
    "springs.toml": 'equation = "W_tautau = W_xixi - 2"\ncontact = ["W"]\nsprings = "kappa"\n'
    f"{DRIVEN}[parameters]\nkappa = 40\n",
    "varying.toml": 'equation = "W_tautau = (1 + kappa*xi)*W_xixi + kappa*W_xi - 2"\n'
    f'contact = ["W", "W_xi"]\n{DRIVEN}[parameters]\nkappa = 0.2\n',
}
PICTURE = _files("png", "svg", "pdf")
COMMON = {"--plot": PICTURE, "--json": FLAG}
ROPE = {
    "--beta": BETA, "--driven-end": END, "--damping": ("0", "0.1", "1e3"),
    "--drive": ("1: 1", "1: 1, 3: 0.2@0.5", "0: 0.1, 2: 1", "1", "1: 1e400", "1:1,1:1", "9999: 1"),
    "--problem": ("none.toml", "/dev/zero", ".", "founded.toml", "springs.toml", "varying.toml"),
    "--set": ("kappa=2", "kappa", "kappa=-1e9", "kappa=1e300", "kappa=nan", "lambda=1"),
}  # fmt: skip
UNITS = {"--hz": ("1.2", "0", "1e300"), "--height": ("0.81", "-1", "1e-300")}
POLYNOMIALS = ("1", "1,0.1", "0,0.02", "1,-1", "0", "1,,2", "0,1e308")
ALONG = dict.fromkeys(("--foundation", "--tension", "--mass", "--weight", "--ground"), POLYNOMIALS)
EVERY: dict[str, dict[str, tuple[Any, ...]]] = {
    "derive": {
        "--order": ORDER, "--format": ("text", "latex", "numpy", "javascript", "json", "pdf"),
        "--out": ("out", "/dev/full", ""), "--style": ("cotangent", "circular"),
        "--column": ("one", "two"), "--omega": OMEGA, "--epsilon": EPSILON, "--no-cache": FLAG,
        **COMMON, **ROPE,
    },
    "evaluate": {
        "--omega": OMEGA, "--epsilon": EPSILON, "--order": ORDER,
        "--s": ("-1,0", "-2:0:0.1", "1", "-1e308", "-1:0:1e-4"),
        "--tau": ("0", "0:6:0.1", "1e308", "1e16", "0:1:1e-4"), **UNITS, **COMMON, **ROPE,
    },
    "validate": {
        "--omega": OMEGA, "--beta": BETA, "--order": ORDER, "--quick": FLAG,
        "--form": ("none.py", "."), **COMMON, **{**ROPE, "--beta": BETA},
    },
    "resonances": {
        "--beta": BETA, "--driven-end": END, "--count": ("1", "5", "100", "1000"),
        "--order": ("1", "3", "10", "100"), "--latex": _files("tex"), **COMMON,
        "--damping": ROPE["--damping"], "--problem": ROPE["--problem"], "--set": ROPE["--set"],
    },
    "tongue": {"": RATIO, "--order": ORDER, "--latex": _files("tex"), **COMMON},
    "fold": {
        "": RATIO, "--beta": BETA, "--driven-end": END, "--latex": _files("tex"), **COMMON,
        "--problem": ROPE["--problem"], "--set": ROPE["--set"], "--drive": ROPE["--drive"],
    },
    "simulate": {
        "--omega": OMEGA, "--epsilon": EPSILON, "--beta": BETA, "--periods": ("4", "3", "2.5"),
        "--ramp": ("0", "1", "2"), "--keep": ("1", "4", "0.1"), "--dx": ("0.02", "0.025", "0.01"),
        "--dt": ("0.01", "1e-5"), "--length": ("8", "5", "3"), "--sponge": ("3", "0"),
        "--scheme": ("trapezoidal", "verlet", "euler"), "--driven-end": END,
        "--damping": ("0", "0.1", "1e3"), "--restitution": ("0", "0.5", "1"),
        "--samples": ("none.csv", "/dev/zero", "."), "--until": ("3", "-1", "1e9"),
        **ALONG, **UNITS,
        "--out": _files("nc"), "--animate": _files("gif"), "--checkpoint": _files("npz"), **COMMON,
    },
    "threshold": {
        "--omega": OMEGA, "--beta": BETA, "--dx": ("0.025", "0.02"), "--relative": ("0.1", "1"),
        "--quick": FLAG, "--json": FLAG,
    },
    "figure2": {
        "--coarse": FLAG, "--out": PICTURE, "--data": ("none.json", "data", "/dev/null"),
        "--collect": _files("json"), "--tables": _files("md"), "--workers": ("1", "2", "0"),
        "--json": FLAG,
    },
}  # fmt: skip
# What a line has when nothing else is said: what is required, and what keeps runs short.
USUAL: dict[str, dict[str, str | None]] = {
    "evaluate": {"--omega": "1.1", "--epsilon": "0.01"},
    "validate": {"--omega": "1.1", "--order": "2", "--quick": None},
    "tongue": {"": "1/2"},
    "fold": {"": "1/1"},
    "simulate": {"--omega": "2.5", "--epsilon": "0.05", "--dx": "0.025", "--ramp": "1",
                 "--periods": "3"},
    "threshold": {"--omega": "2.9", "--dx": "0.025", "--relative": "0.5", "--quick": None},
    "figure2": {"--data": "none.json"},
}  # fmt: skip


class Outcome(NamedTuple):
    """How a line ended: the exit code (None: no end in time; negative: by a signal), its output."""

    code: int | None
    out: str
    err: str


def line(command: str, chosen: dict[str, str | None]) -> list[str]:
    """A command line; the option "" is the argument."""
    words = [command]
    for option, value in ({**USUAL.get(command, {}), **chosen}).items():
        words += ([option] if option else []) + ([] if value is None else [value])
    return words


def lines_at_random(count: int, seed: int) -> Iterator[list[str]]:
    """Options at random, a fifth of their values extreme."""
    source = random.Random(seed)
    for _ in range(count):
        command = source.choice(list(EVERY))
        chosen = {}
        for option, values in EVERY[command].items():
            if source.random() < 0.4:
                extreme = None not in values and source.random() < 0.2
                chosen[option] = source.choice(EXTREMES if extreme else values)
        yield line(command, chosen)


def lines_made(count: int | None = None) -> list[list[str]]:
    """Every option with every extreme in turn, and nothing else unusual; evenly thinned."""
    every = [
        line(command, {option: value})
        for command, options in EVERY.items()
        for option, values in options.items()
        for value in (EXTREMES if None not in values else ())
    ]
    if count is None or count >= len(every):
        return every
    return [every[i * len(every) // count] for i in range(count)]


def run(words: list[str], seconds: float = SECONDS, memory: int = MEMORY) -> Outcome:
    """One line in a child process, killed after so many seconds."""
    with tempfile.TemporaryDirectory(prefix="ropewave-fuzz-") as folder:
        out, err = Path(folder, "stdout"), Path(folder, "stderr")
        child = os.fork()
        if child == 0:
            _live(words, out, err, Path(folder), memory)
        end = time.monotonic() + seconds
        found, status = os.waitpid(child, os.WNOHANG)
        while not found and time.monotonic() < end:
            time.sleep(0.005)
            found, status = os.waitpid(child, os.WNOHANG)
        if not found:
            with suppress(ProcessLookupError):
                os.killpg(child, signal.SIGKILL)
            os.waitpid(child, 0)
        texts = [path.read_text("utf-8", "replace") if path.exists() else "" for path in (out, err)]
        return Outcome(os.waitstatus_to_exitcode(status) if found else None, *texts)


def prepare() -> None:
    """Import and compile in this process what every child would have to."""
    from derivations.app import main as ropewave

    for command in ("derive", "evaluate", "resonances", "tongue", "fold", "simulate"):
        with redirect_stdout(io.StringIO()), suppress(SystemExit):
            ropewave(line(command, {}))


def _live(words: list[str], out: Path, err: Path, folder: Path, memory: int) -> None:
    """The child: never returns."""
    code = 70
    try:
        os.setsid()
        for path, target in ((out, 1), (err, 2)):
            opened = os.open(path, os.O_WRONLY | os.O_CREAT)
            os.dup2(opened, target)
        sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
        sys.stderr = open(2, "w", encoding="utf-8", closefd=False, buffering=1)  # noqa: SIM115
        os.chdir(folder)
        for name, text in PROBLEMS.items():
            Path(name).write_text(text, encoding="utf-8")
        os.environ["ROPEWAVE_CACHE"] = str(folder / "cache")
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        warnings.simplefilter("default")  # the tests make errors of them
        from derivations.app import main

        try:
            main(words)
        except SystemExit as end:
            code = int(end.code or 0)
        sys.stdout.flush()
    except BaseException:
        import traceback

        traceback.print_exc()
    finally:
        os._exit(code)


_NO_NUMBER = re.compile(r"(?<![\w.])[-+]?(nan|inf|NaN|Infinity)(?![\w])")


def fault(words: list[str], outcome: Outcome) -> str | None:
    """What is wrong with an outcome; None when nothing is."""
    code, out, err = outcome
    if "Traceback" in err:
        return "traceback"
    if code is None:
        return None if out.strip() or err.strip() else "silent"
    if code < 0:
        return f"signal {-code}"
    if code == 0:
        if words[0] != "derive" and _NO_NUMBER.search(out):  # its results are formulas, and code
            return "no number"
        if "--json" in words:
            try:
                json.loads(out)
            except ValueError:
                return "no JSON"
        return None
    errors = [text for text in err.splitlines() if text.startswith("ropewave: error: ")]
    return None if len(errors) == 1 and err.rstrip().endswith(errors[0]) else f"exit {code}"


def main() -> None:
    """Run many lines, and print those at fault with what they said."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--made", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=SECONDS)
    given = parser.parse_args()
    prepare()
    counts: dict[str, int] = {}
    for words in (*lines_made(given.made), *lines_at_random(given.count, given.seed)):
        started = time.monotonic()
        outcome = run(words, given.seconds)
        found = fault(words, outcome)
        kind = found or ("unfinished" if outcome.code is None else f"exit {outcome.code}, right")
        counts[kind] = counts.get(kind, 0) + 1
        if found is not None:
            last = " | ".join(outcome.err.strip().splitlines()[-2:])
            print(f"{found} ({time.monotonic() - started:.0f} s): {shlex.join(words)}\n    {last}",
                  flush=True)  # fmt: skip
    for kind, number in sorted(counts.items()):
        print(f"{number:6d}  {kind}")


if __name__ == "__main__":
    main()
