"""General contact and *MODEL CHANGE of elements: where a removed body stood others may pass; faces that a step uncovers or adds need a pair by hand.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from verify.cases.contact.test_missed_contact import MATERIALS, NOT_CONVERGED, YOUNG, block
from verify.conftest import Run

REMOVE = "*MODEL CHANGE, TYPE=ELEMENT, REMOVE\n{}\n"
ADD = "*MODEL CHANGE, TYPE=ELEMENT, ADD\n{}\n"
GENERAL = "*CONTACT{}\n*CONTACT INCLUSIONS, ALL EXTERIOR\n"


def step(cards: str, supports: str, *, is_nlgeom: bool = True) -> str:
    """A step of four increments."""
    text = f"*STEP{', NLGEOM' if is_nlgeom else ''}, INC=50\n*STATIC\n0.25, 1.\n{cards}*BOUNDARY, OP=NEW\n{supports}"
    return text + "*NODE PRINT, NSET=BZ0, TOTALS=ONLY\nRF\n*END STEP\n"


def force(folder: Path) -> float:
    """The last total force along z of the .dat file."""
    return float(re.findall(r"total force.*?\n\s*\n\s*\S+\s+\S+\s+(\S+)", (folder / "job.dat").read_text())[-1])


@pytest.mark.parametrize("is_removed", [True, False])
def test_far_body_where_another_one_stood(run_deck: Run, *, is_removed: bool) -> None:
    """A body comes from afar to the place of one that was removed: nothing is there. While the other one stands there, the job ends."""
    bodies = block("B", 1, (2, 2, 2), (0, 0, 0), (1, 1, 1)) + block("U", 5001, (2, 2, 2), (3, 0, 0), (4, 1, 1))
    text = MATERIALS + bodies + GENERAL.format(", REACH=0.1") + step("", "BZ0, 1, 3\nUX1, 1, 3\n")
    cards, held = (REMOVE.format("B"), "") if is_removed else ("", "BZ0, 1, 3\n")
    done = run_deck(text + step(cards, held + "UX1, 1, 1, -2.5\nUX1, 2, 3\n"))
    said = re.sub(r"\s+", " ", done.stdout + done.stderr)
    assert done.returncode == (0 if is_removed else NOT_CONVERGED), said
    assert re.search("element .* reached [BU], from which it was too far", said) is None or not is_removed, said


LAYERS = "*ELSET, ELSET=LOWER, GENERATE\n1, 7, 2\n*ELSET, ELSET=UPPER, GENERATE\n2, 8, 2\n"  # of B, whose elements are numbered upwards first
PAIR = "*SURFACE, NAME=SU\nU, S1\n*SURFACE, NAME=SB\nLOWER, S2\n*SURFACE INTERACTION, NAME=I\n*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nSU, SB\n"
DOWN = "BZ0, 1, 3\nUZ1, 1, 2\nUZ1, 3, 3, {}\n"


@pytest.mark.parametrize("has_pair", [False, True])
@pytest.mark.parametrize("way", [0.3, 0.53])
def test_uncovered_face(run_deck: Run, tmp_path: Path, way: float, *, has_pair: bool) -> None:
    """The upper layer of B goes and U comes down through its place to the lower one, which the step uncovers: a pair by hand carries it, without one the job ends."""
    bodies = block("B", 1, (2, 2, 2), (0, 0, 0), (1, 1, 1)) + block("U", 5001, (2, 2, 1), (0.2, 0.2, 1.02), (0.8, 0.8, 1.42)) + LAYERS
    text = MATERIALS + bodies + (PAIR if has_pair else "") + GENERAL.format("") + step("", DOWN.format(0))
    done = run_deck(text + step(REMOVE.format("UPPER"), DOWN.format(-way)))
    said = re.sub(r"\s+", " ", done.stdout + done.stderr)
    if way < 0.5 or has_pair:
        assert done.returncode == 0, said
        assert (force(tmp_path) > 0.001 * YOUNG) is (way > 0.5)
        return
    assert done.returncode == NOT_CONVERGED, said
    assert re.search(r"reached [BU] where \*MODEL CHANGE uncovered or added faces, and there is no pair of them. Name the pair with \*CONTACT PAIR", said), said


@pytest.mark.parametrize("has_pair", [False, True])
def test_body_added_on_an_uncovered_face(run_deck: Run, tmp_path: Path, *, has_pair: bool) -> None:
    """The second step takes the upper layer of B away and puts U in its place, without NLGEOM."""
    bodies = block("B", 1, (2, 2, 2), (0, 0, 0), (1, 1, 1)) + block("U", 5001, (2, 2, 1), (0.2, 0.2, 0.5), (0.8, 0.8, 0.9)) + LAYERS
    text = MATERIALS + bodies + (PAIR if has_pair else "") + GENERAL.format("") + step(REMOVE.format("U"), "BZ0, 1, 3\n", is_nlgeom=False)
    done = run_deck(text + step(REMOVE.format("UPPER") + ADD.format("U"), DOWN.format(-0.01), is_nlgeom=False))
    said = re.sub(r"\s+", " ", done.stdout + done.stderr)
    if has_pair:
        assert done.returncode == 0, said
        assert force(tmp_path) > 0.001 * YOUNG
        return
    assert done.returncode == NOT_CONVERGED, said
    assert re.search(r"reached [BU] where \*MODEL CHANGE uncovered or added faces", said), said
