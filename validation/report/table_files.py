"""Tables of a report as files, for spreadsheets (CSV) and for programs (JSON)."""

from __future__ import annotations

import csv
import io
import json
import math
import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from lapjoint.files.plain_text import no_formula

Cell = str | float | None
FOLDER = "tables"
_INDEX = "index.json"


@dataclass(frozen=True)
class Sheet:
    """A table with a name for its files."""

    name: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    grouped: bool = False
    """Whether rows that follow each other with the same first cell are shown as a group under that cell."""

    @property
    def groups(self) -> tuple[tuple[Cell, tuple[tuple[Cell, ...], ...]], ...]:
        """The first cell of each group, and its rows without that cell; None and all rows where nothing is grouped."""
        if not self.grouped:
            return ((None, self.rows),)
        parts = groupby(self.rows, key=lambda row: row[0])
        return tuple((first, tuple(row[1:] for row in rows)) for first, rows in parts)

    @property
    def files(self) -> tuple[str, str]:
        """Names of its CSV and JSON files."""
        return f"{self.name}.csv", f"{self.name}.json"

    @property
    def numeric(self) -> tuple[bool, ...]:
        """Which columns hold nothing but numbers."""
        return tuple(all(_is_number(row[i]) for row in self.rows) for i in range(len(self.columns)))

    @property
    def classes(self) -> tuple[str, ...]:
        """How each column is set: as numbers, as text, or as sentences that need room."""
        longest = [max((len(str(row[i])) for row in self.rows), default=0) for i in range(len(self.columns))]
        return tuple(
            "num" if numeric else "words" if length > 32 else "text"
            for numeric, length in zip(self.numeric, longest, strict=True)
        )

    def csv(self) -> str:
        """Header and rows; numbers that are not finite as inf and nan, and no text that a spreadsheet computes."""
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerows([no_formula(cell) for cell in row] for row in (self.columns, *self.rows))
        return out.getvalue()

    def json(self) -> str:
        """Title, columns and rows; numbers that are not finite as null."""
        rows = [[_finite(cell) for cell in row] for row in self.rows]
        data = {"title": self.title, "columns": self.columns, "rows": rows}
        return json.dumps(data, indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def slug(text: str, longest: int = 48) -> str:
    """A name for files and anchors: lower-case letters, digits and hyphens, never empty."""
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
    return re.sub(r"[^a-z0-9]+", "-", plain.lower())[:longest].strip("-") or "x"


def distinct(names: Sequence[str]) -> list[str]:
    """The slugs of the names, numbered where they meet."""
    found: list[str] = []
    for name in names:
        base, tag, count = slug(name), slug(name), 1
        while tag in found:
            count += 1
            tag = f"{base}-{count}"
        found.append(tag)
    return found


def write_sheets(sheets: Sequence[Sheet], output: Path) -> None:
    """Write all sheets, and an index of them, into a new folder `tables`."""
    folder = output / FOLDER
    folder.mkdir()
    for sheet in sheets:
        for name, text in zip(sheet.files, (sheet.csv(), sheet.json()), strict=True):
            (folder / name).write_text(text, encoding="utf-8", newline="")
    index = [{"title": sheet.title, "files": sheet.files} for sheet in sheets]
    (folder / _INDEX).write_text(json.dumps(index, indent=1) + "\n", encoding="utf-8", newline="")


def remove_sheets(output: Path) -> None:
    """Remove the sheets that an earlier report left in the folder `tables`."""
    for name in _left_behind(output / FOLDER):
        (output / FOLDER / name).unlink(missing_ok=True)


def _left_behind(folder: Path) -> list[str]:
    try:
        index = json.loads((folder / _INDEX).read_text(encoding="utf-8"))
        names = [str(name) for entry in index for name in entry["files"]]
    except (OSError, ValueError, TypeError, KeyError, RecursionError):
        return []
    return [name for name in names if re.fullmatch(r"[a-z0-9-]+\.(csv|json)", name)]


def _finite(cell: Cell) -> Cell:
    return None if isinstance(cell, float) and not math.isfinite(cell) else cell


def _is_number(cell: Cell) -> bool:
    if not isinstance(cell, str):
        return True
    number = r"[-+]?\d[\d.,eE+-]*"
    error = rf" *(±|\+-) *(\d[\d.eE+-]*|\?)| \(({number}|\?) to ({number}|\?)\)"
    return bool(re.fullmatch(rf"\s*({number}({error})?|nan|inf|[-–?])?\s*%?", cell))
