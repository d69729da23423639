"""What a page asks: a problem and a range of frequencies, as a link or a file brings them back."""

from __future__ import annotations

import base64
import json
import math
import shlex
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import tomli_w

from lapjoint.campaigns.grid import FREQUENCY, Axis, Grid
from lapjoint.campaigns.sweep.spec import Plan
from lapjoint.cli.arguments import frequencies, problem_from
from lapjoint.errors import InputError
from lapjoint.files.reading import read_file
from lapjoint.problem import Problem
from lapjoint.problem.files import problem_from_tables, problem_tables, tables_from_toml, to_toml

INTERVALS = 400
"""Number of intervals between the frequencies of a whole curve."""
STEPS = 10, 4, 1
"""Intervals between the frequencies of the curves that follow each other, which have 41, 101 and 401 of them."""
RANGE = 0.2, 2.0
"""First and last frequency of the curve of a problem that is opened, as shares of its own frequency, or of the lowest
natural one."""
DIGITS = 6
"""Significant digits of the ends of a range that no person typed."""
LONGEST_LINK = 100_000
"""Most characters of a state in a link; browsers take addresses of this length."""
MOST_UNPACKED = 4_000_000
"""Most bytes of a state: a link that unpacks to more was not made by this program."""


@dataclass(frozen=True)
class Question:
    """What a page asks.  The problem is as it was typed, and need not be valid."""

    problem: str
    """The problem as TOML; its own excitation frequency is that of the cycle that is shown."""
    first: float
    """First excitation frequency of the curve, in `unit`."""
    last: float
    """Last excitation frequency of the curve, in `unit`."""
    folder: str = "."
    """Folder from which files of samples are looked for."""
    hz: bool = False
    """Whether the frequencies of the curve are in Hz; else they are in rad/s."""

    @property
    def unit(self) -> tuple[str, float]:
        """The unit of the frequencies of the curve, and its size in rad/s."""
        return ("Hz", 2 * math.pi) if self.hz else ("rad/s", 1.0)

    def in_unit(self, hz: bool) -> Question:
        """The question with frequencies in Hz, or in rad/s; another unit rounds them to `DIGITS`."""
        made = replace(self, hz=hz)
        return self if hz == self.hz else made.over(self.first * self.unit[1], self.last * self.unit[1])

    def over(self, first: float, last: float) -> Question:
        """The question with another range of frequencies, given in rad/s."""
        first, last = (float(f"{value / self.unit[1]:.{DIGITS}g}") for value in (first, last))
        return replace(self, first=first, last=last)

    def around(self, omega: float) -> Question:
        """The question with the `RANGE` of an angular frequency, rad/s."""
        return self.over(*(share * omega for share in RANGE))

    @property
    def tables(self) -> dict[str, Any]:
        """The tables of the problem."""
        return tables_from_toml(self.problem, "problem")

    def with_tables(self, tables: Mapping[str, Any]) -> Question:
        """The question with another problem."""
        return replace(self, problem=tomli_w.dumps(tables))

    def made(self) -> Problem:
        """The validated problem; an `InputError` has a line for each fault."""
        return problem_from_tables(self.tables, "problem", self.folder)

    def plan(self, problem: Problem) -> Plan:
        """The sweep whose points are the curve, from the problem that was `made`; an `InputError` if there is none."""
        problem.require_excitation_frequency("curve")
        if not self.last > self.first:
            name = self.unit[0]
            raise InputError(f"to = {self.last:g} {name}: must be greater than from, {self.first:g} {name}")
        return Plan(Grid(problem, (Axis(FREQUENCY, frequencies(self.first, self.last, self._step, self.hz)),)))

    @property
    def _step(self) -> float:
        return (self.last - self.first) / INTERVALS

    def at_frequency(self, omega: float) -> Question:
        """The question whose cycle has an excitation frequency, rad/s; an `InputError` if it cannot have it."""
        return replace(self, problem=to_toml(Grid(self.made(), (Axis(FREQUENCY, (omega,)),)).problem_at(0)))

    def commands(self, file: str) -> tuple[str, ...]:
        """The commands that compute what the page shows of the problem in a file."""
        name, unit = shlex.quote(file), " --hz" if self.hz else ""
        ends = f"--from {self.first!r} --to {self.last!r} --step {self._step!r}"
        return (
            f"lapjoint sweep {name}{unit} {ends} --out curve.nc",
            f"lapjoint steady {name}",
            f"lapjoint validate {name} --case steady --quick",
        )

    def packed(self) -> str:
        """The question as text for a link, of letters, digits, ``-`` and ``_``."""
        return base64.urlsafe_b64encode(zlib.compress(self.written().encode(), 9)).decode().rstrip("=")

    def written(self) -> str:
        """The question as the text of a file."""
        return json.dumps({"problem": self.problem, "from": self.first, "to": self.last, "hz": self.hz}, indent=1)


def opened(tables: Mapping[str, Any], folder: str = ".", hz: bool = False) -> Question:
    """The first question about a problem, which need not be valid: the curve covers `RANGE` of its frequency."""
    question = Question(tomli_w.dumps(tables), 0.0, 0.0, folder, hz)
    try:
        return with_range(question, question.made())
    except InputError:
        return question


def with_range(question: Question, problem: Problem | None) -> Question:
    """A question with a range of frequencies, as soon as its problem is valid and has a frequency."""
    omega = None if problem is None else problem.excitation_frequency
    if question.last or omega is None:
        return question
    return question.around(omega)


def coarse_to_fine(size: int) -> list[list[int]]:
    """The indices of the frequencies of a curve in `STEPS`, each list without those of the lists before it."""
    found: list[list[int]] = []
    known: set[int] = set()
    for step in STEPS:
        found.append([i for i in range(0, size, step) if i not in known])
        known.update(found[-1])
    return found


def unpacked(text: str, folder: str = ".") -> Question:
    """The question in a link, as `Question.packed` writes it; an `InputError` if it is none."""
    try:
        if len(text) > LONGEST_LINK:
            raise ValueError
        raw = base64.b64decode(text + "=" * (-len(text) % 4), altchars=b"-_", validate=True)
        unpacking = zlib.decompressobj()
        whole = unpacking.decompress(raw, MOST_UNPACKED)
        if not unpacking.eof:
            raise ValueError
        return read_back(whole.decode(), folder)
    except (ValueError, zlib.error):
        raise InputError("the link: is not whole, or was not made by this page") from None


def read_back(text: str, folder: str = ".") -> Question:
    """The question in the text of a file, as `Question.written` writes it; an `InputError` if it is none."""
    try:
        state = json.loads(text)
        hz = state.get("hz", False)
        if not isinstance(state["problem"], str) or not isinstance(hz, bool):
            raise ValueError
        question = Question(state["problem"], float(state["from"]), float(state["to"]), folder, hz)
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError, OverflowError):
        raise InputError("the state: is not whole, or was not written by this page") from None
    _ = question.tables
    return question


def first_question(source: str, overrides: tuple[str, ...] = ()) -> Question:
    """The first question about a file or a preset, with changes as ``--set`` takes them.

    A file that ends in .json is a state, as `Question.written` writes it.
    """
    folder = "." if source.startswith("preset:") else str(Path(source).parent)
    if source.endswith(".json"):
        if overrides:
            raise InputError(f"--set {overrides[0]}: changes a problem, and {source} is the state of a page")
        try:
            return read_back(read_file(source).decode(), folder)
        except UnicodeDecodeError:
            raise InputError(f"{source}: is not a text file in UTF-8") from None
    return opened(problem_tables(problem_from(source, overrides)), folder)
