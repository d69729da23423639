"""Uncertain numbers: their distributions are those of scipy, and what cannot be drawn is refused in one message."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from lapjoint import InputError, paper_joint
from lapjoint.problem.files import from_toml, to_toml
from lapjoint.problem.uncertain import OUTERMOST, Listed, Lognormal, Normal, Triangular, UncertainNumber, Uniform

HEAD = {"name": "gap", "paths": ("stops.*.gap",)}
U = np.array([OUTERMOST, 1e-3, 0.2, 0.5, 0.77, 1 - 1e-3, 1 - OUTERMOST])
SPREAD = np.sqrt(np.log1p(0.3**2))
WITNESSED = [
    (Normal(**HEAD, kind="normal", mean=2.0, deviation=0.5), stats.norm(2.0, 0.5)),
    (Normal(**HEAD, kind="normal", mean=2.0, deviation=0.5, low=1.8), stats.truncnorm(-0.4, np.inf, 2.0, 0.5)),
    (Normal(**HEAD, kind="normal", mean=2, deviation=0.5, low=1, high=2.5), stats.truncnorm(-2.0, 1.0, 2.0, 0.5)),
    (
        Lognormal(**HEAD, kind="lognormal", mean=2.0, deviation=0.6),
        stats.lognorm(SPREAD, 0, 2 * np.exp(-(SPREAD**2) / 2)),
    ),
    (Uniform(**HEAD, kind="uniform", low=-1.0, high=3.0), stats.uniform(-1.0, 4.0)),
    (Triangular(**HEAD, kind="triangular", low=-1.0, mode=0.5, high=3.0), stats.triang(0.375, -1.0, 4.0)),
    (Triangular(**HEAD, kind="triangular", low=0.0, mode=0.0, high=3.0), stats.triang(0.0, 0.0, 3.0)),
]


@pytest.mark.parametrize(("one", "witness"), WITNESSED, ids=lambda it: getattr(it, "kind", ""))
def test_quantiles_are_those_of_the_distribution(one: UncertainNumber, witness: stats.rv_continuous) -> None:
    np.testing.assert_allclose(one.quantiles(U), witness.ppf(U), rtol=1e-7)


def test_a_lognormal_variable_has_the_mean_and_the_deviation_that_are_given() -> None:
    witness = WITNESSED[3][1]
    np.testing.assert_allclose([witness.mean(), witness.std()], [2.0, 0.6])


def test_listed_values_are_equally_likely() -> None:
    one = Listed(**HEAD, kind="list", values=(3.0, 1.0, 2.0))
    drawn = one.quantiles((np.arange(300) + 0.5) / 300)
    assert [int((drawn == value).sum()) for value in (1.0, 2.0, 3.0)] == [100, 100, 100]
    assert one.quantiles(np.array([1 - OUTERMOST])).tolist() == [3.0]


def uncertain(*tables: str) -> str:
    """The text of the joint's file with uncertain numbers."""
    return to_toml(paper_joint()) + "".join(f"\n[[uncertain]]\n{table}\n" for table in tables)


GAP = 'name = "gap"\npaths = ["stops.*.gap"]\n'
NORMAL = 'kind = "normal"\nmean = 1e-3\ndeviation = 1e-4\n'


def test_a_file_with_uncertain_numbers_comes_back_the_same() -> None:
    problem = from_toml(
        uncertain(
            GAP + NORMAL,
            'name = "k"\npaths = ["stops.P2.stiffness"]\napply = "factor"\nkind = "list"\nvalues = [0.9, 1.1]',
        )
    )
    assert [one.name for one in problem.uncertain] == ["gap", "k"]
    assert from_toml(to_toml(problem)) == problem


K = 'name = "k"\npaths = ["stops.*.stiffness"]\nkind = "normal"\nmean = 1e6\ndeviation = 2e5\n'
REFUSED = {
    "nothing by that name": (
        GAP.replace(".gap", ".gapp") + NORMAL,
        "uncertain[0].paths: stops[0].gapp: unknown key; did you mean gap? ",
    ),
    "no such stop": (
        GAP.replace("*", "P9") + NORMAL,
        "uncertain[0].paths[0] = \"stops.P9.gap\": there is no element 'P9'",
    ),
    "no such part": (GAP.replace("stops", "masses") + NORMAL, "leads to nothing; the problem has no such part"),
    "no path": ('name = "gap"\npaths = []\n' + NORMAL, "uncertain[0].paths = []: must have at least 1 value"),
    "leaves what is allowed": (K, "k can be drawn as -2.242e+05, and is refused then: stops[0].stiffness = -22"),
    "how to keep it": (K, "must be greater than 0; low and high cut a normal distribution off"),
    "no word": (GAP.replace('"gap"', '"my gap"') + NORMAL, 'name = "my gap": must be a word'),
    "no kind": (GAP, "uncertain[0].kind: is missing; allowed: list, lognormal, normal, triangular, uniform"),
    "low above high": (GAP + 'kind = "uniform"\nlow = 2\nhigh = 1', "high = 1: must be above low, 2"),
    "a mode outside": (GAP + 'kind = "triangular"\nlow = 1\nmode = 0\nhigh = 2', "mode = 0: must be from low, 1, to"),
    "cut beyond its mean": (GAP + NORMAL + "low = 2e-3", "low = 0.002: must be below the mean, 0.001"),
    "a factor on nothing": (
        GAP.replace("gap", "damping") + 'apply = "factor"\n' + NORMAL,
        'stops.0.damping is not given; apply = "factor" needs a finite number there',
    ),
    "a factor on infinity": (
        'name = "k"\npaths = ["supports.0.torsional"]\napply = "factor"\n' + NORMAL,
        "supports.0.torsional is inf; apply",
    ),
    "no number": (GAP.replace("stops.*.gap", "title") + NORMAL, "must be text"),
    "one value": (GAP + 'kind = "list"\nvalues = [1]', "must have at least 2 values"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_drawn_is_refused_in_one_message(case: str) -> None:
    table, message = REFUSED[case]
    with pytest.raises(InputError) as raised:
        from_toml(uncertain(table))
    assert message in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_field_has_one_uncertain_number_and_a_name_is_there_once() -> None:
    with pytest.raises(InputError) as raised:
        from_toml(uncertain(GAP + NORMAL, GAP.replace("*", "P3") + NORMAL))
    assert str(raised.value).split("\n")[1:] == [
        '  uncertain[1].name = "gap": is there twice',
        '  uncertain[1].paths[0] = "stops.P3.gap": stops.1.gap is moved by gap already; a field has one '
        "uncertain number",
    ]
