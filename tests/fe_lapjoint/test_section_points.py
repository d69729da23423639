"""What is no section point of the problem is refused by a message that says why."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import fe_lapjoint
from lapjoint import ContactState, InputError, paper_joint
from lapjoint.answers import SectionPoint

SOLVER, JOINT = fe_lapjoint.Solver(elements=4), paper_joint(angular_frequency=515.0)
START = SOLVER.period_map(JOINT).initial()


def with_value(value: float) -> SectionPoint:
    coordinates = START.coordinates.copy()
    coordinates[1, 3] = value
    return replace(START, coordinates=coordinates)


WRONG: dict[str, tuple[SectionPoint, str]] = {
    "nan": (with_value(np.nan), "not finite"),
    "inf": (with_value(np.inf), "not finite"),
    "a stop too many": (replace(START, state=ContactState((4,))), "stop 5 closed; allowed are .* 1 to 4"),
    "a stop before the first": (replace(START, state=ContactState((-1,))), "stop 0 closed"),
    "too few coordinates": (replace(START, coordinates=START.coordinates[:, :-1]), "no section point of a finite"),
    "one row": (replace(START, coordinates=START.coordinates[0]), "no section point of a finite"),
    "no nodes": (replace(START, nodes=None), "no section point of a finite"),
    "nodes that are no mesh": (replace(START, nodes=np.zeros(START.coordinates.shape[1] // 2)), "nodes"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_section_point_is_refused(name: str) -> None:
    point, message = WRONG[name]
    period_map = SOLVER.period_map(JOINT)
    deviation = period_map.difference(START, START)
    asked: tuple[Callable[[], object], ...] = (
        lambda: SOLVER.steady_state(JOINT, start=point),
        lambda: period_map.adopted(point),
        lambda: period_map.march(point, 2),
        lambda: period_map.history(point, 1),
        lambda: period_map.linearised(point, 2),
        lambda: period_map.followed(point, deviation + 1.0, 1),
    )
    for ask in asked:
        with pytest.raises(InputError, match="^start: .*" + message):
            ask()


def test_a_point_of_another_mesh_has_to_be_adopted_first() -> None:
    period_map = fe_lapjoint.Solver(elements=6).period_map(JOINT)
    with pytest.raises(InputError, match="another mesh"):
        period_map.march(START, 2)
    assert period_map.march(period_map.adopted(START), 2).end.nodes is not None


def test_a_joint_of_fewer_stops_may_start_where_none_of_the_others_is_closed() -> None:
    fewer = JOINT.replace(stops=JOINT.stops[:2])
    assert SOLVER.period_map(fewer).adopted(START).state == START.state
