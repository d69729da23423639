"""Motions with masses, steps and static loads: limits, other integrators, stated errors, and section points."""

from __future__ import annotations

import math

import numpy as np
import pytest
from beams import CLAMP, UNIT

import fe_lapjoint
from fe_lapjoint.march.crowding import MOST_SWITCHES
from fe_lapjoint.march.march import window_of
from fe_lapjoint.march.model import Model
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.mesh import mesh_nodes
from lapjoint import FREE, BaseMotion, Beam, ModalDamping, PolynomialShape, Problem, Stop, Support
from lapjoint.orbits.displaced import energy_roots, plane_directions
from lapjoint.problem import BeamSegment, Gravity, Mass, UniformLoad
from lapjoint.problem.plane import Plane


def loaded(seed: int = 0) -> Problem:
    """A damped cantilever of three segments, with two masses, between stops, under gravity and on a moving base."""
    rng = np.random.default_rng((7, seed))
    ends = (float(rng.uniform(0.2, 0.4)), float(rng.uniform(0.5, 0.8)), 1.0)
    segments = tuple(
        BeamSegment(
            to=to, bending_stiffness=float(10 ** rng.uniform(0, 1)), mass_per_length=float(10 ** rng.uniform(-1, 0))
        )
        for to in ends
    )
    stops = tuple(Stop(x=1.0, side=side, gap=2e-3, stiffness=3e3) for side in ("top", "bottom"))
    return Problem(
        beam=Beam(length=1.0, segments=segments),
        supports=(CLAMP,),
        masses=(
            Mass(x=1.0, mass=float(rng.uniform(0.1, 1)), rotary_inertia=0.01),
            Mass(x=ends[0], mass=float(rng.uniform(0.1, 1))),
        ),
        stops=stops,
        damping=ModalDamping(ratio=0.03),
        gravity=Gravity(acceleration=-5e-3),
        uniform_loads=(UniformLoad(start=0.3, to=0.9, force_per_length=2e-3),),
        base_motion=BaseMotion(amplitude=2e-3, angular_frequency=float(rng.uniform(2, 8))),
    )


@pytest.mark.parametrize("mass", [1e6, 1e12])
def test_a_heavy_mass_stays_in_space(mass: float) -> None:
    """On a base that moves by y, from rest relative to it, a heavy mass keeps its speed: z = y'(0) t - y."""
    base = BaseMotion(amplitude=1e-3, angular_frequency=20.0)
    problem = Problem(beam=UNIT, supports=(CLAMP,), masses=(Mass(x=1.0, mass=mass),), base_motion=base)
    history = fe_lapjoint.Solver(elements=20).simulate(problem, 1.0, errors=False)
    t = np.linspace(0.0, 1.0, 41)
    exact = 1e-3 * (20.0 * t - np.sin(20.0 * t))
    assert history.displacement(1.0, t)[0] == pytest.approx(exact, rel=5 / mass, abs=1e-3 * (100 / mass + 1e-9))


def test_equal_segments_move_as_one_beam_to_the_last_bit() -> None:
    one = loaded().replace(beam=Beam(length=1.0, bending_stiffness=2.0, mass_per_length=0.5))
    parts = tuple(BeamSegment(to=to, bending_stiffness=2.0, mass_per_length=0.5) for to in (0.37, 0.61, 1.0))
    solver = fe_lapjoint.Solver(elements=12)
    whole, cut = (
        solver.simulate(it, 6.0, errors=False) for it in (one, one.replace(beam=Beam(length=1.0, segments=parts)))
    )
    assert len(whole.contacts) > 2
    assert whole.contacts == cut.contacts


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1])
def test_another_integrator_moves_it_alike(seed: int) -> None:
    problem, t = loaded(seed), np.linspace(0.0, 3.0, 61)
    exact, radau = (
        fe_lapjoint.Solver(elements=4, method=method, rtol=1e-9, atol=1e-13).simulate(problem, 3.0, errors=False)
        for method in ("exact", "Radau")
    )
    assert [(c.stop, c.open_end) for c in exact.contacts] == [(c.stop, c.open_end) for c in radau.contacts]
    z = exact.displacement([0.5, 1.0], t)
    assert radau.displacement([0.5, 1.0], t) == pytest.approx(z, abs=1e-6 * np.abs(z).max())


def stated_errors_cover(seed: int) -> bool:
    """Whether the impulses of the first contacts on a mesh are as near to those of a fine mesh as their errors say."""
    problem = loaded(seed)
    coarse = fe_lapjoint.Solver(elements=10).simulate(problem, 4.0)
    fine = fe_lapjoint.Solver(elements=60).simulate(problem, 4.0, errors=False)
    pairs = list(zip(coarse.contacts, fine.contacts, strict=False))[:4]
    known = [(a, b, a.impulse_error) for a, b in pairs if not a.open_end and a.stop == b.stop]
    return all(abs(a.impulse - b.impulse) <= error for a, b, error in known if error is not None)


def test_stated_errors_cover_the_truth() -> None:
    assert sum(stated_errors_cover(seed) for seed in range(4)) >= 3


@pytest.mark.slow
def test_stated_errors_cover_the_truth_in_a_population() -> None:
    assert sum(stated_errors_cover(100 + seed) for seed in range(60)) >= 0.92 * 60


def test_a_retuned_map_keeps_masses_and_static_loads() -> None:
    problem = loaded()
    solver = fe_lapjoint.Solver(elements=10)
    other = problem.replace(base_motion=BaseMotion(amplitude=2e-3, angular_frequency=5.5))
    fresh = solver.period_map(other)
    retuned = solver.period_map(problem).retuned("base_motion.angular_frequency", 5.5, lambda: other)
    assert retuned is not None
    one, two = (it.march(it.initial(), 8) for it in (fresh, retuned))
    assert np.abs(one.impulses).max() > 0
    assert two.impulses == pytest.approx(one.impulses, rel=1e-12)


def test_displaced_starts_know_masses_and_steps() -> None:
    """The energy of a static shape is half of force times displacement; a plane moves what it says."""
    problem = loaded()
    period_map = fe_lapjoint.Solver(elements=16).period_map(problem)
    origin = period_map.initial()
    shapes = period_map.static_shapes(origin, np.array([0.45, 1.0]))
    energy = shapes.displacements @ period_map.energy(origin) @ shapes.displacements.T
    assert energy == pytest.approx(shapes.compliance, rel=1e-9)
    pieces = problem.beam.pieces
    tip = sum(((1 - p.start) ** 3 - (1 - p.end) ** 3) / (3 * p.EI) for p in pieces)  # by the moment over EI
    assert shapes.compliance[1, 1] == pytest.approx(tip, rel=1e-10)
    rows = plane_directions(period_map, problem, origin, Plane.from_text("z(0.45),v(1.0)"))
    history = period_map.history(period_map.moved(origin, np.array([1e-3, 0.2]) @ rows), 1)
    assert history.displacement(0.45, [0.0])[0, 0] == pytest.approx(1e-3, rel=1e-9)
    assert history.velocity(1.0, [0.0])[0, 0] == pytest.approx(0.2, rel=1e-9)
    # the kinetic energy of a deviation counts the masses: that of a translation of the tip's mass and the beam
    roots = energy_roots(period_map, problem, origin)
    assert roots.T @ period_map.energy(origin) @ roots == pytest.approx(np.eye(roots.shape[1]), abs=1e-9)


def test_a_section_point_is_adopted_from_another_mesh_and_another_beam() -> None:
    problem = loaded()
    fine, coarse = (fe_lapjoint.Solver(elements=n).period_map(problem) for n in (40, 11))
    point = coarse.march(coarse.initial(), 5).end
    there = fine.history(fine.adopted(point), 1).displacement([0.2, 0.7, 1.0], [0.0])
    here = coarse.history(point, 1).displacement([0.2, 0.7, 1.0], [0.0])
    assert there == pytest.approx(here, rel=1e-6)  # an element of one mesh spans nodes of the other
    plain = problem.replace(masses=(), beam=Beam(length=1.0, bending_stiffness=2.0, mass_per_length=0.5))
    uniform = fe_lapjoint.Solver(elements=11).period_map(plain)
    taken = uniform.history(uniform.adopted(point), 1).displacement(1.0, [0.0])
    assert taken == pytest.approx(here[-1:], rel=1e-9)


def test_a_mass_on_a_spring_swings_as_an_oscillator() -> None:
    """A heavy mass at the tip of a pinned beam on a spring: k / (M + m / 3), for the beam hardly bends."""
    supports = (Support(x=0.0, translational=math.inf), Support(x=1.0, translational=1e-2))
    for mass, turning in ((1e4, 0.0), (1e4, 2e3)):
        problem = Problem(beam=UNIT, supports=supports, masses=(Mass(x=1.0, mass=mass, rotary_inertia=turning),))
        omega = fe_lapjoint.Solver(elements=10).modes(problem, count=1).angular_frequencies[0]
        assert omega == pytest.approx(math.sqrt(1e-2 / (mass + turning + 1 / 3)), rel=1e-3)


@pytest.mark.parametrize("mass", [1e2, 1e6, 1e10])
def test_a_heavy_mass_leaves_the_windows_of_the_search_as_short(mass: float) -> None:
    """Beside it the beam rattles as fast as before; on soft springs all swings slowly, with the mass or without."""
    soft = tuple(Support(x=x, translational=1e-4) for x in (0.0, 1.0))
    for supports, least in (((CLAMP,), 0.9), (soft, 0.5)):
        bare = Problem(beam=UNIT, supports=supports)
        heavy = bare.replace(masses=(Mass(x=0.4, mass=mass),))
        one, other = (
            window_of(Model(it, Assembly(it, mesh_nodes(it, 8, None)), "exact", 1e-9, 1e-12), FREE)
            for it in (bare, heavy)
        )
        assert least * one < other < 2 * one


@pytest.mark.slow
def test_a_beam_that_rattles_between_heavy_masses_is_no_crowd() -> None:
    """Contacts in thousands within one swing of a mass of 1e8 beams, under modal damping, are not taken for sliding."""
    problem = Problem(
        beam=UNIT,
        supports=(CLAMP,),
        masses=(Mass(x=1.0, mass=1e8),),
        stops=(Stop(x=0.5, side="top", gap=1e-5, stiffness=50.0), Stop(x=0.5, side="bottom", gap=1e-5, stiffness=50.0)),
        damping=ModalDamping(ratio=1e-4),
        initial=PolynomialShape(velocity=(0.0, 0.0, 1.0, -1.0)),
    )
    history = fe_lapjoint.Solver(elements=4).simulate(problem, 900.0, errors=False)
    assert len(history.contacts) > MOST_SWITCHES  # half of them by each stop, of two switches each
