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


def hexagon_section(r: float, t: float) -> tuple[float, ...]:
    """The same of a hollow hexagon: outer less inner one, J by Bredt along the middle line of length 6 m."""
    p, m = r - 2 * t / np.sqrt(3), r - t / np.sqrt(3)
    about = 5 * np.sqrt(3) / 16 * (r**4 - p**4)
    return 1.5 * np.sqrt(3) * (r**2 - p**2), about, about, 4 * (1.5 * np.sqrt(3) * m**2) ** 2 * t / (6 * m), 0.53


def rectangle_section(a: float, b: float) -> tuple[float, ...]:
    """The same of a solid rectangle, J by the series of Saint-Venant, with the shear factor of a trapezoid."""
    n = np.arange(1, 200, 2)
    torsion = a**3 * b / 3 * (1 - 192 * a / (np.pi**5 * b) * np.sum(np.tanh(n * np.pi * b / (2 * a)) / n**5))
    return a * b, a * b**3 / 12, b * a**3 / 12, torsion, 0.822


def cross_section(h: float, b: float, t: float) -> tuple[float, ...]:
    """The same of a cross of two thin walls of length 2 h and 2 b through the node."""
    return 2 * (h + b) * t, t * (2 * h) ** 3 / 12, t * (2 * b) ** 3 / 12, 2 * (h + b) * t**3 / 3, 1.0


GENERAL = (2848.0, 1.94e7, 1.42e6, 6.98e4, 1.0)
MATERIAL = f"*MATERIAL, NAME=M\n*ELASTIC\n{E}, {NU}\n"
CARDS = {  #: numbers, card, lines behind the direction
    "i": (i_section(200.0, 100.0, 8.5, 5.6), MATERIAL + "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=I\n100., 200., 100., 100., 8.5, 8.5, 5.6\n", ""),
    "box": (box_section(60.0, 100.0, 4.0), MATERIAL + "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=BOX\n60., 100., 4., 4., 4., 4.\n", ""),
    "hex": (hexagon_section(50.0, 4.0), MATERIAL + "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=HEX\n50., 4.\n", ""),
    "trapezoid": (
        rectangle_section(40.0, 60.0),
        MATERIAL + "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=TRAPEZOID\n40., 60., 40., 30.\n",
        "5, 5\n",
    ),
    "cross": (
        cross_section(50.0, 30.0, 4.0),
        MATERIAL
        + "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=ARBITRARY\n"
        + "6, 0., -50., 0., 0., 4.\n30., 0., 4.\n0., 0., 0.\n-30., 0., 4.\n0., 0., 0.\n0., 50., 4.\n",
        "",
    ),
    "general": (GENERAL, "*BEAM GENERAL SECTION, ELSET=E, SECTION=GENERAL\n2848., 1.94e7, 0., 1.42e6, 6.98e4\n", f"{E}, {G!r}\n"),
    "l": ((), MATERIAL + "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=L\n80., 120., 10., 10.\n", ""),
    "channel": (
        (),
        MATERIAL + "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=ARBITRARY\n3, 60., -75., 0., -75., 6.\n0., 75., 6.\n60., 75., 6.\n",
        "",
    ),
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


EVEN = [name for name, (numbers, _, _) in CARDS.items() if numbers]  #: sections with both axes of symmetry


@pytest.mark.parametrize("n", [1, 3])
@pytest.mark.parametrize("name", EVEN)
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


@pytest.mark.parametrize("name", EVEN)
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


def tip(done_in: Path, node: int) -> np.ndarray:
    """Displacements of a node along axes 1, 2 and the tangent."""
    u = np.array(read_dat(done_in / "job.dat")[-1].rows[(node,)])
    return np.array([u @ AXIS_1, u @ AXIS_2, u @ TANGENT])


def test_angle(run_deck: Run, tmp_path: Path) -> None:
    """An angle bends obliquely: a force along its leg gives the deflections of both principal axes; through its node, where the
    middle lines meet, it does not twist. A pull at the node bends it about the centroid."""
    a, b, t = 80.0, 120.0, 10.0
    area = (a + b - t) * t
    c = np.array([a * t * (a / 2 - t / 2), (b - t) * t * b / 2]) / area
    about_1 = a * t**3 / 12 + a * t * c[1] ** 2 + t * (b - t) ** 3 / 12 + (b - t) * t * (b / 2 - c[1]) ** 2
    about_2 = t * a**3 / 12 + a * t * (a / 2 - t / 2 - c[0]) ** 2 + (b - t) * t**3 / 12 + (b - t) * t * c[0] ** 2
    product = a * t * (a / 2 - t / 2 - c[0]) * -c[1] + (b - t) * t * -c[0] * (b / 2 - c[1])
    second = np.array([[about_2, product], [product, about_1]])  # of x1 and x2
    load = FORCE[0] * AXIS_1 + FORCE[1] * AXIS_2
    text = deck("l", 2, "".join(f"3, {i + 1}, {float(f)!r}\n" for i, f in enumerate(load)))
    done = run_deck(text, "--dialect=abaqus")
    assert done.returncode == 0 and "WARNING" not in done.stdout, done.stdout
    bent = LENGTH**3 / (3 * E) * np.linalg.solve(second, FORCE) + LENGTH / (G * area) * FORCE
    slope = LENGTH**2 / (2 * E) * np.linalg.solve(second, FORCE)
    expected = np.array([*bent, slope @ c])  # the tangent displacement at the node: the centroid stays
    assert np.abs(tip(tmp_path, 3) - expected).max() < 1e-6 * np.abs(expected).max()  # seven digits are printed
    pull = "".join(f"3, {i + 1}, {float(f)!r}\n" for i, f in enumerate(PULL * TANGENT))
    assert run_deck(deck("l", 2, pull), "--dialect=abaqus").returncode == 0
    curvature = np.linalg.solve(second, PULL * c) / E  # pulls the side of the node: it bends away from the centroid
    expected = np.array([*(curvature * LENGTH**2 / 2), PULL * LENGTH / (E * area) + curvature @ c * LENGTH])
    assert np.abs(tip(tmp_path, 3) - expected).max() < 1e-6 * np.abs(expected).max()


@pytest.mark.parametrize("at_shear_centre", [True, False])
def test_channel(run_deck: Run, tmp_path: Path, at_shear_centre: bool) -> None:
    """A channel bends without twist only under a force through its shear centre, b^2 h^2 t/(4 I) behind its web (Timoshenko,
    Strength of Materials I, section 52); at the web it twists by F e L/(G J)."""
    b, h, t = 60.0, 150.0, 6.0
    inertia = t * h**3 / 12 + 2 * b * t * (h / 2) ** 2
    e = b**2 * h**2 * t / (4 * inertia)
    force = 500.0
    load = force * AXIS_2
    moment = -e * force * TANGENT if at_shear_centre else 0 * TANGENT
    loads = "".join(f"2, {i + 1}, {float(f)!r}\n" for i, f in enumerate([*load, *moment]))
    done = run_deck(deck("channel", 1, loads).replace("\nU\n", "\nU, UR\n"), "--dialect=abaqus")
    assert done.returncode == 0, done.stdout
    tables = read_dat(tmp_path / "job.dat")
    turn = np.array(tables[-1].rows[(2,)])[-3:] @ TANGENT
    torsion = (2 * b + h) * t**3 / 3
    expected = 0.0 if at_shear_centre else force * e * LENGTH / (G * torsion)
    assert turn == pytest.approx(expected, abs=1e-6 * force * e * LENGTH / (G * torsion))


def test_missing_node(run_deck: Run) -> None:
    """A beam by its section with a node that the deck does not define is an error of the deck."""
    done = run_deck(
        "*NODE\n1, 0., 0., 0.\n*ELEMENT, TYPE=B31, ELSET=E\n1, 1, 2\n*MATERIAL, NAME=M\n*ELASTIC\n210000., 0.3\n"
        "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=I\n100., 200., 100., 100., 8.5, 8.5, 5.6\n0., 1., 0.\n"
        "*STEP\n*STATIC\n*BOUNDARY\n1, ENCASTRE\n*END STEP\n"
    )
    assert done.returncode == 3, done.stdout + done.stderr
    assert "There is no node 2." in done.stdout + done.stderr


@pytest.mark.parametrize("order", ["beams first", "shells first"])
def test_beam_on_a_shell(run_deck: Run, tmp_path: Path, order: str) -> None:
    """An I-beam stands on a plate that is held all around: it bends by F h^3/(3 E I) + F h/(k G A) against the fibre of the plate at its foot, to the digits
    of the table, twists by T h/(G J), of which the plate adds 3 % at most, and the moments of the supports are those of the loads.
    """
    height, force, torque = 200.0, 30.0, 50.0
    area, j = 2 * 100 * 8.5 + 183 * 5.6, (2 * 100 * 8.5**3 + 191.5 * 5.6**3) / 3
    inertia = (100 * 200**3 - (100 - 5.6) * 183**3) / 12
    plate = "".join(f"{10 * i + k + 1}, {100. * i}, {100. * k}, 0.\n" for i in range(5) for k in range(5))
    shells = "*ELEMENT, TYPE=S4, ELSET=PLATE\n" + "".join(f"{100 + 10 * i + k}, {10 * i + k + 1}, {10 * i + k + 11}, {10 * i + k + 12}, {10 * i + k + 2}\n" for i in range(4) for k in range(4))
    beams = "*ELEMENT, TYPE=B31, ELSET=COLUMN\n501, 23, 51\n502, 51, 52\n"
    edge = "".join(f"{10 * i + k + 1}, 1, 3\n" for i in range(5) for k in range(5) if {i, k} & {0, 4})
    text = f"*NODE, NSET=ALL\n{plate}51, 200., 200., {height / 2}\n52, 200., 200., {height}\n" + (beams + shells if order == "beams first" else shells + beams)
    text += MATERIAL + "*SHELL SECTION, ELSET=PLATE, MATERIAL=M\n85.\n*BEAM SECTION, ELSET=COLUMN, MATERIAL=M, SECTION=I\n100., 200., 100., 100., 8.5, 8.5, 5.6\n0., 1., 0.\n"
    text += f"*BOUNDARY\n{edge}*STEP\n*STATIC\n*CLOAD\n52, 1, {force}\n52, 6, {torque}\n*NODE PRINT, NSET=ALL\nU, UR, RF\n*END STEP\n"
    done = run_deck(text)
    assert done.returncode == 0, done.stdout + done.stderr
    moved, turned, forces = (table.rows for table in read_dat(tmp_path / "job.dat"))
    places = {10 * i + k + 1: np.array([100.0 * i, 100.0 * k, 0.0]) for i in range(5) for k in range(5)}
    moment = np.sum([np.cross(places[n], forces[(n,)]) for n in places], axis=0)
    assert np.abs(moment + np.cross([200, 200, height], [force, 0, 0]) + [0, 0, torque]).max() <= 1e-5 * 200 * force
    lengths = height**3 / (3 * E * inertia) + height / (0.44 * G * area)
    assert moved[(52,)][0] - moved[(23,)][0] - turned[(23,)][1] * height == pytest.approx(force * lengths, rel=1e-5)
    assert turned[(52,)][2] == pytest.approx(torque * height / (G * j), rel=0.03)
