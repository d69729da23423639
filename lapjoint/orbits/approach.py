r"""Whether a march is bound for a stable orbit, for all time to come.

A march deviates from the orbit by e now, and by e_k = M^k e after k periods of the orbit, M being the derivative of its
map, so long as the march makes the switches that the orbit makes, and no others.  The march does if, for all k >= 0,

    |D e_k| <= c |h|                  at every stop and phase: the deviation touches no further stop; |X e_k| / r <=
    spacing / 3        at every switch: it moves by far less than the time to the next switch of its stop, 3 (|X e_k| /
    r) |h''| <= r        the stop is crossed at a rate that hardly changes, |X' e_k| <= r / 2                 and that
    the deviation hardly changes,

with D the deviation's motion at the stop, h the stop's gap function, r = |h'| at a switch, X and X' the rows that give
h and h' there from the deviation (`lapjoint.orbits.watch`).  Within three shifts |X e_k| / r of a stop's own switch the
first condition does not apply.  An orbit without switches has an exactly linear map, and c is just below one; else the
conditions leave room for the nonlinear part of the map.

The first k are looked at one by one.  For late k only the slow eigenvectors V of M matter, and

    |D e_k| <= sum_i |D V_i| |lambda_i|^K |a_i|,    a = V^-1 e,    k >= K

settles all of them at once.  If some k fails, the last one says how long to march before it is worth looking again.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.orbits.compiled_watch import sound_columns
from lapjoint.orbits.watch import Deviated, Watch
from lapjoint.problem import FloatArray

LINEAR = 0.9
"""Largest share c of the distance to a stop that a deviation may take if the orbit has no switch.  The map is then
exactly linear; a smaller share would leave lightly damped motions undecided for longer."""
CURVED = 0.5
"""Largest share c if the orbit has switches: half of the distance is left for what the linearised map misses."""
_SHIFTS = 3.0
"""Time from a switch, in shifts |X e_k| / r, within which the distance to its stop does not matter: whether the stop is
closed there depends on the shift.  With two shifts orbits become marginal, and cost twice as much marching."""
RATE = 0.5
"""Largest share of the rate at a switch that a deviation may change; the switch then keeps its direction."""
_FIRST, _MOST = 16, 1024
"""Numbers of deviations e_k that are looked at together, first and at most: blocks make fast matrix products."""
_NOTHING = 1e-13
"""Largest deviation that is rounding, over the size of the orbit."""
_DECAYED = 1e-12
"""Largest part of a deviation along an eigenvector that is neglected, over the size of the orbit."""


@dataclass(frozen=True)
class Forecast:
    """How long a deviation breaks the conditions of this module's head."""

    fails: int
    """Periods of the orbit to march before looking again; 0 if the conditions hold from the start and for all time."""

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
    """Whether a march is bound for a stable orbit by its deviation e, or how long to march before looking again.

    `matrix`, (n, n), is the derivative M of the orbit's map; `vectors`, (n, n), has its eigenvectors as columns;
    `deviation`, (n,), is e at the start of the orbit; `size` is the Euclidean norm of the orbit's section point. All
    are in the solver's own coordinates. At most `most` periods of the orbit are looked at one by one.
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
        if fails and 2 * fails <= done:  # enough to know: it is worth looking again after these
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

    `share` is the share c of the distance to a stop that a deviation may take: `LINEAR` or `CURVED`.
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
