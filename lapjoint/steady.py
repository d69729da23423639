"""What a steady state is, and the certificate that says how it was established."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import Enum
from itertools import pairwise

import numpy as np

from lapjoint.contact import ContactState
from lapjoint.problem import FloatArray, Problem
from lapjoint.solution import History


class Outcome(Enum):
    """What a search for a steady state established; the values are sentences."""

    NO_CONTACT = "The motion is periodic and touches no stop."
    PERIODIC = "The motion is periodic, with contacts."
    CHATTERING = "The motion is periodic; in each period a stop chatters: contacts ever closer, then a lasting one."
    QUASIPERIODIC = "The motion is quasi-periodic: it circles an unstable periodic one, and nearby motions keep apart."
    APERIODIC = "The motion is aperiodic: nearby motions part exponentially."
    UNDECIDED = "Within the effort allowed the motion did not repeat, and nearby motions did not part for certain."


@dataclass(frozen=True, eq=False)
class Section:
    """The state of a motion at a multiple of the excitation period, to start another motion from."""

    state: ContactState
    coordinates: FloatArray
    """The solver's own coordinates and their rates, shape ``(2, n)``; only a solver of the same kind reads them."""


@dataclass(frozen=True)
class Exponent:
    """The largest Lyapunov exponent of a motion: the rate at which nearby motions part."""

    value: float
    """Mean rate of growth, 1/s; positive: chaos."""
    spread: float
    """Standard error of the mean over stretches of the motion, 1/s."""
    periods: int
    """Excitation periods over which it was measured."""

    @property
    def positive(self) -> bool:
        """Whether it is above zero by four spreads or more."""
        return self.value > 4 * self.spread

    def vanishes(self, rate: float) -> bool:
        """Whether it is zero within four spreads, and three or more of them above -`rate`, a decay in 1/s."""
        return abs(self.value) <= 4 * self.spread and self.value >= -rate + 3 * self.spread


@dataclass(frozen=True)
class SteadyState:
    """The motion that remains, and the certificate of how that was established."""

    problem: Problem
    solver: str
    """Name of the solver and its numerical options."""
    outcome: Outcome
    order: int
    """Number of excitation periods after which the motion repeats; 0 if it was not found to repeat."""
    symmetric: bool
    """Whether half the motion's period mirrors it, z(x, t + T/2) = -z(x, t)."""
    residual: float
    """Distance between the start and the end of the `order` periods, over the size of the motion."""
    multipliers: FloatArray = field(repr=False)
    """Moduli of the Floquet multipliers of the `order` periods, descending; empty if it does not repeat."""
    exponent: Exponent | None
    """Measured where the motion was not found to repeat."""
    section: Section = field(repr=False)
    """The state at the start of `history`."""
    history: History = field(repr=False)
    """`order` periods of the motion (or the last ones marched), starting at a multiple of the period."""
    impulses: FloatArray = field(default_factory=lambda: np.zeros(0))
    """Impulse of each stop over one excitation period (the mean over the `order`), N s, ``(stops,)``."""

    @property
    def stable(self) -> bool:
        """Whether all Floquet multipliers lie within the unit circle."""
        return bool(np.all(np.asarray(self.multipliers) < 1.0))


def periodic_outcome(history: History) -> Outcome:
    """Which of the periodic outcomes a motion of one period is."""
    if not history.contacts:
        return Outcome.NO_CONTACT
    return (
        Outcome.CHATTERING if any(chatters(history, k) for k in range(len(history.problem.stops))) else Outcome.PERIODIC
    )


def chatters(history: History, stop: int) -> bool:
    """Whether a stop chatters: at least three flights in a row each shorter than the last, then a lasting contact.

    The contact that ends the chatter must last longer than the one before it and than its last flight: without
    the bounces, a stop that is struck and then leaned on.  The history is read as one period of a motion.
    """
    mine = [contact for contact in history.contacts if contact.stop == stop]
    if mine and mine[0].open_start and mine[-1].open_end:  # one contact, cut by the section
        mine = [replace(mine[-1], end=mine[0].end + history.end - history.start), *mine[1:-1]]
        mine.sort(key=lambda contact: contact.start)
    if len(mine) < 4:
        return False
    turn = [
        replace(c, start=c.start + history.end - history.start, end=c.end + history.end - history.start) for c in mine
    ]
    both = mine + turn
    flights = [after.start - before.end for before, after in pairwise(both)]
    return any(
        flights[i] > flights[i + 1] > flights[i + 2]
        and both[i + 3].duration > max(both[i + 2].duration, flights[i + 2])
        for i in range(len(flights) - 2)
    )


def steady_impulses(history: History, order: int) -> FloatArray:
    """Mean impulse of each stop over one excitation period, from a history of `order` periods, ``(stops,)``."""
    total = np.zeros(len(history.problem.stops))
    for contact in history.contacts:
        total[contact.stop] += contact.impulse
    return total / max(order, 1)
