"""What a coarse solver makes of a curve is not believed where a finer one sees it otherwise.

The solvers are maps whose multipliers are given functions of a number, as in `test_bifurcations_of_made_maps`, with a
perturbation of which each finer solver has a quarter: what is true is known without any of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from made_map import Made, MadeMap, made_problem, of_trace

from lapjoint import Problem
from lapjoint.answers.branches import Bifurcation
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.run import Limits
from lapjoint.orbits.branches.tracing import Seed, trace
from lapjoint.orbits.refinement import Refinement

LOW, HIGH = 1.0, 2.0
AMPLITUDE = "base_motion.amplitude"
RATIO, LEFT = 2.0, 0.25
"""Resolution of a solver over that of the one before, and the share of its perturbation that it has: second order."""


@dataclass(frozen=True)
class Perturbed:
    """A solver of maps with two multipliers, whose sum and product are perturbed."""

    total: tuple[float, float]
    """Sum of the multipliers at 1 and its slope."""
    product: float
    """Their product."""
    bumps: tuple[tuple[float, float, float], ...]
    """What is added to the sum: heights, where they are, and widths."""
    share: float = 1.0
    """Share of the heights that this solver has."""

    @property
    def name(self) -> str:
        """As it says."""
        return f"with {self.share} of the perturbation"

    def true_flips(self) -> list[float]:
        """Where 1 + sum + product changes its sign, within 1e-6, without any bump."""
        p = np.linspace(LOW, HIGH, 1_000_001)
        value = 1 + self.product + replace(self, share=0.0)._sum(p)
        return [float(one) for one in p[1:][(value[1:] > 0) != (value[:-1] > 0)]]

    def _sum(self, p: np.ndarray) -> np.ndarray:
        (at, slope), bumps = self.total, self.bumps
        waves = sum(height * np.exp(-(((p - centre) / width) ** 2)) for height, centre, width in bumps)
        return np.asarray(at + slope * (p - 1) + self.share * waves)

    def period_map(self, problem: Problem) -> MadeMap:
        """The map at the amplitude of a problem."""
        return Made(lambda p: [of_trace(float(self._sum(np.array(p))), self.product)]).period_map(problem)

    def finer(self, problem: Problem) -> tuple[Refinement, Perturbed]:
        """The next one."""
        other = replace(self, share=LEFT * self.share)
        return Refinement(other.name, RATIO, 2.0), other


def found_by(
    solver: Perturbed, errors: bool = True, progress: Callable[[float], None] | None = None
) -> tuple[Bifurcation, ...]:
    """The bifurcations of its branch."""
    grid = Grid(made_problem(LOW), (Axis(AMPLITUDE, (LOW, HIGH)),))
    family = Family(solver, lambda value: grid.with_values((value,)), AMPLITUDE, LOW, HIGH)
    seed, limits = Seed(LOW, family.at(LOW).map.initial(), 2), Limits(progress=progress)
    found = trace(family, seed, most_multiple=1, errors=errors, limits=limits)
    assert found is not None
    assert found.branch.ends == ("boundary", "boundary")
    values = [point.value for point in found.branch.points]
    assert values == sorted(values)
    outside = [int(np.count_nonzero(np.abs(point.motion.multipliers) > 1)) for point in found.branch.points]
    changes = [i for i in range(1, len(outside)) if outside[i] != outside[i - 1]]
    assert set(changes) <= {one.index for one in found.branch.bifurcations}
    return found.branch.bifurcations


def test_two_flips_that_only_a_coarse_solver_has_are_not_listed() -> None:
    # The sum is -1.4, and the bump takes it to -1.6: below -1.5 from 1.28 to 1.52; a quarter of it leaves it above.
    solver = Perturbed((-1.4, 0.0), 0.5, ((-0.2, 1.4, 0.15),))
    assert [one.kind for one in found_by(solver, errors=False)] == ["flip", "flip"]
    assert found_by(solver) == ()


def test_progress_goes_on_while_parts_are_followed_by_finer_solvers() -> None:
    solver, shares = Perturbed((-1.4, 0.0), 0.5, ((-0.2, 1.4, 0.15),)), list[float]()
    found_by(solver, progress=shares.append)
    assert shares == sorted(shares)
    assert 0 < shares[0]
    assert shares[-2] <= 0.4 < shares[-1] < 1  # once it is followed, one part is left


def test_what_a_finer_solver_has_far_off_is_not_taken_for_the_same() -> None:
    # With a bump as wide as the range the flip is at 1.2, and for the finer solver at 1.65.
    solver = Perturbed((-1.1, -0.5), 0.5, ((-0.3, 1.2, 3.0),))
    (one,) = found_by(solver)
    assert one.kind == "flip"
    assert not np.isfinite(one.error)


@pytest.mark.parametrize("seed", range(12))
def test_what_has_an_error_is_where_it_says(seed: int) -> None:
    rng = np.random.default_rng((23, seed))
    bumps = tuple(
        (rng.uniform(-0.2, 0.2), rng.uniform(1.2, 1.8), float(np.exp(rng.uniform(*np.log((0.01, 0.3))))))
        for _ in range(3)
    )
    solver = Perturbed((-1.4 - rng.uniform(0, 0.1), rng.uniform(-0.3, 0.3)), 0.5, bumps)
    true = solver.true_flips()
    stated = [one for one in found_by(solver) if np.isfinite(one.error)]
    for one in stated:
        assert min((abs(one.value - value) for value in true), default=np.inf) <= one.error + 2e-6
