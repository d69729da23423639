"""Invariants that every steady state must satisfy, checked from the History of one of its periods.

Besides the invariants of every motion (`validation.invariants`), of a periodic motion:

- the motion closes: displacement and velocity along the beam at the end are equal to those at the start;
- its period is the least: after fewer excitation periods, displacement and velocity differ from the start;
- the two halves of a symmetric motion mirror each other, z(x, t + T/2) = -z(x, t), and those of others do not;
- its impulses per excitation period are the time integrals of the force law.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from lapjoint.answers import History, SteadyState
from validation.invariants import impulse_of, witness
from validation.verdict import Criterion

REPEATS = 1e-6
"""Distance of two motions, divided by their size, below which they are one.  Newton's method closes orbits to a
residual of 1e-9; truncation adds jumps at switches."""


def _apart(history: History, sign: int, later: float) -> float:
    """Largest distance of the motion from `sign` times the motion `later` seconds afterwards, divided by its size.

    Displacements, and velocities divided by the excitation frequency, are compared at 21 places and 33 times in the
    period.
    """
    x, span = history.problem.line.grid(21), history.end - history.start
    t = history.start + span * (np.arange(33) + 0.5) / 33
    on = history.start + np.mod(t - history.start + later, span)
    omega = history.problem.excitation_frequency or 1.0
    here = np.concatenate([history.evaluate(x, t), history.evaluate(x, t, dt=1) / omega])
    there = np.concatenate([history.evaluate(x, on), history.evaluate(x, on, dt=1) / omega])
    return float(np.abs(here - sign * there).max() / max(np.abs(here).max(), 1e-300))


def _closes(found: SteadyState, tolerance: float) -> Criterion:
    """Distance between the end and the start of the motion's period, divided by the size of the motion."""
    history = found.history
    x, ends = history.problem.line.grid(21), np.array([history.start, history.end])
    omega = history.problem.excitation_frequency or 1.0
    both = np.concatenate([history.evaluate(x, ends), history.evaluate(x, ends, dt=1) / omega])
    gap = float(np.abs(np.diff(both, axis=1)).max() / max(np.abs(both).max(), 1e-300))
    return Criterion("end of the period from its start", "1", gap, 0.0, tolerance, "Newton's residual")


def _least_period(found: SteadyState, tolerance: float) -> Criterion:
    """Least distance of the motion from repeating after fewer excitation periods than stated, divided by its size."""
    history, n = found.history, found.period_multiple
    parts = [k for k in range(1, n) if n % k == 0]
    period = (history.end - history.start) / max(n, 1)
    nearest = min(_apart(history, 1, k * period) for k in parts)
    return Criterion("nearest to repeating in a part of its period", "1", nearest, tolerance, math.inf, "it must not")


def _half_period(found: SteadyState, tolerance: float) -> Criterion:
    """Distance of half of the motion from the mirror image of the other half, divided by the size of the motion."""
    history = found.history
    asymmetry = _apart(history, -1, (history.end - history.start) / 2)
    if found.symmetric:
        return Criterion("half a period from its mirror image", "1", asymmetry, 0.0, tolerance, "called symmetric")
    return Criterion("half a period from its mirror image", "1", asymmetry, tolerance, math.inf, "not called symmetric")


def _impulses_per_period(found: SteadyState, tolerance: float) -> Criterion:
    """Largest difference between an impulse per excitation period and the integral of the force law, relative."""
    history = found.history
    breaks = np.unique([history.start, *history.switch_times, history.end])
    largest = max(float(np.abs(found.impulses).max(initial=0.0)), 1e-300)
    periods = max(found.period_multiple, 1)
    worst = 0.0
    for k, impulse in enumerate(found.impulses):
        area, unsure = impulse_of(k, breaks, history, tolerance, largest * periods)
        worst = max(worst, abs(area / periods - float(impulse)) - unsure / periods)
    return Criterion("impulse per period against the force law", "1", worst / largest, 0.0, tolerance, "quadrature")


def steady_witness(found: SteadyState, tolerance: float, label: str) -> list[Criterion]:
    """All invariants of a steady state and of its motion; without invariants of the period if the motion does not
    repeat.

    Parameters
    ----------
    found : SteadyState
        The steady state, of either solver.
    tolerance : float
        Tolerance of the motion, relative to its size.  Comparisons over the period have the tolerance `REPEATS`, and
        impulses per period this tolerance, or ten times the residual if that is more.
    label : str
        Prefix of each name.

    Returns
    -------
    list of Criterion
        Each with its verdict.
    """
    result = witness(found.history, tolerance, label)
    if not found.period_multiple:
        return result
    near = max(REPEATS, 10 * found.residual)  # with truncated modes, a motion repeats only to its residual
    checks = (_closes, _half_period, _least_period) if found.period_multiple > 1 else (_closes, _half_period)
    result += [replace(item, name=f"{label}: {item.name}") for item in (check(found, near) for check in checks)]
    item = _impulses_per_period(found, max(tolerance, 10 * found.residual))
    return [*result, replace(item, name=f"{label}: {item.name}")]
