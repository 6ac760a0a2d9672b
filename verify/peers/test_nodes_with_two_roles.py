"""Nodes that carry loads and are bound as well: forces and displacements against closed forms, and what CalculiX (ccx) gives instead.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.decks.feature_decks import bodies, sections, step
from verify.decks.parts import Part
from verify.decks.solids import unit_cube
from verify.peers.test_mixed_decks import tables_by_both
from verify.readers.dat_frd_files import Block

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")

Run = Callable[..., subprocess.CompletedProcess[str]]
STEEL = "*MATERIAL, NAME=EL\n*ELASTIC\n10000., .3\n"
CUBE = unit_cube() + STEEL + "*SOLID SECTION, ELSET=E, MATERIAL=EL\n*BOUNDARY\nLOW, 1, 3\n"


def row(blocks: list[Block], title: str, node: int = 1, set_name: str = "", time: float = 1.0) -> list[float]:
    """The numbers of a node in the table of a title, a set and a time."""
    return next(b.rows[(node,)] for b in blocks if b.title == title and set_name in ("", b.set_name) and b.time == time)


@pytest.mark.parametrize("load", ["*DLOAD\nE, P2, 8.\n", "*CLOAD\n5, 3, -2.\n6, 3, -2.\n7, 3, -2.\n8, 3, -2.\n"])
def test_held_node_of_a_loaded_rigid_body(run_deck: Run, tmp_path: Path, load: str) -> None:
    """Nothing moves: the held reference node carries the load of its body, 8. CalculiX adds the load to the force of the support: 0."""
    deck = CUBE + "*NODE, NSET=REF\n901, .5, .5, 1.\n902, .5, .5, 1.\n*RIGID BODY, NSET=HIGH, REF NODE=901, ROT NODE=902\n*BOUNDARY\n901, 1, 3\n902, 1, 3\n"
    ours, theirs = tables_by_both(run_deck, tmp_path, deck + step(load + "*NODE PRINT, NSET=REF\nRF\n"))
    assert row(ours, "forces", 901) == pytest.approx([0.0, 0.0, 8.0], abs=1e-9)
    assert row(theirs, "forces", 901) == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)


def test_load_on_a_node_of_a_distributing_surface(run_deck: Run, tmp_path: Path) -> None:
    """A force of 4 along x at the reference node; in the next step one of 1 at a node of the face: 5 in all. In CalculiX it takes the place
    of that node's quarter of the first: 4."""
    deck = CUBE + "*SURFACE, NAME=TOP\nE, S2\n*NODE, NSET=REF\n901, .5, .5, 1.\n*COUPLING, REF NODE=901, SURFACE=TOP, CONSTRAINT NAME=C\n*DISTRIBUTING\n"
    out = "*NODE PRINT, NSET=LOW, TOTALS=ONLY\nRF\n"
    steps = step("*CLOAD\n901, 1, 4.\n" + out) + step("*CLOAD\n7, 1, 1.\n" + out)
    ours, theirs = tables_by_both(run_deck, tmp_path, deck + steps)
    for blocks, sums in ((ours, (-4.0, -5.0)), (theirs, (-4.0, -4.0))):
        assert [row(blocks, "total force", time=float(n))[0] for n in (1, 2)] == pytest.approx(sums)


def test_load_where_a_truss_meets_a_solid(run_deck: Run, tmp_path: Path) -> None:
    """The force at a free node is its load, 5; CalculiX prints what the truss carries of it."""
    deck = CUBE + "*NODE, NSET=FAR\n901, 1., 1., 2.\n*BOUNDARY\n901, 1, 3\n*ELEMENT, TYPE=T3D2, ELSET=T\n9, 7, 901\n*SOLID SECTION, ELSET=T, MATERIAL=EL\n.02\n"
    out = "*NODE PRINT, NSET=HIGH\nU, RF\n*NODE PRINT, NSET=FAR\nRF\n"
    ours, theirs = tables_by_both(run_deck, tmp_path, deck + step("*CLOAD\n7, 3, 5.\n" + out))
    held = 10000.0 * 0.02 * row(ours, "displacements", 7)[2]
    assert held == pytest.approx(200.0 * row(theirs, "displacements", 7)[2], rel=1e-5)
    assert row(ours, "forces", 7, "HIGH") == pytest.approx([0.0, 0.0, 5.0], abs=1e-9)
    assert row(theirs, "forces", 7, "HIGH")[2] == pytest.approx(held, rel=1e-5)


def test_tied_middles_of_plane_elements(run_deck: Run, tmp_path: Path) -> None:
    """Every slave node moves with the face that it is on; CalculiX drops the ties of the middles, with a warning."""
    a, b = Part("A", "CPE8", (0, 0), (2, 1), (3, 2)), Part("B", "CPE8", (0.2, 1), (1.8, 1.8), (2, 2), 1001)
    deck = bodies(a, b) + STEEL + sections("A", "B", rest="1.\n") + "*TIE, NAME=T\nB_Y0, A_Y1\n*BOUNDARY\nA_Y0N, 1, 2\n"
    far = b.label((1.8, 1.8))
    ours, theirs = tables_by_both(run_deck, tmp_path, deck + step(f"*CLOAD\n{far}, 1, 3.\n*NODE PRINT, NSET=NALL\nU\n"))

    def apart(blocks: list[Block]) -> float:
        """The largest distance of a middle of the slaves from the master, whose sides are parabolas."""
        u = {n: np.array(row(blocks, "displacements", n)[:2]) for part in (a, b) for n in part.nodes_on("Y0") + part.nodes_on("Y1")}
        result = 0.0
        for n in b.nodes_on("Y0"):
            x = b.nodes[n - 1001][0]
            cell = min(int(x / (2 / 3)), 2)
            s = x / (2 / 3) - cell
            ends = [a.label(((cell + t) * 2 / 3, 1.0)) for t in (0.0, 0.5, 1.0)]
            shares = [(1 - s) * (1 - 2 * s), 4 * s * (1 - s), s * (2 * s - 1)]
            result = max(result, float(np.abs(u[n] - sum(w * u[m] for w, m in zip(shares, ends, strict=True))).max()))
        return result

    largest = max(abs(v) for v in row(ours, "displacements", far)[:2])
    assert apart(ours) < 1e-5 * largest
    assert apart(theirs) > 0.05 * largest
