"""The problem as a whole, and what its parts must obey together: see `lapjoint.problem` for the equation."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cached_property
from typing import Any, Self

import numpy as np
from pydantic import model_validator

from lapjoint.errors import InputError
from lapjoint.problem.beam import Beam
from lapjoint.problem.damping import Damping, NoDamping
from lapjoint.problem.excitation import BaseMotion, PointLoad
from lapjoint.problem.forces import Forces, forces_of
from lapjoint.problem.initial import AtRest, InitialState, SampledShape
from lapjoint.problem.messages import shown
from lapjoint.problem.schema import Part
from lapjoint.problem.supports_and_stops import Stop, Support


class Problem(Part):
    """A beam with supports, stops, damping, excitation and an initial state."""

    title: str = ""
    """What this problem is, in a line."""
    beam: Beam
    supports: tuple[Support, ...] = ()
    """Linear springs, always acting; none: a free beam."""
    stops: tuple[Stop, ...] = ()
    """Gapped one-sided springs."""
    damping: Damping = NoDamping()
    base_motion: BaseMotion | None = None
    point_loads: tuple[PointLoad, ...] = ()
    initial: InitialState = AtRest()

    @model_validator(mode="after")
    def _parts_fit_together(self) -> Self:
        faults = [*_outside_the_beam(self), *_names_used_twice(self), *_too_large(self)]
        if not faults:
            faults = [*_initial_off_the_beam(self)] or [*_initial_moves_fixed_supports(self)]
        if faults:
            raise ValueError("\n".join(faults))
        return self

    @property
    def stop_names(self) -> tuple[str, ...]:
        """Names of the stops, in order; those without a name are called ``stop 1``, ``stop 2`` ..."""
        return tuple(stop.name or f"stop {i + 1}" for i, stop in enumerate(self.stops))

    @cached_property
    def forces(self) -> Forces:
        """What drives the beam, whatever its kind: all that a solver has to know of it."""
        return forces_of(self.beam.m, self.base_motion, self.point_loads)

    @cached_property
    def excitation_frequency(self) -> float | None:
        """The one angular frequency of all periodic excitation, rad/s; None where there is none or several."""
        found = set(_angular_frequencies(self).values())
        return found.pop() if len(found) == 1 else None

    def require_excitation_frequency(self, purpose: str) -> float:
        """The one angular frequency of all periodic excitation, for what cannot be done without.

        Parameters
        ----------
        purpose : str
            What needs it, as "steady state"; the message begins with it.

        Returns
        -------
        float
            omega, rad/s.

        Raises
        ------
        InputError
            If there is no periodic excitation, or it has several frequencies; the message says which.
        """
        if self.excitation_frequency is not None:
            return self.excitation_frequency
        found = _angular_frequencies(self)
        there = ", ".join(f"{path}.angular_frequency = {omega:.10g}" for path, omega in found.items())
        raise InputError(
            f"{purpose}: base_motion and sine loads must have one common angular_frequency; "
            + (there or "there is neither a base_motion with an amplitude nor a sine load with a force")
        )

    def require_excitation_period(self, purpose: str) -> float:
        """The one period of all periodic excitation, for what cannot be done without.

        Parameters
        ----------
        purpose : str
            What needs it, as "steady state"; the message begins with it.

        Returns
        -------
        float
            T = 2 pi / omega, s.

        Raises
        ------
        InputError
            If there is no periodic excitation, or it has several frequencies; the message says which.
        """
        return 2 * math.pi / self.require_excitation_frequency(purpose)

    def replace(self, **changes: Any) -> Problem:
        """A validated copy with some of the top-level parts changed.

        Parameters
        ----------
        **changes : object
            New values by the names of the parts, as ``stops=()``.

        Returns
        -------
        Problem
            The copy; this problem stays as it is.

        Raises
        ------
        pydantic.ValidationError
            If the parts do not fit together.
        """
        return Problem.model_validate({name: getattr(self, name) for name in Problem.model_fields} | changes)


def _angular_frequencies(problem: Problem) -> dict[str, float]:
    """Angular frequencies, rad/s, of base motion and sine loads that are not zero, by their paths."""
    waves = {} if problem.base_motion is None else {"base_motion": problem.base_motion.waves}
    waves |= {f"point_loads[{i}]": load.waves for i, load in enumerate(problem.point_loads)}
    return {path: wave.angular_frequency for path, of in waves.items() for wave in of if wave.amplitude}


def _outside_the_beam(problem: Problem) -> Iterator[str]:
    L = problem.beam.length
    for group in ("supports", "stops", "point_loads"):
        for i, part in enumerate(getattr(problem, group)):
            if part.x > L:
                yield f"{group}[{i}].x = {part.x:g}: lies outside the beam; allowed are 0 to {L:g} m"


def _names_used_twice(problem: Problem) -> Iterator[str]:
    first: dict[str, int] = {}
    for i, name in enumerate(problem.stop_names):
        if first.setdefault(name, i) < i:
            yield f"stops[{i}].name = {shown(name)}: is the name of stops[{first[name]}] too"


def _too_large(problem: Problem) -> Iterator[str]:
    """What is not finite of the numbers that follow from several fields."""
    motion = problem.base_motion
    if motion is not None:
        squared = motion.angular_frequency * motion.angular_frequency
        if not (math.isfinite(squared) and math.isfinite(motion.amplitude * squared) and squared > 0):
            yield (
                f"base_motion: the acceleration comes to {motion.amplitude * squared:g}, and must be finite; "
                "it follows from amplitude and angular_frequency"
            )
    for i, stop in enumerate(problem.stops):
        if not math.isfinite(stop.stiffness * stop.gap):
            yield (
                f"stops[{i}]: stiffness times gap comes to {stop.stiffness * stop.gap:g}, and must be finite; "
                "it follows from stiffness and gap"
            )


def _initial_off_the_beam(problem: Problem) -> Iterator[str]:
    initial, L = problem.initial, problem.beam.length
    if isinstance(initial, SampledShape) and (initial.x[0] != 0.0 or initial.x[-1] != L):
        yield f"initial.x: runs from {initial.x[0]:g} to {initial.x[-1]:g}, and must run from 0 to {L:g} m"


def _initial_moves_fixed_supports(problem: Problem) -> Iterator[str]:
    initial = problem.initial
    if isinstance(initial, AtRest):
        return
    grid = np.linspace(0.0, problem.beam.length, 101)
    for name, shape in (("displacement", initial.displacement_at), ("velocity", initial.velocity_at)):
        for derivative, word, spring in ((0, "moves", "translational"), (1, "turns", "torsional")):
            # A spline of a callable meets a fixed support to its interpolation error only.
            allowed = 1e-6 * float(np.max(np.abs(shape(grid, derivative)), initial=0.0))
            for i, support in enumerate(problem.supports):
                value = float(shape(np.array(support.x), derivative))
                if math.isinf(getattr(support, spring)) and abs(value) > allowed:
                    yield (
                        f"initial.{name}: {word} supports[{i}] at x = {support.x:g} m, which is fixed; "
                        f"{'its slope' if derivative else 'it'} is {value:g} there and must be 0"
                    )
