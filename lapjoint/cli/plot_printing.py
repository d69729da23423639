"""What the figure of a sweep or of statistics shows, in numbers: peaks, jumps, and where limits are exceeded."""

from __future__ import annotations

import math
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.answers.series import written
from lapjoint.cli.echo import echo
from lapjoint.cli.printing import COLUMNS
from lapjoint.figures.curve_features import STANDS_OUT, Jump, Peak, exceeding, jumps_of, peaks_of
from lapjoint.figures.impulse_curve_wide import MOST_LINES
from lapjoint.figures.sweep_axes import fields, in_order, short_name, units, with_unit
from lapjoint.figures.text import apart, cut_to, error_text, plain

if TYPE_CHECKING:
    import xarray as xr

    from lapjoint.problem import FloatArray

PEAKS_SHOWN = 5
"""Most peaks of a curve that are printed, the largest."""
JUMPS_SHOWN = 20
RUNS_SHOWN = 4
_CURVE = 18
"""Width of the column of stops, characters."""
_NAME = 30
"""Width of a column of stops or places, characters."""


def print_features(dataset: xr.Dataset, variable: str, limits: list[float], name: str = "") -> None:
    """Print peaks and jumps of the curves of a sweep, and where they exceed limits; `name` is that of one of several
    sweeps."""
    heading = f"{plain(name)}: " if name else ""
    if "start" in dataset.outcome.dims:
        echo(f"\n{heading}several starts at a point make no curve, which would have peaks and jumps")
        return
    dataset = in_order(dataset)
    first, second = fields(dataset)
    number = 1 if second is None else dataset.sizes[second]
    if number > MOST_LINES:
        echo(f"\n{heading}{number} curves for each stop; peaks and jumps are printed of {MOST_LINES} at most")
        return
    for i in range(number):
        line = dataset if second is None else dataset.isel({second: i})
        of = "" if second is None else f"{short_name(line, second)} = {with_unit(line, second, line[second].item(), 6)}"
        _print_line(line, first, variable, limits, (heading + of).removesuffix(": "))


def _print_line(dataset: xr.Dataset, first: str, variable: str, limits: list[float], heading: str) -> None:
    """Print the peaks and jumps of one value of the second field."""
    names, values, errors = _curves_of(dataset, variable)
    x, of = dataset[first].values, f"{short_name(dataset, first)} [{units(dataset, first)}]"
    unit = written(str(dataset[variable].attrs["units"]))
    said = f"{variable} [{unit}]".removesuffix(" [1]")
    if heading:
        echo(f"\n{heading}")
    peaks = [peaks_of(x, y, error) for y, error in zip(values, errors, strict=True)]
    if any(peaks):
        echo(f"\n{'Peaks':<{_CURVE}}{of:>31}{said:>29}")
        for curve, found in zip(names, peaks, strict=True):
            _print_peaks(curve, found)
        least = f"A peak stands out by {100 * STANDS_OUT:g} % of the largest value"
        rule = f"{least}; its place is known to one step of the grid."
        echo(fill(rule, COLUMNS))
    _print_jumps(jumps_of(dataset, values), names, of, said)
    for limit in limits:
        echo(f"\nBeyond the limit of {limit:g} {unit}".removesuffix(" 1"))
        for curve, y in zip(names, values, strict=True):
            _print_exceeded(curve, *exceeding(x, y, limit), x.size, units(dataset, first))


def _curves_of(dataset: xr.Dataset, variable: str) -> tuple[list[str], list[FloatArray], list[FloatArray | None]]:
    """Names, values (n,) and numerical errors, (n,) or None, of the curves of a variable."""
    error = dataset.get(f"{variable}_error")
    if "stop" not in dataset[variable].dims:
        return ["beam"], [dataset[variable].values], [None if error is None else error.values]
    names = apart([str(stop) for stop in dataset.stop_name.values], lambda one: cut_to(one, _CURVE - 2))
    rows = [dataset[variable].isel(stop=i).values for i in range(len(names))]
    return names, rows, [None if error is None else error.isel(stop=i).values for i in range(len(names))]


def _print_peaks(curve: str, peaks: list[Peak]) -> None:
    for peak in peaks[:PEAKS_SHOWN]:
        place = f"{peak.place:.6g} +- {peak.error:.3g}"
        place = f"{peak.place:.6g}, an end" if math.isnan(peak.error) else place
        error = "" if math.isnan(peak.value_error) else f" +- {error_text(peak.value_error)}"
        echo(f"{curve:<{_CURVE}}{place:>31}{f'{peak.value:.6g}{error}':>29}")
        curve = ""
    if len(peaks) > PEAKS_SHOWN:
        echo(f"{'':<{_CURVE}}... and {len(peaks) - PEAKS_SHOWN} lower")


def _print_jumps(jumps: list[Jump], names: list[str], of: str, said: str) -> None:
    if not jumps:
        return
    echo(f"\n{'Jumps':<{_CURVE}}between neighbouring points that are different motions")
    rows = [(of, said, "motion"), *(_jump_row(jump, names) for jump in jumps[:JUMPS_SHOWN])]
    first, second = (max(len(row[i]) for row in rows) + 2 for i in (0, 1))
    for place, values, motions in rows:
        echo(f"{place:<{first}}{values:<{second}}{motions}")
    if len(jumps) > JUMPS_SHOWN:
        echo(f"... and {len(jumps) - JUMPS_SHOWN} more")


def _jump_row(jump: Jump, names: list[str]) -> tuple[str, str, str]:
    one, other = jump.motions
    return (
        f"{jump.before:.6g} to {jump.after:.6g}",
        f"{names[jump.curve]} {jump.values[0]:.5g} -> {jump.values[1]:.5g}",
        one if one == other else f"{one} -> {other}",
    )


def _print_exceeded(curve: str, count: int, runs: list[tuple[float, float]], points: int, unit: str) -> None:
    where = [f"{a:.6g} to {b:.6g}" if a != b else f"{a:.6g}" for a, b in runs[:RUNS_SHOWN]]
    more = [f"{len(runs) - RUNS_SHOWN} more"] if len(runs) > RUNS_SHOWN else []
    text = f"{count} of {points} points, {', '.join([*where, *more])} {unit}" if count else "no point"
    echo(f"{curve:<{_CURVE}}{text}".removesuffix(" -"))


def print_exceedance(dataset: xr.Dataset, quantity: str, limit: float) -> None:
    """Print how often a limit is exceeded: between the rates at the edges of the bin in which the limit lies."""
    from lapjoint.figures.exceedance import counted, names_in

    low, top = dataset[f"{quantity}_low"].values, dataset[f"{quantity}_high"].values[-1]
    rates, ends = dataset[f"{quantity}_exceedance"].values, dataset[f"{quantity}_exceedance_interval"].values
    at = int(np.searchsorted(low, limit, side="right"))
    unit = written(str(dataset[f"{quantity}_low"].attrs["units"]))
    echo(f"\n{counted(quantity).capitalize()} a second beyond the limit of {limit:g} {unit}, and their 95 % interval")
    for i, name in names_in(dataset, quantity).items():
        rate, end = rates[i], ends[i]
        most, high = (rate[max(at - 1, 0)], end[max(at - 1, 0), 1]) if limit < top else (0.0, end[-1, 1])
        least, low_end = (rate[at], end[at, 0]) if at < low.size else (0.0, 0.0)
        numbers = f"{least:.4g}" if least == most else f"{least:.4g} to {most:.4g}"
        echo(f"{cut_to(name, _NAME - 2):<{_NAME}}{numbers:<28}{low_end:.3g} to {high:.3g}")
