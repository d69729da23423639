"""Names of the motions of basins, from period multiple and impulse."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

_DIGITS = (4, 6, 9)
"""Numbers of significant digits of an impulse in a name; the first that gives each motion another name is used."""


def motion_names(one: xr.Dataset, numbered: bool = True) -> list[str]:
    """A name for each motion of one problem, with the impulse of the stop that differs most: ``1 period, P4 0.5 N s``.

    With `numbered`, each name begins with the motion's number, from 1, and a mirror image names its original.
    """
    count = int((one.period_multiple.values > 0).sum())
    for digits in _DIGITS:
        names = [_name(one, i, digits) for i in range(count)]
        if max(Counter(names).values(), default=1) == 1:
            break
    if not numbered:
        return names
    twins = one.twin.values
    images = [f" (mirror image of {int(twins[i]) + 1})" if 0 <= twins[i] < i else "" for i in range(count)]
    return [f"{i + 1}: {names[i]}{images[i]}" for i in range(count)]


def _name(one: xr.Dataset, i: int, digits: int) -> str:
    multiple = int(one.period_multiple.values[i])
    name = f"{multiple} period" + "s" * (multiple > 1)
    impulses = one.impulse.values[: int((one.period_multiple.values > 0).sum())]
    if not impulses.shape[1] or not np.any(impulses[i]):
        name += ", no contact"
    else:
        stop = int(np.argmax(np.ptp(impulses, axis=0))) if len(impulses) > 1 else int(np.argmax(np.abs(impulses[i])))
        name += f", {one.stop_name.values[stop]} {impulses[i, stop]:.{digits}g} N s"
    return name
