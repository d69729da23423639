"""The loads of a problem: the excitation, with its sizes, frequencies and phases, and the loads of unit size."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from analytic.modes.static_residual import Loads
from lapjoint.answers.contact_state import ContactState
from lapjoint.orbits.parameters import ExcitationChange
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.excitation import Wave
from lapjoint.problem.forces import HarmonicForce
from lapjoint.problem.load_shape import LoadShape

Positions = tuple[LoadShape, ...]
"""Where each load that is not constant acts."""
MOVED_STOPS = LoadShape()
"""In place of a shape: the base is moved by 1 m, and relative to it every stop fixed in space by -1 m.  A closed one
pushes the beam by -k, and the gap functions of all of them see the displacement of the base beside that of the beam."""


@dataclass(frozen=True)
class Harmonics:
    """Frequencies and phases of the harmonic loads."""

    omega: FloatArray
    """Angular frequencies, rad/s, shape ``(H,)``."""
    phase: FloatArray
    """Phases, rad, shape ``(H,)``."""

    @staticmethod
    def of_unit_frequency(count: int) -> Harmonics:
        """`count` harmonics of 1 rad/s and phase 0, placeholders for harmonics given later."""
        return Harmonics(np.ones(count), np.zeros(count))

    def theta(self, t: float) -> FloatArray:
        """Phase angles, rad, at the time `t`, s, shape ``(H,)``."""
        return self.omega * t + self.phase


@dataclass(frozen=True)
class Excitation:
    """The loads of a problem beside the constant ones."""

    harmonics: Harmonics
    sizes: FloatArray
    """Factors of the unit loads, shape ``(1 + H + R,)``: 1 for the constant load; the amplitudes of the harmonics, m/s2
    of the moving base, N of loads at points, and m of moved stops; and 1 for sampled loads, whose samples have a unit
    themselves, among them the displacement of stops that a sampled base moves."""
    period: float | None
    """The excitation period, s; None if there is none."""
    changes: Mapping[str, ExcitationChange] = field(default_factory=dict)
    """How the excitation changes with parameters, by their paths, as far as that is known beforehand."""


def excitation_of(problem: Problem) -> Excitation:
    """The excitation of a problem: its harmonic loads in the order of its forces, its moved stops, its sampled forces,
    and stops that a recorded or random base moves."""
    waves: tuple[HarmonicForce | Wave, ...] = (*problem.forces.harmonic, *problem.moved_stops)
    fundamental = problem.excitation_frequency
    harmonics = Harmonics(
        np.array([wave.angular_frequency for wave in waves]), np.array([wave.phase for wave in waves])
    )
    sampled = len(problem.forces.sampled) + (problem.forces.seen is not None)
    sizes = np.array([1.0, *(wave.amplitude for wave in waves), *np.ones(sampled)])
    return Excitation(harmonics, sizes, None if fundamental is None else 2 * math.pi / fundamental)


def unit_loads(problem: Problem, positions: Positions, state: ContactState, nodes: FloatArray) -> Loads:
    """The loads in a contact state; each load that is not constant has the size 1.

    Load 0 is constant: the forces k gap of the closed stops, and the constant forces of `problem`.  The other loads,
    harmonic or sampled, act at `positions`.  `nodes`, m, ascending, are the nodes of the beam; every load acts at a
    node, and every piece of a load ends at one.
    """
    total = Loads(np.zeros((1 + len(positions), nodes.size - 1)), np.zeros((1 + len(positions), nodes.size)))

    def add(row: int, shape: LoadShape, size: float) -> None:
        own = acting(shape, nodes)
        total.distributed[row] += size * own.distributed[0]
        total.concentrated[row] += size * own.concentrated[0]

    for i in state.closed:
        stop = problem.structure.stops[i]
        add(0, stop.shape, stop.sign * stop.stiffness * stop.gap)
    for load in problem.forces.constant:
        add(0, load.shape, load.force)
    for row, shape in enumerate(positions, start=1):
        add(row, shape, 1.0)
        for stop in (problem.structure.stops[i] for i in state.closed if shape == MOVED_STOPS):
            if stop.in_space:
                add(row, stop.shape, -stop.stiffness * stop.base_share)
    for support in problem.structure.supports:
        if math.isinf(support.translational):  # a fixed point does not move, and the modes are there 0 but for rounding
            total.concentrated[:, _node_at(support.x, nodes)] = 0.0
    return total


def acting(shape: LoadShape, nodes: FloatArray) -> Loads:
    """One load of size 1 on a beam with `nodes`, m, ascending, which the load's edges are among, to rounding."""
    middle, loads = (nodes[:-1] + nodes[1:]) / 2, Loads(np.zeros((1, nodes.size - 1)), np.zeros((1, nodes.size)))
    for x, force in shape.points:
        loads.concentrated[0, _node_at(x, nodes)] += force
    for start, end, force in shape.pieces:
        loads.distributed[0, (middle > start) & (middle < end)] += force
    return loads


def _node_at(x: float, nodes: FloatArray) -> int:
    """The index of the node at ``x``, m: nodes are (x / L) L, a rounding from x."""
    return int(np.argmin(np.abs(nodes - x)))
