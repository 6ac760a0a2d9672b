"""FreeCAD (tried with 0.20.2 of Debian 12) runs Amontons in place of ccx: it writes the deck, starts the program, reads the results.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import amontons
from verify.conftest import ROOT

HERE = Path(__file__).resolve().parent
FREECAD = shutil.which("freecadcmd") or shutil.which("FreeCADCmd")
pytestmark = pytest.mark.skipif(FREECAD is None or shutil.which("gmsh") is None, reason="FreeCAD and Gmsh are not installed (apt-get install freecad gmsh)")


@pytest.fixture(scope="module")
def command(program: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """amontons-ccx beside the program, as `make install` puts it."""
    folder = tmp_path_factory.mktemp("bin")
    shutil.copy(program, folder)
    return Path(shutil.copy(ROOT / "share" / "amontons-ccx", folder))


@pytest.fixture(scope="module")
def folder(command: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What FreeCAD's run leaves."""
    folder = tmp_path_factory.mktemp("freecad")
    own = os.environ | {"HOME": str(folder), "JOB_FOLDER": str(folder), "JOB_PROGRAM": str(command), "OMP_NUM_THREADS": "1"}
    own = {name: value for name, value in own.items() if name not in ("PYTHONPATH", "LD_LIBRARY_PATH", "VIRTUAL_ENV")}
    done = subprocess.run([str(FREECAD), str(HERE / "freecad_job.py")], cwd=folder, env=own, stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, timeout=300, check=False)  # fmt: skip
    assert (folder / "report.json").exists(), done.stdout[-3000:] + done.stderr[-3000:]
    return folder


def forces(text: str) -> np.ndarray:
    """Total forces of a .dat file, one row for each set."""
    return np.array([line.split() for line in re.findall(r"total force.*\n\n(.*)\n", text)], float)


def test_freecad_reads_our_results(folder: Path) -> None:
    """No complaint; the displacements and stresses in FreeCAD are those of the result file, to the digits of the .frd file."""
    report = json.loads((folder / "report.json").read_text())
    assert (report["missing"], report["code"], report["stderr"]) == ("", 0, "")
    results = amontons.read(Path(report["deck"]).with_suffix(""))
    row = {label: i for i, label in enumerate(results.node_labels)}
    rows = [row[label] for label in report["nodes"]]
    assert len(rows) == len(set(rows)) > 500
    u, mises = results.field("U")[rows], results.field("S_mises")[rows]
    assert np.abs(np.array(report["U"]) - u).max() < 1e-5 * np.abs(u).max()
    assert np.abs(np.array(report["mises"]) - mises).max() < 1e-4 * mises.max()
    assert u[:, 2].min() == pytest.approx(-0.03, rel=1e-6)


def test_the_block_presses(folder: Path) -> None:
    """The plate carries what the block is pressed with, and the force lies below that of a plate and a block of full section in series.

    Bound: the block of A = 400 and h = 15 alone, shortened by 0.02, takes E (1 - nu) / ((1 + nu) (1 - 2 nu)) A 0.02 / 15 if it cannot
    widen; its half widening freely under half the displacement is a lower one, E A 0.01 / 15."""
    fixed, pressed = forces((folder / "Mesh.dat").read_text())
    assert fixed + pressed == pytest.approx(0, abs=1e-5 * abs(pressed[2]))
    E, nu, area = 210e3, 0.3, 400.0
    assert E * area * 0.01 / 15 < -pressed[2] < E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) * area * 0.02 / 15


@pytest.mark.skipif(shutil.which("ccx") is None, reason="ccx is not installed")
def test_ccx_agrees(folder: Path, tmp_path: Path) -> None:
    """CalculiX takes the same deck to the same forces."""
    shutil.copy(folder / "Mesh.inp", tmp_path)
    subprocess.run(["ccx", "-i", "Mesh"], cwd=tmp_path, capture_output=True, check=True, timeout=300)
    ours, theirs = (forces((one / "Mesh.dat").read_text()) for one in (folder, tmp_path))
    assert np.abs(ours - theirs).max() < 1e-5 * np.abs(theirs).max()
