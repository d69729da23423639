"""The report of a run: ``report.html``, one page that needs nothing else, and files for spreadsheets and programs."""

from __future__ import annotations

import json
import platform
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from lapjoint import paper_joint
from lapjoint.figures import plot_joint
from lapjoint.figures.style import COLUMN_WIDTH, new_axes
from lapjoint.files.writing import completed_series, unwritable
from lapjoint.problem import Problem
from lapjoint.problem.files import problem_tables_json
from validation.case import CaseResult
from validation.report.drawing import NARROW_HEIGHT, drawing
from validation.report.own import own_problem
from validation.report.page import page, views
from validation.report.records import case_record, faults_sheet, kinds_sheet, summary_sheet
from validation.report.table_files import remove_sheets, write_sheets
from validation.report.uncertainty_budget import overall_sheet

_PAGES = ("report.html", "report.json")
_PACKAGES = (
    *("lapjoint", "numpy", "scipy", "numba", "scikit-fem", "pydantic", "matplotlib", "jinja2", "meshio", "xarray"),
    *("h5netcdf", "h5py", "threadpoolctl", "click", "rich", "tomli-w"),
)


def write_reports(
    results: Sequence[CaseResult],
    level: str,
    output: Path,
    seconds: float,
    problem: Problem | None = None,
    source: str = "",
) -> tuple[Path, Path]:
    """Write the reports into `output`; files of an earlier report stay until all new ones are complete.

    Parameters
    ----------
    results : sequence of CaseResult
        In the order in which they are reported.
    level : str
        Level of refinement at which the cases ran.
    output : Path
        An existing directory.
    seconds : float
        Run time of all.
    problem : Problem, optional
        The one problem that was compared; None for the suite.
    source : str
        Where the problem comes from, as the command line names it.

    Returns
    -------
    tuple of Path
        ``report.html`` and ``report.json``; the tables are in the folder ``tables`` beside them.

    Raises
    ------
    OutputError
        If a file cannot be written.
    """
    about: dict[str, Any] = {
        "level": level,
        "seconds": round(seconds, 1),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "python": platform.python_version(),
        "platform": platform.platform(),
        "versions": {name: found for name in _PACKAGES if (found := _version(name))},
    }
    if problem is not None:
        about |= {"problem": problem_tables_json(problem), "source": source}
    shown = views(results)
    overall = {"summary": summary_sheet(results), "kinds": kinds_sheet(results), "budget": overall_sheet(results)}
    if problem is None:
        overall["faults"] = faults_sheet()
    own = None if problem is None else own_problem(problem, source, results)
    shown_joint = paper_joint() if problem is None else problem
    narrow = plot_joint(shown_joint, new_axes(COLUMN_WIDTH, NARROW_HEIGHT))
    joint = drawing("The joint", plot_joint(shown_joint), narrow)
    data: dict[str, Any] = {"about": about, "cases": [case_record(result) for result in results]}
    try:
        with completed_series(output, lambda: remove_sheets(output)) as draft:
            sheets = [
                *overall.values(),
                *(own.asked if own else ()),
                *(sheet for view in shown for sheet in view.sheets),
            ]
            write_sheets(sheets, draft)
            (draft / _PAGES[0]).write_text(page(shown, overall, about, joint, own), encoding="utf-8", newline="")
            text = json.dumps(data, indent=1, allow_nan=False) + "\n"
            (draft / _PAGES[1]).write_text(text, encoding="utf-8", newline="")
    except OSError as error:
        raise unwritable(output, error) from None
    return output / _PAGES[0], output / _PAGES[1]


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""
