"""A confirmation as the command line shows it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lapjoint.campaigns.confirm.table import VERDICTS
from lapjoint.cli.echo import echo
from lapjoint.figures.branch_names import KIND_NAMES

if TYPE_CHECKING:
    import xarray as xr

ROWS_SHOWN = 40
_AGREES = VERDICTS.index("agrees")


def all_agree(dataset: xr.Dataset) -> bool:
    """Whether both solvers agree on all bifurcations that were looked for."""
    return bool((dataset.verdict.values == _AGREES).all())


def print_confirmed(dataset: xr.Dataset) -> None:
    """Print a table of verdicts by kind, and each bifurcation on which the solvers do not agree."""
    kind, verdict = dataset.kind.values, dataset.verdict.values
    echo(f"{dataset.attrs['first_solver']}, and {dataset.attrs['solver_name']}:")
    echo(_line("", [*VERDICTS, "largest ratio", "largest errors"]))
    for code, name in enumerate((*KIND_NAMES, "all")):
        mine = np.ones(kind.size, dtype=bool) if name == "all" else kind == code
        if mine.any():
            counts = [str(np.count_nonzero(verdict[mine] == i)) for i in range(len(VERDICTS))]
            echo(_line(name, [*counts, *_largest(dataset, mine)]))
    others = np.flatnonzero(verdict != _AGREES)
    for j in others[:ROWS_SHOWN]:
        echo(f"  {disagreement_text(dataset, int(j))}")
    if others.size > ROWS_SHOWN:
        echo(f"  ... and {others.size - ROWS_SHOWN} more, in the file")


def disagreement_text(dataset: xr.Dataset, j: int) -> str:
    """Bifurcation `j`, on which the solvers do not agree, in a line with both values, their errors and the verdict."""
    row = dataset.isel(bifurcation=j)
    own = f"{float(row.value):.9g} ± {float(row.error):.1g}"
    other = f"{float(row.other_value):.9g} ± {float(row.other_error):.1g}"
    name, verdict = KIND_NAMES[int(row.kind)], VERDICTS[int(row.verdict)]
    what = f"; {row.message.values!s}" if verdict == "not found" else f", {other}"
    return f"bifurcation {int(row.number)}: {name} at {own}{what}: {verdict}"


def _largest(dataset: xr.Dataset, mine: np.ndarray) -> list[str]:
    """The largest ratio of difference to stated error, and each solver's largest stated error, divided by the value."""
    found = mine & np.isfinite(dataset.ratio.values)
    if not found.any():
        return ["-", "-"]
    value = np.abs(dataset.value.values[found])
    errors = [float(np.max(dataset[name].values[found] / value)) for name in ("error", "other_error")]
    return [f"{float(dataset.ratio.values[found].max()):.3g}", " ".join(f"{one:.1e}" for one in errors)]


def _line(name: str, columns: list[str]) -> str:
    return f"{name:<18}" + "".join(f"{column:>17}" for column in columns)
