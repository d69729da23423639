"""Amplitude spectra: the Fourier coefficients of a motion that repeats, or a windowed transform of one that does not.

A motion of n excitation periods that repeats is a sum of lines at the multiples of omega / n.  Their amplitudes are
Fourier coefficients, which the discrete transform of one whole span, without a window, gives but for aliasing; the
number of samples is doubled until none of those drawn changes by more than `TOLERANCE` of the largest.

Any other motion is seen through a Hann window over the whole history, after its weighted mean is taken off, and scaled
so that a sine far from its neighbours has a peak of its own amplitude; lines closer than 4 pi over the history's
duration run into one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.answers import History
from lapjoint.errors import InputError
from lapjoint.figures.sampling import heading, one_position
from lapjoint.figures.style import COLOURS, GREY, THIN, entitle, new_axes, style
from lapjoint.problem import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TOLERANCE = 1e-7
"""Of the largest amplitude: the sampling error of those drawn."""
REPEATS = 1e-3
"""Of the motion's size: how well its state must return for the motion to be taken as repeating."""
DECADES = 6.5
"""How far below the largest amplitude the axis goes."""
_EXCITATION = "excitation"
_FEWEST, _MOST = 2**10, 2**18  # samples


@dataclass(frozen=True)
class Spectrum:
    """Amplitudes over angular frequency."""

    angular_frequencies: FloatArray
    """rad/s, ascending from 0, shape ``(n,)``."""
    amplitudes: FloatArray
    """Of the displacement, m, shape ``(n,)``; the first is the modulus of the mean."""
    periods: int
    """Excitation periods that repeat, whose Fourier coefficients these are; 0: a windowed transform."""
    mismatch: float
    """How far from its start the span ends, relative to the motion's size; NaN for a windowed transform."""


@style()
def plot_spectrum(
    history: History,
    axes: Axes | None = None,
    *,
    x: float | None = None,
    harmonics: int = 20,
    label: str | None = None,
) -> Axes:
    """Amplitude spectrum of the displacement at one position; see the module's head for how it is computed.

    Where the end of the history repeats after some whole number of excitation periods, the lines are the Fourier
    coefficients of the last such span, and the title says how many periods it has.

    Parameters
    ----------
    history : History
        The motion; of a steady state its ``history``.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    x : float, optional
        Position, m; by default the tip.
    harmonics : int
        Up to which multiple of the excitation frequency to draw; of the largest line's frequency where the excitation
        has not one frequency.
    label : str, optional
        Name of the spectrum in the key; by default the position.

    Raises
    ------
    InputError
        If the position is outside the beam, `harmonics` less than 1, or the history has no duration.
    """
    place = one_position(history.problem, history.problem.beam.length if x is None else x)
    found = spectrum(history, place, harmonics)
    axes = new_axes(height=2.6) if axes is None else axes
    omega, amplitude = found.angular_frequencies, 1e3 * found.amplitudes
    floor = float(np.max(amplitude)) * 10.0**-DECADES
    name = label or f"x = {place:g} m"
    earlier = [line for line in axes.lines if not str(line.get_label()).startswith(_EXCITATION)]
    colour = COLOURS[len(earlier) % len(COLOURS)]
    if found.periods:
        axes.plot(omega, amplitude, linestyle="", marker="o", color=colour, label=name)
        axes.vlines(omega, floor, np.maximum(amplitude, floor), color=colour, linewidth=1.0)
    else:
        axes.plot(omega, amplitude, color=colour, linestyle="-", linewidth=0.9, label=name)
    _mark_excitation(axes, history.problem.excitation_frequency)
    _scale(axes, amplitude, floor)
    axes.set_xlim(-0.01 * omega[-1], 1.01 * omega[-1])
    axes.set_xlabel("angular frequency [rad/s]")
    axes.set_ylabel("amplitude of z [mm]")
    entitle(axes, f"{heading(history)}\n{_how(history, found)}" if label is None else "")
    return axes


def _scale(axes: Axes, amplitude: FloatArray, floor: float) -> None:
    """Logarithmic from `floor` on; of a beam at rest, which has no amplitudes, a line at zero that is called so."""
    if floor > 0:
        axes.set_yscale("log")
        axes.set_ylim(floor, 3 * float(np.max(amplitude)))
    elif axes.get_yscale() == "linear":
        axes.set_ylim(-1.0, 1.0)
        axes.set_yticks([0.0])
        axes.text(0.5, 0.6, "at rest", transform=axes.transAxes, ha="center", color=GREY)


def spectrum(history: History, x: float, harmonics: int) -> Spectrum:
    """The amplitudes at position `x`, m, up to `harmonics` times the excitation frequency; see the module's head.

    Raises
    ------
    InputError
        If `harmonics` is less than 1, or the history has no duration.
    """
    if harmonics < 1:
        raise InputError(f"harmonics = {harmonics}: must be 1 or more")
    if not history.end > history.start:
        raise InputError(f"history: runs from {history.start:g} to {history.end:g} s; a spectrum needs a duration")
    periods, mismatch = repeating_periods(history)
    if periods:
        return _fourier(history, x, periods, mismatch, harmonics * periods + 1)
    return _windowed(history, x, harmonics)


def repeating_periods(history: History) -> tuple[int, float]:
    """The least number of excitation periods after which the end of the history repeats, and how well; or 0 and NaN.

    States are compared: displacement and velocity at some points of the beam, each relative to its largest value there.
    Where the state and the phase of the excitation return, so does all that follows.
    """
    omega = history.problem.excitation_frequency
    whole = 0 if omega is None else math.floor((history.end - history.start) * omega / (2 * math.pi) + 1e-9)
    if omega is None or whole == 0:
        return 0, math.nan
    times = np.maximum(history.end - 2 * math.pi / omega * np.arange(whole + 1), history.start)
    x = np.linspace(0.0, history.problem.beam.length, 7)
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
    """The first `count` Fourier coefficients of the last `periods` excitation periods."""
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
    """The weighted mean, m, and the amplitudes, the mean's modulus first."""
    z = history.displacement(x, np.linspace(history.start, history.end, samples, endpoint=False))[0]
    window = 0.5 - 0.5 * np.cos(2 * math.pi * np.arange(samples) / samples)
    mean = float(window @ z / window.sum())
    amplitudes = _amplitudes(z - mean, window)
    amplitudes[0] = abs(mean)
    return mean, amplitudes


def _amplitudes(z: FloatArray, window: FloatArray) -> FloatArray:
    """Moduli of the one-sided transform, scaled to amplitudes, shape ``(samples // 2 + 1,)``."""
    amplitudes: FloatArray = 2 * np.abs(np.fft.rfft(window * z)) / window.sum()
    amplitudes[0] /= 2
    return amplitudes


def _mark_excitation(axes: Axes, omega: float | None) -> None:
    if omega is None:
        return
    label = f"{_EXCITATION}, {omega:g} rad/s"
    if label not in {str(line.get_label()) for line in axes.lines}:
        axes.axvline(omega, color=GREY, linewidth=THIN, linestyle=(0, (4, 3)), zorder=1, label=label)


def _how(history: History, found: Spectrum) -> str:
    if not found.periods:
        return f"Hann window over {history.end - history.start:.4g} s"
    span = "1 period" if found.periods == 1 else f"{found.periods} periods"
    return f"Fourier series of {span}, repeating to {found.mismatch:.1g}"
