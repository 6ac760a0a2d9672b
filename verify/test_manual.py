"""The manual keeps its promises: its decks run, its links lead somewhere, the card reference tells every card.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from card_reference import MANUAL, find_examples, page_of, read_cards
from conftest import ROOT, Run

PAGES = sorted((ROOT / "doc").rglob("*.md"))
DECK = re.compile(r"```abaqus\n(.*?)```", re.DOTALL)
LINK = re.compile(r"\]\(([^)#:\s]+)(#[^)\s]*)?\)")
WRITTEN = {ROOT / "doc" / "manual" / "cards.md", ROOT / "doc" / "verification" / "index.md"}  #: by make doc, make verify
DECKS = [(page.name, deck) for page in PAGES for deck in DECK.findall(page.read_text())]


def test_there_are_decks() -> None:
    """Else the next test proves nothing."""
    assert DECKS


@pytest.mark.parametrize(("page", "deck"), DECKS, ids=[f"{page}-{i}" for i, (page, _) in enumerate(DECKS)])
def test_decks_of_the_manual_run(run: Run, tmp_path: Path, page: str, deck: str) -> None:
    """Every deck that is shown in full."""
    (tmp_path / "job.inp").write_text(deck)
    done = run(["job"], cwd=tmp_path)
    assert done.returncode == 0, f"{page}:\n{done.stdout}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT / "doc")))
def test_links_lead_somewhere(page: Path) -> None:
    """Links to files of the repository."""
    for target, _ in LINK.findall(page.read_text()):
        place = (page.parent / target).resolve()
        is_written = place in WRITTEN or place.parent == ROOT / "doc" / "verification"
        assert place.exists() or is_written, f"{page.name} links to {target}, which is not there"


EXAMPLES = sorted((MANUAL / "examples").glob("*.inp"))


@pytest.mark.parametrize("deck", EXAMPLES, ids=lambda deck: deck.stem)
def test_examples_run(run: Run, tmp_path: Path, deck: Path) -> None:
    """The decks of which the card reference shows parts."""
    done = run(["--outdir", tmp_path, deck])
    assert done.returncode == 0, done.stdout


def test_each_card_has_an_example(run: Run) -> None:
    """Cut from one of these decks."""
    cards = {card.name for card in read_cards(run(["--cards"]).stdout)}
    assert cards - set(find_examples()) == set()


def test_card_reference_is_whole(run: Run) -> None:
    """Each card that the program lists has its section, with a sentence."""
    text = run(["--cards"]).stdout
    cards = read_cards(text)
    assert len(cards) == sum(line.startswith("*") for line in text.splitlines())
    assert all(card.sentence for card in cards)
    page = page_of(cards)
    assert all(f"## \\{card.name}" in page for card in cards)
