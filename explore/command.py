"""The command ``lapjoint explore``, which joins the others by the entry point ``lapjoint.commands``."""

from __future__ import annotations

import click

from lapjoint.cli.completing import PROBLEM
from lapjoint.cli.echo import echo


@click.command()
@click.argument("problem", type=PROBLEM, default="preset:paper", required=False)
@click.option("--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Change one value of PROBLEM; repeatable.")
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="Port on this machine.  [default: a free one]")
@click.option("--no-browser", is_flag=True, help="Do not open a browser; the address is printed.")
def explore(problem: str, overrides: tuple[str, ...], port: int, no_browser: bool) -> None:
    """Open a page on this machine: PROBLEM as a form, and beside it what both solvers answer, at once.

    PROBLEM may also be a state that a page saved, a file that ends in .json.  Ctrl-C ends it.
    """
    from lapjoint.errors import InputError

    try:
        from explore.server import serve
    except ImportError as error:
        raise InputError(
            f"explore: needs the package {error.name}; pip install 'lapjoint[explore]', or -e '.[explore]' in a clone"
        ) from None
    from explore.question import first_question

    serve(first_question(problem, overrides), port, browse=not no_browser, say=_say)


def _say(address: str) -> None:
    echo(f"The page is at {address}\nCtrl-C ends it.")
