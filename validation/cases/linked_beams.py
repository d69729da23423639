"""Frequencies of two linked beams by both solvers, against characteristic equations in closed form.

Where a spring kappa joins the tips of two beams, one force acts on both, and its work is that of the beams' receptances
alpha, deflection under a unit force, and of the spring:

    1 / kappa + alpha_1 + alpha_2 = 0

A hinge is an infinite spring, and a torsional spring obeys the same with the slopes under unit moments.  At the tip of
a cantilever of length L, with b = beta L and c, s, C, S for cos b, sin b, cosh b, sinh b,

    alpha = L^3 (s C - c S) / (EI b^3 (1 + c C)),    turning: L (s C + c S) / (EI b (1 + c C))

and at the end of a free beam the first with c C - 1 for 1 + c C.  In an L-shaped frame a second member of length l
stands on the tip of a cantilever: it rides there as a mass mu, and turns with the tip.  With d, t, D, T for cos, sin,
cosh, sinh of b l, the root of the second member and the tip of the first one turn under unit moments by

    -(1 + d D) / (b (t D - d T)),    (s C + c S - mu b (1 - c C)) / (b (1 + c C - mu b (s C - c S)))

A weld of two equal cantilevers makes one beam of twice the length, clamped at both ends.  A closed stop between two
beams is a spring.  All is divided by C, so that nothing overflows.  Nothing here comes from `analytic`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import analytic
import fe_lapjoint
from lapjoint import FREE, ContactState, Problem, Stop, Support
from lapjoint.problem import Link, Mass, NamedBeam
from lapjoint.solver import Solver
from validation.case import CaseResult, Level, Say, table
from validation.cases.masses_and_steps import EXACT, ROUNDING_OF_EIGENVALUES
from validation.cases.motions import FE_ORDER
from validation.cases.textbook_equations import ROOTS, roots
from validation.uncertainty import elements, refined_estimate
from validation.verdict import Check, Estimate, Kind

FIXED = math.inf
SPRING, SOFT, TURNING = 7.0, 1e-3, 2.0
"""Stiffness of links in units of the first beam: as stiff as the beams, nearly none, and torsional as stiff as they."""
OTHER = 3.0, 0.4  # Bending stiffness and mass per length of the second beam; those of the first are 1
_MEMBER = 0.5  # Length of the second member of a frame, and its mass, which rides on the first one's tip
Fraction = Callable[[float], tuple[float, float]]
"""Numerator and denominator of a receptance, as a function of b of the first beam."""


@dataclass(frozen=True)
class Linked:
    """Two beams of length 1, a state, and the equations whose roots b together give all its frequencies b^2."""

    problem: Problem
    equations: tuple[Callable[[float], float], ...]
    formula: str
    """The equations, for the report."""
    state: ContactState = FREE
    rigid: int = 0
    """Number of motions as rigid bodies, whose frequency is 0."""


def tip(EI: float = 1.0, m: float = 1.0, *, turning: bool = False, free: bool = False) -> Fraction:
    """The receptance at the end of a cantilever, or of a free beam, for a force, or for a moment if `turning`."""
    waves = (m / EI) ** 0.25

    def fraction(first: float) -> tuple[float, float]:
        b = first * waves
        one, c, s, S = 1 / math.cosh(b), math.cos(b), math.sin(b), math.tanh(b)
        return (s + c * S if turning else s - c * S), EI * b ** (1 if turning else 3) * (c - one if free else c + one)

    return fraction


def joined(stiffness: float, *beams: Fraction) -> Callable[[float], float]:
    """The equation of two beams whose receptances are joined by a spring."""

    def equation(b: float) -> float:
        (n, d), (m, e) = (beam(b) for beam in beams)
        return d * e / stiffness + n * e + m * d

    return equation


def _beams(EI: float = 1.0, m: float = 1.0, *, free: bool = False) -> tuple[NamedBeam, NamedBeam]:
    """A cantilever from the left, and a beam from the right, clamped or free there."""
    left, right = (Support(x=x, translational=FIXED, torsional=FIXED) for x in (0.0, 1.0))
    one = NamedBeam(name="one", length=1.0, bending_stiffness=1.0, mass_per_length=1.0, supports=(left,))
    supports = () if free else (right,)
    return one, NamedBeam(
        name="two", origin=1.0, length=1.0, bending_stiffness=EI, mass_per_length=m, supports=supports
    )


def _linked(translational: float, torsional: float = 0.0, *, beams: tuple[NamedBeam, ...]) -> Problem:
    link = Link(between=("one:1", "two:0"), translational=translational, torsional=torsional)
    return Problem(beams=beams, links=(link,))


def _framed() -> Problem:
    """An L-shaped frame: the second member stands on the tip of the first, and turns with it at its root."""
    one, _ = _beams()
    two = NamedBeam(
        name="two",
        length=_MEMBER,
        bending_stiffness=1.0,
        mass_per_length=1.0,
        supports=(Support(x=0.0, translational=FIXED),),
    )
    return _linked(0.0, FIXED, beams=(one.model_copy(update={"masses": (Mass(x=1.0, mass=_MEMBER),)}), two))


def _cantilever(b: float) -> float:
    return math.cos(b) + 1 / math.cosh(b)


def _against(b: float) -> float:
    """Equal cantilevers in opposite phase on the soft spring: each has a spring of twice its stiffness at its tip."""
    above, below = tip()(b)
    return below / SOFT + 2 * above


def _frame(b: float) -> float:
    """The tip of a cantilever, with the mass of the member that stands there, and the member's root turn alike."""
    one, c, s, S = 1 / math.cosh(b), math.cos(b), math.sin(b), math.tanh(b)
    d, t, D, T = (f(_MEMBER * b) for f in (math.cos, math.sin, math.cosh, math.tanh))
    turned, held = s + c * S - _MEMBER * b * (one - c), c + one - _MEMBER * b * (s - c * S)
    return turned * (t - d * T) - held * (d + 1 / D)


def _double_clamped(b: float) -> float:
    return math.cos(2 * b) - 1 / math.cosh(2 * b)


_TOUCHING = Problem(beams=_beams(*OTHER), stops=(Stop(between=("one:1", "two:0"), gap=1e-3, stiffness=SPRING),))
LINKED = {
    "equal cantilevers, soft spring": Linked(
        _linked(SOFT, beams=_beams()),
        (_cantilever, _against),
        f"1 + c C = 0 in phase, and 1 / {SOFT:g} + 2 alpha = 0",
    ),
    "unlike cantilevers, spring": Linked(
        _linked(SPRING, beams=_beams(*OTHER)),
        (joined(SPRING, tip(), tip(*OTHER)),),
        f"1 / {SPRING:g} + alpha_1 + alpha_2 = 0",
    ),
    "unlike cantilevers, hinge": Linked(
        _linked(FIXED, beams=_beams(*OTHER)), (joined(FIXED, tip(), tip(*OTHER)),), "alpha_1 + alpha_2 = 0"
    ),
    "unlike cantilevers, torsional spring": Linked(
        _linked(0.0, TURNING, beams=_beams(*OTHER)),
        (joined(TURNING, tip(turning=True), tip(*OTHER, turning=True)),),
        f"1 / {TURNING:g} + alpha_1 + alpha_2 = 0, turning",
    ),
    "cantilever, hinge, free beam": Linked(
        _linked(FIXED, beams=_beams(*OTHER, free=True)),
        (joined(FIXED, tip(), tip(*OTHER, free=True)),),
        "alpha_1 + alpha_2 = 0, and the free beam turns about its hinge",
        rigid=1,
    ),
    "equal cantilevers, weld": Linked(
        _linked(FIXED, FIXED, beams=_beams()), (_double_clamped,), "cos 2b cosh 2b = 1: one beam, clamped at both ends"
    ),
    "L-shaped frame": Linked(_framed(), (_frame,), f"both turn alike at the corner; mu = l = {_MEMBER:g}"),
    "unlike cantilevers, closed stop": Linked(
        _TOUCHING,
        (joined(SPRING, tip(), tip(*OTHER)),),
        f"1 / {SPRING:g} + alpha_1 + alpha_2 = 0",
        ContactState((0,)),
    ),
    "unlike cantilevers, spring beside a closed stop": Linked(
        _TOUCHING.replace(links=_linked(SPRING, beams=_beams(*OTHER)).links),
        (joined(2 * SPRING, tip(), tip(*OTHER)),),
        f"1 / {2 * SPRING:g} + alpha_1 + alpha_2 = 0",
        ContactState((0,)),
    ),
    "unlike cantilevers, open stop": Linked(
        _TOUCHING,
        (_cantilever, lambda b: tip(*OTHER)(b)[1]),
        "1 + c C = 0 for each",
    ),
}


def frequencies(of: Linked) -> list[float]:
    """The lowest angular frequencies by the equations, rad/s."""
    return sorted([0.0] * of.rigid + [b**2 for equation in of.equations for b in roots(equation)])[:ROOTS]


def run(level: Level, say: Say) -> CaseResult:
    """All pairs of beams, by both solvers."""
    meshes = (24, 48, 96) if level == "full" else (8, 16, 32)
    checks, rows = [], []
    for name, pair in LINKED.items():
        say(name)

        def found(solver: Solver, of: Linked = pair) -> list[float]:
            return [float(w) for w in solver.modes(of.problem, of.state, ROOTS).angular_frequencies]

        fe = zip(*(found(fe_lapjoint.Solver(elements=n)) for n in meshes), strict=True)
        answers = {
            "analytic": [
                Estimate(w, EXACT * w, "roots bracketed by their count, to rounding") for w in found(analytic.Solver())
            ],
            "FE": [refined_estimate(w, 2.0, FE_ORDER, elements(meshes[-1]), ROUNDING_OF_EIGENVALUES) for w in fe],
        }
        for i, w in enumerate(frequencies(pair)):
            true = Estimate(w, EXACT * w, f"{pair.formula}, by brentq to rounding", Kind.ANALYTICAL)
            for solver, own in answers.items():
                checks.append(Check(f"{name}, mode {i + 1}: {solver} against the equation", "1", own[i], true))
            rows.append((name, i + 1, f"{w:.10f}", *(f"{own[i].value:.10f}" for own in answers.values())))
    return CaseResult(
        "linked-beams",
        "Linked beams",
        "Frequencies of two beams joined at their tips by a spring, a hinge, a torsional spring, a weld or a closed "
        "stop, and of an L-shaped frame, each compared with the roots of its characteristic equation, solved apart "
        "from both solvers. Equal beams on a soft spring have pairs of nearly equal frequencies, all of which must be "
        "found.",
        checks=tuple(checks),
        tables=(
            table("Frequencies, in units of the first beam", ("beams", "mode", "equation", "analytic", "FE"), rows),
        ),
        notes=tuple(f"{name}: {pair.formula}" for name, pair in LINKED.items()),
    )
