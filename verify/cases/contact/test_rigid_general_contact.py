"""Rigid bodies against rigid bodies in general contact: springs, gaps and forces have a closed form.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import h5py
import pytest

from verify.conftest import Run

YOUNG = 1000.0
GAP = 0.1
LOAD = 10.0
SPRING, FOOT = 50.0, 200.0  #: stiffness of the springs below the upper and the lower body
COUNT = 3  #: elements an edge of the upper body, whose underside is 1 by 1
PENALTY = 100 * YOUNG * COUNT  #: of the manual: 100 E over the edge
EQUAL = 1e-5  #: the .dat file has seven digits, and a face of a millionth of depth is off by as much


def faces(first: int, n: int, low: float, high: float, heights: tuple[float, ...]) -> tuple[str, list[list[int]]]:
    """Nodes of a square of n by n faces at each height, and the corners of its elements."""
    nodes = "*NODE\n"
    for level, z in enumerate(heights):
        for j in range(n + 1):
            for i in range(n + 1):
                number = first + level * (n + 1) ** 2 + j * (n + 1) + i
                nodes += f"{number}, {low + (high - low) * i / n}, {low + (high - low) * j / n}, {z}\n"
    corners = []
    for j in range(n):
        for i in range(n):
            a = first + j * (n + 1) + i
            base = [a, a + 1, a + n + 2, a + n + 1]
            corners.append([c + level * (n + 1) ** 2 for level in range(len(heights)) for c in base])
    return nodes, corners


def body(name: str, kind: str, first: int, n: int, low: float, high: float, heights: tuple[float, float]) -> str:
    """A block of C3D8 or a sheet of R3D4 at the end that faces the other body."""
    if kind == "sheet":
        heights = heights[:1] if name == "UPPER" else heights[1:]  # type: ignore[assignment]
    nodes, corners = faces(first, n, low, high, heights)
    deck = nodes + f"*ELEMENT, TYPE={'R3D4' if kind == 'sheet' else 'C3D8'}, ELSET={name}\n"
    deck += "".join(f"{first + k}, {', '.join(map(str, c))}\n" for k, c in enumerate(corners))
    return deck if kind == "sheet" else deck + f"*SOLID SECTION, ELSET={name}, MATERIAL=M\n"


def springs(node: int, element: int, direction: int, stiffness: float) -> str:
    """A spring from a node to the ground."""
    name = f"SPRING{element}"
    return f"*ELEMENT, TYPE=SPRING1, ELSET={name}\n{element}, {node}\n*SPRING, ELSET={name}\n{direction}\n{stiffness}\n"


def deck(lower: str = "solid", upper: str = "solid", contact: str = "", loads: str = "", supports: str = "", *, is_nlgeom: bool = False) -> str:
    """A body over another one with a gap, both rigid; the reference nodes are 900 (lower) and 901 (upper)."""
    text = f"*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, .3\n"
    text += body("LOWER", lower, 1, 2, -0.2, 1.3, (0.0, 1.0)) + body("UPPER", upper, 101, COUNT, 0.0, 1.0, (1 + GAP, 2 + GAP))
    text += "*NODE\n900, .5, .5, .5\n901, .5, .5, 1.6\n*NSET, NSET=BODIES\n900, 901\n"
    text += "*RIGID BODY, ELSET=LOWER, REF NODE=900\n*RIGID BODY, ELSET=UPPER, REF NODE=901\n"
    text += springs(901, 500, 3, SPRING) + springs(901, 501, 1, SPRING) + springs(900, 502, 3, FOOT)
    text += (contact or "*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n") + f"*STEP{', NLGEOM' if is_nlgeom else ''}\n*STATIC\n0.5, 1.\n"
    text += f"*BOUNDARY\n{supports or HELD}{loads or f'*CLOAD{chr(10)}901, 3, {-LOAD}{chr(10)}'}"
    return text + "*NODE PRINT, NSET=BODIES\nU, RF\n*END STEP\n"


HELD = "900, 1, 6\n901, 1, 2\n901, 4, 6\n"  #: the lower body is fixed, the upper moves up and down
ON_SPRING = "900, 1, 2\n900, 4, 6\n901, 1, 2\n901, 4, 6\n"  #: both move up and down


def solve(run_deck: Run, folder: Path, text: str, *options: str) -> tuple[list[list[float]], str]:
    """Displacements of 900 and 901 and their reactions at the end, and what the program says in one line."""
    done = run_deck(text, *options)
    said = re.sub(r"\s+", " ", done.stdout + done.stderr)
    assert done.returncode == 0, said
    lines = [line.split() for line in (folder / "job.dat").read_text().splitlines() if re.match(r"\s+90[01]\s", line)]
    return [[float(x) for x in line[1:4]] for line in lines[-4:]], said


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
@pytest.mark.parametrize("supports", [HELD, ON_SPRING])
def test_block_on_block(run_deck: Run, tmp_path: Path, supports: str, dialect: str, *, is_nlgeom: bool) -> None:
    """The load closes the gap against the spring; what is left of it goes into the lower body, through the penalty of the manual."""
    result, said = solve(run_deck, tmp_path, deck(supports=supports, is_nlgeom=is_nlgeom), f"--dialect={dialect}")
    flexibility = 1 / PENALTY + (1 / FOOT if supports == ON_SPRING else 0)
    force = (LOAD - SPRING * GAP) / (1 + SPRING * flexibility)
    assert result[1][2] == pytest.approx(-(LOAD - force) / SPRING, rel=EQUAL)
    if supports == ON_SPRING:
        assert result[0][2] == pytest.approx(-force / FOOT, rel=EQUAL)
    elif dialect == "abaqus":  # RF of the other dialect are internal forces
        assert result[2][2] == pytest.approx(force, rel=EQUAL)
    assert "General contact: 1 pair of 2 meshed bodies: slave UPPER" in said
    assert "acts by a penalty" in said and "Swap slave and master" not in said, "the master is rigid, too"
    assert "snapped" not in said, "the springs take the work"
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        stored = file["AMONTONS/history/strain_energy"][-1]
    lower = force**2 / FOOT if supports == ON_SPRING else 0.0
    assert stored == pytest.approx(0.5 * ((LOAD - force) ** 2 / SPRING + lower), rel=EQUAL)


def test_friction(run_deck: Run, tmp_path: Path) -> None:
    """A force along the surface beyond the friction goes into the spring there."""
    contact = "*SURFACE INTERACTION, NAME=DRY\n*FRICTION\n0.3\n*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n"
    contact += "*CONTACT PROPERTY ASSIGNMENT\n, , DRY\n"
    loads = f"*CLOAD\n901, 3, {-LOAD}\n901, 1, 4.\n"
    supports = "900, 1, 6\n901, 2\n901, 4, 6\n"
    result, _ = solve(run_deck, tmp_path, deck(contact=contact, loads=loads, supports=supports))
    force = (LOAD - SPRING * GAP) / (1 + SPRING / PENALTY)
    assert result[2] == pytest.approx([-0.3 * force, 0, force], rel=EQUAL, abs=1e-6)
    assert result[1][0] == pytest.approx((4 - 0.3 * force) / SPRING, rel=EQUAL)


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize(("lower", "upper"), [("sheet", "solid"), ("solid", "sheet")])
def test_sheet_and_block(run_deck: Run, tmp_path: Path, lower: str, upper: str, *, is_nlgeom: bool) -> None:
    """Rigid elements and a rigid block: one pair, on the sides that face each other."""
    result, said = solve(run_deck, tmp_path, deck(lower, upper, is_nlgeom=is_nlgeom))
    force = (LOAD - SPRING * GAP) / (1 + SPRING / PENALTY)
    assert result[2][2] == pytest.approx(force, rel=EQUAL)
    assert "General contact: 1 pair of 2 meshed bodies:" in said


PAIR = "*SURFACE, NAME=UNDERSIDE\nUPPER, SNEG\n*SURFACE, NAME=TOP\nLOWER, SPOS\n*SURFACE INTERACTION, NAME=I\n"
PAIR += "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nUNDERSIDE, TOP\n*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n"


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize("contact", ["", PAIR, "*CONTACT, REACH=3.\n*CONTACT INCLUSIONS, ALL EXTERIOR\n"])
@pytest.mark.parametrize("supports", [HELD, ON_SPRING])
def test_sheets(run_deck: Run, tmp_path: Path, supports: str, contact: str, *, is_nlgeom: bool) -> None:
    """Two bodies of rigid elements meet with the sides that face each other at the start, as with the pair by hand."""
    result, said = solve(run_deck, tmp_path, deck("sheet", "sheet", contact, supports=supports, is_nlgeom=is_nlgeom))
    force = (LOAD - SPRING * GAP) / (1 + SPRING * (1 / PENALTY + (1 / FOOT if supports == ON_SPRING else 0)))
    assert result[1][2] == pytest.approx(-(LOAD - force) / SPRING, rel=EQUAL)
    if supports == ON_SPRING:
        assert result[0][2] == pytest.approx(-force / FOOT, rel=EQUAL)
    assert f"General contact: {'0 pairs' if contact == PAIR else '1 pair'} of 2 meshed bodies" in said, "far sides and edges make none"


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize(("rows", "height"), [
    ("THICKNESS\n, 0.06", 0.06),
    ("THICKNESS\n, 0.06\nA, 0.02", 0.04),
    ("THICKNESS\n, 0.06\n*SURFACE PROPERTY ASSIGNMENT, PROPERTY=OFFSET FRACTION\nB, SNEG", 0.09),
])  # fmt: skip
def test_thick_sheets(run_deck: Run, tmp_path: Path, rows: str, height: float, *, is_nlgeom: bool) -> None:
    """Rigid elements with an assigned thickness and place meet that much earlier."""
    contact = "*SURFACE, NAME=A\nUPPER, SNEG\n*SURFACE, NAME=B\nLOWER, SPOS\n*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n"
    contact += f"*SURFACE PROPERTY ASSIGNMENT, PROPERTY={rows}\n"
    result, _ = solve(run_deck, tmp_path, deck("sheet", "sheet", contact, is_nlgeom=is_nlgeom))
    force = (LOAD - SPRING * (GAP - height)) / (1 + SPRING / PENALTY)
    assert result[2][2] == pytest.approx(force, rel=EQUAL)
    assert result[1][2] == pytest.approx(-(LOAD - force) / SPRING, rel=EQUAL)


@pytest.mark.parametrize("is_nlgeom", [False, True])
def test_inclined_sheets(run_deck: Run, tmp_path: Path, *, is_nlgeom: bool) -> None:
    """The lower sheet is inclined by 1 to 5. Guided vertically, the upper one comes down on it with its edge at x = 1, and the force
    is normal to the lower face: of its vertical part a fifth goes across."""
    contact = "*CONTACT, TYPE=NODE TO SURFACE\n*CONTACT INCLUSIONS, ALL EXTERIOR\n*CONTACT FORMULATION, TYPE=MASTER SLAVE ROLES\nA, B, SLAVE\n"
    contact = "*SURFACE, NAME=A\nUPPER, SNEG\n*SURFACE, NAME=B\nLOWER, SPOS\n" + contact
    text = deck("sheet", "sheet", contact, is_nlgeom=is_nlgeom)
    lines = text.splitlines()
    first = lines.index("*NODE")
    for i in range(first + 1, first + 10):
        number, x, y, z = (float(v) for v in lines[i].split(","))
        lines[i] = f"{int(number)}, {x}, {y}, {z + 0.2 * (x - 1)}"
    result, _ = solve(run_deck, tmp_path, "\n".join(lines) + "\n")
    assert result[2][2] == pytest.approx(LOAD + SPRING * result[1][2], rel=EQUAL), "what the spring does not take"
    assert result[2][0] == pytest.approx(-0.2 * result[2][2], rel=EQUAL)
    yields = 1.04 * result[2][2] / (PENALTY / 6)  # an edge has a sixth of the area; along z, of an inclined face
    assert result[1][2] == pytest.approx(-GAP - yields, abs=0.02 * yields), "the inclined edges of the master are 2 % longer"


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize("contact", ["", PAIR])
def test_sheets_in_one_plane(run_deck: Run, tmp_path: Path, contact: str, *, is_nlgeom: bool) -> None:
    """Which sides meet of sheets that lie in each other is unknown: an error, unless a pair says it."""
    text = deck("sheet", "sheet", contact, is_nlgeom=is_nlgeom).replace(f", {1 + GAP}\n", ", 1.0\n")
    done = run_deck(text)
    said = re.sub(r"\s+", " ", done.stdout + done.stderr)
    if not contact:
        assert done.returncode == 4, said
        assert "LOWER and UPPER lie in one surface or cross at the start" in said
        return
    assert done.returncode == 0, said
    result, _ = solve(run_deck, tmp_path, text)
    assert result[2][2] == pytest.approx(LOAD / (1 + SPRING / PENALTY), rel=1e-4), "the sheets are a millionth thick"


def test_crossing_sheets(run_deck: Run, tmp_path: Path) -> None:
    """A sheet at 45 degrees goes through a horizontal one: an error, and none if the sheets do not touch."""
    text = deck("sheet", "sheet").splitlines()
    first = [i for i, line in enumerate(text) if line == "*NODE"][1]
    for i in range(first + 1, first + 17):
        number, x, y, _ = (float(v) for v in text[i].split(","))
        text[i] = f"{int(number)}, {x}, {y}, {0.4 + x}"
    crossing = "\n".join(text) + "\n"
    done = run_deck(crossing)
    assert done.returncode == 4
    assert "lie in one surface or cross at the start" in re.sub(r"\s+", " ", done.stderr + done.stdout)
    rules = "*SURFACE, NAME=A\nLOWER, SPOS\nLOWER, SNEG\n*SURFACE, NAME=B\nUPPER, SPOS\nUPPER, SNEG\n"
    rules += "*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n*CONTACT EXCLUSIONS\nA, B\n"
    result, _ = solve(run_deck, tmp_path, crossing.replace("*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n", rules))
    assert result[1][2] == pytest.approx(-LOAD / SPRING, rel=EQUAL)


NO_PAIR = "no pair of {} and {}: supports prescribe the motion of both rigid bodies, and the job ends if they meet."
NOT_CONVERGED = 5  #: exit status of a job that ends early


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize(("lower", "upper"), [("solid", "solid"), ("sheet", "solid"), ("solid", "sheet"), ("sheet", "sheet")])
def test_driven_bodies(run_deck: Run, tmp_path: Path, lower: str, upper: str, *, is_nlgeom: bool) -> None:
    """Supports prescribe the motion of both: no force can move them. Before they meet all is well, and as soon as they do the job ends, as with any other
    contact; with an exclusion they may pass."""
    supports = "900, 1, 6\n901, 1, 2\n901, 3, 3, {}\n901, 4, 6\n"
    for way in (0.9 * GAP, 2 * GAP):
        text = deck(lower, upper, supports=supports.format(-way), loads="900, 1, 6\n", is_nlgeom=is_nlgeom)
        if way > GAP:
            done = run_deck(text)
            said = re.sub(r"\s+", " ", done.stdout + done.stderr)
            assert done.returncode == NOT_CONVERGED, said
            assert re.search(r"General contact: element \d+ of (UPPER|LOWER) passed through element \d+ of (UPPER|LOWER), and no contact", said), said
            assert "Supports prescribe the motion of both rigid bodies: leave one free where it touches, on a spring." in said
            assert "are named in *CONTACT EXCLUSIONS" in said
            continue
        result, said = solve(run_deck, tmp_path, text)
        assert "0 pairs of 2 meshed bodies: " + NO_PAIR.format("LOWER", "UPPER") in said
        assert result[2][2] == pytest.approx(0, abs=1e-9)
        assert result[3][2] == pytest.approx(-way * SPRING, rel=EQUAL)
    sides = "LOWER, SPOS\nLOWER, SNEG\n" if lower == "sheet" else "LOWER,\n"
    rules = f"*SURFACE, NAME=A\n{sides}*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n*CONTACT EXCLUSIONS\nA,\n, A\n"
    result, said = solve(run_deck, tmp_path, deck(lower, upper, rules, supports=supports.format(-2 * GAP), loads="900, 1, 6\n", is_nlgeom=is_nlgeom))
    assert result[3][2] == pytest.approx(-2 * GAP * SPRING, rel=EQUAL)


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize(("step", "ways"), [(0.01, (0.6, -0.3)), (0.5, (-0.1, 0.3)), (0.02, (-0.099, 0.3)), (0.01, (-0.101, 0.3))])
def test_driven_sheets(run_deck: Run, tmp_path: Path, step: float, ways: tuple[float, float], *, is_nlgeom: bool) -> None:
    """Two steps, in short increments or long ones: the job ends where the sheets pass each other, not where they part after a near approach, and not where
    one is deeper in the other by less than a crossing."""
    supports = f"900, 1, 6\n901, 1, 2\n901, 3, 3, {ways[0]}\n901, 4, 6\n"
    text = deck("sheet", "sheet", supports=supports, loads="900, 1, 6\n", is_nlgeom=is_nlgeom).replace("0.5, 1.\n", f"{step}, 1., {step}, {step}\n")
    second = f"*STEP, INC=1000{', NLGEOM' if is_nlgeom else ''}\n*STATIC\n{step}, 1., {step}, {step}\n*BOUNDARY\n901, 3, 3, {ways[1]}\n*END STEP\n"
    done = run_deck(text.replace("*STEP", "*STEP, INC=1000", 1).replace("INC=1000, NLGEOM", "NLGEOM, INC=1000") + second)
    assert done.returncode == (NOT_CONVERGED if ways[1] < 0 else 0), done.stdout
    assert ("passed through element" in done.stdout) is (ways[1] < 0)


def test_driven_bodies_that_overlap(run_deck: Run, tmp_path: Path) -> None:
    """Bodies that overlap at the start are not driven into each other."""
    supports = f"900, 1, 6\n901, 1, 2\n901, 3, 3, {-GAP}\n901, 4, 6\n"
    text = deck(supports=supports, loads="900, 1, 6\n").replace(f", {1 + GAP}\n", f", {1 - GAP}\n")
    result, _ = solve(run_deck, tmp_path, text)
    assert result[3][2] == pytest.approx(-GAP * SPRING, rel=EQUAL)


def test_one_body(run_deck: Run, tmp_path: Path) -> None:
    """Two meshes of one rigid body do not touch, and there is nothing to say."""
    text = deck(supports="901, 1, 2\n901, 4, 6\n900, 1, 6\n")
    text = text.replace("*RIGID BODY, ELSET=LOWER, REF NODE=900\n*RIGID BODY, ELSET=UPPER", "*ELSET, ELSET=BOTH\nLOWER, UPPER\n*RIGID BODY, ELSET=BOTH")
    result, said = solve(run_deck, tmp_path, text)
    assert "General contact: 0 pairs of 2 meshed bodies." in said
    assert result[1][2] == pytest.approx(-LOAD / SPRING, rel=EQUAL)


def test_squares(run_deck: Run, tmp_path: Path) -> None:
    """The same in the plane, with a thickness of 2: three supports drive the lower body, the upper one is free upwards."""
    text = f"*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, .3\n"
    for name, first, low, high in (("LOWER", 1, 0.0, 1.0), ("UPPER", 11, 1 + GAP, 2 + GAP)):
        left, right = (-0.2, 1.3) if name == "LOWER" else (0.0, 1.0)
        corners = ((left, low), (right, low), (right, high), (left, high))
        text += "*NODE\n" + "".join(f"{first + i}, {x}, {y}\n" for i, (x, y) in enumerate(corners))
        text += f"*ELEMENT, TYPE=CPE4, ELSET={name}\n{first}, {first}, {first + 1}, {first + 2}, {first + 3}\n"
        text += f"*SOLID SECTION, ELSET={name}, MATERIAL=M\n2.\n"
    text += "*NODE\n900, .5, .5\n901, .5, 1.6\n*NSET, NSET=BODIES\n900, 901\n"
    text += "*RIGID BODY, ELSET=LOWER, REF NODE=900\n*RIGID BODY, ELSET=UPPER, REF NODE=901\n" + springs(901, 500, 2, SPRING)
    text += "*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n*STEP\n*STATIC\n*BOUNDARY\n900, 1, 2\n900, 6\n901, 1\n901, 6\n"
    text += f"*CLOAD\n901, 2, {-LOAD}\n*NODE PRINT, NSET=BODIES\nU, RF\n*END STEP\n"
    result, _ = solve(run_deck, tmp_path, text)
    force = (LOAD - SPRING * GAP) / (1 + SPRING / (100 * YOUNG * 2))
    assert result[2][1] == pytest.approx(force, rel=EQUAL)
    assert result[1][1] == pytest.approx(-(LOAD - force) / SPRING, rel=EQUAL)


@pytest.mark.parametrize("has_pair", [True, False])
def test_rigid_edge(run_deck: Run, *, has_pair: bool) -> None:
    """Rigid edges are not on the exterior: general contact requires a pair by hand, unless there is one."""
    text = f"*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, .3\n*NODE\n1, 0., 0.\n2, 1., 0.\n3, 1., 1.\n4, 0., 1.\n"
    text += "11, -.5, 1.05\n12, 1.5, 1.05\n900, .5, 1.5\n*ELEMENT, TYPE=CPE4, ELSET=BLOCK\n1, 1, 2, 3, 4\n"
    text += "*SOLID SECTION, ELSET=BLOCK, MATERIAL=M\n1.\n*ELEMENT, TYPE=R2D2, ELSET=EDGE\n11, 11, 12\n*RIGID BODY, ELSET=EDGE, REF NODE=900\n"
    if has_pair:
        text += "*SURFACE, NAME=TOP\nBLOCK, S3\n*SURFACE, NAME=SOLE\nEDGE, SNEG\n*SURFACE INTERACTION, NAME=I\n"
        text += "*CONTACT PAIR, INTERACTION=I\nTOP, SOLE\n"
    text += "*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n*STEP\n*STATIC\n*BOUNDARY\n1, 1, 2\n2, 1, 2\n900, 1\n900, 6\n900, 2, 2, -.1\n*END STEP\n"
    done = run_deck(text)
    said = re.sub(r"\s+", " ", done.stdout + done.stderr)
    assert done.returncode == 0, said
    assert ("*WARNING: General contact does not find rigid edges (R2D2, RAX2), as element 11" in said) is not has_pair


def test_analytic_surface(run_deck: Run, tmp_path: Path) -> None:
    """A rigid plane of TYPE=REVOLUTION, pressed by a force against a spring, on a rigid block."""
    text = f"*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, .3\n" + body("LOWER", "solid", 1, 2, 0.0, 1.0, (0.0, 1.0))
    text += f"*NODE\n900, .5, .5, .5\n901, .5, .5, {1 + GAP}\n*NSET, NSET=BODIES\n900, 901\n"
    text += "*RIGID BODY, ELSET=LOWER, REF NODE=900\n"
    text += f"*SURFACE, NAME=TOOL, TYPE=REVOLUTION\n.5, .5, {1 + GAP}, .5, .5, {2 + GAP}\nSTART, 2., 0.\nLINE, 0., 0.\n"
    text += "*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=901\n" + springs(901, 500, 3, SPRING)
    text += "*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n*STEP\n*STATIC\n*BOUNDARY\n" + HELD
    text += f"*CLOAD\n901, 3, {-LOAD}\n*NODE PRINT, NSET=BODIES\nU, RF\n*END STEP\n"
    result, said = solve(run_deck, tmp_path, text)
    force = (LOAD - SPRING * GAP) / (1 + SPRING / (100 * YOUNG * 2))
    assert "General contact: 1 pair of 1 meshed bodies" in said, said
    assert result[2][2] == pytest.approx(force, rel=EQUAL)


@pytest.mark.parametrize("is_nlgeom", [False, True])
def test_driven_analytic_surface(run_deck: Run, tmp_path: Path, *, is_nlgeom: bool) -> None:
    """Supports prescribe the motion of the plane and of the block: no pair, and the list says so. The job ends if they meet."""
    text = f"*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, .3\n" + body("LOWER", "solid", 1, 2, 0.0, 1.0, (0.0, 1.0))
    text += f"*NODE\n900, .5, .5, .5\n901, .5, .5, {1 + GAP}\n*NSET, NSET=BODIES\n900, 901\n"
    text += "*RIGID BODY, ELSET=LOWER, REF NODE=900\n"
    text += f"*SURFACE, NAME=TOOL, TYPE=REVOLUTION\n.5, .5, {1 + GAP}, .5, .5, {2 + GAP}\nSTART, 2., 0.\nLINE, 0., 0.\n"
    text += "*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=901\n*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n"
    text += f"*STEP{', NLGEOM' if is_nlgeom else ''}\n*STATIC\n.1, 1., , .1\n*BOUNDARY\n900, 1, 6\n901, 1, 2\n901, 3, 3, {{}}\n901, 4, 6\n"
    text += "*NODE PRINT, NSET=BODIES\nU, RF\n*END STEP\n"
    result, said = solve(run_deck, tmp_path, text.format(-0.9 * GAP))
    assert "0 pairs of 1 meshed bodies: " + NO_PAIR.format("LOWER", "TOOL") in said
    assert result[2][2] == pytest.approx(0, abs=1e-9)
    done = run_deck(text.format(-2 * GAP))
    said = re.sub(r"\s+", " ", done.stdout + done.stderr)
    assert done.returncode == NOT_CONVERGED, said
    assert "of LOWER passed through TOOL, and no contact keeps them apart there. Supports prescribe the motion of both rigid bodies" in said
