"""What LLVM is spared while numba compiles functions of this project.

numba makes machine code of each function that it compiles, though of one that only compiled functions call nobody uses
it: they have it in their own, and optimise it there once more.  Here such a function is neither optimised nor made
machine code of by itself; it is kept as LLVM's bitcode, for those that call it.  That halves LLVM's time.

What a function has of those that it calls is its own: numba lets all of a process share the copy that is loaded first,
and what that was compiled for, with loops vectorised or not, then decides how fast the others are.

This stands on how the releases `KNOWN` of numba are built inside.  With any other, `spare_llvm` leaves all as it is.
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
"""What is relied on, or put in place of, in `numba.core.codegen`."""
KNOWN = ("0.68.",)
"""How the releases of numba begin with which this has been tried."""
_WRAPPERS = "_ZN7cpython", "cfunc."
"""How the names of functions begin by which Python and C call a compiled one."""


class Sparing:
    """Whether LLVM is spared just now: while a function of this project is compiled, under numba's lock."""

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
    """Whether neither Python nor C can call anything in a library, and it has no machine code from a file yet."""
    if getattr(library, "_compiled_object", None) is not None:
        return False
    functions = library._final_module.functions
    return not any(it.name.startswith(_WRAPPERS) and not it.is_declaration for it in functions)


def _own_copies(library: Any) -> None:
    """Keep to a library what it has of the functions that it calls."""
    for function in library._final_module.functions:
        if not function.is_declaration and function.linkage == Linkage.linkonce_odr:
            function.linkage = Linkage.internal


def _spare_libraries(kind: Any) -> None:
    """Optimise and make machine code of a library only where that is used."""
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
    """What no machine code is made of has no place for the objects of Python that it uses."""
    write = kind.set_env

    def set_env(self: Any, name: str, environment: Any) -> None:
        if not Sparing.on or self._engine.is_symbol_defined(name):
            write(self, name, environment)

    kind.set_env = set_env
