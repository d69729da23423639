"""Work that LLVM is spared while numba compiles functions of this project.

numba makes machine code of each function that it compiles.  The machine code of a function that only compiled functions
call is never used: its callers contain the function, and optimise it once more.  Here such a function is kept as LLVM's
bitcode for its callers, neither optimised nor made machine code.  This halves LLVM's time.

Each function has its own copies of the functions that it calls.  numba lets all functions of a process share the copy
that is loaded first, and whether its loops are vectorised then decides how fast the others are.

All this depends on the inner structure of the releases `KNOWN` of numba.  With any other, `spare_llvm` changes nothing.
"""

from __future__ import annotations

from typing import Any

import numba
from llvmlite.binding import Linkage
from numba.core import codegen

_NEEDED = {
    "JITCodeLibrary": (
        "_optimize_final_module",
        "_finalize_final_module",
        "_finalize_dynamic_globals",
        "_verify_declare_only_symbols",
        "_ensure_finalized",
        "get_pointer_to_function",
        "serialize_using_bitcode",
        "serialize_using_object_code",
    ),
    "JITCPUCodegen": ("set_env",),
}
"""Members of `numba.core.codegen` that are called or replaced here."""
KNOWN = ("0.68.",)
"""Beginnings of the numbers of numba's releases for which this was tested."""
_WRAPPERS = "_ZN7cpython", "cfunc."
"""Beginnings of the names of functions by which Python and C call a compiled one."""


class Sparing:
    """Whether LLVM is spared now: while a function of this project is compiled, under numba's lock."""

    on = False


def spare_llvm() -> bool:
    """Let numba's code libraries look at `Sparing`; False with a release that is not `KNOWN`, or is built otherwise."""
    if not numba.__version__.startswith(KNOWN):
        return False
    for name, members in _NEEDED.items():
        if not all(hasattr(getattr(codegen, name, None), member) for member in members):
            return False
    _spare_libraries(codegen.JITCodeLibrary)
    _spare_environments(codegen.JITCPUCodegen)
    return True


def _only_for_compiled(library: Any) -> bool:
    """Whether neither Python nor C can call a library's functions, and it has no machine code from a file yet."""
    if getattr(library, "_compiled_object", None) is not None:
        return False
    functions = library._final_module.functions
    return not any(it.name.startswith(_WRAPPERS) and not it.is_declaration for it in functions)


def _own_copies(library: Any) -> None:
    """Make a library's copies of the functions that it calls private to it."""
    for function in library._final_module.functions:
        if not function.is_declaration and function.linkage == Linkage.linkonce_odr:
            function.linkage = Linkage.internal


def _spare_libraries(kind: Any) -> None:
    """Optimise a library, and make its machine code, only where it is used."""
    optimise, finalise = kind._optimize_final_module, kind._finalize_final_module
    address, serialise = kind.get_pointer_to_function, kind.serialize_using_object_code

    def _optimize_final_module(self: Any) -> None:
        if Sparing.on and _only_for_compiled(self):
            return
        if Sparing.on:
            _own_copies(self)
        optimise(self)

    def _finalize_final_module(self: Any) -> None:
        self.only_for_compiled = Sparing.on and _only_for_compiled(self)
        if not self.only_for_compiled:
            finalise(self)
            return
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def get_pointer_to_function(self: Any, name: str) -> int:
        self._ensure_finalized()
        return 0 if self.only_for_compiled else int(address(self, name))

    def serialize_using_object_code(self: Any) -> Any:
        self._ensure_finalized()
        return self.serialize_using_bitcode() if self.only_for_compiled else serialise(self)

    kind.only_for_compiled = False
    for function in (
        _optimize_final_module,
        _finalize_final_module,
        get_pointer_to_function,
        serialize_using_object_code,
    ):
        setattr(kind, function.__name__, function)


def _spare_environments(kind: Any) -> None:
    """Skip Python's objects of a library without machine code, which has no place for them."""
    write = kind.set_env

    def set_env(self: Any, name: str, environment: Any) -> None:
        if not Sparing.on or self._engine.is_symbol_defined(name):
            write(self, name, environment)

    kind.set_env = set_env
