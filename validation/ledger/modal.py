"""Claims about frequencies and mode shapes: Table 4, the states' frequencies of Section 3, the two shape ratios."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import FREE, ContactState, Problem, contact_states, paper_joint, paper_state_number
from lapjoint.problem.presets import PAPER_DENSITY, TABLE_4_DENSITY
from validation.cases.table4 import PRINTED, numbers
from validation.ledger.entry import TIP, Entry, claims, said, written
from validation.ledger.rules import READING, Ruling
from validation.uncertainty import elements, refined_estimate
from validation.verdict import Estimate

MESHES = (16, 32, 64)
QUOTED = (1, 2, 5)  # Modes of the states with two springs that Section 3 cites: 515 + 3, 820 - 6, 2950 + 20


def modal_entries() -> list[Entry]:
    """All claims about frequencies and mode shapes."""
    return [*table_4(), *quoted_frequencies(), *shape_ratios()]


def frequencies(problem: Problem, state: ContactState, i: int) -> tuple[Estimate, Estimate]:
    """The i-th frequency, from 0, by both solvers, rad/s."""
    exact = float(analytic.Solver().modes(problem, state, i + 1).angular_frequencies[i])
    by_mesh = [
        float(fe_lapjoint.Solver(elements=n).modes(problem, state, i + 1).angular_frequencies[i]) for n in MESHES
    ]
    fe = refined_estimate(by_mesh, 2.0, 4.0, elements(MESHES[-1]), 1e-9)
    return Estimate(exact, 1e-13 * exact, "to rounding"), fe


def table_4() -> list[Entry]:
    """Each printed frequency, with the density that reproduces it and with the one that is printed."""
    entries, fitting, heavier_fitting = [], 0, 0
    for k_star, groups in PRINTED.items():
        problem, heavier = (paper_joint(k_star=k_star, density=rho) for rho in (TABLE_4_DENSITY, PAPER_DENSITY))
        by_number = {paper_state_number(problem, state): state for state in contact_states(problem)}
        for states, values in groups.items():
            for i, given in enumerate(values):
                state = by_number[numbers(states)[0]]
                exact, fe = frequencies(problem, state, i)
                other = float(analytic.Solver().modes(heavier, state, i + 1).angular_frequencies[i])
                key = f"table 4/{k_star:g}/{states}/{i + 1}"
                found = {**said(key), "analytic": exact.value, "fe": fe.value}
                why = f"with rho = {TABLE_4_DENSITY:g} kg/m3; with the printed {PAPER_DENSITY:g} it is {other:.6g}"
                entry = Entry(key, found, why, written(exact), written(fe))
                if entry.ruling is not Ruling.CONFIRMED:
                    entry = replace(entry, why=f"{exact.value:.6g}: {why}")
                entries.append(entry)
                fitting += entry.ruling is Ruling.CONFIRMED
                heavier_fitting += abs(other - given.value) <= given.half_unit
    return [*entries, density(fitting, heavier_fitting, len(entries))]


def density(fitting: int, heavier_fitting: int, count: int) -> Entry:
    """The density that the tables print."""
    return Entry(
        "density",
        {"fit printed": heavier_fitting, "fit other": fitting, "frequencies": count},
        f"{fitting} of {count} frequencies of Table 4 come out with {TABLE_4_DENSITY:g}, {heavier_fitting} with "
        f"{PAPER_DENSITY:g}; all are then {1 - (TABLE_4_DENSITY / PAPER_DENSITY) ** 0.5:.2%} lower",
        f"{TABLE_4_DENSITY:g}",
        f"{TABLE_4_DENSITY:g}",
    )


def quoted_frequencies() -> list[Entry]:
    """The frequencies of the two-spring states that the peaks are measured against."""
    problem, heavier = (paper_joint(density=rho) for rho in (TABLE_4_DENSITY, PAPER_DENSITY))
    both = ContactState((0, 1))
    entries = []
    for mode in QUOTED:
        exact, fe = frequencies(problem, both, mode - 1)
        other = float(analytic.Solver().modes(heavier, both, mode).angular_frequencies[mode - 1])
        key = f"quoted frequency/{mode}"
        why = f"{other:.5g} with rho = {PAPER_DENSITY:g}; the paper's figure is a peak less a whole offset"
        found = {**said(key), "analytic": exact.value, "fe": fe.value}
        entries.append(Entry(key, found, why, written(exact), written(fe)))
    highest = claims()[f"quoted frequency/{QUOTED[-1]}"].number.value + READING

    def count(solver: analytic.Solver | fe_lapjoint.Solver) -> int:
        return int(sum(solver.modes(problem, both, 8).angular_frequencies < highest))

    one, other_count = count(analytic.Solver()), count(fe_lapjoint.Solver())
    why = "counted from one; no frequency is missed, as their number below is counted"
    found = {**said("sixth"), "analytic": one, "fe": other_count}
    return [*entries, Entry("sixth", found, why, f"{one}", f"{other_count}")]


def shape_ratios() -> list[Entry]:
    """The tip in state 2 as a part of the free tip, hard contact, first and second mode."""

    def ratio(solver: analytic.Solver | fe_lapjoint.Solver, i: int, density: float) -> float:
        problem, x = paper_joint(k_star=5000.0, density=density), np.array([TIP])
        free, held = (solver.modes(problem, state, i + 1).shapes(x)[i, 0] for state in (FREE, ContactState((0,))))
        return abs(100 * float(held / free))

    entries = []
    for i in range(2):
        exact = partial(ratio, analytic.Solver(), i)
        by_mesh = [ratio(fe_lapjoint.Solver(elements=n), i, PAPER_DENSITY) for n in MESHES]
        fe = refined_estimate(by_mesh, 2.0, 4.0, elements(MESHES[-1]), 1e-9)
        key, value = f"tip ratio/{i + 1}", exact(PAPER_DENSITY)
        found = {**said(key), "analytic": value, "fe": fe.value}
        why = f"mass-normalised shapes; {exact(TABLE_4_DENSITY):.4f} % with the other density"
        entries.append(Entry(key, found, why, f"{value:.4f} %", f"{fe.value:.4f} % ± {fe.uncertainty:.1g}"))
    return entries
