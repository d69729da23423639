"""Both solvers under records: against closed forms, against modal equations integrated by scipy, and each other."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import analytic
import fe_lapjoint
from analytic.march import Joint, march
from analytic.march.initial_state import started
from lapjoint import FREE, BaseMotion, NoDamping, Problem, paper_joint
from lapjoint.problem import FloatArray, RandomBaseMotion, RecordBaseMotion, RecordLoad, ViscousDamping
from lapjoint.solver import Solver

SOLVERS = {"analytic": analytic.Solver(n_modes=10), "fe": fe_lapjoint.Solver(elements=8)}
RATE = 1e4


def _shaken(size: float, count: int, seed: int, **changes: object) -> Problem:
    """The paper's joint on a base with a random acceleration, m/s2."""
    values = size * np.random.default_rng(seed).standard_normal(count)
    base = RecordBaseMotion(quantity="acceleration", values=values, rate=RATE)
    return paper_joint().replace(base_motion=base, **changes)


def _with_more_samples(problem: Problem, seed: int) -> Problem:
    base = problem.base_motion
    assert isinstance(base, RecordBaseMotion)
    extra = np.random.default_rng(seed).uniform(0, base.duration, 2 * base.time.size)
    times = np.unique(np.concatenate([base.time, extra]))
    return problem.replace(base_motion=RecordBaseMotion(quantity="acceleration", values=base.at(times, 2), times=times))


@pytest.mark.parametrize("name", SOLVERS)
@pytest.mark.parametrize("quantity", ["acceleration", "velocity", "displacement"])
def test_a_sine_as_a_record_is_a_sine_but_for_the_error_of_sampling(name: str, quantity: str) -> None:
    solver, Y, omega = SOLVERS[name], 1e-4, 300.0
    joint, end, order = (
        paper_joint().replace(stops=()),
        0.02,
        ("displacement", "velocity", "acceleration").index(quantity),
    )
    sine = BaseMotion(amplitude=Y, angular_frequency=omega)
    t = np.linspace(0, end, 61)
    exact = solver.simulate(joint.replace(base_motion=sine), end, errors=False).displacement([0.5, 2.5], t)
    found = []
    for count in (21, 41, 81):
        times = np.linspace(0, end, count)
        record = RecordBaseMotion(quantity=quantity, values=sine.at(times, order), times=times)
        motion = solver.simulate(joint.replace(base_motion=record), end, errors=False)
        error = np.max(np.abs(motion.displacement([0.5, 2.5], t) - exact)) / np.max(np.abs(exact))
        found.append(error / (omega * end / (count - 1)) ** 2)
    # a linear interpolant of a sine lies inside of it, by (omega h)^2 / 12 in the mean; splines meet it better
    assert found[-1] < 1.3 / 12
    if quantity == "acceleration":
        assert np.allclose(found, 1 / 12, rtol=0.3)  # both parts of the motion from rest, forced and free, share it


@pytest.mark.parametrize("name", SOLVERS)
def test_samples_on_the_interpolant_change_nothing_without_contact(name: str) -> None:
    problem = _shaken(200.0, 151, 3, stops=())
    once, again = (SOLVERS[name].simulate(it, 0.015, errors=False) for it in (problem, _with_more_samples(problem, 4)))
    t = np.linspace(0, 0.015, 301)
    for dt in (0, 1, 2):
        one, other = (motion.evaluate([0.7, 2.5], t, dt=dt) for motion in (once, again))
        assert np.max(np.abs(one - other)) < 1e-9 * np.max(np.abs(one))


@pytest.mark.parametrize("name", SOLVERS)
def test_samples_on_the_interpolant_change_nothing_in_the_first_ten_contacts(name: str) -> None:
    problem = _shaken(200.0, 701, 1)
    once, again = (SOLVERS[name].simulate(it, 0.07, errors=False) for it in (problem, _with_more_samples(problem, 4)))
    assert once.contacts
    largest, hardest = (max(abs(getattr(it, of)) for it in once.contacts[:10]) for of in ("impulse", "peak_force"))
    for one, other in zip(once.contacts[:10], again.contacts[:10], strict=True):
        assert one.stop == other.stop
        assert abs(one.start - other.start) < 1e-9 * one.start
        assert abs(one.end - other.end) < 1e-9 * one.end
        assert abs(one.impulse - other.impulse) < 1e-9 * largest
        assert abs(one.peak_force - other.peak_force) < 1e-9 * hardest


@pytest.mark.parametrize("coefficient", [0.0, 0.01, 40.0, 3000.0])
def test_modes_follow_their_equations_whatever_the_damping(coefficient: float) -> None:
    """A free beam: rigid-body modes with a small drag, with a large one, and modes that are damped above critical."""
    joint, count = paper_joint(), 5
    damping = ViscousDamping(coefficient=coefficient * joint.beam.m) if coefficient else NoDamping()
    load = RecordLoad(x=1.0, values=300 * np.random.default_rng(8).standard_normal(61), rate=RATE)
    problem = _shaken(100.0, 61, 2, stops=(), supports=(), damping=damping, point_loads=(load,))
    solved = Joint(problem, count, count)
    modal, end = solved.modal(FREE), load.duration
    motion = march(solved, started(solved), 0.0, end)
    base, omega, rate = problem.forces.sampled[0], modal.modes.omega, modal.damping_rate

    def rates(t: float, y: FloatArray) -> FloatArray:
        at = np.array([t])
        force = base.at(at)[0] * modal.force[1] + np.interp(t, load.time, load.force) * modal.force[2]
        return np.concatenate([y[count:], force - 2 * rate * y[count:] - omega**2 * y[:count]])

    y, sizes = np.zeros(2 * count), np.zeros(2 * count)
    for a, b in zip(load.time[:-1], load.time[1:], strict=True):
        y = solve_ivp(rates, (a, b), y, method="DOP853", rtol=1e-12, atol=1e-16).y[:, -1]
        sizes = np.maximum(sizes, np.abs(y))
    found = np.concatenate([motion.end.q, motion.end.v])
    assert np.all(np.abs(found - y) < 1e-9 * sizes)  # 60 steps of the witness at 1e-12 each, and what they carry on


@pytest.mark.parametrize("damping", [NoDamping(), ViscousDamping(coefficient=2.0), ViscousDamping(coefficient=2e4)])
@pytest.mark.parametrize("name", SOLVERS)
def test_a_free_beam_stays_where_it_is_while_its_base_moves(name: str, damping: NoDamping | ViscousDamping) -> None:
    problem = _shaken(50.0, 101, 6, stops=(), supports=(), damping=damping)
    base, drag = problem.base_motion, (damping.coefficient if isinstance(damping, ViscousDamping) else 0.0)
    assert isinstance(base, RecordBaseMotion)
    t = base.time[1:]
    found = SOLVERS[name].simulate(problem, base.duration, errors=False).displacement([0.0, 1.7], t)
    rate = drag / problem.beam.m
    # z'' + rate z' = -y'': with z = -y + u, u' + rate u = rate y, one interval after the other
    if rate == 0.0:
        exact = -base.at(t)
    else:

        def change(s: float, z: FloatArray) -> FloatArray:
            return np.array([z[1], -rate * z[1] - base.at(np.array([s]), 2)[0]])

        z, exact = np.zeros(2), np.zeros(t.size)
        for i, (a, b) in enumerate(zip(base.time[:-1], t, strict=True)):
            z = solve_ivp(change, (a, b), z, method="DOP853", rtol=1e-12, atol=1e-18).y[:, -1]
            exact[i] = z[0]
    assert np.max(np.abs(found - exact)) < 1e-9 * np.max(np.abs(exact))


@pytest.mark.parametrize("name", SOLVERS)
def test_accelerations_and_forces_of_a_history_obey_the_equation_of_motion(name: str) -> None:
    """Momentum about a free beam pressed by its stops: mass times acceleration is the sum of forces, at any time."""
    problem = _shaken(200.0, 201, 1, supports=(), damping=NoDamping())
    motion, base = SOLVERS[name].simulate(problem, 0.02, errors=False), problem.base_motion
    assert isinstance(base, RecordBaseMotion)
    x, w = np.polynomial.legendre.leggauss(60)
    L, t = problem.beam.length, np.linspace(0.0003, 0.0199, 97)
    mean = (w / 2) @ motion.evaluate((x + 1) * L / 2, t, dt=1)
    steps = np.diff(mean)  # the mean acceleration is integrated, as it jumps by truncation where a stop switches
    fine = np.linspace(t[0], t[-1], 96 * 40 + 1)
    forces = motion.contact_force(fine).sum(axis=0) - problem.beam.m * L * base.at(fine, 2)
    area = np.array([np.trapezoid(forces[40 * i : 40 * i + 41], fine[40 * i : 40 * i + 41]) for i in range(96)])
    assert np.max(np.abs(problem.beam.m * L * steps - area)) < 2e-3 * np.max(np.abs(area))


def test_what_sampled_forces_cannot_have_is_refused_by_every_solver() -> None:
    recorded = _shaken(1.0, 11, 1)
    random = recorded.replace(base_motion=RandomBaseMotion(psd=((50.0, 3.0), (500.0, 3.0))))
    for solver in SOLVERS.values():
        assert isinstance(solver, Solver)
        with pytest.raises(ValueError, match="base_motion is a record, which has no period"):
            solver.steady_state(recorded)
        with pytest.raises(ValueError, match=r"the record of base_motion ends at 0\.001 s"):
            solver.simulate(recorded, 0.002)
        with pytest.raises(ValueError, match="base_motion is random, and has no period; simulate it, or ask for stat"):
            solver.steady_state(random)
    for problem, kind in ((recorded, "records"), (random, "random excitation")):
        with pytest.raises(ValueError, match=f"the published scheme knows no {kind}"):
            analytic.PublishedScheme().simulate(problem, 0.001)
