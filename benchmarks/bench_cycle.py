"""The cost of an excitation cycle of the paper's joint at 515 rad/s, transient and certified switches included.

To compare two versions of the code, start one process for each, let them take turns many times in computing the same
steady states, and divide the medians of `time.process_time`: other load on the machine then meets both alike.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import analytic
import fe_lapjoint
from analytic.march import Coordinates, Joint, march
from benchmarks.naive_march import naive_march
from lapjoint import FREE, Problem, paper_joint
from lapjoint.problem.presets import lap_joint

CYCLES = 50
PERIOD = 2 * math.pi / 515.0
FREQUENCIES = (300.0, 515.0, 900.0, 1500.0)
"""Angular frequencies of the steady states, rad/s."""


def settled(modes: int) -> tuple[Joint, Coordinates]:
    joint = Joint(paper_joint(angular_frequency=515.0), modes, modes)
    rest = Coordinates(FREE, np.zeros(modes), np.zeros(modes))
    return joint, march(joint, rest, 0.0, 20 * PERIOD, record=False).end


@pytest.mark.parametrize("modes", [5, 10, 20, 40, 80])
@pytest.mark.benchmark(group=f"{CYCLES} cycles at 515 rad/s")
def bench_certified_march(benchmark: Any, modes: int) -> None:
    joint, begin = settled(modes)
    benchmark.extra_info["us per cycle"] = "mean / 50"
    motion = benchmark(march, joint, begin, 0.0, CYCLES * PERIOD, record=False)
    assert motion.penetration.min() > 0


@pytest.mark.benchmark(group=f"{CYCLES} cycles at 515 rad/s")
def bench_naive_march_of_20_modes(benchmark: Any) -> None:
    joint, begin = settled(20)

    def run() -> int:
        slot, _, switches = naive_march(
            joint.tables, joint.slot(begin.state), 0.0, CYCLES * PERIOD, begin.q.copy(), begin.v.copy()
        )
        assert slot >= 0
        return int(switches)

    switches = benchmark.pedantic(run, warmup_rounds=1, rounds=5)
    assert switches == pytest.approx(8 * CYCLES, abs=2)


def with_dampers(damping: float, angular_frequency: float = 515.0) -> Problem:
    """The paper's joint with a damper, N s/m, in each stop."""
    joint = paper_joint(angular_frequency=angular_frequency)
    return joint.replace(stops=tuple(type(stop)(**{**dict(stop), "damping": damping}) for stop in joint.stops))


@pytest.mark.parametrize("damping", [0.0, 3.0, 300.0])
@pytest.mark.benchmark(group=f"{CYCLES} cycles at 515 rad/s, without and with damped stops, 20 modes")
def bench_march_with_damped_stops(benchmark: Any, damping: float) -> None:
    """The march alone; a stop that is released before it opens makes three switches of a contact, not two."""
    joint = Joint(with_dampers(damping), 20, 20)
    rest = Coordinates(FREE, np.zeros(20), np.zeros(20))
    begin = march(joint, rest, 0.0, 20 * PERIOD, record=False).end
    benchmark(march, joint, begin, 0.0, CYCLES * PERIOD, record=False)


@pytest.mark.parametrize("damping", [0.0, 3.0, 300.0])
@pytest.mark.parametrize("solver", ["analytic", "fe"])
def bench_certified_cycle_with_damped_stops(benchmark: Any, solver: str, damping: float) -> None:
    """Certified steady states at four frequencies, with their errors and the energies that their contacts lose."""
    benchmark.group = f"{len(FREQUENCIES)} certified cycles, without and with damped stops, {solver}"
    chosen = analytic.Solver(free_modes=20, contact_modes=20) if solver == "analytic" else fe_lapjoint.Solver()
    problems = [with_dampers(damping, omega) for omega in FREQUENCIES]
    benchmark.pedantic(lambda: [chosen.steady_state(problem) for problem in problems], warmup_rounds=1, rounds=7)


@pytest.mark.parametrize("joint", ["one beam", "two plates"])
@pytest.mark.parametrize("modes", [20, 46])
def bench_march_of_two_plates(benchmark: Any, modes: int, joint: str) -> None:
    """The march alone; `extra_info` has the switches of a cycle, of which the plates make more.  The default number of
    modes of the plates is 46."""
    benchmark.group = f"{CYCLES} cycles, {modes} modes: the paper's joint, and two plates at 300 rad/s"
    it = Joint(paper_joint(angular_frequency=515.0) if joint == "one beam" else lap_joint(), modes, modes)
    assert it.period is not None
    end = CYCLES * it.period
    begin = march(it, Coordinates(FREE, np.zeros(modes), np.zeros(modes)), 0.0, end, record=False).end
    benchmark.extra_info["switches of a cycle"] = int((march(it, begin, 0.0, end).log.stop >= 0).sum()) / CYCLES
    benchmark(march, it, begin, 0.0, end, record=False)


@pytest.mark.parametrize("joint", ["one beam", "two plates"])
@pytest.mark.parametrize("modes", [20, 46])
def bench_certified_cycle_of_two_plates(benchmark: Any, modes: int, joint: str) -> None:
    """A certified steady state, with its errors."""
    benchmark.group = f"certified cycle, {modes} modes: the paper's joint, and two plates at 300 rad/s"
    problem = paper_joint(angular_frequency=515.0) if joint == "one beam" else lap_joint()
    solver = analytic.Solver(n_modes=modes)
    solver.steady_state(problem)
    benchmark.pedantic(solver.steady_state, (problem,), rounds=15)


@pytest.mark.parametrize("damping", [0.0, 3.0])
@pytest.mark.parametrize("solver", ["analytic", "fe"])
def bench_contacts_of_damped_stops(benchmark: Any, solver: str, damping: float) -> None:
    """The same by a solver from rest on, with all contacts and the energies that they lose."""
    benchmark.group = f"{CYCLES} cycles at 515 rad/s with contacts, without and with damped stops, {solver}"
    chosen = analytic.Solver(free_modes=20, contact_modes=20) if solver == "analytic" else fe_lapjoint.Solver()
    problem = with_dampers(damping)
    chosen.simulate(problem, CYCLES * PERIOD, errors=False)
    benchmark.pedantic(chosen.simulate, (problem, CYCLES * PERIOD), {"errors": False}, rounds=7)
