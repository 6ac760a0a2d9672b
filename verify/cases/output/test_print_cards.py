"""What the PRINT cards print: rows and sums of a bar whose values are known, and which cards are refused.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from verify.conftest import Run

ALPHA, HEAT, STRETCH, YOUNG = 1e-3, 40.0, 0.02, 100.0
BAR = f"""*NODE, NSET=N
1, 0, 0, 0
2, 2, 0, 0
3, 2, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 2, 0, 1
7, 2, 1, 1
8, 0, 1, 1
*ELEMENT, TYPE=C3D8, ELSET=E
7, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=LEFT
1, 4, 5, 8
*NSET, NSET=RIGHT
2, 3, 6, 7
*MATERIAL, NAME=M
*ELASTIC
{YOUNG}, 0
*EXPANSION
{ALPHA}
*SOLID SECTION, ELSET=E, MATERIAL=M
"""

Blocks = dict[str, list[list[list[float]]]]


def pull(prints: str, step: str = "*STEP\n*STATIC\n1., 1.\n") -> str:
    """The bar is heated and pulled to 1 + STRETCH of its length."""
    return (BAR + step + f"*TEMPERATURE\nN, {HEAT}\n*BOUNDARY\nN, 2, 3\nLEFT, 1\nRIGHT, 1, 1, {2 * STRETCH}\n" + prints
            + "*END STEP\n")


def blocks_of(path: Path) -> Blocks:
    """Tables by their titles, in the order of their times."""
    result: Blocks = {}
    rows: list[list[float]] = []
    for line in path.read_text().splitlines():
        if re.match(r" +[a-z]", line):
            rows = []
            result.setdefault(re.split(r" \(| for ", line.strip())[0], []).append(rows)
        elif re.match(r" +[-0-9]", line):
            rows.append([float(word) for word in line.split()])
    return result


def close(rows: list[list[float]], right: list[list[float]]) -> bool:
    """Equal in the seven digits printed."""
    return len(rows) == len(right) and all(a == pytest.approx(b, rel=1e-6, abs=1e-9) for a, b in zip(rows, right, strict=True))


def test_nodes(run_deck: Run, tmp_path: Path) -> None:
    """NT, COORD and RF of a set, and the sum of RF; the force is E (stretch - alpha heat) times the area."""
    assert run_deck(pull("*NODE PRINT, NSET=RIGHT, TOTALS=YES\nNT, COORD, RF\n")).returncode == 0
    found = blocks_of(tmp_path / "job.dat")
    force = YOUNG * (STRETCH - ALPHA * HEAT)
    side = YOUNG * ALPHA * HEAT * 2 / 4  # of the four sides, held against growing: a quarter of area 2 at each of their nodes
    assert close(found["temperatures"][0], [[n, HEAT] for n in (2, 3, 6, 7)])
    assert close(found["coordinates"][0], [[2, 2, 0, 0], [3, 2, 1, 0], [6, 2, 0, 1], [7, 2, 1, 1]])
    sides = {2: (1, 1), 3: (-1, 1), 6: (1, -1), 7: (-1, -1)}
    assert close(found["forces"][0], [[n, force / 4, side * a, side * b] for n, (a, b) in sides.items()])
    assert close(found["total force"][0], [[force, 0, 0]])


def test_points(run_deck: Run, tmp_path: Path) -> None:
    """E is the whole strain, S the stress of the elastic one; the points of C3D8 lie at 1/2 -+ 1/sqrt(12) of the sides."""
    assert run_deck(pull("*EL PRINT, ELSET=E, TOTALS=ONLY\nELSE, EVOL\n*EL PRINT, ELSET=E\nS, E, ME, ENER, COORD\n")).returncode == 0
    found = blocks_of(tmp_path / "job.dat")
    elastic = [STRETCH - ALPHA * HEAT, -ALPHA * HEAT, -ALPHA * HEAT]
    energy = YOUNG * sum(e * e for e in elastic) / 2
    assert close(found["stresses"][0], [[7, p, *(YOUNG * e for e in elastic), 0, 0, 0] for p in range(1, 9)])
    assert close(found["strains"][0], [[7, p, STRETCH, 0, 0, 0, 0, 0] for p in range(1, 9)])
    assert close(found["mechanical strains"][0], [[7, p, *elastic, 0, 0, 0] for p in range(1, 9)])
    assert close(found["internal energy density"][0], [[7, p, energy] for p in range(1, 9)])
    assert close(found["total internal energy"][0], [[2 * energy]])
    assert close(found["total volume"][0], [[2]])
    assert "internal energy" not in found and "volume" not in found
    ends = [0.5 - 12**-0.5, 0.5 + 12**-0.5]
    places = [[7, 1 + i + 2 * j + 4 * k, 2 * ends[i], ends[j], ends[k]] for k in (0, 1) for j in (0, 1) for i in (0, 1)]
    assert close(found["global coordinates"][0], places)


def test_places_under_nlgeom(run_deck: Run, tmp_path: Path) -> None:
    """COORD is the place now if the step has NLGEOM."""
    deck = pull("*NODE PRINT, NSET=RIGHT\nCOORD\n*EL PRINT, ELSET=E\nCOORD\n", "*STEP, NLGEOM\n*STATIC\n1., 1.\n")
    assert run_deck(deck).returncode == 0
    found = blocks_of(tmp_path / "job.dat")
    assert {row[1] for row in found["coordinates"][0]} == {2 * (1 + STRETCH)}
    assert found["global coordinates"][0][1][2] == pytest.approx(2 * (1 + STRETCH) * (0.5 + 12**-0.5), rel=1e-6)


def test_frequency(run_deck: Run, tmp_path: Path) -> None:
    """Every third of eight increments, and the last."""
    deck = pull("*NODE PRINT, NSET=RIGHT, FREQUENCY=3\nU\n", "*STEP\n*STATIC, DIRECT\n0.125, 1.\n")
    assert run_deck(deck).returncode == 0
    shown = [rows[0][1] for rows in blocks_of(tmp_path / "job.dat")["displacements"]]
    assert shown == pytest.approx([2 * STRETCH * part for part in (0.375, 0.75, 1.0)], rel=1e-6)


def test_without_a_set(run_deck: Run, tmp_path: Path) -> None:
    """All nodes and elements under the abaqus dialect; under the calculix dialect the card is passed over with a warning, as there."""
    deck = pull("*NODE PRINT\nU\n*EL PRINT\nS\n")
    assert run_deck(deck).returncode == 0
    found = blocks_of(tmp_path / "job.dat")
    assert [row[0] for row in found["displacements"][0]] == list(range(1, 9))
    assert len(found["stresses"][0]) == 8
    (tmp_path / "job.dat").unlink()
    result = run_deck(deck, "--dialect=calculix")
    assert result.returncode == 0
    words = " ".join((result.stdout + result.stderr).split())
    assert "*NODE PRINT needs NSET" in words and "*EL PRINT needs ELSET" in words
    assert not (tmp_path / "job.dat").exists()


def test_with_an_unknown_set(run_deck: Run, tmp_path: Path) -> None:
    """An error under the abaqus dialect; under the calculix dialect a warning, and the other cards count, as in CalculiX."""
    deck = pull("*NODE PRINT, NSET=NIX\nU\n*NODE PRINT, NSET=RIGHT\nU\n*EL PRINT, ELSET=NIX\nS\n")
    assert run_deck(deck).returncode == 3
    result = run_deck(deck, "--dialect=calculix")
    assert result.returncode == 0
    words = " ".join((result.stdout + result.stderr).split())
    assert "There is no node set 'NIX'; the card is passed over." in words
    assert "There is no element set 'NIX'; the card is passed over." in words
    found = blocks_of(tmp_path / "job.dat")
    assert len(found["displacements"]) == 1 and "stresses" not in found
