"""Contact of bodies in the plane and of bodies of revolution, by elements of two dimensions.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from verify.cases.contact.test_hertz import arc, fitted, slab
from verify.cases.contact.test_partial_slip import FAR, MU, NU, RADIUS, YOUNG, cylinders, mindlin
from verify.cases.contact.test_sliding import strap_and_drum
from verify.cases.proof import Case, observed_order
from verify.decks.make_decks import Mesh, graded
from verify.decks.planes import Plane, flat_deck, flatten
from verify.decks.sheets import Floats, between, fix, pair, plane_deck, sheet, step

Proof = Callable[..., Case]

# ----------------------------------------------------------------------------------------------- contact patch


def stack(kind: str, upper: int, lower: int, inner: float) -> tuple[list[tuple[Plane, tuple[float, float]]], str]:
    """Two sheets, one on the other, from x = inner to inner + 1; a pressure of 10 on the top."""
    above = flatten(sheet("ABOVE", between(inner, inner + 1, upper), between(1, 2, 2)))
    below = flatten(sheet("BELOW", between(inner, inner + 1, lower), between(0, 1, 2)))
    middle = (np.abs(above.nodes[:, 1] - 1.5) < 1e-9) & (np.abs(above.nodes[:, 0] - inner - 0.5) < 0.4)
    above.nodes[middle] += np.random.default_rng(5).uniform(-0.08, 0.08, (int(middle.sum()), 2))
    sides = ["ABOVE_LEFT, 1", "BELOW_LEFT, 1"] if inner == 0 or not kind.startswith("CAX") else []
    cards = pair("ABOVE_BOTTOM", "BELOW_TOP", 0.2) + step(fix("BELOW_BOTTOM, 2", *sides) + "*DSLOAD\nABOVE_TOP, P, 10.\n", 1)
    return [(above, (1000.0, 0.3)), (below, (1000.0, 0.3))], cards


@pytest.mark.parametrize(("kind", "inner"), [("CPE4", 0.0), ("CPS4", 0.0), ("CAX4", 0.0), ("CAX4", 1.0), ("CPS4R", 0.0), ("CPS4I", 0.0), ("CPE4I", 0.0),
                                              ("CAX4I", 0.0), ("CAX4I", 1.0)])
def test_patch(proof: Proof, kind: str, inner: float) -> None:
    """The same nodes on both sides: exact, in the plane and for the full circle."""
    thickness = 2.5
    case = proof(
        f"contact-patch-{kind.lower()}-{inner:g}",
        title=f"Contact patch test in two dimensions: {kind}" + (", a ring" if inner else ""),
        model=f"Two bodies 1 x 1 (x from {inner:g}), one on the other, E = 1000, nu = 0.3, {kind}, 3 facets on both sides, inner nodes of the "
        f"upper one moved at random; a pressure of 10 on the top, mu = 0.2; thickness {thickness:g} in the plane.",
        formula="Stress yy = -10 everywhere; contact pressure 10 at each node; the normal force is 10 times the area, thickness or full "
        "circle included.",
        source="Taylor and Papadopoulos (1991)",
        proves="Areas, forces and reactions of edges.",
    )
    parts, cards = stack(kind, 3, 3, inner)
    job = case.run(flat_deck(parts, kind, cards, thickness), requested=1)
    slaves = parts[0][0].node_sets["ABOVE_BOTTOM"]
    area = np.pi * ((inner + 1) ** 2 - inner**2) if kind.startswith("CAX") else thickness
    case.near("stress yy", job.last("S")[:, 1], -10.0, 1e-6, why="in the space of the elements", place="all nodes", time="the end")
    case.near("contact pressure", job.last("CPRESS")[slaves], 10.0, 1e-6, why="in the space of the elements", place="all slave nodes", time="the end")
    case.near("normal force", job.last("CNORMF")[slaves, 1].sum(), 10 * area, 1e-9, why="equilibrium", place="all slave nodes", time="the end")
    case.done()


# ----------------------------------------------------------------------------------------------- Hertz


@pytest.mark.parametrize("kind", ["CPE4", "CPE8"])
def test_hertz_line(proof: Proof, kind: str) -> None:
    """The cylinder on the block of NAFEMS R0094-1 in two dimensions."""
    radius, force = 50.0, 35000.0
    modulus = 1 / ((1 - 0.3**2) / 210000 + (1 - 0.3**2) / 70000)
    a = np.sqrt(4 * force * radius / (np.pi * modulus))
    p0 = np.sqrt(force * modulus / (np.pi * radius))
    case = proof(
        f"hertz-line-{kind.lower()}",
        title=f"Cylinder on a block by {kind}: Hertz in the plane",
        model=f"As NAFEMS R0094 benchmark 1, frictionless, but by {kind} (half of a cylinder's lower part R = 50 mm on half a block 200 x 200 mm, "
        "elements of a/10 at the contact, slave: the cylinder, 35 kN per mm in 10 increments, small displacements).",
        formula=f"a = sqrt(4 F R/(pi E\\*)) = {a:.4f} mm, p0 = sqrt(F E\\*/(pi R)) = {p0:.1f} MPa, p = p0 sqrt(1 - x^2/a^2).",
        source="Hertz (1882); NAFEMS R0094 (2006)",
        proves="Contact of edges: gap, normal, areas, opening and closing.",
    )
    cylinder = flatten(arc(radius, 40.0, 50.0, 0.6, 16, 14), kind == "CPE8")
    block = flatten(slab(100.0, 200.0, 0.6, 16, 14), kind == "CPE8")
    load = f"*DSLOAD\nCYLINDER_TOP, P, {force / 2 / 40:.15g}\n"
    supports = fix("BLOCK_BOTTOM, 1, 2", "CYLINDER_LEFT, 1", "BLOCK_LEFT, 1")
    cards = pair("CYLINDER_BOTTOM", "BLOCK_TOP") + step(supports + load, 10)
    job = case.run(flat_deck([(cylinder, (210000, 0.3)), (block, (70000, 0.3))], kind, cards), requested=10)
    slaves = cylinder.along("CYLINDER_BOTTOM")
    slaves = slaves[slaves < cylinder.elements[:, :4].max() + 1]
    x, p = job.points[slaves, 0], job.last("CPRESS")[slaves]
    found_a, found_p0 = fitted(x, p)
    case.near("peak pressure p0", found_p0, p0, 0.03, why="Hertz is 1 to 2 % off at a/R = 0.12", place="x = 0", time="the end")
    case.near("half width a", found_a, a, 0.03, why="as p0", place="x = a", time="the end")
    inner = x < 0.9 * a
    case.near("pressure", p[inner], p0 * np.sqrt(1 - (x[inner] / a) ** 2), 0.03, why="as p0", place="x < 0.9 a", time="the end")
    case.near("normal force", job.last("CNORMF")[slaves, 1].sum(), force / 2, 1e-6, why="equilibrium", place="all slave nodes", time="the end")
    case.done()


def test_hertz_axisymmetric(proof: Proof) -> None:
    """A ball on a rigid flat, as a body of revolution; two meshes."""
    radius, young, nu, depth = 50.0, 20000.0, 0.3, 0.1
    case = proof(
        "hertz-axisymmetric",
        title="Ball on a rigid flat, axisymmetric: Hertz",
        model="The lower part of a ball R = 50 (E = 20000, nu = 0.3, columns up to r = 40, 50 high), CAX4 of 0.15 and 0.075 at the contact, on a "
        f"fixed plate; the top goes down by {depth:g} in 5 increments, small displacements.",
        formula="With P the force found (full circle): a = (3 P R/(4 E\\*))^(1/3), p0 = 3 P/(2 pi a^2), p = p0 sqrt(1 - r^2/a^2), "
        "E\\* = E/(1 - nu^2).",
        source="Hertz (1882)",
        proves="Contact of bodies of revolution: areas and forces of the full circle.",
    )
    worst = []
    for fine in (0.15, 0.075):
        ball = flatten(arc(radius, 40.0, 50.0, fine, round(3 / fine), 14))
        plate = flatten(sheet("PLATE", [0.0, 10.0, 20.0, 30.0, 41.0], [-1.0, 0.0]))
        supports = fix("PLATE_BOTTOM, 1, 2", "PLATE_TOP, 1, 2", "BALL_LEFT, 1", f"BALL_TOP, 2, 2, {-depth}").replace("BALL", "CYLINDER")
        cards = pair("CYLINDER_BOTTOM", "PLATE_TOP") + step(supports, 5)
        job = case.run(flat_deck([(ball, (young, nu)), (plate, (young, nu))], "CAX4", cards), f"elements of {fine:g}", requested=5)
        force = -job.last("RF")[ball.node_sets["CYLINDER_TOP"], 1].sum()
        a = (3 * force * radius / (4 * young / (1 - nu**2))) ** (1 / 3)
        p0 = 3 * force / (2 * np.pi * a**2)
        slaves = ball.along("CYLINDER_BOTTOM")
        r, p = job.points[slaves, 0], job.last("CPRESS")[slaves]
        inner = (r > 0.2 * a) & (r < 0.8 * a)
        expected = p0 * np.sqrt(1 - (r[inner] / a) ** 2)
        worst.append(float(np.abs(p[inner] - expected).max() / p0))
        when = f"elements of {fine:g}"
        case.near("normal force", job.last("CNORMF")[slaves, 1].sum(), force, 1e-6, why="equilibrium", time=when, place="all slave nodes")
        case.near("pressure", p[inner], expected, 0.02, why=f"{a / fine:.0f} elements over a", place="0.2 a < r < 0.8 a", time=when, scale=p0)
        case.near("edge of contact", r[p > 0].max(), a, 1.0 * fine / a, why="one element", time=when, place="r = a")
    case.near("pressure, error over p0", worst[1], 0.0, 0.02, why="of the finer mesh", place="0.2 a < r < 0.8 a", time="the end", scale=1.0,
              order=f"{observed_order(worst):.1f}")  # fmt: skip
    case.done()


# ----------------------------------------------------------------------------------------------- partial slip


def test_cattaneo_mindlin(proof: Proof) -> None:
    """Two cylinders pressed, then sheared, by CPE4."""
    fine = 0.05
    case = proof(
        "cattaneo-mindlin-plane",
        title="Partial slip of two cylinders by CPE4: Cattaneo and Mindlin",
        model="Two equal cylinders R = 8, E = 200, nu = 0.3, mu = 0.2 (arcs with columns up to x = 4, 6 high), CPE4 of 0.05 at the contact (a/13); "
        "NLGEOM. Step 1 presses by 0.15 (5 increments), step 2 shifts the top by 0.023 (5).",
        formula="From the forces P and Q found: a = sqrt(2 P R/(pi E\\*)), stick in |x| < c = a sqrt(1 - Q/(mu P)), "
        "q = mu p0 [sqrt(1 - x^2/a^2) - (c/a) sqrt(1 - x^2/c^2)].",
        source="Cattaneo (1938); Mindlin (1949)",
        proves="Stick and slip side by side with one tangent.",
    )
    upper, lower = (flatten(part) for part in cylinders(fine))
    press = fix("LOWER_BOTTOM, 1, 2", "UPPER_TOP, 1", "UPPER_TOP, 2, 2, -0.15")
    steps = step(press, 5, True) + step(fix("UPPER_TOP, 1, 1, 0.023"), 5, True)
    parts = [(upper, (YOUNG, NU)), (lower, (YOUNG, NU))]
    job = case.run(flat_deck(parts, "CPE4", pair("UPPER_BOTTOM", "LOWER_TOP", MU) + steps), requested=10)
    force = job.last("RF")[upper.node_sets["UPPER_TOP"]].sum(axis=0)
    P, Q = -float(force[1]), float(force[0])
    slaves = upper.along("UPPER_BOTTOM")
    x = job.points[slaves, 0]
    a = np.sqrt(2 * P * RADIUS / (np.pi * YOUNG / (1 - NU**2) / 2))
    p0, c = 2 * P / (np.pi * a), a * np.sqrt(1 - Q / (MU * P))
    stuck = np.abs(x[job.last("CSTATUS")[slaves] == 1])
    case.near("edge of stick", stuck.max(), c, fine / c, why="one element", place="edge of the stick zone", time="the end")
    smooth = np.abs(x) < c - 1.5 * fine
    expected = mindlin(x[smooth], a, MU * p0, [Q / (MU * P)])
    why = "the bodies are 6 a wide and 9 a high"
    case.near("shear over mu p0", np.abs(job.last("CSHEAR")[slaves, 0][smooth]), expected, 0.03, why=why, place="where it sticks", scale=MU * p0,
              time="the end")  # fmt: skip
    case.done()


def test_flat_punch(proof: Proof) -> None:
    """A rigid flat punch with friction, by CPE4: Spence's stick zone."""
    n, nu, mu, expected = 40, 0.3, 0.3, 0.690
    case = proof(
        "spence-plane",
        title="Flat punch with friction by CPE4: Spence",
        model=f"The right half of a rigid flat punch, half width a = 1, {n} elements on it, pressed by 0.001 in 5 increments into an elastic block of 1000 a x "
        f"1000 a (E = 1000, nu = {nu:g}), CPE4, small displacements, mu = {mu:g}. Slave: the block.",
        formula=f"Stick in |x| < c, c/a = {expected:.3f} independent of the load (boundary elements, with the coupling of shear to pressure).",
        source="Spence, Proc. R. Soc. A 305 (1968) 55",
        proves="Friction under a pressing load in the plane, at a sharp corner of the master.",
    )
    ground = flatten(sheet("GROUND", graded(FAR, 1 / n, n + 4, 22), -graded(FAR, 1 / n, n // 4, 24)[::-1]))
    tool = flatten(sheet("TOOL", np.linspace(0, 1, n + 1), [0.0, 1.0]))
    tool.node_sets["ALL_TOOL"] = np.arange(len(tool.nodes))
    cards = fix("GROUND_BOTTOM, 1, 2", "GROUND_LEFT, 1", "ALL_TOOL, 1", "ALL_TOOL, 2, 2, -0.001")
    deck = flat_deck([(ground, (1000.0, nu)), (tool, (1000.0, nu))], "CPE4", pair("GROUND_TOP", "TOOL_BOTTOM", mu) + step(cards, 5))
    job = case.run(deck, requested=5)
    slaves = ground.along("GROUND_TOP")
    x = job.points[slaves, 0]
    for frame in (1, 3, 5):
        stuck = x[job.field("CSTATUS")[frame, slaves] == 1]
        case.near("c/a", stuck.max(), expected, 1.5 / n, why="one element and a half", time=f"{frame}/5", scale=1.0, place="edge of the stick zone")
    case.done()


@pytest.mark.slow
def test_capstan(proof: Proof) -> None:
    """A strap drawn over a quarter of a drum, by CPE4."""
    case = proof(
        "capstan-plane",
        title="Capstan by CPE4",
        model="A strap (t = 0.5, E = 1000, nu = 0) is shrunk by 0.05 on a quarter of a fixed drum of radius 100, 120 elements along it, CPE4, small "
        "displacements, mu = 0.3. Its ends are held along it while contact is established (1 increment), then one is drawn by 1 (60 increments) while the other yields "
        "by 0.9, so that all of it slides.",
        formula="T2/T1 = exp(mu theta'), theta' = theta/(1 + t/(2 R)).",
        source="Euler (1769), Eytelwein (1808)",
        proves="Friction along a curved edge.",
    )
    strap, drum = (flatten(part) for part in strap_and_drum(120))
    for name, side in (("PULLED", "LEFT"), ("GIVEN", "RIGHT")):
        strap.node_sets[name] = np.setdiff1d(strap.node_sets[f"STRAP_{side}"], strap.node_sets["STRAP_BOTTOM"])
    supports = fix("DRUM_BOTTOM, 1, 2", "DRUM_TOP, 1, 2", "PULLED, 1", "GIVEN, 2")
    steps = step(supports, 1) + step(fix("PULLED, 1, 1, -1.", "GIVEN, 2, 2, 0.9"), 60)
    parts = [(strap, (1000.0, 0.0)), (drum, (1e5, 0.0))]
    job = case.run(flat_deck(parts, "CPE4", pair("STRAP_BOTTOM", "DRUM_TOP", 0.3) + steps), requested=61)
    force = job.last("RF")
    found = force[strap.node_sets["PULLED"], 0].sum() / force[strap.node_sets["GIVEN"], 1].sum()
    expected = np.exp(0.3 * np.pi / 2 / (1 + 0.5 / 200))
    case.near("T2/T1", found, expected, 0.01, why="linear elements bend too stiffly; the mesh of solids is off as much",
              place="ends of the band", time="the end")  # fmt: skip
    case.done()


# ----------------------------------------------------------------------------------------------- against one layer of solids


def iron_parts() -> tuple[Mesh, Mesh]:
    """A stiff arc and a soft ground."""

    def place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        x = 0.6 * s
        return 1.2 + x, (2.0 + 0.75 - np.sqrt(0.75**2 - x**2)) * (1 - t) + 3.0 * t

    return sheet("IRON", between(-1, 1, 8), between(0, 1, 3), place), sheet("GROUND", between(0, 4, 20), between(0, 2, 6))


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_ironing_equals_solids(proof: Proof, mu: float) -> None:
    """Finite sliding over facets: the same as one layer of hexahedra held across the plane."""
    case = proof(
        f"ironing-plane-mu{mu:g}".replace(".", ""),
        title=f"Ironing in two dimensions against one layer of solids, mu = {mu:g}",
        model="A stiff arc (radius 0.75, E = 6896) is pressed by 0.3 into a ground 4 x 2 (E = 689.6, nu = 0.32; 20 x 6 cells) in 6 increments, then "
        f"drawn along by 1.2, six facets, in 12; NLGEOM, mu = {mu:g}: by CPE4 of thickness 1, and by one layer of C3D8 held across the plane.",
        formula="Displacements and contact forces are the same.",
        source="none needed: both are plane strain with the same shape functions and mean dilatation",
        proves="Walking over edges, smooth normals, creases and friction of edges are those of faces; the tangent is as good.",
    )
    upper, lower = iron_parts()
    materials = (6896.0, 0.32), (689.6, 0.32)
    jobs = {}
    for name, y in (("solids", 3), ("plane", 2)):
        held = fix(f"GROUND_BOTTOM, 1, {y}", "IRON_TOP, 1", f"IRON_TOP, {y}, {y}, -0.3")
        steps = step(held, 6, True) + step(fix("IRON_TOP, 1, 1, 1.2"), 12, True)
        contact = pair("IRON_BOTTOM", "GROUND_TOP", mu)
        if name == "solids":
            deck = plane_deck(list(zip((upper, lower), materials, strict=True)), contact, steps)
        else:
            parts = [(flatten(upper), materials[0]), (flatten(lower), materials[1])]
            deck = flat_deck(parts, "CPE4", contact + steps)
        jobs[name] = case.run(deck, name, requested=18)
    solids, plane = jobs["solids"], jobs["plane"]
    layer = np.flatnonzero(np.abs(solids.points[:, 1]) < 1e-9)
    case.true("as many increments", len(solids.times) == len(plane.times), why="the same problem", place="whole job", time="the end")
    case.near("u", plane.last("U")[:, :2], solids.last("U")[layer][:, [0, 2]], 1e-4, why="the tolerance of Newton's method", time="the end",
              place="all nodes")  # fmt: skip
    force = {name: job.last("CNORMF") + job.last("CSHEARF") for name, job in jobs.items()}
    case.near("contact force", force["plane"][:, :2], 2 * force["solids"][layer][:, [0, 2]], 2e-3, why="the same", time="the end",
              place="all slave nodes")  # fmt: skip
    case.within("iterations more than the solids", plane.n_iterations / solids.n_iterations, (0.0, 1.1), why="the same tangent",
                place="whole model", time="whole job")  # fmt: skip
    case.done()


def test_lap_of_rings(proof: Proof) -> None:
    """A shrink fit of two rings by CAX4: Lame."""
    young, d = 206e9, 0.002
    ri, rm, ro = 1.25, 1.516, 1.75
    p = young * d / (rm * (ro**2 + rm**2) / (ro**2 - rm**2) + rm * (rm**2 + ri**2) / (rm**2 - ri**2))
    case = proof(
        "shrink-fit-axisymmetric",
        title="Shrink fit of rings, axisymmetric: Lame",
        model="Two rings, radii 1.25, 1.516 and 1.75 m, 0.5 m long, E = 206 GPa, nu = 0, CAX4, 2 along, 6 through each; the inner "
        "one is 2 mm too large; one increment, small displacements.",
        formula=f"p = E d/(rm [(ro^2 + rm^2)/(ro^2 - rm^2) + (rm^2 + ri^2)/(rm^2 - ri^2)]) = {p:.5g} Pa; d/rm = 0.1 % is neglected.",
        source="Lame (1852)",
        proves="Interference at a contact along the axis: the area is 2 pi r times the length.",
    )
    inner = flatten(sheet("INNER", between(ri, rm + d, 6), between(0, 0.5, 2)))
    outer = flatten(sheet("OUTER", between(rm, ro, 6), between(0, 0.5, 2)))
    cards = pair("INNER_RIGHT", "OUTER_LEFT") + step(fix("INNER_BOTTOM, 2", "OUTER_BOTTOM, 2"), 1)
    job = case.run(flat_deck([(inner, (young, 0.0)), (outer, (young, 0.0))], "CAX4", cards), requested=1)
    slaves = inner.node_sets["INNER_RIGHT"]
    force = np.linalg.norm(job.last("CNORMF")[slaves], axis=1).sum()
    case.near("mean pressure", force / (2 * np.pi * rm * 0.5), p, 0.005, why="six elements through the walls",
              place="all slave nodes", time="the end")  # fmt: skip
    case.near("pressure", job.last("CPRESS")[slaves], p, 0.006, why="the radii are d apart; as the mean", place="all slave nodes", time="the end")
    case.done()
