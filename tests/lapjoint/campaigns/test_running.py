"""Sweeps: the same answer whoever works and however often it is interrupted."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from multiprocessing.pool import ThreadPool
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from counting_solver import asked

from lapjoint import BaseMotion, HarmonicsBaseMotion, Problem, SampledShape, SineLoad, StepLoad, paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, sweep
from lapjoint.campaigns.grid import MOST_POINTS, UNITS, Grid
from lapjoint.campaigns.journal import journal_path
from lapjoint.campaigns.random_start import random_initial
from lapjoint.errors import InputError, SolverError
from lapjoint.problem import BaseHarmonic
from lapjoint.problem.excitation import Wave

FEW = {"n_modes": 4}  # the least that is quick; no accuracy is asked of these tests
JOINT = paper_joint()
FREQUENCIES = Axis(FREQUENCY, range(100, 140))


def counted(**options: Any) -> dict[str, Any]:
    return {"solver": "counting", "options": options}


def test_a_point_is_what_the_solver_says_there() -> None:
    from analytic import Solver

    curve = sweep(JOINT, [Axis(FREQUENCY, [515.0, 820.0]), Axis("damping.ratio", [0.08, 0.1])], options=FEW)
    found = Solver(n_modes=4).steady_state(paper_joint(angular_frequency=820.0, damping_ratio=0.1))
    there = curve.sel(angular_frequency=820.0, damping_ratio=0.1)
    np.testing.assert_array_equal(there.impulse, found.impulses)
    assert complex(there.multiplier_real, abs(there.multiplier_imag)) == found.multipliers[0]
    assert there.period_multiple == found.period_multiple
    assert there.duration == found.history.end - found.history.start
    assert there.contact_count == len(found.history.contacts)
    last = curve.contact_impulse[-len(found.history.contacts) :]  # it is the same as the last point, 820 and 0.1
    np.testing.assert_array_equal(last, [contact.impulse for contact in found.history.contacts])


def test_the_leading_multiplier_of_a_pair_has_a_positive_imaginary_part(counting: Path) -> None:
    curve = sweep(JOINT, [FREQUENCIES], **counted())
    assert (curve.multiplier_real == -0.3).all()
    assert (curve.multiplier_imag == 0.4).all()


def test_growth_on_the_way_and_errors_are_given_only_if_asked(counting: Path) -> None:
    plain = sweep(JOINT, [FREQUENCIES], **counted())
    both = sweep(JOINT, [FREQUENCIES], sensitivity=True, errors=True, **counted())
    assert not {"growth", "impulse_error"} & set(plain)
    np.testing.assert_array_equal(both.growth, both.angular_frequency)
    np.testing.assert_array_equal(both.impulse_error, both.impulse / 1e3)
    assert both.impulse_error.units == "N s"
    xr.testing.assert_equal(plain, both.drop_vars(["growth", "impulse_error"]))


@pytest.mark.parametrize("mapper", [map, "threads"])
def test_a_callable_like_map_does_the_work(mapper: Any, counting: Path) -> None:
    with ThreadPool(2) as threads:
        workers = threads.imap_unordered if mapper == "threads" else mapper
        curve = sweep(JOINT, [FREQUENCIES], workers=workers, **counted())
    xr.testing.assert_identical(curve, sweep(JOINT, [FREQUENCIES], **counted()))


def test_batches_that_take_long_are_handed_back(counting: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = sweep(JOINT, [FREQUENCIES], start="up", **counted())
    monkeypatch.setattr("lapjoint.campaigns.batch.BATCH_SECONDS", 0.0)
    xr.testing.assert_identical(sweep(JOINT, [FREQUENCIES], start="up", **counted()), whole)


SCRIPT = """
import sys
from lapjoint import paper_joint
from lapjoint.errors import Interrupted, OutputError
from lapjoint.campaigns import Axis, FREQUENCY, sweep
if __name__ == "__main__":
    out, workers, start, options = sys.argv[1], int(sys.argv[2]), sys.argv[3], eval(sys.argv[4])
    axes = [Axis(FREQUENCY, range(100, 140))]
    try:
        sweep(paper_joint(), axes, solver="counting", options=options, workers=workers, start=start, out=out)
    except (Interrupted, OutputError) as error:
        print(error, flush=True)
        sys.exit(130 if isinstance(error, Interrupted) else 1)
"""


def script(folder: Path, workers: int, start: str = "rest", before: str = "", **options: Any) -> subprocess.Popen[str]:
    """A process that sweeps, in a group of its own."""
    path = folder / "script.py"
    path.write_text(before + SCRIPT)
    arguments = [str(folder / "curve.nc"), str(workers), start, repr(options)]
    return subprocess.Popen(
        [sys.executable, str(path), *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def wait_for(condition: Any, seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it took too long"
        time.sleep(0.02)


def kept(folder: Path) -> int:
    """Number of points in the journal."""
    path = journal_path(folder / "curve.nc")
    return path.read_bytes().count(b'"outcome"') if path.exists() else 0


def alive(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.mark.parametrize(
    ("workers", "start"),
    [(2, "rest"), *(pytest.param(*it, marks=pytest.mark.thorough) for it in ((1, "rest"), (1, "down"), (2, "up")))],
)
def test_killed_at_once_it_resumes_and_loses_only_what_was_in_flight(
    workers: int, start: Any, counting: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COUNTING_SECONDS", "0.04")
    process = script(counting, workers, start)
    wait_for(lambda: kept(counting) >= 8)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate(timeout=30)
    wait_for(lambda: not alive(process.pid))
    safe = kept(counting)
    assert 8 <= safe < 40
    before = len(asked(counting / "log"))
    monkeypatch.delenv("COUNTING_SECONDS")
    resumed = sweep(JOINT, [FREQUENCIES], start=start, workers=workers, out=counting / "curve.nc", **counted())
    assert len(asked(counting / "log")) - before == 40 - safe
    xr.testing.assert_identical(resumed, sweep(JOINT, [FREQUENCIES], start=start, **counted()))


def test_workers_end_when_the_parent_is_killed(counting: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COUNTING_SECONDS", "0.1")
    process = script(counting, 2)
    wait_for(lambda: kept(counting) >= 12)
    process.kill()
    process.communicate(timeout=30)
    wait_for(lambda: not alive(process.pid), 10.0)


@pytest.mark.parametrize("workers", [pytest.param(1, marks=pytest.mark.thorough), 2])
def test_ctrl_c_says_what_is_kept_and_ends_the_workers(
    workers: int, counting: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COUNTING_SECONDS", "0.1")
    process = script(counting, workers)
    wait_for(lambda: kept(counting) >= 8)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does, to workers too
    out, err = process.communicate(timeout=30)
    assert process.returncode == 130, err
    path = journal_path(counting / "curve.nc")
    assert out == f"interrupted: {kept(counting)} of 40 points are kept in {path}; the same command resumes\n"
    assert err == ""
    wait_for(lambda: not alive(process.pid), 5.0)
    assert not (counting / "curve.nc").exists()


@pytest.mark.parametrize("start", [pytest.param("rest", marks=pytest.mark.thorough), "up"])
def test_a_worker_that_dies_is_replaced(start: Any, counting: Path) -> None:
    options = {"dies_at": 120.0, "died": str(counting / "died")}
    curve = sweep(JOINT, [FREQUENCIES], start=start, workers=2, **counted(**options))
    assert (counting / "died").exists()
    xr.testing.assert_identical(curve, sweep(JOINT, [FREQUENCIES], start=start, **counted(**options)))


@pytest.mark.thorough
def test_a_worker_that_dies_while_it_sends_an_answer_is_replaced(
    counting: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("lapjoint.machine.processes.PATIENCE", 0.2)
    options = {"dies_at": 120.0, "died": str(counting / "died"), "tears": True}
    curve = sweep(JOINT, [FREQUENCIES], workers=2, **counted(**options))
    xr.testing.assert_identical(curve, sweep(JOINT, [FREQUENCIES], **counted(**options)))


@pytest.mark.thorough
def test_a_point_that_kills_every_worker_is_given_up_alone(counting: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lapjoint.campaigns.workers.MOST_DEATHS", 2)  # each death costs a pool
    curve = sweep(JOINT, [FREQUENCIES], workers=2, **counted(dies_at=130.0))
    np.testing.assert_array_equal(curve.angular_frequency[curve.outcome == -1], [130.0])
    assert str(curve.message.sel(angular_frequency=130.0).item()).startswith("the process that solved it died")


@pytest.mark.thorough
def test_workers_killed_while_they_wait_are_replaced(counting: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each time points come back, all workers are killed before the next are sent."""
    monkeypatch.setattr("lapjoint.campaigns.batch.BATCH_SECONDS", 0.0)
    killed = 0

    def kill_all(done: float, total: float) -> None:
        nonlocal killed
        for child in multiprocessing.active_children() if killed < 4 and done > 1 else []:
            child.kill()
            killed += 1
        time.sleep(0.05 if done < 20 else 0.0)  # the pool may notice before the next batch is sent, or not

    curve = sweep(JOINT, [FREQUENCIES], workers=2, progress=kill_all, **counted())
    assert killed >= 4
    xr.testing.assert_identical(curve, sweep(JOINT, [FREQUENCIES], **counted()))


def test_a_point_where_the_solver_gives_up_is_kept_and_the_sweep_goes_on(counting: Path) -> None:
    curve = sweep(JOINT, [FREQUENCIES], out=counting / "curve.nc", **counted(fails_at=120.0))
    failed = curve.sel(angular_frequency=120.0)
    assert failed.outcome == -1
    assert failed.message == "stopped at t = 0.1 s"
    assert np.isnan(failed.impulse).all()
    assert failed.contact_count == 0
    assert (curve.outcome == 1).sum() == 39


@pytest.mark.thorough
def test_a_point_that_is_not_valid_is_named(counting: Path) -> None:
    for workers in (1, 2):
        with pytest.raises(InputError, match=r"^base_motion\.angular_frequency = 130: beam\.length = 2\.5: not here$"):
            sweep(JOINT, [FREQUENCIES], workers=workers, **counted(refuses_at=130.0))


@pytest.mark.parametrize("start", ["up", "down"])
def test_each_motion_starts_from_the_one_before_it(start: Any, counting: Path) -> None:
    shuffled = Axis(FREQUENCY, [103.0, 101.0, 102.0, 104.0])
    gaps = Axis("stops.*.gap", [1e-3, 2e-3])
    sweep(JOINT, [shuffled, gaps], start=start, **counted(fails_at=102.0))
    order = sorted(shuffled.values, reverse=start == "down")
    chain, past = [], None
    for omega in order:
        chain.append((omega, past))
        past = past if omega == 102.0 else omega / 3 + (past or 0.0) / 7
    assert asked(counting / "log") == chain * 2


def test_a_hardening_resonance_is_another_on_the_way_up_than_on_the_way_down() -> None:
    # A base motion so small that the free resonance at 41 rad/s just reaches the stops: past it, the contact that
    # came with the rising frequency lasts, and without it the joint stays free.
    joint = paper_joint(damping_ratio=0.02).replace(
        base_motion=BaseMotion(amplitude=1.5e-4, angular_frequency=50.0),
    )
    axis = Axis(FREQUENCY, [42.0, 44.0, 46.0, 49.0, 52.0, 53.0, 70.0])
    up, down = (sweep(joint, [axis], options={"n_modes": 10}, start=start) for start in ("up", "down"))
    names = up.outcome.attrs["flag_meanings"].split()
    last = dict(angular_frequency=53.0)
    assert names[int(up.outcome.sel(last)) + 1] == "periodic"
    assert names[int(down.outcome.sel(last)) + 1] == "no_contact"
    np.testing.assert_allclose(
        up.impulse.sel(angular_frequency=42.0), down.impulse.sel(angular_frequency=42.0), rtol=1e-6
    )


def test_random_starts_depend_on_the_seed_alone(counting: Path) -> None:
    axes = [Axis(FREQUENCY, [110.0, 120.0])]
    first = sweep(JOINT, axes, start="random", starts=3, seed=1, **counted())
    again = sweep(JOINT, axes, start="random", starts=3, seed=1, workers=reversed_map, **counted())
    other = sweep(JOINT, axes, start="random", starts=3, seed=2, **counted())
    xr.testing.assert_identical(first, again)
    assert first.outcome.dims == ("angular_frequency", "start")
    assert len(np.unique([first.impulse[..., 0], other.impulse[..., 0]])) == 12
    assert (first.distinct == 3).all()


def reversed_map(function: Any, batches: Any) -> list[Any]:
    return [function(batch) for batch in reversed(list(batches))]


def test_further_starts_come_after_the_problems_own(counting: Path) -> None:
    axes = [Axis(FREQUENCY, [110.0, 120.0])]
    curve = sweep(JOINT, axes, starts=3, **counted())
    own = sweep(JOINT, axes, **counted())
    np.testing.assert_array_equal(curve.impulse.isel(start=0), own.impulse)
    assert "distinct" not in own
    assert "start" not in own.dims


def test_a_random_start_meets_the_supports_and_has_the_size_of_the_gaps() -> None:
    from analytic import Solver

    clamp = JOINT.supports[0]
    pinned = {"supports": (clamp, clamp.model_copy(update={"x": 1.1, "torsional": 0.0}))}
    for problem in (JOINT, JOINT.replace(**pinned)):
        initial = random_initial(problem, Solver(), (0, 1, 2))
        changed = problem.replace(initial=initial)  # it is validated against the supports
        assert isinstance(changed.initial, SampledShape)
        assert initial.displacement[0] == pytest.approx(0.0, abs=1e-18)
        assert 1e-4 < np.max(np.abs(initial.displacement)) < 2e-2
        assert 1e-4 < np.max(np.abs(initial.velocity)) / 515.0 < 2e-2


def test_the_frequency_is_that_of_every_sine_load() -> None:
    loads = (
        SineLoad(x=1.0, force=1.0, angular_frequency=10.0),
        SineLoad(x=2.0, force=1.0, angular_frequency=10.0),
    )
    problem = JOINT.replace(base_motion=None, point_loads=loads)
    assert Grid(problem, (Axis(FREQUENCY, [20.0]),)).problem_at(0).excitation_frequency == 20.0
    with pytest.raises(InputError, match="nothing excites"):
        Grid(JOINT.replace(base_motion=None), (Axis(FREQUENCY, [20.0]),)).check()


def test_a_sweep_over_the_frequency_keeps_whole_multiples() -> None:
    def frequencies(base: float | None, *omegas: float) -> list[float]:
        problem = JOINT.replace(
            base_motion=None
            if base is None
            else HarmonicsBaseMotion(angular_frequency=base, harmonics=(BaseHarmonic(multiple=2, amplitude=1e-3),)),
            point_loads=tuple(SineLoad(x=1.0, force=1.0, angular_frequency=omega) for omega in omegas),
        )
        there = Grid(problem, (Axis(FREQUENCY, [7.3]),)).problem_at(0)
        moved = () if there.base_motion is None else (there.base_motion,)
        return [part.angular_frequency for part in (*moved, *there.point_loads) if not isinstance(part, StepLoad)]

    assert frequencies(60.0, 120.0, 60.0) == [7.3, 14.6, 7.3]
    assert frequencies(60.0, 20.0) == pytest.approx([7.3, 7.3 / 3])
    assert frequencies(0.1, 0.3) == [7.3, 3 * 7.3]
    assert frequencies(60.0, 90.0) == [7.3, 7.3]  # no multiples: all of one frequency, as ever
    assert frequencies(None, 40.0, 20.0) == [14.6, 7.3]


def test_harmonics_are_swept_by_frequency_and_amplitude() -> None:
    base = HarmonicsBaseMotion(
        angular_frequency=60.0,
        harmonics=(BaseHarmonic(multiple=1, amplitude=1e-3), BaseHarmonic(multiple=2, amplitude=1e-4, phase=0.5)),
    )
    axes = (Axis(FREQUENCY, [7.0, 9.0]), Axis("base_motion.harmonics.1.amplitude", [0.0, 2e-4]))
    grid = Grid(JOINT.replace(base_motion=base), axes)
    grid.check()
    assert grid.problem_at(3).forces == Grid(grid.problem_at(1), (Axis(FREQUENCY, [9.0]),)).problem_at(0).forces
    moved = grid.problem_at(3).base_motion
    assert moved is not None
    assert moved.waves == (Wave(1e-3, 9.0, 0.0), Wave(2e-4, 18.0, 0.5))
    assert [axis.name for axis in axes] == ["angular_frequency", "base_motion_harmonics_1_amplitude"]
    assert axes[1].units == "m"


def test_every_number_of_a_problem_has_units() -> None:
    definitions = Problem.model_json_schema()["$defs"].values()
    numbers = {
        name
        for definition in definitions
        if "paths" not in definition.get("properties", {})  # numbers of a distribution have the unit of what they move
        for name, field in definition.get("properties", {}).items()
        if "'type': 'number'" in str(field) and "array" not in str(field)
    }
    assert numbers
    assert numbers <= set(UNITS)


BAD: list[tuple[str, dict[str, Any], str]] = [
    ("no axes", {"axes": []}, "axes: there are none"),
    ("no values", {"axes": [("damping.ratio", [])]}, "axis damping.ratio: has no values"),
    ("no path", {"axes": [("", [1.0])]}, "must be the path of a number"),
    ("text", {"axes": [("damping.ratio", ["thin"])]}, "axis damping.ratio: 'thin' must be a number"),
    ("NaN", {"axes": [("damping.ratio", [float("nan")])]}, "nan must be a number"),
    ("value twice", {"axes": [("damping.ratio", [0.1, 0.1])]}, "0.1 is given 2 times"),
    ("axis twice", {"axes": [("stops.0.gap", [1e-3]), ("stops[0].gap", [2e-3])]}, "axis stops.0.gap: is given twice"),
    ("too many", {"axes": [(p, range(1, 5001)) for p in ("damping.ratio", "stops.*.gap")]}, f"at most {MOST_POINTS}"),
    ("unknown field", {"axes": [("stops.0.width", [1.0])]}, "unknown key"),
    ("unknown stop", {"axes": [("stops.P9.gap", [1.0])]}, "axis stops.P9.gap: there is no element 'P9'"),
    ("below a number", {"axes": [("damping.ratio.x", [1.0])]}, "axis damping.ratio.x: 'x' is below a single value"),
    ("bad value", {"axes": [("damping.ratio", [0.1, -0.1])]}, "damping.ratio = -0.1: must be"),
    ("off the beam", {"axes": [("stops.0.x", [2.5, 2.6, 2.0])]}, "stops.0.x = 2.6: stops[0].x = 2.6: lies outside"),
    ("not excited", {"axes": [("base_motion.amplitude", [0.0, 0.1])]}, "must have one angular_frequency"),
    ("start", {"start": "left"}, "start = 'left': allowed: rest, up, down, random"),
    ("starts", {"starts": 0}, "starts = 0: must be an integer from 1"),
    ("starts of a chain", {"start": "up", "starts": 2}, "starts = 2: must be 1 with start = 'up'"),
    ("seed", {"seed": -1}, "seed = -1: must be"),
    ("workers", {"workers": 0}, "workers = 0: must be"),
    ("workers by name", {"workers": "all"}, "workers = 'all': must be"),
    ("solver", {"solver": "magic"}, "solver = 'magic' is not installed"),
    ("options", {"options": {"colour": 1}}, "has no option 'colour'"),
    ("scheduler", {"scheduler": "tcp://127.0.0.1:1"}, "scheduler = 'tcp://127.0.0.1:1': cannot be reached"),
]


def swept(axes: list[Any], **given: Any) -> xr.Dataset:
    return sweep(JOINT, [Axis(*axis) for axis in axes], **given)


@pytest.mark.parametrize(("given", "message"), [row[1:] for row in BAD], ids=[row[0] for row in BAD])
def test_bad_input_is_refused_before_any_work(
    given: dict[str, Any], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("lapjoint.campaigns.cluster.PATIENCE", 0.5)
    monkeypatch.setattr("lapjoint.campaigns.cluster.REACHED", 0.5)
    with pytest.raises(InputError) as error:
        swept(**({"axes": [(FREQUENCY, [515.0])], "options": FEW, "out": tmp_path / "curve.nc"} | given))
    assert message in str(error.value)
    assert "\n" not in str(error.value)
    assert not journal_path(tmp_path / "curve.nc").exists()


@pytest.mark.thorough
def test_a_script_without_a_guard_is_told_so(counting: Path) -> None:
    path = counting / "script.py"
    once = "import lapjoint.machine.processes\nlapjoint.machine.processes.MOST_STARTS = 1\n"
    path.write_text(once + SCRIPT.replace('if __name__ == "__main__":', "if True:"))
    arguments = [str(counting / "curve.nc"), "2", "rest", "{}"]
    done = subprocess.run([sys.executable, str(path), *arguments], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    assert SolverError.__name__ in done.stderr
    assert 'must do so below if __name__ == "__main__"' in done.stderr
