"""What LLVM is spared: code that works all the same, from a file too, and nothing of what others compile."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest
from numba import njit
from numba.core import codegen, config, event

from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.compiled.machine_code import KNOWN, Sparing, spare_llvm

MODULE = """
import math
from lapjoint.compiled.compiling import njit_called, njit_inner

@njit_inner()
def ratio(x, y):
    return x / y

@njit_inner()
def root(x, y):
    if y > 3.0:
        raise ValueError("y is large")
    return math.sqrt(ratio(x, y))

@njit_called()
def one(x, y):
    return root(x, y)

@njit_called()
def two(x, y):
    return root(x, y) + one(x, y)
"""
USE = """
import sys, made
from lapjoint.compiled.machine_code import Sparing
print(getattr(made, sys.argv[1])(8.0, 2.0), sum(getattr(made, sys.argv[1]).stats.cache_hits.values()), Sparing.on)
for y in (0.0, 4.0):
    try:
        getattr(made, sys.argv[1])(1.0, y)
    except (ZeroDivisionError, ValueError) as error:
        print(type(error).__name__, error)
"""


@pytest.mark.thorough
def test_functions_that_only_compiled_ones_call_work_from_a_file_too(tmp_path: Path) -> None:
    (tmp_path / "made.py").write_text(MODULE, encoding="utf-8")
    (tmp_path / "use.py").write_text(USE, encoding="utf-8")
    said = [
        subprocess.run(
            [sys.executable, str(tmp_path / "use.py"), name], capture_output=True, text=True, check=True, cwd=tmp_path
        ).stdout.splitlines()
        for name in ("one", "two", "two")
    ]
    errors = ["ZeroDivisionError division by zero", "ValueError y is large"]
    assert said == [["2.0 0 False", *errors], ["4.0 0 False", *errors], ["4.0 1 False", *errors]]


@pytest.fixture
def nothing_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What a test compiles is in no file yet."""
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))


@pytest.mark.usefixtures("nothing_kept")
def test_a_function_has_its_own_copies_of_what_it_calls() -> None:
    """Else the one that is loaded first gives its copies to the others, which may be compiled otherwise."""

    @njit_inner(inline="never")
    def all_halves(x: np.ndarray) -> float:
        total = 0.0
        for i in range(x.size):
            total += x[i] / 2
        return total

    @njit_called(vectorised=True)
    def called(x: np.ndarray) -> float:
        return all_halves(x) + x[0]

    assert called(np.ones(3)) == 2.5
    (compiled,) = called.overloads.values()  # type: ignore[attr-defined]
    assert "define" in compiled.library.get_llvm_str()
    assert "linkonce_odr" not in compiled.library.get_llvm_str()


class Seen(event.Listener):  # type: ignore[misc]
    """Whether LLVM is spared, and whether loops are vectorised, whenever numba works with LLVM."""

    def __init__(self) -> None:
        self.ways = set[tuple[bool, int]]()

    def on_start(self, event: object) -> None:
        self.ways.add((Sparing.on, config.LOOP_VECTORIZE))

    def on_end(self, event: object) -> None:
        pass


@pytest.mark.usefixtures("nothing_kept")
def test_only_what_python_calls_becomes_machine_code() -> None:
    @njit_inner()
    def half(x: float) -> float:
        return x / 2

    @njit_called()
    def quarter(x: float) -> float:
        return half(half(x))

    ours, theirs, vectorised = Seen(), Seen(), config.LOOP_VECTORIZE
    with event.install_listener("numba:llvm_lock", ours):
        assert quarter(3.0) == 0.75
    (inner,), (called,) = half.overloads.values(), quarter.overloads.values()  # type: ignore[attr-defined]
    known = numba.__version__.startswith(KNOWN)
    assert (inner.library.only_for_compiled, called.library.only_for_compiled) == (known, False)
    assert (True, 0) in ours.ways
    with event.install_listener("numba:llvm_lock", theirs):
        assert njit(lambda x: x + 1)(1) == 2  # of another project
    assert theirs.ways == {(False, vectorised)}


@pytest.mark.parametrize("why", ["another release", "built otherwise"])
def test_a_numba_that_has_not_been_tried_is_left_as_it_is(why: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if why == "another release":
        monkeypatch.setattr(numba, "__version__", "0.99.0")
    else:
        monkeypatch.delattr(codegen.JITCPUCodegen, "set_env")
    before = dict(vars(codegen.JITCodeLibrary))
    assert not spare_llvm()
    assert dict(vars(codegen.JITCodeLibrary)) == before
