"""The peak force of a contact is its highest point, not the highest of samples."""

from __future__ import annotations

import numpy as np
import pytest
from beams import CLAMP, UNIT

import fe_lapjoint
from fe_lapjoint.march.peaks import deepest
from lapjoint import BaseMotion, History, ModalDamping, Problem, Stop, paper_joint
from lapjoint.answers import Contact
from lapjoint.problem import FloatArray


def sampled_peak(history: History, contact: Contact) -> float:
    """The largest force by 20 000 samples, and 200 more around each of the highest of them, twice."""
    stop = history.problem.stops[contact.stop]

    def force(t: FloatArray) -> FloatArray:
        return stop.stiffness * (stop.sign * history.displacement(stop.x, t)[0] - stop.gap)

    t = np.linspace(contact.start, np.nextafter(contact.end, contact.start), 20_000)
    f = force(t)
    step, around = t[1] - t[0], t[np.argsort(f)[-5:]]
    for _ in range(2):
        finer = np.clip((around[:, None] + step * np.linspace(-1, 1, 201)).ravel(), t[0], t[-1])
        g = force(finer)
        step, around = step / 100, finer[np.argsort(g)[-5:]]
        f = np.append(f, g)
    return float(f.max())


def random_problem(rng: np.random.Generator) -> Problem:
    stops = tuple(
        Stop(x=rng.uniform(0.3, 1.0), side=side, gap=10 ** rng.uniform(-6, -3), stiffness=10 ** rng.uniform(1, 7))
        for side in rng.choice(["top", "bottom"], size=rng.integers(1, 4))
    )
    return Problem(
        beam=UNIT,
        supports=(CLAMP,),
        stops=stops,
        damping=ModalDamping(ratio=float(rng.choice([0.0, 0.01, 0.3, 1.0, 3.0]))),
        base_motion=BaseMotion(amplitude=2e-3, angular_frequency=rng.uniform(2, 40)),
    )


def test_peak_forces_are_those_of_dense_sampling() -> None:
    rng, seen = np.random.default_rng(5), 0
    for _ in range(6):
        history = fe_lapjoint.Solver(elements=10).simulate(random_problem(rng), 1.0)
        for contact in history.contacts[:4]:
            sampled = sampled_peak(history, contact)
            # Rounding of z, 1e-14 of its terms, weighs on a shallow penetration by a stiff spring.
            noise = history.problem.stops[contact.stop].stiffness * 1e-14 * 0.1
            assert contact.peak_force == pytest.approx(sampled, rel=1e-9, abs=noise)
            seen += 1
    assert seen


def test_a_contact_cut_by_a_section_has_the_peak_of_both_parts() -> None:
    joint = paper_joint(angular_frequency=820.0)
    solver = fe_lapjoint.Solver(elements=8)
    history = solver.period_map(joint).history(solver.steady_state(joint).section_point, 3)
    for contact in history.contacts:
        assert contact.peak_force == pytest.approx(sampled_peak(history, contact), rel=1e-9)


class Spike:
    """Minus a penetration that is 1 nearly everywhere, and 1 + height within a width of a place."""

    def __init__(self, place: float, width: float, height: float) -> None:
        self.place, self.width, self.height = place, width, height

    def __call__(self, t: FloatArray) -> FloatArray:
        return -(1 + self.height * np.exp(-(((t - self.place) / self.width) ** 2)))[None, :]

    def at(self, k: int, t: float) -> tuple[float, float]:
        raise NotImplementedError

    def from_chord(self, t: FloatArray, width: float) -> FloatArray:
        return np.full((1, t.size), min(self.height, self.height * 2 / self.width**2 * width**2 / 8))

    def ceiling(self, k: int, t: FloatArray, width: float, ends: FloatArray, side: float = 1.0) -> FloatArray:
        return np.asarray((side * ends).max(axis=0) + self.from_chord(t, width)[k])

    def from_tangent(self, k: int, t: float, width: float) -> tuple[float, float]:
        raise NotImplementedError


@pytest.mark.parametrize("place", [0.0, 0.123456789, 0.5, 0.987654321, 1.0])
def test_no_peak_is_too_narrow_to_be_found(place: float) -> None:
    assert deepest(Spike(place, 1e-3, 0.7), 0, 0.0, 1.0, 0.0) == pytest.approx(1.7, rel=1e-11)
