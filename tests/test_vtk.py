"""What is written for ParaView by one library is read back by another, and is the history."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from lapjoint import History, InputError
from lapjoint.vtk import export_series


def read(path: Path, time: float) -> tuple[object, list[float]]:
    """The mesh at a time, read by VTK's own reader, and all times of the series."""
    import pyvista

    reader = pyvista.PVDReader(str(path))
    reader.set_active_time_value(time)
    return reader.read()[0], list(reader.time_values)


def test_the_series_holds_every_field_of_the_history_at_every_time(history: History, tmp_path: Path) -> None:
    times = np.array([0.0, 0.1, 0.25, 0.77, 1.0])
    path = export_series(history, tmp_path / "out", times=times, points=7)
    for time in times:
        mesh, found = read(path, time)
        assert found == times.tolist()
        x, zero = mesh.points[:, 0], np.zeros(mesh.n_points)
        np.testing.assert_array_equal(mesh.points[:, 1:], 0.0)
        expected = {
            "displacement": np.column_stack([zero, zero, history.displacement(x, time)[:, 0]]),
            "velocity": np.column_stack([zero, zero, history.velocity(x, time)[:, 0]]),
            "slope": history.slope(x, time)[:, 0],
            "moment": history.moment(x, time)[:, 0],
            "shear": history.shear(x, time)[:, 0],
            "contact_force": np.column_stack([zero, zero, np.where(x == 1.0, history.contact_force(time).sum(), 0.0)]),
        }
        assert set(mesh.point_data) == set(expected)
        for name, values in expected.items():
            np.testing.assert_array_equal(mesh.point_data[name], values, err_msg=f"{name} at {time}")


def test_the_stops_are_points_behind_their_gaps_with_their_forces(history: History, tmp_path: Path) -> None:
    export_series(history, tmp_path, times=np.array([0.25, 0.75]))
    mesh, _ = read(tmp_path / "stops.pvd", 0.75)
    np.testing.assert_array_equal(mesh.points, [[1.0, 0.0, 1e-3], [1.0, 0.0, -1e-3]])
    np.testing.assert_array_equal(mesh.point_data["contact_force"][:, 2], history.contact_force(0.75)[:, 0])
    np.testing.assert_array_equal(mesh.point_data["closed"], [0, 1])
    # 3 mm of swing behind a gap of 1 mm; one rounding in k times z over k.
    np.testing.assert_allclose(mesh.point_data["penetration"], [0.0, 2e-3], rtol=1e-14)


def test_default_frames_are_equidistant_and_hold_every_switch(history: History, tmp_path: Path) -> None:
    _, times = read(export_series(history, tmp_path, frames=11), 0.0)
    expected = sorted({*np.linspace(0, 1, 11).tolist(), *history.switch_times.tolist()})
    assert times == expected


def test_every_stop_and_support_is_among_the_points(history: History, tmp_path: Path) -> None:
    moved = history.problem.stops[0].model_copy(update={"x": 0.3137})
    problem = history.problem.replace(stops=(moved, history.problem.stops[1]))
    other = History(**{**history.__dict__, "problem": problem})
    mesh, _ = read(export_series(other, tmp_path, frames=2, points=5), 0.0)
    np.testing.assert_array_equal(mesh.points[:, 0], [0.0, 0.25, 0.3137, 0.5, 0.75, 1.0])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"frames": 1}, "frames = 1"),
        ({"frames": 10**9}, "frames = 1000000000"),
        ({"points": 1}, "points = 1"),
        ({"times": np.array([2.0])}, "times"),
        ({"times": np.array([np.nan])}, "times"),
    ],
)
def test_bad_arguments_are_refused(
    history: History, tmp_path: Path, arguments: dict[str, object], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        export_series(history, tmp_path, **arguments)  # type: ignore[arg-type]


def test_a_directory_that_cannot_be_made_is_refused(history: History, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        export_series(history, tmp_path / "file" / "out")
