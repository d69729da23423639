"""Summaries of steady states: closed forms, both solvers within their errors, and as variables of a sweep."""

from __future__ import annotations

import math
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from beams import unit_cantilever
from command_line import PAPER, assert_refused, run
from population import joint as joint_of
from settled import amplification
from toy import bar

import analytic
import fe_lapjoint
from lapjoint import (
    FREQUENCY,
    Axis,
    BaseMotion,
    Beam,
    InputError,
    Mass,
    Outcome,
    Problem,
    SteadyState,
    Stop,
    paper_joint,
    sweep,
)
from lapjoint.campaigns.sweep.table import read_curve
from lapjoint.summaries import summarise
from lapjoint.summaries.of_orbit import OF_STOPS

RIGID = Beam(length=1.0, bending_stiffness=1e9, mass_per_length=1.0)
OMEGA, AMPLITUDE, RATIO = 0.9, 1e-3, 0.05  # rad/s, m, 1
SPRUNG = bar(OMEGA, (1.0, 1e4), ratio=RATIO, amplitude=AMPLITUDE, viscous=False).replace(beam=RIGID)
"""A mass of 1 kg on springs of 1 N/m, whose stop is out of reach."""


@pytest.fixture(scope="module")
def joint() -> SteadyState:
    return analytic.Solver(n_modes=10).steady_state(paper_joint(angular_frequency=820.0))


def test_a_mass_on_springs_has_the_amplitude_of_its_closed_form() -> None:
    size = AMPLITUDE * abs(amplification(OMEGA, RATIO))
    summary = summarise(analytic.Solver(n_modes=3).steady_state(SPRUNG))
    assert summary.errors is not None
    for name, order in (("displacement", 0), ("velocity", 1)):
        for what, share in (("peak", 1.0), ("rms", math.sqrt(0.5))):
            found, error = summary.values[f"{name}_{what}"], summary.errors[f"{name}_{what}"]
            assert found == pytest.approx(share * size * OMEGA**order, rel=1e-5)
            assert error.max() < 1e-4 * found.max()
    assert [float(summary.values[name][0]) for name in OF_STOPS] == [0.0] * len(OF_STOPS)
    assert [float(summary.errors[name][0]) for name in OF_STOPS] == [0.0] * len(OF_STOPS)


def test_peaks_and_means_are_those_of_a_dense_series(joint: SteadyState) -> None:
    summary, history = summarise(joint), joint.history
    t = np.linspace(history.start, history.end, 40001)
    x = summary.selection.x
    for name, values in (("displacement", history.displacement(x, t)), ("moment", history.moment(x, t))):
        size = np.abs(values).max()
        assert summary.values[f"{name}_peak"] == pytest.approx(np.abs(values).max(axis=1), abs=1e-4 * size)
        rms = np.sqrt((values[:, :-1] ** 2).mean(axis=1))
        assert summary.values[f"{name}_rms"] == pytest.approx(rms, abs=1e-5 * size)
    share = [sum(c.duration for c in history.contacts if c.stop == k) for k in range(4)]
    assert summary.values["contact_time"] == pytest.approx(np.array(share) / (history.end - history.start))
    force = np.sqrt((history.contact_force(t[:-1]) ** 2).mean(axis=1))
    assert summary.values["force_rms"] == pytest.approx(force, rel=1e-3)


def test_without_errors_there_are_none(joint: SteadyState) -> None:
    assert summarise(analytic.Solver(n_modes=3).steady_state(SPRUNG, errors=False)).errors is None
    with pytest.raises(InputError, match="lies outside the beam"):
        summarise(joint, at=[3.0])


@pytest.mark.thorough
def test_means_of_chaos_have_standard_errors_and_peaks_have_none() -> None:
    problem = bar(2.7, (0.0, 300.0), ratio=0.001, amplitude=AMPLITUDE, viscous=False).replace(beam=RIGID)
    found = analytic.Solver(n_modes=2, max_periods=300).steady_state(problem)
    assert found.outcome in (Outcome.APERIODIC, Outcome.UNDECIDED)
    summary = summarise(found, quantities=["displacement"])
    assert summary.errors is not None
    assert np.isinf(summary.errors["displacement_peak"]).all()
    error, value = summary.errors["displacement_rms"], summary.values["displacement_rms"]
    assert (0 < error).all()
    assert (error < value).all()
    assert found.march_on is not None
    assert pickle.loads(pickle.dumps(replace(found, comparison=None))).march_on is None


def test_a_sweep_keeps_what_is_named(tmp_path: Path) -> None:
    names = ["displacement_peak", "force_rms", "contact_time"]
    axes = [Axis(FREQUENCY, [500.0, 820.0])]
    found = sweep(paper_joint(), axes, options={"n_modes": 6}, errors=True, summary=names, out=tmp_path / "curve.nc")
    alone = summarise(analytic.Solver(n_modes=6).steady_state(paper_joint(angular_frequency=820.0)))
    assert alone.errors is not None
    i = int(alone.values["displacement_peak"].argmax())
    assert float(found.displacement_peak[1]) == alone.values["displacement_peak"][i]
    assert float(found.displacement_peak_error[1]) == alone.errors["displacement_peak"][i]
    assert float(found.displacement_peak_x[1]) == alone.selection.x[i]
    assert found.force_rms[1].values.tolist() == alone.values["force_rms"].tolist()
    assert found.contact_time_error[1].values.tolist() == alone.errors["contact_time"].tolist()
    assert found.force_rms.attrs["units"] == "N"
    assert read_curve(tmp_path / "curve.nc").identical(found)


def test_unknown_names_are_refused(tmp_path: Path) -> None:
    command = ("sweep", PAPER, "--from", "500", "--to", "501", "--out", tmp_path / "curve.nc")
    refused = run(*command, "--summary", "weight_peak")
    assert_refused(refused, "summary 'weight_peak': is unknown; allowed: displacement_peak")
    with pytest.raises(InputError, match="summary of the stress: the beam has no section"):
        sweep(SPRUNG, [Axis(FREQUENCY, [30.0])], summary=["stress_rms"])


@pytest.mark.parametrize("index", range(6))
def test_what_is_nothing_but_rounding_is_zero(index: int) -> None:
    """Moments at free ends, displacements at fixed ones: exactly, in means and peaks, and their errors with them."""
    problem = joint_of(7, index)
    found = analytic.Solver(n_modes=8, max_periods=64).steady_state(problem)
    summary = summarise(found, quantities=["displacement", "moment"])
    assert summary.errors is not None
    fixed = [s.x for s in problem.supports if s.translational == math.inf]
    free = {0.0, 1.0} - {s.x for s in problem.supports if s.torsional}
    for name, places in (("displacement", fixed), ("moment", free)):
        for what in ("peak", "rms"):
            values, errors = summary.values[f"{name}_{what}"], summary.errors[f"{name}_{what}"]
            here = np.isin(summary.selection.x, list(places))
            assert values[here].tolist() == [0.0] * int(here.sum())
            assert (values[~here] > 1e-6 * values.max()).all()
            assert found.period_multiple == 0 or errors[here].tolist() == [0.0] * int(here.sum())


def struck(mass: float) -> Problem:
    """A cantilever that strikes a pad with a damper at its tip, with a mass there or without."""
    pad = Stop(name="pad", x=1.0, side="top", gap=1e-3, stiffness=30.0, damping=1.0)
    masses = (Mass(name="m", x=1.0, mass=mass),) if mass else ()
    motion = BaseMotion(amplitude=5e-4, angular_frequency=3.2)
    return unit_cantilever(pad).replace(masses=masses, base_motion=motion)


def accelerations(mass: float, n_modes: int, errors: bool = False) -> tuple[float, float]:
    """Peak of the acceleration of the tip, m/s2, and its error."""
    found = analytic.Solver(n_modes=n_modes).steady_state(struck(mass), errors=errors)
    value, error = summarise(found, at=[1.0]).value("absolute_acceleration_peak")
    return float(value[-1]), float(error[-1])


def test_no_error_is_stated_of_an_acceleration_that_has_no_limit() -> None:
    """The force of a damped stop begins with a jump: the acceleration of a beam alone grows with each mode."""
    coarse, unknown = accelerations(0.0, 10, errors=True)
    assert unknown == math.inf
    fine, finest = accelerations(0.0, 20)[0], accelerations(0.0, 40)[0]
    assert fine > 1.5 * coarse
    assert finest > 1.5 * fine
    found = summarise(fe_lapjoint.Solver(elements=8).steady_state(struck(0.0)))
    for name in ("absolute_acceleration_peak", "absolute_acceleration_rms"):
        assert (found.value(name)[1] == math.inf).all()
    assert (found.value("velocity_rms")[1] < math.inf).all()


def test_a_mass_takes_the_jump_of_a_damped_stop() -> None:
    coarse, error = accelerations(0.3, 10, errors=True)
    assert abs(accelerations(0.3, 40)[0] - coarse) <= error < 0.1 * coarse
