"""Random rigid bars with every part, by both solvers and by the witness of numpy alone."""

from __future__ import annotations

import numpy as np
import pytest

from lapjoint.problem.files import from_toml
from validation.cases import rigid_bar
from validation.references.rigid_bar import RigidBar

STIFF = 1e8  # N m2: a bar bends by k L^3 / EI of its motion at most
CLOSE = 2e-4  # of the largest number of a kind: k L^3 / EI of the stiffest stop
DEEP = 0.03  # of the largest peak force: shallower contacts depend on bending
BAR = """
[beam]
length = 1.5
contents_per_length = {contents}
added_mass_per_length = {added}
[[beam.segments]]
to = {step}
bending_stiffness = {{stiffness}}
mass_per_length = {m1}
[[beam.segments]]
to = 1.5
bending_stiffness = {{stiffness}}
mass_per_length = {m2}
[[supports]]
x = 0.0
translational = {k1}
[[supports]]
x = 1.1
translational = {k2}
torsional = {kt}
[[masses]]
x = {a1}
mass = {M1}
rotary_inertia = {J}
[[masses]]
x = {a2}
mass = {M2}
[[stops]]
x = {s1}
side = "top"
gap = {g1}
stiffness = {c1}
fixed_to = "{to1}"
[[stops]]
x = {s2}
side = "bottom"
gap = {g2}
stiffness = {c2}
fixed_to = "{to2}"
[[stops]]
x = {s2}
side = "top"
gap = {g3}
stiffness = {c3}
[gravity]
acceleration = {gravity}
[[uniform_loads]]
from = {q1}
to = {q2}
force_per_length = {q}
[damping]
kind = "modal"
ratio = [{z1}, {z2}, 0.6]
[base_motion]
amplitude = {Y}
angular_frequency = {omega}
phase = {phase}
[initial]
kind = "polynomial"
velocity = [{v1}, {v2}]
"""


def random_bar(seed: int) -> str:
    """A bar with numbers of its own, as text."""
    rng = np.random.default_rng([48, seed])

    def u(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    numbers = {
        "contents": u(0, 1), "added": u(0, 1), "step": u(0.3, 1.2), "m1": u(1, 6), "m2": u(1, 6),
        "k1": u(500, 2000), "k2": u(500, 2000), "kt": u(0, 200), "a1": u(0, 1.5), "M1": u(0, 2), "J": u(0, 0.2),
        "a2": u(0, 1.5), "M2": u(0, 2), "s1": u(0.2, 1.5), "g1": u(-4e-3, 8e-3), "c1": u(500, 5000),
        "s2": u(0.2, 1.5), "g2": u(-4e-3, 8e-3), "c2": u(500, 5000), "g3": u(-2e-3, 8e-3), "c3": u(500, 5000),
        "gravity": u(-3, 3), "q1": u(0, 0.7), "q2": u(0.8, 1.5), "q": u(-15, 15), "z1": u(0.02, 0.1),
        "z2": u(0.02, 0.1), "Y": u(2e-3, 8e-3), "omega": u(6, 25), "phase": u(-3, 3), "v1": u(-0.1, 0.1),
        "v2": u(-0.1, 0.1),
    }  # fmt: skip
    places = {f"to{i}": "space" if rng.random() < 0.5 else "base" for i in (1, 2)}
    return BAR.format(**{key: repr(value) for key, value in numbers.items()}, **places)


def off(seed: int) -> dict[str, float]:
    """Largest differences of contacts and displacements from the witness, over the largest of a kind, by solver."""
    text = random_bar(seed)
    motion = RigidBar.from_toml(text.format(stiffness="inf")).march(rigid_bar.DURATION)
    wanted = motion.contacts[: rigid_bar.CONTACTS]
    if any(one.peak < DEEP * max(c.peak for c in motion.contacts) for one in motion.contacts):
        return {}
    found = {}
    for solver in rigid_bar.SOLVERS:
        history = solver.simulate(from_toml(text.format(stiffness=STIFF)), rigid_bar.DURATION, errors=False)
        contacts = history.contacts[: rigid_bar.CONTACTS]
        assert sorted(c.stop for c in contacts) == sorted(c.stop for c in wanted), seed
        order = [sorted(it, key=lambda c: (round(c.start, 4), c.stop)) for it in (contacts, wanted)]
        numbers = [
            [(c.start, c.end, c.impulse, c.peak_force) for c in order[0]],
            [(c.start, c.end, c.impulse, c.peak) for c in order[1]],
        ]
        one, other = (np.array(rows).reshape(-1, 4) for rows in numbers)
        apart = np.abs(one - other).max(axis=0, initial=0.0) / np.abs(other).max(axis=0, initial=1e-9)
        z = history.displacement(history.problem.beam.length, rigid_bar.TIMES)[0]
        exact = motion.evaluate(1.5, rigid_bar.TIMES)
        found[solver.name] = max(float(apart.max()), float(np.abs(z - exact).max() / np.abs(exact).max()))
    return found


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.thorough) for seed in range(2, 8))])
def test_random_bars_with_every_part_move_as_the_witness_says(seed: int) -> None:
    assert all(worst <= CLOSE for worst in off(seed).values())


@pytest.mark.slow
def test_many_random_bars_with_every_part_move_as_the_witness_says() -> None:
    found = {seed: off(seed) for seed in range(8, 208)}
    judged = {seed: one for seed, one in found.items() if one}
    assert len(judged) > len(found) / 3
    assert {seed: one for seed, one in judged.items() if max(one.values()) > CLOSE} == {}
