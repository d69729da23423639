"""What journal, workers and cluster ask of a plan: which cells there are, and how each is solved."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Protocol


class Campaign(Protocol):
    """Cells that are solved independently, or in chains; `lapjoint.campaigns.plan.Plan` is one.

    The answer of a cell is a frozen dataclass of values that JSON can hold.
    """

    counted: ClassVar[str]
    """What the cells are called in messages, in the plural."""

    @property
    def size(self) -> int:
        """Number of cells."""

    @property
    def chained(self) -> bool:
        """Whether each cell starts from the one before it."""

    @property
    def identity(self) -> dict[str, Any]:
        """What distinguishes this campaign from any other, as values that JSON can hold."""

    @property
    def fingerprint(self) -> str:
        """A digest of the identity, in hexadecimal digits."""

    def chains(self) -> Iterator[tuple[int, ...]]:
        """The cells of each chain, in the sequence in which they are solved."""

    def solve(self, cell: int, section: dict[str, Any] | None) -> tuple[Any, dict[str, Any] | None]:
        """Solve a cell.

        Parameters
        ----------
        cell : int
            Number of the cell.
        section : dict of str to Any, or None
            Section point from which a cell of a chain starts, as `plain_section` gives it.

        Returns
        -------
        answer
            What was found.
        section : dict of str to Any, or None
            Section point from which the next cell of a chain starts.

        Raises
        ------
        InputError
            If there is nothing valid to be solved there; the message names the cell.
        """

    def given_up(self, cell: int, reason: str) -> Any:
        """The answer of a cell whose processes died.

        Parameters
        ----------
        cell : int
            Number of the cell.
        reason : str
            Why it is given up.

        Returns
        -------
        answer
            One that holds the reason.
        """

    def answer(self, fields: Mapping[str, Any]) -> Any:
        """The answer of a cell from what a journal holds of it.

        Parameters
        ----------
        fields : mapping of str to Any
            ``vars`` of the answer, as JSON gives it back.

        Returns
        -------
        answer
            The same answer.
        """
