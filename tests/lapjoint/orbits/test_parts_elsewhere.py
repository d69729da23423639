"""Of a curve that is another branch in part: what is left out is what was not listed, whatever finer solvers put in."""

from __future__ import annotations

from typing import cast

import numpy as np
import pytest

from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.resolving import Part, Resolved, _put_in


@pytest.mark.parametrize("seed", range(200))
def test_ways_between_places_are_left_out_if_none_has_listed_what_is_there(seed: int) -> None:
    """Each way from place to place is told by who has followed it; the parts of finer solvers have their own."""
    rng = np.random.default_rng((91, seed))
    n, family = int(rng.integers(4, 40)), cast(Family, None)

    def curve(count: int, elsewhere: frozenset[int] = frozenset()) -> Resolved:
        places = [cast(Place, object()) for _ in range(count)]
        return Resolved(places, [], [family] * count, ("", ""), elsewhere)

    elsewhere = frozenset(k for k in range(1, n) if rng.random() < 0.5)
    now = curve(n, elsewhere)
    ways = [("coarse", k) for k in range(1, n)]
    edges = np.sort(rng.choice(n, 2 * int(rng.integers(1, n // 2 + 1)), replace=False)).reshape(-1, 2)
    for i, j in edges[::-1].tolist():
        count = int(rng.integers(2, 9))
        now = _put_in(now, Part(i, j, curve(count)))
        ways[i:j] = [("finer", 0)] * (count - 1)
    assert len(now.places) == len(ways) + 1
    assert now.elsewhere == {k for k, (who, own) in enumerate(ways, 1) if who == "coarse" and own in elsewhere}
