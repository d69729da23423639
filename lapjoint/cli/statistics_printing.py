"""Printing of statistics by the command line, in 80 columns, and their content in JSON files."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.answers.series import written
from lapjoint.cli.echo import echo
from lapjoint.cli.printing import COLUMNS, FAILURES_SHOWN, print_excitation
from lapjoint.figures.text import apart, cut_to, plain

if TYPE_CHECKING:
    import xarray as xr

    from lapjoint.problem import FloatArray, Problem

_NAME = 28
"""Width of the column of quantities or stops, characters."""
_SHARES = (0.5, 0.9, 0.99)
"""Fractions of all contacts at which quantiles are printed."""
_OF_STOPS = {
    "contact_rate": "Contacts a second",
    "contact_time": "Share of time in contact",
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


def print_statistics(found: xr.Dataset, problem: Problem) -> None:
    """Print the settings, and the values at places and at stops with their intervals."""
    of = found.attrs
    echo(plain(of["title"]))
    done, units = int(of["seeds"]) - int(of["failed"]), int(of["units"])
    realisations = f"{done} realisations" if int(of["seeds"]) > 1 else "1 motion"
    echo(f"{of['solver_name']}: {realisations} of {of['duration']:g} s, the first {of['settle']:.4g} s left out")
    each = f"{units} unit{'s' * (units > 1)} of {of['unit_duration']:.4g} s"
    echo(f"Intervals of {100 * of['level']:g} % from {each}, {of['rate']:.4g} samples a second")
    print_excitation(problem)
    _print_places(found)
    _print_stops(found, problem)
    for line in [*filter(None, of["remarks"].split("\n"))]:
        echo(fill(f"Note: {line}", COLUMNS))
    messages = [*filter(None, of["messages"].split("\n"))]
    for line in messages[:FAILURES_SHOWN]:
        echo(f"failed: {line}")


def statistics_summary(found: xr.Dataset) -> dict[str, Any]:
    """The content of a JSON file of statistics: attributes, coordinates, and units, values and intervals of each
    variable."""
    variables: dict[str, Any] = {}
    for name, variable in found.data_vars.items():
        if not str(name).endswith("_interval"):
            entry = {"units": variable.attrs["units"], "over": list(variable.dims), "values": variable.values.tolist()}
            if f"{name}_interval" in found:
                entry["interval"] = found[f"{name}_interval"].values.tolist()
            variables[str(name)] = entry
    return {
        **{str(name): value.item() if hasattr(value, "item") else value for name, value in found.attrs.items()},
        "x_m": found.x.values.tolist(),
        "asked": found.asked.values.astype(bool).tolist(),
        "stops": found.stop_name.values.tolist(),
        "variables": variables,
    }


def _print_places(found: xr.Dataset) -> None:
    names = [
        str(name)[: -len("_rms")] for name in found.data_vars if str(name).endswith("_rms") and "x" in found[name].dims
    ]
    unit = f"largest in {found.attrs['unit_duration']:.3g} s, mean"
    for title, middle, last, heading in (
        ("root mean square", "rms", "mean", "mean"),
        (unit, "maximum", "peak", "of all"),
    ):
        echo(f"\n{title:<{_NAME}}{'x [m]':>8}{'':>11}{'95 % interval':>22}{heading:>11}")
        for name in names:
            values, ends = found[f"{name}_{middle}"].values, found[f"{name}_{middle}_interval"].values
            label = f"{name.replace('_', ' ')} [{written(found[f'{name}_rms'].attrs['units'])}]"
            asked = np.flatnonzero(found.asked.values)
            rows = [(int(i), "") for i in asked]
            if values.argmax() not in asked:
                rows.append((int(values.argmax()), "*"))
            for i, star in rows:
                x = f"{found.x.values[i]:.4g}{star}"
                more = _short(found[f"{name}_{last}"].values[i]) if f"{name}_{last}" in found else ""
                echo(f"{label:<{_NAME}}{x:>8}{_interval(values[i], ends[i])}{more}")
                label = ""
    echo("* where it is largest along the beam")


def _print_stops(found: xr.Dataset, problem: Problem) -> None:
    names = apart([str(name) for name in found.stop_name.values], lambda name: cut_to(name, 24))
    if not names:
        return
    damped = [stop.damping > 0 for stop in problem.stops]
    for variable, title in _OF_STOPS.items():
        of_damped = variable == "dissipated_power"
        if of_damped and not any(damped):
            continue
        echo(f"\n{title:<{_NAME + 8}}{'':>11}{'95 % interval':>22}")
        for i, name in enumerate(names):
            if damped[i] or not of_damped:
                ends = found[f"{variable}_interval"].values[i]
                echo(f"{name:<{_NAME + 8}}{_interval(found[variable].values[i], ends)}")
        if of_damped and sum(damped) > 1:
            total = found[f"{variable}_total"]
            echo(f"{'in all':<{_NAME + 8}}{_interval(float(total), found[f'{total.name}_interval'].values)}")
    for variable, title in _OF_CONTACTS.items():
        shares = "".join(f"{f'{100 * share:g} %':>11}" for share in _SHARES)
        echo(f"\n{title:<{_NAME + 3}}{shares}{'largest':>11}")
        for i, name in enumerate(names):
            low, high = found[f"{variable}_low"].values, found[f"{variable}_high"].values
            values = quantiles(found[f"{variable}_count"].values[i], low, high)
            largest = found[f"{variable}_largest"].values[i]
            echo(f"{name:<{_NAME + 3}}{''.join(_short(min(value, largest)) for value in values)}{_short(largest)}")


def quantiles(counts: FloatArray, low: FloatArray, high: FloatArray) -> list[float]:
    """Quantiles at the fractions `_SHARES`, from counts in bins, shape (m,), interpolated logarithmically from `low` to
    `high` of a bin."""
    total = counts.cumsum()
    if not total.size or not total[-1]:
        return [np.nan] * len(_SHARES)
    found = []
    for share in _SHARES:
        bin_ = int(np.searchsorted(total, share * total[-1]))
        part = 1 - (total[bin_] - share * total[-1]) / counts[bin_]
        found.append(float(low[bin_] * (high[bin_] / low[bin_]) ** part))
    return found


def _interval(value: float, ends: FloatArray) -> str:
    return f"{_short(value)}{_short(ends[0])}{_short(ends[1])}"


def _short(value: float) -> str:
    """A number in four digits; a question mark if it is unknown."""
    return f"{value:11.4g}" if np.isfinite(value) else f"{'?':>11}"
