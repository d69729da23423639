"""Quadrature over the beam, for the one function that is no solution of the beam equation: the initial shape."""

from __future__ import annotations

import itertools

import numpy as np

from analytic.modes.normal_modes import NormalModes
from lapjoint.problem import FloatArray, Problem, SampledShape

_POINTS_PER_PANEL = 16  # Gauss points that resolve half a wave to rounding


def over_beam(problem: Problem, modes: NormalModes) -> tuple[FloatArray, FloatArray]:
    """Positions and weights, m, ``(points,)`` each, of Gauss-Legendre quadrature that resolves every mode to rounding.

    The knots of a sampled initial shape are edges of the panels.
    """
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
