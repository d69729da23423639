"""Random initial states of a joint, to look for other motions that it may settle to."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from lapjoint.answers.contact_state import FREE
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.initial import SampledShape
from lapjoint.solver import Solver

POINTS = 65
MODES = 3
SIZE = 3.0
"""Size of the displacement, in gaps."""


def random_initial(problem: Problem, solver: Solver, seed: tuple[int, ...]) -> SampledShape:
    """A random combination of the lowest free modes: some gaps in displacement, omega times that in velocity.

    Parameters
    ----------
    problem : Problem
        The joint, excited at one frequency.
    solver : Solver
        Gives the modes.
    seed : tuple of int
        The same seed gives the same state; none is negative.
    """
    rng = np.random.default_rng(seed)
    x = np.linspace(0.0, problem.beam.length, POINTS)
    shapes = np.asarray(solver.modes(problem, FREE, MODES).shapes(x), dtype=float)
    shapes = shapes / np.max(np.abs(shapes), axis=1, keepdims=True)
    size, omega = SIZE * _gap(problem), problem.excitation_frequency or 1.0
    weights = rng.standard_normal((2, len(shapes))) / math.sqrt(len(shapes))
    displacement, velocity = _held(problem, x, size * np.array([[1.0], [omega]]) * (weights @ shapes))
    return SampledShape(
        x=tuple(x.tolist()), displacement=tuple(displacement.tolist()), velocity=tuple(velocity.tolist())
    )


def _gap(problem: Problem) -> float:
    """A typical gap; where there is none, a thousandth of the length."""
    gaps = [stop.gap for stop in problem.stops if stop.gap > 0]
    return float(np.median(gaps)) if gaps else 1e-3 * problem.beam.length


def _held(problem: Problem, x: FloatArray, values: FloatArray) -> FloatArray:
    """The samples nearest to `values`, shape ``(2, n)``, whose spline meets the fixed supports exactly."""
    rows = np.array(list(_conditions(problem, x)))
    if not rows.size:
        return values
    held: FloatArray = values - values @ rows.T @ np.linalg.pinv(rows @ rows.T) @ rows
    return held


def _conditions(problem: Problem, x: FloatArray) -> Iterator[FloatArray]:
    """For each fixed support, the row that gives the spline's value or slope there from its samples."""
    from scipy.interpolate import CubicSpline

    cardinal = CubicSpline(x, np.eye(x.size))
    for support in problem.supports:
        for derivative, spring in enumerate((support.translational, support.torsional)):
            if math.isinf(spring):
                yield cardinal(support.x, derivative)
