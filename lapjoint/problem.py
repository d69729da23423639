"""What is solved: an immutable, validated description of a beam, its supports, its stops and its excitation.

The beam lies along x, from the root (x = 0) to the tip (x = L).  z(x, t) is the displacement relative to the
moving base, positive upwards; y(t) = Y sin(omega t + phase) is the base.  With E I = EI and rho A = m::

    EI z'''' + damping + m z_tt = m Y omega^2 sin(omega t + phase) + supports + stops + point loads

A closed stop pushes with ``-k (|z| - gap) sign(z)``.  SI units throughout, angles in radians, angular
frequencies in rad/s.  Nothing numerical (modes, elements, tolerances) belongs here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cached_property
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Discriminator, Field, Tag, model_validator

from lapjoint.beam import Beam, Circle, Material, Rectangle, Section, Tube
from lapjoint.initial import (
    AtRest,
    InitialState,
    PolynomialShape,
    SampledShape,
    ShapeFunction,
    initial_from_functions,
)
from lapjoint.schema import Finite, FloatArray, NonNegative, Part, Positive, SpringStiffness

__all__ = [
    "AtRest",
    "BaseMotion",
    "Beam",
    "Circle",
    "Damping",
    "Finite",
    "FloatArray",
    "InitialState",
    "Material",
    "ModalDamping",
    "NoDamping",
    "NonNegative",
    "Part",
    "PointLoad",
    "PolynomialShape",
    "Positive",
    "Problem",
    "Rectangle",
    "SampledShape",
    "Section",
    "ShapeFunction",
    "Side",
    "SineLoad",
    "SpringStiffness",
    "StepLoad",
    "Stop",
    "Support",
    "Tube",
    "ViscousDamping",
    "initial_from_functions",
]


class Support(Part):
    """Linear springs between beam and base at one point, always acting; an infinite stiffness fixes."""

    x: NonNegative
    """Position, m, within the beam."""
    translational: SpringStiffness = 0.0
    """Translational stiffness k, N/m, from 0 to inf."""
    torsional: SpringStiffness = 0.0
    """Torsional stiffness kt, N m/rad, from 0 to inf."""


Side = Literal["top", "bottom"]


class Stop(Part):
    """A one-sided spring that the beam meets after crossing a gap."""

    x: NonNegative
    """Position, m, within the beam."""
    side: Side
    """"top" acts at z > gap, "bottom" at z < -gap."""
    gap: NonNegative
    """Gap when the beam is straight, m."""
    stiffness: Positive
    """Spring stiffness k, N/m."""
    name: str = ""
    """Name shown in tables; empty: numbered in the order given."""

    @property
    def sign(self) -> int:
        """+1 for a top stop, -1 for a bottom stop: closed where ``sign * z > gap``."""
        return 1 if self.side == "top" else -1


def _one_or_each(value: object) -> str:
    return "each" if isinstance(value, list | tuple) else "one"


class NoDamping(Part):
    """No damping."""

    kind: Literal["none"] = "none"


class ModalDamping(Part):
    """Damping ratios in the modes of the current contact state (the paper's)."""

    kind: Literal["modal"] = "modal"
    ratio: Annotated[
        Annotated[NonNegative, Tag("one")] | Annotated[tuple[NonNegative, ...], Field(min_length=1), Tag("each")],
        Discriminator(_one_or_each),
    ]
    """One ratio for every mode, or one per mode from the lowest; the last then holds for all above."""

    def ratios(self, count: int) -> FloatArray:
        """Damping ratios of the first `count` modes, shape ``(count,)``."""
        given = np.atleast_1d(np.asarray(self.ratio, dtype=float))
        return given[np.minimum(np.arange(count), given.size - 1)]


class ViscousDamping(Part):
    """Damping force C z_t per unit length, equation (1) of the paper taken literally."""

    kind: Literal["viscous"] = "viscous"
    coefficient: NonNegative
    """C, N s/m2."""


Damping = Annotated[NoDamping | ModalDamping | ViscousDamping, Field(discriminator="kind")]


class BaseMotion(Part):
    """Harmonic motion of the base, y(t) = amplitude sin(angular_frequency t + phase)."""

    amplitude: NonNegative
    """Y, m."""
    angular_frequency: Positive
    """omega, rad/s."""
    phase: Finite = 0.0
    """Phase, rad."""


class StepLoad(Part):
    """A constant transverse force at a point, from t = 0 on."""

    kind: Literal["step"] = "step"
    x: NonNegative
    """Position, m, within the beam."""
    force: Finite
    """Force, N, positive upwards."""


class SineLoad(Part):
    """A transverse force at a point, force sin(angular_frequency t + phase), from t = 0 on."""

    kind: Literal["sine"] = "sine"
    x: NonNegative
    """Position, m, within the beam."""
    force: Finite
    """Amplitude, N, positive upwards."""
    angular_frequency: Positive
    """Angular frequency, rad/s."""
    phase: Finite = 0.0
    """Phase, rad."""


PointLoad = Annotated[StepLoad | SineLoad, Field(discriminator="kind")]


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
        faults = [*_outside_the_beam(self), *_names_used_twice(self)]
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
    def excitation_frequency(self) -> float | None:
        """The one angular frequency of all periodic excitation, rad/s; None where there is none or several."""
        found = {load.angular_frequency for load in self.point_loads if isinstance(load, SineLoad) and load.force}
        if self.base_motion is not None and self.base_motion.amplitude > 0:
            found.add(self.base_motion.angular_frequency)
        return found.pop() if len(found) == 1 else None

    def replace(self, **changes: Any) -> Problem:
        """A validated copy with some of the top-level parts changed."""
        return Problem.model_validate({name: getattr(self, name) for name in Problem.model_fields} | changes)


def _outside_the_beam(problem: Problem) -> Iterator[str]:
    L = problem.beam.length
    for group in ("supports", "stops", "point_loads"):
        for i, part in enumerate(getattr(problem, group)):
            if part.x > L:
                yield f"{group}[{i}].x = {part.x:g}: lies outside the beam; allowed are 0 to {L:g} m"


def _names_used_twice(problem: Problem) -> Iterator[str]:
    names = problem.stop_names
    for i, name in enumerate(names):
        if name in names[:i]:
            yield f'stops[{i}].name = "{name}": is the name of stops[{names.index(name)}] too'


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
