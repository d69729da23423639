r"""The scheme as the paper publishes it, with its few modes: to tell findings from artefacts of truncation.

What the paper writes.  In each contact state z(x, t) = G(x) + sum Phi_i(x) eta_i(t) (20), with G the whole deflected
shape at the last switch (21), eta_i = 0 there (40), and the velocity carried over by inner products (44).  The modal
equations (26) hold the load (27) and the force of G, -EI integral of Phi_i G'''' (30).  Eight modes are used in the
free state and five in every other.

Which force G exerts.  G is a sum of modes Phi_j of the states met, and between the nodes EI Phi_j'''' = m omega_j^2
Phi_j, so (30) is -sum_j omega_j^2 S_ij g_j with S_ij = integral of m Phi_i Phi_j.  By parts, with Phi_i a mode of the
present state,

    EI integral of Phi_i G''''  =  omega_i^2 (Phi_i, G) - sum over closed stops of Phi_i(x_s) k (sign gap)_s

because the stop forces that the Phi_j carry, k Phi_j(x_s) g_j over all contacts so far, add up to k (G(x_s) - sign gap)
at a closed stop and to 0 at an open one: a contact begins and ends where z(x_s) is the gap.  So (30) needs no
separate force of the gaps, and in q_i = eta_i + (Phi_i, G), the content of the whole shape,

    q_i'' + 2 zeta omega_i q_i' + omega_i^2 q_i = F_i(t) + sum over closed stops of Phi_i(x_s) k (sign gap)_s

is the equation that `analytic.march` solves in closed form.  The published scheme and the present solver differ in
nothing but R = G - sum Phi_i (Phi_i, G), the part of G outside the span of the state's modes: the paper leaves it where
it is until the next switch, `analytic.modes.static_residual` lets it follow its equilibrium.  Both converge to the
same motion.

What is corrected: the off-diagonal entries of (29) are C* omega, not C* omega^2; (44) is a sum over the modes of the
old state.  What is assumed, where the text is silent: the damping ratio of Table 6 holds for every mode of every state
and acts on eta'; the motion starts at rest at z = 0 with y = Y sin(omega t); impacts and rebounds are found exactly
rather than by sampling and bisection to 2.2e-11 s; and a motion has settled when `analytic.published.steady` says so.

Only the velocity within the span of five modes is carried over, which can reverse it at the stops: the beam may leave a
stop that has just closed at once, close it again at once, and so on, thousands of times within a microsecond.  A march
that samples cannot see this; here no state lasts less than `shortest`, which ends such a rattle after a few switches
and leaves all other motions as they are.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from analytic.solver import Solver, check_count
from lapjoint.answers import History, Modes
from lapjoint.answers.contact_state import FREE, ContactState
from lapjoint.answers.steady_state import SectionPoint, SteadyState
from lapjoint.errors import InputError
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.problem import AtEquilibrium, Problem
from lapjoint.solver import MODES, Progress


@dataclass(frozen=True)
class PublishedScheme:
    """The scheme of equations (19)-(49), truncated as in the paper.

    Parameters
    ----------
    free_modes, contact_modes : int
        Modes in the free state, and in every other.
    tolerance : float
        To what fraction impulses and displacements must repeat for a motion to have settled.  As the frozen shape
        creeps on for thousands of cycles, most motions of the paper's joint never settle to 1e-6.
    max_period_multiple : int
        Longest periodic motion looked for, in excitation periods.
    max_periods : int
        Most excitation periods marched before a motion is given up and its next 1000 periods are averaged.
    patience : int
        Most impacts before that.
    shortest : float
        Least time spent in a state, s: what a march that samples the displacement would step over.

    Raises
    ------
    InputError
        If an option is out of its range.
    """

    free_modes: int = 8
    contact_modes: int = 5
    tolerance: float = 1e-3
    max_period_multiple: int = 8
    max_periods: int = 4000
    patience: int = 4000
    shortest: float = 1e-7

    def __post_init__(self) -> None:
        check_count("free_modes", self.free_modes)
        check_count("contact_modes", self.contact_modes)
        if not 1e-9 <= self.tolerance <= 1e-1:
            raise InputError(f"tolerance = {self.tolerance!r}: allowed are 1e-9 to 0.1")
        if not 0 <= self.shortest < math.inf:
            raise InputError(f"shortest = {self.shortest!r}: must be a time in s, 0 or more")
        for field in ("max_period_multiple", "max_periods", "patience"):
            value = getattr(self, field)
            if isinstance(value, bool) or not isinstance(value, int) or value < 1:
                raise InputError(f"{field} = {value!r}: must be an integer of at least 1")

    @property
    def name(self) -> str:
        """Name and options in a line."""
        return f"analytic as published (free modes {self.free_modes}, contact modes {self.contact_modes})"

    def refined(self, factor: float) -> PublishedScheme:
        """The same scheme with more modes.

        Parameters
        ----------
        factor : float
            How many times as many modes.

        Returns
        -------
        PublishedScheme
            With the other options as they are.
        """
        free, contact = (math.ceil(count * factor) for count in (self.free_modes, self.contact_modes))
        return replace(self, free_modes=free, contact_modes=contact)

    @in_one_thread
    def modes(self, problem: Problem, state: ContactState = FREE, count: int = MODES) -> Modes:
        """The lowest modes of a contact state, exact to rounding. See `analytic.Solver.modes`."""
        return Solver().modes(problem, state, count)

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
            Not used: the scheme is marched as it was published, and no errors are estimated.
        progress : callable, optional
            Called with (done, total), s.

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
        _refuse_what_was_not_published(problem)
        from analytic.published.field import history_of
        from analytic.published.initial_state import started
        from analytic.published.joint import PublishedJoint
        from analytic.published.march import march_published

        joint = PublishedJoint(problem, self.free_modes, self.contact_modes)
        begin = started(joint, None)
        motion = march_published(joint, begin, float(duration), shortest=self.shortest, progress=progress)
        return history_of(self.name, motion)

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
        """The motion that remains when the march from the initial state, or from `start`, has settled.

        It is marched, never solved for; see `analytic.published.steady` for when it counts as settled.

        Parameters
        ----------
        problem : Problem
            What is solved; its excitation has a period.
        start : SectionPoint, optional
            Where to begin instead of at the initial state: a section point of this scheme with the same numbers of
            modes.
        sensitivity : bool
            Not used: this scheme does not measure how deviations grow.
        errors : bool
            Not used: the scheme is marched as it was published, and no errors are estimated.
        progress : callable, optional
            Called with the periods marched, and the most allowed.

        Returns
        -------
        SteadyState
            The motion, and the impulses of the stops, N s a period.

        Raises
        ------
        InputError
            If the excitation has no period.
        SolverError
            If the march cannot go on.
        """
        problem.require_excitation_frequency("steady state")
        _refuse_what_was_not_published(problem)
        from analytic.published import steady

        how_long = steady.Patience(
            self.tolerance, self.max_period_multiple, self.max_periods, self.patience, self.shortest
        )
        counts = self.free_modes, self.contact_modes
        return steady.steady_state(problem, self.name, counts, how_long, start, progress)


def _refuse_what_was_not_published(problem: Problem) -> None:
    """Raise `InputError` where a problem has what the published equations do not have."""
    if isinstance(problem.initial, AtEquilibrium):
        raise InputError('initial.kind = "equilibrium": the published scheme starts from a given shape only')
    if problem.records:
        raise InputError(f"{next(iter(problem.records))}: the published scheme knows no records; allowed are sines")
    if problem.random:
        path = next(iter(problem.random))
        raise InputError(f"{path}: the published scheme knows no random excitation; allowed are sines")
    for field, value, allowed in (
        ("masses", problem.structure.masses, "beams without masses"),
        ("beams", problem.beams, "one [beam]"),
        ("beam.segments", problem.line.beams[0].segments, "uniform beams"),
        ("gravity", problem.gravity, "loads at points"),
        ("uniform_loads", problem.uniform_loads, "loads at points"),
    ):
        if value:
            raise InputError(f"{field}: the published scheme knows none; allowed are {allowed}")
    for i, stop in enumerate(problem.structure.stops):
        if stop.in_space:
            raise InputError(f'stops[{i}].fixed_to = "space": the published scheme knows stops that move with the base')
