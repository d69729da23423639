"""One state in closed form, up to the first switch.

Between switches, and between the knots of sampled loads, every stop sees a gap function

    h(s) = Re sum_t c_t exp(lambda_t s) + a0 + a1 s + a2 s^2,    h <= 0,

oriented so that h rising through 0 is the next switch (an open stop closes, a closed stop opens).  No term grows, so
|h'''| <= B = sum |c_t exp(lambda_t s)| |lambda_t|^3 holds from s on.  With h, h', h'' at s, the cubic

    h + h' tau + h'' tau^2 / 2 + B tau^3 / 6

is an upper bound of h(s + tau).  Up to the first root of the cubic no switch is possible: the root is the step.  Near a
switch the steps converge to it cubically, from earlier times; elsewhere the steps are as long as the bound allows.  No
impact, rebound or graze can be stepped over.

Three shortcuts make the search fast and keep the bound.  Far from a switch the high modes need not be summed: they
cannot move h by more than sum |c_t|, and with that sum added to h the cubic of the low modes alone is a bound.  The
terms are turned from step to step by products with tabulated exp(lambda tau); only the last, shortest steps before a
switch, and the end of the march, take a power series or exponentials.  And a stop is not looked at where its cubic of
an earlier step stays below 0 up to the end of the next step.

At a knot of a load the gap functions are continuous, and another closed form begins, see `analytic.march.ramps`: the
search goes on there as within a state.

With -B in place of B the cubic is a lower bound of h(s + tau).  If the lower bound is positive within 1e-13 of the unit
of time of the tables after the step, the switch is bracketed, and the search ends.

Arguments are named as in `analytic.march.gap_function`.
"""

from __future__ import annotations

import math

import numpy as np

from analytic.march.deepest import deepest_of
from analytic.march.gap_function import Rigid, add_rigid, add_terms, add_twisted, at_position, fading_powers
from analytic.march.motion import NO_PROGRESS, NO_SWITCH, PENDING, SLOT, Motion, Work
from analytic.march.ramp_segment import (
    carried_on_ramps,
    interval_at,
    move_body,
    over_knot,
    polynomial_on_ramps,
    start_on_ramps,
    turn_whole,
    up_to_knot,
)
from analytic.march.ramps import LOGGED, RampTables
from analytic.march.step_bound import RESOLUTION, SHARP, crosses, first_root_of_bound, stays_below
from analytic.march.tables import BoolArray, Tables
from analytic.march.terms import (
    SERIES,
    drift_at_stops,
    start_terms,
    state_from_terms,
    tabulated,
    turn_briefly,
    turn_by,
    turn_exactly,
)
from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled.arrays import int_zeros, put, zeros
from lapjoint.compiled.compiling import njit_inner
from lapjoint.problem import FloatArray

_CLOSE = 1e-6
"""Length of a step, over the unit of time, below which all modes are summed at the next look: so close to a switch, the
bound on the modes left out, not the motion, would limit the step."""
_MAX_STEPS = 10_000_000  # most steps in one state, a minute of marching; a motion that goes on takes some hundred
_FIRST_MODES = 5  # modes summed first, then twice as many, and so on: five hold all but some thousandth of a gap
_AHEAD = 8.0
"""How much longer than the nearest stop's step the time is for which another stop is asked whether it can switch: what
is shown once is not looked at again in the next steps."""
UNSEEN = -1  # number of modes summed at a position that is not looked at yet
_LEAST_OF_TERMS = 1e-13
"""Value, relative to the gap plus the sum of all terms' sizes, that a stop which has just switched, and does not leave
0 at once, must exceed before it switches again: 500 times the rounding of that sum."""
_TINY = 1e-300  # m, m/s3: keeps divisions by a bound of 0 finite


@njit_inner()
def follow(
    tables: Tables,
    ramps: RampTables | None,
    motion: Motion,
    work: Work,
    end: float,
    shortest: float,
    depth: bool,
) -> None:
    """Follow the present state up to its first switch, or to `end`, s, at the latest; along ramps to a knot.

    Ramps are loads that are linear between samples, their knots.  Along ramps a closed form holds from knot to knot,
    and the state is left after `LOGGED` knots at the latest.  A state that switches lasts `shortest` seconds at least,
    unless `end` is before.

    `motion` is advanced in place; its pending entry is the stop that switches, NO_SWITCH if none, or NO_PROGRESS if the
    steps ran out.  `work.theta` has the phases at the start, `work.fresh` the stops that have just switched, and
    `work.held` the stops that may not switch in this state.  A fresh stop has to leave 0 at once, or pass a threshold
    of rounding size, before it switches again.  `work.area` takes the time integral of the penetration of each closed
    stop, and, if `depth`, `work.deepest` its deepest penetration.  `ramps.interval`, `ramps.goes_on` and `ramps.shift`
    are changed.
    """
    slot, start, q, v = motion.counts[SLOT], motion.time[0], motion.q, motion.v
    theta, term, poly, area, deepest = work.theta, work.term, work.poly, work.area, work.deepest
    positions, terms, stops = tables.forced.shape[1], tables.terms[slot], area.size
    drift, part = zeros((positions, 3)), zeros((positions, parts_of(terms)))
    theta0, term0 = theta.copy(), term[:terms].copy()
    for k in range(stops):
        area[k] = deepest[k] = 0.0
    base, j, beginning = start, 0, True
    if ramps is None:
        rigid, shift = None, zeros(stops)
        start_terms(tables, slot, theta, q, v, term, poly)
        drift_at_stops(tables, slot, poly, drift)
    else:
        j, beginning = interval_at(ramps, ramps.interval[0], start), not ramps.goes_on[0]
        jerk, body = zeros((positions, ramps.drag.shape[1])), zeros((2, 4))
        rigid, shift = Rigid(jerk, ramps.drag[slot]), ramps.shift
        start_on_ramps(tables, ramps, slot, j, start, theta, q, v, term, body)
    while True:
        until, width, whole = end, end - base, False
        if ramps is not None:
            until, width, whole = up_to_knot(ramps, j, base, end)
            polynomial_on_ramps(tables, ramps, slot, j, base, body, drift, jerk)
        if not beginning:
            bound_parts(tables, slot, term, part)
        put(theta0, theta)
        for k in range(terms):
            term0[k] = term[k]
        s, which, rate = search(
            tables, slot, width, drift, rigid, part, work.fresh, work.held, beginning, shift, theta, term, whole
        )
        if which == NO_PROGRESS:
            motion.time[0], motion.counts[PENDING] = base + s, which
            return
        if ramps is not None and whole and which == NO_SWITCH:
            turn_whole(tables, ramps, slot, theta0, term0, theta, term)
        beginning, ended = False, which != NO_SWITCH or until == end
        leaves = ended or (j + 1) % LOGGED == 0
        add_areas(tables, slot, s, theta0, term0, theta, term, drift, rigid, area)
        for k in range(stops if depth else 0):
            if tables.closed[slot, k] and counts(tables, slot, k):
                so_far, goes_on = deepest[k], not leaves
                deepest[k] = deepest_of(tables, slot, k, s, theta0, term0, drift, rigid, so_far, goes_on)
        if ramps is None:
            break  # without ramps there is no loop to compile, which takes a tenth of the time that all else does
        if not ended:
            base, j = until, j + 1
            over_knot(tables, ramps, slot, j, s, theta, term, body)
        if leaves:
            break
    for k in range(stops):
        if not tables.asleep[slot, k]:  # a stop that may pull has a force of either sign
            area[k] = max(area[k], 0.0)
    if ramps is None:
        wait = min(shortest, end - base) - s
        if which != NO_SWITCH and wait > 0:
            turn_exactly(tables.root[slot], tables.omega, terms, wait, term, theta)
            s += wait
        state_from_terms(tables, slot, theta, s, term, poly, q, v)
    if ended:
        base = end if which == NO_SWITCH else base + s
    if ramps is not None:
        if ended:
            move_body(ramps.drag[slot], s, body)
        carried_on_ramps(tables, ramps, slot, j, base, theta, term, body, q, v)
        ramps.interval[0], ramps.goes_on[0] = j, True
    motion.time[0], motion.time[1], motion.counts[PENDING] = base, rate, which


@njit_inner()
def search(
    tables: Tables,
    slot: int,
    horizon: float,
    drift: FloatArray,
    rigid: Rigid | None,
    part: FloatArray,
    fresh: BoolArray,
    held: BoolArray,
    beginning: bool,
    shift: FloatArray,
    theta: ComplexArray,
    term: ComplexArray,
    at_end: bool,
) -> tuple[float, int, float]:
    """Look for the first switch along one closed form, for `horizon` seconds: its time, s, the stop, and its h', m/s.

    `drift`, ``(U, 3)``, holds the coefficients of 1, s, s^2 of z, m over powers of s; `rigid` is what rigid-body modes
    add under forces that are linear in time; `part`, m, ``(U, parts_of(T))``, bounds the sum of each part of the terms.
    Where a state begins it need not be known: each sum writes it anew, because the terms fade.
    `beginning` says that the state begins here, and does not go on from another closed form: only then `fresh` and
    `held` count.  `shift`, m, ``(P,)``, is how far above 0 each gap function starts, infinite for a stop that may not
    switch; it is written at the beginning of a state, and read where the state goes on.  `theta`, ``(H,)``, and `term`,
    ``(T,)``, are turned to the end; with `at_end` they need not be turned to the horizon if no stop switches, because
    they are known there.
    """
    stops, positions = tables.sign.size, tables.forced.shape[1]
    terms, fastest, twisted = tables.terms[slot], tables.fastest[slot], tables.coupled[slot]
    omega, step, harmonic_turn = tables.omega, tables.step, tables.harmonic_turn
    root, weight, turn, forced = tables.root[slot], tables.weight[slot], tables.turn[slot], tables.forced[slot]
    twist, cube, parts = tables.twist[slot], tables.cube[slot], part.shape[1]
    out, resolution, sharp = zeros((positions, 4)), RESOLUTION * tables.unit, SHARP * tables.unit
    summed, until = int_zeros(positions), zeros(stops)
    s, which, rate, looks, close = 0.0, NO_SWITCH, 0.0, 0, False
    first = 0
    while True:
        for u in range(positions):
            summed[u] = UNSEEN
        begins = beginning and looks == 0
        tau, which, there = horizon - s, NO_SWITCH, False
        for i in range(stops):
            # The stop that was the nearest goes first: others need no look where they do not switch before.
            k = first if i == 0 else (i - 1 if i <= first else i)
            if begins:
                shift[k] = math.inf if held[k] else 0.0
            if shift[k] == math.inf or (i > 0 and until[k] >= s + tau and not begins):
                continue
            # Sum as many modes as it takes to tell that the stop is not near its switch, or all of them.
            u, closed = tables.position[k], tables.closed[slot, k]
            orientation = -tables.sign[k] if closed else tables.sign[k]
            gap = tables.gap[k] if closed else -tables.gap[k]
            if summed[u] == UNSEEN:
                at_position(u, forced, omega, s, theta, drift, out)
                if rigid is not None:
                    add_rigid(rigid, u, s, out)
                summed[u] = 0
            h, left = 0.0, 0.0
            while True:
                if summed[u] > 0:
                    h, left = orientation * out[u, 0] + gap, 0.0
                    for n in range(summed[u], parts):
                        left += part[u, n]
                    every = begins or (close and i == 0)
                    if summed[u] == parts or (h - shift[k] + 3 * left <= 0 and not every):
                        break
                lo, hi = part_of(summed[u], terms)
                if tables.owner is not None and twisted:
                    z, z1, z2, b3, size = add_twisted(weight[u], twist[u], term, root, cube, lo, hi)
                else:
                    z, z1, z2, b3, size = add_terms(weight[u], term, root, cube, lo, hi)
                out[u, 0] += z
                out[u, 1] += z1
                out[u, 2] += z2
                out[u, 3] += b3
                part[u, summed[u]] = size
                summed[u] += 1
            if begins:
                shift[k] = _above(tables, slot, k, fresh[k], out, part, theta)
            h1, h2, b3 = orientation * out[u, 1], orientation * out[u, 2], out[u, 3] + _TINY
            value = min(h - shift[k] + left, 0.0)
            if stays_below(value, h1, h2, b3, min(_AHEAD * tau, horizon - s)):
                until[k] = s + min(_AHEAD * tau, horizon - s)
                continue
            bound = first_root_of_bound(value, h1, h2, b3, tau)
            if tables.owner is not None and rigid is not None and s == 0 and not beginning:
                # where a load has a knot, the velocities that the modes leave out jump
                bound = 0.0 if tables.owner[k] >= 0 and summed[u] == parts and h > shift[k] else bound
            until[k] = s + bound
            if bound < tau:
                tau, which, rate = bound, k, h1
                there = summed[u] == parts and (tau < resolution or crosses(value, h1, h2, b3, tau, sharp))
        if tau <= 0 and which == NO_SWITCH:
            break
        looks += 1
        close = tau < _CLOSE * tables.unit
        if which == NO_SWITCH:
            if not at_end:
                turn_exactly(root, omega, terms, tau, term, theta)
            s = horizon
            break
        if tau * fastest <= SERIES or there or tau < step[-1]:
            turn_briefly(root, omega, terms, fastest, tau, term, theta)
            s += tau
            if there:
                k, u = which, tables.position[which]
                orientation = -tables.sign[k] if tables.closed[slot, k] else tables.sign[k]
                at_position(u, forced, omega, s, theta, drift, out)
                if rigid is not None:
                    add_rigid(rigid, u, s, out)
                if tables.owner is not None and twisted:
                    rate = orientation * out[u, 1]
                    rate += orientation * add_twisted(weight[u], twist[u], term, root, cube, np.int64(0), terms)[1]
                else:
                    rate = orientation * (out[u, 1] + add_terms(weight[u], term, root, cube, np.int64(0), terms)[1])
                break
        else:
            j = tabulated(tau, step)
            turn_by(turn[j], harmonic_turn[j], terms, term, theta)
            s += step[j]
        first = max(which, 0)
        if looks >= _MAX_STEPS:
            which = NO_PROGRESS
            break
    return s, which, rate


@njit_inner(inline="always")
def counts(tables: Tables, slot: int, k: int) -> bool:
    """Whether the penetration of a row is asked for: where the force of a damped stop acts, its own row has none."""
    return tables.owner is None or tables.owner[k] >= 0 or not tables.asleep[slot, k]


@njit_inner(inline="always")
def part_of(n: int, terms: int) -> tuple[int, int]:
    """The first term of part `n` of all terms, and the first beyond it: the first parts are `_FIRST_MODES` long, each
    further one is as long as all before."""
    return (_FIRST_MODES << n) >> 1 if n > 0 else 0, min(_FIRST_MODES << n, terms)


@njit_inner()
def parts_of(terms: int) -> int:
    """Number of parts of the terms; see `part_of`."""
    parts = 1
    while (_FIRST_MODES << (parts - 1)) < terms:
        parts += 1
    return parts


@njit_inner()
def bound_parts(tables: Tables, slot: int, term: ComplexArray, part: FloatArray) -> None:
    """Write to `part`, m, ``(U, parts_of(T))``, a bound on the sum of each part of the terms at each position."""
    for n in range(part.shape[1]):
        lo, hi = part_of(n, tables.terms[slot])
        for u in range(part.shape[0]):
            part[u, n] = 0.0
        for t in range(lo, hi):
            size = math.sqrt(term[t].real ** 2 + term[t].imag ** 2)
            for u in range(part.shape[0]):
                weight = abs(tables.weight[slot, u, t])
                if tables.owner is not None and tables.coupled[slot]:
                    weight = math.sqrt(weight * weight + tables.twist[slot, u, t] ** 2)
                part[u, n] += weight * size


@njit_inner()
def _above(
    tables: Tables, slot: int, k: int, fresh: bool, out: FloatArray, part: FloatArray, theta: ComplexArray
) -> float:
    """How far above 0, m, the gap function of stop `k` starts: states differ by truncation.

    `fresh` says that the stop has just switched.  `out`, ``(U, 4)``, has z and its derivatives; `part`, m, is as in
    `search`.
    """
    u, closed = tables.position[k], tables.closed[slot, k]
    orientation = -tables.sign[k] if closed else tables.sign[k]
    h = orientation * out[u, 0] + (tables.gap[k] if closed else -tables.gap[k])
    above: float = max(h, 0.0)
    size = abs(tables.gap[k])
    for n in range(part.shape[1]):
        size += part[u, n]
    for i in range(theta.size):
        size += abs(tables.forced[slot, u, i])
    threshold = _LEAST_OF_TERMS * size + _TINY
    leaves = orientation * out[u, 1] < -threshold * tables.fastest[slot]  # by more than the rounding of its rate
    if fresh and h - above > -threshold and not leaves:
        above += threshold
    return above


@njit_inner()
def add_areas(
    tables: Tables,
    slot: int,
    s: float,
    theta0: ComplexArray,
    term0: ComplexArray,
    theta: ComplexArray,
    term: ComplexArray,
    drift: FloatArray,
    rigid: Rigid | None,
    area: FloatArray,
) -> None:
    """Add to `area`, m s, ``(P,)``, the time integral of the penetration of each closed stop over one closed form.

    The integral over `s` seconds is that of the antiderivative of every term.  `theta0`, ``(H,)``, and `term0`,
    ``(T,)``, are those at the start; `theta` and `term` those at the end.  `drift` and `rigid` are as in `search`.
    """
    for k in range(area.size):
        if not tables.closed[slot, k] or not counts(tables, slot, k):
            continue
        u = tables.position[k]
        weight, inverse, forced = tables.weight[slot, u], tables.inverse[slot], tables.forced[slot, u]
        z = s * (drift[u, 0] + s * (drift[u, 1] / 2 + s * drift[u, 2] / 3))
        for t in range(tables.terms[slot]):
            change, over = term[t] - term0[t], inverse[t]
            z += weight[t] * (change.real * over.real - change.imag * over.imag)
            if tables.owner is not None:
                z -= tables.twist[slot, u, t] * (change.real * over.imag + change.imag * over.real)
        for h in range(theta.size):
            z -= (forced[h] * (theta[h] - theta0[h])).real / tables.omega[h]
        if rigid is not None:
            for c in range(rigid.drag.size):
                z += rigid.jerk[u, c] * fading_powers(rigid.drag[c], s)[4]
        area[k] += tables.sign[k] * z - tables.gap[k] * s
