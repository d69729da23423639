"""Figure 4 of the paper, by the scheme as published and by certified steady states.

Impulse of the two tip stops in a cycle over the excitation frequency.  The upper curve is the paper's, truncation and
all: a step at 999 rad/s, and about 2060 and 2160 rad/s motions that touch one tip stop only.  The lower curve has
converged.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lapjoint import figures, paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, sweep

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

TIP = ((0, "#D55E00", "P2 (bottom)"), (2, "#0072B2", "P4 (top)"))
PEAKS = ((400, 700), (750, 950), (2600, 3400))  # rad/s: where to look for the three peaks of the paper


def main(step: float = 1.0, workers: int = 2) -> None:
    """Draw both curves, with a point each `step` rad/s, by a number of processes."""
    panels = figures.new_panels(2, 1, 7.0, 4.6, sharex=True)
    frequencies = [Axis(FREQUENCY, np.arange(step, 5000 + step / 2, step))]
    for axes, name, solver in zip(
        panels, ("As published", "Certified"), ("analytic-published", "analytic"), strict=True
    ):
        found = sweep(paper_joint(), frequencies, solver=solver, workers=workers)
        draw(axes, found)
        axes.set_title(name, fontsize=9, loc="left")
        print(f"{name}: {summary(found)}")
    panels[1].set_xlabel("excitation frequency [rad/s]")
    figures.save(panels[0], __file__.replace(".py", ".png"))


def draw(axes: Axes, found: xr.Dataset) -> None:
    """Impulses of the tip stops; those of motions that did not settle in grey."""
    omega, impulse = found.angular_frequency, found.impulse.values / 1e4
    unsettled = found.period_multiple.values == 0
    for stop, colour, label in TIP:
        axes.plot(omega, impulse[:, stop], ".", ms=1.5, color=colour, label=label)
        axes.plot(omega[unsettled], impulse[unsettled, stop], ".", ms=1.5, color="#999999")
    axes.axhspan(-1.5, 1.5, color="#EEEEEE", zorder=0, label="axis of Figure 4")
    axes.set(ylabel="impulse in a cycle [10 kN s]", ylim=(-5.2, 5.2))
    axes.legend(fontsize=7, loc="upper right")


def summary(found: xr.Dataset) -> str:
    """The three peaks of motions that treat both stops alike, their ratios, and the motions that do not."""
    omega, bottom, top = found.angular_frequency.values, -found.impulse.values[:, 0], found.impulse.values[:, 2]
    size = np.where(np.abs(top - bottom) < 0.02 * (top + bottom), (top + bottom) / 2, 0.0)
    peaks = [max(np.flatnonzero((lo <= omega) & (omega <= hi)), key=size.__getitem__) for lo, hi in PEAKS]
    where, (a, b, c) = omega[peaks], size[peaks]
    one_sided = np.mean((bottom == 0) != (top == 0))
    return (
        f"peaks at {where[0]:g}, {where[1]:g} and {where[2]:g} rad/s, ratios {b / a:.2f} and {c / b:.2f}; "
        f"{one_sided:.0%} of the motions touch one tip stop only"
    )


if __name__ == "__main__":
    main()
