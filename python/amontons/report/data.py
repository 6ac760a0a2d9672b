"""What the report needs of a result file: tables, fields at the written increments, and the outer skin of the mesh.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from amontons.results import joined_cells

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Table = dict[str, NDArray]

#: Faces of the VTK cell types: corner nodes, then the mid-side nodes behind each corner (if the cell has them), outward.
_TET = ([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], [[6, 5, 4], [4, 8, 7], [5, 9, 8], [6, 7, 9]])
_HEX = (
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
    [[11, 10, 9, 8], [12, 13, 14, 15], [8, 17, 12, 16], [9, 18, 13, 17], [10, 19, 14, 18], [11, 16, 15, 19]],
)
_WEDGE = (
    [[0, 2, 1], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]],
    [[8, 7, 6], [9, 10, 11], [6, 13, 9, 12], [7, 14, 10, 13], [8, 12, 11, 14]],
)
_TRIANGLE = ([[0, 1, 2]], [[3, 4, 5]])
_SQUARE = ([[0, 1, 2, 3]], [[4, 5, 6, 7]])
#: VTK type: faces, and whether it has mid-side nodes.
CELLS = {
    10: (_TET, False), 24: (_TET, True), 12: (_HEX, False), 25: (_HEX, True), 13: (_WEDGE, False), 26: (_WEDGE, True),
    5: (_TRIANGLE, False), 22: (_TRIANGLE, True), 9: (_SQUARE, False), 23: (_SQUARE, True),
}  # fmt: skip
LINES = (3, 21)  #: VTK types of trusses and springs


@dataclass
class Skin:
    """Outer faces: each a ring of nodes, with mid-side nodes in their places."""

    rings: list[Ints] = field(default_factory=list)
    corners: list[Ints] = field(default_factory=list)

    def triangles(self) -> Ints:
        """(m, 3) nodes. A ring with mid-side nodes is cut at its corners first."""
        parts = []
        for ring, corners in zip(self.rings, self.corners, strict=True):
            n = len(ring)
            if n == len(corners):
                parts += [[ring[0], ring[i], ring[i + 1]] for i in range(1, n - 1)]
                continue
            parts += [[ring[i - 1], ring[i], ring[(i + 1) % n]] for i in range(0, n, 2)]
            middle = ring[1::2]
            parts += [[middle[0], middle[i], middle[i + 1]] for i in range(1, len(middle) - 1)]
        return np.array(parts, dtype=np.int64).reshape(-1, 3)

    def edges(self) -> Ints:
        """(m, 2) nodes of the sides, each once."""
        parts = [np.stack([ring, np.roll(ring, -1)], axis=1) for ring in self.rings]
        if not parts:
            return np.zeros((0, 2), dtype=np.int64)
        return np.unique(np.sort(np.concatenate(parts), axis=1), axis=0)


@dataclass
class Job:
    """A finished (or running) job."""

    name: str
    path: Path
    version: str
    dialect: str
    heading: str
    deck: str
    points: Floats
    labels: Ints
    kinds: list[str]
    times: Floats
    fields: dict[str, Floats]  #: (frames, nodes, ...)
    units: dict[str, str]
    history: Table
    iterations: Table
    steps: Table
    controls: Table
    materials: Table
    pairs: Table
    pair_history: Table  #: sums over each pair; empty without pairs
    slave_node: Ints
    slave_pair: Ints
    is_closed: NDArray[np.bool_]  #: of each slave at the last frame
    skin: Skin
    lines: Ints  #: (m, 2) trusses and springs
    node_sets: dict[str, Ints]

    @property
    def is_plane(self) -> bool:
        """Whether all nodes are in a plane z = const."""
        return bool(np.ptp(self.points[:, 2]) <= 1e-12 * max(float(np.ptp(self.points)), 1e-300))

    def attempts(self) -> NDArray[np.bool_]:
        """Rows of the history that are attempts, not the initial state."""
        return np.asarray(self.history["increment"] > 0)


def read_job(path: Path) -> Job:
    """Everything from the file. ValueError: it is not a result file of Amontons."""
    with h5py.File(path, "r", locking=False) as file:
        if "VTKHDF/Steps" not in file or "AMONTONS" not in file:
            raise ValueError(f"{path} is not a result file of Amontons: it has no groups VTKHDF and AMONTONS.")
        grid, ours = file["VTKHDF"], file["AMONTONS"]
        n_frames = int(grid["Steps"].attrs["NSteps"])
        n = int(grid["NumberOfPoints"][:].sum())
        data = grid["PointData"]
        fields = {name: data[name][: n_frames * n].reshape(n_frames, n, *data[name].shape[1:]) for name in data}
        cells = joined_cells(grid, ours["mesh/node_label"][:])
        contact = ours.get("contact", {})
        n_slaves = len(contact["node"]) if "node" in contact else 0
        return Job(
            name=path.stem, path=path, version=_text(ours, "version"), dialect=_text(ours, "dialect"),
            heading=_text(ours, "heading"), deck=_text(ours, "deck"), points=grid["Points"][:],
            labels=_labels(ours["mesh/node_label"][:], n), kinds=_words(ours["mesh/element_kind"]),
            times=grid["Steps/Values"][:n_frames], fields=fields,
            units={name: _unit(data[name]) for name in data},
            history=_table(ours["history"]), iterations=_table(ours["iterations"]), steps=_table(ours["steps"]),
            controls=_table(ours["controls"]), materials=_table(ours["materials"]), pairs=_table(ours["pairs"]),
            pair_history=_table(ours["pair_history"]) if "pair_history" in ours else {},
            slave_node=contact["node"][:].astype(np.int64) if "node" in contact else np.zeros(0, dtype=np.int64),
            slave_pair=contact["pair"][:].astype(np.int64) if "pair" in contact else np.zeros(0, dtype=np.int64),
            is_closed=contact["status"][(n_frames - 1) * n_slaves : n_frames * n_slaves] > 0 if n_slaves else np.zeros(0, dtype=bool),
            skin=outer_skin(*cells), lines=_lines(*cells), node_sets=_sets(ours["mesh/node_sets"]),
        )  # fmt: skip


def _sets(group: h5py.Group) -> dict[str, Ints]:
    """Members of each set."""
    first, members = group["first"][:], group["members"][:].astype(np.int64)
    return {name: members[a:b] for name, a, b in zip(_words(group["name"]), first[:-1], first[1:], strict=True)}


def _labels(labels: Ints, n_points: int) -> Ints:
    """The labels of the nodes; 0 for the points of analytic surfaces, which come after them."""
    return np.concatenate([labels.astype(np.int64), np.zeros(n_points - len(labels), dtype=np.int64)])


def _unit(item: h5py.Dataset) -> str:
    """The unit of a data set."""
    value = item.attrs.get("unit", "")
    return value.decode() if isinstance(value, bytes) else str(value)


def _text(group: h5py.Group, name: str) -> str:
    """A data set that holds one text."""
    if name not in group:
        return ""
    value = group[name][()]
    if isinstance(value, np.ndarray):
        value = b"\n".join(bytes(v).rstrip() for v in value.ravel())
    return value.decode(errors="replace").rstrip() if isinstance(value, bytes) else str(value)


def _words(item: h5py.Dataset) -> list[str]:
    """A data set of texts."""
    return [v.decode(errors="replace").strip() if isinstance(v, bytes) else str(v).strip() for v in item[:]]


def _table(group: h5py.Group) -> Table:
    """The data sets of a group; texts as texts."""
    result: Table = {}
    for name, item in group.items():
        if isinstance(item, h5py.Dataset):
            is_text = item.dtype.kind in "SO"
            result[name] = np.array(_words(item)) if is_text and item.shape else item[()]
    return result


def outer_skin(connectivity: Ints, offsets: Ints, types: Ints) -> Skin:
    """Faces that belong to one cell only, plane cells themselves."""
    rings: dict[tuple[int, int], list[Ints]] = {}
    for kind in np.unique(types):
        if int(kind) not in CELLS:
            continue
        (faces, middles), has_middles = CELLS[int(kind)]
        first = offsets[:-1][types == kind]
        for face, middle in zip(faces, middles, strict=True):
            local = np.array([v for pair in zip(face, middle, strict=True) for v in pair] if has_middles else face)
            nodes = connectivity[first[:, None] + local[None, :]].astype(np.int64)
            rings.setdefault((len(face), len(local)), []).append(nodes)
    skin = Skin()
    for (n_corners, n_nodes), parts in rings.items():
        nodes = np.concatenate(parts)
        corners = nodes[:, :: n_nodes // n_corners]
        _, index, counts = np.unique(np.sort(corners, axis=1), axis=0, return_index=True, return_counts=True)
        for i in np.sort(index[counts == 1]):
            skin.rings.append(nodes[i])
            skin.corners.append(corners[i])
    return skin


def _lines(connectivity: Ints, offsets: Ints, types: Ints) -> Ints:
    """Ends of the cells of two or three nodes on a line."""
    first = offsets[:-1][np.isin(types, LINES)]
    return np.stack([connectivity[first], connectivity[first + 1]], axis=1).astype(np.int64)
