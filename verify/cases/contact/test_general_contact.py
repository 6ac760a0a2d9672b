"""General contact against the same decks with pairs by hand: the same slaves and masters give the same results.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.planes import flat_deck, flatten
from verify.decks.sheets import between, fix, pair, sheet, step

EQUAL = 1e-6  #: over the largest value: the pairs are the same, but for faces beside those in contact
KEYWORD = re.compile(r"(?m)^(?=\*[A-Za-z])")
INPUT_DECKS = ["three_cubes", "press_fit", "bolted_joint"]
SOFT, STIFF = (1000.0, 0.3), (9000.0, 0.3)


def split_cards(deck: str) -> list[str]:
    """The cards of a deck with their lines."""
    return KEYWORD.split(deck)


def with_pairs(deck: str, form: str = "SURFACE") -> str:
    """The deck with pairs of a kind and without what names a pair."""
    cards = [card for card in split_cards(deck) if not card.startswith("*CONTACT INTERFERENCE")]
    plain = [re.sub(r", TYPE=(NODE|SURFACE) TO SURFACE", "", card) if card.startswith("*CONTACT PAIR") else card for card in cards]
    typed = [re.sub(r"(\*CONTACT PAIR[^\n]*)", rf"\1, TYPE={form} TO SURFACE", card, count=1) for card in plain]
    return "".join(re.sub(r"(\*CONTACT PRINT)[^\n]*", r"\1", card) for card in typed)


def with_general_contact(deck: str, has_roles: bool = True) -> str:
    """The deck with general contact in place of its pairs; the roles of slave and master are those of the pairs."""
    cards, rows, interactions = [], "", []
    for card in split_cards(with_pairs(deck)):
        if not card.startswith("*CONTACT PAIR"):
            cards.append(card)
            continue
        lines = [line for line in card.splitlines()[1:] if line.strip() and not line.startswith("**")]
        interactions += [f"{line}, {re.search(r'INTERACTION=([^,]*)', card.splitlines()[0])[1]}" for line in lines]  # type: ignore[index]
        rows += "".join(f"{line}, SLAVE\n" for line in lines)
    first = next(i for i, card in enumerate(cards) if card.startswith("*STEP"))
    rules = "*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n*CONTACT PROPERTY ASSIGNMENT\n" + "\n".join(interactions) + "\n"
    rules += "*CONTACT FORMULATION, TYPE=MASTER SLAVE ROLES\n" + rows if has_roles else ""
    return "".join(cards[:first]) + rules + "".join(cards[first:])


def block_on_block(kind: str, upper: tuple[float, float] = SOFT) -> str:
    """A block 2 x 1 pressed on a wider one, with friction, then dragged."""
    is_quadratic = kind[3] in "68"
    parts = [flatten(sheet("UPPER", between(0.5, 2.5, 6), between(1, 2, 3)), is_quadratic),
             flatten(sheet("LOWER", between(0, 4, 8), between(0, 1, 3)), is_quadratic)]  # fmt: skip
    press = step(fix("LOWER_BOTTOM, 1, 2", "UPPER_TOP, 1", "UPPER_TOP, 2, 2, -0.05"), 2, is_nlgeom=True)
    drag = step(fix("UPPER_TOP, 1, 1, 0.3"), 4, is_nlgeom=True)
    return flat_deck(list(zip(parts, (upper, STIFF), strict=True)), kind, pair("UPPER_BOTTOM", "LOWER_TOP", 0.2) + press + drag)


def corner(kind: str) -> str:
    """A block in a corner of a floor and a wall: its corner node is slave of both."""
    parts = [flatten(sheet("BOX", between(0, 1, 4), between(0, 1, 4))), flatten(sheet("FLOOR", between(-1, 2, 9), between(-0.5, 0, 1))),
             flatten(sheet("WALL", between(1, 1.5, 1), between(0.1, 1.5, 5)))]  # fmt: skip
    held = fix("FLOOR_BOTTOM, 1, 2", "FLOOR_TOP, 1", "WALL_RIGHT, 1, 2")
    loads = "*DSLOAD\nBOX_TOP, P, 10.\nBOX_LEFT, P, 4.\n"
    pairs = pair("BOX_BOTTOM", "FLOOR_TOP", 0.1) + pair("BOX_RIGHT", "WALL_LEFT", 0.1)
    return flat_deck([(parts[0], SOFT), (parts[1], STIFF), (parts[2], STIFF)], kind, pairs + step(held + loads, 2))


def sheets_in_a_stack(kind: str) -> str:
    """Four thin sheets: each sees the next one only, not its far side nor the sheet behind it."""
    names = ["A", "B", "C", "D"]
    parts = [flatten(sheet(name, between(0, 4, 8), between(0.1 * i, 0.1 * (i + 1), 1))) for i, name in enumerate(names)]
    pairs = "".join(pair(f"{upper}_BOTTOM", f"{lower}_TOP", 0.3) for lower, upper in zip(names, names[1:], strict=False))
    loads = fix("A_BOTTOM, 2", *(f"{name}_LEFT, 1" for name in names)) + "*DSLOAD\nD_TOP, P, 3.\n"
    return flat_deck([(part, SOFT) for part in parts], kind, pairs + step(loads, 1, is_nlgeom=True))


DECKS = {
    "block-cpe4": lambda: block_on_block("CPE4"),
    "block-cpe8": lambda: block_on_block("CPE8"),
    "block-cps4r": lambda: block_on_block("CPS4R"),
    "corner-cpe4": lambda: corner("CPE4"),
    "corner-cps4": lambda: corner("CPS4"),
    "stack-cpe4": lambda: sheets_in_a_stack("CPE4"),
    "stack-cps4": lambda: sheets_in_a_stack("CPS4"),
}


def compare(run: Run, folder: Path, by_hand: str, general: str) -> str:
    """Runs both decks; displacements and stresses must be the same. The output of the second."""
    results = []
    for name, deck in (("hand", by_hand), ("general", general)):
        (folder / f"{name}.inp").write_text(deck)
        done = run(["--outdir", folder, folder / f"{name}.inp"], folder)
        assert done.returncode == 0, done.stdout + done.stderr
        with h5py.File(folder / f"{name}.vtkhdf") as file:
            results.append([np.asarray(file[f"VTKHDF/PointData/{field}"]) for field in ("U", "S")])
    for field, ours in zip(*results, strict=True):
        assert field.shape == ours.shape
        assert np.abs(field - ours).max() <= EQUAL * np.abs(field).max()
    return done.stdout


@pytest.mark.parametrize("name", INPUT_DECKS)
def test_input_decks(run: Run, root: Path, tmp_path: Path, name: str) -> None:
    """The decks of the manual with friction, finite sliding, overlaps and a pre-tension section."""
    for mesh in (root / "input").glob("*.mesh"):
        (tmp_path / mesh.name).write_text(mesh.read_text())
    deck = (root / "input" / f"{name}.inp").read_text()
    compare(run, tmp_path, with_pairs(deck), with_general_contact(deck))


@pytest.mark.parametrize("name", ["block-cpe4", "block-cpe8", "corner-cpe4", "stack-cpe4"])
def test_node_to_surface(run: Run, tmp_path: Path, name: str) -> None:
    """The same with contact at the nodes of the slave."""
    deck = DECKS[name]()
    general = with_general_contact(deck).replace("*CONTACT\n", "*CONTACT, TYPE=NODE TO SURFACE\n")
    assert "General contact: " in compare(run, tmp_path, with_pairs(deck, "NODE"), general)


@pytest.mark.parametrize("name", DECKS)
def test_plane_decks(run: Run, tmp_path: Path, name: str) -> None:
    """Blocks, corners and stacks of sheets; in the stacks no sheet sees the far side of another."""
    deck = DECKS[name]()
    assert "General contact: " in compare(run, tmp_path, with_pairs(deck), with_general_contact(deck))


def test_choice_of_the_slave(run: Run, tmp_path: Path) -> None:
    """Left to itself it takes the softer body as slave, as the pair by hand does, and says so."""
    deck = block_on_block("CPE4")
    output = compare(run, tmp_path, with_pairs(deck), with_general_contact(deck, has_roles=False))
    assert re.search(r"slave UPPER#\d+ \(\d+ faces\), master LOWER \(\d+ faces\), interaction ON_LOWER_TOP: the slave is softer\.", output)


def stretched(options: str = "") -> str:
    """A soft column that a force stretches by three quarters of its length onto a block: farther than the search looks."""
    parts = [flatten(sheet("COLUMN", between(0, 1, 2), between(0, 4, 8))), flatten(sheet("STOP", between(-1, 2, 6), between(-5, -3, 4)))]
    loads = fix("COLUMN_TOP, 2", "COLUMN_LEFT, 1", "STOP_BOTTOM, 1, 2") + "*CLOAD\nCOLUMN_BOTTOM, 2, -125.\n"
    rules = f"*CONTACT{options}\n*CONTACT INCLUSIONS, ALL EXTERIOR\n"
    return flat_deck([(parts[0], SOFT), (parts[1], STIFF)], "CPE4R", rules + step(loads, 20, is_nlgeom=True))


def test_motion(run: Run, tmp_path: Path) -> None:
    """A body that comes from too far ends the job with a sentence; with REACH it finds its contact."""
    (tmp_path / "short.inp").write_text(stretched())
    done = run(["--outdir", tmp_path, tmp_path / "short.inp"], tmp_path)
    assert done.returncode == 5, done.stdout + done.stderr
    assert re.search(r"General contact: element \d+ of (COLUMN reached STOP|STOP reached COLUMN)", done.stdout + done.stderr), done.stderr
    (tmp_path / "long.inp").write_text(stretched(", REACH=8."))
    done = run(["--outdir", tmp_path, tmp_path / "long.inp"], tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(tmp_path / "long.vtkhdf") as file:
        n = file["VTKHDF/NumberOfPoints"][0]
        u = np.asarray(file["VTKHDF/PointData/U"])[-n:]
        assert np.asarray(file["VTKHDF/PointData/CPRESS"])[-n:].max() > 0
    assert -3.05 < u[:3, 1].min() < -2.95, "the corners of the foot on the block, which gives way a little"
