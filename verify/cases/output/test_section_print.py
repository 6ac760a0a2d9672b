"""SECTION PRINT against closed forms: uniform stress in turned and stretched bars of every kind of face.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from verify.conftest import Run
from verify.decks.make_decks import block
from verify.decks.solids import KINDS, Solids, as_kind, prescribed

YOUNG, NU = 1000.0, 0.3
TOLERANCE = 2e-6  # of the largest value: seven digits are printed

Floats = NDArray[np.float64]


def read_statistics(path: Path) -> list[Floats]:
    """The four rows of the last block: force and moment; centre and normal; moment about the centre; area and parts."""
    rows: list[Floats] = []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[:1] == ["statistics"]:
            rows = []
        elif words and words[0][0] in "-0123456789":
            rows.append(np.array([float(word) for word in words]))
    return rows


def hooke(strain: Floats) -> Floats:
    """The stress of a small strain."""
    shear = YOUNG / (1 + NU)
    return shear * strain + shear * NU / (1 - 2 * NU) * np.trace(strain) * np.eye(3)


def check(rows: list[Floats], force: Floats, center: Floats, normal: Floats, area: float) -> None:
    """All numbers of a block."""
    moment = np.cross(center, force)
    tension = force @ normal
    scale = max(np.abs(force).max(), np.abs(moment).max())
    for ours, right, size in ((rows[0], [*force, *moment], scale), (rows[1], [*center, *normal], 1.0), (rows[2], [0, 0, 0], scale),
                              (rows[3][:1], [area], area),
                              (rows[3][1:], [tension, np.linalg.norm(force - tension * normal), 0, 0], scale)):
        assert np.abs(ours - right).max() <= TOLERANCE * size, (ours, right)


def end_surface(solids: Solids, length: float) -> str:
    """The card of the surface of the far end."""
    faces = solids.outer_faces(solids.where(0, length))
    return "*SURFACE, NAME=FAR\n" + "".join(f"{e + 1}, S{f}\n" for e, f in faces)


def job(solids: Solids, u: Floats, nu: float, step: str) -> str:
    """A deck that holds all nodes where they are to be."""
    return (f"{solids.cards()}{end_surface(solids, 2.0)}*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, {nu}\n"
            f"*SOLID SECTION, ELSET=ALL, MATERIAL=M\n{step}*STATIC\n{prescribed(range(len(u)), u)}"
            "*SECTION PRINT, SURFACE=FAR, NAME=END\nSOF, SOM\n*END STEP\n")


@pytest.mark.parametrize("kind", KINDS)
def test_uniform_stress(kind: str, run_deck: Run, tmp_path: Path) -> None:
    """A uniform strain: the force is stress times area, the moment about the centre is nothing."""
    solids = as_kind(block([0, 1, 2], [0, 0.5, 1], [0, 1], "BAR"), kind)
    gradient = 1e-3 * np.array([[1.0, 0.3, -0.2], [0.1, -0.5, 0.4], [0.6, -0.3, 0.2]])
    result = run_deck(job(solids, solids.nodes @ gradient.T, NU, "*STEP\n"))
    assert result.returncode == 0, result.stderr
    normal = np.array([1.0, 0.0, 0.0])
    force = hooke((gradient + gradient.T) / 2) @ normal
    check(read_statistics(tmp_path / "job.dat"), force, np.array([2.0, 0.5, 0.5]), normal, 1.0)


def test_turned_bar(run_deck: Run, tmp_path: Path) -> None:
    """A bar stretched to 1.2 and turned by 40 degrees, nu = 0: the force is turned with it, the face is where it is now.

    Saint-Venant's law in a bar: nominal stress P = stretch E (stretch^2 - 1)/2.
    """
    solids = as_kind(block([0, 1, 2], [0, 1], [0, 1], "BAR"), "C3D20R")
    angle, stretch = np.radians(40.0), 1.2
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    place = solids.nodes * [stretch, 1, 1] @ turn.T
    result = run_deck(job(solids, place - solids.nodes, 0.0, "*STEP, NLGEOM\n"), "--dialect=calculix")
    assert result.returncode == 0, result.stderr
    force = turn[:, 0] * stretch * YOUNG * (stretch**2 - 1) / 2
    check(read_statistics(tmp_path / "job.dat"), force, turn @ [2 * stretch, 0.5, 0.5], turn[:, 0], 1.0)


def test_plane_body(run_deck: Run, tmp_path: Path) -> None:
    """An edge of a plane body is as deep as the body is thick."""
    deck = ("*NODE\n1, 0, 0\n2, 2, 0\n3, 2, 1\n4, 0, 1\n*ELEMENT, TYPE=CPS4, ELSET=E\n1, 1, 2, 3, 4\n*SURFACE, NAME=FAR\n1, S2\n"
            f"*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, {NU}\n*SOLID SECTION, ELSET=E, MATERIAL=M\n0.25\n*STEP\n*STATIC\n*BOUNDARY\n"
            "1, 1, 2\n4, 1, 1\n*CLOAD\n2, 1, 3.\n3, 1, 3.\n*SECTION PRINT, SURFACE=FAR\nSOAREA\n*END STEP\n")
    assert run_deck(deck).returncode == 0
    normal = np.array([1.0, 0.0, 0.0])
    check(read_statistics(tmp_path / "job.dat"), 6 * normal, np.array([2.0, 0.5, 0.0]), normal, 0.25)


@pytest.mark.parametrize(("surface", "words"), [("NONE", "There is no surface 'NONE'"), ("POINTS", "'POINTS' is one of nodes"),
                                                ("RING", "axisymmetric")])
def test_refusals(surface: str, words: str, run_deck: Run) -> None:
    """Surfaces that have no section are refused with their name."""
    deck = ("*NODE\n1, 1, 0\n2, 2, 0\n3, 2, 1\n4, 1, 1\n*ELEMENT, TYPE=CAX4, ELSET=E\n1, 1, 2, 3, 4\n*SURFACE, NAME=RING\n1, S2\n"
            "*SURFACE, NAME=POINTS, TYPE=NODE\n1\n*MATERIAL, NAME=M\n*ELASTIC\n1., 0.\n*SOLID SECTION, ELSET=E, MATERIAL=M\n"
            f"*STEP\n*STATIC\n*SECTION PRINT, SURFACE={surface}\nSOF\n*END STEP\n")
    result = run_deck(deck)
    assert result.returncode == 3
    assert words in " ".join((result.stdout + result.stderr).split())
