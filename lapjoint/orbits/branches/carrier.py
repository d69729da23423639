"""A motion of one solver taken to another, as a sampled shape."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.shooting import taken_over
from lapjoint.problem import SampledShape

_SAMPLES = 401
"""Number of places at which a motion is sampled: Newton's method does the rest."""


@dataclass(frozen=True)
class Carrier:
    """Takes a motion of one solver to others."""

    family: Family
    """The period maps of the solver that has it."""
    place: Place
    """The motion."""

    @cached_property
    def _shape(self) -> SampledShape:
        """The displacement, m, and the velocity, m/s, with which the motion begins, along the beam."""
        map_ = self.place.half_periods.map
        history, length = map_.history(self.place.point, 1), map_.problem.beam.length
        x = length * (1 - np.cos(np.linspace(0.0, np.pi, _SAMPLES))) / 2  # close at the ends, for their slopes
        x[0], x[-1] = 0.0, length
        z, v = (np.asarray(f(x, history.start), dtype=float).ravel() for f in (history.displacement, history.velocity))
        return SampledShape(x=tuple(x.tolist()), displacement=tuple(z.tolist()), velocity=tuple(v.tolist()))

    def started(self, other: Family) -> SectionPoint:
        """The section point with which the motion begins by another solver.

        Parameters
        ----------
        other : Family
            The period maps of that one.

        Returns
        -------
        SectionPoint
            On the map at the same number.
        """
        value = self.place.value
        problem = other.problem_at(value).replace(initial=self._shape)
        return other.adopted(value, other.solver_at(value).period_map(problem).initial())

    def guess(self, other: Family) -> SectionPoint:
        """The same; a self of the solver that has the motion need not take samples of a shape to come near it.

        Parameters
        ----------
        other : Family
            The period maps of the other solver.

        Returns
        -------
        SectionPoint
            On the map at the same number.
        """
        own = other.is_a_self_of(self.family)
        return other.adopted(self.place.value, self.place.point) if own else self.started(other)

    def _at(self, point: SectionPoint) -> Carrier:
        """The same with the motion from another of its section points on."""
        return self if point is self.place.point else Carrier(self.family, self.place.beginning_at(point))

    def seen_by(self, other: Family) -> Place:
        """Where the motion lies for another solver, which need have no motion there.

        Parameters
        ----------
        other : Family
            The period maps of that one.

        Returns
        -------
        Place
            The motion with its section point on that solver's map: to measure distances from.
        """
        return self.place.beginning_at(self.guess(other))

    def carried(self, other: Family) -> Place | None:
        """The motion by another solver, with its tangent the same way along the curve.

        Parameters
        ----------
        other : Family
            The period maps of that one.

        Returns
        -------
        Place or None
            None if that solver has no motion like it.
        """
        place = self.place
        near = taken_over(other, place, lambda point: self._at(point).guess(other))
        if near is None or near.closings != place.closings:
            return None
        return near if near.tangent[-1] * place.tangent[-1] > 0 else near.turned()
