"""A section point of one joint in another: the modes that both have, and the stops that the other's gaps close."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.march import Coordinates, Joint, march
from analytic.march.initial_state import TOUCHING, resumed
from lapjoint import (
    BaseMotion,
    InputError,
    ModalDamping,
    NoDamping,
    Problem,
    SineLoad,
    StepLoad,
    Stop,
    ViscousDamping,
    paper_joint,
)
from lapjoint.answers.contact_state import FREE, ContactState
from lapjoint.problem import Damping
from tests.helpers.beams import CLAMP, UNIT

_MODES = 5
LOADED = paper_joint(angular_frequency=300.0).replace(
    point_loads=(StepLoad(x=0.4, force=50.0), SineLoad(x=0.3, force=200.0, angular_frequency=300.0, phase=0.7))
)


def pressed(joint: Joint, state: ContactState, q: np.ndarray) -> ContactState:
    """The stops that a displacement presses, from the modes and the shapes of what they leave out."""
    modal = joint.modal(state)
    loads = np.append(1.0, np.sin(joint.harmonics.theta(0.0))) * joint.sizes
    z = modal.at_stops @ q + loads @ modal.residual_at_stops
    least = [stop.gap * (1 - TOUCHING * (k in state)) for k, stop in enumerate(joint.problem.stops)]
    signs = [stop.sign for stop in joint.problem.stops]
    return ContactState(tuple(k for k in range(len(least)) if signs[k] * z[k] > least[k]))


@pytest.mark.parametrize("state", [FREE, ContactState((0,)), ContactState((1, 2))])
def test_the_gaps_decide_which_stops_a_section_point_presses(state: ContactState) -> None:
    joint, rng, met = Joint(LOADED, _MODES, _MODES), np.random.default_rng(3), set()
    for _ in range(60):
        values = rng.normal(size=(2, _MODES)) * 10.0 ** rng.uniform(-5, 0)
        point = resumed(joint, state, values)
        assert point.state == pressed(joint, state, values[0])
        assert point.state != state or np.array_equal(point.coordinates, values)
        assert not np.shares_memory(point.coordinates, values)
        met.add(point.state)
    assert len(met) > 2


def test_modes_that_a_section_point_has_too_many_are_left_out() -> None:
    joint = Joint(paper_joint(), _MODES, _MODES)
    values = 1e-6 * np.arange(1.0, 17.0).reshape(2, 8)
    assert np.array_equal(resumed(joint, FREE, values).coordinates, values[:, :_MODES])


@pytest.mark.parametrize("damping", [ModalDamping(ratio=0.05), ViscousDamping(coefficient=30.0), NoDamping()])
@pytest.mark.parametrize("gap", [1e-3, 1.0])
def test_modes_that_a_section_point_lacks_follow_the_loads(gap: float, damping: Damping) -> None:
    """Pressed on a stop, or far from it, they come back to where they were after a period, whatever the others do.

    The viscous damping is above critical for the lowest modes; the load at a point keeps the stop closed.
    """
    problem = Problem(
        beam=UNIT,
        supports=(CLAMP,),
        stops=(Stop(x=1.0, side="top", gap=gap, stiffness=50.0),),
        damping=damping,
        base_motion=BaseMotion(amplitude=1e-4, angular_frequency=5.0),
        point_loads=(StepLoad(x=0.8, force=1.0), SineLoad(x=0.3, force=0.01, angular_frequency=10.0, phase=0.7)),
    )
    coarse, fine = Joint(problem, _MODES, _MODES), Joint(problem, 30, 30)
    state = ContactState((0,) if gap < 0.1 else ())
    static = coarse.flat(state).static[:, 0]
    few = np.array([static + 1e-6, np.zeros(_MODES)])  # the tip is 0.2 m up without the stop
    point = resumed(fine, state, few)
    assert point.state == state
    assert np.array_equal(point.coordinates[:, :_MODES], few)
    assert point.coordinates[0, _MODES:].all()
    after = march(fine, Coordinates(state, *point.coordinates), 0.0, 2 * np.pi / 5.0)
    assert not (after.log.stop >= 0).any()
    apart = np.abs(np.array([after.end.q, after.end.v]) - point.coordinates).max(axis=0)
    assert (apart[_MODES:] <= 1e-12).all()
    assert (apart[:_MODES] > 1e-9).any()


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_coordinates_that_are_not_finite_are_refused_wherever_they_are(wrong: float) -> None:
    joint = Joint(paper_joint(), _MODES, _MODES)
    for at in ((0, 1), (1, 0), (1, 7)):
        values = np.zeros((2, 8))
        values[at] = wrong
        with pytest.raises(InputError, match="not finite"):
            resumed(joint, FREE, values)
