"""Draws a submodel beside its global model: doc/pictures/submodel.png, of doc/manual/submodels.md.

    python -m verify.tools.submodel_picture [--output doc/pictures/submodel.png]

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402

from verify.conftest import ROOT  # noqa: E402
from verify.decks.solids import Solids  # noqa: E402
from verify.decks.submodels import CARD, CUT_RADIUS, OUTER, REMOTE, plate_global, plate_submodel, quarter_ring  # noqa: E402
from verify.independent.results import read_field  # noqa: E402

RING = [0, 8, 1, 9, 2, 10, 3, 11]  #: the nodes around the face at z = 0 of an element of 20 nodes
INK, BLUE, ORANGE = "#1d2935", "#2166ac", "#d95f02"


def draw_mesh(axes: Axes, mesh: Solids, stress: np.ndarray, title: str, extent: float) -> None:
    """The stress over the faces at z = 0, with the edges of the elements."""
    triangles = [(ring[0], ring[i], ring[i + 1]) for ring in mesh.elements[:, RING] for i in range(1, 7)]
    shown = axes.tripcolor(mesh.nodes[:, 0], mesh.nodes[:, 1], triangles, stress / REMOTE, shading="gouraud", cmap="viridis", vmin=-1, vmax=3)
    for ring in mesh.elements[:, RING]:
        axes.plot(*mesh.nodes[[*ring, ring[0]], :2].T, color="white", linewidth=0.4)
    angle = np.linspace(0, np.pi / 2, 60)
    axes.plot(CUT_RADIUS * np.cos(angle), CUT_RADIUS * np.sin(angle), color=ORANGE, linewidth=2)
    axes.set(title=title, xlim=(0, extent), ylim=(0, extent), aspect="equal", xlabel="x / radius", ylabel="y / radius")
    plt.colorbar(shown, ax=axes, label="stress xx / S", fraction=0.046)


def main() -> None:
    """Runs both decks and draws them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, default=ROOT / "doc" / "pictures" / "submodel.png")
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    options = parser.parse_args()
    counts = (10, 16)
    meshes = {"global": quarter_ring((6, 6), OUTER), "local": quarter_ring(counts, CUT_RADIUS)}
    figure, axes = plt.subplots(1, 3, figsize=(13, 3.9), layout="constrained")
    with tempfile.TemporaryDirectory() as folder:
        for name, deck in (("global", plate_global()), ("local", plate_submodel(CARD.format("global.vtkhdf"), counts))):
            (Path(folder) / f"{name}.inp").write_text(deck)
            subprocess.run([options.program.resolve(), "--quiet", name], cwd=folder, check=True)
        stress = {name: read_field(Path(folder) / f"{name}.vtkhdf", "S")[-1] for name in meshes}
    draw_mesh(axes[0], meshes["global"], stress["global"][:, 0], "global model, the cut in orange", OUTER)
    draw_mesh(axes[1], meshes["local"], stress["local"][:, 0], "submodel", 1.1 * CUT_RADIUS)
    exact = np.linspace(0, np.pi / 2, 100)
    axes[2].plot(np.degrees(exact), 1 - 2 * np.cos(2 * exact), color=INK, linewidth=1, label="closed form")
    for name, colour, label in (("global", BLUE, "global model"), ("local", ORANGE, "submodel")):
        x, y, z = meshes[name].nodes.T
        at = np.flatnonzero((np.abs(np.hypot(x, y) - 1) < 1e-9) & (np.abs(z) < 1e-9))
        angle = np.arctan2(y[at], x[at])
        xx, yy, xy = stress[name][at][:, [0, 1, 3]].T
        hoop = xx * np.sin(angle) ** 2 + yy * np.cos(angle) ** 2 - xy * np.sin(2 * angle)
        axes[2].plot(np.degrees(angle), hoop / REMOTE, "o", color=colour, markersize=4, label=label)
    axes[2].set(title="hoop stress at the hole / S", xlabel="angle from the tension [degrees]")
    axes[2].legend(frameon=False)
    figure.savefig(options.output, dpi=100)


if __name__ == "__main__":
    main()
