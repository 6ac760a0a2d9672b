"""Masters that are rigid bodies of elements with a reference node.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verify.cases.proof import Case
from verify.decks.planes import Plane, flat_deck, flatten
from verify.decks.sheets import Floats, between, fix, pair, sheet, step

Proof = Callable[..., Case]
RADIUS, YOUNG, NU = 2.0, 1000.0, 0.3
REFERENCE = 9001


def roller(n: int) -> Plane:
    """The lower part of a roller above a block, its pole in (0, 0)."""

    def place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        angle = s * np.pi / 3
        return (RADIUS - 0.5 * t) * np.sin(angle), RADIUS - (RADIUS - 0.5 * t) * np.cos(angle)

    return flatten(sheet("ROLLER", between(-1, 1, n), between(0, 1, 2), place))


def parts() -> tuple[Plane, Plane]:
    """Block and roller."""
    return flatten(sheet("BLOCK", between(-3, 3, 36), between(-2, 0, 10))), roller(40)


def deck(cards: str, is_rigid: bool) -> str:
    """Both, the roller rigid about a reference node at its centre."""
    block, tool = parts()
    tool.node_sets["TOOL"] = np.arange(len(tool.nodes))
    rigid = f"*NODE\n{REFERENCE}, 0., {RADIUS}\n*RIGID BODY, ELSET=ROLLER, REF NODE={REFERENCE}\n" if is_rigid else ""
    return flat_deck([(block, (YOUNG, NU)), (tool, (YOUNG, NU))], "CPE4", rigid + pair("BLOCK_TOP", "ROLLER_BOTTOM", 0.3) + cards)


def test_indentation_by_a_rigid_body(proof: Proof) -> None:
    """The reference node moves a meshed roller as prescribing all its nodes does."""
    case = proof(
        "rigid-master-indentation",
        title="Indentation by a rigid body of elements",
        model="A block 6 x 2 (E = 1000, nu = 0.3, 36 x 10 CPE4, bottom fixed, slave) under a roller of radius 2 (40 x 2 CPE4), which goes down by 0.1 in 4 "
        "increments and along by 0.2 in 4, mu = 0.3, NLGEOM: as a *RIGID BODY moved by its reference node, and with all its nodes prescribed.",
        formula="The same displacements; the reactions at the reference node are the sum of the contact forces, the moment theirs about it.",
        source="none needed",
        proves="A meshed rigid body as master: forces and moment come to the reference node.",
    )
    jobs = {}
    for name, moved, turn in (("rigid", f"{REFERENCE}", f"{REFERENCE}, 6"), ("prescribed", "TOOL", "")):
        held = fix("BLOCK_BOTTOM, 1, 2", f"{moved}, 1", f"{moved}, 2, 2, -0.1", *([turn] if turn else []))
        steps = step(held, 4, True) + step(fix(f"{moved}, 1, 1, 0.2"), 4, True)
        jobs[name] = case.run(deck(steps, name == "rigid"), name, requested=8)
    block, tool = parts()
    n = len(block.nodes)
    rigid, free = jobs["rigid"], jobs["prescribed"]
    m = n + len(tool.nodes)
    case.near("u", rigid.last("U")[:m], free.last("U")[:m], 1e-5, why="the tolerance of Newton's method",
              place="all nodes of the ground", time="the end")  # fmt: skip
    contact = rigid.last("CNORMF")[:n] + rigid.last("CSHEARF")[:n]
    reaction = rigid.last("RF")[m]
    case.near("reaction at the reference node", reaction[:2], contact.sum(axis=0)[:2], 1e-6, why="equilibrium", scale=float(np.abs(contact.sum(axis=0)).max()),
              place="reference node", time="the end")  # fmt: skip
    total = free.last("RF")[n:m].sum(axis=0)
    case.near("force", reaction[:2], total[:2], 1e-4, why="the tolerance of Newton's method", place="reference node", time="the end")
    case.true("the roller drags", abs(float(reaction[0])) > 0.2 * abs(float(reaction[1])), why="friction is at work",
              place="reference node", time="the end")  # fmt: skip
    case.done()


def test_turning_rigid_body(proof: Proof) -> None:
    """A rigid roller that turns in place: friction, and the moment that it needs."""
    case = proof(
        "rigid-master-turning",
        title="A rigid roller turns in its dent",
        model="As before; the roller goes down by 0.05 (2 increments), then turns by 0.2 about its centre in 4 increments, mu = 0.3, NLGEOM.",
        formula="All of the contact slides in the end: the moment at the reference node is that of the contact forces about it, and mu R times the normal "
        "force, but for the block's bending of the normals.",
        source="Coulomb",
        proves="Rotation of a rigid master by its reference node, and its moment.",
    )
    held = fix("BLOCK_BOTTOM, 1, 2", f"{REFERENCE}, 1", f"{REFERENCE}, 2, 2, -0.05", f"{REFERENCE}, 6")
    steps = step(held, 2, True) + step(fix(f"{REFERENCE}, 6, 6, 0.2"), 4, True)
    job = case.run(deck(steps, True), requested=6)
    block, tool = parts()
    n = len(block.nodes)
    x = job.points[:n, :2] + job.last("U")[:n, :2]
    normal, shear = job.last("CNORMF")[:n, :2], job.last("CSHEARF")[:n, :2]
    arm = x - [0, RADIUS - 0.05]
    f = normal + shear
    moment = float((arm[:, 0] * f[:, 1] - arm[:, 1] * f[:, 0]).sum())
    expected = 0.3 * RADIUS * float(np.linalg.norm(normal, axis=1).sum())
    case.near("moment over mu R N", abs(moment) / expected, 1.0, 0.01, why="facets of the roller are 0.1 long", time="the end",
              place="reference node")  # fmt: skip
    status = job.last("CSTATUS")[:n]
    case.true("all of it slides", bool((status[status > 0] == 2).all() and (status > 0).sum() > 2), why="turned far enough",
              place="all slave nodes in contact", time="the end")  # fmt: skip
    case.done()
