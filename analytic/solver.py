"""The analytic solver: numerical options, and the three questions that it answers.

The modules that answer them bring numba and scipy along; they are imported when the first question is asked.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from lapjoint.answers import History, Modes
from lapjoint.answers.contact_state import FREE, ContactState
from lapjoint.answers.equilibrium import Equilibrium
from lapjoint.answers.steady_state import SectionPoint, SteadyState
from lapjoint.errors import InputError
from lapjoint.machine.one_thread import each_in_one_thread, in_one_thread
from lapjoint.problem import Problem
from lapjoint.solver import MODES, Progress

if TYPE_CHECKING:
    from analytic.period_map import PeriodMap
    from lapjoint.orbits.orbit_errors import FinerMap
    from lapjoint.orbits.refinement import Refinement

MOST_MODES = 500  # most modes in a contact state; work and memory grow with the square of the number
FINER = 1.5
"""Ratio of numbers of modes between the solver that errors are estimated by and this one: below it, more errors are
stated too small."""
LEAST_FINER = 1.2
"""Least such ratio with which errors are estimated, where the limit on modes leaves room for no more."""
ORDER = 4.0
"""Least power of the number of modes with which errors of impulses fall; mostly it is the sixth."""
ORDER_OF_LINKS = (3.0, 1.0)
"""The same powers where dampers of links resist displacements, and slopes: modes that are left out yield to a damper by
a part of the displacement that falls with the third power of their number, and of the slope with the first."""


def order_of(problem: Problem) -> float:
    """The least power of the number of modes with which errors of a problem fall."""
    return min([ORDER, *(ORDER_OF_LINKS[it.derivative] for it in problem.structure.dampers)])


@dataclass(frozen=True)
class Solver:
    """Exact separation of variables, state by state.

    Parameters
    ----------
    n_modes : int, optional
        Modes in every state; by default chosen for the problem by `analytic.mode_count`.
    free_modes, contact_modes : int, optional
        Modes in the free state, and in every other; they go before `n_modes`.
    tolerance : float
        What the default number of modes aims at: the relative error of impulses by truncation.
    max_period_multiple : int
        Longest periodic motion looked for, in excitation periods.
    max_periods : int
        Most excitation periods marched in search of a steady state.

    Raises
    ------
    InputError
        If an option is out of its range.
    """

    n_modes: int | None = None
    free_modes: int | None = None
    contact_modes: int | None = None
    tolerance: float = 1e-5
    max_period_multiple: int = 64
    max_periods: int = 16000

    def __post_init__(self) -> None:
        for field in ("n_modes", "free_modes", "contact_modes"):
            value = getattr(self, field)
            if value is not None:
                check_count(field, value)
        if not 1e-9 <= self.tolerance <= 1e-1:
            raise InputError(f"tolerance = {self.tolerance!r}: allowed are 1e-9 to 0.1")
        for field in ("max_period_multiple", "max_periods"):
            value = getattr(self, field)
            if isinstance(value, bool) or not isinstance(value, int) or value < 1:
                raise InputError(f"{field} = {value!r}: must be an integer of at least 1")

    @property
    def name(self) -> str:
        """Name and options in a line."""
        given = [
            f"{label} {value}"
            for label, value in (
                ("modes", self.n_modes),
                ("free modes", self.free_modes),
                ("contact modes", self.contact_modes),
            )
            if value is not None
        ]
        return f"analytic ({', '.join(given) or f'modes by criterion {self.tolerance:g}'})"

    def refined(self, factor: float) -> Solver:
        """The same solver with more modes, or with a tighter criterion for their number.

        The error falls with about the seventh power of the number of modes, so a criterion is tightened by
        ``factor**7``.

        Parameters
        ----------
        factor : float
            How many times as many modes.

        Returns
        -------
        Solver
            With the other options as they are.
        """

        def more(value: int | None) -> int | None:
            return None if value is None else math.ceil(value * factor)

        return replace(
            self,
            n_modes=more(self.n_modes),
            free_modes=more(self.free_modes),
            contact_modes=more(self.contact_modes),
            tolerance=min(max(self.tolerance / factor**7, 1e-9), 1e-1),
        )

    def mode_counts(self, problem: Problem) -> tuple[int, int]:
        """Numbers of modes used for a problem.

        Parameters
        ----------
        problem : Problem
            What is solved.

        Returns
        -------
        int, int
            In the free state, and in every other.
        """
        common = self.n_modes
        if common is None and (self.free_modes is None or self.contact_modes is None):
            from analytic.mode_count import default_count

            common = default_count(problem, self.tolerance)
        assert common is not None or (self.free_modes is not None and self.contact_modes is not None)
        return self.free_modes or common or 0, self.contact_modes or common or 0

    @in_one_thread
    def modes(self, problem: Problem, state: ContactState = FREE, count: int = MODES) -> Modes:
        """The lowest modes of a contact state, exact to rounding.

        Parameters
        ----------
        problem : Problem
            What is solved.
        state : ContactState
            The stops that are closed; none by default.
        count : int
            How many modes.

        Returns
        -------
        Modes
            Angular frequencies, rad/s, and mass-normalised shapes, kg^-1/2.

        Raises
        ------
        InputError
            If `count` is not between 1 and 500.
        """
        check_count("count", count)
        from analytic.modes.normal_modes import exact_modes

        found = exact_modes(problem, state, count)
        return Modes(state, found.omega, found.shapes)

    def equilibrium(self, problem: Problem) -> Equilibrium:
        """The static equilibrium, in closed form. See `lapjoint.solver.Rests.equilibrium`."""
        from analytic.equilibrium import equilibrium

        return equilibrium(problem, "analytic (static, closed form)")

    @in_one_thread
    def simulate(
        self, problem: Problem, duration: float, *, errors: bool = True, progress: Progress | None = None
    ) -> History:
        """The motion from the initial state.

        Parameters
        ----------
        problem : Problem
            What is solved.
        duration : float
            How long, s.
        errors : bool
            Whether to estimate the numerical errors of the contacts, from a march with more modes; it takes about as
            long again.
        progress : callable, optional
            Called with (done, total), in the same unit.

        Returns
        -------
        History
            The motion from 0 to `duration`, with its contacts.

        Raises
        ------
        InputError
            If `duration` is not positive and finite, or longer than a record.
        SolverError
            If the march cannot go on.
        """
        problem.check_duration(duration)
        from analytic import answers

        counts = self.mode_counts(problem)
        motion = answers.simulate(problem, self.name, counts, float(duration), progress)
        return self._with_errors(motion, counts, float(duration)) if errors else motion

    def stream(self, problem: Problem, duration: float, *, progress: Progress | None = None) -> Iterator[History]:
        """The motion from the initial state, stretch by stretch. See `lapjoint.solver.Streams.stream`."""
        problem.check_duration(duration)
        from analytic import answers

        counts = in_one_thread(self.mode_counts)(problem)
        return each_in_one_thread(answers.stream(problem, self.name, counts, float(duration), progress))

    @in_one_thread
    def steady_state(
        self,
        problem: Problem,
        *,
        start: SectionPoint | None = None,
        sensitivity: bool = True,
        errors: bool = True,
        progress: Progress | None = None,
    ) -> SteadyState:
        """The motion that the march from the initial state, or from `start`, leads to; see `lapjoint.orbits`.

        Parameters
        ----------
        problem : Problem
            What is solved; its excitation has a period.
        start : SectionPoint, optional
            Where to begin instead of at the initial state: a section point of this solver.  Modes that it lacks follow
            the loads, and modes that it has too many are left out; a stop is closed at first where it is pressed.
        sensitivity : bool
            Whether to measure how much deviations grew on the way, `Acceptance.growth`; it takes about as long again.
        errors : bool
            Whether to estimate the numerical errors of the impulses and of the contacts, from a motion with more
            modes; it takes less than as long again.
        progress : callable, optional
            Called with the periods marched, and the most allowed.

        Returns
        -------
        SteadyState
            The motion, its certificate, and the impulses of the stops, N s a period.

        Raises
        ------
        InputError
            If the excitation has no period, or `start` is no such section point.
        SolverError
            If the march cannot go on.
        """
        from lapjoint.orbits import Effort, find_steady_state

        effort = Effort(self.max_period_multiple, self.max_periods, growth=sensitivity)
        return find_steady_state(
            self.period_map(problem),
            self.name,
            effort,
            start=start,
            finer=self._finer_map(problem) if errors else None,
            errors=errors,
            progress=progress,
        )

    def _finer(self, counts: tuple[int, int]) -> tuple[Solver, float] | None:
        """This solver with `FINER` times as many modes as `counts`, and the ratio; None near the limit on modes."""
        free, contact = (min(math.ceil(count * FINER), MOST_MODES) for count in counts)
        ratio = min(free / counts[0], contact / counts[1])
        return (replace(self, free_modes=free, contact_modes=contact), ratio) if ratio >= LEAST_FINER else None

    def _finer_map(self, problem: Problem) -> Callable[[], FinerMap] | None:
        """The period map of the finer solver, made when it is asked for."""
        found = self.finer(problem)
        if found is None:
            return None
        from analytic.march.oscillator import BELOW
        from lapjoint.orbits.orbit_errors import FinerMap

        refinement, finer = found
        return lambda: FinerMap(refinement, finer._period_map(problem, BELOW))

    def _with_errors(self, motion: History, counts: tuple[int, int], duration: float) -> History:
        """A march with the estimated errors of its contacts."""
        from analytic import answers
        from analytic.march.oscillator import BELOW
        from lapjoint.orbits.contact_errors import with_contact_errors, without_contact_errors
        from lapjoint.orbits.refinement import Refinement

        problem = motion.problem
        found = self._finer(counts)
        if found is None:
            return without_contact_errors(motion, f"{MOST_MODES} modes are the most there are")
        finer, ratio = found

        def march() -> History:
            return answers.simulate(problem, finer.name, finer.mode_counts(problem), duration, None, side=BELOW)

        return with_contact_errors(motion, Refinement(finer.name, ratio, order_of(problem)), march)

    def resolving(self, problems: Iterable[Problem]) -> Solver:
        """The same solver with the numbers of modes that the hardest of some problems needs.

        Parameters
        ----------
        problems : iterable of Problem
            The problems, at least one.

        Returns
        -------
        Solver
            Its numbers of modes do not depend on the problem.
        """
        counts = [self.mode_counts(problem) for problem in problems]
        free, contact = (max(each) for each in zip(*counts, strict=True))
        return replace(self, free_modes=free, contact_modes=contact)

    def finer(self, problem: Problem) -> tuple[Refinement, Solver] | None:
        """A solver with more modes, by which errors are estimated.

        Parameters
        ----------
        problem : Problem
            What is solved.

        Returns
        -------
        tuple of Refinement and Solver, or None
            None if there can hardly be more modes.
        """
        from lapjoint.orbits.refinement import Refinement

        found = self._finer(self.mode_counts(problem))
        return None if found is None else (Refinement(found[0].name, found[1], order_of(problem)), found[0])

    def period_map(self, problem: Problem) -> PeriodMap:
        """The motion of a problem from section point to section point; see `lapjoint.orbits.PeriodMap`.

        Parameters
        ----------
        problem : Problem
            What is solved.

        Returns
        -------
        PeriodMap
            The period map with the numbers of modes of this solver.

        Raises
        ------
        InputError
            If the excitation has no period.
        """
        from analytic.march.oscillator import ABOVE

        return self._period_map(problem, ABOVE)

    def _period_map(self, problem: Problem, side: float) -> PeriodMap:
        """`period_map` with the side to which modes are moved at resonance."""
        problem.require_excitation_frequency("steady state")
        from analytic.march import Joint
        from analytic.period_map import PeriodMap

        return PeriodMap(Joint(problem, *self.mode_counts(problem), side), self.name)


def check_count(field: str, value: object) -> None:
    """Raise `InputError` unless a value, called `field` in the message, is an integer from 1 to `MOST_MODES`."""
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= MOST_MODES:
        raise InputError(f"{field} = {value!r}: the analytic solver takes an integer from 1 to {MOST_MODES}")
