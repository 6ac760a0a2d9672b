"""TRANSVERSE SHEAR STIFFNESS: strips of shells, laminates and beams whose deflection is mostly shear, against Timoshenko's beam.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.shells import Shell, shell
from verify.readers.dat_frd_files import read_dat

E, THICK, LENGTH, WIDTH, FORCE = 1000.0, 1.0, 20.0, 2.0, 0.01
LAW = f"*MATERIAL, NAME=M\n*ELASTIC\n{E}, 0.\n"
BENDING = FORCE * LENGTH**3 / (3 * E * WIDTH * THICK**3 / 12)
SOFT = 5.0  #: force per length over strain: shear moves the tip four times as far as bending


def held(nodes: list[int], what: str) -> str:
    """Supports of some nodes (from 0)."""
    return "*BOUNDARY\n" + "".join(f"{i + 1}, {what}\n" for i in nodes)


def tip_of_strip(run_deck: Run, folder: Path, body: Shell, section: str, axis: int = 0, orientation: str = "") -> float:
    """Deflection of a cantilever along the parameter `axis` under a force at its end; its sides keep straight, as those of a wide plate."""
    loads = "*CLOAD\n" + "".join(f"{i + 1}, 3, {FORCE * w:.15g}\n" for i, w in body.edge_weights(axis, 1.0).items())
    deck = f"{body.cards()}{orientation}{section}{held(body.where(axis, 0.0), 'ENCASTRE')}*STEP\n*STATIC\n{loads}"
    done = run_deck(f"{deck}*NSET, NSET=TIP\n{body.at(*((1.0, 0.5) if axis == 0 else (0.5, 1.0))) + 1}\n*NODE PRINT, NSET=TIP\nU\n*END STEP\n")
    assert done.returncode == 0, done.stdout + done.stderr
    return float(next(iter(read_dat(folder / "job.dat")[-1].rows.values()))[2])


def strip(kind: str, axis: int = 0) -> Shell:
    """A strip along x (axis 0) or y (axis 1)."""
    cells = (20, 2) if kind in ("S3", "S4", "S4R") else (10, 2)
    if axis == 0:
        return shell(kind, cells, lambda u, v: (LENGTH * u, WIDTH * v, 0 * u))
    return shell(kind, cells[::-1], lambda u, v: (WIDTH * u, LENGTH * v, 0 * u))


@pytest.mark.parametrize("kind", ["S3", "S4", "S4R", "S6", "S8", "S8R"])
@pytest.mark.parametrize(("axis", "row", "stiffness"), [(0, f"{SOFT}, 300., 0.", SOFT), (1, f"300., {SOFT}", SOFT), (0, f", {SOFT}", SOFT)])
def test_strip(run_deck: Run, tmp_path: Path, kind: str, axis: int, row: str, stiffness: float) -> None:
    """w = F L^3/(3 E I) + F L/(K b), K11 along x and K22 along y; a blank K11 is K22. Elements bend 1 % too stiffly, S3 2 %."""
    section = f"{LAW}*SHELL SECTION, ELSET=E, MATERIAL=M\n{THICK}\n*TRANSVERSE SHEAR STIFFNESS\n{row}\n"
    shear = FORCE * LENGTH / (stiffness * WIDTH)
    assert tip_of_strip(run_deck, tmp_path, strip(kind, axis), section, axis) == pytest.approx(BENDING + shear, rel=0.006)


def test_short_name(run_deck: Run, tmp_path: Path) -> None:
    """*TRANSVERSE SHEAR, as older releases of Abaqus/CAE write it, in a part: the same as the whole name, digit for digit."""
    section = f"{LAW}*SHELL SECTION, ELSET=E, MATERIAL=M\n{THICK}\n*TRANSVERSE SHEAR{{}}\n{SOFT}, 300., 0.\n"
    whole, short = (tip_of_strip(run_deck, tmp_path, strip("S4"), section.format(word)) for word in (" STIFFNESS", ""))
    assert short == whole


def test_mixed_term(run_deck: Run, tmp_path: Path) -> None:
    """K12 couples the shear strains: at Q2 = 0 the stiffness along x is K11, since the strain 23 of the strip is free, less K12^2/K22."""
    body = strip("S4")
    section = f"{LAW}*SHELL SECTION, ELSET=E, MATERIAL=M\n{THICK}\n*TRANSVERSE SHEAR STIFFNESS\n5., 8., 4.\n"
    low, high = FORCE * LENGTH / (5.0 * WIDTH), FORCE * LENGTH / ((5.0 - 16.0 / 8.0) * WIDTH)
    # the twisting moment of the coupling spreads over the width: between both limits, near that of a free shear 23 for a strip of ten widths
    found = tip_of_strip(run_deck, tmp_path, body, section) - BENDING
    assert low * 1.05 < found < high * 1.02


def lamination(plies: list[tuple[float, float]]) -> np.ndarray:
    """A, B, D of isotropic plies without Poisson's ratio: thickness, Young's modulus, from bottom to top."""
    z = np.cumsum([0.0, *[t for t, _ in plies]]) - sum(t for t, _ in plies) / 2
    whole = np.zeros((6, 6))
    for i, (_, young) in enumerate(plies):
        q = young * np.diag([1.0, 1.0, 0.5])
        for (r, c), power in (((0, 0), 1), ((0, 3), 2), ((3, 0), 2), ((3, 3), 3)):
            whole[r : r + 3, c : c + 3] += q * (z[i + 1] ** power - z[i] ** power) / power
    return whole


PLIES = [(0.2, 4000.0), (0.5, 100.0), (0.3, 1500.0)]


def bending_of_plies() -> float:
    """F L^3/(3 D b) of the laminate that is free to stretch."""
    whole = lamination(PLIES)
    rigidity = whole[3, 3] - whole[0, 3] ** 2 / whole[0, 0]
    return FORCE * LENGTH**3 / (3 * rigidity * WIDTH)


@pytest.mark.parametrize("kind", ["S4", "S8R"])
@pytest.mark.parametrize("angle", [0.0, 90.0])
def test_laminate(run_deck: Run, tmp_path: Path, kind: str, angle: float) -> None:
    """A laminate of three plies, each a solid of its own: the stiffness is that of the whole section, in its axes whatever the angles."""
    laws = "".join(f"*MATERIAL, NAME=M{i}\n*ELASTIC\n{young}, 0.\n" for i, (_, young) in enumerate(PLIES))
    layers = "".join(f"{t}, 3, M{i}, {angle * i}\n" for i, (t, _) in enumerate(PLIES))
    section = f"{laws}*SHELL SECTION, ELSET=E, COMPOSITE\n{layers}*TRANSVERSE SHEAR STIFFNESS\n{SOFT}, 40., 0.\n"
    expected = bending_of_plies() + FORCE * LENGTH / (SOFT * WIDTH)
    assert tip_of_strip(run_deck, tmp_path, strip(kind), section) == pytest.approx(expected, rel=0.015), "fibres stay straight at clamp and load"


@pytest.mark.parametrize("kind", ["S4", "S8R"])
@pytest.mark.parametrize("is_given", [True, False])
def test_stiffness_of_a_section(run_deck: Run, tmp_path: Path, kind: str, is_given: bool) -> None:
    """Five layers of a section by its stiffness have K11, or without the card (D11 + D22)/6 + D33/3 of the membrane part."""
    whole = lamination([(THICK, E)])
    if not is_given:
        whole[3:, 3:] *= 1.0
    numbers = [float(whole[i, j]) for j in range(6) for i in range(j + 1)]
    rows = "".join(", ".join(f"{x:.15g}" for x in numbers[k : k + 8]) + "\n" for k in (0, 8, 16))
    section = f"*SHELL GENERAL SECTION, ELSET=E\n{rows}" + (f"*TRANSVERSE SHEAR STIFFNESS\n{SOFT}, 40.\n" if is_given else "")
    length = LENGTH if is_given else 2.0  # a short strip where the shear is not soft
    body = shell(kind, (20 if kind == "S4" else 10, 2), lambda u, v: (length * u, WIDTH * v, 0 * u))
    stiffness = SOFT if is_given else (whole[0, 0] + whole[1, 1]) / 6 + whole[2, 2] / 3
    expected = FORCE * length**3 / (3 * E * WIDTH / 12) + FORCE * length / (stiffness * WIDTH)
    tolerance = 0.01 if is_given else 0.03
    assert tip_of_strip(run_deck, tmp_path, body, section) == pytest.approx(expected, rel=tolerance), "fibres stay straight at clamp and load"


def test_axisymmetric_plate(run_deck: Run, tmp_path: Path) -> None:
    """A clamped circular plate under pressure, SAX1: w = p a^4/(64 D) + p a^2/(4 K) in the middle. Reference: R. D. Mindlin, J. Appl. Mech. 18 (1951)."""
    radius, pressure, n = 10.0, 0.01, 40
    nodes = "".join(f"{i + 1}, {radius * i / n:.15g}, 0.\n" for i in range(n + 1))
    elements = "".join(f"{i + 1}, {i + 1}, {i + 2}\n" for i in range(n))
    deck = f"*NODE, NSET=N\n{nodes}*ELEMENT, TYPE=SAX1, ELSET=E\n{elements}{LAW}*SHELL SECTION, ELSET=E, MATERIAL=M\n{THICK}\n*TRANSVERSE SHEAR STIFFNESS\n2.\n"
    deck += f"*BOUNDARY\n1, XSYMM\n{n + 1}, ENCASTRE\n*STEP\n*STATIC\n*DLOAD\nE, P, {pressure}\n*NSET, NSET=MIDDLE\n1\n*NODE PRINT, NSET=MIDDLE\nU\n*END STEP\n"
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr
    found = abs(float(next(iter(read_dat(tmp_path / "job.dat")[-1].rows.values()))[1]))
    expected = pressure * radius**4 / (64 * E / 12) + pressure * radius**2 / (4 * 2.0)
    assert found == pytest.approx(expected, rel=0.005)


@pytest.mark.parametrize(("row", "shear"), [("800., 500., SCF", (500.0, 800.0)), ("800.", (800.0, 800.0)), ("0., 500., 0.25", (500.0, 500.0))])
def test_beam(run_deck: Run, tmp_path: Path, row: str, shear: tuple[float, float]) -> None:
    """A beam by its section: K23 is first and belongs to direction 2, K13 to direction 1."""
    inertia, force = (30.0, 20.0), (3.0, -2.0)  # I11 resists moments about direction 1
    deck = "*NODE\n1, 0., 0., 0.\n2, 12., 0., 0.\n*NSET, NSET=TIP\n2\n*ELEMENT, TYPE=B31, ELSET=E\n1, 1, 2\n*BEAM GENERAL SECTION, ELSET=E, SECTION=GENERAL\n"
    deck += f"10., {inertia[0]}, 0., {inertia[1]}, 5.\n0., 1., 0.\n{E}, 400.\n*TRANSVERSE SHEAR STIFFNESS\n{row}\n*BOUNDARY\n1, ENCASTRE\n*STEP\n*STATIC\n"
    done = run_deck(f"{deck}*CLOAD\n2, 2, {force[0]}\n2, 3, {force[1]}\n*NODE PRINT, NSET=TIP\nU\n*END STEP\n")
    assert done.returncode == 0, done.stdout + done.stderr
    moved = next(iter(read_dat(tmp_path / "job.dat")[-1].rows.values()))
    for axis in (0, 1):
        expected = force[axis] * (12.0**3 / (3 * E * inertia[1 - axis]) + 12.0 / shear[axis])
        assert moved[1 + axis] == pytest.approx(expected, rel=1e-6)


PLATE = "*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 1., 1., 0.\n4, 0., 1., 0.\n*ELEMENT, TYPE=S4, ELSET=E\n1, 1, 2, 3, 4\n*ELEMENT, TYPE=B31, ELSET=B\n2, 1, 2\n"
REST = "*BOUNDARY\n1, ENCASTRE\n*STEP\n*STATIC\n*CLOAD\n3, 3, 1.\n*END STEP\n"
SHEET = "*SHELL SECTION, ELSET=E, MATERIAL=M\n0.1\n"
RIB = "*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION={}\n"


@pytest.mark.parametrize(
    ("sections", "law", "option", "words"),
    [
        (SHEET + "*TRANSVERSE SHEAR STIFFNESS\n5., 5., 7.\n" + RIB.format("RECT") + "1., 1.\n0., 1., 0.\n", LAW, "abaqus", "K11 K22 must be larger than the square"),
        (SHEET + "*TRANSVERSE SHEAR STIFFNESS\n-5., 5.\n" + RIB.format("RECT") + "1., 1.\n0., 1., 0.\n", LAW, "abaqus", "K11 and K22 must be positive"),
        (SHEET + "*TRANSVERSE SHEAR STIFFNESS\n" + RIB.format("RECT") + "1., 1.\n0., 1., 0.\n", LAW, "abaqus", "The data line is missing"),
        (SHEET + "*TRANSVERSE SHEAR STIFFNESS\n5.\n" + RIB.format("RECT") + "1., 1.\n0., 1., 0.\n", LAW + "*PLASTIC\n5., 0.\n", "abaqus", "is not linear elastic"),
        (SHEET + "*TRANSVERSE SHEAR STIFFNESS\n5.\n" + RIB.format("RECT") + "1., 1.\n0., 1., 0.\n", LAW, "calculix", "CalculiX has no *TRANSVERSE SHEAR STIFFNESS"),
        (SHEET + RIB.format("RECT") + "1., 1.\n0., 1., 0.\n*TRANSVERSE SHEAR STIFFNESS\n5.\n", LAW, "abaqus", "whose shear stiffness is that of their material"),
        ("*SHELL SECTION, ELSET=E, MATERIAL=M, NODAL THICKNESS\n0.1\n*TRANSVERSE SHEAR STIFFNESS\n5.\n" + RIB.format("RECT") + "1., 1.\n0., 1., 0.\n", LAW, "abaqus", "with NODAL THICKNESS takes no"),
        ("*TRANSVERSE SHEAR STIFFNESS\n5.\n" + SHEET + RIB.format("RECT") + "1., 1.\n0., 1., 0.\n", LAW, "abaqus", "*SHELL SECTION"),
    ],
)  # fmt: skip
def test_refused(run_deck: Run, sections: str, law: str, option: str, words: str) -> None:
    """What the card does not go with."""
    done = run_deck(PLATE + law + sections + REST, f"--dialect={option}")
    assert done.returncode == 3, done.stdout
    assert words in " ".join((done.stdout + done.stderr).split())
