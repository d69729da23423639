"""The site of these pages: ``sphinx-build -W docs site``, without a network."""

from __future__ import annotations

import re
import sys
from importlib.metadata import version as version_of
from pathlib import Path
from typing import Any

import nbformat

sys.path.insert(0, str(Path(__file__).parent))
from notebooks import PAGES, notebook_of

project = "lapjoint"
author = "The lapjoint developers"
version = release = version_of("lapjoint")
root_doc = "index"
extensions = [
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_click",
    "sphinx-mathjax-offline",
]
exclude_patterns = ["_build", "conf.py"]
templates_path = ["_templates"]
autosummary_imported_members = False
autosummary_context = {
    "imported": (
        "lapjoint.problem",
        "lapjoint.answers",
        "lapjoint.orbits",
        "lapjoint.campaigns",
        "lapjoint.figures",
        "lapjoint.scene",
        "analytic",
        "fe_lapjoint",
    )
}
"""Packages whose public names come from their modules."""
html_theme = "furo"
html_title = "lapjoint"
html_show_sourcelink = False
html_show_copyright = False  # LICENSE has it
html_copy_source = False
html_static_path = ["_static"]
html_css_files = ["site.css"]
smartquotes = False  # `--plane` in a help text is an option, not a dash

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
myst_fence_as_directive = ["math"]

autosummary_generate = True
autodoc_typehints = "none"  # the docstrings give the types
autodoc_member_order = "bysource"
autodoc_inherit_docstrings = False
autosummary_ignore_module_all = False
numpydoc_show_class_members = False
numpydoc_class_members_toctree = False
nitpicky = False

_PAGES = {"README.md": "readme.md", "CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changes.md"}
"""Files beside this folder, and the pages of the site that hold the same."""


def _led_home(text: str, up: str, here: str) -> str:
    """Links of a page: `up` leads from it to this folder, `here` to the folder above it."""
    for file, page in _PAGES.items():
        text = re.sub(rf"\]\({re.escape(here)}{re.escape(file)}(#[^)]*)?\)", rf"]({up}{page}\1)", text)
    return text


def _read(app: Any, docname: str, source: list[str]) -> None:
    """A page of this folder: links that leave it stay within the site."""
    up = "../" * docname.count("/")
    source[0] = _led_home(source[0], up, f"{up}../")
    if f"{docname}.md" in PAGES:
        name = docname.rpartition("/")[2]
        heading, _, rest = source[0].partition("\n")
        offer = f'<p><a href="{name}.ipynb" download>This page as a notebook</a></p>'
        source[0] = f"{heading}\n\n{offer}\n{rest}"


def _included(app: Any, relative_path: Any, parent_docname: str, content: list[str]) -> None:
    """A file from beside this folder: its links into this folder, and to its neighbours."""
    text = _led_home(content[0], "", "")
    for file in ("LICENSE", "benchmarks/README.md"):
        text = re.sub(rf"\[([^]]*)\]\({file}\)", rf"\1 (`{file}`)", text)
    content[0] = re.sub(r"\]\(docs/(README\.md)?", "](", text)


def _finished(app: Any, error: Exception | None) -> None:
    """What Sphinx leaves out for those who do not see, or use no mouse; and the notebooks.

    Levels of headings, names of what stands beside a page, boxes that scroll by the keyboard, and options that are not
    cut after their dashes.
    """
    for page in () if error else Path(app.outdir).rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        text = text.replace('class="caption" role="heading">', 'class="caption" role="heading" aria-level="2">')
        for beside, name in (("sidebar-drawer", "All pages"), ("toc-drawer", "On this page")):
            text = re.sub(rf'<aside class="{beside}([^"]*)">', rf'<aside class="{beside}\1" aria-label="{name}">', text)
        text = re.sub(r'<span class="pre">(--[\w-]{1,24})</span>', r'<span class="pre option">\1</span>', text)
        page.write_text(re.sub(r"<pre>", '<pre tabindex="0">', text), encoding="utf-8")
    for name in () if error else PAGES:
        notebook = notebook_of((Path(app.srcdir) / name).read_text(encoding="utf-8"))
        nbformat.write(notebook, (Path(app.outdir) / name).with_suffix(".ipynb"))


def setup(app: Any) -> None:
    """Register what this site needs besides its extensions."""
    app.connect("build-finished", _finished)
    app.connect("source-read", _read)
    app.connect("include-read", _included)
