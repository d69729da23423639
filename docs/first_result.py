"""Draws docs/first-result.png, the picture of the README: a steady cycle at the first peak, and the impulse curve."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

import analytic
import fe_lapjoint
from lapjoint import paper_joint
from lapjoint.sweep import FREQUENCY, Axis, sweep

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BLUE, ORANGE, GREEN = "#0072B2", "#D55E00", "#009E73"
DOTS = {"ls": "", "marker": "o", "mfc": "none", "ms": 4, "mec": ORANGE}


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
    """Impulse of the top stops against excitation frequency, every point certified."""
    exact = sweep(paper_joint(), [Axis(FREQUENCY, np.arange(1.0, 5001.0))], workers=2)
    fe = sweep(paper_joint(), [Axis(FREQUENCY, np.arange(50.0, 5001.0, 50.0))], solver="fe", workers=2)
    for k, colour, name in ((2, BLUE, "tip, top (P4)"), (3, GREEN, "mid-span, top (P5)")):
        for found, style, label in ((exact, {"lw": 1.1}, f"{name}, analytic"), (fe, DOTS, "FE" if k == 2 else None)):
            axes.plot(found[found.impulse.dims[0]], found.impulse[:, k] / 1e3, color=colour, label=label, **style)
    axes.set(
        xlabel="excitation frequency (rad/s)",
        ylabel="impulse per cycle (kN s)",
        title=f"Certified steady states: {exact.impulse.shape[0]} analytic, {fe.impulse.shape[0]} by finite elements",
        ylim=(0, None),
    )
    axes.legend(fontsize=8)


if __name__ == "__main__":
    main()
