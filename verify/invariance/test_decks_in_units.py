"""CalculiX's decks, of folders beside the repository, in other units: fields to 1e-8, iterations of each step within one, with
tight controls and in inch and pound with the deck's own. Each deck takes one system of units, by turns; all of them with AMONTONS_EVERY_CASE.

The decks are read in place, as the dialect of CalculiX. Two defaults there are numbers without a unit, K = 50 E of HARD and the stick slope E/2: they
are written out before a deck is scaled, which alone must change no bit of a result.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np
import pytest
from _pytest.mark import ParameterSet

from verify.cases.proof import Job
from verify.conftest import ROOT, Run
from verify.invariance.comparison import IN_UNITS, SYSTEMS, InUnits, has, same, same_counts
from verify.invariance.scaling import Units, cards, keyword, scaled

DECKS = Path(os.environ.get("AMONTONS_DECKS", ROOT.parent / "shared" / "decks"))
FILES = sorted([*DECKS.glob("contact/*.inp"), *DECKS.glob("static/*.inp")])
pytestmark = [pytest.mark.slow, pytest.mark.skipif(not FILES, reason=f"no decks in {DECKS}; AMONTONS_DECKS says where they are")]
#: What Newton's method may leave: springs of K = 1e7 on bodies that are soft beside them make 6e-10 of the largest force by rounding.
TIGHT = 1e-9
EVERY = bool(os.environ.get("AMONTONS_EVERY_CASE"))
#: A body that moves by 4e-9 of its size: its coordinates have seven digits of that, and springs of 50 E make pressures of the rest.
TOLERANCES = {"contactdeleteelement": 1e-4}


def spelled(deck: str) -> str:
    """The deck with HARD and the missing stick slopes as the numbers that they stand for."""
    parts = cards(deck)
    young = next((float(card[1].split(",")[0]) for card in parts if keyword(card) == "ELASTIC"), 0.0)
    for card in parts:
        if keyword(card) == "SURFACE BEHAVIOR" and "HARD" in card[0].upper():
            card[:] = [re.sub("HARD", "LINEAR", card[0], flags=re.I), f"{50 * young:.17g}"]
        if keyword(card) == "FRICTION" and len([v for v in card[1].split(",") if v.strip()]) == 1:
            card[1] = card[1].rstrip().rstrip(",") + f", {0.5 * young:.17g}"
    return "\n".join(line for card in parts for line in card) + "\n"


def solve(run: Run, folder: Path, deck: str) -> Job:
    """A job that has to finish."""
    folder.mkdir()
    (folder / "job.inp").write_text(deck)
    done = run(["--quiet", "--no-checkpoint", "--dialect=calculix", "job"], cwd=folder)
    if "USER goes with TYPE=SOLUTION alone" in done.stderr + done.stdout:
        pytest.skip("stresses by a routine compiled into CalculiX")
    assert done.returncode == 0, done.stdout + done.stderr
    return Job(folder / "job.vtkhdf", "job")


def file_and_systems() -> list[ParameterSet]:
    """Each deck with its system of units."""
    names = list(SYSTEMS)
    turns = ((file, names if EVERY else [names[i % len(names)]]) for i, file in enumerate(FILES))
    return [pytest.param(file, chosen, id=f"{file.parent.name}-{file.stem}") for file, chosen in turns]


@pytest.mark.parametrize(("file", "systems"), file_and_systems())
def test_deck(run: Run, tmp_path: Path, file: Path, systems: list[str]) -> None:
    """N and mm as N and m, kN and m, pound and inch."""
    deck = file.read_text()
    text = spelled(deck)
    plain = solve(run, tmp_path / "plain", scaled(text, Units(), TIGHT))
    if text != "\n".join(line for card in cards(deck) for line in card) + "\n":
        whole = solve(run, tmp_path / "as it is", scaled(deck, Units(), TIGHT))
        for name in (name for name in IN_UNITS if has(plain, name)):
            assert np.array_equal(plain.field(name), whole.field(name)), name
    for system in systems:
        units = SYSTEMS[system]
        same(solve(run, tmp_path / system, scaled(text, units, TIGHT)), plain, TOLERANCES.get(file.stem, 1e-8), InUnits(units))
    same_counts(solve(run, tmp_path / "own inch", scaled(text, SYSTEMS["inch-pound"], 0)), solve(run, tmp_path / "own", scaled(text, Units(), 0)))
