"""A pool of processes ends at Ctrl-C and after an error, whatever its processes are doing."""

from __future__ import annotations

import math
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

import pytest
from counting_solver import tear

from lapjoint.machine.processes import end_pool, first_finished, new_pool, process_pool, standing_pool

LONG = 600.0  # s: longer than any of these tests may take
BUSY = """
import sys, time
from lapjoint.machine.processes import process_pool
if __name__ == "__main__":
    with process_pool(2) as pool:
        tasks = [pool.submit(time.sleep, 600.0) for _ in range(6)]
        print("busy", flush=True)
        tasks[0].result()
"""


def test_answers_come_in_the_order_asked_for() -> None:
    with process_pool(2) as pool:
        assert list(pool.map(math.sqrt, [4.0, 9.0, 16.0])) == [2.0, 3.0, 4.0]
    assert multiprocessing.active_children() == []


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError])
def test_an_error_in_the_block_ends_the_processes_at_once(error: type[BaseException]) -> None:
    begin = time.monotonic()

    def work() -> None:
        with process_pool(2) as pool:
            for _ in range(6):
                pool.submit(time.sleep, LONG)
            raise error

    with pytest.raises(error):
        work()
    assert multiprocessing.active_children() == []
    assert time.monotonic() - begin < LONG / 10


def test_ctrl_c_reaches_the_parent_while_it_waits() -> None:
    def wait() -> None:
        with process_pool(2) as pool:
            threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
            list(pool.map(time.sleep, [LONG] * 4))

    with pytest.raises(KeyboardInterrupt):
        wait()
    assert multiprocessing.active_children() == []


def test_ctrl_c_in_a_terminal_gives_one_traceback_and_leaves_no_process(tmp_path: Path) -> None:
    (tmp_path / "busy.py").write_text(BUSY)
    process = subprocess.Popen(
        [sys.executable, str(tmp_path / "busy.py")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "busy\n"
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does, to the workers too
    _, said = process.communicate(timeout=60)  # returns when no process holds the pipes any more
    assert said.count("Traceback") == 1
    assert said.rstrip().endswith("KeyboardInterrupt")


def test_all_processes_have_started_when_the_pool_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those that started later would meet Ctrl-C before they can ignore it.

    On a busy machine the first process may wait for work before the last task is submitted.
    """
    submit = ProcessPoolExecutor.submit

    def slowly(*task: Any, **more: Any) -> Any:
        time.sleep(0.7)
        return submit(*task, **more)

    with monkeypatch.context() as patch:
        patch.setattr(ProcessPoolExecutor, "submit", slowly)
        pool = new_pool(3)
    try:
        before = multiprocessing.active_children()
        assert len(before) == 3
        assert list(pool.map(abs, range(12))) == list(range(12))
        assert set(multiprocessing.active_children()) == set(before)
    finally:
        end_pool(pool)


def test_tasks_that_are_cancelled_as_the_pool_ends_raise_nothing_in_its_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the machine is busy with: here the pool is slow to shut down, and its processes end meanwhile."""
    shutdown = ProcessPoolExecutor.shutdown

    def slowly(pool: ProcessPoolExecutor, wait: bool = True, *, cancel_futures: bool = False) -> None:
        time.sleep(0.5)
        shutdown(pool, wait, cancel_futures=cancel_futures)

    def work() -> None:
        with process_pool(2) as pool:
            for task in [pool.submit(time.sleep, LONG) for _ in range(30)]:
                task.cancel()
            raise KeyboardInterrupt

    monkeypatch.setattr(ProcessPoolExecutor, "shutdown", slowly)
    with pytest.raises(KeyboardInterrupt):
        work()  # pytest fails a test in one of whose threads an exception is raised


def test_a_script_whose_workers_end_as_they_start_is_told_why(tmp_path: Path) -> None:
    script = tmp_path / "no_main.py"
    script.write_text("from lapjoint.machine.processes import process_pool\nwith process_pool(1):\n    pass\n")
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=100)
    assert "SolverError: the worker processes end as soon as they start; a script that asks for workers" in done.stderr


def test_a_standing_pool_keeps_its_processes_and_starts_others_after_one_dies() -> None:
    with standing_pool(2) as standing:
        assert list(standing.pool.map(math.sqrt, [4.0, 9.0])) == [2.0, 3.0]
        first = set(multiprocessing.active_children())
        assert list(standing.pool.map(math.sqrt, [4.0, 9.0])) == [2.0, 3.0]
        assert set(multiprocessing.active_children()) == first
        with pytest.raises(BrokenProcessPool):
            standing.pool.submit(os.abort).result()
        standing.end()
        assert list(standing.pool.map(math.sqrt, [16.0])) == [4.0]
        assert not first & set(multiprocessing.active_children())
    assert multiprocessing.active_children() == []


def test_a_task_that_a_pool_forgets_as_it_breaks_is_not_waited_for() -> None:
    """As happens once in some thousand times, where a process dies while a task is given."""
    forgotten: Future[None] = Future()
    with process_pool(2) as pool:
        for process in multiprocessing.active_children():
            process.kill()
        with pytest.raises(BrokenProcessPool):
            first_finished(pool, [forgotten])


def test_a_pool_ends_although_a_process_was_killed_while_it_sent_an_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lapjoint.machine.processes.PATIENCE", 0.2)
    with process_pool(2) as pool, pytest.raises(BrokenProcessPool):
        first_finished(pool, [pool.submit(die_while_sending)])
    assert multiprocessing.active_children() == []


def die_while_sending() -> None:
    tear()
    os._exit(1)
