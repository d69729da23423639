"""Deviations by amplitudes of exponentials, against the same deviations by displacements and velocities."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from damped_stops import model_of, pinned_bar
from random_joints import damped_cantilever

from fe_lapjoint.march import coupled_tangent, tangent
from fe_lapjoint.march.coupled import Coupled
from fe_lapjoint.march.initial import initial_coordinates, initial_state
from fe_lapjoint.march.march import March, march
from fe_lapjoint.march.tangent import Carried
from lapjoint import FREE, ContactState, Problem
from lapjoint.problem import FloatArray


def marched(problem: Problem, elements: int, duration: float) -> March:
    model = model_of(problem, elements)
    state = initial_state(model)
    return march(model, state, initial_coordinates(model.assembly, model.system(state)), 0.0, duration)


def plainly(motion: March, monkeypatch: pytest.MonkeyPatch) -> FloatArray:
    """All deviations at the end of a march, by displacements and velocities of all modes."""
    with monkeypatch.context() as patched:
        for module in (tangent, coupled_tangent):
            patched.setattr(module, "by_amplitudes", lambda _: False)
        patched.setattr(tangent, "DEAD", math.inf)
        return Carried(motion.model, motion, np.eye(motion.y.size)).end


def check_deviations(seed: int, monkeypatch: pytest.MonkeyPatch) -> set[tuple[bool, bool]]:
    """Compare a random march, and tell which kinds of states followed each other: whether modes are coupled."""
    motion = marched(damped_cantilever(np.random.default_rng(seed)), 3, 6.0)
    model, n = motion.model, motion.y.size // 2
    start = motion.pieces[0].state
    size = np.concatenate([model.system(start).omega, np.ones(n)])
    plain = plainly(motion, monkeypatch) / size
    apart = Carried(model, motion, np.eye(2 * n)).end / size - plain
    assert np.abs(apart).max() < 1e-9 * np.abs(plain).max(), seed
    coupled = [isinstance(model.system(piece.state), Coupled) for piece in motion.pieces if piece.switched >= 0]
    return set(itertools.pairwise(coupled))


def test_deviations_are_the_same_by_amplitudes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Among them are marches into and out of coupled states, and between two of them."""
    kinds = set().union(*(check_deviations(seed, monkeypatch) for seed in range(6)))
    assert {(False, True), (True, False), (True, True)} <= kinds


@pytest.mark.slow
def test_many_deviations_are_the_same_by_amplitudes(monkeypatch: pytest.MonkeyPatch) -> None:
    for seed in range(6, 200):
        check_deviations(seed, monkeypatch)


def test_a_state_with_rigid_body_motions_keeps_displacements(monkeypatch: pytest.MonkeyPatch) -> None:
    """A bar on a pin turns freely where its stop has let go, and bends where the stop presses."""
    motion = marched(pinned_bar(5.0, EI=1e4).replace(damping={"kind": "modal", "ratio": 0.05}), 2, 3.0)
    systems = [motion.model.system(piece.state) for piece in motion.pieces]
    assert {coupled_tangent.by_amplitudes(it) for it in systems} == {True, False}
    plain = plainly(motion, monkeypatch)
    apart = Carried(motion.model, motion, np.eye(motion.y.size)).end - plain
    assert np.abs(apart).max() < 1e-8 * np.abs(plain).max()


def test_deviations_that_are_all_dead_stay_dead() -> None:
    """After a flight of many decay times no exponential is alive, and the next switch finds nothing to map."""
    problem = damped_cantilever(np.random.default_rng(0))
    model = model_of(problem, 2)
    system = model.system(ContactState(model.damped[:1]))
    assert isinstance(system, Coupled)
    few = system.free.outlasting(1e9, tangent.DEAD)
    there = tangent._Deviations(np.eye(2 * system.omega.size), np.ones(2 * system.omega.size)).within(system)
    later, _ = there.flown(system, 1e9, 1e9)
    assert few == 0
    assert not later.within(None).columns.any()
    assert model.system(FREE).omega.size == system.omega.size
