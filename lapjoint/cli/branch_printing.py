"""Branches as the command line shows them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.cli.echo import echo
from lapjoint.figures.branch_names import bifurcation_name, locus_name, parameter_of, second_parameter_of
from lapjoint.figures.sweep_axes import units

if TYPE_CHECKING:
    import xarray as xr

ROWS_SHOWN = 40
_AT_END = 1e-9
"""Distance from an end of the range within which a point is at the end, divided by the larger of the range and the
end's value."""


def is_whole(dataset: xr.Dataset) -> bool:
    """Whether branches were found, and all were followed to their ends."""
    ends = {*dataset.branch_first_end.values, *dataset.branch_last_end.values}
    failed = int(dataset.sizes.get("failure", 0))
    return bool(ends) and not ends & {"lost", "effort", "contacts"} and not int(dataset.left_out.sum()) and not failed


def print_branches(dataset: xr.Dataset) -> None:
    """Print each branch in a line, with its bifurcations below it; with a second parameter, the loci of bifurcations
    instead."""
    if not dataset.branch_first_end.size:
        echo("no periodic motion was found from any start")
    if second_parameter_of(dataset) is None:
        for i in range(dataset.branch_first_end.size):
            _print_branch(dataset, i)
        if "uncovered_from" not in dataset:
            _print_ends_without_motion(dataset)
    else:
        _print_loci(dataset)
    _print_what_is_missing(dataset)


def _unit(dataset: xr.Dataset, name: str | None = None) -> str:
    """The unit of a parameter behind a space, by default of the one that changes along the branches."""
    return f" {units(dataset, name or parameter_of(dataset))}".removesuffix(" -")


def _print_branch(dataset: xr.Dataset, i: int) -> None:
    mine = np.flatnonzero(dataset.branch.values == i)
    values, stable = dataset[parameter_of(dataset)].values[mine], int(dataset.stable.values[mine].sum())
    multiple = int(dataset.period_multiple.values[mine[0]])
    ends = f"{dataset.branch_first_end.values[i]}, {dataset.branch_last_end.values[i]}"
    echo(
        f"branch {i}: period multiple {multiple}, {mine.size} points, {stable} stable, "
        f"from {values.min():.6g} to {values.max():.6g}{_unit(dataset)}; ends: {ends}"
    )
    for j in np.flatnonzero(dataset.bifurcation_branch.values == i):
        echo(f"  {bifurcation_text(dataset, int(j))}")


def _print_ends_without_motion(dataset: xr.Dataset) -> None:
    """Print the ends of the range that no branch reaches, although a march from rest was made there."""
    values, most = dataset[parameter_of(dataset)].values, int(dataset.attrs["max_period_multiple"])
    repeats = "each excitation period" if most == 1 else f"{most} excitation periods or fewer"
    unit = _unit(dataset)
    missing = int(dataset.left_out.sum()) or int(dataset.sizes.get("failure", 0))
    for end in np.asarray(dataset.attrs["range"]) if values.size and not missing else ():
        if np.abs(values - end).min() > _AT_END * max(abs(end), np.ptp(dataset.attrs["range"])):
            echo(
                f"no branch comes to {end:.6g}{unit}: from rest, no motion that repeats after {repeats} was found there"
            )


def _print_loci(dataset: xr.Dataset) -> None:
    """Print each locus in a line with both its ends, the longest first."""
    second = dataset[second_parameter_of(dataset)]
    locus, at, value = (dataset[f"bifurcation_{name}"].values for name in ("locus", "also_over", "value"))
    found = "loci:" if locus.size else "no bifurcations"
    echo(f"{dataset.branch_first_end.size} branches at {second.size} values of {second.attrs['path']}; {found}")
    unit, also = _unit(dataset), _unit(dataset, str(second.name))
    numbers, counts = np.unique(locus, return_counts=True)
    for shown, k in enumerate(np.argsort(-counts, kind="stable")):
        if shown == ROWS_SHOWN:
            echo(f"  ... and {numbers.size - shown} more, in the file")
            return
        mine = np.flatnonzero(locus == numbers[k])
        mine = mine[np.argsort(at[mine], kind="stable")]
        ends = " to ".join(f"{value[j]:.6g}{unit} at {at[j]:.6g}{also}" for j in dict.fromkeys((mine[0], mine[-1])))
        echo(f"  {locus_name(dataset, int(mine[0]))}, {mine.size} of {second.size} values: {ends}")


def _print_what_is_missing(dataset: xr.Dataset) -> None:
    left = int(dataset.left_out.sum())
    if left:
        motions = "1 motion" if left == 1 else f"{left} motions"
        echo(f"effort = {dataset.attrs['effort']} is spent: the branches of {motions} were not followed")
    for i in range(int(dataset.sizes.get("uncovered", 0))):
        echo(_uncovered_text(dataset, i))
    echo(_unknown_text(dataset))
    for reason in dataset.failure_message.values if "failure_message" in dataset else ():
        echo(f"not followed: {reason}")


def _uncovered_text(dataset: xr.Dataset, i: int) -> str:
    """A part of the range that no branch covers, in a sentence."""
    first, last = (float(dataset[f"uncovered_{name}"].values[i]) for name in ("from", "to"))
    also = second_parameter_of(dataset)
    at = "" if also is None else f"{float(dataset.uncovered_also_over.values[i]):.6g}{_unit(dataset, also)}"
    where = f" at {also} = {at}" if at else ""
    why = str(dataset.uncovered_why.values[i])
    return f"no branch covers {first:.9g} to {last:.9g}{_unit(dataset)}{where}" + (f" ({why})" if why else "")


def _unknown_text(dataset: xr.Dataset) -> str:
    """How likely an unknown branch is, in a sentence; with a second parameter, on average over its values."""
    from lapjoint.campaigns.branches.unknown import Reached

    if not int(dataset.attrs["starts"]):
        return "no random starts were made, which would tell how likely a further branch is: see --starts"
    also = second_parameter_of(dataset)
    where = "" if also is None else f" at each of {dataset[also].size} values of {dataset[also].attrs['path']}"
    starts, branches, alone = (int(dataset[f"starts_{name}"].sum()) for name in ("stable", "branches", "alone"))
    reached = Reached(starts, branches, alone)
    first = f"{_counted(int(dataset.attrs['starts']), 'random start')}{where}: {starts} led to stable motions"
    if reached.probability is None:
        return f"{first}, so that nothing is known of further branches"
    return (
        f"{first} on {_counted(branches, 'branch', 'es')}, to {alone or 'none'} of which nothing else led; another one "
        f"that leads to a stable motion would find an unknown branch with a probability of about "
        f"{100 * reached.probability:.2g} % (95 %: below {100 * reached.bound:.2g} %)"
    )


def _counted(count: int, name: str, ending: str = "s") -> str:
    return f"{count} {name}{'' if count == 1 else ending}"


def bifurcation_text(dataset: xr.Dataset, j: int) -> str:
    """Bifurcation `j` in a line: value, error and name; for a graze also the stop, and how the branch continues."""
    value, error = float(dataset.bifurcation_value[j]), float(dataset.bifurcation_error[j])
    stated = f" ± {error:.1g}" if math.isfinite(error) else ""
    after = str(dataset.bifurcation_after.values[j])
    text = f"{value:.9g}{stated}{_unit(dataset)}  {bifurcation_name(dataset, j)}" + (f": {after}" if after else "")
    asked = bool(dataset.attrs["errors"])
    return text if stated or not asked else f"{text} (not confirmed by the finer solver)"
