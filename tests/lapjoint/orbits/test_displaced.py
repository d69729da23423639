"""Displaced starts: moved by what was asked for, the same in both solvers, refused where it means nothing."""

from __future__ import annotations

import math

import numpy as np
import pytest
from toy import Bar, bar

import analytic
import fe_lapjoint
from lapjoint import FREE, InputError, Problem, Stop, Support, paper_joint
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.orbits.displaced import DisplacedStarts, energy_roots, plane_directions, random_deviation
from lapjoint.problem.plane import Plane

SOLVERS = (analytic.Solver(n_modes=24), fe_lapjoint.Solver(elements=24))
AnySolver = analytic.Solver | fe_lapjoint.Solver
TRUNCATED = 2e-4  # of what a start is moved by: the static shape that 24 modes leave out falls with their cube


def held_joint() -> Problem:
    """The paper's joint with a spring near its middle, so that no shape is that of a textbook."""
    joint = paper_joint(angular_frequency=300.0)
    return joint.replace(supports=(*joint.supports, Support(x=1.1, translational=2e5)))


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("text", ["z(2.5),v(2.5)", "z(2.5),z(1.4)", "v(1.4),v(2.5)", "v(0.9),z(2.2)"])
def test_a_start_is_moved_by_what_was_asked_for(solver: AnySolver, text: str) -> None:
    problem, plane = held_joint(), Plane.from_text(text)
    period_map = solver.period_map(problem)
    origin = period_map.initial()
    rows = plane_directions(period_map, problem, origin, plane)
    for asked in ((3e-4, 0.0), (0.0, -2e-4), (1e-4, 5e-4)):
        history = period_map.history(period_map.moved(origin, np.array(asked) @ rows), 1)
        for value, one in zip(asked, plane.coordinates, strict=True):
            read = history.displacement if one.kind == "z" else history.velocity
            at_rest = period_map.history(origin, 1)
            before = at_rest.displacement if one.kind == "z" else at_rest.velocity
            moved = float(read(one.place, [0.0])[0, 0] - before(one.place, [0.0])[0, 0])
            assert moved == pytest.approx(value, abs=TRUNCATED * max(map(abs, asked)))


def test_the_static_shape_of_a_cantilever_is_that_of_the_textbook() -> None:
    # G(x, L) = x^2 (3 L - x) / 6 EI at the tip's force, and L^3 / 3 EI at the tip.
    problem = paper_joint(angular_frequency=300.0)
    L, EI = problem.beam.length, problem.beam.EI
    for solver in SOLVERS:
        period_map = solver.period_map(problem)
        shapes = period_map.static_shapes(period_map.initial(), np.array([L, 0.4 * L]))
        assert shapes.compliance[0, 0] == pytest.approx(L**3 / (3 * EI), rel=1e-9)
        assert shapes.compliance[0, 1] == pytest.approx((0.4 * L) ** 2 * 2.6 * L / (6 * EI), rel=1e-9)
        assert shapes.compliance == pytest.approx(shapes.compliance.T, rel=1e-9)


def test_both_solvers_start_from_the_same_shape() -> None:
    problem, plane = held_joint(), Plane.from_text("z(2.5),v(1.4)")
    x, found = np.linspace(0.0, 2.5, 26), []
    for solver in SOLVERS:
        period_map = solver.period_map(problem)
        origin = period_map.initial()
        start = period_map.moved(origin, np.array([2e-3, 0.5]) @ plane_directions(period_map, problem, origin, plane))
        history = period_map.history(start, 1)
        found.append((start.state, history.displacement(x, [0.0])[:, 0], history.velocity(x, [0.0])[:, 0]))
    (one, z, v), (other, z_fe, v_fe) = found
    assert one == other != FREE  # 2 mm at the tip press the stop at 1 mm
    assert z == pytest.approx(z_fe, abs=5e-3 * 2e-3)  # as they carry a displacement of a free one
    assert v == pytest.approx(v_fe, abs=2e-2 * 0.5)  # and a velocity


@pytest.mark.parametrize("solver", [*SOLVERS, Bar()])
def test_random_starts_fill_the_ball_of_their_energy(solver: AnySolver | Bar) -> None:
    problem = bar(0.7, (5.0, 9.0)) if isinstance(solver, Bar) else held_joint()
    period_map = solver.period_map(problem)
    assert isinstance(period_map, DisplacedStarts)
    origin = period_map.initial()
    roots, A = energy_roots(period_map, problem, origin), period_map.energy(origin)
    drawn = [random_deviation(roots, 3.0, (7, i)) for i in range(200)]
    energies = np.array([e @ A @ e / 2 for e in drawn])
    n = drawn[0].size
    assert np.all(energies <= 3.0 * (1 + 1e-9))
    # the share below E is (E / bound)^(n/2): its mean is bound n / (n + 2)
    spread = 3.0 * math.sqrt(4 * n / ((n + 2) ** 2 * (n + 4)) / 200)
    assert np.mean(energies) == pytest.approx(3.0 * n / (n + 2), abs=5 * spread)
    assert np.array_equal(drawn[5], random_deviation(roots, 3.0, (7, 5)))


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_energy_of_a_static_shape_is_half_of_force_times_displacement(
    solver: AnySolver,
) -> None:
    problem = held_joint()
    period_map = solver.period_map(problem)
    origin = period_map.initial()
    shapes = period_map.static_shapes(origin, np.array([1.7]))
    twice = float(shapes.displacements[0] @ period_map.energy(origin) @ shapes.displacements[0])
    assert twice == pytest.approx(float(shapes.compliance[0, 0]), rel=1e-3)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_start_may_be_counted_from_a_point_in_contact(solver: AnySolver) -> None:
    problem, plane = held_joint(), Plane.from_text("z(2.5),v(2.5)")
    period_map = solver.period_map(problem)
    rest = period_map.initial()
    rows = plane_directions(period_map, problem, rest, plane)
    pressed = period_map.moved(rest, 1.5e-3 * rows[0])
    assert pressed.state != FREE
    farther = period_map.moved(pressed, 1e-3 * plane_directions(period_map, problem, pressed, plane)[0])
    z = [float(period_map.history(point, 1).displacement(2.5, [0.0])[0, 0]) for point in (pressed, farther)]
    assert z[1] - z[0] == pytest.approx(1e-3, abs=2e-2 * 1e-3)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("z(2.5)", "must be two coordinates"),
        ("z(2.5),w(2.5)", "must be two coordinates"),
        ("z(a),v(2.5)", "must be two coordinates"),
        ("z(2.5),z(2.5)", "they must differ"),
        ("z(2.6),v(2.5)", "lies outside the beam"),
        ("z(0),v(2.5)", "a support holds it"),
        ("z(2.5),z(2.4999)", "both places move alike"),
    ],
)
def test_what_is_no_plane_of_the_joint_is_refused(text: str, said: str) -> None:
    problem = paper_joint()
    period_map = analytic.Solver(n_modes=8).period_map(problem)
    with pytest.raises(InputError, match=said):
        plane_directions(period_map, problem, period_map.initial(), Plane.from_text(text))


def test_a_beam_that_is_free_to_turn_is_refused() -> None:
    joint = paper_joint()
    problem = joint.replace(
        supports=(Support(x=0.0, translational=math.inf),), stops=(Stop(x=2.5, side="top", gap=1e-3, stiffness=1e5),)
    )
    period_map = analytic.Solver(n_modes=8).period_map(problem)
    origin: SectionPoint = period_map.initial()
    with pytest.raises(InputError, match="free to move as a rigid body"):
        plane_directions(period_map, problem, origin, Plane.from_text("z(2.5),v(2.5)"))
    with pytest.raises(InputError, match="no energy bounds its motion"):
        energy_roots(period_map, problem, origin)
