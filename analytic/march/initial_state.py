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
    """The stops that are closed at t = 0: beyond the gap, or at it and moving outwards."""
    closed = []
    for i, stop in enumerate(problem.stops):
        x = np.array(stop.x)
        depth = stop.sign * float(problem.initial.displacement_at(x)) - stop.gap
        outwards = stop.sign * float(problem.initial.velocity_at(x)) > 0
        if depth > 0 or (depth == 0 and outwards and stop.gap > 0):
            closed.append(i)
    return ContactState(tuple(closed))


def initial_coordinates(problem: Problem, modes: NormalModes) -> tuple[FloatArray, FloatArray]:
    """Modal displacements, kg^1/2 m, and velocities, kg^1/2 m/s, at t = 0, each of shape ``(N,)``."""
    count = modes.omega.size
    if isinstance(problem.initial, AtRest):
        return np.zeros(count), np.zeros(count)
    x, weights = _quadrature(problem, modes)
    weighted = problem.beam.m * modes.shapes(x) * weights
    return weighted @ problem.initial.displacement_at(x), weighted @ problem.initial.velocity_at(x)


def _quadrature(problem: Problem, modes: NormalModes) -> tuple[FloatArray, FloatArray]:
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
    """The coordinates of the initial state."""
    state = initial_state(joint.problem)
    return Coordinates(state, *initial_coordinates(joint.problem, joint.modal(state).modes))


def resumed(joint: Joint, section: SectionPoint) -> Coordinates:
    """The coordinates of a section found before, in this joint: its numbers of modes and its gaps may be others.

    Modes that the section lacks are at rest; those that it has too many are left out.
    """
    modal = joint.modal(section.state)
    q, v = (_fitted(part, modal.size) for part in section.coordinates)
    theta = joint.harmonics.theta(0.0)
    loads = np.concatenate([[1.0], np.sin(theta)])
    z = modal.at_stops @ q + loads @ (modal.residual_at_stops * joint.sizes[:, None])
    closed = ContactState(
        tuple(
            k
            for k, stop in enumerate(joint.problem.stops)
            if stop.sign * z[k] > stop.gap or (k in section.state and stop.sign * z[k] > stop.gap * (1 - TOUCHING))
        )
    )
    return translated(joint, Coordinates(section.state, q, v), closed)


def translated(joint: Joint, begin: Coordinates, state: ContactState) -> Coordinates:
    """The same motion at a multiple of the period in the modes of another contact state."""
    if state == begin.state:
        return begin
    passage, theta, omega = joint.passage(begin.state, state), joint.harmonics.theta(0.0), joint.harmonics.omega
    return Coordinates(
        state,
        passage.S @ begin.q + np.concatenate([[1.0], np.sin(theta)]) @ passage.residual,
        passage.S @ begin.v + (omega * np.cos(theta)) @ passage.residual[1:],
    )


def _fitted(values: FloatArray, size: int) -> FloatArray:
    result = np.zeros(size)
    common = min(size, values.size)
    result[:common] = values[:common]
    return result
