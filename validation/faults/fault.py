"""What a fault is: a small change of the code of one function or constant, and a sentence about it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from validation.faults.changed_tree import Changed, sources_below
from validation.faults.syntax import defined, matches

PLACES = {"analytic": "analytic", "fe_lapjoint": "FE", "lapjoint": "ground"}
"""The packages that faults are put in, and what each is called in tables."""


@dataclass(frozen=True)
class Fault:
    """One mistake in one function or constant."""

    name: str
    """A few words with hyphens; no other fault has this name."""
    kind: str
    """The kind of mistake, in a few words."""
    where: str
    """A package or module, a colon, and the qualified name of a definition, which may be in any file below it."""
    what: str
    """What the program does with the fault, in a sentence."""
    old: str
    """An expression or statements that stand once in the definition; see `validation.faults.syntax` for ``...``."""
    new: str
    """The code in place of `old`."""

    @property
    def place(self) -> str:
        """One of the solvers, or the ground that both share."""
        return PLACES[self.where.partition(":")[0].partition(".")[0]]

    def put_into(self, tree: Path) -> Changed:
        """The module that has the fault, and its source with the fault in it."""
        below, _, name = self.where.partition(":")
        homes = [
            (module, source, node) for module, source in sources_below(tree, below) for node in defined(name, source)
        ]
        if not homes:
            raise ValueError(f"fault {self.name}: {below} defines no `{name}`; say in `where` what it is called now")
        found = [(module, source, match) for module, source, node in homes for match in matches(self.old, node)]
        if len(found) != 1:
            modules = ", ".join(module for module, _, _ in found or homes)
            raise ValueError(
                f"fault {self.name}: `{self.old}` stands {len(found)} times in `{name}` of {modules}, and must once"
            )
        ((module, source, match),) = found
        try:
            return Changed(self.name, module, match.replaced(source, self.new))
        except ValueError as error:
            raise ValueError(f"fault {self.name}: {error}") from None
