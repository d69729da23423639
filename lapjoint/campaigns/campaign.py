"""What all work that is done cell by cell has in common: sweeps, and the realisations of statistics.

A campaign is known by its identity, is cut in cells whose answers depend on nothing but the campaign and the number of
the cell, and makes a dataset of them.  Workers, cluster and journal know no more of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from lapjoint.solver import Progress, Solver

if TYPE_CHECKING:
    import xarray as xr


class Point(Protocol):
    """The answer of a cell: plain values that JSON can hold, as attributes."""

    @property
    def message(self) -> str:
        """Why there is no answer; empty where there is one."""


class Kept(Protocol):
    """Work of which a journal keeps what is done."""

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
    def identity(self) -> dict[str, Any]:
        """What distinguishes this work from any other, as values that JSON can hold."""

    @property
    def fingerprint(self) -> str:
        """A digest of the identity."""


class Cells(Kept, Protocol):
    """Cells that workers solve: all that these ask of their work."""

    @property
    def solver(self) -> str:
        """Entry-point name of the solver."""

    @property
    def options(self) -> Mapping[str, Any]:
        """Numerical options of the solver."""

    @property
    def longest_batch(self) -> int:
        """Largest number of cells that a worker is given at once."""

    @property
    def chained(self) -> bool:
        """Whether a cell starts where another has ended."""

    def chains(self) -> Iterator[tuple[int, ...]]:
        """The cells of each chain, in the sequence in which they are solved, where they are chained."""

    def answer(
        self, cell: int, solver: Solver, section: dict[str, Any] | None, progress: Progress | None = None
    ) -> tuple[Any, dict[str, Any] | None]:
        """Solve a cell.

        Parameters
        ----------
        cell : int
            Number of the cell.
        solver : Solver
            The solver.
        section : dict or None
            Where the cell starts, if it is chained.
        progress : callable, optional
            Called now and then with how much of the cell is done and the whole, where it takes long.

        Returns
        -------
        point : Point
            The answer.
        section : dict or None
            Where the next cell starts, if it is chained.

        Raises
        ------
        InputError
            If the cell has no valid problem.
        """

    def point(self, fields: Mapping[str, Any]) -> Any:
        """The answer of a cell from its attributes.

        Parameters
        ----------
        fields : mapping of str to Any
            What the journal holds.

        Returns
        -------
        Point
            The answer.
        """


class Campaign(Cells, Protocol):
    """Work that is done cell by cell, and makes a dataset of what its cells come to."""

    def check(self) -> Solver:
        """Check everything that can be checked before any work, and make the solver.

        Returns
        -------
        Solver
            The solver, with its options.

        Raises
        ------
        InputError
            If something is not allowed.
        """

    def dataset(self, points: Mapping[int, Any]) -> xr.Dataset:
        """What all cells come to.

        Parameters
        ----------
        points : mapping of int to Point
            The answer of each cell.

        Returns
        -------
        xarray.Dataset
            The dataset.

        Raises
        ------
        SolverError
            If no cell has an answer.
        """


@runtime_checkable
class Rehearses(Protocol):
    """A campaign whose cells are too long for the first one to be solved before the workers begin."""

    def rehearse(self, solver: Solver) -> None:
        """Have what workers need compiled and stored, by a short piece of work.

        Parameters
        ----------
        solver : Solver
            The solver.
        """
