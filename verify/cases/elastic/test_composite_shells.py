"""Composite shells: laminates against classical lamination theory, Pagano's plate and a strip of NAFEMS.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from verify.cases.proof import Case
from verify.decks.shells import Floats, Shell, held, shell

Proof = Callable[..., Case]

CLT = "R. M. Jones, Mechanics of Composite Materials, 2nd edition, Taylor & Francis 1999, chapter 4"
LAMINA = (25.0e4, 1.0e4, 0.25, 0.5e4, 0.5e4, 0.2e4)  #: E1, E2, nu12, G12, G13, G23


def laminate(constants: Sequence[float], plies: Sequence[tuple[float, float]], more: str = "") -> str:
    """MATERIAL of a lamina and a section of plies of thickness and angle."""
    rows = "".join(f"{t:.15g}, 3, M, {angle:.15g}\n" for t, angle in plies)
    return f"*MATERIAL, NAME=M\n*ELASTIC, TYPE=LAMINA\n{', '.join(f'{c:.15g}' for c in constants)}\n*SHELL SECTION, ELSET=E, COMPOSITE{more}\n{rows}"


def abd(constants: Sequence[float], plies: Sequence[tuple[float, float]]) -> Floats:
    """The 6 x 6 stiffness of classical lamination theory: (N, M) of (strain, curvature)."""
    e1, e2, nu, g = constants[:4]
    q = np.linalg.inv(np.array([[1 / e1, -nu / e1, 0], [-nu / e1, 1 / e2, 0], [0, 0, 1 / g]]))
    z = -sum(t for t, _ in plies) / 2
    whole = np.zeros((6, 6))
    for t, angle in plies:
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        turn = np.array([[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]])
        stiffness = turn.T @ q @ turn
        for power, (row, column) in ((1, (0, 0)), (2, (0, 3)), (2, (3, 0)), (3, (3, 3))):
            whole[row : row + 3, column : column + 3] += stiffness * ((z + t) ** power - z**power) / power
        z += t
    return whole


def step(load: str) -> str:
    """One linear step."""
    return f"*STEP\n*STATIC\n{load}*END STEP\n"


def edge_load(body: Shell, dof: int, total: float) -> str:
    """A force or moment on the edge u = 1."""
    return "*CLOAD\n" + "".join(f"{i + 1}, {dof}, {total * w:.15g}\n" for i, w in body.edge_weights(0, 1.0).items())


@pytest.mark.parametrize("kind", ["S3", "S4", "S4R", "S6", "S8", "S8R"])
def test_cross_ply_bending(proof: Proof, kind: str) -> None:
    """An unsymmetric strip bends and stretches."""
    case = proof(
        f"composite-bending-{kind.lower()}",
        title=f"An unsymmetric strip [0/90] of {kind} bent by an end moment",
        model="A strip 10 x 1 of two plies of 0.05, E1 = 250000, E2 = 10000, nu12 = 0, clamped at x = 0, with a moment of 1 about -y at x = 10; ten cells.",
        formula="M = (D - B^2/A) k, w = k L^2/2, u = B k L/A (k upward, B < 0 with the stiff ply below).",
        source=CLT,
        proves="Layers with directions of their own; coupling of bending and stretching; the default axes of a shell.",
    )
    constants = (*LAMINA[:2], 0.0, *LAMINA[3:])
    plies = [(0.05, 0.0), (0.05, 90.0)]
    body = shell(kind, (10, 1), lambda u, v: (10 * u, v, 0 * u))
    job = case.run(body.cards() + laminate(constants, plies) + held(body.where(0, 0.0), "ENCASTRE") + step(edge_load(body, 5, -1.0)), kind)
    whole = abd(constants, plies)
    a, b, d = whole[0, 0], whole[0, 3], whole[3, 3]
    curvature = 1 / (d - b * b / a)
    tip = job.last("U")[body.at(1, 0.5)]
    case.near("deflection", float(tip[2]), 50 * curvature, 0.01, why="the clamped fibres stay straight", place="the end", time="the end")
    case.near("stretch", float(tip[0]), 10 * b / a * curvature, 0.01, why="the same; the sign of the coupling counts", place="the end", time="the end")
    case.done()


def test_angle_ply_twist(proof: Proof) -> None:
    """A plate [45/-45] twists where it is pulled."""
    plies = [(0.05, 45.0), (0.05, -45.0)]
    case = proof(
        "composite-twist",
        title="A plate [45/-45] pulled at its end",
        model="A plate 10 x 10 of two plies of 0.05, E1 = 250000, E2 = 10000, nu12 = 0.25, G12 = 5000, pulled with 1 along x, held at three corners; S4, 20 x 20.",
        formula="(strain, curvature) = inverse of the stiffness of classical lamination theory times (N, 0): the fourth corner moves by -kxy a b/2.",
        source=CLT,
        proves="Angles of layers about the normal, sign included.",
    )
    body = shell("S4", (20, 20), lambda u, v: (10 * u, 10 * v, 0 * u))
    supports = held([body.at(0, 0)], "1, 3") + held([body.at(1, 0)], "2, 3") + held([body.at(0, 1)], "3")
    pull = "*CLOAD\n" + "".join(f"{i + 1}, 1, {sign * w:.15g}\n" for end, sign in ((1.0, 1), (0.0, -1)) for i, w in body.edge_weights(0, end).items())
    job = case.run(body.cards() + laminate(LAMINA, plies) + supports + step(pull), "S4")
    state = np.linalg.solve(abd(LAMINA, plies), [0.1, 0, 0, 0, 0, 0])
    u = job.last("U")
    case.near("deflection", float(u[body.at(1, 1), 2]), -50 * state[5], 0.02, why="free edges are softer over a width of the thickness, here 1 %",
              place="the free corner", time="the end")  # fmt: skip
    case.near("stretch", float(u[body.at(1, 0), 0]), 10 * state[0], 0.02, why="the same", place="x = 10, y = 0", time="the end")
    case.done()


def test_shell_by_its_stiffness(proof: Proof) -> None:
    """A plate whose section is given by the 21 numbers of its stiffness."""
    plies = [(0.05, 0.0), (0.03, 30.0), (0.02, 90.0)]
    case = proof(
        "shell-by-its-stiffness",
        title="A plate by the stiffness of its section, pulled and bent",
        model="A plate 10 x 10, *SHELL GENERAL SECTION with A, B and D of the laminate [0/30/90] of 0.05, 0.03, 0.02, E1 = 250000, E2 = 10000, nu12 = 0.25, G12 = 5000; N11 = 0.1 or M11 = 0.001 at both ends, held at three corners; S4, 20 x 20.",
        formula="(strain, curvature) = inverse of the stiffness times (N, M): the fourth corner moves by -kxy a b/2, the middle of an edge by kxx a^2/8 against its ends.",
        source=CLT,
        proves="Layers have A, B and D of a section: its 21 numbers, their order and signs.",
    )
    whole = abd(LAMINA, plies)
    numbers = [float(whole[i, j]) for j in range(6) for i in range(j + 1)]
    rows = "".join(", ".join(f"{x:.15g}" for x in numbers[k : k + 8]) + "\n" for k in (0, 8, 16))
    body = shell("S4", (20, 20), lambda u, v: (10 * u, 10 * v, 0 * u))
    supports = held([body.at(0, 0)], "1, 3") + held([body.at(1, 0)], "2, 3") + held([body.at(0, 1)], "3")
    for dof, size in ((1, 1.0), (5, 0.01)):
        loads = "*CLOAD\n" + "".join(
            f"{i + 1}, {dof}, {sign * size * w:.15g}\n" for end, sign in ((1.0, 1), (0.0, -1)) for i, w in body.edge_weights(0, end).items()
        )
        job = case.run(body.cards() + f"*SHELL GENERAL SECTION, ELSET=E\n{rows}" + supports + step(loads), f"S4-{dof}")
        state = np.linalg.solve(whole, np.array([size / 10 if k == (0 if dof == 1 else 3) else 0.0 for k in range(6)]))
        u = job.last("U")
        name = "pull" if dof == 1 else "bending"
        why = "free edges are softer over a width of the thickness, here 1 %"
        case.near(f"{name}: twist", float(u[body.at(1, 1), 2]), -50 * state[5], 0.02, why=why, place="the free corner", time="the end")
        case.near(f"{name}: curvature", float(u[body.at(0.5, 0), 2]), 12.5 * state[3], 0.02, why=why, place="x = 5, y = 0", time="the end")
        case.near(f"{name}: stretch", float(u[body.at(1, 0), 0]), 10 * state[0], 0.02, why=why, place="x = 10, y = 0", time="the end")
    case.done()


def test_pressurized_tube(proof: Proof) -> None:
    """The axes follow a curved shell."""
    plies = [(0.01, 90.0), (0.02, 0.0), (0.01, 90.0)]
    case = proof(
        "composite-tube",
        title="A laminated tube under pressure",
        model="A quarter of a tube of radius 1 and length 0.5 about x, plies [90/0/90] of 0.01, 0.02, 0.01 (0: along x), E1 = 250000, E2 = 10000, nu12 = 0.25, "
        "inner pressure 100, free ends; S4, 24 x 4.",
        formula="u = R strain of the hoop under N = p R, by classical lamination theory.",
        source=CLT,
        proves="Projection of the axes on a curved shell.",
    )

    def place(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
        return 0.5 * v, np.sin(np.pi / 2 * u), np.cos(np.pi / 2 * u)

    body = shell("S4", (24, 4), place)
    supports = held(body.where(0, 0.0), "YSYMM") + held(body.where(0, 1.0), "ZSYMM") + held([body.at(0.5, 0)], "1")
    corner, along, _, across = body.nodes[body.elements[0]]
    normal = np.cross(along - corner, across - corner)
    outward = float(np.sign(normal[1:] @ body.nodes[0][1:]))
    job = case.run(body.cards() + laminate(LAMINA, plies) + supports + step(f"*DLOAD\nE, P, {100 * outward:.15g}\n"), "S4")
    state = np.linalg.solve(abd(LAMINA, plies), [0, 100, 0, 0, 0, 0])
    u = job.last("U")[body.at(0.5, 0.5)]
    case.near("radial displacement", float(np.hypot(u[1], u[2])), state[1], 0.02, why="thickness 4 % of the radius; pressure on the inner face: 2 %",
              place="the middle", time="the end")  # fmt: skip
    case.done()


@pytest.mark.parametrize("slenderness", [10, 20, 100])
def test_pagano_plate(proof: Proof, slenderness: int) -> None:
    """A thick laminate under a sine of pressure."""
    published = {10: 0.743, 20: 0.517, 100: 0.4337}[slenderness]
    case = proof(
        f"composite-pagano-{slenderness}",
        title=f"Pagano's plate [0/90/90/0], a/h = {slenderness}",
        model="A quarter of a square plate of side 1 and four equal plies, E1/E2 = 25, G12 = G13 = E2/2, G23 = E2/5, nu = 0.25, simply supported (v = w = 0 on "
        "the sides along y, u = w = 0 on those along x), pressure q sin(pi x) sin(pi y) on top; S4, 16 x 16, with one solid and with two for each ply.",
        formula="100 E2 w h^3/(q a^4) in the middle, elasticity of layers: 0.743, 0.517; for a/h = 100 lamination theory with shear: 0.4337",
        source="N. J. Pagano, S. J. Hatfield, Elastic behavior of multilayered bidirectional composites, AIAA J. 10 (1972) 931-933; J. N. Reddy, Mechanics "
        "of Laminated Composite Plates and Shells, 2nd edition, CRC Press 2004",
        proves="Transverse shear of laminates without a correction factor: each layer has its own shear strain.",
    )
    h = 1 / slenderness
    body = shell("S4", (16, 16), lambda u, v: (u / 2, v / 2, 0 * u))
    supports = held(body.where(0, 0.0), "2, 3") + held(body.where(1, 0.0), "1") + held(body.where(1, 0.0), "3")
    supports += held(body.where(0, 1.0), "XSYMM") + held(body.where(1, 1.0), "YSYMM")
    places = np.array([-1, 1]) / (2 * np.sqrt(3) * 16)
    faces, loads = "", "*DSLOAD\n"
    for e, nodes in enumerate(body.elements):
        u, v = body.uv[nodes].mean(axis=0)
        q = 1e-3 * h**3 * np.mean(np.sin(np.pi / 2 * (u + places))) * np.mean(np.sin(np.pi / 2 * (v + places)))
        faces += f"*SURFACE, NAME=F{e}\n{e + 1}, SPOS\n"
        loads += f"F{e}, P, {q:.15g}\n"
    for pieces, allowed in ((1, 0.03), (2, 0.015)):
        plies = [(h / 4 / pieces, angle) for angle in (0, 90, 90, 0) for _ in range(pieces)]
        section = laminate((25.0, 1.0, 0.25, 0.5, 0.5, 0.2), plies)
        job = case.run(body.cards() + section + faces + supports + step(loads), f"{pieces} a ply")
        w = -float(job.last("U")[body.at(1, 1), 2])
        case.near("deflection", w * 1e5, published, allowed, why="shear strain constant over a solid; 16 x 16", place=f"the middle, {pieces} a ply",
                  time="the end")  # fmt: skip
    case.done()


@pytest.mark.parametrize("kind", ["S3", "S4"])
@pytest.mark.parametrize("thickness", [0.1, 0.01])
def test_clamped_plate_of_layers(proof: Proof, kind: str, thickness: float) -> None:
    """Layers of one material are as one layer, however thin."""
    case = proof(
        f"composite-clamped-{kind.lower()}-{thickness:g}",
        title=f"A clamped plate of two equal layers, {kind}, thickness 1/{10 / thickness:.0f} of its side",
        model=f"A quarter of a square plate of side 10 and two layers of {thickness / 2:g}, E = 1e6, nu = 0.3, with clamped edges, under a pressure of 1; 8 x 8 cells.",
        formula="w = 0.0012653 p L^4 / D",
        source="S. Timoshenko, S. Woinowsky-Krieger, Theory of plates and shells, McGraw-Hill 1959, section 44",
        proves="No shear locking of layers: triangles without a bubble of the whole stack give 0.64 of the displacement. Clamped fibres leave Poisson's strain of "
        "each layer free: held, it takes 4 % of S4.",
    )
    body = shell(kind, (8, 8), lambda u, v: (5 * u, 5 * v, 0 * u))
    supports = held(body.where(0, 0.0), "XSYMM") + held(body.where(1, 0.0), "YSYMM") + held(body.where(0, 1.0), "ENCASTRE") + held(body.where(1, 1.0), "ENCASTRE")
    layers = f"*MATERIAL, NAME=M\n*ELASTIC\n1e6, 0.3\n*SHELL SECTION, ELSET=E, COMPOSITE\n{thickness / 2:g}, 3, M\n{thickness / 2:g}, 3, M\n"
    job = case.run(body.cards() + layers + supports + step("*DLOAD\nE, P, 1.\n"), kind)
    expected = 0.0012653 * 10**4 / (1e6 * thickness**3 / (12 * (1 - 0.3**2)))
    case.near("deflection", abs(float(job.last("U")[body.at(0, 0), 2])), expected, 0.01, why="the mesh", place="the centre", time="the end")
    case.done()


@pytest.mark.parametrize("plies", [(0, 90, 90, 0), (0, 90)], ids=["symmetric", "unsymmetric"])
@pytest.mark.parametrize("kind", ["S3", "S4"])
def test_thin_cross_ply(proof: Proof, kind: str, plies: tuple[int, ...]) -> None:
    """A thin laminate under an even pressure."""
    name = "/".join(str(angle) for angle in plies)
    case = proof(
        f"composite-thin-{kind.lower()}-{len(plies)}",
        title=f"A thin plate [{name}] of {kind}",
        model=f"A quarter of a square plate of side 1, thickness 0.001, plies [{name}], E1/E2 = 25, G12 = G13 = E2/2, G23 = E2/5, nu = 0.25, simply supported "
        "(v = w = 0 on the sides along y, u = w = 0 on those along x), even pressure; 16 x 16 cells.",
        formula="Navier's series of classical lamination theory: for each m, n the 3 x 3 system of the amplitudes of u, v, w, with A, B and D.",
        source="J. N. Reddy, Mechanics of Laminated Composite Plates and Shells, 2nd edition, CRC Press 2004, section 5.2",
        proves="Thin laminates of triangles bend without locking, with and without coupling to the membrane.",
    )
    thickness = 1e-3
    body = shell(kind, (16, 16), lambda u, v: (u / 2, v / 2, 0 * u))
    supports = held(body.where(0, 0.0), "2, 3") + held(body.where(1, 0.0), "1") + held(body.where(1, 0.0), "3")
    supports += held(body.where(0, 1.0), "XSYMM") + held(body.where(1, 1.0), "YSYMM")
    constants = (25.0, 1.0, 0.25, 0.5, 0.5, 0.2)
    stack = [(thickness / len(plies), float(angle)) for angle in plies]
    job = case.run(body.cards() + laminate(constants, stack) + supports + step("*DLOAD\nE, P, 1e-15\n"), kind)
    expected = navier(abd(constants, stack), 1e-15)
    case.near("deflection", abs(float(job.last("U")[body.at(1, 1), 2])), expected, 0.01, why="the mesh", place="the middle", time="the end")
    case.done()


def navier(whole: Floats, pressure: float) -> float:
    """Deflection in the middle of a cross-ply square of side 1 whose edges are held across and along themselves."""
    a, b, d = whole[:3, :3], whole[:3, 3:], whole[3:, 3:]
    total = 0.0
    for m in range(1, 40, 2):
        for n in range(1, 40, 2):
            x, y = m * np.pi, n * np.pi
            strain = np.array([[-x, 0, 0], [0, -y, 0], [y, x, 0]])  # of u cos sin, v sin cos
            turn = np.array([[0, 0, x * x], [0, 0, y * y], [0, 0, -2 * x * y]])  # curvatures of w sin sin
            stiffness = strain.T @ a @ strain + strain.T @ b @ turn + turn.T @ b @ strain + turn.T @ d @ turn
            load = np.array([0, 0, 16 * pressure / (m * n * np.pi**2)])
            total += float(np.linalg.solve(stiffness, load)[2]) * (-1) ** ((m + n) // 2 - 1)
    return total


@pytest.mark.parametrize(("kind", "n", "allowed"), [("S4", 40, 0.01), ("S8R", 20, 0.01)])
def test_nafems_strip(proof: Proof, kind: str, n: int, allowed: float) -> None:
    """Three-point bending of seven plies."""
    case = proof(
        f"composite-nafems-strip-{kind.lower()}",
        title=f"Laminated strip of NAFEMS, {kind}",
        model="A strip 50 x 10 on two lines 30 apart, line load of 10 per width in the middle; plies [0/90/0/90/0/90/0] of 0.1, the middle one of 0.4, "
        "E1 = 100000, E2 = 5000, nu12 = 0.4, G12 = 3000, G13 = G23 = 2000; half of it.",
        formula="Deflection 1.06; stress along the strip at the bottom 683.9 in the middle by beam theory, so 2/3 of it at a third of the way to the support, where "
        "the line load does not disturb it.",
        source="NAFEMS, Composites Benchmarks, report R0031, issue 2 (2001), test 1",
        proves="Stresses of layers, deflection with transverse shear.",
    )
    plies = [(0.1, 0.0), (0.1, 90.0), (0.1, 0.0), (0.4, 90.0), (0.1, 0.0), (0.1, 90.0), (0.1, 0.0)]
    body = shell(kind, (n, 4), lambda u, v: (25 * (1 - u), 10 * v, 0 * u))
    body.elements = [[nodes[i] for i in ([0, 3, 2, 1] if len(nodes) == 4 else [0, 3, 2, 1, 7, 6, 5, 4])] for nodes in body.elements]
    supports = held(body.where(0, 0.4), "3") + held(body.where(0, 1.0), "XSYMM") + held([body.at(1, 0.5)], "2")
    load = "*CLOAD\n" + "".join(f"{i + 1}, 3, {-50 * w:.15g}\n" for i, w in body.edge_weights(0, 1.0).items())
    constants = (1.0e5, 5.0e3, 0.4, 3.0e3, 2.0e3, 2.0e3)
    job = case.run(body.cards() + laminate(constants, plies) + supports + step(load), kind)
    case.near("deflection", -float(job.last("U")[body.at(1, 0.5), 2]), 1.06, allowed, why="published with three digits", place="the middle", time="the end")
    x = job.points
    bottom = np.flatnonzero((np.abs(x[:, 0] - 5) < 1e-6) & (np.abs(x[:, 1] - 5) < 1.3) & (x[:, 2] < -0.499))
    stress = float(np.mean(job.last("S")[bottom, 0]))
    case.near("stress", stress, 683.9 * 2 / 3, 0.01, why="means over the elements beside a node", place="bottom, 5 from the middle", time="the end")
    case.done()


@pytest.mark.parametrize("kind", ["S8R", "S6"])
def test_one_solid_through_all_layers(proof: Proof, kind: str) -> None:
    """Layers of different stiffness under pressure from both sides, calculix dialect."""
    case = proof(
        f"composite-one-solid-{kind.lower()}",
        title=f"Layers of different stiffness pressed across the thickness, calculix dialect, {kind}",
        model="A square 2 x 2 of layers of 0.1, 0.5 and 0.2 with E = 210, 1, 20, nu = 0, pressed with 1 on both faces; springs hold it.",
        formula="In one solid of 20 or 15 nodes the strain across the thickness is c0 + c1 z, z from -1 to 1: the least energy has c1 = -c0 E1/E2 and "
        "c0 = -2/(E0 - E1^2/E2), with the moments E_k = int E z^k dz of the layers. The stress is E (c0 + c1 z), not -1 as in separate layers.",
        source="Minimum of the potential energy: K.-J. Bathe, Finite Element Procedures, Prentice Hall 1996, section 4.2; one solid for all layers: CalculiX CrunchiX manual",
        proves="All layers are one solid, integrated layer by layer at two heights each: moments of a stiffness that jumps.",
    )
    thickness, moduli = np.array([0.1, 0.5, 0.2]), np.array([210.0, 1.0, 20.0])
    faces = 2 * np.concatenate([[0.0], np.cumsum(thickness)]) / thickness.sum() - 1
    e0, e1, e2 = (float(moduli @ np.diff(faces ** (k + 1)) / (k + 1)) for k in range(3))
    c0 = -2 / (e0 - e1 * e1 / e2)
    c1 = -c0 * e1 / e2
    body = shell(kind, (2, 2), lambda u, v: (2 * u, 2 * v, 0 * u))
    names = "ABC"
    cards = "".join(f"*MATERIAL, NAME={name}\n*ELASTIC\n{e:g}, 0.\n" for name, e in zip(names, moduli, strict=True))
    cards += "*SHELL SECTION, ELSET=E, COMPOSITE\n" + "".join(f"{t:g}, , {name}\n" for name, t in zip(names, thickness, strict=True))
    corners = [body.at(0, 0), body.at(1, 0), body.at(0, 1)]
    springs = [(corners[0], 1), (corners[0], 2), (corners[1], 2)] + [(corner, 3) for corner in corners]
    for i, (node, dof) in enumerate(springs):
        cards += f"*ELEMENT, TYPE=SPRING1, ELSET=K{i}\n{900 + i}, {node + 1}\n*SPRING, ELSET=K{i}\n{dof}\n1.\n"
    cards += "*SURFACE, NAME=TOP\nE, SPOS\n*SURFACE, NAME=BOTTOM\nE, SNEG\n"
    job = case.run("** dialect: calculix\n" + body.cards() + cards + step("*DSLOAD\nTOP, P, 1.\nBOTTOM, P, 1.\n"), kind)
    stress = job.integration_points("S")[-1]
    places = ((faces[:-1] + faces[1:]) / 2)[:, None] + np.outer(np.diff(faces), [-0.5, 0.5]) / np.sqrt(3)
    expected = moduli[:, None] * (c0 + c1 * places)
    n = stress.shape[0] // len(body.elements) // 6
    found = stress[:, 2].reshape(len(body.elements), 3, 2, n)
    case.near("stress across the thickness", found, np.broadcast_to(expected[None, :, :, None], found.shape), 2e-5,
              why="springs; S8R has a stabilization of 1e-5", place="all points", time="the end")  # fmt: skip
    case.done()


@pytest.mark.parametrize(("kind", "dialect"), [("S4", "abaqus"), ("S8R", "abaqus"), ("S6", "calculix"), ("S8R", "calculix")])
def test_tapered_laminate(proof: Proof, kind: str, dialect: str) -> None:
    """NODAL THICKNESS of a composite shell: all layers grow thinner in proportion."""
    case = proof(
        f"composite-tapered-{kind.lower()}-{dialect}",
        title=f"A tapered laminate of {kind} under a force at its end, dialect {dialect}",
        model="A strip 10 x 1 of [hard/soft/hard] in the proportion 1:2:1, E = 210000 and 70000, nu = 0, *NODAL THICKNESS from 0.4 at the clamp to 0.2 at the end, with 1 along z there; 20 cells.",
        formula="w = F int (L-x)^2/D(x) dx with D(x) = t(x)^3 sum E_k (z_k+1^3 - z_k^3)/3 over the unit thickness.",
        source=CLT,
        proves="Layers keep their share of the thickness at each node.",
    )
    body = shell(kind, (20, 1), lambda u, v: (10 * u, v, 0 * u))
    cards = "*MATERIAL, NAME=HARD\n*ELASTIC\n210000., 0.\n*MATERIAL, NAME=SOFT\n*ELASTIC\n70000., 0.\n"
    cards += "*SHELL SECTION, ELSET=E, COMPOSITE, NODAL THICKNESS\n.1, 3, HARD\n.2, 3, SOFT\n.1, 3, HARD\n*NODAL THICKNESS\n"
    cards += "".join(f"{i + 1}, {0.4 - 0.2 * u:.15g}\n" for i, (u, _) in enumerate(body.uv))
    cards += held(body.where(0, 0.0), "1, 6")
    job = case.run(f"** dialect: {dialect}\n" + body.cards() + cards + step(edge_load(body, 3, 1.0)), kind)
    unit = (210000 * (0.5**3 - 0.25**3) + 70000 * 0.25**3) * 2 / 3
    x = (np.arange(4000) + 0.5) * 10 / 4000
    exact = float(np.sum((10 - x) ** 2 / (unit * (0.4 - 0.02 * x) ** 3)) * 10 / 4000)
    case.near("deflection", float(job.last("U")[body.at(1, 0.5), 2]), exact, 0.01, why="shear adds E/G (t/L)^2, linear steps of the thickness h^2; each below 0.5 %",
              place="the end", time="the end")  # fmt: skip
    case.done()
