"""FOUNDATION: blocks that sink, beams on an elastic foundation, faces that turn under NLGEOM, parts, and what is refused.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.make_decks import block
from verify.decks.sheets import between
from verify.decks.shells import shell
from verify.decks.solids import KINDS, Solids, as_kind
from verify.readers.dat_frd_files import read_dat

E, STIFFNESS, PRESSURE = 1000.0, 50.0, 2.0
LAW = f"*MATERIAL, NAME=M\n*ELASTIC\n{E}, 0.\n"


def bottom_faces(body: Solids, axis: int, at: float) -> str:
    """Rows of FOUNDATION for the faces of a body on a plane."""
    return "".join(f"{e + 1}, F{f}, {STIFFNESS}\n" for e, f in body.outer_faces(body.where(axis, at)))


@pytest.mark.parametrize("step", ["*STEP", "*STEP, NLGEOM"])
@pytest.mark.parametrize("kind", KINDS)
def test_block_sinks(run_deck: Run, tmp_path: Path, kind: str, step: str) -> None:
    """A block on a foundation alone, under a force F on its top that a rigid plate spreads: it sinks by F/(k A) at its bottom and is shortened by F h/(E A)."""
    body = as_kind(block(between(0, 2, 2), between(0, 3, 2), between(0, 1, 2), "BODY"), kind)
    sets = "".join(f"*NSET, NSET={s}\n" + "".join(f"{i + 1},\n" for i in body.where(a, v)) for s, a, v in [("X", 0, 0.0), ("Y", 1, 0.0), ("LOW", 2, 0.0), ("TOP", 2, 1.0)])
    first = body.where(2, 1.0)[0] + 1
    others = "".join(f"2\n{i + 1}, 3, 1., {first}, 3, -1.\n" for i in body.where(2, 1.0)[1:])
    deck = f"{body.cards()}{sets}{LAW}*SOLID SECTION, ELSET=ALL, MATERIAL=M\n*EQUATION\n{others}*FOUNDATION\n{bottom_faces(body, 2, 0.0)}"
    force = 6 * PRESSURE
    deck += f"*BOUNDARY\nX, 1\nY, 2\n{step}\n*STATIC\n*CLOAD\n{first}, 3, {-force}\n*NODE PRINT, NSET=LOW\nU\n*NODE PRINT, NSET=TOP\nU\n*END STEP\n"
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr
    low, top = read_dat(tmp_path / "job.dat")[-2:]
    for row in low.rows.values():
        assert row[2] == pytest.approx(-force / (6 * STIFFNESS), rel=1e-6)
    stretch = -PRESSURE / E
    for _ in range(20 if "NLGEOM" in step else 0):
        stretch = np.expm1(-(1 + stretch) * PRESSURE / E)  # E ln(1 + s) = tau = -p (1 + s)
    for row in top.rows.values():
        assert row[2] == pytest.approx(-force / (6 * STIFFNESS) + stretch, rel=1e-6)


def beam_on_foundation(kind: str, n: int) -> tuple[str, list[int], list[int]]:
    """A strip 40 x 1 x 1 of shells along x, or of plane elements: cards with its foundation, and the nodes (from 1) at its left end and there on top."""
    if kind[0] == "S":
        body = shell(kind, (n, 1), lambda u, v: (40 * u, v, 0 * u))
        ends = [i + 1 for i in body.where(0, 0.0)]
        return body.cards() + f"{LAW}*SHELL SECTION, ELSET=E, MATERIAL=M\n1.\n*FOUNDATION\nE, F, {STIFFNESS}\n*BOUNDARY\nN, 1, 2\nN, 4\nN, 6\n", ends, ends
    rows, place, elements = "", {}, ""
    for j in range(5):
        for i in range(2 * n + 1):
            if i % 2 and j % 2:
                continue
            place[i, j] = len(place) + 1
            rows += f"{place[i, j]}, {40 * i / (2 * n):.15g}, {j / 4 - 0.5:.15g}\n"
    for j in (0, 2):
        for i in range(0, 2 * n, 2):
            around = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
            elements += f"{1 + j // 2 * n + i // 2}, " + ", ".join(str(place[i + a, j + b]) for a, b in around) + "\n"
    deck = f"*NODE, NSET=N\n{rows}*ELEMENT, TYPE={kind}, ELSET=E\n{elements}*ELSET, ELSET=LOW, GENERATE\n1, {n}\n"
    deck += f"{LAW}*SOLID SECTION, ELSET=E, MATERIAL=M\n1.\n*FOUNDATION\nLOW, F1, {STIFFNESS}\n*BOUNDARY\n{place[2 * n, 2]}, 1\n"
    return deck, [place[0, j] for j in range(5)], [place[0, 2]]


@pytest.mark.parametrize(("kind", "n"), [("S4", 80), ("S8R", 40), ("CPS8R", 40)])
def test_beam_on_foundation(run_deck: Run, tmp_path: Path, kind: str, n: int) -> None:
    """A long beam under a force P at its end: w = 2 P b/k there, b^4 = k/(4 E I), and sinks as exp(-b x) cos(b x).
    Reference: M. Hetenyi, Beams on Elastic Foundation (1946), semi-infinite beam. Shear and the local load are left out by comparing at x = 5 and more."""
    deck, ends, _ = beam_on_foundation(kind, n)
    share = 1.0 / len(ends) if kind[0] == "S" else 1.0
    rows = "".join(f"{i}, {3 if kind[0] == 'S' else 2}, {-share}\n" for i in (ends if kind[0] == "S" else ends[2:3]))
    done = run_deck(f"{deck}*STEP\n*STATIC\n*CLOAD\n{rows}*NODE PRINT, NSET=N\nU, COORD\n*END STEP\n")
    assert done.returncode == 0, done.stdout + done.stderr
    tables = read_dat(tmp_path / "job.dat")
    moved = next(t for t in tables if "displacements" in t.name[0]).rows
    places = next(t for t in tables if "coordinates" in t.name[0]).rows
    across = 2 if kind[0] == "S" else 1
    bend = (STIFFNESS / (4 * E / 12)) ** 0.25
    shear = E / 2 * (1.0 if kind[0] == "S" else 5 / 6)
    slack = STIFFNESS / shear  # of the beam of Timoshenko: w'''' - (k/K) w'' + 4 b^4 w = 0
    a, c = np.sqrt(bend**2 + slack / 4), np.sqrt(bend**2 - slack / 4)
    rigidity = E / 12

    def shape(x: np.ndarray) -> np.ndarray:
        """Solution with zero moment and shear force 1 at the end, by its two constants."""
        roots = np.array([-a + 1j * c])
        moment = -rigidity * (roots**2 - slack)  # M = -E I (w'' - k w/K)
        force = moment * roots
        matrix = np.array([[moment[0].real, -moment[0].imag], [force[0].real, -force[0].imag]])
        constants = np.linalg.solve(matrix, [0.0, 1.0])
        return np.real((constants[0] + 1j * constants[1]) * np.exp(roots[0] * x))

    xs, ws = [], []
    for label, row in moved.items():
        place = places[label]
        if kind[0] != "S" and abs(place[1]) > 1e-9:
            continue  # the middle line only
        xs.append(place[0])
        ws.append(row[across])
    exact = shape(np.array(xs))
    exact *= np.sign(exact[int(np.argmin(xs))]) * -1
    far = np.array(xs) > 2.0
    assert np.abs(np.array(ws) - exact)[far].max() < 0.01 * np.abs(exact).max()


@pytest.mark.parametrize("family", ["CPE4", "C3D8"])
def test_face_that_turns(run_deck: Run, tmp_path: Path, family: str) -> None:
    """NLGEOM: a square turned by 50 degrees about a corner and moved: the foundation acts along the present normal, -k int (u . n) n dA."""
    angle, shift = np.radians(50.0), np.array([0.2, -0.1])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    levels = (0.0,) if family == "CPE4" else (0.0, 1.0)
    nodes = [(*p, z) for z in levels for p in corners]
    deck = "*NODE, NSET=N\n" + "".join(f"{i + 1}, {x}, {y}, {z}\n" for i, (x, y, z) in enumerate(nodes))
    deck += f"*ELEMENT, TYPE={family}, ELSET=E\n1, " + ", ".join(str(i + 1) for i in range(len(nodes))) + "\n"
    face = "F1" if family == "CPE4" else "F3"  # y = 0
    deck += f"{LAW}*SOLID SECTION, ELSET=E, MATERIAL=M\n*FOUNDATION\nE, {face}, {STIFFNESS}\n*BOUNDARY\n" + ("" if family == "CPE4" else "N, 3\n")
    rows = ""
    for i, (x, y, _) in enumerate(nodes):
        moved = turn @ [x, y] + shift - [x, y]
        rows += f"{i + 1}, 1, 1, {moved[0]:.15g}\n{i + 1}, 2, 2, {moved[1]:.15g}\n"
    done = run_deck(f"{deck}*STEP, NLGEOM\n*STATIC\n0.1, 1.\n*BOUNDARY\n{rows}*NODE PRINT, NSET=N, TOTALS=ONLY\nRF\n*END STEP\n")
    assert done.returncode == 0, done.stdout + done.stderr
    total = np.array(next(iter(read_dat(tmp_path / "job.dat")[-1].rows.values())))[:2]
    normal = turn @ [0.0, -1.0]
    middle = turn @ [0.5, 0.0] + shift - [0.5, 0.0]
    assert total == pytest.approx(STIFFNESS * (middle @ normal) * normal, rel=1e-5)


def test_part(run_deck: Run, tmp_path: Path) -> None:
    """The card inside a part belongs to each of its instances."""
    part = "*PART, NAME=P\n*NODE, NSET=ALL\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 1., 1., 0.\n4, 0., 1., 0.\n5, 0., 0., 1.\n6, 1., 0., 1.\n7, 1., 1., 1.\n8, 0., 1., 1.\n"
    part += f"*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*SOLID SECTION, ELSET=E, MATERIAL=M\n*FOUNDATION\nE, F1, {STIFFNESS}\n*END PART\n"
    assembly = "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n*INSTANCE, NAME=J, PART=P\n5., 0., 0.\n*END INSTANCE\n*END ASSEMBLY\n"
    deck = f"{part}{assembly}{LAW}*BOUNDARY\nI.ALL, 1, 2\nJ.ALL, 1, 2\n*STEP\n*STATIC\n*DLOAD\nI.E, P2, {PRESSURE}\nJ.E, P2, {2 * PRESSURE}\n"
    done = run_deck(deck + "*NODE PRINT, NSET=I.ALL\nU\n*NODE PRINT, NSET=J.ALL\nU\n*END STEP\n")
    assert done.returncode == 0, done.stdout + done.stderr
    first, second = read_dat(tmp_path / "job.dat")[-2:]
    assert max(row[2] for row in first.rows.values()) == pytest.approx(-PRESSURE / STIFFNESS, rel=1e-6)
    assert max(row[2] for row in second.rows.values()) == pytest.approx(-2 * PRESSURE / STIFFNESS, rel=1e-6)


def test_free_along_the_face(run_deck: Run) -> None:
    """A foundation holds along its normal alone: the other motions are named."""
    body = as_kind(block(between(0, 1, 1), between(0, 1, 1), between(0, 1, 1), "BODY"), "C3D8")
    deck = f"{body.cards()}{LAW}*SOLID SECTION, ELSET=ALL, MATERIAL=M\n*FOUNDATION\n{bottom_faces(body, 2, 0.0)}*STEP\n*STATIC\n*CLOAD\n1, 1, 1.\n*END STEP\n"
    done = run_deck(deck)
    assert done.returncode != 0
    text = " ".join((done.stdout + done.stderr).split())
    assert "move along x" in text or "translate" in text


@pytest.mark.parametrize(
    ("card", "option", "words"),
    [
        ("*FOUNDATION\nALL, F9, 1.\n", "abaqus", "takes no foundation F9"),
        ("*FOUNDATION\nALL, F1, -1.\n", "abaqus", "The stiffness of a foundation must be positive"),
        ("*FOUNDATION\nALL, F1, 1.\n", "calculix", "CalculiX has no *FOUNDATION"),
    ],
)
def test_refused(run_deck: Run, card: str, option: str, words: str) -> None:
    """Bad cards."""
    body = as_kind(block(between(0, 1, 1), between(0, 1, 1), between(0, 1, 1), "BODY"), "C3D8")
    done = run_deck(f"{body.cards()}{LAW}*SOLID SECTION, ELSET=ALL, MATERIAL=M\n{card}*STEP\n*STATIC\n*CLOAD\n1, 1, 1.\n*END STEP\n", f"--dialect={option}")
    assert done.returncode == 3
    assert words in " ".join((done.stdout + done.stderr).split())
