"""The dataset of a confirmation, in memory and as NetCDF; docs/branches.md lists the variables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from lapjoint.campaigns.branches.table import KIND_FLAGS, KINDS
from lapjoint.campaigns.confirm.spec import ConfirmSpec
from lapjoint.campaigns.dataset import Column, attributes_of
from lapjoint.files.flags import flags
from lapjoint.orbits.branches.confirmation import Verdict

if TYPE_CHECKING:
    import xarray as xr

VERDICTS = get_args(Verdict)
"""Names of the verdicts, in the sequence of their codes from 0."""


@dataclass(frozen=True)
class Confirmed:
    """The result of the other solver for a bifurcation."""

    value: float = np.nan
    """The parameter by the other solver, in its SI unit; NaN where the other solver does not find the bifurcation."""
    error: float = np.nan
    """Error of the other solver's value, in the unit of the value; infinite where none can be stated, NaN where the
    bifurcation is not found."""
    verdict: Verdict = "not found"
    """Whether both solvers agree."""
    message: str = ""
    """Why the bifurcation is not found."""


def confirm_dataset(spec: ConfirmSpec, answers: Sequence[Confirmed]) -> xr.Dataset:
    """The dataset of a confirmation, from the result for each of its bifurcations."""
    import xarray as xr

    rows, path = spec.rows, spec.branches.axis.path
    column, si = partial(Column, text_first=True), spec.branches.axis.units
    value, error = (np.array([getattr(row, name) for row in rows]) for name in ("value", "error"))
    other, other_error = (np.array([getattr(one, name) for one in answers]) for name in ("value", "error"))
    ratio = np.abs(other - value) / (error + other_error)
    verdicts = flags(name.replace(" ", "_") for name in VERDICTS)
    columns = (
        (column("number", "i4", "1", "number of the bifurcation in its file"), [row.number for row in rows]),
        (column("kind", "i1", "", "what the bifurcation is", KIND_FLAGS), [KINDS.index(row.kind) for row in rows]),
        (column("value", "f8", si, f"{path} by the first solver"), value),
        (column("error", "f8", si, "its error"), error),
        (column("other_value", "f8", si, f"{path} by the other solver; NaN where not found"), other),
        (column("other_error", "f8", si, "its error; infinite where none can be stated"), other_error),
        (column("ratio", "f8", "1", "distance of both values over the sum of their errors"), ratio),
        (
            column("verdict", "i1", "", "whether both agree within their errors", verdicts),
            [VERDICTS.index(one.verdict) for one in answers],
        ),
        (
            column("message", "O", "", "why it was not found; empty where it was"),
            [one.message for one in answers],
        ),
    )
    variables = {one.name: one.of(("bifurcation",), values) for one, values in columns}
    return xr.Dataset(variables, attrs=_attributes(spec))


def _attributes(spec: ConfirmSpec) -> dict[str, Any]:
    return attributes_of(
        spec,
        f"Confirmation of bifurcations of: {spec.branches.problem.title or 'a joint'}",
        result_of=spec.noun,
        path=spec.branches.axis.path,
        first_solver=spec.branches.check().name,
        solver_name=spec.other.check().name,
        share=spec.share,
        seed=spec.seed,
        branches=spec.identity["branches"],
    )
