"""The motion as files that ParaView opens: two series of ``.vtu`` files, each with a ``.pvd`` that dates them.

``motion.pvd`` is the beam, as line cells between points along x.  Its points lie on the undisplaced axis, so
that the filter Warp By Vector with ``displacement`` shows the motion at any scale.  Point data:

================== ============= ======================================================
name               unit          meaning
================== ============= ======================================================
``displacement``   m             vector (0, 0, z), relative to the base
``velocity``       m/s           vector (0, 0, z_t), relative to the base
``slope``          rad           z_x
``moment``         N m           EI z_xx
``shear``          N             EI z_xxx, to the left of a concentrated force
``contact_force``  N             vector, sum of the stops at this point on the beam; zero elsewhere
================== ============= ======================================================

``stops.pvd`` is the stops, as vertex cells at ``(x, 0, +-gap)``, in the order of the problem.  Point data:
``contact_force`` (N, vector, on the beam), ``penetration`` (m, how far the beam has pressed the stop),
``closed`` (1 or 0) and ``stop`` (index from 0).
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem
from lapjoint.solution import History

MOST_FRAMES = 100_000
MOST_POINTS = 100_000


def export_series(
    history: History,
    directory: str | Path,
    times: FloatArray | None = None,
    points: int = 81,
    frames: int = 200,
) -> Path:
    """Write a history for ParaView.

    Parameters
    ----------
    history : History
        The motion.
    directory : path
        Where the files go; made if it is not there.  Files of an earlier export are overwritten.
    times : ndarray, optional
        Times of the frames, s, shape ``(m,)``, within the history; by default `frames` equidistant times and
        every switch of the contact state.
    points : int
        Equidistant points along the beam, at least 2; the positions of supports and stops are added.
    frames : int
        Number of equidistant times where `times` is not given, at least 2.

    Returns
    -------
    Path
        The file to open, ``motion.pvd``.

    Raises
    ------
    InputError
        If a parameter is out of its range, or the files cannot be written.
    """
    x = beam_points(history.problem, points)
    t = _frame_times(history, frames) if times is None else _given_times(history, times)
    folder = Path(directory)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _write_series(folder, "motion", t, _beam_frames(history, x, t))
        if history.problem.stops:
            _write_series(folder, "stops", t, _stop_frames(history, t))
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error.strerror or error}") from None
    return folder / "motion.pvd"


def check_sizes(points: int, frames: int) -> None:
    """Refuse numbers of points and frames that cannot be written.

    Raises
    ------
    InputError
        If `points` is not 2 to `MOST_POINTS`, or `frames` not 2 to `MOST_FRAMES`.
    """
    _check("points", points, MOST_POINTS)
    _check("frames", frames, MOST_FRAMES)


def _check(name: str, value: int, most: int) -> None:
    if not 2 <= value <= most:
        raise InputError(f"{name} = {value}: allowed are 2 to {most}")


def beam_points(problem: Problem, points: int) -> FloatArray:
    """Positions along the beam, m: `points` equidistant ones, and those of supports and stops.

    Raises
    ------
    InputError
        If `points` is less than 2 or more than `MOST_POINTS`.
    """
    _check("points", points, MOST_POINTS)
    L = problem.beam.length
    special = [support.x for support in problem.supports] + [stop.x for stop in problem.stops]
    grid = np.linspace(0.0, L, points)
    # A grid point closer than this to a special one gives way to it, so that no cell is degenerate.
    apart = np.all(np.abs(grid[:, None] - np.array(special)[None, :]) > 1e-9 * L, axis=1)
    return np.unique(np.concatenate([grid[apart], special]))


def _frame_times(history: History, frames: int) -> FloatArray:
    _check("frames", frames, MOST_FRAMES)
    times = np.union1d(np.linspace(history.start, history.end, frames), history.switch_times)
    if times.size > MOST_FRAMES:
        raise InputError(
            f"frames = {frames}: with {history.switch_times.size} switches that is more than {MOST_FRAMES} files"
        )
    return times


def _given_times(history: History, times: FloatArray) -> FloatArray:
    t = np.unique(np.asarray(times, dtype=float))
    if not 1 <= t.size <= MOST_FRAMES or not np.all((t >= history.start) & (t <= history.end)):
        raise InputError(
            f"times: allowed are 1 to {MOST_FRAMES} numbers within the history, {history.start:g} to {history.end:g} s"
        )
    return t


def _vertical(values: FloatArray) -> FloatArray:
    """Vectors along z, shape ``(n, 3)``, from their lengths, ``(n,)``."""
    return np.column_stack([np.zeros_like(values), np.zeros_like(values), values])


def _beam_frames(history: History, x: FloatArray, t: FloatArray) -> Any:
    """One meshio mesh of the beam for each time."""
    import meshio

    coordinates = np.column_stack([x, np.zeros_like(x), np.zeros_like(x)])
    cells = [("line", np.column_stack([np.arange(x.size - 1), np.arange(1, x.size)]))]
    at = [int(np.flatnonzero(x == stop.x)[0]) for stop in history.problem.stops]
    for time in t:
        force = np.zeros_like(x)
        np.add.at(force, at, history.contact_force(time)[:, 0])
        yield meshio.Mesh(
            coordinates,
            cells,
            point_data={
                "displacement": _vertical(history.displacement(x, time)[:, 0]),
                "velocity": _vertical(history.velocity(x, time)[:, 0]),
                "slope": history.slope(x, time)[:, 0],
                "moment": history.moment(x, time)[:, 0],
                "shear": history.shear(x, time)[:, 0],
                "contact_force": _vertical(force),
            },
        )


def _stop_frames(history: History, t: FloatArray) -> Any:
    """One meshio mesh of the stops for each time."""
    import meshio

    stops = history.problem.stops
    height = np.array([stop.sign * stop.gap for stop in stops])
    coordinates = _vertical(height)
    coordinates[:, 0] = [stop.x for stop in stops]
    cells = [("vertex", np.arange(len(stops))[:, None])]
    stiffness = np.array([stop.stiffness for stop in stops])
    for time in t:
        force = history.contact_force(time)[:, 0]
        state = history.state_at(float(time))
        yield meshio.Mesh(
            coordinates,
            cells,
            point_data={
                "contact_force": _vertical(force),
                "penetration": np.abs(force) / stiffness,
                "closed": np.array([int(i in state) for i in range(len(stops))]),
                "stop": np.arange(len(stops)),
            },
        )


def _write_series(folder: Path, name: str, t: FloatArray, meshes: Any) -> None:
    digits = 1 + int(math.log10(max(t.size - 1, 1)))
    entries = []
    for number, (time, mesh) in enumerate(zip(t, meshes, strict=True)):
        file = f"{name}_{number:0{digits}d}.vtu"
        mesh.write(folder / file, file_format="vtu")
        entries.append(f'    <DataSet timestep="{float(time)!r}" group="" part="0" file="{file}"/>\n')
    (folder / f"{name}.pvd").write_text(
        '<?xml version="1.0"?>\n<!-- SI units: m, s, rad, N, N m; time in s -->\n'
        '<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n  <Collection>\n'
        f"{''.join(entries)}  </Collection>\n</VTKFile>\n"
    )
