"""Time series of a motion: chosen quantities at chosen places, at equidistant times, in memory and in files.

The default rate gives `PER_PERIOD` samples in a period of the fastest frequency in the answer, of its fastest mode or
its fastest force.  It is at least the rate of a record or a random signal that drives the beam.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.answers.history import History
from lapjoint.answers.quantities import QUANTITIES as OF_PLACES
from lapjoint.answers.quantities import checked_quantities
from lapjoint.errors import InputError
from lapjoint.files.netcdf import write_netcdf
from lapjoint.files.plain_text import no_formula
from lapjoint.files.writing import write_file
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.files import to_toml

if TYPE_CHECKING:
    import xarray as xr

FORMAT_VERSION = 1
"""Version of the NetCDF files; it rises with each change that makes an older reader misread a file."""
MOST_VALUES = 10_000_000
"""Largest number of values of all series together, 80 MB."""
PER_PERIOD = 2.56
"""Default number of samples in a period of the fastest frequency: more than the two that a sine needs; vibration
analysers use this number."""
FORCE = "force"
"""The only quantity of stops; all others are quantities of places."""
_ROUNDING = 1e-9
"""Largest distance of the last sample beyond the end of the motion that is rounding, in sampling intervals."""
_FORCE = "N", "force of the stop on the beam, positive upwards"
QUANTITIES = (*OF_PLACES, FORCE)
"""Names of the quantities."""


def time_series(
    history: History,
    *,
    at: Sequence[float] | None = None,
    quantities: Sequence[str] | None = None,
    rate: float | None = None,
) -> xr.Dataset:
    """Time series of quantities at places along the beam, and of the forces of the stops.

    Parameters
    ----------
    history : History
        The motion; for a steady state, its ``history``.
    at : sequence of float, optional
        Positions, m; by default the stops, and the ends that no support fixes.
    quantities : sequence of str, optional
        Names from `QUANTITIES`; by default the displacement and, if there are stops, the force.
    rate : float, optional
        Samples a second, Hz; by default enough for the fastest frequency in the answer.

    Returns
    -------
    xarray.Dataset
        A variable for each quantity, over ``x`` and ``time``, and the force over ``stop`` and ``time``, with units; the
        attributes are the title, the problem, the solver, the rate, and the reason for the rate.

    Raises
    ------
    InputError
        If a place is off the beam, a quantity is unknown, the problem lacks something that a quantity needs, the rate
        is not positive, or there would be more than `MOST_VALUES` values.
    """
    import xarray as xr

    problem = history.problem
    places, chosen = places_of(problem, at), _chosen(problem, quantities)
    rate, source = _default_rate(history) if rate is None else (rate, "as asked for")
    count = _count(problem, places, chosen, rate, history.end - history.start)
    t = np.minimum(history.start + np.arange(count) / rate, history.end)
    x = np.array(places)
    variables: dict[str, Any] = {}
    for name in chosen:
        if name == FORCE:
            values, (units, text), dimension = history.contact_force(t), _FORCE, "stop"
        else:
            quantity = OF_PLACES[name]
            values, units, text, dimension = quantity.of(history, x, t), quantity.units, quantity.text, "x"
        variables[name] = (dimension, "time"), values, {"units": units, "long_name": text}
    coordinates: dict[str, Any] = {
        "time": ("time", t, {"units": "s", "long_name": "time"}),
    } | place_coordinates(problem, x)
    if problem.stops:
        coordinates |= stop_coordinates(problem)
    attributes = {
        "Conventions": "CF-1.11",
        "format_version": FORMAT_VERSION,
        "title": f"Time series of: {problem.title or 'a joint'}",
        "problem": to_toml(problem, samples=False),  # an attribute holds 64 KB
        "solver": history.solver,
        "rate": float(rate),
        "rate_units": "Hz",
        "rate_source": source,
    }
    return xr.Dataset(variables, coords=coordinates, attrs=attributes)


def check_series(
    problem: Problem,
    *,
    at: Sequence[float] | None = None,
    quantities: Sequence[str] | None = None,
    rate: float | None = None,
    duration: float | None = None,
) -> None:
    """Refuse arguments that `time_series` would refuse, before the motion of a duration, s, is computed."""
    places, chosen = places_of(problem, at), _chosen(problem, quantities)
    if rate is not None:
        _count(problem, places, chosen, rate, duration or 0.0)


def write_series(series: xr.Dataset, path: str | Path) -> None:
    """Write time series as NetCDF or CSV, by the ending of `path`.

    A CSV file has one row for each time and one column for each series, with quantity, place or stop, and unit in its
    header.  A name that a spreadsheet would read as a formula is made harmless.  Only NetCDF holds the attributes.

    Parameters
    ----------
    series : xarray.Dataset
        From `time_series`.
    path : path
        The file, ``.nc`` or ``.csv``.

    Raises
    ------
    InputError
        If the path has another ending.
    OutputError
        If the file cannot be written, or the disk is full.
    """
    ending = Path(path).suffix.lower()
    if ending == ".nc":
        write_netcdf(series, path)
    elif ending == ".csv":
        columns = _columns(series)
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow([no_formula(name) for name in columns])
        writer.writerows(zip(*(values.tolist() for values in columns.values()), strict=True))
        write_file(path, out.getvalue())
    else:
        raise InputError(f"{path}: series are written as .nc or .csv, not {ending or 'without an ending'}")


def _columns(series: xr.Dataset) -> dict[str, FloatArray]:
    """The columns of a table by their headings, the times first, each of shape ``(m,)``."""
    columns = {"time [s]": series["time"].values}
    for name, variable in series.data_vars.items():
        units = written(variable.attrs["units"])
        of_stops = variable.dims[0] == "stop"
        wheres = [f"of {stop}" for stop in series["stop_name"].values] if of_stops else _headings(series)
        for where, values in zip(wheres, variable.values, strict=True):
            columns[f"{name} {where} [{units}]"] = values
    return columns


def _headings(series: xr.Dataset) -> list[str]:
    """Where each place is, as headings of a table say it."""
    if "place" in series.coords:
        return [f"at {place}" for place in series["place"].values]
    return [f"at x = {float(x)!r} m" for x in series["x"].values]


def stop_coordinates(problem: Problem) -> dict[str, Any]:
    """The coordinates of stops: the name of each, by which `sel` finds it, and `stop_name`, the same, which files of
    format version 3 always had."""
    names = np.array(problem.stop_names, dtype=object)
    return {name: (("stop",), names, {"long_name": "name of the stop"}) for name in ("stop", "stop_name")}


def place_coordinates(problem: Problem, x: FloatArray) -> dict[str, Any]:
    """The coordinates of places, m, ``(n,)``, as a dataset has them; of several beams with their places as text.

    `stop_x` is the place of each stop, by which `sel` finds there what varies along x.
    """
    line = problem.line
    about = "position on the line of beams" if line.several else "position from the root"
    found: dict[str, Any] = {"x": (("x",), x, {"units": "m", "long_name": about})}
    if line.several:
        names = np.array([line.place(float(one)) for one in x], dtype=object)
        found["place"] = ("x",), names, {"long_name": "beam, and position on it in m"}
    if problem.stops:
        places = np.array([stop.reading[0][0] for stop in problem.structure.stops])
        about = "position of the stop; of one between two beams, on the first"
        found["stop_x"] = ("stop",), places, {"units": "m", "long_name": about}
    return found


def written(units: str) -> str:
    """Units of the CF conventions in the usual notation: ``m s-2`` as ``m/s2``."""
    return re.sub(r" ([a-z]+)-(\d)", lambda power: f"/{power[1]}{power[2].replace('1', '')}", units)


def places_of(problem: Problem, at: Sequence[float] | None) -> list[float]:
    """The places `at` or, by default, the stops and the ends that no support fixes, m, each once."""
    if at is None:
        line = problem.line
        fixed = {support.x for support in problem.structure.supports if math.isinf(support.translational)}
        free = [end for end in line.edges if end not in fixed]
        stops = {x for stop in problem.structure.stops for x, _ in stop.reading}
        return sorted({*free, *stops}) or [(a + b) / 2 for a, b in zip(line.starts, line.ends, strict=True)]
    if not len(at):
        raise InputError("at: names no place; one or more are needed")
    return list(dict.fromkeys(problem.position(x) for x in at))


def _chosen(problem: Problem, quantities: Sequence[str] | None) -> list[str]:
    """The given quantities or, by default, the displacement and, if there are stops, the force; each once."""
    if quantities is None:
        return ["displacement", FORCE] if problem.structure.stops else ["displacement"]
    chosen = checked_quantities(problem, quantities, QUANTITIES)
    if FORCE in chosen and not problem.structure.stops:
        raise InputError(f"quantity {FORCE!r}: there are no stops")
    return chosen


def _default_rate(history: History) -> tuple[float, str]:
    """The default rate, Hz, and a phrase that gives its reason."""
    if history.highest_mode is None:
        raise InputError(f"rate: {history.solver} does not say how fast its fastest mode is; give a rate, in Hz")
    forces = history.problem.forces
    fastest = max(history.highest_mode, forces.fastest)
    if not fastest:
        raise InputError("rate: nothing vibrates in this motion; give a rate, in Hz")
    whose = "mode of the solver" if fastest == history.highest_mode else "force"
    text = (
        f"{PER_PERIOD:g} samples in a period of the fastest frequency of the answer, {fastest:.6g} rad/s of a {whose}"
    )
    rate = PER_PERIOD * fastest / (2 * math.pi)
    sampled = 0.0 if forces.ramps is None else forces.ramps.rate
    whose = "the random excitation" if history.problem.random else "the record of the excitation"
    return (rate, text) if rate >= sampled else (sampled, f"as many as {whose} has")


def _count(problem: Problem, places: list[float], chosen: list[str], rate: float, duration: float) -> int:
    """The number of times, if it and the rate are allowed."""
    if not 0 < rate < math.inf:
        raise InputError(f"rate = {rate:g}: must be positive and finite, in Hz")
    series = sum(len(problem.stops) if name == FORCE else len(places) for name in chosen)
    times = rate * duration + _ROUNDING
    if (times + 1) * series > MOST_VALUES:
        raise InputError(
            f"rate = {rate:g} Hz: over {duration:g} s it gives {times:.3g} samples of each of {series} series; "
            f"allowed are {MOST_VALUES:g} samples in all"
        )
    return math.floor(times) + 1
