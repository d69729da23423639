"""Positions and times at which figures evaluate a history, and the heading of these figures."""

from __future__ import annotations

import math

import numpy as np

from lapjoint.answers import Contact, History
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray

LEAST_SAMPLES = 100
"""Least number of times in a period of the fastest excitation: a curve with fewer could show another motion."""
SMOOTH = 0.002
"""Largest distance of an orbit from its drawn chord, as a fraction of the orbit's size: about a pixel."""
MOST_TIMES = 50_000
"""Number of times at which the refinement of an orbit ends, to limit the time that a figure takes."""
MANY = 100
"""Number of contacts above which the curves are drawn thin."""


def times_drawn(history: History, samples: int) -> FloatArray:
    """Times at which a motion is drawn, s, ascending, (m,): equidistant times, and the switches.

    There are `samples` equidistant times, or more if a period of the fastest excitation would have fewer than
    `LEAST_SAMPLES`.  The times of the switches, and the middles between consecutive switches, are added, so that every
    flight and every contact is drawn.
    """
    if samples < 2:
        raise InputError(f"samples = {samples}: must be 2 or more")
    needed = math.ceil(LEAST_SAMPLES * history.problem.forces.fastest * (history.end - history.start) / (2 * math.pi))
    even = np.linspace(history.start, history.end, max(samples, needed))
    switches = np.asarray(history.switch_times)
    return np.unique(np.concatenate([even, switches, (switches[1:] + switches[:-1]) / 2]))


def smooth_times(history: History, x: float, t: FloatArray) -> FloatArray:
    """Times `t`, s, ascending, (n,), with further times added so that the drawn orbit at position `x`, m, is smooth.

    Between two times the orbit is drawn as a chord.  If the state at a quarter, half or three quarters of this interval
    is farther from the chord than `SMOOTH` of the orbit's size, the middle time is added.  This is repeated until no
    chord is too far, or there are `MOST_TIMES`.
    """
    orbit = _orbit(history, x, t)
    size = np.ptp(orbit, axis=1, keepdims=True)
    size[size == 0] = 1.0
    ends = np.arange(t.size - 1)  # indices of the first ends of the chords to test
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
    """Distance of points from chords, (n,); `chord` leads along a chord and `off` from its start to the point, (2,
    n)."""
    along = np.sum(chord * off, axis=0) / np.maximum(np.sum(chord**2, axis=0), np.finfo(float).tiny)
    return np.asarray(np.hypot(*(off - np.clip(along, 0.0, 1.0) * chord)))


def in_contact(contacts: list[Contact], t: FloatArray) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Whether any stop is in contact at each time `t`, s, (m,), including the ends of contacts."""
    starts, ends = np.sort([c.start for c in contacts]), np.sort([c.end for c in contacts])
    return np.asarray(np.searchsorted(starts, t, side="right") > np.searchsorted(ends, t, side="left"))


def line_width(history: History) -> float:
    """The line width of a motion's curve, points: thin if the motion has more than `MANY` contacts, as it has many
    loops."""
    return 1.1 if len(history.contacts) <= MANY else 0.4


def heading(history: History) -> str:
    """The title of a motion's problem, and below it its solver."""
    return f"{history.problem.title}\n{history.solver}".strip()
