"""What later steps change of equations and hardening, and CalculiX's older coupling: springs and cubes with closed forms.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from verify.conftest import Run

DIGITS = 2e-6  # seven digits are printed

SPRINGS = """** dialect: calculix
*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 2., 0., 0.
4, 3., 0., 0.
*NSET, NSET=N
2, 3, 4
*ELEMENT, TYPE=SPRING1, ELSET=A
1, 2
*ELEMENT, TYPE=SPRING1, ELSET=B
2, 3
*SPRING, ELSET=A
1
100.
*SPRING, ELSET=B
1
300.
*BOUNDARY
1, 1, 3
N, 2, 3
"""
STEP = "*STEP\n*STATIC\n1., 1.\n{}*NODE PRINT, NSET=N\nU\n*END STEP\n"


def blocks(folder: Path) -> list[dict[int, float]]:
    """u_x by node, for each block of job.dat."""
    found: list[dict[int, float]] = []
    for line in (folder / "job.dat").read_text().splitlines():
        if "displacements" in line:
            found.append({})
        elif found and (words := line.split()) and words[0].isdigit():
            found[-1][int(words[0])] = float(words[1])
    return found


@pytest.mark.parametrize("removal", ["*EQUATION, REMOVE\n2, 1, 1\n", "*EQUATION, REMOVE\nN, 1, 3\n", "*EQUATION, REMOVE=ALL\n"])
def test_equation_removed(run_deck: Run, tmp_path: Path, removal: str) -> None:
    """Two springs that move as one, F/(k1 + k2), and then each alone; what is removed stays removed."""
    equation = "*EQUATION\n2\n2, 1, 1., 3, 1, -1.\n"
    deck = f"{SPRINGS}{equation}*BOUNDARY\n4, 1\n" + STEP.format("*CLOAD\n2, 1, 8.\n") + STEP.format(removal) + STEP.format("")
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    first, second, third = blocks(tmp_path)
    assert first[2] == pytest.approx(8.0 / 400.0, rel=DIGITS)
    assert first[3] == pytest.approx(8.0 / 400.0, rel=DIGITS)
    for block in (second, third):
        assert block[2] == pytest.approx(8.0 / 100.0, rel=DIGITS)
        assert abs(block[3]) < 1e-9


def test_equation_in_a_step(run_deck: Run) -> None:
    """A new one is refused there; removing nothing gives a message."""
    done = run_deck(SPRINGS + STEP.format("*EQUATION\n2\n2, 1, 1., 3, 1, -1.\n"))
    assert done.returncode == 3
    assert "must be before the first step" in re.sub(r"\s+", " ", done.stdout)
    done = run_deck(f"{SPRINGS}*BOUNDARY\n4, 1\n" + STEP.format("*EQUATION, REMOVE\n2, 1\n*CLOAD\n2, 1, 8.\n"))
    assert done.returncode == 0
    assert "none is removed" in re.sub(r"\s+", " ", done.stdout)


def test_distributing_coupling(run_deck: Run, tmp_path: Path) -> None:
    """A force F on the node spreads as w F / sum w; its displacement is the weighted mean."""
    coupling = "*ELEMENT, TYPE=DCOUP3D, ELSET=D\n9, 4\n*DISTRIBUTING COUPLING, ELSET=D\n2, 1.\n3, 3.\n"
    done = run_deck(SPRINGS.replace("N, 2, 3\n", "2, 2, 3\n3, 2, 3\n") + coupling + STEP.format("*CLOAD\n4, 1, 8.\n"))
    assert done.returncode == 0, done.stdout
    (u,) = blocks(tmp_path)
    assert u[2] == pytest.approx(2.0 / 100.0, rel=DIGITS)
    assert u[3] == pytest.approx(6.0 / 300.0, rel=DIGITS)
    assert u[4] == pytest.approx((u[2] + 3.0 * u[3]) / 4.0, rel=DIGITS)


@pytest.mark.parametrize(("coupling", "message"), [
    ("*DISTRIBUTING COUPLING, ELSET=A\n2, 1.\n", "must hold one element of type DCOUP3D"),
    ("*ELEMENT, TYPE=DCOUP3D, ELSET=D\n9, 4\n*DISTRIBUTING COUPLING, ELSET=D\n2, -1.\n", "must be positive"),
    ("*ELEMENT, TYPE=DCOUP3D, ELSET=D\n9, 4\n*DISTRIBUTING COUPLING, ELSET=D\n", "data are missing"),
])  # fmt: skip
def test_wrong_coupling(run_deck: Run, coupling: str, message: str) -> None:
    """The message."""
    done = run_deck(SPRINGS + coupling + STEP.format(""))
    assert done.returncode == 3
    assert message in re.sub(r"\s+", " ", done.stdout)


CUBE = """** dialect: calculix
*NODE, NSET=ALL
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
*NSET, NSET=N
2, 3, 6, 7
*ELEMENT, TYPE=C3D8, ELSET=E
1, 1, 2, 3, 4, 5, 6, 7, 8
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*PLASTIC
10., 0.
1010., 1.
*SOLID SECTION, ELSET=E, MATERIAL=M
*BOUNDARY
1, 1, 3
4, 1
4, 3
5, 1, 2
8, 1
"""


@pytest.mark.parametrize(("change", "expected"), [
    ("", 0.008),
    ("*CHANGE MATERIAL, NAME=M\n*CHANGE PLASTIC\n4., 0.\n1004., 1.\n", 0.008 + 4.0 / 1000.0),
])  # fmt: skip
def test_change_plastic(run_deck: Run, tmp_path: Path, change: str, expected: float) -> None:
    """Tension 5, then 8 with a curve that starts at 4 and rises by 1000: s/E + (s - 4)/1000."""
    deck = CUBE + STEP.format("*CLOAD\nN, 1, 1.25\n") + STEP.format(f"{change}*CLOAD\nN, 1, 2.\n")
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    first, second = blocks(tmp_path)
    assert first[2] == pytest.approx(0.005, rel=1e-4)  # Newton's tolerance of the calculix dialect
    assert second[2] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(("change", "message"), [
    ("*CHANGE MATERIAL, NAME=NONE\n*CHANGE PLASTIC\n4., 0.\n", "There is no material 'NONE'"),
    ("*CHANGE MATERIAL, NAME=M\n*CHANGE PLASTIC, HARDENING=KINEMATIC\n4., 0.\n", "has no *PLASTIC with this HARDENING"),
    ("*CHANGE PLASTIC\n4., 0.\n", "must be in the block of a *CHANGE MATERIAL"),
    ("*CHANGE MATERIAL, NAME=M\n*CHANGE PLASTIC\n4., 0.\n5., 0.\n", "plastic strains of a hardening curve must ascend"),
])  # fmt: skip
def test_wrong_change(run_deck: Run, change: str, message: str) -> None:
    """The message."""
    done = run_deck(CUBE + STEP.format(change))
    assert done.returncode == 3
    assert message in re.sub(r"\s+", " ", done.stdout)


def moved(velocity: str, period: float = 1.0, more: str = "") -> str:
    """A step of two increments that moves node 3 by a BOUNDARY card."""
    card = f"*BOUNDARY, {velocity}\n" if velocity else ""
    return f"*STEP\n*STATIC, DIRECT\n{period / 2}, {period}\n{card}{more}*NODE PRINT, NSET=N\nU\n*END STEP\n"


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
def test_prescribed_velocity(run_deck: Run, tmp_path: Path, nlgeom: str) -> None:
    """The displacement is the integral of the velocity over the steps, from where the node is; a displacement after it begins there."""
    tables = "*AMPLITUDE, NAME=RISE\n0., 0., 1., 2.\n*AMPLITUDE, NAME=SMOOTH, DEFINITION=SMOOTH STEP\n.5, 0., 1., 1.\n"
    tables += "*AMPLITUDE, NAME=TOTAL, TIME=TOTAL TIME\n0., 0., 7., 0., 9., 4.\n*AMPLITUDE, NAME=MAGNITUDE, VALUE=ABSOLUTE\n0., 3., 1., 1.\n"
    deck = SPRINGS.replace("calculix", "abaqus") + tables + "*BOUNDARY\n4, 1\n"
    deck += moved("TYPE=VELOCITY", 2.0, "3, 1, 1, .5\n") + moved("") + moved("TYPE=VELOCITY, AMPLITUDE=RISE", 1.0, "3, 1, 1, .4\n")
    deck += moved("TYPE=DISPLACEMENT", 1.0, "3, 1, 1, 1.\n") + moved("TYPE=VELOCITY", 1.0, "3, 1\n")
    deck += moved("TYPE=VELOCITY, AMPLITUDE=SMOOTH", 1.0, "3, 1, 1, 1.\n") + moved("TYPE=VELOCITY, AMPLITUDE=TOTAL", 2.0, "3, 1, 1, 1.\n")
    deck += moved("TYPE=VELOCITY, AMPLITUDE=MAGNITUDE, OP=NEW", 1.0, "3, 1, 1, 9.\n1, 1, 3\nN, 2, 3\n4, 1\n")
    done = run_deck(deck.replace("*STEP", f"*STEP{nlgeom}"))
    assert done.returncode == 0, done.stdout
    expected = [0.5, 1.0, 1.25, 1.5, 1.6, 1.9, 1.45, 1.0, 1.0, 1.0, 1.0, 1.25, 2.25, 5.25, 5.25 + 1.25, 5.25 + 2.0]
    assert [block[3] for block in blocks(tmp_path)] == pytest.approx(expected, rel=DIGITS)


@pytest.mark.parametrize(("card", "message"), [
    ("TYPE=VELOCITY, FIXED", "cannot be combined with FIXED or USER"), ("TYPE=VELOCITY, USER", "cannot be combined with FIXED or USER"),
    ("TYPE=VELOCITY, AMPLITUDE=P", "must be a table"), ("TYPE=ACCELERATION", "Prescribe displacements"),
])  # fmt: skip
def test_refused_velocity(run_deck: Run, card: str, message: str) -> None:
    """What has no integral is refused."""
    wave = "*AMPLITUDE, NAME=P, DEFINITION=PERIODIC\n1, 3., .2, .5\n1., 2.\n"
    done = run_deck(SPRINGS + wave + moved(card, 1.0, "3, 1, 1, .5\n4, 1\n"))
    assert done.returncode == 3
    assert message in re.sub(r"\s+", " ", done.stdout)
