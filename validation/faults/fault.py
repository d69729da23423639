"""What a fault is: a small change of the source of one module, and a sentence about it."""

from __future__ import annotations

from dataclasses import dataclass

PLACES = {"analytic": "analytic", "fe_lapjoint": "FE", "lapjoint": "ground"}
"""The packages that faults are put in, and what each is called in tables."""


@dataclass(frozen=True)
class Fault:
    """One mistake in one module."""

    name: str
    """A few words with hyphens, unique."""
    kind: str
    """Which kind of mistake it is, as programs have it, in a few words."""
    module: str
    """The module, by its full name."""
    what: str
    """What the program then does, in a sentence."""
    old: str
    """A piece of the module's source that occurs there once."""
    new: str
    """What stands in its place."""

    @property
    def place(self) -> str:
        """Where it is: one of the solvers, or the ground that they share."""
        return PLACES[self.module.partition(".")[0]]

    def put_into(self, source: str) -> str:
        """The source of the module with the fault in it.

        Parameters
        ----------
        source : str
            The sound source.

        Returns
        -------
        str
            The same, with `old` replaced by `new`.

        Raises
        ------
        ValueError
            If `old` does not occur exactly once.
        """
        count = source.count(self.old)
        if count != 1:
            raise ValueError(f"fault {self.name}: its text occurs {count} times in {self.module}, and must once")
        return source.replace(self.old, self.new)
