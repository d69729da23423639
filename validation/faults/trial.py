"""One trial: the judge's cases on one tree of the packages, in this process, until something disagrees.

`try_tree` runs in a process of its own that was forked with the heavy libraries loaded, see `preload`.  It forgets the
packages that are loaded, and imports those of the tree.
"""

from __future__ import annotations

import importlib
import math
import resource
import signal
import sys
import time
from collections.abc import Callable
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from enum import Enum
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from validation.case import Level
from validation.faults.changed_tree import PACKAGES


class Result(Enum):
    """Outcome of a trial; the values stand in tables."""

    CAUGHT = "caught"
    MISSED = "not caught"
    CRASHED = "crashed"
    TOO_SLOW = "too slow"


@dataclass(frozen=True)
class Seen:
    """The outcome of the trial of one tree."""

    result: Result
    case: str = ""
    """The case that disagreed, crashed or took too long."""
    item: str = ""
    """The comparison that disagreed, or the error."""
    number: str = ""
    """The number by which the comparison disagreed, with its unit."""
    bound: str = ""
    """The bound of the number, with its unit."""
    seconds: float = 0.0
    """Processor time of all cases up to `case`, s."""
    spent: tuple[tuple[str, float], ...] = ()
    """Each case that ran, and its processor time, s."""


def try_tree(tree: str, cases: tuple[tuple[str, float], ...], level: Level, connection: Connection) -> None:
    """Run cases on the packages of a tree until one disagrees.

    Each case comes with the most processor time that it may take, s.  The connection takes the name of each case
    when it begins, and at the end the fields of `Seen` as a dict.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _forget_packages(tree)
    spent: list[tuple[str, float]] = []
    seen: dict[str, Any] = {"result": Result.MISSED.value}
    for case, most in cases:
        connection.send(case)
        began = time.process_time()
        _allow(began + most)
        try:
            run = importlib.import_module(f"validation.cases.{case}").run
            found = _first_disagreement(run(level, lambda _: None))
        except Exception as error:
            line = str(error).strip().partition("\n")[0]
            found = {"result": Result.CRASHED.value, "item": f"{type(error).__name__}: {line}"}
        spent.append((case, time.process_time() - began))
        if found is not None:
            seen = {**found, "case": case}
            break
    connection.send({**seen, "seconds": sum(seconds for _, seconds in spent), "spent": spent})
    connection.close()


def _first_disagreement(answer: Any) -> dict[str, Any] | None:
    """The first comparison of a case that disagrees, as fields of `Seen`; its class may be of another copy."""
    for item in answer.items:
        if item.verdict.name == "DISAGREE":
            number, bound = measured(item)
            return {"result": Result.CAUGHT.value, "item": item.name, "number": number, "bound": bound}
    return None


def measured(item: Any) -> tuple[str, str]:
    """The number by which a `Check` or `Criterion` disagrees, and its bound, both with their unit.

    Its class may be of another copy of the packages.
    """
    unit = "" if item.unit == "1" else f" {item.unit}"
    if not hasattr(item, "a"):
        low, high = item.low, item.high
        if low == high:
            bound = f"{low:g}"
        elif math.isinf(low) or math.isinf(high):
            bound = f"at most {high:g}" if math.isinf(low) else f"at least {low:g}"
        else:
            bound = f"{low:g} to {high:g}"
        return f"{item.value:.3g}{unit}", f"{bound}{unit}"
    if abs(item.difference) <= item.allowed and item.cap is not None:
        return f"{item.relative:.2g}, relative", f"{item.cap:g}, relative"
    return f"{abs(item.difference):.2g}{unit}", f"{item.allowed:.2g}{unit}"


def _allow(seconds: float) -> None:
    """End this process by the signal SIGXCPU when it has used so much time of the processor, s."""
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(seconds) + 1, hard))


def _forget_packages(tree: str) -> None:
    """Let the packages be imported from a tree; its compiled functions are kept there, and its pools run here."""
    for name in [name for name in sys.modules if name.partition(".")[0] in PACKAGES]:
        del sys.modules[name]
    sys.path.insert(0, tree)
    importlib.invalidate_caches()
    importlib.import_module("numba").config.CACHE_DIR = ""
    processes: Any = importlib.import_module("lapjoint.machine.processes")
    if not Path(processes.__file__).is_relative_to(tree):
        raise ImportError(f"the packages are not imported from {tree}")
    processes.new_pool = _Here
    importlib.import_module("lapjoint.campaigns.workers").__dict__["new_pool"] = _Here
    drawing: Any = importlib.import_module("validation.report.drawing")
    kind: Any = importlib.import_module("validation.case").__dict__["Drawing"]
    drawing.draw = lambda title, paint, **_: kind(title, "")  # nothing is judged by its figures


class _Here(Executor):
    """A pool that does every task at once in the process of the trial, in place of a pool of processes."""

    def __init__(self, workers: int) -> None:
        self._processes: dict[int, Any] = {}
        self._executor_manager_thread = self._result_queue = None

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call a function, and keep what it gives or raises. See `concurrent.futures.Executor`."""
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future
