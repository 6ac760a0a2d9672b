"""CalculiX's triangles in plane stress are stiffer than ours, and why: they are wedges that have plane stress in the mean at their nodes.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from verify.peers.test_mixed_decks import run_peer
from verify.readers.dat_frd_files import read_dat

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")

N, M = 8, 2  #: cells along and across the beam
TIP = (N + 1) * (M + 1)
LAW = "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n*SOLID SECTION, ELSET=E, MATERIAL=STEEL\n"


def beam(*, is_wedge: bool) -> str:
    """A cantilever of triangles of thickness 1, or of the wedges that CalculiX makes of them, with a force at a corner."""
    places = [(1 + i + (N + 1) * j, 5.0 * i, 5.0 * j) for j in range(M + 1) for i in range(N + 1)]
    corners = [(a, a + 1, a + N + 2, a + N + 1) for j in range(M) for a in range(1 + (N + 1) * j, 1 + (N + 1) * j + N)]
    triangles = [t for a, b, c, d in corners for t in ((a, b, c), (a, c, d))]
    lines = ["*NODE, NSET=ALL", *(f"{k}, {x}, {y}, {-0.5 if is_wedge else 0.0}" for k, x, y in places)]
    if is_wedge:
        lines += [f"{100 + k}, {x}, {y}, 0.5" for k, x, y in places]
    lines += [f"*ELEMENT, TYPE={'C3D6' if is_wedge else 'CPS3'}, ELSET=E"]
    lines += [", ".join(str(n) for n in (e, *t, *(100 + k for k in t if is_wedge))) for e, t in enumerate(triangles, 1)]
    lines += [LAW.strip()] + ([] if is_wedge else ["1."])
    if is_wedge:  # both sides move alike in the plane and apart across it
        lines += ["*EQUATION"]
        lines += [f"2\n{100 + k}, {d}, 1., {k}, {d}, {s}." for k, _, _ in places for d, s in ((1, -1), (2, -1), (3, 1))]
    held = [f"{k}, 1, 2" for k, x, _ in places if x == 0]
    return "\n".join([*lines, "*BOUNDARY", *held, f"*NSET, NSET=TIP\n{TIP}", "*STEP", "*STATIC", "*CLOAD", f"{TIP}, 2, -10.",
                      "*NODE PRINT, NSET=TIP", "U", "*END STEP", ""])  # fmt: skip


def test_triangles_in_plane_stress(run_deck: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path) -> None:
    """The wedges here give CalculiX's deflection of CPS3 to its seven digits; CPS3 here give a larger one."""
    folder = tmp_path / "ccx"
    folder.mkdir()
    (folder / "job.inp").write_text(beam(is_wedge=False))
    run_peer(folder)
    theirs = read_dat(folder / "job.dat")[0].rows
    deflection = {}
    for is_wedge in (False, True):
        done = run_deck(beam(is_wedge=is_wedge), "--dialect=calculix")
        assert done.returncode == 0, done.stdout + done.stderr
        deflection[is_wedge] = next(iter(read_dat(tmp_path / "job.dat")[0].rows.values()))[1]
    expected = next(iter(theirs.values()))[1]
    assert deflection[True] == pytest.approx(expected, rel=2e-6)
    assert 1.005 < deflection[False] / expected < 1.1
