"""Body forces of axisymmetric elements by Abaqus's labels, against the resultants.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from verify.conftest import Run

RING = """** dialect: {dialect}
*NODE, NSET=ALL
1, 1., 0.
2, 3., 0.
3, 3., 2.
4, 1., 2.
*ELEMENT, TYPE=CAX4, ELSET=RING
1, 1, 2, 3, 4
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=RING, MATERIAL=M
*BOUNDARY
ALL, 1, 2
*STEP
*STATIC
*DLOAD
RING, {label}, 5.
*NODE PRINT, NSET=ALL, TOTALS=ONLY
RF
*END STEP
"""
VOLUME = math.pi * (3**2 - 1**2) * 2


@pytest.mark.parametrize(("label", "axis"), [("BR", 0), ("BX", 0), ("BZ", 1), ("BY", 1)])
def test_resultant(run_deck: Run, tmp_path: Path, label: str, axis: int) -> None:
    """The reactions balance the force, 5 per volume of the ring, in that direction alone."""
    done = run_deck(RING.format(dialect="abaqus", label=label))
    assert done.returncode == 0, done.stdout
    total = [float(word) for word in (tmp_path / "job.dat").read_text().split()[-3:]]
    assert total[axis] == pytest.approx(-5.0 * VOLUME, rel=1e-6)
    assert abs(total[1 - axis]) < 1e-9


def test_refused(run_deck: Run) -> None:
    """A radial force on elements that are not axisymmetric."""
    done = run_deck(RING.format(dialect="abaqus", label="BR").replace("CAX4", "CPE4"))
    assert done.returncode == 3
    assert "BR, a radial force per volume, is for axisymmetric elements." in re.sub(r"\s+", " ", done.stdout)
