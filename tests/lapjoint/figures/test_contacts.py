"""Figures of contacts: every impulse once, and every moment in one state."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from lapjoint import FREE, ContactState, History, paper_joint
from lapjoint.figures import plot_contact_impulses, plot_contact_states


def bars(history: History) -> list[tuple[float, float, int]]:
    """Start, end and row of every bar drawn, by start."""
    found = []
    for row, collection in enumerate(plot_contact_states(history).collections):
        for path in collection.get_paths():
            x = path.vertices[:, 0]
            found.append((float(x.min()), float(x.max()), row))
    return sorted(found)


def test_every_impulse_is_drawn_with_its_sign_at_its_impact(history: History) -> None:
    axes = plot_contact_impulses(history)
    for stop, name in enumerate(history.problem.stop_names):
        (line,) = [line for line in axes.lines if line.get_label() == name]
        contact = history.contacts[stop]
        assert [list(values) for values in line.get_data()] == [[contact.start], [contact.impulse]]
        assert (contact.impulse > 0) == (history.problem.stops[stop].side == "top")
    assert axes.get_ylabel() == "impulse [N s]"


def test_every_stop_has_its_colour_and_marker(history: History) -> None:
    lines = [line for line in plot_contact_impulses(history).lines if line.get_label() in ("above", "below")]
    assert len({line.get_color() for line in lines}) == len({str(line.get_marker()) for line in lines}) == 2


def test_contacts_cut_by_the_ends_are_hollow(history: History) -> None:
    first, second = history.contacts
    axes = plot_contact_impulses(replace(history, contacts=(replace(first, open_start=True), second)))
    hollow = [line for line in axes.lines if line.get_markerfacecolor() == "white" and len(line.get_xdata())]
    assert [list(line.get_ydata()) for line in hollow] == [[first.impulse]]
    assert "hollow" in axes.get_legend().get_title().get_text()
    assert "hollow" not in plot_contact_impulses(history).get_legend().get_title().get_text()


def test_a_motion_without_contact_says_so(history: History) -> None:
    free = replace(history, contacts=(), states=(FREE,), switch_times=np.zeros(0))
    assert [text.get_text() for text in plot_contact_impulses(free).texts] == ["no contact"]


def test_the_bars_cover_the_history_exactly_once(history: History) -> None:
    found = bars(history)
    edges = [history.start, *history.switch_times, history.end]
    # Matplotlib adds start and duration in double precision: an ulp of a second.
    np.testing.assert_allclose([bar[:2] for bar in found], list(pairwise(edges)), atol=1e-15)


def test_each_row_is_a_state_that_occurs(history: History) -> None:
    axes = plot_contact_states(history)
    assert [label.get_text() for label in axes.get_yticklabels()] == ["free", "above", "below"]
    for start, end, row in bars(history):
        name = history.state_at((start + end) / 2).name(history.problem)
        assert axes.get_yticklabels()[row].get_text() == name


def test_the_shares_are_those_of_the_contacts(history: History) -> None:
    free, above, below = (float(text.get_text().rstrip("%")) for text in plot_contact_states(history).texts)
    assert above == below == pytest.approx(100 * history.contacts[0].duration, abs=0.05)
    assert free == pytest.approx(100 - 200 * history.contacts[0].duration, abs=0.05)


def test_the_paper_s_joint_has_its_numbers(history: History) -> None:
    states = tuple(ContactState(closed) for closed in ((), (2,), (2, 3), (), (0, 1)))
    axes = plot_contact_states(replace(history, problem=paper_joint(), states=states))
    assert [label.get_text() for label in axes.get_yticklabels()] == ["1  free", "4  P4", "6  P2 + P3", "9  P4 + P5"]


def test_a_state_of_no_duration_is_left_out(history: History) -> None:
    switches = np.array([0.2, 0.2, 0.4])
    states = (FREE, ContactState((0,)), ContactState((1,)), FREE)
    axes = plot_contact_states(replace(history, switch_times=switches, states=states))
    assert [label.get_text() for label in axes.get_yticklabels()] == ["free", "below"]
