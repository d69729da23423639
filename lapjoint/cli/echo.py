"""Printing for the commands: control sequences are printed as text."""

from __future__ import annotations

import click

from lapjoint.files.plain_text import escaped


def echo(text: str = "", *, err: bool = False, nl: bool = True) -> None:
    """Print text, which may contain names from files and arguments, to standard output or, with `err`, to standard
    error."""
    click.echo(escaped(text), err=err, nl=nl)
