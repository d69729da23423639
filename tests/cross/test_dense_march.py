"""The witness that marches in tiny steps takes them by the modes that move a stop, and comes to what all modes say."""

from __future__ import annotations

import dense_march
import numpy as np
import pytest
from branch_witness import drawn, witnessed
from population import joint

import fe_lapjoint

SEED, SLIVER = 2013, 177  # a stop at 0.9995 of the beam: the last element's fastest mode has 1.4e8 rad/s
SOLVER = fe_lapjoint.Solver(elements=3)
PERIODS = 2


@pytest.mark.parametrize("index", range(1, 12, 2))
def test_steps_by_the_modes_that_move_find_what_steps_by_all_find(index: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """From rest, and from a motion that has gone on for some periods."""
    map_ = SOLVER.period_map(joint(SEED, index))
    for start in (map_.initial(), map_.march(map_.initial(), 8).end):
        y = np.asarray(map_.modal(start)).ravel()
        few = dense_march.dense_march(map_.model, start.state, y, map_.period, PERIODS)
        with monkeypatch.context() as patch:
            patch.setattr(dense_march, "_STILL", -1.0)
            every = dense_march.dense_march(map_.model, start.state, y, map_.period, PERIODS)
        assert [stop for stop, _ in few.switches] == [stop for stop, _ in every.switches]
        times = [np.array([t for _, t in one.switches]) for one in (few, every)]
        assert np.abs(times[0] - times[1]).max(initial=0.0) <= 1e-10 * map_.period
        assert np.abs(few.y - every.y).max() <= 1e-9 * np.abs(every.y).max()


def test_a_joint_with_a_sliver_of_an_element_can_be_witnessed() -> None:
    found = witnessed(SOLVER, SEED, SLIVER)
    assert not found.faults
    assert found.pushed
    assert drawn(SEED, SLIVER).problem.stops[0].x > 0.999
