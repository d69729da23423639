"""A campaign takes a solver itself, registered or not, and who gives less than a campaign needs is told what."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner
from small_joints import HIGH, LOW, SHAKEN, TOUCHING
from toy import Bar, BarMap, bar

import analytic
import fe_lapjoint
from lapjoint import FREQUENCY, Axis, InputError, Problem, basins, branch, confirm, make_solver, statistics, sweep
from lapjoint.cli.main import main
from lapjoint.errors import Interrupted
from lapjoint.parts import lacking
from lapjoint.solver import Solver, named

RIGID = bar(0.55, (0.4, 20.0), (-0.4, 20.0), ratio=0.05)
AXES = [Axis(FREQUENCY, [0.5, 0.55, 0.6])]


@dataclass(frozen=True)
class Marked(Bar):
    """A rigid bar with an option of its own."""

    mark: Any = None


@dataclass(frozen=True)
class Pathless(Bar):
    """A solver whose period map cannot be marched."""

    def period_map(self, problem: Problem) -> Any:
        return object()


class Plain:
    """A solver that says not which options it has."""

    def __getattr__(self, name: str) -> Any:
        return getattr(Bar(), name)


def test_a_solver_that_a_package_has_registered_is_the_same_by_its_name() -> None:
    assert named(analytic.Solver(n_modes=4)) == ("analytic", {"n_modes": 4})
    assert named(fe_lapjoint.Solver()) == ("fe", {})
    assert named(analytic.PublishedScheme())[0] == "analytic-published"
    one = sweep(TOUCHING, [Axis(FREQUENCY, [5.0])], solver=analytic.Solver(n_modes=2))
    other = sweep(TOUCHING, [Axis(FREQUENCY, [5.0])], options={"n_modes": 2})
    xr.testing.assert_identical(one, other)


@pytest.mark.parametrize(
    "solver",
    [
        analytic.Solver(n_modes=7, tolerance=1 / 3e4),
        fe_lapjoint.Solver(rtol=1e-9 / 3, nodes=(0.0, 1 / 3, 1.0)),
        analytic.PublishedScheme(),
        Marked(mark=((1 / 3, "a"), None, True)),
    ],
    ids=lambda solver: solver.name,
)
def test_a_solver_is_made_again_to_the_bit_from_what_a_file_keeps(solver: Solver) -> None:
    name, options = json.loads(json.dumps(named(solver)))
    assert make_solver(name, **options) == solver


def mapped(function: Callable[[Any], Any], batches: Iterable[Any]) -> list[Any]:
    return [function(batch) for batch in batches]


@pytest.mark.parametrize("workers", [mapped, pytest.param(2, marks=pytest.mark.thorough)])
def test_a_solver_that_nobody_registered_is_rebuilt_by_workers(workers: Any) -> None:
    found = sweep(RIGID, AXES, solver=Bar(max_periods=4000), workers=workers)
    assert (found.attrs["solver"], found.attrs["options"]) == ("toy:Bar", '{"max_periods": 4000}')
    alone = [Bar().steady_state(problem, errors=False).impulses for problem in problems()]
    assert np.array_equal(found.impulse.values, alone)


def problems() -> list[Problem]:
    return [bar(omega, (0.4, 20.0), (-0.4, 20.0), ratio=0.05) for omega in AXES[0].values]


def test_work_of_one_solver_is_not_resumed_by_another(tmp_path: Path) -> None:
    out = tmp_path / "curve.nc"

    def interrupt(done: float, total: float) -> None:
        if done >= 1:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        sweep(RIGID, AXES, solver=Bar(), out=out, progress=interrupt)
    for other, differs in ((Bar(max_periods=99), "options"), (Marked(), "solver"), ("analytic", "solver")):
        with pytest.raises(InputError, match=rf"holds another sweep, not finished \(it differs in {differs}\)"):
            sweep(RIGID, AXES, solver=other, out=out)
    sweep(RIGID, AXES, solver=Bar(), out=out)
    with pytest.raises(InputError, match="is the result of another sweep"):
        sweep(RIGID, AXES, solver=Marked(mark=1), out=out)


@pytest.mark.thorough
def test_all_campaigns_take_a_solver(branches: xr.Dataset) -> None:
    few = analytic.Solver(n_modes=2)
    found = branch(TOUCHING, "base_motion.amplitude", LOW, HIGH, solver=few, errors=False)
    assert found.attrs["options"] == '{"n_modes": 2}'
    assert basins(RIGID, energy=20.0, starts=4, solver=few).attrs["solver"] == "analytic"
    assert statistics(SHAKEN, few, duration=1.5).attrs["options"] == '{"n_modes": 2}'
    found = confirm(branches, solver=fe_lapjoint.Solver(elements=4), share=0.3)
    assert (found.attrs["solver"], found.attrs["options"]) == ("fe", '{"elements": 4}')


@dataclass(frozen=True)
class Half:
    """A part of a solver."""

    name: str = "half"

    def modes(self) -> None:
        """No modes."""


def local() -> Solver:
    @dataclass(frozen=True)
    class Local(Bar):
        """A solver whose class no other process can import."""

    return Local()


REFUSED = [
    (Half(), r"solver = '.*:Half': lacks simulate, steady_state and refined of lapjoint.solver.Solver"),
    (Bar, r"solver = Bar: is a class; give a solver, as Bar\(\)"),
    (Plain(), "Plain: is no dataclass"),
    (local(), "cannot be made again by another process: .*local.* is not installed"),
    (Marked(mark=np.zeros(2)), "cannot be made again by another process: Object of type ndarray"),
    (Marked(mark={1: 2}), "made again from its options, .*, it is not the same"),
    (None, "solver = 'builtins:NoneType': lacks name, modes"),
]


@pytest.mark.parametrize(("solver", "message"), REFUSED, ids=[message[:24] for _, message in REFUSED])
def test_what_is_no_solver_for_a_campaign_is_refused(solver: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        sweep(RIGID, AXES, solver=solver)


def test_options_besides_those_of_a_solver_are_refused() -> None:
    with pytest.raises(InputError, match="options: are those of a solver that is given by its name; rigid bar has its"):
        sweep(RIGID, AXES, solver=Bar(), options={"max_periods": 3})


@pytest.mark.parametrize("name", ["subprocess:Popen", "os:system", "no_such:Thing", "os:nothing", "lapjoint:Beam", ":"])
def test_a_name_in_a_file_calls_nothing_but_solvers(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("subprocess.Popen", "not called")
    with pytest.raises(InputError, match=f"solver = '{name}'"):
        make_solver(name, args=["false"])


def test_a_campaign_says_which_part_a_solver_lacks() -> None:
    with pytest.raises(InputError, match=r"^the period map of solver = rigid bar: lacks arcs of .*, which branches"):
        branch(RIGID, "base_motion.amplitude", 0.9, 1.1, solver=Bar())
    with pytest.raises(InputError, match=r"period map of solver = '.*Pathless': lacks problem, .* which basins need"):
        basins(RIGID, energy=20.0, starts=4, solver=Pathless())
    with pytest.raises(InputError, match=r"of solver = rigid bar: lacks .*march.*, which steady states need"):
        sweep(RIGID, AXES, solver=Pathless())


@pytest.mark.parametrize(
    ("command", "missing"),
    [
        (("branch", "--over", "base_motion.amplitude", "--from", "1e-3", "--to", "2e-3", "-o", "b.nc"), "period_map"),
        (("basins", "--energy", "1", "-o", "b.nc"), "period_map"),
        (("equilibrium",), "equilibrium"),
    ],
)
@pytest.mark.usefixtures("counting")
def test_the_command_line_says_which_part_a_registered_solver_lacks(command: tuple[str, ...], missing: str) -> None:
    result = CliRunner().invoke(main, [command[0], "preset:paper", *command[1:], "--solver", "counting"])
    assert result.exit_code == 2
    assert len(result.stderr.splitlines()) == 1
    assert f"counting: lacks {missing} of lapjoint." in result.stderr.replace("'", "")


def test_what_is_lacking_is_found_without_computing_a_property() -> None:
    class Costly(BarMap):
        @property
        def arcs(self) -> Any:
            raise AssertionError

    from lapjoint.orbits.arcs import HasArcs

    assert not lacking(Costly(RIGID, "bar"), HasArcs)
