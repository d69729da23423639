r"""Starts other than rest: a section point, moved in a plane of two coordinates, or at random in all of phase space.

A unit force at a place a bends the joint without contact into its static shape G(x, a).  A *plane* of starts has two
coordinates, each the displacement or the velocity at a place: with the displacements Z_i given at places a_i, the
displacement of the section point changes by

    z(x) = sum_i f_i G(x, a_i),    sum_i G(a_j, a_i) f_i = Z_j

and its velocity likewise, so that each coordinate changes by the given number at its place.  Random starts are drawn
evenly from all deviations from a section point whose energy does not exceed a bound.  The energy is that of bending,
springs and motion of the joint without contact.  The fraction of starts that end in a motion then estimates the
fraction of this part of phase space from which the motion is reached.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.plane import Plane

_IMMOVABLE = 1e-12
"""Compliance at a place, in units of L^3 / EI, below which a support holds the place; rounding of the shapes is
smaller."""
_ALIKE = 1e-6
"""Determinant of the compliance of two places, divided by the product of its diagonal, below which the places move
together; for independent places the ratio is 1."""


@dataclass(frozen=True)
class StaticShapes:
    """The joint without contact under a unit force at each of ``p`` places, as deviations of ``n`` coordinates."""

    displacements: FloatArray
    """Deviations that move a section point by each shape for a force of 1 N, shape ``(p, n)``."""
    velocities: FloatArray
    """Deviations that add each shape to the velocity of a section point, m/s for a shape in m, shape ``(p, n)``."""
    compliance: FloatArray
    """Displacement at each place under a unit force at each place, m/N, shape ``(p, p)``."""


@runtime_checkable
class DisplacedStarts(Protocol):
    """A period map that knows the joint without contact well enough to start motions anywhere.

    The supports must hold the joint without contact: no rigid-body motion may be free.
    """

    def static_shapes(self, origin: SectionPoint, places: FloatArray) -> StaticShapes:
        """The static shapes of unit forces at `places`, m, (p,), as deviations in the coordinates of `origin`."""

    def energy(self, origin: SectionPoint) -> FloatArray:
        """The matrix A, (n, n), of the energy e . A e / 2, J, of a deviation e from `origin` without contact.

        It is symmetric and positive definite.
        """


def plane_directions(period_map: DisplacedStarts, problem: Problem, origin: SectionPoint, plane: Plane) -> FloatArray:
    """The deviations that move `origin` by 1 m, or 1 m/s, in one coordinate of a plane, and by 0 in the other, (2, n).

    An `InputError` is raised if the supports do not hold the joint, a support holds a place, or both places move
    together.
    """
    plane.check(problem)
    check_held(problem, "plane")
    shapes = period_map.static_shapes(origin, np.array([problem.position(one.place) for one in plane.coordinates]))
    compliance = shapes.compliance
    soft = problem.line.length**3 / problem.line.EI
    for one, own in zip(plane.coordinates, np.diag(compliance), strict=True):
        if own <= _IMMOVABLE * soft:
            raise InputError(f"plane = {str(plane)!r}: {one} cannot be moved, for a support holds it")
    if plane.first.kind != plane.second.kind:
        compliance = np.diag(np.diag(compliance))
    elif np.linalg.det(compliance) <= _ALIKE * compliance[0, 0] * compliance[1, 1]:
        raise InputError(f"plane = {str(plane)!r}: both places move alike; choose them farther apart")
    rows = [
        (shapes.displacements if one.kind == "z" else shapes.velocities)[i] for i, one in enumerate(plane.coordinates)
    ]
    return np.asarray(np.linalg.inv(compliance).T @ np.array(rows))


def random_deviation(roots: FloatArray, energy: float, seed: tuple[int, ...]) -> FloatArray:
    """A deviation, (n,), drawn evenly from all of energy up to `energy`, J; `roots`, (n, n), are those of
    `energy_roots`."""
    rng = np.random.default_rng(seed)
    n = roots.shape[1]
    direction = rng.standard_normal(n)
    size = math.sqrt(2 * energy) * rng.random() ** (1 / n) / float(np.linalg.norm(direction))
    return np.asarray(size * (roots @ direction))


def energy_roots(period_map: DisplacedStarts, problem: Problem, origin: SectionPoint) -> FloatArray:
    """A matrix B, (n, n), with B^T A B = I for the A of `DisplacedStarts.energy`; the supports must hold the joint.

    B maps the unit ball to the deviations from `origin` whose energy is at most 1/2 J.
    """
    check_held(problem, "energy")
    lower = np.linalg.cholesky(period_map.energy(origin))
    return np.asarray(np.linalg.inv(lower).T)


def check_held(problem: Problem, what: str) -> None:
    """Refuse a problem whose supports leave a rigid-body motion free; `what` names the purpose in the message."""
    if problem.structure.free_motions:
        raise InputError(
            f"{what}: without contact the supports leave the beam free to move as a rigid body, so that a force has no "
            "static shape and no energy bounds its motion"
        )
