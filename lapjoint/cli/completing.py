"""Values that the Tab key offers: files, directories, presets, solvers; click offers the names of options.

The values are plain text to click; commands check them where they use them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import click
from click.shell_completion import CompletionItem
from click.types import StringParamType


class Offering(StringParamType):
    """A text for which the Tab key offers names, given by a function, and paths: "file", "dir" or None."""

    def __init__(self, names: Callable[[], Iterable[str]] | None = None, paths: str | None = None) -> None:
        self._names = names
        self._paths = paths

    def shell_complete(self, ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
        """The offers for a value that begins with `incomplete`."""
        names = () if self._names is None else self._names()
        found = [CompletionItem(name) for name in names if name.startswith(incomplete)]
        return found if self._paths is None else [*found, CompletionItem(incomplete, type=self._paths)]


def _presets() -> list[str]:
    from lapjoint.problem.presets import PRESETS

    return [f"preset:{name}" for name in PRESETS]


def _solvers() -> tuple[str, ...]:
    from lapjoint.solver import solver_names

    return solver_names()


FILE = Offering(paths="file")
DIRECTORY = Offering(paths="dir")
PROBLEM = Offering(_presets, "file")
SOLVER = Offering(_solvers)
