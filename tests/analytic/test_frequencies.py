"""Frequencies of the exact solver against 50-digit arithmetic, textbook values and the paper's Table 4."""

from __future__ import annotations

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic.modes.characteristic_equation import Layout, characteristic, count_below, frequencies, layout_of
from lapjoint import Beam, Problem, Support
from tests.helpers.exact_beams import ExactBeam

DIGITS = 50


def uniform_layout(x: list[float], translational: list[float], torsional: list[float]) -> Layout:
    """A uniform beam without masses."""
    nodes, spans = np.zeros(len(x)), np.ones(len(x) - 1)
    at = (np.array(values, dtype=float) for values in (x, translational, torsional))
    return Layout(*at, mass=nodes, rotary=nodes, stiffness=spans, wave=spans)


springs = st.one_of(st.just(0.0), st.just(math.inf), st.integers(0, 15).map(lambda n: 10.0**n), st.floats(1.0, 1e15))
positions = st.lists(st.integers(1, 39), max_size=3, unique=True).map(sorted)


@st.composite
def layouts(draw: st.DrawFn) -> Layout:
    """Random beams: up to three inner supports, springs 0, 1 ... 1e15 and infinite, at EI and L of the paper."""
    inner = draw(positions)
    x = np.array([0.0, *(value / 40 for value in inner), 1.0]) * 2.5
    beam = Beam(length=2.5, bending_stiffness=640625.0, mass_per_length=118.35)
    supports = tuple(Support(x=float(value), translational=draw(springs), torsional=draw(springs)) for value in x)
    return layout_of(Problem(beam=beam, supports=supports))


@settings(max_examples=40, deadline=None, derandomize=True)
@given(layouts())
def test_frequencies_hold_twelve_digits_and_none_is_missed(layout: Layout) -> None:
    roots, exact = frequencies(layout, 12), ExactBeam.of_layout(layout)
    with mp.workdps(DIGITS):
        for i, root in enumerate(roots):
            if root == 0:
                continue
            # omega = z^2: 1e-12 of the frequency is 5e-13 of z.  At most i roots below, at least i + 1 above:
            # the i-th root, counted from 0, lies between, and no root has been passed over.
            below, above = mp.mpf(float(root)) * (1 - mp.mpf(5e-13)), mp.mpf(float(root)) * (1 + mp.mpf(5e-13))
            assert exact.pivots(below**2)[0] <= i
            assert exact.pivots(above**2)[0] >= i + 1
    assert np.count_nonzero(roots == 0) == layout.rigid_modes()


@settings(max_examples=25, deadline=None, derandomize=True)
@given(layouts(), st.floats(0.3, 60.0))
def test_count_by_signs_agrees_with_the_dynamic_stiffness_in_fifty_digits(layout: Layout, z: float) -> None:
    with mp.workdps(DIGITS):
        expected = ExactBeam.of_layout(layout).pivots(mp.mpf(z) ** 2)[0]
    assert count_below(layout, np.array([z]))[0] == expected


@pytest.mark.parametrize(
    ("left", "right", "equation"),
    [
        ((math.inf, math.inf), (0, 0), lambda z: mp.cos(z) + mp.sech(z)),
        ((math.inf, math.inf), (math.inf, math.inf), lambda z: mp.cos(z) - mp.sech(z)),
        ((math.inf, 0), (math.inf, 0), mp.sin),
        ((math.inf, math.inf), (math.inf, 0), lambda z: mp.tan(z) - mp.tanh(z)),
        ((0, math.inf), (0, math.inf), mp.sin),
    ],
    ids=["cantilever", "clamped-clamped", "pinned-pinned", "clamped-pinned", "sliding-sliding"],
)
def test_textbook_beams_satisfy_their_characteristic_equations_up_to_sixty_modes(left, right, equation) -> None:
    layout = uniform_layout([0.0, 1.0], [left[0], right[0]], [left[1], right[1]])
    roots = frequencies(layout, 60)
    elastic = roots[roots > 0]
    with mp.workdps(DIGITS):
        for z in elastic:
            exact = mp.findroot(equation, mp.mpf(float(z)))
            assert abs(z - exact) <= 1e-14 * exact  # a few roundings of double precision
    # Roots of a beam are asymptotically pi apart: none is missing and none is double.
    assert np.all(np.diff(elastic)[1:] > 3.0)
    assert np.all(np.diff(elastic)[1:] < 3.3)


def test_nearly_equal_frequencies_come_out_as_two() -> None:
    layout = uniform_layout([0, 0.5, 1.0], [0, 1e9, 0], [0, 1e9, 0])
    z = frequencies(layout, 2)
    assert 0 < z[1] - z[0] < 1e-6
    middle = np.array([z[0] * (1 - 1e-12), (z[0] + z[1]) / 2, z[1] * (1 + 1e-12)])
    assert count_below(layout, middle).tolist() == [0, 1, 2]
    assert np.sign(characteristic(layout, middle)).tolist() == [1, -1, 1]
