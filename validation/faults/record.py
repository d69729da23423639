"""The last complete run over all faults: kept with the source, and shown in the documents."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

from lapjoint.files.writing import write_file
from validation.faults.catalogue import CONTROL, FAULTS
from validation.faults.running import plain, seen_from
from validation.faults.table import Judged
from validation.faults.trial import Result, Seen

NAME, PAGE = "recorded.json", "faults.md"
_PLACES = {"analytic": "the analytic solver", "FE": "the finite element solver", "ground": "the ground that both share"}
_HEAD = """# Faults, and what catches them

<!-- Written by `lapjoint validate --faults`; not to be edited. -->

A judge that cannot fail is no judge. So `lapjoint validate --faults` puts {count} faults of the kinds that real
programs have into the code, one at a time, each in a process of its own: {places}. The cases then run at the quick
level, cheapest first, until a comparison disagrees. A fault counts as caught only if the verdict changes; a crash does
not count. No fault names the case that is to catch it. The control, an edit that changes nothing, must not be caught;
and without a fault nothing may disagree.

When each was last tried, {caught} of {count} were caught. Times are those of one processor, for all cases up to the
one that disagreed. It took {cases} cases, which come to {whole:.0f} s without a fault; the others run where these leave
a fault uncaught.
"""


def recorded_path() -> Path:
    """The file of the record, beside this module."""
    return Path(str(files("validation.faults"))) / NAME


def written(judged: Sequence[Judged], baseline: dict[str, Seen]) -> str:
    """The record as text."""

    def line(seen: Seen) -> dict[str, Any]:
        rounded = replace(seen, seconds=round(seen.seconds, 1))
        return {key: value for key, value in plain(rounded).items() if key != "spent" and value != ""}

    order = {fault.name: i for i, fault in enumerate((*FAULTS, CONTROL))}
    kept = sorted(judged, key=lambda one: order[one.fault.name])
    data = {
        "cases": {case: round(seen.seconds, 1) for case, seen in sorted(baseline.items())},
        "faults": {one.fault.name: line(one.seen) for one in kept},
    }
    return json.dumps(data, indent=1) + "\n"


def recorded() -> tuple[tuple[Judged, ...], dict[str, float]]:
    """The last complete run: faults of the catalogue as they were judged, and the time of each case without a fault, s.

    The cases are those that it took to catch all faults.
    """
    if not recorded_path().exists():
        return (), {}
    data = json.loads(recorded_path().read_text())
    known = {fault.name: fault for fault in (*FAULTS, CONTROL)}
    judged = tuple(Judged(known[name], seen_from(seen)) for name, seen in data["faults"].items() if name in known)
    return judged, data["cases"]


def page(judged: Sequence[Judged], costs: dict[str, float]) -> str:
    """The page of the documents in Markdown, from all faults, the control, and the time of each case, s."""
    faults = [one for one in judged if one.fault != CONTROL]
    counts = {place: sum(one.fault.place == place for one in faults) for place in _PLACES}
    text = _HEAD.format(
        count=len(faults),
        places=", ".join(f"{counts[place]} into {name}" for place, name in _PLACES.items()),
        caught=sum(one.seen.result is Result.CAUGHT for one in faults),
        cases=len(costs),
        whole=sum(costs.values()),
    )
    for place, name in _PLACES.items():
        text += f"\n## In {name}\n\n| fault | kind | what it does | caught by | by | against | time |\n|{'---|' * 7}\n"
        text += "".join(_row(one) for one in faults if one.fault.place == place)
    return text


def _row(one: Judged) -> str:
    fault, seen = one.fault, one.seen
    caught = f"{seen.case.replace('_', '-')}: {seen.item}" if seen.result is Result.CAUGHT else seen.result.value
    cells = (fault.name, fault.kind, fault.what, caught, seen.number, seen.bound, f"{seen.seconds:.1f} s")
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"


def write_record(judged: Sequence[Judged], baseline: dict[str, Seen]) -> tuple[Path, ...]:
    """Write the record and the page of the documents; an installation has no documents, and nothing is written."""
    path = recorded_path()
    docs = path.parents[2] / "docs"
    if not docs.is_dir():
        return ()
    write_file(path, written(judged, baseline))
    write_file(docs / PAGE, page(*recorded()))
    return path, docs / PAGE
