"""The first result: one steady cycle at the first peak of the paper's joint, and its impulse curve.

Lines are the analytic solver, dots and circles the finite elements, which share nothing with it but the problem.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import figures, paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, sweep

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BLUE, ORANGE, GREEN = "#0072B2", "#D55E00", "#009E73"
DOTS = {"ls": "", "marker": "o", "mfc": "none", "ms": 4, "mec": ORANGE}


def main(step: float = 1.0, fe_step: float = 50.0, workers: int = 2) -> None:
    """The cycle above, the curve below: a point each `step` rad/s, and each `fe_step` by finite elements."""
    above, below = figures.new_panels(2, 1, 7.0, 5.0)
    cycle(above)
    curve(below, step, fe_step, workers)
    figures.save(above, __file__.replace(".py", ".svg"))


def cycle(axes: Axes) -> None:
    """Displacement of tip and mid-span over one steady cycle at 515 rad/s, both solvers."""
    joint = paper_joint(angular_frequency=515.0)
    exact = analytic.Solver().steady_state(joint).history
    fe = fe_lapjoint.Solver().steady_state(joint).history
    t = np.linspace(0.0, exact.end, 600)
    for x, name, colour in ((2.5, "tip", BLUE), (1.25, "mid-span", GREEN)):
        axes.plot(t * 1e3, exact.displacement(x, t)[0] * 1e3, "-", color=colour, label=f"{name}, analytic")
        axes.plot(t * 1e3, fe.displacement(x, t)[0] * 1e3, ":", lw=2.2, color=ORANGE, label=f"{name}, FE")
    for side in (-1, 1):
        axes.axhline(side, color="#777777", lw=0.8, label="gap" if side == 1 else None)
    axes.set(xlabel="t [ms]", ylabel="z [mm]")
    axes.set_title("One steady cycle at 515 rad/s", fontsize=9, loc="left")
    axes.legend(fontsize=7, ncols=2)


def curve(axes: Axes, step: float, fe_step: float, workers: int) -> None:
    """Impulse of the top stops against excitation frequency, every point certified."""
    exact = sweep(paper_joint(), [Axis(FREQUENCY, np.arange(step, 5001.0, step))], workers=workers)
    fe = sweep(paper_joint(), [Axis(FREQUENCY, np.arange(fe_step, 5001.0, fe_step))], solver="fe", workers=workers)
    for k, colour, name in ((2, BLUE, "tip, top (P4)"), (3, GREEN, "mid-span, top (P5)")):
        for found, style, label in ((exact, {"ls": "-"}, f"{name}, analytic"), (fe, DOTS, "FE" if k == 2 else None)):
            axes.plot(found.angular_frequency, found.impulse[:, k] / 1e3, color=colour, label=label, **style)
    counts = (exact.sizes["angular_frequency"], fe.sizes["angular_frequency"])
    axes.set(
        xlabel="excitation frequency [rad/s]",
        ylabel="impulse in a cycle [kN s]",
        ylim=(0, None),
    )
    title = f"Certified steady states: {counts[0]} analytic, {counts[1]} by finite elements"
    axes.set_title(title, fontsize=9, loc="left")
    axes.legend(fontsize=7)
    certified = [int((found.period_multiple > 0).sum()) for found in (exact, fe)]
    print(
        f"Certified periodic: {certified[0]} of {counts[0]} analytic, {certified[1]} of {counts[1]} by finite elements"
    )


if __name__ == "__main__":
    main()
