"""Random problems whose parameters span many decades: solved, without a warning, a false contact, or a crawl."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest

import fe_lapjoint
from fe_lapjoint.march import crowding
from fe_lapjoint.march.gaps import FlowGaps
from lapjoint import (
    BaseMotion,
    Beam,
    History,
    InputError,
    ModalDamping,
    NoDamping,
    Problem,
    SineLoad,
    SolverError,
    StepLoad,
    Stop,
    Support,
    ViscousDamping,
)
from lapjoint.problem import Damping, FloatArray


def random_problem(seed: int, stiffest: float = 8.0) -> tuple[Problem, float]:
    """A problem with stops, and a duration: at most a fiftieth of a period of slow bending; stiff stops chatter in it.

    Lengths are 1e-3 to 1e3 m, stiffnesses of supports 1e-6 to 1e12 EI / L^3, those of stops up to 1e8, or more; gaps
    zero, tiny or of the size of the motion, damping ratios 0 to 5; supports of every kind, and none.  `stiffest` is the
    decade of the stiffest stops.
    """
    rng = np.random.default_rng((11, seed))

    def decades(least: float, most: float) -> float:
        return float(10 ** rng.uniform(least, most))

    L, EI, m = decades(-3, 3), decades(-6, 9), decades(-6, 4)
    slow, unit = math.sqrt(EI / m) / L**2, EI / L**3
    supports: list[Support] = []
    for _ in range(int(rng.integers(0, 4))):
        k, kt = ([0.0, math.inf, size * decades(-6, 12)][int(rng.integers(0, 3))] for size in (unit, EI / L))
        supports.append(Support(x=float(rng.choice([0.0, L, rng.uniform(0, L)])), translational=k, torsional=kt))
    omega = slow * decades(-1, 2)
    base = BaseMotion(amplitude=decades(-11, -2) * L, angular_frequency=omega, phase=rng.uniform(0, 6))
    size = base.amplitude * min(1.0, (omega / slow) ** 2)
    stops = tuple(
        Stop(
            x=float(rng.choice([L, rng.uniform(0, L)])),
            side="top" if rng.random() < 0.5 else "bottom",
            gap=float(rng.choice([0.0, size * decades(-3, 1), size * decades(-9, -6)])),
            stiffness=unit * decades(-6, stiffest),
        )
        for _ in range(int(rng.integers(1, 5)))
    )
    step = StepLoad(x=rng.uniform(0, L), force=unit * size * rng.normal())
    sine = SineLoad(x=rng.uniform(0, L), force=unit * size, angular_frequency=omega * decades(-1, 1), phase=1.0)
    dampings: tuple[Damping, ...] = (
        NoDamping(),
        ModalDamping(ratio=float(rng.choice([0.01, 0.3, 1.0, 2.0, 5.0]))),
        ModalDamping(ratio=tuple(rng.uniform(0, 5, size=3).tolist())),
        ViscousDamping(coefficient=2 * m * slow * decades(-3, 2)),
    )
    problem = Problem(
        beam=Beam(length=L, bending_stiffness=EI, mass_per_length=m),
        supports=tuple(supports),
        stops=stops,
        damping=dampings[int(rng.integers(0, 4))],
        point_loads=((), (step,), (sine,), (step, sine))[int(rng.integers(0, 4))],
        base_motion=base,
    )
    return problem, min(2 * math.pi / slow / 50, 2 * math.pi / omega / 30)


def check_contacts(history: History, rounding: FloatArray) -> None:
    """No contact of no duration, none that pulls but for rounding, none missed on a grid.

    `rounding` is what the solver says that rounding makes of each gap, m: much, where a load pushes a beam that hardly
    a spring holds, so that its equilibrium is a hundred lengths away.
    """
    t = np.linspace(0, history.end, 300, endpoint=False)
    for k, stop in enumerate(history.problem.stops):
        depth = stop.sign * history.displacement(stop.x, t)[0] - stop.gap
        closed = np.zeros(t.size, dtype=bool)
        mine = [contact for contact in history.contacts if contact.stop == k]
        for contact in mine:
            assert contact.duration > 0 or contact.open_end
            closed |= (t >= contact.start) & (t < contact.end)
        allowed = 1e-9 * (
            np.abs(depth).max() + stop.gap + max((c.peak_force / stop.stiffness for c in mine), default=0)
        )
        allowed += rounding[k]
        assert np.all(depth[closed] >= -allowed)
        assert np.all(depth[~closed] <= allowed)


def check(seed: int, monkeypatch: pytest.MonkeyPatch, stiffest: float = 8.0) -> str:
    problem, duration = random_problem(seed, stiffest)
    asked: Counter[str] = Counter()
    plain, plain_rounding = FlowGaps.at, FlowGaps.rounding
    rounding = np.zeros(len(problem.stops))

    def counted(self: FlowGaps, k: int, t: float) -> tuple[float, float]:
        asked["at"] += 1
        return plain(self, k, t)

    def noted(self: FlowGaps) -> FloatArray:
        found = np.asarray(plain_rounding.__get__(self))
        np.maximum(rounding, found, out=rounding)
        return found

    monkeypatch.setattr(FlowGaps, "at", counted)
    monkeypatch.setattr(FlowGaps, "flow_terms", None)  # the search in Python, which is the same
    monkeypatch.setattr(FlowGaps, "rounding", property(noted))
    try:
        history = fe_lapjoint.Solver(elements=8).simulate(problem, duration)
    except InputError:
        return "refused"
    except SolverError as error:
        what = {"or a stiffness of at most": "too stiff", "smaller damping ratio": "held at a gap"}
        return next((outcome for words, outcome in what.items() if words in str(error)), str(error))
    finally:
        monkeypatch.undo()
    check_contacts(history, rounding)
    # Fifty halvings at most lead to a switch, for each stop that is near one, and some to none.
    assert asked["at"] <= 100 * (history.switch_times.size + 10) * len(problem.stops), f"seed {seed}"
    return "solved"


@pytest.mark.thorough
def test_random_extremes(monkeypatch: pytest.MonkeyPatch) -> None:
    outcomes = Counter(check(seed, monkeypatch) for seed in range(30))
    assert set(outcomes) <= {"solved", "refused"}
    assert outcomes["solved"] >= 25


@pytest.mark.slow
@pytest.mark.parametrize(("seeds", "stiffest", "least"), [(range(30, 330), 8.0, 250), (range(330, 498), 13.0, 150)])
def test_many_random_extremes(seeds: range, stiffest: float, least: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crowding, "MOST_SWITCHES", 1000)
    outcomes = Counter(check(seed, monkeypatch, stiffest) for seed in seeds)
    assert set(outcomes) <= {"solved", "refused", "too stiff", "held at a gap"}
    assert outcomes["solved"] >= least


# Each asked for thousands of values where a stiff stop's node rings, or lost a contact's digits in a soft support.
@pytest.mark.parametrize("seed", [341, 390, 403, 417, 459, 478])
def test_stops_of_any_stiffness(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    assert check(seed, monkeypatch, stiffest=13.0) == "solved"
