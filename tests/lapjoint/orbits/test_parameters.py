"""Derivatives of the period map by numbers of the problem, against closed forms of a motion without contact."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import FREE, Axis, paper_joint
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.campaigns.grid import Grid
from lapjoint.orbits import Linearised, PeriodMap, Segment
from lapjoint.orbits.parameters import AMPLITUDE as AMPLITUDE_FIELD
from lapjoint.orbits.parameters import FREQUENCY, FieldDerivatives, derivative_by_field
from lapjoint.orbits.period_map import Derivative
from lapjoint.problem import FloatArray, SineLoad

OMEGA, AMPLITUDE, RATIO = 100.0, 1e-5, 0.05  # so small an amplitude touches no stop
SOLVERS = {"analytic": analytic.Solver(n_modes=6), "FE": fe_lapjoint.Solver(elements=4)}


def maps(solver: str, **fixed: float) -> Callable[[str], Callable[[float], PeriodMap]]:
    values = {"angular_frequency": OMEGA, "base_amplitude": AMPLITUDE, "damping_ratio": RATIO} | fixed

    def of(name: str) -> Callable[[float], PeriodMap]:
        return lambda value: SOLVERS[solver].period_map(paper_joint(**(values | {name: value})))

    return of


def from_rest(solver: str, amplitude: float, omega: float) -> FloatArray:
    """(q, v) after one period from rest, mode by mode, in closed form."""
    problem = paper_joint(angular_frequency=OMEGA)
    count = 6 if solver == "analytic" else 8
    modes = SOLVERS[solver].modes(problem, FREE, count)
    w, a = modes.angular_frequencies, RATIO * modes.angular_frequencies
    x = np.linspace(0.0, problem.beam.length, 20001)
    load = problem.beam.m * amplitude * omega**2 * np.trapezoid(modes.shapes(x), x, axis=1)
    wave = load / (w**2 - omega**2 + 2j * a * omega)
    q0, v0 = -wave.imag, -(1j * omega * wave).imag
    T, b = 2 * np.pi / omega, np.sqrt(w**2 - a**2)
    C, S = np.exp(-a * T) * (np.cos(b * T) + a * np.sin(b * T) / b), np.exp(-a * T) * np.sin(b * T) / b
    q = wave.imag + C * q0 + S * v0
    v = (1j * omega * wave).imag + (C - 2 * a * S) * v0 - w**2 * S * q0
    return np.concatenate([q, v])


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("field", ["base_amplitude", "angular_frequency"])
def test_derivatives_are_those_of_the_closed_form(solver: str, field: str) -> None:
    value = {"base_amplitude": AMPLITUDE, "angular_frequency": OMEGA}[field]
    at = maps(solver)(field)
    found = derivative_by_field(at, field, value, at(value).initial(), 2)
    step = 1e-4 * value
    ends = [
        from_rest(solver, AMPLITUDE + sign * step, OMEGA)
        if field == "base_amplitude"
        else from_rest(solver, AMPLITUDE, OMEGA + sign * step)
        for sign in (1, -1)
    ]
    expected = (ends[0] - ends[1]) / (2 * step)
    # The closed form is differenced over 1e-4 of the value; its integrals are by the trapezoidal rule, to 1e-8.
    assert np.abs(found) == pytest.approx(np.abs(expected), rel=1e-4, abs=1e-5 * np.abs(expected).max())


FIELDS = {"frequency": FREQUENCY, "amplitude": AMPLITUDE_FIELD}


def family_at(solver: str, field: str) -> tuple[float, Callable[[float], PeriodMap]]:
    """A value of a number of a joint in contact, and its period maps, and a load at a point, too."""
    problem = paper_joint(angular_frequency=300.0, damping_ratio=RATIO).replace(
        point_loads=(SineLoad(x=1.1, force=300.0, angular_frequency=300.0, phase=0.4),)
    )
    value = 300.0 if field == FREQUENCY else problem.base_motion.amplitude  # type: ignore[union-attr]
    grid = Grid(problem, (Axis(field, (value,)),))
    return value, lambda number: SOLVERS[solver].period_map(grid.with_values((number,)))


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize("half_periods", [1, 2, 3])
def test_closed_forms_are_the_limit_of_differences_through_contacts(solver: str, field: str, half_periods: int) -> None:
    path = FIELDS[field]
    value, at = family_at(solver, path)
    here = at(value)
    assert isinstance(here, FieldDerivatives)
    start = here.march(here.initial(), 6).end
    found = here.linearised_by(path, start, half_periods)
    assert found is not None
    assert found.by_number is not None
    assert sum(one.switched >= 0 for one in found.segments) >= 2 * half_periods
    plain = here.linearised(start, half_periods)  # type: ignore[attr-defined]
    assert found.matrix == pytest.approx(plain.matrix, rel=1e-12, abs=1e-12 * np.abs(plain.matrix).max())
    step, beside = 1e-6 * value, []
    for sign in (1, -1):
        map_ = at(value + sign * step)
        beside.append(map_.linearised(map_.adopted(start), half_periods))  # type: ignore[attr-defined]
    ends = [here.difference(here.adopted(one.end), plain.end) for one in beside]
    if plain.end.state == start.state:
        expected = (ends[0] - ends[1]) / (2 * step)
        parts = np.split(np.abs(found.by_number - expected) / np.abs(expected).max(), 2)
        # Differences over 1e-6 of the value keep ten digits of the motion; q and v have sizes of their own.
        assert max(part.max() for part in parts) < 1e-6
    for i, one in enumerate(found.segments):
        t = (one.start + one.end) / 2
        rows = [displacements(other.segments[i], t) for other in beside]
        slope = (rows[0] - rows[1]) / (2 * step)
        assert one.change is not None
        assert slope_of(one, t) == pytest.approx(slope, rel=1e-5, abs=1e-5 * np.abs(slope).max())


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_segment_that_is_asked_for_alone_is_that_of_all(solver: str) -> None:
    """Its deviations are kept there alone; the derivative of the end is then known without carrying them again."""
    value, at = family_at(solver, FREQUENCY)
    here = at(value)
    assert isinstance(here, FieldDerivatives)
    start = here.march(here.initial(), 6).end
    alone, whole = (here.linearised_by(FREQUENCY, start, 3) for _ in range(2))
    assert alone is not None
    assert whole is not None
    for i, one in enumerate(whole.segments):
        other = alone.segment(i)
        assert (other.start, other.end, other.switched) == (one.start, one.end, one.switched)
        assert one.change is not None
        assert other.change is not None
        for name in ("closed", "rates", "weights", "amplitudes", "polynomial", "deviations", "drift"):
            np.testing.assert_array_equal(getattr(other, name), getattr(one, name))
        for mine, its in zip(other.change, one.change, strict=True):
            np.testing.assert_array_equal(mine, its)
    np.testing.assert_array_equal(alone.matrix, whole.matrix)


def displacements(one: Segment, t: float) -> FloatArray:
    tau = t - one.start
    waves = one.weights * one.amplitudes * np.exp(one.rates * tau)
    return np.asarray(waves.sum(axis=1).real + one.polynomial @ np.array([1.0, tau, tau**2]))


def slope_of(one: Segment, t: float) -> FloatArray:
    tau, change = t - one.start, one.change
    assert change is not None
    waves = (change.waves + change.secular * tau) * np.exp(one.rates * tau)
    return np.asarray(waves.sum(axis=1).real + change.polynomial @ np.array([1.0, tau, tau**2]))


def test_a_map_that_knows_its_derivatives_is_asked() -> None:
    at = maps("analytic")("base_amplitude")

    class Knows:
        """A map with a derivative of its own."""

        def __init__(self, inner: PeriodMap) -> None:
            self.inner = inner

        def __getattr__(self, name: str) -> object:
            return getattr(self.inner, name)

        def linearised_by(self, field: str, start: SectionPoint, half_periods: int) -> Linearised:
            return Linearised(start, lambda: Derivative(np.eye(1), np.array([float(half_periods)])), tuple)

    known = derivative_by_field(lambda value: Knows(at(value)), "base_amplitude", AMPLITUDE, at(AMPLITUDE).initial(), 2)  # type: ignore[arg-type, return-value]
    assert known.tolist() == [2.0]
