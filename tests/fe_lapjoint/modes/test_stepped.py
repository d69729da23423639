"""Masses and steps: frequencies against eighty digits of a witness of its own, limits, and static loads in closed form.

The witness, `exact_beams`, knows exact members and counts its roots; it shares nothing with finite elements.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from beams import CLAMP, UNIT
from exact_beams import ExactBeam
from random_joints import random_beam

import fe_lapjoint
from fe_lapjoint.march.system import build_system
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.eigenmodes import eigenmodes
from fe_lapjoint.modes.mesh import CLOSE, mesh_nodes, split_elements
from lapjoint import FREE, Beam, InputError, Problem, SolverError, Support
from lapjoint.problem import BeamSegment, FloatArray, Gravity, Mass, UniformLoad
from lapjoint.problem.load_shape import LoadShape

MODES = 6
NEAR = 5e-4  # of the length: the least distance of two parts, but by chance
FLOOR = 3e-11
"""Relative rounding of frequencies."""


def cantilever(beam: Beam = UNIT, *masses: Mass, **parts: object) -> Problem:
    return Problem(beam=beam, supports=(CLAMP,), masses=masses, **parts)


def stepped(*pieces: tuple[float, float, float], **parts: float) -> Beam:
    """A beam of pieces: end, EI and mass per length."""
    segments = tuple(BeamSegment(to=to, bending_stiffness=EI, mass_per_length=m) for to, EI, m in pieces)
    return Beam(length=pieces[-1][0], segments=segments, **parts)


def errors_of(problem: Problem, meshes: list[tuple[float, ...]]) -> FloatArray:
    """Relative errors of the lowest frequencies on some meshes, 0 of rigid-body modes."""
    exact = np.array(ExactBeam.of(problem).frequencies(MODES))
    found = np.array([fe_lapjoint.Solver(nodes=it).modes(problem, FREE, MODES).angular_frequencies for it in meshes])
    assert np.array_equal(found == 0.0, np.broadcast_to(exact == 0.0, found.shape))
    return np.where(exact == 0.0, 0.0, found / np.where(exact == 0.0, 1.0, exact) - 1)


def assert_order_four(problem: Problem) -> None:
    """On meshes of 40 elements or so, cut in two and in two again: the last error is a sixteenth, down to rounding.

    On the first one a stiff piece beside soft ones may have a single element, which does not resolve its waves yet.
    """
    nodes = tuple(mesh_nodes(problem, 40, None).tolist())
    coarse, middle, fine = errors_of(problem, [split_elements(nodes, parts) for parts in (1, 2, 4)])
    assert np.all(coarse < 2e-3)
    assert np.all(np.array([middle, fine]) > -FLOOR)  # Rayleigh: a mesh stiffens
    assert np.all(middle <= coarse + FLOOR)
    assert np.all(fine <= middle / 16 * 1.6 + FLOOR)


@pytest.mark.parametrize(
    "number", [0, 1, 2, *(pytest.param(number, marks=pytest.mark.thorough) for number in range(3, 8))]
)
def test_frequencies_converge_at_order_four(number: int) -> None:
    assert_order_four(random_beam(np.random.default_rng((1, number)), decades=1.5, heaviest=1e3))


@pytest.mark.slow
def test_frequencies_of_150_random_beams_converge_at_order_four() -> None:
    for number in range(150):
        assert_order_four(random_beam(np.random.default_rng((2, number)), decades=2.5, heaviest=1e10))


def assert_exact(problem: Problem) -> None:
    """The finer of two meshes is as near to the truth as their distance and the order say."""
    exact = np.array(ExactBeam.of(problem).frequencies(MODES))
    coarse, fine = (fe_lapjoint.Solver(elements=n).modes(problem, FREE, MODES).angular_frequencies for n in (40, 160))
    assert np.array_equal(coarse == 0.0, exact == 0.0)
    assert np.all(np.abs(fine - exact) <= np.abs(coarse - exact) / 64 + FLOOR * exact)
    assert np.all(np.abs(coarse - exact) <= 1e-3 * exact)


@pytest.mark.parametrize(
    "number", [0, 1, *(pytest.param(number, marks=pytest.mark.thorough) for number in range(2, 4))]
)
def test_heavy_masses_and_soft_springs_keep_the_digits(number: int) -> None:
    assert_exact(random_beam(np.random.default_rng((4, number)), heaviest=1e10, near=NEAR))


def test_a_bending_mode_may_be_slower_than_a_motion_on_soft_springs() -> None:
    """A rotary inertia of 1e10 beams turns slowly, the beam bends; the whole swings faster on its springs."""
    supports = (Support(x=0.0, translational=0.02), Support(x=1.0, translational=0.01, torsional=50.0))
    turning = Mass(x=0.25, mass=10.0, rotary_inertia=1e10)
    assert_exact(Problem(beam=UNIT, supports=supports, masses=(turning,)))


@pytest.mark.slow
def test_frequencies_of_150_harsh_beams_keep_their_digits() -> None:
    refused = 0
    for number in range(150):
        problem = random_beam(np.random.default_rng((5, number)), heaviest=1e10, near=NEAR)
        parts = (*problem.masses, *problem.supports, *problem.stops)
        places = sorted({0.0, *(it.x for it in parts), *(it.end for it in problem.beam.pieces)})
        if np.diff(places).min() < CLOSE * problem.beam.length:
            with pytest.raises(InputError, match="too near for finite elements"):
                frequencies(problem)
            refused += 1
        else:
            assert_exact(problem)
    assert refused < 15  # places that happen to lie within 1e-4 of each other


def frequencies(problem: Problem, count: int = 4, elements: int = 60) -> FloatArray:
    return fe_lapjoint.Solver(elements=elements).modes(problem, FREE, count).angular_frequencies


def test_a_mass_that_vanishes_changes_nothing() -> None:
    bare = frequencies(cantilever())
    assert np.array_equal(frequencies(cantilever(UNIT, Mass(x=1.0, mass=0.0))), bare)
    for size in (1e-3, 1e-6, 1e-9):
        # Rayleigh: omega^2 falls by the mass times the mode's square at the tip, which is 4
        found = frequencies(cantilever(UNIT, Mass(x=1.0, mass=size)))
        assert 1 - found / bare == pytest.approx(2 * size, rel=0.02, abs=1e-13)


@pytest.mark.parametrize("size", [1e4, 1e8, 1e12])
def test_a_mass_that_grows_pins_the_tip(size: float) -> None:
    pinned = frequencies(Problem(beam=UNIT, supports=(CLAMP, Support(x=1.0, translational=math.inf))), 3)
    found = frequencies(cantilever(UNIT, Mass(x=1.0, mass=size)))
    assert found[0] == pytest.approx(math.sqrt(3 / (size + 33 / 140)), rel=1e-6 / size + 1e-11)
    assert found[1:] == pytest.approx(pinned, rel=2 / size + FLOOR)


def test_a_rotary_inertia_that_grows_clamps_the_tip_in_slope() -> None:
    guided = frequencies(Problem(beam=UNIT, supports=(CLAMP, Support(x=1.0, torsional=math.inf))), 3)
    found = frequencies(cantilever(UNIT, Mass(x=1.0, mass=0.0, rotary_inertia=1e10)))
    assert found[0] == pytest.approx(1e-5, rel=1e-9)  # EI / L against the inertia: its own root, free to move
    assert found[1:] == pytest.approx(guided, rel=1e-9)


def test_equal_segments_are_one_beam_to_the_last_bit() -> None:
    in_three = stepped((0.21, 1.0, 1.0), (0.74, 1.0, 1.0), (1.0, 1.0, 1.0))
    assert np.array_equal(frequencies(cantilever(in_three)), frequencies(cantilever()))


def test_a_segment_that_vanishes_leaves_the_beam_without_it() -> None:
    bare = frequencies(cantilever())
    for d in (1e-2, 1e-3, 2e-4):
        problem = cantilever(stepped((0.5, 1.0, 1.0), (0.5 + d, 0.1, 2.0), (1.0, 1.0, 1.0)))
        exact = np.array(ExactBeam.of(problem).frequencies(4))
        found = frequencies(problem)
        assert found - exact == pytest.approx(
            frequencies(cantilever()) - ExactBeam.of(cantilever()).frequencies(4), rel=1
        )
        assert found == pytest.approx(bare, rel=20 * d)
    near = cantilever(stepped((0.5, 1.0, 1.0), (0.5 + CLOSE / 2, 0.1, 2.0), (1.0, 1.0, 1.0)))
    with pytest.raises(InputError, match=r"beam.segments\[1\].to = .*too near .*allowed are the same place, or at"):
        frequencies(near)


def test_elements_follow_the_waves_of_each_piece() -> None:
    """A piece 1e4 times as soft has waves of a tenth of the length, and elements ten times as short."""
    nodes = mesh_nodes(cantilever(stepped((0.5, 1e4, 1.0), (1.0, 1.0, 1.0))), 44, None)
    h = np.diff(nodes)
    assert h[nodes[:-1] < 0.5].max() == pytest.approx(10 * h[-1], rel=0.15)
    assert abs(h.size - 44) <= 1
    assert mesh_nodes(cantilever(), 44, None).size == 45


def test_no_element_is_shorter_than_what_is_refused() -> None:
    nodes = mesh_nodes(cantilever(stepped((0.5, 1e9, 1.0), (0.501, 1.0, 1.0), (1.0, 1e9, 1.0))), 1000, None)
    assert np.diff(nodes).min() >= CLOSE * (1 - 1e-9)


def test_a_mesh_that_double_precision_cannot_hold_is_refused() -> None:
    beam = stepped((0.5, 1e9, 1.0), (1.0, 1.0, 1.0))
    nodes = tuple(np.union1d(np.linspace(0.0, 0.015, 101), np.linspace(0.02, 1.0, 20)).tolist())
    with pytest.raises(SolverError, match=r"singular to rounding: its elements are 0.00015 to .* a factor of 1e"):
        fe_lapjoint.Solver(nodes=nodes).modes(Problem(beam=beam), FREE, 4)


@pytest.mark.parametrize("at", [CLOSE / 2, 1e-7])
@pytest.mark.parametrize("mass", [Mass(x=0.5, mass=1e-3), Mass(x=0.5, mass=0.0, rotary_inertia=1e-9)])
def test_a_mass_beside_a_node_is_refused(at: float, mass: Mass) -> None:
    moved = mass.model_copy(update={"x": 1.0 - at})
    with pytest.raises(InputError, match=r"masses\[0\].x = .*too near for finite elements"):
        frequencies(cantilever(UNIT, moved))


@pytest.mark.parametrize(("kt", "k"), [(1e-2, 0.0), (0.0, 5e6), (0.15, 0.0), (0.0, 1e9)])
@pytest.mark.parametrize("d", [9e-5, 1e-5])
def test_a_spring_beside_a_pin_is_right_or_refused(kt: float, k: float, d: float) -> None:
    supports = (Support(x=0.3, translational=math.inf), Support(x=0.3 + d, translational=k, torsional=kt))
    problem = Problem(beam=UNIT, supports=supports)
    try:
        found = frequencies(problem, 3, 200)
    except InputError:
        assert max(kt * d, k * d**3) > 1e-6
    else:
        assert found == pytest.approx(ExactBeam.of(problem).frequencies(3), rel=1e-6)


def static(problem: Problem, x: float) -> float:
    """Displacement of the free joint at a position under its constant loads, m."""
    assembly = Assembly(problem, mesh_nodes(problem, 7, None))
    system = build_system(assembly, FREE)
    return float(assembly.reading(x) @ system.vectors @ system.equilibrium)


def test_gravity_bends_as_a_load_along_the_beam() -> None:
    heavy = Beam(length=2.0, bending_stiffness=5.0, mass_per_length=3.0, contents_per_length=1.0)
    wet = heavy.model_copy(update={"added_mass_per_length": 7.0})
    q, L, EI = -9.81 * 4.0, 2.0, 5.0
    for beam in (heavy, wet):  # of the water around the beam gravity takes nothing
        hung = cantilever(beam, gravity=Gravity(acceleration=-9.81))
        assert static(hung, L) == pytest.approx(q * L**4 / (8 * EI), rel=1e-11)
    loaded = cantilever(heavy, Mass(x=L, mass=2.5, rotary_inertia=3.0), gravity=Gravity(acceleration=-9.81))
    assert static(loaded, L) == pytest.approx(q * L**4 / (8 * EI) - 2.5 * 9.81 * L**3 / (3 * EI), rel=1e-11)


@pytest.mark.parametrize(("a", "b"), [(0.0, 0.3), (0.2, 0.7), (0.45, 1.0), (1 - 3e-5, 1.0), (0.3, 0.3 + 2e-5)])
def test_a_load_along_a_part_of_the_beam_bends_as_in_closed_form(a: float, b: float) -> None:
    """The tip of a cantilever under q from a to b: q (L x^3 - x^4 / 4) / 6 EI between them; b - a near 0 too."""
    loaded = cantilever(uniform_loads=(UniformLoad(start=a, to=b, force_per_length=2.0),))
    exact = 2.0 / 6 * ((b**3 - b**4 / 4) - (a**3 - a**4 / 4))
    assert static(loaded, 1.0) == pytest.approx(exact, rel=1e-9)


def test_a_stepped_beam_sags_as_in_closed_form() -> None:
    """The tip of a cantilever with a step at the middle, by the moment over EI: q (15 / EI_1 + 1 / EI_2) / 128."""
    beam = stepped((0.5, 4.0, 1.0), (1.0, 0.25, 1.0))
    loaded = cantilever(beam, uniform_loads=(UniformLoad(force_per_length=1.0),))
    assert static(loaded, 1.0) == pytest.approx((15 / 4.0 + 1 / 0.25) / 128, rel=1e-11)


def test_the_base_drives_all_that_moves() -> None:
    """The load of a base is the mass matrix times a translation, to rounding, and of turning masses nothing."""
    beam = stepped((0.3, 1.0, 2.0), (1.0, 3.0, 0.5), contents_per_length=0.25, added_mass_per_length=1.0)
    problem = Problem(beam=beam, masses=(Mass(x=0.6, mass=2.0, rotary_inertia=5.0), Mass(x=1.0, mass=0.1)))
    assembly = Assembly(problem, mesh_nodes(problem, 9, None))
    translation = np.tile([1.0, 0.0], assembly.nodes.size)
    load = assembly.load(problem.structure.inertia)
    assert load == pytest.approx(assembly.mass @ translation, abs=1e-14)
    assert load @ translation == pytest.approx(2.0 * 0.3 + 0.5 * 0.7 + 1.25 + 2.1, rel=1e-14)


def test_loads_act_where_they_are_whatever_the_nodes() -> None:
    """A load between nodes does the work on cubics that its integral is."""
    assembly = Assembly(Problem(beam=UNIT), np.array([0.0, 0.4, 1.0]))
    load = assembly.load(LoadShape.along(0.1, 0.7))
    x, w = np.polynomial.legendre.leggauss(8)
    parts = [((b - a) / 2, (a + b) / 2) for a, b in ((0.1, 0.4), (0.4, 0.7))]
    exact = sum(half * w @ assembly.shapes(middle + half * x, 0) for half, middle in parts)
    assert load == pytest.approx(exact, abs=1e-15)


def test_modes_are_orthonormal_with_masses() -> None:
    problem = next(it for it in (random_beam(np.random.default_rng((1, n))) for n in range(99)) if len(it.masses) == 3)
    assembly = Assembly(problem, mesh_nodes(problem, 40, None))
    vectors = eigenmodes(assembly, FREE)[1]
    assert vectors.T @ assembly.mass @ vectors == pytest.approx(np.eye(vectors.shape[1]), abs=1e-12)
