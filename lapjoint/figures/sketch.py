"""The sketch of a joint: beam, supports, masses, stops behind their gaps, and all loads.  Only x is to scale."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.figures.style import COLOURS, GREY, PAGE_WIDTH, figure_of, new_axes, style
from lapjoint.figures.text import SMALL, cut_to, frequency_text, literal, width_of
from lapjoint.problem import FloatArray, Problem, Support
from lapjoint.problem.excitation import StepLoad
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
_GAP, _SPRING = 0.42, 0.9  # from the beam to a stop, and the length of a spring
_BEYOND = 1.8  # height of names beyond the ground of their stops
_BELOW = -2.45  # height of the line of positions
_NAME_SHOWN = 14  # characters
_NEAR = 0.5  # distance below which two symbols would overlap
_RIGHT = 1.75  # room on the right of the beam
_LINE = 0.26  # height of a line of text, in units of the sketch at the usual size
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
        half = len(lines) * _LINE / 2
        box = left, left + wide, y - half, y + half
        if any(box[0] < b[1] and b[0] < box[1] and box[2] < b[3] and b[2] < box[3] for b in self.taken):
            return False
        self.taken.append(box)
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


@style()
def plot_joint(problem: Problem, axes: Axes | None = None) -> Axes:
    """Draw a joint: positions to scale, everything else as symbols with numbers beside them.

    Numbers for which there is no room are left out.

    Parameters
    ----------
    problem : Problem
        The joint.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, without scales.
    """
    axes = new_axes(PAGE_WIDTH, HEIGHT) if axes is None else axes
    axes.set_axis_off()
    axes.set_xlim(-_LEFT, _WIDE + _RIGHT)
    axes.set_ylim(_BELOW - 0.75, 2.35)
    page, scale = (
        _Page(axes, (_LEFT + _WIDE + _RIGHT) / figure_of(axes).get_size_inches()[0]),
        _WIDE / problem.line.length,
    )
    _draw_beam(page, problem, scale)
    for support in problem.structure.supports:
        under = any(stop.sign < 0 and abs(stop.x - support.x) * scale < _NEAR for stop in problem.structure.stops)
        _draw_support(page, support, support.x * scale, -0.42 if under else 0.0)
    for stop in problem.structure.stops:
        _draw_stop(page, stop, stop.x * scale, _half_depth(problem, float(problem.line.EI_at(np.array([stop.x]))[0])))
    for mass in problem.structure.masses:
        _draw_mass(page, mass.x * scale)
    _draw_drive(page, problem, scale)
    _draw_static_loads(page, problem, scale)
    _draw_positions(page, problem, scale)
    _name_stops(page, problem, scale)
    _name_masses(page, problem, scale)
    _say_supports(page, problem, scale)
    return axes


def _draw_beam(page: _Page, problem: Problem, scale: float) -> None:
    """The beam, piece by piece."""
    for piece in problem.line.pieces:
        half = _half_depth(problem, piece.EI)
        page.axes.fill_between([piece.start * scale, piece.end * scale], -half, half, color=_BEAM, linewidth=0)
    page.take(0.0, _WIDE, -_HALF, _HALF)


def _half_depth(problem: Problem, EI: float) -> float:
    """Half the depth of a piece of bending stiffness `EI`, N m2: depths go with its fourth root, as round bars' do."""
    stiffest = max(piece.EI for piece in problem.line.pieces)
    return _HALF * max(math.sqrt(math.sqrt(EI / stiffest)), _THINNEST)


def _draw_mass(page: _Page, x: float) -> None:
    """A square block about the axis of the beam."""
    page.axes.fill([x - _MASS, x + _MASS, x + _MASS, x - _MASS], [-_MASS, -_MASS, _MASS, _MASS], color=GREY, zorder=3)
    page.take(x - _MASS, x + _MASS, -_MASS, _MASS)


def _draw_support(page: _Page, support: Support, x: float, aside: float) -> None:
    """Draw a wall, a pin, or springs; springs are moved by `aside`, so that they do not overlap a stop."""
    if math.isinf(support.translational) and math.isinf(support.torsional):
        outside = -1.0 if x <= _WIDE / 2 else 1.0
        page.line([x, x], [-0.75, 0.75], _INK, 1.2)
        for at in np.linspace(-0.75, 0.6, 8):
            page.line([x, x + outside * 0.16], [float(at) + 0.08, float(at)], _INK, 0.5)
        page.take(x, x + outside * 0.16, -0.75, 0.75)
        return
    if math.isinf(support.translational):
        page.axes.fill([x, x - 0.2, x + 0.2], [-_HALF, -0.55, -0.55], facecolor="white", edgecolor=_INK, linewidth=0.9)
        page.ground(x, -0.55, -1.0)
    elif support.translational:
        page.spring(x + aside, -_HALF, -_HALF - _SPRING, _INK)
        page.ground(x + aside, -_HALF - _SPRING, -1.0)
    if support.torsional:
        turn = np.linspace(0.0, 3.5 * math.pi, 60)
        radius = 0.1 + 0.02 * turn
        page.line(x + radius * np.cos(turn), 0.45 + radius * np.sin(turn), _INK, 0.8)
        page.take(x - 0.32, x + 0.32, 0.13, 0.77)


def _draw_stop(page: _Page, stop: PlacedStop, x: float, surface: float) -> None:
    """A plate behind its gap from the `surface` of the beam, a spring, and the ground."""
    up = float(stop.sign)
    face = up * (surface + (_GAP if stop.gap > 0 else 0.0))
    page.line([x - 0.16, x + 0.16], [face, face], _STOP, 1.8)
    page.spring(x, face, face + up * _SPRING, _STOP)
    page.ground(x, face + up * _SPRING, up)


def _name_stops(page: _Page, problem: Problem, scale: float) -> None:
    """Write names and numbers beside the stops, or names alone where there is no room for numbers, beside the stops or
    beyond their ground; and the number of stops."""
    for stop, name in zip(problem.structure.stops, problem.stop_names, strict=True):
        short = cut_to(literal(name), _NAME_SHOWN)
        gap = _number("interference", -stop.gap, "m") if stop.gap < 0 else _number("gap", stop.gap, "m")
        numbers = [gap, _number("k", stop.stiffness, "N/m")]
        numbers += [_number("c", stop.damping, "N s/m")] if stop.damping else []
        numbers += ["fixed in space"] if stop.in_space else []
        x, y, text = stop.x * scale, stop.sign * 1.0, "\n".join((short, *numbers))
        _ = (
            page.say(x + 0.36, y, text, _STOP)
            or page.say(x - 0.36, y, text, _STOP, "right")
            or page.say(x + 0.36, y, short, _STOP)
            or page.say(x, stop.sign * _BEYOND, short, _STOP, "center")
        )
    if len(problem.stops) > 1:
        page.say(_WIDE, 2.15, f"{len(problem.stops)} stops", _STOP, "right")


def _name_masses(page: _Page, problem: Problem, scale: float) -> None:
    """Names, masses and rotary inertias above or below the masses, or names and masses beside them, where there is
    room."""
    for mass in problem.structure.masses:
        name, x = cut_to(literal(mass.name), _NAME_SHOWN), mass.x * scale
        lines = [name] if name else []
        lines.append(_number("m", mass.mass, "kg"))
        if mass.rotary_inertia:
            lines.append(_number("J", mass.rotary_inertia, "kg m2"))
        text, y = "\n".join(lines), _MASS + 0.1 + len(lines) * _LINE / 2
        short, aside, near = _number(name or "m", mass.mass, "kg"), _MASS + 0.1, _HALF + 0.05 + _LINE / 2
        _ = (
            page.say(x, y, text, GREY, "center")
            or page.say(x, -y, text, GREY, "center")
            or page.say(x - aside, near, short, GREY, "right")
            or page.say(x + aside, near, short, GREY)
            or page.say(x - aside, -near, short, GREY, "right")
            or page.say(x + aside, -near, short, GREY)
        )


def _say_supports(page: _Page, problem: Problem, scale: float) -> None:
    """Write stiffnesses beside the supports."""
    for support in problem.structure.supports:
        x = support.x * scale
        if 0 < support.translational < math.inf:
            text = _number("k", support.translational, "N/m")
            _ = page.say(x + 0.36, -0.75, text) or page.say(x - 0.8, -0.75, text, align="right")
        if 0 < support.torsional < math.inf:
            page.say(x + 0.4, 0.5, _number("kt", support.torsional, "N m/rad"))


def _draw_drive(page: _Page, problem: Problem, scale: float) -> None:
    """Draw the motion of the base on the left, and the loads as arrows."""
    if problem.base_motion is not None:
        page.arrow(-0.75, 0.8, -0.8, "<->")
        page.say(-_LEFT + 0.05, 1.35, _said_of_base(problem), _DRIVE)
    for load in problem.point_loads:
        place = problem.line.at(load.x)
        x, down = place * scale, isinstance(load, StepLoad) and load.force < 0
        crowded = any(stop.sign < 0 and abs(stop.x - place) * scale < _NEAR for stop in problem.structure.stops)
        tip, tail = (_HALF, 1.5) if down else (1.5, _HALF) if crowded else (-_HALF, -1.5)
        page.arrow(x, tip, tail, "->")
        text = f"{load.force:g} N" if isinstance(load, StepLoad) else f"{load.kind} force"
        page.say(x - 0.12, max(tip, tail, key=abs), text, _DRIVE, "right")


def _draw_static_loads(page: _Page, problem: Problem, scale: float) -> None:
    """Gravity as an arrow at the right, and uniform loads as rows of arrows."""
    if problem.gravity is not None and problem.gravity.acceleration:
        x, up = _WIDE + 1.2, math.copysign(1.0, problem.gravity.acceleration)
        page.arrow(x, up * 0.45, -up * 0.45, "->")
        page.say(x, 0.75, f"{abs(problem.gravity.acceleration):g} m/s2", _DRIVE, "center")
    for load in problem.uniform_loads:
        start, end = load.start * scale, (problem.line.length if load.to is None else load.to) * scale
        far, near = _HALF + _ALONG, _HALF
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


def _draw_positions(page: _Page, problem: Problem, scale: float) -> None:
    """Draw a line with a tick and a number at every position."""
    supports, stops = ([it.x for it in problem.structure.supports], [it.x for it in problem.structure.stops])
    other = [mass.x for mass in problem.structure.masses] + [piece.end for piece in problem.line.pieces]
    page.line([0.0, _WIDE], [_BELOW, _BELOW], GREY, 0.7)
    page.say(_WIDE, _BELOW - 0.42, f"{problem.line.length:g}", GREY, "center")
    page.say(_WIDE + 0.5, _BELOW - 0.42, "x [m]", GREY)
    for place in sorted({0.0, problem.line.length, *supports, *stops, *other}):
        page.line([place * scale] * 2, [_BELOW - 0.07, _BELOW + 0.07], GREY, 0.7)
        if place != problem.line.length:
            page.say(place * scale, _BELOW - 0.42, f"{place:.4g}", GREY, "center")


def _number(symbol: str, value: float, unit: str) -> str:
    return f"{symbol} {value:.4g} {unit}"
