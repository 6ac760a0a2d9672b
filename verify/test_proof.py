"""The runner of the verification cases: its limits of iterations.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from proof import MOST_OVER_ALL, write_index


def test_mean_effort(tmp_path: Path) -> None:
    """The mean is over increments asked for, with the iterations of failed attempts, over all cases together."""
    for name, asked, iterations in (("a", 10, 20), ("b", 2, 64)):
        facts = {"name": name, "title": name, "checks": [], "effort": [(asked, iterations, 1)], "asked": [asked]}
        (tmp_path / f"{name}.json").write_text(json.dumps(facts))
    mean = write_index(tmp_path)
    assert mean == pytest.approx(84 / 12)
    assert mean > MOST_OVER_ALL
    assert not list(tmp_path.glob("*.json"))
    assert "| all | 12 | 84 | 2 | 7.0 |" in (tmp_path / "index.md").read_text()
