"""Modes of beams on many supports, against closed forms, 60-digit counts and quadrature."""

from __future__ import annotations

import math
from types import SimpleNamespace

import mpmath as mp
import numpy as np
import pytest
from scipy.optimize import brentq, elementwise

from analytic.modes.beam_functions import gram, inertia_of
from analytic.modes.boundary_conditions import BAND
from analytic.modes.characteristic_equation import frequencies, layout_of
from analytic.modes.normal_modes import (
    NormalModes,
    elastic_shapes,
    exact_modes,
    null_space_of_band,
    null_vectors,
)
from lapjoint import FREE, Beam, ContactState, Problem, Stop, Support
from lapjoint.errors import SolverError
from tests.helpers.exact_beams import ExactBeam

MODES = 40
DIGITS = 60
KINDS = ["pinned", "sprung", "clamped", "nearly clamped", "stops"]
"""What holds the beam at an inner node; 'stops' are closed."""


def unit_beam(x: np.ndarray, supports: list[Support], stops: list[Stop]) -> Problem:
    beam = Beam(length=float(x[-1]), bending_stiffness=1.0, mass_per_length=1.0)
    return Problem(beam=beam, supports=tuple(supports), stops=tuple(stops))


def equal_spans(spans: int) -> Problem:
    """Spans of 1 m on pins."""
    x = np.arange(spans + 1.0)
    return unit_beam(x, [Support(x=float(at), translational=math.inf) for at in x], [])


def many_supports(seed: int, most: int) -> tuple[Problem, ContactState]:
    """2 to `most` spans: equal, of two lengths or random; ends free, pinned or clamped; nodes of one kind or mixed."""
    rng = np.random.default_rng(seed)
    spans = round(math.exp(rng.uniform(math.log(2), math.log(most))))
    choices = [np.ones(spans), rng.choice([1.0, 1.3], spans), np.exp(rng.uniform(-1.0, 1.0, spans))]
    x = np.concatenate([[0.0], np.cumsum(choices[rng.integers(3)])])
    held, alike = rng.choice([*KINDS, "mixed"]), rng.random() < 0.5
    supports, stops = [], []
    for node, at in enumerate(x.tolist()):
        if node in (0, spans):
            end = rng.choice(["free", "pinned", "clamped"])
            if end != "free":
                torsional = math.inf if end == "clamped" else 0.0
                supports.append(Support(x=at, translational=math.inf, torsional=torsional))
            continue
        kind = rng.choice(KINDS) if held == "mixed" else held
        k = 194.0 if alike else 10 ** rng.uniform(0.0, 5.0)
        if kind == "stops":
            stops.append(Stop(x=at, side="top", gap=1e-3, stiffness=k))
        else:
            torsional = {"clamped": math.inf, "nearly clamped": 1e9}.get(kind, 0.0)
            supports.append(Support(x=at, translational=k if kind == "sprung" else math.inf, torsional=torsional))
    return unit_beam(x, supports, stops), ContactState(tuple(range(len(stops))))


def assert_modes_are_right(problem: Problem, state: ContactState, judged: list[int]) -> None:
    layout, z = layout_of(problem, state.closed), frequencies(layout_of(problem, state.closed), MODES)
    exact = ExactBeam.of_layout(layout)
    with mp.workdps(DIGITS):
        for i in judged:
            if z[i] > 0:
                # 5e-13 of z is 1e-12 of the frequency; see `test_frequencies`.
                assert exact.pivots((mp.mpf(float(z[i])) * (1 - mp.mpf(5e-13))) ** 2)[0] <= i
                assert exact.pivots((mp.mpf(float(z[i])) * (1 + mp.mpf(5e-13))) ** 2)[0] > i
    modes = exact_modes(problem, state, MODES)
    np.testing.assert_allclose(modes.omega, (z / problem.beam.length) ** 2, rtol=1e-13)
    products = gram(modes.shapes, modes.shapes, inertia_of(problem.line))
    # Frequencies that agree to 1e-12 have shapes that hold the rest of sixteen digits only together.
    np.testing.assert_allclose(products, np.eye(MODES), atol=1e-9)
    # Twenty points integrate the few half waves that a 40th of the beam holds to rounding.
    nodes = np.union1d(modes.shapes.nodes, np.linspace(0.0, problem.beam.length, 41))
    points, weights = np.polynomial.legendre.leggauss(20)
    half = np.diff(nodes)[:, None] / 2
    values = modes.shapes((nodes[:-1, None] + half * (1 + points)).ravel())
    np.testing.assert_allclose((values * (half * weights).ravel()) @ values.T, products, atol=1e-10)
    assert_conditions(problem, state, modes)


def assert_conditions(problem: Problem, state: ContactState, modes: NormalModes) -> None:
    """(13a)-(13h) at every node, over the largest amplitude of each mode, from derivatives on both sides."""
    x, h, shapes = modes.shapes.nodes, 1e-9, modes.shapes
    beta = np.maximum(np.sqrt(modes.omega), 1 / problem.beam.length)[:, None]
    left, right = np.zeros((2, 4, modes.omega.size, x.size))
    for d in range(4):
        left[d, :, 1:] = shapes(x[1:], d) / beta**d
        right[d, :, :-1] = (shapes(x[:-1] + h, d) - h * shapes(x[:-1] + h, d + 1)) / beta**d
    largest = np.abs([left, right]).max(axis=(0, 1, 3))[:, None]
    layout, L = layout_of(problem, state.closed), problem.beam.length
    for d, k, sign in ((0, layout.translational / L**3, 1.0), (1, layout.torsional / L, -1.0)):
        assert np.all(np.abs(right - left)[d, :, 1:-1] <= 1e-8 * largest)
        value = np.where(x == 0, right[d], left[d])
        relative = np.where(np.isinf(k), 0.0, k) / beta ** (3 - 2 * d)
        balance = (right[3 - d] - left[3 - d] + sign * relative * value) / (1 + relative)
        assert np.all(np.abs(np.where(np.isinf(k), value, balance)) <= 1e-8 * largest)


def test_modes_meet_the_conditions_13a_to_13h_on_springs_of_both_kinds() -> None:
    """Those of Figure 1: translational and torsional springs of any stiffness at the ends and between them."""
    supports = [
        Support(x=0.0, translational=2.4, torsional=0.04),
        Support(x=0.7, translational=40.0, torsional=0.8),
        Support(x=2.0, translational=0.8, torsional=2.0),
    ]
    problem = unit_beam(np.array([0.0, 2.0]), supports, [])
    assert_conditions(problem, FREE, exact_modes(problem, FREE, 20))


@pytest.mark.parametrize("spans", [2, 44, 51, pytest.param(300, marks=pytest.mark.slow)])
def test_equal_pinned_spans_have_the_frequencies_of_the_three_moment_equation(spans: int) -> None:
    """cos(j pi / n) = -G / F: the first band goes from a pinned span's frequency (j = n) to below a clamped span's."""

    def rotation(s: float, j: int) -> float:
        near, far = 1 / math.tanh(s) - 1 / math.tan(s), 1 / math.sin(s) - 1 / math.sinh(s)
        return near + math.cos(j * math.pi / spans) * far

    omega = exact_modes(equal_spans(spans), FREE, spans).omega
    clamped = 4.730040744862704
    expected = [brentq(rotation, math.pi + 1e-9, clamped, args=(j,), xtol=1e-15) for j in range(spans - 1, 0, -1)]
    np.testing.assert_allclose(np.sqrt(omega), [math.pi, *expected], rtol=1e-13)


@pytest.mark.parametrize(
    "seed", [*range(6), *(pytest.param(seed, marks=pytest.mark.thorough) for seed in range(6, 20))]
)
def test_modes_on_some_supports_are_right(seed: int) -> None:
    assert_modes_are_right(*many_supports(seed, most=16), judged=[39])


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 150))
def test_modes_on_many_supports_are_right(seed: int) -> None:
    assert_modes_are_right(*many_supports(seed, most=300), judged=[0, 1, 17, 38, 39])


@pytest.mark.parametrize("spans", [3, 12])
def test_clamped_spans_that_are_alike_have_as_many_modes_of_one_frequency(spans: int) -> None:
    x = np.arange(spans + 1.0)
    problem = unit_beam(x, [Support(x=float(at), translational=math.inf, torsional=math.inf) for at in x], [])
    modes = exact_modes(problem, FREE, 2 * spans)
    np.testing.assert_allclose(
        np.sqrt(modes.omega), np.repeat([4.730040744862704, 7.853204624095838], spans), rtol=1e-13
    )
    np.testing.assert_allclose(
        gram(modes.shapes, modes.shapes, inertia_of(problem.line)), np.eye(2 * spans), atol=1e-11
    )


@pytest.mark.parametrize("torsional", 10.0 ** np.arange(2, 17, 2))
def test_modes_are_orthonormal_however_near_their_frequencies(torsional: float) -> None:
    x = np.arange(9.0)
    problem = unit_beam(x, [Support(x=float(at), translational=math.inf, torsional=torsional) for at in x], [])
    modes = exact_modes(problem, FREE, 16)
    np.testing.assert_allclose(gram(modes.shapes, modes.shapes, inertia_of(problem.line)), np.eye(16), atol=1e-9)


def test_a_root_that_the_count_does_not_bear_out_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(elementwise, "find_root", lambda f, bracket, **_: SimpleNamespace(x=bracket[0]))
    with pytest.raises(SolverError, match="the count of frequencies"):
        frequencies(layout_of(equal_spans(3)), 4)


@pytest.mark.parametrize("spans", [3, 51])
def test_a_shape_of_a_root_that_is_none_is_refused(spans: int) -> None:
    layout = layout_of(equal_spans(spans))
    with pytest.raises(SolverError, match="meets the conditions at all supports"):
        elastic_shapes(layout, frequencies(layout, 2) * (1 + 1e-5), float(spans))


@pytest.mark.parametrize("pivot", [0.0, 5e-324, 1e-310, 1e-200, 1e-160, 1e-100, 1e-30, 1e-17])
def test_a_null_vector_is_found_however_small_the_pivot_of_its_matrix(pivot: float) -> None:
    """Three matrices at a time: the middle element alone belongs to the null vector."""
    m = 5
    matrices = np.tile(np.diag([2.0, 1.0, pivot, -1.0, 3.0]), (3, 1, 1))
    expected = np.zeros(m)
    expected[2] = 1.0
    rounding = 1e-14  # of the wobble that stands in for the last bits of a singular matrix
    assert np.abs(np.abs(null_vectors(matrices)) - expected).max() <= rounding
    band = np.zeros((2 * BAND + 1, m))
    band[BAND] = np.diagonal(matrices[0])
    assert np.abs(np.abs(null_space_of_band(band, 1)) - expected).max() <= rounding
