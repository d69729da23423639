"""What a person waits for before anything happens: import, the command's help, and compiling on a new machine."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

COMMANDS = {
    "python, doing nothing": ["-c", "pass"],
    "import lapjoint": ["-c", "import lapjoint"],
    "import analytic": ["-c", "import analytic"],
    "import fe_lapjoint": ["-c", "import fe_lapjoint"],
    "lapjoint --help": ["-c", "from lapjoint.cli.main import main; main(['--help'])"],
}


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.benchmark(group="start")
def bench_start(benchmark: Any, command: str) -> None:
    benchmark.pedantic(
        subprocess.run,
        ([sys.executable, *COMMANDS[command]],),
        {"check": True, "capture_output": True},
        rounds=5,
        warmup_rounds=1,
    )


SOLVER = "import {0}, lapjoint; solver, problem = {0}.Solver(), lapjoint.paper_joint(); "
FIRST = {
    "analytic, simulate": SOLVER.format("analytic") + "solver.simulate(problem, 1e-3)",
    "analytic, steady": SOLVER.format("analytic") + "solver.steady_state(problem)",
    "fe, simulate": SOLVER.format("fe_lapjoint") + "solver.simulate(problem, 1e-3)",
    "fe, steady": SOLVER.format("fe_lapjoint") + "solver.steady_state(problem)",
}


@pytest.mark.parametrize("kept", ["compiling", "compiled before"])
@pytest.mark.parametrize("question", FIRST)
def bench_first(benchmark: Any, question: str, kept: str, tmp_path: Path) -> None:
    """The first answer of a process, on a machine that has compiled nothing, and on one that has."""
    benchmark.group = f"first answer: {question}"
    run = {"check": True, "env": {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}}
    command = ([sys.executable, "-c", FIRST[question]],)
    benchmark.pedantic(subprocess.run, command, run, rounds=1, warmup_rounds=int(kept != "compiling"))
