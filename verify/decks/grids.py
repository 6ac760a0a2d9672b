"""Bodies mapped from grids of squares or cubes, with a surface for each side of the grid and one for the whole exterior.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from verify.decks.make_decks import Floats, Ints, _number, _set_card

Place = Callable[..., Sequence[Floats]]  #: coordinates of a point of the grid

#: Corners of a cell of the grid by its steps along the lines, and the faces of the cell on the sides S0 (lowest s), S1, T0, ...
_CELLS = {
    2: ([(0, 0), (1, 0), (1, 1), (0, 1)], {"T0": 1, "S1": 2, "T1": 3, "S0": 4}),
    3: ([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
        {"W0": 1, "W1": 2, "T0": 3, "S1": 4, "T1": 5, "S0": 6}),
}
_FACES = {2: [(0, 1), (1, 2), (2, 3), (3, 0)], 3: [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]}


@dataclass
class Body:
    """Elements of one kind; all numbers are indices from 0."""

    name: str
    nodes: Floats  #: (n_nodes, 2 or 3)
    elements: Ints  #: (n_elements, 4 or 8)
    sides: dict[str, list[tuple[int, int]]]  #: name: [(element, face from 1)]
    sets: dict[str, Ints] = field(default_factory=dict)  #: more node sets, by their last word

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.nodes.shape[1]

    def exterior(self) -> list[tuple[int, int]]:
        """The faces of one element only."""
        owners: dict[tuple[int, ...], list[tuple[int, int]]] = {}
        for e, element in enumerate(self.elements):
            for f, local in enumerate(_FACES[self.dimension], start=1):
                owners.setdefault(tuple(sorted(int(element[i]) for i in local)), []).append((e, f))
        return [found[0] for found in owners.values() if len(found) == 1]

    def nodes_of(self, faces: Iterable[tuple[int, int]]) -> Ints:
        """The nodes of some faces."""
        return np.array(sorted({int(self.elements[e][i]) for e, f in faces for i in _FACES[self.dimension][f - 1]}))

    def select(self, name: str, inside: Callable[[Floats], np.ndarray]) -> None:
        """A node set of the nodes whose coordinates are inside."""
        self.sets[name] = np.flatnonzero(inside(self.nodes))

    def surface(self, name: str, inside: Callable[[Floats], np.ndarray]) -> None:
        """A surface of the exterior faces whose middles (n, 2 or 3) are inside."""
        faces = self.exterior()
        middles = np.array([self.nodes[[self.elements[e][i] for i in _FACES[self.dimension][f - 1]]].mean(axis=0) for e, f in faces])
        self.sides[name] = [face for face, is_in in zip(faces, inside(middles), strict=True) if is_in]


def grid(name: str, *lines: Sequence[float] | Floats, place: Place | None = None, is_closed: bool = False) -> Body:
    """A body from its lines s, t (, w), mapped by place(s, t (, w)); is_closed: the ends of s are one."""
    lines = tuple(np.asarray(line, dtype=float) for line in lines)
    n = [len(line) - 1 for line in lines]
    corners, faces = _CELLS[len(lines)]
    points = [p.ravel(order="F") for p in np.meshgrid(*lines, indexing="ij")]
    nodes = np.stack(list(place(*points) if place else points), axis=1)
    shape = [k + 1 for k in n]
    cells = np.array(list(np.ndindex(*n[::-1])))[:, ::-1]
    elements = np.stack([np.ravel_multi_index(tuple((cells + c).T), shape, order="F") for c in corners], axis=1)
    if is_closed:
        columns = np.arange(len(nodes)) % shape[0]
        first = np.where(columns == n[0], np.arange(len(nodes)) - n[0], np.arange(len(nodes)))
        kept = np.flatnonzero(columns < n[0])
        number = np.zeros(len(nodes), dtype=np.int64)
        number[kept] = np.arange(len(kept))
        nodes, elements = nodes[kept], number[first[elements]]
    sides = {}
    for side, face in faces.items():
        axis = "STW".index(side[0])
        if is_closed and axis == 0:
            continue
        level = 0 if side[1] == "0" else n[axis] - 1
        sides[side] = [(int(e), face) for e in np.flatnonzero(cells[:, axis] == level)]
    return Body(name, nodes, elements, sides)


def bodies_deck(bodies: Sequence[tuple[Body, str]], kind: str, cards: str) -> str:
    """Nodes, elements, sets and surfaces of bodies with the cards of their materials, then pairs and steps.

    A body NAME has the element set and the node set NAME, a node set and a surface NAME_SIDE for each side, and NAME_ALL, its exterior.
    """
    lines, n, e, sections = [], 0, 0, ""
    for body, material in bodies:
        lines += [f"*NODE, NSET={body.name}", *(f"{n + i}, " + ", ".join(_number(v) for v in x) for i, x in enumerate(body.nodes, start=1))]
        lines.append(f"*ELEMENT, TYPE={kind}, ELSET={body.name}")
        lines += [f"{e + i}, " + ", ".join(str(n + k + 1) for k in row) for i, row in enumerate(body.elements, start=1)]
        for side, faces in [*body.sides.items(), ("ALL", body.exterior())]:
            lines += _set_card("NSET", f"{body.name}_{side}", body.nodes_of(faces) + n)
            lines += [f"*SURFACE, NAME={body.name}_{side}", *(f"{e + element + 1}, S{face}" for element, face in faces)]
        for name, members in body.sets.items():
            lines += _set_card("NSET", f"{body.name}_{name}", np.asarray(members) + n)
        n, e = n + len(body.nodes), e + len(body.elements)
        thickness = "1.\n" if kind.startswith("CP") else ""
        sections += f"*MATERIAL, NAME={body.name}\n{material}*SOLID SECTION, ELSET={body.name}, MATERIAL={body.name}\n{thickness}"
    return "\n".join(lines) + "\n" + sections + cards
