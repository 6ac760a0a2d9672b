"""shear_block.inp, the first benchmark: pressed, dragged, partly slipping, sliding; judged from outside.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from verify.conftest import ROOT, Run
from verify.independent.contact import IncrementCheck
from verify.independent.results import read_history, read_results
from verify.tools.contact_check import check_file

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def result(run: Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The finished job."""
    folder = tmp_path_factory.mktemp("shear_block")
    done = run(["--quiet", "--outdir", folder, ROOT / "input" / "shear_block.inp"], cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "shear_block.vtkhdf"


@pytest.fixture(scope="module")
def checks(result: Path) -> list[IncrementCheck]:
    """The independent check of all increments."""
    return check_file(result)


def test_all_increments_are_there(result: Path) -> None:
    """Ten and ten increments of 0.1, and the initial state."""
    assert np.allclose(read_results(result).times, np.linspace(0, 2, 21))


def test_contact_holds(checks: list[IncrementCheck]) -> None:
    """|t| <= mu p to 1e-5 of the largest p, penetration below 1e-8 of an edge, no tension, balance to 1e-6."""
    failures = [f"t = {c.time:.4g}: {failure}" for c in checks for failure in c.failures]
    assert not failures, "\n".join(failures)


def test_sticks_and_slips(checks: list[IncrementCheck]) -> None:
    """During loading some nodes stick while others slip; at the end all slip."""
    drag = [c.pairs[0] for c in checks if c.step == 2]
    assert any(p.n_stick >= 10 and p.n_slip >= 10 for p in drag)
    assert drag[-1].n_stick == 0 and drag[-1].n_slip > 0
    slipping = [p.n_slip for p in drag]
    assert slipping == sorted(slipping), f"the slip zone grows under a growing drag: {slipping}"


def test_friction_is_used_up_at_the_end(checks: list[IncrementCheck]) -> None:
    """Sliding: the tangential force is mu times the normal one (up to the slope of the dented surface)."""
    last = checks[-1].pairs[0]
    assert last.shear_force == pytest.approx(0.3 * last.normal_force, rel=5e-3)


def test_few_iterations(result: Path) -> None:
    """At most six Newton iterations per increment in the mean, failed attempts counted."""
    history = read_history(result)
    rows = history["increment"] > 0
    increments = len(set(zip(history["step"][rows], history["increment"][rows], strict=True)))
    assert history["n_iterations"][rows].sum() / increments <= 6.0
