"""What the command line prints of branches."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lapjoint.campaigns.branch_dataset import KINDS
from lapjoint.cli.echo import echo

if TYPE_CHECKING:
    import xarray as xr


def print_branches(dataset: xr.Dataset) -> None:
    """Print each branch in a line, with its bifurcations below.

    Parameters
    ----------
    dataset : xarray.Dataset
        The dataset of branches.
    """
    name = next(str(key) for key, value in dataset.variables.items() if value.attrs.get("path"))
    numbers = dataset.branch_first_end.size
    if not numbers:
        echo("no periodic motion was found from any start")
    for i in range(numbers):
        mine = np.flatnonzero(dataset.branch.values == i)
        values, stable = dataset[name].values[mine], int(dataset.stable.values[mine].sum())
        multiple = int(dataset.period_multiple.values[mine[0]])
        ends = f"{dataset.branch_first_end.values[i]}, {dataset.branch_last_end.values[i]}"
        echo(
            f"branch {i}: period multiple {multiple}, {mine.size} points, {stable} stable, "
            f"from {values.min():.6g} to {values.max():.6g}; ends: {ends}"
        )
        for j in np.flatnonzero(dataset.bifurcation_branch.values == i):
            echo(f"  {bifurcation_text(dataset, int(j))}")


def bifurcation_text(dataset: xr.Dataset, j: int) -> str:
    """A bifurcation in a line.

    Parameters
    ----------
    dataset : xarray.Dataset
        The dataset of branches.
    j : int
        Which bifurcation.

    Returns
    -------
    str
        Its value with its error, its name and, of a graze, the stop.
    """
    value, error = float(dataset.bifurcation_value[j]), float(dataset.bifurcation_error[j])
    text = f"{value:.9g} ± {error:.1g}  {KINDS[int(dataset.bifurcation_kind[j])]}"
    stop = int(dataset.bifurcation_stop[j])
    if stop >= 0:
        text += f" of {dataset.stop_name.values[stop]}: {dataset.bifurcation_after.values[j]}"
    return text
