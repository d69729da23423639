"""The bifurcations of a curve, each found by another solver, too, from the motion of the first as a sampled shape."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from lapjoint.answers import SectionPoint
from lapjoint.orbits.branches.bifurcations import Located, between
from lapjoint.orbits.branches.continuation import Run
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.value_errors import Finder, Stated, graze_finder, smooth_finder
from lapjoint.orbits.branches.value_errors import stated as with_error
from lapjoint.problem import SampledShape

_SAMPLES = 401
"""Number of places at which a motion is sampled: Newton's method does the rest."""
_BACK = (0.0, 1e-5, 1e-4, 1e-3)
"""Arc lengths before a bifurcation from which it is looked for, in turn: a graze may come before for another solver."""


@dataclass(frozen=True)
class Found:
    """A bifurcation as one solver has it."""

    kind: str
    """What it is."""
    place: Place
    """The motion there."""
    value: float
    """The number, in its SI unit."""
    finder: Finder
    """Finds it by another solver, from a motion of that solver."""

    def stated(self, family: Family) -> Stated:
        """Its value with its error, by the family that it is of."""
        return with_error(family, self.place, self.value, self.finder)

    def by(self, own: Family, family: Family) -> Found | None:
        """The same by another solver; None if that does not find it."""
        found = None
        for back in _BACK:
            value, guess = self.place.moved(own, -back * self.place.tangent)
            place = corrected(own, value, guess, self.place.count)
            near = None if place is None else corrected(family, place.value, carried(place, family), place.count)
            if near is not None:
                along = near.tangent if near.tangent[-1] * self.place.tangent[-1] > 0 else -near.tangent
                found = self.finder(family, replace(near, tangent=along))
            if found is not None:
                break
        if found is None or found[0].extrema.closings != self.place.extrema.closings:
            return None
        return Found(self.kind, *found, self.finder)


def bifurcations_of(family: Family, run: Run) -> Iterator[Found]:
    """Those of a curve that are resolved, the grazes first."""
    for graze in run.grazes:
        place, extremum = graze.before.place, graze.before.extremum
        yield Found("grazing", place, graze.value, graze_finder(extremum, graze.rate, place.extrema.duration))
    apart = {jump.index for jump in run.jumps}
    for i, (a, b) in enumerate(pairwise(run.places), start=1):
        if i not in apart and a.extrema.closings == b.extrema.closings:
            for one in between(family, a, b, (None, None)):
                if isinstance(one, Located):
                    yield Found(one.kind, one.place, one.place.value, smooth_finder(one.kind, one.place))


def carried(place: Place, family: Family) -> SectionPoint:
    """The section point of a motion on the map of another solver, from its displacement and velocity."""
    problem = family.problem_at(place.value)
    history = place.half_periods.map.history(place.point, 1)
    x = problem.beam.length * (1 - np.cos(np.linspace(0.0, np.pi, _SAMPLES))) / 2  # close at the ends, for their slopes
    x[0], x[-1] = 0.0, problem.beam.length
    z, v = (np.asarray(f(x, history.start), dtype=float).ravel() for f in (history.displacement, history.velocity))
    shape = SampledShape(x=tuple(x.tolist()), displacement=tuple(z.tolist()), velocity=tuple(v.tolist()))
    start = family.solver_at(place.value).period_map(problem.replace(initial=shape)).initial()
    return family.adopted(place.value, start)
