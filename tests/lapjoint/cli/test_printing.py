"""Tables on the console keep their columns, whatever the stops are called."""

from __future__ import annotations

import pytest

from lapjoint import History
from lapjoint.cli.printing import NAME_SHOWN, print_history


@pytest.mark.parametrize("name", ["a", "ten letters", "Upper elastomer buffer of the left bracket", "two\nlines"])
def test_names_and_numbers_stand_apart(history: History, capsys: pytest.CaptureFixture[str], name: str) -> None:
    stops = tuple(
        stop.model_copy(update={"name": text}) for stop, text in zip(history.problem.stops, (name, "b"), strict=True)
    )
    print_history(
        History(**{**vars(history), "problem": history.problem.replace(stops=stops)})  # type: ignore[arg-type]
    )
    lines = capsys.readouterr().out.splitlines()
    head, first, second = lines[3:6]
    assert len(head) == len(first) == len(second)
    start = head.index("start [s]") + len("start [s]")
    assert first[:start].split()[-1] == f"{history.contacts[0].start:.9f}"
    assert first[:NAME_SHOWN].split("  ")[0].rstrip() in (name.replace("\n", " "), "Upper elastome…t bracket")
    impulses = lines[-2:]
    assert len({line.index("x = ") for line in impulses}) == 1
    assert all(line[line.index("x = ") - 1] == " " for line in impulses)
