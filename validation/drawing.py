"""Figures for the report: matplotlib without pyplot, as SVG that stands in the page itself."""

from __future__ import annotations

import html
import io
import re
from collections.abc import Callable
from typing import TYPE_CHECKING

from validation.case import Drawing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = {"analytic": "#0072B2", "fe": "#D55E00", "paper": "#666666", "third": "#009E73"}
"""Okabe and Ito's palette, told apart by colour-blind readers."""


def draw(title: str, paint: Callable[[Axes], None], *, width: float = 7.0, height: float = 3.4) -> Drawing:
    """A figure of one Axes that `paint` fills."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(
        {"svg.fonttype": "none", "svg.hashsalt": title, "font.size": 9, "axes.grid": True, "grid.alpha": 0.25}
    ):
        figure = Figure(figsize=(width, height), layout="constrained")
        axes = figure.add_subplot()
        axes.spines[["top", "right"]].set_visible(False)
        paint(axes)
        out = io.StringIO()
        figure.savefig(out, format="svg", transparent=True, metadata={"Date": None})
    svg = out.getvalue()
    svg = svg[svg.index("<svg") :]
    # Ids are per figure; in one page they must not meet.
    tag = re.sub(r"\W+", "-", title.lower())
    svg = re.sub(r'id="([^"]+)"', rf'id="{tag}-\1"', svg)
    svg = re.sub(r'(href="#|url\(#)([^")]+)', rf"\1{tag}-\2", svg)
    return Drawing(title, svg.replace("<svg ", f'<svg role="img" aria-label="{html.escape(title)}" ', 1))
