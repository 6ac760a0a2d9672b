"""Constraints against closed forms: nodes without elements, transforms, rigid bodies, couplings, ties, pre-tension, MPCs.

Where the answer is in the space of the shape functions the tolerance is that of the solver. Non-linear constraints
must converge quadratically: the tests allow few iterations for large rotations.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.make_decks import block, join
from verify.decks.solids import FACES, Solids, as_kind, node_set, unit_cube
from verify.readers.sta_cvg_files import read_cvg, read_sta

YOUNG, NU = 1000.0, 0.25
TOLERANCE = 1e-6  # of the largest value: six digits are printed

CUBE = unit_cube(low="BOTTOM", high="TOP") + """*SURFACE, NAME=UP
1, S2
"""
MATERIAL = f"*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, {NU}\n*SOLID SECTION, ELSET=E, MATERIAL=M\n"
TIGHT = "*CONTROLS, PARAMETERS=FIELD\n1e-10, 1e-10, , , 1e-10\n"
PRINT = "*NODE PRINT, NSET=SHOWN\nU, RF\n"

Rows = dict[int, list[float]]


def job(cards: str, loads: str, step: str = "*STEP\n*STATIC\n", shown: str = "ALL") -> str:
    """A deck of one cube, more model cards, and one step."""
    return f"{CUBE}{cards}*NSET, NSET=SHOWN\n{shown}\n{MATERIAL}{step}{TIGHT}{loads}{PRINT}*END STEP\n"


def read_rows(folder: Path, title: str) -> Rows:
    """The rows of the last block of a title in job.dat, by node."""
    rows: Rows = {}
    is_inside = False
    for line in (folder / "job.dat").read_text().splitlines():
        if " for set " in line:
            is_inside = line.strip().startswith(title)
            rows = {} if is_inside else rows
        elif is_inside and re.match(r" +\d", line) and (words := line.split()):
            rows[int(words[0])] = [float(word) for word in words[1:]]
    return rows


def iterations(folder: Path) -> int:
    """Newton iterations of all attempts."""
    return sum(attempt.iterations for attempt in read_sta(folder / "job.sta"))


def check(rows: Rows, node: int, wanted: list[float], scale: float, what: str) -> None:
    """Compares one row."""
    for k, (value, expected) in enumerate(zip(rows[node], wanted, strict=True)):
        assert abs(value - expected) <= TOLERANCE * scale, f"{what} of node {node}, component {k + 1}: {value}, not {expected}"


def test_spare_nodes(run_deck: Run, tmp_path: Path) -> None:
    """Nodes without elements that nothing names are held, and do not make the stiffness singular."""
    done = run_deck(job("*NODE, NSET=ALL\n90, 5, 5, 5\n", "*BOUNDARY\nBOTTOM, 1, 3\nTOP, 3, 3, .01\n"))
    assert done.returncode == 0, done.stdout + done.stderr
    rows = read_rows(tmp_path, "displacements")
    check(rows, 90, [0, 0, 0], 1.0, "displacement")
    assert rows[5][2] == pytest.approx(0.01)


def test_named_directions_of_a_spare_node(run_deck: Run, tmp_path: Path) -> None:
    """Of a node in an equation only the direction that it names moves; the others are held."""
    cards = "*NODE, NSET=ALL\n90, 5, 5, 5\n*EQUATION\n2\nTOP, 3, 1., 90, 1, -1.\n"
    done = run_deck(job(cards, "*BOUNDARY\n1, 1, 3\n2, 2, 3\n3, 3\n4, 3\n*CLOAD\n90, 1, 20.\n"))
    assert done.returncode == 0, done.stdout + done.stderr
    rows = read_rows(tmp_path, "displacements")
    check(rows, 90, [20.0 / YOUNG, 0, 0], 0.02, "displacement")
    check(rows, 7, [-NU * 0.02, -NU * 0.02, 0.02], 0.02, "displacement")


@pytest.mark.parametrize("kind", ["R", "C"])
def test_skew_support(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """A cube on a skew plane: directions by TRANSFORM, the force normal to it, the reaction too."""
    c = s = math.sqrt(0.5)
    points = f"0, {c}, {s}, 0, {-s}, {c}" if kind == "R" else "5, 0, 0, 6, 0, 0"
    cards = f"*TRANSFORM, NSET=ONE, TYPE={kind}\n{points}\n*NSET, NSET=ONE\n7\n"
    loads = "*BOUNDARY\nBOTTOM, 1, 3\n7, 1, 1, .01\n"
    done = run_deck(job(cards, loads))
    assert done.returncode == 0, done.stdout + done.stderr
    u = read_rows(tmp_path, "displacements")[7]
    assert u[1] * c + u[2] * s == pytest.approx(0.01, rel=1e-6)
    done = run_deck(job(cards, loads).replace("*NODE PRINT, NSET=SHOWN", "*NODE PRINT, NSET=SHOWN, GLOBAL=NO"))
    local = read_rows(tmp_path, "forces")[7]
    assert read_rows(tmp_path, "displacements")[7][0] == pytest.approx(0.01, rel=1e-6)
    assert local[0] > 0 and local[1] == pytest.approx(0, abs=1e-9) and local[2] == pytest.approx(0, abs=1e-9)
    done = run_deck(job(cards, loads))
    rf = read_rows(tmp_path, "forces")[7]
    assert rf[0] == pytest.approx(0, abs=1e-9) and rf[1] == pytest.approx(rf[2], rel=1e-6) and rf[1] > 0


@pytest.mark.parametrize("rotation_node", [True, False])
def test_rigid_body_turns(run_deck: Run, tmp_path: Path, rotation_node: bool) -> None:
    """A cube whose nodes are all of a rigid body, turned by 2 rad about a skew axis in one increment: no strain."""
    angle, axis = 2.0, [2 / 3, -1 / 3, 2 / 3]
    w = [angle * a for a in axis]
    nodes = "*NODE, NSET=ALL\n90, 2, 0, 0\n" + ("91, 2, 0, 0\n" if rotation_node else "")
    cards = nodes + "*NSET, NSET=BODY\n1, 2, 3, 4, 5, 6, 7, 8\n*RIGID BODY, NSET=BODY, REF NODE=90"
    cards += ", ROT NODE=91\n" if rotation_node else "\n"
    loads = "*BOUNDARY\n90, 1, 3\n" + "".join(
        f"91, {k}, {k}, {w[k - 1]:.15g}\n" if rotation_node else f"90, {k + 3}, {k + 3}, {w[k - 1]:.15g}\n" for k in (1, 2, 3)
    )
    done = run_deck(job(cards, loads, "*STEP, NLGEOM\n*STATIC\n"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert iterations(tmp_path) <= 3
    x = [-1.0, 1.0, 1.0]  # node 8 from the reference node is (-2, 1, 1), node 7 (-1, 1, 1)
    dot = sum(a * b for a, b in zip(axis, x, strict=True))
    cross = [axis[1] * x[2] - axis[2] * x[1], axis[2] * x[0] - axis[0] * x[2], axis[0] * x[1] - axis[1] * x[0]]
    turned = [x[k] * math.cos(angle) + cross[k] * math.sin(angle) + axis[k] * dot * (1 - math.cos(angle)) for k in range(3)]
    check(read_rows(tmp_path, "displacements"), 7, [turned[k] - x[k] for k in range(3)], 1.0, "displacement")


def test_rigid_body_in_equilibrium(run_deck: Run, tmp_path: Path) -> None:
    """A cube clamped below, its top a rigid body under a moment and a force, NLGEOM: quadratic convergence."""
    cards = "*NODE, NSET=ALL\n90, .5, .5, 3.\n*RIGID BODY, NSET=TOP, REF NODE=90\n"
    loads = "*BOUNDARY\nBOTTOM, 1, 3\n*CLOAD\n90, 1, 8.\n90, 6, 20.\n"
    done = run_deck(job(cards, loads, "*STEP, NLGEOM\n*STATIC\n"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert iterations(tmp_path) <= 9
    residuals = [iteration.residual for iteration in read_cvg(tmp_path / "job.cvg")]
    small = [r / 100 for r in residuals if r < 1.0]
    assert len(small) >= 2 and small[1] < 30 * small[0] ** 1.7, f"not quadratic: {residuals}"
    forces = read_rows(tmp_path, "forces")
    assert sum(forces[n][0] for n in (1, 2, 3, 4)) == pytest.approx(-8.0, rel=1e-5)


def test_kinematic_coupling(run_deck: Run, tmp_path: Path) -> None:
    """Only the direction bound is: the top moves up by one value and contracts freely."""
    cards = "*NODE, NSET=ALL\n90, .5, .5, 1.\n*COUPLING, REF NODE=90, SURFACE=UP, CONSTRAINT NAME=C\n*KINEMATIC\n3, 3\n"
    loads = "*BOUNDARY\n1, 1, 3\n2, 2, 3\n3, 3\n4, 3\n90, 1, 2\n90, 4, 6\n*CLOAD\n90, 3, 10.\n"
    done = run_deck(job(cards, loads))
    assert done.returncode == 0, done.stdout + done.stderr
    rows = read_rows(tmp_path, "displacements")
    check(rows, 7, [-NU * 0.01, -NU * 0.01, 0.01], 0.01, "displacement")
    check(rows, 90, [0, 0, 0.01], 0.01, "displacement")


@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
def test_kinematic_coupling_without_rows(run_deck: Run, tmp_path: Path, dialect: str) -> None:
    """All directions are bound, in both dialects: the top cannot contract. CalculiX binds none, which the job says."""
    cards = "*NODE, NSET=ALL\n90, .5, .5, 1.\n*COUPLING, REF NODE=90, SURFACE=UP, CONSTRAINT NAME=C\n*KINEMATIC\n"
    loads = "*BOUNDARY\n1, 1, 3\n2, 2, 3\n3, 3\n4, 3\n90, 1, 2\n90, 4, 6\n90, 3, 3, .01\n"
    done = run_deck(f"** dialect: {dialect}\n" + job(cards, loads))
    assert done.returncode == 0, done.stdout + done.stderr
    check(read_rows(tmp_path, "displacements"), 7, [0, 0, 0.01], 0.01, "displacement")
    assert ("CalculiX binds none" in " ".join(done.stdout.split())) == (dialect == "calculix")


WORDS = {"ENCASTRE": "123456", "PINNED": "123", "XSYMM": "156", "YSYMM": "246", "ZSYMM": "345",
         "XASYMM": "234", "YASYMM": "135", "ZASYMM": "126"}  # fmt: skip


@pytest.mark.parametrize("card", ["*RIGID BODY, NSET=BOTTOM, REF NODE=90\n",
                                  "*SURFACE, NAME=DOWN\n1, S1\n*COUPLING, REF NODE=90, SURFACE=DOWN, CONSTRAINT NAME=C\n*KINEMATIC\n"])  # fmt: skip
@pytest.mark.parametrize("word", WORDS)
def test_support_words_at_a_reference_node(run_deck: Run, tmp_path: Path, word: str, card: str) -> None:
    """A word and the degrees of freedom that it leaves hold the bottom of a cube as its own supports do, and no note is printed."""
    force = "*CLOAD\n7, 1, 3.\n8, 2, 2.\n"
    assert run_deck(job("", "*BOUNDARY\nBOTTOM, 1, 3\n" + force)).returncode == 0
    clamped = read_rows(tmp_path, "displacements")
    left = "".join(f"90, {k}\n" for k in "123456" if k not in WORDS[word])
    done = run_deck(job("*NODE, NSET=ALL\n90, .5, .5, -2.\n" + card, f"*BOUNDARY\n90, {word}\n{left}{force}"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "*WARNING" not in done.stdout
    rows = read_rows(tmp_path, "displacements")
    for node in range(1, 9):
        check(rows, node, clamped[node], 0.01, "displacement")


@pytest.mark.parametrize("word", [word for word in WORDS if word != "ENCASTRE"])
def test_what_a_support_word_leaves_free(run_deck: Run, word: str) -> None:
    """Without those degrees of freedom the cube can move, which the check of the model says: the force works on all motions."""
    cards = "*NODE, NSET=ALL\n90, .5, .5, -2.\n*RIGID BODY, NSET=BOTTOM, REF NODE=90\n"
    done = run_deck(job(cards, f"*BOUNDARY\n90, {word}\n*CLOAD\n7, 1, 3.\n7, 2, 4.\n7, 3, 2.\n"))
    assert done.returncode == 4
    motions = " ".join(re.findall(r" can (.*?): no support", done.stdout))
    assert sum(motions.count(verb) for verb in ("move along", "turn about")) == 6 - len(WORDS[word])


def test_distributing_coupling(run_deck: Run, tmp_path: Path) -> None:
    """A force off the centre: the nodes get w (f + J^-1 m x r), with J of four equal weights at the corners."""
    cards = "*NODE, NSET=ALL\n90, 2.5, .5, 1.\n*COUPLING, REF NODE=90, SURFACE=UP, CONSTRAINT NAME=C\n*DISTRIBUTING\n1, 6\n"
    loads = "*BOUNDARY\nALL, 1, 3\n"
    text = job(cards, "*BOUNDARY\nBOTTOM, 1, 3\n*CLOAD\n90, 3, 4.\n").replace(loads, "")
    done = run_deck("** dialect: calculix\n" + text)
    assert done.returncode == 0, done.stdout + done.stderr
    forces = read_rows(tmp_path, "forces")  # internal forces: what is put on the nodes
    # moment about y: -(2)(4) = -8; J_y = sum w x^2 = 1/4; inverse(J) m x r: z component -(m_y / J_y) r_x
    for node, x in ((5, -0.5), (6, 0.5), (7, 0.5), (8, -0.5)):
        check(forces, node, [0, 0, 0.25 * (4.0 + 8.0 / 0.25 * x)], 10.0, "force")


def two_cubes(shift: float) -> str:
    """A second cube on top of the first with nodes of its own, its lower face a little away."""
    nodes = "".join(
        f"{10 + k}, {x}, {y}, {z}\n"
        for k, (x, y, z) in enumerate(
            [(0.2, 0.1, 1 + shift), (0.8, 0.1, 1 + shift), (0.8, 0.9, 1 + shift), (0.2, 0.9, 1 + shift),
             (0.2, 0.1, 2), (0.8, 0.1, 2), (0.8, 0.9, 2), (0.2, 0.9, 2)], start=1)
    )  # fmt: skip
    return (
        f"*NODE, NSET=ALL\n{nodes}*ELEMENT, TYPE=C3D8, ELSET=E\n2, 11, 12, 13, 14, 15, 16, 17, 18\n"
        "*SURFACE, NAME=LOW\n2, S1\n*NSET, NSET=HEAD\n15, 16, 17, 18\n"
    )


PLANE_CUBE = """*NODE, NSET=ALL
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
9, 0.5, 2.
*ELEMENT, TYPE=%s, ELSET=E
1, 1, 2, 3, 4
*NSET, NSET=TOP
3, 4
*SURFACE, NAME=UP
1, S3
"""
IN_THE_PLANE = {
    "rigid body": "*RIGID BODY, NSET=TOP, REF NODE=9\n",
    "kinematic": "*COUPLING, CONSTRAINT NAME=C, REF NODE=9, SURFACE=UP\n*KINEMATIC\n",
    "distributing": "*COUPLING, CONSTRAINT NAME=C, REF NODE=9, SURFACE=UP\n*DISTRIBUTING\n",
}


def plane_job(card: str, kind: str) -> str:
    """A square on two supports with a reference node above it, which is pushed to the side and down; it has no support along z."""
    loads = "*BOUNDARY\n1, 1, 2\n2, 1, 2\n*CLOAD\n9, 1, 5.\n9, 2, -3.\n"
    step = f"*STEP\n*STATIC\n{TIGHT}{loads}{PRINT.replace('SHOWN', 'ALL')}*END STEP\n"
    return f"{PLANE_CUBE % kind}{IN_THE_PLANE[card]}{MATERIAL}1.\n{step}"


@pytest.mark.parametrize("kind", ["CPE4", "CPS4"])
@pytest.mark.parametrize("card", IN_THE_PLANE)
def test_reference_node_of_a_plane_model(run_deck: Run, tmp_path: Path, card: str, kind: str) -> None:
    """It moves with the mean rigid motion of the top, u = u_c + t x (X - c), and its load comes to the supports by statics."""
    assert run_deck("** dialect: abaqus\n" + plane_job(card, kind)).returncode == 0
    u, force = read_rows(tmp_path, "displacements"), read_rows(tmp_path, "forces")
    t = u[3][1] - u[4][1]
    expected = [(u[3][0] + u[4][0]) / 2 - t, (u[3][1] + u[4][1]) / 2, 0.0]
    assert u[9] == pytest.approx(expected, abs=TOLERANCE * abs(u[9][0]))
    assert force[1][0] + force[2][0] == pytest.approx(-5.0, rel=TOLERANCE)
    assert force[2][1] == pytest.approx(3.0 / 2 + 5.0 * 2, rel=TOLERANCE)  # moment about node 1: 3 x 0.5 + 5 x 2
    assert force[1][1] == pytest.approx(3.0 / 2 - 5.0 * 2, rel=TOLERANCE)


def test_distributing_of_axisymmetric_faces(run_deck: Run) -> None:
    """They have no mean rigid motion."""
    run = run_deck("** dialect: abaqus\n" + plane_job("distributing", "CAX4"))
    assert run.returncode != 0
    assert "is of axisymmetric elements" in run.stdout + run.stderr


POINTS = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [1.0, 1.0, 2.0]])
PLACE = np.array([1.0, 2.0, 3.0])  # of the reference node


def test_weights_of_a_distributing_coupling(run_deck: Run, tmp_path: Path) -> None:
    """Force F and moment M on a DCOUP3D element go to nodes on springs as w (F + J^-1 m x r): together they are F and M about the
    node. It moves with the weighted mean rigid body motion of the nodes; a weight in two lines counts twice."""
    stiffness, force, moment = 100.0, np.array([1.0, -2.0, 3.0]), np.array([4.0, 5.0, -6.0])
    weight = np.array([1.0, 2.0, 3.0, 4.0]) / 10
    deck = "*NODE, NSET=ALL\n" + "".join(f"{i + 1}, {x}, {y}, {z}\n" for i, (x, y, z) in enumerate(POINTS)) + "9, 1., 2., 3.\n"
    for k in range(3):
        deck += f"*ELEMENT, TYPE=SPRING1, ELSET=S{k}\n" + "".join(f"{10 * k + i}, {i}\n" for i in range(1, 5)) + f"*SPRING, ELSET=S{k}\n{k + 1}\n{stiffness}\n"
    deck += "*ELEMENT, TYPE=DCOUP3D, ELSET=D\n99, 9\n*DISTRIBUTING COUPLING, ELSET=D\n1, 1.\n2, 2.\n3, 3.\n4, 1.\n4, 3.\n"
    loads = "".join(f"9, {k + 1}, {value}\n" for k, value in enumerate([*force, *moment]))
    run = run_deck(f"** dialect: abaqus\n{deck}*STEP\n*STATIC\n{TIGHT}*CLOAD\n{loads}{PRINT.replace('SHOWN', 'ALL')}*END STEP\n")
    assert run.returncode == 0, run.stdout + run.stderr
    centre = weight @ POINTS
    arms = POINTS - centre
    inertia = sum(w * (r @ r * np.eye(3) - np.outer(r, r)) for w, r in zip(weight, arms, strict=True))
    turn = np.linalg.solve(inertia, moment + np.cross(PLACE - centre, force))
    parts = weight[:, None] * (force + np.cross(turn, arms))
    assert parts.sum(axis=0) == pytest.approx(force)
    assert np.cross(POINTS - PLACE, parts).sum(axis=0) == pytest.approx(moment)
    u = parts / stiffness
    rotation = np.linalg.solve(inertia, (weight[:, None] * np.cross(arms, u)).sum(axis=0))
    shown = read_rows(tmp_path, "displacements")
    scale = np.abs(u).max()
    for i in range(4):
        assert shown[i + 1][:3] == pytest.approx(u[i], abs=TOLERANCE * scale)
    assert shown[9][:3] == pytest.approx(weight @ u + np.cross(rotation, PLACE - centre), abs=10 * TOLERANCE * scale)


@pytest.mark.parametrize("is_plane", [False, True])
def test_distributing_coupling_of_an_element(run_deck: Run, tmp_path: Path, *, is_plane: bool) -> None:
    """With the weights of the area *DISTRIBUTING COUPLING is *COUPLING with *DISTRIBUTING: the same numbers to the last digit."""
    couplings = ["*COUPLING, REF NODE=90, SURFACE=UP, CONSTRAINT NAME=C\n*DISTRIBUTING\n"]
    if is_plane:
        couplings = [IN_THE_PLANE["distributing"], "*ELEMENT, TYPE=DCOUP2D, ELSET=D\n99, 9\n*DISTRIBUTING COUPLING, ELSET=D\nTOP, 1.\n"]
        decks = [plane_job("distributing", "CPE4").replace(couplings[0], coupling) for coupling in couplings]
    else:
        couplings.append("*ELEMENT, TYPE=DCOUP3D, ELSET=D\n99, 90\n*DISTRIBUTING COUPLING, ELSET=D\nTOP, 0.7\n")
        loads = "*BOUNDARY\nBOTTOM, 1, 3\n*CLOAD\n90, 3, 4.\n90, 1, 2.\n90, 6, 1.\n"
        decks = [job("*NODE, NSET=ALL\n90, 2.5, .5, 1.\n" + coupling, loads) for coupling in couplings]
    shown = []
    for deck in decks:
        done = run_deck("** dialect: abaqus\n" + deck)
        assert done.returncode == 0, done.stdout + done.stderr
        shown.append(read_rows(tmp_path, "displacements"))
    assert shown[0] == shown[1]


@pytest.mark.parametrize(("rows", "message"), [
    ("1, 1.\n2, 1.\n", "lie on a line"),
    ("TOP, 1.\n90, 1.\n", "is itself in the list"),
    ("", "couples nothing without *DISTRIBUTING COUPLING"),
])  # fmt: skip
def test_refused_distributing_coupling(run_deck: Run, rows: str, message: str) -> None:
    """Nodes on a line carry no moment about it; a node does not follow itself; an element alone couples nothing."""
    coupling = "*NODE, NSET=ALL\n90, 2.5, .5, 1.\n*ELEMENT, TYPE=DCOUP3D, ELSET=D\n99, 90\n"
    if rows:
        coupling += f"*DISTRIBUTING COUPLING, ELSET=D\n{rows}"
    done = run_deck("** dialect: abaqus\n" + job(coupling, "*BOUNDARY\nBOTTOM, 1, 3\n"))
    assert done.returncode in (3, 4)
    assert message in re.sub(r"\s+", " ", done.stdout + done.stderr)


def test_tie(run_deck: Run, tmp_path: Path) -> None:
    """Two cubes tied, turned rigidly and pulled by displacement: tied nodes are on the facet, also after ADJUST."""
    cards = two_cubes(0.01) + "*TIE, NAME=T\nLOW, UP\n"
    loads = "*BOUNDARY\n1, 1, 3\n2, 2, 3\n4, 3\n3, 3\n*CLOAD\nHEAD, 3, 2.5\n"
    done = run_deck(job(cards, loads))
    assert done.returncode == 0, done.stdout + done.stderr
    rows = read_rows(tmp_path, "displacements")
    top = [rows[n] for n in (5, 6, 7, 8)]
    for node, x, y in ((11, 0.2, 0.1), (13, 0.8, 0.9)):
        weights = [(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y]
        check(rows, node, [sum(w * u[k] for w, u in zip(weights, top, strict=True)) for k in range(3)], 0.01, "displacement")
    forces = read_rows(tmp_path, "forces")
    assert sum(forces[n][2] for n in (1, 2, 3, 4)) == pytest.approx(-10.0, rel=1e-5)


def test_tie_too_far(run_deck: Run) -> None:
    """Surfaces farther apart than the tolerance: reported, nothing runs."""
    cards = two_cubes(0.01) + "*TIE, NAME=T, POSITION TOLERANCE=.001\nLOW, UP\n"
    done = run_deck(job(cards, "*BOUNDARY\nBOTTOM, 1, 3\nHEAD, 1, 3\n"))
    assert done.returncode == 4
    assert "ties no node" in done.stdout + done.stderr


@pytest.mark.parametrize("is_force", [True, False])
def test_pretension(run_deck: Run, tmp_path: Path, is_force: bool) -> None:
    """A column of two cubes between plates, cut in the middle: stress = force; overlap d gives stress E d / length."""
    cards = CUBE.split("*NSET, NSET=BOTTOM")[0]
    nodes = "11, 0, 0, 2\n12, 1, 0, 2\n13, 1, 1, 2\n14, 0, 1, 2\n90, 0, 0, 0\n"
    text = (
        f"{cards}*NODE, NSET=ALL\n{nodes}*ELEMENT, TYPE=C3D8, ELSET=E\n2, 5, 6, 7, 8, 11, 12, 13, 14\n"
        "*SURFACE, NAME=CUT\n2, S1\n*PRE-TENSION SECTION, SURFACE=CUT, NODE=90\n0, 0, 1\n"
        f"*NSET, NSET=SHOWN\nALL\n{MATERIAL}*STEP\n*STATIC\n{TIGHT}"
        "*BOUNDARY\n1, 1, 3\n2, 2, 3\n3, 3\n4, 3\n11, 1, 3\n12, 2, 3\n13, 3\n14, 3\n"
    )
    # the pre-tension node moves by u = n (u_new - u_old); the upper cube has the new nodes
    text += "*CLOAD\n90, 1, -5.\n" if is_force else "*BOUNDARY\n90, 1, 1, -.01\n"
    done = run_deck(text + PRINT + "*END STEP\n")
    assert done.returncode == 0, done.stdout + done.stderr
    forces = read_rows(tmp_path, "forces")
    pull = 5.0 if is_force else YOUNG * 0.01 / 2
    assert sum(forces[n][2] for n in (1, 2, 3, 4)) == pytest.approx(-pull, rel=1e-6)
    u = read_rows(tmp_path, "displacements")
    assert u[90][0] == pytest.approx(-5.0 * 2 / YOUNG if is_force else -0.01, rel=1e-6)


def cut_deck(kind: str, has_wall: bool) -> str:
    """A column 2 x 2 x 4 of unit cubes between plates without friction, cut in the middle, with a force of 5 in the cut; beside it
    a wall without friction, towards which a pressure of 2 pushes the column."""
    column = block([0, 1, 2], [0, 1, 2], range(5), "COLUMN")
    body = as_kind(join([column, block([2, 3], [0, 1, 2], [0, 1, 3, 4], "WALL")]) if has_wall else column, kind)
    pilot = len(body.nodes) + 1
    of_column = set(np.unique(body.elements[(body.nodes[body.elements, 0] <= 2).all(axis=1)]))

    def surface(name: str, axis: int, value: float, lower: tuple[float, float, float]) -> str:
        """Faces at a place, of the elements that lie beyond a corner."""
        at = set(body.where(axis, value))
        rows = [f"{e + 1}, S{f}\n" for e, nodes in enumerate(body.elements) if (body.nodes[nodes] >= lower).all()
                and (lower[0] >= 2 or of_column.issuperset(nodes))
                for f, local in enumerate(FACES[kind], start=1) if at.issuperset(nodes[local])]  # fmt: skip
        return f"*SURFACE, NAME={name}\n" + "".join(rows)

    model = surface("CUT", 2, 2.0, (0, 0, 2)) + f"*PRE-TENSION SECTION, SURFACE=CUT, NODE={pilot}\n0, 0, 1\n"
    loads = "1, 1\n"
    if has_wall:
        model += surface("SIDE", 0, 2.0, (0, 0, 0)) + surface("FRONT", 0, 2.0, (2, 0, 0)) + surface("BACK", 0, 0.0, (0, 0, 0))
        model += "*SURFACE INTERACTION, NAME=SMOOTH\n*CONTACT PAIR, INTERACTION=SMOOTH, TYPE=SURFACE TO SURFACE\nFRONT, SIDE\n"
        loads = "FAR, 1\n*DSLOAD\nBACK, P, 2.\n"
    return (
        f"{body.cards()}*NODE, NSET=PILOT\n{pilot}, 0, 0, 0\n" + node_set("FAR", body.where(0, 3.0))
        + node_set("LOW", body.where(2, 0.0)) + node_set("HIGH", of_column.intersection(body.where(2, 4.0)))
        + node_set("FLAT", body.where(1, 0.0))
        + model + MATERIAL.replace("ELSET=E", "ELSET=ALL")
        + f"*STEP\n*STATIC\n{TIGHT}*CLOAD\n{pilot}, 1, -5.\n*BOUNDARY\nLOW, 3\nHIGH, 3\nFLAT, 2\n{loads}"
        + "*NODE PRINT, NSET=PILOT\nU\n*NODE PRINT, NSET=LOW\nRF\n*END STEP\n"
    )  # fmt: skip


@pytest.mark.parametrize("has_wall", [False, True])
@pytest.mark.parametrize("kind", ["C3D4", "C3D6", "C3D8", "C3D10", "C3D15", "C3D20"])
def test_pretension_parts_all_elements(run_deck: Run, tmp_path: Path, kind: str, has_wall: bool) -> None:
    """Elements that touch the cut with no more than an edge or a corner belong to their side of it too: nothing else transmits force, and the
    overlap is L (F / A + nu p) / E. A surface that crosses the cut has the nodes on both sides of it."""
    text = cut_deck(kind, has_wall)
    done = run_deck(text if has_wall else text.replace("*NSET, NSET=FAR\n\n", ""))
    assert done.returncode == 0, done.stdout + done.stderr
    pressure = 2.0 if has_wall else 0.0
    ((overlap, *_),) = read_rows(tmp_path, "displacements").values()
    assert overlap == pytest.approx(-4.0 * (5.0 / 4.0 + NU * pressure) / YOUNG, rel=1e-6)
    assert sum(row[2] for row in read_rows(tmp_path, "forces").values()) == pytest.approx(-5.0, rel=1e-6)


def test_pretension_as_calculix_has_it(run_deck: Run, tmp_path: Path) -> None:
    """The calculix dialect parts the elements of the faces alone, as CalculiX does (compared with it in verify/peers), and says how many
    others transmit load past the section: less than the force is left in the bar."""
    done = run_deck(cut_deck("C3D4", has_wall=False).replace("*NSET, NSET=FAR\n\n", ""), "--dialect=calculix")
    assert done.returncode == 0, done.stdout + done.stderr
    message = re.search(r"(\d+) elements beside the section", done.stdout + done.stderr)
    body = as_kind(block([0, 1, 2], [0, 1, 2], range(5), "COLUMN"), "C3D4")
    above = (body.nodes[body.elements, 2] >= 2).all(axis=1)
    on_cut = (body.nodes[body.elements, 2] == 2).sum(axis=1)
    assert message
    assert int(message[1]) == (above & (on_cut > 0) & (on_cut < 3)).sum()
    assert 1.0 < -sum(row[2] for row in read_rows(tmp_path, "forces").values()) < 4.0


@pytest.mark.parametrize("form", [", TYPE=SURFACE TO SURFACE", ""])
@pytest.mark.parametrize("slaves", ["all", "above", "below"])
@pytest.mark.parametrize("kind", ["C3D4", "C3D8", "C3D10", "C3D20"])
def test_contact_pushes_across_a_cut(run_deck: Run, tmp_path: Path, kind: str, slaves: str, form: str) -> None:
    """The slave surface crosses the cut, or ends at it on either side, against a wall with other nodes: both nodes of a place at the cut
    go along the wall together and are pushed as one. The pressure passes evenly, so the overlap is L (F / A + nu p) / E, and the
    wall takes all of it; a surface that ends at the cut is pressed half as high up, and the bar bends."""
    text = cut_deck(kind, has_wall=True).replace("FRONT, SIDE", "SIDE, FRONT").replace(", TYPE=SURFACE TO SURFACE", form)
    if slaves != "all":
        body = as_kind(join([block([0, 1, 2], [0, 1, 2], range(5), "COLUMN"), block([2, 3], [0, 1, 2], [0, 1, 3, 4], "WALL")]), kind)
        side = re.search(r"NAME=SIDE\n((?:\d.*\n)+)", text)
        assert side
        is_above = (body.nodes[body.elements, 2].mean(axis=1) > 2.0) == (slaves == "above")
        kept = [row for row in side[1].splitlines(keepends=True) if is_above[int(row.split(",")[0]) - 1]]
        text = text.replace(side[0], "NAME=SIDE\n" + "".join(kept))
    done = run_deck(text.replace("*NODE PRINT, NSET=LOW\nRF\n", "*NODE PRINT, NSET=LOW\nRF\n*NODE PRINT, NSET=FAR\nRF\n"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Swap slave and master" not in done.stdout + done.stderr
    assert iterations(tmp_path) == 1
    ((overlap, *_),) = read_rows(tmp_path, "displacements").values()
    if slaves == "all":
        assert overlap == pytest.approx(-4.0 * (5.0 / 4.0 + NU * 2.0) / YOUNG, rel=1e-6)
    assert sum(row[0] for row in read_rows(tmp_path, "forces").values()) == pytest.approx(-16.0, rel=1e-6)


def test_pretension_in_part_of_a_body(run_deck: Run) -> None:
    """A cut that ends inside the body is reported: elements on its two sides are connected around its edge."""
    text = cut_deck("C3D8", has_wall=False).replace("*NSET, NSET=FAR\n\n", "")
    cut = re.search(r"NAME=CUT\n(.*\n)", text)
    assert cut
    done = run_deck(re.sub(r"(NAME=CUT\n)(\d.*\n)+", r"\g<1>" + cut[1], text))
    assert done.returncode == 3
    assert "does not cut its body through" in done.stdout + done.stderr


def test_plane_and_straight(run_deck: Run, tmp_path: Path) -> None:
    """A node pushed out of the plane of three others pulls them along; the four are in a plane in the end, NLGEOM."""
    cards = "*MPC\nPLANE, 5, 6, 7, 8\n"
    loads = "*BOUNDARY\nBOTTOM, 1, 3\n*CLOAD\n8, 3, 10.\n6, 1, 8.\n"
    done = run_deck(job(cards, loads, "*STEP, NLGEOM\n*STATIC\n"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert iterations(tmp_path) <= 7
    u = read_rows(tmp_path, "displacements")
    corners = {5: (0, 0, 1), 6: (1, 0, 1), 7: (1, 1, 1), 8: (0, 1, 1)}
    place = {n: [x + d for x, d in zip(corners[n], u[n], strict=True)] for n in corners}
    a, b, c = ([p - q for p, q in zip(place[n], place[5], strict=True)] for n in (6, 7, 8))
    volume = (
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    )
    assert abs(volume) < 1e-5
    assert abs(u[8][2] - u[5][2]) > 0.01


def test_mean_rotation(run_deck: Run, tmp_path: Path) -> None:
    """MEANROT: the top turned by 1.2 rad about z on the mean; by symmetry each corner turns by it."""
    cards = "*NODE, NSET=ALL\n90, 0, 0, 1\n*MPC\nMEANROT, 5, 5, 5, 6, 6, 6, 7, 7, 7, 8, 8, 8, 90\n"
    loads = "*BOUNDARY\nBOTTOM, 1, 3\n90, 1, 1, 1.2\n"
    done = run_deck(job(cards, loads, "*STEP, NLGEOM\n*STATIC\n.25, 1.\n"))
    assert done.returncode == 0, done.stdout + done.stderr
    u = read_rows(tmp_path, "displacements")
    for node, x, y in ((5, -0.5, -0.5), (7, 0.5, 0.5)):
        turned = math.atan2(y + u[node][1], x + u[node][0]) - math.atan2(y, x)
        assert turned == pytest.approx(1.2, rel=1e-5)
    forces = read_rows(tmp_path, "forces")
    assert forces[90][0] > 0  # the moment that turns it


def test_time_delay_and_shift(run_deck: Run, tmp_path: Path) -> None:
    """A delayed and shifted amplitude: at the end of the step of length 1 the table is at 1 - .25 + .5."""
    cards = "*AMPLITUDE, NAME=A, SHIFTX=-.5, SHIFTY=1.\n0., 0., 2., 2.\n"
    loads = "*BOUNDARY\nBOTTOM, 1, 3\n*BOUNDARY, AMPLITUDE=A, TIME DELAY=.25\nTOP, 3, 3, .01\n"
    done = run_deck(job(cards, loads))
    assert done.returncode == 0, done.stdout + done.stderr
    assert read_rows(tmp_path, "displacements")[5][2] == pytest.approx(0.01 * (1.25 + 1.0), rel=1e-6)


def test_constraint_conflict(run_deck: Run) -> None:
    """A rigid body with contradictory prescribed displacements is reported with its line."""
    cards = "*NODE, NSET=ALL\n90, .5, .5, 1.\n*RIGID BODY, NSET=TOP, REF NODE=90\n"
    loads = "*BOUNDARY\nBOTTOM, 1, 3\n5, 1, 3\n6, 1, 3\n7, 1, 3\n8, 1, 1, .1\n8, 2, 3\n"
    done = run_deck(job(cards, loads))
    assert done.returncode == 4, done.stdout + done.stderr
    assert re.search(r"RIGID BODY of line \d+ contradicts", done.stdout + done.stderr)


def test_constraint_conflict_during_the_step(run_deck: Run, tmp_path: Path) -> None:
    """Supports that a rigid body allows to first order alone: under NLGEOM the conflict appears during the step, and is reported with its line.

    An edge turns about its end by prescribed displacements that would stretch it by sqrt(1.09) - 1.
    """
    cards = "*NODE, NSET=ALL\n90, .5, .5, 1.\n*RIGID BODY, NSET=TOP, REF NODE=90\n"
    loads = "*BOUNDARY\nBOTTOM, 1, 3\n5, 1, 3\n6, 1, 1\n6, 2, 2, .3\n6, 3, 3\n"
    deck = job(cards, loads, "*STEP, NLGEOM\n*STATIC, DIRECT\n1., 1.\n")
    done = run_deck(deck)
    line = 1 + deck.splitlines().index("*RIGID BODY, NSET=TOP, REF NODE=90")
    message = done.stdout + done.stderr
    assert done.returncode == 5, message
    assert f"CONSTRAINTS: The *RIGID BODY of line {line} contradicts the boundary conditions of its nodes" in message
    assert "Remedy: release a support or an equation" in message
    assert "CONSTRAINTS: The *RIGID BODY" in (tmp_path / "job.cvg").read_text()


@pytest.mark.parametrize(("x", "part"), [(0.25, 0.25), (1.5, 1.5), (0.5, 0.5)])
def test_linear_interpolation(run_deck: Run, tmp_path: Path, x: float, part: float) -> None:
    """MPC LINEAR: a node between two corners, or beyond, moves by their interpolated displacements, and its force goes to both by the lever."""
    cards = f"*NODE, NSET=ALL\n90, {x}, 0.1, 1.\n*MPC\nLINEAR, 90, 5, 6\n"
    done = run_deck(job(cards, "*BOUNDARY\nBOTTOM, 1, 3\n*CLOAD\n90, 3, 4.\n7, 1, 2.\n"))
    assert done.returncode == 0, done.stdout + done.stderr
    u = read_rows(tmp_path, "displacements")
    check(u, 90, [(1 - part) * a + part * b for a, b in zip(u[5], u[6], strict=True)], 0.03, "displacement")
    done = run_deck(job("", f"*BOUNDARY\nBOTTOM, 1, 3\n*CLOAD\n5, 3, {4 * (1 - part)}\n6, 3, {4 * part}\n7, 1, 2.\n"))
    assert done.returncode == 0
    by_lever = read_rows(tmp_path, "displacements")
    for node in range(1, 9):
        check(u, node, by_lever[node], 0.03, "displacement")


@pytest.mark.parametrize(("row", "message"), [("LINEAR, 90, 5", "needs three nodes"), ("LINEAR, 7, 90, 91", "at the same place")])
def test_refused_interpolation(run_deck: Run, row: str, message: str) -> None:
    """Two nodes only, or two at one place."""
    done = run_deck(job(f"*NODE\n90, 0., 0., 2.\n91, 0., 0., 2.\n*MPC\n{row}\n", "*BOUNDARY\nBOTTOM, 1, 3\n"))
    assert done.returncode == 3
    assert message in " ".join(done.stdout.split())


def seam_mesh(kind: str, n_stem: int) -> tuple[str, list[Solids], list[int]]:
    """Two plates end to end, not joined, and a stem across their seam: cards, parts and the number of nodes before each part.

    The nodes of the stem's sole on the seam lie on both plates.
    """
    z, y = np.linspace(-0.5, 0, 3), np.linspace(0, 1, 5)
    parts = [block(np.linspace(-2, 0, 9), y, z, "LEFT"), block(np.linspace(0, 2, 9), y, z, "RIGHT"),
             block(np.linspace(-0.25, 0.25, 3), np.linspace(0, 1, n_stem + 1), np.linspace(0, 1, 4), "STEM")]
    solids, before, cards, elements = [as_kind(part, kind) for part in parts], [], "", 0
    n = 0
    for name, part in zip(("LEFT", "RIGHT", "STEM"), solids, strict=True):
        before.append(n)
        cards += "*NODE\n" + "".join(f"{i + n}, " + ", ".join(f"{v:.15g}" for v in x) + "\n" for i, x in enumerate(part.nodes, start=1))
        for i, nodes in enumerate(part.elements, start=1):
            labels = [str(i + elements), *(str(k + 1 + n) for k in nodes)]
            cards += f"*ELEMENT, TYPE={kind}, ELSET={name}\n" + ", ".join(labels[:11]) + (",\n" + ", ".join(labels[11:]) if labels[11:] else "") + "\n"
        plane = part.where(2, 0.0)
        cards += f"*SURFACE, NAME={name}\n" + "".join(f"{e + 1 + elements}, S{f}\n" for e, f in part.outer_faces(plane))
        n, elements = n + len(part.nodes), elements + len(part.elements)
    end = [int(k) + 1 + before[1] for k in solids[1].where(0, 2.0)]
    cards += node_set("CLAMPED", solids[0].where(0, -2.0)) + node_set("END", [k - 1 for k in end])
    cards += "*ELSET, ELSET=E\nLEFT, RIGHT, STEM\n" + MATERIAL
    loads = f"*STEP\n*STATIC\n{TIGHT}*BOUNDARY\nCLAMPED, 1, 3\n*CLOAD\nEND, 3, {-0.1 / len(end)}\n*NODE PRINT, NSET=END\nU\n*END STEP\n"
    return cards + "{}" + loads, solids, before


def joined_nodes(solids: list[Solids], before: list[int]) -> str:
    """Equations between each node of the stem's sole and the nodes of the plates at its place."""
    stem, text = solids[2], ""
    for plate, n in zip(solids[:2], before[:2], strict=True):
        for k in stem.where(2, 0.0):
            distance = np.linalg.norm(plate.nodes - stem.nodes[k], axis=1)
            if distance.min() < 1e-9:
                text += "".join(f"*EQUATION\n2\n{int(distance.argmin()) + 1 + n}, {c}, 1., {int(k) + 1 + before[2]}, {c}, -1.\n" for c in (1, 2, 3))
    return text


@pytest.mark.parametrize("kind", ["C3D8I", "C3D20R"])
def test_slave_of_two_ties(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """A stem across the seam of two plates, tied to each: its nodes on the seam are slaves of both ties and hold both plates.

    With matching nodes the answer is that of the nodes joined one by one; with a finer stem it is near it, and equations that
    follow from others are reported with their card. (CalculiX 2.20 drops the second tie of these nodes: the right plate then turns about
    the remaining line of nodes, by 1e10 with C3D8I and by a third too much with C3D20R.)
    """
    ties = "*TIE, NAME=T1, POSITION TOLERANCE=.01\nSTEM, LEFT\n*TIE, NAME=T2, POSITION TOLERANCE=.01\nSTEM, RIGHT\n"
    ends = []
    for n_stem, joint in ((4, "ties"), (4, "nodes"), (7, "ties")):
        cards, solids, before = seam_mesh(kind, n_stem)
        done = run_deck(cards.format(ties if joint == "ties" else joined_nodes(solids, before)))
        assert done.returncode == 0, done.stdout + done.stderr
        assert n_stem == 4 or "(*TIE of line" in done.stdout
        ends.append(np.array(list(read_rows(tmp_path, "displacements").values())))
    scale = np.abs(ends[1]).max()
    assert np.abs(ends[0] - ends[1]).max() <= TOLERANCE * scale
    assert np.abs(ends[2] - ends[1]).max() <= 0.01 * scale
