r"""How small deviations travel along a motion: the monodromy matrix, and one tangent vector alone.

A deviation dy travels within a state by the linear flow, and at a switch at time T, where h is the gap function that
vanishes and f- and f+ are the rates before and after,

    dy+ = S dy- + (S f- - f+) dT,    dT = -(dh/dy- dy-) / h'

with S the constant, lossless map between the modes of the two states.

The derivative of a march by a number of its excitation is one deviation more.  Within a state it is a free motion
beyond the change of the forced motion Im sum_h A_h exp(i (w_h t + phase_h)),

    Im sum_h (dA_h + i t dw_h A_h) exp(i (w_h t + phase_h)),

and at the end, whose time may depend on the number, the march goes on by its rates.  Gaps and S do not depend on it.

The fast modes of a mesh die out, so that all deviations come to be combinations of a few: D = E R, with as many
columns of E as of D are independent.  Only what becomes of E is carried on.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import qr

from fe_lapjoint.march.march import March, Piece
from fe_lapjoint.march.model import Model
from fe_lapjoint.march.propagator import free_response
from fe_lapjoint.march.system import IndexArray, System
from lapjoint.orbits.parameters import ExcitationChange
from lapjoint.orbits.segments import MadeSegments, Segment, SegmentChange
from lapjoint.problem import FloatArray

DEAD = 40.0
"""Decay time constants after which a mode has died out: exp(-40) is below the rounding of all else."""
_ALIVE = 0.75
"""Share of the columns that are carried, up to which units of the coordinates that are not zero are carried instead."""
_FEW = 0.5
"""The same of the modes that are left since the start, for combinations that do not depend on each other."""
_DEPENDENT = 1e-17
"""What a column adds to those before, over the largest, up to which it depends on them: it rounds by 1e-16."""


def monodromy(model: Model, motion: March) -> FloatArray:
    """Derivative of the end of a march by its start, each in the modes of its contact state.

    Parameters
    ----------
    model : Model
        The problem on a mesh.
    motion : March
        A march by the exact method.

    Returns
    -------
    FloatArray, shape (2 n, 2 n)
        d(q, q') / d(q, q').
    """
    return Carried(model, motion, np.eye(motion.pieces[0].y.size)).end


@dataclass(frozen=True)
class Carried:
    """Deviations from the start of a march, carried along it."""

    model: Model
    """The problem on a mesh."""
    motion: March
    """A march by the exact method."""
    deviations: FloatArray
    """(dq, dq') at the start as columns, kg^1/2 m and kg^1/2 m/s, in the modes of the first state, ``(2 n, m)``."""
    change: ExcitationChange | None = None
    """How the excitation changes with a number; the last deviation is then over its unit, and zero at the start."""

    @cached_property
    def combinations(self) -> tuple[FloatArray, FloatArray | None]:
        """The same at the end, in the modes of the last state.

        As columns, ``(2 n, r)``, of which the first are combined to all deviations but the one by a number, which is
        the last; and the combinations, ``(r, m)`` without it.  None where each deviation is a column.
        """
        there = self._steps[-1]
        columns = there.columns
        if self.change is not None:
            end, columns = self.motion.pieces[-1].end, columns.copy()
            rates = self.model.system(self.motion.state).rates(end, self.motion.y)
            columns[:, -1] -= self.change.frequency * end * rates
        return columns, there.rest

    @property
    def end(self) -> FloatArray:
        """The same, shape ``(2 n, m)``."""
        columns, rest = self.combinations
        if rest is None:
            return columns
        count = rest.shape[0]
        return np.concatenate([columns[:, :count] @ rest, columns[:, count:]], axis=1)

    @property
    def segments(self) -> MadeSegments:
        """The march as the sums of exponentials that its pieces are, and all deviations from it.

        From window to window; a window ends at a switch at the latest.
        """
        pieces = self.motion.pieces
        start, end = (np.array([getattr(piece, name) for piece in pieces]) for name in ("start", "end"))
        return MadeSegments(start, end, self._segment)

    def _segment(self, i: int) -> Segment:
        """One of them."""
        piece, here = self.motion.pieces[i], self._steps[i]
        if self.change is None:
            one = _segment(self.model, piece, here.columns)
        else:
            one = _segment_with_change(self.model, piece, here.columns, self.change)
        if here.rest is None:
            return one
        return one._replace(deviations=one.deviations @ here.rest, drift=one.drift @ here.rest)

    @cached_property
    def _steps(self) -> tuple[_Deviations, ...]:
        """The deviations at the start of each piece, and those at the end of the last, after its switch."""
        start = since = self.motion.pieces[0].start
        slow = 2 * math.pi / (self.motion.pieces[-1].end - start)
        few = self.deviations.shape[1] - int(self.change is not None)
        q, v = (np.linalg.norm(part, axis=0) for part in np.split(self.deviations[:, :few], 2))
        there = _Deviations(self.deviations, few, np.hypot(slow * q, v))
        steps, expected = [there], few
        for piece, following in zip(self.motion.pieces, (*self.motion.pieces[1:], None), strict=True):
            system = self.model.system(piece.state)
            modes = np.flatnonzero(system.slowest_decay * (piece.end - since) < DEAD)
            alive, count = np.concatenate([modes, modes + system.omega.size]), int(modes[-1]) + 1 if modes.size else 0
            there = replace(there, columns=_along(system, piece, there.columns, self.change, count))
            left = 2 * np.count_nonzero(system.slowest_decay * (piece.end - start) < DEAD)
            if 0 < alive.size <= _ALIVE * there.few:
                there = there.of_alive(alive)
            elif there.few and left <= _FEW * min(there.few, expected) and there.rest is not None:
                there, expected = there.of_independent(system, slow), left
            if piece.switched >= 0:
                since, after = piece.end, self.motion.y if following is None else following.y
                there = replace(there, columns=_jump(self.model, piece, after, there, count))
            steps.append(there)
        return tuple(steps)


@dataclass(frozen=True)
class _Deviations:
    """``m`` deviations, of which the first `few` are combinations of as many columns, and the others are themselves."""

    columns: FloatArray
    """(dq, dq'), kg^1/2 m and kg^1/2 m/s, shape ``(2 n, r)``."""
    few: int
    """How many of the columns the first deviations are combinations of."""
    sizes: FloatArray
    """Size of what each of these came from, shape ``(few,)``."""
    rest: FloatArray | None = None
    """The combinations as columns, shape ``(few, m - r + few)``; None where each is a column."""

    def of_alive(self, alive: IndexArray) -> _Deviations:
        """The same as combinations of units of the coordinates that are not zero."""
        units = np.zeros((self.columns.shape[0], alive.size))
        units[alive, np.arange(alive.size)] = 1.0
        own = self.columns[alive, : self.few]
        columns = np.concatenate([units, self.columns[:, self.few :]], axis=1)
        return _Deviations(columns, alive.size, np.ones(alive.size), own if self.rest is None else own @ self.rest)

    def of_independent(self, system: System, slow: float) -> _Deviations:
        """The same as combinations of columns that do not depend on each other, by a factorisation with pivots.

        What they add is compared by energy, so that the displacements of all modes count alike; `slow` is the lowest
        frequency, rad/s, at which a rigid-body motion counts.
        """
        weights = np.concatenate([np.maximum(system.omega, slow), np.ones(system.omega.size)])
        own = self.columns[:, : self.few] * weights[:, None] / self.sizes
        Q, R, order = qr(own, mode="economic", pivoting=True, overwrite_a=True, check_finite=False)
        added = np.abs(np.diag(R))
        count = int(np.count_nonzero(added > _DEPENDENT * added[0]))
        made = np.empty((count, self.few))
        made[:, order] = R[:count]
        made *= self.sizes
        columns = np.concatenate([Q[:, :count] / weights[:, None], self.columns[:, self.few :]], axis=1)
        return _Deviations(columns, count, np.ones(count), made if self.rest is None else made @ self.rest)


def _along(
    system: System, piece: Piece, deviations: FloatArray, change: ExcitationChange | None, count: int
) -> FloatArray:
    """Deviations ``(2 n, m)`` at the end of a piece, before its switch; modes but the first `count` have died out."""
    if change is None:
        return _flow(system, piece.end - piece.start, deviations, count)
    free = deviations.copy()
    free[:, -1] -= _forced_change(system, piece.start, change)
    free = _flow(system, piece.end - piece.start, free, count)
    free[:, -1] += _forced_change(system, piece.end, change)
    return free


def _forced_change(system: System, t: float, change: ExcitationChange) -> FloatArray:
    """How the forced motion (q, q') at a time changes with a number, ``(2 n,)``."""
    turn, rise = np.exp(1j * (system.driven * t + system.phase)), change.frequency * system.driven
    waves = system.amplitudes * turn
    q = system.amplitude_change(change.frequency, change.sizes) * turn + 1j * t * rise * waves
    return np.concatenate([q.imag.sum(axis=1), (system.driven * q.real + rise * waves.real).sum(axis=1)])


def _segment_with_change(model: Model, piece: Piece, deviations: FloatArray, change: ExcitationChange) -> Segment:
    """The same where the last deviation is by a number of the excitation, and becomes `Segment.change`."""
    system, free = model.system(piece.state), deviations.copy()
    free[:, -1] -= _forced_change(system, piece.start, change)
    one, count = _segment(model, piece, free), deviations.shape[1] - 1
    by_number, loads = one.deviations[:, count], one.amplitudes[one.deviations.shape[0] :]
    secular = np.zeros_like(one.weights)
    turning = 1j * change.frequency * system.driven * loads
    secular[:, by_number.size :] = one.weights[:, by_number.size :] * turning
    waves = piece.start * secular
    waves[:, : by_number.size] = one.weights[:, : by_number.size] * by_number
    waves[:, by_number.size :] += (system.stops @ system.amplitude_change(change.frequency, change.sizes)) * loads
    polynomial = np.zeros_like(one.polynomial)
    polynomial[:, :2] = one.drift[:, :, count]
    return one._replace(
        deviations=one.deviations[:, :count],
        drift=one.drift[:, :, :count],
        change=SegmentChange(waves, secular, polynomial),
    )


def _segment(model: Model, piece: Piece, deviations: FloatArray) -> Segment:
    """A piece as a sum of exponentials, and deviations at its start, ``(2 n, m)``, as sums of the same."""
    assert piece.flow is not None
    system, flow = model.system(piece.state), piece.flow
    q, v = np.split(deviations, 2)
    free_q, free_v = (part[:, None] for part in flow.free)
    rates, modes = system.exponentials
    both = np.concatenate([q, free_q], axis=1), np.concatenate([v, free_v], axis=1)
    terms, drift = system.amplitudes_of(*both)
    loads = -1j * np.exp(1j * (system.driven * piece.start + system.phase))
    polynomial = system.polynomial.copy()
    polynomial[:, :2] += drift[:, :, -1]
    return Segment(
        start=piece.start,
        end=piece.end,
        closed=np.array([k in piece.state for k in range(len(system.stops))], dtype=bool),
        rates=np.concatenate([rates, 1j * system.driven]),
        weights=np.concatenate([system.stops[:, modes].astype(complex), system.stops @ system.amplitudes], axis=1),
        amplitudes=np.concatenate([terms[:, -1], loads]),
        polynomial=polynomial,
        deviations=terms[:, :-1],
        drift=drift[:, :, :-1],
        switched=piece.switched,
    )


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
    """Displacements some time after a unit displacement, and after a unit velocity, of the lowest modes.

    Parameters
    ----------
    system : System
        The contact state.
    s : float
        The time, s, of either sign.
    count : int
        How many modes.

    Returns
    -------
    FloatArray, FloatArray, each of shape (count, 1)
        As `free_response` has them.
    """
    a = system.damping_rate[:count, None]
    if not system.all_oscillate:
        return free_response(system.damping_rate[:count], system.omega[:count], np.array([s]))
    wave = np.exp(system.roots[:count] * s)[:, None]
    S = wave.imag / system.roots.imag[:count, None]
    return wave.real + a * S, S


def _jump(model: Model, piece: Piece, after: FloatArray, before: _Deviations, count: int) -> FloatArray:
    """Columns ``(2 n, r)`` after the switch that ends a piece; ``after`` is (q, q') in the next state's modes.

    Of those before it, the ones that are combined have the first `count` modes alone.
    """
    state, k, n = piece.state, piece.switched, after.size // 2
    old, new = model.system(state), model.system(state.toggled(k))
    S = model.transfer(state, state.toggled(k))

    def mapped(vectors: FloatArray, count: int) -> FloatArray:
        return np.concatenate([S[:, :count] @ vectors[:count], S[:, :count] @ vectors[n : n + count]])

    y, columns = (after.reshape(2, -1) @ S).ravel(), before.columns  # S is orthogonal
    row = model.orientation(state)[k] * old.stops[k]
    change = mapped(old.rates(piece.end, y), n) - new.rates(piece.end, after)
    delay = -(row @ columns[:n]) / (row @ y[n:])
    jumped = np.multiply.outer(change, delay)
    jumped[:, : before.few] += mapped(columns[:, : before.few], count)
    jumped[:, before.few :] += mapped(columns[:, before.few :], n)
    return np.asarray(jumped)
