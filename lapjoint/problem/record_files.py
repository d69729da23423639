"""Columns of a CSV file, as shakers, accelerometers and load cells write them."""

from __future__ import annotations

import csv
import math
from pathlib import Path

from lapjoint.errors import InputError
from lapjoint.input_files import read_file
from lapjoint.problem.messages import encodable, shown
from lapjoint.problem.samples import Samples, Source

_DELIMITERS = (",", ";", "\t", " ")
_NAMED = 12  # most columns that a message names


def read_columns(source: Source) -> tuple[Samples, Samples | None]:
    """The values of a record, and their times if it has a column of them.

    Empty lines and lines that begin with # are passed over.  If the first line that is left has a cell that is no
    number, it holds the names of the columns.

    Parameters
    ----------
    source : Source
        Where to read.

    Returns
    -------
    Samples
        The values, in their own unit.
    Samples or None
        Their times, in their own unit.

    Raises
    ------
    ValueError
        If there is no such file or column, or a cell is no number; the message names the line.
    """
    path = Path(source.folder) / source.file
    try:
        text = read_file(path, f"file = {shown(source.file)}").decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"file = {shown(source.file)}: is not a text file in UTF-8") from None
    except InputError as error:
        raise ValueError(encodable(f"{error}; it is looked for in {path.parent}")) from None
    lines = [(i, line) for i, line in enumerate(text.splitlines(), 1) if i > source.skip]
    lines = [(i, line) for i, line in lines if line.strip() and not line.lstrip().startswith("#")]
    if not lines:
        raise ValueError(
            f"file = {shown(source.file)}: has no samples after the {source.skip} lines that skip leaves out"
        )
    delimiter = source.delimiter or _delimiter_of(lines[0][1])
    rows = [(i, _cells(line, delimiter)) for i, line in lines]
    names: list[str] = []
    if any(_number(cell) is None for cell in rows[0][1]):
        names, rows = rows[0][1], rows[1:]
    width = len(names or rows[0][1])
    time = None if source.time_column is None else _column(source, "time_column", source.time_column, names, width)
    first = 1 if time == 0 and width > 1 else 0
    value = first if source.column is None else _column(source, "column", source.column, names, width)
    if value == time:
        raise ValueError(f"column = {shown(value + 1)}: is the time_column, too")
    return Samples(_numbers(source, rows, value), source), (
        None if time is None else Samples(_numbers(source, rows, time), source)
    )


def _delimiter_of(line: str) -> str:
    return next((mark for mark in _DELIMITERS if mark in line.strip()), ",")


def _cells(line: str, delimiter: str) -> list[str]:
    if delimiter == " ":
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter))]


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None


def _column(source: Source, field: str, given: int | str, names: list[str], width: int) -> int:
    """The index of a column that is given by its name, or by its number from 1."""
    if isinstance(given, str) and given in names:
        return names.index(given)
    if isinstance(given, int) and 1 <= given <= width:
        return given - 1
    named = ", ".join(names[:_NAMED]) + ", ..." * (len(names) > _NAMED)
    allowed = f"{named + ', or ' if named else ''}1 to {width}"
    raise ValueError(f"{field} = {shown(given)}: is no column of {source.file}; allowed: {allowed}")


def _numbers(source: Source, rows: list[tuple[int, list[str]]], column: int) -> list[float]:
    """The numbers of a column."""
    found = []
    for line, cells in rows:
        number = _number(cells[column]) if column < len(cells) else None
        if number is None or not math.isfinite(number):
            there = shown(cells[column]) if column < len(cells) else "nothing"
            message = f"line {line} has {there} in column {column + 1}, and must have a finite number"
            raise ValueError(f"file = {shown(source.file)}: {message}")
        found.append(number)
    return found
