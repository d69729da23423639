"""Stroboscopic samples of the motions of a sweep: the state of one place, once in each excitation period.

The samples of a motion that repeats after p periods are p points; those of a motion that does not repeat fill an
interval, or lie on a fractal set.  Drawn over a parameter, they are a bifurcation diagram.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from lapjoint.answers.history import History
from lapjoint.answers.steady_state import SteadyState
from lapjoint.campaigns.dataset import Column, Variable
from lapjoint.campaigns.point import Point
from lapjoint.campaigns.sweep.spec import Plan
from lapjoint.problem import FloatArray

PREFIX = "strobe_"
"""Beginning of the names of the variables."""
QUANTITIES = {"displacement": ("m", 0), "velocity": ("m s-1", 1)}
"""What is sampled, relative to the base: its unit, and the order of its time derivative."""
_PER_PERIOD = 64
"""Times in an excitation period at which two motions are compared, for the size of the motion and of the difference."""


def strobed(found: SteadyState, number: int, place: float | str) -> dict[str, list[float]]:
    """The samples of a steady state, by quantity, with their errors where the motion has a finer one to compare with.

    A motion that repeats has a sample for each period of its own, at most `number`; another one is marched on over
    `number` periods.  The samples are those at the starts of the periods, the first at the start of `found.history`.
    """
    x, T = found.problem.position(place), 2 * math.pi / found.problem.require_excitation_frequency("strobe")
    history = found.history
    if not found.period_multiple and found.march_on is not None:
        history = found.march_on(number)
    kept = min(number, found.period_multiple or max(1, round((history.end - history.start) / T)))
    times = np.asarray(T * np.arange(kept), dtype=np.float64)
    samples = {name: _values(history, x, times, dt) for name, (_, dt) in QUANTITIES.items()}
    other = found.comparison
    if found.period_multiple and other is not None:
        close = np.asarray(T / _PER_PERIOD * np.arange(_PER_PERIOD * found.period_multiple), dtype=np.float64)
        for name, (_, dt) in QUANTITIES.items():
            apart = np.subtract(samples[name], _values(other.history, x, times, dt))
            whole = _values(history, x, close, dt)
            farthest = float(np.abs(np.subtract(whole, _values(other.history, x, close, dt))).max())
            errors = other.bounds(apart, farthest, 0, dt) + other.floor * float(np.abs(whole).max())
            samples[f"{name}_error"] = errors
    return {name: values.tolist() for name, values in samples.items()}


def _values(history: History, x: float, t: FloatArray, dt: int) -> FloatArray:
    """A derivative of z at the position `x`, m, at times since the start of a motion, s, shape (m,)."""
    return np.asarray(history.evaluate(x, np.minimum(history.start + t, history.end), dt=dt)[0])


def strobe_variables(plan: Plan, points: Sequence[Point], dimensions: tuple[str, ...]) -> dict[str, Variable]:
    """The variables of the samples of all cells, and the coordinate of their dimension; none if none were asked for.

    The samples of a motion that repeats are repeated, so that every motion has as many; those of a motion that was not
    marched so far are followed by NaN.
    """
    if not plan.strobe:
        return {}
    number, shape = plan.strobe, (*plan.shape, plan.strobe)
    text = "excitation period at whose start the sample is taken, since the start of the motion that is kept"
    found = {"strobe": Column("strobe", "i4", "1", text).of(("strobe",), range(number))}
    for name, (units, _) in QUANTITIES.items():
        values = np.array([_as_many(point, name, number) for point in points])
        more = {"place": f"x = {plan.at}" if isinstance(plan.at, str) else f"x = {plan.at:.10g}"}
        what = f"{name} relative to the base, once in each excitation period"
        column = Column(PREFIX + name, "f8", units, what, more)
        found[column.name] = column.of((*dimensions, "strobe"), values, shape)
        if plan.errors:
            errors = np.array([_as_many(point, f"{name}_error", number) for point in points])
            errors[np.isnan(errors) & ~np.isnan(values)] = math.inf
            said = f"estimate of the numerical error of {column.name}; infinite where none can be stated"
            of_error = Column(f"{column.name}_error", "f8", units, said, more)
            found[of_error.name] = of_error.of((*dimensions, "strobe"), errors, shape)
    return found


def _as_many(point: Point, name: str, number: int) -> FloatArray:
    """The `number` samples of a point, repeated if its motion repeats, else filled with NaN, shape (number,)."""
    values = np.array(point.strobe.get(name, ()), dtype=float)
    if point.period_multiple and values.size:
        return np.resize(values, number)
    return np.append(values, np.full(number - values.size, math.nan))
