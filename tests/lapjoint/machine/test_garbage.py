"""Garbage is looked for seldom while it is asked so, whoever else asks so meanwhile, and then as before."""

from __future__ import annotations

import gc
import threading
from collections.abc import Iterator

import pytest

from lapjoint.machine.garbage import seldom_collected


@pytest.fixture(autouse=True)
def thresholds() -> Iterator[tuple[int, int, int]]:
    before = gc.get_threshold()
    gc.set_threshold(700, 10, 10)
    yield gc.get_threshold()
    gc.set_threshold(*before)


@seldom_collected
def inside(nested: bool = False) -> int:
    if nested:
        inside()
    return gc.get_threshold()[0]


def test_it_is_as_before_once_the_outermost_call_returns() -> None:
    assert inside(nested=True) > 10_000
    assert gc.get_threshold() == (700, 10, 10)


def test_it_is_as_before_after_an_error() -> None:
    @seldom_collected
    def failing() -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        failing()
    assert gc.get_threshold() == (700, 10, 10)


def test_who_looks_for_none_still_does_not() -> None:
    gc.set_threshold(0, 10, 10)
    assert inside() == 0


def test_calls_in_two_threads_may_end_in_any_sequence() -> None:
    begun, ended = threading.Event(), threading.Event()

    @seldom_collected
    def waiting() -> None:
        begun.set()
        ended.wait()

    other = threading.Thread(target=waiting)

    @seldom_collected
    def first() -> None:
        other.start()
        begun.wait()

    first()
    assert gc.get_threshold()[0] > 10_000
    ended.set()
    other.join()
    assert gc.get_threshold() == (700, 10, 10)
