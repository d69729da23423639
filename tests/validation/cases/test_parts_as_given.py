"""The case `parts-as-given`: what is read is what is solved, and a file that says something else disagrees."""

from __future__ import annotations

import pytest

from validation.cases import parts_as_given
from validation.verdict import Verdict


def test_the_parts_mean_what_their_file_says() -> None:
    assert parts_as_given.run("quick", lambda _: None).verdict is Verdict.AGREE


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("contents_per_length = 0.85", "contents_per_length = 0.8501"),
        ("added_mass_per_length = 1.37", "added_mass_per_length = 1.3701"),
        ("to = 0.55", "to = 0.5501"),
        ("density = 7890.0", "density = 7891.0"),
        ("mass = 2.6", "mass = 2.6001"),
        ("gap = -4.1e-4", "gap = 4.1e-4"),
        ('fixed_to = "space"', 'fixed_to = "base"'),
        ("acceleration = -9.73", "acceleration = 9.73"),
        ("from = 0.35", "from = 0.36"),
        ("force_per_length = 5.5", "force_per_length = 5.6"),
    ],
)
def test_another_part_disagrees(old: str, new: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert parts_as_given.FILE.count(old) == 1
    monkeypatch.setattr(parts_as_given, "FILE", parts_as_given.FILE.replace(old, new))
    assert parts_as_given.run("quick", lambda _: None).verdict is Verdict.DISAGREE
