"""The equations of beams with masses and steps, the printed benchmark, and both solvers against them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from exact_beams import ExactBeam

from validation.cases import masses_and_steps
from validation.cases.masses_and_steps import EXACT, by_rayleigh, exact_of, sdll15
from validation.cases.masses_and_steps_equations import CARRYING, broader, stepped_cantilever, tip_mass
from validation.cases.textbook_equations import BEAMS, ROOTS, roots
from validation.references.reading import group
from validation.verdict import Kind, Verdict


def silent(_: str) -> None:
    """Progress that nobody wants."""


@pytest.mark.parametrize("name", CARRYING)
def test_roots_are_the_frequencies_of_exact_members(name: str) -> None:
    beam = CARRYING[name]
    exact = np.sqrt(ExactBeam.of(beam.problem).frequencies(ROOTS))
    assert roots(beam.equation) == pytest.approx(exact, rel=EXACT / 2)  # omega is b squared


def test_equations_have_the_textbooks_beams_as_their_limits() -> None:
    free, pinned = (roots(BEAMS[name].equation) for name in ("clamped-free", "clamped-pinned"))
    assert roots(tip_mass(0.0)) == pytest.approx(free, rel=1e-14)
    assert roots(tip_mass(1e12))[0] == pytest.approx(pinned[0], rel=1e-9)  # the slow mode is below the search
    assert roots(stepped_cantilever(1.0, 1.0)) == pytest.approx(free, rel=EXACT)
    assert roots(broader(1 + 1e-9)) == pytest.approx(roots(math.sin), rel=1e-8)


def test_the_printed_benchmark_is_what_its_theory_gives() -> None:
    """Modes 2 to 4 to half a unit of the last digit; the first one by its approximate formula, 0.13 % below."""
    printed, problem = group("sdll15 answers")["bending"], sdll15()
    exact = np.array(ExactBeam.of(problem).frequencies(ROOTS)) / (2 * math.pi)
    assert exact_of(problem) == pytest.approx(exact, rel=EXACT)
    values = (by_rayleigh(problem), *exact[1:])
    for given, value in zip(printed, values, strict=False):
        assert abs(given.value - value) <= given.half_unit


def test_both_solvers_meet_the_equations() -> None:
    result = masses_and_steps.run("quick", silent)
    assert len(result.checks) == 2 * (ROOTS * len(CARRYING) + 2 * 4)
    assert [check.line for check in result.checks if check.verdict is not Verdict.AGREE] == []
    assert {check.b.kind for check in result.checks} == {Kind.ANALYTICAL, Kind.PUBLISHED}
