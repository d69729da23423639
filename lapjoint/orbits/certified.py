"""Certified motions: two are one motion if their orbits are equal; equal impulses are not enough.

A motion of period multiple n has n section points, one a period.  If the problem is its own mirror image and a motion
is not, the mirror image of the motion is another motion.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from lapjoint.answers.steady_state import Outcome, SectionPoint, impulses_per_period, periodic_outcome
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.newton import Orbit
from lapjoint.orbits.trapping import Trap

SAME_ORBIT = 1e-6
"""Distance below which two stable orbits are one, divided by their size; each orbit closes within 1e-9."""


@dataclass(frozen=True)
class CertifiedMotion:
    """A stable periodic motion."""

    points: tuple[SectionPoint, ...]
    """Its section points, one for each excitation period."""
    symmetric: bool
    """Whether half of the motion mirrors the other half."""
    outcome: Outcome
    """Outcome of the motion, one of the periodic outcomes."""
    residual: float
    """Distance between start and end, as a fraction of the size of the motion."""
    multiplier: complex
    """The Floquet multiplier of largest modulus; of a conjugate pair, the one with the positive imaginary part."""
    impulses: tuple[float, ...]
    """Mean impulse of each stop over one excitation period, N s."""

    @property
    def period_multiple(self) -> int:
        """Number of excitation periods after which the motion repeats."""
        return len(self.points)


def certified(half_periods: HalfPeriods, orbit: Orbit) -> CertifiedMotion:
    """The motion of a stable orbit over its least period, with the start of the orbit."""
    period_map, multiple = half_periods.map, orbit.period_multiple
    points = [orbit.point]
    for _ in range(multiple - 1):
        points.append(period_map.march(points[-1], 2).end)
    history = period_map.history(orbit.point, multiple)
    leading = complex(orbit.multipliers[0]) if orbit.multipliers.size else 0j
    return CertifiedMotion(
        points=tuple(points),
        symmetric=orbit.symmetric or (not history.contacts and period_map.problem.forces.change_sign),
        outcome=periodic_outcome(history),
        residual=float(orbit.residual),
        multiplier=complex(leading.real, abs(leading.imag)),
        impulses=tuple(impulses_per_period(history, multiple).tolist()),
    )


def mirrored_motion(half_periods: HalfPeriods, motion: CertifiedMotion) -> CertifiedMotion | None:
    """The mirror image of a motion, z -> -z half a period later; None if the image is the motion itself or not a motion
    of the problem."""
    twins = half_periods.twins
    if twins is None or motion.symmetric:
        return None
    points = tuple(half_periods.marched(point, 1) for point in motion.points)
    impulses = tuple(-motion.impulses[twin] for twin in twins)
    image = replace(motion, points=points, impulses=impulses)
    return None if same_motion(half_periods, motion, image) else image


def same_motion(half_periods: HalfPeriods, one: CertifiedMotion, other: CertifiedMotion) -> bool:
    """Whether two certified motions are one motion, which may start at different periods."""
    if one.period_multiple != other.period_multiple:
        return False
    allowed = max(SAME_ORBIT, 10 * (one.residual + other.residual))
    return any(half_periods.apart(one.points[0], point) <= allowed for point in other.points)


def traps_of(half_periods: HalfPeriods, motion: CertifiedMotion) -> tuple[Trap, ...]:
    """The traps of a motion, one for each of its section points, over its whole period."""
    count = 2 * motion.period_multiple
    return tuple(
        Trap(Orbit(count, point, motion.residual, half_periods.linearised(point, count))) for point in motion.points
    )
