"""Meshes and decks as other programs write them run unchanged: gmsh and meshio make them here, PrePoMax and FreeCAD are imitated.

Every body is a box under a uniform pressure between symmetry planes, so that the answer is that of a bar whatever the mesh:
u_z = -p L / E, u_x = nu p W / E. The files of gmsh and meshio are included as they are; the decks of the other two are made of
a mesh in the words and the order in which these programs write.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

gmsh = pytest.importorskip("gmsh")
meshio = pytest.importorskip("meshio")

YOUNG, NU, PRESSURE = 1000.0, 0.3, 10.0
SIZE = (1.0, 2.0, 3.0)
DIGITS = 1e-5  # of the largest displacement; the default tolerance of the calculix dialect does not apply

Runner = Callable[..., object]

STEP = f"""*MATERIAL, NAME=M
*ELASTIC
{YOUNG}, {NU}
*SOLID SECTION, ELSET=BODY, MATERIAL=M
*STEP
*STATIC
*BOUNDARY
XLOW, 1, 1
YLOW, 2, 2
ZLOW, 3, 3
*DSLOAD
TOP, P, {PRESSURE}
*NODE PRINT, NSET=CORNER
U
*END STEP
"""


@pytest.fixture
def box() -> object:
    """A box in gmsh; the caller meshes and writes it."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 1)
    gmsh.option.setNumber("Mesh.MeshSizeMin", 0.7)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.7)
    gmsh.model.add("box")
    yield gmsh.model.occ
    gmsh.finalize()


def faces() -> dict[str, int]:
    """The surfaces of the box by where they are."""
    found = {}
    for _, tag in gmsh.model.getEntities(2):
        centre = np.array(gmsh.model.occ.getCenterOfMass(2, tag))
        for k, axis in enumerate("XYZ"):
            if abs(centre[k]) < 1e-9:
                found[axis + "LOW"] = tag
            if abs(centre[k] - SIZE[k]) < 1e-9:
                found[axis + "HIGH"] = tag
    return found


def corner_of(path: Path) -> str:
    """The number of the node at the far corner of a mesh that is written."""
    for line in path.read_text().splitlines():
        fields = line.split(",")
        if len(fields) == 4 and all(re.fullmatch(r"\s*[-+.\deE]+\s*", f) for f in fields):
            if np.allclose([float(f) for f in fields[1:]], SIZE, atol=1e-9):
                return fields[0].strip()
    raise AssertionError("the corner is not there")


def check(run: Runner, folder: Path, deck: str, notes: str = "", sign: float = -1.0) -> str:
    """Runs a deck and compares the far corner with the bar."""
    (folder / "job.inp").write_text(deck)
    done = run(["job"], cwd=folder)
    output = done.stdout + done.stderr
    assert done.returncode == 0, output
    assert notes in output
    row = [line.split() for line in (folder / "job.dat").read_text().splitlines() if re.match(r" +\d+ +-?\d\.", line)][-1]
    wanted = [-sign * NU * PRESSURE * SIZE[0] / YOUNG, -sign * NU * PRESSURE * SIZE[1] / YOUNG, sign * PRESSURE * SIZE[2] / YOUNG]
    assert [float(word) for word in row[1:4]] == pytest.approx(wanted, abs=DIGITS * abs(wanted[2]))
    return output


@pytest.mark.parametrize("order", [1, 2])
def test_gmsh_saves_all(run: Runner, tmp_path: Path, box: object, order: int) -> None:
    """Without groups gmsh writes lines and faces too, under names of its own: they are left out, but surfaces can name them."""
    box.addBox(0, 0, 0, *SIZE)
    box.synchronize()
    places = faces()
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(order)
    gmsh.write(str(tmp_path / "box.inp"))
    text = (tmp_path / "box.inp").read_text()
    assert ("type=CPS6" if order == 2 else "type=CPS3") in text and "type=T3D" in text
    sets = "".join(f"*SURFACE, NAME={name}\nSurface{tag},\n" for name, tag in places.items() if name == "ZHIGH")
    sets = sets.replace("ZHIGH", "TOP")
    sets += "".join(f"*NSET, NSET={name}, ELSET=Surface{tag}\n" for name, tag in places.items())
    deck = f"*INCLUDE, INPUT=box.inp\n*ELSET, ELSET=BODY\nVolume1\n{sets}*NSET, NSET=CORNER\n{corner_of(tmp_path / 'box.inp')}\n{STEP}"
    check(run, tmp_path, deck, "lines or faces of solids")


@pytest.mark.parametrize("order", [1, 2])
def test_gmsh_groups_of_hexahedra(run: Runner, tmp_path: Path, box: object, order: int) -> None:
    """Physical groups with names, and node sets that gmsh writes on request."""
    box.addBox(0, 0, 0, *SIZE)
    box.synchronize()
    for dim, tag in gmsh.model.getEntities(1):
        gmsh.model.mesh.setTransfiniteCurve(tag, 3)
        assert dim == 1
    for _, tag in gmsh.model.getEntities(2):
        gmsh.model.mesh.setTransfiniteSurface(tag)
        gmsh.model.mesh.setRecombine(2, tag)
    gmsh.model.mesh.setTransfiniteVolume(1)
    for name, tag in faces().items():
        gmsh.model.addPhysicalGroup(2, [tag], name=f"face {name}")
    gmsh.model.addPhysicalGroup(3, [1], name="BODY")
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(order)
    gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", 1)
    gmsh.write(str(tmp_path / "box.inp"))
    text = (tmp_path / "box.inp").read_text()
    assert ("type=C3D20" if order == 2 else "type=C3D8") in text and "NSET=face_XLOW" in text
    step = STEP
    for name in ("XLOW", "YLOW", "ZLOW"):
        step = step.replace(f"\n{name},", f"\nface_{name},")
    deck = f"*INCLUDE, INPUT=box.inp\n*SURFACE, NAME=TOP\nface_ZHIGH,\n*NSET, NSET=CORNER\n{corner_of(tmp_path / 'box.inp')}\n{step}"
    check(run, tmp_path, deck, "lines or faces of solids")


def test_gmsh_plane_body(run: Runner, tmp_path: Path, box: object) -> None:
    """A mesh of triangles with a section is the body; its edges are the lines that are left out."""
    box.addRectangle(0, 0, 0, SIZE[0], SIZE[2])
    box.synchronize()
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(2)
    lines = {}
    for _, tag in gmsh.model.getEntities(1):
        x, y, _ = gmsh.model.occ.getCenterOfMass(1, tag)
        lines[(round(x, 6), round(y, 6))] = tag
    gmsh.write(str(tmp_path / "box.inp"))
    assert "type=CPS6" in (tmp_path / "box.inp").read_text()
    low, left, up = lines[(SIZE[0] / 2, 0.0)], lines[(0.0, SIZE[2] / 2)], lines[(SIZE[0] / 2, SIZE[2])]
    deck = f"""*INCLUDE, INPUT=box.inp
*NSET, NSET=LOW, ELSET=Line{low}
*NSET, NSET=LEFT, ELSET=Line{left}
*NSET, NSET=UP, ELSET=Line{up}
*SURFACE, NAME=TOP
Line{up},
*MATERIAL, NAME=M
*ELASTIC
{YOUNG}, {NU}
*SOLID SECTION, ELSET=Surface1, MATERIAL=M
.5
*STEP
*STATIC
*BOUNDARY
LOW, 2, 2
LEFT, 1, 1
*DSLOAD
TOP, P, {PRESSURE}
*NODE PRINT, NSET=UP
U
*END STEP
"""
    (tmp_path / "job.inp").write_text(deck)
    done = run(["job"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    rows = [line.split() for line in (tmp_path / "job.dat").read_text().splitlines() if re.match(r" +\d+ +-?\d\.", line)]
    assert rows and all(float(r[2]) == pytest.approx(-PRESSURE * SIZE[2] / YOUNG, rel=DIGITS) for r in rows)
    assert max(float(r[1]) for r in rows) == pytest.approx(NU * PRESSURE * SIZE[0] / YOUNG, rel=DIGITS)


CELLS = {"hexahedron": 8, "hexahedron20": 20, "tetra": 4, "tetra10": 10, "wedge": 6}
EDGES = {
    "hexahedron20": [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)],
    "tetra10": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
}


def box_mesh(kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Points and cells of a box of two cells in each direction, cut into wedges or tetrahedra if need be."""
    grid = [np.linspace(0, s, 3) for s in SIZE]
    points = np.array([[x, y, z] for z in grid[2] for y in grid[1] for x in grid[0]])
    cells = []
    for k in range(2):
        for j in range(2):
            for i in range(2):
                a = i + 3 * j + 9 * k
                hexa = [a, a + 1, a + 4, a + 3, a + 9, a + 10, a + 13, a + 12]
                wedges = [[hexa[m] for m in (0, 1, 2, 4, 5, 6)], [hexa[m] for m in (0, 2, 3, 4, 6, 7)]]
                if kind.startswith("hexa"):
                    cells.append(hexa)
                elif kind.startswith("wedge"):
                    cells += wedges
                else:
                    cells += [[hexa[0], hexa[p], hexa[q], hexa[6]] for p, q in ((1, 2), (2, 3), (3, 7), (7, 4), (4, 5), (5, 1))]
    table = [list(cell) for cell in cells]
    all_points, middle = list(points), {}
    for cell in table:
        for a, b in EDGES.get(kind, []):
            key = (min(cell[a], cell[b]), max(cell[a], cell[b]))
            if key not in middle:
                middle[key] = len(all_points)
                all_points.append((points[key[0]] + points[key[1]]) / 2)
            cell.append(middle[key])
    return np.array(all_points), np.array(table)


@pytest.mark.parametrize("kind", CELLS)
def test_meshio(run: Runner, tmp_path: Path, kind: str) -> None:
    """Long numbers, hybrid and modified types, C3D20 in one line of 21 numbers, sets of nodes and cells."""
    points, cells = box_mesh(kind)
    ends = {f"{axis}LOW": np.flatnonzero(np.abs(points[:, k]) < 1e-9) for k, axis in enumerate("XYZ")}
    ends["CORNER"] = np.flatnonzero(np.all(np.abs(points - SIZE) < 1e-9, axis=1))
    mesh = meshio.Mesh(points, [(kind, cells)], point_sets=ends, cell_sets={"BODY": [np.arange(len(cells))]})
    meshio.write(tmp_path / "mesh.inp", mesh, file_format="abaqus")
    prescribed = f"*BOUNDARY\nZHIGH, 3, 3, {-PRESSURE * SIZE[2] / YOUNG:.17g}\n"
    high = np.flatnonzero(np.abs(points[:, 2] - SIZE[2]) < 1e-9) + 1
    deck = "*INCLUDE, INPUT=mesh.inp\n*NSET, NSET=ZHIGH\n" + "\n".join(map(str, high)) + "\n"
    deck += STEP.replace(f"*DSLOAD\nTOP, P, {PRESSURE}\n", prescribed)
    check(run, tmp_path, deck)


def faces_of_top(cells: np.ndarray, points: np.ndarray) -> list[int]:
    """Numbers of the hexahedra whose face 2 is on top."""
    return [e + 1 for e, cell in enumerate(cells) if np.allclose(points[cell[4:8], 2], SIZE[2])]


def numbers(items: np.ndarray | list[int]) -> str:
    """Whole numbers, eight in a line, each followed by a comma."""
    rows = [items[i : i + 8] for i in range(0, len(items), 8)]
    return ",\n".join(", ".join(map(str, row)) for row in rows) + "\n"


def test_prepomax(run: Runner, tmp_path: Path) -> None:
    """The order and the words of PrePoMax: frames of stars, empty OP=NEW cards, 1E+30 as the largest increment, supports 1 to 6."""
    points, cells = box_mesh("hexahedron20")
    frame = "**\n** {} ++++++++++++++++++++++++++++++++++++++++++++++\n**\n"
    nodes = "".join(f"{i}, {x:.8E}, {y:.8E}, {z:.8E}\n" for i, (x, y, z) in enumerate(points, 1))
    elements = "".join(f"{i}, " + ", ".join(map(str, cell[:10] + 1)) + ",\n" + ", ".join(map(str, cell[10:] + 1)) + "\n"
                       for i, cell in enumerate(cells, 1))
    low = {f"Internal_Selection-1_Symmetry-{axis}": np.flatnonzero(np.abs(points[:, k]) < 1e-9) + 1 for k, axis in enumerate("XYZ")}
    corner = np.flatnonzero(np.all(np.abs(points - SIZE) < 1e-9, axis=1)) + 1
    sets = "".join(f"*Nset, Nset={name}\n{numbers(list(items))}" for name, items in low.items())
    supports = "".join(f"** Name: Symmetry-{axis}\n*Boundary\nInternal_Selection-1_Symmetry-{axis}, {k}, {k}, 0\n"
                       for k, axis in enumerate("XYZ", 1))
    deck = frame.format("Heading") + "*Heading\nHash: 8sP2qv1w, Date: 2026-01-01, Unit system: MM_TON_S_C\n"
    deck += frame.format("Nodes") + f"*Node\n{nodes}" + frame.format("Elements") + f"*Element, Type=C3D20, Elset=Solid_part-1\n{elements}"
    deck += frame.format("Node sets") + sets + f"*Nset, Nset=Corner\n{corner[0]}\n" + frame.format("Element sets")
    deck += f"*Elset, Elset=Internal-1_Pressure-1_S2\n{numbers(faces_of_top(cells, points))}" + frame.format("Surfaces")
    deck += "*Surface, Name=Internal_Selection-1_Pressure-1, Type=Element\nInternal-1_Pressure-1_S2, S2\n"
    deck += frame.format("Physical constants") + frame.format("Coordinate systems") + frame.format("Materials")
    deck += f"*Material, Name=S235\n*Density\n7.8E-09\n*Elastic\n{YOUNG:g}, {NU:g}\n*Expansion, Zero=20\n1.1E-05\n"
    deck += "*Conductivity\n14\n*Specific heat\n440000000\n" + frame.format("Sections")
    deck += "*Solid section, Elset=Solid_part-1, Material=S235\n" + frame.format("Pre-tension sections") + frame.format("Constraints")
    deck += frame.format("Surface interactions") + frame.format("Contact pairs") + frame.format("Amplitudes")
    deck += frame.format("Initial conditions") + frame.format("Steps") + frame.format("Step-1")
    deck += "*Step, Nlgeom=No, Inc=100\n*Static, Solver=Pardiso\n1, 1, 1E-05, 1E+30\n" + frame.format("Output frequency")
    deck += "*Output, Frequency=1\n" + frame.format("Boundary conditions") + "*Boundary, op=New\n" + supports
    deck += frame.format("Loads") + "*Cload, op=New\n*Dload, op=New\n** Name: Pressure-1\n*Dload\n"
    deck += "".join(f"{e}, P2, {PRESSURE:g}\n" for e in faces_of_top(cells, points)) + frame.format("Defined fields")
    deck += "*Temperature, op=New\n" + frame.format("History outputs") + "*Node print, Nset=Corner, Totals=No\nU\n"
    deck += frame.format("Field outputs") + "*Node file\nRF, U\n*El file\nS, E, NOE\n" + frame.format("End step") + "*End step\n"
    check(run, tmp_path, deck)


def test_freecad(run: Runner, tmp_path: Path) -> None:
    """The words of FreeCAD's writer: Evolumes, Eall, sets of one name a line, TOTALS=ONLY."""
    points, cells = box_mesh("tetra10")
    nodes = "".join(f"{i}, {x:.13g}, {y:.13g}, {z:.13g}\n" for i, (x, y, z) in enumerate(points, 1))
    elements = "".join(f"{i}, " + ", ".join(map(str, cell + 1)) + "\n" for i, cell in enumerate(cells, 1))
    fixed = {f"FemConstraint{axis}": np.flatnonzero(np.abs(points[:, k]) < 1e-9) + 1 for k, axis in enumerate("XYZ")}
    fixed["Moved"] = np.flatnonzero(np.abs(points[:, 2] - SIZE[2]) < 1e-9) + 1
    corner = np.flatnonzero(np.all(np.abs(points - SIZE) < 1e-9, axis=1))[0] + 1
    sets = "".join(f"** {name}\n*NSET,NSET={name}\n" + "".join(f"{n},\n" for n in items) + "\n" for name, items in fixed.items())
    bounds = "".join(f"** {name}\n*BOUNDARY\n{name},{k}\n\n" for k, name in enumerate(list(fixed)[:3], 1))
    star = "***********************************************************\n"
    deck = f"""** written by FreeCAD inp file writer for CalculiX,Abaqus meshes
** all mesh elements.

** Nodes
*Node, NSET=Nall
{nodes}
** Volume elements
*Element, TYPE=C3D10, ELSET=Evolumes
{elements}
** Define element set Eall
*ELSET, ELSET=Eall
Evolumes

{star}** Element sets for materials and FEM element type (solid, shell, beam, fluid)
*ELSET,ELSET=MaterialSolidSolid
Evolumes

{star}** Node sets for constraints
{sets}*NSET,NSET=Shown
{corner},

{star}** Materials
** Young's modulus unit is MPa = N/mm2
*MATERIAL, NAME=MaterialSolid
*ELASTIC
{YOUNG:.0f},{NU:.3f}

{star}** Sections
*SOLID SECTION, ELSET=MaterialSolidSolid, MATERIAL=MaterialSolid

{star}** At least one step is needed to run an CalculiX analysis of FreeCAD
*STEP, INC=2000
*STATIC


{star}** Fixed Constraints
{bounds}** Displacement constraint
*BOUNDARY
Moved,3,3,{-PRESSURE * SIZE[2] / YOUNG}

{star}** Outputs --> frd file
*NODE FILE
U
*EL FILE
S, E
** outputs --> dat file
** reaction forces for Constraint fixed
*NODE PRINT, NSET=FemConstraintZ, TOTALS=ONLY
RF

*NODE PRINT, NSET=Shown
U

*OUTPUT, FREQUENCY=1
{star}*END STEP
"""
    check(run, tmp_path, deck)
    text = (tmp_path / "job.dat").read_text()
    total = re.search(r"total force.*\n\n +(\S+) +(\S+) +(\S+)", text)
    assert total
    assert float(total.group(3)) == pytest.approx(PRESSURE * SIZE[0] * SIZE[1], rel=1e-5)


AREA, FORCE, SLOPE = SIZE[0] * SIZE[1], 60.0, 50.0 * YOUNG


def stack() -> tuple[str, list[list[tuple[int, list[int]]]], dict[str, list[int]], int]:
    """Three boxes of C3D8, one on the other, that share no nodes: node lines, elements of each, node sets, number of nodes."""
    points, cells = box_mesh("hexahedron")
    n = len(points)
    nodes = "".join(f"{i + 1 + b * n}, {x:.8E}, {y:.8E}, {z + b * SIZE[2]:.8E}\n" for b in range(3) for i, (x, y, z) in enumerate(points))
    bodies = [[(e + 1 + b * len(cells), [int(m) + 1 + b * n for m in cell]) for e, cell in enumerate(cells)] for b in range(3)]
    low = [i + 1 for i in np.flatnonzero(np.abs(points[:, 2]) < 1e-9)]
    high = [i + 1 + 2 * n for i in np.flatnonzero(np.abs(points[:, 2] - SIZE[2]) < 1e-9)]
    return nodes, bodies, {"LOW": low, "HIGH": high}, 3 * n


def ends(bodies: list[list[tuple[int, list[int]]]], b: int, side: str) -> list[int]:
    """The elements of a box with a face below (S1) or above (S2)."""
    half = len(bodies[b]) // 2
    elements = [e for e, _ in bodies[b]]
    return elements[:half] if side == "S1" else elements[half:]


def check_stack(run: Runner, folder: Path, deck: str, *options: str) -> list[tuple[str, list[float]]]:
    """Runs a deck of the stack, nu = 0, and compares the descent of the reference point: F (3 L/(E A) + 1/(K A)).

    Gives the rows of the .dat file, each with the heading of its block.
    """
    (folder / "job.inp").write_text(deck)
    done = run([*options, "job"], cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    rows, title = [], ""
    for line in (folder / "job.dat").read_text().splitlines():
        if re.search("[a-z]{3}", line):
            title = line.strip()
        elif re.fullmatch(r"[-+.\dE ]*\d[-+.\dE ]*", line):
            rows.append((title, [float(word) for word in line.split()]))
    descent = [row for head, row in rows if head.startswith("displacements")][-1]
    assert descent[3] == pytest.approx(-FORCE / AREA * (3 * SIZE[2] / YOUNG + 1 / SLOPE), rel=1e-4)
    return rows


def test_prepomax_assembly(run: Runner, tmp_path: Path) -> None:
    """A tie, a contact pair with Adjust, a rigid body with its two nodes, an amplitude of many pairs, all in PrePoMax's words."""
    nodes, bodies, sets, n = stack()
    frame = "**\n** {} ++++++++++++++++++++++++++++++++++++++++++++++\n**\n"
    deck = frame.format("Heading") + "*Heading\nModel: Model-1,     Date: 1. 02. 2026,     Unit system: MM_TON_S_C\n"
    deck += frame.format("Nodes") + f"*Node\n{nodes}{n + 1}, 0.5, 1, 9\n{n + 2}, 0.5, 1, 9\n" + frame.format("Elements")
    for b, body in enumerate(bodies):
        deck += f"*Element, Type=C3D8, Elset=Solid_part-{b + 1}\n" + "".join(f"{e}, {', '.join(map(str, cell))}\n" for e, cell in body)
    deck += frame.format("Node sets") + f"*Nset, Nset=RP-1_ref_{n + 1}\n{n + 1}\n*Nset, Nset=RP-1_rot_{n + 2}\n{n + 2}\n"
    deck += f"*Nset, Nset=Internal_Selection-1_Fixed-1\n{numbers(sets['LOW'])}*Nset, Nset=Internal_Selection-1_Rigid_Body-1\n{numbers(sets['HIGH'])}"
    deck += frame.format("Element sets")
    surfaces = ""
    for name, b, side in (("Tie-1_Slave", 1, "S1"), ("Tie-1_Master", 0, "S2"), ("Contact_Pair-1_Slave", 2, "S1"), ("Contact_Pair-1_Master", 1, "S2")):
        deck += f"*Elset, Elset=Internal-1_{name}_{side}\n{numbers(ends(bodies, b, side))}"
        surfaces += f"*Surface, Name=Internal_Selection-1_{name}, Type=Element\nInternal-1_{name}_{side}, {side}\n"
    deck += frame.format("Surfaces") + surfaces + frame.format("Physical constants") + frame.format("Coordinate systems")
    deck += frame.format("Materials") + f"*Material, Name=Steel\n*Elastic\n{YOUNG:g}, 0\n" + frame.format("Sections")
    deck += "".join(f"*Solid section, Elset=Solid_part-{b}, Material=Steel\n" for b in (1, 2, 3)) + frame.format("Pre-tension sections")
    deck += frame.format("Constraints") + "*Tie, Name=Tie-1, Position tolerance=0.01\nInternal_Selection-1_Tie-1_Slave, Internal_Selection-1_Tie-1_Master\n"
    deck += f"*Rigid body, Nset=Internal_Selection-1_Rigid_Body-1, Ref node={n + 1}, Rot node={n + 2}\n"
    deck += frame.format("Surface interactions") + "*Surface interaction, Name=Surface_interaction-1\n"
    deck += f"*Surface behavior, Pressure-overclosure=Linear\n{SLOPE:g}, 1E-08\n*Friction\n0.1, {SLOPE / 10:g}\n"
    deck += frame.format("Contact pairs") + "*Contact pair, Interaction=Surface_interaction-1, Type=Node to surface, Adjust=0.001\n"
    deck += "Internal_Selection-1_Contact_Pair-1_Slave, Internal_Selection-1_Contact_Pair-1_Master\n" + frame.format("Amplitudes")
    deck += "*Amplitude, Name=Amplitude-1\n0, 0, 0.2, 0.2, 0.4, 0.4, 0.6, 0.6, \n0.8, 0.8, 1, 1\n" + frame.format("Initial conditions")
    deck += frame.format("Steps") + frame.format("Step-1") + "*Step, Inc=100\n*Static, Solver=PaStiX\n0.5, 1, 1E-05, 1E+30\n" + frame.format("Controls")
    deck += frame.format("Output frequency") + "*Output, Frequency=2\n" + frame.format("Boundary conditions") + "*Boundary, op=New\n"
    deck += "** Name: Fixed-1\n*Boundary\nInternal_Selection-1_Fixed-1, 1, 6, 0\n** Name: Displacement_rotation-1\n*Boundary\n"
    deck += f"RP-1_ref_{n + 1}, 1, 2, 0\n*Boundary\nRP-1_rot_{n + 2}, 1, 3, 0\n" + frame.format("Loads") + "*Cload, op=New\n*Dload, op=New\n"
    deck += f"** Name: Concentrated_Force-1\n*Cload, Amplitude=Amplitude-1\n{n + 1}, 3, {-FORCE:g}\n" + frame.format("Defined fields")
    deck += frame.format("History outputs") + f"*Node print, Nset=RP-1_ref_{n + 1}\nU\n"
    deck += "*Contact print, Totals=Only, Master=Internal_Selection-1_Contact_Pair-1_Master, Slave=Internal_Selection-1_Contact_Pair-1_Slave\nCNUM\n"
    deck += frame.format("Field outputs") + "*Node file\nRF, U\n*El file\nS, E, NOE\n*Contact file\nCDIS, CSTR, PCON\n" + frame.format("End step") + "*End step\n"
    check_stack(run, tmp_path, deck, "--dialect=calculix")
    text = (tmp_path / "job.frd").read_text()
    assert all(f" -4  {block}" in text for block in ("DISP", "FORC", "STRESS", "TOSTRAIN", "CONTACT"))


def test_freecad_assembly(run: Runner, tmp_path: Path) -> None:
    """A tie, contact with friction, a rigid body and a section in FreeCAD's words, the mesh in a file of its own."""
    nodes, bodies, sets, n = stack()
    star = "\n***********************************************************\n"
    mesh = "** written by FreeCAD inp file writer for CalculiX,Abaqus meshes\n** highest dimension mesh elements only.\n\n** Nodes\n*Node, NSET=Nall\n"
    mesh += nodes + "\n\n** Volume elements\n*Element, TYPE=C3D8, ELSET=Evolumes\n"
    mesh += "".join(f"{e}, {', '.join(map(str, cell))}\n" for body in bodies for e, cell in body)
    (tmp_path / "Mesh_Node_Elem_sets.inp").write_text(mesh + "\n** Define element set Eall\n*ELSET, ELSET=Eall\nEvolumes\n\n")
    deck = star + "** Nodes and Elements\n** written by femmesh.writeABAQUS\n*INCLUDE,INPUT=Mesh_Node_Elem_sets.inp \n"
    deck += star + "** Element sets for materials and FEM element type (solid, shell, beam, fluid)\n*ELSET,ELSET=M001MaterialSolid\nEvolumes\n"
    deck += star + "** constraints_fixed_node_sets\n** ConstraintFixed\n*NSET,NSET=ConstraintFixed\n" + "".join(f"{i},\n" for i in sets["LOW"])
    deck += star + "** constraints_rigidbody_node_sets\n*NSET,NSET=ConstraintRigidBody\n" + "".join(f"{i},\n" for i in sets["HIGH"]) + star
    for name, b, side in (("DEPConstraintContact", 2, "S1"), ("INDConstraintContact", 1, "S2"), ("TIE_DEPConstraintTie", 1, "S1"), ("TIE_INDConstraintTie", 0, "S2"),
                          ("SECTIONFACEConstraintSectionPrint", 0, "S1")):  # fmt: skip
        deck += f"*SURFACE, NAME={name}\n" + "".join(f"{e},{side}\n" for e in ends(bodies, b, side))
    deck += "\n** Physical constants for SI(mm) unit system with Kelvins\n*PHYSICAL CONSTANTS, ABSOLUTE ZERO=0, STEFAN BOLTZMANN=5.670374419e-11\n"
    deck += star + f"** Materials\n** see information about units at file end\n*MATERIAL, NAME=MaterialSolid\n*ELASTIC\n{YOUNG:.13G},{0:.13G}\n"
    deck += "*EXPANSION, ZERO=293.15\n1.2E-05\n" + star + "** Sections\n*SOLID SECTION, ELSET=M001MaterialSolid, MATERIAL=MaterialSolid\n"
    deck += star + "** Contact Constraints\n** ConstraintContact\n*CONTACT PAIR, INTERACTION=INTConstraintContact, TYPE=SURFACE TO SURFACE, ADJUST=0.01\n"
    deck += f"DEPConstraintContact, INDConstraintContact\n*SURFACE INTERACTION, NAME=INTConstraintContact\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{SLOPE:.13G}\n"
    deck += f"*FRICTION\n0.2, {SLOPE / 10:.13G}\n" + star + "** Tie Constraints\n*TIE, POSITION TOLERANCE=0.01, ADJUST=NO, NAME=TIEConstraintTie\n"
    deck += "TIE_DEPConstraintTie, TIE_INDConstraintTie\n" + star + f"** Rigid Body Constraints\n*NODE\n{n + 1},0.5,1.0,9.0\n{n + 2},0.5,1.0,9.0\n"
    deck += f"*NSET,NSET=ConstraintRigidBody_RefNode\n{n + 1},\n*NSET,NSET=ConstraintRigidBody_RotNode\n{n + 2},\n"
    deck += f"*RIGID BODY, NSET=ConstraintRigidBody, REF NODE={n + 1}, ROT NODE={n + 2}\n"
    deck += star + "** At least one step is needed to run an CalculiX analysis of FreeCAD\n*STEP, INC=2000\n"
    deck += "*CONTROLS, PARAMETERS=TIME INCREMENTATION\n4,8,9,200,10,400,,200,,\n0.25,0.5,0.75,0.85,,,1.5,\n*CONTROLS, PARAMETERS=FIELD\n0.0005,0.01,,,0.02,1e-05,0.001,1e-08\n"
    deck += "*STATIC, SOLVER=SPOOLES\n0.5,1.0,1e-05,0.5\n" + star + "** Fixed Constraints\n*BOUNDARY\nConstraintFixed,1\nConstraintFixed,2\nConstraintFixed,3\n\n"
    deck += star + f"** Rigid Body Constraints\n*BOUNDARY\n{n + 1},1,1,0\n*BOUNDARY\n{n + 1},2,2,0\n*CLOAD\n{n + 1},3,{-FORCE:.13G}\n"
    deck += "".join(f"*BOUNDARY\n{n + 2},{k},{k},0\n" for k in (1, 2, 3)) + star + "** SectionPrint Constraints\n"
    deck += "*SECTION PRINT, SURFACE=SECTIONFACEConstraintSectionPrint, NAME=SECTIONPRINTConstraintSectionPrint\nSOF, SOM, SOAREA\n" + star
    deck += "** Outputs --> frd file\n*NODE FILE\nU\n*EL FILE\nS, E\n** outputs --> dat file\n*NODE PRINT, NSET=ConstraintRigidBody_RefNode\nU\n"
    deck += "*NODE PRINT, NSET=ConstraintFixed, TOTALS=ONLY\nRF\n*CONTACT PRINT, MASTER=INDConstraintContact, SLAVE=DEPConstraintContact\nCF, CFN, CFS\n\n"
    deck += f"*OUTPUT, FREQUENCY=1{star}*END STEP\n{star}** CalculiX Input file\n** written by write_footer function\n**   Units\n"
    rows = check_stack(run, tmp_path, deck, "--dialect=calculix")
    total = [row for head, row in rows if head.startswith("total force")]
    assert total[-1] == pytest.approx([0.0, 0.0, FORCE], abs=1e-4 * FORCE)


def test_prepomax_compression_only(run: Runner, tmp_path: Path) -> None:
    """PrePoMax's "compression only" support: a gap GAPUNI from a ground node to each node of the face, and a plastic law that makes
    CalculiX iterate. A bar of 12 x 1 x 2 elements is pushed down near its left end: some nodes stay in contact, the others lift off.

    The gap elements transmit the force and its moment about the y axis; none pulls with more than its 0.001, and all with a force are closed.
    """
    force, n = 500.0, 12
    nodes = [(float(i), float(j), float(k)) for i in range(n + 1) for j in range(2) for k in range(3)]
    label = {place: i for i, place in enumerate(nodes, 1)}
    cells = [[label[(x + a, b + 0.0, z + c)] for c in (0.0, 1.0) for a, b in ((0.0, 0), (1.0, 0), (1.0, 1), (0.0, 1))]
             for x in map(float, range(n)) for z in (0.0, 1.0)]  # fmt: skip
    bottom = [(i, place) for place, i in label.items() if place[2] == 0.0]
    deck = (
        "** dialect: calculix\n*Node\n"
        + "".join(f"{i}, {x}, {y}, {z}\n" for (x, y, z), i in label.items())
        + "".join(f"{1000 + i}, {x}, {y}, {z}\n" for i, (x, y, z) in bottom)
        + "*Element, Type=C3D8I, Elset=Solid_part-1\n"
        + "".join(f"{i}, {', '.join(map(str, cell))}\n" for i, cell in enumerate(cells, 1))
        + "*Element, Type=GAPUNI, Elset=Internal_Gaps\n"
        + "".join(f"{500 + i}, {1000 + i}, {i}\n" for i, _ in bottom)
        + "*Nset, Nset=Internal_All_Compression_Only_Constraints_NodeSet\n"
        + "".join(f"{1000 + i},\n" for i, _ in bottom)
        + "*Nset, Nset=Bottom\n" + "".join(f"{i},\n" for i, _ in bottom)
        + f"""*Material, Name=S235
*Elastic
210000, 0.3
*Plastic
1E+10, 0
1E+11, 1
*Solid section, Elset=Solid_part-1, Material=S235
*Gap, Elset=Internal_Gaps
0, 0, 0, 1, , 1E+12, 0.001
** Name: Compression_Only_BC
*Boundary
Internal_All_Compression_Only_Constraints_NodeSet, 1, 1, 0
Internal_All_Compression_Only_Constraints_NodeSet, 2, 2, 0
Internal_All_Compression_Only_Constraints_NodeSet, 3, 3, 0
*Boundary
{label[(0.0, 0.0, 0.0)]}, 1, 2
{label[(float(n), 0.0, 0.0)]}, 2
*Step, Inc=100
*Static
*Cload, op=New
*Cload
{label[(3.0, 0.0, 2.0)]}, 3, {-force}
{label[(3.0, 1.0, 2.0)]}, 3, {-force}
*Node print, Nset=Internal_All_Compression_Only_Constraints_NodeSet
RF
*Node print, Nset=Bottom
U
*End step
""")
    (tmp_path / "job.inp").write_text(deck)
    done = run(["job"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    blocks = re.split(r"\n\n", (tmp_path / "job.dat").read_text())
    rows = [{int(line.split()[0]): float(line.split()[3]) for line in block.splitlines()} for block in blocks if re.match(r" +\d", block)]
    forces, moved = rows
    pull = 0.001
    assert sum(forces.values()) == pytest.approx(2 * force, rel=1e-4)  # Newton's tolerance of the dialect
    places = dict(bottom)
    assert sum(f * places[i - 1000][0] for i, f in forces.items()) == pytest.approx(3.0 * 2 * force, rel=1e-3)
    assert min(forces.values()) > -1.01 * pull
    assert all(moved[i - 1000] < 1e-9 for i, f in forces.items() if f > 1.0)
    assert max(moved.values()) > 1e-4  # the right end has lifted off
