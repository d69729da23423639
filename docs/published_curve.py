"""Draws docs/published-curve.png: the paper's Figure 4 by the scheme as published, and by the certified solver."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

import analytic
from lapjoint import Outcome, paper_joint
from lapjoint.errors import SolverError
from lapjoint.presets import PAPER_DENSITY

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BLUE, ORANGE, GREY = "#0072B2", "#D55E00", "#999999"
TIP = (0, 2)  # P2 and P4, the stops whose impulses Figure 4 shows
PEAKS = ((400, 700), (750, 950), (2600, 3400))  # rad/s: where to look for the three peaks of the paper
DIFFERENT = 0.02  # of the larger one: impulses of the tip stops that do not agree
UNEVEN = 0.02  # of their sum: difference of the impulses of P2 and P4
Answer = tuple[float, float, float, float, int, bool]  # impulses of P2 to P5, N s; order; symmetric


def answer(omega: float, ask: analytic.Solver | analytic.PublishedScheme, density: float) -> Answer:
    """Impulses, order (-1 if there is no answer at all) and symmetry at one frequency, from rest."""
    try:
        found = ask.steady_state(paper_joint(angular_frequency=float(omega), density=density))
    except SolverError:
        return (np.nan, np.nan, np.nan, np.nan, -1, False)
    P2, P3, P4, P5 = found.impulses
    return (P2, P3, P4, P5, 0 if found.outcome is Outcome.UNDECIDED else found.order, found.symmetric)


def curve(ask: Callable[[float], Answer], frequencies: np.ndarray) -> np.ndarray:
    """Answers at all frequencies, shape ``(n, 6)``."""
    began = time.perf_counter()
    with ProcessPoolExecutor(2) as pool:
        found = np.array(list(pool.map(ask, frequencies, chunksize=20)), dtype=float)
    print(f"{frequencies.size} frequencies in {time.perf_counter() - began:.0f} s")
    return found


def main() -> None:
    """Compute, draw, and print what the curves say."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--step", type=float, default=1.0, help="between frequencies, rad/s")
    options.add_argument("--density", type=float, default=PAPER_DENSITY, help="kg/m3")
    options.add_argument("--tolerance", type=float, default=1e-3, help="to which a published motion must repeat")
    options.add_argument("--modes", type=int, nargs=2, default=(8, 5), help="free and in contact")
    options.add_argument("--out", type=Path, default=Path(__file__).with_name("published-curve.png"))
    given = options.parse_args()
    frequencies = np.arange(given.step, 5000 + given.step / 2, given.step)
    scheme = analytic.PublishedScheme(*given.modes, tolerance=given.tolerance)
    published = curve(partial(answer, ask=scheme, density=given.density), frequencies)
    certified = curve(partial(answer, ask=analytic.Solver(), density=given.density), frequencies)
    draw(frequencies, published, certified, given.out)
    for name, found in (("published", published), ("certified", certified)):
        print_summary(name, frequencies, found)
    print_differences(frequencies, published, certified)


def draw(frequencies: np.ndarray, published: np.ndarray, certified: np.ndarray, out: Path) -> None:
    """The two curves one above the other, on the axes of Figure 4 and wider."""
    figure = Figure(figsize=(9, 7), layout="constrained")
    above, below = figure.subplots(2, sharex=True)
    for axes, found, name in ((above, published, "As published"), (below, certified, "Certified")):
        panel(axes, frequencies, found, name)
    below.set_xlabel("excitation frequency (rad/s)")
    figure.savefig(out, dpi=120)


def panel(axes: Axes, frequencies: np.ndarray, found: np.ndarray, name: str) -> None:
    """Impulses of the tip stops; those of motions that did not settle in grey."""
    unsettled = found[:, 4] <= 0
    for k, colour, label in zip(TIP, (ORANGE, BLUE), ("P2 (bottom)", "P4 (top)"), strict=True):
        axes.plot(frequencies, found[:, k] / 1e4, ".", ms=2, color=colour, label=label)
        axes.plot(frequencies[unsettled], found[unsettled, k] / 1e4, ".", ms=2, color=GREY)
    axes.axhspan(-1.5, 1.5, color="#EEEEEE", zorder=0, label="axis of Figure 4")
    axes.set(ylabel="impulse per cycle (10 kN s)", title=name, ylim=(-5.2, 5.2))
    axes.legend(fontsize=8, loc="upper right")


def print_summary(name: str, frequencies: np.ndarray, found: np.ndarray) -> None:
    """Peaks of even motions, their ratios, and how many motions are not settled or not symmetric."""
    size = np.abs(found[:, TIP]).mean(axis=1)
    uneven = np.abs(np.abs(found[:, 0]) - np.abs(found[:, 2])) > UNEVEN * 2 * size
    heights = []
    for lo, hi in PEAKS:
        here = np.flatnonzero((frequencies >= lo) & (frequencies <= hi) & ~uneven)
        top = here[np.nanargmax(size[here])]
        heights.append(size[top])
        print(f"{name}: peak at {frequencies[top]:g} rad/s, {size[top]:.0f} N s (mean of P2 and P4)")
    print(f"{name}: ratios {heights[1] / heights[0]:.3f} and {heights[2] / heights[1]:.3f}")
    silent = [(found[:, k] == 0) & (found[:, TIP[0] + TIP[1] - k] != 0) for k in TIP]
    print(f"{name}: only P2 silent at {windows(frequencies, silent[0])}; only P4 at {windows(frequencies, silent[1])}")
    for what, which in (("not settled", found[:, 4] == 0), ("no answer", found[:, 4] < 0), ("uneven", uneven)):
        print(f"{name}: {what} at {which.sum()} frequencies: {windows(frequencies, which)}")


def print_differences(frequencies: np.ndarray, published: np.ndarray, certified: np.ndarray) -> None:
    """Where the impulses of the tip stops differ."""
    one, other = np.abs(published[:, TIP]), np.abs(certified[:, TIP])
    for limit in (DIFFERENT, 0.1, 0.5):
        apart = (np.abs(one - other) > limit * np.maximum(one, other)).any(axis=1)
        print(f"differ by more than {limit:.0%} at {apart.sum()} frequencies: {windows(frequencies, apart)}")


def windows(frequencies: np.ndarray, which: np.ndarray) -> str:
    """Runs of frequencies, gaps of a few left out, as text."""
    step = frequencies[1] - frequencies[0]
    inside = frequencies[which]
    if not inside.size:
        return "none"
    runs = np.split(inside, np.flatnonzero(np.diff(inside) > max(10.0, 3 * step)) + 1)
    return ", ".join(f"{run[0]:g}-{run[-1]:g}" for run in runs)


if __name__ == "__main__":
    main()
