"""The table of deviations of the peers' decks, shown at the end of a run and written where AMONTONS_TABLE says.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

LINES: dict[str, list[str]] = {}


@pytest.fixture
def tell(request: pytest.FixtureRequest) -> object:
    """Keeps lines of the table under the name of a deck."""

    def keep(deck: str, *lines: str) -> None:
        LINES.setdefault(deck, []).extend(lines)

    return keep


def pytest_terminal_summary(terminalreporter: object) -> None:
    """Writes the table."""
    if not LINES:
        return
    text = "\n".join(line for deck in sorted(LINES) for line in LINES[deck])
    terminalreporter.section("decks of CalculiX: largest deviation of each block")  # type: ignore[attr-defined]
    terminalreporter.write_line(text)  # type: ignore[attr-defined]
    if "AMONTONS_TABLE" in os.environ:
        Path(os.environ["AMONTONS_TABLE"]).write_text(text + "\n")
