"""Decks with pairs by hand that take seconds, for the cost of general contact: plates with solids, shells, many bodies, a small contact of a large mesh.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import numpy as np

from verify.decks.general_contact import half_cylinder_on_block, turned_ring
from verify.decks.make_decks import Floats
from verify.decks.parts import Part
from verify.decks.pin_in_lug import pin_in_lug
from verify.decks.sheets import fix, pair, step

STEEL, SOFT = (210000.0, 0.3), (1000.0, 0.3)


def solids(*parts: tuple[Part, tuple[float, float]]) -> str:
    """Parts with their (E, nu)."""
    text = ""
    for part, (young, ratio) in parts:
        text += part.cards() + f"*MATERIAL, NAME=M{part.name}\n*ELASTIC\n{young}, {ratio}\n*SOLID SECTION, ELSET={part.name}, MATERIAL=M{part.name}\n"
    return text


def plate_of_shells(name: str, x: Floats, y: Floats, z: Floats, thickness: float, first: int, young: float) -> str:
    """S4 over a grid of places (n, m); surfaces NAME_UP and NAME_DOWN, node sets NAMEN, NAME_X0N and NAME_X1N."""
    n, m = x.shape
    label = first + np.arange(n * m).reshape(n, m)
    text = f"*NODE, NSET={name}N\n" + "".join(f"{k}, {a:.12g}, {b:.12g}, {c:.12g}\n" for k, a, b, c in zip(label.flat, x.flat, y.flat, z.flat, strict=True))
    corners = [(label[i, j], label[i + 1, j], label[i + 1, j + 1], label[i, j + 1]) for i in range(n - 1) for j in range(m - 1)]
    text += f"*ELEMENT, TYPE=S4, ELSET={name}\n" + "".join(f"{first + e}, {', '.join(map(str, row))}\n" for e, row in enumerate(corners))
    text += f"*MATERIAL, NAME=M{name}\n*ELASTIC\n{young}, 0.3\n*SHELL SECTION, ELSET={name}, MATERIAL=M{name}\n{thickness}\n"
    text += f"*SURFACE, NAME={name}_UP\n{name}, SPOS\n*SURFACE, NAME={name}_DOWN\n{name}, SNEG\n"
    return text + "".join(f"*NSET, NSET={name}_X{end}N\n" + "".join(f"{k}\n" for k in label[-end]) for end in (0, 1))


def slider(kind: str, fine: float) -> str:
    """A soft block pressed on a steel plate, then dragged over 0.8 of its length, with friction."""
    n = [max(round(fine * k), 1) for k in (6, 4, 3)]
    box = Part("BOX", kind, (0.5, 0.6, 1.0), (2.5, 1.9, 2.0), tuple(n))
    plate = Part("PLATE", kind, (0.0, 0.0, 0.0), (5.0, 2.5, 1.0), (2 * n[0], n[1] + 1, n[2]), 100001)
    press = step(fix("PLATE_Z0N, 1, 3", "BOX_Z1N, 1, 2", "BOX_Z1N, 3, 3, -0.05"), 2, is_nlgeom=True)
    drag = step(fix("BOX_Z1N, 1, 1, 1.6"), 16, is_nlgeom=True)
    return solids((box, SOFT), (plate, STEEL)) + pair("BOX_Z0", "PLATE_Z1", 0.2) + press + drag


def posts(kind: str, n: int, cells: int, is_nlgeom: bool) -> str:
    """n x n posts between two plates that a pressure holds together and a displacement shears."""
    size = 2.0 * n
    low = Part("LOW", kind, (0, 0, -0.5), (size, size, 0), (3 * n, 3 * n, 1), 200001)
    high = Part("HIGH", kind, (0, 0, 1), (size, size, 1.5), (3 * n, 3 * n, 1), 400001)
    stand = [Part(f"P{i}X{j}", kind, (2 * i + 0.5, 2 * j + 0.45, 0), (2 * i + 1.5, 2 * j + 1.55, 1), (cells, cells, cells), 1 + 2000 * (n * i + j))
             for i in range(n) for j in range(n)]  # fmt: skip
    law = "*SURFACE INTERACTION, NAME=RUB\n*FRICTION\n0.3\n"
    rows = "".join(f"*CONTACT PAIR, INTERACTION=RUB\n{p.name}_Z0, LOW_Z1\n*CONTACT PAIR, INTERACTION=RUB\n{p.name}_Z1, HIGH_Z0\n" for p in stand)
    load = "*DLOAD\n" + high.dload("Z1", 5.0)
    press = step(fix("LOW_Z0N, 1, 3", "HIGH_Z1N, 1, 2") + load, 1, is_nlgeom)
    shear = step(fix("HIGH_Z1N, 1, 1, 0.05"), 4, is_nlgeom)
    return solids((low, STEEL), (high, STEEL), *((p, SOFT) for p in stand)) + law + rows + press + shear


def small_in_large(kind: str, n: int, is_nlgeom: bool) -> str:
    """A small block pressed on the middle of a large one, whose mesh is fine everywhere."""
    large = Part("LARGE", kind, (0, 0, -2), (4, 4, 0), (n, n, n // 2), 1)
    small = Part("SMALL", kind, (1.7, 1.7, 0), (2.3, 2.3, 0.5), (4, 4, 3), 900001)
    press = step(fix("LARGE_Z0N, 1, 3", "SMALL_Z1N, 1, 2", "SMALL_Z1N, 3, 3, -0.02"), 3, is_nlgeom)
    return solids((large, SOFT), (small, (3000.0, 0.3))) + pair("SMALL_Z0", "LARGE_Z1", 0.3) + press


def leaves(n_leaves: int, n: int, m: int) -> str:
    """A leaf spring of shells, clamped at one end; a displacement bends all leaves, which slide on each other with friction."""
    x, y = np.meshgrid(np.linspace(0, 10, n + 1), np.linspace(0, 1, m + 1), indexing="ij")
    text, rows, held = "", "", []
    for k in range(n_leaves):
        text += plate_of_shells(f"L{k}", x, y, np.full_like(x, 0.2 * k), 0.2, 1 + 10000 * k, 2e5)
        held.append(f"L{k}_X0N, 1, 6")
        if k:
            rows += f"*CONTACT PAIR, INTERACTION=RUB\nL{k}_DOWN, L{k - 1}_UP\n"
    law = "*SURFACE INTERACTION, NAME=RUB\n*FRICTION\n0.2\n"
    return text + law + rows + step(fix(*held, f"L{n_leaves - 1}_X1N, 3, 3, -1.5"), 8, is_nlgeom=True)


def sheet_on_bars(n: int) -> str:
    """A sheet of shells that a displacement draws over three bars of solids, pressed on them by its pressure."""
    x, y = np.meshgrid(np.linspace(0, 6, n + 1), np.linspace(0, 2, n // 3 + 1), indexing="ij")
    text = plate_of_shells("SHEET", x, y, np.full_like(x, 0.05), 0.1, 1, 2e4)
    bars = [Part(f"BAR{i}", "C3D8", (1.0 + 1.9 * i, -0.1, -0.5), (1.4 + 1.9 * i, 2.1, 0), (4, n // 3, 3), 100001 + 10000 * i) for i in range(3)]
    law = "*SURFACE INTERACTION, NAME=RUB\n*FRICTION\n0.1\n"
    rows = "".join(f"*CONTACT PAIR, INTERACTION=RUB\n{bar.name}_Z1, SHEET_DOWN\n" for bar in bars)
    load = "*DLOAD\nSHEET, P, -0.5\n"
    press = step(fix(*(f"{bar.name}_Z0N, 1, 3" for bar in bars), "SHEET_X0N, 1, 2") + load, 2, is_nlgeom=True)
    return text + solids(*((bar, STEEL) for bar in bars)) + law + rows + press + step(fix("SHEET_X0N, 1, 1, -0.5"), 10, is_nlgeom=True)


LARGE_DECKS = {
    "slider-c3d8": lambda: slider("C3D8", 2.0),
    "slider-c3d10": lambda: slider("C3D10", 0.8),
    "posts-c3d8i": lambda: posts("C3D8I", 4, 3, True),
    "posts-c3d20r": lambda: posts("C3D20R", 2, 2, False),
    "small-in-large-c3d8": lambda: small_in_large("C3D8", 28, False),
    "small-in-large-c3d10": lambda: small_in_large("C3D10", 12, True),
    "leaves-s4": lambda: leaves(3, 16, 2),
    "sheet-on-bars": lambda: sheet_on_bars(24),
    "half-cylinder-cpe4": lambda: half_cylinder_on_block(80, "BLOCK"),
    "ring-cpe4": lambda: turned_ring(6.0),
    "many-posts-c3d8": lambda: posts("C3D8", 6, 2, True),
    "pin-in-lug-c3d10": lambda: pin_in_lug(6.0),
}
