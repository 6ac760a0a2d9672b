"""Ciarlet's law and rubber with fibres: stretched and sheared cubes against the minimum of the energy, which Newton
iterations on its differences find.

References: P. G. Ciarlet, Mathematical Elasticity I (1988), section 4.10; G. A. Holzapfel, T. C. Gasser, R. W. Ogden, J. Elasticity 61
(2000) 1-48.

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
from verify.decks.solids import as_kind, node_set
from verify.readers.dat_frd_files import read_dat

RunDeck = Callable[..., subprocess.CompletedProcess[str]]
Floats = np.ndarray
YOUNG, POISSON = 210000.0, 0.3
RUBBER = (1.925, 0.026)
FIBRES = ((0.0, 0.7071, 2.3632, 0.8393), (0.0, -0.7071, 2.3632, 0.8393))
LAWS = {
    "CIARLET_EL": f"*USER MATERIAL, CONSTANTS=2\n{YOUNG}, {POISSON}\n",
    "Elastic_fiber_artery": "*USER MATERIAL, CONSTANTS=10\n"
    + f"{RUBBER[0]}, {RUBBER[1]}, {', '.join(map(str, FIBRES[0]))}, {FIBRES[1][0]}, {FIBRES[1][1]}\n{FIBRES[1][2]}, {FIBRES[1][3]}\n",
}


def energy(law: str, c: Floats) -> float:
    """Per reference volume, of C."""
    volume = np.linalg.det(c)
    if law == "CIARLET_EL":
        mu = YOUNG / (2 * (1 + POISSON))
        lame = 2 * mu * POISSON / (1 - 2 * POISSON)
        return float(mu / 2 * (np.trace(c) - 3) + lame / 4 * (volume - 1) - (lame / 4 + mu / 2) * np.log(volume))
    total = RUBBER[0] * (np.trace(c) * volume ** (-1 / 3) - 3) + (np.sqrt(volume) - 1) ** 2 / RUBBER[1]
    for x, y, k1, k2 in FIBRES:
        a = np.array([x, y, np.sqrt(1 - x**2 - y**2)])
        stretch = float(a @ c @ a) * volume ** (-1 / 3) - 1
        total += k1 / (2 * k2) * (np.exp(k2 * max(stretch, 0.0) ** 2) - 1)
    return float(total)


def free_stretches(law: str, stretch: float, measure: Callable[[Floats], Floats]) -> tuple[float, Floats]:
    """The force of a unit cube that is stretched along x and free across, and its sides: the energy is least. The fibres lie
    symmetric in the plane y-z, so that no shear arises."""

    def of(sides: Floats) -> float:
        return energy(law, measure(np.array([stretch, *sides])))

    sides, h = np.array([1.0, 1.0]), 1e-4
    steps = h * np.eye(2)
    for _ in range(30):
        slope = np.array([(of(sides + d) - of(sides - d)) / (2 * h) for d in steps])
        curve = np.array([[(of(sides + d + e) - of(sides + d - e) - of(sides - d + e) + of(sides - d - e)) / (4 * h * h) for e in steps] for d in steps])
        sides = sides - np.linalg.solve(curve, slope)
    force = (energy(law, measure(np.array([stretch + h, *sides]))) - energy(law, measure(np.array([stretch - h, *sides])))) / (2 * h)
    return float(force), sides - 1


def cube(law: str, step: str, stretch: float) -> str:
    """A unit cube that is stretched along x, free across."""
    body = as_kind(block(between(0, 1, 1), between(0, 1, 1), between(0, 1, 1), "BODY"), "C3D8")
    sets = "".join(node_set(s, body.where(k, c)) for s, k, c in [("X", 0, 0.0), ("Y", 1, 0.0), ("Z", 2, 0.0), ("END", 0, 1.0)])
    corner = node_set("CORNER", [n for n in body.where(0, 1.0) if n in body.where(1, 1.0) and n in body.where(2, 1.0)])
    deck = body.cards() + sets + corner + f"*MATERIAL, NAME={law}\n{LAWS[law]}*SOLID SECTION, ELSET=ALL, MATERIAL={law}\n"
    deck += f"*BOUNDARY\nX, 1\nY, 2\nZ, 3\n{step}\n*STATIC\n0.25, 1.\n*BOUNDARY\nEND, 1, 1, {stretch}\n"
    return deck + "*NODE PRINT, NSET=END, TOTALS=ONLY\nRF\n*NODE PRINT, NSET=CORNER\nU\n*END STEP\n"


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("step", "stretch"), [("*STEP, NLGEOM", 0.3), ("*STEP, NLGEOM", -0.2), ("*STEP", 0.1)])
def test_cube(run_deck: RunDeck, tmp_path: Path, law: str, step: str, stretch: float) -> None:
    """Force and contraction. Without NLGEOM C is 1 + 2 e of the small strain e, as in CalculiX."""
    done = run_deck(cube(law, step, stretch), "--dialect=calculix")
    assert done.returncode == 0, done.stdout + done.stderr
    tables = read_dat(tmp_path / "job.dat")[-2:]
    force = next(iter(tables[0].rows.values()))[0]
    across = next(iter(tables[1].rows.values()))[1:]
    measure = (lambda x: np.diag(x**2)) if "NLGEOM" in step else (lambda x: np.diag(2 * x - 1))
    exact, sides = free_stretches(law, 1 + stretch, measure)
    assert force == pytest.approx(exact, rel=2e-6), "differences of the energy"
    assert across == pytest.approx(sides, rel=2e-6)


@pytest.mark.parametrize(
    ("name", "cards", "words"),
    [
        ("CIARLET_EL", "*USER MATERIAL, CONSTANTS=2\n1000., 0.5\n", "Poisson's ratio must be"),
        ("ELASTIC_FIBER", "*USER MATERIAL, CONSTANTS=5\n1., 0., 1., 0., 1.\n", "CONSTANTS must be 6, 10, 14 or 18"),
        ("ELASTIC_FIBER", "*USER MATERIAL, CONSTANTS=6\n1., 0., 0.8, 0.8, 1., 1.\n", "direction of fibre 1 is longer than 1"),
        ("ELASTIC_FIBER", "*USER MATERIAL, CONSTANTS=6\n-1., 0., 0.8, 0., 1., 1.\n", "needs a positive C1"),
        ("ELASTIC_FIBER", "*USER MATERIAL, CONSTANTS=10\n1., 0., 0.8, 0., 1., 1., 0., 1.\n1., -1.\n", "k1 and k2 of fibre 2"),
        ("CIARLET_EL", "*USER MATERIAL, CONSTANTS=2\n1000., 0.3\n*PLASTIC\n10., 0.\n", "not linear and *PLASTIC"),
        ("LIN_ISO_EL", "*USER MATERIAL, CONSTANTS=2\n-1000., 0.3\n", "Young's modulus must be positive"),
    ],
)
def test_refused(run_deck: RunDeck, name: str, cards: str, words: str) -> None:
    """Constants out of bounds."""
    body = as_kind(block(between(0, 1, 1), between(0, 1, 1), between(0, 1, 1), "BODY"), "C3D8")
    deck = body.cards() + f"*MATERIAL, NAME={name}\n{cards}*SOLID SECTION, ELSET=ALL, MATERIAL={name}\n*STEP\n*STATIC\n*END STEP\n"
    done = run_deck(deck, "--dialect=calculix")
    assert done.returncode == 3
    assert words in " ".join((done.stdout + done.stderr).split())
