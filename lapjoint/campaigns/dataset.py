"""The common parts of the datasets of all campaigns: the format version, attributes, declared variables, and reading.

The version is raised whenever a reader of the version before would misread a file or its journal, or miss something in
it.
"""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.campaigns.grid import Axis
from lapjoint.campaigns.job import Spec
from lapjoint.campaigns.point import OUTCOME_CODES
from lapjoint.errors import InputError
from lapjoint.files.flags import flags
from lapjoint.files.netcdf import is_whole
from lapjoint.files.reading import read_file
from lapjoint.problem import Problem
from lapjoint.sampling.design import DRAWN, SAMPLE, Samples

if TYPE_CHECKING:
    import xarray as xr

FORMAT_VERSION = 3
"""Version of the files that are written, and the only one that is read.  Version 2 had no checksums.  Version 1 had
other names for `period_multiple`, `multiplier_real` and `multiplier_imag`, `standard_error` and `duration` too; its
datasets did not say that they were of version 1."""
SWEEP = "sweep"
"""Noun of a sweep, whose dataset has no attribute ``result_of``."""
_HDF5 = b"\x89HDF\r\n\x1a\n"
"""First bytes of a NetCDF-4 file, which is an HDF5 file."""
_DAMAGED = "is damaged: its content does not fit its checksum; what made it, with --force, computes it again"

Variable = tuple[tuple[str, ...], Any, dict[str, Any]]
"""Dimensions, values and attributes of a variable, as xarray takes them."""


@dataclass(frozen=True)
class Column:
    """The declaration of a variable: everything but its dimensions and values."""

    name: str
    kind: str
    """Type of the values, as numpy writes it; "O" for text."""
    units: str
    """Unit, as CF writes it; empty for text and for numbers that stand for names."""
    text: str
    """Description of the variable, its ``long_name``."""
    more: Mapping[str, Any] = field(default_factory=dict)
    """Further attributes."""
    value: Callable[[Any], Any] | None = None
    """Gives the value in a row of a table; by default, the value is the attribute of the row that has this name."""
    of_stops: bool = False
    """Whether there is a value for each stop."""
    text_first: bool = False
    """Whether files have the description before the unit."""

    @property
    def attributes(self) -> dict[str, Any]:
        """The attributes."""
        units, text = {"units": self.units} if self.units else {}, {"long_name": self.text}
        return {**(text | units if self.text_first else units | text), **self.more}

    def values(self, rows: Iterable[Any]) -> list[Any]:
        """The values in the rows of a table."""
        return [getattr(row, self.name) if self.value is None else self.value(row) for row in rows]

    def of(self, dimensions: tuple[str, ...], values: Any, shape: tuple[int, ...] | None = None) -> Variable:
        """The variable with these dimensions and values; the values are reshaped to `shape`, if it is given."""
        array = np.array(values, dtype=self.kind)
        return dimensions, array if shape is None else array.reshape(shape), self.attributes


def tabulated(
    dimension: str, columns: Iterable[Column], rows: Sequence[Any], stops: int = 0, prefix: str = ""
) -> dict[str, Variable]:
    """The variables of the rows of a table, which lie along a dimension; their names begin with `prefix`."""
    found = {}
    for column in columns:
        more, shape = (("stop",), (len(rows), stops)) if column.of_stops else ((), None)
        found[prefix + column.name] = column.of((dimension, *more), column.values(rows), shape)
    return found


OUTCOME_FLAGS = flags((name.lower() for name in OUTCOME_CODES), OUTCOME_CODES.values())
"""Attributes of a variable of outcomes."""


YES_NO = flags(("no", "yes"))
"""Attributes of a variable that is 1 where something is so."""
RESIDUAL = Column("residual", "f8", "1", "distance between start and end of the motion, relative to its size")
IMPULSE = Column(
    "impulse",
    "f8",
    "N s",
    "impulse of the stop over one excitation period; positive at the top, negative at the bottom",
    value=lambda motion: motion.impulses,
    of_stops=True,
)


def axis_coordinate(axis: Axis, text: str | None = None) -> Variable:
    """The values of an axis as a coordinate, named by `text` or by the path of the axis."""
    attributes = {"units": axis.units, "long_name": text or axis.path, "path": axis.path}
    return (axis.name,), np.array(axis.values), attributes


def sample_coordinates(problem: Problem, samples: Samples | None) -> dict[str, Variable]:
    """The numbers of the samples, the drawn value of each uncertain number, and the set and matrix of each sample; none
    without samples."""
    here = (SAMPLE,)
    if samples is None:
        return {}
    found = {SAMPLE: Column(SAMPLE, "i4", "1", "number of the sample").of(here, range(samples.size))}
    for i, one in enumerate(problem.uncertain):
        units = "1" if one.apply == "factor" else Axis(one.paths[0], (0.0,)).units
        text = f"{'factor on' if one.apply == 'factor' else 'value of'} {', '.join(one.paths)}"
        column = Column(DRAWN + one.name, "f8", units, text, {"distribution": one.kind})
        found[column.name] = column.of(here, [values[i] for values in samples.values])
    text = "independently scrambled set of points to which the sample belongs"
    found["sample_set"] = Column("sample_set", "i4", "1", text).of(here, samples.sets)
    text = "0: a point A; i: A with the i-th uncertain number of B; the largest, if not 0: B"
    found["sample_matrix"] = Column("sample_matrix", "i4", "1", text).of(here, samples.matrices)
    return found


def sample_attributes(samples: Samples | None) -> dict[str, Any]:
    """The attributes of a dataset that tell how samples were drawn; none without samples."""
    return {} if samples is None else {f"sample_{key}": value for key, value in samples.identity.items()}


def stop_sides(problem: Problem) -> Variable:
    """The side of each stop."""
    signs = [stop.sign for stop in problem.structure.stops]
    return Column("stop_side", "i1", "", "side of the stop", flags(("bottom", "top"), (-1, 1))).of(("stop",), signs)


def head() -> dict[str, Any]:
    """The first attributes of every dataset."""
    return {"Conventions": "CF-1.11", "format_version": FORMAT_VERSION}


def tail(spec: Spec) -> dict[str, Any]:
    """The last attributes of every dataset, the result of `spec`."""
    numbers = {f"version_{name}": number for name, number in spec.identity["versions"].items()}
    return {**numbers, "fingerprint": spec.fingerprint}


def attributes_of(spec: Spec, title: str, **own: Any) -> dict[str, Any]:
    """The attributes of a dataset, the result of `spec`: those of every dataset, and its `own`."""
    options = json.dumps(spec.identity["options"])
    return {**head(), "title": title, "solver": spec.solver, "options": options, **own, **tail(spec)}


def refusal(found: object) -> str:
    """Why a file of a format version is not read, as the rest of a sentence about it; empty if it can be read."""
    if found == FORMAT_VERSION:
        return ""
    whose = "a newer" if isinstance(found, Integral) and int(found) > FORMAT_VERSION else "an older"
    return f"is of format version {found}, which {whose} lapjoint wrote; this one reads version {FORMAT_VERSION} only"


def read_result(path: str | Path, *nouns: str) -> xr.Dataset:
    """Read the dataset of a campaign, of one of these nouns, from a NetCDF file into memory.

    The attribute ``result_of`` of the dataset is its noun, where it is no sweep.  InputError is raised if there is no
    such file, if it is the result of something else or damaged, or if it has another format version.
    """
    import xarray as xr

    raw = read_file(path)
    if not is_whole(raw):
        raise InputError(f"{path}: {_reason_for(raw, ' or a '.join(nouns))}")
    found = xr.load_dataset(io.BytesIO(raw), engine="h5netcdf")
    if "fingerprint" not in found.attrs or found.attrs.get("result_of", SWEEP) not in nouns:
        raise InputError(f"{path}: is not the result of a {' or a '.join(nouns)}")
    reason = refusal(found.attrs.get("format_version", 1))
    if reason:
        raise InputError(f"{path}: {reason}")
    del found.attrs["checksum"]
    return found


def _reason_for(raw: bytes, noun: str) -> str:
    """The reason for which a file without a right checksum is not read: it is damaged, older, or something else.

    It is found in the bytes, because HDF5 can run forever, or end the process, on a damaged file.
    """
    if not raw.startswith(_HDF5):
        return "cannot be read: is not a NetCDF-4 file"
    if b"fingerprint" not in raw:
        return f"is not the result of a {noun}, or only a part of it"
    if b"checksum" not in raw:
        return f"has no checksum, as an older lapjoint wrote it; this one reads format version {FORMAT_VERSION} only"
    return _DAMAGED
