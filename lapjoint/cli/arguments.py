"""The meaning of arguments: the problem, the solver, axes, contact states, places, and files to write."""

from __future__ import annotations

import math
import os
from collections.abc import Collection, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from lapjoint import ContactState, Problem, contact_states, paper_state_number
from lapjoint.answers.contact_state import can_be_closed, is_paper_joint
from lapjoint.answers.series import check_series
from lapjoint.campaigns.grid import FREQUENCY, MOST_POINTS, Axis
from lapjoint.cli.echo import echo
from lapjoint.cli.options import DRAWINGS, FIGURES, AnswerFiles, SolverChoice, large_allowed
from lapjoint.errors import InputError, OutputError
from lapjoint.problem import files
from lapjoint.problem.override import override
from lapjoint.problem.places import place_of
from lapjoint.problem.presets import PRESETS
from lapjoint.scene.frame_times import check_frames
from lapjoint.solver import Solver

MOST_STOPS = 100
"""Largest number of stops without --large: a problem with more stops takes minutes."""
STOPS_NAMED = 20
"""Largest number of stops that a message names."""


def problem_from(source: str, overrides: tuple[str, ...] = ()) -> Problem:
    """The problem in a TOML file or a preset, with the changes by ``--set``."""
    kind, colon, name = source.partition(":")
    if kind == "preset" and colon:
        if name not in PRESETS:
            raise InputError(f"preset:{name}: there is no such preset; allowed: {', '.join(PRESETS)}")
        preset = PRESETS[name]()
        if not overrides:
            return preset
        tables = files.problem_tables(preset)
    else:
        tables = files.read_tables(source)
    for assignment in overrides:
        override(tables, assignment)
    stops = tables.get("stops")
    if isinstance(stops, list) and len(stops) > MOST_STOPS and not large_allowed():
        limit = f"more than {MOST_STOPS} are taken only with --large, for the work grows with their number"
        raise InputError(f"{source}: stops: there are {len(stops)}; {limit}")
    found = files.problem_from_tables(tables, source, "." if kind == "preset" and colon else Path(source).parent)
    for hint in found.hints:
        echo(f"lapjoint: hint: {hint}", err=True)
    return found


def named_solver(text: str) -> Solver:
    """The solver that a text names: NAME, or NAME:KEY=VALUE,KEY=VALUE with its numerical options."""
    name, colon, options = text.partition(":")
    return SolverChoice(name, options=tuple(options.split(",")) if colon else ()).make()


def other_name(text: str, taken: Collection[str]) -> str:
    """A short name for the solver that `text` names, different from the names already `taken`."""
    name = text.partition(":")[0]
    return name if name not in taken else f"{name}-2"


def axes_from(
    first: float | None,
    last: float | None,
    step: float,
    fields: tuple[str, ...],
    hz: bool = False,
    *,
    needed: bool = True,
) -> tuple[Axis, ...]:
    """The axes of a sweep: the excitation frequency if it is given, in rad/s or Hz, then the other fields in order; at
    least one if one is `needed`."""
    if (first is None) != (last is None):
        raise InputError(f"--{'to' if last is None else 'from'}: is missing; give both --from and --to, or neither")
    if first is None and not fields and needed:
        raise InputError("sweep: nothing is swept; give --from and --to, or --over")
    axes = [axis_from(field) for field in fields]
    if first is None or last is None:
        return tuple(axes)
    return (Axis(FREQUENCY, frequencies(first, last, step, hz)), *axes)


def in_hz(path: str) -> str:
    """The path of an angular frequency as that of the frequency in Hz."""
    if not path.endswith("angular_frequency"):
        raise InputError(f"--hz: --over {path} is no angular_frequency; leave it out")
    return path.removesuffix("angular_frequency") + "frequency"


def is_in_hz(path: str | None) -> bool:
    """Whether a path leads to a frequency in Hz."""
    return path is not None and path.rpartition(".")[2] == "frequency"


def frequencies(first: float, last: float, step: float, hz: bool = False) -> tuple[float, ...]:
    """Angular frequencies, rad/s, from `first` to at most `last` in steps of `step`, all given in rad/s or, with `hz`,
    in Hz."""
    unit, radians = ("Hz", 2 * math.pi) if hz else ("rad/s", 1.0)
    for option, value in (("--from", first), ("--to", last), ("--step", step)):
        if not 0 < value < float("inf"):
            raise InputError(f"{option} {value:g}: must be positive and finite, in {unit}")
    if last < first:
        raise InputError(f"--to {last:g}: must be at least --from, {first:g} {unit}")
    steps = (last - first) / step * (1 + 1e-12) + 1e-9
    if steps >= MOST_POINTS:
        raise InputError(f"--step {step:g}: makes {steps:.3g} points; at most {MOST_POINTS} are allowed")
    return tuple((first + i * step) * radians for i in range(int(steps) + 1))


def axis_from(text: str, option: str = "--over") -> Axis:
    """An axis from ``PATH=FROM:TO:COUNT`` or ``PATH=a,b,c``."""
    path, equals, values = text.partition("=")
    if not equals or not path.strip():
        raise InputError(f"{option} {text}: must be PATH=FROM:TO:COUNT or PATH=a,b,c, as in stops.*.gap=1e-3:3e-3:5")
    try:
        if ":" not in values:
            return Axis(path, tuple(float(value) for value in values.split(",")))
        low, high, number = values.split(":")
        first, last, count = float(low), float(high), int(number)
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{option} {text}: must be FROM:TO:COUNT or numbers with commas between them") from None
    if not 1 <= count <= MOST_POINTS or not math.isfinite(last - first):
        raise InputError(f"{option} {text}: must have finite ends, and a count from 1 to {MOST_POINTS}")
    return Axis(path, tuple(np.linspace(first, last, count).tolist()))


def states_from(problem: Problem, text: str) -> tuple[ContactState, ...]:
    """The contact states of a text: ``all``, ``free``, a number of the paper's, or names of closed stops joined by
    ``+``."""
    if text == "all":
        return contact_states(problem)
    readings = [()] if text == "free" else _closed_stops(text, problem.stop_names)
    if len(readings) > 1:
        quoted = " or ".join("+".join(f'"{problem.stop_names[i]}"' for i in stops) for stops in readings[:2])
        raise InputError(f"--state {text}: can be read in several ways; put each name in quotes, as in {quoted}")
    if readings:
        state = ContactState(readings[0])
        if not can_be_closed(problem, state):
            raise InputError(f"--state {text}: these stops cannot be closed while the others are open")
        return (state,)
    if is_paper_joint(problem):
        found = [state for state in contact_states(problem) if str(paper_state_number(problem, state)) == text]
        if found:
            return (found[0],)
    numbered = ", 1 to 9" if is_paper_joint(problem) else ""
    names = ", ".join(problem.stop_names[:STOPS_NAMED]) + ", ..." * (len(problem.stops) > STOPS_NAMED)
    allowed = f"all, free{numbered}, or stops joined by +, of {names or 'none'}"
    raise InputError(f"--state {text}: there is no such state; allowed: {allowed}")


def _closed_stops(text: str, names: Sequence[str]) -> list[tuple[int, ...]]:
    """Up to two readings of a text as names of stops joined by ``+``, as indices of stops.

    A name may itself contain ``+``; a name in quotes is the name of one stop.  Different spellings of one set of stops
    are one reading.
    """
    number = dict(zip((name.strip() for name in names), range(len(names)), strict=True))
    longest = 1 + max((name.count("+") for name in names), default=0)
    parts = text.split("+")
    ways: list[dict[frozenset[int], None]] = [{frozenset(): None}, *({} for _ in parts)]
    for end in range(1, len(parts) + 1):
        for begin in range(max(0, end - longest), end):
            name = "+".join(parts[begin:end]).strip()
            unquoted = name[1:-1].strip() if len(name) > 1 and name[0] == name[-1] == '"' else name
            for stop in {number[each] for each in (name, unquoted) if each in number}:
                ways[end] |= {stops | {stop}: None for stops in list(ways[begin])[:2]}
    return [tuple(sorted(stops)) for stops in ways[-1]]


def times_from(frames: int | None, times: str | None) -> list[float] | None:
    """The times of ``--times``, s; None without ``--times``.  Both options together are refused."""
    if times is None:
        if frames is not None:
            check_frames(frames)
        return None
    if frames is not None:
        raise InputError("--frames, --times: give one of them")
    try:
        return [float(time) for time in times.split(",")]
    except ValueError:
        raise InputError(f"--times {times}: must be numbers with commas between them, in s") from None


def size_from(text: str | None) -> tuple[int, int] | None:
    """Width and height, pixels, from ``900x400``."""
    if text is None:
        return None
    width, x, height = text.lower().partition("x")
    if not (x and width.isdecimal() and height.isdecimal()):
        raise InputError(f"--size {text}: must be width and height in pixels, as in 900x400")
    return int(width), int(height)


def refuse(reason: str, **given: object) -> None:
    """Refuse options that have no meaning here, if they are given: with a value other than None and False."""
    for name, value in given.items():
        if value is not None and value is not False:
            raise InputError(f"--{name.replace('_', '-')}: {reason}; leave it out")


def names_from(text: str) -> tuple[str, ...]:
    """The names in a text with commas between them."""
    return tuple(name.strip() for name in text.split(","))


def places_from(text: str, problem: Problem) -> list[float]:
    """The positions, m, of the places of ``--at x=2.5,1.25``, or of several beams ``--at x=upper:0.3,lower:0.1``."""
    name, _, listed = text.partition("=")
    try:
        places = [place_of(place.strip()) for place in listed.split(",")] if name.strip() == "x" else []
    except ValueError:
        places = []
    if not places:
        raise InputError(f"--at {text}: must be x= and numbers with commas between them, in m, as in x=2.5,1.25")
    for place in places:
        fault = problem.line.fault_of(place)
        if fault:
            raise InputError(f"x = {fault[0]}: {fault[1]}")
    return [problem.position(place) for place in places]


def place_from(text: str, problem: Problem) -> float | str:
    """The one place of ``--at x=2.5``, m, or of several beams ``--at x=upper:0.3``."""
    found = places_from(text, problem)
    if len(found) > 1:
        raise InputError(f"--at {text}: has {len(found)} places; one is allowed")
    return text.partition("=")[2].strip() if problem.line.several else found[0]


def named_number(option: str, text: str, rule: str) -> tuple[str, float]:
    """The name and the number of ``NAME=VALUE``; `rule` ends the message on any other text."""
    name, _, value = text.partition("=")
    with suppress(ValueError):
        if name.strip():
            return name.strip(), float(value)
    raise InputError(f"{option} {text}: must be {rule}")


def check_answer_files(files: AnswerFiles) -> None:
    """Refuse names of files that could not be written, before the computation begins."""
    check_file("--contacts", files.contacts, ".csv", ".json")
    check_file("--series", files.series, ".nc", ".csv")
    check_file("--figure", files.figure, *FIGURES)


def series_from(problem: Problem, files: AnswerFiles, duration: float | None) -> dict[str, Any]:
    """The arguments of `time_series`; impossible ones are refused before the computation begins."""
    if files.series is None:
        refuse("no series is written without --series FILE", quantity=files.quantity, rate=files.rate)
        return {}
    wanted: dict[str, Any] = {
        "at": None if files.at is None else places_from(files.at, problem),
        "quantities": None if files.quantity is None else names_from(files.quantity),
        "rate": files.rate,
    }
    check_series(problem, **wanted, duration=duration)
    return wanted


def check_duration(duration: float | None) -> None:
    """Refuse a duration that is not positive and finite."""
    if duration is not None and not 0 < duration < float("inf"):
        raise InputError(f"--duration {duration:g}: must be positive and finite, in s")


def duration_of(problem: Problem, duration: float | None) -> float:
    """The given duration, or else the duration of the shortest record, s."""
    if duration is None and not problem.records:
        raise InputError("--duration: is missing; only a problem with a record has a duration of its own")
    return problem.longest if duration is None else duration


def check_file(option: str, path: str | None, *endings: str) -> None:
    """Refuse the name of a file that could not be written, before the computation begins."""
    if path is None:
        return
    if endings and Path(path).suffix.lower() not in endings:
        raise InputError(f"{option} {path}: the name must end in {', '.join(endings)}")
    if Path(path).is_dir():
        raise OutputError(f"{option} {path}: cannot be written: it is a directory")
    folder = _followed(option, path).parent
    if not folder.is_dir():
        raise OutputError(f"{option} {path}: cannot be written: there is no such directory")


def _followed(option: str, path: str) -> Path:
    """A path with its links followed, except a link that leads to itself."""
    try:
        return Path(os.path.realpath(path))
    except (OSError, ValueError) as error:
        raise OutputError(f"{option} {path}: cannot be written: {error}") from None


def drawing_from(problem: Problem, files: AnswerFiles, elsewhere: bool) -> dict[str, Any]:
    """The arguments of a figure: its places.  A figure that cannot be drawn is refused before the computation begins.

    `elsewhere` says whether --at has a meaning without a figure, too.
    """
    draw, at = files.draw, files.at
    if draw and not files.figure:
        raise InputError(f"--draw {draw}: nothing is drawn without --figure FILE")
    if draw == "poincare":
        problem.require_excitation_frequency("--draw poincare")
    name = draw or "motion"
    most = DRAWINGS[name].most_places
    if at is None or not files.figure or not most:
        if not elsewhere:
            refuse("there is neither a series nor a figure that shows places", at=at)
        return {}
    places = places_from(at, problem)
    if len(places) > most:
        raise InputError(f"--at {at}: figure {name} shows one place; give one")
    return {"x": places[0] if most == 1 else places}


def check_directory(path: str) -> None:
    """Refuse a directory that could not be made or written to, before the computation begins."""
    if not path:
        raise InputError("--out: is empty; it must name a directory")
    there = _followed("--out", path)
    while not there.exists() and not there.is_symlink():
        there = there.parent
    if not there.is_dir() or not os.access(there, os.W_OK):
        reason = "is not a directory" if not there.is_dir() else "may not be written to"
        raise OutputError(f"--out {path}: cannot be written: {there} {reason}")
