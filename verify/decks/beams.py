"""Straight beams along x with cross-sections of all kinds, as deck text.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LENGTH = 10.0
MODULUS = 2.1e5
RATIO = 0.3


@dataclass
class Section:
    """A cross-section: its card and its constants by thin or solid formulas."""

    word: str
    data: str  # of the abaqus dialect
    area: float
    inertia_1: float  # integral of the square of the coordinate along direction 1: bending by a force along it
    inertia_2: float
    torsion: float


def circle(r: float) -> Section:
    """A full circle."""
    return Section("CIRC", f"{r}", np.pi * r**2, np.pi * r**4 / 4, np.pi * r**4 / 4, np.pi * r**4 / 2)


def rectangle(a: float, b: float) -> Section:
    """A rectangle; its torsion constant is that of the solid of 20 nodes, which warps as x y (doc/theory/elements.md)."""
    one, two = b * a**3 / 12, a * b**3 / 12
    return Section("RECT", f"{a}, {b}", a * b, one, two, 4 * one * two / (one + two))


def pipe(r: float, t: float) -> Section:
    """A circle with a hole."""
    i = np.pi * (r**4 - (r - t) ** 4) / 4
    return Section("PIPE", f"{r}, {t}", np.pi * (r**2 - (r - t) ** 2), i, i, 2 * i)


def box(a: float, b: float, walls: tuple[float, float, float, float]) -> Section:
    """A thin box by its middle lines; walls at +1, +2, -1, -2; torsion is not set."""
    t1, t2, t3, t4 = walls
    width, height = a - (t1 + t3) / 2, b - (t2 + t4) / 2
    areas = np.array([t1 * height, t2 * width, t3 * height, t4 * width])
    one = np.array([a / 2 - t1 / 2, (t3 - t1) / 4, -(a / 2 - t3 / 2), (t3 - t1) / 4])  # middles of the walls along direction 1
    two = np.array([(t4 - t2) / 4, b / 2 - t2 / 2, (t4 - t2) / 4, -(b / 2 - t4 / 2)])
    own_1 = np.array([0.0, width**2 / 12, 0.0, width**2 / 12])
    own_2 = np.array([height**2 / 12, 0.0, height**2 / 12, 0.0])
    area = areas.sum()
    c1, c2 = (areas @ one) / area, (areas @ two) / area
    return Section("BOX", f"{a}, {b}, {t1}, {t2}, {t3}, {t4}", area, float(areas @ ((one - c1) ** 2 + own_1)), float(areas @ ((two - c2) ** 2 + own_2)), 0.0)


def beam(kind: str, section: Section, data: str = "", n: int = 10) -> str:
    """Nodes, elements and section of a beam along x; direction 1 is y, direction 2 is z. The sets N, E, END (the node at x = LENGTH)."""
    step = 2 if kind[1:3] in ("32", "22") else 1
    count = step * n + 1
    nodes = "".join(f"{i + 1}, {LENGTH * i / (count - 1):.15g}, 0., 0.\n" for i in range(count))
    elements = "".join(f"{e + 1}, {', '.join(str(step * e + 1 + k) for k in range(step + 1))}\n" for e in range(n))
    return (
        f"*NODE, NSET=N\n{nodes}*NSET, NSET=END\n{count}\n*ELEMENT, TYPE={kind}, ELSET=E\n{elements}*MATERIAL, NAME=M\n*ELASTIC\n{MODULUS:.15g}, {RATIO}\n"
        f"*DENSITY\n1.\n*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION={section.word}\n{data or section.data}\n0., 1., 0.\n"
    )
