"""Finds the coefficient of friction from a force curve: secant steps on mu, each a run of the job with that mu.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import amontons


def drag_forces(deck: Path, mu: float) -> np.ndarray:
    """The force along x on the lid after each increment."""
    forces = []
    with amontons.Job(deck) as job:
        job.set("FRICTION", "", mu)
        while not job.is_done:
            job.advance()
            forces.append(job.get("RF", "LID")[:, 0].sum())
    return np.array(forces)


def identify_mu(deck: Path, measured: np.ndarray, guess: float = 0.1, tolerance: float = 1e-8) -> tuple[float, int]:
    """The mu whose force curve has the area of the measured one, and the number of runs that it took."""

    def misfit(mu: float) -> float:
        return float(np.sum(drag_forces(deck, mu) - measured))

    a, b = guess, 1.5 * guess
    at_a, at_b = misfit(a), misfit(b)
    runs = 2
    while abs(b - a) > tolerance and runs < 30:
        a, b, at_a = b, b - at_b * (b - a) / (at_b - at_a), at_b
        at_b = misfit(b)
        runs += 1
    return b, runs
