"""Beams of a part whose instance is rotated: the first direction of their section turns with the part.

Reference: the same part without a rotation; displacements and loads turn with it. The sections are stiffer along one direction.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import pytest

from verify.conftest import Run
from verify.readers.dat_frd_files import read_dat

DIGITS = 4e-6  # seven digits are printed
LOADS = (3.0, 1.0, -2.0)
PLACE = "10., 20., 30.\n10., 20., 30., 10., 20., 31., 90.\n"  # about z: x to y, y to -x
SECTIONS = {
    "given": "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=RECT\n0.3, 0.8\n0., 1., 0.\n",
    "default": "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=RECT\n0.3, 0.8\n",
    "stiffness": "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=I\n0.4, 0.8, 0.4, 0.2, 0.05, 0.05, 0.04\n0., 1., 0.2\n",
    "walls": "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=ARBITRARY\n2, 0., 0., 0.5, 0., 0.04\n0.5, 0.8, 0.04\n0., 1., 0.\n",
    "numbers": "*BEAM GENERAL SECTION, ELSET=E, SECTION=GENERAL\n0.1, 0.02, 0., 0.005, 0.01\n0., 1., 0.\n1e5, 4e4\n",
}


def tip(run_deck: Run, tmp_path: Path, section: str, place: str, forces: tuple[float, float, float]) -> list[float]:
    """The displacements of the end of a cantilever along x of its part."""
    part = "*PART, NAME=P\n*NODE\n" + "".join(f"{i + 1}, {i}.\n" for i in range(5)) + "*ELEMENT, TYPE=B31, ELSET=E\n"
    part += "".join(f"{i + 1}, {i + 1}, {i + 2}\n" for i in range(4)) + section + "*END PART\n"
    assembly = f"*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n{place}*END INSTANCE\n*NSET, NSET=END, INSTANCE=I\n5\n"
    assembly += "*NSET, NSET=FOOT, INSTANCE=I\n1\n*END ASSEMBLY\n*MATERIAL, NAME=M\n*ELASTIC\n1e5, 0.25\n"
    loads = "*STEP\n*STATIC\n*CLOAD\n" + "".join(f"END, {k + 1}, {f}\n" for k, f in enumerate(forces)) + "*NODE PRINT, NSET=END\nU\n*END STEP\n"
    done = run_deck(part + assembly + "*BOUNDARY\nFOOT, 1, 6\n" + loads)
    assert done.returncode == 0, done.stdout
    return list(next(iter(read_dat(tmp_path / "job.dat")[-1].rows.values())))


@pytest.mark.parametrize("name", SECTIONS)
def test_directions_turn_with_the_part(run_deck: Run, tmp_path: Path, name: str) -> None:
    """The end moves as in the part, in turned axes; held in global axes it would bend about the other direction."""
    u = tip(run_deck, tmp_path, SECTIONS[name], "", LOADS)
    turned = tip(run_deck, tmp_path, SECTIONS[name], PLACE, (-LOADS[1], LOADS[0], LOADS[2]))
    size = max(map(abs, u))
    assert turned[:3] == pytest.approx([-u[1], u[0], u[2]], abs=DIGITS * size)


def test_the_default_turns_out_of_the_part(run_deck: Run, tmp_path: Path) -> None:
    """Turned about x by a right angle, a section without a direction is stiff across the one of the part."""
    u = tip(run_deck, tmp_path, SECTIONS["default"], "", (0.0, 1.0, 0.0))
    turned = tip(run_deck, tmp_path, SECTIONS["default"], "0., 0., 0.\n0., 0., 0., 1., 0., 0., 90.\n", (0.0, 0.0, 1.0))
    assert turned[2] == pytest.approx(u[1], rel=DIGITS)
