r"""A contact state in modal form, and the passage from one to another.

In a state with modes Phi_i, i <= N, and the loads p_l of `analytic.modes.static_residual`, equation (26) reads

    q_i'' + 2 zeta_i omega_i q_i' + omega_i^2 q_i = F0_i + sum_h Fh_i sin(theta_h(t))

with theta_h = Omega_h t + phase_h, in coordinates q_i = (Phi_i, z) of the whole displacement, where F0 holds
the forces k gap of the closed stops and the step loads.  The paper's eta_i of (20) is q_i(t) - q_i(T), measured
from the deflected shape G at the last switch; both give the same motion within the span of the modes, and (40)
holds by construction.

At a switch displacement and velocity are carried over (36), (41) by closed-form inner products (43)-(44):

    q_new = S q_old + S0 + sum_h Sh sin(theta_h),    S_ij = integral of m Phi_i_new Phi_j_old
    v_new = S v_old + sum_h Sh Omega_h cos(theta_h)

where S0 and Sh carry the residual shapes of the old state.

Everything here is for harmonic loads of unit size.  So it is the same for all problems that differ in the size, the
frequency and the phase of their excitation only, a `Family`, and a sweep over these computes it once.  What is
kept depends on its key alone and is never changed: `analytic.march.joint` makes its own scaled copy.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from analytic.march.loads import Places, unit_loads
from analytic.march.oscillator import damping_rates
from analytic.modes.beam_functions import gram, integral
from analytic.modes.normal_modes import NormalModes, exact_modes, pool_size
from analytic.modes.static_residual import Residual, residual
from lapjoint.answers.contact_state import ContactState
from lapjoint.machine.result_cache import cached
from lapjoint.problem import FloatArray, Problem, StepLoad
from lapjoint.problem.structure import Structure

_FAMILIES = 16  # families kept: a campaign seldom alternates between more
_STATES = 256  # contact states kept, enough for 16 families of the paper's nine; each takes about 100 kB
_PASSAGES = 512  # passages kept, as a state of four stops can switch to four others; each takes about 15 kB


@dataclass(frozen=True, eq=False)
class Family:
    """All problems that differ in the size, the frequency and the phase of the excitation only."""

    problem: Problem
    """The one with nothing but the constant part of its loads, which is zero for some."""
    places: Places
    """Where the ``H`` harmonic loads act, and then the sampled ones."""

    def __reduce__(self) -> tuple[object, ...]:
        return family_of, (self.problem, self.places)


@dataclass(frozen=True, eq=False)
class ModalState:
    """A contact state with ``N`` modes, ``P`` stops and ``H`` harmonic loads of unit size."""

    state: ContactState
    modes: NormalModes
    damping_rate: FloatArray
    """Damping rates zeta_i omega_i, 1/s, shape ``(N,)``."""
    force: FloatArray
    """(Phi_i, p_l) of the unit loads: the constant F0, kg^-1/2 N, then those of the harmonics, ``(1 + H, N)``."""
    residual: Residual
    """Residual shapes of the unit loads."""
    at_stops: FloatArray
    """Modes at the stops, kg^-1/2, shape ``(P, N)``."""
    foundation_at_stops: FloatArray
    """The foundation shapes of `residual` at the stops, m for each unit of load, shape ``(1 + H, P)``."""

    @property
    def size(self) -> int:
        """Number of modes N."""
        return self.damping_rate.size

    @cached_property
    def residual_at_stops(self) -> FloatArray:
        """Residual shapes at the stops, m for each unit of load, shape ``(1 + H, P)``; not to be written to."""
        return np.asarray(self.foundation_at_stops - self.residual.weights @ self.at_stops.T)

    def head(self, count: int) -> ModalState:
        """The same state with its lowest modes only.

        Parameters
        ----------
        count : int
            How many.

        Returns
        -------
        ModalState
            With `count` modes.
        """
        modes, left = self.modes.head(count), self.residual.weights[:, :count]
        return ModalState(
            self.state,
            modes,
            self.damping_rate[:count],
            self.force[:, :count],
            Residual(self.residual.foundation, modes.shapes, left),
            self.at_stops[:, :count],
            self.foundation_at_stops,
        )


@dataclass(frozen=True)
class Passage:
    """The map from one state to the next at a switch."""

    S: FloatArray
    """Without unit, shape ``(N_new, N_old)``."""
    residual: FloatArray
    """S0 first, then Sh, kg^1/2 m for each unit of load, shape ``(1 + H, N_new)``."""


def family_of(problem: Problem, places: Places | None = None) -> Family:
    """The family of a problem.

    Parameters
    ----------
    problem : Problem
        What is solved.
    places : tuple of float or None, optional
        Where its loads act that are not constant, m, or None for one that is uniform; by default those of the problem.

    Returns
    -------
    Family
        The same object for all problems of the family, as long as it is kept.
    """
    if places is None:
        forces = problem.forces
        places = tuple(it.x for it in forces.harmonic) + tuple(it.x for it in forces.sampled)
    steps = tuple((load.x, load.constant) for load in problem.point_loads)
    return _family(problem.structure, steps, places)


@lru_cache(maxsize=_FAMILIES)
def _family(structure: Structure, steps: tuple[tuple[float, float], ...], places: Places) -> Family:
    """The family of a structure, with constant loads (place in m, force in N), and of places where others act."""
    loads = tuple(StepLoad(x=x, force=force) for x, force in steps)
    still = Problem.model_construct(  # of parts that fit together: they were validated
        beam=structure.beam,
        supports=structure.supports,
        stops=structure.stops,
        damping=structure.damping,
        point_loads=loads,
    )
    return Family(still, places)


@cached(_STATES)
def modal_state(family: Family, state: ContactState, count: int) -> ModalState:
    """A contact state in modal form, for unit loads.

    Parameters
    ----------
    family : Family
        The problems that share it.
    state : ContactState
        The stops that are closed.
    count : int
        Number of modes.

    Returns
    -------
    ModalState
        Not to be written to.
    """
    return _modal_state(family, state, pool_size(count)).head(count)


@cached(_STATES)
def _modal_state(family: Family, state: ContactState, count: int) -> ModalState:
    """A contact state with a number of modes that `pool_size` gives."""
    problem = family.problem
    modes = exact_modes(problem, state, count)
    loads = unit_loads(problem, family.places, state, modes.shapes.nodes)
    at_nodes = modes.shapes(modes.shapes.nodes)
    force = loads.concentrated @ at_nodes.T + loads.uniform[:, None] * integral(modes.shapes)  # (27)
    shapes = residual(problem, state, modes, loads, force)
    x_stops = np.array([stop.x for stop in problem.stops])
    return ModalState(
        state=state,
        modes=modes,
        damping_rate=damping_rates(problem, modes.omega),
        force=force,
        residual=shapes,
        at_stops=modes.shapes(x_stops).T,
        foundation_at_stops=shapes.foundation(x_stops),
    )


@cached(_PASSAGES)
def passage(family: Family, old: ContactState, n_old: int, new: ContactState, n_new: int) -> Passage:
    """The map from one state to another, for unit loads (43).

    Parameters
    ----------
    family : Family
        The problems that share it.
    old : ContactState
        The state before the switch.
    n_old : int
        Its number of modes.
    new : ContactState
        The state after the switch.
    n_new : int
        Its number of modes.

    Returns
    -------
    Passage
        Not to be written to.
    """
    products = _products(family, old, pool_size(n_old), new, pool_size(n_new))
    weights = _modal_state(family, old, pool_size(n_old)).residual.weights[:, :n_old]
    S = products.S[:n_new, :n_old]
    return Passage(S, products.residual[:, :n_new] - weights @ S.T)


@cached(_PASSAGES)
def _products(family: Family, old: ContactState, n_old: int, new: ContactState, n_new: int) -> Passage:
    """Inner products of the modes of `new` with the modes and with the foundation shapes of `old`."""
    before, m = _modal_state(family, old, n_old), family.problem.beam.m
    after = _modal_state(family, new, n_new).modes.shapes
    return Passage(m * gram(after, before.modes.shapes), m * gram(before.residual.foundation, after))
