"""Fatigue in a dataset of statistics: values with intervals over the places ``x``, and ranges of stress in bins.

- ``damage_rate`` is the damage a second.  `sampling_error` of its attributes is the largest difference, over the
  places, to the count from half of the samples, divided by the largest damage.
- ``equivalent_range`` is the range of which one cycle in each period of the excitation, or each second where there is
  no period, does the same damage; the attribute ``equivalent_rate`` is this rate.
- ``largest_range`` is the largest range.  Ranges have a distribution over ``x``, as contacts have over ``stop``.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from lapjoint.summaries import intervals
from lapjoint.summaries.distributions import distribution, edges
from lapjoint.summaries.measure import Measure
from lapjoint.summaries.quantities import is_rounding
from lapjoint.summaries.rainflow import Places
from lapjoint.summaries.sums import Sums
from lapjoint.summaries.valued import Variable, valued

_ROUNDING = 1e-6
"""Smallest range in bins, divided by the largest: below are cycles of rounding, which do no damage."""


def fatigue_table(what: Measure, sums: Sums, binned: bool = True) -> dict[str, Variable]:
    """The variables of fatigue, by name; ranges in bins if they are `binned`."""
    places, here = Places(what.selection.problem, what.selection.x), ("x",)
    known = ~is_rounding(sums.largest_range.max(axis=0))
    omega = what.selection.problem.excitation_frequency
    often = omega / (2 * math.pi) if omega else 1.0
    damage = sums.damage * known / sums.duration
    mean, ends = damage.mean(axis=0), intervals.of_positive_mean(damage)
    found = valued("damage_rate", here, mean, ends, "s-1", "fatigue damage a second")
    off = np.abs((sums.damage - sums.coarse_damage).mean(axis=0) * known / sums.duration)
    found["damage_rate"][2]["sampling_error"] = float(off.max() / mean.max()) if mean.max() > 0 else 0.0
    found |= valued(
        "equivalent_range",
        here,
        places.range_at(mean / often),
        places.range_at(ends / often),
        "Pa",
        "stress range of which equivalent_rate cycles a second do the same damage",
    )
    found["equivalent_range"][2]["equivalent_rate"] = often
    largest = sums.largest_range.max(axis=0) * known
    text = "largest range of stress of a cycle"
    found["largest_range"] = here, largest, {"units": "Pa", "long_name": text}
    return found | _ranges(sums, known, float(largest.max())) if binned else found


def _ranges(sums: Sums, known: npt.NDArray[np.bool_], largest: float) -> dict[str, Variable]:
    """The distribution of the ranges of cycles, from the lowest bin that is not of rounding."""
    counts = sums.range_counts * known[:, None]
    counts[..., edges(0, counts.shape[-1] - 1)[1:] <= _ROUNDING * largest] = 0
    what = ("Pa", "range of stress of a cycle"), "cycles"
    return distribution("stress_range", "x", counts, sums.duration, *what)
