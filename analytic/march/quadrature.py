"""Inner products of modes with the one function that is no solution of the beam equation, the initial shape."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np

from analytic.modes.normal_modes import NormalModes
from lapjoint.answers.equilibrium import breaks_of
from lapjoint.problem import AtEquilibrium, FloatArray, Problem, SampledShape

_POINTS_PER_PANEL = 16  # Gauss points that resolve half a wave to rounding


def over_beam(problem: Problem, modes: NormalModes) -> tuple[FloatArray, FloatArray]:
    """Positions and weights, m, ``(points,)`` each, of Gauss-Legendre quadrature that resolves every mode to rounding.

    The knots of a sampled initial shape, and of a static equilibrium, are edges of the panels.
    """
    breaks = modes.shapes.nodes
    if isinstance(problem.initial, SampledShape):
        breaks = np.union1d(breaks, np.array(problem.initial.x))
    if isinstance(problem.initial, AtEquilibrium):
        breaks = np.union1d(breaks, np.array(breaks_of(problem)))
    fastest = np.abs(modes.shapes.mu).max(axis=(0, 2))[np.searchsorted(modes.shapes.nodes, breaks[1:]) - 1]
    panels = np.ceil(np.diff(breaks) * fastest / math.pi).astype(int) + 1
    edges = np.concatenate(
        [np.linspace(a, b, n + 1)[:-1] for (a, b), n in zip(itertools.pairwise(breaks), panels.tolist(), strict=True)]
        + [breaks[-1:]]
    )
    nodes, w = np.polynomial.legendre.leggauss(_POINTS_PER_PANEL)
    half = np.diff(edges)[:, None] / 2
    x = (edges[:-1, None] + half) + half * nodes
    return np.minimum(x, problem.line.length).ravel(), (half * w).ravel()


def mass_weighted(
    problem: Problem, modes: NormalModes, shape: Callable[..., FloatArray]
) -> list[tuple[FloatArray, FloatArray]]:
    """Pairs of arrays whose products, summed up, are the inner products of modes with `shape`, weighted with the mass.

    The first of each pair has a mode in each row, kg^1/2, ``(N, points)``; the second has `shape` or its slope.
    """
    x, weights = over_beam(problem, modes)
    parts = [(problem.line.inertia_at(x) * modes.shapes(x) * weights, shape(x))]
    for mass in problem.structure.masses:
        at = np.array([mass.x])
        for derivative, lumped in enumerate((mass.mass, mass.rotary_inertia)):
            if lumped:
                parts.append((lumped * modes.shapes(at, derivative), shape(at, derivative)))
    return parts


def projected(problem: Problem, modes: NormalModes, shape: Callable[..., FloatArray]) -> FloatArray:
    """Inner products of modes with `shape`, weighted with the mass, kg^1/2 times its unit, shape ``(N,)``."""
    parts = [weighted @ values for weighted, values in mass_weighted(problem, modes, shape)]
    return np.asarray(np.sum(parts, axis=0))
