"""Files as three kinds of loggers write them: what is refused names the keys, and with these the file is read.

The forms: LabVIEW's measurement file, as National Instruments specifies it; a block of lines on each channel above the
samples, as catman writes it; a German spreadsheet with a title above the names, and units in brackets.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lapjoint import InputError, paper_joint
from lapjoint.problem import RecordBaseMotion
from lapjoint.problem.files import problem_from_tables, problem_tables

pytestmark = pytest.mark.filterwarnings("ignore::lapjoint.errors.RecordWarning")
VALUES = np.round(np.sin(np.arange(1, 40)), 6)
TIMES = np.arange(1, 40) / 500


def _rows(form: str, comma: bool = False) -> str:
    text = "".join(form.format(t=t, a=a) for t, a in zip(TIMES, VALUES, strict=True))
    return text.replace(".", ",") if comma else text


LVM = (
    "LabVIEW Measurement\t\r\nWriter_Version\t2\r\nReader_Version\t2\r\nSeparator\tTab\r\nDecimal_Separator\t,\r\n"
    "Multi_Headings\tNo\r\nX_Columns\tOne\r\nTime_Pref\tRelative\r\nOperator\tlab\r\nDate\t2019/07/22\r\n"
    "Time\t17:18:18,93894577026\r\n***End_of_Header***\t\r\n\t\r\nChannels\t1\t\t\r\nSamples\t39\t\t\r\n"
    "Date\t2019/07/22\t\t\r\nTime\t17:18:18,93894577\t\t\r\nX_Dimension\tTime\t\t\r\nX0\t0,0000000000000000E+0\t\t\r\n"
    "Delta_X\t0,002000\t\t\r\n***End_of_Header***\t\t\t\r\nX_Value\tTable\tComment\r\n"
    + _rows("{t:.6f}\t{a:.6f}\r\n", comma=True)
)
CHANNELS = (
    "run 7\r\ntwo channels\r\n\r\nTime  1 - default sample rate\tTable\t\r\ns\tm/s²\t\r\n"
    "SR=500 Hz\tSR=500 Hz\t\r\nT0=13:52:33\tT0=13:52:33\t\r\n" + _rows("{t:.5E}\t{a:.6E}\t\r\n")
)
GERMAN = "Messung: Tisch\nDatum: 12.03.2024\nRate: 500 Hz\n\nZeit [s];Beschl. [g]\n" + _rows("{t:.4f};{a:.6f}\n", True)
UNITS = "time,table\nms,m/s^2\n" + "".join(f"{1e3 * t:.1f},{a:.6f}\n" for t, a in zip(TIMES, VALUES, strict=True))
FILES: dict[str, tuple[str, dict[str, Any], dict[str, Any]]] = {
    "LabVIEW": (
        LVM,
        {"column": "Table", "time_column": "X_Value"},
        {"skip": 22, "decimal": ",", "column": 2, "time_column": 1},
    ),
    "LabVIEW by numbers": (LVM, {"column": 2, "time_column": 1, "skip": 12}, {"skip": 22, "decimal": ","}),
    "channels": (
        CHANNELS,
        {"column": "Table", "time_column": "Time  1 - default sample rate"},
        {"skip": 6, "column": 2, "time_column": 1},
    ),
    "German": (
        GERMAN,
        {"column": "Beschl. [g]", "time_column": "Zeit [s]", "unit": "g"},
        {"skip": 4, "decimal": ","},
    ),
    "another delimiter": (
        GERMAN,
        {"column": 2, "time_column": 1, "unit": "g", "skip": 5, "decimal": ",", "delimiter": "\t"},
        {"delimiter": ";"},
    ),
    "units": ("a title\n" + UNITS, {"column": "table", "time_column": "time", "time_unit": "ms"}, {"skip": 1}),
    "comments": ("% run 7\n% 2 channels\n" + UNITS, {"column": 2, "time_column": 1, "time_unit": "ms"}, {"skip": 2}),
}


def _load(folder: Path, content: str, **keys: Any) -> RecordBaseMotion:
    (folder / "r.csv").write_text(content, encoding="utf-8", newline="")
    tables = problem_tables(paper_joint())
    tables["base_motion"] = {"kind": "record", "quantity": "acceleration", "file": "r.csv", **keys}
    found = problem_from_tables(tables, "joint", folder).base_motion
    assert isinstance(found, RecordBaseMotion)
    return found


@pytest.mark.parametrize("what", FILES)
def test_the_keys_that_a_message_names_read_the_file(what: str, tmp_path: Path) -> None:
    content, keys, missing = FILES[what]
    with pytest.raises(InputError) as caught:
        _load(tmp_path, content, **keys)
    message = str(caught.value)
    named = re.search(r"; ([^;]*(?:\";\")?) would read it$", message)
    assert named is not None, message
    assert "\n" not in message
    advised = tomllib.loads(re.sub(r", (?=\w+ =)| and (?=\w+ =)", "\n", named[1]))
    assert advised == missing
    found = _load(tmp_path, content, **keys | advised)
    assert found.values is not None
    np.testing.assert_array_equal(found.values.array, VALUES)
    np.testing.assert_allclose(found.time, TIMES - TIMES[0], rtol=0, atol=1e-12)


STATED: dict[str, tuple[str, dict[str, Any], str]] = {
    "in brackets": (GERMAN, {"skip": 4, "decimal": ","}, r'unit = "m/s2": line 5 of the file says "g"; set unit = "g"'),
    "below the names": (UNITS, {}, r'time_unit = "s": line 2 of the file says "ms"; set time_unit = "ms"'),
    "that is not known": (
        UNITS.replace("m/s^2", "mV"),
        {"time_unit": "ms"},
        r'unit = "m/s2": line 2 of the file says "mV"; is no unit of acceleration \(m/s2, .*skip the heading',
    ),
    "of another quantity": (
        UNITS.replace("m/s^2", "N"),
        {"time_unit": "ms"},
        r'line 2 of the file says "N"; is no unit of acceleration',
    ),
}


@pytest.mark.parametrize("what", STATED)
def test_a_unit_that_the_file_states_must_be_that_of_the_problem(what: str, tmp_path: Path) -> None:
    content, keys, message = STATED[what]
    with pytest.raises(InputError, match=message):
        _load(tmp_path, content, column=2, time_column=1, **keys)


@pytest.mark.parametrize("heading", ["t,a\ns,m/s²\n", "t,a\n[s],[m/s^2]\n", "t (s),a (filtered)\n", "t,a\n-,-\n"])
def test_units_that_agree_or_are_none_are_passed_over(heading: str, tmp_path: Path) -> None:
    rows = "".join(f"{t:.3f},{a:.6f}\n" for t, a in zip(TIMES, VALUES, strict=True))
    found = _load(tmp_path, heading + rows, column=2, time_column=1)
    assert found.values is not None
    np.testing.assert_array_equal(found.values.array, VALUES)


def test_comments_may_begin_with_any_text(tmp_path: Path) -> None:
    found = _load(tmp_path, "% run 7\nt;a\n0.1;0.5\n%0.2;9.0\n0.2;0.6\n", comment="%", column="a", time_column="t")
    assert found.values is not None
    assert found.values.array.tolist() == [0.5, 0.6]
    with pytest.raises(InputError, match='comment = "": must have at least 1 character'):
        _load(tmp_path, "0.5\n0.6\n", comment="", rate=10.0)


def test_no_keys_are_named_where_two_sets_would_read_other_numbers(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        _load(tmp_path, "a;b\n1,5\n3,5\n", rate=10.0)
    assert "would read it" not in str(caught.value)


def test_a_long_file_needs_memory_for_its_numbers_alone(tmp_path: Path) -> None:
    import tracemalloc

    from lapjoint.problem.record_files import read_columns
    from lapjoint.problem.samples import Source

    text = "t;a\n" + "".join(f"{i / 5000:.4f};{i % 7}.5\n" for i in range(5_000))
    (tmp_path / "long.csv").write_text(text, encoding="utf-8")
    tracemalloc.start()
    read_columns(Source(str(tmp_path), "long.csv", column="a", time_column="t"))
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < len(text) + 5_000 * 8 * 3 * 3  # the file, and three arrays, while each grows and is copied
