"""Tables on the console keep their columns, whatever the stops are called."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from beams import with_stops

from lapjoint import FREE, History, Outcome
from lapjoint.answers import SectionPoint
from lapjoint.answers.steady_state import Acceptance, SteadyState
from lapjoint.cli.printing import NAME_SHOWN, print_history, print_steady_state


@pytest.mark.parametrize("name", ["a", "ten letters", "Upper elastomer buffer of the left bracket", "two\nlines"])
def test_names_and_numbers_stand_apart(history: History, capsys: pytest.CaptureFixture[str], name: str) -> None:
    print_history(replace(history, problem=with_stops(history.problem, {"name": name}, {"name": "b"})))
    lines = capsys.readouterr().out.splitlines()
    head, first, second = lines[3:6]
    assert head.index("peak [N]") + len("peak [N]") == len(first) == len(second)  # no errors were estimated
    start = head.index("start [s]") + len("start [s]")
    assert first[:start].split()[-1] == f"{history.contacts[0].start:.9f}"
    assert first[:NAME_SHOWN].split("  ")[0].rstrip() in (name.replace("\n", " "), "Upper elastome…t bracket")
    impulses, source = lines[-3:-1], lines[-1]
    assert source == "Numerical errors (+-): no errors were estimated"
    assert len({line.index("x = ") for line in impulses}) == 1
    assert all(line[line.index("x = ") - 1] == " " for line in impulses)


@pytest.mark.parametrize(
    ("acceptance", "expected"),
    [
        ({"growth": 1e7}, None),
        ({}, None),
        ({"growth": 3e9}, "on the way a deviation grew by a factor of 3e+09"),
        ({"growth": 2.0, "pushes": 1}, "the march was pushed off an unstable one once"),
    ],
)
def test_a_steady_state_says_when_another_could_have_been_reached(
    history: History, capsys: pytest.CaptureFixture[str], acceptance: dict[str, float], expected: str | None
) -> None:
    point, multipliers = SectionPoint(FREE, np.zeros((2, 1))), np.array([-0.3 + 0.4j, -0.3 - 0.4j, 0.1])
    certificate = Outcome.PERIODIC, 2, False, 1e-10, multipliers, None
    impulses, accepted = np.zeros(2), Acceptance(point, 20, **acceptance)  # type: ignore[arg-type]
    print_steady_state(SteadyState(history.problem, "some solver", *certificate, point, history, impulses, accepted))
    lines = capsys.readouterr().out.splitlines()
    assert "Repeats after 2 excitation periods, to 1e-10 of its size" in lines
    assert "Floquet multipliers: -0.3+0.4i, -0.3-0.4i, 0.1" in lines
    sensitive = [line for line in lines if line.startswith("Another motion could have been reached: ")]
    assert [line.partition(": ")[2] for line in sensitive] == ([expected] if expected else [])
