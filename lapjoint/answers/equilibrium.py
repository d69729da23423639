"""The static equilibrium of a joint under its static loads, and the means to evaluate it anywhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np

from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.shown import Shown
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.line import Line

Places = FloatArray | float | str
"""Positions on the line of beams, m; or one place as files state it, as ``upper:0.3``."""
_NO_TURN = 1e-9
"""Largest displacement by turning, as a fraction of that by shifting, of a rigid motion that is called a shift; and
of a beam, as a fraction of the largest, of one that is called still."""


class StaticShape(Protocol):
    """The deflected shape z(x) and its derivatives."""

    def __call__(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """A derivative of z.

        Where it jumps, the value is the one to the left (to the right at the left end of a beam).

        Parameters
        ----------
        x : FloatArray, shape (n,)
            Positions on the line of beams, m.
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
    link_forces: FloatArray
    """Of the force of each link, N, shape ``(links,)``."""
    link_moments: FloatArray
    """Of the couple of each link, N m, shape ``(links,)``."""


@dataclass(frozen=True)
class Extreme:
    """The largest magnitude of a quantity along the beams, or the quantity at the end of a beam."""

    x: float
    """Where it is on the line of beams, m."""
    value: float
    """The quantity there, with its sign."""
    error: float
    """Estimate of the numerical error of the value."""


@dataclass(frozen=True, repr=False)
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
    down, a bottom stop up, a stop between two beams the first up and the second down."""
    support_forces: FloatArray
    """Force of each support on the beam, N, positive upwards, shape ``(supports,)``; see `Structure.idle`."""
    support_moments: FloatArray
    """Couple of each support on the beam, N m, positive in the sense of a positive slope, shape ``(supports,)``."""
    link_forces: FloatArray
    """Force of each link on its second beam, N, positive upwards, shape ``(links,)``; that on the first is opposite."""
    link_moments: FloatArray
    """Couple of each link on its second beam, N m, positive in the sense of a positive slope, shape ``(links,)``."""
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

    def displacement(self, x: Places) -> FloatArray:
        """z(x), the displacement, m, positive upwards, shape (n,).  See `Equilibrium.evaluate`."""
        return self.evaluate(x)

    def slope(self, x: Places) -> FloatArray:
        """z_x(x), the slope, rad, shape (n,).  See `Equilibrium.evaluate`."""
        return self.evaluate(x, 1)

    def moment(self, x: Places) -> FloatArray:
        """EI z_xx, the bending moment, N m, shape (n,).  See `Equilibrium.evaluate`."""
        return self.problem.line.EI_at(self._at(x)) * self.evaluate(x, 2)

    def shear(self, x: Places) -> FloatArray:
        """EI z_xxx, the shear force, N, shape (n,).  See `Equilibrium.evaluate`."""
        return self.problem.line.EI_at(self._at(x)) * self.evaluate(x, 3)

    def bending_stress(self, x: Places) -> FloatArray:
        """-E c z_xx, the bending stress at the top of the section, Pa, tension positive.  See `Equilibrium.evaluate`.

        The top lies c above the axis; the stress at the bottom is the opposite.  At a step of the beam it is the larger
        stress of both sides.  A beam without a section is an `InputError`.
        """
        return -self.problem.line.stress_per_moment_at(self._at(x)) * self.moment(x)

    def evaluate(self, x: Places, derivative: int = 0) -> FloatArray:
        """Any derivative of z; where it jumps, the value is the one to the left (to the right at a beam's left end).

        Parameters
        ----------
        x : float, str, or FloatArray, shape (n,)
            Positions, m, from 0 to L; of several beams a place, as ``upper:0.3``, or positions on the line of beams, as
            ``problem.line.at`` and ``problem.line.grid`` give them.
        derivative : int
            Order of the x-derivative, 0 to 3.

        Returns
        -------
        FloatArray, shape (n,)
            The derivative, m^(1 - derivative); n = 1 for a single place.

        Raises
        ------
        ValueError
            If a position is outside the beam.
        """
        at = self._at(x)
        self.problem.line.check(at)
        return self.shape(at, derivative)

    def _at(self, x: Places) -> FloatArray:
        """Positions on the line, m, ``(n,)``."""
        return np.atleast_1d(np.asarray(self.problem.line.at(x) if isinstance(x, str) else x, dtype=float))

    @property
    def tips(self) -> tuple[Extreme, ...]:
        """The displacement, m, of the right end of each beam, with its place and its error."""
        ends, z = self.problem.line.ends, self.displacement(np.array(self.problem.line.ends))
        return tuple(Extreme(x, float(value), self.errors.displacement) for x, value in zip(ends, z, strict=True))

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


def rigid_motion(line: Line, motion: Sequence[float], both_ways: bool = False) -> str:
    """The words for a rigid motion, of each beam the displacement of its left end, m, and its slope, ``(2 beams,)``;
    without the sense of the motion, if it is possible `both_ways`."""
    parts = []
    moves = [
        (beam.length, shift, turn) for beam, shift, turn in zip(line.beams, motion[::2], motion[1::2], strict=True)
    ]
    largest = max(abs(end) for L, shift, turn in moves for end in (shift, shift + turn * L))
    for name, (L, shift, turn) in zip(line.names, moves, strict=True):
        of = f" of {name}" if line.several else ""
        if max(abs(shift), abs(shift + turn * L)) <= _NO_TURN * largest:
            continue
        if abs(turn) * L <= _NO_TURN * abs(shift):
            parts.append("a shift" + of + ("" if both_ways else " upwards" if shift > 0 else " downwards"))
        else:
            sense = "" if both_ways else " anticlockwise" if turn > 0 else " clockwise"
            centre = 0.0 if abs(shift) <= _NO_TURN * abs(turn) * L else -shift / turn
            parts.append(f"a turn{of}{sense} about x = {centre:.6g} m")
    return " with ".join(parts)


def nothing_resists(line: Line, motion: Sequence[float]) -> str:
    """The message that there is no equilibrium, for the loads drive a rigid motion; see `rigid_motion`."""
    of, held = ("", "supports, links nor stops") if line.several else (" of the whole beam", "supports nor stops")
    return (
        f"equilibrium: there is none: the static loads drive {rigid_motion(line, motion)}{of}, which neither {held} "
        "resist"
    )


def nothing_holds(line: Line, motion: Sequence[float], both_ways: bool, others: bool) -> str:
    """The sentence of an equilibrium that a rigid motion does not change, one way or both, or that many do not."""
    if others:
        held = "some beams, which" if line.several else "the beam, which"
        return f"The equilibrium is not unique: nothing holds {held} may be shifted and turned within the gaps."
    held = "the beams" if line.several else "the beam"
    name = rigid_motion(line, motion, both_ways)
    return f"The equilibrium is not unique: nothing holds {held} against {name}, within the gaps."
