"""Elements with repeated nodes, as mesh generators write them, against the same mesh of triangles, wedges and tetrahedra.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.readers.dat_frd_files import read_dat

RunDeck = Callable[..., subprocess.CompletedProcess[str]]

#: Kind of the deck, that of the same elements without repeated nodes, section, load of the deck and of the other one. The plate has
#: two triangles above its diagonal, the block two wedges; each element is turned otherwise.
PLATE = "1, 0., 0.\n2, 2., 0.\n3, 2., 1.\n4, 0., 1.\n"
BLOCK = PLATE + "5, 0., 0., 1.\n6, 2., 0., 1.\n7, 2., 1., 1.\n8, 0., 1., 1.\n"
CASES = {
    "CPS4": (PLATE, "CPS3", ["1, 2, 3, 3", "4, 4, 1, 3"], ["1, 2, 3", "4, 1, 3"], "*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n0.5", "1, P2, 3.\n2, P4, 2.", "1, P2, 3.\n2, P3, 2."),
    "CPE4R": (PLATE, "CPE3", ["3, 1, 2, 2", "4, 1, 1, 3"], ["3, 1, 2", "4, 1, 3"], "*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n0.5", "1, P4, 3.\n2, P4, 2.", "1, P3, 3.\n2, P3, 2."),
    "CAX4": ("1, 1., 0.\n2, 3., 0.\n3, 3., 1.\n4, 1., 1.\n", "CAX3", ["1, 2, 3, 3", "1, 3, 4, 4"], ["1, 2, 3", "1, 3, 4"], "*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n", "1, P2, 3.\n2, P2, 2.", "1, P2, 3.\n2, P2, 2."),
    "S4R": (PLATE, "S3", ["1, 2, 3, 3", "4, 4, 1, 3"], ["1, 2, 3", "4, 1, 3"], "*SHELL SECTION, ELSET=ALL, MATERIAL=STEEL\n0.1", "ALL, P, 0.01\n1, EDNOR2, 0.2\n2, EDNOR4, 0.1", "ALL, P, 0.01\n1, EDNOR2, 0.2\n2, EDNOR3, 0.1"),
    "C3D8": (BLOCK, "C3D6", ["1, 2, 3, 3, 5, 6, 7, 7", "4, 4, 1, 3, 8, 8, 5, 7"], ["1, 2, 3, 5, 6, 7", "1, 3, 4, 5, 7, 8"], "*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n", "1, P4, 3.\n2, P6, 2.", "1, P4, 3.\n2, P4, 2."),
    "C3D8R": (BLOCK, "C3D6", ["1, 2, 3, 3, 5, 6, 7, 7", "1, 3, 4, 4, 5, 7, 8, 8"], ["1, 2, 3, 5, 6, 7", "1, 3, 4, 5, 7, 8"], "*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n", "1, P4, 3.\n2, P2, 2.", "1, P4, 3.\n2, P2, 2."),
}


def deck(nodes: str, kind: str, elements: list[str], section: str, loads: str, nlgeom: str) -> str:
    """A body held at its left side."""
    text = "*NODE, NSET=N\n" + nodes + f"*ELEMENT, TYPE={kind}, ELSET=ALL\n" + "".join(f"{i}, {row}\n" for i, row in enumerate(elements, start=1))
    text += f"*MATERIAL, NAME=STEEL\n*ELASTIC\n1000., 0.3\n{section}\n*NSET, NSET=LEFT\n1, 4" + (", 5, 8\n" if nodes == BLOCK else "\n")
    hold = "LEFT, 1, 6\n" if kind.startswith("S") else "LEFT, 1, 3\n"
    return text + f"*BOUNDARY\n{hold}*STEP{nlgeom}\n*STATIC\n*DLOAD\n{loads}\n*NODE PRINT, NSET=N\nU\n*NODE PRINT, NSET=LEFT, TOTALS=ONLY\nRF\n*END STEP\n"


def results(folder: Path) -> np.ndarray:
    """All printed numbers."""
    return np.concatenate([np.ravel(list(table.rows.values())) for table in read_dat(folder / "job.dat")])


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
@pytest.mark.parametrize("kind", CASES)
def test_as_triangles_and_wedges(run_deck: RunDeck, tmp_path: Path, kind: str, nlgeom: str) -> None:
    """Displacements and reactions are those of the mesh without repeated nodes; loads act on the faces that the deck numbers."""
    nodes, other, elements, others, section, loads, other_loads = CASES[kind]
    done = run_deck(deck(nodes, kind, elements, section, loads, nlgeom))
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"2 elements {kind} have repeated nodes" in done.stdout
    first = results(tmp_path)
    done = run_deck(deck(nodes, other, others, section, other_loads, nlgeom))
    assert done.returncode == 0, done.stdout + done.stderr
    assert np.abs(first).max() > 1e-3
    assert first == pytest.approx(results(tmp_path), rel=1e-6, abs=1e-9)


def test_surfaces_and_contact_faces(run_deck: RunDeck, tmp_path: Path) -> None:
    """A surface of faces S4 of a collapsed block carries a pressure; face S5, which is a line, is refused."""
    nodes, _, elements, _, section, _, _ = CASES["C3D8R"]
    text = deck(nodes, "C3D8R", elements, section, "1, P1, 0.", "").replace("*BOUNDARY", "*SURFACE, NAME=RIGHT\n1, S4\n*BOUNDARY").replace("*NODE PRINT, NSET=N", "*DSLOAD\nRIGHT, P, 3.\n*NODE PRINT, NSET=N", 1)
    done = run_deck(text)
    assert done.returncode == 0, done.stdout + done.stderr
    assert results(tmp_path)[-3:] == pytest.approx([3.0, 0.0, 0.0], abs=1e-6)
    done = run_deck(text.replace("1, S4", "1, S5"))
    assert done.returncode == 3
    assert "no face S5" in done.stdout
