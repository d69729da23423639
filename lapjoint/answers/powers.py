"""The power that the excitation gives to the beams.

Relative to the base, the excitation is the inertia of the beams, static loads and point loads, and what a moving base
does through stops that are fixed in space.  In a steady state its mean is what stops and damping take.
"""

from __future__ import annotations

import numpy as np

from lapjoint.answers.dissipation import NODES, WEIGHTS
from lapjoint.answers.history import History
from lapjoint.problem import FloatArray
from lapjoint.problem.load_shape import LoadShape

_PANELS = 4
"""Least number of panels along the line of beams: eight nodes in each integrate twelve modes to 1e-7."""


def input_power(history: History, t: FloatArray) -> FloatArray:
    """The power of the excitation at times, s, within the motion, W, both shape ``(m,)``."""
    total = np.zeros(t.size)
    velocities: dict[LoadShape, FloatArray] = {}
    for force in history.problem.forces.every:
        if force.shape not in velocities:
            x, weight = _quadrature(force.shape, history.problem.line.length / _PANELS)
            velocities[force.shape] = weight @ history.field(x, t, 0, 1) if x.size else np.zeros(t.size)
        total += force.at(t) * velocities[force.shape]
    if any(stop.base_share for stop in history.problem.structure.stops):
        total -= np.einsum("sm,sm->m", history.contact_force(t), history.base_of_stops(t, 1))
    return total


def _quadrature(shape: LoadShape, longest: float) -> tuple[FloatArray, FloatArray]:
    """Places, m, and the force or the integral of the force at each, for a load of size 1: ``(n,)`` each."""
    x, weight = [place for place, _ in shape.points], [force for _, force in shape.points]
    for start, end, force in shape.pieces:
        edges = np.linspace(start, end, max(1, int(np.ceil((end - start) / longest))) + 1)
        half = np.diff(edges)[:, None] / 2
        x += (edges[:-1, None] + half * (1 + NODES)).ravel().tolist()
        weight += (force * half * WEIGHTS).ravel().tolist()
    return np.array(x), np.array(weight)
