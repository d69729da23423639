"""The style of all figures: sizes, colours and lines, and files that are reproducible byte for byte.

The colours are from Okabe and Ito (2008): colour-blind readers can tell them apart.  Line styles and markers repeat the
distinction.  Text has its printed size at any width of a figure, so a figure is made as wide as it will be printed.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.errors import InputError
from lapjoint.figures.legend import BETWEEN, HANDLE, LINE, legend_that_fits
from lapjoint.figures.text import SMALL, boxes_for_unknown_signs, literal, wrapped
from lapjoint.files.writing import completed, unwritable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
STYLES = ("-", "--", "-.", ":")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<")
"""Markers with an area, so that they can be hollow.  The number of colours is coprime to the numbers of line styles and
of markers, so that a pair is repeated only after all pairs were used."""
FORMATS = (".png", ".svg", ".pdf")
COLUMN_WIDTH, PAGE_WIDTH = 3.4, 7.0
"""Widths of a figure, inches: one column, and both columns of a printed page."""
GREY = "0.55"
THIN = 0.6
"""Line width of gaps, zero lines and reference slopes, points."""
_LABELS_WIDE = 0.65
"""Width reserved for the labels on the left of the axes, inches."""
_LEGEND_SHARE = 0.45
"""Largest height of a legend, divided by the height of axes and legend together."""

STYLE: dict[str, Any] = {
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.titlelocation": "left",
    "axes.labelsize": 8,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "0.8",
    "grid.linewidth": 0.4,
    "grid.alpha": 0.6,
    "xtick.labelsize": SMALL,
    "ytick.labelsize": SMALL,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.1,
    "lines.markersize": 3.5,
    "legend.frameon": False,
    "legend.fontsize": SMALL,
    "legend.title_fontsize": SMALL,
    "legend.handlelength": HANDLE,
    "legend.columnspacing": BETWEEN,
    "legend.borderaxespad": 0.3,
    "savefig.dpi": 200,
    "svg.fonttype": "none",
    "svg.hashsalt": "lapjoint",
    "pdf.fonttype": 42,
}
"""Matplotlib's settings, except for the colours and styles of successive lines, which `style` adds."""


@contextmanager
def style() -> Iterator[None]:
    """A context manager, and decorator, in which figures have this style."""
    import matplotlib
    from cycler import cycler

    lines = [STYLES[i % len(STYLES)] for i in range(len(COLOURS) * len(STYLES))]
    settings: dict[Any, Any] = {**STYLE, "axes.prop_cycle": cycler(color=COLOURS * len(STYLES), linestyle=lines)}
    with matplotlib.rc_context(settings):
        yield


def new_axes(width: float = PAGE_WIDTH, height: float = 3.2) -> Axes:
    """Axes on a new figure, without a window.

    Parameters
    ----------
    width : float
        Width of the figure, inches.
    height : float
        Height of the figure, inches.

    Returns
    -------
    matplotlib.axes.Axes
        The only axes of the figure.
    """
    return new_panels(1, 1, width, height)[0]


@style()
def new_panels(rows: int, columns: int, width: float, height: float, **options: Any) -> tuple[Axes, ...]:
    """Several axes on a new figure, without a window.

    Parameters
    ----------
    rows : int
        Number of rows of axes.
    columns : int
        Number of columns of axes.
    width : float
        Width of the figure, inches.
    height : float
        Height of the figure, inches.
    **options : Any
        Further options of ``matplotlib.figure.Figure.subplots``.

    Returns
    -------
    tuple of matplotlib.axes.Axes
        The axes, row by row.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    return tuple(figure.subplots(rows, columns, squeeze=False, **options).flat)


def save(axes: Axes | Sequence[Axes], path: str | Path) -> None:
    """Write a figure as PNG, SVG or PDF, by the ending of `path`.

    The file gets its name when it is complete.  An older file of this name remains unchanged until then.

    Parameters
    ----------
    axes : matplotlib.axes.Axes or sequence of them
        Any axes of the figure.
    path : str or Path
        The file, which ends in ``.png``, ``.svg`` or ``.pdf``.

    Raises
    ------
    InputError
        If the path has another ending.
    OutputError
        If the file cannot be written or completed, for example on a full disk.
    """
    ending = Path(path).suffix.lower()
    if ending not in FORMATS:
        raise InputError(f"{path}: figures are written as {', '.join(FORMATS)}, not {ending or 'without an ending'}")
    try:
        with completed(path) as unfinished:
            _write(axes, unfinished, ending[1:])
    except OSError as error:
        raise unwritable(path, error) from None


def svg_of(axes: Axes | Sequence[Axes]) -> str:
    """A figure as an SVG element on a transparent ground, from ``<svg`` on, for a page of HTML."""
    out = io.StringIO()
    _write(axes, out, "svg", transparent=True)
    svg = out.getvalue()
    return svg[svg.index("<svg") :]


@style()
def _write(axes: Axes | Sequence[Axes], target: str | Path | io.StringIO, form: str, **options: Any) -> None:
    """Write the file without a date, so that equal figures give equal files."""
    dates = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with boxes_for_unknown_signs():
        figure_of(axes).savefig(target, format=form, metadata=dates.get(form), **options)


def each_axes(axes: Axes | Sequence[Axes]) -> tuple[Axes, ...]:
    """The axes of a single one, a sequence, or an array of axes, row by row."""
    return tuple(np.ravel(np.asarray(axes, dtype=object)))


def figure_of(axes: Axes | Sequence[Axes]) -> Figure:
    """The figure to which axes belong, also if the axes are in a subfigure."""
    from matplotlib.figure import Figure

    figure: Any = each_axes(axes)[0].figure
    while not isinstance(figure, Figure):
        figure = figure.figure  # a subfigure's
    return figure


def entitle(axes: Axes, title: str = "", beside: float = _LABELS_WIDE) -> None:
    """Put a title and, below it, the legend above the axes, where they cover no curve; call this after all lines are
    drawn.

    Title and labels are drawn literally, see `lapjoint.figures.text`; long lines are wrapped.  `beside` is the width of
    the labels beside the axes, inches.
    """
    room = max(1.0, room_of(axes) - beside)
    lines = [literal(line) for line in wrapped(title, room)]
    handles, labels = axes.get_legend_handles_labels()
    if not labels:
        axes.set_title("\n".join(lines), fontsize=SMALL)
        return
    handles, labels, columns = legend_that_fits(handles, labels, room, _lines_high(axes) - len(lines))
    axes.legend(
        handles,
        labels,
        title="\n".join(lines) or None,
        alignment="left",
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=columns,
    )


def room_of(axes: Axes) -> float:
    """The width, inches, of the part of the figure that belongs to the axes and to the labels beside them."""
    figure = figure_of(axes)
    share = axes.get_position().width / (figure.subplotpars.right - figure.subplotpars.left)
    return float(share * figure.get_figwidth())


def _lines_high(axes: Axes) -> int:
    """Largest number of lines of a legend and its title together."""
    figure = figure_of(axes)
    share = axes.get_position().height / (figure.subplotpars.top - figure.subplotpars.bottom)
    return int(_LEGEND_SHARE * share * figure.get_figheight() / LINE)


def faint_if_thin(colour: str, alpha: float = 1.0) -> dict[str, Any]:
    """Settings of bars with faint edges, so that a bar thinner than a pixel is visible, but not drawn too broad."""
    return {"facecolor": (colour, alpha), "edgecolor": (colour, 0.25 * alpha), "linewidth": 0.15, "snap": False}


def draw_time(axes: Axes, start: float, end: float, label: str = "time t [s]") -> None:
    """Let the horizontal axis show time from `start` to `end`, s, with ticks that fit a column."""
    axes.set_xlim(start, end)
    axes.set_xlabel(label)
    axes.locator_params(axis="x", nbins=6)
