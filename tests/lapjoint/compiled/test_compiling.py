"""Compiled functions: without a folder for machine code, and what is said and done while numba compiles."""

from __future__ import annotations

import gc
import logging

import pytest

from lapjoint.cli.progress import tell_of_delays
from lapjoint.compiled.compiling import LOGGER, MESSAGE, Listener, njit_called, njit_inner


def test_where_no_folder_may_be_written_to_functions_are_compiled_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(**_: object) -> None:
        raise OSError("Read-only file system")

    monkeypatch.setattr("tempfile.TemporaryFile", refuse)  # by which numba tries whether it may write

    @njit_inner()
    def half(x: float) -> float:
        return x / 2

    @njit_called()
    def quarter(x: float) -> float:
        return half(half(x))

    assert quarter(3.0) == 0.75


def compiled(listener: Listener, times: int = 1) -> None:
    """Tell a listener that numba compiles, so many times one after the other."""
    for _ in range(times):
        listener.on_start(None)
        listener.on_end(None)


def test_while_numba_compiles_garbage_is_looked_for_rarely_and_as_before_when_it_is_done() -> None:
    before, listener = gc.get_threshold(), Listener()
    listener.on_start(None)
    compiled(listener)
    assert gc.get_threshold()[0] > before[0]
    listener.on_end(None)
    assert gc.get_threshold() == before


def test_the_command_line_says_once_on_standard_error_that_it_compiles(capsys: pytest.CaptureFixture[str]) -> None:
    level = LOGGER.level
    try:
        tell_of_delays()
        tell_of_delays()
        compiled(Listener(), 2)
        assert capsys.readouterr() == ("", f"lapjoint: {MESSAGE}\n")
    finally:
        LOGGER.handlers.clear()
        LOGGER.setLevel(level)


def test_python_is_told_nothing_unless_it_asks(caplog: pytest.LogCaptureFixture) -> None:
    compiled(Listener())
    assert not caplog.records
    with caplog.at_level(logging.INFO, LOGGER.name):
        compiled(Listener())
    assert caplog.messages == [MESSAGE]
