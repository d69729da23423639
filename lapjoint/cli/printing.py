"""Printing of answers by the command line, and their content in JSON files."""

from __future__ import annotations

import json
import math
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint import History, Problem, SteadyState
from lapjoint.answers import Modes
from lapjoint.answers.contact_state import state_label
from lapjoint.answers.series import written
from lapjoint.answers.steady_state import Acceptance
from lapjoint.cli.echo import echo
from lapjoint.figures.text import apart, cut_to, error_text, frequency_text, plain
from lapjoint.files.flags import flag_names
from lapjoint.files.writing import write_file
from lapjoint.summaries import summarise
from lapjoint.summaries.blocks import Block, Number, at_stops, steady_blocks
from lapjoint.summaries.fatigue_of_orbit import OF_FATIGUE
from lapjoint.summaries.of_orbit import OF_ALL, OF_STOPS

if TYPE_CHECKING:
    import xarray as xr


COLUMNS = 80
"""Usual width of a terminal, characters."""
_NUMBER = 12
"""Width of a number in a table, characters, with the space before it."""
_TIMES = 2049
"""Number of times at which displacements at stops are computed: for a wave of ten half waves, the largest is exact to
3e-5."""
ROWS_SHOWN = 20
STATES_SHOWN = 32
FAILURES_SHOWN = 5
MULTIPLIERS_SHOWN = 5
NAME_SHOWN, STATE_SHOWN = 24, 48
"""Most characters of the name of a stop, and of a state, in a table; files hold the whole name."""


def print_modes(problem: Problem, solver: str, answers: list[Modes], hz: bool = False) -> None:
    """Print natural frequencies of each contact state, in rad/s or Hz, within the width of a terminal."""
    shown = answers[:STATES_SHOWN]
    labels = apart([state_label(problem, answer.state) for answer in shown], lambda name: cut_to(name, STATE_SHOWN))
    width = max(len(label) for label in labels) + 2
    row = max((COLUMNS - width) // _NUMBER, 1)
    echo(f"Natural {'frequencies [Hz]' if hz else 'angular frequencies [rad/s]'}, {solver}")
    for label, answer in zip(labels, shown, strict=True):
        values = answer.angular_frequencies / (2 * math.pi if hz else 1.0)
        for first in range(0, len(values), row):
            numbers = "".join(f"{value:{_NUMBER}.6g}" for value in values[first : first + row])
            echo(f"{label if first == 0 else '':<{width}}{numbers}")
    if len(answers) > len(shown):
        echo(f"... and {len(answers) - len(shown)} more states (--json writes all, --state prints one)")


def modes_summary(problem: Problem, solver: str, answers: list[Modes]) -> dict[str, Any]:
    """The content of a JSON file of natural angular frequencies."""
    states = [
        {
            "name": answer.state.name(problem),
            "closed": [problem.stop_names[i] for i in answer.state.closed],
            "angular_frequencies": answer.angular_frequencies.tolist(),
            "frequencies_Hz": (answer.angular_frequencies / (2 * math.pi)).tolist(),
        }
        for answer in answers
    ]
    return {"solver": solver, "unit": "rad/s", "states": states}


def print_history(history: History) -> None:
    """Print the first contacts and a summary."""
    problem, contacts = history.problem, history.contacts
    names, width = stop_column(problem)
    echo(plain(problem.title) or "Untitled problem")
    echo(f"{history.solver}, {history.start:g} to {history.end:g} s: {len(contacts)} contacts")
    print_excitation(problem)
    if contacts:
        heading = (
            f"{'start [s]':>15}{'+-':>10}{'duration [s]':>15}{'impulse [N s]':>15}{'+-':>10}{'peak [N]':>13}{'+-':>10}"
        )
        echo(f"\n{'stop':<{width}}{heading}")
    for c in contacts[:ROWS_SHOWN]:
        remark = "  closed at the start" if c.open_start else "  closed at the end" if c.open_end else ""
        start = f"{c.start:15.9f}{error_text(c.start_error):>10}"
        impulse = f"{c.impulse:15.6g}{error_text(c.impulse_error):>10}"
        peak = f"{c.peak_force:13.5g}{error_text(c.peak_force_error):>10}"
        echo(f"{names[c.stop]:<{width}}{start}{c.duration:15.6g}{impulse}{peak}{remark}".rstrip())
    if len(contacts) > ROWS_SHOWN:
        echo(f"... and {len(contacts) - ROWS_SHOWN} more (--contacts writes them all)")
    lost, unsure = history.dissipated(), history.dissipated_errors()
    per = 1 / (history.end - history.start)
    of_power = None if unsure is None else unsure * per
    in_all = float(lost.sum()) * per, None if of_power is None else float(of_power.sum())
    power = "Mean power lost in damped stops [W]"
    for block in (
        at_stops(problem, "Impulse in all [N s], top positive", ("",), [history.impulses()], [None]),
        at_stops(problem, "Energy lost in damped stops [J]", ("",), [lost], [unsure], damped=True),
        at_stops(problem, power, ("",), [lost * per], [of_power], damped=True, in_all=in_all),
    ):
        _print_at_stops(problem, block)
    if contacts:
        print_source(history.error_source)


def print_excitation(problem: Problem) -> None:
    """Print the fundamental of the excitation, if there is one, and remarks on recorded and random parts."""
    omega = problem.excitation_frequency
    if omega is not None:
        echo(f"Excitation: {frequency_text(omega)}")
    for path, part in (problem.records | problem.random).items():
        echo(fill(f"{path}: {part.remark}", COLUMNS))


def print_steady_state(found: SteadyState, at: list[float] | None = None) -> None:
    """Print a steady state and its certificate, with peaks at places, m, or at the default places."""
    echo(plain(found.problem.title) or "Untitled problem")
    echo(f"{found.solver}: {found.outcome.value}")
    print_excitation(found.problem)
    if found.period_multiple:
        multiple = f"{found.period_multiple} excitation period" + "s" * (found.period_multiple > 1)
        mirrored = ", mirrored after half of them" if found.symmetric else ""
        echo(f"Repeats after {multiple}, to {found.residual:.2g} of its size{mirrored}")
    if found.multipliers.size:
        shown = ", ".join(complex_text(complex(value)) for value in found.multipliers[:MULTIPLIERS_SHOWN])
        echo(f"Floquet multipliers: {shown}{' ...' if found.multipliers.size > MULTIPLIERS_SHOWN else ''}")
    if found.exponent is not None:
        rate, error = found.exponent.value, found.exponent.standard_error
        echo(f"Largest Lyapunov exponent: {rate:.4g} 1/s +- {error:.2g}, over {found.exponent.periods} periods")
        if found.exponent.negative:
            echo("Nearby motions come together: it repeats, but after more periods than max_period_multiple")
    if found.acceptance is not None and found.acceptance.sensitive:
        echo(f"Another motion could have been reached: {_sensitivity(found.acceptance)}")
    if found.problem.structure.stops and not found.history.contacts:
        _print_nearest(found.history)
    for block in steady_blocks(found, at):
        if any(row.of for row in block.rows):
            _print_places(found.problem, block)
        elif block.heads == ("",):
            _print_at_stops(found.problem, block)
        else:
            _print_columns(found.problem, block)
    if found.problem.structure.stops or found.impulse_errors is not None:
        print_source(found.error_source)


def _padded(number: Number) -> str:
    """A number of a table with its error."""
    return f"{number.text:>12}" + ("" if number.error is None else f" +- {error_text(number.error):<8}")


def _heads(block: Block) -> str:
    """Heads above numbers with errors."""
    known = any(number is not None and number.error is not None for row in block.rows for number in row.numbers)
    return (" " * 12 * known).join(f"{head:>12}" for head in block.heads)


def _print_places(problem: Problem, block: Block) -> None:
    """Print values at places: the chosen ones, and where a quantity is largest if that is another place."""
    rows = [row for row in block.rows if not (row.asked and row.largest)]
    unit = "" if problem.line.several else " m"
    places, label = [f"{row.where}{unit}{'*' * row.largest}" for row in rows], ""
    width = max(9, *(len(place) + 1 for place in places))
    echo(f"\n{block.title:<{29 + width}}{_heads(block)}")
    for row, place in zip(rows, places, strict=True):
        numbers = "".join(_padded(number) for number in row.numbers if number is not None)
        echo(f"{row.of if row.of != label else '':<29}{place:<{width}}{numbers}".rstrip())
        label = row.of
    if any(row.largest for row in rows):
        echo("* where its magnitude is largest along the beam")


def _print_columns(problem: Problem, block: Block) -> None:
    """Print several numbers of each stop."""
    names, _ = stop_column(problem)
    echo(f"\n{block.title:<38}{_heads(block)}")
    for row in block.rows:
        numbers = "".join(_padded(number) for number in row.numbers if number is not None)
        echo(f"{row.where if row.stop is None else names[row.stop]:<38}{numbers}".rstrip())


def _print_at_stops(problem: Problem, block: Block) -> None:
    """Print one number of each stop, with its place and side, or of all; nothing without rows."""
    if not block.rows:
        return
    names, width = stop_column(problem)
    echo(f"\n{block.title}")
    for row in block.rows:
        name = f"{row.where:<{width + 21}}"
        if row.stop is not None:
            stop = problem.structure.stops[row.stop]
            name = f"{names[row.stop]:<{width}}x = {stop.where:<8} {stop.side:<8}"
        (number,) = row.numbers
        assert number is not None
        echo(f"{name}{number.text:>14}" + ("" if number.error is None else f"  +- {error_text(number.error)}"))


def print_source(source: str) -> None:
    """Print how errors were estimated, or why there are none."""
    echo(f"Numerical errors (+-): {source}")


def _print_nearest(history: History) -> None:
    """Print the stop to which a motion without contact comes nearest, and the largest displacement towards this stop,
    as a percentage of its gap."""
    stops = history.problem.structure.stops
    t = np.linspace(history.start, history.end, _TIMES)
    sides = np.array([stop.sign for stop in stops])[:, None]
    reach = (sides * history.seen_by_stops(t)).max(axis=1)
    gaps = np.array([stop.gap for stop in stops])
    names, _ = stop_column(history.problem)
    if gaps.min() < 0:  # a distance, because nothing can be a percentage of an interference
        nearest = int((gaps - reach).argmin())
        echo(f"Nearest to a stop: {names[nearest]}, at a distance of {(gaps - reach)[nearest]:.3g} m")
        return
    percent = 100 * np.maximum(reach, 0.0) / np.maximum(gaps, np.finfo(float).tiny)
    nearest = int(percent.round(6).argmax())  # the first of stops that differ by rounding alone
    echo(f"Nearest to a stop: {names[nearest]}, {percent[nearest]:.3g} % of its gap of {stops[nearest].gap:g} m")


def _sensitivity(acceptance: Acceptance) -> str:
    """The reason why rounding or a push may have decided which motion was reached."""
    if acceptance.pushes:
        times = "once" if acceptance.pushes == 1 else f"{acceptance.pushes} times"
        return f"the march was pushed off an unstable one {times}"
    return f"on the way a deviation grew by a factor of {acceptance.growth:.1g}"


def complex_text(value: complex) -> str:
    """A complex number in six digits; a real one without its imaginary part."""
    return f"{value.real:.6g}{value.imag:+.6g}i" if value.imag else f"{value.real:.6g}"


def stop_column(problem: Problem) -> tuple[list[str], int]:
    """The names of the stops, long ones shortened, and the width of a column of them with the space after it."""
    names = apart(problem.stop_names, lambda name: cut_to(name, NAME_SHOWN))
    return names, max([8, *(len(name) for name in names)]) + 2


def steady_state_summary(found: SteadyState, at: list[float] | None = None) -> dict[str, Any]:
    """The content of a JSON file of a steady state, with peaks at places, m, or at the default places."""
    accepted = found.acceptance
    return {
        "solver": found.solver,
        "outcome": found.outcome.name.lower(),
        "period_multiple": found.period_multiple,
        "symmetric": found.symmetric,
        "residual": found.residual,
        "multipliers_real": found.multipliers.real.tolist(),
        "multipliers_imag": found.multipliers.imag.tolist(),
        "lyapunov_exponent_per_s": None if found.exponent is None else found.exponent.value,
        "lyapunov_exponent_standard_error_per_s": None if found.exponent is None else found.exponent.standard_error,
        "accepted_after_periods": None if accepted is None else accepted.periods,
        "pushes": None if accepted is None else accepted.pushes,
        "growth": None if accepted is None else accepted.growth,
        "impulses_Ns": dict(zip(found.problem.stop_names, found.impulses.tolist(), strict=True)),
        "impulse_errors_Ns": None
        if found.impulse_errors is None
        else dict(zip(found.problem.stop_names, found.impulse_errors.tolist(), strict=True)),
        "dissipated_J": dict(zip(found.problem.stop_names, found.dissipated.tolist(), strict=True)),
        "dissipated_errors_J": None
        if found.dissipated_errors is None
        else dict(zip(found.problem.stop_names, found.dissipated_errors.tolist(), strict=True)),
        "error_source": found.error_source,
        "summary": summary_of(found, at),
    }


def summary_of(found: SteadyState, at: list[float] | None) -> dict[str, Any]:
    """Peaks, RMS and contacts of a steady state, as part of a JSON file."""
    summary = summarise(found, at=at)
    what, content = summary.selection, dict[str, Any]()
    for one in what.quantities:
        for kind in ("peak", "rms"):
            name = f"{one.name}_{kind}"
            rows = list(dict.fromkeys([*what.asked.tolist(), int(np.argmax(summary.values[name]))]))
            content[name] = {
                "units": written(one.units),
                "x_m": what.x[rows].tolist(),
                "values": summary.values[name][rows].tolist(),
                "errors": None if summary.errors is None else summary.errors[name][rows].tolist(),
            }
    for name, (units, _) in OF_STOPS.items():
        content[name] = {
            "units": written(units),
            "values": dict(zip(found.problem.stop_names, summary.values[name].tolist(), strict=True)),
            "errors": None
            if summary.errors is None
            else dict(zip(found.problem.stop_names, summary.errors[name].tolist(), strict=True)),
        }
    for name, (units, _) in OF_ALL.items():
        errors = None if summary.errors is None else float(summary.errors[name][0])
        content[name] = {"units": written(units), "value": float(summary.values[name][0]), "error": errors}
    if summary.fatigue is not None:
        for name, (units, _) in OF_FATIGUE.items():
            rows = list(dict.fromkeys([*what.asked.tolist(), int(np.argmax(summary.fatigue.values["damage_rate"]))]))
            of = summary.fatigue.errors
            content[name] = {
                "units": written(units),
                "x_m": what.x[rows].tolist(),
                "values": summary.fatigue.values[name][rows].tolist(),
                "errors": None if of is None else of[name][rows].tolist(),
            }
    return content


def write_json(path: str, content: Any) -> None:
    """Write JSON; numbers that are not finite become null."""

    def finite(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: finite(item) for key, item in value.items()}
        if isinstance(value, list):
            return [finite(item) for item in value]
        return None if isinstance(value, float) and not abs(value) < float("inf") else value

    write_file(path, json.dumps(finite(content), indent=2, allow_nan=False) + "\n")


def print_curve(curve: xr.Dataset) -> None:
    """Print the number of points of a sweep with each outcome, and the first messages of failed points."""
    outcome = curve.outcome.values
    names = flag_names(curve.outcome.attrs)
    counts = [(name.replace("_", " "), int((outcome == code).sum())) for code, name in names.items()]
    echo(f"{outcome.size} points: " + ", ".join(f"{count} {name}" for name, count in counts if count))
    messages = [str(text) for text in curve.message.values.flat if text]
    for text in messages[:FAILURES_SHOWN]:
        echo(f"failed: {text}")
    if len(messages) > FAILURES_SHOWN:
        echo(f"... and {len(messages) - FAILURES_SHOWN} more, in the variable message")
