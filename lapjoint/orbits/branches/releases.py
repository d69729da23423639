"""Grazes of damped stops that may not pull: which events appear and vanish together.

A new contact touches, ends its force and opens.  A flight that splits a contact takes the place of the moment at which
the force would begin again.
"""

from __future__ import annotations

from dataclasses import replace

from lapjoint.answers.contact_state import ContactState, stop_of
from lapjoint.orbits.arcs import ContactSequence
from lapjoint.orbits.branches.boundary_problem import BoundaryProblem
from lapjoint.orbits.branches.point import CurvePoint
from lapjoint.problem import FloatArray


def acts(state: ContactState, switch: int) -> bool:
    """Whether a stop k is closed, or the force ~k of a damped stop acts."""
    return switch in state if switch >= 0 else ~switch in state and ~switch not in state.released


def lets_go(point: CurvePoint, switch: int) -> bool:
    """Whether a switch is of a damped stop that may not pull, and so opens after its force has ended."""
    stop = point.problem.arcs(point.u).problem.structure.stops[stop_of(switch)]
    return switch >= 0 and stop.damping > 0 and not stop.may_pull


def vanishing(sequence: ContactSequence, arc: int) -> tuple[range, tuple[int, ...]] | None:
    """The events that vanish with an arc between two events of one stop, and the one that takes their place, if any.

    The force of a damped stop begins again where a flight between two of its contacts vanishes.  None if an event of
    another stop lies between the events that vanish.
    """
    first, last, joining = arc - 1, arc, sequence.joining
    if sequence.stops[first] != sequence.stops[last]:
        last = next((j for j in (arc, arc + 1) if True in joining[j : j + 1]), -1)
        if last < 0:
            return None
        first = last - 2
    same = sequence.states[first] == sequence.states[last + 1]
    return range(first, last + 1), () if same else (~sequence.stops[arc],)


def with_new_release(
    before: CurvePoint, stop: int, i: int, time: float
) -> tuple[BoundaryProblem, FloatArray, int] | None:
    """Equations, unknowns and new arc after a damped stop that may not pull has grazed in arc `i`; None if not known.

    The graze is at `time`, divided by the length of the motion.

    A new contact touches, ends its force and opens.  A new flight takes the place of the moment at which the force
    begins again.
    """
    problem, shares = before.problem, before.shares.tolist()
    sequence, stops = problem.sequence, problem.sequence.stops
    if not acts(sequence.states[i], stop):
        began, order = sum(shares[:i]), (*stops[:i], stop, ~stop, stop, *stops[i:])
        shares[i : i + 1] = [time - began, 0.0, 0.0, shares[i] - (time - began)]
        new, arc = range(i, i + 3), i + 1
    else:
        begins = [k for k in (i - 1, i) if 0 <= k < len(stops) and stops[k] == ~stop]
        begins = [k for k in begins if acts(sequence.states[k + 1], ~stop) and not {k, k + 1} & problem.tied]
        if not begins:
            return None
        i = min(begins, key=lambda k: abs(sum(shares[: k + 1]) - time))
        order = (*stops[:i], stop, stop, *stops[i + 1 :])
        shares[i + 1 : i + 1] = [0.0]
        new, arc = range(i, i + 1), i + 1
    tied = frozenset(k if k < i else k + len(new) for k in problem.tied)
    made = replace(problem, sequence=ContactSequence(sequence.first, order), tied=tied)
    return made, made.packed(before.u[: before.coordinates], shares, before.value), arc
