"""The initial state in modal coordinates: which stops are closed at t = 0, and the inner products with the modes.

The initial shape is data, a polynomial or a spline, not a solution of the beam equation, so these inner products
alone are taken by Gauss-Legendre quadrature, on panels short enough for every mode to be resolved to rounding.
"""

from __future__ import annotations

import itertools

import numpy as np

from analytic.march.coordinates import Coordinates
from analytic.march.joint import Joint
from analytic.modes.normal_modes import NormalModes
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.problem import AtRest, FloatArray, Problem, SampledShape

TOUCHING = 1e-9  # of the gap: a closed stop that has just been touched stays closed; rounding is 1e-13 of it
_POINTS_PER_PANEL = 16  # 16 Gauss points resolve half a wave to rounding


def initial_state(problem: Problem) -> ContactState:
    """The stops that are closed at t = 0: beyond the gap, or at it and moving outwards.

    Parameters
    ----------
    problem : Problem
        What is solved.

    Returns
    -------
    ContactState
        The stops that are closed.
    """
    closed = []
    for i, stop in enumerate(problem.stops):
        x = np.array(stop.x)
        depth = stop.sign * float(problem.initial.displacement_at(x)) - stop.gap
        outwards = stop.sign * float(problem.initial.velocity_at(x)) > 0
        if depth > 0 or (depth == 0 and outwards and stop.gap > 0):
            closed.append(i)
    return ContactState(tuple(closed))


def initial_coordinates(problem: Problem, modes: NormalModes) -> tuple[FloatArray, FloatArray]:
    """The initial state in modal coordinates.

    Parameters
    ----------
    problem : Problem
        What is solved.
    modes : NormalModes
        ``N`` modes of the contact state at t = 0.

    Returns
    -------
    FloatArray, shape (N,)
        Modal displacements, kg^1/2 m.
    FloatArray, shape (N,)
        Modal velocities, kg^1/2 m/s.
    """
    count = modes.omega.size
    if isinstance(problem.initial, AtRest):
        return np.zeros(count), np.zeros(count)
    x, weights = _quadrature(problem, modes)
    weighted = problem.beam.m * modes.shapes(x) * weights
    return weighted @ problem.initial.displacement_at(x), weighted @ problem.initial.velocity_at(x)


def _quadrature(problem: Problem, modes: NormalModes) -> tuple[FloatArray, FloatArray]:
    """Positions, m, and weights, m, of the quadrature over the beam, each of shape ``(points,)``."""
    breaks = modes.shapes.nodes
    if isinstance(problem.initial, SampledShape):
        breaks = np.union1d(breaks, np.array(problem.initial.x))
    longest = problem.beam.length / max(modes.omega.size, 1)
    edges = np.concatenate(
        [np.linspace(a, b, int(np.ceil((b - a) / longest)) + 1)[:-1] for a, b in itertools.pairwise(breaks)]
        + [breaks[-1:]]
    )
    nodes, w = np.polynomial.legendre.leggauss(_POINTS_PER_PANEL)
    half = np.diff(edges)[:, None] / 2
    x = (edges[:-1, None] + half) + half * nodes
    return np.minimum(x, problem.beam.length).ravel(), (half * w).ravel()


def started(joint: Joint) -> Coordinates:
    """The coordinates of the initial state.

    Parameters
    ----------
    joint : Joint
        The problem and its modes.

    Returns
    -------
    Coordinates
        In the contact state at t = 0.
    """
    state = initial_state(joint.problem)
    return Coordinates(state, *initial_coordinates(joint.problem, joint.modal(state).modes))


def resumed(joint: Joint, point: SectionPoint) -> Coordinates:
    """The coordinates of a section point found before, whose numbers of modes and gaps may be others than this joint's.

    Modes that the point lacks are at rest; those that it has too many are left out.

    Parameters
    ----------
    joint : Joint
        The problem and its modes.
    point : SectionPoint
        A section point of the analytic solver for a joint with the same stops, but for their gaps.

    Returns
    -------
    Coordinates
        In the contact state that the gaps of this joint imply.
    """
    state, (modes, left_out) = point.state, joint.at_stops(point.state)
    q, v = _fitted(point.coordinates, modes.shape[1])
    z = (modes @ q + left_out).tolist()
    kept, closed = 1 - TOUCHING, state.closed
    pressed = [k for k, (sign, gap) in enumerate(joint.gaps) if sign * z[k] > (gap * kept if k in closed else gap)]
    found = Coordinates(state, q, v)
    return found if pressed == list(closed) else translated(joint, found, ContactState(tuple(pressed)))


def translated(joint: Joint, begin: Coordinates, state: ContactState) -> Coordinates:
    """The same motion, at a multiple of the period, in the modes of another contact state.

    Parameters
    ----------
    joint : Joint
        The problem and its modes.
    begin : Coordinates
        Where the motion is.
    state : ContactState
        The state in whose modes it is wanted.

    Returns
    -------
    Coordinates
        In that state; what its modes cannot hold is left out.
    """
    if state == begin.state:
        return begin
    return Coordinates(state, *carried_over(joint, begin.state, state, begin.q, begin.v))


def carried_over(
    joint: Joint, old: ContactState, new: ContactState, q: FloatArray, v: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Modal coordinates at a multiple of the period, in the modes of another contact state.

    Parameters
    ----------
    joint : Joint
        The problem and its modes.
    old, new : ContactState
        The state in whose modes they are given, and the one in whose modes they are wanted.
    q, v : FloatArray, shape (..., n_old)
        Modal displacements, kg^1/2 m, and velocities, kg^1/2 m/s, of one motion or of many.

    Returns
    -------
    tuple of FloatArray, shape (..., n_new)
        The same motions in the modes of `new`; what these cannot hold is left out.
    """
    passage, theta, omega = joint.passage(old, new), joint.harmonics.theta(0.0), joint.harmonics.omega
    left_out = np.concatenate([[1.0], np.sin(theta)]) @ passage.residual
    moving = (omega * np.cos(theta)) @ passage.residual[1:]
    if q.ndim == 1:  # a product of a matrix and a vector, to the bits that it has always had
        return passage.S @ q + left_out, passage.S @ v + moving
    return q @ passage.S.T + left_out, v @ passage.S.T + moving


def _fitted(values: FloatArray, size: int) -> FloatArray:
    """A copy of `values`, cut or padded with 0 to the shape ``(2, size)``."""
    if values.shape[1] == size:
        return np.array(values, dtype=float)
    result = np.zeros((2, size))
    common = min(size, values.shape[1])
    result[:, :common] = values[:, :common]
    return result
