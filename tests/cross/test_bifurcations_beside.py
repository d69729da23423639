"""Where a symmetry breaks, and where a torus is born: both solvers, closed form, and on either side a plain march.

Random stiff bars touch each of their stops once a period, and their motions are known in closed form; both solvers
state their errors, and bars of two bending stiffnesses have the rigid one as their limit.  At both ends of the range a
rigid bar is marched by numpy alone, from beside the motion: it comes back where the branch is stable, and leaves where
it is not, by the multipliers that the branch has.  It then ends on the branch that springs where a symmetry breaks, or
on a torus, where nothing repeats.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from contact_bars import BENDING, ContactBar, draw

import analytic
import fe_lapjoint
from lapjoint import History
from lapjoint.answers.branches import Branch
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.seeds import on_branch, springs_where
from lapjoint.orbits.branches.tracing import Seed, Traced, trace
from lapjoint.problem import FloatArray
from lapjoint.problem.files import from_toml
from validation.references.bilinear_map import OneContact

AMPLITUDE = "base_motion.amplitude"
SYMMETRY, TORUS = "symmetry breaking", "neimark-sacker"
SOLVERS = {"analytic": analytic.Solver(n_modes=2), "fe": fe_lapjoint.Solver(elements=1)}
RATIO = 4.0  # of the two bending stiffnesses
CURVED = 0.2  # share of a change with the bending that is not proportional to 1 / EI
CANCELS = 1e-6  # of the amplitude: a change that is as small may be what is left of two that cancel
PUSH, SMALL = 1e-3, 1e-6  # of the motion: where marches begin, and where they are linear
BACK, AWAY = 0.1, 10.0  # of the push: what is left of it, or has become of it, in the end
LIKE = 0.02  # by so much the multipliers of a beam and of a rigid bar differ at most
MARCHES = 12  # in which deviations show all multipliers
BENT = 0.02  # of a motion: by so much a beam and a rigid bar differ at most
REPEATS = 1e-3  # of a motion: section points as near are one
KEPT, MULTIPLES = 40, 4  # section points on a torus, and periods after which they do not repeat: it may lock to more
COUNT = 30  # bars of each kind in the slow tests
FAR = 0.5  # of a motion: on a torus it goes no farther


def traced(solver: object, bar: ContactBar, *, bending: float = BENDING) -> tuple[Family, Traced]:
    """The branch of a bar from the stable end of its range."""
    low, high, start = bar.low.amplitude, bar.high.amplitude, bar.stable
    grid = Grid(from_toml(bar.text(start, bending)), (Axis(AMPLITUDE, (low, high)),))
    family = Family(solver, lambda value: grid.with_values((value,)), AMPLITUDE, low, high)
    half = family.at(start.amplitude)
    found = trace(family, Seed(start.amplitude, half.map.initial(), half.least), most_multiple=1)
    assert found is not None
    assert found.branch.ends == ("boundary", "boundary")
    return family, found


def only(branch: Branch, kind: str) -> tuple[float, float]:
    """Value and error of the one bifurcation of a branch."""
    assert [one.kind for one in branch.bifurcations] == [kind]
    value, error = branch.bifurcations[0].value, branch.bifurcations[0].error
    assert error <= 1e-5 * value
    return value, error


def check_values(bar: ContactBar, kind: str) -> tuple[Family, Traced]:
    """The bifurcation by both solvers and by closed form; the branch of the analytic one."""
    (family, found), (_, other) = (traced(solver, bar) for solver in SOLVERS.values())
    value, error = only(found.branch, kind)
    beside = only(other.branch, kind)
    assert abs(value - beside[0]) <= error + beside[1]
    stiff, less = only(traced(SOLVERS["analytic"], bar, bending=RATIO * BENDING)[1].branch, kind)
    change = stiff - value
    allowed = CURVED * abs(change) + CANCELS * stiff + less + (less + error) / (RATIO - 1)
    assert abs(stiff + change / (RATIO - 1) - bar.at.amplitude) <= allowed
    return family, found


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


def check_beside(bar: ContactBar, branch: Branch) -> None:
    """Marches from beside the motion at both ends of the range come back or leave, as the branch says."""
    for motion, stable in ((bar.stable, True), (bar.unstable, False)):
        (point,) = (one for one in branch.points if one.value == pytest.approx(motion.amplitude, rel=1e-9))
        assert point.motion.stable == stable
        march, over = March(bar, motion), 0.5 if bar.map.mirrored else 1.0
        assert march.apart(march.once(march.start), march.start) < 1e-9
        leading = float(np.abs(point.motion.multipliers).max()) ** over
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


def start_of(history: History, bar: ContactBar) -> FloatArray:
    """(u, u') of a beam's motion at its start, at the bar's coordinates."""
    ends = [history.problem.beam.length] if bar.bar(bar.at).pinned else [0.0, history.problem.beam.length]
    now = np.array([history.start])
    return np.array([float(of(x, now)[0][0]) for of in (history.displacement, history.velocity) for x in ends])


def check_broken(bar: ContactBar, family: Family, found: Traced) -> None:
    """The branch that springs is stable, and goes to where the other is not; a march comes to it there."""
    assert all(point.motion.symmetric for point in found.branch.points)
    (seed,) = found.seeds
    springing = trace(family, seed, most_multiple=1, errors=False)
    assert springing is not None
    branch = springing.branch
    assert branch.ends == ("bifurcation", "boundary")
    assert not any(point.motion.symmetric for point in branch.points)
    first = min((one.index for one in branch.bifurcations), default=len(branch.points))
    assert all(point.motion.stable for point in branch.points[:first])
    last = branch.points[first - 1]
    motion = bar.motion(last.value)
    march, moduli = March(bar, motion), [abs(motion.multipliers[0]), float(np.abs(last.motion.multipliers).max())]
    assert moduli[0] > 1
    end = march.settled(march.pushed(PUSH), 2 * enough(moduli[0]) + 4 * enough(moduli[1]))
    expected = start_of(last.motion.history, bar)
    assert min(march.apart(end, one) for one in (expected, march.once(expected))) < BENT
    assert march.apart(end, march.once(end)) > REPEATS  # its mirror image is another motion
    assert march.apart(end, march.once(march.once(end))) < REPEATS


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


def check_symmetry(seed: int) -> None:
    """All of it for one bar between two stops."""
    bar = draw(seed, SYMMETRY)
    family, found = check_values(bar, SYMMETRY)
    check_beside(bar, found.branch)
    check_broken(bar, family, found)


def check_torus(seed: int) -> bool:
    """All of it for one bar on springs; whether a torus is born on the unstable side."""
    bar = draw(seed, TORUS)
    check_beside(bar, check_values(bar, TORUS)[1].branch)
    return on_torus(bar)


def test_a_branch_from_an_end_of_its_range_begins_there_with_nothing_unresolved() -> None:
    bar = draw(1, SYMMETRY)
    branch = traced(SOLVERS["analytic"], bar)[1].branch
    assert [one.kind for one in branch.bifurcations] == [SYMMETRY]
    assert {point.value for point in branch.points} >= {bar.low.amplitude, bar.high.amplitude}


@pytest.mark.parametrize("number", [13, pytest.param(10, marks=pytest.mark.thorough)])
def test_a_branch_that_is_known_from_afar_is_known_where_it_springs(number: int) -> None:
    family, found = traced(SOLVERS["analytic"], draw(number, SYMMETRY))
    (seed,) = found.seeds
    springing = trace(family, seed, most_multiple=1, errors=False)
    assert springing is not None
    last = springing.branch.points[-1]
    again = trace(family, Seed(last.value, last.motion.section_point, seed.count), most_multiple=1, errors=False)
    assert again is not None
    points = again.branch.points
    values, sections = [one.value for one in points], [one.motion.section_point for one in points]
    springs = springs_where(family, seed, again.springs, seed.count)
    assert springs or on_branch(family, seed, values, sections, seed.count)


def test_a_march_beside_the_breaking_of_a_symmetry_does_what_the_branch_says() -> None:
    check_symmetry(1)


def test_a_march_beside_a_neimark_sacker_does_what_the_branch_says() -> None:
    assert check_torus(5)


@pytest.mark.thorough
def test_marches_beside_the_breaking_of_symmetries_do_what_the_branches_say() -> None:
    for seed in (0, 4, 6, 7):
        check_symmetry(seed)


@pytest.mark.thorough
def test_marches_beside_neimark_sackers_do_what_the_branches_say() -> None:
    assert sum(check_torus(seed) for seed in (3, 7, 8)) >= 2


@pytest.mark.slow
def test_marches_beside_the_breaking_of_many_symmetries_do_what_the_branches_say() -> None:
    for seed in range(COUNT):
        check_symmetry(seed)


@pytest.mark.slow
def test_marches_beside_many_neimark_sackers_do_what_the_branches_say() -> None:
    assert sum(check_torus(seed) for seed in range(COUNT)) >= COUNT // 2
