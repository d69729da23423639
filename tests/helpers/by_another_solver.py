"""The bifurcations of a curve, each found by another solver, too, from motions of the first as sampled shapes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from lapjoint.answers import SectionPoint
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import Finder
from lapjoint.orbits.branches.found_along import Approach, Way, along, directly, motion_at
from lapjoint.orbits.branches.listing import Listed
from lapjoint.orbits.branches.value_errors import Stated, stated
from lapjoint.problem import SampledShape

_SAMPLES = 401
"""Number of places at which a motion is sampled: Newton's method does the rest."""
_BACK = (0.0, 1e-5, 1e-4, 1e-3)
"""Arc lengths before a bifurcation from which it is looked for, in turn: a graze may come before for another solver."""


def by_another(one: Listed, family: Family) -> Stated | None:
    """The value and the error of a bifurcation by another solver; None if that does not find it."""
    assert one.found is not None
    assert one.way is not None
    motion, way = motion_at(one.found), CarriedWay(one.way, family)
    finders: tuple[Finder, ...] = directly(one.found), along(one.found, way)
    for back in _BACK:
        value, guess = motion.moved(one.family, -back * motion.tangent)
        own = corrected(one.family, value, guess, motion.count)
        near = None if own is None else carried(own, family)
        found = None if near is None else finders[0](family, near)
        if found is not None and found[0].extrema.closings == motion.extrema.closings:
            return stated(family, *found, either(*finders))
    if way.starts:
        beside = way.starts[0].place
        orbit = replace(beside.orbit, point=shape_of(motion, family, motion.value))
        found = finders[1](family, replace(beside, value=motion.value, orbit=orbit))
        if found is not None:
            return stated(family, *found, either(*finders))
    return None


def either(first: Finder, second: Finder) -> Finder:
    """Finds a bifurcation in one way, or else in another."""
    return lambda family, place: first(family, place) or second(family, place)


@dataclass(frozen=True)
class CarriedWay:
    """The part of a branch about a bifurcation, as another solver has it."""

    way: Way
    """The same by the first solver."""
    family: Family
    """The period maps of the other."""

    @cached_property
    def starts(self) -> tuple[Approach, ...]:
        """Places from which the branch leads to the bifurcation."""
        found = [(carried(start.place, self.family), start.length) for start in self.way.starts]
        return tuple(Approach(place, length) for place, length in found if place is not None)


def carried(place: Place, family: Family) -> Place | None:
    """A motion by another solver, with its tangent the same way along the curve; None if that has none like it."""
    near = corrected(family, place.value, shape_of(place, family, place.value), place.count)
    if near is None or near.extrema.closings != place.extrema.closings:
        return None
    return near if near.tangent[-1] * place.tangent[-1] > 0 else near.turned()


def shape_of(place: Place, family: Family, value: float) -> SectionPoint:
    """The section point of a motion on the map of another solver, from its displacement and velocity."""
    problem = family.problem_at(value)
    history = place.half_periods.map.history(place.point, 1)
    x = problem.beam.length * (1 - np.cos(np.linspace(0.0, np.pi, _SAMPLES))) / 2  # close at the ends, for their slopes
    x[0], x[-1] = 0.0, problem.beam.length
    z, v = (np.asarray(f(x, history.start), dtype=float).ravel() for f in (history.displacement, history.velocity))
    shape = SampledShape(x=tuple(x.tolist()), displacement=tuple(z.tolist()), velocity=tuple(v.tolist()))
    start = family.solver_at(value).period_map(problem.replace(initial=shape)).initial()
    return family.adopted(value, start)
