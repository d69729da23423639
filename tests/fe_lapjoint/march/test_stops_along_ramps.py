"""Damped stops and stops in space along ramps, on a mesh: limits, cuts, energies, and the library methods."""

from __future__ import annotations

import numpy as np
import pytest
from damped_stops import model_of, sampled_joint
from random_joints import damped_cantilever

from fe_lapjoint import Solver
from fe_lapjoint.march.initial import initial_coordinates, initial_state
from fe_lapjoint.march.march import march
from lapjoint.answers.dissipation import Span, energies_lost
from lapjoint.problem import FloatArray, Problem

DURATION = 2.0  # s
SAMPLES = (81, 161, 321)  # of a record over this time
LEAST_ORDER = 3.5  # the spline of a displacement record has errors of the fourth order


def marched(problem: Problem, end: float) -> tuple[FloatArray, list[int], int]:
    """(q, q') of a joint on its mesh at `end`, s, what switched, and the number of pieces."""
    model = model_of(problem, 2)
    state = initial_state(model)
    motion = march(model, state, initial_coordinates(model.assembly, model.system(state)), 0.0, end)
    return motion.y, [it.switched for it in motion.pieces if it.switched >= 0], len(motion.pieces)


@pytest.mark.parametrize("seed", [1, 5])
def test_a_record_that_samples_a_sine_approaches_its_motion(seed: int) -> None:
    sine = damped_cantilever(np.random.default_rng(seed))
    sine = sine.replace(stops=tuple(stop.model_copy(update={"fixed_to": "space"}) for stop in sine.stops))
    assert sine.base_motion is not None
    exact, switches, _ = marched(sine, DURATION)
    errors = []
    for count in SAMPLES:
        t = np.linspace(0.0, DURATION, count)
        record = {"kind": "record", "quantity": "displacement", "times": t, "values": sine.base_motion.at(t)}
        y, found, _ = marched(sine.replace(base_motion=record), DURATION)
        assert found == switches
        errors.append(float(np.abs(y - exact)[: y.size // 2].max()))
    assert np.log2(errors[0] / errors[-1]) / (len(SAMPLES) - 1) > LEAST_ORDER


@pytest.mark.parametrize("seed", [2, 9])
def test_blocks_of_ramps_change_no_motion(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    y, switches, whole = marched(sampled_joint(seed), 3.0)
    monkeypatch.setattr("lapjoint.problem.ramps.KNOTS", 8)
    again, found, cut = marched(sampled_joint(seed).replace(title="in blocks of eight knots"), 3.0)
    assert cut > whole
    assert found == switches
    assert again == pytest.approx(y, abs=1e-9 * np.abs(y).max())  # the rounding of the fastest of coupled modes


@pytest.mark.parametrize("seed", [1, 2, 4, *(pytest.param(k, marks=pytest.mark.slow) for k in range(5, 60))])
def test_energies_of_damped_stops_are_those_of_quadrature(seed: int) -> None:
    history = Solver(elements=1).simulate(sampled_joint(seed, halves=True), 1.0, errors=False)
    for k, stop in enumerate(history.problem.stops):
        found = [it for it in history.contacts if it.stop == k]
        if stop.damping and found:
            spans = [Span(it.start, it.end, it.open_start, it.open_end) for it in found]
            assert [it.dissipated for it in found] == pytest.approx(energies_lost(history, k, spans), rel=1e-8)


def check_library(problem: Problem, method: str) -> None:
    """Compare a library method with the exact flow."""
    exact, found = (
        Solver(elements=1, method=name, rtol=1e-10, atol=1e-13).simulate(problem, 0.5, errors=False)
        for name in ("exact", method)
    )
    assert found.states == exact.states
    assert found.switch_times == pytest.approx(exact.switch_times, abs=1e-7)
    for one, other in zip(exact.contacts, found.contacts, strict=True):
        assert other.impulse == pytest.approx(one.impulse, rel=1e-5, abs=1e-8)
        assert other.peak_force == pytest.approx(one.peak_force, rel=1e-5, abs=1e-8)
        assert other.dissipated == pytest.approx(one.dissipated, rel=1e-5, abs=1e-9)


@pytest.mark.parametrize(
    "seed", [2, *(pytest.param(k, marks=pytest.mark.slow) for k in (0, 1, *range(3, 30)))], ids="joint-{}".format
)
def test_a_library_method_meets_damped_stops_as_the_exact_flow(seed: int) -> None:
    check_library(damped_cantilever(np.random.default_rng(seed), halves=True), "DOP853")


@pytest.mark.thorough
@pytest.mark.parametrize("method", ["DOP853", "LSODA", pytest.param("Radau", marks=pytest.mark.slow)])
def test_each_library_method_does_along_ramps(method: str) -> None:
    check_library(sampled_joint(0, halves=True), method)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1, 12))
def test_library_methods_do_on_many_joints_along_ramps(seed: int) -> None:
    check_library(sampled_joint(seed, halves=True), "DOP853")
