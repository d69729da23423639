"""Events of a motion found again in a neighbouring one, compiled; see `lapjoint.orbits.branches.passings`."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from lapjoint.compiling import njit_called, njit_inner
from lapjoint.orbits.compiled_intervals import IndexArray
from lapjoint.problem import FloatArray

_REACH = 3.0
"""Change of an extremum over what its rates make of it, up to which it may be due to this step: a rate may grow
threefold in a step, and an extremum that changes by more is another one."""
_LOOKS = 16
"""Parts of the way between two motions, between which the cubic of an extremum is looked at."""


class Events(NamedTuple):
    """The ``m`` extrema and ``J`` switches of a motion, and how they move along the curve, per unit of arc length."""

    kind: IndexArray
    """What each extremum is, shape ``(m,)``."""
    phase: FloatArray
    """When, over the length of the motion, shape ``(m,)``."""
    value: FloatArray
    """h, m, shape ``(m,)``."""
    phase_rate: FloatArray
    """Of the phase, shape ``(m,)``; 0 where it is not known."""
    value_rate: FloatArray
    """Of the value, m, shape ``(m,)``; 0 where it is not known."""
    switch_kind: IndexArray
    """What each switch is, shape ``(J,)``."""
    switch_phase: FloatArray
    """When, over the length of the motion, shape ``(J,)``."""
    switch_rate: FloatArray
    """Of that, shape ``(J,)``; 0 where it is not known."""


@njit_called()
def met(a: Events, b: Events, length: float, both: bool) -> tuple[bool, bool, npt.NDArray[np.bool_], IndexArray]:
    """What becomes of the events of a motion on the way to another one.

    Parameters
    ----------
    a, b : Events
        Those of the one, and of the other.
    length : float
        Arc length from the one to the other.
    both : bool
        Whether the rates of the other are known, too; else those that it has are not looked at, and nothing is seen
        that passes zero and comes back.

    Returns
    -------
    same : bool
        Whether the switches of the one are those of the other.
    through : bool
        Whether an extremum that is not found in the other motion passes zero on the way, by its rate.  A maximum and a
        minimum may arise as one on the way, and pass zero one after the other; both motions then have as many contacts.
    passes : ndarray, shape (m,)
        Which extrema of the one pass zero on the way, and are found in the other.
    partner : ndarray, shape (m,)
        Which extremum of the other each of them is; -1 where it is none.
    """
    partner, passes = _partners(a, b, length, both), np.zeros(a.kind.size, dtype=np.bool_)
    alone, through = np.ones(b.kind.size, dtype=np.bool_), False
    for i in range(a.kind.size):
        j, rise = partner[i], length * a.value_rate[i]
        if j < 0:
            through |= (a.value[i] > 0) != (a.value[i] + rise > 0)
        else:
            alone[j] = False
            passes[i] = _passes(a.value[i], rise, b.value[j], length * b.value_rate[j] if both else rise, both)
    for j in range(b.kind.size):
        if both and alone[j]:
            through |= (b.value[j] > 0) != (b.value[j] - length * b.value_rate[j] > 0)
    return _same_switches(a, b, length), through, passes, partner


@njit_inner()
def _partners(a: Events, b: Events, length: float, both: bool) -> IndexArray:
    """The extremum of the other motion that each of one is, shape ``(m,)``: each is the nearest to the other."""
    partner = nearest(a.kind, a.phase + length * a.phase_rate, b.kind, b.phase)
    back = nearest(b.kind, b.phase - length * b.phase_rate if both else b.phase, a.kind, a.phase)
    for i in range(partner.size):
        if partner[i] >= 0 and back[partner[i]] != i:
            partner[i] = -1
    return partner


@njit_inner()
def _same_switches(a: Events, b: Events, length: float) -> bool:
    """Whether each switch of either motion is one of the other."""
    if a.switch_kind.size != b.switch_kind.size:
        return False
    there = nearest(a.switch_kind, a.switch_phase + length * a.switch_rate, b.switch_kind, b.switch_phase)
    found = np.zeros(there.size, dtype=np.bool_)
    for j in there:
        if j < 0 or found[j]:
            return False
        found[j] = True
    return True


@njit_inner()
def _passes(h0: float, v0: float, h1: float, v1: float, both: bool) -> bool:
    """Whether an extremum passes zero between two values, with these changes over the way at its ends.

    It does so once where they have different signs; and with one sign, if the cubic with these values and changes does.
    """
    reach = _REACH * max(abs(v0), abs(v1))
    if (h0 > 0) != (h1 > 0):
        return abs(h1 - h0) <= reach
    if not both or min(abs(h0), abs(h1)) > reach:
        return False
    for i in range(1, _LOOKS):
        t = i / _LOOKS
        s = 1 - t
        h = s * s * ((1 + 2 * t) * h0 + t * v0) + t * t * ((3 - 2 * t) * h1 - s * v1)
        if (h > 0) != (h0 > 0):
            return True
    return False


@njit_called()
def nearest(kind: IndexArray, phase: FloatArray, other_kind: IndexArray, other_phase: FloatArray) -> IndexArray:
    """For each of some events of a motion that repeats, the event of another motion that is the nearest in phase.

    Parameters
    ----------
    kind, phase : ndarray, shape (m,)
        What each event is, and when, over the length of the motion.
    other_kind, other_phase : ndarray, shape (n,)
        The same of the events among which it is looked for.

    Returns
    -------
    ndarray, shape (m,)
        Their indices; -1 where there is none of that kind.
    """
    found = np.full(kind.size, -1)
    for i in range(kind.size):
        least = math.inf
        for j in range(other_kind.size):
            if other_kind[j] == kind[i]:
                apart = other_phase[j] - phase[i]
                apart = abs(apart - round(apart))
                if apart < least:
                    found[i], least = j, apart
    return found
