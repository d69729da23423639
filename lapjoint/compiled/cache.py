"""The files in which machine code is kept: valid as long as nothing changes that went into it.

numba keeps machine code until the file changes in which the function stands.  The functions that it calls, and the
constants that it reads, are compiled into it as well, and may stand elsewhere: when these change, the machine code is
silently that of another program.  Here the key of the machine code holds the content of all of them.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np
from numba import types
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.dispatcher import Dispatcher


class ContentCache(FunctionCache):  # type: ignore[misc]
    """The machine code of one function in numba's cache, under a key that holds the content of everything compiled into
    it.

    It raises a `RuntimeError` where there is no folder for machine code.
    """

    def __init__(self, dispatcher: Any) -> None:
        super().__init__(dispatcher.py_func)
        locator, name = self._impl.locator, self._impl.filename_base
        self._cache_file = _Files(self._cache_path, name, locator.get_source_stamp())
        self._dispatcher = dispatcher
        self._content = ""

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        """Types, processor, content and names of fields; not before the first call, when all modules are loaded.

        In place of the content, numba has digests of the function and of its closure.  A compiled function in a closure
        has another digest in each process.
        """
        if not self._content:
            self._content = content_of(self._dispatcher)
        return sig, codegen.magic_tuple(), self._content, tuple(_fields(one) for one in sig)


class _Files(IndexDataCacheFile):  # type: ignore[misc]
    """The files of one function; files that cannot be read, damaged or of modules that have moved, count as empty."""

    def _load_index(self) -> Any:
        try:
            return super()._load_index()
        except Exception:  # unpickling raises whatever the classes raise that a file names
            return {}

    def _load_data(self, name: str) -> Any:
        try:
            return super()._load_data(name)
        except Exception as error:
            raise OSError(f"{name} cannot be read") from error  # numba takes this for a missing file


def content_of(dispatcher: Any) -> str:
    """SHA-256 of a compiled function: its code, its constants and options, and those of all that it calls."""
    digest = hashlib.sha256(_how())
    for part in _of_dispatcher(dispatcher, set()):
        digest.update(f"{len(part)} {part}".encode())
    return digest.hexdigest()


@cache
def _how() -> bytes:
    """The content of this folder, which decides how functions are compiled."""
    return b"".join(file.read_bytes() for file in sorted(Path(__file__).parent.glob("*.py")))


def _fields(kind: Any) -> tuple[Any, ...]:
    """Names of the fields of a named tuple, and of the named tuples in it; empty for all other types."""
    if not isinstance(kind, types.NamedTuple | types.NamedUniTuple):
        return ()
    return (*kind.fields, *(_fields(one) for one in kind))


def _of_dispatcher(dispatcher: Any, seen: set[Any]) -> Iterator[str]:
    function: FunctionType = dispatcher.py_func
    yield f"{function.__module__}.{function.__qualname__}"
    if function in seen:
        return
    seen.add(function)
    for option, value in sorted(dispatcher.targetoptions.items()):
        yield f"{option} {_written(value)}"
    yield _written(function.__defaults__)
    for cell in function.__closure__ or ():
        yield from _of_value(cell.cell_contents, (), seen)
    yield from _of_code(function.__code__, function.__globals__, seen)


def _of_code(code: CodeType, names: dict[str, Any], seen: set[Any]) -> Iterator[str]:
    yield code.co_code.hex()
    yield repr(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _of_code(constant, names, seen)
        else:
            yield _written(constant)
    for name in code.co_names:
        if name in names:
            yield name
            yield from _of_value(names[name], code.co_names, seen)


def _of_value(value: Any, attributes: tuple[str, ...], seen: set[Any]) -> Iterator[str]:
    """The content of a value; of a module, that of the attributes that the code may ask it for."""
    if isinstance(value, Dispatcher):
        yield from _of_dispatcher(value, seen)
    elif isinstance(value, ModuleType):
        yield value.__name__
        for name in attributes:
            if isinstance(getattr(value, name, None), Dispatcher | int | float | complex):
                yield from _of_value(getattr(value, name), (), seen)
    elif isinstance(value, np.ndarray):
        yield f"{value.dtype} {value.shape} {value.tobytes().hex()}"
    elif isinstance(value, tuple):
        for one in value:
            yield from _of_value(one, attributes, seen)
    elif callable(value):
        yield f"{getattr(value, '__module__', '')}.{getattr(value, '__qualname__', '')} {getattr(value, '_fields', '')}"
    else:
        yield _written(value)


def _written(value: Any) -> str:
    """A constant as text that is equal in every process."""
    if isinstance(value, set | frozenset):
        return f"{{{', '.join(sorted(map(_written, value)))}}}"
    return repr(value)
