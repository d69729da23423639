"""What a process that computes one thing alone would give, to compare with what it gives beside others."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from threading import Barrier
from typing import TypeVar

T = TypeVar("T")

OFTEN = 1e-6
"""Time after which Python gives another thread its turn, s: as often as it can, so that threads meet in mid-work."""


def forget() -> None:
    """Empty every cache of both solvers, so that they know what a fresh process knows."""
    modules = [it for name, it in sys.modules.items() if name.partition(".")[0] in ("analytic", "fe_lapjoint")]
    for kept in [value for module in modules for value in vars(module).values()]:
        if hasattr(kept, "cache_clear"):
            kept.cache_clear()


@contextmanager
def restless_threads(count: int, interval: float = OFTEN) -> Iterator[ThreadPoolExecutor]:
    """Threads that take turns after every `interval`, s."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(interval)
    try:
        with ThreadPoolExecutor(count) as threads:
            yield threads
    finally:
        sys.setswitchinterval(before)


def assert_the_same_in_threads_that_know_nothing(answer: Callable[[float], T], questions: Sequence[float]) -> None:
    """Each question in a thread of its own, all begun at once with cold caches, as each alone with cold caches."""
    expected = []
    for question in questions:
        forget()
        expected.append(answer(question))
    forget()
    together = Barrier(len(questions))

    def in_a_thread(question: float) -> T:
        together.wait()
        return answer(question)

    with restless_threads(len(questions)) as threads:
        assert list(threads.map(in_a_thread, questions)) == expected
