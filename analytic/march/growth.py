"""Deviations carried along with a march in one compiled call.

All deviations over one march serve Newton's method; one deviation and its growth over many periods serve Lyapunov
exponents.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.march.carried import size_of
from analytic.march.coordinates import Coordinates
from analytic.march.joint import Joint
from analytic.march.march import MOST_SWITCHES, WITH_ALL_AT_ONCE, begun, ended
from analytic.march.motion import SWITCHES
from analytic.march.periods import Periods, march_on, room_for
from analytic.march.tables import IntArray
from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class Growth(Periods):
    """A motion over whole periods, and the growth of a deviation from it."""

    penetrations: FloatArray
    """Time integral of each stop's penetration over each period, m s, shape ``(count, P)``."""
    slots: IntArray
    """State at the end of each period, as its slot, shape ``(count,)``."""
    coordinates: FloatArray
    """q, kg^1/2 m, and v, kg^1/2 m/s, at the end of each period, padded with 0, shape ``(count, 2, N)``."""
    growth: FloatArray
    """Natural logarithm of the growth of the deviation in each period, without unit, shape ``(count,)``; growth below
    `LEAST_GROWTH` is replaced by `LEAST_GROWTH`."""
    deviation: FloatArray
    """The deviation (dq, dv) at the end, kg^1/2 m and kg^1/2 m/s, scaled to a size of 1 kg^1/2 m, shape ``(2 N,)``."""


def march_linearised(
    joint: Joint, begin: Coordinates, end: float, deviations: FloatArray
) -> tuple[Coordinates, FloatArray]:
    """March from the time 0 to `end`, s, and carry deviations, ``(2 N_start, m)``, along; they end as ``(2 N_end, m)``.

    Deviations (dq, dv), kg^1/2 m and kg^1/2 m/s, are columns.  The motion ends where `march` does, to the bit, but no
    log is kept.
    """
    motion = begun(joint, begin, 0.0)
    now = march_on(joint, motion, end, 1, room_for(motion, 1, 0), deviations.copy(), at_once=WITH_ALL_AT_ONCE)
    return ended(joint, motion), now


def measure_growth(
    joint: Joint,
    begin: Coordinates,
    deviation: FloatArray,
    period: float,
    count: int,
    *,
    max_switches: int = MOST_SWITCHES,
) -> Growth:
    """March over whole periods, as `march_periods` does, and carry a deviation (dq, dv), ``(2 N_start,)``, along.

    The deviation, of any size but 0, is scaled to unit size, |dq| + |dv| period / 2 pi = 1 kg^1/2 m, at the start and
    at the end of each period.  `period` is in s.
    """
    motion, growth = begun(joint, begin, 0.0), np.zeros(count)
    record, now = room_for(motion, count, count), deviation.reshape(-1, 1) / size_of(deviation.reshape(-1, 1), period)
    now = march_on(joint, motion, period, count, record, now, growth, max_switches=max_switches)
    total, switches = record.penetration.sum(axis=0), int(motion.counts[SWITCHES])
    return Growth(joint, ended(joint, motion), total, switches, *record, growth, now[:, 0].copy())
