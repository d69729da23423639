"""How every figure looks: sizes, colours, lines, and files that are the same bytes each time.

The colours are those of Okabe and Ito (2008), which colour-blind readers tell apart; line styles and markers repeat
the distinction.  Text has its final size at any width, so a figure is made as wide as it will be printed.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.errors import InputError
from lapjoint.figures.legend import BETWEEN, HANDLE, LINE, key_that_fits
from lapjoint.figures.text import SMALL, boxes_for_unknown_signs, literal, wrapped
from lapjoint.output_files import completed, unwritable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
STYLES = ("-", "--", "-.", ":")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<")
"""Filled, so that they can be hollow.  The number of colours has no divisor in common with that of styles, nor with
that of markers, so that a pair returns only when all pairs have been drawn."""
FORMATS = (".png", ".svg", ".pdf")
COLUMN_WIDTH, PAGE_WIDTH = 3.4, 7.0  # inches
GREY = "0.55"
THIN = 0.6  # points: gaps, zero lines, reference slopes
_LABELS_WIDE = 0.65
"""Width that the labels left of axes take, inches."""
_KEY_SHARE = 0.45
"""Of the height of axes and key together: the most that the key takes."""

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
"""Matplotlib's settings; the colours and line styles of successive lines come besides."""


@contextmanager
def style() -> Iterator[None]:
    """The style of all figures, while they are made and while they are written; a decorator too."""
    import matplotlib
    from cycler import cycler

    lines = [STYLES[i % len(STYLES)] for i in range(len(COLOURS) * len(STYLES))]
    settings: dict[Any, Any] = {**STYLE, "axes.prop_cycle": cycler(color=COLOURS * len(STYLES), linestyle=lines)}
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

    The file takes its name when it is complete; until then one of that name stays as it is.

    Raises
    ------
    InputError
        If the ending is another one, or no file can be written there.
    OutputError
        If the file cannot be completed, as on a full disk.
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
    """The figure that `axes` belong to as an SVG element on a transparent ground, for a page of HTML."""
    out = io.StringIO()
    _write(axes, out, "svg", transparent=True)
    svg = out.getvalue()
    return svg[svg.index("<svg") :]


@style()
def _write(axes: Axes | Sequence[Axes], target: str | Path | io.StringIO, form: str, **options: Any) -> None:
    """The file without the date, so that equal figures are equal files."""
    dates = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with boxes_for_unknown_signs():
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


def entitle(axes: Axes, title: str = "", beside: float = _LABELS_WIDE) -> None:
    """What is drawn, and the key to its lines below, both above the axes, where no curve can be.

    Title and labels are drawn as they are, no part of them as mathematics; see `lapjoint.figures.text`.  The labels
    beside the axes are `beside` inches wide.
    """
    room = max(1.0, room_of(axes) - beside)
    lines = [literal(line) for line in wrapped(title, room)]
    handles, labels = axes.get_legend_handles_labels()
    if not labels:
        axes.set_title("\n".join(lines), fontsize=SMALL)
        return
    handles, labels, columns = key_that_fits(handles, labels, room, _lines_high(axes) - len(lines))
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
    """Width of the part of the figure that the axes have for themselves and what is beside them, inches."""
    figure = figure_of(axes)
    share = axes.get_position().width / (figure.subplotpars.right - figure.subplotpars.left)
    return float(share * figure.get_figwidth())


def _lines_high(axes: Axes) -> int:
    """Lines of a key and its title together."""
    figure = figure_of(axes)
    share = axes.get_position().height / (figure.subplotpars.top - figure.subplotpars.bottom)
    return int(_KEY_SHARE * share * figure.get_figheight() / LINE)


def faint_if_thin(colour: str, alpha: float = 1.0) -> dict[str, Any]:
    """How bars are filled: those thinner than a pixel are faint, neither lost nor as broad as one."""
    return {"facecolor": (colour, alpha), "edgecolor": (colour, 0.25 * alpha), "linewidth": 0.15, "snap": False}


def draw_time(axes: Axes, start: float, end: float, label: str = "time t [s]") -> None:
    """The axis of time from `start` to `end`, s, with few enough ticks for a column."""
    axes.set_xlim(start, end)
    axes.set_xlabel(label)
    axes.locator_params(axis="x", nbins=6)
