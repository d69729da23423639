r"""Forces that are linear between knots, and what each contact state makes of them.

While a modal force is F + G s, the particular motion of a mode with stiffness is linear in time,

    p(s) = (F + G s) / omega^2 - 2 a G / omega^4,    a = zeta omega,

and what the left-out modes add is F + G s times their quasi-static shape.  Where G changes by dG at a knot, p jumps by
-2 a dG / omega^4 and p' by dG / omega^2, and the free motion by the opposite: each term changes by its *kick* times dG.
A march over a knot therefore needs no displacements and velocities.

Stops that stand still in space move relative to the base by -y, and their gaps see y beside z.  Its acceleration is
linear between knots, so y is a load with two more derivatives; while the modal force is F y,

    p(s) = c0 y + c1 y' + c2 a + c3 a',    c0 = F / omega^2,    c_n = -(2 a c_(n-1) + c_(n-2)) / omega^2,

where a = y'' and a' are minus the first load, the force of inertia, and minus its rate: gain and lag of that load take
c2 and c3.
In a coupled state, see `analytic.march.coupled`, forces contain rates of the loads, and velocities jump with these.

  Modes without stiffness are carried as q, q', q''
and q''', see `analytic.march.gap_function.Rigid`, because for a small drag their p is a difference of huge numbers.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from analytic.march.joint import Joint
from analytic.march.oscillator import OSCILLATING
from analytic.march.tables import BoolArray, IntArray
from analytic.modes.beam_functions import ComplexArray
from lapjoint.answers.contact_state import ContactState
from lapjoint.compiled.by_reference import by_reference, in_c_order
from lapjoint.problem import FloatArray
from lapjoint.problem.ramps import Ramps

LOGGED = 64
"""Largest number of knots in a segment of the log, so that a motion is evaluated from a start that is not far back."""
_RIGID = 2  # most rigid-body modes of a beam: it moves, and it turns


@by_reference
class RampTables(NamedTuple):
    """``K`` knots, ``R`` forces, ``S`` slots, at most ``N`` modes and ``T`` terms, ``U`` positions, ``P`` stops.

    There are ``L`` loads: the forces, and the displacement of the base if stops fixed in space see it.
    """

    time: FloatArray
    """The knots, s, shape ``(K,)``."""
    force: FloatArray
    """The forces at the knots, N or N/m, shape ``(K, R)``."""
    slope: FloatArray
    """Rate of the forces from each knot to the next, N/s or N/(m s), shape ``(K - 1, R)``."""
    spacing: float
    """The time between most knots, s; 0 where it differs from knot to knot."""
    base: FloatArray
    """Displacement of the base that stops fixed in space see, and three derivatives, from each knot on, m over powers
    of s, shape ``(K - 1, 4)``; ``(0, 4)`` without such stops."""
    whole: ComplexArray
    """exp(lambda spacing) of each term, shape ``(S, T)``."""
    gain: FloatArray
    """Displacement of each mode, kg^1/2 m for each unit of load, 0 without stiffness, shape ``(S, L, N)``."""
    lag: FloatArray
    """Displacement of each mode, kg^1/2 m for each unit of the load's rate, shape ``(S, L, N)``."""
    jolt: FloatArray
    """Force on each oscillator of a coupled state by the rate of the load's rate, shape ``(S, L, N)``.  The velocity
    contains it times the load's rate, which jumps at a knot; the march carries the rest of the velocity."""
    kick: ComplexArray
    """Change of each term, kg^1/2 m for each unit of change of the rate, shape ``(S, R, T)``."""
    still: FloatArray
    """Displacement at the positions of the stops under the constant loads, rigid-body modes aside, m, ``(S, U)``."""
    gain_at_stops: FloatArray
    """What the gaps at the positions of the stops see, residual included, m for each unit of load, ``(S, U, L)``."""
    lag_at_stops: FloatArray
    """What the gaps at the positions of the stops see, m for each unit of the load's rate, ``(S, U, L)``."""
    rigid: IntArray
    """The rigid-body modes, -1 for none, shape ``(S, 2)``."""
    rigid_at_stops: FloatArray
    """Weights of displacement and velocity of these modes at the positions of the stops, ``(S, U, 2, 2)``."""
    pull: FloatArray
    """Force on these modes by the constant load and each of ``R`` loads, by its rate, and by the rate of its rate,
    shape ``(S, 2, 1 + R, 3)``."""
    drag: FloatArray
    """Rates at which the parts of `Rigid` fall, 1/s, shape ``(S, C)``: one for all rigid-body modes; or, with damped
    stops or a base that stops see, one for each of two, and 0."""
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
    made = made._replace(time=block.time, force=block.force, slope=block.slope, spacing=block.spacing)
    return made._replace(base=_base_of(block), whole=whole)


def _base_of(block: Ramps) -> FloatArray:
    """`RampTables.base` of a block."""
    return np.zeros((0, 4)) if block.base is None else np.ascontiguousarray(block.base_at(block.time[:-1]).T)


def ramp_tables(
    joint: Joint, ramps: Ramps, carried: tuple[IntArray, BoolArray, FloatArray] | None = None
) -> RampTables:
    """The ramps of a joint in all the states that it has met, with as many slots as its tables.

    `carried` are `interval`, `goes_on` and `shift`, new ones if not given.
    """
    tables, R, L = joint.tables, ramps.force.shape[1], joint.sampled
    S, N, T, U = tables.modes.size, tables.kind.shape[1], tables.root.shape[1], tables.weight.shape[1]
    made = RampTables(
        time=ramps.time,
        force=ramps.force,
        slope=ramps.slope,
        spacing=ramps.spacing,
        base=_base_of(ramps),
        whole=np.exp(tables.root * ramps.spacing),
        gain=np.zeros((S, L, N)),
        lag=np.zeros((S, L, N)),
        jolt=np.zeros((S, L, N)),
        kick=np.zeros((S, R, T), dtype=complex),
        still=np.zeros((S, U)),
        gain_at_stops=np.zeros((S, U, L)),
        lag_at_stops=np.zeros((S, U, L)),
        rigid=np.full((S, _RIGID), -1, dtype=np.int64),
        rigid_at_stops=np.zeros((S, U, _RIGID, 2)),
        pull=np.zeros((S, _RIGID, 1 + R, 3)),
        drag=np.zeros((S, _RIGID + 1 if joint.damped or L > R else 1)),
        interval=np.zeros(1, dtype=np.int64),
        goes_on=np.zeros(1, dtype=np.bool_),
        shift=np.zeros(tables.sign.size),
    )
    made = in_c_order(made)
    if carried is not None:
        made = made._replace(interval=carried[0], goes_on=carried[1], shift=carried[2])
    for slot, state in enumerate(joint.states):
        _fill(made, joint, slot, _pushed(joint, slot, state))
    return made


class _Pushed(NamedTuple):
    """What ``L`` sampled loads do in a state: real parts by the load, imaginary parts by its rate."""

    force: ComplexArray
    """Forces on the modes, or on the oscillators of a coupled state, shape ``(L, N)``."""
    jolt: FloatArray
    """Forces by the rate of the load's rate, shape ``(L, N)``."""
    constant: FloatArray
    """Forces of the constant load, shape ``(N,)``."""
    reads: FloatArray
    """Weights of displacements and velocities at the positions of the stops, shape ``(U, 2, N)``."""
    rest: ComplexArray
    """What the gaps at the positions see beside these, m, shape ``(U, L)``."""


def _pushed(joint: Joint, slot: int, state: ContactState) -> _Pushed:
    """What the sampled loads of a joint do in a state."""
    tables, L, it = joint.tables, joint.sampled, joint.coupled(state)
    n, U = int(tables.modes[slot]), tables.weight.shape[1]
    if it is not None:
        force, rest = joint.of_loads(it.push)[-L:], joint.of_loads(it.beside.transpose(0, 2, 1))[-L:].T
        return _Pushed(force, it.lag[1, -L:], it.push[0, 0], it.frame.reads, rest)
    flat, reads, rest = joint.flat(state), np.zeros((U, 2, n)), np.zeros((U, L), dtype=complex)
    reads[:, 0] = tables.weight[slot, :, :n]
    rest[: flat.residual.shape[0]] = flat.residual[:, -L:]
    return _Pushed(flat.force[-L:].astype(complex), np.zeros((L, n)), tables.force[slot, 0, :n], reads, rest)


def _fill(made: RampTables, joint: Joint, slot: int, by: _Pushed) -> None:
    """Write one state into its slot."""
    tables = joint.tables
    n, R, root = int(tables.modes[slot]), made.kick.shape[1], tables.root[slot]
    terms = int(tables.terms[slot])
    others = root[:n].conj()
    others[tables.mode_of[slot, n:terms]] = root[n:terms]
    square, twice = (root[:n] * others).real, -(root[:n] + others).real  # omega^2 and 2 a
    elastic = square > 0
    soft = np.divide(1.0, square, out=np.zeros(n), where=elastic)
    lossy = np.divide(1.0, twice, out=np.zeros(n), where=~elastic & (twice > 0))
    gain = by.force.real * soft
    lag = (by.force.imag - twice * gain) * soft
    by_speed = by.reads[:, 1] @ gain.T
    gain_at_stops = np.zeros((by.reads.shape[0], gain.shape[0]))
    if made.base.size:
        # a rigid-body motion with drag feels the rate of the base alone: its equation, integrated once
        gain[-1] += by.force.imag[-1] * lossy
        lag[-1] += (by.jolt[-1] - gain[-1]) * lossy
        bend = (by.jolt[-1] - twice * lag[-1] - gain[-1]) * soft - lag[-1] * lossy
        gain[0] -= bend  # the first load is minus the acceleration of the base
        lag[0] += (twice * bend + lag[-1]) * soft + bend * lossy
        by_speed = by.reads[:, 1] @ gain.T
        gain_at_stops[:, 0] = -by.reads[:, 1] @ lag[-1]
    made.gain[slot, :, :n], made.lag[slot, :, :n], made.jolt[slot, :, :n] = gain, lag, by.jolt
    x, y = -lag[:R], by.jolt[:R] - gain[:R]
    oscillating = np.flatnonzero(tables.kind[slot, :n] == OSCILLATING)
    one, kick = root[oscillating], made.kick[slot]
    kick[:, oscillating] = x[:, oscillating] - 1j * (y[:, oscillating] - one.real * x[:, oscillating]) / one.imag
    for extra, i in enumerate(tables.mode_of[slot, n:terms].tolist(), start=n):
        if elastic[i]:
            first, second = root[i].real, root[extra].real
            kick[:, i] = (y[:, i] - second * x[:, i]) / (first - second)
            kick[:, extra] = (first * x[:, i] - y[:, i]) / (first - second)
    rigid = np.flatnonzero(~elastic)
    made.rigid[slot, : rigid.size] = rigid
    made.rigid_at_stops[slot, :, : rigid.size] = by.reads[:, :, rigid].transpose(0, 2, 1)
    made.pull[slot, : rigid.size, 0, 0] = by.constant[rigid]
    parts = by.force[:R, rigid].real, by.force[:R, rigid].imag, by.jolt[:R, rigid]
    made.pull[slot, : rigid.size, 1:] = np.stack(parts, axis=-1).transpose(1, 0, 2)
    if made.drag.shape[1] == 1:
        made.drag[slot] = twice[rigid].max(initial=0.0)
    else:
        made.drag[slot, : rigid.size] = twice[rigid]
    made.still[slot] = tables.constant[slot] + by.reads[:, 0, elastic] @ tables.static[slot, :n, 0][elastic]
    made.gain_at_stops[slot] = gain_at_stops + by.rest.real + by.reads[:, 0] @ gain.T
    made.lag_at_stops[slot] = by.rest.imag + by.reads[:, 0] @ lag.T + by_speed
