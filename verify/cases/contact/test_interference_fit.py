"""Overlapping elastic bodies on meshes that do not match, pressed apart over a step under NLGEOM, and then drawn along.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.cases.proof import Job
from verify.decks.make_decks import block
from verify.decks.sheets import between, fix, pair, solid_deck, step

Run = Callable[..., subprocess.CompletedProcess[str]]
OVERLAP = 0.02
SHRINK = "*CONTACT INTERFERENCE, SHRINK\nUPPER_BOTTOM, LOWER_TOP\n"
SOFT = (10000.0, 0.3)


def deck(mu: float, steps: str, options: str = "") -> str:
    """A block of half the height of its lower one and narrower, OVERLAP deep in it; the outer faces are held."""
    lower = block(between(-0.2, 1.5, 3), between(-0.3, 1.4, 4), between(-0.6, 0.0, 2), "LOWER")
    upper = block(between(0.0, 1.0, 2), between(0.0, 1.0, 3), between(-OVERLAP, 0.5 - OVERLAP, 2), "UPPER")
    return solid_deck([(upper, SOFT), (lower, SOFT)], pair("UPPER_BOTTOM", "LOWER_TOP", mu, options), steps)


def solve(run_deck: Run, tmp_path: Path, text: str) -> Job:
    """A job without a failed attempt and with few iterations."""
    done = run_deck(text, "--quiet")
    assert done.returncode == 0, done.stdout + done.stderr
    job = Job(tmp_path / "job.vtkhdf", "job")
    assert job.n_failed == 0
    assert job.n_iterations <= 4 * job.n_increments
    return job


HELD = fix("LOWER_BOTTOM, 1, 3", "UPPER_TOP, 1, 3")


@pytest.mark.parametrize("options", ["", ", TYPE=SURFACE TO SURFACE"])
def test_end_is_that_of_one_increment(options: str, run_deck: Run, tmp_path: Path) -> None:
    """Without friction the end does not depend on the path: the overclosure released in four increments, or pressed out at once."""
    ends = []
    for cards, n in ((SHRINK, 4), ("", 1)):
        job = solve(run_deck, tmp_path, deck(0.0, step(HELD + cards, n, is_nlgeom=True), options))
        ends.append({name: job.last(name) for name in ("U", "CNORMF", "S")})
    for name, end in ends[0].items():
        assert np.abs(end - ends[1][name]).max() <= 1e-6 * np.abs(ends[1][name]).max(), name
    assert ends[0]["CNORMF"][:, 2].sum() > 100.0


@pytest.mark.parametrize("options", ["", ", TYPE=SURFACE TO SURFACE"])
def test_then_it_is_drawn(options: str, run_deck: Run, tmp_path: Path) -> None:
    """With friction nodes stick while the master turns under them: no overclosure remains, friction is bounded, forces are in equilibrium."""
    steps = step(HELD + SHRINK, 4, is_nlgeom=True) + step(fix("UPPER_TOP, 1, 1, 0.05"), 4, is_nlgeom=True)
    job = solve(run_deck, tmp_path, deck(0.4, steps, options))
    normal, shear = job.last("CNORMF"), job.last("CSHEARF")
    assert np.abs(job.last("COPEN")).max() <= 1e-8 if not options else True
    assert (np.linalg.norm(shear, axis=1) <= 0.4 * np.linalg.norm(normal, axis=1) * (1 + 1e-6)).all()
    lowest = job.points[:, 2] < -0.6 + 1e-9
    reaction = job.last("RF")[lowest].sum(axis=0)
    total = (normal + shear).sum(axis=0)
    assert np.abs(reaction - total).max() <= 1e-6 * np.abs(total).max()
