"""A period map whose motions are known: a fixed point that stands still, with multipliers that are given functions.

P(x, p) = c + A(p) (x - c) with the real block diagonal matrix A(p) that has the multipliers wanted at p.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from lapjoint import FREE, BaseMotion, Beam, NoDamping, Problem, StepLoad, Support
from lapjoint.answers import History, SectionPoint
from lapjoint.orbits import Passage
from lapjoint.orbits.period_map import Derivative, Linearised
from lapjoint.problem import FloatArray

Blocks = Callable[[float], list[FloatArray]]
"""The blocks of A at a number p."""


def pair(modulus: float, angle: float) -> FloatArray:
    """The block of a complex pair."""
    c, s = modulus * np.cos(angle), modulus * np.sin(angle)
    return np.array([[c, -s], [s, c]])


def of_trace(trace: float, determinant: float) -> FloatArray:
    """The block of two multipliers with a sum and a product, which may be real or a pair."""
    return np.array([[trace, -determinant], [1.0, 0.0]])


@dataclass(frozen=True)
class MadeMap:
    """See `lapjoint.orbits.PeriodMap`."""

    problem: Problem
    matrix: FloatArray

    period = 1.0
    lowest_damping_rate = 1.0

    def initial(self) -> SectionPoint:
        """The fixed point."""
        return SectionPoint(FREE, np.ones((1, self.matrix.shape[0])))

    def march(self, start: SectionPoint, half_periods: int) -> Passage:
        """The map, as often as there are whole periods."""
        return Passage(self.linearised(start, half_periods).end, np.zeros(0), 0)

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """The same with its derivative."""
        power = np.linalg.matrix_power(self.matrix, half_periods // 2)
        end = SectionPoint(FREE, 1 + (start.coordinates - 1) @ power.T)
        return Linearised(end, lambda: Derivative(power), tuple)

    def history(self, start: SectionPoint, periods: int) -> History:
        """A motion without contact."""

        def field(x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
            return np.zeros((x.size, t.size))

        return History(self.problem, "made", 0.0, float(periods), np.zeros(0), (FREE,), (), field)

    def difference(self, point: SectionPoint, origin: SectionPoint) -> FloatArray:
        """As it says."""
        return np.asarray((point.coordinates - origin.coordinates)[0])

    def norm(self, deviation: FloatArray) -> float:
        """Euclidean."""
        return float(np.linalg.norm(deviation))

    def size(self, point: SectionPoint) -> float:
        """Of the coordinates."""
        return self.norm(point.coordinates[0])

    def moved(self, origin: SectionPoint, deviation: FloatArray) -> SectionPoint:
        """As it says."""
        return SectionPoint(FREE, origin.coordinates + deviation)

    def mirrored(self, point: SectionPoint) -> SectionPoint:
        """Never asked for."""
        raise NotImplementedError

    def adopted(self, point: SectionPoint) -> SectionPoint:
        """The same."""
        return point


@dataclass(frozen=True)
class Made:
    """A solver that gives such maps; p is the amplitude of the base, m."""

    blocks: Blocks
    name = "made"

    def period_map(self, problem: Problem) -> MadeMap:
        """The map at the amplitude of a problem."""
        assert isinstance(problem.base_motion, BaseMotion)
        blocks = self.blocks(problem.base_motion.amplitude)
        n = sum(len(block) for block in blocks)
        matrix, i = np.zeros((n, n)), 0
        for block in blocks:
            matrix[i : i + len(block), i : i + len(block)] = block
            i += len(block)
        return MadeMap(problem, matrix)


@dataclass(frozen=True)
class TongueMap(MadeMap):
    """An angle that is locked: a -> a + 2 pi / n + c (2 detuning - cos(n a)), c = 0.3 / n^2, on a circle that attracts.

    Motions of ``n`` periods have cos(n a) = 2 detuning.  Over the detuning they are one closed curve with folds at plus
    and minus a half, which comes to the same motion, a period later, each time that a has gone on by 2 pi / n.
    """

    multiple: int = 1
    detuning: float = 0.0

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """See `MadeMap`."""
        x, y = start.coordinates[0]
        r, a, n = np.hypot(x, y), np.arctan2(y, x), self.multiple
        c = 0.3 / n**2
        polar = np.array([[np.cos(a), np.sin(a)], [-np.sin(a) / r, np.cos(a) / r]])
        for _ in range(half_periods // 2):
            polar = np.array([[0.5], [1 + c * n * np.sin(n * a)]]) * polar
            a, r = a + 2 * np.pi / n + c * (2 * self.detuning - np.cos(n * a)), 1 + 0.5 * (r - 1)
        back = np.array([[np.cos(a), -r * np.sin(a)], [np.sin(a), r * np.cos(a)]])
        end = SectionPoint(FREE, r * np.array([[np.cos(a), np.sin(a)]]))
        return Linearised(end, lambda: Derivative(back @ polar), tuple)


@dataclass(frozen=True)
class Tongue:
    """A solver that gives such maps; the detuning is the amplitude of the base, m, less 1."""

    multiple: int
    name = "tongue"

    def period_map(self, problem: Problem) -> TongueMap:
        """The map at the amplitude of a problem."""
        assert isinstance(problem.base_motion, BaseMotion)
        return TongueMap(problem, np.eye(2), self.multiple, problem.base_motion.amplitude - 1)


def made_problem(amplitude: float) -> Problem:
    """A problem to hang the number on; under a constant load, so that no motion is its own mirror image."""
    return Problem(
        beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
        supports=(Support(x=0.0, translational=1.0), Support(x=1.0, translational=1.0)),
        damping=NoDamping(),
        point_loads=(StepLoad(x=0.5, force=1.0),),
        base_motion=BaseMotion(amplitude=amplitude, angular_frequency=2 * np.pi),
    )
