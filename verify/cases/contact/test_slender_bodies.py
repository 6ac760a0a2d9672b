"""Slender bodies in contact: bending them stretches them for a moment, and Newton's iteration has to get over that.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.decks.parts import Part
from verify.readers.dat_frd_files import read_dat

Run = Callable[..., object]
LENGTH, HEIGHT, LOAD = 10.0, 0.5, 4.0
LAW = "*SURFACE INTERACTION, NAME=SI\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.E6\n"
PAIRS = ("NODE TO SURFACE", "SURFACE TO SURFACE", "MORTAR")


def beam_on_die(pair: str, gap: float, kind: str = "C3D8I") -> str:
    """A cantilever 10 x 1 x 0.5 under the forces of a uniform pressure, a die below its outer half; `pair` may be empty."""
    beam = Part("B", kind, (0, 0, gap), (LENGTH, 1, gap + HEIGHT), (10, 1, 1), 1001)
    die = Part("A", kind, (6, -0.2, -1), (9, 1.3, 0), (4, 2, 2))
    text = die.cards() + beam.cards() + "*MATERIAL, NAME=EL\n*ELASTIC\n210000., .3\n"
    text += "*SOLID SECTION, ELSET=A, MATERIAL=EL\n*SOLID SECTION, ELSET=B, MATERIAL=EL\n*BOUNDARY\nA_Z0N, 1, 3\nB_X0N, 1, 3\n"
    if pair:
        text += LAW + f"*CONTACT PAIR, INTERACTION=SI, TYPE={pair}\nB_Z0, A_Z1\n"
    shares = {n: 1.0 for n in beam.nodes_on("Z1") if beam.nodes[n - 1001][0] > 0}
    force = -LOAD * LENGTH / sum(shares.values())
    text += "*STEP, NLGEOM, INC=100\n*STATIC\n.1, 1.\n*CLOAD\n" + "".join(f"{n}, 3, {force * w:.12g}\n" for n, w in shares.items())
    return text + "*NODE PRINT, NSET=BN\nU\n*NODE PRINT, NSET=A_Z0N, TOTALS=ONLY\nRF\n*NODE PRINT, NSET=B_X0N, TOTALS=ONLY\nRF\n*END STEP\n"


def cost(output: str) -> tuple[int, int, int]:
    """Increments, failed attempts, iterations."""
    found = [re.search(rf"{words} +(\d+)", output) for words in ("increments converged", "attempts that failed", "Newton iterations")]
    made, failed, iterations = (int(m.group(1)) for m in found if m)
    return made, failed, iterations


@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
@pytest.mark.parametrize("pair", PAIRS)
def test_a_pair_that_never_touches(run_deck: Run, tmp_path: Path, pair: str, dialect: str) -> None:
    """A beam that bends by several times its height does so at the same cost with a die far below it as without one.

    (The line search once looked at the imbalance alone, which bending raises a hundredfold; no increment was short enough.)
    """
    results = []
    for kind in (pair, ""):
        result = run_deck(beam_on_die(kind, 20.0), f"--dialect={dialect}")
        assert result.returncode == 0, result.stdout + result.stderr  # type: ignore[attr-defined]
        results.append((cost(result.stdout), {key: row for key, row in read_dat(tmp_path / "job.dat")[-3].rows.items()}))  # type: ignore[attr-defined]
    assert results[0][0] == results[1][0]
    assert max(abs(v) for row in results[1][1].values() for v in row) > 1.5
    for key, row in results[1][1].items():
        assert results[0][1][key] == pytest.approx(row, abs=1e-7)


@pytest.mark.parametrize("kind", ["C3D8I", pytest.param("C3D10", marks=pytest.mark.slow)])
@pytest.mark.parametrize("pair", PAIRS)
def test_a_beam_that_comes_to_lie_on_a_die(run_deck: Run, tmp_path: Path, pair: str, kind: str) -> None:
    """It does so without a cut-back and in at most three iterations an increment; clamp and die take all of the load."""
    result = run_deck(beam_on_die(pair, 0.1, kind), "--dialect=calculix")
    assert result.returncode == 0, result.stdout + result.stderr  # type: ignore[attr-defined]
    made, failed, iterations = cost(result.stdout)  # type: ignore[attr-defined]
    assert failed == 0
    assert iterations <= 3 * made
    totals = [block for block in read_dat(tmp_path / "job.dat") if block.title == "total force"][-2:]
    die, clamp = (np.array(next(iter(block.rows.values()))) for block in totals)
    assert die[2] > 0.2 * LOAD * LENGTH
    assert die + clamp == pytest.approx([0, 0, LOAD * LENGTH], abs=1e-3 * LOAD * LENGTH)
