"""The question of a confirmation: the bifurcations of a file of branches, and the solver that looks for each."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from hashlib import sha256
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from lapjoint.campaigns.branches.spec import BranchSpec, range_of
from lapjoint.campaigns.branches.table import KINDS
from lapjoint.campaigns.grid import Axis
from lapjoint.campaigns.identity import check_seed, versions
from lapjoint.campaigns.job import Spec
from lapjoint.errors import InputError
from lapjoint.problem.files import from_toml
from lapjoint.solver import Solver

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Row:
    """A bifurcation of the file."""

    number: int
    """Its number in the file."""
    kind: str
    """Kind of the bifurcation."""
    value: float
    """The parameter at the bifurcation, in its SI unit."""
    error: float
    """Error of the parameter, in its SI unit."""
    stop: int
    """The stop that is grazed."""
    arcs: str
    """The motion at the bifurcation as JSON, as `lapjoint.campaigns.branches.plain.plain_located` gives it; or
    empty."""
    also: int
    """Number of the value of a second parameter; 0 without one."""


@dataclass(frozen=True)
class ConfirmSpec(Spec):
    """Everything that a confirmation depends on; most fields are the arguments of `lapjoint.confirm`."""

    noun: ClassVar[str] = "confirmation"
    cells_noun: ClassVar[str] = "bifurcations"

    branches: BranchSpec
    """The question of the search for branches."""
    rows: tuple[Row, ...] = field(repr=False)
    """The bifurcations that are looked for."""
    solver: str = "fe"
    options: Mapping[str, Any] = field(default_factory=dict)
    share: float = 1.0
    seed: int = 0

    @cached_property
    def other(self) -> BranchSpec:
        """The question of the search, asked of the other solver."""
        return replace(self.branches, solver=self.solver, options=self.options)

    @property
    def size(self) -> int:
        """Number of bifurcations that are looked for."""
        return len(self.rows)

    def check(self) -> Solver:
        """Check all, and make the other solver; InputError if something is wrong."""
        solver = self.other.check()
        self.branches.check()
        range_of(self.other.at(0))
        return solver

    @cached_property
    def identity(self) -> dict[str, Any]:
        """What distinguishes this confirmation from any other, as values that JSON can hold."""
        rows = sha256(repr(self.rows).encode()).hexdigest()
        return {
            "content": "confirmation",
            "branches": self.branches.fingerprint,
            "bifurcations": rows,
            "solver": self.solver,
            "options": dict(self.options),
            "share": self.share,
            "seed": self.seed,
            "versions": versions(),
        }


def confirm_spec(
    found: xr.Dataset, solver: str, options: Mapping[str, Any], share: float = 1.0, seed: int = 0
) -> ConfirmSpec:
    """The question of the confirmation of a dataset of branches; the arguments are those of `lapjoint.confirm`.

    InputError is raised if an argument is not allowed, or the dataset has nothing that can be confirmed.
    """
    check_seed(seed)
    if isinstance(share, bool) or not isinstance(share, int | float) or not 0 < share <= 1:
        raise InputError(f"share = {share!r}: must be above 0, and at most 1")
    if "bifurcation_arcs" not in found:
        raise InputError("branches: hold no motions at their bifurcations; lapjoint branch, run again, keeps them")
    if not found.attrs["errors"]:
        raise InputError("branches: state no errors of their bifurcations; leave --no-errors out of lapjoint branch")
    rows = list(_rows(found))
    if not rows:
        raise InputError("branches: have no bifurcation, and so there is nothing to confirm")
    if share < 1:
        drawn = np.random.default_rng(seed).choice(len(rows), max(1, round(share * len(rows))), replace=False)
        rows = [rows[i] for i in np.sort(drawn)]
    return ConfirmSpec(_spec_of(found), tuple(rows), solver, options, float(share), seed)


def _spec_of(found: xr.Dataset) -> BranchSpec:
    """The question of the search that made a dataset of branches."""
    attrs = found.attrs
    second = next((one for one in found.coords.values() if "path" in one.attrs), None)
    return BranchSpec(
        from_toml(attrs["problem"]),
        attrs["path"],
        float(attrs["range"][0]),
        float(attrs["range"][1]),
        solver=attrs["solver"],
        options=json.loads(attrs["options"]),
        max_period_multiple=int(attrs["max_period_multiple"]),
        starts=int(attrs["starts"]),
        seed=int(attrs["seed"]),
        errors=bool(attrs["errors"]),
        max_points=int(attrs["max_points"]),
        effort=int(attrs["effort"]),
        also_over=None if second is None else Axis(second.attrs["path"], tuple(second.values.tolist())),
        from_grazes=bool(attrs.get("from_grazes", False)),
    )


def _rows(found: xr.Dataset) -> Iterator[Row]:
    """All bifurcations of a dataset of branches."""
    also = np.zeros(found.sizes["bifurcation"], dtype=int)
    if "bifurcation_also_over" in found:
        second = next(one for one in found.coords.values() if "path" in one.attrs)
        also = np.argmin(np.abs(found.bifurcation_also_over.values[:, None] - second.values), axis=1)
    columns = (found[f"bifurcation_{name}"].values for name in ("kind", "value", "error", "stop", "arcs"))
    for i, (kind, value, error, stop, arcs) in enumerate(zip(*columns, strict=True)):
        yield Row(i, KINDS[kind], float(value), float(error), int(stop), str(arcs), int(also[i]))
