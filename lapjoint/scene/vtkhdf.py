"""Writes a scene as one VTKHDF file (version 2.3 of the format): all parts in one unstructured grid, at all times.

The fixed points and cells are stored once.  The cell value ``part`` tells the parts apart: it counts from 0 in the
order of the attribute ``parts``.  Values that a part does not carry are NaN, or -1 for integers.  The attribute
``units`` of a dataset is its unit.

h5py writes the file, by the description of the format in VTK's documentation.  VTK's own writer (9.7) stores times in
single precision, in which both ends of a short contact are equal.  The parts are in one grid, not in separate blocks,
because the reader of VTK 9.7 shows the first time step of blocks at all times.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from lapjoint.files.writing import completed
from lapjoint.scene.parts import Arrays, Part
from lapjoint.scene.scene import Block, Scene

VERSION = (2, 3)
"""Version of the format."""
_TYPE = "UnstructuredGrid"
_CELL_TYPES = {2: 3, 4: 9, 8: 12}  # VTK_LINE, VTK_QUAD, VTK_HEXAHEDRON
_FIXED = ("PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets")


def write_vtkhdf(scene: Scene, blocks: Iterable[Block], folder: Path, name: str, note: str) -> Path:
    """Write ``NAME.vtkhdf``, with a note as an attribute; the file gets its name when it is complete."""
    path = folder / f"{name}.vtkhdf"
    parts = [part for _, part in scene.parts]
    with completed(path) as unfinished, h5py.File(unfinished, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = VERSION
        root.attrs.create("Type", _TYPE.encode(), dtype=h5py.string_dtype("ascii", len(_TYPE)))
        root.attrs["note"] = note
        root.attrs["parts"] = ", ".join(label for label, _ in scene.parts)
        _write_grid(root, parts)
        _start_steps(root)
        for block in blocks:
            _append(root, block, parts, scene)
    return path


def _write_grid(root: Any, parts: Sequence[Part]) -> None:
    """Write the fixed points and cells of all parts."""
    first = np.cumsum([0, *(len(part.points) for part in parts)])
    corners = np.concatenate([np.full(len(part.cells), part.cells.shape[1]) for part in parts])
    root["Points"] = np.concatenate([part.points for part in parts])
    root["Points"].attrs["units"] = "m"
    root["Connectivity"] = np.concatenate([part.cells.ravel() + at for part, at in zip(parts, first, strict=False)])
    root["Offsets"] = np.cumsum([0, *corners])
    root["Types"] = np.array([_CELL_TYPES[number] for number in corners], dtype=np.uint8)
    for number, of in (("NumberOfPoints", "Points"), ("NumberOfCells", "Types")):
        root[number] = [len(root[of])]
    root["NumberOfConnectivityIds"] = [len(root["Connectivity"])]


def _start_steps(root: Any) -> None:
    """Make the empty tables of the time steps; fixed points and cells have the offset 0 in each step."""
    for data in ("PointData", "CellData", "FieldData"):
        root.create_group(data)
        root.create_group(f"Steps/{data}Offsets")
    steps = root["Steps"]
    steps.create_group("FieldDataSizes")
    steps.attrs["NSteps"] = 0
    steps.create_dataset("Values", (0,), np.float64, maxshape=(None,)).attrs["units"] = "s"
    for name in (*_FIXED, "NumberOfParts"):
        steps.create_dataset(name, (0,), np.int64, maxshape=(None,))


def _append(root: Any, block: Block, parts: Sequence[Part], scene: Scene) -> None:
    """Append the values at the times of a block."""
    steps, number = root["Steps"], block.times.size
    first = int(steps.attrs["NSteps"])
    steps.attrs["NSteps"] = first + number
    _extend(steps, "Values", block.times)
    _extend(steps, "NumberOfParts", np.ones(number, dtype=np.int64))
    for name in _FIXED:
        _extend(steps, name, np.zeros(number, dtype=np.int64))
    point = _joined([values.point for values in block.values], [len(part.points) for part in parts], number)
    cell = _joined([values.cell for values in block.values], [len(part.cells) for part in parts], number)
    cell["part"] = np.tile(np.repeat(np.arange(len(parts)), [len(part.cells) for part in parts]), (number, 1))
    whole = {name: values[:, None] for name, values in block.whole.items()}
    for data, arrays in (("PointData", point), ("CellData", cell), ("FieldData", whole)):
        for name, values in arrays.items():
            _extend(root[data], name, values.reshape(-1, *values.shape[2:]), scene.unit(name))
            _extend(steps[f"{data}Offsets"], name, values.shape[1] * np.arange(first, first + number))
    for name in whole:
        _extend(steps["FieldDataSizes"], name, np.ones((number, 2), dtype=np.int64))  # components, tuples


def _joined(carried: Sequence[Arrays], sizes: Sequence[int], number: int) -> Arrays:
    """The values of all parts side by side, shape (number, points or cells of all parts).

    Values that a part does not carry are NaN, or -1 for integers.
    """
    found: Arrays = {}
    for name in dict.fromkeys(name for arrays in carried for name in arrays):
        like = next(arrays[name] for arrays in carried if name in arrays)
        nothing = np.nan if np.issubdtype(like.dtype, np.floating) else -1
        found[name] = np.concatenate(
            [
                arrays.get(name, np.full((number, size, *like.shape[2:]), nothing, dtype=like.dtype))
                for arrays, size in zip(carried, sizes, strict=True)
            ],
            axis=1,
        )
    return found


def _extend(group: Any, name: str, rows: Any, unit: str = "") -> None:
    """Append rows, shape ``(rows, ...)``, to a dataset, which is made with the first rows."""
    if name not in group:
        rest = rows.shape[1:]
        group.create_dataset(
            name,
            (0, *rest),
            rows.dtype,
            maxshape=(None, *rest),
            chunks=(min(len(rows), 4096), *rest),
            compression="gzip",
            shuffle=True,
        )
        if unit:
            group[name].attrs["units"] = unit
    dataset = group[name]
    dataset.resize(len(dataset) + len(rows), axis=0)
    dataset[-len(rows) :] = rows
