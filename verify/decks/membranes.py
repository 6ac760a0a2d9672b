"""Decks of membranes: meshes of shells with membranes in their place.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verify.decks.shells import Floats, Shell, shell

KINDS = ["M3D3", "M3D4", "M3D4R", "M3D6", "M3D8", "M3D8R"]


def membrane(kind: str, cells: tuple[int, int], place: Callable[[Floats, Floats], tuple[Floats, Floats, Floats]]) -> Shell:
    """Cells of u and v in 0..1; triangles halve them."""
    mesh = shell("S" + kind[3:], cells, place)
    mesh.kind = kind
    return mesh


def quarter_disc(kind: str, n: int, radius: float, height: Callable[[Floats], Floats] | None = None) -> Shell:
    """A quarter of a disc about the z axis from a square: u = 0 is the plane x = 0, v = 0 the plane y = 0, the other two sides the rim."""

    def place(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
        x, y = u * np.sqrt(1 - v**2 / 2), v * np.sqrt(1 - u**2 / 2)
        r = np.hypot(x, y)
        return radius * x, radius * y, height(r) if height else 0 * x

    return membrane(kind, (n, n), place)


def membrane_section(material: str, thickness: float, more: str = "") -> str:
    """MATERIAL, whose cards are given, and MEMBRANE SECTION."""
    return f"*MATERIAL, NAME=M\n{material}*MEMBRANE SECTION, ELSET=E, MATERIAL=M{more}\n{thickness:.15g}\n"
