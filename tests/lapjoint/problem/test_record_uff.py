"""Records in universal files (UFF) are read as they were written, or refused in one message.

The witness writes data sets 58 and 58b by the formats of the University of Cincinnati's description of them
(https://www.ceas3.uc.edu/sdrluff/), and shares no code with pyuff, which reads them.
"""

from __future__ import annotations

import struct
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lapjoint import InputError, paper_joint
from lapjoint.problem import RecordBaseMotion
from lapjoint.problem.files import problem_from_tables, problem_tables, read_problem, write_problem

pytestmark = pytest.mark.filterwarnings("ignore::lapjoint.errors.RecordWarning")
RATE = 1000.0
VALUES = np.sin(0.04 * np.arange(101)) + 0.25


def _set58(
    name: str = "table",
    values: np.ndarray = VALUES,
    *,
    function: int = 1,
    over: int = 17,
    quantity: int = 12,
    unit: str = "m/s2",
    data: int = 4,
    times: np.ndarray | None = None,
    binary: str = "",
    promised: int | None = None,
) -> bytes:
    """A data set 58; `data` is 2, 4, 5 or 6: real or complex, single or double; `binary` is ``<`` or ``>``."""
    if times is not None:
        values = np.column_stack([times, values]).ravel()
    letter = {2: "f", 4: "d", 5: "f", 6: "d"}[data]
    packed = struct.pack(f"{binary}{values.size}{letter}", *values) if binary else b""
    kind = f"{58:6d}" + (f"b{1 + (binary == '>'):6d}{2:6d}{11:12d}{len(packed):12d}" + 4 * f"{0:6d}" if binary else "")
    points = values.size // (2 if times is not None or data > 4 else 1) if promised is None else promised
    even = (1, 0.0, 1 / RATE) if times is None else (0, 0.0, 0.0)
    axes = [(over, "Time", "s"), (quantity, "z", unit), (0, "NONE", "NONE"), (0, "NONE", "NONE")]
    head = [
        f"{-1:6d}",
        kind,
        *(f"{text:<80}" for text in (name, "NONE", "29-Nov-26", "NONE", "NONE")),
        f"{function:5d}{0:10d}{0:5d}{0:10d} {'NONE':<10}{12:10d}{3:4d} {'NONE':<10}{1:10d}{0:4d}",
        f"{data:10d}{points:10d}{even[0]:10d}{even[1]:13.5e}{even[2]:13.5e}{0.0:13.5e}",
        *(f"{code:10d}{0:5d}{0:5d}{0:5d} {label:<20} {own:<20}" for code, label, own in axes),
    ]
    width, digits, each = (13, 5, 6) if data in (2, 5) else (20, 12, 4)
    numbers = [f"{value:{width}.{digits}e}" for value in values]
    if times is not None:
        numbers = [f"{value:13.5e}" if i % 2 == 0 else f"{value:20.12e}" for i, value in enumerate(values)]
    rows = ["".join(numbers[i : i + each]) for i in range(0, len(numbers), each)]
    body = packed if binary else ("\n".join(rows) + "\n").encode()
    return ("\n".join(head) + "\n").encode() + body + f"{-1:6d}\n".encode()


def _set164(code: int, length: float, force: float) -> bytes:
    factors = "".join(f"{value:25.17e}" for value in (length, force, 1.0)) + f"\n{273.15:25.17e}"
    return f"{-1:6d}\n{164:6d}\n{code:10d}{'units':<20}{2:10d}\n{factors}\n{-1:6d}\n".replace("e+", "D+").encode()


def _load(folder: Path, content: bytes | None, name: str = "r.uff", **keys: Any) -> RecordBaseMotion:
    """The record of an acceleration, unless `keys` says otherwise."""
    if content is not None:
        (folder / name).write_bytes(content)
    tables = problem_tables(paper_joint())
    tables["base_motion"] = {"kind": "record", "quantity": "acceleration", "file": name, **keys}
    found = problem_from_tables(tables, "joint", folder).base_motion
    assert isinstance(found, RecordBaseMotion)
    return found


@pytest.mark.parametrize("binary", ["", "<", ">"])
@pytest.mark.parametrize(("data", "rounded"), [(2, 1e-5), (4, 1e-12)])
def test_numbers_come_back_from_text_and_binary_of_both_precisions(
    data: int, rounded: float, binary: str, tmp_path: Path
) -> None:
    found = _load(tmp_path, _set58(data=data, binary=binary))
    assert found.values is not None
    np.testing.assert_allclose(found.values.array, VALUES, rtol=0, atol=rounded)
    np.testing.assert_allclose(found.time, np.arange(101) / RATE, rtol=1e-9)


def test_a_universal_file_is_known_by_its_first_lines_too(tmp_path: Path) -> None:
    assert _load(tmp_path, _set58(), "shaker.txt").duration == pytest.approx(0.1)


def test_times_of_their_own_are_read_and_holes_refused(tmp_path: Path) -> None:
    times = np.geomspace(0.1, 10.0, 101)
    np.testing.assert_allclose(_load(tmp_path, _set58(times=times)).time, times - 0.1, rtol=0, atol=1e-4)
    holed = np.arange(101) / 10 + 5.0 * (np.arange(101) > 60)
    with pytest.raises(InputError, match=r"times: sample 62 is at 11\.1 s, 5\.1 s after .*\(1 hole\)"):
        _load(tmp_path, _set58(times=holed))
    assert "1 hole bridged" in _load(tmp_path, _set58(times=holed), holes="bridge").remark
    with pytest.raises(InputError, match=r"times: 9\.9 comes after 10 \(sample 2\); times must ascend"):
        _load(tmp_path, _set58(times=np.arange(101)[::-1] / 10))


def test_one_of_several_data_sets_is_chosen_by_number_or_name(tmp_path: Path) -> None:
    three = _set164(1, 1.0, 1.0) + _set58() + _set58("tip", 2 * VALUES) + _set58("FRF", function=4, over=18)
    with pytest.raises(InputError) as caught:
        _load(tmp_path, three)
    assert str(caught.value) == (
        'joint: base_motion: file = "r.uff": has 3 data sets 58; dataset chooses one: 1: "table", time response of '
        'acceleration at 12+Z; 2: "tip", time response of acceleration at 12+Z; 3: "FRF", frequency response of '
        "acceleration at 12+Z"
    )
    for chosen in (2, "tip"):
        values = _load(tmp_path, three, dataset=chosen).values
        assert values is not None
        np.testing.assert_allclose(values.array, 2 * VALUES, rtol=0, atol=1e-11)
    with pytest.raises(InputError, match='dataset = "top" is none of them'):
        _load(tmp_path, three, dataset="top")
    with pytest.raises(InputError, match='dataset = "table" is several of them'):
        _load(tmp_path, _set58() + _set58(), dataset="table")


WRONG: dict[str, tuple[bytes, dict[str, Any], str]] = {
    "of another unit": (_set58(unit="g"), {}, r'unit = "m/s2": data set 1 of the file says "g"; set unit = "g"'),
    "of no known unit": (_set58(unit="mV"), {}, r'data set 1 of the file says "mV"; is no unit of acceleration \(m/s2'),
    "of the file's unit": (_set164(5, 1e3, 1e3) + _set58(unit="NONE"), {}, r'1 of the file says "mm/s2"; set unit ='),
    "of feet": (_set164(2, 3.28084, 0.2248089) + _set58(unit=""), {}, r'says "m/3\.28084/s2"; is no unit of accel'),
    "of a force": (_set58(quantity=13, unit="N"), {}, r"data set 1 is of force, and the problem asks for acceleration"),
    "of a pressure": (_set58(quantity=15), {}, r"data set 1 is of pressure, and the problem asks for acceleration"),
    "over frequency": (
        _set58(function=4, over=18),
        {},
        "data set 1 is a frequency response over frequency; a record is over",
    ),
    "complex": (_set58(data=6, values=np.ones(20)), {}, "data set 1 has complex values; a record is real"),
    "too short": (_set58(promised=200), {}, "data set 1 is damaged: it has 101 values, and should have 200"),
    "too short in binary": (_set58(promised=200, binary="<"), {}, "is damaged: it has 101 values, and should have 200"),
    "damaged": (_set58().replace(b"e-01", b"x-01", 1), {}, "data set 1 is damaged"),
    "without numbers": (_set58(values=np.full(101, np.nan)), {}, r"values\[0\] = nan: must be a finite number"),
    "without functions": (_set164(1, 1.0, 1.0), {}, "has no data set 58, in which functions of time are kept"),
    "empty": (b"", {}, "is no UFF file, which begins with a line -1"),
    "CSV": (b"t;a\n0.1;0.2\n", {}, "is no UFF file, which begins with a line -1"),
    "with a column": (_set58(), {"column": 2}, "is a UFF file, and column is a key of CSV files; leave it out"),
    "with a rate": (_set58(), {"rate": 1e3}, "rate: the file has the times; leave it out"),
    "two, of one": (_set58(), {"dataset": 2}, "has 1 data set 58; dataset = 2 is none of them"),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_no_record_is_refused_in_one_message(what: str, tmp_path: Path) -> None:
    content, keys, message = WRONG[what]
    with pytest.raises(InputError, match=message) as caught:
        _load(tmp_path, content, **keys)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("binary", ["", "<"])
def test_a_file_that_was_cut_off_anywhere_is_refused(binary: str, tmp_path: Path) -> None:
    whole = _set58(binary=binary) + _set58("tip", binary=binary)
    for end in np.linspace(1, len(whole) - 9, 60).astype(int):
        with pytest.raises(
            InputError, match=r"is no UFF file|ends within a data set|has no data set 58|has 1 data set"
        ):
            _load(tmp_path, whole[:end], dataset=2)


def test_units_that_are_spelt_otherwise_are_the_same(tmp_path: Path) -> None:
    for unit in ("m/s^2", "m/s²", "[m/s2]", "m/s**2", "NONE", ""):
        _load(tmp_path, _set58(unit=unit))
    assert _load(tmp_path, _set58(unit="G".lower()), unit="g").si_values[0] == pytest.approx(0.25 * 9.80665)


def test_a_problem_with_a_universal_file_is_written_and_read_back(tmp_path: Path) -> None:
    record = _load(tmp_path, _set58() + _set58("tip"), dataset="tip")
    problem = paper_joint().replace(base_motion=record)
    write_problem(problem, tmp_path / "joint.toml")
    assert 'dataset = "tip"' in (tmp_path / "joint.toml").read_text(encoding="utf-8")
    assert read_problem(tmp_path / "joint.toml") == problem


def test_without_pyuff_the_message_says_how_to_get_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyuff", None)
    with pytest.raises(InputError, match=r"is a UFF file, and needs pyuff: pip install 'lapjoint\[uff\]'"):
        _load(tmp_path, _set58())


def test_a_file_that_is_not_there_is_missed_where_it_is_looked_for(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no\.uff.*cannot be read: there is no such file; it is looked for in"):
        _load(tmp_path, None, "no.uff")
    with pytest.raises(InputError, match=r'dataset = 2: "r\.csv" is no UFF file; column chooses one'):
        _load(tmp_path, b"0.5\n0.6\n", "r.csv", rate=10.0, dataset=2)
