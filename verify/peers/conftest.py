"""The table of deviations of the peers' decks: shown at the end of a run, and a page of the manual if `make verify` requests it.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path

import pytest

CLOSE, AGREES = 0.001, 0.01  # of the largest value of a block
PAGE = "calculix-decks.md"


@dataclass
class Row:
    """One block of a deck: how far it is from the reference."""

    block: str
    time: float
    largest: float
    deviation: float
    where: str


@dataclass
class Entry:
    """One deck."""

    deck: str
    reason: str = ""  #: why it is not judged or did not run; empty if it is judged
    note: str = ""
    has_run: bool = True
    is_excluded: bool = False  #: by a reason that lies in the reference, not here
    rows: list[Row] = field(default_factory=list)

    @property
    def worst(self) -> float:
        """The largest deviation of its blocks."""
        return max((row.deviation for row in self.rows), default=0.0)

    @property
    def verdict(self) -> str:
        """In words."""
        if self.reason:
            return self.reason
        if self.worst <= AGREES:
            return "agrees" + (f": {self.note}" if self.note else "")
        return "**does not agree**" + (f": {self.note}" if self.note else "")


ENTRIES: dict[str, Entry] = {}


@pytest.fixture
def record(request: pytest.FixtureRequest) -> Callable[[Entry], None]:
    """Keeps the result of a deck and sends it to the controlling process."""

    def keep(entry: Entry) -> None:
        request.node.user_properties.append(("deck of a peer", json.dumps(asdict(entry))))

    return keep


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Collects the decks."""
    for name, value in report.user_properties:
        if name == "deck of a peer":
            words = json.loads(value)
            ENTRIES[words["deck"]] = Entry(**words | {"rows": [Row(**row) for row in words["rows"]]})


def percent(value: float) -> str:
    """A deviation as it is written."""
    return f"{100 * value:.4f} %" if value < 1e3 else "not found"


def pytest_terminal_summary(terminalreporter: object) -> None:
    """Shows the table."""
    if not ENTRIES:
        return
    terminalreporter.section("decks of CalculiX: largest deviation of each block")  # type: ignore[attr-defined]
    for deck in sorted(ENTRIES):
        entry = ENTRIES[deck]
        terminalreporter.write_line(f"{deck:30s} {entry.verdict}")  # type: ignore[attr-defined]
        for row in entry.rows:
            terminalreporter.write_line(  # type: ignore[attr-defined]
                f"{percent(row.deviation):>16s}  {row.block}, time {row.time:g}, largest {row.largest:.3e}, at {row.where}")


@pytest.hookimpl(tryfirst=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """Writes the page, once, when all workers are done and all decks have run."""
    pages = os.environ.get("AMONTONS_PAGES")
    if pages and ENTRIES and not hasattr(session.config, "workerinput"):
        (Path(pages) / PAGE).write_text(page())


def counts(folder: str) -> str:
    """The line of a folder."""
    judged = [e for e in ENTRIES.values() if e.deck.startswith(folder + "/") and not e.is_excluded]
    run = [e for e in judged if e.has_run and not e.reason]
    close, agree = (sum(e.worst <= limit for e in run) for limit in (CLOSE, AGREES))
    return f"| {folder} | {len(judged)} | {len(run)} | {agree} | {close} |"


def page() -> str:
    """The page of the manual."""
    lines = [
        "# Decks of CalculiX's suite",
        "",
        "Written by `make verify` where the decks are at hand (AMONTONS_DECKS says where; they are not part of Amontons). Each deck",
        "of CalculiX's own tests runs under the calculix dialect as it is and is compared with CalculiX's printed reference block",
        "by block: the largest difference over the largest value of the block. Blocks of nothing but rounding, in the reference and",
        "here, are left out. Tables of plane and axisymmetric elements, which CalculiX expands into solids, are compared by the",
        "extremes of their columns, its files of nodal values (DISP, STRESS, TOSTRAIN) by the places of the nodes.",
        "",
        "A deck does not count if its reference is not reproduced by CalculiX's own release, needs code compiled into CalculiX, or",
        "has nothing that Amontons writes.",
        "",
        "| folder | decks that count | finish | within 1 % | within 0.1 % |",
        "|---|---|---|---|---|",
        *(counts(folder) for folder in sorted({deck.split("/")[0] for deck in ENTRIES})),
        "",
        "| deck | blocks | largest deviation | verdict |",
        "|---|---|---|---|",
    ]
    for deck, entry in sorted(ENTRIES.items()):
        shown = percent(entry.worst) if entry.rows else ""
        lines.append(f"| {deck} | {len(entry.rows) or ''} | {shown} | {entry.verdict} |")
    lines += ["", "## Block by block", "", "| deck | block | time | largest value | deviation | at |", "|---|---|---|---|---|---|"]
    for deck, entry in sorted(ENTRIES.items()):
        for row in entry.rows:
            lines.append(f"| {deck} | {row.block} | {row.time:g} | {row.largest:.3e} | {percent(row.deviation)} | {row.where} |")
            deck = ""
    return "\n".join(lines) + "\n"
