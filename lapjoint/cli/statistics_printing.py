"""Printing of statistics by the command line, in 80 columns, and their content in JSON files."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING, Any

from lapjoint.cli.echo import echo
from lapjoint.cli.printing import COLUMNS, FAILURES_SHOWN, print_excitation
from lapjoint.figures.text import apart, cut_to, plain
from lapjoint.summaries.blocks import Block, Number
from lapjoint.summaries.statistics_blocks import statistics_blocks

if TYPE_CHECKING:
    import xarray as xr

    from lapjoint.problem import Problem

_NAME = 28
"""Width of the column of quantities or stops, characters."""
_WIDE = 11
"""Width of a column of numbers, characters."""


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
    names = apart(problem.stop_names, lambda name: cut_to(name, 24))
    for block in statistics_blocks(found, problem):
        if any(row.of for row in block.rows):
            _print_places(block)
        else:
            _print_stops(block, names)
    _print_notes(of)


def print_samples(found: xr.Dataset) -> None:
    """Print the settings of statistics with samples."""
    of = found.attrs
    echo(plain(of["title"]))
    seeds = int(of["seeds"])
    each = f", each of {seeds} realisations" if seeds > 1 else ""
    echo(f"{of['solver_name']}: {found.sizes['sample']} samples{each} of {of['duration']:g} s")
    echo(f"The first {found.settle.min():.4g} to {found.settle.max():.4g} s of each are left out")
    _print_notes(of)


def _print_notes(of: dict[str, Any]) -> None:
    """Print remarks, and messages of realisations that did not come to their end."""
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
        **({"x_m": found.x.values.tolist()} if "x" in found.dims else {}),
        **({"asked": found.asked.values.astype(bool).tolist()} if "asked" in found else {}),
        "stops": found.stop_name.values.tolist(),
        "variables": variables,
    }


def _print_places(block: Block) -> None:
    """Print values at places: the chosen ones, and where a quantity is largest if that is another place."""
    width, label = max(8, *(len(row.where) + 2 for row in block.rows)), ""
    heads = "".join(f"{head:>{_WIDE}}" for head in block.heads[1:])
    echo(f"\n{block.title:<{_NAME}}{'x [m]':>{width}}{'':>{_WIDE}}{'95 % interval':>22}{heads}")
    for row in block.rows:
        if row.asked and row.largest:
            continue
        where, of = row.where + "*" * row.largest, row.of if row.of != label else ""
        echo(f"{of:<{_NAME}}{where:>{width}}{''.join(map(_padded, row.numbers))}".rstrip())
        label = row.of
    if any(row.largest and not row.asked for row in block.rows):
        echo("* where it is largest along the beam")


def _print_stops(block: Block, names: list[str]) -> None:
    """Print one number of each stop with its interval, or several numbers without."""
    one = block.heads == ("",)
    wide = _NAME + (8 if one else 3)
    heads = f"{'':>{_WIDE}}{'95 % interval':>22}" if one else "".join(f"{head:>{_WIDE}}" for head in block.heads)
    echo(f"\n{block.title:<{wide}}{heads}")
    for row in block.rows:
        name = row.where if row.stop is None else names[row.stop]
        echo(f"{name:<{wide}}{''.join(map(_padded, row.numbers))}")


def _padded(number: Number | None) -> str:
    """A number of a table, with the ends of its interval."""
    if number is None:
        return ""
    return "".join(f"{text:>{_WIDE}}" for text in (number.text, *number.ends) if text)
