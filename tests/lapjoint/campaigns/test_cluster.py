"""A sweep on a real dask scheduler with two workers, one of which is killed, finds what one process finds."""

from __future__ import annotations

import gc
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import xarray as xr
from counting_solver import installed
from small_joints import HIGH, LOW, SHAKEN, TOUCHING

from lapjoint import branch, paper_joint, statistics
from lapjoint.campaigns import FREQUENCY, Axis, sweep
from lapjoint.errors import InputError, SolverError

pytest.importorskip("distributed")
JOINT = paper_joint()
AXES = [Axis(FREQUENCY, range(100, 140))]


class Cluster(NamedTuple):
    """Address of a scheduler, the process groups of its two workers (each a nanny and its child), and its own."""

    address: str
    workers: list[int]
    scheduler: int

    def kill_a_worker(self) -> None:
        """Kill one at work; its nanny starts another."""
        from distributed import Client

        with Client(self.address, set_as_default=False) as client:
            os.kill(min(client.run(os.getpid).values()), signal.SIGKILL)


@contextmanager
def begun(folder: Path) -> Iterator[Cluster]:
    """A scheduler and two workers; the counting solver, which takes its time there, is installed there and here."""
    processes: list[subprocess.Popen[bytes]] = []
    where, package = folder / "scheduler.json", folder / "package"
    package.mkdir()
    with pytest.MonkeyPatch.context() as here:
        here.setenv("PYTHONPATH", installed(package))
        here.syspath_prepend(str(package))
        slow = {"COUNTING_SECONDS": "0.05", "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1"}  # of its own three

        def begin(program: str, *options: str) -> int:
            command = [sys.executable, "-m", f"distributed.cli.{program}", *options, "--scheduler-file", str(where)]
            given: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": folder}
            given |= {"env": os.environ | slow, "start_new_session": True}
            processes.append(subprocess.Popen([*command, "--no-dashboard"], **given))
            return processes[-1].pid

        try:
            scheduler = begin("dask_scheduler", "--host", "127.0.0.1", "--port", "0")
            workers = [begin("dask_worker", "--nthreads", "1", "--host", "127.0.0.1") for _ in range(2)]
            yield Cluster(address(where), workers, scheduler)
        finally:
            for process in processes:
                kill_group(process.pid)
                process.wait(timeout=30)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    """One for all tests that leave it alive."""
    with begun(tmp_path_factory.mktemp("cluster")) as cluster:
        yield cluster


@pytest.fixture
def doomed(tmp_path: Path) -> Iterator[Cluster]:
    """One of its own for a test that ends it; what was forgotten then is met there, and in no later test."""
    with begun(tmp_path) as cluster:
        yield cluster
    gc.collect()


def address(where: Path) -> str:
    end = time.monotonic() + 60
    while time.monotonic() < end:
        try:
            return str(json.loads(where.read_text())["address"])
        except (OSError, ValueError):
            time.sleep(0.05)
    raise AssertionError("the scheduler did not start")


def kill_group(group: int) -> None:
    with suppress(ProcessLookupError):
        os.killpg(group, signal.SIGKILL)


@pytest.mark.parametrize("start", [pytest.param("rest", marks=pytest.mark.thorough), "up"])
def test_a_cluster_that_loses_a_worker_finds_what_one_process_finds(
    start: Any, cluster: Cluster, tmp_path: Path
) -> None:
    killers: list[threading.Thread] = []

    def kill_one(done: float, total: float) -> None:
        if done >= 10 and not killers:
            killers.append(threading.Thread(target=cluster.kill_a_worker))
            killers[0].start()

    given: dict[str, Any] = {"solver": "counting", "start": start}
    found = sweep(JOINT, AXES, scheduler=cluster.address, out=tmp_path / "curve.nc", progress=kill_one, **given)
    assert killers
    killers[0].join()
    xr.testing.assert_identical(found, sweep(JOINT, AXES, **given))


@pytest.mark.thorough
def test_a_point_that_kills_every_worker_is_given_up_alone(cluster: Cluster) -> None:
    axes = [Axis(FREQUENCY, range(100, 104))]
    found = sweep(JOINT, axes, solver="counting", options={"dies_at": 102.0}, scheduler=cluster.address)
    assert found.outcome.values.tolist() == [1, 1, -1, 1]
    assert found.message.values.tolist() == ["", "", "the workers that solved it died", ""]


@pytest.mark.thorough
def test_statistics_on_a_cluster_that_loses_a_worker_are_those_of_one_process(cluster: Cluster, tmp_path: Path) -> None:
    killed: list[float] = []

    def kill_one(done: float, total: float) -> None:
        if done >= 2 and not killed:
            killed.append(done)
            cluster.kill_a_worker()

    given: dict[str, Any] = {"duration": 1.5, "seeds": 8, "options": {"n_modes": 2}}
    found = statistics(SHAKEN, scheduler=cluster.address, out=tmp_path / "stats.nc", progress=kill_one, **given)
    assert killed
    xr.testing.assert_identical(found, statistics(SHAKEN, **given))


@pytest.mark.thorough
def test_branches_on_a_cluster_that_loses_a_worker_are_those_of_one_process(cluster: Cluster, tmp_path: Path) -> None:
    killed: list[float] = []

    def kill_one(done: float, total: float) -> None:
        if done >= 9 and not killed:
            killed.append(done)
            cluster.kill_a_worker()

    also = Axis("stops.*.gap", (0.95e-3, 1e-3, 1.05e-3, 1.1e-3))
    given: dict[str, Any] = {"options": {"n_modes": 2}, "errors": False, "also_over": also}
    where = TOUCHING, "base_motion.amplitude", LOW, HIGH
    found = branch(*where, scheduler=cluster.address, out=tmp_path / "loci.nc", progress=kill_one, **given)
    assert killed
    xr.testing.assert_identical(found, branch(*where, **given))


@pytest.mark.slow
def test_the_script_of_the_page_on_clusters_runs(tmp_path: Path) -> None:
    page = (Path(__file__).resolve().parents[3] / "docs" / "sweeps.md").read_text(encoding="utf-8")
    (script,) = re.findall(r"^```py\n(.*?)^```$", page, re.DOTALL | re.MULTILINE)
    (tmp_path / "script.py").write_text(script, encoding="utf-8")
    done = subprocess.run([sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


def test_without_dask_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r"needs the package distributed; install it with pip install 'lapjoint"):
        sweep(JOINT, AXES, scheduler="tcp://127.0.0.1:8786", options={"n_modes": 4})


@pytest.mark.parametrize("address", ["", "x://y", "tcp://", "tcp://a:b:c", "tls://127.0.0.1:1", "tcp://127.0.0.1:1"])
def test_an_address_that_is_none_is_refused(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lapjoint.campaigns.cluster.REACHED", 0.2)
    with pytest.raises(InputError, match="cannot be reached"):
        sweep(JOINT, AXES, scheduler=address, options={"n_modes": 4})


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("lost", "message"),
    [
        ("workers", r"all workers of the scheduler are gone, and none came in 2 s; \d+ of 40 points are kept in"),
        ("scheduler", r"the connection to it was lost; \d+ of 40 points are kept in .*; the same command resumes"),
    ],
)
def test_a_cluster_that_dies_ends_the_sweep_with_a_message(
    lost: str,
    message: str,
    doomed: Cluster,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    """By that alone: what else was under way says nothing when it is forgotten."""
    monkeypatch.setattr("lapjoint.campaigns.cluster.ALONE", 2.0)
    monkeypatch.setattr("lapjoint.campaigns.cluster.LOOK", 0.5)

    def kill_all(done: float, total: float) -> None:
        if done >= 5:
            for group in doomed.workers if lost == "workers" else [doomed.scheduler]:
                kill_group(group)

    with pytest.raises(SolverError, match=message):
        sweep(JOINT, AXES, solver="counting", scheduler=doomed.address, out=tmp_path / "curve.nc", progress=kill_all)
    gc.collect()
    assert not caplog.records


@pytest.mark.thorough
def test_answers_that_are_lost_with_their_workers_are_not_waited_for(
    doomed: Cluster, cluster: Cluster, tmp_path: Path
) -> None:
    """All points are solved, and no answer has been fetched, when the workers are killed; another cluster goes on."""
    from distributed import Client

    fetch = Client.gather

    def too_late(client: Any, answer: Any, **options: Any) -> Any:
        wait_until_idle(doomed.address)
        for group in doomed.workers:
            kill_group(group)
        return fetch(client, answer, **options)

    given: dict[str, Any] = {"solver": "counting", "out": tmp_path / "curve.nc"}
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("lapjoint.campaigns.cluster.ALONE", 2.0)
        patched.setattr("lapjoint.campaigns.cluster.LOOK", 0.5)
        patched.setattr(Client, "gather", too_late)
        with pytest.raises(SolverError, match="all workers of the scheduler are gone"):
            sweep(JOINT, AXES, scheduler=doomed.address, **given)
    found = sweep(JOINT, AXES, scheduler=cluster.address, **given)
    assert (found.outcome.values == 1).all()


def wait_until_idle(address: str) -> None:
    """Wait until no worker of a scheduler has work."""
    from distributed import Client

    with Client(address, set_as_default=False) as client:
        end = time.monotonic() + 60
        while any(client.processing().values()):
            assert time.monotonic() < end, "it took too long"
            time.sleep(0.05)
