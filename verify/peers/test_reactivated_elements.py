"""Elements that *MODEL CHANGE adds free of strain where the mesh is stretched, against closed forms and CalculiX itself (ccx).

A cube that comes back at a stretch a and is drawn to b is, here, a cube of that shape that was never away: F = b/a. CalculiX 2.20 takes
Green's strain at a off that at b, both of the first mesh: nearly b a^2 times the stiffness.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import math
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from verify.cases.loads.test_model_change import BACK, COLUMNS, OUT
from verify.peers.test_mixed_decks import tables_by_both
from verify.readers.dat_frd_files import Block

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")

Run = Callable[..., subprocess.CompletedProcess[str]]
STIFFNESS = 30.0
C10, D1 = 5.0, 0.01
LAWS = {"elastic": f"*ELASTIC\n{STIFFNESS}, 0.\n", "rubber": f"*HYPERELASTIC, NEO HOOKE\n{C10}, {D1}\n"}


def stress_of_strain(law: str, green: float) -> float:
    """The second Piola-Kirchhoff stress along an axis of Green's strain along it alone."""
    if law == "elastic":
        return STIFFNESS * green
    c = 1 + 2 * green
    volume = math.sqrt(c)
    return 2 * C10 * c ** (-1 / 3) * (1 - (c + 2) / (3 * c)) + 2 / D1 * (volume - 1) * volume / c


def green(stretch: float) -> float:
    """Green's strain of a stretch."""
    return (stretch**2 - 1) / 2


def stress(blocks: list[Block], element: int) -> float:
    """S33 of the first point of an element at the end."""
    return [block for block in blocks if block.title == "stresses"][-1].rows[(element, 1)][2]


@pytest.mark.parametrize(("first", "second"), [(1.5, 1.8), (0.7, 0.6)])
@pytest.mark.parametrize("law", LAWS)
def test_added_where_the_mesh_is_stretched(run_deck: Run, tmp_path: Path, law: str, first: float, second: float) -> None:
    """Cauchy's stress of a lateral strain of zero: stretch times the second Piola-Kirchhoff stress."""
    model = COLUMNS.replace("*ELASTIC\n1000., 0.\n", LAWS[law]) + "MIDDLE, 3\n"
    text, step = model, "*STEP, NLGEOM\n*STATIC, DIRECT\n.5, 1.\n"
    for change, stretch in ((OUT, first), (BACK.format("=STRAIN FREE"), first), ("", second)):
        text += f"{step}{change}*BOUNDARY\nLID, 3, 3, {stretch - 1}\n*EL PRINT, ELSET=UPPER\nS\n*END STEP\n"
    ours, theirs = tables_by_both(run_deck, tmp_path, text)
    assert stress(ours, 2) == pytest.approx(second / first * stress_of_strain(law, green(second / first)), rel=1e-5)
    assert stress(theirs, 2) == pytest.approx(second * stress_of_strain(law, green(second) - green(first)), rel=1e-5)
