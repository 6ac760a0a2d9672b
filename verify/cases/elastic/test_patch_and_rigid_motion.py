"""Patches, rotations, heat, and bodies that are joined: exact answers, each with a page.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from verify.cases.elastic.test_plane_and_discrete_elements import sheet
from verify.cases.elastic.test_solid_elements import NU, YOUNG, distorted, hencky_stress, hooke, voigt
from verify.cases.proof import Case
from verify.decks.make_decks import block
from verify.decks.sheets import Floats, between, fix, step
from verify.decks.solids import KINDS, as_kind, node_set, prescribed

Proof = Callable[..., Case]
TIGHT = "*CONTROLS, PARAMETERS=FIELD\n1e-10, 1e-10, , , 1e-10\n"
ELASTIC = f"*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, {NU}\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n"
PLANE_SHAPES = ["3", "4", "4R", "6", "8", "8R"]


def solid_patch(case: Case, kind: str, slope: Floats, is_nlgeom: bool) -> None:
    """An affine motion of the faces of a cube of distorted elements."""
    body = distorted(kind)
    u, outside = body.nodes @ slope.T, body.boundary_nodes()
    deck = body.cards() + ELASTIC + step(TIGHT + prescribed(outside, u[outside]), 2, is_nlgeom)
    what = "finite" if is_nlgeom else "small"
    job = case.run(deck, f"{kind}, {what}", requested=2)
    expected = hencky_stress(slope) if is_nlgeom else hooke(0.5 * (slope + slope.T))
    case.near("displacement", job.last("U"), u, 1e-9, why="exact but for rounding", place=kind, time=what)
    case.near("stress", job.last("S"), np.tile(voigt(expected), (len(u), 1)), 1e-8, why="exact but for rounding", place=kind, time=what)


def test_patches(proof: Proof) -> None:
    """Irons's patch test for every solid element."""
    case = proof(
        "patch-tests",
        title="Patch test of every solid element, distorted, small and finite strain",
        model="A cube of 3 x 3 x 3 cells (cut into tetrahedra and wedges where needed) whose inner nodes are moved at random by up to 12 % of its side; all "
        "nodes of its faces follow an affine motion, strains of 0.1 % and, NLGEOM, of 10 % to 80 %; 2 increments. E = 1000, nu = 0.3.",
        formula="u = A X inside as well; one stress everywhere: Hooke's law for sym A, Hencky's for F = 1 + A.",
        source="B. M. Irons (1966); closed form",
        proves="Completeness of every element: without it nothing converges.",
    )
    slope = np.array([[1.0, 0.5, -0.3], [0.2, -0.4, 0.6], [0.1, 0.7, 0.8]])
    for kind in KINDS:
        solid_patch(case, kind, 1e-3 * slope, False)
        solid_patch(case, kind, 0.1 * slope, True)
    case.done()


def plane_slope(prefix: str, is_nlgeom: bool) -> Floats:
    """An affine motion of a plane body in three dimensions, the third with what the kind of element requires; axisymmetric: u_r = a r, u_z = b z."""
    slope = np.zeros((3, 3))
    slope[:2, :2] = np.diag([1.0, -0.5]) if prefix == "CAX" else [[1.0, 0.5], [0.2, -0.4]]
    slope *= 0.1 if is_nlgeom else 1e-3
    if prefix == "CAX":
        slope[2, 2] = slope[0, 0]
    elif prefix == "CPS" and is_nlgeom:
        deformation = np.eye(2) + slope[:2, :2]
        slope[2, 2] = np.exp(-NU / (1 - NU) * np.log(np.linalg.det(deformation))) - 1
    elif prefix == "CPS":
        slope[2, 2] = -NU / (1 - NU) * np.trace(slope)
    return slope


@pytest.mark.parametrize("is_nlgeom", [False, pytest.param(True, marks=pytest.mark.slow)], ids=["small", "finite"])
def test_plane_patches(proof: Proof, is_nlgeom: bool) -> None:
    """The same for plane stress, plane strain and axisymmetric elements."""
    what = "finite strain" if is_nlgeom else "small strain"
    case = proof(
        f"patch-tests-plane{'-finite' * is_nlgeom}",
        title=f"Patch test of plane stress, plane strain and axisymmetric elements, distorted, {what}",
        model="A square of 4 x 4 cells whose inner corners are moved at random by up to a fifth of a cell; the rim follows an affine motion (axisymmetric: "
        f"u_r = a r, u_z = b z, the square at radii 1 to 2) with strains of {'5 to 10 %, NLGEOM' if is_nlgeom else '0.1 %'}, one increment. E = 1000, nu = 0.3.",
        formula="u = A X inside as well; one stress everywhere, "
        + ("Hencky's for F = 1 + A. " if is_nlgeom else "Hooke's law for sym A. ")
        + "Plane stress: sigma_zz = 0; plane strain: eps_zz = 0; axisymmetric: eps_theta = a.",
        source="B. M. Irons (1966); closed form",
        proves="Completeness of every plane and axisymmetric element.",
    )
    for prefix in ("CPS", "CPE", "CAX"):
        slope = plane_slope(prefix, is_nlgeom)
        stress = hencky_stress(slope) if is_nlgeom else hooke(0.5 * (slope + slope.T))
        for shape in PLANE_SHAPES:
            body = sheet(prefix, shape, (4, 4), lambda s, t: (1 + s, t), 0.2)
            rim = np.flatnonzero(((body.uv < 1e-9) | (body.uv > 1 - 1e-9)).any(axis=1))
            u = body.nodes @ slope[:2, :2].T
            kind = prefix + shape
            job = case.run(body.cards() + ELASTIC + step(TIGHT + fix(*rows_of(rim, u)), 1, is_nlgeom), kind, requested=1)
            case.near("displacement", job.last("U")[:, :2], u, 1e-9, why="exact but for rounding", place=f"all nodes, {kind}", time="the end")
            wanted = np.tile(voigt(stress), (len(u), 1))
            case.near("stress", job.last("S"), wanted, 1e-8, why="exact but for rounding", place=f"all nodes, {kind}", time="the end")
    case.done()


def rows_of(nodes: Floats, u: Floats) -> list[str]:
    """Data lines of BOUNDARY that give nodes of a plane body their displacements."""
    return [f"{n + 1}, {d + 1}, {d + 1}, {u[n, d]:.17g}" for n in nodes for d in (0, 1)]


@pytest.mark.slow
def test_plane_rotation(proof: Proof) -> None:
    """A turn by 60 degrees in the plane leaves no stress; nor does a shift along the axis."""
    case = proof(
        "rigid-rotation-plane",
        title="Rigid motion of every plane and axisymmetric element, distorted",
        model="The square of the patch test; its rim is turned by 60 degrees about the origin along straight paths in 3 increments, NLGEOM; axisymmetric "
        "elements, which have no other rigid motion, are shifted by 0.7 along the axis.",
        formula="u = (R - 1) X inside as well, no strain, no stress.",
        source="closed form",
        proves="Objectivity: strains along the path leave no residual stress.",
    )
    turn = np.array([[0.5, -np.sqrt(0.75)], [np.sqrt(0.75), 0.5]])
    for prefix in ("CPS", "CPE", "CAX"):
        for shape in PLANE_SHAPES:
            body = sheet(prefix, shape, (4, 4), lambda s, t: (1 + s, t), 0.2)
            rim = np.flatnonzero(((body.uv < 1e-9) | (body.uv > 1 - 1e-9)).any(axis=1))
            u = np.tile([0.0, 0.7], (len(body.nodes), 1)) if prefix == "CAX" else body.nodes @ turn.T - body.nodes
            kind = prefix + shape
            job = case.run(body.cards() + ELASTIC + step(TIGHT + fix(*rows_of(rim, u)), 3, True), kind, requested=3)
            case.near("displacement", job.last("U")[:, :2], u, 1e-9, why="exact but for rounding", place=f"all nodes, {kind}", time="the end")
            case.near("stress over E", job.last("S") / YOUNG, 0.0, 1e-8, why="exact but for rounding", place=f"all nodes, {kind}", time="the end",
                      scale=1.0)  # fmt: skip
    case.done()


@pytest.mark.parametrize("kind", ["T3D2", "T3D3"])
def test_bars_turned(proof: Proof, kind: str) -> None:
    """A row of bars of different lengths is stretched and turned."""
    stretch, area = 1.2, 0.1
    case = proof(
        f"patch-bars-{kind.lower()}",
        title=f"A row of {kind} in space, stretched and turned",
        model=f"Three {kind} one after the other along (1, 2, 2)/3, 1, 0.5 and 1.5 long, section 0.1, E = 1000; the ends of the row move so that it is 1.2 times as "
        "long and lies along x, in 5 increments, NLGEOM; the nodes between them are free along x alone. And turned without a stretch.",
        formula="Force E A ln(l)/l with the stretch l, none without it; the nodes between the ends part the row as before.",
        source="closed form: Kirchhoff's stress by the logarithmic strain, volume unchanged in the force per reference section",
        proves="One strain in bars of different lengths; no force from a rotation.",
    )
    along = np.array([1.0, 2.0, 2.0]) / 3
    ends = np.array([0.0, 1.0, 1.5, 3.0])
    places = ends if kind == "T3D2" else np.sort(np.concatenate([ends, (ends[1:] + ends[:-1]) / 2]))
    nodes = places[:, None] * along
    rows = "".join(f"{i}, {x:.15g}, {y:.15g}, {z:.15g}\n" for i, (x, y, z) in enumerate(nodes, start=1))
    per = 1 if kind == "T3D2" else 2
    bars = "".join(f"{e + 1}, {', '.join(str(per * e + 1 + i) for i in range(per + 1))}\n" for e in range(3))
    deck = f"*NODE, NSET=NODES\n{rows}*ELEMENT, TYPE={kind}, ELSET=ALL\n{bars}" + ELASTIC + f"{area}\n"
    for name, factor in (("stretched", stretch), ("turned", 1.0)):
        target = factor * places[:, None] * np.array([1.0, 0.0, 0.0])
        inner = range(1, len(places) - 1)
        moves = [f"{n + 1}, {d + 1}, {d + 1}, {target[n, d] - nodes[n, d]:.17g}" for n in (0, len(places) - 1) for d in range(3)]
        moves += [f"{n + 1}, {d + 1}, {d + 1}, {-nodes[n, d]:.17g}" for n in inner for d in (1, 2)]
        job = case.run(deck + step(TIGHT + fix(*moves), 5, True), name, requested=5)
        case.near("place", nodes + job.last("U"), target, 1e-8, why="exact but for rounding", place=f"all nodes, {name}", time="the end")
        wanted = YOUNG * area * np.log(factor) / factor
        case.near("force over E A", job.last("RF")[-1, 0] / (YOUNG * area), wanted / (YOUNG * area), 1e-8, why="exact but for rounding",
                  place=f"end of the row, {name}", time="the end", scale=1.0)  # fmt: skip
    case.done()


def test_rigid_rotation(proof: Proof) -> None:
    """A turn by 60 degrees leaves no stress."""
    case = proof(
        "rigid-rotation",
        title="Rigid rotation of every solid element, distorted",
        model="The cube of the patch test; its faces are turned by 60 degrees about the axis (1, 2, 2)/3 along straight paths in 3 increments, NLGEOM.",
        formula="u = (R - 1) X inside as well, no strain, no stress.",
        source="closed form",
        proves="Objectivity: strains along the path leave no residual stress.",
    )
    axis = np.array([1.0, 2.0, 2.0]) / 3
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    turn = np.eye(3) + np.sin(np.pi / 3) * cross + (1 - np.cos(np.pi / 3)) * cross @ cross
    for kind in KINDS:
        body = distorted(kind)
        u, outside = body.nodes @ turn.T - body.nodes, body.boundary_nodes()
        job = case.run(body.cards() + ELASTIC + step(TIGHT + prescribed(outside, u[outside]), 3, True), kind, requested=3)
        case.near("displacement", job.last("U"), u, 1e-9, why="exact but for rounding", place=kind, time="the end")
        case.near("stress over E", job.last("S") / YOUNG, 0.0, 1e-8, why="exact but for rounding", place=kind, scale=1.0, time="the end")
    case.done()


# ------------------------------------------------------------------------------------------------------------- heat


def test_thermal(proof: Proof) -> None:
    """A cube that is heated: free, between two walls, and held all around; and the thermal bow of a strip of two metals."""
    alpha, heat = 1e-5, 100.0
    case = proof(
        "thermal",
        title="Thermal expansion, free and constrained",
        model="A cube of 2 x 2 x 2 C3D8, E = 1000, nu = 0.3, alpha = 1e-5, heated by 100 in 2 increments: free, between two walls, held on all sides. "
        "A strip of two metals (each 1 x 20 x 1, E = 1000 and 2000, nu = 0, alpha = 1e-5 and 2e-5; C3D20R), heated by 100, held at one end.",
        formula="Free: strain alpha T, no stress. Walls: -E alpha T. All around: -E alpha T/(1 - 2 nu). Strip: curvature "
        "6 (alpha_2 - alpha_1) T (1 + m)^2/(h (3 (1 + m)^2 + (1 + m n)(m^2 + 1/(m n)))), m = 1, n = E_1/E_2, h = 2.",
        source="closed forms; S. Timoshenko, J. Opt. Soc. Am. 11 (1925) 233-255",
        proves="EXPANSION, INITIAL CONDITIONS and TEMPERATURE, stress from constraint.",
    )
    material = ELASTIC.replace("*SOLID", f"*EXPANSION, ZERO=20.\n{alpha}\n*SOLID")
    body = as_kind(block(between(0, 1, 2), between(0, 1, 2), between(0, 1, 2), "CUBE"), "C3D8")
    sides = "".join(node_set(f"P{axis}", body.where(axis, 0.0)) + node_set(f"Q{axis}", body.where(axis, 1.0)) for axis in range(3))
    start = "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNODES, 20.\n"
    hot = f"*TEMPERATURE\nNODES, {20 + heat}\n"
    rollers = ["P0, 1", "P1, 2", "P2, 3"]
    for name, walls, wanted in (
        ("free", [], [0.0, 0.0, 0.0]),
        ("walls", ["Q0, 1"], [-YOUNG * alpha * heat, 0.0, 0.0]),
        ("all around", ["Q0, 1", "Q1, 2", "Q2, 3"], [-YOUNG * alpha * heat / (1 - 2 * NU)] * 3),
    ):
        job = case.run(body.cards() + sides + material + start + step(TIGHT + fix(*rollers, *walls) + hot, 2), name, requested=2)
        case.near("stress", job.last("S")[:, :3], np.tile(wanted, (len(body.nodes), 1)), 1e-9, why="uniform", place=name, scale=YOUNG * alpha * heat,
                  time="the end")  # fmt: skip
        if name == "free":
            case.near("displacement", job.last("U"), alpha * heat * body.nodes, 1e-9, why="uniform", place=name, time="the end")
    length = 20.0
    body = as_kind(block(between(0, length, 20), [0.0, 1.0], [-1.0, 0.0, 1.0], "STRIP"), "C3D20R")
    upper = [i for i, nodes in enumerate(body.elements) if body.nodes[nodes, 2].mean() > 0]
    cards = body.cards() + "*ELSET, ELSET=UP\n" + "".join(f"{i + 1}\n" for i in upper)
    cards += "*ELSET, ELSET=LOW\n" + "".join(f"{i + 1}\n" for i in range(len(body.elements)) if i not in upper)
    for name, e, a in (("UP", 2000.0, 2 * alpha), ("LOW", 1000.0, alpha)):
        cards += f"*MATERIAL, NAME={name}\n*ELASTIC\n{e}, 0.\n*EXPANSION, ZERO=20.\n{a}\n*SOLID SECTION, ELSET={name}, MATERIAL={name}\n"
    end = body.where(0, 0.0)
    corner = end[np.abs(body.nodes[end][:, 1:]).sum(axis=1) < 1e-9]
    cards += node_set("END", end) + node_set("CORNER", corner) + node_set("SIDE", body.where(1, 0.0))
    job = case.run(cards + start + step(TIGHT + fix("END, 1", "SIDE, 2", "CORNER, 3") + hot, 1), "strip", requested=1)
    n = 0.5
    curvature = 6 * alpha * heat * 4 / (2 * (3 * 4 + (1 + n) * (1 + 1 / n)))
    tip = np.flatnonzero((np.abs(body.nodes - [length, 0, 0]) < 1e-9).all(axis=1))[0]
    case.near("deflection of the tip", job.last("U")[tip, 2], -curvature * length**2 / 2, 0.005, why="free edges disturb over one height of twenty",
              place="end of the strip", time="the end")  # fmt: skip
    case.done()


# ------------------------------------------------------------------------------------------------------ joined bodies


def test_bolt(proof: Proof) -> None:
    """A bolt tightened against two plates, then loaded from outside."""
    case = proof(
        "bolt",
        title="Pre-tensioned bolt: load shared with the plates",
        model="A bolt 1 x 1 x 4 (E = 2000, pre-tension section in its middle) between two struts 1 x 1 x 4 (E = 1000), nu = 0, C3D8; heads move together "
        "(EQUATION), the other ends are held. Step 1: the bolt is pulled by 10 at the section. Step 2: the section is fixed as it is. Step 3: 6 on the "
        "heads. One increment each.",
        formula="Bolt k_b = 500, struts together k_s = 500: after step 1 the bolt force is 10; in step 3 it takes 6 k_b/(k_b + k_s) more.",
        source="closed form; VDI 2230 has it as the joint diagram",
        proves="PRE-TENSION SECTION by force, then by length (BOUNDARY, FIXED), in one job.",
    )
    cards, nodes, elements = "", [], []
    heads: list[int] = []
    for k in range(3):
        column = block([2.0 * k, 2.0 * k + 1], [0.0, 1.0], between(0, 4, 2), "C")
        base = 12 * k
        nodes += [f"{base + i + 1}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(column.nodes)]
        elements += [(2 * k + e + 1, [base + n + 1 for n in element], k) for e, element in enumerate(column.elements)]
        heads += [base + i + 1 for i in np.flatnonzero(column.nodes[:, 2] == 4)]
    cards = "*NODE, NSET=ALL\n" + "\n".join(nodes) + "\n90, 0, 0, 9\n"
    for name, which in (("BOLT", (1,)), ("STRUTS", (0, 2))):
        cards += f"*ELEMENT, TYPE=C3D8, ELSET={name}\n" + "".join(f"{e}, {', '.join(map(str, n))}\n" for e, n, k in elements if k in which)
    cards += "*NSET, NSET=FEET\n" + "".join(f"{12 * k + i}\n" for k in range(3) for i in range(1, 5))
    cards += "*NSET, NSET=BOLTFEET\n" + "".join(f"{12 + i}\n" for i in range(1, 5))
    cards += "".join(f"*EQUATION\n2\n{n}, 3, 1., {heads[0]}, 3, -1.\n" for n in heads[1:])
    cards += "*SURFACE, NAME=CUT\n4, S1\n*PRE-TENSION SECTION, SURFACE=CUT, NODE=90\n0, 0, 1\n"
    for name, e in (("BOLT", 2000.0), ("STRUTS", 1000.0)):
        cards += f"*MATERIAL, NAME={name}\n*ELASTIC\n{e}, 0.\n*SOLID SECTION, ELSET={name}, MATERIAL={name}\n"
    first = TIGHT + fix("FEET, 1, 3") + "".join(f"{n}, 1, 2\n" for n in heads) + "*CLOAD\n90, 1, -10.\n"
    second = TIGHT + "*CLOAD, OP=NEW\n*BOUNDARY, FIXED\n90, 1\n"
    third = TIGHT + f"*CLOAD\n{heads[0]}, 3, 6.\n"
    job = case.run(cards + step(first, 1) + step(second, 1) + step(third, 1), requested=3)
    stress = job.field("S")[:, [i for i in range(12, 16)], 2]
    case.near("bolt force", stress[1], 10.0, 1e-8, why="uniaxial", time="tightened", place="all nodes of the bolt")
    case.near("bolt force", stress[2], 10.0, 1e-8, why="uniaxial", time="fixed", place="all nodes of the bolt")
    case.near("bolt force", stress[3], 10.0 + 6 * 500 / 1000, 1e-8, why="uniaxial", time="loaded", place="all nodes of the bolt")
    case.done()


def test_rigid_end(proof: Proof) -> None:
    """A cantilever whose end is a rigid body, bent by a moment on the reference node."""
    length, moment = 10.0, 5.0
    case = proof(
        "rigid-end",
        title="Moment on a rigid end: RIGID BODY with a rotation node, and COUPLING with KINEMATIC",
        model="A beam 10 x 1 x 1 (20 x 2 x 2 C3D20R), E = 1000, nu = 0, held at x = 0; the nodes at its end belong to a rigid body or a coupling whose "
        "reference node stands 1 off the axis; moment 5 about y there, one increment, small displacements.",
        formula="End rotation M L/(E I), deflection M L^2/(2 E I), both exact for nu = 0; the reference node moves with the rotation.",
        source="beam theory",
        proves="Rotations of reference nodes, their moments, and how they bind nodes.",
    )
    body = as_kind(block(between(0, length, 20), between(-0.5, 0.5, 2), between(-0.5, 0.5, 2), "BEAM"), "C3D20R")
    n = len(body.nodes)
    rotation, deflection = moment * length / (YOUNG / 12), moment * length**2 / (2 * YOUNG / 12)
    material = ELASTIC.replace(f"{YOUNG}, {NU}", f"{YOUNG}, 0.")
    start = f"*NODE\n{n + 1}, {length}, 0., 1.\n{n + 2}, {length}, 0., 1.\n*NSET, NSET=REF\n{n + 1}\n"
    end, root = body.where(0, length), body.where(0, 0.0)
    sets = node_set("END", end) + node_set("ROOT", root)
    surface = "*SURFACE, NAME=FACE, TYPE=NODE\nEND\n"
    axis = int(np.flatnonzero((np.abs(body.nodes - [length, 0, 0]) < 1e-9).all(axis=1))[0])
    for name, tie, load in (
        ("rigid body", f"*RIGID BODY, NSET=END, REF NODE={n + 1}, ROT NODE={n + 2}\n", f"*CLOAD\n{n + 2}, 2, {moment}\n"),
        ("coupling", f"{surface}*COUPLING, REF NODE={n + 1}, SURFACE=FACE, CONSTRAINT NAME=C\n*KINEMATIC\n1, 3\n", f"*CLOAD\n{n + 1}, 5, {moment}\n"),
    ):
        job = case.run(body.cards() + start + sets + tie + material + step(TIGHT + fix("ROOT, 1, 3") + load, 1), name, requested=1)
        u = job.last("U")
        case.near("deflection", u[axis, 2], -deflection, 1e-6, why="exact", place=f"end of the axis, {name}", time="the end")
        case.near("shift of the reference node", u[n, 0], rotation, 1e-6, why="exact: rotation times its distance from the axis", place=name,
                  time="the end")  # fmt: skip
    case.done()
