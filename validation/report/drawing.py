"""Figures for the report: SVG that stands in the page itself, in the style of `lapjoint.figures`."""

from __future__ import annotations

import html
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from lapjoint.figures.style import COLOURS as PALETTE
from lapjoint.figures.style import PAGE_WIDTH, new_axes, style, svg_of
from validation.case import Drawing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = {"analytic": PALETTE[0], "fe": PALETTE[1], "paper": "#666666", "third": PALETTE[2]}
"""Colours by the origin of a number."""


def draw(title: str, paint: Callable[[Axes], object], *, width: float = PAGE_WIDTH, height: float = 3.4) -> Drawing:
    """A figure of one Axes that `paint` fills, width by height in inches, as SVG; `title` names it for readers who do
    not see it."""
    axes = new_axes(width, height)
    with style():
        paint(axes)
    return drawing(title, axes)


def drawing(title: str, axes: Axes | Sequence[Axes]) -> Drawing:
    """The figure of these axes, one or several."""
    return Drawing(title, svg_of(axes).replace("<svg ", f'<svg role="img" aria-label="{html.escape(title)}" ', 1))
