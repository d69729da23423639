"""The beam: its length, and its material and cross-section, or its bending stiffness and mass per unit length; in
segments, if these change along the beam."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from lapjoint.problem.fatigue import SNLine
from lapjoint.problem.schema import NonNegative, Part, Positive

LEAST, MOST = 1e-100, 1e100
"""Least and largest value, in SI units, of a quantity that follows from a beam's fields; its square is then finite."""
NEAREST = 1e-12
"""Distance, divided by the length of the beam, within which two positions may be one, except for rounding."""
_CANTILEVER = 1.8751040687119611  # beta L of the first mode of a cantilever: the least root of cosh x cos x = -1


class Material(Part):
    """A linear elastic material."""

    youngs_modulus: Positive
    """Young's modulus E, Pa."""
    density: Positive
    """Mass density rho, kg/m3."""
    fatigue: SNLine | None = None
    """S-N line, by which cycles of stress do damage."""


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


def uniform_slowest_bending(EI: float, m: float, length: float) -> float:
    """Lowest natural angular frequency, rad/s, of a uniform cantilever of EI, N m2, m, kg/m, and a length, m."""
    return _CANTILEVER**2 * math.sqrt(EI / m) / length**2


@dataclass(frozen=True)
class BeamPiece:
    """A part of the beam along which stiffness and masses per unit length are constant."""

    start: float
    """Position of its end nearer to the root, m."""
    end: float
    """Position of its other end, m."""
    EI: float
    """Bending stiffness EI, N m2."""
    mass: float
    """Mass per unit length of the beam and its contents, on which gravity acts, kg/m."""
    inertia: float
    """Mass per unit length that moves: `mass`, and the added mass of a fluid around the beam, kg/m."""
    material: Material | None
    """Material; None where stiffness and mass are given as numbers."""
    section: Section | None
    """Cross-section; None where stiffness and mass are given as numbers."""


class BeamSegment(Part):
    """A part of a stepped beam, from the end of the segment before it, or from the root."""

    to: Positive
    """Position of its end, m; that of the last segment is the length of the beam."""
    bending_stiffness: Positive | None = None
    """Bending stiffness EI, N m2 (with mass_per_length, instead of material and section)."""
    mass_per_length: Positive | None = None
    """Mass per unit length m = rho A, kg/m (with bending_stiffness)."""
    material: Material | None = None
    """Material (with section); the material of the beam, if not given."""
    section: Section | None = None
    """Cross-section (with material)."""


class Beam(Part):
    """An Euler-Bernoulli beam: its length, and EI and m, or a material and a cross-section, or segments of its own."""

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
    segments: tuple[BeamSegment, ...] = ()
    """Parts of a beam with steps, from the root to the tip, instead of one stiffness and mass; a segment that has a
    section and no material is of the beam's material."""
    contents_per_length: NonNegative = 0.0
    """Mass per unit length of what fills the beam, kg/m; gravity acts on it."""
    added_mass_per_length: NonNegative = 0.0
    """Mass per unit length of the fluid around the beam that moves with it, kg/m; a moving base pushes on it, gravity
    does not act on it."""

    @model_validator(mode="after")
    def _one_description(self) -> Self:
        if self.segments:
            faults = list(self._segment_faults())
        elif not _described_once(self, self.material):
            faults = ["give either bending_stiffness and mass_per_length, or material and section, or segments"]
        else:
            faults = []
        faults = faults or list(self._out_of_range())
        if faults:
            raise ValueError("\n".join(faults))
        return self

    def _segment_faults(self) -> Iterator[str]:
        """What is wrong with the segments."""
        for name in ("bending_stiffness", "mass_per_length", "section"):
            if getattr(self, name) is not None:
                yield f"{name}: a beam with segments has it in each segment"
        start = 0.0
        for i, segment in enumerate(self.segments):
            if not _described_once(segment, segment.material or self.material):
                yield (
                    f"segments[{i}]: give either bending_stiffness and mass_per_length, or a section with a material "
                    "here or in the beam, and not both"
                )
            if not segment.to - start > NEAREST * self.length:
                yield f"segments[{i}].to = {segment.to:g}: must be more than {start:g} m, where the segment begins"
            start = segment.to
        if start != self.length:
            last = len(self.segments) - 1
            yield f"segments[{last}].to = {start:g}: must be the length of the beam, {self.length:g} m"

    def _out_of_range(self) -> Iterator[str]:
        """The first quantity out of range that follows from the beam's fields, if any."""
        for i, piece in enumerate(self.pieces):
            here = f"segments[{i}]." if self.segments else ""
            given = self.segments[i] if self.segments else self
            EI_from: tuple[str, ...] = (f"{here}bending_stiffness",)
            m_from: tuple[str, ...] = (f"{here}mass_per_length",)
            if given.section is not None:
                sizes = tuple(f"{here}section.{name}" for name in type(given.section).model_fields if name != "shape")
                material = f"{here}material" if given.material is not None else "material"
                EI_from, m_from = (f"{material}.youngs_modulus", *sizes), (f"{material}.density", *sizes)
            fluids = [name for name in ("contents_per_length", "added_mass_per_length") if getattr(self, name)]
            yield from _piece_out_of_range(piece.EI, piece.inertia, self.length, EI_from, (*m_from, *fluids))

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy with other values.  See `pydantic.BaseModel.model_copy`; the pieces follow from the new values."""
        made = super().model_copy(update=update, deep=deep)
        vars(made).pop("pieces", None)
        return made

    @cached_property
    def pieces(self) -> tuple[BeamPiece, ...]:
        """The parts of constant stiffness and mass, from the root to the tip; one, if there are no segments."""
        found, start = [], 0.0
        for segment in self.segments or (self,):
            material = segment.material or self.material
            EI, mass = _stiffness_and_mass(segment, material)
            end = segment.to if isinstance(segment, BeamSegment) else self.length
            mass += self.contents_per_length
            inertia = mass + self.added_mass_per_length
            section = segment.section
            found.append(BeamPiece(start, end, EI, mass, inertia, material if section is not None else None, section))
            start = end
        return tuple(found)

    @property
    def EI(self) -> float:
        """Bending stiffness EI, N m2; of a beam with segments the harmonic mean over its length."""
        if len(self.pieces) == 1:
            return self.pieces[0].EI
        return self.length / sum((piece.end - piece.start) / piece.EI for piece in self.pieces)

    @property
    def m(self) -> float:
        """Mass per unit length that moves, with contents and added mass, kg/m; the mean of a beam with segments."""
        if len(self.pieces) == 1:
            return self.pieces[0].inertia
        return sum((piece.end - piece.start) * piece.inertia for piece in self.pieces) / self.length

    @property
    def slowest_bending(self) -> float:
        """Lowest natural angular frequency as a uniform cantilever of stiffness `EI` and mass `m`, rad/s."""
        return uniform_slowest_bending(self.EI, self.m, self.length)


def _described_once(part: Beam | BeamSegment, material: Material | None) -> bool:
    """Whether a part gives its stiffness and mass once, as numbers or by a section of a `material`."""
    numbers = (part.bending_stiffness is not None, part.mass_per_length is not None)
    if any(numbers):
        return all(numbers) and part.material is None and part.section is None
    return material is not None and part.section is not None


def _stiffness_and_mass(part: Beam | BeamSegment, material: Material | None) -> tuple[float, float]:
    """EI, N m2, and rho A, kg/m, of a part that is of a `material`, if it has a section."""
    if part.section is None or material is None:
        assert part.bending_stiffness is not None
        assert part.mass_per_length is not None
        return part.bending_stiffness, part.mass_per_length
    return material.youngs_modulus * part.section.second_moment, material.density * part.section.area


def _piece_out_of_range(
    EI: float, m: float, L: float, EI_from: tuple[str, ...], m_from: tuple[str, ...]
) -> Iterator[str]:
    """The first quantity out of range that follows from stiffness, mass per length and length, with its fields."""
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


def _power(value: float, exponent: int) -> float:
    """A power, infinite where it overflows."""
    try:
        return float(value**exponent)
    except OverflowError:
        return math.inf
