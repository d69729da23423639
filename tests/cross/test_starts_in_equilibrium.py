"""A motion that starts in static equilibrium stays there, and one released elsewhere rings about it."""

from __future__ import annotations

import math

import numpy as np
import pytest

import analytic
import fe_lapjoint
from analytic import PublishedScheme
from lapjoint import (
    AtEquilibrium,
    BaseMotion,
    Beam,
    History,
    InputError,
    ModalDamping,
    Problem,
    StepLoad,
    Stop,
    Support,
    paper_joint,
)
from lapjoint.answers import Equilibrium
from lapjoint.problem.files import from_toml, to_toml
from lapjoint.problem.static_loads import UniformLoad
from tests.helpers.random_joints import resting_joint

SOLVERS = (analytic.Solver(n_modes=12), fe_lapjoint.Solver(elements=16))
IDS = ("analytic", "fe")
CLAMP = Support(x=0.0, translational=math.inf, torsional=math.inf)
PIN = Support(x=0.0, translational=math.inf)


def joint(rng: np.random.Generator, loose: bool = False) -> Problem:
    """A joint that sags onto stops, or is pressed by them: perhaps a loose beam on a pin, which a stop holds."""
    L, EI, m = 1.0, 450.0, 2.4
    size = 30.0 * L**3 / EI
    stops = [
        Stop(
            name=f"s{i}",
            x=float(rng.uniform(0.4, 1.0)),
            side=("top", "bottom")[int(rng.integers(2))],
            gap=size * float(rng.uniform(-0.02, 0.02)),
            stiffness=10 ** rng.uniform(4, 6),
        )
        for i in range(int(rng.integers(1, 4)))
    ]
    if loose:
        stops.append(Stop(name="below", x=0.7, side="bottom", gap=1e-3, stiffness=1e5))
    return Problem(
        beam=Beam(length=L, bending_stiffness=EI, mass_per_length=m),
        supports=[PIN if loose else CLAMP],
        stops=stops,
        damping=ModalDamping(ratio=0.01) if rng.random() < 0.5 else {"kind": "none"},
        uniform_loads=[UniformLoad(force_per_length=-30.0 * float(rng.uniform(0.5, 1)))],
        point_loads=[StepLoad(x=0.6, force=float(rng.normal()))],
        initial=AtEquilibrium(),
    )


def places(problem: Problem) -> np.ndarray:
    """The stops and the tip, where elements have nodes: between nodes a march leaves out the load's own quartic."""
    return np.array([*(stop.x for stop in problem.stops), 1.0])


def check_still(history: History, rest: Equilibrium) -> None:
    """Nothing moves but in the last digits; twelve modes leave 1e-9 of a static deflection out, which 24 do not."""
    x, t = places(history.problem), np.linspace(0, history.end, 23)
    size, stops = np.abs(rest.displacement(np.linspace(0, 1, 65))).max(), history.problem.stops
    z, slowest = history.displacement(x, t), history.problem.beam.slowest_bending
    assert history.states[0] == rest.state
    assert not history.switch_times.size
    assert np.abs(z[:, 0] - rest.displacement(x)).max() <= 1e-8 * size
    assert np.abs(z - z[:, :1]).max() <= 1e-13 * size
    assert np.abs(history.velocity(x, t)).max() <= 1e-13 * size * slowest
    forces = history.contact_force(t)
    softness = size * max(stop.stiffness for stop in stops)
    assert np.abs(np.abs(forces[:, 0]) - rest.contact_forces).max() <= 1e-8 * softness
    assert np.abs(forces - forces[:, :1]).max() <= 1e-13 * softness


@pytest.mark.parametrize("solver", SOLVERS, ids=IDS)
@pytest.mark.parametrize("loose", [False, True])
def test_a_joint_in_equilibrium_stays_there(solver: analytic.Solver | fe_lapjoint.Solver, loose: bool) -> None:
    rng = np.random.default_rng(7 + loose)
    for _ in range(3):
        problem = joint(rng, loose)
        check_still(solver.simulate(problem, 1.0, errors=False), solver.equilibrium(problem))


@pytest.mark.slow
@pytest.mark.parametrize("solver", SOLVERS, ids=IDS)
@pytest.mark.parametrize("loose", [False, True])
def test_100_joints_in_equilibrium_stay_there(solver: analytic.Solver | fe_lapjoint.Solver, loose: bool) -> None:
    rng = np.random.default_rng(70 + loose)
    for _ in range(50):
        problem = joint(rng, loose)
        check_still(solver.simulate(problem, 1.0, errors=False), solver.equilibrium(problem))


@pytest.mark.slow
@pytest.mark.parametrize("solver", SOLVERS, ids=IDS)
@pytest.mark.parametrize("held", [True, False])
def test_beams_with_steps_and_masses_in_equilibrium_stay_there(
    solver: analytic.Solver | fe_lapjoint.Solver, held: bool
) -> None:
    """Supports and stops of all stiffnesses; twelve modes leave 1e-6 of some deflections out."""
    rng, rested = np.random.default_rng(90 + held), 0
    for _ in range(50):
        problem = resting_joint(rng, held=held)
        loads = [load for load in problem.point_loads if isinstance(load, StepLoad)]
        problem = problem.replace(point_loads=loads, initial=AtEquilibrium())
        try:
            rest = solver.equilibrium(problem)
        except InputError:
            continue
        size = np.abs(rest.displacement(np.linspace(0, problem.beam.length, 65))).max()
        if size == 0:
            continue
        slowest = problem.beam.slowest_bending
        x, t = np.array([*(stop.x for stop in problem.stops), problem.beam.length]), np.linspace(0, 20 / slowest, 13)
        motion = solver.simulate(problem, float(t[-1]), errors=False)
        z = motion.displacement(x, t)
        assert motion.states == (rest.state,)
        assert np.abs(z[:, 0] - rest.displacement(x)).max() <= 1e-6 * size
        assert np.abs(z - z[:, :1]).max() <= 1e-12 * size
        assert np.abs(motion.velocity(x, t)).max() <= 1e-12 * size * slowest
        rested += 1
    assert rested > 20


@pytest.mark.parametrize("solver", SOLVERS, ids=IDS)
def test_a_joint_released_at_rest_rings_about_its_equilibrium(solver: analytic.Solver | fe_lapjoint.Solver) -> None:
    problem = joint(np.random.default_rng(3)).replace(stops=(), damping={"kind": "none"}, initial={"kind": "rest"})
    motion, rest = solver.simulate(problem, 20.0, errors=False), solver.equilibrium(problem)
    tip = motion.displacement(1.0, np.linspace(0.0, 20.0, 20_001))[0]
    assert tip.mean() == pytest.approx(rest.displacement(1.0)[0], rel=1e-2)
    assert tip.min() == pytest.approx(2 * rest.displacement(1.0)[0], rel=5e-2)


@pytest.mark.parametrize("solver", SOLVERS, ids=IDS)
def test_a_shaken_joint_starts_in_equilibrium_and_leaves_it(solver: analytic.Solver | fe_lapjoint.Solver) -> None:
    shaken = BaseMotion(amplitude=1e-4, angular_frequency=40.0)
    problem = joint(np.random.default_rng(5)).replace(base_motion=shaken)
    motion, rest = solver.simulate(problem, 0.5, errors=False), solver.equilibrium(problem)
    x, size = places(problem), np.abs(rest.displacement(np.linspace(0, 1, 65))).max()
    assert np.abs(motion.displacement(x, 0.0)[:, 0] - rest.displacement(x)).max() <= 1e-8 * size
    assert motion.state_at(0.0) == rest.state
    assert np.abs(motion.velocity(x, 0.3)).max() > 1e-4
    point = solver.period_map(problem).initial()
    assert point.state == rest.state


def test_the_start_is_read_and_written() -> None:
    problem = joint(np.random.default_rng(5))
    text = to_toml(problem)
    assert 'kind = "equilibrium"' in text
    assert from_toml(text) == problem


def test_the_published_scheme_refuses_the_start() -> None:
    problem = paper_joint(angular_frequency=515.0).replace(initial=AtEquilibrium())
    for ask in (lambda it: it.steady_state(problem), lambda it: it.simulate(problem, 0.1)):
        with pytest.raises(InputError, match=r'initial\.kind = "equilibrium": the published scheme starts'):
            ask(PublishedScheme())


@pytest.mark.parametrize("solver", SOLVERS, ids=IDS)
def test_a_motion_from_an_equilibrium_that_is_not_there_is_refused(solver: analytic.Solver) -> None:
    problem = joint(np.random.default_rng(5)).replace(supports=(), stops=())
    with pytest.raises(InputError, match="equilibrium: there is none"):
        solver.simulate(problem, 0.1)
