"""Results in Python: tables, grids and fields of a result file against the file itself and VTK's reader; the example notebook.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

import amontons
from verify.conftest import ROOT
from verify.library.common import block, cubes  # noqa: F401

NOTEBOOK = ROOT / "doc" / "manual" / "block.ipynb"


@pytest.fixture(scope="module")
def results(block: Path, tmp_path_factory: pytest.TempPathFactory) -> amontons.Results:  # noqa: F811
    """Those of the shear block."""
    folder = tmp_path_factory.mktemp("results")
    with amontons.Job(block, outdir=folder, files=True) as job:
        job.run()
    return amontons.read(folder / "block")


def test_increments_one_by_one(cubes: Path) -> None:  # noqa: F811
    """The loop goes through the 20 increments of the deck; numbers and times are those of the program's own records."""
    job = amontons.Job(cubes)
    assert repr(job) == "<Job three_cubes: step 0, 0 increments, time 0, not done>"
    done = list(job)
    assert [one.number for one in done] == list(range(1, 21))
    assert [one.step for one in done] == 10 * [1] + 10 * [2]
    assert np.allclose([one.time for one in done], np.arange(1, 21) / 10, rtol=1e-12)
    assert np.allclose([one.dt for one in done], 0.1, rtol=1e-9)
    assert sum(one.iterations for one in done) == job.number("ITERATIONS")
    assert repr(job) == "<Job three_cubes: step 2, 20 increments, time 2, done>"
    assert list(job) == []
    job.close()
    assert repr(job) == "<Job three_cubes: closed>"


def test_pair_sums_of_a_job(cubes: Path) -> None:  # noqa: F811
    """The sole slides: T = 0.3 N (Coulomb), N is the reaction of the floor, and the forces are the sums of those at the nodes."""
    with amontons.Job(cubes) as job:
        job.run()
        assert job.names("PAIRS") == ["CUBE_SOLE / TABLE_TOP"]
        normal, friction = job.get("CFN"), job.get("cfs", "cube_sole/table_top")
        assert normal.shape == friction.shape == (1, 3)
        assert np.allclose(normal[0], job.get("CNORMF").sum(axis=0), rtol=1e-12, atol=1e-12)
        assert np.allclose(friction[0], job.get("CSHEARF", "CUBE_SOLE").sum(axis=0), rtol=1e-12, atol=1e-12)
        assert abs(np.linalg.norm(friction) / np.linalg.norm(normal) - 0.3) < 1e-6
        assert job.number("CAREA") == pytest.approx(0.64, rel=1e-6)   # the sole of 0.8 by 0.8


@pytest.mark.parametrize(
    ("quantity", "where", "words"),
    [("S_MISE", "", "did you mean S_mises?"), ("U", "TABLE_TOPP", "did you mean TABLE_TOP?"), ("CFNN", "", "did you mean CFN?"),
     ("CFN", "CUBE_SOL", "there is only CUBE_SOLE/TABLE_TOP"), ("POINT S", "CUBES", "did you mean CUBE?")],
)  # fmt: skip
def test_nearest_names_are_reported(cubes: Path, quantity: str, where: str, words: str) -> None:  # noqa: F811
    """A slip of the pen is answered by the name that was meant."""
    with amontons.Job(cubes) as job, pytest.raises(amontons.UsageError) as error:
        job.get(quantity, where)
    assert words in str(error.value)


def test_a_slave_of_two_pairs_needs_both_names() -> None:
    """A surface that is the slave of two pairs does not choose one of them."""
    deck = (ROOT / "input" / "three_cubes.inp").read_text()
    mesh = (ROOT / "input" / "three_cubes.mesh").read_text()
    text = deck.replace("*INCLUDE, INPUT=three_cubes.mesh", mesh)
    card = next(line for line in text.splitlines() if line.upper().startswith("*CONTACT PAIR"))
    names = text[text.index(card) :].splitlines()[1]
    second = "*SURFACE, NAME=OTHER_TOP\nTABLE, S2\n"
    text = text.replace(card, f"{second}{card}\n{names.split(',')[0]}, OTHER_TOP\n{card}", 1)
    with amontons.Job(text=text, check=True) as job:
        assert len(job.names("PAIRS")) == 2
        assert job.get("CFN").shape == (2, 3)
        assert job.get("CFN", job.names("PAIRS")[1]).shape == (1, 3)
        with pytest.raises(amontons.UsageError, match="slave of several"):
            job.get("CFN", names.split(",")[0].strip())


def test_repr_and_names(results: amontons.Results) -> None:
    """What is in the file, in one line; sets and fields by name."""
    with h5py.File(results.path) as file:
        n_nodes, n_elements = len(file["AMONTONS/mesh/node_label"]), len(file["AMONTONS/mesh/element_label"])
        names = {name.decode().strip() for name in file["AMONTONS/mesh/node_sets/name"][:]}
    assert repr(results) == (f"<Results block.vtkhdf: {len(results.times)} frames to time {results.times[-1]:g}, {n_nodes} nodes, "
                             f"{n_elements} elements, 1 contact pairs>")  # fmt: skip
    assert set(results.node_sets) == names
    assert {"U", "S_mises", "CPRESS"} <= set(results.fields)
    assert results.fields["CPRESS"] == "[stress]"


def test_tables(results: amontons.Results) -> None:
    """History and pairs are those of the file, column by column; magnitudes are those of the vectors."""
    pytest.importorskip("pandas")
    history, pairs = results.history, results.pairs
    with h5py.File(results.path) as file:
        ours = file["AMONTONS"]
        assert np.array_equal(history["total_time"], ours["history/total_time"][:])
        assert np.array_equal(history[["reaction_force1", "reaction_force2", "reaction_force3"]], ours["history/reaction_force"][:])
        assert np.array_equal(history[["n_open", "n_stick", "n_slip"]], ours["history/n_status"][:])
        assert np.array_equal(pairs[["CFN1", "CFN2", "CFN3"]], ours["pair_history/CFN"][:])
        mu = ours["pairs/friction"][0]
        assert np.allclose(pairs["CFSM"], np.linalg.norm(ours["pair_history/CFS"][:], axis=1), rtol=1e-14)
    assert set(pairs["pair"]) == set(results.pair_names)
    assert pairs.attrs["units"]["CFNM"] == "[force]"
    assert "friction" in pairs.attrs["descriptions"]["CFSM"].lower()
    assert pairs.attrs["descriptions"]["CFNM"].startswith("Magnitude")
    assert pairs.attrs["descriptions"]["pair"] == "Slave / master."
    assert (pairs["CFSM"] <= mu * pairs["CFNM"] * (1 + 1e-6)).all()
    assert pairs["CFSM"].iloc[-1] > 0.9 * mu * pairs["CFNM"].iloc[-1] > 0
    assert len(results.iterations) == history["n_iterations"].sum()


def test_tables_without_pandas(results: amontons.Results, monkeypatch: pytest.MonkeyPatch) -> None:
    """The message says what to install."""
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match=r"pip install pandas"):
        results._table("steps")


def test_grid_is_that_of_vtk(results: amontons.Results) -> None:
    """Points, cells and fields of each frame are those that VTK's reader makes of the file."""
    pyvista = pytest.importorskip("pyvista")
    reader = pyvista.get_reader(results.path)
    for k in (0, len(results.times) // 2, len(results.times) - 1):
        reader.reader.SetStep(k)
        reader.reader.Modified()
        theirs, ours = reader.read(), results.grid(results.times[k])
        assert ours.field_data["TIME"][0] == results.times[k]
        assert np.array_equal(ours.points, theirs.points)
        assert np.array_equal(ours.cells, theirs.cells)
        assert np.array_equal(ours.celltypes, theirs.celltypes)
        for name in results.fields:
            assert np.array_equal(ours.point_data[name], theirs.point_data[name]), name
        assert np.array_equal(ours.cell_data["BODY"], theirs.cell_data["BODY"])


def test_grid_of_sets(results: amontons.Results) -> None:
    """Each set has its elements, whatever the case of the letters; two sets have both; nodes keep their labels."""
    pytest.importorskip("pyvista")
    with h5py.File(results.path) as file:
        cells = {name[6:]: values[:] for name, values in file["VTKHDF/CellData"].items() if name.startswith("ELSET ")}
    for name, is_in in cells.items():
        assert results.grid(elset=name.lower()).n_cells == is_in.sum()
    one, other = list(cells)[:2]
    both = results.grid(elset=[one, other])
    assert both.n_cells == np.sum((cells[one] + cells[other]) > 0)
    place = {label: x for label, x in zip(results.node_labels, results.points, strict=True)}
    assert all(np.array_equal(place[label], x) for label, x in zip(both["NODE"], both.points, strict=True))


def test_fields(results: amontons.Results) -> None:
    """A field of a set has the rows of its nodes; times between frames take the nearest, times beyond are refused."""
    name = results.node_sets[0]
    everywhere = dict(zip(results.node_labels, results.field("U"), strict=True))
    assert np.array_equal(results.field("U", nset=name.lower()), [everywhere[label] for label in results.nodes(name)])
    assert results.field("CPRESS").shape == (len(results.node_labels),)
    middle = 0.4 * results.times[3] + 0.6 * results.times[4]
    assert np.array_equal(results.field("u", middle), results.field("U", results.times[4]))
    with pytest.raises(amontons.UsageError, match="the frames go from"):
        results.field("U", 1.01 * results.times[-1])


def test_names_that_are_not_there(results: amontons.Results, tmp_path: Path) -> None:
    """The nearest name is reported; a file of another program is refused."""
    with pytest.raises(amontons.UsageError, match=r"no field named S_MISE; did you mean S_mises\?"):
        results.field("S_MISE")
    with pytest.raises(amontons.UsageError, match="no node set named QQQ; there are "):
        results.nodes("QQQ")
    with pytest.raises(amontons.FileError, match="there is no such file"):
        amontons.read(tmp_path / "nothing")
    (tmp_path / "text.vtkhdf").write_text("nothing")
    with pytest.raises(amontons.FileError):
        amontons.read(tmp_path / "text.vtkhdf")
    with h5py.File(tmp_path / "other.vtkhdf", "w") as file:
        file.create_group("VTKHDF")
    with pytest.raises(amontons.FileError, match="not a result file"):
        amontons.read(tmp_path / "other.vtkhdf")


@pytest.mark.slow
def test_notebook(tmp_path: Path, library: Path) -> None:
    """The example runs cell by cell, and its curves are right: T reaches mu N, pressures are largest at the edges."""
    for package in ("pandas", "matplotlib", "pyvista"):
        pytest.importorskip(package)
    cells = ["".join(cell["source"]) for cell in json.loads(NOTEBOOK.read_text())["cells"] if cell["cell_type"] == "code"]
    proof = """
last = pairs.iloc[-1]
assert abs(last["CFSM"] - 0.3 * last["CFNM"]) < 1e-6 * last["CFNM"] and last["n_stick"] == 0, last
pressure = at["CPRESS"][sole][order]
assert pressure.argmax() in (0, 1, len(pressure) - 2, len(pressure) - 1), pressure
assert abs(results.field("U", nset="BLOCK_TOP")[:, 0] - 0.01).max() < 1e-12
"""
    (tmp_path / "cells.py").write_text("\n".join([*cells, proof]))
    environment = os.environ | {"MPLBACKEND": "Agg", "PYVISTA_OFF_SCREEN": "true", "AMONTONS_LIBRARY": str(library),
                                "PYTHONPATH": str(ROOT / "python")}  # fmt: skip
    done = subprocess.run([sys.executable, "cells.py"], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "iterations" in done.stdout
