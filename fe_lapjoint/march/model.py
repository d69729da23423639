"""A problem on a mesh with its contact states, each built when it is first entered."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fe_lapjoint.march.coupled import Coupled, coupled_system
from fe_lapjoint.march.coupled_modes import acting, coupled_modes, searched_rows
from fe_lapjoint.march.ramp_tables import Knots, RampForm, knots_of, ramp_form
from fe_lapjoint.march.system import IndexArray, System, build_system, under_other_loads
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.eigenmodes import transfer, weighted
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.ramps import Ramps

_ALL = slice(None)


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
    _undamped: dict[ContactState, System] = field(default_factory=dict)
    _rows: dict[ContactState, IndexArray] = field(default_factory=dict)
    _gaps: dict[ContactState, tuple[FloatArray, FloatArray]] = field(default_factory=dict)
    _forms: dict[ContactState, RampForm] = field(default_factory=dict)
    _block: tuple[Ramps, Knots] | None = None
    _maps: dict[tuple[ContactState, ContactState], FloatArray] = field(default_factory=dict)
    passages: dict[tuple[ContactState, ContactState], FloatArray] = field(default_factory=dict)
    """The matrices of `fe_lapjoint.march.coupled_tangent.passage` that were needed."""
    _alike: Model | None = None
    """A model that differs by the excitation alone, whose contact states are shared."""

    def __post_init__(self) -> None:
        stops = self.problem.structure.stops
        self.sign = np.array([stop.sign for stop in stops], dtype=float)
        self.gap = np.array([stop.gap for stop in stops], dtype=float)
        self.stiffness = np.array([stop.stiffness for stop in stops], dtype=float)
        self.damped = tuple(k for k, stop in enumerate(stops) if stop.damping > 0)
        """The damped stops, each of which has a second gap function, of its force; see `fe_lapjoint.march.coupled`."""
        self.drags = self.problem.structure.couples
        """Whether viscous damping, or dampers of links, couple the modes of all states."""

    def driven(self, problem: Problem) -> Model:
        """This mesh, with all its matrices, for a problem with another size or frequency of the excitation."""
        alike = self._alike or self
        return Model(problem, self.assembly, self.method, self.rtol, self.atol, _maps=self._maps, _alike=alike)

    def system(self, state: ContactState) -> System:
        """One contact state in modal form."""
        system = self._systems.get(state)
        if system is None:
            coupled = self.drags or any(k in state for k in self.damped)
            system = self._systems[state] = self._coupled(state) if coupled else self.undamped(state)
        return system

    def undamped(self, state: ContactState) -> System:
        """A contact state as if no stop were damped, and as if stops that have let go were open."""
        state = acting(state)
        system = self._undamped.get(state)
        if system is None:
            if self._alike is None:
                system = build_system(self.assembly, state)
            else:
                system = under_other_loads(self._alike.undamped(state), self.assembly, self.problem)
            self._undamped[state] = system
        return system

    def _coupled(self, state: ContactState) -> Coupled:
        """A contact state whose modes are coupled."""
        base = self.undamped(state)
        modes = coupled_modes(self.assembly, state, base.omega)
        return coupled_system(base, state, self.problem.structure.stops, modes)

    def rows(self, state: ContactState) -> IndexArray | slice:
        """Which of the gap functions, of ``P`` stops and then of the forces of damped stops, may switch in a state."""
        if not self.damped:
            return _ALL
        rows = self._rows.get(state)
        if rows is None:
            rows = self._rows[state] = searched_rows(self.problem.structure.stops, state)
        return rows

    def after(self, state: ContactState, row: int) -> ContactState:
        """The state after the switch of a gap function."""
        return state.toggled(row if row < self.sign.size else ~self.damped[row - self.sign.size])

    def ramp_form(self, state: ContactState, window: float) -> RampForm:
        """One contact state for the march along sampled forces; `window`, s, is the same in every call."""
        form = self._forms.get(state)
        if form is None:
            form = self._forms[state] = ramp_form(self.system(state), *self._signs(state), window)
        return form

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
        return weighted(self.assembly, acting(state))

    def transfer(self, old: ContactState, new: ContactState) -> FloatArray:
        """The orthogonal matrix Phi_new^T M Phi_old, ``(n, n)``, which maps modal coordinates between states."""
        matrix = self._maps.get((old, new))
        if matrix is None:
            one, other = acting(old), acting(new)
            matrix = np.eye(self.assembly.free.size) if one == other else transfer(self.assembly, one, other)
            self._maps[old, new] = matrix
        return matrix

    def orientation(self, state: ContactState) -> FloatArray:
        """Signs, ``(P,)``, one for each of `rows`: ``orientation * z - offset`` rises through 0 at the next switch."""
        return self._signs(state)[0]

    def offset(self, state: ContactState) -> FloatArray:
        """The gap of each open stop, and minus the gap of each closed stop, m, shape ``(P,)``; see `orientation`."""
        return self._signs(state)[1]

    def _signs(self, state: ContactState) -> tuple[FloatArray, FloatArray]:
        signs = self._gaps.get(state)
        if signs is None:
            closed = np.array([k in state for k in range(self.sign.size)], dtype=bool)
            direction = np.where(closed, -1.0, 1.0)
            signs = direction * self.sign, direction * self.gap
            if self.damped:
                stop = [*range(self.sign.size), *self.damped]
                presses = np.array([-1.0 if k in state and k not in state.released else 1.0 for k in self.damped])
                both, rows = np.concatenate([direction, presses]), self.rows(state)
                signs = (both * self.sign[stop])[rows], (both * self.gap[stop])[rows]
            self._gaps[state] = signs
        return signs
