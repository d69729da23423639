"""Figures for the report: SVG that stands in the page itself, in the style of `lapjoint.figures`."""

from __future__ import annotations

import html
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from lapjoint.figures.style import COLOURS as PALETTE
from lapjoint.figures.style import COLUMN_WIDTH, PAGE_WIDTH, new_axes, style, svg_of
from validation.case import Drawing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = {"analytic": PALETTE[0], "fe": PALETTE[1], "paper": "#666666", "third": PALETTE[2]}
"""Colours by the origin of a number."""


NARROW_HEIGHT = 3.0
"""Height of a figure for narrow screens, inches."""


def draw(title: str, paint: Callable[[Axes], object], *, width: float = PAGE_WIDTH, height: float = 3.4) -> Drawing:
    """A figure of one Axes that `paint` fills, width by height in inches, as SVG, and another for narrow screens, a
    column wide; `title` names it for readers who do not see it."""

    def painted(width: float, height: float) -> Axes:
        axes = new_axes(width, height)
        with style():
            paint(axes)
        return axes

    narrow = painted(COLUMN_WIDTH, NARROW_HEIGHT) if width > COLUMN_WIDTH else None
    return drawing(title, painted(width, height), narrow)


def drawing(title: str, axes: Axes | Sequence[Axes], narrow: Axes | Sequence[Axes] | None = None) -> Drawing:
    """The figure of these axes, one or several; and the figure of others for narrow screens."""
    return Drawing(title, _named(title, axes), "" if narrow is None else _named(title, narrow))


def _named(title: str, axes: Axes | Sequence[Axes]) -> str:
    return svg_of(axes).replace("<svg ", f'<svg role="img" aria-label="{html.escape(title)}" ', 1)
