"""Joints whose stops press the straight beam: steady states, forces and contact states in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from beams import CLAMP, unit_cantilever
from refining import AnySolver

import analytic
import fe_lapjoint
from analytic.mode_count import most_closed
from lapjoint import FREE, ContactState, Problem, StepLoad, Stop, Support, contact_states
from lapjoint.answers import History
from lapjoint.answers.contact_state import can_be_closed
from lapjoint.problem.supports_and_stops import Side

ANALYTIC = analytic.Solver()
SOLVERS = (ANALYTIC, fe_lapjoint.Solver(elements=20))

AT, STIFFNESS, PRESS = 0.7, 40.0, 2e-3  # m, N/m, m: more than the beam moves there
SOFT = 2.0  # N/m: a beam that such a stop pushes away from rest does not leave it


def cantilever(stops: tuple[Stop, ...], supports: tuple[Support, ...] = (), force: float = 0.0) -> Problem:
    """A clamped beam that its base shakes at twice its first frequency, with some parts at `AT`."""
    loads = (StepLoad(x=AT, force=force),) if force else ()
    return unit_cantilever(*stops).replace(supports=(CLAMP, *supports), point_loads=loads)


def same_motion(one: History, other: History) -> None:
    """Fail unless two motions are one but for rounding."""
    x, t = np.linspace(0.0, 1.0, 9), np.linspace(one.start, one.end, 40)
    z = one.displacement(x, t)
    assert np.abs(z - other.displacement(x, t)).max() <= 1e-9 * np.abs(z).max()  # of high modes' sums, near 1e-12


def pressing(side: Side, gap: float = -PRESS) -> Stop:
    """A stop at `AT`."""
    return Stop(x=AT, side=side, gap=gap, stiffness=STIFFNESS)


@pytest.mark.parametrize("solver", SOLVERS)
def test_two_stops_that_press_a_beam_from_both_sides_are_one_spring_until_one_opens(solver: AnySolver) -> None:
    pressed = cantilever((pressing("top"), pressing("bottom")))
    spring = cantilever((), (Support(x=AT, translational=2 * STIFFNESS),))
    steady = solver.steady_state(pressed)
    same_motion(steady.history, solver.steady_state(spring).history)
    same_motion(solver.simulate(pressed, 3.0, errors=False), solver.simulate(spring, 3.0, errors=False))
    period = pressed.require_excitation_period("test")
    assert steady.impulses == pytest.approx([STIFFNESS * PRESS * period, -STIFFNESS * PRESS * period], rel=1e-10)
    assert steady.symmetric
    assert all(contact.open_start and contact.open_end for contact in steady.history.contacts)


@pytest.mark.parametrize("side", ["top", "bottom"])
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_stop_that_never_opens_is_a_spring_and_a_constant_force(solver: AnySolver, side: Side) -> None:
    stop = Stop(x=AT, side=side, gap=-10 * PRESS, stiffness=SOFT)
    pressed = cantilever((stop,))
    spring = cantilever((), (Support(x=AT, translational=SOFT),), stop.sign * SOFT * stop.gap)
    same_motion(solver.simulate(pressed, 3.0, errors=False), solver.simulate(spring, 3.0, errors=False))
    same_motion(solver.steady_state(pressed).history, solver.steady_state(spring).history)


def test_opposite_stops_can_be_closed_together_where_their_gaps_overlap() -> None:
    both, one, other = ContactState((0, 1)), ContactState((0,)), ContactState((1,))
    overlapping = cantilever((pressing("top"), pressing("bottom", PRESS / 2)))
    assert contact_states(overlapping) == (one, other, both)
    apart = cantilever((pressing("top"), pressing("bottom", 2 * PRESS)))
    assert contact_states(apart) == (FREE, one, other)
    assert can_be_closed(overlapping, both)
    assert not can_be_closed(overlapping, FREE)
    assert not can_be_closed(apart, both)
    touching = cantilever((pressing("top", 0.0), pressing("bottom", 0.0)))
    assert contact_states(touching) == (FREE, one, other)


def test_the_number_of_modes_is_chosen_for_the_stiffest_state_that_is_possible() -> None:
    overlapping = cantilever((pressing("top"), pressing("bottom")))
    assert most_closed(overlapping) == ContactState((0, 1))
    assert most_closed(cantilever((pressing("top", PRESS), pressing("bottom", PRESS)))) == ContactState((0,))
    assert ANALYTIC.mode_counts(overlapping)[0] > 0
