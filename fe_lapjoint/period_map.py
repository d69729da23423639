"""The period map of the finite element solver, as the search for periodic motions uses it.

A section point holds the displacements and slopes of all nodes, and their rates, which every problem on a mesh shares.
Deviations are (q, q') in the modes of the joint without contact.  The modal masses are one, so that the norm of a
deviation needs no mass matrix.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import islice

import numpy as np

from fe_lapjoint.march.arcs import Arcs
from fe_lapjoint.march.coupled import Coupled
from fe_lapjoint.march.field import history_of
from fe_lapjoint.march.initial import initial_coordinates, initial_state
from fe_lapjoint.march.march import March, longest_window, march, require_room, window_of
from fe_lapjoint.march.model import Model
from fe_lapjoint.march.section_points import coordinates_of, section_point, understood
from fe_lapjoint.march.tangent import Carried
from fe_lapjoint.modes.assembly import Assembly
from lapjoint.answers import History
from lapjoint.answers.contact_state import FREE, ContactState
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.orbits.displaced import StaticShapes
from lapjoint.orbits.parameters import excitation_change
from lapjoint.orbits.period_map import (
    LEAST_GROWTH,
    Derivative,
    Followed,
    Linearised,
    Passage,
    period_pieces,
    rescaled,
)
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.damping import ROUNDED
from lapjoint.problem.problem import resting
from lapjoint.problem.symmetry import mirror_twins
from lapjoint.solver import Progress

_STRETCH = 16
"""Excitation periods in one stretch of a streamed motion."""
_FEW = 64
"""Most pieces of a march along which a deviation is carried before it is rescaled; a change of contact state may
multiply the deviation by 1e4."""
_TOUCHING = 1e-12
"""A stop whose gap and displacement differ by less than this fraction keeps its contact state: the difference may be
rounding."""


@dataclass(frozen=True)
class PeriodMap:
    """The motion of a problem from section point to section point; see `lapjoint.orbits.PeriodMap`."""

    model: Model
    name: str

    @property
    def problem(self) -> Problem:
        """The problem."""
        return self.model.problem

    @cached_property
    def omega(self) -> float:
        """Angular frequency of the excitation, rad/s."""
        return self.problem.require_excitation_frequency("steady state")

    @property
    def period(self) -> float:
        """The excitation period, s."""
        return 2 * math.pi / self.omega

    @cached_property
    def lowest_damping_rate(self) -> float:
        """Least positive damping rate zeta omega of the modes of the joint without contact, 1/s; 0 without damping."""
        system, rounding = self.model.system(FREE), 0.0
        damping_rate = system.damping_rate
        if isinstance(system, Coupled):
            damping_rate, rounding = -system.free.rates.real, ROUNDED * float(np.abs(system.free.rates).max())
        return float(damping_rate[damping_rate > rounding].min()) if (damping_rate > rounding).any() else 0.0

    @cached_property
    def _twins(self) -> tuple[int, ...] | None:
        """The twin of each stop, if the problem is its own mirror image."""
        return mirror_twins(self.problem)

    @cached_property
    def arcs(self) -> Arcs:
        """Motions with a given contact sequence. See `lapjoint.orbits.arcs.HasArcs`."""
        return Arcs(self.model, self.omega)

    def retuned(self, field: str, value: float, problem: Callable[[], Problem]) -> PeriodMap | None:
        """The map with another excitation on the same mesh. See `lapjoint.orbits.parameters.Retunes`."""
        if excitation_change(self.problem, field) is None:
            return None
        return PeriodMap(self.model.driven(problem()), self.name)

    def initial(self) -> SectionPoint:
        """The initial state of the problem."""
        state = initial_state(self.model)
        return section_point(self.model, state, initial_coordinates(self.model.assembly, self.model.system(state)))

    @in_one_thread
    def march(self, start: SectionPoint, half_periods: int) -> Passage:
        """March a period at a time. See `lapjoint.orbits.PeriodMap.march`."""
        point, total, switches = start, np.zeros(len(self.problem.structure.stops)), 0
        for piece in [self.period] * (half_periods // 2) + [self.period / 2] * (half_periods % 2):
            motion = march(self.model, point.state, self.modal(point), 0.0, piece, peaks=False, keep=False)
            point = section_point(self.model, motion.state, motion.y)
            total += motion.impulses
            switches += motion.switches
        return Passage(point, total, switches)

    @in_one_thread
    def history(self, start: SectionPoint, periods: int) -> History:
        """The same march with its contacts. See `lapjoint.orbits.PeriodMap.history`."""
        return self._recorded(start, [self.period] * periods, None)

    def simulated(self, duration: float, progress: Progress | None) -> History:
        """The motion from the initial state to `duration`, s, marched a period at a time, as in the search for steady
        states."""
        longest = max(window_of(self.model, FREE), longest_window(self.model, FREE, duration))
        require_room(self.model, duration / longest)
        motion = self._recorded(self.initial(), period_pieces(self.period, duration), progress)
        return replace(motion, end=duration)  # the sum of the pieces differs from the duration by rounding

    def streamed(self, duration: float) -> Iterator[History]:
        """The motion of `simulated`, some periods at a time; see `lapjoint.solver.Streams.stream`."""
        pieces = period_pieces(self.period, duration)
        motions, start = self._marched(self.initial(), pieces), 0.0
        for first in range(0, len(pieces), _STRETCH):
            taken = list(islice(motions, _STRETCH))
            number = first + len(taken)
            end = duration if number == len(pieces) else number * self.period
            yield _between(history_of(self.name, self.model, taken, self.period, first), start, end)
            start = end

    def _recorded(self, start: SectionPoint, pieces: list[float], progress: Progress | None) -> History:
        motions, number, size = [], 0, 0.0
        for motion in self._marched(start, pieces):
            motions.append(motion)
            number += len(motion.pieces)
            size = require_room(self.model, number, size)
            if progress is not None:
                progress(float(len(motions)), float(len(pieces)))
        return history_of(self.name, self.model, motions, self.period)

    def _marched(self, start: SectionPoint, pieces: list[float]) -> Iterator[March]:
        """The marches of pieces that follow each other; each march counts time from 0."""
        point = start
        for piece in pieces:
            motion = march(self.model, point.state, self.modal(point), 0.0, piece)
            yield motion
            point = section_point(self.model, motion.state, motion.y)

    def difference(self, point: SectionPoint, origin: SectionPoint) -> FloatArray:
        """Deviation, as (q, q') in the modes without contact. See `lapjoint.orbits.PeriodMap.difference`."""
        return self._free_modes((point.coordinates - origin.coordinates)[:, self.model.assembly.free])

    def norm(self, deviation: FloatArray) -> float:
        """Root of |q|^2 + |q' / omega|^2, kg^1/2 m. See `lapjoint.orbits.PeriodMap.norm`."""
        q, v = deviation.reshape(2, -1)
        return math.hypot(float(np.linalg.norm(q)), float(np.linalg.norm(v)) / self.omega)

    def unit_norms(self, n: int) -> FloatArray:
        """Norms of units of the coordinates. See `lapjoint.orbits.period_map.UnitNorms`."""
        return np.repeat([1.0, 1 / self.omega], n // 2)

    def size(self, point: SectionPoint) -> float:
        """Norm of the coordinates. See `lapjoint.orbits.PeriodMap.size`."""
        return self.norm(self._free_modes(point.coordinates[:, self.model.assembly.free]))

    def moved(self, origin: SectionPoint, deviation: FloatArray) -> SectionPoint:
        """The point moved by a deviation, stops open or closed by their gaps.  See
        `lapjoint.orbits.PeriodMap.moved`."""
        assembly = self.model.assembly
        moved = origin.coordinates[:, assembly.free] + deviation.reshape(2, -1) @ self.model.system(FREE).vectors.T
        return self._settled(SectionPoint(origin.state, assembly.full(moved), origin.nodes))

    def mirrored(self, point: SectionPoint) -> SectionPoint:
        """The mirror image, with every stop exchanged for its twin. See `lapjoint.orbits.PeriodMap.mirrored`."""
        assert self._twins is not None
        closed, released = (tuple(self._twins[k] for k in part) for part in (point.state.closed, point.state.released))
        return SectionPoint(ContactState(closed, released), -point.coordinates, point.nodes)

    def adopted(self, point: SectionPoint) -> SectionPoint:
        """A section point, interpolated to this mesh if it is of another.  See `lapjoint.orbits.PeriodMap.adopted`."""
        assembly, coordinates = self.model.assembly, point.coordinates
        nodes = understood(self.problem, point)
        if not np.array_equal(nodes, assembly.nodes):
            if abs(nodes[-1] - assembly.nodes[-1]) > 1e-9 * assembly.nodes[-1]:
                raise InputError("start: is a section point of a beam of another length")
            other = Assembly(resting(replace(self.problem.structure, supports=(), stops=(), links=())), nodes)
            x, L = np.minimum(assembly.nodes, nodes[-1]), self.problem.line.length
            values = np.stack([coordinates @ other.shapes(x, 0).T, L * (coordinates @ other.shapes(x, 1).T)], axis=2)
            coordinates = values.reshape(2, -1)
        full = assembly.full(coordinates[:, assembly.free])
        return self._settled(SectionPoint(point.state, full, assembly.nodes))

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """March and carry all deviations along. See `lapjoint.orbits.Tangent.linearised`."""
        model, y = self.model, self.modal(start)
        motion = march(model, start.state, y, 0.0, half_periods * self.period / 2, record=False)
        n, S, back = y.size // 2, model.transfer(FREE, start.state), model.transfer(motion.state, FREE)
        into = np.zeros((2 * n, 2 * n))
        into[:n, :n] = into[n:, n:] = S
        whole = Carried(model, motion, into)

        def derivative() -> Derivative:
            columns, rest = whole.combinations
            columns = np.concatenate([back @ columns[:n], back @ columns[n:]])
            return Derivative(columns) if rest is None else Derivative(columns @ rest, (columns, rest))

        return Linearised(
            section_point(self.model, motion.state, motion.y),
            derivative,
            lambda: whole.segments,
            lambda: Carried(model, motion, into[:, :0]).segments,
        )

    @in_one_thread
    def followed(self, start: SectionPoint, deviation: FloatArray, periods: int) -> Followed:
        """March and carry one deviation along. See `lapjoint.orbits.Follows.followed`."""
        model, point, points, growth = self.model, start, [], np.zeros(periods)
        impulses, switches = np.zeros((periods, len(self.problem.structure.stops))), 0
        for i in range(periods):
            motion = march(model, point.state, self.modal(point), 0.0, self.period, peaks=False)
            there = (deviation.reshape(2, -1) @ model.transfer(FREE, point.state).T).reshape(-1, 1)
            for part in _in_parts(motion):
                there = Carried(model, part, there).end
                largest = float(np.max(np.abs(there)))
                if largest > LEAST_GROWTH:
                    there, growth[i] = there / largest, growth[i] + math.log(largest)
            deviation = (there.reshape(2, -1) @ model.transfer(motion.state, FREE).T).ravel()
            size, deviation = rescaled(deviation, self.norm)
            growth[i] += math.log(size)
            point = section_point(self.model, motion.state, motion.y)
            impulses[i] = motion.impulses
            switches += motion.switches
            points.append(point)
        return Followed(tuple(points), impulses, switches, growth, deviation)

    def static_shapes(self, origin: SectionPoint, places: FloatArray) -> StaticShapes:
        """Static shapes of unit forces. See `lapjoint.orbits.displaced.DisplacedStarts.static_shapes`."""
        assembly = self.model.assembly
        rows = np.array([assembly.reading(float(x)) for x in places])
        bent = np.linalg.solve(assembly.stiffness(FREE), rows.T)
        shapes = bent.T @ self.model.weighted(FREE)
        still = np.zeros_like(shapes)
        both = np.concatenate([shapes, still], axis=1), np.concatenate([still, shapes], axis=1)
        return StaticShapes(*both, rows @ bent)

    def energy(self, origin: SectionPoint) -> FloatArray:
        """Energy of deviations. See `lapjoint.orbits.displaced.DisplacedStarts.energy`."""
        omega = self.model.system(FREE).omega
        return np.diag(np.concatenate([omega**2, np.ones_like(omega)]))

    def modal(self, point: SectionPoint) -> FloatArray:
        """(q, q') of a section point on this mesh. See `fe_lapjoint.march.section_points.coordinates_of`."""
        return coordinates_of(self.model, point)

    def _free_modes(self, coordinates: FloatArray) -> FloatArray:
        """(q, q') in the modes of the joint without contact, from free degrees of freedom ``(2, n)``."""
        return (coordinates @ self.model.weighted(FREE)).ravel()

    def _settled(self, point: SectionPoint) -> SectionPoint:
        """The section point with the contact state that its displacements imply."""
        model, assembly = self.model, self.model.assembly
        z = assembly.stop_rows @ point.coordinates[0, assembly.free]
        base = [model.undamped(point.state).seen_motion(np.zeros(1), dt)[:, 0] for dt in (0, 1)]
        depth = model.sign * (z + base[0]) - model.gap
        free = np.abs(point.coordinates[0, assembly.free])
        unclear = np.abs(depth) <= _TOUCHING * (np.abs(model.gap) + np.abs(assembly.stop_rows) @ free)
        closed = [k for k in range(depth.size) if (k in point.state if unclear[k] else depth[k] > 0)]
        released = []
        rate = assembly.stop_rows @ point.coordinates[1, assembly.free] + base[1]
        for k in model.damped:
            stop = self.problem.structure.stops[k]
            pull = -(depth[k] + stop.damping / stop.stiffness * stop.sign * rate[k])
            near = _TOUCHING * abs(stop.gap)
            if not stop.may_pull and pull > (-near if k in point.state.released else near):
                released.append(k)
        return SectionPoint(ContactState(tuple(closed), tuple(released)), point.coordinates, point.nodes)


def _in_parts(motion: March) -> Iterator[March]:
    """A march in parts of so few pieces that no deviation grows beyond double precision in one of them."""
    for first in range(0, len(motion.pieces), _FEW):
        pieces, following = motion.pieces[first : first + _FEW], motion.pieces[first + _FEW : first + _FEW + 1]
        state, y = (following[0].state, following[0].y) if following else (motion.state, motion.y)
        yield replace(motion, pieces=pieces, state=state, y=y)


def _between(motion: History, start: float, end: float) -> History:
    """A motion whose ends are moved, by a rounding error, to `start` and `end`, with the contacts that are open
    there."""
    contacts = tuple(
        replace(c, start=start if c.open_start else c.start, end=end if c.open_end else c.end) for c in motion.contacts
    )
    return replace(motion, start=start, end=end, contacts=contacts)
