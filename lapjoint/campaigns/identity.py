"""The identity of a piece of work: its problem, its options, and the versions of the packages that compute its
answers."""

from __future__ import annotations

import json
import platform
from collections.abc import Mapping
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from lapjoint.errors import InputError
from lapjoint.problem import Problem
from lapjoint.problem.files import to_toml

PACKAGES = ("lapjoint", "numpy", "scipy", "numba")
"""Packages whose versions tell one piece of work from another, because answers are computed with them."""


def problem_identity(problem: Problem) -> dict[str, str]:
    """The text of a problem, and digests of its records, which are not in the text: part of an identity."""
    samples = {f"samples of {path}": record.digest for path, record in problem.records.items()}
    return {"problem": to_toml(problem, samples=False), **samples}


def digest_of(identity: Mapping[str, Any], options: Mapping[str, Any]) -> str:
    """A digest of an identity, in hexadecimal digits; InputError if JSON cannot hold the solver's `options` in it."""
    try:
        text = json.dumps(identity)
    except TypeError as error:
        raise InputError(f"options = {dict(options)!r}: cannot be written to a file: {error}") from None
    return sha256(text.encode()).hexdigest()


def versions() -> dict[str, str]:
    """Versions of Python and of the `PACKAGES`, by name."""

    def installed(name: str) -> str:
        try:
            return version(name)
        except PackageNotFoundError:
            return "unknown"

    return {name: installed(name) for name in PACKAGES} | {"python": platform.python_version()}


def check_integer(name: str, value: object, low: int, high: int) -> None:
    """Raise InputError, which names the value by `name`, unless it is an integer from `low` to `high`."""
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise InputError(f"{name} = {value!r}: must be an integer from {low} to {high}")


def check_seed(seed: object) -> None:
    """Raise InputError unless a seed is an integer that is not negative, of at most 63 bits."""
    check_integer("seed", seed, 0, 2**63 - 1)
