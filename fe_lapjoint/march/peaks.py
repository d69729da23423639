"""The deepest penetration of a contact: the highest of all local extrema of its force, found by bounds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_lapjoint.march.events import BoolArray, Gaps, IndexArray
from lapjoint.problem import FloatArray

_FIRST = 16
"""Intervals of equal length into which the time is cut at first."""
_SPLIT = 16
"""Parts into which an interval is cut; a few more cost hardly more."""
_RELATIVE = 1e-12
"""Relative error of the deepest penetration; a maximum is flat, so its time is known to 1e-6."""
_CUTS = 20
"""Most cuts of an interval; 12 of them reach the last digit of a time."""
_AT_ONCE = 32
"""Intervals that are cut together: the ones with the highest bounds, because a high value found there excludes others.
"""


@dataclass(frozen=True)
class _Intervals:
    """Intervals that may hold a deeper penetration than was found, with the gap function at their ends."""

    cuts: IndexArray
    """Number of cuts that made each interval, shape ``(i,)``."""
    start: FloatArray
    """Start of each interval, s, shape ``(i,)``."""
    ends: FloatArray
    """The gap function at the start and at the end of each interval, m, shape ``(2, i)``."""
    most: FloatArray
    """Bound on the penetration in each interval, m, shape ``(i,)``."""

    def only(self, which: BoolArray) -> _Intervals:
        """The selected intervals."""
        return _Intervals(self.cuts[which], self.start[which], self.ends[:, which], self.most[which])

    def and_others(self, others: _Intervals) -> _Intervals:
        """These intervals followed by others."""
        return _Intervals(
            np.concatenate([self.cuts, others.cuts]),
            np.concatenate([self.start, others.start]),
            np.concatenate([self.ends, others.ends], axis=1),
            np.concatenate([self.most, others.most]),
        )


def deepest(gaps: Gaps, k: int, start: float, end: float, rounding: float) -> float:
    """The deepest penetration of closed stop `k` between two times, s: in m, to 1e-12 of itself or to `rounding`, m.

    An interval whose bound exceeds the deepest value found is cut, the highest bounds first.  An interval is left out
    only when its bound says that it holds nothing deeper.
    """

    def intervals(edges: FloatArray, h: FloatArray, cuts: int) -> _Intervals:
        """Intervals between the edges ``(i, n + 1)``."""
        begin, ends = edges[:, :-1].ravel(), np.stack([h[:, :-1].ravel(), h[:, 1:].ravel()])
        most = gaps.ceiling(k, begin, width / _SPLIT**cuts, ends, -1.0)
        return _Intervals(np.full(begin.size, cuts), begin, ends, most)

    width = (end - start) / _FIRST
    edges = start + width * np.arange(_FIRST + 1.0)[None, :]
    h = gaps(edges[0])[k][None, :]
    found, left = float(-h.min()), intervals(edges, h, 0)
    while True:
        left = left.only((left.most > found + max(_RELATIVE * abs(found), rounding)) & (left.cuts < _CUTS))
        if not left.start.size:
            return found
        alike = np.flatnonzero(left.cuts == left.cuts[np.argmax(left.most)])
        first = alike[np.argsort(-left.most[alike], kind="stable")[:_AT_ONCE]]
        cuts = int(left.cuts[first[0]]) + 1
        edges = left.start[first, None] + width / _SPLIT**cuts * np.arange(_SPLIT + 1.0)
        inner = gaps(edges[:, 1:-1].ravel())[k].reshape(first.size, -1)
        found = max(found, float(-inner.min()))
        h = np.concatenate([left.ends[:1, first].T, inner, left.ends[1:, first].T], axis=1)
        others = np.ones(left.start.size, dtype=np.bool_)
        others[first] = False
        left = left.only(others).and_others(intervals(edges, h, cuts))
