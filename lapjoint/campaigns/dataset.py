"""The dataset of a sweep, in memory and as NetCDF.

Its variables are listed in the README.  The contacts are a contiguous ragged array (CF 1.11, section 9.3.3): those
of one motion lie together along the dimension ``contact``, motion after motion in C order of the grid, and
``contact_count`` says how many each has.
"""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.answers.quantities import QUANTITIES
from lapjoint.answers.steady_state import Outcome
from lapjoint.campaigns.format_version import FORMAT_VERSION, attributes_of, refusal
from lapjoint.campaigns.plan import Plan
from lapjoint.campaigns.point import CUT_AT_END, CUT_AT_START, FAILED, OUTCOME_CODES, Point
from lapjoint.errors import InputError
from lapjoint.files.netcdf import is_whole
from lapjoint.files.reading import read_file
from lapjoint.summaries.of_orbit import OF_STOPS

if TYPE_CHECKING:
    import xarray as xr

SAME_MOTION = 1e-3
"""Two motions are the same if their impulses differ by at most this, relative to the largest impulse at the point:
more than the numerical error of an impulse, and less than different motions differ."""

_HDF5 = b"\x89HDF\r\n\x1a\n"
"""First bytes of a NetCDF-4 file, which is an HDF5 file."""
_DAMAGED = "is damaged: its content does not fit its checksum; what made it, with --force, computes it again"

Variable = tuple[tuple[str, ...], Any, dict[str, Any]]
"""Dimensions, values and attributes, as xarray takes them."""
_LEADING = "the Floquet multiplier of largest modulus; of a conjugate pair, the one with the positive imaginary part"
# Each entry has the name of the variable, which is also that of the field of `Point`, its type, units and meaning.
_SCALARS: tuple[tuple[str, str, str, str], ...] = (
    ("period_multiple", "i4", "1", "excitation periods after which the motion repeats; 0: it was not found to repeat"),
    ("residual", "f8", "1", "distance between start and end of the motion, relative to its size"),
    ("multiplier_real", "f8", "1", f"real part of {_LEADING}"),
    ("multiplier_imag", "f8", "1", f"imaginary part of {_LEADING}"),
    ("exponent", "f8", "s-1", "largest Lyapunov exponent, measured where the motion does not repeat"),
    ("standard_error", "f8", "s-1", "standard error of the largest Lyapunov exponent"),
    ("duration", "f8", "s", "duration of the motion whose contacts are kept"),
)
_ERROR = "estimate of the numerical error of: {}"
_GROWTH = ("growth", "f8", "1", "largest factor by which a deviation grew on the way to the motion")
_CONTACTS: tuple[tuple[str, str, str, str], ...] = (
    ("contact_stop", "i4", "", "index of the stop, from 0"),
    ("contact_start", "f8", "s", "time of impact, since the start of the motion that is kept"),
    ("contact_duration", "f8", "s", "time in contact"),
    ("contact_impulse", "f8", "N s", "time integral of the stop's force; positive at the top, negative at the bottom"),
    ("contact_peak_force", "f8", "N", "largest force of the stop"),
    ("contact_cut", "i1", "", "whether the contact is cut by the start or the end of the motion that is kept"),
)


def dataset_of(plan: Plan, points: Mapping[int, Point]) -> xr.Dataset:
    """The dataset of a sweep whose points are all done.

    Parameters
    ----------
    plan : Plan
        The sweep.
    points : mapping of int to Point
        What was found for each cell.

    Returns
    -------
    xarray.Dataset
        The dataset; the README lists its variables with their units.
    """
    import xarray as xr

    ordered = [points[cell] for cell in range(plan.size)]
    grid = tuple(axis.name for axis in plan.grid.axes) + (("start",) if plan.has_starts else ())
    variables = {
        **_stops(plan),
        **_impulse(plan, grid, ordered),
        **_certificate(plan, grid, ordered),
        **_contacts(plan, grid, ordered),
        **_summary(plan, grid, ordered),
    }
    if plan.has_starts:
        variables["distinct"] = _distinct(plan, grid, ordered)
    return xr.Dataset(variables, coords=_coordinates(plan), attrs=_attributes(plan))


def _coordinates(plan: Plan) -> dict[str, Variable]:
    found: dict[str, Variable] = {}
    for axis in plan.grid.axes:
        name = "excitation angular frequency" if axis.name == "angular_frequency" else axis.path
        attributes = {"units": axis.units, "long_name": name, "path": axis.path}
        found[axis.name] = (axis.name,), np.array(axis.values), attributes
    if plan.has_starts:
        text = "number of the start; 0 is the problem's own initial state, the others are random"
        text = "number of the random start" if plan.start == "random" else text
        found["start"] = ("start",), np.arange(plan.starts, dtype="i4"), {"units": "1", "long_name": text}
    names = np.array(plan.grid.problem.stop_names, dtype=object)
    found["stop_name"] = ("stop",), names, {"long_name": "name of the stop"}
    return found


def _stops(plan: Plan) -> dict[str, Variable]:
    signs = np.array([stop.sign for stop in plan.grid.problem.stops], dtype="i1")
    meanings = {"flag_values": np.array([-1, 1], dtype="i1"), "flag_meanings": "bottom top"}
    return {"stop_side": (("stop",), signs, {"long_name": "side of the stop", **meanings})}


def _impulse(plan: Plan, grid: tuple[str, ...], points: list[Point]) -> dict[str, Variable]:
    none = (np.nan,) * len(plan.grid.problem.stops)
    text = "impulse of the stop over one excitation period; positive at the top, negative at the bottom"
    columns = {"impulse": ([point.impulses if point.outcome != FAILED else none for point in points], text)}
    if plan.errors:
        text = (
            "estimate of the numerical error of the impulse; infinite where none can be stated, the standard error of "
            "the mean where the motion does not repeat"
        )
        columns["impulse_error"] = [point.impulse_errors or none for point in points], text
    dimensions, shape = (*grid, "stop"), (*plan.shape, len(none))
    return {
        name: (dimensions, np.array(values, dtype=float).reshape(shape), {"units": "N s", "long_name": text})
        for name, (values, text) in columns.items()
    }


def _certificate(plan: Plan, grid: tuple[str, ...], points: list[Point]) -> dict[str, Variable]:
    def shaped(values: list[Any], kind: Any) -> Any:
        return np.array(values, dtype=kind).reshape(plan.shape)

    found: dict[str, Variable] = {}
    sentences = ["The solver gave up; see the variable message.", *(outcome.value for outcome in Outcome)]
    meanings = {
        "flag_values": np.array(list(OUTCOME_CODES.values()), dtype="i1"),
        "flag_meanings": " ".join(OUTCOME_CODES).lower(),
        "comment": " ".join(f"{name.lower()}: {s}" for name, s in zip(OUTCOME_CODES, sentences, strict=True)),
    }
    codes = shaped([OUTCOME_CODES[point.outcome] for point in points], "i1")
    found["outcome"] = grid, codes, {"long_name": "what the search for a steady state established", **meanings}
    for name, kind, units, text in (*_SCALARS, _GROWTH) if plan.sensitivity else _SCALARS:
        values = shaped([getattr(point, name) for point in points], kind)
        found[name] = grid, values, {"units": units, "long_name": text}
    yes_no = {"flag_values": np.array([0, 1], dtype="i1"), "flag_meanings": "no yes"}
    text = "whether half the motion's period mirrors it, z(x, t + T/2) = -z(x, t)"
    found["symmetric"] = grid, shaped([point.symmetric for point in points], "i1"), {"long_name": text, **yes_no}
    text = "why the solver gave up; empty where it did not"
    found["message"] = grid, shaped([point.message for point in points], object), {"long_name": text}
    return found


def _contacts(plan: Plan, grid: tuple[str, ...], points: list[Point]) -> dict[str, Variable]:
    counts = np.array([len(point.contacts) for point in points], dtype="i4").reshape(plan.shape)
    rows = [contact for point in points for contact in point.contacts]
    names = ", ".join(grid)
    attributes: dict[str, Any] = {
        "units": "1",
        "long_name": "number of contacts in the motion that is kept",
        "sample_dimension": "contact",
        "comment": "Contiguous ragged array: the contacts of each motion lie together along the dimension contact, "
        f"motion after motion in C order of ({names}), the last fastest. Those of the motion with the flat index i "
        "are contact_*[sum(contact_count.flat[:i]) : sum(contact_count.flat[:i + 1])].",
    }
    found: dict[str, Variable] = {"contact_count": (grid, counts, attributes)}
    for column, (name, kind, units, text) in enumerate(_CONTACTS):
        values = np.array([row[column] for row in rows], dtype=kind)
        found[name] = ("contact",), values, {"long_name": text} | ({"units": units} if units else {})
    found["contact_stop"][2]["comment"] = "index along the dimension stop"
    masks = np.array([CUT_AT_START, CUT_AT_END], dtype="i1")
    found["contact_cut"][2].update(flag_masks=masks, flag_meanings="cut_at_start cut_at_end")
    return found


def _summary(plan: Plan, grid: tuple[str, ...], points: list[Point]) -> dict[str, Variable]:
    """The further numbers that were asked for: of quantities, the largest along the beam and where it is."""
    found: dict[str, Variable] = {}
    stops = len(plan.grid.problem.stops)
    for name in plan.summary:
        if name in OF_STOPS:
            units, text = OF_STOPS[name]
            dimensions, kinds, width = (
                (*grid, "stop"),
                [("", text, units), ("_error", _ERROR.format(text), units)],
                stops,
            )
        else:
            quantity, _, kind = name.rpartition("_")
            one = QUANTITIES[quantity]
            what = "largest magnitude" if kind == "peak" else "root mean square"
            text = f"{what} of the {one.text}, where it is largest along the beam"
            where = f"position of {name} from the root"
            dimensions, width = grid, 1
            kinds = [("", text, one.units), ("_error", _ERROR.format(text), one.units), ("_x", where, "m")]
        nothing = [math.nan] * (len(kinds) * width)
        columns = np.array([point.summary.get(name, nothing) for point in points], dtype=float)
        shape = (*plan.shape, stops) if name in OF_STOPS else plan.shape
        for i, (ending, text, units) in enumerate(kinds):
            if plan.errors or ending != "_error":
                values = columns[:, i * width : (i + 1) * width].reshape(shape)
                found[f"{name}{ending}"] = dimensions, values, {"units": units, "long_name": text}
    return found


def _distinct(plan: Plan, grid: tuple[str, ...], points: list[Point]) -> Variable:
    counts = [_motions(points[i : i + plan.starts]) for i in range(0, len(points), plan.starts)]
    text = (
        "number of different motions among the starts: by period multiple and impulses (mirror images count twice); "
        "all that do not repeat count as one"
    )
    attributes = {"units": "1", "long_name": text, "relative_tolerance": SAME_MOTION}
    return grid[:-1], np.array(counts, dtype="i4").reshape(plan.grid.shape), attributes


def _motions(points: list[Point]) -> int:
    """Number of different motions among points; points without an answer do not count."""
    found: list[Point] = []
    answers = [point for point in points if point.outcome != FAILED]
    size = max((abs(impulse) for point in answers for impulse in point.impulses), default=0.0)
    for point in answers:
        if not any(_same(point, other, SAME_MOTION * size) for other in found):
            found.append(point)
    return len(found)


def _same(one: Point, other: Point, tolerance: float) -> bool:
    if one.period_multiple != other.period_multiple:
        return False
    return one.period_multiple == 0 or bool(np.allclose(one.impulses, other.impulses, rtol=0.0, atol=tolerance))


def _attributes(plan: Plan) -> dict[str, Any]:
    return attributes_of(
        plan,
        f"Steady states of: {plan.grid.problem.title or 'a joint'}",
        problem=plan.identity["problem"],
        start=plan.start,
        starts=plan.starts,
        seed=plan.seed,
        sensitivity=int(plan.sensitivity),
        errors=int(plan.errors),
    )


def read_curve(path: str | Path) -> xr.Dataset:
    """Read the dataset of a sweep from a NetCDF file into memory.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    xarray.Dataset
        The dataset; the README lists its variables with their units.

    Raises
    ------
    InputError
        If there is no such file, it is not the result of a sweep, it is damaged, or an older or newer version of
        lapjoint wrote it in another format.
    """
    return read_result(path, Plan.noun)


def read_result(path: str | Path, *nouns: str) -> xr.Dataset:
    """Read the dataset of a sweep, or of other work that is done cell by cell, from a NetCDF file into memory.

    Parameters
    ----------
    path : str or Path
        The file.
    *nouns : str
        What the work may be called.

    Returns
    -------
    xarray.Dataset
        The dataset; its attribute ``result_of`` says what the work is called, where it is no sweep.

    Raises
    ------
    InputError
        If there is no such file, it is not the result of such work, it is damaged, or an older or newer version of
        lapjoint wrote it in another format.
    """
    import xarray as xr

    raw = read_file(path)
    if not is_whole(raw):
        raise InputError(f"{path}: {_reason_for(raw, ' or a '.join(nouns))}")
    found = xr.load_dataset(io.BytesIO(raw), engine="h5netcdf")
    if "fingerprint" not in found.attrs or found.attrs.get("result_of", Plan.noun) not in nouns:
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
