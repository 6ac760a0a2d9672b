"""Loads on volumes and times of output against closed forms, and what their cards refuse.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from verify.conftest import Run
from verify.decks.solids import UNIT_CUBE
from verify.readers.sta_cvg_files import read_sta

YOUNG, DENSITY, LENGTH = 1000.0, 2.0, 4.0
DIGITS = 2e-6  # seven digits are printed

MATERIAL = f"*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, 0.\n*DENSITY\n{DENSITY}\n"


def bar(kind: str = "C3D8", material: str = MATERIAL) -> str:
    """Four cubes in a row along x, held at x = 0; sets BAR, ROOT (nodes at x = 0), TIP (at x = LENGTH)."""
    nodes = [(x, y, z) for x in range(5) for y, z in ((0, 0), (1, 0), (1, 1), (0, 1))]
    rows = "".join(f"{i}, {x}, {y}, {z}\n" for i, (x, y, z) in enumerate(nodes, 1))
    order = [1, 2, 3, 4]
    cells = "".join(f"{e + 1}, " + ", ".join(str(4 * e + k) for k in order) + ", " + ", ".join(
        str(4 * (e + 1) + k) for k in order) + "\n" for e in range(4))
    return (f"*NODE\n{rows}*ELEMENT, TYPE={kind}, ELSET=BAR\n{cells}*NSET, NSET=ROOT\n1, 2, 3, 4\n*NSET, NSET=TIP\n17, 18, 19, 20\n"
            f"*NSET, NSET=ALL, GENERATE\n1, 20\n{material}*SOLID SECTION, ELSET=BAR, MATERIAL=M\n*BOUNDARY\nROOT, 1, 1\n1, 2, 3\n2, 3, 3\n")


def blocks(folder: Path, title: str) -> list[tuple[float, dict[int, list[float]]]]:
    """Time and rows of each block of a title in job.dat."""
    result: list[tuple[float, dict[int, list[float]]]] = []
    is_inside = False
    for line in (folder / "job.dat").read_text().splitlines():
        if head := re.match(r" (\D+) \(.*time +(\S+)", line):
            is_inside = head.group(1) == title
            if is_inside:
                result.append((float(head.group(2)), {}))
        elif is_inside and re.match(r" +\d", line) and (words := line.split()):
            result[-1][1][int(words[0])] = [float(word) for word in words[1:]]
    return result


def run_bar(run_deck: Run, loads: str, step: str = "*STEP\n*STATIC\n", model: str | None = None) -> None:
    """Runs a deck of the bar."""
    done = run_deck(f"{model or bar()}{step}{loads}*NODE PRINT, NSET=ALL\nU, RF\n*END STEP\n")
    assert done.returncode == 0, done.stdout + done.stderr


def refused(run_deck: Run, deck: str) -> str:
    """The message about a deck that has to be refused."""
    done = run_deck(deck)
    assert done.returncode == 3, f"exit {done.returncode}\n{done.stdout}"
    return str(done.stdout + done.stderr)


@pytest.mark.parametrize("kind", ["C3D8", "C3D8R", "C3D8I"])
def test_rotating_bar(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """A bar that turns about its end: u = rho omega^2 (L^2 x / 2 - x^3 / 6) / E, exact at the nodes of linear elements."""
    omega2 = 0.5
    run_bar(run_deck, f"*DLOAD\nBAR, CENTRIF, {omega2}, 0., .5, .5, 0., 0., 3.\n", model=bar(kind))
    u, rf = blocks(tmp_path, "displacements")[-1][1], blocks(tmp_path, "forces")[-1][1]
    for node in (9, 18):
        x = (node - 1) // 4
        exact = DENSITY * omega2 * (LENGTH**2 * x / 2 - x**3 / 6) / YOUNG
        # the force across the axis, rho omega^2 (y - 1/2), does not move the mean of the section
        mean = sum(u[4 * x + k][0] for k in (1, 2, 3, 4)) / 4
        assert mean == pytest.approx(exact, rel=DIGITS)
    assert sum(rf[n][0] for n in (1, 2, 3, 4)) == pytest.approx(-DENSITY * omega2 * LENGTH**2 / 2, rel=DIGITS)


def test_axis_along_the_bar_does_nothing(run_deck: Run, tmp_path: Path) -> None:
    """About its own axis the bar is only drawn apart across it."""
    run_bar(run_deck, "*DLOAD\nBAR, CENTRIF, .5, -7., .5, .5, 1., 0., 0.\n")
    assert all(abs(row[0]) < 1e-12 for row in blocks(tmp_path, "displacements")[-1][1].values())


@pytest.mark.parametrize(("label", "k"), [("BX", 0), ("BY", 1), ("BZ", 2)])
def test_body_force(run_deck: Run, tmp_path: Path, label: str, k: int) -> None:
    """A force per volume needs no density; along the bar u(L) = b L^2 / (2 E)."""
    material = f"*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, 0.\n"
    extra = "ROOT, 2, 3\n"
    run_bar(run_deck, f"*DLOAD\nBAR, {label}, 3.\n", model=bar(material=material) + "*BOUNDARY\n" + extra)
    rf = blocks(tmp_path, "forces")[-1][1]
    assert sum(rf[n][k] for n in (1, 2, 3, 4)) == pytest.approx(-3.0 * LENGTH, rel=DIGITS)
    if k == 0:
        assert blocks(tmp_path, "displacements")[-1][1][17][0] == pytest.approx(3.0 * LENGTH**2 / (2 * YOUNG), rel=DIGITS)


def test_mass_on_a_spring_turns(run_deck: Run, tmp_path: Path) -> None:
    """Under NLGEOM the arm grows with the force: k (r - L) = m omega^2 r, so r = L k / (k - m omega^2)."""
    k, mass, omega2, length = 10.0, 2.0, 2.0, 1.5
    deck = (f"*NODE, NSET=ALL\n1, 0, 0, 0\n2, {length}, 0, 0\n*ELEMENT, TYPE=SPRINGA, ELSET=S\n1, 1, 2\n*ELEMENT, TYPE=MASS, ELSET=M\n"
            f"2, 2\n*SPRING, ELSET=S\n\n{k}\n*MASS, ELSET=M\n{mass}\n*BOUNDARY\n1, 1, 3\n2, 2, 3\n*STEP, NLGEOM\n*STATIC\n"
            f"*DLOAD\nM, CENTRIF, {omega2}, 0., 0., 0., 0., 0., 1.\n*NODE PRINT, NSET=ALL\nU\n*END STEP\n")
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    exact = length * k / (k - mass * omega2) - length
    assert blocks(tmp_path, "displacements")[-1][1][2][0] == pytest.approx(exact, rel=DIGITS)
    iterations = sum(attempt.iterations for attempt in read_sta(tmp_path / "job.sta"))
    assert iterations <= 3, "the stiffness of the load is missing"


def test_axisymmetric_ring_turns(run_deck: Run, tmp_path: Path) -> None:
    """A thin ring: hoop stress rho omega^2 R^2, u = rho omega^2 R^3 / E, to the ratio of thickness and radius."""
    radius, thick, omega2 = 10.0, 0.01, 0.3
    nodes = [(radius, 0), (radius + thick, 0), (radius + thick, 1), (radius, 1)]
    deck = "*NODE, NSET=ALL\n" + "".join(f"{i}, {x}, {y}\n" for i, (x, y) in enumerate(nodes, 1))
    deck += f"*ELEMENT, TYPE=CAX4, ELSET=R\n1, 1, 2, 3, 4\n{MATERIAL}*SOLID SECTION, ELSET=R, MATERIAL=M\n*BOUNDARY\n1, 2, 2\n2, 2, 2\n"
    step = "*STEP\n*STATIC\n*DLOAD\nR, CENTRIF, {}, 0., 0., 0., {}\n*NODE PRINT, NSET=ALL\nU\n*END STEP\n"
    done = run_deck(deck + step.format(omega2, "0., 1., 0."))
    assert done.returncode == 0, done.stdout
    mean = radius + thick / 2
    assert blocks(tmp_path, "displacements")[-1][1][1][0] == pytest.approx(DENSITY * omega2 * mean**3 / YOUNG, rel=3 * thick / mean)
    assert "turn about the y axis" in refused(run_deck, deck + step.format(omega2, "1., 0., 0."))


@pytest.mark.parametrize(("row", "message"), [
    ("BAR, CENTRIF, -1., 0., 0., 0., 0., 0., 1.", "not negative"),
    ("BAR, CENTRIF, 1., 0., 0., 0.", "direction must not be zero"),
    ("BAR, NEWTON", "BX, BY, BZ"),
    ("BAR, BX, 1., 2.", "at most 3"),
    ("BAR, CENTRIF, x, 0., 0., 0., 0., 0., 1.", "real number"),
])
def test_refused_loads(run_deck: Run, row: str, message: str) -> None:
    """Invalid rows of DLOAD."""
    assert message in refused(run_deck, f"{bar()}*STEP\n*STATIC\n*DLOAD\n{row}\n*END STEP\n")


def test_rotation_needs_a_density(run_deck: Run) -> None:
    """As gravity does."""
    model = bar(material=f"*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, 0.\n")
    assert "no *DENSITY" in refused(run_deck, f"{model}*STEP\n*STATIC\n*DLOAD\nBAR, CENTRIF, 1., 0., 0., 0., 0., 0., 1.\n*END STEP\n")


POINTS = "*TIME POINTS, NAME=WHEN{}\n{}\n"


@pytest.mark.parametrize(("card", "wanted"), [
    (POINTS.format("", ".15, .4\n.9"), [0.15, 0.4, 0.9, 1.0, 1.15, 1.4, 1.9, 2.0]),
    (POINTS.format(", GENERATE", "0., 1., .4"), [0.4, 0.8, 1.0, 1.4, 1.8, 2.0]),
    (POINTS.format(", TIME=TOTAL TIME", ".3, 1.7"), [0.3, 1.0, 1.7, 2.0]),
])
def test_time_points(run_deck: Run, tmp_path: Path, card: str, wanted: list[float]) -> None:
    """Two steps are printed at the times wanted and at their ends, and nowhere else; the force grows linearly."""
    step = "*STEP\n*STATIC\n.35, 1.\n*CLOAD\nTIP, 1, {}\n*NODE PRINT, NSET=ALL, TIME POINTS=WHEN\nU\n*END STEP\n"
    done = run_deck(bar() + card + step.format(1) + step.format(2))
    assert done.returncode == 0, done.stdout
    found = blocks(tmp_path, "displacements")
    assert [time for time, _ in found] == pytest.approx(wanted)
    for time, u in found:
        assert u[17][0] == pytest.approx(time * 4.0 * LENGTH / YOUNG, rel=DIGITS)


def test_time_points_of_the_result_file(run_deck: Run, tmp_path: Path) -> None:
    """The result file has its own list; increments end at both."""
    import h5py  # noqa: PLC0415

    cards = "*TIME POINTS, NAME=A\n.3\n*TIME POINTS, NAME=B\n.6\n"
    step = "*STEP\n*STATIC\n*CLOAD\nTIP, 1, 1.\n*NODE PRINT, NSET=ALL, TIME POINTS=A\nU\n*NODE FILE, TIME POINTS=B\nU\n*END STEP\n"
    done = run_deck(bar() + cards + step)
    assert done.returncode == 0, done.stdout
    assert [time for time, _ in blocks(tmp_path, "displacements")] == pytest.approx([0.3, 1.0])
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        assert file["VTKHDF/Steps/Values"][:] == pytest.approx([0.0, 0.6, 1.0])


@pytest.mark.parametrize(("card", "message"), [
    ("*TIME POINTS, NAME=WHEN\n", "needs a data line"),
    ("*TIME POINTS, NAME=WHEN\n.4, .3\n", "must ascend"),
    ("*TIME POINTS, NAME=WHEN\n.4, b\n", "real number"),
    ("*TIME POINTS, NAME=WHEN, GENERATE\n0., 1., -.1\n", "positive distance"),
    ("*TIME POINTS, NAME=OTHER\n.5\n", "There are no time points 'WHEN'"),
    ("*TIME POINTS, NAME=WHEN\n.5\n*TIME POINTS, NAME=WHEN\n.5\n", "defined twice"),
])
def test_refused_time_points(run_deck: Run, card: str, message: str) -> None:
    """Invalid TIME POINTS cards."""
    assert message in refused(run_deck, f"{bar()}{card}*STEP\n*STATIC\n*NODE PRINT, NSET=ALL, TIME POINTS=WHEN\nU\n*END STEP\n")


WEIGHT = "*NODE\n" + UNIT_CUBE + """*NSET, NSET=LOW
1, 2, 3, 4
*MATERIAL, NAME=STUFF
*ELASTIC
{modulus}, 0.3
*DENSITY
{density}
*SOLID SECTION, ELSET=E, MATERIAL=STUFF
*BOUNDARY
LOW, 1, 3
*STEP
*STATIC
*DLOAD
E, GRAV, {gravity}, 0., 0., -1.
*END STEP
"""


@pytest.mark.parametrize(("modulus", "density", "gravity", "hint"), [
    (210000.0, 7.85e-9, 9810.0, ""), (2.1e11, 7850.0, 9.81, ""), (210.0, 7.85e-6, 9.81e-3, ""), (1.0, 1.1e-9, 9810.0, ""), (1e6, 1100.0, 9.81, ""),
    (210000.0, 7850.0, 9.81, "No solid has both"), (210000.0, 7.85e-6, 9.81, "No solid has both"), (2.1e11, 7.85e-9, 9.81, "No solid has both"),
    (210000.0, 7.85e-9, 9.81, "where gravity is 9810, not 9.81"),
])  # fmt: skip
def test_units_of_a_weight(run_deck: Run, modulus: float, density: float, gravity: float, hint: str) -> None:
    """Steel and rubber in N, mm, t, in N, m, kg and in kN, mm, kg, ms get no hint; mixed units get one."""
    done = run_deck(WEIGHT.format(modulus=modulus, density=density, gravity=gravity))
    assert done.returncode == 0, done.stdout
    words = " ".join(done.stdout.split())
    assert ("*WARNING" in words) == (hint != "")
    assert hint in words


@pytest.mark.parametrize(("modulus", "scale", "hint"), [
    (210000.0, 100.0, ""), (2.1e11, 0.1, ""), (210000.0, 1.0, ""), (3e7, 1.0, ""), (5.0, 0.01, ""), (2.1e11, 1.0, ""),
    (210000.0, 0.05, "looks like MPa"), (2.1e11, 100.0, "is in Pa, which belongs to lengths in m"), (2.1e14, 1.0, "No solid has the Young's modulus"),
])  # fmt: skip
def test_units_of_lengths(run_deck: Run, modulus: float, scale: float, hint: str) -> None:
    """Millimetres with MPa, metres with Pa, psi with inches and soft small parts get no hint; metres with MPa and millimetres with Pa do."""
    deck = WEIGHT.format(modulus=modulus, density=1.0, gravity=1.0).replace("*DENSITY\n1.0\n", "").replace("*DLOAD\nE, GRAV, 1.0, 0., 0., -1.\n", "")
    first, last = deck.index("*NODE"), deck.index("*ELEMENT")
    rows = [line.split(",") for line in deck[first:last].splitlines()[1:]]
    nodes = "".join(f"{row[0]}, " + ", ".join(repr(scale * float(x)) for x in row[1:4]) + "\n" for row in rows)
    done = run_deck(deck[:first] + deck[first:last].splitlines()[0] + "\n" + nodes + deck[last:])
    assert done.returncode == 0, done.stdout
    words = " ".join(done.stdout.split())
    assert ("*WARNING" in words) == (hint != ""), words
    assert hint in words
