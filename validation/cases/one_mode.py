"""The impact oscillator with one degree of freedom, as the limit of a beam that turns about a pin without bending."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import Beam, History, PolynomialShape, Problem, Stop, Support
from lapjoint.solver import Solver
from validation.case import CaseResult, Level, Say, table
from validation.cases.bilinear import Bilinear, classical_frequency
from validation.uncertainty import Refined, refined_estimate
from validation.verdict import Check, ErrorSource, Estimate, Kind

LENGTH, MASS = 1.0, 3.0  # Length, m, and mass per length, kg/m: the moment of inertia about the pin is m L^3 / 3
TORSION, STOP = 100.0, 525.0
"""Torsional spring, N m/rad, and stop, N/m: omega_2 / omega_1 = 2.5, with which no compared harmonic is resonant."""
SPEED = 0.1  # Speed of the tip at t = 0, m/s
GAPS = (0.006, 0.0)  # Gaps of the stop, m
CONTACTS, HARMONICS = 3, (0, 1, 2, 3)
SOFTEST, RATIO = 1e6, 4.0  # Least bending stiffness, N m2, and the factor from one stiffness to the next
LIMIT_ORDER = 1.0
"""Order of the effect of bending in 1 / EI: bending is proportional to load / EI; the ringing after an impact has the
order 3/2."""
SOLVERS: dict[str, Solver] = {"analytic": analytic.Solver(n_modes=6), "FE": fe_lapjoint.Solver(elements=6)}
ROUNDING = 1e-12  # Relative rounding of the closed form
EVENT_FLOOR = (
    1.1e-9  # s: the shortest step in the FE solver's search for a switch, the first one after a start at the gap
)


def oscillator(gap: float) -> Bilinear:
    """The limit of a rigid bar, with the displacement of its tip as the coordinate."""
    inertia = MASS * LENGTH**3 / 3
    omega_1 = math.sqrt(TORSION / inertia)
    omega_2 = math.sqrt((TORSION + STOP * LENGTH**2) / inertia)
    return Bilinear(omega_1, omega_2, gap, SPEED)


def bar(gap: float, stiffness: float) -> Problem:
    """The beam: pinned, held by a torsional spring, turning towards a stop at its tip."""
    return Problem(
        beam=Beam(length=LENGTH, bending_stiffness=stiffness, mass_per_length=MASS),
        supports=(Support(x=0.0, translational=math.inf, torsional=TORSION),),
        stops=(Stop(x=LENGTH, side="top", gap=gap, stiffness=STOP),),
        initial=PolynomialShape(velocity=(0.0, SPEED / LENGTH)),
    )


def contact_numbers(history: History) -> list[float]:
    """Start, end, impulse and peak force of the first contacts."""
    first = history.contacts[:CONTACTS]
    return [number for c in first for number in (c.start, c.end, c.impulse, c.peak_force)]


def exact_contacts(limit: Bilinear) -> list[tuple[str, str, float]]:
    """Start, end, impulse and peak force of the first contacts in closed form, with name and unit."""
    numbers = []
    for i, piece in enumerate(limit.contacts(CONTACTS)):
        label = f"contact {i + 1}"
        numbers += [(f"{label}: impact", "s", piece.start), (f"{label}: rebound", "s", piece.end)]
        numbers += [(f"{label}: impulse", "N s", STOP * piece.area), (f"{label}: peak", "N", STOP * piece.depth)]
    return numbers


def period_numbers(history: History) -> list[float]:
    """Frequency between the second and third impact, and harmonics of the tip's displacement in between."""
    start, end = (contact.start for contact in history.contacts[1:3])
    omega = 2 * math.pi / (end - start)
    x, w = np.polynomial.legendre.leggauss(16)
    inside = history.switch_times[(history.switch_times > start) & (history.switch_times < end)]
    edges = np.concatenate([np.linspace(a, b, 9)[:-1] for a, b in zip([start, *inside], [*inside, end], strict=True)])
    edges = np.append(edges, end)
    half = np.diff(edges)[:, None] / 2
    t, weights = (edges[:-1, None] + half * (1 + x)).ravel(), (half * w).ravel()
    z = history.displacement(LENGTH, t)[0] * weights
    return [omega, *(abs(np.sum(z * np.exp(-1j * n * omega * (t - start)))) / (end - start) for n in HARMONICS)]


def exact_period(limit: Bilinear) -> list[tuple[str, str, float]]:
    """Frequency and harmonics in closed form, with name and unit."""
    omega = classical_frequency(limit.omega_1, limit.omega_2)
    return [("frequency", "rad/s", omega), *((f"harmonic {n}", "m", limit.harmonic(n)) for n in HARMONICS)]


def to_the_limit(levels: Sequence[Sequence[float]], i: int, unit: str, solver: Solver) -> Estimate:
    """A number of the stiffest beam, and its distance from the rigid bar by extrapolation."""
    what = Refined(ErrorSource.STIFFNESS, f"{solver.name}, beam {RATIO:g} and {RATIO**2:g} times as stiff")
    found = refined_estimate([level[i] for level in levels], RATIO, LIMIT_ORDER, what, 1e-10)
    return replace(found, uncertainty=found.uncertainty + (EVENT_FLOOR if unit == "s" else 0.0))


def run(level: Level, say: Say) -> CaseResult:
    """With and without a gap, by both solvers."""
    checks, rows = [], []
    for gap in GAPS:
        limit = oscillator(gap)
        say(f"gap {gap:g} m")
        exact = exact_contacts(limit) + (exact_period(limit) if gap == 0 else [])
        for name, solver in SOLVERS.items():
            levels = [numbers(solver, limit, SOFTEST * RATIO**power) for power in range(3)]
            for i, (quantity, unit, value) in enumerate(exact):
                found = to_the_limit(levels, i, unit, solver)
                source = "Shaw and Holmes (1983)" if quantity == "frequency" else "sines piece by piece"
                reference = Estimate(value, ROUNDING * abs(value), source, Kind.ANALYTICAL)
                checks.append(Check(f"gap {gap:g} m, {quantity}: {name}", unit, found, reference))
                rows.append((f"{gap:g}", quantity, unit, name, value, found.value, f"{checks[-1].relative:.1e}"))
    columns = ("gap (m)", "quantity", "unit", "solver", "closed form", "found", "difference")
    return CaseResult(
        "one-mode",
        "The impact oscillator with one degree of freedom",
        "A beam on a pin and a torsional spring, so stiff that it turns as a rigid bar, swings against one stop "
        "without damping: the bilinear oscillator, whose motion is known piece by piece. Impacts, rebounds, impulses "
        "and peak forces are compared for a gap; without one, so are the classical frequency "
        "2 omega_1 omega_2 / (omega_1 + omega_2) and the first Fourier coefficients. Beams of three bending "
        "stiffnesses, each four times the one before, show how far the stiffest is from the rigid bar.",
        checks=tuple(checks),
        tables=(table("Bilinear oscillator", columns, rows),),
    )


def numbers(solver: Solver, limit: Bilinear, stiffness: float) -> list[float]:
    """All numbers of one motion, in the order of the closed form."""
    duration = limit.contacts(CONTACTS)[-1].end + limit.period / 8
    history = solver.simulate(bar(limit.gap, stiffness), duration, errors=False)
    return contact_numbers(history) + (period_numbers(history) if limit.gap == 0 else [])
