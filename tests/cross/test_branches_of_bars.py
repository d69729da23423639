"""Bifurcations of rigid bars that touch a stop once a period, against the bilinear oscillator's closed forms.

Over the arcs of the rigid bar the program has the closed form itself.  Both solvers have beams: a bar of bending
stiffness EI misses the rigid one's amplitudes in proportion to 1 / EI, and two of them give the limit.
"""

from __future__ import annotations

import bilinear_bars
import contact_bars
import pytest
from amplitude_ranges import range_of
from few_and_many import few_and_many
from rigid_bar_arcs import RigidBarResolution, Steps, steps

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Problem
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.orbits.branches.bifurcations import Bifurcation
from lapjoint.orbits.branches.errors import AIM, Stated, stated
from lapjoint.orbits.branches.starts import of_motion
from lapjoint.orbits.branches.tracing import Limits, trace
from lapjoint.problem.files import from_toml
from validation.references.bilinear_map import BilinearMap, OneContact

EXACT = 2e-9  # of the amplitude: motions are solved, and bifurcations located, to 1e-9 of arclength each
MULTIPLIER = 1e-3  # likewise: Newton's method keeps a derivative from 1e-5 of arclength away, in which they change most
BRIEF = 1e-3  # of a period: a shorter contact, up to a graze, is known less closely by the closed form
RATIO = 4.0  # of the two bending stiffnesses
STIFF = 16.0  # of the softer bar, where one bar's amplitude happens to depend on its bending a hundred times less
CURVED = 0.2  # share of a change with the bending that is not proportional to 1 / EI
KINDS = ["fold", "flip", "symmetry breaking", "neimark-sacker"]
POINTS = 200  # of a branch
Known = tuple[str, OneContact]
"""Kind of a bifurcation, and the motion there, by closed form."""
SOLVERS = {"analytic": analytic.Solver(n_modes=2), "fe": fe_lapjoint.Solver(elements=1)}


def rigid(seed: int, kind: str) -> tuple[BilinearMap, Steps, list[Known], list[Known]]:
    """A rigid bar, its branch, the bifurcations that must be on the branch, and all that may be."""
    if kind in ("fold", "flip"):
        bar = bilinear_bars.draw(seed, kind, on_pin=False)
        resolution = RigidBarResolution.of(bar.problem(), bar.low, bar.high)
        found = steps(resolution.start(bar.map, bar.seed), POINTS)
        return bar.map, found, [*bar.there], [*bar.there, *bar.elsewhere]
    one = contact_bars.draw(seed, kind)
    resolution = RigidBarResolution.of(from_toml(one.text(one.stable)), one.low.amplitude, one.high.amplitude)
    must: list[Known] = [("flip" if kind == "symmetry breaking" else kind, one.at)]
    return one.map, steps(resolution.start(one.map, one.stable), POINTS), must, must


def check_exactly(seed: int, kind: str) -> int:
    """All of a branch against the closed form; the number of bifurcations."""
    known, found, must, may = rigid(seed, kind)
    for its in must:
        assert any(is_same(one, its) for one in found.bifurcations), (seed, its[0], its[1].amplitude)
    for one in found.bifurcations:
        assert any(is_same(one, its) for its in may), (seed, one.kind, one.point.value)
    for point in (one for one in found.points if one.shares[1] > BRIEF):
        motion = known.motion(float(point.durations[1]))
        assert point.value == pytest.approx(motion.amplitude, rel=EXACT)
        for multiplier in motion.multipliers:
            assert abs(point.multipliers - multiplier).min() <= MULTIPLIER * max(1.0, abs(multiplier))
    return len(found.bifurcations)


def is_same(one: Bifurcation, known: Known) -> bool:
    """Whether a bifurcation is one of the closed form."""
    kind, motion = known
    return one.kind == kind and abs(one.point.value - motion.amplitude) <= EXACT * motion.amplitude


def bifurcations(
    problem: Problem, ends: tuple[float, float], half_periods: int, solver: object
) -> list[tuple[str, Stated]]:
    """Those of the branch of the motion with which a problem begins."""
    assert isinstance(problem.base_motion, BaseMotion)
    value, of = problem.base_motion.amplitude, range_of(problem, solver, *ends)
    resolution = of.resolution(value)
    start = of_motion(resolution, value, resolution.map(value).initial(), half_periods)
    traced = trace(of, start, 1, Limits(POINTS))
    assert traced is not None
    return [(one.what.kind, stated(one.what)) for one in traced.found if isinstance(one.what, Bifurcation)]


def compare(known: float, kind: str, *found: list[tuple[str, Stated]]) -> None:
    """Those of two bendings that are nearest to the closed form have it as their limit, within their errors."""
    first, second = (
        min((one for what, one in each if what == kind), key=lambda one: abs(one.value - known)) for each in found
    )
    change = second.value - first.value
    assert max(first.error, second.error) <= AIM * known
    allowed = CURVED * abs(change) + second.error + (first.error + second.error) / (RATIO - 1)
    assert abs(second.value + change / (RATIO - 1) - known) <= allowed, (kind, known)


@in_one_thread
def check_in_the_limit(seed: int, kind: str, solver: object) -> None:
    """The bifurcations that are joined to the seed of one bar."""
    if kind in ("fold", "flip"):
        bar = bilinear_bars.draw(seed, kind, on_pin=True)
        problems = [bar.problem(factor * bilinear_bars.BENDING) for factor in (1.0, RATIO)]
        soft, stiff = (bifurcations(problem, (bar.low, bar.high), 2, solver) for problem in problems)
        for name, motion in bar.there:
            compare(motion.amplitude, name, soft, stiff)
        return
    one = contact_bars.draw(seed, kind)
    texts = [one.text(one.stable, factor * STIFF * contact_bars.BENDING) for factor in (1.0, RATIO)]
    breaks = kind == "symmetry breaking"
    ends = one.low.amplitude, one.high.amplitude
    soft, stiff = (bifurcations(from_toml(text), ends, 1 if breaks else 2, solver) for text in texts)
    compare(one.at.amplitude, "flip" if breaks else kind, soft, stiff)


@pytest.mark.parametrize("seeds", few_and_many(range(1), range(1, 40)))
@pytest.mark.parametrize(
    "kind", [pytest.param(it, marks=pytest.mark.thorough if it == "neimark-sacker" else ()) for it in KINDS]
)
def test_the_branches_of_rigid_bars_are_those_of_the_closed_form(kind: str, seeds: range) -> None:
    assert sum(check_exactly(seed, kind) for seed in seeds) >= len(seeds)


@pytest.mark.parametrize(
    ("name", "kind"),
    [("analytic", "flip"), ("analytic", "symmetry breaking"), ("fe", "neimark-sacker")],
)
def test_a_stiff_bar_has_the_closed_form_as_its_limit(name: str, kind: str) -> None:
    check_in_the_limit(0, kind, SOLVERS[name])


@pytest.mark.parametrize(
    "seeds", [pytest.param(range(2), marks=pytest.mark.thorough), pytest.param(range(2, 15), marks=pytest.mark.slow)]
)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", SOLVERS)
def test_stiff_bars_have_the_closed_form_as_their_limit(name: str, kind: str, seeds: range) -> None:
    for seed in seeds:
        check_in_the_limit(seed, kind, SOLVERS[name])
