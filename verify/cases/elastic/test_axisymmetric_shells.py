"""Axisymmetric shells SAX1 and SAX2: edge effects, plates and spheres against closed forms.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from verify.cases.proof import Case, Job
from verify.decks.shells import Floats
from verify.readers.dat_frd_files import read_dat

Proof = Callable[..., Case]
PLATES = "S. Timoshenko and S. Woinowsky-Krieger, Theory of Plates and Shells, 2nd edition, McGraw-Hill 1959"
TABLES = "*NODE PRINT, NSET=N\nU, UR\n*EL PRINT, ELSET=E\nSF, SM\n"
E, NU = 210000.0, 0.3


def meridian(kind: str, places: Floats) -> str:
    """NODE and ELEMENT cards of a line through places (n, 2); SAX2 takes two intervals each."""
    nodes = "".join(f"{i + 1}, {x:.15g}, {y:.15g}\n" for i, (x, y) in enumerate(places))
    step = 2 if kind == "SAX2" else 1
    rows = [range(i, i + step + 1) for i in range(1, len(places) - step + 1, step)]
    elements = "".join(f"{k + 1}, {', '.join(str(i) for i in row)}\n" for k, row in enumerate(rows))
    return f"*NODE, NSET=N\n{nodes}*ELEMENT, TYPE={kind}, ELSET=E\n{elements}"


def section(thickness: float, more: str = "", modulus: float = E, ratio: float = NU) -> str:
    """One elastic material and its section."""
    return f"*MATERIAL, NAME=M\n*ELASTIC\n{modulus:.15g}, {ratio:.15g}\n*SHELL SECTION, ELSET=E, MATERIAL=M{more}\n{thickness:.15g}\n"


def step(load: str, more: str = "") -> str:
    """One step that prints displacements, rotations and section forces."""
    return f"*STEP{more}\n*STATIC\n{load}{TABLES}*END STEP\n"


def table(job: Job, title: str) -> Floats:
    """The rows of the last table with a title, by label."""
    block = [block for block in read_dat(job.path.with_suffix(".dat")) if block.title.startswith(title)][-1]
    return np.array([np.atleast_1d(values) for _, values in sorted(block.rows.items())])


def stiffness(thickness: float) -> float:
    """Bending stiffness of a plate."""
    return float(E * thickness**3 / (12 * (1 - NU**2)))


@pytest.mark.parametrize("kind", ["SAX1", "SAX2"])
def test_edge_of_a_cylinder(proof: Proof, kind: str) -> None:
    """A moment and a radial force on the edge of a long cylinder."""
    a, h, moment, force = 100.0, 1.0, 300.0, 20.0
    case = proof(
        f"axisymmetric-cylinder-{kind.lower()}",
        title=f"The edge of a cylinder of {kind}",
        model="Radius 100, thickness 1, length 80, E = 210000, nu = 0.3; on the edge y = 0 a moment of 300 and a radial force of 20, both per length of the circle.",
        formula="w = exp(-b y) (b M (cos b y - sin b y) + Q cos b y)/(2 b^3 D) inward, M1 = M (cos + sin) exp(-b y) + Q sin exp(-b y)/b, N2 = -E h w/a, b^4 = 3 (1 - nu^2)/(a h)^2.",
        source=f"{PLATES}, section 115",
        proves="Bending along the line with the hoop force: deflection, rotation, section forces; moments act on the rotation in the plane.",
    )
    y = np.linspace(0.0, 80.0, 161)
    deck = meridian(kind, np.stack([0 * y + a, y], axis=1)) + section(h)
    around = 2 * np.pi * a
    deck += f"*BOUNDARY\n161, 2, 2\n{step(f'*CLOAD{chr(10)}1, 1, {-force * around:.15g}{chr(10)}1, 6, {-moment * around:.15g}{chr(10)}')}"
    job = case.run(deck, kind)
    beta, bending = (3 * (1 - NU**2)) ** 0.25 / np.sqrt(a * h), stiffness(h)

    def inward(y: Floats) -> Floats:
        s = beta * y
        return np.exp(-s) * (beta * moment * (np.cos(s) - np.sin(s)) + force * np.cos(s)) / (2 * beta**3 * bending)

    why = "theory of thin shells: h/a"
    u, turn = table(job, "displacements"), table(job, "rotations")
    case.near("radial displacement", u[:, 0], -inward(y), 0.01, why=why, place="all nodes", time="the end")
    case.near("rotation", float(turn[0, 2]), -(2 * beta * moment + force) / (2 * beta**2 * bending), 0.01, why=why, place="the edge", time="the end")
    middle = (y[:-1] + y[1:]) / 2 if kind == "SAX1" else y[1::2]
    s = beta * middle
    wanted = np.exp(-s) * (moment * (np.cos(s) + np.sin(s)) + force * np.sin(s) / beta)
    found, forces = table(job, "section moments"), table(job, "section forces")
    case.near("size of SM1", np.abs(found[1:, 0]), np.abs(wanted[1:]), 0.015, why=why + "; the mean of an element", place="all elements but the first", time="the end", scale=moment)
    case.near("SF2", forces[:, 1], -E * h * inward(middle) / a, 0.015, why=why, place="all elements", time="the end")
    case.near("SF1", forces[:, 0], 0 * middle, 0.005, why="no force along the axis", place="all elements", time="the end", scale=float(np.abs(forces[:, 1]).max()))
    case.done()


@pytest.mark.parametrize(("kind", "h"), [("SAX1", 2.0), ("SAX1", 0.1), ("SAX2", 2.0), ("SAX2", 0.1)])
def test_clamped_plate(proof: Proof, kind: str, h: float) -> None:
    """A clamped circular plate under pressure."""
    case = proof(
        f"axisymmetric-plate-{kind.lower()}-{h:g}",
        title=f"A clamped circular plate of {kind}, thickness {h:g}",
        model=f"Radius 100, thickness {h:g}, E = 210000, nu = 0.3, twenty intervals, a pressure along the normal.",
        formula="w = p a^4/(64 D); moments at the centre (1 + nu) p a^2/16, radial moment at the edge -p a^2/8.",
        source=f"{PLATES}, section 17",
        proves="Bending without locking down to h/a = 1/1000; pressure P acts along the normal; clamp and axis of revolution.",
    )
    a, p = 100.0, h**3 * 1e-3
    r = np.linspace(0.0, a, 21)
    deck = meridian(kind, np.stack([r, 0 * r], axis=1)) + section(h)
    job = case.run(deck + "*BOUNDARY\n21, ENCASTRE\n1, XSYMM\n" + step(f"*DLOAD\nE, P, {p:.15g}\n"), kind)
    exact = p * (a**2 - r**2) ** 2 / (64 * stiffness(h))
    why = "twenty intervals; shear (h/a)^2"
    case.near("deflection", table(job, "displacements")[:, 1], exact, 0.005, why=why, place="all nodes", time="the end")
    ends = slice(None, None, 2) if kind == "SAX2" else slice(None)
    corner = r[ends]
    middle = (corner[:-1] + corner[1:]) / 2
    found = table(job, "section moments")
    radial = p / 16 * ((1 + NU) * a**2 - (3 + NU) * middle**2)
    hoop = p / 16 * ((1 + NU) * a**2 - (1 + 3 * NU) * middle**2)
    scale = p * a**2 / 8
    case.near("SM1", found[1:, 0], radial[1:], 0.02, why="the mean of an element", place="all elements but the first", time="the end", scale=scale)
    case.near("SM2", found[1:, 1], hoop[1:], 0.02, why="the mean of an element", place="all elements but the first", time="the end", scale=scale)
    stress = job.last("S")
    top = np.flatnonzero(np.abs(job.points[:, 1] - h / 2) < 1e-9 * a)
    at = top[np.argmin(job.points[top, 0])]
    case.near("S11 on the top at the centre", float(stress[at, 0]), 6 * (1 + NU) * p * a**2 / 16 / h**2, 0.02, why=why, place="the axis", time="the end")
    case.done()


@pytest.mark.parametrize("kind", ["SAX1", "SAX2"])
def test_hemisphere(proof: Proof, kind: str) -> None:
    """A hemisphere under pressure: free to grow, then clamped."""
    case = proof(
        f"axisymmetric-hemisphere-{kind.lower()}",
        title=f"A hemisphere of {kind} under pressure",
        model="Radius 100, thickness 1, E = 210000, nu = 0.3, pressure 1 inside, 180 intervals; the equator slides, then it is clamped.",
        formula="Sliding: u = p a^2 (1 - nu)/(2 E h), SF1 = SF2 = p a/2. Clamped: the radial moment at the edge is p a^2 (1 - nu)/(4 l^2), l^4 = 3 (1 - nu^2) (a/h)^2.",
        source=f"{PLATES}, sections 105, 129 and 130",
        proves="Normals that turn along the line and at the axis; membrane forces and edge effect of a curved shell.",
    )
    a, h, p = 100.0, 1.0, 1.0
    angle = np.linspace(0.0, np.pi / 2, 181)
    places = a * np.stack([np.sin(angle), np.cos(angle)], axis=1)
    deck = meridian(kind, places) + section(h)
    load = step(f"*DLOAD\nE, P, {p}\n")
    job = case.run(deck + "*BOUNDARY\n1, XSYMM\n181, YSYMM\n" + load, "free")
    u = table(job, "displacements")
    growth = p * a**2 * (1 - NU) / (2 * E * h)
    why = "theory of thin shells: pressure acts on the inner side, h/a"
    case.near("displacement", u[:, :2], growth * places / a, 0.02, why=why, place="all nodes", time="the end", scale=growth)
    case.near("SF1, SF2", table(job, "section forces")[:, :2], np.full((len(table(job, "section forces")), 2), p * a / 2), 0.0125, why=why, place="all elements", time="the end")
    job = case.run(deck + "*BOUNDARY\n1, XSYMM\n181, ENCASTRE\n" + load, "clamped")
    root = (3 * (1 - NU**2)) ** 0.25 * np.sqrt(a / h)
    moment = p * a**2 * (1 - NU) / (4 * root**2)
    found = table(job, "section moments")[:, 0]
    width = np.pi / 2 / len(found)
    s = root * (width * (np.arange(len(found))[::-1] + 0.5))
    wanted = moment * np.exp(-s) * (np.cos(s) - np.sin(s))
    case.near("size of SM1", np.abs(found), np.abs(wanted), 0.025, why=why + " and 1/l^2", place="all elements", time="the end", scale=moment)
    case.done()


def test_offset_in_a_tube(proof: Proof) -> None:
    """A thick tube whose nodes lie on its inner side."""
    case = proof(
        "axisymmetric-offset",
        title="A tube of SAX1 whose nodes lie inside",
        model="Inner radius 10, thickness 1, OFFSET=SNEG, E = 210000, nu = 0.3, pressure 50 on the inner side, free along the axis.",
        formula="u = (p a/E) ((b^2 + a^2)/(b^2 - a^2) + nu) at the inner radius a = 10, b = 11.",
        source="S. Timoshenko and J. N. Goodier, Theory of Elasticity, 3rd edition, McGraw-Hill 1970, section 28",
        proves="OFFSET; the displacement of a node is that of its place; strains across the thickness.",
    )
    y = np.linspace(5.0, 0.0, 6)
    deck = meridian("SAX1", np.stack([0 * y + 10.0, y], axis=1)) + section(1.0, ", OFFSET=SNEG")
    job = case.run(deck + "*BOUNDARY\n6, YSYMM\n" + step("*DLOAD\nE, P, 50.\n"), "tube")
    exact = 50 * 10 / E * ((121 + 100) / (121 - 100) + NU)
    case.near("radial displacement", table(job, "displacements")[:, 0], np.full(6, exact), 1e-4, why="quadratic over the thickness", place="all nodes", time="the end")
    case.done()


def test_sandwich_plate(proof: Proof) -> None:
    """A clamped plate of three layers."""
    case = proof(
        "axisymmetric-sandwich",
        title="A clamped circular plate of three layers of SAX1",
        model="Radius 100; layers 0.5, 1, 0.5 with E = 210000, 70000, 210000, nu = 0.3; twenty intervals under pressure.",
        formula="w = p a^4/(64 D), D = (E1 (2^3 - 1^3) + E2 1^3)/(12 (1 - nu^2)).",
        source=f"{PLATES}, section 17",
        proves="COMPOSITE of axisymmetric shells.",
    )
    r = np.linspace(0.0, 100.0, 21)
    deck = meridian("SAX1", np.stack([r, 0 * r], axis=1))
    deck += f"*MATERIAL, NAME=M\n*ELASTIC\n{E}, {NU}\n*MATERIAL, NAME=CORE\n*ELASTIC\n{E / 3}, {NU}\n*SHELL SECTION, ELSET=E, COMPOSITE\n0.5, 3, M\n1., 3, CORE\n0.5, 3, M\n"
    job = case.run(deck + "*BOUNDARY\n21, ENCASTRE\n1, XSYMM\n" + step("*DLOAD\nE, P, 0.01\n"), "plate")
    bending = E * (8 - 1 + 1 / 3) / (12 * (1 - NU**2))
    exact = 0.01 * (100**2 - r**2) ** 2 / (64 * bending)
    case.near("deflection", table(job, "displacements")[:, 1], exact, 0.01, why="shear of the core (h/a)^2; twenty intervals", place="all nodes", time="the end")
    case.done()


def test_orthotropic_cylinder(proof: Proof) -> None:
    """Plies along and round a tube under pressure with closed ends."""
    case = proof(
        "axisymmetric-plies",
        title="A tube of two plies of SAX1",
        model="Radius 100, plies of 0.5 along (0) and round (90) the tube, E1 = 140000, E2 = 10000, nu12 = 0.3, G = 5000; symmetric 90/0/90 in 0.25, 0.5, 0.25; pressure 1, closed ends.",
        formula="(N1, N2) = (p a/2, p a) = A (e1, e2) with the membrane stiffness A of lamination theory.",
        source="R. M. Jones, Mechanics of Composite Materials, 2nd edition, Taylor & Francis 1999, chapter 4",
        proves="Direction 1 of plies follows the line, 90 degrees is round the circle.",
    )
    y = np.linspace(20.0, 0.0, 21)
    a, p = 100.0, 1.0
    deck = meridian("SAX1", np.stack([0 * y + a, y], axis=1))
    deck += "*MATERIAL, NAME=M\n*ELASTIC, TYPE=LAMINA\n140000., 10000., .3, 5000., 5000., 3500.\n"
    deck += "*SHELL SECTION, ELSET=E, COMPOSITE\n.25, 3, M, 90.\n.5, 3, M, 0.\n.25, 3, M, 90.\n"
    pull = f"*DLOAD\nE, P, {p}\n*CLOAD\n1, 2, {np.pi * a**2 * p:.15g}\n"
    job = case.run(deck + "*BOUNDARY\n1, 6, 6\n21, YSYMM\n" + step(pull), "tube")
    q = np.linalg.inv(np.array([[1 / 140000, -0.3 / 140000], [-0.3 / 140000, 1 / 10000]]))
    membrane = 0.5 * q + 0.5 * q[::-1, ::-1]
    along, around = np.linalg.solve(membrane, [p * a / 2, p * a])
    u = table(job, "displacements")
    why = "theory of thin shells: h/a"
    case.near("radial displacement", u[:, 0], np.full(21, around * a), 0.01, why=why, place="all nodes", time="the end")
    case.near("displacement along the axis", float(u[0, 1]), along * 20, 0.02, why=why, place="the end", time="the end")
    case.done()


def deflection_of_karman(a: float, h: float, p: float, n: int = 400) -> float:
    """The deflection of the centre of a clamped plate by Karman's equations: central differences, Newton's method.

    Slope f and radial force N: D (f'' + f'/r - f/r^2) = p r/2 + N f, r N'' + 3 N' = -E h f^2/(2 r); f = 0 and r N' + (1 - nu) N = 0 at r = a.
    """
    r = np.linspace(0.0, a, n + 1)
    d, inner, bending = a / n, np.arange(1, n), stiffness(h)
    f, force = np.zeros(n + 1), np.zeros(n + 1)
    for _ in range(30):
        rest, matrix = np.zeros(2 * n + 2), np.zeros((2 * n + 2, 2 * n + 2))
        s = r[inner]
        m = n + 1 + inner
        rest[inner] = bending * ((f[2:] - 2 * f[1:-1] + f[:-2]) / d**2 + (f[2:] - f[:-2]) / (2 * d * s) - f[1:-1] / s**2) - p * s / 2 - force[1:-1] * f[1:-1]
        matrix[inner, inner + 1] = bending * (1 / d**2 + 1 / (2 * d * s))
        matrix[inner, inner - 1] = bending * (1 / d**2 - 1 / (2 * d * s))
        matrix[inner, inner] = bending * (-2 / d**2 - 1 / s**2) - force[1:-1]
        matrix[inner, m] = -f[1:-1]
        rest[m] = s * (force[2:] - 2 * force[1:-1] + force[:-2]) / d**2 + 3 * (force[2:] - force[:-2]) / (2 * d) + E * h * f[1:-1] ** 2 / (2 * s)
        matrix[m, m + 1], matrix[m, m - 1], matrix[m, m] = s / d**2 + 1.5 / d, s / d**2 - 1.5 / d, -2 * s / d**2
        matrix[m, inner] = E * h * f[1:-1] / s
        for row, (columns, values) in {
            0: ([0], [1.0]), n: ([n], [1.0]), n + 1: ([n + 1, n + 2, n + 3], [-3.0, 4.0, -1.0]),
            2 * n + 1: ([2 * n + 1, 2 * n, 2 * n - 1], [1 - NU + 3 * n / 2, -2.0 * n, n / 2]),
        }.items():  # fmt: skip
            matrix[row, columns] = values
            rest[row] = np.dot(values, np.r_[f, force][columns])
        change = np.linalg.solve(matrix, -rest)
        f, force = f + change[: n + 1], force + change[n + 1 :]
        if np.abs(change[: n + 1]).max() < 1e-10 * np.abs(f).max():
            return float(abs(np.sum((f[1:] + f[:-1]) * d / 2)))
    raise AssertionError("Newton's method for Karman's equations does not converge")


def test_large_deflection(proof: Proof) -> None:
    """A clamped plate whose middle surface stretches."""
    case = proof(
        "axisymmetric-large-deflection",
        title="Large deflection of a clamped circular plate of SAX1",
        model="Radius 100, thickness 1, E = 210000, nu = 0.3, held edge, NLGEOM, twenty intervals; a pressure of 0.03, 1.4 thicknesses of deflection.",
        formula="Karman's equations of plates for the slope and the radial force, by finite differences.",
        source=f"{PLATES}, section 96",
        proves="NLGEOM: the membrane force stiffens the plate.",
    )
    a, h, p = 100.0, 1.0, 0.03
    r = np.linspace(0.0, a, 21)
    deck = meridian("SAX1", np.stack([r, 0 * r], axis=1)) + section(h) + "*BOUNDARY\n21, ENCASTRE\n1, XSYMM\n"
    job = case.run(deck + step(f"*DLOAD\nE, P, {p:.15g}\n", ", NLGEOM"), "plate")
    u = table(job, "displacements")[0, 1]
    case.near("deflection", float(u), deflection_of_karman(a, h, p), 0.005, why="twenty intervals", place="the axis", time="the end")
    case.within("deflection over the linear one", float(u) / (p * a**4 / (64 * stiffness(h))), (0.3, 0.6), why="the stretch carries the rest", place="the axis", time="the end")
    case.done()


def test_contact_of_a_side(proof: Proof) -> None:
    """A plate lies with its lower side on a block."""
    case = proof(
        "axisymmetric-contact",
        title="A plate of SAX1 pressed on a block",
        model="A block 10 x 5 of CAX4, E = 1000, nu = 0; half a thickness above it a plate of thickness 0.4, E = 210000, nu = 0, with a pressure of 2 from above.",
        formula="u = -p H/E everywhere in the plate; contact pressure 2.",
        source="statics",
        proves="Contact acts on SNEG and sees the thickness.",
    )
    r = np.linspace(0.0, 10.0, 6)
    nodes = "".join(f"{100 + 10 * j + i}, {x:.15g}, {5.0 * j / 2:.15g}\n" for j in range(3) for i, x in enumerate(r))
    solids = "".join(f"{100 + 10 * j + i}, {100 + 10 * j + i}, {101 + 10 * j + i}, {111 + 10 * j + i}, {110 + 10 * j + i}\n" for j in range(2) for i in range(5))
    deck = meridian("SAX1", np.stack([r, 0 * r + 5.2], axis=1)) + section(0.4, "", 210000.0, 0.0)
    deck += f"*NODE, NSET=BLOCK\n{nodes}*ELEMENT, TYPE=CAX4, ELSET=B\n{solids}*MATERIAL, NAME=SOFT\n*ELASTIC\n1000., 0.\n*SOLID SECTION, ELSET=B, MATERIAL=SOFT\n"
    deck += "*SURFACE, NAME=LOW\nE, SNEG\n*SURFACE, NAME=TOP\nB, S3\n*SURFACE INTERACTION, NAME=I\n*CONTACT PAIR, INTERACTION=I\nLOW, TOP\n"
    floor = "".join(f"{100 + i}, 2, 2\n" for i in range(6))
    deck += f"*BOUNDARY\n{floor}1, 1, 1\n100, 1, 1\n110, 1, 1\n120, 1, 1\n"
    job = case.run(deck + step("*DLOAD\nE, P, -2.\n"), "plate")
    case.near("displacement", table(job, "displacements")[:, 1], np.full(6, -2 * 5 / 1000), 1e-3, why="the plate is thin beside the block", place="the plate", time="the end")
    case.done()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ((", MATERIAL=M", ", MATERIAL=M, ORIENTATION=O"), "leave ORIENTATION out"),
        (("E, P,", "E, EDNOR1,"), "take no load EDNOR1"),
        ((", MATERIAL=M", ", COMPOSITE"), "angles of layers"),
    ],
)
def test_what_is_refused(run_deck: Callable[..., Any], change: tuple[str, str], message: str) -> None:
    """Each error says what to do."""
    r = np.linspace(0.0, 100.0, 5)
    deck = meridian("SAX1", np.stack([r, 0 * r], axis=1)) + section(2.0) + "*ORIENTATION, NAME=O\n1., 0., 0., 0., 1., 0.\n*BOUNDARY\n5, ENCASTRE\n1, XSYMM\n" + step("*DLOAD\nE, P, 1.\n")
    assert change[0] in deck
    if "COMPOSITE" in change[1]:
        deck = deck.replace("\n2\n", "\n1., 3, M, 45.\n1., 3, M, -45.\n")
    done = run_deck(deck.replace(*change))
    assert done.returncode != 0
    assert message in done.stdout + done.stderr
