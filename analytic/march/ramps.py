r"""Forces that are linear between knots, and what each contact state makes of them.

While a modal force is F + G s, the particular motion of a mode with stiffness is linear in time,

    p(s) = (F + G s) / omega^2 - 2 a G / omega^4,    a = zeta omega,

and what the left-out modes add is F + G s times their quasi-static shape.  Where G changes by dG at a knot, p jumps by
-2 a dG / omega^4 and p' by dG / omega^2, and the free motion by the opposite: each term changes by its *kick* times dG.
A march over a knot therefore needs no displacements and velocities.  Modes without stiffness are carried as q, q', q''
and q''', see `analytic.march.gap_function.Rigid`, because for a small drag their p is a difference of huge numbers.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from analytic.march.joint import Joint
from analytic.march.oscillator import OSCILLATING
from analytic.march.tables import BoolArray, FlatState, IntArray, Tables, flat_state
from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled.by_reference import by_reference, in_c_order
from lapjoint.problem import FloatArray
from lapjoint.problem.ramps import Ramps

LOGGED = 64
"""Largest number of knots in a segment of the log, so that a motion is evaluated from a start that is not far back."""
_RIGID = 2  # most rigid-body modes of a beam: it moves, and it turns


@by_reference
class RampTables(NamedTuple):
    """``K`` knots, ``R`` forces, ``S`` slots, at most ``N`` modes and ``T`` terms, ``U`` positions, ``P`` stops."""

    time: FloatArray
    """The knots, s, shape ``(K,)``."""
    force: FloatArray
    """The forces at the knots, N or N/m, shape ``(K, R)``."""
    slope: FloatArray
    """Rate of the forces from each knot to the next, N/s or N/(m s), shape ``(K - 1, R)``."""
    spacing: float
    """The time between most knots, s; 0 where it differs from knot to knot."""
    whole: ComplexArray
    """exp(lambda spacing) of each term, shape ``(S, T)``."""
    gain: FloatArray
    """1 / omega^2 times the modal force, kg^1/2 m for each unit of load, 0 without stiffness, shape ``(S, R, N)``."""
    lag: FloatArray
    """-2 a / omega^4 times the modal force, kg^1/2 m for each unit of the load's rate, shape ``(S, R, N)``."""
    kick: ComplexArray
    """Change of each term, kg^1/2 m for each unit of change of the rate, shape ``(S, R, T)``."""
    still: FloatArray
    """Displacement at the positions of the stops under the constant loads, rigid-body modes aside, m, ``(S, U)``."""
    gain_at_stops: FloatArray
    """Quasi-static displacement at the positions of the stops, residual included, m for each unit of load, ``(S, U,
    R)``."""
    lag_at_stops: FloatArray
    """Part of the displacement at the positions of the stops that lags, m for each unit of the load's rate, ``(S, U,
    R)``."""
    rigid: IntArray
    """The rigid-body modes, -1 for none, shape ``(S, 2)``."""
    drag: FloatArray
    """Twice the damping rate of the rigid-body modes, 1/s, shape ``(S,)``."""
    interval: IntArray
    """The interval between knots in which the march is, shape ``(1,)``; changed in place."""
    goes_on: BoolArray
    """Whether the march is in a state that it has entered before, shape ``(1,)``; changed in place."""
    shift: FloatArray
    """How far above 0 each gap function was on entering the state, m, shape ``(P,)``; changed in place."""


class RampState:
    """What a march along ramps carries from one compiled call to the next, and from block to block of the ramps.

    The march begins at `start`, s.
    """

    def __init__(self, joint: Joint, start: float) -> None:
        blocks = joint.problem.forces.ramps
        assert blocks is not None
        self._joint, self._blocks = joint, blocks
        self._carried = np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.bool_), np.zeros(joint.stops)
        self._block = blocks.block_at(start)
        self._met = 0
        self._made: RampTables | None = None

    def move_to(self, t: float) -> float:
        """Go on to the block of samples that holds the time `t`, s; returns its end, s, infinite for the last block.

        `t` is not before the `t` of the last call.  A march up to the end of the block may then take `tables`.
        """
        block = self._blocks.block_at(t)
        if block is not self._block:
            self._block, self._carried[0][0] = block, 0
            if self._made is not None:
                self._made = on_block(self._made, self._joint, block)
        return block.end if block.end < self._blocks.end else np.inf

    @property
    def tables(self) -> RampTables:
        """The tables of all states that the joint has met so far."""
        met = len(self._joint.states)
        if self._made is None or met != self._met:
            self._made, self._met = ramp_tables(self._joint, self._block, self._carried), met
        return self._made


def on_block(made: RampTables, joint: Joint, block: Ramps) -> RampTables:
    """The tables with another block of the ramps; all other arrays are shared with `made`."""
    whole = made.whole if block.spacing == made.spacing else np.exp(joint.tables.root * block.spacing)
    return made._replace(time=block.time, force=block.force, slope=block.slope, spacing=block.spacing, whole=whole)


def ramp_tables(
    joint: Joint, ramps: Ramps, carried: tuple[IntArray, BoolArray, FloatArray] | None = None
) -> RampTables:
    """The ramps of a joint in all the states that it has met, with as many slots as its tables.

    `carried` are `interval`, `goes_on` and `shift`, new ones if not given.
    """
    tables, R = joint.tables, ramps.force.shape[1]
    S, N, T, U = tables.modes.size, tables.kind.shape[1], tables.root.shape[1], tables.weight.shape[1]
    made = RampTables(
        time=ramps.time,
        force=ramps.force,
        slope=ramps.slope,
        spacing=ramps.spacing,
        whole=np.exp(tables.root * ramps.spacing),
        gain=np.zeros((S, R, N)),
        lag=np.zeros((S, R, N)),
        kick=np.zeros((S, R, T), dtype=complex),
        still=np.zeros((S, U)),
        gain_at_stops=np.zeros((S, U, R)),
        lag_at_stops=np.zeros((S, U, R)),
        rigid=np.full((S, _RIGID), -1, dtype=np.int64),
        drag=np.zeros(S),
        interval=np.zeros(1, dtype=np.int64),
        goes_on=np.zeros(1, dtype=np.bool_),
        shift=np.zeros(tables.sign.size),
    )
    made = in_c_order(made)
    if carried is not None:
        made = made._replace(interval=carried[0], goes_on=carried[1], shift=carried[2])
    for slot, state in enumerate(joint.states):
        _fill(made, tables, slot, flat_state(joint.loaded, state, joint.count(state)))
    return made


def _fill(made: RampTables, tables: Tables, slot: int, flat: FlatState) -> None:
    """Write one state into its slot."""
    n, terms, R = int(tables.modes[slot]), int(tables.terms[slot]), made.gain.shape[1]
    root, force, weight = tables.root[slot], flat.force[-R:], tables.weight[slot, :, :n]
    others = root[:n].conj()
    others[tables.mode_of[slot, n:terms]] = root[n:terms]
    square, twice = (root[:n] * others).real, -(root[:n] + others).real  # omega^2 and 2 a
    elastic = square > 0
    made.gain[slot, :, :n] = np.divide(force, square, out=np.zeros_like(force), where=elastic)
    made.lag[slot, :, :n] = -np.divide(twice * made.gain[slot, :, :n], square, out=np.zeros_like(force), where=elastic)
    x, y = -made.lag[slot, :, :n], -made.gain[slot, :, :n]
    oscillating = np.flatnonzero(tables.kind[slot, :n] == OSCILLATING)
    one = root[oscillating]
    made.kick[slot][:, oscillating] = (
        x[:, oscillating] - 1j * (y[:, oscillating] - one.real * x[:, oscillating]) / one.imag
    )
    for extra, i in enumerate(tables.mode_of[slot, n:terms].tolist(), start=n):
        if elastic[i]:
            first, second = root[i].real, root[extra].real
            made.kick[slot, :, i] = (y[:, i] - second * x[:, i]) / (first - second)
            made.kick[slot, :, extra] = (first * x[:, i] - y[:, i]) / (first - second)
    rigid = np.flatnonzero(~elastic)
    made.rigid[slot, : rigid.size] = rigid
    made.drag[slot] = twice[rigid].max(initial=0.0)
    made.still[slot] = tables.constant[slot] + weight[:, elastic] @ tables.static[slot, :n, 0][elastic]
    made.gain_at_stops[slot] = flat.residual[:, -R:] + weight @ made.gain[slot, :, :n].T
    made.lag_at_stops[slot] = weight @ made.lag[slot, :, :n].T
