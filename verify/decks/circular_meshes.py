"""Meshes about an axis: a quarter of a disk, its circles continued outwards, as a block of hexahedra.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import numpy as np

from verify.decks.make_decks import Floats, Ints, Mesh, grid_elements, weld


def quarter_disk(core: Floats, rings: Floats, z: Floats, name: str) -> Mesh:
    """The quarter x >= 0, y >= 0: a square with the lines `core` (0 to 1), then rings whose lines are `rings`.

    Rings run from 0, the border of the square, over 1, the circle of radius 1, outwards, where they are radii. Node sets
    NAME_X and NAME_Y (the planes x = 0, y = 0), NAME_BOTTOM, NAME_TOP; surface NAME_DISK: the top within radius 1.
    """

    def square(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        return 0.55 * s * (1 - 0.15 * t**2), 0.55 * t * (1 - 0.15 * s**2)

    def ring(w: Floats, t: Floats) -> tuple[Floats, Floats]:
        inner, circle = square(np.ones_like(t), t), (np.cos(t * np.pi / 4), np.sin(t * np.pi / 4))
        near, far = np.clip(w, 0, 1), np.maximum(w, 1)
        return tuple((a * (1 - near) + b * near) * np.where(w > 1, far, 1) for a, b in zip(inner, circle, strict=True))  # type: ignore[return-value]

    parts = []
    for place, first, second in (
        (square, core, core),
        (ring, rings, core),
        (lambda t, w: ring(w, t)[::-1], core, rings),
    ):
        a, b, c = (v.ravel(order="F") for v in np.meshgrid(first, second, z, indexing="ij"))
        x, y = place(a, b)
        parts.append(Mesh(np.stack([x, y, c], axis=1), grid_elements(len(first) - 1, len(second) - 1, len(z) - 1)))
    mesh = weld(parts, 1e-7)
    top = faces_within(mesh, float(z[-1]), 1.0)
    mesh.element_sets = {name: np.arange(len(mesh.elements)), f"{name}_D": top}
    mesh.surfaces = {f"{name}_DISK": [(f"{name}_D", 2)]}
    planes = {"X": (0, 0.0), "Y": (1, 0.0), "BOTTOM": (2, z[0]), "TOP": (2, z[-1])}
    for side, (axis, value) in planes.items():
        mesh.node_sets[f"{name}_{side}"] = np.flatnonzero(np.abs(mesh.nodes[:, axis] - value) < 1e-9)
    return mesh


def faces_within(mesh: Mesh, height: float, radius: float) -> Ints:
    """Elements whose upper face lies at a height and within a radius."""
    upper = mesh.nodes[mesh.elements[:, 4:]]
    flat = (np.abs(upper[:, :, 2] - height) < 1e-9).all(axis=1)
    return np.flatnonzero(flat & (np.hypot(upper[:, :, 0], upper[:, :, 1]) < radius + 1e-7).all(axis=1))
