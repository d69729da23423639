"""The march of the finite element model: linear flows between switches, with this package's own event handling.

Time is cut into windows.  In each, the linear system of the present contact state is integrated: by its exact flow, or
by `solve_ivp` with one of scipy's own methods and dense output.  `fe_lapjoint.march.events` looks for the first switch
in that motion; there the state is changed, the modal coordinates are mapped, and the next window begins.  A window of
the exact flow in which every stop stays well away from its switch is followed by one of twice the length, up to a third
of the shortest excitation period, so that a slow motion takes few windows.  Any other window is followed by one of the
first length.  `fe_lapjoint.ExactPropagator` is this exact flow as a method of `solve_ivp`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from fe_lapjoint.march.coupled import Coupled, CoupledFlow, flow_from
from fe_lapjoint.march.coupled_modes import acting
from fe_lapjoint.march.crowding import Crowd
from fe_lapjoint.march.gaps import FlowGaps, SolutionGaps
from fe_lapjoint.march.model import Model
from fe_lapjoint.march.peaks import deepest
from fe_lapjoint.march.propagator import Flow
from fe_lapjoint.march.ramp_march import RampMotion, follow
from fe_lapjoint.march.system import SAMPLES, Coordinates, IndexArray, System
from lapjoint.answers import Contact
from lapjoint.answers.contact_state import ContactState
from lapjoint.errors import SolverError
from lapjoint.machine.memory import require
from lapjoint.problem import FloatArray
from lapjoint.solver import Progress

_GAUSS = np.polynomial.legendre.leggauss(7)
"""Points and weights of Gauss' rule on [-1, 1], exact for the polynomials of degree 13 at most of dense output."""
_PIECE = 1000
"""Upper estimate of the memory of a piece of a motion, beside (q, q') at its start, bytes."""
_ACCOUNTED = 1024
"""Number of pieces, of some MB together, between two checks of the memory of all pieces."""
WINDOWS_PER_PERIOD = 3
"""Windows, each of `SAMPLES` steps, in the shorter of the excitation period and the period of the slowest bending."""


@dataclass(frozen=True, slots=True)
class FlowFrom:
    """The coordinates of an exact flow, which is rebuilt at each call: they take a tenth of the flow's memory."""

    system: System
    start: float
    """Start of the flow, s."""
    y: FloatArray
    """(q, q') at the start, kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``."""

    @property
    def flow(self) -> Flow:
        """The flow, bit for bit as it was integrated."""
        return flow_from(self.system, self.start, self.y)

    def __call__(self, t: FloatArray, dt: int = 0) -> FloatArray:
        """The `dt`-th derivative of the modal displacements at times ``(m,)``, shape ``(n, m)``."""
        return self.flow(t, dt)


@dataclass(frozen=True, slots=True)
class LibraryMotion:
    """A motion by dense output of a library method; as `Coordinates`."""

    system: System
    dense: Any
    """scipy's `OdeSolution` of (q, q')."""

    def __call__(self, t: FloatArray, dt: int = 0) -> FloatArray:
        """The `dt`-th derivative (0 to 3) of the modal displacements at times ``(m,)``, shape ``(n, m)``."""
        found = [*self.dense(t).reshape(2, -1, t.size)]
        for order in range(dt - 1):
            found.append(self.system.next_derivative(t, found[order], found[order + 1], order))
        return np.asarray(found[dt])

    def areas(self, end: float) -> FloatArray:
        """The time integral of what the forces of the stops read, from the start to `end`, m s, shape ``(P,)``.

        Gauss' rule takes each step of the method, on which dense output is a polynomial: a step is as short as the fast
        motion after a switch needs.
        """
        edges = np.append(self.dense.ts[self.dense.ts < end], end)
        half = np.diff(edges)[:, None] / 2
        t, w = ((edges[:-1, None] + half) + half * _GAUSS[0]).ravel(), (half * _GAUSS[1]).ravel()
        return np.asarray(self.system.of_forces.read(self, t) @ w)


@dataclass(frozen=True, slots=True)
class Piece:
    """A stretch of the motion in one state, as integrated."""

    state: ContactState
    start: float
    """Start of the piece, s."""
    end: float
    """End of the piece, s."""
    y: FloatArray
    """(q, q') at the start, kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``."""
    coordinates: Coordinates
    """The modal displacements and their derivatives within the piece."""
    switched: int
    """The stop that switches at the end; from the number of stops on a damped stop whose force ends or begins, see
    `Model.after`; -1 if none does."""

    @property
    def flow(self) -> Flow | None:
        """The exact flow, if the method is exact."""
        it = self.coordinates
        return it if isinstance(it, Flow) else it.flow if isinstance(it, FlowFrom) else None

    def kept(self, model: Model) -> Piece:
        """This piece with coordinates that are rebuilt at each call, for later use."""
        if isinstance(self.coordinates, RampMotion):
            return replace(self, coordinates=replace(self.coordinates))  # without its amplitudes
        if not isinstance(self.coordinates, Flow):
            return self
        return replace(self, coordinates=FlowFrom(model.system(self.state), self.start, self.y))


def integrate(model: Model, state: ContactState, t: float, end: float, y: FloatArray) -> LibraryMotion:
    """The motion from `t` to `end`, s, by a library method; `y` is (q, q') at the start, shape ``(2 n,)``.

    A method that stops before the end of the window gives a SolverError.
    """
    system = model.system(state)
    options: dict[str, Any] = {"method": model.method, "rtol": model.rtol, "atol": model.atol}
    if model.method != "DOP853":
        options["jac"] = system.jacobian(t, y) if model.method in ("Radau", "BDF") else system.jacobian
    solution = solve_ivp(system.rates, (t, end), y, dense_output=True, **options)
    if not solution.success:
        raise SolverError(f"solve_ivp with {model.method} stopped at t = {solution.t[-1]:.9g} s: {solution.message}")
    return LibraryMotion(system, solution.sol)


@dataclass(frozen=True)
class March:
    """A motion as pieces and contacts, and its end."""

    model: Model
    pieces: tuple[Piece, ...]
    """All pieces of the motion, or the last alone; see `march`."""
    contacts: tuple[Contact, ...]
    """By start time; empty if the march was not to be recorded."""
    state: ContactState
    """Contact state at the end."""
    y: FloatArray
    """(q, q') at the end, kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``."""
    switches: int
    """How often a stop opened or closed."""

    @property
    def impulses(self) -> FloatArray:
        """Impulse of each stop over the march, N s, shape ``(P,)``."""
        total = np.zeros(self.model.sign.size)
        for contact in self.contacts:
            total[contact.stop] += contact.impulse
        return total


@dataclass
class _LastingContact:
    """A contact that has not ended yet."""

    start: float
    """Start of the contact, s."""
    open_start: bool
    """Whether the stop was closed when the march began."""
    area: float = 0.0
    """Time integral of the penetration so far, m s."""
    deepest: float = 0.0
    """Largest penetration so far, m."""
    work: float = 0.0
    """Energy that a damped stop took so far, J; not a number where the motion has no closed form of it."""


@dataclass
class _PreviousWindow:
    """Switches and rounding errors of the window before, which the search for switches in a window needs."""

    switch: FloatArray
    """Time of the last switch of each stop, or of the start of the march, s, shape ``(P,)``."""
    rounding: FloatArray
    """Rounding error of each gap function in the window before, m, shape ``(P,)``."""
    shift: FloatArray
    """Height of each gap function above 0 when its stop switched, m, shape ``(P,)``; used along ramps."""

    def rounding_until_now(self, rounding: FloatArray, rows: IndexArray | slice) -> FloatArray:
        """The larger of this and the last window's rounding of some gap functions, m: a change of state carries
        rounding over."""
        larger = np.maximum(rounding, self.rounding[rows])
        self.rounding[rows] = rounding
        return larger


def march(
    model: Model,
    state: ContactState,
    y: FloatArray,
    start: float,
    end: float,
    *,
    progress: Progress | None = None,
    record: bool = True,
    peaks: bool = True,
    keep: bool = True,
    max_switches: int = 200_000,
) -> March:
    """March from `start` to `end`, s, in steps from switch to switch.

    `y` holds (q, q') at the start in the modes of `state`, kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``.  `record` says
    whether contacts are listed, `peaks` whether their peak forces, and the energies that damped stops take, are found,
    `keep` whether every piece of the motion is kept, or the last alone.  A SolverError is raised if the integrator
    fails, if there are more than `max_switches` switches, if the switches of one stop crowd
    (`fe_lapjoint.march.crowding`), or if the motion takes too much memory.
    """
    window, longest, size = window_of(model, state), longest_window(model, state, end - start), 0.0
    if keep and model.problem.forces.ramps is None:
        size = require_room(model, (end - start) / max(longest, window))
    step, crowd = window / SAMPLES, Crowd(model, window)
    rows = model.sign.size + len(model.damped)
    previous = _PreviousWindow(np.full(rows, start), np.zeros(rows), np.zeros(rows))
    lasting = {k: _LastingContact(start, True) for k in acting(state).closed}
    pieces: list[Piece] = []
    contacts: list[Contact] = []
    t, switches, done = start, 0, 0
    while t < end or not pieces:
        piece, y, clear = _advance(model, state, t, end, step, y, previous)
        step = min(2 * step, max(longest, window) / SAMPLES) if clear else window / SAMPLES
        if record:
            _account(model, piece, lasting, peaks)
        if not keep:
            pieces.clear()
        pieces.append(piece.kept(model))
        done += 1
        if keep and done % _ACCOUNTED == 0:
            size = require_room(model, done, size)
        t = piece.end
        if piece.switched >= 0:
            row, switches = piece.switched, switches + 1
            k, new = row if row < model.sign.size else model.damped[row - model.sign.size], model.after(state, row)
            if switches > max_switches:
                raise SolverError(f"more than {max_switches} switches before t = {t:.6g} s")
            crowd.add(k, t)
            if not record:
                pass
            elif k in lasting and k not in acting(new):
                contacts.append(_contact(model, k, lasting.pop(k), t, open_end=False))
            elif k not in lasting and k in acting(new):
                lasting[k] = _LastingContact(t, False)
            previous.switch[row] = t
            if row == k and k in model.damped:
                previous.switch[model.sign.size + model.damped.index(k)] = t  # at a touch, the force begins near 0
            S = model.transfer(state, new)
            y = (y.reshape(2, -1) @ S.T).ravel()
            state = new
        if progress is not None and done % 32 == 0:
            progress(t - start, end - start)
    if record:
        contacts += [_contact(model, k, it, end, open_end=True) for k, it in lasting.items()]
    contacts.sort(key=lambda contact: (contact.start, contact.stop))
    return March(model, tuple(pieces), tuple(contacts), state, y, switches)


def require_room(model: Model, pieces: float, before: float = 0.0) -> float:
    """Account for the memory of pieces of a motion, bytes; a SolverError if it is too much.

    See `lapjoint.machine.memory`. `before` is the memory that was accounted for before, bytes.
    """
    modes = model.assembly.free.size
    size = pieces * (_PIECE + 16.0 * modes)
    what = f"{pieces:.3g} pieces of a motion, of {modes} degrees of freedom each,"
    require(size, what, "take a shorter motion, fewer elements, or statistics, which keep sums alone", before)
    return size


def window_of(model: Model, state: ContactState) -> float:
    """First length of a search window, s: a third of the shortest excitation period or of the slow motion's period.

    The slow motion is the first bending of the beam, or the slowest mode that oscillates with all stops closed, if that
    mode is slower: on springs that are soft compared with the beam, the joint swings as a rigid body and hardly bends.
    The mode counts with the frequency that it would have without the masses, about: beside a heavy mass, which moves
    slowly, the beam may rattle as fast as without it.
    The search is by bounds, which hold in a window of any length.  A library method gives no bounds; its windows depend
    on bending alone.
    """
    beam = model.problem.line
    slow = math.sqrt(beam.EI / (beam.m * beam.length**4))
    if model.method == "exact":
        omega = model.undamped(ContactState(tuple(range(model.sign.size)))).omega
        carried = sum(mass.mass + mass.rotary_inertia / beam.length**2 for mass in model.problem.structure.masses)
        lighter = math.sqrt(1 + carried / (beam.m * beam.length))
        slow = min(slow, lighter * float(omega[omega > 0].min(initial=math.inf)))
    return 2 * math.pi / float(max([slow, *model.system(state).driven])) / WINDOWS_PER_PERIOD


def longest_window(model: Model, state: ContactState, duration: float) -> float:
    """Longest search window, s: a third of the shortest excitation period, or the whole march without excitation."""
    periods = [2 * math.pi / omega for omega in model.system(state).driven]
    return float(min(periods) / WINDOWS_PER_PERIOD) if periods else duration


def _advance(
    model: Model, state: ContactState, t: float, end: float, step: float, y: FloatArray, previous: _PreviousWindow
) -> tuple[Piece, FloatArray, bool]:
    """A window of up to `SAMPLES` steps, shorter if a stop switches in it, and (q, q') at its end.

    The last value says whether every stop stays well away from its switch, so that the next window may have steps of
    twice the length.
    """
    system = model.system(state)
    orientation, offset = model.orientation(state), model.offset(state)
    if system.ramps is not None:
        if model.method == "exact":
            return *_advance_on_ramps(model, state, t, end, step * SAMPLES, y, previous), False
        end = min(end, system.ramps.ramps.until(t))  # a library method is started anew at every knot
    count = min(SAMPLES, max(1, math.ceil((end - t) / step)))
    until = min(t + count * step, end)
    if model.method == "exact":
        flow = flow_from(system, t, y)
        time, stop, clear = math.inf, -1, True
        if orientation.size:
            # The flow is valid beyond the end of the window, so the last step may reach beyond it, too.
            grid, z = np.asarray(t + step * np.arange(count + 1.0)), flow.at_grid(step, count)
            h = orientation[:, None] * z - offset[:, None]
            gaps = FlowGaps(flow, orientation, offset, step)
            rows = model.rows(state)
            rounding = previous.rounding_until_now(gaps.rounding, rows)
            time, row = gaps.first_switch(grid, h, rounding, previous.switch[rows] == t)
            stop = _switched(rows, row)
            clear = bool(np.all(h.max(axis=1) <= -gaps.curvature * (2 * step) ** 2 / 8))
        until, stop = (time, stop) if time <= until else (until, -1)
        return Piece(state, t, until, y, flow, stop), flow.at(until), clear
    return *_advance_by_library(model, state, t, until, y, previous), False


def _advance_on_ramps(
    model: Model, state: ContactState, t: float, end: float, window: float, y: FloatArray, previous: _PreviousWindow
) -> tuple[Piece, FloatArray]:
    """A piece over knots of sampled forces, up to a switch at the latest, and (q, q') at its end."""
    knots, last = model.block_at(t)
    motion, rows = RampMotion(model.ramp_form(state, window), knots, t, y), model.rows(state)
    shift, rounding = previous.shift[rows], previous.rounding[rows]
    until, y_end, row = follow(motion, min(end, last) if last > t else end, previous.switch[rows] == t, shift, rounding)
    previous.shift[rows], previous.rounding[rows] = shift, rounding
    return Piece(state, t, until, y, motion, _switched(rows, row)), y_end


def _switched(rows: IndexArray | slice, row: int) -> int:
    """Which of all gap functions switches, from its number among those that may; -1 for none."""
    return row if isinstance(rows, slice) or row < 0 else int(rows[row])


def _advance_by_library(
    model: Model, state: ContactState, t: float, end: float, y: FloatArray, previous: _PreviousWindow
) -> tuple[Piece, FloatArray]:
    """A window integrated by `solve_ivp`, and (q, q') at its end."""
    coordinates, rows = integrate(model, state, t, end, y), model.rows(state)
    gaps = SolutionGaps(model.system(state), coordinates, t, end, model.orientation(state), model.offset(state))
    time, row = math.inf, -1
    if model.sign.size:
        time, row = gaps.first_switch(previous.rounding_until_now(gaps.rounding, rows), previous.switch[rows] == t)
    until = end if row < 0 else time
    at = np.array([until])
    y_end = np.concatenate([coordinates(at, dt)[:, 0] for dt in (0, 1)])
    return Piece(state, t, until, y, coordinates, _switched(rows, row)), y_end


def _account(model: Model, piece: Piece, lasting: dict[int, _LastingContact], peaks: bool) -> None:
    """Add a piece to the area and the depth of the contacts that last through it."""
    if not lasting or piece.end <= piece.start:
        return
    duration = piece.end - piece.start
    if isinstance(piece.coordinates, RampMotion):
        closed, deepest_ = np.zeros(model.sign.size, dtype=bool), np.zeros(model.sign.size)
        for k, contact in lasting.items():
            closed[k], deepest_[k] = True, contact.deepest
        damped = np.array([stop.damping for stop in model.problem.structure.stops])
        area, deepest_, works = piece.coordinates.accounted(piece.end, peaks, closed, damped > 0, deepest_)
        for k, contact in lasting.items():
            contact.deepest = float(deepest_[k])
            if peaks and damped[k]:
                contact.work += float(model.stiffness[k] * works[k, 0] + damped[k] * works[k, 1])
        peaks = False
    elif piece.flow is not None:
        area = piece.flow.integral_at_stops(piece.end)
    elif isinstance(piece.coordinates, LibraryMotion):
        area = piece.coordinates.areas(piece.end)
    for k, contact in lasting.items():
        contact.area += float(model.sign[k] * area[k] - model.gap[k] * duration)
    if not peaks:
        return
    gaps = _gaps(model, piece)
    for k, contact in lasting.items():
        depth = deepest(gaps, k, piece.start, piece.end, float(gaps.rounding[k]))
        contact.deepest = max(contact.deepest, depth)
        if k in model.damped:
            sign, gap, flow, lost = float(model.sign[k]), float(model.gap[k]), piece.flow, math.nan
            if isinstance(flow, CoupledFlow) and flow.system.plain:
                lost = float(model.stiffness[k]) * flow.work_on(k, sign, gap, piece.end)
            contact.work += lost


def _gaps(model: Model, piece: Piece) -> FlowGaps | SolutionGaps:
    """The gap functions of a piece; those of the forces where damped stops are closed."""
    orientation, offset = model.orientation(piece.state), model.offset(piece.state)
    flow, step, system = piece.flow, (piece.end - piece.start) / SAMPLES, model.system(piece.state)
    if isinstance(system, Coupled):
        closed = np.array([-1.0 if k in piece.state else 1.0 for k in range(model.sign.size)])
        system, orientation, offset = system.of_forces, closed * model.sign, closed * model.gap
    if flow is None:
        return SolutionGaps(system, piece.coordinates, piece.start, piece.end, orientation, offset)
    return FlowGaps(flow.of_forces() if isinstance(flow, CoupledFlow) else flow, orientation, offset, step)


def _contact(model: Model, k: int, it: _LastingContact, end: float, *, open_end: bool) -> Contact:
    stiffness = float(model.stiffness[k])
    return Contact(
        stop=k,
        start=it.start,
        end=end,
        impulse=float(model.sign[k])
        * stiffness
        * (it.area if model.problem.structure.stops[k].may_pull else max(it.area, 0.0)),
        peak_force=stiffness * max(it.deepest, 0.0),
        open_start=it.open_start,
        open_end=open_end,
        dissipated=it.work,
    )
