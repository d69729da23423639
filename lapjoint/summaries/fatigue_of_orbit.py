"""Fatigue by a steady state: damage a second, equivalent range and largest range at each place, with errors.

The error of a damage is the difference to the count from half of the samples, and what the motion at a finer resolution
tells, see `lapjoint.orbits.refinement`.  For a motion that does not repeat it is the standard error of the mean.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lapjoint.answers.history import History
from lapjoint.answers.steady_state import SteadyState
from lapjoint.problem import FloatArray
from lapjoint.summaries.correlated_series import standard_error
from lapjoint.summaries.quantities import Selection, is_rounding
from lapjoint.summaries.rainflow import CycleCounter, Damage, Places, damage_of_period, rate_of

OF_FATIGUE = {
    "damage_rate": ("s-1", "fatigue damage a second"),
    "equivalent_range": ("Pa", "stress range of which one cycle in each period of the excitation does the same damage"),
    "largest_range": ("Pa", "largest range of stress of a cycle"),
}
"""Values of each place: unit and meaning."""


@dataclass(frozen=True)
class FatigueSummary:
    """Fatigue at the places of a summary."""

    values: dict[str, FloatArray]
    """By the names of `OF_FATIGUE`, shape ``(X,)``."""
    errors: dict[str, FloatArray] | None
    """Estimates of the errors of `values`; infinite where none can be stated, None if none were estimated."""
    counts: FloatArray
    """Cycles a second in each bin of the range, ``(X, BINS)``, see `lapjoint.summaries.distributions`."""


def fatigue_of_orbit(steady: SteadyState, what: Selection, finer: float) -> FatigueSummary | None:
    """Fatigue by a periodic motion; None if no material has an S-N line."""
    if not what.fatigued:
        return None
    places, history = Places(steady.problem, what.x), steady.history
    duration, period = history.end - history.start, _period(steady)
    values = _values(places, damage_of_period(places, history), duration, period)
    counts = values.pop("counts")
    if steady.impulse_errors is None:
        return FatigueSummary(_named(values), None, counts)
    if steady.comparison is None:
        return FatigueSummary(_named(values), {name: np.full(what.x.size, math.inf) for name in OF_FATIGUE}, counts)
    other, errors = steady.comparison, {}
    better = _values(places, damage_of_period(places, other.history, finer), duration, period)
    for name in ("damage_rate", "largest_range"):
        apart, value = values[name] - better[name], values[name]
        errors[name] = other.bounds(apart, float(np.abs(apart).max(initial=0.0)), 2, 0) + other.floor * value.max()
    errors["damage_rate"] += np.abs(values["damage_rate"] - values["coarse"])
    errors["largest_range"] += np.abs(better["largest_range"] - values["largest_range"])
    errors["damage_rate"][values["damage_rate"] == 0] *= better["damage_rate"][values["damage_rate"] == 0] > 0
    errors["largest_range"][values["largest_range"] == 0] = 0.0
    errors["equivalent_range"] = _range_error(places, values["damage_rate"] * period, errors["damage_rate"] * period)
    return FatigueSummary(_named(values), errors, counts)


def fatigue_of_wandering(
    steady: SteadyState, history: History, what: Selection, periods: int, enough: bool
) -> FatigueSummary | None:
    """Fatigue by a motion over some excitation periods that does not repeat; None if no material has an S-N line.

    Standard errors are stated if there are `enough` periods.
    """
    if not what.fatigued:
        return None
    places, edges = Places(steady.problem, what.x), np.linspace(history.start, history.end, periods + 1)
    counter = CycleCounter(places, rate_of(history))
    each = (counter.take(history, edges[i], edges[i + 1]) for i in range(periods))
    parts = [part for part in each if part is not None]
    rest = counter.finish()
    every = [*parts, rest]
    total = Damage(
        np.sum([part.damage for part in every], axis=0),
        np.sum([part.coarse for part in every], axis=0),
        np.max([part.largest for part in every], axis=0),
        np.sum([part.counts for part in every], axis=0),
    )
    period = (history.end - history.start) / periods
    values = _values(places, total, history.end - history.start, period)
    counts = values.pop("counts")
    if steady.impulse_errors is None:
        return FatigueSummary(_named(values), None, counts)
    series = np.array([part.damage + rest.damage / periods for part in parts]) / period
    error = np.array([standard_error(one) if enough else math.inf for one in series.T])
    error = error + np.abs(values["damage_rate"] - values["coarse"])
    return FatigueSummary(
        _named(values),
        {
            "damage_rate": error,
            "equivalent_range": _range_error(places, values["damage_rate"] * period, error * period),
            "largest_range": np.full(what.x.size, math.inf),
        },
        counts,
    )


def _period(steady: SteadyState) -> float:
    """The excitation period, s."""
    return 2 * math.pi / steady.problem.require_excitation_frequency("a steady state")


def _named(values: dict[str, FloatArray]) -> dict[str, FloatArray]:
    return {name: values[name] for name in OF_FATIGUE}


def _values(places: Places, done: Damage, duration: float, period: float) -> dict[str, FloatArray]:
    """Values by name, with those from half of the samples, and counts a second; 0 where stress is rounding."""
    known = ~is_rounding(done.largest)
    rate = done.damage * known / duration
    return {
        "damage_rate": rate,
        "coarse": done.coarse * known / duration,
        "equivalent_range": places.range_at(rate * period),
        "largest_range": done.largest * known,
        "counts": done.counts * known[:, None] / duration,
    }


def _range_error(places: Places, damage: FloatArray, error: FloatArray) -> FloatArray:
    """The error of the equivalent range by the error of the damage of a period, (X,) each."""
    finite = np.where(np.isfinite(error), error, 0.0)
    middle = places.range_at(damage)
    low, high = places.range_at(np.maximum(damage - finite, 0.0)), places.range_at(damage + finite)
    return np.where(np.isfinite(error), np.maximum(high - middle, middle - low), math.inf)
