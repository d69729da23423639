"""Problems that a page starts from: the presets, and problems of the gallery as files."""

from __future__ import annotations

from importlib.resources import files
from typing import Any

from lapjoint.problem.files import problem_tables, tables_from_toml
from lapjoint.problem.presets import PRESETS

GALLERY = {
    "cascade": "a bar on a pin beside one stop: a cascade that ends in chaos",
    "hardening": "a cantilever between two stops: a resonance that leans over",
    "loose_pinned_beam": "a beam with clearance in both pins",
    "machine_joint": "an arm with a clevis, on a pad and between two jaws",
    "own_joint": "a pipe with play in its hanger",
}
"""Problems of the gallery, by the names of their scripts, and what they are."""


def starts() -> dict[str, str]:
    """The names of all starts, by what a page says of them."""
    presets = {f"preset: {preset().title}": f"preset:{name}" for name, preset in PRESETS.items()}
    return presets | {f"gallery: {text}": name for name, text in GALLERY.items()}


def tables_of(name: str) -> dict[str, Any]:
    """The tables of a start, by its name."""
    if name.startswith("preset:"):
        return problem_tables(PRESETS[name.removeprefix("preset:")]())
    return tables_from_toml((files(__name__) / f"{name}.toml").read_text(encoding="utf-8"), name)
