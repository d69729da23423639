"""Motions that begin at rest at a stop: the first derivative of the gap function that is not 0 decides on the stop."""

from __future__ import annotations

import itertools
import math

import pytest
from beams import UNIT
from refining import AnySolver
from rigid_starts import ORDERS, start

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Beam, ModalDamping, NoDamping, Problem, Stop, Support
from lapjoint.problem import PolynomialShape, RecordBaseMotion

RIGID = Beam(length=1.0, bending_stiffness=1e8, mass_per_length=1.0)
SPRINGS = Support(x=0.0, translational=50.0), Support(x=1.0, translational=50.0)
SOLVERS = {"analytic": analytic.Solver(), "fe": fe_lapjoint.Solver(elements=12)}
solvers = pytest.mark.parametrize("solver", SOLVERS.values(), ids=SOLVERS)
KINDS = tuple(itertools.product(ORDERS, (True, False)))
# A record of a few samples says little to a bar that is to be rigid, and bends at some 1000 Hz.
pytestmark = pytest.mark.filterwarnings("ignore::lapjoint.errors.RecordWarning")


@solvers
def test_a_bar_that_a_sine_presses_on_a_stop_without_gap_touches_it_from_the_start(solver: AnySolver) -> None:
    """z begins as t^3; end and impulse of the contact by scipy's DOP853 with a tolerance of 1e-12."""
    problem = Problem(
        beam=RIGID,
        supports=SPRINGS,
        stops=(Stop(x=0.5, side="top", gap=0.0, stiffness=300.0),),
        damping=NoDamping(),
        base_motion=BaseMotion(amplitude=0.01, angular_frequency=7.0),
    )
    first = solver.simulate(problem, 0.5).contacts[0]
    assert (first.start, first.start_error, first.open_start) == (0.0, 0.0, True)
    assert first.end == pytest.approx(0.3980190961, abs=1e-6)  # the bar bends by 1e-7
    assert first.impulse == pytest.approx(0.1078106135, rel=1e-5)


@solvers
@pytest.mark.parametrize("gap", [0.0, 0.3])
def test_a_free_bar_that_is_pushed_ever_harder_from_its_gap_has_one_contact(solver: AnySolver, gap: float) -> None:
    """z = gap + t^3 / 6 until the spring answers: u'' = t - 100 u, whose impulse is T^2 / 2 - (1 - cos 10 T) / 100."""
    (contact,) = solver.simulate(pushed(gap, (0.0, -2.0)), 2.0).contacts
    assert (contact.start, contact.start_error, contact.open_end) == (0.0, 0.0, True)
    assert contact.impulse == pytest.approx(2.0 - (1 - math.cos(20.0)) / 100, rel=1e-6)
    assert contact.impulse_error is not None
    assert contact.impulse_error < 1e-6


@solvers
def test_a_bar_that_rests_at_its_gap_or_leaves_it_has_no_contact(solver: AnySolver) -> None:
    for acceleration in ((0.0, 0.0), (0.0, 2.0), (2.0, 2.0)):
        assert solver.simulate(pushed(0.3, acceleration), 2.0, errors=False).contacts == ()


@solvers
@pytest.mark.parametrize("quarters", range(4))
@pytest.mark.parametrize("x", [0.23, 0.5])
def test_a_beam_that_bends_touches_a_stop_without_gap_from_the_start_or_not_at_all_at_first(
    solver: AnySolver, x: float, quarters: int
) -> None:
    """The force of the base begins as t, 1, -t and -1 where its phase is none to three quarter turns."""
    problem = Problem(
        beam=UNIT,
        supports=(Support(x=0.0, translational=math.inf), Support(x=1.0, translational=math.inf)),
        stops=(Stop(x=x, side="top", gap=0.0, stiffness=30.0),),
        damping=ModalDamping(ratio=0.01),
        base_motion=BaseMotion(amplitude=1e-3, angular_frequency=7.0, phase=quarters * math.pi / 2),
    )
    first = solver.simulate(problem, 0.8, errors=False).contacts[0]
    if quarters < 2:
        assert first.start == 0.0
        assert first.end > 0.1
    else:
        assert first.start > 0.1


def pushed(gap: float, acceleration: tuple[float, float]) -> Problem:
    """A free bar at its gap, whose base has this acceleration, m/s2, at 0 and 2 s."""
    return Problem(
        beam=RIGID,
        stops=(Stop(x=0.5, side="top", gap=gap, stiffness=100.0),),
        damping=NoDamping(),
        base_motion=RecordBaseMotion(quantity="acceleration", values=acceleration, rate=0.5),
        initial=PolynomialShape(displacement=(gap,)),
    )


@solvers
@pytest.mark.parametrize("seed", [1, *(pytest.param(i, marks=pytest.mark.slow) for i in range(2, 14))])
@pytest.mark.parametrize(("order", "pressed"), KINDS)
def test_bars_that_start_at_a_stop_move_as_their_power_series(
    solver: AnySolver, order: int, pressed: bool, seed: int
) -> None:
    """The contacts are those of the rigid bar; the elastic bar, of EI from 3e5 N m2 on, is off by some 1e-5."""
    begun = start(seed, order, pressed)
    right, found = begun.contacts(0.5), solver.simulate(begun.problem(), 0.5, errors=False).contacts
    assert [one.stop for one in found] == [one[0] for one in right]
    for one, (_, begin, end, impulse) in zip(found, right, strict=True):
        assert (one.start == 0.0) == (begin == 0.0)
        assert (one.start, one.end) == (pytest.approx(begin, abs=1e-3), pytest.approx(end, abs=1e-3))
        assert one.impulse == pytest.approx(impulse, rel=1e-2, abs=1e-6)
