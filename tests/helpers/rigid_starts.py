"""A bar that is all but rigid and begins at rest at a stop, in a hundred ways, and what it does then by power series.

The bar has a mass of 1 kg and moves without turning: u'' = F(t) - K u - c u' - stop forces, in N, m and s.  F is
chosen so that the first time derivative of the gap function that is not 0 has a given order and sign.  The witness sums
u as a power series in time from step to step; where it begins at a stop, the leading coefficients of the gap function
that are 0 are 0 exactly, and those left say at any small time on which side of the gap the bar is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lapjoint import BaseMotion, Beam, HarmonicsBaseMotion, HarmonicsLoad, NoDamping, Problem, SineLoad, StepLoad, Stop
from lapjoint.problem import (
    BaseHarmonic,
    LoadHarmonic,
    PolynomialShape,
    RecordLoad,
    Support,
    ViscousDamping,
)

ORDERS = (1, 2, 3, 4)
_TERMS, _STEP = 26, 0.02  # of the series, and how far each is summed, s: 15 rad/s times it is 0.3
_KNOTS = 0.1  # s between the knots of a record
_QUARTERS = (0.0, 1.0, 0.0, -1.0)  # sin of so many quarter turns
Contact = tuple[int, float, float, float]
"""Stop, start, s, end, s, and the time integral of the penetration times the stiffness, N s."""


@dataclass(frozen=True)
class Start:
    """A bar that begins at one or more stops."""

    stops: tuple[Stop, ...]
    stiffness: float
    """K of the spring at the middle, N/m."""
    drag: float
    """c, N s/m."""
    displacement: float
    """m."""
    velocity: float
    """m/s."""
    constant: float
    """N."""
    waves: tuple[tuple[float, float, int], ...]
    """Amplitude, N, angular frequency, rad/s, and phase in quarter turns, of each wave of the force."""
    record: tuple[float, ...]
    """Force at knots that are `_KNOTS` apart, N; none if empty."""
    rigidity: float
    """EI, N m2."""
    by_base: bool
    """Whether the waves are those of a moving base."""

    def problem(self) -> Problem:
        """The same as a problem."""
        loads: list[StepLoad | SineLoad | HarmonicsLoad | RecordLoad] = []
        base: BaseMotion | HarmonicsBaseMotion | None = None
        if self.constant:
            loads.append(StepLoad(x=0.5, force=self.constant))
        if self.record:
            loads.append(RecordLoad(x=0.5, values=self.record, rate=1 / _KNOTS))
        lowest = min((omega for _, omega, _ in self.waves), default=1.0)
        parts = [(a, round(omega / lowest), quarters * math.pi / 2) for a, omega, quarters in self.waves]
        if self.waves and self.by_base:
            moved = [(abs(a) / (n * lowest) ** 2, n, phase + (math.pi if a < 0 else 0.0)) for a, n, phase in parts]
            if len(moved) == 1:
                base = BaseMotion(amplitude=moved[0][0], angular_frequency=lowest, phase=moved[0][2])
            else:
                harmonics = tuple(BaseHarmonic(multiple=n, amplitude=a, phase=phase) for a, n, phase in moved)
                base = HarmonicsBaseMotion(angular_frequency=lowest, harmonics=harmonics)
        elif self.waves:
            harmonics_of_load = tuple(LoadHarmonic(multiple=n, force=a, phase=phase) for a, n, phase in parts)
            loads.append(HarmonicsLoad(x=0.5, angular_frequency=lowest, harmonics=harmonics_of_load))
        supports = (Support(x=0.5, translational=self.stiffness, torsional=self.rigidity),) if self.stiffness else ()
        return Problem(
            beam=Beam(length=1.0, bending_stiffness=self.rigidity, mass_per_length=1.0),
            supports=supports,
            stops=self.stops,
            damping=ViscousDamping(coefficient=self.drag) if self.drag else NoDamping(),
            base_motion=base,
            point_loads=tuple(loads),
            initial=PolynomialShape(displacement=(self.displacement,), velocity=(self.velocity,)),
        )

    def contacts(self, end: float) -> list[Contact]:
        """The contacts up to a time, s, by start time, then stop."""
        closed: set[int] = set()
        now, t, found = np.array([self.displacement, self.velocity]), 0.0, []
        since: dict[int, tuple[float, float]] = {}
        area, fresh, steps = np.zeros(len(self.stops)), set(range(len(self.stops))), 0
        while t < end - 1e-12:
            u = self._series(now, t, closed)
            if t == 0:
                closed = {k for k in fresh if _value(self._gap(k, u), 1e-4) > 0}
                since = dict.fromkeys(closed, (0.0, 0.0))
                u = self._series(now, t, closed)
            until = min(end, (steps + 1) * _STEP) - t
            tau, which = until, -1
            for k in range(len(self.stops)):
                h = self._gap(k, u) * (-1 if k in closed else 1)
                if k in fresh:
                    h[0] = 0.0
                    h = h[np.flatnonzero(h)[0] :] if h.any() else h
                at = _first_rise(h, tau)
                if at < tau:
                    tau, which = at, k
            integral = sum(u[n] * tau ** (n + 1) / (n + 1) for n in range(u.size))
            for k in closed:
                stop = self.stops[k]
                area[k] += stop.stiffness * (integral - stop.sign * stop.gap * tau)
            now = np.array([_value(u, tau), _value(u[1:] * np.arange(1, u.size), tau)])
            t, fresh = t + tau, set()
            if which < 0:
                steps += 1
                t = min(end, steps * _STEP)
                continue
            place = self.stops[which].sign * self.stops[which].gap
            fresh = {k for k, it in enumerate(self.stops) if it.sign * it.gap == place}
            for k in sorted(fresh):
                if k in closed:
                    begun, before = since.pop(k)
                    found.append((k, begun, t, float(area[k] - before)))
                else:
                    since[k] = (t, float(area[k]))
            closed = set(since)
        found += [(k, begun, end, float(area[k] - before)) for k, (begun, before) in since.items()]
        return sorted(found, key=lambda contact: (contact[1], contact[0]))

    def _series(self, now: np.ndarray, t: float, closed: set[int]) -> np.ndarray:
        """The coefficients of u in powers of the time from t on."""
        u = np.zeros(_TERMS)
        u[:2] = now
        for n in range(_TERMS - 2):
            force = self._force(t, n) - self.stiffness * u[n] - self.drag * (n + 1) * u[n + 1]
            for k in closed:
                stop = self.stops[k]
                force -= stop.stiffness * (u[n] - (stop.sign * stop.gap if n == 0 else 0.0))
            u[n + 2] = force / ((n + 1) * (n + 2))
        return u

    def _force(self, t: float, n: int) -> float:
        """The coefficient n of the force in powers of the time from t on."""
        total = self.constant if n == 0 else 0.0
        for a, omega, quarters in self.waves:
            angle = omega * t + quarters * math.pi / 2
            turned = (math.sin(angle), math.cos(angle), -math.sin(angle), -math.cos(angle))[n % 4]
            turned = _QUARTERS[(quarters + n) % 4] if t == 0 else turned
            total += a * omega**n / math.factorial(n) * turned
        if self.record and n < 2:
            j = min(int(t / _KNOTS + 1e-9), len(self.record) - 2)
            slope = (self.record[j + 1] - self.record[j]) / _KNOTS
            total += self.record[j] + slope * (t - j * _KNOTS) if n == 0 else slope
        return total

    def _gap(self, k: int, u: np.ndarray) -> np.ndarray:
        """The coefficients of sign u - gap."""
        h = self.stops[k].sign * u
        h[0] -= self.stops[k].gap
        return h


def start(seed: int, order: int, pressed: bool) -> Start:
    """A random bar at a stop: the first derivative that is not 0 has this order, and presses the bar on it or not."""
    rng = np.random.default_rng((seed, order, pressed))
    gap = 0.0 if rng.random() < 0.5 else float(10 ** rng.uniform(-3, -1))
    side, other = (("top", "bottom"), ("bottom", "top"))[rng.integers(2)]
    stiffness = float(10 ** rng.uniform(1, 3))
    stops = [Stop(x=0.5, side=side, gap=gap, stiffness=stiffness)]
    if rng.random() < 0.25:
        stops.append(Stop(x=0.5, side=side, gap=gap, stiffness=2 * stiffness))
    if rng.random() < 0.4:
        beyond = gap + float(rng.uniform(0.0, 0.2)) if gap else 0.0
        stops.append(Stop(x=0.5, side=other, gap=beyond, stiffness=float(10 ** rng.uniform(1, 3))))
    sign = stops[0].sign
    out = sign if pressed else -sign
    spring = float(10 ** rng.uniform(0.5, 2))
    omega, force = float(rng.uniform(4, 12)), out * float(10 ** rng.uniform(-0.5, 1))
    velocity, record, waves = 0.0, np.zeros(0), [(force, omega, 0)]
    rest = spring * (sign * gap)  # what holds the bar in balance at the gap
    constant = rest
    if order == 1:
        velocity = out * float(10 ** rng.uniform(-1, 0))
    if order == 2:
        waves = [(force, omega, 1)]
    if order == 4:
        waves = [(force, omega, 1), (-force, 2 * omega, 1)]  # cos - cos = 3/2 omega^2 t^2
    kind = rng.choice(["load", "base", "record" if order < 4 else "step"])
    if kind == "record":
        record = np.cumsum(np.concatenate([[0.0], rng.normal(scale=abs(force), size=20)]))
        record += force if order == 2 else 0.0
        record[1] = record[0] + force / 2
        waves = []
    if kind == "step":
        constant, waves = rest + force, [(-force, omega, 1)]
    rigidity, drag = float(10 ** rng.uniform(5.5, 6.5)), float(rng.choice([0.0, 0.2, 0.5]))
    bar = tuple(stops), spring, drag, sign * gap, velocity, constant, tuple(waves), tuple(record.tolist())
    return Start(*bar, rigidity, by_base=kind == "base")


def _value(series: np.ndarray, tau: float) -> float:
    return float(np.polynomial.polynomial.polyval(tau, series))


def _first_rise(h: np.ndarray, end: float) -> float:
    """Where a series first rises through 0, s; `end` if it does not before."""
    at = np.linspace(0.0, end, 33)
    values = np.polynomial.polynomial.polyval(at, h)
    rises = np.flatnonzero((values[:-1] <= 0) & (values[1:] > 0))
    if not rises.size:
        return end
    lo, hi = at[rises[0]], at[rises[0] + 1]
    for _ in range(60):
        middle = (lo + hi) / 2
        lo, hi = (middle, hi) if _value(h, middle) <= 0 else (lo, middle)
    return float(hi)
