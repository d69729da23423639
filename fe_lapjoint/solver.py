"""The finite element solver: its numerical options, and its modes, motions and steady states.

The modules that compute the answers import scikit-fem and scipy; they are imported on the first call.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
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
    from fe_lapjoint.period_map import PeriodMap
    from lapjoint.orbits.orbit_errors import FinerMap
    from lapjoint.orbits.refinement import Refinement

MOST_ELEMENTS = 1000
METHODS = ("exact", "Radau", "BDF", "LSODA", "DOP853")
FINER_ORBIT = 1.5
"""Number of elements of the mesh for errors of steady states, as a multiple of this solver's number."""
FINER_MARCH = 4 / 3
"""Number of elements of the mesh for errors of a march, as a multiple of this solver's number; the finer march takes
about as long as the march itself."""
ORDER = 4.0
"""Errors fall with this power of the number of elements: the order of convergence of frequencies with cubic
elements."""


@dataclass(frozen=True)
class Solver:
    """Hermite beam elements, penalty contact springs, event-driven time stepping.

    Parameters
    ----------
    elements : int
        Approximate number of elements along the beam; every support, stop, mass, step and load gets a node in
        addition; along a stepped beam elements are shorter where its waves are.
    nodes : tuple of float, optional
        Nodes of a graded mesh, m, instead of `elements`.
    method : str
        "exact" (the flow that `fe_lapjoint.ExactPropagator` steps by), or a method of `solve_ivp`: "Radau", "BDF",
        "LSODA" or "DOP853".
        The mesh's highest frequency rises with the square of `elements`, and makes explicit methods and LSODA slow.
    rtol, atol : float
        Tolerances of the library methods: relative, and absolute in kg^1/2 m and kg^1/2 m/s.
    max_period_multiple : int
        Longest period of the periodic motions searched for, in excitation periods.
    max_periods : int
        Limit of the excitation periods marched in search of a steady state.  Another 512 are marched where a Lyapunov
        exponent has to be measured.

    Raises
    ------
    InputError
        If an option is out of its range.
    """

    elements: int = 40
    nodes: tuple[float, ...] | None = None
    method: str = "exact"
    rtol: float = 1e-9
    atol: float = 1e-12
    max_period_multiple: int = 64
    max_periods: int = 6000

    def __post_init__(self) -> None:
        for field, most in (("elements", MOST_ELEMENTS), ("max_period_multiple", 1000), ("max_periods", 10**7)):
            value = getattr(self, field)
            if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= most:
                raise InputError(f"{field} = {value!r}: must be an integer from 1 to {most}")
        if self.method not in METHODS:
            raise InputError(f"method = {self.method!r}: allowed are {', '.join(METHODS)}")
        for field in ("rtol", "atol"):
            value = getattr(self, field)
            if not 0 < value < 1:
                raise InputError(f"{field} = {value!r}: must lie between 0 and 1")

    @property
    def name(self) -> str:
        """Name and options in a line."""
        mesh = f"{self.elements} elements" if self.nodes is None else f"{len(self.nodes)} nodes given"
        return f"FE ({mesh}, {self.method})"

    def refined(self, factor: float) -> Solver:
        """The same solver on a finer mesh.

        Parameters
        ----------
        factor : float
            New number of elements as a multiple of the old; each element between given nodes is split into
            `factor` equal parts, rounded up.

        Returns
        -------
        Solver
            A solver with the other options unchanged.
        """
        elements = math.ceil(self.elements * factor)
        if self.nodes is None:
            return replace(self, elements=elements)
        from fe_lapjoint.modes.mesh import split_elements

        return replace(self, elements=elements, nodes=split_elements(self.nodes, max(1, math.ceil(factor))))

    @in_one_thread
    def modes(self, problem: Problem, state: ContactState = FREE, count: int = MODES) -> Modes:
        """The lowest modes of a contact state on the mesh; frequencies converge from above, with order 4.

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
            If `count` exceeds the number of degrees of freedom.
        """
        from fe_lapjoint import answers

        return answers.modes(self, problem, state, count)

    @in_one_thread
    def equilibrium(self, problem: Problem) -> Equilibrium:
        """The static equilibrium, by a quadratic program on a mesh. See `lapjoint.solver.Rests.equilibrium`."""
        from fe_lapjoint.equilibrium import equilibrium

        return equilibrium(problem)

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
            Whether to estimate the numerical errors of the contacts, from a second march on a finer mesh, which
            takes about as long as the first.
        progress : callable, optional
            Called with (done, total), both in seconds of motion or both in excitation periods.

        Returns
        -------
        History
            The motion from 0 to `duration`, with its contacts.

        Raises
        ------
        InputError
            If `duration` is not positive and finite, or longer than the record of a sampled force.
        SolverError
            If the march cannot be continued.
        """
        problem.check_duration(duration)
        from fe_lapjoint import answers

        motion = answers.simulate(self, problem, float(duration), progress)
        return self._with_errors(motion, float(duration)) if errors else motion

    def stream(self, problem: Problem, duration: float, *, progress: Progress | None = None) -> Iterator[History]:
        """The motion from the initial state, stretch by stretch, in memory that does not grow with its duration.

        Parameters
        ----------
        problem : Problem
            What is solved.
        duration : float
            How long, s.
        progress : callable, optional
            Called with the time marched and the duration, s, after each stretch.

        Returns
        -------
        iterator of History
            Stretches in order of time.  The first begins at 0, each other one where its predecessor ends, and the last
            ends at `duration`.  A contact that lasts from one stretch into the next is in both, marked as open at their
            common end.  No errors are estimated.

        Raises
        ------
        InputError
            If `duration` is not positive and finite, or longer than the record of a sampled force.
        SolverError
            If the march cannot be continued.
        """
        problem.check_duration(duration)
        from fe_lapjoint import answers

        return each_in_one_thread(answers.stream(self, problem, float(duration), progress))

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
            Where to begin instead of at the initial state: a section point of a finite element solver for a beam of
            the same length.  Frequency, amplitude, gaps, stiffnesses, damping and mesh may differ; a stop is closed at
            first where it is pressed.
        sensitivity : bool
            Whether to measure how much deviations grew during the march, `Acceptance.growth`, which doubles the time
            of the call, approximately.
        errors : bool
            Whether to estimate the numerical errors of the impulses and of the contacts, from the same steady state on
            a finer mesh, which takes less time than the search itself.
        progress : callable, optional
            Called with the periods marched, and their limit.

        Returns
        -------
        SteadyState
            The motion, its certificate, and the impulses of the stops, N s a period.

        Raises
        ------
        InputError
            If the excitation has no period, `method` is not "exact", or `start` is not a section point of this kind.
        SolverError
            If the march cannot be continued.
        """
        from lapjoint.orbits import Effort, find_steady_state

        effort = Effort(self.max_period_multiple, self.max_periods, growth=sensitivity)
        return find_steady_state(
            self.period_map(problem),
            self.name,
            effort,
            start=start,
            finer=lambda: self._finer_map(problem),
            errors=errors,
            progress=progress,
        )

    def _finer(self, problem: Problem, ratio: float) -> Solver:
        """This solver on a mesh with at least `ratio` times as many elements between any two required nodes."""
        from fe_lapjoint.modes.mesh import mesh_nodes, refined_nodes

        nodes = mesh_nodes(problem, self.elements, self.nodes)
        return replace(self, nodes=tuple(refined_nodes(problem, nodes, ratio).tolist()))

    def _finer_map(self, problem: Problem) -> FinerMap:
        """The period map of the finer solver."""
        from lapjoint.orbits.orbit_errors import FinerMap

        refinement, finer = self.finer(problem)
        return FinerMap(refinement, finer.period_map(problem))

    def _with_errors(self, motion: History, duration: float) -> History:
        """The motion with estimated errors of its contacts, from a march on a finer mesh."""
        from fe_lapjoint import answers
        from lapjoint.orbits.contact_errors import with_contact_errors, without_contact_errors
        from lapjoint.orbits.refinement import Refinement

        if self.method != "exact":
            return without_contact_errors(motion, f"the error of {self.method}'s steps in time is not known")
        problem = motion.problem
        finer = self._finer(problem, FINER_MARCH)
        refinement = Refinement(finer.name, FINER_MARCH, ORDER)
        return with_contact_errors(motion, refinement, lambda: answers.simulate(finer, problem, duration, None))

    def finer(self, problem: Problem) -> tuple[Refinement, Solver]:
        """A solver on a finer mesh, by which errors are estimated.

        Parameters
        ----------
        problem : Problem
            What is solved.

        Returns
        -------
        tuple of Refinement and Solver
            How the finer mesh compares with this solver's, and the finer solver.
        """
        from lapjoint.orbits.refinement import Refinement

        finer = self._finer(problem, FINER_ORBIT)
        return Refinement(finer.name, FINER_ORBIT, ORDER), finer

    def period_map(self, problem: Problem) -> PeriodMap:
        """The motion of a problem from section point to section point; see `lapjoint.orbits.PeriodMap`.

        Parameters
        ----------
        problem : Problem
            What is solved.

        Returns
        -------
        PeriodMap
            The period map on the mesh of this solver.

        Raises
        ------
        InputError
            If the excitation has no period, or `method` is not "exact".
        """
        problem.require_excitation_frequency("steady state")
        if self.method != "exact":
            raise InputError(f"method = {self.method!r}: a steady state needs the exact flow; allowed is 'exact'")
        from fe_lapjoint import answers

        return answers.period_map(self, problem)
