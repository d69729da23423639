"""The sketch of a joint as a page shows it: the figure ``joint`` as SVG, and where its numbers can be dragged."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from explore.answers import Drawn, Handle
from lapjoint.figures.sketch import GAP, Plan, plot_joint
from lapjoint.figures.style import COLUMN_WIDTH, PAGE_WIDTH, figure_of, svg_of
from lapjoint.problem import Problem
from lapjoint.problem.override import path_keys
from lapjoint.problem.places import split_place
from lapjoint.problem.placing import masses_of, supports_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STEP = 1e-2
"""Step of a position, as a share of the beam's length: with the keyboard the beam is crossed in ten steps of ten."""
GAP_STEP = 1e-5
"""Step of a gap that is not above 0, as a share of the beam's length: of the size of the gaps of loose joints."""
_POINTS = 72
"""Units of an SVG in an inch."""
_INK, _PAPER = "#262626", "#ffffff"
_SHARE = 75
"""Share of a colour in its mixture with the ink, percent: its contrast to white and to black is then above 4.5."""


@dataclass(frozen=True)
class _Spot:
    """A number of the problem, and where it is in the sketch."""

    path: str
    label: str
    at: tuple[float, float]
    """Where it is, in the coordinates of the axes."""
    up: int = 0
    """Direction in which a gap grows; 0 of a position."""


def drawn(problem: Problem) -> Drawn:
    """The sketch of a joint, wide and narrow, and its handles.

    Parameters
    ----------
    problem : Problem
        The joint.

    Returns
    -------
    Drawn
        Both pictures, and the handles in the order stops, supports, masses.
    """
    plan = Plan(problem)
    wide, narrow = (plot_joint(problem, width=width) for width in (PAGE_WIDTH, COLUMN_WIDTH))
    svg = _on_a_page(svg_of(wide), "wide-"), _on_a_page(svg_of(narrow), "narrow-")  # makes the layout, too
    return Drawn(svg, tuple(_handle(plan, spot, (wide, narrow)) for spot in _spots(plan)))


def _spots(plan: Plan) -> Iterator[_Spot]:
    """All that can be moved: stops, supports and masses along their beams, and gaps by the faces of the stops."""
    problem = plan.problem
    for i, (stop, name) in enumerate(zip(problem.structure.stops, problem.stop_names, strict=True)):
        x, face, far = plan.stop_at(stop)
        yield _Spot(f"stops.{i}.gap", f"{name}, gap", (x, face), stop.sign)
        if stop.side != "between":
            yield _Spot(f"stops.{i}.x", f"{name}, position", (x, far))
            continue
        for k, at in enumerate((stop.x, stop.met)):
            on = problem.line.names[problem.line.beam_at(at)]
            yield _Spot(f"stops.{i}.between.{k}", f"{name}, position on {on}", (plan.x(at), plan.y(at)))
    for path, support in supports_of(problem, problem.line):
        yield _Spot(*_named(problem, path, "support", ""), plan.support_at(support))
    for path, mass in masses_of(problem, problem.line):
        yield _Spot(*_named(problem, path, "mass", mass.name), (plan.x(mass.x), plan.y(mass.x)))


def _named(problem: Problem, path: str, word: str, name: str) -> tuple[str, str]:
    """The path and the label of the position of a part of a beam; parts without a name are numbered."""
    keys = path_keys(path)
    on = f"{problem.beams[int(keys[1])].name}, " if keys[0] == "beams" else ""
    return ".".join((*keys, "x")), f"{on}{name or f'{word} {int(keys[-1]) + 1}'}, position"


def _handle(plan: Plan, spot: _Spot, axes: tuple[Axes, Axes]) -> Handle:
    """A spot with its value and limits, in both pictures."""
    value, beam, length = _value(plan.problem, spot.path)
    (wide, over_wide), (narrow, over_narrow) = (_in_svg(one, spot.at) for one in axes)
    along = -spot.up / GAP if spot.up else 1 / plan.scale
    return Handle(
        path=spot.path,
        label=f"{spot.label} in m",
        value=value,
        beam=beam,
        least=-length if spot.up else 0.0,
        most=length,
        step=(GAP_STEP if spot.up else STEP) * length,
        is_gap=bool(spot.up),
        centres=(wide, narrow),
        reach=(along / over_wide[bool(spot.up)], along / over_narrow[bool(spot.up)]),
    )


def _value(problem: Problem, path: str) -> tuple[float, str, float]:
    """The value at a path, m, what a place begins with before it, and the length of its beam, m."""
    keys = path_keys(path)
    found: Any = problem
    for key in keys:
        found = found[int(key)] if key.isdecimal() else getattr(found, key)
    lengths = {name: beam.length for name, beam in zip(problem.line.names, problem.line.beams, strict=True)}
    if isinstance(found, str):
        place = split_place(found)
        assert place is not None
        return place[1], f"{found.rpartition(':')[0]}:", lengths[place[0]]
    on = problem.line.beams[int(keys[1]) if keys[0] == "beams" else 0]
    return float(found), "", max(lengths.values()) if keys[-1] == "gap" else on.length


def _in_svg(axes: Axes, at: tuple[float, float]) -> tuple[tuple[float, float], tuple[float, float]]:
    """A point of the axes in the SVG, from the left and from the top, and units of the SVG in units of the axes."""
    figure = figure_of(axes)
    (x, y), (zero_x, zero_y), (one_x, one_y) = axes.transData.transform([at, (0, 0), (1, 1)]) * _POINTS / figure.dpi
    return (float(x), float(figure.get_figheight() * _POINTS - y)), (float(one_x - zero_x), float(one_y - zero_y))


def _on_a_page(svg: str, prefix: str) -> str:
    """An SVG with the colours of a page, light or dark, whose names occur once in the page."""
    svg = re.sub(r'(\bid="|xlink:href="#|url\(#)', rf"\g<1>{prefix}", svg)
    return re.sub(r"\b(fill|stroke): (#[0-9a-f]{6})", lambda found: f"{found[1]}: {_colour(found[2])}", svg)


def _colour(colour: str) -> str:
    if colour == _PAPER:
        return "var(--panel-background-color, Canvas)"
    return "currentColor" if colour == _INK else f"color-mix(in srgb, {colour} {_SHARE}%, currentColor)"
