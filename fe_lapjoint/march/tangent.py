r"""How small deviations travel along a motion: the monodromy matrix, and one tangent vector alone.

A deviation dy travels within a state by the linear flow, and at a switch at time T, where h is the gap function that
vanishes and f- and f+ are the rates before and after,

    dy+ = S dy- + (S f- - f+) dT,    dT = -(dh/dy- dy-) / h'

with S the constant, lossless map between the modes of the two states.

The derivative of a march by a number of its excitation is one deviation more.  Within a state it is a free motion
beyond the change of the forced motion Im sum_h A_h exp(i (w_h t + phase_h)),

    Im sum_h (dA_h + i t dw_h A_h) exp(i (w_h t + phase_h)),

and at the end, whose time may depend on the number, the march goes on by its rates.  Gaps and S do not depend on it.

The fast modes of a mesh die out within one state.  Once most coordinates are zero, all deviations are D = E R, with E
the columns of the identity that belong to the others, and only what becomes of E is carried on.
"""

from __future__ import annotations

import numpy as np

from fe_lapjoint.march.march import March, Piece
from fe_lapjoint.march.model import Model
from fe_lapjoint.march.propagator import free_response
from fe_lapjoint.march.system import IndexArray, System
from lapjoint.orbits.parameters import ExcitationChange
from lapjoint.orbits.period_map import Segment, SegmentChange
from lapjoint.problem import FloatArray

_DEAD = 60.0
"""Decay time constants after which a mode is zero: exp(-60) is below the rounding of all else, 1e-16, even after a
change of unit by the ratio of the highest and the lowest frequency of a mesh, some 1e8."""
_FEW = 0.5
"""Share of the deviations from which on it saves time to carry the coordinates that are not zero instead of them."""


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
    return carried(model, motion, np.eye(motion.pieces[0].y.size))


def carried(model: Model, motion: March, deviations: FloatArray, change: ExcitationChange | None = None) -> FloatArray:
    """What becomes of deviations from the start of a march by its end.

    Parameters
    ----------
    model : Model
        The problem on a mesh.
    motion : March
        A march by the exact method.
    deviations : FloatArray, shape (2 n, m)
        (dq, dq') at the start as columns, kg^1/2 m and kg^1/2 m/s, in the modes of the first state.
    change : ExcitationChange, optional
        How the excitation changes with a number; the last deviation is then over its unit, and zero at the start.

    Returns
    -------
    FloatArray, shape (2 n, m)
        The same at the end, in the modes of the last state.
    """
    by_number, since, rest = int(change is not None), motion.pieces[0].start, None
    for piece, following in zip(motion.pieces, (*motion.pieces[1:], None), strict=True):
        system = model.system(piece.state)
        deviations = _along(system, piece, deviations, change)
        if rest is None:
            alive = np.tile(system.slowest_decay * (piece.end - since) < _DEAD, 2)
            if 0 < np.count_nonzero(alive) <= _FEW * (deviations.shape[1] - by_number):
                deviations, rest = _fewer(deviations, np.flatnonzero(alive), by_number)
        if piece.switched >= 0:
            y, since = motion.y if following is None else following.y, piece.end
            deviations = _jump(model, piece, y, deviations)
    if change is not None:
        end = motion.pieces[-1].end
        deviations[:, -1] -= change.frequency * end * model.system(motion.state).rates(end, motion.y)
    if rest is None:
        return deviations
    count = rest.shape[0]
    return np.concatenate([deviations[:, :count] @ rest, deviations[:, count:]], axis=1)


def _fewer(deviations: FloatArray, alive: IndexArray, by_number: int) -> tuple[FloatArray, FloatArray]:
    """Units of the coordinates that are not zero, beside the last `by_number` deviations; and the others in them."""
    units = np.zeros((deviations.shape[0], alive.size + by_number))
    units[alive, np.arange(alive.size)] = 1.0
    count = deviations.shape[1] - by_number
    units[:, alive.size :] = deviations[:, count:]
    return units, deviations[alive, :count]


def _along(system: System, piece: Piece, deviations: FloatArray, change: ExcitationChange | None) -> FloatArray:
    """Deviations ``(2 n, m)`` at the end of a piece, before its switch."""
    if change is None:
        return _flow(system, piece.end - piece.start, deviations)
    free = deviations.copy()
    free[:, -1] -= _forced_change(system, piece.start, change)
    free = _flow(system, piece.end - piece.start, free)
    free[:, -1] += _forced_change(system, piece.end, change)
    return free


def _forced_change(system: System, t: float, change: ExcitationChange) -> FloatArray:
    """How the forced motion (q, q') at a time changes with a number, ``(2 n,)``."""
    turn, rise = np.exp(1j * (system.driven * t + system.phase)), change.frequency * system.driven
    waves = system.amplitudes * turn
    q = system.amplitude_change(change.frequency, change.sizes) * turn + 1j * t * rise * waves
    return np.concatenate([q.imag.sum(axis=1), (system.driven * q.real + rise * waves.real).sum(axis=1)])


def traced(
    model: Model, motion: March, deviations: FloatArray, change: ExcitationChange | None = None
) -> tuple[Segment, ...]:
    """A march as the sums of exponentials that its pieces are, and all deviations from it.

    Parameters
    ----------
    model : Model
        The problem on a mesh.
    motion : March
        A march by the exact method.
    deviations : FloatArray, shape (2 n, m)
        (q, q') at the start by each coordinate of a deviation, in the modes of the first state.
    change : ExcitationChange, optional
        How the excitation changes with a number; the last deviation is then over its unit, and zero at the start.

    Returns
    -------
    tuple of Segment
        The march from window to window; a window ends at a switch at the latest.
    """
    segments = []
    for i, piece in enumerate(motion.pieces):
        if change is None:
            segments.append(_segment(model, piece, deviations))
        else:
            segments.append(_segment_with_change(model, piece, deviations, change))
        deviations = _along(model.system(piece.state), piece, deviations, change)
        if piece.switched >= 0 and i + 1 < len(motion.pieces):
            deviations = _jump(model, piece, motion.pieces[i + 1].y, deviations)
    return tuple(segments)


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
    polynomial = np.zeros((len(system.stops), 3))
    polynomial[:, :2] = drift[:, :, -1]
    polynomial[:, 0] += system.stops @ system.equilibrium
    if system.drift is not None:
        polynomial[:, 1] += system.stops @ system.drift[0]
        polynomial[:, 2] = system.stops @ system.drift[1] / 2
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


def _flow(system: System, s: float, deviations: FloatArray) -> FloatArray:
    """Deviations ``(2 n, m)`` after `s` seconds within one state."""
    if system.all_oscillate:
        wave, a = np.exp(system.roots * s)[:, None], system.damping_rate[:, None]
        S = wave.imag / system.roots.imag[:, None]
        C = wave.real + a * S
    else:
        a = system.damping_rate[:, None]
        C, S = free_response(system.damping_rate, system.omega, np.array([s]))
    n = system.omega.size
    q, v = deviations[:n], deviations[n:]
    return np.concatenate([C * q + S * v, (C - 2 * a * S) * v - (system.omega**2)[:, None] * (S * q)])


def _jump(model: Model, piece: Piece, after: FloatArray, deviations: FloatArray) -> FloatArray:
    """Deviations ``(2 n, m)`` after the switch that ends a piece; ``after`` is (q, q') in the next state's modes."""
    state, k, n = piece.state, piece.switched, after.size // 2
    old, new = model.system(state), model.system(state.toggled(k))
    S = model.transfer(state, state.toggled(k))

    def mapped(vectors: FloatArray) -> FloatArray:
        return np.concatenate([S @ vectors[:n], S @ vectors[n:]])

    before = (after.reshape(2, -1) @ S).ravel()  # S is orthogonal
    row = model.orientation(state)[k] * old.stops[k]
    change = mapped(old.rates(piece.end, before)) - new.rates(piece.end, after)
    delay = -(row @ deviations[:n]) / (row @ before[n:])
    return np.asarray(mapped(deviations) + np.multiply.outer(change, delay))
