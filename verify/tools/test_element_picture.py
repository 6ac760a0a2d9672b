"""The faces that the manual's picture names are those of the program.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.tools.element_picture import FACES, PLACES, main


@pytest.mark.parametrize("kind", PLACES)
def test_faces(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """A pressure on face k pushes with the area of that face against its outward normal; one step a face, all nodes held."""
    x = np.array([(*place, 0.0)[:3] for place in PLACES[kind]], dtype=float)
    nodes = "".join(f"{i}, {', '.join(map(str, place))}\n" for i, place in enumerate(PLACES[kind], 1))
    head = (f"*NODE, NSET=ALL\n{nodes}*ELEMENT, TYPE={kind}, ELSET=E\n1, {', '.join(str(i + 1) for i in range(len(x)))}\n"
            "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n*SOLID SECTION, ELSET=E, MATERIAL=M\n1.\n*BOUNDARY\nALL, 1, 3\n")  # fmt: skip
    head = head.replace("ALL, 1, 3", "ALL, 1, 2") if kind.startswith("CP") else head
    steps = "".join(f"*STEP\n*STATIC\n1., 1.\n*DLOAD, OP=NEW\nE, P{k}, 1.\n*END STEP\n" for k in range(1, len(FACES[kind]) + 1))
    done = run_deck(head + steps, "--quiet")
    assert done.returncode == 0, done.stdout
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        history = file["AMONTONS/history"]
        rows = {int(step): force for step, force in zip(history["step"][:], history["applied_force"][:], strict=True)}
    for k, face in enumerate(FACES[kind], 1):
        corners = x[np.array(face) - 1]
        if len(face) == 2:
            along = corners[1] - corners[0]
            normal = np.array([along[1], -along[0], 0.0])
        else:
            normal = sum(np.cross(corners[i] - corners[0], corners[i + 1] - corners[0]) for i in range(1, len(face) - 1)) / 2
        outward = normal * np.sign(normal @ (corners.mean(axis=0) - x.mean(axis=0)))
        np.testing.assert_allclose(rows[k], -outward, atol=1e-12, err_msg=f"S{k}")


def test_picture_is_drawn(tmp_path: Path) -> None:
    """The script that makes it runs."""
    assert main(["--output", str(tmp_path / "elements.png")]) == 0
    assert (tmp_path / "elements.png").stat().st_size > 10_000
