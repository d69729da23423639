"""Random bars against one stop, with all that is known of their motions of one contact by closed form.

`draw` gives bars whose motions have a fold or a flip over the amplitude of the base, and the range of amplitudes around
these: for the toy solver, a bar of mass 1 on springs of stiffness 1, or for the beam solvers, a stiff beam on a pin and
a torsional spring, with a bending stiffness that can be raised.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from lapjoint import BaseMotion, Beam, ModalDamping, PolynomialShape, Problem, Stop, Support, ViscousDamping
from validation.references.bilinear_map import BilinearMap, OneContact, Piece

_SIDE = 1.08  # by so much the range goes beyond the folds and flips at its ends
_AT_ONE = 1e-4  # distance of a multiplier from 1 at a fold; at a pole of the amplitude it is anywhere
LENGTH, MASS, PLACE = 1.5, 4.0, 1.2  # m, kg/m and m, of the bar on a pin
BENDING = 2.5e5
"""N m2: it bends little, k L^3 / EI is 0.1 at most."""


@dataclass(frozen=True)
class Bar:
    """A bar, and what is known of it."""

    map: BilinearMap
    viscous: bool
    ratio: float
    torsional: float
    """Of the spring at its pin, N m; 0 for the bar on two springs."""
    low: float
    """Least amplitude of the base, m."""
    high: float
    """Largest one, m."""
    seed: OneContact
    """A motion of that range."""
    there: tuple[tuple[str, OneContact], ...]
    """Folds and flips that are joined to it within the range."""
    elsewhere: tuple[tuple[str, OneContact], ...]
    """All others."""

    def problem(self, bending: float = BENDING) -> Problem:
        """The bar at the amplitude of its seed, and from where that is at t = 0."""
        known = self.map
        u, v = (float(one) for one in known.start(self.seed))
        stiffness = (known.pressed.stiffness - known.free.stiffness) / known.lever**2
        base = BaseMotion(amplitude=self.seed.amplitude, angular_frequency=known.omega)
        on_pin = bool(self.torsional)
        length, mass = (LENGTH, MASS) if on_pin else (1.0, 1.0)
        supports: tuple[Support, ...] = (Support(x=0.0, translational=math.inf, torsional=self.torsional),)
        if not on_pin:
            supports = tuple(Support(x=x, translational=0.5) for x in (0.0, 1.0))
        coefficient = 2 * self.ratio * math.sqrt(known.free.stiffness / known.free.mass) * mass
        return Problem(
            beam=Beam(length=length, bending_stiffness=bending, mass_per_length=mass),
            supports=supports,
            stops=(Stop(x=PLACE if on_pin else 0.5, side="top", gap=known.gap, stiffness=stiffness),),
            damping=ViscousDamping(coefficient=coefficient) if self.viscous else ModalDamping(ratio=self.ratio),
            base_motion=base,
            initial=PolynomialShape(
                displacement=(0.0, u / length) if on_pin else (u,), velocity=(0.0, v / length) if on_pin else (v,)
            ),
        )


def draw(seed: int, kind: str, *, on_pin: bool) -> Bar:
    """The first bar of a seed that has a fold, or a flip."""
    rng = np.random.default_rng((seed, kind == "fold"))
    while True:
        one = _random(rng, on_pin)
        found = _around(one, kind)
        if found is not None:
            return found


def _random(rng: np.random.Generator, on_pin: bool) -> Bar:
    viscous, ratio = bool(rng.integers(2)), math.exp(rng.uniform(math.log(0.01), math.log(0.1)))
    torsional, share = (rng.uniform(200.0, 900.0) if on_pin else 0.0), rng.uniform(0.4, 3.0)
    times = math.exp(rng.uniform(math.log(1.5), math.log(12.0 if on_pin else 50.0)))
    mass, stiffness, lever, load, gap = 1.0, 1.0, 1.0, 1.0, 1.0
    if on_pin:  # u is the tip's displacement
        mass, stiffness, lever = MASS * LENGTH / 3, torsional / LENGTH**2, PLACE / LENGTH
        load, gap = MASS * LENGTH / 2, 1e-3
    both = stiffness * (1 + times)
    omega = math.sqrt(stiffness / mass)
    damping = [2 * ratio * mass * omega * factor for factor in (1.0, 1.0 if viscous else math.sqrt(1 + times))]
    level = stiffness * times * (gap / lever) / both
    pieces = Piece(mass, damping[0], stiffness, 0.0), Piece(mass, damping[1], both, level)
    known = BilinearMap(*pieces, lever, gap, load, share * omega)
    return Bar(known, viscous, ratio, torsional, 0.0, 0.0, known.stations[0], (), ())


def _around(bar: Bar, kind: str) -> Bar | None:
    """The range of amplitudes around the folds and flips; None if there is none of the kind."""
    known = bar.map
    folds = [("fold", one) for one in known.folds() if min(abs(m - 1) for m in one.multipliers) < _AT_ONE]
    events = [(name, one) for name, one in (*folds, *(("flip", one) for one in known.flips())) if known.exists(one)]
    wanted = [one for name, one in events if name == kind]
    if not wanted:
        return None
    low, high = wanted[0].amplitude / _SIDE, wanted[0].amplitude * _SIDE
    stations = known.stations
    first = int(np.searchsorted([one.duration for one in stations], wanted[0].duration))
    inside = [low < one.amplitude < high and known.exists(one) for one in stations]
    a = b = first
    while a > 0 and inside[a - 1]:
        a -= 1
    while b < len(stations) - 1 and inside[b]:
        b += 1
    if b - a < 20:  # hardly any motions of one contact are joined to it
        return None
    span = stations[a].duration, stations[b - 1].duration
    there = tuple(one for one in events if span[0] < one[1].duration < span[1])
    elsewhere = tuple(one for one in events if one not in there)
    seed = stations[(a + 2 * b) // 3]
    return replace(bar, low=low, high=high, seed=seed, there=there, elsewhere=elsewhere)
