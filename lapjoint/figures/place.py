"""Where and when a history is looked at: positions on its beam, and times between its ends."""

from __future__ import annotations

import math

import numpy as np

from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem
from lapjoint.solution import Contact, History

LEAST_SAMPLES = 100
"""No excitation period is drawn with fewer times than this: a coarser curve shows a motion that is not there."""

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
