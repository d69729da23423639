"""A problem of one's own is judged whatever drives it, and what the solvers agree on is not called different."""

from __future__ import annotations

import warnings

import pytest
from few_and_many import in_processes
from population import driven_joint

from lapjoint.errors import RecordWarning
from lapjoint.problem.files import from_toml
from validation.cases import own_problem
from validation.report.asked import problem_sheets
from validation.verdict import Verdict

WORN = """
title = "A machine designer's worn joint"
[beam]
length = 0.6
added_mass_per_length = 0.2
material = {youngs_modulus = 2.05e11, density = 7850}
[[beam.segments]]
to = 0.2
section = {shape = "rectangle", breadth = 0.04, height = 0.02}
[[beam.segments]]
to = 0.6
section = {shape = "rectangle", breadth = 0.04, height = 0.012}
[[supports]]
x = 0.0
translational = inf
torsional = inf
[[masses]]
name = "clevis"
x = 0.6
mass = 0.8
rotary_inertia = 4e-4
[[stops]]
name = "top pad"
x = 0.45
side = "top"
gap = 2e-4
stiffness = 2e6
[[stops]]
name = "bottom pad"
x = 0.45
side = "bottom"
gap = -1e-5
stiffness = 2e6
[[stops]]
name = "wall"
x = 0.6
side = "bottom"
gap = 1e-3
stiffness = 1e6
fixed_to = "space"
[gravity]
acceleration = -9.81
[[uniform_loads]]
from = 0.25
to = 0.4
force_per_length = -30
[damping]
kind = "modal"
ratio = 0.02
[base_motion]
amplitude = 1e-3
angular_frequency = 120.0
"""
SEED, COUNT = 271, 200
FEW = (10, 121)  # a record; one that balances
MORE = (3, 22, 29)  # harmonics and twins; a random excitation; a record that touches nothing
FAR = 10.0  # times what is allowed: so far off is none
MOST_MISSED = 0.01  # of all numbers


def judged(index: int) -> tuple[str, int, list[tuple[str, float]], list[str]]:
    """The problem's title, the number of its checks, those that disagree and by how much, and failed criteria."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)
        problem, _ = driven_joint(SEED, index)
        parts = [own_problem.frequencies, own_problem.transient]
        if problem.excitation_frequency is not None:
            parts.append(own_problem.steady)
        if own_problem.has_equilibrium(problem):
            parts.append(own_problem.equilibrium)
        results = [part(problem, "quick", lambda text: None) for part in parts]
    checks = [check for result in results for check in result.checks]
    missed = [(it.name, abs(it.difference) / it.allowed) for it in checks if it.verdict is Verdict.DISAGREE]
    failed = [it.line for result in results for it in result.criteria if it.verdict is Verdict.DISAGREE]
    return problem.title, len(checks), missed, failed


@pytest.mark.parametrize("index", [*FEW, *(pytest.param(it, marks=pytest.mark.thorough) for it in MORE)])
def test_a_few_problems_of_ones_own_are_judged_and_agree(index: int) -> None:
    _, count, missed, failed = judged(index)
    assert count
    assert not missed
    assert not failed


@pytest.mark.thorough
def test_the_witness_of_energy_is_not_misled_by_two_quadratures_that_agree_by_chance() -> None:
    *_, failed = judged(31)
    assert not failed


@pytest.mark.slow
def test_many_problems_of_ones_own_are_judged_and_agree() -> None:
    found = list(in_processes(judged, range(COUNT)))
    missed = [(title, *one) for title, _, several, _ in found for one in several]
    assert not [(title, failed) for title, _, _, failed in found if failed]
    assert all(ratio <= FAR for _, _, ratio in missed), missed
    assert len(missed) <= MOST_MISSED * sum(count for _, count, _, _ in found), missed


def test_where_a_joint_rests_is_judged_if_it_has_static_loads_or_preload() -> None:
    problem = from_toml(WORN)
    assert own_problem.has_equilibrium(problem)
    result = own_problem.equilibrium(problem, "quick", lambda text: None)
    assert result.verdict is Verdict.AGREE
    assert [check.unit for check in result.checks] == ["N"] * 3 + ["m"] * 2 + ["N"]
    assert any(check.a.value > 1.0 for check in result.checks)


@pytest.mark.parametrize(
    ("changed", "wanted"),
    [
        ({"gravity": None, "uniform_loads": ()}, True),
        ({"gravity": None, "uniform_loads": (), "stops": ()}, False),
        ({"supports": (), "stops": ()}, False),
    ],
    ids=["preload alone", "nothing acts", "nothing resists"],
)
def test_a_joint_without_an_equilibrium_of_interest_has_none_judged(changed: dict[str, object], wanted: bool) -> None:
    assert own_problem.has_equilibrium(from_toml(WORN).replace(**changed)) is wanted


def test_the_report_lists_each_segment_of_a_beam_by_its_values() -> None:
    (beam,) = (text for part, text in problem_sheets(from_toml(WORN))[0].rows if part == "beam")
    assert "segments: (to 0.2 m, section: shape rectangle" in str(beam)
    assert "{" not in str(beam)


@pytest.mark.thorough
def test_a_joint_with_every_part_is_judged_and_agrees() -> None:
    problem = from_toml(WORN)
    for part in (own_problem.frequencies, own_problem.transient, own_problem.steady):
        result = part(problem, "quick", lambda text: None)
        assert [item.line for item in result.items if item.verdict is not Verdict.AGREE] == []
