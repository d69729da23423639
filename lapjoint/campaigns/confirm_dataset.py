"""The dataset of a confirmation, in memory and as NetCDF; docs/branches.md lists the variables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.campaigns.branch_dataset import KINDS, meanings_of
from lapjoint.campaigns.format_version import attributes_of

if TYPE_CHECKING:
    import xarray as xr

    from lapjoint.campaigns.confirm_plan import Confirmed, ConfirmPlan, Row

VERDICTS = ("agrees", "apart", "not found", "no error stated")
"""Names of the verdicts, in the sequence of their codes from 0."""


def verdict_of(row: Row, other: Confirmed) -> str:
    """Whether both solvers have one bifurcation at the same value.

    Parameters
    ----------
    row : Row
        The bifurcation by the first solver.
    other : Confirmed
        The same by the other.

    Returns
    -------
    str
        ``agrees`` if the values differ by at most the sum of their errors, ``apart`` if by more; ``no error stated``
        where an error is infinite, and ``not found``.
    """
    if math.isnan(other.value):
        return "not found"
    if not math.isfinite(row.error + other.error):
        return "no error stated"
    return "agrees" if abs(other.value - row.value) <= row.error + other.error else "apart"


def confirm_dataset(plan: ConfirmPlan, answers: Sequence[Confirmed]) -> xr.Dataset:
    """The dataset of a confirmation.

    Parameters
    ----------
    plan : ConfirmPlan
        What was looked for.
    answers : sequence of Confirmed
        What was found for each of its bifurcations.

    Returns
    -------
    xarray.Dataset
        The dataset.
    """
    import xarray as xr

    rows, units = plan.rows, plan.branches.axis.units
    value, error = (np.array([getattr(row, name) for row in rows]) for name in ("value", "error"))
    other, other_error = (np.array([getattr(one, name) for one in answers]) for name in ("value", "error"))
    verdicts = [VERDICTS.index(verdict_of(row, one)) for row, one in zip(rows, answers, strict=True)]
    kinds = [KINDS.index(row.kind) for row in rows]

    def column(values: Any, kind: Any, text: str, **attributes: Any) -> tuple[tuple[str, ...], Any, dict[str, Any]]:
        return ("bifurcation",), np.array(values, dtype=kind), {"long_name": text, **attributes}

    path = plan.branches.axis.path
    ratio = np.abs(other - value) / (error + other_error)
    variables = {
        "number": column([row.number for row in rows], "i4", "number of the bifurcation in its file", units="1"),
        "kind": column(kinds, "i1", "what the bifurcation is", **meanings_of(KINDS)),
        "value": column(value, "f8", f"{path} by the first solver", units=units),
        "error": column(error, "f8", "its error", units=units),
        "other_value": column(other, "f8", f"{path} by the other solver; NaN where not found", units=units),
        "other_error": column(other_error, "f8", "its error; infinite where none can be stated", units=units),
        "ratio": column(ratio, "f8", "distance of both values over the sum of their errors", units="1"),
        "verdict": column(verdicts, "i1", "whether both agree within their errors", **meanings_of(VERDICTS)),
        "message": column([one.message for one in answers], object, "why it was not found; empty where it was"),
    }
    return xr.Dataset(variables, attrs=_attributes(plan))


def _attributes(plan: ConfirmPlan) -> dict[str, Any]:
    return attributes_of(
        plan,
        f"Confirmation of bifurcations of: {plan.branches.problem.title or 'a joint'}",
        result_of=plan.noun,
        path=plan.branches.axis.path,
        first_solver=plan.branches.check().name,
        solver_name=plan.other.check().name,
        share=plan.share,
        seed=plan.seed,
        branches=plan.identity["branches"],
    )
