"""Pages in a real browser, where one is installed: what overflows, what lies on what, and an accessibility checker."""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome")
BROWSER = next(filter(None, map(shutil.which, NAMES)), None)
needs_browser = pytest.mark.skipif(BROWSER is None, reason=f"no browser: none of {', '.join(NAMES)} is installed")
QUIET = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--hide-scrollbars"),
    *("--disable-background-networking", "--disable-sync", "--disable-component-update", "--disable-extensions"),
)
LIGHT, DARK = 1, 0
"""What the browser calls the two schemes of colours."""
SERIOUS = ("serious", "critical")
"""Impacts of an accessibility checker's findings that no page may have."""
_LOOK = r"""<!doctype html><meta charset="utf-8"><body><script>
const PAGES = %(pages)s, WIDTHS = %(widths)s, AXE = %(axe)s;
const MOVES = ["fixed", "sticky"];  // what stays in sight lies on what scrolls below it
function overlaps(shown, view) {
  const lines = [];
  const texts = shown.createTreeWalker(shown.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const text = texts.currentNode, parent = text.parentElement;
    if (!text.data.trim() || parent.closest("script, style, mjx-container") || !parent.checkVisibility()) continue;
    let moves = false, hidden = false;
    for (let e = parent; e; e = e.parentElement) {
      moves ||= MOVES.includes(view.getComputedStyle(e).position);
      hidden ||= e.clientWidth === 1 || view.getComputedStyle(e).opacity === "0";  // for screen readers alone
    }
    if (moves || hidden) continue;
    const range = shown.createRange();
    range.selectNodeContents(text);
    for (const r of range.getClientRects()) {
      const inset = r.height / 4;  // a font is taller than its letters
      lines.push({text: text.data.trim().slice(0, 40), node: text, l: r.left + 1, r: r.right - 1, t: r.top + inset,
        b: r.bottom - inset});
    }
  }
  lines.sort((a, b) => a.t - b.t);
  const found = [];
  for (let i = 0; i < lines.length; i++) for (let j = i + 1; j < lines.length && lines[j].t < lines[i].b; j++) {
    const a = lines[i], b = lines[j];
    if (a.node !== b.node && a.l < b.r && b.l < a.r) found.push([a.text, b.text]);
  }
  return found;
}
function broken(shown, view) {
  const found = [];
  const texts = shown.createTreeWalker(shown.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const text = texts.currentNode, parent = text.parentElement;
    if (!parent.closest(".kept table") || !parent.checkVisibility()) continue;
    for (const word of text.data.matchAll(/[^ \\n/:-]+/g)) {
      const range = shown.createRange();
      range.setStart(text, word.index);
      range.setEnd(text, word.index + word[0].length);
      const lines = new Set([...range.getClientRects()].map((r) => Math.round(r.top)));
      if (lines.size > 1) found.push(word[0]);
    }
  }
  return found;
}
async function look(page, width) {
  const frame = document.createElement("iframe");
  frame.style = `width:${width}px;height:800px;border:0`;
  frame.src = page;
  document.body.append(frame);
  await new Promise((done) => { frame.onload = done; });
  const shown = frame.contentDocument;
  for (const d of shown.querySelectorAll("details")) d.open = true;
  const boxes = [...shown.querySelectorAll(".wide")];
  const beyond = boxes.filter((e) => e.scrollWidth > e.clientWidth + 1).length;
  const hides = (e) => ["hidden", "clip"].includes(frame.contentWindow.getComputedStyle(e).overflowX);
  const cut = [...shown.querySelectorAll("body *:not(mjx-assistive-mml)")].filter(
    (e) => e.innerText && e.clientWidth > 1 && e.scrollWidth > e.clientWidth + 1 && hides(e));
  const found = {page, width, page_width: shown.documentElement.scrollWidth, tables: boxes.length, beyond};
  found.cut = cut.map((e) => e.outerHTML.slice(0, 200));
  found.overlaps = overlaps(shown, frame.contentWindow);
  found.broken = broken(shown, frame.contentWindow);
  if (AXE) {
    const script = shown.createElement("script");
    script.textContent = AXE;
    shown.head.append(script);
    const result = await frame.contentWindow.axe.run(shown, {resultTypes: ["violations"]});
    found.violations = result.violations.map((v) => [v.id, v.impact, v.nodes[0].html.slice(0, 200)]);
  }
  frame.remove();
  return found;
}
(async () => {
  const all = [];
  for (const page of PAGES) for (const width of WIDTHS) all.push(await look(page, width));
  const result = document.createElement("pre");
  result.id = "result";
  result.textContent = JSON.stringify(all);
  document.body.append(result);
})();
</script></body>
"""


@dataclass(frozen=True)
class Seen:
    """A page at one width, all that is folded open."""

    page: str
    width: int
    page_width: int
    """Its content, pixels: more than `width` scrolls sideways."""
    tables: int
    """Tables in boxes of their own."""
    beyond: int
    """Tables that are wider than their box."""
    cut: list[str]
    """Elements whose text is cut off."""
    overlaps: list[list[str]]
    """Pairs of texts that lie on each other."""
    broken: list[str]
    """Words of tables that go on in the next line."""
    violations: list[list[str]]
    """Findings of the accessibility checker: rule, impact, and where first."""

    @property
    def serious(self) -> list[list[str]]:
        """The findings that no page may have."""
        return [one for one in self.violations if one[1] in SERIOUS]


def browse(profile: Path, page: Path, *options: str, fragment: str = "", timeout: float = 120) -> str:
    """What the browser prints for a page, in a profile of its own and without a network."""
    assert BROWSER is not None
    command = [BROWSER, *QUIET, f"--user-data-dir={profile}", "--host-resolver-rules=MAP * ~NOTFOUND", *options]
    command.append(page.as_uri() + fragment)
    return subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=True).stdout


def look_at(
    profile: Path,
    folder: Path,
    pages: Sequence[str],
    widths: Sequence[int],
    *,
    checked: bool = False,
    scheme: int = LIGHT,
) -> list[Seen]:
    """Each page of a folder at each width; `checked` asks the accessibility checker, too."""
    axe = files("axe_core_python").joinpath("axe.min.js").read_text(encoding="utf-8") if checked else ""
    text = {"pages": json.dumps(list(pages)), "widths": json.dumps(list(widths)), "axe": json.dumps(axe)}
    text["axe"] = text["axe"].replace("</", "<\\/")
    sheet = folder / "look.html"
    sheet.write_text(_LOOK % text, encoding="utf-8")
    options = ("--allow-file-access-from-files", "--virtual-time-budget=600000", "--dump-dom")
    try:
        dom = browse(profile, sheet, *options, f"--blink-settings=preferredColorScheme={scheme}", timeout=500)
    finally:
        sheet.unlink()
    result = re.search(r'<pre id="result">(.*?)</pre>', dom, re.DOTALL)
    assert result, dom[-500:]
    return [Seen(**{"violations": [], **one}) for one in json.loads(html.unescape(result[1]))]
