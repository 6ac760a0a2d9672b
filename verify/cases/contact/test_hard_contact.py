"""Hard contact problems: pairs over whole exteriors equal those of the facing sides; surface to surface is as sturdy as node to surface.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.grids import bodies_deck, grid
from verify.decks.hard_contact import SOFT, STEEL, Draw, problems, step
from verify.decks.sheets import between, fix, pair
from verify.independent.results import read_field, read_history

FORMS = {"nodes": "", "faces": ", TYPE=SURFACE TO SURFACE"}
SIDES = {"thin plates": ("UPPER_T0", "LOWER_T1"), "ring on mandrel": ("RING_T1", "MANDREL_T0"), "block on block": ("BODY_W0", "TABLE_W1"),
         "pin in bore": ("PIN_T0", "LUG_T1")}  #: the sides that touch
EQUAL = 1e-6  #: of the largest displacement: the tolerance of the corrections


def solve(run: Run, folder: Path, deck: str) -> Path:
    """Runs a deck that has to finish; its result file."""
    folder.mkdir(exist_ok=True)
    (folder / "job.inp").write_text(deck)
    done = run(["--quiet", "--outdir", folder, folder / "job.inp"], folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "job.vtkhdf"


def effort(file: Path) -> tuple[int, int]:
    """Iterations, and attempts that failed."""
    rows = read_history(file)
    counted = rows["increment"] > 0
    made = len(set(zip(rows["step"][counted].tolist(), rows["increment"][counted].tolist(), strict=True)))
    return int(rows["n_iterations"][counted].sum()), int(counted.sum()) - made


@pytest.mark.parametrize("form", list(FORMS))
@pytest.mark.parametrize("name", list(SIDES))
def test_whole_exteriors(run: Run, tmp_path: Path, name: str, form: str) -> None:
    """A pair of two whole exteriors finds the sides that touch: a slave beyond one side of a sheet is not behind the other.

    By faces the edges of the block have the normal cone of both their sides: the sides belong to the slave in both decks.
    """
    deck = problems()["g"][name](Draw(), FORMS[form]).deck
    slave, master = SIDES[name]
    bodies = slave.split("_")[0], master.split("_")[0]
    assert f"{bodies[0]}_ALL, {bodies[1]}_ALL" in deck
    whole = solve(run, tmp_path / "whole", deck)
    if (name, form) == ("block on block", "faces"):
        faces = "".join(re.search(rf"\*SURFACE, NAME=BODY_{side}\n([^*]+)", deck)[1] for side in ("W0", "S0", "S1", "T0", "T1"))  # type: ignore[index]
        deck = deck.replace("*MATERIAL, NAME=BODY\n", f"*SURFACE, NAME=BODY_LOWER\n{faces}*MATERIAL, NAME=BODY\n")
        slave = "BODY_LOWER"
    sides = solve(run, tmp_path / "sides", deck.replace(f"{bodies[0]}_ALL, {bodies[1]}_ALL", f"{slave}, {master}"))
    expected = read_field(sides, "U")[-1]
    assert np.abs(read_field(whole, "U")[-1] - expected).max() <= EQUAL * np.abs(expected).max()
    assert effort(whole)[1] == 0


@pytest.mark.parametrize("form", list(FORMS))
def test_free_motion_takes_no_rounds(run: Run, tmp_path: Path, form: str) -> None:
    """A pin that its supports move within its play has no force at all: rounding of K du is no residual, and no correction is made."""
    solve(run, tmp_path / "job", problems()["g"]["pin in bore"](Draw(), FORMS[form]).deck)
    first = next(line.split() for line in (tmp_path / "job" / "job.cvg").read_text().splitlines() if line.split()[:4] == ["1", "1", "1", "1"])
    assert first[-1] == "0"  # ROUNDS


def tip_force(run: Run, folder: Path, start: float | None) -> float:
    """A bar on a block, its tip pressed down beside the edge of the block; a second master lies deeper there, from `start` on, or none at all."""
    bar = grid("BAR", between(-2, 2, 16), between(0, 0.25, 2))
    blocks = [grid("HIGH", between(-2.2, 1.05, 13), between(-1, 0, 3))]
    if start is not None:
        blocks.append(grid("LOW", between(start, 3, 6), between(-1.2, -0.2, 3)))
    cards = "".join(pair("BAR_T0", f"{block.name}_T1", 0.0, FORMS["faces"]) for block in blocks)
    cards += step(fix(*(f"{block.name}_T0, 1, 2" for block in blocks), "BAR_S0, 1, 2", "BAR_S1, 2, 2, -0.05"), 4)
    file = solve(run, folder, bodies_deck([(bar, SOFT), *((block, STEEL) for block in blocks)], "CPE4", cards))
    tip = np.flatnonzero(np.isclose(bar.nodes[:, 0], 2.0))
    return float(read_field(file, "RF")[-1, tip, 1].sum())


@pytest.mark.parametrize("start", [1.1, 1.6])
def test_rows_end_at_a_step(run: Run, tmp_path: Path, start: float) -> None:
    """A bar bends over the edge of a block. A node beyond the edge is lower than the block's plane without penetration, whether the bar is the slave
    of a deeper master, too, or not: with a row there the tip is held 1.8 times as stiffly. The mean gap at the edge differs by a few percent between
    both, because only in a single pair the node's function goes to its neighbour."""
    single = tip_force(run, tmp_path / "single", None)
    assert tip_force(run, tmp_path / "both", start) == pytest.approx(single, rel=0.03)


def seam_decks(form: str, mu: float, drag: float) -> tuple[list[str], int]:
    """A block pressed on a held plate and drawn by `drag` in one increment over x = 1.13: over one plate, and over two that meet there. Both decks, and
    the number of the block's nodes. Cells of 0.2 on the block."""
    block = grid("BLOCK", between(0, 1, 5), between(0, 1, 4))
    left, right = between(-1, 1.13, 7), between(1.13, 4, 13)
    whole = [grid("WHOLE", np.concatenate([left, right[1:]]), between(-1, 0, 2))]
    halves = [grid("LEFT", left, between(-1, 0, 2)), grid("RIGHT", right, between(-1, 0, 2))]
    decks = []
    for plates in (whole, halves):
        cards = "".join(pair("BLOCK_T0", f"{plate.name}_T1", mu, FORMS[form]) for plate in plates)
        held = [f"{plate.name}_{side}, 1, 2" for plate in plates for side in ("T0", "T1")]
        cards += step(fix(*held, "BLOCK_T1, 1", "BLOCK_T1, 2, 2, -0.01"), 1) + step(fix(f"BLOCK_T1, 1, 1, {drag:g}"), 1)
        decks.append(bodies_deck([(block, SOFT), *((plate, STEEL) for plate in plates)], "CPE4", cards))
    return decks, len(block.nodes)


@pytest.mark.parametrize("drag", [0.06, 0.5, 0.7, 1.3])
@pytest.mark.parametrize("form", list(FORMS))
def test_slide_over_a_seam(run: Run, tmp_path: Path, form: str, drag: float) -> None:
    """Nodes that slide from one master to the next within one increment slip as on one master: the same displacements and contact forces. A node whose
    slip counted from where an iterate finds it on the next master sticks there instead, and the block has other pressures."""
    decks, n = seam_decks(form, 0.3, drag)
    one, two = (solve(run, tmp_path / name, deck) for name, deck in zip(("one", "two"), decks, strict=True))
    for name in ("U", "CNORMF", "CSHEARF", "CPRESS"):
        expected = read_field(one, name)[-1][:n]
        assert np.abs(read_field(two, name)[-1][:n] - expected).max() <= EQUAL * np.abs(expected).max(), name
    assert effort(two) == effort(one)


def test_rows_penetrate_in_the_mean(run: Run, tmp_path: Path) -> None:
    """A roller in a saddle by faces: the nodes beside the contact lie behind the chords of the saddle, as their rows admit, which face it. They did not
    pass through it (three attempts failed with PENETRATION JUMP)."""
    file = solve(run, tmp_path / "job", problems()["c"]["saddle"](Draw(), FORMS["faces"]).deck)
    assert effort(file)[1] == 0


@pytest.mark.parametrize("form", list(FORMS))
def test_corner_without_friction(run: Run, tmp_path: Path, form: str) -> None:
    """A leaning lip touches a plate with its corner, then with its side: without friction the plate gets no force along itself, and no attempt fails."""
    deck = problems()["f"]["flattened lip"](Draw(), FORMS[form]).deck
    assert "*FRICTION\n0.3\n" in deck
    file = solve(run, tmp_path / "job", deck.replace("*FRICTION\n0.3\n", "*FRICTION\n0.\n"))
    plate = [int(label) - 1 for label in re.findall(r"^(\d+),", re.search(r"\*NODE, NSET=PLATE\n([^*]+)", deck)[1], re.MULTILINE)]  # type: ignore[index]
    force = read_field(file, "RF")[:, plate].sum(axis=1)
    pressed = force[:, 1] < -1e-3 * np.abs(force[:, 1]).max()
    assert pressed.sum() > 10
    assert np.abs(force[pressed, 0]).max() <= 1e-5 * np.abs(force[pressed, 1]).max()  # Newton's tolerance of forces is 1e-6
    assert effort(file)[1] == 0
