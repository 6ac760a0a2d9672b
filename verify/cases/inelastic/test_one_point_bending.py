"""Plastic bending of one-point elements: a cantilever of perfectly plastic steel, of hardening steel under NLGEOM and of sand, against elements of full order.

The hourglass stress of C3D8R, CPS4R and CPE4R follows the flow of the material (doc/theory/elements.md, "One point and hourglass stiffness"). An elastic
one gave twice the limit load with four elements over the depth, and four times with two.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.decks.make_decks import block
from verify.decks.sheets import between
from verify.decks.solids import as_kind, node_set

RunDeck = Callable[..., subprocess.CompletedProcess[str]]
LENGTH, DEPTH = 10.0, 1.0
LAWS = {
    "perfect": "*ELASTIC\n200000., 0.3\n*PLASTIC\n200., 0.\n",
    "hardening": "*ELASTIC\n200000., 0.3\n*PLASTIC\n200., 0.\n400., 0.1\n",
    "creep": "*ELASTIC\n200000., 0.3\n*CREEP\n1e-12, 4., 0.\n",
}


def reaction(run_deck: RunDeck, folder: Path, kind: str, rows: int, law: str, tip: float, procedure: str = "*STATIC", step: str = "") -> tuple[float, int, str]:
    """The force at the tip that the deflection takes, the Newton iterations, and what the program says."""
    is_plane = kind.startswith("CP")
    body = as_kind(block(between(0, LENGTH, 20), between(0, 1, 1), between(0, DEPTH, rows), "BODY"), "C3D8" if is_plane else kind)
    nodes, elements, across = body.nodes, body.elements, 3
    if is_plane:  # the front side of the block
        front = np.flatnonzero(nodes[:, 1] < 1e-9)
        number = {int(n): i for i, n in enumerate(front)}
        elements = np.array([[number[int(n)] for n in e if int(n) in number] for e in elements])
        nodes = np.column_stack([nodes[front][:, 0], nodes[front][:, 2], np.zeros(len(front))])
        across = 2
        middle = nodes[elements].mean(axis=1)
        elements = np.array([sorted(e, key=lambda n, m=m: np.arctan2(*(nodes[n][1::-1] - m[1::-1]))) for e, m in zip(elements, middle, strict=True)])
    text = "*NODE\n" + "".join(f"{i + 1}, {x:.12g}, {y:.12g}, {z:.12g}\n" for i, (x, y, z) in enumerate(nodes))
    text += f"*ELEMENT, TYPE={kind}, ELSET=ALL\n"
    for e, members in enumerate(elements.tolist()):
        words = [str(n + 1) for n in members]
        text += ",\n".join(", ".join(line) for line in ([f"{e + 1}", *words[:10]], words[10:]) if line) + "\n"
    text += f"*MATERIAL, NAME=M\n{law}*SOLID SECTION, ELSET=ALL, MATERIAL=M\n" + ("1.\n" if is_plane else "")
    text += node_set("FIX", np.flatnonzero(nodes[:, 0] < 1e-9)) + node_set("TIP", np.flatnonzero(nodes[:, 0] > LENGTH - 1e-9))
    text += f"*STEP, INC=1000{step}\n{procedure}\n0.05, 1.\n*BOUNDARY\nFIX, 1, {across}\nTIP, {across}, {across}, {-tip}\n*END STEP\n"
    done = run_deck(text)
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(folder / "job.vtkhdf") as file:
        n = int(file["VTKHDF/NumberOfPoints"][-1])
        labels, forces = np.asarray(file["AMONTONS/mesh/node_label"])[-n:], np.asarray(file["VTKHDF/PointData/RF"])[-n:]
    tips = np.flatnonzero(nodes[:, 0] > LENGTH - 1e-9) + 1
    iterations = next(int(line.split()[2]) for line in done.stdout.splitlines() if line.strip().startswith("Newton iterations"))
    return float(-forces[np.isin(labels, tips), across - 1].sum()), iterations, done.stdout + done.stderr


@pytest.mark.parametrize(("kind", "reference"), [("C3D8R", "C3D20R"), ("CPS4R", None), ("CPE4R", None)])
def test_limit_load(run_deck: RunDeck, tmp_path: Path, kind: str, reference: str | None) -> None:
    """Four elements over the depth hold 1.15 of the limit load at most, in as many iterations; the solid is compared with C3D20R at the same deflection.

    The hinge of a slender beam carries b h^2/4 of the yield stress, in plane strain 2/sqrt(3) of it; at this deflection a tenth of the curvature of the root is
    elastic still, and C3D20R gives 1.09 of the hinge.
    """
    hinge = 200.0 * DEPTH**2 / 4 / LENGTH * (2 / np.sqrt(3) if kind == "CPE4R" else 1.0)
    force, iterations, _ = reaction(run_deck, tmp_path, kind, 4, LAWS["perfect"], 1.0)
    expected = 1.09 * hinge
    if reference:
        expected, most, _ = reaction(run_deck, tmp_path, reference, 4, LAWS["perfect"], 1.0)
        assert iterations <= 1.3 * most
    assert 0.9 * expected < force < 1.15 * expected, (force, expected)


@pytest.mark.parametrize(("rows", "tolerance"), [(2, 0.3), (4, 0.15), (8, 0.1)])
def test_hardening(run_deck: RunDeck, tmp_path: Path, rows: int, tolerance: float) -> None:
    """The force of C3D20R, nearer with more elements."""
    force, _, _ = reaction(run_deck, tmp_path, "C3D8R", rows, LAWS["hardening"], 1.0)
    expected, _, _ = reaction(run_deck, tmp_path, "C3D20R", 4, LAWS["hardening"], 1.0)
    assert force == pytest.approx(expected, rel=tolerance)


def test_hardening_under_large_displacements(run_deck: RunDeck, tmp_path: Path) -> None:
    """The force of C3D8I at a deflection of twice the depth."""
    force, _, _ = reaction(run_deck, tmp_path, "C3D8R", 4, LAWS["hardening"], 2.0, step=", NLGEOM")
    expected, _, _ = reaction(run_deck, tmp_path, "C3D8I", 4, LAWS["hardening"], 2.0, step=", NLGEOM")
    assert force == pytest.approx(expected, rel=0.15)


@pytest.mark.parametrize("rows", [1, 2, 4])
def test_creep(run_deck: RunDeck, tmp_path: Path, rows: int) -> None:
    """A held deflection relaxes as with C3D20R, also that of a single row, which is bent by its hourglass modes alone: 8 % are its mesh."""
    force, _, _ = reaction(run_deck, tmp_path, "C3D8R", rows, LAWS["creep"], 0.05, "*VISCO, CETOL=1e-3")
    expected, _, _ = reaction(run_deck, tmp_path, "C3D20R", 4, LAWS["creep"], 0.05, "*VISCO, CETOL=1e-3")
    assert force == pytest.approx(expected, rel=0.08)


def test_coarse_increments_are_named(run_deck: RunDeck, tmp_path: Path) -> None:
    """A single row in bending overshoots while flow sets in: a line says so."""
    _, _, said = reaction(run_deck, tmp_path, "C3D8R", 1, LAWS["perfect"], 1.0)
    assert "hourglass stresses that the material does not hold" in said
