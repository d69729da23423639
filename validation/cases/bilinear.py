"""The undamped impact oscillator in closed form: one mass, a linear spring, and a second spring behind a gap.

x'' + omega_1^2 x = 0 for x < gap, and x'' + omega_2^2 x = (omega_2^2 - omega_1^2) gap beyond, with omega_2 > omega_1:
the bilinear oscillator of S. W. Shaw and P. J. Holmes, "A periodically forced piecewise linear oscillator", J. Sound
Vib. 90 (1983) 129-155, unforced.  Each piece is a sine, whose end brentq finds.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

from scipy.optimize import brentq


@dataclass(frozen=True)
class Piece:
    """A contact of the oscillator."""

    start: float
    """s."""
    end: float
    """s."""
    area: float
    """Time integral of x - gap over the contact, m s: the impulse divided by the stiffness."""
    depth: float
    """Largest x - gap, m."""


@dataclass(frozen=True)
class Bilinear:
    """The oscillator, leaving x = 0 with `speed` > 0 at t = 0."""

    omega_1: float
    """Angular frequency in free flight, rad/s."""
    omega_2: float
    """Angular frequency in contact, rad/s."""
    gap: float
    """m."""
    speed: float
    """m/s."""

    @property
    def first_impact(self) -> float:
        """Time of the first contact, s."""
        if self.gap == 0:
            return 0.0
        w = self.omega_1
        crossing = brentq(lambda t: self.speed / w * math.sin(w * t) - self.gap, 0.0, math.pi / 2 / w, xtol=1e-16)
        return float(crossing)

    @property
    def contact(self) -> Piece:
        """One contact, from its start at 0: x - gap = c (1 - cos omega_2 t) + (v / omega_2) sin omega_2 t."""
        w, v = self.omega_2, self.impact_speed
        c = -((self.omega_1 / w) ** 2) * self.gap  # distance of the equilibrium in contact from the gap

        def beyond(t: float) -> float:
            return c * (1 - math.cos(w * t)) + v / w * math.sin(w * t)

        top = (math.pi - math.atan2(v / w, c)) / w if c else math.pi / 2 / w
        end = float(brentq(beyond, top, 2 * top * (1 + 1e-9), xtol=1e-16))
        area = c * end - c / w * math.sin(w * end) + v / w**2 * (1 - math.cos(w * end))
        return Piece(0.0, end, area, beyond(top))

    @property
    def impact_speed(self) -> float:
        """Speed at every impact and rebound, m/s, by the energy of the flight."""
        return math.sqrt(self.speed**2 - (self.omega_1 * self.gap) ** 2)

    @property
    def period(self) -> float:
        """Time from one impact to the next, s: a contact, and a flight that is symmetric about its lowest point."""
        return self.contact.end + math.pi / self.omega_1 + 2 * self.first_impact

    def contacts(self, count: int) -> tuple[Piece, ...]:
        """The first contacts."""
        one, begin = self.contact, self.first_impact
        starts = [begin + n * self.period for n in range(count)]
        return tuple(Piece(start, start + one.end, one.area, one.depth) for start in starts)

    def harmonic(self, n: int) -> float:
        """Magnitude of the n-th complex Fourier coefficient of x over a period, m; for a gap of zero."""
        assert self.gap == 0
        omega = 2 * math.pi / self.period
        in_contact = _half_sine(self.omega_2, n * omega)
        in_flight = -cmath.exp(-1j * n * omega * math.pi / self.omega_2) * _half_sine(self.omega_1, n * omega)
        parts = in_contact * self.speed / self.omega_2 + in_flight * self.speed / self.omega_1
        return abs(parts) / self.period


def classical_frequency(omega_1: float, omega_2: float) -> float:
    """Angular frequency of the bilinear oscillator without a gap, 2 omega_1 omega_2 / (omega_1 + omega_2)."""
    return 2 * omega_1 * omega_2 / (omega_1 + omega_2)


def _half_sine(omega: float, s: float) -> complex:
    """Integral of sin(omega t) exp(-i s t) over half a period of the sine, for s other than omega."""
    return omega * (1 + cmath.exp(-1j * s * math.pi / omega)) / (omega**2 - s**2)
