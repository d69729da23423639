"""The search for switches: no contact that rounding makes, no unit of time or length of its own, and no crawling."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest
from beams import CLAMP, UNIT

import fe_lapjoint
from fe_lapjoint.march.gaps import FlowGaps
from fe_lapjoint.march.propagator import Flow
from fe_lapjoint.march.system import build_system
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.mesh import mesh_nodes
from lapjoint import (
    FREE,
    BaseMotion,
    History,
    ModalDamping,
    NoDamping,
    Problem,
    StepLoad,
    Stop,
    Support,
    ViscousDamping,
    paper_joint,
)
from lapjoint.problem import Damping, FloatArray

OMEGA = 8.0


def shaken(*stops: Stop, phase: float = 0.0, damping: Damping | None = None) -> Problem:
    return Problem(
        beam=UNIT,
        supports=(CLAMP,),
        stops=stops,
        damping=ModalDamping(ratio=0.02) if damping is None else damping,
        base_motion=BaseMotion(amplitude=1e-3, angular_frequency=OMEGA, phase=phase),
    )


def tip(gap: float, side: str = "top") -> Stop:
    return Stop(x=1.0, side=side, gap=gap, stiffness=1000.0)


def simulated(problem: Problem, periods: float, elements: int = 12) -> History:
    return fe_lapjoint.Solver(elements=elements).simulate(problem, periods * 2 * math.pi / OMEGA)


@pytest.mark.parametrize("phase", [0.0, *(pytest.param(it, marks=pytest.mark.thorough) for it in (1.0, 2.0, 4.0))])
@pytest.mark.parametrize("ratio", [0.0, 0.02, 0.1, pytest.param(2.0, marks=pytest.mark.thorough)])
def test_rounding_makes_no_contact_on_a_gap_of_zero(phase: float, ratio: float) -> None:
    for stops in ((tip(0.0),), (tip(0.0), tip(0.0, "bottom"))):
        contacts = simulated(shaken(*stops, phase=phase, damping=ModalDamping(ratio=ratio)), 4).contacts
        assert len(contacts)
        shortest = min(c.duration for c in contacts if not c.open_end)
        assert shortest > 1e-3 * 2 * math.pi / OMEGA, "half a contact oscillation on k = 1000 lasts 0.05"
        assert all(c.impulse for c in contacts if not c.open_end)


@pytest.mark.parametrize("x", [0.0, 1.0, 0.5])
def test_a_stop_without_gap_on_a_fixed_point_never_switches(x: float) -> None:
    stop = Stop(x=x, side="top", gap=0.0, stiffness=1000.0)
    problem = shaken(stop, stop.model_copy(update={"side": "bottom"}))
    problem = problem.replace(
        supports=(CLAMP, Support(x=1.0, translational=math.inf), Support(x=0.5, translational=math.inf))
    )
    assert simulated(problem, 5).switch_times.size == 0


def counted_evaluations(monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """How often a gap function is asked for at one time, from now on: by the search in Python, which is the same."""
    monkeypatch.setattr(FlowGaps, "flow_terms", None)
    asked: Counter[str] = Counter()
    plain = FlowGaps.at

    def counted(self: FlowGaps, k: int, t: float) -> tuple[float, float]:
        asked["at"] += 1
        return plain(self, k, t)

    monkeypatch.setattr(FlowGaps, "at", counted)
    return asked


@pytest.mark.parametrize("seed", range(6))
def test_the_compiled_search_is_that_in_python(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(seed)
    stops = (tip(1e-3 * rng.uniform(0, 2)), tip(1e-3 * rng.uniform(0, 2), "bottom"))
    damping = ModalDamping(ratio=(0.01, rng.uniform(0.01, 0.5), 0.02))
    problem = shaken(*stops, damping=damping, phase=rng.uniform(0, 6))
    problem = problem.replace(supports=(*problem.supports, Support(x=0.5, translational=10.0 ** rng.uniform(0, 4))))
    compiled = simulated(problem, 8).contacts
    monkeypatch.setattr(FlowGaps, "flow_terms", None)
    assert len(compiled)
    assert simulated(problem, 8).contacts == compiled


def test_what_the_grid_tells_is_not_asked_for_again(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = counted_evaluations(monkeypatch)
    history = fe_lapjoint.Solver().simulate(paper_joint(angular_frequency=515.0), 6 * 2 * math.pi / 515, errors=False)
    switches = history.switch_times.size
    assert switches
    assert asked["at"] < 4 * switches  # Newton's method from the cubic, once or twice; few intervals are halved


@pytest.mark.parametrize(
    "damping", [ModalDamping(ratio=r) for r in (0.98, 1.0, 1.02, 5.0)] + [ViscousDamping(coefficient=200.0)]
)
def test_overdamped_modes_do_not_slow_the_search(damping: Damping, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = counted_evaluations(monkeypatch)
    history = simulated(shaken(tip(1e-5), damping=damping), 4, elements=40)
    switches = history.switch_times.size
    assert switches
    assert asked["at"] < 60 * switches  # some ten halvings and Newton steps for each, with room for windows without one


def test_bounds_hold_for_every_kind_of_mode() -> None:
    """Against 2000 samples: z never rises above a chord, or leaves a tangent, by more than the bound."""
    rng = np.random.default_rng(0)
    for ratio in ((5.0, 1.0, 0.999, 0.02), (1.2, 0.8, 3.0, 1.0 + 1e-7), (0.0, 0.5), (1.1,)):
        for supports in ((CLAMP,), (Support(x=0.0, translational=math.inf),), ()):
            problem = shaken(
                tip(1e-3), Stop(x=0.4, side="top", gap=0.0, stiffness=1.0), damping=ModalDamping(ratio=ratio)
            )
            problem = problem.replace(supports=supports)
            system = build_system(Assembly(problem, mesh_nodes(problem, 5, None)), FREE)
            n = system.omega.size
            flow = Flow(system, 0.3, rng.normal(size=n), rng.normal(size=n) * rng.choice([0.1, 1.0, 1e3], size=n))
            for width in 10.0 ** rng.uniform(-6, 1, size=12):
                begin = 0.3 + rng.choice([0.0, 1e-3, 0.1])
                t = np.linspace(begin, begin + width, 2000)
                z = flow.at_stops(t)
                slack = 1e-9 * np.abs(z).max()
                offset = np.array([0.1, 0.2])
                gaps = FlowGaps(flow, np.array([1.0, -1.0]), offset, width)
                chord = flow.envelope.from_chord(t[:1], width)[system.place_of, 0]
                assert np.all(z.max(axis=1) <= np.maximum(z[:, 0], z[:, -1]) + chord + slack)
                for k, (side, gap) in enumerate(zip((1.0, -1.0), offset, strict=True)):
                    h = side * z[k] - gap
                    for direction in (1.0, -1.0):
                        most = gaps.ceiling(k, t[:1], width, h[[0, -1], None], direction)
                        assert np.all(direction * h <= most + slack)
                        assert most <= (direction * h[[0, -1]]).max() + chord[k] + slack
                    value, rate = flow.at_stop(k, begin)
                    ends = (*flow.at_stop(k, 0.3 + 3 * width), *flow.at_stop(k, 0.3 + 4 * width))
                    assert flow.at_step(k, width, 3) == pytest.approx(ends, rel=1e-7, abs=1e-9 * np.abs(z).max())
                    stray, turn = flow.envelope.from_tangent(int(system.place_of[k]), begin, width)
                    since = t - begin
                    assert np.all(np.abs(z[k] - value - rate * since) <= stray * since / width + slack)
                    rates = flow.at_stops(t, 1)[k]
                    assert np.all(np.abs(rates - rate) <= turn + 1e-9 * np.abs(rates).max())


@pytest.mark.parametrize("stiffness", [1e6, 1e9, 1e12])
def test_a_node_that_rings_while_pressed_on_a_stop_is_not_followed_swing_by_swing(
    stiffness: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without damping the tip almost leaves the stop at each of up to 7e5 swings, and its peaks are almost equal."""
    asked: Counter[str] = Counter()
    plain = FlowGaps.__call__

    def counted(self: FlowGaps, t: FloatArray) -> FloatArray:
        asked["values"] += t.size
        return plain(self, t)

    monkeypatch.setattr(FlowGaps, "__call__", counted)
    one_by_one = counted_evaluations(monkeypatch)
    stop = Stop(x=1.0, side="top", gap=0.0, stiffness=stiffness)
    pressed = shaken(stop).replace(base_motion=None, damping=NoDamping(), point_loads=(StepLoad(x=1.0, force=1.0),))
    history = fe_lapjoint.Solver(elements=20).simulate(pressed, 0.02, errors=False)
    (contact,) = history.contacts
    assert (contact.start, contact.open_end) == (pytest.approx(0.0, abs=1e-6), True)
    # The load is a step, which a spring answers with twice its force; the beam carries less, the stiffer the stop is.
    assert contact.peak_force == pytest.approx(2.0, abs=600 / stiffness**0.5)
    assert one_by_one["at"] < 600
    assert asked["values"] < 20_000
