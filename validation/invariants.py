"""Invariants that every motion must satisfy, checked from a History alone.

This witness is independent of the solvers: it knows the problem, and evaluates displacement and velocity anywhere, but
does not know how they were computed.

- energy: d/dt (kinetic + bending + springs) = power of base inertia and point loads - dissipation.  Dissipation of
  viscous damping is the integral of C z_t^2, and that of a link's damper c times the squared rate of what it sees.
  Under modal damping it is not local, and only its sign can be checked;
- force law and gaps: every stop that is closed by the contact state is pressed, and no other stop is;
- momentum: if no support is infinitely stiff, and damping is viscous or absent, the impulses of supports, base, point
  loads and drag, and the *stated* impulses of the stops, add up to the change of momentum, and of one beam to that of
  angular momentum;
- impulse: the stated impulse is the time integral of the force law;
- dissipation: the stated energy lost in a damped stop is the time integral of force times rate, less what the spring
  stores where the history cuts the contact;
- continuity: the displacement does not jump at a switch, equation (36) of the paper.

`validation.orbit_invariants` has what a steady state must satisfy besides.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from lapjoint.answers import Contact, History
from lapjoint.problem import FloatArray, ModalDamping, Problem, ViscousDamping
from lapjoint.problem.load_shape import LoadShape
from lapjoint.problem.named_beam import NamedBeam
from lapjoint.problem.structure import PlacedLink
from validation.references.panels import gauss_panels
from validation.verdict import Criterion

_PANELS_X = 24  # Least number of panels along the beam: two for each half wave of the twelfth mode
_MOST_HALVINGS = 8  # Most halvings of the panels in time
_BALANCED = (
    1e-3  # Least angular momentum that counts, divided by all momentum times half the length; a smaller one is rounding
)


def _panels(breaks: FloatArray, per_panel: float, pieces: int = 1) -> tuple[FloatArray, FloatArray]:
    """Gauss points and weights on panels no longer than `per_panel` between the breaks, each cut into `pieces`."""
    edges = [breaks[:1]]
    for a, b in itertools.pairwise(breaks):
        if b > a:
            edges.append(np.linspace(a, b, pieces * max(1, math.ceil((b - a) / per_panel)) + 1)[1:])
    return gauss_panels(np.concatenate(edges), 12)


def _space(history: History) -> tuple[FloatArray, FloatArray]:
    problem = history.problem
    parts = [support.x for support in problem.structure.supports]
    parts += [x for stop in problem.structure.stops for x, _ in stop.reading]
    parts += [x for link in problem.structure.links for x in (link.first, link.second)]
    steps = [mass.x for mass in problem.structure.masses]
    steps += [x for piece in problem.line.pieces for x in (piece.start, piece.end)]
    loads = [x for force in problem.forces.every for x in force.shape.edges]
    L = problem.line.length
    longest = max(beam.length for beam in problem.line.beams)
    x, w = _panels(np.unique([0.0, L, *parts, *steps, *loads]), longest / _PANELS_X)
    on_beams = problem.line.EI_at(x) > 0
    return x[on_beams], w[on_beams]


def _applied(shape: LoadShape, x: FloatArray, w: FloatArray, values: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Sum of a load's forces times `values` at their places, which gives ``(n, ...)``; `x`, `w` is the quadrature."""
    per_length = sum((force * ((x > start) & (x < end)) for start, end, force in shape.pieces), np.zeros(x.size))
    total = np.asarray((w * per_length) @ values(x))
    for place, force in shape.points:
        total = total + force * values(np.array([place]))[0]
    return total


def energy(history: History, t: FloatArray) -> FloatArray:
    """Kinetic, bending and spring energy of a motion, but for springs of damped stops.

    Parameters
    ----------
    history : History
        The motion.
    t : FloatArray, shape (m,)
        Times, s.

    Returns
    -------
    FloatArray, shape (m,)
        Energy, J.
    """
    problem, (x, w) = history.problem, _space(history)
    beam = problem.line
    total = (w * beam.inertia_at(x)) @ history.evaluate(x, t, dt=1) ** 2 / 2
    total = total + (w * beam.EI_at(x)) @ history.evaluate(x, t, dx=2) ** 2 / 2
    for mass in problem.structure.masses:
        total = total + mass.mass / 2 * history.velocity(mass.x, t)[0] ** 2
        total = total + mass.rotary_inertia / 2 * history.evaluate(mass.x, t, dx=1, dt=1)[0] ** 2
    for support in problem.structure.supports:
        if 0 < support.translational < math.inf:
            total = total + support.translational / 2 * history.displacement(support.x, t)[0] ** 2
        if 0 < support.torsional < math.inf:
            total = total + support.torsional / 2 * history.slope(support.x, t)[0] ** 2
    for link in problem.structure.links:
        for derivative, stiffness in enumerate((link.translational, link.torsional)):
            if 0 < stiffness < math.inf:
                total = total + stiffness / 2 * _apart(history, link, t, derivative, 0) ** 2
    for stop, depth in zip(problem.structure.stops, history.penetration(t), strict=True):
        if stop.damping == 0:  # what a damped stop takes and gives back is in `power`
            total = total + stop.stiffness / 2 * np.maximum(depth, 0.0) ** 2
    return np.asarray(total)


def power(history: History, t: FloatArray) -> FloatArray:
    """Power of base inertia, of loads, of damped stops and of stops fixed in space, minus the dissipation of viscous
    damping and of dampers in links.

    Parameters
    ----------
    history : History
        The motion.
    t : FloatArray, shape (m,)
        Times, s.

    Returns
    -------
    FloatArray, shape (m,)
        Power, W.
    """
    problem, (x, w) = history.problem, _space(history)
    velocity = history.evaluate(x, t, dt=1)
    total = np.zeros(t.size)
    for force in problem.forces.every:
        total += force.at(t) * _applied(force.shape, x, w, lambda places: history.velocity(places, t))
    # a spring stores what the beam and a base that moves towards the stop do; a damped stop is what it does to the beam
    for stop, force, base in zip(
        problem.structure.stops, history.contact_force(t), history.base_of_stops(t, 1), strict=True
    ):
        met = sum(factor * history.velocity(x, t)[0] for x, factor in stop.reading)
        total += force * met if stop.damping > 0 else -force * base
    for link in problem.structure.links:
        for derivative, c in enumerate((link.damping, link.torsional_damping)):
            if c > 0:
                total -= c * _apart(history, link, t, derivative, 1) ** 2
    return total - (w * _viscous(problem, x)) @ velocity**2


def _apart(history: History, link: PlacedLink, t: FloatArray, dx: int, dt: int) -> FloatArray:
    """A derivative of the second beam's displacement less that of the first, at a link, ``(m,)``."""
    first, second = history.evaluate(np.array([link.first, link.second]), t, dx=dx, dt=dt)
    return np.asarray(second - first)


def _viscous(problem: Problem, x: FloatArray) -> FloatArray:
    """Viscous damping at positions on the line, m, N s/m2: that of the problem, and of each beam its own; ``(n,)``."""
    everywhere = problem.damping.coefficient if isinstance(problem.damping, ViscousDamping) else 0.0
    found, line = np.zeros(x.size), problem.line
    for start, end, beam in zip(line.starts, line.ends, line.beams, strict=True):
        own = beam.viscous_damping if isinstance(beam, NamedBeam) else 0.0
        found += (everywhere + own) * ((x > start) & (x < end))
    return found


def _first_panel(history: History) -> float:
    whole, fastest = history.end - history.start, history.problem.forces.fastest
    return (min(whole, 2 * math.pi / fastest) if fastest else whole) / 16


def _time_integral(
    function: Callable[[FloatArray], FloatArray], breaks: FloatArray, history: History, tolerance: float, scale: float
) -> float:
    """Integral over time by Gauss panels, halved until three results differ by less than a tenth of the tolerance.

    Two results may agree by chance while fast modes ring.  Panels end at the knots of a record, between which motions
    are smooth.
    """
    breaks = np.unique(np.concatenate([breaks, _knots(history, float(breaks[0]), float(breaks[-1]))]))
    values = [math.inf]
    for halvings in range(_MOST_HALVINGS):
        t, w = _panels(breaks, _first_panel(history), 2**halvings)
        values.append(float(function(t) @ w))
        if np.ptp(values[-3:]) <= 0.1 * tolerance * scale:
            break
    return values[-1]


def impulse_of(stop: int, breaks: FloatArray, history: History, tolerance: float, scale: float) -> float:
    """Impulse of a stop by the force law.

    Parameters
    ----------
    stop : int
        Index of the stop.
    breaks : FloatArray, shape (n,)
        Times, s, from the first to the last of the integral, with all switches between.
    history : History
        The motion.
    tolerance : float
        Largest error of the integral, divided by `scale`.
    scale : float
        Size of the impulse, N s.

    Returns
    -------
    float
        The impulse, N s.
    """

    def force(t: FloatArray) -> FloatArray:
        return -np.asarray(history.contact_force(np.minimum(t, history.end))[stop])

    return _time_integral(force, breaks, history, tolerance, scale)


def _knots(history: History, start: float, end: float) -> FloatArray:
    """Times of the knots of forces that are linear between knots; none if there are more knots than the finest
    panels."""
    ramps = history.problem.forces.ramps
    found = [np.zeros(0)] if ramps is None else [force.knots_within(start, end) for force in ramps.forces]
    knots = np.concatenate(found)
    inside = knots[(knots > start) & (knots < end)]
    return inside if inside.size <= 16 * 2**_MOST_HALVINGS else inside[:0]


def energy_balance(history: History, tolerance: float) -> Criterion:
    """Error of the energy balance, divided by the energy supplied and removed or, if larger, the largest stored energy.

    Parameters
    ----------
    history : History
        The motion.
    tolerance : float
        Largest allowed value, without unit.

    Returns
    -------
    Criterion
        The residual of the balance; under modal damping, whose dissipation is not local, only an excess of energy
        counts.
    """
    breaks = np.unique([history.start, *history.switch_times, history.end])
    t, w = _panels(breaks, _first_panel(history))
    handled = float(w @ np.abs(power(history, t)))
    scale = max(handled, float(np.max(energy(history, t[:: max(1, t.size // 200)]))), 1e-300)
    supplied = _time_integral(lambda s: power(history, s), breaks, history, tolerance, scale)
    ends = energy(history, np.array([history.start, history.end]))
    surplus = (ends[1] - ends[0] - supplied) / scale
    if isinstance(history.problem.damping, ModalDamping):
        reason = "modal damping takes energy and gives none; created energy only within the truncation"
        return Criterion("energy created", "1", float(surplus), -math.inf, tolerance, reason)
    return Criterion("energy unaccounted for", "1", float(surplus), -tolerance, tolerance, "quadrature and truncation")


def momentum_applies(problem: Problem) -> bool:
    """Whether all forces on the beam are known from its motion: no modal damping, and no infinitely stiff support.

    Parameters
    ----------
    problem : Problem
        What is solved.
    """
    fixed = any(
        math.isinf(support.translational) or math.isinf(support.torsional) for support in problem.structure.supports
    )
    return not fixed and not isinstance(problem.damping, ModalDamping)


def _from_middle(length: float) -> Callable[[FloatArray], FloatArray]:
    """The arm of a force about the middle of the beam."""
    return lambda x: x - length / 2


def momentum_balance(history: History, tolerance: float) -> tuple[Criterion, ...]:
    """Errors of the balances of momentum and angular momentum, by the stated impulses, divided by the sum of all parts.

    The angular momentum of several beams depends on where each stands, and is left out.

    Parameters
    ----------
    history : History
        The motion of a problem to which `momentum_applies`.
    tolerance : float
        Largest allowed value, without unit.

    Returns
    -------
    tuple of Criterion
        The two residuals, or that of momentum alone.
    """
    problem, (x, w) = history.problem, _space(history)
    inertia, L, both = problem.line.inertia_at(x), problem.line.length, np.array([history.start, history.end])
    breaks = np.unique([history.start, *history.switch_times, history.end])
    found: list[Criterion] = []
    momentum = 0.0  # sum of the magnitudes of all parts of the momentum balance, kg m/s
    arms: tuple[tuple[str, Callable[[FloatArray], FloatArray], float], ...] = (
        ("momentum", np.ones_like, 0.0),
        ("angular momentum", _from_middle(L), 1.0),
    )
    for name, arm, slope in arms[: 1 if problem.line.several else 2]:

        def force(t: FloatArray, arm: Callable[[FloatArray], FloatArray] = arm, slope: float = slope) -> FloatArray:
            total = np.zeros(t.size)
            for one in problem.forces.every:
                total += one.at(t) * float(_applied(one.shape, x, w, arm))
            for support in problem.structure.supports:
                total -= (
                    support.translational * float(arm(np.asarray(support.x))) * history.displacement(support.x, t)[0]
                )
                total -= support.torsional * slope * history.slope(support.x, t)[0]
            return total - (w * _viscous(problem, x) * arm(x)) @ history.evaluate(x, t, dt=1)

        ends = (w * inertia * arm(x)) @ history.evaluate(x, both, dt=1)
        for mass in problem.structure.masses:
            ends = ends + mass.mass * float(arm(np.asarray(mass.x))) * history.velocity(mass.x, both)[0]
            ends = ends + mass.rotary_inertia * slope * history.evaluate(mass.x, both, dx=1, dt=1)[0]
        readings = [problem.structure.stops[c.stop].reading for c in history.contacts]
        arms_of = [sum(factor * float(arm(np.asarray(at))) for at, factor in reading) for reading in readings]
        stops = [-c.impulse * at for c, at in zip(history.contacts, arms_of, strict=True)]
        amount = float(np.abs(ends).sum() + np.abs(stops).sum())
        scale = max(amount, _BALANCED * (L / 2) ** slope * momentum, 1e-300)
        momentum = max(momentum, amount)
        given = _time_integral(force, breaks, history, tolerance, scale) + sum(stops)
        left = float(ends[1] - ends[0] - given) / scale
        reason = "quadrature and truncation, by the stated impulses"
        found.append(Criterion(f"{name} unaccounted for", "1", left, -tolerance, tolerance, reason))
    return tuple(found)


def gaps(history: History, tolerance: float) -> Criterion:
    """Largest violation of a gap: a closed stop that pulls, or an open stop that is crossed, divided by the motion's
    size.

    Parameters
    ----------
    history : History
        The motion.
    tolerance : float
        Largest allowed value, without unit.

    Returns
    -------
    Criterion
        The depth of the violation, divided by the largest displacement that the stops see.
    """
    problem = history.problem
    if not problem.structure.stops:
        return Criterion("gaps", "1", 0.0, 0.0, tolerance, "there are no stops")
    worst, size = 0.0, 1e-300
    breaks = np.unique([history.start, *history.switch_times, history.end])
    for a, b in itertools.pairwise(breaks):
        t = np.linspace(a, b, 42)[1:-1]
        state = history.state_at((a + b) / 2)
        size = max(size, float(np.abs(history.seen_by_stops(t)).max()))
        for k, beyond in enumerate(history.penetration(t)):
            worst = max(worst, float(np.max(-beyond if k in state else beyond)))
    return Criterion("gap violated", "1", worst / size, 0.0, tolerance, "truncation at switches; event times")


def stated_impulses(history: History, tolerance: float) -> Criterion:
    """Largest difference between a stated impulse and the integral of the force law, divided by the largest impulse.

    Parameters
    ----------
    history : History
        The motion.
    tolerance : float
        Largest allowed value, without unit.

    Returns
    -------
    Criterion
        The largest difference of all contacts, divided by the largest impulse.
    """
    worst, largest = 0.0, max((abs(c.impulse) for c in history.contacts), default=1e-300)
    for contact in history.contacts:
        if contact.end > contact.start:
            area = impulse_of(contact.stop, _breaks(history, contact), history, tolerance, largest)
            worst = max(worst, abs(area - contact.impulse))
    return Criterion("stated impulse against the force law", "1", worst / largest, 0.0, tolerance, "quadrature")


def _breaks(history: History, contact: Contact) -> FloatArray:
    """First and last time of a contact, and the switches between, s."""
    inside = (history.switch_times > contact.start) & (history.switch_times < contact.end)
    return np.array([contact.start, *history.switch_times[inside], contact.end])


def stated_energies(history: History, tolerance: float) -> Criterion:
    """Largest difference between a stated energy lost in a damped stop and the force law's, divided by the largest.

    Parameters
    ----------
    history : History
        The motion.
    tolerance : float
        Largest allowed value, without unit.

    Returns
    -------
    Criterion
        The largest difference of all contacts of damped stops, divided by the largest energy lost in a contact; of a
        stop without damping the whole energy counts as difference.
    """
    stops, worst = history.problem.structure.stops, 0.0
    largest = max((abs(contact.dissipated) for contact in history.contacts), default=0.0) or 1e-300
    for contact in history.contacts:
        k, lost = contact.stop, 0.0
        if stops[k].damping > 0 and contact.end > contact.start:

            def taken(t: FloatArray, k: int = k) -> FloatArray:
                t = np.minimum(t, history.end)
                return -np.asarray(history.contact_force(t)[k] * history.seen_by_stops(t, 1)[k])

            ends = history.penetration(np.clip([contact.start, contact.end], history.start, history.end))[k]
            stored = stops[k].stiffness / 2 * ends**2 * np.array([contact.open_start, contact.open_end])
            lost = _time_integral(taken, _breaks(history, contact), history, tolerance, largest)
            lost += float(stored[0] - stored[1])
        worst = max(worst, abs(lost - contact.dissipated))
    name = "stated energy lost in damped stops against the force law"
    return Criterion(name, "1", worst / largest, 0.0, tolerance, "quadrature")


def continuity(history: History, tolerance: float) -> Criterion:
    """Largest jump of displacement along the beam at a switch, divided by the size of the motion.

    Parameters
    ----------
    history : History
        The motion.
    tolerance : float
        Largest allowed value, without unit.

    Returns
    -------
    Criterion
        The jump, divided by the largest displacement after a switch.
    """
    t = history.switch_times[history.switch_times > history.start]
    if not t.size:
        return Criterion("displacement jump at switches", "1", 0.0, 0.0, tolerance, "no switch")
    x = history.problem.line.grid(21)
    after, before = history.displacement(x, t), history.displacement(x, np.nextafter(t, history.start))
    jump = float(np.abs(after - before).max() / max(np.abs(after).max(), 1e-300))
    return Criterion("displacement jump at switches", "1", jump, 0.0, tolerance, "modes of the two states, truncated")


def witness(history: History, tolerance: float, label: str) -> list[Criterion]:
    """All invariants of a motion.

    Parameters
    ----------
    history : History
        The motion.
    tolerance : float
        Tolerance of all invariants, relative to the size of the motion.
    label : str
        Prefix of each name.

    Returns
    -------
    list of Criterion
        Each with its verdict.
    """
    found = [check(history, tolerance) for check in (energy_balance, gaps, stated_impulses, continuity)]
    if any(stop.damping > 0 for stop in history.problem.stops):
        found.append(stated_energies(history, tolerance))
    if momentum_applies(history.problem):
        found += momentum_balance(history, tolerance)
    return [replace(item, name=f"{label}: {item.name}") for item in found]
