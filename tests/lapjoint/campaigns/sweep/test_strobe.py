"""Stroboscopic samples of a sweep: a motion of p periods has p different ones, and each is the motion's own state."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import brentq
from small_joints import SHAKEN, cantilever

from lapjoint import FREQUENCY, Axis, BaseMotion, InputError, Problem, Stop, sweep
from lapjoint.campaigns.grid import Grid
from lapjoint.campaigns.journal import journal_path
from lapjoint.campaigns.sweep.job import SweepJob
from lapjoint.campaigns.sweep.spec import Plan
from lapjoint.errors import Interrupted
from lapjoint.problem.presets import lap_joint
from lapjoint.solver import Solver, make_solver

N = 12
JOINT = cantilever(base_motion=BaseMotion(amplitude=1e-3, angular_frequency=5.0))
AXES = (Axis(FREQUENCY, (5.0, 8.5, 8.0)),)
"""The motion has one period, two, and is chaotic, or of a long period, near 8 rad/s."""
FEW = {"n_modes": 2}
OTHER = {"elements": 4}


def swept(problem: Problem = JOINT, axes: tuple[Axis, ...] = AXES, **given: Any) -> xr.Dataset:
    return sweep(problem, axes, **({"options": FEW, "strobe": N} | given))


@pytest.fixture(scope="module")
def found() -> xr.Dataset:
    return swept()


def solved(solver: Solver, omega: float, **given: Any) -> Any:
    """The steady state of the joint at another frequency, without a sweep."""
    motion = BaseMotion(amplitude=1e-3, angular_frequency=omega)
    return solver.steady_state(JOINT.replace(base_motion=motion), **given)


def test_there_are_as_many_different_samples_as_periods(found: xr.Dataset) -> None:
    assert found.strobe_displacement.dims == ("angular_frequency", "strobe")
    assert found.strobe_displacement.units == "m"
    assert found.strobe_velocity.units == "m s-1"
    assert found.period_multiple.values[:2].tolist() == [1, 2]
    for name in ("strobe_displacement", "strobe_velocity"):
        assert [np.unique(row).size for row in found[name].values[:2]] == [1, 2]
        np.testing.assert_array_equal(found[name][1, 2:], found[name][1, :-2])  # the second period follows the first


@pytest.mark.parametrize(("name", "options", "values"), [("analytic", FEW, (5.0, 8.5, 8.0)), ("fe", OTHER, (5.0, 8.5))])
def test_samples_are_the_states_of_the_motion(name: str, options: dict[str, Any], values: tuple[float, ...]) -> None:
    curve, solver = (
        swept(axes=(Axis(FREQUENCY, values),), solver=name, options=options, at=0.7),
        make_solver(name, **options),
    )
    assert curve.strobe_displacement.attrs["place"] == "x = 0.7"
    for i, omega in enumerate(values):
        motion, T = solved(solver, omega, errors=False, sensitivity=False), 2 * math.pi / omega
        assert motion.period_multiple == curve.period_multiple[i]
        multiple = motion.period_multiple
        history = motion.history if multiple else motion.march_on(N)
        for k in range(N):
            t = history.start + (k % multiple if multiple else k) * T
            assert curve.strobe_displacement[i, k] == pytest.approx(history.displacement(0.7, t).item(), rel=1e-9)
            assert curve.strobe_velocity[i, k] == pytest.approx(history.velocity(0.7, t).item(), rel=1e-9)


def test_without_contact_the_samples_are_those_of_a_linear_beam() -> None:
    """The sum over the modes of a cantilever far from its stop: a closed form that has no march in it."""
    far = JOINT.replace(stops=(Stop(x=1.0, side="top", gap=1.0, stiffness=50.0),))
    curve = swept(far, options={"n_modes": 8})
    near = [(n - 0.5) * math.pi for n in range(1, 13)]
    roots = [brentq(lambda b: math.cos(b) + 1 / math.cosh(b), b - 0.5, b + 0.5) for b in near]
    for omega, z, v in zip(AXES[0].values, curve.strobe_displacement[:, 0], curve.strobe_velocity[:, 0], strict=True):
        # q'' + c q' + beta^4 q = -y'' share of each mode, with y = A sin(omega t)
        tip = 0j
        for n, beta in enumerate(roots):
            sigma = (math.cosh(beta) + math.cos(beta)) / (math.sinh(beta) + math.sin(beta))
            tip += (-1) ** n * 4 * sigma / beta * 1e-3 * omega**2 / (beta**4 - omega**2 + 0.8j * omega)
        assert z.item() == pytest.approx(tip.imag, rel=1e-4)
        assert v.item() == pytest.approx((1j * omega * tip).imag, rel=1e-4)


def test_errors_bound_what_a_finer_solver_says() -> None:
    rough, fine = (swept(axes=(Axis(FREQUENCY, (5.0, 8.5)),), options={"n_modes": n}, errors=True) for n in (4, 16))
    for name in ("strobe_displacement", "strobe_velocity"):
        error = rough[f"{name}_error"]
        assert error.dims == rough[name].dims
        assert np.isfinite(error).all()
        assert (error > 0).all()
        apart = min(
            (abs(rough[name] - fine[name].roll(strobe=k)) / error).max().item() for k in range(2)
        )  # either period of the second motion may be the first
        assert apart <= 1
        assert (error < 0.1 * np.abs(rough[name]).max()).all()


def test_no_error_is_stated_where_the_motion_does_not_repeat() -> None:
    curve = swept(errors=True, options={"n_modes": 2, "max_periods": 400})
    wanders = curve.isel(angular_frequency=2)
    assert np.isfinite(wanders.strobe_displacement).all()
    if not wanders.period_multiple:
        assert np.isinf(wanders.strobe_displacement_error).all()


def test_a_motion_that_was_not_marched_so_far_is_followed_by_nan(monkeypatch: pytest.MonkeyPatch) -> None:
    from dataclasses import replace

    from lapjoint.campaigns.point import point_of
    from lapjoint.campaigns.sweep.strobe import strobe_variables, strobed

    motion = replace(solved(make_solver("analytic", **FEW), 8.5), period_multiple=0)
    point = replace(point_of(motion), strobe=strobed(motion, N, 1.0))
    plan = Plan(Grid(JOINT, (Axis(FREQUENCY, (8.5,)),)), strobe=N)
    _, values, _ = strobe_variables(plan, [point], ("angular_frequency",))["strobe_displacement"]
    assert np.isfinite(values[0, :2]).all()
    assert np.isnan(values[0, 2:]).all()


def test_an_interrupted_sweep_resumes_to_the_same_file(
    found: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, answered = tmp_path / "strobe.nc", SweepJob.answer

    def once(job: SweepJob, cell: int, *given: Any) -> Any:
        if cell == 2:
            raise KeyboardInterrupt
        return answered(job, cell, *given)

    monkeypatch.setattr("lapjoint.campaigns.batch.BATCH_SECONDS", 0.0)
    with monkeypatch.context() as patch:
        patch.setattr(SweepJob, "answer", once)
        with pytest.raises(Interrupted, match="2 of 3 points are kept"):
            swept(out=out)
    for other, name in (({"strobe": N + 1}, "strobe"), ({"at": 0.5}, "at"), ({"strobe": 0}, "strobe")):
        with pytest.raises(InputError, match=rf"differs in .*{name}"):
            swept(out=out, **other)
    assert swept(out=out).identical(found)
    assert not journal_path(out).exists()


def test_a_sweep_without_samples_is_what_it_was(found: xr.Dataset) -> None:
    plain = swept(strobe=0)
    assert not {"strobe", "strobe_displacement"} & set(plain.variables)
    assert "strobe" not in Plan(Grid(JOINT, AXES)).identity
    shared = found.drop_vars(["strobe", "strobe_displacement", "strobe_velocity"]).drop_attrs()
    xr.testing.assert_identical(shared, plain.drop_attrs())


def test_the_place_is_the_outermost_stop_or_the_tip_or_on_a_beam() -> None:
    inner = JOINT.replace(stops=(Stop(x=0.4, side="top", gap=1e-3, stiffness=50.0),))
    assert Plan(Grid(inner, AXES), strobe=N).at == 0.4
    assert Plan(Grid(JOINT.replace(stops=()), AXES), strobe=N).at == 1.0
    assert Plan(Grid(JOINT, AXES), strobe=N, at=0.25).at == 0.25
    lap = lap_joint()
    for at in (None, "upper:0.1"):
        this = Plan(Grid(lap, AXES), strobe=N, at=at)
        assert lap.position(this.at or 0.0) == pytest.approx(lap.one_position(at), rel=1e-12)
        assert isinstance(this.at, str)
        json.dumps(this.identity)


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "a negative number": ({"strobe": -1}, r"strobe = -1: "),
    "no whole number": ({"strobe": 1.5}, r"strobe = 1\.5: "),
    "too many": ({"strobe": 10_001}, r"strobe = 10001: "),
    "too many in all": (
        {"strobe": 10_000, "axes": (Axis(FREQUENCY, range(1, 1500)),)},
        r"strobe = 10000: 1499 points have 14990000 samples; at most 10000000 are allowed",
    ),
    "a place without samples": ({"strobe": 0, "at": 0.5}, r"at = 0\.5: is the place of samples; give their number"),
    "a place off the beam": ({"at": 1.5}, r"x = 1\.5: lies outside the beam"),
    "a place on no beam": ({"at": "upper:0.5"}, r'x = "upper:0\.5": there is one beam, without a name'),
    "a beam that is too short at a point": (
        {"at": 1.0, "problem": JOINT.replace(stops=()), "axes": (Axis("beam.length", (1.0, 0.5)),)},
        r"beam\.length = 0\.5: x = 1: lies outside the beam",
    ),
    "random motion": (
        {"problem": SHAKEN, "axes": (Axis("damping.ratio", (0.1, 0.2)),)},
        r"damping\.ratio = 0\.1: .* is random, and has no period",
    ),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_not_allowed_is_told_before_any_work(what: str, monkeypatch: pytest.MonkeyPatch) -> None:
    given, message = REFUSED[what]
    monkeypatch.setattr(SweepJob, "answer", None)
    with pytest.raises(InputError, match=message):
        swept(**given)
