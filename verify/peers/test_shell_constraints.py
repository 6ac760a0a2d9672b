"""Constraints of nodes of shells and beams against CalculiX itself (ccx), where it is installed: rigid bodies, couplings of nodes, equations.

CalculiX ties the mean of bottom and top of a shell, or of the corners of a beam, to the node: constraints bind displacements, not
rotations. The constrained nodes of S6, S8 and S8R are printed there by Simpson's rule over the thickness (0.6 % of a pull in the plane),
here as the constraint moves them; reference node, rotation node and stresses are compared.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from verify.decks.beams import beam, rectangle
from verify.decks.shells import Shell, held, section, shell
from verify.peers.test_mixed_decks import run_peer
from verify.readers.dat_frd_files import Block, compare_block, read_dat

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")

Run = Callable[..., subprocess.CompletedProcess[str]]
LENGTH, WIDTH, THICK = 10.0, 4.0, 0.4
KINDS = ["S3", "S4", "S6", "S8", "S8R"]
ALLOWED = {"displacements": 1e-6, "stresses": 1e-6}  # of the largest of a block: .dat files have seven digits
STABILIZED = {"displacements": 2e-6, "stresses": 6e-5}  # S8R has a stabilization that CalculiX has not (test_composite_shells.py)
ZERO = 1e-9  # of the plate's thickness: what is left of a displacement of zero
REFERENCE = "*NODE, NSET=REF\n9001, {x}, 2., 0.\n*NODE, NSET=ROT\n9002, {x}, 2., 0.\n"
LOADS = {"force": "9001, 3, 10.\n", "pull": "9001, 1, 1000.\n9001, 2, 10.\n", "bending": "9002, 2, -50.\n", "torsion": "9002, 1, 50.\n"}
PRINT = "*NODE PRINT, NSET=REF\nU\n*NODE PRINT, NSET=ROT\nU\n*EL PRINT, ELSET=E\nS\n*END STEP\n"


def plate(kind: str) -> Shell:
    """A cantilever of 8 x 3 cells."""
    return shell(kind, (8, 3), lambda u, v: (LENGTH * u, WIDTH * v, 0 * u))


def rows(nodes: list[int]) -> str:
    """Nodes, one a line."""
    return "".join(f"{i + 1},\n" for i in nodes)


def assert_like_peer(run_deck: Run, folder: Path, deck: str, allowed: dict[str, float]) -> list[Block]:
    """All blocks of CalculiX; ours are returned."""
    (folder / "job.inp").write_text(deck)
    run_peer(folder)
    reference = read_dat(folder / "job.dat")
    done = run_deck(deck, "--dialect=calculix")
    assert done.returncode == 0, done.stdout + done.stderr
    ours = read_dat(folder / "job.dat")
    assert [block.name for block in ours] == [block.name for block in reference]
    for mine, theirs in zip(ours, reference, strict=True):
        if max(mine.largest, theirs.largest) < ZERO * THICK:
            continue
        found = compare_block(mine, theirs)
        assert found.deviation <= allowed[theirs.title], f"{theirs.title} of {theirs.set_name}: {found.deviation:.1e} at {found.where}"
    return ours


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("kind", KINDS)
def test_rigid_patch(run_deck: Run, tmp_path: Path, kind: str, load: str) -> None:
    """NSET binds the displacements of a patch; its border may turn. The patch clamped would move by 0.6 to 6 % less."""
    body = plate(kind)
    patch = [i for i in range(len(body.nodes)) if body.uv[i, 0] > 0.75 - 1e-9]
    deck = body.cards() + section(2.1e5, 0.3, THICK) + REFERENCE.format(x=11.0) + f"*NSET, NSET=R\n{rows(patch)}"
    deck += f"*RIGID BODY, NSET=R, REF NODE=9001, ROT NODE=9002\n{held(body.where(0, 0.0), '1, 6')}*STEP\n*STATIC\n*CLOAD\n{LOADS[load]}{PRINT}"
    assert_like_peer(run_deck, tmp_path, deck, STABILIZED if kind == "S8R" else ALLOWED)


@pytest.mark.parametrize("support", ["on the edge", "rotation held"])
@pytest.mark.parametrize("kind", ["S3", "S4", "S8R"])
def test_rigid_edge(run_deck: Run, tmp_path: Path, kind: str, support: str) -> None:
    """An edge is a hinge, as in CalculiX: with a reference node on it under a force, or with a held rotation 1000 from it."""
    body = plate(kind)
    deck = body.cards() + section(2.1e5, 0.3, THICK) + REFERENCE.format(x=10.0 if support == "on the edge" else 1010.0)
    deck += f"*NSET, NSET=R\n{rows(body.where(0, 1.0))}*RIGID BODY, NSET=R, REF NODE=9001, ROT NODE=9002\n{held(body.where(0, 0.0), '1, 6')}"
    if support == "rotation held":
        deck += "*BOUNDARY\n9002, 1, 3\n"
    deck += f"*STEP\n*STATIC\n*CLOAD\n9001, 3, 10.\n{PRINT}"
    assert_like_peer(run_deck, tmp_path, deck, STABILIZED if kind == "S8R" else ALLOWED)


@pytest.mark.parametrize("load", ["force", "pull", "bending"])
@pytest.mark.parametrize("kind", ["B31", "B32", "B32R"])
def test_rigid_end_of_a_beam(run_deck: Run, tmp_path: Path, kind: str, load: str) -> None:
    """The last five nodes of a beam: the first of them is a hinge."""
    count = 11 if kind == "B31" else 21
    deck = beam(kind, rectangle(0.4, 0.6)) + REFERENCE.format(x=11.0).replace(" 2.,", " 0.,")
    deck += f"*NSET, NSET=R\n{rows(list(range(count - 5, count)))}*RIGID BODY, NSET=R, REF NODE=9001, ROT NODE=9002\n*BOUNDARY\n1, 1, 6\n"
    deck += f"*STEP\n*STATIC\n*CLOAD\n{LOADS[load]}{PRINT}"
    assert_like_peer(run_deck, tmp_path, deck, ALLOWED)


@pytest.mark.parametrize("load", ["9001, 3, 10.\n", "9001, 5, -50.\n"])
@pytest.mark.parametrize("kind", KINDS)
def test_coupling_of_nodes(run_deck: Run, tmp_path: Path, kind: str, load: str) -> None:
    """KINEMATIC of a surface of nodes."""
    body = plate(kind)
    patch = [i for i in range(len(body.nodes)) if body.uv[i, 0] > 0.75 - 1e-9]
    deck = body.cards() + section(2.1e5, 0.3, THICK) + REFERENCE.format(x=11.0) + f"*SURFACE, NAME=S, TYPE=NODE\n{rows(patch)}"
    deck += f"*COUPLING, REF NODE=9001, SURFACE=S, CONSTRAINT NAME=C\n*KINEMATIC\n1, 3\n{held(body.where(0, 0.0), '1, 6')}*STEP\n*STATIC\n*CLOAD\n{load}"
    deck += PRINT.replace("*NODE PRINT, NSET=ROT\nU\n", "")
    assert_like_peer(run_deck, tmp_path, deck, STABILIZED if kind == "S8R" else ALLOWED)


@pytest.mark.parametrize("kind", KINDS)
def test_equations_between_plates(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """Two plates whose edges move alike; by Simpson's rule stresses beside them would differ by 1e-2 of the largest."""
    first, n = plate(kind), 1000
    deck = first.cards() + "*NODE\n" + "".join(f"{n + i + 1}, {x + LENGTH + 1:.15g}, {y:.15g}, {z:.15g}\n" for i, (x, y, z) in enumerate(first.nodes))
    deck += f"*ELEMENT, TYPE={kind}, ELSET=E\n" + "".join(f"{n + e + 1}, {', '.join(str(n + i + 1) for i in nodes)}\n" for e, nodes in enumerate(first.elements))
    deck += section(2.1e5, 0.3, THICK) + "*EQUATION\n"
    for left, right in zip(first.where(0, 1.0), first.where(0, 0.0), strict=True):
        deck += "".join(f"2\n{n + right + 1}, {k}, 1., {left + 1}, {k}, -1.\n" for k in (1, 2, 3))
    deck += held(first.where(0, 0.0), "1, 6") + held([n + i for i in first.where(0, 1.0)], "1, 3")
    deck += f"*NSET, NSET=REF\n{first.at(1.0, 0.5) + 1}\n*STEP\n*STATIC\n*CLOAD\nREF, 3, 30.\n{PRINT}".replace("*NODE PRINT, NSET=ROT\nU\n", "")
    assert_like_peer(run_deck, tmp_path, deck, {"displacements": 1e-5, "stresses": 6e-5 if kind == "S8R" else 1e-6})


@pytest.mark.parametrize("kind", ["S4", "S8R"])
def test_turned_edge_of_a_plate_that_could_yield(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """Without NLGEOM a moment below the yield moment bends a plate as if it could not yield.

    With *PLASTIC the step iterates, and CalculiX turns the edge by a finite angle (0.056 here) while its strains are linear: 0.3 % less.
    """
    body = plate(kind)
    shares = body.edge_weights(0, 1.0)
    tips = []
    for flow in ("", "*PLASTIC\n250., 0.\n350., .1\n"):
        text = body.cards() + section(210000.0, 0.3, THICK).replace("*SHELL", flow + "*SHELL") + held(body.where(0, 0.0), "1, 6")
        text += "*STEP\n*STATIC\n*CLOAD\n" + "".join(f"{n + 1}, 5, {-26 * share}\n" for n, share in shares.items())
        text += "*NODE PRINT, NSET=N\nU\n*END STEP\n"
        for folder in (tmp_path / f"{len(tips)}",):
            folder.mkdir()
            (folder / "job.inp").write_text(text)
            run_peer(folder)
        done = run_deck(text, "--dialect=calculix")
        assert done.returncode == 0, done.stdout + done.stderr
        tip = body.at(1.0, 0.5) + 1
        tips += [read_dat(path / "job.dat")[-1].rows[(tip,)][2] for path in (tmp_path, folder)]
    ours, theirs, ours_flow, theirs_flow = tips
    assert theirs == pytest.approx(ours, rel=1e-5)
    assert ours_flow == pytest.approx(ours, rel=1e-4)
    assert 1.002 < ours / theirs_flow < 1.005
