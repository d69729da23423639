"""Writes a scene as XDMF time series, one for each part, for meshio and programs that read its files.

meshio writes the files, and its reader opens a part as one series.  ParaView's "XDMF Reader" opens them too, but its
"Xdmf3 Reader" cannot read meshio's files.  XDMF holds no units; `lapjoint.scene.parts` lists them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import h5py

from lapjoint.files.writing import completed_series
from lapjoint.scene.parts import PARTS
from lapjoint.scene.scene import Block, Scene

_CELL_TYPES = {2: "line", 4: "quad", 8: "hexahedron"}


def write_xdmf(scene: Scene, blocks: Iterable[Block], folder: Path, name: str, note: str) -> Path:
    """Write ``NAME_PART.xdmf`` and ``NAME_PART.h5`` for each part, or no file at all; return the first part's file.

    Files of an earlier series of this name remain until the new series is complete.  The format cannot hold the note.
    """
    names = [f"{name}_{label}.xdmf" for label, _ in scene.parts]
    with completed_series(folder, lambda: _remove(folder, name)) as draft:
        _write_all(scene, blocks, [draft / each for each in names])
    return folder / names[0]


def _remove(folder: Path, name: str) -> None:
    """Remove the files of all parts of a series."""
    for part in PARTS:
        for pattern in (f"{name}_{part}", f"{name}_*_{part}", f"{name}_{part}_*", f"{name}_*_{part}_*"):
            for old in folder.glob(f"{pattern}.xdmf"):
                old.unlink()
                old.with_suffix(".h5").unlink(missing_ok=True)


def _write_all(scene: Scene, blocks: Iterable[Block], paths: Sequence[Path]) -> None:
    with ExitStack() as stack:
        series = [stack.enter_context(_series(path)) for path in paths]
        for writer, (_, part) in zip(series, scene.parts, strict=True):
            writer.write_points_cells(part.points, [(_CELL_TYPES[part.cells.shape[1]], part.cells)])
        for block in blocks:
            for writer, values in zip(series, block.values, strict=True):
                for at, time in enumerate(block.times):
                    point = {key: array[at] for key, array in values.point.items()}
                    cell = {key: [array[at]] for key, array in values.cell.items()}
                    writer.write_data(repr(float(time)), point_data=point, cell_data=cell)


def _series(path: Path) -> Any:
    """meshio's writer of a series, changed so that it writes its HDF5 file beside `path`, not in the current folder."""
    from meshio.xdmf import TimeSeriesWriter

    class Beside(TimeSeriesWriter):  # type: ignore[misc]
        def __enter__(self) -> Any:
            self.h5_filename = path.with_suffix(".h5").name
            self.h5_file = h5py.File(path.with_suffix(".h5"), "w")
            return self

    return Beside(path)
