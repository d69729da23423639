"""Flips and folds just beyond a graze, where the map changes as the root of the penetration, are on the branch.

The maps are those of `root_maps`, with roots so small that many lie between the graze and where the branch goes on.
With M = 1 + A + e g' / (2 s), s = root(h), the determinant of 1 + M is that of 2 + A times 1 + g' (2 + A)^-1 e / (2 s).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from root_maps import AMPLITUDE, HIGH, LOW, Roots, made, past_the_graze

from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.listing import listed

NEAREST = 2e-7  # h, m: motions within 1e-7 of a graze are not looked at
GOES_ON = 3e-5  # h, m, where a branch goes on first
FLAT = 0.05  # least change of h with the number, above which the graze is told from motions beside it


def any_map(seed: int) -> tuple[Family, Roots]:
    """A map with a root that outweighs the rest only near the graze."""
    family, solver = made(seed)
    return with_root(family, solver, np.random.default_rng((44, seed)), (1e-3, 1.0))


def contracting(seed: int) -> tuple[Family, Roots]:
    """The same with all multipliers well within the circle, but for those near the graze on its touched side."""
    family, solver = made(seed)
    rng, n = np.random.default_rng((45, seed)), solver.g.size
    turned = np.linalg.qr(rng.standard_normal((n, n)))[0]
    solver = replace(solver, A=turned @ np.diag(rng.uniform(-1.6, -0.4, n)) @ turned.T)
    return with_root(family, solver, rng, (1e-4, 0.3))


def with_root(
    family: Family, solver: Roots, rng: np.random.Generator, sizes: tuple[float, float]
) -> tuple[Family, Roots]:
    """A map with another size of the vector with which the root is multiplied."""
    size = float(np.exp(rng.uniform(*np.log(sizes))))
    solver = replace(solver, e=solver.e / np.linalg.norm(solver.e) * size)
    return Family(solver, family.problem_at, AMPLITUDE, LOW, HIGH), solver


def truth(solver: Roots) -> dict[str, tuple[float, float]]:
    """The number, and the penetration h, m, at the flip and at the fold of the touched motions, if they are there."""
    (alpha, beta), n = solver.quadratic, solver.g.size
    at_flip = -float(solver.g @ np.linalg.solve(2 * np.eye(n) + solver.A, solver.e)) / 2
    roots = {"flip": at_flip, "fold": -beta / 2}
    values = {kind: 1 - (root**2 + beta * root) / alpha for kind, root in roots.items()}
    there = [kind for kind, root in roots.items() if root > 0 and LOW < values[kind] < HIGH]
    return {kind: (values[kind], roots[kind] ** 2) for kind in there}


@pytest.mark.parametrize(("maps", "seeds", "many", "few"), [(any_map, 120, 30, 3), (contracting, 270, 80, 10)])
def test_what_lies_just_beyond_a_graze_is_found_and_nothing_else(
    maps: Callable[[int], tuple[Family, Roots]], seeds: int, many: int, few: int
) -> None:
    near = unresolved = 0
    for seed in range(seeds):
        family, solver = maps(seed)
        if abs(solver.quadratic[0]) < FLAT:
            continue
        run, true = past_the_graze(family, solver), truth(solver)
        found = [one.bifurcation for one in listed(family, run, errors=False)]
        if any(one.kind == "unresolved" for one in found):  # it is said that a part is not known
            unresolved += 1
            continue
        for kind in ("flip", "fold"):
            own = [one.value for one in found if one.kind == kind]
            value, penetration = true.get(kind, (np.nan, 0.0))
            if penetration > NEAREST:
                assert own == pytest.approx([value], abs=1e-7)
                near += penetration < GOES_ON
            else:
                assert all(one == pytest.approx(value, abs=1e-7) for one in own)
    assert near >= many
    assert unresolved <= few
