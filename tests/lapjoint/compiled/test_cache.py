"""What was compiled counts as long as nothing changes that went into it: never the answer of another program."""

from __future__ import annotations

import importlib
import os
import pickle
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

import lapjoint

LOWEST = """
import numpy as np
from lapjoint.compiled.compiling import njit_inner

LIMIT, TABLE, SAME = 2.0, np.array([1.0, 2.0]), (1, 2.0)

@njit_inner()
def lowest(x):
    return x * LIMIT + TABLE[1]
"""
LOW = """
from lapjoint.compiled.compiling import njit_inner
from kept_lowest import SAME, lowest

@njit_inner()
def low(x):
    return lowest(x) + 3.0 + SAME[1]
"""
HIGH = """
from typing import NamedTuple
import kept_low
from lapjoint.compiled.compiling import njit_called, njit_inner

class Pair(NamedTuple):
    one: float
    two: float

@njit_inner()
def same(x):
    return x

def ten_times(function):
    @njit_called()
    def again(x):
        return 10.0 * function(x.two)
    return again

again = ten_times(same)

@njit_called()
def high(x):
    return kept_low.low(x.one) + again(x)
"""
SOURCES = {"kept_lowest": LOWEST, "kept_low": LOW, "kept_high": HIGH}
FEW = ("a constant", "what is called by what is called", "its own file, of the same length")
UNCHANGED = 29.0  # high(Pair(1.0, 2.0)) = (1 * 2 + 2) + 3 + 2 + 10 * 2
CHANGES = {
    "a constant": ("kept_lowest", "LIMIT, TABLE, SAME = 2.0", "LIMIT, TABLE, SAME = 4.0", 31.0),
    "an array": ("kept_lowest", "np.array([1.0, 2.0])", "np.array([1.0, 5.0])", 32.0),
    "a tuple": ("kept_lowest", "(1, 2.0)", "(1, 7.0)", 34.0),
    "what is called by what is called": ("kept_lowest", "x * LIMIT", "x + LIMIT", 30.0),
    "a constant within a function": ("kept_low", "+ 3.0", "+ 8.0", 34.0),
    "its own file, of the same length": ("kept_high", "10.0 * function", "20.0 * function", 49.0),
    "what a function encloses": ("kept_high", "def same(x):\n    return x", "def same(x):\n    return 4", 49.0),
    "the sequence of a table": ("kept_high", "one: float\n    two: float", "two: float\n    one: float", 21.0),
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder of modules that compile, on the path."""
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    yield tmp_path
    for name in SOURCES:
        sys.modules.pop(name, None)


def loaded(folder: Path, sources: dict[str, str]) -> ModuleType:
    """The highest module, as a new process would load it; all files have one time."""
    for name, source in sources.items():
        (folder / f"{name}.py").write_text(source)
        os.utime(folder / f"{name}.py", (1e9, 1e9))
        sys.modules.pop(name, None)
    importlib.invalidate_caches()
    return importlib.import_module("kept_high")


def answer(module: ModuleType) -> tuple[float, int]:
    """What the compiled function says, and how often it was taken from what was kept."""
    found = float(module.high(module.Pair(1.0, 2.0)))
    return found, sum(module.high.stats.cache_hits.values())


@pytest.mark.parametrize("what", [pytest.param(it, marks=() if it in FEW else pytest.mark.thorough) for it in CHANGES])
def test_a_change_anywhere_in_what_was_compiled_is_seen(what: str, folder: Path) -> None:
    module, old, new, changed = CHANGES[what]
    assert SOURCES[module].count(old) == 1
    assert answer(loaded(folder, SOURCES)) == (UNCHANGED, 0)
    assert answer(loaded(folder, SOURCES)) == (UNCHANGED, 1)
    assert answer(loaded(folder, SOURCES | {module: SOURCES[module].replace(old, new)})) == (changed, 0)
    assert answer(loaded(folder, SOURCES)) == (UNCHANGED, 1)


def test_what_nothing_compiled_depends_on_may_change(folder: Path) -> None:
    loaded(folder, SOURCES).high(sys.modules["kept_high"].Pair(1.0, 2.0))
    assert answer(loaded(folder, SOURCES | {"kept_low": LOW + "UNUSED = 1.0\n"})) == (UNCHANGED, 1)


@pytest.mark.parametrize("suffix", ["nbi", "nbc"])
@pytest.mark.parametrize("what", [b"nonsense", b"cno_such_module\nname\n.", b""], ids=["damaged", "moved", "cut"])
def test_files_that_cannot_be_read_are_made_anew(suffix: str, what: bytes, folder: Path) -> None:
    assert answer(loaded(folder, SOURCES)) == (UNCHANGED, 0)
    for file in folder.rglob(f"kept_high.high*.{suffix}"):
        written = file.read_bytes()
        version = pickle.dumps(pickle.loads(written), protocol=-1) if suffix == "nbi" else b""
        assert written.startswith(version)
        file.write_bytes(version + what)
    assert answer(loaded(folder, SOURCES)) == (UNCHANGED, 0)
    assert answer(loaded(folder, SOURCES)) == (UNCHANGED, 1)


def test_every_module_that_has_a_say_in_how_numba_compiles_counts() -> None:
    ground = Path(lapjoint.__file__).parent
    told = {
        file.parent for file in ground.rglob("*.py") if re.search(r"^from (numba|llvmlite)", file.read_text(), re.M)
    }
    assert told == {ground / "compiled"}


@pytest.mark.thorough
def test_every_process_finds_what_another_has_kept() -> None:
    """Sets in options and constants are written in a sequence that hashes of strings do not decide."""
    script = (
        "import analytic.march.march, fe_lapjoint.march.march; from numba.core.dispatcher import Dispatcher; "
        "import sys; from lapjoint.compiled.cache import content_of; "
        "print([content_of(v) for m in sorted(sys.modules) if m.startswith(('analytic', 'fe_lapjoint', 'lapjoint')) "
        "for v in vars(sys.modules[m]).values() if isinstance(v, Dispatcher)])"
    )
    said = {
        subprocess.run(
            [sys.executable, "-c", script], env=os.environ | {"PYTHONHASHSEED": seed}, capture_output=True, check=True
        ).stdout
        for seed in ("1", "2")
    }
    assert len(said) == 1
    assert len(said.pop()) > 1000
