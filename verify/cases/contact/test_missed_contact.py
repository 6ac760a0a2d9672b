"""General contact loses no contact: bodies touch, or the job says which two passed through each other and fails.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from itertools import product
from pathlib import Path

import pytest

from verify.conftest import Run

YOUNG = 1000.0
NOT_CONVERGED = 5  #: exit status of a job that ends early
ROUNDING = 1e-5  #: the .dat file has seven digits, a rigid element a millionth of depth
MATERIALS = f"*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, 0.\n"
GENERAL = "*CONTACT, TYPE={}\n*CONTACT INCLUSIONS, ALL EXTERIOR\n"
Point = tuple[float, float, float]


def grid(first: int, counts: tuple[int, int, int], low: Point, high: Point) -> tuple[str, dict[tuple[int, ...], int]]:
    """The nodes of a box, and the number of each by its place along the axes."""
    places = list(product(*(range(n + 1) for n in counts)))
    number = {place: first + k for k, place in enumerate(places)}
    lines = [[low[i] + (high[i] - low[i]) * place[i] / max(counts[i], 1) for i in range(3)] for place in places]
    return "*NODE\n" + "".join(f"{first + k}, {', '.join(map(str, x))}\n" for k, x in enumerate(lines)), number


def block(name: str, first: int, counts: tuple[int, int, int], low: Point, high: Point) -> str:
    """A box of C3D8 with node sets of its ends: NAME with X0, X1, Z0, Z1."""
    text, number = grid(first, counts, low, high)
    text += f"*ELEMENT, TYPE=C3D8, ELSET={name}\n"
    for k, (a, b, c) in enumerate(product(*map(range, counts))):
        corners = [number[a + i, b + j, c + h] for h in (0, 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
        text += f"{first + k}, {', '.join(map(str, corners))}\n"
    for axis, end in ((0, 0), (0, 1), (2, 0), (2, 1)):
        nodes = [label for place, label in number.items() if place[axis] == end * counts[axis]]
        text += f"*NSET, NSET={name}{'XYZ'[axis]}{end}\n" + "".join(f"{label},\n" for label in nodes)
    return text + f"*SOLID SECTION, ELSET={name}, MATERIAL=M\n"


def sheet(first: int, counts: tuple[int, int, int], low: Point, high: Point) -> str:
    """The sheet S of rigid elements, a box of which one side is zero; its reference node is 9000."""
    text, number = grid(first, counts, low, high)
    along = [i for i in range(3) if counts[i] > 0]
    text += "*ELEMENT, TYPE=R3D4, ELSET=S\n"
    for k, (a, b) in enumerate(product(range(counts[along[0]]), range(counts[along[1]]))):
        place = [0, 0, 0]
        corners = []
        for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)):
            place[along[0]], place[along[1]] = a + i, b + j
            corners.append(number[tuple(place)])
        text += f"{first + k}, {', '.join(map(str, corners))}\n"
    return text + f"*NODE\n9000, {', '.join(map(str, low))}\n*RIGID BODY, ELSET=S, REF NODE=9000\n"


def job(bodies: str, supports: str, *, is_nlgeom: bool, first_increment: float = 0.25, kind: str = "SURFACE TO SURFACE", rules: str = "",
        printed: str = "BZ0") -> str:  # fmt: skip
    """A deck of one step."""
    text = MATERIALS + bodies + GENERAL.format(kind) + rules + f"*STEP{', NLGEOM' if is_nlgeom else ''}, INC=50\n"
    text += f"*STATIC\n{first_increment}, 1.\n*BOUNDARY\n{supports}*NODE PRINT, NSET={printed}, TOTALS=ONLY\nRF\n*END STEP\n"
    return text


def force(folder: Path) -> float:
    """The last total force along z of the .dat file."""
    return float(re.findall(r"total force.*?\n\s*\n\s*\S+\s+\S+\s+(\S+)", (folder / "job.dat").read_text())[-1])


CUBE = block("B", 1, (4, 4, 4), (0, 0, 0), (1, 1, 1))
UPRIGHT = {  # a sheet that moves down into the top of the cube with its edge: as wide as it, or within it
    "wide": sheet(1001, (0, 2, 2), (0.45, -0.25, 1.05), (0.45, 1.25, 2.05)),
    "narrow": sheet(1001, (0, 6, 4), (0.45, 0.2, 1.05), (0.45, 0.8, 2.05)),
}
DOWN = "BZ0, 1, 3\n9000, 1, 2\n9000, 4, 6\n9000, 3, 3, {}\n"


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize(("way", "first"), [(0.1, 0.25), (0.5, 1.0), (2.5, 1.0)])
@pytest.mark.parametrize("width", UPRIGHT)
def test_edge_of_sheet(run_deck: Run, width: str, way: float, first: float, *, is_nlgeom: bool) -> None:
    """The edge of a sheet touches nothing: the job names both bodies and fails, even if the sheet is through in one increment."""
    done = run_deck(job(CUBE + UPRIGHT[width], DOWN.format(-way), is_nlgeom=is_nlgeom, first_increment=first))
    assert done.returncode == NOT_CONVERGED
    said = re.sub(r"\s+", " ", done.stdout + done.stderr)
    if (width, way, is_nlgeom) == ("narrow", 0.5, True):
        assert "LIMIT POINT: the stiffness is not positive" in said, "the sheet's sides touch on the way in, and no increment converges"
        assert "nothing holds" not in said, "its reference node holds the sheet"
        return
    crossing = r"element \d+ of (B passed through element \d+ of S|S passed through element \d+ of B),"
    assert re.search(crossing, said), said
    assert ("The edge of a sheet of rigid elements touches nothing" in said) or (not is_nlgeom and way > 0.25), said


@pytest.mark.parametrize("is_nlgeom", [False, True])
def test_body_against_edge(run_deck: Run, *, is_nlgeom: bool) -> None:
    """A body is moved into the edge of a sheet that lies."""
    lying = sheet(1001, (4, 4, 0), (1.05, -0.2, 0.55), (2.05, 1.2, 0.55))
    done = run_deck(job(CUBE + lying, "BX0, 2, 3\nBX0, 1, 1, 0.3\n9000, 1, 6\n", is_nlgeom=is_nlgeom))
    assert done.returncode == NOT_CONVERGED
    assert "no contact keeps them apart" in re.sub(r"\s+", " ", done.stdout + done.stderr)


@pytest.mark.parametrize("is_nlgeom", [False, True])
def test_excluded_sheet(run_deck: Run, *, is_nlgeom: bool) -> None:
    """Bodies that are named in the exclusions may pass each other."""
    rules = "*SURFACE, NAME=CUBE\nB,\n*SURFACE, NAME=SIDES\nS, SPOS\nS, SNEG\n"
    deck = job(CUBE + UPRIGHT["narrow"] + rules, DOWN.format(-0.5), is_nlgeom=is_nlgeom, rules="*CONTACT EXCLUSIONS\nCUBE, SIDES\n")
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr


def test_sheet_between_bodies(run_deck: Run, tmp_path: Path) -> None:
    """A body pushes an upright sheet sideways onto another one: both cubes share what the gaps leave of the way, k = E A / l."""
    gap, way = 0.05, 0.15
    bodies = block("B", 1, (2, 2, 2), (0, 0, 0), (1, 1, 1)) + block("D", 201, (2, 2, 2), (1 + 2 * gap, 0, 0), (2 + 2 * gap, 1, 1))
    bodies += sheet(1001, (0, 4, 4), (1 + gap, -0.2, -0.2), (1 + gap, 1.2, 1.2))
    supports = f"BX0, 2, 3\nBX0, 1, 1, {way}\nDX1, 1, 3\n9000, 2, 6\n"
    done = run_deck(job(bodies, supports, is_nlgeom=False, printed="DX1"))
    assert done.returncode == 0, done.stdout + done.stderr
    pushed = re.findall(r"total force.*?\n\s*\n\s*(\S+)", (tmp_path / "job.dat").read_text())[-1]
    assert float(pushed) == pytest.approx(-YOUNG / 2 * (way - 2 * gap), rel=ROUNDING)


RIGID = "*NODE\n9000, .5, .5, 0.\n*RIGID BODY, ELSET=B, REF NODE=9000\n"


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize("kind", ["SURFACE TO SURFACE", "NODE TO SURFACE"])
def test_fine_master(run_deck: Run, tmp_path: Path, kind: str, *, is_nlgeom: bool) -> None:
    """A coarse cube comes from seven edges of a fine rigid master: beyond three of them, within three of its own. F = E A d / l."""
    gap, depth = 0.5, 0.003
    bodies = block("B", 1, (20, 20, 1), (-0.2, -0.2, 0), (1.2, 1.2, 0.2)) + RIGID
    bodies += block("U", 5001, (1, 1, 1), (0, 0, 0.2 + gap), (1, 1, 1.2 + gap))
    supports = f"9000, 1, 6\nUZ1, 1, 2\nUZ1, 3, 3, {-gap - depth}\n"
    done = run_deck(job(bodies, supports, is_nlgeom=is_nlgeom, kind=kind, printed="UZ1"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert force(tmp_path) == pytest.approx(-YOUNG * depth, rel=4 * depth if is_nlgeom else ROUNDING), "NLGEOM: E times a larger strain"


@pytest.mark.parametrize("is_nlgeom", [False, True])
def test_post_between_slave_nodes(run_deck: Run, tmp_path: Path, *, is_nlgeom: bool) -> None:
    """A rigid post passes between the nodes of a coarse slave: contact at nodes cannot see it and says so, mortar contact can."""
    bodies = block("B", 1, (10, 10, 1), (0.3, 0.3, 0), (0.7, 0.7, 0.2)) + RIGID
    bodies += block("U", 5001, (1, 1, 1), (0, 0, 0.22), (1, 1, 1.22))
    supports = "9000, 1, 6\nUZ1, 1, 2\nUZ1, 3, 3, -0.05\n"
    done = run_deck(job(bodies, supports, is_nlgeom=is_nlgeom, kind="NODE TO SURFACE"))
    assert done.returncode == NOT_CONVERGED
    assert "TYPE=SURFACE TO SURFACE looks at their faces" in re.sub(r"\s+", " ", done.stdout + done.stderr)
    done = run_deck(job(bodies, supports, is_nlgeom=is_nlgeom, printed="UZ1"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert force(tmp_path) == pytest.approx(-YOUNG * 0.03, rel=0.1), "the face is held in the mean"


@pytest.mark.parametrize("is_nlgeom", [False, True])
def test_long_way(run_deck: Run, tmp_path: Path, *, is_nlgeom: bool) -> None:
    """From beyond the search a body comes with NLGEOM; without it the job does not end as if there were nothing between."""
    gap, depth = 1.5, 0.003
    bodies = CUBE + block("U", 5001, (4, 4, 4), (0, 0, 1 + gap), (1, 1, 2 + gap))
    way = gap + (2 * depth if is_nlgeom else 0.1)
    done = run_deck(job(bodies, f"BZ0, 1, 3\nUZ1, 1, 2\nUZ1, 3, 3, {-way}\n", is_nlgeom=is_nlgeom, printed="UZ1"))
    if is_nlgeom:
        assert done.returncode == 0, done.stdout + done.stderr
        assert force(tmp_path) == pytest.approx(-YOUNG * depth, rel=4 * depth), "of two cubes"
    else:
        assert done.returncode == NOT_CONVERGED
        assert "give NLGEOM on *STEP" in re.sub(r"\s+", " ", done.stdout + done.stderr)


@pytest.mark.parametrize("is_nlgeom", [False, True])
def test_soft_contact_at_a_border(run_deck: Run, *, is_nlgeom: bool) -> None:
    """A body is pressed in by a fifth of an edge, as its soft law allows, over the border of the other one: nothing passed through."""
    bodies = CUBE + block("U", 5001, (3, 3, 3), (0.35, 0.2, 1), (0.95, 0.8, 1.6)) + block("V", 6001, (3, 3, 3), (-0.35, 0.2, 1), (0.25, 0.8, 1.6))
    bodies += "*SURFACE INTERACTION, NAME=SOFT\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n200.\n"
    supports = "BZ0, 1, 3\nUZ1, 1, 2\nUZ1, 3, 3, -0.05\nVZ1, 1, 2\nVZ1, 3, 3, -0.05\n"
    rules = "*CONTACT PROPERTY ASSIGNMENT\n, , SOFT\n"
    done = run_deck(job(bodies, supports, is_nlgeom=is_nlgeom, rules=rules))
    assert done.returncode == 0, done.stdout + done.stderr


def pair_job(bodies: str, supports: str, *, increment: float = 0.25, cards: str = "", changed: str = "", is_nlgeom: bool = True) -> str:
    """A deck with a pair by hand, node to surface: the bottom of U, the slave, and the top of B, bodies of one layer."""
    text = MATERIALS + bodies + "*SURFACE, NAME=SU\nU, S1\n*SURFACE, NAME=SB\nB, S2\n*SURFACE INTERACTION, NAME=I\n"
    text += "*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE\nSU, SB\n" + cards + f"*STEP{', NLGEOM' if is_nlgeom else ''}, INC=50\n"
    return text + f"*STATIC\n{increment}, 1.\n{changed}*BOUNDARY\n{supports}*END STEP\n"


def post(gap: float) -> str:
    """A narrow post B below the single face of U."""
    low = 0.2 + gap
    return block("B", 1, (10, 10, 1), (0.3, 0.3, 0), (0.7, 0.7, 0.2)) + block("U", 5001, (1, 1, 1), (0, 0, low), (1, 1, 1 + low))


HELD_POST = "BZ0, 1, 3\nUZ1, 1, 2\nUZ1, 3, 3, {}\n"
REMOVED = "*STEP, NLGEOM\n*STATIC\n.25, 1.\n*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nSU, SB\n*BOUNDARY\n" + HELD_POST.format(-0.06) + "*END STEP\n"
ADDED = "*MODEL CHANGE, TYPE=CONTACT PAIR, ADD\nSU, SB\n"


@pytest.mark.parametrize(("way", "increment"), [(0.06, 0.25), (0.4, 0.25), (0.4, 1.0)])
def test_post_in_a_pair(run_deck: Run, way: float, increment: float) -> None:
    """The post passes between the nodes of a slave by hand, to a depth, right through, or through in one increment: the job says so."""
    done = run_deck(pair_job(post(0.02), HELD_POST.format(-way), increment=increment))
    assert done.returncode == NOT_CONVERGED
    said = re.sub(r"\s+", " ", done.stdout + done.stderr)
    assert re.search(r"Contact pair SU / SB: element \d+ of (B passed through element \d+ of U|U passed through element \d+ of B),", said), said
    assert "*CONTACT PAIR, TYPE=SURFACE TO SURFACE looks at their faces" in said


PERMITTED = {
    "overlap at the start": pair_job(post(-0.03), HELD_POST.format(-0.05)),
    "clearance": pair_job(post(0.02), HELD_POST.format(-0.05), cards="*CLEARANCE, SLAVE=SU, MASTER=SB, VALUE=0.5\n"),
    "removed": pair_job(post(0.02), HELD_POST.format(-0.06), cards=REMOVED),
    "added again": pair_job(post(0.02), HELD_POST.format(-0.07), cards=REMOVED, changed=ADDED),
    "no pair": pair_job(post(0.02), HELD_POST.format(-0.05)).replace("*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE\nSU, SB\n", ""),
}


@pytest.mark.parametrize("reason", PERMITTED)
def test_permitted_crossings(run_deck: Run, reason: str) -> None:
    """Bodies may pass where they overlap at the start, by a clearance, while their pair is removed and after that, and without a pair."""
    done = run_deck(PERMITTED[reason])
    assert done.returncode == 0, done.stdout + done.stderr


def pressed(way: float, *, is_nlgeom: bool, nodes: str = "UZ0") -> str:
    """A smaller block U that supports drive, all its nodes or those given at the bottom, into B."""
    bodies = block("B", 1, (4, 4, 1), (0, 0, 0), (1, 1, 0.5)) + block("U", 5001, (2, 2, 1), (0.2, 0.2, 0.52), (0.8, 0.8, 0.82))
    supports = "BZ0, 1, 3\n" + "".join(f"{nodes_of}, 1, 2\n{nodes_of}, 3, 3, {-way}\n" for nodes_of in (*nodes.split(), "UZ1"))
    return pair_job(bodies, supports, is_nlgeom=is_nlgeom)


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize(("nodes", "way"), [("UZ0", 0.1), ("UZ0", 0.03), ("UZ0", 0.0205), ("5001 5003 5005", 0.1)])
def test_driven_slaves(run_deck: Run, nodes: str, way: float, *, is_nlgeom: bool) -> None:
    """Supports drive all slave nodes into the master, far or a little, or some beside others that touch: the node and its depth are named."""
    done = run_deck(pressed(way, is_nlgeom=is_nlgeom, nodes=nodes))
    assert done.returncode == NOT_CONVERGED
    said = re.sub(r"\s+", " ", done.stdout + done.stderr)
    assert re.search(r"Contact pair SU / SB: supports drive the slave node 500[135] by [\d.E-]+ behind its master", said), said


@pytest.mark.parametrize("is_nlgeom", [False, True])
def test_slave_driven_under_a_law(run_deck: Run, *, is_nlgeom: bool) -> None:
    """The remedy of that sentence: the force of a linear law acts on the master. Nor is a slave that stops before its master a fault."""
    law = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.e6\n"
    deck = pressed(0.03, is_nlgeom=is_nlgeom).replace("*SURFACE INTERACTION, NAME=I\n", "*SURFACE INTERACTION, NAME=I\n" + law)
    for text in (deck, pressed(0.019, is_nlgeom=is_nlgeom)):
        done = run_deck(text)
        assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize("kind", ["NODE TO SURFACE", "SURFACE TO SURFACE"])
def test_held_slaves(run_deck: Run, kind: str, *, is_nlgeom: bool) -> None:
    """All nodes of the slave are held and a free master is pressed into it by its far side: no contact pushes it back. Where some slave nodes are held and others
    carry, nothing is wrong."""
    bodies = block("B", 1, (4, 4, 1), (0, 0, 0), (1, 1, 0.5)) + block("U", 5001, (2, 2, 1), (0.2, 0.2, 0.52), (0.8, 0.8, 0.82))
    come = "BZ0, 1, 2\nBZ0, 3, 3, {way}\n"
    for way, supports in ((0.05, "UZ0, 1, 3\nUZ1, 1, 3\n"), (0.0205, "UZ0, 1, 3\nUZ1, 1, 3\n")):
        done = run_deck(pair_job(bodies, supports + come.format(way=way), is_nlgeom=is_nlgeom).replace("NODE TO SURFACE", kind))
        said = re.sub(r"\s+", " ", done.stdout + done.stderr)
        assert done.returncode == NOT_CONVERGED, said
        assert re.search(r"Contact pair SU / SB: supports hold the slave node 50\d\d by [\d.E-]+ behind its master, and exact contact cannot push", said), said
    for supports in ("UZ0, 1, 3\nUZ1, 1, 3\n" + come.format(way=0.019), "5001, 1, 3\nUZ1, 1, 3\n" + come.format(way=0.0205)):
        done = run_deck(pair_job(bodies, supports, is_nlgeom=is_nlgeom).replace("NODE TO SURFACE", kind))
        assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize("has_wall", [False, True])
def test_held_slaves_beside_another_contact(run_deck: Run, *, has_wall: bool, is_nlgeom: bool) -> None:
    """A free block of one element is pressed into the held slave U above it, and by its own width against a wall beside it, too: that contact loads the nodes of
    the same master face, but does not keep it from U."""
    bodies = block("B", 1, (1, 1, 1), (0, 0, 0), (1, 1, 0.5)) + block("U", 5001, (2, 2, 1), (0.2, 0.2, 0.52), (0.8, 0.8, 0.82))
    bodies += block("W", 7001, (1, 2, 2), (1, -0.2, -0.2), (1.2, 1.2, 0.7))
    text = pair_job(bodies, "UZ0, 1, 3\nUZ1, 1, 3\nWX1, 1, 3\nBX0, 2, 2\nBX0, 1, 1, {}\nBZ0, 3, 3, 0.05\n".format(0.01 if has_wall else 0.0), is_nlgeom=is_nlgeom)
    wall = "*SURFACE, NAME=SR\nB, S4\n*SURFACE, NAME=SW\nW, S6\n*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE\nSR, SW\n*STEP"
    done = run_deck(text.replace("*STEP", wall))
    said = re.sub(r"\s+", " ", done.stdout + done.stderr)
    assert done.returncode == NOT_CONVERGED, said
    assert "Contact pair SU / SB: supports hold the slave node" in said, said


KINDS = {
    f"{'general' if general else 'pair'}, {kind.lower()}": GENERAL.format(kind)
    if general
    else f"*SURFACE, NAME=SU\nU, S1\n*SURFACE, NAME=SB\nB, S2\n*SURFACE INTERACTION, NAME=I\n*CONTACT PAIR, INTERACTION=I, TYPE={kind}\nSU, SB\n"
    for general, kind in product((True, False), ("NODE TO SURFACE", "SURFACE TO SURFACE"))
}
ALL_HELD = "BZ0, 1, 3\nBZ1, 1, 3\n"
ALL_DOWN = "UZ0, 1, 2\nUZ0, 3, 3, -{way}\nUZ1, 1, 2\nUZ1, 3, 3, -{way}\n"
PILOT = "*NODE\n9000, .5, .5, .8\n"
PILOT_DOWN = "9000, 1, 2\n9000, 4, 6\n9000, 3, 3, -{way}\n"
RIGID_U = PILOT + "*RIGID BODY, ELSET=U, REF NODE=9000\n"
RIGID_B = "*NODE\n9001, .5, .5, 0.\n*RIGID BODY, ELSET=B, REF NODE=9001\n"
EQUATIONS = PILOT + "".join(f"*EQUATION\n2\n{n}, {i}, 1., 9000, {i}, -1.\n" for n in range(5001, 5019, 2) for i in (1, 2, 3))
COUPLING = PILOT + "*SURFACE, NAME=SOLE\nU, S1\n*COUPLING, CONSTRAINT NAME=C, REF NODE=9000, SURFACE=SOLE\n*KINEMATIC\n1, 3\n"
TURNED = "*TRANSFORM, NSET=UZ0\n.6, 0., .8, 0., 1., 0.\n"  # its supports are rows of two unknowns
DRIVEN = {  # cards, and the supports that bring U down or B up
    "all nodes": ("", ALL_HELD + ALL_DOWN),
    "the master comes": ("", "BZ0, 1, 2\nBZ0, 3, 3, {way}\nBZ1, 1, 2\nBZ1, 3, 3, {way}\nUZ0, 1, 3\nUZ1, 1, 3\n"),
    "facing nodes": ("", "BZ1, 1, 3\nUZ0, 1, 2\nUZ0, 3, 3, -{way}\n"),
    "facing nodes by local axes": (TURNED, "BZ1, 1, 3\nUZ0, 2, 2\nUZ0, 1, 1, -{local[0]}\nUZ0, 3, 3, -{local[1]}\n"),
    "a rigid body on nodes": (RIGID_U, ALL_HELD + PILOT_DOWN),
    "nodes on a rigid body": (RIGID_B, "9001, 1, 6\n" + ALL_DOWN),
    "a rigid body under nodes": (RIGID_B, "9001, 1, 2\n9001, 4, 6\n9001, 3, 3, {way}\nUZ0, 1, 3\nUZ1, 1, 3\n"),
    "equations": (EQUATIONS, ALL_HELD + "UZ1, 1, 3\n9000, 1, 2\n9000, 3, 3, -{way}\n"),
    "a coupling": (COUPLING, ALL_HELD + PILOT_DOWN),
}


def both_driven(kind: str, how: str, way: float, *, is_nlgeom: bool, gap: float = 0.02, law: str = "") -> str:
    """Supports prescribe the motion of both bodies where they face each other."""
    cards, supports = DRIVEN[how]
    bodies = block("B", 1, (4, 4, 1), (0, 0, 0), (1, 1, 0.5)) + block("U", 5001, (2, 2, 1), (0.2, 0.2, 0.5 + gap), (0.8, 0.8, 0.8 + gap))
    contact = KINDS[kind]
    if law and "general" in kind:
        contact = f"*SURFACE INTERACTION, NAME=I\n{law}" + contact + "*CONTACT PROPERTY ASSIGNMENT\n, , I\n"
    elif law:
        contact = contact.replace("NAME=I\n*CONTACT", f"NAME=I\n{law}*CONTACT")
    text = MATERIALS + bodies + cards + contact + f"*STEP{', NLGEOM' if is_nlgeom else ''}, INC=50\n*STATIC\n.25, 1.\n"
    return text + "*BOUNDARY\n" + supports.format(way=way, local=(0.8 * way, 0.6 * way)) + "*END STEP\n"


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize("how", DRIVEN)
@pytest.mark.parametrize("kind", KINDS)
def test_both_driven(run_deck: Run, kind: str, how: str, *, is_nlgeom: bool) -> None:
    """No contact can keep bodies apart that supports drive into each other: the job names node, depth and remedy. Before they meet nothing is wrong."""
    for way in (0.0205, 0.1):
        done = run_deck(both_driven(kind, how, way, is_nlgeom=is_nlgeom))
        said = re.sub(r"\s+", " ", done.stdout + done.stderr)
        assert done.returncode == NOT_CONVERGED, said
        node = re.search(r"Contact pair \S+ / \S+: supports drive the slave node \d+ by ([\d.E-]+) behind its master, whose motion they prescribe, too", said)
        assert node, said
        assert way != 0.0205 or float(node[1]) == pytest.approx(way - 0.02, rel=0.02), "the depth is named"
        assert ("named in *CONTACT EXCLUSIONS" if "general" in kind else "need no *CONTACT PAIR") in said
    done = run_deck(both_driven(kind, how, 0.019, is_nlgeom=is_nlgeom))
    assert done.returncode == 0, done.stdout + done.stderr


LAW = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.e5\n"


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_both_driven_by_right(run_deck: Run, kind: str, *, is_nlgeom: bool) -> None:
    """A law of the deck has a force for any depth; bodies that overlap at the start, or that supports move as one, are not driven into each other."""
    together = both_driven(kind, "all nodes", 0.3, is_nlgeom=is_nlgeom, gap=-0.02).replace("BZ0, 1, 3\nBZ1, 1, 3\n", ALL_DOWN.format(way=0.3).replace("UZ", "BZ"))
    allowed = {
        "law": both_driven(kind, "all nodes", 0.03, is_nlgeom=is_nlgeom, law=LAW),
        "overlap": both_driven(kind, "all nodes", 0.0, is_nlgeom=is_nlgeom, gap=-0.02),
        "overlap that grows": both_driven(kind, "all nodes", 0.01, is_nlgeom=is_nlgeom, gap=-0.02),
        "moved as one": together,
    }
    for why, deck in allowed.items():
        done = run_deck(deck)
        assert done.returncode == 0, why + done.stdout + done.stderr


PLANE = (
    "*NODE\n9001, .5, .5, 0.\n*SURFACE, NAME=TOOL, TYPE=REVOLUTION\n.5, .5, .5, .5, .5, 1.5\nSTART, 0., 0.\nLINE, 2., 0.\n"
    "*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=9001\n"
)
TOOL = {
    "the nodes": ("9001, 1, 6\n" + ALL_DOWN, 0.05),
    "the tool": ("9001, 1, 2\n9001, 4, 6\n9001, 3, 3, {way}\nUZ0, 1, 3\nUZ1, 1, 3\n", 0.05),
    "the tool, turned": ("9001, 1, 3\n9001, 5, 6\n9001, 4, 4, {way}\nUZ0, 1, 3\nUZ1, 1, 3\n", 0.2),
}


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize("how", TOOL)
@pytest.mark.parametrize("kind", KINDS)
def test_driven_on_an_analytic_master(run_deck: Run, kind: str, how: str, *, is_nlgeom: bool) -> None:
    """The same against an analytic plane, which supports hold, move or turn; a tenth of the way is less than the gap."""
    supports, way = TOOL[how]
    contact = KINDS[kind].replace("*SURFACE, NAME=SB\nB, S2\n", "").replace("SU, SB", "SU, TOOL")
    deck = MATERIALS + block("U", 5001, (2, 2, 1), (0.2, 0.2, 0.52), (0.8, 0.8, 0.82)) + PLANE + contact
    deck += f"*STEP{', NLGEOM' if is_nlgeom else ''}, INC=50\n*STATIC\n.25, 1.\n*BOUNDARY\n{supports}*END STEP\n"
    done = run_deck(deck.format(way=way))
    said = re.sub(r"\s+", " ", done.stdout + done.stderr)
    assert done.returncode == NOT_CONVERGED, said
    assert re.search(r"supports drive the slave node 50\d\d by [\d.E-]+ behind its master, whose motion they prescribe, too", said), said
    done = run_deck(deck.format(way=way / 10))
    assert done.returncode == 0, done.stdout + done.stderr


def slotted(way: float) -> str:
    """A body with a slot of 0.05 whose upper lip supports move down."""
    heights = (0.0, 0.45, 0.5, 0.95)
    number = {place: k + 1 for k, place in enumerate(product(range(4), range(2), range(4)))}
    text = "*NODE\n" + "".join(f"{k}, {0.4 * a}, {0.4 * b}, {heights[c]}\n" for (a, b, c), k in number.items()) + "*ELEMENT, TYPE=C3D8, ELSET=C\n"
    for k, (a, c) in enumerate((a, c) for a, c in product(range(3), range(3)) if a == 0 or c != 1):
        corners = [number[a + i, j, c + h] for h in (0, 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
        text += f"{k + 1}, {', '.join(map(str, corners))}\n"
    lip = [label for (a, _, c), label in number.items() if a >= 2 and c >= 2]
    text += "*SOLID SECTION, ELSET=C, MATERIAL=M\n*BOUNDARY\n" + "".join(f"{label}, 1, 3\n" for label in number.values() if label not in lip)
    return text + "".join(f"{label}, 1, 2\n{label}, 3, 3, {-way}\n" for label in lip)


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_driven_on_itself(run_deck: Run, kind: str, *, is_nlgeom: bool) -> None:
    """The lips of a slot, all of whose nodes supports move, in self contact."""
    contact = KINDS[kind]
    if "pair" in kind:
        contact = "*SURFACE, NAME=SU\nC,\n" + contact.split("SB\nB, S2\n")[1].replace("SU, SB", "SU,")
    for way, expected in ((0.06, NOT_CONVERGED), (0.045, 0)):
        nodes, supports = slotted(way).split("*BOUNDARY\n")
        deck = MATERIALS + nodes + contact + f"*STEP{', NLGEOM' if is_nlgeom else ''}, INC=50\n*STATIC\n.25, 1.\n*BOUNDARY\n{supports}*END STEP\n"
        done = run_deck(deck)
        said = re.sub(r"\s+", " ", done.stdout + done.stderr)
        assert done.returncode == expected, said
        assert ("behind its master, whose motion they prescribe, too" in said) is (expected != 0), said


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize("kind", ["NODE TO SURFACE", "SURFACE TO SURFACE"])
@pytest.mark.parametrize("count", [1, 2])
def test_coarse_stack(run_deck: Run, tmp_path: Path, count: int, kind: str, *, is_nlgeom: bool) -> None:
    """A block lies on another one, to one side, each of one or two elements: the sole is the only slave, and the force is that of the pair by hand. The side faces
    oppose each other as far as an element is deep, but lie beside each other."""
    bodies = block("B", 1, (1, 1, 1), (0, 0, 0), (1, 1, 0.8)) + block("U", 5001, (count, 1, 1), (-0.2, -0.1, 0.8), (0.6, 0.9, 1.6))
    deck = job(bodies, "BZ0, 1, 3\nUX0, 1, 1\nUZ1, 2, 2\nUZ1, 3, 3, -0.001\n", is_nlgeom=is_nlgeom, kind=kind)
    by_hand = "*SURFACE, NAME=SU\nU, S1\n*SURFACE, NAME=SB\nB, S2\n*SURFACE INTERACTION, NAME=I\n"
    by_hand = deck.replace(GENERAL.format(kind), by_hand + f"*CONTACT PAIR, INTERACTION=I, TYPE={kind}\nSU, SB\n")
    forces = []
    for text in (deck, by_hand):
        done = run_deck(text)
        said = re.sub(r"\s+", " ", done.stdout + done.stderr)
        assert done.returncode == 0, said
        assert text is by_hand or "1 pair of 2 meshed bodies: slave U#" in said, said
        forces.append(force(tmp_path))
    assert forces[0] == pytest.approx(forces[1], rel=ROUNDING)
    assert forces[0] > 0.0
