"""The result file as others see it: VTK's own reader, pyvista, and h5py on what VTK ignores.

The file is that of the unit test program test_results: two elements of each solid kind, and fields that are simple functions
of the frame number f: u = f X, stress f (1 to 6), strain a tenth of it (`sample_job.inc`).

SPDX-License-Identifier: GPL-3.0-or-later
"""

import os
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
import pyvista
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

from verify.conftest import Run

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = ROOT / os.environ.get("AMONTONS_UNITS", "build/unit") / "test_results"

WIDTHS = {
    "U": 3, "RF": 3, "S": 6, "LE": 6, "S_mises": 1, "CPRESS": 1, "CSHEAR": 3, "COPEN": 1, "CSLIP": 3, "CNORMF": 3,
    "CSHEARF": 3, "PEEQ": 1, "NT": 1, "CSTATUS": 1, "CSCENARIO": 1,
}  # fmt: skip
TIMES = [0.0, 0.5, 1.0]
#: VTK cell type, nodes and volume of the parent element of each kind, in the order of element_kinds.f90: the solids
KINDS = [
    (10, 4, 1 / 6), (13, 6, 1.0), (12, 8, 8.0), (12, 8, 8.0), (24, 10, 1 / 6), (25, 20, 8.0), (25, 20, 8.0), (12, 8, 8.0),
    (12, 8, 8.0), (26, 15, 1.0), (12, 8, 8.0), (13, 6, 1.0), *5 * [(25, 20, 8.0)], (26, 15, 1.0),
]  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which test_results has left its files."""
    if not PROGRAM.exists():
        pytest.fail(f"{PROGRAM} is not there; `make unit` builds it.")
    path = tmp_path_factory.mktemp("vtkhdf")
    done = subprocess.run([PROGRAM], cwd=path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout
    assert done.stderr == "", "HDF5 must not print its own errors"
    return path


def open_reader(path: Path) -> vtkHDFReader:
    """VTK's reader after it has looked at the file."""
    reader = vtkHDFReader()
    assert reader.CanReadFile(str(path)) == 1
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    return reader


def grid_at(reader: vtkHDFReader, time: float) -> vtkUnstructuredGrid:
    """The grid that ParaView would show at a time."""
    reader.UpdateTimeStep(time)
    grid = reader.GetOutputDataObject(0)
    assert isinstance(grid, vtkUnstructuredGrid), "one part per step must come out as an unstructured grid"
    return grid


def times_of(reader: vtkHDFReader) -> list[float]:
    """The time values that the reader offers."""
    return list(reader.GetOutputInformation(0).Get(Pipeline.TIME_STEPS()) or [])


def array(grid: vtkUnstructuredGrid, name: str) -> np.ndarray:
    """A point array."""
    return vtk_to_numpy(grid.GetPointData().GetArray(name))


def test_reader_sees_all_frames(folder: Path) -> None:
    """Three frames with their times; every array is there, complete and finite, in each."""
    reader = open_reader(folder / "job.vtkhdf")
    assert times_of(reader) == TIMES
    for time in TIMES:
        grid = grid_at(reader, time)
        data = grid.GetPointData()
        assert {data.GetArrayName(i) for i in range(data.GetNumberOfArrays())} == set(WIDTHS)
        for name, width in WIDTHS.items():
            values = array(grid, name).reshape(grid.GetNumberOfPoints(), -1)
            assert values.shape[1] == width, name
            assert np.isfinite(values).all(), name


@pytest.mark.parametrize("frame", [0, 1, 2])
def test_values_per_frame(folder: Path, frame: int) -> None:
    """Each frame shows its own values, not those of the first: u = f X; constant stress comes to the nodes unchanged."""
    grid = grid_at(open_reader(folder / "job.vtkhdf"), TIMES[frame])
    points = vtk_to_numpy(grid.GetPoints().GetData())
    stress = frame * np.arange(1.0, 7.0)
    np.testing.assert_allclose(array(grid, "U"), frame * points, atol=1e-14)
    np.testing.assert_allclose(array(grid, "RF"), 2.0 * frame)
    np.testing.assert_allclose(array(grid, "S"), np.tile(stress, (len(points), 1)), atol=1e-12)
    np.testing.assert_allclose(array(grid, "LE"), np.tile(0.1 * stress, (len(points), 1)), atol=1e-13)
    mises = frame * np.sqrt(0.5 * (1 + 1 + 4) + 3 * (16 + 25 + 36))  # of (1 2 3 4 5 6)
    np.testing.assert_allclose(array(grid, "S_mises"), mises, rtol=1e-13)


def test_contact_arrays(folder: Path) -> None:
    """What slave nodes show; the node that is slave twice shows the pair in which it touches; zero elsewhere."""
    grid = grid_at(open_reader(folder / "job.vtkhdf"), TIMES[2])
    points = vtk_to_numpy(grid.GetPoints().GetData())
    far = np.linalg.norm(np.ptp(points, axis=0))
    np.testing.assert_array_equal(array(grid, "CSTATUS")[:6], [2, 1, 0, 0, -1, -1])
    np.testing.assert_array_equal(array(grid, "CSCENARIO")[:5], [3, 0, 0, 1, 0])
    np.testing.assert_allclose(array(grid, "CPRESS")[:5], [10.0, 4.0, 0, 0, 0])
    np.testing.assert_allclose(array(grid, "COPEN")[:5], [0, 0, 0.25, far, 0])
    np.testing.assert_allclose(array(grid, "CSHEAR")[:2], [[-3, 0, 0], [0, 1, 0]])
    np.testing.assert_allclose(array(grid, "CNORMF")[:2], [[0, 0, 20], [0, 0, 8]])
    np.testing.assert_allclose(array(grid, "CSHEARF")[:2], [[-6, 0, 0], [0, 2, 0]])
    np.testing.assert_allclose(array(grid, "CSLIP")[:2], [[0.02, 0, 0], [0, 0, 0]])
    assert (array(grid, "CSTATUS")[4:] == -1).all(), "no slaves"
    for name in (name for name in WIDTHS if name.startswith("C") and name != "CSTATUS"):
        assert not array(grid, name)[5:].any(), name


TWO_BODIES = """*NODE, NSET=NALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
9, 2., 0., 0.
10, 2., 1., 0.
11, 2., 0., 1.
12, 2., 1., 1.
21, 0., 0., 1.
22, 1., 0., 1.
23, 1., 1., 1.
24, 0., 1., 1.
25, 0., 0., 2.
26, 1., 0., 2.
27, 1., 1., 2.
28, 0., 1., 2.
90, 0.5, 0.5, 5.
*ELEMENT, TYPE=C3D8, ELSET=UPPER
70, 21, 22, 23, 24, 25, 26, 27, 28
*ELEMENT, TYPE=C3D8, ELSET=LOWER
31, 1, 2, 3, 4, 5, 6, 7, 8
32, 2, 9, 10, 3, 6, 11, 12, 7
*ELSET, ELSET=LEFT
31, 70
*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*MATERIAL, NAME=POM
*ELASTIC
2500., 0.3
*SOLID SECTION, ELSET=LOWER, MATERIAL=STEEL
*SOLID SECTION, ELSET=UPPER, MATERIAL=POM
*SURFACE, NAME=SOLE
UPPER, S1
*SURFACE, NAME=TABLE
LOWER, S2
*SURFACE, TYPE=REVOLUTION, NAME=BALL
0.5, 0.5, 5., 0.5, 0.5, 6.
START, 0., -2.
CIRCL, 2., 0., 0., 0.
*RIGID BODY, ANALYTICAL SURFACE=BALL, REF NODE=90
*SURFACE INTERACTION, NAME=I
*CONTACT PAIR, INTERACTION=I
SOLE, TABLE
*STEP
*STATIC
0.5, 1., , 0.5
*BOUNDARY
90, 1, 6
1, 1, 3
2, 1, 3
3, 1, 3
4, 1, 3
9, 1, 3
10, 1, 3
25, 1, 2
26, 1, 2
27, 1, 2
28, 1, 2
25, 3, 3, -0.01
26, 3, 3, -0.01
27, 3, 3, -0.01
28, 3, 3, -0.01
*END STEP
"""


def test_cell_arrays(run_deck: Run, tmp_path: Path) -> None:
    """Body, material, label and sets of each cell, the same in each frame; a threshold of a set is its elements; cells of tools have 0."""
    assert run_deck(TWO_BODIES, "--quiet").returncode == 0
    reader = open_reader(tmp_path / "job.vtkhdf")
    times = times_of(reader)
    assert len(times) == 3
    labels = [70, 31, 32]
    for time in times:
        grid = pyvista.wrap(grid_at(reader, time))
        tools = grid.n_cells - 3
        assert tools > 100
        expected = {"BODY": [1, 2, 2], "MATERIAL": [2, 1, 1], "SECTION": [2, 1, 1], "ELEMENT": labels,
                    "ELSET UPPER": [1, 0, 0], "ELSET LOWER": [0, 1, 1], "ELSET LEFT": [1, 1, 0]}  # fmt: skip
        assert set(grid.cell_data) == set(expected)
        for name, values in expected.items():
            np.testing.assert_array_equal(grid.cell_data[name], values + [0] * tools, err_msg=name)
        for name, members in (("ELSET LEFT", [70, 31]), ("ELSET LOWER", [31, 32])):
            assert grid.threshold(0.5, scalars=name).cell_data["ELEMENT"].tolist() == members
        status = grid.point_data["CSTATUS"]
        slaves = np.flatnonzero(status >= 0)
        assert slaves.tolist() == [12, 13, 14, 15], "nodes 21 to 24"
    assert (status[slaves] > 0).all()


def test_cells(folder: Path) -> None:
    """Two cells of each kind, with VTK's type and the volume of the parent element: the node order is VTK's."""
    grid = pyvista.wrap(grid_at(open_reader(folder / "job.vtkhdf"), 0.0))
    assert grid.n_cells == 2 * len(KINDS)
    volumes = grid.compute_cell_sizes(length=False, area=False)["Volume"]
    for cell in range(grid.n_cells):
        vtk_type, n_nodes, volume = KINDS[cell // 2]
        assert grid.celltypes[cell] == vtk_type
        assert grid.get_cell(cell).n_points == n_nodes
        assert volumes[cell] == pytest.approx(volume, rel=1e-6), f"cell {cell}"


@pytest.mark.parametrize(("name", "times"), [("after_0", TIMES[:1]), ("after_1", TIMES[:2])])
def test_file_of_running_job(folder: Path, name: str, times: list[float]) -> None:
    """The file as it was on disk after each increment, not yet closed, opens and shows the frames so far."""
    reader = open_reader(folder / f"{name}.vtkhdf")
    assert times_of(reader) in (times, [])  # VTK returns no times if there is only one
    grid = grid_at(reader, times[-1])
    points = vtk_to_numpy(grid.GetPoints().GetData())
    np.testing.assert_allclose(array(grid, "U"), (len(times) - 1) * points, atol=1e-14)


def test_two_files_of_one_process(folder: Path) -> None:
    """Files written in turn hold their own frames."""
    for name, frames in (("a", [0]), ("b", [3, 4])):
        with h5py.File(folder / f"{name}.vtkhdf") as file:
            points, u = file["VTKHDF/Points"][:], file["VTKHDF/PointData/U"][:]
            np.testing.assert_allclose(u, np.concatenate([f * points for f in frames]))


def test_frames_before_an_error_stay(folder: Path) -> None:
    """A refused increment leaves a file that opens and shows the frames before it."""
    with h5py.File(folder / "refused.vtkhdf") as file:
        assert file["VTKHDF/Steps"].attrs["NSteps"] == 1
        assert len(file["VTKHDF/PointData/U"]) == file["VTKHDF/NumberOfPoints"][0]
        assert file["AMONTONS/history/frame"][:].tolist() == [0]


def test_pyvista(folder: Path) -> None:
    """The recipe of the manual: a reader, a step number, a grid."""
    reader = pyvista.get_reader(folder / "job.vtkhdf")
    for step in range(3):
        reader.reader.SetStep(step)
        reader.reader.Modified()
        grid = reader.read()
        np.testing.assert_allclose(grid["U"], step * grid.points, atol=1e-14)


def test_layout_of_vtkhdf(folder: Path) -> None:
    """What readers from VTK 9.3 to 9.7 need, trap by trap."""
    with h5py.File(folder / "job.vtkhdf") as file:
        grid = file["VTKHDF"]
        kind = grid.attrs.get_id("Type").get_type()
        assert grid.attrs["Type"] == b"UnstructuredGrid"
        assert (kind.get_size(), kind.get_cset(), kind.is_variable_str()) == (16, h5py.h5t.CSET_ASCII, False)
        assert grid["Types"].dtype == np.uint8
        steps = grid["Steps"]
        assert steps["NumberOfParts"][:].tolist() == [1, 1, 1]
        for name in ("PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"):
            assert steps[name][:].ravel().tolist() == [0, 0, 0], name
        n = int(grid["NumberOfPoints"][0])
        assert set(steps["PointDataOffsets"]) == set(grid["PointData"]) == set(WIDTHS)
        for name in WIDTHS:
            assert steps["PointDataOffsets"][name][:].tolist() == [0, n, 2 * n], name
            assert len(grid["PointData"][name]) == 3 * n, name


def data_sets(group: h5py.Group) -> list[h5py.Dataset]:
    """All data sets below a group."""
    found: list[h5py.Dataset] = []
    group.visititems(lambda _, item: found.append(item) if isinstance(item, h5py.Dataset) else None)
    return found


def test_every_data_set_is_labelled(folder: Path) -> None:
    """Each data set says its unit and, in a sentence, what it is; each number is finite."""
    with h5py.File(folder / "job.vtkhdf") as file:
        for item in data_sets(file):
            assert item.attrs["unit"].startswith(b"["), item.name
            assert item.attrs["unit"].endswith(b"]"), item.name
            assert item.attrs["description"].endswith(b"."), item.name
            if item.dtype.kind == "f":
                assert np.isfinite(item[()]).all(), item.name


def test_history(folder: Path) -> None:
    """A row per attempt; NaN of a failed attempt becomes 1e30; `frame` leads to the fields."""
    with h5py.File(folder / "job.vtkhdf") as file:
        history = file["AMONTONS/history"]
        assert {len(history[name]) for name in history} == {5}
        assert history["step"][:].tolist() == [1, 1, 2, 2, 2]
        assert history["attempt"][:].tolist() == [1, 1, 1, 2, 1]
        assert history["is_converged"][:].tolist() == [1, 1, 0, 1, 1]
        assert history["frame"][:].tolist() == [0, 1, -1, -1, 2]
        assert history["residual"][:].tolist() == [1e-7, 1e-7, 1e30, 1e-7, 1e-7]
        assert history["n_scenario"][2].tolist() == [1, 2, 3, 4]
        assert history["applied_force"][4].tolist() == [1, 2, 3]
        assert history["reason"][:].tolist() == [b"", b"", b"residual is not a number", b"", b""]
        assert history["seconds"].shape[1] == len(file["AMONTONS/phases"])
        iterations = file["AMONTONS/iterations"]
        assert iterations["iteration"][:].tolist() == [1, 2, 3]
        assert iterations["n_scenario"][:].tolist() == [[1, 0, 0, 1], [2, 0, 0, 1], [3, 0, 0, 1]]
        np.testing.assert_allclose(iterations["residual"][:], [0.1, 0.01, 0.001])


def test_model_beside_the_grid(folder: Path) -> None:
    """Deck, controls, labels, sets, materials, pairs."""
    with h5py.File(folder / "job.vtkhdf") as file:
        ours = file["AMONTONS"]
        assert ours["deck"][()].decode() == "*HEADING\nA job of the unit tests."
        assert ours["dialect"][()] == b"abaqus"
        assert ours["controls/i_c"][:].tolist() == [24, 33]
        assert ours["steps/is_nlgeom"][:].tolist() == [0, 1]
        assert ours["steps/title"][:].tolist() == [b"", b"the second"]
        assert ours["mesh/node_label"][:3].tolist() == [10, 20, 30]
        assert ours["mesh/element_label"][:2].tolist() == [101, 102]
        names = b"C3D4 C3D6 C3D8 C3D8 C3D10 C3D20 C3D20R C3D8I C3D8R C3D15 CSS8 CSS6 rectBeam pipeBeam boxBeam circBeam kronBeam layWedge".split()
        assert ours["mesh/element_kind"][:].tolist() == [name for name in names for _ in range(2)]
        sets = ours["mesh/node_sets"]
        assert sets["name"][:].tolist() == [b"Corner", b"Empty"]
        assert sets["first"][:].tolist() == [0, 2, 2]
        assert sets["members"][:].tolist() == [8, 4]
        assert ours["materials/name"][:].tolist() == [b"steel"]
        assert ours["materials/youngs_modulus"][:].tolist() == [210000.0]
        pairs = ours["pairs"]
        assert pairs["master"][:].tolist() == [b"Bricks", b"Tets"]
        assert pairs["friction"][:].tolist() == [0.3, 0.3]
        assert pairs["first"][:].tolist() == [0, 2, 3]
        assert pairs["facet_face"][:].tolist() == [2, 1, 3]


def test_master_facets_face_outward(folder: Path) -> None:
    """The corners of a facet, by the right-hand rule, give a normal that points away from its element."""
    with h5py.File(folder / "job.vtkhdf") as file:
        pairs, grid = file["AMONTONS/pairs"], file["VTKHDF"]
        points, offsets, nodes = grid["Points"][:], grid["Offsets"][:], grid["Connectivity"][:]
        for facet, element in zip(pairs["facet_nodes"][:], pairs["facet_element"][:], strict=True):
            own = nodes[offsets[element] : offsets[element + 1]]
            facet = facet[facet >= 0]
            assert set(facet) <= set(own)
            a, b, c = points[facet[:3]]
            assert np.cross(b - a, c - a) @ (a - points[own].mean(axis=0)) > 0


def test_points_and_slaves_per_frame(folder: Path) -> None:
    """Rows of integration points and slave nodes, frame by frame."""
    with h5py.File(folder / "job.vtkhdf") as file:
        points, contact = file["AMONTONS/integration_points"], file["AMONTONS/contact"]
        n = points["first"][-1]
        for frame in range(3):
            rows = slice(frame * n, (frame + 1) * n)
            np.testing.assert_allclose(points["S"][rows], np.tile(frame * np.arange(1.0, 7.0), (n, 1)))
            np.testing.assert_allclose(points["E"][rows], 0.1 * points["S"][rows])
            np.testing.assert_allclose(points["energy"][rows], frame)
            np.testing.assert_allclose(contact["force"][5 * frame], [0, 0, 10 * frame])
        assert contact["node"][:].tolist() == [0, 1, 2, 3, 0]
        assert contact["pair"][:].tolist() == [0, 0, 0, 0, 1]
        assert contact["facet"][-5:].tolist() == [1, 0, 0, -1, 0]
        assert contact["gap"][-5:].tolist() == [0, 0, 0.25, 0, -0.5]


LAWS = {
    "A": ("*ELASTIC\n1000., 0.3\n*PLASTIC\n5., 0.\n", "Hencky, plastic"),
    "B": ("*ELASTIC, TYPE=ENGINEERING CONSTANTS\n1000., 900., 800., 0.3, 0.3, 0.3, 400., 400.\n400.\n", "Hencky, orthotropic"),
    "C": ("*HYPERELASTIC, NEO HOOKE\n0.5, 0.02\n", "hyperelastic, polynomial"),
    "D": ("*HYPERELASTIC, OGDEN, N=1\n0.8, 1.8, 0.02\n", "hyperelastic, Ogden"),
    "E": ("*HYPERELASTIC, ARRUDA-BOYCE\n1., 2.8, 0.02\n", "hyperelastic, Arruda-Boyce"),
    "F": ("*HYPERFOAM, N=1\n0.6, 4., 0.2\n", "hyperfoam"),
    "G": ("*ELASTIC\n1000., 0.3\n*CREEP\n1e-9, 2., 0.\n", "Hencky, creep"),
    "H": ("*DEFORMATION PLASTICITY\n1000., 0.3, 10., 5., 0.3\n", "Ramberg-Osgood"),
}


def test_laws_have_their_names(run_deck: Run, tmp_path: Path) -> None:
    """What materials/law says of each kind of material."""
    deck = ""
    for k, (name, (cards, _)) in enumerate(LAWS.items()):
        place = [(x + 3 * k, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        deck += "*NODE\n" + "".join(f"{8 * k + i}, {x}, {y}, {z}\n" for i, (x, y, z) in enumerate(place, start=1))
        deck += f"*ELEMENT, TYPE=C3D8, ELSET={name}\n{k + 1}, " + ", ".join(str(8 * k + i) for i in range(1, 9)) + "\n"
        deck += f"*MATERIAL, NAME={name}\n{cards}*SOLID SECTION, ELSET={name}, MATERIAL={name}\n"
    held = "".join(f"{8 * k + i}, 1, 3\n" for k in range(len(LAWS)) for i in range(1, 5))
    done = run_deck(deck + f"*STEP, NLGEOM\n*STATIC\n*BOUNDARY\n{held}*END STEP\n", "--quiet")
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        laws = file["AMONTONS/materials/law"][:]
    assert [law.decode() for law in laws] == [name for _, name in LAWS.values()]
