"""The table of motions of one problem, made from the motions that its chunks found, and their branches.

Chunks find motions independently, so several chunks may find one motion.  Two motions are one if their orbits are.
Where modes are truncated, the map jumps as two switches change their order, and one motion of the joint becomes several
orbits that are hardly apart (`lapjoint.orbits.least_period`).  The table has these orbits as one motion.

Motions of neighbouring problems belong to one branch if Newton's method leads from each to the other, and both mirror
themselves or neither does: where a symmetry breaks, other branches begin.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lapjoint.campaigns.basins.solve import UNBOUND, ChunkEnds, motion_from, prepared
from lapjoint.campaigns.basins.spec import BasinPlan
from lapjoint.campaigns.batch import solver_of
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.certified import CertifiedMotion, mirrored_motion, same_motion
from lapjoint.orbits.compiled_intervals import IndexArray
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.least_period import PARTED, switch_order
from lapjoint.orbits.newton import FAR, find_orbit
from lapjoint.problem import FloatArray

NORMAL_95 = 1.959963984540054
"""Quantile of the normal distribution that leaves 2.5 % above it."""


@dataclass(frozen=True)
class MotionTable:
    """The ``M`` motions of one problem with ``P`` stops, and the motion to which each of ``N`` starts is bound."""

    motions: tuple[CertifiedMotion, ...]
    """The motions, in descending order of their number of starts."""
    motion: IndexArray
    """Index of the motion of each start, or `UNBOUND`, shape ``(N,)``."""
    outcome: IndexArray
    """Number of the outcome of each start, shape ``(N,)``."""
    periods: IndexArray
    """Periods marched from each start, shape ``(N,)``."""
    pushed: np.ndarray
    """Whether each march was pushed off an unstable motion, shape ``(N,)``."""
    messages: dict[int, str]
    """Reasons for which marches could not go on, by the number of the start."""
    twin: IndexArray
    """Index of the mirror image of each motion, or `UNBOUND`, shape ``(M,)``."""
    orbits: IndexArray
    """Number of orbits into which truncation splits each motion, shape ``(M,)``; 1 where it does not."""
    errors: FloatArray
    """Estimated numerical error of each motion's impulses, N s, shape ``(M, P)``."""

    @property
    def counts(self) -> IndexArray:
        """Number of starts that are bound to each motion, shape ``(M,)``."""
        return np.bincount(self.motion[self.motion >= 0], minlength=len(self.motions))


def table_of(plan: BasinPlan, value: int, scouts: ChunkEnds, chunks: Sequence[ChunkEnds]) -> MotionTable:
    """The motions of one problem, and where each start ends.

    The motions of `scouts` are the library; `chunks` are all other chunks, in the order of their starts.
    """
    half_periods = HalfPeriods(prepared(plan, value).period_map)
    library = [motion_from(plain) for plain in scouts.motions]
    motions, numbers, pushed = list(library), list[int](), list[int]()
    messages: dict[int, str] = {}
    for chunk in chunks:
        index = list(range(len(library)))
        for plain in chunk.motions:
            index.append(_known(half_periods, motions, motion_from(plain)))
        numbers += [UNBOUND if i < 0 else index[i] for i in chunk.motion]
        first = len(numbers) - len(chunk.motion)
        messages |= {first + failure.start: failure.reason for failure in chunk.messages}
        pushed += [first + i for i in chunk.pushed]
    motions, orbits, motion = _ordered(half_periods, motions, np.array(numbers, dtype=np.intp))
    was_pushed = np.zeros(motion.size, dtype=np.bool_)
    was_pushed[pushed] = True
    return MotionTable(
        motions=tuple(motions),
        motion=motion,
        outcome=np.array([code for chunk in chunks for code in chunk.outcome], dtype=np.intp),
        periods=np.array([count for chunk in chunks for count in chunk.periods], dtype=np.intp),
        pushed=was_pushed,
        messages=messages,
        twin=_twins(half_periods, motions),
        orbits=orbits,
        errors=_errors(plan, value, motions),
    )


def _known(half_periods: HalfPeriods, motions: list[CertifiedMotion], motion: CertifiedMotion) -> int:
    """The index of a motion in the list; the motion is added if it is not there."""
    for i, known in enumerate(motions):
        if same_motion(half_periods, motion, known):
            return i
    motions.append(motion)
    return len(motions) - 1


def _ordered(
    half_periods: HalfPeriods, motions: Sequence[CertifiedMotion], motion: IndexArray
) -> tuple[list[CertifiedMotion], IndexArray, IndexArray]:
    """Motions in descending order of their number of starts, the number of orbits of each, and the index of each
    start's motion.

    Of several orbits that are one motion, the orbit with most starts represents the motion.
    """
    order = np.argsort(-np.bincount(motion[motion >= 0], minlength=len(motions)), kind="stable")
    kept: list[CertifiedMotion] = []
    place = np.full(len(motions), UNBOUND, dtype=np.intp)
    for i in order.tolist():
        same = next((j for j, other in enumerate(kept) if _parted(half_periods, other, motions[i])), None)
        place[i] = len(kept) if same is None else same
        kept += [motions[i]] * (same is None)
    motion = np.where(motion < 0, UNBOUND, place[motion]) if motions else motion
    again = np.argsort(-np.bincount(motion[motion >= 0], minlength=len(kept)), kind="stable")
    back = np.argsort(again)
    orbits = np.bincount(place, minlength=len(kept))[again]
    return [kept[i] for i in again], orbits, np.where(motion < 0, UNBOUND, back[motion]) if kept else motion


def _parted(half_periods: HalfPeriods, one: CertifiedMotion, other: CertifiedMotion) -> bool:
    """Whether two orbits are parts of one motion: hardly apart, with the same stops that switch, but in another order.

    With the same order they are two motions: the map does not jump between them, and both exist.
    """
    if one.period_multiple != other.period_multiple:
        return False
    near = (point for point in other.points if half_periods.apart(point, one.points[0]) <= PARTED)
    point = next(near, None)
    if point is None:
        return False
    count = 2 * one.period_multiple
    orders = [switch_order(half_periods.linearised(at, count)) for at in (one.points[0], point)]
    return orders[0] != orders[1] and sorted(orders[0]) == sorted(orders[1])


def _twins(half_periods: HalfPeriods, motions: Sequence[CertifiedMotion]) -> IndexArray:
    """The index of each motion's mirror image, or `UNBOUND`."""
    twins = np.full(len(motions), UNBOUND, dtype=np.intp)
    for i, motion in enumerate(motions):
        image = mirrored_motion(half_periods, motion)
        if image is not None:
            there = (j for j, other in enumerate(motions) if same_motion(half_periods, image, other))
            twins[i] = next(there, UNBOUND)
    return twins


def _errors(plan: BasinPlan, value: int, motions: Sequence[CertifiedMotion]) -> FloatArray:
    """Errors of the impulses, N s, from the solver's own refinement; infinite where it states none."""
    problem, solver = plan.problem_at(value), solver_of(plan)
    errors = np.full((len(motions), len(problem.stops)), math.inf)
    for i, motion in enumerate(motions):
        try:
            found = solver.steady_state(problem, start=motion.points[0], sensitivity=False)
        except SolverError:
            continue
        if found.period_multiple == motion.period_multiple and found.impulse_errors is not None:
            errors[i] = found.impulse_errors
    return errors


def wilson(count: int, total: int) -> tuple[float, float]:
    """The ends of the Wilson interval at 95 % of the share `count` of `total`, from 0 to 1."""
    z2 = NORMAL_95**2
    share = count / total
    middle = (share + z2 / (2 * total)) / (1 + z2 / total)
    half = NORMAL_95 / (1 + z2 / total) * math.sqrt(share * (1 - share) / total + z2 / (4 * total**2))
    low, high = max(0.0, middle - half), min(1.0, middle + half)
    return (0.0 if count == 0 else low), (1.0 if count == total else high)


def branches_of(plan: BasinPlan, tables: Sequence[MotionTable]) -> list[IndexArray]:
    """The branch of each motion of each problem, shape (M,), along the values of `over`.

    Branches are numbered from 0 in the order in which they are met.
    """
    assert plan.over is not None
    branches = [np.full(len(table.motions), UNBOUND, dtype=np.intp) for table in tables]
    maps = [HalfPeriods(prepared(plan, value).period_map) for value in range(plan.values)]
    ascending, used = np.argsort(plan.over.values, kind="stable").tolist(), 0
    for at, value in enumerate(ascending):
        if at:
            before = ascending[at - 1]
            for i, j in _followed(maps[before], tables[before].motions, maps[value], tables[value].motions):
                branches[value][j] = branches[before][i]
        for j in np.flatnonzero(branches[value] == UNBOUND).tolist():
            branches[value][j] = used
            used += 1
    return branches


def _followed(
    here: HalfPeriods, ours: Sequence[CertifiedMotion], there: HalfPeriods, theirs: Sequence[CertifiedMotion]
) -> list[tuple[int, int]]:
    """Pairs of motions of neighbouring problems for which Newton's method leads from each to the other."""
    pairs = []
    for i, motion in enumerate(ours):
        j = _led_to(motion, there, theirs)
        if j is not None and _led_to(theirs[j], here, ours) == i:
            pairs.append((i, j))
    return pairs


def _led_to(motion: CertifiedMotion, there: HalfPeriods, theirs: Sequence[CertifiedMotion]) -> int | None:
    """The index of the motion of another problem to which Newton's method leads from a motion; None if it leads to
    none."""
    try:
        point = there.map.adopted(motion.points[0])
    except InputError:
        return None
    orbit = find_orbit(there, point, 2 * motion.period_multiple, FAR)
    if orbit is None:
        return None
    at = replace(motion, points=(orbit.point,) * motion.period_multiple, residual=orbit.residual)
    alike = (
        j for j, other in enumerate(theirs) if other.symmetric == motion.symmetric and same_motion(there, at, other)
    )
    return next(alike, None)
