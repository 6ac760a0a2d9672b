"""TRVEC and TRSHR on the sides of shells: they act at the reference surface, where the nodes are, as in Abaqus.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.readers.dat_frd_files import read_dat

YOUNG, LENGTH, WIDTH, THICKNESS, TRACTION = 1e6, 10.0, 2.0, 1.0, 3.0
CELLS = (10, 2)
SHELLS = ["S3", "S4", "S4R", "S8R"]
LAYERS = "COMPOSITE\n0.2, 3, M\n0.3, 3, M\n0.5, 3, M\n"


def strip(kind: str, place: str, label: str, section: str = "", nlgeom: str = "") -> str:
    """A clamped strip in the plane z = 0 under a traction along x on one of its sides; END is a corner of its free end."""
    m = 2 if kind == "S8R" else 1
    labels: dict[tuple[int, int], int] = {}
    for j in range(CELLS[1] * m + 1):
        for i in range(CELLS[0] * m + 1):
            if not (m == 2 and i % 2 and j % 2):
                labels[i, j] = len(labels) + 1
    nodes = "".join(f"{n}, {LENGTH * i / (CELLS[0] * m)}, {WIDTH * j / (CELLS[1] * m)}, 0.\n" for (i, j), n in labels.items())
    rows: list[list[int]] = []
    for b in range(0, CELLS[1] * m, m):
        for a in range(0, CELLS[0] * m, m):
            around = [labels[x] for x in ((a, b), (a + m, b), (a + m, b + m), (a, b + m))]
            if m == 2:
                around += [labels[x] for x in ((a + 1, b), (a + 2, b + 1), (a + 1, b + 2), (a, b + 1))]
            rows += [around[:3], [around[0], *around[2:]]] if kind == "S3" else [around]
    elements = "".join(f"{e}, {', '.join(map(str, row))}\n" for e, row in enumerate(rows, 1))
    clamped = "".join(f"{n},\n" for (i, _), n in labels.items() if i == 0)
    words = section or f"MATERIAL=M\n{THICKNESS}\n"
    follower = ", FOLLOWER=NO, CONSTANT RESULTANT=YES" if nlgeom else ""
    return (
        f"*NODE\n{nodes}*ELEMENT, TYPE={kind}, ELSET=E\n{elements}*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, 0.\n*SHELL SECTION, ELSET=E, {words}"
        f"*NSET, NSET=CLAMPED\n{clamped}*NSET, NSET=END\n{labels[CELLS[0] * m, 0]},\n*SURFACE, NAME=SIDE\nE, {place}\n*BOUNDARY\nCLAMPED, 1, 6\n"
        f"*STEP{nlgeom}\n*STATIC\n*DSLOAD{follower}\nSIDE, {label}, {TRACTION}, 1., 0., 0.\n*NODE PRINT, NSET=END\nU\n*END STEP\n"
    )


def end_of(folder: Path) -> np.ndarray:
    """The displacement of the free end."""
    return np.array(next(iter(read_dat(folder / "job.dat")[-1].rows.values()))[:3])


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
@pytest.mark.parametrize("label", ["TRSHR", "TRVEC"])
@pytest.mark.parametrize("place", ["SPOS", "SNEG"])
@pytest.mark.parametrize("kind", SHELLS)
def test_strip_is_stretched(run_deck: Run, tmp_path: Path, kind: str, place: str, label: str, nlgeom: str) -> None:
    """u = q L^2/(2 E t) and no deflection (Timoshenko): on the face of the solid the traction deflected the end by q t L^3/(6 E I), 4 L/t times u."""
    done = run_deck(strip(kind, place, label, nlgeom=nlgeom))
    assert done.returncode == 0, done.stdout + done.stderr
    u = end_of(tmp_path)
    stretch = TRACTION * LENGTH**2 / (2 * YOUNG * THICKNESS)
    assert abs(u[2]) <= 1e-9 * stretch
    assert u[0] == pytest.approx(stretch, rel=0.03 if kind == "S3" else 1e-6 if not nlgeom else 1e-4)


@pytest.mark.parametrize("kind", ["S4", "S8R"])
@pytest.mark.parametrize(("offset", "arm"), [("SPOS", 0.5), ("SNEG", -0.5), ("0.2", 0.2)])
def test_offset_strip_is_bent(run_deck: Run, tmp_path: Path, kind: str, offset: str, arm: float) -> None:
    """Nodes off the middle surface by a: the moment per length is q a, whichever side is named; w = -q a L^3/(3 E I'), I' = t^3/12."""
    for place in ("SPOS", "SNEG"):
        done = run_deck(strip(kind, place, "TRSHR", f"OFFSET={offset}, MATERIAL=M\n{THICKNESS}\n"))
        assert done.returncode == 0, done.stdout + done.stderr
        expected = -TRACTION * arm * LENGTH**3 / (3 * YOUNG * THICKNESS**3 / 12)
        assert end_of(tmp_path)[2] == pytest.approx(expected, rel=4e-3), place


@pytest.mark.parametrize("kind", ["S4", "S8R"])
def test_layered_strip_is_stretched(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """Three layers of one material: the reference surface is the interface of the second and the third, away from the face below."""
    for place in ("SPOS", "SNEG"):
        done = run_deck(strip(kind, place, "TRSHR", LAYERS))
        assert done.returncode == 0, done.stdout + done.stderr
        u = end_of(tmp_path)
        stretch = TRACTION * LENGTH**2 / (2 * YOUNG * THICKNESS)
        assert abs(u[2]) <= 1e-3 * 4 * LENGTH / THICKNESS * stretch
        assert u[0] == pytest.approx(stretch, rel=2e-2), place


def test_edge_keeps_its_traction(run_deck: Run, tmp_path: Path) -> None:
    """An edge of shells is no side: its traction acts over the thickness. u = q L/E."""
    deck = strip("S4", "SPOS", "TRVEC").replace("*SURFACE, NAME=SIDE\nE, SPOS\n", "*SURFACE, NAME=SIDE\n10, E2\n20, E2\n")
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr
    assert end_of(tmp_path)[0] == pytest.approx(TRACTION * LENGTH / YOUNG, rel=1e-6)


@pytest.mark.parametrize("place", ["SPOS", "SNEG"])
def test_area_is_that_of_the_reference_surface(run_deck: Run, tmp_path: Path, place: str) -> None:
    """A cylinder of SAX1, radius 5, thickness 2, length 4, drawn along its axis: the force is 2 pi R L q."""
    radius, length, n = 5.0, 4.0, 4
    nodes = "".join(f"{i + 1}, {radius}, {length * i / n}\n" for i in range(n + 1))
    elements = "".join(f"{i + 1}, {i + 1}, {i + 2}\n" for i in range(n))
    done = run_deck(
        f"*NODE\n{nodes}*ELEMENT, TYPE=SAX1, ELSET=E\n{elements}*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, 0.\n*SHELL SECTION, ELSET=E, MATERIAL=M\n2.\n"
        f"*SURFACE, NAME=SIDE\nE, {place}\n*NSET, NSET=CLAMPED\n1\n*BOUNDARY\nCLAMPED, 1, 6\n*STEP\n*STATIC\n*DSLOAD\nSIDE, TRSHR, {TRACTION}, 0., 1., 0.\n"
        "*NODE PRINT, NSET=CLAMPED, TOTALS=ONLY\nRF\n*END STEP\n"
    )
    assert done.returncode == 0, done.stdout + done.stderr
    total = np.array(next(iter(read_dat(tmp_path / "job.dat")[-1].rows.values())))
    assert total[1] == pytest.approx(-2 * np.pi * radius * length * TRACTION, rel=1e-6)
