"""How deviations travel along the finite element motion: monodromy, multipliers, exponents."""

from __future__ import annotations

import math

import numpy as np
import pytest

import fe_lapjoint
from fe_lapjoint.march import tangent
from fe_lapjoint.march.march import march
from fe_lapjoint.march.tangent import Carried
from lapjoint import ModalDamping, ViscousDamping, paper_joint

OMEGA = 515.0
PERIOD = 2 * math.pi / OMEGA


@pytest.mark.parametrize("damping", [ModalDamping(ratio=(0.08, 0.02)), ViscousDamping(coefficient=2000.0)])
def test_volume_shrinks_as_the_damping_says(damping: ModalDamping | ViscousDamping) -> None:
    """The determinant of the monodromy is exp(-integral of the trace of the damping); switches lose nothing."""
    solver, problem = fe_lapjoint.Solver(elements=4), paper_joint(angular_frequency=OMEGA).replace(damping=damping)
    steady, period_map = solver.steady_state(problem), solver.period_map(problem)
    model, point = period_map.model, steady.section_point
    motion = march(model, point.state, period_map.modal(point), 0.0, PERIOD)
    assert steady.history.contacts
    trace = sum(2 * float(np.sum(model.system(p.state).damping_rate)) * (p.end - p.start) for p in motion.pieces)
    monodromy = Carried(model, motion, np.eye(motion.y.size)).end
    assert np.linalg.slogdet(monodromy)[1] == pytest.approx(-trace, rel=1e-6)


@pytest.mark.parametrize(("elements", "periods", "ratio"), [(16, 1, 0.08), (24, 3, 0.02), (60, 1, 0.02)])
def test_what_fast_modes_leave_out_of_the_monodromy_is_below_rounding(
    elements: int, periods: int, ratio: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where no mode is taken to have died out, all deviations are carried with all their coordinates."""
    problem = paper_joint(angular_frequency=100.0, damping_ratio=ratio)
    period_map = fe_lapjoint.Solver(elements=elements).period_map(problem)
    model, point = period_map.model, period_map.march(period_map.initial(), 40).end
    motion = march(model, point.state, period_map.modal(point), 0.0, periods * 2 * math.pi / 100.0)
    n = motion.y.size // 2
    columns, rest = Carried(model, motion, np.eye(2 * n)).combinations
    assert rest is not None
    assert columns.shape[1] <= n  # half of the coordinates
    together = columns @ rest
    monkeypatch.setattr(tangent, "DEAD", math.inf)
    all_modes = Carried(model, motion, np.eye(2 * n))
    assert all_modes.combinations[1] is None
    alone = all_modes.end
    monkeypatch.undo()
    size = np.repeat([100.0, 1.0], n)  # a velocity is compared with a displacement times the excitation's frequency
    known = period_map.linearised(point, 2 * periods)
    dense = np.linalg.eigvals(known.matrix)
    largest = np.abs(dense).max()
    for one in known.multipliers:  # small ones are worse known by the whole matrix
        assert np.abs(dense - one).min() <= 1e-8 * largest
    apart, whole = ((one * size[:, None]) / size for one in (together - alone, alone))
    assert np.abs(apart).max() <= 1e-13 * np.abs(whole).max()
