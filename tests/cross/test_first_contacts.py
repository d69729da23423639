"""First contacts under records, harmonics and random motions, and of joints with masses, steps, static loads, preload
and stops in space: the solvers agree within their stated errors."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import pytest
from few_and_many import in_processes
from population import driven_joint
from random_joints import real_march
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
    """Both solvers on one problem, from rest."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)
        problem, duration = drawn(SEED, index)
        every = [solver.simulate(problem, duration).contacts for solver in solvers]
    size = max((abs(c.impulse) for contacts in every for c in contacts), default=0.0)
    one, other = ([c for c in contacts if abs(c.impulse) > GRAZE * size][:CONTACTS] for contacts in every)
    numbers: list[tuple[str, float]] = []
    for i, (a, b) in enumerate(zip(one, other, strict=False)):
        if math.inf in (a.start_error, b.start_error):  # a solver says that it does not know whether this contact is
            return Compared(problem.title, tuple(numbers), "")
        if a.stop != b.stop:
            return Compared(problem.title, tuple(numbers), f"contact {i}: stop {a.stop} or {b.stop}")
        numbers.append((f"start {i}", _times(a, b, "start", ROUNDING * duration)))
        numbers.append((f"impulse {i}", _times(a, b, "impulse", ROUNDING * size)))
    parted = "" if len(one) == len(other) else f"{len(one)} or {len(other)} contacts"
    return Compared(problem.title, tuple(numbers), parted)


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


@pytest.mark.parametrize(("drawn", "few"), [(driven_joint, FEW), (real_march, REAL)])
def test_the_solvers_agree_on_the_first_contacts_of_a_few_joints(drawn: Drawn, few: tuple[int, ...]) -> None:
    check([compared(drawn, i) for i in few], 12)


@pytest.mark.slow
@pytest.mark.parametrize("drawn", [driven_joint, real_march])
def test_the_solvers_agree_on_the_first_contacts_of_many_joints(drawn: Drawn) -> None:
    check(list(in_processes(partial(compared, drawn), range(COUNT))), 4 * COUNT)
