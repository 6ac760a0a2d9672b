"""Draws how nodes and faces of the elements are numbered: doc/pictures/elements.png, of doc/manual/elements.md.

    python -m verify.tools.element_picture [--output doc/pictures/elements.png]

`verify/tools/test_element_picture.py` compares the faces with those of the program.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402

#: Places of the corner nodes, nodes 1 to n.
PLACES = {
    "C3D8": [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
    "C3D6": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)],
    "C3D4": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
    "CPE4": [(0, 0), (1, 0), (1, 1), (0, 1)],
    "CPE3": [(0, 0), (1, 0), (0, 1)],
}
#: Corner nodes of the faces S1, S2, ...; of a plane element its edges.
FACES = {
    "C3D8": [(1, 2, 3, 4), (5, 8, 7, 6), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 8, 4), (4, 8, 5, 1)],
    "C3D6": [(1, 2, 3), (4, 6, 5), (1, 4, 5, 2), (2, 5, 6, 3), (3, 6, 4, 1)],
    "C3D4": [(1, 2, 3), (1, 4, 2), (2, 4, 3), (3, 4, 1)],
    "CPE4": [(1, 2), (2, 3), (3, 4), (4, 1)],
    "CPE3": [(1, 2), (2, 3), (3, 1)],
}
#: The two nodes of each edge that has a mid-side node, in the order of these nodes: numbers n + 1, n + 2, ...
MIDDLES = {
    "C3D8": ("C3D20", [(1, 2), (2, 3), (3, 4), (4, 1), (5, 6), (6, 7), (7, 8), (8, 5), (1, 5), (2, 6), (3, 7), (4, 8)]),
    "C3D6": ("C3D15", [(1, 2), (2, 3), (3, 1), (4, 5), (5, 6), (6, 4), (1, 4), (2, 5), (3, 6)]),
    "C3D4": ("C3D10", [(1, 2), (2, 3), (3, 1), (1, 4), (2, 4), (3, 4)]),
    "CPE4": ("CPE8", [(1, 2), (2, 3), (3, 4), (4, 1)]),
    "CPE3": ("CPE6", [(1, 2), (2, 3), (3, 1)]),
}
#: Where y points to on the paper, so that no number covers another.
DEPTH = {"C3D8": (0.56, 0.4), "C3D6": (0.42, 0.39), "C3D4": (0.42, 0.3)}
COLOURS = ["#2166ac", "#d95f02", "#1b9e77", "#7b3294", "#a6761d", "#b3202c"]
INK = "#1d2935"


def flat(place: Sequence[float], depth: tuple[float, float]) -> np.ndarray:
    """Where a point of space is on the paper."""
    x, y, z = (*place, 0.0)[:3]
    return np.array([x + depth[0] * y, depth[1] * y + z]) if len(place) == 3 else np.array([x, y])


def draw(axes: Axes, kind: str) -> None:
    """One element: edges, nodes with their numbers, the names of the faces at their middles."""
    points = np.array([flat(place, DEPTH.get(kind, (0.0, 0.0))) for place in PLACES[kind]])
    quadratic, edges = MIDDLES[kind]
    for a, b in edges:
        axes.plot(*points[[a - 1, b - 1]].T, color="#8a97a3", lw=1.2, zorder=1)
    for number, (a, b) in enumerate(edges, len(points) + 1):
        middle, (across, along) = points[[a - 1, b - 1]].mean(axis=0), np.abs(points[a - 1] - points[b - 1])
        axes.plot(*middle, "o", ms=2.5, color="#5f6c78", zorder=2)
        place = (-3, 2) if min(across, along) > 0.1 and (points[a - 1] - points[b - 1]).prod() > 0 else (3, 3)   # above its edge
        place = (3, -8) if max(points[a - 1][1], points[b - 1][1]) == points[:, 1].min() else place
        axes.annotate(str(number), middle, xytext=place, textcoords="offset points", fontsize=7, color="#5f6c78", ha="right" if place[0] < 0 else "left")
    for number, point in enumerate(points, 1):
        axes.plot(*point, "o", ms=5, color=INK, zorder=3)
        away = point - points.mean(axis=0)
        axes.annotate(str(number), point, xytext=tuple(13 * away / np.linalg.norm(away)), textcoords="offset points", fontsize=11,
                      color=INK, ha="center", va="center", weight="bold")  # fmt: skip
    for i, face in enumerate(FACES[kind]):
        middle = points[np.array(face) - 1].mean(axis=0)
        middle = 0.62 * middle + 0.38 * points.mean(axis=0) if len(face) == 2 else middle   # beside its mid-side node
        axes.text(*middle, f"S{i + 1}", color="white", fontsize=9, ha="center", va="center", weight="bold", zorder=4,
                  bbox={"boxstyle": "round,pad=0.25", "fc": COLOURS[i], "ec": "none"})  # fmt: skip
    names = {"CPE4": "CPE4, CPS4, CAX4\n(8, 8R: with the small numbers)", "CPE3": "CPE3, CPS3, CAX3\n(6: with the small numbers)"}
    axes.set_title(names.get(kind, f"{kind}\n({quadratic}: with the small numbers)"), fontsize=9.5, color=INK)
    axes.set_aspect("equal")
    axes.margins(0.16)
    axes.axis("off")


def main(arguments: Sequence[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, default=Path(__file__).resolve().parents[2] / "doc" / "pictures" / "elements.png")
    wanted = parser.parse_args(arguments)
    figure, axes = plt.subplots(1, 5, figsize=(13.5, 3.4), width_ratios=[1.3, 1.2, 1.2, 1, 1])
    for place, kind in zip(axes, PLACES, strict=True):
        draw(place, kind)
    figure.tight_layout()
    figure.savefig(wanted.output, dpi=110, metadata={"Software": None})
    print(f"The picture is {wanted.output}.")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
