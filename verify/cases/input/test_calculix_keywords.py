"""Every keyword of CalculiX 2.20, and the words of its step cards: read, passed over because statics does not need it, or refused.

The keywords are those of its manual (chapter "Input deck format"). None is unknown, and what is refused says what to write instead.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from verify.conftest import Run
from verify.decks.solids import unit_cube

READ = """AMPLITUDE|BEAM GENERAL SECTION|BEAM SECTION|BOUNDARY|CHANGE FRICTION|CHANGE MATERIAL|CHANGE PLASTIC|CHANGE SOLID SECTION|CHANGE SURFACE BEHAVIOR|CLEARANCE|
CLOAD|CONTACT FILE|CONTACT OUTPUT|CONTACT PAIR|CONTACT PRINT|CONTROLS|COUPLING|CREEP|CYCLIC HARDENING|CYCLIC SYMMETRY MODEL|
DEFORMATION PLASTICITY|DENSITY|DEPVAR|DISTRIBUTING|DISTRIBUTING COUPLING|DISTRIBUTION|DLOAD|DSLOAD|DYNAMIC|ELASTIC|ELEMENT|
ELEMENT OUTPUT|EL FILE|EL PRINT|ELSET|END STEP|EQUATION|EXPANSION|FRICTION|GAP|HEADING|HYPERELASTIC|HYPERFOAM|INCLUDE|
INITIAL CONDITIONS|KINEMATIC|MASS|MATERIAL|MEMBRANE SECTION|MODEL CHANGE|MOHR COULOMB|MOHR COULOMB HARDENING|MPC|NO ANALYSIS|NODE|NODE FILE|NODE OUTPUT|NODE PRINT|
NODAL THICKNESS|NORMAL|NSET|ORIENTATION|OUTPUT|PLASTIC|PRE-TENSION SECTION|RATE DEPENDENT|RESTART|RIGID BODY|SECTION PRINT|SHELL SECTION|SOLID SECTION|SPRING|STATIC|STEP|SUBMODEL|SURFACE|
SURFACE BEHAVIOR|SURFACE INTERACTION|TEMPERATURE|TIE|TIME POINTS|TRANSFORM|USER MATERIAL|VISCO"""
PASSED = """CONDUCTIVITY|CONTACT DAMPING|DAMPING|DASHPOT|ELECTRICAL CONDUCTIVITY|FACE PRINT|FILTER|FLUID CONSTANTS|GAP CONDUCTANCE|
GAP HEAT GENERATION|MAGNETIC PERMEABILITY|MODAL DAMPING|PHYSICAL CONSTANTS|SPECIFIC GAS CONSTANT|SPECIFIC HEAT"""
REFUSED = """BASE MOTION|BUCKLE|CFD|CFLUX|CHANGE CONTACT TYPE|COMPLEX FREQUENCY|CONSTRAINT|
CORRELATION LENGTH|COUPLED TEMPERATURE-DISPLACEMENT|CRACK PROPAGATION|DESIGN RESPONSE|DESIGN VARIABLES|DFLUX|
ELECTROMAGNETICS|FEASIBLE DIRECTION|FILM|FLUID SECTION|FREQUENCY|GEOMETRIC CONSTRAINT|GEOMETRIC TOLERANCES|GREEN|HCF|
HEAT TRANSFER|INITIAL STRAIN INCREASE|MASS FLOW|MASS FLOW RATE|MATRIX ASSEMBLE|MODAL DYNAMIC|
NETWORK MPC|OBJECTIVE|RADIATE|RANDOM FIELD|REFINE MESH|
RETAINED NODAL DOFS|ROBUST DESIGN|SELECT CYCLIC SYMMETRY MODES|SENSITIVITY|STEADY STATE DYNAMICS|
SUBSTRUCTURE GENERATE|SUBSTRUCTURE MATRIX OUTPUT|TRANSFORMF|UNCOUPLED TEMPERATURE-DISPLACEMENT|USER SECTION|
VALUES AT INFINITY|VIEWFACTOR"""


def words(table: str) -> list[str]:
    """The keywords of a table."""
    return [word.strip() for word in table.split("|")]


@pytest.mark.parametrize(("table", "message", "code"), [
    (READ, None, None),
    (PASSED, r"is read past\. \w.*", None),
    (REFUSED, r"is not supported\. [A-Z].*", 3),
], ids=["read", "passed over", "refused"])  # fmt: skip
def test_keywords(run_deck: Run, table: str, message: str | None, code: int | None) -> None:
    """Each keyword alone: its message and its exit code."""
    for keyword in words(table):
        done = run_deck(f"** dialect: calculix\n*{keyword}\n")
        text = re.sub(r"\s+", " ", done.stdout + done.stderr)
        assert "is not known" not in text, keyword
        if message:
            assert re.search(rf"The card \*{keyword} {message}", text), f"{keyword}: {text}"
        else:
            assert f"*{keyword} is not supported" not in text, keyword
            assert f"*{keyword} is read past" not in text, keyword
        if code:
            assert done.returncode == code, keyword


def faults_of(text: str) -> dict[str, list[tuple[str, str]]]:
    """What `--cards` says that a card refuses: lines that do it, and the parameter that each message must name."""
    faults: dict[str, list[tuple[str, str]]] = {}
    card = ""
    for line in text.splitlines():
        if head := re.match(r"(\*[A-Z][A-Z0-9 -]*?)  \(.*\)$", line):
            card = head.group(1)
            faults[card] = [(f"{card}, NONSENSE=1", "NONSENSE")]
            continue
        parts = re.match(r"    ([A-Z][A-Z0-9 .-]*?)(?:\[?=([^ :\]]+)\]?)?(?: \((?:required|default [^)]*)\))?: (.*)$", line)
        if not parts or not card:
            continue
        name, kind, rest = parts.groups()
        if rest.startswith("no effect"):
            continue
        values = []
        if rest.startswith("refused."):
            values = ["1"]
        elif kind in ("integer", "real"):
            values = ["abc"]
        elif kind and ("/" in kind or kind.isupper()):
            values = ["NONSENSE"]
        if refused := re.search(r"Refused: (.*?)\. ", rest):
            values += re.split(r", | or ", refused.group(1))
        faults[card] += [(f"{card}, {name}={value}", name) for value in values]
    return faults


def test_what_each_card_refuses(run_deck: Run, run: Run) -> None:
    """Of every card of the table: a parameter that it has not, parameters and words that are refused, invalid words and numbers.
    Each is an error in its line that names the parameter."""
    faults = faults_of(run(["--cards"]).stdout)
    assert len(faults) >= 90
    assert sum(len(rows) for rows in faults.values()) >= 390
    for card, rows in faults.items():
        done = run_deck("".join(f"{row}\n" for row, _ in rows))
        assert done.returncode == 3, card
        text = re.sub(r"\n(?!job.inp)", " ", done.stdout + done.stderr)
        for i, (row, name) in enumerate(rows, 1):
            assert re.search(rf"^job.inp:{i}: \*ERROR.*{re.escape(name)}", text, re.MULTILINE), row


CUBE = unit_cube() + """*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=E, MATERIAL=M
*BOUNDARY
LOW, 1, 3
"""
PRINT = "*NODE PRINT, NSET=HIGH\nU\n"


def last_block(folder: Path) -> tuple[float, float]:
    """Time and u_z of the first row of the last block."""
    lines = (folder / "job.dat").read_text().split("\n")
    heads = [i for i, line in enumerate(lines) if "displacements" in line]
    return float(lines[heads[-1]].split()[-1]), float(lines[heads[-1] + 2].split()[3])


@pytest.mark.parametrize(("words", "time"), [("", 3.0), (", TIME RESET", 1.0), (", TOTAL TIME AT START=7.", 9.0)])
def test_clock(run_deck: Run, tmp_path: Path, words: str, time: float) -> None:
    """A second step of length 2: where its total time ends, and what an amplitude in total time gives there.

    The factor is the total time, so that u_z of the cube (E = 1000, four nodal forces of 1 N times the factor) is 0.004 t.
    """
    deck = f"""** dialect: calculix
{CUBE}*AMPLITUDE, NAME=A, TIME=TOTAL TIME
0., 0., 100., 100.
*STEP
*STATIC
1., 1.
*CLOAD, AMPLITUDE=A
HIGH, 3, 1.
{PRINT}*END STEP
*STEP
*STATIC{words}
1., 2.
{PRINT}*END STEP
"""
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    got, u = last_block(tmp_path)
    assert got == pytest.approx(time, rel=1e-7)
    assert u == pytest.approx(0.004 * time, rel=2e-6)  # seven digits are printed


def displacements(folder: Path) -> list[float]:
    """Time and u_z of the first row of each block, one after the other."""
    lines = (folder / "job.dat").read_text().split("\n")
    return [float(word) for i, line in enumerate(lines) if "displacements" in line for word in (line.split()[-1], lines[i + 2].split()[3])]


@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
@pytest.mark.parametrize("option", ["", ", AMPLITUDE=STEP"])
def test_supports_of_the_model(run_deck: Run, tmp_path: Path, dialect: str, option: str) -> None:
    """A displacement before the first step grows over that step, whatever its loads do, and stays in the next one; a later line of
    the step itself counts in its place."""
    model = CUBE + "*BOUNDARY\nHIGH, 3, 3, .01\n"
    step = f"*STEP, NLGEOM{option}\n*STATIC, DIRECT\n.25, 1.\n{PRINT}*END STEP\n"
    done = run_deck(f"** dialect: {dialect}\n{model}{step}{step}")
    assert done.returncode == 0, done.stdout
    assert displacements(tmp_path) == pytest.approx([x for i in range(1, 9) for x in (0.25 * i, 0.01 * min(0.25 * i, 1.0))], rel=2e-6)
    if not option:
        done = run_deck(f"** dialect: {dialect}\n{model}{step.replace('*NODE', '*BOUNDARY' + chr(10) + 'HIGH, 3, 3, .02' + chr(10) + '*NODE')}")
        assert done.returncode == 0, done.stdout
        assert displacements(tmp_path) == pytest.approx([x for i in range(1, 5) for x in (0.25 * i, 0.005 * i)], rel=2e-6)


def test_amplitude_of_a_support_of_the_model(run_deck: Run, tmp_path: Path) -> None:
    """Its amplitude runs over the first step, and its end is kept."""
    model = CUBE + "*AMPLITUDE, NAME=A\n0., 0., .5, 1., 1., .5\n*BOUNDARY, AMPLITUDE=A\nHIGH, 3, 3, .01\n"
    step = f"*STEP, NLGEOM\n*STATIC, DIRECT\n.25, 1.\n{PRINT}*END STEP\n"
    assert run_deck(f"** dialect: calculix\n{model}{step}{step}").returncode == 0
    assert displacements(tmp_path)[1::2] == pytest.approx([0.005, 0.01, 0.0075] + 5 * [0.005], rel=2e-6)


def test_perturbation(run_deck: Run, tmp_path: Path) -> None:
    """Load cases: each step shows what its own loads do to the body at rest (u = F L / (E A)), supports of the model stay."""
    case = "*STEP, PERTURBATION\n*STATIC\n*CLOAD\nHIGH, 3, {}\n" + PRINT + "*END STEP\n"
    moved = "*STEP, PERTURBATION\n*STATIC\n*BOUNDARY\nHIGH, 3, 3, .02\n" + PRINT + "*END STEP\n"
    last = "*STEP\n*STATIC\n*CLOAD\nHIGH, 3, 3.\n" + PRINT + "*END STEP\n"
    done = run_deck(CUBE + case.format(1.0) + case.format(-2.0) + moved + case.format(0.5) + last)
    assert done.returncode == 0, done.stdout
    assert displacements(tmp_path)[1::2] == pytest.approx([0.004, -0.008, 0.02, 0.002, 0.012], rel=2e-6)
    assert run_deck("** dialect: calculix\n" + CUBE + case.format(1.0)).returncode == 0
    assert displacements(tmp_path) == pytest.approx([1.0, 0.004], rel=2e-6)


@pytest.mark.parametrize(("deck", "message"), [
    (CUBE + "*STEP\n*STATIC\n*END STEP\n*STEP, PERTURBATION\n*STATIC\n*END STEP\n", "after a general step"),
    (CUBE + "*STEP, PERTURBATION, NLGEOM\n*STATIC\n*END STEP\n", "where contact, a material"),
    (CUBE.replace("1000., 0.\n", "1000., 0.\n*PLASTIC\n5., 0.\n") + "*STEP, PERTURBATION\n*STATIC\n*END STEP\n", "where contact, a material"),
    ("** dialect: calculix\n" + CUBE + 2 * "*STEP, PERTURBATION\n*STATIC\n*END STEP\n", "with other steps"),
    ("** dialect: calculix\n" + CUBE + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 0.\n*STEP, PERTURBATION\n*STATIC\n*TEMPERATURE\nALL, 9.\n*END STEP\n",
     "with *TEMPERATURE"),
], ids=["after", "nlgeom", "plastic", "two", "warm"])  # fmt: skip
def test_perturbations_refused(run_deck: Run, deck: str, message: str) -> None:
    """What is not that of a linear body at rest."""
    done = run_deck(deck)
    assert done.returncode == 3
    assert f"PERTURBATION is not supported {message}" in re.sub(r"\s+", " ", done.stdout + done.stderr)


def test_initial_displacements(run_deck: Run, tmp_path: Path) -> None:
    """They change nothing, and a message says so."""
    step = f"*INITIAL CONDITIONS, TYPE=DISPLACEMENT\nHIGH, 3, .1\n*STEP, NLGEOM\n*STATIC\n*BOUNDARY\nHIGH, 3, 3, .01\n{PRINT}*END STEP\n"
    done = run_deck(f"** dialect: calculix\n{CUBE}{step}", "--explain")
    assert "Initial displacements have no effect in a static step" in re.sub(r"\s+", " ", done.stdout + done.stderr)
    assert run_deck(f"** dialect: calculix\n{CUBE}{step}").returncode == 0
    assert displacements(tmp_path) == pytest.approx([1.0, 0.01], rel=2e-6)


def test_energy_of_a_body_that_flows(run_deck: Run, tmp_path: Path) -> None:
    """ENER of a bar that is pulled to eight times its yield strain: under calculix all work, under abaqus that in the elastic strain.

    With E = 1000, yield stress 5 and no hardening: s^2 / (2 E) = 0.0125, and s (0.04 - 0.005) more in the plastic strain."""
    flowing = CUBE.replace("1000., 0.\n", "1000., 0.\n*PLASTIC\n5., 0.\n").replace("LOW, 1, 3\n", "LOW, 3, 3\n1, 1, 2\n2, 2, 2\n")
    step = "*STEP\n*STATIC, DIRECT\n.125, 1.\n*BOUNDARY\nHIGH, 3, 3, .04\n*EL PRINT, ELSET=E\nENER\n*END STEP\n"
    for dialect, energy in (("abaqus", 0.0125), ("calculix", 0.0125 + 5.0 * 0.035)):
        assert run_deck(f"** dialect: {dialect}\n{flowing}{step}").returncode == 0
        rows = re.findall(r"^ +1 +\d +(\S+)$", (tmp_path / "job.dat").read_text(), re.MULTILINE)
        assert float(rows[-1]) == pytest.approx(energy, rel=1e-5), dialect


@pytest.mark.parametrize(("dialect", "row", "code", "place"), [
    ("abaqus", "7, 1, 1, 1", 0, 1.0), ("calculix", "7, 1., 1., 1.", 0, 1.0), ("calculix", "7, 1, 1, 2", 0, 2.0), ("abaqus", "7, 1, 1, 2", 3, None),
])  # fmt: skip
def test_nodes_given_again(run_deck: Run, tmp_path: Path, dialect: str, row: str, code: int, place: float | None) -> None:  # noqa: PLR0913
    """A node that stands in the deck again is one node and in both sets; at another place the last counts in CalculiX, else it is an error."""
    deck = CUBE.replace("*NSET, NSET=LOW", f"*NODE, NSET=AGAIN\n{row}\n*NSET, NSET=LOW")
    done = run_deck(f"** dialect: {dialect}\n{deck}*STEP\n*STATIC\n*CLOAD\nHIGH, 3, 1.\n*NODE PRINT, NSET=AGAIN\nCOORD\n{PRINT}*END STEP\n")
    assert done.returncode == code, done.stdout
    text = re.sub(r"\s+", " ", done.stdout + done.stderr)
    if place is None:
        assert "The node 7 is defined twice, here at another place; the first time in line 9 of job.inp." in text
        return
    assert "The deck defines 1 node more than once" in text
    rows = re.search(r"coordinates .*?\n\n(.*?)\n", (tmp_path / "job.dat").read_text(), re.DOTALL)
    assert rows
    assert [float(word) for word in rows.group(1).split()] == pytest.approx([7.0, 1.0, 1.0, place])
    if place == 1.0:
        assert displacements(tmp_path) == pytest.approx([1.0, 0.004], rel=2e-6)


def test_members_named_twice(run_deck: Run, tmp_path: Path) -> None:
    """A load acts on a member of a set once, however often the set names it; where CalculiX applies it as often, a message says so."""
    message = "Here the load acts on each of them once; CalculiX applies it as often as they are named."
    deck = CUBE.replace("5, 6, 7, 8\n*MATERIAL", "5, 6, 7, 8, 5\n*MATERIAL") + f"*STEP\n*STATIC\n*CLOAD\nHIGH, 3, 1.\n{PRINT}*END STEP\n"
    for dialect in ("abaqus", "calculix"):
        done = run_deck(f"** dialect: {dialect}\n{deck}")
        assert done.returncode == 0, done.stdout
        assert displacements(tmp_path) == pytest.approx([1.0, 0.004], rel=2e-6)
        assert (message in re.sub(r"\s+", " ", done.stdout + done.stderr)) == (dialect == "calculix")
    pressed = CUBE.replace("*MATERIAL", "*ELSET, ELSET=E\n1\n*MATERIAL") + f"*STEP\n*STATIC\n*DLOAD\nE, P2, 4.\n{PRINT}*END STEP\n"
    done = run_deck("** dialect: calculix\n" + pressed)
    assert message in re.sub(r"\s+", " ", done.stdout + done.stderr)
    assert displacements(tmp_path) == pytest.approx([1.0, -0.004], rel=2e-6)


@pytest.mark.parametrize(("second", "is_noted"), [("E, CENTRIF, 1., 0., 0., 0., 0., 1., 0.", True), ("1, CENTRIF, 1., 0., 0., 0., 1., 0., 0.", True),
                                                  ("E, CENTRIF, 1., 0., 0., 0., 1., 0., 0.", False), ("E, GRAV, 1., 0., 1., 0.", False)])
def test_second_rotation(run_deck: Run, second: str, is_noted: bool) -> None:
    """An element that turns about two axes, or by two sets: both act, which CalculiX does not do."""
    deck = CUBE.replace("*ELASTIC", "*DENSITY\n2.\n*ELASTIC") + "*STEP\n*STATIC\n*DLOAD\nE, CENTRIF, 1., 0., 0., 0., 1., 0., 0.\n"
    for dialect in ("abaqus", "calculix"):
        done = run_deck(f"** dialect: {dialect}\n{deck}{second}\n{PRINT}*END STEP\n")
        assert done.returncode == 0, done.stdout
        assert ("applies one of them alone" in " ".join((done.stdout + done.stderr).split())) == (is_noted and dialect == "calculix")


@pytest.mark.parametrize("kind", ["CAX4", "CPE4"])
def test_springs_on_rings(run_deck: Run, kind: str) -> None:
    """A spring at a ring acts on two degrees of the circle, as in CalculiX, and a note says so."""
    deck = f"*NODE\n1, 1., 0.\n2, 2., 0.\n3, 2., 1.\n4, 1., 1.\n*ELEMENT, TYPE={kind}, ELSET=E\n1, 1, 2, 3, 4\n*ELEMENT, TYPE=SPRING1, ELSET=S\n7, 3\n8, 4\n"
    deck += "*SPRING, ELSET=S\n2\n10.\n*SOLID SECTION, ELSET=E, MATERIAL=M\n1.\n*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n*NSET, NSET=N\n1, 2\n"
    deck += "*STEP\n*STATIC\n*BOUNDARY\nN, 1, 2\n*DLOAD\nE, P3, 1.\n*END STEP\n"
    for dialect in ("abaqus", "calculix"):
        done = run_deck(f"** dialect: {dialect}\n{deck}")
        assert done.returncode == 0, done.stdout
        says_so = "(2 springs, the first is element 7) act on two degrees of the circle" in " ".join((done.stdout + done.stderr).split())
        assert says_so == (kind == "CAX4" and dialect == "calculix")


def test_density_over_temperature(run_deck: Run, tmp_path: Path) -> None:
    """Weight of a bar, u = rho g L^2 / (2 E): rho at the start under abaqus, at the present temperature under calculix."""
    deck = CUBE.replace("*ELASTIC", "*DENSITY\n2., 0.\n1., 100.\n*ELASTIC") + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20.\n"
    deck += f"*STEP\n*STATIC\n*TEMPERATURE\nALL, 70.\n*DLOAD\nE, GRAV, 10., 0., 0., -1.\n{PRINT}*END STEP\n"
    for dialect, rho in (("abaqus", 1.8), ("calculix", 1.3)):
        assert run_deck(f"** dialect: {dialect}\n{deck}").returncode == 0
        assert displacements(tmp_path)[-1] == pytest.approx(-rho * 10 / 2 / 1000, rel=2e-6)


def test_no_analysis(run_deck: Run, tmp_path: Path) -> None:
    """The deck is checked, and nothing is written; an error in it is reported."""
    deck = f"** dialect: calculix\n{CUBE}*STEP\n*NO ANALYSIS\n*CLOAD\nHIGH, 3, 1.\n*END STEP\n"
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    assert not (tmp_path / "job.vtkhdf").exists()
    assert run_deck(deck.replace("HIGH, 3, 1.", "NONE, 3, 1.")).returncode == 3


@pytest.mark.parametrize(("card", "word"), [
    ("STEP", "STEP, INC=1000"), ("STEP", "STEP, AMPLITUDE=RAMP"), ("STEP", "STEP, NLGEOM=NO"),
    ("STATIC", "STATIC, SOLVER=PARDISO"), ("STATIC", "STATIC, SOLVER=ITERATIVE CHOLESKY"), ("STATIC", "STATIC, DIRECT"),
    ("STATIC", "STATIC, DIRECT=NO"),
    ("CLOAD", "SLIP WEAR\n1., 2.\n*CLOAD"),
    ("STATIC", "STATIC, STABILIZE=1e-4, ALLSDTOL=0.05"), ("STATIC\n1., 1.", "STATIC\n1., 1., 1e-9, 2., 0."),
    ("STATIC\n1., 1.", "STATIC\n0.5, 1., 0.7"), ("CLOAD", "CLOAD, LOAD CASE=1"), ("CLOAD", "CLOAD, SECTOR=1"),
    ("CLOAD", "CLOAD, OP=NEW"), ("BOUNDARY", "BOUNDARY, LOAD CASE=1"), ("NODE PRINT", "NODE PRINT, FREQUENCYF=3, GLOBAL=YES"),
    ("NODE PRINT", "NODE PRINT, TOTALS=YES"), ("END STEP", "NODE FILE, OUTPUT=3D, NSET=HIGH\nU, RF, NT, PU\n*END STEP"),
    ("END STEP", "EL FILE, LAST ITERATIONS, GLOBAL=NO\nS, E, ME, PEEQ, ENER, ERR, ZZS, THE, HER, SDV\n*END STEP"),
    ("END STEP", "CONTACT FILE, CONTACT ELEMENTS\nCDIS, CSTR, PCON\n*END STEP"),
    ("END STEP", "EL PRINT, ELSET=E\nS, E, ME, PEEQ, SDV, ENER, ELSE, EVOL, EMAS, COORD, ZZS\n*END STEP"),
    ("NODE", "NODE, SYSTEM=R"), ("ELASTIC", "ELASTIC, TYPE=ISO"),
])  # fmt: skip
def test_words(run_deck: Run, tmp_path: Path, card: str, word: str) -> None:
    """Words that change nothing of a linear step of length 1: the displacement is that of a bar, F L / (E A) = 0.004."""
    step = f"*STEP\n*STATIC\n1., 1.\n*CLOAD\nHIGH, 3, 1.\n{PRINT}*END STEP\n"
    deck = f"** dialect: calculix\n{CUBE}{step}"
    assert f"*{card}" in deck
    done = run_deck(deck.replace(f"*{card}", f"*{word}", 1))
    assert done.returncode == 0, done.stdout
    time, u = last_block(tmp_path)
    assert time == pytest.approx(1.0)
    if "TOTALS" not in word:
        assert u == pytest.approx(0.004, rel=2e-6)


def test_dashpots(run_deck: Run, tmp_path: Path) -> None:
    """CalculiX's dashpots do nothing in statics; under abaqus they are refused, for there they act by the increment."""
    more = "*ELEMENT, TYPE=DASHPOTA, ELSET=D\n9, 5, 1\n*DASHPOT, ELSET=D\n\n1e5\n"
    step = f"*STEP\n*STATIC\n1., 1.\n*CLOAD\nHIGH, 3, 1.\n{PRINT}*END STEP\n"
    done = run_deck(f"** dialect: calculix\n{CUBE}{more}{step}")
    assert done.returncode == 0, done.stdout
    assert last_block(tmp_path)[1] == pytest.approx(0.004, rel=2e-6)
    done = run_deck(CUBE + more + step)
    assert done.returncode == 3
    assert "leave the dashpots out" in re.sub(r"\s+", " ", done.stdout + done.stderr)


@pytest.mark.parametrize("words", ["NSET=HIGH", "PIN NSET=HIGH", "TIE NSET=HIGH, POSITION=INPUT", "PIN NSET=HIGH, TIE NSET=CORNER"])
def test_rigid_body(run_deck: Run, tmp_path: Path, words: str) -> None:
    """The upper face as a rigid body under a force at its node: u_z = F L / (E A) everywhere."""
    deck = f"""{CUBE}*NODE, NSET=REF
100, .5, .5, 2.
*NSET, NSET=CORNER
7
*RIGID BODY, REF NODE=REF, {words}
*STEP
*STATIC
*BOUNDARY
REF, 4, 6
*CLOAD
REF, 3, 4.
{PRINT}*END STEP
"""
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    assert last_block(tmp_path)[1] == pytest.approx(0.004, rel=2e-6)


def test_rigid_body_over_missing_nodes(run_deck: Run) -> None:
    """An element with an undefined node is reported; the rigid body over it does not write past its list."""
    deck = CUBE.replace("8, 0., 1., 1.\n", "") + "*NODE\n100, .5, .5, 2.\n*RIGID BODY, REF NODE=100, ELSET=E\n*STEP\n*STATIC\n*END STEP\n"
    done = run_deck(deck)
    assert done.returncode == 3
    assert "no node 8" in re.sub(r"\s+", " ", done.stdout + done.stderr)


def test_contact_with_all_prescribed(run_deck: Run) -> None:
    """Nothing is left to solve for; the condensed solver has no unknowns to order, and the job ends well."""
    upper = "".join(f"{i + 8}, {x}, {y}, {z}\n" for i, (x, y, z) in enumerate(
        [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1), (0, 0, 2), (1, 0, 2), (1, 1, 2), (0, 1, 2)], start=1))  # fmt: skip
    deck = f"""{CUBE}*NODE, NSET=UP
{upper}*ELEMENT, TYPE=C3D8, ELSET=F
2, 9, 10, 11, 12, 13, 14, 15, 16
*SOLID SECTION, ELSET=F, MATERIAL=M
*SURFACE, NAME=TOP
E, S2
*SURFACE, NAME=SOLE
F, S1
*SURFACE INTERACTION, NAME=I
*CONTACT PAIR, INTERACTION=I
SOLE, TOP
*BOUNDARY
ALL, 1, 3
UP, 1, 3
*STEP
*STATIC
*BOUNDARY
UP, 3, 3, 0.1
*END STEP
"""
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr


def test_unknown_cards(run_deck: Run) -> None:
    """Unknown keywords: CalculiX warns and continues, Abaqus stops; so do the dialects."""
    step = f"*STEP\n*STATIC\n*NONSENSE\n1, 2\n*CLOAD\nHIGH, 3, 1.\n{PRINT}*END STEP\n"
    done = run_deck(f"** dialect: calculix\n{CUBE}{step}")
    assert done.returncode == 0, done.stdout
    assert "*NONSENSE is not known, to CalculiX neither" in re.sub(r"\s+", " ", done.stdout)
    assert run_deck(CUBE + step).returncode == 3


@pytest.mark.parametrize(("kind", "taken"), [("C3D8RH", "C3D8R"), ("C3D8H", "C3D8"), ("C3D8T", "C3D8"), ("C3D8RT", "C3D8R")])
def test_kinds(run_deck: Run, tmp_path: Path, kind: str, taken: str) -> None:
    """Letters that stand for other unknowns are left out, those of the integration stay."""
    done = run_deck(CUBE.replace("TYPE=C3D8,", f"TYPE={kind},") + f"*STEP\n*STATIC\n*CLOAD\nHIGH, 3, 1.\n{PRINT}*END STEP\n")
    assert done.returncode == 0, done.stdout
    assert f"elements {kind} are taken as {taken}." in re.sub(r"\s+", " ", done.stdout)
    assert last_block(tmp_path)[1] == pytest.approx(0.004, rel=2e-6)
