"""Amplitude spectra: Fourier coefficients of a motion that repeats, or a windowed transform of any other motion.

A motion that repeats after n excitation periods is a sum of lines at the multiples of omega / n.  Their amplitudes are
Fourier coefficients, computed by the discrete transform of one repetition, without a window, and exact except for
aliasing.  The number of samples is doubled until no drawn amplitude changes by more than `TOLERANCE` of the largest.

For any other motion, the weighted mean is subtracted, and the whole history is multiplied by a Hann window.  The
transform is scaled so that the peak of a single sine has the amplitude of the sine.  Two lines merge if their angular
frequencies differ by less than 4 pi, divided by the history's duration.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.answers import History
from lapjoint.errors import InputError
from lapjoint.figures.sampling import heading, times_drawn
from lapjoint.figures.style import COLOURS, GREY, THIN, entitle, new_axes, style
from lapjoint.figures.text import hertz
from lapjoint.problem import FloatArray, Problem

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TOLERANCE = 1e-7
"""Largest sampling error of the drawn amplitudes, divided by the largest amplitude; far below the resolution of a
plot."""
REPEATS = 1e-3
"""Largest distance between the states at both ends of a repetition, divided by the motion's size, for a motion that
counts as repeating."""
DECADES = 6.5
"""Number of decades below the largest amplitude at which the axis ends, just above `TOLERANCE`."""
_EXCITATION = "excitation"
_HARMONICS = 20
"""Least default number of multiples of the excitation frequency that are drawn."""
_FEWEST, _MOST = 2**10, 2**18
"""First number of samples of the transform, and the number above which it is not doubled again."""

_STATIONS = 33
"""Number of positions among which the one with the largest motion is chosen."""


@dataclass(frozen=True)
class Spectrum:
    """Amplitudes over angular frequency."""

    angular_frequencies: FloatArray
    """rad/s, ascending from 0, shape ``(n,)``."""
    amplitudes: FloatArray
    """Amplitudes of the displacement, m, shape ``(n,)``; the first is the modulus of the mean."""
    periods: int
    """Number of excitation periods after which the motion repeats; 0 for a windowed transform."""
    mismatch: float
    """Distance between the states at both ends of the repetition, divided by the motion's size; NaN for a windowed
    transform."""


@style()
def plot_spectrum(
    history: History,
    axes: Axes | None = None,
    *,
    x: float | None = None,
    harmonics: int | None = None,
    label: str | None = None,
) -> Axes:
    """Draw the amplitude spectrum of the displacement at one position; the module's head says how it is computed.

    If the end of the history repeats after a whole number of excitation periods, the lines are the Fourier coefficients
    of the last repetition, and the title gives this number.

    Parameters
    ----------
    history : History
        The motion; for a steady state, its ``history``.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    x : float, optional
        Position, m; by default `most_moved`.  The legend names the position.
    harmonics : int, optional
        Largest drawn multiple of the excitation frequency or, if the excitation has no period, of the frequency with
        the largest amplitude.  By default 20, or twice the largest multiple in the excitation if that is more.
    label : str, optional
        Name of the spectrum in the legend, before its position.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, frequency in Hz and amplitude in mm.

    Raises
    ------
    InputError
        If the position is outside the beam, `harmonics` less than 1, or the history has no duration.
    """
    place = most_moved(history) if x is None else history.problem.position(x)
    found = spectrum(history, place, _default_harmonics(history.problem) if harmonics is None else harmonics)
    axes = new_axes(height=2.6) if axes is None else axes
    frequency, amplitude = found.angular_frequencies / (2 * math.pi), 1e3 * found.amplitudes
    floor = float(np.max(amplitude)) * 10.0**-DECADES
    where = f"x = {history.problem.line.place(place)} m"
    name = f"{label}, {where}" if label else where
    earlier = [line for line in axes.lines if not str(line.get_label()).startswith(_EXCITATION)]
    colour = COLOURS[len(earlier) % len(COLOURS)]
    if found.periods:
        axes.plot(frequency, amplitude, linestyle="", marker="o", color=colour, label=name)
        axes.vlines(frequency, floor, np.maximum(amplitude, floor), color=colour, linewidth=1.0)
    else:
        axes.plot(frequency, amplitude, color=colour, linestyle="-", linewidth=0.9, label=name)
    _mark_excitation(axes, history.problem.excitation_frequency)
    _scale(axes, amplitude, floor)
    axes.set_xlim(-0.01 * frequency[-1], 1.01 * frequency[-1])
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel("amplitude of z [mm]")
    entitle(axes, f"{heading(history)}\n{_how(history, found)}" if label is None else "")
    return axes


def most_moved(history: History) -> float:
    """The position, m, out of `_STATIONS` equidistant positions, whose displacement has the largest standard deviation.

    If several differ by rounding alone, it is the position farthest from the root.
    """
    _require_duration(history)
    x = history.problem.line.grid(_STATIONS)
    swing = np.std(history.displacement(x, times_drawn(history, _FEWEST)), axis=1)
    return float(x[np.flatnonzero(swing >= (1 - TOLERANCE) * np.max(swing))[-1]])


def _require_duration(history: History) -> None:
    if not history.end > history.start:
        raise InputError(f"history: runs from {history.start:g} to {history.end:g} s; a spectrum needs a duration")


def _default_harmonics(problem: Problem) -> int:
    """The largest multiple of the excitation frequency that is drawn by default."""
    omega = problem.excitation_frequency
    return _HARMONICS if omega is None else max(_HARMONICS, 2 * round(problem.forces.fastest / omega))


def _scale(axes: Axes, amplitude: FloatArray, floor: float) -> None:
    """Scale the axis logarithmically from `floor`, mm; a beam at rest has no amplitudes, and gets a line at zero."""
    if floor > 0:
        axes.set_yscale("log")
        axes.set_ylim(floor, 3 * float(np.max(amplitude)))
    elif axes.get_yscale() == "linear":
        axes.set_ylim(-1.0, 1.0)
        axes.set_yticks([0.0])
        axes.text(0.5, 0.6, "at rest", transform=axes.transAxes, ha="center", color=GREY)


def spectrum(history: History, x: float, harmonics: int) -> Spectrum:
    """The amplitude spectrum of the displacement at one position, up to a multiple of the excitation frequency."""
    if harmonics < 1:
        raise InputError(f"harmonics = {harmonics}: must be 1 or more")
    _require_duration(history)
    periods, mismatch = repeating_periods(history)
    if periods:
        return _fourier(history, x, periods, mismatch, harmonics * periods + 1)
    return _windowed(history, x, harmonics)


def repeating_periods(history: History) -> tuple[int, float]:
    """The least number of excitation periods after which the end of a history repeats, or 0, and the mismatch.

    The state is displacement and velocity at some points of the beam, each divided by its largest value at this point.
    If the state returns at one phase of the excitation, the whole later motion repeats.
    """
    omega = history.problem.excitation_frequency
    whole = 0 if omega is None else math.floor((history.end - history.start) * omega / (2 * math.pi) + 1e-9)
    if omega is None or whole == 0:
        return 0, math.nan
    times = np.maximum(history.end - 2 * math.pi / omega * np.arange(whole + 1), history.start)
    x = history.problem.line.grid(7)
    period = np.linspace(times[1], times[0], 200)
    off = np.zeros(whole + 1)
    for values, size in (
        (history.displacement(x, times), history.displacement(x, period)),
        (history.velocity(x, times), history.velocity(x, period)),
    ):
        off = np.maximum(off, np.max(np.abs(values - values[:, :1]), axis=0) / (np.max(np.abs(size)) or 1.0))
    found = np.flatnonzero(off[1:] <= REPEATS)
    return (int(found[0]) + 1, float(off[found[0] + 1])) if found.size else (0, math.nan)


def _fourier(history: History, x: float, periods: int, mismatch: float, count: int) -> Spectrum:
    """The moduli of the first `count` Fourier coefficients of the last `periods` excitation periods."""
    omega = float(history.problem.excitation_frequency or math.nan)
    start = max(history.end - 2 * math.pi / omega * periods, history.start)
    samples, amplitudes = max(_FEWEST, 2 ** math.ceil(math.log2(4 * count))), np.full(count, np.inf)
    while True:
        t = np.linspace(start, history.end, samples, endpoint=False)
        before, amplitudes = amplitudes, _amplitudes(history.displacement(x, t)[0], np.ones(samples))[:count]
        samples *= 2
        if np.max(np.abs(amplitudes - before)) <= TOLERANCE * np.max(amplitudes) or samples > _MOST:
            return Spectrum(np.arange(float(count)) * (omega / periods), amplitudes, periods, mismatch)


def _windowed(history: History, x: float, harmonics: int) -> Spectrum:
    """The Hann-windowed transform of the whole history."""
    step = 2 * math.pi / (history.end - history.start)  # rad/s
    base = history.problem.excitation_frequency
    if base is None:
        _, first = _hann(history, x, 4 * _FEWEST)
        base = step * max(1, int(np.argmax(first[1:])) + 1)
    count = max(2, math.ceil(harmonics * base / step) + 1)
    samples, amplitudes = max(_FEWEST, 2 ** math.ceil(math.log2(4 * count))), np.full(count, np.inf)
    while True:
        before, (_, every) = amplitudes, _hann(history, x, samples)
        amplitudes = every[:count]
        samples *= 2
        if np.max(np.abs(amplitudes - before)) <= TOLERANCE * np.max(amplitudes) or samples > max(_MOST, 16 * count):
            return Spectrum(np.arange(float(count)) * step, amplitudes, 0, math.nan)


def _hann(history: History, x: float, samples: int) -> tuple[float, FloatArray]:
    """The weighted mean, m, and the amplitudes, m, shape ``(samples // 2 + 1,)``, with the mean's modulus first."""
    z = history.displacement(x, np.linspace(history.start, history.end, samples, endpoint=False))[0]
    window = 0.5 - 0.5 * np.cos(2 * math.pi * np.arange(samples) / samples)
    mean = float(window @ z / window.sum())
    amplitudes = _amplitudes(z - mean, window)
    amplitudes[0] = abs(mean)
    return mean, amplitudes


def _amplitudes(z: FloatArray, window: FloatArray) -> FloatArray:
    """Moduli of the one-sided transform of `z`, shape ``(n,)``, scaled to amplitudes, m, shape ``(n // 2 + 1,)``."""
    amplitudes: FloatArray = 2 * np.abs(np.fft.rfft(window * z)) / window.sum()
    amplitudes[0] /= 2
    return amplitudes


def _mark_excitation(axes: Axes, omega: float | None) -> None:
    if omega is None:
        return
    label = f"{_EXCITATION}, {hertz(omega)} Hz"
    if label not in {str(line.get_label()) for line in axes.lines}:
        axes.axvline(omega / (2 * math.pi), color=GREY, linewidth=THIN, linestyle=(0, (4, 3)), zorder=1, label=label)


def _how(history: History, found: Spectrum) -> str:
    if not found.periods:
        return f"Hann window over {history.end - history.start:.4g} s"
    duration = "1 period" if found.periods == 1 else f"{found.periods} periods"
    return f"Fourier series of {duration}, repeating to {found.mismatch:.1g}"
