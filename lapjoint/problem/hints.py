"""Hints at slips: values that hardly any joint has, the unit that they look like, and supports without a spring.

A hint never blocks: each value is allowed, and solved for as it stands.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from lapjoint.problem.beam import Beam, Material, Section
from lapjoint.problem.damping import Damping, ModalDamping
from lapjoint.problem.forces import Forces
from lapjoint.problem.line import Line
from lapjoint.problem.masses import Mass
from lapjoint.problem.placing import masses_of, supports_of
from lapjoint.problem.static_loads import Gravity
from lapjoint.problem.structure import Structure
from lapjoint.problem.supports_and_stops import PlacedStop, Support
from lapjoint.problem.written import Written


@dataclass(frozen=True)
class _Usual:
    """The usual range of a quantity, and the units that are mistaken for its own."""

    unit: str
    low: float
    high: float
    """The usual range, SI."""
    slips: tuple[tuple[str, float], ...]
    """Other units, and their size in SI units, the likeliest first."""

    def hint(self, path: str, value: float, aside: str = "") -> Iterator[str]:
        """A hint where a value is out of the range; it names the units in which the value would be usual."""
        if self.low <= value <= self.high:
            return
        meant = next(((name, value * size) for name, size in self.slips if self.low <= value * size <= self.high), None)
        usual = f"{self.low:g} to {self.high:g} {self.unit} are usual{aside}"
        guess = f"; were {meant[0]} meant? Then it is {meant[1]:g}" if meant else ""
        yield f"{path} = {value:g} {self.unit}: {usual}{guess}"


YOUNGS_MODULUS = _Usual("Pa", 1e6, 1.3e12, (("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3)))
"""From rubber to diamond."""
DENSITY = _Usual("kg/m3", 10.0, 2.3e4, (("g/cm3", 1e3), ("t/mm3", 1e12), ("kg/mm3", 1e9)))
"""From foam to osmium."""
LENGTH = _Usual("m", 1e-6, 500.0, (("mm", 1e-3), ("um", 1e-6)))
"""From cantilevers of micromechanics to bridges."""
SLENDER = 0.5
"""Depth of a section, divided by the beam's length, above which the theory of slender beams fails."""
HEAVY = 1e4
"""Mass on the beam, divided by the mass of the beam, above which grams were perhaps taken for kilograms."""
WEIGHT = _Usual("m/s2", 0.0, 300.0, (("mm/s2", 1e-3),))
"""Acceleration of gravity, without its sign: from none to a centrifuge."""
WIDE = 0.2
"""Gap, divided by the beam's length, above which no small displacement closes it."""
RATIO = 2.0
"""Damping ratio from which on a percentage was probably meant; 1 is critical damping."""
FAST, SLOW = 1e4, 1e-6
"""Limits of the excitation frequency, divided by a cantilever's lowest: above the first the beam hardly responds, below
the second the excitation is static."""
HARD, SOFT = 1e10, 1e-8
"""Limits of the stiffness of a stop, divided by EI / L^3: above the first the stop is practically rigid, below the
second the beam hardly feels it."""


def hints(problem: Written, joint: Structure, forces: Forces) -> tuple[str, ...]:
    """A line for each value that looks like a slip: the field, its value, its usual range, and the unit that was
    perhaps meant."""
    line, stops = joint.line, joint.stops
    found = [
        hint for j, beam in enumerate(line.beams) for hint in _of_beam(f"beams[{j}]" if line.several else "beam", beam)
    ]
    return (
        *found,
        *_of_fatigue(line),
        *_of_supports(supports_of(problem, line)),
        *_of_stops(stops, line),
        *_of_masses(masses_of(problem, line), line),
        *_of_gravity(problem.gravity),
        *_of_damping(problem.damping),
        *_of_excitation(forces, line),
    )


def _of_fatigue(line: Line) -> Iterator[str]:
    """A hint if an S-N line cannot be used, because parts of the beams have no section and therefore no stress."""
    if not line.has_sections and any(piece.material and piece.material.fatigue for piece in line.pieces):
        yield "fatigue: no damage is stated, because stress needs a section in every part of the beams"


def _of_beam(path: str, beam: Beam) -> Iterator[str]:
    yield from LENGTH.hint(f"{path}.length", beam.length)
    if beam.material is not None:
        yield from _of_material(f"{path}.material", beam.material)
    if beam.section is not None:
        yield from _of_section(f"{path}.section", beam.section, beam.length)
    for i, segment in enumerate(beam.segments):
        if segment.material is not None:
            yield from _of_material(f"{path}.segments[{i}].material", segment.material)
        if segment.section is not None:
            yield from _of_section(f"{path}.segments[{i}].section", segment.section, beam.length)


def _of_material(path: str, material: Material) -> Iterator[str]:
    yield from YOUNGS_MODULUS.hint(f"{path}.youngs_modulus", material.youngs_modulus, " (steel has 2.05e11)")
    yield from DENSITY.hint(f"{path}.density", material.density, " (steel has 7850)")


def _of_section(path: str, section: Section, length: float) -> Iterator[str]:
    if section.depth > SLENDER * length:
        guess = "; were mm meant? " + _thousandth(section.depth) if section.depth / 1000 < SLENDER * length else ""
        yield f"{path}: {section.depth:g} m deep, and the beam is {length:g} m long{guess}"


def _of_supports(supports: Sequence[tuple[str, Support]]) -> Iterator[str]:
    for path, it in supports:
        if not (it.translational or it.torsional):
            yield f"{path}: has neither a translational nor a torsional stiffness, and holds nothing; inf fixes"


def _of_stops(stops: Sequence[PlacedStop], line: Line) -> Iterator[str]:
    for i, stop in enumerate(stops):
        beam, size = line.beams[line.beam_at(stop.x)], abs(stop.gap)
        if size > WIDE * beam.length:
            guess = "; were mm meant? " + _thousandth(stop.gap) if size / 1000 <= WIDE * beam.length else ""
            yield f"stops[{i}].gap = {stop.gap:g} m: the beam is {beam.length:g} m long{guess}"
        ratio = stop.stiffness * beam.length**3 / beam.EI
        if not SOFT <= ratio <= HARD:
            yield (
                f"stops[{i}].stiffness = {stop.stiffness:g} N/m: is {ratio:.1g} times EI / length^3; are its unit and "
                "those of the beam right?"
            )


def _of_masses(masses: Sequence[tuple[str, Mass]], line: Line) -> Iterator[str]:
    for path, it in masses:
        beam = line.beams[line.beam_at(it.x)]
        ratio = it.mass / (beam.m * beam.length)
        if ratio > HEAVY:
            yield f"{path}.mass = {it.mass:g} kg: is {ratio:.1g} times the mass of the beam; are the units right?"


def _of_gravity(gravity: Gravity | None) -> Iterator[str]:
    if gravity is not None:
        acceleration = gravity.acceleration
        yield from WEIGHT.hint("gravity.acceleration", abs(acceleration))
        if acceleration > 0:
            yield f"gravity.acceleration = {acceleration:g} m/s2: acts upwards; downwards it is {-acceleration:g}"


def _of_damping(damping: Damping) -> Iterator[str]:
    largest = float(np.max(damping.ratio)) if isinstance(damping, ModalDamping) else 0.0
    if largest >= RATIO:
        meant = f"was {largest:g} % meant? Then it is {largest / 100:g}"
        yield f"damping.ratio = {largest:g}: 1 is critical damping; {meant}"


def _of_excitation(forces: Forces, line: Line) -> Iterator[str]:
    bending = line.slowest_bending
    for omega in sorted({force.angular_frequency for force in forces.harmonic if force.amplitude}):
        if not SLOW <= omega / bending <= FAST:
            yield (
                f"angular_frequency = {omega:g} rad/s ({omega / (2 * math.pi):.3g} Hz): a cantilever like this beam "
                f"bends at {bending:.3g} rad/s; are the units right?"
            )


def _thousandth(value: float) -> str:
    return f"Then it is {value / 1000:g}"
