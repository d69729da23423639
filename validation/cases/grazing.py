"""Ever shorter grazing contacts: found by both solvers, missed by `solve_ivp` alone."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import analytic
import fe_lapjoint
from lapjoint import FREE, BaseMotion, Beam, ModalDamping, Problem, Stop, Support
from lapjoint.problem import FloatArray
from validation.case import CaseResult, Level, Say, table
from validation.verdict import Check, Criterion, Estimate

RATIO = 0.02  # Modal damping ratio
BEAM = Beam(length=2.0, bending_stiffness=1e5, mass_per_length=10.0)
FREE_FLIGHT = Problem(
    title="Cantilever that grazes a stop",
    beam=BEAM,
    supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
    damping=ModalDamping(ratio=RATIO),
    base_motion=BaseMotion(amplitude=1e-3, angular_frequency=70.0),
)
DURATION = 0.5  # Length of the motion, s
DEPTHS = tuple(10.0**-n for n in range(2, 9))


def highest(solver: analytic.Solver | fe_lapjoint.Solver) -> tuple[float, float]:
    """Largest tip displacement of the free flight, m, and its time, s, to rounding."""
    history = solver.simulate(FREE_FLIGHT, DURATION, errors=False)
    t = np.linspace(0.0, DURATION, 4001)
    i = int(np.argmax(history.displacement(BEAM.length, t)[0]))
    lo, hi = t[max(i - 1, 0)], t[min(i + 1, t.size - 1)]
    for _ in range(60):  # bisection on the velocity
        middle = (lo + hi) / 2
        if history.velocity(BEAM.length, middle)[0, 0] > 0:
            lo = middle
        else:
            hi = middle
    return float(history.displacement(BEAM.length, lo)[0, 0]), float(lo)


def three_modes() -> Callable[[float], int]:
    """A function of the depth, m, that counts the crossings of the gap that `solve_ivp` reports for the three lowest
    modes; there are two, as the gap lies this depth below the highest point of the motion."""
    modes = analytic.Solver().modes(FREE_FLIGHT, FREE, 3)
    omega, tip = modes.angular_frequencies, modes.shapes(np.array([BEAM.length]))[:, 0]
    x, w = np.polynomial.legendre.leggauss(60)
    share = BEAM.m * modes.shapes((x + 1) * BEAM.length / 2) @ w * BEAM.length / 2
    base = FREE_FLIGHT.base_motion
    assert isinstance(base, BaseMotion)

    def rates(t: float, y: FloatArray) -> FloatArray:
        force = share * base.amplitude * base.angular_frequency**2 * math.sin(base.angular_frequency * t)
        return np.concatenate([y[3:], force - 2 * RATIO * omega * y[3:] - omega**2 * y[:3]])

    def solve(rtol: float, **options: Any) -> Any:
        return solve_ivp(rates, (0.0, DURATION), np.zeros(6), method="DOP853", rtol=rtol, atol=rtol * 1e-4, **options)

    smooth = solve(1e-12, dense_output=True).sol
    t = np.linspace(0.0, DURATION, 20_001)
    i = int(np.argmax(tip @ smooth(t)[:3]))
    peak = float(np.max(tip @ smooth(np.linspace(t[i - 1], t[i + 1], 20_001))[:3]))

    def crossings(depth: float) -> int:
        return len(solve(1e-8, events=lambda _, y: float(tip @ y[:3]) - peak * (1 - depth)).t_events[0])

    return crossings


def run(level: Level, say: Say) -> CaseResult:
    """Contacts of ever smaller depth, by both solvers and by plain `solve_ivp`."""
    solvers: tuple[analytic.Solver | fe_lapjoint.Solver, ...] = (
        analytic.Solver(n_modes=16),
        fe_lapjoint.Solver(elements=16),
    )
    tops, found_by_solve_ivp = [highest(solver) for solver in solvers], three_modes()
    rows, checks, criteria, missed = [], [], [], 0
    for depth in DEPTHS:
        say(f"depth {depth:g}")
        durations = []
        for solver, (top, when) in zip(solvers, tops, strict=True):
            stop = Stop(x=BEAM.length, side="top", gap=top * (1 - depth), stiffness=1e5)
            contacts = solver.simulate(
                FREE_FLIGHT.replace(stops=(stop,)), min(DURATION, when + 0.01), errors=False
            ).contacts
            near = [c for c in contacts if abs((c.start + c.end) / 2 - when) < 1e-2]
            durations.append(near[0].duration if near else 0.0)
            criteria.append(
                Criterion(
                    f"depth {depth:g}: contacts found, {solver.name}", "1", float(len(near)), 1, 1, "one is there"
                )
            )
        plain = found_by_solve_ivp(depth)
        missed += plain == 0
        rows.append((f"{depth:g}", *(f"{d:.3e}" for d in durations), "found" if plain else "missed"))
        # A graze of depth d under acceleration a lasts sqrt(8 d z / |a|) in both solvers, each with its own a.
        u = 5e-3 * durations[0] + 4.4e-11
        a, b = (Estimate(d, u, "0.5 % for 16 modes and 16 elements, each with its own gap") for d in durations)
        checks.append(Check(f"depth {depth:g}: duration of the contact", "s", a, b))
    criteria.append(
        Criterion("contacts that solve_ivp alone misses", "1", float(missed), 1, len(DEPTHS), "what the case is about")
    )
    return CaseResult(
        "grazing",
        "Ever shorter grazing contacts",
        "A stop is placed a little below the highest point of the tip's free flight: by 1e-2 to 1e-8 of it. "
        "The contacts become ever shorter. scipy's solve_ivp looks at its events at the ends of its steps only, and "
        "passes over two crossings within one step (DOP853, rtol 1e-8); the certified steps of the analytic solver and "
        "the search of the FE solver do not.",
        checks=tuple(checks),
        criteria=tuple(criteria),
        tables=(table("Duration of the grazing contact, s", ("depth", "analytic", "FE", "solve_ivp alone"), rows),),
    )
