"""Newton's method on period maps, and what is known of the orbits that it finds."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from settled import orbit_of
from toy import Bar, Unwilling, bar

import analytic
import fe_lapjoint
from lapjoint import FREE, ModalDamping, Problem, ViscousDamping, paper_joint
from lapjoint.answers import SectionPoint
from lapjoint.errors import SolverError
from lapjoint.orbits import Linearised
from lapjoint.orbits.half_periods import HalfPeriodMarch, HalfPeriods
from lapjoint.orbits.newton import FAR, RESIDUAL, Orbit, find_orbit
from lapjoint.orbits.period_map import Derivative
from lapjoint.problem import FloatArray

SOLVERS: dict[str, Any] = {"analytic": analytic.Solver(n_modes=4), "FE": fe_lapjoint.Solver(elements=2)}
MODAL, VISCOUS = ModalDamping(ratio=(0.08, 0.02)), ViscousDamping(coefficient=2000.0)


def test_half_periods_and_whole_periods_find_the_same_orbit_and_multipliers() -> None:
    map_ = Bar().period_map(bar(0.8, (0.5, 5.0), (-0.5, 5.0)))
    half, whole, three = (orbit_of(map_, count) for count in (1, 2, 3))
    assert (half.symmetric, half.period_multiple) == (True, 1)
    assert (whole.symmetric, whole.period_multiple) == (False, 1)
    assert (three.symmetric, three.period_multiple) == (True, 3)
    assert half.point.coordinates == pytest.approx(whole.point.coordinates, rel=1e-7)
    assert np.sort_complex(half.multipliers) == pytest.approx(np.sort_complex(whole.multipliers), abs=1e-7)
    assert np.abs(three.multipliers) == pytest.approx(np.abs(whole.multipliers) ** 3, abs=1e-7)
    assert half.multipliers == pytest.approx(half.spectrum[0] ** 2)


# --- Maps written down ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Written:
    """A map z -> A z + b z^3 of the plane, or what fails in its place; only what Newton's method asks for."""

    A: FloatArray
    cubic: float = 0.0
    fails_beyond: float = math.inf

    @property
    def problem(self) -> Problem:
        return bar(1.0, (0.5, 1.0))

    @property
    def period(self) -> float:
        return 1.0

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        z = start.coordinates.ravel()
        if np.linalg.norm(z) > self.fails_beyond:
            raise SolverError("too far")
        end = SectionPoint(FREE, (self.A @ z + self.cubic * z**3).reshape(2, 1))
        return Linearised(end, lambda: Derivative(self.A + 3 * self.cubic * np.diag(z**2)), tuple)

    def difference(self, point: SectionPoint, origin: SectionPoint) -> FloatArray:
        return (point.coordinates - origin.coordinates).ravel()

    def norm(self, deviation: FloatArray) -> float:
        return float(np.linalg.norm(deviation))

    def size(self, point: SectionPoint) -> float:
        return max(1.0, self.norm(point.coordinates.ravel()))

    def moved(self, origin: SectionPoint, deviation: FloatArray) -> SectionPoint:
        return SectionPoint(FREE, origin.coordinates + deviation.reshape(2, 1))


def point_at(*z: float) -> SectionPoint:
    return SectionPoint(FREE, np.array(z).reshape(2, 1))


def found(map_: Written, guess: SectionPoint, farthest: float = FAR) -> Orbit | None:
    return find_orbit(HalfPeriods(map_), guess, 2, farthest)  # type: ignore[arg-type]


def spiral(modulus: float, angle: float = 1.0) -> FloatArray:
    return modulus * np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


@pytest.mark.parametrize(
    ("A", "stable", "unstable", "spirals_out"),
    [
        (np.diag([0.9, -0.5]), True, False, False),
        (np.diag([0.9, -1.1]), False, True, False),
        (np.diag([1.1, 0.5]), False, True, False),
        (spiral(0.99), True, False, False),
        (spiral(1.01), False, True, True),
        (spiral(1.0), False, False, False),  # cannot be told from either
        (np.diag([-1.0, 0.5]), False, False, False),
        (np.diag([1 - 1e-12, 0.0]) * -1, False, False, False),
        (np.diag([-1 - 1e-8, 0.5]), False, False, False),
    ],
)
def test_stability_is_said_only_for_certain(A: FloatArray, stable: bool, unstable: bool, spirals_out: bool) -> None:
    orbit = found(Written(A), point_at(0.1, 0.2))
    assert orbit is not None
    assert (orbit.stable, orbit.unstable, orbit.spirals_out) == (stable, unstable, spirals_out)
    assert orbit.point.coordinates == pytest.approx(np.zeros((2, 1)), abs=1e-12)
    leading = max(np.linalg.eigvals(A), key=abs)
    assert abs(orbit.leading) == pytest.approx(abs(leading), rel=1e-12)


def test_multipliers_are_complex_and_their_vectors_belong_to_them() -> None:
    orbit = found(Written(spiral(0.8, 0.7)), point_at(0.1, 0.2))
    assert orbit is not None
    values, vectors = orbit.spectrum
    assert orbit.multipliers.dtype == complex
    assert sorted(values, key=lambda one: one.imag) == pytest.approx(
        [0.8 * cmath.exp(-0.7j), 0.8 * cmath.exp(0.7j)], abs=1e-12
    )
    assert orbit.last.matrix @ vectors == pytest.approx(vectors * values, abs=1e-12)


def test_a_nonlinear_map_is_solved_to_its_residual() -> None:
    """z = A z + z^3 / 10 with A = diag(1 / 2, 1 / 2): fixed points at 0 and at +- sqrt(5), which repels by 2."""
    map_ = Written(np.diag([0.5, 0.5]), 0.1)
    near, far = found(map_, point_at(0.4, 0.3)), found(map_, point_at(2.3, 2.1))
    assert near is not None
    assert far is not None
    assert near.point.coordinates == pytest.approx(np.zeros((2, 1)), abs=1e-9)
    assert far.point.coordinates == pytest.approx(np.full((2, 1), math.sqrt(5)), rel=1e-12)
    assert far.multipliers == pytest.approx([2.0, 2.0], rel=1e-6)
    assert max(near.residual, far.residual) <= RESIDUAL


def test_where_newtons_method_cannot_go_on_there_is_no_orbit() -> None:
    assert found(Written(np.eye(2), 0.1), point_at(0.0, 0.5)) is None  # I - M is singular
    assert found(Written(np.diag([0.5, 0.5]), fails_beyond=0.1), point_at(1.0, 0.0)) is None  # the first march fails
    # The march from the guess goes well, and the one after Newton's step does not: it leads to z = -4.4.
    assert found(Written(np.diag([0.5, 0.5]), 0.1, fails_beyond=2.0), point_at(1.19, 0.0)) is None
    assert found(Written(np.diag([0.5, 0.5])), point_at(1.0, 0.0), farthest=0.4) is None  # too far to be tried
    assert found(Written(np.diag([0.5, 0.5])), point_at(1.0, 0.0), farthest=0.6) is not None


def test_a_march_that_cannot_go_on_is_no_orbit_by_finite_differences_either() -> None:
    unwilling = Unwilling(bar(0.8, (0.5, 5.0)), "unwilling")
    assert find_orbit(HalfPeriods(unwilling), unwilling.initial(), 2, FAR) is None


# --- Half periods --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "map_",
    [
        pytest.param(lambda: Bar().period_map(bar(0.8, (0.5, 5.0), (-0.5, 5.0))), id="bar"),
        pytest.param(lambda: SOLVERS["analytic"].period_map(paper_joint()), id="analytic"),
        pytest.param(lambda: SOLVERS["FE"].period_map(paper_joint()), id="FE"),
    ],
)
def test_two_half_periods_are_a_whole_one(map_: Any) -> None:
    halves = HalfPeriods(map_())
    assert halves.least == 1
    point = halves.map.march(halves.map.initial(), 6).end
    one = halves.marched(halves.marched(point, 1), 1)
    whole = halves.marched(point, 2)
    # The march is cut in another place.
    assert halves.apart(one, whole) < 1e-9
    first = halves.linearised(point, 1)
    assert halves.apart(first.end, halves.marched(point, 1)) < 1e-12
    second = halves.linearised(first.end, 1)
    both: HalfPeriodMarch = halves.linearised(point, 2)
    if point.state == first.end.state:  # else they are in other coordinates
        scale = np.abs(both.matrix).max()
        assert second.matrix @ first.matrix == pytest.approx(both.matrix, abs=1e-6 * scale)


def test_only_symmetric_problems_have_half_periods() -> None:
    lopsided = HalfPeriods(Bar().period_map(bar(0.8, (0.5, 5.0))))
    assert lopsided.twins is None
    assert lopsided.least == 2
    assert HalfPeriods(Bar().period_map(bar(0.8, (0.5, 5.0), (-0.5, 5.0)))).twins == (1, 0)


def test_distances_are_relative_to_the_motion() -> None:
    halves = HalfPeriods(Bar().period_map(bar(2.0, (0.5, 5.0))))
    here, there = point_at(3.0, 8.0), point_at(3.5, 8.0)
    assert halves.map.size(here) == pytest.approx(5.0)
    assert halves.apart(there, here) == pytest.approx(0.1)
    assert halves.relative(np.zeros(2), point_at(0.0, 0.0)) == 0.0
