"""Columns of a CSV file, as shakers, accelerometers and load cells write them.

Empty lines are skipped, and so are lines that begin with the text `comment`.  The first line holds the names of the
columns if one of its cells is neither a number nor made of digits and marks alone.  A line of units may follow: no cell
of it is a number.

A file that can be read in two ways is refused.  All lines of samples have one number of fields, and fields beyond those
of the first line are empty.  A number has no separated thousands.  Where every line of the samples could also be read
with commas as decimal marks (``29,123``), or with separated thousands (``1,234.5``), `decimal` or `delimiter` must say
how to read it.  The message names the keys that would read the file, where some do (`lapjoint.problem.record_advice`).

Lines are read one after the other, and only the numbers of the two columns are kept.
"""

from __future__ import annotations

import csv
import io
import math
import re
from array import array
from collections.abc import Iterable, Iterator
from itertools import chain, islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lapjoint.errors import InputError
from lapjoint.files.reading import read_file
from lapjoint.problem.messages import encodable, shown
from lapjoint.problem.samples import Samples, Source, Stated
from lapjoint.problem.schema import IntArray

DELIMITERS = (";", "\t", ",", " ")
"""Possible delimiters of columns, in the order in which they are looked for."""
_NAMED = 12
"""Most columns that a message names."""
MARKS = re.compile(r"(?=.*\d)[\d\s.,:/'+-]+")
"""A cell of digits and marks, as a time of day or ``1,234.5``: no name of a column."""
_WHOLE, _FRACTION, _POWER = r"[+-]?(?:\d+|[1-9]\d{0,2}(?:\.\d{3})+)", r",\d+", r"(?:[eE][+-]?\d+)?"
_WITH_COMMA, _PERHAPS = f"{_WHOLE}{_FRACTION}{_POWER}", f"{_WHOLE}(?:{_FRACTION})?{_POWER}"
_DECIMAL_COMMAS = re.compile(
    rf"{_WITH_COMMA}(?:,{_WITH_COMMA})*|(?=.*,){_PERHAPS}(?:[;\s]\s*{_PERHAPS})*"  # ``0,5,-1.234,5``; ``0;29,123``
)
"""A line that makes sense with its commas as decimal marks, whatever stands between columns."""
_THOUSANDS = {
    ".": re.compile(r"(?:^|[\s,])[+-]?[1-9]\d{0,2}(?:[, ]\d{3})+(?:\.\d*)?(?:$|[\s,])"),
    ",": re.compile(r"(?:^|\s)[+-]?[1-9]\d{0,2}(?: \d{3})+(?:,\d*)?(?:$|\s)"),
}
"""A number whose thousands may be separated, by its decimal mark: ``1,234.5``; ``1 234,5``."""
_LONGEST_CELL = 131_072
"""Most characters of a line that is split without `csv`, whose limit for a cell this is."""


_OTHERWISE = "; skip, comment, delimiter and decimal say how to read it, and thousands must not be separated"
"""What to try where no keys are known to read a file, at the end of a message."""


class Line(NamedTuple):
    """A line with names, units or samples."""

    number: int
    """Which line of the file it is, from 1."""
    text: str
    cells: list[str]


class UnreadableError(Exception):
    """Why a file cannot be read as its keys say, and what to try where no other keys are known to read it."""

    def __init__(self, message: str, otherwise: str = "") -> None:
        super().__init__(message)
        self.otherwise = otherwise


class Columns(NamedTuple):
    """Values and times of a record, each in its own unit."""

    values: Samples
    times: Samples | None
    """None without a column of times."""
    lines: IntArray
    """The lines of the samples in the file, from 1, shape (n,)."""


def read_columns(source: Source) -> Columns:
    """The columns of a record in a CSV file.

    A `ValueError` names the line that can be read in two ways; an `UnreadableError` the line that cannot be read.
    """
    try:
        return columns_of(source, file_lines(source))
    except csv.Error as error:
        raise ValueError(f"file = {shown(source.file)}: cannot be read as CSV: {error}") from None


def _unreadable(source: Source, message: str) -> UnreadableError:
    return UnreadableError(f"file = {shown(source.file)}: {message}", _OTHERWISE)


def columns_of(source: Source, numbered: Iterable[tuple[int, str]]) -> Columns:
    """The columns of a record in lines of text, each with its number; else an `UnreadableError`, or a `ValueError`."""
    lines = _lines(source, numbered)
    heading, rest, width = _heading(source, lines)
    value, time, off = _chosen(source, heading.names, width)
    wanted = [value] if time is None else [value, time]
    numbers, found = [array("d") for _ in wanted], array("q")
    marks = _Marks(source)
    first: Line | None = None
    for row in rest:
        _check_width(source, row, heading.top, width, first or row)
        first = first or row
        marks.see(row)
        for column, kept in zip(wanted, numbers, strict=True) if off is None else ():
            number = number_in(row.cells[column], source.decimal)
            if number is None or not math.isfinite(number):
                off = _no_number(source, row, column)
                break
            kept.append(number)
        found.append(row.number)
    marks.check()
    if off is not None:
        raise off
    values, *times = (
        Samples(np.array(kept), source, heading.stated(column)) for kept, column in zip(numbers, wanted, strict=True)
    )
    return Columns(values, times[0] if times else None, np.array(found, dtype=np.int64))


class _Heading(NamedTuple):
    """What stands above the samples."""

    top: Line
    """The first line, of names or of samples."""
    names: list[str]
    """None if the first line is one of samples."""
    units: Line | None

    def stated(self, column: int) -> Stated | None:
        """What the heading says of the unit of a column: in the line of units, or in brackets behind its name."""
        if self.units is not None:
            text = self.units.cells[column] if column < len(self.units.cells) else ""
            return Stated(f"line {self.units.number}", text, sure=True)
        bracketed = re.search(r"[\[(]([^\[\]()]+)[\])]$", self.names[column]) if self.names else None
        return None if bracketed is None else Stated(f"line {self.top.number}", bracketed[1], sure=False)


def _heading(source: Source, lines: Iterator[Line]) -> tuple[_Heading, Iterator[Line], int]:
    """The heading, the lines of samples, and the number of their fields."""
    top = next(lines)
    first = top.cells
    while not first[-1] and len(first) > 1:
        first = first[:-1]
    if not any(_is_name(cell, source.decimal) for cell in first):
        return _Heading(top, [], None), chain([top], lines), len(first)
    second = next(lines, None)
    if second is None:
        return _Heading(top, first, None), lines, len(first)
    if all(_is_name(cell, source.decimal) for cell in second.cells) and any(second.cells):
        return _Heading(top, first, second), lines, len(first)
    return _Heading(top, first, None), chain([second], lines), len(first)


def _lines(source: Source, numbered: Iterable[tuple[int, str]]) -> Iterator[Line]:
    """The lines with names, units and samples, in their fields."""
    kept = ((i, line) for i, line in numbered if i > source.skip and line.strip() and not source.passes_over(line))
    begin = list(islice(kept, 2))
    if not begin:
        raise _unreadable(
            source, "has no samples" + f" after the {source.skip} lines that skip leaves out" * (source.skip > 0)
        )
    delimiter = source.delimiter or _delimiter_of([line for _, line in begin], source.decimal)
    for i, line in chain(begin, kept):
        yield Line(i, line.strip(), cells_of(line, delimiter))


def file_lines(source: Source) -> Iterator[tuple[int, str]]:
    """The lines of a file, from 1, without a byte order mark."""
    path = Path(source.folder) / source.file
    try:
        raw = read_file(path, f"file = {shown(source.file)}")
    except InputError as error:
        raise ValueError(encodable(f"{error}; it is looked for in {path.parent}")) from None
    try:
        for i, line in enumerate(io.TextIOWrapper(io.BytesIO(raw), source.encoding), 1):
            yield i, line.removeprefix("\ufeff") if i == 1 else line
    except UnicodeDecodeError:
        raise ValueError(f"file = {shown(source.file)}: {_undecodable(raw, source.encoding)}") from None
    except (LookupError, ValueError):
        message = "is no encoding of text; allowed are utf-8, cp1252, latin-1, utf-16 and what else Python knows"
        raise ValueError(f"encoding = {shown(source.encoding)}: {message}") from None


def _undecodable(raw: bytes, encoding: str) -> str:
    """Why bytes are no text in an encoding, with the line, and the encoding that they probably have."""
    try:
        raw.decode(encoding)
        line = 1
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
    wide = raw.startswith((b"\xff\xfe", b"\xfe\xff"))
    return (
        f"is not a text file in {encoding.upper()} (line {line}); "
        f'encoding = "{"utf-16" if wide else "cp1252"}" may be right'
    )


def _delimiter_of(first: list[str], decimal: str) -> str:
    """The delimiter in the first two lines: in the line of samples, or in either if both are samples."""
    samples = [line for line in first[::-1] if line is first[-1] or MARKS.fullmatch(line)]
    for line in samples:
        for mark in DELIMITERS:
            if mark != decimal and mark in (line.strip() if mark == " " else line):
                return mark
    return DELIMITERS[0]


def cells_of(line: str, delimiter: str) -> list[str]:
    """The fields of a line; csv.Error if one is too long."""
    if delimiter == " ":
        return re.split("[ \t]+", line.strip())
    if '"' in line or len(line) > _LONGEST_CELL:
        return [cell.strip() for cell in next(csv.reader([line.rstrip("\n")], delimiter=delimiter))]
    return [cell.strip() for cell in line.split(delimiter)]


def number_in(cell: str, decimal: str) -> float | None:
    """The number in a cell; None where there is none, or one with separated thousands."""
    if "_" in cell or (decimal == "," and "." in cell):
        return None
    try:
        return float(cell.replace(decimal, "."))
    except ValueError:
        return None


def _is_name(cell: str, decimal: str) -> bool:
    return number_in(cell, decimal) is None and not MARKS.fullmatch(cell)


def _check_width(source: Source, row: Line, top: Line, width: int, first: Line) -> None:
    """Refuse a line of samples with fewer fields than the first line's `width`, or not as many as the first samples."""
    if len(row.cells) < width or any(row.cells[width:]):
        other, number = top, width
    elif len(row.cells) != len(first.cells):
        other, number = first, len(first.cells)
    else:
        return
    message = f"line {row.number}, {shown(row.text)}, has {_fields(len(row.cells))}"
    raise _unreadable(source, f"{message}, and line {other.number} has {_fields(number)}")


def _fields(number: int) -> str:
    return f"{number} field{'s' * (number > 1)}"


class _Marks:
    """Whether all lines of samples can be read in two ways, and no key says in which."""

    def __init__(self, source: Source) -> None:
        self._source = source
        self._line: Line | None = None
        self._commas = source.decimal == "." and source.delimiter != ","
        self._thousands = _THOUSANDS[source.decimal] if source.delimiter is None else None

    def see(self, row: Line) -> None:
        """Take one more line of samples into account."""
        self._line = self._line or row
        if self._commas and not _DECIMAL_COMMAS.fullmatch(row.text.rstrip(",; \t")):
            self._commas = False
        if self._thousands is not None and not self._thousands.search(row.text):
            self._thousands = None

    def check(self) -> None:
        """Refuse the lines if both readings make sense of all of them."""
        if self._line is None or not (self._commas or self._thousands):
            return
        if self._commas:
            two, keys = "a comma may be a decimal mark or stand between columns", 'decimal = "," or delimiter = ","'
        else:
            two, keys = (
                "thousands may be separated, which is not read, or columns",
                'delimiter = "," or delimiter = " "',
            )
        where = f"file = {shown(self._source.file)}: line {self._line.number}, {shown(self._line.text)}"
        raise ValueError(f"{where}: {two}; {keys} says which")


def _chosen(source: Source, names: list[str], width: int) -> tuple[int, int | None, UnreadableError | None]:
    """The indices of the columns of values and of times, or what is wrong with their keys."""
    try:
        time = None if source.time_column is None else _column(source, "time_column", source.time_column, names, width)
        default = 1 if time == 0 and width > 1 else 0
        value = default if source.column is None else _column(source, "column", source.column, names, width)
    except UnreadableError as error:
        return 0, None, error
    if value == time:
        return 0, None, UnreadableError(f"column = {shown(value + 1)}: is the time_column, too")
    return value, time, None


def _column(source: Source, field: str, given: int | str, names: list[str], width: int) -> int:
    """The index of a column that is given by its name, or by its number from 1."""
    if isinstance(given, str) and given in names:
        return names.index(given)
    if isinstance(given, int) and 1 <= given <= width:
        return given - 1
    named = ", ".join(names[:_NAMED]) + ", ..." * (len(names) > _NAMED)
    allowed = f"{named + ', or ' if named else ''}1 to {width}"
    raise UnreadableError(f"{field} = {shown(given)}: is no column of {source.file}; allowed: {allowed}")


def _no_number(source: Source, row: Line, column: int) -> UnreadableError:
    cell = row.cells[column]
    hint = f", with decimal = {shown(source.decimal)} and no separated thousands" * bool(MARKS.fullmatch(cell))
    there = shown(cell) if cell else "nothing"
    message = f"line {row.number} has {there} in column {column + 1}, and must have a finite number{hint}"
    return UnreadableError(f"file = {shown(source.file)}: {message}")
