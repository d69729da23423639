"""The case `shared-record`: what it measures of two motions that part."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import analytic
from validation.cases import shared_record as case
from validation.verdict import Criterion, Verdict


def test_a_distance_that_grows_exponentially_has_its_rate() -> None:
    t = np.linspace(0.2, 1.2, 51)
    found = case.growth(t, 1e-7 * np.exp(6.5 * t))
    assert found.rate == pytest.approx(6.5)
    assert found.times == pytest.approx(np.exp(6.5))
    assert found.uncertainty < 1e-9


def test_departures_from_a_line_make_its_rate_unsure() -> None:
    t = np.linspace(0.0, 2.0, 201)
    found = case.growth(t, np.exp(3.0 * t + 0.5 * np.sin(20 * t)))
    assert abs(found.rate - 3.0) < found.uncertainty < 1.0


def test_solvers_part_as_twins_do_and_another_stiffness_is_noticed() -> None:
    seed, (fine, other) = case.SEEDS[1], case.FINE
    motions = fine.simulate(case.joint(seed), 1.2), other.simulate(case.joint(seed), 1.2)
    assert all(item.verdict is Verdict.AGREE for item in case.contacts(seed, motions))
    joint = case.joint(seed)
    stiffer = joint.replace(stops=tuple(replace_stiffness(stop) for stop in joint.stops))
    changed = motions[0], analytic.Solver(n_modes=32).simulate(stiffer, 1.2)
    assert any(item.verdict is Verdict.DISAGREE for item in case.contacts(seed, changed))


def replace_stiffness(stop: case.Stop) -> case.Stop:
    return stop.model_copy(update={"stiffness": 1.01 * stop.stiffness})


def test_contacts_count_until_one_is_not_known() -> None:
    own = case.FINE[0].simulate(case.joint(2), 0.4)
    unknown = replace(own, contacts=(own.contacts[0], replace(own.contacts[1], start_error=np.inf), *own.contacts[2:]))
    assert case.known((own, unknown)) == [0]
    first = next(iter(case.contacts(2, (own, unknown))))
    assert isinstance(first, Criterion)
    assert first.verdict is Verdict.DISAGREE
