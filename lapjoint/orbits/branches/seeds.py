"""Motions from which branches are followed: found by a march from a start, and told from those that are known."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import SolverError
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.branches.closing import SAME, Start, images_of
from lapjoint.orbits.branches.corrector import corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.tracing import Seed
from lapjoint.orbits.curves.starts import periodic_motion
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.problem import FloatArray

_LOCATED = 1e-6, 1e-3
"""Distances of the number over its scale, and of the motion over its size, up to which two bifurcations that have been
located are one: branches leave them along a parabola, so that the motions differ by the root of the number's error."""
_NEAR = 3.0
"""Distance of a motion from a branch, over that of the branch's neighbours, from which it is not looked at closer."""

_BESIDE = 0.1
"""Distance of a motion from the chord between two of a branch, over the chord's length, up to which it may be of it."""


@in_one_thread
def seed_from(family: Family, value: float, start: SectionPoint, most_multiple: int) -> Seed | None:
    """A periodic motion that a march comes to, or is near where it does not settle.

    Parameters
    ----------
    family : Family
        The period maps.
    value : float
        The number, in its SI unit.
    start : SectionPoint
        Where the march begins.
    most_multiple : int
        Largest period multiple.

    Returns
    -------
    Seed, or None
        None if none is found.
    """
    half = family.at(value)
    try:
        found = periodic_motion(half, half.map.adopted(start), most_multiple, SAME)
    except SolverError:
        return None
    return None if found is None else Seed(value, *found)


def springs_where(family: Family, seed: Seed, springs: Sequence[tuple[float, SectionPoint]], count: int) -> bool:
    """Whether a motion belongs to a branch because both spring from one bifurcation.

    Parameters
    ----------
    family : Family
        The period maps.
    seed : Seed
        The motion.
    springs : sequence of tuple of float and SectionPoint
        The bifurcations from which the branch springs: the number, and the section point.
    count : int
        Half periods of the branch's motions.

    Returns
    -------
    bool
        Whether it does.
    """
    if seed.away_from is None or count != seed.count:
        return False
    value, point = seed.away_from
    near, same = _LOCATED
    there = [its for other, its in springs if abs(other - value) <= near * family.scale(value)]
    if not there:
        return False
    half = family.at(value)
    images = images_of(half, half.map.adopted(point), count // 2)
    return any(half.apart(half.map.adopted(its), image) <= same for its in there for image in images)


@in_one_thread
def on_branch(family: Family, seed: Seed, values: Sequence[float], points: Sequence[SectionPoint], count: int) -> bool:
    """Whether a motion is one of a branch that is known, or the mirror image of one.

    Parameters
    ----------
    family : Family
        The period maps.
    seed : Seed
        The motion.
    values : sequence of float
        The number at each point of the branch, in its SI unit.
    points : sequence of SectionPoint
        The section points of the branch.
    count : int
        Half periods of the branch's motions.

    Returns
    -------
    bool
        Whether it is.
    """
    if count != seed.count:
        return False
    first, last, same = min(values), max(values), 1e-9 * family.scale(seed.value)
    if max(first - seed.value, seed.value - last) > last - first + same:
        return False  # it lies farther beyond its ends than any step leads
    all_values = np.array(values)
    low, high = np.minimum(all_values[:-1], all_values[1:]), np.maximum(all_values[:-1], all_values[1:])
    reach = _beyond_folds(np.diff(all_values)) + same
    beside = np.flatnonzero((low - reach <= seed.value) & (seed.value <= high + reach)).tolist()
    if not beside:
        return False
    half = family.at(seed.value)
    images = images_of(half, seed.point, seed.count)
    for i in beside:
        ends = [half.map.adopted(points[i + k]) for k in (0, 1)]
        width = max(half.apart(ends[1], ends[0]), 1e-3)
        for image in images:
            if min(half.apart(image, end) for end in ends) > _NEAR * width:
                continue
            share = (seed.value - all_values[i]) / ((all_values[i + 1] - all_values[i]) or 1.0)
            share = min(max(share, 0.0), 1.0)
            guess = half.map.moved(ends[0], share * half.map.difference(ends[1], ends[0]))
            for one in (guess, *ends, *_on_chord(half, ends, image)):
                found = corrected(family, seed.value, one, count, fixed=True)
                if found is not None and half.apart(found.point, image) <= SAME:
                    return True
            neighbours = [(values[i + k], points[i + k]) for k in (0, 1)]
            if _leads_through(family, (seed.value, image), neighbours, count):
                return True
    return False


def _leads_through(
    family: Family,
    one: tuple[float, SectionPoint],
    neighbours: Sequence[tuple[float, SectionPoint]],
    count: int,
) -> bool:
    """Whether a smooth curve leads through a motion from one neighbour on a branch to the next, be it that it folds.

    Each is a number, and a section point.
    """
    here, a, b = (
        corrected(family, value, family.adopted(value, point), count, fixed=True) for value, point in (one, *neighbours)
    )
    if here is None or a is None or b is None or a.tangent.shape != b.tangent.shape:
        return False
    way = b.chord(family, a)
    return Start(family, here, itself=True).between(a.along(way), b.along(way)) is not None


def _beyond_folds(steps: FloatArray) -> FloatArray:
    """How far beyond its ends a number may go between two neighbours on a branch, from its change between all of them.

    Nowhere, but where it turns back beside them; there hardly as far as it comes from.
    """
    if not steps.size:
        return steps
    before, after = np.abs(steps[:-1]), np.abs(steps[1:])
    far = np.where(steps[:-1] * steps[1:] < 0, np.maximum(before, after), 0.0)
    return np.asarray(np.maximum(np.append(far, 0.0), np.append(0.0, far)))


def _on_chord(half: HalfPeriods, ends: Sequence[SectionPoint], image: SectionPoint) -> list[SectionPoint]:
    """The point of the chord between two motions that is nearest to another; none if that is not beside the chord.

    Where a branch turns back the number says little about how far along the chord a motion lies.
    """
    chord, way = (half.map.difference(one, ends[0]) for one in (ends[1], image))
    weights = half.unit_norms(chord.size)
    length = float(np.linalg.norm(weights * chord))
    if not length:
        return []
    share = float((weights * way) @ (weights * chord)) / length**2
    off = float(np.linalg.norm(weights * (way - share * chord)))
    return [half.map.moved(ends[0], share * chord)] if 0 <= share <= 1 and off <= _BESIDE * length else []
