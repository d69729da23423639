"""Folds and flips of the bilinear oscillator: a rigid bar against a stop, of one contact a period, in closed form.

The toy solver's bar is that oscillator, and its branches have the closed form's folds and flips to many digits.  Beams
are stiff bars on a pin: at two bending stiffnesses both solvers state their errors, and the bar of none is the limit.
"""

from __future__ import annotations

import numpy as np
import pytest
from bilinear_bars import BENDING, Bar, contacts, draw, matched
from toy import Bar as ToySolver

import analytic
import fe_lapjoint
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.run import Limits
from lapjoint.orbits.branches.tracing import Seed, Traced, trace

AMPLITUDE = "base_motion.amplitude"
EXACT = 1e-7  # of the amplitude: the toy's derivatives are differences
BRIEF = 1e-3  # of a period: a contact in which the toy's differences change what they are taken of
LIKEWISE, MULTIPLIER = 1e-5, 1e-3  # the same of motions that are told by the duration of their contact
MOST = 150  # points of a branch
RATIO = 4.0  # of the two bending stiffnesses
CURVED = 0.2  # share of a change with the bending that is not proportional to 1 / EI
SOLVERS = {"analytic": analytic.Solver(n_modes=2), "fe": fe_lapjoint.Solver(elements=1)}


def traced(solver: object, bar: Bar, bending: float, *, errors: bool) -> Traced:
    """The branch of the bar's seed."""
    problem = bar.problem(bending)
    grid = Grid(problem, (Axis(AMPLITUDE, (bar.low, bar.high)),))
    family = Family(solver, lambda value: grid.with_values((value,)), AMPLITUDE, bar.low, bar.high)
    seed = Seed(bar.seed.amplitude, family.at(bar.seed.amplitude).map.initial(), 2)
    found = trace(family, seed, most_multiple=1, errors=errors, limits=Limits(MOST))
    assert found is not None
    return found


def check_exactly(bar: Bar) -> int:
    """The toy's branch against the closed form, with every motion of one contact; the number of folds and flips."""
    branch = traced(ToySolver(), bar, 1.0, errors=False).branch
    pairs = list(matched(bar, branch))
    for _, known, value, _ in pairs:
        assert value == pytest.approx(known, rel=EXACT)
    for point in branch.points:
        history = point.motion.history
        if contacts(history.contacts) != 1:
            continue
        d = sum(one.end - one.start for one in history.contacts)
        motion = bar.map.motion(d)
        assert point.value == pytest.approx(motion.amplitude, rel=LIKEWISE)
        leading = max(abs(one) for one in motion.multipliers)
        if d > BRIEF * bar.map.period:
            assert abs(point.motion.multipliers[0]) == pytest.approx(leading, rel=MULTIPLIER)
    return len(pairs)


def check_in_the_limit(bar: Bar, solver: analytic.Solver | fe_lapjoint.Solver) -> int:
    """A solver's branches of two stiff bars, taken to the limit, against the closed form; the number of comparisons."""
    of: list[list[tuple[str, float, float, float]]] = []
    for factor in (1.0, RATIO):
        branch = traced(solver, bar, factor * BENDING, errors=True).branch
        pairs = [(*pair[:3], branch.bifurcations[pair[3]].error) for pair in matched(bar, branch)]
        of.append(sorted(pairs, key=lambda pair: pair[:2]))
        for kind, _, _, i in matched(bar, branch):
            one = branch.bifurcations[i]
            before, after = (branch.points[k].motion.multipliers for k in (one.index - 1, one.index))
            outside = [int(np.count_nonzero(np.abs(multipliers) > 1)) for multipliers in (before, after)]
            assert abs(outside[1] - outside[0]) == 1, (kind, one.value)
    assert [pair[:2] for pair in of[0]] == [pair[:2] for pair in of[1]]
    for (_, known, soft, first), (_, _, stiff, second) in zip(*of, strict=True):
        change = stiff - soft
        assert max(first, second) <= 1e-5 * known
        allowed = CURVED * abs(change) + second + (first + second) / (RATIO - 1)
        assert abs(stiff + change / (RATIO - 1) - known) <= allowed
    return len(of[0])


KINDS = pytest.mark.parametrize("kind", ["fold", "flip"])


def test_an_extremum_of_the_amplitude_is_where_a_multiplier_is_one() -> None:
    bar = draw(0, "fold", on_pin=False)
    motion = next(motion for kind, motion in bar.there if kind == "fold")
    assert min(abs(one - 1) for one in motion.multipliers) < 1e-6


@KINDS
def test_the_branches_of_a_bar_have_the_folds_and_flips_of_the_closed_form(kind: str) -> None:
    assert sum(check_exactly(draw(seed, kind, on_pin=False)) for seed in (0,)) >= 1


def test_a_fold_just_before_a_graze_is_found_from_places_at_which_the_number_is_held() -> None:
    assert check_exactly(draw(11, "fold", on_pin=False)) == 1


@pytest.mark.thorough
def test_a_branch_folds_just_before_a_graze_although_a_part_before_that_is_not_resolved() -> None:
    assert check_exactly(draw(32, "fold", on_pin=False)) == 1  # a graze follows the fold by 1e-6 of the amplitude


@pytest.mark.thorough
@pytest.mark.parametrize(("solver", "kind"), [("analytic", "flip"), ("fe", "fold")])
def test_stiff_bars_tend_to_the_folds_and_flips_of_the_closed_form(kind: str, solver: str) -> None:
    assert check_in_the_limit(draw(1, kind, on_pin=True), SOLVERS[solver]) >= 1


@pytest.mark.slow
@KINDS
def test_the_branches_of_many_bars_have_the_folds_and_flips_of_the_closed_form(kind: str) -> None:
    assert sum(check_exactly(draw(seed, kind, on_pin=False)) for seed in range(40)) >= 40


@pytest.mark.slow
@KINDS
@pytest.mark.parametrize("solver", SOLVERS)
def test_many_stiff_bars_tend_to_the_folds_and_flips_of_the_closed_form(kind: str, solver: str) -> None:
    assert sum(check_in_the_limit(draw(seed, kind, on_pin=True), SOLVERS[solver]) for seed in range(15)) >= 12
