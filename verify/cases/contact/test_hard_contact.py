"""Hard contact problems: pairs over whole exteriors equal those of the facing sides; surface to surface is as sturdy as node to surface.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

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
    """A pair of two whole exteriors finds the sides that touch: a slave beyond one side of a sheet is not behind the other."""
    deck = problems()["g"][name](Draw(), FORMS[form]).deck
    slave, master = SIDES[name]
    bodies = slave.split("_")[0], master.split("_")[0]
    assert f"{bodies[0]}_ALL, {bodies[1]}_ALL" in deck
    whole = solve(run, tmp_path / "whole", deck)
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
