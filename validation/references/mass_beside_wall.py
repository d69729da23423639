"""One mass on a spring whose base moves past a wall that stands still, by its closed form between two switches.

With z relative to the base, whose acceleration is y'' = sin(omega t), and a wall at a gap,

    m z'' + c z' + k z = -m y'',                          while z + y < gap,
    m z'' + c z' + (k + k_w) z = -m y'' + k_w (gap - y)   else.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

_STEPS = 400  # in the shorter of the two free periods, to look for a switch
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(24)  # exact to rounding over half a swing


@dataclass(frozen=True)
class Hit:
    """One contact with the wall."""

    start: float
    """s."""
    end: float
    """s."""
    impulse: float
    """N s."""
    peak: float
    """N."""
    middle: float
    """Force half way from start to end, N."""


@dataclass(frozen=True)
class MassBesideWall:
    """The mass, its spring, and the wall."""

    mass: float
    """kg."""
    stiffness: float
    """N/m, of the spring."""
    ratio: float
    """Damping ratio of the mass on its spring."""
    omega: float
    """rad/s, of the base, whose acceleration is sin(omega t), m/s2."""
    wall: float
    """Stiffness of the wall, N/m."""
    gap: float
    """Gap while the base is in the middle of its motion, m."""

    @property
    def drag(self) -> float:
        """Damping coefficient c, N s/m."""
        return 2 * self.ratio * math.sqrt(self.stiffness * self.mass)

    def hits(self, duration: float) -> list[Hit]:
        """The contacts from rest that end before a time, s."""
        found, t, z, v, pressed = list[Hit](), 0.0, 0.0, 0.0, False
        while True:
            stretch = _Stretch(self, t, z, v, pressed)
            length = stretch.until_switch(duration - t)
            if length is None:
                return found
            if pressed:
                middle = self.wall * stretch.depth(length / 2)
                found.append(Hit(t, t + length, *stretch.impulse_and_peak(length), middle))
            (z, v), t, pressed = stretch.at(length), t + length, not pressed


class _Stretch:
    """The motion from displacement `z`, m, and velocity `v`, m/s, at time `t`, s, while the wall is pressed or not."""

    def __init__(self, of: MassBesideWall, t: float, z: float, v: float, pressed: bool) -> None:
        m, w = of.mass, of.omega
        k, c = of.stiffness / m + pressed * of.wall / m, of.drag / m
        # y = -sin(w t) / w^2: the wall adds k_w sin(w t) / w^2 to the force
        self._answer = (-1.0 + pressed * of.wall / m / w**2) / (k - w**2 + 1j * c * w) * cmath.exp(1j * w * t)
        self._rest = pressed * of.wall * of.gap / m / k
        self._root = -c / 2 + 1j * math.sqrt(k - c**2 / 4)
        x, rate = z - self._rest - self._answer.imag, v - w * self._answer.real
        self._free = x - 1j * (rate - self._root.real * x) / self._root.imag
        self._of, self._t, self._pressed, self._step = of, t, pressed, 2 * math.pi / math.sqrt(k) / _STEPS

    def at(self, s: float) -> tuple[float, float]:
        """Displacement, m, and velocity, m/s, relative to the base, `s` seconds later."""
        wave, own = self._answer * cmath.exp(1j * self._of.omega * s), self._free * cmath.exp(self._root * s)
        return self._rest + wave.imag + own.real, self._of.omega * wave.real + (self._root * own).real

    def depth(self, s: float) -> float:
        """Penetration of the wall, m."""
        return self.at(s)[0] - math.sin(self._of.omega * (self._t + s)) / self._of.omega**2 - self._of.gap

    def rate(self, s: float) -> float:
        """Rate of the penetration, m/s."""
        return self.at(s)[1] - math.cos(self._of.omega * (self._t + s)) / self._of.omega

    def until_switch(self, most: float) -> float | None:
        """Time to the next switch, s; None if there is none within `most`, s."""
        s, sign = 1e-3 * self._step, -1.0 if self._pressed else 1.0
        while sign * self.depth(s + self._step) < 0:
            s += self._step
            if s > most:
                return None
        found = float(brentq(self.depth, s, s + self._step, xtol=1e-17, rtol=1e-15))
        return found if found <= most else None

    def impulse_and_peak(self, length: float) -> tuple[float, float]:
        """Impulse, N s, and largest force, N, of a contact that lasts `length`, s, and has one maximum."""
        force = [self._of.wall * self.depth(length / 2 * (1 + float(u))) for u in _POINTS]
        deepest = float(brentq(self.rate, 0.0, length))
        return float(length / 2 * (_WEIGHTS @ force)), self._of.wall * self.depth(deepest)
