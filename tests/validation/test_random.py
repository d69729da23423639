"""Both solvers under random excitation: blocks against one record, and mean squares against closed integrals."""

from __future__ import annotations

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import Problem, paper_joint
from lapjoint.problem import RandomBaseMotion, RandomLoad, RecordBaseMotion, RecordLoad

SOLVERS = {"analytic": analytic.Solver(n_modes=8), "fe": fe_lapjoint.Solver(elements=4)}
RATE = 4096.0


@pytest.fixture
def short_blocks(monkeypatch: pytest.MonkeyPatch) -> float:
    """Blocks of 128 intervals, and how long one lasts, s."""
    monkeypatch.setattr("lapjoint.problem.ramps.KNOTS", 128)
    return 128 / RATE


def _shaken(size: float, **changes: object) -> Problem:
    """The paper's joint under a base and a load, with `size` times a density."""
    base = RandomBaseMotion(psd=((50.0, 3 * size), (90.0, 8 * size), (500.0, 0.4 * size)), seed=3, rate=RATE)
    load = RandomLoad(x=2.0, psd=((60.0, 500.0 * size), (80.0, 500.0 * size)), seed=3)
    return paper_joint().replace(base_motion=base, point_loads=(load,), **changes)


def _recorded(problem: Problem, end: float) -> Problem:
    """The same samples as records."""
    base, load = problem.base_motion, problem.point_loads[0]
    assert isinstance(base, RandomBaseMotion)
    assert isinstance(load, RandomLoad)
    rates = base.samples_per_second, load.samples_per_second
    t = [np.arange(np.ceil(end * rate) + 2) / rate for rate in rates]
    return problem.replace(
        base_motion=RecordBaseMotion(quantity="acceleration", values=base.at(t[0], 2), rate=rates[0]),
        point_loads=(RecordLoad(x=load.x, values=load.realisation(0).at(t[1]), rate=rates[1]),),
    )


@pytest.mark.parametrize("name", SOLVERS)
def test_edges_of_blocks_do_not_show(name: str, short_blocks: float) -> None:
    problem, end = _shaken(1.0, stops=()), 2.4 * short_blocks
    once, again = (SOLVERS[name].simulate(it, end, errors=False) for it in (problem, _recorded(problem, end)))
    t = np.sort(np.concatenate([np.linspace(0, end, 601), short_blocks + np.array([-1e-9, 0.0, 1e-9])]))
    for dt in (0, 1, 2):
        one, other = (motion.evaluate([0.7, 2.5], t, dt=dt) for motion in (once, again))
        assert np.max(np.abs(one - other)) < 1e-9 * np.max(np.abs(one))


@pytest.mark.parametrize("name", SOLVERS)
def test_contacts_over_edges_of_blocks_are_those_under_a_record(name: str, short_blocks: float) -> None:
    problem, end = _shaken(100.0), 2.4 * short_blocks
    once, again = (SOLVERS[name].simulate(it, end, errors=False) for it in (problem, _recorded(problem, end)))
    assert 5 < len(once.contacts) == len(again.contacts)
    hardest = max(one.peak_force for one in once.contacts)
    first = once.contacts[:10]  # chaos makes more of rounding in later ones
    for one, other in zip(first, again.contacts, strict=False):
        assert one.stop == other.stop
        assert abs(one.start - other.start) < 1e-9 * one.start
        assert abs(one.end - other.end) < 1e-9 * one.end
        assert abs(one.peak_force - other.peak_force) < 1e-9 * hardest
    assert first[0].start < short_blocks < first[-1].start


@pytest.mark.parametrize("name", SOLVERS)
def test_a_block_may_end_in_a_contact(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = _shaken(100.0)
    contact = SOLVERS[name].simulate(problem, 0.03, errors=False).contacts[0]
    knots = int(np.ceil(contact.start * RATE))
    monkeypatch.setattr("lapjoint.problem.ramps.KNOTS", knots)
    assert contact.start < knots / RATE < contact.end
    other = SOLVERS[name].simulate(_shaken(100.0), 0.03, errors=False).contacts[0]
    for of in ("start", "end", "impulse", "peak_force"):
        assert getattr(other, of) == pytest.approx(getattr(contact, of), rel=1e-10)
