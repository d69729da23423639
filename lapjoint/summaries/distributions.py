"""Distributions of contacts or cycles of stress in a fixed number of bins of equal ratio, `PER_DECADE` in a decade.

The number beyond an edge of a bin is exact, also in the tails.  Edges are 12 % apart.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from lapjoint.problem import FloatArray
from lapjoint.summaries import intervals
from lapjoint.summaries.valued import Variable, valued

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


def distribution(
    name: str, of: str, counts: npt.NDArray[Any], duration: float, measured: tuple[str, str], what: str
) -> dict[str, Variable]:
    """Edges of bins, counts in them, and rates of exceedance, from the lowest bin to the highest that is in use.

    `counts` are those of units of a `duration`, s, (U, n, BINS), over the dimension `of`; `measured` has the units and
    the name of the values, and `what` is counted.
    """
    units, text = measured
    used = np.flatnonzero(counts.any(axis=(0, 1)))
    first, last = (int(used[0]), int(used[-1])) if used.size else (0, 0)
    counts, ends, bins = counts[..., first : last + 1], edges(first, last), f"{name}_bin"
    beyond, attributes = counts[..., ::-1].cumsum(axis=-1)[..., ::-1], {"units": units, "long_name": text}
    about = {"units": "1", "long_name": f"{what} in the bin, by the {text}"}
    return {
        f"{name}_low": ((bins,), ends[:-1], attributes | {"comment": "lower edge of the bin"}),
        f"{name}_high": ((bins,), ends[1:], attributes | {"comment": "upper edge of the bin"}),
        f"{name}_count": ((of, bins), counts.sum(axis=0), about),
        **valued(
            f"{name}_exceedance",
            (of, bins),
            beyond.mean(axis=0) / duration,
            intervals.of_rate(beyond, duration),
            "s-1",
            f"{what} a second that reach or exceed the lower edge of the bin, by the {text}",
        ),
    }
