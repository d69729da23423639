"""First contacts under records, harmonics and random motions, and of joints with masses, steps, static loads, preload
and stops in space or damped: the solvers agree within their stated errors."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import pytest
from few_and_many import in_processes
from population import driven_joint
from random_joints import DAMPED, PERIODS, real_march
from refining import AnySolver

import analytic
import fe_lapjoint
from lapjoint import Problem
from lapjoint.answers import Contact
from lapjoint.errors import RecordWarning

SOLVERS: tuple[AnySolver, ...] = (analytic.Solver(), fe_lapjoint.Solver(elements=24))
SEED, COUNT = 271, 200
FEW = (0, 1, 2, 3, 4, 5, 37)  # two of each kind of excitation, and a record with a load that is a sine
REAL = (3, 7, 11, 15, 35)  # steps, gravity, preload, and several at once
BROKEN = (4, 6)  # whose force nearly ends within a contact, or does
CONTACTS = 3  # of a motion that begins at rest
MARGIN = 3.0  # of both stated errors together, which are estimates
ROUNDING = 1e-9  # of the duration, and of the largest impulse: what errors of truncation do not count
FAR = 10.0  # times what the errors allow: so far off is none
GRAZE = 1e-3  # of the largest impulse: whether so light a contact is there, truncation decides
MOST_MISSED = 0.03  # of all numbers; stated errors are to cover 19 of 20, and here there are two


@dataclass(frozen=True)
class Compared:
    """The first contacts of one joint by both solvers."""

    title: str
    numbers: tuple[tuple[str, float], ...]
    """What it is, and its difference over what both errors allow."""
    parted: str
    """Empty, or which contact the two do not share."""


Drawn = Callable[[int, int], tuple[Problem, float]]


def compared(drawn: Drawn, index: int, solvers: tuple[AnySolver, ...] = SOLVERS) -> Compared:
    """Both solvers on one problem, from rest: the first contacts of which both state an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)
        problem, duration = drawn(SEED, index)
        every = [solver.simulate(problem, duration).contacts for solver in solvers]
    size = max((abs(c.impulse) for contacts in every for c in contacts), default=0.0)
    heavy = [[c for c in contacts if abs(c.impulse) > GRAZE * size][:CONTACTS] for contacts in every]
    numbers: list[tuple[str, float]] = []
    for mine, others in ((heavy[0], every[1]), (heavy[1], every[0])):
        for a in mine:
            if not math.isfinite(a.start_error or 0.0):
                continue
            near = [c for c in others if c.stop == a.stop]
            b = min(near, key=lambda c: abs(c.start - a.start), default=None)
            if b is None or b.start > a.end or b.end < a.start:
                return Compared(problem.title, tuple(numbers), f"stop {a.stop}, {a.start:.6g} s: one solver alone")
            if mine is heavy[0]:
                numbers.append((f"start {a.start:.6g}", _times(a, b, "start", ROUNDING * duration)))
                numbers.append((f"impulse {a.start:.6g}", _times(a, b, "impulse", ROUNDING * size)))
    return Compared(problem.title, tuple(numbers), "")


def damped_march(seed: int, index: int) -> tuple[Problem, float]:
    """A joint with damped stops, and some periods of its base, s."""
    problem = DAMPED(seed, index)
    return problem, PERIODS * problem.require_excitation_period("test")


def _times(a: Contact, b: Contact, what: str, rounding: float) -> float:
    """A difference over what the errors allow."""
    errors = [getattr(c, f"{what}_error") for c in (a, b)]
    return float(abs(getattr(a, what) - getattr(b, what)) / (MARGIN * sum(errors) + rounding))


def check(found: list[Compared], least: int) -> None:
    """Fail unless nearly all numbers agree, and no contact is in one motion only."""
    parted = [f"{it.title}: {it.parted}" for it in found if it.parted]
    numbers = [(it.title, *number) for it in found for number in it.numbers]
    missed = [number for number in numbers if not number[2] <= 1.0]
    assert len(numbers) >= least
    assert not parted, "\n".join(parted)
    assert all(number[2] <= FAR for number in missed), missed
    assert len(missed) <= MOST_MISSED * len(numbers), missed


@pytest.mark.parametrize(
    ("drawn", "few", "least"), [(driven_joint, FEW, 12), (real_march, REAL, 12), (damped_march, BROKEN, 4)]
)
def test_the_solvers_agree_on_the_first_contacts_of_a_few_joints(
    drawn: Drawn, few: tuple[int, ...], least: int
) -> None:
    check([compared(drawn, i) for i in few], least)


@pytest.mark.slow
@pytest.mark.parametrize("drawn", [driven_joint, real_march, damped_march])
def test_the_solvers_agree_on_the_first_contacts_of_many_joints(drawn: Drawn) -> None:
    check(list(in_processes(partial(compared, drawn), range(COUNT))), 4 * COUNT)
