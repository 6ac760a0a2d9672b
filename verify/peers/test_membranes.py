"""Membranes in the calculix dialect against CalculiX itself (ccx), where it is installed: displacements of sheets in their plane.

CalculiX 2.20 leaves M3D6, M3D4R and M3D8R without stiffness in some motion: held nodes move, or all move without end.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from verify.decks.membranes import membrane, membrane_section
from verify.decks.shells import held
from verify.peers.test_mixed_decks import tables_by_both
from verify.readers.dat_frd_files import compare_block

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")


@pytest.mark.parametrize("kind", ["M3D3", "M3D4", "M3D8"])
def test_sheet(run_deck: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path, kind: str) -> None:
    """Cook's panel, clamped at one side and pulled along the other."""
    mesh = membrane(kind, (6, 6), lambda u, v: (48 * u, 44 * u + v * (44 - 28 * u), 0 * u))
    mesh.kind = "S" + kind[3:]
    loads = "".join(f"{i + 1}, 2, {weight:.15g}\n" for i, weight in mesh.edge_weights(0, 1.0).items())
    mesh.kind = kind
    deck = mesh.cards() + membrane_section("*ELASTIC\n100., 0.3\n", 0.5) + held(mesh.where(0, 0.0), "1, 2") + "*BOUNDARY\nN, 3\n"
    deck += f"*STEP\n*STATIC\n*CLOAD\n{loads}*NODE PRINT, NSET=N\nU\n*END STEP\n"
    ours, theirs = tables_by_both(run_deck, tmp_path, deck)
    assert compare_block(ours[0], theirs[0]).deviation <= 0.01, "1 % of the largest displacement"
