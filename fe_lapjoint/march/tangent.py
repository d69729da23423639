r"""How small deviations travel along a motion: the monodromy matrix, and one tangent vector alone.

A deviation dy travels within a state by the linear flow, and at a switch at time T, where h is the gap function that
vanishes and f- and f+ are the rates before and after,

    dy+ = S dy- + (S f- - f+) dT,    dT = -(dh/dy- dy-) / h'

with S the constant, lossless map between the modes of the two states.
"""

from __future__ import annotations

import numpy as np

from fe_lapjoint.march.march import March, Piece
from fe_lapjoint.march.model import Model
from fe_lapjoint.march.propagator import free_response
from fe_lapjoint.march.system import System
from lapjoint.orbits.period_map import Segment
from lapjoint.problem import FloatArray


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


def carried(model: Model, motion: March, deviations: FloatArray) -> FloatArray:
    """What becomes of deviations from the start of a march by its end.

    Parameters
    ----------
    model : Model
        The problem on a mesh.
    motion : March
        A march by the exact method.
    deviations : FloatArray, shape (2 n, m)
        (dq, dq') at the start as columns, kg^1/2 m and kg^1/2 m/s, in the modes of the first state.

    Returns
    -------
    FloatArray, shape (2 n, m)
        The same at the end, in the modes of the last state.
    """
    for piece, following in zip(motion.pieces, (*motion.pieces[1:], None), strict=True):
        deviations = _flow(model.system(piece.state), piece.end - piece.start, deviations)
        if piece.switched >= 0:
            y = motion.y if following is None else following.y
            deviations = _jump(model, piece, y, deviations)
    return deviations


def traced(model: Model, motion: March, deviations: FloatArray) -> tuple[Segment, ...]:
    """A march as the sums of exponentials that its pieces are, and all deviations from it.

    Parameters
    ----------
    model : Model
        The problem on a mesh.
    motion : March
        A march by the exact method.
    deviations : FloatArray, shape (2 n, m)
        (q, q') at the start by each coordinate of a deviation, in the modes of the first state.

    Returns
    -------
    tuple of Segment
        The march from window to window; a window ends at a switch at the latest.
    """
    segments = []
    for i, piece in enumerate(motion.pieces):
        segments.append(_segment(model, piece, deviations))
        deviations = _flow(model.system(piece.state), piece.end - piece.start, deviations)
        if piece.switched >= 0 and i + 1 < len(motion.pieces):
            deviations = _jump(model, piece, motion.pieces[i + 1].y, deviations)
    return tuple(segments)


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
