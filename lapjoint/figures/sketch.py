"""The sketch of a joint: beams, supports, masses, links, stops behind their gaps, and loads.  Only x is to scale."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.figures.style import COLOURS, GREY, PAGE_WIDTH, figure_of, new_axes, style
from lapjoint.figures.text import SMALL, cut_to, frequency_text, literal, width_of
from lapjoint.problem import FloatArray, NamedBeam, Problem, Support
from lapjoint.problem.excitation import PointLoad, SineLoad, StepLoad
from lapjoint.problem.placing import uniform_load_shape
from lapjoint.problem.structure import PlacedLink
from lapjoint.problem.supports_and_stops import PlacedStop

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HEIGHT = 2.5
"""Height of the figure, inches."""
_WIDE, _LEFT = 10.0, 1.4  # length of the beam on the page, and the room on its left, in units of the sketch
_HALF = 0.13  # half the beam's depth, of a stepped beam where its bending stiffness is largest
_THINNEST = 0.3  # least depth of a piece of a stepped beam, as a fraction of the largest
_MASS = 0.3  # half the side of a mass
_ALONG = 0.55  # height of the arrows of a uniform load above the beam
GAP = 0.42
"""Height of an open gap, units of the sketch."""
_SPRING = 0.9  # length of a spring
_HEAD = 0.25  # from a beam to the head of a stop that holds two beams together
_BEYOND = 1.8  # height of names beyond the ground of their stops
_BELOW = -2.45  # height of the line of positions
_NAME_SHOWN = 14  # characters
_NEAR = 0.5  # distance below which two symbols would overlap
_RIGHT = 1.75  # room on the right of the beam
_INCHES = 0.42  # of the page for a unit of height that several beams need
_LINE = 0.26  # height of a line of text, in units of the sketch at the usual size
_WALL, _PIN, _COIL = 0.75, 0.55, 0.45  # from a beam to the end of a wall, to the ground of a pin, and to a coil
_ASIDE = 0.42  # from a support on springs to its springs where a stop is below
_APART = 1.9  # height between two beams that lie above each other
_PAD = 0.042  # inches that matplotlib leaves on each side of the axes
_AIR = 0.05  # inches between two texts on a line, at least
_INK = "0.15"
_BEAM, _STOP, _DRIVE = COLOURS[0], COLOURS[1], COLOURS[2]


@dataclass
class _Page:
    """Axes, and their occupied boxes: a text that would overlap an occupied box is left out."""

    axes: Axes
    per_inch: float
    """Units of the sketch in an inch."""
    taken: list[tuple[float, float, float, float]] = field(default_factory=list)
    """Occupied boxes: left, right, lowest and highest coordinate."""

    def line(self, x: FloatArray | list[float], y: FloatArray | list[float], colour: str, width: float) -> None:
        """Draw a line."""
        self.axes.plot(x, y, color=colour, linewidth=width, linestyle="-")

    def take(self, left: float, right: float, lowest: float, highest: float) -> None:
        """Mark a box as occupied."""
        self.taken.append((min(left, right), max(left, right), min(lowest, highest), max(lowest, highest)))

    def say(self, x: float, y: float, text: str, colour: str = _INK, align: str = "left") -> bool:
        """Write a text centred at height `y`, if there is room, and say whether it was written."""
        lines = text.split("\n")
        wide = max(width_of(line, SMALL) for line in lines) * self.per_inch
        left = x - {"left": 0.0, "center": wide / 2, "right": wide}[align]
        half, air = len(lines) * _LINE / 2, _AIR * self.per_inch
        box = left, left + wide, y - half, y + half
        if left < -_LEFT or left + wide > _WIDE + _RIGHT:
            return False
        if any(box[0] < b[1] and b[0] < box[1] and box[2] < b[3] and b[2] < box[3] for b in self.taken):
            return False
        self.take(left - air, left + wide + air, y - half, y + half)
        self.axes.text(x, y, text, color=colour, fontsize=SMALL, ha=align, va="center", linespacing=1.15)
        return True

    def ground(self, x: float, y: float, up: float, wide: float = 0.32) -> None:
        """A hatched line at `y`, with the hatching above (`up` = 1) or below (-1)."""
        self.line([x - wide, x + wide], [y, y], _INK, 0.9)
        for at in np.linspace(x - wide, x + wide * 0.75, 6):
            self.line([float(at), float(at) + 0.2 * wide], [y, y + up * 0.14], _INK, 0.5)
        self.take(x - wide, x + 1.05 * wide, y, y + up * 0.14)

    def spring(self, x: float, start: float, end: float, colour: str) -> None:
        """A zigzag along y from `start` to `end`."""
        share = np.array([0.0, 0.15, *np.linspace(0.2, 0.8, 7), 0.85, 1.0])
        side = np.array([0.0, 0.0, 1, -1, 1, -1, 1, -1, 1, 0.0, 0.0])
        self.line(x + 0.16 * side, start + (end - start) * share, colour, 0.9)
        self.take(x - 0.16, x + 0.16, start, end)

    def arrow(self, x: float, tip: float, tail: float, form: str) -> None:
        """An arrow along y."""
        look = {"arrowstyle": form, "color": _DRIVE, "linewidth": 1.1, "shrinkA": 0, "shrinkB": 0}
        self.axes.annotate("", (x, tip), (x, tail), arrowprops=look)
        self.take(x - 0.1, x + 0.1, tip, tail)


@dataclass(frozen=True)
class Plan:
    """Where positions on the line of beams, and what stands there, lie on the page, in the coordinates of its axes."""

    problem: Problem

    @cached_property
    def origins(self) -> list[float]:
        """Where each beam's left end lies along x, m."""
        return [beam.origin if isinstance(beam, NamedBeam) else 0.0 for beam in self.problem.line.beams]

    @cached_property
    def ends(self) -> tuple[float, float]:
        """The leftmost and the rightmost end of a beam along x, m."""
        ends = [origin + beam.length for origin, beam in zip(self.origins, self.problem.line.beams, strict=True)]
        return min(self.origins), max(ends)

    @cached_property
    def scale(self) -> float:
        """Units of the sketch in a metre."""
        return _WIDE / (self.ends[1] - self.ends[0])

    @cached_property
    def heights(self) -> list[float]:
        """Height of each beam on the page: beams that are drawn at one offset share it; the lowest is at 0."""
        offsets = [beam.offset if isinstance(beam, NamedBeam) else 0.0 for beam in self.problem.line.beams]
        levels = sorted(set(offsets))
        return [_APART * levels.index(offset) for offset in offsets]

    def along(self, x: float) -> float:
        """Coordinate along x, m, of a position on the line, m."""
        i = self.problem.line.beam_at(x)
        return self.origins[i] + x - self.problem.line.starts[i]

    def x(self, x: float) -> float:
        """Horizontal coordinate on the page of a position on the line, m."""
        return (self.along(x) - self.ends[0]) * self.scale

    def y(self, x: float) -> float:
        """Height on the page of the beam at a position on the line, m."""
        return self.heights[self.problem.line.beam_at(x)]

    def below(self, x: float) -> bool:
        """Whether a stop hangs under the beam near a position on the line, m."""
        near = (abs(stop.x - x) * self.scale < _NEAR for stop in self.problem.structure.stops if stop.sign < 0)
        return any(near)

    def stop_at(self, stop: PlacedStop) -> tuple[float, float, float]:
        """Horizontal coordinate of a stop on the page, and heights of its face and of the other end of its spring."""
        x, y, up, other = self.x(stop.met), self.y(stop.met), float(stop.sign), self.y(stop.x)
        if stop.side == "between":
            x = (self.x(stop.x) + x) / 2
            if other < y:  # closes where the beams come apart: its head is beyond the upper beam
                return x, y + _HALF + _HEAD, other + _HALF
        surface = _half_depth(self.problem, float(self.problem.line.EI_at(np.array([stop.met]))[0]))
        opened = GAP if stop.gap > 0 else 0.0
        far = other - _HALF if stop.side == "between" else y + up * (surface + opened + _SPRING)
        return x, y + up * (surface + opened), far

    def support_at(self, support: Support) -> tuple[float, float]:
        """Where the ground of a support is on the page; of one that resists turning alone, where its coil is."""
        x, y, below = self.x(support.x), self.y(support.x), self.below(support.x)
        if math.isinf(support.translational):
            reach = _WALL if math.isinf(support.torsional) else _PIN
            return x, y + (reach if below else -reach)
        if support.translational:
            return x - (_ASIDE if below else 0.0), y - _HALF - _SPRING
        return x, y + _COIL


@style()
def plot_joint(problem: Problem, axes: Axes | None = None, *, width: float = PAGE_WIDTH) -> Axes:
    """Draw a joint: positions to scale, everything else as symbols with numbers beside them.

    Numbers for which there is no room are left out.

    Parameters
    ----------
    problem : Problem
        The joint.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    width : float
        Width of the new figure, inches; a narrow figure has fewer numbers.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, without scales.
    """
    plan = Plan(problem)
    top = max(plan.heights)
    axes = new_axes(width, HEIGHT + top * _INCHES) if axes is None else axes
    axes.set_axis_off()
    axes.set_xlim(-_LEFT, _WIDE + _RIGHT)
    axes.set_ylim(_BELOW - 0.75, 2.35 + top)
    page = _Page(axes, (_LEFT + _WIDE + _RIGHT) / (figure_of(axes).get_size_inches()[0] - 2 * _PAD))
    _draw_beams(page, plan)
    for support in problem.structure.supports:
        _draw_support(page, plan, support)
    for stop in problem.structure.stops:
        _draw_stop(page, plan, stop)
    for link in problem.structure.links:
        _draw_link(page, plan, link)
    for mass in problem.structure.masses:
        _draw_mass(page, plan.x(mass.x), plan.y(mass.x))
    _draw_drive(page, plan)
    _draw_static_loads(page, plan)
    _draw_positions(page, plan)
    _name_beams(page, plan)
    _say_supports(page, plan)
    _name_stops(page, plan)
    _name_masses(page, plan)
    _say_loads(page, plan)
    _say_links(page, plan)
    return axes


def _draw_beams(page: _Page, plan: Plan) -> None:
    """The beams, piece by piece."""
    for piece in plan.problem.line.pieces:
        half, y = _half_depth(plan.problem, piece.EI), plan.y(piece.start)
        ends = [plan.x(piece.start), plan.x(piece.end)]
        page.axes.fill_between(ends, y - half, y + half, color=_BEAM, linewidth=0)
        page.take(ends[0], ends[1], y - _HALF, y + _HALF)


def _name_beams(page: _Page, plan: Plan) -> None:
    """Names of several beams, above their middles or wherever there is room."""
    line = plan.problem.line
    for name, start, end, y in zip(line.names, line.starts, line.ends, plan.heights, strict=True):
        places = [plan.x(start + share * (end - start)) for share in (0.5, 0.3, 0.7, 0.15, 0.85)] if name else []
        _ = any(
            page.say(x, y + side * 0.32, cut_to(name, _NAME_SHOWN), _BEAM, "center") for side in (1, -1) for x in places
        )


def _half_depth(problem: Problem, EI: float) -> float:
    """Half the depth of a piece of bending stiffness `EI`, N m2: depths go with its fourth root, as round bars' do."""
    stiffest = max(piece.EI for piece in problem.line.pieces)
    return _HALF * max(math.sqrt(math.sqrt(EI / stiffest)), _THINNEST)


def _draw_mass(page: _Page, x: float, y: float) -> None:
    """A square block about the axis of the beam."""
    corners = [y - _MASS, y - _MASS, y + _MASS, y + _MASS]
    page.axes.fill([x - _MASS, x + _MASS, x + _MASS, x - _MASS], corners, color=GREY, zorder=3)
    page.take(x - _MASS, x + _MASS, y - _MASS, y + _MASS)


def _draw_support(page: _Page, plan: Plan, support: Support) -> None:
    """Draw a wall, a pin, or springs."""
    x, y = plan.x(support.x), plan.y(support.x)
    at, ground = plan.support_at(support)
    if math.isinf(support.translational) and math.isinf(support.torsional):
        outside = -1.0 if x <= _WIDE / 2 else 1.0
        page.line([x, x], [y - _WALL, y + _WALL], _INK, 1.2)
        for height in np.linspace(y - _WALL, y + 0.6, 8):
            page.line([x, x + outside * 0.16], [float(height) + 0.08, float(height)], _INK, 0.5)
        page.take(x, x + outside * 0.16, y - _WALL, y + _WALL)
        return
    if math.isinf(support.translational):
        up = math.copysign(1.0, ground - y)  # from above where a stop is below
        page.axes.fill(
            [x, x - 0.2, x + 0.2], [y + up * _HALF, ground, ground], facecolor="white", edgecolor=_INK, linewidth=0.9
        )
        page.ground(x, ground, up)
    elif support.translational:
        page.spring(at, y - _HALF, ground, _INK)
        page.ground(at, ground, -1.0)
    if support.torsional:
        _draw_coil(page, x, y + _COIL)


def _draw_coil(page: _Page, x: float, y: float) -> None:
    """A torsional spring about a point."""
    turn = np.linspace(0.0, 3.5 * math.pi, 60)
    radius = 0.1 + 0.02 * turn
    page.line(x + radius * np.cos(turn), y + radius * np.sin(turn), _INK, 0.8)
    page.take(x - 0.32, x + 0.32, y - 0.32, y + 0.32)


def _draw_link(page: _Page, plan: Plan, link: PlacedLink) -> None:
    """Springs between two beams, or a bar where they are infinite, and a damper beside them; a coil resists turning."""
    (x0, y0), (x1, y1) = ((plan.x(at), plan.y(at)) for at in (link.first, link.second))
    if math.isinf(link.translational) or y0 == y1:
        page.line([x0, x1], [y0, y1], _INK, 2.2)
        page.take(min(x0, x1) - 0.1, max(x0, x1) + 0.1, y0, y1)
    elif link.translational:
        low, high = sorted((y0, y1))
        page.spring((x0 + x1) / 2, low + _HALF, high - _HALF, _INK)
    if link.damping and y0 != y1:
        low, high = sorted((y0, y1))
        _draw_damper(page, (x0 + x1) / 2 - 0.34, low + _HALF, high - _HALF)
    if link.torsional or link.torsional_damping:
        _draw_coil(page, (x0 + x1) / 2 + 0.4, (y0 + y1) / 2)


def _draw_damper(page: _Page, x: float, low: float, high: float) -> None:
    """A pot that is open above, with a piston in it, between two heights."""
    middle, deep = (low + high) / 2, 0.2 * (high - low)
    page.line([x, x], [low, middle - deep], _INK, 0.8)
    page.line(
        [x - 0.1, x - 0.1, x + 0.1, x + 0.1], [middle + deep, middle - deep, middle - deep, middle + deep], _INK, 0.8
    )
    page.line([x - 0.07, x + 0.07], [middle, middle], _INK, 1.4)
    page.line([x, x], [middle, high], _INK, 0.8)
    page.take(x - 0.12, x + 0.12, low, high)


def _draw_stop(page: _Page, plan: Plan, stop: PlacedStop) -> None:
    """A plate behind its gap from the surface of the beam, a spring, and the ground, or the other beam."""
    x, face, far = plan.stop_at(stop)
    if stop.side == "between" and plan.y(stop.x) < plan.y(stop.met):
        surface = plan.y(stop.met) - _HALF
        page.spring(x, far, surface, _STOP)
        page.line([x, x], [surface, face], _STOP, 0.9)
    else:
        page.spring(x, face, far, _STOP)
    if stop.side != "between":
        page.ground(x, far, float(stop.sign))
    page.line([x - 0.16, x + 0.16], [face, face], _STOP, 1.8)


def _name_stops(page: _Page, plan: Plan) -> None:
    """Write names and numbers beside the stops, or names alone where there is no room for numbers, beside the stops or
    beyond their ground; and the number of stops."""
    problem = plan.problem
    for stop, name in zip(problem.structure.stops, problem.stop_names, strict=True):
        short = cut_to(literal(name), _NAME_SHOWN)
        gap = _number("interference", -stop.gap, "m") if stop.gap < 0 else _number("gap", stop.gap, "m")
        numbers = [gap, _number("k", stop.stiffness, "N/m")]
        numbers += [_number("c", stop.damping, "N s/m")] if stop.damping else []
        numbers += ["fixed in space"] if stop.in_space and stop.side != "between" else []
        x, y, text = plan.x(stop.x), plan.y(stop.x), "\n".join((short, *numbers))
        middle, beyond = y + stop.sign * 1.0, y + stop.sign * _BEYOND
        head = max(y, plan.y(stop.reading[0][0])) + _HALF + _HEAD
        if stop.side == "between":
            middle = beyond = (y + plan.y(stop.reading[0][0])) / 2
        _ = (
            page.say(x + 0.36, middle, text, _STOP)
            or page.say(x - 0.36, middle, text, _STOP, "right")
            or page.say(x + 0.36, middle, short, _STOP)
            or page.say(x - 0.36, middle, short, _STOP, "right")
            or page.say(x, beyond, short, _STOP, "center")
            or page.say(plan.x(stop.x), head + _LINE, short, _STOP, "center")
        )
    if len(problem.stops) > 1:
        page.say(_WIDE, 2.15 + max(plan.heights), f"{len(problem.stops)} stops", _STOP, "right")


def _name_masses(page: _Page, plan: Plan) -> None:
    """Names, masses and rotary inertias above or below the masses, or names and masses beside them, where there is
    room."""
    for mass in plan.problem.structure.masses:
        name, x, y = cut_to(literal(mass.name), _NAME_SHOWN), plan.x(mass.x), plan.y(mass.x)
        lines = [name] if name else []
        lines.append(_number("m", mass.mass, "kg"))
        if mass.rotary_inertia:
            lines.append(_number("J", mass.rotary_inertia, "kg m2"))
        text, above = "\n".join(lines), _MASS + 0.1 + len(lines) * _LINE / 2
        short, aside, near = _number(name or "m", mass.mass, "kg"), _MASS + 0.1, _HALF + 0.05 + _LINE / 2
        _ = (
            page.say(x, y + above, text, GREY, "center")
            or page.say(x, y - above, text, GREY, "center")
            or page.say(x - aside, y + near, short, GREY, "right")
            or page.say(x + aside, y + near, short, GREY)
            or page.say(x - aside, y - near, short, GREY, "right")
            or page.say(x + aside, y - near, short, GREY)
            or page.say(x, y + above, name or short, GREY, "center")
            or page.say(x, y - above, name or short, GREY, "center")
        )


def _say_supports(page: _Page, plan: Plan) -> None:
    """Write stiffnesses beside the supports."""
    for support in plan.problem.structure.supports:
        x, y = plan.x(support.x), plan.y(support.x)
        if 0 < support.translational < math.inf:
            text = _number("k", support.translational, "N/m")
            _ = page.say(x + 0.36, y - 0.75, text) or page.say(x - 0.8, y - 0.75, text, align="right")
        if 0 < support.torsional < math.inf:
            page.say(x + 0.4, y + 0.5, _number("kt", support.torsional, "N m/rad"))


def _say_links(page: _Page, plan: Plan) -> None:
    """Write dampings beside the links."""
    for link in plan.problem.structure.links:
        numbers = [_number("c", link.damping, "N s/m")] if link.damping else []
        numbers += [_number("ct", link.torsional_damping, "N m s/rad")] if link.torsional_damping else []
        x, y = (plan.x(link.first) + plan.x(link.second)) / 2, (plan.y(link.first) + plan.y(link.second)) / 2
        if numbers:
            text = "\n".join(numbers)
            _ = page.say(x - 0.5, y, text, align="right") or page.say(x + 0.8, y, text)


def _draw_drive(page: _Page, plan: Plan) -> None:
    """Draw the motion of the base on the left, and the loads as arrows."""
    problem = plan.problem
    if problem.base_motion is not None:
        page.arrow(-0.75, 0.8, -0.8, "<->")
        text = _said_of_base(problem)
        _ = page.say(-_LEFT + 0.05, 1.35, text, _DRIVE) or page.say(-_LEFT + 0.05, -1.35, text, _DRIVE)
    for load in problem.point_loads:
        place = problem.line.at(load.x)
        head, tail = _ends_of(load, plan)
        page.arrow(plan.x(place), plan.y(place) + head, plan.y(place) + tail, "->")


def _ends_of(load: PointLoad, plan: Plan) -> tuple[float, float]:
    """Heights of head and tail of the arrow of a load above the beam."""
    if isinstance(load, StepLoad) and load.force < 0:
        return _HALF, 1.5
    return (1.5, _HALF) if plan.below(plan.problem.line.at(load.x)) else (-_HALF, -1.5)


def _say_loads(page: _Page, plan: Plan) -> None:
    """Write what each load is beside its arrow, or beyond the arrow."""
    for load in plan.problem.point_loads:
        place = plan.problem.line.at(load.x)
        x, y, end = plan.x(place), plan.y(place), max(_ends_of(load, plan), key=abs)
        beside, beyond = y + end, y + end + math.copysign(_LINE, end)
        places = ((x - 0.12, beside, "right"), (x + 0.12, beside, "left"), (x, beyond, "center"))
        _ = any(page.say(u, w, text, _DRIVE, side) for text in _said_of_load(load) for u, w, side in places)


def _said_of_load(load: PointLoad) -> tuple[str, ...]:
    """A load in a few words, the longest text first."""
    if isinstance(load, StepLoad):
        return (f"{load.force:g} N",)
    if isinstance(load, SineLoad):
        return f"{load.force:g} N at\n{frequency_text(load.angular_frequency)}", f"{load.force:g} N"
    return f"{load.kind} force", load.kind


def _draw_static_loads(page: _Page, plan: Plan) -> None:
    """Gravity as an arrow at the right, and uniform loads as rows of arrows."""
    problem = plan.problem
    if problem.gravity is not None and problem.gravity.acceleration:
        x, up = _WIDE + 1.2, math.copysign(1.0, problem.gravity.acceleration)
        page.arrow(x, up * 0.45, -up * 0.45, "->")
        text = f"{abs(problem.gravity.acceleration):g} m/s2"
        _ = page.say(x, 0.75, text, _DRIVE, "center") or page.say(_WIDE + _RIGHT, 0.75, text, _DRIVE, "right")
    for load in problem.uniform_loads:
        ((first, last, _),) = uniform_load_shape(load, problem.line).pieces
        start, end, y = plan.x(first), plan.x(last), plan.y(first)
        far, near = y + _HALF + _ALONG, y + _HALF
        tip, tail = (near, far) if load.force_per_length < 0 else (far, near)
        for x in np.linspace(start, end, max(2, round((end - start) / 0.5) + 1)):
            page.arrow(float(x), tip, tail, "->")
        page.line([start, end], [far, far], _DRIVE, 0.8)
        page.say((start + end) / 2, far + _LINE / 2 + 0.05, f"{load.force_per_length:g} N/m", _DRIVE, "center")


def _said_of_base(problem: Problem) -> str:
    """The motion of the base, in one or two lines."""
    base = problem.base_motion
    assert base is not None
    omega = problem.excitation_frequency
    if base.kind == "sine":
        return f"base: {base.amplitude:g} m at\n{frequency_text(base.angular_frequency)}"
    if omega is not None:
        return f"base: {len(base.waves)} harmonics of\n{frequency_text(omega)}"
    return f"base: {base.kind}"


def _draw_positions(page: _Page, plan: Plan) -> None:
    """Draw a line with a tick and a number at every position."""
    structure, (left, right) = plan.problem.structure, plan.ends
    at = [*structure.line.edges, *(piece.end for piece in structure.line.pieces)]
    at += [support.x for support in structure.supports] + [mass.x for mass in structure.masses]
    at += [x for stop in structure.stops for x, _ in stop.reading]
    at += [x for link in structure.links for x in (link.first, link.second)]
    at += [structure.line.at(load.x) for load in plan.problem.point_loads]
    loaded = (uniform_load_shape(load, structure.line).pieces for load in plan.problem.uniform_loads)
    at += [end for pieces in loaded for first, last, _ in pieces for end in (first, last)]
    page.line([0.0, _WIDE], [_BELOW, _BELOW], GREY, 0.7)
    page.say(_WIDE, _BELOW - 0.42, f"{right:g}", GREY, "center")
    _ = page.say(_WIDE + 0.5, _BELOW - 0.42, "x [m]", GREY) or page.say(_WIDE + 0.25, _BELOW, "x [m]", GREY)
    for place in sorted({plan.along(x) for x in at}):
        x = (place - left) * plan.scale
        page.line([x] * 2, [_BELOW - 0.07, _BELOW + 0.07], GREY, 0.7)
        if place != right:
            page.say(x, _BELOW - 0.42, f"{place:.4g}", GREY, "center")


def _number(symbol: str, value: float, unit: str) -> str:
    return f"{symbol} {value:.4g} {unit}"
