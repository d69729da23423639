"""The parts of a scene: fixed points and cells, and the values that they carry at any time.

The points are those of the joint at rest with all gaps at zero: the axis of the beam lies on z = 0, and the face of
each stop lies on the beam's surface.  Every part carries ``displacement``, so the filter Warp By Vector of ParaView
moves all parts together, at any scale, and a beam that presses a stop touches the stop at every scale.  Of several
beams each is a part, or a block, of its own: ``beam_upper`` and ``solid_upper`` of a beam called upper.

================== ====================== ==============================================================
part               cells                  what it is
================== ====================== ==============================================================
``beam``           lines                  the axis
``solid``          hexahedra              the beam in its true cross-section, if the problem gives one
``masses``         quadrilaterals         a cube for each mass, of a size that says nothing
``stops``          a line for each stop   the spring, from its face to the rail that carries it
``gaps``           a line for each stop   from the beam's surface to the stop's face: the opening
``base``           quadrilaterals         rails, walls at fixed ends, and posts of other supports
================== ====================== ==============================================================

======================== ========== ===============================================================================
point value              unit       meaning
======================== ========== ===============================================================================
``displacement``         m          vector, relative to the base; on the solid with its cross-sections' rotation
``displacement_absolute`` m         vector, the base's own motion, times the beam's base_share, included
``velocity``             m/s        vector, relative to the base (beam and solid)
``velocity_absolute``    m/s        vector, the base's own motion, times base_share, included (beam and solid)
``slope``                rad        z_x (beam and solid)
``moment``               N m        EI z_xx (14a) (beam and solid)
``shear``                N          EI z_xxx (14b), to the left of a concentrated force (beam and solid)
``bending_stress``       Pa         -E zeta z_xx at the height zeta above the axis, tension positive; on the beam's
                                    line that of the top surface (if the problem gives a cross-section)
``contact_force``        N          vector, of the stops on the beam (beam only)
``difference``           m          vector, of a later motion from the first (beam and solid of the later one)
======================== ========== ===============================================================================

================== ====== =================================================================
cell value         unit   meaning
================== ====== =================================================================
``contact_force``  N      vector, of the stop on the beam (stops)
``closed``         1      1 while the stop is closed, else 0 (stops, gaps)
``penetration``    m      distance by which the beam has pressed in the stop (stops)
``opening``        m      distance of the beam from the stop, 0 while it is closed (gaps)
``stop``           1      number of the stop in the problem, from 0 (stops, gaps)
================== ====== =================================================================
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from lapjoint.problem import BeamPiece, FloatArray, Line, Support
from lapjoint.scene.layout import Layout
from lapjoint.scene.sampled_motion import Sample
from lapjoint.scene.section_mesh import IntArray, SectionMesh, section_mesh

PARTS = ("beam", "solid", "masses", "stops", "gaps", "base")
"""Names of all kinds of parts."""
Arrays = dict[str, FloatArray | IntArray]
"""Values by name."""
UNITS = {
    "displacement": "m",
    "displacement_absolute": "m",
    "difference": "m",
    "velocity": "m/s",
    "velocity_absolute": "m/s",
    "slope": "rad",
    "moment": "N m",
    "shear": "N",
    "bending_stress": "Pa",
    "contact_force": "N",
    "closed": "1",
    "penetration": "m",
    "opening": "m",
    "stop": "1",
}
"""SI unit of each value of a motion, by name."""


class Values(NamedTuple):
    """The values of a part at ``m`` times, in the units of `UNITS`."""

    point: Arrays
    """Values at the points by name, shape ``(m, points)``, or ``(m, points, 3)`` for vectors."""
    cell: Arrays
    """Values of the cells by name, shape ``(m, cells)``, or ``(m, cells, 3)`` for vectors."""


@dataclass(frozen=True)
class Part:
    """A part of the scene, which a program can show or hide: see the head of this module."""

    layout: Layout
    """The joint to which the part belongs."""
    beam: int | None = None
    """Index of the only beam that the part shows; None: all that there are."""

    @property
    def label(self) -> str:
        """Name of the part among those of its joint: its kind, and of one of several beams the beam's name."""
        if self.beam is None:
            return self.name
        words = [re.sub(r"[^\w+-]+", "_", name) for name in self.layout.problem.line.names]
        alike = words.count(words[self.beam]) > 1
        return f"{self.name}_{words[self.beam]}{f'_{self.beam}' if alike else ''}"

    @property
    def name(self) -> str:
        """Kind of the part, one of `PARTS`."""
        return type(self).__name__.lower()

    @property
    def points(self) -> FloatArray:
        """Positions at rest, m, shape (points, 3)."""
        return self._mesh[0]

    @property
    def cells(self) -> IntArray:
        """Indices of points, shape (cells, corners): 2 for lines, 4 for quadrilaterals, 8 for hexahedra."""
        return self._mesh[1]

    @cached_property
    def _mesh(self) -> tuple[FloatArray, IntArray]:
        raise NotImplementedError

    @property
    def _on_line(self) -> FloatArray:
        """A position on the line of the beam with whose base each point moves, m, shape (points,)."""
        raise NotImplementedError

    @cached_property
    def _shares(self) -> FloatArray:
        """How much of the base's motion is added to each point's, shape (points,)."""
        x, at = np.unique(self._on_line, return_inverse=True)
        return self.layout.problem.structure.base_shares(x)[at]

    def _displacements(self, relative: FloatArray, sample: Sample) -> Arrays:
        """Displacements of the points, m, ``(m, points, 3)``, without and with those of the base."""
        return {"displacement": relative, "displacement_absolute": self._with_base(relative, sample.base[0])}

    def _velocities(self, relative: FloatArray, sample: Sample) -> Arrays:
        """Velocities of the points, m/s, ``(m, points, 3)``, without and with those of the base."""
        return {"velocity": relative, "velocity_absolute": self._with_base(relative, sample.base[1])}

    def _with_base(self, vectors: FloatArray, base: FloatArray) -> FloatArray:
        """Vectors, ``(m, points, 3)``, to which each point's share of the base's motion along z, ``(m,)``, is added."""
        moved = vectors.copy()
        moved[:, :, 2] += np.outer(base, self._shares)
        return moved

    def values(self, sample: Sample) -> Values:
        """The values of the part at the `m` times of a sample; the head of this module lists them with their units."""
        raise NotImplementedError


class Beam(Part):
    """The axis of the beam."""

    @cached_property
    def _stations(self) -> IntArray:
        """Indices of the stations on the beam, ascending, ``(points,)``."""
        on = self.layout.beam_of(self.layout.stations)
        return np.flatnonzero((on == self.beam) | (self.beam is None)).astype(np.int64)

    @property
    def _on_line(self) -> FloatArray:
        return self.layout.stations[self._stations]

    @cached_property
    def _mesh(self) -> tuple[FloatArray, IntArray]:
        first = np.arange(self._stations.size - 1)
        return self.layout.place(self._on_line, 0.0, 0.0), np.column_stack([first, first + 1])

    def values(self, sample: Sample) -> Values:
        """See `lapjoint.scene.parts.Part.values`."""
        beam, problem = sample.beam, self.layout.problem
        here, x = self._stations, self._on_line
        EI = problem.line.EI_at(x)
        point = self._displacements(_upwards(beam["z"][:, here]), sample)
        if "z_t" in beam:
            point |= self._velocities(_upwards(beam["z_t"][:, here]), sample)
        point |= {
            "slope": beam["z_x"][:, here],
            "moment": EI * beam["z_xx"][:, here],
            "shear": EI * beam["z_xxx"][:, here],
        }
        if problem.line.has_sections:
            point["bending_stress"] = -problem.line.stress_per_moment_at(x) * EI * beam["z_xx"][:, here]
        force = np.zeros_like(beam["z"])
        for stop, station in enumerate(self.layout.at_stops):
            force[:, station] += sample.force[:, stop]
        for stop, station in self.layout.on_beams:
            force[:, station] -= sample.force[:, stop]
        return Values(point | {"contact_force": _upwards(force[:, here])}, {})


class Solid(Part):
    """The beam in its true cross-sections, which stay plane and at right angles to the axis; each piece is a block."""

    @cached_property
    def _blocks(self) -> tuple[tuple[BeamPiece, SectionMesh, IntArray], ...]:
        """Each piece of the beam with the mesh of its section, and the indices of the stations from start to end."""
        x, found = self.layout.stations, []
        line = self.layout.problem.line
        for piece in (it for it in line.pieces if self.beam in (None, line.beam_at(it.start))):
            assert piece.section is not None
            found.append((piece, section_mesh(piece.section), np.flatnonzero((x >= piece.start) & (x <= piece.end))))
        return tuple(found)

    @cached_property
    def _mesh(self) -> tuple[FloatArray, IntArray]:
        points, cells, first = [], [], 0
        for _, flat, stations in self._blocks:
            y, z = np.tile(flat.points, (stations.size, 1)).T
            points.append(self.layout.place(np.repeat(self.layout.stations[stations], len(flat.points)), y, z))
            behind = first + flat.quads[None] + len(flat.points) * np.arange(stations.size - 1)[:, None, None]
            cells.append(np.concatenate([behind, behind + len(flat.points)], axis=2).reshape(-1, 8))
            first += len(points[-1])
        return np.concatenate(points), np.concatenate(cells)

    @cached_property
    def _of_points(self) -> tuple[IntArray, FloatArray]:
        """The station, and E / EI, 1/m4, of each point, shape ``(points,)``."""
        station = [np.repeat(stations, len(flat.points)) for _, flat, stations in self._blocks]
        ratio = [
            np.full(indices.size, piece.material.youngs_modulus / piece.EI)
            for indices, (piece, _, _) in zip(station, self._blocks, strict=True)
            if piece.material is not None
        ]
        return np.concatenate(station), np.concatenate(ratio)

    @property
    def _on_line(self) -> FloatArray:
        return self.layout.stations[self._of_points[0]]

    def values(self, sample: Sample) -> Values:
        """See `lapjoint.scene.parts.Part.values`."""
        beam, (station, ratio) = sample.beam, self._of_points
        height = self.points[:, 2] - self.layout.levels(self.layout.stations[station])
        EI = self.layout.problem.line.EI_at(self.layout.stations)

        def on_points(values: FloatArray) -> FloatArray:
            """Values at the stations, ``(m, n)``, at the points of each cross-section."""
            return values[:, station]

        z_x, moment = on_points(beam["z_x"]), on_points(EI * beam["z_xx"])
        point = self._displacements(_vectors(on_points(beam["z"]), -height * z_x), sample)
        if "z_t" in beam:
            point |= self._velocities(_vectors(on_points(beam["z_t"]), -height * on_points(beam["z_xt"])), sample)
        point |= {"slope": z_x, "moment": moment, "shear": on_points(EI * beam["z_xxx"])}
        return Values(point | {"bending_stress": -ratio * height * moment}, {})


class Masses(Part):
    """The masses, as rigid cubes that move and turn with the beam."""

    @cached_property
    def _mesh(self) -> tuple[FloatArray, IntArray]:
        masses, half = self.layout.problem.structure.masses, self.layout.half_mass
        corner = half * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
        faces = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
        x = np.repeat([mass.x for mass in masses], len(corner))
        dx, y, z = np.tile(corner, (len(masses), 1)).T
        cells = faces[None] + len(corner) * np.arange(len(masses))[:, None, None]
        return self.layout.place(x + dx, y, z), cells.reshape(-1, 4).astype(np.int64)

    @property
    def _on_line(self) -> FloatArray:
        x = [mass.x for mass in self.layout.problem.structure.masses]
        return np.repeat(x, len(self.points) // len(x))

    def values(self, sample: Sample) -> Values:
        """See `lapjoint.scene.parts.Part.values`."""
        x = np.array([mass.x for mass in self.layout.problem.structure.masses])
        at = np.repeat(np.searchsorted(self.layout.stations, x), len(self.points) // x.size)
        from_axis = self.points - self.layout.place(self.layout.stations[at], 0.0, 0.0)
        slope = sample.beam["z_x"][:, at]
        moved = _vectors(sample.beam["z"][:, at] + slope * from_axis[:, 0], -slope * from_axis[:, 2])
        return Values(self._displacements(moved, sample), {})


class _AtStops(Part):
    """A line at each stop, which moves with the base of the beam that meets the stop."""

    @property
    def _on_line(self) -> FloatArray:
        return np.repeat([stop.met for stop in self.layout.problem.structure.stops], 2)


class Stops(_AtStops):
    """The springs of the stops."""

    @cached_property
    def _mesh(self) -> tuple[FloatArray, IntArray]:
        return _posts(self.layout, self.layout.reach)

    def values(self, sample: Sample) -> Values:
        """See `lapjoint.scene.parts.Part.values`."""
        stops = self.layout.problem.structure.stops
        feet = sample.gapped * np.array([stop.sign * self.layout.widest_gap(stop.sign) for stop in stops])
        feet[[stop for stop, _ in self.layout.on_beams]] = 0.0
        moved = np.stack([sample.faces, feet + sample.moved], axis=2)
        pressed = np.abs(sample.force) / np.array([stop.stiffness for stop in stops])
        return Values(
            self._displacements(_upwards(moved.reshape(len(moved), -1)), sample),
            {
                "contact_force": _upwards(sample.force),
                "closed": sample.closed,
                "penetration": pressed,
                "stop": _numbers(sample),
            },
        )


class Gaps(_AtStops):
    """The openings between the beam and each stop."""

    @cached_property
    def _mesh(self) -> tuple[FloatArray, IntArray]:
        return _posts(self.layout, 0.0)

    def values(self, sample: Sample) -> Values:
        """See `lapjoint.scene.parts.Part.values`."""
        surface = sample.beam["z"][:, self.layout.at_stops]
        moved = np.stack([surface, sample.faces], axis=2)
        opening = np.abs(sample.faces - surface)
        return Values(
            self._displacements(_upwards(moved.reshape(len(moved), -1)), sample),
            {"opening": opening, "closed": sample.closed, "stop": _numbers(sample)},
        )


class Base(Part):
    """The base, which shakes the joint: rails above and below, walls at fixed ends, posts under other supports."""

    @cached_property
    def _plates(self) -> list[tuple[float, float, float, float]]:
        """Each plate: its start along the line and above the beam's axis, m, and its end; first the rails."""
        layout, structure = self.layout, self.layout.problem.structure
        line, far = structure.line, layout.half_depth + layout.reach
        sides = {(line.beam_at(stop.x), stop.sign) for stop in structure.stops if stop.side != "between"}
        sides |= {(line.beam_at(it.x), -1) for it in structure.supports if not _is_wall(it, line)}
        plates = [(line.starts[beam], side * far, line.ends[beam], side * far) for beam, side in sorted(sides)]
        for support in structure.supports:
            low = -far if _is_wall(support, line) else -layout.half_depth
            plates.append((support.x, low, support.x, far if _is_wall(support, line) else -far))
        return plates

    @cached_property
    def _mesh(self) -> tuple[FloatArray, IntArray]:
        layout, half = self.layout, self.layout.breadth / 2
        corners = [
            (x, y, z)
            for a, low, b, high in self._plates
            for x, z, y in ((a, low, -half), (b, high, -half), (b, high, half), (a, low, half))
        ]
        x, y, z = np.array(corners, dtype=float).reshape(-1, 3).T
        return layout.place(x, y, z), np.arange(4 * len(self._plates)).reshape(-1, 4)

    @property
    def _on_line(self) -> FloatArray:
        return np.repeat([start for start, *_ in self._plates], 4)

    def values(self, sample: Sample) -> Values:
        """See `lapjoint.scene.parts.Part.values`.  The end of a post that holds the beam moves with the beam."""
        heights = [z for _, low, _, high in self._plates for z in (low, high, high, low)]
        side = np.sign(heights).astype(int)
        rails = sample.gapped * np.array([sign * self.layout.widest_gap(sign) for sign in side])
        z = np.tile(rails, (sample.times.size, 1))
        structure = self.layout.problem.structure
        first = len(self.points) - 4 * len(structure.supports)
        for i, support in enumerate(structure.supports):
            if not _is_wall(support, structure.line):
                station = int(np.searchsorted(self.layout.stations, support.x))
                z[:, [first + 4 * i, first + 4 * i + 3]] = sample.beam["z"][:, [station]]
        return Values(self._displacements(_upwards(z), sample), {})


def parts_of(layout: Layout, *, gaps: bool = True) -> tuple[Part, ...]:
    """The parts of a joint: a solid if there are cross-sections, masses, and stops, with their gaps if asked for."""
    problem = layout.problem
    each = range(len(problem.line.beams)) if problem.line.several else (None,)
    beams = [Beam(layout, i) for i in each]
    solid = [Solid(layout, i) for i in each] if problem.line.has_sections else []
    masses = (Masses(layout),) if problem.structure.masses else ()
    stops = (Stops(layout), *((Gaps(layout),) if gaps else ())) if problem.structure.stops else ()
    base = (Base(layout),) if problem.structure.stops or problem.structure.supports else ()
    return (*beams, *solid, *masses, *stops, *base)


def _is_wall(support: Support, line: Line) -> bool:
    return support.torsional == np.inf and support.x in line.edges


def _posts(layout: Layout, length: float) -> tuple[FloatArray, IntArray]:
    """For each stop a line of `length`, m, that leads from the beam's surface at rest away from the beam; of a stop
    between two beams to the surface of the first."""
    stops = layout.problem.structure.stops
    sign = np.array([stop.sign for stop in stops])
    seen = np.array([stop.reading[0][0] for stop in stops])
    surface = layout.half_depth_at(seen)
    x = np.repeat(seen, 2)
    z = np.column_stack([sign * surface, sign * np.where(length, layout.half_depth + length, surface)]).ravel()
    for k, station in layout.on_beams if length else ():
        x[2 * k + 1] = layout.stations[station]
        z[2 * k + 1] = -layout.half_depth_at(layout.stations[[station]])[0]
    return layout.place(x, np.repeat(layout.across, 2), z), np.arange(x.size, dtype=np.int64).reshape(-1, 2)


def _numbers(sample: Sample) -> IntArray:
    return np.tile(np.arange(sample.closed.shape[1]), (sample.times.size, 1))


def _upwards(z: FloatArray) -> FloatArray:
    """Vectors along z, shape ``(m, n, 3)``, from their lengths, shape ``(m, n)``."""
    return _vectors(z, np.zeros_like(z))


def _vectors(z: FloatArray, x: FloatArray) -> FloatArray:
    """Vectors, shape ``(m, n, 3)``, from their z- and x-components, each of shape ``(m, n)``."""
    return np.stack([x, np.zeros_like(z), z], axis=2)
