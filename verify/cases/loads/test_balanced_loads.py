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


def hinged_strip(holder: str, loads: str, nlgeom: str = "") -> str:
    """A strip of S4R, 10 x 2 x 0.1 and nu = 0, hinged at x = 0; node 900 holds the edge x = 10."""
    rows = "".join(f"{1 + i + 11 * j}, {i}., {j}., 0.\n" for j in range(3) for i in range(11)) + "900, 10., 1., 0.\n"
    cells = "".join(f"{1 + i + 10 * j}, {1 + i + 11 * j}, {2 + i + 11 * j}, {13 + i + 11 * j}, {12 + i + 11 * j}\n" for j in range(2) for i in range(10))
    return (
        f"*NODE\n{rows}*NSET, NSET=FAR\n11, 22, 33\n*ELEMENT, TYPE=S4R, ELSET=STRIP\n{cells}*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, 0.\n"
        f"*SHELL SECTION, ELSET=STRIP, MATERIAL=M\n0.1\n{holder}*BOUNDARY\n1, 1, 3\n12, 1, 3\n23, 1, 3\n*STEP{nlgeom}\n*STATIC\n{loads}*END STEP\n"
    )


HOLDERS = {
    "RIGID BODY": "*RIGID BODY, NSET=FAR, REF NODE=900\n",
    "COUPLING": "*SURFACE, NAME=EDGE, TYPE=NODE\nFAR\n*COUPLING, CONSTRAINT NAME=C, REF NODE=900, SURFACE=EDGE\n*KINEMATIC\n1, 6\n",
}


@pytest.mark.parametrize("holder", HOLDERS)
def test_a_hinged_strip_held_by_a_reference_node(proof: Proof, holder: str) -> None:
    """The reference node takes part in the free turn of the strip, and so does its rotation."""
    case = proof(
        f"hinged-strip-{holder.lower().replace(' ', '-')}",
        title=f"A strip on a hinge whose far edge *{holder} holds",
        model=f"A strip 10 x 2 x 0.1 of 10 x 2 S4R, E = 200 000, nu = 0, hinged along x = 0; the reference node of *{holder} on the edge "
        "x = 10 takes a pull of 12 along x; in a second job a force of 1 along z with a moment of 10 about y.",
        formula="Pull: u = F x / (E A). Force and moment: no work on the turn about the hinge, M(x) = x, so that the deflection is "
        "-(x^3 - 81 x) / (6 E I) from the chord to x = 9, where the support without force holds it.",
        source="Euler-Bernoulli beam; the bending moment of a hinged end",
        proves="What equations couple to a body takes part in its free motions: reference nodes by their displacements, and moments by rotations.",
    )
    stretch = 12.0 / (YOUNG * 0.2)
    job = case.run(hinged_strip(HOLDERS[holder], "*CLOAD\n900, 1, 12.\n"))
    x = job.points[:33]
    error = np.abs(job.last("U")[:33, 0] - stretch * x[:, 0]).max()
    case.within("error of u_x under the pull", error, (0.0, 1e-9 * stretch), why="in the space of the elements", place="nodes of the strip", time="the end")
    job = case.run(hinged_strip(HOLDERS[holder], "*CLOAD\n900, 3, 1.\n900, 5, 10.\n"))
    w = -(x[:, 0] ** 3 - 81 * x[:, 0]) / (6 * YOUNG * 2.0 * 0.1**3 / 12)
    error = np.abs(job.last("U")[:33, 2] - w).max()
    case.within("error of the deflection", error, (0.0, 2e-3 * np.abs(w).max()), why="S4R of length 1, at the nodes", place="nodes of the strip", time="the end")
    case.done()


@pytest.mark.parametrize("holder", HOLDERS)
@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
@pytest.mark.parametrize("load", ["900, 3, 1.", "900, 5, 10.", "900, 3, 1.\n900, 5, 9.9"])
def test_loads_of_a_reference_node_that_turn_the_strip(run: Run, tmp_path: Path, holder: str, nlgeom: str, load: str) -> None:
    """A force or a moment alone works on the free turn about the hinge, and so do both out of balance: refused."""
    (tmp_path / "turned.inp").write_text(hinged_strip(HOLDERS[holder], f"*CLOAD\n{load}\n", nlgeom))
    done = run(["--outdir", tmp_path, tmp_path / "turned.inp"], tmp_path)
    assert done.returncode == 4 and "can turn about y through the point (0, 1, 0)" in done.stdout, done.stdout


@pytest.mark.parametrize("holder", HOLDERS)
def test_loads_that_lose_their_balance_as_the_strip_bends(run: Run, tmp_path: Path, holder: str) -> None:
    """Bent by half of its length, the strip shortens the arm of the force: no support may carry the rest unnoticed."""
    for name, load, code in (("small", 0.3, 0), ("large", 5.0, 5)):
        (tmp_path / f"{name}.inp").write_text(hinged_strip(HOLDERS[holder], f"*CLOAD\n900, 3, {load}\n900, 5, {10 * load}\n", ", NLGEOM"))
        done = run(["--outdir", tmp_path, tmp_path / f"{name}.inp"], tmp_path)
        assert done.returncode == code, done.stdout
        assert ("The loads no longer balance each other: node " in done.stdout) == (code != 0), done.stdout


def test_loads_that_balance_at_some_times_only(run: Run, tmp_path: Path) -> None:
    """Two forces whose amplitudes agree at quarters of the step, where they are compared, and not between."""
    mesh = free_mesh("C3D8")
    ends = [[n + 1 for n in mesh.where(0, x)] for x in (0.0, SIZE[0])]
    cards = "".join(
        f"*CLOAD, AMPLITUDE={name}\n" + "".join(f"{n}, 1, {force}\n" for n in nodes) for name, force, nodes in zip("AB", (-1.0, 1.0), ends, strict=True)
    )
    for middle, code in ((0.1, 0), (0.2, 5)):
        deck = free_deck(mesh, cards).replace("0.5, 1.", "0.1, 1., 0.1, 0.1")
        deck = "*AMPLITUDE, NAME=A\n0., 0., 1., 1.\n*AMPLITUDE, NAME=B\n" + f"0., 0., 0.1, {middle}, 0.2, 0.2, 1., 1.\n" + deck
        (tmp_path / f"ends-{code}.inp").write_text(deck)
        done = run(["--outdir", tmp_path, tmp_path / f"ends-{code}.inp"], tmp_path)
        assert done.returncode == code, done.stdout
        assert ("The loads no longer balance each other: node " in done.stdout) == (code != 0), done.stdout


def test_a_folded_strip_on_a_hinge(run: Run, tmp_path: Path) -> None:
    """A strip hinged at x = 0 with an upright end of half its length, pulled at its end towards the hinge.

    The line of the force passes through the hinge, M = V x and H s on the legs, and by Castigliano the end moves along the force by
    (V^2 10^3 + H^2 5^3) / (3 E I F) + (H^2 10 + V^2 5) / (E A F). The fold has two fibres at each node: knots.
    """
    x = [(float(i), 0.0) for i in range(11)] + [(10.0, 0.5 * i) for i in range(1, 11)]
    n = len(x)
    rows = "".join(f"{1 + i + n * j}, {a}, {j}., {b}\n" for j in range(3) for i, (a, b) in enumerate(x))
    cells = "".join(f"{1 + i + 20 * j}, {1 + i + n * j}, {2 + i + n * j}, {2 + n + i + n * j}, {1 + n + i + n * j}\n" for j in range(2) for i in range(20))
    force = 0.1
    along, up = -force * 10 / np.sqrt(125.0), -force * 5 / np.sqrt(125.0)
    loads = "".join(f"{n * (j + 1)}, {k}, {share * f:.16g}\n" for j, share in enumerate((0.25, 0.5, 0.25)) for k, f in ((1, along), (3, up)))
    deck = (
        f"*NODE\n{rows}*ELEMENT, TYPE=S4R, ELSET=STRIP\n{cells}*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, 0.\n"
        f"*SHELL SECTION, ELSET=STRIP, MATERIAL=M\n0.1\n*BOUNDARY\n"
        + "".join(f"{1 + n * j}, 1, 3\n" for j in range(3))
        + f"*STEP\n*STATIC\n*CLOAD\n{loads}"
    )
    (tmp_path / "fold.inp").write_text(deck + "*END STEP\n")
    done = run(["--outdir", tmp_path, tmp_path / "fold.inp"], tmp_path)
    assert done.returncode == 0 and "balance each other" in done.stdout, done.stdout
    with h5py.File(tmp_path / "fold.vtkhdf") as data:
        u = data["VTKHDF/PointData/U"][-int(data["VTKHDF/NumberOfPoints"][-1]) :][n - 1 : 3 * n : n].mean(axis=0)
    moved = (u[0] * along + u[2] * up) / force
    bending, area = YOUNG * 2.0 * 0.1**3 / 12, YOUNG * 0.2
    exact = (up**2 * 1000 + along**2 * 125) / (3 * bending * force) + (along**2 * 10 + up**2 * 5) / (area * force)
    assert abs(moved - exact) < 0.02 * exact, (moved, exact)     # the fold is 1 % of the longer leg thick
    (tmp_path / "turned.inp").write_text(deck + f"{n}, 3, 0.001\n*END STEP\n")
    done = run(["--outdir", tmp_path, tmp_path / "turned.inp"], tmp_path)
    assert done.returncode == 4 and "can turn about y" in done.stdout, done.stdout
