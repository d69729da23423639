"""Processes that are killed at their work."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from lapjoint.campaigns.journal import journal_path


def killed_at_work(arguments: list[str], out: Path, lines: int) -> None:
    """Run Python until the journal of `out` has more than so many lines, or the work is done; then kill all of it."""
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    process = subprocess.Popen(
        [sys.executable, *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=env,
        start_new_session=True,
    )
    journal, end = journal_path(out), time.monotonic() + 120
    try:
        while not (out.exists() or (journal.exists() and journal.read_bytes().count(b"\n") > lines)):
            assert time.monotonic() < end, "it took too long"
            time.sleep(0.005)
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
