"""Analytic rigid masters: lines, arcs, cylinders and balls that are exact, moved by a reference node.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from verify.cases.contact.test_sliding import strap_and_drum
from verify.cases.proof import Case, Job, observed_order
from verify.decks.make_decks import Mesh, block, graded
from verify.decks.planes import Plane, flat_deck, flatten
from verify.decks.sheets import Floats, between, fix, pair, plane_deck, sheet, solid_deck, step

Proof = Callable[..., Case]
REFERENCE = 9001
YOUNG, NU = 1000.0, 0.3
PLANE_STRAIN = YOUNG / (1 - NU**2)


def rigid(kind: str, profile: str, place: str, name: str = "TOOL", options: str = "") -> str:
    """An analytic surface and its reference node."""
    return (
        f"*NODE, NSET=REFERENCE\n{REFERENCE}, {place}\n*SURFACE, NAME={name}, TYPE={kind}{options}\n{profile}"
        f"*RIGID BODY, ANALYTICAL SURFACE={name}, REF NODE={REFERENCE}\n"
    )


# ----------------------------------------------------------------------------------------------------------- Hertz


def half_space(n: int) -> Plane:
    """The right half of a block 60 x 60 below y = 0, cells of 1/n near the origin."""
    return flatten(sheet("GROUND", graded(60.0, 1 / n, int(1.4 * n), 14), -graded(60.0, 1 / n, n // 2, 16)[::-1]))


def ellipse(x: Floats, p: Floats) -> tuple[float, float]:
    """Half width and peak of p^2 = p0^2 (1 - x^2/a^2) through the pressures above 0.4 of the largest."""
    inside = p > 0.4 * p.max()
    slope, square = np.polyfit(x[inside] ** 2, p[inside] ** 2, 1)
    return float(np.sqrt(-square / slope)), float(np.sqrt(square))


@pytest.mark.parametrize("kind", ["CPE4", "CAX4"])
def test_hertz(proof: Proof, kind: str) -> None:
    """A rigid cylinder, and a rigid ball, on a half-space, by a force on the reference node."""
    radius = 100.0
    is_ball = kind == "CAX4"
    force = 4 * PLANE_STRAIN / (3 * radius) if is_ball else np.pi * PLANE_STRAIN / (4 * radius)
    p0 = (6 * force * PLANE_STRAIN**2 / (np.pi**3 * radius**2)) ** (1 / 3) if is_ball else np.sqrt(force * PLANE_STRAIN / (np.pi * radius))
    case = proof(
        f"hertz-analytic-{'ball' if is_ball else 'cylinder'}",
        title=f"Hertz with an analytic rigid {'ball (axisymmetric)' if is_ball else 'cylinder'}",
        model=f"A block 60 x 60 (half of it; E = {YOUNG:g}, nu = {NU:g}, {kind}, 8 and 16 cells on the half width a = 1 of the contact) under an analytic arc of radius {radius:g}, "
        "*SURFACE, TYPE=SEGMENTS, whose reference node is pushed down by the force of a = 1 in 4 increments, small displacements.",
        formula="a = 1; p = p0 sqrt(1 - x^2/a^2), p0 = sqrt(F E\\*/(pi R)) of a cylinder with the force F per length, (6 F E\\*^2/(pi^3 R^2))^(1/3) of a ball.",
        source="Johnson, Contact Mechanics (1985), section 4.2",
        proves="The gap to a curved analytic master is exact: one node touches at first, sixteen in the end.",
    )
    arc = f"START, {radius / 2:.15g}, {radius * (1 - np.sqrt(0.75)):.15g}\nCIRCL, 0., 0., 0., {radius:g}\n"
    cards = fix("GROUND_BOTTOM, 1, 2", "GROUND_LEFT, 1", "REFERENCE, 1", "REFERENCE, 6") + f"*CLOAD\nREFERENCE, 2, {-force * (1 if is_ball else 0.5):.15g}\n"
    errors = []
    for n in (8, 16):
        ground = half_space(n)
        deck = flat_deck([(ground, (YOUNG, NU))], kind, rigid("SEGMENTS", arc, "0., 10.") + pair("GROUND_TOP", "TOOL") + step(cards, 4))
        job = case.run(deck, f"{n} cells", requested=4)
        slaves = ground.along("GROUND_TOP")
        x, p = job.points[slaves, 0], job.last("CPRESS")[slaves]
        a, peak = ellipse(x, p)
        errors.append(abs(peak / p0 - 1))
    case.near("peak pressure p0", peak, p0, 0.01, why="16 cells on the half width, and the block is 60 half widths large",
              place="x = 0", time="the end", order=f"{observed_order(errors):.1f}")  # fmt: skip
    case.near("half width a", a, 1.0, 0.02, why="as p0", place="x = a", time="the end")
    case.near("edge of contact", x[p > 0].max(), 1.0, 1.01 / n, why="one cell", place="x = a", time="the end")
    inner = x < 0.9
    case.near("pressure p(x), x < 0.9 a", p[inner], p0 * np.sqrt(1 - x[inner] ** 2), 0.02, why="of p0", place="x < 0.9 a", time="the end")
    case.done()


@pytest.mark.slow
def test_hertz_ball_in_space(proof: Proof) -> None:
    """A ball as a surface of revolution on a quarter of a block."""
    radius = 100.0
    force = 4 * PLANE_STRAIN / (3 * radius)
    p0 = (6 * force * PLANE_STRAIN**2 / (np.pi**3 * radius**2)) ** (1 / 3)
    case = proof(
        "hertz-analytic-revolution",
        title="Hertz with an analytic rigid ball in space",
        model="A quarter of a block 40 x 40 x 20 (E = 1000, nu = 0.3, C3D8, cells of a/6 near the contact) under *SURFACE, TYPE=REVOLUTION, a ball of radius 100 whose "
        "reference node is pushed down by the force of a = 1 in 2 increments, small displacements.",
        formula="a = 1, p0 = (6 F E\\*^2/(pi^3 R^2))^(1/3)",
        source="Johnson, Contact Mechanics (1985), section 4.2",
        proves="A surface of revolution, its pole at a slave node.",
    )
    line = graded(20.0, 1 / 6, 8, 8)
    ground = block(line, line, -graded(20.0, 1 / 6, 5, 8)[::-1], "GROUND")
    sides = {"XSIDE": np.flatnonzero(ground.nodes[:, 0] < 1e-9), "YSIDE": np.flatnonzero(ground.nodes[:, 1] < 1e-9)}
    profile = f"0., 0., {radius:g}, 0., 0., {radius + 1:g}\nSTART, {radius:g}, 0.\nCIRCL, 0., {-radius:g}, 0., 0.\n"
    held = fix("GROUND_BOTTOM, 1, 3", "XSIDE, 1", "YSIDE, 2", "REFERENCE, 1, 2", "REFERENCE, 4, 6") + f"*CLOAD\nREFERENCE, 3, {-force / 4:.15g}\n"
    job = case.run(solid_deck([(ground, (YOUNG, NU))], rigid("REVOLUTION", profile, "0., 0., 100.") + pair("GROUND_TOP", "TOOL"), step(held, 2), sides), requested=2)
    slaves = ground.node_sets["GROUND_TOP"]
    r, p = np.linalg.norm(job.points[slaves, :2], axis=1), job.last("CPRESS")[slaves]
    a, peak = ellipse(r, p)
    case.near("peak pressure p0", peak, p0, 0.04, why="cells of a/6, a block of 20 half widths", place="x = 0", time="the end")
    case.near("half width a", a, 1.0, 0.04, why="as p0", place="x = a", time="the end")
    case.near("force of the contact", job.last("CNORMF")[slaves, 2].sum(), -force / 4, 1e-6, why="equilibrium",
              place="all slave nodes", time="the end")  # fmt: skip
    case.done()


def test_surface_is_shown(proof: Proof) -> None:
    """The result file has the ball as cells, which turn and move with the reference node."""
    case = proof(
        "analytic-shown",
        title="An analytic ball in the result file",
        model="A cube under a ball of radius 3, a *SURFACE, TYPE=REVOLUTION, whose reference node, beside its axis, moves by (0.1, 0.2, 0) and turns by 0.5 about z.",
        formula="The points of the surface are R x + t; they lie on a ball",
        source="none needed",
        proves="What ParaView shows of a rigid master is where it is.",
    )
    cube = block(between(0, 1, 1), between(0, 1, 1), between(-1, 0, 1), "CUBE")
    profile = "0.5, 0.5, 3.5, 0.5, 0.5, 4.5\nSTART, 3., 0.\nCIRCL, 0., -3., 0., 0.\n"
    moves = fix("CUBE_BOTTOM, 1, 3", "REFERENCE, 1, 1, 0.1", "REFERENCE, 2, 2, 0.2", "REFERENCE, 3, 5", "REFERENCE, 6, 6, 0.5")
    job = case.run(solid_deck([(cube, (YOUNG, NU))], rigid("REVOLUTION", profile, "2., 0., 3.") + pair("CUBE_TOP", "TOOL"), step(moves, 2, True)), requested=2)
    first = 8 + 1 + 1 + 4
    shown, u = job.points[first:], job.last("U")[first:]
    case.true("points of the surface", len(shown) > 500, why="5 degrees a cell", place="the drawn surface", time="the end")
    centre, reference = np.array([0.5, 0.5, 3.5]), np.array([2.0, 0.0, 3.0])
    case.near("on the ball", np.linalg.norm(shown - centre, axis=1), np.full(len(shown), 3.0), 1e-12, why="exact",
              place="the drawn surface", time="the start")  # fmt: skip
    turn = np.array([[np.cos(0.5), -np.sin(0.5), 0], [np.sin(0.5), np.cos(0.5), 0], [0, 0, 1.0]])
    case.near("where they are", shown + u, (shown - reference) @ turn.T + reference + [0.1, 0.2, 0], 1e-7, why="the tolerance of the rigid body", scale=3.0,
              place="the drawn surface", time="the end")  # fmt: skip
    case.done()


IN_A_PART = """\
*HEADING
A ball as Abaqus/CAE writes it: in an instance that is shifted and turned.
*PART, NAME=CUBE
*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
*ELEMENT, TYPE=C3D8, ELSET=B
1, 1,2,3,4,5,6,7,8
*NSET, NSET=BOT
1,2,3,4
*SOLID SECTION, ELSET=B, MATERIAL=M
*SURFACE, NAME=TOP
B, S2
*END PART
*PART, NAME=BALL
*END PART
*ASSEMBLY, NAME=A
*INSTANCE, NAME=C1, PART=CUBE
*END INSTANCE
*INSTANCE, NAME=BALL-1, PART=BALL
0.5, 0., -0.5
0.5, 0., 0., 1.5, 0., 0., 90.
*NODE
1, 0., 7., 0.
*NSET, NSET=RP
1
*SURFACE, TYPE=REVOLUTION, NAME=SKIN
START, 6., 7.
CIRCL, 0., 1., 0., 7.
*RIGID BODY, REF NODE=RP, ANALYTICAL SURFACE=SKIN
*END INSTANCE
*END ASSEMBLY
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SURFACE INTERACTION, NAME=I
*FRICTION
0.2
*CONTACT PAIR, INTERACTION=I
C1.TOP, BALL-1.SKIN
*STEP, NLGEOM
*STATIC
0.5, 1.
*BOUNDARY
C1.BOT, 1, 3
BALL-1.RP, 1, 6
BALL-1.RP, 3, 3, -0.2
*END STEP
"""
PLAIN_BALL = "*SURFACE, NAME=SKIN, TYPE=REVOLUTION\n0.5, 0.5, 7., 0.5, 0.5, 8.\nSTART, 6., 0.\nCIRCL, 0., -6., 0., 0.\n*RIGID BODY, ANALYTICAL SURFACE=SKIN, REF NODE=900\n"


@pytest.mark.parametrize("blank", ["", "\n"])
def test_ball_in_a_part(proof: Proof, blank: str) -> None:
    """The axes of an analytic surface of a part move with its instance."""
    case = proof(
        f"analytic-in-a-part{'-blank' if blank else ''}",
        title="An analytic ball in a part" + (", a blank line for its axes" if blank else ""),
        model="A cube under a ball of radius 6 that goes down by 0.2, mu = 0.2, NLGEOM: the ball in an instance that is shifted and turned by 90 degrees about x, its profile in the axes of the part; and written "
        "where it is.",
        formula="The force at the reference node is the same",
        source="none needed",
        proves="Parts as Abaqus/CAE writes them.",
    )
    deck = IN_A_PART.replace("NAME=SKIN\n", f"NAME=SKIN\n{blank}")
    plain = deck.split("*PART, NAME=BALL")[0].replace("*PART, NAME=CUBE\n", "").replace("*END PART\n", "") + "*NODE\n900, 0.5, 0.5, 7.\n" + PLAIN_BALL
    plain += deck.split("*END ASSEMBLY\n")[1].replace("C1.", "").replace("BALL-1.RP", "900").replace("BALL-1.", "")
    forces = [case.run(text, name, requested=2).last("RF")[8] for name, text in (("part", deck), ("plain", plain))]
    case.near("force", forces[0], forces[1], 1e-10, why="the same model", place="reference node of the ball", time="the end")
    case.done()


# ---------------------------------------------------------------------------------------------------------- planes

WEIGHT = 4.0


def stone(angle: float) -> Plane:
    """A block 2 x 1 that stands on a plane through the origin, inclined by an angle."""
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    plane = flatten(sheet("STONE", between(0, 2, 8), between(0, 1, 4)))
    plane.nodes = plane.nodes @ turn.T
    plane.node_sets["STONE"] = np.arange(len(plane.nodes))
    return plane


def test_block_slides_on_inclined_plane(proof: Proof) -> None:
    """Above the critical angle a spring along the slope takes the force beyond the friction limit."""
    beta, mu, stiffness = 0.5, 0.3, 50.0
    case = proof(
        "incline-analytic-slip",
        title="A block slides on an inclined analytic plane, held by a spring",
        model=f"A block 2 x 1 (8 x 4 CPE4, E = 1e5, nu = 0.3) of weight {WEIGHT:g}, nodal forces, on *SURFACE, TYPE=SEGMENTS inclined by {beta:g} rad, mu = {mu:g}; a spring along the "
        f"slope (k = {stiffness:g}) from its upper corner to a fixed point. 5 increments, small displacements.",
        formula="k u = W (sin b - mu cos b); all of the contact slips",
        source="Coulomb",
        proves="Slip on a flat analytic master, whatever its direction.",
    )
    plane = stone(beta)
    along = np.array([np.cos(beta), np.sin(beta)])
    corner = int(np.argmin(np.linalg.norm(plane.nodes - 2 * along, axis=1)))
    anchor = plane.nodes[corner] + 3 * along
    spring = (
        f"*NODE, NSET=ANCHOR\n8001, {anchor[0]:.15g}, {anchor[1]:.15g}\n*ELEMENT, TYPE=SPRINGA, ELSET=SPRING\n8001, {corner + 1}, 8001\n*SPRING, ELSET=SPRING\n\n{stiffness:g}\n"
    )
    far = [f"{v:.15g}" for v in np.concatenate([-5 * along, 9 * along])]
    profile = f"START, {far[0]}, {far[1]}\nLINE, {far[2]}, {far[3]}\n"
    loads = "*CLOAD\n" + f"STONE, 2, {-WEIGHT / len(plane.nodes):.15g}\n"
    cards = spring + rigid("SEGMENTS", profile, "0., -1.") + pair("STONE_BOTTOM", "TOOL", mu) + step(fix("ANCHOR, 1, 3", "REFERENCE, 1, 2", "REFERENCE, 6") + loads, 5)
    job = case.run(flat_deck([(plane, (1e5, NU))], "CPE4", cards), requested=5)
    u = job.last("U")[corner, :2] @ along
    case.near("force of the spring", -stiffness * u, WEIGHT * (np.sin(beta) - mu * np.cos(beta)), 1e-5, why="the tolerance of Newton's method",
              place="spring", time="the end")  # fmt: skip
    status = job.last("CSTATUS")[plane.node_sets["STONE_BOTTOM"]]
    case.true("what touches slips", bool((status[status > 0] == 2).all() and (status > 0).sum() >= 3), why="above the critical angle",
              place="all slave nodes in contact", time="the end")  # fmt: skip
    force = job.last("RF")[len(plane.nodes) + 1]
    weight = np.array([0.0, WEIGHT]) - stiffness * -u * along
    case.near("force at the reference node", force[:2], weight, 1e-5, why="equilibrium", place="reference node", time="the end")
    case.done()


def test_tilting_table(proof: Proof) -> None:
    """A block sticks to a table that turns about a distant reference node."""
    angle, mu = 0.2, 0.3
    case = proof(
        "tilting-table",
        title="A block sticks on a table that tilts",
        model=f"A block 2 x 1 (8 x 4 CPE4, E = 1e5) of weight {WEIGHT:g}, nodal forces that keep their direction, on a flat analytic table with its reference node at (-3, 1). The table turns by "
        f"{angle:g} rad, atan(mu) = {np.arctan(mu):.4f}, and moves by (1, 2), in 6 increments, NLGEOM, mu = {mu:g}.",
        formula="The block goes along as a rigid body; force and moment at the reference node are those of the weight",
        source="statics",
        proves="Finite rotation and motion of an analytic master: sticking nodes stay where they touched, no slip piles up; the moment is exact.",
    )
    plane = stone(0.0)
    loads = "*CLOAD\n" + f"STONE, 2, {-WEIGHT / len(plane.nodes):.15g}\n"
    first = step(fix("REFERENCE, 1, 2", "REFERENCE, 6") + loads, 1, True)
    then = step(fix("REFERENCE, 1, 1, 1.", "REFERENCE, 2, 2, 2.", f"REFERENCE, 6, 6, {angle:g}"), 6, True)
    cards = rigid("SEGMENTS", "START, -10., 0.\nLINE, 10., 0.\n", "-3., 1.") + pair("STONE_BOTTOM", "TOOL", mu) + first + then
    job = case.run(flat_deck([(plane, (1e5, NU))], "CPE4", cards), requested=7)
    n = len(plane.nodes)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    centre = np.array([-3.0, 1.0])
    place = plane.nodes + job.last("U")[:n, :2]
    ridden = (plane.nodes - centre) @ turn.T + centre + [1.0, 2.0]
    case.near("where the block is", place, ridden, 2e-4, why="the block's own strain: 4 x weight/(E width)", scale=1.0,
              place="all nodes of the block", time="the end")  # fmt: skip
    bottom = plane.node_sets["STONE_BOTTOM"]
    away = (place - ridden)[bottom] @ turn[:, 1]
    case.near("distance from the table", away, np.zeros(len(bottom)), 1e-8, why="the tolerance of the gap", scale=1.0,
              place="bottom of the block", time="the end")  # fmt: skip
    slip = np.linalg.norm(job.last("CSLIP")[bottom], axis=1)
    case.near("slip", slip, np.zeros(len(bottom)), 1e-5, why="below the critical angle only the foremost node creeps with the block's strain", scale=1.0,
              place="bottom of the block", time="the end")  # fmt: skip
    force = job.last("RF")[n]
    case.near("force", force[:2], np.array([0.0, WEIGHT]), 2e-5, why="the tolerance of Newton's method", place="reference node", time="the end")
    moment = WEIGHT * (place[:, 0].mean() - (centre[0] + 1))
    case.near("moment", moment_of(job, n), moment, 2e-5, why="as the force", place="reference node", time="the end")
    case.done()


def moment_of(job: Job, reference: int) -> float:
    """The moment in the plane at a reference node: the reaction of the node made for its rotation, right after it."""
    return float(job.last("RF")[reference + 1][2])


# --------------------------------------------------------------------------------------------------------- capstan


@pytest.mark.slow
def test_capstan(proof: Proof) -> None:
    """A strap drawn over a quarter of an analytic drum."""
    case = proof(
        "capstan-analytic",
        title="Capstan on an analytic drum",
        model="A strap (t = 0.5, E = 1000, nu = 0) is shrunk by 0.05 on a quarter of a fixed analytic drum of radius 100, 100 CPE4 along it, small displacements, mu = 0.3. Its ends are "
        "held along it while contact is established (1 increment), then one is drawn by 1 (60 increments) while the other yields by 0.9, so that all of it slides.",
        formula="T2/T1 = exp(mu theta'), theta' = theta/(1 + t/(2 R))",
        source="Euler (1769), Eytelwein (1808)",
        proves="Friction along an analytic arc.",
    )
    strap = flatten(strap_and_drum(100)[0])
    for name, side in (("PULLED", "LEFT"), ("GIVEN", "RIGHT")):
        strap.node_sets[name] = np.setdiff1d(strap.node_sets[f"STRAP_{side}"], strap.node_sets["STRAP_BOTTOM"])
    supports = fix("REFERENCE, 1, 2", "REFERENCE, 6", "PULLED, 1", "GIVEN, 2")
    steps = step(supports, 1) + step(fix("PULLED, 1, 1, -1.", "GIVEN, 2, 2, 0.9"), 60)
    drum = rigid("SEGMENTS", "START, 0., 100.\nCIRCL, 100., 0., 0., 0.\n", "0., 0.")
    job = case.run(flat_deck([(strap, (1000.0, 0.0))], "CPE4", drum + pair("STRAP_BOTTOM", "TOOL", 0.3) + steps), requested=61)
    force = job.last("RF")
    found = force[strap.node_sets["PULLED"], 0].sum() / force[strap.node_sets["GIVEN"], 1].sum()
    case.near("T2/T1", found, np.exp(0.3 * np.pi / 2 / (1 + 0.5 / 200)), 0.01, why="linear elements bend too stiffly, as on a meshed drum",
              place="ends of the band", time="the end")  # fmt: skip
    stuck = job.last("CSTATUS")[strap.node_sets["STRAP_BOTTOM"]] == 1
    case.true("no node sticks", not stuck.any(), why="drawn far enough", place="all slave nodes", time="the end")
    case.done()


# ---------------------------------------------------------------------------------------------------------- roller

RADIUS = 2.0
ARC = f"START, {RADIUS * np.sin(np.pi / 3):.15g}, {RADIUS / 2:.15g}\nCIRCL, {-RADIUS * np.sin(np.pi / 3):.15g}, {RADIUS / 2:.15g}, 0., {RADIUS:g}\n"
ROLLER = rigid("SEGMENTS", ARC, f"0., {RADIUS:g}")


def ground() -> Mesh:
    """A block under the roller, in x-z."""
    return sheet("BLOCK", between(-3, 3, 36), between(-2, 0, 10))


def meshed_roller(n: int) -> Plane:
    """The lower part of the roller in n elements along the arc."""

    def place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        angle = s * np.pi / 3
        return (RADIUS - 0.5 * t) * np.sin(angle), RADIUS - (RADIUS - 0.5 * t) * np.cos(angle)

    return flatten(sheet("ROLLER", between(-1, 1, n), between(0, 1, 2), place))


def roll(y: int, rotation: int, *drive: str) -> str:
    """Down by 0.1 in 4 increments, then driven in 4; y is the direction that is down."""
    held = fix(f"BLOCK_BOTTOM, 1, {y}", f"{REFERENCE}, 1", f"{REFERENCE}, {y}, {y}, -0.1", f"{REFERENCE}, {rotation}")
    return step(held, 4, True) + step(fix(*drive), 4, True)


@pytest.mark.slow
def test_against_meshed_master(proof: Proof) -> None:
    """The finer a meshed rigid roller, the nearer it comes to the analytic one: second order."""
    case = proof(
        "analytic-against-meshed",
        title="An analytic roller against ever finer meshed ones",
        model="A block 6 x 2 (E = 1000, nu = 0.3, 36 x 10 CPE4, bottom fixed, slave) under a rigid roller of radius 2 that goes down by 0.1 and along by 0.2, 4 + 4 increments, NLGEOM, mu = 0.3: analytic, "
        "and meshed with 20, 40 and 80 elements along its arc of 120 degrees.",
        formula="The faces of the meshed roller lie inside its circle by h^2/(8 R): forces differ by the square of h",
        source="none needed",
        proves="The analytic master is the limit of meshed ones.",
    )
    block_under = flatten(ground())
    contact = pair("BLOCK_TOP", "TOOL", 0.3) + roll(2, 6, f"{REFERENCE}, 1, 1, 0.2")
    exact = case.run(flat_deck([(block_under, (YOUNG, NU))], "CPE4", ROLLER + contact), "analytic", requested=8)
    n = len(block_under.nodes)
    wanted = exact.last("RF")[n][:2]
    errors = []
    for cells in (20, 40, 80):
        tool = meshed_roller(cells)
        body = f"*NODE\n{REFERENCE}, 0., {RADIUS:g}\n*RIGID BODY, ELSET=ROLLER, REF NODE={REFERENCE}\n"
        deck = flat_deck([(block_under, (YOUNG, NU)), (tool, (YOUNG, NU))], "CPE4", body + contact.replace("BLOCK_TOP, TOOL", "BLOCK_TOP, ROLLER_BOTTOM"))
        job = case.run(deck, f"{cells} cells", requested=8)
        errors.append(float(np.linalg.norm(job.last("RF")[n + len(tool.nodes)][:2] - wanted) / np.linalg.norm(wanted)))
    order = observed_order([errors[0], errors[2]], 4.0)
    case.near("force of the finest meshed roller, error", errors[2], 0.0, 0.01, why="h^2/(8 R) of 80 cells is 0.2 % of the depth", scale=1.0,
              place="reference node", time="the end", order=f"{order:.1f}")  # fmt: skip
    case.within("observed order", order, (1.5, 2.6), why="second order", place="reference node", time="the end")
    case.done()


def test_turning_roller(proof: Proof) -> None:
    """A roller that turns in its dent: all of the contact slides, the moment is mu R N."""
    case = proof(
        "analytic-turning",
        title="An analytic roller turns in its dent",
        model="As before; the roller turns by 0.2 about its centre in 4 increments, mu = 0.3.",
        formula="M = mu R sum |N|: every normal passes through the centre",
        source="Coulomb",
        proves="Normals of an analytic arc are exact: the same on a meshed roller holds to a per cent.",
    )
    block_under = flatten(ground())
    job = case.run(flat_deck([(block_under, (YOUNG, NU))], "CPE4", ROLLER + pair("BLOCK_TOP", "TOOL", 0.3) + roll(2, 6, f"{REFERENCE}, 6, 6, 0.2")), requested=8)
    n = len(block_under.nodes)
    normal = np.linalg.norm(job.last("CNORMF")[:n], axis=1).sum()
    case.near("moment over mu R N", abs(moment_of(job, n)) / (0.3 * RADIUS * normal), 1.0, 1e-6, why="the tolerance of Newton's method",
              place="reference node", time="the end")  # fmt: skip
    status = job.last("CSTATUS")[:n]
    case.true("all of it slides", bool((status[status > 0] == 2).all() and (status > 0).sum() > 2), why="turned far enough",
              place="all slave nodes in contact", time="the end")  # fmt: skip
    case.done()


def test_clamped_by_a_force(proof: Proof) -> None:
    """A sheet between a die, a punch and a holder that only contact supports: the force goes through."""
    force, mu = 50.0, 0.1
    case = proof(
        "analytic-clamped",
        title="A sheet clamped by a holder under a force",
        model="A sheet 60 x 1 (E = 70000, nu = 0.3, 90 x 3 CPE4, symmetric at x = 0) lies on an analytic die (x >= 26.5, corner rounded by 5) and touches a fixed punch above (x <= 25, rounded by 5). "
        f"An analytic holder (x >= 26.5) is pressed on it by a force of {force:g} in 5 increments, NLGEOM, mu = {mu:g}.",
        formula="The die bears what holder and punch press; under the holder the sheet gets thinner by p t (1 - nu^2)/E, p = F/33.5, where its ends are far.",
        source="Equilibrium; Hooke's law in plane strain",
        proves="A rigid tool without any stiffness of its own is part of the interface, so the contact subproblem is solved first: otherwise the nodes between punch and die alternate between open and closed and no increment converges.",
    )
    sheet_between = flatten(sheet("SHEET", between(0, 60, 90), between(0, 1, 3)))
    die = rigid("SEGMENTS", "START, 26.5, -60.\nLINE, 26.5, 0.\nLINE, 100., 0.\n", "26., 0.", "DIE", ", FILLET RADIUS=5.")
    punch = rigid("SEGMENTS", "START, 25., 61.\nLINE, 25., 1.\nLINE, -1., 1.\n", "0., 1.", "PUNCH", ", FILLET RADIUS=5.")
    holder = rigid("SEGMENTS", "START, 100., 1.\nLINE, 26.5, 1.\nLINE, 26.5, 40.\n", "30., 1.", "HOLDER", ", FILLET RADIUS=0.5")
    tools = "".join(text.replace(str(REFERENCE), str(REFERENCE + k)) for k, text in enumerate((die, punch, holder)))
    pairs = pair("SHEET_BOTTOM", "DIE", mu) + pair("SHEET_TOP", "PUNCH", mu) + pair("SHEET_TOP", "HOLDER", mu)
    held = fix("SHEET_LEFT, 1", *(f"{REFERENCE + k}, 1, 6" for k in (0, 1)), f"{REFERENCE + 2}, 1", f"{REFERENCE + 2}, 6")
    job = case.run(flat_deck([(sheet_between, (70000.0, NU))], "CPE4", tools + pairs + step(f"{held}*CLOAD\n{REFERENCE + 2}, 2, {-force:g}\n", 5, True)), requested=5)
    pressed = job.last("CNORMF")[sheet_between.node_sets["SHEET_BOTTOM"]][:, 1].sum()
    above = job.last("CNORMF")[sheet_between.node_sets["SHEET_TOP"]][:, 1].sum()
    case.near("die and what is above, the difference", pressed + above, 0.0, 1e-6, why="Newton's tolerance", scale=force, place="all slave nodes", time="the end")
    u = job.last("U")
    middle = [sheet_between.along(name)[np.argmin(np.abs(sheet_between.nodes[sheet_between.along(name), 0] - 44.0))] for name in ("SHEET_BOTTOM", "SHEET_TOP")]
    thinner = force / 33.5 * (1 - NU**2) / 70000.0
    case.near("sheet under the middle of the holder, thinner by", u[middle[0]][1] - u[middle[1]][1], thinner, 0.02, why="the friction of the ends reaches in", place="x = 44", time="the end")
    case.done()


def test_drawn_equals_flat(proof: Proof) -> None:
    """The same roller drawn out across one layer of solids."""
    case = proof(
        "analytic-drawn",
        title="*SURFACE, TYPE=CYLINDER against TYPE=SEGMENTS",
        model="The block under the roller as before, down by 0.1 and along by 0.2: in two dimensions, and as one layer of C3D8 held across the plane under the drawn-out profile, turned into x-z by its local axes.",
        formula="Displacements are the same",
        source="none needed",
        proves="Local axes, generator and weights in space.",
    )
    flat = flatten(ground())
    plane = case.run(flat_deck([(flat, (YOUNG, NU))], "CPE4", ROLLER + pair("BLOCK_TOP", "TOOL", 0.3) + roll(2, 6, f"{REFERENCE}, 1, 1, 0.2")), "plane", requested=8)
    sheet_under = ground()
    drawn = rigid("CYLINDER", "0., 0., 0., 1., 0., 0.\n0., 1., 0.\n" + ARC, f"0., 0., {RADIUS:g}")
    steps = roll(3, 5, f"{REFERENCE}, 1, 1, 0.2").replace("*STATIC", "*STATIC", 1)
    steps = steps.replace(f"{REFERENCE}, 5\n", f"{REFERENCE}, 2\n{REFERENCE}, 4, 6\n", 1)
    solid = case.run(plane_deck([(sheet_under, (YOUNG, NU))], drawn + pair("BLOCK_TOP", "TOOL", 0.3), steps), "solids", requested=8)
    keep = np.flatnonzero(np.abs(sheet_under.nodes[:, 1]) < 1e-9)
    case.near("displacement", solid.last("U")[keep][:, [0, 2]], plane.last("U")[: len(flat.nodes), :2], 1e-6, why="the tolerance of Newton's method",
              place="all nodes", time="the end")  # fmt: skip
    case.done()
