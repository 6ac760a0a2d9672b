"""*TIE to a master that is made of nodes (abaqus dialect): each slave node moves with the nearest one.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.grids import bodies_deck, grid
from verify.decks.make_decks import Floats
from verify.decks.sheets import between, fix

ELASTIC = "*ELASTIC\n1000., 0.3\n"
SETUP_ERROR, DECK_ERROR = 4, 3


def last(folder: Path, name: str) -> tuple[Floats, Floats]:
    """Places of all nodes, and a field at the end."""
    with h5py.File(folder / "job.vtkhdf") as file:
        place = np.asarray(file["VTKHDF/Points"])
        return place, np.asarray(file[f"VTKHDF/PointData/{name}"])[-len(place):]


def step(*entries: str, words: str = ", NLGEOM") -> str:
    """A step with supports."""
    return f"*STEP{words}\n*STATIC\n0.5, 1.\n{fix(*entries)}*END STEP\n"


@pytest.mark.parametrize("slave", ["faces", "nodes"])
def test_matching_blocks_are_one_body(run_deck: Run, tmp_path: Path, slave: str) -> None:
    """Blocks of matching meshes, a small gap between them, tied node to node: pulled, sheared and bent they are one body of the same mesh."""
    line = between(0, 1, 2)
    bodies = [grid("LOW", line, line, between(-1, 0, 2)), grid("UP", line, line, between(0.001, 1.001, 2))]
    surface = "UP_W0" if slave == "faces" else "DOTS"
    tie = f"*SURFACE, NAME=HOLD, TYPE=NODE\nLOW_W1\n*SURFACE, NAME=DOTS, TYPE=NODE\nUP_W0\n*TIE, NAME=T\n{surface}, HOLD\n"
    loads = step("{}_W0, 1, 3", "{}_W1, 1, 1, 0.2", "{}_W1, 2, 2", "{}_W1, 3, 3, 0.1")
    done = run_deck("** dialect: abaqus\n" + bodies_deck([(body, ELASTIC) for body in bodies], "C3D8", tie + loads.replace("{}_W0", "LOW_W0").replace("{}_W1", "UP_W1")))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "slave node" not in done.stdout
    place, tied = last(tmp_path, "U")
    assert np.all(np.abs(place[:, 2] - 0.001) > 1e-6)   # the slave nodes were moved onto their masters
    whole = grid("ONE", line, line, [-1.0, -0.5, 0.0, 0.501, 1.001])
    done = run_deck("** dialect: abaqus\n" + bodies_deck([(whole, ELASTIC)], "C3D8", loads.replace("{}", "ONE")))
    assert done.returncode == 0, done.stdout + done.stderr
    there, wanted = last(tmp_path, "U")
    number = [int(np.argmin(np.linalg.norm(there - x, axis=1))) for x in place]
    assert tied == pytest.approx(wanted[number], abs=1e-7)


BARS = """*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 1.02, 0., 0.
4, 2.02, 0., 0.
5, 1.03, 0.05, 0.
6, 9., 9., 9.
*ELEMENT, TYPE=T3D2, ELSET=LEFT
1, 1, 2
*ELEMENT, TYPE=T3D2, ELSET=RIGHT
2, 3, 4
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=LEFT, MATERIAL=M
2.
*SOLID SECTION, ELSET=RIGHT, MATERIAL=M
1.
*MASS, ELSET=MASSES
1.
*ELEMENT, TYPE=MASS, ELSET=MASSES
3, 5
4, 6
*SURFACE, NAME=JOINTS, TYPE=NODE
2,
6,
*SURFACE, NAME=ENDS, TYPE=NODE
3,
5,
"""


@pytest.mark.parametrize("tolerance", ["0.03", "0.1"])
def test_bars(run_deck: Run, tmp_path: Path, tolerance: str) -> None:
    """Two bars whose ends are 0.02 apart, tied in place: F = u/(L1/E A1 + L2/E A2). A slave node farther than the tolerance stays free, and the job says so."""
    free = tolerance == "0.03"
    held = ["1, 1, 3", "2, 2, 3", "4, 2, 3", "4, 1, 1, 0.03", "6, 1, 3", *(["5, 1, 3"] if free else [])]
    done = run_deck("** dialect: abaqus\n" + BARS + f"*TIE, NAME=T, POSITION TOLERANCE={tolerance}, ADJUST=NO\nENDS, JOINTS\n" + step(*held, words=""))
    assert done.returncode == 0, done.stdout + done.stderr
    place, u = last(tmp_path, "U")
    force = last(tmp_path, "RF")[1]
    assert place[2, 0] == 1.02
    assert force[3, 0] == pytest.approx(0.03 / (1 / 2000 + 1 / 1000), rel=1e-9)   # the tie of node 5 adds no stiffness
    assert u[2] == pytest.approx(u[1], abs=1e-12)
    assert u[1, 0] == pytest.approx(0.01, rel=1e-9)
    assert u[4, 0] == pytest.approx(0.0 if free else 0.01, abs=1e-9)
    assert ("ties 1 of 2 slave nodes" in " ".join((done.stdout + done.stderr).split())) == free


@pytest.mark.parametrize(("deck", "code", "sentence"), [
    ("** dialect: calculix\n" + BARS + "*TIE, NAME=T, POSITION TOLERANCE=1.\nENDS, JOINTS\n", DECK_ERROR, "CalculiX ties to faces"),
    ("** dialect: abaqus\n" + BARS + "*SURFACE, NAME=ONE, TYPE=NODE\n2\n*TIE, NAME=T\nENDS, ONE\n", DECK_ERROR, "has one node"),
    ("** dialect: abaqus\n" + BARS + "*TIE, NAME=T, POSITION TOLERANCE=0.01\nENDS, JOINTS\n", SETUP_ERROR, "the nearest one is 0.02 away"),
])  # fmt: skip
def test_refused(run_deck: Run, deck: str, code: int, sentence: str) -> None:
    """CalculiX's masters are faces; a tolerance that reaches no node, or none at all, is an error with its figures."""
    done = run_deck(deck + step("1, 1, 3", "6, 1, 3", words=""))
    assert done.returncode == code, done.stdout + done.stderr
    assert sentence in " ".join((done.stdout + done.stderr).split())


def test_rotations_are_not_tied(run_deck: Run) -> None:
    """Two shells tied node to node would be a hinge, where Abaqus ties rotations too."""
    nodes = "".join(f"{1 + i + 10 * k}, {x}, {y}, 0.\n" for k in (0, 1) for i, (x, y) in enumerate(((k, 0), (k + 1, 0), (k + 1, 1), (k, 1))))
    deck = f"** dialect: abaqus\n*NODE\n{nodes}*ELEMENT, TYPE=S4, ELSET=E\n1, 1, 2, 3, 4\n2, 11, 12, 13, 14\n*MATERIAL, NAME=M\n{ELASTIC}"
    deck += "*SHELL SECTION, ELSET=E, MATERIAL=M\n0.1\n*SURFACE, NAME=A, TYPE=NODE\n2, 3\n*SURFACE, NAME=B, TYPE=NODE\n11, 14\n"
    deck = deck.replace("2, 3\n*SURFACE", "2,\n3,\n*SURFACE").replace("11, 14\n", "11,\n14,\n")
    done = run_deck(deck + "*TIE, NAME=T\nB, A\n" + step("1, 1, 6", "4, 1, 6", words=""))
    assert done.returncode == SETUP_ERROR, done.stdout + done.stderr
    assert "not their rotations" in " ".join((done.stdout + done.stderr).split())
