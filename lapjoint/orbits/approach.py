"""The test of whether a march is bound for a stable orbit: whether it converges to the orbit, by conditions.

Let e be the deviation of the march from the orbit now, and M the derivative of the orbit's period map.  After k periods
of the orbit the deviation is e_k = M^k e, provided that the march makes exactly the switches of the orbit.  It makes
exactly these switches if, for all k >= 0,

    |D e_k| <= c |h|              at every stop and phase: the deviation touches no further stop,
    |X e_k| / r <= spacing / 3    at every switch: it shifts by at most a third of the time to its stop's next switch,
    3 (|X e_k| / r) |h''| <= r    at every switch: the stop is crossed at a rate that hardly changes,
    |X' e_k| <= r / 2             at every switch: the deviation changes that rate by at most half,

where h is the stop's gap function, r = |h'| at a switch, D maps a deviation to the change of the displacement at the
stop, and the rows X and X' map it to the changes of h and h' at the switch (`lapjoint.orbits.watch`).  Within three
shifts |X e_k| / r of a stop's own switch the first condition does not apply.  The force of a damped stop has a gap
function of its own, k d + c d' over k.  It begins where the stop's gap closes, and cannot act beyond where the gap
opens, however the deviation shifts these times; both therefore count as switches of the force, too.  Without switches
the map is linear, and c = `LINEAR`; with switches c = `CURVED` leaves room for the nonlinear part of the map.

The first e_k are tested one by one.  For late k only the slow eigenvectors V of M matter, and

    |D e_k| <= sum_i |D V_i| |lambda_i|^K |a_i|,    a = V^-1 e,    k >= K

bounds all k >= K, so that one test covers them.  The number of periods to march before the next
test is one more than the last k that fails.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.orbits.compiled_watch import sound_columns
from lapjoint.orbits.watch import Deviated, Watch
from lapjoint.problem import FloatArray

LINEAR = 0.9
"""Largest fraction c of the distance to a stop that a deviation may have if the orbit has no switch.  The map is then
exactly linear; a smaller fraction would leave lightly damped motions undecided for longer."""
CURVED = 0.5
"""Largest fraction c if the orbit has switches: half of the distance is left for the error of the linearised map."""
_SHIFTS = 3.0
"""Time on either side of a stop's own switch in which the first condition does not apply, divided by the shift |X e_k|
/ r: the deviation decides whether the stop is closed there.  With two shifts some orbits fail narrowly, and need twice
the marching."""
RATE = 0.5
"""Largest change of the rate at a switch, divided by the rate; the switch then keeps its direction."""
_FIRST, _MOST = 16, 1024
"""First and largest number of deviations e_k that are tested together: blocks make fast matrix products."""
_NOTHING = 1e-13
"""Deviation, divided by the size of the orbit, below which a deviation is rounding."""
_DECAYED = 1e-12
"""Largest part of a deviation along an eigenvector that is neglected, divided by the size of the orbit."""


@dataclass(frozen=True)
class Forecast:
    """The result of a test: how long the march has to continue before the conditions can hold."""

    fails: int
    """Periods of the orbit to march before the next test; 0 if the conditions hold from the start and for all time."""

    @property
    def bound(self) -> bool:
        """Whether the march is bound for the orbit."""
        return self.fails == 0


def forecast(
    watch: Watch,
    matrix: FloatArray,
    vectors: ComplexArray,
    deviation: FloatArray,
    size: float,
    most: int,
) -> Forecast:
    """Whether a march is bound for a stable orbit by its deviation e, or else how long to march before the next test.

    `matrix`, (n, n), is the derivative M of the orbit's map, and `vectors`, (n, n), has its eigenvectors as columns.
    `deviation`, (n,), is e at the start of the orbit, and `size` the Euclidean norm of the orbit's section point.  All
    are in the solver's own coordinates.  Blocks of periods are tested, period by period, until
    at least `most` are done.
    """
    share = CURVED if watch.switches.time.size else LINEAR
    power, count, done, fails = matrix, 1, 0, 0
    block = deviation[:, None]
    while count < _FIRST:  # doubling: E, M^c E
        block = np.concatenate([block, power @ block], axis=1)
        power, count = power @ power, 2 * count
    while True:
        broken = np.flatnonzero(~sound(watch, watch.deviated(block), share))
        if broken.size:
            fails = done + int(broken[-1]) + 1
        done += block.shape[1]
        if fails and 2 * fails <= done:  # later failures would not change the next test much
            return Forecast(fails)
        if not fails and _decays(watch, vectors, power @ block[:, 0], size, share):
            return Forecast(0)
        if done >= most:
            return Forecast(max(fails, 1))
        block = power @ block
        if block.shape[1] < _MOST:
            block = np.concatenate([block, power @ block], axis=1)
            power = power @ power


def sound(watch: Watch, deviated: Deviated, share: float) -> np.ndarray:
    """Whether each of K deviations meets all conditions of this module's head at one k, shape (K,).

    `share` is the fraction c of the distance to a stop that a deviation may have: `LINEAR` or `CURVED`.
    """
    switches, intervals = watch.switches, watch.intervals
    return np.asarray(
        sound_columns(
            deviated.largest,
            deviated.at_switches,
            deviated.rates,
            intervals.distance,
            intervals.before,
            intervals.since,
            intervals.after,
            intervals.until,
            switches.rate,
            switches.curvature,
            switches.spacing,
            (share, _SHIFTS, RATE),
        )
    )


def _decays(
    watch: Watch,
    vectors: ComplexArray,
    deviation: FloatArray,
    size: float,
    share: float,
) -> bool:
    """Whether the bound by the slow eigenvectors shows that a deviation meets all conditions now and later."""
    if float(np.linalg.norm(deviation)) <= _NOTHING * size:
        return True
    try:
        parts = np.linalg.solve(vectors, deviation.astype(complex))
    except np.linalg.LinAlgError:
        return False
    if not np.all(np.isfinite(parts)):
        return False
    slow = np.abs(parts) * np.linalg.norm(vectors, axis=0) > _DECAYED * size
    if not slow.any():
        return True
    columns = vectors[:, slow] * parts[slow]
    both = watch.deviated(np.concatenate([np.real(columns), np.imag(columns)], axis=1))

    def bound(values: FloatArray) -> FloatArray:
        return np.asarray(np.hypot(*np.split(values, 2, axis=1)).sum(axis=1, keepdims=True))

    worst = Deviated(bound(both.largest), bound(both.at_switches), bound(both.rates))
    return bool(sound(watch, worst, share)[0])
