"""The job of a confirmation: the first solver finds each bifurcation again, and the other solver looks for it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from lapjoint.campaigns.branches.plain import located_of
from lapjoint.campaigns.branches.spec import range_of
from lapjoint.campaigns.confirm.spec import ConfirmSpec
from lapjoint.campaigns.confirm.table import Confirmed, confirm_dataset
from lapjoint.campaigns.job import Job
from lapjoint.campaigns.point import PlainSection
from lapjoint.errors import SolverError
from lapjoint.orbits.branches.confirmation import confirmed
from lapjoint.orbits.branches.errors import Stated
from lapjoint.solver import Progress, Solver

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class ConfirmJob(Job[ConfirmSpec, Confirmed]):
    """The work on a confirmation; its cells are the bifurcations."""

    longest_batch: ClassVar[int] = 4
    """Largest number of bifurcations in a batch: each takes some seconds."""

    def answer(
        self, cell: int, solver: Solver, section: PlainSection | None, progress: Progress | None = None
    ) -> tuple[Confirmed, None]:
        """The result of the other solver for a bifurcation."""
        return solve_bifurcation(self.spec, cell), None

    def point(self, fields: Mapping[str, Any]) -> Confirmed:
        """The result for a bifurcation, from its attributes."""
        return Confirmed(**fields)

    def dataset(self, points: Mapping[int, Confirmed]) -> xr.Dataset:
        """The dataset of all bifurcations."""
        return confirm_dataset(self.spec, [points[cell] for cell in range(self.spec.size)])


def solve_bifurcation(spec: ConfirmSpec, cell: int) -> Confirmed:
    """The result of the other solver for one bifurcation, by its number."""
    row = spec.rows[cell]
    if not row.arcs:
        return Confirmed(message="the file has no motion of it")
    try:
        what = located_of(range_of(spec.branches.at(row.also)), json.loads(row.arcs))
        if what is None:
            return Confirmed(message="the first solver does not find it again from the motion in the file")
        found = confirmed(Stated(row.value, row.error, what), range_of(spec.other.at(row.also)))
    except SolverError as error:
        return Confirmed(message=str(error))
    if found.other is None:
        return Confirmed(message="the other solver does not find it")
    return Confirmed(float(found.other.value), float(found.other.error), found.verdict)
