"""Motions of joints whose beams have steps and masses: energy, the number of modes, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

import analytic
from lapjoint import FREE, Beam, ModalDamping, NoDamping, Problem, Stop
from lapjoint.answers import History
from lapjoint.answers.steady_state import Outcome
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, PolynomialShape
from lapjoint.problem.beam import BeamSegment
from lapjoint.problem.masses import Mass
from lapjoint.problem.static_loads import Gravity, UniformLoad
from tests.helpers.beams import CLAMP, LONG, UNIT, unit_cantilever
from tests.helpers.random_joints import real_march
from validation.invariants import energy_balance

SEED = 44  # of `real_march`
FIRST = 6  # contacts compared: fewer than it takes a chaotic motion to magnify an error much
DAMPINGS = {"undamped": NoDamping(), "damped": ModalDamping(ratio=0.02)}


def impulses(history: History) -> FloatArray:
    """Sum over all contacts of each stop, N s."""
    total = np.zeros(len(history.problem.stops))
    for contact in history.contacts:
        total[contact.stop] += contact.impulse
    return total


def first_contacts(problem: Problem, duration: float) -> History | None:
    """The motion from rest up to a moment between two of its first contacts, or None if it has too few."""
    contacts = analytic.Solver().simulate(problem, duration, errors=False).contacts
    last = min(FIRST, len(contacts) - 1)
    if last < 1:
        return None
    end = max((contacts[last - 1].end + contacts[last].start) / 2, contacts[0].end)
    return analytic.Solver().simulate(problem, end, errors=False)


@pytest.mark.parametrize("seed", [4, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(5, 45))])
def test_undamped_motions_keep_their_energy(seed: int) -> None:
    problem, duration = real_march(SEED, seed)
    problem = problem.replace(damping=NoDamping())
    motion = analytic.Solver().simulate(problem, duration, errors=False)
    # A switch loses what the modes leave out: impulses err by 1e-5 by the criterion, energies by less.
    assert abs(energy_balance(motion, 1e-5).value) <= 1e-5


@pytest.mark.parametrize("damping", DAMPINGS)
@pytest.mark.parametrize("seed", [2, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(200, 240))])
def test_twice_as_many_modes_change_impulses_by_the_stated_tolerance(seed: int, damping: str) -> None:
    problem, duration = real_march(SEED, seed)
    problem = problem.replace(damping=DAMPINGS[damping])
    few = first_contacts(problem, duration)
    if few is None:
        return
    count = analytic.Solver().mode_counts(problem)[0]
    many = analytic.Solver(n_modes=min(500, max(60, 2 * count))).simulate(problem, few.end, errors=False)
    exact = impulses(many)
    # The tolerance is 1e-5 for an impact; a later one of the six inherits errors of those before it.
    assert np.abs(impulses(few) - exact).max() <= 3e-5 * np.abs(exact).max()


def test_a_joint_cut_in_equal_segments_moves_as_the_whole_one() -> None:
    stop = Stop(x=1.0, side="top", gap=1e-3, stiffness=50.0)
    whole = unit_cantilever(stop)
    ends = (0.21, 0.5, 1.0)
    segments = tuple(BeamSegment(to=end, bending_stiffness=1.0, mass_per_length=1.0) for end in ends)
    cut = whole.replace(beam=Beam(length=1.0, segments=segments), masses=(Mass(x=0.4, mass=0.0),))
    one, other = (analytic.Solver().simulate(problem, 8.0, errors=False) for problem in (whole, cut))
    assert len(one.contacts) == len(other.contacts) > 3
    for a, b in zip(one.contacts, other.contacts, strict=True):
        assert (b.start, b.impulse) == pytest.approx((a.start, a.impulse), rel=1e-8)


def test_the_steady_state_of_a_laden_joint_converges_with_the_number_of_modes() -> None:
    segments = (
        BeamSegment(to=0.4, bending_stiffness=3.0, mass_per_length=2.0),
        BeamSegment(to=1.0, bending_stiffness=1.0, mass_per_length=1.0),
    )
    problem = unit_cantilever(Stop(x=1.0, side="top", gap=5e-4, stiffness=100.0)).replace(
        beam=Beam(length=1.0, segments=segments),
        masses=(Mass(x=0.7, mass=0.5, rotary_inertia=0.01), Mass(x=1.0, mass=0.1)),
        gravity=Gravity(acceleration=2e-3),
    )
    found = [analytic.Solver(n_modes=n).steady_state(problem, errors=False, sensitivity=False) for n in (8, 16, 32)]
    assert all(it.outcome is Outcome.PERIODIC for it in found)
    one, two, three = (float(it.impulses[0]) for it in found)
    assert abs(two - three) < abs(one - three) / 8
    assert abs(two - three) < 1e-5 * abs(three)


def test_a_rigid_initial_velocity_is_held_by_the_rigid_modes() -> None:
    """The velocity v = x of a free bar is a rigid motion: its modes hold all of it, with masses and steps."""
    beam = Beam(
        length=1.0,
        segments=(
            BeamSegment(to=0.5, bending_stiffness=1.0, mass_per_length=2.0),
            BeamSegment(to=1.0, bending_stiffness=3.0, mass_per_length=1.0),
        ),
    )
    problem = Problem(
        beam=beam,
        masses=(Mass(x=0.6, mass=0.7, rotary_inertia=0.2),),
        initial=PolynomialShape(velocity=(0.0, 1.0)),
    )
    motion = analytic.Solver(n_modes=12).simulate(problem, 1e-6, errors=False)
    v = motion.displacement(np.array([0.0, 1.0]), np.array([0.0, 1e-6]))
    np.testing.assert_allclose(v[:, 1] / 1e-6, [0.0, 1.0], atol=1e-9)


def test_gravity_bends_a_cantilever_with_a_mass_at_its_tip_as_the_textbook_says() -> None:
    """The tip comes to rest at m g L^4 / 8 EI + M g L^3 / 3 EI, and a load up to a adds p a^3 (4 L - a) / 24 EI."""
    g, mass, p, a = 9.81, 0.4, 1.7, 0.6
    problem = Problem(
        beam=UNIT,
        supports=(CLAMP,),
        masses=(Mass(x=1.0, mass=mass),),
        damping=ModalDamping(ratio=1.0),
        gravity=Gravity(acceleration=-g),
        uniform_loads=(UniformLoad(to=a, force_per_length=p),),
    )
    motion = analytic.Solver(n_modes=10).simulate(problem, 100.0, errors=False)
    exact = -g / 8 - mass * g / 3 + p * a**3 * (4 - a) / 24
    assert float(motion.displacement(np.array([1.0]), np.array([100.0]))[0, 0]) == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize(
    ("field", "changes"),
    [
        ("masses", {"masses": (Mass(x=1.0, mass=1.0),)}),
        (
            "beam.segments",
            {"beam": Beam(length=2.0, segments=(BeamSegment(to=2.0, bending_stiffness=1e5, mass_per_length=10.0),))},
        ),
        ("gravity", {"gravity": Gravity(acceleration=-9.81)}),
        ("uniform_loads", {"uniform_loads": (UniformLoad(force_per_length=1.0),)}),
    ],
)
def test_the_published_scheme_refuses_what_it_does_not_have(field: str, changes: dict[str, object]) -> None:
    problem = Problem(beam=LONG, supports=(CLAMP,)).replace(**changes)
    with pytest.raises(InputError, match=f"{field}: the published scheme"):
        analytic.PublishedScheme().simulate(problem, 1.0)


def test_most_modes_of_a_heavy_mass_on_a_light_beam_are_those_of_the_pinned_beam() -> None:
    problem = Problem(beam=LONG, supports=(CLAMP,), masses=(Mass(x=2.0, mass=1e10 * LONG.m * LONG.length),))
    omega = analytic.Solver().modes(problem, FREE, 3).angular_frequencies
    slow = math.sqrt(3 * LONG.EI / LONG.length**3 / (1e10 * LONG.m * LONG.length))
    assert omega[0] == pytest.approx(slow, rel=1e-9)
    assert omega[1] == pytest.approx(3.9266023120479185**2 * math.sqrt(LONG.EI / LONG.m) / LONG.length**2, rel=1e-9)
