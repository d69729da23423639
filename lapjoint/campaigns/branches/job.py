"""The job of a search for branches, whose parts lead to further parts.

Several workers follow a few branches at each value of a second parameter.  One process takes one value after the other,
and one branch after the other.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

from lapjoint.campaigns.branches.search import Part, Search
from lapjoint.campaigns.branches.solve import follow_a_little
from lapjoint.campaigns.branches.spec import BranchSpec, range_of
from lapjoint.campaigns.branches.table import branch_dataset
from lapjoint.campaigns.job import Answers, Batch, Job, Stage
from lapjoint.campaigns.point import PlainSection
from lapjoint.solver import Progress, Solver

if TYPE_CHECKING:
    import xarray as xr

_AHEAD, _AHEAD_OF_OTHERS = 2, 32
"""Numbers of branches under way at each value of a second parameter: for each process, and for workers whose number is
not known.  With two branches for a process, one waits in the queue, so that no process waits for work."""


@dataclass(frozen=True)
class BranchJob(Job[BranchSpec, dict[str, Any]]):
    """The work on a search for branches.  Its cells are the parts of the search, named as `Part.name` says.

    Answers are the values that `lapjoint.campaigns.branches.solve.solve_start` and `solve_branch` give.
    """

    searches: list[Search] = field(default_factory=list, compare=False, repr=False)
    """The search at each value of the second parameter; empty in workers."""

    def check(self) -> None:
        """Check the question, and whether the solver has arcs."""
        super().check()
        range_of(self.spec.at(0))

    def answer(
        self, cell: Part, solver: Solver, section: PlainSection | None, progress: Progress | None = None
    ) -> tuple[dict[str, Any], None]:
        """The result of a part."""
        return cell.solved(self.spec, progress), None

    def point(self, fields: Mapping[str, Any]) -> dict[str, Any]:
        """The result of a part that is given up."""
        return {"starts": [], "points": [], **fields}

    def rehearse(self, cell: Part, solver: Solver) -> bool:
        """Compile the functions that workers need for such a part."""
        spec = self.spec.at(cell.value)
        if cell.start is None:
            period_map = range_of(spec).resolution(spec.first).map(spec.first)
            period_map.march(period_map.initial(), 2)
        else:
            follow_a_little(spec, cell.start)
        return True

    def key(self, cell: Part) -> str:
        """The name of a part."""
        return cell.name

    def line(self, points: Mapping[str, dict[str, Any]], section: PlainSection | None) -> dict[str, Any]:
        """The result of one part as a line of the journal."""
        ((name, result),) = points.items()
        return {"part": name, "result": result}

    def from_line(self, line: Mapping[str, Any]) -> tuple[dict[str, dict[str, Any]], None]:
        """The result of a part, read back from a line of the journal."""
        return {line["part"]: line["result"]}, None

    def stages(self, answers: Answers, processes: int | None) -> Iterator[Stage]:
        """The starts, and then the branches, of all values of the second parameter or of one after the other."""
        ahead = _AHEAD_OF_OTHERS if processes is None else 1 if processes == 1 else _AHEAD * processes
        self.searches[:] = [Search(self.spec, i, ahead) for i in range(self.spec.values)]
        given = set[str]()
        least = (self.spec.size + 1) * self.spec.values  # one branch at least is to be expected at each value

        def known_of() -> int:
            return max(least, len(given | answers.points.keys()))

        def next_batches(searches: Sequence[Search]) -> list[Batch]:
            parts = [part for search in searches for part in search.go_on(answers.points)]
            given.update(part.name for part in parts)
            return [Batch((part,)) for part in parts]

        for searches in [[search] for search in self.searches] if processes == 1 else [self.searches]:
            while batches := next_batches(searches):
                branches = any(batch.cells[0].start is not None for batch in batches)
                more = partial(next_batches, searches) if branches else list
                yield Stage(BranchJob(self.spec), batches, known_of, more, all_workers=True)

    def dataset(self, points: Mapping[str, dict[str, Any]]) -> xr.Dataset:
        """The dataset of the branches at all values of the second parameter."""
        return branch_dataset(self.spec, [search.diagram for search in self.searches])
