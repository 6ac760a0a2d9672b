"""Slave nodes that equations, couplings and rigid bodies move: contact acts on them by a penalty.

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
YOUNG, DOWN, ALONG, MU = 1000.0, 0.01, 0.02, 0.3
PILOT = 9001
BY = {
    "rigid body": f"*RIGID BODY, ELSET=UP, REF NODE={PILOT}",
    "kinematic coupling": f"*SURFACE, NAME=SOLE\nUP, S1\n*COUPLING, CONSTRAINT NAME=C, REF NODE={PILOT}, SURFACE=SOLE\n*KINEMATIC\n1, 3",
}
KINDS = {"node to surface": "", "surface to surface": ", TYPE=SURFACE TO SURFACE"}


def bodies(n: int) -> tuple[Mesh, Mesh]:
    """A cube of n x n x n elements, and a plate of the same mesh on it."""
    line = np.linspace(0, 1, n + 1)
    low, up = block(line, line, line, "LOW"), block(line, line, [1.0, 1.5], "UP")
    low.select("FLOOR", lambda x: x[:, 2] < 1e-9)
    up.node_sets["PLATE"] = np.arange(len(up.nodes))
    return low, up


def deck(n: int, cards: str, steps: str, mu: float, kind: str, nu: float = 0.0, names: tuple[str, str] = ("UP_BOTTOM", "LOW_TOP")) -> str:
    """The two bodies, the plate moved by the pilot node where cards say so."""
    head = f"*NODE\n{PILOT}, 0.5, 0.5, 1.5\n{cards}\n" if cards else ""
    low, up = bodies(n)
    return solid_deck([(low, (YOUNG, nu)), (up, (YOUNG, nu))], head + pair(*names, mu, kind), steps)


def equations(n: int) -> str:
    """The displacement along z of all nodes of the plate's sole is that of the pilot node."""
    low, up = bodies(n)
    first = len(low.nodes) + 1
    sole = [first + int(i) for i in np.flatnonzero(up.nodes[:, 2] < 1 + 1e-9)]
    return "*EQUATION\n" + "\n".join(f"2\n{node}, 3, 1., {PILOT}, 3, -1." for node in sole)


def pilot_force(job: Job, n: int) -> np.ndarray:
    """The reaction at the pilot node."""
    low, up = bodies(n)
    return np.asarray(job.last("RF")[len(low.nodes) + len(up.nodes)])


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("n", [2, 4])
@pytest.mark.parametrize("by", [*BY, "equations"])
def test_pressed_and_dragged(proof: Proof, by: str, n: int, kind: str) -> None:
    """A plate that a pilot node moves presses and drags an elastic cube."""
    case = proof(
        f"dependent-slaves-{by.replace(' ', '-')}-{kind.split()[0]}-{n}",
        title=f"Slave nodes moved by a pilot node: {by}, {kind}, {n} elements along an edge",
        model=f"A cube of edge 1 (E = {YOUNG:g}, nu = 0, {n} x {n} x {n} C3D8, fixed below, master) under a plate of the same mesh whose nodes a pilot node "
        f"moves ({by}); the pilot node goes down by {DOWN:g}.",
        formula="p = d/(H/E + 1/K) with the penalty K = 100 E/a and a = 1/n: springs in series. Dragged until all slips, the force is mu p.",
        source="Hooke, Coulomb",
        proves="Contact acts on slave nodes that depend on others, with the stiffness that the job names.",
    )
    cards = equations(n) if by == "equations" else BY[by]
    free = "PLATE, 1, 2" if by == "equations" else f"{PILOT}, 1, 2"
    held = fix("FLOOR, 1, 3", free, *([] if by == "equations" else [f"{PILOT}, 4, 6"]), f"{PILOT}, 3, 3, {-DOWN}")
    job = case.run(deck(n, cards, step(held, 1), 0.0, KINDS[kind]), "pressed")
    stiffness = 100 * YOUNG * n
    pressure = DOWN / (1 / YOUNG + 1 / stiffness)
    case.near("force at the pilot node", -float(pilot_force(job, n)[2]), pressure, 1e-8, why="closed form", place="pilot node", time="the end")
    if by != "equations":
        steps = step(held, 1) + step(fix(f"{PILOT}, 1, 1, {5 * ALONG}"), 4)
        job = case.run(deck(n, cards, steps, MU, KINDS[kind]), "dragged")
        force = pilot_force(job, n)
        case.near("drag over normal force", float(-force[0] / force[2]), MU, 1e-6, why="all slave nodes slip", place="pilot node", time="the end")
    case.done()


@pytest.mark.parametrize("kind", KINDS)
def test_against_exact_contact(proof: Proof, kind: str) -> None:
    """The same plate as the master of exact contact."""
    case = proof(
        f"dependent-slaves-exact-{kind.split()[0]}",
        title=f"A rigid plate as slave and as master, {kind}",
        model=f"The cube with nu = 0.3 under the rigid plate, which goes down by {DOWN:g}, without friction; 2 and 4 elements along an edge.",
        formula="On equal meshes both choices constrain the same nodes; as slave the force is smaller by the penalty, less than 1/(100 n + 1).",
        source="exact contact with slave and master exchanged",
        proves="The penalty at dependent slave nodes costs one per cent of an element's shortening.",
    )
    held = fix("FLOOR, 1, 3", f"{PILOT}, 1, 2", f"{PILOT}, 4, 6", f"{PILOT}, 3, 3, {-DOWN}")
    for n in (2, 4):
        force = {}
        for name, names in (("slave", ("UP_BOTTOM", "LOW_TOP")), ("master", ("LOW_TOP", "UP_BOTTOM"))):
            job = case.run(deck(n, BY["rigid body"], step(held, 1), 0.0, KINDS[kind], 0.3, names), f"{name}-{n}")
            force[name] = -float(pilot_force(job, n)[2])
        case.within(f"force as slave over that as master, n = {n}", force["slave"] / force["master"], (1 - 1.5 / (100 * n), 1.0),
                    why="springs in series; nu stiffens the cube by less than half", place="pilot node", time="the end")  # fmt: skip
    case.done()


def test_the_job_says_so(run_deck: Run) -> None:
    """A warning names pair, stiffness and a node."""
    held = fix("FLOOR, 1, 3", f"{PILOT}, 1, 2", f"{PILOT}, 4, 6", f"{PILOT}, 3, 3, {-DOWN}")
    said = run_deck(deck(2, BY["rigid body"], step(held, 1), 0.0, "")).stdout
    assert "The contact pair UP_BOTTOM / LOW_TOP acts by a penalty of 200000 [stress/length]" in said, said
    assert "move 9 slave nodes (28, ...)" in said, said
    assert "cannot push there" not in said, said
