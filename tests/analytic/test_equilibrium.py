"""Static equilibria of the analytic solver against closed forms, and against elements of fifty digits."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic import Solver
from lapjoint import Beam, InputError, Problem, Stop, Support
from lapjoint.answers import Equilibrium
from lapjoint.problem.static_loads import UniformLoad
from lapjoint.solver import Rests
from tests.helpers.random_joints import resting_joint
from tests.helpers.static_beams import StaticBeams, in_fifty_digits

SOLVER = Solver()
CLAMP = Support(x=0.0, translational=math.inf, torsional=math.inf)
L, EI, Q, K = 2.0, 3.0e3, 500.0, 1e6


def beam_on(*stops: Stop, supports: tuple[Support, ...] = (), q: float = -Q) -> Problem:
    """A uniform beam under a uniform load upwards, N/m."""
    beam = Beam(length=L, bending_stiffness=EI, mass_per_length=4.0)
    loads = [UniformLoad(force_per_length=q)] if q else []
    return Problem(beam=beam, supports=supports, stops=stops, uniform_loads=loads)


def stop(x: float, gap: float, side: str = "bottom") -> Stop:
    return Stop(x=x, side=side, gap=gap, stiffness=K, name=f"{side} {x}")


def check_witnessed(problem: Problem) -> None:
    """The conditions of equilibrium hold to fifty digits for the pressing stops, and forces and shape are those."""
    found = SOLVER.equilibrium(problem)
    with in_fifty_digits():
        witness = StaticBeams(problem)
        z = witness.displacements(found.state.closed)
        depths = witness.depths(z)
        for j, (it, depth) in enumerate(zip(problem.stops, depths, strict=True)):
            assert (j in found.state) == (depth > 0), f"{problem!r}"
            force = it.stiffness * max(depth, 0)
            assert abs(force - found.contact_forces[j]) <= found.errors.contact_forces[j] * (1 + 1e-12)
        nodes = np.array(witness.nodes)
        for order, error in ((0, found.errors.displacement), (1, found.errors.slope)):
            exact = np.array([float(value) for value in z[order::2]])
            assert np.all(
                np.abs(found.evaluate(nodes, order) - exact) <= error + 2e-16 * np.abs(exact) + 1e-40
            )  # of the witness
        for i, support in enumerate(problem.supports):
            if math.isfinite(support.translational):
                force = -support.translational * z[witness.at(support.x)]
                assert abs(force - found.support_forces[i]) <= found.errors.support_forces[i] * (1 + 1e-12)


def check_balanced(found: Equilibrium) -> None:
    """No force is left over at the tip and the root."""
    problem = found.problem
    shear, moment = found.errors.shear, found.errors.moment
    tip = np.array([problem.beam.length])
    at_tip = sum(F for F, s in zip(found.support_forces, problem.supports, strict=True) if s.x == tip[0])
    at_tip -= sum(it.sign * F for F, it in zip(found.contact_forces, problem.stops, strict=True) if it.x == tip[0])
    assert abs(found.shear(tip)[0] + at_tip) <= 1e3 * shear or any(
        part.x == tip[0] for part in (*problem.masses, *problem.point_loads)
    )
    couple = sum(C for C, s in zip(found.support_moments, problem.supports, strict=True) if s.x == tip[0])
    assert abs(found.moment(tip)[0] - couple) <= 1e3 * moment


def test_the_tip_of_a_cantilever_presses_its_stop_by_the_textbook_force() -> None:
    gap = 0.01
    found = SOLVER.equilibrium(beam_on(stop(L, gap), supports=(CLAMP,)))
    force = (Q * L**4 / 8 / EI - gap) / (L**3 / 3 / EI + 1 / K)
    assert found.contact_forces[0] == pytest.approx(force, rel=1e-14)
    assert found.support_forces[0] == pytest.approx(Q * L - force, rel=1e-14)
    assert found.support_moments[0] == pytest.approx(Q * L**2 / 2 - force * L, rel=1e-13)
    assert found.displacement(L)[0] == pytest.approx(-gap - force / K, rel=1e-13)
    assert found.moment(0.0)[0] == pytest.approx(force * L - Q * L**2 / 2, rel=1e-13)
    assert found.state.closed == (0,)
    assert found.unique


def test_largest_moment_of_a_beam_on_two_pins_is_at_its_middle() -> None:
    pins = tuple(Support(x=x, translational=math.inf) for x in (0.0, L))
    found = SOLVER.equilibrium(beam_on(supports=pins)).largest_moment()
    assert found.x == pytest.approx(L / 2, rel=1e-12)
    assert found.value == pytest.approx(Q * L**2 / 8, rel=1e-14)


def test_two_stops_at_one_place_press_the_beam_between_them_without_a_load() -> None:
    pressed = tuple(stop(L, -1e-3, side) for side in ("top", "bottom"))
    found = SOLVER.equilibrium(beam_on(*pressed, supports=(CLAMP,), q=0.0))
    assert found.contact_forces.tolist() == [1e-3 * K, 1e-3 * K]
    assert not found.displacement(np.linspace(0, L, 5)).any()


def test_a_free_beam_rests_on_two_stops() -> None:
    found = SOLVER.equilibrium(beam_on(stop(L / 4, 0.01), stop(3 * L / 4, 0.01), stop(3 * L / 4, 0.01, "top")))
    assert found.contact_forces[:2] == pytest.approx([Q * L / 2, Q * L / 2], rel=1e-14)
    assert found.contact_forces[2] == 0
    assert found.unique


@pytest.mark.parametrize(
    ("problem", "motion"),
    [
        (beam_on(), "a shift downwards"),
        (beam_on(stop(0.1, 0.0), stop(0.9, 0.0)), "a turn clockwise about x = 0.9 m"),
        (beam_on(supports=(Support(x=0.5, translational=math.inf),)), "a turn clockwise about x = 0.5 m"),
        (beam_on(stop(L, 0.0, "top"), supports=(Support(x=0.0, torsional=3.0),)), "a shift downwards"),
    ],
)
def test_a_motion_that_nothing_resists_is_named(problem: Problem, motion: str) -> None:
    with pytest.raises(InputError, match=f"there is none: the static loads drive {motion} of the whole beam"):
        SOLVER.equilibrium(problem)


@pytest.mark.parametrize(
    ("problem", "said"),
    [
        (beam_on(q=0.0), "shifted and turned"),
        (beam_on(stop(L, 1e-3), supports=(Support(x=0.5, translational=math.inf),), q=0.0), "a turn about x = 0.5 m"),
        (
            beam_on(stop(L, 0.0), supports=(Support(x=0.5, translational=math.inf),), q=0.0),
            "a turn anticlockwise about x = 0.5 m",
        ),
        (beam_on(stop(0.5, -1e-3), stop(0.5, -1e-3, "top"), q=0.0), "a turn about x = 0.5 m"),
        (beam_on(stop(0.5, 0.0), q=0.0), "shifted and turned"),
        (beam_on(stop(0.5, 0.0), stop(0.5, 0.0, "top"), q=0.0), "a turn about x = 0.5 m"),
    ],
)
def test_an_equilibrium_that_is_not_unique_says_so_and_is_the_straightest(problem: Problem, said: str) -> None:
    found = SOLVER.equilibrium(problem)
    assert not found.unique
    assert said in found.other_equilibria
    assert np.abs(found.displacement(np.linspace(0, L, 9))).max() <= 1e-15


@pytest.mark.parametrize(
    "stops",
    [
        tuple(stop(x, 0.0, side) for x in (0.5, 1.5) for side in ("top", "bottom")),
        (stop(0.2, 0.0), stop(1.0, 0.0, "top"), stop(1.8, 0.0)),
    ],
)
def test_touching_stops_make_an_unloaded_free_beam_unique(stops: tuple[Stop, ...]) -> None:
    found = SOLVER.equilibrium(beam_on(*stops, q=0.0))
    assert found.unique
    assert not found.contact_forces.any()


def test_of_several_equilibria_the_one_with_least_mean_square_is_given() -> None:
    """A stop at one end presses a free beam without load by its width: the beam turns about two thirds."""
    found = SOLVER.equilibrium(beam_on(stop(0.0, -1e-3), q=0.0))
    assert not found.unique
    assert found.displacement([0.0, 2 / 3 * L, L]) == pytest.approx([1e-3, 0.0, -0.5e-3], rel=1e-12, abs=1e-18)


def test_the_solver_rests() -> None:
    assert isinstance(SOLVER, Rests)


@pytest.mark.parametrize("seed", range(12))
def test_random_joints_rest_as_elements_of_fifty_digits_say(seed: int) -> None:
    problem = resting_joint(np.random.default_rng(seed))
    check_witnessed(problem)
    check_balanced(SOLVER.equilibrium(problem))


@pytest.mark.slow
def test_pressing_stops_of_500_random_joints_are_those_of_a_quadratic_program() -> None:
    rng = np.random.default_rng(4801)
    pressing = 0
    for _ in range(500):
        problem = resting_joint(rng)
        check_witnessed(problem)
        found = SOLVER.equilibrium(problem)
        check_balanced(found)
        with in_fifty_digits():
            assert StaticBeams(problem).by_quadratic_program() == found.state.closed
        pressing += len(found.state.closed)
    assert pressing > 250


@pytest.mark.slow
def test_500_random_loose_joints_rest_or_have_a_motion_that_nothing_resists() -> None:
    rng = np.random.default_rng(4802)
    rested = 0
    for _ in range(500):
        problem = resting_joint(rng, held=False)
        try:
            found = SOLVER.equilibrium(problem)
        except InputError as error:
            there = str(error)
            check_unresisted(problem)
        else:
            there = ""
            if found.unique:
                check_witnessed(problem)
                rested += 1
        assert not there or "there is none" in there
    assert 50 < rested < 450


def check_unresisted(problem: Problem) -> None:
    """Some rigid motion that supports allow and that leaves all stops gains work from the loads."""
    witness = StaticBeams(problem)
    forces, couples = (np.array([float(f) for f in witness.f])[i::2] for i in range(2))
    work = float(forces.sum()), float(forces @ witness.nodes + couples.sum())
    size = problem.beam.length
    gains = []
    for angle in np.linspace(0, 2 * math.pi, 200_001):
        motion = math.cos(angle), math.sin(angle) / size
        held = any(
            (s.translational > 0 and abs(motion[0] + motion[1] * s.x) > 1e-4)
            or (s.torsional > 0 and abs(motion[1] * size) > 1e-4)
            for s in problem.supports
        )
        towards = max((it.sign * (motion[0] + motion[1] * it.x) for it in problem.stops), default=-1.0)
        if not held and towards <= 1e-4:
            gains.append(motion[0] * work[0] + motion[1] * work[1])
    assert max(gains) > 0
