"""A problem on a mesh with its contact states, each built when it is first entered."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fe_lapjoint.march.ramp_interval import Knots, RampTables, knots_of, ramp_tables
from fe_lapjoint.march.system import System, build_system, under_other_loads
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.eigenmodes import transfer, weighted
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.ramps import Ramps


@dataclass
class Model:
    """A problem on a mesh: contact states, each with ``n`` modes, are built when first needed, and kept."""

    problem: Problem
    assembly: Assembly
    """The mesh; its own problem may have harmonic loads of other sizes or frequencies."""
    method: str
    """"exact", or a method of `solve_ivp`."""
    rtol: float
    """Relative tolerance of that method."""
    atol: float
    """Absolute tolerance of that method, kg^1/2 m and kg^1/2 m/s."""
    _systems: dict[ContactState, System] = field(default_factory=dict)
    _gaps: dict[ContactState, tuple[FloatArray, FloatArray]] = field(default_factory=dict)
    _tables: dict[ContactState, RampTables] = field(default_factory=dict)
    _block: tuple[Ramps, Knots] | None = None
    _maps: dict[tuple[ContactState, ContactState], FloatArray] = field(default_factory=dict)
    _alike: Model | None = None
    """A model that differs by the excitation alone, whose contact states are shared."""

    def __post_init__(self) -> None:
        stops = self.problem.stops
        self.sign = np.array([stop.sign for stop in stops], dtype=float)
        self.gap = np.array([stop.gap for stop in stops], dtype=float)
        self.stiffness = np.array([stop.stiffness for stop in stops], dtype=float)

    def driven(self, problem: Problem) -> Model:
        """This mesh, with all its matrices, for a problem with another size or frequency of the excitation."""
        alike = self._alike or self
        return Model(problem, self.assembly, self.method, self.rtol, self.atol, _maps=self._maps, _alike=alike)

    def system(self, state: ContactState) -> System:
        """One contact state in modal form."""
        system = self._systems.get(state)
        if system is None:
            if self._alike is None:
                system = build_system(self.assembly, state)
            else:
                system = under_other_loads(self._alike.system(state), self.assembly, self.problem)
            self._systems[state] = system
        return system

    def ramp_tables(self, state: ContactState, window: float) -> RampTables:
        """Tables of one contact state for the march along sampled forces; `window`, s, is the same in every call."""
        tables = self._tables.get(state)
        if tables is None:
            signs = self._signs(state)
            tables = self._tables[state] = ramp_tables(self.system(state), *signs, window)
        return tables

    def block_at(self, t: float) -> tuple[Knots, float]:
        """The block of sampled forces at time `t`, s, and its end, s; see `lapjoint.problem.ramps.RampBlocks`."""
        assert self.problem.forces.ramps is not None
        block = self.problem.forces.ramps.block_at(t)
        if self._block is None or self._block[0] is not block:
            self._block = block, knots_of(block)
        return self._block[1], block.end

    def weighted(self, state: ContactState) -> FloatArray:
        """M Phi of a contact state, kg^1/2, ``(n, n)``; free degrees of freedom multiplied by it give modal
        coordinates."""
        return weighted(self.assembly, state)

    def transfer(self, old: ContactState, new: ContactState) -> FloatArray:
        """The orthogonal matrix Phi_new^T M Phi_old, ``(n, n)``, which maps modal coordinates between states."""
        matrix = self._maps.get((old, new))
        if matrix is None:
            matrix = self._maps[old, new] = transfer(self.assembly, old, new)
        return matrix

    def orientation(self, state: ContactState) -> FloatArray:
        """Signs, ``(P,)``, with which ``orientation * z - offset`` rises through 0 at the next switch of each stop."""
        return self._signs(state)[0]

    def offset(self, state: ContactState) -> FloatArray:
        """The gap of each open stop, and minus the gap of each closed stop, m, shape ``(P,)``; see `orientation`."""
        return self._signs(state)[1]

    def _signs(self, state: ContactState) -> tuple[FloatArray, FloatArray]:
        signs = self._gaps.get(state)
        if signs is None:
            closed = np.array([k in state for k in range(self.sign.size)], dtype=bool)
            direction = np.where(closed, -1.0, 1.0)
            signs = self._gaps[state] = direction * self.sign, direction * self.gap
        return signs
