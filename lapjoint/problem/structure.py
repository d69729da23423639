"""The joint without its excitation and its initial state: the part shared by all problems of a sweep over these two.

All positions are on the line of beams, see `lapjoint.problem.line`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from lapjoint.problem.damping import Damping, ViscousDamping
from lapjoint.problem.line import Line
from lapjoint.problem.load_shape import LoadShape
from lapjoint.problem.masses import Mass
from lapjoint.problem.named_beam import NamedBeam
from lapjoint.problem.schema import FloatArray
from lapjoint.problem.supports_and_stops import PlacedStop, Support

_HELD = 1e-9
"""Supports and links hold a rigid-body motion if they resist it by at least this, for a motion of unit size."""
_BASE = -1.0
"""Stands for the base where others are positions on the line, m, which are at least 0."""
_KEPT = 64
"""Number of structures that are cached: problems of one campaign mostly share one."""


@dataclass(frozen=True)
class PlacedLink:
    """A link on the line of beams: springs and dampers between two positions."""

    first: float
    """Position on the line, m."""
    second: float
    """Position on the line, m, on another beam."""
    translational: float
    """Stiffness between the displacements, N/m, from 0 to inf."""
    torsional: float
    """Stiffness between the slopes, N m/rad, from 0 to inf."""
    damping: float = 0.0
    """Damping between the displacements, N s/m."""
    torsional_damping: float = 0.0
    """Damping between the slopes, N m s/rad."""


@dataclass(frozen=True)
class Damper:
    """A viscous damper between two positions on the line of beams."""

    first: float
    """Position on the line, m."""
    second: float
    """Position on the line, m, on another beam."""
    derivative: int
    """What it resists a change of: the difference of the displacements, 0, or of the slopes, 1."""
    damping: float
    """Damping, N s/m, or N m s/rad between slopes."""


@dataclass(frozen=True, eq=False)
class Structure:
    """Beams with their supports, stops, links, damping and masses.

    Equal ones are one object as long as it is cached: caches keyed by it need not compare its parts.
    """

    line: Line
    supports: tuple[Support, ...]
    stops: tuple[PlacedStop, ...]
    damping: Damping
    masses: tuple[Mass, ...] = ()
    links: tuple[PlacedLink, ...] = ()

    @cached_property
    def inertia(self) -> LoadShape:
        """All that moves, kg and kg/m, times the beam's share of the base's motion: the shape of the force by which a
        moving base drives the beams."""
        return self._masses("inertia", [_share(beam, "base_share") for beam in self.line.beams])

    @cached_property
    def weight(self) -> LoadShape:
        """All on which gravity acts, kg and kg/m, times the beam's share of gravity."""
        return self._masses("mass", [_share(beam, "gravity_share") for beam in self.line.beams])

    def _masses(self, name: str, shares: list[float]) -> LoadShape:
        """The lumped masses, and a mass per unit length, each times the share of its beam."""
        line = self.line
        points = ((it.x, shares[line.beam_at(it.x)] * it.mass) for it in self.masses)
        pieces = ((it.start, it.end, shares[line.beam_at(it.start)] * getattr(it, name)) for it in line.pieces)
        return LoadShape(tuple(point for point in points if point[1]), tuple(piece for piece in pieces if piece[2]))

    def base_shares(self, x: FloatArray) -> FloatArray:
        """How much of the base's motion acts along z at positions on the line, m, ``(n,)``; gives ``(n,)``."""
        shares = [_share(beam, "base_share") for beam in self.line.beams]
        return np.array([shares[self.line.beam_at(float(position))] for position in x])

    @cached_property
    def free_motions(self) -> int:
        """Number of motions as rigid bodies, 0 to 2 for each beam, that supports and links leave free."""
        line = self.line
        rows = [self._rigid(support.x, 0) for support in self.supports if support.translational > 0]
        rows += [self._rigid(support.x, 1) for support in self.supports if support.torsional > 0]
        for link in self.links:
            for derivative, stiffness in enumerate((link.translational, link.torsional)):
                if stiffness > 0:
                    rows.append(self._rigid(link.second, derivative) - self._rigid(link.first, derivative))
        every = 2 * len(line.beams)
        return every - int(np.linalg.matrix_rank(np.array(rows), tol=_HELD)) if rows else every

    def _rigid(self, x: float, derivative: int) -> FloatArray:
        """Displacement, or slope times the longest beam's length, at a position, m, when each beam shifts or turns;
        ``(2 beams,)``."""
        found, i = np.zeros(2 * len(self.line.beams)), self.line.beam_at(x)
        start, length = self.line.starts[i], self.line.beams[i].length
        longest = max(beam.length for beam in self.line.beams)
        found[2 * i : 2 * i + 2] = (0.0, longest / length) if derivative else (1.0, (x - start) / length)
        return found

    @cached_property
    def idle(self) -> frozenset[tuple[int, int]]:
        """The infinite springs that hold only what others hold, and of which equilibria say that they take no force.

        Each is the index among the supports and then the links, and 0 of a displacement or 1 of a slope.  Infinite
        springs join displacements, or slopes, to each other or to the base, and such a spring joins what others, that
        stand before it, have joined.
        """
        root: dict[tuple[float, int], tuple[float, int]] = {}

        def first(one: tuple[float, int]) -> tuple[float, int]:
            while root.get(one, one) != one:
                one = root[one]
            return one

        ends = [(it.x, _BASE, it.translational, it.torsional) for it in self.supports]
        ends += [(it.first, it.second, it.translational, it.torsional) for it in self.links]
        found = set()
        for i, (a, b, *springs) in enumerate(ends):
            for derivative in (derivative for derivative, k in enumerate(springs) if math.isinf(k)):
                one, other = (first((x, derivative)) for x in (a, b))
                if one == other:
                    found.add((i, derivative))
                root[one] = other
        return frozenset(found)

    @cached_property
    def viscous(self) -> tuple[tuple[float, float, float], ...]:
        """Start and end, m, of each piece of the beams, and the viscous damping along it, N s/m2: that of all beams and
        the beam's own."""
        line, everywhere = self.line, self.damping.coefficient if isinstance(self.damping, ViscousDamping) else 0.0
        own = [beam.viscous_damping if isinstance(beam, NamedBeam) else 0.0 for beam in line.beams]
        return tuple((it.start, it.end, everywhere + own[line.beam_at(it.start)]) for it in line.pieces)

    @cached_property
    def even_decay(self) -> float:
        """The rate C / (2 m), 1/s, that viscous damping along the beams adds to every mode, where it couples no modes:
        its force is then one number times the inertia, everywhere."""
        rates = [C / (2 * it.inertia) for (_, _, C), it in zip(self.viscous, self.line.pieces, strict=True)]
        return rates[0] if not self.masses and all(rate == rates[0] for rate in rates) else 0.0

    @cached_property
    def coupling_drag(self) -> tuple[tuple[float, float, float], ...]:
        """Start and end, m, and viscous damping, N s/m2, of the pieces along which it couples the modes."""
        return () if self.even_decay else tuple(piece for piece in self.viscous if piece[2] > 0)

    @cached_property
    def dampers(self) -> tuple[Damper, ...]:
        """The dampers of links, which couple the modes."""
        return tuple(
            Damper(link.first, link.second, derivative, c)
            for link in self.links
            for derivative, c in enumerate((link.damping, link.torsional_damping))
            if c > 0
        )

    @property
    def couples(self) -> bool:
        """Whether viscous damping along the beams, or dampers of links, couple the modes of every contact state."""
        return bool(self.coupling_drag or self.dampers)

    def __reduce__(self) -> tuple[object, ...]:
        return structure_of, (self.line, self.supports, self.stops, self.damping, self.masses, self.links)


def _share(beam: object, name: str) -> float:
    """How much of the base's motion, or of gravity, acts along a beam's z; 1 for the only beam."""
    return float(getattr(beam, name)) if isinstance(beam, NamedBeam) else 1.0


@lru_cache(maxsize=_KEPT)
def structure_of(
    line: Line,
    supports: tuple[Support, ...],
    stops: tuple[PlacedStop, ...],
    damping: Damping,
    masses: tuple[Mass, ...] = (),
    links: tuple[PlacedLink, ...] = (),
) -> Structure:
    """The structure of these parts: one object for equal parts, as long as it is cached."""
    return Structure(line, supports, stops, damping, masses, links)
