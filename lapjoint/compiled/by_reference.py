"""Named tuples of arrays that compiled functions take by one address, instead of array by array.

numba passes a tuple by value: thirty arrays are two hundred numbers at every call, and a function that takes them
compiles for seconds.  To compiled functions, a named tuple decorated with `by_reference` is an address: that of a few
words for each field, which are written when Python calls a function, and read where they are needed.  A field may be
None, and the type of the tuple tells: see `lapjoint.compiled.absent_fields`.

Compiled functions borrow the arrays: they write to them, but neither keep nor return one, nor a view of one.  Python
keeps the arrays as long as the tuple, and so at least for the time of a call.
"""

from __future__ import annotations

import hashlib
from typing import Any, NamedTuple, TypeVar

import numpy as np
from llvmlite import ir
from numba import typeof, types
from numba.core import cgutils
from numba.core.datamodel import models
from numba.core.datamodel.registry import register_default
from numba.core.imputils import lower_getattr_generic
from numba.core.pythonapi import NativeValue, unbox
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.core.typing.typeof import typeof_impl

T = TypeVar("T", bound=tuple[Any, ...])

_WORD = 8  # bytes of an address, a length or a float
_ITEMS = tuple.__basicsize__ // _WORD  # words of a tuple before its items
_HEAD = object.__basicsize__ // _WORD  # words of any object before what it holds: of a float, its value
_DATA, _LENGTHS = _HEAD, _HEAD + 2  # word of an array that is the address of its data, and of its shape


class Field(NamedTuple):
    """A field of a tuple: its name, its type to numba, and which word it begins at."""

    name: str
    type: Any
    word: int

    @property
    def dimensions(self) -> int:
        """Number of dimensions of an array; 0 of a number."""
        return int(getattr(self.type, "ndim", 0))

    @property
    def words(self) -> int:
        """Number of words that hold the field: none if it is None."""
        return 0 if isinstance(self.type, types.NoneType) else 1 + self.dimensions


class ByReference(types.Type):  # type: ignore[misc]
    """The type, to numba, of a decorated tuple: the name of its class, and its fields in order."""

    def __init__(self, name: str, fields: tuple[Field, ...]) -> None:
        self.fields = fields
        digest = hashlib.sha256(repr([(it.name, str(it.type)) for it in fields]).encode()).hexdigest()
        # The name of every function that takes the tuple contains this name.
        super().__init__(f"{name}_{digest[:12]}")

    def field(self, name: str) -> Field | None:
        """A field by its name; None if there is none of that name."""
        return next((it for it in self.fields if it.name == name), None)


def by_reference(kind: type[T]) -> type[T]:
    """Let compiled functions take a named tuple by its address; returns its class.

    Its fields are arrays in C order, floats or None.
    """
    typeof_impl.register(kind)(_type_of)
    return kind


def in_c_order(values: T) -> T:
    """A named tuple with its arrays in C order, copied if they are not, for functions that only read them."""
    kind: Any = type(values)
    made: T = kind._make(np.ascontiguousarray(it) if isinstance(it, np.ndarray) else it for it in values)
    return made


def _type_of(values: Any, _: Any) -> ByReference:
    """The type of a tuple to numba."""
    fields, word = [], 0
    for name, value in zip(values._fields, values, strict=True):
        it = typeof(value)
        array = isinstance(value, np.ndarray) and it.layout == "C" and it.aligned
        if not array and value is not None and not isinstance(value, float):
            raise TypeError(f"{type(values).__name__}.{name} is neither an array in C order nor a float nor None")
        fields.append(Field(name, it, word))
        word += fields[-1].words
    return ByReference(type(values).__name__, tuple(fields))


def _unboxed(kind: ByReference, values: Any, c: Any) -> Any:
    """The address of words for the fields of a tuple, read from Python's objects as CPython and numpy lay them out.

    numba has checked the types of the objects before.
    """
    builder, word = c.builder, ir.IntType(8 * _WORD)

    def at(address: Any, index: int) -> Any:
        return cgutils.gep_inbounds(builder, builder.bitcast(address, word.as_pointer()), index)

    def address_at(address: Any, index: int) -> Any:
        return builder.inttoptr(builder.load(at(address, index)), word.as_pointer())

    last = kind.fields[-1]
    words = cgutils.alloca_once(builder, word, size=last.word + last.words)
    for i, field in enumerate(kind.fields):
        if not field.words:
            continue
        value = address_at(values, _ITEMS + i)
        builder.store(builder.load(at(value, _DATA)), at(words, field.word))
        if field.dimensions:
            lengths = address_at(value, _LENGTHS)
            for k in range(field.dimensions):
                builder.store(builder.load(at(lengths, k)), at(words, field.word + 1 + k))
    return NativeValue(builder.bitcast(words, c.context.get_value_type(kind)))


class _Fields(AttributeTemplate):  # type: ignore[misc]
    """The types of the fields."""

    key = ByReference

    def generic_resolve(self, kind: ByReference, name: str) -> Any:
        """The type of a field, or None if there is none of that name."""
        field = kind.field(name)
        return None if field is None else field.type


def _look_up(context: Any, builder: Any, kind: ByReference, address: Any, name: str) -> Any:
    """Code that loads a field: a number, or an array without a count of references."""
    field = kind.field(name)
    assert field is not None
    if not field.words:
        return context.get_dummy_value()
    words = builder.bitcast(address, ir.IntType(8 * _WORD).as_pointer())
    at = [cgutils.gep_inbounds(builder, words, field.word + i) for i in range(1 + field.dimensions)]
    if not isinstance(field.type, types.Array):
        return builder.load(builder.bitcast(at[0], context.get_value_type(field.type).as_pointer()))
    array = context.make_array(field.type)(context, builder)
    size = itemsize = context.get_constant(types.intp, context.get_abi_sizeof(context.get_data_type(field.type.dtype)))
    shape, count = [builder.load(it) for it in at[1:]], context.get_constant(types.intp, 1)
    strides: list[Any] = []
    for length in reversed(shape):
        strides.insert(0, size)
        size, count = builder.mul(size, length), builder.mul(count, length)
    array.meminfo = cgutils.get_null_value(array.meminfo.type)
    array.parent = cgutils.get_null_value(array.parent.type)
    array.nitems, array.itemsize = count, itemsize
    array.data = builder.inttoptr(builder.load(at[0]), array.data.type)
    array.shape = cgutils.pack_array(builder, shape)
    array.strides = cgutils.pack_array(builder, strides)
    return array._getvalue()


register_default(ByReference)(models.OpaqueModel)
unbox(ByReference)(_unboxed)
infer_getattr(_Fields)
lower_getattr_generic(ByReference)(_look_up)
