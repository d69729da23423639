"""Single values of a problem are set by assignments."""

from __future__ import annotations

import math
from typing import Any

import pytest

from lapjoint import HarmonicsBaseMotion, InputError, paper_joint
from lapjoint.problem import BaseHarmonic
from lapjoint.problem.excitation import Wave
from lapjoint.problem.files import problem_from_tables, problem_tables
from lapjoint.problem.override import override, toml_value


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("820", 820),
        ("1e-3", 1e-3),
        ("[1, 2]", [1, 2]),
        ("inf", math.inf),
        ("top", "top"),
        ('"top"', "top"),
        ("1\nb=2", "1\nb=2"),
    ],
)
def test_an_assigned_value_is_toml_or_text(text: str, value: Any) -> None:
    assert toml_value(text) == value


def test_a_frequency_is_set_in_either_unit_whatever_the_file_has() -> None:
    tables = problem_tables(paper_joint())
    override(tables, "base_motion.frequency=10")
    assert problem_from_tables(tables).excitation_frequency == 2 * math.pi * 10
    override(tables, "base_motion.angular_frequency=515")
    assert problem_from_tables(tables).excitation_frequency == 515


def test_values_are_set_by_number_by_name_and_all_at_once() -> None:
    tables = problem_tables(paper_joint())
    for assignment in ("stops[0].gap=1", "stops.P3.gap = 2", "stops.3.gap=3", "stops.*.stiffness=7", "title=new"):
        override(tables, assignment)
    assert [stop["gap"] for stop in tables["stops"]] == [1, 2, 1e-3, 3]
    assert {stop["stiffness"] for stop in tables["stops"]} == {7}
    assert tables["title"] == "new"


def test_a_harmonic_is_set_by_its_number() -> None:
    base = HarmonicsBaseMotion(
        angular_frequency=5.0,
        harmonics=(BaseHarmonic(multiple=1, amplitude=1.0), BaseHarmonic(multiple=2, amplitude=2.0)),
    )
    tables = problem_tables(paper_joint().replace(base_motion=base))
    for assignment in ("base_motion.harmonics[1].phase=0.3", "base_motion.harmonics.*.amplitude=3"):
        override(tables, assignment)
    moved = problem_from_tables(tables).base_motion
    assert moved is not None
    assert moved.waves == (Wave(3.0, 5.0, 0.0), Wave(3.0, 10.0, 0.3))


@pytest.mark.parametrize(
    ("assignment", "message"),
    [
        ("gap", "must be key=value"),
        ("=3", "must be key=value"),
        ("stops.9.gap=3", "no element '9'; allowed are 0 to 3"),
        ("stops.P9.gap=3", "no element 'P9'"),
        ("title.x=3", "below a single value"),
    ],
)
def test_an_assignment_that_hits_nothing_is_refused(assignment: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        override(problem_tables(paper_joint()), assignment)
