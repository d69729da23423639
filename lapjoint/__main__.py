"""``python -m lapjoint``: the command ``lapjoint``."""

from __future__ import annotations

from lapjoint.cli.main import main

if __name__ == "__main__":
    main(prog_name="python -m lapjoint")
