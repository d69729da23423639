"""What one library writes for ParaView another reads back, value by value, and it is the motion."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import meshio
import numpy as np
import pytest
from beams import with_stops
from written_history import with_section

from lapjoint import (
    FREE,
    Beam,
    BeamSegment,
    Circle,
    ContactState,
    History,
    InputError,
    Mass,
    Material,
    Rectangle,
    Tube,
    paper_joint,
)
from lapjoint.answers import Modes
from lapjoint.errors import OutputError
from lapjoint.problem.beam import Section
from lapjoint.scene import export_modes, export_motion
from lapjoint.scene.scene import Scene, motion_scene

DEPTH = 0.02  # m
TIMES = [0.0, 0.1, 0.25, 0.77, 1.0]


class Read(NamedTuple):
    """What a reader finds of one part at one time."""

    points: Any
    point_data: dict[str, Any]
    cell_data: dict[str, Any]


def vtu_by_meshio(path: Path) -> dict[float, dict[str, Read]]:
    """All times and parts that a ``.pvd`` lists, its files read by meshio (VTK wrote them)."""
    found: dict[float, dict[str, Read]] = {}
    for entry in ET.parse(path).iter("DataSet"):
        mesh = meshio.read(path.parent / entry.attrib["file"])
        cells = {name: values[0] for name, values in mesh.cell_data.items()}
        here = found.setdefault(float(entry.attrib["timestep"]), {})
        here[entry.attrib["name"]] = Read(mesh.points, mesh.point_data, cells)
    return found


def vtkhdf_by_vtk(path: Path) -> dict[float, dict[str, Read]]:
    """The same of a VTKHDF file, read by VTK (h5py wrote it), forwards and backwards in time."""
    import pyvista
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader

    with h5py.File(path) as file:
        names = file["VTKHDF"].attrs["parts"].split(", ")
    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    found: dict[float, dict[str, Read]] = {}
    for time in (*times, *reversed(times)):
        reader.UpdateTimeStep(time)
        grid = pyvista.wrap(reader.GetOutputDataObject(0))
        found[time] = {}
        for number, name in enumerate(names):
            piece = grid.extract_cells(np.flatnonzero(grid.cell_data["part"] == number))
            order = np.argsort(piece.point_data["vtkOriginalPointIds"])
            cells = {key: np.asarray(values) for key, values in piece.cell_data.items()}
            point = {key: np.asarray(values)[order] for key, values in piece.point_data.items()}
            found[time][name] = Read(np.asarray(piece.points)[order], point, cells)
    return dict(sorted(found.items()))


def xdmf_by_vtk(path: Path) -> dict[float, dict[str, Read]]:
    """The same of XDMF series, read by VTK (meshio wrote them)."""
    import pyvista

    found: dict[float, dict[str, Read]] = {}
    for one in sorted(path.parent.glob("motion_*.xdmf")):
        reader = pyvista.XdmfReader(str(one))
        for time in reader.time_values:
            reader.set_active_time_value(time)
            mesh = reader.read()["TimeSeries_meshio"]
            data = [{k: np.asarray(v) for k, v in kept.items()} for kept in (mesh.point_data, mesh.cell_data)]
            found.setdefault(time, {})[one.stem.removeprefix("motion_")] = Read(np.asarray(mesh.points), *data)
    return found


FORMATS = {"pvd": vtu_by_meshio, "vtkhdf": vtkhdf_by_vtk, "xdmf": xdmf_by_vtk}


def expected(scene: Scene, times: list[float]) -> Iterator[tuple[float, str, Read]]:
    """What should be read."""
    block = scene.block(np.array(times))
    for (name, part), values in zip(scene.parts, block.values, strict=True):
        for i, time in enumerate(times):
            point = {key: array[i] for key, array in values.point.items()}
            cell = {key: array[i] for key, array in values.cell.items()}
            yield time, name, Read(part.points, point, cell)


@pytest.mark.parametrize("kind", FORMATS)
def test_another_library_reads_back_every_value_of_both_solvers_side_by_side(
    solid: History, tmp_path: Path, kind: Any
) -> None:
    both = {"analytic": solid, "fe": solid}
    path = export_motion(both, tmp_path / "out", format=kind, times=TIMES, points=7)
    switches = solid.switch_times.tolist()
    times = sorted({*TIMES, *switches})
    found = FORMATS[kind](path)
    assert list(found) == times
    for time, name, want in expected(motion_scene(both, points=7), times):
        have = found[time][name]
        np.testing.assert_array_equal(have.points, want.points)
        for wanted, had in ((want.point_data, have.point_data), (want.cell_data, have.cell_data)):
            for key, values in wanted.items():
                np.testing.assert_array_equal(had[key], values, err_msg=f"{name} {key} at {time}")


def test_meshio_opens_a_part_as_one_series(solid: History, tmp_path: Path) -> None:
    path = export_motion(solid, tmp_path, format="xdmf", times=TIMES)
    assert path.name == "motion_beam.xdmf"
    with meshio.xdmf.TimeSeriesReader(path) as series:
        points, cells = series.read_points_cells()
        time, point, _ = series.read_data(1)
    assert (time, cells[0].type) == (solid.switch_times[0], "line")
    np.testing.assert_array_equal(point["slope"], solid.slope(points[:, 0], time)[:, 0])


def test_pyvista_opens_all_parts_as_one_series(solid: History, tmp_path: Path) -> None:
    import pyvista

    reader = pyvista.get_reader(str(export_motion(solid, tmp_path, times=TIMES)))
    reader.set_active_time_value(0.25)
    blocks = reader.read()
    assert len(blocks) == 5  # beam, solid, stops, gaps, base need a stop, a section
    tip = blocks[0].point_data["displacement"][-1]
    np.testing.assert_array_equal(tip, [0.0, 0.0, solid.displacement(1.0, 0.25)[0, 0]])


@pytest.mark.parametrize("kind", ["pvd", "vtkhdf"])
def test_units_stand_with_the_values(solid: History, tmp_path: Path, kind: Any) -> None:
    path = export_motion(solid, tmp_path, format=kind, times=[0.25])
    units = {"displacement": "m", "velocity": "m/s", "slope": "rad", "moment": "N m", "bending_stress": "Pa"}
    if kind == "vtkhdf":
        with h5py.File(path) as file:
            found = {name: file[f"VTKHDF/PointData/{name}"].attrs["units"] for name in units}
    else:
        import pyvista
        from vtkmodules.vtkCommonCore import vtkDataArray

        data = pyvista.read(tmp_path / "motion" / "beam_000000.vtu").GetPointData()
        found = {name: data.GetArray(name).GetInformation().Get(vtkDataArray.UNITS_LABEL()) for name in units}
    assert found == units


def test_the_axis_carries_the_history(solid: History) -> None:
    scene = motion_scene(solid, points=7)
    (_, beam), t = scene.parts[0], 0.25
    x, values = beam.points[:, 0], scene.block(np.array([t])).values[0].point
    assert beam.points[:, 1:].any() == False  # noqa: E712
    np.testing.assert_array_equal(values["displacement"][0, :, 2], solid.displacement(x, t)[:, 0])
    np.testing.assert_array_equal(values["velocity"][0, :, 2], solid.velocity(x, t)[:, 0])
    for name in ("slope", "moment", "shear"):
        np.testing.assert_array_equal(values[name][0], getattr(solid, name)(x, t)[:, 0])
    # Top surface: M c / I with the sign of tension; one rounding.
    inertia = 0.05 * DEPTH**3 / 12
    np.testing.assert_allclose(
        values["bending_stress"][0], -solid.moment(x, t)[:, 0] * DEPTH / 2 / inertia, rtol=1e-14, atol=1e-6
    )
    force = np.where(x == 1.0, solid.contact_force(t).sum(), 0.0)
    np.testing.assert_array_equal(values["contact_force"][0, :, 2], force)


def test_what_is_seen_from_outside_moves_with_the_base() -> None:
    import analytic

    joint = paper_joint()
    motion = analytic.Solver(n_modes=4).simulate(joint, 0.004)
    t = np.array([0.001, 0.0035])
    base = joint.base_motion
    assert base is not None
    y = base.amplitude * np.sin(base.angular_frequency * t)
    scene = motion_scene(motion, points=5)
    for (name, _), values in zip(scene.parts, scene.block(t).values, strict=True):
        carried = values.point["displacement_absolute"] - values.point["displacement"]
        # y is added to displacements of the same size: rounding only.
        np.testing.assert_allclose(carried[:, :, 2], np.tile(y[:, None], carried.shape[1]), atol=1e-15, err_msg=name)
        assert not carried[:, :, :2].any()


@pytest.mark.parametrize(
    "section",
    [Rectangle(breadth=0.3, height=0.05), Circle(diameter=0.2), Tube(outer_diameter=0.2, inner_diameter=0.15)],
)
def test_the_solid_has_its_true_section(history: History, section: Section) -> None:
    import pyvista

    from lapjoint.scene.pvd import grid_of

    solid = dict(motion_scene(with_section(history, section), points=5).parts)["solid"]
    grid = grid_of(solid)
    # A polygon of 48 corners in place of a circle has 0.29 % less area, and 0.57 % less second moment.
    sizes = grid.compute_cell_sizes()["Volume"]
    assert sizes.min() > 0
    assert sizes.sum() == pytest.approx(section.area * 1.0, rel=3e-3)
    ends = grid.points[grid.points[:, 0] == 0.0]
    assert np.ptp(ends[:, 2]) == pytest.approx(section.depth, rel=1e-12)
    assert isinstance(grid, pyvista.UnstructuredGrid)


def test_bending_stress_over_the_section_makes_the_moment(solid: History) -> None:
    from lapjoint.scene.pvd import grid_of

    scene = motion_scene(solid, points=3)
    (at,) = [i for i, (name, _) in enumerate(scene.parts) if name == "solid"]
    stress = scene.block(np.array([0.25])).values[at].point["bending_stress"][0]
    grid = grid_of(scene.parts[at][1])
    root = grid.points[:, 0] == 0.0
    top = root & (grid.points[:, 2] == DEPTH / 2)
    # Linear over the height: M = -sigma_top W, with W = b h^2 / 6.
    np.testing.assert_allclose(-stress[top] * 0.05 * DEPTH**2 / 6, solid.moment(0.0, 0.25)[0, 0], rtol=1e-13)
    np.testing.assert_allclose(stress[root & (grid.points[:, 2] == 0)], 0.0, atol=1e-6)


def test_sections_stay_plane_and_at_right_angles_to_the_axis(solid: History) -> None:
    scene = motion_scene(solid, points=5)
    part = dict(scene.parts)["solid"]
    values = scene.block(np.array([0.3])).values[1].point
    x, height = part.points[:, 0], part.points[:, 2]
    np.testing.assert_array_equal(values["displacement"][0, :, 0], -height * solid.slope(x, 0.3)[:, 0])
    np.testing.assert_array_equal(values["displacement"][0, :, 2], solid.displacement(x, 0.3)[:, 0])
    turning = solid.evaluate(x, 0.3, dx=1, dt=1)[:, 0]
    np.testing.assert_array_equal(values["velocity"][0, :, 0], -height * turning)


def test_a_beam_that_presses_a_stop_touches_it_at_every_scale(solid: History) -> None:
    scene = motion_scene(solid, points=5)
    parts = dict(scene.parts)
    times = np.array([0.1, 0.25, 0.75])
    values = dict(zip(parts, scene.block(times).values, strict=True))
    top = int(np.flatnonzero((parts["solid"].points == [1.0, 0.025, DEPTH / 2]).all(axis=1))[0])
    for scale in (1.0, 7.0):
        beam = parts["solid"].points[top, 2] + scale * values["solid"].point["displacement"][:, top, 2]
        face = parts["stops"].points[0, 2] + scale * values["stops"].point["displacement"][:, 0, 2]
        assert (face >= beam).all()
        assert face[1] == beam[1]
    np.testing.assert_array_equal(values["stops"].cell["closed"], [[1, 0], [1, 0], [0, 1]])
    # 3 mm of swing behind a gap of 1 mm; one rounding in k times z over k.
    np.testing.assert_allclose(values["stops"].cell["penetration"][1:], [[2e-3, 0.0], [0.0, 2e-3]], rtol=1e-14)
    np.testing.assert_allclose(values["gaps"].cell["opening"][1:], [[0.0, 4e-3], [4e-3, 0.0]], rtol=1e-14)


def test_the_second_motion_carries_its_difference_from_the_first(solid: History) -> None:
    def doubled(x: Any, t: Any, dx: int = 0, dt: int = 0) -> Any:
        return 2 * solid.field(x, t, dx, dt)

    other = replace(solid, field=doubled)
    scene = motion_scene({"one": solid, "two": other}, points=5)
    names = [name for name, _ in scene.parts]
    values = dict(zip(names, scene.block(np.array([0.3])).values, strict=True))
    for part in ("beam", "solid"):
        difference = values[f"two_{part}"].point["difference"]
        np.testing.assert_allclose(difference, values[f"one_{part}"].point["displacement"], rtol=1e-15)
        assert "difference" not in values[f"one_{part}"].point
    offsets = [layout.offset for layout in scene.layouts]
    assert offsets[1] < offsets[0] - 0.05


def test_a_beam_without_a_section_is_a_line(history: History, tmp_path: Path) -> None:
    scene = motion_scene(history)
    assert [name for name, _ in scene.parts] == ["beam", "stops", "gaps", "base"]
    assert "bending_stress" not in scene.block(np.array([0.25])).values[0].point
    found = vtu_by_meshio(export_motion(history, tmp_path, times=[0.25]))
    assert set(found[0.25]) == {"beam", "stops", "gaps", "base"}


def test_every_stop_and_support_is_among_the_points(history: History) -> None:
    other = replace(history, problem=with_stops(history.problem, {"x": 0.3137}))
    (_, beam) = motion_scene(other, points=5).parts[0]
    np.testing.assert_array_equal(beam.points[:, 0], [0.0, 0.25, 0.3137, 0.5, 0.75, 1.0])


@pytest.mark.parametrize("kind", FORMATS)
def test_modes_of_any_state_are_a_series_over_their_numbers(history: History, tmp_path: Path, kind: Any) -> None:
    problem = with_section(history).problem
    shapes = lambda x, derivative=0: np.array([x**2, x**3]) if derivative == 0 else np.zeros((2, x.size))  # noqa: E731
    states = [Modes(state, np.array([5.0, 9.0]), shapes) for state in (FREE, ContactState((1,)))]
    paths = export_modes(problem, states, tmp_path, format=kind, points=3)
    assert [path.name.split(".")[0].removesuffix("_beam") for path in paths] == ["modes_free", "modes_below"]
    if kind == "pvd":
        found = vtu_by_meshio(paths[1])
        assert list(found) == [1.0, 2.0]
        np.testing.assert_array_equal(found[2.0]["beam"].point_data["displacement"][:, 2], [0.0, 0.125, 1.0])
        assert meshio.read(tmp_path / "modes_below" / "beam_000001.vtu").field_data["angular_frequency"] == [9.0]
        # The spring of the closed stop pushes back with k times the shape at the tip.
        force = found[1.0]["stops"].cell_data["contact_force"][:, 2]
        np.testing.assert_allclose(force, [0.0, -1e4], rtol=1e-15)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"points": 1}, "points = 1"),
        ({"frames": 1}, "frames = 1"),
        ({"frames": 10**9}, "frames = 1000000000"),
        ({"times": [2.0]}, "times"),
        ({"times": [np.nan]}, "times"),
        ({"frames": 5, "times": [0.5]}, "not two of them"),
        ({"tolerance": 0.0}, "tolerance = 0"),
        ({"tolerance": 1e-12}, "allowed are 100000"),
        ({"format": "stl"}, "format = 'stl'"),
    ],
)
def test_bad_arguments_are_refused(history: History, tmp_path: Path, arguments: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        export_motion(history, tmp_path, **arguments)


def test_a_directory_that_cannot_be_made_is_refused(history: History, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for kind in FORMATS:
        with pytest.raises(OutputError, match="cannot be written"):
            export_motion(history, tmp_path / "file" / "out", format=kind)  # type: ignore[arg-type]


def files_in(folder: Path) -> dict[str, bytes]:
    """All files below a folder, hidden ones too, with their content."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


@pytest.mark.parametrize("kind", ["pvd", *(pytest.param(it, marks=pytest.mark.thorough) for it in ("vtkhdf", "xdmf"))])
def test_an_interrupted_export_leaves_the_series_of_before(solid: History, tmp_path: Path, kind: Any) -> None:
    def interrupt(done: float, total: float) -> None:
        raise KeyboardInterrupt

    for before in (False, True):
        if before:
            export_motion(solid, tmp_path, format=kind, frames=3)
        there = files_in(tmp_path)
        with pytest.raises(KeyboardInterrupt):
            export_motion(solid, tmp_path, format=kind, frames=20, progress=interrupt)
        assert files_in(tmp_path) == there
        assert bool(there) is before
        assert not [path for path in tmp_path.iterdir() if path.name.startswith(".")]


@pytest.mark.parametrize("kind", FORMATS)
def test_a_full_disk_is_said_before_it_is_met(
    solid: History, tmp_path: Path, kind: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    from lapjoint.scene import export

    monkeypatch.setattr(export, "ROOM", 10**18)
    with pytest.raises(OutputError, match="No space left"):
        export_motion(solid, tmp_path / "out", format=kind)
    assert list((tmp_path / "out").iterdir()) == []


def test_the_size_is_said_first_and_a_large_one_refused_unless_asked_for(
    solid: History, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from lapjoint.scene import export

    for kind in FORMATS:
        said: list[str] = []
        export_motion(solid, tmp_path / kind, format=kind, frames=12, say=said.append)
        files = [file for file in (tmp_path / kind).rglob("*") if file.is_file()]
        size = sum(file.stat().st_size for file in files) / 1e6
        number, _, told = said[0].partition(" files, about " if kind != "vtkhdf" else " file, about ")
        assert int(number.split()[-1]) == len(files)
        assert size / 3 < float(told.split()[0]) < 3 * size
    monkeypatch.setattr(export, "MOST_FILES", 20)
    there = files_in(tmp_path / "pvd")
    with pytest.raises(InputError, match="more than 500 MB or 20 files are written only with --large"):
        export_motion(solid, tmp_path / "pvd", frames=12)
    assert files_in(tmp_path / "pvd") == there
    export_motion(solid, tmp_path / "pvd", frames=12, large=True)


@pytest.mark.parametrize("in_the_way", ["motion", "motion.pvd", "motion/beam_000000.vtu"])
def test_what_is_in_the_way_of_a_series_is_left_alone(solid: History, tmp_path: Path, in_the_way: str) -> None:
    if in_the_way == "motion":
        (tmp_path / "motion").write_text("mine")
    else:
        (tmp_path / in_the_way / "mine").mkdir(parents=True)
    there = files_in(tmp_path)
    with pytest.raises(OutputError, match=r"cannot be written: (Is|Not) a directory"):
        export_motion(solid, tmp_path, frames=2)
    assert files_in(tmp_path) == there


def test_whatever_the_title_says_the_series_can_be_read(solid: History, tmp_path: Path) -> None:
    for title in ("a---b-", "bell \a & <tag> \x85"):
        problem = solid.problem.replace(title=title)
        motion = replace(solid, problem=problem)
        assert list(vtu_by_meshio(export_motion(motion, tmp_path, times=[0.0]))) == [0.0]
        path = export_motion(motion, tmp_path, format="vtkhdf", times=[0.0, 0.05])
        assert list(vtkhdf_by_vtk(path)) == [0.0, 0.05]


@pytest.mark.parametrize("kind", ["pvd", "xdmf"])
def test_an_export_leaves_no_part_of_another_joint_and_no_file_of_a_longer_series(
    solid: History, history: History, tmp_path: Path, kind: Any
) -> None:
    export_motion({"one": solid, "two": solid}, tmp_path / "out", format=kind, frames=9)
    (tmp_path / "out/motion").mkdir(exist_ok=True)
    (tmp_path / "out/motion/notes.txt").write_text("mine")
    export_motion(history, tmp_path / "out", format=kind, frames=2)
    export_motion(history, tmp_path / "new", format=kind, frames=2)
    assert files_in(tmp_path / "out") == files_in(tmp_path / "new") | {"motion/notes.txt": b"mine"}


def test_states_whose_stops_have_like_names_have_files_of_their_own(history: History, tmp_path: Path) -> None:
    problem = with_stops(history.problem, {"name": "a b"}, {"name": "a-b"})
    shapes = lambda x, derivative=0: np.zeros((1, x.size))  # noqa: E731
    states = [Modes(ContactState((i,)), np.array([5.0]), shapes) for i in (0, 1)]
    paths = export_modes(problem, states, tmp_path, format="vtkhdf")
    assert len(set(paths)) == 2
    with h5py.File(paths[0]) as file:
        assert file["VTKHDF/CellData/part"].attrs["units"] == "1"
        assert file["VTKHDF/PointData/displacement"].attrs["units"] == "m m-1 kg-1/2"


def test_a_motion_has_a_name_that_a_file_can_have(history: History, tmp_path: Path) -> None:
    for name in ("../x", "a/b", ""):
        with pytest.raises(InputError, match="names one; allowed are letters"):
            export_motion({name: history}, tmp_path)


def test_motions_without_a_time_in_common_are_refused(history: History, tmp_path: Path) -> None:
    later = replace(history, start=2.0, end=3.0)
    with pytest.raises(InputError, match="no time in common"):
        export_motion({"one": history, "two": later}, tmp_path)


@pytest.fixture
def stepped(history: History) -> History:
    """The motion of a beam of two sections, with a mass at the tip."""
    segments = (
        BeamSegment(to=0.4, section=Rectangle(breadth=0.05, height=0.04)),
        BeamSegment(to=1.0, section=Rectangle(breadth=0.05, height=DEPTH)),
    )
    beam = Beam(length=1.0, material=Material(youngs_modulus=2e11, density=7800.0), segments=segments)
    return replace(history, problem=history.problem.replace(beam=beam, masses=(Mass(x=1.0, mass=2.0),)))


def test_a_stepped_solid_has_the_section_of_each_piece_and_carries_its_moment(stepped: History) -> None:
    from lapjoint.scene.pvd import grid_of

    scene = motion_scene(stepped, points=5)
    (at,) = [i for i, (name, _) in enumerate(scene.parts) if name == "solid"]
    grid = grid_of(scene.parts[at][1])
    volume = 0.05 * (0.4 * 0.04 + 0.6 * DEPTH)
    assert grid.compute_cell_sizes()["Volume"].sum() == pytest.approx(volume, rel=1e-12)
    stress, moment = (
        scene.block(np.array([0.25])).values[at].point["bending_stress"][0],
        stepped.moment(0.4, 0.25)[0, 0],
    )
    for depth in (0.04, DEPTH):
        top = np.isclose(grid.points[:, 0], 0.4) & np.isclose(grid.points[:, 2], depth / 2)
        assert top.sum() == 2
        np.testing.assert_allclose(-stress[top] * 0.05 * depth**2 / 6, moment, rtol=1e-12)
    np.testing.assert_allclose(stepped.bending_stress(0.4, 0.25), -moment / (0.05 * DEPTH**2 / 6), rtol=1e-12)


def test_a_mass_moves_and_turns_with_the_beam_and_keeps_its_shape(stepped: History) -> None:
    scene = motion_scene(stepped, points=5)
    (at,) = [i for i, (name, _) in enumerate(scene.parts) if name == "masses"]
    rest, moved = scene.parts[at][1].points, scene.block(np.array([0.3])).values[at].point["displacement"][0]
    centre = moved.mean(axis=0)
    np.testing.assert_allclose(centre, [0.0, 0.0, stepped.displacement(1.0, 0.3)[0, 0]], atol=1e-15)
    slope = stepped.slope(1.0, 0.3)[0, 0]
    turned = np.column_stack([-slope * rest[:, 2], np.zeros(len(rest)), slope * (rest[:, 0] - 1.0)])
    np.testing.assert_allclose(moved - centre, turned, atol=1e-15)
