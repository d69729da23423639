"""Steady states, and the certificates that say how they were established."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import Enum
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.history import NO_ERRORS, History
from lapjoint.answers.shown import Shown
from lapjoint.problem import FloatArray, Problem

ComplexArray = npt.NDArray[np.complex128]

CERTAIN = 4.0
"""Number of standard errors by which an exponent must differ from zero: more than two, because the error is an estimate
from few blocks, and because the search makes several measurements."""
LEAST_GROWTH = 10.0
"""Least growth of a deviation that shows chaos, and least decay that shows a stable motion, over a measurement, as
powers of e: on a torus a deviation grows and shrinks by less, over any time."""
_CHATTER = 4
"""Least number of contacts in a period of a stop that chatters: three flights, and the contacts before, between and
after them."""
ALIKE = 0.1
"""Relative difference up to which the exponents of both halves agree, even if their standard errors are smaller."""
SMALL = 0.1
"""Largest exponent that counts as zero, divided by the lowest decay rate of free vibration: nearby motions would take
ten times as long to part as free vibration takes to decay."""
SENSITIVE = 1e8
"""Growth of a deviation from which rounding may decide which motion is reached: a rounding error of 1e-16 of the motion
then grows to 1e-8, the difference that tells two motions apart."""


class Outcome(Enum):
    """The result of a search for a steady state; the values are sentences."""

    NO_CONTACT = "The motion is periodic and touches no stop."
    PERIODIC = "The motion is periodic, with contacts."
    CHATTERING = "The motion is periodic; in each period a stop chatters: contacts ever closer, then a lasting one."
    QUASIPERIODIC = "The motion is quasi-periodic: it winds around an unstable one, and nearby motions keep apart."
    APERIODIC = "The motion is aperiodic: nearby motions part exponentially."
    UNDECIDED = "Within the effort allowed the motion did not settle, and nearby motions did not part for certain."


@dataclass(frozen=True, eq=False)
class SectionPoint:
    """The state of a motion at a multiple of the excitation period, to start another motion from."""

    state: ContactState
    coordinates: FloatArray
    """Coordinates and their rates, shape ``(2, n)``, which only a solver of the kind that made them can read."""
    nodes: FloatArray | None = None
    """Positions of nodal coordinates, m, shape ``(nodes,)``; None for modal coordinates."""


@dataclass(frozen=True)
class Exponent:
    """The largest Lyapunov exponent of a motion: the rate at which nearby motions part.

    An exponent counts as positive, negative or zero only if this is certain, and at most one of the three is certain.
    A positive or negative exponent has this sign in each half of the measurement, which excludes a transient that
    decays.  An exponent is zero only if it lies in a narrow interval about zero in every quarter of the measurement.
    """

    value: float
    """Mean rate of growth, 1/s; a positive one means chaos."""
    standard_error: float
    """Standard error of the mean, 1/s, with the correlation of the growth from period to period."""
    periods: int
    """Number of excitation periods of the measurement."""
    time: float
    """Duration of the measurement, s."""
    halves: tuple[float, float]
    """Mean rates over the first half of the measurement and over the second, 1/s."""
    quarters: tuple[float, ...]
    """Rates over the quarters of the measurement, 1/s: weighted means, which converge fast on quasi-periodic
    motions."""

    @property
    def positive(self) -> bool:
        """Whether the exponent is certainly positive: by `CERTAIN` errors in each half, and with growth by
        e^`LEAST_GROWTH`."""
        return min(self.halves) > self._margin and self._steady and self.value * self.time > LEAST_GROWTH

    @property
    def negative(self) -> bool:
        """Whether the exponent is certainly negative, as on a stable periodic motion, however long its period."""
        return max(self.halves) < -self._margin and self._steady and self.value * self.time < -LEAST_GROWTH

    def vanishes(self, rate: float) -> bool:
        """Whether the exponent is certainly zero: in every quarter at most `SMALL` times a rate of decay.

        Parameters
        ----------
        rate : float
            Lowest decay rate of free vibration, 1/s.  If it is zero or infinite, nothing is damped, and no exponent
            counts as zero.
        """
        if self.positive or self.negative or not 0 < rate < math.inf:
            return False
        return all(abs(quarter) <= SMALL * rate for quarter in self.quarters)

    @property
    def _margin(self) -> float:
        """Bound on the error of an exponent, 1/s."""
        return CERTAIN * self.standard_error

    @property
    def _steady(self) -> bool:
        """Whether both halves agree: their difference has twice the standard error of the mean."""
        return abs(self.halves[1] - self.halves[0]) <= max(3 * 2 * self.standard_error, ALIKE * abs(self.value))


@dataclass(frozen=True)
class Acceptance:
    """Where and when in the march a motion was accepted as the steady state, so that anyone can continue the march."""

    point: SectionPoint
    """The section point of the march at which the motion was accepted."""
    periods: int
    """Excitation periods marched until then."""
    pushes: int = 0
    """Number of times that the march was pushed off an unstable motion, which it would not have left by itself."""
    growth: float | None = None
    """Largest factor by which a deviation grew from any section point to any later one; None if it was not measured."""

    @property
    def sensitive(self) -> bool | None:
        """Whether rounding or a push may have decided which motion was reached; None if growth was not measured."""
        if self.pushes:
            return True
        return None if self.growth is None else self.growth >= SENSITIVE


@dataclass(frozen=True)
class Comparison:
    """The motion at a finer resolution of the solver, and how errors follow from the difference."""

    history: History
    """The finer motion over one period."""
    bounds: Callable[[FloatArray, float, int, int], FloatArray]
    """Error bounds from differences: `lapjoint.orbits.refinement.Refinement.bounds`."""
    floor: float
    """Error that refinement does not reveal, divided by the largest value."""


@dataclass(frozen=True, repr=False)
class SteadyState(Shown):
    """The motion that remains, and the certificate of how it was established."""

    problem: Problem
    solver: str
    """Name of the solver and its numerical options."""
    outcome: Outcome
    period_multiple: int
    """Number of excitation periods after which the motion repeats; 0 if it was not found to repeat."""
    symmetric: bool
    """Whether the second half of the motion's period mirrors the first, z(x, t + T/2) = -z(x, t)."""
    residual: float
    """Distance between the start and the end of the motion's period, divided by the size of the motion."""
    multipliers: ComplexArray = field(repr=False)
    """Floquet multipliers over the motion's period, largest modulus first, ``(m,)``; empty if the motion does not
    repeat."""
    exponent: Exponent | None
    """The largest Lyapunov exponent, measured if the motion was not found to repeat; else None."""
    section_point: SectionPoint = field(repr=False)
    """The state at the start of `history`."""
    history: History = field(repr=False)
    """One period of the motion (or the last periods marched), starting at a multiple of the excitation period."""
    impulses: FloatArray = field(default_factory=lambda: np.zeros(0))
    """Impulse of each stop over one excitation period (the mean over the motion's period), N s, ``(stops,)``."""
    acceptance: Acceptance | None = None
    """Where and when the search accepted this motion; None if there was no search."""
    impulse_errors: FloatArray | None = None
    """Estimate of the numerical error of each impulse, N s, ``(stops,)``; infinite if no error can be stated, None if
    none was estimated.  For a motion that does not repeat, the standard error of the mean."""
    dissipated_errors: FloatArray | None = None
    """Estimate of the numerical error of each energy in `dissipated`, J, ``(stops,)``; infinite if no error can be
    stated, None if none was estimated or the motion does not repeat."""
    error_source: str = NO_ERRORS
    """How the errors were estimated, or why there are none."""
    comparison: Comparison | None = field(default=None, repr=False, compare=False)
    """The finer motion from which errors follow; None if no error can be stated, or none was requested."""
    march_on: Callable[[int], History] | None = field(default=None, repr=False, compare=False)
    """Continues a motion that does not repeat, from `section_point` over some excitation periods; not pickled."""

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "march_on": None}

    @property
    def dissipated(self) -> FloatArray:
        """Energy that each stop takes from the beam and keeps over one excitation period (the mean over `history`), J,
        ``(stops,)``."""
        omega = self.problem.excitation_frequency
        duration = self.history.end - self.history.start
        periods = self.period_multiple or (round(duration * omega / (2 * math.pi)) if omega else 1)
        return self.history.dissipated() / max(periods, 1)

    @property
    def stable(self) -> bool | None:
        """Whether all Floquet multipliers lie within the unit circle; None if no orbit was certified."""
        if not self.multipliers.size:
            return None
        return bool(np.abs(self.multipliers).max() < 1.0)


def periodic_outcome(history: History) -> Outcome:
    """The outcome of one period of a periodic motion: `NO_CONTACT`, `PERIODIC` or `CHATTERING`."""
    if not history.contacts:
        return Outcome.NO_CONTACT
    return (
        Outcome.CHATTERING if any(chatters(history, k) for k in range(len(history.problem.stops))) else Outcome.PERIODIC
    )


def chatters(history: History, stop: int) -> bool:
    """Whether a stop chatters in a period: three or more flights, each shorter than the last, then a long contact.

    The last contact must last longer than the contact and the flight before it: the beam bounces, and then remains
    pressed on the stop.
    """
    mine = [contact for contact in history.contacts if contact.stop == stop]
    if mine and mine[0].open_start and mine[-1].open_end:  # one contact, cut in two by the section point
        mine = [replace(mine[-1], end=mine[0].end + history.end - history.start), *mine[1:-1]]
        mine.sort(key=lambda contact: contact.start)
    if len(mine) < _CHATTER:
        return False
    next_period = [
        replace(c, start=c.start + history.end - history.start, end=c.end + history.end - history.start) for c in mine
    ]
    both = mine + next_period
    flights = [after.start - before.end for before, after in pairwise(both)]
    return any(
        flights[i] > flights[i + 1] > flights[i + 2]
        and both[i + 3].duration > max(both[i + 2].duration, flights[i + 2])
        for i in range(len(flights) - 2)
    )


def impulses_per_period(history: History, period_multiple: int) -> FloatArray:
    """Mean impulse of each stop over one of the excitation periods of a history, N s, top positive, (stops,)."""
    total = np.zeros(len(history.problem.stops))
    for contact in history.contacts:
        total[contact.stop] += contact.impulse
    return total / max(period_multiple, 1)
