"""The locus of the first graze, by both solvers, is that of the closed form; what is joined is one bifurcation."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import xarray as xr
from closed_form import reached
from population import joint

from lapjoint import FREQUENCY, Axis, BaseMotion, Problem, branch
from lapjoint.campaigns.branches.loci import loci_of
from lapjoint.campaigns.branches.table import KINDS
from lapjoint.problem import FloatArray

AMPLITUDE = "base_motion.amplitude"
SOLVERS: dict[str, dict[str, int]] = {"analytic": {"n_modes": 20}, "fe": {"elements": 16}}
LOCATED = 3e-8
"""Relative: grazes are located to 1e-9 in number and motion, and both sums leave out modes, of lightly damped joints
some 1e-8 of the motion."""


def locus(problem: Problem, solver: str) -> tuple[xr.Dataset, FloatArray, FloatArray]:
    """Branches over the amplitude of the base at three frequencies, these, and what the closed form has at each."""
    base = problem.base_motion
    assert isinstance(base, BaseMotion)
    omega = base.angular_frequency * np.array([0.998, 1.0, 1.002])
    exact = np.array([reached(problem, float(one)) for one in omega])
    first = exact.min(axis=1)
    how: dict[str, Any] = {"solver": solver, "options": SOLVERS[solver], "max_points": 60, "effort": 120}
    also = Axis(FREQUENCY, tuple(omega.tolist()))
    found = branch(
        problem, AMPLITUDE, 0.9 * first.min(), 1.02 * first.max(), **how, errors=solver == "fe", also_over=also
    )
    return found, omega, exact


@pytest.mark.parametrize(
    ("seed", "index"),
    [
        (2, 3),
        pytest.param(1, 9, marks=pytest.mark.thorough),
        *(pytest.param(2, i, marks=pytest.mark.slow) for i in range(1, 41, 2)),
    ],
)
@pytest.mark.parametrize("solver", ["analytic", pytest.param("fe", marks=pytest.mark.thorough)])
def test_the_locus_of_the_first_graze_is_that_of_the_closed_form(solver: str, seed: int, index: int) -> None:
    found, omega, exact = locus(joint(seed, index), solver)
    first = np.flatnonzero(found.bifurcation_first.values & (found.bifurcation_after.values != "ends"))  # others spring
    assert {KINDS[kind] for kind in found.bifurcation_kind.values[first]} == {"grazing"}
    np.testing.assert_array_equal(found.bifurcation_also_over.values[first], omega)
    assert len(set(found.bifurcation_locus.values[first])) == 1
    for j, row in zip(first, exact, strict=True):
        allowed = float(found.bifurcation_error[j]) if solver == "fe" else LOCATED * row.min()
        assert allowed <= 2e-3 * row.min()
        assert float(found.bifurcation_value[j]) == pytest.approx(row.min(), rel=0, abs=allowed)
        assert row[int(found.bifurcation_stop[j])] == pytest.approx(row.min(), rel=1e-12)


def labels_of(found: xr.Dataset) -> list[tuple[Any, ...]]:
    columns = (found[f"bifurcation_{name}"].values.tolist() for name in ("kind", "stop", "first"))
    return list(zip(*columns, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize("index", range(0, 12))
def test_what_is_joined_over_a_coarse_grid_is_joined_over_a_fine_one_or_has_come_to_nothing_else(index: int) -> None:
    problem = joint(4, index)
    base = problem.base_motion
    assert isinstance(base, BaseMotion)
    omega = tuple((base.angular_frequency * np.linspace(0.95, 1.05, 13)).tolist())
    first = float(reached(problem, base.angular_frequency).min())
    found = branch(
        problem,
        AMPLITUDE,
        0.8 * first,
        1.3 * first,
        options={"n_modes": 4},
        errors=False,
        max_points=300,
        effort=300,
        also_over=Axis(FREQUENCY, omega),
    )
    at, value, impulses = (found[f"bifurcation_{name}"].values for name in ("also_over", "value", "impulse"))
    labels, fine = labels_of(found), loci_of(omega, labels_of(found), at, value, impulses)
    kept = np.flatnonzero(np.isin(at, omega[::2]))
    coarse = loci_of(omega[::2], [labels[j] for j in kept], at[kept], value[kept], impulses[kept])
    joined = contradicted = 0
    for number in set(coarse.tolist()):
        chain = kept[coarse == number]
        for a, b in pairwise(chain.tolist()):
            same = np.flatnonzero((fine == fine[a]) & (at == at[b]))
            joined += 1
            contradicted += bool(same.size) and b not in same
    assert contradicted <= 0.02 * joined
