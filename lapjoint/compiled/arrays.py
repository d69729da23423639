"""New arrays in compiled functions, and copies of them.

numba compiles `numpy.zeros` and `numpy.empty` anew for each shape and type.  For an assignment such as ``a[:] = b`` it
compiles the message of shapes that differ, too, which takes three seconds the first time.

Only compiled functions can call the functions of this module.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np import arrayobj

from lapjoint.compiled.compiling import njit_inner

Shape: TypeAlias = int | tuple[int, ...]


def _zeros(dtype: Any, name: str, what: str) -> Any:
    """A function that makes arrays of one type."""

    def zeros(typing_context: Any, shape: Any) -> Any:
        one = isinstance(shape, types.Integer)
        lengths: Any = (types.intp,) if one else types.UniTuple(types.intp, len(shape))
        array_type = types.Array(dtype, len(lengths), "C")

        def made(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            lengths = [arguments[0]] if one else cgutils.unpack_tuple(builder, arguments[0])
            array = arrayobj._empty_nd_impl(context, builder, array_type, lengths)
            cgutils.memset(builder, array.data, builder.mul(array.itemsize, array.nitems), 0)
            return array._getvalue()

        return array_type(types.intp if one else lengths), made

    zeros.__name__ = zeros.__qualname__ = name
    zeros.__doc__ = f"A new array of {what}, all zero, of a shape that is an integer or a tuple of integers."
    return intrinsic(zeros)


zeros: Callable[[Shape], npt.NDArray[np.float64]] = _zeros(types.float64, "zeros", "floats")
complex_zeros: Callable[[Shape], npt.NDArray[np.complex128]] = _zeros(types.complex128, "complex_zeros", "complexes")
int_zeros: Callable[[Shape], npt.NDArray[np.int64]] = _zeros(types.int64, "int_zeros", "integers")
bool_zeros: Callable[[Shape], npt.NDArray[np.bool_]] = _zeros(types.boolean, "bool_zeros", "truth values")


@njit_inner()
def put(target: npt.NDArray[Any], values: npt.NDArray[Any]) -> None:
    """Write `values` into an array of the same shape (n,)."""
    for i in range(target.size):
        target[i] = values[i]
