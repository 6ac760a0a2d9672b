"""Forces per length on beams: a cantilever deflects by q L^4 / (8 E I), stretches by q L^2 / (2 E A), and P1 turns with it as
the elastica says.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.beams import LENGTH, MODULUS, Section, beam, box, circle, pipe, rectangle
from verify.readers.dat_frd_files import read_dat

SECTIONS = {"rect": rectangle(0.4, 0.6), "circ": circle(0.3), "pipe": pipe(0.3, 0.05), "box": box(0.6, 0.4, (0.02, 0.04, 0.03, 0.02))}
CIRCLE = ".6, .6"  #: of the calculix dialect
FORCE = 0.01


def end_of(run: Run, folder: Path, deck: str, dialect: str) -> np.ndarray:
    """The displacement of the end."""
    (folder / "job.inp").write_text(deck + "*NODE PRINT, NSET=END\nU\n*END STEP\n")
    done = run([f"--dialect={dialect}", "--outdir", folder, folder / "job.inp"])
    assert done.returncode == 0, done.stdout + done.stderr
    return np.array(next(iter(read_dat(folder / "job.dat")[-1].rows.values())))


LABELS = {"abaqus": ["PX", "PY", "PZ", "P1", "P2"], "calculix": ["P1", "P2"]}  #: of beams that are expanded
EXPANDED = {"abaqus": ["rect", "circ", "pipe"], "calculix": list(SECTIONS)}


@pytest.mark.parametrize(("dialect", "name", "label"), [(d, n, x) for d in LABELS for n in EXPANDED[d] for x in LABELS[d]])
@pytest.mark.parametrize("kind", ["B31", "B32"])
def test_cantilever(run: Run, tmp_path: Path, dialect: str, kind: str, name: str, label: str) -> None:
    """Direction 1 is y, 2 is z. In the calculix dialect the value is the pressure on the side of the solid, a quarter of the circle. The
    deflections carry shear, the clamp around the section, and 2 % of a circle in the calculix dialect."""
    section: Section = SECTIONS[name]
    deck = beam(kind, section, CIRCLE if name == "circ" and dialect == "calculix" else "", n=20)
    width = {"rect": (0.6, 0.4), "circ": (0.6 / 2**0.5,) * 2, "pipe": (0.6, 0.6), "box": (0.4, 0.6)}[name][label == "P2"]
    value = FORCE / width if dialect == "calculix" else FORCE
    end = end_of(run, tmp_path, deck + f"*BOUNDARY\n1, 1, 6\n*STEP\n*STATIC\n*DLOAD\nE, {label}, {value:.15g}\n", dialect)
    axis = {"PX": 0, "PY": 1, "P1": 1, "PZ": 2, "P2": 2}[label]
    if axis == 0:
        assert end[0] == pytest.approx(FORCE * LENGTH**2 / (2 * MODULUS * section.area), rel=5e-3)
        return
    inertia = section.inertia_1 if axis == 1 else section.inertia_2
    assert end[axis] == pytest.approx(FORCE * LENGTH**4 / (8 * MODULUS * inertia), rel=0.03)
    assert abs(end[3 - axis]) <= (0.1 if name == "box" else 1e-6) * end[axis]


@pytest.mark.parametrize(("dialect", "name", "label", "said"), [
    *(("abaqus", "box", x, "Beams by their section take *CLOAD at their nodes") for x in ("PX", "PY", "PZ")),
    *(("abaqus", "box", x, "beams P1 and P2, those by their section *CLOAD at their nodes") for x in ("P1", "P2")),
    *(("calculix", name, x, "The second field must be P1 to P6") for name in SECTIONS for x in ("PX", "PY", "PZ")),
])  # fmt: skip
def test_refused(run: Run, tmp_path: Path, dialect: str, name: str, label: str, said: str) -> None:
    """A box of B31 is a beam by its section in the abaqus dialect; CalculiX knows no force per length of beams along an axis."""
    deck = beam("B31", SECTIONS[name], CIRCLE if name == "circ" and dialect == "calculix" else "", n=2)
    (tmp_path / "job.inp").write_text(deck + f"*BOUNDARY\n1, 1, 6\n*STEP\n*STATIC\n*DLOAD\nE, {label}, 1.\n*END STEP\n")
    done = run([f"--dialect={dialect}", "--outdir", tmp_path, tmp_path / "job.inp"])
    assert done.returncode == 3
    assert said in " ".join((done.stdout + done.stderr).split()), done.stdout + done.stderr


def elastica(load: float, is_following: bool) -> np.ndarray:
    """The end of an inextensible cantilever, L = 1, E I = 1, under a force per length across it or along y: Runge and Kutta's method from
    the free end, whose slope is found by halving.
    """

    def slopes(state: np.ndarray) -> np.ndarray:  # x, y, angle, moment, force on the rest: over the way back from the end
        _, _, angle, moment, fx, fy = state
        along = np.array([np.cos(angle), np.sin(angle)])
        across = np.array([-along[1], along[0]]) if is_following else np.array([0.0, 1.0])
        return np.array([*-along, -moment, along[0] * fy - along[1] * fx, *(load * across)])

    def root(angle: float, n: int = 400) -> np.ndarray:
        state, h = np.array([0.0, 0.0, angle, 0.0, 0.0, 0.0]), 1 / n
        for _ in range(n):
            a = slopes(state)
            b = slopes(state + h / 2 * a)
            c = slopes(state + h / 2 * b)
            state = state + h / 6 * (a + 2 * b + 2 * c + slopes(state + h * c))
        return state

    low, high = 0.0, load / 6  # the angle of small deflections is the largest
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if root(middle)[2] < 0 else (low, middle)
    return -root(low)[:2]


def test_elastica() -> None:
    """Small loads: q L^4 / (8 E I)."""
    for is_following in (False, True):
        x, y = elastica(0.01, is_following)
        assert y == pytest.approx(0.01 / 8, rel=1e-3)
        assert x == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("label", ["P1", "PY"])
def test_large_deflection(run: Run, tmp_path: Path, label: str) -> None:
    """Under NLGEOM P1 turns with the beam, PY does not: the elastica. P1 acts per length of the stretched side, by some 1 % longer."""
    load = 5.0
    across = load * MODULUS * 0.1**4 / 12 / LENGTH**3
    deck = beam("B32", rectangle(0.1, 0.1), n=10) + f"*BOUNDARY\n1, 1, 6\n*STEP, NLGEOM\n*STATIC\n.1, 1.\n*DLOAD\nE, {label}, {across:.15g}\n"
    end = end_of(run, tmp_path, deck, "abaqus")
    x, y = elastica(load, label == "P1")
    assert end[:2] == pytest.approx([(x - 1) * LENGTH, y * LENGTH], abs=0.015 * LENGTH)
    other = elastica(load, label != "P1")
    assert np.linalg.norm(other - [x, y]) > 0.03  # what the tolerance distinguishes


def test_two_sections_and_removal(run: Run, tmp_path: Path) -> None:
    """PX on beams of two sections is the same force per length on both; OP=NEW takes it away."""
    deck = beam("B31", rectangle(0.4, 0.6), n=2).replace("ELSET=E, MATERIAL", "ELSET=E1, MATERIAL") + "*ELSET, ELSET=E1\n1\n*ELSET, ELSET=E2\n2\n"
    deck += "*BEAM SECTION, ELSET=E2, MATERIAL=M, SECTION=RECT\n.2, .3\n0., 1., 0.\n*BOUNDARY\n1, 1, 6\n*STEP\n*STATIC\n*DLOAD\nE, PX, .01\n"
    half, big, small = LENGTH / 2, 0.24 * MODULUS, 0.06 * MODULUS
    expected = FORCE * (half * half + half**2 / 2) / big + FORCE * half**2 / 2 / small
    assert end_of(run, tmp_path, deck, "abaqus")[0] == pytest.approx(expected, rel=0.01)
    removed = deck + "*END STEP\n*STEP\n*STATIC\n*DLOAD, OP=NEW\n"
    assert abs(end_of(run, tmp_path, removed, "abaqus")[0]) <= 1e-9 * expected
