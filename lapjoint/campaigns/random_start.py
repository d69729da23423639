"""Random initial states of a joint, from which a sweep looks for coexisting motions."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from lapjoint.answers.contact_state import FREE
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.initial import BeamsStart, SampledShape
from lapjoint.problem.placing import sampled_start
from lapjoint.solver import Solver

POINTS = 65
"""Number of samples of an initial state along the beam: at least sixteen for each half-wave of the `MODES` modes."""
MODES = 3
"""Number of free modes that are combined, from the lowest."""
SIZE = 3.0
"""Size of the displacement, divided by the gap: large enough for most of the states to reach the stops soon."""


def random_initial(problem: Problem, solver: Solver, seed: tuple[int, ...]) -> SampledShape | BeamsStart:
    """A random combination of the lowest free modes, which satisfies the fixed supports.

    Displacements are `SIZE` gaps in size, and velocities are this size times the excitation frequency.  The solver
    gives the modes.  Equal seeds, which are not negative, give equal states.
    """
    rng = np.random.default_rng(seed)
    x = problem.line.grid(POINTS)
    shapes = np.asarray(solver.modes(problem, FREE, MODES).shapes(x), dtype=float)
    shapes = shapes / np.max(np.abs(shapes), axis=1, keepdims=True)
    size, omega = SIZE * _gap(problem), problem.excitation_frequency or 1.0
    weights = rng.standard_normal((2, len(shapes))) / math.sqrt(len(shapes))
    displacement, velocity = _meeting_supports(problem, x, size * np.array([[1.0], [omega]]) * (weights @ shapes))
    return sampled_start(problem.line, x, displacement, velocity)


def _gap(problem: Problem) -> float:
    """The median size of the gaps and interferences, m; a thousandth of the length where there is none."""
    gaps = [abs(stop.gap) for stop in problem.stops if stop.gap]
    return float(np.median(gaps)) if gaps else 1e-3 * problem.line.beams[0].length


def _meeting_supports(problem: Problem, x: FloatArray, values: FloatArray) -> FloatArray:
    """The samples nearest to `values`, shape ``(2, n)``, whose splines satisfy the fixed supports exactly."""
    rows = np.array(list(_conditions(problem, x)))
    if not rows.size:
        return values
    nearest: FloatArray = values - values @ rows.T @ np.linalg.pinv(rows @ rows.T) @ rows
    return nearest


def _conditions(problem: Problem, x: FloatArray) -> Iterator[FloatArray]:
    """Rows of shape ``(n,)`` that give the spline's value or slope at a fixed support from its ``n`` samples."""
    from scipy.interpolate import CubicSpline

    line, beams = problem.line, range(len(problem.line.beams))
    cardinal = [CubicSpline(x[line.own(x, j)], np.eye(x.size)[line.own(x, j)]) for j in beams]
    for support in problem.structure.supports:
        for derivative, spring in enumerate((support.translational, support.torsional)):
            if math.isinf(spring):
                yield cardinal[line.beam_at(support.x)](support.x, derivative)
