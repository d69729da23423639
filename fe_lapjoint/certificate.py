"""From what a search found to the `SteadyState` that everybody reads."""

from __future__ import annotations

import math

import numpy as np

from fe_lapjoint.march.field import history_of
from fe_lapjoint.march.march import March, march
from fe_lapjoint.march.model import Model
from fe_lapjoint.newton import Orbit
from fe_lapjoint.steady import Found
from fe_lapjoint.turns import Point, Turns
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.steady_state import Section, SteadyState, periodic_outcome, steady_impulses
from lapjoint.problem import FloatArray

_MIRRORED = 1e-6  # relative distance within which half a period mirrors a motion


def section(model: Model, point: Point) -> Section:
    """A point as displacements and velocities of the free degrees of freedom, which every problem on a mesh shares."""
    return Section(point.state, point.y.reshape(2, -1) @ model.system(point.state).vectors.T)


def read_section(model: Model, given: Section) -> Point:
    """The point that `section` was made from, in the modes of the same stops on this model's mesh."""
    known = [k for k in given.state.closed if k < len(model.problem.stops)]
    state = ContactState(tuple(known))
    return Point(state, (given.coordinates @ model.assembly.mass @ model.system(state).vectors).ravel())


def certificate(name: str, turns: Turns, found: Found, max_order: int) -> SteadyState:
    """March once over what was found, with contacts, and say what it is."""
    orbit, model = found.orbit, turns.model
    point = found.last if orbit is None else orbit.point
    order = 0 if orbit is None else order_of(turns, orbit)
    periods = order or max_order
    motion = march(model, point.state, point.y, 0.0, periods * 2 * math.pi / turns.omega)
    end = turns.seen_from(point.state, Point(motion.state, motion.y))
    history = history_of(name, model, motion)
    return SteadyState(
        problem=model.problem,
        solver=name,
        outcome=periodic_outcome(history) if orbit else found.outcome,
        order=order,
        symmetric=orbit is not None and is_symmetric(turns, order, motion),
        residual=turns.size(end - point.y) / max(turns.size(point.y), np.finfo(float).tiny),
        multipliers=np.zeros(0) if orbit is None else multipliers(turns, orbit),
        exponent=found.exponent,
        section=section(model, point),
        history=history,
        impulses=steady_impulses(history, periods),
    )


def order_of(turns: Turns, orbit: Orbit) -> int:
    """Excitation periods after which an orbit repeats."""
    return orbit.turns if orbit.turns % turns.per_period else orbit.turns // turns.per_period


def multipliers(turns: Turns, orbit: Orbit) -> FloatArray:
    """Moduli of the whole period: an odd number of half periods makes half of it."""
    return orbit.moduli**2 if orbit.turns % turns.per_period else orbit.moduli


def is_symmetric(turns: Turns, order: int, motion: March) -> bool:
    """Whether half the period mirrors a periodic motion: that of a mirror image, or one without contacts."""
    if order % 2 == 0 or (turns.twins is None and motion.contacts):
        return False
    start, half = motion.pieces[0], order * math.pi / turns.omega
    piece = next(piece for piece in motion.pieces if piece.end >= half)
    at = np.array([half])
    there = np.concatenate([piece.coordinates(at, derivative)[:, 0] for derivative in (0, 1)])
    sum_ = start.y + turns.seen_from(start.state, Point(piece.state, there))
    return turns.size(sum_) <= _MIRRORED * turns.size(start.y)
