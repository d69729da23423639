"""Where nodes are put: places that rounding parts are one, near ones act inside an element, others are refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from beams import CLAMP, UNIT

import fe_lapjoint
from fe_lapjoint.march.system import build_system
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.mesh import mesh_nodes
from lapjoint import FREE, ContactState, InputError, Problem, StepLoad, Stop, Support

SOLVER = fe_lapjoint.Solver(elements=20)


def with_stops(*places: float, stiffness: float) -> Problem:
    stops = tuple(Stop(x=x, side="top", gap=1e-3, stiffness=stiffness) for x in places)
    return Problem(beam=UNIT, supports=(CLAMP,), stops=stops)


def frequencies(problem: Problem) -> np.ndarray:
    closed = ContactState(tuple(range(len(problem.stops))))
    return SOLVER.modes(problem, closed, 4).angular_frequencies


def test_places_that_rounding_parts_are_one_node() -> None:
    two = with_stops(0.3, 0.1 + 0.2, stiffness=500.0)
    one = with_stops(0.3, stiffness=1000.0)
    assert 0.1 + 0.2 != 0.3
    assert np.array_equal(mesh_nodes(two, 20, None), mesh_nodes(one, 20, None))
    assert frequencies(two) == pytest.approx(frequencies(one), rel=1e-12)  # rounding


@pytest.mark.parametrize("stiffness", [1e2, 1e9])
def test_stops_at_any_distance_have_the_frequencies_of_one_in_the_limit(stiffness: float) -> None:
    limit = frequencies(with_stops(0.3, stiffness=2 * stiffness))
    for exponent in range(2, 16):
        d = 1.5 * 10.0**-exponent
        found = frequencies(with_stops(0.3 - d / 2, 0.3 + d / 2, stiffness=stiffness))
        # Two stops a distance d apart resist the slope there by k d^2 / 2 more than one, EI / d at most.
        assert found == pytest.approx(limit, rel=1e-6 + min(20 * d + stiffness * d**2, 1.0)), f"at {d:g}"
        if stiffness * d**2 < 1e-7:
            assert found == pytest.approx(limit, rel=1e-7 + 20 * d), f"at {d:g}"


def test_a_load_beside_a_stop_acts_where_it_is() -> None:
    """Deflection of a cantilever at x under a force at a: F a^2 (3 x - a) / 6 EI."""
    x = 0.3
    for d in (1e-3, 1e-5, 1e-8, 1e-14):
        a = x - d
        loaded = with_stops(x, stiffness=1e-9).replace(point_loads=(StepLoad(x=a, force=1.0),))
        system = build_system(Assembly(loaded, mesh_nodes(loaded, 20, None)), FREE)
        z = float(system.stops[0] @ system.equilibrium)
        assert z == pytest.approx(a**2 * (3 * x - a) / 6, rel=1e-8)  # rounding of short elements


@pytest.mark.parametrize(
    ("supports", "named"),
    [
        ((CLAMP, Support(x=1e-6, translational=math.inf)), r"supports\[1\].x = 1e-06"),
        ((Support(x=1 - 1e-9, translational=math.inf),), r"supports\[0\].x = 0.999999999"),
        ((CLAMP, Support(x=5e-5, torsional=1e6)), r"supports\[1\].x = 5e-05"),
    ],
)
def test_what_elements_cannot_tell_apart_is_refused_by_name(supports: tuple[Support, ...], named: str) -> None:
    with pytest.raises(InputError, match=named + ".*allowed are the same place, or at least 0.0001 m"):
        frequencies(Problem(beam=UNIT, supports=supports))


def test_nodes_of_the_users_own_may_be_no_nearer() -> None:
    problem = with_stops(0.3, stiffness=100.0)
    with pytest.raises(InputError, match=r"nodes: 0.5 and 0.50001 m .* allowed are nodes at least 0.0001 m apart"):
        mesh_nodes(problem, 10, (0.5, 0.50001))
    with pytest.raises(InputError, match="nodes: nan lies outside"):
        mesh_nodes(problem, 10, (0.5, math.nan))
    # a node a hair beside a stop gives way to it; one that rounding parts from another or from the tip is that one
    assert mesh_nodes(problem, 10, (0.1 + 0.2, 0.6, 0.6 + 1e-16, 1.0 + 2e-16)).tolist() == [0.0, 0.3, 0.6, 1.0]
    assert mesh_nodes(problem, 10, (0.30001,)).tolist() == [0.0, 0.3, 1.0]
