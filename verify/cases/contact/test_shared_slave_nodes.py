"""Pairs that share nodes: chains, corners, symmetric pairs.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable

import h5py
import numpy as np
import pytest

from verify.cases.contact.test_hertz import arc, slab
from verify.cases.proof import Case, Job
from verify.decks import solids
from verify.decks.make_decks import block
from verify.decks.planes import Plane, flat_deck, flatten
from verify.decks.sheets import Floats, between, fix, pair, sheet, solid_deck, step

Proof = Callable[..., Case]
YOUNG, NU = 1000.0, 0.3
TYPES = {"": "", "s2s": ", TYPE=SURFACE TO SURFACE"}
TITLES = {"": "", "s2s": ", surface to surface"}
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
    job = case.run(flat_deck([(part, SOFT) for part in parts], "CPE4", cards), requested=1)
    case.near("stress yy", job.last("S")[:, 1], -10.0, 1e-6, why="in the space of the elements", place="all nodes", time="the end")
    n = len(parts[0].nodes)
    pressed = np.concatenate([parts[0].node_sets["UPPER_BOTTOM"], n + parts[1].node_sets["MIDDLE_BOTTOM"]])
    case.near("contact pressure", job.last("CPRESS")[pressed], 10.0, 1e-6, why="in the space of the elements",
              place="all slave nodes", time="the end")  # fmt: skip
    top = job.last("U")[parts[0].node_sets["UPPER_TOP"], 1]
    case.near("uy of the top", top, -30.0 * (1 - NU**2) / YOUNG, 1e-6, why="in the space of the elements", place="top", time="the end")
    case.done()


@pytest.mark.parametrize("kind", ["CPE4", "CPE8"])
@pytest.mark.parametrize("form", ["", "s2s"])
def test_chain(proof: Proof, kind: str, form: str) -> None:
    """A block on a block that leans on a wall: the corner node passes the force of one pair to the other."""
    options = TYPES[form]
    case = proof(
        f"chain-wall-{kind.lower()}" + ("-s2s" if form else ""),
        title=f"A block on a block that leans on a wall, {kind}" + TITLES[form],
        model="An upper block 1 x 1 on a lower one, both 3 x 3 cells, E = 1000, nu = 0.3, the lower one on a roller support between a roller and a fixed wall that it "
        "touches with its right side; a pressure of 10 on the top, frictionless, one increment. The top right node of the lower block is slave at the "
        "wall and is master of nodes of the upper block.",
        formula="Upper block: stress yy = -10 alone. Lower block: yy = -10, xx = -10 nu/(1 - nu), contact pressure at the wall the same.",
        source="plane strain; without friction the two blocks slide on each other",
        proves="The force on a slave is found from the equilibrium of its node with what other pairs bring there.",
    )
    is_quadratic = kind == "CPE8"
    upper, lower = (flatten(sheet(name, between(0, 1, 3), between(y, y + 1, 3)), is_quadratic) for name, y in (("UPPER", 1), ("LOWER", 0)))
    wall = flatten(sheet("WALL", between(1, 1.5, 1), between(-0.5, 1.5, 2)), is_quadratic)
    floor = fix("LOWER_BOTTOM, 2", "LOWER_LEFT, 1", "UPPER_LEFT, 1", "FIXED, 1, 2")
    n = len(upper.nodes) + len(lower.nodes)
    wall.node_sets["FIXED"] = np.arange(len(wall.nodes))
    load = "*DSLOAD\nUPPER_TOP, P, 10.\n"
    cards = pair("LOWER_RIGHT", "WALL_LEFT", options=options) + pair("UPPER_BOTTOM", "LOWER_TOP", options=options) + step(floor + load, 1)
    job = case.run(flat_deck([(upper, SOFT), (lower, SOFT), (wall, SOFT)], kind, cards), requested=1)
    at_wall = len(upper.nodes) + lower.node_sets["LOWER_RIGHT"]
    total = job.last("CNORMF")[at_wall, 0].sum()
    case.near("force on the wall", -total, 10 * NU / (1 - NU), 1e-6, why="in the space of the elements", place="wall", time="the end")
    if form or not is_quadratic:  # the middle nodes of quadratic slave edges follow their ends, so forces on the master are those of lines
        corners = at_wall[at_wall < n]
        case.near("pressure at the wall", job.last("CPRESS")[corners], 10 * NU / (1 - NU), 1e-6, why="in the space of the elements",
                  place="corners at the wall", time="the end")  # fmt: skip
        stress = job.last("S")[: len(upper.nodes)]
        case.near("upper block, stress xx", stress[:, 0], 0.0, 1e-6, why="in the space of the elements", scale=10.0,
                  place="all nodes of the upper block", time="the end")  # fmt: skip
        stress = job.last("S")[len(upper.nodes) : n]
        case.near("lower block, stress xx", stress[:, 0], -10 * NU / (1 - NU), 1e-6, why="in the space of the elements",
                  place="all nodes of the lower block", time="the end")  # fmt: skip
    case.done()


@pytest.mark.parametrize("angle", [0.0, 25.0, -25.0])
@pytest.mark.parametrize("form", ["", "s2s"])
def test_corner(proof: Proof, angle: float, form: str) -> None:
    """A block in the corner of a floor and a wall that leans."""
    options = TYPES[form]
    case = proof(
        f"corner-{angle:g}".replace("--", "-minus-") + ("-s2s" if form else ""),
        title=f"A block in a corner, the wall leaning by {angle:g} degrees" + TITLES[form],
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
    cards = pair("BODY_BOTTOM", "FLOOR_TOP", options=options) + pair("BODY_LEFT", "WALL_RIGHT", options=options)
    cards += step(fix("FLOOR_ALL, 1, 2", "WALL_ALL, 1, 2") + load, 1)
    job = case.run(flat_deck([(body, SOFT), (floor, SOFT), (wall, SOFT)], "CPE4", cards), requested=1)
    stress = job.last("S")[: len(body.nodes)]
    case.near("stress xx, yy", stress[:, :2], -10.0, 1e-6, why="in the space of the elements", place="all nodes", time="the end")
    case.near("stress xy", stress[:, 3], 0.0, 1e-6, why="in the space of the elements", scale=10.0, place="all nodes", time="the end")
    both = np.unique(np.concatenate([body.node_sets["BODY_BOTTOM"], body.node_sets["BODY_LEFT"]]))
    case.near("contact pressure", job.last("CPRESS")[both], 10.0, 1e-6, why="in the space of the elements", place="all slave nodes", time="the end")
    reaction = job.last("RF")[len(body.nodes) :]
    case.near("reaction of the walls", reaction.sum(axis=0)[:2], [10.0, 10.0 - 10 * lean], 1e-9, why="equilibrium", scale=10.0,
              place="floor and wall", time="the end")  # fmt: skip
    case.done()


def test_corner_of_three_walls(proof: Proof) -> None:
    """A cube in the corner of three walls."""
    case = proof(
        "corner-cube",
        title="A cube in the corner of three walls",
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
    job = case.run(solid_deck([(cube, SOFT), *((wall, SOFT) for wall in walls)], pairs, step(supports + load, 1)), requested=1)
    n = len(cube.nodes)
    case.near("normal stresses", job.last("S")[:n, :3], -10.0, 1e-6, why="in the space of the elements",
              place="all nodes of the cube", time="the end")  # fmt: skip
    case.near("shear stresses", job.last("S")[:n, 3:], 0.0, 1e-6, why="in the space of the elements", scale=10.0,
              place="all nodes of the cube", time="the end")  # fmt: skip
    touching = np.flatnonzero((cube.nodes < 1e-9).any(axis=1))
    case.near("contact pressure", job.last("CPRESS")[touching], 10.0, 1e-6, why="in the space of the elements",
              place="all slave nodes", time="the end")  # fmt: skip
    case.done()


def hertz(case: Case, name: str, pairs: str, cylinder: Plane, below: Plane, is_nlgeom: bool) -> tuple[Job, float]:
    """The cylinder of NAFEMS R0094-1 pushed into the block; the job and the displacement of the cylinder's top."""
    load = f"*DSLOAD\nCYLINDER_TOP, P, {35000 / 2 / 40:.15g}\n"
    supports = fix("BLOCK_BOTTOM, 1, 2", "CYLINDER_LEFT, 1", "BLOCK_LEFT, 1")
    cards = pairs + step(supports + load, 10, is_nlgeom)
    job = case.run(flat_deck([(cylinder, (210000, 0.3)), (below, (70000, 0.3))], "CPE4", cards), name, requested=10)
    return job, float(job.last("U")[cylinder.along("CYLINDER_TOP")[0], 1])


@pytest.mark.parametrize(("mu", "is_nlgeom"), [(0.0, False), (0.2, False), (0.2, True)])
@pytest.mark.slow
def test_symmetric_pair(proof: Proof, mu: float, is_nlgeom: bool) -> None:
    """A on B and B on A, on meshes that do not match."""
    case = proof(
        f"symmetric-pair-mu{mu:g}{'-nlgeom' if is_nlgeom else ''}".replace(".", ""),
        title=f"A symmetric pair against one-sided pairs, mu = {mu:g}{', NLGEOM' if is_nlgeom else ''}",
        model="The cylinder on the block of NAFEMS R0094 benchmark 1 by CPE4, elements of a/10 on the cylinder and of a/6 on the block, 35 kN per mm in 10 "
        f"increments, {'NLGEOM' if is_nlgeom else 'small displacements'}, mu = {mu:g}: the cylinder slave, the block slave, and both pairs together.",
        formula="The same displacement of the top and the same force whichever side is slave.",
        source="both one-sided results are those of one problem, up to the meshes",
        proves="The rule that drops one side of the constraint node by node: no node is constrained twice, none is left out.",
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
        case.near("force between the bodies", force, held, 1e-6, why="equilibrium", time=name, place="both sides")
    mean = 0.5 * (found["cylinder slave"] + found["block slave"])
    for name, sunk in found.items():
        case.near("the top sinks", sunk, mean, 0.005, why="the meshes", time=name, place="top")
    case.done()


@pytest.mark.slow
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
        job = case.run(flat_deck([(upper, (3000.0, 0.3)), (lower, (1000.0, 0.3))], "CPE4", pairs + steps), name, requested=24)
        force[name] = job.field("RF")[:, upper.node_sets["UPPER_TOP"], :2].sum(axis=1)
        if name == "coarse first":
            fine_nodes = len(upper.nodes) + lower.node_sets["LOWER_TOP"]
            case.within("fine nodes in contact", int((job.last("CSTATUS")[fine_nodes] > 0).sum()), (4, 20), why="between the four coarse ones",
                        place="the ground's fine nodes", time="the end")  # fmt: skip
    for time, frame in (("pressed", 4), ("drawn", 24)):
        good = force["fine slave"][frame]
        for name in ("coarse first", "fine first"):
            case.near(f"force, {name}", force[name][frame], good, 0.03, why="the meshes", time=time, place="top")
        case.within("what the coarse slave alone misses", 1 - force["coarse slave"][frame, 1] / good[1], (0.10, 0.20), why="the ground rises", time=time,
                    place="top")  # fmt: skip
    case.done()


@pytest.mark.parametrize("form", ["", "s2s"])
def test_groove(proof: Proof, form: str) -> None:
    """A cube drawn along the edge of floor and wall: friction where both constrain no motion along it."""
    mu, options = 0.2, TYPES[form]
    case = proof(
        "corner-groove" + ("-s2s" if form else ""),
        title="A cube drawn along a groove" + TITLES[form],
        model="A cube of 3 x 3 x 3 C3D8, E = 1000, nu = 0.3, on a floor and against a wall, a pressure of 10 towards both (1 increment), then drawn along the "
        f"edge by 0.1 at its nodes away from both (5 increments), mu = {mu:g} in both pairs, small displacements.",
        formula="Every node slides: its friction is mu N against the motion. At the nodes of the edge, slaves in both pairs, the friction along the edge is that "
        "of the pair that presses more, of two that press alike the first, the floor; the wall pushes there only. The pull is the sum.",
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
    pairs = pair("CUBE_BOTTOM", "FLOOR_SIDE", mu, options) + pair("CUBE_X0", "WALL_SIDE", mu, options)
    supports = fix("FLOOR_ALL, 1, 3", "WALL_ALL, 1, 3", "HANDLE, 2")
    steps = step(supports + "*DSLOAD\nCUBE_TOP, P, 10.\nCUBE_X1, P, 10.\n", 1) + step(fix("HANDLE, 2, 2, 0.1"), 5)
    job = case.run(solid_deck([(cube, SOFT), *((wall, SOFT) for wall in walls)], pairs, steps), requested=6)
    with h5py.File(job.path) as file:
        contact = file["AMONTONS/contact"]
        node, of_pair = contact["node"][:], contact["pair"][:]
        force, shear, status = (contact[name][-len(node) :] for name in ("force", "shear", "status"))
    first = of_pair == of_pair.min()
    shared = np.isin(node, np.intersect1d(node[first], node[~first]))
    normal = np.linalg.norm(force, axis=1)
    expected = np.where(~first & shared, 0.0, mu * normal)
    case.true("all of it slides", bool((status == 2).all()), why="drawn far enough", time="the end", place="all slave nodes")
    case.near("friction, slave by slave", np.linalg.norm(shear, axis=1), expected, 1e-6, why="Coulomb", scale=mu * float(normal.max()), time="the end",
              place="all slave nodes")  # fmt: skip
    both = force.sum(axis=0) + shear.sum(axis=0)  # the friction at one leans a little along the normal of the other
    case.near("force of floor and wall", both[[0, 2]], 10.0, 1e-6, why="equilibrium", time="the end", place="floor and wall")
    case.near("pull", job.last("RF")[cube.node_sets["HANDLE"], 1].sum(), expected.sum(), 0.02, why="friction leans a little across", time="the end",
              place="handle")  # fmt: skip
    case.done()


def fixed_block(name: str, x: Floats, y: Floats, z: Floats, side: tuple[int, float], first: int) -> tuple[str, int]:
    """The cards of a block of C3D8 whose nodes are held, with the surface of one side; and how many nodes it has."""
    body = solids.as_kind(block(x, y, z, name), "C3D8")
    lines = [f"*NODE, NSET={name}_ALL"] + [f"{first + i}, " + ", ".join(f"{v:.15g}" for v in p) for i, p in enumerate(body.nodes, start=1)]
    lines += [f"*ELEMENT, TYPE=C3D8, ELSET={name}"]
    lines += [f"{first + e}, " + ", ".join(str(first + n + 1) for n in nodes) for e, nodes in enumerate(body.elements, start=1)]
    lines += [f"*SURFACE, NAME={name}_SIDE"] + [f"{first + e + 1}, S{f}" for e, f in body.outer_faces(body.where(*side))]
    return "\n".join(lines) + f"\n*SOLID SECTION, ELSET={name}, MATERIAL=M\n", len(body.nodes)


def pressed_cube(kind: str, walls: str, pairs: str, sides: dict[str, Callable[[solids.Solids], solids.Ints]], pressed: list[tuple[int, float]], supports: str) -> tuple[str, Floats]:
    """A cube of 3 x 3 x 3 cells against walls, 10 on some of its sides; the deck and its nodes. sides: slave surfaces by their corner nodes."""
    line = np.array([0.0, 0.3, 0.6, 1.0])
    cube = solids.as_kind(block(line, line, line, "CUBE"), kind)
    deck = cube.cards().replace("ELSET=ALL", "ELSET=CUBE") + "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n*SOLID SECTION, ELSET=CUBE, MATERIAL=M\n" + walls
    for name, members in sides.items():
        deck += f"*SURFACE, NAME={name}\n" + "".join(f"{e + 1}, S{f}\n" for e, f in cube.outer_faces(members(cube)))
    loads = "".join(f"{e + 1}, P{f}, 10.\n" for axis, value in pressed for e, f in cube.outer_faces(cube.where(axis, value)))
    return deck + pairs + f"*STEP\n*STATIC\n1., 1.\n{supports}*DLOAD\n{loads}*END STEP\n", cube.nodes


@pytest.mark.parametrize("kind", ["C3D4", "C3D10", "C3D20"])
def test_corner_by_surfaces(proof: Proof, kind: str) -> None:
    """A cube of other elements in the corner of three walls, by surface to surface."""
    case = proof(
        f"corner-cube-{kind.lower()}-s2s",
        title=f"A cube of {kind} in the corner of three walls, surface to surface",
        model=f"As corner-cube: a cube of 3 x 3 x 3 cells of {kind}, the walls meshed otherwise, TYPE=SURFACE TO SURFACE.",
        formula="Stress -10 in all directions, contact pressure 10 everywhere.",
        source="equilibrium",
        proves="Mid-side nodes of edges belong to the faces of two pairs; their transformed basis is one.",
    )
    wide, thin, walls, pairs, n = np.array([-0.5, 0.45, 1.5]), np.array([-0.5, 0.0]), "", "", 5000
    sides = {}
    for axis, name in enumerate(("WALLX", "WALLY", "FLOOR")):
        spans = [thin if k == axis else wide for k in range(3)]
        cards, m = fixed_block(name, *spans, (axis, 0.0), n)
        walls, n = walls + cards, n + m
        sides[f"CUBE_{name}"] = lambda body, axis=axis: body.where(axis, 0.0)
        pairs += pair(f"CUBE_{name}", f"{name}_SIDE", options=TYPES["s2s"])
    supports = fix("FLOOR_ALL, 1, 3", "WALLX_ALL, 1, 3", "WALLY_ALL, 1, 3")
    deck, nodes = pressed_cube(kind, walls, pairs, sides, [(0, 1.0), (1, 1.0), (2, 1.0)], supports)
    job = case.run(deck, requested=1)
    case.near("normal stresses", job.last("S")[: len(nodes), :3], -10.0, 1e-6, why="in the space of the elements",
              place="all nodes of the cube", time="the end")  # fmt: skip
    case.near("shear stresses", job.last("S")[: len(nodes), 3:], 0.0, 1e-6, why="in the space of the elements", scale=10.0,
              place="all nodes of the cube", time="the end")  # fmt: skip
    touching = np.flatnonzero((nodes < 1e-9).any(axis=1))
    case.near("contact pressure", job.last("CPRESS")[touching], 10.0, 1e-6, why="in the space of the elements",
              place="nodes at the walls", time="the end")  # fmt: skip
    case.done()


@pytest.mark.parametrize("kind", ["C3D4", "C3D8", "C3D10", "C3D20"])
@pytest.mark.parametrize("divided", ["masters", "slaves", "both"])
def test_seam(proof: Proof, kind: str, divided: str) -> None:
    """A block over the seam of two plates, and a block whose lower side is two surfaces."""
    case = proof(
        f"seam-{divided}-{kind.lower()}",
        title=f"Surface-to-surface pairs side by side: {divided} divided, {kind}",
        model=f"A cube of 3 x 3 x 3 cells of {kind}, E = 1000, nu = 0.3, on held plates: two masters whose seam is at x = 0.41, inside a row of slave faces, or "
        "a slave side that is two surfaces with a row of nodes in common, or both; frictionless, a pressure of 10 on the top, one increment.",
        formula="Stress zz = -10 and nothing else; contact pressure 10 at every node, at those of the seam too.",
        source="equilibrium",
        proves="A node that is slave in several surface-to-surface pairs with the same normal has one row of all of them.",
    )
    wide, low = np.array([-0.5, 0.45, 1.5]), np.array([-0.5, 0.0])
    spans = [np.array([-0.5, 0.41]), np.array([0.41, 1.5])] if divided != "slaves" else [wide]
    walls, n, names = "", 5000, []
    for k, span in enumerate(spans):
        cards, m = fixed_block(f"PLATE{k}", span, wide, low, (2, 0.0), n)
        walls, n, names = walls + cards, n + m, [*names, f"PLATE{k}"]
    halves = {"FOOT0": (-1.0, 0.6), "FOOT1": (0.6, 2.0)} if divided != "masters" else {"FOOT0": (-1.0, 2.0)}
    sides = {name: lambda body, a=a, b=b: np.flatnonzero((np.abs(body.nodes[:, 2]) < 1e-9) & (body.nodes[:, 0] > a - 1e-9) & (body.nodes[:, 0] < b + 1e-9))
             for name, (a, b) in halves.items()}  # fmt: skip
    meet = [(foot, k) for foot, (a, b) in halves.items() for k, span in enumerate(spans) if a < span[-1] and b > span[0]]
    pairs = "".join(pair(foot, f"PLATE{k}_SIDE", 0.0, TYPES["s2s"]).replace("ON_", f"{foot}_ON_") for foot, k in meet)
    supports = fix(*(f"{name}_ALL, 1, 3" for name in names), "X0, 1", "Y0, 2")
    deck, nodes = pressed_cube(kind, walls, pairs, sides, [(2, 1.0)], supports)
    held = "".join(solids.node_set(name, np.flatnonzero(np.abs(nodes[:, axis]) < 1e-9)) for name, axis in (("X0", 0), ("Y0", 1)))
    job = case.run(deck.replace("*STEP\n", held + "*STEP\n", 1), requested=1)
    n = len(nodes)
    case.near("stress", job.last("S")[:n], [0.0, 0.0, -10.0, 0.0, 0.0, 0.0], 1e-6, why="in the space of the elements", scale=10.0,
              place="all nodes of the upper body", time="the end")  # fmt: skip
    case.near("contact pressure", job.last("CPRESS")[:n][nodes[:, 2] < 1e-9], 10.0, 1e-6, why="in the space of the duals",
              place="nodes of the seam", time="the end")  # fmt: skip
    case.done()


@pytest.mark.slow
def test_symmetric_surfaces(proof: Proof) -> None:
    """A on B and B on A by surface to surface: the second pair is left out."""
    case = proof(
        "symmetric-pair-s2s",
        title="A symmetric pair by surface to surface",
        model="The cylinder on the block of symmetric-pair, mu = 0.2, NLGEOM, TYPE=SURFACE TO SURFACE: the cylinder slave alone, and both pairs.",
        formula="The same result.",
        source="the rule: of two pairs that are each other's mirror images the first counts",
        proves="Nothing is held twice.",
    )
    cylinder, below = flatten(arc(50.0, 40.0, 50.0, 0.6, 16, 14)), flatten(slab(100.0, 200.0, 1.0, 10, 14))
    first = pair("CYLINDER_BOTTOM", "BLOCK_TOP", 0.2, TYPES["s2s"])
    second = pair("BLOCK_TOP", "CYLINDER_BOTTOM", 0.2, TYPES["s2s"])
    jobs = [hertz(case, name, pairs, cylinder, below, True)[0] for name, pairs in (("one", first), ("both", first + second))]
    case.near("displacements", jobs[1].last("U"), jobs[0].last("U"), 1e-9, why="the same equations",
              place="all nodes", time="the end")  # fmt: skip
    case.done()


def test_mixed_types_share_no_mid_sides(run_deck: Callable[..., subprocess.CompletedProcess[str]]) -> None:
    """Quadratic slave faces of one body in a pair of each type, with a common edge: reported, with a remedy."""
    walls, pairs, n, sides = "", "", 5000, {}
    for axis, name, options in ((2, "FLOOR", ""), (0, "WALL", TYPES["s2s"])):
        spans = [np.array([-0.5, 0.0]) if k == axis else np.array([-0.5, 1.5]) for k in range(3)]
        cards, m = fixed_block(name, *spans, (axis, 0.0), n)
        walls, n = walls + cards, n + m
        sides[f"CUBE_{name}"] = lambda body, axis=axis: body.where(axis, 0.0)
        pairs += pair(f"CUBE_{name}", f"{name}_SIDE", options=options)
    supports = fix("FLOOR_ALL, 1, 3", "WALL_ALL, 1, 3")
    for kind, code in (("C3D20", 4), ("C3D8", 0)):
        deck, _ = pressed_cube(kind, walls, pairs, sides, [(0, 1.0), (2, 1.0)], supports + "*BOUNDARY\n1, 2\n")
        done = run_deck(deck)
        assert done.returncode == code, done.stdout
        assert ("Give both the same TYPE" in done.stdout) == (code == 4)
