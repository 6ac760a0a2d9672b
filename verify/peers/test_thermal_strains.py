"""Thermal strains under large displacements, against closed forms and against CalculiX itself (ccx), which takes them off F.

A warm body stretches freely by 1 + e. Here the rest of the deformation is F/(1 + e); CalculiX 2.20 has Green's strain of F - e, which is not
that of F R for a rotation R, and its plastic law gives the stress of a body that has not swollen.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import math
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from verify.decks.solids import unit_cube
from verify.peers.test_mixed_decks import tables_by_both
from verify.readers.dat_frd_files import Block

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")

Run = Callable[..., subprocess.CompletedProcess[str]]
E, NU, YIELD, WARMED = 210000.0, 0.3, 250.0, 1000.0


def model(expansion: float, cards: str = "") -> str:
    """A cube at rest at 20 degrees."""
    return (unit_cube("N") + f"*MATERIAL, NAME=M\n*ELASTIC\n{E}, {NU}\n*EXPANSION\n{expansion}\n{cards}*SOLID SECTION, ELSET=E, MATERIAL=M\n"
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nN, 20.\n")


def stress(blocks: list[Block]) -> float:
    """S11 of the first point at the end."""
    return list([block for block in blocks if block.title == "stresses"][-1].rows.values())[0][0]


@pytest.mark.parametrize("angle", [30, 90])
def test_warm_body_that_turns(run_deck: Run, tmp_path: Path, angle: int) -> None:
    """A free body has no stress; in CalculiX that of Green's strain of (1 + e) R - e: E e (1 - cos) / ((1 + nu) (1 - 2 nu))."""
    e = 1.2e-5 * WARMED
    c, s = (1 + e) * math.cos(math.radians(angle)), (1 + e) * math.sin(math.radians(angle))
    text = model(1.2e-5) + f"*STEP, NLGEOM\n*STATIC\n*TEMPERATURE\nN, {20 + WARMED}\n*BOUNDARY\n"
    for line in unit_cube("N").splitlines()[1:9]:
        n, x, y, z = (float(word) for word in line.split(","))
        text += "".join(f"{int(n)}, {k}, {k}, {u:.12g}\n" for k, u in enumerate((c * x - s * y - x, s * x + c * y - y, e * z), 1))
    ours, theirs = tables_by_both(run_deck, tmp_path, text + "*EL PRINT, ELSET=E\nS\n*END STEP\n")
    there = E * e * (1 - math.cos(math.radians(angle))) / ((1 + NU) * (1 - 2 * NU))
    assert stress(ours) == pytest.approx(0.0, abs=1e-6 * there)
    assert stress(theirs) == pytest.approx(there, rel=1e-5)


@pytest.mark.parametrize("expansion", [1.2e-5, 5e-5])
def test_warm_body_that_yields(run_deck: Run, tmp_path: Path, expansion: float) -> None:
    """A bar held at its ends, of constant yield stress: -250, and the plastic strain ln(1 + e).

    In CalculiX F - e is 1 - e along the bar and keeps the volume: its S = J s / (1 - e)^2 gives the stress s / ((1 - e) e + sqrt(1 - e))^2.
    """
    e = expansion * WARMED
    text = model(expansion, f"*PLASTIC\n{YIELD}, 0.\n{YIELD}, 1.\n") + "*BOUNDARY\n1, 1, 3\n4, 1\n5, 1, 2\n8, 1\n2, 2, 3\n6, 2\n3, 3\n4, 3\n2, 1\n3, 1\n6, 1\n7, 1\n"
    text += f"*STEP, NLGEOM, INC=200\n*STATIC, DIRECT\n.01, 1.\n*TEMPERATURE\nN, {20 + WARMED}\n*EL PRINT, ELSET=E, FREQUENCY=100\nS, PEEQ\n*END STEP\n"
    ours, theirs = tables_by_both(run_deck, tmp_path, text)
    assert stress(ours) == pytest.approx(-YIELD, rel=1e-5)
    assert stress(theirs) == pytest.approx(-YIELD / ((1 - e) * e + math.sqrt(1 - e)) ** 2, rel=1e-4)
    strains = [list(blocks[-1].rows.values())[0][0] for blocks in (ours, theirs)]
    assert strains[0] == pytest.approx(math.log(1 + e) - YIELD / E, rel=2e-3)
    assert strains[1] == pytest.approx(-math.log(1 - e) - YIELD / E, rel=2e-3)


def test_held_rubber(run_deck: Run, tmp_path: Path) -> None:
    """A cube of rubber of the volumetric energy (J - 1)^2/D, held on all sides: the stress 2/D (J - 1) J, J = 1/(1 + e)^3.

    In CalculiX F - e is 1 - e: the second Piola-Kirchhoff stress 2/D (J - 1) J/(1 - e)^2 with J = (1 - e)^3.
    """
    e, d = 0.01, 0.001
    text = model(e / WARMED).replace(f"*ELASTIC\n{E}, {NU}\n", f"*HYPERELASTIC, NEO HOOKE\n500., {d}\n")
    text += f"*BOUNDARY\nN, 1, 3\n*STEP, NLGEOM\n*STATIC\n*TEMPERATURE\nN, {20 + WARMED}\n*EL PRINT, ELSET=E\nS\n*END STEP\n"
    ours, theirs = tables_by_both(run_deck, tmp_path, text)
    assert stress(ours) == pytest.approx(2 / d * ((1 + e) ** -3 - 1) * (1 + e) ** -3, rel=1e-5)
    assert stress(theirs) == pytest.approx(2 / d * ((1 - e) ** 3 - 1) * (1 - e), rel=1e-5)
