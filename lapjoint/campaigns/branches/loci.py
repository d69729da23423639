"""Which bifurcations, found at different values of a second parameter, are one that continues from value to value: a
*locus*.

Two bifurcations at neighbouring values are joined if three conditions hold.  They are alike: their kind, the stop that
is grazed, whether it is touched at all before, and the period multiple.  Of all that are alike, each is by far the
nearest to the other.  And they are near.  Where a locus has points at two earlier values, the next is looked for on the
line through both.  Doubtful pairs are not joined: with values closer together, more bifurcations are joined.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from itertools import pairwise

import numpy as np

from lapjoint.orbits.compiled_intervals import IndexArray
from lapjoint.problem import FloatArray

_BY_FAR = 2.0
"""Least ratio of the distance to the second nearest bifurcation to the distance to the nearest, for the nearest to be
joined."""
_NEAR = 0.5
"""Largest distance at which two bifurcations are joined: a change of the parameter, or of the impulses, by half of
their size."""

_NO_IMPULSE = 1e-3
"""Impulse, divided by the largest impulse of all motions, below which relative differences of impulses are not
counted."""


def loci_of(
    values: Sequence[float],
    labels: Sequence[Hashable],
    second: FloatArray,
    value: FloatArray,
    impulses: FloatArray,
    largest: float,
) -> IndexArray:
    """The number of each bifurcation's locus, shape (n,), from 0 in the sequence of the bifurcations.

    `values` are all values of the second parameter.  Of length n are `labels`, which must agree along a locus (None:
    joined to nothing), `second`, the second parameter, and `value`, the parameter of each bifurcation.  `impulses`,
    shape (n, s), are the impulses of the stops in N s, and `largest` is the largest impulse of all motions, in N s.
    """
    where = np.column_stack([value, np.nan_to_num(impulses)])
    least = _NO_IMPULSE * largest
    before = np.full(len(labels), -1)
    for now, then in pairwise(sorted(values)):
        here, there = np.flatnonzero(second == now), np.flatnonzero(second == then)
        expected = np.array([_expected(int(i), before, second, where, then) for i in here])
        for label in {labels[int(i)] for i in here} - {None}:
            own = [k for k, i in enumerate(here) if labels[int(i)] == label]
            others = [int(j) for j in there if labels[int(j)] == label]
            for k, j in _pairs(where[here[own]], expected[own], where[others], least):
                before[others[j]] = here[own[k]]
    return _numbered(before, np.argsort(second, kind="stable"))


def _expected(i: int, before: IndexArray, second: FloatArray, where: FloatArray, at: float) -> FloatArray:
    """Where a bifurcation is looked for at the next value of the second parameter."""
    if before[i] < 0:
        return np.asarray(where[i])
    last = int(before[i])
    return np.asarray(where[i] + (where[i] - where[last]) * (at - second[i]) / (second[i] - second[last]))


def _pairs(here: FloatArray, expected: FloatArray, there: FloatArray, least: float) -> list[tuple[int, int]]:
    """Pairs of bifurcations that are near, each by far the nearest to the other; `least` is an argument of `_apart`."""
    if not len(here) or not len(there):
        return []
    apart = np.array([[_apart(a, b, size, least) for b in there] for a, size in zip(expected, here, strict=True)])
    found = []
    for i, j in enumerate(apart.argmin(axis=1).tolist()):
        others = np.concatenate([np.delete(apart[i], j), np.delete(apart[:, j], i)])
        if apart[i, j] <= _NEAR and (others >= _BY_FAR * apart[i, j]).all() and apart[:, j].argmin() == i:
            found.append((i, j))
    return found


def _apart(expected: FloatArray, found: FloatArray, size: FloatArray, least: float) -> float:
    """The larger of the relative distances of two bifurcations in the parameter and in the impulses; `least`, N s, is
    the least size by which distances of impulses are divided."""

    def share(part: slice, least: float) -> float:
        whole = max(float(np.linalg.norm(size[part])), float(np.linalg.norm(found[part])), least)
        return float(np.linalg.norm(expected[part] - found[part]) / whole) if whole else 0.0

    return max(share(slice(0, 1), 0.0), share(slice(1, None), least))


def _numbered(before: IndexArray, ascending: IndexArray) -> IndexArray:
    """Numbers of loci, from 0 in the sequence of the bifurcations; `before` has the previous bifurcation of each on its
    locus, or a negative number."""
    first = np.arange(before.size)
    for i in ascending.tolist():
        if before[i] >= 0:
            first[i] = first[before[i]]
    numbers: dict[int, int] = {}
    return np.array([numbers.setdefault(int(one), len(numbers)) for one in first], dtype=int)
