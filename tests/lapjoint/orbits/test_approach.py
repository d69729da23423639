"""Whether a march is bound for an orbit, on linear maps whose whole future is known."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from lapjoint.orbits.approach import CURVED, LINEAR, Forecast, forecast
from lapjoint.orbits.watch import Deviated, Intervals, Switches
from lapjoint.problem import FloatArray

MOST = 100_000


def no_switches() -> Switches:
    none = np.zeros(0)
    return Switches(none, np.zeros(0, dtype=np.intp), none, none, none)


@dataclass
class HandMade:
    """A watch over an orbit whose distances, and whose deviations' motions, are rows of numbers."""

    rows: FloatArray
    """D: what deviations come to in each interval, shape ``(m, n)``."""
    distance: FloatArray
    """|h|, shape ``(m,)``."""
    switches: Switches = field(default_factory=no_switches)
    X: FloatArray | None = None
    """Motion at the stop that switches, shape ``(J, n)``."""
    rates: FloatArray | None = None
    """Its rate, shape ``(J, n)``."""
    since: FloatArray | None = None
    """Time from the one switch there is to each interval, s."""
    seen: list[FloatArray] = field(default_factory=list)
    """Every block of deviations that it was asked about."""

    @property
    def intervals(self) -> Intervals:
        m = self.distance.size
        none, far = np.full(m, -1, dtype=np.intp), np.full(m, np.inf)
        if self.since is None:
            return Intervals(np.zeros(m, dtype=np.intp), self.distance, none, far, none, far)
        return Intervals(np.zeros(m, dtype=np.intp), self.distance, np.zeros(m, dtype=np.intp), self.since, none, far)

    def deviated(self, deviations: FloatArray) -> Deviated:
        self.seen.append(deviations)
        n = deviations.shape[0]
        X = np.zeros((0, n)) if self.X is None else self.X
        rates = np.zeros_like(X) if self.rates is None else self.rates
        return Deviated(np.abs(self.rows @ deviations), X @ deviations, rates @ deviations)


def assert_waits(found: Forecast, last: int) -> None:
    """A march is bound if no period fails, however late; else it is to wait, but not for longer than that."""
    assert found.bound == (last == 0)
    assert found.fails <= last


def ask(watch: HandMade, matrix: FloatArray, deviation: FloatArray, most: int = MOST, size: float = 1.0) -> Forecast:
    vectors = np.linalg.eig(matrix)[1].astype(complex)
    return forecast(watch, matrix, vectors, deviation, size, most)


def last_failure(watch: HandMade, matrix: FloatArray, deviation: FloatArray, periods: int) -> int:
    """By brute force, how many of the first `periods` must pass until all that follow are sound."""
    fails, e = 0, deviation
    share = CURVED if watch.switches.time.size else LINEAR
    for k in range(periods):
        if np.any(np.abs(watch.rows @ e) > share * watch.distance):
            fails = k + 1
        e = matrix @ e
    return fails


@pytest.mark.parametrize(
    "seed", [*range(10), *(pytest.param(seed, marks=pytest.mark.thorough) for seed in range(10, 30))]
)
def test_the_last_period_that_fails_is_that_of_brute_force(seed: int) -> None:
    """Random maps of three real and two complex multipliers, non-normal, with decays from 0.5 to 0.995."""
    rng = np.random.default_rng(seed)
    moduli, angle = rng.uniform(0.5, 0.995, 4), rng.uniform(0, np.pi)
    block = np.zeros((5, 5))
    block[:3, :3] = np.diag(moduli[:3] * rng.choice([-1, 1], 3))
    block[3:, 3:] = moduli[3] * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    basis = rng.standard_normal((5, 5))
    matrix = basis @ block @ np.linalg.inv(basis)
    watch = HandMade(rng.standard_normal((7, 5)), rng.uniform(0.5, 2.0, 7))
    deviation = rng.standard_normal(5) * 10 ** rng.uniform(-2, 2)
    found = ask(watch, matrix, deviation)
    # 0.995^6000 leaves 1e-13 of anything, and these bases enlarge it by some hundred at most.
    assert_waits(found, last_failure(watch, matrix, deviation, 8000))


def test_a_deviation_is_accepted_exactly_where_its_largest_motion_stays_below_the_distance() -> None:
    matrix, row = np.diag([0.9, -0.7]), np.array([[1.0, 1.0]])
    deviation = np.array([0.3, 0.5])
    largest = max(abs(float((row @ np.linalg.matrix_power(matrix, k) @ deviation)[0])) for k in range(100))
    for margin, bound in ((1 + 1e-9, True), (1 - 1e-9, False)):
        found = ask(HandMade(row, np.array([margin * largest / LINEAR])), matrix, deviation)
        assert found.bound is bound


def test_a_transient_that_grows_before_it_decays_is_seen() -> None:
    """A Jordan block but for a hair: from (0, 1) the first coordinate rises to some 18, 50 periods later."""
    matrix = np.array([[0.98, 1.0], [0.0, 0.98001]])
    row, deviation = np.array([[1.0, 0.0]]), np.array([0.0, 1.0])
    path = [float((np.linalg.matrix_power(matrix, k) @ deviation)[0]) for k in range(400)]
    top, when = max(path), int(np.argmax(path))
    assert when > 40
    assert ask(HandMade(row, np.array([1.01 * top / LINEAR])), matrix, deviation).bound
    below = ask(HandMade(row, np.array([0.99 * top / LINEAR])), matrix, deviation)
    assert below.fails == 1 + max(k for k, value in enumerate(path) if value > 0.99 * top)
    assert when < below.fails < when + 40


def test_a_beat_far_in_the_future_is_seen() -> None:
    """Two multipliers that turn almost alike cancel now, and add up 300 periods later."""
    turns = [np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]) for a in (1.0, 1.0 + np.pi / 300)]
    matrix = 0.999 * np.block([[turns[0], np.zeros((2, 2))], [np.zeros((2, 2)), turns[1]]])
    watch = HandMade(np.array([[1.0, 0.0, 1.0, 0.0]]), np.array([1.0]))
    deviation = np.array([0.7, 0.0, -0.7, 0.0])
    found = ask(watch, matrix, deviation)
    last = last_failure(watch, matrix, deviation, 3000)
    assert last > 200
    assert_waits(found, last)


@pytest.mark.parametrize("decay", [0.9, 0.99, 0.999, 0.9999])
def test_no_more_periods_are_looked_at_than_needed_by_a_factor_of_eight(decay: float) -> None:
    """Between the last failure and the bound for all that follows lies the difference of a sum and its parts.

    Here it is a factor of 2 in size, log(2) / -log(decay) periods; blocks double from 16 up to 1024.
    """
    matrix = decay * np.diag([1.0, -1.0])
    watch = HandMade(np.array([[1.0, 1.0]]), np.array([1.0]))
    deviation = np.array([2.0, 2.0])
    found = ask(watch, matrix, deviation)
    needed = np.log(4 / LINEAR) / -np.log(decay)
    assert found.fails == last_failure(watch, matrix, deviation, int(2 * needed) + 10)
    looked_at = sum(block.shape[1] for block in watch.seen if block.shape[1] >= 16)
    assert looked_at <= 8 * needed + 32


def test_what_was_not_looked_at_is_not_known() -> None:
    watch, matrix = HandMade(np.array([[1.0]]), np.array([1.0])), np.array([[0.999]])
    deviation = np.array([100.0])
    needed = last_failure(watch, matrix, deviation, 10_000)
    assert 4000 < needed < 5000
    short = ask(watch, matrix, deviation, most=1000)
    assert not short.bound
    assert 1000 <= short.fails < needed
    enough = ask(watch, matrix, deviation, most=3 * needed)
    assert enough.fails == needed


def test_what_was_sound_so_far_is_not_bound_while_the_rest_is_unknown() -> None:
    """A point on a circle that is seen at quarter turns only, always 45 degrees from where it would touch."""
    matrix = (1 - 1e-9) * np.array([[0.0, -1.0], [1.0, 0.0]])
    watch = HandMade(np.array([[1.0, 0.0]]), np.array([0.85 / LINEAR]))
    found = ask(watch, matrix, np.array([1.0, 1.0]) / np.sqrt(2), most=64)
    assert found == Forecast(1)
    assert not found.bound


def test_blocks_that_double_hold_the_columns_of_one_by_one_iteration() -> None:
    rng = np.random.default_rng(2)
    matrix = 0.997 * np.linalg.qr(rng.standard_normal((4, 4)))[0]
    watch = HandMade(np.ones((1, 4)), np.array([0.5]))
    deviation = rng.standard_normal(4)
    ask(watch, matrix, deviation)
    looked = [block for block in watch.seen if block.shape[1] >= 16]
    together = np.concatenate(looked, axis=1)
    assert together.shape[1] >= 256
    e = deviation
    for k in range(together.shape[1]):
        # Squares of the matrix round otherwise than its steps do.
        assert together[:, k] == pytest.approx(e, abs=1e-11)
        e = matrix @ e


def test_an_eigenbasis_that_is_none_settles_nothing_but_what_has_died_away() -> None:
    """A true Jordan block has too few eigenvectors; it is iterated until rounding is left."""
    matrix = np.array([[0.9, 1.0], [0.0, 0.9]])
    vectors = np.array([[1.0, -1.0], [0.0, 0.0]], dtype=complex)
    watch = HandMade(np.eye(2), np.array([1e3, 1e3]))
    found = forecast(watch, matrix, vectors, np.array([0.0, 1.0]), 1.0, MOST)
    assert found.bound
    # 0.9^k k is below 1e-13 from k = 340 on.
    assert 340 <= sum(block.shape[1] for block in watch.seen if block.shape[1] >= 16) <= 1024
    assert not forecast(watch, matrix, vectors, np.array([0.0, 1.0]), 1.0, 128).bound


def test_no_deviation_is_bound_at_once() -> None:
    watch = HandMade(np.eye(2), np.zeros(2))
    assert ask(watch, np.diag([0.9, 0.5]), np.zeros(2)).bound


# --- Switches ------------------------------------------------------------------------------------------------------


def one_switch(rate: float = 1.0, curvature: float = 0.0, spacing: float = np.inf) -> Switches:
    return Switches(
        np.array([0.5]), np.zeros(1, dtype=np.intp), np.array([rate]), np.array([curvature]), np.array([spacing])
    )


def bound(size: float, switches: Switches, X: float = 1.0, rates: float = 0.0, **watch: FloatArray) -> bool:
    """Whether a deviation of one coordinate that halves in each period is bound for an orbit of one switch."""
    given = {"rows": np.zeros((1, 1)), "distance": np.ones(1)} | watch
    made = HandMade(switches=switches, X=np.array([[X]]), rates=np.array([[rates]]), **given)  # type: ignore[arg-type]
    return ask(made, np.array([[0.5]]), np.array([size])).bound


def test_a_switch_keeps_away_from_the_next_one_of_its_stop() -> None:
    assert bound(0.99, one_switch(spacing=3.0))
    assert not bound(1.01, one_switch(spacing=3.0))
    assert bound(0.99 * 7, one_switch(rate=7.0, spacing=3.0))  # the shift in time is what counts
    assert not bound(1.01 * 7, one_switch(rate=7.0, spacing=3.0))


def test_a_switch_is_crossed_at_a_rate_that_hardly_changes() -> None:
    assert bound(0.99 / 3, one_switch(curvature=1.0))
    assert not bound(1.01 / 3, one_switch(curvature=1.0))
    assert bound(0.99, one_switch(), X=0.0, rates=0.5)
    assert not bound(1.01, one_switch(), X=0.0, rates=0.5)


def test_a_switch_at_grazing_settles_nothing() -> None:
    assert not bound(1e-9, one_switch(rate=0.0, curvature=1.0))
    assert bound(0.0, one_switch(rate=0.0, curvature=1.0))  # no deviation shifts nothing


def test_near_its_own_switch_a_stop_may_be_touched() -> None:
    rows, distance = np.ones((1, 1)), np.array([0.1])  # a deviation of 0.1 takes all of it at first, later half
    for since, expected in ((0.1, True), (0.29, True), (0.31, False)):  # three shifts reach as far as 0.3
        given = {"rows": rows, "distance": distance, "since": np.array([since])}
        assert bound(0.1, one_switch(), **given) is expected


def test_orbits_with_switches_are_given_less_room() -> None:
    rows, distance = np.ones((1, 1)), np.ones(1)
    assert bound(0.99 * CURVED, one_switch(), X=0.0, rows=rows, distance=distance)
    assert not bound(1.01 * CURVED, one_switch(), X=0.0, rows=rows, distance=distance)
    assert ask(HandMade(rows, distance), np.array([[0.5]]), np.array([0.99 * LINEAR])).bound
    assert not ask(HandMade(rows, distance), np.array([[0.5]]), np.array([1.01 * LINEAR])).bound
