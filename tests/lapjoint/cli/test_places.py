"""``--at`` chooses the places of series, of figures that show places, and of what ``lapjoint steady`` prints."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from command_line import run_well

from lapjoint import figures
from lapjoint.cli.options import DRAWINGS

SIMULATE = ("simulate", "preset:paper", "--n-modes", "3", "--duration", "0.02", "--no-errors")
STEADY = ("steady", "preset:paper", "--n-modes", "3", "--no-errors")


@pytest.mark.parametrize(
    ("draw", "at", "x"),
    [
        ("motion", "x=1,0.5", [1.0, 0.5]),
        ("phase", "x=1.25", 1.25),
        ("poincare", "x=1.25", 1.25),
        ("spectrum", "x=2", 2.0),
    ],
)
def test_a_figure_is_drawn_at_the_places_asked_for(draw: str, at: str, x: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    function, seen = DRAWINGS[draw].function, []
    drawn = getattr(figures, function)
    monkeypatch.setattr(figures, function, lambda history, **places: seen.append(places) or drawn(history, **places))
    run_well(*SIMULATE, "--figure", "figure.png", "--draw", draw, "--at", at)
    assert seen == [{"x": x}]


def test_steady_prints_peaks_at_the_places_asked_for() -> None:
    lines = run_well(*STEADY, "--at", "x=0.7", "--json", "steady.json").splitlines()
    (row,) = (line for line in lines if line.startswith("moment [N m]"))
    assert "0.7 m" in row
    assert any(line.startswith("stress [Pa]") for line in lines)
    start = next(i for i, line in enumerate(lines) if line.startswith("Largest magnitude"))
    assert max(map(len, lines[start:])) <= 80
    summary = json.loads(Path("steady.json").read_text())["summary"]
    assert summary["moment_peak"]["x_m"][0] == 0.7
    assert list(summary["force_peak"]["values"]) == ["P2", "P3", "P4", "P5"]
    assert summary["force_peak"]["errors"] is None
