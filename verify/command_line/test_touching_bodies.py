"""Bodies that touch without a pair or a tie: the check names them, and its cards, copied as they are, pair them.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import h5py
import pytest
from verify.conftest import Run

#: A small block on a larger one, pressed down by 0.01; E and the area of contact.
E, AREA = 210000.0, 0.36
DECK = """*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
11, .2, .2, 1
12, .8, .2, 1
13, .8, .8, 1
14, .2, .8, 1
15, .2, .2, 2
16, .8, .2, 2
17, .8, .8, 2
18, .2, .8, 2
*ELEMENT, TYPE=C3D8{low}
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D8, ELSET=UP
2, 11, 12, 13, 14, 15, 16, 17, 18
*ELSET, ELSET=ALL
1, 2
*NSET, NSET=TOP
15, 16, 17, 18
*NSET, NSET=FLOOR, GENERATE
1, 8
*MATERIAL, NAME=M
*ELASTIC
210000., 0.
*SOLID SECTION, ELSET=ALL, MATERIAL=M
{cards}*STEP
*STATIC
*BOUNDARY
FLOOR, 1, 3
TOP, 1, 2
TOP, 3, 3, -.01
*END STEP
"""


@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
@pytest.mark.parametrize("low", [", ELSET=LOW", ""], ids=["sets", "labels"])
def test_cards_to_copy(run: Run, tmp_path: Path, dialect: str, low: str) -> None:
    """Without them the block falls through the other one; with them it is pressed by E A 0.01 (the lower block is held, nu = 0)."""
    (tmp_path / "job.inp").write_text(DECK.format(low=low, cards=""))
    said = run(["--dialect", dialect, "--check", "job"], cwd=tmp_path)
    text = said.stdout + said.stderr
    assert "touch, overlap or nearly meet, but no contact pair and no tie joins them" in text
    cards = re.search(r"bonds them\.\n((?:\*.*\n|[^*].*\n)*?)The deck has", text)
    assert cards, text
    (tmp_path / "job.inp").write_text(DECK.format(low=low, cards=cards.group(1)))
    done = run(["--dialect", dialect, "job"], cwd=tmp_path)
    assert done.returncode == 0
    assert "nearly meet" not in done.stdout + done.stderr
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        force = abs(file["AMONTONS/pair_history/CFN"][-1][2])
    # The springs of the calculix dialect (K = 50 E a unit of area, in series with 1 mm of block) give way by a fiftieth.
    assert force == pytest.approx(E * AREA * 0.01, rel=1e-6 if dialect == "abaqus" else 0.03)
