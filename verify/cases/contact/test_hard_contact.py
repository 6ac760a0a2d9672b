"""Hard contact problems: pairs over whole exteriors equal those of the facing sides; surface to surface is as sturdy as node to surface.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.hard_contact import Draw, problems
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
