"""Elastic bodies without contact against closed forms and published tables: Lame, Cook, NAFEMS LE10, the elastica, Hencky.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from verify.cases.elastic.test_solid_elements import tip_shares
from verify.cases.proof import Case, Job, observed_order
from verify.decks import make_decks
from verify.decks.make_decks import Mesh, block, grid_elements
from verify.decks.sheets import Floats, between, fix, plane_deck, sheet, step
from verify.decks.solids import Solids, as_kind, node_set, pressure_on

Proof = Callable[..., Case]


def whole_deck(body: Solids, elastic: tuple[float, float], cards: str, steps: str) -> str:
    """A body of one kind and material."""
    material = f"*MATERIAL, NAME=M\n*ELASTIC\n{elastic[0]:.15g}, {elastic[1]:.15g}\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n"
    return body.cards() + cards + material + steps


def snapped(body: Solids, place: Callable[[Floats], Floats]) -> Solids:
    """The body with all its nodes, mid-sides included, moved to where `place` puts them."""
    body.nodes = place(body.nodes)
    return body


# ------------------------------------------------------------------------------------- thick cylinder and sphere

INNER, OUTER, PRESSURE, YOUNG, NU = 1.0, 2.0, 10.0, 1000.0, 0.3


def tube(kind: str, n: int) -> Solids:
    """A quarter of a tube 0.25 long, n cells through, 2 n around."""

    def bend(p: Floats) -> Floats:
        angle, r = p[:, 0] * np.pi / 2, INNER + (OUTER - INNER) * p[:, 2]
        return np.stack([r * np.sin(angle), 0.25 * p[:, 1], r * np.cos(angle)], axis=1)

    cube = block(between(0, 1, 2 * n), between(0, 1, 1), between(0, 1, n), "TUBE")
    return snapped(as_kind(cube, kind), bend)


@pytest.mark.parametrize(
    ("kind", "tolerance", "order"), [("C3D8", 0.01, 1.6), ("C3D10", 0.002, 1.6), ("C3D20", 5e-4, 2.5), ("C3D20R", 5e-4, 2.5)]
)
def test_thick_cylinder(proof: Proof, kind: str, tolerance: float, order: float) -> None:
    """Inner pressure, plane strain: displacement at both faces."""
    case = proof(
        f"thick-cylinder-{kind.lower()}",
        title=f"Thick cylinder under inner pressure, {kind}",
        model="A quarter of a tube, radii 1 and 2, E = 1000, nu = 0.3, plane strain, pressure 10 inside, one increment; 4 and 8 cells through.",
        formula="u(r) = (1 + nu)/E p a^2/(b^2 - a^2) [(1 - 2 nu) r + b^2/r].",
        source="Lame (1852)",
        proves="Curved bodies, pressure on curved faces, symmetry supports.",
    )

    def exact(r: Floats) -> Floats:
        factor = (1 + NU) / YOUNG * PRESSURE * INNER**2 / (OUTER**2 - INNER**2)
        return factor * ((1 - 2 * NU) * r + OUTER**2 / r)

    errors = []
    for n in (4, 8):
        body = tube(kind, n)
        r = np.hypot(body.nodes[:, 0], body.nodes[:, 2])
        inside = np.flatnonzero(np.abs(r - INNER) < 1e-6)
        cards = node_set("X", body.where(0, 0.0)) + node_set("Z", body.where(2, 0.0))
        load = fix("X, 1", "Z, 3", "NODES, 2") + pressure_on(body.outer_faces(inside), PRESSURE)
        job = case.run(whole_deck(body, (YOUNG, NU), cards, step(load, 1)), f"{n} cells", requested=1)
        u = (job.last("U")[:, [0, 2]] * body.nodes[:, [0, 2]]).sum(axis=1) / r
        errors.append(float(np.abs(u - exact(r)).max() / exact(np.array([INNER]))[0]))
    found = observed_order(errors)
    case.near("radial displacement", errors[1], 0.0, tolerance, why="eight cells", place="all nodes", scale=1.0, order=f"{found:.1f}", time="the end")
    case.within("observed order", found, (order, 9.0), why="linear elements: 2, quadratic ones: 3 or more, less what is lost at curved faces",
                place="all nodes", time="the end")  # fmt: skip
    case.done()


@pytest.mark.parametrize(("kind", "tolerance", "order"), [("C3D8", 0.02, 1.6), ("C3D20R", 0.001, 2.5)])
def test_thick_sphere(proof: Proof, kind: str, tolerance: float, order: float) -> None:
    """Inner pressure: displacement."""
    case = proof(
        f"thick-sphere-{kind.lower()}",
        title=f"Thick sphere under inner pressure, {kind}",
        model="The part of a hollow sphere (radii 1 and 2, E = 1000, nu = 0.3) over a sixth of it, |x| < z, |y| < z by the symmetry planes x = 0 and "
        "y = 0: three patches on an octant; pressure 10 inside, one increment; 3 and 6 cells through.",
        formula="u(r) = p a^3/(E (b^3 - a^3)) [(1 - 2 nu) r + (1 + nu) b^3/(2 r^2)].",
        source="Lame (1852)",
        proves="Doubly curved bodies and pressure.",
    )

    def exact(r: Floats) -> Floats:
        factor = PRESSURE * INNER**3 / (YOUNG * (OUTER**3 - INNER**3))
        return factor * ((1 - 2 * NU) * r + (1 + NU) * OUTER**3 / (2 * r**2))

    errors = []
    for n in (3, 6):
        body = octant(kind, n)
        r = np.linalg.norm(body.nodes, axis=1)
        inside = np.flatnonzero(np.abs(r - INNER) < 1e-6)
        cards = "".join(node_set(f"P{axis}", body.where(axis, 0.0)) for axis in range(3))
        load = fix("P0, 1", "P1, 2", "P2, 3") + pressure_on(body.outer_faces(inside), PRESSURE)
        job = case.run(whole_deck(body, (YOUNG, NU), cards, step(load, 1)), f"{n} cells", requested=1)
        u = (job.last("U") * body.nodes).sum(axis=1) / r
        errors.append(float(np.abs(u - exact(r)).max() / exact(np.array([INNER]))[0]))
    found = observed_order(errors)
    case.near("radial displacement", errors[1], 0.0, tolerance, why="six cells", place="all nodes", scale=1.0, order=f"{found:.1f}", time="the end")
    case.within("observed order", found, (order, 9.0), why="linear elements: 2, quadratic ones: 3 or more, less what is lost at curved faces",
                place="all nodes", time="the end")  # fmt: skip
    case.done()


def octant(kind: str, n: int) -> Solids:
    """An octant of a hollow sphere: three patches that meet on the diagonal."""
    parts = []
    for axis in range(3):
        a, b, r = np.meshgrid(between(0, 1, n), between(0, 1, n), between(0, 1, n), indexing="ij")
        grid = [v.ravel(order="F") for v in (a, b, r)]
        nodes = np.stack(np.roll([grid[0], grid[1], np.ones_like(grid[0])], axis + 1, axis=0), axis=1)
        parts.append(Mesh(nodes + 1e3 * np.stack([grid[2]] * 3, axis=1), grid_elements(n, n, n)))
    body = as_kind(make_decks.weld(parts, 1e-6), kind)
    share = np.array([_layer(p) for p in body.nodes])
    cube = body.nodes - 1e3 * share[:, None]
    ray = np.tan(np.clip(cube, 0, 1) * np.pi / 4)
    ray /= np.linalg.norm(ray, axis=1, keepdims=True)
    body.nodes = ray * (INNER + (OUTER - INNER) * share)[:, None]
    return body


def _layer(point: Floats) -> float:
    """The radial share that was put onto all coordinates: the largest coordinate is 1e3 share + 1 on a cube's face."""
    return float((point.max() - 1.0) / 1e3)


# ------------------------------------------------------------------------------------------------ Cook's membrane


def panel_place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
    """Cook's panel from the unit square."""
    return 48 * s, (1 - t) * 44 * s + t * (44 + 16 * s)


def cook_c3d8(nu: float, n: int) -> str:
    """n x n linear hexahedra."""
    panel = sheet("PANEL", between(0, 1, n), between(0, 1, n), panel_place)
    right = panel.node_sets["PANEL_RIGHT"]
    ends = np.isin(panel.nodes[right, 2], [44.0, 60.0])
    shares = 6.25 * 16 / n / 2 * np.where(ends, 0.5, 1.0)
    forces = "*CLOAD\n" + "".join(f"{i + 1}, 3, {share:.15g}\n" for i, share in zip(right, shares, strict=True))
    return plane_deck([(panel, (70.0, nu))], "", step(fix("PANEL_LEFT, 1, 3") + forces, 1))


def cook_c3d20r(nu: float, n: int) -> str:
    """n x n quadratic hexahedra."""

    def place(p: Floats) -> Floats:
        x, z = panel_place(p[:, 0], p[:, 2])
        return np.stack([x, p[:, 1], z], axis=1)

    body = snapped(as_kind(block(between(0, 1, n), between(0, 1, 1), between(0, 1, n), "PANEL"), "C3D20R"), place)
    forces = "*CLOAD\n" + "".join(f"{k + 1}, 3, {6.25 * share:.15g}\n" for k, share in tip_shares(body).items())
    load = fix("LEFT, 1, 3", "NODES, 2") + forces
    return whole_deck(body, (70.0, nu), node_set("LEFT", body.where(0, 0.0)), step(load, 1))


def tip_of(job: Job) -> float:
    """uz at (48, 60)."""
    return float(job.last("U")[(np.abs(job.points - [48, 0, 60]) < 1e-9).all(axis=1), 2][0])


COOK = (
    "The panel (0,0) (48,44) (48,60) (0,44), E = 70, plane strain, left side held, shear 6.25 per area on the right side, one increment, small "
    "displacements"
)


def test_cook(proof: Proof) -> None:
    """Cook's membrane in plane strain."""
    case = proof(
        "cook",
        title="Cook's membrane",
        model=COOK + "; nu = 1/3; 8 x 8, 16 x 16 and 32 x 32 C3D8.",
        formula="Tip (48, 60) goes up by 32.00.",
        source="Cook (1974); CoFEA benchmark 02",
        proves="Bending and shear of a tapered panel.",
    )
    found = [tip_of(case.run(cook_c3d8(1 / 3, n), f"{n} x {n}", requested=1)) for n in (8, 16, 32)]
    case.near("tip", found[2], 32.0, 0.01, why="32 x 32 linear elements", place="(48, 60)", time="32 x 32", order=f"{observed_order(np.abs(np.diff(found))):.1f}")
    case.within("change from 16 to 32", abs(found[2] / found[1] - 1), (0.0, 0.02), why="convergence", place="(48, 60)", time="the end")
    case.done()


@pytest.mark.slow
def test_cook_incompressible(proof: Proof) -> None:
    """Cook's membrane, nearly incompressible: no locking."""
    case = proof(
        "cook-incompressible",
        title="Cook's membrane, nearly incompressible",
        model=COOK + "; nu = 0.499995; 8 x 8, 16 x 16 and 32 x 32 C3D8 (mean dilatation), 32 x 32 C3D20R.",
        formula="No closed form: two independent elements that do not lock have to agree, and to change little with the mesh. (CoFEA's benchmark 02 "
        "prints 28.8 for this; neither element tends to it.)",
        source="Cook (1974)",
        proves="Mean dilatation: no volumetric locking of C3D8 as nu goes to 1/2.",
    )
    tips = [tip_of(case.run(cook_c3d8(0.499995, n), f"C3D8 {n} x {n}", requested=1)) for n in (8, 16, 32)]
    order = f"{observed_order(np.abs(np.diff(tips))):.1f}"
    coarse, fine = tips[1:]
    quadratic = tip_of(case.run(cook_c3d20r(0.499995, 32), "C3D20R", requested=1))
    case.near("tip", fine, quadratic, 0.005, why="both are 1 % from their limit", place="(48, 60)", time="C3D8 against C3D20R", order=order)
    case.within("change from 16 to 32", abs(fine / coarse - 1), (0.0, 0.02), why="a locking element changes by factors",
                place="(48, 60)", time="the end")  # fmt: skip
    case.done()


# ---------------------------------------------------------------------------------------------------- NAFEMS LE10


@pytest.mark.parametrize(("kind", "tolerance"), [("C3D20", 0.02), ("C3D20R", 0.02), pytest.param("C3D10", 0.05, marks=pytest.mark.slow)])
def test_le10(proof: Proof, kind: str, tolerance: float) -> None:
    """Thick elliptic plate under pressure."""
    case = proof(
        f"nafems-le10-{kind.lower()}",
        title=f"NAFEMS LE10: thick elliptic plate, {kind}",
        model="A quarter of a plate 600 thick between the ellipses 2000 x 1000 and 3250 x 2750, E = 210000, nu = 0.3, pressure 1 on top; the outer "
        "side is held in x and y, its middle line in z; one increment, small displacements; 5 x 4 x 4 and 10 x 8 x 8 cells.",
        formula="sigma_yy at D (2000, 0, 300) = -5.38.",
        source="NAFEMS, The standard NAFEMS benchmarks, LE10",
        proves="Bending of thick curved plates, stress at a node of the surface.",
    )

    def place(p: Floats) -> Floats:
        angle, s = p[:, 0] * np.pi / 2, p[:, 1]
        x = (2000 + 1250 * s) * np.cos(angle)
        y = (1000 + 1750 * s) * np.sin(angle)
        return np.stack([x, y, p[:, 2]], axis=1)

    found = []
    for n in (1, 2):
        plate = block(between(0, 1, 5 * n)[::-1], between(0, 1, 4 * n), between(-300, 300, 4 * n), "PLATE")
        body = as_kind(plate, kind)
        outer = np.flatnonzero(np.abs(body.nodes[:, 1] - 1) < 1e-9)
        middle = outer[np.abs(body.nodes[outer, 2]) < 1e-9]
        body = snapped(body, place)
        cards = node_set("OUTER", outer) + node_set("MIDDLE", middle)
        cards += node_set("X", body.where(0, 0.0)) + node_set("Y", np.flatnonzero(np.abs(body.nodes[:, 1]) < 1e-9))
        top = body.outer_faces(body.where(2, 300.0))
        load = fix("OUTER, 1, 2", "MIDDLE, 3", "X, 1", "Y, 2") + pressure_on(top, 1.0)
        job = case.run(whole_deck(body, (210000.0, 0.3), cards, step(load, 1)), f"{5 * n} x {4 * n} x {4 * n}", requested=1)
        d = np.flatnonzero((np.abs(body.nodes - [2000, 0, 300]) < 1e-6).all(axis=1))[0]
        found.append(float(job.last("S")[d, 1]))
    case.near("sigma_yy", found[1], -5.38, tolerance, why="as NAFEMS accepts", place="D", time="the end")
    case.within("change from the coarser mesh", abs(found[1] / found[0] - 1), (0.0, 3 * tolerance), why="three times the tolerance of the finer", place="D", time="the end")
    case.done()


# -------------------------------------------------------------------------------------------------- the elastica


@pytest.mark.parametrize("search", ["NONE", "AUTO"])
def test_elastica(proof: Proof, search: str) -> None:
    """A slender cantilever with a large rotation under an end force."""
    length, load = 20.0, 4.0
    case = proof(
        f"elastica-{search.lower()}",
        title=f"Cantilever with a large rotation, line search {search}",
        model="A cantilever 20 x 1 x 1 (20 x 1 x 2 C3D20R), E = 12000, nu = 0, its end pulled across by P with P L^2/(E I) = 4 in 10 increments, NLGEOM.",
        formula="The elastica, E I theta'' = -P cos(theta), theta(0) = 0, theta'(L) = 0, integrated numerically in the test.",
        source="Euler (1744); Bisshopp and Drucker (1945)",
        proves="Large rotations with small strains.",
    )
    tip_x, tip_z = elastica(load)
    body = as_kind(block(between(0, length, 20), between(0, 1, 1), between(0, 1, 2), "BEAM"), "C3D20R")
    end = body.where(0, length)
    inertia, young = 1 / 12, 12000.0
    force = load * young * inertia / length**2
    points = end[np.abs(body.nodes[end, 2] - 0.5) < 1e-9]
    cards = node_set("ROOT", body.where(0, 0.0)) + node_set("END", points)
    steps = step(fix("ROOT, 1, 3") + f"*CLOAD\nEND, 3, {force / len(points):.15g}\n", 10, True)
    steps = steps.replace("*STATIC", f"*LINE SEARCH, TYPE={search}\n*STATIC")
    job = case.run(whole_deck(body, (young, 0.0), cards, steps), requested=10)
    u = job.last("U")[points].mean(axis=0) / length
    case.near("tip along", u[0], tip_x - 1, 0.01, why="shear and stretch of a beam of 20:1", scale=1.0, place="end of the axis", time="the end")
    case.near("tip across", u[2], tip_z, 0.01, why="shear and stretch of a beam of 20:1", scale=1.0, place="end of the axis", time="the end")
    case.done()


def elastica(load: float) -> tuple[float, float]:
    """x and z of the tip over the length for P L^2/(E I) = load, by shooting for the curvature at the root."""

    def shoot(curvature: float) -> Floats:
        def slope(_: float, y: Floats) -> list[float]:
            return [y[1], -load * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])]

        return solve_ivp(slope, (0, 1), [0, curvature, 0, 0], rtol=1e-10, atol=1e-12).y[:, -1]

    root = brentq(lambda k: shoot(k)[1], 0.0, load)
    end = shoot(root)
    return float(end[2]), float(end[3])


# --------------------------------------------------------------------------------------------- Hencky, by large strain


@pytest.mark.parametrize("kind", ["C3D8", "C3D10", "C3D20R"])
def test_hencky_cube(proof: Proof, kind: str) -> None:
    """A cube sheared and stretched far, against the closed form at every increment."""
    case = proof(
        f"hencky-{kind.lower()}",
        title=f"Simple shear of a cube, Hencky's law, {kind}",
        model="A cube (E = 1000, nu = 0.3, 2 x 2 x 2 cells), all its faces moved as in simple shear x + g z, g up to 2 in 10 increments, NLGEOM.",
        formula="tau = 2 G ln V, ln V from the eigenvalues of F F' for F = 1 + g e_x e_z': sigma_xz = 2 G asinh(g/2)/sqrt(4 + g^2) * 2/..., "
        "computed by an eigenvalue solution in the test; sigma_xx = -sigma_zz.",
        source="Hencky (1928); Bruhns, Xiao and Meyers (2001)",
        proves="The finite strain law itself, far from small: the shear stress of Hencky's law has its peak near g = 3.",
    )
    body = as_kind(block(between(0, 1, 2), between(0, 1, 2), between(0, 1, 2), "CUBE"), kind)
    outside = body.boundary_nodes()
    rows = [f"{n + 1}, 1, 1, {2 * body.nodes[n, 2]:.15g}" for n in outside] + [f"{n + 1}, 2, 3" for n in outside]
    job = case.run(whole_deck(body, (1000.0, 0.3), "", step(fix(*rows), 10, True)), requested=10)
    shear = 1000 / 2.6
    for g in (0.4, 1.0, 2.0):
        stress = job.field("S")[job.frame(g / 2)]
        squares, axes = np.linalg.eigh(np.array([[1 + g * g, g], [g, 1.0]]))
        tau = shear * (axes * np.log(squares)) @ axes.T
        wanted = np.zeros(6)
        wanted[[0, 2, 5]] = tau[0, 0], tau[1, 1], tau[0, 1]
        case.near("stress", stress, np.tile(wanted, (len(stress), 1)), 1e-7, why="uniform strain", time=f"g = {g:g}", place="all nodes")
    case.figure(lambda: shear_curve(job, shear), "Shear stress over shear; the line is the closed form.")
    case.done()


def shear_curve(job: Job, shear: float) -> object:
    """sigma_xz over g."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.5, 3.2))
    axes = figure.subplots()
    g = np.linspace(0, 2, 100)
    axes.plot(g, 2 * shear * np.arcsinh(g / 2) * 2 / np.sqrt(4 + g**2), "k-")
    axes.plot(2 * job.times, job.field("S")[:, 0, 5], "o")
    axes.set(xlabel="g", ylabel="shear stress")
    return figure
