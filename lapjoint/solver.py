"""The Solver protocol, and how solvers are found by name."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, fields, is_dataclass
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Protocol, runtime_checkable

from lapjoint.answers import History, Modes
from lapjoint.answers.contact_state import FREE, ContactState
from lapjoint.answers.equilibrium import Equilibrium
from lapjoint.answers.steady_state import SectionPoint, SteadyState
from lapjoint.errors import InputError, SolverError
from lapjoint.parts import require
from lapjoint.problem import Problem

ENTRY_POINT_GROUP = "lapjoint.solvers"
"""Name of the group of entry points under which packages register their solvers."""
MODES = 6
"""Default number of modes of a state: they fit on a line of a terminal."""
Progress = Callable[[float, float], None]
"""Called now and then with (done, total), in the same unit."""


@runtime_checkable
class Solver(Protocol):
    """A small frozen object that holds numerical options only, and answers questions about problems."""

    @property
    def name(self) -> str:
        """Name and options in a line, for tables and files."""

    def modes(self, problem: Problem, state: ContactState = FREE, count: int = MODES) -> Modes:
        """The lowest modes of a contact state.

        Parameters
        ----------
        problem : Problem
            The joint.
        state : ContactState
            The stops that are closed; none by default.
        count : int
            Number of modes, at least 1; `MODES` by default.

        Returns
        -------
        Modes
            Natural frequencies, rad/s, ascending, and mass-normalised shapes, kg^-1/2.

        Raises
        ------
        InputError
            If the solver cannot give so many modes.
        """

    def simulate(
        self, problem: Problem, duration: float, *, errors: bool = True, progress: Progress | None = None
    ) -> History:
        """The motion from the problem's initial state.

        Parameters
        ----------
        problem : Problem
            The joint, its excitation and its initial state.
        duration : float
            Length of the motion, s.
        errors : bool
            Whether to estimate the numerical errors of the contacts, from a march at a finer resolution; it
            takes about as long again.
        progress : callable, optional
            Called now and then with the time marched and the duration, s.

        Returns
        -------
        History
            From 0 to `duration`.

        Raises
        ------
        InputError
            If the solver cannot treat such a problem.
        SolverError
            If the march cannot go on.
        """

    def steady_state(
        self,
        problem: Problem,
        *,
        start: SectionPoint | None = None,
        sensitivity: bool = True,
        errors: bool = True,
        progress: Progress | None = None,
    ) -> SteadyState:
        """The motion that remains when a march has settled.

        Parameters
        ----------
        problem : Problem
            The joint; its excitation has a period.
        start : SectionPoint, optional
            Where the march begins instead of at the problem's initial state: the section point of a steady state of
            this or a neighbouring problem, found by the same solver.
        sensitivity : bool
            Whether to measure `Acceptance.growth`, how much deviations grew on the way, which may take as long again;
            a solver that does not measure it takes no notice.
        errors : bool
            Whether to estimate the numerical errors of the impulses and of the contacts, at a finer resolution; it
            takes less than as long again.
        progress : callable, optional
            Called now and then with the periods marched, and the most allowed.

        Returns
        -------
        SteadyState
            The motion, and how it was established.

        Raises
        ------
        InputError
            If the excitation has no period, or `start` is no section point of such a problem.
        SolverError
            If the march cannot go on.
        """

    def refined(self, factor: float) -> Solver:
        """This solver at another resolution.

        Parameters
        ----------
        factor : float
            By which the number of modes or elements is multiplied.

        Returns
        -------
        Solver
            A new solver, with all other options of this one.
        """


@runtime_checkable
class Streams(Protocol):
    """A solver that can hand on a motion in stretches, so that a long one needs no more memory than a short one."""

    def stream(self, problem: Problem, duration: float, *, progress: Progress | None = None) -> Iterator[History]:
        """The motion from the problem's initial state, stretch by stretch.

        Parameters
        ----------
        problem : Problem
            The joint, its excitation and its initial state.
        duration : float
            Length of the motion, s.
        progress : callable, optional
            Called now and then with the time marched and the duration, s.

        Yields
        ------
        History
            Each begins where the one before ends; the first at 0, the last ends at `duration`.  A contact that goes on
            over an end is in both, marked as open there.  No errors are estimated.

        Raises
        ------
        InputError
            If the solver cannot treat such a problem.
        SolverError
            If the march cannot go on.
        """


@runtime_checkable
class Rests(Protocol):
    """A solver that finds static equilibria."""

    def equilibrium(self, problem: Problem) -> Equilibrium:
        """The static equilibrium of a problem under its static loads.

        The loads are gravity, the uniform loads and the constant parts of the point loads.  A moving base and loads
        that change with time do not count; stops that are fixed to space are where they are at y = 0.

        Parameters
        ----------
        problem : Problem
            The joint and its loads.

        Returns
        -------
        Equilibrium
            The deflected shape and all forces; of several equilibria the one nearest to the straight beam.

        Raises
        ------
        InputError
            If there is none, because the loads drive a rigid motion that neither supports nor stops resist.
        SolverError
            If rounding hides which stops press.
        """


def solver_names() -> tuple[str, ...]:
    """Names of all solvers that are installed."""
    return tuple(sorted(entry.name for entry in entry_points(group=ENTRY_POINT_GROUP)))


def options_of(name: str) -> list[str] | None:
    """The names of the numerical options of an installed solver.

    Parameters
    ----------
    name : str
        As `make_solver` takes it.

    Returns
    -------
    list of str or None
        The names of the options; None if the solver does not tell them.

    Raises
    ------
    InputError
        If there is no such solver, or it lacks a part.
    SolverError
        If it is registered but cannot be loaded.
    """
    return _options_of(_factory(name))


def make_solver(name: str, **options: Any) -> Solver:
    """A solver by its name, with its numerical options.

    Parameters
    ----------
    name : str
        One of `solver_names`; or ``module:class`` of a dataclass that no package has registered.
    **options : object
        Numerical options by name, as ``n_modes=20``.  A list becomes a tuple, as a frozen object needs.

    Returns
    -------
    Solver
        A solver with these options, and the default of all others.

    Raises
    ------
    InputError
        If there is no such solver, or it does not take these options or values, or it lacks a part.
    SolverError
        If it is registered but cannot be loaded.
    """
    factory = _factory(name)
    allowed = _options_of(factory)
    unknown = [] if allowed is None else [option for option in options if option not in allowed]
    if unknown and allowed is not None:
        raise InputError(f"solver {name!r} has no option {unknown[0]!r}; allowed: {', '.join(allowed)}")
    try:
        solver = factory(**{option: _frozen(value) for option, value in options.items()})
    except TypeError as error:
        given = ", ".join(f"{option} = {value!r}" for option, value in options.items())
        raise InputError(f"solver {name!r} does not take {given}: {error}") from None
    _check_whole(solver, name)
    return solver  # type: ignore[no-any-return]


def _factory(name: str) -> Any:
    """What makes the solver of a name; a class that no package has registered must be a dataclass with all parts."""
    found = {entry.name: entry for entry in entry_points(group=ENTRY_POINT_GROUP)}
    own = name not in found and re.fullmatch(r"[\w.]+:[\w.]+", name) is not None
    if name not in found and not own:
        raise InputError(f"solver = {name!r} is not installed; allowed: {', '.join(sorted(found))}, or module:class")
    try:
        factory = (EntryPoint(name, name, ENTRY_POINT_GROUP) if own else found[name]).load()
    except (ImportError, AttributeError) as error:
        if own:
            raise InputError(f"solver = {name!r}: cannot be imported: {error}") from error
        raise SolverError(f"solver {name!r} is installed but cannot be loaded: {error}") from error
    if own:  # a name may come from a file, which must not have just anything called
        if not (isinstance(factory, type) and is_dataclass(factory)):
            raise InputError(f"solver = {name!r}: is no dataclass, whose fields are the options of a solver")
        _check_whole(factory, name)
    return factory


def _options_of(factory: Any) -> list[str] | None:
    """The names of the options of what makes a solver; None if it does not tell them."""
    return [field.name for field in fields(factory)] if is_dataclass(factory) else None


def _frozen(value: Any) -> Any:
    """A value with tuples in place of lists."""
    return tuple(map(_frozen, value)) if isinstance(value, list) else value


def _check_whole(solver: object, name: str) -> None:
    """Raise InputError, which names the missing parts, unless an object, or its class, has all that a solver needs."""
    require(solver, Solver, f"solver = {name!r}", "all solvers")


def named(solver: str | Solver, options: Mapping[str, Any] | None = None) -> tuple[str, dict[str, Any]]:
    """The name and the options from which `make_solver` makes a solver again, in another process or from a file.

    Parameters
    ----------
    solver : str or Solver
        A name; or a solver, whose options are its fields: they must be values that JSON can hold.
    options : mapping, optional
        The options of a solver that is given by its name.

    Returns
    -------
    str, dict
        The entry-point name, or ``module:class`` of a solver that no package has registered; and the options that
        differ from their defaults.

    Raises
    ------
    InputError
        If the solver cannot be made again from them, lacks a part, or has options besides its own.
    """
    if isinstance(solver, str):
        return solver, dict(options or {})
    kind = type(solver)
    name = f"{kind.__module__}:{kind.__qualname__}"
    if isinstance(solver, type):
        raise InputError(f"solver = {solver.__name__}: is a class; give a solver, as {solver.__name__}()")
    _check_whole(solver, name)
    if options:
        raise InputError(f"options: are those of a solver that is given by its name; {solver.name} has its own")
    if not is_dataclass(solver):
        raise InputError(f"solver = {name}: is no dataclass, whose fields are the options of a solver")
    package = kind.__module__.partition(".")[0]
    for entry in entry_points(group=ENTRY_POINT_GROUP):
        if entry.module.partition(".")[0] == package and _factory(entry.name) is kind:
            name = entry.name
    own = {field.name: getattr(solver, field.name) for field in fields(solver) if field.init}
    try:
        kept, usual = json.loads(json.dumps(own)), _defaults(solver)
        own = {field: value for field, value in own.items() if field not in usual or value != usual[field]}
        again = make_solver(name, **{field: kept[field] for field in own})
    except (TypeError, InputError) as error:
        raise InputError(f"solver = {solver.name}: cannot be made again by another process: {error}") from None
    if again != solver:
        raise InputError(f"solver = {solver.name}: made again from its options, {own!r}, it is not the same")
    return name, own


def _defaults(solver: Any) -> dict[str, Any]:
    """The default of each field that has one."""
    found = {field.name: field.default for field in fields(solver) if field.default is not MISSING}
    made = {field.name: field.default_factory() for field in fields(solver) if field.default_factory is not MISSING}
    return found | made
