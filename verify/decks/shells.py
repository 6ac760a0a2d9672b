"""Meshes of shells over a rectangle of parameters, as deck text.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclass
class Shell:
    """Nodes, elements and parameters of a mesh."""

    kind: str
    uv: Floats  # (n, 2) parameters of the nodes
    nodes: Floats  # (n, 3)
    elements: list[list[int]]

    def cards(self) -> str:
        """NODE and ELEMENT; the sets N and E."""
        rows = "".join(f"{i + 1}, {x:.15g}, {y:.15g}, {z:.15g}\n" for i, (x, y, z) in enumerate(self.nodes))
        body = "".join(f"{e + 1}, {', '.join(str(n + 1) for n in nodes)}\n" for e, nodes in enumerate(self.elements))
        return f"*NODE, NSET=N\n{rows}*ELEMENT, TYPE={self.kind}, ELSET=E\n{body}"

    def where(self, axis: int, value: float) -> list[int]:
        """Nodes (from 0) on a line of the parameters."""
        return [int(i) for i in np.flatnonzero(np.abs(self.uv[:, axis] - value) < 1e-9)]

    def at(self, u: float, v: float) -> int:
        """The node (from 0) nearest to a place."""
        return int(np.argmin(np.abs(self.uv - np.array([u, v])).sum(axis=1)))

    def edge_weights(self, axis: int, value: float) -> dict[int, float]:
        """Consistent shares of the nodes in an even force on an edge of the parameters; they sum to 1."""
        line = sorted(self.where(axis, value), key=lambda i: self.uv[i, 1 - axis])
        parts = [1 / 6, 4 / 6, 1 / 6] if is_quadratic(self.kind) else [0.5, 0.5]
        weights = dict.fromkeys(line, 0.0)
        pieces = range(0, len(line) - 1, len(parts) - 1)
        for k in pieces:
            for j, part in enumerate(parts):
                weights[line[k + j]] += part / len(pieces)
        return weights


def is_quadratic(kind: str) -> bool:
    """Whether a kind has nodes on its sides."""
    return kind[1] in "68"


def shell(kind: str, cells: tuple[int, int], place: Callable[[Floats, Floats], tuple[Floats, Floats, Floats]]) -> Shell:
    """Cells of u and v in 0..1; triangles halve them."""
    step = 2 if is_quadratic(kind) else 1
    n, m = (step * c for c in cells)
    index = {}
    uv = []
    for j in range(m + 1):
        for i in range(n + 1):
            if kind[1] == "8" and i % 2 and j % 2:
                continue
            index[i, j] = len(uv)
            uv.append((i / n, j / m))
    elements = []
    for j in range(0, m, step):
        for i in range(0, n, step):
            corners = [(i, j), (i + step, j), (i + step, j + step), (i, j + step)]
            pieces = [corners] if kind[1] in "48" else [corners[:3], [corners[2], corners[3], corners[0]]]
            for piece in pieces:
                sides = [((a[0] + b[0]) // 2, (a[1] + b[1]) // 2) for a, b in zip(piece, piece[1:] + piece[:1], strict=True)]
                elements.append([index[p] for p in piece + (sides if is_quadratic(kind) else [])])
    parameters = np.array(uv)
    return Shell(kind, parameters, np.column_stack(place(parameters[:, 0], parameters[:, 1])), elements)


def section(modulus: float, ratio: float, thickness: float, density: float = 0.0, more: str = "") -> str:
    """MATERIAL and SHELL SECTION."""
    weight = f"*DENSITY\n{density:.15g}\n" if density else ""
    return f"*MATERIAL, NAME=M\n*ELASTIC\n{modulus:.15g}, {ratio:.15g}\n{weight}*SHELL SECTION, ELSET=E, MATERIAL=M{more}\n{thickness:.15g}\n"


def held(nodes: list[int], what: str) -> str:
    """BOUNDARY rows: a word, or degrees of freedom as in '1, 3'."""
    return "*BOUNDARY\n" + "".join(f"{i + 1}, {what}\n" for i in nodes) if nodes else ""
