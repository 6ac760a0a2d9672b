"""Nodes of point masses and of springs in one direction: where a rigid body, a coupling, a tie or an equation binds them, they move with what binds them.

A direction in which nothing at such a node has stiffness is fixed only if no constraint has it. (Fixed in any case, it would hold the body.)

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.make_decks import Floats
from verify.decks.solids import unit_cube

CUBE = "** dialect: {dialect}\n" + unit_cube(low="BOTTOM", high="TOP") + """*NODE
90, 0.5, 0.5, 1.
91, 1., 1., 1.
*SURFACE, NAME=UP
1, S2
*SURFACE, NAME=CORNERS, TYPE=NODE
TOP,
*SURFACE, NAME=POINT, TYPE=NODE
91,
*MATERIAL, NAME=M
*ELASTIC
1000., 0.25
*SOLID SECTION, ELSET=E, MATERIAL=M
"""
MASS = "*ELEMENT, TYPE=MASS, ELSET=LUMP\n9, {node}\n*MASS, ELSET=LUMP\n{mass}\n"
SPRING = "*ELEMENT, TYPE=SPRING1, ELSET=SOFT\n9, {node}\n*SPRING, ELSET=SOFT\n2\n1e-9\n"
CARDS = {
    "rigid body": (90, "*RIGID BODY, NSET=TOP, REF NODE=90\n"),
    "kinematic coupling": (90, "*COUPLING, REF NODE=90, SURFACE=UP, CONSTRAINT NAME=C\n*KINEMATIC\n1, 6\n"),
    "distributing coupling": (90, "*COUPLING, REF NODE=90, SURFACE=UP, CONSTRAINT NAME=C\n*DISTRIBUTING\n"),
    "pin": (91, "*MPC\nPIN, 91, 7\n"),
    "equation": (91, "".join(f"*EQUATION\n2\n91, {k}, 1., 7, {k}, -1.\n" for k in (1, 2, 3))),
    "equation the other way": (91, "".join(f"*EQUATION\n2\n7, {k}, 1., 91, {k}, -1.\n" for k in (1, 2, 3))),
    "tie": (91, "*TIE, NAME=T\nPOINT, UP\n"),
    "tie to nodes": (91, "*TIE, NAME=T\nPOINT, CORNERS\n"),
}


def moved(run_deck: Run, folder: Path, model: str, load: str, dialect: str = "abaqus", words: str = "") -> Floats:
    """The displacements of all nodes."""
    done = run_deck(CUBE.format(dialect=dialect) + model + f"*STEP{words}\n*STATIC\n1., 1.\n*BOUNDARY\nBOTTOM, 1, 3\n{load}*END STEP\n")
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(folder / "job.vtkhdf") as file:
        u = np.asarray(file["VTKHDF/PointData/U"])[-10:]
    assert np.abs(u[4:8, 0]).min() > 1e-6
    return u


@pytest.mark.parametrize("words", ["", ", NLGEOM"], ids=["linear", "nlgeom"])
@pytest.mark.parametrize("what", CARDS)
def test_point_moves_with_what_binds_it(run_deck: Run, tmp_path: Path, what: str, words: str) -> None:
    """A force on the bound node gives the displacements that it gives without the point; the weight of the mass those of a force."""
    node, cards = CARDS[what]
    load = f"*CLOAD\n{node}, 1, 5.\n{node}, 3, -3.\n"
    plain = moved(run_deck, tmp_path, cards, load, words=words)
    tolerance = 1e-12 if not words else 1e-6 * np.abs(plain).max()
    for point in (MASS.format(node=node, mass=2.0), SPRING.format(node=node)):
        assert moved(run_deck, tmp_path, cards + point, load, words=words) == pytest.approx(plain, abs=tolerance + 1e-11)
    weight = moved(run_deck, tmp_path, cards + MASS.format(node=node, mass=2.0), "*DLOAD\nLUMP, GRAV, 2.5, 1., 0., 0.\n", words=words)
    assert weight == pytest.approx(moved(run_deck, tmp_path, cards, f"*CLOAD\n{node}, 1, 5.\n", words=words), abs=tolerance + 1e-11)


def test_in_the_calculix_dialect(run_deck: Run, tmp_path: Path) -> None:
    """The same."""
    node, cards = CARDS["rigid body"]
    load = f"*CLOAD\n{node}, 1, 5.\n"
    plain = moved(run_deck, tmp_path, cards, load, "calculix")
    assert moved(run_deck, tmp_path, cards + MASS.format(node=node, mass=2.0), load, "calculix") == pytest.approx(plain, abs=1e-11)


def test_point_that_nothing_binds(run_deck: Run, tmp_path: Path) -> None:
    """A mass alone stays where it is."""
    done = run_deck(CUBE.format(dialect="abaqus") + MASS.format(node=91, mass=1.0) + "*STEP\n*STATIC\n*BOUNDARY\nBOTTOM, 1, 3\n*CLOAD\nTOP, 1, 1.\n*END STEP\n")
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        assert np.all(np.asarray(file["VTKHDF/PointData/U"])[-1] == 0.0)
