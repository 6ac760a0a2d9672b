"""Laws at random for the decks of random_contact: surfaces that give by a law, from soft to all but hard, in both dialects.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random

LINEAR_STIFFNESS = [1.0, 5.0, 30.0, 200.0, 1e3, 1e4, 1e5]  #: Young's moduli of the softer body per edge
TABLE_STIFFNESS = [10.0, 100.0, 1000.0]  #: the same, of the first piece of a table
TIED_STIFFNESS = [10.0, 100.0, 1e3, 1e4]  #: the same
STICK_SHARE = [0.01, 0.03, 0.1]  #: stick slope over the slope of the law of pressure
MAX_TIED = 0.05  #: bodies that are tied are dragged no farther [length]


@dataclass
class Law:
    """How the surfaces of a deck act on each other."""

    description: str  #: kind and stiffness
    dialect: str
    kind: str  #: of the contact pair
    behavior: str  #: the word of *SURFACE BEHAVIOR
    data: str  #: its data lines
    friction: str  #: the data line of *FRICTION; empty: none

    def cards(self, slave: str, master: str) -> str:
        """The interaction and the pair."""
        friction = f"*FRICTION\n{self.friction}\n" if self.friction else ""
        return (f"*SURFACE INTERACTION, NAME=GIVING\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE={self.behavior}\n{self.data}\n{friction}"
                f"*CONTACT PAIR, INTERACTION=GIVING, TYPE={self.kind}\n{slave}, {master}\n")  # fmt: skip


def draw_law(draw: Random, young: float, edge: float, mu: float, kind: str) -> Law:
    """A law for bodies of which the softer has a modulus, and edges of a length."""
    dialect = draw.choice(["abaqus", "calculix", "calculix"])
    if kind.startswith("SURFACE") and dialect == "calculix" and draw.random() < 0.4:
        kind = "MORTAR"
    behavior = draw.choice(["LINEAR"] * 4 + ["EXPONENTIAL"] * 2 + ["TABULAR", "TIED"])
    unit = young / edge
    if behavior == "LINEAR":
        ratio = draw.choice(LINEAR_STIFFNESS)
        tension = draw.choice(["", f", {1e-6 * young:.6g}, 1e-3"]) if dialect == "calculix" else ""
        description, stiffness, data = f"LINEAR {ratio:g}", ratio * unit, f"{ratio * unit:.9g}{tension}"
    elif behavior == "EXPONENTIAL":
        c0, p0 = draw.choice([0.05, 0.01, 0.002]), draw.choice([1e-3, 1e-2])
        description, stiffness, data = f"EXPONENTIAL {c0:g} {p0:g}", math.log(100.0) * p0 / c0 * unit, f"{c0 * edge:.9g}, {p0 * young:.9g}"
    elif behavior == "TABULAR":
        ratio, bend = draw.choice(TABLE_STIFFNESS), draw.choice([0.001, 0.01])
        description, stiffness = f"TABULAR {ratio:g}", ratio * unit
        rows = [(0.0, 0.0), (ratio * bend, bend), (5.0 * ratio * bend, 2.0 * bend), (5000.0 * ratio * bend, 1000.0 * bend)]
        data = "\n".join(f"{p * young:.9g}, {h * edge:.9g}" for p, h in rows)
    else:
        ratio = draw.choice(TIED_STIFFNESS)
        description, stiffness, data = f"TIED {ratio:g}", ratio * unit, f"{ratio * unit:.9g}"
    slope = draw.choice([*STICK_SHARE, None])
    stick = f", {slope * stiffness:.9g}" if slope and dialect == "calculix" else ""
    return Law(description, dialect, kind, behavior, data, f"{mu:g}{stick}" if mu > 0.0 else "")
