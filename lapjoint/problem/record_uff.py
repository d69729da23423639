"""Data sets 58 of a universal file (UFF), text or binary, as modal analysis systems write them; `pyuff` reads them.

A data set 58 is a function with its abscissa.  Here it must be a real function of time.  Its unit is that of its label;
without a label, that of the system of units in the file's data set 164.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

import numpy as np

from lapjoint.problem.messages import shown
from lapjoint.problem.record_files import Columns
from lapjoint.problem.samples import Samples, Source, Stated
from lapjoint.problem.schema import IntArray

_ENDINGS = (".uff", ".unv")
_START = re.compile(rb"[\r\n]*    -1 *\r?\n *\d{1,6}[bB]?[ \r\n]")
"""The line that begins a data set, and the line with its type."""
_LISTED = 12
"""Most data sets that a message names."""
_QUANTITIES = {
    2: "stress",
    3: "strain",
    5: "temperature",
    6: "heat flux",
    8: "displacement",
    9: "force",
    11: "velocity",
    12: "acceleration",
    13: "force",
    15: "pressure",
    16: "mass",
    17: "time",
    18: "frequency",
    19: "revolutions",
}
"""Quantities by their code in records 8 and 9 of a data set 58; 0 and 1 say none."""
_FUNCTIONS = {0: "general", 1: "time response", 2: "auto-spectrum", 3: "cross-spectrum", 4: "frequency response"}
"""Types of functions by their code in record 6; there are some thirty."""
_DIRECTIONS = ("", "+X", "+Y", "+Z", "+RX", "+RY", "+RZ", "-RZ", "-RY", "-RX", "-Z", "-Y", "-X")
"""Directions by their code in record 6, the negative ones from the end."""
_RATES = {"displacement": "", "velocity": "/s", "acceleration": "/s2"}
_LENGTHS, _FORCES = {1.0: "m", 100.0: "cm", 1000.0: "mm", 39.37: "in"}, {1.0: "N", 1000.0: "mN", 0.2248: "lbf"}
"""Units by how many of them are one SI unit."""
_ROUNDED = 1e-3
"""Relative distance of a factor in a data set 164 from that of its unit: writers give four digits at least."""


def is_uff(source: Source) -> bool:
    """Whether a file is a universal file, by its name or its first lines."""
    if source.file.lower().endswith(_ENDINGS):
        return True
    try:
        with open(Path(source.folder) / source.file, "rb") as file:
            return file.seekable() and bool(_START.match(file.read(200)))
    except (OSError, ValueError):
        return False  # the reader of text says what is wrong


def read_function(source: Source) -> Columns:
    """The samples and times of the chosen data set; a `ValueError` says why there are none."""
    try:
        return _read(source)
    except _UnreadableError as error:
        raise ValueError(f"file = {shown(source.file)}: {error}") from None


class _UnreadableError(Exception):
    """Why a file gives no samples."""


def _read(source: Source) -> Columns:
    path = Path(source.folder) / source.file
    for key, default in Source._field_defaults.items():
        if getattr(source, key) != default and key != "dataset":
            raise _UnreadableError(f"is a UFF file, and {key} is a key of CSV files; leave it out")
    file = _opened(path)
    _check_whole(path)
    sets = [i for i, kind in enumerate(file.get_set_types()) if kind == 58]
    heads = [_set(file, i, n, header_only=True) for n, i in enumerate(sets, 1)]
    n = _chosen(source, heads)
    of = _set(file, sets[n], n + 1)
    _check(of, n + 1)
    where = f"data set {n + 1}"
    quantity = _QUANTITIES.get(of["ordinate_spec_data_type"], "")
    unit = str(of["ordinate_axis_units_lab"]).strip()
    if not unit or unit.upper() == "NONE":
        unit = _unit_of_the_file(file, quantity)
    times = Stated(where, str(of["abscissa_axis_units_lab"]).strip(), sure=True)
    none: IntArray = np.zeros(0, dtype=np.int64)
    return Columns(
        Samples(of["data"], source, Stated(where, unit, sure=True, quantity=quantity)),
        Samples(of["x"], source, times),
        none,
    )


def _opened(path: Path) -> Any:
    try:
        import pyuff
    except ImportError:
        raise _UnreadableError("is a UFF file, and needs pyuff: pip install 'lapjoint[uff]'") from None
    if not path.is_file():
        raise _UnreadableError(f"cannot be read: there is no such file; it is looked for in {path.parent}")
    if not os.access(path, os.R_OK):
        raise _UnreadableError("cannot be read: permission denied")
    try:
        return pyuff.UFF(str(path))
    except Exception as error:  # pyuff raises nothing narrower
        raise _UnreadableError(f"cannot be read as UFF: {error}") from None


def _set(file: Any, i: int, number: int, **how: bool) -> dict[str, Any]:
    """The data set with an index in the file, which is the `number`-th of type 58."""
    try:
        found: dict[str, Any] = file.read_sets(int(i), **how)
    except Exception as error:  # pyuff raises nothing narrower
        raise _UnreadableError(f"data set {number} is damaged: {error}") from None
    return found


def _check_whole(path: Path) -> None:
    """Refuse a file that does not begin with a data set, or ends within one."""
    with open(path, "rb") as file:
        begins = _START.match(file.read(200))
        file.seek(max(0, os.fstat(file.fileno()).st_size - 200))
        ends = file.read().rstrip().endswith(b"    -1")
    if not begins:
        raise _UnreadableError("is no UFF file, which begins with a line -1 and a line with the type of a data set")
    if not ends:
        raise _UnreadableError("ends within a data set, as a file that was cut off: the line -1 at its end is missing")


def _chosen(source: Source, heads: list[dict[str, Any]]) -> int:
    """Which of the data sets 58 is chosen, from 0."""
    if not heads:
        raise _UnreadableError("has no data set 58, in which functions of time are kept")
    given = source.dataset
    names = [_name(head) for head in heads]
    if given is None and len(heads) == 1:
        return 0
    if isinstance(given, int) and 1 <= given <= len(heads):
        return given - 1
    if isinstance(given, str) and names.count(given) == 1:
        return names.index(given)
    listed = "; ".join(f"{n}: {_described(head)}" for n, head in enumerate(heads[:_LISTED], 1))
    several = isinstance(given, str) and given in names
    wrong = "" if given is None else f"dataset = {shown(given)} is {'several' if several else 'none'} of them; "
    there = f"{len(heads)} data sets 58" if len(heads) > 1 else "1 data set 58"
    raise _UnreadableError(f"has {there}; {wrong}dataset chooses one: {listed}{'; ...' * (len(heads) > _LISTED)}")


def _name(head: dict[str, Any]) -> str:
    return str(head["id1"]).strip()


def _described(head: dict[str, Any]) -> str:
    """A data set for a list: its name, type, quantity, and the place of the response."""
    code = int(head["rsp_dir"])
    direction = _DIRECTIONS[code] if abs(code) <= 6 else ""
    kind = _FUNCTIONS.get(head["func_type"], f"function of type {head['func_type']}")
    quantity = _QUANTITIES.get(head["ordinate_spec_data_type"], "")
    return f"{shown(_name(head))}, {kind}{f' of {quantity}' if quantity else ''} at {head['rsp_node']}{direction}"


def _check(of: dict[str, Any], number: int) -> None:
    """Refuse a function that is no real function of time, or has not as many values as it says."""
    kind, over = of["func_type"], _QUANTITIES.get(of["abscissa_spec_data_type"], "")
    if kind not in (0, 1) or over not in ("", "time"):
        name = _FUNCTIONS.get(kind, f"function of type {kind}")
        raise _UnreadableError(f"data set {number} is a {name} over {over or 'its abscissa'}; a record is over time")
    if np.iscomplexobj(of["data"]):
        raise _UnreadableError(f"data set {number} has complex values; a record is real")
    if not len(of["data"]) == len(of["x"]) == of["num_pts"]:
        raise _UnreadableError(
            f"data set {number} is damaged: it has {len(of['data'])} values, and should have {of['num_pts']}"
        )


def _unit_of_the_file(file: Any, quantity: str) -> str:
    """The unit of a quantity in the system of units of the file, by its data set 164; empty if there is none."""
    found = [i for i, kind in enumerate(file.get_set_types()) if kind == 164]
    if not found or not (quantity in _RATES or quantity == "force"):
        return ""
    of = file.read_sets(int(found[0]))
    factor, units = (of["force"], _FORCES) if quantity == "force" else (of["length"], _LENGTHS)
    near = [unit for size, unit in units.items() if abs(factor / size - 1) < _ROUNDED]
    unit = near[0] if near else f"{'N' if quantity == 'force' else 'm'}/{factor:g}"
    return unit + _RATES.get(quantity, "")
