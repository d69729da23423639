"""What a certificate says: chatter, exponents, and the words for what was established."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import History, InputError, Outcome, paper_joint
from lapjoint.answers import Contact, Exponent
from lapjoint.answers.steady_state import chatters, impulses_per_period, periodic_outcome
from lapjoint.solver import Solver


def with_contacts(history: History, *spans: tuple[float, float], cut: bool = False) -> History:
    """A period of 1 s with contacts of the first stop from `spans`; `cut`: the last goes on into the first."""
    last = len(spans) - 1
    contacts = (Contact(0, *span, 1.0, 1.0, cut and i == 0, cut and i == last) for i, span in enumerate(spans))
    return replace(history, contacts=tuple(contacts))


CHATTER = ((0.10, 0.12), (0.30, 0.31), (0.40, 0.41), (0.45, 0.90))


@pytest.mark.parametrize(
    ("spans", "cut", "expected"),
    [
        (CHATTER, False, True),
        (CHATTER[:3], False, False),  # no lasting contact
        (((0.1, 0.12), (0.15, 0.17), (0.3, 0.31), (0.5, 0.9)), False, False),  # flights grow
        (((0.1, 0.12), (0.3, 0.32), (0.5, 0.52), (0.7, 0.72)), False, False),  # bounces at an even pace
        # the same chatter, seen from within its lasting contact
        (((0.0, 0.30), (0.50, 0.52), (0.70, 0.71), (0.80, 0.81), (0.85, 1.0)), True, True),
        ((), False, False),
    ],
)
def test_chatter_is_bounces_ever_closer_and_then_a_lasting_contact(
    history: History, spans: tuple[tuple[float, float], ...], cut: bool, expected: bool
) -> None:
    motion = with_contacts(history, *spans, cut=cut)
    assert chatters(motion, 0) is expected
    assert not chatters(motion, 1)
    outcome = Outcome.CHATTERING if expected else Outcome.PERIODIC if spans else Outcome.NO_CONTACT
    assert periodic_outcome(motion) is outcome


def measured(value: float, error: float, *, trend: float = 0.0, time: float = 100.0) -> Exponent:
    """An exponent whose second half exceeds the first by ``trend``."""
    halves = value - trend / 2, value + trend / 2
    return Exponent(value, error, 1000, time, halves, tuple(np.repeat(halves, 2)))


def test_an_exponent_is_positive_or_negative_only_in_both_halves_and_over_many_e_folds() -> None:
    assert measured(1.0, 0.2).positive
    assert measured(-1.0, 0.2).negative
    assert not measured(1.0, 0.3).positive  # less than four standard errors
    assert not measured(1.0, 0.2, trend=0.6).positive  # the first half alone is not certain
    assert not measured(1.0, 0.1, trend=0.7).positive  # the halves differ: it has not settled
    assert not measured(1.0, 0.1, time=9.0).positive  # fewer than ten e-folds


def test_an_exponent_vanishes_only_where_it_is_known_to_be_small() -> None:
    assert measured(0.02, 0.1).vanishes(rate=0.4)
    assert not measured(0.31, 0.17).vanishes(rate=1.2)  # within two standard errors of zero, and not known to be
    assert not measured(0.48, 0.13).vanishes(rate=1.2)
    assert not measured(-0.15, 0.07, trend=-0.2).vanishes(rate=0.48)
    assert not measured(0.0, 0.1, trend=0.2).vanishes(rate=0.4)
    assert not measured(0.02, 0.001, time=1e4).vanishes(rate=0.4)  # small, and certainly not zero
    for undamped in (0.0, math.inf):
        assert not measured(0.0, 0.1).vanishes(undamped)


def test_impulses_are_means_over_the_periods(history: History) -> None:
    np.testing.assert_allclose(impulses_per_period(with_contacts(history, *CHATTER), 2), [2.0, 0.0])


@pytest.mark.parametrize("solver", [analytic.Solver(), analytic.PublishedScheme(), fe_lapjoint.Solver()])
def test_without_excitation_every_solver_says_what_is_missing(solver: Solver) -> None:
    message = "^steady state: the excitation must have one angular_frequency, or whole .*; there is neither"
    with pytest.raises(InputError, match=message):
        solver.steady_state(paper_joint().replace(base_motion=None))
