"""Basins as the command line shows them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lapjoint.cli.echo import echo
from lapjoint.figures.basin_names import motion_names

if TYPE_CHECKING:
    import xarray as xr

ROWS_SHOWN = 20


def print_basins(found: xr.Dataset) -> None:
    """Print the fraction of starts that end in each motion, for each value of the varied parameter."""
    own = {"first", "second", "start"}
    over = [str(name) for name in found.motion.dims if name not in own]
    starts = found.motion.size // (found.sizes[over[0]] if over else 1)
    echo(f"{starts} starts; share of each motion, with its 95 % interval:")
    for i in range(found.sizes[over[0]] if over else 1):
        one = found.isel({over[0]: i}) if over else found
        if over:
            echo(f"{found[over[0]].attrs['long_name']} = {float(one[over[0]]):.6g} {found[over[0]].attrs['units']}")
        _print_shares(one)


def _print_shares(one: xr.Dataset) -> None:
    """Print the fraction of starts that end in each motion, of one problem."""
    shown = 0
    for name, kind in (("", "motion"), ("unbound_", "unbound")):
        labels = motion_names(one) if kind == "motion" else [str(text) for text in one.unbound.values]
        for i, label in enumerate(labels):
            count = int(one[f"{name}count"].values[i])
            if kind == "unbound" and not count:
                continue
            if shown == ROWS_SHOWN:
                echo("  ... and more, in the file")
                return
            shown += 1
            share, low, high = (float(one[f"{name}fraction{end}"].values[i]) for end in ("", "_low", "_high"))
            echo(f"  {100 * share:7.3f} %  [{100 * low:.3f}, {100 * high:.3f}]  {label}")
