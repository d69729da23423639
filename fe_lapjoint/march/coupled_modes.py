"""What a contact state whose modes are coupled is without its loads, kept for all problems of the same joint.

A search marches through a dozen of these states on each mesh, and each needs the eigenvalues of a dense matrix.  They
depend on the joint, its mesh and the closed stops: another frequency or size of the excitation takes them as they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fe_lapjoint.march.exponentials import Exponentials, exponentials
from fe_lapjoint.march.system import ComplexArray, IndexArray, drag_on, own_rates
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.eigenmodes import eigenmodes, transfer
from lapjoint.answers.contact_state import ContactState
from lapjoint.machine.result_cache import cached
from lapjoint.problem import FloatArray, ModalDamping
from lapjoint.problem.problem import resting
from lapjoint.problem.structure import Structure
from lapjoint.problem.supports_and_stops import PlacedStop

_KEPT = 256  # states that are kept, each of a megabyte with 40 elements


@dataclass(frozen=True, eq=False)
class CoupledModes:
    """A state of ``n`` modes and ``P`` stops, ``D`` of them damped, without loads; see `Coupled`."""

    closed: tuple[int, ...]
    """The closed damped stops."""
    pressing: tuple[int, ...]
    """Those of them that exert a force."""
    bent: FloatArray
    """What a damper that exerts a force acts on: its mode, kg^-1/2, without rigid-body motions, which are those that no
    spring holds; shape ``(len(pressing), n)``."""
    damping: FloatArray
    """Damping matrix, 1/s, shape ``(n, n)``."""
    free: Exponentials
    places: FloatArray
    """Modes at the places, kg^-1/2, shape ``(p, n)``."""
    delay: FloatArray
    """See `Coupled.delay`."""
    place_of: IndexArray
    """The place of each gap function that may switch."""
    force_place: IndexArray
    """See `Coupled.force_place`."""
    row_places: IndexArray
    """See `Coupled.row_places`."""

    @cached_property
    def shares(self) -> ComplexArray:
        """Factor of each free term in the motion of the places, kg^-1/2, shape ``(p, T)``."""
        return np.asarray(self.places @ self.free.modes * (1 + np.outer(self.delay, self.free.rates)))

    @cached_property
    def moduli(self) -> FloatArray:
        """Moduli of the factors of (q, q') in the motion of the places, shape ``(p, 2 n)``."""
        own = np.abs(self.places)
        return np.concatenate([own, self.delay[:, None] * own], axis=1)


def coupled_modes(assembly: Assembly, state: ContactState, omega: FloatArray) -> CoupledModes:
    """A state on a mesh, whose modes before they are coupled have the frequencies `omega`, rad/s, ``(n,)``."""
    return _coupled_modes(assembly.problem.structure, assembly.without_stops[1], state, omega.tobytes())


@cached(_KEPT)
def _coupled_modes(
    structure: Structure, nodes: tuple[float, ...], state: ContactState, frequencies: bytes
) -> CoupledModes:
    """`coupled_modes` by all that they depend on; not to be written to."""
    assembly, stops, omega = Assembly(resting(structure), np.array(nodes)), structure.stops, np.frombuffer(frequencies)
    vectors, (first, at) = eigenmodes(assembly, acting(state))[1], assembly.stop_places
    phi = assembly.stop_rows @ vectors
    damped = [k for k, stop in enumerate(stops) if stop.damping > 0]
    closed = [k for k in damped if k in state]
    pressing = [k for k in closed if k not in state.released]
    own, drag = np.diag(2 * own_rates(assembly.problem, omega)), drag_on(assembly, vectors)
    if state.released and isinstance(structure.damping, ModalDamping):
        S = transfer(assembly, state.pressed, acting(state))
        own = (S * (2 * own_rates(assembly.problem, eigenmodes(assembly, state.pressed)[0]))) @ S.T
    coupling = np.zeros_like(own) if drag is None else drag
    bent = np.where(omega > 0, phi[pressing], 0.0)
    for k, mode in zip(pressing, bent, strict=True):
        coupling += stops[k].damping * np.outer(mode, mode)
    places, P = phi[first], len(stops)
    force_place, row_places = at.copy(), np.full(P + len(damped), -1)
    row_places[:P] = at
    for i, k in enumerate(closed):
        force_place[k] = row_places[P + damped.index(k)] = places.shape[0] + i
    return CoupledModes(
        tuple(closed),
        tuple(pressing),
        bent,
        own + coupling,
        exponentials(omega, own, coupling),
        np.concatenate([places, phi[closed]]),
        np.array([*np.zeros(places.shape[0]), *(stops[k].damping / stops[k].stiffness for k in closed)]),
        row_places[searched_rows(stops, state)],
        force_place,
        row_places,
    )


def acting(state: ContactState) -> ContactState:
    """The state with the stops that have let go open: its modes are those of the springs that act."""
    return ContactState(tuple(k for k in state.closed if k not in state.released)) if state.released else state


def searched_rows(stops: Sequence[PlacedStop], state: ContactState) -> IndexArray:
    """The gap functions that may switch: those of all stops, and those of the forces of closed stops that end."""
    damped = [k for k, stop in enumerate(stops) if stop.damping > 0]
    forces = [i for i, k in enumerate(damped, len(stops)) if k in state and not stops[k].may_pull]
    return np.array([*range(len(stops)), *forces], dtype=np.intp)
