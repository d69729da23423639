"""Limits of the numbers of a problem, within which double precision is sufficient for the problem and all that is
computed from it.

Every quantity that a problem states, or that follows from it, is at most 1e100 in SI units, so that its square is
finite.  Times between samples, squares of frequencies, and quantities of the beam are at least 1e-100.  Stiffness,
damping and masses have limits relative to the beam, and segments of the beam relative to each other.  Two supports at
different positions are farther apart than rounding.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np

from lapjoint.problem.beam import LEAST, MOST, NEAREST, Beam
from lapjoint.problem.damping import ModalDamping, ViscousDamping
from lapjoint.problem.excitation import AnyBaseMotion, PointLoad, StepLoad
from lapjoint.problem.initial import AtEquilibrium, AtRest, BeamsStart, PolynomialShape, SampledShape
from lapjoint.problem.line import Line
from lapjoint.problem.placing import masses_of, supports_of
from lapjoint.problem.records import Record, RecordBaseMotion
from lapjoint.problem.schema import FloatArray
from lapjoint.problem.structure import PlacedLink, Structure
from lapjoint.problem.supports_and_stops import Support
from lapjoint.problem.written import Written

_SOFTEST, _FIXED = 1e-16, 1e20
"""Least and largest finite stiffness of a support, divided by EI / L^3, or by EI / L if it is torsional.
On a softer spring the slowest mode takes some 1e8 times as long as a bending mode, and too few digits are left for its
motion; a stiffer spring is fixed to rounding."""
_STIFFEST = 1e13
"""Largest stiffness of a stop, divided by EI / L^3: too few digits are left for the compression of a stiffer stop."""
_HEAVIEST = 1e12
"""Largest mass, divided by that of the beam, and largest rotary inertia, divided by the beam's mass times L^2.
With heavier ones the slowest modes take more than 1e6 times as long as a bending mode, and double precision mixes
them."""
_STEEPEST = 1e9
"""Largest ratio of stiffness, or of mass per length, between two segments: with steps of 1e12 the stiffness of finite
elements is singular to rounding."""
_MOST_DAMPED = 1e7
"""Largest damping ratio: a mode's two decay rates then differ by 4e14, of the 1e16 that double precision resolves."""
_MOST_COUPLING = 1e4
"""Largest viscous damping, in units of the critical one, that couples the modes: the slowest decay keeps seven digits
there, and loses two with each factor of ten."""
_MOST_IN_STOP = 1e4
"""Largest damping of a stop, divided by sqrt(EI m) / L + sqrt(k m L), about the critical damping of the beam on the
stop: the flow of up to 60 modes then keeps eight digits; the error grows with the damping."""
_MOST_PHASE = 1e8
"""Largest phase, rad: of a larger phase, whole turns take half of the digits."""


def faults_of_size(
    problem: Written, joint: Structure, excitation: Mapping[str, AnyBaseMotion | PointLoad]
) -> Iterator[str]:
    """A line for each number of a problem, whose structure is `joint`, that is out of its limits; the parts are valid,
    and those of the excitation are given by their paths."""
    line = joint.line
    yield from _of_inertia(problem, line)
    for i, stop in enumerate(joint.stops):
        yield from _stated(f"stops[{i}].gap", stop.gap, "m")
        yield from _stated(f"stops[{i}].stiffness", stop.stiffness, "N/m")
        yield from _stated(f"stops[{i}].damping", stop.damping, "N s/m")
    yield from _of_places(problem, joint)
    yield from _of_stiffness(problem, joint)
    yield from _of_damping(joint)
    yield from faults_of_excitation(excitation)
    yield from _of_initial_state(problem, line)


def faults_of_excitation(excitation: Mapping[str, AnyBaseMotion | PointLoad]) -> Iterator[str]:
    """A line for each number of an excitation that is too large or too small; its parts are given by their paths."""
    for path, part in excitation.items():
        yield from faults_of_part(path, part)


def faults_of_part(path: str, part: AnyBaseMotion | PointLoad) -> Iterator[str]:
    """A line for each number of a base motion or a point load that is too large or too small."""
    if isinstance(part, Record):
        yield from _of_record(path, part)
    if isinstance(part, StepLoad):
        yield from _stated(f"{path}.force", part.force, "N")
    several, base = part.kind == "harmonics", path == "base_motion"
    source = f"{'multiple and ' if several else ''}angular_frequency"
    for i, wave in enumerate(part.waves):
        here, squared = f"{path}.harmonics[{i}]" if several else path, wave.angular_frequency * wave.angular_frequency
        yield from _stated(f"{here}.{'amplitude' if base else 'force'}", wave.amplitude, "m" if base else "N")
        if not LEAST <= squared <= MOST:
            yield _following(here, "square of the angular frequency", squared, source, LEAST)
        elif base and not wave.amplitude * squared <= MOST:
            from_both = f"amplitude{',' if several else ' and'} {source}"
            yield _following(here, "acceleration", wave.amplitude * squared, from_both)
        if not abs(wave.phase) <= _MOST_PHASE:
            yield f"{here}.phase = {wave.phase:g}: allowed are {-_MOST_PHASE:g} to {_MOST_PHASE:g} rad"


def _stated(path: str, value: float, unit: str) -> Iterator[str]:
    """A fault of a number of the file, if it is too large."""
    if not abs(value) <= MOST:
        yield f"{path} = {value:g}: must be at most {MOST:g} {unit}, up or down"


def _following(path: str, name: str, value: float, source: str, least: float = 0.0) -> str:
    """The fault of a quantity out of range that follows from numbers of the file."""
    allowed = f"between {least:g} and {MOST:g}" if least else f"at most {MOST:g}"
    return f"{path}: the {name} comes to {value:g}, and must be {allowed} in SI units; it follows from {source}"


def _of_places(problem: Written, joint: Structure) -> Iterator[str]:
    """Parts within rounding of the root, and supports within rounding of each other: the messages ask whether a clamp
    was meant."""
    line = joint.line
    supports = {f"{path}.x": part.x for path, part in supports_of(problem, line)}
    stops = {f"stops[{i}].x": x for i, stop in enumerate(joint.stops) for x, _ in stop.reading}
    masses = {f"{path}.x": part.x for path, part in masses_of(problem, line)}
    loads = {
        f"point_loads[{i}].x": line.at(load.x)
        for i, load in enumerate(problem.point_loads)
        if not line.fault_of(load.x)
    }
    for path, x in (supports | stops | masses | loads).items():
        i = line.beam_at(x)
        own, least = x - line.starts[i], NEAREST * line.beams[i].length
        if 0 < own <= least:
            yield f"{path} = {own:g}: must be 0, or more than {NEAREST:g} of the length, which is {least:.2g} m"
    for (one, x), (other, y) in pairwise(sorted(supports.items(), key=lambda item: item[1])):
        i = line.beam_at(x)
        start, least = line.starts[i], NEAREST * line.beams[i].length
        if 0 < y - x <= least and x - start > least:
            yield (
                f"{other} = {y - start!r}: lies {y - x:.2g} m from {one} = {x - start!r}; allowed are the same place, "
                f"and more than {NEAREST:g} of the length, which is {least:.2g} m"
            )


def _of_stiffness(problem: Written, joint: Structure) -> Iterator[str]:
    """Springs too soft or too stiff, relative to the beams that they touch, for double precision."""
    line = joint.line
    for path, support in supports_of(problem, line):
        yield from _of_springs(path, support, [line.beams[line.beam_at(support.x)]])
    for i, link in enumerate(joint.links):
        yield from _of_springs(f"links[{i}]", link, [line.beams[line.beam_at(x)] for x in (link.first, link.second)])
    text = "EI / length^3"
    for i, stop in enumerate(joint.stops):
        beams = [line.beams[line.beam_at(x)] for x, _ in stop.reading]
        unit = min(beam.EI / beam.length**3 for beam in beams)
        if stop.stiffness > _STIFFEST * unit:
            yield (
                f"stops[{i}].stiffness = {stop.stiffness:g}: is {stop.stiffness / unit:.2g} {text}; allowed are up to "
                f"{_STIFFEST:g} {text}, which is {_STIFFEST * unit:.2g}"
            )
        if stop.damping > 0:
            roots = (math.sqrt(it.EI) / it.length + math.sqrt(stop.stiffness * it.length) for it in beams)
            critical = min(math.sqrt(it.m) * root for it, root in zip(beams, roots, strict=True))
            if stop.damping > _MOST_IN_STOP * critical:
                yield (
                    f"stops[{i}].damping = {stop.damping:g}: must be at most {_MOST_IN_STOP:g} times sqrt(EI m) / "
                    f"length + sqrt(stiffness m length), which is {_MOST_IN_STOP * critical:.2g} N s/m"
                )


def _of_springs(path: str, springs: Support | PlacedLink, beams: Sequence[Beam]) -> Iterator[str]:
    """Springs of a support or of a link that are out of their limits, relative to each of the beams."""
    for name, power, text in (("translational", 3, "EI / length^3"), ("torsional", 1, "EI / length")):
        spring, units = getattr(springs, name), [beam.EI / beam.length**power for beam in beams]
        least, most = _SOFTEST * max(units), _FIXED * min(units)
        if 0 < spring < least or most < spring < math.inf:
            unit = max(units) if spring < least else min(units)
            yield (
                f"{path}.{name} = {spring:g}: is {spring / unit:.2g} {text}; allowed are 0, "
                f"{_SOFTEST:g} to {_FIXED:g} {text}, which is {least:.2g} to {most:.2g}, and inf"
            )


def _of_inertia(problem: Written, line: Line) -> Iterator[str]:
    """Masses too heavy, and steps or beams too unlike, for double precision to hold slow and fast modes."""
    for path, mass in masses_of(problem, line):
        beam = line.beams[line.beam_at(mass.x)]
        whole = beam.m * beam.length
        for name, size, unit, text in (
            ("mass", mass.mass, whole, "the beam's mass"),
            ("rotary_inertia", mass.rotary_inertia, whole * beam.length**2, "the beam's mass times length^2"),
        ):
            if not size <= _HEAVIEST * unit:
                yield (
                    f"{path}.{name} = {size:g}: is {size / unit:.2g} times {text}; allowed are up to "
                    f"{_HEAVIEST:g} times, which is {_HEAVIEST * unit:.2g}"
                )
    for name, field in (("bending stiffness", "EI"), ("mass per length", "inertia")):
        values = [getattr(piece, field) for piece in line.pieces]
        if max(values) > _STEEPEST * min(values):
            low, high = (_piece_path(line, values.index(extreme)) for extreme in (min(values), max(values)))
            yield (
                f"{high}: its {name} is {max(values) / min(values):.2g} times that of {low.removeprefix('beam.')}; "
                f"allowed are up to {_STEEPEST:g} times"
            )


def _piece_path(line: Line, number: int) -> str:
    """The path of a piece of the line, by its number."""
    for j, beam in enumerate(line.beams):
        if number < len(beam.pieces):
            here = f"beams[{j}]" if line.several else "beam"
            return f"{here}.segments[{number}]" if beam.segments else here
        number -= len(beam.pieces)
    raise AssertionError(number)


def _of_damping(joint: Structure) -> Iterator[str]:
    """Damping too large for double precision to hold the slower of two decay rates."""
    damping, line = joint.damping, joint.line
    if isinstance(damping, ModalDamping):
        several = isinstance(damping.ratio, tuple)
        for i, ratio in enumerate(damping.ratio if isinstance(damping.ratio, tuple) else (damping.ratio,)):
            if not ratio <= _MOST_DAMPED:
                path = f"damping.ratio{f'[{i}]' if several else ''}"
                yield f"{path} = {ratio:g}: must be at most {_MOST_DAMPED:g}; 1 is critical damping"
    if isinstance(damping, ViscousDamping):
        critical = 2 * line.m * line.slowest_bending
        couples = joint.coupling_drag > 0
        most, beside = (
            (_MOST_COUPLING, ", where masses or steps of mass couple the modes") if couples else (_MOST_DAMPED, "")
        )
        if not damping.coefficient <= most * critical:
            yield (
                f"damping.coefficient = {damping.coefficient:g}: must be at most {most:g} times the critical "
                f"damping of the slowest bending, which is {most * critical:.2g} N s/m2{beside}"
            )


def _of_record(path: str, record: Record) -> Iterator[str]:
    """Times, samples, or the base motion that follows from them, out of range."""
    with np.errstate(all="ignore"):
        between = np.array([1 / record.rate]) if record.rate is not None else np.diff(record.time)
        shortest, values = float(between.min()), record.si_values
        if not (LEAST <= shortest and record.duration <= MOST):
            field = f"{path}.times" if record.rate is None else f"{path}.rate = {record.rate:g}"
            yield (
                f"{field}: the samples come to {shortest:g} s apart, and {record.duration:g} s in all; allowed are "
                f"{LEAST:g} to {MOST:g} s"
            )
        elif not _largest(values) <= MOST:
            yield _following(path, "largest sample", _largest(values), "values and unit")
        elif isinstance(record, RecordBaseMotion):
            for order, name in enumerate(("displacement", "velocity", "acceleration")):
                reached = _largest(record.motion.at(record.motion.time, order))
                if not reached <= MOST:
                    yield _following(path, f"largest {name} of the base", reached, "values, unit and the times")


def _of_initial_state(problem: Written, line: Line) -> Iterator[str]:
    """Initial shapes that are not finite, or too large."""
    initial = problem.initial
    if isinstance(initial, AtRest | AtEquilibrium):
        return
    shapes: list[tuple[str, float, PolynomialShape | SampledShape]]
    if isinstance(initial, BeamsStart):
        shapes = [(f"initial.beams[{i}]", line.length, one.shape) for i, one in enumerate(initial.beams)]
    else:
        shapes = [("initial", line.length, initial)]
    for path, length, shape in shapes:
        grid = np.linspace(0.0, length, 101)
        with np.errstate(all="ignore"):
            for name, of_x in (("displacement", shape.displacement_at), ("velocity", shape.velocity_at)):
                for order, word in enumerate(("largest value", "largest slope", "largest second derivative")):
                    reached = _largest(of_x(grid, order))
                    if not reached <= MOST:
                        yield _following(f"{path}.{name}", word, reached, f"{name} and length")
                        break


def _largest(values: FloatArray) -> float:
    """The largest modulus; NaN if a value is NaN."""
    return float(np.max(np.abs(values), initial=0.0))
