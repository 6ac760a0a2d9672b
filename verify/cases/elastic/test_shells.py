"""Shells and beams expanded into solids: bending, twist, a knot, an offset and the Scordelis-Lo roof against closed forms and published figures.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.cases.proof import Case
from verify.conftest import Run
from verify.decks.shells import Floats, held, section, shell
from verify.readers.dat_frd_files import read_dat
from verify.study.shell_benchmarks import cylinder, hemisphere, roof

Proof = Callable[..., Case]

KINDS = ["S3", "S4", "S4R", "S8R", "S8", "S6"]


def step(load: str) -> str:
    """One linear step that writes U at all nodes."""
    return f"*STEP\n*STATIC\n{load}*END STEP\n"


def flat(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    """A strip 10 x 1 in the plane."""
    return 10 * u, v, 0 * u


@pytest.mark.parametrize("n", [1, 2, 8])
@pytest.mark.parametrize("kind", ["S8R", "S8", "S6"])
def test_clamped_edge_in_tension(proof: Proof, kind: str, n: int) -> None:
    """The whole thickness of a clamped edge is held, whatever the size of the elements."""
    case = proof(
        f"shell-clamp-{kind.lower()}-{n}",
        title=f"A clamped strip of {kind} pulled, {n} elements",
        model=f"A strip 10 x 1, thickness 0.5, E = 1.2e6, nu = 0, clamped at x = 0 by ENCASTRE, with a force of 60 along x at x = 10; {n} cells, small displacements.",
        formula="u = F L / (E A).",
        source="Bar theory, exact for nu = 0",
        proves="The middle of the thickness is held with its faces where the rotations of a shell are.",
    )
    body = shell(kind, (n, 1), flat)
    load = "*CLOAD\n" + "".join(f"{i + 1}, 1, {60 * w:.15g}\n" for i, w in body.edge_weights(0, 1.0).items())
    job = case.run(body.cards() + section(1.2e6, 0.0, 0.5) + held(body.where(0, 0.0), "ENCASTRE") + step(load), kind)
    for v in (0.0, 0.5, 1.0):
        case.near(f"u at {v}", float(job.last("U")[body.at(1, v), 0]), 60 * 10 / (1.2e6 * 0.5), 1e-6, why="solver tolerance", place="the end", time="the end")
    case.done()


@pytest.mark.parametrize("kind", KINDS)
def test_bending(proof: Proof, kind: str) -> None:
    """A strip bent by moments at its end."""
    case = proof(
        f"shell-bending-{kind.lower()}",
        title=f"A strip of {kind} bent by an end moment",
        model="A strip 10 x 1, thickness 0.1, E = 1.2e6, nu = 0, clamped at x = 0, with a moment of 1 about -y at x = 10; ten cells, small displacements.",
        formula="w = M L^2 / (2 E I), I = b t^3 / 12: w = 0.5; rotation M L / (E I).",
        source="Beam theory, exact for nu = 0",
        proves="Moments and supports of all six degrees of freedom act on the fibres of an expanded shell; bending without locking.",
    )
    body = shell(kind, (10, 1), flat)
    load = "*CLOAD\n" + "".join(f"{i + 1}, 5, {-w:.15g}\n" for i, w in body.edge_weights(0, 1.0).items())
    job = case.run(body.cards() + section(1.2e6, 0.0, 0.1) + held(body.where(0, 0.0), "ENCASTRE") + step(load), kind)
    tip = job.last("U")[body.at(1, 0.5), 2]
    case.near("deflection", float(tip), 0.5, 0.005, why="quadratic triangles are not exact", place="the end", time="the end")
    case.done()


def test_knot(proof: Proof) -> None:
    """A right angle: plate and flange with a force at the end of the flange."""
    case = proof(
        "shell-knot",
        title="An angle of two plates",
        model="A plate 10 x 1 along x and a flange of 5 along z at its end, thickness 0.1, E = 1.2e6, nu = 0; clamped at x = 0, a force of 0.1 along x at the "
        "end of the flange; S4, fifteen cells.",
        formula="The plate turns by M L / (E I) with M = F h: the end of the flange moves by F h^2 L / (E I) + F h^3 / (3 E I) along x.",
        source="Beam theory",
        proves="A knot carries moments from one plate to the other.",
    )

    def angle(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
        s = 15 * u
        return np.minimum(s, 10), v, np.maximum(s - 10, 0)

    body = shell("S4", (15, 1), angle)
    load = "*CLOAD\n" + "".join(f"{i + 1}, 1, {0.1 * w:.15g}\n" for i, w in body.edge_weights(0, 1.0).items())
    job = case.run(body.cards() + section(1.2e6, 0.0, 0.1) + held(body.where(0, 0.0), "ENCASTRE") + step(load), "angle")
    bending = 1.2e6 * 0.1**3 / 12
    expected = 0.1 * 5**2 * 10 / bending + 0.1 * 5**3 / (3 * bending)
    case.near("displacement", float(job.last("U")[body.at(1, 0.5), 0]), expected, 0.005, why="linear elements in bending that varies; the "
              "edge has a thickness", place="end of the flange", time="the end")  # fmt: skip
    case.done()


def test_offset(proof: Proof) -> None:
    """A strip whose nodes lie on top is pulled at them: it bends."""
    case = proof(
        "shell-offset",
        title="A strip pulled at its top",
        model="The strip 10 x 1 of thickness 0.1 with its nodes on top (OFFSET=SPOS), E = 1.2e6, nu = 0; clamped at x = 0, pulled with 1 at the nodes of its end.",
        formula="The force acts t/2 above the middle: u = N L / (E A) + M L (t/2) / (E I), w = -M L^2 / (2 E I), M = N t / 2.",
        source="Beam theory",
        proves="Offset of the nodes, in geometry and in the work of their forces.",
    )
    body = shell("S4", (10, 1), flat)
    load = "*CLOAD\n" + "".join(f"{i + 1}, 1, {w:.15g}\n" for i, w in body.edge_weights(0, 1.0).items())
    job = case.run(body.cards() + section(1.2e6, 0.0, 0.1, more=", OFFSET=SPOS") + held(body.where(0, 0.0), "ENCASTRE") + step(load), "offset")
    bending, stretching = 1.2e6 * 0.1**3 / 12, 1.2e6 * 0.1
    u = job.last("U")[body.at(1, 0.5)]
    case.near("along", float(u[0]), 10 / stretching + 0.05**2 * 10 / bending, 1e-8, why="exact for these elements", place="the end", time="the end")
    case.near("across", float(u[2]), -0.05 * 100 / (2 * bending), 1e-6, why="exact for these elements", place="the end", time="the end")
    case.done()


@pytest.mark.parametrize("n", [4, 8])
def test_roof(proof: Proof, n: int) -> None:
    """The Scordelis-Lo roof of S8R."""
    case = proof(
        f"scordelis-lo-{n}",
        title=f"Scordelis-Lo roof, S8R, {n} x {n}",
        model="A quarter of a cylindrical roof: radius 25, length 50, angle 80 degrees, thickness 0.25, E = 4.32e8, nu = 0, weight 90 per area; rigid diaphragms "
        "at the ends, free long edges.",
        formula="The middle of the free edge sinks by 0.3024.",
        source="R. H. MacNeal, R. L. Harder, Finite Elements in Analysis and Design 1 (1985) 3-20",
        proves="Curved shells: normals at the nodes, symmetry conditions with rotations.",
    )

    def place(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
        angle = np.radians(40 * u)
        return 25 * np.sin(angle), 25 * v, 25 * np.cos(angle)

    body = shell("S8R", (n, n), place)
    supports = held(body.where(1, 0.0), "1") + held(body.where(1, 0.0), "3") + held(body.where(1, 1.0), "YSYMM") + held(body.where(0, 0.0), "XSYMM")
    job = case.run(body.cards() + section(4.32e8, 0.0, 0.25, 360.0) + supports + step("*DLOAD\nE, GRAV, 1., 0, 0, -1\n"), f"{n} x {n}")
    case.near("sinking", float(-job.last("U")[body.at(1, 1), 2]), 0.3024, 0.02, why="2 % is the usual demand", place="free edge, middle",
              time="the end")  # fmt: skip
    case.done()


def test_hemisphere(proof: Proof) -> None:
    """The pinched hemisphere of S4: thin, curved, with little membrane strain."""
    case = proof(
        "hemisphere-s4",
        title="Pinched hemisphere with a hole, S4",
        model="A quarter of a hemisphere of radius 10 with a hole of 18 degrees, thickness 0.04, E = 6.825e7, nu = 0.3; two forces of 2 outward and two inward "
        "at its edge; 8 x 8 and 16 x 16 cells.",
        formula="The loaded places move by 0.0930.",
        source="R. H. MacNeal, R. L. Harder, Finite Elements in Analysis and Design 1 (1985) 3-20: 0.0940; J. C. Simo, D. D. Fox, M. S. Rifai, Comput. Methods "
        "Appl. Mech. Engrg. 73 (1989) 53-92: 0.0930",
        proves="No membrane, shear or thickness locking: assumed strains in trapezoidal solids.",
    )
    for n in (8, 16):
        body, deck, node, direction, expected = hemisphere("S4", n)
        job = case.run(deck, f"{n} x {n}")
        case.near("displacement", float(job.last("U")[node, direction]), expected, 0.02, why="2 % is the usual demand", place=f"loaded place, {n} x {n}",
                  time="the end")  # fmt: skip
    case.done()


def test_uneven_hemisphere(proof: Proof) -> None:
    """The pinched hemisphere of warped S4."""
    case = proof(
        "uneven-hemisphere-s4",
        title="Pinched hemisphere with a hole, uneven meshes of S4",
        model="The pinched hemisphere by 8 x 8 and 16 x 16 cells whose sides along an edge are as 1 : 2 : ... : n, along the opposite one the other way round.",
        formula="The loaded places move by 0.0930.",
        source="J. C. Simo, D. D. Fox, M. S. Rifai, Comput. Methods Appl. Mech. Engrg. 73 (1989) 53-92; meshes: Y. Ko, P.-S. Lee, K.-J. Bathe, Comput. Struct. 182 "
        "(2017) 404-418",
        proves="Warped faces bend without membrane strain; bilinear membrane strains would give 0.227 and 0.744 of the displacement.",
    )
    for n in (8, 16):
        _, deck, node, direction, expected = hemisphere("S4", n, True)
        job = case.run(deck, f"{n} x {n}")
        case.near("displacement", float(job.last("U")[node, direction]), expected, 0.02, why="2 % is the usual demand", place=f"loaded place, {n} x {n}",
                  time="the end")  # fmt: skip
    case.done()


@pytest.mark.parametrize(("n", "is_uneven"), [(8, False), (12, True)], ids=["even", "uneven"])
def test_large_deflection_of_hemisphere(proof: Proof, n: int, is_uneven: bool) -> None:
    """The pinched hemisphere under a hundred times the load: faces that were plane warp."""
    mesh = f"{'uneven ' if is_uneven else ''}{n} x {n}"
    case = proof(
        f"large-deflection-hemisphere-s4-{'un' * is_uneven}even",
        title=f"Pinched hemisphere with a hole, large displacements, S4, {mesh}",
        model=f"The pinched hemisphere under forces of 200, NLGEOM, {mesh} cells.",
        formula="The loaded places move by 3.406 outward and 5.902 inward.",
        source="K. Y. Sze, X. H. Liu, S. H. Lo, Finite Elements in Analysis and Design 40 (2004) 1551-1569: hemispherical shell under alternating radial forces",
        proves="Membrane strains of faces that warp as they deform; bilinear ones give 0.85 of the displacement outward with 8 x 8 cells.",
    )
    body, deck, node, _, _ = hemisphere("S4", n, is_uneven)
    other = body.at(1, 0)
    load = f"*STEP, NLGEOM, INC=100\n*STATIC\n.1, 1.\n*CLOAD\n{node + 1}, 1, 100.\n{other + 1}, 2, -100.\n*END STEP\n"
    job = case.run(deck.split("*STEP")[0] + load, mesh)
    why = "2 % is the usual demand"
    case.near("outward", float(job.last("U")[node, 0]), 3.406, 0.02, why=why, place="loaded place", time="the end")
    case.near("inward", -float(job.last("U")[other, 1]), 5.902, 0.02, why=why, place="loaded place", time="the end")
    case.done()


@pytest.mark.parametrize("is_uneven", [False, True], ids=["even", "uneven"])
def test_hemisphere_of_triangles(proof: Proof, is_uneven: bool) -> None:
    """The pinched hemisphere of S3."""
    mesh = f"{'uneven ' if is_uneven else ''}16 x 16"
    case = proof(
        f"hemisphere-s3-{'un' * is_uneven}even",
        title=f"Pinched hemisphere with a hole, S3, {mesh}",
        model=f"The pinched hemisphere by {mesh} cells of two triangles.",
        formula="The loaded places move by 0.0930.",
        source="J. C. Simo, D. D. Fox, M. S. Rifai, Comput. Methods Appl. Mech. Engrg. 73 (1989) 53-92",
        proves="No shear locking of thin triangles; shear strains tied at the edges alone give 0.854 and 0.624 of the displacement.",
    )
    _, deck, node, direction, expected = hemisphere("S3", 16, is_uneven)
    job = case.run(deck, mesh)
    case.near("displacement", float(job.last("U")[node, direction]), expected, 0.02, why="2 % is the usual demand", place="loaded place", time="the end")
    case.done()


@pytest.mark.parametrize(("problem", "n", "allowed"), [("roof", 4, 0.01), ("roof", 8, 0.01), ("cylinder", 8, 0.02), ("hemisphere", 16, 0.01)])
def test_curved_quadratic_triangles(proof: Proof, problem: str, n: int, allowed: float) -> None:
    """Thin curved shells of S6."""
    case = proof(
        f"curved-s6-{problem}-{n}",
        title=f"{problem.capitalize()} of S6, {n} x {n}",
        model=f"The Scordelis-Lo roof, the pinched cylinder or the pinched hemisphere with a hole, {n} x {n} cells of two quadratic triangles in a quarter (an "
        "eighth of the cylinder).",
        formula="The edge of the roof sinks by 0.3024, the loaded places move by 1.8248e-5 and 0.0930.",
        source="R. H. MacNeal, R. L. Harder, Finite Elements in Analysis and Design 1 (1985) 3-20; J. C. Simo, D. D. Fox, M. S. Rifai, Comput. Methods Appl. Mech. "
        "Engrg. 73 (1989) 53-92",
        proves="No membrane or shear locking of curved triangles: strains of the displacements give 0.81, 0.980, 0.66 and 0.89 on these meshes.",
    )
    _, deck, node, direction, expected = {"roof": roof, "cylinder": cylinder, "hemisphere": hemisphere}[problem]("S6", n)
    job = case.run(deck, f"{n} x {n}")
    case.near("displacement", float(job.last("U")[node, direction]), expected, allowed, why="the mesh", place="loaded place or free edge", time="the end")
    case.done()


def test_large_deflection_of_quadratic_triangles(proof: Proof) -> None:
    """The pinched hemisphere of S6 under a hundred times the load."""
    case = proof(
        "large-deflection-hemisphere-s6",
        title="Pinched hemisphere with a hole, large displacements, S6, 14 x 14",
        model="The pinched hemisphere under forces of 200, NLGEOM, 14 x 14 cells of two triangles.",
        formula="The loaded places move by 3.406 outward and 5.902 inward.",
        source="K. Y. Sze, X. H. Liu, S. H. Lo, Finite Elements in Analysis and Design 40 (2004) 1551-1569: hemispherical shell under alternating radial forces",
        proves="The assumed strains of S6 under large rotations.",
    )
    body, deck, node, _, _ = hemisphere("S6", 14)
    other = body.at(1, 0)
    load = f"*STEP, NLGEOM, INC=100\n*STATIC\n.1, 1.\n*CLOAD\n{node + 1}, 1, 100.\n{other + 1}, 2, -100.\n*END STEP\n"
    job = case.run(deck.split("*STEP")[0] + load, "14 x 14")
    case.near("outward", float(job.last("U")[node, 0]), 3.406, 0.02, why="2 % is the usual demand", place="loaded place", time="the end")
    case.near("inward", -float(job.last("U")[other, 1]), 5.902, 0.02, why="2 % is the usual demand", place="loaded place", time="the end")
    case.done()


@pytest.mark.parametrize(
    ("kind", "thickness"), [("S3", 1.0), ("S3", 0.1), ("S3", 0.01), ("S4", 1.0), ("S4", 0.1), ("S4", 0.01), ("S6", 0.01)]
)  # fmt: skip
def test_clamped_plate(proof: Proof, kind: str, thickness: float) -> None:
    """A clamped square plate under pressure, ever thinner."""
    case = proof(
        f"clamped-plate-{kind.lower()}-{thickness:g}",
        title=f"Clamped plate of {kind}, thickness 1/{10 / thickness:.0f} of its side",
        model=f"A quarter of a square plate of side 10, thickness {thickness:g}, E = 1e6, nu = 0.3, with clamped edges, under a pressure of 1; 8 x 8 cells.",
        formula="w = 0.0012653 p L^4 / D; of thickness L/10: 0.001465. Mindlin's plate with the shear factor 5/6 has 0.001505, so that shear adds 0.00024 times 5/6 without.",
        source="S. Timoshenko, S. Woinowsky-Krieger, Theory of plates and shells, McGraw-Hill 1959, section 44; thick: E. Hinton, Numerical methods and software for "
        "dynamic analysis of plates and shells, Pineridge Press 1988",
        proves="No shear locking, however thin the plate is: triangles that lock give 0.2 of the displacement at 1/1000.",
    )
    body = shell(kind, (8, 8), lambda u, v: (5 * u, 5 * v, 0 * u))
    supports = held(body.where(0, 0.0), "XSYMM") + held(body.where(1, 0.0), "YSYMM") + held(body.where(0, 1.0), "ENCASTRE") + held(body.where(1, 1.0), "ENCASTRE")
    job = case.run(body.cards() + section(1e6, 0.3, thickness) + supports + step("*DLOAD\nE, P, 1.\n"), kind)
    factor = 0.001465 if thickness > 0.5 else 0.0012653
    expected = factor * 10**4 / (1e6 * thickness**3 / (12 * (1 - 0.3**2)))
    case.near("deflection", abs(float(job.last("U")[body.at(0, 0), 2])), expected, 0.01, why="the mesh", place="the centre", time="the end")
    case.done()


def test_pinched_cylinder(proof: Proof) -> None:
    """The pinched cylinder of S4: membrane strains in a small place under a point load."""
    case = proof(
        "pinched-cylinder-s4",
        title="Pinched cylinder with diaphragms, S4",
        model="An eighth of a cylinder of radius 300, length 600, thickness 3, E = 3e6, nu = 0.3, pinched by two forces of 1; rigid diaphragms; 32 x 32 cells.",
        formula="The loaded place moves by 1.8248e-5.",
        source="G. M. Lindberg, M. D. Olson, G. R. Cowper, New developments in the finite element analysis of shells, Nat. Res. Council Canada DME/NAE Q. "
        "Bull. 4 (1969) 1-38",
        proves="Convergence under a point load; bilinear membrane strains need this mesh, as in Dvorkin and Bathe (1984).",
    )
    body, deck, node, direction, expected = cylinder("S4", 32)
    job = case.run(deck, "32 x 32")
    case.near("displacement", float(job.last("U")[node, direction]), expected, 0.02, why="2 % is the usual demand", place="loaded place", time="the end")
    case.done()


def test_plastic_moment(proof: Proof) -> None:
    """A strip bent beyond yield: equilibrium below the full plastic moment, none above it."""
    case = proof(
        "shell-plastic-moment",
        title="A strip of S4 bent beyond yield",
        model="The strip 10 x 1 of thickness 0.1, E = 1.2e6, nu = 0, perfectly plastic at 600, with a moment at its end; the other end is free to "
        "narrow; ten cells, small displacements.",
        formula="The full plastic moment is M_p = sigma b t^2 / 4 = 1.5; it yields at 2 M_p / 3. Two points over the thickness would carry 1.15 M_p.",
        source="W. Prager, P. G. Hodge, Theory of Perfectly Plastic Solids, Wiley 1951",
        proves="Plastic zones over the thickness: the limit of the moment lies between 0.98 and 1.02 M_p.",
    )
    body = shell("S4", (10, 1), flat)
    plastic = section(1.2e6, 0.0, 0.1).replace("*SHELL", "*PLASTIC\n600., 0.\n*SHELL")
    start = body.where(0, 0.0)
    supports = held(start, "1") + held(start, "3") + held(start, "5") + held(start[:1], "2")

    def deck(share: float) -> str:
        load = "*CLOAD\n" + "".join(f"{i + 1}, 5, {-1.5 * share * w:.15g}\n" for i, w in body.edge_weights(0, 1.0).items())
        return body.cards() + plastic + supports + f"*STEP, INC=100\n*STATIC\n.1, 1.\n{load}*END STEP\n"

    job = case.run(deck(0.98), "below the limit", requested=10)
    bent = float(job.last("U")[body.at(1, 0.5), 2]) / (0.5 * 0.98 * 1.5 / (1.2e6 * 0.1**3 / 12) * 100)
    case.within("deflection over the elastic one", bent, (1.2, 4.0), why="most of the thickness yields; 2.7 without transverse stresses", place="the end",
                time="the end")  # fmt: skip
    folder = case.work / "above"
    folder.mkdir()
    (folder / "job.inp").write_text(deck(1.02))
    above = case.runner(["--quiet", "job"], cwd=folder)
    case.true("no equilibrium above the limit", above.returncode != 0, why="five points by Simpson's rule give the exact limit", place="the strip",
              time="before the end")  # fmt: skip
    case.done()


@pytest.mark.parametrize(("kind", "n"), [("S4", 12), ("S8R", 6)])
@pytest.mark.parametrize(("direction", "expected"), [(3, 5.424e-3), (2, 1.754e-3)])
def test_twisted_beam(proof: Proof, kind: str, n: int, direction: int, expected: float) -> None:
    """MacNeal and Harder's twisted beam."""
    case = proof(
        f"twisted-beam-{kind.lower()}-{direction}",
        title=f"Twisted beam, {kind}, force {'in its plane' if direction == 3 else 'out of its plane'}",
        model="A strip of length 12, width 1.1, thickness 0.32, twisted by 90 degrees, E = 29e6, nu = 0.22, clamped at one end, a unit force at the other; "
        f"{n} x {n // 6} cells.",
        formula=f"The end moves by {expected} along the force.",
        source="R. H. MacNeal, R. L. Harder, Finite Elements in Analysis and Design 1 (1985) 3-20",
        proves="Warped elements, clamped ends.",
    )

    def place(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
        angle, across = np.radians(90 * u), 1.1 * (v - 0.5)
        return 12 * u, across * np.cos(angle), across * np.sin(angle)

    body = shell(kind, (n, n // 6), place)
    load = "*CLOAD\n" + "".join(f"{i + 1}, {direction}, {w:.15g}\n" for i, w in body.edge_weights(0, 1.0).items())
    job = case.run(body.cards() + section(29e6, 0.22, 0.32) + held(body.where(0, 0.0), "ENCASTRE") + step(load), kind)
    case.near("end", float(job.last("U")[body.at(1, 0.5), direction - 1]), expected, 0.02, why="2 % is the usual demand", place="the end",
              time="the end")  # fmt: skip
    case.done()


@pytest.mark.parametrize(("kind", "n", "allowed"), [("S4", 32, 0.0006), ("S8R", 8, 0.0005)])
def test_roll_up(proof: Proof, kind: str, n: int, allowed: float) -> None:
    """A strip rolled up to a quarter of a circle."""
    case = proof(
        f"shell-roll-up-{kind.lower()}",
        title=f"A strip of {kind} rolled up to a quarter of a circle",
        model=f"The strip 10 x 1, thickness 0.1, E = 1.2e6, nu = 0, clamped at x = 0; a moment at x = 10 grows to pi E I / 2 L in 20 increments, NLGEOM; {n} cells.",
        formula="The strip is an arc of radius R = E I / M = 2 L / pi: its end is at x = z = R.",
        source="Euler's elastica; K. Y. Sze, X. H. Liu, S. H. Lo, Finite Elements in Analysis and Design 40 (2004) 1551-1569, case 1",
        proves="Finite rotations of fibres: moments on knots turn them.",
    )
    body = shell(kind, (n, 1), flat)
    moment = np.pi / 2 * 1.2e6 * (0.1**3 / 12) / 10
    load = "*CLOAD\n" + "".join(f"{i + 1}, 5, {-moment * w:.15g}\n" for i, w in body.edge_weights(0, 1.0).items())
    deck = body.cards() + section(1.2e6, 0.0, 0.1) + held(body.where(0, 0.0), "ENCASTRE")
    job = case.run(deck + f"*STEP, NLGEOM, INC=200\n*STATIC\n.05, 1., , .05\n{load}*END STEP\n", kind, requested=20)
    u = job.last("U")[body.at(1, 0.5)]
    case.near("x", float(u[0]), 20 / np.pi - 10, allowed, why="the error of the mesh in the length of the arc", place="the end", time="the end")
    case.near("z", float(u[2]), 20 / np.pi, allowed, why="the same", place="the end", time="the end")
    case.done()


def test_contact_sees_thickness(proof: Proof) -> None:
    """Two parallel plates meet by their faces, not by their middles."""
    case = proof(
        "shell-contact",
        title="Two plates touch by SPOS and SNEG",
        model="Two plates 1 x 1 of thickness 0.2, middles 1 apart, E = 1000, nu = 0; the lower is held at its nodes, the upper is moved down by 0.801 at its nodes; "
        "one cell, four cells, frictionless.",
        formula="Faces touch after 0.8. A force F at the middle is shared by both faces: each plate gives way by F t / (4 E A), F = 2 E A 0.001 / t = 10.",
        source="Equilibrium of the faces",
        proves="Contact surfaces SPOS and SNEG lie half a thickness off the nodes.",
    )
    rows = ["*NODE, NSET=LOW\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n*NODE, NSET=UP\n"]
    rows += [f"{11 + i + 3 * j}, {i / 2}, {j / 2}, 1.\n" for j in range(3) for i in range(3)]
    rows.append("*ELEMENT, TYPE=S4, ELSET=A\n1, 1, 2, 3, 4\n*ELEMENT, TYPE=S4, ELSET=B\n")
    rows += [f"{2 + i + 2 * j}, {11 + i + 3 * j}, {12 + i + 3 * j}, {15 + i + 3 * j}, {14 + i + 3 * j}\n" for j in range(2) for i in range(2)]
    rows.append("*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n*SHELL SECTION, ELSET=A, MATERIAL=M\n.2\n*SHELL SECTION, ELSET=B, MATERIAL=M\n.2\n"
                "*SURFACE, NAME=TOP\nA, SPOS\n*SURFACE, NAME=UNDER\nB, SNEG\n*SURFACE INTERACTION, NAME=I\n*CONTACT PAIR, INTERACTION=I\nUNDER, TOP\n"
                "*BOUNDARY\nLOW, 1, 3\nUP, 1, 2\n*STEP\n*STATIC\n.1, 1., , .1\n*BOUNDARY\nUP, 3, 3, -0.801\n*END STEP\n")  # fmt: skip
    job = case.run("".join(rows), "plates", requested=10)
    case.near("force", float(np.sum(job.last("RF")[:4, 2])), 10.0, 1e-6, why="exact for these elements", place="the lower plate", time="the end")
    case.done()


@pytest.mark.parametrize("is_finite", [False, True], ids=["linear", "nlgeom"])
@pytest.mark.parametrize("by", ["moment", "coupling", "rigid body"])
def test_moment_about_the_normal(run_deck: Run, tmp_path: Path, by: str, is_finite: bool) -> None:
    """A strip 60 x 20 x 4 bends in its plane by M L^2/(2 E I), 3 %: under a moment about the normal at the node in the middle of its end, or under
    a couple on a block whose face is coupled to this node. The supports balance it.
    """
    nodes = {100 * i + k + 1: (10.0 * i, 10.0 * k, 0.0) for i in range(7) for k in range(3)}
    block = {901 + 4 * z + n: (x, y, 3.0 + 5 * z) for z in range(2) for n, (x, y) in enumerate([(55, 5), (65, 5), (65, 15), (55, 15)])}
    text = "*NODE, NSET=N\n" + "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in nodes.items()) + "*ELEMENT, TYPE=S4, ELSET=E\n"
    text += "".join(f"{10 * i + k + 1}, {100 * i + k + 1}, {100 * i + k + 101}, {100 * i + k + 102}, {100 * i + k + 2}\n" for i in range(6) for k in range(2))
    text += "*SHELL SECTION, ELSET=E, MATERIAL=M\n4.\n*MATERIAL, NAME=M\n*ELASTIC\n210000., 0.3\n*NSET, NSET=FIX\n1, 2, 3\n*NSET, NSET=END\n601, 603\n"
    loads = "602, 6, 100.\n"
    if by != "moment":
        text += "*NODE\n" + "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in block.items()) + "*ELEMENT, TYPE=C3D8, ELSET=B\n901, " + ", ".join(map(str, block))
        text += "\n*SOLID SECTION, ELSET=B, MATERIAL=M\n*SURFACE, NAME=FOOT\nB, S1\n*NSET, NSET=FEET\n901, 902, 903, 904\n"
        text += ("*COUPLING, CONSTRAINT NAME=C, REF NODE=602, SURFACE=FOOT\n*DISTRIBUTING\n" if by == "coupling" else "*RIGID BODY, TIE NSET=FEET, REF NODE=602\n")
        loads = "905, 2, -10.\n906, 2, 10.\n"
    deck = f"{text}*BOUNDARY\nFIX, ENCASTRE\n*STEP\n*STATIC\n*CLOAD\n{loads}*NODE PRINT, NSET=N\nU, RF\n*END STEP\n"
    done = run_deck(deck.replace("*STEP\n*STATIC", "*STEP, NLGEOM\n*STATIC") if is_finite else deck)
    assert done.returncode == 0, done.stdout + done.stderr
    moved, forces = (table.rows for table in read_dat(tmp_path / "job.dat"))
    moment = sum(np.cross(nodes[n], forces[(n,)]) for n in (1, 2, 3))
    assert moment[2] == pytest.approx(-100, rel=1e-4)
    assert np.mean([moved[(n,)][1] for n in (601, 603)]) == pytest.approx(100 * 60**2 / (2 * 210000 * 4 * 20**3 / 12), rel=0.03)


@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
@pytest.mark.parametrize("is_held", [True, False], ids=["held flat", "free to bend"])
def test_foil(run_deck: Run, tmp_path: Path, is_held: bool, dialect: str) -> None:
    """A foil 8000 times as long as thick, stretched by 0.5 %: E t w e where it is held flat; refused where it could bend, which rounding would hide."""
    body = shell("S8R", (6, 6), lambda u, v: (0.2 * u, 0.2 * v, 0 * u))
    deck = body.cards() + section(3.44e9, 0.3, 25e-6) + held(body.where(1, 0.0), "2") + "*BOUNDARY\n1, 1\n"
    deck += held(list(range(len(body.nodes))), "3") if is_held else held(body.where(1, 0.0), "3, 6")
    deck += "*NSET, NSET=LOW\n" + "".join(f"{i + 1},\n" for i in body.where(1, 0.0)) + "*STEP\n*STATIC\n" + held(body.where(1, 1.0), "2, 2, 1e-3")
    done = run_deck(deck + "*NODE PRINT, NSET=LOW, TOTALS=ONLY\nRF\n*END STEP\n", f"--dialect={dialect}")
    if not is_held:
        assert done.returncode == 3
        assert "too thin at element" in done.stdout + done.stderr
        return
    assert done.returncode == 0, done.stdout + done.stderr
    force = next(iter(read_dat(tmp_path / "job.dat")[-1].rows.values()))[1]
    assert force == pytest.approx(-3.44e9 * 25e-6 * 0.2 * 0.005, rel=1e-6)
