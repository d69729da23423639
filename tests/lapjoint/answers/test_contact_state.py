"""Contact states, and the paper's numbers for them."""

from __future__ import annotations

from itertools import combinations

import pytest

from lapjoint import (
    FREE,
    Beam,
    ContactState,
    InputError,
    Problem,
    Stop,
    contact_states,
    paper_joint,
    paper_state_number,
)
from lapjoint.answers.contact_state import can_be_closed, state_order


def beam_with(*stops: Stop) -> Problem:
    return Problem(beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0), stops=stops)


def stop(x: float, side: str, gap: float = 0.0) -> Stop:
    return Stop.model_validate({"x": x, "side": side, "gap": gap, "stiffness": 1.0})


def test_the_papers_joint_has_its_nine_states_in_its_order() -> None:
    joint = paper_joint()
    states = contact_states(joint)
    by_number = {paper_state_number(joint, state): state.name(joint) for state in states}
    # Table 1 and Table 4 of the paper: P2 and P4 at the tip, P3 and P5 at mid-span, bottom before top.
    assert by_number == {
        1: "free",
        2: "P2",
        3: "P3",
        4: "P4",
        5: "P5",
        6: "P2 + P3",
        7: "P2 + P5",
        8: "P3 + P4",
        9: "P4 + P5",
    }


def test_a_state_can_be_closed_if_it_is_one_of_those_listed() -> None:
    places = [(0.5, "top", 1e-3), (0.5, "top", 1e-3), (0.5, "bottom", 0.0), (1.0, "top", 2e-3), (1.0, "top", 0.0)]
    problem = beam_with(*(stop(*place) for place in places))
    listed = contact_states(problem)
    subsets = [ContactState(closed) for n in range(6) for closed in combinations(range(5), n)]
    assert [state for state in subsets if can_be_closed(problem, state)] == list(listed)


@pytest.mark.parametrize(("number", "told"), [(40, f"{2**40}"), (20_000, r"some 10\^6021")])
def test_too_many_states_are_counted_and_not_listed(number: int, told: str) -> None:
    many = beam_with(*(stop((i + 1) / number, "top") for i in range(number)))
    with pytest.raises(InputError, match=f"these have {told} contact states; at most 4096 can be listed"):
        contact_states(many)


@pytest.mark.parametrize(
    ("stops", "closed"),
    [
        pytest.param([], [()], id="a beam without stops has one state"),
        pytest.param([("top", 0.0), ("bottom", 0.0)], [(), (0,), (1,)], id="opposite stops never close together"),
        pytest.param([("top", 2e-3), ("top", 1e-3)], [(), (1,), (0, 1)], id="stops close in the order of their gaps"),
        pytest.param([("top", 1e-3), ("top", 1e-3)], [(), (0, 1)], id="stops with equal gaps close together"),
    ],
)
def test_states_of_stops_at_one_place(stops: list[tuple[str, float]], closed: list[tuple[int, ...]]) -> None:
    states = contact_states(beam_with(*(stop(1.0, *one) for one in stops)))
    assert [state.closed for state in states] == closed


def test_a_state_is_a_set_and_toggling_undoes_itself() -> None:
    assert ContactState((3, 1, 3)) == ContactState((1, 3))
    assert FREE.toggled(2).toggled(2) == FREE
    assert 2 in FREE.toggled(2)


def test_only_the_papers_layout_has_numbers() -> None:
    with pytest.raises(ValueError, match="paper's joint"):
        paper_state_number(beam_with(stop(1.0, "top")), FREE)


def test_a_name_says_which_closed_stops_are_released() -> None:
    joint = paper_joint()
    state = ContactState((0, 1), (1,))
    assert state.name(joint) == "P2 + P3 (released)"
    assert state.toggled(~1).name(joint) == "P2 + P3"
    assert state_order(joint, state.toggled(~1)) < state_order(joint, state)
