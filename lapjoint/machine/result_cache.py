"""Caches of results with a bound on their number and on the size of their arrays.

`functools.lru_cache` bounds the number alone: results of 15 kB with 20 modes take 2 MB each with 500.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from functools import update_wrapper
from threading import Lock
from typing import Any, Generic, ParamSpec, TypeVar

import numpy as np

P = ParamSpec("P")
T = TypeVar("T")

MOST_BYTES = 100_000_000
"""Largest size of the arrays that one function keeps, bytes: a few such functions take less than a gigabyte."""


class ResultCache(Generic[P, T]):
    """A function of positional hashable arguments whose latest results are kept; the last one is, however large it is.

    It keeps at most `most` results, and at most `most_bytes` bytes of arrays. Threads may call it: two that miss the
    same result at once both make it.
    """

    def __init__(self, make: Callable[P, T], most: int, most_bytes: int) -> None:
        self._make, self._most, self._most_bytes = make, most, most_bytes
        self._found: OrderedDict[tuple[Any, ...], tuple[T, int]] = OrderedDict()
        self._bytes, self._lock = 0, Lock()
        update_wrapper(self, make)

    def __call__(self, *args: P.args, **none: P.kwargs) -> T:
        """The result for these arguments, kept or made."""
        assert not none
        with self._lock:
            if args in self._found:
                self._found.move_to_end(args)
                return self._found[args][0]
        made = self._make(*args, **none)
        size = bytes_in(made)
        with self._lock:
            self._bytes += size - self._found.pop(args, (made, 0))[1]
            self._found[args] = made, size
            while len(self._found) > 1 and (len(self._found) > self._most or self._bytes > self._most_bytes):
                self._bytes -= self._found.popitem(last=False)[1][1]
        return made

    def cache_clear(self) -> None:
        """Keep nothing of what was found before."""
        with self._lock:
            self._found.clear()
            self._bytes = 0


def cached(most: int, most_bytes: int = MOST_BYTES) -> Callable[[Callable[P, T]], ResultCache[P, T]]:
    """A decorator that keeps the latest results of a function; see `ResultCache`."""
    return lambda make: ResultCache(make, most, most_bytes)


def bytes_in(value: object) -> int:
    """The size of the arrays in a value, in its fields and its items, bytes; an array held twice counts twice."""
    if isinstance(value, np.ndarray):
        return value.nbytes
    if isinstance(value, tuple):
        return sum(bytes_in(item) for item in value)
    return sum(bytes_in(item) for item in getattr(value, "__dict__", {}).values())
