"""Quadratic bodies that close a gap in their first increment, which is the whole step: few iterations and factorisations, no failed attempt.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run

GAP, LOAD, MU = 0.05, 2000.0, 0.15
MAX_ITERATIONS, MAX_FACTORISATIONS = 4, 6  #: 3 and 4 were found
#: corner nodes of the faces S1, S2, ... of an element
FACES = {
    "C3D10": [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)],
    "C3D20": [(0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)],
}


def two_blocks(kind: str, formulation: str) -> str:
    """A block over a larger one, with a gap; the rigid lid of the upper one is pressed down by a force and guided along z."""
    from verify.decks import make_decks, solids

    sizes = {"LOW": ((0, 0, 0), (4, 4, 1), (4, 4, 2), 1.0), "TOP": ((1, 1, 1 + GAP), (3, 3, 2 + GAP), (3, 3, 2), 1 + GAP)}
    lines: list[str] = []
    surfaces: list[str] = []
    n_nodes = n_elements = 0
    for name, (low, high, cells, contact) in sizes.items():
        ticks = [np.linspace(a, b, n + 1) for a, b, n in zip(low, high, cells, strict=True)]
        body = solids.as_kind(make_decks.block(*ticks, name), kind)
        heights = body.nodes[:, 2]
        held = np.flatnonzero(np.abs(heights - (low[2] if name == "LOW" else high[2])) < 1e-9) + 1 + n_nodes
        lines += [f"*NODE, NSET={name}"] + [f"{n_nodes + i}, {x:.15g}, {y:.15g}, {z:.15g}" for i, (x, y, z) in enumerate(body.nodes, 1)]
        lines += [f"*ELEMENT, TYPE={kind}, ELSET={name}"]
        surfaces += [f"*SURFACE, NAME=FACE_{name}"]
        for number, element in enumerate(body.elements, n_elements + 1):
            words = [str(number), *(str(int(node) + 1 + n_nodes) for node in element)]
            lines += [", ".join(words[:16]) + ("," if len(words) > 16 else "")] + ([", ".join(words[16:])] if len(words) > 16 else [])
            for face, corners in enumerate(FACES[kind], 1):
                if all(abs(heights[int(element[corner])] - contact) < 1e-9 for corner in corners):
                    surfaces += [f"{number}, S{face}"]
        lines += [f"*NSET, NSET=HELD_{name}", *map(str, held)]
        n_nodes += len(body.nodes)
        n_elements += len(body.elements)
    return "\n".join([*lines, "*NODE, NSET=HAND", "900000, 2., 2., 2.", "*RIGID BODY, NSET=HELD_TOP, REF NODE=900000",
                      "*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., 0.3", "*SOLID SECTION, ELSET=LOW, MATERIAL=STEEL",
                      "*SOLID SECTION, ELSET=TOP, MATERIAL=STEEL", *surfaces, "*SURFACE INTERACTION, NAME=DRY", "*FRICTION", f"{MU}",
                      f"*CONTACT PAIR, INTERACTION=DRY, TYPE={formulation}", "FACE_TOP, FACE_LOW", "*STEP", "*STATIC", "1., 1.",
                      "*BOUNDARY", "HELD_LOW, 1, 3", "HAND, 1, 2", "HAND, 4, 6", "*CLOAD", f"HAND, 3, {-LOAD}",
                      "*NODE PRINT, NSET=HELD_LOW, TOTALS=ONLY", "RF", "*END STEP", ""])  # fmt: skip


@pytest.mark.parametrize("formulation", ["SURFACE TO SURFACE", "NODE TO SURFACE"])
@pytest.mark.parametrize("kind", FACES)
def test_first_increment_closes_the_gap(run: Run, tmp_path: Path, kind: str, formulation: str) -> None:
    """The upper block hangs free until it touches; the whole load goes through the contact."""
    (tmp_path / "job.inp").write_text(two_blocks(kind, formulation))
    done = run(["job"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    reported = {name: int(re.search(rf"{name} +(\d+)", done.stdout)[1])  # type: ignore[index]
            for name in ("increments converged", "attempts that failed", "Newton iterations", "factorisations")}  # fmt: skip
    assert reported["increments converged"] == 1
    assert reported["attempts that failed"] == 0
    assert reported["Newton iterations"] <= MAX_ITERATIONS
    assert reported["factorisations"] <= MAX_FACTORISATIONS
    force = [float(word) for word in (tmp_path / "job.dat").read_text().split()[-3:]]
    assert force[2] == pytest.approx(LOAD, rel=1e-5)
    if kind == "C3D20":  # tetrahedra have no symmetry: friction has a resultant, which the guides of the lid take
        assert force[:2] == pytest.approx([0, 0], abs=1e-5 * LOAD)
    assert np.hypot(*force[:2]) <= MU * LOAD
