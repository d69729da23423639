"""Numbers of the validation are, within their stated uncertainty, what they were before the search was written anew."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path

import pytest

RECORDED = Path(__file__).parent / "recorded" / "standard.json"
ROUNDING = 1e-12  # of a value: numbers that are stated as exact still differ in their last digits
RUN = "import sys; from lapjoint.cli.main import main; sys.exit(main())"


@pytest.mark.slow
def test_every_recorded_number_comes_back_within_its_uncertainty(tmp_path: Path) -> None:
    recorded = json.loads(RECORDED.read_text(encoding="utf-8"))["checks"]
    subprocess.run([sys.executable, "-c", RUN, "validate", "-o", str(tmp_path)], check=True, capture_output=True)
    report = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    found = {case["name"]: {check["name"]: check for check in case["checks"]} for case in report["cases"]}
    moved = []
    for case, checks in recorded.items():
        for name, (a, u_a, b, u_b) in checks.items():
            for side, was, u_was in (("a", a, u_a), ("b", b, u_b)):
                now = found[case][name][side]
                allowed = math.hypot(u_was, now["uncertainty"]) + ROUNDING * abs(was)
                if not abs(now["value"] - was) <= allowed:
                    moved.append(f"{case}: {name}: {was!r} was, {now['value']!r} is; allowed {allowed:.1e}")
    assert not moved, "\n".join(moved)
