"""A job that fails says why: the reason, its advice, and the nodes, on the terminal and in .cvg.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from conftest import Run

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "decks"))

from make_decks import block  # noqa: E402
from planes import flat_deck, flatten  # noqa: E402
from sheets import between, fix, pair, sheet, solid_deck  # noqa: E402

ELASTIC = "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n"
STATIC = "*STEP, NLGEOM, INC=100\n*STATIC\n0.1, 1., 0.01, 0.1\n"


def truss() -> str:
    """A flat truss of von Mises, half of it: limit load 2/(3 sqrt(3)) E A (h/l)^3 / 2 = 0.19, pressed with 1, to snap through."""
    return (
        "*NODE\n1, 0., 0., 0.\n2, 10., 0., 1.\n*ELEMENT, TYPE=T3D2, ELSET=BAR\n1, 1, 2\n"
        f"{ELASTIC}*SOLID SECTION, ELSET=BAR, MATERIAL=M\n1.\n{STATIC}*BOUNDARY\n1, 1, 3\n2, 1, 2\n*CLOAD\n2, 3, -1.\n*END STEP\n"
    )


def crushed() -> str:
    """An element of height 1, its top prescribed to go 1.5 down."""
    mesh = block([0.0, 1.0], [0.0, 1.0], [0.0, 1.0], "A")
    step = "*STEP, NLGEOM\n*STATIC, DIRECT\n1., 1.\n" + fix("A_BOTTOM, 1, 3", "A_TOP, 1, 2", "A_TOP, 3, 3, -1.5") + "*END STEP\n"
    return solid_deck([(mesh, (1000.0, 0.0))], "", step)


def dragged_off() -> str:
    """A block pressed on a table by forces and dragged off it in one increment: then nothing carries the forces."""
    table = block(between(0, 2, 4), between(0, 1, 1), [-1.0, 0.0], "TABLE")
    body = block(between(1, 2, 2), between(0, 1, 1), [0.0, 1.0], "BODY")
    press = "*STEP, NLGEOM\n*STATIC\n1., 1.\n" + fix("TABLE_TOP, 1, 3", "TABLE_BOTTOM, 1, 3", "BODY_TOP, 1, 2") + "*CLOAD\nBODY_TOP, 3, -1.\n"
    drag = "*END STEP\n*STEP, NLGEOM\n*STATIC, DIRECT\n1., 1.\n" + fix("BODY_TOP, 1, 1, 2.") + "*END STEP\n"
    return solid_deck([(body, (1000.0, 0.0)), (table, (1000.0, 0.0))], pair("BODY_BOTTOM", "TABLE_TOP", 0.1), press + drag)


def shot(way: float, static: str) -> str:
    """A block that starts 2 before a thin plate (0.2 thick, 3 long) and is driven `way` towards it; both faces are master."""
    body = flatten(sheet("BODY", between(1.1, 1.9, 3), between(2, 2.5, 2)))
    plate = flatten(sheet("PLATE", between(0, 3, 12), between(-0.2, 0, 2)))
    drive = fix("PLATE_LEFT, 1, 2", "PLATE_RIGHT, 1, 2", "BODY_TOP, 1", f"BODY_TOP, 2, 2, {-way}")
    cards = pair("BODY_BOTTOM", "BOTH", 0.2) + f"*STEP, NLGEOM, INC=1000\n*STATIC{static}{drive}*END STEP\n"
    deck = flat_deck([(body, (2000.0, 0.3)), (plate, (2000.0, 0.3))], "CPE4", cards)
    return deck.replace("*SURFACE INTERACTION", "*SURFACE, NAME=BOTH\nPLATE_E2, S3\nPLATE_E1, S1\n*SURFACE INTERACTION", 1)


def test_shot_is_caught(run: Run, tmp_path: Path) -> None:
    """A block that the first attempt shoots beyond the plate is caught by it when increments may be smaller: it stays above."""
    (tmp_path / "job.inp").write_text(shot(2.8, "\n1., 1., 1e-3, 1.\n"))
    done = run(["job"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "PENETRATION JUMP" in done.stdout, done.stdout
    assert "slave nodes at the end:  open 0" in done.stdout, done.stdout


@pytest.mark.parametrize(
    ("deck", "reasons", "advice"),
    [
        (truss(), ("LIMIT POINT",), "prescribe displacements"),
        (crushed(), ("MATERIAL",), "smaller increments"),
        (dragged_off(), ("FREE BODY", "LEFT MASTER"), "hold the body"),
        (shot(4.0, ", DIRECT\n1., 1.\n"), ("PENETRATION JUMP",), "half an edge"),
    ],
    ids=["limit point", "material", "free body", "penetration jump"],
)
def test_reason(run: Run, tmp_path: Path, deck: str, reasons: tuple[str, ...], advice: str) -> None:
    """Exit code 5, the reason in capitals, one remedy; .cvg has the reason too."""
    (tmp_path / "job.inp").write_text(deck)
    done = run(["job"], cwd=tmp_path)
    assert done.returncode == 5, done.stdout + done.stderr
    assert any(reason in done.stdout for reason in reasons), done.stdout
    assert "Remedy:" in done.stdout, done.stdout
    assert advice in done.stdout, done.stdout
    assert any(reason in (tmp_path / "job.cvg").read_text() for reason in reasons)
