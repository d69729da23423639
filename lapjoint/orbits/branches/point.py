"""A curve point: one periodic motion with its contact sequence, the extrema of its gap functions, and its section."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from lapjoint.answers.steady_state import ComplexArray, SectionPoint
from lapjoint.orbits.arcs import ContactSequence, image_of
from lapjoint.orbits.branches.boundary_problem import BoundaryProblem, Linearisation
from lapjoint.orbits.branches.newton import Solution, solve
from lapjoint.orbits.compiled_extrema import gap_extrema
from lapjoint.orbits.compiled_intervals import IndexArray, Motion, Stops
from lapjoint.orbits.watch import row_of, rows_of, switches_of
from lapjoint.problem import FloatArray
from lapjoint.problem.symmetry import mirror_twins

SAME = 1e-6
"""Arclength below which two curve points are one: far above the error of a solution, 1e-9, and far below the length
over which a curve turns.  Also the largest distance of two equal motions, divided by their size, and of two
simultaneous events, divided by the length of the motion."""
_ROUNDED = 1e-9
"""Distance of a time from a multiple of half a period, divided by half a period, that is rounding."""


@dataclass(frozen=True)
class GapExtrema:
    """Extrema of the gap functions, where an open stop is nearest to closing, or a closed stop nearest to opening."""

    arc: IndexArray
    """Index of the arc of each extremum, shape ``(m,)``."""
    stop: IndexArray
    """The switch of each extremum: k of a stop, or ~k of the force of a damped stop, shape ``(m,)``."""
    time: FloatArray
    """Time of each, in s from the section, shape ``(m,)``."""
    violation: FloatArray
    """Distance of each extremum beyond its stop or, while the stop is closed, beyond opening, shape ``(m,)``, without
    unit.  The distance is divided by the stop's gap; if that is zero, by the largest gap; if all are zero, by the size
    of the motion.  A value above zero says that the contact sequence lacks two events."""
    lost: float
    """Largest displacement at a stop that a change of contact state loses, divided by the divisor of `violation`."""


@dataclass(frozen=True)
class CurvePoint:
    """A solution of a boundary value problem, and the tangent of its curve there."""

    problem: BoundaryProblem
    """The equations."""
    u: FloatArray = field(repr=False)
    """The unknowns, shape ``(n + F + 1,)``."""
    scale: FloatArray = field(repr=False)
    """Size of each unknown: the size of the motion for coordinates, the mean duration for durations, the size of the
    parameter for the parameter."""
    tangent: FloatArray = field(repr=False)
    """Unit tangent in scaled unknowns, in one of the two directions along the curve."""
    linearisation: Linearisation = field(repr=False)
    """Equations and derivative at the point."""
    orientation: int
    """Sign of the determinant of the derivative bordered by this tangent; it is constant along a smooth curve."""

    @staticmethod
    def of(problem: BoundaryProblem, solution: Solution, scale: FloatArray) -> CurvePoint:
        """A solution, found with a scale of shape (n + F + 1,), as a curve point with its own scale."""
        own = scale_of(problem, solution.u)
        tangent = solution.tangent * scale / own
        tangent /= np.linalg.norm(tangent)
        return CurvePoint(problem, solution.u, own, tangent, solution.linearisation, solution.orientation)

    @property
    def value(self) -> float:
        """The parameter, in its SI unit."""
        return float(self.u[-1])

    @property
    def coordinates(self) -> int:
        """Number ``n`` of coordinates of the section."""
        return self.problem.coordinates(self.u)

    @cached_property
    def durations(self) -> FloatArray:
        """Durations of all arcs, s, shape ``(M + 1,)``."""
        return self.problem.durations(self.u)

    @cached_property
    def shares(self) -> FloatArray:
        """Durations of all arcs, divided by the length of the motion, shape ``(M + 1,)``; read-only."""
        return self.problem.shares(self.u)

    @property
    def tolerance(self) -> float:
        """Violation below which an extremum only touches its stop: the grazing tolerance or, if larger,
        `GapExtrema.lost`."""
        return max(self.problem.resolution.options.grazing_tolerance, self.extrema.lost)

    @property
    def multipliers(self) -> ComplexArray:
        """Eigenvalues of the derivative of the map over all half periods of the motion, shape ``(n,)``."""
        return self.linearisation.multipliers

    @cached_property
    def twins(self) -> tuple[int, ...] | None:
        """The mirror twin of each stop, if the motion repeats mirrored after an odd number of half periods; else
        None."""
        return mirror_twins(self.problem.arcs(self.u).problem) if self.problem.half_periods % 2 else None

    @cached_property
    def extrema(self) -> GapExtrema:
        """The extrema of the gap functions along the motion."""
        arcs, chain = self.problem.arcs(self.u), self.linearisation.chain
        structure = arcs.problem.structure
        if not structure.stops:
            none = np.zeros(0, dtype=np.intp)
            return GapExtrema(none, none, np.zeros(0), np.zeros(0), 0.0)
        motion, stops = arcs.motion(self.problem.sequence, chain, self.durations), rows_of(structure.stops)
        stop, time, value, highest = gap_extrema(motion, stops)
        began = motion.start[motion.duration > 0]
        arc = np.flatnonzero(motion.duration > 0)[np.searchsorted(began, time, side="right") - 1]
        orientation = motion.orientation[arc, stop]
        is_open = orientation > 0
        sizes = self._sizes(stops.gap)
        keep: npt.NDArray[np.bool_] = (highest == is_open) & (orientation != 0)
        keep &= ~self._switches(motion, arc, stop, time)
        levels = self._levels(motion, stops)
        value = value - levels[arc, stop]
        violation = np.where(is_open, value, -value) / sizes[stop]
        lost = float((np.abs(levels) / sizes).max(initial=0.0))
        return GapExtrema(arc[keep], switches_of(structure.stops)[stop[keep]], time[keep], violation[keep], lost)

    @cached_property
    def _rows(self) -> IndexArray:
        """The row of `rows_of` that switches at each event, shape ``(M,)``."""
        stops = self.problem.arcs(self.u).problem.structure.stops
        return np.array([row_of(stops, switch) for switch in self.problem.sequence.stops], dtype=np.intp)

    def _switches(self, motion: Motion, arc: IndexArray, stop: IndexArray, time: FloatArray) -> npt.NDArray[np.bool_]:
        """Whether extrema, ``m`` of them, lie where their own stop switches, at the start of an arc."""
        found = np.zeros(arc.size, dtype=bool)
        for i in np.flatnonzero((arc > 0) & (time == motion.start[arc])):
            before = int(np.flatnonzero(motion.duration[: arc[i]] > 0)[-1])
            found[i] = stop[i] in self._rows[before : arc[i]]
        return found

    def _levels(self, motion: Motion, stops: Stops) -> FloatArray:
        """Value of each gap function at which its stop switches in each arc, in m, shape ``(M + 1, P)``.

        A stop that has just switched switches back at the value with which its arc began.  This value is zero, except
        for the part of the motion that is lost at a change of contact state.  A damped stop opens at the value with
        which its contact began.
        """
        levels, switched = np.zeros(motion.orientation.shape), self._rows
        if switched.size:
            after = [self.problem.group(i)[-1] + 1 for i in range(switched.size)]
            arcs, place = np.array(after), stops.place[switched]
            waves = (motion.weights[arcs, place] * motion.amplitudes[arcs]).real.sum(axis=1)
            z = waves + motion.polynomial[arcs, place, 0]
            levels[arcs, switched] = stops.sign[switched] * z - stops.gap[switched]
            for i in np.flatnonzero(self.problem.sequence.joining):
                levels[i, switched[i]] = levels[i - 1, switched[i]]
        return levels

    def _sizes(self, gaps: FloatArray) -> FloatArray:
        """Divisor of distances from each stop, m: its gap, or else the largest gap, or else the size of the motion."""
        largest = float(gaps.max(initial=0.0))
        return np.where(gaps > 0, gaps, largest if largest > 0 else float(np.abs(self.scale[: self.coordinates]).max()))

    def entering(self, arc: int, stop: int) -> tuple[float, float]:
        """First and second time derivative, in m/s and m/s2, with which a stop enters its side of the gap at the start
        of an arc.

        Positive values lead into the state that the stop has in the arc.  They are the derivatives of the gap function
        for a closed stop, and of minus the gap function for an open stop, in the contact state of the arc.
        """
        arcs = self.problem.arcs(self.u)
        motion = arcs.motion(self.problem.sequence, self.linearisation.chain, self.durations)
        rows, row = rows_of(arcs.problem.structure.stops), row_of(arcs.problem.structure.stops, stop)
        place, rates = rows.place[row], motion.rates[arc]
        waves, (_, one, two) = motion.weights[arc, place] * motion.amplitudes[arc], motion.polynomial[arc, place]
        rate, second = (float((waves * power).real.sum()) for power in (rates, rates**2))
        sign = -motion.orientation[arc, row] * rows.sign[row]
        return float(sign * (rate + one)), float(sign * (second + 2 * two))

    def predicted(self, length: float) -> FloatArray:
        """Unknowns at an arclength, of either sign, along the tangent, shape (n + F + 1,)."""
        return self.u + length * self.scale * self.tangent

    def arclength(self, other: CurvePoint) -> float:
        """Arclength, of either sign, at which another point of the curve lies along this point's tangent."""
        return float(self.tangent @ ((other.u - self.u) / self.scale))

    def turned(self) -> CurvePoint:
        """The curve point with the opposite tangent."""
        return replace(self, tangent=-self.tangent, orientation=-self.orientation)

    def sections(self) -> list[SectionPoint]:
        """The motion at all multiples of the excitation period within its length.

        If the problem is its own mirror image, multiples of half the period count, too; at odd multiples the mirror
        image of the motion is given.
        """
        arcs, chain = self.problem.arcs(self.u), self.linearisation.chain
        twins, half = mirror_twins(arcs.problem), arcs.period / 2
        first, found = int(np.ceil(chain.times[0] / half - _ROUNDED)), list[SectionPoint]()
        for k in range(first, first + self.problem.half_periods):
            if k % 2 and twins is None:
                continue
            i = max(int(np.searchsorted(chain.times, k * half, side="right")) - 1, 0)
            state, began = self.problem.sequence.states[i], float(chain.times[i])
            there = arcs.later(state, chain.starts[i], began, k * half - began)
            if k % 2 and twins is not None:
                state, there = state.mirrored(twins), -there
            found.append(arcs.point(state, there))
        return found

    def section(self) -> SectionPoint:
        """The motion at a multiple of the excitation period, from which the solver's march may begin.

        If the problem is its own mirror image, the mirror image is given at an odd multiple of half a period.
        """
        arcs, chain = self.problem.arcs(self.u), self.linearisation.chain
        k = int(np.ceil(2 * chain.times[0] / arcs.period - _ROUNDED))
        mirrors = mirror_twins(arcs.problem) is not None
        if self.problem.half_periods % 2:
            return self.sections()[0]  # each half period of this motion is the mirror image of the previous half period
        return self.sections()[1 if mirrors and k % 2 else 0]


def solved(
    problem: BoundaryProblem, guess: FloatArray, scale: FloatArray, row: FloatArray, exact: bool = False
) -> CurvePoint | None:
    """The curve point to which Newton's method leads from a guess, with the arguments of `newton.solve`; None if it
    finds none.

    The tangent has a positive product with `row`.
    """
    found = solve(problem, guess, scale, row, exact)
    return None if found is None else CurvePoint.of(problem, found, scale)


def holding(
    problem: BoundaryProblem, guess: FloatArray, unknown: int, scale: FloatArray | None = None
) -> CurvePoint | None:
    """The curve point near a guess at which one unknown keeps its value; None if Newton's method finds none.

    Guess and scale have shape (n + F + 1,); the tangent goes towards a larger value of the unknown.
    """
    row = np.zeros(guess.size)
    row[unknown] = 1.0
    return solved(problem, guess, scale_of(problem, guess) if scale is None else scale, row)


def scale_of(problem: BoundaryProblem, u: FloatArray) -> FloatArray:
    """Size of each unknown, in its own unit, shape (n + F + 1,); see `CurvePoint.scale`."""
    n = problem.coordinates(u)
    units = problem.arcs(u).unit_norms(problem.sequence.first)
    size = float(np.linalg.norm(u[:n] * units))
    durations = np.full(problem.free.size, 1 / (problem.events + 1))  # the mean duration
    return np.concatenate([max(size, np.finfo(float).tiny) / units, durations, [problem.resolution.scale(u[-1])]])


def resectioned(point: CurvePoint) -> tuple[BoundaryProblem, FloatArray, FloatArray]:
    """The motion of a point, with two events or more, with its section in the middle of the longest arc.

    Returns its equations, its unknowns, shape (n' + F + 1,), and the change of the unknowns, of that shape, over an
    arclength of `SAME` along the point's tangent.
    """
    durations = point.durations
    lengths = np.append(durations[1:-1], durations[0] + durations[-1])
    arc = (int(np.argmax(lengths)) + 1) % lengths.size
    shift = 0.5 * (durations[arc] if arc else durations[0] - durations[-1])
    problem, u = _at_section(point.problem, point.u, arc, shift)
    ahead = point.predicted(SAME)
    periods = (_began(point.problem, point.u, arc) + shift) / point.problem.arcs(point.u).period
    later = periods * point.problem.arcs(ahead).period - _began(point.problem, ahead, arc)  # at the same phase
    return problem, u, _at_section(point.problem, ahead, arc, later)[1] - u


def _began(problem: BoundaryProblem, u: FloatArray, arc: int) -> float:
    """Time at which an arc begins."""
    return problem.time(u) + float(problem.durations(u)[:arc].sum())


def _at_section(problem: BoundaryProblem, u: FloatArray, arc: int, shift: float) -> tuple[BoundaryProblem, FloatArray]:
    """The motion with its section `shift`, s, after the start of an arc, 0 to M - 1; a negative shift is for arc 0
    only."""
    arcs, chain, sequence = problem.arcs(u), problem.chain(u), problem.sequence
    durations, stops, mirrored = problem.durations(u), sequence.stops, problem.half_periods % 2
    twins = mirror_twins(arcs.problem) if mirrored else None
    if arc == 0 and shift < 0:  # the section is in the last arc, because backwards in time fast modes grow
        start = arcs.later(sequence.states[-1], chain.starts[-1], float(chain.times[-1]), float(durations[-1]) + shift)
        start = -start if mirrored else start
    else:
        start = arcs.later(sequence.states[arc], chain.starts[arc], float(chain.times[arc]), shift)
    image = [image_of(k, twins) for k in stops[:arc]] if twins is not None else list(stops[:arc])
    if arc:
        lengths = [durations[arc] - shift, *durations[arc + 1 : -1], durations[-1] + durations[0], *durations[1:arc]]
    else:
        lengths = [durations[0] - shift, *durations[1:-1]]
    order = ContactSequence(sequence.states[arc], (*stops[arc:], *image))
    tied = frozenset((i - arc) % len(stops) for i in problem.tied)
    phase = ((float(chain.times[arc]) + shift) / arcs.period) % 1.0
    moved = replace(problem, sequence=order, phase=phase, tied=tied)
    return moved, moved.packed(start, np.array(lengths) / problem.length(u), u[-1])
