"""Momentum and angular momentum of a motion, body by body, from a History alone.

A body is a beam, or beams that infinitely stiff links join.  Where no infinitely stiff support holds a body, and
damping is viscous or absent, all forces on it are known from its motion: those of supports, of links to other bodies,
of base, loads and drag, and the *stated* impulses of the stops.  They must add up to the change of its momentum, and of
its angular momentum about the middle of its extent as drawn.  The force of an infinitely stiff link is not known: it
cancels in the momentum, and in the angular momentum if both its places have one x; else the angular momentum is left
out.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lapjoint.answers import History
from lapjoint.problem import FloatArray, ModalDamping, Problem, ViscousDamping
from lapjoint.problem.named_beam import NamedBeam
from lapjoint.problem.structure import PlacedLink
from validation.motion_integrals import along_beams, applied, time_integral
from validation.verdict import Criterion

_BALANCED = 1e-3
"""Least angular momentum that counts, divided by all momentum times half of the extent; a smaller one is rounding."""
_ALIGNED = 1e-12
"""Largest difference of two positions of one x, divided by half of the extent of the beams: rounding."""


def stretch(history: History, link: PlacedLink, t: FloatArray, dx: int, dt: int = 0) -> FloatArray:
    """The second beam's displacement, m, or slope, less the first one's, at a link, or a rate of it, ``(m,)``."""
    first, second = (history.evaluate(x, t, dx=dx, dt=dt)[0] for x in (link.first, link.second))
    return np.asarray(second - first)


def damping_along(problem: Problem, x: FloatArray) -> FloatArray:
    """Viscous damping at positions on the line, m, N s/m2: that of the problem, and of each beam its own; ``(n,)``."""
    everywhere = problem.damping.coefficient if isinstance(problem.damping, ViscousDamping) else 0.0
    found, line = np.zeros(x.size), problem.line
    for start, end, beam in zip(line.starts, line.ends, line.beams, strict=True):
        own = beam.viscous_damping if isinstance(beam, NamedBeam) else 0.0
        found += (everywhere + own) * ((x > start) & (x < end))
    return found


@dataclass(frozen=True)
class _Body:
    """Beams that infinitely stiff links join, by their indices, as a part of a problem."""

    problem: Problem
    beams: tuple[int, ...]

    def on(self, x: FloatArray) -> FloatArray:
        """1 at positions on the line, m, ``(...)``, that are on the body, else 0."""
        return np.isin(self._beam(x), self.beams).astype(float)

    def from_middle(self, x: FloatArray) -> FloatArray:
        """The arm, m, about the middle of the body of a force at positions on the line, m, ``(...)``; 0 elsewhere."""
        (left, right), i = self._extent, self._beam(x)
        starts = np.array(self.problem.line.starts)
        return np.asarray(self.on(x) * (x - starts[i] + self._origins[i] - (left + right) / 2))

    @property
    def half(self) -> float:
        """Half of the extent, m."""
        left, right = self._extent
        return (right - left) / 2

    @property
    def name(self) -> str:
        """The names of the beams in words; empty of the only beam."""
        line = self.problem.line
        return f" of {' and '.join(line.names[i] for i in self.beams)}" if line.several else ""

    @property
    def turns_freely(self) -> bool:
        """Whether the forces of all infinitely stiff links have one arm on both beams, so that they cancel."""
        rigid = [link for link in self.problem.structure.links if math.isinf(link.translational)]
        return all(abs(self.lever(link, self.from_middle)) <= _ALIGNED * self.half for link in rigid)

    def lever(self, link: PlacedLink, arm: Callable[[FloatArray], FloatArray]) -> float:
        """The arm of the force of a link on its second beam, less that of the opposite force on the first."""
        return float(np.diff(arm(np.array([link.first, link.second])))[0])

    def _beam(self, x: FloatArray) -> FloatArray:
        """The beam at each position on the line, m, ``(...)``."""
        return np.asarray(np.searchsorted(self.problem.line.starts, x, side="right") - 1)

    @cached_property
    def _origins(self) -> FloatArray:
        """x of the left end of each beam as drawn, m, ``(beams,)``."""
        beams = self.problem.line.beams
        return np.array([beam.origin if isinstance(beam, NamedBeam) else 0.0 for beam in beams])

    @property
    def _extent(self) -> tuple[float, float]:
        """x of both ends of the body as drawn, m."""
        ends = [(self._origins[i], self._origins[i] + self.problem.line.beams[i].length) for i in self.beams]
        return min(left for left, _ in ends), max(right for _, right in ends)


def _bodies(problem: Problem) -> list[_Body]:
    """The bodies that no infinitely stiff support holds."""
    line, group = problem.line, list(range(len(problem.line.beams)))
    for link in problem.structure.links:
        if math.isinf(link.translational) or math.isinf(link.torsional):
            one, other = (group[line.beam_at(x)] for x in (link.first, link.second))
            group = [one if number == other else number for number in group]
    stiff = [it for it in problem.structure.supports if math.isinf(it.translational) or math.isinf(it.torsional)]
    held = {group[line.beam_at(it.x)] for it in stiff}
    numbers = [number for number in dict.fromkeys(group) if number not in held]
    return [_Body(problem, tuple(i for i, of in enumerate(group) if of == number)) for number in numbers]


def momentum_applies(problem: Problem) -> bool:
    """Whether all forces on some body are known from its motion: no modal damping, and no infinitely stiff support.

    Parameters
    ----------
    problem : Problem
        What is solved.
    """
    return bool(_bodies(problem)) and not isinstance(problem.damping, ModalDamping)


def momentum_balance(history: History, tolerance: float) -> list[Criterion]:
    """Errors of the balances of momentum and angular momentum, by the stated impulses, divided by the sum of all parts.

    Parameters
    ----------
    history : History
        The motion of a problem to which `momentum_applies`.
    tolerance : float
        Largest allowed value, without unit.

    Returns
    -------
    list of Criterion
        The two residuals of each body that no infinitely stiff support holds; the first alone where the forces of
        infinitely stiff links do not cancel in the second.
    """
    return [item for body in _bodies(history.problem) for item in _balance(history, body, tolerance)]


def _balance(history: History, body: _Body, tolerance: float) -> list[Criterion]:
    """The residuals of one body."""
    problem, (x, w) = history.problem, along_beams(history)
    structure, inertia, both = problem.structure, problem.line.inertia_at(x), np.array([history.start, history.end])
    breaks = np.unique([history.start, *history.switch_times, history.end])
    found: list[Criterion] = []
    momentum = 0.0  # sum of the magnitudes of all parts of the momentum balance, kg m/s
    arms = (("momentum", body.on, 0.0), ("angular momentum", body.from_middle, 1.0))
    for name, arm, turning in arms if body.turns_freely else arms[:1]:

        def at(place: float, arm: Callable[[FloatArray], FloatArray] = arm) -> float:
            return float(arm(np.asarray(place)))

        def couple(place: float, turning: float = turning) -> float:
            return turning * float(body.on(np.asarray(place)))

        def force(
            t: FloatArray,
            arm: Callable[[FloatArray], FloatArray] = arm,
            at: Callable[[float], float] = at,
            couple: Callable[[float], float] = couple,
        ) -> FloatArray:
            total = np.zeros(t.size)
            for one in problem.forces.every:
                total += one.at(t) * float(applied(one.shape, x, w, arm))
            for it in structure.supports:
                if at(it.x) and it.translational:
                    total -= it.translational * at(it.x) * history.displacement(it.x, t)[0]
                if couple(it.x) and it.torsional:
                    total -= it.torsional * couple(it.x) * history.slope(it.x, t)[0]
            for link in structure.links:
                lever, turned = at(link.second) - at(link.first), couple(link.second) - couple(link.first)
                if math.isfinite(link.translational) and link.translational * lever:
                    total -= link.translational * lever * stretch(history, link, t, 0)
                if math.isfinite(link.torsional) and link.torsional * turned:
                    total -= link.torsional * turned * stretch(history, link, t, 1)
                for dx, c in enumerate((link.damping * lever, link.torsional_damping * turned)):
                    if c:
                        total -= c * stretch(history, link, t, dx, dt=1)
            return total - (w * damping_along(problem, x) * arm(x)) @ history.evaluate(x, t, dt=1)

        ends = (w * inertia * arm(x)) @ history.evaluate(x, both, dt=1)
        for mass in structure.masses:
            ends = ends + mass.mass * at(mass.x) * history.velocity(mass.x, both)[0]
            ends = ends + mass.rotary_inertia * couple(mass.x) * history.evaluate(mass.x, both, dx=1, dt=1)[0]
        stops = [
            -c.impulse * factor * at(place)
            for c in history.contacts
            for place, factor in structure.stops[c.stop].reading
        ]
        amount = float(np.abs(ends).sum() + np.abs(stops).sum())
        scale = max(amount, _BALANCED * body.half**turning * momentum, 1e-300)
        momentum = max(momentum, amount)
        given, unsure = time_integral(force, breaks, history, tolerance, scale)
        left, allowed = float(ends[1] - ends[0] - given - sum(stops)) / scale, tolerance + unsure / scale
        reason = "quadrature and truncation, by the stated impulses"
        found.append(Criterion(f"{name}{body.name} unaccounted for", "1", left, -allowed, allowed, reason))
    return found
