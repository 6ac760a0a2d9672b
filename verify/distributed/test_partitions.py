"""Results in partitions (--partitions): VTK's reader finds in them, bit by bit, the fields of one file; a killed rank; resumption.

The tests on ranks need bin/amontons-mpi (`make MPI=1`) and mpiexec; without them they are skipped. Those on one process run always.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

import amontons
import h5py
import numpy as np
import pytest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataSetAttributes, vtkPartitionedDataSet, vtkUnstructuredGrid
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

from amontons.report.data import read_job
from verify.benchmark.wide_contact import Model, deck_of
from verify.decks import behaviour_decks
from verify.distributed.ranks_and_serial import DIALECT, environment, execute, program, ranks_of, run
from verify.distributed.test_library_on_ranks import on_ranks
from verify.study.gradients_samples import sample

needs_ranks = pytest.mark.skipif(
    not program("amontons-mpi").exists() or shutil.which("mpiexec") is None, reason="there is no amontons-mpi (make MPI=1 builds it), or no mpiexec"
)

CONTACT = ("pair", "node", "facet", "status", "force", "gap")  #: tables of /AMONTONS/contact


@dataclass
class Frame:
    """A time as VTK's reader shows it: the partitions one after the other."""

    time: float
    n_points: list[int]  #: of each partition
    n_cells: list[int]
    points: np.ndarray
    cells: list[np.ndarray]  #: points of each cell, counted through all partitions
    types: np.ndarray
    at_points: dict[str, np.ndarray]
    at_cells: dict[str, np.ndarray]


def partitions_of(reader: vtkHDFReader) -> list[vtkUnstructuredGrid]:
    """What the reader has, as a list of grids."""
    data = reader.GetOutputDataObject(0)
    if isinstance(data, vtkPartitionedDataSet):
        return [data.GetPartition(i) for i in range(data.GetNumberOfPartitions())]
    return [data]


def arrays_of(all_data: list[vtkDataSetAttributes]) -> dict[str, np.ndarray]:
    """The arrays of all partitions, one after the other."""
    names = [all_data[0].GetArrayName(i) for i in range(all_data[0].GetNumberOfArrays())]
    return {name: np.concatenate([vtk_to_numpy(data.GetArray(name)) for data in all_data]) for name in names}


def frames_of(path: Path) -> list[Frame]:
    """All times of a file, by VTK's reader."""
    reader = vtkHDFReader()
    assert reader.CanReadFile(str(path)) == 1
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    frames = []
    for moment in reader.GetOutputInformation(0).Get(Pipeline.TIME_STEPS()) or []:
        reader.UpdateTimeStep(moment)
        grids = partitions_of(reader)
        before, cells = 0, []
        for grid in grids:
            ends = vtk_to_numpy(grid.GetCells().GetOffsetsArray())
            cells += np.split(vtk_to_numpy(grid.GetCells().GetConnectivityArray()) + before, ends[1:-1])
            before += grid.GetNumberOfPoints()
        frames.append(
            Frame(
                time=moment,
                n_points=[grid.GetNumberOfPoints() for grid in grids],
                n_cells=[grid.GetNumberOfCells() for grid in grids],
                points=np.concatenate([vtk_to_numpy(grid.GetPoints().GetData()) for grid in grids]),
                cells=cells,
                types=np.concatenate([vtk_to_numpy(grid.GetCellTypes()) for grid in grids]),
                at_points=arrays_of([grid.GetPointData() for grid in grids]),
                at_cells=arrays_of([grid.GetCellData() for grid in grids]),
            )
        )
    return frames


def labels_of(path: Path, what: str) -> np.ndarray:
    """Labels of nodes or elements in the order of a file."""
    with h5py.File(path) as file:
        return file[f"AMONTONS/mesh/{what}_label"][:]


def rows_in(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Where each label of the other file is in the first one."""
    place = {label: i for i, label in enumerate(one)}
    return np.array([place[label] for label in other])


def expect_same(one: Path, divided: Path, n_partitions: int) -> None:
    """The same times, points, cells and fields in one file and in partitions, bit by bit; each element once, each partition with cells."""
    nodes = rows_in(labels_of(one, "node"), labels_of(divided, "node"))
    elements = rows_in(labels_of(one, "element"), labels_of(divided, "element"))
    n_drawn = frames_of(one)[0].points.shape[0] - labels_of(one, "node").size  # points of analytic surfaces: the last of both
    nodes = np.concatenate([nodes, labels_of(one, "node").size + np.arange(n_drawn)])
    elements = np.concatenate([elements, elements.size + np.arange(frames_of(one)[0].types.size - elements.size)])
    assert sorted(elements) == list(range(elements.size))
    first, second = frames_of(one), frames_of(divided)
    assert [frame.time for frame in first] == [frame.time for frame in second] and len(first) > 1
    for a, b in zip(first, second, strict=True):
        assert len(a.n_points) == 1 and len(b.n_points) == n_partitions and min(b.n_cells) > 0
        assert sum(b.n_cells) == sum(a.n_cells) and sum(b.n_points) == nodes.size > sum(a.n_points) - 1
        assert a.points[nodes].tobytes() == b.points.tobytes()
        assert np.array_equal(a.types[elements], b.types)
        for e, cell in zip(elements, b.cells, strict=True):
            assert np.array_equal(a.cells[e], nodes[cell])
        assert list(a.at_points) == list(b.at_points) and list(a.at_cells) == list(b.at_cells)
        for name, values in a.at_points.items():
            assert values[nodes].tobytes() == b.at_points[name].tobytes(), (name, a.time)
        for name, values in a.at_cells.items():
            assert np.array_equal(values[elements], b.at_cells[name]), (name, a.time)
    assert np.abs(first[-1].at_points["U"]).max() > 0.0


def expect_same_tables(one: Path, divided: Path) -> None:
    """What VTK does not read: histories, contact, integration points, sets and facets, by labels."""
    with h5py.File(one) as a, h5py.File(divided) as b:
        ours, theirs = a["AMONTONS"], b["AMONTONS"]
        nodes, elements = (rows_in(ours[f"mesh/{what}_label"][:], theirs[f"mesh/{what}_label"][:]) for what in ("node", "element"))
        for name, item in ours["history"].items():
            if name != "seconds":
                assert item[:].tobytes() == theirs[f"history/{name}"][:].tobytes(), name
        for name in CONTACT:
            mine, other = ours[f"contact/{name}"][:], theirs[f"contact/{name}"][:]
            assert np.array_equal(mine, nodes[other] if name == "node" else other), name
        facets, others = ours["pairs/facet_nodes"][:], theirs["pairs/facet_nodes"][:]
        assert np.array_equal(facets, np.where(others < 0, -1, nodes[others]))
        assert np.array_equal(ours["pairs/facet_element"][:], elements[theirs["pairs/facet_element"][:]])
        for kind, rows in (("node_sets", nodes), ("element_sets", elements)):
            assert np.array_equal(ours[f"mesh/{kind}/first"][:], theirs[f"mesh/{kind}/first"][:])
            assert np.array_equal(ours[f"mesh/{kind}/members"][:], rows[theirs[f"mesh/{kind}/members"][:]])
        first, second = ours["integration_points/first"][:], theirs["integration_points/first"][:]
        points = np.concatenate([np.arange(first[e], first[e + 1]) for e in elements])
        assert second[-1] == points.size == first[-1]
        n_frames = int(a["VTKHDF/Steps"].attrs["NSteps"])
        for name in ("S", "E", "energy", "PEEQ"):
            mine, other = ours[f"integration_points/{name}"][:], theirs[f"integration_points/{name}"][:]
            assert mine.shape == other.shape
            for k in range(n_frames):
                assert mine[k * points.size + points].tobytes() == other[k * points.size : (k + 1) * points.size].tobytes(), name


DECKS = {
    "plates": lambda: (deck_of(Model(5)), ()),  # two bodies, hard contact with friction, surface to surface
    "quadratic": lambda: (behaviour_decks.cases()["drag-C3D10-s"], (DIALECT,)),
    "mortar": lambda: (behaviour_decks.cases()["drag-C3D15-m"], (DIALECT,)),
    "hard nodes": lambda: (behaviour_decks.cases()["hard-drag-n"], (DIALECT,)),
}


@needs_ranks
@pytest.mark.parametrize("name", DECKS)
@pytest.mark.parametrize("n_ranks", [2, 4])
def test_one_file_and_two_partitions(tmp_path: Path, name: str, n_ranks: int) -> None:
    """Contact on ranks, once with one file and once with two partitions: the same numbers in both."""
    deck, options = DECKS[name]()
    one = run(tmp_path / "one", deck, n_ranks, *options)
    divided = run(tmp_path / "divided", deck, n_ranks, *options, "--partitions", "2")
    assert (one.code, divided.code) == (0, 0), divided.text
    assert sorted(path.name for path in (tmp_path / "divided").glob("*.vtkhdf")) == ["job.partition-0001.vtkhdf", "job.partition-0002.vtkhdf", "job.vtkhdf"]
    expect_same(tmp_path / "one" / "job.vtkhdf", tmp_path / "divided" / "job.vtkhdf", 2)
    expect_same_tables(tmp_path / "one" / "job.vtkhdf", tmp_path / "divided" / "job.vtkhdf")


@pytest.mark.parametrize("n_ranks", [0, pytest.param(2, marks=needs_ranks)])
def test_more_partitions_than_ranks(tmp_path: Path, n_ranks: int) -> None:
    """Five partitions by one process and by two ranks: a rank writes several files. Moved to another folder they still belong together."""
    deck = deck_of(Model(5))
    one = run(tmp_path / "one", deck, n_ranks)
    divided = run(tmp_path / "there", deck, n_ranks, "--partitions=5")
    assert (one.code, divided.code) == (0, 0), divided.text
    (tmp_path / "there").rename(tmp_path / "here")
    expect_same(tmp_path / "one" / "job.vtkhdf", tmp_path / "here" / "job.vtkhdf", 5)


def test_each_partition_alone(tmp_path: Path) -> None:
    """The file of a partition reads alone; together they have each element once."""
    divided = run(tmp_path, deck_of(Model(5)), 0, "--partitions", "3")
    assert divided.code == 0, divided.text
    whole = frames_of(tmp_path / "job.vtkhdf")
    parts = [frames_of(tmp_path / f"job.partition-000{p}.vtkhdf") for p in (1, 2, 3)]
    for k, frame in enumerate(whole):
        assert [part[k].n_points[0] for part in parts] == frame.n_points
        assert np.concatenate([part[k].at_points["S"] for part in parts]).tobytes() == frame.at_points["S"].tobytes()
        assert np.array_equal(np.concatenate([part[k].at_cells["BODY"] for part in parts]), frame.at_cells["BODY"])


@pytest.mark.parametrize("name", ["snap_fit", "shell_bracket", "press_fit"])
def test_samples(tmp_path: Path, name: str) -> None:
    """A tool of lines and arcs, shells with their section forces, bodies of revolution: three partitions show what one file shows."""
    deck = sample(name)
    one, divided = run(tmp_path / "one", deck, 0), run(tmp_path / "divided", deck, 0, "--partitions", "3")
    assert (one.code, divided.code) == (0, 0), divided.text
    expect_same(tmp_path / "one" / "job.vtkhdf", tmp_path / "divided" / "job.vtkhdf", 3)


def test_library(tmp_path: Path) -> None:
    """The library writes what the program writes, divided, and says which numbers are allowed."""
    deck = deck_of(Model(5))
    assert run(tmp_path / "one", deck, 0).code == 0
    with amontons.Job(text=deck, name="job", outdir=tmp_path, partitions=3) as job:
        job.run()
    expect_same(tmp_path / "one" / "job.vtkhdf", tmp_path / "job.vtkhdf", 3)
    with pytest.raises(amontons.UsageError, match="is 10000; it can be 1 to 9999"):
        amontons.Job(text=deck, partitions=10000)


@needs_ranks
def test_library_on_ranks(tmp_path: Path) -> None:
    """A job of Python on a communicator writes a file for each group of ranks: bit by bit the fields of one file."""
    one, folder = run(tmp_path / "one", deck_of(Model(5)), 2), tmp_path / "divided"
    assert one.code == 0, one.text
    folder.mkdir()
    on_ranks(2, "partitions", folder)
    assert sorted(path.name for path in folder.glob("*.vtkhdf")) == ["job.partition-0001.vtkhdf", "job.partition-0002.vtkhdf", "job.vtkhdf"]
    expect_same(tmp_path / "one" / "job.vtkhdf", folder / "job.vtkhdf", 2)


def n_frames_of(path: Path) -> int:
    """How many frames a file shows at the moment, which a job may be writing; 0: it is not there yet."""
    try:
        with h5py.File(path, "r", locking=False) as file:
            return int(file["VTKHDF/Steps"].attrs["NSteps"])
    except (OSError, KeyError):
        return 0


def kill_a_rank(folder: Path, n_ranks: int, n_frames: int, *options: str) -> None:
    """Starts folder/job.inp and kills the last rank, which writes a partition, when the file shows so many frames. (With a checkpoint it shows
    those up to the last one, which is due at the end of a step at the latest.)"""
    with (folder / "output.txt").open("w") as output:
        command = ["mpiexec", "-n", str(n_ranks), program("amontons-mpi"), "--progress=none", "--partitions", "2", *options, "job"]
        process = subprocess.Popen(command, cwd=folder, env=environment(), stdout=output, stderr=output)
        while process.poll() is None and n_frames_of(folder / "job.vtkhdf") < n_frames:
            time.sleep(0.005)
        os.kill(ranks_of(process)[-1], signal.SIGKILL)
        assert process.wait(timeout=60) != 0


@needs_ranks
@pytest.mark.parametrize("options", [(), ("--no-checkpoint",)])
def test_a_killed_rank(tmp_path: Path, options: tuple[str, ...]) -> None:
    """A rank is killed between increments: the increments before are there in both partitions, with the values of the whole job. From the
    checkpoint the job continues on any number of ranks, and its files are those of a job that was never killed."""
    deck = deck_of(Model(5))
    whole = run(tmp_path / "whole", deck, 2, "--partitions", "2")
    assert whole.code == 0, whole.text
    expected = frames_of(tmp_path / "whole" / "job.vtkhdf")
    folder = tmp_path / "job"
    folder.mkdir()
    (folder / "job.inp").write_text(deck)
    kill_a_rank(folder, 2, 3, *options)
    left = frames_of(folder / "job.vtkhdf")
    assert len(expected) > len(left) > 2
    for a, b in zip(expected, left, strict=False):
        assert a.time == b.time
        for name, values in a.at_points.items():
            assert values.tobytes() == b.at_points[name].tobytes(), (name, a.time)
    assert (folder / "job.restart").exists() == (options == ())
    if options:
        return
    refused = execute(folder, 2, "--resume", "--partitions", "3")
    assert refused.code == 2 and "--partitions 2" in refused.text
    shutil.copytree(folder, tmp_path / "serial")
    for n_ranks, where in ((2, folder), (0, tmp_path / "serial")):
        rest = execute(where, n_ranks, "--resume")
        assert rest.code == 0 and "continues after the checkpoint" in rest.text, rest.text
        again = frames_of(where / "job.vtkhdf")
        assert [frame.time for frame in again] == [frame.time for frame in expected]
        for a, b in zip(expected, again, strict=True):
            assert a.n_points == b.n_points
            for name in ("U", "S", "CPRESS", "CSTATUS"):
                near = 1e-9 * max(np.abs(frame.at_points[name]).max() for frame in expected)
                if n_ranks:
                    assert a.at_points[name].tobytes() == b.at_points[name].tobytes(), name
                assert np.abs(a.at_points[name] - b.at_points[name]).max() <= near, name


def test_wrong_numbers(tmp_path: Path) -> None:
    """The option says what is allowed; more partitions than elements are as many as there are elements."""
    (tmp_path / "job.inp").write_text(sample("three_cubes"))
    for word in ("0", "two", "10000", "-1"):
        outcome = execute(tmp_path, 0, f"--partitions={word}")
        assert outcome.code == 2 and "it can be 1 to 9999" in outcome.text
    assert not list(tmp_path.glob("*.vtkhdf"))
    outcome = execute(tmp_path, 0, "--partitions", "50")
    assert outcome.code == 0, outcome.text
    assert [min(frame.n_cells) for frame in frames_of(tmp_path / "job.vtkhdf")][-1] == 1

def test_python_reader(tmp_path: Path) -> None:
    """`amontons.read` and the report see one grid: volumes, surface and fields of the one file, nodes of two partitions joined."""
    deck = deck_of(Model(5))
    one, divided = run(tmp_path / "one", deck, 0), run(tmp_path / "divided", deck, 0, "--partitions", "3")
    assert (one.code, divided.code) == (0, 0), divided.text
    paths = [tmp_path / name / "job.vtkhdf" for name in ("one", "divided")]
    whole, parts = (amontons.read(path) for path in paths)
    rows = rows_in(parts.node_labels, whole.node_labels)
    assert np.array_equal(parts.field("U")[rows], whole.field("U"))
    for nset in whole.node_sets:
        assert np.array_equal(parts.nodes(nset), whole.nodes(nset))
        assert np.array_equal(parts.field("RF", nset=nset), whole.field("RF", nset=nset))
    grids = [whole.grid(), parts.grid()]
    cells = [{tuple(sorted(map(tuple, grid.get_cell(i).points.round(9)))) for i in range(grid.n_cells)} for grid in grids]
    assert cells[0] == cells[1] and grids[0].n_cells == grids[1].n_cells == len(cells[0])
    faces = [{tuple(sorted(job.labels[ring])) for ring in job.skin.rings} for job in map(read_job, paths)]
    assert faces[0] == faces[1] and len(faces[0]) > 0
