"""NO COMPRESSION and NO TENSION: Abaqus's cutoff of principal stresses, by closed forms.

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
from verify.decks.solids import Solids, as_kind, node_set
from verify.readers.dat_frd_files import read_dat

E, NU = 1000.0, 0.25
LAME, G = E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 + 2 * NU)
SIDES = {"NO COMPRESSION": 1.0, "NO TENSION": -1.0}


def law(word: str, section: str = "*SOLID SECTION, ELSET=ALL, MATERIAL=M\n") -> str:
    """The material and its section."""
    return f"*MATERIAL, NAME=M\n*ELASTIC\n{E}, {NU}\n*{word}\n{section}"


def sets(body: Solids, places: dict[str, tuple[int, float]]) -> str:
    """Node sets of planes."""
    return "".join(f"*NSET, NSET={name}\n" + "".join(f"{i + 1},\n" for i in body.where(axis, at)) for name, (axis, at) in places.items())


def cut(word: str, strain: np.ndarray) -> np.ndarray:
    """The law: principal stresses of Hooke's law, those of the other sign zero."""
    values, axes = np.linalg.eigh(LAME * np.trace(strain) * np.eye(3) + 2 * G * strain)
    side = SIDES[word]
    return np.asarray((axes * side * np.maximum(side * values, 0.0)) @ axes.T)


GRADIENTS = [
    np.array([[0.01, 0.004, 0.0], [-0.002, -0.006, 0.003], [0.001, 0.002, 0.004]]),
    np.array([[-0.01, 0.002, 0.001], [0.0, 0.003, 0.0], [0.002, -0.001, -0.002]]),
    np.array([[0.003, 0.0, 0.0], [0.0, 0.004, 0.001], [0.0, 0.0, 0.005]]),
]


@pytest.mark.parametrize("kind", ["C3D8", "C3D10", "C3D20R", "C3D8R", "C3D8I"])
@pytest.mark.parametrize("word", SIDES)
@pytest.mark.parametrize("which", range(3))
def test_homogeneous(run_deck: Run, tmp_path: Path, kind: str, word: str, which: int) -> None:
    """All nodes of a block are moved by a gradient: the stress is the law at every point."""
    body = as_kind(block(between(0, 1, 1), between(0, 1, 1), between(0, 1, 1), "BODY"), kind)
    moved = body.nodes @ GRADIENTS[which].T
    rows = "".join(f"{i + 1}, {k + 1}, {k + 1}, {u[k]:.15g}\n" for i, u in enumerate(moved) for k in range(3))
    done = run_deck(f"{body.cards()}{law(word)}*STEP\n*STATIC\n*BOUNDARY\n{rows}*EL PRINT, ELSET=ALL\nS\n*END STEP\n")
    assert done.returncode == 0, done.stdout + done.stderr
    expected = cut(word, (GRADIENTS[which] + GRADIENTS[which].T) / 2)
    expected = expected[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    for row in read_dat(tmp_path / "job.dat")[-1].rows.values():
        assert row == pytest.approx(expected, abs=2e-6 * E * 0.01)


@pytest.mark.parametrize("step", ["*STEP", "*STEP, NLGEOM"])
@pytest.mark.parametrize("stretch", [0.1, -0.1])
@pytest.mark.parametrize("word", SIDES)
def test_truss(run_deck: Run, tmp_path: Path, word: str, stretch: float, step: str) -> None:
    """The force of a bar: E times the strain on one side, zero on the other; under NLGEOM the logarithmic strain and the present area."""
    section = "*SOLID SECTION, ELSET=ALL, MATERIAL=M\n2.\n"
    deck = "*NODE\n1, 0., 0., 0.\n2, 3., 0., 0.\n*NSET, NSET=END\n2\n*ELEMENT, TYPE=T3D2, ELSET=ALL\n1, 1, 2\n" + law(word, section)
    done = run_deck(f"{deck}*BOUNDARY\n1, 1, 3\n2, 2, 3\n{step}\n*STATIC\n*BOUNDARY\nEND, 1, 1, {3 * stretch}\n*NODE PRINT, NSET=END\nRF\n*END STEP\n")
    assert done.returncode == 0, done.stdout + done.stderr
    force = next(iter(read_dat(tmp_path / "job.dat")[-1].rows.values()))[0]
    expected = E * 2 * stretch
    if "NLGEOM" in step:
        expected = E * 2 * np.log(1 + stretch) / (1 + stretch)  # tau V/L
    assert force == pytest.approx(expected if stretch * SIDES[word] > 0 else 0.0, rel=2e-6, abs=1e-9)


@pytest.mark.parametrize("kind", ["CPS4", "CPS8R", "M3D4", "M3D8R", "CPE4", "CAX4"])
@pytest.mark.parametrize("word", SIDES)
def test_sheet(run_deck: Run, tmp_path: Path, kind: str, word: str) -> None:
    """A sheet stretched along x by 0.01 and pressed along y by 0.02: s1 = C (e1 + nu e2) of plane stress, s2 is cut, or the other way round. In plane strain
    and around an axis the third principal stress is that of Hooke's law, too."""
    along, across = 0.01, -0.02
    quadratic = "8" in kind
    steps = (0.0, 0.5, 1.0) if quadratic else (0.0, 1.0)
    points = [(x, y) for y in steps for x in steps if not (x == 0.5 and y == 0.5)]
    number = {p: i + 1 for i, p in enumerate(points)}
    corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    sides = [(0.5, 0.0), (1.0, 0.5), (0.5, 1.0), (0.0, 0.5)] if quadratic else []
    first = 5.0 if kind == "CAX4" else 0.0
    deck = "*NODE\n" + "".join(f"{i}, {first + x}, {y}, 0.\n" for (x, y), i in number.items())
    deck += f"*ELEMENT, TYPE={kind}, ELSET=ALL\n1, " + ", ".join(str(number[p]) for p in corners + sides) + "\n"
    section = "*MEMBRANE SECTION, ELSET=ALL, MATERIAL=M\n0.5\n" if kind[0] == "M" else "*SOLID SECTION, ELSET=ALL, MATERIAL=M\n" + ("" if kind[1] == "A" else "0.5\n")
    moved = {i: ((first + x) * along, y * across) for (x, y), i in number.items()}
    rows = "".join(f"{i}, 1, 1, {u:.15g}\n{i}, 2, 2, {v:.15g}\n" + (f"{i}, 3\n" if kind[0] == "M" else "") for i, (u, v) in moved.items())
    done = run_deck(f"{deck}{law(word, section)}*STEP\n*STATIC\n*BOUNDARY\n{rows}*EL PRINT, ELSET=ALL\nS\n*END STEP\n")
    assert done.returncode == 0, done.stdout + done.stderr
    if kind in ("CPE4", "CAX4"):
        strain = np.diag([along, across, 0.0 if kind == "CPE4" else along])
        expected = np.diag(cut(word, strain))
    else:
        plane = E / (1 - NU**2) * np.array([along + NU * across, across + NU * along, 0.0])
        expected = SIDES[word] * np.maximum(SIDES[word] * plane, 0.0)
    for row in read_dat(tmp_path / "job.dat")[-1].rows.values():
        assert row[:3] == pytest.approx(expected, abs=1e-6 * E * 0.02)


@pytest.mark.parametrize("kind", ["CPS8R", "CPE8R"])
def test_wall_outside_core(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """A wall without tensile strength under a force off its middle by e > h/6: pressed over c = 3 (h/2 - e), its stress falls linearly from 2 N/(b c) to zero.
    Reference: S. Timoshenko, Strength of Materials, part I (1955), article on eccentric compression of a short strut that cannot resist tension."""
    height, depth, width, force = 2.0, 1.0, 0.5, 100.0
    off = depth / 3
    pressed = 3 * (depth / 2 - off)
    edge_stress = 2 * force / (width * pressed)
    cards, base, top, last = plane_wall(kind, 16, depth, height)
    sets_text = "".join(f"*NSET, NSET={s}\n" + "".join(f"{i + 1},\n" for i in m) for s, m in [("BASE", base), ("TOP", top)])
    reference = last + 1
    deck = f"{cards}{sets_text}*MATERIAL, NAME=M\n*ELASTIC\n1e5, 0.\n*NO TENSION\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n{width}\n"
    deck += f"*NODE, NSET=R\n{reference}, {off:.15g}, {height:g}\n*RIGID BODY, TIE NSET=TOP, REF NODE={reference}\n*BOUNDARY\nBASE, 2\n{base[0] + 1}, 1\n{reference}, 1\n"
    deck += "*STEP\n*CONTROLS, PARAMETERS=TIME INCREMENTATION\n40, 40, , 60\n*STATIC\n0.25, 1.\n"
    deck += f"*CLOAD\n{reference}, 2, {-force}\n*NODE PRINT, NSET=R\nU\n*NODE PRINT, NSET=R\nUR\n*END STEP\n"
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr
    tables = read_dat(tmp_path / "job.dat")
    moved = next(iter(next(t for t in reversed(tables) if "displacements" in t.name[0]).rows.values()))
    turned = next(iter(next(t for t in reversed(tables) if "rotations" in t.name[0]).rows.values()))
    shortening = edge_stress / 1e5 * height
    assert moved[1] == pytest.approx(-2 / 3 * shortening, rel=5e-3)
    assert max(abs(x) for x in turned) == pytest.approx(shortening / pressed, rel=1e-2)


def solid_wall(kind: str, controls: str) -> str:
    """The same wall of 8 x 1 x 4 solids, half as wide, its rigid top guided."""
    body = as_kind(block(between(-0.5, 0.5, 8), between(0, 0.5, 1), between(0, 2, 4), "BODY"), kind)
    reference = len(body.nodes) + 1
    middle = next(i for i in body.where(2, 0.0) if abs(body.nodes[i, 0]) < 1e-9) + 1
    deck = body.cards() + sets(body, {"BASE": (2, 0.0), "TOP": (2, 2.0)})
    deck += "*MATERIAL, NAME=M\n*ELASTIC\n1e5, 0.\n*NO TENSION\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n"
    deck += f"*NODE, NSET=R\n{reference}, {1 / 3:.15g}, 0.25, 2.\n*RIGID BODY, TIE NSET=TOP, REF NODE={reference}\n"
    deck += f"*BOUNDARY\nBASE, 2, 3\n{middle}, 1\n{reference}, 1, 2\n{reference}, 4\n{reference}, 6\n"
    return deck + f"*STEP\n{controls}*STATIC\n0.25, 1.\n*CLOAD\n{reference}, 3, -100.\n*NODE PRINT, NSET=R\nU\n*END STEP\n"


ABAQUS_CRITERIA = "*CONTROLS, PARAMETERS=TIME INCREMENTATION\n40, 40, , 60\n*CONTROLS, PARAMETERS=FIELD\n5e-3, 1e-2\n"


@pytest.mark.parametrize("kind", ["C3D4", "C3D6", "C3D8", "C3D8R", "C3D10", "C3D15", "C3D20", "C3D20R"])
def test_solid_wall(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """With Abaqus's criteria all these kinds finish. C3D20R is at the closed form, linear and fully integrated elements are stiffer."""
    done = run_deck(solid_wall(kind, ABAQUS_CRITERIA))
    assert done.returncode == 0, done.stdout + done.stderr
    moved = next(iter(read_dat(tmp_path / "job.dat")[-1].rows.values()))[2]
    exact = -2 / 3 * (2 * 100 / (0.5 * 0.5)) / 1e5 * 2
    assert 0.6 < moved / exact < 1.001
    if kind == "C3D20R":
        assert moved == pytest.approx(exact, rel=1e-3)


def test_remedy(run_deck: Run) -> None:
    """A wall of C3D10 that does not finish by the defaults says what helps."""
    done = run_deck(solid_wall("C3D10", ""))
    assert done.returncode == 5
    assert "Take Abaqus's criteria" in done.stdout + done.stderr


def test_remedy_of_modes(run_deck: Run) -> None:
    """C3D8I, whose modes have no solution, says which elements have none."""
    done = run_deck(solid_wall("C3D8I", ABAQUS_CRITERIA))
    assert done.returncode == 5
    assert "Take C3D8, C3D8R" in done.stdout + done.stderr


def column(kind: str, word: str, off: float) -> str:
    """A column of a shell or a beam, 2 high, 1 thick, 0.5 wide, under a force of 100 off its middle, pressed or pulled by the side that it carries."""
    n, m, height, width = 8, 2 if kind == "B32" else 1, 2.0, 0.5
    if kind[0] == "B":
        mesh = "*NODE, NSET=N\n" + "".join(f"{i + 1}, 0., 0., {height * i / (n * m):.9g}\n" for i in range(n * m + 1)) + f"*ELEMENT, TYPE={kind}, ELSET=E\n"
        mesh += "".join(f"{e + 1}, " + ", ".join(str(e * m + 1 + k) for k in range(m + 1)) + "\n" for e in range(n))
        section = f"*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=RECT\n1., {width}\n1., 0., 0.\n"
        base, top = [0], {n * m: 1.0}
    else:
        sheet = shell(kind, (n, 1), lambda u, v: (0 * u, width * v, height * u))
        mesh, section = sheet.cards(), "*SHELL SECTION, ELSET=E, MATERIAL=M\n1.\n"
        base, top = sheet.where(0, 0.0), sheet.edge_weights(0, 1.0)
    loads = "".join(f"{i + 1}, 3, {SIDES[word] * 100 * w:.15g}\n{i + 1}, 5, {100 * off * w:.15g}\n" for i, w in top.items())
    return (f"{mesh}{node_set('BASE', base)}{node_set('TOP', top)}*MATERIAL, NAME=M\n*ELASTIC\n1e5, 0.\n*{word}\n{section}*BOUNDARY\nBASE, 1, 6\nN, 2\nN, 4\n"
            f"*STEP\n*STATIC\n0.25, 1.\n*CLOAD\n{loads}*NODE PRINT, NSET=TOP\nUR\n*END STEP\n")  # fmt: skip


@pytest.mark.parametrize("word", SIDES)
@pytest.mark.parametrize(("kind", "beyond"), [("S3", 0.949), ("S4", 0.949), ("S6", 1.108), ("S8R", 0.844), ("B31", 0.844), ("B32", 1.108)])
def test_column(run_deck: Run, tmp_path: Path, kind: str, beyond: float, word: str) -> None:
    """Shells and beams by the defaults. Inside the core the column turns by e N L/(E I); outside by the closed form of the wall, as well as the points over
    the thickness know the crack: five of S3 and S4 by -5 %, three of S6 and B32 by +11 %, two of S8R and B31 by -16 %."""
    for off in (0.1, 0.25):
        done = run_deck(column(kind, word, off))
        assert done.returncode == 0, done.stdout + done.stderr
        turn = next(iter(read_dat(tmp_path / "job.dat")[-1].rows.values()))[1]
        pressed = 3 * (0.5 - off)
        exact = 2 * (100 * off / (1e5 * 0.5 / 12) if off < 1 / 6 else 2 * 100 / (0.5 * pressed) / 1e5 / pressed)
        assert turn / exact == pytest.approx(1.0 if off < 1 / 6 else beyond, rel=1e-6 if off < 1 / 6 else 1e-3)


def plane_wall(kind: str, n: int, depth: float, height: float) -> tuple[str, list[int], list[int], int]:
    """A wall of n x 4 elements of eight nodes: its cards, the nodes (from 0) of base and top, their number."""
    place: dict[tuple[int, int], int] = {}
    rows, elements = "", ""
    for j in range(9):
        for i in range(2 * n + 1):
            if i % 2 and j % 2:
                continue
            place[i, j] = len(place)
            rows += f"{len(place)}, {depth * (i / (2 * n) - 0.5):.15g}, {height * j / 8:.15g}\n"
    for j in range(0, 8, 2):
        for i in range(0, 2 * n, 2):
            around = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
            elements += f"{1 + j // 2 * n + i // 2}, " + ", ".join(str(1 + place[i + a, j + b]) for a, b in around) + "\n"
    base, top = ([k for (_, j), k in place.items() if j == at] for at in (0, 8))
    return f"*NODE\n{rows}*ELEMENT, TYPE={kind}, ELSET=ALL\n{elements}", base, top, len(place)


CUBE = as_kind(block(between(0, 1, 1), between(0, 1, 1), between(0, 1, 1), "BODY"), "C3D8")


@pytest.mark.parametrize(
    ("cards", "option", "words"),
    [
        ("*NO TENSION\n*NO COMPRESSION\n", "abaqus", "has *NO COMPRESSION or *NO TENSION before this card"),
        ("*NO TENSION\n*PLASTIC\n10., 0.\n", "abaqus", "beside a law that is not linear elastic"),
        ("*NO TENSION\n", "calculix", "CalculiX has no *NO COMPRESSION and *NO TENSION"),
    ],
)  # fmt: skip
def test_refused(run_deck: Run, cards: str, option: str, words: str) -> None:
    """What the cards do not go with."""
    deck = f"{CUBE.cards()}*MATERIAL, NAME=M\n*ELASTIC\n{E}, {NU}\n{cards}*SOLID SECTION, ELSET=ALL, MATERIAL=M\n"
    done = run_deck(deck + "*STEP\n*STATIC\n*BOUNDARY\n1, 1, 3\n*END STEP\n", f"--dialect={option}")
    assert done.returncode == 3
    assert words in " ".join((done.stdout + done.stderr).split())
