r"""Periodic motions of forced bilinear systems with one contact, and their bifurcations, in closed form.

    M u'' + C_1 u' + K_1 u = G Y omega^2 sin(omega t) + f_1,                  N . u < gap,
    M u'' + C_2 u' + K_2 u = G Y omega^2 sin(omega t) + f_1 + k gap N,        N . u > gap,     K_2 = K_1 + k N N^T,

with n coordinates u.  A motion that touches the stop once in some periods of the load is known but for the phase of the
load, its amplitude and what u and u' are at both ends of the contact, where N . u = gap: 4 n numbers, of which the
phase and the amplitude stand for (A, B) = Y (cos, sin) of the phase at which the contact begins.  In both pieces u and
u' at the end are linear in those at the start and in (A, B), so that once the duration d of the contact is given, the
4 n conditions that the pieces meet are linear equations.  So Y(d) is explicit.  With m the product of both pieces'
matrices and of the jumps of deviations at the stop, where the damping force jumps if C_1 and C_2 differ, there lies

    a fold              at an extremum of Y(d),
    a flip              at a root of det(1 + m(d)),
    a Neimark-Sacker    where a complex pair of eigenvalues of m(d) has the modulus one.

Between two equal stops (`mirrored`) a motion that mirrors itself touches either once, half a period of the load after
the other: then the pieces make up half a period and end where the mirror image of the motion begins, m has the sign
minus, and the root of det(1 + m(d)) is where the symmetry breaks.

S. W. Shaw and P. J. Holmes, "A periodically forced piecewise linear oscillator", J. Sound Vib. 90 (1983) 129-155, give
the map of this oscillator for n = 1; there the times of the switches are solved for instead, which is not needed here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy.linalg import null_space
from scipy.optimize import brentq, minimize_scalar

from validation.references.rigid_bar import RigidBar

Array = npt.NDArray[np.float64]
_STATIONS = 4000  # Durations of contact, evenly spaced over all possible ones, between which bifurcations are sought
_SAMPLES = 400  # Samples of each piece at which the motion must be on its side of the stop
_CLOSE = 1e-14  # Tolerance of durations over the period
_TIGHT = 1e-7  # Tolerance of an extremum of Y over the range of durations; the error of Y is its square
_REAL = 1e-9  # Largest imaginary part of a real multiplier over its modulus


@dataclass(frozen=True, eq=False)
class Piece:
    """One side of the stop: M u'' + C u' + K u = K level + load; scalars serve where n is 1."""

    mass: float | Array
    """kg, shape ``(n, n)``."""
    damping: float | Array
    """N s/m, shape ``(n, n)``."""
    stiffness: float | Array
    """N/m, shape ``(n, n)``."""
    level: float | Array
    """Displacement at rest without load, m, shape ``(n,)``."""

    @cached_property
    def count(self) -> int:
        """Number n of coordinates."""
        return int(np.atleast_2d(self.mass).shape[0])

    @cached_property
    def rest(self) -> Array:
        """(level, 0), shape ``(2 n,)``."""
        return np.append(np.atleast_1d(self.level), np.zeros(self.count))

    @cached_property
    def _modes(self) -> tuple[npt.NDArray[np.complex128], npt.NDArray[np.complex128], npt.NDArray[np.complex128]]:
        """Eigenvalues and eigenvectors of the first-order system, and the inverse of these."""
        M, C, K = (np.atleast_2d(one) for one in (self.mass, self.damping, self.stiffness))
        zero, one = np.zeros_like(M), np.eye(self.count)
        values, vectors = np.linalg.eig(np.block([[zero, one], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]]))
        return values.astype(complex), vectors.astype(complex), np.linalg.inv(vectors.astype(complex))

    def transfer(self, t: float | Array) -> Array:
        """Transfer matrix of (u - level, u'), m and m/s, without load over times `t`, s: shape t.shape + (2 n, 2 n)."""
        values, vectors, inverse = self._modes
        return np.asarray(((vectors * np.exp(np.multiply.outer(t, values))[..., None, :]) @ inverse).real)

    def response(self, omega: float, force: float | Array) -> npt.NDArray[np.complex128]:
        """Complex amplitude, m, shape (n,), of the steady motion under a harmonic force, N, shape (n,), at `omega`
        rad/s."""
        M, C, K = (np.atleast_2d(one) for one in (self.mass, self.damping, self.stiffness))
        return np.asarray(np.linalg.solve(K - omega**2 * M + 1j * omega * C, np.atleast_1d(force).astype(complex)))


@dataclass(frozen=True, eq=False)
class OneContact:
    """A motion with one contact in its pieces; time counts from the start of the contact."""

    duration: float
    """Duration of the contact, s."""
    amplitude: float
    """Amplitude Y of the base, m."""
    phase: float
    """Phase of the load where the contact begins, rad."""
    start: Array
    """(u, u') at the start of the contact, m and m/s, shape ``(2 n,)``."""
    end: Array
    """(u, u') at its end, shape ``(2 n,)``."""
    multipliers: tuple[complex, ...]
    """Multipliers over the pieces, by falling modulus: over half a period for a mirrored motion."""


@dataclass(frozen=True, eq=False)
class BilinearMap:
    """The system under a load of one frequency, and its motions with one contact in `periods` of it."""

    free: Piece
    """The system without contact."""
    pressed: Piece
    """The system in contact."""
    lever: float | Array
    """N: displacement at the stop by each coordinate, shape ``(n,)``."""
    gap: float
    """Gap of the stop, m."""
    load: float | Array
    """G, kg, shape ``(n,)``: the force's amplitude is G Y omega^2."""
    omega: float
    """Frequency of the load, rad/s."""
    periods: int = 1
    mirrored: bool = False
    """Whether the motions mirror themselves between two equal stops, in one period."""

    @staticmethod
    def of_bar(bar: RigidBar) -> BilinearMap:
        """The system of a rigid bar shaken at its base against one stop, or between two equal ones."""
        pieces = [Piece(bar.M, *bar.matrices(closed)) for closed in (frozenset[int](), frozenset({0}))]
        base, stop = bar.tables["base_motion"], bar.stops[0]
        return BilinearMap(
            pieces[0],
            pieces[1],
            stop["sign"] * bar.rows[0],
            stop["gap"],
            bar.by_inertia(added=True),
            base["angular_frequency"],
            mirrored=len(bar.stops) == 2,
        )

    @property
    def period(self) -> float:
        """Duration of the two pieces, s: of the motions, or half of that if they mirror themselves."""
        return self.periods * 2 * math.pi / self.omega / (2 if self.mirrored else 1)

    @property
    def _sign(self) -> float:
        return -1.0 if self.mirrored else 1.0

    @cached_property
    def _row(self) -> Array:
        """The displacement at the stop by (u, u'), shape ``(2 n,)``."""
        return np.append(np.atleast_1d(self.lever), np.zeros(self.free.count))

    def motion(self, d: float) -> OneContact:
        """The motion of a duration of contact, whether or not it is on the right side of the stop."""
        return self.motions(np.array([d]))[0]

    def motions(self, d: Array) -> list[OneContact]:
        """The motion of each duration of contact, `d` in s, shape (m,), above zero and below the period."""
        size, count = 2 * self.free.count, d.size
        # At the stop (u, u') = touch + along . s, with s of 2 n - 1 numbers.
        touch, along = self.gap * self._row / (self._row @ self._row), null_space(self._row[None, :])
        equations, rest = np.zeros((count, 2 * size, 2 * size)), np.zeros((count, 2 * size))
        moves = [self.pressed.transfer(d), self.free.transfer(self.period - d)]
        first, last = slice(2, 1 + size), slice(1 + size, None)  # of the unknowns: A, B, s at the start, s at the end
        for i, (piece, begins, ends) in enumerate(
            ((self.pressed, np.zeros(count), d), (self.free, d, np.full(count, self.period)))
        ):
            move, wave, rows = moves[i], self._wave(piece), slice(i * size, (i + 1) * size)
            sign = self._sign if i else 1.0
            equations[:, rows, :2] = wave(ends) - move @ wave(begins)
            equations[:, rows, last if i else first] += move @ along
            equations[:, rows, first if i else last] -= sign * along
            rest[:, rows] = sign * touch - piece.rest - move @ (touch - piece.rest)
        found = np.linalg.solve(equations, rest[:, :, None])[:, :, 0]
        starts, ends = touch + found[:, first] @ along.T, touch + found[:, last] @ along.T
        spectra = np.linalg.eigvals(self._sign * moves[1] @ self._jumps(ends, -1) @ moves[0] @ self._jumps(starts, 1))
        return [
            OneContact(
                float(d[i]),
                math.hypot(*found[i, :2]),
                math.atan2(found[i, 1], found[i, 0]),
                starts[i],
                ends[i],
                tuple(complex(one) for one in sorted(spectra[i], key=abs, reverse=True)),
            )
            for i in range(count)
        ]

    def _wave(self, piece: Piece) -> Callable[[float | Array], Array]:
        """(u, u') of the steady motion under A sin(omega t) + B cos(omega t), by A and B: shape ``(..., 2 n, 2)``."""
        unit = piece.response(self.omega, np.atleast_1d(self.load) * self.omega**2)
        whole = np.append(unit, 1j * self.omega * unit)

        def at(t: float | Array) -> Array:
            now = np.multiply.outer(np.exp(1j * self.omega * np.asarray(t)), whole)
            return np.stack([now.imag, now.real], axis=-1)

        return at

    def _jumps(self, states: Array, sign: int) -> Array:
        """Jump of deviations at a switch of each state: an early switch has the damping of the other side for
        longer."""
        size, n = states.shape[1], self.free.count
        change = np.atleast_2d(self.free.damping) - np.atleast_2d(self.pressed.damping)
        force = sign * np.linalg.solve(np.atleast_2d(self.free.mass), change @ states[:, n:].T).T
        jumps = np.zeros((len(states), size, size))
        jumps[:, n:, :] = force[:, :, None] * self._row / (states[:, n:] @ np.atleast_1d(self.lever))[:, None, None]
        return np.eye(size) + jumps

    def state(self, motion: OneContact, t: float) -> Array:
        """u and u' of a motion, m and m/s, shape (2 n,), `t` s (of any size) after its contact began."""
        turns, t = divmod(t, self.period)
        piece, start, deviation, load = self._begins(motion, t < motion.duration)
        now = piece.transfer(t - start) @ deviation + self._wave(piece)(t) @ load + piece.rest
        return np.asarray(self._sign**turns * now)

    def start(self, motion: OneContact) -> Array:
        """u and u' of a motion, m and m/s, shape (2 n,), where the phase of the load is zero."""
        return self.state(motion, -motion.phase / self.omega)

    def _begins(self, motion: OneContact, pressed: bool) -> tuple[Piece, float, Array, Array]:
        """A piece of a motion: its start, (u, u') there less level and steady motion, and (A, B)."""
        piece, start, state = self.free, motion.duration, motion.end
        if pressed:
            piece, start, state = self.pressed, 0.0, motion.start
        load = motion.amplitude * np.array([math.cos(motion.phase), math.sin(motion.phase)])
        return piece, start, state - piece.rest - self._wave(piece)(start) @ load, load

    def exists(self, motion: OneContact) -> bool:
        """Whether a motion is beyond the stop in its contact, and nowhere else."""
        speeds = [np.atleast_1d(self.lever) @ state[self.free.count :] for state in (motion.start, motion.end)]
        if not speeds[0] > 0 > speeds[1]:
            return False
        pressed, free = (self._heights(motion, pressed) for pressed in (True, False))
        return bool((pressed > 0).all() and (free < 0).all() and not (self.mirrored and (free < -2 * self.gap).any()))

    def _heights(self, motion: OneContact, pressed: bool) -> Array:
        """Displacement beyond the stop within a piece, m, shape ``(samples,)``."""
        piece, start, deviation, load = self._begins(motion, pressed)
        length = motion.duration if pressed else self.period - motion.duration
        t = np.linspace(0.0, length, _SAMPLES)[1:-1]
        values, vectors, inverse = piece._modes
        free = np.exp(np.multiply.outer(t, values)) @ ((self._row @ vectors) * (inverse @ deviation))
        forced = self._row @ (self._wave(piece)(start + t) @ load).T
        return np.asarray(free.real + forced + self._row @ piece.rest - self.gap)

    @cached_property
    def stations(self) -> list[OneContact]:
        """Motions of all durations of contact, whether or not they exist."""
        return self.motions(np.linspace(0.0, self.period, _STATIONS + 2)[1:-1])

    def folds(self) -> list[OneContact]:
        """The motions of least or largest amplitude among their neighbours, whether or not they exist."""
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
        """The motions with a multiplier of -1, where the symmetry of mirrored motions breaks."""
        return self._roots(lambda motion: float(np.prod(1 + np.array(motion.multipliers)).real))

    def neimark_sackers(self) -> list[OneContact]:
        """The motions with a complex pair of multipliers on the unit circle."""

        # The product of 1 - mu_i mu_j over i < j vanishes there, and where mu_i = 1 / mu_j are real.
        def beyond(motion: OneContact) -> float:
            mu = np.array(motion.multipliers)
            return float(np.prod(1 - np.outer(mu, mu)[np.triu_indices(mu.size, 1)]).real)

        return [one for one in self._roots(beyond) if _on_circle(one.multipliers)]

    def _roots(self, function: Callable[[OneContact], float]) -> list[OneContact]:
        """The motions at which a function changes its sign."""
        values = [function(one) for one in self.stations]
        return [
            self.motion(
                float(
                    brentq(
                        lambda d: function(self.motion(d)),
                        a.duration,
                        b.duration,
                        xtol=_CLOSE * self.period,
                        rtol=1e-15,
                    )
                )
            )
            for (a, b), (one, other) in zip(pairwise(self.stations), pairwise(values), strict=True)
            if (one > 0) != (other > 0)
        ]


def _on_circle(multipliers: Sequence[complex]) -> bool:
    """Whether the multiplier whose modulus is nearest to one is complex."""
    nearest = min(multipliers, key=lambda one: abs(abs(one) - 1))
    return abs(nearest.imag) > _REAL * abs(nearest)
