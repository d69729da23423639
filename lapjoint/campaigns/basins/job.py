"""The job of basins."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

from lapjoint.campaigns.basins.solve import NO_LIBRARY, ChunkEnds, Failure, library_text, prepared, solve_chunk
from lapjoint.campaigns.basins.spec import BasinPlan
from lapjoint.campaigns.basins.table import basins_dataset
from lapjoint.campaigns.job import Job
from lapjoint.campaigns.point import PlainSection
from lapjoint.solver import Progress, Solver

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class BasinJob(Job[BasinPlan, ChunkEnds]):
    """The work on basins; its cells are chunks of starts, first the scouts."""

    longest_batch: ClassVar[int] = 4
    libraries: tuple[str, ...] = ()
    """The library of motions of each problem, as `library_text` gives it; empty until the scouts are done."""

    def check(self) -> None:
        """Check the plan, and whether its first problem can be started as the plan says."""
        super().check()
        prepared(self.spec, 0)

    @property
    def first_stage(self) -> int:
        """Number of the chunks of scouts, one for each problem."""
        return self.spec.values

    def informed(self, points: Mapping[int, ChunkEnds]) -> BasinJob:
        """The job that knows the motions that the scouts found."""
        return replace(self, libraries=tuple(library_text(points[value]) for value in range(self.first_stage)))

    def answer(
        self, cell: int, solver: Solver, section: PlainSection | None, progress: Progress | None = None
    ) -> tuple[ChunkEnds, None]:
        """Where the starts of a cell end; `progress` is called with the number that have ended, and of all."""
        library = NO_LIBRARY if cell < self.first_stage else self.libraries[self.spec.chunk(cell).value]
        return solve_chunk(self.spec, cell, library, progress), None

    def point(self, fields: Mapping[str, Any]) -> ChunkEnds:
        """The ends of a chunk from their attributes."""
        return ChunkEnds(**{**fields, "messages": [Failure(*one) for one in fields.get("messages", ())]})

    def dataset(self, points: Mapping[int, ChunkEnds]) -> xr.Dataset:
        """The dataset of all chunks."""
        return basins_dataset(self.spec, points)
