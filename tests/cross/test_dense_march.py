"""The witness that marches in tiny steps takes them by the modes that move a stop, and comes to what all modes say."""

from __future__ import annotations

import dense_march
import numpy as np
import pytest
from dense_march import fastest_moving
from population import joint
from scipy.linalg import expm, solve_sylvester

import fe_lapjoint
from fe_lapjoint.march.system import System
from lapjoint.problem import FloatArray

SEED = 2013
SOLVER = fe_lapjoint.Solver(elements=3)
PERIODS = 2
TIMES = 300  # in a period of the loads, at which the modes that are left out are looked at
STILL = 1e-9  # of the largest displacement of a stop: what they move one by, at most


def own_motion(system: System, y: FloatArray, t: float, times: FloatArray) -> FloatArray:
    """What each mode does beside its answer to the loads, some times later, shape ``(times, n)``.

    The answer X (sin, cos) of the unknowns has M X + B = X S, where the loads' own equation is s' = S s.
    """
    n = system.omega.size
    M, z = dense_march.matrix(system, np.ones(n), y, t)
    loads = slice(2 * n + 1, None)
    A = M[: 2 * n, : 2 * n]
    X = solve_sylvester(A, -M[loads, loads], -M[: 2 * n, loads])
    own = z[: 2 * n] - X @ z[loads] + np.linalg.solve(A, M[: 2 * n, 2 * n])
    return np.array([(expm(A * s) @ own)[:n] for s in times])


@pytest.mark.parametrize("index", range(12))
def test_modes_that_are_left_out_leave_every_stop_where_it_is(index: int) -> None:
    map_ = SOLVER.period_map(joint(SEED, index))
    start = map_.march(map_.initial(), 8).end
    system, y = map_.model.system(start.state), np.asarray(map_.modal(start)).ravel()
    q, v = np.split(y, 2)
    left_out = np.hypot(system.omega, system.damping_rate) > fastest_moving(system, q, v, 0.0)
    shapes = np.abs(system.stops)
    own = np.abs(own_motion(system, y, 0.0, np.linspace(0.0, map_.period, TIMES)))
    size = float((shapes @ np.hypot(q, v / system.omega)).max())
    assert (own[:, left_out] @ shapes[:, left_out].T).max(initial=0.0) <= STILL * size


@pytest.mark.parametrize("index", range(1, 12, 2))
def test_steps_by_the_modes_that_move_find_what_steps_by_all_find(index: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """From rest, and from a motion that has gone on for some periods."""
    map_ = SOLVER.period_map(joint(SEED, index))
    for start in (map_.initial(), map_.march(map_.initial(), 8).end):
        y = np.asarray(map_.modal(start)).ravel()
        few = dense_march.dense_march(map_.model, start.state, y, map_.period, PERIODS)
        with monkeypatch.context() as patch:
            patch.setattr(dense_march, "STILL", -1.0)
            every = dense_march.dense_march(map_.model, start.state, y, map_.period, PERIODS)
        assert [stop for stop, _ in few.switches] == [stop for stop, _ in every.switches]
        times = [np.array([t for _, t in one.switches]) for one in (few, every)]
        assert np.abs(times[0] - times[1]).max(initial=0.0) <= 1e-10 * map_.period
        assert np.abs(few.y - every.y).max() <= 1e-9 * np.abs(every.y).max()
