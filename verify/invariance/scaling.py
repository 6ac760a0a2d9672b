"""The same deck in other units, with other labels, or with the cards of the model in another order.

Every card that a deck may hold is known here with the units of its numbers; one that is not known is an error, so that nothing
is scaled in silence by one.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import random
import re
from dataclasses import dataclass

#: Cards without numbers that have a unit.
PLAIN = {"HEADING", "ELEMENT", "NSET", "ELSET", "SURFACE", "MATERIAL", "SOLID SECTION", "SURFACE INTERACTION", "FRICTION",
         "CONTACT PAIR", "STEP", "STATIC", "END STEP", "CONTROLS", "NODE PRINT", "EL PRINT", "CONTACT PRINT", "NODE FILE", "EL FILE",
         "CONTACT FILE", "NODE OUTPUT", "ELEMENT OUTPUT", "CONTACT OUTPUT", "OUTPUT", "LINE SEARCH", "AMPLITUDE", "CHANGE FRICTION",
         "CHANGE SURFACE BEHAVIOR", "MODEL CHANGE", "EQUATION", "INCLUDE"}  # fmt: skip
#: Card to the units of the numbers of a data line; the last one repeats. L length, F force, S stress, K stress per length, 1 none.
UNITS = {"NODE": "1L", "ELASTIC": "S1", "CLOAD": "11F", "DSLOAD": "11S", "SURFACE BEHAVIOR": "K", "CONTACT INTERFERENCE": "11L"}
MODEL_END = "*STEP"


@dataclass
class Units:
    """One unit of length and of force of the model in the deck's."""

    length: float = 1.0
    force: float = 1.0

    def of(self, letter: str) -> float:
        """The factor of a unit."""
        stress = self.force / self.length**2
        return {"1": 1.0, "L": self.length, "F": self.force, "S": stress, "K": stress / self.length}[letter]


def cards(deck: str) -> list[list[str]]:
    """Keyword line and data lines of each card; comments are dropped."""
    result: list[list[str]] = []
    for line in deck.splitlines():
        if line.startswith("**"):
            continue
        if line.startswith("*"):
            result.append([line])
        elif result:
            result[-1].append(line)
    return result


def keyword(card: list[str]) -> str:
    """In upper case."""
    return re.sub(r"\s+", " ", card[0][1:].split(",")[0].strip().upper())


def scaled(deck: str, units: Units) -> str:
    """The deck in other units, with controls so tight that what is left is below what is compared."""
    return "\n".join(line for card in cards(deck) for line in scaled_card(card, units)) + "\n"


def scaled_card(card: list[str], units: Units) -> list[str]:
    """One card."""
    name = keyword(card)
    if name == "STATIC":
        return [*card, "*CONTROLS, PARAMETERS=FIELD", "1e-10, 1e-10, , , 1e-10"]
    if name == "CONTROLS" and "FIELD" in card[0].upper():
        return []
    if name == "CLEARANCE":
        return [re.sub(r"(VALUE=)([^,]+)", lambda m: m.group(1) + times(m.group(2), units.of("L")), card[0])]
    if name == "BOUNDARY":
        return [card[0], *(row(line, "111L", units) for line in card[1:])]
    if name == "DLOAD":
        return [card[0], *(row(line, "11S", units) if "GRAV" not in line.upper() else refuse(name) for line in card[1:])]
    if name in UNITS:
        return [card[0], *(row(line, UNITS[name], units) for line in card[1:])]
    return card if name in PLAIN else [refuse(name)]


def refuse(name: str) -> str:
    """What cannot be scaled."""
    raise ValueError(f"the units of *{name} are not known to scaling.py")


def times(text: str, factor: float) -> str:
    """A number times a factor; a word as it is."""
    try:
        return f"{float(text) * factor:.17g}" if factor != 1.0 else text
    except ValueError:
        return text


def row(line: str, letters: str, units: Units) -> str:
    """One data line."""
    fields = line.split(",")
    return ", ".join(times(text.strip(), units.of(letters[min(i, len(letters) - 1)])) for i, text in enumerate(fields))


def shuffled(deck: str, seed: int) -> str:
    """The cards of the model in another order; those that belong to the card before them stay behind it."""
    model, steps = deck[: deck.index(MODEL_END)], deck[deck.index(MODEL_END) :]
    groups: list[list[str]] = []
    followers = {"ELASTIC", "DENSITY", "FRICTION", "SURFACE BEHAVIOR"}
    for card in cards(model):
        if keyword(card) in followers and groups:
            groups[-1] += card
        else:
            groups.append(list(card))
    random.Random(seed).shuffle(groups)
    return "\n".join(line for group in groups for line in group) + "\n" + steps
