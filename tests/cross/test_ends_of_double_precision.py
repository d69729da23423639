"""Problems with one number at the ends of double precision: an answer without NaN, or one message, and no traceback."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from command_line import run

ENDS = [
    s * 10.0**e for e in (-308, -200, -150, -100, -50, -30, -16, 16, 30, 50, 100, 150, 200, 308) for s in (1.0, -1.0)
]
ENDS += [5e-324, 1.7e308, -5e-324, -1.7e308]
FIXED = {"x": 0.0, "translational": math.inf, "torsional": math.inf}
TIP = {"x": 1.0, "side": "top", "gap": 1e-3, "stiffness": 1e4}
PLAIN = {"length": 1.0, "bending_stiffness": 450.0, "mass_per_length": 2.4}
STEEL = {"youngs_modulus": 2.1e11, "density": 7800.0}
SINE = {"amplitude": 2e-3, "angular_frequency": 60.0, "phase": 0.1}
WAVE = [math.sin(0.3 * i) for i in range(40)]
HARMONIC = {"multiple": 2, "phase": 0.1}
PROBLEMS: dict[str, dict[str, Any]] = {
    "sine": {
        "beam": PLAIN,
        "supports": [FIXED],
        "stops": [TIP],
        "damping": {"kind": "modal", "ratio": 0.05},
        "base_motion": SINE,
    },
    "viscous": {
        "beam": {"length": 1.0, "material": STEEL, "section": {"shape": "rectangle", "breadth": 0.02, "height": 0.01}},
        "supports": [FIXED, {"x": 0.7, "translational": 1e5, "torsional": 10.0}],
        "stops": [TIP, TIP | {"x": 0.6, "side": "bottom", "gap": 0.0}],
        "damping": {"kind": "viscous", "coefficient": 3.0},
        "base_motion": {
            "kind": "harmonics",
            "angular_frequency": 40.0,
            "harmonics": [{"multiple": 1, "amplitude": 1e-3, "phase": 0.0}, HARMONIC | {"amplitude": 1e-4}],
        },
    },
    "record": {
        "beam": PLAIN,
        "supports": [FIXED],
        "stops": [TIP],
        "damping": {"kind": "modal", "ratio": [0.05, 0.02]},
        "base_motion": {"kind": "record", "quantity": "acceleration", "values": WAVE, "rate": 300.0, "remove": "drift"},
        "initial": {"kind": "polynomial", "displacement": [0.0, 0.0, 1e-3], "velocity": [0.0, 0.0, 0.1]},
    },
    "displacement": {
        "beam": PLAIN,
        "supports": [FIXED],
        "stops": [TIP],
        "base_motion": {
            "kind": "record",
            "quantity": "displacement",
            "values": WAVE,
            "times": [0.003 * i for i in range(40)],
            "unit": "mm",
        },
    },
    "loads": {
        "beam": {
            "length": 1.0,
            "material": STEEL,
            "section": {"shape": "tube", "outer_diameter": 0.02, "inner_diameter": 0.018},
        },
        "supports": [{"x": 0.0, "translational": math.inf}, {"x": 1.0, "translational": math.inf}],
        "stops": [TIP | {"x": 0.5}, TIP | {"x": 0.5, "side": "bottom"}],
        "damping": {"kind": "modal", "ratio": 0.02},
        "point_loads": [
            {"kind": "step", "x": 0.3, "force": 2.0},
            {"kind": "sine", "x": 0.6, "force": 20.0, "angular_frequency": 80.0, "phase": 0.2},
            {"kind": "harmonics", "x": 0.5, "angular_frequency": 80.0, "harmonics": [HARMONIC | {"force": 1.0}]},
        ],
        "initial": {
            "kind": "sampled",
            "x": [0.0, 0.25, 0.5, 0.75, 1.0],
            "displacement": [0.0, 1e-4, 2e-4, 1e-4, 0.0],
            "velocity": [0.0, 0.01, 0.02, 0.01, 0.0],
        },
    },
    "random": {
        "beam": PLAIN,
        "supports": [FIXED],
        "stops": [TIP],
        "damping": {"kind": "modal", "ratio": 0.05},
        "base_motion": {"kind": "random", "psd": [[5.0, 1.0], [50.0, 2.0]], "seed": 3},
    },
    "free": {
        "beam": {"length": 1.0, "material": STEEL, "section": {"shape": "circle", "diameter": 0.02}},
        "stops": [TIP | {"x": 0.2}],
        "point_loads": [{"kind": "record", "x": 0.4, "values": WAVE, "rate": 300.0, "unit": "N"}],
    },
}
Place = tuple[str | int, ...]
SOLVERS = {"analytic": ("--n-modes", "6"), "fe": ("--n-modes", "6", "--elements", "8")}
COMMANDS = {"modes": (), "simulate": ("--duration", "0.1"), "steady": ()}
NO_NUMBER = re.compile(r"(?<![a-z])(nan|inf)(?![a-z])", re.IGNORECASE)


def numbers(table: Any, place: Place = ()) -> Iterator[Place]:
    """Where a problem has numbers; of samples, the first few."""
    for key, value in table.items() if isinstance(table, dict) else enumerate(table[:8]):
        if isinstance(value, dict | list):
            yield from numbers(value, (*place, key))
        elif isinstance(value, float):
            yield (*place, key)


def put(table: Any, place: Place, value: float) -> Any:
    """The same with another number."""
    if not place:
        return value
    items = table.items() if isinstance(table, dict) else enumerate(table)
    made = {key: put(it, place[1:], value) if key == place[0] else it for key, it in items}
    return made if isinstance(table, dict) else list(made.values())


def drawn() -> list[tuple[str, Place, float]]:
    """All problems of this kind, shuffled."""
    all_ = [(name, place, end) for name, table in PROBLEMS.items() for place in numbers(table) for end in ENDS]
    return [all_[i] for i in np.random.default_rng(0).permutation(len(all_))]


def check(tmp_path: Path, name: str, place: Place, end: float) -> None:
    path = tmp_path / "problem.toml"
    path.write_text(tomli_w.dumps(put(PROBLEMS[name], place, end)))
    for solver, options in SOLVERS.items():
        for command, more in COMMANDS.items():
            what = f"{name}: {'.'.join(map(str, place))} = {end!r}, {command} by {solver}"
            with warnings.catch_warnings():
                warnings.simplefilter("error", RuntimeWarning)
                result = run(command, path, "--solver", solver, *options, *more)
            assert isinstance(result.exception, SystemExit | None), f"{what}: {result.exception!r}"
            assert result.exit_code in (0, 1, 2), what
            assert not NO_NUMBER.search(result.stdout), f"{what}: {result.stdout}"
            if result.exit_code:
                assert "lapjoint: " in result.stderr or "Within the effort allowed" in result.stdout, what
            if result.exit_code == 2 and command == "modes":
                return  # the problem itself is refused, by all alike


@pytest.mark.parametrize("case", drawn()[:20], ids=lambda case: f"{case[0]}-{'.'.join(map(str, case[1]))}-{case[2]:g}")
def test_a_number_at_the_ends_of_double_precision(case: tuple[str, Place, float], tmp_path: Path) -> None:
    check(tmp_path, *case)


@pytest.mark.slow
def test_many_numbers_at_the_ends_of_double_precision(tmp_path: Path) -> None:
    for case in drawn()[20:2020]:
        check(tmp_path, *case)
