"""An outside benchmark: Code_Aster's validation case SDNL105 (V5.02.105), three tubes that strike each other.

A step load at mid-span of the first of three clamped-clamped tubes presses it against the second, which strikes the
third.  The document prints the motion at 1 s, by five modes of each tube, ten elements a tube and steps of 0.2 ms.  A
separate program repeats that, and then takes away the steps, the mesh and the small number of modes one by one, which
shows how much of each printed value comes from which.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import History, Problem, StepLoad, Stop, Support
from lapjoint.problem import Material, NamedBeam, Tube
from validation.case import CaseResult, Level, Say, number, table
from validation.cases.motions import refined_by
from validation.references import three_tubes
from validation.references.reading import Printed, group
from validation.uncertainty import refined_estimate
from validation.verdict import Check, Criterion, Estimate

TUBES = "abc"
REPEATED = 3e-3  # Relative difference from a printed value up to which it counts as repeated
UNITS = {"impact": "s", "displacement": "m", "velocity": "m/s"}
UNDER_THE_LOAD = 1e-4
"""What all modes beyond the eightieth still add to the velocity of the first tube, m/s.  The load begins with a step
and acts where the velocity is read; the waves of its modes fall only with the square of their number."""
FLOOR = 1e-9  # Relative rounding of a number after 1 s
ORDER = 2.0  # Assumed: an undamped tube under a step load rings in all its modes, and its motion converges slowly
MODES = {"quick": (48, 72, 108), "standard": (96, 144, 216), "full": (144, 216, 324)}  # Of all tubes together
ELEMENTS = 20, 40, 80  # Of each tube


def as_published() -> Problem:
    """The three tubes of the document."""
    given = {key: row[0].value for key, row in group("sdnl105 problem").items()}
    L, outer = given["length"], 2 * given["radius"]
    tubes = tuple(
        NamedBeam(
            name=name,
            length=L,
            material=Material(youngs_modulus=given["youngs_modulus"], density=given["density"]),
            section=Tube(outer_diameter=outer, inner_diameter=outer - 2 * given["wall"]),
            supports=tuple(Support(x=x, translational=math.inf, torsional=math.inf) for x in (0.0, L)),
        )
        for name in TUBES
    )
    return Problem(
        title="SDNL105 (V5.02.105): three tubes that strike each other",
        beams=tubes,
        stops=tuple(
            Stop(between=(f"{two}:0.5", f"{one}:0.5"), gap=given["gap"], stiffness=given["stiffness"])
            for one, two in itertools.pairwise(TUBES)
        ),
        point_loads=(StepLoad(x="a:0.5", force=given["force"]),),
    )


def names() -> list[tuple[str, str, Printed]]:
    """Name, unit and converged value of every number that is compared."""
    kept = group("sdnl105 answers")
    return [(f"{key} {i + 1}", unit, value) for key, unit in UNITS.items() for i, value in enumerate(kept[key])]


def answers(history: History) -> list[float]:
    """First impact of each stop, s, and displacements, m, and velocities, m/s, of the middles at 1 s."""
    middles = np.array([history.problem.position(f"{name}:0.5") for name in TUBES])
    impacts = [next((c.start for c in history.contacts if c.stop == k), math.nan) for k in range(len(TUBES) - 1)]
    at = three_tubes.AT
    return [*impacts, *history.displacement(middles, at)[:, 0], *history.velocity(middles, at)[:, 0]]


def ladder() -> dict[str, three_tubes.Motion]:
    """The motion as the document has it, and without its steps, without its mesh and without its few modes."""
    mesh = three_tubes.meshed()
    few = (three_tubes.MODES + 1) // 2  # the antisymmetric ones do not move
    return {
        "as printed": three_tubes.stepped(mesh),
        "no steps": three_tubes.exact(mesh),
        "no mesh": three_tubes.exact(three_tubes.uniform(few)),
        "20 symmetric modes": three_tubes.exact(three_tubes.uniform(20)),
    }


def run(level: Level, say: Say) -> CaseResult:
    """The printed numbers repeated by numpy alone, and both solvers against the converged ones."""
    say("numpy alone")
    steps = ladder()
    criteria, rows = [], []
    printed = group("sdnl105 printed")
    for key in printed:
        for i, value in enumerate(printed[key]):
            values = [float(getattr(motion, key)[i]) for motion in steps.values()]
            criteria.append(
                Criterion(
                    f"{key} {i + 1}: five modes of ten elements, in steps of 0.2 ms, over the printed value, less 1",
                    "1",
                    values[0] / value.value - 1,
                    -REPEATED,
                    REPEATED,
                    "the same model by a separate program",
                )
            )
            kept = group("sdnl105 answers")[key][i]
            rows.append((f"{key} {i + 1}", UNITS[key], value.text, *(number(v, 6) for v in values), kept.text))
    problem, checks = as_published(), []
    solvers: dict[str, list[analytic.Solver] | list[fe_lapjoint.Solver]] = {
        "analytic": [analytic.Solver(n_modes=n) for n in MODES[level]],
        "FE": [fe_lapjoint.Solver(elements=n) for n in ELEMENTS],
    }
    found: dict[str, list[Estimate]] = {}
    for name, levels in solvers.items():
        say(name)
        runs = [answers(solver.simulate(problem, three_tubes.AT, errors=False)) for solver in levels]
        ratio = 1.5 if name == "analytic" else 2.0
        what = refined_by(levels[-1])
        found[name] = [refined_estimate(values, ratio, ORDER, what, FLOOR) for values in zip(*runs, strict=True)]
    for i, (name, unit, kept) in enumerate(names()):
        reference = kept.estimate(UNDER_THE_LOAD if name == "velocity 1" else 0.0)
        for solver, estimates in found.items():
            checks.append(Check(f"{name}: {solver} against reference", unit, estimates[i], reference))
        checks.append(Check(f"{name}: analytic against FE", unit, found["analytic"][i], found["FE"][i]))
    for name, unit, kept in names():
        key, which = name.split()
        if key in printed:
            given = printed[key][int(which) - 1].estimate()
            reason = "Five modes, ten elements and steps of 0.2 ms, whose shares the table shows."
            checks.append(Check(f"{name}: printed against converged", unit, given, kept.estimate(), explanation=reason))
    return CaseResult(
        "sdnl105",
        "Outside benchmark: SDNL105",
        "A step load of 1 MN presses the first of three tubes against the second, which strikes the third, undamped. "
        "The printed values are those of five modes of ten elements, and a separate program repeats them. "
        "The displacements converge to within 0.3 % of what is printed, the velocity of the third tube to within 1 %. "
        "With all modes the velocity of the second tube is a tenth lower than printed, and that of the first, under "
        "the load, a third of the printed value: the mesh and the five modes made these two.",
        checks=tuple(checks),
        criteria=tuple(criteria),
        tables=(table("SDNL105 at 1 s", ("quantity", "unit", "printed", *steps, "converged"), rows),),
    )
