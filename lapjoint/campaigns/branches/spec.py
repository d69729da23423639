"""What is asked of a search for branches."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

from lapjoint.campaigns.branch_plan import BranchPlan

if TYPE_CHECKING:
    from lapjoint.orbits.curves.resolution import ParameterRange

_FORMAT = 3
"""Number of the form in which a journal keeps the parts of the work: another one is not gone on with."""
_KEPT = 8
"""Number of searches whose period maps are kept: values of a second number are searched at the same time."""


@dataclass(frozen=True)
class BranchSpec(BranchPlan):
    """Everything that branches depend on. See `lapjoint.campaigns.branch_plan.BranchPlan` for the parameters."""

    @cached_property
    def identity(self) -> dict[str, Any]:
        """What distinguishes this from any other search, as values that JSON can hold; floats are written exactly."""
        return {**super().identity, "parts": _FORMAT}


class _Key:
    """A search as a key: two with the same fingerprint are one."""

    def __init__(self, spec: BranchPlan) -> None:
        self.spec = spec

    def __hash__(self) -> int:
        return hash(self.spec.fingerprint)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Key) and other.spec.fingerprint == self.spec.fingerprint


def range_of(spec: BranchPlan) -> ParameterRange:
    """The range of the parameter with its period maps.

    Parameters
    ----------
    spec : BranchPlan
        What is asked, at one value of a second number.

    Returns
    -------
    ParameterRange
        Made once in each process.

    Raises
    ------
    InputError
        If the solver has no arcs, or there is no valid problem at an end of the range.
    """
    return _range(_Key(spec))


@lru_cache(maxsize=_KEPT)
def _range(key: _Key) -> ParameterRange:
    from lapjoint.orbits.curves.resolution import ParameterRange

    spec = key.spec
    low, high = spec.axis.values
    return ParameterRange(spec.check(), spec.problem_at, spec.path, low, high)
