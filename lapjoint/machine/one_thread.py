"""Linear algebra in one thread, so that no bit of an answer depends on the number of processors.

BLAS splits the product of two matrices among its threads, which changes the last bits of sums.  In a chaotic transient
last bits decide which motion is reached.  The matrices here are too small to gain from threads; sweeps gain from
processes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache, wraps
from itertools import islice
from threading import Lock, local
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


class _Limit:
    """The limit of one thread, which holds for the whole process as long as any thread needs it."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._here = local()
        self._threads = 0
        """Number of threads of this process that need the limit."""
        self._before: list[int | None] = []
        """Numbers of threads of the libraries before the first thread needed the limit."""

    def __enter__(self) -> None:
        self._here.depth = getattr(self._here, "depth", 0) + 1
        if self._here.depth > 1:
            return
        with self._lock:
            if not self._threads:
                self._before = [library.num_threads for library in _libraries()]
            self._threads += 1
            for library in _libraries():  # for each thread anew: some libraries count for each thread by itself
                _set(library, 1)

    def __exit__(self, *error: object) -> None:
        self._here.depth -= 1
        if self._here.depth:
            return
        with self._lock:
            self._threads -= 1
            if not self._threads:
                for library, threads in zip(_libraries(), self._before, strict=True):
                    _set(library, threads)


def _set(library: Any, threads: int | None) -> None:
    """Set the number of threads of a library, from any thread of this process."""
    # threadpoolctl 3.7 lets only the thread that set OpenBLAS first set it again; a call of any other does nothing.
    release = getattr(library, "clear_controlling_thread", lambda force: None)
    release(force=True)
    library.set_num_threads(threads)
    release(force=True)


@cache
def _libraries() -> tuple[Any, ...]:
    """The libraries of linear algebra that this process has loaded."""
    import numpy as np  # noqa: F401  # only what is loaded can be limited
    import scipy.linalg  # noqa: F401
    from threadpoolctl import ThreadpoolController

    return tuple(ThreadpoolController().select(user_api="blas").lib_controllers)


_LIMIT = _Limit()


def in_one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Make a function, and all that it calls, run its linear algebra in one thread.

    The limit holds for the process, in all of its threads, until the last such function returns; then the number of
    threads is what it was before the first.
    """

    @wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        with _LIMIT:
            return function(*args, **kwargs)

    return limited


def each_in_one_thread(items: Iterator[R]) -> Iterator[R]:
    """The items of an iterator, each made under the limit; between them the limit does not hold."""
    more = True
    while more:
        with _LIMIT:
            made = list(islice(items, 1))
        more = bool(made)
        yield from made
