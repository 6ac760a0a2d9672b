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
DIGITS = 1e-5  # of the largest displacement; the default tolerance of the calculix dialect is not asked for

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
    """Physical groups with names, and node sets that gmsh writes when asked to."""
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


def test_prepomax_compression_only(run: Runner, tmp_path: Path) -> None:
    """PrePoMax's "compression only" support: a gap GAPUNI from a ground node to each node of the face, and a plastic law that makes
    CalculiX iterate. A bar of 12 x 1 x 2 elements is pushed down near its left end: some nodes carry, the others lift off.

    The gaps carry the force and its moment about the y axis; none pulls with more than its 0.001, and all that carry touch.
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
    carried, moved = rows
    pull = 0.001
    assert sum(carried.values()) == pytest.approx(2 * force, rel=1e-4)  # Newton's tolerance of the dialect
    places = dict(bottom)
    assert sum(f * places[i - 1000][0] for i, f in carried.items()) == pytest.approx(3.0 * 2 * force, rel=1e-3)
    assert min(carried.values()) > -1.01 * pull
    assert all(moved[i - 1000] < 1e-9 for i, f in carried.items() if f > 1.0)
    assert max(moved.values()) > 1e-4  # the right end has lifted off
