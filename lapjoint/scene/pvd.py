"""Writes a scene as ``.vtu`` files, one for each part and time, and a ``.pvd`` file that lists them with their times.

ParaView opens the list as one series.  VTK writes the files.  The unit of an array is in VTK's key for units,
``UNITS_LABEL``.
"""

from __future__ import annotations

import errno
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from lapjoint.files.writing import completed_series
from lapjoint.scene.parts import Part
from lapjoint.scene.scene import Block, Scene

_CELL_TYPES = {2: "LINE", 4: "QUAD", 8: "HEXAHEDRON"}


def grid_of(part: Part) -> Any:
    """A part at rest as a grid without values."""
    import pyvista

    kind = getattr(pyvista.CellType, _CELL_TYPES[part.cells.shape[1]])
    return pyvista.UnstructuredGrid({kind: part.cells}, part.points)


def write_pvd(scene: Scene, blocks: Iterable[Block], folder: Path, name: str, note: str) -> Path:
    """Write ``NAME.pvd``, and the files that it lists in the folder NAME beside it; return the path of ``NAME.pvd``.

    Files of an earlier series of this name remain until the new series is complete.  The list has a comment, the note.
    """
    path = folder / f"{name}.pvd"
    with completed_series(folder, lambda: _remove(folder, name)) as draft:
        (draft / name).mkdir()
        entries = _write_pieces(scene, blocks, draft, name)
        (draft / path.name).write_text(
            f'<?xml version="1.0"?>\n<!-- {re.sub("-(?=-)", "- ", note)} -->\n'
            '<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n  <Collection>\n'
            f"{''.join(entries)}  </Collection>\n</VTKFile>\n",
            encoding="utf-8",
        )
    return path


def _remove(folder: Path, name: str) -> None:
    """Remove the files of a series, and their folder if there is nothing else in it."""
    (folder / f"{name}.pvd").unlink(missing_ok=True)
    pieces = folder / name
    for old in pieces.glob("*_[0-9][0-9][0-9][0-9][0-9][0-9].vtu"):
        old.unlink()
    if pieces.is_dir() and not any(pieces.iterdir()):
        pieces.rmdir()


def _write_pieces(scene: Scene, blocks: Iterable[Block], folder: Path, name: str) -> list[str]:
    """Write a file for each part and time; return the lines of the list."""
    grids = [(label, grid_of(part)) for label, part in scene.parts]
    entries: list[str] = []
    number = 0
    for block in blocks:
        for at, time in enumerate(block.times):
            for place, (label, grid) in enumerate(grids):
                file = f"{name}/{label}_{number:06d}.vtu"
                _fill(grid, block, place, at, scene)
                _write(grid, folder / file)
                entries.append(_entry(float(time), place, label, file))
            number += 1
    return entries


def _entry(time: float, place: int, label: str, file: str) -> str:
    return (
        f'    <DataSet timestep="{time!r}" group="" part="{place}" name={quoteattr(label)} file={quoteattr(file)}/>\n'
    )


def _fill(grid: Any, block: Block, place: int, at: int, scene: Scene) -> None:
    """Give the grid the values of the part number `place` at the time number `at`, each with its unit."""
    from vtkmodules.vtkCommonCore import vtkDataArray

    values = block.values[place]
    whole = {name: array[:, None] for name, array in block.whole.items()}
    for data, arrays in ((grid.point_data, values.point), (grid.cell_data, values.cell), (grid.field_data, whole)):
        for name, array in arrays.items():
            data[name] = np.ascontiguousarray(array[at])
            data.GetAbstractArray(name).GetInformation().Set(vtkDataArray.UNITS_LABEL(), scene.unit(name))


def _write(grid: Any, path: Path) -> None:
    from vtkmodules.vtkCommonCore import vtkObject
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    writer = vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetFileName(str(path))
    writer.SetDataModeToBinary()
    writer.SetCompressorTypeToZLib()
    shown = vtkObject.GetGlobalWarningDisplay()
    vtkObject.SetGlobalWarningDisplay(0)  # VTK would print its own message about a full disk
    try:
        written = writer.Write() and not writer.GetErrorCode()
    finally:
        vtkObject.SetGlobalWarningDisplay(shown)
    if not written:
        raise OSError(errno.EIO, f"VTK could not write {path.name}")
