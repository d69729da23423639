"""What an answer to an own problem assumes: the assumptions of the model that apply to the problem."""

from __future__ import annotations

import math
from collections.abc import Iterator

from lapjoint.problem import ModalDamping, NoDamping, Problem, ViscousDamping


def assumptions(problem: Problem) -> list[str]:
    """The assumptions that apply to a problem, each in a sentence or two."""
    return [*_of_beams(problem), _of_damping(problem), *_of_contacts(problem), *_of_excitation(problem)]


def _of_beams(problem: Problem) -> Iterator[str]:
    several = problem.line.several
    it = "Each beam is" if several else "The beam is"
    yield (
        f"{it} slender and linear elastic at any stress (Euler-Bernoulli): small deflections in one plane, no axial "
        "force, no shear deformation, no rotary inertia of its own."
    )
    heights = [piece.section.depth for piece in problem.line.pieces if piece.section is not None]
    if heights:
        times, which = min(beam.length for beam in problem.line.beams) / max(heights), "shortest " * several
        yield f"Slenderness: the {which}beam is {times:.3g} times as long as deep."
    if problem.line.has_sections:
        yield "Stress is that of bending alone, without concentration at steps or holes and without contact pressure."
    if any(math.isinf(s.translational) or math.isinf(s.torsional) for s in problem.structure.supports):
        yield "Supports that are infinitely stiff do not give at all; the others are linear springs."


def _of_damping(problem: Problem) -> str:
    damping = problem.damping
    if isinstance(damping, ModalDamping):
        return (
            "Damping is a ratio in each mode of the present contact state; its forces jump when a stop closes or opens."
        )
    if isinstance(damping, ViscousDamping):
        return "Damping is viscous along the beam, and grows with the velocity relative to the base."
    if isinstance(damping, NoDamping) and not problem.structure.dampers:
        return "Nothing is damped, but by stops that have a damping of their own."
    return "Damping is that of links and beams alone."


def _of_contacts(problem: Problem) -> Iterator[str]:
    stops = problem.structure.stops
    if not stops:
        return
    if any(stop.damping > 0 for stop in stops):
        yield "A stop is a linear spring with a linear damper, at a point; it does not yield, wear or heat up."
    else:
        yield "A stop is a linear spring at a point, without loss of its own; it does not yield or wear."
    yield "Contact forces are normal to the beam: there is no friction, and no sliding along the beam."
    spread = (
        f"Samples of {', '.join(one.name for one in problem.uncertain)} (by --samples) show what their spread changes."
        if problem.uncertain
        else "In a real joint they are seldom known to better than a tenth, and the answer may change by more than "
        "that with them."
    )
    yield f"Gaps and stiffnesses are taken as exact. {spread}"


def _of_excitation(problem: Problem) -> Iterator[str]:
    if problem.excitation_frequency is not None:
        yield "The steady state is the one that the given start leads to; others may exist, and need other starts."
    if problem.records:
        yield "Between its samples the record is a straight line, and after its end nothing is said."
    if problem.random:
        yield "Random excitation is stationary and Gaussian; the motion shown is one realisation of it, by its seed."
    if problem.gravity is None:
        yield "There is no gravity."
