"""Nodes that pass the ridge of a master: above a face they touch it, beside the body nothing pushes them.

A block whose nodes are all held is the master, with its top and one side; a law of K per area gives the force of a depth. Reference: the body ends at its
ridge, so that a node beyond it touches only what it has below it; CalculiX's forces agree (`ccx`, side by side).

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import math
import os
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from verify.conftest import Run

STIFFNESS = 1000.0
CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
SHARE = 0.25  #: of the area of a face at each of its nodes
SIZE = 0.3  #: of the slave
EQUAL = 1e-3  #: the calculix dialect takes forces of 1e-3 as none, as CalculiX does


def ridge_deck(angle: float, start: tuple[float, float], way: tuple[float, float], increments: int, *, is_nlgeom: bool, dialect: str) -> str:
    """A master of two faces of 1 by 1 that meet at the origin by an angle, and a face of SIZE above it, whose right edge starts at a place and moves."""
    sine, cosine = round(math.sin(math.radians(angle)), 12), round(math.cos(math.radians(angle)), 12)
    outer = ((-1.0, 0.0), (0.0, 0.0), (cosine, -sine))
    half = math.radians(angle / 2)
    inner = ((-1.0, -0.5), (-0.5 * math.sin(half), -0.5 * math.cos(half)), (cosine - 0.5 * sine, -sine - 0.5 * cosine))
    text = f"** dialect: {dialect}\n*NODE\n"
    for k, (out, low) in enumerate(zip(outer, inner, strict=True)):
        for j in (0, 1):
            text += f"{1 + 4 * k + 2 * j}, {out[0]}, {j}, {out[1]}\n{2 + 4 * k + 2 * j}, {low[0]}, {j}, {low[1]}\n"
    for k, (x, y, z) in enumerate(CORNERS):
        text += f"{101 + k}, {start[0] + SIZE * (x - 1)}, {0.33 + SIZE * y}, {start[1] + SIZE * z}\n{201 + k}, {50 + x}, {y}, {z}\n"
    text += "*ELEMENT, TYPE=C3D8, ELSET=M\n"
    for k in (0, 1):
        corners = [1 + 4 * (k + i) + 2 * j + low for low in (1, 0) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
        text += f"{k + 1}, {', '.join(map(str, corners))}\n"
    for name, first in (("S", 101), ("FREE", 201)):  # CalculiX solves nothing without a free node
        text += f"*ELEMENT, TYPE=C3D8, ELSET={name}\n{first}, {', '.join(str(first + k) for k in range(8))}\n"
    text += "*ELSET, ELSET=ALL\nM, S, FREE\n*MATERIAL, NAME=A\n*ELASTIC\n1000., 0.\n*SOLID SECTION, ELSET=ALL, MATERIAL=A\n"
    text += "*NSET, NSET=MN, GENERATE\n1, 12\n*NSET, NSET=SN, GENERATE\n101, 108\n*NSET, NSET=FN, GENERATE\n201, 207\n*SURFACE, NAME=SM\nM, S2\n"
    text += f"*SURFACE, NAME=SS\nS, S1\n*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{STIFFNESS}\n"
    text += "*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE\nSS, SM\n*BOUNDARY\nMN, 1, 3\nFN, 1, 3\n"
    text += f"*STEP{', NLGEOM' if is_nlgeom else ''}, INC=1000\n*STATIC, DIRECT\n{1 / increments}, 1.\n*BOUNDARY\nSN, 1, 1, {way[0]}\nSN, 2, 2\nSN, 3, 3, {way[1]}\n"
    return text + "*NODE PRINT, NSET=SN, TOTALS=ONLY\nRF\n*END STEP\n"


def forces(folder: Path) -> list[tuple[float, float]]:
    """The forces on the slave along x and z, by increment; a Fortran exponent without its letter is no force."""
    rows = re.findall(r"total force.*?\n\s*\n\s*(\S+)\s+\S+\s+(\S+)", (folder / "job.dat").read_text())
    return [(float(x) if "E" in x.upper() else 0.0, float(z) if "E" in z.upper() else 0.0) for x, z in rows]


@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
@pytest.mark.parametrize("angle", [50, 60, 90])
def test_sliding_over_a_ridge(run_deck: Run, tmp_path: Path, angle: float, dialect: str) -> None:
    """Two nodes of four, and then the others, pass the ridge at a depth of 0.02: each is free as soon as it is beyond it. (A face inclined by 50 degrees
    lies lower by more than that after 0.02.)"""
    done = run_deck(ridge_deck(angle, (-0.1, -0.02), (0.5, 0.0), 25, is_nlgeom=True, dialect=dialect))
    assert done.returncode == 0, done.stdout + done.stderr
    whole = -STIFFNESS * 0.02 * SIZE**2
    for k, (_, along_z) in enumerate(forces(tmp_path)):
        place = -0.1 + 0.02 * (k + 1)
        beyond = [0.019 < x for x in (place, place - SIZE)]
        if k == 0 or any(-0.021 < x < 0.021 for x in (place, place - SIZE)):
            continue  # the first increment of the calculix dialect, and nodes at the ridge
        assert along_z == pytest.approx(whole * (1 - 2 * SHARE * sum(beyond)), abs=-EQUAL * whole), f"at {place}"


@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
@pytest.mark.parametrize(("height", "is_nlgeom"), [(0.1, True), (0.1, False), (-0.1, True), (-0.1, False)])
def test_face_beside_a_ridge(run_deck: Run, tmp_path: Path, height: float, dialect: str, *, is_nlgeom: bool) -> None:
    """The slave is beside the body by 0.05 and comes down from above its top or from below it: the top ends at the ridge."""
    done = run_deck(ridge_deck(90, (0.05 + SIZE, height), (0.0, -0.15), 5, is_nlgeom=is_nlgeom, dialect=dialect))
    assert done.returncode == 0, done.stdout + done.stderr
    assert forces(tmp_path)[-1] == pytest.approx((0.0, 0.0), abs=EQUAL)


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
@pytest.mark.parametrize("angle", [20, 50, 90, -30])
def test_ridges_and_valleys_beside_calculix(run: Callable, tmp_path: Path, angle: float) -> None:
    """The same forces as CalculiX's at every place but at the edge itself, where its border halves the angle of the faces and ours is the normal."""
    results = {}
    for side in ("ours", "theirs"):
        folder = tmp_path / side
        folder.mkdir()
        (folder / "job.inp").write_text(ridge_deck(angle, (-0.1, -0.02), (0.5, 0.0), 25, is_nlgeom=True, dialect="calculix"))
        if side == "ours":
            done = run(["job"], cwd=folder)
        else:
            done = subprocess.run(["ccx", "job"], cwd=folder, env=os.environ | {"OMP_NUM_THREADS": "1"}, capture_output=True, text=True, timeout=100)
        assert done.returncode == 0, done.stdout + done.stderr
        results[side] = forces(folder)
    largest = max(abs(z) for _, z in results["theirs"])
    for k, (own, other) in enumerate(zip(results["ours"], results["theirs"], strict=True)):
        if not any(-0.021 < x < 0.021 for x in (-0.1 + 0.02 * (k + 1), -0.1 + 0.02 * (k + 1) - SIZE)):
            assert own == pytest.approx(other, abs=EQUAL * largest), f"increment {k + 1}"
