"""Derivatives of the period map by numbers of the problem, against closed forms of a motion without contact."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import FREE, paper_joint
from lapjoint.orbits import PeriodMap
from lapjoint.orbits.parameters import derivative_by_field
from lapjoint.problem import FloatArray

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


def test_a_map_that_knows_its_derivatives_is_asked() -> None:
    at = maps("analytic")("base_amplitude")

    class Knows:
        """A map with a derivative of its own."""

        def __init__(self, inner: PeriodMap) -> None:
            self.inner = inner

        def __getattr__(self, name: str) -> object:
            return getattr(self.inner, name)

        def derivative_by(self, field: str, start: object, half_periods: int) -> FloatArray:
            return np.array([float(half_periods)])

    known = derivative_by_field(lambda value: Knows(at(value)), "base_amplitude", AMPLITUDE, at(AMPLITUDE).initial(), 2)  # type: ignore[arg-type, return-value]
    assert known.tolist() == [2.0]
