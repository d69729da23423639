"""The dataset of statistics: values and intervals, from the sums of units.

- Each quantity has, over the places ``x``, ``*_rms``, ``*_peak`` (the largest of all) and ``*_maximum`` (the mean of
  the largest in a unit).  All but velocities and accelerations, whose means vanish in a stationary motion, have
  ``*_mean``.
- Each stop has, over ``stop``, ``force_rms``, ``force_peak``, ``force_maximum``, ``impulse_rate`` (the mean force),
  ``contact_rate``, ``contact_time`` (the fraction of time in contact) and ``dissipated_power`` (what a damped stop
  takes and keeps); ``dissipated_power_total`` is that of all stops together.  ``input_power`` and ``damping_power`` are
  those of the excitation and of the damping of beams and links.
- Materials with an S-N line add fatigue, see `lapjoint.summaries.fatigue_table`.
- Each distribution has, over ``stop`` and bins, ``*_count`` and ``*_exceedance``: the number of contacts a second that
  reach or exceed the lower edge of a bin.

A value with an interval has a second variable, ``*_interval``, over ``bound`` too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from lapjoint.answers.series import place_coordinates, stop_coordinates
from lapjoint.problem import FloatArray
from lapjoint.summaries import intervals
from lapjoint.summaries.distributions import distribution
from lapjoint.summaries.fatigue_table import fatigue_table
from lapjoint.summaries.measure import ENOUGH, LONG, Measure
from lapjoint.summaries.quantities import is_rounding
from lapjoint.summaries.sums import OF_CONTACTS, Sums
from lapjoint.summaries.valued import Variable, valued

if TYPE_CHECKING:
    import xarray as xr

CORRELATED = 0.3
"""Correlation of neighbouring units above which a remark says that units are too short: intervals are then a third too
narrow."""
MAXIMUM = "mean of the largest magnitude in a unit of time"
_OF_CONTACTS = {
    "impulse": ("N s", "impulse of a contact, its magnitude"),
    "peak_force": ("N", "largest force of a contact"),
    "contact_duration": ("s", "duration of a contact"),
    "impact_speed": ("m s-1", "speed of the beam towards the stop when a contact begins"),
}


def table(what: Measure, sums: Sums) -> xr.Dataset:
    """The dataset of statistics, without its problem and solver: values and intervals."""
    import xarray as xr

    return xr.Dataset(variables_of(what, sums), coords=_coordinates(what), attrs=settings_of(what, sums))


def variables_of(what: Measure, sums: Sums, *, binned: bool = True) -> dict[str, Variable]:
    """The variables of statistics, by name; what is counted in bins only if it is `binned`."""
    damped = np.array([stop.damping > 0 for stop in what.selection.problem.stops], dtype=bool)
    variables: dict[str, Variable] = {**_of_places(what, sums), **_of_stops(sums, damped), **_largest(sums)}
    variables |= _distributions(sums) if binned else {}
    return variables | (fatigue_table(what, sums, binned) if what.selection.fatigued else {})


def remarks(what: Measure, sums: Sums, realisations: int) -> list[str]:
    """A sentence for each reason to doubt the confidence intervals of `realisations` motions."""
    found, units = [], sums.samples.size
    if units < ENOUGH:
        found.append(
            f"intervals are made of {units} unit{'s' * (units > 1)} of {what.unit:.4g} s only, each long against the "
            "correlation; a longer duration, or more seeds, makes them narrower"
        )
    if what.unit < LONG * what.decay_time < np.inf:
        found.append(
            f"a unit of {what.unit:.4g} s is short against the decay time of the slowest mode, {what.decay_time:.4g} s"
        )
    correlation = _correlation(sums, realisations)
    if correlation > CORRELATED:
        found.append(
            f"units of {what.unit:.4g} s that follow each other have a correlation of {correlation:.2f}; intervals are "
            "too narrow, and a longer duration is needed"
        )
    return found


def _correlation(sums: Sums, realisations: int) -> float:
    """Median correlation of the mean squares of neighbouring units; 0 if there are too few units."""
    units = sums.samples.size // realisations
    if units < ENOUGH:
        return 0.0
    squares = sums.squares.reshape(realisations, units, -1) / sums.samples.reshape(realisations, units, 1)
    off = squares - squares.mean(axis=1, keepdims=True)
    both, each = (off[:, 1:] * off[:, :-1]).sum(axis=(0, 1)), (off**2).sum(axis=(0, 1))
    return float(np.median(both[each > 0] / each[each > 0])) if (each > 0).any() else 0.0


def _coordinates(what: Measure) -> dict[str, Variable]:
    asked = np.isin(np.arange(what.selection.x.size), what.selection.asked)
    problem = what.selection.problem
    return (
        place_coordinates(problem, what.selection.x)
        | stop_coordinates(problem)
        | {
            "asked": (("x",), asked.astype("i1"), {"long_name": "1 where the place was asked for"}),
            "bound": interval_ends(),
        }
    )


def interval_ends() -> Variable:
    """The coordinate of the ends of intervals."""
    return ("bound",), np.array(["low", "high"], dtype=object), {"long_name": "end of the interval"}


def settings_of(what: Measure, sums: Sums) -> dict[str, Any]:
    """How motions were summarised, as attributes of a dataset."""
    return {
        "level": intervals.LEVEL,
        "duration": what.duration,
        "settle": what.settle,
        "units": int(sums.samples.size),
        "unit_duration": what.unit,
        "decay_time": what.decay_time,
        "rate": what.rate,
        "samples": int(sums.samples.sum()),
        "intervals": (
            f"{100 * intervals.LEVEL:g} %, of Student's t over the units, of the reciprocal root for what is never "
            "negative; of Poisson counts, corrected for their dispersion, where fewer than half of the units have "
            f"{intervals.FEW} events or more"
        ),
        "peaks": "of forces those of the contacts; others the largest sample, refined, which is a lower bound",
    }


def _of_places(what: Measure, sums: Sums) -> dict[str, Variable]:
    found: dict[str, Variable] = {}
    number, here = sums.samples[:, None], ("x",)
    for q, one in enumerate(what.selection.quantities):
        known = ~is_rounding(sums.peak[:, q].max(axis=0))
        mean, squares = sums.total[:, q] / number * known, sums.squares[:, q] / number * known
        peak = sums.peak[:, q] * known
        if one.dt == 0:
            text = f"mean of the {one.text}"
            found |= valued(f"{one.name}_mean", here, mean.mean(axis=0), intervals.of_mean(mean), one.units, text)
        found |= valued(
            f"{one.name}_rms",
            here,
            np.sqrt(squares.mean(axis=0)),
            intervals.of_rms(squares),
            one.units,
            f"root mean square of the {one.text}",
        )
        found |= _maxima(one.name, "x", peak, one.units, one.text)
    return found


def _maxima(name: str, dimension: str, peak: FloatArray, units: str, text: str) -> dict[str, Variable]:
    """The largest of all units, and the mean of the largest in each unit."""
    largest = {"units": units, "long_name": f"largest magnitude of the {text}"}
    return {f"{name}_peak": ((dimension,), peak.max(axis=0), largest)} | valued(
        f"{name}_maximum",
        (dimension,),
        peak.mean(axis=0),
        intervals.of_positive_mean(peak),
        units,
        f"{MAXIMUM}: {text}",
    )


def _of_stops(sums: Sums, damped: npt.NDArray[np.bool_]) -> dict[str, Variable]:
    """Values of the stops, of which some are `damped`, ``(S,)``."""
    number, here, T = sums.samples[:, None], ("stop",), sums.duration
    squares = sums.force_squares / number
    text = "force of the stop"
    found = valued(
        "force_rms",
        here,
        np.sqrt(squares.mean(axis=0)),
        intervals.of_rms(squares),
        "N",
        f"root mean square of the {text}",
    )
    found |= _maxima("force", "stop", sums.force_peak, "N", text)
    counts = sums.contacts
    found |= valued(
        "contact_rate", here, counts.mean(axis=0) / T, intervals.of_rate(counts, T), "s-1", "contacts a second"
    )
    share, impulse = sums.time_in_contact / T, sums.impulse / T
    found |= valued(
        "contact_time", here, share.mean(axis=0), intervals.of_positive_mean(share), "1", "share of time in contact"
    )
    found |= valued("impulse_rate", here, impulse.mean(axis=0), _signed(impulse), "N", "impulse a second; top positive")
    got = sums.received / T
    text = "energy that the stop takes a second, to keep or to give back: of each contact the most"
    found |= valued("received_power", here, got.mean(axis=0), intervals.of_positive_mean(got), "W", text)
    power = sums.dissipated / T
    text = "energy that the stop takes and keeps a second"
    found |= valued("dissipated_power", here, power.mean(axis=0), intervals.of_positive_mean(power), "W", text)
    never = share.sum(axis=0) == 0
    for name in ("force_rms", "force_maximum", "contact_time", "impulse_rate", "received_power"):
        found[f"{name}_interval"][1][never] = [0.0, np.inf]  # of a stop that was never touched, the value is unknown
    total = power.sum(axis=1)
    ends = intervals.of_positive_mean(total)
    untouched = damped & never
    found["dissipated_power_interval"][1][untouched] = [0.0, np.inf]
    if np.any(damped) and np.array_equal(untouched, damped):
        ends = np.array([0.0, np.inf])
    given = sums.work / sums.samples
    text = "energy that the excitation gives a second"
    found |= valued("input_power", (), given.mean(axis=0), intervals.of_mean(given), "W", text)
    left, text = given - total, "energy that the damping of beams and links takes a second: what the stops leave"
    found |= valued("damping_power", (), left.mean(axis=0), intervals.of_mean(left), "W", text)
    text = "energy that all stops take and keep a second"
    return found | valued("dissipated_power_total", (), total.mean(axis=0), ends, "W", text)


def _signed(units: FloatArray) -> FloatArray:
    """The interval, (S, 2), of the mean over units of values of one sign, (U, S)."""
    ends = intervals.of_positive_mean(np.abs(units))
    return np.where((units.sum(axis=0) < 0)[:, None], -ends[:, ::-1], ends)


def _largest(sums: Sums) -> dict[str, Variable]:
    """The largest value of the contacts of each stop."""
    return {
        f"{name}_largest": (("stop",), sums.largest[:, :, k].max(axis=0), {"units": units, "long_name": text})
        for k, (name, (units, text)) in enumerate(_OF_CONTACTS.items())
    }


def _distributions(sums: Sums) -> dict[str, Variable]:
    """The distribution of each of `OF_CONTACTS`."""
    found: dict[str, Variable] = {}
    for k, name in enumerate(OF_CONTACTS):
        found |= distribution(name, "stop", sums.counts[:, :, k], sums.duration, _OF_CONTACTS[name], "contacts")
    return found
