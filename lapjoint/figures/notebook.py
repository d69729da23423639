"""The display of answers in notebooks: a table and a small figure, as one piece of HTML."""

from __future__ import annotations

import base64
import html
import math
from collections.abc import Iterable, Sequence
from functools import singledispatch

import numpy as np
from matplotlib.axes import Axes

from lapjoint.answers.equilibrium import Equilibrium
from lapjoint.answers.history import History
from lapjoint.answers.modes import Modes
from lapjoint.answers.steady_state import SteadyState
from lapjoint.figures.motion import plot_motion
from lapjoint.figures.style import new_axes, svg_of
from lapjoint.figures.text import error_text, frequency_text

CONTACTS_SHOWN, MODES_SHOWN = 8, 12
"""Largest numbers of rows in the tables of contacts and of modes, so that an answer fits on a screen."""
_SIZE = 5.6, 2.4  # inches
_SAMPLES = 800
_MIDDLE = ' style="text-align: left"'


@singledispatch
def html_of(answer: object) -> str:
    """An answer as one piece of HTML; `TypeError` for an object that is no answer."""
    raise TypeError(f"{type(answer).__name__} is no answer")


@html_of.register
def _of_modes(modes: Modes) -> str:
    """Natural frequencies as a table."""
    closed = ", ".join(str(i + 1) for i in modes.state.closed)
    title = f"Modes with stop {closed} closed" if closed else "Modes with all stops open"
    shown = modes.angular_frequencies[:MODES_SHOWN]
    rows = [(str(i), f"{w:.6g}", f"{w / (2 * math.pi):.6g}") for i, w in enumerate(shown, start=1)]
    left_out = modes.angular_frequencies.size - shown.size
    return _page(title, [], _table(("mode", "rad/s", "Hz"), rows, left_out))


@html_of.register
def _of_history(history: History) -> str:
    """A motion: its contacts as a table, and displacements over time."""
    lines = [
        f"{history.solver}, {history.start:g} to {history.end:g} s: {len(history.contacts)} contacts",
    ]
    damped = any(stop.damping > 0 for stop in history.problem.stops)
    rows = [
        (
            history.problem.stop_names[c.stop],
            f"{c.start:.6g}",
            f"{c.duration:.4g}",
            _with_error(c.impulse, c.impulse_error),
            _with_error(c.peak_force, c.peak_force_error),
            *([_with_error(c.dissipated, c.dissipated_error)] if damped else []),
        )
        for c in history.contacts[:CONTACTS_SHOWN]
    ]
    heads = ["stop", "start [s]", "duration [s]", "impulse [N s]", "peak [N]", *(["lost [J]"] if damped else [])]
    table = _table(heads, rows, len(history.contacts) - len(rows)) if rows else ""
    return _page(history.problem.title or "Untitled problem", lines, table + _picture(history))


@html_of.register
def _of_steady_state(steady: SteadyState) -> str:
    """A steady state: its outcome, the impulses of the stops as a table, and one period."""
    lines = [f"{steady.solver}: {steady.outcome.value}"]
    omega = steady.problem.excitation_frequency
    if omega is not None:
        lines.append(f"Excitation: {frequency_text(omega)}")
    if steady.period_multiple:
        lines.append(
            f"It repeats after {steady.period_multiple} excitation period{'s' * (steady.period_multiple > 1)}"
            + (", mirrored half-way." if steady.symmetric else ".")
        )
    if steady.multipliers.size:
        lines.append(f"Largest modulus of a Floquet multiplier: {np.abs(steady.multipliers).max():.4g}")
    errors = [None] * steady.impulses.size if steady.impulse_errors is None else steady.impulse_errors.tolist()
    rows = [
        [name, stop.where, stop.side, _with_error(float(impulse), error)]
        for name, stop, impulse, error in zip(
            steady.problem.stop_names, steady.problem.structure.stops, steady.impulses, errors, strict=True
        )
    ]
    heads = ["stop", "x [m]", "side", "impulse a period [N s]"]
    if any(stop.damping > 0 for stop in steady.problem.stops):
        lost, unsure = steady.dissipated, steady.dissipated_errors
        heads.append("energy lost a period [J]")
        for i, row in enumerate(rows):
            row.append(_with_error(float(lost[i]), None if unsure is None else float(unsure[i])))
    table = _table(heads, rows, 0) if rows else ""
    return _page(steady.problem.title or "Untitled problem", lines, table + _picture(steady.history))


@html_of.register
def _of_equilibrium(found: Equilibrium) -> str:
    """A static equilibrium: the forces of the stops as a table, and the deflected shape."""
    problem, line = found.problem, found.problem.line
    lines = [found.solver, *([found.other_equilibria] if found.other_equilibria else [])]
    for name, tip in zip(line.names, found.tips, strict=True):
        lines.append(f"Displacement of the tip{f' of {name}' if name else ''}: {_with_error(tip.value, tip.error)} m")
    rows = [
        (name, stop.where, stop.side, _with_error(float(force), float(error)))
        for name, stop, force, error in zip(
            problem.stop_names, problem.structure.stops, found.contact_forces, found.errors.contact_forces, strict=True
        )
    ]
    table = _table(("stop", "x [m]", "side", "force [N]"), rows, 0) if rows else ""
    axes = new_axes(*_SIZE)
    for i, (name, start, end) in enumerate(zip(line.names, line.starts, line.ends, strict=True)):
        x, origin = np.linspace(start, end, _SAMPLES), problem.beams[i].origin if line.several else 0.0
        axes.plot(x - start + origin, found.displacement(x), label=name or None)
    axes.set(xlabel="x [m]", ylabel="z [m]")
    if line.several:
        axes.legend()
    return _page(problem.title or "Untitled problem", lines, table + _image(axes, "Displacement along the beam"))


def _with_error(value: float, error: float | None) -> str:
    return f"{value:.6g}" if error is None else f"{value:.6g} ± {error_text(error)}"


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]], left_out: int) -> str:
    """A table in HTML, with the number of rows that are left out."""
    head = "".join(f"<th{_MIDDLE}>{html.escape(text)}</th>" for text in heads)
    body = "".join("<tr>" + "".join(f"<td{_MIDDLE}>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    more = f"<p>... and {left_out} more</p>" if left_out > 0 else ""
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{more}"


def _picture(history: History) -> str:
    """Displacements over time as an image, on white, so that it is legible on a dark page, too."""
    axes = plot_motion(history, new_axes(*_SIZE), samples=_SAMPLES)
    return _image(axes, "Displacement over time, with the gaps and the contacts of the stops")


def _image(axes: Axes, text: str) -> str:
    """A picture on white, with a text for those who do not see it."""
    data = base64.b64encode(svg_of(axes).encode()).decode()
    return f'<img alt="{text}" style="background: white; max-width: 100%" src="data:image/svg+xml;base64,{data}">'


def _page(title: str, lines: Sequence[str], rest: str) -> str:
    said = "".join(f"<br>{html.escape(line)}" for line in lines)
    return f"<div><p><strong>{html.escape(title)}</strong>{said}</p>{rest}</div>"
