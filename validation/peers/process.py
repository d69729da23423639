"""A function of a module run in a process of its own, so that a crash of foreign code is a message and not an abort.

It is a plain ``python -m``, not a pool: a pool would import the user's script anew in its worker.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import tempfile
from importlib import import_module
from pathlib import Path
from typing import Any

from lapjoint.errors import InputError, SolverError

_LAST_WORDS = 300  # Characters shown of the last message of a crashed process


def in_another_process(function: str, arguments: tuple[Any, ...], program: str, hint: str) -> Any:
    """The result of ``module:name`` with arguments that go through pickle, run in another process.  InputError names
    the `program` and the `hint` how to install it if it cannot be imported; SolverError is raised if the function
    raises or its process dies."""
    with tempfile.TemporaryDirectory() as directory:
        question, answer = Path(directory) / "question", Path(directory) / "answer"
        question.write_bytes(pickle.dumps((function, arguments)))
        command = [sys.executable, "-m", __name__, str(question), str(answer)]
        path = os.pathsep.join(entry for entry in sys.path if entry)
        done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": path})
        if not answer.exists():
            words = done.stderr.strip()[-_LAST_WORDS:]
            raise SolverError(f"{program} ended its process with status {done.returncode}: {words}")
        kind, result = pickle.loads(answer.read_bytes())
    if kind == "missing":
        raise InputError(f"{program} is not installed, or a library of it is missing ({result}): {hint}")
    if kind == "failed":
        raise SolverError(f"{program}: {result}")
    return result


def _main(question: Path, answer: Path) -> None:
    function, arguments = pickle.loads(question.read_bytes())
    module, _, name = function.partition(":")
    try:
        result = ("done", getattr(import_module(module), name)(*arguments))
    except ImportError as error:
        result = ("missing", str(error).split("\n")[0])
    except Exception as error:
        result = ("failed", f"{type(error).__name__}: {error}")
    answer.write_bytes(pickle.dumps(result))


if __name__ == "__main__":
    _main(Path(sys.argv[1]), Path(sys.argv[2]))
