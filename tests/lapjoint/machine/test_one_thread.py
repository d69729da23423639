"""The limit of one thread holds wherever it is asked for, and is gone when nobody needs it any more."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import pytest
import scipy.linalg  # noqa: F401  # its library is limited too, and must be there before a test asks
from threadpoolctl import threadpool_info, threadpool_limits

from lapjoint.machine.one_thread import in_one_thread


def threads() -> set[int]:
    """Numbers of threads that the libraries of linear algebra use now."""
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


@in_one_thread
def within() -> set[int]:
    return threads() | within_again()


@in_one_thread
def within_again() -> set[int]:
    return threads()


def test_it_holds_within_the_function_and_no_longer() -> None:
    with threadpool_limits(3, user_api="blas"):
        before = threads()
        assert within() == {1}
        assert threads() == before


def test_it_goes_when_the_function_raises() -> None:
    @in_one_thread
    def fails() -> None:
        raise ValueError("any error")

    before = threads()
    with pytest.raises(ValueError, match="any error"):
        fails()
    assert threads() == before


def test_it_holds_until_the_last_of_several_threads_leaves() -> None:
    """The first to come is the first to go: the others must not lose the limit with it."""
    both_in, one_out = Barrier(2), Barrier(2)

    @in_one_thread
    def first() -> None:
        both_in.wait()

    def leaves() -> None:
        first()
        one_out.wait()

    @in_one_thread
    def stays() -> set[int]:
        both_in.wait()
        one_out.wait()
        return threads()

    before = threads()
    with ThreadPoolExecutor(2) as pool:
        pool.submit(leaves)
        assert pool.submit(stays).result() == {1}
        assert pool.submit(within).result() == {1}
    assert threads() == before
