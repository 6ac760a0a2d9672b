"""Elastic laws that CalculiX takes by the name of the material, against CalculiX itself (ccx), where it is installed: a thin sheet
that wrinkles under shear, a cantilever of cracked concrete with a sheet of steel in it, and sheared cubes of the other laws.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.decks.make_decks import block
from verify.decks.shells import held, shell
from verify.decks.sheets import between
from verify.decks.solids import as_kind, node_set
from verify.peers.test_mixed_decks import run_both, run_peer
from verify.readers.dat_frd_files import read_dat

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")

RunDeck = Callable[..., subprocess.CompletedProcess[str]]
SIZE, THICKNESS = 0.2, 25e-6
CONCRETE_AND_STEEL = """*MATERIAL, NAME=COMPRESSION_ONLY
*USER MATERIAL, CONSTANTS=2
1.4e10, 1e4
*DENSITY
2350.
*MATERIAL, NAME=STEEL
*ELASTIC
2.1e11, 0.3
*DENSITY
7800.
"""


def step_of(weights: str) -> str:
    """Dead weight in one increment; the free end is printed."""
    return f"*STEP\n*STATIC\n1., 1.\n*DLOAD\n{weights}*NODE PRINT, NSET=END\nU\n*END STEP\n"


def by_both(run_deck: RunDeck, folder: Path, deck: str) -> tuple[dict[tuple[int, ...], list[float]], dict[tuple[int, ...],
list[float]]]:
    """The rows of the last table of Amontons and of CalculiX."""
    run_both(run_deck, folder, deck)
    ours, theirs = (read_dat(place / "job.dat")[-1].rows for place in (folder, folder / "ccx"))
    return ours, theirs


@pytest.mark.parametrize("step", ["*STEP, INC=1000", "*STEP, NLGEOM, INC=1000"])
def test_wrinkled_sheet(run_deck: RunDeck, tmp_path: Path, step: str) -> None:
    """A square of foil, 8000 times as long as thick, held flat and sheared: both programs give the force of the tension field."""
    body = shell("S8R", (6, 6), lambda u, v: (SIZE * u, SIZE * v, 0 * u))
    sets = "".join(f"*NSET, NSET={name}\n" + "".join(f"{i + 1},\n" for i in body.where(1, y)) for name, y in (("LOW", 0.0), ("HIGH", 1.0)))
    law = f"*MATERIAL, NAME=TENSION_ONLY_FOIL\n*USER MATERIAL, CONSTANTS=2\n3.44e9, 1e3\n*SHELL SECTION, ELSET=E, MATERIAL=TENSION_ONLY_FOIL\n{THICKNESS:g}\n"
    deck = body.cards() + sets + law + held(list(range(len(body.nodes))), "3") + f"*BOUNDARY\nLOW, 1, 2\n{step}\n*STATIC\n.1, 1.\n"
    deck += "*BOUNDARY\nHIGH, 1, 1, 1e-3\nHIGH, 2, 2, 1e-5\n*NODE PRINT, NSET=LOW, TOTALS=ONLY\nRF\n*END STEP\n"
    ours, theirs = (next(iter(rows.values())) for rows in by_both(run_deck, tmp_path, deck))
    assert min(-ours[0], -ours[1]) > 1.0
    assert ours[:2] == pytest.approx(theirs[:2], rel=1e-5)


def test_cracked_cantilever(run_deck: RunDeck, tmp_path: Path) -> None:
    """Both programs give the same deflection of solids, and of a composite shell, which is 11 % stiffer. Theory of cracked sections: q L^4/(8 EI) = 2.29e-4, and shear."""
    heights = np.concatenate([between(0.0, 0.09, 3), between(0.09, 0.1, 1)[1:], between(0.1, 0.2, 3)[1:]])
    body = as_kind(block(between(0, 1, 20), np.array([0.0, 0.1]), heights, "BODY"), "C3D20R")
    middles = body.nodes[body.elements[:, :8], 2].mean(axis=1)
    is_steel = (middles > 0.09) & (middles < 0.1)
    sets = "".join(f"*ELSET, ELSET={name}\n" + "".join(f"{e + 1},\n" for e in np.flatnonzero(which)) for name, which in (("S", is_steel), ("C", ~is_steel)))
    sections = "*SOLID SECTION, ELSET=C, MATERIAL=COMPRESSION_ONLY\n*SOLID SECTION, ELSET=S, MATERIAL=STEEL\n"
    deck = body.cards() + sets + node_set("END", body.where(0, 1.0)) + CONCRETE_AND_STEEL + sections + held(list(body.where(0, 0.0)), "1, 3")
    ours, theirs = by_both(run_deck, tmp_path, deck + step_of("C, GRAV, 9.81, 0., 0., -1.\nS, GRAV, 9.81, 0., 0., -1.\n"))
    for node, u in theirs.items():
        assert ours[node] == pytest.approx(u, rel=1e-4, abs=1e-9)
    deflection = theirs[next(iter(theirs))][2]
    plate = shell("S8R", (10, 1), lambda u, v: (u, 0.1 * v, 0 * u))
    layers = "*SHELL SECTION, ELSET=E, COMPOSITE\n.09,, COMPRESSION_ONLY\n.01,, STEEL\n.1,, COMPRESSION_ONLY\n"
    deck = plate.cards() + node_set("END", plate.where(0, 1.0)) + CONCRETE_AND_STEEL + layers + held(plate.where(0, 0.0), "1, 6")
    done = run_deck(deck + step_of("E, GRAV, 9.81, 0., 0., -1.\n"), "--dialect=calculix")
    assert done.returncode == 0, done.stdout + done.stderr
    (tmp_path / "ccx" / "job.inp").write_text(deck + step_of("E, GRAV, 9.81, 0., 0., -1.\n"))
    run_peer(tmp_path / "ccx")
    ours, theirs = (read_dat(place / "job.dat")[-1].rows for place in (tmp_path, tmp_path / "ccx"))
    for node, u in theirs.items():
        assert ours[node] == pytest.approx(u, rel=1e-4, abs=1e-9)
    assert ours[next(iter(theirs))][2] == pytest.approx(0.89 * deflection, rel=0.02), "one parabola through concrete and steel is stiffer than solids"


@pytest.mark.parametrize(
    ("name", "constants"),
    [
        ("CIARLET_EL", ["210000., 0.3"]),
        ("LIN_ISO_EL_STEEL", ["210000., 0.3"]),
        ("ELASTIC_FIBER", ["1.9, 0.026, 0.8, 0., 2.4, 0.8, -.6, .5", "3., 0.4"]),
    ],
)
@pytest.mark.parametrize("step", ["*STEP", "*STEP, NLGEOM"])
def test_sheared_cube(run_deck: RunDeck, tmp_path: Path, name: str, constants: list[str], step: str) -> None:
    """Cubes whose lower side is held and whose upper side is moved along and across, in turned axes of the material: displacements
    and forces agree as they are printed."""
    body = as_kind(block(between(0, 1, 2), between(0, 1, 2), between(0, 1, 2), "BODY"), "C3D20R")
    low, high = body.where(2, 0.0), body.where(2, 1.0)
    number = sum(line.count(",") + 1 for line in constants)
    deck = body.cards() + node_set("LOW", low) + node_set("HIGH", high) + f"*MATERIAL, NAME={name}\n*USER MATERIAL, CONSTANTS={number}\n"
    deck += "\n".join(constants) + f"\n*ORIENTATION, NAME=TURNED\n0.8, 0.6, 0., -0.6, 0.8, 0.\n*SOLID SECTION, ELSET=ALL, MATERIAL={name}, ORIENTATION=TURNED\n"
    deck += f"*BOUNDARY\nLOW, 1, 3\n{step}\n*STATIC\n.25, 1.\n*BOUNDARY\nHIGH, 1, 1, 0.2\nHIGH, 2, 2, -0.1\nHIGH, 3, 3, 0.1\n"
    ours, theirs = by_both(run_deck, tmp_path, deck + "*NODE PRINT, NSET=HIGH\nRF\n*END STEP\n")
    largest = max(abs(f) for row in theirs.values() for f in row)
    for node, force in theirs.items():
        assert ours[node] == pytest.approx(force, rel=0, abs=1e-5 * largest)
