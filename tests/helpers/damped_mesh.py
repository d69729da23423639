"""A mesh as `tests.helpers.damped_stops.witnessed` takes a joint: its modes, and the maps between them."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from fe_lapjoint.march.model import Model
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.mesh import mesh_nodes
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray, Problem
from tests.helpers.damped_stops import random_damped_joint


def model_of(problem: Problem, elements: int) -> Model:
    """A problem on a mesh, by the exact method."""
    return Model(problem, Assembly(problem, mesh_nodes(problem, elements, None)), "exact", 1e-9, 1e-12)


class MeshForWitness:
    """All modes of a mesh with the springs of the closed stops; no mode is left out."""

    def __init__(self, model: Model) -> None:
        system = model.undamped(ContactState())
        self.model, self.problem = model, model.problem
        self.harmonics = SimpleNamespace(omega=system.driven, theta=lambda t: system.driven * t + system.phase)
        self.sizes = np.ones(1 + system.driven.size)
        self.loaded = SimpleNamespace(positions=[None] * system.driven.size)

    def modal(self, state: ContactState) -> SimpleNamespace:
        """The modes of a set of closed stops, and the loads on them."""
        system, n = self.model.undamped(state), self.model.assembly.free.size
        return SimpleNamespace(
            size=n,
            at_stops=system.stops,
            force=np.concatenate([system.constant[None], system.harmonic.T]),
            residual_at_stops=np.concatenate([np.zeros((1, system.place_of.size)), system.seen[system.place_of].T]),
            modes=SimpleNamespace(omega=system.omega),
            damping_rate=system.damping_rate,
        )

    def passage(self, old: ContactState, new: ContactState) -> SimpleNamespace:
        """The map between the modes of two sets of closed stops."""
        n = self.model.assembly.free.size
        return SimpleNamespace(S=self.model.transfer(old, new), residual=np.zeros((self.sizes.size, n)))

    def in_modes(self, state: ContactState, y: FloatArray) -> FloatArray:
        """(q, q') in the modes of all closed stops, from those of the springs that act, shape ``(2, n)``."""
        return np.asarray(y.reshape(2, -1) @ self.model.transfer(state, ContactState(state.closed)).T)


def random_damped_mesh(rng: np.random.Generator) -> Model:
    """A random cantilever of two elements, with one to four stops at their ends, of which most are damped."""
    problem = random_damped_joint(rng)
    stops = [stop.model_copy(update={"x": 0.5 if stop.x < 0.65 else 1.0}) for stop in problem.stops]
    return model_of(problem.replace(stops=tuple(stops)), 2)
