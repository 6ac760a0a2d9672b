"""Meshes that the deck makes of a few numbers: NGEN, NFILL, NCOPY, ELGEN, ELCOPY; their coordinates, sets and loads.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from verify.conftest import Run

DIGITS = 2e-6  # seven digits are printed
BLOCK = """*NODE
1, 0., 0., 0.
5, 4., 0., 0.
21, 0., 2., 0.
25, 4., 2., 0.
*NGEN, NSET=FRONT
1, 5
*NGEN, NSET=BACK
21, 25, 1
*NFILL, NSET=FLOOR
FRONT, BACK, 2, 10
*NCOPY, OLD SET=FLOOR, CHANGE NUMBER=100, SHIFT, MULTIPLE=2, NEW SET=UPPER
0., 0., 1.5

*NSET, NSET=N
FLOOR, UPPER
*ELEMENT, TYPE=C3D8, ELSET=E
1, 1, 2, 12, 11, 101, 102, 112, 111
*ELGEN, ELSET=E
1, 4, 1, 1, 2, 10, 10
*ELCOPY, OLD SET=E, ELEMENT SHIFT=100, SHIFT NODES=100, NEW SET=LID
"""
BAR = """*ELSET, ELSET=ALL
E, LID
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=ALL, MATERIAL=M
*NSET, NSET=LEFT, GENERATE
1, 221, 10
*SURFACE, NAME=RIGHT
4, S4
14, S4
104, S4
114, S4
"""
STEP = """*STEP
*STATIC
*BOUNDARY
LEFT, 1, 3
*DSLOAD
RIGHT, P, -10.
*NODE PRINT, NSET=N
U, COORD
*END STEP
"""


def rows_of(folder: Path, title: str) -> dict[int, list[float]]:
    """The rows of the block of a title."""
    text = (folder / "job.dat").read_text()
    block = re.search(rf"^ {title}.*?\n\n(.*?)(?:\n\n|\Z)", text, re.S | re.M)
    assert block
    return {int(line.split()[0]): [float(word) for word in line.split()[1:]] for line in block.group(1).splitlines()}


def test_block(run_deck: Run, tmp_path: Path) -> None:
    """A bar of 4 x 2 x 2 elements: every place, and u = s x / E under a tension s."""
    done = run_deck(BLOCK + BAR + STEP)
    assert done.returncode == 0, done.stdout
    places = rows_of(tmp_path, "coordinates") if "coordinates" in (tmp_path / "job.dat").read_text() else {}
    moves = rows_of(tmp_path, "displacements")
    labels = {100 * k + 10 * j + i + 1: (float(i), float(j), 1.5 * k) for i in range(5) for j in range(3) for k in range(3)}
    assert moves.keys() == labels.keys()
    floor = [label for label in moves if label < 100]
    assert floor == sorted(floor)  # sets are in the order of the numbers
    for label, (x, y, z) in labels.items():
        assert moves[label][0] == pytest.approx(10.0 * x / 1000.0, rel=DIGITS, abs=1e-12)
        if places:
            assert places[label] == pytest.approx([x, y, z], rel=DIGITS, abs=1e-12)


def test_inside_a_part(run_deck: Run, tmp_path: Path) -> None:
    """The same block as a part: it is made before the part is written flat."""
    part = f"*PART, NAME=P\n{BLOCK}*END PART\n*ASSEMBLY\n*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n"
    model = BAR.replace("E, LID", "I.E, I.LID").replace("*NSET, NSET=LEFT,", "*NSET, NSET=LEFT, INSTANCE=I,")
    deck = part + "*NSET, NSET=N, INSTANCE=I\nN,\n*END ASSEMBLY\n" + model.replace(", INSTANCE=I", "") + STEP
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    assert rows_of(tmp_path, "displacements")[225][0] == pytest.approx(0.04, rel=DIGITS)


def test_curves(run_deck: Run, tmp_path: Path) -> None:
    """A quarter of a circle by its centre, a parabola by its middle, and a row whose intervals grow by 2: 1/7, 3/7, 1 of it."""
    deck = """*NODE
1, 2., 0., 0.
4, 0., 2., 0.
9, 0., 0., 0.
11, 0., 0., 0.
15, 4., 0., 0.
31, 0., 0., 0.
40, 0., 0., 7.
*NGEN, LINE=C, NSET=N
1, 4, 1, 9
*NGEN, LINE=P, NSET=N
11, 15, 1, , 2., 1., 0.
*NSET, NSET=A
31
*NSET, NSET=B
40
*NFILL, BIAS=0.5, NSET=N
A, B, 3, 3
*NSET, NSET=N
1
*ELEMENT, TYPE=SPRING1, ELSET=S
1, 1
*SPRING, ELSET=S
1
1.
*STEP
*STATIC
*NODE PRINT, NSET=N
COORD
*END STEP
"""
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    text = (tmp_path / "job.dat").read_text()
    rows = {int(words[0]): [float(word) for word in words[1:]] for words in re.findall(r"^ +(\d+) +(\S+) +(\S+) +(\S+)$", text, re.M)}
    for i, label in enumerate((1, 2, 3, 4)):
        angle = math.radians(30.0 * i)
        assert rows[label] == pytest.approx([2 * math.cos(angle), 2 * math.sin(angle), 0.0], rel=DIGITS, abs=1e-9)
    for i, label in enumerate((11, 12, 13, 14, 15)):
        assert rows[label][:2] == pytest.approx([float(i), 1.0 - (i / 2.0 - 1.0) ** 2], rel=DIGITS, abs=1e-9)
    assert [rows[label][2] for label in (34, 37, 40)] == pytest.approx([1.0, 3.0, 7.0], rel=DIGITS)


def test_systems(run_deck: Run, tmp_path: Path) -> None:
    """Cylindrical and spherical coordinates, also of nodes that others are made of."""
    deck = """*NODE, SYSTEM=C, NSET=N
1, 2., 30., 5.
2, 2., 90., 5.
*NODE, SYSTEM=S, NSET=N
3, 2., 90., 30.
*NODE, NSET=N
12, 1., 2., 3.
*NSET, NSET=N
12
*NGEN, NSET=N
2, 12, 5
*ELEMENT, TYPE=SPRING1, ELSET=S
1, 1
*SPRING, ELSET=S
1
1.
*STEP
*STATIC
*NODE PRINT, NSET=N
COORD
*END STEP
"""
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    text = (tmp_path / "job.dat").read_text()
    rows = {int(words[0]): [float(word) for word in words[1:]] for words in re.findall(r"^ +(\d+) +(\S+) +(\S+) +(\S+)$", text, re.M)}
    half = math.sqrt(3.0) / 2.0
    assert rows[1] == pytest.approx([2.0 * half, 1.0, 5.0], rel=DIGITS)
    assert rows[2] == pytest.approx([0.0, 2.0, 5.0], rel=DIGITS, abs=1e-9)
    assert rows[3] == pytest.approx([0.0, 2.0 * half, 1.0], rel=DIGITS, abs=1e-9)
    assert rows[7] == pytest.approx([0.5, 2.0, 4.0], rel=DIGITS)


def test_link(run_deck: Run, tmp_path: Path) -> None:
    """A node on springs, linked to a fixed node: it moves across the link only, F / k.

    Under calculix the link turns NLGEOM on, as BEAM does there: the node stays on the circle, where F and the springs k turn it by
    tan a = F_y/(k L + F_x).
    """
    deck = """*NODE
1, 0., 0., 0.
2, 1., 0., 0.
*NSET, NSET=N
2
*ELEMENT, TYPE=SPRING1, ELSET=A
1, 2
*ELEMENT, TYPE=SPRING1, ELSET=B
2, 2
*SPRING, ELSET=A
1
100.
*SPRING, ELSET=B
2
100.
*MPC
LINK, 1, 2
*BOUNDARY
1, 1, 3
2, 3
*STEP
*STATIC
*CLOAD
2, 1, 5.
2, 2, 3.
*NODE PRINT, NSET=N
U
*END STEP
"""
    angle = math.atan(3.0 / (100.0 + 5.0))
    for dialect, expected in (("abaqus", [0.0, 0.03, 0.0]), ("calculix", [math.cos(angle) - 1.0, math.sin(angle), 0.0])):
        done = run_deck(f"** dialect: {dialect}\n{deck}")
        assert done.returncode == 0, done.stdout
        (row,) = rows_of(tmp_path, "displacements").values()
        assert row == pytest.approx(expected, rel=DIGITS, abs=1e-9)


@pytest.mark.parametrize(("card", "message"), [
    ("*NGEN\n1, 7, 1\n", "There is no node 7 before this card"),
    ("*NGEN\n1, 5, 3\n", "no multiple of the step 3"),
    ("*NGEN, LINE=S\n1, 5\n", "LINE must be C (circle) or P"),
    ("*NGEN, SYSTEM=C\n1, 5\n", "The parameter SYSTEM of *NGEN is not supported"),
    ("*NFILL\nA, B, 3, 1\n", "There is no node set 'A' before this card"),
    ("*NFILL, BIAS=-1.\n", "BIAS must be positive"),
    ("*NCOPY, OLD SET=X, CHANGE NUMBER=10, SHIFT\n", "There is no node set 'X' before this card"),
    ("*NCOPY, OLD SET=X, CHANGE NUMBER=10, REFLECT=LINE\n", "REFLECT"),
    ("*ELGEN\n7, 2\n", "There is no element 7 before this card"),
    ("*ELCOPY, OLD SET=X, ELEMENT SHIFT=0\n", "needs ELEMENT SHIFT"),
    ("*NGEN\n1, x\n", "must be an integer"),
])  # fmt: skip
def test_refused(run_deck: Run, card: str, message: str) -> None:
    """The message names the line of the card."""
    done = run_deck(f"*NODE\n1, 0., 0., 0.\n5, 4., 0., 0.\n{card}{STEP}")
    assert done.returncode == 3, done.stdout
    assert message in re.sub(r"\s+", " ", done.stdout + done.stderr)
