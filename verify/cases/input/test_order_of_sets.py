"""Nodes of node sets in the order that binds those of two sets in *EQUATION and *MPC.

Abaqus sorts a set by the numbers of its nodes unless a card has UNSORTED; CalculiX keeps the order of the deck. Reference: one mesh
in place of two that are bound.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import pytest

from verify.conftest import Run
from verify.readers.dat_frd_files import read_dat

DIGITS = 2e-6  # seven digits are printed
LAW = "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.25\n*SOLID SECTION, ELSET=E, MATERIAL=M\n"
LOADS = "*BOUNDARY\n1, 1, 3\n2, 1, 3\n3, 1, 3\n4, 1, 3\n*STEP\n*STATIC\n*CLOAD\n15, 3, 1.\n17, 1, 2.\n*NODE PRINT, NSET=TOP\nU\n*END STEP\n"
LOWER, UPPER = (8, 7, 6, 5), (14, 13, 12, 11)  #: the nodes at one place, the one above the other


def cubes(joint: tuple[int, ...]) -> str:
    """Two cubes one above the other; the lower nodes of the upper one are at the upper nodes of the lower one."""
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    nodes = [f"{1 + i + first}, {x}., {y}., {z}." for first, z in ((0, 0), (4, 1), (10, 1), (14, 2)) for i, (x, y) in enumerate(corners)]
    lines = ["*NODE", *nodes, "*ELEMENT, TYPE=C3D8, ELSET=E", "1, 1, 2, 3, 4, 5, 6, 7, 8"]
    lines += ["2, " + ", ".join(map(str, joint)) + ", 15, 16, 17, 18", "*NSET, NSET=TOP\n15, 16, 17, 18"]
    return "\n".join(lines) + "\n" + LAW


def tops(run_deck: Run, tmp_path: Path, deck: str, *options: str) -> dict[object, list[float]]:
    """The displacements of the upper side at the end."""
    done = run_deck(deck + LOADS, *options)
    assert done.returncode == 0, done.stdout
    return {k: list(v) for k, v in read_dat(tmp_path / "job.dat")[-1].rows.items()}


def sets(lower: tuple[int, ...], upper: tuple[int, ...], parameter: str = "") -> str:
    """The sets LOWER and UPPER."""
    return "".join(f"*NSET, NSET={name}{parameter}\n{', '.join(map(str, nodes))}\n" for name, nodes in (("LOWER", lower), ("UPPER", upper)))


EQUATIONS = "".join(f"*EQUATION\n2\nUPPER, {k}, 1., LOWER, {k}, -1.\n" for k in (1, 2, 3))


@pytest.mark.parametrize("bond", [EQUATIONS, "*MPC\nTIE, UPPER, LOWER\n"])
@pytest.mark.parametrize(("given", "options"), [
    (sets(LOWER, UPPER[::-1]), ()),  # each set is sorted
    (sets(LOWER, UPPER, ", UNSORTED"), ()),
    (sets(LOWER, UPPER), ("--dialect=calculix",)),  # none is
    ("*NSET, NSET=LOWER\n8, 6\n" + sets(LOWER, UPPER), ()),  # over two cards
])
def test_pairs_of_sets(run_deck: Run, tmp_path: Path, bond: str, given: str, options: tuple[str, ...]) -> None:
    """Each node is bound to the one at its place: the cubes move as one mesh."""
    whole = tops(run_deck, tmp_path, cubes((5, 6, 7, 8)), *options)
    bound = tops(run_deck, tmp_path, cubes((11, 12, 13, 14)) + given + bond, *options)
    assert {k: pytest.approx(v, rel=DIGITS, abs=1e-9) for k, v in whole.items()} == bound


def test_unsorted_pairs(run_deck: Run, tmp_path: Path) -> None:
    """UNSORTED keeps an order that binds nodes of different places."""
    whole = tops(run_deck, tmp_path, cubes((5, 6, 7, 8)))
    crossed = tops(run_deck, tmp_path, cubes((11, 12, 13, 14)) + sets(LOWER, UPPER[::-1], ", UNSORTED") + EQUATIONS)
    assert max(abs(crossed[k][0] - whole[k][0]) for k in whole) > 0.01 * max(abs(v[0]) for v in whole.values())


def test_points_between_sets(run_deck: Run, tmp_path: Path) -> None:
    """MPC, LINEAR over three sets, and over two sets and a node, is that over single nodes."""
    deck = cubes((5, 6, 7, 8)).replace("*ELEMENT", "31, 0.25, 0., 2.\n32, 0.5, 1., 2.\n*ELEMENT", 1).replace("NSET=TOP\n", "NSET=TOP\n31, 32, ")
    springs = "*ELEMENT, TYPE=SPRING1, ELSET=G\n91, 31\n92, 32\n*SPRING, ELSET=G\n3,\n50.\n"
    three = "*NSET, NSET=P\n31, 32\n*NSET, NSET=A, UNSORTED\n15, 18\n*NSET, NSET=B\n16, 17\n"
    single = tops(run_deck, tmp_path, deck + springs + "*MPC\nLINEAR, 31, 15, 16\nLINEAR, 32, 18, 17\n")
    assert single == tops(run_deck, tmp_path, deck + springs + three + "*MPC\nLINEAR, P, A, B\n")
    single = tops(run_deck, tmp_path, deck + springs + "*MPC\nLINEAR, 31, 15, 17\nLINEAR, 32, 16, 17\n")
    assert single == tops(run_deck, tmp_path, deck + springs + three.replace("15, 18", "15, 16") + "*MPC\nLINEAR, P, A, 17\n")
    done = run_deck(deck + springs + three.replace("16, 17", "5, 6, 7") + "*MPC\nLINEAR, P, A, B\n" + LOADS)
    assert done.returncode == 3
    assert "LINEAR binds nodes three by three" in done.stdout
