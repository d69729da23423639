"""Draws docs/first-result.png, the picture of the README: a steady cycle at the first peak, and the impulse curve."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

import analytic
import fe_lapjoint
from lapjoint import paper_joint

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BLUE, ORANGE, GREEN = "#0072B2", "#D55E00", "#009E73"
COMPARED = (250.0, 515.0, 820.0, 1400.0, 2060.0, 2950.0, 3500.0, 4200.0, 5000.0)


def main() -> None:
    """Compute and draw."""
    figure = Figure(figsize=(8, 5.6), layout="constrained")
    above, below = figure.subplots(2)
    cycle(above)
    curve(below)
    figure.savefig(Path(__file__).with_name("first-result.png"), dpi=130)


def cycle(axes: Axes) -> None:
    """Displacement of tip and mid-span over one steady cycle at 515 rad/s, both solvers."""
    joint = paper_joint(angular_frequency=515.0)
    exact = analytic.Solver().steady_state(joint).history
    fe = fe_lapjoint.Solver().steady_state(joint).history
    t = np.linspace(0.0, exact.end, 600)
    for x, name, colour in ((2.5, "tip", BLUE), (1.25, "mid-span", GREEN)):
        axes.plot(t * 1e3, exact.displacement(x, t)[0] * 1e3, color=colour, label=f"{name}, analytic")
        axes.plot(t * 1e3, fe.displacement(x, t)[0] * 1e3, ":", lw=2.2, color=ORANGE, label=f"{name}, FE")
    for side in (-1, 1):
        axes.axhline(side, color="#777777", lw=0.8, label="gap" if side == 1 else None)
    axes.set(xlabel="t (ms)", ylabel="z (mm)", title="One steady cycle at 515 rad/s")
    axes.legend(fontsize=8, ncols=2)


def curve(axes: Axes) -> None:
    """Impulse of the top stops against excitation frequency."""
    omega = np.arange(20.0, 5001.0, 10.0)
    solver = analytic.Solver(n_modes=24)
    impulses = np.array([solver.steady_state(paper_joint(angular_frequency=float(w))).impulses for w in omega])
    fe = np.array([fe_lapjoint.Solver().steady_state(paper_joint(angular_frequency=w)).impulses for w in COMPARED])
    for k, colour, name in ((2, BLUE, "tip, top (P4)"), (3, GREEN, "mid-span, top (P5)")):
        axes.plot(omega, impulses[:, k] / 1e3, color=colour, lw=1.1, label=f"{name}, analytic")
        axes.plot(COMPARED, fe[:, k] / 1e3, "o", color=ORANGE, mfc="none", ms=5, label="FE" if k == 2 else None)
    axes.set(
        xlabel="excitation frequency (rad/s)",
        ylabel="impulse per cycle (kN s)",
        title=f"Steady-state impulses at {omega.size} frequencies",
        ylim=(0, None),
    )
    axes.legend(fontsize=8)


if __name__ == "__main__":
    main()
