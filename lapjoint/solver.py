"""The Solver protocol, and how solvers are found by name."""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import entry_points
from typing import Any, Protocol, runtime_checkable

from lapjoint.contact import ContactState
from lapjoint.errors import InputError
from lapjoint.problem import Problem
from lapjoint.solution import History, Modes, SteadyState

ENTRY_POINT_GROUP = "lapjoint.solvers"
Progress = Callable[[float, float], None]
"""Called now and then with (done, total), in the same unit."""


@runtime_checkable
class Solver(Protocol):
    """A small frozen object that holds numerical options only, and answers questions about problems."""

    @property
    def name(self) -> str:
        """Name and options in a line, for tables and files."""

    def modes(self, problem: Problem, state: ContactState, count: int) -> Modes:
        """The lowest `count` modes of a contact state."""

    def simulate(self, problem: Problem, duration: float, *, progress: Progress | None = None) -> History:
        """The motion from the initial state, over `duration` seconds."""

    def steady_state(self, problem: Problem, *, progress: Progress | None = None) -> SteadyState:
        """The periodic motion that a march from the initial state leads to."""

    def refined(self, factor: float) -> Solver:
        """The same solver with its resolution (modes, elements) multiplied by `factor`."""


def solver_names() -> tuple[str, ...]:
    """Names of all solvers that are installed."""
    return tuple(sorted(entry.name for entry in entry_points(group=ENTRY_POINT_GROUP)))


def make_solver(name: str, **options: Any) -> Solver:
    """A solver by its entry-point name, with its numerical options.

    Raises
    ------
    InputError
        If there is no such solver, or it does not take these options or values.
    """
    found = {entry.name: entry for entry in entry_points(group=ENTRY_POINT_GROUP)}
    if name not in found:
        raise InputError(f"solver = {name!r} is not installed; allowed: {', '.join(sorted(found))}")
    try:
        solver = found[name].load()(**options)
    except TypeError as error:
        raise InputError(f"solver {name!r} does not take these options: {error}") from None
    assert isinstance(solver, Solver)
    return solver
