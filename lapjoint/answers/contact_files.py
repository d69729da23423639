"""The contacts of a motion as CSV or JSON."""

from __future__ import annotations

import csv
import io
import json
import math
from pathlib import Path
from typing import Any

from lapjoint.answers.history import History
from lapjoint.errors import InputError
from lapjoint.files.plain_text import no_formula
from lapjoint.files.writing import write_file
from lapjoint.problem.files import problem_tables_json

CONTACT_COLUMNS = (
    "stop",
    "side",
    "start_s",
    "end_s",
    "duration_s",
    "impulse_Ns",
    "peak_force_N",
    "open_start",
    "open_end",
    "start_error_s",
    "impulse_error_Ns",
    "peak_force_error_N",
    "dissipated_J",
    "dissipated_error_J",
)


def write_contacts(history: History, path: str | Path) -> None:
    """Write the contacts of a history as CSV or JSON, by the ending of `path`.

    The columns are `CONTACT_COLUMNS`; times are in s, impulses in N s (top positive), forces in N, energies lost in
    damped stops in J.  Errors are empty if none were estimated, and infinite (in JSON null) if none can be stated.  In
    CSV, a name that a spreadsheet would read as a formula gets an apostrophe in front.  The JSON file also holds the
    problem, the solver, the first and last time, the total impulse of each stop, and how errors were estimated.
    """
    ending = Path(path).suffix.lower()
    if ending == ".csv":
        out = io.StringIO()
        writer = csv.DictWriter(out, CONTACT_COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: no_formula(cell) for key, cell in row.items()} for row in contact_rows(history))
        write_file(path, out.getvalue())
    elif ending == ".json":
        impulses = dict(zip(history.problem.stop_names, history.impulses().tolist(), strict=True))
        content = {
            "problem": problem_tables_json(history.problem),
            "solver": history.solver,
            "start_s": history.start,
            "end_s": history.end,
            "impulses_Ns": impulses,
            "error_source": history.error_source,
            "contacts": [
                {key: None if value == math.inf else value for key, value in row.items()}
                for row in contact_rows(history)
            ],
        }
        write_file(path, json.dumps(content, indent=2, allow_nan=False) + "\n")
    else:
        raise InputError(f"{path}: contacts are written as .csv or .json, not {ending or 'without an ending'}")


def contact_rows(history: History) -> list[dict[str, Any]]:
    """The contacts of a history as rows with the keys `CONTACT_COLUMNS`, by start time; units are in the keys."""
    stops, names = history.problem.structure.stops, history.problem.stop_names
    return [
        {
            "stop": names[c.stop],
            "side": stops[c.stop].side,
            "start_s": float(c.start),
            "end_s": float(c.end),
            "duration_s": float(c.duration),
            "impulse_Ns": float(c.impulse),
            "peak_force_N": float(c.peak_force),
            "open_start": c.open_start,
            "open_end": c.open_end,
            "start_error_s": c.start_error,
            "impulse_error_Ns": c.impulse_error,
            "peak_force_error_N": c.peak_force_error,
            "dissipated_J": float(c.dissipated),
            "dissipated_error_J": c.dissipated_error,
        }
        for c in history.contacts
    ]
