"""A march from rest tells of a search that accepts too much."""

from __future__ import annotations

import numpy as np
import pytest

import analytic
from lapjoint.orbits import search
from validation.cases import settled
from validation.verdict import Verdict

SOLVER = analytic.Solver(n_modes=6)


def disagree(label: str) -> list[str]:
    problem = settled.JOINTS[label]
    steady = SOLVER.steady_state(problem, sensitivity=False, errors=False)
    checks = settled.compared(label, SOLVER, steady, settled.end_of_march(SOLVER, problem))
    return [item.name for item in checks if item.verdict is Verdict.DISAGREE]


@pytest.mark.parametrize("label", settled.JOINTS)
def test_the_search_finds_what_a_march_ends_on(label: str) -> None:
    assert disagree(label) == []


def test_chaos_must_have_lasted(monkeypatch: pytest.MonkeyPatch) -> None:
    def missed() -> list[str]:
        found = settled.lasting("chaos", SOLVER, settled.CHAOTIC["chaos"])
        return [item.name for item in found if item.verdict is Verdict.DISAGREE]

    assert missed() == []
    monkeypatch.setattr(search, "DECAY_TIMES", 2.0)
    assert len(missed()) == 1


def test_a_contact_that_the_time_cuts_counts_in_part() -> None:
    problem = settled.JOINTS["uneven"]
    period = problem.require_excitation_period("march")
    history = SOLVER.simulate(problem, 40 * period, errors=False)
    contact = history.contacts[-3]
    middle = (contact.start + contact.end) / 2
    whole, half, none = (settled.impulses_after(history, t) for t in (contact.start, middle, contact.end))
    assert np.abs(whole - none).max() == pytest.approx(abs(contact.impulse), rel=1e-12)
    assert 0.2 < (half - none)[contact.stop] / contact.impulse < 0.8
