"""Power spectral density of a motion, by Welch's method, with its 95 % interval.

The motion is cut into segments that overlap by half, and the mean of each is subtracted.  The squared transforms of the
segments, each under a Hann window, are averaged.  Averages of a stationary Gaussian motion have nearly a chi-square
distribution (P. D. Welch, IEEE Transactions on Audio and Electroacoustics 15, 1967, 70-73); segments that overlap by
half under a Hann window share 1/36 of their variance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.answers import History
from lapjoint.errors import InputError
from lapjoint.figures.sampling import heading
from lapjoint.figures.spectrum import most_moved
from lapjoint.figures.style import COLOURS, entitle, faint_if_thin, new_axes, style
from lapjoint.problem import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SEGMENTS = 15
"""Default number of segments: eight side by side, and those between them; the interval is then some 2 dB wide."""
_SHARED = 1 / 36
"""Squared correlation of two segments under a Hann window that overlap by half, with neglect of the ends."""
_LEVEL = 0.95
"""Probability that the interval contains the density."""
_FEWEST, _MOST = 2**9, 2**22
"""First number of samples of a segment, and the number of samples in all above which they are not made denser."""
_DENSER = 1.6
"""Factor by which samples are made denser: with a whole number, a line could fold back to one place each time."""
_CHANGE, _LARGE = 0.01, 1e-3
"""Largest relative change of the density as samples are made denser, where it is larger than a fraction of its
largest value: far less than the interval is wide."""
_LEFT_OUT = 1e-6
"""Fraction of the mean square at frequencies too high to be drawn."""
_DECADES = 9
"""Number of decades below the largest density at which the axis ends."""


@dataclass(frozen=True)
class PowerDensity:
    """One-sided power spectral density."""

    frequencies: FloatArray
    """Hz, ascending from one step, shape ``(n,)``."""
    density: FloatArray
    """m2/Hz of a displacement, shape ``(n,)``."""
    interval: tuple[float, float]
    """Ends of the 95 % interval, as factors of the density."""
    segments: int
    """Number of segments."""
    segment: float
    """Duration of a segment, s."""


@style()
def plot_psd(
    history: History,
    axes: Axes | None = None,
    *,
    x: float | None = None,
    highest: float | None = None,
    segments: int = SEGMENTS,
    label: str | None = None,
) -> Axes:
    """Draw the power spectral density of the displacement at one position, with its 95 % interval.

    The interval is that of a stationary Gaussian motion.  The whole history counts, its beginning too.

    Parameters
    ----------
    history : History
        The motion.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    x : float, optional
        Position, m; by default that which moves most.
    highest : float, optional
        Highest frequency drawn, Hz; by default the highest below which all but a millionth of the mean square lies.
    segments : int
        Number of segments that overlap by half: more make the interval narrower, and the steps in frequency wider.
    label : str, optional
        Name of the curve in the legend, before its position.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, frequency in Hz and density in m2/Hz.

    Raises
    ------
    InputError
        If the position is outside the beam, or a number is not positive.
    """
    place = most_moved(history) if x is None else history.problem.position(x)
    found = power_density(history, place, segments, highest)
    axes = new_axes(height=2.6) if axes is None else axes
    where = f"x = {history.problem.line.place(place)} m"
    colour = COLOURS[len(axes.lines) % len(COLOURS)]
    f, density = found.frequencies, found.density
    axes.plot(f, density, color=colour, linestyle="-", linewidth=0.9, label=f"{label}, {where}" if label else where)
    low, high = found.interval
    axes.fill_between(f, low * density, high * density, **faint_if_thin(colour, 0.25))
    if np.any(density > 0):
        axes.set_yscale("log")
        top = float(np.max(density))
        axes.set_ylim(max(0.3 * float(np.min(density)), top * 10.0**-_DECADES), 5 * top)
    axes.set_xlim(0.0, float(f[-1]))
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel("density of z [m²/Hz]")
    how = f"Welch, {found.segments} segments of {found.segment:.4g} s, 95 % interval"
    entitle(axes, f"{heading(history)}\n{how}" if label is None else "")
    return axes


def power_density(history: History, x: float, segments: int = SEGMENTS, highest: float | None = None) -> PowerDensity:
    """The density of the displacement at a position, m, up to a frequency, Hz; see `plot_psd`."""
    if segments < 1:
        raise InputError(f"segments = {segments}: must be 1 or more")
    if highest is not None and not 0 < highest < math.inf:
        raise InputError(f"highest = {highest:g}: must be positive and finite, in Hz")
    duration = history.end - history.start
    if not duration > 0:
        raise InputError(f"history: runs from {history.start:g} to {history.end:g} s; a density needs a duration")
    each, before = _FEWEST, None
    while True:
        found = _welch(history, x, segments, each)
        if before is not None and found[0, -1] >= 2 * (highest or 0.0) and _settled(before, found):
            break
        each, before = 2 * round(_DENSER / 2 * each), found
        if each * (segments + 1) > 2 * _MOST:
            break
    last = _last(found) if highest is None else int(np.searchsorted(found[0], highest, side="right"))
    from scipy.stats import chi2

    freedom = 2 * segments / (1 + 2 * _SHARED * (segments - 1) / segments)
    ends = freedom / chi2.ppf([(1 + _LEVEL) / 2, (1 - _LEVEL) / 2], freedom)
    f, density = found[:, : max(last, 2)]
    return PowerDensity(f, density, (float(ends[0]), float(ends[1])), segments, 2 * duration / (segments + 1))


def _welch(history: History, x: float, segments: int, each: int) -> FloatArray:
    """Frequencies, Hz, without 0, and the density there, shape (2, each / 2), with `each` samples in a segment."""
    from scipy.signal import welch

    samples = each * (segments + 1) // 2
    t = np.linspace(history.start, history.end, samples, endpoint=False)
    rate = samples / (history.end - history.start)
    f, density = welch(history.displacement(x, t)[0], rate, "hann", each, each // 2, detrend="constant")
    return np.array([f[1:], density[1:]])


def _settled(before: FloatArray, now: FloatArray) -> bool:
    """Whether the density has changed little where it is large, although the motion was sampled more densely.

    The upper half of the frequencies does not count: faster motion is folded back there first.
    """
    count = before.shape[1] // 2
    first, second = before[1, :count], now[1, :count]
    large = second > _LARGE * np.max(now[1])
    folded = np.sum(now[1, count:]) > _LEFT_OUT * np.sum(now[1])
    return not folded and bool(np.all(np.abs(first - second)[large] <= _CHANGE * second[large]))


def _last(found: FloatArray) -> int:
    """The number of frequencies below which all of the mean square lies but `_LEFT_OUT`."""
    total = np.cumsum(found[1])
    return int(np.searchsorted(total, (1 - _LEFT_OUT) * total[-1])) + 1
