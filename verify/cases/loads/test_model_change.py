"""What steps change of the model, against closed forms: elements taken out and put back, other materials.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from verify.conftest import Run

YOUNG = 1000.0
DIGITS = 2e-6  # seven digits are printed
TIGHT = "*CONTROLS, PARAMETERS=FIELD\n1e-10, 1e-10, , , 1e-10\n"

Rows = dict[tuple[int, ...], list[float]]

COLUMNS = """*NODE, NSET=ALL
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
9, 0, 0, 2
10, 1, 0, 2
11, 1, 1, 2
12, 0, 1, 2
*ELEMENT, TYPE=C3D8, ELSET=BOTH
1, 1, 2, 3, 4, 5, 6, 7, 8
2, 5, 6, 7, 8, 9, 10, 11, 12
*ELSET, ELSET=LOWER
1
*ELSET, ELSET=UPPER
2
*NSET, NSET=FLOOR
1, 2, 3, 4
*NSET, NSET=MIDDLE
5, 6, 7, 8
*NSET, NSET=LID
9, 10, 11, 12
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*MATERIAL, NAME=SOFT
*ELASTIC
250., 0.
*SOLID SECTION, ELSET=BOTH, MATERIAL=M
*BOUNDARY
FLOOR, 1, 3
ALL, 1, 2
"""
PRINT = "*NODE PRINT, NSET=ALL\nU, RF\n*EL PRINT, ELSET=BOTH\nS\n"


def read_blocks(folder: Path, title: str) -> list[Rows]:
    """The blocks of a title in job.dat, in their order."""
    blocks: list[Rows] = []
    is_inside = False
    for line in (folder / "job.dat").read_text().splitlines():
        if " for set " in line:
            is_inside = line.strip().startswith(title)
            if is_inside:
                blocks.append({})
        elif is_inside and (words := line.split()) and words[0].isdigit():
            n = 2 if title == "stresses" else 1
            blocks[-1][tuple(map(int, words[:n]))] = [float(word) for word in words[n:]]
    return blocks


def steps(*loads: str, nlgeom: bool = False) -> str:
    """A deck of two cubes on each other, and some steps."""
    head = "*STEP, NLGEOM\n*STATIC\n" if nlgeom else "*STEP\n*STATIC\n"
    return COLUMNS + "".join(f"{head}{TIGHT if i == 0 else ''}{load}{PRINT}*END STEP\n" for i, load in enumerate(loads))


OUT = "*MODEL CHANGE, TYPE=ELEMENT, REMOVE\n2\n"
BACK = "*MODEL CHANGE, TYPE=ELEMENT, ADD{}\nUPPER\n"


@pytest.mark.parametrize("nlgeom", [False, True])
def test_element_comes_back_free_of_strain(run_deck: Run, tmp_path: Path, nlgeom: bool) -> None:
    """The upper cube is stretched, taken out, and put back where its nodes are: no stress until it is stretched again."""
    deck = steps(
        "*BOUNDARY\nLID, 3, 3, .02\n",
        OUT,
        BACK.format(""),
        "*BOUNDARY\nLID, 3, 3, .03\n",
        nlgeom=nlgeom,
    )
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    stresses, u = read_blocks(tmp_path, "stresses"), read_blocks(tmp_path, "displacements")
    assert [len(rows) for rows in stresses] == [16, 8, 16, 16]
    assert u[1][(5,)][2] == pytest.approx(0.0, abs=1e-9), "the lower cube springs back when the upper one is gone"
    assert u[1][(9,)][2] == pytest.approx(0.02, rel=DIGITS), "a support holds without an element too"
    assert max(abs(s) for row in stresses[2].values() for s in row) < 1e-9 * YOUNG
    # The new cube is 1.02 long; both stretch by 0.01 together, the springs 1000 / 1 and 1000 / 1.02 in series.
    if not nlgeom:
        middle = 0.01 * (1 / 1.02) / (1 + 1 / 1.02)
        assert u[3][(5,)][2] == pytest.approx(middle, rel=DIGITS)
        assert stresses[3][(2, 1)][2] == pytest.approx(YOUNG * middle, rel=DIGITS)
        assert stresses[3][(1, 1)][2] == pytest.approx(YOUNG * middle, rel=DIGITS)


def test_element_comes_back_with_strain(run_deck: Run, tmp_path: Path) -> None:
    """ADD=WITH STRAIN counts strain from the start of the job: the stress of the first step is there again."""
    done = run_deck(steps("*BOUNDARY\nLID, 3, 3, .02\n", OUT, BACK.format("=WITH STRAIN")))
    assert done.returncode == 0, done.stdout
    stresses = read_blocks(tmp_path, "stresses")
    assert stresses[2][(2, 1)][2] == pytest.approx(stresses[0][(2, 1)][2], rel=DIGITS)
    assert stresses[0][(2, 1)][2] == pytest.approx(YOUNG * 0.01, rel=DIGITS)


def test_absent_from_the_first_step(run_deck: Run, tmp_path: Path) -> None:
    """A body that is built in layers: the upper one comes when the lower is compressed already, its weight only then."""
    deck = steps(
        "*MODEL CHANGE, TYPE=ELEMENT, REMOVE\nUPPER\n*CLOAD\nMIDDLE, 3, -2.5\n",
        BACK.format("") + "*CLOAD\nLID, 3, -2.5\n",
    )
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    u, stresses = read_blocks(tmp_path, "displacements"), read_blocks(tmp_path, "stresses")
    assert u[0][(5,)][2] == pytest.approx(-0.01, rel=DIGITS)
    assert u[0][(9,)][2] == 0.0, "a node without elements stays where it is"
    assert stresses[1][(2, 1)][2] == pytest.approx(-10.0, rel=DIGITS)
    assert stresses[1][(1, 1)][2] == pytest.approx(-20.0, rel=DIGITS)
    length = 1.01                                # of the upper cube when it comes
    assert u[1][(9,)][2] == pytest.approx(-0.02 + 0.01 - 10.0 / YOUNG * length, rel=DIGITS)


def test_resumed_job_knows_where_elements_were_born(run: Run, tmp_path: Path) -> None:
    """A job that resumes after a checkpoint gives the same as one that ran through."""
    deck = steps("*BOUNDARY\nLID, 3, 3, .02\n", OUT, BACK.format(""), "*BOUNDARY\nLID, 3, 3, .03\n", nlgeom=True)
    (tmp_path / "job.inp").write_text(deck)
    assert run(["job"], cwd=tmp_path).returncode == 0
    whole = read_blocks(tmp_path, "stresses")[-1]
    # The same deck stops in its last step, which needs more increments than allowed.
    short = deck.replace("*STEP, NLGEOM\n*STATIC\n*BOUNDARY\nLID, 3, 3, .03\n",
                         "*STEP, NLGEOM, INC=1\n*STATIC\n.5, 1.\n*BOUNDARY\nLID, 3, 3, .03\n")
    assert short != deck
    (tmp_path / "job.inp").write_text(short)
    assert run(["job"], cwd=tmp_path).returncode == 5
    resumed = run(["--resume", "job"], cwd=tmp_path)
    assert resumed.returncode == 0, resumed.stdout
    end = read_blocks(tmp_path, "stresses")[-1]
    assert end.keys() == whole.keys()
    for key, row in whole.items():
        assert end[key] == pytest.approx(row, rel=DIGITS, abs=1e-9 * YOUNG)


def test_changed_material(run_deck: Run, tmp_path: Path) -> None:
    """The upper cube becomes four times as soft: springs in series."""
    done = run_deck(steps("*CLOAD\nLID, 3, 2.5\n", "*CHANGE SOLID SECTION, ELSET=UPPER, MATERIAL=SOFT\n", ""))
    assert done.returncode == 0, done.stdout
    u = read_blocks(tmp_path, "displacements")
    assert u[0][(9,)][2] == pytest.approx(10 / YOUNG + 10 / YOUNG, rel=DIGITS)
    for later in u[1:]:
        assert later[(5,)][2] == pytest.approx(10 / YOUNG, rel=DIGITS)
        assert later[(9,)][2] == pytest.approx(10 / YOUNG + 10 / (YOUNG / 4), rel=DIGITS)


RELIEF = "*MODEL CHANGE, TYPE=ELEMENT, MECHSTRAINTORESIDUAL\nBOTH\n"


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("kind", ["C3D8", "C3D8I", "C3D8R"])
def test_stress_goes_and_strain_stays(run_deck: Run, tmp_path: Path, kind: str, nlgeom: bool) -> None:
    """MECHSTRAINTORESIDUAL: the stretch e_1 of the first step has no stress any more; then S = E (strain - strain_1), Green's
    strain under NLGEOM (as CalculiX, whose stresses are these: verify/peers), and the warmth of the first step stays a strain."""
    deck = steps("*BOUNDARY\nLID, 3, 3, .04\n*TEMPERATURE\nALL, 50.\n", RELIEF, "*BOUNDARY\nLID, 3, 3, .06\n", nlgeom=nlgeom)
    deck = deck.replace("TYPE=C3D8,", f"TYPE={kind},").replace("*MATERIAL, NAME=SOFT", "*EXPANSION\n1e-5\n*MATERIAL, NAME=SOFT")
    done = run_deck("** dialect: calculix\n" + deck.replace("*SOLID SECTION", "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 0.\n*SOLID SECTION"))
    assert done.returncode == 0, done.stdout + done.stderr
    stresses = read_blocks(tmp_path, "stresses")
    first, warm = 0.02, 1e-5 * 50
    assert stresses[1][(1, 1)][2] == pytest.approx(0.0, abs=1e-8 * YOUNG)
    if nlgeom:
        strain = [((1 + e) ** 2 - 1) / 2 for e in (first, 0.03)]
        before, after = YOUNG * (strain[0] - (warm + warm**2 / 2)), YOUNG * (strain[1] - strain[0])
        assert stresses[0][(1, 1)][2] == pytest.approx(before * (1 + first), rel=3 * warm), "a volume swollen by 3 a T"
        assert stresses[2][(1, 1)][2] == pytest.approx(after * 1.03, rel=3 * warm)
    else:
        assert stresses[0][(1, 1)][2] == pytest.approx(YOUNG * (first - warm), rel=DIGITS)
        assert stresses[2][(1, 1)][2] == pytest.approx(YOUNG * 0.01, rel=DIGITS)


@pytest.mark.parametrize(("deck", "message"), [
    (steps("", RELIEF), "is a parameter of CalculiX"),
    ("** dialect: calculix\n" + steps("", RELIEF).replace("*MATERIAL, NAME=SOFT", "*PLASTIC\n9., 0.\n*MATERIAL, NAME=SOFT"), "*ELASTIC alone"),
    ("** dialect: calculix\n" + steps("", RELIEF.replace("BOTH\n", "")), "needs data lines"),
    ("** dialect: calculix\n" + "*STEP, NLGEOM".join(steps("", RELIEF).rsplit("*STEP", 1)), "the step before must have NLGEOM"),
])  # fmt: skip
def test_refused_relief(run_deck: Run, deck: str, message: str) -> None:
    """Where the strain cannot be kept without stress."""
    done = run_deck(deck)
    assert done.returncode == 3, done.stdout
    assert message in re.sub(r"\s+", " ", done.stdout + done.stderr)


@pytest.mark.parametrize(("card", "message"), [
    ("*MODEL CHANGE, TYPE=ELEMENT\n2\n", "either ADD or REMOVE"),
    ("*MODEL CHANGE, TYPE=ELEMENT, REMOVE\n", "needs data lines"),
    ("*MODEL CHANGE, TYPE=ELEMENT, REMOVE\nNOWHERE\n", "There is no element or element set 'NOWHERE'"),
    ("*MODEL CHANGE, TYPE=ELEMENT, REMOVE\nBOTH\n", "No element is left"),
    ("*MODEL CHANGE, TYPE=ELEMENT, ADD=HALF\n2\n", "not known"),
    ("*CHANGE SOLID SECTION, ELSET=UPPER\n", "needs the parameter MATERIAL"),
    ("*CHANGE SOLID SECTION, ELSET=UPPER, MATERIAL=GOLD\n", "There is no material 'GOLD'"),
    ("*CHANGE SOLID SECTION, ELSET=NOWHERE, MATERIAL=M\n", "There is no element set 'NOWHERE'"),
    ("*CHANGE SOLID SECTION, ELSET=UPPER, MATERIAL=M, ORIENTATION=O\n", "The axes stay"),
])
def test_refused_changes(run_deck: Run, card: str, message: str) -> None:
    """Invalid cards."""
    done = run_deck(steps(card))
    assert done.returncode == 3, done.stdout
    assert message in re.sub(r"\s+", " ", done.stdout + done.stderr)


def test_needless_changes_are_reported(run_deck: Run) -> None:
    """Elements that are there already."""
    done = run_deck(steps("*BOUNDARY\nLID, 3, 3, .02\n" + BACK.format("")))
    assert done.returncode == 0
    assert "had not been taken out" in done.stdout + done.stderr


@pytest.mark.parametrize("threads", [1, 2])
def test_many_elements(run_deck: Run, tmp_path: Path, threads: int) -> None:
    """A tower of eight cubes, which are computed together, loses its upper half and gets it back: springs in series again."""
    nodes = [(x, y, z) for z in range(9) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    deck = "*NODE, NSET=ALL\n" + "".join(f"{i}, {x}, {y}, {z}\n" for i, (x, y, z) in enumerate(nodes, 1))
    deck += "*ELEMENT, TYPE=C3D8, ELSET=BOTH\n" + "".join(
        f"{e + 1}, " + ", ".join(str(4 * e + k) for k in range(1, 9)) + "\n" for e in range(8))
    deck += "*ELSET, ELSET=UPPER, GENERATE\n5, 8\n*NSET, NSET=FLOOR\n1, 2, 3, 4\n*NSET, NSET=LID\n33, 34, 35, 36\n"
    deck += COLUMNS[COLUMNS.index("*MATERIAL"):]
    for load in ("*BOUNDARY\nLID, 3, 3, .08\n", OUT.replace("\n2\n", "\nUPPER\n"), BACK.format(""), "*BOUNDARY\nLID, 3, 3, .16\n"):
        deck += f"*STEP\n*STATIC\n{load}{PRINT}*END STEP\n"
    done = run_deck(deck, "--threads", str(threads), threads=threads)
    assert done.returncode == 0, done.stdout
    stresses, u = read_blocks(tmp_path, "stresses"), read_blocks(tmp_path, "displacements")
    assert [len(rows) for rows in stresses] == [64, 32, 64, 64]
    assert u[1][(17,)][2] == pytest.approx(0.0, abs=1e-9)
    assert max(abs(s) for row in stresses[2].values() for s in row) < 1e-9 * YOUNG
    # The new upper half is 4.08 long, the lower one 4.
    assert u[3][(17,)][2] == pytest.approx(0.08 * 4 / 8.08, rel=DIGITS)
    assert all(row[2] == pytest.approx(YOUNG * 0.08 / 8.08, rel=DIGITS) for row in stresses[3].values())
