"""Elastic bodies without contact against closed forms: every element kind, small and large displacements.

The closed form at finite strain is that of the Hencky law of doc/theory: Kirchhoff stress linear in the logarithmic
strain. Tolerances: 1e-6 of the largest value is what the default controls promise; where the answer is in the space
of the shape functions no other error remains, so most tests require less than a tenth of that.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from verify.conftest import Run
from verify.decks import make_decks, solids
from verify.decks.solids import KINDS, Solids, as_kind, node_set, prescribed, pressure_on
from verify.independent.results import read_field

Floats = NDArray[np.float64]

YOUNG, NU = 1000.0, 0.3
MATERIAL = "*MATERIAL, NAME=M\n*ELASTIC\n{e:.17g}, {nu:.17g}\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n"
TIGHT = "*CONTROLS, PARAMETERS=FIELD\n1e-10, 1e-10, , , 1e-10\n"


def bar(kind: str, length: float = 2.0) -> Solids:
    """A bar length x 1 x 1 of 3 x 2 x 2 cells."""
    return as_kind(make_decks.block(np.linspace(0, length, 4), [0, 0.4, 1], [0, 0.5, 1], "BAR"), kind)


def distorted(kind: str, interior: float = 0.12) -> Solids:
    """A cube of 3 x 3 x 3 cells whose inner nodes are moved at random; faces stay flat, mid-sides stay halfway."""
    line = np.linspace(0, 1, 4)
    mesh = make_decks.block(line, line, line, "CUBE")
    inner = ((mesh.nodes > 1e-9) & (mesh.nodes < 1 - 1e-9)).all(axis=1)
    mesh.nodes[inner] += interior * np.random.default_rng(7).uniform(-1, 1, (int(inner.sum()), 3))
    return as_kind(mesh, kind)


def material(e: float = YOUNG, nu: float = NU, density: float | None = None) -> str:
    """Material and section of all elements."""
    extra = "" if density is None else f"*DENSITY\n{density:.17g}\n"
    return MATERIAL.format(e=e, nu=nu).replace("*SOLID", extra + "*SOLID")


def step(cards: str, is_nlgeom: bool = False, static: str = "1., 1.") -> str:
    """One step with tight controls."""
    return f"*STEP{', NLGEOM' if is_nlgeom else ''}\n*STATIC\n{static}\n{TIGHT}{cards}*END STEP\n"


def solve(run_deck: Run, tmp_path: Path, deck: str) -> dict[str, Floats]:
    """The fields at the end of a job that has to succeed."""
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr
    path = tmp_path / "job.vtkhdf"
    names = ["U", "RF", "S", "LE" if "NLGEOM" in deck else "E"]
    return {name.replace("LE", "E"): read_field(path, name)[-1] for name in names}


def close(found: Floats, expected: Floats | float, tolerance: float, what: str) -> None:
    """Difference over the largest expected value."""
    scale = max(float(np.abs(expected).max()), 1e-300)
    worst = float(np.abs(np.asarray(found) - expected).max()) / scale
    assert worst <= tolerance, f"{what}: off by {worst:.2e} of the largest value, allowed {tolerance:.0e}"


def rollers(body: Solids) -> str:
    """u.n = 0 on the three faces in the coordinate planes."""
    cards = [node_set(f"X{axis}", body.where(axis, 0.0)) for axis in range(3)]
    return "".join(cards) + "*BOUNDARY\n" + "".join(f"X{axis}, {axis + 1}\n" for axis in range(3))


@pytest.mark.parametrize("is_nlgeom", [False, True], ids=["small", "nlgeom"])
@pytest.mark.parametrize("kind", KINDS)
def test_uniaxial_tension(run_deck: Run, tmp_path: Path, kind: str, is_nlgeom: bool) -> None:
    """Force, lateral contraction, stress and strain of a stretched bar.

    Small: F = E A e. Hencky: tau = E ln(l), F = tau A0/l, lateral stretch l^(-nu), Cauchy stress tau/J with
    J = l^(1 - 2 nu).
    """
    body = bar(kind)
    elongation = 0.5 if is_nlgeom else 0.001
    end = body.where(0, 2.0)
    cards = node_set("END", end) + rollers(body)
    deck = body.cards() + cards + material() + step(f"*BOUNDARY\nEND, 1, 1, {elongation}\n", is_nlgeom, "0.25, 1.")
    found = solve(run_deck, tmp_path, deck)
    stretch = 1 + elongation / 2.0
    if is_nlgeom:
        force, side, strain = YOUNG * np.log(stretch) / stretch, stretch**-NU - 1, np.log(stretch)
        stress = YOUNG * strain / stretch ** (1 - 2 * NU)
    else:
        strain = elongation / 2.0
        force, side, stress = YOUNG * strain, -NU * strain, YOUNG * strain
    close(found["RF"][end, 0].sum(), force, 1e-8, "force")
    close(found["U"][:, 1], side * body.nodes[:, 1], 1e-7, "lateral displacement")
    close(found["S"], np.tile([stress, 0, 0, 0, 0, 0], (len(body.nodes), 1)), 1e-7, "stress")
    lateral = -NU * strain
    close(found["E"], np.tile([strain, lateral, lateral, 0, 0, 0], (len(body.nodes), 1)), 1e-7, "strain")


@pytest.mark.parametrize("is_nlgeom", [False, True], ids=["small", "nlgeom"])
@pytest.mark.parametrize("kind", KINDS)
def test_patch_of_distorted_elements(run_deck: Run, tmp_path: Path, kind: str, is_nlgeom: bool) -> None:
    """Irons's patch test: an affine motion of the boundary is followed inside, with one stress everywhere."""
    body = distorted(kind)
    slope = np.array([[1.0, 0.5, -0.3], [0.2, -0.4, 0.6], [0.1, 0.7, 0.8]]) * (0.1 if is_nlgeom else 1e-3)
    u = body.nodes @ slope.T
    outside = body.boundary_nodes()
    deck = body.cards() + material() + step(prescribed(outside, u[outside]), is_nlgeom, "0.5, 1.")
    found = solve(run_deck, tmp_path, deck)
    close(found["U"], u, 1e-9, "displacement")
    expected = hencky_stress(slope) if is_nlgeom else hooke(0.5 * (slope + slope.T))
    close(found["S"], np.tile(voigt(expected), (len(body.nodes), 1)), 1e-8, "stress")


def hooke(strain: Floats) -> Floats:
    """Isotropic linear law with YOUNG and NU."""
    lame, shear = YOUNG * NU / ((1 + NU) * (1 - 2 * NU)), YOUNG / (2 * (1 + NU))
    return lame * np.trace(strain) * np.eye(3) + 2 * shear * strain


def hencky_stress(slope: Floats) -> Floats:
    """Cauchy stress of the Hencky law for F = 1 + slope."""
    deformation = np.eye(3) + slope
    squares, axes = np.linalg.eigh(deformation @ deformation.T)
    return hooke(axes @ np.diag(0.5 * np.log(squares)) @ axes.T) / np.linalg.det(deformation)


def voigt(tensor: Floats) -> Floats:
    """xx yy zz xy yz xz."""
    return tensor[[0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]


@pytest.mark.parametrize("kind", KINDS)
def test_column_under_its_weight(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """nu = 0: u = -rho g z (H - z/2)/E; the reaction is the weight. Linear hexahedra and wedges are exact at their
    nodes only if the column is one cell wide or prismatic (it is); linear tetrahedra are not and get 3 %.
    """
    body = as_kind(make_decks.block([0, 1], [0, 1], np.linspace(0, 4, 9), "COLUMN"), kind)
    density, gravity, height = 2.5, 9.81, 4.0
    base = body.where(2, 0.0)
    cards = node_set("BASE", base) + rollers(body)
    deck = (
        body.cards() + cards + material(nu=0.0, density=density) + step(f"*DLOAD\nALL, GRAV, {gravity}, 0., 0., -1.\n")
    )
    found = solve(run_deck, tmp_path, deck)
    z = body.nodes[:, 2]
    expected = -density * gravity * z * (height - z / 2) / YOUNG
    tolerance = 0.03 if kind == "C3D4" else 1e-9
    close(found["U"][:, 2], expected, tolerance, "displacement")
    close(found["RF"][base, 2].sum(), density * gravity * height, 1e-9, "reaction")
    if kind in solids.QUADRATIC:
        stress = -density * gravity * (height - z)
        close(found["S"][:, 2], stress, 1e-8, "stress")


@pytest.mark.parametrize("is_nlgeom", [False, True], ids=["small", "nlgeom"])
@pytest.mark.parametrize("kind", KINDS)
def test_pressure_all_around(run_deck: Run, tmp_path: Path, kind: str, is_nlgeom: bool) -> None:
    """Hydrostatic pressure p: stress -p everywhere. Small: u = -p x/(3K). Hencky: 3 K ln(l) = -p l^3."""
    body = distorted(kind, 0.08)
    bulk = YOUNG / (3 * (1 - 2 * NU))
    pressure = 0.3 * bulk if is_nlgeom else 1e-3 * bulk
    sides = [pressure_on(body.outer_faces(body.where(axis, 1.0)), pressure) for axis in range(3)]
    cards = "*DLOAD\n" + "".join(sides).replace("*DLOAD\n", "")
    deck = body.cards() + rollers(body) + material() + step(cards, is_nlgeom, "0.25, 1.")
    found = solve(run_deck, tmp_path, deck)
    close(found["S"], np.tile([-pressure] * 3 + [0.0] * 3, (len(body.nodes), 1)), 1e-7, "stress")
    close(found["U"], (hydrostatic_stretch(pressure, bulk, is_nlgeom) - 1) * body.nodes, 1e-7, "displacement")


def hydrostatic_stretch(pressure: float, bulk: float, is_nlgeom: bool) -> float:
    """The stretch of a cube under pressure."""
    if not is_nlgeom:
        return 1 - pressure / (3 * bulk)
    stretch = 1.0
    for _ in range(60):
        value, slope = (
            3 * bulk * np.log(stretch) + pressure * stretch**3,
            3 * bulk / stretch + 3 * pressure * stretch**2,
        )
        stretch -= value / slope
    return float(stretch)


@pytest.mark.parametrize("kind", ["C3D8", "C3D10", "C3D20R"])
def test_periodic_cell_by_equations(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """A cell of two layers across x, tied left to right by *EQUATION to the corner's motion: stiffness of springs in
    series, E A/(l1/E1 + l2/E2) with nu = 0, and the same left and right shape under a shear of the corner.
    """
    body = bar(kind)
    left, right = body.where(0, 0.0), body.where(0, 2.0)
    partner = {tuple(np.round(body.nodes[n, 1:], 9)): n for n in right}
    origin, corner = 0, int(partner[0.0, 0.0])
    is_hard = body.nodes[body.elements][:, :, 0].mean(axis=1) < 2 / 3
    cards = f"*ELSET, ELSET=HARD\n{rows(np.flatnonzero(is_hard))}*ELSET, ELSET=SOFT\n{rows(np.flatnonzero(~is_hard))}"
    cards += "".join(
        f"*MATERIAL, NAME={name}\n*ELASTIC\n{e}, 0.\n*SOLID SECTION, ELSET={name}, MATERIAL={name}\n"
        for name, e in (("HARD", 4 * YOUNG), ("SOFT", YOUNG))
    )
    cards += equations((partner[tuple(np.round(body.nodes[n, 1:], 9))], n, corner) for n in left if n != origin)
    motion = "*BOUNDARY\n" + f"{origin + 1}, 1, 3\n{corner + 1}, 1, 1, 0.002\n{corner + 1}, 2, 3\n{side_support(body)}"
    found = solve(run_deck, tmp_path, body.cards() + cards + step(motion))
    series = 0.002 / ((2 / 3) / (4 * YOUNG) + (4 / 3) / YOUNG)
    close(found["RF"][right, 0].sum(), series, 1e-8, "force through the cell")
    close(found["S"][:, 0], series, 1e-7, "stress")
    jump = found["U"][[partner[tuple(np.round(body.nodes[n, 1:], 9))] for n in left]] - found["U"][left]
    close(jump, np.tile([0.002, 0, 0], (len(left), 1)), 1e-10, "jump from left to right")


def side_support(body: Solids) -> str:
    """Against the rotation about x that periodicity leaves: one node beside the origin held in z."""
    beside = int(
        body.where(0, 0.0)[np.argmax(body.nodes[body.where(0, 0.0), 1] * (body.nodes[body.where(0, 0.0), 2] < 1e-9))]
    )
    return f"{beside + 1}, 3\n"


def rows(members: Iterable[int]) -> str:
    """Labels, ten a line."""
    labels = [str(int(m) + 1) for m in members]
    return "".join(", ".join(labels[i : i + 10]) + "\n" for i in range(0, len(labels), 10))


def equations(triples: Iterable[tuple[int, int, int]]) -> str:
    """u(right) - u(left) - u(corner) = 0 in all directions."""
    cards = ""
    for right, left, corner in triples:
        for d in (1, 2, 3):
            cards += f"*EQUATION\n3\n{right + 1}, {d}, 1., {left + 1}, {d}, -1., {corner + 1}, {d}, -1.\n"
    return cards


@pytest.mark.parametrize(("kind", "tolerance"), [("C3D20R", 0.005), ("C3D20", 0.01), ("C3D10", 0.03)])
def test_cantilever(run_deck: Run, tmp_path: Path, kind: str, tolerance: float) -> None:
    """Tip of a slender cantilever: P L^3/(3 E I) + P L/(5/6 G A), nu = 0 (Timoshenko); elements ten by two."""
    length, force = 10.0, 0.1
    body = as_kind(make_decks.block(np.linspace(0, length, 11), [0, 1], [0, 0.5, 1], "BEAM"), kind)
    tip = body.where(0, length)
    # A uniform shear on the tip as forces on its nodes: by their share of the pressure reaction, which a job prints.
    loads = tip_shares(body)
    cload = "*CLOAD\n" + "".join(f"{n + 1}, 3, {force * share:.17g}\n" for n, share in loads.items())
    deck = (
        body.cards() + node_set("ROOT", body.where(0, 0.0)) + "*BOUNDARY\nROOT, 1, 3\n" + material(nu=0.0) + step(cload)
    )
    found = solve(run_deck, tmp_path, deck)
    expected = force * length**3 / (3 * YOUNG / 12) + force * length / (5 / 6 * YOUNG / 2)
    close(found["U"][tip, 2].mean(), expected, tolerance, "tip")
    close(found["RF"][:, 2].sum(), -force, 1e-9, "reaction")


def tip_shares(body: Solids) -> dict[int, float]:
    """Consistent nodal shares of a uniform traction on the face at the greatest x (flat faces with mid-sides halfway).

    Serendipity: corners -1/12, mid-sides 1/3 of a face; six-node triangles: mid-sides 1/3.
    """
    shares: dict[int, float] = {}
    edges = solids._TET_EDGES if body.kind == "C3D10" else solids._HEX_EDGES
    n_corners = 4 if body.kind == "C3D10" else 8
    for e, f in body.outer_faces(body.where(0, float(body.nodes[:, 0].max()))):
        local = solids.FACES[body.kind][f - 1]
        mids = [n_corners + i for i, (a, b) in enumerate(edges) if a in local and b in local]
        corners = body.nodes[body.elements[e][local]]
        area = sum(
            np.linalg.norm(np.cross(corners[i] - corners[0], corners[i + 1] - corners[0])) / 2
            for i in range(1, len(local) - 1)
        )
        corner_share = -1 / 12 if len(local) == 4 else 0.0
        for members, share in ((local, corner_share), (mids, 1 / 3)):
            for n in body.elements[e][members]:
                shares[int(n)] = shares.get(int(n), 0.0) + share * area
    return shares


@pytest.mark.parametrize("kind", KINDS)
def test_rotation_of_a_stretched_bar(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """Step 1 stretches a bar by its ends, step 2 turns it by 40 degrees: the stress turns with it, exactly.

    The ends are moved with all their nodes (affine, lateral contraction included), so that the state is uniform.
    """
    body = bar(kind)
    stretch = 1.3
    stretched = body.nodes * np.array([stretch, stretch**-NU, stretch**-NU])
    angle = np.radians(40)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    ends = np.concatenate([body.where(0, 0.0), body.where(0, 2.0)])
    first = prescribed(ends, (stretched - body.nodes)[ends])
    second = prescribed(ends, (stretched @ turn.T - body.nodes)[ends])
    deck = body.cards() + material() + step(first, True, "0.5, 1.") + step(second, True, "0.25, 1.")
    found = solve(run_deck, tmp_path, deck)
    close(found["U"], stretched @ turn.T - body.nodes, 1e-8, "displacement")
    stress = YOUNG * np.log(stretch) / stretch ** (1 - 2 * NU)
    close(found["S"], np.tile(voigt(turn @ np.diag([stress, 0, 0]) @ turn.T), (len(body.nodes), 1)), 1e-7, "stress")


@pytest.mark.parametrize("kind", KINDS)
def test_rigid_rotation_leaves_no_stress(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """The boundary of a distorted cube turned by 60 degrees about a skew axis in one increment."""
    body = distorted(kind)
    axis = np.array([1.0, 2.0, 2.0]) / 3
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    angle = np.radians(60)
    turn = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    outside = body.boundary_nodes()
    u = body.nodes @ turn.T - body.nodes
    deck = body.cards() + material() + step(prescribed(outside, u[outside]), True)
    found = solve(run_deck, tmp_path, deck)
    close(found["U"], u, 1e-9, "displacement")
    assert np.abs(found["S"]).max() < 1e-8 * YOUNG
    assert np.abs(found["E"]).max() < 1e-8
