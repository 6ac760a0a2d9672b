"""`amontons --explain`: every card once, with what becomes of it; nothing is run.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from verify.conftest import ROOT, Run
from verify.decks.solids import UNIT_CUBE

DECK = f"""*HEADING
explained
*NODE, NSET=ALL
{UNIT_CUBE.replace('C3D8', 'C3D8H')}*MATERIAL, NAME=STEEL
*ELASTIC
210000., .3
*CONDUCTIVITY
50.
*SOLID SECTION, ELSET=E, MATERIAL=STEEL
*BOUNDARY
1, 1, 3
2, 2, 3
3, 3
4, 3
*STEP, NLGEOM, NAME=load
*STATIC, SOLVER=SPOOLES, EXPLICIT=1
.25, 2.
*CLOAD
5, 3, 1.
*END STEP
"""


def explained(run: Run, folder: Path, deck: str, *options: str) -> tuple[str, int]:
    """The explanation of a deck; there are no result files."""
    (folder / "job.inp").write_text(deck)
    done = run([*options, "--explain", "job"], cwd=folder)
    assert [path.name for path in folder.iterdir()] == ["job.inp"], "--explain runs nothing"
    return str(done.stdout), int(done.returncode)


def part(text: str, line: int) -> str:
    """The explanation of the card of a line."""
    found = re.search(rf"^\S*job\.inp:{line}: .*\n(?:    .*\n)*", text, re.MULTILINE)
    assert found, f"nothing of line {line} in\n{text}"
    return found.group(0)


def test_every_card_is_explained(run: Run, tmp_path: Path) -> None:
    """In the order of the deck, with its line."""
    text, code = explained(run, tmp_path, DECK)
    assert code == 0
    lines = [i for i, line in enumerate(DECK.splitlines(), 1) if line.startswith("*")]
    assert [int(n) for n in re.findall(r"^\S*job\.inp:(\d+): \*", text, re.MULTILINE)] == lines


def test_status_words(run: Run, tmp_path: Path) -> None:
    """Used, ignored, approximated by a note, defaults, and the numbers taken."""
    text, _ = explained(run, tmp_path, DECK)
    assert ": *CONDUCTIVITY: ignored. There is no flow of heat" in part(text, 17)
    step = part(text, 25)
    assert "NLGEOM: used" in step
    assert "NAME=load: ignored" in step
    assert "by default: INC=100, AMPLITUDE=RAMP" in step
    assert "EXPLICIT=1: ignored. There is no flow." in part(text, 26)
    assert "SOLVER=SPOOLES: used." in part(text, 26)
    assert "data: .25, 2." in part(text, 26)
    element = part(text, 12)
    assert "note: The elements C3D8H are taken as C3D8." in element
    assert "dialects differ: abaqus: C3D8" in element
    assert "8 data lines" in part(text, 3)
    numbers = text.partition("Numbers taken")[2]
    assert "1 element C3D8, 8 integration points, mean dilatation" in numbers
    assert "material STEEL: E 210000, nu 0.3; under NLGEOM Kirchhoff stress" in numbers
    assert re.search(r"step 1: NLGEOM, length 2, first increment 0\.25, least \S+, largest 2, at most 100 increments", numbers)
    assert "7 prescribed displacements, 1 force" in numbers


def test_dialects(run: Run, tmp_path: Path) -> None:
    """The same deck under the other dialect: other numbers."""
    abaqus, _ = explained(run, tmp_path, DECK)
    calculix, _ = explained(run, tmp_path, DECK, "--dialect=calculix")
    assert "read in the abaqus dialect" in abaqus
    assert "read in the calculix dialect" in calculix
    assert "mean dilatation\n" not in calculix.partition("Numbers taken")[2]
    assert "second Piola-Kirchhoff" in calculix
    assert re.search(r"Rn 5E-\d, Cn 0\.01", calculix)


def test_deck_with_errors(run: Run, tmp_path: Path) -> None:
    """It is explained all the same, each error below its card; the exit code is that of a deck with errors."""
    deck = DECK.replace("*CLOAD\n5, 3, 1.", "*CLOAD\n5, 9, 1.\n*FREQUENCY\n10\n*NONSENSE\n*BOUNDARY, TYPE=ACCELERATION\n1, 1")
    text, code = explained(run, tmp_path, deck)
    assert code == 3
    assert "error: The degree of freedom of a force" in part(text, 28)
    assert ": *FREQUENCY: refused." in part(text, 30)
    assert "*NONSENSE: not known" in part(text, 32)
    assert "TYPE=ACCELERATION: refused. Prescribe displacements." in part(text, 33)
    assert "The deck has" in text and "would not run" in text


def test_contact_numbers(run: Run) -> None:
    """The law that is taken, with its numbers."""
    done = run(["--explain", ROOT / "input" / "three_cubes.inp"])
    assert done.returncode == 0
    assert "interaction RUBBING: HARD, exact; friction 0.3" in done.stdout


def test_output_variables(run: Run, tmp_path: Path) -> None:
    """Components are of a field, energies stand in the history table; a message names what is not written."""
    requested = "*OUTPUT, FIELD\n*NODE OUTPUT\nU, RF3, CF\n*ELEMENT OUTPUT\nS12, LE, MISES, PEMAG\n*ENERGY OUTPUT\nALLSE, ALLFD\n*END STEP"
    text, code = explained(run, tmp_path, DECK.replace("*END STEP", requested))
    assert code == 0
    assert re.findall(r"note: job.vtkhdf always .* in neither: (.*)\.", text) == ["CF", "PEMAG"]


def test_broken_parts(run: Run, tmp_path: Path) -> None:
    """The explanation of an incomplete deck gives the reason."""
    text, code = explained(run, tmp_path, "*PART, NAME=P\n*NODE\n1, 0, 0, 0\n" + DECK)
    assert code == 3
    assert "no *END PART" in text


def test_no_deck(run: Run, tmp_path: Path) -> None:
    """Nothing to explain."""
    assert run(["--explain", "nowhere"], cwd=tmp_path).returncode == 7
    assert run(["--explain"], cwd=tmp_path).returncode == 2


@pytest.mark.parametrize("deck", sorted((ROOT / "input").glob("*.inp")), ids=lambda path: path.stem)
def test_decks_of_the_repository(run: Run, deck: Path) -> None:
    """No card of theirs is unknown or refused."""
    done = run(["--explain", deck])
    assert done.returncode == 0, done.stdout[-1000:]
    assert ": not known" not in done.stdout and ": refused" not in done.stdout
