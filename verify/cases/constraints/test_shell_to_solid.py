"""*SHELL TO SOLID COUPLING: a strip, one end of solids, the other of shells, whose meshes do not match.

Stress that is constant or linear over the thickness passes exactly, so that a strip with nu = 0 has the displacements of the beam
(u = F L/(E A), w = M L^2/(2 E I)); a rigid rotation strains nothing; with nu = 0.3 and a lateral force a strip of solids is the reference.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.decks.grids import bodies_deck, grid
from verify.decks.shells import Shell, section, shell
from verify.decks.sheets import between
from verify.decks.solids import as_kind, node_set

RunDeck = Callable[..., subprocess.CompletedProcess[str]]
Floats = np.ndarray
LENGTH, JOINT, WIDTH, THICKNESS, MODULUS = 10.0, 4.0, 2.0, 0.5, 1000.0
PLATE = 5000  #: added to the labels of the shells
STIFFNESS = MODULUS * WIDTH * THICKNESS**3 / 12  #: E I
KINDS = [("S4", "C3D8I"), ("S4", "C3D20"), ("S4R", "C3D10"), ("S3", "C3D20R"), ("S6", "C3D20"), ("S8R", "C3D15")]


@dataclass
class Strip:
    """Cards of the model, and the nodes of its ends."""

    cards: str
    plate: Shell

    def tip(self) -> dict[int, float]:
        """Labels of the nodes at the end of the shells with their shares in a force."""
        return {PLATE + i + 1: share for i, share in self.plate.edge_weights(0, 1.0).items()}


def strip(kinds: tuple[str, str], ratio: float, more: str = "", layers: str = "") -> Strip:
    """Solids from 0 to JOINT with three cells over the width and three over the thickness, shells with two from there to LENGTH."""
    wide, high = np.array([0.0, 0.5, 1.4, 2.0]), THICKNESS * np.array([-0.5, -0.2, 0.1, 0.5])
    body = as_kind(grid("SOLID", between(0, JOINT, 4), wide, high), kinds[1])
    plate = shell(kinds[0], (6, 2), lambda u, v: (JOINT + (LENGTH - JOINT) * u, WIDTH * v, 0 * u))
    ends = [(e, f) for e, f in body.outer_faces(body.where(0, JOINT))]
    first = len(body.elements)
    text = body.cards() + node_set("FIXED", body.where(0, 0.0)) + "".join(
        ["*SURFACE, NAME=FACE\n", *(f"{e + 1}, S{f}\n" for e, f in ends)])
    text += "*NODE\n" + "".join(f"{PLATE + i + 1}, {x:.15g}, {y:.15g}, {z:.15g}\n" for i, (x, y, z) in enumerate(plate.nodes))
    text += f"*ELEMENT, TYPE={kinds[0]}, ELSET=E\n" + "".join(
        f"{first + e + 1}, {', '.join(str(PLATE + n + 1) for n in nodes)}\n" for e, nodes in enumerate(plate.elements))
    edge = set(plate.where(0, 0.0))
    text += "*SURFACE, NAME=EDGE\n"
    for e, nodes in enumerate(plate.elements):
        corners = nodes[: 4 if kinds[0][1] in "48" else 3]
        text += "".join(f"{first + e + 1}, E{k + 1}\n" for k in range(len(corners)) if {corners[k], corners[(k + 1) % len(corners)]} <= edge)
    shells = section(MODULUS, ratio, THICKNESS)
    if layers:
        shells = shells[: shells.index("*SHELL SECTION")] + f"*SHELL SECTION, ELSET=E, COMPOSITE\n{layers}"
    text += shells + "*SOLID SECTION, ELSET=ALL, MATERIAL=M\n"
    return Strip(text + f"*SHELL TO SOLID COUPLING, CONSTRAINT NAME=C{more}\nEDGE, FACE\n", plate)


def last_frame(folder: Path, name: str) -> Floats:
    """A field at the nodes of elements at the end."""
    with h5py.File(folder / "job.vtkhdf") as file:
        m = int(file["VTKHDF/NumberOfPoints"][-1])
        values = np.asarray(file[f"VTKHDF/{name}" if name == "Points" else f"VTKHDF/PointData/{name}"])[-m:]
        return values[np.unique(file["VTKHDF/Connectivity"])]


@pytest.mark.parametrize("layers", ["", "0.1, 3, M\n0.25, 3, M\n0.15, 3, M\n"], ids=["one layer", "three layers"])
@pytest.mark.parametrize("kinds", KINDS, ids="-".join)
def test_pull_and_moment(run_deck: RunDeck, tmp_path: Path, kinds: tuple[str, str], layers: str) -> None:
    """The closed form of the beam."""
    force, moment = 3.0, 0.7
    model = strip(kinds, 0.0, layers=layers)
    loads = "*CLOAD\n" + "".join(f"{n}, 1, {share * force:.15g}\n{n}, 5, {share * moment:.15g}\n" for n, share in model.tip().items())
    deck = model.cards + node_set("TIP", [n - 1 for n in model.tip()]) + "*STEP\n*STATIC\n" + "*BOUNDARY\nFIXED, 1\nFIXED, 3\n1, 2\n" + loads
    done = run_deck(deck + "*NODE PRINT, NSET=TIP\nU\nUR\n*END STEP\n")
    assert done.returncode == 0, done.stdout + done.stderr
    u, turn = blocks(tmp_path)
    middle = [force * LENGTH / (MODULUS * WIDTH * THICKNESS), 0, -moment * LENGTH**2 / (2 * STIFFNESS)]
    assert np.abs(u - middle).max() < 1e-6 * abs(middle[2]), u
    assert np.abs(turn - [0, moment * LENGTH / STIFFNESS, 0]).max() < 1e-6 * moment * LENGTH / STIFFNESS, turn


@pytest.mark.parametrize("kinds", [("S4", "C3D8I"), ("S8R", "C3D20")], ids="-".join)
def test_like_solids(run_deck: RunDeck, tmp_path: Path, kinds: tuple[str, str]) -> None:
    """Clamped, nu = 0.3, a lateral force at the tip: the deflection and the stress before the joint are those of C3D20 throughout."""
    model = strip(kinds, 0.3)
    loads = "*CLOAD\n" + "".join(f"{n}, 3, {share:.15g}\n" for n, share in model.tip().items())
    tip = node_set("TIP", [n - 1 for n in model.tip()])
    assert run_deck(model.cards + tip + "*STEP\n*STATIC\n*BOUNDARY\nFIXED, 1, 3\n" + loads + "*END STEP\n").returncode == 0
    found = tip_and_stress(tmp_path)
    whole = as_kind(grid("B", between(0, LENGTH, 10), between(0, WIDTH, 4), THICKNESS * np.array([-0.5, -0.2, 0.1, 0.5])), "C3D20")
    end = [(e, f) for e, f in whole.outer_faces(whole.where(0, LENGTH))]
    text = whole.cards() + node_set("FIXED", whole.where(0, 0.0)) + "*SURFACE, NAME=END\n" + "".join(f"{e + 1}, S{f}\n" for e, f in end)
    text += f"*MATERIAL, NAME=M\n*ELASTIC\n{MODULUS}, 0.3\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n*STEP\n*STATIC\n*BOUNDARY\nFIXED, 1, 3\n"
    assert run_deck(text + f"*DSLOAD\nEND, TRVEC, {1 / (WIDTH * THICKNESS)}, 0., 0., 1.\n*END STEP\n").returncode == 0
    reference = tip_and_stress(tmp_path)
    assert found == pytest.approx(reference, rel=0.01)


def test_turned_by_a_right_angle(run_deck: RunDeck, tmp_path: Path) -> None:
    """NLGEOM: the solids are turned about their end; the shells follow as a rigid body, also an angle whose corner is a knot."""
    model = strip(("S4", "C3D8I"), 0.3)
    line = sorted(model.plate.where(1, 0.5), key=lambda i: model.plate.nodes[i, 0])
    flange = "*NODE\n" + "".join(f"{7000 + k}, {model.plate.nodes[i, 0]:.15g}, 1., 1.5\n" for k, i in enumerate(line))
    flange += "*ELEMENT, TYPE=S4, ELSET=E\n" + "".join(
        f"{9000 + k}, {PLATE + a + 1}, {PLATE + b + 1}, {7001 + k}, {7000 + k}\n" for k, (a, b) in enumerate(zip(line, line[1:], strict=False)))
    cards = model.cards.replace("*SURFACE, NAME=EDGE", flange + "*SURFACE, NAME=EDGE")
    base = last_numbers(cards)
    turned = "".join(f"{n}, 1, 1, {-x - z + x:.15g}\n{n}, 2, 2, 0.\n{n}, 3, 3, {x - z:.15g}\n" for n, (x, y, z) in base.items())
    deck = cards + "*STEP, NLGEOM\n*STATIC\n0.25, 1.\n*BOUNDARY\n" + turned + "*END STEP\n"
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr
    x, u, s = (last_frame(tmp_path, name) for name in ("Points", "U", "S_mises"))
    assert np.abs(x + u - np.stack([-x[:, 2], x[:, 1], x[:, 0]], axis=1)).max() < 1e-6
    assert s.max() < 1e-6 * MODULUS


def blocks(folder: Path) -> tuple[Floats, Floats]:
    """Displacements and rotations of *NODE PRINT."""
    rows = [line.split() for line in (folder / "job.dat").read_text().splitlines()]
    values = np.array([[float(v) for v in row[1:]] for row in rows if len(row) == 4 and row[0].isdigit()])
    return values[: len(values) // 2], values[len(values) // 2 :]


def tip_and_stress(folder: Path) -> list[float]:
    """The mean deflection at the tip, and the largest sxx of the solids at x = 2."""
    x, u, s = (last_frame(folder, name) for name in ("Points", "U", "S"))
    before = np.flatnonzero(np.abs(x[:, 0] - 2.0) < 1e-9)
    return [float(u[np.abs(x[:, 0] - LENGTH) < 1e-9, 2].mean()), float(s[before, 0].max())]


def last_numbers(cards: str) -> dict[int, tuple[float, ...]]:
    """The nodes of the set FIXED with their places."""
    places = {}
    for row in cards[: cards.index("*ELEMENT")].splitlines()[1:]:
        label, *at = row.split(",")
        places[int(label)] = tuple(float(v) for v in at)
    rows = cards[cards.index("*NSET, NSET=FIXED") :].splitlines()[1:]
    names = [n for row in rows[: next(i for i, row in enumerate(rows) if row[0] == "*")] for n in row.split(",") if n.strip()]
    return {int(n): places[int(n)] for n in names}
