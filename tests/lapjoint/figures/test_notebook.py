"""Answers show themselves in notebooks: well-formed HTML with the numbers of the answer, and names made harmless."""

from __future__ import annotations

import base64
import re
from html.parser import HTMLParser
from xml.etree import ElementTree

import pytest

import analytic
from lapjoint import FREE, History, SteadyState, paper_joint, summarise
from lapjoint.answers import Equilibrium, Modes

SOLVER = analytic.Solver(n_modes=6)


class Tags(HTMLParser):
    """Checks that tags close in order, and gathers the text."""

    void = ("br", "img")

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag not in self.void:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data + " "


def shown(answer: Modes | Equilibrium | History | SteadyState) -> tuple[str, str]:
    """The HTML of an answer, and the text in it."""
    page = answer._repr_html_()
    tags = Tags()
    tags.feed(page)
    assert not tags.open
    return page, tags.text


def test_modes() -> None:
    modes = SOLVER.modes(paper_joint(), FREE, 14)
    _, text = shown(modes)
    assert f"{modes.angular_frequencies[0]:.6g}" in text
    assert f"{modes.angular_frequencies[0] / 6.283185307179586:.6g}" in text
    assert "... and 2 more" in text


def test_equilibrium_with_a_picture() -> None:
    joint = paper_joint()
    pressed = joint.replace(stops=[joint.stops[0].model_copy(update={"gap": -1e-3, "name": "a < b"})])
    found = SOLVER.equilibrium(pressed)
    page, text = shown(found)
    assert f"{found.contact_forces[0]:.6g} ±" in text
    assert "a < b" in text
    (data,) = re.findall(r"base64,([^\"]+)", page)
    assert ElementTree.fromstring(base64.b64decode(data)).tag.endswith("svg")


def test_motion_with_a_picture() -> None:
    joint = paper_joint().replace(title="<b>Joint</b> & more")
    history = SOLVER.simulate(joint, 0.05)
    page, text = shown(history)
    assert "<b>Joint</b> & more" in text  # as text, not as a tag
    assert "<b>" not in page
    assert f"{history.contacts[0].impulse:.6g} ±" in text
    (data,) = re.findall(r"base64,([^\"]+)", page)
    assert ElementTree.fromstring(base64.b64decode(data)).tag.endswith("svg")
    assert len(page) < 200_000


@pytest.mark.parametrize("errors", [True, False])
def test_steady_state(errors: bool) -> None:
    found = SOLVER.steady_state(paper_joint(angular_frequency=515.0), errors=errors)
    _, text = shown(found)
    assert found.outcome.value in text
    assert f"{found.impulses[0]:.6g}" in text
    assert ("±" in text) is errors


def test_a_motion_without_stops_has_no_table() -> None:
    page, _ = shown(SOLVER.simulate(paper_joint().replace(stops=()), 0.05))
    assert "<table>" not in page


@pytest.mark.parametrize("errors", [True, False])
def test_answers_print_short_and_give_all_to_pandas(errors: bool) -> None:
    joint = paper_joint(angular_frequency=515.0)
    found = SOLVER.steady_state(joint, errors=errors)
    marched = SOLVER.simulate(joint, 0.1, errors=errors)
    for answer in (SOLVER.modes(joint), found, marched, SOLVER.equilibrium(joint), summarise(found)):
        text = repr(answer)
        assert text.startswith(f"{type(answer).__name__}: ")
        assert text.count("\n") < 20
        assert max(map(len, text.splitlines())) < 120
        assert answer._repr_html_().startswith("<div>")
    frame = found.to_pandas()
    assert frame["impulse_per_period"].tolist() == found.impulses.tolist()
    assert ("impulse_per_period_error" in frame) is errors
    assert frame.attrs["units"]["impulse_per_period"] == "N s"
    assert marched.to_pandas()["start"].tolist() == [c.start for c in marched.contacts]
    assert f"... and {len(marched.contacts) - 12} more" in repr(marched)
    values = summarise(found)
    long = values.to_pandas().set_index(["value_of", "at"])
    assert long.loc[("force_peak", "P4"), "value"] == values.values["force_peak"][2]
    assert long.loc[("velocity_rms", "2.5 m"), "unit"] == "m/s"


def test_a_title_cannot_break_the_lines_of_a_text() -> None:
    shown = repr(SOLVER.simulate(paper_joint().replace(title="a\nb\x1b[31m", stops=()), 0.05))
    assert shown.splitlines()[0] == "History: a b [31m"
