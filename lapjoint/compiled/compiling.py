"""Compiled functions: how they are compiled, where the machine code is kept, and how one gets to know.

numba compiles a function when it is first called, and keeps the machine code in a file beside its source, or in the
user's own cache where the package's folder may not be written to.  Where neither may be, each process compiles anew.
What is kept is valid for one content of all that was compiled in: see `lapjoint.compiled.cache`.

numba writes two more functions for each, by which Python and C call it.  What only other compiled functions call does
without them, and is spared more, see `lapjoint.compiled.machine_code`: it is `njit_inner`.

Arithmetic is done as it is written, without numba's `fastmath`.  LLVM would else order and join operations as suits the
processor, and what was compiled before in the same process: two processes that compiled the same function each had
other last bits.  As it is, all of them have the same, however LLVM optimises, and for whichever processor, but for what
they call: the linear algebra, and the exponential and the sines of the C library, which choose their own code.  To let
it reorder sums was a hundredth faster at most.

Loops are vectorised only where that is asked for.  It would take a sixth of the time to compile, and has not been found
to make a march faster.  What carries many deviations at once takes two thirds of the time with it.

`LOGGER` says when compiling begins; nobody listens but the command line.
"""

from __future__ import annotations

import gc
import logging
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar

from numba import njit
from numba.core import config, event

from lapjoint.compiled.cache import ContentCache
from lapjoint.compiled.machine_code import Sparing, spare_llvm

F = TypeVar("F", bound=Callable[..., Any])

LOGGER = logging.getLogger(__name__)
MESSAGE = "compiling for this machine, once: this takes some seconds"
"""What is said when compiling begins, once in a process."""
_RARELY = 50_000
"""Objects made until Python looks for cyclic garbage while numba compiles, seventy times as many as usual.  Nearly all
of them live until the end, so that looking takes a ninth of the time, and finds nothing."""

_OWN: dict[Callable[..., Any], bool] = {}
"""The functions of this project that are compiled, and whether their loops are vectorised; what else numba compiles in
this process is left as it is."""


def njit_called(*, vectorised: bool = False, **options: Any) -> Callable[[F], F]:
    """A decorator that compiles a function that Python calls, with `options` of `numba.njit` other than `fastmath`.

    With `vectorised` the loops of the function and of all compiled functions that it calls are vectorised.
    """

    compiler: Any = njit
    assert "fastmath" not in options

    def compiled(function: F) -> F:
        made = compiler(no_cfunc_wrapper=True, **options)(function)
        with suppress(RuntimeError):  # no folder to keep the machine code in
            made._cache = ContentCache(made)
        _OWN[function] = vectorised
        result: F = made
        return result

    return compiled


def njit_inner(**options: Any) -> Callable[[F], F]:
    """A decorator that compiles a function that only compiled functions can call, with `options` of `numba.njit`."""
    return njit_called(no_cpython_wrapper=True, **options)


class _Listener(event.Listener):  # type: ignore[misc]
    """Told by numba of everything that it compiles, while it holds its lock."""

    def __init__(self) -> None:
        self._depth, self._thresholds, self._said = 0, gc.get_threshold(), False
        self._vectorised = config.LOOP_VECTORIZE

    def on_start(self, event: Any) -> None:
        """Another function is compiled, perhaps because one that is being compiled calls it."""
        self._depth += 1
        if self._depth == 1:
            self._thresholds = gc.get_threshold()
            if self._thresholds[0]:
                gc.set_threshold(_RARELY, *self._thresholds[1:])
            self._vectorised = config.LOOP_VECTORIZE
            own = None if event is None else _OWN.get(event.data["dispatcher"].py_func)
            if own is not None:
                config.LOOP_VECTORIZE, Sparing.on = int(own), True
        if not self._said:
            self._said = True
            LOGGER.info(MESSAGE)

    def on_end(self, event: Any) -> None:
        """It is compiled, or could not be."""
        self._depth -= 1
        if not self._depth:
            gc.set_threshold(*self._thresholds)
            config.LOOP_VECTORIZE, Sparing.on = self._vectorised, False


spare_llvm()
event.register("numba:compile", _Listener())
