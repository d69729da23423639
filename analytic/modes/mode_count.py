r"""How many modes are enough: a criterion, evaluated for the problem at hand.

With the residual of `analytic.modes.static_residual` the modes i > N follow the loads quasi-statically.  What remains
in error is their inertia: relative to the force of a closed stop,

    e_N = k sum_{i > N} Phi_i(x_stop)^2 / omega_i^2 . (omega_c / omega_N)^2

The first factor is the share of the left-out modes in the compliance that the stop feels, the second the inertia
neglected at the fastest frequency omega_c that drives the contact: the excitation, or the lowest elastic frequency
with every stop closed that can be.  Measured on the paper's joint from 515 to 5000 rad/s with 14 to 40 modes, the
steady impulses change by 0.1 to 3 e_N when the number of modes is raised further (tests/analytic/test_steady_state.py).

A step load excites every mode at once, and inertia does not help: the share of the left-out modes in the
compliance at the load, sum_{i > N} Phi_i^2 / omega_i^2 over the sum of all, has to be small by itself.

An initial shape that is not straight and still also asks that the modes hold all but a thousandth of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from analytic.march.initial_state import initial_coordinates
from analytic.march.loads import harmonics_of
from analytic.march.modal_state import Family, family_of
from analytic.modes.normal_modes import NormalModes, exact_modes
from lapjoint.answers.contact_state import FREE, contact_states
from lapjoint.problem import AtRest, FloatArray, Problem, StepLoad

LEAST, MOST = 10, 320
"""Least and most number of modes that the criterion chooses; beyond the most, the error may exceed the tolerance."""
_SHAPE_REMAINDER = 1e-3
"""Largest share of an initial shape, in the norm of its coordinates, that the modes may leave out."""


def default_count(problem: Problem, tolerance: float) -> int:
    """The least number of modes for which e_N is small enough, in the free state and in the one with most stops closed.

    Parameters
    ----------
    problem : Problem
        What is solved.
    tolerance : float
        The largest e_N allowed, without unit.

    Returns
    -------
    int
        From `LEAST` to `MOST`.
    """
    pool = 40
    while True:
        enough = _enough(problem, tolerance, pool)
        if 2 * enough <= pool or pool >= 2 * MOST:
            return min(enough, MOST)
        pool *= 2


def truncation_error(problem: Problem, pool: int) -> FloatArray:
    """e_N of every N below a number of modes at which its sums are cut; of the two states the larger.

    Parameters
    ----------
    problem : Problem
        What is solved.
    pool : int
        Number of modes at which the sums are cut.

    Returns
    -------
    FloatArray, shape (pool - 1,)
        e_N for N = 1 ... pool - 1, without unit.
    """
    parts = _parts(family_of(problem), pool)
    fastest = max([parts.elastic, *harmonics_of(problem).omega])
    return np.asarray(np.maximum(parts.inert * fastest**2, parts.steps))


@dataclass(frozen=True)
class _Parts:
    """What the criterion needs apart from the excitation."""

    elastic: float
    """The lowest elastic frequency with every stop closed that can be, rad/s."""
    inert: FloatArray
    """e_N over the square of the fastest frequency, s^2, shape ``(pool - 1,)``."""
    steps: FloatArray
    """The error of step loads, shape ``(pool - 1,)``."""


@lru_cache(maxsize=32)
def _parts(family: Family, pool: int) -> _Parts:
    problem = family.problem
    both = [exact_modes(problem, state, pool) for state in dict.fromkeys((FREE, contact_states(problem)[-1]))]
    elastic = both[-1].omega[both[-1].omega > 0]
    return _Parts(
        elastic=float(elastic[0]),
        inert=np.max([_inert(problem, modes) for modes in both], axis=0),
        steps=np.max([_steps(problem, modes) for modes in both], axis=0),
    )


def _inert(problem: Problem, modes: NormalModes) -> FloatArray:
    """e_N over the square of the fastest frequency, s^2, of one state, shape ``(modes - 1,)``."""
    omega = np.where(modes.omega > 0, modes.omega, np.inf)
    shares = [np.zeros(omega.size)]
    for stop in problem.stops:
        share = stop.stiffness * modes.shapes(np.array([stop.x]))[:, 0] ** 2 / omega**2
        shares.append(share)
    left_out = np.max([share[::-1].cumsum()[::-1] for share in shares], axis=0)[1:]
    # Without stops the left-out modes still answer the loads; their share of a deflection is below one in N^4.
    least = np.arange(1, omega.size, dtype=float) ** -4
    square = np.where(modes.omega[:-1] > 0, omega[:-1], 0.0) ** 2  # rigid-body modes are never left out
    return np.asarray(
        np.divide(np.maximum(left_out, least), square, out=np.full(square.size, np.inf), where=square > 0)
    )


def _steps(problem: Problem, modes: NormalModes) -> FloatArray:
    """The largest share of left-out modes in the compliance at a step load, of one state, shape ``(modes - 1,)``."""
    omega = np.where(modes.omega > 0, modes.omega, np.inf)
    errors = [np.zeros(omega.size - 1)]
    for load in problem.point_loads:
        if isinstance(load, StepLoad):
            compliance = modes.shapes(np.array([load.x]))[:, 0] ** 2 / omega**2
            tail = compliance[::-1].cumsum()[::-1]
            errors.append(tail[1:] / (tail[0] + np.finfo(float).tiny))
    return np.asarray(np.max(errors, axis=0))


def _enough(problem: Problem, tolerance: float, pool: int) -> int:
    """The least number of modes by the sums over `pool` modes; `pool` itself if none is enough."""
    error = truncation_error(problem, pool)
    small = np.flatnonzero(error <= tolerance)
    count = max(LEAST, int(small[0]) + 1 if small.size else pool)
    if isinstance(problem.initial, AtRest):
        return count
    return max(count, _shape_count(problem, pool))


def _shape_count(problem: Problem, pool: int) -> int:
    """The number of modes that hold enough of the initial shape."""
    q, v = initial_coordinates(problem, exact_modes(problem, FREE, pool))
    needed = 1
    for coordinates in (q, v):
        tail = np.sqrt((coordinates[::-1] ** 2).cumsum()[::-1])
        inside = np.flatnonzero(tail <= _SHAPE_REMAINDER * tail[0]) if tail[0] > 0 else np.zeros(1, dtype=int)
        needed = max(needed, int(inside[0]) if inside.size else pool)
    return needed
