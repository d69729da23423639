"""What a sweep's --summary put into its file can be drawn, by name and with its unit; frequencies in Hz too."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from command_line import PAPER, assert_refused, run, run_well

from lapjoint import InputError
from lapjoint.answers.quantities import QUANTITIES
from lapjoint.campaigns.sweep.table import read_curve
from lapjoint.figures import in_hertz, plot_curve, plot_curve_wide
from lapjoint.figures.sweep_axes import axis_label
from lapjoint.figures.sweep_variables import curves, drawable, ordinate
from lapjoint.summaries.of_orbit import OF_STOPS, SUMMARIES

NAMES = ("stress_peak", "displacement_rms", "force_peak", "contact_time")


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep in Hz, over gaps too, with further variables."""
    path = tmp_path_factory.mktemp("sweep") / "curve.nc"
    swept = ("--from", "80", "--to", "82", "--hz", "--over", "stops.*.gap=1e-3,2e-3", "--n-modes", "4")
    run_well("sweep", PAPER, *swept, "--summary", ",".join(NAMES), "--out", path)
    return path


@pytest.fixture(scope="module")
def curve(file: Path) -> xr.Dataset:
    return read_curve(file)


def test_a_sweep_in_hz_is_of_the_same_angular_frequencies(curve: xr.Dataset) -> None:
    assert curve.angular_frequency.values.tolist() == [2 * math.pi * f for f in (80.0, 81.0, 82.0)]
    axes = plot_curve(in_hertz(curve))
    assert axes.get_xlabel() == "frequency [Hz]"
    assert axes.get_xlim() == pytest.approx((80.0, 82.0))
    assert plot_curve(curve).get_xlabel() == "angular frequency ω [rad/s]"
    assert_refused(run("sweep", PAPER, "--from", "2", "--to", "1", "--hz", "--out", "x.nc"), "at least --from, 2 Hz")


@pytest.mark.parametrize(
    ("name", "label", "count"),
    [
        ("impulse", "impulse in a period [N s]", 4),
        ("stress_peak", "largest stress [", 1),
        ("displacement_rms", "RMS of displacement [", 1),
        ("force_peak", "largest force [", 4),
        ("contact_time", "share of time in contact", 4),
    ],
)
def test_a_variable_is_drawn_with_its_name_and_unit(curve: xr.Dataset, name: str, label: str, count: int) -> None:
    axes = plot_curve(curve, variable=name)
    assert axes.get_ylabel().startswith(label)
    found = curves(curve, name)
    assert len(found) == count
    drawn = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in axes.lines[:-1]])
    assert np.isin(found[0][1].values, drawn).all()
    assert len(plot_curve_wide(curve, variable=name)) == count + 1
    assert axes.yaxis.get_major_formatter().get_offset() == ""


@pytest.mark.parametrize(
    ("size", "unit", "expected"),
    [(3e8, "MPa", 300.0), (2e5, "kPa", 200.0), (50.0, "Pa", 50.0), (2e-5, "µPa", 20.0), (0.0, "Pa", 0.0)],
)
def test_a_prefix_keeps_numbers_on_the_axis_short(curve: xr.Dataset, size: float, unit: str, expected: float) -> None:
    scaled = curve.assign(stress_peak=xr.full_like(curve.stress_peak, size).assign_attrs(curve.stress_peak.attrs))
    assert ordinate(scaled, "stress_peak") == f"largest stress [{unit}]"
    assert float(curves(scaled, "stress_peak")[0][1][0, 0]) == pytest.approx(expected)


def test_every_summary_has_a_label(curve: xr.Dataset) -> None:
    units = {f"{one.name}_{what}": one.units for one in QUANTITIES.values() for what in ("peak", "rms")}
    for name in SUMMARIES:
        values = curve.stress_peak.assign_attrs(units=units.get(name, "N"))
        text = ordinate(curve.assign({name: values}), name)
        assert "_" not in text
        assert text[0].isalpha()


@pytest.mark.parametrize("name", ["equivalent_range", "received_power", "absolute_acceleration_peak"])
def test_a_long_label_fits_beside_the_panels_of_a_wide_figure(curve: xr.Dataset, name: str) -> None:
    like = curve.force_peak if name in OF_STOPS else curve.stress_peak
    panel = plot_curve_wide(curve.assign({name: like.assign_attrs(units="m s-2")}), variable=name)[0]
    figure = panel.get_figure(root=True)
    assert figure is not None
    figure.draw_without_rendering()
    label = panel.yaxis.label.get_window_extent()
    assert label.y0 >= figure.bbox.y0
    assert label.y1 <= figure.bbox.y1
    assert label.x0 >= figure.bbox.x0


def test_what_is_not_there_is_refused_by_name(curve: xr.Dataset, file: Path) -> None:
    assert drawable(curve) == ("impulse", *[name for name in SUMMARIES if name in NAMES])
    with pytest.raises(InputError, match=r"variable 'moment_peak': is not in this file, which has impulse, "):
        plot_curve(curve, variable="moment_peak")
    assert_refused(run("plot", file, "--variable", "weight"), "variable 'weight': is not in this file")
    picture = file.with_suffix(".svg")
    printed = run_well("plot", file, "--hz", "--wide", "--variable", "stress_peak", "-o", picture)
    assert printed.startswith(f"Wrote {picture}\n")


@pytest.mark.parametrize(
    ("path", "units", "label"),
    [
        ("masses.clevis.rotary_inertia", "kg m2", "rotary inertia (clevis mass) [kg m2]"),
        ("masses.*.mass", "kg", "mass (all masses) [kg]"),
        ("supports.0.torsional", "N m rad-1", "torsional (0 support) [N m/rad]"),
        ("gravity.acceleration", "m s-2", "gravity.acceleration [m/s2]"),
        ("damping.ratio", "1", "damping.ratio [-]"),
    ],
)
def test_a_swept_field_is_labelled_by_part_and_unit(path: str, units: str, label: str) -> None:
    dataset = xr.Dataset(coords={path: ("point", [1.0], {"path": path, "units": units})})
    assert axis_label(dataset, path) == label
