"""The problem at a point of a grid: the one whose tables have the values there, or what is said of those tables."""

from __future__ import annotations

import math
import re
from itertools import product
from typing import Any

import pytest

from lapjoint import InputError, Problem, SineLoad, StepLoad, paper_joint
from lapjoint.campaigns.grid import FREQUENCY, Axis, Grid
from lapjoint.problem import BaseHarmonic, HarmonicsBaseMotion, HarmonicsLoad, LoadHarmonic
from lapjoint.problem.files import problem_from_tables, problem_tables
from lapjoint.problem.override import assign

JOINT = paper_joint()
LOADED = JOINT.replace(
    point_loads=(
        StepLoad(x=0.2, force=3.0),
        SineLoad(x=0.1, force=1.0, angular_frequency=1545.0),
        HarmonicsLoad(x=0.3, angular_frequency=515.0, harmonics=(LoadHarmonic(multiple=2, force=0.5),)),
    )
)
HARMONICS = JOINT.replace(
    base_motion=HarmonicsBaseMotion(
        angular_frequency=300.0,
        harmonics=(BaseHarmonic(multiple=1, amplitude=0.01), BaseHarmonic(multiple=3, amplitude=0)),
    )
)
STILL = JOINT.replace(base_motion=None, point_loads=LOADED.point_loads[:1])
PATHS = [
    "base_motion.amplitude",
    "base_motion.phase",
    "base_motion.angular_frequency.x",
    "base_motion",
    "base_motion.kind",
    "base_motion.harmonics.1.amplitude",
    "base_motion.unknown",
    "point_loads.*.force",
    "point_loads.0.x",
    "point_loads.2.harmonics.0.multiple",
    "point_loads.7.x",
    "stops.*.gap",
    "damping.ratio",
    "unknown",
]
VALUES = [0.03, 2.0, 0.0, -1.0, 1e200, math.inf, -math.inf]


def test_the_last_axis_runs_fastest_as_in_the_dataset() -> None:
    axes = (Axis("stops.*.gap", (1e-3, 2e-3)), Axis("damping.ratio", (0.1, 0.08, 0.05)))
    grid = Grid(JOINT, axes)
    assert grid.shape == (2, 3)
    assert [grid.values_at(i) for i in range(grid.size)] == list(product(*(axis.values for axis in axes)))


def by_tables(grid: Grid, values: tuple[float, ...]) -> Problem:
    """The problem whose tables have the values of axes that set one number each."""
    tables = problem_tables(grid.problem)
    for axis, value in zip(grid.axes, values, strict=True):
        assign(tables, axis.path, value, f"axis {axis.path}")
    return problem_from_tables(
        tables, ", ".join(f"{axis.path} = {value:.10g}" for axis, value in zip(grid.axes, values, strict=True))
    )


def found(make: Any, *given: Any) -> Any:
    """What a function gives, or the message with which it refuses."""
    try:
        return make(*given)
    except InputError as error:
        return str(error)


def said_once(found: Problem | str, path: str) -> Problem | str:
    """The same, where a message that names a value is one about that value."""
    if isinstance(found, Problem):
        return found
    return re.sub(rf"^{re.escape(path)} = \S+: (?={re.escape(path)} = )", "", found)


@pytest.mark.parametrize("problem", [JOINT, LOADED, HARMONICS, STILL], ids=["sine", "loads", "harmonics", "still"])
@pytest.mark.parametrize("path", PATHS)
def test_the_problem_at_a_point_is_that_of_its_tables_or_is_refused_as_they_are(problem: Problem, path: str) -> None:
    for paths in ((path,), (path, "base_motion.amplitude" if path != "base_motion.amplitude" else "base_motion.phase")):
        grid = Grid(problem, tuple(Axis(one, (1.0,)) for one in paths))
        for value in VALUES:
            values = (value, 0.01)[: len(paths)]
            made, expected = found(grid.with_values, values), found(by_tables, grid, values)
            expected = said_once(expected, path) if len(paths) == 1 else expected
            assert made == expected, value
            if isinstance(expected, Problem):
                assert made.forces == expected.forces
                assert problem_tables(made) == problem_tables(expected)


@pytest.mark.parametrize("value", [77.7, 0.0, -3.0, 1e160, math.inf])
def test_the_frequency_of_all_excitation_keeps_the_whole_multiples(value: float) -> None:
    grid, paths = Grid(LOADED, (Axis(FREQUENCY, (1.0,)),)), [FREQUENCY, "point_loads.1.angular_frequency"]
    tables = problem_tables(LOADED)
    for path, ratio in zip([*paths, "point_loads.2.angular_frequency"], (1.0, 3.0, 1.0), strict=True):
        assign(tables, path, value * ratio, "")
    made = found(grid.with_values, (value,))
    assert made == said_once(found(problem_from_tables, tables, f"{FREQUENCY} = {value:.10g}"), FREQUENCY)
    assert made == found(grid.with_values, (value,))
    assert isinstance(made, str) or made.forces.fundamental == value
    assert LOADED.forces.fundamental == 515.0


@pytest.mark.parametrize(
    ("path", "units"),
    [
        ("masses.clevis.rotary_inertia", "kg m2"),
        ("masses.*.mass", "kg"),
        ("beam.segments[0].to", "m"),
        ("beam.added_mass_per_length", "kg m-1"),
        ("gravity.acceleration", "m s-2"),
        ("uniform_loads.0.from", "m"),
    ],
)
def test_an_axis_of_a_mass_a_step_or_a_load_has_its_unit(path: str, units: str) -> None:
    assert Axis(path, (1.0,)).units == units


def test_an_axis_in_hz_is_kept_as_angular_frequencies() -> None:
    axis = Axis("base_motion.frequency", (1.0, 2.0))
    assert axis == Axis(FREQUENCY, (2 * math.pi, 4 * math.pi))
    assert (axis.name, axis.units) == ("angular_frequency", "rad s-1")
    assert Axis("point_loads[1].frequency", (1.0,)).path == "point_loads.1.angular_frequency"
