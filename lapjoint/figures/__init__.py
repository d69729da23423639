"""Figures of answers, drawn with matplotlib and without a display.

Each function takes an answer and, optionally, axes to draw on.  It returns the axes, which `save` writes as PNG, SVG or
PDF.  All figures share one style, `lapjoint.figures.style`, and convert SI units to the units on their axes.
"""

from lapjoint.figures.basins import plot_basins
from lapjoint.figures.bifurcation import plot_bifurcation
from lapjoint.figures.branch_diagram import plot_branches
from lapjoint.figures.branch_loci import plot_loci
from lapjoint.figures.contacts import plot_contact_impulses, plot_contact_states
from lapjoint.figures.convergence import plot_convergence
from lapjoint.figures.curves_together import plot_curves, plot_curves_wide
from lapjoint.figures.density import plot_psd
from lapjoint.figures.exceedance import plot_exceedance
from lapjoint.figures.impulse_curve import plot_curve
from lapjoint.figures.impulse_curve_wide import plot_curve_wide
from lapjoint.figures.mode_shapes import plot_mode_shapes, plot_state_shapes
from lapjoint.figures.motion import plot_motion
from lapjoint.figures.phase_portrait import plot_phase_portrait, plot_poincare_section
from lapjoint.figures.sketch import plot_joint
from lapjoint.figures.spectrum import plot_spectrum
from lapjoint.figures.style import new_axes, new_panels, save
from lapjoint.figures.sweep_axes import in_hertz

__all__ = [
    "in_hertz",
    "new_axes",
    "new_panels",
    "plot_basins",
    "plot_bifurcation",
    "plot_branches",
    "plot_contact_impulses",
    "plot_contact_states",
    "plot_convergence",
    "plot_curve",
    "plot_curve_wide",
    "plot_curves",
    "plot_curves_wide",
    "plot_exceedance",
    "plot_joint",
    "plot_loci",
    "plot_mode_shapes",
    "plot_motion",
    "plot_phase_portrait",
    "plot_poincare_section",
    "plot_psd",
    "plot_spectrum",
    "plot_state_shapes",
    "save",
]
