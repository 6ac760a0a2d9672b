"""Cyclic symmetry, the older kinematic coupling, pre-tension of a truss and data in files, against closed forms.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.solids import unit_cube

DIGITS = 2e-6  # seven digits are printed
YOUNG, NU, DENSITY = 1000.0, 0.3, 2.0
INNER, OUTER = 1.0, 2.0


def rows_of(folder: Path, title: str = "displacements") -> dict[int, list[float]]:
    """The rows of the last block of a title in job.dat."""
    rows: dict[int, list[float]] = {}
    is_inside = False
    for line in (folder / "job.dat").read_text().splitlines():
        if " for set " in line:
            is_inside = line.strip().startswith(title)
            rows = {} if is_inside else rows
        elif is_inside and re.match(r" +\d", line) and (words := line.split()):
            rows[int(words[0])] = [float(word) for word in words[1:]]
    return rows


def sector(n_sectors: int, start: float, cells: tuple[int, int], is_turned: bool = False) -> tuple[str, np.ndarray]:
    """A sector of a ring, C3D20R, one cell high, from an angle on; node sets A and B are its sides. With is_turned B is the first."""
    n_r, n_t = cells
    angle = 2 * math.pi / n_sectors
    grid: dict[tuple[int, int, int], int] = {}
    points: list[tuple[float, float, float]] = []

    def node(i: int, j: int, k: int) -> int:
        """The node of half-steps i outward, j around, k up."""
        if (i, j, k) not in grid:
            r, t = INNER + (OUTER - INNER) * i / (2 * n_r), start + angle * j / (2 * n_t)
            points.append((r * math.cos(t), r * math.sin(t), k / 100))
            grid[i, j, k] = len(points)
        return grid[i, j, k]

    corners = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
    edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    rows = []
    for i in range(n_r):
        for j in range(n_t):
            local = corners + [tuple((a + b) // 2 for a, b in zip(corners[p], corners[q], strict=True)) for p, q in edges]
            rows.append([node(2 * i + a, 2 * j + b, c) for a, b, c in local])
    x = np.array(points)
    sides = {"A": [n for key, n in grid.items() if key[1] == 0], "B": [n for key, n in grid.items() if key[1] == 2 * n_t]}
    if is_turned:
        sides = {"A": sides["B"], "B": sides["A"]}
    text = "*NODE, NSET=ALL\n" + "".join(f"{i}, {a:.16g}, {b:.16g}, {c:.16g}\n" for i, (a, b, c) in enumerate(points, 1))
    text += "*ELEMENT, TYPE=C3D20R, ELSET=RING\n"
    text += "".join(f"{e}, " + ", ".join(map(str, row[:10])) + ",\n" + ", ".join(map(str, row[10:])) + "\n" for e, row in enumerate(rows, 1))
    for name, items in sides.items():
        text += f"*NSET, NSET={name}\n" + "".join(f"{n},\n" for n in items)
        text += f"*SURFACE, NAME=S{name}, TYPE=NODE\n{name}\n"
    low = [n for key, n in grid.items() if key[2] == 0]
    text += "*NSET, NSET=LOW\n" + "".join(f"{n},\n" for n in low) + "*NSET, NSET=ONE\n" + f"{node(0, 0, 0)}\n"
    text += f"*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, {NU}\n*DENSITY\n{DENSITY}\n*SOLID SECTION, ELSET=RING, MATERIAL=M\n"
    return text, x


TIE = "*TIE, NAME=CS, CYCLIC SYMMETRY\nSA, SB\n*CYCLIC SYMMETRY MODEL, N={}, TIE=CS\n0., 0., 0., 0., 0., {}\n"


@pytest.mark.parametrize(("n", "along", "is_turned"), [(4, 1.0, False), (12, -1.0, False), (12, 1.0, True), (3, 2.0, False)])
def test_turning_ring(run_deck: Run, tmp_path: Path, n: int, along: float, is_turned: bool) -> None:
    """A thin ring turns: 8 E u / (rho w^2 r) = (3 + nu) ((1 - nu) (a^2 + b^2) + (1 + nu) a^2 b^2 / r^2) - (1 - nu^2) r^2.

    Whichever side depends, and whichever direction the axis points. Timoshenko and Goodier, Theory of Elasticity, sec. 32.
    """
    omega2 = 0.3
    text, x = sector(n, 0.3, (4, 2 if n > 3 else 6), is_turned)
    loads = f"*DLOAD\nRING, CENTRIF, {omega2}, 0., 0., 0., 0., 0., 1.\n"
    held = "*BOUNDARY\nLOW, 3, 3\n*TRANSFORM, NSET=ONE, TYPE=C\n0., 0., 0., 0., 0., 1.\n*BOUNDARY\nONE, 2, 2\n"
    done = run_deck(f"{text}{TIE.format(n, along)}{held}*STEP\n*STATIC\n{loads}*NODE PRINT, NSET=ALL, GLOBAL=YES\nU\n*END STEP\n")
    assert done.returncode == 0, done.stdout
    u = rows_of(tmp_path)
    a, b = INNER, OUTER
    for label in range(1, len(x) + 1):
        r = math.hypot(x[label - 1][0], x[label - 1][1])
        exact = DENSITY * omega2 * r / (8 * YOUNG) * (
            (3 + NU) * ((1 - NU) * (a**2 + b**2) + (1 + NU) * a**2 * b**2 / r**2) - (1 - NU**2) * r**2)
        e = np.array([x[label - 1][0], x[label - 1][1]]) / r
        ur, ut = float(e @ u[label][:2]), float(e[0] * u[label][1] - e[1] * u[label][0])
        assert ur == pytest.approx(exact, rel=4e-3), f"node {label}"   # 4 quadratic elements over the width
        assert abs(ut) < 1e-4 * exact


def test_node_on_the_axis_stays_there(run_deck: Run, tmp_path: Path) -> None:
    """Two wedges around the axis: its nodes are their own partners and move along it only."""
    deck = """*NODE, NSET=ALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 0., 1., 0.
4, 0., 0., 1.
5, 1., 0., 1.
6, 0., 1., 1.
*ELEMENT, TYPE=C3D6, ELSET=E
1, 1, 2, 3, 4, 5, 6
*SURFACE, NAME=SA, TYPE=NODE
1
2
4
5
*SURFACE, NAME=SB, TYPE=NODE
1
3
4
6
*NSET, NSET=LOW
1, 2, 3
*MATERIAL, NAME=M
*ELASTIC
1000., .25
*SOLID SECTION, ELSET=E, MATERIAL=M
*TIE, NAME=CS, CYCLIC SYMMETRY
SA, SB
*CYCLIC SYMMETRY MODEL, N=4, TIE=CS
0., 0., 0., 0., 0., 1.
*BOUNDARY
LOW, 3, 3
2, 2, 2
*STEP
*STATIC
*DLOAD
E, P2, 10.
*NODE PRINT, NSET=ALL
U
*END STEP
"""
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    u = rows_of(tmp_path)
    assert u[4] == pytest.approx([0, 0, -0.01], abs=1e-9)
    assert u[5] == pytest.approx([0.25 * 0.01, 0, -0.01], abs=1e-9)
    assert u[6] == pytest.approx([0, 0.25 * 0.01, -0.01], abs=1e-9)


@pytest.mark.parametrize(("cards", "code", "message"), [
    ("*TIE, NAME=CS, CYCLIC SYMMETRY\nSA, SB\n", 3, "no *CYCLIC SYMMETRY MODEL, TIE=CS"),
    ("*CYCLIC SYMMETRY MODEL, N=4, TIE=CS\n0,0,0,0,0,1\n", 3, "There is no *TIE, NAME=CS, CYCLIC SYMMETRY"),
    (TIE.format(1, 1.0), 3, "must be at least 2"),
    (TIE.format(4, 0.0), 3, "must differ"),
    (TIE.format(5, 1.0), 4, "have no partner"),
    ("*TIE, NAME=CS, MULTISTAGE\nSA, SB\n", 3, "Model the whole body"),
])
def test_refused_sectors(run_deck: Run, cards: str, code: int, message: str) -> None:
    """Cards that do not fit together, and a wrong number of sectors."""
    text, _ = sector(4, 0.0, (1, 1))
    done = run_deck(f"{text}{cards}*STEP\n*STATIC\n*END STEP\n")
    assert done.returncode == code, done.stdout
    assert message in re.sub(r"\s+", " ", done.stdout + done.stderr)


CUBE = unit_cube(low="BOTTOM", high="TOP") + """*NODE, NSET=ALL
90, .5, .5, 2.
*MATERIAL, NAME=M
*ELASTIC
1000., .25
*SOLID SECTION, ELSET=E, MATERIAL=M
"""


def test_kinematic_coupling(run_deck: Run, tmp_path: Path) -> None:
    """The older card binds what *COUPLING with *KINEMATIC binds: the same numbers to the last digit."""
    loads = "*BOUNDARY\nBOTTOM, 1, 3\n*STEP, NLGEOM\n*STATIC\n*CLOAD\n90, 1, 5.\n90, 6, 20.\n*NODE PRINT, NSET=ALL\nU\n*END STEP\n"
    done = run_deck(f"{CUBE}*KINEMATIC COUPLING, REF NODE=90\nTOP\n{loads}")
    assert done.returncode == 0, done.stdout
    old = rows_of(tmp_path)
    assert run_deck(f"{CUBE}*SURFACE, NAME=UP\nE, S2\n*COUPLING, REF NODE=90, SURFACE=UP, CONSTRAINT NAME=C\n*KINEMATIC\n{loads}").returncode == 0
    assert old == rows_of(tmp_path)
    assert run_deck(f"{CUBE}*KINEMATIC COUPLING, REF NODE=90\nTOP, 3\n{loads.replace('90, 1, 5.', '90, 3, -5.').replace('90, 6, 20.', '90, 4, 0.')}"
                    ).returncode == 0
    assert rows_of(tmp_path)[7][0] > 1e-4, "only the third direction is bound"


@pytest.mark.parametrize(("row", "message"), [
    ("", "needs data lines"),
    ("TOP, 4, 6\n", "must be 1 to 3"),
    ("NOWHERE\n", "There is no node or node set"),
])
def test_refused_kinematic_coupling(run_deck: Run, row: str, message: str) -> None:
    """Invalid rows."""
    done = run_deck(f"{CUBE}*KINEMATIC COUPLING, REF NODE=90\n{row}*STEP\n*STATIC\n*END STEP\n")
    assert done.returncode == 3
    assert message in done.stdout + done.stderr


TRUSS = """*NODE, NSET=ALL
1, 0, 0, 0
2, 3, 4, 0
3, 6, 8, 0
9, 0, 0, 0
*ELEMENT, TYPE=T3D2, ELSET=ROD
1, 1, 2
2, 2, 3
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=ROD, MATERIAL=M
.5
*BOUNDARY
1, 1, 3
3, 1, 3
2, 3, 3
"""


def test_pretension_of_a_truss(run_deck: Run, tmp_path: Path) -> None:
    """A rod of two trusses between walls, cut and pulled together: F in both, overlap F L / (E A) of the whole rod."""
    # a weak spring keeps the middle from swinging out sideways
    side = "*NODE\n4, 7, 1, 0\n*ELEMENT, TYPE=SPRINGA, ELSET=S\n9, 2, 4\n*SPRING, ELSET=S\n\n1.e-6\n*BOUNDARY\n4, 1, 3\n"
    loads = "*STEP\n*STATIC\n*CLOAD\n9, 1, 10.\n*NODE PRINT, NSET=ALL\nU, RF\n*END STEP\n"
    done = run_deck(f"{TRUSS}{side}*PRE-TENSION SECTION, ELEMENT=1, NODE=9\n{loads}")
    assert done.returncode == 0, done.stdout
    u, rf = rows_of(tmp_path), rows_of(tmp_path, "forces")
    assert u[9][0] == pytest.approx(10.0 * 10.0 / (1000.0 * 0.5), rel=DIGITS)
    assert rf[1][:2] == pytest.approx([-6.0, -8.0], rel=DIGITS)
    assert rf[3][:2] == pytest.approx([6.0, 8.0], rel=DIGITS)


@pytest.mark.parametrize(("deck", "message"), [
    (f"{TRUSS}*PRE-TENSION SECTION, NODE=9\n", "needs either SURFACE or ELEMENT"),
    (f"{TRUSS}*PRE-TENSION SECTION, NODE=9, ELEMENT=7\n", "must name one truss"),
    (f"{TRUSS}*PRE-TENSION SECTION, NODE=9, ELEMENT=ROD\n", "must name one truss"),
    (f"{CUBE}*PRE-TENSION SECTION, NODE=90, ELEMENT=1\n", "must name one truss"),
])
def test_refused_pretension(run_deck: Run, deck: str, message: str) -> None:
    """What cannot be cut."""
    done = run_deck(f"{deck}*STEP\n*STATIC\n*END STEP\n")
    assert done.returncode == 3
    assert message in done.stdout + done.stderr


def test_data_in_files(run_deck: Run, tmp_path: Path) -> None:
    """NODE, ELEMENT and EQUATION with INPUT read their rows from files; errors there name the file and its line."""
    (tmp_path / "nodes.txt").write_text("".join(line + "\n" for line in CUBE.splitlines()[1:9]))
    (tmp_path / "cells.txt").write_text("1, 1, 2, 3, 4,\n5, 6, 7, 8\n")
    (tmp_path / "sums.txt").write_text("2\n7, 3, 1., 5, 3, -1.\n")
    deck = "*NODE, NSET=ALL,\nINPUT=nodes.txt\n*ELEMENT, TYPE=C3D8, ELSET=E, INPUT=cells.txt\n*EQUATION, INPUT=sums.txt\n"
    deck += CUBE[CUBE.index("*NSET, NSET=BOTTOM"):] + "*BOUNDARY\nBOTTOM, 1, 3\n*STEP\n*STATIC\n*CLOAD\n5, 3, 10.\n"
    deck += "*NODE PRINT, NSET=ALL\nU\n*END STEP\n"
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    u = rows_of(tmp_path)
    assert u[5][2] == pytest.approx(u[7][2], rel=DIGITS) and u[5][2] > 0
    (tmp_path / "sums.txt").write_text("2\n7, 3, x, 5, 3, -1.\n")
    done = run_deck(deck)
    assert done.returncode == 3
    assert "sums.txt:2:" in done.stdout + done.stderr
    (tmp_path / "sums.txt").unlink()
    assert "cannot be read" in run_deck(deck).stdout


def test_include_in_a_circle(run_deck: Run, tmp_path: Path) -> None:
    """Two files that include each other."""
    (tmp_path / "a.inp").write_text("*INCLUDE, INPUT=b.inp\n")
    (tmp_path / "b.inp").write_text("*INCLUDE, INPUT=a.inp\n")
    done = run_deck(f"{CUBE}*INCLUDE, INPUT=a.inp\n*STEP\n*STATIC\n*END STEP\n")
    assert done.returncode == 3
    assert "includes itself" in done.stdout + done.stderr
