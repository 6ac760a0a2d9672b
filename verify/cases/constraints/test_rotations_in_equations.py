"""EQUATION with rotations: nodes of shells and beams, reference nodes, drills, local directions, removal, refusals.

Strips and beams have nu = 0; Timoshenko's beam is the reference, with F L / (5/6 G A) for the shear.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from verify.cases.constraints.test_multipoint_constraints import Rows, read_rows
from verify.conftest import Run

E, L, WIDTH, THICK = 1000.0, 10.0, 4.0, 0.5
EI = E * WIDTH * THICK**3 / 12
SHEAR = L / (5 / 6 * E / 2 * WIDTH * THICK)  # deflection by a force of 1
FINE = 1e-3  # one S8R bends exactly; its shear strains of width and thickness are (h / L)^2 = 2.5e-3, in part in SHEAR
EXACT = 1e-5  # six digits are printed
DIALECTS = ["abaqus", "calculix"]


def strip(first: int, y: float) -> str:
    """The nodes of one S8R along x, clamped end first: 1 to 3 at the clamp, 6 to 8 at the tip."""
    places = [(x * L / 2, y + s * WIDTH / 2) for x, s in [(0, 0), (0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1), (2, 2)]]
    return "".join(f"{first + i}, {x}, {z}, 0.\n" for i, (x, z) in enumerate(places, 1))


def element(first: int) -> str:
    """Its element."""
    return ", ".join(str(first + i) for i in (0, 1, 6, 8, 3, 4, 7, 5, 2))


MATERIAL = f"*SHELL SECTION, ELSET=E, MATERIAL=M\n{THICK}\n*MATERIAL, NAME=M\n*ELASTIC\n{E}, 0.\n"
TWO = (f"*NODE, NSET=ALL\n{strip(0, 0.)}{strip(10, 20.)}*ELEMENT, TYPE=S8R, ELSET=E\n1, {element(0)[3:]}\n2, {element(10)[4:]}\n"
       f"*NSET, NSET=ROOT\n1, 2, 3, 11, 12, 13\n*NSET, NSET=TIP\n6, 7, 8\n*NSET, NSET=OTHER\n16, 17, 18\n{MATERIAL}")
PUSH = "*CLOAD\n6, 3, .25\n7, 3, .5\n8, 3, .25\n"  # one force, spread as the mean of the edge
PRINT = "*NODE PRINT, NSET=ALL\nU\n*END STEP\n"


def job(dialect: str, cards: str, loads: str, step: str = "*STEP\n*STATIC\n") -> str:
    """A deck."""
    return f"** dialect: {dialect}\n{cards}{step}{loads}{PRINT}"


def solved(run_deck: Run, folder: Path, deck: str) -> Rows:
    """The displacements at the end."""
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr
    return read_rows(folder, "displacements")


@pytest.mark.parametrize("dialect", DIALECTS)
def test_tips_of_two_strips_turn_alike(run_deck: Run, tmp_path: Path, dialect: str) -> None:
    """Moments M and -M with M L / EI = F L^2 / 2 EI - M L / EI make the rotations equal: deflections F L^3 (1/3 - 1/8) and 1/8 / EI."""
    rows = solved(run_deck, tmp_path, job(dialect, TWO + "*EQUATION\n2\nOTHER, 5, 1., TIP, 5, -1.\n", "*BOUNDARY\nROOT, 1, 6\n" + PUSH))
    whole = L**3 / EI
    for node in (6, 7, 8):
        assert rows[node][2] == pytest.approx(whole * (1 / 3 - 1 / 8) + SHEAR, rel=FINE)
        assert rows[node + 10][2] == pytest.approx(whole / 8, rel=FINE)


@pytest.mark.parametrize(("kind", "dialect"), [("B31", "abaqus"), ("B31", "calculix"), ("B32", "abaqus")])
def test_beams_turn_alike(run_deck: Run, tmp_path: Path, kind: str, dialect: str) -> None:
    """The same of two beams, with the factor -1: they turn against each other."""
    n = 20 if kind == "B31" else 2  # a moment acts on the corners of a cross-section, which a fine mesh of solids feels
    nodes = "".join(f"{first + i}, {i * L / n}, {first / 10}, 0.\n" for first in (0, 100) for i in range(n + 1) if first + i)
    nodes += "500, 0., 0., 0.\n"
    at = {0: 500}
    step = 1 if kind == "B31" else 2
    rows = "".join(f"{1 + first + i}, " + ", ".join(str(at.get(first + k, first + k)) for k in range(i, i + step + 1)) + "\n"
                   for first in (0, 100) for i in range(0, n, step))
    cards = (f"*NODE, NSET=ALL\n{nodes}*ELEMENT, TYPE={kind}, ELSET=E\n{rows}*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=RECT\n"
             f"1., 1.\n0., 1., 0.\n*MATERIAL, NAME=M\n*ELASTIC\n{E}, 0.\n*EQUATION\n2\n{100 + n}, 5, 1., {n}, 5, 1.\n")
    u = solved(run_deck, tmp_path, job(dialect, cards, f"*BOUNDARY\n500, 1, 6\n100, 1, 6\n*CLOAD\n{n}, 3, 1.\n"))
    whole = L**3 * 12 / E
    assert u[n][2] == pytest.approx(whole * (1 / 3 - 1 / 8) + L / (5 / 6 * E / 2), rel=0.02)  # (h / L)^2 is 0.01
    assert u[100 + n][2] == pytest.approx(-whole / 8, rel=0.01)


@pytest.mark.parametrize("dialect", DIALECTS)
def test_rotations_of_rigid_bodies(run_deck: Run, tmp_path: Path, dialect: str) -> None:
    """A strip whose clamp is a rigid body turned by 0.01 through an equation moves rigidly; the body at the tip weighs nothing."""
    cards = TWO + "*NODE, NSET=ALL\n50, 0., 1., 0.\n51, 100., 0., 0.\n*NSET, NSET=HEAD\n11, 12, 13\n*NSET, NSET=OWN\n1, 2, 3\n" \
        "*RIGID BODY, TIE NSET=OWN, REF NODE=50\n*RIGID BODY, TIE NSET=HEAD, REF NODE=51\n*EQUATION\n2\n50, 5, 1., 51, 5, -2.\n"
    loads = "*BOUNDARY\n50, 1, 4\n50, 6\n51, 1, 4\n51, 6\n51, 5, 5, .005\n"
    rows = solved(run_deck, tmp_path, job(dialect, cards, loads))
    assert rows[7][2] == pytest.approx(-0.01 * L, rel=EXACT)


def test_finite_rotation(run_deck: Run, tmp_path: Path) -> None:
    """A strip of ten S4 whose tip turns by 1 rad with a reference node under NLGEOM is an arc: x = L sin(1), z = L (1 - cos(1))."""
    n = 10
    nodes = "".join(f"{2 * i + j + 1}, {i * L / n}, {j * 1.0}, 0.\n" for i in range(n + 1) for j in (0, 1))
    elements = "".join(f"{i + 1}, {2 * i + 1}, {2 * i + 3}, {2 * i + 4}, {2 * i + 2}\n" for i in range(n))
    cards = (f"*NODE, NSET=ALL\n{nodes}90, 0., 9., 0.\n91, 0., 9., 1.\n*ELEMENT, TYPE=S4, ELSET=E\n{elements}{MATERIAL}*NSET, NSET=TIP\n"
             "21, 22\n*NSET, NSET=BODY\n91,\n*RIGID BODY, TIE NSET=BODY, REF NODE=90\n*EQUATION\n2\nTIP, 5, 1., 90, 5, 1.\n")
    loads = "*BOUNDARY\n1, 1, 6\n2, 1, 6\n90, 1, 4\n90, 6\n90, 5, 5, 1.\n"
    rows = solved(run_deck, tmp_path, job("abaqus", cards, loads, "*STEP, NLGEOM\n*STATIC\n0.1, 1., , 0.1\n"))
    for node in (21, 22):
        assert rows[node][0] == pytest.approx(L * math.sin(1) - L, rel=0.01)  # chords of ten elements: (1 / 10)^2 / 24, and their shear
        assert rows[node][2] == pytest.approx(L * (1 - math.cos(1)), rel=0.01)


@pytest.mark.parametrize("dialect", DIALECTS)
def test_all_six_join_two_strips(run_deck: Run, tmp_path: Path, dialect: str) -> None:
    """Two strips end to end, joined by equations of all six degrees of freedom, drills too, are one of length 2 L: F (2 L)^3 / 3 EI."""
    second = "".join(f"{10 + i}, {x + L}, {y}, 0.\n" for i, x, y in [(int(a), float(b), float(c)) for a, b, c, _ in
                     (line.split(",") for line in strip(0, 0.0).splitlines())])
    cards = TWO.replace(strip(10, 20.0), second).replace("1, 2, 3, 11, 12, 13", "1, 2, 3").replace("6, 7, 8\n*NSET, NSET=OTHER", "6, 7, 8\n*NSET, NSET=NEXT\n"
            "11, 12, 13\n*NSET, NSET=OTHER") + "*EQUATION\n" + "".join(f"2\nNEXT, {k}, 1., TIP, {k}, -1.\n" for k in range(1, 7))
    loads = "*BOUNDARY\nROOT, 1, 6\n" + PUSH.replace("\n6,", "\n16,").replace("\n7,", "\n17,").replace("\n8,", "\n18,")
    rows = solved(run_deck, tmp_path, job(dialect, cards, loads))
    assert rows[17][2] == pytest.approx((2 * L) ** 3 / (3 * EI) + 2 * SHEAR, rel=FINE)


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("equation", ["7, 6, 1., 17, 1, -1.", "17, 1, 1., 7, 6, -1."])
def test_a_drill_holds_nothing(run_deck: Run, tmp_path: Path, equation: str, dialect: str) -> None:
    """A strip is pulled by F = 6: the middle of its edge, tied to a drill of the other strip, moves as without the equation."""
    pull = job(dialect, TWO, "*BOUNDARY\nROOT, 1, 6\n*CLOAD\n16, 1, 1.\n17, 1, 4.\n18, 1, 1.\n")
    free = solved(run_deck, tmp_path, pull)
    assert free[17][0] == pytest.approx(6 * L / (E * WIDTH * THICK), rel=EXACT)
    rows = solved(run_deck, tmp_path, pull.replace("*STEP", f"*EQUATION\n2\n{equation}\n*STEP", 1).replace("ALL\nU", "ALL\nU, UR"))
    for node in (16, 17, 18):
        assert rows[node] == pytest.approx(free[node], rel=EXACT, abs=1e-9)


@pytest.mark.parametrize("dialect", DIALECTS)
def test_removed_in_a_step(run_deck: Run, tmp_path: Path, dialect: str) -> None:
    """Without the equation the loaded strip bends by F L^3 / 3 EI and the other is straight again."""
    cards = TWO + "*EQUATION\n2\nOTHER, 5, 1., TIP, 5, -1.\n"
    loads = f"*BOUNDARY\nROOT, 1, 6\n{PUSH}*END STEP\n*STEP\n*STATIC\n*EQUATION, REMOVE\nOTHER, 5\n"
    rows = solved(run_deck, tmp_path, job(dialect, cards, loads))
    assert rows[7][2] == pytest.approx(L**3 / (3 * EI) + SHEAR, rel=FINE)
    assert abs(rows[17][2]) < 1e-9 * L**3 / EI


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("body", ["", "*NSET, NSET=TIP2\n16, 17, 18\n*RIGID BODY, TIE NSET=TIP2, REF NODE=90\n"])
def test_local_directions(run_deck: Run, tmp_path: Path, dialect: str, body: str) -> None:
    """With local x along global y the rotation 4 is that about y, at nodes of shells and at a reference node, for supports too."""
    cards = f"{TWO}*NODE, NSET=ALL\n90, {L}, 22., 0.\n{body}*NSET, NSET=LOCAL\n90, OTHER\n*TRANSFORM, NSET=LOCAL\n0., 1., 0., -1., 0., 0.\n"
    equation = "*EQUATION\n2\nTIP, 5, 1., 90, 4, -1.\n" if body else "*EQUATION\n2\nTIP, 5, 1., OTHER, 4, -1.\n"
    rows = solved(run_deck, tmp_path, job(dialect, cards + equation, "*BOUNDARY\nROOT, 1, 6\n" + PUSH))
    assert rows[17][2] == pytest.approx(L**3 / EI / 8, rel=FINE)
    held = solved(run_deck, tmp_path, job(dialect, cards, f"*BOUNDARY\nROOT, 1, 6\n{'90' if body else 'OTHER'}, 4, 4, -.02\n"))
    assert held[17][2] == pytest.approx(0.01 * L, rel=FINE)  # an arc: w = t L / 2


@pytest.mark.parametrize("dialect", DIALECTS)
def test_an_equation_holds_a_hinge(run_deck: Run, tmp_path: Path, dialect: str) -> None:
    """A strip on hinges can turn, which the check of the model says; with the rotation of the hinge tied to the clamped strip it bends."""
    loads = "*BOUNDARY\n1, 1, 3\n2, 1, 3\n3, 1, 3\n11, 1, 6\n12, 1, 6\n13, 1, 6\n" + PUSH
    free = run_deck(job(dialect, TWO, loads))
    assert free.returncode == 4 and "turn about" in free.stdout
    rows = solved(run_deck, tmp_path, job(dialect, TWO + "*EQUATION\n2\n1, 5, 1., 11, 5, -1.\n2\n2, 5, 1., 12, 5, -1.\n2\n3, 5, 1., 13, 5, -1.\n", loads))
    assert rows[7][2] == pytest.approx(L**3 / (3 * EI) + SHEAR, rel=FINE)


CUBE = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n*ELEMENT, TYPE=C3D8, ELSET=C\n9,1,2,3,4,5,6,7,8\n" \
    "*SOLID SECTION, ELSET=C, MATERIAL=M\n*MATERIAL, NAME=M\n*ELASTIC\n1., 0.\n"


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize(("equation", "message"), [
    ("2\n5, 4, 1., 6, 4, -1.\n", "The node 5 has no rotation, which the degree of freedom 4 is"),
    ("2\n5, 1, 1., 6, 6, -1.\n", "The node 6 has no rotation, which the degree of freedom 6 is"),
    ("2\n5, 7, 1., 6, 7, -1.\n", "The degree of freedom must be 1 to 3, or 4 to 6 at nodes that have rotations"),
])
def test_refused(run_deck: Run, equation: str, message: str, dialect: str) -> None:
    """A node of a solid has none."""
    done = run_deck(job(dialect, f"{CUBE}*EQUATION\n{equation}", "*BOUNDARY\n1, 1, 3\n").replace("NSET=ALL", "NSET=X"))
    assert done.returncode == 3
    assert message in " ".join(done.stdout.split()), done.stdout
