"""Modes of several beams with links and stops between them: order four against a witness that counts, and limits.

The witness, `linked_beams`, knows exact members and counts its roots; it shares nothing with finite elements.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from linked_beams import ExactBeams, random_beams, random_state

import fe_lapjoint
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.eigenmodes import eigenmodes
from fe_lapjoint.modes.mesh import mesh_nodes, refined_nodes
from lapjoint import FREE, Beam, ContactState, InputError, Mass, Problem, Stop, Support
from lapjoint.problem import FloatArray, Link, NamedBeam

CLAMP = Support(x=0.0, translational=math.inf, torsional=math.inf)
SOLVER = fe_lapjoint.Solver(elements=20)
COUNT = 6


def beam(name: str = "a", *supports: Support, **parts: object) -> NamedBeam:
    given = {"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0} | parts
    return NamedBeam(name=name, supports=supports, **given)


def frequencies(problem: Problem, state: ContactState = FREE, count: int = 8) -> FloatArray:
    return SOLVER.modes(problem, state, count).angular_frequencies


def check_order_four(number: int, *, soft: float = -3.0, ratio: float = 30.0) -> None:
    """On meshes of 10, 20 and 40 elements a beam errors are above 0 and fall to a sixteenth, to rounding.

    Curvatures, from which frequencies are computed, lose digits as the highest frequency of the mesh over a bending
    frequency; motions that do not bend lose none.
    """
    rng = np.random.default_rng((49, number))
    problem = random_beams(rng, soft=soft, ratio=ratio)
    state, nodes = random_state(rng, problem), mesh_nodes(problem, 10, None)
    meshes = [Assembly(problem, refined_nodes(problem, nodes, times)) for times in (1, 2, 4)]
    every = [eigenmodes(mesh, state)[0] for mesh in meshes]
    rigid, witness = int(np.count_nonzero(every[0] == 0)), ExactBeams(problem, state)
    assert witness.exact_count(1e-6 * every[0][rigid]) == rigid
    exact = np.array(witness.frequencies(COUNT, rigid))[rigid:]
    coarse, middle, fine = (omega[rigid:COUNT] / exact - 1 for omega in every)
    floor = [np.finfo(float).eps * omega[-1] / np.maximum(exact, problem.line.slowest_bending) for omega in every]
    for before, after, rounding in ((coarse, middle, floor[1]), (middle, fine, floor[2])):
        assert np.all(after >= -rounding)  # Rayleigh: a mesh stiffens
        assert np.all(after <= before / 16 * 1.6 + rounding)


@pytest.mark.parametrize("number", [*range(5), *(pytest.param(n, marks=pytest.mark.thorough) for n in range(5, 10))])
def test_frequencies_converge_at_order_four(number: int) -> None:
    check_order_four(number)


@pytest.mark.slow
def test_frequencies_of_120_random_systems_converge_at_order_four() -> None:
    for number in range(100, 180):
        check_order_four(number)
    for number in range(200, 240):
        check_order_four(number, soft=-10.0, ratio=1e4)


def test_beams_that_nothing_joins_have_their_own_modes() -> None:
    """A link without stiffness, and an open stop, join nothing: the frequencies are those of two problems."""
    one, other = beam("a", CLAMP), beam("b", Support(x=0.7, translational=3.0), length=0.7, bending_stiffness=5.0)
    both = Problem(
        beams=(one, other),
        links=(Link(between=("a:1.0", "b:0.0")),),
        stops=(Stop(between=("a:0.5", "b:0.2"), gap=1e-3, stiffness=1e3),),
    )
    alone = [
        frequencies(
            Problem(beam=Beam(length=it.length, bending_stiffness=it.EI, mass_per_length=it.m), supports=it.supports)
        )
        for it in (one, other)
    ]
    marked = [
        frequencies(Problem(beams=(it,), stops=(Stop(x=f"{it.name}:{x}", side="top", gap=1.0, stiffness=1.0),)))
        for it, x in ((one, 0.5), (other, 0.2))
    ]
    both_found = frequencies(both, count=12)
    assert both_found == pytest.approx(np.sort(np.concatenate(marked))[:12], rel=1e-12)
    assert both_found == pytest.approx(np.sort(np.concatenate(alone))[:12], rel=1e-4)  # another mesh


def test_two_equal_beams_that_are_joined_everywhere_are_one_of_twice_the_stiffness_and_mass() -> None:
    places = np.linspace(0.0, 1.0, 11)
    rigid = {"translational": math.inf, "torsional": math.inf}
    links = tuple(Link(between=(f"a:{x}", f"b:{x}"), **rigid) for x in places.tolist())
    mass = Mass(x=1.0, mass=0.5, rotary_inertia=0.01)
    both = Problem(beams=(beam("a", CLAMP, masses=(mass,)), beam("b")), links=links)
    one = Problem(beam=Beam(length=1.0, bending_stiffness=2.0, mass_per_length=2.0), supports=(CLAMP,), masses=(mass,))
    assert frequencies(both) == pytest.approx(frequencies(one), rel=1e-11)
    x = np.linspace(0.0, 1.0, 33)
    for name in "ab":
        shapes = np.abs(SOLVER.modes(both, FREE, 4).shapes(both.line.starts["ab".index(name)] + x))
        assert shapes == pytest.approx(np.abs(SOLVER.modes(one, FREE, 4).shapes(x)), abs=1e-9)


def test_beams_welded_end_to_end_are_one_beam() -> None:
    """The second begins where the first ends, and has another stiffness: a step."""
    weld = Link(between=("a:0.4", "b:0.0"), translational=math.inf, torsional=math.inf)
    parts = beam("a", CLAMP, length=0.4), beam("b", length=0.6, bending_stiffness=3.0, mass_per_length=2.0)
    segments = [{"to": 0.4, "bending_stiffness": 1.0, "mass_per_length": 1.0}]
    segments.append({"to": 1.0, "bending_stiffness": 3.0, "mass_per_length": 2.0})
    one = Problem(beam=Beam(length=1.0, segments=segments), supports=(CLAMP,))
    both = Problem(beams=parts, links=(weld,))
    first, second = np.linspace(0.0, 0.4, 21), np.linspace(0.0, 0.6, 21)
    meshes = [tuple(np.concatenate([first, start + second]).tolist()) for start in (0.4, both.line.starts[1])]
    found = [
        fe_lapjoint.Solver(nodes=mesh).modes(it, FREE, 8).angular_frequencies
        for it, mesh in zip((one, both), meshes, strict=True)
    ]
    assert found[1] == pytest.approx(found[0], rel=1e-11)


@pytest.mark.parametrize("kappa", [1e-12, 1e-9, 1e-6, 1e-3])
def test_equal_beams_on_a_soft_link_have_pairs(kappa: float) -> None:
    """The sum of both moves as one beam alone, the difference as one on a spring of twice the stiffness."""
    both = Problem(
        beams=(beam("a", CLAMP), beam("b", CLAMP)), links=(Link(between=("a:1.0", "b:1.0"), translational=kappa),)
    )
    one = Problem(beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0), supports=(CLAMP,))
    held = one.replace(supports=(CLAMP, Support(x=1.0, translational=2 * kappa)))
    pairs = np.stack([frequencies(one), frequencies(held)], axis=1).ravel()
    assert frequencies(both, count=12) == pytest.approx(pairs[:12], rel=1e-11)


def test_links_that_close_a_loop_hold_no_more_than_once() -> None:
    """Three beams welded to each other at one place, by two welds or by three."""
    rigid = {"translational": math.inf, "torsional": math.inf}
    names = ("a", "b", "c")
    links = [Link(between=(f"{i}:0.5", f"{j}:0.3"), **rigid) for i, j in (("a", "b"), ("b", "c"), ("c", "a"))]
    links[1] = Link(between=("b:0.3", "c:0.5"), **rigid)
    links[2] = Link(between=("c:0.5", "a:0.5"), **rigid)
    beams = tuple(beam(name, length=1.0) for name in names)
    two, three = (Problem(beams=beams, links=tuple(links[:n])) for n in (2, 3))
    assert np.array_equal(frequencies(two), frequencies(three))
    assert np.count_nonzero(frequencies(three) == 0) == 2


def test_a_hinge_leaves_its_rigid_motions() -> None:
    """Two free beams hinged at an end: shift, and both turn, as heavy as one may be; pinned besides: both turn."""
    hinge = Link(between=("a:1.0", "b:0.0"), translational=math.inf)
    for mass in (0.0, 1e3, 1e9):
        beams = (beam("a"), beam("b", masses=(Mass(x=1.0, mass=mass),)))
        free = Problem(beams=beams, links=(hinge,))
        assert np.count_nonzero(frequencies(free) == 0) == 3
        pinned = free.replace(beams=(beam("a", Support(x=0.0, translational=math.inf)), beams[1]))
        assert np.count_nonzero(frequencies(pinned) == 0) == 2


def test_modes_are_orthonormal_and_satisfy_the_links() -> None:
    rng = np.random.default_rng(5)
    problem = random_beams(rng)
    assembly = Assembly(problem, mesh_nodes(problem, 20, None))
    vectors = eigenmodes(assembly, FREE)[1]
    assert vectors.T @ assembly.mass @ vectors == pytest.approx(np.eye(vectors.shape[1]), abs=1e-11)
    for link in problem.structure.links:
        for derivative, k in enumerate((link.translational, link.torsional)):
            if math.isinf(k):
                one, other = (assembly.shapes(np.array([x]), derivative) for x in (link.first, link.second))
                assert one == pytest.approx(other, abs=1e-12)


def test_each_beam_has_the_mesh_that_it_has_alone_and_a_space_is_one_element() -> None:
    one, other = beam("a", CLAMP), beam("b", length=0.01)
    both = Problem(beams=(one, other))
    nodes, start = mesh_nodes(both, 10, None), both.line.starts[1]
    assert nodes == pytest.approx([*np.linspace(0, 1, 11), *(start + np.linspace(0, 0.01, 11))], abs=1e-15)
    finer = refined_nodes(both, nodes, 1.5)
    assert finer.size == 2 * 16
    assert not np.any((finer > 1.0) & (finer < start))
    given = mesh_nodes(both, 10, (0.5, 1.1, start + 0.004))  # on a space there is nothing
    assert given == pytest.approx([0, 0.5, 1.0, start, start + 0.004, start + 0.01], abs=1e-15)


def test_a_space_has_no_displacement_and_the_start_of_a_beam_is_its_own() -> None:
    both = Problem(beams=(beam("a", CLAMP), beam("b", CLAMP, bending_stiffness=2.0)))
    shapes, start = SOLVER.modes(both, FREE, 4).shapes, both.line.starts[1]
    for derivative in range(4):
        assert np.all(shapes(np.array([1.0 + 1e-9, 1.1, start - 1e-9]), derivative) == 0)
    for derivative in range(4):
        at, beside = (shapes(np.array([x]), derivative) for x in (start, start + 1e-12))
        assert at == pytest.approx(beside, rel=1e-8, abs=1e-9)


def test_places_too_near_for_elements_are_named() -> None:
    link = Link(between=("a:0.00001", "b:0.5"), translational=math.inf)
    with pytest.raises(InputError, match=r"links\[0\].between = a:1e-05: lies 1e-05 m from .* at a:0 m, too near"):
        frequencies(Problem(beams=(beam("a", CLAMP), beam("b")), links=(link,)))
