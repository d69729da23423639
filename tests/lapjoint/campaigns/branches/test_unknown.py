"""How likely an unknown branch is: against all sets of starts of made populations, and searches of made branches."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from lapjoint.campaigns.branches.unknown import Reached, reached
from lapjoint.problem import FloatArray


def reached_by(draw: tuple[int, ...], leads: dict[str, set[str]], known: set[str]) -> Reached:
    """What random starts reach, each of which leads to the branch of its number."""
    return reached([str(one) for one in draw], [], leads, known)


def unknown_share(draw: tuple[int, ...], shares: FloatArray, leads: dict[str, set[str]], known: set[str]) -> float:
    """The probability that another start leads to a branch to which none of some starts leads."""
    found = known | {str(one) for one in draw}
    for _ in shares:
        found |= {other for one in found for other in leads.get(one, set())}
    return float(sum(share for k, share in enumerate(shares) if str(k) not in found))


@pytest.mark.parametrize("known", [set[str](), {"1"}])
@pytest.mark.parametrize("leads", [{}, {"0": {"2"}, "2": {"0"}}, {"0": {"2"}, "2": {"3"}}])
def test_on_average_over_all_starts_the_probability_is_right(leads: dict[str, set[str]], known: set[str]) -> None:
    """Of n starts it estimates what n - 1 starts leave unknown: to rounding, over all sets of starts."""
    shares, n = np.array([0.4, 0.3, 0.2, 0.1]), 4
    estimated = left = 0.0
    for draw in product(range(4), repeat=n):
        chance = float(np.prod(shares[list(draw)]))
        probability = reached_by(draw, leads, known).probability
        assert probability is not None
        estimated += chance * probability
        left += chance * unknown_share(draw[1:], shares, leads, known)
    assert left > 0
    assert estimated == pytest.approx(left, rel=1e-12)


@pytest.mark.parametrize("n", [10, 50, 200])
@pytest.mark.parametrize("classes", [1, 2, 4, 8, 20, 50, 100, 400])
@pytest.mark.parametrize("large", [0.0, 0.8])
def test_the_bound_holds_in_some_nineteen_of_twenty_searches(n: int, classes: int, large: float) -> None:
    """Branches that are equally likely, alone or beside a large one, are where it holds least; it must not fail in a
    tenth of 2000 searches, three standard errors above the twelfth that would be borne."""
    rng = np.random.default_rng((47, n, classes))
    shares = np.append(np.full(classes, (1 - large) / classes), large)
    counts = rng.multinomial(n, shares, size=2000)
    unknown = ((counts == 0) * shares).sum(axis=1)
    bounds = np.array([Reached(n, 1, alone).bound for alone in range(n + 1)])
    assert (unknown > bounds[(counts == 1).sum(axis=1)] + 1e-12).mean() < 0.1


def test_a_branch_is_alone_if_nothing_leads_there_but_one_start() -> None:
    leads = {"a": {"b"}, "b": {"a", "c"}}
    assert reached(["a"], [], {}, set()) == Reached(1, 1, 1)
    assert reached(["a", "a"], [], {}, set()) == Reached(2, 1, 0)
    assert reached(["a"], [], {}, {"a"}) == Reached(1, 1, 0)
    assert reached(["c"], [], leads, {"a"}) == Reached(1, 1, 0)
    assert reached(["a", "c"], [], leads, set()) == Reached(2, 2, 1)  # c leads nowhere
    assert reached(["c"], ["a"], leads, set()) == Reached(1, 1, 0)
    assert reached(["d", "d", "a"], ["d"], leads, {"b"}) == Reached(3, 2, 0)


def test_a_motion_of_a_branch_that_was_not_followed_is_unknown() -> None:
    assert reached(["a", None, None], [None], {}, {"a"}) == Reached(3, 3, 2)


def test_without_stable_motions_nothing_is_known() -> None:
    nothing = reached([], ["a", None], {}, set())
    assert (nothing.starts, nothing.probability, nothing.bound) == (0, None, 1.0)
    assert Reached(5, 5, 5).bound == 1.0


def test_the_bound_solves_the_binomial_equation() -> None:
    """At the bound, n1 or fewer of N independent starts have a probability of a hundredth."""
    assert Reached(50, 3, 0).bound == pytest.approx(1 - 0.01 ** (1 / 50), rel=1e-12)
    assert Reached(1, 1, 0).bound == pytest.approx(0.99, rel=1e-12)
    p = Reached(4, 2, 1).bound
    assert (1 - p) ** 4 + 4 * p * (1 - p) ** 3 == pytest.approx(0.01, rel=1e-9)
