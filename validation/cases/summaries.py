"""Statistics, summaries of steady states and time series of a motion, by plain sums and closed forms.

`lapjoint.statistics` reads a motion in stretches and samples it sparsely.  Here numpy sums up the whole motion, densely
sampled, and takes textbook intervals.  A steady state without contact is a sine of known amplitude; a steady state with
contacts is summed up from its own samples.  Time series of a beam on two pins are compared with the sum over its sines.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

import analytic
from lapjoint import History, Problem, statistics
from lapjoint.answers.series import time_series
from lapjoint.problem import FloatArray
from lapjoint.problem.files import from_toml
from lapjoint.summaries import summarise
from validation.case import CaseResult, Level, Say, number, table
from validation.cases.pinned_beam import LOADED, TRUNCATION, exact
from validation.cases.rigid_bar import SOFT, SPRINGS
from validation.references.pinned_beam import PinnedBeam
from validation.references.shaken_cantilever import ShakenCantilever
from validation.references.summed_up import Touch, of_counts, of_reciprocal_root, scatter, shared, student
from validation.verdict import Check, Criterion, Estimate, Kind

LENGTH, BREADTH, HEIGHT, MODULUS, HEAVY = 0.8, 0.03, 0.008, 2.1e11, 7850.0
"""Length, breadth and height, m, modulus, Pa, and density, kg/m3, of the beam."""
BENDING, MASS = MODULUS * BREADTH * HEIGHT**3 / 12, HEAVY * BREADTH * HEIGHT
LOWEST = 1.875104068711961**2 * math.sqrt(BENDING / MASS) / LENGTH**2
"""Lowest angular frequency of a cantilever, rad/s: R. D. Blevins, Formulas for Natural Frequency and Mode Shape, 1979,
table 8-1."""
DAMPING = 0.05
PLACES = {"mid-span": LENGTH / 2, "three quarters": 0.75 * LENGTH}
SEED, SEEDS, UNITS = 3, 2, 9  # Seed, number of realisations, and units of each realisation
DURATION = 58.0  # Length, s: seven decay times are left out, and `UNITS` of twenty fit in the rest
SOLVER = {"n_modes": 4}
SHAKEN = """
title = "Cantilever between three stops, base and tip shaken at random"
[beam]
length = {length}
material = {{youngs_modulus = {modulus}, density = {heavy}}}
section = {{shape = "rectangle", breadth = {breadth}, height = {height}}}
[[supports]]
x = 0.0
translational = inf
torsional = inf
[[stops]]
x = {length}
side = "top"
gap = 7.5e-3
stiffness = 4000.0
[[stops]]
x = {length}
side = "bottom"
gap = 7e-3
stiffness = 3000.0
[[stops]]
x = {half}
side = "top"
gap = 3.3e-3
stiffness = 20000.0
[damping]
kind = "modal"
ratio = {damping}
[base_motion]
kind = "random"
psd = [[4.0, 0.4], [20.0, 1.2], [60.0, 0.3]]
seed = {seed}
[[point_loads]]
kind = "random"
x = {length}
psd = [[5.0, 1e-3], [40.0, 1e-3]]
seed = {load_seed}
[[point_loads]]
kind = "step"
x = {length}
force = 3.0
"""
LOAD_SEED = 40
DENSE = 4096.0  # Sample rate of the witness, Hz: 11 samples in a period of the fastest of four modes
SPARSE = 64.0
"""Sample rate of the statistics, Hz: six in a period of the slowest mode, so that few samples are near a peak."""
SURE = 4.0  # Largest error by sparse samples, in standard deviations: chance exceeds it once in 16 000 cases
ROUNDING = 1e-9  # Relative rounding between a march evaluated as a whole and in stretches
PEAK = 2e-3  # Relative error of a peak between dense samples, or between samples refined around the largest one
SAME_BATCHES = 0.2  # Relative difference of the widths of intervals from sparse samples and from dense ones
STEADY = ShakenCantilever(length=0.9, stiffness=40.0, mass=0.8, damping=9.0)
GRAVITY, PRESSED_GAP, PRESSED_STIFFNESS, PRESSED_DURATION = 9.81, 1e-3, 3000.0, 24.0
"""Acceleration, m/s2, gap, m, and stiffness, N/m, of the stop on which the beam's weight rests, and time, s: what is
left out of the start, and three units."""
SAG = 1e-6
"""What `SOLVER` leaves out of the sag of a beam: 6e-8 with four modes."""
AMPLITUDE, OMEGA = 2e-3, 37.0  # Amplitude, m, and frequency, rad/s, of the base's motion
TRAPEZOIDS, BY_PARTS = 1000, 1e-6
"""Trapezoids of the part of a contact in one batch, and the relative error of the width of an interval of its impulse:
a part whose force turns by 3 rad is off by the twelfth part of (3 / 1000)^2."""
LEFT_OUT = 1e-4
"""Error of 24 modes and the static residual for a harmonic motion far below the last mode, divided by the largest
number of its kind."""
MIDPOINTS = 2**15  # Number of dense samples of a period: a kink of a force at a switch makes an error of 1e-8
BY_MIDPOINTS = 1e-5  # Relative tolerance of the midpoint sums, a margin over 1e-8
SERIES_RATE, SERIES_DURATION = 700.0, 0.14
"""Sample rate, Hz, and length, s: the phases of the loads do not differ by whole numbers of samples."""


def problem(realisation: int) -> Problem:
    """The joint with the seeds of a realisation."""
    return from_toml(
        SHAKEN.format(
            length=LENGTH,
            half=LENGTH / 2,
            breadth=BREADTH,
            height=HEIGHT,
            modulus=MODULUS,
            heavy=HEAVY,
            damping=DAMPING,
            seed=SEED + realisation,
            load_seed=LOAD_SEED + realisation,
        )
    )


@dataclass(frozen=True)
class Plain:
    """A motion as dense samples, and as its contacts."""

    motion: History
    start: float
    """Time at which the part that counts begins, s."""

    @cached_property
    def t(self) -> FloatArray:
        """Times of the samples, s, shape (m,)."""
        return np.arange(math.ceil(self.start * DENSE), math.floor(self.motion.end * DENSE)) / DENSE

    @cached_property
    def samples(self) -> dict[str, FloatArray]:
        """Samples by the name of the quantity, shape (places, m)."""
        z = {(dx, dt): self.motion.evaluate(np.array(list(PLACES.values())), self.t, dx, dt) for dx, dt in self._needed}
        base = self.motion.problem.base_motion
        assert base is not None
        return {
            "displacement": z[0, 0],
            "velocity": z[0, 1],
            "absolute_acceleration": z[0, 2] + base.at(self.t, 2),
            "moment": BENDING * z[2, 0],
            "stress": -MODULUS * HEIGHT / 2 * z[2, 0],
        }

    _needed = ((0, 0), (0, 1), (0, 2), (2, 0))

    @cached_property
    def forces(self) -> FloatArray:
        """Forces of the stops, N, shape ``(stops, m)``, by gaps and stiffnesses in the file."""
        found = []
        for stop in self.motion.problem.structure.stops:
            z = (1 if stop.side == "top" else -1) * self.motion.displacement(stop.x, self.t)[0]
            found.append(stop.stiffness * np.maximum(z - stop.gap, 0.0))
        return np.array(found)

    @cached_property
    def touches(self) -> list[Touch]:
        """Contacts of the motion."""
        found = []
        for it in self.motion.contacts:
            stop = self.motion.problem.structure.stops[it.stop]
            speed = (1 if stop.side == "top" else -1) * float(self.motion.velocity(stop.x, it.start)[0, 0])
            found.append(Touch(it.stop, it.start, it.end, it.impulse, it.peak_force, speed))
        return found

    def impulses(self, edges: FloatArray, stop: int) -> FloatArray:
        """Impulse of a stop in each batch, N s, shape (units,); of a contact across an edge by trapezoids."""
        found = np.zeros(edges.size - 1)
        it = self.motion.problem.structure.stops[stop]
        for touch in self.touches:
            for i, (a, b) in enumerate(itertools.pairwise(edges)) if touch.stop == stop else ():
                start, end = max(touch.start, a), min(touch.end, b)
                if (start, end) == (touch.start, touch.end):
                    found[i] += touch.impulse
                elif start < end:
                    t = np.linspace(start, end, TRAPEZOIDS + 1)
                    depth = np.maximum(it.sign * self.motion.displacement(it.x, t)[0] - it.gap, 0.0)
                    found[i] += it.sign * it.stiffness * float(np.trapezoid(depth, t))
        return found


QUANTITIES = {
    "displacement": "m",
    "velocity": "m/s",
    "absolute_acceleration": "m/s2",
    "moment": "N m",
    "stress": "Pa",
}


def of_places(found: xr.Dataset, plain: list[Plain], edges: FloatArray) -> Iterator[Check]:
    """Means, root mean squares and peaks, and the intervals of displacements."""
    for p, (where, x) in enumerate(PLACES.items()):
        for name, unit in QUANTITIES.items():
            both = [motion.samples[name][p] for motion in plain]
            squares, off = np.mean([scatter(values**2, 1 / DENSE, 1 / SPARSE) for values in both], axis=0)
            rms = math.sqrt(squares)
            yield close(found, f"{name}_rms", unit, rms, SURE * off / (2 * rms), f"of {where}", x=x)
            if name == "displacement":
                mean, off = np.mean([scatter(values, 1 / DENSE, 1 / SPARSE) for values in both], axis=0)
                yield close(found, f"{name}_mean", unit, float(mean), SURE * float(off), f"of {where}", x=x)
                peak = max(float(np.abs(values).max()) for values in both)
                yield close(found, f"{name}_peak", unit, peak, PEAK * peak, f"of {where}", x=x)
                batches = [batched(m.t, values, edges) for m, values in zip(plain, both, strict=True)]
                ends = sampled(np.concatenate(batches), float(off) / math.sqrt(SEEDS))
                yield wide(found, f"{name}_mean", unit, ends, f"of {where}", SAME_BATCHES, x=x)


def sampled(batches: FloatArray, off: float) -> FloatArray:
    """Student's interval, widened by the error of the mean of sparse samples."""
    low, high = student(batches)
    wider = math.sqrt(1 + batches.size * off**2 / float(np.var(batches, ddof=1)))
    return np.asarray((low + high) / 2 + wider * (high - low) / 2 * np.array([-1.0, 1.0]))


def batched(t: FloatArray, values: FloatArray, edges: FloatArray) -> FloatArray:
    """Means over batches, shape ``(units,)``."""
    return np.array([values[(t >= a) & (t < b)].mean() for a, b in itertools.pairwise(edges)])


def of_stops(found: xr.Dataset, plain: list[Plain], edges: FloatArray) -> Iterator[Check]:
    """Rates, fractions of time, impulses and forces of each stop, with intervals, and the rate of peak forces above
    each edge."""
    unit = edges[1] - edges[0]
    for k, stop in enumerate(plain[0].motion.problem.structure.stops):
        where = f"of stop {k + 1}"
        mine = [[it for it in motion.touches if it.stop == k] for motion in plain]
        begun = [[it for it in touches if it.start >= edges[0]] for touches in mine]
        every = [it for touches in begun for it in touches]
        counts = np.concatenate([np.histogram([it.start for it in touches], edges)[0] for touches in begun])
        times = np.concatenate([shared(touches, edges, k) for touches in mine]) / unit
        impulse = sum(it.impulse for it in every) / (counts.size * unit)
        exact_ones = {
            "contact_rate": ("1/s", counts.mean() / unit),
            "contact_time": ("1", times.mean()),
            "impulse_rate": ("N", impulse),
            "force_peak": ("N", max(it.peak for it in every)),
            "impulse_largest": ("N s", max(abs(it.impulse) for it in every)),
            "impact_speed_largest": ("m/s", max(it.speed for it in every)),
            "contact_duration_largest": ("s", max(it.end - it.start for it in every)),
        }
        for name, (si, value) in exact_ones.items():
            yield close(found, name, si, float(value), ROUNDING * abs(float(value)), where, stop=k)
        squares, off = np.mean([scatter(m.forces[k] ** 2, 1 / DENSE, 1 / SPARSE) for m in plain], axis=0)
        rms = math.sqrt(squares)
        yield close(found, "force_rms", "N", rms, SURE * off / (2 * rms), f"{where} (gap {stop.gap:g} m)", stop=k)
        yield wide(found, "contact_rate", "1/s", of_counts(counts) / unit, where, ROUNDING, stop=k)
        yield wide(found, "contact_time", "1", of_reciprocal_root(times), where, ROUNDING, stop=k)
        impulses = np.concatenate([motion.impulses(edges, k) for motion in plain]) / unit
        yield wide(found, "impulse_rate", "N", of_reciprocal_root(np.abs(impulses)), where, BY_PARTS, stop=k)
        whole = [it for it in every if it.end < edges[-1]]
        for name, sizes in (
            ("peak_force", [it.peak for it in whole]),
            ("impulse", [abs(it.impulse) for it in whole]),
        ):
            reached = np.array(sizes)[:, None] >= found[f"{name}_low"].values
            beyond = reached.sum(axis=0) / (counts.size * unit)
            apart = float(np.abs(found[f"{name}_exceedance"].values[k] - beyond).max())
            a = Estimate(apart, 0.0, "all edges")
            b = Estimate(0.0, 0.5 / (counts.size * unit), "half of one contact", Kind.ANALYTICAL)
            yield Check(f"exceedance of {name.replace('_', ' ')}s {where}, largest difference", "1/s", a, b)


def close(found: xr.Dataset, name: str, unit: str, value: float, u: float, where: str, **at: float) -> Check:
    """A value of the dataset against the value of the plain sums."""
    a = Estimate(float(chosen(found[name], at)), 0.0, "statistics, in stretches")
    return Check(f"{name.replace('_', ' ')} {where}", unit, a, Estimate(value, u, "plain sums", Kind.ANALYTICAL))


def wide(found: xr.Dataset, name: str, unit: str, ends: FloatArray, where: str, share: float, **at: float) -> Check:
    """The width of an interval against the textbook's."""
    low, high = chosen(found[f"{name}_interval"], at).values
    width = float(ends[1] - ends[0])
    a = Estimate(float(high - low), 0.0, "statistics, in stretches")
    b = Estimate(width, share * width, "textbook, from plain sums", Kind.ANALYTICAL)
    return Check(f"{name.replace('_', ' ')} {where}, width of the interval", unit, a, b)


def chosen(values: xr.DataArray, at: dict[str, float]) -> xr.DataArray:
    """The values at a position, or of a stop."""
    return values.sel(at, method="nearest") if "x" in at else values.isel({k: int(v) for k, v in at.items()})


def of_units(found: xr.Dataset) -> Iterator[Check | Criterion]:
    """Length of the units, and of the part that is left out, against the decay time of the slowest mode."""
    decay = 1 / (DAMPING * LOWEST)
    yield Criterion("units", "1", float(found.attrs["units"]), SEEDS * UNITS, SEEDS * UNITS, "as many fit")
    for name, most in (("unit_duration", 20.0), ("settle", 7.0)):
        a = found.attrs[name] / decay
        yield Criterion(f"{name.replace('_', ' ')} over the decay time", "1", a, most * 0.999, 1.5 * most, "as it says")


def pressed() -> Iterator[Check]:
    """A cantilever whose weight presses a stop at its tip all the time: the reaction in closed form, in every unit."""
    joint = from_toml(
        f"[beam]\nlength = {LENGTH}\nbending_stiffness = {BENDING}\nmass_per_length = {MASS}\n"
        "[[supports]]\nx = 0.0\ntranslational = inf\ntorsional = inf\n"
        f'[[stops]]\nx = {LENGTH}\nside = "bottom"\ngap = {PRESSED_GAP}\nstiffness = {PRESSED_STIFFNESS}\n'
        f'[gravity]\nacceleration = {-GRAVITY}\n[damping]\nkind = "modal"\nratio = {DAMPING}\n'
        '[initial]\nkind = "equilibrium"\n'
    )
    found = statistics(joint, duration=PRESSED_DURATION, seeds=1, options=SOLVER)
    sag = GRAVITY * MASS * LENGTH**4 / (8 * BENDING)
    force = (sag - PRESSED_GAP) / (LENGTH**3 / (3 * BENDING) + 1 / PRESSED_STIFFNESS)
    exact = {"force_rms": force, "force_maximum": force, "impulse_rate": -force, "contact_time": 1.0}
    for name, value in exact.items():
        unit = "1" if name == "contact_time" else "N"
        yield close(found, name, unit, value, SAG * abs(value), "of a stop that is always pressed", stop=0)
        for end, found_end in zip(("lower", "upper"), found[f"{name}_interval"].values[0], strict=True):
            a = Estimate(float(found_end), 0.0, "statistics, in stretches")
            b = Estimate(value, SAG * abs(value), "the same in all units", Kind.ANALYTICAL)
            yield Check(f"{name.replace('_', ' ')} of a stop that is always pressed, {end} end", unit, a, b)
    yield close(found, "contact_rate", "1/s", 0.0, 0.0, "of a stop that is always pressed", stop=0)


def steady_without_contact() -> Iterator[Check]:
    """A cantilever under a sine: amplitudes in closed form, against the summary of its steady state."""
    joint = from_toml(
        f"[beam]\nlength = {STEADY.length}\nbending_stiffness = {STEADY.stiffness}\nmass_per_length = {STEADY.mass}\n"
        "[[supports]]\nx = 0.0\ntranslational = inf\ntorsional = inf\n"
        f'[damping]\nkind = "viscous"\ncoefficient = {STEADY.damping}\n'
        f"[base_motion]\namplitude = {AMPLITUDE}\nangular_frequency = {OMEGA}\n"
    )
    steady = analytic.Solver(n_modes=24).steady_state(joint, sensitivity=False)
    L, f, a = STEADY.length, np.array([OMEGA / (2 * math.pi)]), AMPLITUDE * OMEGA**2
    tip, root = (STEADY.answer(f, x, dx)[0] for x, dx in ((L, 0), (0.0, 2)))
    sizes = {
        "displacement": ("m", L, abs(tip) * a),
        "velocity": ("m/s", L, abs(tip) * a * OMEGA),
        "absolute_acceleration": ("m/s2", L, abs(1 - OMEGA**2 * tip) * a),
        "moment": ("N m", 0.0, STEADY.stiffness * abs(root) * a),
    }
    found = summarise(steady, at=[L, 0.0])
    assert found.errors is not None
    for name, (unit, x, size) in sizes.items():
        at = int(np.argmin(np.abs(found.selection.x - x)))
        for what, value in (("peak", size), ("rms", size / math.sqrt(2))):
            key = f"{name}_{what}"
            u = float(found.errors[key][at]) + LEFT_OUT * value
            one = Estimate(float(found.values[key][at]), u, "summary, with its error")
            other = Estimate(value, 0.0, "no modes summed", Kind.ANALYTICAL)
            yield Check(f"steady, {key.replace('_', ' ')} at {x:g} m", unit, one, other)


def steady_with_contacts() -> Iterator[Check]:
    """Bars between stops: the summaries of their steady states against midpoint sums over their periods."""
    joint = from_toml(SPRINGS.format(stiffness=repr(SOFT)))
    steady = analytic.Solver(n_modes=5).steady_state(joint, sensitivity=False, errors=False)
    found, motion = summarise(steady).values, steady.history
    period = motion.end - motion.start
    t = motion.start + (np.arange(MIDPOINTS) + 0.5) * period / MIDPOINTS
    for k, stop in enumerate(joint.structure.stops):
        depth = np.maximum(stop.sign * motion.displacement(stop.x, t)[0] - stop.gap, 0.0)
        begun = [c for c in motion.contacts if c.stop == k and not c.open_start]
        plain = {
            "force_rms": ("N", stop.stiffness * math.sqrt(float(np.mean(depth**2)))),
            "force_peak": ("N", stop.stiffness * float(depth.max())),
            "contact_time": ("1", float(np.mean(depth > 0))),
            "contact_rate": ("1/s", len(begun) / period),
        }
        for name, (unit, value) in plain.items():
            counted = len(begun) / MIDPOINTS if name == "contact_time" else 0.0
            b = Estimate(value, BY_MIDPOINTS * value + counted, f"{MIDPOINTS} midpoints", Kind.ANALYTICAL)
            a = Estimate(float(found[name][k]), 0.0, "summary")
            yield Check(f"steady with contacts, {name.replace('_', ' ')} of stop {k + 1}", unit, a, b)


def series() -> Iterator[Check | Criterion]:
    """Time series of the beam on two pins against its sines, at times that the witness computes itself."""
    joint, beam, places = from_toml(LOADED), PinnedBeam.from_toml(LOADED), (0.3, 0.9)
    motion = analytic.Solver(n_modes=24).simulate(joint, SERIES_DURATION, errors=False)
    names = {"displacement": 0, "velocity": 1, "moment": 3, "shear": 4}
    names_of = dict(zip(names, ("displacement", "velocity", "bending moment", "shear force"), strict=True))
    found = time_series(motion, at=places, quantities=[*names, "stress", "absolute_velocity"], rate=SERIES_RATE)
    count = math.floor(SERIES_RATE * SERIES_DURATION + 1e-9) + 1
    yield Criterion("series, number of times", "1", float(found.sizes["time"]), count, count, "one at each end")
    chosen_times = np.linspace(0, count - 1, 8).astype(int)[1:]
    t = chosen_times / SERIES_RATE
    witness = np.array([[exact(beam, x, when) for when in t] for x in places])
    section, base = beam.tables["beam"]["section"], beam.tables["base_motion"]
    rate = base["amplitude"] * base["angular_frequency"] * np.cos(base["angular_frequency"] * t + base["phase"])
    wanted = {name: witness[:, :, i] for name, i in names.items()}
    wanted["stress"] = -witness[:, :, 3] * 6 / (section["breadth"] * section["height"] ** 2)
    wanted["absolute_velocity"] = witness[:, :, 1] + rate
    for name, values in wanted.items():
        unit = {"displacement": "m", "moment": "N m", "shear": "N", "stress": "Pa"}.get(name, "m/s")
        like = names_of.get(name, "bending moment" if name == "stress" else "velocity")
        u = 2 * TRUNCATION[like] * float(np.abs(values).max())
        for p, x in enumerate(places):
            got = found[name].values[p, chosen_times]
            i = int(np.argmax(np.abs(got - values[p])))
            b = Estimate(float(values[p, i]), u, "sum over the sines, by numpy alone", Kind.ANALYTICAL)
            label = f"series, {name.replace('_', ' ')} at {x:g} m, {t[i]:.4g} s"
            yield Check(label, unit, Estimate(float(got[i]), 0.0, "time series"), b)


def forces(plain: Plain) -> Iterator[Check]:
    """The forces of a series, at the hardest contact of each stop, against the stop's force law."""
    stops = plain.motion.problem.structure.stops
    found = time_series(plain.motion, quantities=["force"], rate=DENSE)["force"].values
    first = round(plain.t[0] * DENSE)
    for k, stop in enumerate(stops):
        i = int(np.argmax(plain.forces[k]))
        value = (-1 if stop.side == "top" else 1) * float(plain.forces[k, i])
        b = Estimate(value, ROUNDING * abs(value), "gap and stiffness of the file", Kind.ANALYTICAL)
        a = Estimate(float(found[k, first + i]), 0.0, "time series")
        yield Check(f"series, force of stop {k + 1} at {plain.t[i]:.5g} s", "N", a, b)


def run(level: Level, say: Say) -> CaseResult:
    """Statistics, steady states and time series."""
    say(f"statistics of {SEEDS} motions")
    found = statistics(
        problem(0),
        duration=DURATION,
        seeds=SEEDS,
        options=SOLVER,
        at=list(PLACES.values()),
        quantities=list(QUANTITIES),
        rate=SPARSE,
    )
    say("the same at once")
    settle = float(found.attrs["settle"])
    edges = np.linspace(settle, DURATION, UNITS + 1)
    solver = analytic.Solver(**SOLVER)
    plain = [Plain(solver.simulate(problem(i), DURATION, errors=False), settle) for i in range(SEEDS)]
    items: list[Check | Criterion] = [*of_units(found), *of_places(found, plain, edges), *of_stops(found, plain, edges)]
    say("steady states and series")
    items += [*pressed(), *steady_without_contact(), *steady_with_contacts(), *series(), *forces(plain[0])]
    checks = tuple(item for item in items if isinstance(item, Check))
    rows = [(c.name, c.unit, c.b.value, c.a.value, number(c.difference, 2), number(c.allowed, 2)) for c in checks]
    return CaseResult(
        "summaries",
        "What is read off a motion",
        "Statistics of two motions at random between three stops, made in stretches, against plain sums over the same "
        "motions as a whole; their intervals against the textbook's; those of a stop that the beam's weight "
        "always presses against its reaction in closed form; a summary of a steady state without contact "
        "against its closed form, and of one with contacts against midpoint sums; time series of a beam on two pins "
        "against the sum over its sines.",
        checks=checks,
        criteria=tuple(item for item in items if isinstance(item, Criterion)),
        tables=(table("Summaries", ("quantity", "unit", "witness", "found", "difference", "allowed"), rows),),
    )
