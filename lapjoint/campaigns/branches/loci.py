"""Which bifurcations, found at the values of a second parameter, are one that goes on from value to value: a *locus*.

Two at neighbouring values are joined if they are alike (their kind, the stop that is grazed, whether it is touched at
all before, and the period multiple), each is the other's nearest of these by far, and they are near.  Where a locus
comes from two values before, it is looked for where the line through these leads.  What is doubtful is not joined:
values that lie closer together join more.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from itertools import pairwise

import numpy as np

from lapjoint.orbits.compiled_intervals import IndexArray
from lapjoint.problem import FloatArray

_BY_FAR = 2.0
"""Least ratio of the distances to the second nearest and to the nearest bifurcation for the nearest to count."""
_NEAR = 0.5
"""Largest distance at which two bifurcations are joined: the parameter, or the impulses, change by half of their
size."""

_NO_IMPULSE = 1e-3
"""Impulse, over the largest impulse of all motions, below which differences of impulses do not matter."""


def loci_of(
    values: Sequence[float],
    labels: Sequence[Hashable],
    second: FloatArray,
    value: FloatArray,
    impulses: FloatArray,
    largest: float,
) -> IndexArray:
    """The number of each bifurcation's locus, shape (n,), from 0 in the sequence of the bifurcations.

    `values` are all values of the second parameter; `labels`, `second` and `value`, of length n, are what must agree
    along a locus (None: joined to nothing), the second parameter, and the parameter of each bifurcation; `impulses`,
    shape (n, s), are those of the stops in N s, and `largest` is the largest impulse of all motions.
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
    """Those that are each other's nearest by far, and near; `least` is that of `_apart`."""
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
    """Distance of two bifurcations over their size: of the numbers, and of the impulses, where these are not tiny."""

    def share(part: slice, least: float) -> float:
        whole = max(float(np.linalg.norm(size[part])), float(np.linalg.norm(found[part])), least)
        return float(np.linalg.norm(expected[part] - found[part]) / whole) if whole else 0.0

    return max(share(slice(0, 1), 0.0), share(slice(1, None), least))


def _numbered(before: IndexArray, ascending: IndexArray) -> IndexArray:
    """Numbers of loci, in the sequence of the bifurcations, from the bifurcation before each."""
    first = np.arange(before.size)
    for i in ascending.tolist():
        if before[i] >= 0:
            first[i] = first[before[i]]
    numbers: dict[int, int] = {}
    return np.array([numbers.setdefault(int(one), len(numbers)) for one in first], dtype=int)
