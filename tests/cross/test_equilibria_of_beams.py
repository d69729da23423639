"""Both solvers find the same static equilibria of several beams, and motions that start there stay there."""

from __future__ import annotations

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import AtEquilibrium, InputError, Problem
from lapjoint.cli.equilibrium_printing import differences
from lapjoint.problem.presets import lap_joint
from lapjoint.problem.static_loads import Gravity
from tests.helpers.linked_beams import resting_beams
from tests.helpers.rested import rested

MARCHES = (analytic.Solver(n_modes=12), fe_lapjoint.Solver(elements=16))
IDS = ("analytic", "fe")


def rest_alike(problem: Problem) -> bool:
    """Whether there is an equilibrium, after a check that both solvers say so, and agree."""
    found = rested(problem)
    if found is None:
        return False
    one, other = found
    assert differences(one, other) == []
    assert one.other_equilibria == other.other_equilibria
    assert np.all(other.errors.contact_forces <= 1e-7 * other.contact_forces.max(initial=0.0))
    return True


def test_random_systems_rest_alike() -> None:
    rng = np.random.default_rng(53)
    assert sum(rest_alike(resting_beams(rng)) for _ in range(5))


@pytest.mark.slow
def test_500_random_systems_rest_alike() -> None:
    rng = np.random.default_rng(4904)
    assert sum(rest_alike(resting_beams(rng)) for _ in range(500)) > 250


def laden_lap() -> Problem:
    """The lap joint under its weight, one gap an interference, at rest."""
    lap = lap_joint()
    stops = (lap.stops[0].model_copy(update={"gap": -1e-4}), *lap.stops[1:])
    return lap.replace(stops=stops, base_motion=None, gravity=Gravity(acceleration=-9.81), initial=AtEquilibrium())


@pytest.mark.parametrize("solver", MARCHES, ids=IDS)
def test_a_lap_joint_in_equilibrium_stays_there(solver: analytic.Solver | fe_lapjoint.Solver) -> None:
    problem = laden_lap()
    rest, motion = solver.equilibrium(problem), solver.simulate(problem, 0.05, errors=False)
    x, t = problem.line.grid(5), np.linspace(0, motion.end, 13)
    z, size = motion.displacement(x, t), np.abs(rest.displacement(x)).max()
    assert rest.state.closed == (0,)
    assert motion.states == (rest.state,)
    assert np.abs(z[:, 0] - rest.displacement(x)).max() <= 1e-5 * size  # modes, and quartics within elements, left out
    assert np.abs(z - z[:, :1]).max() <= 1e-12 * size


@pytest.mark.parametrize("solver", MARCHES, ids=IDS)
@pytest.mark.parametrize(("moved", "closed"), [(0.02, (2,)), (-0.02, (0, 1))])
def test_gaps_between_beams_are_read_on_both_at_the_start(
    solver: analytic.Solver | fe_lapjoint.Solver, moved: float, closed: tuple[int, ...]
) -> None:
    """The upper plate, moved up, leaves the lower one, and moved down strikes it; the bolt holds at the other."""
    start = {"kind": "beams", "beams": [{"beam": "upper", "displacement": [0, 0, moved]}]}
    lap = lap_joint().replace(base_motion=None, initial=start)

    assert solver.simulate(lap, 1e-6, errors=False).states[0].closed == closed


@pytest.mark.slow
@pytest.mark.parametrize("solver", MARCHES, ids=IDS)
def test_random_systems_in_equilibrium_stay_there(solver: analytic.Solver | fe_lapjoint.Solver) -> None:
    """Stops, springs and masses of all sizes; twelve modes leave a part of some deflections out."""
    rng, rested = np.random.default_rng(495), 0
    while rested < 25:
        problem = resting_beams(rng).replace(initial=AtEquilibrium())
        try:
            rest = solver.equilibrium(problem)
        except InputError:
            continue
        x = np.unique([x for stop in problem.structure.stops for x, _ in stop.reading])
        size = np.abs(rest.displacement(problem.line.grid(9))).max()
        if size == 0 or not rest.unique:
            continue
        slowest = problem.line.slowest_bending
        motion, t = solver.simulate(problem, 20 / slowest, errors=False), np.linspace(0, 20 / slowest, 13)
        z = motion.displacement(x, t)
        assert motion.states == (rest.state,)
        assert np.abs(z[:, 0] - rest.displacement(x)).max() <= 1e-2 * size
        assert np.abs(z - z[:, :1]).max() <= 1e-11 * size
        assert np.abs(motion.velocity(x, t)).max() <= 1e-11 * size * slowest
        rested += 1
