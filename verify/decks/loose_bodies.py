"""Decks of loose bodies in the plane: stacks of blocks and walls of bricks with small gaps, under gravity and a lateral push.

SPDX-License-Identifier: GPL-3.0-or-later

Nothing but contact supports a block: each must fall on the one below. Every block is pushed sideways by a force below the friction limit of all joints.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from verify.decks.planes import Plane, flat_deck, flatten
from verify.decks.sheets import between, fix, sheet, step

STIFF = (210000.0, 0.3)  #: E, nu of blocks and table; a stack of 40 stays far below the load at which its own weight buckles it
DENSITY, GRAVITY = 1e-5, 1e4  #: a block of area 1 and thickness 1 weighs 0.1


@dataclass(frozen=True)
class Pile:
    """A pile of loose bodies on a table."""

    deck: str
    blocks: list[Plane]  #: from below
    weight: float  #: of all blocks
    push: float  #: on all blocks, along +x
    mu: float  #: of all joints


def _pile(blocks: list[tuple[str, Plane]], joints: list[tuple[str, str]], table: Plane, push: float, mu: float, cells: int, n: int, options: str) -> Pile:
    """The deck of blocks on TABLE; joints (slave surface, master surface); the push acts on the left side of every block."""
    names = [name for name, _ in blocks]
    areas = {name: float(np.ptp(part.nodes[:, 0]) * np.ptp(part.nodes[:, 1])) for name, part in blocks}
    cards = f"*SURFACE INTERACTION, NAME=JOINT\n*FRICTION\n{mu:.15g}\n"
    for slave, master in joints:
        cards += f"*CONTACT PAIR, INTERACTION=JOINT{options}\n{slave}, {master}\n"
    weights = "*DLOAD\n" + "".join(f"{name}, GRAV, {GRAVITY:.15g}, 0., -1.\n" for name in names)
    pushes = "*CLOAD\n" + "".join(f"{name}_LEFT, 1, {push * DENSITY * GRAVITY * areas[name] / (cells + 1):.15g}\n" for name in names) if push else ""
    cards += step(fix("TABLE_BOTTOM, 1, 2") + weights + pushes, n, True)
    deck = flat_deck([*((part, STIFF) for _, part in blocks), (table, STIFF)], "CPE4", cards)
    for name in names:
        deck = deck.replace(f"*SOLID SECTION, ELSET={name},", f"*DENSITY\n{DENSITY:.15g}\n*SOLID SECTION, ELSET={name},", 1)
    weight = DENSITY * GRAVITY * sum(areas.values())
    return Pile(deck, [part for _, part in blocks], weight, push * weight, mu)


def stack(n_blocks: int, gap: float = 0.01, push: float | None = None, mu: float = 0.2, cells: int = 2, increments: int = 1, options: str = "") -> Pile:
    """Blocks of edge 1 one above the other, each `gap` above the one below.

    `push` is that on a block over its weight. By default the resultant at the foot is 0.15 off the middle, so that the stack stands on its whole foot.
    """
    push = 0.3 / max(n_blocks, 3) if push is None else push
    table = flatten(sheet("TABLE", between(-1, 2, 7), between(-1, 0, 2)))
    blocks, joints, below = [], [], "TABLE_TOP"
    for i in range(n_blocks):
        low = gap + i * (1 + gap)
        name = f"B{i + 1}"
        blocks.append((name, flatten(sheet(name, between(0, 1, cells), between(low, low + 1, cells)))))
        joints.append((f"{name}_BOTTOM", below))
        below = f"{name}_TOP"
    return _pile(blocks, joints, table, push, mu, cells, increments, options)


def wall(n_rows: int, n_columns: int, gap: float = 0.01, push: float = 0.05, mu: float = 0.2, cells: int = 2, increments: int = 1,
         options: str = "") -> Pile:  # fmt: skip
    """Bricks 2 by 1 in running bond with a gap on all sides; every second row begins and ends with a half brick."""
    pitch = 2 + gap
    length = n_columns * pitch - gap
    table = flatten(sheet("TABLE", between(-1, length + 1, 2 * n_columns + 3), between(-1, 0, 2)))
    blocks, joints, below = [], [], []
    for row in range(n_rows):
        low = gap + row * (1 + gap)
        ends = [(c * pitch, c * pitch + 2) for c in range(n_columns)]
        if row % 2 == 1:
            middle = [((c + 0.5) * pitch, (c + 0.5) * pitch + 2) for c in range(n_columns - 1)]
            ends = [(0.0, middle[0][0] - gap), *middle, (middle[-1][1] + gap, length)]
        here = []
        for column, (left, right) in enumerate(ends):
            name = f"B{row + 1}X{column + 1}"
            n_along = cells * round(right - left)
            blocks.append((name, flatten(sheet(name, between(left, right, n_along), between(low, low + 1, cells)))))
            if here:
                joints.append((f"{name}_LEFT", f"{here[-1][0]}_RIGHT"))
            joints += [(f"{name}_BOTTOM", f"{other}_TOP") for other, start, end in below if start < right and left < end]
            if row == 0:
                joints.append((f"{name}_BOTTOM", "TABLE_TOP"))
            here.append((name, left, right))
        below = here
    return _pile(blocks, joints, table, push, mu, cells, increments, options)


def by_inertia(deck: str, times: str, of_step: str = "") -> str:
    """The deck of a static step with inertia in its place, density 1e-3 where there is none."""
    heavy = re.sub(r"(\*(?:ELASTIC|HYPERELASTIC.*)\n.*\n)(?!\*DENSITY)", r"\1*DENSITY\n1e-3\n", deck)
    heavy = re.sub(r"\*STATIC.*\n.*\n", f"*DYNAMIC, APPLICATION=QUASI-STATIC\n{times}\n", heavy)
    return re.sub(r"\*STEP.*", f"*STEP, NLGEOM, INC=2000{of_step}", heavy)
