"""The examples of a problem file that ``lapjoint init`` writes: presets, with every key explained."""

from __future__ import annotations

from typing import Literal

ExampleName = Literal["paper", "lap"]


def commented_example(preset: ExampleName = "paper") -> str:
    """The TOML file of a preset, with comments on units and what is allowed: one beam, or several of them."""
    return {"paper": _ONE_BEAM, "lap": _SEVERAL_BEAMS}[preset]


_ONE_BEAM = """\
# A problem for `lapjoint`.  SI units: m, kg, s, N, rad; angular frequencies in rad/s.
# x runs from the root (0) to the tip (length); z is the displacement relative to the base, positive upwards.
# `lapjoint schema` prints every key that is allowed.
schema_version = 1            # of the keys in this file; may be left out
title = "Lap joint of Rahmani and Ervin (2014)"

[beam]
length = 2.5                  # m, > 0
# Either a material and a section, as here, or bending_stiffness (EI, N m2) and mass_per_length (kg/m), or segments.
# contents_per_length = 8.0   # kg/m, >= 0, of what fills the beam; base motion and gravity act on it
# added_mass_per_length = 5.0 # kg/m, >= 0, of a fluid around the beam; base motion acts on it, gravity does not

[beam.material]
youngs_modulus = 2.05e11      # Pa, > 0
density = 7890.0              # kg/m3, > 0

[beam.section]                # leave out if there are segments
shape = "rectangle"           # "rectangle" (breadth, height), "circle" (diameter), "tube" (outer_, inner_diameter)
breadth = 0.3                 # m, across the motion
height = 0.05                 # m, along the motion

# [[beam.segments]]           # a beam with steps: its parts, from the root to the tip
# to = 0.8                    # m, where the segment ends
# section = {shape = "rectangle", breadth = 0.3, height = 0.06}
# [[beam.segments]]           # each with a section, and a material if it is not the beam's,
# to = 2.5                    # or with bending_stiffness and mass_per_length; the last one ends at the length
# section = {shape = "rectangle", breadth = 0.3, height = 0.05}

# [[masses]]                  # rigid masses at points; base motion and gravity act on them
# name = "clevis"             # for figures and for --set masses.clevis.mass=13
# x = 2.5                     # m, within the beam
# mass = 12.0                 # kg, >= 0
# rotary_inertia = 0.05       # kg m2, >= 0, about the axis of bending; 0 by default

[[supports]]                  # linear springs to the base that always act; any number, also none
x = 0.0                       # m, within the beam
translational = inf           # N/m, 0 to inf; inf fixes the displacement
torsional = inf               # N m/rad, 0 to inf; inf fixes the slope

[[stops]]                     # one-sided springs behind a gap; any number, also none
name = "P2"                   # for tables
x = 2.5                       # m, within the beam
side = "bottom"               # "bottom" acts at z < -gap, "top" at z > gap
gap = 1e-3                    # m; below 0 an interference: the stop presses the straight beam
stiffness = 1.476e8           # N/m, > 0; here 1200 times 3 EI / length^3
# damping = 4e3               # N s/m, of a damper beside the spring, 0 by default; may_pull = true lets both pull
# fixed_to = "space"          # "base" by default: the stop moves with the base; in "space" the gap sees z + y

[[stops]]
name = "P3"
x = 1.25
side = "bottom"
gap = 1e-3
stiffness = 1.476e8

[[stops]]
name = "P4"
x = 2.5
side = "top"
gap = 1e-3
stiffness = 1.476e8

[[stops]]
name = "P5"
x = 1.25
side = "top"
gap = 1e-3
stiffness = 1.476e8

[damping]
kind = "modal"                # "modal" (ratio), "viscous" (coefficient, N s/m2) or "none"
ratio = 0.08                  # of every mode of the current contact state, >= 0; or a list, one per mode

[base_motion]                 # y(t) = amplitude sin(angular_frequency t + phase); leave out for a base at rest
kind = "sine"                 # or "harmonics", "record" or "random", see below; "sine" where none is given
amplitude = 0.06              # m, >= 0
angular_frequency = 515.0     # rad/s, > 0; or else frequency = 82.0, in Hz: so also below
phase = 0.0                   # rad

# [base_motion]               # y(t) = sum of amplitude sin(multiple angular_frequency t + phase)
# kind = "harmonics"
# frequency = 10.0            # Hz, of the fundamental; or else angular_frequency, rad/s
# harmonics = [               # whole multiples of it, each once
#     {multiple = 1, amplitude = 2e-3},
#     {multiple = 3, amplitude = 1e-4, phase = 0.7},
# ]

# [base_motion]               # y(t) as it was measured
# kind = "record"
# quantity = "acceleration"   # or "velocity", "displacement"
# file = "shaker.csv"         # from the folder of this file; or values = [...]
# column = "a_z"              # name, or number from 1; by default the first that is not the time
# time_column = "t"           # or rate = 5000.0, samples a second
# unit = "g"                  # "m/s2" by default; also time_unit, remove = "offset" or "drift"
# decimal = ","               # "." by default; also skip, delimiter, encoding, comment, holes = "bridge",
                              # and dataset, of a UFF file

# [base_motion]               # a stationary Gaussian acceleration
# kind = "random"
# psd = [[5.0, 80.0], [500.0, 80.0]]  # one-sided, log-log between breakpoints: [Hz, (m/s2)2/Hz]
# unit = "g2/Hz"              # "(m/s2)2/Hz" by default
# rate = 4000.0               # samples a second, 8 times the highest frequency by default
# seed = 1                    # which realisation

# [[point_loads]]             # transverse forces from t = 0 on; any number
# kind = "sine"               # "step" (x, force), "sine" (x, force, angular_frequency, phase), "harmonics"
                              # (x, angular_frequency, harmonics = [{multiple = 1, force = 100.0, phase = 0.0}, ...])
                              # or "record" (x, and file and so on as of a base; unit = "kN")
                              # or "random" (x, and psd and so on as of a base; unit = "kN2/Hz")
# x = 2.5                     # m, within the beam
# force = 100.0               # N, positive upwards
# angular_frequency = 515.0   # rad/s

# [gravity]                   # along z, on beam, contents and masses, from t = 0 on
# acceleration = -9.81        # m/s2, positive upwards

# [[uniform_loads]]           # constant forces along the beam, from t = 0 on; any number
# from = 0.5                  # m; the root, if not given
# to = 1.0                    # m; the tip, if not given
# force_per_length = -200.0   # N/m, positive upwards

# [[uncertain]]               # random variables of which `--samples 256` draws values; any number
# name = "gap"                # a word of letters, digits and _
# paths = ["stops.*.gap"]     # the fields that it moves, together
# apply = "value"             # or "factor": on the number of each field
# kind = "normal"             # "normal" (mean, deviation; low and high cut it off), "lognormal" (mean, deviation: of
                              # the value itself), "uniform" (low, high), "triangular" (low, mode, high) or "list"
                              # (values, equally likely)
# mean = 1e-3
# deviation = 1e-4

[initial]
kind = "rest"                 # "rest", "equilibrium" (at rest under the static loads), "polynomial" (displacement
                              # and velocity: coefficients of 1, x, x^2 ...) or "sampled" (x, displacement, velocity:
                              # lists of equal length)
"""


_SEVERAL_BEAMS = """\
# A problem of several beams for `lapjoint`.  SI units: m, kg, s, N, rad; angular frequencies in rad/s.
# `lapjoint init` without --preset explains the keys of one beam; all of them, loads among them, may stand here, too.
# A place is written beam:x, where x runs from the left end of that beam (0) to its right end (length), in m.
schema_version = 1            # of the keys in this file; may be left out
title = "Lap joint of two plates with a loose bolt"

[[beams]]                     # any number; all run towards +x
name = "upper"                # by which places are given
origin = 0.0                  # m, where its left end lies; for drawings
offset = 0.01                 # m, how far it is drawn above z = 0; changes no answer
length = 0.3                  # m, > 0
# base_share = 1.0            # how much of the base's motion acts along its z: -1 mirrored, 0 none; 1 by default
# gravity_share = 1.0         # how much of gravity acts along its z; 1 by default
# viscous_damping = 2.0       # N s/m2, >= 0, along this beam alone; adds to [damping]

[beams.material]              # as of one beam: or bending_stiffness and mass_per_length, or segments
youngs_modulus = 2.05e11      # Pa, > 0
density = 7850.0              # kg/m3, > 0

[beams.section]
shape = "rectangle"
breadth = 0.04                # m, across the motion
height = 0.004                # m, along the motion

[[beams.supports]]            # springs between this beam and the base; [[beams.masses]] are written alike
x = 0.0                       # m, from the left end of this beam
translational = inf           # N/m, 0 to inf; inf fixes the displacement
torsional = inf               # N m/rad, 0 to inf; inf fixes the slope

[[beams]]
name = "lower"
origin = 0.24
length = 0.3

[beams.material]
youngs_modulus = 2.05e11
density = 7850.0

[beams.section]
shape = "rectangle"
breadth = 0.04
height = 0.006

[[beams.supports]]
x = 0.3
translational = inf
torsional = inf

[[stops]]                     # between two beams: closed where the second comes nearer to the first than the gap
name = "left edge"
between = ["upper:0.24", "lower:0"]  # the upper one first; or x = "upper:0.3" and side, as of one beam
gap = 1e-4                    # m; below 0 an interference
stiffness = 2e6               # N/m, > 0; also damping and may_pull

[[stops]]
name = "right edge"
between = ["upper:0.3", "lower:0.06"]
gap = 1e-4
stiffness = 2e6

[[stops]]                     # the bolt closes where the plates come apart
name = "bolt"
between = ["lower:0.03", "upper:0.27"]
gap = 2e-4
stiffness = 2e7

# [[links]]                   # springs and dampers between two beams that always act: a tight bolt, a weld, a hinge
# name = "rivet"              # for figures and for --set links.rivet.translational=1e6
# between = ["upper:0.29", "lower:0.05"]
# translational = 1e7         # N/m, 0 to inf; inf joins the displacements
# torsional = 1e3             # N m/rad, 0 to inf; inf joins the slopes
# damping = 20.0              # N s/m, >= 0, beside the translational spring
# torsional_damping = 0.1     # N m s/rad, >= 0, beside the torsional spring

[damping]
kind = "modal"                # "modal" (ratio), "viscous" (coefficient, N s/m2) or "none"
ratio = 0.05                  # of every mode of the system in the current contact state

[base_motion]                 # y(t) = amplitude sin(angular_frequency t); moves all supports
amplitude = 5e-4              # m, >= 0
angular_frequency = 300.0     # rad/s, > 0

[initial]
kind = "rest"                 # or "equilibrium": at rest under the static loads
"""
