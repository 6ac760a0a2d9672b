"""Submodels beside CalculiX: the same global .frd file, in text and binary, drives the same submodel in both programs.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.solids import Solids, node_set
from verify.decks.submodels import CARD, GRADIENT, LAW, block, plate_global, plate_submodel, short_rows
from verify.peers.test_mixed_decks import run_peer
from verify.readers.dat_frd_files import Block, read_frd

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")

DIGITS = 1e-5  #: six digits are printed, of the global results and of those compared
LOW, HIGH = np.zeros(3), np.array([4.0, 3.0, 2.0])


def both(run: Run, folder: Path, global_deck: str, deck: str) -> tuple[list[Block], list[Block]]:
    """The .frd blocks of the submodel here and by CalculiX, after CalculiX has computed the global model."""
    for name, text in (("global", global_deck), ("theirs", deck), ("ours", deck)):
        (folder / name).mkdir()
        (folder / name / "job.inp").write_text(text)
        if name != "global":
            shutil.copy(folder / "global" / "job.frd", folder / name / "global.frd")
        if name != "ours":
            run_peer(folder / name)
    done = run(["job"], cwd=folder / "ours")
    assert done.returncode == 0, done.stdout + done.stderr
    return read_frd(folder / "ours" / "job.frd"), read_frd(folder / "theirs" / "job.frd")


def deviation(ours: Block, theirs: Block) -> float:
    """The largest difference over the largest value."""
    assert ours.rows.keys() == theirs.rows.keys()
    mine, reference = (np.array([b.rows[key] for key in sorted(theirs.rows)]) for b in (ours, theirs))
    return float(np.abs(mine[:, : reference.shape[1]] - reference).max() / np.abs(reference).max())


def named(blocks: list[Block], name: str) -> list[Block]:
    """The blocks of one field."""
    return [b for b in blocks if b.title == name]


@pytest.mark.parametrize("word", ["FILE", "OUTPUT"])
def test_hole(run: Run, tmp_path: Path, word: str) -> None:
    """The region around a hole: displacements, stresses and reactions; OUTPUT makes the global file binary."""
    deck = plate_global().replace("*NODE FILE", f"*NODE {word}").replace("*EL FILE", f"*EL {word}")
    ours, theirs = both(run, tmp_path, deck, plate_submodel(counts=(5, 8)))
    for field, tolerance in (("DISP", DIGITS), ("STRESS", 10 * DIGITS), ("FORC", 10 * DIGITS)):
        # stresses and forces come of differences of displacements of six digits
        (a,), (b,) = named(ours, field), named(theirs, field)
        assert deviation(a, b) <= tolerance, field


def twisted_global(mesh: Solids) -> str:
    """A block whose ends move in two steps, neither of them homogeneous."""
    held, pulled = mesh.where(0, 0.0), mesh.where(0, 4.0)
    sets = node_set("HELD", held) + node_set("PULLED", pulled)
    first = "*BOUNDARY\nHELD, 1, 3\n" + short_rows(pulled, mesh.nodes[pulled] @ GRADIENT.T * 2)
    second = "*BOUNDARY\nPULLED, 3, 3, 0.3\n"
    step = "*STEP, NLGEOM\n*STATIC\n0.5, 1.\n{}*NODE FILE\nU\n*END STEP\n"
    return "** dialect: calculix\n" + mesh.cards() + LAW + sets + step.format(first) + step.format(second)


@pytest.mark.parametrize("kind", ["C3D8", "C3D6", "C3D4", "C3D20", "C3D15", "C3D10"])
def test_two_steps(run: Run, tmp_path: Path, kind: str) -> None:
    """Each element kind as the global one, two steps with NLGEOM and several increments: the last of each step counts."""
    sub = block("C3D8", (2, 2, 2), np.array([0.7, 0.4, 0.3]), np.array([3.1, 2.2, 1.9]))
    step = "*STEP, NLGEOM\n*STATIC, DIRECT\n0.5, 1.\n*BOUNDARY, SUBMODEL, STEP={}\nCUT, 1, 3\n*NODE FILE\nU\n*END STEP\n"
    deck = "** dialect: calculix\n" + sub.cards() + LAW + node_set("CUT", sub.boundary_nodes()) + CARD.format("global.frd")
    mesh = block(kind, (4, 3, 2), LOW, HIGH, shake=0.2)
    ours, theirs = both(run, tmp_path, twisted_global(mesh), deck + step.format(1) + step.format(2))
    assert len(named(ours, "DISP")) == len(named(theirs, "DISP")) == 4
    for a, b in zip(named(ours, "DISP"), named(theirs, "DISP"), strict=True):
        assert deviation(a, b) <= DIGITS


def test_outside_and_element_set(run: Run, tmp_path: Path) -> None:
    """Nodes outside take the nearest point of the chosen elements in both programs."""
    mesh = block("C3D8", (4, 3, 2), LOW, HIGH)
    sub = block("C3D8", (2, 2, 2), np.array([1.2, 1.2, 1.2]), np.array([3.0, 2.0, 2.3]))
    step = "*STEP\n*STATIC\n*BOUNDARY, SUBMODEL, STEP=1\nCUT, 1, 3\n*NODE FILE\nU\n*END STEP\n"
    chosen = [e + 1 for e, nodes in enumerate(mesh.elements) if mesh.nodes[nodes][:, 0].mean() < 3]
    elset = "*ELSET, ELSET=CHOSEN\n" + ",\n".join(map(str, chosen)) + "\n"
    deck = "** dialect: calculix\n" + sub.cards() + LAW + elset + node_set("CUT", sub.boundary_nodes())
    deck += "*SUBMODEL, TYPE=NODE, INPUT=global.frd, GLOBAL ELSET=CHOSEN\nCUT\n" + step
    ours, theirs = both(run, tmp_path, twisted_global(mesh), deck)
    assert deviation(named(ours, "DISP")[0], named(theirs, "DISP")[0]) <= DIGITS


def test_temperatures(run: Run, tmp_path: Path) -> None:
    """A field of temperatures comes to all nodes of the submodel; CalculiX writes it to its file."""
    mesh = block("C3D8", (3, 2, 2), LOW, HIGH)
    rows = "".join(f"{i}, {20 + 10 * x[0] * x[1] - 3 * x[2]:.6g}\n" for i, x in enumerate(mesh.nodes, start=1))
    law = LAW.replace("*SOLID", "*EXPANSION\n1e-5\n*SOLID") + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNODES, 20.\n"
    held = node_set("HELD", mesh.where(0, 0.0))
    deck = "** dialect: calculix\n" + mesh.cards() + law + held
    deck += "*STEP\n*STATIC\n*BOUNDARY\nHELD, 1, 3\n*TEMPERATURE\n" + rows + "*NODE FILE\nU, NT\n*END STEP\n"
    sub = block("C3D8", (2, 2, 2), np.array([0.7, 0.4, 0.3]), np.array([3.1, 2.2, 1.9]))
    step = "*STEP\n*STATIC\n*TEMPERATURE, SUBMODEL, STEP=1\nNODES\n*BOUNDARY, SUBMODEL, STEP=1\nNODES, 1, 1\nCUT, 2, 3\n*NODE FILE\nU, NT\n*END STEP\n"
    small = "** dialect: calculix\n" + sub.cards() + law + node_set("CUT", sub.boundary_nodes())
    small += "*SUBMODEL, TYPE=NODE, INPUT=global.frd\nNODES\n" + step
    ours, theirs = both(run, tmp_path, deck, small)
    for field in ("NDTEMP", "DISP"):
        assert deviation(named(ours, field)[0], named(theirs, field)[0]) <= DIGITS, field


def test_no_local_directions(run: Run, tmp_path: Path) -> None:
    """Both programs refuse driven nodes with *TRANSFORM."""
    deck = plate_submodel(counts=(2, 2)).replace("*SUBMODEL", "*TRANSFORM, NSET=CUT, TYPE=R\n0., 1., 0., -1., 0., 0.\n*SUBMODEL")
    (tmp_path / "job.inp").write_text(deck)
    done = run(["job"], cwd=tmp_path)
    assert done.returncode == 3
    assert "directions of its own" in re.sub(r"\s+", " ", done.stdout + done.stderr)
