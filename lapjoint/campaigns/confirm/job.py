"""The job of a confirmation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from lapjoint.campaigns.confirm.solve import Confirmed, solve_bifurcation
from lapjoint.campaigns.confirm.spec import ConfirmSpec
from lapjoint.campaigns.confirm.table import confirm_dataset
from lapjoint.campaigns.job import Job
from lapjoint.campaigns.point import PlainSection
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
