"""A mesh as `tests.helpers.damped_stops.witnessed` takes a joint: its modes, and the maps between them."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from fe_lapjoint.march.model import Model
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.mesh import mesh_nodes
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import Beam, BeamSegment, FloatArray, Mass, Problem, ViscousDamping
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
            modes=SimpleNamespace(
                omega=system.omega, shapes=lambda x: system.vectors.T @ self.model.assembly.shapes(x, 0).T
            ),
            residual=lambda x: np.zeros((1 + system.driven.size, x.size)),
            damping_rate=system.damping_rate * (not self.model.drags),
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


def random_dragged_mesh(rng: np.random.Generator) -> Model:
    """The same with a step, a mass or both, under viscous damping, which couples its modes."""
    problem, kind = random_damped_mesh(rng).problem, rng.integers(3)
    (e, f), (m, n) = 10 ** rng.uniform(-0.5, 0.5, (2, 2))
    stepped = Beam(
        length=1.0,
        segments=(
            BeamSegment(to=0.5, bending_stiffness=float(e), mass_per_length=float(m)),
            BeamSegment(to=1.0, bending_stiffness=float(f), mass_per_length=float(n)),
        ),
    )
    mass = Mass(x=float(rng.choice([0.5, 1.0])), mass=float(10 ** rng.uniform(-1.5, 0.5)), rotary_inertia=1e-3)
    stops = problem.stops
    if rng.random() < 0.5:
        stops = tuple(stop.model_copy(update={"damping": 0.0, "may_pull": False}) for stop in stops)
    return model_of(
        problem.replace(
            beam=problem.beam if kind == 1 else stepped,
            masses=() if kind == 0 else (mass,),
            stops=stops,
            damping=ViscousDamping(coefficient=float(10 ** rng.uniform(-1, 1))),
        ),
        2,
    )
