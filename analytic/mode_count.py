"""How many modes are enough: a criterion, evaluated for the problem at hand.

With the residual of `analytic.modes.static_residual` the modes i > N follow the loads quasi-statically.  The remaining
error is the neglect of their inertia.  As a fraction of the force of a closed stop of stiffness k it is

    e_N = k sum_{i > N} Phi_i(x_stop)^2 / omega_i^2 . (omega_c / omega_N)^2

The first factor is the part of the left-out modes in the compliance at the stop, times k.  The second factor is the
neglected inertia at the fastest frequency omega_c that drives the contact, the largest of three frequencies:
the excitation's frequency (the usual rate of a record), the lowest elastic frequency with the stops closed, and the
frequency of the contact itself.  A beam that meets a stop with the speed v takes the modal speeds k Phi_i v / omega_i^2
from it.  The modes left out of the contact lack the force k^2 v sum Phi_i^2 sin(omega_i t) / omega_i^3.  The impulse of
this force, divided by the impulse of the impact, is e_N with

    omega_c^2 = 4 k c / M,

as Phi^2 is at most 4 / M, M being the beam's mass.  Of a beam with steps it is, for fast modes, M = m^(3/4) EI^(1/4)
times the integral of (m / EI)^(1/4), with m and EI at the stop; a mass at the stop makes Phi smaller.  Hence e_N falls
as k^2 N^-7.  The factor c is above 1, because the error of one impact is carried into the next impacts: c is 3.
Without a modal damping ratio, which damps the left-out modes before the next contact, c is twice as large.  Between two
opposite stops whose room is a small part of the base's motion Y the beam is pressed rather than thrown against a stop.
There c is the ratio of the two impulses, 2 sqrt(g / Y), with half the room for g, if the ratio is below 3.  Both
constants are measured, on random joints of one to four stops anywhere, 1 to 1e7 EI / L^3 stiff, against twice as many
modes: docs/theory.md has the table.

A load that is present at t = 0 excites every mode, and inertia does not help: the left-out modes start from their
equilibrium here, although in truth they are at rest.  For a step load the compliance of the left-out modes at the load,
sum_{i > N} Phi_i^2 / omega_i^2 divided by the sum over all modes, has to be small by itself.  For the inertia of a base
that starts with an acceleration, the part of the left-out modes in the largest deflection has to be small.  A sine or a
record counts with its size at t = 0 divided by its largest size.  A stop that presses the straight beam is such a load,
too, where the motion begins with the straight beam.

An initial state other than the straight beam at rest also requires that the modes hold all but a thousandth of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from analytic.march.initial_state import initial_coordinates
from analytic.march.loads import MOVED_STOPS, acting
from analytic.march.modal_state import LoadedStructure, loaded_structure
from analytic.modes.normal_modes import NormalModes, exact_modes
from lapjoint.answers.contact_state import FREE, ContactState, closed_together, places
from lapjoint.problem import AtEquilibrium, AtRest, FloatArray, ModalDamping, Problem
from lapjoint.problem.load_shape import LoadShape
from lapjoint.problem.structure import Structure
from lapjoint.problem.supports_and_stops import PlacedStop, readings

LEAST, MOST = 10, 320
"""Least and most number of modes that the criterion chooses; beyond the most, the error may exceed the tolerance."""
_IMPACTS, _RINGING = 3.0, 2.0
"""c of free impacts, and the factor on c where the left-out modes still ring at the next impact; see the module's
head."""
_DAMPED = 1e-3  # modal damping ratio from which they do not ring on: the least of the problems measured
_POSITIONS = 33  # positions along the beam at which the deflection under a uniform load is looked at
_SHAPE_REMAINDER = 1e-3
"""Largest part of an initial shape that the modes may leave out, as a fraction of the norm of its coordinates."""


def default_count(problem: Problem, tolerance: float) -> int:
    """The least number of modes, from `LEAST` to `MOST`, for which e_N is at most `tolerance`.

    e_N counts in the free state and in the state with most stops closed.
    """
    pool, criterion = 40, _criterion(problem)
    while True:
        enough = _enough(criterion, tolerance, pool)
        if 2 * enough <= pool or pool >= 2 * MOST:
            return min(enough, MOST)
        pool *= 2


def truncation_error(problem: Problem, pool: int) -> FloatArray:
    """e_N for N = 1 ... pool - 1, ``(pool - 1,)``, with sums cut at `pool` modes: the larger of the values in both
    states."""
    return _error(_criterion(problem), pool)


def most_closed(problem: Problem) -> ContactState:
    """The contact state with the stiffest of the sets of stops that can be closed together at every place.

    Of equally stiff sets the one with more stops at the top is taken.
    """

    def stiffness(closed: tuple[int, ...]) -> tuple[float, int]:
        stops = [problem.structure.stops[i] for i in closed]
        return sum(stop.stiffness for stop in stops), sum(stop.sign for stop in stops)

    stiffest = [max(closed_together(problem, here), key=stiffness) for here in places(problem)]
    return ContactState(tuple(i for closed in stiffest for i in closed))


@dataclass(frozen=True)
class _Criterion:
    """The problem as the criterion needs it, for any number of modes at which its sums are cut."""

    problem: Problem
    loaded: LoadedStructure
    fastest: float
    """The highest frequency of the loads, rad/s; 0 without any."""
    contact_squares: tuple[float, ...]
    """omega_c^2 of each stop's own contacts, (rad/s)^2."""
    sudden: tuple[tuple[LoadShape, float, float], ...]
    """Loads that are already there at t = 0: their shape; their lowest frequency, rad/s; and their size at t = 0
    divided by the largest size that all loads of this shape can have."""


def _criterion(problem: Problem) -> _Criterion:
    damping = problem.damping
    damped = isinstance(damping, ModalDamping) and bool(damping.ratios(MOST + 1)[-1] >= _DAMPED)
    return _Criterion(
        problem=problem,
        loaded=loaded_structure(problem),
        fastest=max([problem.forces.usual_rate, *(force.angular_frequency for force in problem.forces.harmonic)]),
        contact_squares=tuple(
            _contact_square(problem, stop, 1.0 if damped else _RINGING) for stop in problem.structure.stops
        ),
        sudden=_sudden(problem),
    )


def _sudden(problem: Problem) -> tuple[tuple[LoadShape, float, float], ...]:
    """See `_Criterion.sudden`."""
    forces, usual = problem.forces, problem.forces.usual_rate
    constant = [(f.shape, f.force) for f in forces.constant] + (
        _presses(problem) if isinstance(problem.initial, AtRest) else []
    )
    loads: list[tuple[LoadShape, float, float, float]] = [(shape, 0.0, f, abs(f)) for shape, f in constant]
    loads += [(f.shape, f.angular_frequency, float(f.at(np.zeros(1))[0]), abs(f.amplitude)) for f in forces.harmonic]
    loads += [(f.shape, usual, float(f.at(np.zeros(1))[0]), f.size) for f in forces.sampled]
    found = []
    loads = [load for load in loads if load[3] > 0]
    for place in dict.fromkeys(load[0] for load in loads):
        omegas, starts, sizes = zip(*(load[1:] for load in loads if load[0] == place), strict=True)
        if sum(starts):
            found.append((place, min(omegas), abs(sum(starts)) / sum(sizes)))
    return tuple(found)


def _presses(problem: Problem) -> list[tuple[LoadShape, float]]:
    """Where stops press the straight beam at t = 0, and their forces on it, N, positive upwards."""
    base, found = sum(wave.amplitude * math.sin(wave.phase) for wave in problem.moved_stops), []
    if problem.forces.seen is not None:
        base = float(problem.forces.seen.at(np.zeros(1))[0])
    for stop in problem.structure.stops:
        depth = stop.sign * base * stop.base_share - stop.gap
        if depth > 0:
            found.append((stop.shape, -stop.sign * stop.stiffness * depth))
    return found


def _contact_square(problem: Problem, stop: PlacedStop, ringing: float) -> float:
    """omega_c^2, (rad/s)^2, of the contacts of a stop, 4 k c / M of the module's head; `ringing` is the factor on c."""
    c, base = _IMPACTS, problem.base_motion
    stops = problem.structure.stops
    opposite = [other.gap for other in stops if other.side != stop.side and other.place == stop.place]
    waves = [] if base is None else [wave.amplitude for wave in base.waves if wave.amplitude]
    if opposite and len(waves) == 1 and not problem.point_loads and not stop.in_space:
        room = max(stop.gap + min(opposite), 0.0)  # none where the gaps overlap
        c = min(c, 2 * math.sqrt(room / 2 / waves[0]))
    return 4 * c * ringing * stop.stiffness / min(_mass_met(problem.structure, x) for x, _ in stop.reading)


@lru_cache(maxsize=256)
def _mass_met(structure: Structure, x: float) -> float:
    """M of the module's head at a position, m, kg: the least of both sides at a step."""
    pieces = structure.line.pieces
    waves = sum((piece.end - piece.start) * (piece.inertia / piece.EI) ** 0.25 for piece in pieces)
    here = [piece for piece in pieces if piece.start <= x <= piece.end]
    return float(min(piece.inertia**0.75 * piece.EI**0.25 for piece in here) * waves)


def _error(criterion: _Criterion, pool: int) -> FloatArray:
    """See `truncation_error`."""
    parts = _modal_sums(criterion.loaded, pool)
    driven = max(parts.elastic, criterion.fastest) ** 2
    error = np.asarray(driven * parts.loads)
    for x, omega, share in criterion.sudden:
        for start in parts.starts[x]:
            error = np.maximum(error, share * start.error(omega))
    for square, share in zip(criterion.contact_squares, parts.contacts, strict=True):
        error = np.maximum(error, max(driven, square) * share)
    return np.asarray(error)


@dataclass(frozen=True, eq=False)
class _SuddenAnswer:
    """The answer of a state's modes to a load of unit size that is there at once."""

    parts: FloatArray
    """Phi_i (Phi_i, p) at the load, or along the beam, kg^-1 or kg^-1 m, shape ``(pool, places)``."""
    square: FloatArray
    """omega_i^2, (rad/s)^2, shape ``(pool,)``."""
    left_out: FloatArray
    """Bound on the sum of all modes above each N, m for a unit load, shape ``(pool - 1,)``."""

    def error(self, omega: float) -> FloatArray:
        """Left-out modes' part of the largest deflection under a load of `omega`, rad/s, as a fraction, ``(pool -
        1,)``."""
        slowed = np.maximum(self.square, omega**2)  # inertia makes the answer of the modes below it smaller
        most = np.abs((1 / np.where(slowed > 0, slowed, np.inf)) @ self.parts).max()
        return np.asarray(self.left_out / (most + np.finfo(float).tiny))


@dataclass(frozen=True)
class _ModalSums:
    """The sums of the criterion apart from the excitation."""

    elastic: float
    """The lowest elastic frequency with the stops closed, rad/s."""
    contacts: FloatArray
    """e_N divided by omega_c^2, for each stop, s^2, shape ``(stops, pool - 1)``."""
    loads: FloatArray
    """e_N divided by the square of the fastest frequency of the response to the loads, s^2, shape ``(pool - 1,)``."""
    starts: dict[LoadShape, tuple[_SuddenAnswer, _SuddenAnswer]]
    """Answers of the two states to a load of each shape."""


@lru_cache(maxsize=32)
def _modal_sums(loaded: LoadedStructure, pool: int) -> _ModalSums:
    problem = loaded.problem
    both = [exact_modes(problem, state, pool) for state in dict.fromkeys((FREE, most_closed(problem)))]
    elastic, constant = both[-1].omega[both[-1].omega > 0], problem.forces.constant
    pressed = [stop.shape for stop in problem.structure.stops if stop.gap < 0 or stop.in_space]
    # Without stops the left-out modes still answer the loads; their share of a deflection is below one in N^4.
    least = np.arange(1, pool, dtype=float) ** -4
    return _ModalSums(
        elastic=float(elastic[0]),
        contacts=np.max([_over_square(modes, _shares(problem, modes)) for modes in both], axis=0),
        loads=np.max([_over_square(modes, least) for modes in both], axis=0),
        starts={
            x: (_sudden_answer(both[0], x), _sudden_answer(both[-1], x))
            for x in (*(f.shape for f in constant), *pressed, *loaded.positions)
            if x != MOVED_STOPS
        },
    )


def _shares(problem: Problem, modes: NormalModes) -> FloatArray:
    """k sum_{i > N} Phi_i^2 / omega_i^2 at each stop of stiffness k, without unit, in one state, ``(stops, modes -
    1)``."""
    omega = np.where(modes.omega > 0, modes.omega, np.inf)
    stiffness = np.array([stop.stiffness for stop in problem.structure.stops])
    x, seen = readings(problem.structure.stops)
    share = stiffness[:, None] * (seen @ modes.shapes(x).T) ** 2 / omega**2
    return np.asarray(share[:, ::-1].cumsum(axis=1)[:, ::-1][:, 1:])


def _over_square(modes: NormalModes, share: FloatArray) -> FloatArray:
    """Shares of left-out modes in a compliance, ``(..., modes - 1)``, divided by omega_N^2, s^2.

    They are infinite for rigid-body modes, which are never left out.
    """
    square = modes.omega[:-1] ** 2
    return np.asarray(np.divide(share, square, out=np.full(share.shape, np.inf), where=square > 0))


def _sudden_answer(modes: NormalModes, shape: LoadShape) -> _SuddenAnswer:
    """The answer of one state's modes to a load."""
    if shape.pieces:
        where = np.linspace(0.0, modes.shapes.nodes[-1], _POSITIONS)
    else:
        where = np.array([x for x, _ in shape.points])
    along = acting(LoadShape(pieces=shape.pieces), modes.shapes.nodes).modal(modes.shapes)[0]
    at_points = modes.shapes(np.array([x for x, _ in shape.points])) @ np.array([force for _, force in shape.points])
    parts = modes.shapes(where) * (along + at_points)[:, None]
    square = modes.omega**2
    tail = np.abs(parts / np.where(square > 0, square, np.inf)[:, None])[::-1].cumsum(axis=0)[::-1].max(axis=1)
    return _SuddenAnswer(parts, square, tail[1:])


def _enough(criterion: _Criterion, tolerance: float, pool: int) -> int:
    """The least number of modes by the sums over `pool` modes; `pool` itself if none is enough."""
    problem, error = criterion.problem, _error(criterion, pool)
    small = np.flatnonzero(error <= tolerance)
    count = max(LEAST, int(small[0]) + 1 if small.size else pool)
    if isinstance(problem.initial, AtRest | AtEquilibrium):
        return count
    return max(count, _shape_count(problem, pool))


def _shape_count(problem: Problem, pool: int) -> int:
    """The number of modes that hold enough of the initial shape."""
    q, v = initial_coordinates(problem, exact_modes(problem, FREE, pool))
    needed = 1
    for coordinates in (q, v):
        tail = np.sqrt((coordinates[::-1] ** 2).cumsum()[::-1])
        inside = np.flatnonzero(tail <= _SHAPE_REMAINDER * tail[0]) if tail[0] > 0 else np.zeros(1, dtype=int)
        needed = max(needed, int(inside[0]) if inside.size else pool)
    return needed
