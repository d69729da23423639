"""What tells one campaign from another, in what sequence a chain goes, and where each answer stands in the dataset."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lapjoint import ModalDamping, paper_joint
from lapjoint.campaigns import FREQUENCY, Axis
from lapjoint.campaigns.basins.spec import BasinPlan
from lapjoint.campaigns.branches.spec import BranchSpec
from lapjoint.campaigns.grid import Grid
from lapjoint.campaigns.point import Point
from lapjoint.campaigns.statistics.spec import Realisations
from lapjoint.campaigns.sweep.spec import Plan
from lapjoint.campaigns.sweep.table import sweep_dataset

JOINT = paper_joint()
FREQUENCIES, RATIOS = (300.0, 100.0, 200.0), (0.08, 0.02)
GRID = Grid(JOINT, (Axis(FREQUENCY, FREQUENCIES), Axis("damping.ratio", RATIOS)))
SWEEP = Plan(GRID)
PLANS: dict[str, Any] = {
    "sweep": SWEEP,
    "basins": BasinPlan(JOINT, energy=20.0, starts=5),
    "branches": BranchSpec(JOINT, FREQUENCY, 100.0, 200.0),
    "statistics": Realisations(JOINT, 1.0),
}


@pytest.mark.parametrize("kind", PLANS)
def test_work_with_other_options_of_the_solver_is_other_work(kind: str) -> None:
    plan = PLANS[kind]
    assert replace(plan, options={}).fingerprint == plan.fingerprint
    found = {replace(plan, options={"n_modes": count}).fingerprint for count in (12, 13)}
    assert len(found | {plan.fingerprint}) == 3


@pytest.mark.parametrize(
    "change",
    [
        {"solver": "fe"},
        {"start": "random"},
        {"starts": 2},
        {"seed": 1},
        {"sensitivity": True},
        {"errors": True},
        {"summary": ("force_rms",)},
        {"grid": Grid(JOINT, GRID.axes[::-1])},
        {"grid": Grid(JOINT.replace(title="another"), GRID.axes)},
    ],
    ids=lambda change: "".join(change),
)
def test_a_sweep_that_asks_for_anything_else_is_another_sweep(change: dict[str, Any]) -> None:
    assert replace(SWEEP, **change).fingerprint != SWEEP.fingerprint


@pytest.mark.parametrize(("start", "sequence"), [("up", (100.0, 200.0, 300.0)), ("down", (300.0, 200.0, 100.0))])
def test_a_chain_goes_along_the_first_axis_the_way_that_is_asked_for(start: Any, sequence: tuple[float, ...]) -> None:
    chains = list(replace(SWEEP, start=start).chains())
    for chain, ratio in zip(chains, RATIOS, strict=True):
        assert [GRID.values_at(cell) for cell in chain] == [(omega, ratio) for omega in sequence]


def test_an_answer_stands_at_the_values_of_its_problem() -> None:
    """Each point gets the numbers of its own problem for an answer."""
    points = {}
    for cell in range(SWEEP.size):
        problem = SWEEP.grid.problem_at(cell)
        assert isinstance(problem.damping, ModalDamping)
        omega, ratio = problem.require_excitation_frequency("test"), problem.damping.ratio
        assert isinstance(ratio, float)
        impulses = tuple(omega * (1 + i) for i in range(len(JOINT.stops)))
        points[cell] = Point("PERIODIC", 1, residual=ratio, impulses=impulses, duration=omega)
    found = sweep_dataset(SWEEP, points)
    for omega in FREQUENCIES:
        for ratio in RATIOS:
            here = found.sel({"angular_frequency": omega, "damping_ratio": ratio})
            assert (float(here.duration), float(here.residual)) == (omega, ratio)
            assert np.array_equal(here.impulse, omega * np.arange(1, 1 + len(JOINT.stops)))
