"""Bodies for decks of several parts: blocks of any element kind with named sides.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from verify.decks.make_decks import block
from verify.decks.mixed_decks import nodes_of
from verify.decks.planes import grid_rows, number_mid_sides
from verify.decks.solids import Solids, as_kind

Floats = NDArray[np.float64]
SIDES = [("X0", 0, 0), ("X1", 0, 1), ("Y0", 1, 0), ("Y1", 1, 1), ("Z0", 2, 0), ("Z1", 2, 1)]


def rows(numbers: list[int]) -> str:
    """Numbers, ten in a row."""
    return "".join(", ".join(map(str, numbers[i : i + 10])) + "\n" for i in range(0, len(numbers), 10))


class Part:
    """A block; its set of elements is its name, that of its nodes NAMEN, of its sides NAME_X0N; surfaces are NAME_X0 and so on.

    Nodes and elements count from the number `first`.
    """

    def __init__(self, name: str, kind: str, low: tuple[float, ...], high: tuple[float, ...], cells: tuple[int, ...], first: int = 1,
                 bend: Callable[[Floats], Floats] | None = None) -> None:
        self.name, self.kind, self.first = name, kind, first
        axes = [np.linspace(a, b, n + 1) for a, b, n in zip(low, high, cells, strict=True)]
        self.is_plane = not kind.startswith("C3D")
        if self.is_plane:
            places, self.elements, self.faces = self._sheet(axes)
        else:
            grid = block(axes[0], axes[1], axes[2], "B")
            made: Solids = as_kind(grid, kind)
            places, self.elements, self.faces = made.nodes, made.elements, {}
            for side, axis, end in SIDES:
                on = set(np.flatnonzero(np.abs(made.nodes[:, axis] - axes[axis][-end]) < 1e-9).tolist())
                self.faces[side] = [(int(e), int(f)) for e, f in made.outer_faces(on)]
            self._solids = made
        self.on = {side: np.flatnonzero(np.abs(places[:, axis] - axes[axis][-end]) < 1e-9).tolist() for side, axis, end in SIDES
                   if axis < places.shape[1]}
        self.nodes = bend(places) if bend else places

    def _sheet(self, axes: list[Floats]) -> tuple[Floats, NDArray[np.int64], dict[str, list[tuple[int, int]]]]:
        """Plane elements in x-y."""
        xs, ys = axes[:2]
        cut = grid_rows(len(xs), len(ys), self.kind)
        places = [(float(x), float(y)) for y in ys for x in xs]
        result, made = number_mid_sides(cut, len(places), self.kind)
        places += [tuple((np.array(places[a]) + places[b]) / 2) for a, b in made]
        faces: dict[str, list[tuple[int, int]]] = {}
        for side, axis, end in SIDES[:4]:
            value = axes[axis][-end]
            faces[side] = [(e, k + 1) for e, row in enumerate(cut) for k in range(len(row))
                           if all(abs(places[row[(k + s) % len(row)]][axis] - value) < 1e-9 for s in (0, 1))]
        return np.array(places), np.array(result), faces

    def label(self, place: tuple[float, ...]) -> int:
        """The number of the node nearest to a place."""
        return int(np.argmin(np.linalg.norm(self.nodes - np.array(place), axis=1))) + self.first

    def nodes_on(self, side: str) -> list[int]:
        """The numbers of the nodes of a side."""
        return [k + self.first for k in self.on[side]]

    def cards(self) -> str:
        """All of it."""
        text = f"*NODE, NSET={self.name}N\n"
        text += "".join(f"{i}, " + ", ".join(f"{v:.12g}" for v in x) + "\n" for i, x in enumerate(self.nodes, start=self.first))
        text += f"*ELEMENT, TYPE={self.kind}, ELSET={self.name}\n"
        for i, row in enumerate(self.elements, start=self.first):
            words = [str(i), *(str(n + self.first) for n in row)]
            text += ", ".join(words[:11]) + (",\n" + ", ".join(words[11:]) if len(words) > 11 else "") + "\n"
        for side, members in self.on.items():
            text += f"*NSET, NSET={self.name}_{side}N\n{rows([m + self.first for m in members])}"
        for side, faces in self.faces.items():
            text += f"*SURFACE, NAME={self.name}_{side}\n" + "".join(f"{e + self.first}, S{f}\n" for e, f in faces)
        return text

    def dload(self, side: str, value: float) -> str:
        """Lines of *DLOAD of a pressure."""
        return "".join(f"{e + self.first}, P{f}, {value:g}\n" for e, f in self.faces[side])


__all__ = ["Part", "nodes_of", "rows"]
