"""How the motion starts: at rest, straight or in static equilibrium, from polynomials in x, or from sampled shapes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from lapjoint.errors import InputError
from lapjoint.problem.schema import Finite, FloatArray, Part

ShapeFunction = Callable[[FloatArray], FloatArray]


class AtRest(Part):
    """Straight and still at t = 0."""

    kind: Literal["rest"] = "rest"

    def displacement_at(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """z(x, 0), the initial displacement, or a derivative of it in x.

        Parameters
        ----------
        x : FloatArray, shape (...)
            Positions, m, in an array of any shape.
        derivative : int
            Order of the x-derivative.

        Returns
        -------
        FloatArray, shape (...)
            The derivative, in m over m^derivative, an array shaped like `x`.
        """
        return np.zeros_like(np.asarray(x, dtype=float))

    velocity_at = displacement_at
    """z_t(x, 0), the initial velocity, which is zero, too, in m/s over m^derivative."""


class AtEquilibrium(Part):
    """Still at t = 0, in the static equilibrium under gravity and all constant loads, which each solver finds itself.

    Base motion and loads that change with time do not count.
    """

    kind: Literal["equilibrium"] = "equilibrium"


class PolynomialShape(Part):
    """Initial displacement and velocity as polynomials in x, coefficients in ascending powers."""

    kind: Literal["polynomial"] = "polynomial"
    displacement: tuple[Finite, ...] = ()
    """z(x, 0) = sum of displacement[n] x^n, m."""
    velocity: tuple[Finite, ...] = ()
    """z_t(x, 0) = sum of velocity[n] x^n, m/s."""

    def displacement_at(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """z(x, 0) or an x-derivative of it. See `AtRest.displacement_at`."""
        return _polynomial(self.displacement, x, derivative)

    def velocity_at(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """z_t(x, 0), m/s, or an x-derivative of it. See `AtRest.displacement_at`."""
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
        """z(x, 0) or an x-derivative of it. See `AtRest.displacement_at`."""
        return _spline(self.x, self.displacement, x, derivative)

    def velocity_at(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """z_t(x, 0), m/s, or an x-derivative of it. See `AtRest.displacement_at`."""
        return _spline(self.x, self.velocity, x, derivative)


class BeamStart(Part):
    """Initial displacement and velocity of one of several beams."""

    beam: str
    """Name of the beam."""
    x: tuple[Finite, ...] = ()
    """Positions on the beam, m, ascending, from 0 to L, of sampled shapes; empty: the shapes are polynomials."""
    displacement: tuple[Finite, ...] = ()
    """Coefficients of 1, x, x^2 ..., or samples, of z(x, 0), m; empty: zero."""
    velocity: tuple[Finite, ...] = ()
    """Coefficients, or samples, of z_t(x, 0), m/s; empty: zero."""

    @property
    def shape(self) -> PolynomialShape | SampledShape:
        """The shapes on this beam."""
        if self.x:
            return SampledShape(x=self.x, displacement=self.displacement, velocity=self.velocity)
        return PolynomialShape(displacement=self.displacement, velocity=self.velocity)


class BeamsStart(Part):
    """Initial displacement and velocity of several beams, each by itself; a beam that is not named is at rest."""

    kind: Literal["beams"] = "beams"
    beams: Annotated[tuple[BeamStart, ...], Field(min_length=1)]
    """Tables of beam, displacement and velocity, and of x where these are samples."""


@dataclass(frozen=True)
class LineShape:
    """An initial state of several beams as functions of the position on the line."""

    parts: tuple[tuple[float, float, PolynomialShape | SampledShape], ...]
    """Start and end on the line, m, and the shapes, of each beam that is not at rest."""

    def displacement_at(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """z(x, 0) or an x-derivative of it. See `AtRest.displacement_at`."""
        return self._of_beams("displacement_at", x, derivative)

    def velocity_at(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """z_t(x, 0), m/s, or an x-derivative of it. See `AtRest.displacement_at`."""
        return self._of_beams("velocity_at", x, derivative)

    def _of_beams(self, name: str, x: FloatArray, derivative: int) -> FloatArray:
        """A shape of each beam at its own positions, zero elsewhere."""
        x = np.asarray(x, dtype=float)
        found = np.zeros_like(x)
        for start, end, shape in self.parts:
            here = (x >= start) & (x <= end)
            found = np.where(here, getattr(shape, name)(np.clip(x - start, 0.0, end - start), derivative), found)
        return found


@lru_cache(maxsize=32)
def _spline_through(x: tuple[float, ...], values: tuple[float, ...]) -> Any:
    from scipy.interpolate import CubicSpline

    return CubicSpline(x, values)


def _spline(points: tuple[float, ...], values: tuple[float, ...], x: FloatArray, derivative: int) -> FloatArray:
    if not values:
        return np.zeros_like(np.asarray(x, dtype=float))
    result: FloatArray = _spline_through(points, values)(x, derivative)
    return result


def _polynomial(coefficients: tuple[float, ...], x: FloatArray, derivative: int) -> FloatArray:
    series = np.polynomial.Polynomial(np.array(coefficients or (0.0,), dtype=float))
    result: FloatArray = (series.deriv(derivative) if derivative else series)(np.asarray(x, dtype=float))
    return np.asarray(result, dtype=float)


InitialShape = AtRest | PolynomialShape | SampledShape | LineShape
"""An initial state as functions of the position on the line."""
InitialState = Annotated[
    AtRest | PolynomialShape | SampledShape | AtEquilibrium | BeamsStart, Field(discriminator="kind")
]


def initial_from_functions(
    length: float,
    displacement: ShapeFunction | None = None,
    velocity: ShapeFunction | None = None,
    points: int = 401,
) -> SampledShape:
    """Initial state from Python callables, sampled at equidistant positions from root to tip.

    Both solvers use the cubic spline through the samples, which a problem file stores.  The spline differs from the
    function by O((length / points)^4).

    Parameters
    ----------
    length : float
        Length L of the beam, m.
    displacement : callable, optional
        Takes positions, m, shape ``(points,)``, and returns z(x, 0), m, of the same shape; zero if not given.
    velocity : callable, optional
        Takes positions, m, shape ``(points,)``, and returns z_t(x, 0), m/s, of the same shape; zero if not given.
    points : int
        Number of samples, at least 4.

    Returns
    -------
    SampledShape
        The samples, to be given as ``initial`` of a problem.

    Raises
    ------
    InputError
        If a callable does not return one finite number for each position.
    """
    x = np.linspace(0.0, length, points)

    def sample(name: str, function: ShapeFunction | None) -> tuple[float, ...]:
        if function is None:
            return ()
        values = np.asarray(function(x), dtype=float)
        if values.shape != x.shape or not np.all(np.isfinite(values)):
            raise InputError(
                f"initial.{name}: the function must return {points} finite numbers for {points} positions, "
                f"and gave shape {values.shape}"
            )
        return tuple(values.tolist())

    return SampledShape(
        x=tuple(x.tolist()),
        displacement=sample("displacement", displacement),
        velocity=sample("velocity", velocity),
    )
