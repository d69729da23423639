"""The parts of a scene: fixed points and cells, and the values that they carry at any time.

The points are those of the joint at rest with all gaps at zero: the axis of the beam lies on z = 0, and the face of
each stop lies on the beam's surface.  Every part carries ``displacement``, so the filter Warp By Vector of ParaView
moves all parts together, at any scale, and a beam that presses a stop touches the stop at every scale.

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
``displacement_absolute`` m         vector, the base's own motion included
``velocity``             m/s        vector, relative to the base (beam and solid)
``velocity_absolute``    m/s        vector, the base's own motion included (beam and solid)
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

    def values(self, sample: Sample) -> Values:
        """The values of the part at the `m` times of a sample; the head of this module lists them with their units."""
        raise NotImplementedError


class Beam(Part):
    """The axis of the beam."""

    @cached_property
    def _mesh(self) -> tuple[FloatArray, IntArray]:
        x, on = self.layout.stations, self.layout.beam_of(self.layout.stations)
        first = np.flatnonzero(on[:-1] == on[1:])
        return self.layout.place(x, 0.0, 0.0), np.column_stack([first, first + 1])

    def values(self, sample: Sample) -> Values:
        """See `lapjoint.scene.parts.Part.values`."""
        beam, problem = sample.beam, self.layout.problem
        z, EI = beam["z"], problem.line.EI_at(self.layout.stations)
        point = _displacements(_upwards(z), sample)
        if "z_t" in beam:
            point |= _velocities(_upwards(beam["z_t"]), sample)
        point |= {
            "slope": beam["z_x"],
            "moment": EI * beam["z_xx"],
            "shear": EI * beam["z_xxx"],
        }
        if problem.line.has_sections:
            point["bending_stress"] = -problem.line.stress_per_moment_at(self.layout.stations) * EI * beam["z_xx"]
        force = np.zeros_like(z)
        for stop, station in enumerate(self.layout.at_stops):
            force[:, station] += sample.force[:, stop]
        for stop, station in self.layout.on_beams:
            force[:, station] -= sample.force[:, stop]
        return Values(point | {"contact_force": _upwards(force)}, {})


class Solid(Part):
    """The beam in its true cross-sections, which stay plane and at right angles to the axis; each piece is a block."""

    @cached_property
    def _blocks(self) -> tuple[tuple[BeamPiece, SectionMesh, IntArray], ...]:
        """Each piece of the beam with the mesh of its section, and the indices of the stations from start to end."""
        x, found = self.layout.stations, []
        for piece in self.layout.problem.line.pieces:
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

    def values(self, sample: Sample) -> Values:
        """See `lapjoint.scene.parts.Part.values`."""
        beam, (station, ratio) = sample.beam, self._of_points
        height = self.points[:, 2] - self.layout.levels(self.layout.stations[station])
        EI = self.layout.problem.line.EI_at(self.layout.stations)

        def on_points(values: FloatArray) -> FloatArray:
            """Values at the stations, ``(m, n)``, at the points of each cross-section."""
            return values[:, station]

        z_x, moment = on_points(beam["z_x"]), on_points(EI * beam["z_xx"])
        point = _displacements(_vectors(on_points(beam["z"]), -height * z_x), sample)
        if "z_t" in beam:
            point |= _velocities(_vectors(on_points(beam["z_t"]), -height * on_points(beam["z_xt"])), sample)
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

    def values(self, sample: Sample) -> Values:
        """See `lapjoint.scene.parts.Part.values`."""
        x = np.array([mass.x for mass in self.layout.problem.structure.masses])
        at = np.repeat(np.searchsorted(self.layout.stations, x), len(self.points) // x.size)
        from_axis = self.points - self.layout.place(self.layout.stations[at], 0.0, 0.0)
        slope = sample.beam["z_x"][:, at]
        moved = _vectors(sample.beam["z"][:, at] + slope * from_axis[:, 0], -slope * from_axis[:, 2])
        return Values(_displacements(moved, sample), {})


class Stops(Part):
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
            _displacements(_upwards(moved.reshape(len(moved), -1)), sample),
            {
                "contact_force": _upwards(sample.force),
                "closed": sample.closed,
                "penetration": pressed,
                "stop": _numbers(sample),
            },
        )


class Gaps(Part):
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
            _displacements(_upwards(moved.reshape(len(moved), -1)), sample),
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
        return Values(_displacements(_upwards(z), sample), {})


def parts_of(layout: Layout, *, gaps: bool = True) -> tuple[Part, ...]:
    """The parts of a joint: a solid if there are cross-sections, masses, and stops, with their gaps if asked for."""
    problem = layout.problem
    solid = (Solid(layout),) if problem.line.has_sections else ()
    masses = (Masses(layout),) if problem.structure.masses else ()
    stops = (Stops(layout), *((Gaps(layout),) if gaps else ())) if problem.structure.stops else ()
    base = (Base(layout),) if problem.structure.stops or problem.structure.supports else ()
    return (Beam(layout), *solid, *masses, *stops, *base)


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


def _displacements(relative: FloatArray, sample: Sample) -> Arrays:
    return {"displacement": relative, "displacement_absolute": _with_base(relative, sample.base[0])}


def _velocities(relative: FloatArray, sample: Sample) -> Arrays:
    return {"velocity": relative, "velocity_absolute": _with_base(relative, sample.base[1])}


def _with_base(vectors: FloatArray, base: FloatArray) -> FloatArray:
    """Vectors, shape ``(m, n, 3)``, to which the motion of the base along z, shape ``(m,)``, is added."""
    moved = vectors.copy()
    moved[:, :, 2] += base[:, None]
    return moved
