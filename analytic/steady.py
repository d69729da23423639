r"""Periodic motions: Newton's method on the period map, Floquet multipliers, and exponents where nothing repeats.

The state at a multiple of the period, y = (q, v) in the modes of the contact state at that time, is mapped by P(y)
over n periods.  A joint that is its own mirror image has a finer map: over half a period, then mirrored, z -> -z.  Its
fixed points are the symmetric motions.  All maps are counted in half periods here, called turns: an odd number of
turns ends mirrored, and 2 n turns are n periods.

A fixed point y* is accepted only if it is stable, all multipliers within the unit circle, and if the march leads to
it.  Either the march has come within `_NEAR` of repeating, or it moves as the linearisation at y* says it must,

    |P(y) - y* - M (y - y*)| <= _LINEAR |y - y*|;

and in both cases the left side is less than `_SLOWER` of (1 - |mu_1|) |y - y*|, what the map takes off the distance:
where an orbit attracts slowly, one that circles it in many more periods passes the first test and not this one.

So a motion is found long before it has settled, and among motions that coexist it is the one marched to.  What holds a
march at a motion that is not stable, or parts a stable one into several, is dealt with in `analytic.held`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from analytic.exponent import exponent_of, outcome_of
from analytic.held import NARROW, PUSHES, REPEATS, disturbed, parted_by_a_jump, pushed
from analytic.maps import Map, Shot
from analytic.march import Coordinates, Joint, march
from analytic.tangent import carried
from lapjoint.answers.contact_state import FREE
from lapjoint.answers.steady_state import Exponent, Outcome
from lapjoint.errors import SolverError
from lapjoint.problem import FloatArray
from lapjoint.solver import Progress

_NEAR = 1e-2  # of the size of the motion
_FAR = 2.0  # from here on Newton is tried for one period
_THERE = 1e-4  # of the size of the motion: the march has come to the orbit
_SLOWER = 0.5
_LINEAR = 0.1
_TURNS = 1e-6  # of a multiplier's modulus: an imaginary part above says that it is one of a complex pair
_FIRST_STRETCH = 8  # periods
_NEWTON_STEPS = 12
_LONG = 512  # periods of transient before an exponent is measured, and the least over which it is
_WATCHED = 64  # periods over which it is looked how far a march wanders


@dataclass(frozen=True)
class Search:
    """How hard to look for a steady state."""

    tolerance: float
    max_order: int
    max_periods: int


@dataclass(frozen=True)
class Orbit:
    """A periodic motion."""

    begin: Coordinates
    """At a multiple of the excitation period."""
    order: int
    """Excitation periods per period of the motion."""
    symmetric: bool
    residual: float
    multipliers: FloatArray
    """Moduli over `order` periods, descending."""


@dataclass(frozen=True)
class Wandering:
    """A motion that was not found to repeat."""

    begin: Coordinates
    residual: float
    """How far it is from repeating, at best, after up to the most periods looked for."""
    exponent: Exponent
    outcome: Outcome
    """What the exponent shows of a march that does not repeat: aperiodic, quasi-periodic, or undecided."""
    breadth: float
    """How far it wanders from repeating, relative to its size: the farthest of all returns, at the best order."""
    deviation: FloatArray
    """A deviation of unit size that has grown with the motion to its end."""
    penetration: FloatArray
    """Mean over the time measured of the integral of each stop's penetration over one period, m s."""

    def confirms(self, before: Wandering) -> bool:
        """Whether this shows what the measurement before it showed, so that more would tell nothing new.

        If deviations died out in both, the motion repeats, after more periods than were looked for.
        """
        if self.outcome is Outcome.UNDECIDED:
            return before.exponent.negative and self.exponent.negative
        return self.outcome is before.outcome


def find_steady(
    joint: Joint, begin: Coordinates, period: float, search: Search, progress: Progress | None
) -> Orbit | Wandering:
    """March from `begin` for longer and longer, and try Newton's method after each stretch.

    What an exponent shows is believed when two stretches in a row agree, the second longer than the first: a long
    transient, or chaos that pauses, deceives one of them more easily than both.
    """
    maps, now, marched, stretch, pushes = Map(joint, period), begin, 0, _FIRST_STRETCH, 0
    before: Wandering | None = None
    while True:
        wandering = None
        if marched + stretch < min(_LONG, search.max_periods):
            now = march(joint, now, 0.0, stretch * period, record=False).end
        else:
            stretch = max(stretch, _LONG)
            wandering, now = _measured(maps, now, stretch, search.max_order, pushes)
        marched += stretch
        if progress is not None:
            progress(min(marched, search.max_periods), search.max_periods)
        orbit, returns = _orbit_from(maps, now, search)
        if orbit is not None:
            return orbit
        if wandering is not None:
            certain = before is not None and wandering.confirms(before)
            if certain or marched >= search.max_periods:
                return wandering if certain else replace(wandering, outcome=Outcome.UNDECIDED)
            before = wandering
        away = pushed(maps, now, returns, pushes)
        off = away is not None
        if away is None and wandering is not None and wandering.exponent.positive:
            away = disturbed(maps, now, wandering.breadth, wandering.deviation, pushes)
            off = wandering.breadth <= NARROW and pushes < PUSHES
        now = away or now
        if off:
            pushes, before = pushes + 1, None
        stretch = min(stretch if off else 2 * stretch, max(search.max_periods - marched, _FIRST_STRETCH))


def _orbit_from(maps: Map, now: Coordinates, search: Search) -> tuple[Orbit | None, FloatArray]:
    """The first stable motion that a section leads to: of one period, symmetric ones first, then of several.

    Without one, the residuals after 1, 2, ... turns are of use.
    """
    for turns in (1, 2) if maps.symmetric else (2,):
        orbit = _newton(maps, now, turns, search.tolerance, _FAR)
        if orbit is not None:
            return _least(maps, orbit, search.tolerance), np.zeros(0)
    returns = maps.returns(now, 2 * search.max_order)
    for i in np.flatnonzero(returns <= _NEAR):
        orbit = _newton(maps, now, int(i) + 1, search.tolerance, _NEAR)
        if orbit is not None and orbit.order <= search.max_order:
            return _least(maps, orbit, search.tolerance), returns
    return None, returns


def _least(maps: Map, orbit: Orbit, tolerance: float) -> Orbit:
    """The same motion over its least period: an orbit found over n turns may repeat after a part of them."""
    found = orbit.order if orbit.symmetric else 2 * orbit.order
    for turns in range(1, found):
        if found % turns == 0 and (maps.symmetric or turns % 2 == 0):
            shorter = _newton(maps, orbit.begin, turns, tolerance, _NEAR)
            if shorter is not None:
                return shorter
            parted = parted_by_a_jump(maps, orbit.begin, turns, found // turns)
            if parted is not None:
                return _orbit(orbit.begin, turns, *parted)
    return orbit


def _orbit(begin: Coordinates, turns: int, residual: float, moduli: FloatArray) -> Orbit:
    """A motion that repeats after some turns, `moduli` being those of the multipliers over these."""
    odd = turns % 2 == 1
    return Orbit(begin, turns if odd else turns // 2, odd, residual, moduli**2 if odd else moduli)


def _newton(maps: Map, guess: Coordinates, turns: int, tolerance: float, allowed: float) -> Orbit | None:
    """A stable orbit of some turns that `guess` leads to, or None."""
    now, first = guess, None
    for _ in range(_NEWTON_STEPS):
        try:
            shot = maps.shoot(now, turns)
        except SolverError:  # a step of Newton's led out of what can be marched
            return None
        if not shot.residual <= allowed:
            return None
        first = first or shot
        matrix = maps.matrix(shot, turns)
        if shot.residual < tolerance:
            eigenvalues = np.linalg.eigvals(matrix)
            multipliers = np.sort(np.abs(eigenvalues))[::-1]
            leading = eigenvalues[np.argmax(np.abs(eigenvalues))]
            maps.circled |= bool(multipliers[0] > 1 and abs(leading.imag) > _TURNS * abs(leading))
            if multipliers[0] >= 1 or not _leads_to(maps, guess, first, now, matrix, multipliers[0]):
                return None
            return _orbit(now, turns, shot.residual, multipliers)
        allowed = 2 * max(shot.residual, 1e-6)
        now = now.moved(now.y + np.linalg.solve(np.eye(now.y.size) - matrix, shot.end.y - now.y))
    return None


def _leads_to(maps: Map, guess: Coordinates, first: Shot, orbit: Coordinates, matrix: FloatArray, slow: float) -> bool:
    """Whether the march from `guess`, of which `first` is the next piece, is on its way to `orbit`.

    `slow` is the modulus of the leading multiplier.
    """
    deviation = guess.y - orbit.y
    away = maps.norm(deviation)
    if away <= _THERE * maps.norm(orbit.y):
        return True
    departure = maps.norm(first.end.y - orbit.y - matrix @ deviation)
    linear = first.residual <= _NEAR or departure <= _LINEAR * away
    return linear and departure <= _SLOWER * (1 - slow) * away


def _measured(
    maps: Map, begin: Coordinates, periods: int, max_order: int, pushes: int
) -> tuple[Wandering, Coordinates]:
    """March over `periods` and measure the largest Lyapunov exponent; also returns where the march ends.

    The exponent says nothing of a march that repeats, nor of one that is so narrow that it may be held and has not
    been pushed off for certain: at an unstable motion it is the growth of deviations that the march does not make.
    """
    joint, now = maps.joint, begin
    rng = np.random.default_rng(0)
    deviation = rng.standard_normal((begin.y.size, 1))
    deviation /= maps.norm(deviation[:, 0])
    growth, total, sections = np.zeros(periods), np.zeros(len(joint.problem.stops)), [begin]
    for i in range(periods):
        motion = march(joint, now, 0.0, maps.period)
        deviation = carried(motion, deviation)
        size = maps.norm(deviation[:, 0])
        growth[i] = np.log(size)
        deviation /= size
        now = motion.end
        total += motion.penetration
        sections.append(now)
    exponent = exponent_of(growth, maps.period)
    outcome = outcome_of(exponent, joint.family.state(FREE, joint.count(FREE)).decay, circled=maps.circled)
    breadth = maps.breadth(sections[-_WATCHED - 1 :], max_order)
    if breadth <= REPEATS or (outcome is Outcome.APERIODIC and breadth <= NARROW and pushes < PUSHES):
        outcome = Outcome.UNDECIDED
    return Wandering(
        begin=now,
        residual=float(maps.returns(now, 2 * max_order)[1::2].min()),
        exponent=exponent,
        outcome=outcome,
        breadth=breadth,
        deviation=deviation[:, 0],
        penetration=total / periods,
    ), now
