"""Axes element by element in a part: bars of an orthotropic material, pulled along one of its axes.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.readers.dat_frd_files import read_dat

MODULI = (1000.0, 500.0, 200.0)  #: along the axes 1, 2, 3 of the material
STRAIN = 1e-3
CUBES = "".join(
    f"*NODE\n{', '.join(map(str, (8 * k + i, 3 * k + x, y, z)))}\n"
    for k in range(3)
    for i, (x, y, z) in enumerate([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], 1)
)
ELEMENTS = "*ELEMENT, TYPE=C3D8, ELSET=E\n" + "".join(f"{k + 1}, {', '.join(str(8 * k + i) for i in range(1, 9))}\n" for k in range(3))
#: along z lies axis 3 by default, axis 1 in element 2, axis 2 in the set of element 3
ROWS = ", 1., 0., 0., 0., 1., 0.\n2, 0., 0., 1., 1., 0., 0.\nTHIRD, 0., 1., 0., 0., 0., 1.\n"
#: the same by cylinders, whose axes 1, 2, 3 point away from, around and along a line so far away that they hardly turn in an element
CYLINDERS = ", 0., .5, .5, 0., .5, 1.5\n2, 0., .5, -1e4, 1., .5, -1e4\nTHIRD, 0., -1e4, .5, 1., -1e4, .5\n"


def deck(placement: str, direction: int, *, is_cylindrical: bool) -> str:
    """Three cubes in an instance, each pulled along z of the part, which is a direction of the model."""
    text = "*PART, NAME=P\n" + CUBES + ELEMENTS + "*ELSET, ELSET=THIRD\n3,\n*NSET, NSET=FOOT\n1, 2, 3, 4, 9, 10, 11, 12, 17, 18, 19, 20\n"
    text += "".join(f"*NSET, NSET=HEAD{k + 1}\n{', '.join(str(8 * k + i) for i in range(5, 9))}\n" for k in range(3))
    text += "*NSET, NSET=CORNERS\n1, 9, 17\n*NSET, NSET=BESIDE\n2, 10, 18\n"
    text += f"*ORIENTATION, NAME=AXES{', SYSTEM=CYLINDRICAL' if is_cylindrical else ''}\nGRAIN\n3, 0.\n*DISTRIBUTION TABLE, NAME=TABLE\nCOORD3D, COORD3D\n"
    text += "*DISTRIBUTION, NAME=GRAIN, LOCATION=ELEMENT, TABLE=TABLE\n" + (CYLINDERS if is_cylindrical else ROWS)
    text += "*SOLID SECTION, ELSET=E, MATERIAL=M, ORIENTATION=AXES\n*END PART\n*ASSEMBLY, NAME=A\n"
    text += "*INSTANCE, NAME=FIRST, PART=P\n100., 0., 0.\n*END INSTANCE\n"
    text += f"*INSTANCE, NAME=SECOND, PART=P\n{placement}*END INSTANCE\n*END ASSEMBLY\n"
    text += "*MATERIAL, NAME=M\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n" + ", ".join(map(str, MODULI)) + ", 0., 0., 0., 100., 90.\n80.\n"
    text += "*STEP\n*STATIC\n*BOUNDARY\n"
    for name, along in (("FIRST", 3), ("SECOND", direction)):
        text += f"{name}.FOOT, 1, 3\n" + "".join(f"{name}.HEAD{k}, {along}, {along}, {STRAIN}\n" for k in (1, 2, 3))
    text += "".join(f"*NODE PRINT, NSET={name}.HEAD{k}, TOTALS=ONLY\nRF\n" for name in ("FIRST", "SECOND") for k in (1, 2, 3))
    return text + "*END STEP\n"


@pytest.mark.parametrize("is_cylindrical", [False, True])
@pytest.mark.parametrize(("placement", "direction"), [
    ("", 3),
    ("0., 20000., 10000.\n", 3),
    ("0., 20000., 10000.\n0., 0., 0., 0., 1., 0., 90.\n", 1),
])  # fmt: skip
def test_bars(run_deck: Run, tmp_path: Path, placement: str, direction: int, *, is_cylindrical: bool) -> None:
    """Without lateral contraction the force is E strain, E of the axis along the bar, in both instances, however they lie."""
    done = run_deck(deck(placement, direction, is_cylindrical=is_cylindrical))
    assert done.returncode == 0, done.stdout + done.stderr
    forces = [[float(x) for x in line.split()[-3:]] for line in re.findall(r"total force.*\n\s*\n(.*)", (tmp_path / "job.dat").read_text())]
    expected = [MODULI[2], MODULI[0], MODULI[1]]
    assert len(forces) == 6, (tmp_path / "job.dat").read_text()
    for k in range(3):
        assert forces[k][2] == pytest.approx(expected[k] * STRAIN, rel=1e-6)
        assert forces[3 + k][direction - 1] == pytest.approx(expected[k] * STRAIN, rel=1e-6)


@pytest.mark.parametrize("placement", ["", "0., 2., 1.\n0., 0., 0., 1., 0., 0., 90.\n"])
def test_angles(run_deck: Run, tmp_path: Path, placement: str) -> None:
    """Angles element by element about axis 2, which lies across the bar along z: its modulus off the axes of the material is
    1/E = c^4/E3 + s^4/E1 + c^2 s^2/G13 (R. M. Jones, Mechanics of Composite Materials, section 2.7; nu = 0). The bars contract and
    shear freely."""
    angles = {1: 0.0, 2: 90.0, 3: 30.0}
    text = "*PART, NAME=P\n" + CUBES + ELEMENTS + "*ELSET, ELSET=THIRD\n3,\n"
    text += "".join(f"*NSET, NSET=HEAD{k + 1}\n{', '.join(str(8 * k + i) for i in range(5, 9))}\n" for k in range(3))
    text += "*NSET, NSET=A\n1, 9, 17\n*NSET, NSET=B\n2, 10, 18\n*NSET, NSET=C\n3, 11, 19\n*NSET, NSET=D\n4, 12, 20\n"
    text += "*ORIENTATION, NAME=AXES\n1., 0., 0., 0., 1., 0.\n2, TURN\n*DISTRIBUTION TABLE, NAME=TABLE\nANGLE\n"
    text += f"*DISTRIBUTION, NAME=TURN, LOCATION=ELEMENT, TABLE=TABLE\n, {angles[1]}\n2, {angles[2]}\nTHIRD, {angles[3]}\n"
    text += "*SOLID SECTION, ELSET=E, MATERIAL=M, ORIENTATION=AXES\n*END PART\n*ASSEMBLY, NAME=S\n"
    text += f"*INSTANCE, NAME=I, PART=P\n{placement}*END INSTANCE\n*END ASSEMBLY\n"
    text += "*MATERIAL, NAME=M\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n" + ", ".join(map(str, MODULI)) + ", 0., 0., 0., 100., 90.\n80.\n"
    along, side, sign = (2, 3, -1) if placement else (3, 2, 1)  # z and y of the part in the model; x stays
    text += f"*STEP\n*STATIC\n*BOUNDARY\nI.A, 1, 3\nI.B, {side}, {side}\n" + "".join(f"I.{n}, {along}, {along}\n" for n in "BCD")
    text += "*CLOAD\n" + "".join(f"I.HEAD{k}, {along}, {sign * 0.25}\n" for k in (1, 2, 3))
    text += "".join(f"*NODE PRINT, NSET=I.HEAD{k}\nU\n" for k in (1, 2, 3)) + "*END STEP\n"
    done = run_deck(text)
    assert done.returncode == 0, done.stdout + done.stderr
    blocks = [block for block in read_dat(tmp_path / "job.dat") if block.rows]
    assert len(blocks) == 3
    for k, block in enumerate(blocks, 1):
        s, c = np.sin(np.radians(angles[k])), np.cos(np.radians(angles[k]))
        compliance = s**4 / MODULI[0] + c**4 / MODULI[2] + c**2 * s**2 / 90.0
        for row in block.rows.values():
            assert sign * row[along - 1] == pytest.approx(compliance, rel=1e-6)
