"""Energies of each increment: what the loads gave is stored, or taken by friction and by plastic strain.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.make_decks import Floats, block
from verify.decks.sheets import between, fix, pair, solid_deck, step

TERMS = ("strain_energy", "contact_energy", "friction_work", "plastic_work", "proximal_work")


def energies(run: Run, folder: Path, deck: str) -> dict[str, Floats]:
    """The energies of the increments that converged."""
    (folder / "job.inp").write_text(deck)
    done = run(["job"], cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(folder / "job.vtkhdf") as file:
        history = file["AMONTONS/history"]
        keep = np.asarray(history["is_converged"]) == 1
        return {name: np.asarray(history[name])[keep] for name in ("external_work", *TERMS)}


def plastic(deck: str, name: str, curve: str) -> str:
    """The material of a part gets a curve of hardening."""
    head, tail = deck.split(f"*MATERIAL, NAME={name}\n", 1)
    first, second, rest = tail.split("\n", 2)
    return f"{head}*MATERIAL, NAME={name}\n{first}\n{second}\n{curve}{rest}"


@pytest.mark.parametrize("hardening", ["", ", HARDENING=KINEMATIC"])
def test_bar(run: Run, tmp_path: Path, hardening: str) -> None:
    """A bar drawn to twice its strain of yield: half of sigma eps_y is stored, sigma times the rest is taken by plastic strain."""
    bar = block([0.0, 2.0], [0.0, 1.0], [0.0, 1.0], "BAR")
    bar.node_sets["LEFT"], bar.node_sets["RIGHT"] = (np.flatnonzero(bar.nodes[:, 0] == x) for x in (0.0, 2.0))
    supports = fix("LEFT, 1", "1, 1, 3", "5, 2", "RIGHT, 1, 1, 0.02")
    deck = solid_deck([(bar, (1000.0, 0.3))], "", step(supports, 4))
    found = energies(run, tmp_path, plastic(deck, "BAR", f"*PLASTIC{hardening}\n5., 0.\n5., 1.\n"))
    volume, yield_strain, stress = 2.0, 0.005, 5.0
    assert found["plastic_work"][-4:] == pytest.approx(volume * stress * np.array([0, 0, 0.0025, 0.005]), rel=1e-6, abs=1e-9)
    assert found["strain_energy"][-1] == pytest.approx(0.5 * volume * stress * yield_strain, rel=1e-6)
    assert found["external_work"][-1] == pytest.approx(found["strain_energy"][-1] + found["plastic_work"][-1], rel=1e-6)


@pytest.mark.parametrize("law", ["hard", "linear"])
def test_balance_of_a_sliding_block(run: Run, tmp_path: Path, law: str) -> None:
    """A soft block that yields is pressed on a table and dragged: in each increment the sums agree to the error of the trapezoidal rule."""
    body = block(between(0, 1, 4), between(0, 1, 3), between(0, 0.6, 3), "BODY")
    table = block(between(-0.5, 2, 8), between(-0.5, 1.5, 4), [-1.0, -0.4, 0.0], "TABLE")
    press = fix("TABLE_BOTTOM, 1, 3", "BODY_TOP, 1, 2", "BODY_TOP, 3, 3, -0.006")
    steps = step(press, 10) + step(fix("BODY_TOP, 1, 1, 0.02"), 20)
    cards = pair("BODY_BOTTOM", "TABLE_TOP", 0.3)
    if law == "linear":
        cards = cards.replace("*FRICTION\n0.3\n", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1e6\n*FRICTION\n0.3\n")
    deck = solid_deck([(body, (2000.0, 0.3)), (table, (210000.0, 0.3))], cards + steps, "")
    found = energies(run, tmp_path, plastic(deck, "BODY", "*PLASTIC\n12., 0.\n20., 0.1\n"))
    total = sum(found[name] for name in TERMS)
    assert np.abs(total - found["external_work"]).max() < 0.01 * found["external_work"][-1]
    assert found["friction_work"][-1] > 0.05 * found["external_work"][-1]
    assert found["plastic_work"][-1] > 0.05 * found["external_work"][-1]
    assert (np.diff(found["plastic_work"]) >= -1e-12).all()
