"""The picture of a job: in space and in the plane, with contact and without, and with a rigid surface that is drawn.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.planes import flat_deck, flatten
from verify.decks.sheets import between, fix, pair, sheet, step
from verify.decks.solids import unit_cube
from verify.tools import picture

BALL = """*NODE
90, 0.5, 0.5, 3.
*SURFACE, TYPE=REVOLUTION, NAME=TOOL
0.5, 0.5, 3., 0.5, 0.5, 5.
START, 0., -2.
CIRCL, 2., 0., 0., 0.
*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=90
"""
CUBE = unit_cube("N", "ALL") + """*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET=ALL, MATERIAL=M
"""
TRUSS = """*NODE
11, 0, 0, 1
12, 0, 0, 3
*ELEMENT, TYPE=T3D2, ELSET=ROD
11, 11, 12
*SOLID SECTION, ELSET=ROD, MATERIAL=M
0.1
"""
PULL = "*STEP\n*STATIC\n*BOUNDARY\n1, 1, 3\n2, 2, 3\n3, 3\n4, 3\n5, 3, 3, 0.1\n6, 3, 3, 0.1\n7, 3, 3, 0.1\n8, 3, 3, 0.1\n"


def blocks() -> str:
    """One square pressed on another and dragged, CPE4."""
    upper, lower = flatten(sheet("UPPER", between(0, 1, 2), between(0, 1, 2))), flatten(sheet("LOWER", between(-1, 2, 6), between(-1, 0, 2)))
    steps = step(fix("LOWER_BOTTOM, 1, 2", "UPPER_TOP, 1", "UPPER_TOP, 2, 2, -0.01"), 1) + step(fix("UPPER_TOP, 1, 1, 0.05"), 2)
    return flat_deck([(upper, (1000.0, 0.3)), (lower, (1000.0, 0.3))], "CPE4", pair("UPPER_BOTTOM", "LOWER_TOP", 0.2) + steps)


@pytest.mark.parametrize(
    ("deck", "faces", "bars", "shells"),
    [
        (blocks(), 4 + 12, 0, 0),
        (CUBE + TRUSS + PULL + "11, 1, 3\n12, 1, 2\n12, 3, 3, 0.1\n*END STEP\n", 6, 1, 0),
        (CUBE + BALL + PULL + "90, 1, 6\n*END STEP\n", 6, 0, None),
    ],
    ids=["plane contact", "solid and bar", "rigid ball"],
)
def test_it_is_drawn(run_deck: Run, tmp_path: Path, deck: str, faces: int, bars: int, shells: int | None) -> None:
    """What is seen: the outer faces of bodies, bars as lines, rigid surfaces as a net."""
    done = run_deck(deck, "--quiet")
    assert done.returncode == 0, done.stdout + done.stderr
    job = picture.read_job(tmp_path / "job.vtkhdf")
    assert (len(job.skin), len(job.bars)) == (faces, bars)
    assert len(job.shells) > 100 if shells is None else len(job.shells) == shells
    assert picture.main([str(tmp_path / "job.vtkhdf"), "--output", str(tmp_path / "job.png")]) == 0
    assert (tmp_path / "job.png").stat().st_size > 10000
    figure, words = picture.shape(tmp_path / "job.vtkhdf")
    assert figure.axes
    assert "Mises" in words


def test_plane_bodies_are_seen_along_z() -> None:
    """x to the right, y up."""
    right, up, towards = picture.camera(np.array([[0.0, 0.0, 0.0], [2.0, 1.0, 0.0]]))
    assert np.array_equal([right, up, towards], np.eye(3))
