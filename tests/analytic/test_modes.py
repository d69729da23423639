"""Exact mode shapes: normalisation, orthogonality, closed-form inner products, boundary conditions."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.march.joint import Joint
from analytic.modes.beam_functions import gram, inertia_of, integrals
from analytic.modes.characteristic_equation import layout_of
from analytic.modes.normal_modes import exact_modes
from lapjoint import FREE, Beam, ContactState, Problem, Stop, Support, paper_joint
from tests.helpers.beams import CLAMP, LONG


def test_closed_form_inner_products_agree_with_quadrature() -> None:
    problem = paper_joint()
    free, both = (exact_modes(problem, state, 60).shapes for state in (FREE, ContactState((0, 1))))
    x, w = np.polynomial.legendre.leggauss(400)  # resolves 60 half waves to rounding on each half of the beam
    L = problem.beam.length
    x, w = np.concatenate([(x + 1) * L / 4, (x + 3) * L / 4]), np.concatenate([w, w]) * L / 4
    np.testing.assert_allclose(
        gram(both, free, inertia_of(problem.line)), problem.beam.m * (both(x) * w) @ free(x).T, atol=1e-12
    )
    np.testing.assert_allclose(integrals(both).sum(axis=1), both(x) @ w, atol=1e-12)


def test_a_long_beam_has_a_rigid_body_mode() -> None:
    """The exponentials that a rigid-body mode does not have would overflow from 709 m on."""
    beam = Beam(length=2000.0, bending_stiffness=1e9, mass_per_length=100.0)
    shapes = exact_modes(Problem(beam=beam, supports=(Support(x=0.0, translational=math.inf),)), FREE, 12).shapes
    np.testing.assert_allclose(gram(shapes, shapes, inertia_of(beam)), np.eye(12), atol=1e-11)
    np.testing.assert_allclose(shapes(np.array([2000.0]))[0], math.sqrt(3 / (beam.m * beam.length)), rtol=1e-12)


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


def test_residual_shape_is_the_sum_of_the_left_out_modes() -> None:
    problem, state, x = paper_joint(), ContactState((0, 1)), np.array([0.3, 1.25, 2.5])
    few, joint = Joint(problem, 20, 20), Joint(problem, 300, 300)
    many = joint.modal(state)
    forces = (many.force * joint.sizes[:, None])[:, 20:]
    summed = (forces / many.modes.omega[20:] ** 2) @ many.modes.shapes(x)[20:]
    # The sum is cut at 300 modes (3e-4 of it is left out) and the foundation of the closed form moves it by 1e-6.
    np.testing.assert_allclose(few.residual(state)(x), summed, rtol=2e-3, atol=2e-3 * np.abs(summed).max())


Paths = dict[str, list[tuple[tuple[Support, ...], float]]]
"""By name, supports and the stiffness of a closed stop at the tip, 0 for none, from one to the next."""
STIFFER = [float(k) for k in 1e3 * 1.3 ** np.arange(44)]  # up to 1e8 N/m: 8000 times the beam's EI / L^3
HELD = [*(1e2 * 1.5 ** np.arange(45)).tolist(), math.inf]
SOFT = [float(k) for k in LONG.EI * 10.0 ** np.arange(-13.0, -2.0, 0.5)]
ENDS = {
    "clamped": (CLAMP,),
    "clamped, on a spring at the tip": (CLAMP, Support(x=2.0, translational=3e5, torsional=1e4)),
    "pinned at both ends": tuple(Support(x=x, translational=math.inf) for x in (0.0, 2.0)),
    "free": (),
}
KINDS = {
    "pin and soft torsion": lambda x, k: (Support(x=x, translational=math.inf, torsional=k),),
    "a spring": lambda x, k: (Support(x=x, translational=k),),
    "two springs": lambda x, k: (Support(x=x, translational=k), Support(x=2.0 - 0.4 * x, translational=0.3 * k)),
    "a spring and torsion": lambda x, k: (Support(x=x, translational=k, torsional=5.0 * k),),
}
STOPS: Paths = {f"a stop at the tip, {name}": [(ends, k) for k in STIFFER] for name, ends in ENDS.items()}
SUPPORTS: Paths = {
    "the clamp's torsion": [((Support(x=0.0, translational=math.inf, torsional=k),), 0.0) for k in HELD],
    "a spring at the tip": [((CLAMP, Support(x=2.0, translational=k)), 0.0) for k in HELD],
}
RIGID: Paths = {  # without a spring, other motions are rigid than with a soft one, but for a pin
    f"{name} at {x:g}": [(made(x, k), 0.0) for k in ([0.0] if "pin" in name else []) + SOFT]
    for name, made in KINDS.items()
    for x in (0.0, 0.3, 1.1, 2.0)
}


@pytest.mark.parametrize(
    ("path", "modes"),
    [
        *(pytest.param(path, 6, id=name) for name, path in STOPS.items()),
        *(pytest.param(path, 6, id=name, marks=pytest.mark.thorough) for name, path in SUPPORTS.items()),
        *(
            pytest.param(path, 2, id=name, marks=() if "at 0.3" in name else pytest.mark.thorough)
            for name, path in RIGID.items()
        ),
    ],
)
def test_modes_keep_their_sign_as_a_stop_or_a_support_stiffens(
    path: list[tuple[tuple[Support, ...], float]], modes: int
) -> None:
    """From one stiffness to the next a section's modal coordinates mean the same motion, from rigid to bending."""
    x, previous = np.linspace(0, 2, 41), None
    for supports, k in path:
        stops = (Stop(x=2.0, side="top", gap=1e-3, stiffness=k),) if k else ()
        problem = Problem(beam=LONG, supports=supports, stops=stops)
        shapes = exact_modes(problem, ContactState((0,) if k else ()), modes + 1).shapes(x)[:modes]
        if previous is not None:
            assert np.all((previous * shapes).sum(axis=1) >= 0.0)
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
