"""What a curve of a sweep shows: its peaks, its jumps from one motion to another, and where it exceeds a limit.

The values are known at the points of the grid only.  A peak therefore has an error along the axis, the distance to the
farther of the two points beside it, and a jump lies somewhere between two points.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from lapjoint.figures.impulse_curve import ERRATIC, in_pieces, motion_kinds
from lapjoint.figures.sweep_axes import fields
from lapjoint.files.flags import flag_names
from lapjoint.problem import FloatArray

if TYPE_CHECKING:
    import xarray as xr

STANDS_OUT = 0.05
"""Least height of a peak above the higher of the valleys beside it, divided by the largest magnitude of the curve: a
lower one would hardly be seen in the figure."""


@dataclass(frozen=True)
class Peak:
    """A largest magnitude of a curve among the points around it."""

    place: float
    """The swept value, in its unit."""
    error: float
    """Distance to the farther of the neighbouring points: a smooth curve has its peak within it; NaN at the end of the
    range, beyond which the curve may rise further."""
    value: float
    """The value of the curve there, in the unit of the variable; between the points the curve may be higher."""
    value_error: float
    """Estimate of the numerical error of the value; NaN if none was estimated."""


@dataclass(frozen=True)
class Jump:
    """Two neighbouring points at which the motions differ."""

    before: float
    after: float
    """The swept values of the points, in their unit."""
    motions: tuple[str, str]
    """The motions, in words."""
    curve: int
    """Index of the curve whose value changes most."""
    values: tuple[float, float]
    """The values of this curve at the points."""


def peaks_of(x: FloatArray, y: FloatArray, errors: FloatArray | None = None) -> list[Peak]:
    """The peaks of a curve `y` over ascending `x`, (n,) each, with its numerical `errors`: the largest first.

    The largest value is always among the peaks, even at an end of the range.
    """
    from scipy.signal import find_peaks

    size = np.where(np.isfinite(y), np.abs(y), 0.0)
    if x.size < 2 or not size.any():
        return []
    found = find_peaks(size, prominence=STANDS_OUT * size.max())[0].tolist()
    if not any(size[i] == size.max() for i in found):
        found.append(int(np.argmax(size)))
    known = np.full(x.size, np.nan) if errors is None else errors
    to_next, to_last = np.append(np.diff(x), np.nan), np.append(np.nan, np.diff(x))
    peaks = [Peak(float(x[i]), float(np.maximum(to_next[i], to_last[i])), float(y[i]), float(known[i])) for i in found]
    return sorted(peaks, key=lambda peak: -abs(peak.value))


def jumps_of(dataset: xr.Dataset, curves: list[FloatArray]) -> list[Jump]:
    """The jumps of the curves, (n,) each, of a dataset with one swept field: where the lines of the figure break.

    Between two points at which nothing repeats there is no jump: nothing shows that their motions differ.
    """
    x, kinds = dataset[fields(dataset)[0]].values, motion_kinds(dataset).values
    words = motions_of(dataset)
    edges = {piece.start for y in curves for piece in in_pieces(y, kinds)} if curves else set()
    found = []
    for i in sorted(edges - {0}):
        pair = kinds[i - 1 : i + 1]
        if np.isnan(pair).any() or (pair == ERRATIC).all():
            continue
        steps = [abs(y[i] - y[i - 1]) for y in curves]
        most = int(np.argmax(steps))
        values = float(curves[most][i - 1]), float(curves[most][i])
        found.append(Jump(float(x[i - 1]), float(x[i]), (words[i - 1], words[i]), most, values))
    return found


def motions_of(dataset: xr.Dataset) -> list[str]:
    """The motion at each point in words: ``periodic, 2 periods``, ``no contact``, ``aperiodic``, ``failed``."""
    names, words = flag_names(dataset.outcome.attrs), []
    columns = (dataset[name].values.tolist() for name in ("outcome", "period_multiple", "symmetric"))
    for code, multiple, mirrors in zip(*columns, strict=True):
        words.append(motion_words(names[code], multiple, mirrors))
    return words


def motion_words(outcome: str, multiple: int, mirrors: bool) -> str:
    """A motion in words; `multiple` is its period multiple, 0 if it does not repeat."""
    repeats = f", {multiple} period{'s' * (multiple > 1)}" if multiple else ""
    word = outcome.replace("_", " ")
    plain = word == "no contact" and multiple == 1
    return word if plain else word + repeats + ", symmetric" * bool(multiple and mirrors)


def exceeding(x: FloatArray, y: FloatArray, limit: float) -> tuple[int, list[tuple[float, float]]]:
    """The number of points at which the magnitude of a curve exceeds a limit, and the first and last swept value of
    each run of such points."""
    beyond: npt.NDArray[np.bool_] = np.abs(np.nan_to_num(y)) > limit
    edges = np.flatnonzero(np.diff(np.concatenate([[0], beyond.astype(int), [0]])))
    return int(beyond.sum()), [(float(x[a]), float(x[b - 1])) for a, b in list(pairwise(edges))[::2]]
