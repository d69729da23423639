"""Beside a bifurcation a plain march does what the branch says, on either side.

Random stiff bars touch each of their stops once a period, and their motions are known in closed form.  At both ends of
a range where a symmetry breaks, or a torus is born, a rigid bar is marched by numpy alone, from beside the motion: it
comes back where the branch is stable, and leaves where it is not, by the multipliers that the branch has.  It then ends
on the branch that springs where a symmetry breaks, or on a torus, where nothing repeats.  Beside folds and flips the
solvers march.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import bilinear_bars
import numpy as np
import pytest
from amplitude_ranges import AMPLITUDE, docs_cantilever, from_below, range_of
from contact_bars import ContactBar, draw

import analytic
import fe_lapjoint
from lapjoint import History, branch
from lapjoint.answers import SectionPoint
from lapjoint.campaigns.branches.solve import steady_state
from lapjoint.orbits.branches.bifurcations import Bifurcation
from lapjoint.orbits.branches.errors import value_of
from lapjoint.orbits.branches.point import SAME, CurvePoint
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.branches.starts import of_motion
from lapjoint.orbits.branches.tracing import Traced, trace
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.problem import FloatArray
from lapjoint.problem.files import from_toml
from validation.references.bilinear_map import OneContact

SYMMETRY, TORUS = "symmetry breaking", "neimark-sacker"
PUSH, SMALL = 1e-3, 1e-6  # of the motion: where marches begin, and where they are linear
BACK, AWAY = 0.1, 10.0  # of the push: what is left of it, or has become of it, in the end
LIKE = 0.02  # by so much the multipliers of a beam and of a rigid bar differ at most
MARCHES = 12  # in which deviations show all multipliers
BENT = 0.02  # of a motion: by so much a beam and a rigid bar differ at most
REPEATS = 1e-3  # of a motion: section points as near are one
KEPT, MULTIPLES = 40, 4  # section points on a torus, and periods after which they do not repeat: it may lock to more
COUNT = 30  # bars of each kind in the slow tests
PERIODS = 2000  # of the load, in which what a multiplier of 0.99 leaves falls to 1e-9
SOLVERS = {"analytic": analytic.Solver(n_modes=8), "fe": fe_lapjoint.Solver(elements=4)}
BARS = {"analytic": analytic.Solver(n_modes=2), "fe": fe_lapjoint.Solver(elements=1)}
FAR = 0.5  # of a motion: on a torus it goes no farther


def traced(bar: ContactBar) -> tuple[ParameterRange, Traced]:
    """The branch of a bar from the stable end of its range."""
    start = bar.stable
    of = range_of(from_toml(bar.text(start)), analytic.Solver(n_modes=2), bar.low.amplitude, bar.high.amplitude)
    resolution = of.resolution(start.amplitude)
    half = HalfPeriods(resolution.map(start.amplitude))
    found = trace(of, of_motion(resolution, start.amplitude, half.map.initial(), half.least), 1)
    assert found is not None
    assert found.ends == ("boundary", "boundary")
    return of, found


class March:
    """Marches of a rigid bar around a motion of its own, over the periods that its pieces make up."""

    def __init__(self, bar: ContactBar, motion: OneContact) -> None:
        self.bar, self.map = bar.bar(motion), bar.map
        self.start = self.map.start(motion)
        n = self.start.size // 2
        self.scale = np.repeat([1.0, 1.0 / self.map.omega], n)
        self.size = float(np.linalg.norm(self.scale * self.start))

    def once(self, y: FloatArray) -> FloatArray:
        """(u, u') after the pieces, and its mirror image if the motion mirrors itself."""
        return np.asarray((-1.0 if self.map.mirrored else 1.0) * self.bar.march(self.map.period, *np.split(y, 2)).y)

    def apart(self, y: FloatArray, z: FloatArray) -> float:
        """Distance over the size of the motion."""
        return float(np.linalg.norm(self.scale * (y - z))) / self.size

    def pushed(self, by: float) -> FloatArray:
        """A start beside the motion."""
        direction = 1.0 / self.scale * np.linspace(1.0, -0.5, self.start.size)
        return np.asarray(self.start + by / self.apart(self.start + direction, self.start) * direction)

    def multipliers(self) -> FloatArray:
        """What deviations are multiplied by, from some that are marched: the moduli, the largest first."""
        size, before, after = self.start.size, list[FloatArray](), list[FloatArray]()
        for _ in range(size):
            y = self.start + SMALL * self.size / self.scale * np.eye(size)[len(before) // MARCHES]
            for _ in range(MARCHES):
                before.append(self.scale * (y - self.start))
                y = self.once(y)
                after.append(self.scale * (y - self.start))
        matrix = np.linalg.lstsq(np.array(before), np.array(after), rcond=None)[0]
        return np.asarray(np.sort(np.abs(np.linalg.eigvals(matrix)))[::-1])

    def settled(self, y: FloatArray, times: int) -> FloatArray:
        """Where a march of so many pieces comes to."""
        for _ in range(times):
            y = self.once(y)
        return y


def enough(modulus: float) -> int:
    """Marches after which a deviation has changed thousandfold."""
    return math.ceil(math.log(1e3) / abs(math.log(modulus)))


def check_beside(bar: ContactBar, found: Traced) -> None:
    """Marches from beside the motion at both ends of the range come back or leave, as the branch says."""
    for motion, stable in ((bar.stable, True), (bar.unstable, False)):
        point = min((found.points[0], found.points[-1]), key=lambda one: abs(one.value - motion.amplitude))
        assert point.value == pytest.approx(motion.amplitude, rel=1e-9)
        assert (np.abs(point.multipliers).max() < 1) == stable
        march = March(bar, motion)
        assert march.apart(march.once(march.start), march.start) < 1e-9
        leading = float(np.abs(point.multipliers).max())
        assert march.multipliers()[0] == pytest.approx(leading, rel=LIKE)
        y, times = march.pushed(PUSH), enough(leading)
        if stable:
            assert march.apart(march.settled(y, times), march.start) < BACK * PUSH
            continue
        farthest = 0.0
        for _ in range(times):
            y = march.once(y)
            farthest = max(farthest, march.apart(y, march.start))
            if farthest > AWAY * PUSH:
                break
        assert farthest > AWAY * PUSH


def start_of(point: CurvePoint, bar: ContactBar) -> FloatArray:
    """(u, u') of a beam's motion at its start, at the bar's coordinates."""
    history: History = steady_state(point).history
    ends = [history.problem.beam.length] if bar.bar(bar.at).pinned else [0.0, history.problem.beam.length]
    now = np.array([history.start])
    return np.array([float(of(x, now)[0][0]) for of in (history.displacement, history.velocity) for x in ends])


def check_broken(bar: ContactBar, of: ParameterRange, found: Traced) -> None:
    """The branch that springs is stable, and goes to where the other is not; a march comes to it there."""
    assert is_symmetric(found)
    (start,) = found.starts
    springing = trace(of, start, 1)
    assert springing is not None
    assert springing.ends == ("bifurcation", "boundary")
    assert not is_symmetric(springing)
    first = min((one.index for one in springing.found if isinstance(one.what, Bifurcation)), default=None)
    stable = springing.points[1:first]  # the first one is that of the bifurcation
    assert all(np.abs(point.multipliers).max() < 1 for point in stable)
    last = stable[-1]
    motion = bar.motion(last.value)
    march, moduli = March(bar, motion), [abs(motion.multipliers[0]), float(np.abs(last.multipliers).max())]
    assert moduli[0] > 1
    end = march.settled(march.pushed(PUSH), 2 * enough(moduli[0]) + 4 * enough(moduli[1]))
    expected = start_of(last, bar)
    assert min(march.apart(end, one) for one in (expected, march.once(expected))) < BENT
    assert march.apart(end, march.once(end)) > REPEATS  # its mirror image is another motion
    assert march.apart(end, march.once(march.once(end))) < REPEATS


def is_symmetric(found: Traced) -> bool:
    """Whether the motions of a branch mirror themselves."""
    (half_periods,) = {point.problem.half_periods for point in found.points}
    return half_periods % 2 == 1


def on_torus(bar: ContactBar) -> bool:
    """Whether a march from beside the motion stays near it; then nothing must repeat."""
    march, points = March(bar, bar.unstable), list[FloatArray]()
    y, before = march.pushed(PUSH), 3 * enough(abs(bar.unstable.multipliers[0]))
    for k in range(before + KEPT):
        y = march.once(y)
        if march.apart(y, march.start) > FAR:
            return False
        points += [y] if k >= before else []
    for n in range(1, MULTIPLES + 1):
        assert max(march.apart(a, b) for a, b in zip(points, points[n:], strict=False)) > REPEATS
    return True


def settled(of: ParameterRange, value: float, start: SectionPoint) -> SectionPoint:
    """Where a march from a section point ends."""
    map_ = of.resolution(value).map(value)
    return map_.march(map_.adopted(start), 2 * PERIODS).end


@pytest.mark.parametrize("name", ["analytic", pytest.param("fe", marks=pytest.mark.thorough)])
def test_a_march_on_either_side_of_a_fold_does_what_the_branch_says(name: str) -> None:
    of, found = from_below(docs_cantilever(), SOLVERS[name], 60)
    assert found is not None
    up, down = (one for one in found.found if one.what.kind == "fold")
    lower, upper = found.points[up.index - 1].section(), found.points[down.index].section()
    for value, start, has_contact in (
        (0.999 * value_of(up.what), lower, False),
        (1.001 * value_of(up.what), lower, True),
        (1.001 * value_of(down.what), upper, True),
        (0.999 * value_of(down.what), upper, False),
    ):
        end, map_ = settled(of, value, start), of.resolution(value).map(value)
        assert (abs(map_.march(end, 2).impulses[0]) > 1e-3) == has_contact


@pytest.mark.parametrize("name", ["analytic", pytest.param("fe", marks=pytest.mark.thorough)])
def test_a_march_on_either_side_of_a_flip_does_what_the_branch_says(name: str) -> None:
    bar, solver = bilinear_bars.draw(0, "flip", on_pin=True), BARS[name]
    of, value = range_of(bar.problem(), solver, bar.low, bar.high), bar.seed.amplitude
    resolution = of.resolution(value)
    mother = trace(of, of_motion(resolution, value, resolution.map(value).initial(), 2), 2)
    assert mother is not None
    (flip,) = (one for one in mother.found if one.what.kind == "flip")
    (start,) = mother.starts
    doubled = trace(of, start, 1)
    assert doubled is not None
    assert doubled.ends == ("bifurcation", "boundary")
    there = next(point for point in doubled.points[1:] if np.abs(point.multipliers).max() < 0.9)
    beside = min(mother.points, key=lambda point: abs(point.value - there.value))
    before = 2 * value_of(flip.what) - there.value
    for at, begun in ((there.value, beside.section()), (before, there.section())):
        half, end = HalfPeriods(of.resolution(at).map(at)), settled(of, at, begun)
        assert (half.apart(half.marched(end, 2), end) > REPEATS) == (at == there.value)
        if at == there.value:
            assert min(half.apart(half.map.adopted(image), end) for image in there.sections()) < SAME


@pytest.mark.parametrize("number", [13, pytest.param(10, marks=pytest.mark.thorough)])
def test_a_branch_that_is_come_upon_from_afar_is_the_one_that_springs(number: int) -> None:
    """Starts from the problem's own state lead to both branches; each is there once."""
    bar = draw(number, SYMMETRY)
    far, near = sorted((bar.low.amplitude, bar.high.amplitude), key=lambda one: one == bar.stable.amplitude)
    found = branch(
        from_toml(bar.text(bar.stable)), AMPLITUDE, far, near, options={"n_modes": 2}, errors=False, starts=8
    )
    symmetric = [
        bool(found.symmetric.values[found.branch.values == i].all()) for i in range(found.sizes["branch_number"])
    ]
    assert sorted(symmetric) == [False, True]


def some_more_and_many(some: tuple[int, ...], more: tuple[int, ...]) -> list[Any]:
    """Seeds of bars for every run, for CI, and for slow runs."""
    of_ci, of_slow_runs = pytest.param(more, marks=pytest.mark.thorough), range(COUNT)
    return [some, of_ci, pytest.param(of_slow_runs, marks=pytest.mark.slow)]


@pytest.mark.parametrize("seeds", some_more_and_many((1,), (0, 4, 6, 7)))
def test_marches_beside_the_breaking_of_symmetries_do_what_the_branches_say(seeds: Sequence[int]) -> None:
    for seed in seeds:
        bar = draw(seed, SYMMETRY)
        of, found = traced(bar)
        check_beside(bar, found)
        check_broken(bar, of, found)


@pytest.mark.parametrize("seeds", some_more_and_many((5,), (3, 7, 8)))
def test_marches_beside_neimark_sackers_do_what_the_branches_say(seeds: Sequence[int]) -> None:
    """On the unstable side of half of them, at least, a torus is born."""
    tori = 0
    for seed in seeds:
        bar = draw(seed, TORUS)
        check_beside(bar, traced(bar)[1])
        tori += on_torus(bar)
    assert tori >= len(seeds) / 2
