r"""How small deviations travel along a motion: all of them, and one tangent vector alone.

A deviation dy travels within a state by the linear flow, and at a switch at time T, where h is the gap function that
vanishes and f- and f+ are the rates before and after,

    dy+ = S dy- + (S f- - f+) dT,    dT = -(dh/dy- dy-) / h'

with S the constant, lossless map between the modes of the two states.

The fast modes of a mesh die out, so that all deviations come to be combinations of a few: D = E R, where E has as many
columns as D has independent ones.  Only E is carried on.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
import numpy.typing as npt
from scipy.linalg import qr

from fe_lapjoint.march.coupled import Coupled, CoupledFlow
from fe_lapjoint.march.coupled_modes import acting
from fe_lapjoint.march.coupled_tangent import by_amplitudes, jumped
from fe_lapjoint.march.march import March, Piece
from fe_lapjoint.march.model import Model
from fe_lapjoint.march.propagator import free_response
from fe_lapjoint.march.system import ComplexArray, IndexArray, System
from lapjoint.answers.contact_state import ContactState
from lapjoint.orbits.segments import Segment
from lapjoint.problem import FloatArray

Array = TypeVar("Array", FloatArray, ComplexArray)
DEAD = 40.0
"""Decay time constants after which a mode has died out: exp(-40) is below the rounding of the other modes."""
_ALIVE = 0.75
"""Unit vectors replace the carried columns where the nonzero coordinates number at most this fraction of the
columns."""
_FEW = 0.5
"""Columns are reduced to independent ones where the coordinates alive since the start number at most this fraction of
them."""
_DEPENDENT = 1e-17
"""A column that adds at most this fraction of the largest addition to the columns before it depends on them; rounding
makes errors of 1e-16."""


@dataclass(frozen=True)
class Carried:
    """Deviations from the start of a march, carried along it."""

    model: Model
    """The problem on a mesh."""
    motion: March
    """A march by the exact method."""
    deviations: FloatArray
    """(dq, dq') at the start as columns, kg^1/2 m and kg^1/2 m/s, in the modes of the first state, ``(2 n, m)``."""

    @cached_property
    def combinations(self) -> tuple[FloatArray, FloatArray | None]:
        """Columns ``(2 n, r)`` at the end of the march, and the combinations ``(r, m)`` that give the deviations.

        The combinations are None where each deviation is a column.  The columns are in the modes of the last state.
        """
        return self._steps[-1].columns, self._steps[-1].rest

    @property
    def end(self) -> FloatArray:
        """The deviations at the end of the march, shape ``(2 n, m)``."""
        columns, rest = self.combinations
        return columns if rest is None else columns @ rest

    @property
    def segments(self) -> tuple[Segment, ...]:
        """The march as sums of exponentials with all deviations from it, a segment for each window.

        A window ends at a switch at the latest.
        """
        steps = zip(self.motion.pieces, self._steps[:-1], strict=True)
        return tuple(_segment(self.model, piece, here) for piece, here in steps)

    @cached_property
    def _steps(self) -> tuple[_Deviations, ...]:
        """The deviations at the start of each piece, followed by the deviations after the last piece and its switch."""
        start = since = self.motion.pieces[0].start
        slow = 2 * math.pi / (self.motion.pieces[-1].end - start)
        q, v = (np.linalg.norm(part, axis=0) for part in np.split(self.deviations, 2))
        there = _Deviations(self.deviations, np.hypot(slow * q, v))
        if not q.size:
            within = (there.within(self.model.system(piece.state)) for piece in self.motion.pieces)
            return (*within, there)
        steps, expected = [], q.size
        for piece, following in zip(self.motion.pieces, (*self.motion.pieces[1:], None), strict=True):
            system, few = self.model.system(piece.state), there.columns.shape[1]
            there = there.within(system)
            steps.append(there)
            there, count = there.flown(system, piece.end - piece.start, piece.end - since)
            left = _outlasting(system, piece.end - start)
            if 0 < there.columns.shape[1] == few and left <= _FEW * min(few, expected) and there.rest is not None:
                there, expected = there.of_independent(system, slow), left
            if piece.switched >= 0:
                since, after = piece.end, self.motion.y if following is None else following.y
                there = there.jumped(self.model, piece, after, count)
        return (*steps, there.within(None))


@dataclass(frozen=True)
class _Deviations:
    """``m`` deviations as combinations of ``r`` columns."""

    columns: FloatArray
    """(dq, dq'), kg^1/2 m and kg^1/2 m/s, shape ``(2 n, r)``; or amplitudes, ``(2 T, r)``, without last rows of
    zeros."""
    sizes: FloatArray
    """Size of the motion that each column came from, shape ``(r,)``."""
    rest: FloatArray | None = None
    """The combinations as columns, shape ``(r, m)``; None where each is a column."""
    state: Coupled | None = None
    """The state whose amplitudes the columns are; None where they are (dq, dq')."""
    units: bool = False
    """Whether the columns are unit vectors of the first amplitudes."""

    def within(self, system: System | None) -> _Deviations:
        """The deviations in the coordinates of a state, or as (dq, dq')."""
        columns, state = self.columns, system if system is not None and by_amplitudes(system) else None
        if state is self.state:
            return self
        if self.state is not None:
            columns = self.state.free.real_motion[: columns.shape[0]].T @ columns
        if state is not None:
            columns = state.free.real_back.T @ columns
        return replace(self, columns=columns, state=state, units=False)

    def flown(self, system: System, s: float, since: float) -> tuple[_Deviations, int]:
        """The deviations after `s` seconds in one state, which is `since` seconds old by then, as combinations of what
        is alive if that is less than they are; and the number of the lowest modes beyond which all are zero."""
        few = self.columns.shape[1]
        if self.state is not None:
            count = min(self.state.free.outlasting(since, DEAD), self.columns.shape[0] // 2)
            own = self.state.turned(s, self.columns[: 2 * count])
            if not 0 < 2 * count <= _ALIVE * few:
                return replace(self, columns=own, units=False), system.omega.size
            made = own if self.rest is None else own @ self.rest
            return _Deviations(np.eye(2 * count), np.ones(2 * count), made, self.state, True), system.omega.size
        if isinstance(system, Coupled):
            return replace(self, columns=system.flown(s, self.columns)), system.omega.size
        modes = np.flatnonzero(system.slowest_decay * since < DEAD)
        count = int(modes[-1]) + 1 if modes.size else 0
        flown = replace(self, columns=_flow(system, s, self.columns, count))
        if 0 < 2 * modes.size <= _ALIVE * few:
            flown = flown.of_alive(np.concatenate([modes, modes + system.omega.size]))
        return flown, count

    def jumped(self, model: Model, piece: Piece, after: FloatArray, count: int) -> _Deviations:
        """The deviations after the switch that ends a piece, before which `count` modes move; ``after`` is (q, q')."""
        new = model.system(model.after(piece.state, piece.switched))
        if self.state is None and not by_amplitudes(new):
            return replace(self, columns=_jump(model, piece, after, self.columns, count))
        columns = jumped(model, piece, after, self.columns, self.units)
        return replace(self, columns=columns, state=new if by_amplitudes(new) else None, units=False)

    def of_alive(self, alive: IndexArray) -> _Deviations:
        """The deviations as combinations of the unit vectors of the coordinates that are not zero."""
        units = np.zeros((self.columns.shape[0], alive.size))
        units[alive, np.arange(alive.size)] = 1.0
        own = self.columns[alive]
        return _Deviations(units, np.ones(alive.size), own if self.rest is None else own @ self.rest)

    def of_independent(self, system: System, slow: float) -> _Deviations:
        """The deviations as combinations of independent columns, by a factorisation with pivots.

        The columns are compared by energy, so that the displacements of all modes have equal weight; `slow`, rad/s, is
        the frequency that stands for lower ones, so that a rigid-body motion counts.  Amplitudes are in this measure.
        """
        weights = np.concatenate([np.maximum(system.omega, slow), np.ones(system.omega.size)])
        if self.state is not None:
            weights = np.ones(self.columns.shape[0])
        own = self.columns * weights[:, None] / self.sizes
        Q, R, order = qr(own, mode="economic", pivoting=True, overwrite_a=True, check_finite=False)
        added = np.abs(np.diag(R))
        count = int(np.count_nonzero(added > _DEPENDENT * added[0]))
        made = np.empty((count, order.size))
        made[:, order] = R[:count]
        made *= self.sizes
        columns = np.ascontiguousarray(Q[:, :count] / weights[:, None])
        return _Deviations(columns, np.ones(count), made if self.rest is None else made @ self.rest, self.state)


def _segment(model: Model, piece: Piece, here: _Deviations) -> Segment:
    """A piece as a sum of exponentials, and the deviations at its start as sums of these exponentials."""
    assert piece.flow is not None
    system, flow = model.system(piece.state), piece.flow
    if isinstance(system, Coupled):
        return _coupled_segment(model, system, piece, here)
    q, v = np.split(here.columns, 2)
    free_q, free_v = (part[:, None] for part in flow.free)
    rates, modes = system.exponentials
    both = np.concatenate([q, free_q], axis=1), np.concatenate([v, free_v], axis=1)
    terms, drift = system.amplitudes_of(*both)
    loads = -1j * np.exp(1j * (system.driven * piece.start + system.phase))
    polynomial = system.polynomial.copy()
    polynomial[:, :2] += drift[:, :, -1]
    deviations, drift = terms[:, :-1], drift[:, :, :-1]
    if here.rest is not None:
        deviations, drift = deviations @ here.rest, drift @ here.rest
    weights = np.concatenate([system.stops[:, modes].astype(complex), system.stop_amplitudes], axis=1)
    return Segment(
        start=piece.start,
        end=piece.end,
        closed=closed_rows(model, piece.state),
        rates=np.concatenate([rates, 1j * system.driven]),
        weights=_with_forces(model, weights),
        amplitudes=np.concatenate([terms[:, -1], loads]),
        polynomial=_with_forces(model, polynomial),
        deviations=deviations,
        drift=_with_forces(model, drift),
        switched=piece.switched,
    )


def closed_rows(model: Model, state: ContactState) -> npt.NDArray[np.bool_]:
    """Whether each stop is closed, and then whether the force of each damped stop acts, shape ``(P + D,)``."""
    presses = acting(state)
    return np.array([*(k in state for k in range(model.sign.size)), *(k in presses for k in model.damped)], dtype=bool)


def _with_forces(model: Model, values: Array) -> Array:
    """Values of the stops along the first axis, and zeros for the forces of damped stops, all of which are open."""
    if not model.damped:
        return values
    return np.concatenate([values, np.zeros((len(model.damped), *values.shape[1:]), dtype=values.dtype)])


def _coupled_segment(model: Model, system: Coupled, piece: Piece, here: _Deviations) -> Segment:
    """`_segment` of a piece in which damped stops are closed."""
    flow = piece.flow
    assert isinstance(flow, CoupledFlow)
    columns = here.columns if here.rest is None else here.columns @ here.rest
    if here.state is None:
        deviations = system.free.back @ columns
    else:
        deviations = np.zeros((system.free.rates.size, columns.shape[1]), dtype=complex)
        deviations[: columns.shape[0] // 2] = columns[::2] + 1j * columns[1::2]
    (places, delay, weights), still = system.gap_rows, flow.polynomial
    polynomial, drift = places @ still, np.zeros((delay.size, 2, columns.shape[1]))
    polynomial[:, :2] += delay * (places @ (still[:, 1:] * [1.0, 2.0]))
    if system.free.rest is not None:
        place, speed = system.free.rest @ columns
        drift[:, 0], drift[:, 1] = places @ place + delay * (places @ speed), places @ speed
    return Segment(
        start=piece.start,
        end=piece.end,
        closed=closed_rows(model, piece.state),
        rates=system.rates_of_terms[:-1],
        weights=weights,
        amplitudes=flow.amplitudes,
        polynomial=polynomial,
        deviations=deviations,
        drift=drift,
        switched=piece.switched,
    )


def _outlasting(system: System, s: float) -> int:
    """How many independent deviations from a motion in one state are alive after `s` seconds, or are about to be."""
    if isinstance(system, Coupled):
        return 2 * (system.free.outlasting(s, DEAD) + int(np.count_nonzero(system.omega == 0)))
    return 2 * int(np.count_nonzero(system.slowest_decay * s < DEAD))


def _flow(system: System, s: float, deviations: FloatArray, count: int) -> FloatArray:
    """Deviations ``(2 n, m)`` after `s` seconds within one state, of the first `count` modes; the others are zero."""
    C, S = responses(system, s, count)
    a, n = system.damping_rate[:count, None], system.omega.size
    q, v = deviations[:count], deviations[n : n + count]
    flown = np.zeros_like(deviations)
    flown[:count] = C * q + S * v
    flown[n : n + count] = (C - 2 * a * S) * v - (system.omega[:count] ** 2)[:, None] * (S * q)
    return flown


def responses(system: System, s: float, count: int) -> tuple[FloatArray, FloatArray]:
    """C and S of `free_response` after `s` seconds of either sign, for the `count` lowest modes, ``(count, 1)``."""
    a = system.damping_rate[:count, None]
    if not system.all_oscillate:
        return free_response(system.damping_rate[:count], system.omega[:count], np.array([s]))
    wave = np.exp(system.roots[:count] * s)[:, None]
    S = wave.imag / system.roots.imag[:count, None]
    return wave.real + a * S, S


def _jump(model: Model, piece: Piece, after: FloatArray, columns: FloatArray, count: int) -> FloatArray:
    """Columns ``(2 n, r)`` after the switch that ends a piece; ``after`` is (q, q') in the next state's modes.

    The columns before the switch hold the first `count` modes alone.
    """
    state, n = piece.state, after.size // 2
    following = model.after(state, piece.switched)
    old, new, S = model.system(state), model.system(following), model.transfer(state, following)

    def mapped(vectors: FloatArray, count: int) -> FloatArray:
        return np.concatenate([S[:, :count] @ vectors[:count], S[:, :count] @ vectors[n : n + count]])

    y = (after.reshape(2, -1) @ S).ravel()  # S is orthogonal
    rates, at = old.rates(piece.end, y), np.array([piece.end])
    change = mapped(rates, n) - new.rates(piece.end, after)
    if piece.switched < model.sign.size:
        row = old.stops[piece.switched]
        delay = -(row @ columns[:n]) / (row @ y[n:] + old.seen_motion(at, 1)[piece.switched, 0])
    else:  # a force ends or begins where z + (c / k) z' is at the gap
        k = model.damped[piece.switched - model.sign.size]
        lag = model.problem.structure.stops[k].damping / model.stiffness[k]
        row = np.concatenate([old.stops[k], lag * old.stops[k]])
        seen = old.seen_motion(at, 1)[k, 0] + lag * old.seen_motion(at, 2)[k, 0]
        delay = -(row @ columns) / (row @ rates + seen)
    return np.asarray(np.multiply.outer(change, delay) + mapped(columns, count))
