"""Damped stops and stops in space along ramps: limits, cuts, and beams that nothing holds."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.march import Joint, March, march
from analytic.march.initial_state import started
from analytic.march.tables import switch_of
from analytic.solver import Solver
from lapjoint.problem import FloatArray, Problem
from tests.helpers.damped_stops import loose_beam, sampled_joint, witnessed
from tests.helpers.random_joints import damped_cantilever

DURATION = 2.0  # s
SAMPLES = (81, 161, 321)  # of a record over this time
LEAST_ORDER = 3.5  # the spline of a displacement record has errors of the fourth order


def marched(problem: Problem, modes: int, end: float) -> tuple[Joint, March, FloatArray, list[int]]:
    """A joint, its march to `end`, s, the modal displacements there, kg^1/2 m, and what switched."""
    joint = Joint(problem, modes, modes)
    motion = march(joint, started(joint), 0.0, end, depth=True)
    q, _ = joint.in_modes(motion.end.state, motion.end.q, motion.end.v, end)
    return joint, motion, q, [switch_of(joint.tables, row) for row in motion.log.stop.tolist() if row >= 0]


@pytest.mark.parametrize("seed", [1, 5])
def test_a_record_that_samples_a_sine_approaches_its_motion(seed: int) -> None:
    sine = damped_cantilever(np.random.default_rng(seed))
    sine = sine.replace(stops=tuple(stop.model_copy(update={"fixed_to": "space"}) for stop in sine.stops))
    assert sine.base_motion is not None
    *_, exact, switches = marched(sine, 5, DURATION)
    errors = []
    for count in SAMPLES:
        t = np.linspace(0.0, DURATION, count)
        record = {"kind": "record", "quantity": "displacement", "times": t, "values": sine.base_motion.at(t)}
        *_, q, found = marched(sine.replace(base_motion=record), 5, DURATION)
        assert found == switches
        errors.append(float(np.abs(q - exact).max()))
    assert np.log2(errors[0] / errors[-1]) / (len(SAMPLES) - 1) > LEAST_ORDER


@pytest.mark.parametrize("seed", [2, 9])
def test_blocks_of_ramps_change_no_motion(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    _, whole, q, switches = marched(sampled_joint(seed), 6, 3.0)
    monkeypatch.setattr("lapjoint.problem.ramps.KNOTS", 8)
    _, cut, again, found = marched(sampled_joint(seed).replace(title="in blocks of eight knots"), 6, 3.0)
    assert cut.log.slot.size > whole.log.slot.size
    assert found == switches
    assert again == pytest.approx(q, abs=1e-12 * np.abs(q).max())  # the rounding of some ten switches
    assert cut.penetration == pytest.approx(whole.penetration, abs=1e-12 * whole.penetration.max())


def check_loose(seed: int, end: float) -> None:
    """Compare with brute force."""
    joint, motion, q, switches = marched(loose_beam(seed), 5, end)
    begin = started(joint)
    witness = witnessed(joint, begin.state, *joint.in_modes(begin.state, begin.q, begin.v, 0.0), end)
    assert tuple(switches) == witness.indices
    assert motion.log.end[motion.log.stop >= 0] == pytest.approx(witness.times, abs=1e-8)
    assert q == pytest.approx(witness.q, abs=1e-7 * np.abs(witness.q).max())


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_loose_beams_meet_damped_stops_where_brute_force_finds_it(seed: int) -> None:
    check_loose(seed, 0.8)


def test_a_shaken_joint_with_damped_stops_has_energies_of_its_stops() -> None:
    history = Solver(n_modes=6).simulate(sampled_joint(2), 1.5)
    assert history.contacts
    assert all(contact.dissipated > 0 for contact in history.contacts if not contact.open_end)
