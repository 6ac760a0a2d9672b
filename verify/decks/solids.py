"""Meshes of every element kind from a mesh of hexahedra, and the cards of small decks with them.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from verify.decks.make_decks import Mesh

#: Data of *NODE for a cube of edge 1, and its element: eight nodes, those of the bottom first.
UNIT_CUBE = """1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
*ELEMENT, TYPE=C3D8, ELSET=E
1, 1, 2, 3, 4, 5, 6, 7, 8
"""

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Natural coordinates of the corners of a hexahedron.
CORNERS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]])
KINDS = ["C3D4", "C3D6", "C3D8", "C3D8I", "C3D8R", "C3D10", "C3D15", "C3D20", "C3D20R"]
QUADRATIC = {"C3D10", "C3D15", "C3D20", "C3D20R"}

#: Corner nodes (from 0) of the faces S1, S2, ... as Abaqus numbers them.
_TET = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]
_WEDGE = [[0, 1, 2], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]]
_HEX = [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]]
FACES = {"C3D4": _TET, "C3D10": _TET, "C3D6": _WEDGE, "C3D15": _WEDGE, "C3D8": _HEX, "C3D8I": _HEX, "C3D8R": _HEX,
         "C3D20": _HEX, "C3D20R": _HEX}

_TET_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
_WEDGE_EDGES = [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)]
_HEX_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]

_EDGES = {"C3D10": _TET_EDGES, "C3D15": _WEDGE_EDGES}


@dataclass
class Solids:
    """Elements of one kind; indices from 0, labels in a deck are one more."""

    kind: str
    nodes: Floats  #: (n_nodes, 3)
    elements: Ints  #: (n_elements, nodes of the kind)

    def where(self, axis: int, value: float) -> Ints:
        """Nodes with a coordinate at a value."""
        return np.flatnonzero(np.abs(self.nodes[:, axis] - value) < 1e-9)

    def outer_faces(self, nodes: Iterable[int] | None = None) -> list[tuple[int, int]]:
        """(element from 0, face from 1) of the faces of one element only; with nodes, those whose corners are in it."""
        owners: dict[tuple[int, ...], list[tuple[int, int]]] = {}
        for e, element in enumerate(self.elements):
            for f, local in enumerate(FACES[self.kind], start=1):
                owners.setdefault(tuple(sorted(int(n) for n in element[local])), []).append((e, f))
        wanted = set(range(len(self.nodes))) if nodes is None else {int(n) for n in nodes}
        return [found[0] for corners, found in owners.items() if len(found) == 1 and wanted.issuperset(corners)]

    def boundary_nodes(self) -> Ints:
        """Nodes on the outer faces, mid-sides included."""
        edges = _EDGES.get(self.kind, _HEX_EDGES)
        outer: set[int] = set()
        for e, f in self.outer_faces():
            local = FACES[self.kind][f - 1]
            members = list(local)
            if self.kind in QUADRATIC:
                members += [len(set(sum(edges, ()))) + i for i, (a, b) in enumerate(edges) if a in local and b in local]
            outer.update(int(n) for n in self.elements[e][members])
        return np.array(sorted(outer))

    def cards(self) -> str:
        """*NODE and *ELEMENT with the sets ALL (elements) and NODES."""
        lines = ["*NODE, NSET=NODES"]
        lines += [f"{i}, " + ", ".join(f"{v:.15g}" for v in x) for i, x in enumerate(self.nodes, start=1)]
        lines += [f"*ELEMENT, TYPE={self.kind}, ELSET=ALL"]
        for i, nodes in enumerate(self.elements, start=1):
            labels = [str(i), *(str(n + 1) for n in nodes)]
            lines += [", ".join(labels[:11]) + ("," if len(labels) > 11 else "")]
            lines += [", ".join(labels[11:])] if len(labels) > 11 else []
        return "\n".join(lines) + "\n"


def as_kind(mesh: Mesh, kind: str) -> Solids:
    """Hexahedra as they are, cut into six tetrahedra or two wedges, and with mid-side nodes where the kind has them."""
    elements = mesh.elements
    if kind in ("C3D4", "C3D10"):
        elements = np.concatenate([elements[:, tet] for tet in _six_tetrahedra()])
    if kind in ("C3D6", "C3D15"):
        elements = np.concatenate([elements[:, w] for w in ([0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7])])
    if kind not in QUADRATIC:
        return Solids(kind, mesh.nodes, elements)
    return _with_mid_sides(kind, mesh.nodes, elements, _EDGES.get(kind, _HEX_EDGES))


def _six_tetrahedra() -> list[list[int]]:
    """Kuhn's cut of a cube along the diagonal from corner 0 to corner 6; conforming between neighbours of a grid."""
    corner = {tuple(int(v) for v in (place + 1) / 2): i for i, place in enumerate(CORNERS)}
    cut = []
    for order in permutations(range(3)):
        place, path = [0, 0, 0], [0]
        for axis in order:
            place[axis] = 1
            path.append(corner[tuple(place)])
        is_even = np.linalg.det(np.eye(3)[list(order)]) > 0
        cut.append(path if is_even else [path[1], path[0], *path[2:]])
    return cut


def _with_mid_sides(kind: str, nodes: Floats, elements: Ints, edges: Sequence[tuple[int, int]]) -> Solids:
    """Mid-side nodes halfway."""
    made: dict[tuple[int, int], int] = {}
    places = [tuple(x) for x in nodes]
    rows = []
    for element in elements:
        row = list(element)
        for a, b in edges:
            ends = (int(element[a]), int(element[b]))
            key = (min(ends), max(ends))
            if key not in made:
                made[key] = len(places)
                places.append(tuple((nodes[key[0]] + nodes[key[1]]) / 2))
            row.append(made[key])
        rows.append(row)
    return Solids(kind, np.array(places), np.array(rows))


def unit_cube(nset: str = "ALL", elset: str = "E", kind: str = "C3D8", low: str = "LOW", high: str = "HIGH") -> str:
    """Cards of one element of eight nodes, the cube from 0 to 1: nodes 1 to 4 below, 5 to 8 above them."""
    corners = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    rows = "".join(f"{i}, {x}., {y}., {z}.\n" for i, (x, y, z) in enumerate(corners, start=1))
    element = f"*ELEMENT, TYPE={kind}, ELSET={elset}\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"
    return f"*NODE, NSET={nset}\n{rows}{element}{node_set(low, range(4))}{node_set(high, range(4, 8))}"


def node_set(name: str, members: Iterable[int]) -> str:
    """*NSET of indices from 0."""
    labels = [str(int(m) + 1) for m in members]
    rows = [", ".join(labels[i : i + 10]) for i in range(0, len(labels), 10)]
    return f"*NSET, NSET={name}\n" + "\n".join(rows) + "\n"


def prescribed(members: Iterable[int], values: Floats) -> str:
    """*BOUNDARY with all three displacements of each node."""
    lines = ["*BOUNDARY"]
    for node, value in zip(members, values, strict=True):
        lines += [f"{int(node) + 1}, {d}, {d}, {float(v):.17g}" for d, v in enumerate(value, start=1)]
    return "\n".join(lines) + "\n"


def pressure_on(faces: Iterable[tuple[int, int]], magnitude: float) -> str:
    """*DLOAD with a pressure on faces."""
    return "*DLOAD\n" + "".join(f"{e + 1}, P{f}, {magnitude:.17g}\n" for e, f in faces)
