"""Motions under noise that cost next to nothing, for populations: modal oscillators in steps, with stops.

Each mode obeys q'' + 2 zeta w q' + w^2 q = p a(t) + c F, where the acceleration a is linear between samples of white
noise, p is the share of the mode, and F the forces of the stops, taken at the start of a step: intervals do not ask how
exact a motion is.  A step is a 64th of a period of the fastest mode.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from lapjoint import FREE, Beam, ContactState, History, ModalDamping, Problem, Stop, Support
from lapjoint.answers import Contact, Modes
from lapjoint.compiled.arrays import zeros
from lapjoint.compiled.compiling import njit_called
from lapjoint.problem import FloatArray
from lapjoint.solver import Progress

RATIO = 0.1
STEPS = 64


@dataclass(frozen=True)
class Noisy:
    """A solver of one problem: natural frequencies, rad/s, and shapes at `x`, which are interpolated."""

    omega: tuple[float, ...]
    x: tuple[float, ...]
    shapes: tuple[tuple[float, ...], ...]
    """Of each mode, at `x`; the first row as many as modes."""
    share: tuple[float, ...]
    """What the acceleration drives of each mode, and the unit of force."""
    seed: int

    @property
    def name(self) -> str:
        """Name in a line."""
        return "noisy"

    def modes(self, problem: Problem, state: ContactState = FREE, count: int = 1) -> Modes:
        """Those that it has; shapes are of no use here."""
        return Modes(state, np.resize(self.omega, count), lambda x, dx=0: np.zeros((count, np.size(x))))

    def stream(self, problem: Problem, duration: float, *, progress: Progress | None = None) -> Iterator[History]:
        """The motion from rest, in ten stretches."""
        omega, stops = np.array(self.omega), problem.stops
        step = 2 * math.pi / omega.max() / STEPS
        count = math.ceil(duration / step) + 2
        noise = np.random.default_rng(self.seed).standard_normal(count // 8 + 2)
        at_stops = np.array([self._at(np.array([stop.x])) for stop in stops])[:, :, 0]
        sign, gap, k = (np.array([float(getattr(one, name)) for one in stops]) for name in ("sign", "gap", "stiffness"))
        motion, events = marched(omega, RATIO, np.array(self.share), at_stops, sign, gap, k, noise, step, count)
        contacts = contacts_of(events, problem)
        edges = np.linspace(0.0, duration, 11)
        for start, end in pairwise(edges.tolist()):
            inside = tuple(_part(c, start, end) for c in contacts if c.start < end and c.end > start)
            yield History(
                problem,
                self.name,
                start,
                end,
                np.zeros(0),
                (FREE,),
                inside,
                _Sampled(self, motion, step),  # type: ignore[arg-type]
            )

    def _at(self, x: FloatArray) -> FloatArray:
        return np.array([np.interp(x, self.x, row) for row in self.shapes])


def _part(c: Contact, start: float, end: float) -> Contact:
    """The part of a contact in a stretch, with all of its impulse where it begins."""
    cut, goes_on = c.start < start, c.end > end
    lo, hi = max(c.start, start), min(c.end, end)
    return Contact(c.stop, lo, hi, 0.0 if cut else c.impulse, c.peak_force, open_start=cut, open_end=goes_on)


@dataclass(frozen=True)
class _Sampled:
    """q, q' and q'' between steps."""

    solver: Noisy
    motion: FloatArray
    step: float

    def __call__(self, x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        s = t / self.step
        i = s.astype(int)
        low, high = self.motion[dt][:, i], self.motion[dt][:, i + 1]
        return np.asarray(self.solver._at(x).T @ (low + (s - i) * (high - low)))


@njit_called()
def marched(omega, ratio, share, at_stops, sign, gap, k, noise, step, count):  # type: ignore[no-untyped-def]
    """q, q', q'' at steps, and rows of stop, start, end, impulse and peak force."""
    modes, stops = omega.size, sign.size
    motion, events = zeros((3, modes, count)), zeros((count, 5))
    found = 0
    q, v, force = zeros(modes), zeros(modes), zeros(modes)
    began, impulse, peak = zeros(stops), zeros(stops), zeros(stops)
    began[:] = -1.0
    for n in range(count):
        t = n * step
        j = n // 8
        a = noise[j] + (noise[j + 1] - noise[j]) * (n % 8) / 8
        force[:] = 0.0
        for s in range(stops):
            z, w = 0.0, 0.0
            for i in range(modes):
                z += at_stops[s, i] * q[i]
                w += at_stops[s, i] * v[i]
            deep = sign[s] * z - gap[s]
            if deep > 0:
                f = k[s] * deep
                if began[s] < 0:
                    late = deep / max(sign[s] * w, 1e-300)
                    began[s], impulse[s], peak[s] = t - min(late, step), 0.0, 0.0
                impulse[s] += f * step
                peak[s] = max(peak[s], f)
                for i in range(modes):
                    force[i] -= sign[s] * f * at_stops[s, i]
            elif began[s] >= 0:
                late = deep / min(sign[s] * w, -1e-300)
                end = max(t - min(late, step), began[s] + 1e-9)
                events[found, 0], events[found, 1], events[found, 2] = s, began[s], end
                events[found, 3], events[found, 4] = impulse[s], peak[s]
                found += 1
                began[s] = -1.0
        for i in range(modes):
            acceleration = share[i] * a + force[i] - 2 * ratio * omega[i] * v[i] - omega[i] ** 2 * q[i]
            motion[0, i, n], motion[1, i, n], motion[2, i, n] = q[i], v[i], acceleration
            v[i] += step * acceleration
            q[i] += step * v[i]
    return motion, events[:found]


def contacts_of(events: FloatArray, problem: Problem) -> list[Contact]:
    """The contacts, by their starts."""
    order = np.argsort(events[:, 1], kind="stable")
    return [
        Contact(int(s), start, end, problem.stops[int(s)].sign * impulse, peak)
        for s, start, end, impulse, peak in events[order].tolist()
    ]


def bar(seed: int) -> tuple[Problem, Noisy]:
    """A rigid bar that bounces on a stiff stop, and reaches a far one now and then."""
    problem = Problem(
        beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
        supports=(Support(x=0.0, translational=0.5), Support(x=1.0, translational=0.5)),
        stops=(
            Stop(name="near", x=0.5, side="top", gap=0.2, stiffness=20.0),
            Stop(name="far", x=0.5, side="bottom", gap=3.3, stiffness=5.0),
        ),
        damping=ModalDamping(ratio=RATIO),
    )
    return problem, Noisy((1.0,), (0.0, 1.0), ((1.0, 1.0),), (1.0,), seed)


def beam(seed: int) -> tuple[Problem, Noisy]:
    """A cantilever of two modes between stops so soft that it is linear: they count how often it goes how far."""
    omega, x = (1.0, 6.267), np.linspace(0.0, 1.0, 65)
    bent = (1.8751, 4.6941)
    ratio = [(math.sinh(b) - math.sin(b)) / (math.cosh(b) + math.cos(b)) for b in bent]
    rows = [
        np.cosh(b * x) - np.cos(b * x) - r * (np.sinh(b * x) - np.sin(b * x)) for b, r in zip(bent, ratio, strict=True)
    ]
    problem = Problem(
        beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
        supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
        stops=(
            Stop(name="often", x=1.0, side="top", gap=0.3, stiffness=1e-9),
            Stop(name="seldom", x=1.0, side="bottom", gap=1.9, stiffness=1e-9),
        ),
        damping=ModalDamping(ratio=RATIO),
    )
    return problem, Noisy(omega, tuple(x.tolist()), tuple(tuple(row.tolist()) for row in rows), (0.783, 0.434), seed)
