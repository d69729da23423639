"""Files for ParaView and films: one steady cycle of the paper's joint, with the frames that the motion needs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import analytic
from lapjoint import History, paper_joint
from lapjoint.scene import Look, export_motion, save_film


@pytest.fixture(scope="module")
def motion() -> History:
    """One cycle at 515 rad/s."""
    return analytic.Solver().steady_state(paper_joint(), errors=False).history


@pytest.mark.parametrize("kind", ["pvd", "vtkhdf", "xdmf"])
@pytest.mark.benchmark(group="export of 200 frames and the switches")
def bench_export(benchmark: Any, motion: History, tmp_path: Path, kind: Any) -> None:
    path = benchmark.pedantic(export_motion, (motion, tmp_path), {"format": kind, "frames": 200}, rounds=3)
    files = [file for file in tmp_path.rglob("*") if file.is_file()]
    benchmark.extra_info["files"] = len(files)
    benchmark.extra_info["megabytes"] = round(sum(file.stat().st_size for file in files) / 1e6, 1)
    assert path.is_file()


@pytest.mark.parametrize("kind", ["pvd", "vtkhdf"])
@pytest.mark.benchmark(group="all 200 frames and the switches read again by VTK")
def bench_reading(benchmark: Any, motion: History, tmp_path: Path, kind: Any) -> None:
    path = export_motion(motion, tmp_path, format=kind, frames=200)
    read = {"pvd": read_pvd, "vtkhdf": read_vtkhdf}[kind]
    assert benchmark.pedantic(read, (path,), rounds=3) == 200 + motion.switch_times.size


@pytest.mark.benchmark(group="film of 48 frames")
def bench_film(benchmark: Any, motion: History, tmp_path: Path) -> None:
    look = Look(size=(760, 340))
    benchmark.pedantic(save_film, (motion, tmp_path / "film.gif"), {"frames": 48, "look": look}, rounds=2)


def read_pvd(path: Path) -> int:
    import pyvista

    reader = pyvista.get_reader(str(path))
    for time in reader.time_values:
        reader.set_active_time_value(time)
        reader.read()
    return len(reader.time_values)


def read_vtkhdf(path: Path) -> int:
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    for time in times:
        reader.UpdateTimeStep(time)
    return len(times)
