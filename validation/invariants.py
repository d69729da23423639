"""Invariants that every motion must satisfy, checked from a History alone.

This witness is independent of the solvers: it knows the problem, and evaluates displacement and velocity anywhere, but
does not know how they were computed.

- energy: d/dt (kinetic + bending + springs and links) = power of base inertia and loads - dissipation.  Under viscous
  damping dissipation is the integral of C z_t^2, and that of a link's damper c times the squared rate of what it
  sees.  Under modal damping it is not local, and only its sign can be checked;
- force law and gaps: every stop that is closed by the contact state is pressed, and no other stop is;
- momentum: the stated impulses of the stops, and all other forces, add up to the change of momentum, and of angular
  momentum; see `validation.momentum`;
- impulse: the stated impulse is the time integral of the force law;
- dissipation: the stated energy lost in a damped stop is the time integral of force times rate, less what the spring
  stores where the history cuts the contact;
- continuity: the displacement does not jump at a switch, equation (36) of the paper.

`validation.orbit_invariants` has what a steady state must satisfy besides.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from lapjoint.answers import Contact, History
from lapjoint.problem import FloatArray, ModalDamping
from validation.momentum import damping_along, momentum_applies, momentum_balance, stretch
from validation.motion_integrals import along_beams, applied, first_panel, panels, time_integral
from validation.verdict import Criterion


def energy(history: History, t: FloatArray) -> FloatArray:
    """Kinetic, bending and spring energy of a motion, links among the springs, but for springs of damped stops.

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
    problem, (x, w) = history.problem, along_beams(history)
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
        for dx, k in enumerate((link.translational, link.torsional)):
            if 0 < k < math.inf:
                total = total + k / 2 * stretch(history, link, t, dx) ** 2
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
    problem, (x, w) = history.problem, along_beams(history)
    velocity = history.evaluate(x, t, dt=1)
    total = np.zeros(t.size)
    for force in problem.forces.every:
        total += force.at(t) * applied(force.shape, x, w, lambda places: history.velocity(places, t))
    # a spring stores what beams and a base that moves towards the stop do; a damped stop is what it does to the beams
    base = history.base_of_stops(t, 1)
    moved = zip(
        problem.structure.stops, history.contact_force(t), history.seen_by_stops(t, 1) - base, base, strict=True
    )
    for stop, force, of_beams, of_base in moved:
        total += force * of_beams if stop.damping > 0 else -force * of_base
    for link in problem.structure.links:
        for dx, c in enumerate((link.damping, link.torsional_damping)):
            if c > 0:
                total -= c * stretch(history, link, t, dx, dt=1) ** 2
    return total - (w * damping_along(problem, x)) @ velocity**2


def impulse_of(stop: int, breaks: FloatArray, history: History, tolerance: float, scale: float) -> tuple[float, float]:
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
    tuple of float
        The impulse, and what its integral leaves open, N s.
    """

    def force(t: FloatArray) -> FloatArray:
        return -np.asarray(history.contact_force(np.minimum(t, history.end))[stop])

    return time_integral(force, breaks, history, tolerance, scale)


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
    t, w = panels(breaks, first_panel(history))
    handled = float(w @ np.abs(power(history, t)))
    scale = max(handled, float(np.max(energy(history, t[:: max(1, t.size // 200)]))), 1e-300)
    supplied, unsure = time_integral(lambda s: power(history, s), breaks, history, tolerance, scale)
    ends = energy(history, np.array([history.start, history.end]))
    surplus, tolerance = (ends[1] - ends[0] - supplied) / scale, tolerance + unsure / scale
    if isinstance(history.problem.damping, ModalDamping):
        reason = "modal damping takes energy and gives none; created energy only within the truncation"
        return Criterion("energy created", "1", float(surplus), -math.inf, tolerance, reason)
    return Criterion("energy unaccounted for", "1", float(surplus), -tolerance, tolerance, "quadrature and truncation")


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
    """Largest difference between a stated impulse and the integral of the force law, beyond what the integral leaves
    open, divided by the largest impulse.

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
            area, unsure = impulse_of(contact.stop, _breaks(history, contact), history, tolerance, largest)
            worst = max(worst, abs(area - contact.impulse) - unsure)
    return Criterion("stated impulse against the force law", "1", worst / largest, 0.0, tolerance, "quadrature")


def _breaks(history: History, contact: Contact) -> FloatArray:
    """First and last time of a contact, and the switches between, s."""
    inside = (history.switch_times > contact.start) & (history.switch_times < contact.end)
    return np.array([contact.start, *history.switch_times[inside], contact.end])


def stated_energies(history: History, tolerance: float) -> Criterion:
    """Largest difference between a stated energy lost in a damped stop and the force law's, beyond what the integral
    leaves open, divided by the largest.

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
    stops, worst = history.problem.stops, 0.0
    largest = max((abs(contact.dissipated) for contact in history.contacts), default=0.0) or 1e-300
    for contact in history.contacts:
        k, lost, unsure = contact.stop, 0.0, 0.0
        if stops[k].damping > 0 and contact.end > contact.start:

            def taken(t: FloatArray, k: int = k) -> FloatArray:
                t = np.minimum(t, history.end)
                return -np.asarray(history.contact_force(t)[k] * history.seen_by_stops(t, 1)[k])

            ends = history.penetration(np.clip([contact.start, contact.end], history.start, history.end))[k]
            stored = stops[k].stiffness / 2 * ends**2 * np.array([contact.open_start, contact.open_end])
            lost, unsure = time_integral(taken, _breaks(history, contact), history, tolerance, largest)
            lost += float(stored[0] - stored[1])
        worst = max(worst, abs(lost - contact.dissipated) - unsure)
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
