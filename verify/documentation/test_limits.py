"""doc/manual/limits.md against the program: what the page says is not there is refused before the first step, by name.

Each row of the tables stands in TRIALS with cards that request it; all cards of the list of refused cards are tried as well.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from verify.conftest import ROOT, Run

PAGE = ROOT / "doc" / "manual" / "limits.md"
DECK_ERROR = 3
CUBE = """*NODE, NSET=ALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
*ELEMENT, TYPE=C3D8, ELSET=CUBE
1, 1, 2, 3, 4, 5, 6, 7, 8
{elements}*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
{material}*SOLID SECTION, ELSET=CUBE, MATERIAL=STEEL
*SURFACE, NAME=LOW
CUBE, S1
*SURFACE, NAME=HIGH
CUBE, S2
*SURFACE INTERACTION, NAME=DRY
{interaction}*BOUNDARY
ALL, 1, 3
{pair}*STEP
{step}*END STEP
"""
#: words of the row's first column: part of the deck, cards, words of the sentence that refuses them
TRIALS = [
    ("vibration", "step", "*DYNAMIC\n0.1, 1.\n", r"\*DYNAMIC"),
    ("natural frequencies", "step", "*FREQUENCY\n3\n", r"\*FREQUENCY is not supported"),
    ("buckling factors", "step", "*BUCKLE\n3\n", r"\*BUCKLE is not supported"),
    ("a step after a", "step", "*STATIC, RIKS\n0.1, 1.\n*CLOAD\nALL, 3, 1.\n*END STEP\n*STEP\n*STATIC\n", "No step can follow a RIKS step"),
    ("imperfections by the modes", "pair", "*IMPERFECTION, FILE=job, STEP=1\n1, 0.01\n", "Modes are not read from the results of another job"),
    ("heat transfer", "step", "*HEAT TRANSFER\n0.1, 1.\n", r"\*HEAT TRANSFER is not supported"),
    ("coupled temperature", "step", "*COUPLED TEMPERATURE-DISPLACEMENT\n0.1, 1.\n", r"\*COUPLED TEMPERATURE-DISPLACEMENT is not supported"),
    ("submodels by stresses", "pair", "*SUBMODEL, TYPE=SURFACE, INPUT=global.frd\nHIGH\n", "Stresses are not taken from a global model"),
    ("membranes with nodal thickness", "elements", "*ELEMENT, TYPE=M3D4, ELSET=SKIN\n2, 5, 6, 7, 8\n*MEMBRANE SECTION, ELSET=SKIN, MATERIAL=STEEL, NODAL THICKNESS\n0.1\n", "NODAL THICKNESS"),
    ("foundations of beams", "elements", "*ELEMENT, TYPE=B31, ELSET=BEAM\n2, 5, 6\n*BEAM SECTION, ELSET=BEAM, MATERIAL=STEEL, SECTION=RECT\n0.1, 0.1\n0., 1., 0.\n*FOUNDATION\nBEAM, FX, 1.\n", "takes no foundation FX"),
    ("elbows and meshed", "elements", "*ELEMENT, TYPE=B31, ELSET=BEAM\n2, 5, 6\n*BEAM SECTION, ELSET=BEAM, MATERIAL=STEEL, SECTION=ELBOW\n1., 0.1\n", "SECTION=ELBOW is not supported"),
    ("connectors, joints", "elements", "*ELEMENT, TYPE=CONN3D2, ELSET=LINK\n2, 5, 6\n", "CONN3D2"),
    ("cohesive elements of a continuum", "elements", "*ELEMENT, TYPE=COH3D8, ELSET=GLUE\n2, 1, 2, 3, 4, 5, 6, 7, 8\n*COHESIVE SECTION, ELSET=GLUE, MATERIAL=STEEL, RESPONSE=CONTINUUM\n", "RESPONSE=CONTINUUM.*A layer of finite thickness"),
    ("gaskets", "elements", "*GASKET SECTION, ELSET=CUBE\n", r"\*GASKET SECTION is not supported"),
    ("rigid elements RB2D2", "elements", "*ELEMENT, TYPE=RB2D2, ELSET=TOOL\n2, 5, 6\n*RIGID BODY, ELSET=TOOL, REF NODE=8\n", r"Rigid tools are R3D3"),
    ("user elements", "elements", "*USER ELEMENT, TYPE=U1, NODES=4, LINEAR\n1, 2\n", r"LINEAR.*The routine UEL gives force"),
    ("self contact by a pressure", "pair", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1000.\n*CONTACT PAIR, INTERACTION=DRY\nLOW,\n", "hard contact only"),
    ("friction that depends on", "interaction", "*FRICTION\n0.3, 1., 0.5, 20.\n", "friction cannot depend"),
    ("cohesive behaviour of contact", "interaction", "*COHESIVE BEHAVIOR\n", r"\*COHESIVE BEHAVIOR is not supported"),
    ("clay", "material", "*CLAY PLASTICITY\n1., 30., 0.5, 0.01\n", r"\*CLAY PLASTICITY is not supported"),
    ("damage", "material", "*DAMAGE INITIATION, CRITERION=DUCTILE\n0.1\n", "Damage is one of cohesive elements"),
    ("viscoelasticity by test data", "material", "*VISCOELASTIC, TIME=CREEP TEST DATA\n0.1, 0.1, 1.\n", r"Give g, k and tau"),
    ("`*TRS`", "material", "*TRS\n0.1, 0.1, 1.\n", r"\*TRS is not supported"),
    ("cast iron", "material", "*CAST IRON PLASTICITY\n0.1\n", r"\*CAST IRON PLASTICITY is not supported"),
    ("rate-dependent yield", "material", "*PLASTIC\n200., 0.\n*RATE DEPENDENT, TYPE=JOHNSON COOK\n0.01, 1.\n", r"Give POWER LAW or YIELD RATIO"),
]
#: rows that no card requests, each with what holds it
NO_CARD = {
    "S6 that curve": "verify/cases/elastic/test_shells.py",
    "submodels of shells": "verify/cases/loads/test_shell_submodels.py",
    "wear": "no card of Abaqus or CalculiX",
    "fatigue, crack growth": "results of other programs",
}


def rows() -> list[str]:
    """The first column of the tables."""
    found = re.findall(r"^\| (?!not there)([^|]+) \| ", PAGE.read_text(), re.M)
    assert len(found) > 10
    return found


@pytest.mark.parametrize(("row", "place", "cards", "reported"), TRIALS, ids=[trial[0] for trial in TRIALS])
def test_what_is_not_there_is_refused(run: Run, tmp_path: Path, row: str, place: str, cards: str, reported: str) -> None:
    """With an error that names it; the same deck without it has none."""
    if not any(row.lower() in line.lower() for line in rows()):
        pytest.skip(f"the page does not say any longer that there is no {row}")
    parts = dict.fromkeys(("elements", "material", "interaction", "pair"), "") | {"step": "*STATIC\n"}
    (tmp_path / "plain.inp").write_text(CUBE.format(**parts))
    done = run(["--check", "plain"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    (tmp_path / "job.inp").write_text(CUBE.format(**parts | {place: cards}))
    done = run(["job"], cwd=tmp_path)
    assert done.returncode == DECK_ERROR, done.stdout + done.stderr
    errors = [line for line in (done.stdout + done.stderr).splitlines() if "*ERROR" in line]
    assert any(re.search(reported, line) for line in errors), errors
    assert not (tmp_path / "job.vtkhdf").exists()


def test_each_row_is_tried() -> None:
    """A row without a trial is a sentence without proof."""
    known = [trial[0] for trial in TRIALS] + list(NO_CARD)
    assert [row for row in rows() if not any(word.lower() in row.lower() for word in known)] == []


def test_all_refused_cards_are_refused(run: Run, tmp_path: Path) -> None:
    """Each card of the list that `amontons --cards` ends with."""
    listed = run(["--cards"]).stdout
    names = re.findall(r"^    \*([A-Z][A-Z0-9 -]+)$", listed[listed.index("Cards refused") :], re.M)
    assert len(names) > 50
    (tmp_path / "job.inp").write_text("".join(f"*{name}\n" for name in names))
    done = run(["--check", "job"], cwd=tmp_path)
    reported = done.stdout + done.stderr
    assert done.returncode == DECK_ERROR
    assert [name for name in names if f"The card *{name} is not supported." not in reported] == []
