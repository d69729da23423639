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

All loads here have unit size.  Modal states and passages therefore belong to a `LoadedStructure`: all problems that
differ in the size, the frequency and the phase of their excitation only.  A sweep over these computes them once.  What
is cached depends on its key alone and is never changed: `analytic.march.joint` makes its own scaled copy.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from analytic.march.loads import MOVED_STOPS, Positions, unit_loads
from analytic.march.oscillator import damping_rates
from analytic.modes.beam_functions import gram, inertia_of
from analytic.modes.normal_modes import NormalModes, exact_modes, pool_size
from analytic.modes.static_residual import Residual, residual
from lapjoint.answers.contact_state import ContactState
from lapjoint.machine.result_cache import cached
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.forces import ConstantForce
from lapjoint.problem.problem import resting
from lapjoint.problem.structure import Structure
from lapjoint.problem.supports_and_stops import readings

_STRUCTURES = 16  # loaded structures kept: a campaign seldom alternates between more
_STATES = 256  # contact states kept, enough for 16 structures with the nine of the paper; each takes about 100 kB
_PASSAGES = 512  # passages kept, as a state of four stops can switch to four others; each takes about 15 kB


@dataclass(frozen=True, eq=False)
class LoadedStructure:
    """The part of a problem that does not depend on the size, the frequency and the phase of the excitation."""

    problem: Problem
    """The problem with only the constant part of its loads."""
    positions: Positions
    """Positions of the ``H`` harmonic loads, of which moved stops are the last, and then of the sampled loads, of which
    stops that a recorded or random base moves are the last."""
    sampled: int
    """Number ``R`` of sampled loads."""

    @cached_property
    def damped(self) -> bool:
        """Whether a stop is damped."""
        return any(stop.damping > 0 for stop in self.problem.structure.stops)

    def __reduce__(self) -> tuple[object, ...]:
        return _loaded_structure, (self.problem.structure, self.problem.forces.constant, self.positions, self.sampled)


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
        """This state with its `count` lowest modes only."""
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


def loaded_structure(problem: Problem) -> LoadedStructure:
    """The loaded structure of a problem; problems that share it get the same object while it is cached."""
    forces = problem.forces
    sampled = (*(it.shape for it in forces.sampled), *(() if forces.seen is None else (MOVED_STOPS,)))
    positions = (*(it.shape for it in forces.harmonic), *(MOVED_STOPS for _ in problem.moved_stops), *sampled)
    at_points = [load.shape for load in forces.harmonic if not load.of_base]
    at_points += [load.shape for load in forces.sampled]
    # Loads that change with time act at nodes, too: there they are constant loads of size 0.
    constant = (*forces.constant, *(ConstantForce(shape, 0.0) for shape in dict.fromkeys(at_points)))
    return _loaded_structure(problem.structure, constant, positions, len(sampled))


@lru_cache(maxsize=_STRUCTURES)
def _loaded_structure(
    structure: Structure, constant: tuple[ConstantForce, ...], positions: Positions, sampled: int
) -> LoadedStructure:
    """A structure with constant loads, and the positions of the other loads, of which the last are sampled."""
    return LoadedStructure(resting(structure, constant), positions, sampled)


@cached(_STATES)
def modal_state(loaded: LoadedStructure, state: ContactState, count: int) -> ModalState:
    """A contact state with `count` modes in modal form, for unit loads; not to be written to."""
    return _modal_state(loaded, state, pool_size(count)).head(count)


@cached(_STATES)
def _modal_state(loaded: LoadedStructure, state: ContactState, count: int) -> ModalState:
    """A contact state with a number of modes that `pool_size` gives."""
    problem = loaded.problem
    modes = exact_modes(problem, state, count)
    loads = unit_loads(problem, loaded.positions, state, modes.shapes.nodes)
    force = loads.modal(modes.shapes)
    shapes = residual(problem, state, modes, loads, force)
    x, seen = readings(problem.structure.stops)
    return ModalState(
        state=state,
        modes=modes,
        damping_rate=damping_rates(problem, modes.omega),
        force=force,
        residual=shapes,
        at_stops=seen @ modes.shapes(x).T,
        foundation_at_stops=shapes.foundation(x) @ seen.T,
    )


@cached(_PASSAGES)
def passage(loaded: LoadedStructure, old: ContactState, n_old: int, new: ContactState, n_new: int) -> Passage:
    """The map from a state with `n_old` modes to one with `n_new`, for unit loads (43); not to be written to."""
    products = _products(loaded, old, pool_size(n_old), new, pool_size(n_new))
    weights = _modal_state(loaded, old, pool_size(n_old)).residual.weights[:, :n_old]
    S = products.S[:n_new, :n_old]
    return Passage(S, products.residual[:, :n_new] - weights @ S.T)


@cached(_PASSAGES)
def _products(loaded: LoadedStructure, old: ContactState, n_old: int, new: ContactState, n_new: int) -> Passage:
    """Inner products of the modes of `new` with the modes and with the foundation shapes of `old`."""
    before, inertia = _modal_state(loaded, old, n_old), inertia_of(loaded.problem.line, loaded.problem.structure.masses)
    after = _modal_state(loaded, new, n_new).modes.shapes
    return Passage(gram(after, before.modes.shapes, inertia), before.residual.foundation.products(after, inertia))
