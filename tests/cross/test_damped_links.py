"""Damped links, and viscous damping of single beams, by both solvers: closed forms, splines with expm, and limits."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy.linalg
from damped_links import Splines, damped_pair
from few_and_many import few_and_many

import analytic
import fe_lapjoint
from lapjoint import Problem
from lapjoint.answers import History
from lapjoint.problem import FloatArray, Link, NamedBeam, NoDamping, ViscousDamping
from tests.cross.test_damped_motions import SMALL, check_derivative
from validation.invariants import witness
from validation.verdict import Verdict

CONTACTS, MARGIN = 4, 3.0  # first contacts that are compared; times the stated errors, which are to cover 19 of 20
BOTH = pytest.mark.parametrize("solver", [analytic.Solver(n_modes=10), fe_lapjoint.Solver(elements=8)])
STIFF = {"length": 1.0, "bending_stiffness": 1e6, "mass_per_length": 1.0}
PLAIN = {"length": 0.5, "bending_stiffness": 1.0, "mass_per_length": 1.0}
CLAMP = {"x": 0.0, "translational": math.inf, "torsional": math.inf}
TILTED = {"x": [0, 0.3, 0.6, 1], "displacement": [0.02, 0.023, 0.026, 0.03], "velocity": [0.08, 0.092, 0.104, 0.12]}


def apart(t: FloatArray, start: tuple[float, float], mass: float, damping: float, stiffness: float) -> FloatArray:
    """The difference of two equal masses, kg or kg m2, with a spring and a damper between them, from its start and
    rate."""
    matrix = np.array([[0.0, 1.0], [-2 * stiffness / mass, -2 * damping / mass]])
    return np.array([(scipy.linalg.expm(matrix * s) @ start)[0] for s in t])


@BOTH
@pytest.mark.parametrize(("k", "damping", "turn", "turning"), [(20.0, 3.0, 7.0, 0.3), (0.0, 0.7, 0.0, 0.0)])
def test_two_stiff_beams_move_as_two_masses(solver: Any, k: float, damping: float, turn: float, turning: float) -> None:
    """Joined by a damper alone, the beams go on to turn as they do, and one takes along the other."""
    link = {"between": ["a:0.5", "b:0.5"], "translational": k, "torsional": turn}
    problem = Problem.model_validate(
        {
            "beams": [STIFF | {"name": name} for name in "ab"],
            "links": [link | {"damping": damping, "torsional_damping": turning}],
            "initial": {"kind": "beams", "beams": [TILTED | {"beam": "b"}]},
        }
    )
    t, both = np.linspace(0, 1.5, 7), np.array([problem.position("a:0.5"), problem.position("b:0.5")])
    motion = solver.simulate(problem, 1.5, errors=False)
    for found, start, mass, spring, damper in (
        (motion.displacement(both, t), (0.025, 0.1), 1.0, k, damping),
        (motion.slope(both, t), (0.01, 0.04), 1 / 12, turn, turning),
    ):
        assert found[1] - found[0] == pytest.approx(apart(t, start, mass, damper, spring), abs=2e-5 * start[0])
        assert found.sum(axis=0) == pytest.approx(start[0] + start[1] * t, rel=1e-8)


@pytest.mark.parametrize("seeds", few_and_many(range(2, 4), range(4, 44)))
def test_linear_motions_are_those_of_splines(seeds: range) -> None:
    """Modes that are left out yield to dampers, between slopes by a share that falls slowly with their number."""
    for seed in seeds:
        problem, t = damped_pair(np.random.default_rng(seed), strike=False), 0.7 + 0.03 * seed
        turns, exact = any(link.torsional_damping for link in problem.links), Splines(problem).from_rest("upper:1.0", t)
        size = 0.03 + abs(exact)
        for solver, off in (
            (analytic.Solver(n_modes=16), 2e-2 if turns else 1e-3),
            (fe_lapjoint.Solver(elements=8), 1e-4),
        ):
            z = solver.simulate(problem, t, errors=False).displacement(problem.position("upper:1.0"), t).item()
            assert abs(z - exact) < off * size, seed


@pytest.mark.thorough
def test_motions_under_a_record_are_those_of_splines() -> None:
    problem = damped_pair(np.random.default_rng(1), strike=False)
    links = tuple(it.model_copy(update={"torsional_damping": 0.0}) for it in problem.links)
    problem = problem.replace(links=links, damping=ViscousDamping(coefficient=0.5))
    times, values = np.linspace(0, 1.5, 16), np.random.default_rng(0).normal(size=16)
    record = {"kind": "record", "x": "lower:0.8", "times": times.tolist(), "values": values.tolist()}
    given = problem.model_dump() | {"base_motion": None, "point_loads": [record]}
    exact = Splines(problem).under_ramps("upper:1.0", "lower:0.8", times, values)
    motion = analytic.Solver(n_modes=16).simulate(Problem.model_validate(given), 1.5, errors=False)
    assert motion.displacement(problem.position("upper:1.0"), 1.5).item() == pytest.approx(exact, rel=1e-4)


@pytest.mark.thorough
@pytest.mark.parametrize("solver", [analytic.Solver(n_modes=48), fe_lapjoint.Solver(elements=8)])  # 24 leave 2e-4
def test_energy_and_momentum_are_accounted_for(solver: Any) -> None:
    problem = damped_pair(np.random.default_rng(3)).replace(damping=NoDamping())
    loose = problem.replace(beams=tuple(beam.model_copy(update={"supports": ()}) for beam in problem.beams))
    for one in (problem, loose):
        motion = solver.simulate(one, 0.9, errors=False)
        found = witness(motion, 1e-4, "")
        assert [it.name for it in found if it.verdict is not Verdict.AGREE] == []
        assert len(found) == 4 + 4 * (one is loose) + any(stop.damping > 0 for stop in one.stops)
        weak = [link.model_copy(update={"damping": 1.01 * link.damping}) for link in one.links]
        wrong = History(**{name: getattr(motion, name) for name in motion.__dataclass_fields__} | {
            "problem": one.replace(links=tuple(weak))
        })  # fmt: skip
        assert witness(wrong, 1e-4, "")[0].verdict is Verdict.DISAGREE


@BOTH
def test_a_damper_that_never_gives_joins_two_halves(solver: Any) -> None:
    halves = [PLAIN | {"name": "a", "supports": [CLAMP]}, PLAIN | {"name": "b"}]
    load, z = {"kind": "step", "x": "b:0.5", "force": 1.0}, []
    for springs in ({"translational": math.inf}, *({"damping": damping} for damping in (1e2, 1e3, 1e4))):
        link = springs | {"between": ["a:0.5", "b:0.0"], "torsional": math.inf}
        problem = Problem.model_validate({"beams": halves, "links": [link], "point_loads": [load]})
        z.append(solver.simulate(problem, 0.5, errors=False).displacement(problem.position("b:0.5"), 0.5).item())
    off = [abs(it / z[0] - 1) for it in z[1:]]
    assert off[1] < 0.15 * off[0]
    assert off[2] < 0.15 * off[1]


@BOTH
@pytest.mark.parametrize("uneven", [False, True])
def test_one_viscous_coefficient_of_all_beams_is_that_of_the_problem(solver: Any, uneven: bool) -> None:
    problem = damped_pair(np.random.default_rng(5)).replace(damping=NoDamping())
    beams: list[NamedBeam] = [
        NamedBeam(**PLAIN | {"mass_per_length": 1.0 + uneven * i}, name=beam.name, supports=beam.supports)
        for i, beam in enumerate(problem.beams)
    ]
    problem = problem.replace(beams=tuple(beams), links=(), stops=())
    own = [beam.model_copy(update={"viscous_damping": 0.8}) for beam in beams]
    one, other = (
        solver.simulate(it, 1.1, errors=False).displacement(problem.position("lower:0.5"), 1.1).item()
        for it in (problem.replace(damping=ViscousDamping(coefficient=0.8)), problem.replace(beams=tuple(own)))
    )
    assert problem.replace(beams=tuple(own)).structure.couples == uneven
    assert other == pytest.approx(one, rel=1e-13)


@pytest.mark.thorough
def test_link_dampers_add_to_those_of_the_problem() -> None:
    """A link with both dampers is two links, one with each."""
    problem = damped_pair(np.random.default_rng(6))
    link: Link = problem.links[0].model_copy(update={"damping": 2.0, "torsional_damping": 0.4})
    parts = (
        link.model_copy(update={"damping": 2.0, "torsional_damping": 0.0}),
        Link(between=link.between, torsional_damping=0.4),
    )
    z = [
        analytic.Solver(n_modes=6).simulate(problem.replace(links=links), 1.0, errors=False).displacement(0.9, 1.0)
        for links in ((link,), parts)
    ]
    assert z[1].item() == pytest.approx(z[0].item(), rel=1e-9)


def far(problem: Problem, duration: float) -> list[float]:
    """Distances of the first contacts' starts and impulses, over what the stated errors allow."""
    solvers = analytic.Solver(), fe_lapjoint.Solver()
    one, other = (solver.simulate(problem, duration).contacts[:CONTACTS] for solver in solvers)
    found: list[float] = []
    for a, b in zip(one, other, strict=False):
        if a.stop != b.stop:
            break
        for what in ("start", "impulse"):
            errors = [getattr(c, f"{what}_error") for c in (a, b)]
            found.append(abs(getattr(a, what) - getattr(b, what)) / (MARGIN * sum(errors) + 1e-9))
    return found


@pytest.mark.thorough
@pytest.mark.parametrize("seeds", few_and_many(range(1), range(1, 50)))
def test_first_contacts_agree_within_stated_errors(seeds: range) -> None:
    found = [each for seed in seeds for each in far(damped_pair(np.random.default_rng(seed)), 4.0)]
    assert len(found) >= 4 * len(seeds)
    assert sum(each > 1 for each in found) <= 0.05 * len(found)


@pytest.mark.parametrize("solver", SMALL)
@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 25))])
def test_deviations_travel_as_finite_differences(solver: Any, seed: int) -> None:
    check_derivative(solver, seed, damped_pair)
