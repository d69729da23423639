"""Where and when a history is looked at: positions on its beam, and times between its ends."""

from __future__ import annotations

import math

import numpy as np

from lapjoint.answers import Contact, History
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem

LEAST_SAMPLES = 100
"""No excitation period is drawn with fewer times than this: a coarser curve shows a motion that is not there."""

SMOOTH = 0.002
"""Of an orbit's size: how far it may be from the chord that is drawn for it, about a pixel."""

MOST_TIMES = 50_000
"""No orbit is refined further than this."""

MANY = 100
"""With more contacts than this the curves are thin."""


def checked_position(problem: Problem, x: float) -> float:
    """The position `x`, m.

    Raises
    ------
    InputError
        If it is outside the beam.
    """
    if not 0.0 <= x <= problem.beam.length:
        raise InputError(f"x = {x:g}: lies outside the beam; allowed are 0 to {problem.beam.length:g} m")
    return float(x)


def one_position(problem: Problem, x: float | None) -> float:
    """The position asked for; by default that of the stop farthest from the root, or the tip where there is none."""
    if x is not None:
        return checked_position(problem, x)
    return max((stop.x for stop in problem.stops), default=problem.beam.length)


def times_drawn(history: History, samples: int) -> FloatArray:
    """Equidistant times, s, ascending: `samples`, or more if an excitation period has fewer than `LEAST_SAMPLES`.

    The switches are added, and a time between each two, so that no flight or contact is left out.

    Raises
    ------
    InputError
        If `samples` is less than 2.
    """
    if samples < 2:
        raise InputError(f"samples = {samples}: must be 2 or more")
    omega = history.problem.excitation_frequency or 0.0
    needed = math.ceil(LEAST_SAMPLES * omega * (history.end - history.start) / (2 * math.pi))
    even = np.linspace(history.start, history.end, max(samples, needed))
    switches = np.asarray(history.switch_times)
    return np.unique(np.concatenate([even, switches, (switches[1:] + switches[:-1]) / 2]))


def smooth_times(history: History, x: float, t: FloatArray) -> FloatArray:
    """The times `t`, s, and more where the orbit at position `x`, m, is drawn with corners that it has not.

    Where the state a quarter, half or three quarters of the way between two times is farther from the chord than
    `SMOOTH` of the orbit's size, the time half-way is added, and so on until all is smooth, or there are `MOST_TIMES`.
    """
    orbit = _orbit(history, x, t)
    size = np.ptp(orbit, axis=1, keepdims=True)
    size[size == 0] = 1.0
    ends = np.arange(t.size - 1)  # of the chords to look at, the first ones
    while ends.size and t.size < MOST_TIMES:
        start, chord = orbit[:, ends] / size, np.diff(orbit, axis=1)[:, ends] / size
        width = np.diff(t)[ends]
        early, halfway, late = (_orbit(history, x, t[ends] + share * width) for share in (0.25, 0.5, 0.75))
        off = [_distance(chord, point / size - start) for point in (early, halfway, late)]
        between = t[ends] + 0.5 * width
        rough = (np.max(off, axis=0) > SMOOTH) & (between > t[ends]) & (between < t[ends + 1])
        places, ends = ends[rough] + 1, ends[rough] + np.arange(rough.sum())
        t = np.insert(t, places, between[rough])
        orbit = np.insert(orbit, places, halfway[:, rough], axis=1)
        ends = np.sort(np.concatenate([ends, ends + 1]))
    return t


def _orbit(history: History, x: float, t: FloatArray) -> FloatArray:
    return np.vstack([history.displacement(x, t), history.velocity(x, t)])


def _distance(chord: FloatArray, off: FloatArray) -> FloatArray:
    """Distance from chords of points, `off` their starts; all of shape ``(2, n)``."""
    along = np.sum(chord * off, axis=0) / np.maximum(np.sum(chord**2, axis=0), np.finfo(float).tiny)
    return np.asarray(np.hypot(*(off - np.clip(along, 0.0, 1.0) * chord)))


def in_contact(contacts: list[Contact], t: FloatArray) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Whether any of the contacts lasts at each time of `t`, their ends included, shape ``(m,)``."""
    starts, ends = np.sort([c.start for c in contacts]), np.sort([c.end for c in contacts])
    return np.asarray(np.searchsorted(starts, t, side="right") > np.searchsorted(ends, t, side="left"))


def line_width(history: History) -> float:
    """Width of a curve, points: thin where there are many contacts, and so many turns of the curve."""
    return 1.1 if len(history.contacts) <= MANY else 0.4


def heading(history: History) -> str:
    """Title of the problem, and below it the solver."""
    return f"{history.problem.title}\n{history.solver}".strip()
