"""Random excitation in the problem: its units, its defaults, its file, and what is said of it."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

from lapjoint import InputError, paper_joint
from lapjoint.errors import ExcitationWarning
from lapjoint.problem import Problem, RandomBaseMotion, RandomLoad, RecordLoad
from lapjoint.problem.files import from_toml, json_schema, problem_from_tables, problem_tables, to_toml
from lapjoint.problem.override import override
from lapjoint.problem.ramps import RandomForce
from lapjoint.problem.random_motion import DENSITIES
from lapjoint.problem.record_units import G

BAND = ((5.0, 80.0), (500.0, 80.0))


def _tables(**base: Any) -> dict[str, Any]:
    return problem_tables(paper_joint()) | {"base_motion": {"kind": "random", **base}}


def _shaken(**changes: Any) -> Problem:
    return paper_joint().replace(base_motion=RandomBaseMotion(psd=BAND, **changes))


def test_a_problem_file_with_random_parts_comes_back_as_it_was() -> None:
    load = RandomLoad(x=2.5, psd=((10.0, 1e-3), (40.0, 2e-3), (90.0, 1e-4)), unit="kN2/Hz", rate=900.0, seed=4)
    problem = _shaken(seed=2).replace(point_loads=(load,))
    assert from_toml(to_toml(problem)) == problem
    assert list(problem.random) == ["base_motion", "point_loads[0]"]
    tables = problem_tables(problem)
    for assignment in ("base_motion.seed=7", "base_motion.psd.1.0=400", "point_loads.0.psd=[[20, 1], [30, 2]]"):
        override(tables, assignment)
    changed = problem_from_tables(tables)
    assert changed.base_motion == RandomBaseMotion(psd=((5.0, 80.0), (400.0, 80.0)), seed=7)
    assert changed.random["point_loads[0]"].psd == ((20.0, 1.0), (30.0, 2.0))
    described = json_schema()["$defs"]["RandomBaseMotion"]["properties"]["psd"]
    assert described["minItems"] == 2
    assert "one-sided" in described["description"]


def test_units_of_a_density_are_squares_of_those_of_records() -> None:
    assert DENSITIES["acceleration"]["g2/Hz"] == G**2
    assert DENSITIES["acceleration"]["(mm/s2)2/Hz"] == 1e-6
    assert DENSITIES["force"]["kN2/Hz"] == 1e6
    one, other = RandomBaseMotion(psd=BAND), RandomBaseMotion(psd=tuple((f, s / G**2) for f, s in BAND), unit="g2/Hz")
    assert one.rms == pytest.approx(np.sqrt(80 * 495), rel=1e-12)
    assert other.rms == pytest.approx(one.rms, rel=1e-12)


def test_the_rate_follows_from_the_density_alone() -> None:
    problem = _shaken()
    assert problem.random["base_motion"].samples_per_second == 4000.0
    (force,) = problem.forces.sampled
    assert isinstance(force, RandomForce)
    assert force.rate == 4000.0
    assert force.usual_rate == pytest.approx(2 * np.pi * np.sqrt((500**3 - 5**3) / (3 * 495)), rel=1e-12)
    assert problem.longest == np.inf
    problem.check_duration(1e6)


def test_the_base_and_each_load_have_noise_of_their_own() -> None:
    load = RandomLoad(x=1.0, psd=BAND)
    forces = _shaken().replace(point_loads=(load, load)).forces.sampled
    t = np.arange(2000) / 4000.0
    values = np.array([force.at(t) for force in forces])
    assert np.max(np.abs(np.corrcoef(values) - np.eye(3))) < 0.3
    motion = _shaken().base_motion
    assert motion is not None
    assert np.allclose(values[0], -motion.at(t, 2), rtol=1e-12)


def test_another_seed_changes_every_random_part_and_nothing_else() -> None:
    load = RandomLoad(x=1.0, psd=((1.0, 1.0), (2.0, 1.0)), seed=3)  # which warns, once
    record = RecordLoad(x=2.0, values=[0.0, 1.0, 2.0], rate=1000.0)
    with pytest.warns(ExcitationWarning):
        problem = _shaken(seed=1).replace(point_loads=(load, record))
    with warnings.catch_warnings(action="error"):
        other = problem.reseeded(11)
    assert [part.seed for part in other.random.values()] == [11, 11]
    assert other.point_loads[1] == record
    assert not np.array_equal(other.forces.sampled[0].at(np.arange(9.0)), problem.forces.sampled[0].at(np.arange(9.0)))
    assert other.reseeded(1).base_motion == problem.base_motion
    with pytest.raises(ValueError, match="greater than or equal to 0"):
        problem.reseeded(-1)


def test_its_remark_says_what_it_is() -> None:
    assert _shaken(seed=3).random["base_motion"].remark == (
        "random acceleration: 199 m/s2 RMS from 5 to 500 Hz, 4000 samples a second, seed 3; "
        "the base moves by 0.0117 m RMS with 0.633 m/s RMS"
    )


def test_a_period_is_asked_for_in_vain() -> None:
    with pytest.raises(
        InputError, match="base_motion is random, and has no period; simulate it, or ask for statistics"
    ):
        _shaken().require_excitation_period("steady state")


FAULTS: list[tuple[dict[str, Any], str]] = [
    ({}, "base_motion.psd: is missing (Breakpoints of the one-sided density"),
    ({"psd": 5}, "base_motion.psd = 5: must be a list"),
    ({"psd": []}, "base_motion.psd: there are no breakpoints; at least 2 are needed"),
    ({"psd": [[5, 1]]}, "base_motion.psd: there is 1 breakpoint; at least 2 are needed"),
    ({"psd": [5, 1]}, "breakpoint 1 is 5; must be [frequency in Hz, density]"),
    ({"psd": [[5, 1], [6, 1, 2]]}, "breakpoint 2 is [6, 1, 2]; must be [frequency in Hz, density]"),
    ({"psd": [[5, 1], [5, 2]]}, "base_motion.psd: 5 Hz is there twice (breakpoint 2); frequencies must ascend"),
    ({"psd": [[5, 1], [4, 2]]}, "base_motion.psd: 4 Hz comes after 5 (breakpoint 2); frequencies must ascend"),
    ({"psd": [[0, 1], [4, 2]]}, "base_motion.psd[0][0] = 0: must be greater than 0"),
    ({"psd": [[1, 1], [4, 0]]}, "base_motion.psd[1][1] = 0: must be greater than 0"),
    ({"psd": [[1, 1], [4, float("inf")]]}, "base_motion.psd[1][1] = inf: must be a finite number"),
    ({"psd": [[1, float("nan")], [4, 1]]}, "base_motion.psd[0][1] = nan"),
    ({"psd": [[1, 1e308], [1e6, 1e308]]}, "psd: comes to inf m/s2 RMS"),
    ({"psd": [[1e-300, 1], [1e300, 1]]}, "psd: comes to inf m/s2 RMS"),
    ({"psd": [[1e-3, 1], [500, 1]]}, "psd: begins at 0.001 Hz, and a filter of 1048576 taps at 4000 samples a second"),
    ({"psd": BAND, "rate": 1200}, "rate = 1200: must be at least 2.5 times the highest frequency of the psd, 1250"),
    ({"psd": BAND, "rate": 1e306}, "rate = 1e+306: is too large for a number"),
    ({"psd": BAND, "rate": 0}, "base_motion.rate = 0: must be greater than 0"),
    ({"psd": BAND, "seed": -1}, "base_motion.seed = -1: must be at least 0"),
    ({"psd": BAND, "seed": 0.5}, "base_motion.seed = 0.5: must be a whole number"),
    ({"psd": BAND, "seed": 2**70}, "base_motion.seed = 1180591620717411303424: must be at most"),
    ({"psd": BAND, "unit": "g"}, 'unit = "g": is no unit of a density of acceleration; allowed: (m/s2)2/Hz'),
    ({"psd": BAND, "sede": 1}, "base_motion.sede: unknown key; did you mean seed?"),
]


@pytest.mark.parametrize(("base", "message"), FAULTS, ids=[row[1][:60] for row in FAULTS])
def test_a_fault_has_one_line_that_names_it(base: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as caught:
        problem_from_tables(_tables(**base))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


DOUBTS: list[tuple[dict[str, Any], str]] = [
    ({"psd": BAND, "rate": 1500}, "straight lines between samples add 6.2% of the density at 500 Hz at 1000 Hz"),
    ({"psd": [[5, 1e11], [500, 1e11]]}, "comes to 7.04e+06 m/s2 RMS, a thousand times what shakers reach"),
    ({"psd": [[0.04, 1], [500, 1]]}, "its lower edge, 0.04 Hz, smears over 0.0245 Hz at 4000 samples a second"),
    ({"psd": [[1, 1], [4, 1]]}, "base_motion: its psd ends at 4 Hz, and the beam bends at 6.59 Hz or more"),
]


@pytest.mark.parametrize(("base", "message"), DOUBTS, ids=[row[1][:40] for row in DOUBTS])
def test_what_can_hardly_be_meant_is_said(base: dict[str, Any], message: str) -> None:
    with pytest.warns(ExcitationWarning) as said:
        problem_from_tables(_tables(**base))
    assert [message in str(one.message) for one in said] == [True]
