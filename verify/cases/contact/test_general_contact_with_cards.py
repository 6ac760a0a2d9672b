"""General contact together with other cards: ties, removed elements, temperatures, shrink fits; against pairs by hand and closed forms.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.assemblies import FLANGE_PAIRS, by_hand, flange, general
from verify.decks.grids import bodies_deck, grid
from verify.decks.make_decks import Floats
from verify.decks.sheets import between, fix

SOFT, STEEL = "*ELASTIC\n1000., 0.3\n", "*ELASTIC\n210000., 0.3\n"
EQUAL = 1e-6  #: over the largest value: the pairs are the same, but for faces beside those in contact
ROUNDING = 1e-6  #: of stresses that vanish, over those before: the tolerance of Newton's method


class Result(NamedTuple):
    """The last frame of a job, and what the terminal said."""

    points: Floats
    u: Floats
    stress: Floats
    force: Floats  #: RF
    pressure: Floats
    said: str


def solve(run: Run, folder: Path, deck: str) -> Result:
    """Runs a deck, which must end well."""
    (folder / "job.inp").write_text(deck)
    done = run(["--outdir", folder, folder / "job.inp"], folder)
    said = done.stdout + done.stderr
    assert done.returncode == 0, said
    with h5py.File(folder / "job.vtkhdf") as file:
        n = int(file["VTKHDF/NumberOfPoints"][-1])
        fields = [np.asarray(file[f"VTKHDF/{name}"])[-n:] for name in ("Points", *(f"PointData/{f}" for f in ("U", "S", "RF", "CPRESS")))]
    return Result(*fields, said)


def same(ours: Result, other: Result) -> None:
    """Displacements and stresses are those of another deck."""
    for a, b in ((ours.u, other.u), (ours.stress, other.stress)):
        assert np.abs(a - b).max() <= EQUAL * np.abs(b).max()


def step(cards: str, increments: str = "0.25, 1.", options: str = "") -> str:
    """A static step."""
    return f"*STEP{options}\n*STATIC\n{increments}\n{cards}*END STEP\n"


# Ties


def post(contact: str, tie: str, lean: float) -> str:
    """A post on a table, whose sides lean outward, and a plate that presses on it."""
    table = grid("TABLE", between(0, 6, 12), between(0, 2, 4))
    column = grid("POST", between(0, 2, 5), between(2, 4, 4), place=lambda x, y: (2 + x + lean * (x - 1) * (y - 2), y))
    plate = grid("PLATE", between(-1, 7, 10), between(4, 5, 2))
    cards = tie + contact + fix("TABLE_T0, 1, 2", "PLATE_T1, 1") + step(fix("PLATE_T1, 2, 2, -0.05"), "1., 1.")
    return bodies_deck([(column, SOFT), (table, SOFT), (plate, STEEL)], "CPE4", cards)


@pytest.mark.parametrize("lean", [0.0, 1.5], ids=["upright", "leaning"])
@pytest.mark.parametrize("tie", ["POST_T0, TABLE_T1", "TABLE_T1, POST_T0"])
def test_tied_bodies(run: Run, tmp_path: Path, tie: str, lean: float) -> None:
    """Contact does not act between tied faces, nor at the faces beside them: the post is as with one pair by hand, and no warning says
    that the tie holds slave nodes."""
    tie = f"*TIE, NAME=WELD\n{tie}\n"
    ours = solve(run, tmp_path, post(general(0.0), tie, lean))
    same(ours, solve(run, tmp_path, post(by_hand(0.0, "POST_T1, PLATE_T0"), tie, lean)))
    assert "*WARNING" not in ours.said


def tongue(contact: str, tie: str, length: float = 5.6) -> str:
    """A tongue on a block: tied over a third of its length, a gap below the rest, which a pressure closes."""
    block = grid("BLOCK", between(0, 6, 12), between(0, 2, 4))
    lines = between(0, length, round(length / 0.4)), between(0, 0.5, 2)
    strip = grid("TONGUE", *lines, place=lambda x, y: (x, 2 + y + 0.02 * np.clip((x - 2) / 0.4, 0, 1) * (1 - y / 0.5)))
    strip.surface("FOOT", lambda m: m[:, 1] < 2 + 1e-6)
    strip.surface("FREE", lambda m: (m[:, 1] > 2 + 1e-6) & (m[:, 1] < 2.15))
    pressed = "*DLOAD\n" + "".join(f"{e}, P3, 1.\n" for e in range(round(length / 0.4) + 1, 2 * round(length / 0.4) + 1))
    return bodies_deck([(strip, SOFT), (block, SOFT)], "CPE4", tie + contact + fix("BLOCK_T0, 1, 2") + step(pressed))


@pytest.mark.parametrize("surfaces", ["TONGUE_T0, BLOCK_T1", "TONGUE_ALL, BLOCK_ALL"])
def test_partly_tied_bodies(run: Run, tmp_path: Path, surfaces: str) -> None:
    """A tie leaves out the faces that it holds. Those beyond its position tolerance touch: naming the whole undersides, or both bodies,
    is the same as naming the foot."""
    by_foot = solve(run, tmp_path, tongue(by_hand(0.0, "TONGUE_FREE, BLOCK_T1"), "*TIE, NAME=WELD\nTONGUE_FOOT, BLOCK_T1\n"))
    assert by_foot.pressure.max() > 1.0, "the tongue lies on the block"
    ours = solve(run, tmp_path, tongue(general(0.0), f"*TIE, NAME=WELD, POSITION TOLERANCE=0.001\n{surfaces}\n"))
    same(ours, by_foot)


def test_tie_beside_the_master(run: Run, tmp_path: Path) -> None:
    """The corner of a tongue that is as long as the block stands 0.02 above the edge of the block: it lies in the plane of its end, but
    no nearer than that to its faces, and a tolerance of 0.001 does not tie it."""
    by_foot = solve(run, tmp_path, tongue(by_hand(0.0, "TONGUE_FREE, BLOCK_T1"), "*TIE, NAME=WELD\nTONGUE_FOOT, BLOCK_T1\n", 6.0))
    tie = "*TIE, NAME=WELD, POSITION TOLERANCE=0.001\nTONGUE_ALL, BLOCK_ALL\n"
    same(solve(run, tmp_path, tongue(general(0.0), tie, 6.0)), by_foot)


# Removed elements

PUSHED = step(fix("SOLE_T1, 1", "SOLE_T1, 2, 2, -0.03"))


def sole(contact: str, steps: str, options: str = "") -> str:
    """A block on a floor of four columns."""
    floor = grid("FLOOR", between(0, 6, 9), between(0, 1, 3))
    block = grid("SOLE", between(1, 3, 4), between(1.002, 2, 3))
    steps = steps.replace("*STEP", f"*STEP{options}")
    return bodies_deck([(block, SOFT), (floor, SOFT)], "CPE4", contact + fix("FLOOR_T0, 1, 2") + steps)


CONTACTS = {
    "general": general(0.2),
    "general-nodes": general(0.2).replace("*CONTACT\n", "*CONTACT, TYPE=NODE TO SURFACE\n"),
    "hand": by_hand(0.2, "SOLE_T0, FLOOR_T1"),
    "hand-nodes": by_hand(0.2, "SOLE_T0, FLOOR_T1").replace("TYPE=SURFACE TO SURFACE", "TYPE=NODE TO SURFACE"),
    "springs": by_hand(0.2, "SOLE_T0, FLOOR_T1").replace("*FRICTION", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1e5\n*FRICTION"),
    "floor-slave": by_hand(0.2, "FLOOR_T1, SOLE_T0"),
}


@pytest.mark.parametrize("options", ["", ", NLGEOM"], ids=["small", "finite"])
@pytest.mark.parametrize("removed", ["SOLE", "FLOOR"])
@pytest.mark.parametrize("name", CONTACTS)
def test_removed_bodies(run: Run, tmp_path: Path, name: str, removed: str, options: str) -> None:
    """A body that a step removes touches nothing, as slave and as master: the other one is free of stress."""
    remove = step(f"*MODEL CHANGE, TYPE=ELEMENT, REMOVE\n{removed}\n", "0.5, 1.")
    before = solve(run, tmp_path, sole(CONTACTS[name], PUSHED, options))
    assert before.pressure.max() > 5.0, "they touched"
    after = solve(run, tmp_path, sole(CONTACTS[name], PUSHED + remove, options))
    left = after.points[:, 1] < 1.001 if removed == "SOLE" else after.points[:, 1] > 1.001
    assert np.abs(after.stress[left]).max() <= ROUNDING * np.abs(before.stress).max()
    assert after.pressure.max() <= 0.0


@pytest.mark.parametrize("options", ["", ", NLGEOM"], ids=["small", "finite"])
@pytest.mark.parametrize("name", [name for name in CONTACTS if name != "floor-slave"])
def test_removed_layer(run: Run, tmp_path: Path, name: str, options: str) -> None:
    """Columns of the floor are removed below a part of the block: it rests on the other ones alone, as on a floor without them."""
    gone = [9 * row + column for row in range(3) for column in (3, 4, 5)]
    cards = "*MODEL CHANGE, TYPE=ELEMENT, REMOVE\n" + "".join(f"{12 + e + 1}\n" for e in gone)
    pushed = PUSHED.replace("*BOUNDARY", cards + "*BOUNDARY")
    ours = solve(run, tmp_path, sole(CONTACTS[name], pushed, options))
    x, p = ours.points[:, 0], ours.pressure
    assert p[np.abs(x - 1.5) < 0.1].max() > 5.0, "it rests on the columns that are left"
    assert np.abs(p[(x > 2.4) & (x < 3.1)]).max() <= 0.0, "not on those that are gone"


def test_body_removed_and_added(run: Run, tmp_path: Path) -> None:
    """A body that is put back touches again, free of strain where its nodes are: general contact as the pair by hand."""
    steps = PUSHED + step("*MODEL CHANGE, TYPE=ELEMENT, REMOVE\nSOLE\n", "0.5, 1.")
    steps += step("*MODEL CHANGE, TYPE=ELEMENT, ADD\nSOLE\n" + fix("SOLE_T1, 2, 2, -0.06"))
    ours = solve(run, tmp_path, sole(CONTACTS["general"], steps))
    same(ours, solve(run, tmp_path, sole(CONTACTS["hand"], steps)))
    assert ours.pressure.max() > 5.0


@pytest.mark.parametrize("options", ["", ", NLGEOM"], ids=["small", "finite"])
def test_body_added_later(run: Run, tmp_path: Path, options: str) -> None:
    """A body that the first step takes out and the second one adds touches then: general contact as the pair by hand."""
    steps = step("*MODEL CHANGE, TYPE=ELEMENT, REMOVE\nSOLE\n", "0.5, 1.")
    steps += step("*MODEL CHANGE, TYPE=ELEMENT, ADD\nSOLE\n" + fix("SOLE_T1, 1", "SOLE_T1, 2, 2, -0.06"))
    ours = solve(run, tmp_path, sole(CONTACTS["general"], steps, options))
    same(ours, solve(run, tmp_path, sole(CONTACTS["hand"], steps, options)))
    assert ours.pressure.max() > 5.0


# Closed forms


def test_thermal_expansion_closes_a_gap(run: Run, tmp_path: Path) -> None:
    """A bar of 10 grows by 0.05 against a rigid wall 0.01 away: its stress is -E (alpha dT - gap/L)."""
    bar = grid("BAR", between(0, 10, 10), between(0, 1, 2))
    wall = grid("WALL", between(10.01, 11, 2), between(-0.5, 1.5, 3))
    cards = "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nBAR, 20.\nWALL, 20.\n" + general(0.0) + fix("BAR_S0, 1", "BAR_T0, 2", "WALL_ALL, 1, 2")
    deck = bodies_deck([(bar, "*ELASTIC\n1000., 0.\n*EXPANSION\n1e-4\n"), (wall, STEEL)], "CPS4", cards + step("*TEMPERATURE\nBAR, 70.\n"))
    result = solve(run, tmp_path, deck)
    assert result.stress[result.points[:, 0] < 10.001, 0] == pytest.approx(-1000 * (1e-4 * 50 - 0.01 / 10), rel=1e-6)


A, B, C = 20.0, 30.0, 40.0  #: radii of two steel rings: inside, between them, outside


def rings(overlap: float, cards: str, steps: str) -> str:
    """Two rings of general contact that overlap, free to change their height; cards: before *CONTACT ! in its block."""
    inner = grid("INNER", between(A, B + overlap / 2, 12), between(0, 5, 3))
    outer = grid("OUTER", between(B - overlap / 2, C, 12), between(0, 5, 4))
    contact = general(0.0).replace("*CONTACT\n", cards.partition("!")[0] + "*CONTACT\n") + cards.partition("!")[2]
    return bodies_deck([(inner, STEEL), (outer, STEEL)], "CAX4", contact + fix("INNER_T0, 2", "OUTER_T0, 2") + steps)


def lame(overlap: float) -> float:
    """The pressure of a shrink fit: E delta/b / ((b^2+a^2)/(b^2-a^2) + (c^2+b^2)/(c^2-b^2)) (G. Lame)."""
    return 210000 * overlap / B / ((B**2 + A**2) / (B**2 - A**2) + (C**2 + B**2) / (C**2 - B**2))


ALL = "*CONTACT INITIALIZATION ASSIGNMENT\n, , FIT\n"
FIT_ERROR = 0.01  #: of elements whose error is of second order in 1/12, and of the strain of 3e-4


@pytest.mark.parametrize("options", ["", ", NLGEOM"], ids=["small", "finite"])
def test_shrink_fit(run: Run, tmp_path: Path, options: str) -> None:
    """Without a card overlaps are pushed out in the first increment, and a warning says so."""
    result = solve(run, tmp_path, rings(0.01, "", step("", "1., 1.", options)))
    pressed = result.pressure[result.pressure > 0]
    assert len(pressed) == 5
    assert pressed == pytest.approx(lame(0.01), rel=FIT_ERROR)
    assert "It is pushed out in the first increment" in result.said


@pytest.mark.parametrize("options", ["", ", NLGEOM"], ids=["small", "finite"])
def test_interference_fit(run: Run, tmp_path: Path, options: str) -> None:
    """INTERFERENCE FIT takes the overlap away over the first step: half of it at half of the time."""
    steps = step("", "0.5, 1., 0.5, 0.5", options)
    result = solve(run, tmp_path, rings(0.01, "*CONTACT INITIALIZATION DATA, NAME=FIT, INTERFERENCE FIT\n!" + ALL, steps))
    assert result.pressure[result.pressure > 0] == pytest.approx(lame(0.01), rel=FIT_ERROR)
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        pressure = np.asarray(file["VTKHDF/PointData/CPRESS"]).reshape(-1, len(result.points))
        time = np.asarray(file["VTKHDF/Steps/Values"])
    half = pressure[np.abs(time - 0.5).argmin()]
    assert half[half > 0] == pytest.approx(lame(0.005), rel=FIT_ERROR)


@pytest.mark.parametrize(("overlap", "data", "pressure"), [
    (0.01, "", 0.0),
    (-0.004, ", SEARCH ABOVE=0.005", 0.0),
    (0.01, ", SEARCH BELOW=0.02", 0.0),
    (0.01, ", SEARCH BELOW=0.005", lame(0.01)),
])  # fmt: skip
def test_adjusted_overlaps(run: Run, tmp_path: Path, overlap: float, data: str, pressure: float) -> None:
    """Else the slave nodes are moved onto the master, without stress: those of an overlap, with SEARCH ABOVE those of a gap, too, with
    SEARCH BELOW no deeper ones."""
    result = solve(run, tmp_path, rings(overlap, f"*CONTACT INITIALIZATION DATA, NAME=FIT{data}\n!" + ALL, step("", "1., 1.")))
    if pressure > 0:
        assert result.pressure.max() == pytest.approx(pressure, rel=FIT_ERROR)
        return
    assert np.abs(result.stress).max() <= ROUNDING * lame(0.01)
    outer = result.points[(result.points[:, 0] > B - 0.1) & (result.points[:, 0] < B + 0.1), 0]
    assert np.ptp(outer) <= 1e-9, "both surfaces have one radius"


# Sentences


def clamped(role: str) -> str:
    """Two blocks, the upper one held in all its nodes and the slave: as the deck says, or because the lower one is held, too."""
    low, high = grid("LOW", between(0, 3, 3), between(0, 1, 1)), grid("HIGH", between(1, 2, 1), between(1, 2, 1))
    held = fix("HIGH_ALL, 1, 2", "LOW_T0, 1, 2") + (fix("LOW_ALL, 1, 2") if role == "" else "")
    roles = f"*CONTACT FORMULATION, TYPE=MASTER SLAVE ROLES\nHIGH_ALL, LOW_ALL, {role}\n" if role else ""
    return bodies_deck([(high, SOFT), (low, SOFT)], "CPE4", general(0.0) + roles + held + step("", "1., 1."))


def test_held_slaves(run: Run, tmp_path: Path) -> None:
    """The warning of slave nodes that supports hold names the card that gives general contact its roles; it is silent where supports
    hold the master, too."""
    warning = "the contact cannot push there"
    said = solve(run, tmp_path, clamped("SLAVE")).said
    assert warning in said
    assert "Swap slave and master by *CONTACT FORMULATION, TYPE=MASTER SLAVE ROLES." in said
    for role in ("MASTER", ""):
        assert warning not in solve(run, tmp_path, clamped(role)).said


def test_gasket_in_symmetry_planes(run: Run, tmp_path: Path) -> None:
    """Both faces of a gasket of shells are slaves; in symmetry planes supports hold its nodes along it, which leaves contact to act."""
    said = solve(run, tmp_path, flange(by_hand(0.2, *FLANGE_PAIRS))).said
    assert "knots" not in said


REFUSED = {
    "*CONTACT CLEARANCE, NAME=C, CLEARANCE=0.1": ("", "*CONTACT CLEARANCE is not supported", "*CONTACT INITIALIZATION DATA with SEARCH ABOVE"),
    "*CONTACT CLEARANCE ASSIGNMENT\n, , C": ("", "*CONTACT CLEARANCE ASSIGNMENT is not supported", "a *CONTACT PAIR of the two surfaces with a *CLEARANCE"),
    "in a step": ("*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n", "*CONTACT must be before the first step", "general contact holds in all steps"),
    "removed": ("*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nA, B\n", "There is no contact pair of the slave 'A' and the master 'B'.",
                "give the two surfaces a *CONTACT PAIR, which *CONTACT leaves out then"),
}  # fmt: skip


@pytest.mark.parametrize("card", REFUSED)
def test_refused_cards(run_deck: Run, card: str) -> None:
    """What general contact does not take names the alternative."""
    in_step, message, remedy = REFUSED[card]
    text = "*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 1., 1., 0.\n4, 0., 1., 0.\n5, 0., 0., 1.\n6, 1., 0., 1.\n7, 1., 1., 1.\n8, 0., 1., 1.\n"
    text += "*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*MATERIAL, NAME=M\n*ELASTIC\n1., 0.\n*SOLID SECTION, ELSET=E, MATERIAL=M\n"
    text += "*SURFACE, NAME=A\nE, S1\n*SURFACE, NAME=B\nE, S2\n*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n"
    text += (card + "\n" if card.startswith("*") else "") + f"*STEP\n*STATIC\n{in_step}*BOUNDARY\n1, 1, 3\n*END STEP\n"
    done = run_deck(text, "--check")
    said = re.sub(r"\s+", " ", done.stdout + done.stderr)
    assert done.returncode != 0, said
    assert message in said, said
    assert remedy in said, said


def test_settings_without_effect(run_deck: Run) -> None:
    """*CONTACT CONTROLS ASSIGNMENT changes nothing here: a warning says so."""
    text = "*CONTACT CONTROLS ASSIGNMENT, TYPE=SCALE PENALTY\n, , 2.\n"
    said = re.sub(r"\s+", " ", (done := run_deck(text, "--check")).stdout + done.stderr)
    assert "*WARNING: The card *CONTACT CONTROLS ASSIGNMENT is read past." in said, said
