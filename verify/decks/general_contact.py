"""Decks with pairs by hand, and the same decks with general contact.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re

import numpy as np

from verify.decks.grids import bodies_deck, grid
from verify.decks.make_decks import Floats
from verify.decks.planes import flat_deck, flatten
from verify.decks.sheets import between, fix, pair, sheet, step

KEYWORD = re.compile(r"(?m)^(?=\*[A-Za-z])")
INPUT_DECKS = ["three_cubes", "press_fit", "bolted_joint"]  #: of the folder input
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


def half_cylinder_on_block(n_block: int, slave: str, gap: float = 0.0) -> str:
    """A half cylinder of radius 1.5 with 24 elements of 0.25 through the wall, pressed 0.3 into a block of length 20, then dragged over it by 14.

    slave: BLOCK (with few elements it reaches through several of the cylinder) or CYL.
    """
    radius, way, height = 1.5, 14.0, 2.0

    def place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        r = radius * (1 - 0.5 * t)
        return 3 + r * np.cos(np.pi * (1 + s)), height + gap + radius + r * np.sin(np.pi * (1 + s))

    block, cylinder = grid("BLOCK", between(0, 20, n_block), between(0, height, 2)), grid("CYL", between(0, 1, 24), between(0, 1, 3), place=place)
    contact = pair("BLOCK_T1", "CYL_T0") if slave == "BLOCK" else pair("CYL_T0", "BLOCK_T1")
    press = step(fix("BLOCK_T0, 1, 2", "CYL_T1, 1", f"CYL_T1, 2, 2, {-0.3 - gap}"), 4, is_nlgeom=True)
    drag = step(fix(f"CYL_T1, 1, 1, {way}"), 40, is_nlgeom=True)
    return bodies_deck([(block, "*ELASTIC\n1000., 0.3\n"), (cylinder, "*ELASTIC\n20000., 0.3\n")], "CPE4", contact + press + drag)


def turned_ring(turn: float) -> str:
    """A rigid ring of radius 1.5, pressed 0.1 into a block and turned on the spot without friction."""
    radius = 1.5

    def place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        r = radius * (1 - 0.5 * t)
        return 3 + r * np.cos(2 * np.pi * s), 2 + radius + r * np.sin(2 * np.pi * s)

    block = grid("BLOCK", between(0, 6, 24), between(0, 2, 6))
    ring = grid("RING", between(0, 1, 36), between(0, 1, 2), place=place, is_closed=True)
    body = f"*NODE\n90000, 3., {2 + radius}\n*RIGID BODY, ELSET=RING, REF NODE=90000\n"
    press = step(fix("BLOCK_T0, 1, 2", "90000, 1", "90000, 2, 2, -0.1", "90000, 6"), 4, is_nlgeom=True)
    spin = step(fix(f"90000, 6, 6, {turn}"), 20, is_nlgeom=True)
    return bodies_deck([(block, "*ELASTIC\n1000., 0.3\n"), (ring, "*ELASTIC\n20000., 0.3\n")], "CPE4", body + pair("BLOCK_T1", "RING_T0") + press + spin)


DECKS = {
    "block-cpe4": lambda: block_on_block("CPE4"),
    "block-cpe8": lambda: block_on_block("CPE8"),
    "block-cps4r": lambda: block_on_block("CPS4R"),
    "corner-cpe4": lambda: corner("CPE4"),
    "corner-cps4": lambda: corner("CPS4"),
    "stack-cpe4": lambda: sheets_in_a_stack("CPE4"),
    "stack-cps4": lambda: sheets_in_a_stack("CPS4"),
}
