"""Element kinds against closed forms and published numbers: plane, axisymmetric, C3D8I, C3D8R, trusses, springs, masses.

Plane meshes are grids of (u, v) in the unit square, mapped; a kind is chosen by its shape and its prefix. Tolerances are
those of the discretisation, said at each test; patch tests require agreement to rounding.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from verify.conftest import Run
from verify.decks import make_decks
from verify.decks.solids import as_kind, node_set, pressure_on
from verify.independent.results import read_field

Floats = NDArray[np.float64]
Map = Callable[[Floats, Floats], tuple[Floats, Floats]]

SHAPES = ["3", "4", "4I", "4R", "6", "8", "8R"]
TIGHT = "*CONTROLS, PARAMETERS=FIELD\n1e-10, 1e-10, , , 1e-10\n"


@dataclass
class Sheet:
    """A plane mesh; indices from 0, labels one more."""

    kind: str
    nodes: Floats  #: (n_nodes, 2)
    uv: Floats  #: (n_nodes, 2) place in the unit square
    elements: list[list[int]]

    def where(self, axis: int, value: float) -> NDArray[np.int64]:
        """Nodes at a value of u (0) or v (1)."""
        return np.flatnonzero(np.abs(self.uv[:, axis] - value) < 1e-9)

    def edges(self, axis: int, value: float) -> list[tuple[int, int]]:
        """(element from 0, edge from 1) whose corners are there."""
        wanted = set(self.where(axis, value).tolist())
        corners = 3 if len(self.elements[0]) in (3, 6) else 4
        return [(e, i + 1) for e, nodes in enumerate(self.elements) for i in range(corners)
                if nodes[i] in wanted and nodes[(i + 1) % corners] in wanted]

    def cards(self) -> str:
        """*NODE and *ELEMENT with the set ALL."""
        lines = ["*NODE, NSET=NODES"] + [f"{i}, {x:.15g}, {y:.15g}" for i, (x, y) in enumerate(self.nodes, start=1)]
        lines += [f"*ELEMENT, TYPE={self.kind}, ELSET=ALL"]
        lines += [", ".join(str(n) for n in [e, *(n + 1 for n in nodes)]) for e, nodes in enumerate(self.elements, start=1)]
        return "\n".join(lines) + "\n"


def sheet(prefix: str, shape: str, cells: tuple[int, int], place: Map, shake: float = 0.0) -> Sheet:
    """A grid of cells mapped by place(u, v); inner corners are moved at random by `shake` of a cell."""
    is_quadratic = shape[0] in "68"
    step = 2 if is_quadratic else 1
    columns, rows = (n * step + 1 for n in cells)
    u, v = (a.ravel() for a in np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows)))
    uv = np.column_stack([u, v])
    if shake > 0:
        uv = shaken(uv, cells, step, (columns, rows), shake)
    elements = []
    for j in range(cells[1]):
        for i in range(cells[0]):
            at = lambda a, b, i=i, j=j: (j * step + b) * columns + i * step + a  # noqa: E731
            elements += cell(shape, step, at)
    used = sorted({n for nodes in elements for n in nodes})
    number = {n: k for k, n in enumerate(used)}
    x, y = place(uv[used, 0], uv[used, 1])
    return Sheet(prefix + shape, np.column_stack([x, y]), np.column_stack([u, v])[used],
                 [[number[n] for n in nodes] for nodes in elements])


def shaken(uv: Floats, cells: tuple[int, int], step: int, shape: tuple[int, int], amount: float) -> Floats:
    """Inner corners moved, what is between them halfway."""
    columns, rows = shape
    grid = uv.reshape(rows, columns, 2).copy()
    move = amount * np.random.default_rng(5).uniform(-1, 1, (rows // step + 1, columns // step + 1, 2)) / np.array(cells)
    move[[0, -1], :] = 0
    move[:, [0, -1]] = 0
    grid[::step, ::step] += move[: grid[::step, ::step].shape[0], : grid[::step, ::step].shape[1]]
    if step == 2:
        grid[::2, 1::2] = (grid[::2, :-2:2] + grid[::2, 2::2]) / 2
        grid[1::2, ::2] = (grid[:-2:2, ::2] + grid[2::2, ::2]) / 2
        grid[1::2, 1::2] = (grid[:-2:2, :-2:2] + grid[2::2, 2::2]) / 2
    return grid.reshape(-1, 2)


def cell(shape: str, s: int, at: Callable[[int, int], int]) -> list[list[int]]:
    """The elements of one cell: a square, or two triangles."""
    square = [at(0, 0), at(s, 0), at(s, s), at(0, s)]
    if shape[0] == "3":
        return [[square[0], square[1], square[2]], [square[0], square[2], square[3]]]
    if shape[0] == "4":
        return [square]
    if shape[0] == "8":
        return [[*square, at(1, 0), at(2, 1), at(1, 2), at(0, 1)]]
    return [[square[0], square[1], square[2], at(1, 0), at(2, 1), at(1, 1)],
            [square[0], square[2], square[3], at(1, 1), at(1, 2), at(0, 1)]]


def material(e: float, nu: float, thickness: float = 1.0) -> str:
    """Material and section of all elements."""
    return f"*MATERIAL, NAME=M\n*ELASTIC\n{e}, {nu}\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n{thickness}\n"


def step(cards: str, is_nlgeom: bool = False, static: str = "1., 1.") -> str:
    """One step with tight controls."""
    return f"*STEP{', NLGEOM' if is_nlgeom else ''}\n*STATIC\n{static}\n{TIGHT}{cards}*END STEP\n"


def supports(members: Iterable[int], *dofs: int) -> str:
    """*BOUNDARY at zero."""
    return "*BOUNDARY\n" + "".join(f"{n + 1}, {d}\n" for n in members for d in dofs)


def solve(run_deck: Run, tmp_path: Path, deck: str) -> dict[str, Floats]:
    """Displacements, reactions and stresses at the end of a job that has to succeed."""
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr
    return {name: read_field(tmp_path / "job.vtkhdf", name)[-1] for name in ("U", "RF", "S")}


def near(found: float, expected: float, tolerance: float, what: str) -> None:
    """Relative difference."""
    assert abs(found - expected) <= tolerance * abs(expected), f"{what}: {found:.6g}, expected {expected:.6g} to {tolerance:.1g}"


def square(u: Floats, v: Floats) -> tuple[Floats, Floats]:
    """A parallelogram, off the axis."""
    return 1 + u + 0.2 * v, 0.1 * u + 0.9 * v


@pytest.mark.parametrize("is_nlgeom", [False, True], ids=["small", "nlgeom"])
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("prefix", ["CPS", "CPE", "CAX"])
def test_patch(run_deck: Run, tmp_path: Path, prefix: str, shape: str, is_nlgeom: bool) -> None:
    """An affine motion of the boundary is followed inside with one stress. Axisymmetric: u_r = a r, u_z = b z."""
    body = sheet(prefix, shape, (4, 3), square, 0.3)
    slope = np.array([[1.0, 0.5], [0.2, -0.4]]) * (0.1 if is_nlgeom else 1e-3)
    if prefix == "CAX":
        slope = np.diag([0.1, -0.05]) * (1 if is_nlgeom else 1e-2)
    u = body.nodes @ slope.T
    outside = np.flatnonzero((np.abs(body.uv - 0.5) > 0.5 - 1e-9).any(axis=1))
    cards = "*BOUNDARY\n" + "".join(f"{n + 1}, {d + 1}, {d + 1}, {u[n, d]:.17g}\n" for n in outside for d in (0, 1))
    found = solve(run_deck, tmp_path, body.cards() + material(1000, 0.3, 0.5) + step(cards, is_nlgeom, "0.5, 1."))
    scale = np.abs(u).max()
    assert np.abs(found["U"][:, :2] - u).max() <= 1e-9 * scale
    assert np.abs(found["U"][:, 2]).max() == 0
    assert np.abs(found["S"] - found["S"][0]).max() <= 1e-7 * np.abs(found["S"]).max()
    if prefix == "CPS":
        assert np.abs(found["S"][:, 2]).max() <= 1e-12 * np.abs(found["S"]).max()


@pytest.mark.parametrize(("shape", "tolerance"), [("3", 0.08), ("4", 0.02), ("4I", 0.02), ("4R", 0.02), ("6", 0.003), ("8", 0.003),
                                                  ("8R", 0.003)])
@pytest.mark.parametrize("prefix", ["CPE", "CAX"])
def test_thick_cylinder(run_deck: Run, tmp_path: Path, prefix: str, shape: str, tolerance: float) -> None:
    """Lame: a tube of radii 1 and 2 under inner pressure, plane strain, 8 cells through the wall."""
    e, nu, p, inner, outer = 1000.0, 0.3, 10.0, 1.0, 2.0
    a = p * inner**2 / (outer**2 - inner**2)
    expected = (1 + nu) / e * (a * (1 - 2 * nu) * inner + a * outer**2 / inner)
    if prefix == "CAX":
        body = sheet(prefix, shape, (8, 1), lambda u, v: (1 + u, 0.2 * v))
        cards = supports(range(len(body.nodes)), 2)
        load_edge, inside, hoop = body.edges(0, 0.0), body.where(0, 0.0), 2
    else:
        quarter = np.pi / 2
        body = sheet(prefix, shape, (8, 12), lambda u, v: ((1 + u) * np.cos(quarter * v), (1 + u) * np.sin(quarter * v)))
        cards = supports(body.where(1, 0.0), 2) + supports(body.where(1, 1.0), 1)
        load_edge, inside, hoop = body.edges(0, 0.0), body.where(0, 0.0), 1
    load = "*DLOAD\n" + "".join(f"{el + 1}, P{edge}, {p}\n" for el, edge in load_edge)
    found = solve(run_deck, tmp_path, body.cards() + material(e, nu) + cards + step(load))
    node = next(n for n in inside if abs(body.nodes[n, 1]) < 1e-9)
    near(found["U"][node, 0], expected, tolerance / 2, "displacement of the bore")
    stress = a * (1 + outer**2 / inner**2)
    near(found["S"][node, hoop], stress, 8 * tolerance, "hoop stress of the bore")


@pytest.mark.parametrize("shape", ["4", "4I", "8R"])
def test_full_circle(run_deck: Run, tmp_path: Path, shape: str) -> None:
    """Reactions of axisymmetric bodies are those of the full circle: a pressed disk gives pressure times area."""
    body = sheet("CAX", shape, (4, 2), lambda u, v: (2 * u, v))
    load = "*DLOAD\n" + "".join(f"{el + 1}, P{edge}, 3.\n" for el, edge in body.edges(1, 1.0))
    cards = supports(body.where(1, 0.0), 2) + supports(body.where(0, 0.0), 1)
    found = solve(run_deck, tmp_path, body.cards() + material(1000, 0.3) + cards + step(load, True))
    assert abs(found["S"][:, 1] + 3).max() < 0.05
    near(found["RF"][body.where(1, 0.0), 1].sum(), 3 * np.pi * (2 + found["U"][body.where(1, 1.0), 0].max()) ** 2, 1e-6,
         "reaction")


@pytest.mark.parametrize(("shape", "tolerance"), [("3", 0.12), ("4", 0.03), ("4I", 0.005), ("4R", 0.02), ("6", 0.005), ("8", 0.005),
                                                  ("8R", 0.005)])
def test_cook(run_deck: Run, tmp_path: Path, shape: str, tolerance: float) -> None:
    """Cook's membrane in plane stress, E = 1, nu = 1/3, F = 1: the middle of the free end rises 23.96
    (converged); 16 x 16 cells."""
    body = sheet("CPS", shape, (16, 16), lambda u, v: (48 * u, 44 * u * (1 - v) + v * (44 + 16 * u)))
    weights = np.zeros(len(body.nodes))
    for el, edge in body.edges(0, 1.0):  # consistent forces of a uniform shear
        nodes, corners = body.elements[el], 3 if len(body.elements[el]) in (3, 6) else 4
        ends = [nodes[edge - 1], nodes[edge % corners]]
        length = abs(body.nodes[ends[0], 1] - body.nodes[ends[1], 1]) / 16
        weights[ends] += length / (6 if shape[0] in "68" else 2)
        if shape[0] in "68":
            weights[nodes[corners + edge - 1]] += 2 * length / 3
    load = "*CLOAD\n" + "".join(f"{n + 1}, 2, {w:.17g}\n" for n, w in enumerate(weights) if w > 0)
    found = solve(run_deck, tmp_path, body.cards() + material(1, "0.33333333333333333") + supports(body.where(0, 0.0), 1, 2)
                  + step(load))
    tip = int(np.argmin(np.abs(body.uv - [1, 0.5]).sum(axis=1)))
    near(found["U"][tip, 1], 23.96, tolerance, "rise of the middle")


@pytest.mark.parametrize(("shape", "tolerance"), [("3", 0.2), ("4", 0.06), ("4I", 0.03), ("4R", 0.2), ("6", 0.03), ("8", 0.02), ("8R", 0.02)])
def test_nafems_le1(run_deck: Run, tmp_path: Path, shape: str, tolerance: float) -> None:
    """NAFEMS LE1: an elliptic membrane pulled outside by 10 MPa; stress yy at the inner end of the long axis 92.7 MPa."""
    def place(u: Floats, v: Floats) -> tuple[Floats, Floats]:
        angle = np.pi / 2 * v
        return ((1 - u) * 2.0 + u * 3.25) * np.cos(angle), ((1 - u) * 1.0 + u * 2.75) * np.sin(angle)

    body = sheet("CPS", shape, (12, 24), place)
    load = "*DLOAD\n" + "".join(f"{el + 1}, P{edge}, -10.\n" for el, edge in body.edges(0, 1.0))
    cards = supports(body.where(1, 0.0), 2) + supports(body.where(1, 1.0), 1)
    found = solve(run_deck, tmp_path, body.cards() + material(210e3, 0.3, 0.1) + cards + step(load))
    corner = int(np.argmin(np.abs(body.uv).sum(axis=1)))
    near(found["S"][corner, 1], 92.7, tolerance, "stress at D")


@pytest.mark.parametrize(("kind", "low", "high"), [("C3D8I", 0.99, 1.01), ("C3D8R", 0.97, 1.03), ("C3D8", 0.3, 0.95),
                                                   ("C3D15", 0.97, 1.01), ("C3D20R", 0.99, 1.01)])
def test_cantilever(run_deck: Run, tmp_path: Path, kind: str, low: float, high: float) -> None:
    """A bar 10 x 1 x 1, one element high, pulled down at its end: F l^3/(3 E I) + 6/5 F l/(G A). C3D8 locks in shear."""
    body = as_kind(make_decks.block(np.linspace(0, 10, 11), [0, 1.0], [0, 1.0], "BAR"), kind)
    end = body.where(0, 10.0)
    ends = node_set("ROOT", body.where(0, 0.0)) + node_set("END", end)
    master = int(end[0])
    ties = "".join(f"*EQUATION\n2\n{n + 1}, 3, 1., {master + 1}, 3, -1.\n" for n in end[1:])
    middle = [n for n in body.where(0, 0.0) if abs(body.nodes[n, 2]) < 1e-9]
    cards = "*BOUNDARY\nROOT, 1\n" + "".join(f"{n + 1}, 3\n" for n in middle) + f"{middle[0] + 1}, 2\n"
    deck = body.cards() + ends + material(1000, 0.0) + ties + cards + step(f"*CLOAD\n{master + 1}, 3, -0.01\n")
    found = solve(run_deck, tmp_path, deck)
    expected = 0.01 * 10**3 / (3 * 1000 / 12) + 1.2 * 0.01 * 10 / 500
    ratio = -found["U"][master, 2] / expected
    assert low <= ratio <= high, f"{kind}: {ratio:.4f} of the deflection of the beam"


def test_bending_of_incompressible_modes(run_deck: Run, tmp_path: Path) -> None:
    """C3D8I and C3D8R bend without locking at nu = 0.4999 too: pressures that turn round at mid height."""
    ratio = {}
    for kind in ("C3D8I", "C3D8R", "C3D8"):
        body = as_kind(make_decks.block(np.linspace(0, 8, 9), [0, 1.0], [0, 0.5, 1.0], "BAR"), kind)
        upper = [f for f in body.outer_faces(body.where(0, 8.0)) if body.nodes[body.elements[f[0]], 2].mean() > 0.5]
        lower = [f for f in body.outer_faces(body.where(0, 8.0)) if body.nodes[body.elements[f[0]], 2].mean() < 0.5]
        root = node_set("ROOT", body.where(0, 0.0))
        corner = int(np.argmin(np.abs(body.nodes).sum(axis=1)))
        edge = [n for n in body.where(0, 0.0) if abs(body.nodes[n, 2]) < 1e-9]
        cards = "*BOUNDARY\nROOT, 1\n" + "".join(f"{n + 1}, 3\n" for n in edge) + f"{corner + 1}, 2\n"
        deck = body.cards() + root + material(1000, 0.4999) + cards + step(pressure_on(upper, -0.4) + pressure_on(lower, 0.4))
        found = solve(run_deck, tmp_path, deck)
        end = int(np.argmin(np.abs(body.nodes - [8, 0, 0]).sum(axis=1)))
        moment = 0.4 * 0.5 * 0.5  # two halves of area 1/2, half a height apart
        ratio[kind] = found["U"][end, 2] / (moment * 8**2 / (2 * 1000 / 12))
    assert 0.97 <= abs(ratio["C3D8I"]) <= 1.03 and 0.9 <= abs(ratio["C3D8R"]) <= 1.1, ratio


@pytest.mark.parametrize("kind", ["T3D2", "T3D3"])
def test_two_bars(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """Two bars hang at 45 degrees with a force down at their joint: u = F l/(2 E A cos^2) along it; then pulled far."""
    if kind == "T3D2":
        lines = "*NODE\n1, -1, 1\n2, 1, 1\n3, 0, 0\n*ELEMENT, TYPE=T3D2, ELSET=ALL\n1, 1, 3\n2, 2, 3\n"
        extra = ""
    else:
        lines = ("*NODE\n1, -1, 1\n2, 1, 1\n3, 0, 0\n4, -0.5, 0.5\n5, 0.5, 0.5\n"
                 "*ELEMENT, TYPE=T3D3, ELSET=ALL\n1, 1, 4, 3\n2, 2, 5, 3\n")
        extra = "*EQUATION\n2\n4, 1, 1., 4, 2, 1.\n*EQUATION\n2\n5, 1, 1., 5, 2, -1.\n"  # a middle may not leave its line
    cards = extra + "*BOUNDARY\n1, 1, 3\n2, 1, 3\n3, 3\n" + ("" if kind == "T3D2" else "4, 3\n5, 3\n")
    deck = lines + material(1000, 0.3, 0.01) + cards + step("*CLOAD\n3, 2, -0.001\n")
    found = solve(run_deck, tmp_path, deck)
    near(found["U"][2, 1], -0.001 * np.sqrt(2) / (2 * 1000 * 0.01 * 0.5), 1e-9, "sag")
    near(found["S"][2, 0], 0.001 / (2 * np.sqrt(0.5)) / 0.01, 1e-9, "axial stress")


def test_bars_pulled_far(run_deck: Run, tmp_path: Path) -> None:
    """The joint of two T3D2 moved by one length: force 2 A0 tau/l sin(angle), tau = E ln(l/L)."""
    lines = "*NODE\n1, -1, 0\n2, 1, 0\n3, 0, 0\n*ELEMENT, TYPE=T3D2, ELSET=ALL\n1, 1, 3\n2, 2, 3\n"
    cards = "*BOUNDARY\n1, 1, 3\n2, 1, 3\n3, 1\n3, 3\n"
    deck = lines + material(1000, 0.3, 0.01) + cards + step("*BOUNDARY\n3, 2, 2, -1.\n", True, "0.1, 1.")
    found = solve(run_deck, tmp_path, deck)
    stretch = np.sqrt(2.0)
    near(found["RF"][2, 1], -2 * 0.01 * 1000 * np.log(stretch) / stretch * np.sqrt(0.5), 1e-8, "force")


def test_springs_and_mass(run_deck: Run, tmp_path: Path) -> None:
    """A mass of 2 hangs under gravity 10 on springs of 40 and 60 in a row: 20/40 and 20/60 longer; SPRING1 beside."""
    deck = """*NODE
1, 0, 0, 0
2, 0, 0, -1
3, 0, 0, -2
4, 1, 0, 0
*ELEMENT, TYPE=SPRINGA, ELSET=A
1, 1, 2
*ELEMENT, TYPE=SPRING2, ELSET=B
2, 2, 3
*ELEMENT, TYPE=MASS, ELSET=M
3, 3
*ELEMENT, TYPE=SPRING1, ELSET=C
4, 4
*SPRING, ELSET=A

40.
*SPRING, ELSET=B
3, 3
60.
*SPRING, ELSET=C
1
5.
*MASS, ELSET=M
2.
*BOUNDARY
1, 1, 3
2, 1, 2
""" + step("*DLOAD\nM, GRAV, 10., 0., 0., -1.\n*CLOAD\n4, 1, 3.\n")
    found = solve(run_deck, tmp_path, deck)
    near(found["U"][1, 2], -0.5, 1e-12, "first spring")
    near(found["U"][2, 2], -0.5 - 1 / 3, 1e-12, "both springs")
    near(found["U"][3, 0], 0.6, 1e-12, "spring to the ground")
    near(found["RF"][0, 2], 20, 1e-12, "weight")


def test_contact_needs_one_kind(run_deck: Run) -> None:
    """A face cannot touch an edge: refused, with what is wrong."""
    deck = """*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
11, 0., 1., 0.
12, 1., 1., 0.
13, 1., 2., 0.
14, 0., 2., 0.
*ELEMENT, TYPE=C3D8, ELSET=SOLID
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=CPE4, ELSET=PLATE
2, 11, 12, 13, 14
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET=SOLID, MATERIAL=M
*SOLID SECTION, ELSET=PLATE, MATERIAL=M
1.
*SURFACE, NAME=FACE
1, S5
*SURFACE, NAME=EDGE
2, S1
*SURFACE INTERACTION, NAME=I
*CONTACT PAIR, INTERACTION=I
EDGE, FACE
""" + step("*BOUNDARY\n1, 1, 3\n2, 1, 3\n")
    done = run_deck(deck)
    assert done.returncode == 4
    assert "both surfaces must be of one kind" in done.stdout + done.stderr


PLANE_TRUSS = """*NODE, NSET=ALL
1, 0., 0.
2, 3., 0.
3, 3., 4.
*ELEMENT, TYPE={kind}, ELSET=BARS
1, 1, 2
2, 2, 3
3, 1, 3
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET=BARS, MATERIAL=M
2.
*BOUNDARY
1, 1, 2
2, 2
{more}*STEP{nlgeom}
*STATIC
*CLOAD
3, 1, {force}
*NODE PRINT, NSET=ALL
U
*END STEP
"""


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
def test_plane_trusses(run_deck: Run, tmp_path: Path, nlgeom: str) -> None:
    """T2D2 needs no support out of the plane: a triangle of bars is as one of T3D2 that are held there, and statics gives the small one."""
    found = []
    force = 1e-3 if not nlgeom else 60.0
    for kind, more in (("T2D2", ""), ("T3D2", "ALL, 3\n")):
        done = run_deck(PLANE_TRUSS.format(kind=kind, more=more, nlgeom=nlgeom, force=force))
        assert done.returncode == 0, done.stdout
        rows = [line.split() for line in (tmp_path / "job.dat").read_text().splitlines() if line.split()[:1] == ["3"]]
        found.append([float(word) for word in rows[-1][1:]])
    assert found[0] == pytest.approx(found[1], rel=1e-6, abs=1e-12)
    # forces per load: diagonal 5/3, upright -4/3, base 0; work of the load: u = sum of n^2 L / (E A)
    u = force * ((5 / 3) ** 2 * 5 + (4 / 3) ** 2 * 4) / (1000.0 * 2.0)
    assert found[0][0] == pytest.approx(u, rel=1e-6 if not nlgeom else 0.2)
    assert found[0][2] == 0.0
