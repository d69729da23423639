"""Problems in and out as TOML, lossless both ways.

A key that a file leaves out has the default of the schema, and defaults are not written.  Floats are written with the
fewest digits that give the number back, and an infinite stiffness as ``inf``.
"""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import ValidationError

from lapjoint.errors import InputError
from lapjoint.files.reading import read_file
from lapjoint.files.writing import write_file
from lapjoint.problem.messages import in_sentences
from lapjoint.problem.problem import Problem
from lapjoint.problem.samples import Samples
from lapjoint.problem.slips import line_meant
from lapjoint.problem.tables import tables_of


def read_problem(path: str | Path) -> Problem:
    """The problem in a TOML file.

    Parameters
    ----------
    path : path
        The file, text in UTF-8.

    Returns
    -------
    Problem
        It is validated.

    Raises
    ------
    InputError
        If there is no such file, or it is not a valid problem; one line for each fault.
    """
    return problem_from_tables(read_tables(path), str(path), Path(path).parent)


def write_problem(problem: Problem, path: str | Path) -> None:
    """Write a problem as TOML.

    Parameters
    ----------
    problem : Problem
        What is written; `read_problem` gives the same back.
    path : path
        The file; one that is there is replaced.

    Raises
    ------
    OutputError
        If no file can be written there, or the disk is full.
    """
    write_file(path, to_toml(problem, Path(path).parent))


def read_tables(path: str | Path) -> dict[str, Any]:
    """The tables of a TOML file in UTF-8, not validated yet; an `InputError` if it cannot be read, or is not TOML."""
    raw = read_file(path)
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise InputError(f"{path}: is not a text file in UTF-8 (line {line})") from None
    if not text.strip():
        raise InputError(f"{path}: is empty; `lapjoint init` writes an example of a problem")
    return tables_from_toml(text, str(path))


def tables_from_toml(text: str, source: str = "TOML") -> dict[str, Any]:
    """The tables of a TOML text, not validated yet; messages begin with `source`, and give the line of a fault."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        lines = text.count("\n", 0, len(text.rstrip())) + 1
        reason = str(error).replace("at end of document", f"at the end of the document, line {lines}")
        line = re.search(r"at line (\d+)", reason)
        meant = line_meant(text, int(line[1]), "twice" in reason) if line else ""
        raise InputError(f"{source}: is not valid TOML: {reason}{meant}") from None
    except (RecursionError, ValueError) as error:
        raise InputError(f"{source}: is not valid TOML: {error}") from None


def problem_from_tables(tables: Mapping[str, Any], source: str = "problem", folder: str | Path = ".") -> Problem:
    """The validated problem in tables as TOML holds them; an `InputError` begins with `source`, a line for each fault.

    Files of samples are looked for from `folder`.
    """
    try:
        return Problem.model_validate(tables, context={"folder": str(folder)})
    except ValidationError as error:
        raise InputError(in_sentences(error, tables, Problem, source)) from None


def from_toml(text: str) -> Problem:
    """The validated problem in a TOML text; an `InputError` has one line for each fault."""
    return problem_from_tables(tables_from_toml(text))


def to_toml(problem: Problem, folder: str | Path | None = None, *, samples: bool = True) -> str:
    """A problem as TOML, without what is None or the default; `from_toml` reads the same problem from it.

    Samples that were read from a file stay in the file, which is named relative to `folder` if it is given, with a
    digest of the samples. Without `samples` the text has no digests, and no samples that have no file.
    """
    return tomli_w.dumps(_plain(problem_tables(problem), folder, samples))


def _plain(value: Any, folder: str | Path | None, samples: bool) -> Any:
    """Tables as text can hold them: samples as lists, or where they are."""
    if isinstance(value, list):
        return [_plain(item, folder, samples) for item in value]
    if isinstance(value, Samples):
        return value.array.tolist()
    if not isinstance(value, dict):
        return value
    kept = dict(value)
    source = kept["values"].source if isinstance(kept.get("values"), Samples) else None
    if source is not None:
        if folder is not None:
            kept["file"] = os.path.relpath(Path(source.folder) / source.file, folder)
        del kept["values"]
        kept.pop("times", None)
    if not samples:
        for key in ("values", "times", "sha256"):
            kept.pop(key, None)
    return {key: _plain(item, folder, samples) for key, item in kept.items()}


def problem_tables(problem: Problem) -> dict[str, Any]:
    """A problem as the tables of its TOML file, without what is None or the default; see `problem_from_tables`."""
    return tables_of(problem)


def json_schema() -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of a problem file, with a description of every field."""
    schema = Problem.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema"} | schema


def problem_tables_json(problem: Problem) -> dict[str, Any]:
    """A problem as tables for JSON, which has no infinite numbers: an infinite stiffness is the text ``inf``."""

    def plain(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: plain(item) for key, item in value.items()}
        if isinstance(value, list):
            return [plain(item) for item in value]
        return "inf" if value == float("inf") else value

    result: dict[str, Any] = plain(_plain(problem_tables(problem), None, True))
    return result
