"""Distributions of contacts in a fixed number of bins of equal ratio, `PER_DECADE` in a decade.

The number of contacts beyond an edge of a bin is exact, also in the tails.  Edges are 12 % apart.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from lapjoint.problem import FloatArray

IndexArray = npt.NDArray[np.intp]

PER_DECADE = 20
"""Number of bins in a factor of ten: each bin is 12 % wider than the previous one."""
DECADES = (-12, 12)
"""Exponents of ten of the first and the last edge, in SI units; values beyond them are in the first or the last bin."""
BINS = PER_DECADE * (DECADES[1] - DECADES[0])
"""Number of bins."""


def bins_of(values: FloatArray) -> IndexArray:
    """The bins, from 0 to `BINS` - 1, of values in SI units, both (n,); a value on an edge is in the bin above it."""
    return np.clip(np.searchsorted(_EDGES, values, side="right") - 1, 0, BINS - 1)


def edges(first: int, last: int) -> FloatArray:
    """The edges of the bins from `first` to `last`, SI units, ascending, (last - first + 2,)."""
    return _EDGES[first : last + 2].copy()


_EDGES = 10.0 ** (DECADES[0] + np.arange(BINS + 1) / PER_DECADE)
