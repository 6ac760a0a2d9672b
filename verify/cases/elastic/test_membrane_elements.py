"""Membrane elements: patches, discs and spheres under pressure, prestress, contact.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import brentq

from verify.cases.proof import Case
from verify.decks.membranes import KINDS, membrane, membrane_section, quarter_disc
from verify.decks.shells import Floats, held

Proof = Callable[..., Case]

ELASTIC = "*ELASTIC\n210000., 0.3\n"


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_patch(proof: Proof, kind: str, nlgeom: bool) -> None:
    """A distorted sheet that is stretched evenly."""
    case = proof(
        f"membrane-patch-{kind.lower()}{'-large' if nlgeom else ''}",
        title=f"Patch of {kind}{', NLGEOM' if nlgeom else ''}",
        model="A sheet 2 x 1 x 0.05 of 3 x 2 distorted cells in the plane z = 0, E = 210000, nu = 0.3; its rim moves by a uniform gradient (0.2, 0.1; -0.05, 0.15) "
        f"{'in full' if nlgeom else 'over 100'}, z is held.",
        formula="Hooke's law in plane stress of the strain" + (" ln V of the gradient" if nlgeom else "") + "; the stress across is zero.",
        source="R. L. Taylor, J. C. Simo, O. C. Zienkiewicz, A. C. H. Chan, The patch test, Int. J. Numer. Methods Eng. 22 (1986) 39-62",
        proves="Uniform stress in distorted membranes.",
    )

    def place(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
        bump = np.sin(np.pi * np.clip(u, 0, 1)) * np.sin(np.pi * np.clip(v, 0, 1))
        return 2 * u + 0.11 * bump * (u - v), v + 0.07 * bump, 0 * u

    mesh = membrane(kind, (3, 2), place)
    if kind[3] in "68":  # straight sides: the middles lie between the ends
        for nodes in mesh.elements:
            corners = len(nodes) // 2
            for k in range(corners):
                mesh.nodes[nodes[corners + k]] = (mesh.nodes[nodes[k]] + mesh.nodes[nodes[(k + 1) % corners]]) / 2
    gradient = np.array([[0.2, 0.1], [-0.05, 0.15]]) * (1 if nlgeom else 0.01)
    rim = sorted({i for axis in (0, 1) for value in (0.0, 1.0) for i in mesh.where(axis, value)})
    rows = "".join(f"{i + 1}, {k + 1}, {k + 1}, {(gradient @ mesh.nodes[i, :2])[k]:.15g}\n" for i in rim for k in (0, 1))
    deck = mesh.cards() + membrane_section(ELASTIC, 0.05) + "*BOUNDARY\nN, 3\n"
    job = case.run(deck + f"*STEP{', NLGEOM' if nlgeom else ''}\n*STATIC\n*BOUNDARY\n{rows}*END STEP\n", "the sheet")
    if nlgeom:
        f = np.eye(2) + gradient
        values, axes = np.linalg.eigh(f @ f.T)
        strain = axes @ np.diag(np.log(values) / 2) @ axes.T
    else:
        strain = (gradient + gradient.T) / 2
    stress = 210000 / (1 - 0.3**2) * (0.7 * strain + 0.3 * np.trace(strain) * np.eye(2))
    if nlgeom:  # Kirchhoff's to Cauchy's: over the change of volume
        stress /= np.exp((1 - 2 * 0.3) / 210000 * np.trace(stress))
    wanted = np.array([stress[0, 0], stress[1, 1], 0.0, stress[0, 1], 0.0, 0.0])
    found = job.integration_points("S")[-1]
    case.near("stress at any point", found, np.broadcast_to(wanted, found.shape), 1e-8, why="the patch is exact; the equations are solved beyond the criteria in the "
              "last iteration", place="all points", time="the end")  # fmt: skip
    case.done()


def tension(load: float, ratio: float, prestress: float, centre: float) -> tuple[float, float]:
    """Hencky's series with a tension at the centre: the misfit of the rim, and the deflection of the centre.

    Lengths over the radius a, tensions n over E t q^(2/3) and deflections over a q^(1/3), q = p a / (E t) = load: with n = sum of b_k r^(2 k) the equations
    n w' = -r/2 and r (n_theta + n)' = -w'^2/2, n_theta = (r n)', give 4 k (k + 1) b_k = -c_(k - 1)/4 where r^2 sum of c_k r^(2 k) = r^2/n^2.
    """
    m = 60
    b, inverse = np.zeros(m), np.zeros(m)
    b[0], inverse[0] = centre, 1 / centre
    for k in range(1, m):
        c = float(np.dot(inverse[:k], inverse[:k][::-1]))
        b[k] = -c / 4 / (4 * k * (2 * k + 2))
        inverse[k] = -float(np.dot(b[1 : k + 1], inverse[:k][::-1])) / centre
    powers = np.arange(m)
    misfit = float(np.sum(b * (2 * powers + 1 - ratio))) - (1 - ratio) * prestress / load ** (2 / 3)
    return misfit, float(np.sum(inverse / (2 * (2 * powers + 2))))


def hencky(load: float, ratio: float, prestress: float = 0.0) -> tuple[float, float]:
    """Deflection of the centre over the radius, and its stress over E."""
    centre = brentq(lambda b: tension(load, ratio, prestress, b)[0], 0.35, 100.0 + prestress / load ** (2 / 3))
    return tension(load, ratio, prestress, centre)[1] * load ** (1 / 3), centre * load ** (2 / 3)


def test_series() -> None:
    """Hencky's constants: 0.653 and 0.431 for nu = 0.3, as in Fichter's table."""
    deflection, stress = hencky(1.0, 0.3)
    assert abs(deflection - 0.653) < 1e-3
    assert abs(stress - 0.431) < 1e-3


def rim(nodes: Floats, radius: float) -> list[int]:
    """Nodes (from 0) on the rim of a disc."""
    return [int(i) for i in np.flatnonzero(np.abs(np.hypot(nodes[:, 0], nodes[:, 1]) - radius) < 1e-6 * radius)]


@pytest.mark.parametrize("kind, n, tolerance", [("M3D3", 16, 4e-3), ("M3D4", 16, 1e-3), ("M3D4R", 16, 1e-3), ("M3D6", 8, 1e-3), ("M3D8", 8, 1e-3), ("M3D8R", 8, 1e-3)])
def test_disc(proof: Proof, kind: str, n: int, tolerance: float) -> None:
    """Hencky's membrane with a prestress."""
    thickness, modulus, ratio, stress = 1e-3, 210000.0, 0.3, 2.0
    load, strong = 1e-6, 20e-6  # p a / (E t)
    case = proof(
        f"membrane-disc-{kind.lower()}",
        title=f"A circular membrane of {kind} under pressure (Hencky)",
        model=f"A quarter of a disc of radius 1 and thickness 0.001, {n} x {n} cells, clamped at the rim; E = 210000, nu = 0.3, initial stress 2; pressure up to "
        "p a/(E t) = 1e-6, then 2e-5; NLGEOM.",
        formula="Hencky's series with the initial stress as a further term at the rim.",
        source="H. Hencky, Z. Math. Phys. 63 (1915) 311-317; W. B. Fichter, NASA TP 3658 (1997); J. D. Campbell, Q. J. Mech. Appl. Math. 9 (1956) 84-93",
        proves="Large deflections, initial stress, pressure.",
    )
    mesh = quarter_disc(kind, n, 1.0)
    deck = mesh.cards() + membrane_section(f"*ELASTIC\n{modulus}, {ratio}\n", thickness) + held(mesh.where(0, 0.0), "1") + held(mesh.where(1, 0.0), "2")
    deck += held(rim(mesh.nodes, 1.0), "1, 3") + f"*INITIAL CONDITIONS, TYPE=STRESS\nE, {stress}, {stress}\n"
    for q in (load, strong):
        deck += f"*STEP, NLGEOM\n*STATIC\n.1, 1.\n*DLOAD\nE, P, {q * modulus * thickness:.15g}\n*END STEP\n"
    job = case.run(deck, "the disc")
    centre = mesh.at(0.0, 0.0)
    for q, time in ((load, 1.0), (strong, 2.0)):
        deflection, tension_there = hencky(q, ratio, stress / modulus)
        frame = job.frame(time)
        case.near("deflection", float(job.field("U")[frame, centre, 2]), deflection, tolerance, why="discretization; finite rotations change 1e-3 of it at most",
                  place="the centre", time=f"t = {time:g}")  # fmt: skip
        case.near("stress", float(job.field("S")[frame, centre, 0]), tension_there * modulus, 8e-3, why="extrapolated to the node; falls with the square of the size of the elements",
                  place="the centre", time=f"t = {time:g}")  # fmt: skip
    case.done()


@pytest.mark.parametrize("kind, n, tolerance", [("M3D4", 12, 1e-2), ("M3D6", 6, 2e-3), ("M3D8R", 6, 2e-3)])
def test_balloon(proof: Proof, kind: str, n: int, tolerance: float) -> None:
    """A sphere of rubber."""
    case = proof(
        f"membrane-balloon-{kind.lower()}",
        title=f"A balloon of {kind}",
        model=f"An eighth of a sphere of radius 1 and thickness 0.01, {n} x {n} cells, neo-Hooke with C10 = 0.5, D1 = 1e-4, symmetry planes; inflated by a following "
        "pressure in a prescribed rise to 0.9 of the largest one; NLGEOM.",
        formula="p = 2 mu t / R (1/l - 1/l^7), sigma = mu (l^2 - 1/l^4) for the stretch l; the volume changes by 1e-4 at most.",
        source="A. E. Green, W. Zerna, Theoretical Elasticity, 2nd edition, Oxford 1968, section 3.10",
        proves="Finite strains, change of thickness, following pressure on membranes.",
    )

    def place(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
        x, y = u * np.sqrt(1 - v**2 / 2), v * np.sqrt(1 - u**2 / 2)
        r = np.maximum(np.hypot(x, y), 1e-300)
        angle = np.pi / 2 * r
        return np.sin(angle) * x / r, np.sin(angle) * y / r, np.cos(angle)

    mesh = membrane(kind, (n, n), place)
    pressure = 0.9 * 2 * 0.01 * (7 ** (-1 / 6) - 7 ** (-7 / 6))
    stretch = brentq(lambda x: 0.02 * (1 / x - 1 / x**7) - pressure, 1.0, 7 ** (1 / 6))
    deck = mesh.cards() + membrane_section("*HYPERELASTIC, NEO HOOKE\n.5, 1e-4\n", 0.01) + held(mesh.where(0, 0.0), "1") + held(mesh.where(1, 0.0), "2")
    deck += held(rim(mesh.nodes, 1.0), "3") + f"*STEP, NLGEOM\n*STATIC\n.1, 1.\n*DLOAD\nE, P, {pressure:.15g}\n*END STEP\n"
    job = case.run(deck, "the balloon")
    u = job.last("U")
    grown = np.linalg.norm(job.points[: len(mesh.nodes)] + u[: len(mesh.nodes)], axis=1)
    case.near("radius", float(grown.mean()), stretch, tolerance, why="facets in place of a sphere; the stretch is five times as sensitive to the pressure here",
              place="mean of the nodes", time="the end")  # fmt: skip
    case.near("stress", float(job.last("S")[mesh.at(0.0, 0.0), 0]), stretch**2 - stretch**-4, 1.5e-2, why="extrapolated to the node; falls with the square of the size of the elements",
              place="the pole", time="the end")  # fmt: skip
    case.done()


def even_load(x: Floats, elements: list[list[int]]) -> Floats:
    """Nodal forces along z of a unit pressure on quadrilaterals that lie flat."""
    force = np.zeros(len(x))
    for nodes in elements:
        for a in (-(3**-0.5), 3**-0.5):
            for b in (-(3**-0.5), 3**-0.5):
                signs = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
                shape = (1 + a * signs[:, 0]) * (1 + b * signs[:, 1]) / 4
                slope = np.stack([signs[:, 0] * (1 + b * signs[:, 1]), signs[:, 1] * (1 + a * signs[:, 0])]) / 4
                force[nodes] += shape * float(np.linalg.det(slope @ x[nodes, :2]))
    return force


@pytest.mark.parametrize("contact", ["", ", TYPE=SURFACE TO SURFACE"])
def test_ceiling(proof: Proof, contact: str) -> None:
    """A membrane that is inflated against a rigid ceiling."""
    case = proof(
        f"membrane-ceiling{'-faces' if contact else ''}",
        title=f"A membrane is inflated against a ceiling{', surface to surface' if contact else ''}",
        model="A quarter of a disc of M3D4, radius 1, thickness 0.01, E = 1000, nu = 0.3, initial stress 10, clamped at the rim, pressure 1 below a rigid plane at "
        "height 0.1 (R3D4); its side SPOS is the slave.",
        formula="Where the membrane lies flat the contact pressure is that below it; the forces of ceiling and rim balance the pressure on the area within the rim.",
        source="statics",
        proves="Contact on SPOS of a membrane and following pressure.",
    )
    mesh = quarter_disc("M3D4", 16, 1.0)
    deck = mesh.cards() + membrane_section("*ELASTIC\n1000., 0.3\n", 0.01) + held(mesh.where(0, 0.0), "1") + held(mesh.where(1, 0.0), "2")
    edge = rim(mesh.nodes, 1.0)
    deck += held(edge, "1, 3") + "*INITIAL CONDITIONS, TYPE=STRESS\nE, 10., 10.\n"
    deck += "*NODE\n9001, -.5, -.5, .1\n9002, 1.5, -.5, .1\n9003, 1.5, 1.5, .1\n9004, -.5, 1.5, .1\n9005, 0., 0., .1\n"
    deck += "*ELEMENT, TYPE=R3D4, ELSET=PLANE\n9001, 9001, 9002, 9003, 9004\n*RIGID BODY, ELSET=PLANE, REF NODE=9005\n*BOUNDARY\n9005, 1, 6\n"
    deck += "*SURFACE, NAME=TOP\nE, SPOS\n*SURFACE, NAME=CEILING\nPLANE, SNEG\n*SURFACE INTERACTION, NAME=I\n"
    deck += f"*CONTACT PAIR, INTERACTION=I{contact}\nTOP, CEILING\n*STEP, NLGEOM\n*STATIC\n.1, 1.\n*DLOAD\nE, P, 1.\n*END STEP\n"
    job = case.run(deck, "the disc")
    contact_force = job.last("CNORMF")[: len(mesh.nodes), 2]
    reaction = job.last("RF")[: len(mesh.nodes), 2]
    corners = mesh.nodes[edge][np.argsort(np.arctan2(mesh.nodes[edge, 1], mesh.nodes[edge, 0]))]
    area = float(np.sum(corners[:-1, 0] * corners[1:, 1] - corners[1:, 0] * corners[:-1, 1]) / 2)
    case.near("force of ceiling and rim", float(contact_force.sum() + reaction.sum()), -area, 1e-6, why="equilibrium by the force criterion", place="the membrane",
              time="the end")  # fmt: skip
    inner = np.flatnonzero(np.hypot(mesh.nodes[:, 0], mesh.nodes[:, 1]) < 0.4)
    now = mesh.nodes + job.last("U")[: len(mesh.nodes)]
    forces = -even_load(now, mesh.elements)
    case.near("contact forces", contact_force[inner], forces[inner], 1e-5, why="a flat sheet passes the pressure on; 1e-6 of it deviates by the last correction",
              place="within 0.4 of the centre", time="the end")  # fmt: skip
    case.near("height", now[inner, 2], np.full(len(inner), 0.1), 1.5e-5, why="it lies at the ceiling, half of whose thickness is a millionth of its edges, 2",
              place="within 0.4 of the centre", time="the end")  # fmt: skip
    case.done()
