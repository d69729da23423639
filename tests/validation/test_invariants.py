"""The solver-blind witness knows masses, steps and static loads: it accepts right motions, and sees each fault."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import fe_lapjoint
from lapjoint import BaseMotion, Beam, History, NoDamping, Problem, Stop, Support
from lapjoint.problem import BeamSegment, Gravity, Mass, UniformLoad
from validation.invariants import witness
from validation.verdict import Verdict

L, DURATION, TOLERANCE = 2.0, 0.3, 1e-5
"""Length, m; duration of a motion, s; relative tolerance: quadrature over elements that cross panels leaves 1e-6."""


def loaded_problem(seed: int, *, held: bool) -> Problem:
    """An undamped beam with steps, masses that turn, gravity, and a load along a part, shaken between stops."""
    rng = np.random.default_rng((48, seed))
    ends = (*sorted((rng.uniform(0.2, 0.8, 2) * L).tolist()), L)
    segments = tuple(
        BeamSegment(
            to=to, bending_stiffness=float(10 ** rng.uniform(3.5, 4.5)), mass_per_length=float(rng.uniform(1, 10))
        )
        for to in ends
    )
    beam = Beam(length=L, segments=segments, contents_per_length=0.5, added_mass_per_length=0.7)
    masses = tuple(
        Mass(x=x, mass=float(rng.uniform(0.5, 5)), rotary_inertia=float(rng.uniform(0.05, 0.5)))
        for x in (L, float(rng.uniform(0.2, 1.8)))
    )
    springs = (Support(x=0.0, translational=2e5, torsional=3e3), Support(x=1.3, translational=1e5))
    stops = tuple(
        Stop(x=x, side=side, gap=gap, stiffness=1e5)
        for x, gap in ((L, 2e-3), (0.0, 3e-3))
        for side in ("top", "bottom")
    )
    start, to = float(rng.uniform(0.1, 0.8)), float(rng.uniform(1.2, 1.9))
    return Problem(
        beam=beam,
        masses=masses,
        supports=springs if held else (),
        stops=stops,
        damping=NoDamping(),
        gravity=Gravity(acceleration=-3.0),
        uniform_loads=(UniformLoad(start=start, to=to, force_per_length=20.0),),
        base_motion=BaseMotion(amplitude=1e-3, angular_frequency=40.0),
    )


@cache
def motion(seed: int, held: bool) -> History:
    return fe_lapjoint.Solver(elements=24).simulate(loaded_problem(seed, held=held), DURATION, errors=False)


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 12))])
def test_right_motions_with_masses_steps_and_loads_pass(seed: int, held: bool) -> None:
    found = witness(motion(seed, held), TOLERANCE, "motion")
    assert len(found) == 6
    assert [item.line for item in found if item.verdict is not Verdict.AGREE] == []


def _mass(name: str, factor: float = 1.01) -> Callable[[Problem], Problem]:
    """The problem with one field of its first mass larger by a factor."""
    return lambda it: it.replace(
        masses=(it.masses[0].model_copy(update={name: factor * getattr(it.masses[0], name)}), *it.masses[1:])
    )


def _segment(name: str) -> Callable[[Problem], Problem]:
    """The problem with its middle segment changed by a hundredth in one of its fields."""

    def change(it: Problem) -> Problem:
        first, middle, last = it.beam.segments
        changed = middle.model_copy(update={name: 1.01 * getattr(middle, name)})
        return it.replace(beam=it.beam.model_copy(update={"segments": (first, changed, last)}))

    return change


def _beam(name: str) -> Callable[[Problem], Problem]:
    return lambda it: it.replace(beam=it.beam.model_copy(update={name: 1.05 * getattr(it.beam, name)}))


def _along(name: str) -> Callable[[Problem], Problem]:
    """The problem with its load along a part changed by a hundredth in one of its fields."""
    return lambda it: it.replace(
        uniform_loads=(it.uniform_loads[0].model_copy(update={name: 1.01 * getattr(it.uniform_loads[0], name)}),)
    )


FAULTS: dict[str, tuple[Callable[[Problem], Problem], str]] = {
    "a mass": (_mass("mass"), "momentum"),
    "the place of a mass": (_mass("x"), "angular momentum"),
    "a rotary inertia": (_mass("rotary_inertia", 1.2), "angular momentum"),
    "the stiffness of a segment": (_segment("bending_stiffness"), "energy"),
    "the mass of a segment": (_segment("mass_per_length"), "momentum"),
    "the end of a segment": (_segment("to"), "momentum"),
    "contents": (_beam("contents_per_length"), "momentum"),
    "added mass": (_beam("added_mass_per_length"), "momentum"),
    "gravity": (lambda it: it.replace(gravity=Gravity(acceleration=-3.03)), "momentum"),
    "a load along a part": (_along("force_per_length"), "momentum"),
    "where a load begins": (_along("start"), "angular momentum"),
    "where a load ends": (_along("to"), "momentum"),
}
"""What the witness is told wrongly, by a hundredth or more, and the balance that must say so."""


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_in_each_term_is_seen(name: str) -> None:
    change, balance = FAULTS[name]
    right = motion(0, False)
    problem = right.problem
    if name == "the place of a mass":  # the tip is the end of the beam
        problem = problem.replace(masses=problem.masses[::-1])
        right = replace(right, problem=problem)
    found = witness(replace(right, problem=change(problem)), TOLERANCE, "motion")
    item = next(item for item in found if item.name == f"motion: {balance} unaccounted for")
    assert item.verdict is Verdict.DISAGREE
    assert abs(item.value) > 10 * TOLERANCE
