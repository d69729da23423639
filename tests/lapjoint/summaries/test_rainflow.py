"""Rainflow counts, damage and powers: the standard's example, closed forms, brute force and other formulas."""

from __future__ import annotations

import itertools
import math
from collections import Counter

import fatpack
import numpy as np
import pytest
from settled import amplification
from toy import bar

import analytic
import fe_lapjoint
from lapjoint import Beam, InputError, Problem, statistics
from lapjoint.answers.contact_state import FREE
from lapjoint.answers.dissipation import taken
from lapjoint.figures import plot_exceedance
from lapjoint.problem import FloatArray, SNLine
from lapjoint.problem.files import from_toml, to_toml
from lapjoint.summaries import summarise
from lapjoint.summaries.rainflow import CycleCounter, Places, Rainflow, of_period, turning_parts, turning_points

LINE = SNLine(slope=3.0, reference_range=80e6, reference_cycles=2e6)
JOINT = """
[beam]
length = 0.8
[beam.material]
youngs_modulus = 2.1e11
density = 7850.0
[beam.material.fatigue]
slope = 3.0
reference_range = 80e6
reference_cycles = 2e6
[beam.section]
shape = "rectangle"
breadth = 0.03
height = 0.008
[[supports]]
x = 0.0
translational = inf
torsional = inf
[[stops]]
x = 0.8
side = "top"
gap = {gap}
stiffness = 4000.0
damping = {drag}
[damping]
{damping}
[base_motion]
{base}
"""
MODAL, VISCOUS = 'kind = "modal"\nratio = 0.02', 'kind = "viscous"\ncoefficient = 4.0'
SINE = "amplitude = 4e-3\nangular_frequency = 60.0"


def joint(gap: float = 7.5e-3, drag: float = 0.0, damping: str = MODAL, base: str = SINE) -> Problem:
    return from_toml(JOINT.format(gap=gap, drag=drag, damping=damping, base=base))


def counted(pieces: list[FloatArray]) -> Counter[float]:
    """Number of cycles of each range, rounded to 1e-9, of a series in pieces; of the residue half cycles."""
    rain, found = Rainflow(), Counter[float]()
    closed = [row for piece in pieces for row in rain.take(piece)]
    last, halves = rain.rest()
    for ranges, share in (([*closed, *last], 1.0), (halves, 0.5)):
        for one in ranges:
            found[round(float(one), 9)] += share  # type: ignore[assignment]
    return found


def by_the_standard(values: FloatArray) -> Counter[float]:
    """The same by the three-point rules of ASTM E1049-85, 5.4.4, word by word."""
    found, points, left = Counter[float](), turning_points(values).tolist(), []
    for value in points:
        left.append(value)
        while len(left) >= 3:
            X, Y = abs(left[-1] - left[-2]), abs(left[-2] - left[-3])
            if X < Y:
                break
            if len(left) == 3:
                found[round(Y, 9)] += 0.5  # type: ignore[assignment]
                del left[0]
            else:
                found[round(Y, 9)] += 1
                del left[-3:-1]
    for a, b in itertools.pairwise(left):
        found[round(abs(b - a), 9)] += 0.5  # type: ignore[assignment]
    return found


def test_the_example_of_the_standard_has_its_counts() -> None:
    """ASTM E1049-85 (2017), 5.4.4 and figure 6: cycles of each range of the series A to I."""
    series = np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0])
    assert counted([series]) == {3.0: 0.5, 4.0: 1.5, 6.0: 0.5, 8.0: 1.0, 9.0: 0.5}


@pytest.mark.parametrize("seed", range(8))
def test_pieces_have_the_cycles_of_the_whole_and_of_the_standard(seed: int) -> None:
    rng = np.random.default_rng(seed)
    series = np.round(np.cumsum(rng.normal(size=700)) if seed % 2 else rng.normal(size=700), 2 if seed < 4 else 9)
    cuts = np.sort(rng.integers(0, series.size, 60))
    whole = counted([series])
    assert counted(np.split(series, cuts)) == whole
    assert by_the_standard(series) == whole


def test_a_period_that_repeats_has_the_cycles_of_many_periods() -> None:
    rng = np.random.default_rng(5)
    for _ in range(20):
        series = np.append(rng.normal(size=rng.integers(3, 40)), 0.0)
        series[0] = 0.0
        own = sorted(of_period(series))
        many = Rainflow()
        many.take(np.tile(series[:-1], 4))
        later = sorted(many.take(np.tile(series[:-1], 1)))  # the cycles that close in one more period
        assert later == pytest.approx(own)


def test_a_cubic_finds_the_extrema_of_a_sine_between_its_samples() -> None:
    t = np.arange(0, 200) * 2 * math.pi / 16 + 0.1
    (row,) = turning_parts(t, np.sin(t)[None], np.cos(t)[None])
    assert np.abs(turning_points(row)[1:-1]) == pytest.approx(1.0, abs=1e-4)
    assert turning_points(row).size == 2 + np.floor((t[-1] - math.pi / 2) / math.pi) + 1


def test_the_line_is_that_of_another_program() -> None:
    ranges = np.array([20e6, 30e6, 50e6, 80e6, 200e6])
    with_knee = SNLine(slope=3, reference_range=80e6, reference_cycles=2e6, knee_cycles=1e7, second_slope=5)
    curve = fatpack.BiLinearEnduranceCurve(80e6)  # m1 = 3, Nc = 2e6, m2 = 5, Nd = 1e7 there
    curve.Nd = 1e7
    assert 1 / with_knee.damage(ranges) == pytest.approx(curve.get_endurance(ranges))
    assert with_knee.range_at(with_knee.damage(ranges)) == pytest.approx(ranges)
    endless = SNLine(slope=3, reference_range=80e6, reference_cycles=2e6, knee_cycles=1e7, second_slope=math.inf)
    assert (endless.damage(ranges) > 0).tolist() == [False, False, True, True, True]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"slope": 0.5}, "slope"),
        ({"knee_cycles": 1e7}, "second_slope"),
        ({"knee_cycles": 1e7, "second_slope": 2.0}, "second_slope = 2"),
        ({"reference_range": -1.0}, "reference_range"),
    ],
)
def test_a_wrong_line_is_refused_by_name(changes: dict[str, float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        SNLine(**{"slope": 3.0, "reference_range": 80e6, "reference_cycles": 2e6, **changes})


def test_a_line_is_written_and_read_again() -> None:
    assert from_toml(to_toml(joint())) == joint()
    material = joint().line.pieces[0].material
    assert material is not None
    assert material.fatigue == LINE


@pytest.mark.parametrize(
    "solver", [analytic.Solver(n_modes=6), pytest.param(fe_lapjoint.Solver(elements=8), marks=pytest.mark.thorough)]
)
def test_a_sine_does_the_damage_of_its_closed_form(solver: analytic.Solver | fe_lapjoint.Solver) -> None:
    found = summarise(solver.steady_state(joint(gap=1.0)), at=[0.0, 0.4])
    assert found.fatigue is not None
    assert found.fatigue.errors is not None
    here = found.selection.asked
    twice = 2 * math.sqrt(2) * found.values["stress_rms"][here]
    rate = 60.0 / (2 * math.pi) * (twice / 80e6) ** 3 / 2e6  # f (2 A)^m / K
    assert found.fatigue.values["damage_rate"][here] == pytest.approx(rate, rel=1e-5)
    assert found.fatigue.values["equivalent_range"][here] == pytest.approx(twice, rel=1e-5)
    assert found.fatigue.values["largest_range"][here] == pytest.approx(twice, rel=1e-5)


@pytest.mark.thorough
def test_both_solvers_agree_within_their_errors() -> None:
    both = [summarise(s.steady_state(joint())) for s in (analytic.Solver(n_modes=12), fe_lapjoint.Solver(elements=8))]
    for name in ("damage_rate", "equivalent_range", "largest_range"):
        values, errors = zip(*((it.fatigue.values[name], it.fatigue.errors[name]) for it in both), strict=True)  # type: ignore[union-attr, index]
        assert np.all(np.abs(values[0] - values[1]) <= errors[0] + errors[1])
        assert errors[1][0] < 0.05 * values[1][0]
    for name in ("received_power", "input_power", "damping_power"):
        values, errors = zip(*((it.values[name], it.errors[name]) for it in both), strict=True)  # type: ignore[index]
        assert np.all(np.abs(values[0] - values[1]) <= errors[0] + errors[1])


def test_stretches_have_the_damage_of_the_whole_motion() -> None:
    problem = joint()
    motion = analytic.Solver(n_modes=6).simulate(problem, 1.5, errors=False)
    places, edges = Places(problem, np.array([0.0, 0.4])), np.array([0.0, 0.123, 0.5, 0.501, 1.1, 1.5])
    whole, cut = CycleCounter(places, 4000.0), CycleCounter(places, 4000.0)
    once = whole.take(motion, 0.0, 1.5)
    pieces = [cut.take(motion, a, b, i % 2 == 0) for i, (a, b) in enumerate(itertools.pairwise(edges))]
    assert once is not None
    parts = sum(piece.damage for piece in pieces if piece is not None) + cut.finish().damage
    once.damage += whole.finish().damage
    assert parts == pytest.approx(once.damage, rel=1e-4)


def test_cycles_in_bins_do_the_damage_of_all_cycles_and_are_drawn_where_it_is_largest() -> None:
    problem = joint(base='kind = "random"\npsd = [[4.0, 0.4], [40.0, 0.4]]\nseed = 2')
    found = statistics(problem, duration=20.0, options={"n_modes": 2}, at=[0.2])
    counts, seconds = found.stress_range_count.values, found.attrs["unit_duration"] * found.attrs["units"]
    least, most = (counts @ LINE.damage(found[f"stress_range_{end}"].values) / seconds for end in ("low", "high"))
    assert np.all(least <= found.damage_rate.values * (1 + 1e-9))
    assert np.all(found.damage_rate.values <= most * (1 + 1e-9))
    beyond = found.stress_range_exceedance.values
    assert beyond[:, 0] == pytest.approx(counts.sum(axis=1) / seconds)
    axes = plot_exceedance(found, quantity="stress_range")
    assert [line.get_label() for line in axes.lines] == ["x = 0 m, largest damage", "x = 0.2 m"]
    for line, i in zip(axes.lines, (found.damage_rate.values.argmax(), found.asked.values.argmax()), strict=True):
        drawn = np.isin(found.stress_range_low.values, line.get_xdata())
        assert np.array_equal(line.get_ydata(), beyond[i][drawn])
    with pytest.raises(InputError, match=r"cycles are counted of a material with \[beam.material.fatigue\]"):
        plot_exceedance(found.drop_vars("stress_range_exceedance"), quantity="stress_range")


@pytest.mark.thorough
def test_a_narrow_band_does_the_damage_of_rayleighs_amplitudes() -> None:
    """J. W. Miles, J. Aeronaut. Sci. 21 (1954) 753: nu (2 sqrt(2) s)^m Gamma(1 + m / 2) / K, of a mode with 1 % of
    critical damping.  A wider band does less, down to 0.926 - 0.033 m of it (P. H. Wirsching, M. C. Light, J. Struct.
    Div. 106 (1980) 1593).  Half of the samples are eight a period: a cubic misses (pi / 4)^4 / 384 of the amplitude."""
    problem = joint(
        gap=1.0,
        damping='kind = "modal"\nratio = 0.01',
        base='kind = "random"\npsd = [[4.0, 0.4], [40.0, 0.4]]\nseed = 2',
    )
    solver = analytic.Solver(n_modes=1)
    nu = float(solver.modes(problem, FREE, 1).angular_frequencies[0]) / (2 * math.pi)
    found = statistics(problem, duration=1000.0, options={"n_modes": 1}, at=[0.0])
    s = float(found.stress_rms[0])
    expected = nu * (2 * math.sqrt(2) * s / 80e6) ** 3 / 2e6 * math.gamma(2.5)
    low, high = found.damage_rate_interval.values[0]
    assert low < expected < high / (0.926 - 0.033 * 3)
    assert high < 2 * low
    assert found.damage_rate.attrs["sampling_error"] < 3 * (math.pi / 4) ** 4 / 384
    equivalent = LINE.range_at(found.damage_rate.values)
    assert found.equivalent_range.values == pytest.approx(equivalent)  # once a second: there is no period
    assert float(found.stress_range_count[0].sum()) > nu * 900


@pytest.mark.parametrize(
    ("solver", "seeds"),
    [
        (analytic.Solver(n_modes=6), range(1)),
        pytest.param(analytic.Solver(n_modes=10), range(1, 20), marks=pytest.mark.thorough),
        pytest.param(fe_lapjoint.Solver(elements=6), range(20), marks=pytest.mark.thorough),
    ],
)
def test_a_damped_stop_receives_the_largest_of_dense_sums(
    solver: analytic.Solver | fe_lapjoint.Solver, seeds: range
) -> None:
    """Sums over 20 000 midpoints: of the three lowest modes, which hold the energy, they err by (h w)^2 / 24 < 4e-7."""
    contacts = 0
    for seed in seeds:
        rng = np.random.default_rng([seed, 50])
        problem = joint(rng.uniform(2e-3, 7e-3), 10 ** rng.uniform(-0.5, 1.5), (MODAL, VISCOUS)[seed % 2])
        motion = solver.simulate(problem, rng.uniform(0.3, 0.5), errors=False)
        contacts += len(motion.contacts)
        for contact, (whole, most) in zip(motion.contacts, taken(motion), strict=True):
            t, h = np.linspace(contact.start, contact.end, 20_000, endpoint=False, retstep=True)
            power = -motion.contact_force(t + h / 2)[0] * motion.seen_by_stops(t + h / 2, 1)[0]
            sums = np.cumsum(power) * h
            assert most == pytest.approx(max(sums.max(), 0.0), rel=1e-6)
            assert whole == pytest.approx(sums[-1], abs=1e-6 * most)
    assert contacts >= len(seeds)


def test_a_mass_on_springs_takes_the_power_of_its_closed_form() -> None:
    rigid = Beam(length=1.0, bending_stiffness=1e9, mass_per_length=1.0)
    problem = bar(0.9, (1.0, 1e4), ratio=0.05, amplitude=1e-3, viscous=False).replace(beam=rigid)
    speed = 0.9 * 1e-3 * abs(amplification(0.9, 0.05))
    values = summarise(analytic.Solver(n_modes=3).steady_state(problem)).values
    for name in ("input_power", "damping_power"):  # 2 zeta omega m v^2 / 2, of 1 kg on 1 N/m
        assert values[name] == pytest.approx(0.05 * speed**2, rel=1e-4)


@pytest.mark.parametrize(
    ("solver", "drag"),
    [
        (analytic.Solver(n_modes=8), 0.0),
        pytest.param(analytic.Solver(n_modes=8), 3.0, marks=pytest.mark.thorough),
        pytest.param(fe_lapjoint.Solver(elements=6), 0.0, marks=pytest.mark.thorough),
        pytest.param(fe_lapjoint.Solver(elements=6), 3.0, marks=pytest.mark.thorough),
    ],
)
def test_what_goes_in_comes_out(solver: analytic.Solver | fe_lapjoint.Solver, drag: float) -> None:
    """The work of viscous damping along the beam, and the work that loads the stop, by dense sums."""
    steady = solver.steady_state(joint(drag=drag, damping=VISCOUS))
    values, motion = summarise(steady).values, steady.history
    t = np.linspace(motion.start, motion.end, 20_001)
    x, w = np.polynomial.legendre.leggauss(40)
    along = 4.0 * 0.4 * w @ motion.velocity(0.4 + 0.4 * x, t) ** 2
    assert values["damping_power"][0] == pytest.approx(along.mean(), rel=1e-3)
    work = -motion.contact_force(t)[0] * motion.seen_by_stops(t, 1)[0]
    received = np.maximum(work, 0.0).mean()
    assert values["received_power"][0] == pytest.approx(received, rel=2e-3)
    assert values["dissipated_power"][0] == pytest.approx(work.mean(), abs=1e-3 * received)
