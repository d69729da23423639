"""Named tuples by reference: what compiled functions see of them, and what they may not hold; new arrays besides."""

from __future__ import annotations

import pickle
from typing import NamedTuple

import numpy as np
import pytest
from numba.core.errors import TypingError

from lapjoint.compiled.arrays import bool_zeros, complex_zeros, int_zeros, zeros
from lapjoint.compiled.by_reference import by_reference, in_c_order
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray


@by_reference
class Several(NamedTuple):
    """Arrays of several types and shapes, and a float."""

    row: FloatArray
    scale: float
    block: np.ndarray
    flag: np.ndarray


def several() -> Several:
    return Several(
        np.arange(3.0), 2.5, np.arange(24.0).reshape(2, 3, 4) * (1 + 2j), np.array([[True, False], [False, True]])
    )


@njit_inner()
def _weighed(values: Several, i: int) -> complex:
    total = 0.0 + 0.0j
    for j in range(values.block.shape[1]):
        for k in range(values.block.shape[2]):
            total += values.row[j] * values.scale * values.block[i, j, k]
    return total


@njit_called()
def _seen(values: Several, other: Several, sums: np.ndarray) -> int:
    for i in range(sums.size):
        sums[i] = _weighed(values, i) + _weighed(other, i)
    values.row[1] = -values.scale
    count = 0
    for i in range(values.flag.shape[0]):
        for k in range(values.flag.shape[1]):
            count += values.flag[i, k]
    return count


def test_compiled_functions_read_and_write_what_python_holds() -> None:
    values, other, sums = several(), several()._replace(scale=-1.0, row=np.array([1.0, 0.0, 4.0])), np.zeros(2, complex)
    expected = np.einsum("j,ijk->i", values.row * values.scale, values.block)
    expected += np.einsum("j,ijk->i", other.row * other.scale, other.block)
    assert _seen(values, other, sums) == 2
    np.testing.assert_allclose(sums, expected, rtol=1e-14)
    assert values.row.tolist() == [0.0, -2.5, 2.0]
    turned = other._replace(block=np.asfortranarray(values.block), flag=values.flag.T)
    assert in_c_order(turned).row is turned.row
    assert _seen(in_c_order(turned), other, sums) == 2
    assert _seen(pickle.loads(pickle.dumps(values)), other, sums) == 2


@pytest.mark.parametrize(
    ("name", "value"),
    [("block", np.zeros((2, 3, 4), complex).T), ("row", np.zeros(6)[::2]), ("scale", 1), ("row", "x")],
)
def test_what_has_no_such_layout_is_refused(name: str, value: object) -> None:
    with pytest.raises(TypeError, match=rf"Several\.{name} is neither an array in C order nor a float"):
        _seen(several()._replace(**{name: value}), several(), np.zeros(2, complex))


def test_a_type_belongs_to_its_fields_alone() -> None:
    sums = np.zeros(2, complex)
    before = len(_seen.signatures)  # type: ignore[attr-defined]
    _seen(several(), several()._replace(row=np.zeros(7)), sums)
    assert len(_seen.signatures) == max(before, 1)  # type: ignore[attr-defined]
    with pytest.raises(TypingError):  # one dimension less is another type, which the function cannot index
        _seen(several()._replace(block=np.zeros((2, 3), complex)), several(), sums)


@njit_called()
def _new(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    return zeros((n, 2, 3)), complex_zeros((n, 0)), int_zeros(n), bool_zeros((2, n))


def test_new_arrays_are_all_zero_and_belong_to_python() -> None:
    np.full(4096, 7.0)  # what was in memory before
    for made, shape, kind in zip(_new(5), [(5, 2, 3), (5, 0), (5,), (2, 5)], [float, complex, int, bool], strict=True):
        assert made.shape == shape
        assert made.dtype == kind
        assert not made.any()
        assert made.flags.c_contiguous
        made[...] = 1
