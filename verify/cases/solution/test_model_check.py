"""Unsupported models (rigid body motion): the model check names the cause and the remedy, exit code 4, before any file is written."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from verify.conftest import Run
from verify.study.runs import run_limited

SETUP = 4
Point = tuple[float, float, float]


@dataclass
class Deck:
    """Cubes stacked or side by side, one card list before the steps and one list of cards for each step."""

    nodes: list[Point] = field(default_factory=list)
    elements: list[list[int]] = field(default_factory=list)
    cards: list[str] = field(default_factory=list)
    steps: list[list[str]] = field(default_factory=list)
    material: str = "*ELASTIC\n210000, 0.3"
    nlgeom: str = ""

    def cube(self, corner: Point, size: float = 1.0) -> int:
        """Adds a cube with sets CUBEn (element), FLOORn and LIDn (nodes at its bottom and top); returns n."""
        first = len(self.nodes) + 1
        x, y, z = corner
        for height in (z, z + size):
            for dx, dy in ((0, 0), (size, 0), (size, size), (0, size)):
                self.nodes.append((x + dx, y + dy, height))
        self.elements.append(list(range(first, first + 8)))
        n = len(self.elements)
        self.cards += [
            f"*ELSET, ELSET=CUBE{n}\n{n}",
            f"*NSET, NSET=FLOOR{n}\n{first}, {first + 1}, {first + 2}, {first + 3}",
            f"*NSET, NSET=LID{n}\n{first + 4}, {first + 5}, {first + 6}, {first + 7}",
            f"*SURFACE, NAME=SOLE{n}\nCUBE{n}, S1",
            f"*SURFACE, NAME=TOP{n}\nCUBE{n}, S2",
        ]
        return n

    def pair(self, slave: str, master: str, friction: float = 0.0) -> None:
        """Adds a contact pair with its own interaction."""
        name = f"RUBBING{len(self.cards)}"
        self.cards.append(f"*SURFACE INTERACTION, NAME={name}\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD")
        if friction:
            self.cards.append(f"*FRICTION\n{friction}")
        self.cards.append(f"*CONTACT PAIR, INTERACTION={name}, TYPE=NODE TO SURFACE\n{slave}, {master}")

    def text(self) -> str:
        """The deck. Element 1 to n are the cubes."""
        nodes = "\n".join(f"{i}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(self.nodes, 1))
        elements = "\n".join(f"{i}, " + ", ".join(map(str, e)) for i, e in enumerate(self.elements, 1))
        head = ["*NODE", nodes, "*ELEMENT, TYPE=C3D8, ELSET=ALL", elements, "*MATERIAL, NAME=STEEL", self.material]
        head += ["*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL"]
        steps = [f"*STEP{self.nlgeom}\n*STATIC\n" + "\n".join(step) + "\n*END STEP" for step in self.steps]
        return "\n".join(head + self.cards + steps) + "\n"


def fixed(*sets: str) -> str:
    """Supports in all directions."""
    return "*BOUNDARY\n" + "\n".join(f"{name}, 1, 3" for name in sets)


def refuse(run_deck: Run, tmp_path: Path, deck: Deck | str, *sentences: str) -> list[str]:
    """The deck ends with exit code 4 and prints the sentences as errors, and no file is written; returns the errors."""
    done = run_deck(deck if isinstance(deck, str) else deck.text())
    assert done.returncode == SETUP, done.stdout + done.stderr
    lines = done.stdout.splitlines()
    assert re.match(r"\*ERROR: The model check found \d+ errors?\.", lines[-1]), done.stdout
    errors = [line for line in lines[:-1] if line.startswith("*ERROR")]
    assert f"found {len(errors)} error" in lines[-1]
    for sentence in sentences:
        assert any(sentence in line for line in errors), f"'{sentence}' is not printed:\n{done.stdout}"
    assert [path.name for path in tmp_path.iterdir()] == ["job.inp"]
    return errors


def accept(run_deck: Run, deck: Deck | str, *options: str) -> str:
    """--check accepts the deck; returns the output."""
    done = run_deck(deck if isinstance(deck, str) else deck.text(), "--check", *options)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "*ERROR" not in done.stdout
    return done.stdout


def stack(friction: float, gap: float = 0.0) -> Deck:
    """A small cube on (or above) a large one whose bottom is fixed."""
    deck = Deck()
    deck.cube((0.0, 0.0, 0.0))
    deck.cube((0.1, 0.1, 1.0 + gap), 0.8)
    deck.pair("SOLE2", "TOP1", friction)
    return deck


def test_free_body(run_deck: Run, tmp_path: Path) -> None:
    """The cube is not supported; the message names its set."""
    deck = Deck(steps=[["*CLOAD\n1, 1, 100."]])
    deck.cube((0.0, 0.0, 0.0))
    refuse(run_deck, tmp_path, deck, "In step 1 the body of element 1 (set ALL, 1 element) can move and turn freely")


@pytest.mark.parametrize(
    ("supports", "motion"),
    [
        ("FLOOR1, 3, 3", "can move along x, move along y and turn about z through its centre"),
        ("FLOOR1, 1, 1\nFLOOR1, 3, 3", "can move along y:"),
        ("1, 1, 3\n5, 1, 2", "can turn about z through the point (0, 0, 0.5):"),
        ("1, 1, 3\n2, 2, 3", "can turn about x through the point (0.5, 0, 0):"),
    ],
)
def test_partly_held(run_deck: Run, tmp_path: Path, supports: str, motion: str) -> None:
    """The message describes the remaining rigid body motions in words."""
    deck = Deck(steps=[["*BOUNDARY\n" + supports]])
    deck.cube((0.0, 0.0, 0.0))
    errors = refuse(run_deck, tmp_path, deck, motion)
    assert len(errors) == 1


def inclined_bar(digits: int, shift: float, held: str, stretch: float = 1.0) -> str:
    """A bar of two cubes along (1, 2, 2)/3, coordinates written with some digits; sets EDGE (three nodes on a line along it) and END (four)."""
    along, across, up = (1 / 3, 2 / 3, 2 / 3), (2 / 3, 1 / 3, -2 / 3), (-2 / 3, 2 / 3, -1 / 3)
    places = [(i * stretch, j, k) for i in range(3) for k in range(2) for j in range(2)]
    nodes = [tuple(shift + a * along[m] + b * across[m] + c * up[m] for m in range(3)) for a, b, c in places]
    rows = "".join(f"{n}, " + ", ".join(f"{v:.{digits}g}" for v in x) + "\n" for n, x in enumerate(nodes, 1))
    return (
        f"*NODE\n{rows}*ELEMENT, TYPE=C3D8, ELSET=BAR\n1, 1, 5, 6, 2, 3, 7, 8, 4\n2, 5, 9, 10, 6, 7, 11, 12, 8\n"
        "*NSET, NSET=EDGE\n1, 5, 9\n*NSET, NSET=END\n1, 2, 3, 4\n*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n"
        f"*SOLID SECTION, ELSET=BAR, MATERIAL=M\n*STEP\n*STATIC\n*BOUNDARY\n{held}\n*CLOAD\n12, 1, 1.\n*END STEP\n"
    )


@pytest.mark.parametrize(("digits", "shift"), [(17, 0.0), (8, 0.0), (7, 0.0), (6, 0.0), (5, 0.0), (17, 1000.0), (8, 1000.0)])
def test_held_on_a_line(run_deck: Run, tmp_path: Path, digits: int, shift: float) -> None:
    """Three supports on a line leave the rotation about it, also where the rounding of their coordinates takes them off it."""
    deck = inclined_bar(digits, shift, "EDGE, 1, 3")
    (error,) = refuse(run_deck, tmp_path, deck, "the body of element 1 (set BAR, 2 elements) can turn about (0.33")
    assert error.count("turn") == 1 and "move" not in error


@pytest.mark.parametrize(("digits", "shift", "held", "stretch"), [
    (5, 0.0, "EDGE, 1, 3\n2, 3", 1.0), (7, 1000.0, "EDGE, 1, 3\n2, 3", 1.0), (4, 0.0, "END, 1, 3", 1.0),
    (5, 0.0, "END, 1, 3", 100.0), (7, 0.0, "END, 1, 3", 1000.0),
])  # fmt: skip
def test_held_well(run_deck: Run, digits: int, shift: float, held: str, stretch: float) -> None:
    """One support more off the line holds the bar; a slender one is held at its end."""
    done = run_deck(inclined_bar(digits, shift, held, stretch))
    assert done.returncode == 0, done.stdout


def test_released_in_a_later_step(run_deck: Run, tmp_path: Path) -> None:
    """OP=NEW in step 2 takes the supports of step 1 away: found before step 1 begins."""
    deck = Deck(steps=[[fixed("FLOOR1")], ["*BOUNDARY, OP=NEW\nFLOOR1, 3, 3"]])
    deck.cube((0.0, 0.0, 0.0))
    refuse(run_deck, tmp_path, deck, "In step 2 the body of element 1")


def test_held_where_it_has_turned_to(run_deck: Run, tmp_path: Path) -> None:
    """A body that could turn where the deck places it is held where a step under NLGEOM has brought it: a warning, and the job
    runs. Without NLGEOM it is an error, and so is always what can move along.
    """
    hinge, turn = "*BOUNDARY{0}\n1, 1, 3\n2, 2, 3\n5, 3, 3{1}\n6, 3, 3{1}", "\n5, 2, 2, 0.3\n6, 2, 2, 0.3"
    later = hinge.format(", OP=NEW", ", -0.046")
    deck = Deck(steps=[[hinge.format("", "") + turn], [later]], nlgeom=", NLGEOM")
    deck.cube((0.0, 0.0, 0.0))
    assert "In step 2 the body of element 1 (set ALL, 1 element) can turn about x" in accept(run_deck, deck)
    assert run_deck(deck.text()).returncode == 0
    for path in tmp_path.iterdir():
        path.unlink()
    deck.nlgeom = ""
    refuse(run_deck, tmp_path, deck, "In step 2 the body of element 1 (set ALL, 1 element) can turn about x")
    deck.nlgeom, deck.steps[1] = ", NLGEOM", ["*BOUNDARY, OP=NEW\nFLOOR1, 2, 3"]
    refuse(run_deck, tmp_path, deck, "In step 2 the body of element 1 (set ALL, 1 element) can move along x")


def test_sliding_without_friction(run_deck: Run, tmp_path: Path) -> None:
    """On a smooth table a body is free to slide; with friction it is not."""
    deck = stack(friction=0.0)
    deck.steps = [[fixed("FLOOR1"), "*CLOAD\nLID2, 3, -10."]]
    refuse(run_deck, tmp_path, deck, "of element 2 (set CUBE2, 1 element) can move along x, move along y and turn about z")
    deck = stack(friction=0.3)
    deck.steps = [[fixed("FLOOR1"), "*CLOAD\nLID2, 3, -10."]]
    assert "WARNING" not in accept(run_deck, deck)


def test_two_bodies_slide_together(run_deck: Run, tmp_path: Path) -> None:
    """Two bodies joined by friction, unsupported together."""
    deck = stack(friction=0.3)
    deck.steps = [["*BOUNDARY\nFLOOR1, 3, 3"]]
    refuse(run_deck, tmp_path, deck, "of element 1 (set CUBE1, 1 element) and with it the body of element 2 (set CUBE2, 1 ele")


def test_open_at_the_start(run_deck: Run) -> None:
    """A body that only a force pushes over a gap is reported, but may run."""
    deck = stack(friction=0.3, gap=0.05)
    deck.steps = [[fixed("FLOOR1"), "*CLOAD\nLID2, 3, -10."]]
    assert "until its contact closes" in accept(run_deck, deck)
    deck.steps = [[fixed("FLOOR1"), "*BOUNDARY\nLID2, 1, 2\nLID2, 3, 3, -0.06"]]
    assert "WARNING" not in accept(run_deck, deck)


def test_no_projection(run_deck: Run, tmp_path: Path) -> None:
    """The slave surface is nowhere near its master, or on the other side of the body."""
    deck = stack(friction=0.3, gap=20.0)
    deck.steps = [[fixed("FLOOR1", "LID2")]]
    refuse(run_deck, tmp_path, deck, "None of the 4 slave nodes of the contact pair SOLE2 / TOP1 projects on the master")


def test_large_gaps_and_overclosures_are_reported_under_calculix(run_deck: Run) -> None:
    """CalculiX runs pairs that are far apart or far inside each other, and so does its dialect."""
    deck = stack(friction=0.3, gap=20.0)
    deck.steps = [[fixed("FLOOR1", "LID2")]]
    message = accept(run_deck, deck, "--dialect=calculix")
    assert "WARNING: None of the 4 slave nodes of the contact pair SOLE2 / TOP1 projects on the master" in message
    message = accept(run_deck, deck.text().replace("NODE TO SURFACE", "SURFACE TO SURFACE"), "--dialect=calculix")
    assert "WARNING: No slave face of the contact pair SOLE2 / TOP1 faces the master at the start" in message
    deck = stack(friction=0.3, gap=-0.7)
    deck.steps = [[fixed("FLOOR1", "LID2")]]
    assert "lies 0.7 inside the master at the start" in accept(run_deck, deck, "--dialect=calculix")


def test_driven_over_a_wide_gap(run_deck: Run) -> None:
    """The same gap is good if a displacement under NLGEOM closes it."""
    deck = stack(friction=0.3, gap=5.0)
    deck.nlgeom = ", NLGEOM"
    deck.steps = [[fixed("FLOOR1"), "*BOUNDARY\nLID2, 1, 2\nLID2, 3, 3, -5.01"]]
    assert "may bring the surfaces together later" in accept(run_deck, deck)


@pytest.mark.parametrize("height", [-0.25, 0.25])
def test_far_side(run_deck: Run, tmp_path: Path, height: float) -> None:
    """The same well below and above the plate: no slave node is near its master, and all of them face the same direction as it."""
    deck = Deck(steps=[[fixed("FLOOR1", "LID2")]])
    deck.cube((0.0, 0.0, 0.9), 0.1)
    deck.cube((0.01, 0.01, 0.9 + height), 0.08)
    deck.pair("SOLE2", "SOLE1")
    refuse(run_deck, tmp_path, deck, "The surfaces of the contact pair SOLE2 / SOLE1 face the same way at all 4 slave nodes that project on the master")


def test_flipped_normals(run_deck: Run, tmp_path: Path) -> None:
    """The master is the bottom of a thin plate, the slave the bottom of the cube on it."""
    deck = Deck(steps=[[fixed("FLOOR1", "LID2")]])
    deck.cube((0.0, 0.0, 0.9), 0.1)
    deck.cube((0.01, 0.01, 0.9), 0.08)
    deck.pair("SOLE2", "SOLE1")
    refuse(run_deck, tmp_path, deck, "The surfaces of the contact pair SOLE2 / SOLE1 face the same way at 4 of 4 slave nodes")
    assert re.search(r"^ +4 +4 +0 +4 +\d+ +- +- +0  SOLE2 / SOLE1$", run_deck(deck.text(), "--check").stdout, re.MULTILINE)


def test_penetration(run_deck: Run, tmp_path: Path) -> None:
    """Much is an error, little a warning with the deepest node."""
    deck = stack(friction=0.3, gap=-0.7)
    deck.steps = [[fixed("FLOOR1", "LID2")]]
    refuse(run_deck, tmp_path, deck, "lies 0.7 inside the master at the start, where an edge is 1 long: the surfaces are")
    deck = stack(friction=0.3, gap=-0.01)
    deck.steps = [[fixed("FLOOR1", "LID2")]]
    said = accept(run_deck, deck)
    assert re.search(r"\*WARNING: In the contact pair SOLE2 / TOP1 slave node (9|10|11|12) lies 0\.01 inside", said)


def test_pairs_that_share_nodes(run_deck: Run) -> None:
    """A surface that is slave in one pair and master in another, and a symmetric pair: one side drops its constraint."""
    deck = Deck(steps=[[fixed("FLOOR1", "LID3")]])
    for n in range(3):
        deck.cube((0.1 * n, 0.1 * n, float(n)), 1.0)
    deck.pair("SOLE2", "TOP1", 0.3)
    deck.pair("TOP2", "SOLE3", 0.3)
    deck.pair("TOP1", "SOLE2", 0.3)
    accept(run_deck, deck)


def test_common_nodes(run_deck: Run, tmp_path: Path) -> None:
    """Two elements that share a face cannot touch each other there."""
    deck = Deck(steps=[[fixed("FLOOR1")]])
    deck.cube((0.0, 0.0, 0.0))
    deck.cube((0.0, 0.0, 1.0))
    deck.elements[1][:4] = deck.elements[0][4:]
    deck.pair("SOLE2", "TOP1")
    refuse(run_deck, tmp_path, deck, "4 nodes (5, 6, 7 and 8) belong to both surfaces of the contact pair SOLE2 / TOP1")


def test_slave_held_along_the_normal(run_deck: Run) -> None:
    """The contact cannot push a slave node that a support holds: a warning."""
    deck = stack(friction=0.3)
    deck.steps = [[fixed("FLOOR1", "CORNERS"), "*CLOAD\nLID2, 3, -1."]]
    deck.cards.append("*NSET, NSET=CORNERS\n9, 10")
    said = accept(run_deck, deck)
    assert "at 2 slave nodes of the contact pair SOLE2 / TOP1 (9 and 10): the contact cannot push there" in said
    assert re.search(r"slaves projected +closed +flipped +held", said)
    assert re.search(r"^ +4 +4 +4 +0 +2 +0 +0 +0\.3  SOLE2 / TOP1$", said, re.MULTILINE), said
    assert re.search(r"volume 1; held by 12 supports, contact SOLE2 / TOP1 \(4 closed, 0 open\)$", said, re.MULTILINE), said
    assert re.search(r"volume 0\.512; held by 6 supports, contact SOLE2 / TOP1 \(4 closed, 0 open\)$", said, re.MULTILINE), said


def test_inverted_element(run_deck: Run, tmp_path: Path) -> None:
    """Bottom and top of an element exchanged."""
    deck = Deck(steps=[[fixed("FLOOR1")]])
    deck.cube((0.0, 0.0, 0.0))
    deck.elements[0] = deck.elements[0][4:] + deck.elements[0][:4]
    refuse(run_deck, tmp_path, deck, "The volume of element 1 is zero or negative at an integration point.")


def test_conflicting_constraints(run_deck: Run, tmp_path: Path) -> None:
    """An equation between two displacements that are prescribed differently, in the second step only."""
    deck = Deck(steps=[[fixed("FLOOR1")], ["*BOUNDARY\n5, 3, 3, 0.1\n6, 3, 3, 0.2"]])
    deck.cube((0.0, 0.0, 0.0))
    deck.cards.append("*EQUATION\n2\n5, 3, 1., 6, 3, -1.")
    line = deck.text().splitlines().index("*EQUATION") + 1
    errors = refuse(run_deck, tmp_path, deck, "In step 2 the *EQUATION of line")
    assert re.search(rf"of line ({line}|{line + 1}|{line + 2}) contradicts", errors[0])


def test_weight_without_density(run_deck: Run, tmp_path: Path) -> None:
    """GRAV needs *DENSITY: the reader or the model check reports it."""
    deck = Deck(steps=[[fixed("FLOOR1"), "*DLOAD\nALL, GRAV, 9810., 0., 0., -1."]])
    deck.cube((0.0, 0.0, 0.0))
    done = run_deck(deck.text())
    assert done.returncode in (3, SETUP)
    assert "DENSITY" in done.stdout
    assert [path.name for path in tmp_path.iterdir()] == ["job.inp"]
    deck.material += "\n*DENSITY\n7.85e-9"
    assert "WARNING" not in accept(run_deck, deck)


def test_all_at_once(run_deck: Run, tmp_path: Path) -> None:
    """Several mistakes are reported together."""
    deck = stack(friction=0.0)
    deck.steps = [["*BOUNDARY\nFLOOR1, 3, 3"]]
    deck.cube((5.0, 0.0, 0.0))
    deck.elements[2] = deck.elements[2][4:] + deck.elements[2][:4]
    errors = refuse(
        run_deck,
        tmp_path,
        deck,
        "The volume of element 3",
        "of element 3 (set CUBE3, 1 element) can move and turn freely",
        "of element 2 (set CUBE2, 1 element)",
        "of element 1 (set CUBE1, 1 element)",
    )
    assert len(errors) >= 4


THREE_CUBES = (Path(__file__).resolve().parents[3] / "input" / "three_cubes.inp").read_text()
THREE_CUBES = THREE_CUBES.replace("*INCLUDE, INPUT=three_cubes.mesh\n", (Path(__file__).resolve().parents[3] / "input" / "three_cubes.mesh").read_text())
SLIPS = [
    ("*BOUNDARY", "*BOUNDRY", 3, "*BOUNDRY is not known; did you mean *BOUNDARY?"),
    ("*SOLID SECTION", "*SOLID SECION", 3, "*SOLID SECION is not known; did you mean *SOLID SECTION?"),
    ("MATERIAL=STEEL", "MATERAIL=STEEL", 3, "has no parameter MATERAIL (did you mean MATERIAL?)"),
    ("MATERIAL=STEEL", "MATERIAL=STELL", 3, "There is no material 'STELL'; did you mean STEEL?"),
    ("MATERIAL=STEEL", "MATERIAL=GOLD", 3, "There is no material 'GOLD'; there is only STEEL."),
    ("FLOOR, 1, 3", "FLOR, 1, 3", 3, "There is no node or node set 'FLOR'; did you mean FLOOR?"),
    ("CUBE_SOLE, TABLE_TOP", "CUBESOLE, TABLE_TPO", 3, "There is no surface 'TABLE_TPO'; did you mean TABLE_TOP?"),
    ("INTERACTION=RUBBING\nCUBE", "INTERACTION=RUBING\nCUBE", 3, "There is no surface interaction 'RUBING'; did you mean RUBBING?"),
    ("*BOUNDARY\nFLOOR", "*DSLOAD\nTABLE, P, 1.\n*BOUNDARY\nFLOOR", 3, "'TABLE' is a set of elements, no surface."),
    ("FLOOR, 1, 3\n", "", 0, "Nothing but contact holds the body of element 1"),
    ("CUBE_SOLE, TABLE_TOP", "TABLE_TOP, CUBE_SOLE", 0, "If the master lies between nodes of the slave, swap them"),
    ("TABLE, S2", "TABLE, S2\nTABLE, S4", 4, "'TABLE_TOP' holds faces inside the body, 1 of 4"),
]


@pytest.mark.parametrize(("right", "wrong", "status", "message"), SLIPS, ids=[message[:40] for *_, message in SLIPS])
def test_slips_of_a_beginner(run_deck: Run, right: str, wrong: str, status: int, message: str) -> None:
    """A misspelt word is reported with the word that was meant; a forgotten support and faces inside a body are remarked."""
    done = run_deck(THREE_CUBES.replace(right, wrong, 1), "--check")
    assert done.returncode == status, done.stdout
    assert message in done.stdout, done.stdout


def test_nodes_that_face_away_may_be_held(run_deck: Run) -> None:
    """The bottom of a cube whose whole skin is the slave is held: no message, contact is at its top."""
    deck = THREE_CUBES.replace("CUBE, S1\n", "CUBE,\n").replace("LID, 1, 2", "LID, 1, 3")
    assert "cannot push there" not in run_deck(deck, "--check").stdout


def test_a_fit_is_no_mistake(run_deck: Run) -> None:
    """What *CONTACT INTERFERENCE, SHRINK takes as a fit is not called a penetration."""
    deck = THREE_CUBES.replace("LID, 3, 3, -0.001", "LID, 3, 3")
    deeper = re.sub(r"^(1[3-9]|20), ([^,]+), ([^,]+), (\S+)$", lambda m: f"{m[1]}, {m[2]}, {m[3]}, {float(m[4]) - 0.02}", deck, flags=re.M)
    assert "inside the master" in run_deck(deeper, "--check").stdout
    fit = deeper.replace("*BOUNDARY\nFLOOR", "*CONTACT INTERFERENCE, SHRINK\nCUBE_SOLE, TABLE_TOP\n*BOUNDARY\nFLOOR", 1)
    done = run_deck(fit, "--check")
    assert done.returncode == 0 and "inside the master" not in done.stdout, done.stdout


@pytest.mark.parametrize("name", ["three_cubes", "shear_block", "hertz_octant", "ironing"])
def test_decks_of_input_are_good(run: Run, root: Path, name: str, tmp_path: Path) -> None:
    """No deck of input/ gets an error or a warning from the model check, and --check lists bodies, pairs and steps."""
    done = run(["--check", "--outdir", tmp_path, root / "input" / f"{name}.inp"])
    assert done.returncode == 0, done.stdout
    assert not re.search(r"\*(ERROR|WARNING)", done.stdout), done.stdout
    assert all(_has_count(done.stdout, word, at_least=1) for word in ("nodes", "bodies", "contact pairs", "steps"))


def _has_count(text: str, word: str, at_least: int) -> bool:
    """Whether the summary has a line `word  number`."""
    found: Sequence[str] = re.findall(rf"^ *{word} +(\d+)", text, re.M)
    return len(found) == 1 and int(found[0]) >= at_least


def test_cost_of_many_equations(program: Path, tmp_path: Path) -> None:
    """A plate of 3600 shells has three equations for each of its nodes: their motions leave the check at a cost that grows with them."""
    n = 60
    rows = "".join(f"{i * (n + 1) + j + 1}, {i}., {j}., 0.\n" for i in range(n + 1) for j in range(n + 1))
    shells = ""
    for i in range(n):
        for j in range(n):
            first = i * (n + 1) + j + 1
            shells += f"{i * n + j + 1}, {first}, {first + n + 1}, {first + n + 2}, {first + 1}\n"
    deck = tmp_path / "plate.inp"
    deck.write_text(
        f"*NODE\n{rows}*ELEMENT, TYPE=S4, ELSET=E\n{shells}*MATERIAL, NAME=M\n*ELASTIC\n210000, 0.3\n*SHELL SECTION, ELSET=E, MATERIAL=M\n0.1\n"
        "*BOUNDARY\n1, 1, 3\n2, 1, 3\n*STEP\n*STATIC\n*CLOAD\n3721, 3, 1.\n*END STEP\n")
    done, _ = run_limited([program, "--check", "--dialect=calculix", deck], 20.0)  # 2 s are enough; by the cube of the motions it is minutes
    output = (done.stdout + done.stderr).decode()
    assert done.returncode == SETUP, output
    assert "can turn about y" in output
