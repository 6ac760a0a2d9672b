"""Beams by their section: a cantilever in any direction, in both dialects, against the closed forms of Timoshenko's beam.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.readers.dat_frd_files import read_dat

E, NU, LENGTH = 210000.0, 0.3, 600.0
G = E / (2 + 2 * NU)
TANGENT = np.array([2.0, 1.0, 2.0]) / 3  #: of the beam
AXIS_1 = np.array([1.0, -2.0, 0.0]) / np.sqrt(5.0)
AXIS_2 = np.cross(TANGENT, AXIS_1)
FORCE, PULL, TORQUE = np.array([700.0, -400.0]), 9000.0, 50000.0  #: along axes 1, 2; along and about the tangent


def i_section(h: float, b: float, t: float, s: float) -> tuple[float, ...]:
    """Area, moments about axes 1 and 2, J and the shear factor of a symmetric I, as two flanges and a web."""
    web = h - 2 * t
    about_1 = 2 * (b * t**3 / 12 + b * t * ((h - t) / 2) ** 2) + s * web**3 / 12
    return 2 * b * t + s * web, about_1, 2 * t * b**3 / 12 + web * s**3 / 12, (2 * b * t**3 + web * s**3) / 3, 0.44


def box_section(a: float, b: float, t: float) -> tuple[float, ...]:
    """The same of a box: outer less inner rectangle, J by Bredt."""
    p, q = a - 2 * t, b - 2 * t
    return a * b - p * q, (a * b**3 - p * q**3) / 12, (b * a**3 - q * p**3) / 12, 2 * t * ((a - t) * (b - t)) ** 2 / (a + b - 2 * t), 0.44


GENERAL = (2848.0, 1.94e7, 1.42e6, 6.98e4, 1.0)
MATERIAL = f"*MATERIAL, NAME=M\n*ELASTIC\n{E}, {NU}\n"
CARDS = {
    "i": (i_section(200.0, 100.0, 8.5, 5.6), MATERIAL + "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=I\n100., 200., 100., 100., 8.5, 8.5, 5.6\n", ""),
    "box": (box_section(60.0, 100.0, 4.0), MATERIAL + "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=BOX\n60., 100., 4., 4., 4., 4.\n", ""),
    "general": (GENERAL, "*BEAM GENERAL SECTION, ELSET=E, SECTION=GENERAL\n2848., 1.94e7, 0., 1.42e6, 6.98e4\n", f"{E}, {G!r}\n"),
    "u1": ((2848.0, 1.94e7, 1.42e6, 1.94e7 + 1.42e6, 0.8), MATERIAL + "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=GENERAL\n2848., 1.42e6, 0., 1.94e7, 0.8\n", ""),
}


def vector(v: np.ndarray) -> str:
    """Three numbers of a data line."""
    return ", ".join(repr(float(c)) for c in v)


def deck(name: str, n: int, loads: str) -> str:
    """A cantilever of n elements, clamped at node 1; U of all nodes is printed."""
    _, card, last = CARDS[name]
    nodes = "".join(f"{i + 1}, {vector(LENGTH * i / n * TANGENT)}\n" for i in range(n + 1))
    elements = "".join(f"{i}, {i}, {i + 1}\n" for i in range(1, n + 1))
    user = "*USER ELEMENT, TYPE=U1, NODES=2, INTEGRATION POINTS=2, MAXDOF=6\n" if name == "u1" else ""
    kind = "U1" if name == "u1" else "B31"
    step = f"*BOUNDARY\n1, 1, 6\n*STEP\n*STATIC\n*CLOAD\n{loads}*NODE PRINT, NSET=ALL\nU\n*END STEP\n"
    return f"*NODE, NSET=ALL\n{nodes}{user}*ELEMENT, TYPE={kind}, ELSET=E\n{elements}{card}{vector(AXIS_1)}\n{last}{step}"


@pytest.mark.parametrize("n", [1, 3])
@pytest.mark.parametrize("name", list(CARDS))
def test_cantilever(run_deck: Run, tmp_path: Path, name: str, n: int) -> None:
    """The tip under a force: deflection F L^3/(3 E I) + F L/(k G A) along both axes, and stretch; with any number of elements."""
    area, about_1, about_2, _, k = CARDS[name][0]
    load = FORCE[0] * AXIS_1 + FORCE[1] * AXIS_2 + PULL * TANGENT
    loads = "".join(f"{n + 1}, {i + 1}, {float(f)!r}\n" for i, f in enumerate(load))
    done = run_deck(deck(name, n, loads), f"--dialect={'calculix' if name == 'u1' else 'abaqus'}")
    assert done.returncode == 0 and "WARNING" not in done.stdout, done.stdout
    u = np.array(read_dat(tmp_path / "job.dat")[-1].rows[(n + 1,)])
    shear = LENGTH / (k * G * area)
    expected = FORCE[0] * (LENGTH**3 / (3 * E * about_2) + shear) * AXIS_1 + FORCE[1] * (LENGTH**3 / (3 * E * about_1) + shear) * AXIS_2
    expected = expected + PULL * LENGTH / (E * area) * TANGENT
    assert np.abs(u - expected).max() < 1e-6 * np.abs(expected).max()  # seven digits are printed


@pytest.mark.parametrize("name", list(CARDS))
def test_twist(run_deck: Run, tmp_path: Path, name: str) -> None:
    """A torque turns the tip by T L/(G J): seen at the end of a stiff arm, a second beam across, by its displacement."""
    torsion = CARDS[name][0][3]
    arm = 10.0
    loads = "".join(f"3, {i + 4}, {float(f)!r}\n" for i, f in enumerate(TORQUE * TANGENT))
    text = deck(name, 1, loads).replace("*ELEMENT", f"3, {vector(LENGTH * TANGENT + arm * AXIS_2)}\n*ELEMENT", 1)
    if name == "u1":  # nodes come before the card of the type
        text = deck(name, 1, loads).replace("*USER", f"3, {vector(LENGTH * TANGENT + arm * AXIS_2)}\n*USER", 1)
    text = text.replace("1, 1, 2\n", "1, 1, 2\n2, 2, 3\n", 1)
    done = run_deck(text, f"--dialect={'calculix' if name == 'u1' else 'abaqus'}")
    assert done.returncode == 0, done.stdout
    rows = read_dat(tmp_path / "job.dat")[-1].rows
    # the torque bends the arm, too: curvature about the tangent, which is an axis of its section across AXIS_1
    bent = TORQUE * arm**2 / (2 * E * CARDS[name][0][2])
    moved = float((np.array(rows[(3,)]) - np.array(rows[(2,)])) @ -AXIS_1)
    assert moved == pytest.approx(TORQUE * LENGTH / (G * torsion) * arm + bent, rel=2e-6)  # seven digits are printed
