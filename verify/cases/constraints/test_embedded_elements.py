"""Embedded elements: reinforcing bars, sheets and solids whose nodes lie anywhere in their hosts.

Linear fields are exact: the force of a stretched block is that of concrete and bars side by side. Bars on edges of the hosts are the
same as bars that share the nodes of the hosts.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.decks.make_decks import block
from verify.decks.sheets import between
from verify.decks.solids import as_kind, node_set

RunDeck = Callable[..., subprocess.CompletedProcess[str]]
Floats = np.ndarray
CONCRETE, STEEL, AREA = 30.0, 200.0, 0.01
BAR, BAR_ELEMENT = 5000, 9000  #: label of the first node and element
MATERIALS = f"*MATERIAL, NAME=CONCRETE\n*ELASTIC\n{CONCRETE}, 0.\n*MATERIAL, NAME=STEEL\n*ELASTIC\n{STEEL}, 0.\n"


def bar(points: Floats, labels: list[int] | None = None) -> str:
    """Trusses from point to point, the set BAR; with labels of nodes that are there."""
    numbers = labels or [BAR + i for i in range(len(points))]
    text = "" if labels else "*NODE\n" + "".join(f"{n}, " + ", ".join(f"{v:.12g}" for v in x) + "\n" for n, x in zip(numbers, points, strict=True))
    text += "*ELEMENT, TYPE=T3D2, ELSET=BAR\n" + "".join(f"{BAR_ELEMENT + i}, {a}, {b}\n" for i, (a, b) in enumerate(zip(numbers, numbers[1:], strict=False)))
    return text + f"*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL\n{AREA}\n"


def results(path: Path) -> tuple[Floats, Floats, Floats]:
    """Reference coordinates, displacements and reactions at the end."""
    with h5py.File(path / "job.vtkhdf") as file:
        m = int(file["VTKHDF/NumberOfPoints"][-1])
        return tuple(np.asarray(file[f"VTKHDF/{name}"])[-m:] for name in ("Points", "PointData/U", "PointData/RF"))  # type: ignore[return-value]


def beam(kind: str, n: tuple[int, int, int]) -> tuple[object, str]:
    """A block of 4 x 1 x 1 and its cards."""
    body = as_kind(block(between(0, 4, n[0]), between(0, 1, n[1]), between(0, 1, n[2]), "BODY"), kind)
    ends = node_set("LEFT", body.where(0, 0.0)) + node_set("RIGHT", body.where(0, 4.0))
    return body, body.cards() + "*ELSET, ELSET=BODY\n" + "".join(f"{e + 1},\n" for e in range(len(body.elements))) + ends + MATERIALS


@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
@pytest.mark.parametrize("kind", ["C3D8", "C3D10", "C3D20R"])
def test_stretched_block(run_deck: RunDeck, tmp_path: Path, kind: str, dialect: str) -> None:
    """A bar askew along x in hosts of another division: the forces at the ends are those of both areas, each point moves with x."""
    _, cards = beam(kind, (3, 2, 2))
    points = np.stack([np.linspace(0, 4, 8), np.full(8, 0.37), np.full(8, 0.61)], axis=1)
    deck = cards + "*SOLID SECTION, ELSET=BODY, MATERIAL=CONCRETE\n" + bar(points) + "*EMBEDDED ELEMENT, HOST ELSET=BODY\nBAR\n"
    deck += "*STEP\n*STATIC\n*BOUNDARY\nLEFT, 1, 3\nRIGHT, 1, 1, 0.004\nRIGHT, 2, 3\n*END STEP\n"
    done = run_deck(deck, f"--dialect={dialect}")
    assert done.returncode == 0, done.stdout + done.stderr
    x, u, force = results(tmp_path)
    assert np.abs(u - 0.001 * x * [1, 0, 0]).max() < 1e-12
    right = force[x[:, 0] > 3.999, 0].sum()
    assert right == pytest.approx(0.001 * (CONCRETE + STEEL * AREA), rel=1e-9)
    assert force[x[:, 0] < 0.001, 0].sum() == pytest.approx(-right, rel=1e-9)


@pytest.mark.parametrize("step", ["*STEP", "*STEP, NLGEOM"])
def test_same_as_shared_nodes(run_deck: RunDeck, tmp_path: Path, step: str) -> None:
    """A bent and twisted beam whose bars lie on edges of the hosts."""
    body, cards = beam("C3D8", (6, 2, 2))
    where = [i for i in range(len(body.nodes)) if tuple(body.nodes[i, 1:]) == (0.5, 0.5)]  # type: ignore[attr-defined]
    where.sort(key=lambda i: body.nodes[i, 0])  # type: ignore[attr-defined]
    load = f"{step}\n*STATIC\n0.5, 1.\n*BOUNDARY\nLEFT, 1, 3\nRIGHT, 1, 1, 0.1\nRIGHT, 2, 2, 0.5\nRIGHT, 3, 3, -0.8\n*END STEP\n"
    section = "*SOLID SECTION, ELSET=BODY, MATERIAL=CONCRETE\n"
    cards = cards.replace(f"{CONCRETE}, 0.\n", f"{CONCRETE}, 0.25\n")
    found = []
    for name, more in (("own", bar(body.nodes[where]) + "*EMBEDDED ELEMENT\nBAR\n"), ("shared", bar(body.nodes[where], [i + 1 for i in where]))):  # type: ignore[attr-defined]
        done = run_deck(cards + section + more + load)
        assert done.returncode == 0, name + done.stdout + done.stderr
        _, u, force = results(tmp_path)
        found.append((u[: len(body.nodes)], force[: len(body.nodes)]))  # type: ignore[attr-defined]
    assert np.abs(found[0][0] - found[1][0]).max() < 1e-9
    assert np.abs(found[0][1] - found[1][1]).max() < 1e-9 * np.abs(found[1][1]).max()


def test_turned_without_stress(run_deck: RunDeck, tmp_path: Path) -> None:
    """The block turns by 60 degrees as a rigid body: bars anywhere in it have no force."""
    body, cards = beam("C3D8", (2, 1, 1))
    points = np.array([[0.3, 0.2, 0.1], [1.1, 0.7, 0.3], [2.7, 0.4, 0.9], [3.9, 0.9, 0.8]])
    angle = np.radians(60)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    moved = body.nodes @ turn.T - body.nodes  # type: ignore[attr-defined]
    supports = "".join(f"{i + 1}, {k + 1}, {k + 1}, {v:.15g}\n" for i, u in enumerate(moved) for k, v in enumerate(u))
    deck = cards + "*SOLID SECTION, ELSET=BODY, MATERIAL=CONCRETE\n" + bar(points) + "*EMBEDDED ELEMENT\nBAR\n"
    done = run_deck(deck + f"*STEP, NLGEOM\n*STATIC\n*BOUNDARY\n{supports}*END STEP\n")
    assert done.returncode == 0, done.stdout + done.stderr
    x, u, force = results(tmp_path)
    assert np.abs(x + u - x @ turn.T).max() < 1e-12
    assert np.abs(force).max() < 1e-9 * CONCRETE


def test_bar_in_a_plane(run_deck: RunDeck, tmp_path: Path) -> None:
    """Trusses in the plane, in plane stress of thickness 0.5."""
    nodes = [(x, y) for y in (0.0, 0.5, 1.0) for x in (0.0, 1.0, 2.0)]
    deck = "*NODE, NSET=ALL\n" + "".join(f"{i + 1}, {x}, {y}\n" for i, (x, y) in enumerate(nodes))
    deck += "*ELEMENT, TYPE=CPS4, ELSET=BODY\n1, 1, 2, 5, 4\n2, 2, 3, 6, 5\n3, 4, 5, 8, 7\n4, 5, 6, 9, 8\n" + MATERIALS
    deck += "*SOLID SECTION, ELSET=BODY, MATERIAL=CONCRETE\n0.5\n*NODE\n11, 0., 0.3\n12, 0.7, 0.3\n13, 2., 0.3\n"
    deck += f"*ELEMENT, TYPE=T2D2, ELSET=BAR\n11, 11, 12\n12, 12, 13\n*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL\n{AREA}\n*EMBEDDED ELEMENT\nBAR\n"
    deck += "*STEP\n*STATIC\n*BOUNDARY\n1, 1, 2\n4, 1, 2\n7, 1, 2\n3, 1, 1, 0.002\n6, 1, 1, 0.002\n9, 1, 1, 0.002\n3, 2\n6, 2\n9, 2\n*END STEP\n"
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr
    x, _, force = results(tmp_path)
    assert force[x[:, 0] > 1.999, 0].sum() == pytest.approx(0.001 * (0.5 * CONCRETE + STEEL * AREA), rel=1e-9)


def test_sheet_and_solid(run_deck: RunDeck, tmp_path: Path) -> None:
    """A membrane and a small brick in a stretched block: the brick adds its stiffness to that of its host, as in Abaqus."""
    _, cards = beam("C3D8", (3, 1, 1))
    deck = cards + "*SOLID SECTION, ELSET=BODY, MATERIAL=CONCRETE\n*NODE\n"
    sheet = [(0, 0.2, 0.4), (4, 0.2, 0.4), (4, 0.8, 0.4), (0, 0.8, 0.4)]
    brick = [(0, y, z) for y, z in ((0.1, 0.6), (0.3, 0.6), (0.3, 0.8), (0.1, 0.8))]
    brick = brick + [(4, y, z) for _, y, z in brick]
    deck += "".join(f"{BAR + i}, {x}, {y}, {z}\n" for i, (x, y, z) in enumerate(sheet + brick))
    deck += f"*ELEMENT, TYPE=M3D4, ELSET=SHEET\n{BAR_ELEMENT}, " + ", ".join(str(BAR + i) for i in range(4))
    deck += f"\n*ELEMENT, TYPE=C3D8, ELSET=BRICK\n{BAR_ELEMENT + 1}, " + ", ".join(str(BAR + 4 + i) for i in (0, 1, 2, 3, 4, 5, 6, 7))
    deck += "\n*MEMBRANE SECTION, ELSET=SHEET, MATERIAL=STEEL\n0.02\n*SOLID SECTION, ELSET=BRICK, MATERIAL=STEEL\n*EMBEDDED ELEMENT, HOST ELSET=BODY\nSHEET, BRICK\n"
    done = run_deck(deck + "*STEP\n*STATIC\n*BOUNDARY\nLEFT, 1, 3\nRIGHT, 1, 1, 0.004\nRIGHT, 2, 3\n*END STEP\n")
    assert done.returncode == 0, done.stdout + done.stderr
    x, _, force = results(tmp_path)
    assert force[x[:, 0] > 3.999, 0].sum() == pytest.approx(0.001 * (CONCRETE + STEEL * (0.6 * 0.02 + 0.2 * 0.2)), rel=1e-9)


def test_parts_and_instances(run_deck: RunDeck, tmp_path: Path) -> None:
    """As Abaqus/CAE writes it: the bar is a part of its own, placed in the block."""
    body = as_kind(block(between(0, 4, 3), between(0, 1, 1), between(0, 1, 1), "BODY"), "C3D8")
    deck = "*PART, NAME=BLOCK\n" + body.cards() + node_set("LEFT", body.where(0, 0.0)) + node_set("RIGHT", body.where(0, 4.0))
    deck += "*ELSET, ELSET=ALL_OF_IT, GENERATE\n1, 3, 1\n*SOLID SECTION, ELSET=ALL_OF_IT, MATERIAL=CONCRETE\n*END PART\n*PART, NAME=REBAR\n*NODE\n1, 0., 0., 0.\n2, 4., 0., 0.\n"
    deck += f"*ELEMENT, TYPE=T3D2, ELSET=WIRE\n1, 1, 2\n*SOLID SECTION, ELSET=WIRE, MATERIAL=STEEL\n{AREA}\n*END PART\n"
    deck += "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=BLOCK-1, PART=BLOCK\n*END INSTANCE\n*INSTANCE, NAME=REBAR-1, PART=REBAR\n0., 0.3, 0.7\n*END INSTANCE\n"
    deck += "*ELSET, ELSET=STEEL_SET, INSTANCE=REBAR-1\n1,\n*ELSET, ELSET=HOSTS, INSTANCE=BLOCK-1, GENERATE\n1, 3, 1\n*EMBEDDED ELEMENT, HOST ELSET=HOSTS\nSTEEL_SET\n*END ASSEMBLY\n"
    deck += MATERIALS + "*STEP\n*STATIC\n*BOUNDARY\nBLOCK-1.LEFT, 1, 3\nBLOCK-1.RIGHT, 1, 1, 0.004\nBLOCK-1.RIGHT, 2, 3\n*END STEP\n"
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr
    x, _, force = results(tmp_path)
    assert force[x[:, 0] > 3.999, 0].sum() == pytest.approx(0.001 * (CONCRETE + STEEL * AREA), rel=1e-9)


def test_outside_within_tolerance(run_deck: RunDeck, tmp_path: Path) -> None:
    """A bar 0.02 outside moves with the nearest points and a warning names them; ABSOLUTE EXTERIOR TOLERANCE refuses it."""
    _, cards = beam("C3D8", (4, 1, 1))
    points = np.stack([np.linspace(0.5, 3.5, 4), np.full(4, 0.5), np.full(4, 1.02)], axis=1)
    deck = cards + "*SOLID SECTION, ELSET=BODY, MATERIAL=CONCRETE\n" + bar(points) + "*EMBEDDED ELEMENT, HOST ELSET=BODY\nBAR\n"
    step = "*STEP\n*STATIC\n*BOUNDARY\nLEFT, 1, 3\nRIGHT, 1, 1, 0.004\nRIGHT, 2, 3\n*END STEP\n"
    done = run_deck(deck + step)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "4 nodes move with the nearest point" in " ".join((done.stdout + done.stderr).split())
    x, u, _ = results(tmp_path)
    assert np.abs(u[x[:, 2] > 1.01, 0] - 0.001 * points[:, 0]).max() < 1e-4
    done = run_deck(deck.replace("HOST ELSET=BODY\n", "HOST ELSET=BODY, ABSOLUTE EXTERIOR TOLERANCE=0.01\n") + step)
    assert done.returncode == 4
    assert "4 nodes of the embedded elements lie outside the hosts" in " ".join((done.stdout + done.stderr).split())


@pytest.mark.parametrize(
    ("card", "words"),
    [
        ("*EMBEDDED ELEMENT, HOST ELSET=NO_SUCH_SET\nBAR\n", "There is no element set 'NO_SUCH_SET'"),
        ("*EMBEDDED ELEMENT\nBAR, NO_SUCH_SET\n", "NO_SUCH_SET"),
        ("*EMBEDDED ELEMENT\n", "needs the elements that are embedded"),
        ("*EMBEDDED ELEMENT\nBAR, BODY\n", "There is no host"),
        ("*EMBEDDED ELEMENT, EXTERIOR TOLERANCE=-1.\nBAR\n", "EXTERIOR TOLERANCE must not be negative"),
    ],
)
def test_refused(run_deck: RunDeck, card: str, words: str) -> None:
    """Each error names what is wrong."""
    _, cards = beam("C3D8", (1, 1, 1))
    deck = cards + "*SOLID SECTION, ELSET=BODY, MATERIAL=CONCRETE\n" + bar(np.array([[0.5, 0.5, 0.5], [3.5, 0.5, 0.5]])) + card
    done = run_deck(deck + "*STEP\n*STATIC\n*BOUNDARY\nLEFT, 1, 3\n*END STEP\n")
    assert done.returncode == 3
    assert words in " ".join((done.stdout + done.stderr).split())
