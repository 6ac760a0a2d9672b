"""Seals of rubber without a pair named in the deck, with default settings: an O-ring, a U-cup, a wiper lip.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.assemblies import RUBBER, general
from verify.decks.make_decks import Floats
from verify.decks.seals import CORD, CUP_LEAN, CUP_LEG, CUP_SLOT, LIP_LENGTH, RING_RADIUS, SLIT, o_ring, u_cup, wiper_lip

MODULUS = 3.0  #: of the rubber: 6 C10
TOL_LINDLEY = 0.06  #: of the formula; the meshes of a squeeze differ by 0.4 %
YEOH = "*HYPERELASTIC, YEOH\n0.5, -0.01, 0.002, 0.04, 0., 0.\n"


def solve(run: Run, folder: Path, deck: str) -> tuple[Floats, Floats, Floats]:
    """Runs a deck; places at the start, displacements and reactions at the end: (n, 3)."""
    (folder / "job.inp").write_text(deck)
    done = run(["--outdir", folder, folder / "job.inp"], folder)
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(folder / "job.vtkhdf") as file:
        n = int(file["VTKHDF/NumberOfPoints"][-1])
        u, force = (np.asarray(file[f"VTKHDF/PointData/{field}"])[-n:] for field in ("U", "RF"))
        return np.asarray(file["VTKHDF/Points"])[-n:], u, force


def force_on_ring(run: Run, folder: Path, n: int, deck: str) -> float:
    """The force of the upper plate over d L E, L the length of the ring."""
    _, _, force = solve(run, folder, deck)
    first = (2 * n + 1) ** 2 + 8 * n**2 + 2 * (4 * n + 1)  # nodes of the ring and of the lower plate
    return float(-force[first:, 1].sum() / (CORD * 2 * np.pi * RING_RADIUS * MODULUS))


@pytest.mark.parametrize(("n", "squeeze"), [(4, 0.2), (6, 0.2), (6, 0.25), (8, 0.25)])
def test_o_ring(run: Run, tmp_path: Path, n: int, squeeze: float) -> None:
    """An O-ring that is free to slide has the force d L E (1.25 c^1.5 + 50 c^6) of P. Lindley, J. IRI 1 (1967) 202-213."""
    force = force_on_ring(run, tmp_path, n, o_ring(n, "CAX4", general(0.0), squeeze))
    assert force == pytest.approx(1.25 * squeeze**1.5 + 50 * squeeze**6, rel=TOL_LINDLEY)


def test_u_cup(run: Run, tmp_path: Path) -> None:
    """Two walls come from both sides until the legs touch: the way that brings them together is that of both walls."""
    at, u, force = solve(run, tmp_path, u_cup(2, general(0.2), 0.34))
    is_cup = np.abs(at[:, 0]) < CUP_LEG + CUP_SLOT / 2 + CUP_LEAN + 1e-9
    now = at + u
    tips = is_cup & (at[:, 1] > 2.0 - 1e-9)
    left, right = now[tips & (at[:, 0] < 0), 0].max(), now[tips & (at[:, 0] > 0), 0].min()
    assert abs(right - left) <= 0.02 * CUP_LEG  # closed in the mean over a face
    assert force[:, 0].sum() == pytest.approx(0, abs=1e-6 * np.abs(force).max())


@pytest.mark.parametrize(("n", "material", "mu"), [(2, RUBBER, 0.0), (2, YEOH, 0.3), (3, RUBBER, 0.0)])
def test_wiper_lip(run: Run, tmp_path: Path, n: int, material: str, mu: float) -> None:
    """A shaft lays a lip against its housing, from which the faces of its tip were turned away at the start. The lip fills no more than the
    slit; what the shaft presses the housing and the root carry."""
    at, u, force = solve(run, tmp_path, wiper_lip(n, material, general(mu), 5.0))
    count = (2 * n + 1) * (8 * n + 1)  # nodes of the lip, the first ones
    now = (at + u)[:count]
    assert now[:, 0].max() > 0.7 * LIP_LENGTH  # it lies
    assert now[:, 1].max() <= 1e-3 * SLIT
    assert now[:, 1].min() >= -1.02 * SLIT
    assert np.abs(force.sum(axis=0)).max() <= 1e-6 * np.abs(force).max()
