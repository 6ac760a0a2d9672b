"""Composite shells of the calculix dialect against CalculiX itself (ccx), where it is installed.

CalculiX has one solid through all layers, Amontons one for each: shear strain differs between layers here. Displacements of thin laminates agree within 1 % of
the largest.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from verify.decks.shells import held, shell
from verify.peers.test_mixed_decks import run_peer
from verify.readers.dat_frd_files import compare_block, read_dat

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")

PLY = """*MATERIAL, NAME=M
*ELASTIC, TYPE=ENGINEERING CONSTANTS
250000., 10000., 10000., .25, .25, .25, 5000., 5000.
2000.
*ORIENTATION, NAME=O0
1., 0., 0., 0., 1., 0.
*ORIENTATION, NAME=O90
0., 1., 0., -1., 0., 0.
*ORIENTATION, NAME=O45
1., 1., 0., -1., 1., 0.
"""


@pytest.mark.parametrize("kind", ["S8R", "S6"])
@pytest.mark.parametrize("plies", [("O0", "O90"), ("O45", "O0", "O90")])
def test_cantilever(run_deck: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path, kind: str, plies: tuple[str, ...]) -> None:
    """An unsymmetric strip: deflection, stretch and twist."""
    body = shell(kind, (10, 2), lambda u, v: (10 * u, 2 * v, 0 * u))
    section = "*SHELL SECTION, ELSET=E, COMPOSITE\n" + "".join(f".05, , M, {name}\n" for name in plies)
    load = "*CLOAD\n" + "".join(f"{i + 1}, 3, {-0.01 * w:.15g}\n" for i, w in body.edge_weights(0, 1.0).items())
    deck = body.cards() + PLY + section + held(body.where(0, 0.0), "1, 6") + f"*STEP\n*STATIC\n{load}*NODE PRINT, NSET=N\nU\n*END STEP\n"
    done = run_deck(deck, "--dialect=calculix")
    assert done.returncode == 0, done.stdout + done.stderr
    (tmp_path / "ccx").mkdir()
    (tmp_path / "ccx" / "job.inp").write_text(deck)
    run_peer(tmp_path / "ccx")
    ours, theirs = (read_dat(folder / "job.dat")[0] for folder in (tmp_path, tmp_path / "ccx"))
    assert compare_block(ours, theirs).deviation <= 0.01, "1 % of the largest displacement: transverse shear differs"
