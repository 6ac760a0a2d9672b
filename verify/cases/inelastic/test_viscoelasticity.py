"""Viscoelasticity by Prony series: relaxation and creep of bars, creep of a thick sphere under pressure, long-term and instantaneous
steps, and rubber that is stretched at once and held.

Formulas: W. N. Findley, J. S. Lai, K. Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials (1976), chapter 5 (bars), by
the correspondence principle from S. Timoshenko, J. N. Goodier, Theory of Elasticity, section 136 (sphere).

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
YOUNG, POISSON = 1000.0, 0.3
SERIES = ((0.3, 0.5), (0.4, 7.0))  # g and tau
LASTING = 1 - sum(g for g, _ in SERIES)
STRAIN = 0.01


def bar(law: str, steps: str, kind: str = "C3D8") -> str:
    """A unit cube that is free across."""
    body = as_kind(block(between(0, 1, 1), between(0, 1, 1), between(0, 1, 1), "BODY"), kind)
    sets = "".join(node_set(s, body.where(k, c)) for s, k, c in [("X0", 0, 0.0), ("Y0", 1, 0.0), ("Z0", 2, 0.0), ("Z1", 2, 1.0)])
    return body.cards() + sets + f"*MATERIAL, NAME=M\n{law}*SOLID SECTION, ELSET=ALL, MATERIAL=M\n*BOUNDARY\nX0, 1\nY0, 2\nZ0, 3\n" + steps


def elastic(moduli: str, share: float = 1.0) -> str:
    """Elasticity whose bulk modulus relaxes by a share of what the shear modulus does."""
    return f"*ELASTIC{moduli}\n{YOUNG}, {POISSON}\n*VISCOELASTIC, TIME=PRONY\n" + "".join(f"{g}, {g * share}, {tau}\n" for g, tau in SERIES)


def totals(folder: Path) -> list[float]:
    """The force along z at the end of each increment."""
    return [next(iter(t.rows.values()))[-1] for t in read_dat(folder / "job.dat")]


def run(run_deck: RunDeck, deck: str) -> None:
    """Runs a deck."""
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr


PRINT = "*NODE PRINT, NSET=Z1, TOTALS=ONLY\nRF\n*END STEP\n"


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
def test_relaxation(run_deck: RunDeck, tmp_path: Path, nlgeom: str) -> None:
    """Stretched in a *STATIC step, held in *VISCO: E (1 - sum g (1 - exp(-t/tau))), in increments of any length; at last LONG TERM."""
    steps = f"*STEP{nlgeom}\n*STATIC\n1., 1.\n*BOUNDARY\nZ1, 3, 3, {STRAIN}\n{PRINT}"
    steps += f"*STEP{nlgeom}\n*VISCO, DIRECT\n1.25, 5.\n{PRINT}*STEP{nlgeom}\n*STATIC, LONG TERM\n1., 1.\n{PRINT}"
    run(run_deck, bar(elastic(", MODULI=INSTANTANEOUS"), steps))
    forces = np.array(totals(tmp_path))
    times = np.array([0, 1.25, 2.5, 3.75, 5.0])
    factors = np.array([1 - sum(g * (1 - np.exp(-t / tau)) for g, tau in SERIES) for t in times] + [LASTING])
    assert forces == pytest.approx(forces[0] * factors, rel=1e-6)
    if not nlgeom:
        assert forces[0] == pytest.approx(YOUNG * STRAIN, rel=1e-6)


def test_long_term_moduli(run_deck: RunDeck, tmp_path: Path) -> None:
    """The constants are the long-term ones by default: E after LONG TERM, E over what lasts at once."""
    steps = "".join(f"*STEP\n*STATIC{word}\n1., 1.\n*BOUNDARY\nZ1, 3, 3, {STRAIN}\n{PRINT}" for word in ("", ", LONG TERM"))
    run(run_deck, bar(elastic(""), steps))
    assert totals(tmp_path) == pytest.approx([YOUNG * STRAIN / LASTING, YOUNG * STRAIN], rel=1e-6)


def test_creep(run_deck: RunDeck, tmp_path: Path) -> None:
    """One term under constant tension: strain s/E (1 + g/(1 - g) (1 - exp(-(1 - g) t/tau))); the strain bends over an increment, so that
    a quarter of its length leaves a sixteenth of the error."""
    g, tau, stress = 0.6, 2.0, 5.0
    law = f"*ELASTIC, MODULI=INSTANTANEOUS\n{YOUNG}, {POISSON}\n*VISCOELASTIC, TIME=PRONY\n{g}, {g}, {tau}\n"
    errors = []
    for n in (8, 32):
        load = f"*DSLOAD\nTOP, P, {-stress}\n*NODE PRINT, NSET=Z1\nU\n*END STEP\n"
        steps = f"*SURFACE, NAME=TOP\nALL, S2\n*STEP\n*STATIC\n1., 1.\n{load}*STEP, INC=1000\n*VISCO, DIRECT\n{4 / n}, 4.\n*NODE PRINT, NSET=Z1\nU\n*END STEP\n"
        run(run_deck, bar(law, steps))
        u = next(iter(read_dat(tmp_path / "job.dat")[-1].rows.values()))[2]
        errors.append(u / (stress / YOUNG * (1 + g / (1 - g) * (1 - np.exp(-(1 - g) * 4 / tau)))) - 1)
    assert abs(errors[1]) < 1e-4
    assert abs(errors[1]) < 0.1 * abs(errors[0]) + 2e-6


def test_sphere(run_deck: RunDeck, tmp_path: Path) -> None:
    """A thick sphere under internal pressure whose bulk modulus does not relax: u = p a^3/(b^3 - a^3) (r/(3 K) + b^3/(4 G(t) r^2))."""
    a, b, pressure, g, tau, n, m = 1.0, 2.0, 10.0, 0.5, 1.0, 10, 12
    bulk, shear = YOUNG / (3 * (1 - 2 * POISSON)), YOUNG / (2 * (1 + POISSON))
    radii, angles = np.linspace(a, b, 2 * n + 1), np.linspace(0, np.pi / 2, 2 * m + 1)
    label = {(i, j): 1 + i * (2 * m + 1) + j for i in range(2 * n + 1) for j in range(2 * m + 1)}
    nodes = "".join(f"{k}, {radii[i] * np.cos(angles[j]):.12g}, {radii[i] * np.sin(angles[j]):.12g}\n" for (i, j), k in label.items())
    corners = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    elements = "".join(f"{1 + e * m + f}, " + ", ".join(str(label[2 * e + x, 2 * f + y]) for x, y in corners) + "\n" for e in range(n) for f in range(m))
    inner = "".join(f"{1 + f}, P4, {pressure}\n" for f in range(m))
    low = "".join(f"{label[i, 0]}, 2\n" for i in range(2 * n + 1))
    axis = "".join(f"{label[i, 2 * m]}, 1\n" for i in range(2 * n + 1))
    deck = f"*NODE\n{nodes}*ELEMENT, TYPE=CAX8R, ELSET=ALL\n{elements}*NSET, NSET=HERE\n{label[0, 0]}, {label[2 * n, 0]}\n"
    deck += f"*MATERIAL, NAME=M\n*ELASTIC, MODULI=INSTANTANEOUS\n{YOUNG}, {POISSON}\n*VISCOELASTIC, TIME=PRONY\n{g}, 0., {tau}\n"
    deck += f"*SOLID SECTION, ELSET=ALL, MATERIAL=M\n*BOUNDARY\n{low}{axis}*STEP\n*STATIC\n1., 1.\n*DLOAD\n{inner}*NODE PRINT, NSET=HERE\nU\n*END STEP\n"
    run(run_deck, deck + "*STEP, INC=200\n*VISCO, DIRECT\n0.1, 3.\n*NODE PRINT, NSET=HERE\nU\n*END STEP\n")
    tables = read_dat(tmp_path / "job.dat")
    for table, time in ((tables[0], 0.0), (tables[-1], 3.0)):
        compliance = (1 + g / (1 - g) * (1 - np.exp(-(1 - g) * time / tau))) / shear
        for row, r in zip(table.rows.values(), (a, b), strict=True):
            assert row[0] == pytest.approx(pressure * a**3 / (b**3 - a**3) * (r / (3 * bulk) + b**3 * compliance / (4 * r * r)), rel=1e-3)


@pytest.mark.parametrize("law", ["*HYPERELASTIC, NEO HOOKE, MODULI=INSTANTANEOUS\n50., 1E-5\n", "*HYPERELASTIC, OGDEN, N=1, MODULI=INSTANTANEOUS\n100., 3., 1E-5\n"])
def test_rubber(run_deck: RunDeck, tmp_path: Path, law: str) -> None:
    """Rubber stretched by a half at once and held: the force relaxes as the shear modulus, for the volume hardly changes."""
    series = "*VISCOELASTIC, TIME=PRONY\n" + "".join(f"{g}, 0., {tau}\n" for g, tau in SERIES)
    steps = f"*STEP, NLGEOM\n*STATIC\n0.25, 1.\n*BOUNDARY\nZ1, 3, 3, 0.5\n{PRINT}*STEP, NLGEOM\n*VISCO, DIRECT\n1.25, 5.\n{PRINT}"
    run(run_deck, bar(law + series, steps))
    forces = np.array(totals(tmp_path))[-5:]
    factors = np.array([1 - sum(g * (1 - np.exp(-t / tau)) for g, tau in SERIES) for t in (0, 1.25, 2.5, 3.75, 5.0)])
    assert forces == pytest.approx(forces[0] * factors, rel=5e-4), "shear over bulk modulus: 100 over 2e5"
    if "NEO HOOKE" in law:
        assert forces[0] == pytest.approx(2 * 50.0 * (1.5 - 1.5**-2), rel=1e-3)


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
@pytest.mark.parametrize("law", [elastic(""), "*HYPERELASTIC, NEO HOOKE\n80., 1e-3\n*VISCOELASTIC, TIME=PRONY\n0.3, 0., 0.5\n0.4, 0., 7.\n"])
def test_relaxation_is_no_snap(run_deck: RunDeck, law: str, nlgeom: str) -> None:
    """A stable bar under a constant force that lengthens when it relaxes, and its load, are not reported as snaps: what relaxes takes
    energy."""
    steps = f"*STEP{nlgeom}\n*STATIC\n0.2, 1.\n*CLOAD\nZ1, 3, 3.\n*END STEP\n*STEP{nlgeom}\n*STATIC, LONG TERM\n0.2, 1.\n*END STEP\n"
    done = run_deck(bar(law, steps))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "snapped" not in done.stdout + done.stderr
