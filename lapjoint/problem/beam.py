"""The beam itself: material, cross-section and length, or its two resulting stiffness and mass numbers."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from lapjoint.problem.schema import Part, Positive


class Material(Part):
    """A linear elastic material."""

    youngs_modulus: Positive
    """Young's modulus E, Pa."""
    density: Positive
    """Mass density rho, kg/m3."""


class Rectangle(Part):
    """A solid rectangular cross-section; it bends about the axis along its breadth."""

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
    """A solid circular cross-section."""

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
    """A circular tube as cross-section."""

    shape: Literal["tube"] = "tube"
    outer_diameter: Positive
    """Outer diameter, m."""
    inner_diameter: Positive
    """Inner diameter, m; less than the outer."""

    @model_validator(mode="after")
    def _inner_within_outer(self) -> Self:
        if self.inner_diameter >= self.outer_diameter:
            raise ValueError(
                f"inner_diameter = {self.inner_diameter:g} must be less than outer_diameter = {self.outer_diameter:g}"
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
    """A uniform Euler-Bernoulli beam: its length, and either EI and m or a material and a cross-section."""

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
            raise ValueError("give either bending_stiffness and mass_per_length, or material and section, and not both")
        for name, value in (("bending stiffness EI", self.EI), ("mass per length", self.m)):
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"the {name} comes to {value:g}, and must be positive and finite")
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
