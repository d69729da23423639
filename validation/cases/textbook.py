"""Frequency parameters of single-span beams against textbook tables and the equations that they solve."""

from __future__ import annotations

import math

import analytic
import fe_lapjoint
from lapjoint import FREE, Beam, Problem
from lapjoint.solver import Solver
from validation.case import CaseResult, Level, Say, table
from validation.cases.motions import FE_ORDER
from validation.cases.textbook_equations import BEAMS, ROOTS, Textbook, roots
from validation.references.reading import Printed, group, group_names
from validation.uncertainty import elements, refined_estimate
from validation.verdict import Check, Estimate, Kind

EXACT = 4e-15  # Relative rounding of either root finder
ROUNDING_OF_EIGENVALUES = 1e-9  # Relative rounding of the finite element eigenvalues


def parameters(solver: Solver, beam: Textbook) -> tuple[float, ...]:
    """The lowest elastic beta L of a beam of unit length, stiffness and mass."""
    problem = Problem(beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0), supports=beam.supports)
    found = solver.modes(problem, FREE, ROOTS + beam.rigid).angular_frequencies
    return tuple(math.sqrt(omega) for omega in found[beam.rigid :])


def computed(beam: Textbook, meshes: tuple[int, ...]) -> dict[str, tuple[Estimate, ...]]:
    """Both solvers' beta L with their uncertainty."""
    exact = parameters(analytic.Solver(), beam)
    fe = list(zip(*(parameters(fe_lapjoint.Solver(elements=n), beam) for n in meshes), strict=True))
    how, what = "roots bracketed by their count, to rounding", elements(meshes[-1])
    return {
        "analytic": tuple(Estimate(b, EXACT * b, how) for b in exact),
        "FE": tuple(refined_estimate(b, 2.0, FE_ORDER, what, ROUNDING_OF_EIGENVALUES) for b in fe),
    }


def run(level: Level, say: Say) -> CaseResult:
    """All beams, by both solvers."""
    meshes = (24, 48, 96) if level == "full" else (16, 32, 64)
    checks, rows = [], []
    for name, beam in BEAMS.items():
        say(name)
        answers = computed(beam, meshes)
        for i, root in enumerate(roots(beam.equation)):
            reference = Estimate(root, EXACT * root, f"{beam.formula}, by brentq to rounding", Kind.ANALYTICAL)
            for solver, found in answers.items():
                checks.append(Check(f"{name}, b_{i + 1}: {solver} against the equation", "1", found[i], reference))
            rows.append((name, i + 1, f"{root:.12f}", *(f"{found[i].value:.12f}" for found in answers.values())))
        for row in rows_of(name):
            checks += _against_print(name, row, answers)
    return CaseResult(
        "textbook",
        "Single-span beams of the textbooks",
        "Frequency parameters b = beta L of uniform beams on every pair of clamped, pinned, sliding and free ends that "
        "textbooks list, and on translational and torsional springs at root, mid-span and tip. Each is compared with "
        "the root of the textbook's characteristic equation, solved apart from both solvers, and where a table was "
        "found with the printed digits, of which half a unit of the last one is granted. Rigid-body modes are left "
        "out.",
        checks=tuple(checks),
        tables=(table("Frequency parameters b", ("beam", "mode", "equation", "analytic", "FE"), rows),),
        notes=tuple(f"{name}: {beam.formula}" for name, beam in BEAMS.items()),
    )


def rows_of(beam: str) -> list[tuple[Printed, ...]]:
    """The rows of printed tables that are about a beam."""
    return [group(name)[beam] for name in group_names() if name.startswith(f"{beam}, ")]


def _against_print(beam: str, row: tuple[Printed, ...], answers: dict[str, tuple[Estimate, ...]]) -> list[Check]:
    return [
        Check(
            f"{beam}, b_{i + 1}: {solver} against {given.source.short}",
            "1",
            found[i],
            given.estimate(found[i].uncertainty),
        )
        for i, given in enumerate(row)
        for solver, found in answers.items()
    ]
