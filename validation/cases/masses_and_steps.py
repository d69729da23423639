"""Frequencies of beams with masses and steps against their equations, and against a printed benchmark with a mass."""

from __future__ import annotations

import math

import analytic
import fe_lapjoint
from lapjoint import FREE, Beam, Problem, Support
from lapjoint.problem import Mass, Material, Tube
from lapjoint.solver import Solver
from validation.case import CaseResult, Level, Say, table
from validation.cases.masses_and_steps_equations import CARRYING, tip_mass
from validation.cases.motions import FE_ORDER
from validation.cases.textbook_equations import ROOTS, roots
from validation.references.reading import group
from validation.uncertainty import elements, refined_estimate
from validation.verdict import Check, Estimate, Kind

EXACT = 1e-12  # Relative rounding of the roots: a determinant loses the digits of cosh b, up to 1e4
ROUNDING_OF_EIGENVALUES = 1e-11  # Relative rounding of the finite element frequencies
RAYLEIGH = 0.24  # Part of the beam's mass that moves with the tip, in the benchmark's formula for its first frequency


def sdll15() -> Problem:
    """The benchmark's tube with a mass at its tip."""
    given = {key: row[0].value for key, row in group("sdll15 problem").items()}
    beam = Beam(
        length=given["length"],
        material=Material(youngs_modulus=given["youngs_modulus"], density=given["density"]),
        section=Tube(outer_diameter=given["outer_diameter"], inner_diameter=given["inner_diameter"]),
    )
    clamp = Support(x=0.0, translational=math.inf, torsional=math.inf)
    return Problem(beam=beam, supports=(clamp,), masses=(Mass(x=beam.length, mass=given["tip_mass"]),))


def exact_of(problem: Problem) -> tuple[float, ...]:
    """The benchmark's frequencies by the characteristic equation of a cantilever with a mass at its tip, Hz."""
    beam, mass = problem.line, problem.structure.masses[0].mass
    unit = math.sqrt(beam.EI / (beam.m * beam.length**4)) / (2 * math.pi)
    return tuple(unit * b**2 for b in roots(tip_mass(mass / (beam.m * beam.length))))


def by_rayleigh(problem: Problem) -> float:
    """The first frequency by the benchmark's approximate formula, Hz."""
    beam = problem.line
    moved = problem.structure.masses[0].mass + RAYLEIGH * beam.m * beam.length
    return math.sqrt(3 * beam.EI / (beam.length**3 * moved)) / (2 * math.pi)


def computed(problem: Problem, meshes: tuple[int, ...], count: int) -> dict[str, tuple[Estimate, ...]]:
    """Both solvers' frequencies, rad/s, with their uncertainty."""

    def found(solver: Solver) -> tuple[float, ...]:
        return tuple(float(omega) for omega in solver.modes(problem, FREE, count).angular_frequencies)

    fe = zip(*(found(fe_lapjoint.Solver(elements=n)) for n in meshes), strict=True)
    what = elements(meshes[-1])
    how = "roots bracketed by their count, to rounding"
    return {
        "analytic": tuple(Estimate(w, EXACT * w, how) for w in found(analytic.Solver())),
        "FE": tuple(refined_estimate(w, 2.0, FE_ORDER, what, ROUNDING_OF_EIGENVALUES) for w in fe),
    }


def run(level: Level, say: Say) -> CaseResult:
    """All beams, by both solvers."""
    meshes = (24, 48, 96) if level == "full" else (16, 32, 64)
    checks: list[Check] = []
    rows = []
    for name, beam in CARRYING.items():
        say(name)
        answers = computed(beam.problem, meshes, ROOTS)
        for i, root in enumerate(roots(beam.equation)):
            w = root**2  # of length, stiffness and mass 1
            reference = Estimate(w, EXACT * w, f"{beam.formula}, by brentq to rounding", Kind.ANALYTICAL)
            for solver, found in answers.items():
                checks.append(Check(f"{name}, mode {i + 1}: {solver} against the equation", "1", found[i], reference))
            rows.append((name, i + 1, f"{w:.10f}", *(f"{found[i].value:.10f}" for found in answers.values())))
    say("SDLL15")
    more, benchmark = _sdll15(meshes)
    return CaseResult(
        "masses-and-steps",
        "Beams with masses and steps",
        "Frequencies of uniform beams that carry masses, with and without rotary inertia, and of stepped beams, each "
        "compared with the root of its characteristic equation, solved apart from both solvers.  Code_Aster's "
        "benchmark SDLL15, a tube with 1000 kg at its tip, is compared with its printed digits and with the equation. "
        "Its first frequency is printed from an approximate formula, whose distance from the equation is granted.",
        checks=(*checks, *more),
        tables=(
            table("Frequencies, in units of sqrt(EI / m) / L^2", ("beam", "mode", "equation", "analytic", "FE"), rows),
            table("SDLL15, Hz", ("mode", "printed", "equation", "analytic", "FE"), benchmark),
        ),
        notes=tuple(f"{name}: {beam.formula}" for name, beam in CARRYING.items()),
    )


def _sdll15(meshes: tuple[int, ...]) -> tuple[list[Check], list[tuple[object, ...]]]:
    """The benchmark's checks and the rows of its table, in Hz."""
    problem = sdll15()
    given, exact = group("sdll15 answers")["bending"], exact_of(problem)
    answers = computed(problem, meshes, len(given))
    checks: list[Check] = []
    rows: list[tuple[object, ...]] = []
    for i, value in enumerate(given):
        formula = abs(by_rayleigh(problem) - exact[0]) if i == 0 else 0.0
        true = Estimate(exact[i], EXACT * exact[i], "equation of a mass at the tip, by brentq", Kind.ANALYTICAL)
        row: list[object] = [i + 1, value.text, f"{exact[i]:.9f}"]
        for solver, found in answers.items():
            hertz = Estimate(found[i].value / (2 * math.pi), found[i].uncertainty / (2 * math.pi), found[i].how)
            label = f"SDLL15, mode {i + 1}: {solver} against"
            checks.append(Check(f"{label} the document", "Hz", hertz, value.estimate(hertz.uncertainty + formula)))
            checks.append(Check(f"{label} the equation", "Hz", hertz, true))
            row.append(f"{hertz.value:.9f}")
        rows.append(tuple(row))
    return checks, rows
