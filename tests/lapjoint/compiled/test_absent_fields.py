"""Fields that are None: what depends on them is neither compiled nor run, and all else is as before."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from numba.core.errors import TypingError

from lapjoint.compiled.by_reference import by_reference
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray


@by_reference
class Perhaps(NamedTuple):
    """An array, and one that may be missing."""

    row: FloatArray
    more: FloatArray | None


def _no_code(values: Perhaps) -> float:
    """A function that no compiled function can call."""
    raise NotImplementedError


@njit_called()
def _never_without(values: Perhaps) -> float:
    if values.more is not None:
        return _no_code(values)
    return values.row[0]


@njit_inner()
def _more(values: Perhaps, i: int) -> float:
    return 0.0 if values.more is None else values.more[i]


@njit_called()
def _sum(values: Perhaps, twice: bool) -> float:
    total = 0.0
    for i in range(values.row.size):
        total += values.row[i]
        if twice and values.more is not None:
            for k in range(values.more.size):
                total += values.more[k]
        total += _more(values, i)
    return total


def test_code_that_needs_a_missing_field_is_not_compiled() -> None:
    assert _never_without(Perhaps(np.array([2.0]), None)) == 2.0
    with pytest.raises(TypingError, match="_no_code"):
        _never_without(Perhaps(np.array([2.0]), np.zeros(1)))


@pytest.mark.parametrize("twice", [False, True])
def test_one_function_takes_tuples_with_and_without_the_field(twice: bool) -> None:
    row, more = np.arange(3.0), np.array([10.0, 20.0, 40.0])
    for _ in range(2):
        assert _sum(Perhaps(row, None), twice) == 3.0
        assert _sum(Perhaps(row, more), twice) == 3.0 + 70.0 + 3 * 70.0 * twice


@pytest.mark.thorough
def test_a_joint_without_dampers_compiles_nothing_of_coupled_states(tmp_path: Path) -> None:
    code = """
from numba.core import event
names = []
class Names(event.Listener):
    def on_start(self, it): names.append(it.data["dispatcher"].py_func.__name__)
    def on_end(self, it): pass
event.register("numba:compile", Names())
import sys, analytic, lapjoint
from numba.core.dispatcher import Dispatcher
analytic.Solver(n_modes=2).simulate(lapjoint.paper_joint(), 1e-4)
known = [it.py_func.__name__ for one in list(sys.modules.values()) if one.__name__.startswith("analytic.")
         for it in vars(one).values() if isinstance(it, Dispatcher)]
print(*names)
print(*known)
"""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", code], check=True, env=environment, capture_output=True, text=True)
    compiled, known = (
        {name for name in line.split() if "coupled" in name or "twisted" in name} for line in done.stdout.splitlines()
    )
    assert done.stdout.splitlines()[0], "nothing was compiled"
    assert known
    assert compiled == set()
