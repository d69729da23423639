"""Exact mode shapes: normalisation, orthogonality, closed-form inner products, boundary conditions."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.march.joint import Joint
from analytic.modes.beam_functions import gram, inertia_of, integrals, squares
from analytic.modes.boundary_conditions import BAND
from analytic.modes.characteristic_equation import frequencies, layout_of
from analytic.modes.normal_modes import elastic_shapes, exact_modes, null_space_of_band, null_vectors
from lapjoint import FREE, Beam, ContactState, Problem, Stop, Support, contact_states, paper_joint
from tests.helpers.beams import CLAMP, LONG

PROBLEMS = {
    "free": (),
    "pinned": (Support(x=0.3, translational=math.inf),),
    "clamped in the middle": (Support(x=1.0, translational=math.inf, torsional=math.inf),),
    "nearly clamped in the middle": (Support(x=1.0, translational=1e12, torsional=1e12),),
    "on soft springs": (Support(x=0.0, translational=1.0), Support(x=2.0, translational=1.0)),
    "general (Figure 1)": (
        Support(x=0.0, translational=3e4, torsional=2e3),
        Support(x=0.7, translational=5e5, torsional=4e4),
        Support(x=2.0, translational=1e4, torsional=1e5),
    ),
}


@pytest.mark.parametrize("name", PROBLEMS)
def test_modes_are_orthonormal(name: str) -> None:
    problem = Problem(beam=LONG, supports=PROBLEMS[name])
    shapes = exact_modes(problem, FREE, 60).shapes
    # (16), (18).  Within a cluster of frequencies 1e-7 apart the null vectors hold nine digits.
    tolerance = 1e-9 if "nearly" in name else 1e-11
    np.testing.assert_allclose(gram(shapes, shapes, inertia_of(LONG)), np.eye(60), atol=tolerance)


def test_closed_form_inner_products_agree_with_quadrature() -> None:
    problem = paper_joint()
    free, both = (exact_modes(problem, state, 60).shapes for state in (FREE, ContactState((0, 1))))
    x, w = np.polynomial.legendre.leggauss(400)  # resolves 60 half waves to rounding on each half of the beam
    L = problem.beam.length
    x, w = np.concatenate([(x + 1) * L / 4, (x + 3) * L / 4]), np.concatenate([w, w]) * L / 4
    np.testing.assert_allclose(
        gram(both, free, inertia_of(problem.beam)), problem.beam.m * (both(x) * w) @ free(x).T, atol=1e-12
    )
    np.testing.assert_allclose(integrals(both).sum(axis=1), both(x) @ w, atol=1e-12)


@pytest.mark.parametrize("name", PROBLEMS)
def test_squares_are_the_diagonal_of_all_inner_products(name: str) -> None:
    shapes = exact_modes(Problem(beam=LONG, supports=PROBLEMS[name]), FREE, 40).shapes
    np.testing.assert_allclose(
        squares(shapes, inertia_of(LONG)), np.diag(gram(shapes, shapes, inertia_of(LONG))), rtol=1e-13
    )


def test_boundary_terms_and_integrals_of_exponentials_agree() -> None:
    problem = paper_joint()
    one, other = (exact_modes(problem, state, 50).shapes for state in (ContactState((0,)), ContactState((1, 2))))
    every_pair = 2.0  # of the larger mu^4
    inertia = inertia_of(problem.beam)
    np.testing.assert_allclose(gram(one, other, inertia), gram(one, other, inertia, near=every_pair), atol=1e-13)


def test_a_long_beam_has_a_rigid_body_mode() -> None:
    """The exponentials that a rigid-body mode does not have would overflow from 709 m on."""
    beam = Beam(length=2000.0, bending_stiffness=1e9, mass_per_length=100.0)
    shapes = exact_modes(Problem(beam=beam, supports=(Support(x=0.0, translational=math.inf),)), FREE, 12).shapes
    np.testing.assert_allclose(gram(shapes, shapes, inertia_of(beam)), np.eye(12), atol=1e-11)
    np.testing.assert_allclose(shapes(np.array([2000.0]))[0], math.sqrt(3 / (beam.m * beam.length)), rtol=1e-12)


def test_a_matrix_that_is_singular_to_the_last_bit_has_its_null_vector() -> None:
    singular = np.array([[[1.0, 2.0, 0.0], [2.0, 4.0, 0.0], [0.0, 0.0, 1.0]]])
    (vector,) = null_vectors(singular)
    np.testing.assert_allclose(np.abs(vector), np.array([2.0, 1.0, 0.0]) / math.sqrt(5), atol=1e-13)


def test_no_rule_of_signs_is_continuous() -> None:
    """Followed around the spring amid two pins at which the first two frequencies meet, a shape changes its sign."""
    L, x = LONG.length, np.linspace(0, LONG.length, 41)
    pins = tuple(Support(x=at, translational=math.inf) for at in (0.0, L))
    crossing = 4 * (2 * math.pi) ** 3 / math.tanh(math.pi) * LONG.EI / L**3
    followed: list[np.ndarray] = []
    for angle in np.linspace(0.0, 2 * math.pi, 49):
        stiffness, place = crossing * math.exp(0.5 * math.cos(angle)), L / 2 + 0.04 * L * math.sin(angle)
        problem = Problem(beam=LONG, supports=(*pins, Support(x=place, translational=stiffness)))
        modes = exact_modes(problem, FREE, 2)
        assert modes.omega[1] > 1.01 * modes.omega[0]
        shapes = modes.shapes(x)
        overlap = (followed[-1] * shapes).sum(axis=1) if followed else np.ones(2)
        assert np.all(np.abs(overlap) > 0.5)
        followed.append(shapes * np.sign(overlap)[:, None])
    np.testing.assert_allclose(followed[-1], -followed[0], atol=1e-9)


def test_mapping_obeys_the_reciprocity_of_the_two_states() -> None:
    # (8) by parts: (omega_i^2 - omega_j^2) <Phi_i, Phi_j> = sum of k Phi_i Phi_j over the stops that differ.
    problem = paper_joint()
    joint, both_closed = Joint(problem, 30, 30), ContactState((0, 1))
    free, both = joint.modal(FREE), joint.modal(both_closed)
    S = joint.passage(FREE, both_closed).S
    k = problem.stops[0].stiffness
    jump = k * both.at_stops[:2].T @ free.at_stops[:2]
    squares = both.modes.omega[:, None] ** 2 - free.modes.omega**2
    np.testing.assert_allclose(S * squares, jump, atol=1e-11 * np.abs(squares).max())


def test_shapes_meet_the_conditions_13a_to_13h() -> None:
    problem = Problem(beam=LONG, supports=PROBLEMS["general (Figure 1)"])
    shapes, EI = exact_modes(problem, FREE, 20).shapes, LONG.EI
    eps = 1e-12

    def at(x: float, d: int) -> np.ndarray:
        return shapes(np.array([x]), d)[:, 0]

    root, middle, tip = problem.supports
    scale = EI * np.abs(shapes(np.linspace(0, 2, 50), 3)).max(axis=1)
    assert np.all(np.abs(EI * at(0, 3) + root.translational * at(0, 0)) < 1e-9 * scale)  # V up is -EI phi'''
    assert np.all(np.abs(EI * at(0, 2) - root.torsional * at(0, 1)) < 1e-9 * scale)
    jump = EI * (at(0.7 + eps, 3) - at(0.7, 3))
    assert np.all(np.abs(jump + middle.translational * at(0.7, 0)) < 1e-8 * scale)
    turn = EI * (at(0.7 + eps, 2) - at(0.7, 2))
    assert np.all(np.abs(turn - middle.torsional * at(0.7, 1)) < 1e-8 * scale)
    assert np.all(np.abs(EI * at(2.0, 3) - tip.translational * at(2.0, 0)) < 1e-9 * scale)
    assert np.all(np.abs(EI * at(2.0, 2) + tip.torsional * at(2.0, 1)) < 1e-9 * scale)


def test_derivatives_of_shapes_agree_with_differences() -> None:
    shapes = exact_modes(paper_joint(), ContactState((1,)), 10).shapes
    x, h = np.array([0.31, 1.0, 2.1]), 1e-5
    for d in (1, 2, 3):
        difference = (shapes(x + h, d - 1) - shapes(x - h, d - 1)) / (2 * h)
        scale = np.abs(shapes(x, d)).max(axis=1, keepdims=True)
        assert np.all(np.abs(difference - shapes(x, d)) < 1e-7 * scale)  # h^2 beta^2 / 6 at the tenth mode


def test_residual_shape_is_the_sum_of_the_left_out_modes() -> None:
    problem, state, x = paper_joint(), ContactState((0, 1)), np.array([0.3, 1.25, 2.5])
    few, joint = Joint(problem, 20, 20), Joint(problem, 300, 300)
    many = joint.modal(state)
    forces = (many.force * joint.sizes[:, None])[:, 20:]
    summed = (forces / many.modes.omega[20:] ** 2) @ many.modes.shapes(x)[20:]
    # The sum is cut at 300 modes (3e-4 of it is left out) and the foundation of the closed form moves it by 1e-6.
    np.testing.assert_allclose(few.residual(state)(x), summed, rtol=2e-3, atol=2e-3 * np.abs(summed).max())


def test_frequencies_of_all_nine_states_interlace_the_free_ones() -> None:
    problem = paper_joint(k_star=5000.0)
    free = exact_modes(problem, FREE, 12).omega
    for state in contact_states(problem):
        omega = exact_modes(problem, state, 10).omega
        assert np.all(omega >= free[:10] * (1 - 1e-14))
        assert np.all(omega <= free[len(state.closed) : 10 + len(state.closed)] * (1 + 1e-14))


ENDS = {
    "clamped": (CLAMP,),
    "clamped, on a spring at the tip": (CLAMP, Support(x=2.0, translational=3e5, torsional=1e4)),
    "pinned at both ends": tuple(Support(x=x, translational=math.inf) for x in (0.0, 2.0)),
    "free": (),
}


@pytest.mark.parametrize("ends", ENDS)
def test_modes_keep_their_sign_as_a_stop_at_the_tip_stiffens(ends: str) -> None:
    """From one stiffness to the next, 30 % more, a section's modal coordinates mean the same motion."""
    x, previous = np.linspace(0, 2, 41), None
    for k in 1e3 * 1.3 ** np.arange(44):  # up to 1e8 N/m: 8000 times the beam's EI / L^3
        stops = (Stop(x=2.0, side="top", gap=1e-3, stiffness=k),)
        shapes = exact_modes(Problem(beam=LONG, supports=ENDS[ends], stops=stops), ContactState((0,)), 6).shapes(x)
        if previous is not None:
            assert np.all((previous * shapes).sum(axis=1) >= 0.0)
        previous = shapes


@pytest.mark.parametrize("change", ["the clamp's torsional spring", "a spring at the tip"])
def test_modes_without_contact_keep_their_sign_as_a_support_stiffens(change: str) -> None:
    x, previous = np.linspace(0, 2, 41), None
    for k in [*(1e2 * 1.5 ** np.arange(45)), math.inf]:
        tip, root = (0.0, k) if "clamp" in change else (k, math.inf)
        supports = (Support(x=0.0, translational=math.inf, torsional=root),)
        supports += (Support(x=2.0, translational=tip),) if tip else ()
        shapes = exact_modes(Problem(beam=LONG, supports=supports), FREE, 6).shapes(x)
        if previous is not None:
            assert np.all((previous * shapes).sum(axis=1) > 0.0)
        previous = shapes


SOFT = {
    "pin and soft torsion": lambda x, k: (Support(x=x, translational=math.inf, torsional=k),),
    "a spring": lambda x, k: (Support(x=x, translational=k),),
    "two springs": lambda x, k: (Support(x=x, translational=k), Support(x=2.0 - 0.4 * x, translational=0.3 * k)),
    "a spring and torsion": lambda x, k: (Support(x=x, translational=k, torsional=5.0 * k),),
}


@pytest.mark.parametrize("kind", SOFT)
@pytest.mark.parametrize("x", [0.0, 0.3, 1.1, 2.0])
def test_modes_keep_their_sign_from_rigid_to_bending(kind: str, x: float) -> None:
    places, previous = np.linspace(0, 2, 21), None
    for k in [0.0, *LONG.EI * 10.0 ** np.arange(-13.0, -2.0, 0.5)]:
        if k == 0.0 and kind != "pin and soft torsion":  # without a spring, other motions are rigid
            continue
        shapes = exact_modes(Problem(beam=LONG, supports=SOFT[kind](x, k)), FREE, 3).shapes(places)[:2]
        if previous is not None:
            assert np.all((previous * shapes).sum(axis=1) > 0.0), k
        previous = shapes


@pytest.mark.parametrize("k", [1e-8, 1.0, 1e9])
def test_rigid_modes_move_the_tip_upwards_wherever_the_beam_is_held(k: float) -> None:
    for x in np.linspace(0.0, 1.9, 20).tolist():
        shapes = exact_modes(Problem(beam=LONG, supports=(Support(x=x, translational=k),)), FREE, 3).shapes
        assert shapes(np.array([LONG.length]))[0, 0] > 0.0, x


def with_many_stops(count: int) -> Problem:
    """The paper's joint with many more stops along it."""
    joint = paper_joint()
    x = np.linspace(0.2, 1.0, count) * joint.beam.length
    return joint.replace(stops=tuple(Stop(x=float(it), side="top", gap=1e-3, stiffness=1e4) for it in x))


def test_open_stops_cost_nothing_and_change_no_bit() -> None:
    many = with_many_stops(200)
    few = many.replace(stops=many.stops[30:60:10])
    assert layout_of(many, (30, 50)).x.size == 4  # both ends, two closed stops, nothing else
    one, other = exact_modes(many, ContactState((30, 50)), 12), exact_modes(few, ContactState((0, 2)), 12)
    assert np.array_equal(one.omega, other.omega)
    assert np.array_equal(one.shapes(few.stops[1].x * np.ones(1)), other.shapes(few.stops[1].x * np.ones(1)))


def test_modes_on_many_spans_are_orthonormal_and_solve_the_same_equations() -> None:
    """They are found by the diagonals of a matrix; on few spans, by the whole of it."""
    many = with_many_stops(24)
    state = ContactState(tuple(range(24)))
    modes = exact_modes(many, state, 12)
    assert gram(modes.shapes, modes.shapes, inertia_of(many.beam)) == pytest.approx(np.eye(12), abs=1e-9)
    layout = layout_of(many, state.closed)
    whole = elastic_shapes(layout, frequencies(layout, 12), many.beam.length, few_spans=100)
    x = np.linspace(0.0, many.beam.length, 50)
    values = whole.scaled(
        np.sign(whole(x)[:, -1] * modes.shapes(x)[:, -1]) / np.sqrt(squares(whole, inertia_of(many.beam)))
    )(x)
    assert modes.shapes(x) == pytest.approx(values, abs=1e-8 * np.abs(values).max())


def test_a_band_that_is_singular_to_the_last_bit_has_its_null_vector() -> None:
    size = 28
    values = np.cos(np.arange(size))
    exact = np.tile(np.array([0.0] * BAND + [1.0] + [0.0] * BAND)[:, None], (1, size))
    exact[BAND, -1] = 0.0  # the last equation is 0 = 0
    exact[BAND - 1, -1] = values[3]
    null = null_space_of_band(exact, 1)[0]
    assert np.abs(null[:-2]).max() < 1e-12
    assert null[-2] == pytest.approx(-values[3] * null[-1], rel=1e-12)


@pytest.mark.parametrize("extra", [[0.11], [0.3, 0.31, 0.9]])
def test_functions_on_shorter_spans_are_the_same(extra: list[float]) -> None:
    shapes = exact_modes(paper_joint(), ContactState((2, 3)), 30).shapes
    nodes = np.union1d(shapes.nodes, np.array(extra) * shapes.nodes[-1])
    shorter, x = shapes.on(nodes), np.linspace(0.0, shapes.nodes[-1], 301)
    assert shorter.nodes.size == shapes.nodes.size + len(extra)
    for derivative in range(4):
        values = shapes(x, derivative)
        assert shorter(x, derivative) == pytest.approx(values, abs=1e-12 * np.abs(values).max())
    inertia = inertia_of(paper_joint().beam)
    assert gram(shorter, shapes, inertia) == pytest.approx(gram(shapes, shapes, inertia), abs=1e-12)
