"""The joint without its excitation and its initial state: the part shared by all problems of a sweep over these two."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from lapjoint.problem.beam import Beam
from lapjoint.problem.damping import Damping, ViscousDamping
from lapjoint.problem.load_shape import LoadShape
from lapjoint.problem.masses import Mass
from lapjoint.problem.supports_and_stops import Stop, Support

_HELD = 1e-9
"""Supports hold a rigid-body motion if they resist it by at least this, for a motion of unit size."""
_KEPT = 64
"""Number of structures that are cached: problems of one campaign mostly share one."""


@dataclass(frozen=True, eq=False)
class Structure:
    """A beam with its supports, stops, damping and masses.

    Equal ones are one object as long as it is cached: caches keyed by it need not compare its parts.
    """

    beam: Beam
    supports: tuple[Support, ...]
    stops: tuple[Stop, ...]
    damping: Damping
    masses: tuple[Mass, ...] = ()

    @cached_property
    def inertia(self) -> LoadShape:
        """All that moves, kg and kg/m: the shape of the force by which a moving base drives the beam."""
        return LoadShape(
            tuple((mass.x, mass.mass) for mass in self.masses if mass.mass),
            tuple((piece.start, piece.end, piece.inertia) for piece in self.beam.pieces),
        )

    @cached_property
    def weight(self) -> LoadShape:
        """All on which gravity acts, kg and kg/m."""
        along = tuple((piece.start, piece.end, piece.mass) for piece in self.beam.pieces)
        return LoadShape(self.inertia.points, along)

    @cached_property
    def free_motions(self) -> int:
        """Number of motions as a rigid body, 0 to 2, that the supports leave free."""
        rows = [(1.0, support.x / self.beam.length) for support in self.supports if support.translational > 0]
        rows += [(0.0, 1.0) for support in self.supports if support.torsional > 0]
        return 2 - int(np.linalg.matrix_rank(np.array(rows), tol=_HELD)) if rows else 2

    @cached_property
    def coupling_drag(self) -> float:
        """The viscous coefficient C, N s/m2, where it couples the modes, else 0.

        Its force is proportional to the velocity, and couples no modes, where all inertia is one mass per length.
        """
        pieces = self.beam.pieces
        even = not self.masses and all(piece.inertia == pieces[0].inertia for piece in pieces)
        return self.damping.coefficient if isinstance(self.damping, ViscousDamping) and not even else 0.0

    def __reduce__(self) -> tuple[object, ...]:
        return structure_of, (self.beam, self.supports, self.stops, self.damping, self.masses)


@lru_cache(maxsize=_KEPT)
def structure_of(
    beam: Beam,
    supports: tuple[Support, ...],
    stops: tuple[Stop, ...],
    damping: Damping,
    masses: tuple[Mass, ...] = (),
) -> Structure:
    """The structure of these parts: one object for equal parts, as long as it is cached."""
    return Structure(beam, supports, stops, damping, masses)
