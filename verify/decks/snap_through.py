"""Decks of structures that snap through, for *STATIC, RIKS.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

TRUSSES = """*NODE, NSET=ALL
1, -10., 0., 0.
2, 0., 1., 0.
3, 10., 0., 0.
*NSET, NSET=LOADED
2
*ELEMENT, TYPE=T3D2, ELSET=E
1, 1, 2
2, 2, 3
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET=E, MATERIAL=M
1.
*BOUNDARY
1, 1, 3
3, 1, 3
2, 1
2, 3
"""  #: a von Mises truss: two bars, their ridge 1 above the supports at +-10


def path_step(line: str, loads: str, increments: int = 200) -> str:
    """A RIKS step, with the displacements of the loaded node in the .dat file."""
    return f"*STEP, NLGEOM, INC={increments}\n*STATIC, RIKS\n{line}\n{loads}*NODE PRINT, NSET=LOADED\nU\n*END STEP\n"


class Mesh:
    """Nodes by their place, and elements."""

    def __init__(self) -> None:
        self.nodes: dict[tuple[float, ...], int] = {}
        self.elements: list[list[int]] = []

    def node(self, *place: float) -> int:
        """The node at a place."""
        return self.nodes.setdefault(tuple(round(x, 6) for x in place), len(self.nodes) + 1)

    def add_quadrilateral(self, corners: Sequence[np.ndarray]) -> None:
        """Eight nodes: the corners, then the middles of the sides."""
        middles = [0.5 * (corners[i] + corners[(i + 1) % 4]) for i in range(4)]
        self.elements.append([self.node(*place) for place in [*corners, *middles]])

    def write(self, kind: str, moved: dict[int, np.ndarray] | None = None) -> str:
        """The cards of nodes and elements."""
        lines = ["*NODE, NSET=ALL"]
        for place, label in self.nodes.items():
            lines.append(f"{label}, " + ", ".join(f"{x:.10g}" for x in (place if moved is None else moved[label])))
        lines.append(f"*ELEMENT, TYPE={kind}, ELSET=E")
        for label, nodes in enumerate(self.elements, 1):
            words = [str(x) for x in [label, *nodes]]
            lines += [", ".join(words[:11]) + ("," if len(words) > 11 else "")] + ([", ".join(words[11:])] if len(words) > 11 else [])
        return "\n".join(lines) + "\n"


def supports(rows: Iterable[tuple[int, int, int]]) -> str:
    """A BOUNDARY card: node, first and last degree of freedom."""
    return "*BOUNDARY\n" + "".join(f"{node}, {first}, {last}\n" for node, first, last in rows)


def material(youngs_modulus: float, poissons_ratio: float, thickness: str = "") -> str:
    """The cards of an elastic material."""
    return f"*MATERIAL, NAME=M\n*ELASTIC\n{youngs_modulus}, {poissons_ratio}\n*SOLID SECTION, ELSET=E, MATERIAL=M\n{thickness}"


def lee_frame(line: str, elements: int = 20) -> str:
    """Lee's frame of CPS8R, one over the height of 2, thickness 3: a hinge in the middle of each end."""
    mesh = Mesh()

    def beam(start: Sequence[float], along: Sequence[float], stations: np.ndarray) -> None:
        axis = np.array(along)
        across = np.array([-axis[1], axis[0]])
        for a, b in zip(stations[:-1], stations[1:], strict=True):
            mesh.add_quadrilateral([start + a * axis - across, start + b * axis - across, start + b * axis + across, start + a * axis + across])

    beam(np.array([0.0, 0.0]), [0.0, 1.0], np.linspace(0.0, 119.0, elements + 1))
    mesh.add_quadrilateral([np.array(corner, float) for corner in [(-1, 119), (1, 119), (1, 121), (-1, 121)]])
    beam(np.array([0.0, 120.0]), [1.0, 0.0], np.concatenate([np.linspace(1.0, 24.0, elements // 5 + 1), np.linspace(24.0, 120.0, elements - elements // 5 + 1)[1:]]))
    deck = mesh.write("CPS8R") + f"*NSET, NSET=LOADED\n{mesh.node(24.0, 120.0)}\n" + material(720.0, 0.3, "3.\n")
    deck += supports([(mesh.node(0.0, 0.0), 1, 2), (mesh.node(120.0, 120.0), 1, 2)])
    return deck + path_step(line, "*CLOAD\nLOADED, 2, -1.\n")


def toggle(line: str, half_span: float, rise: float, height: float, thickness: float, youngs_modulus: float, elements: int = 10) -> str:
    """Half of a toggle of CPS8R: clamped at one end, the other moves down only, by a force of 20."""
    mesh = Mesh()
    along = np.array([half_span, rise]) / np.hypot(half_span, rise)
    across = 0.5 * height * np.array([-along[1], along[0]])
    stations = np.linspace(0.0, np.hypot(half_span, rise), elements + 1)
    for a, b in zip(stations[:-1], stations[1:], strict=True):
        mesh.add_quadrilateral([a * along - across, b * along - across, b * along + across, a * along + across])
    ends = [[mesh.node(*(s * along + k * across)) for k in (-1, 0, 1)] for s in stations[[0, -1]]]
    deck = mesh.write("CPS8R") + f"*NSET, NSET=LOADED\n{ends[1][1]}\n" + material(youngs_modulus, 0.0, f"{thickness}\n")
    deck += supports([(node, 1, 2) for node in ends[0]] + [(node, 1, 1) for node in ends[1]])
    return deck + path_step(line, "*CLOAD\nLOADED, 2, -20.\n")


def hinged_roof(line: str, thickness: float, elements: int = 8, loads: str = "*CLOAD\nLOADED, 3, -750.\n") -> str:
    """A quarter of a cylindrical roof of S8R, which become solids: straight edges hinged, curved ones free, a quarter of a force of 3000
    in the middle. Radius 2540, half length 254, half angle 0.1, E = 3102.75, nu = 0.3.
    """
    radius, half_length, angle, n = 2540.0, 254.0, 0.1, elements
    mesh = Mesh()
    places = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    for j in range(n):
        for i in range(n):
            mesh.elements.append([mesh.node(2 * i + a, 2 * j + b) for a, b in places])
    moved, rows = {}, []
    for (i, j), label in mesh.nodes.items():
        turn = angle * i / (2 * n)
        moved[label] = np.array([radius * np.sin(turn), half_length * j / (2 * n), radius * np.cos(turn) - radius])
        rows += [(label, 1, 1), (label, 5, 6)] if i == 0 else []
        rows += [(label, 2, 2), (label, 4, 4), (label, 6, 6)] if j == 0 else []
        rows += [(label, 1, 3)] if i == 2 * n else []
    deck = mesh.write("S8R", moved) + f"*NSET, NSET=LOADED\n{mesh.node(0, 0)}\n*MATERIAL, NAME=M\n*ELASTIC\n3102.75, 0.3\n"
    return deck + f"*SHELL SECTION, ELSET=E, MATERIAL=M\n{thickness}\n" + supports(rows) + path_step(line, loads)
