"""What is kept of a chunk of starts."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from lapjoint.campaigns.point import FAILED, OUTCOME_CODES

UNBOUND = -1
"""Stands for the motion of a start that is bound to none."""


@dataclass(frozen=True)
class Chunk:
    """Where the starts of a chunk end, as values that JSON can hold."""

    motions: list[dict[str, Any]] = field(default_factory=list)
    """The certified motions that were found in it and are not in the library, as `plain_motion` gives them."""
    motion: list[int] = field(default_factory=list)
    """Index of the motion to which each start is bound, those of the library first; or `UNBOUND`."""
    outcome: list[int] = field(default_factory=list)
    """Number of the outcome of each start, see `lapjoint.campaigns.point.OUTCOME_CODES`."""
    periods: list[int] = field(default_factory=list)
    """Excitation periods marched from each start."""
    pushed: list[int] = field(default_factory=list)
    """Starts of the chunk whose march was pushed off an unstable motion that it could not leave."""
    messages: list[list[Any]] = field(default_factory=list)
    """Starts of the chunk whose march could not go on, each with the reason."""
    message: str = ""
    """Why there is no answer at all; empty where there is one."""

    @staticmethod
    def failed(count: int, reason: str) -> Chunk:
        """A chunk whose starts all failed.

        Parameters
        ----------
        count : int
            Their number.
        reason : str
            Why.

        Returns
        -------
        Chunk
            No start is bound.
        """
        return Chunk(
            [], [UNBOUND] * count, [OUTCOME_CODES[FAILED]] * count, [0] * count, [], [[i, reason] for i in range(count)]
        )
