"""``python -m lapjoint`` is the command."""

from __future__ import annotations

import subprocess
import sys


def test_module_runs_as_the_command() -> None:
    done = subprocess.run([sys.executable, "-m", "lapjoint", "--version"], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("lapjoint, version")
    help_text = subprocess.run([sys.executable, "-m", "lapjoint", "-h"], capture_output=True, text=True, check=True)
    assert help_text.stdout.startswith("Usage: python -m lapjoint")
