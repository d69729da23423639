"""Whether a march is bound for an orbit, on linear maps whose whole future is known."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from scipy.linalg import block_diag

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
    matrix = 0.999 * block_diag(*turns)
    watch = HandMade(np.array([[1.0, 0.0, 1.0, 0.0]]), np.array([1.0]))
    deviation = np.array([0.7, 0.0, -0.7, 0.0])
    last = last_failure(watch, matrix, deviation, 3000)
    assert last > 200
    assert_waits(ask(watch, matrix, deviation), last)


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


def test_where_there_is_no_deviation_the_march_is_bound() -> None:
    watch = HandMade(np.eye(2), np.zeros(2))
    assert ask(watch, np.diag([0.9, 0.5]), np.zeros(2)).bound


# --- Switches ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("switch", "most", "given"),
    [
        pytest.param({"spacing": 3.0}, 1.0, {}, id="a third of the way to the next switch of its stop"),
        pytest.param({"rate": 7.0, "spacing": 3.0}, 7.0, {}, id="the same in time at seven times the rate"),
        pytest.param({"curvature": 1.0}, 1 / 3, {}, id="no farther than its rate holds"),
        pytest.param({}, 1.0, {"X": 0.0, "rates": 0.5}, id="half of its rate may change"),
        pytest.param({"rate": 0.0, "curvature": 1.0}, 0.0, {}, id="at grazing there is no room"),
        pytest.param({}, CURVED, {"X": 0.0, "row": 1.0}, id="less of the distance than without switches"),
        pytest.param(None, LINEAR, {"row": 1.0}, id="without switches"),
    ],
)
def test_a_switch_leaves_a_deviation_so_much_room(
    switch: dict[str, float] | None, most: float, given: dict[str, float]
) -> None:
    assert bound(0.99 * most, switch, **given)
    assert not bound(1.01 * most + 1e-9, switch, **given)


def bound(
    size: float, switch: dict[str, float] | None, X: float = 1.0, rates: float = 0.0, row: float = 0.0, **watch: Any
) -> bool:
    """Whether a deviation of one coordinate that halves in each period is bound for an orbit of one switch, or none."""
    given = {"rows": np.full((1, 1), row), "distance": np.ones(1)} | watch
    if switch is not None:
        one = {"rate": 1.0, "curvature": 0.0, "spacing": np.inf} | switch
        switches = Switches(np.array([0.5]), np.zeros(1, dtype=np.intp), *(np.array([value]) for value in one.values()))
        given |= {"switches": switches, "X": np.array([[X]]), "rates": np.array([[rates]])}
    return ask(HandMade(**given), np.array([[0.5]]), np.array([size])).bound


def test_near_its_own_switch_a_stop_may_be_touched() -> None:
    # A deviation of 0.1 takes all of the distance at first, and later half; three shifts reach as far as 0.3.
    for since, expected in ((0.1, True), (0.29, True), (0.31, False)):
        given = {"row": 1.0, "distance": np.array([0.1]), "since": np.array([since])}
        assert bound(0.1, {}, **given) is expected
