"""The motion in three dimensions: files for ParaView, pictures, films and windows."""

from lapjoint.scene.appearance import Look
from lapjoint.scene.export import export_modes, export_motion
from lapjoint.scene.pictures import FILMS, PICTURES, save_film, save_picture, show_window
from lapjoint.scene.render_process import check_can_show

__all__ = [
    "FILMS",
    "PICTURES",
    "Look",
    "check_can_show",
    "export_modes",
    "export_motion",
    "save_film",
    "save_picture",
    "show_window",
]
