"""Claims over a population, of which each run tries a few members, and a slow run many, on all cores."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from typing import Any, TypeVar

import pytest

Answer = TypeVar("Answer")


def few_and_many(few: Any, many: Any, mark: pytest.MarkDecorator = pytest.mark.slow) -> list[Any]:
    """The two values of a parameter; the second one is tried in slow runs alone."""
    return [pytest.param(few, id="few"), pytest.param(many, id="many", marks=mark)]


def in_processes(task: Callable[..., Answer], *arguments: Iterable[Any]) -> Iterator[Answer]:
    """What a task gives for each set of arguments, in their order, by a process for each core."""
    pool = ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("spawn"))
    try:
        yield from pool.map(task, *arguments)
    finally:
        pool.shutdown(cancel_futures=True)
