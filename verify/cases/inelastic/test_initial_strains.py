"""Initial stresses and plastic strains of a material that can flow, below its yield stress and beyond: a bar against closed forms.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray

from verify.cases.inelastic.test_field_variables import N, bar, pull, step
from verify.conftest import Run

Floats = NDArray[np.float64]
E, NU = 210000.0, 0.3
METAL = f"*ELASTIC\n{E}, {NU}\n*PLASTIC\n300., 0.\n400., .05\n"
SECOND_ORDER = 2e-3  #: Green's and logarithmic strains of some 5e-4 differ by half of that


def rows(values: str, dialect: str) -> str:
    """Lines of *INITIAL CONDITIONS: of each point under calculix, of each element under abaqus."""
    points = "12345678" if dialect == "calculix" else ""
    return "".join(f"{e}, {p}, {values}\n" for e in range(1, N + 1) for p in points) or "".join(f"{e}, {values}\n" for e in range(1, N + 1))


def solve(run: Run, folder: Path, deck: str, dialect: str) -> tuple[Floats, Floats]:
    """Displacement of the far corner and stress of the first point, at the end."""
    (folder / "job.inp").write_text(deck)
    done = run([f"--dialect={dialect}", "--outdir", folder, folder / "job.inp"], folder)
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(folder / "job.vtkhdf") as file:
        n = int(file["VTKHDF/NumberOfPoints"][-1])
        u = np.asarray(file["VTKHDF/PointData/U"])[-n:]
        stress = np.asarray(file["VTKHDF/PointData/S"])[-n:]
        labels = file["AMONTONS/mesh/node_label"][:].tolist()
    return u[labels.index(19)], stress[0]


@pytest.mark.parametrize("option", ["", ", NLGEOM"])
@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
def test_stress_below_yield(run: Run, tmp_path: Path, dialect: str, option: str) -> None:
    """The ends keep their distance, the sides are free: s = sx - nu (sy + sz), and the sides move as their stresses go."""
    sx, sy, sz = 120.0, 80.0, 60.0
    stress = f"*INITIAL CONDITIONS, TYPE=STRESS\n{rows(f'{sx}, {sy}, {sz}, 0., 0., 0.', dialect)}"
    u, s = solve(run, tmp_path, bar(METAL, stress + "*BOUNDARY\nX4, 1\n", step("", option=option)), dialect)
    assert s[0] == pytest.approx(sx - NU * (sy + sz), rel=SECOND_ORDER)
    # with no strain along x: (1 + nu) ((1 - nu) e_y - nu e_z) ... solved for the changes -sy, -sz of the stresses
    law = (1 + NU) / E * np.array([[1 - NU, -NU], [-NU, 1 - NU]])
    assert u[1:] == pytest.approx(law @ [-sy, -sz], rel=SECOND_ORDER)


@pytest.mark.parametrize("option", ["", ", NLGEOM"])
def test_strains_with_volume(run: Run, tmp_path: Path, option: str) -> None:
    """Strains given as plastic ones that change the volume, as those of shrinking welds: a free bar takes them on."""
    strain = np.array([5e-4, 3e-4, 1e-4])
    given = f"*INITIAL CONDITIONS, TYPE=PLASTIC STRAIN\n{rows(', '.join(map(str, strain)) + ', 0., 0., 0.', 'calculix')}"
    u, s = solve(run, tmp_path, bar(METAL, given, step("", option=option)), "calculix")
    assert u == pytest.approx(strain * [N, 1, 1], rel=SECOND_ORDER)
    assert np.abs(s).max() < 1e-3


@pytest.mark.parametrize("option", ["", ", NLGEOM"])
def test_volume_after_flow(run: Run, tmp_path: Path, option: str) -> None:
    """Pulled beyond yield and released, the bar keeps the volume of the strains that it had before: flow has none."""
    strain = np.array([5e-4, 3e-4, 1e-4])
    given = f"*INITIAL CONDITIONS, TYPE=PLASTIC STRAIN\n{rows(', '.join(map(str, strain)) + ', 0., 0., 0.', 'calculix')}"
    steps = step(pull(350.0), n=4, option=option) + step("*CLOAD\nX4, 1, 0.\n", n=4, option=option)
    u, s = solve(run, tmp_path, bar(METAL, given, steps), "calculix")
    stretches = 1 + u / [N, 1, 1]
    assert stretches[0] > 1.02
    volume = np.sum(stretches - 1) if not option else np.prod(stretches) - 1
    assert volume == pytest.approx(strain.sum(), rel=2 * SECOND_ORDER)
    assert np.abs(s).max() < 1e-2
