"""Pairs that share nodes: chains, corners, symmetric pairs.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "decks"))

from make_decks import block  # noqa: E402
from planes import Plane, flat_deck, flatten  # noqa: E402
from proof import Case, Job  # noqa: E402
from sheets import Floats, between, fix, pair, sheet, solid_deck, step  # noqa: E402
from test_hertz import arc, slab  # noqa: E402

Proof = Callable[..., Case]
YOUNG, NU = 1000.0, 0.3
SOFT = (YOUNG, NU)


def around(name: str, surfaces: list[tuple[str, int]]) -> str:
    """A surface put together from element sets and edges."""
    return f"*SURFACE, NAME={name}\n" + "".join(f"{elset}, S{edge}\n" for elset, edge in surfaces)


def test_stacked_blocks(proof: Proof) -> None:
    """Three blocks, the middle one master all around and slave at its bottom."""
    case = proof(
        "chain-column",
        title="Three stacked blocks, the middle one master all around",
        model="Three blocks 1 x 1 of CPE4 (3 x 2 cells each), one on the other, E = 1000, nu = 0.3, rollers at the left and below, a pressure of 10 "
        "on the top in one increment, mu = 0.2. The master of the upper pair is the whole outline of the middle block, whose bottom nodes are slaves "
        "of the lower pair.",
        formula="Stress yy = -10 everywhere, contact pressure 10 at both interfaces; the top sinks by 3 p (1 - nu^2)/E.",
        source="plane strain, uniaxial stress",
        proves="A node may be slave in one pair and stand on the master surface of another.",
    )
    parts = [flatten(sheet(name, between(0, 1, 3), between(y, y + 1, 2))) for name, y in (("UPPER", 2), ("MIDDLE", 1), ("LOWER", 0))]
    outline = around("ALL_MIDDLE", [("MIDDLE_E1", 1), ("MIDDLE_R", 2), ("MIDDLE_E2", 3), ("MIDDLE_L", 4)])
    sides = [f"{name}_LEFT, 1" for name in ("UPPER", "MIDDLE", "LOWER")]
    load = "*DSLOAD\nUPPER_TOP, P, 10.\n"
    cards = outline + pair("UPPER_BOTTOM", "ALL_MIDDLE", 0.2) + pair("MIDDLE_BOTTOM", "LOWER_TOP", 0.2)
    cards += step(fix("LOWER_BOTTOM, 2", *sides) + load, 1)
    job = case.run(flat_deck([(part, SOFT) for part in parts], "CPE4", cards), asked=1)
    case.near("stress yy", job.last("S")[:, 1], -10.0, 1e-6, why="in the space of the elements")
    n = len(parts[0].nodes)
    pressed = np.concatenate([parts[0].node_sets["UPPER_BOTTOM"], n + parts[1].node_sets["MIDDLE_BOTTOM"]])
    case.near("contact pressure", job.last("CPRESS")[pressed], 10.0, 1e-6, why="in the space of the elements")
    top = job.last("U")[parts[0].node_sets["UPPER_TOP"], 1]
    case.near("uy of the top", top, -30.0 * (1 - NU**2) / YOUNG, 1e-6, why="in the space of the elements")
    case.done()


@pytest.mark.parametrize("kind", ["CPE4", "CPE8"])
def test_chain(proof: Proof, kind: str) -> None:
    """A block on a block that leans on a wall: the corner node passes the force of one pair to the other."""
    case = proof(
        f"chain-wall-{kind.lower()}",
        title=f"A block on a block that leans on a wall, {kind}",
        model="An upper block 1 x 1 on a lower one, both 3 x 3 cells, E = 1000, nu = 0.3, the lower one on a roller floor between a roller and a fixed wall that it "
        "touches with its right side; a pressure of 10 on the top, frictionless, one increment. The top right node of the lower block is slave at the "
        "wall and carries nodes of the upper block.",
        formula="Upper block: stress yy = -10 alone. Lower block: yy = -10, xx = -10 nu/(1 - nu), contact pressure at the wall the same.",
        source="plane strain; without friction the two blocks slide on each other",
        proves="The force on a slave is found from the balance of its node with what other pairs bring there.",
    )
    is_quadratic = kind == "CPE8"
    upper, lower = (flatten(sheet(name, between(0, 1, 3), between(y, y + 1, 3)), is_quadratic) for name, y in (("UPPER", 1), ("LOWER", 0)))
    wall = flatten(sheet("WALL", between(1, 1.5, 1), between(-0.5, 1.5, 2)), is_quadratic)
    floor = fix("LOWER_BOTTOM, 2", "LOWER_LEFT, 1", "UPPER_LEFT, 1", "FIXED, 1, 2")
    n = len(upper.nodes) + len(lower.nodes)
    wall.node_sets["FIXED"] = np.arange(len(wall.nodes))
    load = "*DSLOAD\nUPPER_TOP, P, 10.\n"
    cards = pair("LOWER_RIGHT", "WALL_LEFT") + pair("UPPER_BOTTOM", "LOWER_TOP") + step(floor + load, 1)
    job = case.run(flat_deck([(upper, SOFT), (lower, SOFT), (wall, SOFT)], kind, cards), asked=1)
    at_wall = len(upper.nodes) + lower.node_sets["LOWER_RIGHT"]
    total = job.last("CNORMF")[at_wall, 0].sum()
    case.near("force on the wall", -total, 10 * NU / (1 - NU), 1e-6, why="in the space of the elements")
    if not is_quadratic:  # the middle nodes of quadratic slave edges follow their ends, so forces on the master are those of lines
        corners = at_wall[at_wall < n]
        case.near("pressure at the wall", job.last("CPRESS")[corners], 10 * NU / (1 - NU), 1e-6, why="in the space of the elements")
        stress = job.last("S")[: len(upper.nodes)]
        case.near("upper block, stress xx", stress[:, 0], 0.0, 1e-6, why="in the space of the elements", scale=10.0)
        stress = job.last("S")[len(upper.nodes) : n]
        case.near("lower block, stress xx", stress[:, 0], -10 * NU / (1 - NU), 1e-6, why="in the space of the elements")
    case.done()


@pytest.mark.parametrize("angle", [0.0, 25.0, -25.0])
def test_corner(proof: Proof, angle: float) -> None:
    """A block in the corner of a floor and a wall that leans."""
    case = proof(
        f"corner-{angle:g}".replace("-", "m") if angle < 0 else f"corner-{angle:g}",
        title=f"A block in a corner, the wall leaning by {angle:g} degrees",
        model=f"A parallelogram, 3 x 3 cells of CPE4, its left side leaning by {angle:g} degrees, on a fixed floor and against a fixed wall that leans the same, "
        "E = 1000, nu = 0.3, a pressure of 10 on both other sides, frictionless, one increment. The corner node is slave at the floor and at the wall.",
        formula="All pressures are 10: the stress in the plane is -10 in every direction, contact pressure 10 everywhere, at the corner node in both pairs.",
        source="equilibrium",
        proves="A node that touches in two pairs at once, at right angles and not.",
    )
    lean = np.tan(np.radians(angle))

    def place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        return s + lean * t, t

    body = flatten(sheet("BODY", between(0, 1, 3), between(0, 1, 3), place))
    floor = flatten(sheet("FLOOR", between(-1, 2, 2), between(-0.5, 0, 1)))
    wall = flatten(sheet("WALL", between(-0.5, 0, 1), between(-0.4, 1.4, 2), place))
    for part, name in ((floor, "FLOOR"), (wall, "WALL")):
        part.node_sets[f"{name}_ALL"] = np.arange(len(part.nodes))
    load = "*DSLOAD\nBODY_TOP, P, 10.\nBODY_RIGHT, P, 10.\n"
    cards = pair("BODY_BOTTOM", "FLOOR_TOP") + pair("BODY_LEFT", "WALL_RIGHT")
    cards += step(fix("FLOOR_ALL, 1, 2", "WALL_ALL, 1, 2") + load, 1)
    job = case.run(flat_deck([(body, SOFT), (floor, SOFT), (wall, SOFT)], "CPE4", cards), asked=1)
    stress = job.last("S")[: len(body.nodes)]
    case.near("stress xx, yy", stress[:, :2], -10.0, 1e-6, why="in the space of the elements")
    case.near("stress xy", stress[:, 3], 0.0, 1e-6, why="in the space of the elements", scale=10.0)
    both = np.unique(np.concatenate([body.node_sets["BODY_BOTTOM"], body.node_sets["BODY_LEFT"]]))
    case.near("contact pressure", job.last("CPRESS")[both], 10.0, 1e-6, why="in the space of the elements")
    reaction = job.last("RF")[len(body.nodes) :]
    case.near("reaction of the walls", reaction.sum(axis=0)[:2], [10.0, 10.0 - 10 * lean], 1e-9, why="equilibrium", scale=10.0)
    case.done()


def test_corner_of_three_walls(proof: Proof) -> None:
    """A cube in the corner of a room."""
    case = proof(
        "corner-room",
        title="A cube in the corner of a room",
        model="A cube of 3 x 3 x 3 C3D8, E = 1000, nu = 0.3, touches three fixed walls; a pressure of 10 on its three other faces, frictionless, one "
        "increment. The nodes at its edges are slaves in two pairs, the node in the corner in three.",
        formula="Stress -10 in all directions, contact pressure 10 everywhere.",
        source="equilibrium",
        proves="A node that touches in three pairs at once.",
    )
    lines = between(0, 1, 3)
    cube = block(lines, lines, lines, "CUBE")
    number = np.arange(27).reshape(3, 3, 3)  # z, y, x
    sides = {"X0": (number[:, :, 0], 6), "X1": (number[:, :, 2], 4), "Y0": (number[:, 0, :], 3), "Y1": (number[:, 2, :], 5)}
    for name, (members, face) in sides.items():
        cube.element_sets[f"CUBE_{name}E"] = members.ravel()
        cube.surfaces[f"CUBE_{name}"] = [(f"CUBE_{name}E", face)]
    wide, thin = between(-0.5, 1.5, 2), between(-0.5, 0, 1)
    walls = [block(wide, wide, thin, "FLOOR"), block(thin, wide, wide, "WALLX"), block(wide, thin, wide, "WALLY")]
    for wall, face in zip(walls, (2, 4, 5), strict=True):
        name = next(iter(wall.element_sets))
        wall.surfaces = {f"{name}_SIDE": [(name, face)]}
        wall.node_sets = {f"{name}_ALL": np.arange(len(wall.nodes))}
    load = "*DSLOAD\nCUBE_TOP, P, 10.\nCUBE_X1, P, 10.\nCUBE_Y1, P, 10.\n"
    pairs = pair("CUBE_BOTTOM", "FLOOR_SIDE") + pair("CUBE_X0", "WALLX_SIDE") + pair("CUBE_Y0", "WALLY_SIDE")
    supports = fix("FLOOR_ALL, 1, 3", "WALLX_ALL, 1, 3", "WALLY_ALL, 1, 3")
    job = case.run(solid_deck([(cube, SOFT), *((wall, SOFT) for wall in walls)], pairs, step(supports + load, 1)), asked=1)
    n = len(cube.nodes)
    case.near("normal stresses", job.last("S")[:n, :3], -10.0, 1e-6, why="in the space of the elements")
    case.near("shear stresses", job.last("S")[:n, 3:], 0.0, 1e-6, why="in the space of the elements", scale=10.0)
    touching = np.flatnonzero((cube.nodes < 1e-9).any(axis=1))
    case.near("contact pressure", job.last("CPRESS")[touching], 10.0, 1e-6, why="in the space of the elements")
    case.done()


def hertz(case: Case, name: str, pairs: str, cylinder: Plane, below: Plane, is_nlgeom: bool) -> tuple[Job, float]:
    """The cylinder of NAFEMS R0094-1 pushed into the block; the job and the displacement of the cylinder's top."""
    load = f"*DSLOAD\nCYLINDER_TOP, P, {35000 / 2 / 40:.15g}\n"
    supports = fix("BLOCK_BOTTOM, 1, 2", "CYLINDER_LEFT, 1", "BLOCK_LEFT, 1")
    cards = pairs + step(supports + load, 10, is_nlgeom)
    job = case.run(flat_deck([(cylinder, (210000, 0.3)), (below, (70000, 0.3))], "CPE4", cards), name, asked=10)
    return job, float(job.last("U")[cylinder.along("CYLINDER_TOP")[0], 1])


@pytest.mark.parametrize(("mu", "is_nlgeom"), [(0.0, False), (0.2, False), (0.2, True)])
def test_symmetric_pair(proof: Proof, mu: float, is_nlgeom: bool) -> None:
    """A on B and B on A, on meshes that do not match."""
    case = proof(
        f"symmetric-pair-mu{mu:g}{'-nlgeom' if is_nlgeom else ''}".replace(".", ""),
        title=f"A symmetric pair against one-sided pairs, mu = {mu:g}{', NLGEOM' if is_nlgeom else ''}",
        model="The cylinder on the block of NAFEMS R0094 benchmark 1 by CPE4, elements of a/10 on the cylinder and of a/6 on the block, 35 kN per mm in 10 "
        f"increments, {'NLGEOM' if is_nlgeom else 'small displacements'}, mu = {mu:g}: the cylinder slave, the block slave, and both pairs together.",
        formula="The same displacement of the top and the same force whichever side is slave.",
        source="both one-sided results are those of one problem, up to the meshes",
        proves="The rule by which one side gives way node by node: nothing is held twice, nothing is left out.",
    )
    cylinder = flatten(arc(50.0, 40.0, 50.0, 0.6, 16, 14))
    below = flatten(slab(100.0, 200.0, 1.0, 10, 14))
    first, second = pair("CYLINDER_BOTTOM", "BLOCK_TOP", mu), pair("BLOCK_TOP", "CYLINDER_BOTTOM", mu)
    found = {}
    for name, pairs in (("cylinder slave", first), ("block slave", second), ("both", first + second), ("both, the block first", second + first)):
        job, sunk = hertz(case, name, pairs, cylinder, below, is_nlgeom)
        found[name] = sunk
        n = len(cylinder.nodes)
        normal = job.last("CNORMF")
        force = normal[:n, 1].sum() - normal[n:, 1].sum()
        shear = job.last("CSHEARF")
        force += shear[:n, 1].sum() - shear[n:, 1].sum()
        held = job.last("RF")[n + below.node_sets["BLOCK_BOTTOM"], 1].sum()
        case.near("force between the bodies", force, held, 1e-6, why="equilibrium", time=name)
    mean = 0.5 * (found["cylinder slave"] + found["block slave"])
    for name, sunk in found.items():
        case.near("the top sinks", sunk, mean, 0.005, why="the meshes", time=name)
    case.done()


def test_coarse_side_first(proof: Proof) -> None:
    """A symmetric pair whose first slave is much too coarse: the fine side fills in between."""
    case = proof(
        "symmetric-pair-coarse",
        title="A symmetric pair whose first slave is too coarse",
        model="A block 1 x 1 (E = 3000, 3 x 3 CPE4) on a block 4 x 1 (E = 1000, 80 x 8), nu = 0.3, mu = 0.2, NLGEOM: pressed by 0.02 (4 increments), drawn by 0.5 "
        "(20). The coarse block slave; the fine one slave; both pairs, the coarse slave first, and the fine one first.",
        formula="With the fine slave the result is good. The four nodes of the coarse slave alone let the soft ground rise between them: 15 % less force. Both "
        "pairs together are within 3 % of the fine slave whichever comes first.",
        source="none needed: one problem",
        proves="Slaves of the second pair are kept where no slave of the first stands around; sliding over many facets with it.",
    )
    upper, lower = flatten(sheet("UPPER", between(0, 1, 3), between(0, 1, 3))), flatten(sheet("LOWER", between(-1, 3, 80), between(-1, 0, 8)))
    coarse, fine = pair("UPPER_BOTTOM", "LOWER_TOP", 0.2), pair("LOWER_TOP", "UPPER_BOTTOM", 0.2)
    steps = step(fix("LOWER_BOTTOM, 1, 2", "UPPER_TOP, 1", "UPPER_TOP, 2, 2, -0.02"), 4, True) + step(fix("UPPER_TOP, 1, 1, 0.5"), 20, True)
    force = {}
    for name, pairs in (("coarse slave", coarse), ("fine slave", fine), ("coarse first", coarse + fine), ("fine first", fine + coarse)):
        job = case.run(flat_deck([(upper, (3000.0, 0.3)), (lower, (1000.0, 0.3))], "CPE4", pairs + steps), name, asked=24)
        force[name] = job.field("RF")[:, upper.node_sets["UPPER_TOP"], :2].sum(axis=1)
        if name == "coarse first":
            fine_nodes = len(upper.nodes) + lower.node_sets["LOWER_TOP"]
            case.within("fine nodes in contact", int((job.last("CSTATUS")[fine_nodes] > 0).sum()), (4, 20), why="between the four coarse ones")
    for time, frame in (("pressed", 4), ("drawn", 24)):
        good = force["fine slave"][frame]
        for name in ("coarse first", "fine first"):
            case.near(f"force, {name}", force[name][frame], good, 0.03, why="the meshes", time=time)
        case.within("what the coarse slave alone misses", 1 - force["coarse slave"][frame, 1] / good[1], (0.10, 0.20), why="the ground rises", time=time)
    case.done()


def test_groove(proof: Proof) -> None:
    """A cube drawn along the edge of floor and wall: friction where both leave a direction free."""
    mu = 0.2
    case = proof(
        "corner-groove",
        title="A cube drawn along a groove",
        model="A cube of 3 x 3 x 3 C3D8, E = 1000, nu = 0.3, on a floor and against a wall, a pressure of 10 towards both (1 increment), then drawn along the "
        f"edge by 0.1 at its nodes away from both (5 increments), mu = {mu:g} in both pairs, small displacements.",
        formula="Every node slides: its friction is mu N against the motion. At the nodes of the edge, slaves in both pairs, the friction along the edge is that "
        "of the pair that comes first, the floor; the wall pushes there only. The pull is the sum.",
        source="Coulomb; the rule of corners (theory of contact, section 5)",
        proves="Friction at nodes that touch twice; the normal forces of both pairs there.",
    )
    lines = between(0, 1, 3)
    cube = block(lines, lines, lines, "CUBE")
    number = np.arange(27).reshape(3, 3, 3)  # z, y, x
    cube.element_sets |= {"CUBE_X0E": number[:, :, 0].ravel(), "CUBE_X1E": number[:, :, 2].ravel()}
    cube.surfaces |= {"CUBE_X0": [("CUBE_X0E", 6)], "CUBE_X1": [("CUBE_X1E", 4)]}
    cube.select("HANDLE", lambda x: (x[:, 0] > 0.5) & (x[:, 2] > 0.5))
    wide, thin = between(-0.5, 2.0, 2), between(-0.5, 0, 1)
    walls = [block(wide, wide, thin, "FLOOR"), block(thin, wide, wide, "WALL")]
    for wall, face in zip(walls, (2, 4), strict=True):
        name = next(iter(wall.element_sets))
        wall.surfaces = {f"{name}_SIDE": [(name, face)]}
        wall.node_sets = {f"{name}_ALL": np.arange(len(wall.nodes))}
    pairs = pair("CUBE_BOTTOM", "FLOOR_SIDE", mu) + pair("CUBE_X0", "WALL_SIDE", mu)
    supports = fix("FLOOR_ALL, 1, 3", "WALL_ALL, 1, 3", "HANDLE, 2")
    steps = step(supports + "*DSLOAD\nCUBE_TOP, P, 10.\nCUBE_X1, P, 10.\n", 1) + step(fix("HANDLE, 2, 2, 0.1"), 5)
    job = case.run(solid_deck([(cube, SOFT), *((wall, SOFT) for wall in walls)], pairs, steps), asked=6)
    with h5py.File(job.path) as file:
        contact = file["AMONTONS/contact"]
        node, of_pair = contact["node"][:], contact["pair"][:]
        force, shear, status = (contact[name][-len(node) :] for name in ("force", "shear", "status"))
    first = of_pair == of_pair.min()
    shared = np.isin(node, np.intersect1d(node[first], node[~first]))
    normal = np.linalg.norm(force, axis=1)
    expected = np.where(~first & shared, 0.0, mu * normal)
    case.true("all of it slides", bool((status == 2).all()), why="drawn far enough", time="the end")
    case.near("friction, slave by slave", np.linalg.norm(shear, axis=1), expected, 1e-6, why="Coulomb", scale=mu * float(normal.max()), time="the end")
    both = force.sum(axis=0) + shear.sum(axis=0)  # the friction at one leans a little along the normal of the other
    case.near("force of floor and wall", both[[0, 2]], 10.0, 1e-6, why="equilibrium", time="the end")
    case.near("pull", job.last("RF")[cube.node_sets["HANDLE"], 1].sum(), expected.sum(), 0.02, why="friction leans a little across", time="the end")
    case.done()
