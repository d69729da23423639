"""When a motion by the published scheme counts as settled, and the certificate that says so.

The paper runs each motion "through steady state"; one that "appears transient after many thousands of impacts" is
called aperiodic, and its next 1000 cycles are taken.  The text does not say when a motion has settled.

Here the penetration times of all stops (the impulses divided by the stiffnesses) and the displacements at the stops at
the end of the cycle are compared with the values p cycles before, for p = 1, 2, ... `max_period_multiple`.  A motion
has settled when, for one p, they agree to `tolerance` cycle by cycle for `REPEATS` repeats, and the last repeat also
agrees with the first.  Otherwise, after `patience` impacts or `max_periods` cycles, the next 1000 cycles are averaged
and the motion is UNDECIDED.

Newton's method is not used: a frozen shape that stops growing may take any value, so fixed points fill a continuum, and
only the march tells which fixed point a motion from rest approaches.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from analytic.march.march import MOST_SWITCHES, settle_status
from analytic.march.motion import PERIODS, SWITCHES, new_log, new_work
from analytic.published.field import history_of
from analytic.published.initial_state import packed, started
from analytic.published.joint import FrozenMotion, PublishedJoint
from analytic.published.march import PublishedMarch, march_published, restarted
from analytic.published.settle import SETTLED, UNSETTLED, settle
from lapjoint.answers import History
from lapjoint.answers.steady_state import Outcome, SectionPoint, SteadyState, impulses_per_period, periodic_outcome
from lapjoint.problem import FloatArray, Problem
from lapjoint.solver import Progress

REPEATS = 20  # repeats after which a motion has settled: each repeats the one before, the last also the first
_CYCLES_AVERAGED = 1000  # cycles of an unsettled motion whose impulses are averaged, as in the paper
_CHUNK = 500  # cycles after which the number of impacts is compared with `patience`
_SYMMETRIC = 1e-4  # largest distance of a symmetric motion from its mirror image, relative to the largest displacement
_SAMPLES = 64  # times in half a motion at which it is compared with its mirror image


@dataclass(frozen=True)
class Patience:
    """How long to wait for a motion to settle."""

    tolerance: float
    """Relative deviation within which impulses and displacements must repeat."""
    max_period_multiple: int
    """Longest periodic motion looked for, in excitation periods."""
    max_periods: int
    """Excitation periods after which a motion is given up."""
    patience: int
    """Impacts after which a motion is given up."""
    shortest: float
    """Least time spent in a state, s."""


@dataclass(frozen=True)
class Settling:
    """A motion marched cycle by cycle."""

    period_multiple: int
    """Number of excitation periods after which the motion repeats; 0 if it did not settle."""
    rows: FloatArray
    """Penetration times of stops over each cycle, m s, and displacements at its end, m, shape ``(cycles, P + U)``."""
    motion: FrozenMotion
    """The motion at the end of the last cycle."""


def settling(
    joint: PublishedJoint, motion: FrozenMotion, period: float, patience: Patience, progress: Progress | None = None
) -> Settling:
    """March until the motion has settled, or for as long as `patience` allows; `motion` is advanced in place.

    `period` is the excitation period, s.  `progress` is called with the periods marched, and the most allowed.
    """
    P, most = joint.stops, patience.max_periods
    rows = np.zeros((most + _CYCLES_AVERAGED, P + joint.tables.constant.shape[1]))
    agree, log = np.zeros(patience.max_period_multiple, dtype=np.int64), new_log(0, 1, P)
    restarted(motion)
    limit, last, moving, work = min(_CHUNK, most), False, motion.moving, new_work(joint.tables)
    while True:
        status, multiple = settle(
            joint.tables,
            joint.frozen(motion),
            moving,
            work,
            False,
            period,
            log,
            rows[:limit],
            agree,
            REPEATS,
            patience.tolerance,
            patience.shortest,
            MOST_SWITCHES,
        )
        if status not in (SETTLED, UNSETTLED):
            settle_status(joint, moving, status, MOST_SWITCHES)
            continue
        if progress is not None:
            progress(min(limit, most), most)
        cycles, impacts = int(moving.counts[PERIODS]), int(moving.counts[SWITCHES]) // 2
        if status == SETTLED or last:
            return Settling(multiple, rows[:cycles], motion)
        last = limit >= most or impacts >= patience.patience
        limit = cycles + _CYCLES_AVERAGED if last else min(limit + _CHUNK, most)


def steady_state(
    problem: Problem,
    name: str,
    counts: tuple[int, int],
    patience: Patience,
    start: SectionPoint | None,
    progress: Progress | None,
) -> SteadyState:
    """The motion that remains, from `start` or from the initial state, with the impulses of the stops, N s a period.

    `counts` are the numbers of modes in the free state and in every other.  `progress` is called with the periods
    marched, and the most allowed.
    """
    assert problem.excitation_frequency is not None
    period, joint = 2 * math.pi / problem.excitation_frequency, PublishedJoint(problem, *counts)
    found = settling(joint, started(joint, start), period, patience, progress)
    point, multiple = packed(joint, found.motion), found.period_multiple
    periods = multiple or patience.max_period_multiple
    motion = march_published(joint, started(joint, point), periods * period, shortest=patience.shortest)
    history = history_of(name, motion)
    if multiple:
        impulses, outcome = impulses_per_period(history, multiple), periodic_outcome(history)
    else:
        impulses, outcome = _mean_impulses(problem, found.rows), Outcome.UNDECIDED
    return SteadyState(
        problem=problem,
        solver=name,
        outcome=outcome,
        period_multiple=multiple,
        symmetric=multiple % 2 == 1 and is_symmetric(history),
        residual=_residual(motion, periods * period),
        multipliers=np.zeros(0, dtype=complex),
        exponent=None,
        section_point=point,
        history=history,
        impulses=impulses,
    )


def _mean_impulses(problem: Problem, rows: FloatArray) -> FloatArray:
    """Mean impulse of each stop over the last `_CYCLES_AVERAGED` cycles, N s, shape ``(P,)``."""
    stiffness = np.array([stop.sign * stop.stiffness for stop in problem.structure.stops])
    return np.asarray(stiffness * rows[-_CYCLES_AVERAGED:, : stiffness.size].mean(axis=0))


def is_symmetric(history: History) -> bool:
    """Whether z(x, t + T/2) = -z(x, t) at the stops, to `_SYMMETRIC`, in a motion of the length T."""
    half = (history.end - history.start) / 2
    t = history.start + half * np.arange(_SAMPLES) / _SAMPLES
    x = np.array(sorted({stop.x for stop in history.problem.structure.stops} or {history.problem.line.length}))
    z, later = history.displacement(x, t), history.displacement(x, t + half)
    return bool(np.abs(z + later).max() <= _SYMMETRIC * np.abs(z).max())


def _residual(motion: PublishedMarch, period: float) -> float:
    """Distance of the coordinates at the end from the start, divided by their size; infinite if the states differ."""
    first, end = motion.segments[0], motion.end
    if first.state != end.state:
        return math.inf
    scale = period / (2 * math.pi)
    size = float(np.linalg.norm(first.q) + scale * np.linalg.norm(first.v))
    apart = float(np.linalg.norm(end.q - first.q) + scale * np.linalg.norm(end.v - first.v))
    return apart / (size + 1e-300)
