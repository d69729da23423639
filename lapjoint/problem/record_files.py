"""Columns of a CSV file, as shakers, accelerometers and load cells write them.

Empty lines and lines that begin with # are skipped.  The first line holds the names of the columns if one of its cells
is neither a number nor made of digits and marks alone.

A file that can be read in two ways is refused.  All lines of samples have one number of fields, and fields beyond those
of the first line are empty.  A number has no separated thousands.  Where every line of the samples could also be read
with commas as decimal marks (``29,123``), or with separated thousands (``1,234.5``), `decimal` or `delimiter` must say
how to read it.
"""

from __future__ import annotations

import csv
import math
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lapjoint.errors import InputError
from lapjoint.files.reading import read_file
from lapjoint.problem.messages import encodable, shown
from lapjoint.problem.samples import Samples, Source
from lapjoint.problem.schema import IntArray

_DELIMITERS = (";", "\t", ",", " ")
"""Possible delimiters of columns, in the order in which they are looked for."""
_NAMED = 12
"""Most columns that a message names."""
_MARKS = re.compile(r"(?=.*\d)[\d\s.,:/'+-]+")
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


class _Line(NamedTuple):
    """A line with names or samples."""

    number: int
    """Which line of the file it is, from 1."""
    text: str
    cells: list[str]


def read_columns(source: Source) -> tuple[Samples, Samples | None, IntArray]:
    """The values of a record, their times, each in its own unit, and the lines of the file, from 1, (n,) each.

    The times are None without a column of them. A `ValueError` names the line of a cell that is no number, or that can
    be read in two ways.
    """
    lines = _lines(source)
    first = lines[0].cells
    while not first[-1] and len(first) > 1:
        first = first[:-1]
    names = first if any(_is_name(cell, source.decimal) for cell in first) else []
    rows, width = lines[1:] if names else lines, len(first)
    _check_widths(source, lines[0], width, rows)
    _check_marks(source, rows)
    time = None if source.time_column is None else _column(source, "time_column", source.time_column, names, width)
    default = 1 if time == 0 and width > 1 else 0
    value = default if source.column is None else _column(source, "column", source.column, names, width)
    if value == time:
        raise ValueError(f"column = {shown(value + 1)}: is the time_column, too")
    times = None if time is None else Samples(_numbers(source, rows, time), source)
    return Samples(_numbers(source, rows, value), source), times, np.array([row.number for row in rows], dtype=np.int64)


def _lines(source: Source) -> list[_Line]:
    """The lines with names and samples."""
    numbered = enumerate(re.split(r"\r\n|\n|\r", _text(source)), 1)
    kept = [(i, line) for i, line in numbered if i > source.skip]
    kept = [(i, line) for i, line in kept if line.strip() and not line.lstrip().startswith("#")]
    if not kept:
        raise _refused(source, f"has no samples after the {source.skip} lines that skip leaves out")
    delimiter = source.delimiter or _delimiter_of([line for _, line in kept[:2]], source.decimal)
    try:
        return [_Line(i, line.strip(), _cells(line, delimiter)) for i, line in kept]
    except csv.Error as error:
        raise _refused(source, f"cannot be read as CSV: {error}") from None


def _text(source: Source) -> str:
    """The text of the file, without a byte order mark."""
    path = Path(source.folder) / source.file
    try:
        raw = read_file(path, f"file = {shown(source.file)}")
    except InputError as error:
        raise ValueError(encodable(f"{error}; it is looked for in {path.parent}")) from None
    try:
        return raw.decode(source.encoding).removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        message = f"is not a text file in {source.encoding.upper()} (line {line}); encoding may be cp1252, utf-16 ..."
        raise _refused(source, message) from None
    except (LookupError, ValueError):
        message = "is no encoding of text; allowed are utf-8, cp1252, latin-1, utf-16 and what else Python knows"
        raise ValueError(f"encoding = {shown(source.encoding)}: {message}") from None


def _refused(source: Source, message: str) -> ValueError:
    return ValueError(f"file = {shown(source.file)}: {message}")


def _delimiter_of(first: list[str], decimal: str) -> str:
    """The delimiter in the first two lines: in the line of samples, or in either if both are samples."""
    samples = [line for line in first[::-1] if line is first[-1] or _MARKS.fullmatch(line)]
    for line in samples:
        for mark in _DELIMITERS:
            if mark != decimal and mark in (line.strip() if mark == " " else line):
                return mark
    return _DELIMITERS[0]


def _cells(line: str, delimiter: str) -> list[str]:
    if delimiter == " ":
        return re.split("[ \t]+", line.strip())
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter))]


def _number(cell: str, decimal: str) -> float | None:
    """The number in a cell; None where there is none, or one with separated thousands."""
    if "_" in cell or (decimal == "," and "." in cell):
        return None
    try:
        return float(cell.replace(decimal, "."))
    except ValueError:
        return None


def _is_name(cell: str, decimal: str) -> bool:
    return _number(cell, decimal) is None and not _MARKS.fullmatch(cell)


def _check_widths(source: Source, first: _Line, width: int, rows: list[_Line]) -> None:
    """Refuse lines of samples that differ in their number of fields, or have fewer than the first line's `width`."""
    for row in rows:
        if len(row.cells) < width or any(row.cells[width:]):
            other, number = first, width
        elif len(row.cells) != len(rows[0].cells):
            other, number = rows[0], len(rows[0].cells)
        else:
            continue
        raise _refused(
            source,
            f"line {row.number}, {shown(row.text)}, has {_fields(len(row.cells))}, and line {other.number} has "
            f"{_fields(number)}; skip, delimiter and decimal say how to read them, and thousands must not be separated",
        )


def _fields(number: int) -> str:
    return f"{number} field{'s' * (number > 1)}"


def _check_marks(source: Source, rows: list[_Line]) -> None:
    """Refuse samples that can be read in two ways, unless a key says in which."""
    if not rows:
        return
    if (
        source.decimal == "."
        and source.delimiter != ","
        and all(_DECIMAL_COMMAS.fullmatch(row.text.rstrip(",; \t")) for row in rows)
    ):
        two, keys = "a comma may be a decimal mark or stand between columns", 'decimal = "," or delimiter = ","'
    elif source.delimiter is None and all(_THOUSANDS[source.decimal].search(row.text) for row in rows):
        two, keys = "thousands may be separated, which is not read, or columns", 'delimiter = "," or delimiter = " "'
    else:
        return
    raise _refused(source, f"line {rows[0].number}, {shown(rows[0].text)}: {two}; {keys} says which")


def _column(source: Source, field: str, given: int | str, names: list[str], width: int) -> int:
    """The index of a column that is given by its name, or by its number from 1."""
    if isinstance(given, str) and given in names:
        return names.index(given)
    if isinstance(given, int) and 1 <= given <= width:
        return given - 1
    named = ", ".join(names[:_NAMED]) + ", ..." * (len(names) > _NAMED)
    allowed = f"{named + ', or ' if named else ''}1 to {width}"
    raise ValueError(f"{field} = {shown(given)}: is no column of {source.file}; allowed: {allowed}")


def _numbers(source: Source, rows: list[_Line], column: int) -> list[float]:
    """The numbers of a column."""
    found = []
    for row in rows:
        cell = row.cells[column]
        number = _number(cell, source.decimal)
        if number is None or not math.isfinite(number):
            message = f"line {row.number} has {shown(cell) if cell else 'nothing'} in column {column + 1}"
            hint = f", with decimal = {shown(source.decimal)} and no separated thousands" * bool(_MARKS.fullmatch(cell))
            raise _refused(source, f"{message}, and must have a finite number{hint}")
        found.append(number)
    return found
