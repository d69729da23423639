"""Bifurcations of maps whose multipliers are given functions of a number: all are found, where they are, and no others.

Each block of a map has two multipliers with the sum t(p) and the product d(p), so that a flip is a root of 1 + t + d,
and a Neimark-Sacker a root of d - 1 with |t| < 2.  Within one step of a branch pairs turn real outside the circle, pass
-1 one after the other, and go out of the circle and come back.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from made_map import Made, made_problem, of_trace
from scipy.optimize import brentq

from lapjoint.answers.branches import Bifurcation
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches import bifurcations
from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.locating import Criterion, criteria_of
from lapjoint.orbits.branches.tracing import Seed, trace

LOW, HIGH = 1.0, 2.0
AMPLITUDE = "base_motion.amplitude"
_GRID = np.linspace(LOW, HIGH, 4001)
NEAR = 0.05
"""Of the number, a fifth of the longest step: two bifurcations that undo each other within it may be overlooked."""
EXACT = 1e-7  # of the number: a multiplier is off by 1e-9 at most, and moves a hundredth as fast as the number at least
HARD = 17, 427
"""Seeds of maps of which a step has flips of two multipliers that undo each other: beside a Neimark-Sacker that makes
up all that changes, and alone, while both ends of the step look alike."""
Curve = Callable[[float], float]


@dataclass(frozen=True)
class Wave:
    """A constant and a wave of a number."""

    mean: float
    height: float
    rate: float
    phase: float

    def __call__(self, p: float) -> float:
        return self.mean + self.height * float(np.sin(self.rate * p + self.phase))


def found_in(blocks: list[tuple[Curve, Curve]]) -> list[Bifurcation]:
    """What a branch of the map with these sums and products of multipliers says."""
    grid = Grid(made_problem(LOW), (Axis(AMPLITUDE, (LOW, HIGH)),))
    solver = Made(lambda p: [of_trace(t(p), d(p)) for t, d in blocks])
    family = Family(solver, lambda value: grid.with_values((value,)), AMPLITUDE, LOW, HIGH)
    found = trace(family, Seed(LOW, family.at(LOW).map.initial(), 2), most_multiple=1, errors=False)
    assert found is not None
    assert found.branch.ends == ("boundary", "boundary")
    return list(found.branch.bifurcations)


def known_in(blocks: list[tuple[Curve, Curve]]) -> list[tuple[str, float]]:
    """What is there, by closed form, in the sequence of the number."""
    known = []
    for t, d in blocks:
        known += [("flip", p) for p in roots(lambda p, t=t, d=d: 1 + t(p) + d(p))]
        known += [("neimark-sacker", p) for p in roots(lambda p, d=d: d(p) - 1) if abs(t(p)) < 2]
    return sorted(known, key=lambda one: one[1])


def roots(function: Curve) -> list[float]:
    """Roots of a function in the range."""
    values = [function(float(p)) for p in _GRID]
    return [
        float(brentq(function, a, b, xtol=1e-14))
        for a, b, fa, fb in zip(_GRID, _GRID[1:], values, values[1:], strict=False)
        if (fa > 0) != (fb > 0)
    ]


def check(blocks: list[tuple[Curve, Curve]]) -> int:
    """Compare, and give how many are known: all that are found are, and those that are not are near pairs of a kind."""
    known, found = known_in(blocks), sorted(found_in(blocks), key=lambda one: one.value)
    missed = []
    for one in known:
        if found and found[0].kind == one[0] and found[0].value == pytest.approx(one[1], rel=EXACT):
            found.pop(0)
        else:
            missed.append(one)
    assert not found
    assert len(missed) % 2 == 0
    for (kind, value), (other, after) in zip(missed[::2], missed[1::2], strict=True):
        assert kind == other
        assert after - value < NEAR
    return len(known) - len(missed)


def random_blocks(seed: int) -> list[tuple[Curve, Curve]]:
    """Sums and products that wander so that a block has some bifurcations, and never a multiplier of 1."""
    rng = np.random.default_rng((13, seed))
    blocks: list[tuple[Curve, Curve]] = []
    while len(blocks) < 3:
        t, d = (Wave(rng.uniform(-1.5, 0.5), rng.uniform(0, 1), rng.uniform(0, 4), rng.uniform(0, 6)) for _ in range(2))
        d = Wave(rng.uniform(0.2, 1.0), rng.uniform(0, 0.5), rng.uniform(0, 4), rng.uniform(0, 6))
        if all(1 - t(p) + d(p) > 0.1 for p in _GRID[::20]):
            blocks.append((t, d))
    return blocks


def test_a_flip_of_a_pair_that_turns_real_outside_the_circle_is_found() -> None:
    # From a pair of modulus 1.17 at p = 1 to -2.06 and -0.78 at p = 1.25: they meet at 1.08, and one passes -1 at 1.2.
    assert check([(lambda p: -2 - 3.4 * (p - 1), lambda p: 1.36 + p - 1)]) == 1


def test_two_flips_that_undo_each_other_within_a_step_are_found() -> None:
    # A multiplier is below -1 from p = 1.445 to 1.555.
    assert check([(lambda p: -1.53 + 10 * (p - 1.5) ** 2, lambda p: 0.5)]) == 2


@pytest.mark.parametrize("seed", range(8))
def test_a_flip_that_a_multiplier_passes_very_fast_leaves_nothing_unresolved(seed: int) -> None:
    # It is off by up to 1e-5 where the number is exact to 1e-9, and must not count as another one outside the circle.
    rng = np.random.default_rng((17, seed))
    where, slope = rng.uniform(LOW, HIGH), np.exp(rng.uniform(*np.log([3e5, 3e6]))) * rng.choice([-1, 1])

    def fast(p: float) -> float:
        return -1 + 0.5 * float(np.tanh(slope * (p - where)))

    assert check([(lambda p: fast(p) + 0.3, lambda p: 0.3 * fast(p))]) == 1


def test_a_pair_that_leaves_the_circle_and_comes_back_within_a_step_is_found() -> None:
    assert check([(lambda p: 0.3, lambda p: 0.9 + 0.13 * float(np.cos(8 * (p - 1.4))))]) == 2


@pytest.mark.parametrize("third", ["neimark-sacker", "flip"])
def test_two_flips_that_undo_each_other_beside_what_makes_up_all_that_changes_are_found(third: str) -> None:
    # Between 1.56 and 1.99, which is one step, a multiplier comes in through -1 at 1.73 and another goes out at 1.85.
    def passes(slope: float, where: float) -> tuple[Curve, Curve]:
        def own(p: float) -> float:
            return -1 + 0.6 * float(np.tanh(slope * (p - where)))

        return lambda p: own(p) + 0.1, lambda p: 0.1 * own(p)

    pair: tuple[Curve, Curve] = lambda p: 0.3, lambda p: 1 + 0.6 * (p - 1.92)
    assert check([passes(3.0, 1.73), passes(-3.0, 1.85), pair if third == "neimark-sacker" else passes(3.0, 1.92)]) == 3


@pytest.mark.parametrize("seed", [*range(12), *HARD])
def test_the_bifurcations_of_a_random_map_are_found_and_no_others(seed: int) -> None:
    check(random_blocks(seed))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("kind", ["flip", "neimark-sacker"])
def test_bifurcations_that_cannot_be_located_lie_in_parts_that_are_said_to_be_unresolved(
    seed: int, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    check_blind(random_blocks(seed), kind, monkeypatch)


@pytest.mark.parametrize("kind", ["flip", "neimark-sacker"])
@pytest.mark.parametrize("way", [-1, 1])
def test_of_two_bifurcations_at_one_number_one_that_cannot_be_located_is_said_to_be_there(
    kind: str, way: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    flips = lambda p: way * (p - 1.5) - 1.5, lambda p: 0.5
    pair = lambda p: 0.3, lambda p: 1 + 0.5 * (p - 1.5)
    assert {one.kind for one in found_in([flips, pair])} >= {"flip", "neimark-sacker"}
    check_blind([flips, pair], kind, monkeypatch)


def check_blind(blocks: list[tuple[Curve, Curve]], kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Bifurcations of a kind lie in parts that are not resolved if none of that kind is located."""
    locate, known = bifurcations.located, [one.value for one in found_in(blocks) if one.kind == kind]

    def blind(family: Family, first: Place, last: Place, criterion: Criterion) -> Place | None:
        return None if criterion == criteria_of(first)[kind] else locate(family, first, last, criterion)

    monkeypatch.setattr(bifurcations, "located", blind)
    left = found_in(blocks)
    assert all(one.kind != kind for one in left)
    parts = [one for one in left if one.kind == "unresolved"]
    for value in known:
        assert any(abs(part.value - value) <= part.error + EXACT for part in parts)


@pytest.mark.parametrize("seed", range(4))
def test_where_a_multiplier_jumps_past_the_circle_it_is_searched_for_once(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng, searched, locate = np.random.default_rng((18, seed)), list[float](), bifurcations.located
    where, size = rng.uniform(1.2, 1.8), rng.uniform(0.05, 0.4) * rng.choice([-1, 1])

    def jumps(p: float) -> float:
        return -1 + (size if p > where else -size)

    def counted(family: Family, first: Place, last: Place, criterion: Criterion) -> Place | None:
        searched.append(first.value)
        return locate(family, first, last, criterion)

    monkeypatch.setattr(bifurcations, "located", counted)
    (part,) = found_in([(lambda p: jumps(p) + 0.3, lambda p: 0.3 * jumps(p))])
    assert part.kind == "unresolved"
    assert abs(part.value - where) <= part.error + EXACT
    assert len(searched) == 1


@pytest.mark.slow
def test_the_bifurcations_of_random_maps_are_found_and_no_others() -> None:
    drawn = [random_blocks(seed) for seed in range(12, 400)]
    apart = [np.diff([value for _, value in known_in(blocks)]).min(initial=1.0) for blocks in drawn]
    # Nearer to each other than that, a pair may still be within 1e-6 of the circle where the next one lies.
    assert sum(check(blocks) for blocks, least in zip(drawn, apart, strict=True) if least > 1e-3) > 400
