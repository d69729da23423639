"""Static equilibria of several beams by the analytic solver: closed forms, and elements of fifty digits."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic import Solver
from lapjoint import InputError, Problem, Stop, Support
from lapjoint.problem import Link, NamedBeam
from lapjoint.problem.static_loads import Gravity, UniformLoad
from tests.helpers.linked_beams import resting_beams
from tests.helpers.static_beams import StaticBeams, in_fifty_digits

SOLVER = Solver()
CLAMP = Support(x=0.0, translational=math.inf, torsional=math.inf)
EI, L = {"upper": 40.0, "lower": 150.0}, {"upper": 0.3, "lower": 0.5}
K = 2e6
SOFTNESS = sum(L[name] ** 3 / (3 * EI[name]) for name in EI)  # of both tips under opposite forces, m/N


def beam(name: str, **others: object) -> NamedBeam:
    given = {"supports": (CLAMP,)} | others
    return NamedBeam(name=name, length=L[name], bending_stiffness=EI[name], mass_per_length=2.0, **given)


def tips(gap: float, **others: object) -> Problem:
    """Two cantilevers whose tips meet."""
    stop = Stop(name="tips", between=("upper:0.3", "lower:0.5"), gap=gap, stiffness=K)
    return Problem(**{"beams": (beam("upper"), beam("lower")), "stops": (stop,)} | others)


def test_two_cantilevers_pressed_together_share_the_interference() -> None:
    found = SOLVER.equilibrium(tips(-1e-3))
    force = 1e-3 / (SOFTNESS + 1 / K)
    assert found.contact_forces == pytest.approx([force], rel=1e-14)
    assert found.displacement("upper:0.3") == pytest.approx([force * 0.3**3 / 120], rel=1e-14)
    assert found.displacement("lower:0.5") == pytest.approx([-force * 0.5**3 / 450], rel=1e-14)
    assert found.moment("lower:0") == pytest.approx([-force * 0.5], rel=1e-13)
    assert found.support_forces == pytest.approx([-force, force], rel=1e-14)
    assert found.slope("lower:0.5") == pytest.approx([-force * 0.5**2 / 300], rel=1e-13)


def test_uniform_loads_of_each_beam_press_the_tips_together() -> None:
    loads = [UniformLoad(beam="upper", force_per_length=-50.0), UniformLoad(beam="lower", force_per_length=80.0)]
    found = SOLVER.equilibrium(tips(1e-4, uniform_loads=loads))
    reach = 50.0 * 0.3**4 / 320 + 80.0 * 0.5**4 / 1200 - 1e-4
    assert found.contact_forces == pytest.approx([reach / (SOFTNESS + 1 / K)], rel=1e-13)


@pytest.mark.parametrize("k", [0.0, 1e-3, 1e3, 1e9, math.inf])
def test_a_link_of_any_stiffness_carries_what_its_softness_leaves(k: float) -> None:
    link = Link(between=("upper:0.3", "lower:0.5"), translational=k)
    load = UniformLoad(beam="upper", force_per_length=-50.0)
    found = SOLVER.equilibrium(tips(1.0, links=[link], uniform_loads=[load]))
    force = -50.0 * 0.3**4 / 320 / (SOFTNESS + 1 / k) if k else 0.0
    assert found.link_forces == pytest.approx([force], rel=1e-13)
    assert found.link_moments == pytest.approx([0.0])
    assert found.displacement("lower:0.5") == pytest.approx([force * 0.5**3 / 450], rel=1e-13)


def test_shares_say_how_much_of_gravity_acts() -> None:
    beams = (beam("upper", gravity_share=-0.5), beam("lower", gravity_share=0.0))
    found = SOLVER.equilibrium(tips(1.0, beams=beams, gravity=Gravity(acceleration=-9.0)))
    assert found.displacement("upper:0.3") == pytest.approx([9.0 * 0.3**4 / 320], rel=1e-13)
    assert found.displacement("lower:0.5") == [0.0]


def test_an_infinite_link_that_joins_what_is_joined_takes_no_force() -> None:
    """Both clamped ends, a link between these, and a second link at the place of another."""
    twice = [Link(between=("upper:0.2", "lower:0.2"), translational=math.inf) for _ in range(2)]
    links = [Link(between=("upper:0", "lower:0"), translational=math.inf, torsional=math.inf), *twice]
    load = UniformLoad(beam="upper", force_per_length=-50.0)
    found = SOLVER.equilibrium(tips(1.0, links=links, uniform_loads=[load]))
    assert found.link_forces[[0, 2]].tolist() == [0.0, 0.0]
    assert found.link_moments.tolist() == [0.0, 0.0, 0.0]
    assert found.link_forces[1] < 0


def test_a_loose_beam_between_stops_is_not_unique() -> None:
    stops = [Stop(between=(f"upper:{x}", f"lower:{x}"), gap=1e-3, stiffness=K) for x in (0.1, 0.2)]
    found = SOLVER.equilibrium(tips(1.0, beams=(beam("upper", supports=()), beam("lower")), stops=stops))
    assert "nothing holds some beams" in found.other_equilibria
    held = (beam("upper", supports=(Support(x=0.1, translational=math.inf),)), beam("lower"))
    found = SOLVER.equilibrium(tips(1.0, beams=held, stops=stops[:1]))
    assert "nothing holds the beams against a turn of upper about x = 0.1 m" in found.other_equilibria


def test_beams_that_lie_on_each_other_rest_and_one_that_nothing_holds_does_not() -> None:
    """The upper beam's weight lies on two stops on the lower one; hung below it, the beam falls."""
    stops = [Stop(between=(f"upper:{x}", f"lower:{x}"), gap=1e-3, stiffness=K) for x in (0.0, 0.3)]
    loose = tips(1.0, beams=(beam("upper", supports=()), beam("lower")), stops=stops, gravity={"acceleration": -9.81})
    found = SOLVER.equilibrium(loose)
    assert found.unique
    assert found.contact_forces == pytest.approx([2.0 * 0.3 * 9.81 / 2] * 2, rel=1e-13)
    with pytest.raises(InputError, match=r"drive a .* of upper .*which neither supports, links nor stops resist"):
        SOLVER.equilibrium(loose.replace(gravity={"acceleration": 9.81}))


def mirrored(problem: Problem) -> Problem:
    """Up and down exchanged: loads reversed, sides and the beams of each pair exchanged."""
    stops = []
    for stop in problem.stops:
        change: dict[str, object] = {"side": {"top": "bottom", "bottom": "top", None: None}[stop.side]}
        if stop.between:
            change = {"between": stop.between[::-1]}
        stops.append(stop.model_copy(update=change))
    loads = [one.model_copy(update={"force_per_length": -one.force_per_length}) for one in problem.uniform_loads]
    steps = [one.model_copy(update={"force": -one.force}) for one in problem.point_loads]
    gravity = problem.gravity and Gravity(acceleration=-problem.gravity.acceleration)
    return problem.replace(stops=stops, uniform_loads=loads, point_loads=steps, gravity=gravity)


@pytest.mark.parametrize("seed", range(3))
def test_a_system_mirrored_rests_mirrored(seed: int) -> None:
    problem = resting_beams(np.random.default_rng((491, seed)))
    try:
        found = SOLVER.equilibrium(problem)
    except InputError:
        with pytest.raises(InputError):
            SOLVER.equilibrium(mirrored(problem))
        return
    other, x = SOLVER.equilibrium(mirrored(problem)), problem.line.grid(7)
    assert other.contact_forces.tolist() == found.contact_forces.tolist()
    if found.unique:
        assert other.displacement(x).tolist() == (-found.displacement(x)).tolist()


def check_witnessed(problem: Problem) -> tuple[int, bool]:
    """The conditions of equilibrium hold to fifty digits, and a quadratic program finds the same pressing stops; gives
    their number, and whether there was something to compare."""
    try:
        found = SOLVER.equilibrium(problem)
    except InputError:
        assert problem.structure.free_motions > 0
        return 0, False
    compared = False
    with in_fifty_digits():
        witness = StaticBeams(problem)
        if problem.structure.free_motions == 0:
            assert witness.by_quadratic_program() == found.state.closed
            compared = True
        if found.unique:
            check_shape(problem, witness)
            compared = True
    return len(found.state.closed), compared


def check_shape(problem: Problem, witness: StaticBeams) -> None:
    """Forces and shape are those of the witness with the same pressing stops, which it presses, and no others."""
    found = SOLVER.equilibrium(problem)
    z = witness.displacements(found.state.closed)
    for j, (it, depth) in enumerate(zip(problem.stops, witness.depths(z), strict=True)):
        assert (j in found.state) == (depth > 0)
        force = it.stiffness * max(depth, 0)
        assert abs(force - found.contact_forces[j]) <= found.errors.contact_forces[j] * (1 + 1e-12)
    parts = zip(witness.springs[::2], [*found.support_forces, *found.link_forces], strict=True)
    for (row, k), force in parts:
        if math.isfinite(k):
            exact = float(-k * witness.read(row, z))
            assert force == pytest.approx(exact, rel=1e-15, abs=1e-40)
    x = np.array(witness.nodes)
    for order, error in ((0, found.errors.displacement), (1, found.errors.slope)):
        exact = np.array([float(value) for value in z[order::2]])
        assert np.all(np.abs(found.evaluate(x, order) - exact) <= error + 2e-16 * np.abs(exact) + 1e-40)


@pytest.mark.parametrize("seed", [0, 2, 3])
def test_random_systems_rest_as_elements_of_fifty_digits_say(seed: int) -> None:
    check_witnessed(resting_beams(np.random.default_rng((492, seed))))


@pytest.mark.slow
def test_300_random_systems_rest_as_a_quadratic_program_says() -> None:
    rng = np.random.default_rng(4901)
    found = [check_witnessed(resting_beams(rng)) for _ in range(300)]
    assert sum(pressing for pressing, _ in found) > 200
    assert sum(compared for _, compared in found) > 200
