"""General contact against the same decks with pairs by hand: the same slaves and masters give the same results.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.general_contact import DECKS, INPUT_DECKS, SOFT, STIFF, block_on_block, half_cylinder_on_block, turned_ring, with_general_contact, with_pairs
from verify.decks.general_contact_large import LARGE_DECKS
from verify.decks.planes import flat_deck, flatten
from verify.decks.sheets import between, fix, sheet, step

EQUAL = 1e-6  #: over the largest value: the pairs are the same, but for faces beside those in contact


def compare(run: Run, folder: Path, by_hand: str, general: str) -> str:
    """Runs both decks; displacements and stresses must be the same. The output of the second."""
    results = []
    for name, deck in (("hand", by_hand), ("general", general)):
        (folder / f"{name}.inp").write_text(deck)
        done = run(["--outdir", folder, folder / f"{name}.inp"], folder)
        assert done.returncode == 0, done.stdout + done.stderr
        with h5py.File(folder / f"{name}.vtkhdf") as file:
            results.append([np.asarray(file[f"VTKHDF/PointData/{field}"]) for field in ("U", "S")])
    for field, ours in zip(*results, strict=True):
        assert field.shape == ours.shape
        assert np.abs(field - ours).max() <= EQUAL * np.abs(field).max()
    return done.stdout


@pytest.mark.parametrize("name", INPUT_DECKS)
def test_input_decks(run: Run, root: Path, tmp_path: Path, name: str) -> None:
    """The decks of the manual with friction, finite sliding, overlaps and a pre-tension section."""
    for mesh in (root / "input").glob("*.mesh"):
        (tmp_path / mesh.name).write_text(mesh.read_text())
    deck = (root / "input" / f"{name}.inp").read_text()
    compare(run, tmp_path, with_pairs(deck), with_general_contact(deck))


@pytest.mark.parametrize("name", ["block-cpe4", "block-cpe8", "corner-cpe4", "stack-cpe4"])
def test_node_to_surface(run: Run, tmp_path: Path, name: str) -> None:
    """The same with contact at the nodes of the slave."""
    deck = DECKS[name]()
    general = with_general_contact(deck).replace("*CONTACT\n", "*CONTACT, TYPE=NODE TO SURFACE\n")
    assert "General contact: " in compare(run, tmp_path, with_pairs(deck, "NODE"), general)


@pytest.mark.parametrize("name", DECKS)
def test_plane_decks(run: Run, tmp_path: Path, name: str) -> None:
    """Blocks, corners and stacks of sheets; in the stacks no sheet sees the far side of another."""
    deck = DECKS[name]()
    assert "General contact: " in compare(run, tmp_path, with_pairs(deck), with_general_contact(deck))


@pytest.mark.parametrize("name", ["posts-c3d20r", "leaves-s4", "small-in-large-c3d10"])
def test_larger_decks(run: Run, tmp_path: Path, name: str) -> None:
    """Posts between plates, whose sides face each other; a leaf spring of shells; a small contact of a large mesh."""
    deck = LARGE_DECKS[name]()
    assert "General contact: " in compare(run, tmp_path, with_pairs(deck), with_general_contact(deck))


def test_choice_of_the_slave(run: Run, tmp_path: Path) -> None:
    """Left to itself it takes the softer body as slave, as the pair by hand does, and says so."""
    deck = block_on_block("CPE4")
    output = compare(run, tmp_path, with_pairs(deck), with_general_contact(deck, has_roles=False))
    assert re.search(r"slave UPPER#\d+ \(\d+ faces\), master LOWER \(\d+ faces\), interaction ON_LOWER_TOP: the slave is softer\.", output)


@pytest.mark.parametrize(("form", "n_block", "slave", "gap"), [
    ("SURFACE", 8, "BLOCK", 0.0),
    ("SURFACE", 16, "BLOCK", 0.0),
    ("SURFACE", 16, "BLOCK", 1.0),
    ("SURFACE", 8, "CYL", 0.0),
    ("NODE", 60, "BLOCK", 0.0),
    ("NODE", 16, "CYL", 1.0),
])  # fmt: skip
def test_long_way(run: Run, tmp_path: Path, form: str, n_block: int, slave: str, gap: float) -> None:
    """A half cylinder is dragged over a block by nine of its radii. The faces of a coarse slave lie behind those of the cylinder by more than
    one of its elements, and the sides of the block, which can meet the cylinder too, share nodes with its top."""
    deck = half_cylinder_on_block(n_block, slave, gap)
    general = with_general_contact(deck)
    if form == "NODE":
        general = general.replace("*CONTACT\n", "*CONTACT, TYPE=NODE TO SURFACE\n")
    assert "General contact: " in compare(run, tmp_path, with_pairs(deck, form), general)


@pytest.mark.parametrize("form", ["SURFACE", "NODE"])
def test_turned_faces(run: Run, tmp_path: Path, form: str) -> None:
    """A rigid ring on a block is turned by 150 degrees: the faces that come to the block were turned away from it at the start."""
    deck = turned_ring(2.6)
    general = with_general_contact(deck)
    if form == "NODE":
        general = general.replace("*CONTACT\n", "*CONTACT, TYPE=NODE TO SURFACE\n")
    compare(run, tmp_path, with_pairs(deck, form), general)


def test_turned_faces_beyond_the_reach(run: Run, tmp_path: Path) -> None:
    """With a reach that is too short for them the job ends with a sentence, and not without contact."""
    (tmp_path / "job.inp").write_text(with_general_contact(turned_ring(2.6)).replace("*CONTACT\n", "*CONTACT, REACH=0.\n"))
    done = run(["--outdir", tmp_path, tmp_path / "job.inp"], tmp_path)
    assert done.returncode == 5, done.stdout + done.stderr
    assert re.search(r"General contact: element \d+ of (BLOCK reached RING|RING reached BLOCK)", done.stdout + done.stderr)


def stretched(options: str = "") -> str:
    """A soft column that a force stretches by three quarters of its length onto a block: farther than the search looks."""
    parts = [flatten(sheet("COLUMN", between(0, 1, 2), between(0, 4, 8))), flatten(sheet("STOP", between(-1, 2, 6), between(-5, -3, 4)))]
    loads = fix("COLUMN_TOP, 2", "COLUMN_LEFT, 1", "STOP_BOTTOM, 1, 2") + "*CLOAD\nCOLUMN_BOTTOM, 2, -125.\n"
    rules = f"*CONTACT{options}\n*CONTACT INCLUSIONS, ALL EXTERIOR\n"
    return flat_deck([(parts[0], SOFT), (parts[1], STIFF)], "CPE4R", rules + step(loads, 20, is_nlgeom=True))


def test_motion(run: Run, tmp_path: Path) -> None:
    """A body that comes from too far ends the job with a sentence; with REACH it finds its contact."""
    (tmp_path / "short.inp").write_text(stretched())
    done = run(["--outdir", tmp_path, tmp_path / "short.inp"], tmp_path)
    assert done.returncode == 5, done.stdout + done.stderr
    assert re.search(r"General contact: element \d+ of (COLUMN reached STOP|STOP reached COLUMN)", done.stdout + done.stderr), done.stderr
    (tmp_path / "long.inp").write_text(stretched(", REACH=8."))
    done = run(["--outdir", tmp_path, tmp_path / "long.inp"], tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(tmp_path / "long.vtkhdf") as file:
        n = file["VTKHDF/NumberOfPoints"][0]
        u = np.asarray(file["VTKHDF/PointData/U"])[-n:]
        assert np.asarray(file["VTKHDF/PointData/CPRESS"])[-n:].max() > 0
    assert -3.05 < u[:3, 1].min() < -2.95, "the corners of the foot on the block, which gives way a little"


def shell_over_shell(cards: str) -> str:
    """Two plates of S4, 0.2 thick, their middles 0.3 apart."""
    deck = ""
    for first, height in ((1, 0.0), (11, 0.3)):
        corners = ((0, 0), (1, 0), (1, 1), (0, 1))
        deck += "*NODE\n" + "".join(f"{first + i}, {x}, {y}, {height}\n" for i, (x, y) in enumerate(corners))
        name = "LOW" if first == 1 else "UP"
        deck += f"*ELEMENT, TYPE=S4, ELSET={name}\n{first}, {first}, {first + 1}, {first + 2}, {first + 3}\n"
        deck += f"*SHELL SECTION, ELSET={name}, MATERIAL=M\n.2\n"
        deck += f"*SURFACE, NAME={name}_FACE\n{name}, {'SPOS' if first == 1 else 'SNEG'}\n"
        deck += f"*NSET, NSET={name}_NODES, GENERATE\n{first}, {first + 3}\n*BOUNDARY\n{name}_NODES, 1, 3\n"
    material = "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n"
    return material + deck + "*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n" + cards + "*STEP\n*STATIC\n*END STEP\n"


PLACES = "The place of the nodes of a shell over its thickness"
THICKNESSES = "The thickness of a shell is ORIGINAL, THINNING, or a number that is not negative"


@pytest.mark.parametrize(("row", "message"), [
    ("THICKNESS\nUP_FACE, THINNING, 1.", ""),
    ("OFFSET FRACTION\n, ORIGINAL", ""),
    ("THICKNESS\n, -0.1", THICKNESSES),
    ("THICKNESS\n, 0.1, 0.", THICKNESSES),
    ("THICKNESS\n, SPOS", THICKNESSES),
    ("OFFSET FRACTION\n, 0.6", PLACES),
    ("OFFSET FRACTION\n, THINNING", PLACES),
    ("OFFSET FRACTION\n, SPOS, 2.", PLACES),
    ("THICKNESS\n, 9.", "lifts the surfaces of"),
])  # fmt: skip
def test_properties_of_shells(run_deck: Run, row: str, message: str) -> None:
    """What *SURFACE PROPERTY ASSIGNMENT allows for shells; a thickness beyond the search of contact is an error."""
    done = run_deck(shell_over_shell(f"*SURFACE PROPERTY ASSIGNMENT, PROPERTY={row}\n"), "--check")
    text = re.sub(r"\s+", " ", done.stdout + done.stderr)
    assert (done.returncode == 0) is (message == ""), text
    assert message in text


def test_properties_of_other_elements(run_deck: Run) -> None:
    """NODAL THICKNESS varies over the faces; general contact does not find membranes."""
    assignment = "*SURFACE PROPERTY ASSIGNMENT, PROPERTY=THICKNESS\nUP_FACE, 0.3\n"
    for before, after, message in (
        ("*SHELL SECTION, ELSET=UP", "*NODAL THICKNESS\nUP_NODES, 0.2\n*SHELL SECTION, NODAL THICKNESS, ELSET=UP", "has a NODAL THICKNESS"),
        ("TYPE=S4, ELSET=UP", "TYPE=M3D4, ELSET=UP", "does not find membranes"),
    ):
        text = shell_over_shell(assignment).replace(before, after)
        if "M3D4" in after:
            text = text.replace("*SHELL SECTION, ELSET=UP", "*MEMBRANE SECTION, ELSET=UP")
        done = run_deck(text, "--check")
        assert done.returncode == 3
        assert message in re.sub(r"\s+", " ", done.stdout + done.stderr)


def force_of_plates(run_deck: Run, folder: Path, way: float, cards: str, *, is_held: bool = False) -> float:
    """The force between two plates of S4, 0.2 thick, whose nodes are 0.3 apart, when those of the upper move down."""
    n = 4
    deck = "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n"
    for name, first, height, side in (("LOW", 1, 0.0, "SPOS"), ("UP", 101, 0.3, "SNEG")):
        deck += "*NODE\n" + "".join(f"{first + i + (n + 1) * j}, {i / n}, {j / n}, {height}\n" for j in range(n + 1) for i in range(n + 1))
        corners = [(first + i + (n + 1) * j, first + i + (n + 1) * j + 1, first + i + (n + 1) * (j + 1) + 1, first + i + (n + 1) * (j + 1))
                   for j in range(n) for i in range(n)]  # fmt: skip
        deck += f"*ELEMENT, TYPE=S4, ELSET={name}\n" + "".join(f"{first + k}, {a}, {b}, {c}, {d}\n" for k, (a, b, c, d) in enumerate(corners))
        deck += f"*SHELL SECTION, ELSET={name}, MATERIAL=M\n0.2\n*SURFACE, NAME={name}_FACE\n{name}, {side}\n"
        last = 6 if is_held and name == "LOW" else 3
        deck += f"*NSET, NSET={name}_NODES, GENERATE\n{first}, {first + (n + 1) ** 2 - 1}\n*BOUNDARY\n{name}_NODES, 1, {last}\n"
    deck += f"*CONTACT\n*CONTACT INCLUSIONS\nUP_FACE, LOW_FACE\n{cards}*STEP\n*STATIC\n.1, 1.\n*BOUNDARY\nUP_NODES, 3, 3, {-way}\n"
    done = run_deck(deck + "*NODE PRINT, NSET=LOW_NODES, TOTALS=ONLY\nRF\n*END STEP\n")
    assert done.returncode == 0, done.stdout + done.stderr
    return float((folder / "job.dat").read_text().split()[-1])


@pytest.mark.parametrize("roles", ["LOW_FACE, UP_FACE, SLAVE", "UP_FACE, LOW_FACE, SLAVE", "held"])
def test_shells_on_each_other(run_deck: Run, tmp_path: Path, roles: str) -> None:
    """Two plates, whose nodes are moved until their faces overlap by d = 0.05, are squeezed: the energy E (d/t)^2 t of both gives the
    force 2 E d/t, whichever face is the slave; with the rotations of the lower plate held it is rigid, and takes part as before
    (its thickness stays free)."""
    cards = "" if roles == "held" else f"*CONTACT FORMULATION, TYPE=MASTER SLAVE ROLES\n{roles}\n"
    force = force_of_plates(run_deck, tmp_path, 0.3 - 0.2 + 0.05, cards, is_held=roles == "held")
    assert force == pytest.approx(2 * 1000 * 0.05 / 0.2, rel=1e-6)


@pytest.mark.parametrize(("rows", "height"), [
    ("THICKNESS\n, 0.26", 0.06),
    ("THICKNESS\n, 0.1", -0.1),
    ("THICKNESS\n, 0.", -0.2),
    ("THICKNESS\nUP_FACE, 0.24, 0.5\nLOW_FACE, ORIGINAL, 1.2", -0.04 + 0.02),
    ("THICKNESS\n, 0.5\n, THINNING", 0.0),
    ("OFFSET FRACTION\nUP_FACE, SPOS", 0.1),
    ("OFFSET FRACTION\nLOW_FACE, SPOS", -0.1),
    ("OFFSET FRACTION\n, -0.25", 0.0),
    ("OFFSET FRACTION\nLOW_FACE, -0.2\n*SURFACE PROPERTY ASSIGNMENT, PROPERTY=THICKNESS\nLOW_FACE, 0.1", 0.07 - 0.1),
])  # fmt: skip
@pytest.mark.parametrize("contact_type", ["SURFACE TO SURFACE", "NODE TO SURFACE"])
def test_assigned_thickness(run_deck: Run, tmp_path: Path, rows: str, height: float, contact_type: str) -> None:
    """The same with surfaces that the assignment puts before the faces: of thickness t and place a at t (1/2 - a) from the nodes on the
    side SPOS, at t (1/2 + a) on the other one."""
    cards = f"*SURFACE PROPERTY ASSIGNMENT, PROPERTY={rows}\n"
    deck_of = run_deck if contact_type == "SURFACE TO SURFACE" else lambda deck: run_deck(deck.replace("*CONTACT\n", "*CONTACT, TYPE=NODE TO SURFACE\n"))
    force = force_of_plates(deck_of, tmp_path, 0.3 - 0.2 - height + 0.05, cards)
    assert force == pytest.approx(2 * 1000 * 0.05 / 0.2, rel=1e-6)

