"""Datasets as NetCDF files that show whether they are whole.

Besides the attributes of its dataset a file has ``checksum``: the digest of all its bytes, with zeros in place of the
digest.
"""

from __future__ import annotations

import io
import re
import secrets
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

from lapjoint.files.writing import write_file

if TYPE_CHECKING:
    import xarray as xr

_SEAL = b"sha256 of the file, with zeros for these digits: "
_ZEROS = 64 * b"0"
_SEALED = re.compile(re.escape(_SEAL) + b"([0-9a-f]{64})")
"""The attribute ``checksum`` as the bytes of the file hold it."""


def write_netcdf(dataset: xr.Dataset, path: str | Path) -> None:
    """Write a dataset with its checksum; an older file of that name stays until the new one is complete."""
    content, room = io.BytesIO(), secrets.token_hex(len(_ZEROS) // 2)
    encoding = {name: {"_FillValue": None} for name in dataset.variables if dataset[name].dtype.kind != "O"}
    sealed = dataset.assign_attrs(checksum=f"{_SEAL.decode()}{room}")
    sealed.to_netcdf(content, engine="h5netcdf", encoding=encoding)
    before, after = content.getvalue().split(room.encode())
    write_file(path, before + _digest(before, after) + after)


def is_whole(raw: bytes) -> bool:
    """Whether the bytes of a file hold their own digest."""
    return any(_digest(raw[: at.start(1)], raw[at.end(1) :]) == at[1] for at in _SEALED.finditer(raw))


def _digest(before: bytes, after: bytes) -> bytes:
    """The digest of a file that has these bytes before and after it."""
    found = sha256(before)
    found.update(_ZEROS)
    found.update(after)
    return found.hexdigest().encode()
