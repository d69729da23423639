"""What is asked of a confirmation: the bifurcations of a file of branches, and the solver that looks for each."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from hashlib import sha256
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from lapjoint.campaigns.branches.plain import located_of
from lapjoint.campaigns.branches.spec import BranchSpec, range_of
from lapjoint.campaigns.branches.table import KINDS
from lapjoint.campaigns.grid import Axis
from lapjoint.campaigns.plan import check_integer, digest_of, versions
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.confirmation import Verdict, confirmed
from lapjoint.orbits.branches.errors import Stated
from lapjoint.problem.files import from_toml
from lapjoint.solver import Progress, Solver

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Row:
    """A bifurcation of the file."""

    number: int
    """Its number in the file."""
    kind: str
    """What it is."""
    value: float
    """The number of the problem there, in its SI unit."""
    error: float
    """Its error, in the same unit."""
    stop: int
    """The stop that is grazed."""
    arcs: str
    """The motion there as JSON, as `lapjoint.campaigns.branches.plain.plain_located` has it; or empty."""
    also: int
    """Number of the value of a second number; 0 without one."""


@dataclass(frozen=True)
class Confirmed:
    """What the other solver has for a bifurcation."""

    value: float = np.nan
    """The number, in its SI unit; NaN where it does not find it."""
    error: float = np.nan
    """Its error, in the same unit; infinite where none can be stated, NaN where it does not find it."""
    verdict: Verdict = "not found"
    """Whether both agree."""
    message: str = ""
    """Why there is none."""


@dataclass(frozen=True)
class ConfirmSpec:
    """Everything that a confirmation depends on.

    Parameters
    ----------
    branches : BranchSpec
        What the file of branches is the result of.
    rows : tuple of Row
        Its bifurcations that are looked for.
    solver : str
        Entry-point name of the other solver.
    options : mapping
        Numerical options of that.
    share : float
        Share of the bifurcations that are looked for, drawn at random; 1 for all.
    seed : int
        Seed of the draw.
    """

    noun: ClassVar[str] = "confirmation"
    cells_noun: ClassVar[str] = "bifurcations"
    longest_batch: ClassVar[int] = 4
    """Largest number of bifurcations in a batch: each takes some seconds."""
    chained: ClassVar[bool] = False

    branches: BranchSpec
    rows: tuple[Row, ...] = field(repr=False)
    solver: str = "fe"
    options: Mapping[str, Any] = field(default_factory=dict)
    share: float = 1.0
    seed: int = 0

    @cached_property
    def other(self) -> BranchSpec:
        """What the file would be the result of, had the other solver followed the branches."""
        return replace(self.branches, solver=self.solver, options=self.options)

    @property
    def size(self) -> int:
        """Number of bifurcations that are looked for."""
        return len(self.rows)

    def chains(self) -> Iterator[tuple[int, ...]]:
        """None: no bifurcation starts where another ends."""
        return iter(())

    def check(self) -> Solver:
        """Check all, and make the solver. See `lapjoint.campaigns.campaign.Campaign.check`."""
        solver = self.other.check()
        self.branches.check()
        range_of(self.other.at(0))
        return solver

    def answer(
        self, cell: int, solver: Solver, section: dict[str, Any] | None, progress: Progress | None = None
    ) -> tuple[Confirmed, None]:
        """Look for a bifurcation. See `lapjoint.campaigns.campaign.Campaign.answer`."""
        row = self.rows[cell]
        if not row.arcs:
            return Confirmed(message="the file has no motion of it"), None
        try:
            what = located_of(range_of(self.branches.at(row.also)), json.loads(row.arcs))
            if what is None:
                return Confirmed(message="the first solver does not find it again from the motion in the file"), None
            found = confirmed(Stated(row.value, row.error, what), range_of(self.other.at(row.also)))
        except SolverError as error:
            return Confirmed(message=str(error)), None
        if found.other is None:
            return Confirmed(message="the other solver does not find it"), None
        return Confirmed(float(found.other.value), float(found.other.error), found.verdict), None

    def point(self, fields: Mapping[str, Any]) -> Confirmed:
        """What came of a bifurcation. See `lapjoint.campaigns.campaign.Campaign.point`."""
        return Confirmed(**fields)

    def dataset(self, points: Mapping[int, Confirmed]) -> xr.Dataset:
        """All of them. See `lapjoint.campaigns.campaign.Campaign.dataset`."""
        from lapjoint.campaigns.confirm.table import confirm_dataset

        return confirm_dataset(self, [points[cell] for cell in range(self.size)])

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

    @cached_property
    def fingerprint(self) -> str:
        """A digest of the identity, in hexadecimal digits."""
        return digest_of(self.identity, self.options)


def confirm_spec(
    found: xr.Dataset, solver: str, options: Mapping[str, Any], share: float = 1.0, seed: int = 0
) -> ConfirmSpec:
    """What is asked of the confirmation of a dataset of branches.

    Parameters
    ----------
    found : xarray.Dataset
        The dataset.
    solver : str
        Entry-point name of the other solver.
    options : mapping
        Numerical options of that.
    share : float
        Share of the bifurcations that are looked for, above 0 and at most 1.
    seed : int
        Seed of the draw.

    Returns
    -------
    ConfirmSpec
        It, checked.

    Raises
    ------
    InputError
        If a parameter is not allowed, or the dataset has nothing that can be confirmed.
    """
    check_integer("seed", seed, 0, 2**63 - 1)
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
    """What was asked of the search whose result a dataset of branches is."""
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
