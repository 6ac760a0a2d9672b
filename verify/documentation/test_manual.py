"""The manual keeps its promises: its decks run, its links lead somewhere, the card reference lists every card.

The links and anchors of the site are looked at here in the Markdown itself, so that it needs nothing but Python; test_site.py
builds the site and looks at the pages.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from fnmatch import fnmatch
from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import ROOT, Run
from verify.tools.card_reference import MANUAL, find_examples, page_of, read_cards, read_other_cards
from verify.tools.module_table import page as modules_page

PAGES = sorted((ROOT / "doc").rglob("*.md"))
DECK = re.compile(r"```abaqus\n(.*?)```", re.DOTALL)
LINK = re.compile(r"\]\(([^)#:\s]+)(#[^)\s]*)?\)")
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


@pytest.fixture(scope="module")
def texts(run: Run) -> dict[Path, str]:
    """All pages, those that `make doc` writes among them; pages beside doc/ that are linked come from the disk."""
    made = {MANUAL / "cards.md": page_of(run(["--cards"]).stdout), ROOT / "doc" / "developer" / "modules.md": modules_page()}
    return {page.resolve(): page.read_text() for page in PAGES} | made


def anchors_of(text: str) -> set[str]:
    """What the site makes of the headings."""
    headings = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S), flags=re.M)
    plain = [re.sub(r"[^\w\s-]", "", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)).strip().lower() for heading in headings]
    return {re.sub(r"[-\s]+", "-", heading) for heading in plain}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT / "doc")))
def test_links_lead_somewhere(texts: dict[Path, str], page: Path) -> None:
    """Links to files of the repository, and to headings in them."""
    for target, anchor in LINK.findall(page.read_text()):
        place = (page.parent / target).resolve()
        is_verification = place.parent == ROOT / "doc" / "verification"   # written by make verify
        assert place.exists() or place in texts or is_verification, f"{page.name} links to {target}, which is not there"
        if anchor and place in texts:
            assert anchor[1:] in anchors_of(texts[place]), f"{page.name} links to {target}{anchor}: there is no such heading"


def test_every_page_is_in_the_navigation(texts: dict[Path, str]) -> None:
    """And the navigation names no page that is not there."""
    settings = (ROOT / "mkdocs.yml").read_text()
    named = set(re.findall(r":\s+(\S+\.md)$", settings[settings.index("\nnav:") :], flags=re.M))
    there = {str(page.relative_to(ROOT / "doc")) for page in texts}
    apart = [pattern for block in re.findall(r"^(?:not_in_nav|exclude_docs): \|\n((?:  .*\n)+)", settings, flags=re.M) for pattern in block.split()]
    assert named - there - {"verification/index.md"} == set()
    assert {page for page in there - named if not any(fnmatch(page, pattern.lstrip("/")) for pattern in apart)} == set()


def test_part_of_your_own(run: Run, tmp_path: Path) -> None:
    """The bracket of the first job: meshed by gmsh as it is shown there, its reactions are pressure times area."""
    text = (MANUAL / "first_job.md").read_text()
    for name, kind in (("bracket.geo", "geo"), ("bracket.inp", "inp")):
        (tmp_path / name).write_text(re.search(rf"```{kind}\n(.*?)```", text, re.DOTALL)[1])
    mesh = [sys.executable, Path(sys.executable).parent / "gmsh", "-3", "bracket.geo", "-format", "inp", "-o", "bracket_mesh.inp"]
    done = subprocess.run(mesh, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    done = run(["bracket"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    force = [float(word) for word in (tmp_path / "bracket.dat").read_text().split()[-3:]]
    assert force == pytest.approx([0.0, 0.0, 640.0], abs=1e-5)


def column(table: str) -> np.ndarray:
    """A column of the history tables of job.vtkhdf in the working directory."""
    with h5py.File("job.vtkhdf") as file:
        return file[f"AMONTONS/{table}"][:]


def test_three_joints(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The press fit by Lamé, the bolt by statics, the snap fit by the slopes of its catch."""
    monkeypatch.chdir(tmp_path)

    def values(name: str, table: str) -> np.ndarray:
        assert run(["--quiet", "--outdir", tmp_path, ROOT / "input" / f"{name}.inp"]).returncode == 0
        shutil.move(f"{name}.vtkhdf", "job.vtkhdf")
        return column(table)

    # Lamé's tube is free of friction, which stiffens the deck's by a hundredth; at the end the seat is 9.8 of 10 long
    force = 78.75 * 2 * np.pi * 20 * 10
    normal, shear = values("press_fit", "pair_history/CFN"), column("pair_history/CFS")
    joined, slipping = normal[column("pair_history/step") == 1][-1, 0], np.abs(shear[:, 1]).max()
    pull = [abs(float(row.split()[1])) for row in re.findall(r"SHAFT_LOW and time.*\n\n(.*)", Path("press_fit.dat").read_text())]
    assert joined == pytest.approx(force, rel=0.01)
    assert slipping == pytest.approx(0.15 * force, rel=0.0125)
    assert max(pull) == pytest.approx(0.15 * force, rel=0.0175)
    assert pull[-1] == pytest.approx(0.15 * force * 9.8 / 10, rel=0.005)
    rows = (MANUAL / "joints.md").read_text().replace(" ", "")   # the table says the same
    for value, lame in ((joined, force), (slipping, 0.15 * force), (max(pull), 0.15 * force), (pull[-1], 0.15 * force)):
        assert f"|{value:.0f}|{lame:.0f}|{100 * (value / lame - 1):.1f}%|" in rows
    head, nut, joint = values("bolted_joint", "pair_history/CFN").reshape(-1, 3, 3)[-1, :, 1]
    assert (head, nut) == (pytest.approx(joint + 4000, rel=1e-6), pytest.approx(-head, rel=1e-6))
    assert 10000 < head < 10100
    time = values("snap_fit", "history/total_time")
    along, across = column("history/slave_force")[:, :2].T
    for at, ratio in ((0.1, -0.8 / 0.88), (0.3, -0.8 / 0.88), (0.4, -0.2), (0.6, -0.2), (0.85, 1.4 / 1.32)):
        k = int(np.argmin(np.abs(time - at)))
        assert along[k] / across[k] == pytest.approx(ratio, rel=2e-3)
    assert along[-1] == across[-1] == 0


def test_joints_show_their_decks() -> None:
    """The cards shown stand in the deck, in this order."""
    shown = re.findall(r"bin/amontons --outdir results (input/\S+)\n.*?```inp\n(.*?)```", (MANUAL / "joints.md").read_text(), re.DOTALL)
    assert len(shown) == 3
    for name, cards in shown:
        lines = iter((ROOT / name).read_text().splitlines())
        missing = [line for line in cards.splitlines() if line not in lines]   # `in` reads on to the line
        assert not missing, f"{name} has no line {missing[0]} there"


def test_every_reason_is_in_the_manual() -> None:
    """Why an increment failed, as failure_messages.f90 says it, has its row with what to do."""
    source = (ROOT / "src" / "nonlinear" / "failure_messages.f90").read_text()
    reasons = set(re.findall(r"words = '([A-Z]{4,}(?:[ -][A-Z]{2,})*)'", source))
    assert {"CONSTRAINTS", "FREE BODY", "LEFT MASTER", "STICK-SLIP FLIP", "LIMIT POINT", "SLOW"} <= reasons
    text = (MANUAL / "messages.md").read_text()
    rows = [line.split("|")[1] for line in text[text.index("## An increment that fails"):].splitlines() if line.startswith("|")]
    assert {reason for reason in reasons if not any(reason in row for row in rows)} == set()


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
    page = page_of(text)
    assert all(f"## \\{card.name}" in page for card in cards)


def test_cards_that_are_not_used_have_their_own_lists(run: Run) -> None:
    """Two headings, linked from the top of the page; each card stands in one list, under what to do instead, and in no other section."""
    text = run(["--cards"]).stdout
    lists = read_other_cards(text)
    page = page_of(text)
    sections = {part.split("\n", 1)[0]: part for part in re.split(r"^## ", page, flags=re.M)}
    top = page[: page.index("\n## ")]
    assert list(lists) == ["Cards read past with a note", "Cards refused"]
    assert list(sections)[-2:] == list(lists), "the last two sections"
    listed = [name for groups in lists.values() for _, names in groups for name in names]
    assert len(listed) == len(set(listed)) == sum(line.startswith("    *") for line in text.splitlines()) > 200
    for heading, groups in lists.items():
        assert f"[{heading.lower()}](#{heading.lower().replace(' ', '-')})" in top
        for sentence, names in groups:
            row = next(row for row in sections[heading].splitlines() if f"`{names[0]}`" in row)
            assert all(f"`{name}`" in row for name in names) and sentence.replace("*", "\\*") in row
    others = "".join(part for heading, part in sections.items() if heading not in lists)
    assert not [name for name in ("*PREPRINT", "*BUCKLE", "*CONNECTOR SECTION") if f"`{name}`" in others]


@pytest.mark.parametrize(
    ("card", "words"),
    [
        ("DYNAMIC", "*DYNAMIC needs APPLICATION=QUASI-STATIC"),
        ("DYNAMIC, APPLICATION=TRANSIENT FIDELITY", "Waves and vibration are not resolved"),
        ("MODAL DYNAMIC", "Vibration is not computed. For slow loads use *STATIC"),
        ("FREQUENCY", "Natural frequencies are not computed"),
        ("BUCKLE", "the largest reaction is the buckling load"),
        ("HEAT TRANSFER", "give them to the nodes by *TEMPERATURE"),
    ],
)
def test_other_procedures_say_what_to_do_instead(run_deck: Run, card: str, words: str) -> None:
    """Each has a sentence of its own."""
    done = run_deck("*NODE\n1, 0., 0., 0.\n*STEP\n*" + card + "\n*END STEP\n")
    assert done.returncode == 3
    assert words in re.sub(r"\s+", " ", done.stdout), done.stdout


def test_front_pages_say_the_same() -> None:
    """What it does and what not, on the first page of the repository and of the site."""
    tables = [re.findall(r"^\|.*Amontons \| CalculiX.*\n(?:\|.*\n)+", (ROOT / name).read_text(), re.M) for name in ("README.md", "doc/index.md")]
    assert len(tables[0]) == 1
    assert tables[0] == tables[1]
    cells = [cell.strip() for row in tables[0][0].splitlines()[2:] for cell in row.strip("|").split("|")[1:]]
    assert set(cells) == {"yes", "no"}


def test_front_page_links_what_a_reader_needs() -> None:
    """Both have the clone line with its honest address, one picture, the limits and the first job."""
    for name, folder in (("README.md", "doc/"), ("doc/index.md", "")):
        text = (ROOT / name).read_text()
        assert text.count("![") == 1, name
        assert "git clone https://ADDRESS/amontons.git" in text, name
        for link in ("manual/limits.md", "manual/first_job.md"):
            assert f"]({folder}{link})" in text, (name, link)
        assert "python -m verify.benchmark.pin_in_lug" in text, name


def test_contact_page_starts_with_a_picture_and_a_deck() -> None:
    """Then the rules; no list comes before them."""
    text = (ROOT / "doc/manual/contact.md").read_text()
    start = text[: text.index("*END STEP")]
    assert start.index("![") < start.index("```") < start.index("\n*CONTACT PAIR")
    assert not re.search(r"^- ", start, re.M)
