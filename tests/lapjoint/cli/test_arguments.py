"""What numbers the words of a command line stand for, and what its JSON files hold."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from lapjoint.cli.arguments import axes_from, axis_from, frequencies
from lapjoint.cli.options import SolverChoice
from lapjoint.cli.printing import write_json


def test_frequencies_in_hz_become_angular_ones() -> None:
    (axis,) = axes_from(10.0, 12.0, 0.5, (), hz=True)
    assert axis.values == pytest.approx([2 * math.pi * f for f in (10.0, 10.5, 11.0, 11.5, 12.0)], rel=1e-14)
    (axis,) = axes_from(10.0, 12.0, 0.5, ())
    assert axis.values == (10.0, 10.5, 11.0, 11.5, 12.0)


def test_both_ends_of_a_range_of_frequencies_belong_to_it() -> None:
    assert frequencies(1.0, 2.0, 0.25) == (1.0, 1.25, 1.5, 1.75, 2.0)
    assert frequencies(0.1, 0.7, 0.1) == pytest.approx([0.1 * i for i in range(1, 8)], rel=1e-14)
    assert frequencies(1.0, 2.1, 0.5) == (1.0, 1.5, 2.0)


def test_an_axis_is_a_range_with_both_ends_or_a_list() -> None:
    assert np.allclose(axis_from("stops.*.gap=1e-3:3e-3:5").values, [1e-3, 1.5e-3, 2e-3, 2.5e-3, 3e-3], rtol=1e-14)
    assert axis_from("damping.ratio=0.08,0.02").values == (0.08, 0.02)


def test_the_number_of_modes_is_that_of_its_own_option() -> None:
    assert SolverChoice("analytic", 12, None, ("max-periods=30",)).numerics == {"n_modes": 12, "max_periods": 30}
    assert SolverChoice("fe", None, 40, ("elements=7",)).numerics == {"elements": 40}


def test_a_number_that_is_not_finite_is_none_in_json(tmp_path: Path) -> None:
    write_json(str(tmp_path / "a.json"), {"a": [1.5, math.inf], "b": math.nan, "c": 0})
    assert json.loads((tmp_path / "a.json").read_text()) == {"a": [1.5, None], "b": None, "c": 0}
