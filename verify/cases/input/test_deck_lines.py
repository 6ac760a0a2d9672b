"""Lines of a deck that are easily lost or misread: data after a trailing comma, what follows an INCLUDE, parameters,
decimal commas, keywords without a star, empty sets.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from verify.conftest import Run
from verify.decks.solids import UNIT_CUBE

YOUNG = 1000.0
CUBE = f"""*NODE, NSET=ALL
{UNIT_CUBE}*NSET, NSET=LOW
1, 2, 3, 4
*NSET, NSET=HIGH
5, 6, 7, 8
*MATERIAL, NAME=M
*ELASTIC
{YOUNG}, 0.
*SOLID SECTION, ELSET=E, MATERIAL=M
"""
BOUNDARY = "*BOUNDARY\nLOW, 1, 3\n"
STEP = "*STEP\n*STATIC\n"
LOAD = "*CLOAD\nHIGH, 3, 2.5\n"
END = "*NODE PRINT, NSET=HIGH\nU\n*END STEP\n"
LIFT = 4 * 2.5 / YOUNG  # of the top by four forces of 2.5 on an area of 1


def output_of(done: object) -> str:
    """The output of a job, in one line."""
    return re.sub(r"\s+", " ", done.stdout + done.stderr)  # type: ignore[attr-defined]


def lifts(folder: Path) -> list[float]:
    """Displacements along z of the top in the last block of job.dat."""
    rows = [line.split() for line in (folder / "job.dat").read_text().splitlines() if re.match(r" +[5-8] ", line)]
    return [float(row[3]) for row in rows[-4:]]


@pytest.mark.parametrize(("card", "words"), [
    ("*BOUNDARY,\nLOW, 1, 3\n" + STEP + LOAD, "BOUNDARY"),
    ("*BOUNDARY,\n** the bottom\nLOW, ENCASTRE\n" + STEP + LOAD, "BOUNDARY"),
    (BOUNDARY + STEP + "*CLOAD,\nHIGH, 3, 2.5\n", "CLOAD"),
    (BOUNDARY + STEP + "*CLOAD, OP=NEW,\nHIGH, 3, 2.5\n", "CLOAD"),
    (BOUNDARY + STEP + "*CLOAD,\nOP=NEW,\nHIGH, 3, 2.5\n", "CLOAD"),
    (BOUNDARY + "*STEP,\nINC=10,\nUNSYMM=NO\n*STATIC,\n1., 1.\n*CLOAD,\nOP=NEW\nHIGH, 3, 2.5\n", ""),
    (BOUNDARY + "*NSET, NSET=MORE,\nGENERATE\n5, 8\n" + STEP + "*CLOAD\nMORE, 3, 2.5\n", ""),
    (BOUNDARY + "*NSET, NSET=MORE,\nHIGH\n" + STEP + "*CLOAD\nMORE, 3, 2.5\n", "NSET"),
])  # fmt: skip
@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
def test_trailing_commas(run_deck: Run, tmp_path: Path, dialect: str, card: str, words: str) -> None:
    """After a trailing comma a line without parameters of the card is data, and a note names the card; parameters continue it."""
    done = run_deck(f"** dialect: {dialect}\n" + CUBE + card + END)
    assert done.returncode == 0, done.stdout
    assert lifts(tmp_path) == pytest.approx([LIFT] * 4, rel=1e-6)
    note = "The keyword line above ends with a comma, but this line has no parameter of *"
    assert (note in output_of(done)) == (words != "")
    assert f"{note}{words}" in output_of(done) or not words


def test_trailing_comma_in_a_part(run_deck: Run, tmp_path: Path) -> None:
    """The same inside a part, where names become those of the instance."""
    part = CUBE[: CUBE.index("*MATERIAL")] + "*NSET, NSET=MORE,\nHIGH\n*SOLID SECTION, ELSET=E, MATERIAL=M\n"
    deck = f"*PART, NAME=P\n{part}*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n*END ASSEMBLY\n"
    deck += f"*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, 0.\n*BOUNDARY,\nI.LOW, 1, 3\n{STEP}*CLOAD,\nI.MORE, 3, 2.5\n"
    done = run_deck(deck + END.replace("HIGH", "I.HIGH"))
    assert done.returncode == 0, done.stdout
    assert lifts(tmp_path) == pytest.approx([LIFT] * 4, rel=1e-6)


def test_wrong_parameter_after_a_trailing_comma(run_deck: Run) -> None:
    """A line with an equals sign is no data: its parameter is refused by name."""
    done = run_deck(CUBE + BOUNDARY + STEP + "*CLOAD,\nCOLOUR=RED\nHIGH, 3, 2.5\n" + END)
    assert done.returncode == 3
    assert "no parameter COLOUR" in output_of(done)


@pytest.mark.parametrize("include", ["INPUT=more.inp", "FILE=more.inp", "INPUT=more.inp,", "\nINPUT=more.inp", "\nFILE=more.inp,"])
def test_include(run_deck: Run, tmp_path: Path, include: str) -> None:
    """INPUT and FILE name the file; a comma at the end takes no line of the deck away."""
    (tmp_path / "more.inp").write_text("*BOUNDARY\nLOW, 1, 3\n")
    done = run_deck(CUBE + f"*INCLUDE, {include}\n" + STEP + LOAD + END)
    assert done.returncode == 0, done.stdout
    assert lifts(tmp_path) == pytest.approx([LIFT] * 4, rel=1e-6)


def test_node_file_with_a_trailing_comma(run_deck: Run, tmp_path: Path) -> None:
    """Nodes of a file and of the lines below the card that names it."""
    nodes = "5, 0., 0., 1.\n6, 1., 0., 1.\n7, 1., 1., 1.\n"
    (tmp_path / "nodes.txt").write_text(nodes)
    deck = CUBE.replace(nodes, "").replace("*NODE, NSET=ALL\n", "*NODE, INPUT=nodes.txt,\n")
    done = run_deck(deck + BOUNDARY + STEP + LOAD + END)
    assert done.returncode == 0, done.stdout
    assert lifts(tmp_path) == pytest.approx([LIFT] * 4, rel=1e-6)


@pytest.mark.parametrize(("expression", "value"), [
    ("2.5", 2.5), ("5/2.", 2.5), ("1. + 1.5", 2.5), ("-(1 - 3.5)", 2.5), ("10*0.5**2", 2.5), ("2 - -0.5", 2.5), ("b/c", 2.5),
    ("2.5e-1*10 # comment", 2.5), ("+1D1/4", 2.5), ("8-2-1*3-.5", 2.5), ("2**-1*b/c*2", 2.5), ("-2**2 + 6.5", 2.5), ("a_1*1.", 2.5),
    ("2*(b - (c + .5))", 11.0), ("10/2", 5.0), ("1+2*3", 7.0), ("2**3**2/128", 4.0),
    ("sqrt(6.25)", 2.5), ("2.5*sin(2*atan(1.)); d = 2;", 2.5), ("3; force = force - 0.5", 2.5), ("abs(-2.5)", 2.5),
])  # fmt: skip
def test_parameters(run_deck: Run, tmp_path: Path, expression: str, value: float) -> None:
    """Expressions as Python evaluates them, in data lines and in parameters of cards."""
    cards = f"*PARAMETER\n** numbers\nb = 10.\nc=4\n a_1 = 2.5\nforce = {expression}\nnumber=8\n"
    deck = cards + CUBE.replace("8, 0., 1., 1.", "<number>, 0., 1., 1.") + BOUNDARY
    done = run_deck(deck + "*STEP, INC=<c>\n*STATIC\n*CLOAD\nHIGH, 3, <Force>\n" + END)
    assert done.returncode == 0, done.stdout
    assert lifts(tmp_path) == pytest.approx([4 * value / YOUNG] * 4, rel=1e-6)


def test_parameters_change_in_the_order_of_the_deck(run_deck: Run, tmp_path: Path) -> None:
    """A card of the step gives another value; included files and parts have the parameters too, comments are left alone."""
    (tmp_path / "more.inp").write_text("*PARAMETER\nf = 2*f\n")
    deck = "*PARAMETER\nf = 1.25\n" + CUBE + "** <nothing>\n" + BOUNDARY + "*INCLUDE, INPUT=more.inp\n" + STEP + "*CLOAD\nHIGH, 3, <f>\n"
    done = run_deck(deck + END)
    assert done.returncode == 0, done.stdout
    assert lifts(tmp_path) == pytest.approx([LIFT] * 4, rel=1e-6)


def test_quotients_of_integers_are_rounded_down(run_deck: Run, tmp_path: Path) -> None:
    """5/2 is 2, as Abaqus documents, and the job says so; 5./2 is 2.5."""
    deck = CUBE + BOUNDARY + "*PARAMETER\nf = {}\n" + STEP + "*CLOAD\nHIGH, 3, <f>\n" + END
    done = run_deck(deck.format("5/2"))
    assert done.returncode == 0, done.stdout
    assert "5/2 is rounded down to 2" in output_of(done)
    assert lifts(tmp_path) == pytest.approx([0.8 * LIFT] * 4, rel=1e-6)
    done = run_deck(deck.format("5./2"))
    assert "rounded" not in output_of(done)
    assert lifts(tmp_path) == pytest.approx([LIFT] * 4, rel=1e-6)


@pytest.mark.parametrize(("line", "message"), [
    ("f = 1/0", "divides by zero"), ("f = g + 1", "no parameter 'g' before"), ("f = (1 + 2", "not closed"),
    ("f = 2 +", "is missing in '2 +'"), ("f = 'text'", "is missing"), ("f = sqrt(-2.)", "sqrt has no value here"), ("f = log(0)", "log has no value"),
    ("f = cot(2.)", "no parameter 'cot'"), ("f = asin 1.", "no parameter 'asin'"), ("2.5", "name = expression"),
    ("f = 1 2", "'2' is not understood"), ("f = 10.**400", "not finite"), ("f-1 = 2", "name = expression"), ("e = 1", "There is no parameter 'f'"),
])  # fmt: skip
def test_wrong_parameters(run_deck: Run, line: str, message: str) -> None:
    """What cannot be evaluated is refused with its line."""
    done = run_deck(CUBE + BOUNDARY + f"*PARAMETER\n{line}\n" + STEP + "*CLOAD\nHIGH, 3, <f>\n" + END)
    assert done.returncode == 3
    assert message in output_of(done)


def test_unsupported_element_has_one_message(run_deck: Run) -> None:
    """The section of an element whose type is refused adds no message of its own."""
    deck = re.sub(r"TYPE=C3D8\b", "TYPE=M4R", CUBE).replace("*SOLID SECTION", "*MEMBRANE SECTION")
    done = run_deck(deck + BOUNDARY + STEP + LOAD + END)
    assert done.returncode == 3
    output = output_of(done)
    assert "The element type M4R is not supported. The kinds are" in output and "B21 to B32R" in output
    assert "The deck has 1 error" in output, output


def deck_with(wrong: str, right: str = "", more: str = "") -> str:
    """The cube with one line of it replaced, or more cards of the model."""
    deck = CUBE + more + BOUNDARY + STEP + LOAD + END
    assert right in deck
    return deck.replace(right, wrong, 1) if right else deck


COMMAS = "This looks like decimal commas"


@pytest.mark.parametrize(("right", "wrong"), [
    ("7, 1., 1., 1.", "7, 1,0, 1,0, 1,0"), ("1000.0, 0.", "1000,0, 0,3"), ("*SOLID", "*DENSITY\n7,8e-9\n*SOLID"),
    ("*STATIC\n", "*STATIC\n0,1, 1,\n"), ("*SOLID", "*PLASTIC\n200,5, 0\n*SOLID"), ("*SOLID", "*EXPANSION\n1,2e-5\n*SOLID"),
])  # fmt: skip
def test_decimal_commas(run_deck: Run, right: str, wrong: str) -> None:
    """Digits, a comma and digits without a blank, beside commas with one."""
    done = run_deck(deck_with(wrong, right))
    assert output_of(done).count(COMMAS) == 1


@pytest.mark.parametrize(("right", "wrong"), [
    ("7, 1., 1., 1.", "7,1,1,1"), ("1000.0, 0.", "1000,0"), ("*SOLID", "*DENSITY\n7.8e-9,20\n*SOLID"), ("*STATIC\n", "*STATIC\n1,1\n"),
    ("*SOLID", "*PLASTIC\n200,0\n300,1\n*SOLID"), ("*SOLID", "*EXPANSION\n1.2e-5, 20\n*SOLID"), ("1, 2, 3, 4\n", "1,2, 3,4\n"),
])  # fmt: skip
def test_commas_between_integers(run_deck: Run, right: str, wrong: str) -> None:
    """Integers without blanks are what they are."""
    done = run_deck(deck_with(wrong, right))
    assert done.returncode == 0, done.stdout
    assert COMMAS not in output_of(done)


def test_too_many_values_with_decimal_commas(run_deck: Run) -> None:
    """The error names the decimal mark."""
    done = run_deck(deck_with("HIGH, 3, 2,5", "HIGH, 3, 2.5"))
    assert done.returncode == 3
    assert "This line has 4 values; at most 3 are allowed here; a comma parts two numbers, and a point is the decimal mark." in output_of(done)


@pytest.mark.parametrize(("right", "wrong", "keyword", "code"), [
    ("*ELASTIC", "ELASTIC", "ELASTIC without its star; it counts as data of *MATERIAL", 3),
    ("*STATIC", "static", "STATIC without its star; it counts as data of *STEP", 3),
    ("*BOUNDARY", "Boundary", "BOUNDARY without its star; it counts as data of *SOLID SECTION", 3),
    ("*END STEP", "END STEP", "END STEP without its star; it counts as data of *NODE PRINT", 3),
    ("*NODE PRINT, NSET=HIGH\nU", "*NODE PRINT, NSET=HIGH\nU\nNODE FILE\nU", "NODE FILE without its star; it counts as data of *NODE PRINT", 0),
    ("*NSET, NSET=LOW", "NSET, NSET=LOW", "NSET without its star; it counts as data of *ELEMENT", 3),
])  # fmt: skip
def test_keywords_without_a_star(run_deck: Run, right: str, wrong: str, keyword: str, code: int) -> None:
    """A data line that begins with a keyword is named, with the card that it counts for."""
    done = run_deck(deck_with(wrong, right))
    assert done.returncode == code, done.stdout
    assert f"This line begins with the keyword {keyword}." in output_of(done)


def test_a_set_may_have_the_name_of_a_keyword(run_deck: Run) -> None:
    """Then a line may begin with it."""
    done = run_deck(CUBE + "*NSET, NSET=STATIC\n5\n" + BOUNDARY + STEP + "*CLOAD\nSTATIC, 1, 1.\n" + END)
    assert done.returncode == 0, done.stdout
    assert "star" not in output_of(done)


@pytest.mark.parametrize(("line", "what"), [
    ("*CLOAD\nNONE, 3, 1.", "node"), ("*BOUNDARY\nNONE, 1", "node"), ("*NODE PRINT, NSET=NONE\nU", "node"), ("*DLOAD\nNONE, P2, 1.", "element"),
    ("*EL PRINT, ELSET=NONE\nS", "element"),
])  # fmt: skip
def test_empty_sets(run_deck: Run, line: str, what: str) -> None:
    """A card that uses a set without members is named; a set that none uses is not."""
    sets = "*NSET, NSET=NONE\n*ELSET, ELSET=NONE\n"
    done = run_deck(CUBE + sets + BOUNDARY + STEP + LOAD + END)
    assert done.returncode == 0, done.stdout
    assert "has no members" not in output_of(done)
    done = run_deck(CUBE + sets + BOUNDARY + STEP + LOAD + line + "\n" + END)
    assert done.returncode == 0, done.stdout
    assert output_of(done).count(f"The {what} set 'NONE' has no members.") == 1


def test_sets_of_the_geometry_of_gmsh(run_deck: Run, tmp_path: Path) -> None:
    """meshio writes them with numbers of no node or element, negative ones too."""
    sets = "*NSET, NSET=gmsh:bounding_entities\n-3,\n99\n*ELSET, ELSET=gmsh:bounding_entities\n-1,\n0,\n77\n"
    done = run_deck(CUBE + sets + BOUNDARY + STEP + LOAD + END)
    assert done.returncode == 0, done.stdout
    assert "The set 'gmsh:bounding_entities' describes the geometry of gmsh" in output_of(done)
    assert lifts(tmp_path) == pytest.approx([LIFT] * 4, rel=1e-6)


def test_explanation_of_what_is_refused(run_deck: Run) -> None:
    """The value that an error names is not called used."""
    done = run_deck(deck_with("*ELEMENT, TYPE=S99, ELSET=E\n1, 1, 2, 3, 4", "*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8"), "--explain")
    assert done.returncode == 3
    assert "TYPE=S99: refused, see the error below." in done.stdout
    assert "ELSET=E: used." in done.stdout


def test_layered_solids_are_refused_once(run_deck: Run) -> None:
    """*SOLID SECTION, COMPOSITE: neither the material nor the lines of its layers are errors of their own."""
    layered = CUBE.replace("*SOLID SECTION, ELSET=E, MATERIAL=M\n", "*SOLID SECTION, ELSET=E, COMPOSITE\n0.5, 1, M\n0.5, 1, M\n")
    done = run_deck(layered + BOUNDARY + STEP + LOAD + "*END STEP\n")
    text = " ".join((done.stdout + done.stderr).split())
    assert done.returncode == 3
    assert "The deck has 1 error " in text
    assert "give each layer elements of its own" in text
