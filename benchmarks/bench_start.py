"""What a person waits for before anything happens: import, and the command's help."""

from __future__ import annotations

import subprocess
import sys
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
