"""Branches go on across grazes at which the map changes as the root of the penetration, or end where it jumps."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from root_maps import Roots, made, past_the_graze, touched

from lapjoint.answers import FREE, SectionPoint
from lapjoint.orbits.branches.closing import Start
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.run import Run


def across(seed: int, leaps: bool = False) -> tuple[Family, Roots, Run]:
    """A branch of a random map past the graze."""
    family, solver = made(seed, leaps)
    return family, solver, past_the_graze(family, solver)


@pytest.mark.parametrize("seed", range(40))
def test_a_branch_goes_on_beyond_a_graze_where_the_map_changes_as_a_root(seed: int) -> None:
    _, solver, run = across(seed)
    alpha, beta = solver.quadratic
    assert run.end == "boundary"
    (graze,) = run.grazes
    assert graze.kind == ("persists" if beta > 0 else "folds")
    assert graze.value == pytest.approx(1.0, abs=1e-6)
    assert {touched(one, solver) > 0 for one in run.places} == {False, True}
    for one in run.places:
        h, q = touched(one, solver), one.value - 1
        expected = h + beta * np.sqrt(h) + alpha * q if h > 0 else h + alpha * q
        assert expected == pytest.approx(0.0, abs=1e-7)


@pytest.mark.parametrize("seed", range(20))
def test_a_branch_ends_at_a_graze_where_what_has_touched_is_not_turned_back(seed: int) -> None:
    _, solver, run = across(seed, leaps=True)
    assert run.end == "graze"
    assert run.grazes[-1].kind == "ends"
    assert run.grazes[-1].value == pytest.approx(1.0, abs=1e-6)
    assert all(touched(one, solver) < 0 for one in run.places)


@pytest.mark.parametrize("seed", range(20))
def test_a_branch_that_only_is_not_found_beyond_a_graze_is_lost(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("grazing.beyond_graze", "continuation.across_jump", "continuation.jumped"):
        monkeypatch.setattr(f"lapjoint.orbits.branches.{name}", lambda *_: None)
    _, _, run = across(seed)
    assert run.end == "lost"
    assert run.grazes[-1].kind == "lost"


def test_a_curve_that_folds_at_a_graze_has_not_come_back_to_it() -> None:
    """A mark may be the motion just before a graze, which lies beside chords beyond it."""
    chords = 0
    for seed in range(40):
        family, solver, run = across(seed)
        (graze,) = run.grazes
        if graze.kind == "folds":
            mark = Start(family, run.places[graze.index])
            for first, ratio in product((1e-6, 1e-5, 1e-4, 1e-3), (3, 10, 100)):
                a, b = (beyond(family, solver, root) for root in (first, ratio * first))
                assert mark.between(a.along(b.chord(family, a)), b.along(b.chord(family, a))) is None
                chords += 1
    assert chords >= 100


def beyond(family: Family, solver: Roots, root: float) -> Place:
    """The motion with a given root of h."""
    alpha, beta = solver.quadratic
    p = -(root**2 + beta * root) / alpha
    x = -np.linalg.solve(solver.A, p * solver.b + solver.e * root)
    found = corrected(family, 1 + p, SectionPoint(FREE, 1 + x[None]), 2, fixed=True)
    assert found is not None
    return found
