"""Orbits that marches settle to, and the motion of the rigid bar without contact."""

from __future__ import annotations

from lapjoint.orbits import PeriodMap
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.newton import FAR, Orbit, find_orbit


def orbit_of(map_: PeriodMap, half_periods: int, settle: int = 30) -> Orbit:
    """The orbit near which a march of `settle` periods from the initial state ends."""
    point = map_.march(map_.initial(), 2 * settle).end
    found = find_orbit(HalfPeriods(map_), point, half_periods, FAR)
    assert found is not None
    return found


def amplification(omega: float, ratio: float) -> complex:
    """A of the steady z = Im(A exp(i omega t)) of `toy.bar` without contact, over the base amplitude."""
    return omega**2 / (1 - omega**2 + 2j * ratio * omega)
