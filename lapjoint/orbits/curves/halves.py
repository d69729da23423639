"""Motions that repeat in half of their time, and those that spring from them: flips and broken symmetries.

A motion of twice as many half periods springs where a multiplier passes -1.  The motion differs from the one that it
springs from by the multiplier's vector in its first half, and by the opposite in its second.  Where the branch of the
new motion meets that of the old one again, this difference passes zero.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from lapjoint.orbits.arcs import ContactSequence
from lapjoint.orbits.curves.bifurcations import Stretch, beside
from lapjoint.orbits.curves.boundary_problem import BoundaryProblem
from lapjoint.orbits.curves.newton import solve
from lapjoint.orbits.curves.point import CurvePoint, scale_of
from lapjoint.problem import FloatArray
from lapjoint.problem.symmetry import mirror_twins

_AWAY = (1e-2, 1e-3, 1e-4)
"""Arclengths from a bifurcation at which a motion of the branch that springs there is looked for, in turn: the first is
found unless the branch is narrower."""
_MEETS = 1e-3
"""Difference of both halves, over that at the start of a step, up to which it counts as zero."""


def springing(point: CurvePoint) -> CurvePoint | None:
    """A motion of the branch that springs from a motion with a multiplier of -1.

    Parameters
    ----------
    point : CurvePoint
        The motion at the bifurcation.

    Returns
    -------
    CurvePoint, or None
        Its tangent leads away from the bifurcation; None if Newton's method finds none.
    """
    problem, u, way = _doubled(point)
    scale = scale_of(problem, u)
    row = way / scale
    row /= np.linalg.norm(row)
    for length in _AWAY:
        found = solve(problem, u + length * scale * row, scale, row)
        if found is not None:
            new = CurvePoint.of(problem, found, scale)
            return new if float(new.tangent @ (row * scale / new.scale)) > 0 else new.turned()
    return None


def _doubled(point: CurvePoint) -> tuple[BoundaryProblem, FloatArray, FloatArray]:
    """The same motion twice, and the direction in which one of twice the length differs from it."""
    problem, n, M = point.problem, point.coordinates, point.problem.events
    twins = mirror_twins(problem.arcs(point.u).problem) if problem.half_periods % 2 else None
    stops = problem.sequence.stops
    image = tuple(twins[k] for k in stops) if twins is not None else stops
    shares = point.shares
    J = point.linearisation.jacobian
    vector = np.linalg.svd(point.linearisation.monodromy + np.eye(n))[2][-1]
    moved = -np.linalg.solve(J[n:, n:-1], J[n:, :n] @ vector) if M else np.zeros(0)
    if M:
        last = -float(moved.sum())
        shares = np.concatenate([shares[:-1], [shares[-1] + shares[0]], shares[1:-1]]) / 2
        moved = np.concatenate([moved, [last - moved[0]], -moved[1:]]) / 2
    else:
        shares = np.zeros(0)
    doubled = replace(
        problem,
        sequence=ContactSequence(problem.sequence.first, (*stops, *image)),
        half_periods=2 * problem.half_periods,
    )
    u = np.concatenate([point.u[:n], shares, point.u[-1:]])
    return doubled, u, np.concatenate([vector, moved, [0.0]])


def half_difference(point: CurvePoint) -> FloatArray | None:
    """By how much a motion misses to repeat in half of its time, in scaled coordinates of the section.

    Parameters
    ----------
    point : CurvePoint
        The motion.

    Returns
    -------
    FloatArray, shape (n,), or None
        None if the contact sequences of both halves differ, or half the time is no period of the problem.
    """
    problem, M = point.problem, point.problem.events
    half, odd = problem.half_periods // 2, problem.half_periods % 2
    twins = mirror_twins(problem.arcs(point.u).problem) if half % 2 else None
    if odd or M % 2 or (half % 2 and twins is None):
        return None
    stops, states = problem.sequence.stops, problem.sequence.states
    image = tuple(twins[k] for k in stops[: M // 2]) if twins is not None else stops[: M // 2]
    expected = {twins[k] for k in states[0].closed} if twins is not None else set(states[0].closed)
    if stops[M // 2 :] != image or set(states[M // 2].closed) != expected:
        return None
    arcs, chain = problem.arcs(point.u), point.linearisation.chain
    time, began = problem.time(point.u) + problem.length(point.u) / 2, float(chain.times[M // 2])
    there = arcs.later(states[M // 2], chain.starts[M // 2], began, time - began)
    n = point.coordinates
    return np.asarray(((-there if twins is not None else there) - point.u[:n]) / point.scale[:n])


@dataclass(frozen=True)
class Meeting:
    """Where a branch meets that of motions which repeat in half of the time."""

    point: CurvePoint
    """The motion, as one of the branch that ends there."""

    def halved(self) -> tuple[BoundaryProblem, FloatArray]:
        """The motion over half of its time.

        Returns
        -------
        BoundaryProblem, FloatArray
            Its equations, and the unknowns.
        """
        problem, u, M = self.point.problem, self.point.u, self.point.problem.events
        n, shares = self.point.coordinates, 2 * self.point.shares[: M // 2]
        sequence = ContactSequence(problem.sequence.first, problem.sequence.stops[: M // 2])
        halved = replace(problem, sequence=sequence, half_periods=problem.half_periods // 2)
        return halved, np.concatenate([u[:n], shares, u[-1:]])


def meeting(stretch: Stretch) -> Meeting | None:
    """Where in a step a motion comes to repeat in half of its time.

    Parameters
    ----------
    stretch : Stretch
        The step.

    Returns
    -------
    Meeting, or None
        None if it does not.
    """
    first, last = half_difference(stretch.start), half_difference(stretch.end)
    if first is None or last is None or not float(first @ last) < 0:
        return None
    size, known, products = float(np.linalg.norm(first)), dict[float, CurvePoint](), dict[float, float]()

    def along(s: float) -> float:
        point = beside(stretch.start, s)
        missed = None if point is None else half_difference(point)
        if point is None or missed is None:
            raise ValueError
        known[s], products[s] = point, float(missed @ first) / size**2
        return products[s]

    try:
        at = brentq(along, 0.0, stretch.length, xtol=1e-10, rtol=1e-9)
    except ValueError:  # Newton's method is lost where both branches meet; nearby it is not
        at = min(known, key=lambda s: abs(products[s]), default=None)
    if at is None or at not in known:
        return None
    missed = half_difference(known[at])
    if missed is None or float(np.linalg.norm(missed)) > _MEETS * max(size, float(np.linalg.norm(last))):
        return None
    return Meeting(known[at])
