"""Files of samples are read as they were meant, or refused: decimal commas, thousands, delimiters, encodings, holes.

The witness is a writer of random files, which knows the numbers, and shares no code with the reader.
"""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from few_and_many import few_and_many

from lapjoint import InputError, paper_joint
from lapjoint.problem import RecordBaseMotion, RecordLoad
from lapjoint.problem.files import from_toml, json_schema, problem_from_tables, problem_tables, to_toml

pytestmark = pytest.mark.filterwarnings("ignore::lapjoint.errors.RecordWarning")


def _load(folder: Path, content: str | bytes, **keys: Any) -> RecordLoad:
    """The record of a force, in N at 1000 samples a second unless `keys` says otherwise."""
    (folder / "r.csv").write_bytes(content.encode() if isinstance(content, str) else content)
    tables: dict[str, Any] = problem_tables(paper_joint())
    timed = {} if "time_column" in keys else {"rate": 1000.0}
    tables["point_loads"] = [{"kind": "record", "x": 1.0, "file": "r.csv", **timed, **keys}]
    load = problem_from_tables(tables, "joint", folder).point_loads[0]
    assert isinstance(load, RecordLoad)
    return load


def _values(load: RecordLoad) -> list[float]:
    assert load.values is not None
    return [float(value) for value in load.values.array]


REFUSED: dict[str, tuple[str | bytes, dict[str, Any], str]] = {
    "a decimal comma": (
        "0,000\n29,123\n-1,5\n",
        {},
        r'line 1, "0,000": a comma may be .* decimal = "," or delimiter =',
    ),
    "two of them": ("0,0,0,1\n0,5,-0,2\n", {"column": 2}, r'line 1, "0,0,0,1": a comma may be a decimal mark'),
    "under a heading": ("force, N\n29,123\n30,5\n", {}, r'line 2, "29,123": a comma may be a decimal mark'),
    "beside spaces": ("29,123 0,5\n30,123 0,6\n", {}, r'line 1, "29,123 0,5": a comma may be a decimal mark'),
    "beside a semicolon": ("0;29,123\n1;30,5\n", {}, r'line 1, "0;29,123": a comma may be a decimal mark'),
    "too many fields": (
        "t,a\n0,0000,0,000\n",
        {"column": "a"},
        'line 2, "0,0000,0,000", has 4 fields, and line 1 has 2 fields',
    ),
    "too few fields": ("1,0.5\n2\n", {}, 'line 2, "2", has 1 field, and line 1 has 2 fields'),
    "a field in one line": (
        "0.5,0.5,3,758,\n0.6,0.6,735,\n",
        {"column": 3},
        "line 2, .*, has 4 fields, and line 1 has 5",
    ),
    "thousands": ("1,234.5\n2,234.5\n", {}, r'line 1, "1,234.5": thousands may be separated'),
    "some thousands": ("999.5\n1,000.5\n", {}, 'line 2, "1,000.5", has 2 fields, and line 1 has 1 field'),
    "thousands first": ("1,000.5\n999.5\n", {}, 'line 2, "999.5", has 1 field, and line 1 has 2 fields'),
    "thousands in a cell": ("t;a\n0;1,234.5\n", {"column": "a"}, r'line 2 has "1,234.5" in column 2, .* no separated'),
    "in the first cell": (
        "1,234.5;0\n999.5;1\n",
        {},
        r'line 1 has "1,234.5" in column 1, and must have a finite number',
    ),
    "thousands of points": ("1.234,5\n2.234,5\n", {}, r'line 1, "1.234,5": a comma may be a decimal mark'),
    "and a decimal comma": ("1.234,5\n999,5\n", {"decimal": ","}, r'line 1 has "1.234,5" in column 1'),
    "thousands of spaces": ("1 234\n2 234\n", {}, r'line 1, "1 234": thousands may be separated'),
    "of spaces and commas": ("1 234,5\n2 234,5\n", {"decimal": ","}, r'line 1, "1 234,5": thousands may be separated'),
    "of narrow spaces": ("1\u202f234\n2\u202f234\n", {}, r"line 1 has .* in column 1, and must have a finite number"),
    "of apostrophes": ("1'234.5\n999.5\n", {}, r"line 1 has \"1'234.5\" in column 1"),
    "underscores": ("0.5\n1_000.5\n", {}, r'line 2 has "1_000.5" in column 1'),
    "one mark for two": ("0,5\n", {"decimal": ",", "delimiter": ","}, 'delimiter = ",": is the decimal mark, too'),
    "another encoding": (
        "a [m/s\xb2]\n1.5\n2.5\n".encode("cp1252"),
        {},
        r'in UTF-8 \(line 1\); encoding = "cp1252" may be right',
    ),
    "no encoding": ("1.5\n2.5\n", {"encoding": "x"}, 'encoding = "x": is no encoding of text; allowed are utf-8'),
    "of bytes": ("1.5\n2.5\n", {"encoding": "hex"}, 'encoding = "hex": is no encoding of text'),
    "an endless cell": ("1.5,2\n" + "9" * 200_000 + ",3\n", {}, "cannot be read as CSV: field larger than"),
    "a mark of its own": ("1.5\n2.5\n", {"decimal": "'"}, r'decimal = "\'": must be "." or ","'),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_may_be_meant_otherwise_is_refused_with_its_line(what: str, tmp_path: Path) -> None:
    content, keys, message = REFUSED[what]
    with pytest.raises(InputError, match=message) as caught:
        _load(tmp_path, content, **keys)
    assert "\n" not in str(caught.value)


READ: dict[str, tuple[str | bytes, dict[str, Any], list[float]]] = {
    "a decimal comma": ("0,5\n29,123\n", {"decimal": ","}, [0.5, 29.123]),
    "a comma between columns": ("29,123\n30,5\n", {"delimiter": ","}, [29.0, 30.0]),
    "decimal commas and semicolons": ("t;a\n0,0;1,5\n0,1;-2,5\n", {"decimal": ",", "column": "a"}, [1.5, -2.5]),
    "decimal commas and tabs": ("0,0\t1,5\n0,1\t2,5\n", {"decimal": ",", "column": 2}, [1.5, 2.5]),
    "decimal commas and spaces": ("0,0  1,5\n0,1 2,5\n", {"decimal": ",", "column": 2}, [1.5, 2.5]),
    "a comma and a point": ("0,0.5\n1,0.25\n", {"column": 2}, [0.5, 0.25]),
    "whole numbers": ("0,1\n1,-2\n2,300\n", {"column": 2}, [1.0, -2.0, 300.0]),
    "empty cells at the end": ("t,a\n0.1,0.2,,\n0.2,0.3,,\n", {"column": "a"}, [0.2, 0.3]),
    "the first line, too": ("0.1,0.2,\n0.2,0.3,\n", {"column": 2}, [0.2, 0.3]),
    "times of day": ("12:00:01,0.25\n12:00:02,0.5\n", {"column": 2}, [0.25, 0.5]),
    "a series of pandas": (",0\n0,0.25\n1,0.5\n", {"column": "0"}, [0.25, 0.5]),
    "a semicolon before a comma": ("t [s]; acc, z\n0.0;0.25\n0.1;0.5\n", {"column": "acc, z"}, [0.25, 0.5]),
    "a byte order mark": (b"\xef\xbb\xbf0.25\n0.5\n", {}, [0.25, 0.5]),
    "cp1252": (
        "Schl\xe4ge\n0.25\n0.5\n".encode("cp1252"),
        {"encoding": "cp1252", "column": "Schl\xe4ge"},
        [0.25, 0.5],
    ),
    "utf-16": ("a\r\n0,25\r\n0,5\r\n".encode("utf-16"), {"encoding": "utf-16", "decimal": ","}, [0.25, 0.5]),
    "an empty first column": ("t\ta\n\t0.25\n0.1\t0.5\n", {"column": "a"}, [0.25, 0.5]),
}


@pytest.mark.parametrize("what", READ)
def test_what_keys_settle_is_read(what: str, tmp_path: Path) -> None:
    content, keys, right = READ[what]
    assert _values(_load(tmp_path, content, **keys)) == right


def _written(number: float, digits: int, decimal: str, thousands: str) -> str:
    return f"{number:,.{digits}f}".replace(",", "_").replace(".", decimal).replace("_", thousands)


def _random_file(rng: random.Random) -> tuple[str, list[float], dict[str, Any], int]:
    """A file, its last column as it is written, the keys with which it is read, and the number of columns."""
    decimal, delimiter = rng.choice(
        [(".", ","), (".", ";"), (".", "\t"), (".", " "), (",", ";"), (",", "\t"), (",", " ")]
    )
    columns, rows, digits = rng.randint(1, 3), rng.randint(2, 12), rng.choice([0, 1, 3, 4])
    thousands = rng.choice(["", "", "", ",", ".", " ", "'"])
    thousands = "" if thousands == decimal or (thousands == "." and digits == 0) else thousands  # 1.234 tells nothing
    scale, sign = 10.0 ** rng.randint(-2, 5), rng.choice([-1, 0, 1])
    lines, right = [], []
    for i in range(rows):
        value = round(scale * (rng.random() - (0.5 if sign < 0 else 0.0)), digits)
        others = [_written(i * rng.choice([1, 10]) / 10, 1, decimal, "") for _ in range(columns - 1)]
        lines.append(delimiter.join([*others, _written(value, digits, decimal, thousands)]))
        right.append(value)
    if rng.random() < 0.5:
        lines.insert(0, delimiter.join(["t", "u", "a"][-columns:]))
    ending = rng.choice(["", "", delimiter]) if delimiter != " " else ""
    text = "".join(f"{line}{ending}\n" for line in lines)
    keys = {} if thousands == delimiter else {"decimal": decimal, "delimiter": delimiter}
    return text, right, keys, columns


def _read(folder: Path, text: str, **keys: Any) -> list[float] | None:
    try:
        return _values(_load(folder, text, **keys))
    except InputError:
        return None


@pytest.mark.parametrize("number", few_and_many(100, 5000))
def test_random_files_are_read_as_they_were_written_or_refused(number: int, tmp_path: Path) -> None:
    """Without keys, or with the right ones."""
    found, guessed = 0, 0
    for seed in range(number):
        text, right, keys, column = _random_file(random.Random(seed))
        without = _read(tmp_path, text, column=column)
        with_keys = _read(tmp_path, text, column=column, **keys) if keys else None  # no key makes sense of some files
        assert with_keys in (right, None), (seed, text)
        assert without in (right, None), (seed, text)
        found, guessed = found + (with_keys is not None), guessed + (without is not None)
    assert found > number / 2  # those without separated thousands
    assert guessed > number / 4  # those with points, and what cannot be anything else


def _timed(folder: Path, times: np.ndarray, **keys: Any) -> RecordLoad:
    rows = "".join(f"{t:.6f},{np.sin(9 * t) + 1.5:.6f}\n" for t in times)
    return _load(folder, f"# run 3\nt,f\n{rows}", time_column="t", **keys)


EVEN = np.arange(200) / 100


def test_a_hole_in_an_even_record_is_refused_with_its_line_and_length(tmp_path: Path) -> None:
    holed = np.concatenate([EVEN[:50], EVEN[50:] + 2.0])
    message = (
        r"time_column: line 53 is at 2\.5 s, 2\.01 s after the sample before, .* 0\.01 s \(1 hole\); holes = \"bridge\""
    )
    with pytest.raises(InputError, match=message):
        _timed(tmp_path, holed)
    with pytest.raises(InputError, match=r"times: sample 51 is at 2\.5 s, 2\.01 s after the sample before"):
        RecordBaseMotion(quantity="acceleration", values=holed, times=holed)
    bridged = _timed(tmp_path, holed, holes="bridge")
    assert "1 hole bridged as from sample to sample, the longest from 0.49 s on for 2.01 s" in bridged.remark
    assert "bridged" not in _timed(tmp_path, EVEN, holes="bridge").remark
    with pytest.raises(InputError, match='holes = "fill": must be "refuse" or "bridge"'):
        _timed(tmp_path, EVEN, holes="fill")


def test_steps_that_jitter_and_steps_that_are_uneven_throughout_are_no_holes(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    _timed(tmp_path, EVEN + rng.uniform(-0.0024, 0.0024, EVEN.size))  # steps of 0.52 to 1.48 medians
    _timed(tmp_path, np.cumsum(rng.exponential(0.01, 200)) + EVEN * 1e-2)
    _timed(tmp_path, np.geomspace(0.1, 10.0, 200))
    _timed(tmp_path, np.concatenate([EVEN, EVEN[-1] + EVEN[1:100] * 3]))  # at two rates
    _timed(tmp_path, np.array([0.0, 1.0, 5.0]))


def test_every_missing_sample_of_an_even_record_is_found(tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    for count in range(1, 10):
        missing = np.sort(rng.choice(np.arange(1, 198), count, replace=False))
        load = _timed(tmp_path, np.delete(EVEN, missing), holes="bridge")
        runs = 1 + np.count_nonzero(np.diff(missing) > 1)
        assert f"; {runs} hole" in load.remark


def test_keys_of_reading_are_written_and_in_the_schema(tmp_path: Path) -> None:
    load = _load(tmp_path, "0,25\n0,5\n".encode("utf-16"), decimal=",", encoding="utf-16", holes="bridge")
    problem = paper_joint().replace(point_loads=(load,))
    text = to_toml(problem, tmp_path)
    for line in ('decimal = ","', 'encoding = "utf-16"', 'holes = "bridge"'):
        assert line in text
    (tmp_path / "joint.toml").write_text(text, encoding="utf-8")
    assert from_toml(to_toml(problem.replace(point_loads=()))) == problem.replace(point_loads=())
    keys = json_schema()["$defs"]["RecordLoad"]["properties"]
    assert keys["decimal"]["enum"] == [".", ","]
    assert keys["holes"]["default"] == "refuse"
    assert keys["encoding"]["default"] == "utf-8"
