"""Beams and shells that a temperature stretches and its gradient bends: free ends move as alpha T L and alpha T' L^2 / 2.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.beams import LENGTH, MODULUS, Section, beam, box, circle, pipe, rectangle
from verify.decks.shells import shell
from verify.readers.dat_frd_files import read_dat

ALPHA, MEAN, ALONG_2, ALONG_1 = 1e-5, 100.0, 20.0, 30.0
STRETCH, BEND_2, BEND_1 = (ALPHA * MEAN * LENGTH, *(-ALPHA * slope * LENGTH**2 / 2 for slope in (ALONG_2, ALONG_1)))
SECTIONS = {"rect": rectangle(0.4, 0.6), "circ": circle(0.3), "pipe": pipe(0.3, 0.05), "box": box(0.6, 0.4, (0.02, 0.04, 0.03, 0.02))}
CIRCLE = ".6, .6"  #: of the calculix dialect


def cards(rows: str) -> str:
    """Expansion of the material without Poisson's ratio, a clamp, and temperatures that grow from zero."""
    clamp = "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nN, 0.\n*BOUNDARY\nROOT, 1, 6\n"
    return clamp + f"*STEP\n*STATIC\n*TEMPERATURE\n{rows}*NODE PRINT, NSET=END\nU\n*END STEP\n"


def expanding(deck: str) -> str:
    """The deck with thermal expansion and without lateral contraction."""
    expanded = deck.replace(f"{MODULUS:.15g}, 0.3", f"{MODULUS:.15g}, 0.\n*EXPANSION\n{ALPHA}")
    assert expanded != deck
    return expanded


def end_of(run: Run, folder: Path, deck: str, dialect: str) -> np.ndarray:
    """The mean displacement of the set END."""
    (folder / "job.inp").write_text(expanding(deck))
    done = run([f"--dialect={dialect}", "--outdir", folder, folder / "job.inp"])
    assert done.returncode == 0, done.stdout + done.stderr
    rows = read_dat(folder / "job.dat")[-1].rows
    return np.mean(list(rows.values()), axis=0)


@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
@pytest.mark.parametrize("name", SECTIONS)
@pytest.mark.parametrize("kind", ["B31", "B31R", "B32", "B32R"])
def test_beams(run: Run, tmp_path: Path, kind: str, name: str, dialect: str) -> None:
    """Direction 1 is y, 2 is z. Rectangles of B31 in the calculix dialect have the mean temperature, as in CalculiX; the corners of round
    sections there lie on the circle, over which the points see a gradient that is 3 to 8 % too small.
    """
    section: Section = SECTIONS[name]
    deck = beam(kind, section, CIRCLE if name == "circ" and dialect == "calculix" else "", n=4)
    deck += "*NSET, NSET=ROOT\n1\n" + cards(f"N, {MEAN}, {ALONG_2}, {ALONG_1}\n")
    if name == "box" and dialect == "abaqus":  # a beam by its section
        (tmp_path / "job.inp").write_text(expanding(deck))
        done = run(["--outdir", tmp_path, tmp_path / "job.inp"])
        assert done.returncode == 3
        assert "Beams by their section do not expand with *TEMPERATURE" in " ".join((done.stdout + done.stderr).split())
        return
    end = end_of(run, tmp_path, deck, dialect)
    has_mean = name == "rect" and kind.startswith("B31") and dialect == "calculix"
    allowed = 0.1 if name == "circ" and dialect == "calculix" else 2e-3
    assert end[0] == pytest.approx(STRETCH, rel=2e-3)
    assert end[1:] == pytest.approx([0.0, 0.0] if has_mean else [BEND_1, BEND_2], rel=allowed, abs=1e-9)


@pytest.mark.parametrize("name", ["circ", "pipe"])
def test_ends_of_different_temperature(run: Run, tmp_path: Path, name: str) -> None:
    """The middle of a beam of two nodes has the mean of its ends, whose amplitudes differ: halfway both ends together give a quarter and a
    half of the last value.
    """
    deck = beam("B31", SECTIONS[name], n=1).replace("*NODE, NSET=N", "*AMPLITUDE, NAME=LATE\n0., 0., .5, .5, 1., 1.\n*NODE, NSET=N")
    deck += "*NSET, NSET=ROOT\n1\n" + cards("1, 40.\n").replace("*NODE PRINT", "*TEMPERATURE, AMPLITUDE=LATE\n2, 80.\n*NODE PRINT")
    end = end_of(run, tmp_path, deck.replace("*STATIC\n", "*STATIC\n.5, 1.\n"), "abaqus")
    assert end[0] == pytest.approx(ALPHA * 60.0 * LENGTH, rel=2e-3)


@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
@pytest.mark.parametrize("kind", ["S3", "S4", "S4R", "S6", "S8", "S8R"])
def test_shells(run: Run, tmp_path: Path, kind: str, dialect: str) -> None:
    """A strip that may contract along its clamp. In the calculix dialect S4 and S4R have the mean temperature, and S3 locks, both as in
    CalculiX (verify/peers/test_nodal_stresses.py).
    """
    body = shell(kind, (8, 2), lambda u, v: (LENGTH * u, 2 * v - 1, 0 * u))
    sets = "".join(f"*NSET, NSET={name}\n" + "".join(f"{i + 1}\n" for i in body.where(0, u)) for name, u in (("ROOT", 0.0), ("END", 1.0)))
    middle = f"{body.at(0, 0.5) + 1}, 2\n"
    deck = body.cards() + sets + f"*MATERIAL, NAME=M\n*ELASTIC\n{MODULUS:.15g}, 0.3\n*SHELL SECTION, ELSET=E, MATERIAL=M\n0.4\n"
    deck += cards(f"N, {MEAN}, {ALONG_2}\n").replace("ROOT, 1, 6\n", "ROOT, 1\nROOT, 3\nROOT, 5\n" + middle)
    end = end_of(run, tmp_path, deck, dialect)
    has_mean = kind.startswith("S4") and dialect == "calculix"
    assert end[0] == pytest.approx(STRETCH, rel=1e-3)
    locks = kind == "S3" and dialect == "calculix"
    assert end[2] == pytest.approx(0.0 if has_mean else BEND_2, rel=0.35 if locks else 0.02, abs=1e-9)
