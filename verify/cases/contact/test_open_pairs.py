"""A pair that stays open, elsewhere on the bodies of a stack, changes nothing: neither the stiffness of its slave faces nor the rows of other pairs.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.make_decks import Floats, block
from verify.decks.solids import as_kind

TYPES = {"n2s": "NODE TO SURFACE", "s2s": "SURFACE TO SURFACE"}
FAR = {"slave": ("B_X1", "F_X0"), "master": ("F_X0", "B_X1"), "below": ("A_X1", "F_X0"), "above": ("C_X1", "F_X0")}
EQUAL = 1e-7  #: of the largest displacement; residuals are below 1e-9 of the forces


def body(name: str, kind: str, first: int, cells: tuple[int, int, int], low: tuple[float, ...], high: tuple[float, ...]) -> str:
    """A block with a node set and a surface for each side."""
    mesh = as_kind(block(*(np.linspace(low[k], high[k], cells[k] + 1) for k in range(3)), name=name), kind)
    text = "*NODE\n" + "".join(f"{first + i}, {x:.12g}, {y:.12g}, {z:.12g}\n" for i, (x, y, z) in enumerate(mesh.nodes))
    text += f"*ELEMENT, TYPE={kind}, ELSET={name}\n"
    for e, row in enumerate(mesh.elements):
        labels = [str(first + e), *(str(first + n) for n in row)]
        text += ", ".join(labels[:11]) + (",\n" + ", ".join(labels[11:]) if len(labels) > 11 else "") + "\n"
    for axis in range(3):
        for end, place in enumerate((low[axis], high[axis])):
            members = mesh.where(axis, place)
            text += f"*NSET, NSET={name}N_{'XYZ'[axis]}{end}\n" + "".join(f"{first + n}\n" for n in members)
            text += f"*SURFACE, NAME={name}_{'XYZ'[axis]}{end}\n" + "".join(f"{first + e}, S{f}\n" for e, f in mesh.outer_faces(members))
    return text + f"*SOLID SECTION, ELSET={name}, MATERIAL=M\n"


def stack(kinds: tuple[str, ...], form: str, far: tuple[str, str] | None, slaves: tuple[str, str], *, is_nlgeom: bool) -> str:
    """Three coarse blocks, each overhanging the one below on one side, pressed and dragged by the top one: they come apart on one side. With a third pair of a fixed block."""
    text = "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n"
    text += body("A", kinds[0], 10001, (2, 2, 1), (0, 0, 0), (2, 1, 0.5)) + body("B", kinds[1], 20001, (2, 1, 1), (0.4, 0, 0.5), (2.2, 1, 0.8))
    text += body("C", kinds[2], 30001, (1, 1, 1), (0.7, 0, 0.81), (1.9, 1, 1.2)) + body("F", "C3D8", 40001, (1, 2, 2), (3.2, 0, 0), (3.8, 1, 1.3))
    text += "*SURFACE INTERACTION, NAME=I\n*FRICTION\n0.2\n"
    pairs = [("A_Z1", "B_Z0") if slaves[0] == "A" else ("B_Z0", "A_Z1"), ("C_Z0", "B_Z1") if slaves[1] == "C" else ("B_Z1", "C_Z0"), *([far] if far else [])]
    text += "".join(f"*CONTACT PAIR, INTERACTION=I, TYPE={form}\n{slave}, {master}\n" for slave, master in pairs)
    text += f"*STEP{', NLGEOM' if is_nlgeom else ''}\n*STATIC\n.25, 1., , .25\n*CONTROLS, PARAMETERS=FIELD\n1e-9, 1e-6\n"
    text += "*BOUNDARY\nAN_Z0, 1, 3\nFN_X1, 1, 3\nBN_X0, 1, 2\nCN_Z1, 2\nCN_Z1, 1, 1, 0.01\nCN_Z1, 3, 3, -0.03\n"
    return text + "*END STEP\n"


def solve(run: Run, folder: Path, name: str, deck: str) -> tuple[Floats, int]:
    """Displacements and how many slave nodes of the first two pairs are closed at the end."""
    (folder / f"{name}.inp").write_text(deck)
    done = run(["--outdir", folder, folder / f"{name}.inp"], folder)
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(folder / f"{name}.vtkhdf") as file:
        pair = np.asarray(file["AMONTONS/contact/pair"])
        status = np.asarray(file["AMONTONS/contact/status"])[-len(pair) :]
        assert not status[pair == 2].any(), "the far pair stays open"
        return np.asarray(file["VTKHDF/PointData/U"])[-int(file["VTKHDF/NumberOfPoints"][-1]) :], int(np.count_nonzero(status[pair < 2]))


@pytest.mark.parametrize("is_nlgeom", [False, True])
@pytest.mark.parametrize(("slaves", "kind"), [(("A", "B"), "C3D20"), (("B", "C"), "C3D10"), (("B", "C"), "C3D15"), (("A", "B"), "C3D10")])
@pytest.mark.parametrize("form", TYPES)
def test_far_pair(run: Run, tmp_path: Path, form: str, kind: str, slaves: tuple[str, str], *, is_nlgeom: bool) -> None:
    """The displacements are those without the third pair, on whichever body it is and whichever side is its slave."""
    kinds = (kind, kind, kind)
    plain, n_closed = solve(run, tmp_path, "plain", stack(kinds, TYPES[form], None, slaves, is_nlgeom=is_nlgeom))
    assert n_closed > 0
    for name, far in FAR.items():
        other, _ = solve(run, tmp_path, name, stack(kinds, TYPES[form], far, slaves, is_nlgeom=is_nlgeom))
        assert np.abs(other - plain).max() <= EQUAL * np.abs(plain).max(), name
