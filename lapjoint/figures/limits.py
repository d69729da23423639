"""Lines at which the magnitude of a variable reaches a limit, named in the legend."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.figures.sweep_variables import unit_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

DASHES = (0, (5, 2, 1, 2, 1, 2))
"""Line pattern of limits, which no curve has."""


def draw_limits(axes: Axes, dataset: xr.Dataset, variable: str, limits: Sequence[float], exponent: int) -> None:
    """Draw a line at each of the `limits`, magnitudes in the variable's SI unit, on the sides of zero that have values.

    The axes show the variable in its unit with a prefix of ten to the `exponent`.
    """
    drawn = [np.asarray(line.get_ydata(), dtype=float) for line in axes.lines]
    sides = [sign for sign in (1.0, -1.0) if any(np.any(sign * y > 0) for y in drawn)] or [1.0]
    for number, limit in enumerate(limits):
        shown = limit / 10.0**exponent
        label = limit_text(dataset, variable, limit, exponent)
        for sign in sides:
            name = label if sign == sides[0] else None
            axes.axhline(sign * shown, color="black", linestyle=DASHES, linewidth=0.7 + 0.5 * number, label=name)


def limit_text(dataset: xr.Dataset, variable: str, limit: float, exponent: int) -> str:
    """A limit with its unit, as figures name it: ``limit 120 MPa``."""
    return f"limit {limit / 10.0**exponent:.6g} {unit_of(dataset, variable, exponent)}".removesuffix(" 1")
