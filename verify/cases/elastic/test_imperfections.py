"""*IMPERFECTION: a strut with a bow, an oval ring, and the same model with the offsets in its coordinates.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.cases.proof import Case
from verify.conftest import Run
from verify.readers.dat_frd_files import read_dat

Proof = Callable[..., Case]
YOUNG, LENGTH, DEPTH = 1.0e6, 100.0, 1.0
CELLS = 40
BOW = 1e-3 * LENGTH  #: height of the bow in the middle
EULER = np.pi**2 * YOUNG * DEPTH**3 / 12 / LENGTH**2
TOL_BOW = 3e-3  #: (u'/2)^2 of the bow and of the deflection, the shear of a strut of slenderness 100, and the compression P/EA


def strut(offsets: np.ndarray, is_in_coordinates: bool) -> str:
    """A straight strut of CPS8 along x, pinned at its ends, and the offsets along y of its nodes as a card or in the coordinates."""
    x = np.repeat(np.linspace(0, LENGTH, 2 * CELLS + 1), 3)
    y = np.tile([-DEPTH / 2, 0.0, DEPTH / 2], 2 * CELLS + 1)
    keep = [i for i in range(len(x)) if not (i // 3 % 2 and i % 3 == 1)]
    drawn = y + offsets[np.arange(len(x)) // 3] if is_in_coordinates else y
    lines = ["*NODE, NSET=ALL", *(f"{i + 1}, {x[i]:.17g}, {drawn[i]:.17g}" for i in keep), "*ELEMENT, TYPE=CPS8, ELSET=E"]
    for e in range(CELLS):
        n = 6 * e + 1
        lines.append(f"{e + 1}, {n}, {n + 6}, {n + 8}, {n + 2}, {n + 3}, {n + 7}, {n + 5}, {n + 1}")
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", f"{YOUNG}, 0.", "*SOLID SECTION, ELSET=E, MATERIAL=M", "1.", "*BOUNDARY", "2, 1, 2", f"{6 * CELLS + 2}, 2"]
    if not is_in_coordinates:
        lines += ["*IMPERFECTION", *(f"{i + 1}, 0., {offsets[i // 3]:.17g}, 0." for i in keep)]
    return "\n".join(lines) + "\n"


def half_wave() -> np.ndarray:
    """The bow at the stations along the strut: the buckling mode times its height."""
    return BOW * np.sin(np.pi * np.linspace(0, 1, 2 * CELLS + 1))


def compression(force: float) -> str:
    """A step with a force at the sliding end."""
    return f"*STEP, NLGEOM\n*STATIC, DIRECT\n0.5, 1.\n*CONTROLS, PARAMETERS=FIELD\n1e-10, 1e-10\n*CLOAD\n{6 * CELLS + 2}, 1, {-force:.17g}\n*NODE PRINT, NSET=ALL\nU\n*END STEP\n"


def test_strut_with_a_bow(proof: Proof) -> None:
    """A pinned strut whose first mode is its imperfection: deflection by the amplification of the bow."""
    case = proof(
        "imperfection-of-a-strut",
        title="A strut with an imperfection in the form of its buckling mode",
        model=f"A strut of {LENGTH:g} x {DEPTH:g}, pinned at its ends, E = {YOUNG:g}, nu = 0, of {CELLS} CPS8; drawn straight. *IMPERFECTION bends it to a "
        f"half wave of the height e = {BOW:g}. A force of a half and of 0.8 of Euler's compresses it, with NLGEOM.",
        formula="Added deflection in the middle e (P/P_E)/(1 - P/P_E), P_E = pi^2 E I/l^2; without the imperfection none.",
        source="S. P. Timoshenko, J. M. Gere, Theory of Elastic Stability, 2nd ed., section 1.12",
        proves="The offsets of *IMPERFECTION are those of the nodes before the load, and are not part of the displacements.",
    )
    for ratio in (0.5, 0.8):
        deck = strut(half_wave(), False) + compression(ratio * EULER)
        job = case.run(deck, f"{ratio:g} of Euler's load")
        middle = int(np.argmin(np.abs(job.points[:, 0] - LENGTH / 2) + np.abs(job.points[:, 1] - BOW)))
        case.near("height of the middle before the load", job.points[middle, 1], BOW, 1e-12, why="rounding", place="middle", time="the start")
        case.near("deflection", job.last("U")[middle, 1], BOW * ratio / (1 - ratio), TOL_BOW, why="moderate rotations, shear", place="middle", time=f"P = {ratio:g} P_E")
    case.done()


def displacements(run_deck: Run, tmp_path: Path, deck: str) -> dict[object, list[float]]:
    """The displacements at the end."""
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    return dict(read_dat(tmp_path / "job.dat")[-1].rows)


def test_offsets_are_coordinates(run_deck: Run, tmp_path: Path) -> None:
    """A card, a file of it and the same offsets in the coordinates give the same digits; without them the strut stays straight."""
    load = compression(0.5 * EULER)
    by_card = displacements(run_deck, tmp_path, strut(half_wave(), False) + load)
    assert by_card == displacements(run_deck, tmp_path, strut(half_wave(), True) + load)
    head, rows = strut(half_wave(), False).split("*IMPERFECTION\n")
    (tmp_path / "bow.inp").write_text(rows)
    assert by_card == displacements(run_deck, tmp_path, head + "*IMPERFECTION, INPUT=bow.inp\n" + load)
    straight = displacements(run_deck, tmp_path, head + load)
    middle = 3 * CELLS + 2
    assert abs(straight[(middle,)][1]) < 1e-9 * by_card[(middle,)][1]


def test_offsets_of_shells_turn_their_normals(run_deck: Run, tmp_path: Path) -> None:
    """A flat strip of S4 that is bent up to a ramp: it is the ramp that the coordinates would draw, with its normals."""
    nodes = [(x, y) for y in (0.0, 1.0) for x in range(5)]
    ramp = [0.5 * x for x, _ in nodes]

    def deck(drawn: list[float], card: str) -> str:
        lines = ["*NODE, NSET=ALL", *(f"{i + 1}, {x}, {y}, {z:g}" for i, ((x, y), z) in enumerate(zip(nodes, drawn, strict=True))), "*ELEMENT, TYPE=S4, ELSET=E"]
        lines += [f"{e + 1}, {e + 1}, {e + 2}, {e + 7}, {e + 6}" for e in range(4)]
        lines += ["*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3", "*SHELL SECTION, ELSET=E, MATERIAL=M", "0.1", "*BOUNDARY", "1, 1, 6", "6, 1, 6"]
        return "\n".join(lines) + "\n" + card + "*STEP\n*STATIC\n*DLOAD\nE, P, 0.001\n*NODE PRINT, NSET=ALL\nU\n*END STEP\n"

    card = "*IMPERFECTION\n" + "".join(f"{i + 1}, 0., 0., {z:g}\n" for i, z in enumerate(ramp))
    assert displacements(run_deck, tmp_path, deck([0.0] * len(nodes), card)) == displacements(run_deck, tmp_path, deck(ramp, ""))


def test_nodes_of_instances(run_deck: Run, tmp_path: Path) -> None:
    """INSTANCE.NUMBER and INSTANCE.SET name nodes of a part, in the global axes; the offsets of the second instance leave the first."""
    part = "*PART, NAME=P\n*NODE\n" + "".join(f"{1 + i + 2 * j + 4 * k}, {i}, {j}, {k}\n" for k in (0, 1) for j in (0, 1) for i in (0, 1))
    part += "*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 4, 3, 5, 6, 8, 7\n*NSET, NSET=TOP\n5, 6, 7, 8\n*NSET, NSET=LOW\n1, 2, 3, 4\n"
    part += "*SOLID SECTION, ELSET=E, MATERIAL=M\n*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=ONE, PART=P\n*END INSTANCE\n"
    part += "*INSTANCE, NAME=TWO, PART=P\n5., 0., 0.\n5., 0., 0., 5., 0., 1., 90.\n*END INSTANCE\n*NSET, NSET=ENDS\nONE.TOP, TWO.TOP\n*END ASSEMBLY\n"
    part += "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n*BOUNDARY\nONE.LOW, 1, 3\nTWO.LOW, 1, 3\n"
    load = "*STEP\n*STATIC\n*BOUNDARY\nENDS, 1, 2\nENDS, 3, 3, 0.1\n*NODE PRINT, NSET=ENDS\nRF\n*END STEP\n"
    for rows in ("TWO.TOP, 0., 0., 1.\n", "TWO.5, 0., 0., 1.\nTWO.6, 0., 0., 1.\nTWO.7, 0., 0., 1.\nTWO.8, 0., 0., 1.\n"):
        forces = [row[2] for row in displacements(run_deck, tmp_path, part + "*IMPERFECTION\n" + rows + load).values()]
        assert sum(forces[:4]) == pytest.approx(100.0, rel=1e-6)   # E A u/l
        assert sum(forces[4:]) == pytest.approx(50.0, rel=1e-6)    # of a bar twice as long
