"""The types shared by all work that is done cell by cell: a specification, a job, and a batch of its cells.

A *specification* holds the question; its fingerprint distinguishes its journal and its file from all others.  A *job*
cuts a specification into cells, and makes a dataset of their answers.  An answer depends on nothing but the
specification and the cell.  Runner, workers, cluster and journal use only these types.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from lapjoint.campaigns.identity import digest_of
from lapjoint.campaigns.point import PlainSection
from lapjoint.solver import Progress, Solver, make_solver

if TYPE_CHECKING:
    import xarray as xr


class Spec(ABC):
    """The question of a campaign: everything on which its answers depend."""

    noun: ClassVar[str]
    """Name of the work in messages: sweep, ..."""
    cells_noun: ClassVar[str]
    """Name of several cells in messages: points, ..."""
    grows: ClassVar[bool] = False
    """Whether further cells become known while the work goes on, so that progress shows no remaining time."""
    if TYPE_CHECKING:  # fields of each dataclass below

        @property
        def solver(self) -> str:
            """Entry-point name of the solver."""

        @property
        def options(self) -> Mapping[str, Any]:
            """Numerical options of the solver."""

    @property
    @abstractmethod
    def size(self) -> int:
        """Number of cells."""

    @property
    @abstractmethod
    def identity(self) -> dict[str, Any]:
        """What distinguishes this work from any other, as values that JSON can hold; floats are written exactly."""

    @cached_property
    def fingerprint(self) -> str:
        """A digest of the identity, in hexadecimal digits."""
        return digest_of(self.identity, self.options)

    def check(self) -> Solver:
        """Check all that can be checked before any work, and make the solver; InputError if something is wrong."""
        return make_solver(self.solver, **self.options)

    def kept(self, count: int) -> str:
        """A number of answers as the subject of a sentence, with its verb."""
        return f"{count} of {self.size} {self.cells_noun} are"

    @property
    def nothing_kept(self) -> str:
        """A sentence for a journal without answers."""
        return f"none of {self.size} {self.cells_noun} was done"


@dataclass(frozen=True)
class Batch:
    """Cells to be solved one after the other."""

    cells: tuple[Any, ...]
    """The cells: numbers, unless a job has others."""
    chained: bool = False
    """Whether each cell starts from the section point at which the cell before it has settled."""
    section: PlainSection | None = None
    """Section point from which the first cell of a chain starts; None if it starts from the problem's initial state."""

    def first(self) -> Batch:
        """A batch of the first cell alone."""
        return replace(self, cells=self.cells[:1])

    def after(self, done: int, section: PlainSection | None) -> Batch | None:
        """The rest of the batch after its first `done` cells, with a chain at `section`; None if no cell is left."""
        left = self.cells[done:]
        return replace(self, cells=left, section=section if self.chained else None) if left else None


def batches_of(cells: Iterable[Any], length: int) -> list[Batch]:
    """Batches of at most `length` independent cells, in the sequence of the cells."""
    left = tuple(cells)
    return [Batch(left[i : i + length]) for i in range(0, len(left), length)]


class Answers:
    """The answers of a job so far."""

    def __init__(self) -> None:
        self.points: dict[Any, Any] = {}
        """Answers by the keys of their cells."""
        self.sections: dict[Any, PlainSection | None] = {}
        """Section point from which a chain goes on, by the last cell of each batch; None where there is no chain."""

    def append(self, points: Mapping[Any, Any], section: PlainSection | None = None) -> None:
        """Keep answers, and the section point at which a chain continues after them."""
        self.points.update(points)
        self.sections[next(reversed(points))] = section


@dataclass(frozen=True)
class Stage:
    """Batches that can be solved at the same time."""

    job: Job[Any, Any]
    """The job as workers get it."""
    batches: list[Batch]
    size: Callable[[], int]
    """Number of all cells of the work that are known of, this stage and others."""
    more: Callable[[], list[Batch]] = list
    """Batches that the answers kept so far make possible; asked for whenever a batch is solved."""
    all_workers: bool = False
    """Whether all processes are started, although there are fewer batches: more come, or later stages have them."""


S = TypeVar("S", bound=Spec)
A = TypeVar("A")


@dataclass(frozen=True)
class Job(ABC, Generic[S, A]):
    """Work that is done cell by cell, and makes a dataset of the answers."""

    longest_batch: ClassVar[int] = 1
    """Largest number of independent cells that a worker is given at once."""
    spec: S

    @abstractmethod
    def answer(
        self, cell: Any, solver: Solver, section: PlainSection | None, progress: Progress | None = None
    ) -> tuple[A, PlainSection | None]:
        """The answer of a cell, and the section point from which the next cell of its chain starts.

        `section` is where this cell of a chain starts.  `progress` is called, in cells that take long, with the amount
        done and the whole.  InputError is raised if the cell has no valid problem.
        """

    def plain(self, point: A) -> dict[str, Any]:
        """The attributes of an answer as values that JSON can hold."""
        return vars(point)

    @abstractmethod
    def point(self, fields: Mapping[str, Any]) -> A:
        """The answer of which `plain` gave the attributes, or some of them."""

    @abstractmethod
    def dataset(self, points: Mapping[Any, A]) -> xr.Dataset:
        """The dataset of the answers of all cells, by their keys; SolverError is raised if no cell has an answer."""

    def check(self) -> None:
        """Check all that can be checked before any work; InputError if something is wrong."""
        self.spec.check()

    def rehearse(self, cell: Any, solver: Solver) -> bool:
        """Have the functions that workers need compiled and stored, by a short piece of work, if a cell takes so long
        that it cannot be solved for that.  Whether that was done."""
        return False

    def key(self, cell: Any) -> Hashable:
        """The name of a cell among answers: the number of the cell."""
        return cell  # type: ignore[no-any-return]

    def line(self, points: Mapping[Any, A], section: PlainSection | None) -> dict[str, Any]:
        """Answers, and the section point at which a chain continues after them, as a line of the journal."""
        line: dict[str, Any] = {"cells": list(points), "points": [self.plain(point) for point in points.values()]}
        return line if section is None else {**line, "section": section}

    def from_line(self, line: Mapping[str, Any]) -> tuple[dict[Any, A], PlainSection | None]:
        """The answers and the section point of which `line` made a line."""
        points = {cell: self.point(fields) for cell, fields in zip(line["cells"], line["points"], strict=True)}
        return points, line.get("section")

    def chains(self) -> Iterable[tuple[int, ...]]:
        """The cells of each chain, each of which starts where the one before it ends; none if cells are independent."""
        return ()

    @property
    def first_stage(self) -> int:
        """Number of the cells that must be answered before the others begin."""
        return 0

    def informed(self, points: Mapping[Any, A]) -> Job[S, A]:
        """The job that knows the answers of the first stage, and solves the other cells."""
        return self

    def stages(self, answers: Answers, processes: int | None) -> Iterator[Stage]:
        """The stages of the work that is left, each asked for when the stage before it is finished.

        `processes` is the number of processes that do the work; None if the number of workers is not known.
        """
        first = [cell for cell in range(self.first_stage) if cell not in answers.points]
        if first:
            yield Stage(self, batches_of(first, 1), lambda: self.spec.size)
        length = max(1, min(self.longest_batch, self.spec.size // (4 * (processes or 1))))
        yield Stage(self.informed(answers.points), self._batches(answers, length), lambda: self.spec.size)

    def _batches(self, answers: Answers, length: int) -> list[Batch]:
        """Batches of the cells that are not done: the rest of each chain, or at most `length` independent cells."""
        done, chains = answers.points, tuple(self.chains())
        if not chains:
            return batches_of((cell for cell in range(self.spec.size) if cell not in done), length)
        found = []
        for chain in chains:
            number = next((i for i, cell in enumerate(chain) if cell not in done), len(chain))
            if number < len(chain):
                section = answers.sections.get(chain[number - 1]) if number else None
                found.append(Batch(chain[number:], True, section))
        return found
