"""How every figure looks: sizes, colours, lines, and files that are the same bytes each time.

The colours are those of Okabe and Ito (2008), which colour-blind readers tell apart; line styles and markers repeat
the distinction.  Text has its final size at any width, so a figure is made as wide as it will be printed.
"""

from __future__ import annotations

import io
import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.errors import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
STYLES = ("-", "--", "-.", ":")
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
FORMATS = (".png", ".svg", ".pdf")
COLUMN_WIDTH, PAGE_WIDTH = 3.4, 7.0  # inches
GREY = "0.55"
THIN = 0.6  # points: gaps, zero lines, reference slopes
_CHARACTERS, _LABELS_WIDE = 18.0, 0.6
"""Characters of small text in an inch, and the width that tick labels take, inches."""

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
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.1,
    "lines.markersize": 3.5,
    "legend.frameon": False,
    "legend.fontsize": 7,
    "legend.title_fontsize": 7,
    "legend.handlelength": 2.0,
    "legend.columnspacing": 1.2,
    "legend.borderaxespad": 0.3,
    "savefig.dpi": 200,
    "svg.fonttype": "none",
    "svg.hashsalt": "lapjoint",
    "pdf.fonttype": 42,
}
"""Matplotlib's settings; the colours and line styles of successive lines come besides."""


@contextmanager
def style() -> Iterator[None]:
    """The style of all figures, while they are made and while they are written; a decorator too."""
    import matplotlib
    from cycler import cycler

    lines = [STYLES[i % len(STYLES)] for i in range(len(COLOURS))]
    settings: dict[Any, Any] = {**STYLE, "axes.prop_cycle": cycler(color=COLOURS, linestyle=lines)}
    with matplotlib.rc_context(settings):
        yield


def new_axes(width: float = PAGE_WIDTH, height: float = 3.2) -> Axes:
    """Axes on a figure of their own, `width` by `height` inches, that belongs to no window."""
    return new_panels(1, 1, width, height)[0]


@style()
def new_panels(rows: int, columns: int, width: float, height: float, **options: Any) -> tuple[Axes, ...]:
    """Axes row by row on a figure of their own, `width` by `height` inches; `options` as for ``Figure.subplots``."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    return tuple(figure.subplots(rows, columns, squeeze=False, **options).flat)


def save(axes: Axes | Sequence[Axes], path: str | Path) -> None:
    """Write the figure that `axes`, one or several, belong to, as PNG, SVG or PDF by the ending of `path`.

    Raises
    ------
    InputError
        If the ending is another one, or the file cannot be written.
    """
    ending = Path(path).suffix.lower()
    if ending not in FORMATS:
        raise InputError(f"{path}: figures are written as {', '.join(FORMATS)}, not {ending or 'without an ending'}")
    try:
        _write(axes, path, ending[1:])
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror or error}") from None


def svg_of(axes: Axes | Sequence[Axes]) -> str:
    """The figure that `axes` belong to as an SVG element on a transparent ground, for a page of HTML."""
    out = io.StringIO()
    _write(axes, out, "svg", transparent=True)
    svg = out.getvalue()
    return svg[svg.index("<svg") :]


@style()
def _write(axes: Axes | Sequence[Axes], target: str | Path | io.StringIO, form: str, **options: Any) -> None:
    """The file without the date, so that equal figures are equal files."""
    dates = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    figure_of(axes).savefig(target, format=form, metadata=dates.get(form), **options)


def each_axes(axes: Axes | Sequence[Axes]) -> tuple[Axes, ...]:
    """One Axes, a sequence of them, or an array of them of any shape, row by row."""
    return tuple(np.ravel(np.asarray(axes, dtype=object)))


def figure_of(axes: Axes | Sequence[Axes]) -> Figure:
    """The figure that `axes`, one or several, belong to."""
    from matplotlib.figure import Figure

    figure: Any = each_axes(axes)[0].figure
    while not isinstance(figure, Figure):
        figure = figure.figure  # a subfigure's
    return figure


def entitle(axes: Axes, title: str = "") -> None:
    """What is drawn, and the key to its lines below, both above the axes, where no curve can be."""
    figure = figure_of(axes)
    width = axes.get_position().width / (figure.subplotpars.right - figure.subplotpars.left) * figure.get_figwidth()
    letters = max(20, int((width - _LABELS_WIDE) * _CHARACTERS))
    text = "\n".join(line for part in title.splitlines() for line in textwrap.wrap(part, letters))
    handles, labels = axes.get_legend_handles_labels()
    if not labels:
        axes.set_title(text, fontsize=STYLE["legend.title_fontsize"])
        return
    axes.legend(
        handles,
        labels,
        title=text or None,
        alignment="left",
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=_columns([len(label) + 6 for label in labels], letters),
    )


def _columns(lengths: list[int], room: int) -> int:
    """The columns of the fewest rows in which entries of these lengths, filled column by column, fit side by side."""
    for rows in range(1, len(lengths)):
        columns = -(-len(lengths) // rows)
        most, longer = divmod(len(lengths), columns)  # the first columns have one row more
        ends = [(i + 1) * most + min(i + 1, longer) for i in range(columns)]
        if sum(max(lengths[start:end]) for start, end in zip([0, *ends], ends, strict=False)) <= room:
            return columns
    return 1


def faint_if_thin(colour: str, alpha: float = 1.0) -> dict[str, Any]:
    """How bars are filled: those thinner than a pixel are faint, neither lost nor as broad as one."""
    return {"facecolor": (colour, alpha), "edgecolor": (colour, 0.25 * alpha), "linewidth": 0.15, "snap": False}


def draw_time(axes: Axes, start: float, end: float, label: str = "time t [s]") -> None:
    """The axis of time from `start` to `end`, s, with few enough ticks for a column."""
    axes.set_xlim(start, end)
    axes.set_xlabel(label)
    axes.locator_params(axis="x", nbins=6)
