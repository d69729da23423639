"""Compiled functions: how they are compiled, where the machine code is kept, and how a user hears of compiling.

numba compiles a function when it is first called, and keeps the machine code in a file beside its source, or in the
user's own cache where the package's folder may not be written to.  Where neither may be, each process compiles anew.
Machine code is valid for one content of all that was compiled into it: see `lapjoint.compiled.cache`.

For each function numba writes two more, by which Python and C call it.  Functions that only compiled functions call do
without these, and without more (`lapjoint.compiled.machine_code`): they are `njit_inner`.

Arithmetic is done as it is written, without numba's `fastmath`.  With it LLVM would order and join operations as suits
the processor and the code compiled before, so that two processes would differ in last bits.  Without it all bits agree,
however LLVM optimises, on any processor, except through the linear algebra and the C library's exponential and sines,
which choose their own code.  Reordering of sums gained 1 % at most.

Loops are vectorised only on request.  Vectorising takes a sixth of the time to compile, and does not make a march
faster. Functions that carry many deviations at once take two thirds of the time with it.

`LOGGER` says when compiling begins; the command line prints it.
"""

from __future__ import annotations

import gc
import logging
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar

from numba import njit
from numba.core import config, event

from lapjoint.compiled.absent_fields import Compiler
from lapjoint.compiled.cache import ContentCache
from lapjoint.compiled.machine_code import Sparing, spare_llvm

F = TypeVar("F", bound=Callable[..., Any])

LOGGER = logging.getLogger(__name__)
MESSAGE = "compiling for this machine, once: this takes some seconds"
"""The message when compiling begins, once in a process."""
_RARELY = 50_000
"""Objects made between Python's searches for cyclic garbage while numba compiles, seventy times as many as usual:
nearly all of them live until the end, and the usual searches take a ninth of the time."""

_OWN: dict[Callable[..., Any], bool] = {}
"""The compiled functions of this project, and whether their loops are vectorised; others are left alone."""


def njit_called(*, vectorised: bool = False, **options: Any) -> Callable[[F], F]:
    """A decorator that compiles a function that Python calls, with `options` of `numba.njit` other than `fastmath`.

    With `vectorised` the loops of the function and of all compiled functions that it calls are vectorised.
    """

    compiler: Any = njit
    assert "fastmath" not in options

    def compiled(function: F) -> F:
        made = compiler(no_cfunc_wrapper=True, pipeline_class=Compiler, **options)(function)
        with suppress(RuntimeError):  # no folder to keep the machine code in
            made._cache = ContentCache(made)
        _OWN[function] = vectorised
        result: F = made
        return result

    return compiled


def njit_inner(**options: Any) -> Callable[[F], F]:
    """A decorator that compiles a function that only compiled functions can call, with `options` of `numba.njit`."""
    return njit_called(no_cpython_wrapper=True, **options)


class Listener(event.Listener):  # type: ignore[misc]
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
event.register("numba:compile", Listener())
