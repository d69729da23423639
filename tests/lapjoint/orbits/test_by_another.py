"""A bifurcation is found by another solver whose motion, where the first one has it, is no longer critical.

The first solver restores it by its finer selves, as far as they have it where it is said to be.

Maps are made: a fixed point that stands still, with a pair of multipliers that leaves the circle, elsewhere by each
self of the other solver, and the nearer the finer that is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from made_map import Blocks, Made, MadeMap, made_problem, of_trace, pair

from lapjoint import Problem
from lapjoint.answers.branches import Bifurcation, MotionThere
from lapjoint.campaigns import Axis, Grid
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches import by_another_solver, resolving
from lapjoint.orbits.branches.bifurcations import Located
from lapjoint.orbits.branches.by_another_solver import by_another
from lapjoint.orbits.branches.corrector import corrected
from lapjoint.orbits.branches.extremum_search import OnExtremum
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import Again
from lapjoint.orbits.branches.gap_extrema import Extremum
from lapjoint.orbits.branches.listing import Listed
from lapjoint.orbits.branches.locating import Kind
from lapjoint.orbits.branches.restored import restored
from lapjoint.orbits.branches.run import Graze
from lapjoint.orbits.branches.value_errors import AIM, Stated
from lapjoint.orbits.refinement import SAFETY, Refinement

AMPLITUDE, LOW, HIGH, AT = "base_motion.amplitude", 0.9, 1.1, 1.0
ORDER, RATIO = 2.0, 1.5
LEFT = 3.1  # largest error over the shift: thrice what the coarsest self has it apart, and rounding
FINER = 1  # with more, the finer ones come so near that their pair is critical


@dataclass(frozen=True)
class Shifted(Made):
    """A solver that has all of a made map at a number that is larger by `shift`."""

    shift: float = 0.0
    name = "shifted"

    def period_map(self, problem: Problem) -> MadeMap:
        """The map at the amplitude of a problem."""
        return Made(lambda p: self.blocks(p - self.shift)).period_map(problem)

    def finer(self, problem: Problem) -> tuple[Refinement, Shifted]:
        """One finer solver."""
        return Refinement("made", RATIO, ORDER), replace(self, shift=self.shift / RATIO**ORDER)


def family_of(solver: Made) -> Family:
    """Its maps over the range."""
    grid = Grid(made_problem(LOW), (Axis(AMPLITUDE, (LOW, HIGH)),))
    return Family(solver, lambda value: grid.with_values((value,)), AMPLITUDE, LOW, HIGH)


def found_by_another(blocks: Blocks, solver: Shifted, finer: int = FINER) -> Stated | None:
    """The Neimark-Sacker bifurcation at `AT`, by a solver that has it elsewhere, or not at all."""
    own, other = family_of(Made(blocks)), family_of(solver)
    place = corrected(own, AT, own.at(AT).map.initial(), 2)
    assert place is not None
    one = Listed(own, Bifurcation("neimark-sacker", AT, 0.0, 0), Located("neimark-sacker", place))
    return by_another(one, other, finer)


def judge(blocks: Blocks, shift: float) -> None:
    found = found_by_another(blocks, Shifted(blocks, shift))
    assert found is not None
    assert abs(found.value - AT) <= found.error <= LEFT * abs(shift)


@pytest.mark.parametrize("seed", range(20))
def test_a_pair_that_is_off_the_circle_there_is_followed_to_it(seed: int) -> None:
    rng = np.random.default_rng((81, seed))
    rate, shift, angle = rng.choice([-1, 1]) * rng.uniform(200, 500), rng.choice([-1, 1]) * 1e-3, rng.uniform(0.5, 2.5)
    judge(lambda p: [pair(float(np.exp(rate * (p - AT))), angle), pair(0.3, 1.0)], shift)


@pytest.mark.parametrize("seed", range(20))
def test_a_pair_that_is_real_there_is_found_beside_it(seed: int) -> None:
    """It is critical as it leaves the circle near -1; a little farther, it is two real numbers."""
    rng = np.random.default_rng((82, seed))
    side, shift = rng.choice([-1, 1]), 1e-4
    trace_rate, product_rate, trace = rng.uniform(6e3, 1e4), rng.uniform(5e2, 2e3), rng.uniform(-1.7, -1.5)

    def blocks(p: float) -> list[np.ndarray]:
        d = side * (p - AT)
        return [
            of_trace(float(np.clip(trace + trace_rate * d, -3.0, 3.0)), float(np.exp(product_rate * d))),
            pair(0.3, 1.0),
        ]

    judge(blocks, side * shift)


@pytest.mark.parametrize("seed", range(20))
def test_a_neighbour_is_not_taken_for_one_that_the_other_solver_lacks(seed: int) -> None:
    """Both have the same angle at the circle, and nothing else tells them apart but the way back."""
    rng = np.random.default_rng((85, seed))
    angle, rate, beside = rng.uniform(0.5, 2.5), rng.uniform(5, 50), rng.choice([-1, 1]) * rng.uniform(6e-4, 2e-3)

    def neighbour(p: float) -> np.ndarray:
        return pair(float(np.exp(rate * (p - AT - beside))), angle)

    lacking = Shifted(lambda p: [pair(0.3, angle), neighbour(p)])
    assert found_by_another(lambda p: [pair(float(np.exp(-rate * (p - AT))), angle), neighbour(p)], lacking) is None


@dataclass(frozen=True)
class Patchy(Shifted):
    """The same, of which some selves lack what is critical."""

    lacks: frozenset[int] = frozenset()
    level: int = 0

    def period_map(self, problem: Problem) -> MadeMap:
        """The map at the amplitude of a problem."""
        if self.level in self.lacks:
            return Made(lambda p: [pair(0.3, 1.0)] * 2).period_map(problem)
        return super().period_map(problem)

    def finer(self, problem: Problem) -> tuple[Refinement, Patchy]:
        """One finer solver."""
        refinement, finer = super().finer(problem)
        return refinement, replace(self, shift=finer.shift, level=self.level + 1)


@pytest.mark.parametrize("seed", range(20))
def test_where_one_self_lacks_a_bifurcation_the_one_before_it_gives_the_error(seed: int) -> None:
    """Finite elements with 137 and 309 elements had one of the joint's folds, and those with 206 had not."""
    rng = np.random.default_rng((86, seed))
    rate, angle = rng.choice([-1, 1]) * rng.uniform(200, 500), rng.uniform(0.5, 2.5)
    shift = rng.choice([-1, 1]) * 10 ** rng.uniform(-8, -5.6)

    def blocks(p: float) -> list[np.ndarray]:
        return [pair(float(np.exp(rate * (p - AT))), angle), pair(0.3, 1.0)]

    for lacks, last in ((set(), 2), ({1}, 2), ({2}, 3)):
        found = found_by_another(blocks, Patchy(blocks, shift, frozenset(lacks)), last)
        assert found is not None
        assert abs(found.value - AT) <= found.error <= LEFT * abs(shift)
        assert found.error == pytest.approx(SAFETY * abs(shift), rel=1e-2, abs=1e-8)  # the coarser one's error is known
    for lacks in ({0, 1}, {1, 2, 3}, {0, 1, 2}):
        found = found_by_another(blocks, Patchy(blocks, shift, frozenset(lacks)), max(lacks) + 1)
        assert found is not None
        assert found.value == pytest.approx(AT, abs=abs(shift))
        assert np.isinf(found.error)
    far = found_by_another(blocks, Patchy(blocks, 1e3 * shift, frozenset({1})), 2)
    assert far is None or np.isinf(far.error) or far.error <= AIM * AT


def test_what_a_solver_without_finer_selves_finds_has_no_error() -> None:
    def blocks(p: float) -> list[np.ndarray]:
        return [pair(float(np.exp(300 * (p - AT))), 1.0), pair(0.3, 1.0)]

    found = found_by_another(blocks, Shifted(blocks, 1e-6), 0)
    assert found is not None
    assert found.value == pytest.approx(AT + 1e-6, abs=1e-8)
    assert np.isinf(found.error)
    assert found_by_another(blocks, Patchy(blocks, 1e-6, frozenset({0})), 0) is None


@pytest.mark.parametrize(("error", "value"), [(np.inf, AT), (1e-3, AT + 0.05)])
def test_what_is_found_along_a_curve_counts_only_if_it_is_surer(
    monkeypatch: pytest.MonkeyPatch, error: float, value: float
) -> None:
    """The finest elements had one of the joint's folds from its motion; along their curve they came to another."""

    def blocks(p: float) -> list[np.ndarray]:
        return [pair(float(np.exp(300 * (p - AT))), 1.0), pair(0.3, 1.0)]

    monkeypatch.setattr(by_another_solver._Search, "_along", lambda search: Stated(AT + 0.05, error))
    found = found_by_another(blocks, Patchy(blocks, 1e-6, frozenset({0, 1})), 2)
    assert found is not None
    assert found.value == pytest.approx(value, abs=1e-6)
    assert found.error == error


@pytest.mark.parametrize(
    ("answer", "value", "error"),
    [(Stated(AT + 2e-6, 1e-7), AT + 2e-6, 1e-7), (Stated(AT + 2e-6, 1e-3), AT, 1e-9), (None, AT, 1e-9)],
)
def test_what_two_may_have_alike_by_chance_is_asked_for_again_once(
    monkeypatch: pytest.MonkeyPatch, answer: Stated | None, value: float, error: float
) -> None:
    """What finer selves are sure of takes its place, and nothing else does."""
    asked = list[object]()

    def by_finer(one: Listed, *_: object) -> Stated | None:
        asked.append(one)
        return answer

    monkeypatch.setattr(resolving, "by_another", by_finer)
    own = family_of(Made(lambda p: [pair(float(np.exp(300 * (p - AT))), 1.0), pair(0.3, 1.0)]))
    place = corrected(own, AT, own.at(AT).map.initial(), 2)
    assert place is not None
    said = Bifurcation("neimark-sacker", AT, 1e-9, 0)
    sure = Listed(own, said, Located("neimark-sacker", place))
    assert resolving.asked_again(sure) is sure
    assert not sure.to_be_asked
    assert not asked
    unsure = replace(sure, sure=False)
    assert unsure.to_be_asked
    again = resolving.asked_again(unsure)
    assert asked
    assert (again.bifurcation.value, again.bifurcation.error) == (value, error)
    assert not again.to_be_asked
    whole = resolving._all_asked_again(resolving.Resolved([place], [sure, unsure], [own], ("", "")))
    assert [(one.bifurcation.value, one.bifurcation.error) for one in whole.bifurcations] == [
        (AT, 1e-9),
        (value, error),
    ]


@pytest.mark.parametrize("from_one", [1, 2, 3])
def test_what_coarse_selves_find_does_not_count_where_finer_ones_come_to_a_rival(
    monkeypatch: pytest.MonkeyPatch, from_one: int
) -> None:
    """Coarse finite elements had the neighbour of a fold 2.2e-4 rad/s off, which finer ones told from it."""

    def blocks(p: float) -> list[np.ndarray]:
        return [pair(float(np.exp(300 * (p - AT))), 1.0), pair(0.3, 1.0)]

    far = Patchy(blocks, 1e-4)  # too far apart for a sure answer by the coarse ones
    found = found_by_another(blocks, far, 3)
    assert found is not None
    assert abs(found.value - AT) <= found.error
    monkeypatch.setattr(by_another_solver._Search, "_is_nearest", lambda _, i, *rest: i < from_one)
    assert found_by_another(blocks, far, 3) is None


def touched_graze() -> tuple[Listed, Family]:
    """A graze that a made motion touches; only how it is looked for from beyond matters."""
    own, other = (family_of(Made(lambda p: [pair(0.3, 1.0), pair(0.3, 1.0)])) for _ in range(2))
    place = corrected(own, AT, own.at(AT).map.initial(), 2)
    assert place is not None
    place.__dict__["closings"] = (1,)
    before = OnExtremum(place, Extremum(0, 0.1, 1e-9, True, 0), 1.0)
    assert before.touched
    return Listed(own, Bifurcation("grazing", AT, 0.0, 0, 0), Graze(0, AT, "persists", before, -1.0, 1)), other


@pytest.mark.parametrize("error", [SolverError("lost"), InputError("left")])
def test_a_graze_that_is_not_found_beyond_is_looked_for_from_before(
    monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    def lost(*_: object) -> None:
        raise error

    monkeypatch.setattr(by_another_solver, "seen_from_beyond", lost)
    monkeypatch.setattr(by_another_solver._Search, "_direct", lambda _: Stated(AT, 1e-7))
    assert by_another(*touched_graze()) == Stated(AT, 1e-7)


def test_what_is_left_of_the_marches_is_for_a_graze_seen_from_beyond() -> None:
    """Seen so, the search is another one."""
    left = list[float]()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(by_another_solver, "seen_from_beyond", lambda _, graze: graze)
        patch.setattr(by_another_solver._Search, "_direct", lambda it: left.append(it.marches - it._marched))
        search = by_another_solver._Search(*touched_graze(), 1, 1, 100.0)
        search.family.marches += 30
        assert search._from_beyond() is None
    assert left == [70.0]


@dataclass(frozen=True)
class OneGraze:
    """A branch with one graze beside a bifurcation, and nothing to follow."""

    grazes: tuple[object, ...] = (None,)
    sides: tuple[object, ...] = ()


class MadeBeside:
    """What selves find beside a graze: the bifurcation as each has it, but for some that lack it."""

    def __init__(self, own: Family, one: Located, lacks: frozenset[int]) -> None:
        self.own, self.one, self.lacks, self.asked = own, one, lacks, list[int]()

    def found_by(self, family: Family) -> Again | None:
        """What one self finds."""
        self.asked.append(family.level)
        family.marches += 1
        shift = family.zones[0].solver.shift
        return None if family.level in self.lacks else Again(self.one.place, AT + shift)


def beside(
    lacks: frozenset[int], shift: float, own_selves: bool, marches: float = np.inf
) -> tuple[Stated | None, list[int]]:
    """What selves say of a bifurcation that each finds only beside a graze, and which of them have been asked."""

    def blocks(p: float) -> list[np.ndarray]:
        return [pair(float(np.exp(300 * (p - AT))), 1.0), pair(0.3, 1.0)]

    other = family_of(Shifted(blocks, shift))
    own = other if own_selves else family_of(Made(blocks))
    place = corrected(own, AT, own.at(AT).map.initial(), 2)
    assert place is not None
    one = Located("neimark-sacker", place)
    made = MadeBeside(own, one, lacks)
    listed = Listed(own, Bifurcation("neimark-sacker", AT, 0.0, 0), one, way=OneGraze())
    search = by_another_solver._Search(listed, other, 3, 3, marches)
    return search._from_graze(made), made.asked


@pytest.mark.parametrize("seed", range(20))
def test_beside_a_graze_one_self_may_lack_what_both_beside_it_have(seed: int) -> None:
    """Finite elements with 206 and 464 elements had one of the joint's flips, and those with 309 had not."""
    rng = np.random.default_rng((87, seed))
    shift = rng.choice([-1, 1]) * 10 ** rng.uniform(-8, -5.6)
    for lacks, asked in (((), [0, 1]), ((1,), [0, 1, 2]), ((0,), [0, 1, 2]), ((0, 2), [0, 1, 2, 3])):
        found, whom = beside(frozenset(lacks), shift, own_selves=False)
        assert found is not None
        assert whom == asked
        assert abs(found.value - AT) <= found.error <= LEFT * abs(shift)
    for lacks, asked in (((0, 1), [0, 1, 2, 3]), ((1, 2), [0, 1, 2]), ((0, 1, 2), [0, 1, 2]), ((1, 2, 3), [0, 1, 2])):
        found, whom = beside(frozenset(lacks), shift, own_selves=False)
        assert (found is not None) == (lacks == (0, 1))
        assert whom == asked  # the finest is not asked where nothing tells its error
    for lacks, asked in (((0,), [0, 1, 2]), ((1,), [0, 1, 2, 3]), ((0, 2), [0, 1, 2])):
        found, whom = beside(frozenset(lacks), shift, own_selves=True)
        assert (found is not None) == (lacks != (0, 2))  # of the first solver, two must agree that follow each other
        assert whom == asked


def test_beside_a_graze_a_pair_that_is_begun_is_asked_though_the_marches_are_spent() -> None:
    for own_selves in (False, True):
        assert beside(frozenset(), 1e-3, own_selves, marches=1)[1] == [0, 1]
        assert beside(frozenset({0}), 1e-3, own_selves, marches=1)[1] == [0]
        assert beside(frozenset({0}), 1e-3, own_selves, marches=2)[1] == [0, 1, 2]
        assert beside(frozenset(), 1e-3, own_selves, marches=0)[1] == []


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("kind", ["flip", "neimark-sacker"])
def test_a_bifurcation_is_restored_where_it_is_said_to_be(kind: Kind, seed: int) -> None:
    """The motion is that of the coarsest self, the number that of the next, or of one much finer, with a small error.

    A number from which finer selves lie farther changes nothing.
    """
    rng = np.random.default_rng((84, seed))
    shift, angle, rate = rng.choice([-1, 1]) * 10 ** rng.uniform(-5, -3), rng.uniform(0.5, 2.5), rng.uniform(5, 50)
    family = family_of(Shifted(lambda p: [critical(kind, rate * (p - AT), angle), pair(0.3, 1.0)], shift))
    motion = MotionThere(AT + shift, family.at(AT + shift).map.initial(), 2)
    finest = shift * RATIO ** (-2 * ORDER)
    near, far, error = AT + shift / RATIO**ORDER, AT + 3 * shift, abs(shift)
    for value, stated, off in ((near, error, finest), (AT, 1e-6 * error, finest), (far, error, shift)):
        one = restored(family, Bifurcation(kind, value, stated, 0, motion=motion))
        assert one is not None
        assert isinstance(one.found, Located)
        assert one.found.place.value - AT == pytest.approx(off, rel=1e-3)


def critical(kind: Kind, logarithm: float, angle: float) -> np.ndarray:
    """The multiplier, or the pair, whose modulus has a logarithm."""
    return np.array([[-np.exp(logarithm)]]) if kind == "flip" else pair(float(np.exp(logarithm)), angle)


def two_flips(at: float, beside: float, rate: float) -> Blocks:
    """One multiplier that leaves the circle at -1, and one that enters it a little farther."""
    return lambda p: [critical("flip", rate * (p - at), 0.0), critical("flip", -rate * (p - at - beside), 0.0)]


def flip_by_another(own: Family, values: tuple[float, ...], other: Family) -> Stated | None:
    """The flip at the first of some values, by a solver that may take it for those at the others."""
    place, *rivals = (corrected(own, value, own.at(value).map.initial(), 2) for value in values)
    assert place is not None
    known = tuple(rival for rival in rivals if rival is not None)
    one = Listed(own, Bifurcation("flip", values[0], 0.0, 0), Located("flip", place), rivals=known)
    return by_another(one, other, FINER)


@pytest.mark.parametrize("seed", range(20))
def test_of_two_that_are_close_together_each_is_found_as_itself(seed: int) -> None:
    """The other solver has both, off by less than half of their distance, or has the second one alone."""
    rng = np.random.default_rng((87, seed))
    beside, rate = rng.choice([-1, 1]) * 10 ** rng.uniform(-4.3, -3.6), rng.choice([-1, 1]) * rng.uniform(5, 50)
    own, shift = family_of(Made(two_flips(AT, beside, rate))), 0.2 * beside
    both = family_of(Shifted(two_flips(AT, beside, rate), shift))
    alone = family_of(Shifted(lambda p: [np.array([[0.3]]), two_flips(AT, beside, rate)(p)[1]]))
    for values in ((AT, AT + beside), (AT + beside, AT)):
        found = flip_by_another(own, values, both)
        assert found is not None
        assert abs(found.value - values[0]) <= abs(shift)
    assert flip_by_another(own, (AT,), alone) is not None  # so near that the way back is not asked for
    assert flip_by_another(own, (AT, AT + beside), alone) is None
