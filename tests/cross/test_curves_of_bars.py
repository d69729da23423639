"""Bifurcations of curves of stiff bars against the closed form of the rigid bar, which is their limit.

A bar of bending stiffness EI misses the rigid one's amplitudes in proportion to 1 / EI; two of them give the limit.
"""

from __future__ import annotations

import bilinear_bars
import contact_bars
import pytest
from curves import range_of

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Problem
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.curves.bifurcations import Bifurcation
from lapjoint.orbits.curves.errors import AIM, Stated, stated
from lapjoint.orbits.curves.starts import of_motion
from lapjoint.orbits.curves.tracing import Limits, trace
from lapjoint.problem.files import from_toml

RATIO = 4.0  # of the two bending stiffnesses
STIFF = 16.0  # of the softer bar, where one bar's amplitude happens to depend on its bending a hundred times less
CURVED = 0.2  # share of a change with the bending that is not proportional to 1 / EI
KINDS = ["fold", "flip", "symmetry breaking", "neimark-sacker"]
POINTS = 200  # of a branch
SOLVERS = {"analytic": analytic.Solver(n_modes=2), "fe": fe_lapjoint.Solver(elements=1)}


def bifurcations(
    problem: Problem, ends: tuple[float, float], half_periods: int, solver: object
) -> list[tuple[str, Stated]]:
    """Those of the branch of the motion with which a problem begins."""
    assert isinstance(problem.base_motion, BaseMotion)
    value, of = problem.base_motion.amplitude, range_of(problem, solver, *ends)
    resolution = of.resolution(value)
    start = of_motion(resolution, value, resolution.map(value).initial(), half_periods)
    assert start is not None
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
def check(seed: int, kind: str, solver: object) -> None:
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


@pytest.mark.parametrize(
    ("name", "kind"),
    [("analytic", "flip"), ("analytic", "symmetry breaking"), ("fe", "flip"), ("fe", "neimark-sacker")],
)
def test_a_stiff_bar_has_the_closed_form_as_its_limit(name: str, kind: str) -> None:
    check(0, kind, SOLVERS[name])


@pytest.mark.thorough
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["analytic", "fe"])
def test_stiff_bars_have_the_closed_form_as_their_limit(name: str, kind: str) -> None:
    for seed in range(3):
        check(seed, kind, SOLVERS[name])


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["analytic", "fe"])
def test_many_stiff_bars_have_the_closed_form_as_their_limit(name: str, kind: str) -> None:
    for seed in range(3, 15):
        check(seed, kind, SOLVERS[name])
