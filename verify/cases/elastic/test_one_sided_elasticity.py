"""Materials that carry tension only or compression only, by closed forms: a bar, and a wall pressed outside its core.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.decks.make_decks import block
from verify.decks.sheets import between
from verify.decks.solids import as_kind
from verify.readers.dat_frd_files import read_dat

RunDeck = Callable[..., subprocess.CompletedProcess[str]]
YOUNG, LIMIT = 1000.0, 1.0


def material(name: str, young: float = YOUNG, limit: float = LIMIT) -> str:
    """The law that CalculiX takes by the name of the material, for all elements."""
    return f"*MATERIAL, NAME={name}\n*USER MATERIAL, CONSTANTS=2\n{young:g}, {limit:g}\n*SOLID SECTION, ELSET=ALL, MATERIAL={name}\n"


def stress(strain: float, side: float) -> float:
    """Of uniaxial strain; side 1: tension only, -1: compression only."""
    return YOUNG * strain * (0.5 + np.arctan(side * strain * YOUNG / (np.pi * LIMIT)) / np.pi)


@pytest.mark.parametrize("stretch", [0.2, -0.2])
@pytest.mark.parametrize("step", ["*STEP", "*STEP, NLGEOM"])
@pytest.mark.parametrize(("name", "side"), [("TENSION_ONLY", 1.0), ("Compression_only_stone", -1.0)])
def test_bar(run_deck: RunDeck, tmp_path: Path, name: str, side: float, step: str, stretch: float) -> None:
    """The force of a unit cube; under NLGEOM the second Piola-Kirchhoff stress follows Green's strain."""
    body = as_kind(block(between(0, 1, 1), between(0, 1, 1), between(0, 1, 1), "BODY"), "C3D8")
    sets = "".join(f"*NSET, NSET={s}\n" + "".join(f"{i + 1},\n" for i in body.where(k, c)) for s, k, c in [("X", 0, 0), ("Y", 1, 0), ("Z", 2, 0), ("END", 0, 1)])
    deck = body.cards() + sets + material(name) + f"*BOUNDARY\nX, 1\nY, 2\nZ, 3\n{step}\n*STATIC\n*BOUNDARY\nEND, 1, 1, {stretch}\n"
    done = run_deck(deck + "*NODE PRINT, NSET=END, TOTALS=ONLY\nRF\n*END STEP\n", "--dialect=calculix")
    assert done.returncode == 0, done.stdout + done.stderr
    force = next(iter(read_dat(tmp_path / "job.dat")[-1].rows.values()))[0]
    exact = stress(stretch, side)
    if "NLGEOM" in step:
        exact = (1 + stretch) * stress(stretch + stretch**2 / 2, side)
    assert force == pytest.approx(exact, rel=2e-6)


def test_wall_outside_core(run_deck: RunDeck, tmp_path: Path) -> None:
    """A wall without tensile strength under a force off its middle by e > h/6: pressed over c = 3 (h/2 - e), its stress falls linearly from 2 N/(b c) to zero;
    the point of the force sinks by two thirds of the shortening of the edge. Reference: S. Timoshenko, Strength of Materials, part I (1955), article on eccentric
    compression of a short strut that cannot resist tension."""
    height, depth, width, force = 2.0, 1.0, 0.5, 100.0
    off = depth / 3
    pressed = 3 * (depth / 2 - off)
    edge_stress = 2 * force / (width * pressed)
    body = as_kind(block(between(-0.5 * depth, 0.5 * depth, 8), between(0, width, 1), between(0, height, 4), "BODY"), "C3D20R")
    base, top = body.where(2, 0.0), body.where(2, height)
    sets = "".join(f"*NSET, NSET={s}\n" + "".join(f"{i + 1},\n" for i in n) for s, n in [("BASE", base), ("TOP", top), ("SIDE", body.where(1, 0.0))])
    reference = len(body.nodes) + 1
    deck = body.cards() + sets + material("COMPRESSION_ONLY", 1e5, 1e-5 * edge_stress)
    deck += f"*NODE, NSET=R\n{reference}, {off:.15g}, 0., {height:g}\n{reference + 1}, {off:.15g}, 0., {height:g}\n"
    deck += f"*RIGID BODY, NSET=TOP, REF NODE={reference}, ROT NODE={reference + 1}\n*BOUNDARY\nBASE, 3\nSIDE, 2\n{base[0] + 1}, 1\n{reference + 1}, 1\n{reference + 1}, 3\n"
    deck += f"*STEP\n*STATIC\n*CLOAD\n{reference}, 3, {-force}\n*NODE PRINT, NSET=R\nU\n*END STEP\n"
    done = run_deck(deck, "--dialect=calculix")
    assert done.returncode == 0, done.stdout + done.stderr
    moved, turned = read_dat(tmp_path / "job.dat")[-1].rows.values()
    shortening = edge_stress / 1e5 * height
    assert moved[2] == pytest.approx(-2 / 3 * shortening, rel=1e-3), "1e-5 of the stress on the side that cracks"
    assert abs(turned[1]) == pytest.approx(shortening / pressed, rel=1e-3)


@pytest.mark.parametrize(
    ("cards", "words"),
    [
        ("*USER MATERIAL, CONSTANTS=2\n1000., 0.\n", "needs a positive Young's modulus"),
        ("*USER MATERIAL, CONSTANTS=2\n1000., 1.\n*PLASTIC\n10., 0.\n", "not linear and *PLASTIC"),
        ("*USER MATERIAL, CONSTANTS=2\n1000., 1.\n*ELASTIC\n10., 0.\n", "has a law of stress before this card"),
        ("*ELASTIC\n10., 0.\n*USER MATERIAL, CONSTANTS=2\n1000., 1.\n", "has a law of stress before this card"),
        ("*USER MATERIAL, CONSTANTS=2\n1000., 1.\n*INITIAL CONDITIONS, TYPE=STRESS\n1, 1, 1., 0., 0., 0., 0., 0.\n", "can have no initial stress"),
    ],
)
def test_refused(run_deck: RunDeck, cards: str, words: str) -> None:
    """What the laws do not go with."""
    body = as_kind(block(between(0, 1, 1), between(0, 1, 1), between(0, 1, 1), "BODY"), "C3D8")
    section = "*SOLID SECTION, ELSET=ALL, MATERIAL=TENSION_ONLY\n"
    first, _, rest = cards.partition("*INITIAL")
    deck = body.cards() + "*MATERIAL, NAME=TENSION_ONLY\n" + first + section + (f"*INITIAL{rest}" if rest else "")
    done = run_deck(deck + "*STEP\n*STATIC\n*BOUNDARY\n1, 1, 3\n*END STEP\n", "--dialect=calculix")
    assert done.returncode == 3
    assert words in " ".join((done.stdout + done.stderr).split())
