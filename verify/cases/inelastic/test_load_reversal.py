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
from verify.decks.shells import held, shell
from verify.readers.dat_frd_files import read_dat
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


@pytest.mark.parametrize("kind", ["S4", "S8R"])
def test_unloaded_body(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """A cantilever that could yield is bent below its yield stress and released under NLGEOM: nothing is left, and no attempt fails.

    The stress of a body without load is that of a strain of 1e-18; a difference of numbers near 1 would be a hundred times that.
    """
    body = shell(kind, (4, 2), lambda u, v: (10 * u, 4 * v, 0 * u))
    text = body.cards() + "*MATERIAL, NAME=M\n*ELASTIC\n210000., .3\n*PLASTIC\n250., 0.\n350., .1\n*SHELL SECTION, ELSET=E, MATERIAL=M\n.4\n"
    text += held(body.where(0, 0.0), "1, 6")
    for force in (4.4, 0.0):
        text += "*STEP, NLGEOM\n*STATIC, DIRECT\n.1, 1.\n*CLOAD\n"
        text += "".join(f"{n + 1}, 3, {force * share}\n" for n, share in body.edge_weights(0, 1.0).items())
        text += "*NODE PRINT, NSET=N, FREQUENCY=10\nU\n*END STEP\n"
    done = run_deck(text, "--dialect=calculix")
    assert done.returncode == 0, done.stdout
    assert not any(attempt.is_failed for attempt in read_sta(tmp_path / "job.sta"))
    bent, free = read_dat(tmp_path / "job.dat")
    assert bent.largest > 0.1
    assert free.largest < 1e-3 * bent.largest
