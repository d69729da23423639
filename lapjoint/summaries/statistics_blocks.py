"""Statistics as blocks of rows, like the summary of a steady state in `lapjoint.summaries.blocks`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lapjoint.answers.series import written
from lapjoint.problem import FloatArray, Problem
from lapjoint.summaries.blocks import LIFE, POWERS, Block, Number, Row

if TYPE_CHECKING:
    import xarray as xr

SHARES = (0.5, 0.9, 0.99)
"""Fractions of all contacts at which quantiles are shown."""
_DIGITS = 4
_OF_STOPS = {
    "contact_rate": "Contacts a second",
    "contact_time": "Share of time in contact",
    "received_power": "Mean power received by the stop [W]",
    "dissipated_power": "Mean power lost in the stop [W]",
    "impulse_rate": "Impulse a second [N], top positive",
    "force_rms": "Root mean square of the force [N]",
    "force_maximum": "Largest force [N]",
}
_OF_CONTACTS = {
    "impulse": "Impulse of a contact [N s]",
    "peak_force": "Largest force of a contact [N]",
    "contact_duration": "Duration of a contact [s]",
    "impact_speed": "Impact speed [m/s]",
}


def statistics_blocks(found: xr.Dataset, problem: Problem) -> list[Block]:
    """What is shown of statistics: values with their intervals, quantiles of contacts, powers, and fatigue.

    Blocks without rows are left out.
    """
    unit = f"largest in {found.attrs['unit_duration']:.3g} s, mean"
    powers = tuple(Row(text, (_with_interval(found, name),)) for name, text in POWERS.items())
    blocks = [
        _at_places(found, problem, "root mean square", "rms", "mean", "mean"),
        _at_places(found, problem, unit, "maximum", "peak", "of all"),
        *(_at_stops(found, problem, name, title) for name, title in _OF_STOPS.items()),
        *(_at_stops(found, problem, name, _titled(found, name)) for name in _others(found)),
        *(_of_contacts(found, problem, name, title) for name, title in _OF_CONTACTS.items()),
        Block("Mean power [W]", ("",), powers),
        *(_of_fatigue(found, problem) if "damage_rate" in found else ()),
    ]
    return [block for block in blocks if block.rows]


def quantiles(counts: FloatArray, low: FloatArray, high: FloatArray) -> list[float]:
    """Quantiles at the fractions `SHARES`, from counts in bins, shape (m,), interpolated logarithmically from `low` to
    `high` of a bin."""
    total = counts.cumsum()
    if not total.size or not total[-1]:
        return [np.nan] * len(SHARES)
    found = []
    for share in SHARES:
        bin_ = int(np.searchsorted(total, share * total[-1]))
        part = 1 - (total[bin_] - share * total[-1]) / counts[bin_]
        found.append(float(low[bin_] * (high[bin_] / low[bin_]) ** part))
    return found


def _at_places(found: xr.Dataset, problem: Problem, title: str, value: str, other: str, head: str) -> Block:
    """For each quantity a row for each chosen place, and one for the place where it is largest along the beam."""
    names = [
        str(name)[: -len("_rms")] for name in found.data_vars if str(name).endswith("_rms") and "x" in found[name].dims
    ]
    rows: list[Row] = []
    for name in names:
        largest = int(found[f"{name}_{value}"].values.argmax())
        rows += _along(found, problem, name, f"{name}_{value}", f"{name}_{other}", largest)
    return Block(title, ("", head), tuple(rows))


def _along(found: xr.Dataset, problem: Problem, name: str, value: str, other: str, largest: int) -> list[Row]:
    """A row for each chosen place, and one for the place `largest`: a value with its interval, and another if the
    dataset has it."""
    asked, rows = np.flatnonzero(found.asked.values).tolist(), []
    of = f"{name.replace('_', ' ')} [{written(found[value].attrs['units'])}]"
    for k, i in enumerate([*asked, largest]):
        more = Number(float(found[other].values[i]), digits=_DIGITS) if other in found else None
        where, star = problem.line.place(float(found.x.values[i]), _DIGITS), k == len(asked)
        rows.append(Row(where, (_with_interval(found, value, i), more), of, largest=star, asked=i in asked))
    return rows


def _at_stops(found: xr.Dataset, problem: Problem, name: str, title: str) -> Block:
    """A value of each stop; of damped stops alone, and of all together, where it is a loss."""
    of_damped, stops = name == "dissipated_power", problem.structure.stops
    which = [i for i, stop in enumerate(stops) if stop.damping > 0 or not of_damped]
    rows = [Row(problem.stop_names[i], (_with_interval(found, name, i),), stop=i) for i in which]
    if of_damped and len(which) > 1:
        rows.append(Row("in all", (_with_interval(found, f"{name}_total"),)))
    return Block(title, ("",), tuple(rows))


def _of_contacts(found: xr.Dataset, problem: Problem, name: str, title: str) -> Block:
    """Quantiles of the contacts of each stop, and the largest value."""
    low, high, rows = found[f"{name}_low"].values, found[f"{name}_high"].values, []
    for i, stop in enumerate(problem.stop_names):
        largest = float(found[f"{name}_largest"].values[i])
        values = quantiles(found[f"{name}_count"].values[i], low, high)
        numbers = [Number(min(value, largest), digits=_DIGITS) for value in values]
        rows.append(Row(stop, (*numbers, Number(largest, digits=_DIGITS)), stop=i))
    return Block(title, (*(f"{100 * share:g} %" for share in SHARES), "largest"), tuple(rows))


def _of_fatigue(found: xr.Dataset, problem: Problem) -> list[Block]:
    """Damage, its error by sampling, ranges at places, and the life, if there is damage."""
    rate = found.damage_rate.values
    worst, rows = int(rate.argmax()), list[Row]()
    for name, other in (("damage_rate", ""), ("equivalent_range", "largest_range")):
        rows += _along(found, problem, name, name, other, worst)
    often = f"{found.equivalent_range.attrs['equivalent_rate']:.4g}"
    blocks = [Block(f"Fatigue; {often} cycles/s", ("", "largest"), tuple(rows))]
    if rate[worst] > 0:
        error = Number(100 * float(found.damage_rate.attrs["sampling_error"]), digits=2)
        with np.errstate(divide="ignore"):
            life, high, low = 1 / np.array([rate[worst], *found.damage_rate_interval.values[worst]]) / 3600
        hours = Number(float(life), interval=(float(low), float(high)), digits=_DIGITS)
        blocks.append(Block(LIFE, ("",), (Row("along the beam", (hours,)),)))
        blocks.append(Block("Error of damage by sampling, in % of the largest", ("",), (Row("at most", (error,)),)))
    return blocks


def _with_interval(found: xr.Dataset, name: str, i: int | None = None) -> Number:
    """A value of a dataset of statistics, of its i-th place or stop, with its interval."""
    value, ends = found[name].values, found[f"{name}_interval"].values
    if i is not None:
        value, ends = value[i], ends[i]
    return Number(float(value), interval=(float(ends[0]), float(ends[1])), digits=_DIGITS)


def _others(found: xr.Dataset) -> list[str]:
    """Values of stops with intervals that have no title of their own."""
    known = {*_OF_STOPS, *(f"{name}_exceedance" for name in _OF_CONTACTS)}
    return [
        str(name)
        for name in found.data_vars
        if found[name].dims == ("stop",) and f"{name}_interval" in found and name not in known
    ]


def _titled(found: xr.Dataset, name: str) -> str:
    """The title of a value by its attributes."""
    of = found[name].attrs
    return f"{of['long_name']} [{written(of['units'])}]"
