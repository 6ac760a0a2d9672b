"""Loads that turn back on a body that flows: the iterations of the first increment after each turn.

A clamped cube with kinematic hardening goes up and down in 24 equal increments, the first eight up, by displacement or by force. The
body flows before each turn and is elastic in the increment after it, so that Newton's method needs one iteration there at small
displacements if it starts from the last equilibrium; from an extrapolated flow it takes two to four.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import pytest

from verify.benchmark.estimate_table import cube
from verify.conftest import Run
from verify.readers.sta_cvg_files import read_sta

TURNS = (9, 25)  #: the first increments after the turns of the amplitude


def cycled_cube(load: str, words: str = "") -> str:
    """The deck."""
    deck = cube(4, "").replace("*ELASTIC\n", "*PLASTIC, HARDENING=KINEMATIC\n200., 0.\n1200., 0.1\n*ELASTIC\n")
    deck = deck.replace("*STEP\n", f"*AMPLITUDE, NAME=CYCLE\n0., 0., 8., 1., 24., -1., 32., 0.\n*STEP{words}\n")
    return deck.replace("*STATIC\n", "*STATIC, DIRECT\n1., 32.\n").replace("*CLOAD\nHIGH, 3, -1.\n", load)


@pytest.mark.parametrize("words, most", [("", 1), (", NLGEOM", 2)])
@pytest.mark.parametrize("load", ["*BOUNDARY, AMPLITUDE=CYCLE\nHIGH, 3, 3, -0.006\n", "*CLOAD, AMPLITUDE=CYCLE\nHIGH, 3, -9.\n"])
def test_turns(run_deck: Run, tmp_path: Path, load: str, words: str, most: int) -> None:
    """No attempt fails, and the increments after the turns take one iteration (under NLGEOM two)."""
    done = run_deck(cycled_cube(load, words))
    assert done.returncode == 0, done.stdout
    attempts = read_sta(tmp_path / "job.sta")
    assert not any(attempt.is_failed for attempt in attempts)
    assert all(attempts[turn - 1].iterations <= most for turn in TURNS), [attempt.iterations for attempt in attempts]
    assert max(attempt.iterations for attempt in attempts) > most, "nothing flows"
