"""A march that sits on an unstable orbit: how it is told, and how it is pushed off.

What grows must first be there.  A march from rest keeps every symmetry that the problem has, to rounding, and comes to
orbits that attract within the symmetry and repel outside; rounding then takes long to grow to anything.  No joint is
so symmetric, so the march is pushed off: along the leading eigenvector of the orbit's matrix, to the side to which it
deviates already.  Left alone it would have gone the same way, later.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice

import numpy as np

from fe_lapjoint.newton import Orbit
from fe_lapjoint.turns import Point, Turns

PUSHES = 3
_ON_IT = 1e-5  # relative distance from an unstable orbit at which a march sits on it
_PUSH = 1e-3  # relative; the next one is ten times as long
_REPEATS = 1e-4  # relative distance after which a motion is said to repeat, whatever is nearby
_WATCHED = 40  # periods over which it must


def pushed_off(turns: Turns, orbit: Orbit, point: Point, times: int) -> Point | None:
    """Where a march that sits on an unstable orbit at `point` goes on, after `times` such pushes; None if it does not.

    A stop that the push opens or closes is taken as it then is.
    """
    size = turns.size(orbit.point.y)
    away = turns.seen_from(orbit.point.state, point) - orbit.point.y
    if times >= PUSHES or not orbit.unstable or turns.size(away) > _ON_IT * size:
        return None
    moduli, vectors = np.linalg.eig(orbit.matrix)
    first = int(np.argmax(np.abs(moduli)))
    along = vectors[:, first].real
    side = np.linalg.solve(vectors, away.astype(vectors.dtype))[first].real
    length = _PUSH * 10**times * size / turns.size(along)
    y = orbit.point.y + away + (length if side >= 0 else -length) * along
    return turns.settled(Point(orbit.point.state, y))


def repeats(turns: Turns, points: Sequence[Point], max_order: int) -> bool:
    """Whether the last periods of a march, one point a turn, repeat after `max_order` periods or fewer."""
    per = turns.per_period
    last = points[-1 - _WATCHED * per :]
    allowed = _REPEATS * max(turns.size(point.y) for point in last)

    def all_near(n: int) -> bool:
        pairs = zip(last, islice(last, n, None), strict=False)
        return all(turns.size(turns.seen_from(a.state, b) - a.y) <= allowed for a, b in pairs)

    return any(all_near(n) for n in range(1, min(per * max_order, len(last) - 1) + 1))
