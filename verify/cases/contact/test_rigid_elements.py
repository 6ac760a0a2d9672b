"""Rigid elements R3D3 and R3D4 as masters of contact.

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
    """Rigid elements without a rigid body, with a section, in the plane, under the calculix dialect."""
    alone = f"*NODE\n{PILOT}, 0.5, 0.5, 2.\n"
    assert f"The rigid element {FIRST} belongs to no *RIGID BODY, ELSET=, REF NODE=." in refusal(run_deck, alone)
    section = RIGID + "*SHELL SECTION, ELSET=UP, MATERIAL=LOW\n0.1\n"
    assert f"The element {FIRST} is rigid and needs no section" in refusal(run_deck, section)
    assert "solids in a *RIGID BODY; in the plane *SURFACE, TYPE=SEGMENTS" in refusal(run_deck, RIGID, "TYPE=R3D4", "TYPE=RAX2")
    assert "The element type R3D4 is not supported" in refusal(run_deck, RIGID, top="** dialect: calculix\n")


def test_explained(run_deck: Run) -> None:
    """--explain takes the card as it is."""
    mesh, surface = rigid_punch(3, "R3D4", "SPOS")
    deck = solid_deck([(cube(3), (YOUNG, NU))], mesh + RIGID + surface + pair("LOW_TOP", "PUNCH"), steps(False))
    done = run_deck(deck, "--explain")
    assert done.returncode == 0, done.stdout
    assert "TYPE=R3D4: used" in done.stdout, done.stdout
