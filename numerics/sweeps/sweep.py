"""The same computation at many parameters: in parallel, resumable, and never done twice.

Tasks are plain dictionaries; so are results. With a folder, every result is a file of its own that
carries the specification it belongs to and a seal: a killed sweep goes on where it stopped, and a
damaged file, or one of another specification, is refused and left alone. Only the parent writes.
"""

from __future__ import annotations

import hashlib
import json
import multiprocessing
import os
import pickle
import reprlib
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from numerics.errors import FileError, InputError, WorkerError
from numerics.files.atomic import sweep_unfinished
from numerics.files.sealed import LARGEST_JSON, is_there, read_json, replace_file
from numerics.problems.drive import whole

Task = dict[str, Any]
Result = dict[str, Any]
_THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def sweep(
    work: Callable[[Task], Result],
    tasks: Sequence[Task],
    folder: Path | str | None = None,
    specification: str = "",
    workers: int = 1,
    progress: Callable[[int, int], None] | None = None,
) -> list[Result]:
    """``[work(task) for task in tasks]``, in parallel and resumable.

    Parameters
    ----------
    work
        A function at the top of a module, so that other processes can import it.
    tasks
        Dictionaries of JSON values; numbers may be NumPy's, in results too, but must be finite.
    folder
        Where results are kept, and come back from as plain Python values; without it they are in
        memory only.
    specification
        What else the results depend on: the versions and settings that ``work`` fixes.
    workers
        Processes; 1 computes here.
    progress
        Called with the results there are and their number at the end.

    Returns
    -------
    list
        The results in the order of the tasks.

    Raises
    ------
    InputError
        Two equal tasks, a task or a result to be kept that is not JSON (NaN is not), no worker, or
        ``work`` that other processes cannot import.
    FileError
        A file in the folder is damaged or of another specification, or cannot be written.
    WorkerError
        A process ended before its work.

    Examples
    --------
    >>> sweep(square, [{"x": 2}, {"x": 3}])
    [{'y': 4}, {'y': 9}]
    """
    workers = whole("workers", workers)
    named = {_name(task): task for task in tasks}
    if len(named) < len(tasks):
        raise InputError("two tasks of the sweep are equal; give each once")
    folder = None if folder is None else Path(folder)
    results: dict[str, Result] = {}
    if folder is not None:
        sweep_unfinished(folder)
        for name, task in named.items():
            found = _read(folder / name, specification, task)
            if found is not None:
                results[name] = found
    left = [(name, task) for name, task in named.items() if name not in results]
    if progress is not None:
        progress(len(results), len(tasks))
    for name, result in _compute(work, left, workers):
        if folder is not None:
            result = _write(folder / name, specification, named[name], result)
        results[name] = result
        if progress is not None:
            progress(len(results), len(tasks))
    return [results[name] for name in named]


def square(task: Task) -> Result:
    """y = x²: the smallest work there is, for examples and tests.

    >>> square({"x": 3})
    {'y': 9}
    """
    return {"y": task["x"] ** 2}


def _compute(
    work: Callable[[Task], Result], left: list[tuple[str, Task]], workers: int
) -> Iterator[tuple[str, Result]]:
    """Names and results, as they come."""
    if workers == 1 or len(left) < 2:
        for name, task in left:
            yield name, work(task)
        return
    _check_importable(work)
    # Spawned, not forked: threads of compiled libraries do not survive a fork.
    context = multiprocessing.get_context("spawn")
    pool: Executor = ProcessPoolExecutor(
        min(workers, len(left)), context, initializer=_watch, initargs=(os.getpid(),)
    )
    try:
        with _one_thread_each():
            futures: dict[Future[Result], str] = {
                pool.submit(work, task): name for name, task in left
            }
        for future in as_completed(futures):
            yield futures[future], future.result()
    except BrokenProcessPool as error:
        raise WorkerError(
            "a process of the sweep ended before its work. A script that starts one needs its "
            "calls under if __name__ == '__main__':, and memory must do for "
            f"{min(workers, len(left))} workers; workers = 1 computes without other processes"
        ) from error
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """For processes that start within: the threads of linear algebra would be in each other's way.

    What the user has set stays.
    """
    before = {name: os.environ.get(name) for name in _THREADS}
    os.environ.update({name: "1" for name, value in before.items() if value is None})
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]


def _check_importable(work: Callable[[Task], Result]) -> None:
    """That a new process, which begins with the import of the main module, can find ``work``."""
    main = sys.modules["__main__"]
    file = getattr(main, "__file__", None)
    named = getattr(main, "__spec__", None) is not None
    if not named and file is not None and not Path(file).exists():
        what = f"the main program, {file!r}, is no file that they can import"
    elif not named and file is None and getattr(work, "__module__", None) == "__main__":
        what = "the work is defined in a session, which they cannot import"
    else:
        try:
            pickle.dumps(work)
            return
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            what = f"the work cannot be sent to them ({error})"
    raise InputError(
        f"workers are processes of their own, and {what}. Put the work at the top of a module, in "
        "a file, or take workers = 1"
    )


def _watch(parent: int) -> None:
    """End this process when its parent is gone: a killed parent cannot end it."""

    def look() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=look, daemon=True).start()


def _name(task: Task) -> str:
    """A file name that depends on the task alone."""
    return hashlib.sha256(_spelling(task).encode()).hexdigest()[:24] + ".json"


def _spelling(content: Any) -> str:
    try:
        return json.dumps(content, sort_keys=True, allow_nan=False, default=_plain)
    except (TypeError, ValueError, RecursionError) as error:
        raise InputError(
            f"{reprlib.repr(content)} is not JSON ({error}); give plain finite numbers and words"
        ) from None


def _plain(value: Any) -> Any:
    """A NumPy scalar as the number that it is."""
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"Object of type {type(value).__name__} is not JSON serializable")


def _seal(specification: str, task: Task, result: Result) -> str:
    return hashlib.sha256(_spelling([specification, task, result]).encode()).hexdigest()


def _write(path: Path, specification: str, task: Task, result: Result) -> Result:
    """Keep a result, and return it as it will be read."""
    content = {
        "specification": specification,
        "task": task,
        "result": result,
        "seal": _seal(specification, task, result),
    }
    text = json.dumps(content, indent=1, allow_nan=False, default=_plain)
    if len(text) > LARGEST_JSON:
        raise InputError(
            f"the result of {reprlib.repr(task)} takes {len(text)} bytes of JSON, more than "
            f"{LARGEST_JSON}; let the work write it to a file of its own, and return the name"
        )
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(
            f"cannot write {path}: {error.strerror or error}. Choose another folder"
        ) from error
    replace_file(path, text.encode())
    kept: Result = json.loads(text)["result"]
    return kept


def _read(path: Path, specification: str, task: Task) -> Result | None:
    if not is_there(path):
        return None
    remedy = "Delete it, and its result will be computed again"
    try:
        content = read_json(path, remedy)
        parts = content["specification"], content["task"], content["result"]
        whole = content["seal"] == _seal(*parts)
    except (InputError, KeyError, TypeError) as error:
        raise FileError(f"{path} is damaged ({error!r}). {remedy}") from error
    if not whole:
        raise FileError(f"{path} is not what was written: its seal does not fit. {remedy}")
    # As they are spelt: a tuple is read back as a list.
    if _spelling(parts[:2]) != _spelling([specification, task]):
        raise FileError(
            f"{path} belongs to another sweep ({parts[0]!r}, task {parts[1]!r}; wanted "
            f"{specification!r}, task {task!r}). Give another folder, or delete this one"
        )
    result: Result = parts[2]
    return result
