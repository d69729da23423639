"""The beam: its length, and its material and cross-section, or its bending stiffness and mass per unit length."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from lapjoint.errors import InputError
from lapjoint.problem.schema import Part, Positive

LEAST, MOST = 1e-100, 1e100
"""Least and largest value, in SI units, of a quantity that follows from a beam's fields; its square is then finite."""
_CANTILEVER = 1.8751040687119611  # beta L of the first mode of a cantilever: the least root of cosh x cos x = -1


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
        return self.breadth * _power(self.height, 3) / 12

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
        return math.pi * _power(self.diameter, 2) / 4

    @property
    def second_moment(self) -> float:
        """Second moment of area I = pi d^4 / 64, m4."""
        return math.pi * _power(self.diameter, 4) / 64

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
        return math.pi * (_power(self.outer_diameter, 2) - _power(self.inner_diameter, 2)) / 4

    @property
    def second_moment(self) -> float:
        """Second moment of area I, m4."""
        return math.pi * (_power(self.outer_diameter, 4) - _power(self.inner_diameter, 4)) / 64

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
        faults = list(self._out_of_range())
        if faults:
            raise ValueError("\n".join(faults))
        return self

    def _out_of_range(self) -> Iterator[str]:
        """The first quantity out of range that follows from the beam's fields, if any."""
        EI_from: tuple[str, ...] = ("bending_stiffness",)
        m_from: tuple[str, ...] = ("mass_per_length",)
        if self.section is not None:
            sizes = tuple(f"section.{name}" for name in type(self.section).model_fields if name != "shape")
            EI_from, m_from = ("material.youngs_modulus", *sizes), ("material.density", *sizes)
        EI, m, L = self.EI, self.m, self.length
        derived: tuple[tuple[str, float, tuple[str, ...]], ...] = (
            ("bending stiffness EI", EI, EI_from),
            ("mass per length m", m, m_from),
            ("mass m L", m * L, (*m_from, "length")),
            ("stiffness EI / L^3", EI / L / L / L, (*EI_from, "length")),
            ("frequency squared EI / (m L^4)", EI / m / L / L / L / L if m else 0.0, (*EI_from, *m_from, "length")),
        )
        for name, value, fields in derived:
            if not LEAST <= value <= MOST:
                sources, allowed = ", ".join(dict.fromkeys(fields)), f"between {LEAST:g} and {MOST:g} in SI units"
                yield f"the {name} comes to {value:g}, and must be {allowed}; it follows from {sources}"
                return

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

    @property
    def slowest_bending(self) -> float:
        """Lowest natural angular frequency of the beam as a cantilever, rad/s."""
        return _CANTILEVER**2 * math.sqrt(self.EI / self.m) / self.length**2

    def require_section(self, purpose: str) -> tuple[Material, Section]:
        """The material and the cross-section, for what cannot be done without.

        Parameters
        ----------
        purpose : str
            What needs them; the message begins with it.

        Returns
        -------
        Material
            The material.
        Section
            The cross-section.

        Raises
        ------
        InputError
            If the beam has none.
        """
        if self.material is None or self.section is None:
            raise InputError(f"{purpose}: the beam has no section; it needs beam.material and beam.section")
        return self.material, self.section


def _power(value: float, exponent: int) -> float:
    """A power, infinite where it overflows."""
    try:
        return float(value**exponent)
    except OverflowError:
        return math.inf
