"""Momentum tells of a wrong impulse where nothing else of the motion is wrong."""

from __future__ import annotations

from dataclasses import replace

import pytest

import fe_lapjoint
from lapjoint import History, paper_joint
from lapjoint.problem.files import from_toml
from validation.cases import balance
from validation.momentum import momentum_applies, momentum_balance
from validation.verdict import Verdict


@pytest.fixture(scope="module")
def motion() -> History:
    return fe_lapjoint.Solver(elements=8).simulate(from_toml(balance.JOINT), 0.3)


def test_an_impulse_a_thousandth_too_large_breaks_the_balance(motion: History) -> None:
    wrong = replace(motion, contacts=tuple(replace(c, impulse=1.001 * c.impulse) for c in motion.contacts))
    right = momentum_balance(motion, 2e-5)
    assert all(item.verdict is Verdict.AGREE for item in right)
    assert any(item.verdict is Verdict.DISAGREE for item in momentum_balance(wrong, 2e-5))


def test_an_impulse_counted_twice_breaks_the_balance(motion: History) -> None:
    twice = replace(motion, contacts=(*motion.contacts, motion.contacts[-1]))
    assert all(item.verdict is Verdict.DISAGREE for item in momentum_balance(twice, 1e-4))


def test_forces_that_a_motion_does_not_tell_are_left_alone() -> None:
    assert not momentum_applies(paper_joint())
