"""The static equilibrium of a joint under its static loads, and the means to evaluate it anywhere."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np

from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.shown import Shown
from lapjoint.problem import FloatArray, Problem

_NO_TURN = 1e-9
"""Largest displacement by turning, as a fraction of that by shifting, of a rigid motion that is called a shift."""


class StaticShape(Protocol):
    """The deflected shape z(x) and its derivatives."""

    def __call__(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """A derivative of z.

        Where it jumps, the value is the one to the left (to the right at x = 0).

        Parameters
        ----------
        x : FloatArray, shape (n,)
            Positions, m, from 0 to L.
        derivative : int
            Order of the x-derivative, 0 to 3.

        Returns
        -------
        FloatArray, shape (n,)
            The derivative, m^(1 - derivative).
        """


@dataclass(frozen=True)
class EquilibriumErrors:
    """Numerical errors of an equilibrium; those of the shape hold everywhere along the beam."""

    displacement: float
    """Of z, m."""
    slope: float
    """Of z_x, rad."""
    moment: float
    """Of EI z_xx, N m."""
    shear: float
    """Of EI z_xxx, N."""
    contact_forces: FloatArray
    """Of the force of each stop, N, shape ``(stops,)``."""
    support_forces: FloatArray
    """Of the force of each support, N, shape ``(supports,)``."""
    support_moments: FloatArray
    """Of the couple of each support, N m, shape ``(supports,)``."""


@dataclass(frozen=True)
class Extreme:
    """The largest magnitude of a quantity along the beam."""

    x: float
    """Where it is, m."""
    value: float
    """The quantity there, with its sign."""
    error: float
    """Estimate of the numerical error of the value."""


@dataclass(frozen=True)
class Equilibrium(Shown):
    """The static equilibrium of a joint, with its contact forces and the means to evaluate it anywhere.

    The loads are gravity, the uniform loads and the constant parts of the point loads.  A moving base and loads that
    change with time do not count; stops that are fixed to space are where they are at y = 0.
    """

    problem: Problem
    solver: str
    """Name of the solver and its numerical options, for tables and files."""
    state: ContactState
    """The stops that press the beam."""
    contact_forces: FloatArray
    """Magnitude of the force of each stop, N, at least 0 on either side, shape ``(stops,)``; a top stop pushes the beam
    down, a bottom stop up."""
    support_forces: FloatArray
    """Force of each support on the beam, N, positive upwards, shape ``(supports,)``."""
    support_moments: FloatArray
    """Couple of each support on the beam, N m, positive in the sense of a positive slope, shape ``(supports,)``."""
    shape: StaticShape
    """z(x), m, and its derivatives."""
    errors: EquilibriumErrors
    error_source: str
    """How the errors were estimated."""
    other_equilibria: str = ""
    """A sentence that says how else the joint can rest, if the equilibrium is not unique; else empty."""

    @property
    def unique(self) -> bool:
        """Whether there is no other equilibrium.

        The forces and the bending of all equilibria are the same.  They differ by a rigid motion that no support
        resists, within the gaps; given is the one nearest to the straight beam, in mean square.
        """
        return not self.other_equilibria

    def displacement(self, x: FloatArray | float) -> FloatArray:
        """z(x), the displacement, m, positive upwards, shape (n,).  See `Equilibrium.evaluate`."""
        return self.evaluate(x)

    def slope(self, x: FloatArray | float) -> FloatArray:
        """z_x(x), the slope, rad, shape (n,).  See `Equilibrium.evaluate`."""
        return self.evaluate(x, 1)

    def moment(self, x: FloatArray | float) -> FloatArray:
        """EI z_xx, the bending moment, N m, shape (n,).  See `Equilibrium.evaluate`."""
        return self.problem.line.EI_at(np.atleast_1d(np.asarray(x, dtype=float))) * self.evaluate(x, 2)

    def shear(self, x: FloatArray | float) -> FloatArray:
        """EI z_xxx, the shear force, N, shape (n,).  See `Equilibrium.evaluate`."""
        return self.problem.line.EI_at(np.atleast_1d(np.asarray(x, dtype=float))) * self.evaluate(x, 3)

    def bending_stress(self, x: FloatArray | float) -> FloatArray:
        """-E c z_xx, the bending stress at the top of the section, Pa, tension positive.  See `Equilibrium.evaluate`.

        The top lies c above the axis; the stress at the bottom is the opposite.  At a step of the beam it is the larger
        stress of both sides.  A beam without a section is an `InputError`.
        """
        x_ = np.atleast_1d(np.asarray(x, dtype=float))
        return -self.problem.line.stress_per_moment_at(x_) * self.moment(x_)

    def evaluate(self, x: FloatArray | float, derivative: int = 0) -> FloatArray:
        """Any derivative of z; where it jumps, the value is the one to the left (to the right at x = 0).

        Parameters
        ----------
        x : float or FloatArray, shape (n,)
            Positions, m, from 0 to L.
        derivative : int
            Order of the x-derivative, 0 to 3.

        Returns
        -------
        FloatArray, shape (n,)
            The derivative, m^(1 - derivative); n = 1 for a single number.

        Raises
        ------
        ValueError
            If a position is outside the beam.
        """
        x_ = np.atleast_1d(np.asarray(x, dtype=float))
        self.problem.line.check(x_)
        return self.shape(x_, derivative)

    def largest_moment(self) -> Extreme:
        """The bending moment, N m, of largest magnitude along the beam, with its place and its error."""
        found = max(_moments(self), key=lambda at: abs(at[1]))
        return Extreme(*found, self.errors.moment)

    def largest_stress(self) -> Extreme:
        """The bending stress at the top, Pa, of largest magnitude along the beam; `InputError` without a section."""
        beam = self.problem.line
        beam.require_sections("stress")
        places = np.array(list(_moments(self)))
        stress = -beam.stress_per_moment_at(places[:, 0]) * places[:, 1]
        most = int(np.argmax(np.abs(stress)))
        factor = float(beam.stress_per_moment_at(places[:, 0]).max())
        return Extreme(float(places[most, 0]), float(stress[most]), factor * self.errors.moment)


@dataclass(frozen=True)
class RestingStart:
    """The initial state of a motion that starts at rest in a static equilibrium."""

    found: Equilibrium

    def displacement_at(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """z(x, 0) or an x-derivative of it.

        Parameters
        ----------
        x : FloatArray, shape (...)
            Positions, m, in an array of any shape.
        derivative : int
            Order of the x-derivative, 0 to 3.

        Returns
        -------
        FloatArray, shape (...)
            The derivative, in m over m^derivative, an array shaped like `x`.
        """
        return self.found.shape(np.asarray(x, dtype=float), derivative)

    def velocity_at(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """z_t(x, 0), which is zero, m/s, shaped like `x`. See `RestingStart.displacement_at`."""
        return np.zeros_like(np.asarray(x, dtype=float))

    def pressed(self, stop: int) -> bool:
        """Whether a stop presses, whatever the base does; `stop` is its index."""
        return stop in self.found.state and not self.found.problem.structure.stops[stop].in_space

    def kept_in(self, state: ContactState) -> bool:
        """Whether the equilibrium is one with the stops of a contact state closed, touching ones among them."""
        stops = self.found.problem.structure.stops
        return all(not stops[k].in_space for k in {*state.closed} ^ {*self.found.state.closed})


def _moments(found: Equilibrium) -> list[tuple[float, float]]:
    """Places, m, among which the moment is largest, and the moment there, N m.

    Between two places where anything acts or the beam changes, the moment is a quadratic function of x.
    """
    places: list[float] = []
    moments: list[float] = []
    for a, b in pairwise(breaks_of(found.problem)):
        if (a, b) in found.problem.line.spaces:
            continue
        first = min(float(np.nextafter(a, b)), b)
        one, other = found.shear(np.array([a + (b - a) / 4, b - (b - a) / 4]))
        level = a + (b - a) * (0.25 + 0.5 * one / (one - other)) if one != other else a
        inside = [level] if a < level < b else []
        places += [a, *inside, b]
        moments += found.moment(np.array([first, *inside, b])).tolist()
    return list(zip(places, moments, strict=True))


def breaks_of(problem: Problem) -> tuple[float, ...]:
    """Positions, m, ascending from 0 to L, of all that acts at points, and of all ends of segments and static loads."""
    structure = problem.structure
    found = {*problem.line.edges, *(piece.end for piece in problem.line.pieces)}
    found |= {x for stop in structure.stops for x, _ in stop.reading}
    found |= {x for link in structure.links for x in (link.first, link.second)}
    found |= {part.x for part in structure.supports} | {part.x for part in structure.masses}
    found |= {x for force in problem.forces.constant for x in force.shape.edges}
    return tuple(sorted(found))


def rigid_motion(shift: float, turn: float, length: float, both_ways: bool = False) -> str:
    """The words for a rigid motion of the root by `shift`, m, and of the slope by `turn`, rad, of a beam of a length,
    m; without the sense of the motion, if it is possible `both_ways`."""
    if abs(turn) * length <= _NO_TURN * abs(shift):
        return "a shift" + ("" if both_ways else " upwards" if shift > 0 else " downwards")
    sense = "" if both_ways else " anticlockwise" if turn > 0 else " clockwise"
    return f"a turn{sense} about x = {-shift / turn + 0.0:.6g} m"


def nothing_resists(shift: float, turn: float, length: float) -> str:
    """The message that there is no equilibrium, for the loads drive a rigid motion; see `rigid_motion`."""
    return (
        f"equilibrium: there is none: the static loads drive {rigid_motion(shift, turn, length)} of the whole beam, "
        "which neither supports nor stops resist"
    )


def nothing_holds(shift: float, turn: float, length: float, both_ways: bool, others: bool) -> str:
    """The sentence of an equilibrium that a rigid motion does not change, one way or both, or that many do not."""
    if others:
        return "The equilibrium is not unique: nothing holds the beam, which may be shifted and turned within the gaps."
    name = rigid_motion(shift, turn, length, both_ways)
    return f"The equilibrium is not unique: nothing holds the beam against {name}, within the gaps."
