r"""Periodic motions of the forced bilinear oscillator with one contact, their folds and flips, in closed form.

    M u'' + C_1 u' + K_1 u = G Y omega^2 sin(omega t)                        N u < gap,
    M u'' + C_2 u' + K_2 u = G Y omega^2 sin(omega t) + k N gap,             N u > gap,     K_2 = K_1 + k N^2.

A motion that touches the stop once in n periods of the load is known but for the phase of the load, its amplitude and
the two speeds at the stop once the duration d of its contact is given: in both pieces displacement and speed at the end
are linear in those at the start and in (A, B) = Y (cos, sin) of the phase at which the contact begins, and the four
conditions that the pieces meet at the stop are four linear equations for the four.  So Y(d) is explicit, and

    a fold    is an extremum of Y(d),
    a flip    is a root of det(1 + m(d)), with m the product of both pieces' matrices and of the jumps of deviations at
              the stop, where the damping force jumps if C_1 and C_2 differ.

S. W. Shaw and P. J. Holmes, "A periodically forced piecewise linear oscillator", J. Sound Vib. 90 (1983) 129-155, give
the map of this oscillator; there the times of the switches are solved for instead, which is not needed here.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq, minimize_scalar

Array = npt.NDArray[np.float64]
_STATIONS = 4000
"""Durations of the contact, evenly over all that are possible, between which folds and flips are looked for."""
_SAMPLES = 400  # of each piece, at which it must be on its side of the stop
_CLOSE = 1e-14  # of the period: durations are found as closely
_TIGHT = 1e-7  # of the range of durations: how closely an extremum of Y is known, which leaves the square of this in Y


@dataclass(frozen=True)
class Piece:
    """One side of the stop: M u'' + C u' + K u = constant + load."""

    mass: float
    """kg."""
    damping: float
    """N s/m."""
    stiffness: float
    """N/m."""
    level: float
    """Displacement at rest without load, m."""

    def transfer(self, t: float) -> Array:
        """What becomes of (u - level, u') without load in a time.

        Parameters
        ----------
        t : float
            s.

        Returns
        -------
        Array, shape (2, 2)
            In m and m/s.
        """
        a = self.damping / (2 * self.mass)
        w = math.sqrt(self.stiffness / self.mass - a**2)
        c, s, e = math.cos(w * t), math.sin(w * t), math.exp(-a * t)
        return e * np.array([[c + a / w * s, s / w], [-(w + a**2 / w) * s, c - a / w * s]])

    def response(self, omega: float, force: float) -> complex:
        """Complex amplitude of the steady motion under a harmonic force.

        Parameters
        ----------
        omega : float
            rad/s.
        force : float
            N.

        Returns
        -------
        complex
            m.
        """
        return force / complex(self.stiffness - self.mass * omega**2, self.damping * omega)


@dataclass(frozen=True)
class OneContact:
    """A motion with one contact in its period; time counts from the start of the contact."""

    duration: float
    """Of the contact, s."""
    amplitude: float
    """Of the base, Y, m."""
    phase: float
    """Of the load where the contact begins, rad."""
    speeds: tuple[float, float]
    """u' at the start and at the end of the contact, m/s."""
    multipliers: tuple[complex, complex]
    """Over its period."""


@dataclass(frozen=True)
class BilinearMap:
    """The oscillator under a load of one frequency, and its motions with one contact in `periods` of it."""

    free: Piece
    """Without contact."""
    pressed: Piece
    """In contact."""
    lever: float
    """N: displacement at the stop over u."""
    gap: float
    """m."""
    load: float
    """G, kg: the force's amplitude is G Y omega^2."""
    omega: float
    """rad/s."""
    periods: int = 1

    @property
    def period(self) -> float:
        """Of the motions, s."""
        return self.periods * 2 * math.pi / self.omega

    @property
    def touch(self) -> float:
        """u at the stop, m."""
        return self.gap / self.lever

    def motion(self, d: float) -> OneContact:
        """The motion of a duration of contact, whether or not it is on the right side of the stop.

        Parameters
        ----------
        d : float
            s, above zero and below the period.

        Returns
        -------
        OneContact
            Its amplitude is above zero.
        """
        equations, rest = np.zeros((4, 4)), np.zeros(4)  # unknown: A, B, speed at the start, speed at the end
        for i, (piece, start, end) in enumerate(((self.pressed, 0.0, d), (self.free, d, self.period))):
            move = piece.transfer(end - start)
            wave = self._wave(piece)
            rows = slice(2 * i, 2 * i + 2)
            equations[rows, :2] = wave(end) - move @ wave(start)
            equations[rows, 2 + i] += move @ [0.0, 1.0]
            equations[rows, 3 - i] -= np.array([0.0, 1.0])
            rest[rows] = np.array([self.touch - piece.level, 0.0]) - move @ [self.touch - piece.level, 0.0]
        A, B, first, last = (float(value) for value in np.linalg.solve(equations, rest))
        return OneContact(d, math.hypot(A, B), math.atan2(B, A), (first, last), self._multipliers(d))

    def _wave(self, piece: Piece) -> Callable[[float], Array]:
        """(u, u') of the steady motion by A and by B: under A sin(omega t) + B cos(omega t), shape ``(2, 2)``."""
        unit = piece.response(self.omega, self.load * self.omega**2)

        def at(t: float) -> Array:
            now = unit * complex(math.cos(self.omega * t), math.sin(self.omega * t))
            rate = 1j * self.omega * now
            return np.array([[now.imag, now.real], [rate.imag, rate.real]])

        return at

    def _multipliers(self, d: float) -> tuple[complex, complex]:
        """Of the pieces, and of the jumps: what is early at a switch has the other side's damping force for longer."""
        change = (self.free.damping - self.pressed.damping) / self.free.mass
        there, back = (np.array([[1.0, 0.0], [sign * change, 1.0]]) for sign in (1, -1))
        matrix = self.free.transfer(self.period - d) @ back @ self.pressed.transfer(d) @ there
        one, other = np.linalg.eigvals(matrix)
        return complex(one), complex(other)

    def state(self, motion: OneContact, t: float) -> tuple[float, float]:
        """u and u' of a motion at a time since its contact began.

        Parameters
        ----------
        motion : OneContact
            The motion.
        t : float
            s; of any size.

        Returns
        -------
        tuple of float
            m and m/s.
        """
        t %= self.period
        piece, start, deviation, load = self._begins(motion, t < motion.duration)
        u, v = piece.transfer(t - start) @ deviation + self._wave(piece)(t) @ load
        return float(u) + piece.level, float(v)

    def _begins(self, motion: OneContact, pressed: bool) -> tuple[Piece, float, Array, Array]:
        """A piece of a motion: its start, (u, u') there less level and steady motion, and (A, B)."""
        piece, start, speed = self.free, motion.duration, motion.speeds[1]
        if pressed:
            piece, start, speed = self.pressed, 0.0, motion.speeds[0]
        load = motion.amplitude * np.array([math.cos(motion.phase), math.sin(motion.phase)])
        return piece, start, np.array([self.touch - piece.level, speed]) - self._wave(piece)(start) @ load, load

    def exists(self, motion: OneContact) -> bool:
        """Whether a motion is beyond the stop in its contact, and nowhere else.

        Parameters
        ----------
        motion : OneContact
            The motion.

        Returns
        -------
        bool
            At as many points as a piece has samples.
        """
        if not motion.speeds[0] > 0 > motion.speeds[1]:
            return False
        heights = [self._heights(motion, pressed) for pressed in (True, False)]
        return bool((heights[0] > 0).all() and (heights[1] < 0).all())

    def _heights(self, motion: OneContact, pressed: bool) -> Array:
        """u beyond the stop within a piece, m, shape ``(samples,)``."""
        piece, start, (u, v), load = self._begins(motion, pressed)
        length = motion.duration if pressed else self.period - motion.duration
        t = np.linspace(0.0, length, _SAMPLES)[1:-1]
        a = piece.damping / (2 * piece.mass)
        w = math.sqrt(piece.stiffness / piece.mass - a**2)
        free = np.exp(-a * t) * (u * np.cos(w * t) + (v + a * u) / w * np.sin(w * t))
        unit = piece.response(self.omega, self.load * self.omega**2)
        turn = unit * np.exp(1j * self.omega * (start + t))
        return np.asarray(free + turn.imag * load[0] + turn.real * load[1] + piece.level - self.touch)

    @cached_property
    def stations(self) -> list[OneContact]:
        """Motions of all durations, whether or not they are."""
        return [self.motion(float(d)) for d in np.linspace(0.0, self.period, _STATIONS + 2)[1:-1]]

    def folds(self) -> list[OneContact]:
        """The motions of least or largest amplitude, of those beside them.

        Returns
        -------
        list of OneContact
            By their durations.
        """
        found = []
        for a, b, c in zip(self.stations, self.stations[1:], self.stations[2:], strict=False):
            sign = 1.0 if b.amplitude < min(a.amplitude, c.amplitude) else -1.0
            if sign > 0 or b.amplitude > max(a.amplitude, c.amplitude):
                inside = (a.duration, c.duration)

                def height(d: float, sign: float = sign) -> float:
                    return sign * self.motion(d).amplitude

                at = minimize_scalar(height, bounds=inside, method="bounded", options={"xatol": _TIGHT * self.period})
                found.append(self.motion(float(at.x)))
        return found

    def flips(self) -> list[OneContact]:
        """The motions with a multiplier of -1.

        Returns
        -------
        list of OneContact
            By their durations.
        """

        def beyond(motion: OneContact) -> float:
            one, other = motion.multipliers
            return float(((1 + one) * (1 + other)).real)

        return [
            self.motion(
                float(
                    brentq(
                        lambda d: beyond(self.motion(d)), a.duration, b.duration, xtol=_CLOSE * self.period, rtol=1e-15
                    )
                )
            )
            for a, b in pairwise(self.stations)
            if (beyond(a) > 0) != (beyond(b) > 0)
        ]
