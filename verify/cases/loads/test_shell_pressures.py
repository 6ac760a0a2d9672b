"""Pressure on curved shells acts at the reference surface, where the nodes are, as in Abaqus: thick rings with closed forms.

A quarter of a ring about z of radius R (that of the nodes), thickness t = R/10, Poisson's ratio 0. By statics its two ends carry
p R L together along x and y, whatever the mesh, since the area vectors of a surface add up to that between its ends. On the face of
the solid it would be p (R -+ t/2) L, 5 % off.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.readers.dat_frd_files import read_dat

YOUNG, RADIUS, THICKNESS, LENGTH, PRESSURE = 1e6, 10.0, 1.0, 2.0, 3e3
SHELLS = ["S3", "S4", "S4R", "S6", "S8", "S8R"]
LINEAR = ["S3", "S4", "S4R"]
CELLS = 8
LAYERS = "COMPOSITE\n0.2, 3, M\n0.3, 3, M\n0.5, 3, M\n"


def ring(kind: str, load: str, section: str = f"MATERIAL=M\n{THICKNESS}\n", nlgeom: str = "", extra: str = "") -> str:
    """The quarter of a ring, its normals outward, with symmetry at its ends XEND (y = 0) and YEND (x = 0)."""
    m = 2 if kind in ("S6", "S8", "S8R") else 1
    labels: dict[tuple[int, int], int] = {}
    for j in range(m + 1):
        for i in range(CELLS * m + 1):
            if kind == "S6" or not (m == 2 and i % 2 and j % 2):
                labels[i, j] = len(labels) + 1
    nodes = ""
    for (i, j), n in labels.items():
        angle = math.pi / 2 * i / (CELLS * m)
        nodes += f"{n}, {RADIUS * math.cos(angle)!r}, {RADIUS * math.sin(angle)!r}, {LENGTH * j / m}\n"
    rows: list[list[int]] = []
    for a in range(0, CELLS * m, m):
        corners = [(a, 0), (a + m, 0), (a + m, m), (a, m)]
        for part in ([[0, 1, 2], [0, 2, 3]] if kind in ("S3", "S6") else [[0, 1, 2, 3]]):
            own = [corners[k] for k in part]
            middles = [((p[0] + q[0]) // 2, (p[1] + q[1]) // 2) for p, q in zip(own, own[1:] + own[:1], strict=True)]
            rows.append([labels[x] for x in own + (middles if m == 2 else [])])
    elements = "".join(f"{e}, {', '.join(map(str, row))}\n" for e, row in enumerate(rows, 1))
    ends = "".join(f"*NSET, NSET={name}\n" + "".join(f"{n},\n" for (i, _), n in labels.items() if i == at) for name, at in (("XEND", 0), ("YEND", CELLS * m)))
    return (
        f"*NODE, NSET=ALL\n{nodes}*ELEMENT, TYPE={kind}, ELSET=E\n{elements}*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, 0.\n*SHELL SECTION, ELSET=E, {section}"
        f"{ends}*SURFACE, NAME=INSIDE\nE, SNEG\n*SURFACE, NAME=OUTSIDE\nE, SPOS\n{extra}*BOUNDARY\nXEND, YSYMM\nYEND, XSYMM\nALL, 3\n"
        f"*STEP{nlgeom}\n*STATIC\n{load}*NODE PRINT, NSET=XEND, TOTALS=ONLY\nRF\n*NODE PRINT, NSET=XEND\nU\n*END STEP\n"
    )


def force_and_radius(folder: Path) -> tuple[float, float]:
    """The force along y at the end on the axis x, and the mean radial displacement of this line, by its shape functions."""
    force, u = read_dat(folder / "job.dat")[-2:]
    weights = [0.5, 0.5] if len(u.rows) == 2 else [1 / 6, 4 / 6, 1 / 6]
    return next(iter(force.rows.values()))[1], float(np.dot(weights, [row[0] for row in u.rows.values()]))


OUTWARD = {"DLOAD": f"*DLOAD\nE, P, {PRESSURE}\n", "SNEG": f"*DSLOAD\nINSIDE, P, {PRESSURE}\n", "SPOS": f"*DSLOAD\nOUTSIDE, P, {-PRESSURE}\n"}


@pytest.mark.parametrize("place", OUTWARD)
@pytest.mark.parametrize("kind", SHELLS)
def test_resultant_is_that_of_the_reference_radius(run_deck: Run, tmp_path: Path, kind: str, place: str) -> None:
    """The hoop force is p R L, whichever side is named; the radius grows by p R^2/(E t), the polygon of S3 and S4 less."""
    done = run_deck(ring(kind, OUTWARD[place]))
    assert done.returncode == 0, done.stdout + done.stderr
    force, u = force_and_radius(tmp_path)
    assert force == pytest.approx(-PRESSURE * RADIUS * LENGTH, rel=1e-9)
    assert u == pytest.approx(PRESSURE * RADIUS**2 / (YOUNG * THICKNESS), rel=1e-2 if kind in LINEAR else 2e-3)


@pytest.mark.parametrize("section", [f"OFFSET=SPOS, MATERIAL=M\n{THICKNESS}\n", f"OFFSET=SNEG, MATERIAL=M\n{THICKNESS}\n", f"OFFSET=0.2, MATERIAL=M\n{THICKNESS}\n", LAYERS, f"OFFSET=-0.4, {LAYERS}"])
@pytest.mark.parametrize("kind", SHELLS)
def test_offset_and_layers(run_deck: Run, tmp_path: Path, kind: str, section: str) -> None:
    """The reference surface off the middle, and inside a layer that has not the loaded face: p R L by the radius of the nodes."""
    done = run_deck(ring(kind, OUTWARD["SNEG"], section))
    assert done.returncode == 0, done.stdout + done.stderr
    assert force_and_radius(tmp_path)[0] == pytest.approx(-PRESSURE * RADIUS * LENGTH, rel=1e-9)


@pytest.mark.parametrize("section", [f"MATERIAL=M\n{THICKNESS}\n", f"OFFSET=0.2, MATERIAL=M\n{THICKNESS}\n", LAYERS])
@pytest.mark.parametrize("kind", SHELLS)
def test_follows_the_reference_surface(run_deck: Run, tmp_path: Path, kind: str, section: str) -> None:
    """NLGEOM: p (R + u) L, u the displacement of the nodes of the deck, 4 % of R; Newton's method converges with the exact tangent."""
    done = run_deck(ring(kind, OUTWARD["SPOS"], section, ", NLGEOM"))
    assert done.returncode == 0, done.stdout + done.stderr
    force, u = force_and_radius(tmp_path)
    assert u > 0.02 * RADIUS
    assert force == pytest.approx(-PRESSURE * (RADIUS + u) * LENGTH, rel=1e-6)


def test_calculix_loads_the_face(run_deck: Run, tmp_path: Path) -> None:
    """In its dialect, as in CalculiX: the area of the face of the solid."""
    for place, radius in (("SNEG", RADIUS - THICKNESS / 2), ("SPOS", RADIUS + THICKNESS / 2)):
        done = run_deck(ring("S8R", OUTWARD[place]), "--dialect=calculix")
        assert done.returncode == 0, done.stdout + done.stderr
        assert force_and_radius(tmp_path)[0] == pytest.approx(-PRESSURE * radius * LENGTH, rel=2e-2)


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
@pytest.mark.parametrize("place", OUTWARD)
@pytest.mark.parametrize("kind", ["SAX1", "SAX2"])
def test_axisymmetric_shells(run_deck: Run, tmp_path: Path, kind: str, place: str, nlgeom: str) -> None:
    """A cylinder grows by p R^2/(E t); under NLGEOM by the factor g of E t ln g = p R g^2."""
    n = 4
    m = 2 if kind == "SAX2" else 1
    nodes = "".join(f"{i + 1}, {RADIUS}, {LENGTH * (1 - i / (n * m))}\n" for i in range(n * m + 1))
    elements = "".join(f"{i + 1}, {', '.join(str(m * i + 1 + k) for k in range(m + 1))}\n" for i in range(n))
    done = run_deck(
        f"*NODE, NSET=ALL\n{nodes}*ELEMENT, TYPE={kind}, ELSET=E\n{elements}*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, 0.\n*SHELL SECTION, ELSET=E, MATERIAL=M\n{THICKNESS}\n"
        f"*SURFACE, NAME=INSIDE\nE, SNEG\n*SURFACE, NAME=OUTSIDE\nE, SPOS\n*BOUNDARY\nALL, 2\nALL, 6\n*STEP{nlgeom}\n*STATIC\n{OUTWARD[place]}"
        "*NODE PRINT, NSET=ALL\nU\n*END STEP\n"
    )
    assert done.returncode == 0, done.stdout + done.stderr
    u = [row[0] for row in read_dat(tmp_path / "job.dat")[-1].rows.values()]
    strain = PRESSURE * RADIUS / (YOUNG * THICKNESS)
    grown = 1 + strain
    for _ in range(50 if nlgeom else 0):
        grown = math.exp(strain * grown**2)
    assert u == pytest.approx([RADIUS * (grown - 1)] * len(u), rel=1e-3)
