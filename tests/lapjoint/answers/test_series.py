"""Time series are the motion's own values at equidistant times, and files keep all their digits."""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from written_history import AMPLITUDE, GAP, OMEGA, STIFFNESS, with_section

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, History, InputError, Problem, Stop, paper_joint, time_series, write_series
from lapjoint.answers.series import MOST_VALUES, PER_PERIOD, QUANTITIES
from lapjoint.files.netcdf import is_whole
from lapjoint.problem import FloatArray, Rectangle
from lapjoint.problem.files import from_toml
from lapjoint.problem.records import RecordBaseMotion

E, HEIGHT = 2e11, 0.02
EI = E * 0.05 * HEIGHT**3 / 12
BASE = BaseMotion(amplitude=0.5, angular_frequency=3.0, phase=0.2)


@pytest.fixture
def solid(history: History) -> History:
    """The written motion, of a beam that has a section, on a base that moves."""
    steel = with_section(history, Rectangle(breadth=0.05, height=HEIGHT))
    return replace(steel, problem=steel.problem.replace(base_motion=BASE))


def test_every_quantity_is_that_of_the_closed_form(solid: History) -> None:
    at = [0.4, 1.0]
    found = time_series(solid, at=at, quantities=QUANTITIES, rate=64)
    t, x = found.time.values, np.array(at)[:, None]
    assert np.array_equal(t, np.arange(65) / 64)
    shape, curvature = AMPLITUDE * x**2 * (3 - x) / 2, AMPLITUDE * (3 - 3 * x)
    wave, rate_of_wave = np.sin(OMEGA * t), OMEGA * np.cos(OMEGA * t)
    y, v = 0.5 * np.sin(3 * t + 0.2), 1.5 * np.cos(3 * t + 0.2)
    tip = AMPLITUDE * wave
    expected = {
        "displacement": shape * wave,
        "velocity": shape * rate_of_wave,
        "acceleration": -(OMEGA**2) * shape * wave,
        "absolute_displacement": shape * wave + y,
        "absolute_velocity": shape * rate_of_wave + v,
        "absolute_acceleration": -(OMEGA**2) * shape * wave - 9 * y,
        "moment": EI * curvature * wave,
        "shear": EI * -3 * AMPLITUDE * wave * np.ones_like(x),
        "stress": -E * HEIGHT / 2 * curvature * wave,
        "force": STIFFNESS * np.array([-np.maximum(tip - GAP, 0), np.maximum(-tip - GAP, 0)]),
    }
    assert set(expected) == set(found.data_vars)
    for name, values in expected.items():
        np.testing.assert_allclose(found[name].values, values, rtol=1e-13, atol=1e-13 * np.max(np.abs(values)))
        assert found[name].attrs["units"]
        assert found[name].attrs["long_name"]
    assert found["force"].dims == ("stop", "time")
    assert list(found.stop_name.values) == ["above", "below"]
    np.testing.assert_array_equal(found.force.sel(stop="below"), found.force[1])
    at_stops = found.displacement.sel(x=found.stop_x)
    np.testing.assert_array_equal(at_stops.sel(stop="below"), found.displacement.sel(x=1.0))


def test_netcdf_and_csv_keep_every_digit(solid: History, tmp_path: Path) -> None:
    found = time_series(solid, at=[1.0, 1 / 3], quantities=["absolute_acceleration", "stress", "force"], rate=37.5)
    write_series(found, tmp_path / "a.nc")
    assert is_whole((tmp_path / "a.nc").read_bytes())
    with xr.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as read:
        xr.testing.assert_equal(read.load(), found)
        assert from_toml(read.attrs["problem"]) == solid.problem
        assert read.attrs["title"] == "Time series of: Written down"
        assert read.attrs["solver"] == "written down"
        assert (read.attrs["rate"], read.attrs["rate_source"]) == (37.5, "as asked for")
    write_series(found, tmp_path / "a.csv")
    with (tmp_path / "a.csv").open(newline="") as file:
        heading, *rows = csv.reader(file)
    assert heading == [
        "time [s]",
        "absolute_acceleration at x = 1.0 m [m/s2]",
        f"absolute_acceleration at x = {1 / 3!r} m [m/s2]",
        "stress at x = 1.0 m [Pa]",
        f"stress at x = {1 / 3!r} m [Pa]",
        "force of above [N]",
        "force of below [N]",
    ]
    table = np.array(rows, dtype=float).T
    columns = (found.time.values[None], found.absolute_acceleration.values, found.stress.values, found.force.values)
    assert np.array_equal(table, np.concatenate(columns))
    with pytest.raises(InputError, match=r"\.nc or \.csv"):
        write_series(found, tmp_path / "a.xls")


def test_no_heading_is_a_formula(history: History, tmp_path: Path) -> None:
    stop = Stop(name='=HYPERLINK("a";"b")\n+1', x=1.0, side="top", gap=GAP, stiffness=STIFFNESS)
    named = replace(history, problem=history.problem.replace(stops=(stop,), title="=1+1"))
    write_series(time_series(named, rate=2), tmp_path / "a.csv")
    with (tmp_path / "a.csv").open(newline="") as file:
        heading, *rows = csv.reader(file)
    assert all(name[0].isalpha() for name in heading)
    assert len(rows) == 3


def test_the_places_are_the_stops_and_the_free_ends_by_default(history: History) -> None:
    assert time_series(history, rate=4).x.values.tolist() == [0.0, 1.0]
    held = Problem(
        beam=history.problem.beam,
        supports=({"x": 0.0, "translational": math.inf}, {"x": 1.0, "translational": 1e9}),  # type: ignore[arg-type]
        stops=(Stop(x=0.25, side="top", gap=GAP, stiffness=STIFFNESS),),
    )
    assert time_series(replace(history, problem=held), rate=4).x.values.tolist() == [0.25, 1.0]
    fixed = tuple({"x": x, "translational": math.inf} for x in (0.0, 1.0))
    clamped = replace(history, problem=Problem(beam=held.beam, supports=fixed))  # type: ignore[arg-type]
    found = time_series(clamped, rate=4)
    assert found.x.values.tolist() == [0.5]
    assert list(found.data_vars) == ["displacement"]


def test_the_last_sample_is_at_the_end_whatever_rounding_does(history: History) -> None:
    for start, duration, rate in ((0.0, 0.3, 10.0), (0.1, 0.7, 10.0), (0.2, 0.6 / 7, 70.0), (0.3, 0.6, 1e5 / 3)):
        part = replace(history, start=start, end=start + duration)
        t = time_series(part, rate=rate).time.values
        assert t.size == round(duration * rate) + 1
        assert start == t[0]
        assert t[-1] <= part.end
        assert part.end - t[-1] < 1e-9 / rate


@pytest.mark.parametrize("solver", [analytic.Solver(n_modes=8), fe_lapjoint.Solver(elements=8)], ids=["analytic", "fe"])
def test_the_default_rate_is_enough_for_the_fastest_mode(solver: analytic.Solver | fe_lapjoint.Solver) -> None:
    joint = paper_joint()
    motion = solver.simulate(joint, 0.01, errors=False)
    assert motion.highest_mode is not None
    count = 8 if isinstance(solver, analytic.Solver) else 16  # 18 degrees of freedom, of which the root fixes two
    highest = max(solver.modes(joint, state, count).angular_frequencies[-1] for state in set(motion.states))
    assert motion.highest_mode == pytest.approx(highest, rel=1e-9)
    found = time_series(motion)
    assert found.attrs["rate"] == pytest.approx(PER_PERIOD * motion.highest_mode / (2 * math.pi))
    assert f"{motion.highest_mode:.6g} rad/s of a mode" in found.attrs["rate_source"]
    assert found.x.values.tolist() == sorted({joint.beam.length, *(stop.x for stop in joint.stops)})
    assert np.array_equal(found.displacement.values, motion.displacement(found.x.values, found.time.values))


def test_each_refusal_is_one_clear_message(history: History) -> None:
    for wanted, message in (
        ({"quantities": ["stress"]}, "quantity 'stress': the beam has no section"),
        ({"quantities": ["slope"]}, "quantity 'slope': is unknown; allowed: displacement, velocity, "),
        ({"quantities": []}, "quantity: none is named"),
        ({"at": [2.0]}, "x = 2: lies outside the beam; allowed are 0 to 1 m"),
        ({"at": [math.nan]}, "x = nan: lies outside"),
        ({"at": []}, "at: names no place"),
        ({"rate": 0.0}, "rate = 0: must be positive"),
        ({"rate": math.nan}, "rate = nan: must be positive"),
        ({"rate": MOST_VALUES}, r"allowed are 1e\+07 samples"),
        ({"rate": None}, "written down does not say how fast"),
    ):
        with pytest.raises(InputError, match=message):
            time_series(history, **{"rate": 10.0, **wanted})  # type: ignore[arg-type]
    with pytest.raises(InputError, match="quantity 'force': there are no stops"):
        time_series(replace(history, problem=history.problem.replace(stops=())), quantities=["force"], rate=10)


def shaken_by(record: FloatArray, history: History) -> History:
    """The history of a joint whose base moves as samples of its acceleration say, over one second."""
    base = RecordBaseMotion(quantity="acceleration", times=np.linspace(0.0, 1.0, record.size), values=record)
    return replace(history, problem=history.problem.replace(base_motion=base), highest_mode=40.0)


def test_a_long_record_fits_into_the_file(history: History, tmp_path: Path) -> None:
    shaken = shaken_by(np.sin(OMEGA * np.linspace(0.0, 1.0, 20_001)), history)
    found = time_series(shaken, quantities=["absolute_acceleration"], rate=100.0)
    write_series(found, tmp_path / "a.nc")
    assert is_whole((tmp_path / "a.nc").read_bytes())
    own = history.acceleration(found.x.values, found.time.values)
    np.testing.assert_allclose(found.absolute_acceleration.values, own + np.sin(OMEGA * found.time.values), atol=1e-6)


@pytest.mark.parametrize(("samples", "rate"), [(501, 500.0), (11, PER_PERIOD * 40.0 / (2 * math.pi))])
def test_by_default_no_sample_of_a_record_is_passed_over(history: History, samples: int, rate: float) -> None:
    found = time_series(shaken_by(np.ones(samples), history))
    assert found.rate == pytest.approx(rate)
    assert ("record" in found.rate_source) == (samples == 501)
