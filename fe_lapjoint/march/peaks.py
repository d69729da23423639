"""The deepest penetration of a contact: the highest of all local extrema of its force, found by bounds."""

from __future__ import annotations

import numpy as np

from fe_lapjoint.march.events import Gaps

_FIRST = 16  # intervals to begin with
_SPLIT = 16  # into how many an interval is cut that may hold more than was found; a few more cost hardly more
_RELATIVE = 1e-12  # of the deepest: what is left to be found; a maximum is flat, so its place is known to 1e-6
_ROUNDS = 20  # of cutting, at most; 12 of them cut to the last digit of a time


def deepest(gaps: Gaps, k: int, start: float, end: float, rounding: float) -> float:
    """The deepest penetration of a closed stop.

    Wherever the bound on an interval exceeds what has been found, the interval is cut; none is left out before the
    bound says that it holds nothing deeper.

    Parameters
    ----------
    gaps : Gaps
        The gap functions of the state; that of a closed stop is minus its penetration.
    k : int
        The stop.
    start, end : float
        Between which times, s.
    rounding : float
        What rounding makes of the gap function, m: no more is looked for.

    Returns
    -------
    float
        m; to 1e-12 of itself, or to `rounding`.
    """
    width = (end - start) / _FIRST
    edges = start + width * np.arange(_FIRST + 1.0)
    depth = -gaps(edges)[k]
    lo, left, right = edges[:-1], depth[:-1], depth[1:]
    found = float(depth.max())
    for _ in range(_ROUNDS):
        enough = found + max(_RELATIVE * abs(found), rounding)
        open_ = np.maximum(left, right) + gaps.from_chord(lo, width)[k] > enough
        if not open_.any():
            break
        width /= _SPLIT
        t = lo[open_, None] + width * np.arange(1.0, _SPLIT)
        inner = -gaps(t.ravel())[k].reshape(t.shape)
        found = max(found, float(inner.max()))
        values = np.concatenate([left[open_, None], inner, right[open_, None]], axis=1)
        lo = np.concatenate([lo[open_, None], t], axis=1).ravel()
        left, right = values[:, :-1].ravel(), values[:, 1:].ravel()
    return found
