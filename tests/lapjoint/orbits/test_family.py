"""The period maps that a branch is followed in: their resolution by zones of the range."""

from __future__ import annotations

import numpy as np
import pytest

import analytic
from lapjoint import paper_joint
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.seeds import seed_from
from lapjoint.orbits.branches.tracing import trace

FREQUENCY = "base_motion.angular_frequency"


def family(low: float, high: float, path: str = FREQUENCY) -> Family:
    grid = Grid(paper_joint(), (Axis(path, (low, high)),))
    return Family(analytic.Solver(), lambda value: grid.with_values((value,)), path, low, high)


def modes(one: Family, value: float) -> int:
    solver = one.solver_at(value)
    assert isinstance(solver, analytic.Solver)
    assert solver.free_modes is not None
    return solver.free_modes


@pytest.mark.parametrize("high", [30.0, 800.0, 5000.0])
def test_each_problem_has_at_least_the_modes_that_it_needs_alone(high: float) -> None:
    one, solver = family(1.0, high), analytic.Solver()
    for value in [1.0, *np.random.default_rng(5).uniform(1.0, high, 40).tolist(), high]:
        alone = solver.mode_counts(paper_joint(angular_frequency=value))
        assert modes(one, value) >= max(alone)
        assert one.at(value).map.initial().coordinates.shape[1] == modes(one, value)


def test_low_frequencies_do_not_pay_for_high_ones() -> None:
    one = family(1.0, 5000.0)
    assert modes(one, 50.0) < modes(one, 5000.0)
    assert modes(one, 50.0) == modes(family(1.0, 50.0), 50.0)


def test_a_finer_family_is_finer_in_every_zone() -> None:
    one = family(1.0, 5000.0)
    for value in (2.0, 50.0, 4000.0):
        found = one.finer(value)
        assert found is not None
        refinement, finer = found
        assert modes(finer, value) == pytest.approx(modes(one, value) * refinement.ratio, rel=0.1)
        assert finer.at(value).map.initial().coordinates.shape[1] > one.at(value).map.initial().coordinates.shape[1]


def test_a_range_with_zero_or_with_one_resolution_is_one_zone() -> None:
    assert len(family(0.0, 0.01, "stops.*.gap").zones) == 1
    assert len(family(1.0, 500.0).zones) == 1


def test_a_branch_goes_on_where_the_resolution_changes() -> None:
    one = family(60.0, 4000.0)
    edge = one.zones[0].high
    part = family(60.0, 4000.0)
    seed = seed_from(one, 700.0, one.at(700.0).map.initial(), 1)
    assert seed is not None
    assert modes(one, np.nextafter(edge, 0.0)) < modes(one, np.nextafter(edge, np.inf))
    part.low, part.high = edge - 60.0, edge + 250.0
    found = trace(part, seed, most_multiple=1, errors=False)
    assert found is not None
    assert found.branch.ends == ("boundary", "boundary")
    assert not [bifurcation for bifurcation in found.branch.bifurcations if abs(bifurcation.value - edge) < 1e-2 * edge]
    counts = [point.motion.section_point.coordinates.shape[1] for point in found.branch.points]
    assert counts == sorted(counts)
    assert len(set(counts)) == 2
