"""Recorded excitation: what lies between samples, files and arrays, and a message for each bad record."""

from __future__ import annotations

import os
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lapjoint import InputError, Problem, paper_joint, read_problem, write_problem
from lapjoint.campaigns.grid import FREQUENCY, Axis, Grid
from lapjoint.campaigns.sweep.spec import Plan
from lapjoint.errors import RecordWarning
from lapjoint.problem import RecordBaseMotion, RecordLoad
from lapjoint.problem.files import from_toml, problem_from_tables, problem_tables, to_toml
from lapjoint.problem.samples import Samples

RATE = 5000.0
TIMES = np.arange(401) / RATE
VALUES = 0.3 * np.sin(190.0 * TIMES) + 0.02 + 0.5 * TIMES
TABLES = {"kind": "record", "quantity": "acceleration", "values": VALUES.tolist(), "rate": RATE}


def _joint(**changes: Any) -> Problem:
    tables = problem_tables(paper_joint())
    tables["base_motion"] = {key: value for key, value in (TABLES | changes).items() if value is not None}
    return problem_from_tables(tables, "joint")


def _in_a_file(folder: Path, **changes: Any) -> Path:
    rows = "\n".join(f"{t!r};{x!r}" for t, x in zip(TIMES.tolist(), (VALUES / 9.80665).tolist(), strict=True))
    (folder / "shaker.csv").write_text(f"# run 7\nt;acc z\n{rows}\n", encoding="utf-8")
    write_problem(paper_joint().replace(base_motion=None), folder / "joint.toml")
    lines = {
        "kind": "record",
        "quantity": "acceleration",
        "file": "shaker.csv",
        "time_column": "t",
        "unit": "g",
    } | changes
    text = "\n".join(f"{key} = {value!r}".replace("'", '"') for key, value in lines.items())
    with (folder / "joint.toml").open("a", encoding="utf-8") as file:
        file.write(f"\n[base_motion]\n{text}\n")
    return folder / "joint.toml"


def _record(problem: Problem) -> RecordBaseMotion:
    assert isinstance(problem.base_motion, RecordBaseMotion)
    return problem.base_motion


@pytest.mark.parametrize(("unit", "seconds"), [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("min", 60.0)])
def test_samples_lie_at_their_own_time_stamps(unit: str, seconds: float) -> None:
    """Stamps whose steps grow, and samples on a straight line over them: the line comes back between the samples."""
    stamps = np.arange(1.0, 9.0) ** 2
    record = RecordBaseMotion(
        quantity="acceleration", times=Samples(stamps), time_unit=unit, values=Samples(0.01 * stamps)
    )
    np.testing.assert_allclose(record.time, (stamps - 1.0) * seconds, rtol=1e-15)
    t = np.linspace(0.0, record.duration, 50)
    line = 0.01 * (1.0 + t / seconds)
    np.testing.assert_allclose(np.interp(t, record.motion.time, record.motion.acceleration), line, rtol=1e-13)


@pytest.mark.parametrize(("quantity", "order"), [("acceleration", 2), ("velocity", 1), ("displacement", 0)])
def test_the_acceleration_between_samples_converges_with_their_square(quantity: str, order: int) -> None:
    def exact(t: np.ndarray, derivative: int) -> np.ndarray:
        return 60.0 ** (derivative - 2) * np.sin(60 * t + 0.3 + derivative * np.pi / 2)

    errors, t = [], np.linspace(0.0, 0.4, 2001)
    for count in (161, 321, 641):
        times = np.linspace(0.0, 0.4, count)
        record = RecordBaseMotion(quantity=quantity, values=exact(times, order), times=times)
        assert np.allclose(record.at(times, order), exact(times, order), rtol=0, atol=1e-12 * 60.0 ** (order - 2))
        errors.append(np.max(np.abs(record.at(t, 2) - exact(t, 2))))
    assert np.all(np.abs(np.log2(np.array(errors[:-1]) / errors[1:]) - 2) < 0.15)  # the ends add terms of third order


@pytest.mark.parametrize(("quantity", "order"), [("acceleration", 2), ("velocity", 1), ("displacement", 0)])
def test_samples_inserted_on_the_interpolant_change_nothing(quantity: str, order: int) -> None:
    record = RecordBaseMotion(quantity=quantity, values=VALUES, rate=RATE)
    more = np.linspace(0.0, TIMES[-1], 3 * (TIMES.size - 1) + 1)  # the middles of intervals stay middles of intervals
    again = RecordBaseMotion(quantity=quantity, values=record.at(more, order), times=more)
    t = np.linspace(0.0, TIMES[-1], 3001)
    assert np.allclose(again.at(t, 2), record.at(t, 2), rtol=0, atol=1e-8 * np.max(np.abs(record.at(t, 2))))
    assert np.allclose(again.at(t, 0), record.at(t, 0), rtol=0, atol=1e-11 * np.max(np.abs(record.at(t, 0))))


def test_offset_and_drift_are_said_and_removed_if_asked() -> None:
    as_recorded = _record(_joint())
    assert "mean 0.0" in as_recorded.remark
    assert "removed: nothing" in as_recorded.remark
    end = np.array([TIMES[-1]])
    without_mean, without_line = (_record(_joint(remove=what)) for what in ("offset", "drift"))
    assert abs(float(without_mean.at(end, 1)[0])) < 1e-15
    assert abs(float(without_mean.at(end, 0)[0])) > 1e-6
    # a line nearest to the acceleration takes the velocity and the displacement at the end with it
    assert abs(float(without_line.at(end, 1)[0])) < 1e-15
    assert abs(float(without_line.at(end, 0)[0])) < 1e-15
    load = RecordLoad(x=1.0, values=VALUES, rate=RATE, remove="drift")
    assert np.max(np.abs(np.polyfit(TIMES, load.force, 1))) < 0.05 * np.max(np.abs(np.polyfit(TIMES, VALUES, 1)))


def test_a_file_and_an_array_give_the_same_motion(tmp_path: Path) -> None:
    problem = read_problem(_in_a_file(tmp_path))
    t = np.linspace(0.0, TIMES[-1], 101)
    assert np.allclose(_record(problem).at(t, 2), _record(_joint()).at(t, 2), rtol=1e-12)
    numbered = read_problem(_in_a_file(tmp_path, column=2, time_column=1, skip=1, delimiter=";"))
    assert _record(numbered).values == _record(problem).values


def test_problems_with_records_are_written_and_read_without_loss(tmp_path: Path) -> None:
    given = _joint(remove="offset")
    assert from_toml(to_toml(given)) == given
    assert pickle.loads(pickle.dumps(given)) == given
    read = read_problem(_in_a_file(tmp_path))
    (tmp_path / "deeper").mkdir()
    write_problem(read, tmp_path / "deeper" / "copy.toml")
    assert os.path.join("..", "shaker.csv") in (tmp_path / "deeper" / "copy.toml").read_text(encoding="utf-8")
    again = read_problem(tmp_path / "deeper" / "copy.toml")
    assert _record(again).values == _record(read).values
    (tmp_path / "shaker.csv").unlink()
    assert pickle.loads(pickle.dumps(read)) == read  # samples travel with the problem
    assert read.replace(title="another").base_motion == read.base_motion


def test_a_file_that_changed_since_it_was_named_with_its_digest_is_told(tmp_path: Path) -> None:
    path = _in_a_file(tmp_path)
    write_problem(read_problem(path), path)
    text = (tmp_path / "shaker.csv").read_text(encoding="utf-8")
    (tmp_path / "shaker.csv").write_text(text.replace("0.0002;", "0.00021;"), encoding="utf-8")
    with pytest.raises(InputError, match=r'"shaker\.csv" has changed: its samples now have [0-9a-f]{64}'):
        read_problem(path)


def test_a_plan_holds_the_digest_and_not_the_samples() -> None:
    plans = [Plan(Grid(_joint(values=values), (Axis("damping.ratio", (0.1,)),))) for values in ([1.0, 2.0], [1.0, 3.0])]
    first, second = (plan.identity for plan in plans)
    assert "values" not in first["problem"]
    assert [key for key, value in first.items() if value != second[key]] == ["samples of base_motion"]


def test_what_has_no_period_says_so() -> None:
    with pytest.raises(InputError, match="steady state: base_motion is a record, which has no period"):
        _joint().require_excitation_frequency("steady state")
    with pytest.raises(InputError, match=r"axis base_motion\.angular_frequency: base_motion is a record"):
        Grid(_joint(), (Axis(FREQUENCY, (1.0,)),)).check()


def test_no_motion_is_simulated_beyond_its_record() -> None:
    problem = _joint()
    problem.check_duration(problem.longest)
    with pytest.raises(InputError, match=r"duration = 0.1: the record of base_motion ends at 0.08 s"):
        problem.check_duration(0.1)


FAULTS = {
    "wrong unit": ({"unit": "furlong"}, 'unit = "furlong": is no unit of acceleration; allowed: m/s2, '),
    "wrong unit of time": ({"time_unit": "h"}, 'time_unit = "h": allowed: s, ms, us, min'),
    "one sample": ({"values": [1.0]}, "values: there is 1 sample; at least 2 are needed"),
    "not a number": ({"values": [1.0, float("nan")]}, r"values\[1\] = nan: must be a finite number"),
    "text": ({"values": [1.0, "2"]}, "base_motion.values: must be a list of numbers"),
    "one number": ({"values": 2.0}, "base_motion.values = 2.0: must be a list of numbers"),
    "too large": ({"values": [1e200, 0.0]}, "values: the largest is 1e[+]200, and its square must be finite"),
    "unsorted": ({"times": [0.0, 2.0, 1.0], "values": [1.0] * 3, "rate": None}, r"times: 1 comes after 2 \(sample 3\)"),
    "repeated": ({"times": [0.0, 1.0, 1.0], "values": [1.0] * 3, "rate": None}, "times: 1 is there twice"),
    "few times": ({"times": [0.0, 1.0], "values": [1.0] * 3, "rate": None}, "times: there are 2, and 3 values"),
    "rate and times": ({"times": [0.0, 1.0], "values": [1.0] * 2}, "rate, times: give one of them"),
    "neither": ({"rate": None}, "rate, times: give one of them"),
    "nothing": ({"values": None}, "file: is missing"),
    "no file": ({"values": None, "file": "none.csv"}, 'file = "none.csv": cannot be read: No such file'),
    "both": ({"file": "none.csv"}, "file, values: give one of them"),
    "quantity": ({"quantity": "jerk"}, 'quantity = "jerk": must be "acceleration", "velocity" or "displacement"'),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_bad_record_gets_one_clear_message(fault: str) -> None:
    changes, message = FAULTS[fault]
    with pytest.raises(InputError, match=message) as caught:
        _joint(**changes)
    assert "\n" not in str(caught.value)


FILE_FAULTS = {
    "column": ({"column": "acc"}, 'column = "acc": is no column of shaker.csv; allowed: t, acc z, or 1 to 2'),
    "number": ({"column": 3}, "column = 3: is no column of shaker.csv; allowed: t, acc z, or 1 to 2"),
    "time": ({"column": "t"}, "column = 1: is the time_column, too"),
    "skip": ({"skip": 999}, "has no samples after the 999 lines that skip leaves out"),
    "cells": ({"delimiter": ","}, 'time_column = "t": is no column'),
}


@pytest.mark.parametrize("fault", FILE_FAULTS)
def test_a_bad_file_gets_one_clear_message(fault: str, tmp_path: Path) -> None:
    changes, message = FILE_FAULTS[fault]
    with pytest.raises(InputError, match=message):
        read_problem(_in_a_file(tmp_path, **changes))


def test_a_cell_that_is_no_number_is_named_by_its_line(tmp_path: Path) -> None:
    path = _in_a_file(tmp_path)
    with (tmp_path / "shaker.csv").open("a", encoding="utf-8") as file:
        file.write("9.0;over\n")
    with pytest.raises(InputError, match='line 404 has "over" in column 2, and must have a finite number'):
        read_problem(path)


def test_a_record_that_no_shaker_makes_is_a_warning() -> None:
    with pytest.warns(RecordWarning, match='a thousand times what shakers reach; is unit = "g" right?'):
        RecordBaseMotion(quantity="acceleration", values=[0.0, 3e5], rate=1e3, unit="g")


def test_a_rate_too_low_for_the_beam_is_a_warning() -> None:
    with pytest.warns(RecordWarning, match="base_motion: has 10 samples a second, and the beam bends at"):
        _joint(rate=10.0)
    with pytest.warns(RecordWarning, match="base_motion: has 10 samples a second, and the beam bends at"):
        paper_joint().with_excitation(base_motion=_joint(rate=1e4).base_motion.model_copy(update={"rate": 10.0}))


def test_a_column_of_times_is_used_as_it_is(tmp_path: Path) -> None:
    times, heights = np.array([0.0, 0.01, 0.04, 0.05, 0.07, 0.1]), np.array([0.0, 1.0, -2.0, 0.5, 3.0, -1.0])
    rows = "".join(f"{t!r},{a!r}\n" for t, a in zip((times + 3).tolist(), heights.tolist(), strict=True))
    (tmp_path / "uneven.csv").write_text(f"time,acceleration\n{rows}")
    tables = {"quantity": "acceleration", "file": "uneven.csv", "time_column": "time"}
    record = RecordBaseMotion.model_validate(tables, context={"folder": str(tmp_path)})
    np.testing.assert_allclose(record.at(times[:-1], 2), heights[:-1], rtol=0, atol=1e-9)
