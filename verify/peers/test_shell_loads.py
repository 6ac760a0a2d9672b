"""Loads on edges and energies of shells against closed forms, and what CalculiX (ccx) gives instead.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from verify.decks.shells import shell
from verify.peers.test_mixed_decks import tables_by_both

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")

Run = Callable[..., subprocess.CompletedProcess[str]]


def plate(kind: str, option: str = "", thickness: str = "") -> str:
    """A plate of 2 x 1, thickness 0.05, fixed along x = 0."""
    mesh = shell(kind, (4, 2), lambda u, v: (2 * u, v, 0 * u))
    text = mesh.cards() + f"*MATERIAL, NAME=M\n*ELASTIC\n10000., .3\n*SHELL SECTION, ELSET=E, MATERIAL=M{option}\n.05\n{thickness}"
    return text + f"*NSET, NSET=TIP\n{mesh.at(1.0, 1.0) + 1}\n*NSET, NSET=LEFT\n" + "".join(f"{i + 1}\n" for i in mesh.where(0, 0.0)) + "*BOUNDARY\nLEFT, 1, 6\n"


@pytest.mark.parametrize("kind", ["S4", "S8"])
def test_edge_load_by_nodal_thickness(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """A force of 0.3 per length on an edge of 0.5 away from the support: 0.15, inward; CalculiX has its opposite times the thickness."""
    deck = plate(kind, ", NODAL THICKNESS", "*NODAL THICKNESS\nN, .04\n") + "*STEP\n*STATIC\n*DLOAD\n3, EDNOR1, .3\n*NODE PRINT, NSET=LEFT, TOTALS=ONLY\nRF\n*END STEP\n"
    ours, theirs = (blocks[0].rows[(1,)] for blocks in tables_by_both(run_deck, tmp_path, deck))
    assert ours == pytest.approx([0.0, -0.15, 0.0], abs=1e-9)
    assert theirs == pytest.approx([0.0, 0.15 * 0.04, 0.0], abs=1e-6)


def test_energy_of_one_point(run_deck: Run, tmp_path: Path) -> None:
    """The energy of bent S4R is half the work of the load; CalculiX leaves that of the hourglass stiffness out, nearly all."""
    deck = plate("S4R") + "*STEP\n*STATIC\n*CLOAD\nTIP, 3, .01\n*NODE PRINT, NSET=TIP\nU\n*EL PRINT, ELSET=E, TOTALS=ONLY\nELSE\n*END STEP\n"
    ours, theirs = tables_by_both(run_deck, tmp_path, deck)
    work = [0.5 * 0.01 * next(iter(blocks[0].rows.values()))[2] for blocks in (ours, theirs)]
    assert work[0] == pytest.approx(work[1], rel=1e-5)
    assert ours[1].rows[(1,)] == pytest.approx([work[0]], rel=1e-5)
    assert theirs[1].rows[(1,)][0] < 0.1 * work[1]
