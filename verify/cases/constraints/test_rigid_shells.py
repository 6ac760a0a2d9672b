"""Rigid bodies of nodes of shells and beams: clamped with their rotations, hinged in the calculix dialect, and moments that turn nothing.

Strips have nu = 0; Timoshenko's beam is the reference.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import pytest

from verify.cases.constraints.test_multipoint_constraints import read_rows
from verify.conftest import Run
from verify.decks.shells import held, section, shell

E, LENGTH, WIDTH, THICK, ARM, FORCE = 1.2e5, 10.0, 4.0, 0.4, 2.0, 3.0
EI = E * WIDTH * THICK**3 / 12
SHEAR = LENGTH / (5 / 6 * E / 2 * WIDTH * THICK)  # deflection by a force of 1


def strip(kind: str, card: str, x: float, step: str, support: str = "") -> str:
    """A clamped strip whose tip belongs to a rigid body with a reference node at x; n elements along it."""
    body = shell(kind, (8, 2), lambda u, v: (LENGTH * u, WIDTH * v, 0 * u))
    rows = "".join(f"{i + 1},\n" for i in body.where(0, 1.0))
    bound = "*MPC\nBEAM, R, REF\n" if card == "MPC" else f"*RIGID BODY, {card}=R, REF NODE=9001\n"
    return (f"{body.cards()}{section(E, 0.0, THICK)}*NODE, NSET=REF\n9001, {x}, 2., 0.\n*NSET, NSET=R\n{rows}{bound}"
            f"{held(body.where(0, 0.0), '1, 6')}{support}*STEP\n*STATIC\n*CLOAD\n{step}*NODE PRINT, NSET=REF\nU, UR\n*END STEP\n")


@pytest.mark.parametrize(("dialect", "card"), [("abaqus", "NSET"), ("abaqus", "TIE NSET"), ("abaqus", "MPC"), ("calculix", "TIE NSET")])
@pytest.mark.parametrize("kind", ["S4", "S8R"])
def test_rigid_end_turns_the_strip(run_deck: Run, tmp_path: Path, kind: str, dialect: str, card: str) -> None:
    """A force on an arm a at the rigid end: u = F (L^3/3 + a L^2 + a^2 L)/EI + F L/GA', turned by F (L^2/2 + a L)/EI."""
    done = run_deck(f"** dialect: {dialect}\n" + strip(kind, card, LENGTH + ARM, f"9001, 3, {FORCE}\n"))
    assert done.returncode == 0, done.stdout + done.stderr
    u = read_rows(tmp_path, "displacements")[9001]
    deflection = FORCE * ((LENGTH**3 / 3 + ARM * LENGTH**2 + ARM**2 * LENGTH) / EI + SHEAR)
    assert u[2] == pytest.approx(deflection, rel=3e-3)  # eight bilinear elements: their bending errs by (h/L)^2/4
    ur = read_rows(tmp_path, "rotations")[9001]
    assert ur[1] == pytest.approx(-FORCE * (LENGTH**2 / 2 + ARM * LENGTH) / EI, rel=3e-3)


@pytest.mark.parametrize(("kind", "card", "gap"), [("S4", "BEAM", 0.5), ("S8R", "BEAM", 0.5), ("S4R", "TIE", 0.0)])
def test_pairs_of_nodes_of_two_strips(run_deck: Run, tmp_path: Path, kind: str, card: str, gap: float) -> None:
    """Two strips in line, node to node by rigid links or tied where they meet, with a force at the tip: bending goes across.
    u = F ((L1 + a + L2)^3 - (a + L2)^3 + L2^3)/3 EI + F (L1 + L2)/GA'."""
    first = shell(kind, (8, 2), lambda u, v: (LENGTH * u, WIDTH * v, 0 * u))
    second = shell(kind, (4, 2), lambda u, v: (LENGTH + gap + 0.5 * LENGTH * u, WIDTH * v, 0 * u))
    n, m = 1000, 500                                                  # added to the labels of the second strip
    lines, is_element = [], False
    for line in second.cards().splitlines():
        is_element = is_element or line.upper().startswith("*ELEMENT")
        words = line.split(",")
        if not line.startswith("*"):
            words = [str(int(w) + (m if is_element and i == 0 else n)) if is_element or i == 0 else w for i, w in enumerate(words)]
        lines.append(",".join(words))
    pairs = "".join(f"{card}, {j + 1 + n}, {i + 1}\n" for i, j in zip(first.where(0, 1.0), second.where(0, 0.0), strict=True))
    tip = second.where(0, 1.0)
    loads = "".join(f"{j + 1 + n}, 3, {FORCE / len(tip)}\n" for j in tip)
    done = run_deck(f"** dialect: abaqus\n{first.cards()}" + "\n".join(lines) + f"\n{section(E, 0.0, THICK)}*MPC\n{pairs}"
                    f"{held(first.where(0, 0.0), '1, 6')}*NSET, NSET=TIP\n{tip[0] + 1 + n}\n"
                    f"*STEP\n*STATIC\n*CLOAD\n{loads}*NODE PRINT, NSET=TIP\nU\n*END STEP\n")  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    rest = gap + 0.5 * LENGTH
    deflection = FORCE * (((LENGTH + rest)**3 - rest**3 + (0.5 * LENGTH)**3) / (3 * EI) + 1.5 * SHEAR)
    assert read_rows(tmp_path, "displacements")[tip[0] + 1 + n][2] == pytest.approx(deflection, rel=5e-3)


def test_edge_is_a_hinge_in_the_calculix_dialect(run_deck: Run, tmp_path: Path) -> None:
    """NSET binds displacements there: with a held rotation the tip still turns, u = F L^3/3 EI + F L/GA', not F L^3/12 EI; a note says so."""
    done = run_deck("** dialect: calculix\n" + strip("S8R", "NSET", LENGTH + ARM, f"9001, 3, {FORCE}\n", "*BOUNDARY\n9001, 4, 6\n"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "nodes on one line are a hinge. TIE NSET binds both" in done.stdout
    assert read_rows(tmp_path, "displacements")[9001][2] == pytest.approx(FORCE * (LENGTH**3 / 3 / EI + SHEAR), rel=3e-3)


@pytest.mark.parametrize(("card", "code"), [("NSET", 4), ("TIE NSET", 0)])
def test_moment_about_the_line_of_a_hinge(run_deck: Run, card: str, code: int) -> None:
    """A moment about the edge turns nothing: an error. About another axis, or with rotations, it turns the strip."""
    done = run_deck("** dialect: calculix\n" + strip("S4", card, LENGTH, "9001, 5, 1.\n"))
    assert done.returncode == code, done.stdout + done.stderr
    assert code == 0 or "a moment on the node 9001 acts about the line on which all nodes of its *RIGID BODY" in done.stdout + done.stderr
    assert run_deck("** dialect: calculix\n" + strip("S4", card, LENGTH, "9001, 4, 1.\n")).returncode == 0
    assert run_deck("** dialect: calculix\n" + strip("S4", card, LENGTH, "9001, 5, 1.\n", "*BOUNDARY\n9001, 5\n")).returncode == 0


def test_moment_about_an_edge_of_a_solid(run_deck: Run) -> None:
    """The same at an edge of a brick that lies obliquely."""
    deck = ("*NODE, NSET=ALL\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 1., 1., 0.\n4, 0., 1., 0.\n5, 1., 0., 1.\n6, 2., 0., 1.\n7, 2., 1., 1.\n8, 1., 1., 1.\n"
            "*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*MATERIAL, NAME=M\n*ELASTIC\n100., .3\n*SOLID SECTION, ELSET=E, MATERIAL=M\n"
            "*NODE\n9, 1.5, 0., .5\n*NSET, NSET=R\n2, 6\n*RIGID BODY, NSET=R, REF NODE=9\n*BOUNDARY\n1, 1, 3\n4, 1, 3\n5, 1, 3\n8, 1, 3\n"
            "*STEP\n*STATIC\n*CLOAD\n9, 4, {}\n9, 6, 1.\n*END STEP\n")
    done = run_deck(deck.format(1.0))
    assert done.returncode == 4
    assert "about the line on which all nodes of its *RIGID BODY" in done.stdout + done.stderr
    assert run_deck(deck.format(-1.0)).returncode == 0
