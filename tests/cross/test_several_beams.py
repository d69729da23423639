"""Two and three beams by both solvers: first contacts and steady states agree within their stated errors, and no
certificate is false on a long march."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import pytest
from few_and_many import in_processes
from refining import AnySolver
from shaken_beams import decay_time, shaken_beams, shaken_march
from witness import testify

import analytic
import fe_lapjoint
from lapjoint import Problem
from lapjoint.errors import SolverError
from lapjoint.problem.presets import lap_joint
from tests.cross import test_first_contacts as first_contacts
from tests.cross.test_real_joints import Settled, judged

LONGEST = 500  # excitation periods, after which a motion that has not been told is not waited for
SOLVERS: tuple[AnySolver, ...] = (
    analytic.Solver(tolerance=1e-4, max_periods=LONGEST),
    fe_lapjoint.Solver(elements=8, max_periods=LONGEST),
)
SEED, COUNT = 49, 200
FEW = (1, 5)  # systems that settle soon
MOST_APART = 0.02  # of all systems: stated errors are to cover 19 of 20, and three times as much is allowed


@dataclass(frozen=True)
class Met:
    """One system by both solvers."""

    contacts: first_contacts.Compared
    settled: Settled
    certificates: tuple[tuple[str, str], ...]
    """Verdict and reason of the march on from each solver's certificate."""


def met(index: int) -> Met | None:
    """One system of the seed; None if a solver says that its modal damping holds it at a gap."""
    problem = shaken_beams(SEED, index)
    try:
        contacts = first_contacts.compared(lambda _, i: shaken_march(SEED, i), index, SOLVERS)
        found = [solver.steady_state(problem, sensitivity=False) for solver in SOLVERS]
        said = [
            testify(solver.period_map(problem), steady, decay_time(problem))
            for solver, steady in zip(SOLVERS, found, strict=True)
        ]
    except SolverError:
        return None
    return Met(contacts, judged(problem, *found, SOLVERS), tuple((it.verdict, it.why) for it in said))


def check(found: Iterable[Met | None]) -> list[str]:
    """Fail unless nearly all contacts and steady states agree, and all certificates are true; gives the verdicts on
    the steady states."""
    every = [it for it in found if it is not None]
    first_contacts.check([it.contacts for it in every], 2 * len(every))
    false = [f"{it.settled.title}: {why}" for it in every for verdict, why in it.certificates if verdict == "false"]
    assert not false, "\n".join(false)
    apart = [f"{it.settled.title}: {it.settled.why}" for it in every if it.settled.verdict == "apart"]
    assert len(apart) <= MOST_APART * len(every), "\n".join(apart)
    return [it.settled.verdict for it in every]


def test_both_solvers_agree_on_a_few_systems_of_beams() -> None:
    assert check(map(met, FEW)) == ["agree"] * len(FEW)


@pytest.mark.slow
@pytest.mark.long_march
def test_both_solvers_agree_on_many_systems_of_beams() -> None:
    verdicts = check(in_processes(met, range(COUNT)))
    assert verdicts.count("undecided") <= 0.3 * COUNT


@pytest.mark.thorough
def test_both_solvers_agree_on_the_first_contacts_of_the_lap_joint() -> None:
    def drawn(_: int, __: int) -> tuple[Problem, float]:
        return lap_joint(), 0.03

    found = first_contacts.compared(drawn, 0)
    assert not found.parted
    assert len(found.numbers) == 2 * first_contacts.CONTACTS
    assert max(times for _, times in found.numbers) <= 1
