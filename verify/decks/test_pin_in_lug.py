"""The generator of the pin in a lug: sound tetrahedra, a bore and a barrel of the right area, a deck that both dialects take.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.decks import pin_in_lug as deck

SIZE = 6.0


@pytest.mark.parametrize(
    ("name", "volume", "area"),
    [
        ("LUG", (60 * 40 + np.pi * 20**2 / 2 - np.pi * 10**2) * 12, 2 * np.pi * 10 * 12),
        ("PIN", np.pi * 9.95**2 * 36, 2 * np.pi * 9.95 * 2 * deck.GRIP),
    ],
)
def test_bodies(name: str, volume: float, area: float) -> None:
    """Volume and contact surface of the chords: within two per cent of the round ones."""
    body = deck.mesh_body(name, 3.0)
    a, b, c, d = (body.nodes[body.elements[:, k]] for k in range(4))
    volumes = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
    assert volumes.min() > 0
    assert volumes.sum() == pytest.approx(volume, rel=0.02)
    for k, (i, j) in enumerate(((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)), start=4):
        middle = (body.nodes[body.elements[:, i]] + body.nodes[body.elements[:, j]]) / 2
        assert np.abs(body.nodes[body.elements[:, k]] - middle).max() < 0.5, "mid-side nodes in their places"
    radius = np.hypot(body.nodes[:, 0], body.nodes[:, 1])
    marked = np.abs(radius - (10.0 if name == "LUG" else 9.95)) < 1e-4
    marked &= (np.abs(body.nodes[:, 2]) < deck.GRIP + 1e-6) | (name == "LUG")
    corners = np.array([body.elements[e][deck.FACES[f - 1]] for e, f in body.faces(marked)])
    p, q, r = (body.nodes[corners[:, k]] for k in range(3))
    assert np.linalg.norm(np.cross(q - p, r - p), axis=1).sum() / 2 == pytest.approx(area, rel=0.03)


@pytest.mark.slow
def test_pull(run_deck: Run, tmp_path: Path) -> None:
    """The root carries the force of the free pin; no attempt fails."""
    done = run_deck(deck.pin_in_lug(SIZE))
    assert done.returncode == 0, done.stdout
    force = [float(word) for word in (tmp_path / "job.dat").read_text().split()[-3:]]
    assert force == pytest.approx([-20000.0, 0.0, 0.0], abs=5.0)
    assert "attempts that failed                   0" in done.stdout
