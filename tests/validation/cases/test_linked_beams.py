"""The case `linked-beams`: its roots are what a count finds, and mistakes are noticed."""

from __future__ import annotations

from dataclasses import replace

import pytest
from linked_beams import ExactBeams

from validation.cases import linked_beams
from validation.cases.linked_beams import LINKED, frequencies
from validation.verdict import Verdict

UNLIKE = "unlike cantilevers, spring"


@pytest.mark.parametrize("name", LINKED)
def test_roots_are_the_frequencies_that_are_counted(name: str) -> None:
    pair = LINKED[name]
    exact = ExactBeams(pair.problem, pair.state).frequencies(linked_beams.ROOTS, pair.rigid)
    assert frequencies(pair) == pytest.approx(exact, rel=1e-10)


@pytest.mark.parametrize(
    "changed", [{"translational": 7.00001}, {"torsional": 1e-5}, {"between": ("one:1", "two:0.01")}]
)
def test_another_link_disagrees(changed: dict[str, object], monkeypatch: pytest.MonkeyPatch) -> None:
    right = LINKED[UNLIKE]
    (link,) = right.problem.links
    wrong = replace(right, problem=right.problem.replace(links=(link.model_copy(update=changed),)))
    monkeypatch.setattr(linked_beams, "LINKED", {UNLIKE: wrong})
    assert linked_beams.run("quick", lambda _: None).verdict is Verdict.DISAGREE
