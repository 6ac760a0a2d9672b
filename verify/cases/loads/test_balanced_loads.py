"""Free bodies under balanced loads: the stresses of theory, supports without force, and an error where the loads do not balance.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.cases.proof import Case
from verify.conftest import Run
from verify.decks.make_decks import block
from verify.decks.solids import Solids, as_kind

Proof = Callable[..., Case]
YOUNG, NU, ALPHA, PRESSURE = 2.0e5, 0.3, 1.2e-5, 60.0
SIZE, CELLS = (4.0, 2.0, 1.0), (4, 2, 2)


def free_mesh(kind: str) -> Solids:
    """A block without any support."""
    return as_kind(block(*(np.linspace(0.0, length, n + 1) for length, n in zip(SIZE, CELLS, strict=True)), "BLOCK"), kind)


def free_deck(mesh: Solids, loads: str, nlgeom: str = "") -> str:
    """Its deck; ENDS are the faces x = 0 and x = 4."""
    rows = "".join(f"{i}, " + ", ".join(f"{v:.15g}" for v in x) + "\n" for i, x in enumerate(mesh.nodes, 1))
    cells = ""
    for i, nodes in enumerate(mesh.elements, 1):
        labels = [str(n + 1) for n in nodes]
        cells += f"{i}, " + ",\n".join(", ".join(labels[k : k + 10]) for k in range(0, len(labels), 10)) + "\n"
    ends = "".join(f"{e + 1}, S{f}\n" for x in (0.0, SIZE[0]) for e, f in mesh.outer_faces(mesh.where(0, x)))
    return (
        f"*NODE\n{rows}*ELEMENT, TYPE={mesh.kind}, ELSET=BLOCK\n{cells}*SURFACE, NAME=ENDS\n{ends}*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, {NU}\n"
        f"*EXPANSION\n{ALPHA}\n*SOLID SECTION, ELSET=BLOCK, MATERIAL=M\n*STEP{nlgeom}\n*STATIC\n0.5, 1.\n{loads}*END STEP\n"
    )


@pytest.mark.parametrize("kind", ["C3D8", "C3D10", "C3D20R"])
def test_free_block_under_pressure(proof: Proof, kind: str) -> None:
    """Pressed at both ends, held nowhere."""
    case = proof(
        f"free-block-pressure-{kind.lower()}",
        title=f"A free block pressed at both ends, {kind}",
        model=f"A block 4 x 2 x 1 of {kind}, E = 200 000, nu = 0.3, without any support, a pressure of 60 on both ends.",
        formula="Stress xx = -60, all others zero; the ends approach each other by 60 * 4 / E; no reactions.",
        source="uniaxial stress",
        proves="Loads that do no work on the rigid motions need no supports; the degrees of freedom held in their place carry no force.",
    )
    mesh = free_mesh(kind)
    job = case.run(free_deck(mesh, f"*DSLOAD\nENDS, P, {PRESSURE}\n"))
    exact = np.array([-PRESSURE, 0.0, 0.0, 0.0, 0.0, 0.0])
    stress = np.abs(job.last("S") - exact).max()
    case.within("error of the stress", stress, (0.0, 1e-8 * PRESSURE), why="in the space of the elements", place="all nodes", time="the end")
    u = job.last("U")[:, 0]
    shortening = u[mesh.where(0, 0.0)].mean() - u[mesh.where(0, SIZE[0])].mean()
    case.near("shortening", shortening, PRESSURE * SIZE[0] / YOUNG, 1e-9, why="rounding", place="the ends", time="the end")
    largest = PRESSURE * SIZE[1] * SIZE[2]
    reaction = np.abs(job.last("RF")).max()
    case.within("reactions", reaction, (0.0, 1e-8 * largest), why="rounding of 120", place="all nodes", time="the end")
    case.done()


def test_free_block_in_a_linear_temperature(proof: Proof) -> None:
    """A linear temperature bends a free body without stress."""
    case = proof(
        "free-block-temperature",
        title="A free block with a linear temperature",
        model="A block 4 x 2 x 1 of C3D20R without any support, temperature 100 x - 50 z, alpha = 1.2e-5.",
        formula="No stress at all.",
        source="B. A. Boley, J. H. Weiner, Theory of Thermal Stresses, Wiley 1960: linear temperature in a free simply connected body",
        proves="The supports that replace the missing ones hold the rigid motion only.",
    )
    mesh = free_mesh("C3D20R")
    rows = "".join(f"{i}, {100 * x - 50 * z:.15g}\n" for i, (x, _, z) in enumerate(mesh.nodes, 1))
    job = case.run(free_deck(mesh, f"*TEMPERATURE\n{rows}"))
    stress = YOUNG * ALPHA * 400.0
    for name in ("S", "RF"):
        case.within(f"largest {name}", np.abs(job.last(name)).max(), (0.0, 1e-9 * stress), why="rounding of E alpha 400", place="all nodes", time="the end")
    case.done()


def test_free_block_pulled_by_its_ends(proof: Proof) -> None:
    """Both ends are moved along x; nothing holds the block across, nor its turn about x."""
    case = proof(
        "free-block-pulled",
        title="A free block whose ends are moved apart",
        model="A block 4 x 2 x 1 of C3D8, E = 200 000, nu = 0.3; u_x = -0.001 at one end and 0.003 at the other, no other support.",
        formula="Stress xx = E 0.004 / 4 = 200, all others zero; the supports in place of the missing ones have no reaction.",
        source="uniaxial stress",
        proves="Moved supports load a body like forces: what they leave free needs no support.",
    )
    mesh = free_mesh("C3D8")
    rows = "".join(f"{n + 1}, 1, 1, {-0.001 if x == 0.0 else 0.003}\n" for x in (0.0, SIZE[0]) for n in mesh.where(0, x))
    job = case.run(free_deck(mesh, f"*BOUNDARY\n{rows}"))
    exact = np.array([200.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    stress = np.abs(job.last("S") - exact).max()
    case.within("error of the stress", stress, (0.0, 2e-6), why="rounding of 200", place="all nodes", time="the end")
    across = np.abs(job.last("RF")[:, 1:]).max()
    case.within("reactions across", across, (0.0, 4e-6), why="rounding of 400", place="all nodes", time="the end")
    case.done()


def test_message(run: Run, tmp_path: Path) -> None:
    """One line names the body and the nodes, under NLGEOM too; loads that do not balance are an error as before."""
    mesh = free_mesh("C3D8")
    (tmp_path / "free.inp").write_text(free_deck(mesh, f"*DSLOAD\nENDS, P, {PRESSURE}\n", ", NLGEOM"))
    done = run(["--outdir", tmp_path, tmp_path / "free.inp"], tmp_path)
    assert done.returncode == 0, done.stdout
    assert "The loads on the body of element 1 (set BLOCK, 16 elements) balance each other; node " in done.stdout
    assert "hold its 6 free rigid motions without a force." in done.stdout
    with h5py.File(tmp_path / "free.vtkhdf") as file:
        assert np.abs(np.asarray(file["VTKHDF/PointData/RF"])).max() <= 1e-6 * PRESSURE * SIZE[1] * SIZE[2]
    (tmp_path / "pushed.inp").write_text(free_deck(mesh, f"*DSLOAD\nENDS, P, {PRESSURE}\n*CLOAD\n1, 1, 0.1\n"))
    done = run(["--outdir", tmp_path, tmp_path / "pushed.inp"], tmp_path)
    assert done.returncode == 4 and "can move and turn freely" in done.stdout, done.stdout


def test_a_shell_on_a_hinge(run: Run, tmp_path: Path) -> None:
    """A strip of S4 whose end is held without its rotations, pulled along itself: u = F x / (E A), and it does not turn."""
    length, width, thickness, force = 4.0, 1.0, 0.1, 12.0
    rows = "".join(f"{1 + i + 5 * j}, {length * i / 4}, {width * j}, 0.\n" for j in (0, 1) for i in range(5))
    cells = "".join(f"{i}, {i}, {i + 1}, {i + 6}, {i + 5}\n" for i in range(1, 5))
    (tmp_path / "hinge.inp").write_text(
        f"*NODE\n{rows}*ELEMENT, TYPE=S4, ELSET=STRIP\n{cells}*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, 0.\n"
        f"*SHELL SECTION, ELSET=STRIP, MATERIAL=M\n{thickness}\n*BOUNDARY\n1, 1, 3\n6, 1, 3\n*STEP\n*STATIC\n"
        f"*CLOAD\n5, 1, {force / 2}\n10, 1, {force / 2}\n*END STEP\n"
    )
    done = run(["--outdir", tmp_path, tmp_path / "hinge.inp"], tmp_path)
    assert done.returncode == 0 and "balance each other" in done.stdout, done.stdout
    with h5py.File(tmp_path / "hinge.vtkhdf") as data:
        n = int(data["VTKHDF/NumberOfPoints"][-1])
        x, u = data["VTKHDF/Points"][-n:], data["VTKHDF/PointData/U"][-n:]
    stretch = force / (YOUNG * width * thickness)
    assert np.abs(u[:, 0] - stretch * x[:, 0]).max() < 1e-9 * stretch * length
    assert np.abs(u[:, 1:]).max() < 1e-9 * stretch * length
