"""Modes of several beams with links and stops between them: against a witness that counts in fifty digits, and limits.

The witness, `linked_beams`, assembles members and counts by Wittrick and Williams; it shares nothing with the solver.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from linked_beams import ExactBeams, equal_beams, random_beams, random_state, resting_beams, stiffer_links

import analytic
from analytic.march.modal_state import loaded_structure, modal_state
from analytic.modes.beam_functions import gram, inertia_of
from analytic.modes.characteristic_equation import layout_of
from analytic.modes.coupled_beams import CoupledBeams
from analytic.modes.normal_modes import exact_modes
from lapjoint import FREE, ContactState, InputError, Mass, Problem, SolverError, Stop, Support
from lapjoint.problem import FloatArray, Link, NamedBeam

COUNT = 24
NEAR = 1e-10  # of each frequency, however slow
CLAMP = Support(x=0.0, translational=math.inf, torsional=math.inf)


def check_modes(problem: Problem, state: ContactState, rng: np.random.Generator) -> None:
    """Frequencies lie where the count steps over their numbers, and modes are orthonormal."""
    modes, witness = exact_modes(problem, state, COUNT), ExactBeams(problem, state)
    rigid = int(np.count_nonzero(modes.omega == 0))
    if not state.closed:
        assert rigid == problem.structure.free_motions
    near = NEAR * modes.omega
    for k in {rigid, rigid + 1, int(rng.integers(rigid, COUNT)), int(rng.integers(rigid, COUNT)), COUNT - 1}:
        below = modes.omega[k] - near[k]
        assert witness.exact_count(below) <= k
        assert k < witness.exact_count(modes.omega[k] + near[k])
    inertia = inertia_of(problem.line, problem.structure.masses)
    assert gram(modes.shapes, modes.shapes, inertia) == pytest.approx(np.eye(COUNT), abs=1e-9)


def check_system(number: int) -> None:
    """A quarter of the systems have equal beams, a quarter beams that differ by up to 1e3, and a quarter springs nearly
    as soft as a problem may have."""
    rng, kind = np.random.default_rng((490, number)), number % 4
    if kind == 0:
        problem = equal_beams(rng)
    elif kind == 1:
        problem = random_beams(rng, soft=-13.0, ratio=10.0)
    else:
        problem = stiffer_links(rng, random_beams(rng, soft=-6.0, ratio=1e3 if kind == 2 else 30.0))
    check_modes(problem, random_state(rng, problem), rng)


@pytest.mark.parametrize("number", [*range(4), *(pytest.param(n, marks=pytest.mark.thorough) for n in range(4, 12))])
def test_frequencies_agree_with_fifty_digits_and_none_is_missed(number: int) -> None:
    check_system(number)


@pytest.mark.slow
@pytest.mark.parametrize("start", range(1000, 2000, 50))
def test_frequencies_of_1000_systems_agree_with_fifty_digits(start: int) -> None:
    """What the solver gives is right; of springs at the ends of their range it may refuse one system in fifty."""
    refused = []
    for number in range(start, start + 50):
        try:
            check_system(number)
        except SolverError as error:
            refused.append(f"{number}: {error}")
    assert len(refused) <= 1, refused


@pytest.mark.parametrize("k", [1e-8, 1e-15])
@pytest.mark.parametrize("rungs", [2, pytest.param(6, marks=pytest.mark.thorough)])
def test_soft_supports_keep_their_digits_under_many_links(k: float, rungs: int) -> None:
    """The elastic part of the receptance of beams that bend together is hidden by their rigid motion there."""
    a = plate("a", clamped=False)
    a = a.model_copy(update={"supports": (Support(x=0.3, translational=k),)})
    links = tuple(linked(x, math.inf) for x in np.linspace(0.0, 1.0, rungs).tolist())
    problem = Problem(beams=(a, plate("b", 1.2, EI=10.0, m=2.0, clamped=False)), links=links)
    check_modes(problem, FREE, np.random.default_rng(1))


def test_modes_too_slow_beside_the_stiffest_beam_are_refused() -> None:
    """1e-16 EI / L^3 and 10 m L are a frequency of 3e-9."""
    a = plate("a", clamped=False)
    heavy = {"supports": (Support(x=0.5, translational=1e-16),), "masses": (Mass(x=0.5, mass=10.0),)}
    problem = Problem(beams=(a.model_copy(update=heavy), plate("b")))
    with pytest.raises(SolverError, match=r"slower than 1e-8 .* of the stiffest beam"):
        exact_modes(problem, FREE, 4)


def plate(name: str, length: float = 1.0, *, EI: float = 1.0, m: float = 1.0, clamped: bool = True) -> NamedBeam:
    """A beam, clamped at its left end or free."""
    supports = (CLAMP,) if clamped else ()
    return NamedBeam(name=name, length=length, bending_stiffness=EI, mass_per_length=m, supports=supports)


def omega(problem: Problem, count: int, state: ContactState = FREE) -> FloatArray:
    """The lowest frequencies, rad/s."""
    return exact_modes(problem, state, count).omega


def linked(x: float, k: float, kt: float = 0.0) -> Link:
    """A link at equal places of beams a and b."""
    return Link(between=(f"a:{x}", f"b:{x}"), translational=k, torsional=kt)


def test_beams_without_links_are_two_problems() -> None:
    a, b = plate("a"), plate("b", 0.8, EI=2.0, clamped=False)
    alone = [omega(Problem(beams=(one,)), 12) for one in (a, b)]
    both = exact_modes(Problem(beams=(a, b), links=(linked(0.5, 0.0),)), FREE, 12)
    assert both.omega == pytest.approx(np.sort(np.concatenate(alone))[:12], rel=1e-14)
    # Each mode moves one beam alone.
    moved = np.array([np.abs(both.shapes(np.linspace(*ends, 9))).max(axis=1) for ends in ((0.0, 1.0), (1.25, 2.05))])
    assert np.all(moved.min(axis=0) < 1e-12 * moved.max(axis=0))


def test_equal_beams_joined_at_both_ends_have_the_modes_of_one_and_of_the_joined_ends_held() -> None:
    ends = (linked(0.0, math.inf, math.inf), linked(1.0, math.inf, math.inf))
    found = omega(Problem(beams=(plate("a", clamped=False), plate("b", clamped=False)), links=ends), 16)
    together = omega(Problem(beams=(plate("a", EI=2.0, m=2.0, clamped=False),)), 10)
    held = NamedBeam(
        **{**plate("a").model_dump(), "supports": (CLAMP, Support(x=1.0, translational=math.inf, torsional=math.inf))}
    )
    expected = np.sort(np.concatenate([together, omega(Problem(beams=(held,)), 8)]))
    assert found == pytest.approx(expected[:16], rel=1e-13)


@pytest.mark.parametrize("x", [0.5, 1.0])
def test_an_infinite_link_is_the_limit_of_stiff_ones(x: float) -> None:
    a, b = plate("a"), plate("b", EI=3.0, clamped=False)
    stiff, infinite = (omega(Problem(beams=(a, b), links=(linked(x, k, k),)), 12) for k in (1e13, math.inf))
    assert infinite == pytest.approx(stiff, rel=1e-7)


@pytest.mark.thorough
@pytest.mark.parametrize("place", [0.5, 1.0])
def test_a_link_goes_from_none_to_an_infinite_one(place: float) -> None:
    """Rayleigh: each frequency rises with the stiffness, by one place in the list at most, from limit to limit."""
    beams = plate("a"), plate("b", 0.9, EI=3.0, clamped=False)
    link = {"between": (f"a:{place}", f"b:{place * 0.9}")}
    none, *softer = (
        omega(Problem(beams=beams, links=(Link(translational=k, **link),)), 13)
        for k in (0.0, *10.0 ** np.arange(-9, 17, 5))
    )
    infinite = omega(Problem(beams=beams, links=(Link(translational=math.inf, **link),)), 13)
    every = np.array([none, *softer, infinite])
    assert np.all(np.diff(every, axis=0) >= -1e-12 * every[1:])
    assert np.all(every[-1][:-1] <= every[0][1:] * (1 + 1e-12))
    assert softer[-1] == pytest.approx(infinite, rel=1e-11)


@pytest.mark.thorough
def test_two_equal_beams_joined_everywhere_are_one_of_twice_the_stiffness_and_mass() -> None:
    """Welds at each tenth part hold the difference of the beams: below its frequencies are those of one beam alone."""
    welds = tuple(linked(x, math.inf, math.inf) for x in np.linspace(0.0, 1.0, 11)[1:].tolist())
    found = omega(Problem(beams=(plate("a"), plate("b")), links=welds), 8)
    assert found == pytest.approx(omega(Problem(beams=(plate("a", EI=2.0, m=2.0),)), 8), rel=1e-12)


@pytest.mark.parametrize("stiffness", [1e4, 1e8])
def test_a_very_stiff_second_beam_is_a_stop_at_rest(stiffness: float) -> None:
    """It yields as its static compliance L^3 / 3 EI in series with the stop, so the difference falls as 1 / EI."""
    a, b = plate("a"), plate("b", EI=stiffness)
    between = Problem(beams=(a, b), stops=(Stop(between=("a:1.0", "b:1.0"), gap=1e-3, stiffness=40.0),))
    fixed = Problem(beams=(a,), stops=(Stop(x="a:1.0", side="top", gap=1e-3, stiffness=40.0),))
    found, at_rest = (omega(it, 3, ContactState((0,))) for it in (between, fixed))
    assert found == pytest.approx(at_rest, rel=40 / (3 * stiffness))


def test_equal_beams_on_a_soft_link_come_in_pairs() -> None:
    """Of two equal beams one mode of each pair leaves a link at rest, and the link adds 2 k phi^2 to the other's."""
    k = 1e-6
    one = exact_modes(Problem(beams=(plate("a"),)), FREE, 5)
    found = omega(Problem(beams=(plate("a"), plate("b")), links=(linked(1.0, k),)), 10)
    tip = one.shapes(np.array([1.0]))[:, 0]
    assert found[0::2] == pytest.approx(one.omega, rel=1e-14)
    assert found[1::2] ** 2 - found[0::2] ** 2 == pytest.approx(2 * k * tip**2, abs=1e-13 * one.omega[-1] ** 2)


def test_a_closed_stop_between_beams_is_a_link() -> None:
    a, b = plate("a"), plate("b", 0.7)
    stop = Problem(beams=(a, b), stops=(Stop(between=("a:0.9", "b:0.4"), gap=1e-3, stiffness=40.0),))
    link = Problem(beams=(a, b), links=(Link(between=("a:0.9", "b:0.4"), translational=40.0),))
    assert np.array_equal(omega(stop, 12, ContactState((0,))), omega(link, 12))


def test_links_that_say_nothing_new_change_nothing() -> None:
    """Infinite links in a ring, and links between places that are fixed, are redundant: the count would see 0 = 0."""
    beams = (plate("a"), plate("b"), plate("c"))
    ring = tuple(
        Link(between=(f"{one}:1.0", f"{other}:1.0"), translational=math.inf) for one, other in ("ab", "bc", "ca")
    )
    fixed = Link(between=("a:0.0", "b:0.0"), translational=math.inf, torsional=5.0)
    expected = omega(Problem(beams=beams, links=ring[:2]), 12)
    assert omega(Problem(beams=beams, links=(*ring, ring[0], fixed)), 12) == pytest.approx(expected, rel=1e-13)


def test_a_trial_value_that_is_a_frequency_of_a_beam_alone_is_counted() -> None:
    problem = Problem(
        beams=tuple(
            NamedBeam(
                name=name,
                length=1.0,
                bending_stiffness=1.0,
                mass_per_length=1.0,
                supports=(Support(x=0.0, translational=math.inf), Support(x=1.0, translational=math.inf)),
            )
            for name in "ab"
        ),
        links=(linked(0.5, math.inf),),
    )
    coupled = CoupledBeams(layout_of(problem))
    z = math.pi * problem.line.length * np.arange(2.0, 9.0, 2.0)
    # Up to 2 j half waves there are 2 j modes in which both move alike, and 2 j - 1 in which a pin holds the middle.
    assert np.array_equal(coupled.count_below(z * (1 + 1e-11)), [3, 7, 11, 15])
    assert np.all(coupled.count_below(z) <= [3, 7, 11, 15])
    assert omega(problem, 6)[[1, 2]] == pytest.approx((2 * math.pi) ** 2, rel=1e-13)


@pytest.mark.parametrize("EI", [1e4, 1e8])
def test_equal_beams_that_hardly_bend_have_pairs_of_slow_modes(EI: float) -> None:
    """Each moves on its springs as the rigid beam that it nearly is: m w^2 = 2 k, or m w^2 = 6 k where it turns."""
    springs = tuple(Support(x=x, translational=1.0) for x in (0.0, 1.0))
    parts = {"length": 1.0, "bending_stiffness": EI, "mass_per_length": 1.0, "supports": springs}
    problem = Problem(beams=(NamedBeam(name="a", **parts), NamedBeam(name="b", **parts)))
    modes = exact_modes(problem, FREE, 4)
    near = 1 / EI + 1e-10 * problem.line.slowest_bending
    assert modes.omega == pytest.approx(np.sqrt([2.0, 2.0, 6.0, 6.0]), abs=near)
    inertia = inertia_of(problem.line, problem.structure.masses)
    assert gram(modes.shapes, modes.shapes, inertia) == pytest.approx(np.eye(4), abs=1e-9)


def check_static_forces(number: int) -> None:
    """Forces of pressed stops by the modes and what they leave, against the equilibrium, which is exact arithmetic on
    compliances: rounding of a displacement as large as the gap counts with the stiffness of the stop."""
    problem = resting_beams(np.random.default_rng((491, number)))
    try:
        forces = analytic.Solver(n_modes=COUNT).equilibrium(problem).contact_forces
    except (InputError, SolverError):  # there is none
        return
    state = ContactState(tuple(np.flatnonzero(forces > 0).tolist()))
    found = modal_state(loaded_structure(problem), state, 200)
    if not state.closed or (found.modes.omega == 0).any():
        return
    z = (found.force[0] / found.modes.omega**2) @ found.at_stops.T + found.residual_at_stops[0]
    for k in state.closed:
        stop = problem.structure.stops[k]
        size = stop.stiffness * abs(stop.gap) + forces.max()
        assert stop.stiffness * (stop.sign * z[k] - stop.gap) == pytest.approx(forces[k], abs=1e-8 * size)


def test_static_forces_of_stops_of_any_stiffness_keep_eight_digits() -> None:
    for number in range(40):
        check_static_forces(number)


@pytest.mark.slow
def test_many_static_forces_keep_eight_digits() -> None:
    for number in range(40, 1000):
        check_static_forces(number)
