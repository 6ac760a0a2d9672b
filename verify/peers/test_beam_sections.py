"""Cross-sections of beams in the calculix dialect against CalculiX itself (ccx), where it is installed: displacements and tables of stresses.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.decks.beams import Section, beam, box, circle, pipe
from verify.peers.test_mixed_decks import run_both, run_peer, tables_by_both
from verify.readers.dat_frd_files import compare_block, read_dat, read_frd

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")

NOISE = 1e-9  #: displacements below are rounding

# kind, section, data line of CalculiX, degrees of freedom of the load
CASES = {
    "rect": ("B32", Section("RECT", ".4, .6", 0.24, 0.0, 0.0, 0.0), ""),
    "rect-reduced": ("B32R", Section("RECT", ".4, .6", 0.24, 0.0, 0.0, 0.0), ""),
    "pipe": ("B32R", pipe(0.3, 0.05), ""),
    "box": ("B32R", box(0.6, 0.4, (0.02, 0.04, 0.03, 0.02)), ""),
    "circ": ("B32", circle(0.3), ".6, .6"),
    "circ-reduced": ("B32R", circle(0.3), ".6, .6"),
    "ellipse-reduced": ("B32R", Section("CIRC", "", 0.0, 0.0, 0.0, 0.0), ".6, .4"),
}


@pytest.mark.parametrize("dof", [1, 2, 3, 4])
@pytest.mark.parametrize("name", list(CASES))
def test_cantilever(run_deck: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path, name: str, dof: int) -> None:
    """Stretched, bent about both axes, twisted."""
    kind, section, data = CASES[name]
    deck = beam(kind, section, data, n=5) + "*BOUNDARY\n1, 1, 6\n*STEP\n*STATIC\n*CLOAD\n" + f"END, {dof}, 1.\n"
    deck += "*NODE PRINT, NSET=N\nU\n*EL PRINT, ELSET=E\nS\n*END STEP\n"
    ours, theirs = tables_by_both(run_deck, tmp_path, deck)
    assert [block.title for block in ours] == [block.title for block in theirs]
    for one, other in zip(ours, theirs, strict=True):
        assert len(one.rows) == len(other.rows)
        if other.largest > NOISE:  # under a moment along the beam its nodes do not move
            assert compare_block(one, other).deviation <= 0.01, f"{other.title}: 1 % of the largest value"


@pytest.mark.parametrize(("name", "force"), [("rect-reduced", 0.9), ("circ-reduced", 1.2)])
def test_points_of_reduced_beams(run_deck: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path, name: str, force: float) -> None:
    """B32R of rectangles and circles bends and twists beyond yield at CalculiX's 2 x 5 x 5 points: displacements and tables."""
    kind, section, data = CASES[name]
    deck = beam(kind, section, data, n=3).replace("*DENSITY", "*PLASTIC\n300., 0.\n400., 0.02\n*DENSITY") + "*BOUNDARY\n1, 1, 6\n"
    deck += f"*STEP, INC=100\n*STATIC, DIRECT\n0.25, 1.\n*CLOAD\nEND, 2, {force}\nEND, 3, 0.3\nEND, 4, 2.\n"
    deck += "*NODE PRINT, NSET=N\nU\n*EL PRINT, ELSET=E\nS, PEEQ\n*END STEP\n"
    ours, theirs = tables_by_both(run_deck, tmp_path, deck)
    assert [block.title for block in ours] == [block.title for block in theirs]
    assert any("equivalent plastic" in block.title and block.largest > 2e-4 for block in theirs)
    for one, other in zip(ours, theirs, strict=True):
        assert compare_block(one, other).deviation <= 2e-3, f"{other.title} at {other.time}: stresses differ by terms of second order in the rotation, 7e-4 here"


@pytest.mark.parametrize("steps", ["*BOUNDARY\nEND, 4, 6\n*STEP\n*STATIC\n*CLOAD\nEND, 3, 1.\nEND, 1, 2.\n",
                                   "*STEP\n*STATIC\n*CLOAD\nEND, 3, 1.\nEND, 4, .1\n"], ids=["rotation held", "moment"])
def test_guided_end(run_deck: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path, steps: str) -> None:
    """Where a rotation is prescribed the middles of the sides of the cross-section lie between its corners; under a moment they bulge."""
    deck = beam("B32", CASES["rect"][1], n=2) + "*BOUNDARY\n1, 1, 6\n" + steps + "*NODE PRINT, NSET=N\nU\n*EL PRINT, ELSET=E\nS\n*END STEP\n"
    run_both(run_deck, tmp_path, deck)
    for one, other in zip(read_dat(tmp_path / "job.dat"), read_dat(tmp_path / "ccx" / "job.dat"), strict=True):
        assert compare_block(one, other).deviation <= 1e-5, f"{other.title}: beyond rounding and the printed digits"


@pytest.mark.parametrize("name", ["rect", "rect-reduced", "circ", "circ-reduced", "pipe"])
@pytest.mark.parametrize("held", ["END, 3\n", "END, 1, 3\n", "MIDDLE, 3\n", "MIDDLE, 2, 3\nEND, 1, 2\n"])
def test_hinged(run_deck: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path, held: str, name: str) -> None:
    """A support without rotations holds the mean of the corners of the cross-section; the middles of its sides are free."""
    kind, section, data = CASES[name]
    deck = beam(kind, section, data, n=2) + f"*NSET, NSET=MIDDLE\n3\n*BOUNDARY\n1, 1, 6\n{held}*STEP\n*STATIC\n*CLOAD\n2, 3, 1.\n4, 2, 2.\n4, 1, 3.\n"
    deck += "*NODE PRINT, NSET=N\nU\n*EL PRINT, ELSET=E\nS\n*END STEP\n"
    run_both(run_deck, tmp_path, deck)
    for one, other in zip(read_dat(tmp_path / "job.dat"), read_dat(tmp_path / "ccx" / "job.dat"), strict=True):
        assert compare_block(one, other).deviation <= (2e-3 if name == "pipe" else 1e-4), f"{other.title}: beyond rounding and the printed digits"


def test_pretension(run_deck: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path) -> None:
    """A row of beams with a pre-tension section in one: CalculiX drops this beam, its ends are connected along it alone."""
    section = Section("RECT", ".4, .6", 0.24, 0.0, 0.0, 0.0)
    deck = beam("B31", section, n=10) + "*NODE\n999, 0., 5., 0.\n*PRE-TENSION SECTION, ELEMENT=5, NODE=999\n*BOUNDARY\n1, 1, 6\n11, 1, 6\n"
    deck += "*STEP\n*STATIC\n*CLOAD\n999, 1, 100.\n4, 2, 1.\n8, 3, 2.\n*NODE PRINT, NSET=N\nU\n*END STEP\n"
    ours, theirs = tables_by_both(run_deck, tmp_path, deck)
    assert compare_block(ours[0], theirs[0]).deviation <= 0.01, "1 % of the largest displacement"


TURN = np.array([[0.458905312970806, -0.644217687237691, 0.611873749827591], [0.386530612142214, 0.764842187284488, 0.515374149790153], [-0.8, 0.0, 0.6]])


@pytest.mark.parametrize("held", ["2, 4, 6\n", "2, 5, 5\n", ""], ids=["rotations", "one", "none"])
def test_beam_at_transformed_nodes(run_deck: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path, held: str) -> None:
    """Rotations at nodes with *TRANSFORM are mean rotations about the local axes: the deflection of a beam along them, to CalculiX's digits."""
    places = [TURN @ np.array([0.0, 0.0, z]) for z in (0.0, 4.0)]
    deck = "*NODE, NSET=ALL\n" + "".join(f"{i + 1}, {x:.12g}, {y:.12g}, {z:.12g}\n" for i, (x, y, z) in enumerate(places)) + "*ELEMENT, TYPE=B31, ELSET=B\n1, 1, 2\n"
    deck += "*MATERIAL, NAME=M\n*ELASTIC\n2e5, 0.3\n*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT\n0.8, 0.6\n" + ", ".join(f"{v:.12g}" for v in TURN[:, 0]) + "\n"
    deck += "*TRANSFORM, NSET=ALL\n" + ", ".join(f"{v:.12g}" for v in [*TURN[:, 0], *TURN[:, 1]]) + f"\n*BOUNDARY\n1, 1, 6\n{held}*STEP\n*STATIC\n"
    deck += "*CLOAD\n2, 1, 10.\n2, 2, 7.\n*NODE PRINT, NSET=ALL, GLOBAL=YES\nU\n*END STEP\n"
    folder = tmp_path / "ccx"
    folder.mkdir()
    (folder / "job.inp").write_text(deck.replace("*NODE PRINT, NSET=ALL, GLOBAL=YES\nU", "*NODE FILE, OUTPUT=2D\nU"))
    run_peer(folder)
    theirs = next(table for table in read_frd(folder / "job.frd") if table.title == "DISP").rows[(2,)]
    done = run_deck(deck, "--dialect=calculix")
    assert done.returncode == 0, done.stdout + done.stderr
    ours = read_dat(tmp_path / "job.dat")[0].rows[(2,)]
    assert np.abs(np.subtract(ours, theirs[:3])).max() <= 1e-5 * np.abs(theirs[:3]).max(), (ours, theirs)
