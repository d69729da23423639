"""A problem of one's own with several beams is judged like any other, and the report draws it."""

from __future__ import annotations

import pytest

from lapjoint import InputError, Problem
from lapjoint.problem.files import from_toml
from lapjoint.problem.presets import lap_joint
from validation.cases import own_problem
from validation.peers.opensees import check_beam
from validation.verdict import Verdict

FREE_PAIR = """
title = "A free beam on a soft link to another on soft supports"
[[beams]]
name = "upper"
length = 1.0
offset = 0.05
bending_stiffness = 1.0
mass_per_length = 1.0
[[beams]]
name = "lower"
origin = 0.3
length = 0.8
bending_stiffness = 2.0
mass_per_length = 1.5
masses = [{x = 0.8, mass = 0.3, rotary_inertia = 0.001, name = "weight"}]
supports = [{x = 0.0, translational = 40.0}, {x = 0.8, translational = 60.0, torsional = 0.5}]
[[stops]]
name = "near"
between = ["upper:0.4", "lower:0.1"]
gap = 0.01
stiffness = 300.0
[[stops]]
name = "far"
between = ["upper:0.9", "lower:0.6"]
gap = -0.002
stiffness = 200.0
[[links]]
between = ["upper:0.7", "lower:0.35"]
translational = 30.0
torsional = 0.2
[initial]
kind = "beams"
beams = [{beam = "upper", velocity = [-0.05, -0.02]}, {beam = "lower", velocity = [0.03]}]
"""

PRESSED_PAIR = """
title = "A bar that lies on a soft tube in water, with a hundred thousandth of the force that the gap stands for"
stops = [
    {name = "near", between = ["bar:0.4115", "tube:0.4115"], gap = 2.65e-4, stiffness = 3.5e7},
    {name = "far", between = ["bar:0.823", "tube:0.823"], gap = -5.19e-4, stiffness = 4.74e7},
]
[[beams]]
name = "bar"
length = 0.823
bending_stiffness = 16914.0
mass_per_length = 23.5
supports = [{x = 0.0, translational = inf, torsional = 3050.0}]
[[beams]]
name = "tube"
origin = 0.0
offset = -0.05
length = 0.823
bending_stiffness = 2.583
mass_per_length = 0.0614
added_mass_per_length = 0.248
supports = [{x = 0.0, translational = inf, torsional = 18.4}]
[damping]
kind = "modal"
ratio = 0.0752
[gravity]
acceleration = -9.81
[base_motion]
amplitude = 4.12e-4
angular_frequency = 13.89
"""


def test_where_two_beams_rest_is_judged_with_the_forces_of_links() -> None:
    problem = from_toml(FREE_PAIR)
    assert own_problem.has_equilibrium(problem)
    result = own_problem.equilibrium(problem, "quick", lambda text: None)
    assert result.verdict is Verdict.AGREE
    names = [check.name for check in result.checks]
    assert "displacement at lower:0.6 m" in names
    assert "force of the support at lower:0.8 m" in names
    (link,) = (check for check in result.checks if check.name == "force of the link upper:0.7 to lower:0.35")
    assert link.a.value != 0


def test_opensees_is_not_asked_about_several_beams() -> None:
    with pytest.raises(InputError, match=r"beams: the OpenSees solver works for one \[beam\]"):
        check_beam(lap_joint())


@pytest.mark.thorough
def test_small_forces_of_stiff_stops_agree_within_their_errors() -> None:
    """A force is the difference of two numbers that are a hundred thousand times as large."""
    result = own_problem.steady(from_toml(PRESSED_PAIR), "quick", lambda text: None)
    assert [item.line for item in result.items if item.verdict is not Verdict.AGREE] == []
    (force,) = (check for check in result.checks if check.name == "Force, near, peak")
    assert force.allowed < 1e-5 * force.a.value


@pytest.mark.slow
@pytest.mark.parametrize("problem", [lap_joint(), from_toml(FREE_PAIR)], ids=["lap", "free pair"])
def test_two_beams_are_judged_and_agree(problem: Problem) -> None:
    parts = [own_problem.frequencies, own_problem.transient]
    for part in [*parts, *([own_problem.steady] if problem.base_motion else [])]:
        result = part(problem, "quick", lambda text: None)
        assert [item.line for item in result.items if item.verdict is not Verdict.AGREE] == []
