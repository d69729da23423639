"""Answers show themselves in notebooks: well-formed HTML with the numbers of the answer, and names made harmless."""

from __future__ import annotations

import base64
import re
from html.parser import HTMLParser
from xml.etree import ElementTree

import pytest

import analytic
from lapjoint import FREE, History, SteadyState, paper_joint
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
