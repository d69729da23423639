"""The types shared by all work that is done cell by cell: a specification, and a job.

A *specification* holds the question; its fingerprint distinguishes its journal and its file from all others.  A *job*
cuts a specification into cells, and makes a dataset of their answers.  An answer depends on nothing but the
specification and the number of the cell.  Workers, cluster and journal use only these types.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Protocol, TypeVar, runtime_checkable

from lapjoint.campaigns.point import PlainSection
from lapjoint.solver import Progress, Solver

if TYPE_CHECKING:
    import xarray as xr


class Answer(Protocol):
    """The answer of a cell: plain values that JSON can hold, as attributes."""

    @property
    def message(self) -> str:
        """Why there is no answer; empty where there is one."""


class Spec(Protocol):
    """The question of a piece of work: everything that a journal and a file must know of the work."""

    @property
    def noun(self) -> str:
        """What the work is called in messages: sweep, ..."""

    @property
    def cells_noun(self) -> str:
        """What several cells are called in messages: points, ..."""

    @property
    def size(self) -> int:
        """Number of cells."""

    @property
    def solver(self) -> str:
        """Entry-point name of the solver."""

    @property
    def options(self) -> Mapping[str, Any]:
        """Numerical options of the solver."""

    @property
    def identity(self) -> dict[str, Any]:
        """What distinguishes this work from any other, as values that JSON can hold."""

    @property
    def fingerprint(self) -> str:
        """A digest of the identity."""

    def check(self) -> Solver:
        """Check all that can be checked before any work, and make the solver; InputError if something is wrong."""


class CellSolver(Protocol):
    """Solves cells: everything that workers must know of the work."""

    @property
    def spec(self) -> Spec:
        """What is asked."""

    def answer(
        self, cell: int, solver: Solver, section: PlainSection | None, progress: Progress | None = None
    ) -> tuple[Any, PlainSection | None]:
        """The answer of a cell, and the section point from which the next cell of its chain starts.

        `section` is where this cell of a chain starts.  `progress` is called, in cells that take long, with the amount
        done and the whole.  InputError is raised if the cell has no valid problem.
        """

    def point(self, fields: Mapping[str, Any]) -> Any:
        """The answer of a cell from its attributes, as a journal holds them."""


@runtime_checkable
class Rehearses(Protocol):
    """Solves cells so long that the first cell cannot be solved before the workers begin, to compile functions."""

    def rehearse(self, solver: Solver) -> None:
        """Have the functions that workers need compiled and stored, by a short piece of work."""


S = TypeVar("S", bound=Spec)
A = TypeVar("A", bound=Answer)


@dataclass(frozen=True)
class Job(ABC, Generic[S, A]):
    """Work that is done cell by cell, and makes a dataset of the answers: a `CellSolver`."""

    longest_batch: ClassVar[int] = 1
    """Largest number of independent cells that a worker is given at once."""
    spec: S

    @abstractmethod
    def answer(
        self, cell: int, solver: Solver, section: PlainSection | None, progress: Progress | None = None
    ) -> tuple[A, PlainSection | None]:
        """The answer of a cell, as `CellSolver` says."""

    @abstractmethod
    def point(self, fields: Mapping[str, Any]) -> A:
        """The answer of a cell from its attributes, as a journal holds them."""

    @abstractmethod
    def dataset(self, points: Mapping[int, A]) -> xr.Dataset:
        """The dataset of the answers of all cells, by their numbers; SolverError is raised if no cell has an answer."""

    def check(self) -> None:
        """Check all that can be checked before any work; InputError if something is wrong."""
        self.spec.check()

    def chains(self) -> Iterable[tuple[int, ...]]:
        """The cells of each chain, each of which starts where the one before it ends; none if cells are independent."""
        return ()

    @property
    def first_stage(self) -> int:
        """Number of the cells that must be answered before the others begin."""
        return 0

    def informed(self, points: Mapping[int, A]) -> Job[S, A]:
        """The job that knows the answers of the first stage, and solves the other cells."""
        return self
