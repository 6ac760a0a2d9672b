"""The factor of the first iteration of an increment serves the others where only the bulk is nonlinear.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from verify.benchmark.bench import plastic_deck
from verify.cases.proof import Job
from verify.conftest import Run


def solve(run: Run, folder: Path, size: int, line_search: str) -> Job:
    """Two increments of the upset cube with criteria of 1e-8."""
    folder.mkdir()
    deck = plastic_deck(size).replace("0.1, 1., , 0.1", "0.5, 1.\n*CONTROLS, PARAMETERS=FIELD\n1e-8, 1e-8").replace("-0.1\n", "-0.01\n")
    (folder / "job.inp").write_text(deck.replace("*END STEP", f"*LINE SEARCH, TYPE={line_search}\n*END STEP"))
    done = run(["--quiet", "--no-checkpoint", "job"], cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return Job(folder / "job.vtkhdf", folder.name)


def test_one_factor_an_increment(run: Run, tmp_path: Path) -> None:
    """With AUTO one factor an increment, with NONE one an iteration: the same fields, and at most one iteration more."""
    reused, renewed = (solve(run, tmp_path / line_search, 18, line_search) for line_search in ("AUTO", "NONE"))
    factors = [job.history["n_factorisations"].sum() for job in (reused, renewed)]
    assert factors[1] == renewed.n_iterations > 6
    assert factors[0] < 0.6 * factors[1]
    assert reused.n_iterations <= renewed.n_iterations + 1
    for field in ("U", "S", "PEEQ"):
        ours, theirs = reused.last(field), renewed.last(field)
        assert np.abs(ours - theirs).max() <= 1e-7 * np.abs(theirs).max(), field


def test_small_models_get_new_factors(run: Run, tmp_path: Path) -> None:
    """Where a factor costs little more than its solutions, each iteration has its own."""
    job = solve(run, tmp_path / "small", 6, "AUTO")
    assert job.history["n_factorisations"].sum() == job.n_iterations
