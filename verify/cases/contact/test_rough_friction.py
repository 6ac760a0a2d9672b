"""Surfaces that never slip (*FRICTION, ROUGH) and that are pulled until they separate.

A node that sticks can be drawn off its master by its own friction, and be pressed into it as soon as it is released: no status of
the two is then an equilibrium. It is released, slides to the frictionless equilibrium, and sticks there again.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.cases.contact import test_mortar
from verify.conftest import Run
from verify.decks import make_decks, solids
from verify.decks.sheets import between

PRESSED = 0.1  # of the foot of the springs, into the plate
ACROSS, ALONG = 1.0, 1.5  # K_xz, K_xx = K_zz of the springs between node 1 and its foot
LOST = ALONG - ACROSS**2 / ALONG  # stiffness along z where x is free

#: A node on a plate; a spring at 45 degrees of stiffness 2 and two of 1/2 along the axes lead to a foot that is moved.
NODE_ON_PLATE = """*NODE
1, 0., 0., 0.
2, 1., 0., 1.
11, -4., -4., -1.
12, 4., -4., -1.
13, 4., 4., -1.
14, -4., 4., -1.
15, -4., -4., 0.
16, 4., -4., 0.
17, 4., 4., 0.
18, -4., 4., 0.
*ELEMENT, TYPE=C3D8, ELSET=PLATE
1, 11, 12, 13, 14, 15, 16, 17, 18
*ELEMENT, TYPE=SPRINGA, ELSET=TILTED
2, 1, 2
*ELEMENT, TYPE=SPRING2, ELSET=X
3, 1, 2
*ELEMENT, TYPE=SPRING2, ELSET=Y
4, 1, 2
*ELEMENT, TYPE=SPRING2, ELSET=Z
5, 1, 2
*SPRING, ELSET=TILTED

2.
*SPRING, ELSET=X
1, 1
0.5
*SPRING, ELSET=Y
2, 2
0.5
*SPRING, ELSET=Z
3, 3
0.5
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET=PLATE, MATERIAL=M
*SURFACE, NAME=TOP
1, S2
*SURFACE, NAME=TIP, TYPE=NODE
1, 1.
*SURFACE INTERACTION, NAME=I
*FRICTION, ROUGH
*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE
TIP, TOP
*NSET, NSET=HELD, GENERATE
11, 18, 1
*BOUNDARY
HELD, 1, 3
2, 2, 2
"""


def step(along: float, increment: float) -> str:
    """The foot of the springs goes to this place along x, and stays pressed."""
    return f"*STEP\n*STATIC, DIRECT\n{increment}, 1.\n*BOUNDARY\n2, 1, 1, {along}\n2, 3, 3, {-PRESSED}\n*END STEP\n"


@pytest.mark.parametrize(("drag", "increment", "place", "force"), [
    (0.1, 1.0, 0.0, 0.05),             # it sticks: N = K_zz p - K_xz s
    (0.1, 0.25, 0.0, 0.05),
    (0.3, 1.0, 0.3 - ACROSS / ALONG * PRESSED, LOST * PRESSED),   # released from sticking: N = (K_zz - K_xz^2/K_xx) p
    (0.2, 0.5, 0.2 - ACROSS / ALONG * PRESSED, LOST * PRESSED),   # sticks at s = 0.1; in the second increment it loses it
    (-0.3, 1.0, 0.0, 0.45),            # drawn in the opposite direction it is pressed more
])  # fmt: skip
def test_release_from_sticking(run_deck: Run, tmp_path: Path, drag: float, increment: float, place: float, force: float) -> None:
    """A node on springs that pull it up as they are drawn along: where N would be negative it slides to where T is 0."""
    done = run_deck("** dialect: abaqus\n" + NODE_ON_PLATE + step(0.0, 1.0) + step(drag, increment))
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        data = file["VTKHDF/PointData"]
        offset = file["VTKHDF/Steps/PointDataOffsets/U"][-1]
        displacement = data["U"][offset]
        reaction = data["RF"][offset + 1]
    assert displacement == pytest.approx([place, 0.0, 0.0], abs=1e-9)
    drawn = np.array([drag - place, -PRESSED])
    expected = np.array([[ALONG, ACROSS], [ACROSS, ALONG]]) @ drawn
    assert -expected[1] == pytest.approx(force, abs=1e-12)
    assert reaction == pytest.approx([expected[0], 0.0, expected[1]], abs=1e-9)


def sheared(kind: str, contact: str) -> str:
    """A block on a larger one, 0.02 apart and brought together by ADJUST, pressed by 0.01 and sheared by 0.05."""
    bodies = [
        solids.as_kind(make_decks.block(between(x, x + size, 3), between(y, y + size, 3), between(z, z + 0.6, 2), "BODY"), kind)
        for x, y, z, size in ((0.0, 0.0, 0.02, 1.0), (-0.2, -0.3, -0.6, 1.7))
    ]
    upper, lower = bodies
    n = len(upper.nodes)
    top = upper.where(2, 0.62)
    bottom = n + lower.where(2, -0.6)
    cards = (
        test_mortar.renumbered(upper, 0, 0, "ABOVE") + test_mortar.renumbered(lower, n, len(upper.elements), "BELOW")
        + "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n"
        + "".join(f"*SOLID SECTION, ELSET={name}, MATERIAL=M\n" for name in ("ABOVE", "BELOW"))
        + "*SURFACE, NAME=SLAVE\n" + test_mortar.faces_at(upper, lambda x: np.full(len(x), 0.02), 0)
        + "*SURFACE, NAME=MASTER\n" + test_mortar.faces_at(lower, lambda x: np.zeros(len(x)), len(upper.elements))
        + "*SURFACE INTERACTION, NAME=I\n*FRICTION, ROUGH\n"
        + f"*CONTACT PAIR, INTERACTION=I, TYPE={contact}, ADJUST=0.03\nSLAVE, MASTER\n"
        + solids.node_set("TOP", top) + solids.node_set("BOTTOM", bottom)
        + "*BOUNDARY\nBOTTOM, 1, 3\n"
    )  # fmt: skip
    for drag in (0.0, 0.05):
        cards += f"*STEP, NLGEOM\n*STATIC\n0.25, 1.\n*BOUNDARY\nTOP, 1, 1, {drag}\nTOP, 2, 2\nTOP, 3, 3, -0.01\n*END STEP\n"
    return cards


def test_sheared_block(run_deck: Run, tmp_path: Path) -> None:
    """Nodes at the lifting edge lose their grip one after the other; C3D10 surface to surface failed at 64 % of the shear. The forces
    are those of C3D20R by nodes."""
    forces = {}
    for kind, contact in (("C3D10", "SURFACE TO SURFACE"), ("C3D20R", "NODE TO SURFACE")):
        done = run_deck("** dialect: abaqus\n" + sheared(kind, contact))
        assert done.returncode == 0, done.stdout + done.stderr
        if kind == "C3D10":
            assert int(re.search(r"attempts that failed\s+(\d+)", done.stdout)[1]) == 0
            assert int(re.search(r"Newton iterations\s+(\d+)", done.stdout)[1]) <= 40
        with h5py.File(tmp_path / "job.vtkhdf") as file:
            data = file["VTKHDF/PointData"]
            offset = file["VTKHDF/Steps/PointDataOffsets/U"][-1]
            place = file["VTKHDF/Points"][:]
            top = np.flatnonzero(np.abs(place[:, 2] - 0.62) < 1e-9)
            forces[kind] = data["RF"][offset:][top].sum(axis=0)
            assert np.all(data["CPRESS"][offset:] > -1e-9)
    scale = np.abs(forces["C3D20R"]).max()
    assert forces["C3D10"] == pytest.approx(forces["C3D20R"], abs=0.02 * scale)
