"""Arcs with coupled modes, by both solvers: against their marches, an ODE march and differences."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from few_and_many import few_and_many

import analytic
import fe_lapjoint
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.orbits.arcs import Arcs, Chain, ContactSequence
from lapjoint.orbits.segments import Segments
from lapjoint.orbits.watch import switches_of
from lapjoint.problem import FloatArray
from tests.helpers.damped_stops import witnessed
from tests.helpers.random_joints import damped_cantilever, dragged_cantilever

SOLVERS: dict[str, Any] = {"analytic": analytic.Solver(n_modes=8), "fe": fe_lapjoint.Solver(elements=3)}
BOTH = pytest.mark.parametrize("name", SOLVERS)
SOME = pytest.mark.parametrize("seeds", few_and_many(range(10), range(10, 60)))
CHATTERS = 40  # switches in a period, beyond which roundings grow too large
PERIODS = 3  # before the arcs begin
STEP = 1e-7  # of durations in differences, as a fraction of the period
RESOLVED = 1e-3  # largest product of a rate and this step; differences err by a sixth of its square


def size(values: npt.NDArray[np.inexact[Any]]) -> float:
    """The largest of some numbers, without sign."""
    return float(np.abs(values).max(initial=0.0))


def cut(name: str, seed: int) -> tuple[Any, SectionPoint, ContactSequence, FloatArray]:
    """A period map, a motion some periods from rest, and the sequence and durations of its next period."""
    draw = damped_cantilever if seed % 2 else dragged_cantilever
    period_map = SOLVERS[name].period_map(draw(np.random.default_rng(seed)))
    problem = period_map.problem
    point = period_map.march(period_map.initial(), 2 * PERIODS).end
    segments = Segments.of(period_map.linearised(point, 2).motion)
    at = np.flatnonzero(segments.switched >= 0)
    sequence = ContactSequence(point.state, tuple(switches_of(problem.stops)[segments.switched[at]].tolist()))
    return period_map, point, sequence, np.diff([0.0, *segments.end[at], period_map.period])


@pytest.mark.parametrize("name", ["fe", pytest.param("analytic", marks=pytest.mark.thorough)])
@SOME
def test_arcs_go_where_the_march_goes_and_have_its_derivative(seeds: range, name: str) -> None:
    forces = 0
    for seed in seeds:
        period_map, point, sequence, durations = cut(name, seed)
        arcs = period_map.arcs
        if len(sequence.stops) > CHATTERS:
            continue
        start = arcs.coordinates(point)
        chain = arcs.chain(sequence, start, 0.0, durations)
        end = period_map.march(point, 2).end
        assert end.state == sequence.states[-1]
        assert size(chain.end - arcs.coordinates(end)) <= 1e-10 * size(chain.end), seed
        forces += sum(switch < 0 for switch in sequence.stops)
        plain = [i for i in range(len(sequence.stops)) if not (sequence.returning[i] or sequence.joining[i])]
        if name == "fe":  # whose modes lose nothing at a switch
            assert size(chain.events[plain]) <= 1e-8
            joining = np.flatnonzero(sequence.joining)
            assert size(chain.events[joining] * (durations[joining] + durations[joining - 1])) <= 1e-8
    assert forces >= len(seeds)


@BOTH
@SOME
def test_derivatives_are_those_that_differences_give(seeds: range, name: str) -> None:
    joined = 0
    for seed in seeds:
        period_map, point, sequence, durations = cut(name, seed)
        arcs, rng = period_map.arcs, np.random.default_rng(seed)
        if len(sequence.stops) > CHATTERS:
            continue
        for i in np.flatnonzero(sequence.joining):
            durations[i - 1 : i + 1] = 10 ** rng.uniform(-2.5, -1) * rng.uniform(0.3, 1, 2) * arcs.period
            joined += 1
        chain = arcs.chain(sequence, arcs.coordinates(point), 0.0, durations, derivatives=False)
        if np.abs(arcs.motion(sequence, chain, durations).rates).max() * STEP * arcs.period > RESOLVED:
            continue
        check_derivatives(arcs, sequence, arcs.coordinates(point), durations)
    assert joined >= len(seeds) // 4


def check_derivatives(arcs: Arcs, sequence: ContactSequence, start: FloatArray, durations: FloatArray) -> None:
    """Fail unless derivatives by the start and by durations are those that central differences give."""
    n, M = start.size, len(sequence.stops)
    chain = arcs.chain(sequence, start, 0.0, durations)
    assert chain.end_by is not None
    assert chain.events_by is not None
    steps = np.concatenate([size(start) / arcs.unit_norms(sequence.first), np.full(M + 1, STEP * arcs.period)])
    told, found = np.concatenate([chain.end_by, chain.events_by]) * steps, np.empty((chain.end.size + M, n + M + 1))

    def moved(by: FloatArray) -> FloatArray:
        there: Chain = arcs.chain(sequence, start + by[:n], 0.0, durations + by[n:], derivatives=False)
        return np.concatenate([there.end, there.events])

    for j in range(n + M + 1):
        by = np.eye(n + M + 1)[j] * steps
        found[:, j] = (moved(by) - moved(-by)) / 2
    for part in (slice(0, n), slice(n, n + M + 1)):
        for rows in (slice(0, chain.end.size), *(slice(chain.end.size + i, chain.end.size + i + 1) for i in range(M))):
            assert size((told - found)[rows, part]) <= 1e-6 * size(told[rows, part])


@BOTH
def test_the_two_arcs_of_a_graze_are_regular_where_they_vanish(name: str) -> None:
    """At p = r = 0 the equation of the opening is h' = 0; its derivatives by p and r are the limits."""
    period_map, point, _, _ = cut(name, 3)
    arcs, start = period_map.arcs, period_map.arcs.coordinates(point)
    k = next(
        k
        for k, stop in enumerate(arcs.problem.stops)
        if stop.damping > 0 and not stop.may_pull and k not in point.state
    )
    sequence = ContactSequence(point.state, (k, ~k, k))
    assert sequence.joining == (False, False, True)
    assert sequence.returning == (False, False, False)
    rest = 0.1 * arcs.period
    events = [
        arcs.chain(sequence, start, 0.0, np.array([rest, p, r, rest])).events[2] for p, r in ((0, 0), (1e-13, 2e-13))
    ]
    assert events[0] == pytest.approx(events[1], rel=1e-9)


@pytest.mark.thorough
@pytest.mark.parametrize("seeds", few_and_many(range(2, 4), range(4, 16)))
def test_arcs_go_where_an_ode_solver_goes(seeds: range) -> None:
    switches = 0
    for seed in seeds:
        problem = damped_cantilever(np.random.default_rng(seed))
        period_map = analytic.Solver(n_modes=6).period_map(problem)
        point, arcs, joint = period_map.initial(), period_map.arcs, period_map.joint
        q, v = joint.in_modes(point.state, *point.coordinates, 0.0)
        end = 0.8 * period_map.period
        true = witnessed(joint, point.state, q, v, end)
        sequence = ContactSequence(point.state, true.indices)
        durations = np.diff([0.0, *true.times, end])
        there = arcs.chain(sequence, arcs.coordinates(point), 0.0, durations, derivatives=False).end
        found = np.concatenate(joint.in_modes(true.state, *there.reshape(2, -1), end))
        expected = np.concatenate([true.q, true.v])
        assert size(found - expected) <= 1e-7 * size(expected), seed
        switches += len(true.indices)
    assert switches >= 2 * len(seeds)
