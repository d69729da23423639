"""A column of numbers with decimal commas, as loggers write it, shakes a joint as the same numbers with points do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import InputError, Problem
from lapjoint.problem.files import problem_from_tables
from lapjoint.solver import Solver

TABLES = {
    "beam": {"length": 1.0, "bending_stiffness": 1e6, "mass_per_length": 1.0},
    "supports": [{"x": 0.0, "translational": 200.0}, {"x": 1.0, "translational": 200.0}],
    "stops": [{"name": "s", "x": 0.5, "side": "top", "gap": 0.005, "stiffness": 5000.0}],
    "damping": {"kind": "viscous", "coefficient": 2.0},
}
SAMPLES = [f"{30 * np.sin(3 * t) * np.sin(40 * t):.3f}" for t in np.arange(4001) / 2000]


def _joint(folder: Path, samples: list[str], **keys: str) -> Problem:
    (folder / "r.csv").write_text("\n".join(samples), encoding="utf-8")
    motion = {"kind": "record", "quantity": "acceleration", "file": "r.csv", "rate": 2000.0, **keys}
    return problem_from_tables(TABLES | {"base_motion": motion}, "joint", folder)


@pytest.mark.thorough
@pytest.mark.filterwarnings("ignore::lapjoint.errors.RecordWarning")
@pytest.mark.parametrize("solver", [analytic.Solver(), fe_lapjoint.Solver()])
def test_decimal_commas_give_the_impulse_of_points(solver: Solver, tmp_path: Path) -> None:
    commas = [sample.replace(".", ",") for sample in SAMPLES]
    with pytest.raises(InputError, match='line 1, "0,000": a comma may be a decimal mark or stand between columns'):
        _joint(tmp_path, commas)
    joint = _joint(tmp_path, commas, decimal=",")
    impulse = float(solver.simulate(joint, joint.longest, errors=False).impulses().sum())
    assert impulse == pytest.approx(15.189907, rel=1e-6)  # of both solvers, from points; 14.668 of whole numbers
