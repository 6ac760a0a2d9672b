"""The dialect: parts and instances, amplitudes, surfaces without faces, included data; what they do and what they refuse.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from verify.conftest import Run
from verify.decks.solids import UNIT_CUBE

DIGITS = 2e-6  # seven digits are printed

BRICK = f"""*PART, NAME=Brick
*NODE
{UNIT_CUBE.partition("*ELEMENT")[0]}*ELEMENT, TYPE=C3D8
1, 1, 2, 3, 4,
5, 6, 7, 8
*NSET, NSET=Low
1, 2, 3, 4
*NSET, NSET=High, GENERATE
5, 8, 1
*NSET, NSET=Every
Low, High
*ELSET, ELSET=All
1
*ELSET, ELSET=_Top_S2, INTERNAL
1
*SURFACE, TYPE=ELEMENT, NAME=Top
_Top_S2, S2
*SURFACE, TYPE=ELEMENT, NAME=Bottom
1, S1
*ORIENTATION, NAME=Axes
1., 0., 0., 0., 1., 0.
3, 0.
*SOLID SECTION, ELSET=All, ORIENTATION=Axes, MATERIAL=Wood
,
*END PART
"""
WOOD = "*MATERIAL, NAME=Wood\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n1000., 500., 250., 0., 0., 0., 100., 100.,\n100.\n"
STEEL = "*MATERIAL, NAME=Wood\n*ELASTIC\n1000., 0.\n"


def rows_of(folder: Path, title: str = "displacements", name: str = "") -> dict[int, list[float]]:
    """The rows of the last block of a title (and set) in job.dat."""
    rows: dict[int, list[float]] = {}
    is_inside = False
    for line in (folder / "job.dat").read_text().splitlines():
        if " for set " in line:
            is_inside = line.strip().startswith(title) and (not name or f"for set {name.upper()} " in line)
            rows = {} if is_inside else rows
        elif is_inside and re.match(r" +\d", line) and (words := line.split()):
            rows[int(words[0])] = [float(word) for word in words[1:]]
    return rows


def refused(run_deck: Run, deck: str) -> str:
    """The message about a deck that has to be refused."""
    done = run_deck(deck)
    assert done.returncode == 3, f"exit {done.returncode}\n{done.stdout}"
    return re.sub(r"\s+", " ", done.stdout + done.stderr)


def test_column_of_two_instances(run_deck: Run, tmp_path: Path) -> None:
    """Two instances tied on each other, a reference node of the assembly that pulls: u = F L / (E A) of each."""
    deck = f"""*HEADING
two bricks
{BRICK}*ASSEMBLY, NAME=Assembly
*INSTANCE, NAME=Brick-1, PART=Brick
*END INSTANCE
*INSTANCE, NAME=Brick-2, PART=Brick
0., 0., 1.
*END INSTANCE
*NODE
1, .5, .5, 3.
*NSET, NSET=Fixed, INSTANCE=Brick-1
Low,
*NSET, NSET=Lid, INSTANCE=Brick-2
5, 6, 7, 8
*NSET, NSET=Ref
1,
*ELSET, ELSET=Both, INSTANCE=Brick-1
All,
*ELSET, ELSET=Both, INSTANCE=Brick-2
1,
*TIE, NAME=Glue
Brick-2.Bottom, Brick-1.Top
*COUPLING, CONSTRAINT NAME=C, REF NODE=Ref, SURFACE=Brick-2.Top
*KINEMATIC
*END ASSEMBLY
{STEEL}*BOUNDARY
Fixed, 1, 3
*STEP
*STATIC
*CLOAD
Ref, 3, 10.
*BOUNDARY
Brick-2.7, 1, 1
*NODE PRINT, NSET=Lid
U
*NODE PRINT, NSET=Ref
U
*NODE PRINT, NSET=Brick-1.Every
U
*EL PRINT, ELSET=Both
S
*END STEP
"""
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    assert "Of the instance Brick-2 the numbers of nodes are 8" in done.stdout + done.stderr
    assert sorted(rows_of(tmp_path, name="Lid")) == [13, 14, 15, 16]
    assert all(row[2] == pytest.approx(0.02, rel=DIGITS) for row in rows_of(tmp_path, name="Lid").values())
    assert rows_of(tmp_path, name="Ref")[17][2] == pytest.approx(0.02, rel=DIGITS)
    assert rows_of(tmp_path, name="Brick-1.Every")[5][2] == pytest.approx(0.01, rel=DIGITS)
    assert rows_of(tmp_path, "stresses", "Both").keys() == {1, 6} or len(rows_of(tmp_path, "stresses", "Both")) == 2


@pytest.mark.parametrize(("card", "code", "message"), [
    ("*HOURGLASS STIFFNESS", 0, "*HOURGLASS STIFFNESS is read past. The stiffness of one-point elements"),
    ("*TRANSVERSE SHEAR STIFFNESS", 3, "*TRANSVERSE SHEAR STIFFNESS must be directly below *SHELL SECTION"),
])  # fmt: skip
def test_numbers_of_a_section_inside_a_part(run_deck: Run, card: str, code: int, message: str) -> None:
    """What these cards do inside a part is what they do outside."""
    brick = BRICK.replace("*END PART", f"{card}\n25., 30., 0.\n*END PART")
    done = run_deck(f"{brick}*ASSEMBLY\n{INSTANCE}*END ASSEMBLY\n{STEEL}*BOUNDARY\nI.Low, 1, 3\n*STEP\n*STATIC\n*CLOAD\n"
                    "I.High, 3, 1.\n*END STEP\n")  # fmt: skip
    assert done.returncode == code, done.stdout
    assert message in re.sub(r"\s+", " ", done.stdout + done.stderr)


def test_turned_instance(run_deck: Run, tmp_path: Path) -> None:
    """Moved by (5, 0, 0), then turned by 90 degrees about the line x = 1 along z: its stiff axis points along y.

    Node 2 of the part, (1, 0, 0), goes to (6, 0, 0), then to (1, 5, 0).
    """
    deck = f"""{BRICK}*ASSEMBLY, NAME=A
*INSTANCE, NAME=Turned, PART=Brick
5., 0., 0.
1., 0., 0., 1., 0., 1., 90.
*END INSTANCE
*NSET, NSET=Root, INSTANCE=Turned
1, 4, 5, 8
*NSET, NSET=End, INSTANCE=Turned
2, 3, 6, 7
*END ASSEMBLY
{WOOD}*BOUNDARY
Root, 1, 3
*STEP
*STATIC
*BOUNDARY
End, 2, 2, .001
*NODE PRINT, NSET=Root, TOTALS=ONLY
RF
*END STEP
"""
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    total = [line.split() for line in (tmp_path / "job.dat").read_text().splitlines() if re.match(r" +-?\d+\.\d+E", line)][-1]
    assert [float(word) for word in total] == pytest.approx([0, -1000.0 * 0.001, 0], abs=1e-9)
    import h5py  # noqa: PLC0415

    with h5py.File(tmp_path / "job.vtkhdf") as file:
        assert file["VTKHDF/Points"][1] == pytest.approx([1.0, 5.0, 0.0], abs=1e-12)


INSTANCE = "*INSTANCE, NAME=I, PART=Brick\n*END INSTANCE\n"
STEP = "*STEP\n*STATIC\n*END STEP\n"


@pytest.mark.parametrize(("deck", "message"), [
    (BRICK.replace("*END PART\n", ""), "no *END PART"),
    (f"{BRICK}*ASSEMBLY\n*INSTANCE, NAME=I, PART=Stone\n*END INSTANCE\n*END ASSEMBLY\n", "There is no part 'Stone'"),
    (f"{BRICK}*ASSEMBLY\n*INSTANCE, PART=Brick\n*END INSTANCE\n*END ASSEMBLY\n", "needs the parameter NAME=name"),
    (f"{BRICK}*ASSEMBLY\n{INSTANCE}{INSTANCE}*END ASSEMBLY\n", "The instance 'I' is defined twice"),
    (f"{BRICK}*ASSEMBLY\n*INSTANCE, NAME=I, PART=Brick\n*END ASSEMBLY\n", "no *END INSTANCE"),
    (f"{BRICK}{INSTANCE}", "must be between *ASSEMBLY"),
    (f"{BRICK}*ASSEMBLY\n{INSTANCE}{STEP}*END ASSEMBLY\n", "must be after *END ASSEMBLY"),
    (f"{BRICK}*ASSEMBLY\n{INSTANCE}*NSET, NSET=N, INSTANCE=J\n1\n*END ASSEMBLY\n", "There is no instance 'J'"),
    (f"{BRICK}*ASSEMBLY\n*INSTANCE, NAME=I, PART=Brick\n1., 2., 3., 4.\n*END INSTANCE\n*END ASSEMBLY\n", "translation of three"),
    (f"{BRICK}*ASSEMBLY\n*INSTANCE, NAME=I, PART=Brick\n\n0,0,0\n1.,1.,1.,1.,1.,1.,90.\n*END INSTANCE\n*END ASSEMBLY\n", "must differ"),
    (BRICK.replace("*END PART", "*BOUNDARY\n1, 1\n*END PART")
     + "*ASSEMBLY\n*INSTANCE, NAME=I, PART=Brick\n0,0,0\n0.,0.,0.,0.,0.,1.,90.\n*END INSTANCE\n*END ASSEMBLY\n", "is rotated"),
    (BRICK.replace("*END PART", "*CYCLIC SYMMETRY MODEL\n1, 1\n*END PART") + f"*ASSEMBLY\n{INSTANCE}*END ASSEMBLY\n", "inside a part"),
])
def test_refused_parts(run_deck: Run, deck: str, message: str) -> None:
    """An invalid structure; nothing else of the deck is read then."""
    text = refused(run_deck, f"{deck}{STEEL}{STEP}")
    assert message in text
    assert "1 error" in text


@pytest.mark.parametrize(("follows", "before"), [("", "*STEP"), (f"*ASSEMBLY\n{INSTANCE}*END ASSEMBLY\n", "*ASSEMBLY"),
                                                 ("*Part, NAME=Other\n*END PART\n", "*Part, NAME=Other")])
def test_a_part_without_its_end(run_deck: Run, follows: str, before: str) -> None:
    """The message names the line where the part begins, and the card before which its end is missing."""
    text = refused(run_deck, f"*HEADING\nA title\n{BRICK.replace('*END PART' + chr(10), '')}{follows}{STEEL}{STEP}")
    assert "job.inp:3" in text, text
    assert f"This part has no *END PART before {before};" in text


def test_errors_in_a_part_keep_their_lines(run_deck: Run) -> None:
    """The line of the part is named, once for each instance."""
    deck = f"{BRICK.replace('1, S1', '1, S9')}*ASSEMBLY\n{INSTANCE}*END ASSEMBLY\n{STEEL}{STEP}"
    line = deck.splitlines().index("1, S9") + 1
    assert f"job.inp:{line}:" in refused(run_deck, deck)


CUBE = BRICK.replace("*PART, NAME=Brick\n", "").replace("*END PART\n", "").replace(", ORIENTATION=Axes", "") + STEEL
HELD = "*BOUNDARY\nLow, 1, 3\n"


def test_long_names(run_deck: Run) -> None:
    """Names may have 80 characters, of instances and sets together 161; one more is an error."""
    name = "N" * 80
    deck = f"{CUBE}*NSET, NSET={name}\n1\n{HELD}*STEP\n*STATIC\n*NODE PRINT, NSET={name}\nU\n*END STEP\n"
    assert run_deck(deck).returncode == 0
    assert "more than 80 characters" in refused(run_deck, deck.replace(name, name + "N"))
    part = BRICK.replace("Every", name)
    deck = f"{part}*ASSEMBLY\n*INSTANCE, NAME={'I' * 80}, PART=Brick\n*END INSTANCE\n*END ASSEMBLY\n{STEEL}*BOUNDARY\n"
    deck += f"{'I' * 80}.{name}, 1, 3\n*STEP\n*STATIC\n*END STEP\n"
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout


AMPLITUDES = {
    "SMOOTH": ("*AMPLITUDE, NAME=A, DEFINITION=SMOOTH STEP\n0., 1., 2., 5.\n",
               lambda t: 1 + 4 * (t / 2) ** 3 * (10 - 15 * (t / 2) + 6 * (t / 2) ** 2)),
    "EQUAL": ("*AMPLITUDE, NAME=A, DEFINITION=EQUALLY SPACED, FIXED INTERVAL=.5, BEGIN=.25\n1., 3.\n2.\n",
              lambda t: 1 if t < 0.25 else 1 + 4 * (t - 0.25) if t < 0.75 else 3 - 2 * (t - 0.75)),
    "PERIODIC": ("*AMPLITUDE, NAME=A, DEFINITION=PERIODIC\n2, 3., .2, .5\n1., 2., -1., .25\n",
                 lambda t: 0.5 if t < 0.2 else 0.5 + math.cos(3 * (t - 0.2)) + 2 * math.sin(3 * (t - 0.2))
                 - math.cos(6 * (t - 0.2)) + 0.25 * math.sin(6 * (t - 0.2))),
    "MODULATED": ("*AMPLITUDE, NAME=A, DEFINITION=MODULATED\n1., 2., .1, 4., 7.\n",
                  lambda t: 1 + 2 * math.sin(4 * max(0, t - 0.1)) * math.sin(7 * max(0, t - 0.1))),
    "DECAY": ("*AMPLITUDE, NAME=A, DEFINITION=DECAY\n.1, 2., .3, .5\n",
              lambda t: 0.1 if t < 0.3 else 0.1 + 2 * math.exp(-(t - 0.3) / 0.5)),
    "SHIFTED": ("*AMPLITUDE, NAME=A, SHIFTX=.1, SHIFTY=2.\n0., 0., .9, 9.\n", lambda t: 2 + 10 * (t - 0.1) if t > 0.1 else 2),
}


@pytest.mark.parametrize("name", AMPLITUDES)
@pytest.mark.parametrize("value", ["RELATIVE", "ABSOLUTE"])
def test_amplitudes(run_deck: Run, tmp_path: Path, name: str, value: str) -> None:
    """The displacement of a face follows the formula at four times; absolute values are not multiplied by that of the load."""
    card, curve = AMPLITUDES[name]
    card = card.replace("NAME=A", f"NAME=A, VALUE={value}")
    step = "*STEP\n*STATIC, DIRECT\n.25, 1.\n*BOUNDARY, AMPLITUDE=A\nHigh, 3, 3, 1.e-3\n*NODE PRINT, NSET=High\nU\n*END STEP\n"
    done = run_deck(CUBE + HELD + card + step)
    assert done.returncode == 0, done.stdout
    text = (tmp_path / "job.dat").read_text()
    found = re.findall(r"time +(\S+)\s+5 +\S+ +\S+ +(\S+)", text)
    assert len(found) == 4
    factor = 1e-3 if value == "RELATIVE" else 1.0
    for time, u in found:
        assert float(u) == pytest.approx(factor * curve(float(time)), rel=DIGITS, abs=1e-9)


@pytest.mark.parametrize(("card", "message"), [
    ("DEFINITION=EQUALLY SPACED\n1., 2.", "needs a positive FIXED INTERVAL"),
    ("FIXED INTERVAL=.5\n0., 1.", "belong to DEFINITION=EQUALLY SPACED"),
    ("DEFINITION=PERIODIC\n2, 3., .2, .5\n1., 2.", "PERIODIC needs the number n"),
    ("DEFINITION=PERIODIC\n2, 3.", "at least 4 numbers"),
    ("DEFINITION=DECAY\n1., 2., 3., -1.", "a positive td"),
    ("DEFINITION=USER\n1.", "at most 0 are allowed here"),
    ("DEFINITION=DECAY, SHIFTX=1.\n1., 2., 3., 1.", "shift tables"),
    ("\n0., 1., 0., 2.", "must ascend"),
    ("\n0., 1., 2.", "odd number"),
])
def test_refused_amplitudes(run_deck: Run, card: str, message: str) -> None:
    """Invalid AMPLITUDE cards."""
    assert message in refused(run_deck, f"{CUBE}{HELD}*AMPLITUDE, NAME=A, {card}\n{STEP}")


def test_surface_without_faces(run_deck: Run, tmp_path: Path) -> None:
    """The free faces of two cubes on each other: a pressure all around squeezes them, p = -E eps of each direction at nu 0."""
    upper = "*NODE\n9, 0, 0, 2\n10, 1, 0, 2\n11, 1, 1, 2\n12, 0, 1, 2\n*ELEMENT, TYPE=C3D8, ELSET=All\n2, 5, 6, 7, 8, 9, 10, 11, 12\n"
    deck = CUBE + upper + "*SURFACE, NAME=Skin\nAll,\n*BOUNDARY\n1, 1, 3\n2, 2, 3\n4, 3, 3\n3, 3, 3\n4, 1, 1\n"
    deck += "*NSET, NSET=Shown\n7, 11\n*STEP\n*STATIC\n*DSLOAD\nSkin, P, 10.\n*NODE PRINT, NSET=Shown\nU\n*END STEP\n"
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    assert rows_of(tmp_path)[11] == pytest.approx([-0.01, -0.01, -0.02], rel=DIGITS)
    assert rows_of(tmp_path)[7] == pytest.approx([-0.01, -0.01, -0.01], rel=DIGITS)


FACETS = {"CPS4": "100, 5, 6, 7, 8\n", "S4R": "100, 8, 7, 6, 5\n", "CPS3": "100, 5, 6, 7\n101, 5, 7, 8\n"}


@pytest.mark.parametrize("kind", ["CPS4", "S4R"])
@pytest.mark.parametrize("row", ["Lid,", "100,"])
def test_surface_of_faces_of_a_mesh_generator(run_deck: Run, tmp_path: Path, kind: str, row: str) -> None:
    """A plane element beside the solid stands for the face that it lies on, whatever its sense."""
    deck = f"{CUBE}*ELEMENT, TYPE={kind}, ELSET=Lid\n{FACETS[kind]}*SURFACE, NAME=Up\n{row}\n{HELD}"
    deck += "*STEP\n*STATIC\n*DSLOAD\nUp, P, 10.\n*NODE PRINT, NSET=High\nU\n*END STEP\n"
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    assert all(u[2] == pytest.approx(-0.01, rel=DIGITS) for u in rows_of(tmp_path).values())


def test_faces_that_fit_no_solid(run_deck: Run) -> None:
    """Triangles on the quadrilateral face of a cube."""
    deck = f"{CUBE}*ELEMENT, TYPE=CPS3, ELSET=Lid\n{FACETS['CPS3']}*SURFACE, NAME=Up\nLid,\n{HELD}{STEP}"
    assert "lie on no face" in refused(run_deck, deck)


def test_surface_with_a_wrong_face(run_deck: Run) -> None:
    """An invalid label."""
    assert "nothing for all free faces" in refused(run_deck, f"{CUBE}*SURFACE, NAME=Up\nAll, top\n{HELD}{STEP}")


def test_instance_without_an_assembly(run_deck: Run) -> None:
    """INSTANCE on a set of a flat deck names nothing."""
    assert "INSTANCE belongs to the sets of an assembly" in refused(run_deck, f"{CUBE}*NSET, NSET=A, INSTANCE=I\n1\n{HELD}{STEP}")


def test_supports_inside_parts(run_deck: Run, tmp_path: Path) -> None:
    """Supports, initial temperatures and a contact pair written in the part and the assembly; the load on the whole model.

    Two cubes of E = 1000, nu = 0, weight 2 each, one on the other: the lower is pressed together by (1/2 + 1) 2 / 1000, and the upper
    by (1/2) 2 / 1000 more. Expansion has no effect at the temperature of the start.
    """
    sides = "*BOUNDARY\nEvery, 1, 2\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\nEvery, 20.\n"
    deck = f"""{BRICK.replace("*END PART", sides + "*END PART")}*ASSEMBLY, NAME=Assembly
*INSTANCE, NAME=A, PART=Brick
*END INSTANCE
*INSTANCE, NAME=B, PART=Brick
0., 0., 1.
*END INSTANCE
*NSET, NSET=Foot, INSTANCE=A
Low,
*CONTACT PAIR, INTERACTION=Smooth
B.Bottom, A.Top
*BOUNDARY
Foot, 3
*END ASSEMBLY
{STEEL}*DENSITY
.2
*EXPANSION, ZERO=20.
1e-3
*SURFACE INTERACTION, NAME=Smooth
*STEP
*STATIC
*DLOAD
, GRAV, 10., 0., 0., -1.
*NODE PRINT, NSET=A.High
U
*NODE PRINT, NSET=B.High
U
*END STEP
"""
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    assert all(row[2] == pytest.approx(-0.003, rel=DIGITS) for row in rows_of(tmp_path, name="A.High").values())
    assert all(row[2] == pytest.approx(-0.004, rel=DIGITS) for row in rows_of(tmp_path, name="B.High").values())


CAE = """*Heading
** Job name: Job-1 Model name: Model-1
*Preprint, echo=NO, model=NO, history=NO, contact=NO
**
** PARTS
**
*Part, name=Block
*Node
      1,           0.,           0.,           0.
      2,           1.,           0.,           0.
      3,           1.,           1.,           0.
      4,           0.,           1.,           0.
      5,           0.,           0.,           1.
      6,           1.,           0.,           1.
      7,           1.,           1.,           1.
      8,           0.,           1.,           1.
*Element, type=C3D8R
1, 1, 2, 3, 4, 5, 6, 7, 8
*Nset, nset=Set-1, generate
 1,  8,  1
*Elset, elset=Set-1
 1,
** Section: Section-1
*Solid Section, elset=Set-1, controls=EC-1, material=Steel
,
*End Part
**
**
** ASSEMBLY
**
*Assembly, name=Assembly
**
*Instance, name=Block-1, part=Block
*End Instance
**
*Instance, name=Block-2, part=Block
          0.,           0.,           1.
*End Instance
**
*Node
      1,          0.5,          0.5,           3.
*Nset, nset=_PickedSet20, internal, instance=Block-1
 1, 2, 3, 4
*Elset, elset=_PickedSet20, internal, instance=Block-1
 1,
*Nset, nset="Set A", instance=Block-2
 5, 6, 7, 8
*Nset, nset=RP
 1,
*Elset, elset=_Surf-1_S2, internal, instance=Block-1
 1,
*Surface, type=ELEMENT, name=Surf-1
_Surf-1_S2, S2
*Elset, elset=_Surf-2_S1, internal, instance=Block-2
 1,
*Surface, type=ELEMENT, name=Surf-2
_Surf-2_S1, S1
*Elset, elset=_Top_S2, internal, instance=Block-2
 1,
*Surface, type=ELEMENT, name=Top
_Top_S2, S2
** Constraint: Constraint-1
*Coupling, constraint name=Constraint-1, ref node=RP, surface=Top
*Kinematic
*End Assembly
**
** ELEMENT CONTROLS
**
*Section Controls, name=EC-1, hourglass=ENHANCED
1., 1., 1.
*Amplitude, name=Amp-1
             0.,              0.,              1.,              1.
**
** MATERIALS
**
*Material, name=Steel
*Density
 7.85e-09,
*Elastic
210000., 0.
*Plastic
250.,0.
300.,0.1
**
** INTERACTION PROPERTIES
**
*Surface Interaction, name=IntProp-1
1.,
*Friction, slip tolerance=0.005
 0.2,
*Surface Behavior, pressure-overclosure=HARD
**
** BOUNDARY CONDITIONS
**
** Name: BC-1 Type: Symmetry/Antisymmetry/Encastre
*Boundary
_PickedSet20, ENCASTRE
**
** INTERACTIONS
**
** Interaction: Int-1
*Contact Pair, interaction=IntProp-1, small sliding, type=SURFACE TO SURFACE, adjust=0.0
Surf-2, Surf-1
** ----------------------------------------------------------------
**
** STEP: Step-1
**
*Step, name=Step-1, nlgeom=NO, inc=1000, unsymm=YES
*Static, stabilize=0.0002, allsdtol=0.05, continue=NO
0.1, 1., 1e-05, 1.
**
** BOUNDARY CONDITIONS
**
** Name: BC-2 Type: Displacement/Rotation
*Boundary, amplitude=Amp-1
RP, 1, 1
RP, 2, 2
RP, 3, 3, -0.001
RP, 4, 4
RP, 5, 5
RP, 6, 6
**
** LOADS
**
** Name: Load-1   Type: Gravity
*Dload
, GRAV, 9.81, 0., 0., -1.
** Name: Load-2   Type: Pressure
*Dsload
Top, P, 5.
**
** CONTROLS
**
*Controls, reset
*Controls, parameters=time incrementation
, , , , , , , 10, , ,
**
** OUTPUT REQUESTS
**
*Restart, write, frequency=0
**
** FIELD OUTPUT: F-Output-1
**
*Output, field, variable=PRESELECT
**
** FIELD OUTPUT: F-Output-2
**
*Output, field, time interval=0.1
*Node Output
CF, RF, U
*Element Output, directions=YES
LE, PE, PEEQ, PEMAG, S
*Contact Output
CDISP, CSTRESS
**
** HISTORY OUTPUT: H-Output-1
**
*Output, history, variable=PRESELECT
*Output, history
*Node Output, nset="Set A"
RF3, U3
*Energy Output
ALLIE, ALLSE
*Node Print, nset=RP, summary=NO
RF
*End Step
"""


def test_deck_of_abaqus_cae(run_deck: Run, tmp_path: Path) -> None:
    """The words and the order of Abaqus/CAE: two blocks in contact, pressed by a reference point.

    The sides are free and nu is 0: a bar of length 2 shortened by 0.001. The reference point takes 105 N less the 5 N of the pressure,
    and what braking takes: stabilize=0.0002 dissipates at most that part of the energy, so that the force is wrong by at most as much.
    """
    done = run_deck(CAE)
    assert done.returncode == 0, done.stdout
    (row,) = rows_of(tmp_path, "forces", "RP").values()
    assert row[2] == pytest.approx(-210000.0 * 0.001 / 2.0 + 5.0, abs=0.0002 * 105.0)
    assert run_deck(CAE.replace("stabilize=0.0002, ", "")).returncode == 0
    (row,) = rows_of(tmp_path, "forces", "RP").values()
    assert row[2] == pytest.approx(-210000.0 * 0.001 / 2.0 + 5.0, rel=1e-5)


def test_springs_of_abaqus_cae(run_deck: Run, tmp_path: Path) -> None:
    """Springs that Abaqus/CAE writes into the assembly, between nodes INSTANCE.NUMBER, beside a reference point: u = F / k more."""
    deck = f"""{BRICK}*ASSEMBLY, NAME=Assembly
*INSTANCE, NAME=Brick-1, PART=Brick
*END INSTANCE
*INSTANCE, NAME=Brick-2, PART=Brick
0., 0., 3.
*END INSTANCE
*NODE
1, .5, .5, 9.
*NSET, NSET=RP
1,
*NSET, NSET=Lid, INSTANCE=Brick-2
5, 6, 7, 8
*SPRING, ELSET="Springs/Dashpots-1-spring"
3, 3
100.
*ELEMENT, TYPE=SPRING2, ELSET="Springs/Dashpots-1-spring"
1, Brick-1.5, Brick-2.1
2, Brick-1.6, Brick-2.2
3, Brick-1.7, Brick-2.3
4, Brick-1.8, Brick-2.4
*END ASSEMBLY
{STEEL}*BOUNDARY
Brick-1.Low, 1, 3
Brick-2.Every, 1, 2
*STEP
*STATIC
*CLOAD
Lid, 3, 2.
*NODE PRINT, NSET=Lid
U
*END STEP
"""
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    rows = rows_of(tmp_path, name="Lid")
    assert len(rows) == 4
    assert all(row[2] == pytest.approx(8.0 / 1000.0 + 2.0 / 100.0 + 8.0 / 1000.0, rel=DIGITS) for row in rows.values())
