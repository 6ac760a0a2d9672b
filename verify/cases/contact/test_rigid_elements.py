"""Rigid elements R3D3, R3D4, R2D2 and RAX2 as masters of contact.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from verify.cases.proof import Case, Job
from verify.conftest import Run
from verify.decks.make_decks import Mesh, block
from verify.decks.sheets import fix, pair, solid_deck, step

Proof = Callable[..., Case]
YOUNG, NU, PILOT = 1000.0, 0.3, 9001
FIRST = 5001  #: label of the first rigid node and element
TYPES = {"node to surface": "", "surface to surface": ", TYPE=SURFACE TO SURFACE"}
RIGID = f"*NODE\n{PILOT}, 0.5, 0.5, 2.\n{PILOT + 1}, 0.5, 0.5, 3.\n*RIGID BODY, ELSET=UP, REF NODE={PILOT}, ROT NODE={PILOT + 1}\n"


def cube(n: int) -> Mesh:
    """The body that is pressed."""
    line = np.linspace(0, 1, n + 1)
    low = block(line, line, line, "LOW")
    low.select("FLOOR", lambda x: x[:, 2] < 1e-9)
    return low


def punch_lines(n: int) -> tuple[np.ndarray, np.ndarray]:
    """The punch overhangs along y and ends within the cube along x."""
    return np.linspace(0.1, 0.75, n + 1), np.linspace(-0.2, 1.2, n + 1)


def solid_punch(n: int) -> tuple[Mesh, str]:
    """The punch as a rigid body of solids: sole and both sides along x."""
    punch = block(*punch_lines(n), [1.0, 1.5], "UP")
    every = np.arange(n * n)
    punch.element_sets |= {"LEFT": every[every % n == 0], "RIGHT": every[every % n == n - 1]}
    punch.surfaces["PUNCH"] = [("UP_E1", 1), ("RIGHT", 4), ("LEFT", 6)]
    return punch, "PUNCH"


def rigid_punch(n: int, kind: str, side: str) -> tuple[str, str]:
    """The faces of the same punch as rigid elements: sole and both sides along x, folded; side is that of its outside."""
    x, y = punch_lines(n)
    profile = [(x[0], 1.5), *((value, 1.0) for value in x), (x[-1], 1.5)]
    nodes = [f"{FIRST + len(profile) * j + i}, {a:.15g}, {b:.15g}, {c:.15g}" for j, b in enumerate(y) for i, (a, c) in enumerate(profile)]
    cards = "*NODE\n" + "\n".join(nodes) + f"\n*ELEMENT, TYPE={kind}, ELSET=UP\n"
    label = FIRST
    for j in range(n):
        for i in range(len(profile) - 1):
            p = FIRST + len(profile) * j + i
            corners = [p, p + len(profile), p + len(profile) + 1, p + 1]   # the normal points out of the punch
            if side == "SNEG":
                corners.reverse()
            for element in [corners] if kind == "R3D4" else [corners[:3], [corners[0], *corners[2:]]]:
                cards += f"{label}, {', '.join(map(str, element))}\n"
                label += 1
    return cards, f"*SURFACE, NAME=PUNCH\nUP, {side}\n"


def steps(is_nlgeom: bool) -> str:
    """Down, then along and turned about z."""
    down = fix("FLOOR, 1, 3", f"{PILOT}, 1, 2", f"{PILOT}, 3, 3, -0.05", f"{PILOT}, 4, 6")
    turned = fix(f"{PILOT}, 2, 2, 0.02", f"{PILOT}, 6, 6, 0.05")
    return step(down, 2, is_nlgeom) + step(turned, 2, is_nlgeom)


@pytest.mark.parametrize("contact", TYPES)
@pytest.mark.parametrize("kind, side", [("R3D4", "SPOS"), ("R3D4", "SNEG"), ("R3D3", "SPOS")])
def test_punch(proof: Proof, kind: str, side: str, contact: str) -> None:
    """The same punch as rigid elements and as a rigid body of solids."""
    case = proof(
        f"rigid-elements-{kind.lower()}-{side.lower()}-{contact.split()[0]}",
        title=f"A punch of {kind}, {side}, {contact}",
        model="A cube of edge 1 (E = 1000, nu = 0.3, C3D8, fixed below, slave) under a flat punch that goes down by 0.05, along by 0.02 and turns by 0.05 about "
        "its axis, mu = 0.3, NLGEOM: of rigid elements, folded at its edges, and as a *RIGID BODY of C3D8; two meshes.",
        formula="The same contact: equal displacements, forces and moments at the reference node.",
        source="none needed",
        proves="Rigid elements as masters, their sides, motion and reactions of the reference node.",
    )
    for n in (3, 5):
        low = cube(n)
        solid, sole = solid_punch(n)
        one: Job = case.run(solid_deck([(low, (YOUNG, NU)), (solid, (YOUNG, NU))], RIGID + pair("LOW_TOP", sole, 0.3, TYPES[contact]), steps(True)), f"solid-{n}")
        mesh, surface = rigid_punch(n, kind, side)
        two: Job = case.run(solid_deck([(cube(n), (YOUNG, NU))], mesh + RIGID + surface + pair("LOW_TOP", "PUNCH", 0.3, TYPES[contact]), steps(True)), f"rigid-{n}")
        m = len(low.nodes)
        case.near(f"displacements, n = {n}", two.last("U")[:m], one.last("U")[:m], 1e-5, why="the tolerance of Newton's method, and the thickness of 1e-6",
                  place="all nodes of the cube", time="the end")  # fmt: skip
        floor = low.node_sets["FLOOR"]
        moved = [job.points.tolist().index([0.5, 0.5, 2.0]) for job in (one, two)]
        force = [np.asarray(job.last("RF")[k]) for job, k in zip((one, two), moved, strict=True)]
        case.near(f"force, n = {n}", force[1], force[0], 1e-4, why="the tolerance of Newton's method", place="reference node", time="the end")
        case.near(f"balance, n = {n}", force[1], -two.last("RF")[floor].sum(axis=0), 1e-6, why="equilibrium", place="reference node and floor", time="the end")
        turned = [job.points.tolist().index([0.5, 0.5, 3.0]) for job in (one, two)]
        moment = [np.asarray(job.last("RF")[k]) for job, k in zip((one, two), turned, strict=True)]
        case.near(f"moment, n = {n}", moment[1], moment[0], 1e-4, why="the tolerance of Newton's method", place="rotation node", time="the end")
        case.true(f"the punch turns, n = {n}", abs(float(moment[1][2])) > 1e-3, why="friction", place="rotation node", time="the end")
    case.done()


def refusal(run_deck: Run, cards: str, old: str = "", new: str = "", top: str = "") -> str:
    """What the job says of a deck that must be refused."""
    mesh, surface = rigid_punch(3, "R3D4", "SPOS")
    deck = solid_deck([(cube(3), (YOUNG, NU))], mesh + cards + surface + pair("LOW_TOP", "PUNCH"), steps(False))
    done = run_deck(top + (deck.replace(old, new) if old else deck))
    assert done.returncode == 3, done.stdout
    return done.stdout


def test_refused(run_deck: Run) -> None:
    """Rigid elements without a rigid body, with a section, of another kind, under the calculix dialect."""
    alone = f"*NODE\n{PILOT}, 0.5, 0.5, 2.\n"
    assert f"The rigid element {FIRST} belongs to no *RIGID BODY, ELSET=, REF NODE=." in refusal(run_deck, alone)
    section = RIGID + "*SHELL SECTION, ELSET=UP, MATERIAL=LOW\n0.1\n"
    assert f"The element {FIRST} is rigid and needs no section" in refusal(run_deck, section)
    assert "Rigid tools are R3D3, R3D4, in the plane R2D2, RAX2" in refusal(run_deck, RIGID, "TYPE=R3D4", "TYPE=RB3D2")
    assert "The element type R3D4 is not supported" in refusal(run_deck, RIGID, top="** dialect: calculix\n")


def test_explained(run_deck: Run) -> None:
    """--explain takes the card as it is."""
    mesh, surface = rigid_punch(3, "R3D4", "SPOS")
    deck = solid_deck([(cube(3), (YOUNG, NU))], mesh + RIGID + surface + pair("LOW_TOP", "PUNCH"), steps(False))
    done = run_deck(deck, "--explain")
    assert done.returncode == 0, done.stdout
    assert "TYPE=R3D4: used" in done.stdout, done.stdout


def plane_block(kind: str, n: int) -> str:
    """The unit square on the floor, from x = 0.5: nodes 1 on, set LOW, surface TOP, sets FLOOR."""
    nodes = "".join(f"{(n + 1) * j + i + 1}, {0.5 + i / n:.15g}, {j / n:.15g}\n" for j in range(n + 1) for i in range(n + 1))
    corners = [[(n + 1) * j + i + 1, (n + 1) * j + i + 2, (n + 1) * (j + 1) + i + 2, (n + 1) * (j + 1) + i + 1] for j in range(n) for i in range(n)]
    body = "".join(f"{e + 1}, {', '.join(map(str, nodes_of))}\n" for e, nodes_of in enumerate(corners))
    top = "".join(f"{n * (n - 1) + i + 1}, S3\n" for i in range(n))
    floor = "".join(f"{i + 1}\n" for i in range(n + 1))
    return (
        f"*NODE\n{nodes}*ELEMENT, TYPE={kind}, ELSET=LOW\n{body}*NSET, NSET=FLOOR\n{floor}*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, {NU}\n"
        f"*SOLID SECTION, ELSET=LOW, MATERIAL=M\n{'' if kind.startswith('CAX') else '1.' + chr(10)}*SURFACE, NAME=TOP\n{top}"
    )


@pytest.mark.parametrize("contact", TYPES)
@pytest.mark.parametrize("kind, side", [("R2D2", "SPOS"), ("R2D2", "SNEG"), ("RAX2", "SPOS")])
def test_plane_punch(proof: Proof, kind: str, side: str, contact: str) -> None:
    """The same punch as rigid edges and as a rigid body of plane elements."""
    is_round = kind == "RAX2"
    case = proof(
        f"rigid-edges-{kind.lower()}-{side.lower()}-{contact.split()[0]}",
        title=f"A punch of {kind}, {side}, {contact}",
        model=f"A square of edge 1 ({'CAX4, from radius 0.5' if is_round else 'CPE4'}, E = 1000, nu = 0.3, fixed below, slave, friction 0.2) under a flat punch with its edge on it that "
        f"goes down by 0.05{'' if is_round else ' and then along by 0.02 and turns by 0.02'}; NLGEOM.",
        formula="The results of the punch as a rigid body of plane elements.",
        source="the same model with another rigid tool",
        proves="Rigid edges in the plane: sides, section, reference node, reactions.",
    )
    n = 8
    solid = "CAX4" if is_round else "CPE4"
    right = 1.22  # the sole ends within the square
    pilot = f"*NODE\n{PILOT}, {0.0 if is_round else 0.8}, 2.\n"
    profile = [(0.3, 1.0), (0.8, 1.0), (right, 1.0), (right, 1.5)]
    edges = "*NODE\n" + "".join(f"{FIRST + i}, {x}, {y}\n" for i, (x, y) in enumerate(profile)) + f"*ELEMENT, TYPE={kind}, ELSET=UP\n"
    for i in range(len(profile) - 1):  # left of 1 to 2 is the side of SPOS: the punch lies there from left to right
        ends = [FIRST + i, FIRST + i + 1] if side == "SNEG" else [FIRST + i + 1, FIRST + i]
        edges += f"{FIRST + i}, {ends[0]}, {ends[1]}\n"
    edges += f"*RIGID BODY, ELSET=UP, REF NODE={PILOT}\n*SURFACE, NAME=PUNCH\nUP, {side}\n"
    places = [(0.3, 1.0), (0.8, 1.0), (right, 1.0), (0.3, 1.5), (0.8, 1.5), (right, 1.5)]
    body = "*NODE\n" + "".join(f"{FIRST + i}, {x}, {y}\n" for i, (x, y) in enumerate(places)) + f"*ELEMENT, TYPE={solid}, ELSET=UP\n"
    body += f"{FIRST}, {FIRST}, {FIRST + 1}, {FIRST + 4}, {FIRST + 3}\n{FIRST + 1}, {FIRST + 1}, {FIRST + 2}, {FIRST + 5}, {FIRST + 4}\n"
    body += "*SOLID SECTION, ELSET=UP, MATERIAL=M\n" + ("" if is_round else "1.\n") + f"*RIGID BODY, ELSET=UP, REF NODE={PILOT}\n"
    body += f"*SURFACE, NAME=PUNCH\n{FIRST}, S1\n{FIRST + 1}, S1\n{FIRST + 1}, S2\n"
    contacts = f"*SURFACE INTERACTION, NAME=I\n*FRICTION\n.2\n*CONTACT PAIR, INTERACTION=I{TYPES[contact]}\nTOP, PUNCH\n"
    held = "FLOOR, 1, 2" if not is_round else "FLOOR, 2"
    steps = step(fix(held, f"{PILOT}, 1", f"{PILOT}, 6", f"{PILOT}, 2, 2, -0.05"), 2, True)
    if not is_round:
        steps += step(fix(f"{PILOT}, 1, 1, 0.02", f"{PILOT}, 6, 6, 0.02"), 2, True)
    jobs = [case.run(plane_block(solid, n) + pilot + tool + contacts + steps, name) for tool, name in ((edges, "edges"), (body, "solids"))]
    count = (n + 1) ** 2
    for field in ("U", "CNORMF", "CSHEARF"):
        found, wanted = (job.field(field)[:, :count] for job in jobs)
        case.near(field, found, wanted, 1e-7, why="the same rows of contact; the criteria allow 1e-8 of the largest force", place="the square", time="all increments")
    found, wanted = (job.last("RF")[list(job.results.points[:, 1]).index(2.0)] for job in jobs)
    case.near("reaction", found, wanted, 1e-7, why="the same", place="the reference node", time="the end")
    case.done()
