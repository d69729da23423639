"""The plotter: sets up a drawing for pyvista, as meshes, text and a camera, and shows its frames."""

from __future__ import annotations

from typing import Any

import numpy as np

from lapjoint.figures.text import cut_to
from lapjoint.problem import FloatArray
from lapjoint.scene.frames import Drawing, Plates, Skin, Springs

BACKGROUND, INK, PALE, STEEL = "white", "#222222", "#C9CCD1", "#7A828C"
SILENT, BRIEF, LIT = "#8A929C", "#F3CF80", "#E69F00"
"""Colours of a stop that is open, that is closed only between two frames, and that is closed."""
COLOURS = "coolwarm"
"""Matplotlib's name of the colour map: pale at zero, blue below it and red above it."""
VIEWPOINT = np.array([0.35, -1.0, 0.32])
"""Direction from the middle of the scene to the eye, shape ``(3,)``."""
GLYPH = 0.55
"""Mean width of a letter, divided by the font size, by which the width of text is estimated before drawing."""
TURNS, ROUND = 6, 20
"""Number of turns of a coil, and number of points on each turn."""


class Stage:
    """A drawing and its plotter, with a window or `off_screen`."""

    def __init__(self, drawing: Drawing, off_screen: bool) -> None:
        import pyvista

        self.drawing = drawing
        self.plotter = pyvista.Plotter(off_screen=off_screen, window_size=list(drawing.size), border=False)
        self.plotter.set_background(BACKGROUND)
        self.font = max(8, round(min(drawing.size[0] / 75, drawing.size[1] / 26)))
        self._skins = [self._add_skin(skin, first=i == 0) for i, skin in enumerate(drawing.skins)]
        self._coils = [self._add_springs(springs) for springs in drawing.springs]
        self._plates = [self._add_plates(plates) for plates in drawing.plates]
        self._add_words()
        self._aim()
        self.at(0)
        if off_screen:  # the colour scale has its final place only after it is drawn twice
            self.image()
            self.image()

    def at(self, frame: int) -> None:
        """Show a frame, numbered from 0."""
        for skin, (shown, ids) in zip(self.drawing.skins, self._skins, strict=True):
            if ids is None:
                shown.copy_from(_tube(skin, frame))
            else:
                shown.points = skin.points[frame][ids]
                shown.point_data["value"] = skin.values[frame][ids]
        for springs, pieces in zip(self.drawing.springs, self._coils, strict=True):
            for stop, (coil, actor) in enumerate(pieces):
                coil.points = _coil(springs.points[frame, stop], springs.radius)
                actor.prop.color = (SILENT, BRIEF, LIT)[springs.acts[frame, stop]]
        for plates, shown in zip(self.drawing.plates, self._plates, strict=True):
            shown.points = plates.points[frame]
        for word, label in zip(self.drawing.words, self._labels, strict=True):
            label.position = word.places[frame]
        self._caption.input = self._cut(self.drawing.captions[frame])

    def image(self) -> Any:
        """The current frame as an array of colours (red, green, blue), shape ``(height, width, 3)``."""
        self.plotter.render()
        return self.plotter.screenshot(return_img=True)

    def _add_skin(self, skin: Skin, first: bool) -> tuple[Any, Any]:
        """Add a beam, with the colour scale for the first one; return its mesh, and the indices of its points in
        `skin`."""
        import pyvista

        if skin.cells.shape[1] == 2:
            shown, ids = _tube(skin, 0), None
        else:
            grid = pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: skin.cells}, skin.points[0])
            grid.point_data["id"] = np.arange(grid.n_points)
            shown = grid.extract_surface(algorithm="dataset_surface").copy()
            ids = np.asarray(shown.point_data["id"])
            shown.point_data["value"] = skin.values[0][ids]
        bar = {
            "title": self.drawing.label,
            "color": INK,
            "title_font_size": self.font,
            "label_font_size": self.font,
            "n_labels": 3,
            "fmt": "%.5g",
            "width": 0.34,
            "height": 4.2 * self.font / self.drawing.size[1],
            "position_x": 0.33,
            "position_y": 0.4 * self.font / self.drawing.size[1],
        }
        self.plotter.add_mesh(
            shown,
            scalars="value",
            cmap=COLOURS,
            clim=list(self.drawing.limits),
            scalar_bar_args=bar,
            show_scalar_bar=first,
            ambient=0.35,
            diffuse=0.75,
            specular=0.1,
        )
        if first:
            self.plotter.scalar_bars[self.drawing.label].GetTitleTextProperty().SetLineOffset(-self.font / 2)
        return shown, ids

    def _add_springs(self, springs: Springs) -> list[tuple[Any, Any]]:
        """Add the coils; return the line of each coil, and the actor whose colour changes."""
        import pyvista

        pieces, width = [], max(2.0, self.drawing.size[0] / 300)
        for ends in springs.points[0]:
            coil = pyvista.lines_from_points(_coil(ends, springs.radius))
            actor = self.plotter.add_mesh(coil, color=SILENT, line_width=width, render_lines_as_tubes=True)
            pieces.append((coil, actor))
        return pieces

    def _add_plates(self, plates: Plates) -> Any:
        import pyvista

        shown = pyvista.PolyData.from_regular_faces(plates.points[0], plates.cells)
        self.plotter.add_mesh(shown, color=PALE, opacity=0.55, show_edges=True, edge_color=STEEL, ambient=0.4)
        return shown

    def _add_words(self) -> None:
        """Add title, notes, an empty caption, and names."""
        import pyvista

        head = [self._cut(self.drawing.title), *(self._cut(note, 1.9) for note in self.drawing.notes)]
        self._corner("\n".join(head), 0.008, "left")
        self._caption = self._corner("", 0.992, "right")
        self._labels = []
        for word in self.drawing.words:
            label = pyvista.Label(word.text, position=tuple(word.places[0]), size=self.font)
            label.prop.font_size = self.font
            label.prop.color = INK
            label.prop.bold = True
            label.prop.justification_horizontal = word.side
            label.prop.justification_vertical = "center"
            self.plotter.add_actor(label)
            self._labels.append(label)

    def _cut(self, text: str, share: float = 1.0) -> str:
        """Text on one line, shortened to half of the width times `share`."""
        most = max(8, int(share * self.drawing.size[0] / 2 / (GLYPH * self.font)))
        return cut_to(text, most)

    def _corner(self, text: str, x: float, side: str) -> Any:
        """Add text in an upper corner."""
        actor = self.plotter.add_text(text, position=(x, 0.985), viewport=True, font_size=self.font, color=INK)
        actor.prop.font_size = self.font
        actor.prop.justification_horizontal = side
        actor.prop.justification_vertical = "top"
        return actor

    def _aim(self) -> None:
        """Place the camera in front, a little above and towards the tip, where it remains during the motion."""
        moving: list[Skin | Springs | Plates] = [*self.drawing.skins, *self.drawing.springs, *self.drawing.plates]
        points = np.concatenate([thing.points.reshape(-1, 3) for thing in moving])
        forward = -VIEWPOINT / np.linalg.norm(VIEWPOINT)
        right = np.cross(forward, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        above = np.cross(right, forward)
        (left_end, right_end), (low, high) = ((np.min(points @ axis), np.max(points @ axis)) for axis in (right, above))
        width, height = self.drawing.size
        # Text above and the colour scale below need a part of the height, names a part of the width.
        head, foot = 1.3 * (len(self.drawing.notes) + 1.5) * self.font / height, 6.0 * self.font / height
        left_names, right_names = self._widths_of_names()
        room = max(1 - left_names - right_names - 0.04, 0.3)
        shown = max((high - low) / max(1 - head - foot, 0.3), (right_end - left_end) / room * height / width)
        sideways = (right_names - left_names) / 2 * shown * width / height
        middle = ((left_end + right_end) / 2 + sideways) * right
        middle = middle + ((low + high) / 2 + (head - foot) / 2 * shown) * above
        distance = 2 * float(np.ptp(points, axis=0).max())
        camera = self.plotter.camera
        self.plotter.enable_parallel_projection()
        camera.focal_point = middle + np.mean(points @ forward) * forward
        camera.position = np.asarray(camera.focal_point) - distance * forward
        camera.up = (0.0, 0.0, 1.0)
        camera.parallel_scale = shown / 2
        self.plotter.reset_camera_clipping_range()

    def _widths_of_names(self) -> tuple[float, float]:
        """Width of the names on the left and on the right of the joints, divided by the whole width."""
        glyph = 1.15 * GLYPH * self.font / self.drawing.size[0]  # bold
        left = max((len(word.text) for word in self.drawing.words if word.side == "right"), default=0)
        middle = max((len(word.text) / 2 for word in self.drawing.words if word.side == "center"), default=0)
        return glyph * max(left, middle), glyph * middle


def _tube(skin: Skin, frame: int) -> Any:
    import pyvista

    line = pyvista.lines_from_points(skin.points[frame])
    line.point_data["value"] = skin.values[frame]
    return line.tube(radius=skin.radius, n_sides=16)


def _coil(ends: FloatArray, radius: float) -> FloatArray:
    """A helix, m, shape ``(n, 3)``, from the face to the foot of a spring, the rows of `ends`, shape ``(2, 3)``."""
    face, foot = ends
    angle = np.linspace(0.0, 2 * np.pi * TURNS, TURNS * ROUND + 1)
    along = np.linspace(0.0, 1.0, angle.size)[:, None]
    wave = radius * np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])
    helix: FloatArray = face + along * (foot - face) + wave
    return helix
