"""MORTAR against CalculiX itself (ccx), where it is installed: increments of several sizes, and what nodes show.

A beam of C3D8I, held at one end and across, is bent over the edge of a block without friction: an elastic job, whose end does not depend on the path.
CalculiX makes integrals and normals once an increment; its end comes nearer to ours with smaller increments.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from verify.decks.feature_decks import STEEL, bodies, sections
from verify.decks.parts import Part
from verify.peers.test_mixed_decks import run_peer
from verify.readers.dat_frd_files import read_frd
from verify.readers.sta_cvg_files import read_cvg, read_sta

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")


def bent(n: int, kind: str = "C3D8I", cells: int = 6, tip: float = -1.0, across: str = "BN, 2, 2\n") -> str:
    """The deck in n increments of one size; a beam of so many elements."""
    beam = Part("B", kind, (0, 0, 0.1), (10, 1, 0.6), (cells, 1, 1), 1001)
    base = Part("A", kind, (6, -0.2, -1), (9, 1.3, 0), (4, 2, 2))
    return (
        bodies(base, beam) + STEEL + sections("A", "B")
        + "*SURFACE INTERACTION, NAME=SI\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.E6\n*CONTACT PAIR, INTERACTION=SI, TYPE=MORTAR\nB_Z0, A_Z1\n"
        + f"*BOUNDARY\nA_Z0N, 1, 3\nB_X0N, 1, 3\n{across}*STEP, NLGEOM\n*STATIC\n{1 / n}, 1., 1.E-6, {1 / n}\n"
        + f"*BOUNDARY\nB_X1N, 3, 3, {tip}\n*NODE FILE\nU\n*END STEP\n"
    )


def end_of(folder: Path) -> tuple[float, int]:
    """The largest displacement of the beam along itself at the end, and the iterations of all increments."""
    fields = [block for block in read_frd(folder / "job.frd") if block.title.startswith("DISP")]
    iterations = sum(attempt.iterations for attempt in read_sta(folder / "job.sta"))
    return max(abs(row[0]) for (node, *_), row in fields[-1].rows.items() if node > 1000), iterations


def test_end_does_not_depend_on_increments(run: Callable, tmp_path: Path) -> None:
    """Ours is the same in 1, 4, 20 and 50 increments; CalculiX's is far off in 1 and near with 20 and 50, in more iterations."""
    ours, theirs = {}, {}
    for n in (1, 4, 20, 50):
        for side, ends in (("ours", ours), ("theirs", theirs)):
            folder = tmp_path / f"{side}{n}"
            folder.mkdir()
            (folder / "job.inp").write_text(bent(n))
            if side == "theirs":
                run_peer(folder)
            else:
                done = run(["--dialect=calculix", "job"], cwd=folder)
                assert done.returncode == 0, done.stdout + done.stderr
            ends[n] = end_of(folder)
    print(ours, theirs)
    for n, (end, iterations) in ours.items():
        assert end == pytest.approx(ours[50][0], rel=2e-3), n
        assert iterations < theirs[n][1], n
    assert abs(theirs[1][0] - ours[1][0]) > 0.5 * ours[1][0]
    assert theirs[20][0] == pytest.approx(ours[20][0], rel=0.02)
    assert theirs[50][0] == pytest.approx(ours[50][0], rel=0.02)


FREE = [("C3D10", 9, -0.5), ("C3D8", 6, -1.0), ("C3D8I", 6, -1.0), ("C3D20", 5, -0.5), ("C3D10", 6, -1.0), ("C3D8", 9, -1.0)]
"""Beams that are free across, and where their tips go."""


@pytest.mark.parametrize(("kind", "cells", "tip"), FREE)
def test_free_across(kind: str, cells: int, tip: float, run: Callable, tmp_path: Path) -> None:
    """A beam without lateral support becomes unstable during the step: the job ends with default settings nevertheless, in at most 8 iterations for
    each requested increment. As long as it is stable it goes where CalculiX goes in small increments, within 2 %. (Not of C3D10: there the beam is 0.015 deep in
    the block's edge in CalculiX, 0.001 in Amontons.) Of the beam of 9 C3D8 that is bent by 1 the iterations are no measure: its nodes run off the block, it snaps
    through, and how many attempts an increment takes there is decided by the ninth digit of the load: 24 to 109 iterations. (6 C3D10 take 50 to 55.)
    """
    deck = bent(10, kind, cells, tip, "")
    (tmp_path / "job.inp").write_text(deck.replace("0.1, 1., 1.E-6, 0.1", "0.1, 1."))
    done = run(["--dialect=calculix", "job"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = read_cvg(tmp_path / "job.cvg")
    print(kind, cells, tip, len(rows), "iterations in", rows[-1].increment, "increments")
    assert len(rows) <= 80 or (kind, cells) == ("C3D8", 9)
    if kind == "C3D10":
        return
    ends = []
    for side, n in (("ours", 3), ("theirs", 15)):
        folder = tmp_path / side
        folder.mkdir()
        (folder / "job.inp").write_text(bent(n, kind, cells, 0.3 * tip, ""))
        if side == "theirs":
            run_peer(folder)
        else:
            done = run(["--dialect=calculix", "job"], cwd=folder)
            assert done.returncode == 0, done.stdout + done.stderr
        ends.append([block for block in read_frd(folder / "job.frd") if block.title.startswith("DISP")][-1].rows)
    ours, theirs = ends
    for node, row in theirs.items():
        assert ours[node][:3] == pytest.approx(row[:3], abs=-0.02 * 0.3 * tip), node


@pytest.mark.parametrize(("kind", "cells", "tip"), [("C3D8", 9, -1.0), ("C3D8", 9, -1.000000001), ("C3D8", 9, -0.99), ("C3D8", 9, -1.01), ("C3D8I", 8, -1.0), ("C3D8I", 8, -0.99)])
def test_slides_off(kind: str, cells: int, tip: float, run: Callable, tmp_path: Path) -> None:
    """A beam that slides off the block sideways comes to the end: its forces fade as its faces leave the block, and none jumps."""
    (tmp_path / "job.inp").write_text(bent(10, kind, cells, tip, "").replace("0.1, 1., 1.E-6, 0.1", "0.1, 1."))
    done = run(["--dialect=calculix", "job"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("kind", ["C3D8", "C3D20"])
def test_pressure_at_nodes(kind: str, run: Callable, tmp_path: Path) -> None:
    """Pressure and friction of MORTAR in .frd, which the faces of eight nodes have by transformed functions: those of CalculiX.

    Within 1 %: CalculiX ends its iterations at 0.5 % of a mean force; meshes match.
    """
    base = Part("A", kind, (0, 0, -1), (1, 1, 0), (2, 2, 1))
    top = Part("B", kind, (0, 0, 0), (1, 1, 0.5), (2, 2, 1), 1001)
    deck = (
        bodies(base, top) + STEEL + sections("A", "B")
        + "*SURFACE INTERACTION, NAME=SI\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.E6\n*FRICTION\n0.3, 1.E5\n"
        + "*CONTACT PAIR, INTERACTION=SI, TYPE=MORTAR\nB_Z0, A_Z1\n*BOUNDARY\nA_Z0N, 1, 3\nB_Z1N, 1, 2\n"
        + "*STEP\n*STATIC\n1., 1.\n*DLOAD\n" + top.dload("Z1", 100.0) + "*NODE FILE\nU\n*CONTACT FILE\nCDIS, CSTR\n*END STEP\n"
    )
    fields = []
    for side in ("ours", "theirs"):
        folder = tmp_path / side
        folder.mkdir()
        (folder / "job.inp").write_text(deck)
        if side == "theirs":
            run_peer(folder)
        else:
            done = run(["--dialect=calculix", "job"], cwd=folder)
            assert done.returncode == 0, done.stdout + done.stderr
        fields += [block.rows for block in read_frd(folder / "job.frd") if block.title == "CONTACT"]
    ours, theirs = fields
    largest = max(row[3] for row in theirs.values())
    assert largest > 100.0
    for node, row in theirs.items():
        assert ours[node][3:] == pytest.approx(row[3:], abs=1e-2 * largest), node
