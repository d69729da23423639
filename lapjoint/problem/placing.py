"""From a problem as it is written to its structure on the line of beams, and what is wrong with its places."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from lapjoint.problem.initial import AtEquilibrium, AtRest, BeamsStart, BeamStart, InitialShape, LineShape, SampledShape
from lapjoint.problem.line import Line
from lapjoint.problem.links import Link
from lapjoint.problem.load_shape import LoadShape
from lapjoint.problem.masses import Mass
from lapjoint.problem.messages import closest, shown
from lapjoint.problem.named_beam import NamedBeam
from lapjoint.problem.schema import FloatArray
from lapjoint.problem.static_loads import UniformLoad
from lapjoint.problem.structure import PlacedLink, Structure, structure_of
from lapjoint.problem.supports_and_stops import PlacedStop, Stop, Support
from lapjoint.problem.written import Written


def line_of(problem: Written) -> Line:
    """The beams of a problem on one axis."""
    return Line(problem.beams or (problem.beam,) if problem.beam is not None else problem.beams)


def placed(problem: Written, line: Line) -> Structure:
    """The structure of a problem whose places are right; `line` is that of its beams."""
    return structure_of(
        line,
        tuple(part for _, part in supports_of(problem, line)),
        tuple(_placed_stop(stop, line) for stop in problem.stops),
        problem.damping,
        tuple(part for _, part in masses_of(problem, line)),
        tuple(_placed_link(link, line) for link in problem.links),
    )


def supports_of(problem: Written, line: Line) -> list[tuple[str, Support]]:
    """All supports on the line, each after its path."""
    found = [(f"supports[{i}]", support) for i, support in enumerate(problem.supports)]
    for j, (start, beam) in enumerate(zip(line.starts, problem.beams, strict=bool(problem.beams))):
        for i, it in enumerate(beam.supports):
            placed = Support(x=start + it.x, translational=it.translational, torsional=it.torsional)
            found.append((f"beams[{j}].supports[{i}]", placed))
    return found


def masses_of(problem: Written, line: Line) -> list[tuple[str, Mass]]:
    """All masses on the line, each after its path."""
    found = [(f"masses[{i}]", mass) for i, mass in enumerate(problem.masses)]
    for j, (start, beam) in enumerate(zip(line.starts, problem.beams, strict=bool(problem.beams))):
        for i, it in enumerate(beam.masses):
            placed = Mass(x=start + it.x, mass=it.mass, rotary_inertia=it.rotary_inertia, name=it.name)
            found.append((f"beams[{j}].masses[{i}]", placed))
    return found


def _placed_stop(stop: Stop, line: Line) -> PlacedStop:
    """A stop on the line."""

    def share_at(x: float) -> float:
        beam = line.beams[line.beam_at(x)]
        return beam.base_share if isinstance(beam, NamedBeam) else 1.0

    if stop.between is not None:
        first, second = (line.at(place) for place in stop.between)
        side = "between"
        reading: tuple[tuple[float, float], ...] = ((second, 1.0), (first, -1.0))
        share = share_at(second) - share_at(first)
        where = " to ".join(map(line.place, (first, second)))
    else:
        assert stop.x is not None
        assert stop.side is not None
        x = float(stop.x) if not line.several and not isinstance(stop.x, str) else line.at(stop.x)
        side, where = stop.side, line.place(x)
        reading = ((x, 1.0),)
        share = share_at(x) if stop.in_space else 0.0
    return PlacedStop(stop.sign, reading, share, stop.gap, stop.stiffness, stop.damping, stop.may_pull, where, side)


def _placed_link(link: Link, line: Line) -> PlacedLink:
    """A link on the line."""
    first, second = (line.at(place) for place in link.between)
    return PlacedLink(first, second, link.translational, link.torsional)


def uniform_load_shape(load: UniformLoad, line: Line) -> LoadShape:
    """Where a uniform load acts on the line."""
    i = line.names.index(load.beam) if line.several else 0
    end = line.beams[i].length if load.to is None else load.to
    return LoadShape.along(line.starts[i] + load.start, line.starts[i] + end)


def shape_on_line(initial: AtRest | BeamsStart | InitialShape, line: Line) -> InitialShape:
    """An initial state, other than an equilibrium, as functions of the position on the line."""
    if not isinstance(initial, BeamsStart):
        return initial
    indices = [line.names.index(one.beam) for one in initial.beams]
    return LineShape(
        tuple((line.starts[i], line.ends[i], one.shape) for i, one in zip(indices, initial.beams, strict=True))
    )


def sampled_start(
    line: Line, x: FloatArray, displacement: FloatArray, velocity: FloatArray
) -> SampledShape | BeamsStart:
    """The initial state through samples, ``(n,)`` each, at positions on the line, m, ascending, that include the ends
    of each beam."""
    on = [line.own(x, j) for j in range(len(line.beams))]
    parts = [
        BeamStart(
            beam=name,
            x=tuple((x[here] - start).tolist()),
            displacement=tuple(displacement[here].tolist()),
            velocity=tuple(velocity[here].tolist()),
        )
        for name, start, here in zip(line.names, line.starts, on, strict=True)
    ]
    if line.several:
        return BeamsStart(beams=tuple(parts))
    (only,) = parts
    return SampledShape(x=only.x, displacement=only.displacement, velocity=only.velocity)


def place_faults(problem: Written) -> list[str]:
    """A line for each fault of the beams, and of the places of all that is on them."""
    beams = list(_beam_faults(problem))
    if beams:
        return beams
    line = line_of(problem)
    of_loads = load_faults(problem, line)
    return [*_on_beams(problem, line), *_of_stops(problem, line), *_of_links(problem, line), *of_loads]


def can_be_placed(problem: Written) -> bool:
    """Whether there is one beam, and all places are numbers: the structure then exists even with parts outside."""
    places = [stop.x for stop in problem.stops] + [load.x for load in problem.point_loads]
    numbers = all(isinstance(place, float) for place in places)
    return problem.beam is not None and not problem.beams and not problem.links and numbers


def _beam_faults(problem: Written) -> Iterator[str]:
    """Faults of the beams themselves."""
    if (problem.beam is None) == (not problem.beams):
        if problem.beam is None:
            yield "beam: is missing (a table [beam], or several tables [[beams]])"
        else:
            yield "beams: give either one [beam], or [[beams]]"
    names = [beam.name for beam in problem.beams]
    for i, name in enumerate(names):
        if name in names[:i]:
            yield f"beams[{i}].name = {shown(name)}: is the name of beams[{names.index(name)}] too"
    if problem.beams:
        for group in ("supports", "masses"):
            if getattr(problem, group):
                yield f"{group}: of [[beams]] each has its own, in [[beams.{group}]]"
    elif problem.links:
        yield "links: connect two beams; there is only one"


def _on_beams(problem: Written, line: Line) -> Iterator[str]:
    """Supports and masses outside their beam."""
    owners: list[tuple[str, float, Sequence[Support], Sequence[Mass]]] = [
        (f"beams[{j}].", beam.length, beam.supports, beam.masses) for j, beam in enumerate(problem.beams)
    ] or [("", line.length, problem.supports, problem.masses)]
    for prefix, L, supports, masses in owners:
        for group, places in (("supports", [it.x for it in supports]), ("masses", [it.x for it in masses])):
            for i, x in enumerate(places):
                if x > L:
                    yield f"{prefix}{group}[{i}].x = {x:g}: lies outside the beam; allowed are 0 to {L:g} m"


def _of_stops(problem: Written, line: Line) -> Iterator[str]:
    """Stops at places that there are not."""
    for i, stop in enumerate(problem.stops):
        if stop.between is not None:
            yield from _between(f"stops[{i}]", stop.between, line)
        elif stop.x is not None:
            fault = line.fault_of(stop.x)
            if fault:
                yield f"stops[{i}].x = {fault[0]}: {fault[1]}"


def _of_links(problem: Written, line: Line) -> Iterator[str]:
    """Links between places that there are not, or of one beam."""
    for i, link in enumerate(problem.links):
        yield from _between(f"links[{i}]", link.between, line)


def _between(path: str, between: tuple[float | str, float | str], line: Line) -> Iterator[str]:
    """Faults of two places that must lie on different beams."""
    faults = [(i, line.fault_of(place)) for i, place in enumerate(between)]
    for i, fault in faults:
        if fault:
            yield f"{path}.between[{i}] = {fault[0]}: {fault[1]}"
    if not any(fault for _, fault in faults):
        first, second = (line.beam_at(line.at(place)) for place in between)
        if first == second:
            yield f"{path}.between: both places are on one beam; they must be on different beams"


def load_faults(problem: Written, line: Line) -> Iterator[str]:
    """Loads outside their beam, or on none."""
    for i, load in enumerate(problem.point_loads):
        fault = line.fault_of(load.x)
        if fault:
            yield f"point_loads[{i}].x = {fault[0]}: {fault[1]}"
    for i, along in enumerate(problem.uniform_loads):
        path = f"uniform_loads[{i}]"
        if line.several and along.beam not in line.names:
            yield f"{path}.beam = {shown(along.beam)}: there is no such beam; {closest(along.beam, line.names)}"
        elif not line.several and along.beam:
            yield f"{path}.beam = {shown(along.beam)}: there is one beam, without a name"
        else:
            L = line.beams[line.names.index(along.beam)].length
            if along.to is not None and along.to > L:
                yield f"{path}.to = {along.to:g}: lies outside the beam; allowed are 0 to {L:g} m"
            if along.start > L:
                yield f"{path}.from = {along.start:g}: lies outside the beam; allowed are 0 to {L:g} m"
            elif along.to is None and along.start >= L:
                yield f"{path}.from = {along.start:g}: must be less than the length of the beam, {L:g} m"


def start_faults(problem: Written, line: Line) -> Iterator[str]:
    """Initial states that belong to another number of beams, or to none of them."""
    initial = problem.initial
    if isinstance(initial, BeamsStart):
        if not line.several:
            yield 'initial.kind = "beams": there is one beam, whose start is "rest", "polynomial" or "sampled"'
            return
        names = [one.beam for one in initial.beams]
        for i, name in enumerate(names):
            if name not in line.names:
                yield f"initial.beams[{i}].beam = {shown(name)}: there is no such beam; {closest(name, line.names)}"
            elif name in names[:i]:
                yield f"initial.beams[{i}].beam = {shown(name)}: is given in initial.beams[{names.index(name)}] too"
    elif line.several and not isinstance(initial, AtRest | AtEquilibrium):
        yield f'initial.kind = "{initial.kind}": of several beams allowed are "rest", "equilibrium" and "beams"'
    samples = [("initial", getattr(initial, "x", ()), line.length)]
    if isinstance(initial, BeamsStart):
        lengths = dict(zip(line.names, (beam.length for beam in line.beams), strict=True))
        samples = [(f"initial.beams[{i}]", it.x, lengths.get(it.beam, 0.0)) for i, it in enumerate(initial.beams)]
    for path, x, L in samples:
        if x and (x[0] != 0.0 or x[-1] != L):
            yield f"{path}.x: runs from {x[0]:g} to {x[-1]:g}, and must run from 0 to {L:g} m"


def names_used_twice(problem: Written) -> Iterator[str]:
    """Stops whose name another stop has."""
    first: dict[str, int] = {}
    for i, name in enumerate(problem.stop_names):
        if first.setdefault(name, i) < i:
            yield f"stops[{i}].name = {shown(name)}: is the name of stops[{first[name]}] too"


def moved_supports(problem: Written, line: Line, grid_points: int = 101) -> Iterator[str]:
    """Initial shapes that move or turn a fixed support."""
    if isinstance(problem.initial, AtRest | AtEquilibrium):
        return
    import math

    import numpy as np

    initial, grid = shape_on_line(problem.initial, line), line.grid(grid_points)
    for name, shape in (("displacement", initial.displacement_at), ("velocity", initial.velocity_at)):
        for derivative, word, spring in ((0, "moves", "translational"), (1, "turns", "torsional")):
            # A spline through a callable's samples meets a fixed support only within its interpolation error.
            allowed = 1e-6 * float(np.max(np.abs(shape(grid, derivative)), initial=0.0))
            for path, support in supports_of(problem, line):
                value = float(shape(np.array(support.x), derivative))
                if math.isinf(getattr(support, spring)) and abs(value) > allowed:
                    yield (
                        f"initial.{name}: {word} {path} at x = {line.place(support.x)} m, which is fixed; "
                        f"{'its slope' if derivative else 'it'} is {value:g} there and must be 0"
                    )
