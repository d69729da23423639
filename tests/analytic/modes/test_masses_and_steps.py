"""Modes of beams with steps and masses: against fifty digits, limits, and what two ways of writing a shape share."""

from __future__ import annotations

import math
from itertools import pairwise

import mpmath as mp
import numpy as np
import pytest

from analytic.march.modal_state import loaded_structure, modal_state
from analytic.modes import boundary_conditions
from analytic.modes.beam_functions import gram, inertia_of
from analytic.modes.characteristic_equation import frequencies, layout_of
from analytic.modes.normal_modes import NormalModes, elastic_shapes, exact_modes
from lapjoint import FREE, BaseMotion, Beam, ContactState, Problem, StepLoad, Stop, Support
from lapjoint.problem.beam import BeamSegment, Tube
from lapjoint.problem.masses import Mass
from lapjoint.problem.static_loads import Gravity, UniformLoad
from tests.helpers.beams import CLAMP, LONG
from tests.helpers.exact_beams import ExactBeam
from tests.helpers.random_joints import random_beam

DIGITS = 60
MODES = 40


def unit_frequency(problem: Problem) -> float:
    """sqrt(EI / m) / L^2 of the means, rad/s."""
    beam = problem.beam
    return math.sqrt(beam.EI / beam.m) / beam.length**2


def random_state(seed: int) -> tuple[Problem, ContactState]:
    """A random beam, and a state of the stop at its tip."""
    rng = np.random.default_rng(seed)
    return random_beam(rng), ContactState((0,)) if rng.random() < 0.3 else FREE


def assert_frequencies(seed: int, judged: list[int]) -> None:
    """None is missed, and each is right to 1e-11 of itself, or of `unit_frequency` where that is more."""
    problem, state = random_state(seed)
    omega, unit = exact_modes(problem, state, MODES).omega, unit_frequency(problem)
    exact = ExactBeam.of(problem, state.closed)
    with mp.workdps(DIGITS):
        for i in judged:
            least = 1e-11 * max(omega[i], unit)
            above = mp.mpf(float(omega[i])) + least
            below = mp.mpf(float(omega[i])) - least
            assert exact.pivots(above)[0] >= i + 1
            assert below <= 0 or exact.pivots(below)[0] <= i


def assert_orthonormal(seed: int) -> None:
    """(16), (18) with the mass as weight.  Frequencies near each other have shapes that hold fewer digits."""
    problem, state = random_state(seed)
    modes = exact_modes(problem, state, MODES)
    products = gram(modes.shapes, modes.shapes, inertia_of(problem.line, problem.masses))
    omega = modes.omega
    near = np.abs(omega[:, None] - omega) / np.maximum(np.maximum(omega[:, None], omega), 1e-300)
    allowed = np.where(near > 0, 1e-12 + 1e-14 / np.maximum(near, 1e-14) * (near < 0.01), 1e-12)
    assert np.all(np.abs(products - np.eye(MODES)) <= allowed)


@pytest.mark.parametrize("seed", range(20))
def test_frequencies_agree_with_fifty_digits_and_none_is_missed(seed: int) -> None:
    assert_frequencies(seed, [0, 2])


@pytest.mark.slow
@pytest.mark.parametrize("start", range(1000, 3000, 100))
def test_frequencies_of_many_beams_agree_with_fifty_digits(start: int) -> None:
    for seed in range(start, start + 100):
        assert_frequencies(seed, [seed % 3, 3 + seed % (MODES - 3)])


@pytest.mark.parametrize("seed", range(100, 110))
def test_modes_are_orthonormal_with_the_mass_as_weight(seed: int) -> None:
    assert_orthonormal(seed)


@pytest.mark.slow
@pytest.mark.parametrize("start", range(1000, 3000, 100))
def test_modes_of_many_beams_are_orthonormal(start: int) -> None:
    for seed in range(start, start + 100):
        assert_orthonormal(seed)


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(2, 20))])
def test_inner_products_agree_with_quadrature(seed: int) -> None:
    problem = random_beam(np.random.default_rng(seed), decades=1.0)
    one, other = (exact_modes(problem, state, 12).shapes for state in (FREE, ContactState((0,))))
    nodes = np.union1d(one.nodes, other.nodes)
    edges = np.unique(np.concatenate([np.linspace(a, b, 9) for a, b in pairwise(nodes)]))
    points, weights = np.polynomial.legendre.leggauss(20)
    half = np.diff(edges)[:, None] / 2
    x, w = (edges[:-1, None] + half * (1 + points)).ravel(), (half * weights).ravel()
    expected = (one(x) * problem.line.inertia_at(x) * w) @ other(x).T
    heaviest = 1.0
    for mass in problem.masses:
        at = np.array([mass.x])
        expected += mass.mass * one(at) @ other(at).T + mass.rotary_inertia * one(at, 1) @ other(at, 1).T
        beam = problem.beam
        heaviest += (mass.mass + mass.rotary_inertia / beam.length**2) / (beam.m * beam.length)
    # A displacement at a mass, from the waves, has a rounding error that the mass multiplies.
    found = gram(one, other, inertia_of(problem.line, problem.masses))
    np.testing.assert_allclose(found, expected, atol=1e-13 * (10 + heaviest))


def cantilever(**parts: object) -> Problem:
    return Problem.model_validate({"beam": LONG, "supports": (CLAMP,), **parts})


def with_segments(*ends: float, EI: float = LONG.EI, m: float = LONG.m) -> Beam:
    """A beam of the length of `LONG`, of segments that are alike."""
    return Beam(
        length=LONG.length,
        segments=tuple(BeamSegment(to=end, bending_stiffness=EI, mass_per_length=m) for end in (*ends, LONG.length)),
    )


def shapes_at(modes: NormalModes) -> np.ndarray:
    return modes.shapes(np.linspace(0.0, LONG.length, 33))


def test_equal_segments_are_the_uniform_beam() -> None:
    whole, cut = (exact_modes(cantilever(beam=beam), FREE, MODES) for beam in (LONG, with_segments(0.3, 0.31, 1.7)))
    np.testing.assert_allclose(cut.omega, whole.omega, rtol=1e-13)
    np.testing.assert_allclose(shapes_at(cut), shapes_at(whole), atol=1e-12)


def test_a_segment_whose_length_goes_to_zero_vanishes() -> None:
    whole = exact_modes(cantilever(), FREE, 20)
    for length in 10.0 ** -np.arange(3.0, 12.0, 4.0):
        thick = BeamSegment(to=0.7 + length, bending_stiffness=50 * LONG.EI, mass_per_length=7 * LONG.m)
        ends = [BeamSegment(to=end, bending_stiffness=LONG.EI, mass_per_length=LONG.m) for end in (0.7, LONG.length)]
        modes = exact_modes(cantilever(beam=Beam(length=LONG.length, segments=(ends[0], thick, ends[1]))), FREE, 20)
        np.testing.assert_allclose(modes.omega, whole.omega, rtol=10 * length + 1e-12)
        np.testing.assert_allclose(shapes_at(modes), shapes_at(whole), atol=500 * length + 1e-11)


def test_masses_that_go_to_zero_vanish() -> None:
    whole = exact_modes(cantilever(), FREE, 20)
    for mass in 10.0 ** -np.arange(3.0, 15.0, 4.0):
        modes = exact_modes(cantilever(masses=(Mass(x=1.3, mass=mass, rotary_inertia=1e-3 * mass),)), FREE, 20)
        np.testing.assert_allclose(modes.omega, whole.omega, rtol=mass + 1e-12)
        np.testing.assert_allclose(shapes_at(modes), shapes_at(whole), atol=10 * mass + 1e-11)


def test_a_mass_at_the_tip_that_goes_to_infinity_is_a_pin() -> None:
    pin = (CLAMP, Support(x=LONG.length, translational=math.inf))
    pinned = exact_modes(cantilever(supports=pin), FREE, 20)
    for mass in 10.0 ** np.arange(4.0, 15.0, 3.0):
        modes = exact_modes(cantilever(masses=(Mass(x=LONG.length, mass=mass),)), FREE, 21)
        np.testing.assert_allclose(modes.omega[1:], pinned.omega, rtol=100 / mass + 1e-12)
        # The slowest mode is that of the mass on the beam's 3 EI / L^3, for which the beam hardly counts.
        slow = math.sqrt(3 * LONG.EI / LONG.length**3 / (mass + 33 / 140 * LONG.m * LONG.length))
        np.testing.assert_allclose(modes.omega[0], slow, rtol=(LONG.m * LONG.length / mass) ** 2 + 1e-12)
        x = np.linspace(0.0, 1.0, 33)
        static = (3 * x**2 - x**3) / 2 / math.sqrt(mass)
        np.testing.assert_allclose(shapes_at(modes)[0], static, atol=100 / mass**1.5 + 1e-13 / math.sqrt(mass))


def test_modes_keep_their_sign_as_a_mass_at_the_tip_grows() -> None:
    x, previous = np.linspace(0, 2, 41), None
    for mass in [0.0, *(1e-4 * 4.0 ** np.arange(18))]:  # up to 1e6 kg, of a beam of 20 kg
        shapes = exact_modes(cantilever(masses=(Mass(x=2.0, mass=mass),)), FREE, 6).shapes(x)
        assert previous is None or np.all((previous * shapes).sum(axis=1) > 0.0), mass
        previous = shapes


@pytest.mark.parametrize("mass", [0.0, 3.0])
def test_waves_and_series_are_one_shape_where_they_meet(mass: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """A slow mode, just on either side of the limit, written in both ways."""
    EI = LONG.EI / LONG.length**3
    problem = Problem(
        beam=LONG,
        supports=(
            Support(x=0.0, translational=2e-3 * EI),
            Support(x=1.3, translational=1e-3 * EI, torsional=1e-3 * EI),
        ),
        masses=(Mass(x=1.3, mass=mass * LONG.m * LONG.length),) if mass else (),
    )
    layout = layout_of(problem)
    z = frequencies(layout, 2)
    assert z[-1] < 0.7
    x, found = np.linspace(0.0, LONG.length, 41), []
    for short in (0.1 * z[0], 0.3, 3.0):
        monkeypatch.setattr(boundary_conditions, "_SHORT", short)
        values = elastic_shapes(layout, z, LONG.length)(x)
        found.append(values / values[:, -1:])
    # Waves lose z^-3 of their digits; the series are cut where the next term is z^16 / 16!.
    np.testing.assert_allclose(found[1], found[2], atol=1e-12)
    np.testing.assert_allclose(found[0], found[1], atol=1e-15 * float(z[0]) ** -3 + 1e-12)


def test_positions_that_differ_by_rounding_are_one_place() -> None:
    L = 0.36387816115812505
    whole = Problem(
        beam=Beam(length=L, bending_stiffness=1.0, mass_per_length=1.0), masses=(Mass(x=0.6 * L, mass=1.0),)
    )
    near = whole.replace(uniform_loads=(UniformLoad(start=0.25 * L, to=24 * L / 40, force_per_length=1.0),))
    assert 24 * L / 40 != 0.6 * L
    assert layout_of(near).x.size == 4
    np.testing.assert_allclose(exact_modes(near, FREE, 20).omega, exact_modes(whole, FREE, 20).omega, rtol=1e-13)


def loaded(seed: int) -> Problem:
    """A random beam under every kind of load."""
    problem = random_beam(np.random.default_rng(seed), decades=1.0)
    L = problem.beam.length
    return problem.replace(
        gravity=Gravity(acceleration=-9.81),
        uniform_loads=(UniformLoad(start=0.25 * L, to=0.6 * L, force_per_length=3.0),),
        base_motion=BaseMotion(amplitude=1.0, angular_frequency=1.0),
        point_loads=(StepLoad(x=0.33 * L, force=2.0),),
    )


@pytest.mark.parametrize("seed", [0, 5, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(30, 60))])
def test_foundation_shapes_have_the_modal_content_that_their_equation_says(seed: int) -> None:
    """(Phi_i, u) = (Phi_i, p) / (omega_i^2 + sigma): the inner products know nothing of the loads."""
    problem = loaded(seed)
    for state in (FREE, ContactState((0,))):
        modal = modal_state(loaded_structure(problem), state, 30)
        found = modal.residual.foundation.products(modal.modes.shapes, inertia_of(problem.line, problem.masses))
        expected = modal.residual.weights
        assert np.all(np.abs(found - expected) <= 1e-10 * np.linalg.norm(expected, axis=1)[:, None])


def test_modal_forces_of_gravity_and_of_the_base_are_integrals_of_what_moves() -> None:
    problem = loaded(5)
    beam, modal = problem.line, modal_state(loaded_structure(problem), FREE, 10)
    points, weights = np.polynomial.legendre.leggauss(40)
    expected = np.zeros(10)
    for start, end in pairwise(modal.modes.shapes.nodes):
        x = (start + end) / 2 + (end - start) / 2 * points
        expected += (modal.modes.shapes(x) * beam.inertia_at(x)) @ weights * (end - start) / 2
    for mass in problem.masses:
        expected += mass.mass * modal.modes.shapes(np.array([mass.x]))[:, 0]
    np.testing.assert_allclose(modal.force[1], expected, atol=1e-12 * np.abs(expected).max())


def test_a_tube_with_a_mass_at_its_tip_has_the_printed_frequencies() -> None:
    """SDLL15 of the VPCS (AFNOR): 1000 kg at the tip of a cantilever tube, 1.65, 16.07, 50.02 and 103.2 Hz."""
    tube = {"outer_diameter": 0.35, "inner_diameter": 0.32}
    beam = Beam.model_validate(
        {
            "length": 10.0,
            "material": {"youngs_modulus": 2.1e11, "density": 7800.0},
            "section": {"shape": "tube", **tube},
        }
    )
    assert isinstance(beam.section, Tube)
    hertz = exact_modes(Problem(beam=beam, supports=(CLAMP,), masses=(Mass(x=10.0, mass=1000.0),)), FREE, 4).omega
    # The last printed digit is cut off, not rounded: the first frequency is 1.6554 Hz.
    assert np.all(np.abs(hertz / (2 * math.pi) - [1.65, 16.07, 50.02, 103.2]) < [0.01, 0.01, 0.01, 0.1])


def test_the_stop_of_a_laden_beam_is_a_spring() -> None:
    """A mass on a stop: the closed stop is a support of its stiffness."""
    stop = Stop(x=2.0, side="top", gap=1e-3, stiffness=1e6)
    masses = (Mass(x=2.0, mass=4.0, rotary_inertia=0.3),)
    closed = exact_modes(cantilever(stops=(stop,), masses=masses), ContactState((0,)), 10)
    held = exact_modes(cantilever(supports=(CLAMP, Support(x=2.0, translational=1e6)), masses=masses), FREE, 10)
    np.testing.assert_allclose(closed.omega, held.omega, rtol=1e-13)
