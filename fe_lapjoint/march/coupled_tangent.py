"""Small deviations in contact states whose modes are coupled, by the amplitudes of the exponentials of each state.

In these coordinates the flow multiplies each amplitude by exp(r s), and exponentials that have died are left out.  A
switch maps the amplitudes of one state to those of the next by a matrix that depends on the joint and the mesh alone:
see `passage`.  States with rigid-body motions, and those whose modes are not coupled, keep (dq, dq').
"""

from __future__ import annotations

from typing import TypeGuard

import numpy as np

from fe_lapjoint.march.coupled import Coupled
from fe_lapjoint.march.coupled_modes import acting
from fe_lapjoint.march.exponentials import Exponentials
from fe_lapjoint.march.march import Piece
from fe_lapjoint.march.model import Model
from fe_lapjoint.march.system import System
from fe_lapjoint.modes.eigenmodes import Springs, springs_of, transfer_between
from lapjoint.answers.contact_state import ContactState
from lapjoint.machine.result_cache import cached
from lapjoint.problem import FloatArray
from lapjoint.problem.structure import Structure

_KEPT = 256  # matrices that are kept, each of a fifth of a megabyte with 40 elements


def by_amplitudes(system: System) -> TypeGuard[Coupled]:
    """Whether deviations in a state are given by the ``T`` amplitudes of its exponentials, real and imaginary parts in
    turn, ``(2 T, m)``, and not by (dq, dq'), ``(2 n, m)``."""
    return isinstance(system, Coupled) and system.free.rest is None


def jumped(model: Model, piece: Piece, after: FloatArray, columns: FloatArray, units: bool) -> FloatArray:
    """Deviations ``(rows, m)`` after the switch that ends a piece, in the coordinates of the next state.

    `columns`, ``(first rows, m)``, holds those before the switch up to the last row that is not zero, and `units` says
    that they are unit vectors.  ``after`` is (q, q') after the switch.
    """
    following = model.after(piece.state, piece.switched)
    old, new, S = model.system(piece.state), model.system(following), model.transfer(piece.state, following)
    y, n, at = (after.reshape(2, -1) @ S).ravel(), after.size // 2, np.array([piece.end])  # S is orthogonal
    rates = old.rates(piece.end, y)
    change = S @ rates[n:] - new.rates(piece.end, after)[n:]  # velocities go on
    k, lag = piece.switched, 0.0
    if k >= model.sign.size:  # a force ends or begins where z + (c / k) z' is at the gap
        k = model.damped[k - model.sign.size]
        lag = model.problem.structure.stops[k].damping / float(model.stiffness[k])
    row = np.concatenate([old.stops[k], lag * old.stops[k]])
    rate = row @ rates
    if old.sees_base or old.ramps is not None:
        rate += old.seen_motion(at, 1)[k, 0] + lag * old.seen_motion(at, 2)[k, 0]
    if by_amplitudes(old):
        row = old.modes.shares[old.row_places[piece.switched]].conj().view(float)
    passed, own = _passage_of(model, piece.state, following)[:, : columns.shape[0]], row[: columns.shape[0]]
    own, felt = own if units else own @ columns, np.concatenate([np.zeros(n), change])
    if by_amplitudes(new):
        felt = new.free.real_back[n:].T @ change
    made = np.multiply.outer(felt, own / -rate)
    made += passed if units else passed @ columns
    return np.asarray(made)


def _passage_of(model: Model, old: ContactState, new: ContactState) -> FloatArray:
    """`passage` between two states."""
    found = model.passages.get((old, new))
    if found is None:
        free = [it.free if by_amplitudes(it) else None for it in (model.system(old), model.system(new))]
        springs = [springs_of(model.assembly, acting(state)) for state in (old, new)]
        found = passage(*model.assembly.without_stops, springs[0], springs[1], free[0], free[1])
        model.passages[old, new] = found
    return found


@cached(_KEPT)
def passage(
    joint: Structure,
    nodes: tuple[float, ...],
    old_springs: Springs,
    new_springs: Springs,
    old: Exponentials | None,
    new: Exponentials | None,
) -> FloatArray:
    """The matrix that maps coordinates of deviations in one state to those in another, read-only.

    They are amplitudes where exponentials are given, and else (dq, dq').
    """
    S = transfer_between(joint, nodes, old_springs, new_springs)
    n = S.shape[0]
    before = np.eye(2 * n) if old is None else old.real_motion.T
    made = np.concatenate([S @ before[:n], S @ before[n:]])
    made = made if new is None else new.real_back.T @ made
    made.flags.writeable = False
    return np.asarray(made)
