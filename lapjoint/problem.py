"""What is solved: an immutable, validated description of a beam, its supports, its stops and its excitation.

The beam lies along x, from the root (x = 0) to the tip (x = L).  z(x, t) is the displacement relative to the
moving base, positive upwards; y(t) = Y sin(omega t + phase) is the base.  With E I = EI and rho A = m::

    EI z'''' + damping + m z_tt = m Y omega^2 sin(omega t + phase) + supports + stops + point loads

A closed stop pushes with ``-k (|z| - gap) sign(z)``.  SI units throughout, angles in radians, angular
frequencies in rad/s.  Nothing numerical (modes, elements, tolerances) belongs here.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from typing import Annotated, Any, Literal, Self

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, PrivateAttr, model_validator

FloatArray = npt.NDArray[np.float64]


def _refuse_text_and_booleans(value: object) -> object:
    if isinstance(value, str | bool):
        raise ValueError(f"must be a number, not {value!r}")
    return value


_Number = BeforeValidator(_refuse_text_and_booleans)
Finite = Annotated[float, _Number, Field(allow_inf_nan=False)]
Positive = Annotated[float, _Number, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, _Number, Field(ge=0, allow_inf_nan=False)]
SpringStiffness = Annotated[float, _Number, Field(ge=0)]  # infinite allowed, NaN refused by ge


class Part(BaseModel):
    """Base of every part of a problem: frozen, and unknown keys are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)


class Material(Part):
    """A linear elastic material."""

    youngs_modulus: Positive
    """Young's modulus E, Pa."""
    density: Positive
    """Mass density rho, kg/m3."""


class Rectangle(Part):
    """A solid rectangular section, bending about its breadth."""

    shape: Literal["rectangle"] = "rectangle"
    breadth: Positive
    """Breadth b, across the motion, m."""
    height: Positive
    """Height h, along the motion, m."""

    @property
    def area(self) -> float:
        """Area A, m2."""
        return self.breadth * self.height

    @property
    def second_moment(self) -> float:
        """Second moment of area I = b h^3 / 12, m4."""
        return self.breadth * self.height**3 / 12

    @property
    def depth(self) -> float:
        """Extent along the motion, m."""
        return self.height


class Circle(Part):
    """A solid circular section."""

    shape: Literal["circle"] = "circle"
    diameter: Positive
    """Diameter, m."""

    @property
    def area(self) -> float:
        """Area A, m2."""
        return math.pi * self.diameter**2 / 4

    @property
    def second_moment(self) -> float:
        """Second moment of area I = pi d^4 / 64, m4."""
        return math.pi * self.diameter**4 / 64

    @property
    def depth(self) -> float:
        """Extent along the motion, m."""
        return self.diameter


class Tube(Part):
    """A circular tube."""

    shape: Literal["tube"] = "tube"
    outer_diameter: Positive
    """Outer diameter, m."""
    inner_diameter: Positive
    """Inner diameter, m; less than the outer."""

    @model_validator(mode="after")
    def _inner_within_outer(self) -> Self:
        if self.inner_diameter >= self.outer_diameter:
            raise ValueError(
                f"inner_diameter = {self.inner_diameter:g} must be less than "
                f"outer_diameter = {self.outer_diameter:g}"
            )
        return self

    @property
    def area(self) -> float:
        """Area A, m2."""
        return math.pi * (self.outer_diameter**2 - self.inner_diameter**2) / 4

    @property
    def second_moment(self) -> float:
        """Second moment of area I, m4."""
        return math.pi * (self.outer_diameter**4 - self.inner_diameter**4) / 64

    @property
    def depth(self) -> float:
        """Extent along the motion, m."""
        return self.outer_diameter


Section = Annotated[Rectangle | Circle | Tube, Field(discriminator="shape")]


class Beam(Part):
    """A uniform Euler-Bernoulli beam: its length, and either EI and m or a material and a section."""

    length: Positive
    """Length L, m."""
    bending_stiffness: Positive | None = None
    """Bending stiffness EI, N m2 (with mass_per_length, instead of material and section)."""
    mass_per_length: Positive | None = None
    """Mass per unit length m = rho A, kg/m (with bending_stiffness)."""
    material: Material | None = None
    """Material (with section, instead of bending_stiffness and mass_per_length)."""
    section: Section | None = None
    """Cross-section (with material)."""

    @model_validator(mode="after")
    def _one_description(self) -> Self:
        numbers = (self.bending_stiffness is not None, self.mass_per_length is not None)
        parts = (self.material is not None, self.section is not None)
        if not ((all(numbers) and not any(parts)) or (all(parts) and not any(numbers))):
            raise ValueError(
                "give either bending_stiffness and mass_per_length, or material and section, and not both"
            )
        return self

    @property
    def EI(self) -> float:
        """Bending stiffness EI, N m2."""
        if self.material is None or self.section is None:
            assert self.bending_stiffness is not None
            return self.bending_stiffness
        return self.material.youngs_modulus * self.section.second_moment

    @property
    def m(self) -> float:
        """Mass per unit length rho A, kg/m."""
        if self.material is None or self.section is None:
            assert self.mass_per_length is not None
            return self.mass_per_length
        return self.material.density * self.section.area


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


class NoDamping(Part):
    """No damping."""

    kind: Literal["none"] = "none"


class ModalDamping(Part):
    """Damping ratios in the modes of the current contact state (the paper's)."""

    kind: Literal["modal"] = "modal"
    ratio: NonNegative | Annotated[tuple[NonNegative, ...], Field(min_length=1)]
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
ShapeFunction = Callable[[FloatArray], FloatArray]


class AtRest(Part):
    """Straight and still at t = 0."""

    kind: Literal["rest"] = "rest"

    def displacement_at(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """z(x, 0) or a derivative in x; ``x`` of any shape, m."""
        return np.zeros_like(np.asarray(x, dtype=float))

    velocity_at = displacement_at


class PolynomialShape(Part):
    """Initial displacement and velocity as polynomials in x, coefficients in ascending powers."""

    kind: Literal["polynomial"] = "polynomial"
    displacement: tuple[Finite, ...] = ()
    """z(x, 0) = sum of displacement[n] x^n, m."""
    velocity: tuple[Finite, ...] = ()
    """z_t(x, 0) = sum of velocity[n] x^n, m/s."""

    def displacement_at(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """z(x, 0) or a derivative in x; ``x`` of any shape, m."""
        return _polynomial(self.displacement, x, derivative)

    def velocity_at(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """z_t(x, 0) or a derivative in x; ``x`` of any shape, m."""
        return _polynomial(self.velocity, x, derivative)


class SampledShape(Part):
    """Initial displacement and velocity through given points, joined by a C2 cubic spline (not-a-knot)."""

    kind: Literal["sampled"] = "sampled"
    x: Annotated[tuple[Finite, ...], Field(min_length=4)]
    """Positions, m, ascending, from 0 to L."""
    displacement: tuple[Finite, ...] = ()
    """z(x, 0), m, one for each position; empty: zero."""
    velocity: tuple[Finite, ...] = ()
    """z_t(x, 0), m/s, one for each position; empty: zero."""

    _splines: dict[str, Any] = PrivateAttr(default_factory=dict)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if np.any(np.diff(self.x) <= 0):
            raise ValueError("x must ascend strictly")
        for name in ("displacement", "velocity"):
            n = len(getattr(self, name))
            if n not in (0, len(self.x)):
                raise ValueError(f"{name} has {n} values, and x has {len(self.x)}")
        return self

    def displacement_at(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """z(x, 0) or a derivative in x; ``x`` of any shape, m."""
        return self._spline("displacement", x, derivative)

    def velocity_at(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """z_t(x, 0) or a derivative in x; ``x`` of any shape, m."""
        return self._spline("velocity", x, derivative)

    def _spline(self, name: str, x: FloatArray, derivative: int) -> FloatArray:
        values = getattr(self, name)
        if not values:
            return np.zeros_like(np.asarray(x, dtype=float))
        if name not in self._splines:
            from scipy.interpolate import CubicSpline

            self._splines[name] = CubicSpline(self.x, values)
        result: FloatArray = self._splines[name](x, derivative)
        return result


def _polynomial(coefficients: tuple[float, ...], x: FloatArray, derivative: int) -> FloatArray:
    series = np.polynomial.Polynomial(np.array(coefficients or (0.0,), dtype=float))
    result: FloatArray = (series.deriv(derivative) if derivative else series)(np.asarray(x, dtype=float))
    return np.asarray(result, dtype=float)


InitialState = Annotated[AtRest | PolynomialShape | SampledShape, Field(discriminator="kind")]


def initial_from_functions(
    length: float,
    displacement: ShapeFunction | None = None,
    velocity: ShapeFunction | None = None,
    points: int = 401,
) -> SampledShape:
    """Initial state from Python callables, sampled at `points` equidistant positions over ``[0, length]``.

    The callables take and return arrays of shape ``(points,)``.  The cubic spline through the samples is what
    both solvers see, and what a file keeps; its error is O((length / points)^4).
    """
    x = np.linspace(0.0, length, points)

    def sample(function: ShapeFunction | None) -> tuple[float, ...]:
        return () if function is None else tuple(np.asarray(function(x), dtype=float).tolist())

    return SampledShape(x=tuple(x.tolist()), displacement=sample(displacement), velocity=sample(velocity))


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
    def _within_the_beam(self) -> Self:
        L = self.beam.length
        for group in ("supports", "stops", "point_loads"):
            for i, part in enumerate(getattr(self, group)):
                if part.x > L:
                    raise ValueError(f"{group}[{i}].x = {part.x:g} lies outside the beam, 0 to {L:g} m")
        names = self.stop_names
        if len(set(names)) != len(names):
            raise ValueError(f"stops: the names {', '.join(names)} are not all different")
        return self

    @model_validator(mode="after")
    def _initial_respects_fixed_supports(self) -> Self:
        initial = self.initial
        if isinstance(initial, AtRest):
            return self
        L = self.beam.length
        if isinstance(initial, SampledShape) and (initial.x[0] != 0.0 or initial.x[-1] != L):
            raise ValueError(
                f"initial.x runs from {initial.x[0]:g} to {initial.x[-1]:g}, and must run from 0 to {L:g} m"
            )
        grid = np.linspace(0.0, L, 101)
        for name, shape in (("displacement", initial.displacement_at), ("velocity", initial.velocity_at)):
            for derivative, word, spring in ((0, "moves", "translational"), (1, "turns", "torsional")):
                # A spline of a callable meets a fixed support to its interpolation error only.
                allowed = 1e-6 * float(np.max(np.abs(shape(grid, derivative)), initial=0.0))
                for i, support in enumerate(self.supports):
                    value = float(shape(np.array(support.x), derivative))
                    if math.isinf(getattr(support, spring)) and abs(value) > allowed:
                        raise ValueError(
                            f"initial.{name} {word} supports[{i}] at x = {support.x:g} m, which is fixed: "
                            f"{'its slope' if derivative else 'it'} is {value:g} there and must be 0"
                        )
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
