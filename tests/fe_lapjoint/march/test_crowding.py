"""A stop whose switches crowd is named, with the cause and what to change; a march does not take minutes over them."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from beams import CLAMP, UNIT

import fe_lapjoint
from fe_lapjoint.march import crowding
from fe_lapjoint.march.crowding import bounce_ratio
from lapjoint import BaseMotion, ModalDamping, NoDamping, Problem, SolverError, StepLoad, Stop, ViscousDamping


def pressed(stiffness: float) -> Problem:
    """A cantilever, EI = m = L = 1, that a load presses against a stop at its tip."""
    return Problem(
        beam=UNIT,
        supports=(CLAMP,),
        stops=(Stop(name="tip", x=1.0, side="top", gap=1e-4, stiffness=stiffness),),
        damping=ModalDamping(ratio=0.01),
        point_loads=(StepLoad(x=0.7, force=1.0),),
        base_motion=BaseMotion(amplitude=1e-3, angular_frequency=3.0),
    )


def ratio(problem: Problem, elements: int) -> float:
    return float(bounce_ratio(fe_lapjoint.Solver(elements=elements).period_map(problem).model)[0])


def contacts(stiffness: float, elements: int) -> int:
    return len(fe_lapjoint.Solver(elements=elements).simulate(pressed(stiffness), 0.4, errors=False).contacts)


def test_the_ratio_grows_with_the_root_of_the_stiffness_and_falls_with_the_mesh() -> None:
    assert ratio(pressed(4e6), 20) == pytest.approx(2 * ratio(pressed(1e6), 20), rel=1e-9)
    for elements in (10, 20, 40):  # the clamped end is some elements away
        assert ratio(pressed(1e6), elements) / ratio(pressed(1e6), 2 * elements) == pytest.approx(2**1.5, rel=1e-4)


def test_the_node_of_one_element_alone_has_the_mass_and_the_frequency_of_arithmetic() -> None:
    mass = np.array([[156, -22], [-22, 4]]) / 420  # of the free end of one element, EI = m = L = 1
    stiffness = np.array([[12, -6], [-6, 4]])
    answer = np.linalg.solve(mass, [1.0, 0.0])  # rates after a unit impulse on the tip
    inverse_mass, squared = answer[0], answer @ stiffness @ answer / answer[0]
    alone = pressed(1e6).replace(point_loads=())
    assert ratio(alone, 1) == pytest.approx(math.sqrt(1e6 * inverse_mass / squared), rel=1e-9)


def test_a_stop_that_makes_its_node_bounce_is_refused_with_what_helps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crowding, "MOST_SWITCHES", 300)
    with pytest.raises(SolverError, match=r"^tip: more than 300 switches between t = ") as caught:
        contacts(1e12, 20)
    helps = re.search(r"take (\S+) times as many elements, or a stiffness of at most (\S+) N/m$", str(caught.value))
    assert helps is not None
    finer, softer = map(float, helps.groups())
    assert ratio(pressed(1e12 / finer**3), 20) == pytest.approx(1.0, rel=2e-3)  # as on so fine a mesh
    assert ratio(pressed(softer), 20) == pytest.approx(1.0, rel=2e-3)
    assert contacts(softer, 20) < 50
    assert contacts(softer * 2.0**3, 40) < 50  # the same ratio on a mesh twice as fine


def test_contacts_that_the_mesh_follows_may_be_many(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crowding, "MOST_SWITCHES", 2)
    problem = pressed(1e5).replace(damping=NoDamping())
    assert ratio(problem, 20) < 1
    assert len(fe_lapjoint.Solver(elements=20).simulate(problem, 0.4, errors=False).contacts) > 2


def test_a_motion_that_modal_damping_holds_at_a_gap_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crowding, "MOST_SWITCHES", 100)
    problem = Problem(  # no support: the load throws the beam's end against the stop
        beam=UNIT,
        stops=(Stop(name="end", x=1.0, side="top", gap=0.0, stiffness=4e4),),
        damping=ModalDamping(ratio=5.0),
        point_loads=(StepLoad(x=0.77, force=1.0),),
    )
    with pytest.raises(
        SolverError, match=r"^end: more than 100 switches .* smaller damping ratio, or viscous damping$"
    ):
        fe_lapjoint.Solver(elements=8).simulate(problem, 0.02, errors=False)
    viscous = problem.replace(damping=ViscousDamping(coefficient=1.0))
    assert len(fe_lapjoint.Solver(elements=8).simulate(viscous, 0.02, errors=False).contacts) < 100
