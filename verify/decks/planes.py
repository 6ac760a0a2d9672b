"""Decks of plane and axisymmetric elements, made from sheets: the layer y = 0 of a sheet in x-z becomes a mesh in x-y.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from verify.decks.make_decks import Floats, Ints, Mesh, _number, _set_card, material_cards

EDGE_OF_FACE = {1: 1, 4: 2, 2: 3, 6: 4}  #: of the square for each face of the hexahedron: bottom, right, top, left
CORNERS = [0, 1, 5, 4]  #: of the hexahedron in its face y = 0, counterclockwise in x-z


@dataclass
class Plane:
    """Squares with named sets; all numbers are indices from 0."""

    nodes: Floats  #: (n_nodes, 2)
    elements: Ints  #: (n_elements, 4 or 8)
    node_sets: dict[str, Ints] = field(default_factory=dict)
    element_sets: dict[str, Ints] = field(default_factory=dict)
    surfaces: dict[str, list[tuple[str, int]]] = field(default_factory=dict)  #: name: [(element set, edge 1 to 4)]

    def along(self, name: str) -> Ints:
        """The nodes of a set from left to right."""
        members = self.node_sets[name]
        return members[np.argsort(self.nodes[members, 0], kind="stable")]


def flatten(sheet: Mesh, is_quadratic: bool = False) -> Plane:
    """The layer y = 0 of a sheet, with its sets and surfaces; mid-side nodes stand in the middle of straight edges."""
    keep = np.flatnonzero(np.abs(sheet.nodes[:, 1]) < 1e-9)
    number = np.full(len(sheet.nodes), -1)
    number[keep] = np.arange(len(keep))
    plane = Plane(sheet.nodes[keep][:, [0, 2]], number[sheet.elements[:, CORNERS]])
    plane.node_sets = {name: number[members][number[members] >= 0] for name, members in sheet.node_sets.items()}
    plane.element_sets = dict(sheet.element_sets)
    plane.surfaces = {name: [(s, EDGE_OF_FACE[f]) for s, f in faces] for name, faces in sheet.surfaces.items()}
    return _with_mid_sides(plane) if is_quadratic else plane


def _with_mid_sides(plane: Plane) -> Plane:
    """The same mesh with 8 nodes; a mid-side node is in the sets that both its corners are in."""
    edges = np.stack([plane.elements, np.roll(plane.elements, -1, axis=1)], axis=2)
    pairs, place = np.unique(np.sort(edges.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
    n = len(plane.nodes)
    for name, members in plane.node_sets.items():
        inside = np.isin(pairs, members).all(axis=1)
        plane.node_sets[name] = np.concatenate([members, n + np.flatnonzero(inside)])
    plane.elements = np.concatenate([plane.elements, n + place.reshape(-1, 4)], axis=1)
    plane.nodes = np.concatenate([plane.nodes, plane.nodes[pairs].mean(axis=1)])
    return plane


def grid_rows(n_x: int, n_y: int, kind: str) -> list[list[int]]:
    """Corners of the elements of a kind on a grid of n_x times n_y nodes, counted along x first; triangles cut each cell in two."""
    quads = [[i + n_x * j, i + 1 + n_x * j, i + 1 + n_x * (j + 1), i + n_x * (j + 1)] for j in range(n_y - 1) for i in range(n_x - 1)]
    return [[q[i] for i in t] for q in quads for t in ((0, 1, 2), (0, 2, 3))] if has_shape(kind, "36") else quads


def has_shape(kind: str, numbers: str) -> bool:
    """Whether a plane kind has one of these numbers of nodes: CPE8R has 8."""
    return kind.rstrip("R")[3:] in numbers


def number_mid_sides(rows: list[list[int]], n: int, kind: str) -> tuple[list[list[int]], dict[tuple[int, int], int]]:
    """The rows of a quadratic kind with their mid-side nodes, numbered from n on as they come, and the ends of each; others as they are."""
    made: dict[tuple[int, int], int] = {}
    if not has_shape(kind, "68"):
        return rows, made
    edges = [[(min(a, b), max(a, b)) for a, b in zip(row, row[1:] + row[:1], strict=True)] for row in rows]
    return [row + [made.setdefault(edge, n + len(made)) for edge in ends] for row, ends in zip(rows, edges, strict=True)], made


def join_planes(parts: Iterable[Plane]) -> Plane:
    """Parts put together, nothing glued."""
    parts = list(parts)
    whole = Plane(np.empty((0, 2)), np.empty((0, parts[0].elements.shape[1]), dtype=np.int64))
    for part in parts:
        n, e = len(whole.nodes), len(whole.elements)
        whole.nodes = np.concatenate([whole.nodes, part.nodes])
        whole.elements = np.concatenate([whole.elements, part.elements + n])
        whole.node_sets |= {name: members + n for name, members in part.node_sets.items()}
        whole.element_sets |= {name: members + e for name, members in part.element_sets.items()}
        whole.surfaces |= part.surfaces
    return whole


def flat_deck(parts: Sequence[tuple[Plane, tuple[float, float]]], kind: str, cards: str, thickness: float = 1.0) -> str:
    """A deck of parts with their (E, nu), each named by its first element set; then the cards of pairs and steps."""
    mesh = join_planes(part for part, _ in parts)
    lines = ["*NODE"]
    lines += [f"{i}, " + ", ".join(_number(v) for v in point) for i, point in enumerate(mesh.nodes, start=1)]
    lines += [f"*ELEMENT, TYPE={kind}"]
    lines += [f"{i}, " + ", ".join(str(n + 1) for n in nodes) for i, nodes in enumerate(mesh.elements, start=1)]
    for name, members in mesh.node_sets.items():
        lines += _set_card("NSET", name, members)
    for name, members in mesh.element_sets.items():
        lines += _set_card("ELSET", name, members)
    for name, entries in mesh.surfaces.items():
        lines += [f"*SURFACE, NAME={name}"] + [f"{elset}, S{edge}" for elset, edge in entries]
    materials = ""
    for part, elastic in parts:
        name = next(iter(part.element_sets))
        materials += material_cards(name, elastic, name) + (f"{thickness:.15g}\n" if kind.startswith("CP") else "")
    return "\n".join(lines) + "\n" + materials + cards
