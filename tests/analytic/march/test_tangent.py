"""The derivative of a march is that of the march as it is, however few modes it has: judged by differences.

With few modes what a switch leaves out is large.  A derivative that holds only for all modes is off by a thousandth
then, while a motion that converges to a periodic one shows nothing of it.
"""

from __future__ import annotations

import math
import sys
from itertools import pairwise

import numpy as np
import pytest

import analytic
from analytic import ensemble
from analytic.march import gap_view, growth, linearised, march, march_linearised, periods
from analytic.march.coordinates import Coordinates
from analytic.march.joint import Joint
from analytic.march.march import settle_status
from analytic.march.motion import SWITCHES, Motion
from analytic.period_map import PeriodMap
from lapjoint import FREE, ModalDamping, paper_joint
from lapjoint.answers import SectionPoint
from lapjoint.machine.one_thread import in_one_thread
from tests.helpers.population import stiffened_joint


def test_a_march_that_has_to_learn_its_switches_carries_the_same_deviations() -> None:
    """It comes back from compiled code at each switch that it does not know yet, and goes on from there."""
    begin, learned = Coordinates(FREE, np.zeros(9), np.zeros(9)), np.zeros(2, dtype=int)
    for seed in range(20):
        problem, ends = stiffened_joint(96, seed), []
        for i in range(2):
            met = Joint(problem, 9, 9)
            known = np.count_nonzero(met.tables.next_slot >= 0)
            period = 2 * math.pi / problem.require_excitation_frequency("test")
            ends.append(march_linearised(met, begin, 3 * period, np.eye(18))[1])
            learned[i] += np.count_nonzero(met.tables.next_slot >= 0) - known
        assert np.array_equal(ends[0], ends[1]), seed
    assert learned[0] > 0
    assert learned[1] == 0


LONG = 8


def of_many_switches() -> tuple[PeriodMap, SectionPoint]:
    """A joint whose motion switches often in `LONG` half periods, and whose fast modes die out on the way."""
    problem = paper_joint(angular_frequency=200.0).replace(damping=ModalDamping(ratio=0.05))
    period_map = analytic.Solver(n_modes=40).period_map(problem)
    return period_map, period_map.march(period_map.initial(), 8).end


@in_one_thread
def test_deviations_carried_in_pieces_are_those_carried_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    found = []
    period_map, point = of_many_switches()
    begin = Coordinates(point.state, *point.coordinates)
    motion = march(period_map.joint, begin, 0.0, LONG / 2 * period_map.period)
    for at_once in (1_000_000, 3):
        monkeypatch.setattr(linearised, "WITH_ALL_AT_ONCE", at_once)
        found.append(gap_view(motion))
    assert len(found[0]) > 20
    for one, other in zip(*((it.deviations, it.drift) for it in found), strict=True):
        assert one == pytest.approx(other, rel=1e-12, abs=1e-12 * np.abs(other).max())


def test_long_marches_come_back_from_compiled_code_before_long(monkeypatch: pytest.MonkeyPatch) -> None:
    """Python takes no notice of Ctrl-C until they do."""
    counts: list[int] = []

    def counting(of: Joint, motion: Motion, status: int, max_switches: int) -> None:
        counts.append(int(motion.counts[SWITCHES]))
        settle_status(of, motion, status, max_switches)

    period_map, point = of_many_switches()
    for module in (periods, ensemble):
        monkeypatch.setattr(module, "settle_status", counting)
    monkeypatch.setattr(growth, "WITH_ALL_AT_ONCE", 10)
    monkeypatch.setattr(sys.modules[settle_status.__module__], "SWITCHES_AT_ONCE", 10)
    begin = Coordinates(point.state, *point.coordinates)
    marches = [
        lambda: march_linearised(period_map.joint, begin, LONG / 2 * period_map.period, np.eye(point.coordinates.size)),
        lambda: period_map.march(point, LONG),
        lambda: period_map.followed(point, np.ones(point.coordinates.size), LONG // 2),
        lambda: period_map.ensemble([point, point]).march(np.arange(2), LONG // 2),
    ]
    for made in marches:
        counts.clear()
        made()
        assert max(counts) > 20
        assert all(after - before <= 11 for before, after in pairwise([0, *counts]))
