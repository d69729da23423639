"""The dataset of a confirmation, in memory and as NetCDF; docs/branches.md lists the variables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from lapjoint.campaigns.branches.table import KINDS, meanings_of
from lapjoint.campaigns.dataset import attributes_of
from lapjoint.orbits.branches.confirmation import Verdict

if TYPE_CHECKING:
    import xarray as xr

    from lapjoint.campaigns.confirm.solve import Confirmed
    from lapjoint.campaigns.confirm.spec import ConfirmSpec

VERDICTS = get_args(Verdict)
"""Names of the verdicts, in the sequence of their codes from 0."""


def confirm_dataset(spec: ConfirmSpec, answers: Sequence[Confirmed]) -> xr.Dataset:
    """The dataset of a confirmation.

    Parameters
    ----------
    spec : ConfirmSpec
        What was looked for.
    answers : sequence of Confirmed
        What was found for each of its bifurcations.

    Returns
    -------
    xarray.Dataset
        The dataset.
    """
    import xarray as xr

    rows, units = spec.rows, spec.branches.axis.units
    value, error = (np.array([getattr(row, name) for row in rows]) for name in ("value", "error"))
    other, other_error = (np.array([getattr(one, name) for one in answers]) for name in ("value", "error"))
    verdicts = [VERDICTS.index(one.verdict) for one in answers]
    kinds = [KINDS.index(row.kind) for row in rows]

    def column(values: Any, kind: Any, text: str, **attributes: Any) -> tuple[tuple[str, ...], Any, dict[str, Any]]:
        return ("bifurcation",), np.array(values, dtype=kind), {"long_name": text, **attributes}

    path = spec.branches.axis.path
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
