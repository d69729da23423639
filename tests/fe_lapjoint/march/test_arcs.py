"""Arcs of the finite element model against its march, an exponential of a matrix, differences, and 60 digits."""

from __future__ import annotations

import math
from collections.abc import Iterator

import mpmath as mp
import numpy as np
import pytest
from beams import CLAMP, UNIT
from scipy.linalg import eigh, expm

import fe_lapjoint
from fe_lapjoint.march import arcs as arcs_module
from fe_lapjoint.march.arcs import Arcs
from fe_lapjoint.march.system import System
from lapjoint import (
    FREE,
    ContactState,
    ModalDamping,
    Problem,
    StepLoad,
    Stop,
    Support,
    ViscousDamping,
    paper_joint,
)
from lapjoint.orbits.arcs import ContactSequence
from lapjoint.problem import BaseHarmonic, FloatArray, HarmonicsBaseMotion, NoDamping

DAMPINGS = (
    ModalDamping(ratio=0.03),
    ModalDamping(ratio=(0.01, 0.2, 1.0, 3.0, 0.05)),  # one is critical, one is overdamped
    ModalDamping(ratio=1.0 - 1e-9),
    ViscousDamping(coefficient=0.2),
    ViscousDamping(coefficient=30.0),  # the lowest modes are overdamped
    NoDamping(),
)


def joint(rng: np.random.Generator, number: int) -> Problem:
    """One to four stops, all kinds of damping, rigid-body modes in every third, harmonics and constant loads."""
    supports = ((CLAMP,), (Support(x=0.0, translational=math.inf),), ())[number % 3]
    stops = tuple(
        Stop(
            x=rng.choice([0.35, 0.5, 0.75, 1.0]),
            side=side,
            gap=rng.uniform(1e-4, 1e-3),
            stiffness=10 ** rng.uniform(0, 3),
        )
        for side in rng.choice(["top", "bottom"], size=rng.integers(1, 5))
    )
    waves = tuple(
        BaseHarmonic(multiple=n, amplitude=1e-3 / n**2, phase=rng.uniform(0, 6)) for n in range(1, rng.integers(2, 5))
    )
    return Problem(
        beam=UNIT,
        supports=supports,
        stops=stops,
        damping=DAMPINGS[number % len(DAMPINGS)] if number % 4 else DAMPINGS[0],
        base_motion=HarmonicsBaseMotion(angular_frequency=rng.uniform(2.0, 20.0), harmonics=waves),
        point_loads=(StepLoad(x=0.7, force=1e-3),) if number % 2 else (),
    )


ROUNDING = 1e-14
"""Of the largest rates and accelerations: roundings of sums over tens of modes, and of their functions."""


def arcs_of(problem: Problem, elements: int = 3) -> Arcs:
    return fe_lapjoint.Solver(elements=elements).period_map(problem).arcs


def any_chain(
    rng: np.random.Generator, arcs: Arcs, events: int
) -> tuple[ContactSequence, FloatArray, float, FloatArray]:
    """Any stops switch after any durations, some of which are small, zero or below zero."""
    system = arcs.model.system(FREE)
    n, fastest = system.omega.size, max(system.omega[-1], 2 * system.damping_rate.max())
    stops = tuple(rng.integers(0, len(arcs.problem.stops), size=events).tolist())
    durations = arcs.period * rng.uniform(0.0, 0.4, size=events + 1) * rng.choice([1.0, 1.0, 1e-6, 0.0], events + 1)
    backwards = rng.random(events + 1) < 0.2
    durations[backwards] = -rng.uniform(0.0, 0.5, size=backwards.sum()) / fastest
    turns = np.maximum(system.omega, arcs.omega)
    start = 1e-3 * arcs.omega * np.concatenate([rng.normal(size=n) / turns**2, rng.normal(size=n) / turns])
    return ContactSequence(FREE, stops), start, float(rng.uniform(0, arcs.period)), durations


def population(seed: int, count: int) -> Iterator[tuple[Arcs, ContactSequence, FloatArray, float, FloatArray]]:
    for number in range(count):
        rng = np.random.default_rng((seed, number))
        arcs = arcs_of(joint(rng, number))
        yield arcs, *any_chain(rng, arcs, int(rng.integers(0, 7)))


def over_nodes(arcs: Arcs, state: ContactState) -> FloatArray:
    """The matrix of displacements, velocities, a sine and a cosine for each load, and 1, by assembled matrices."""
    assembly, problem, forces = arcs.model.assembly, arcs.problem, arcs.problem.forces
    M, K, n = assembly.mass, assembly.stiffness(state), assembly.free.size
    square, vectors = eigh(K, M)
    omega = np.sqrt(np.maximum(square, 0.0))
    omega[: assembly.rigid_modes(state)] = 0.0
    drag = np.full(n, getattr(problem.damping, "coefficient", 0.0))
    if isinstance(problem.damping, ModalDamping):
        drag = problem.damping.ratios(n) * 2 * omega
    constant = sum((load.force * assembly.load(load.shape) for load in forces.constant), np.zeros(n))
    for k in state.closed:
        stop = problem.stops[k]
        constant = constant + stop.sign * stop.stiffness * stop.gap * assembly.stop_rows[k]
    A = np.zeros((2 * n + 2 * len(forces.harmonic) + 1,) * 2)
    A[:n, n : 2 * n] = np.eye(n)
    A[n : 2 * n, :n] = -np.linalg.solve(M, K)
    A[n : 2 * n, n : 2 * n] = -vectors @ np.diag(drag) @ vectors.T @ M
    A[n : 2 * n, -1] = np.linalg.solve(M, constant)
    for i, load in enumerate(forces.harmonic):
        sine = 2 * n + 2 * i
        A[n : 2 * n, sine] = np.linalg.solve(M, load.amplitude * assembly.load(load.shape))
        A[sine, sine + 1], A[sine + 1, sine] = load.angular_frequency, -load.angular_frequency
    return A


def test_a_chain_is_what_exponentials_of_matrices_over_the_nodes_give() -> None:
    for arcs, sequence, start, time, durations in population(1, 20):
        first, last = (arcs.model.system(state).vectors for state in (sequence.first, sequence.states[-1]))
        angles = [f.angular_frequency * time + f.phase for f in arcs.problem.forces.harmonic]
        loads = [part for angle in angles for part in (math.sin(angle), math.cos(angle))]
        x = np.concatenate([*(first @ part for part in np.split(start, 2)), loads, [1.0]])
        for state, duration in zip(sequence.states, durations, strict=True):
            x = expm(over_nodes(arcs, state) * duration) @ x
        found = arcs.chain(sequence, start, time, durations, derivatives=False)
        for part, known in zip(np.split(found.end, 2), np.split(x[: start.size], 2), strict=True):
            # The matrix rounds by 1e-16 of the highest omega^2, up to 1e8 of the lowest.
            assert np.abs(last @ part - known).max() <= 1e-6 * np.abs(known).max()


def exact_means(a: float, omega: float, d: float) -> list[tuple[mp.mpf, mp.mpf]]:
    """The mean rate over d of a free mode after a unit displacement and a unit velocity, and its derivative by d."""
    a, square, d = mp.mpf(a), mp.mpf(omega) ** 2, mp.mpf(d)
    s = mp.sqrt(mp.mpc(a**2 - square))

    def derivatives(t: mp.mpf) -> list[tuple[mp.mpf, mp.mpf, mp.mpf]]:
        S = mp.exp(-a * t) * (mp.sinh(s * t) / s if s else t)
        C = mp.exp(-a * t) * mp.cosh(s * t) + a * S
        v, w = -square * S, C - 2 * a * S
        return [(mp.re(z), mp.re(rate), mp.re(-square * y - 2 * a * rate)) for z, rate, y in ((C, v, C), (S, w, S))]

    if not d:
        return [(rate, bend / 2) for _, rate, bend in derivatives(d)]
    means = [(there[0] - z) / d for there, z in zip(derivatives(d), (1, 0), strict=True)]
    return [(mean, (there[1] - mean) / d) for mean, there in zip(means, derivatives(d), strict=True)]


def exact_equation(
    arcs: Arcs, system: System, y: FloatArray, time: float, d: float, stop: int
) -> tuple[mp.mpf, mp.mpf, FloatArray]:
    """The mean rate of h over d, m/s, its derivative by d, and that by (q, q') at the start, ``(2, n)``."""
    value, by_duration, by_start = mp.mpf(0), mp.mpf(0), np.zeros((2, system.omega.size))
    loads = [
        (mp.mpf(w), mp.expj(mp.mpf(w) * time + phase)) for w, phase in zip(system.driven, system.phase, strict=True)
    ]
    of_loads, ramps = (
        [exact_means(0.0, w, d) for w in system.driven],
        system.drift or (np.zeros(system.omega.size),) * 2,
    )
    for j, share in enumerate(arcs.model.sign[stop] * system.stops[stop]):
        waves = [(P * turn, w) for P, (w, turn) in zip(system.amplitudes[j], loads, strict=True)]
        units = [(y[j] - mp.fsum(wave.imag for wave, _ in waves) - system.equilibrium[j])]
        units.append(y[system.omega.size + j] - mp.fsum(w * wave.real for wave, w in waves) - ramps[0][j])
        own = exact_means(system.damping_rate[j], system.omega[j], d)
        parts = list(zip(units, own, strict=True))
        for (wave, w), both in zip(waves, of_loads, strict=True):
            parts += [(wave.imag, both[0]), (w * wave.real, both[1])]
        value += share * (mp.fsum(unit * mean for unit, (mean, _) in parts) + ramps[0][j] + ramps[1][j] * mp.mpf(d) / 2)
        by_duration += share * (mp.fsum(unit * bend for unit, (_, bend) in parts) + ramps[1][j] / 2)
        by_start[:, j] = [float(share * mean) for mean, _ in own]
    return value, by_duration, by_start


@pytest.mark.parametrize("duration", [0.0, 1e-12, -1e-12, 1e-9, 1e-7, 1e-5, 1e-4, 1e-3, -1e-4, 1e-2, 0.3])
def test_the_equation_of_a_returning_stop_has_all_digits_at_any_duration(duration: float) -> None:
    """Against 60 digits, from the same modes: the equation, and its derivatives by the start and by the duration.

    Its digits are those of the largest rate and acceleration that each mode and each load could have.
    """
    with mp.workdps(60):
        for number in range(12):
            rng = np.random.default_rng((3, number))
            arcs = arcs_of(joint(rng, number))
            d, stop = duration * arcs.period, 0
            _, start, time, _ = any_chain(rng, arcs, 0)
            found = arcs.chain(ContactSequence(FREE, (stop, stop)), start, time, np.array([0.0, d, 0.0]))
            assert found.events_by is not None
            system, n = arcs.model.system(ContactState((stop,))), start.size // 2
            value, by_duration, by_start = exact_equation(arcs, system, found.starts[1], time, d, stop)
            row, (q, v) = np.abs(system.stops[stop]), np.abs(np.split(found.starts[1], 2))
            turn = system.omega + 2 * system.damping_rate
            shaken = row @ np.abs(system.amplitudes) @ system.driven
            rate, bend = row @ (turn * q + v) + shaken, row @ (turn**2 * q + turn * v) + shaken * system.driven.max()
            assert abs(float(found.events[1] - value)) <= ROUNDING * rate
            assert abs(float(found.events_by[1, 2 * n + 1] - by_duration)) <= ROUNDING * bend
            S = arcs.model.transfer(FREE, system.state)
            for known, exact, unit in zip(np.split(found.events_by[1, : 2 * n], 2), by_start, (turn, 1), strict=True):
                assert (np.abs(known - exact @ S) <= ROUNDING * (row * unit) @ np.abs(S)).all()


def test_a_contact_of_no_duration_leaves_no_trace() -> None:
    for number in range(6):
        rng = np.random.default_rng((4, number))
        arcs = arcs_of(joint(rng, number))
        _, start, time, _ = any_chain(rng, arcs, 0)
        first, second = arcs.period * rng.uniform(0.01, 0.5, size=2)
        there = arcs.chain(ContactSequence(FREE, (0, 0)), start, time, np.array([first, 0.0, second]))
        alone = arcs.chain(ContactSequence(FREE), start, time, np.array([first + second]))
        assert there.end_by is not None
        assert alone.end_by is not None
        size, weights = np.abs(alone.end).max(), np.append(arcs.model.system(FREE).omega, np.ones(start.size // 2))
        assert np.abs(there.end - alone.end).max() <= 1e-12 * size
        apart = there.end_by[:, : start.size] - alone.end_by[:, : start.size]
        # Units of displacement of fast modes come to velocities as large as their frequencies.
        assert np.abs(apart).max() <= 1e-12 * weights.max()
        assert np.abs(arcs.later(FREE, start, time, first + second) - alone.end).max() <= 1e-15 * size


def test_modes_that_die_out_change_no_derivative(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = paper_joint(angular_frequency=515.0, damping_ratio=0.05)
    arcs = arcs_of(problem, 16)
    stops, n = (0, 0, 1, 1, 2, 2, 0), arcs.model.system(FREE).omega.size
    durations = arcs.period * np.array([3.0, 0.2, 1.0, 0.0, 2.0, 0.5, 0.1, 3.0])
    start = arcs.coordinates(fe_lapjoint.Solver(elements=16).period_map(problem).initial())
    start[0] = 1e-3
    found = arcs.chain(ContactSequence(FREE, stops), start, 0.0, durations)
    monkeypatch.setattr(arcs_module, "DEAD", math.inf)
    whole = arcs.chain(ContactSequence(FREE, stops), start, 0.0, durations)
    for known, all_modes in ((found.end_by, whole.end_by), (found.events_by, whole.events_by)):
        assert known is not None
        assert all_modes is not None
        assert np.count_nonzero(known[0, :n]) < np.count_nonzero(all_modes[0, :n])
        assert np.abs(known - all_modes).max() <= 1e-14 * np.abs(all_modes).max()
