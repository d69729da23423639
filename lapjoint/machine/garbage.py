"""Python's search for cyclic garbage, made seldom where many objects are made and hardly any are garbage.

Python looks through young objects after every 700 that are made, and now and then through all.  What follows a branch
makes some hundred for each march, which live as long as their motion: looking takes 5 to 8 % of its time.
"""

from __future__ import annotations

import gc
import threading
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")

_RARELY = 50_000
"""Objects that are made until Python looks again."""


class _Within:
    """How many calls are under way, in all threads, and the thresholds before the first of them."""

    lock = threading.Lock()
    calls = 0
    before = gc.get_threshold()


def seldom_collected(function: Callable[P, T]) -> Callable[P, T]:
    """Have a function look for garbage seldom; once no such call is under way, the thresholds of `gc` are restored."""

    @wraps(function)
    def called(*args: P.args, **kwargs: P.kwargs) -> T:
        with _Within.lock:
            if not _Within.calls:
                _Within.before = gc.get_threshold()
                if _Within.before[0]:  # else nothing is looked for at all
                    gc.set_threshold(max(_RARELY, _Within.before[0]), *_Within.before[1:])
            _Within.calls += 1
        try:
            return function(*args, **kwargs)
        finally:
            with _Within.lock:
                _Within.calls -= 1
                if not _Within.calls:
                    gc.set_threshold(*_Within.before)

    return called
