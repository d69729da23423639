"""The dataset of a sweep: its file read by others, its conventions, and its figures."""

from __future__ import annotations

import json
import math
import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np
import pytest
import xarray as xr

from lapjoint import Outcome, paper_joint
from lapjoint.campaigns.grid import FREQUENCY, Axis, Grid
from lapjoint.campaigns.point import Point
from lapjoint.campaigns.sweep.spec import Plan
from lapjoint.campaigns.sweep.table import read_curve, sweep_dataset
from lapjoint.errors import InputError, OutputError
from lapjoint.figures import plot_curve, plot_curve_wide, save
from lapjoint.figures.impulse_curve_wide import OUTCOME_COLOURS, certificates
from lapjoint.files.netcdf import write_netcdf
from lapjoint.problem.files import from_toml

JOINT = paper_joint()
OUTCOMES = [outcome.name for outcome in Outcome]


def plan(frequencies: int = 12, gaps: int = 0, **given: Any) -> Plan:
    axes = [Axis(FREQUENCY, np.linspace(100.0, 1200.0, frequencies))]
    axes += [Axis("stops.*.gap", np.linspace(1e-3, 3e-3, gaps))] if gaps else []
    return Plan(Grid(JOINT, tuple(axes)), **given)


def point(cell: int) -> Point:
    """Something that looks like a sweep: two humps, every outcome, up to six contacts."""
    x = cell / 12
    size = 1e3 * (math.exp(-((x - 0.4) ** 2) * 50) + 2 * math.exp(-((x - 0.7) ** 2) * 30) + 0.1)
    impulses = tuple(sign * size * scale for sign, scale in ((-1, 0.3), (-1, 1.0), (1, 0.3), (1, 1.0)))
    outcome = OUTCOMES[cell % len(OUTCOMES)]
    if cell % 8 == 7:
        return Point(message="stopped")
    multiple = 0 if outcome in ("QUASIPERIODIC", "APERIODIC", "UNDECIDED") else 1 + cell % 2
    contacts = tuple((k % 4, 0.1 * k, 0.05, float(cell), 2.0, 0, 0.5) for k in range(cell % 7))
    return Point(outcome, multiple, False, 1e-9, 0.5, 0.0, math.nan, math.nan, impulses, 1.0, contacts)


def dataset(this: Plan) -> xr.Dataset:
    return sweep_dataset(this, {cell: point(cell) for cell in range(this.size)})


def test_a_file_gives_back_the_dataset(tmp_path: Path) -> None:
    for this in (plan(), plan(3, 4), plan(3, start="random", starts=2), plan(1)):
        write_netcdf(dataset(this), tmp_path / "curve.nc")
        xr.testing.assert_identical(read_curve(tmp_path / "curve.nc"), dataset(this))
    assert [path.name for path in tmp_path.iterdir()] == ["curve.nc"]


def test_a_joint_without_stops_and_a_long_problem_fit_into_a_file(tmp_path: Path) -> None:
    free = JOINT.replace(stops=(), title="x" * 200_000)
    this = Plan(Grid(free, (Axis(FREQUENCY, [1.0, 2.0]),)))
    found = sweep_dataset(this, {cell: Point("NO_CONTACT", 1) for cell in range(2)})
    write_netcdf(found, tmp_path / "curve.nc")
    xr.testing.assert_identical(read_curve(tmp_path / "curve.nc"), found)
    assert from_toml(found.attrs["problem"]) == free
    plot_curve(found)
    plot_curve_wide(found)


def test_everything_has_a_name_units_and_dimensions_with_names() -> None:
    found = dataset(plan(3, 2, start="random", starts=2))
    for name, variable in found.variables.items():
        assert variable.attrs["long_name"], name
        text = variable.dtype.kind in "OUT"
        assert (
            text
            or "units" in variable.attrs
            or {"flag_values", "flag_masks"} & set(variable.attrs)
            or (name == "contact_stop")
        ), name
    assert found.attrs["Conventions"] == "CF-1.11"
    assert json.loads(found.attrs["options"]) == {}
    assert {f"version_{name}" for name in ("lapjoint", "numpy", "scipy", "numba", "python")} <= set(found.attrs)
    assert (
        len(found.outcome.attrs["flag_values"]) == len(found.outcome.attrs["flag_meanings"].split()) == len(Outcome) + 1
    )


def test_other_readers_find_the_contacts_of_each_motion(tmp_path: Path) -> None:
    this = plan(4, 3)
    write_netcdf(dataset(this), tmp_path / "curve.nc")
    with h5py.File(tmp_path / "curve.nc") as file:
        counts, impulses = file["contact_count"][...], file["contact_impulse"][...]
        assert file["contact_count"].attrs["sample_dimension"] == "contact"
    assert counts.shape == (4, 3)
    assert counts.sum() == impulses.size
    ends = np.cumsum(counts.ravel())
    for cell, (count, end) in enumerate(zip(counts.ravel(), ends, strict=True)):
        assert count == len(point(cell).contacts)
        assert (impulses[end - count : end] == cell).all()
    with h5netcdf.File(tmp_path / "curve.nc") as file:
        assert file["contact_stop"].dimensions == ("contact",)
        assert file["impulse"].dimensions == ("angular_frequency", "stops_all_gap", "stop")
        assert list(file["stop_name"][...]) == [b"P2", b"P3", b"P4", b"P5"]


def test_distinct_motions_are_counted_by_period_multiple_and_impulses() -> None:
    one = Point("PERIODIC", 1, impulses=(1.0, 0.0, 0.0, 0.0))
    near = replace(one, impulses=(1.0005, 0.0, 0.0, 0.0))
    far = replace(one, impulses=(1.1, 0.0, 0.0, 0.0))
    double = replace(one, period_multiple=2)
    wild = replace(one, outcome="APERIODIC", period_multiple=0)
    motions = [[one, near, Point()], [one, far, double], [wild, replace(wild, impulses=far.impulses), Point()]]
    motions += [[Point()] * 3]
    points = dict(enumerate(point for three in motions for point in three))
    found = sweep_dataset(plan(4, start="random", starts=3), points)
    assert found.distinct.values.tolist() == [1, 3, 1, 0]


def test_what_was_there_stays_when_the_disk_is_full(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "curve.nc"
    write_netcdf(dataset(plan()), path)

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(OutputError, match=r"curve\.nc: cannot be written: No space left on device$"):
        write_netcdf(dataset(plan(3)), path)
    assert read_curve(path).sizes["angular_frequency"] == 12
    assert [path.name for path in tmp_path.iterdir()] == ["curve.nc"]


@pytest.mark.parametrize(("version", "whose"), [(None, "an older"), (1, "an older"), (2, "an older"), (4, "a newer")])
def test_a_file_of_another_format_is_refused(version: int | None, whose: str, tmp_path: Path) -> None:
    path, found = tmp_path / "curve.nc", dataset(plan())
    assert found.attrs.pop("format_version") == 3
    if version is not None:
        found.attrs["format_version"] = version
    write_netcdf(found, path)
    with pytest.raises(InputError) as error:
        read_curve(path)
    sentence = f"is of format version {version or 1}, which {whose} lapjoint wrote; this one reads version 3 only"
    assert str(error.value) == f"{path}: {sentence}"


def test_a_damaged_file_is_refused_in_one_sentence(tmp_path: Path) -> None:
    """Every kind of damage: a flipped bit anywhere, a cut, other bytes, and zeros as a crash leaves them."""
    path, rng = tmp_path / "curve.nc", random.Random(5)
    write_netcdf(dataset(plan()), path)
    raw = path.read_bytes()
    said = set()
    for number in range(300):
        at = rng.randrange(len(raw))
        flipped = raw[:at] + bytes([raw[at] ^ 1 << rng.randrange(8)]) + raw[at + 1 :]
        zeroed = raw[:at] + bytes(len(raw[at : at + 512])) + raw[at + 512 :]
        path.write_bytes([flipped, raw[:at], zeroed + b"0", flipped[:-1]][number % 4])
        with pytest.raises(InputError) as error:
            read_curve(path)
        said.add(str(error.value).removeprefix(f"{path}: "))
    reason = "its content does not fit its checksum; what made it, with --force, computes it again"
    a_part = ("cannot be read: is not a NetCDF-4 file", "is not the result of a sweep, or only a part of it")
    older = "has no checksum, as an older lapjoint wrote it; this one reads format version 3 only"
    assert said <= {f"is damaged: {reason}", *a_part, older}
    path.write_bytes(raw)
    xr.testing.assert_identical(read_curve(path), dataset(plan()))


def test_a_title_that_looks_like_a_checksum_does_no_harm(tmp_path: Path) -> None:
    title = "sha256 of the file, with zeros for these digits: " + 64 * "0"
    this = Plan(Grid(JOINT.replace(title=title), (Axis(FREQUENCY, [1.0]),)))
    write_netcdf(dataset(this), tmp_path / "curve.nc")
    xr.testing.assert_identical(read_curve(tmp_path / "curve.nc"), dataset(this))


def changed(found: xr.Dataset, path: Path) -> None:
    """Leave out a variable of a file, as another program may."""
    write_netcdf(found, path)
    with xr.open_dataset(path, engine="h5netcdf") as raw:
        less = raw.load().drop_vars("contact_count")
    less.to_netcdf(path, engine="h5netcdf")


def older(found: xr.Dataset, path: Path) -> None:
    """Write a file as the format version before had it."""
    found.assign_attrs(format_version=2).to_netcdf(path, engine="h5netcdf")


def other(found: xr.Dataset, path: Path) -> None:
    """Write something else."""
    xr.Dataset({"a": ("x", np.zeros(2))}).to_netcdf(path, engine="h5netcdf")


@pytest.mark.parametrize(
    ("written", "message"),
    [
        (lambda found, path: None, "No such file"),
        (lambda found, path: path.write_text("text"), "is not a NetCDF-4 file"),
        (other, "is not the result of a sweep"),
        (older, r"curve\.nc: has no checksum, as an older lapjoint wrote it; this one reads"),
        (changed, r"curve\.nc: is damaged: its content does not fit its checksum"),
    ],
    ids=["nothing", "text", "another dataset", "older", "changed"],
)
def test_what_is_not_a_sweep_of_ours_is_refused(written: Any, message: str, tmp_path: Path) -> None:
    written(dataset(plan()), tmp_path / "curve.nc")
    with pytest.raises(InputError, match=message):
        read_curve(tmp_path / "curve.nc")


def test_a_curve_shows_every_stop_with_its_sign() -> None:
    found = dataset(plan())
    ax = plot_curve(found)
    named = {str(line.get_label()): line for line in ax.lines if not str(line.get_label()).startswith("_")}
    assert list(named) == ["P2", "P3", "P4", "P5", "does not repeat"]
    ours = [line for line in ax.lines if line.get_color() == named["P4"].get_color() and line.get_marker() != "o"]
    drawn = np.concatenate([np.asarray(line.get_ydata()) for line in ours])
    np.testing.assert_array_equal(drawn, found.impulse.sel(stop="P4"))
    assert ax.get_xlabel() == "angular frequency ω [rad/s]"
    assert ax.get_ylabel() == "impulse in a period [N s]"
    assert ax.figure.get_figwidth() == 3.4


def test_a_third_field_is_drawn_at_its_first_value_and_the_figure_says_so() -> None:
    axes = [Axis(FREQUENCY, [1.0, 2.0]), Axis("stops.*.gap", [1e-3, 2e-3]), Axis("damping.ratio", [0.1, 0.05])]
    this = Plan(Grid(JOINT, tuple(axes)))
    legend = plot_curve(dataset(this)).get_legend()
    assert legend is not None
    title = legend.get_title().get_text().replace("\n", " ")
    assert title == "gap (all stops) [m], paler to darker, damping ratio = 0.05"
    assert plot_curve_wide(dataset(this))[0].figure.get_suptitle() == "damping ratio = 0.05"


def test_the_strip_tells_what_was_established() -> None:
    found = certificates(dataset(plan(14)))
    names = [list(OUTCOME_COLOURS)[code] for code in found]
    expected = ["no_contact", "periodic_n", "chattering", "quasiperiodic", "aperiodic", "undecided", "no_contact"]
    assert names[:8] == [*expected, "failed"]
    assert names[13] == "periodic_n"


@pytest.mark.parametrize(
    "this",
    [
        pytest.param(plan(), id="one axis"),
        pytest.param(plan(12, 12), id="map"),
        pytest.param(plan(1), id="one point"),
        pytest.param(plan(4, 3, starts=2), id="lines and starts"),
        pytest.param(plan(12, 3), id="lines", marks=pytest.mark.thorough),
        pytest.param(plan(12, start="random", starts=4), id="starts", marks=pytest.mark.thorough),
    ],
)
def test_every_kind_of_sweep_is_drawn(this: Plan, tmp_path: Path) -> None:
    found = dataset(this)
    save(plot_curve(found), tmp_path / "curve.png")
    axes = plot_curve_wide(found)
    assert len(axes) == 5
    save(axes[0], tmp_path / "wide.png")
    assert (tmp_path / "wide.png").stat().st_size > 1000


@pytest.mark.parametrize("ending", ["svg", "pdf"])
def test_a_sweep_is_drawn_in_vectors(ending: str, tmp_path: Path) -> None:
    save(plot_curve(dataset(plan(4, 3))), tmp_path / f"curve.{ending}")
    assert (tmp_path / f"curve.{ending}").stat().st_size > 1000
