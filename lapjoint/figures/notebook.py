"""The display of answers in notebooks: a table and a small figure, as one piece of HTML."""

from __future__ import annotations

import base64
import html
from collections.abc import Sequence
from functools import singledispatch

import numpy as np
from matplotlib.axes import Axes

from lapjoint.answers.equilibrium import Equilibrium
from lapjoint.answers.history import History
from lapjoint.answers.steady_state import SteadyState
from lapjoint.figures.motion import plot_motion
from lapjoint.figures.style import new_axes, svg_of
from lapjoint.figures.tables import table_of

_SIZE = 5.6, 2.4  # inches
_SAMPLES = 800
_MIDDLE = ' style="text-align: left"'


def html_of(answer: object) -> str:
    """An answer as one piece of HTML; `TypeError` for an object that is no answer."""
    table = table_of(answer)
    said = "".join(f"<br>{html.escape(line.replace(' +- ', ' ± '))}" for line in table.lines)
    rows = _table(table.heads, table.rows("±"), table.count) if table.count else ""
    return f"<div><p><strong>{html.escape(table.title)}</strong>{said}</p>{rows}{picture_of(answer)}</div>"


@singledispatch
def picture_of(answer: object) -> str:
    """A picture of an answer as an image in HTML; empty for an answer that has none."""
    return ""


@picture_of.register
def _of_history(history: History) -> str:
    """Displacements over time."""
    axes = plot_motion(history, new_axes(*_SIZE), samples=_SAMPLES)
    return _image(axes, "Displacement over time, with the gaps and the contacts of the stops")


@picture_of.register
def _of_steady_state(steady: SteadyState) -> str:
    """One period."""
    return _of_history(steady.history)


@picture_of.register
def _of_equilibrium(found: Equilibrium) -> str:
    """The deflected shape."""
    problem, line = found.problem, found.problem.line
    axes = new_axes(*_SIZE)
    for i, (name, start, end) in enumerate(zip(line.names, line.starts, line.ends, strict=True)):
        x, origin = np.linspace(start, end, _SAMPLES), problem.beams[i].origin if line.several else 0.0
        axes.plot(x - start + origin, found.displacement(x), label=name or None)
    axes.set(xlabel="x [m]", ylabel="z [m]")
    if line.several:
        axes.legend()
    return _image(axes, "Displacement along the beam")


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]], count: int) -> str:
    """A table in HTML, with the number of rows that are left out of a count."""
    head = "".join(f"<th{_MIDDLE}>{html.escape(text)}</th>" for text in heads)
    body = "".join("<tr>" + "".join(f"<td{_MIDDLE}>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    more = f"<p>... and {count - len(rows)} more</p>" if count > len(rows) else ""
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{more}"


def _image(axes: Axes, text: str) -> str:
    """A picture on white, with a text for those who do not see it."""
    data = base64.b64encode(svg_of(axes).encode()).decode()
    return f'<img alt="{text}" style="background: white; max-width: 100%" src="data:image/svg+xml;base64,{data}">'
