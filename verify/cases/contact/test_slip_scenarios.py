"""The slip scenario of a slave node follows the same friction limit as its status: TAUMAX, a coefficient of zero, the user's FRIC.

A node that slides steadily is in scenario I or II until its slip is in equilibrium; III and IV are for slip that is taken back.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
import pytest
from verify.conftest import ROOT, Run


from verify.decks.planes import flat_deck, flatten
from verify.decks.sheets import between, fix, pair, sheet
from verify.cases.contact.test_contact_laws import Bench, bench, step  # noqa: F401

STEEL, SOFT = (210000.0, 0.3), (2000.0, 0.3)
SEARCHES = ["NONE", "ALL", "GLOBAL", "NODAL", "AUTO"]


@dataclass
class Iterations:
    """What the iterations of a job say of slip."""

    step: np.ndarray  # (n)
    increment: np.ndarray
    scenario: np.ndarray  # (n, 4) nodes in I to IV
    balanced: np.ndarray  # (n) nodes that slip in equilibrium
    status: np.ndarray  # (n, 3) nodes that are open, stick, slip
    length: np.ndarray  # (n) step length

    def lasts(self) -> np.ndarray:
        """The last iteration of each increment."""
        ends = np.append(np.flatnonzero(np.diff(self.increment) | np.diff(self.step)), len(self.step) - 1)
        return np.asarray(ends)


def iterations_of(file: Path) -> Iterations:
    """Reads them from a result file."""
    with h5py.File(file) as h:
        table = h["AMONTONS/iterations"]
        return Iterations(*(np.asarray(table[name]) for name in ("step", "increment", "n_scenario", "n_balanced", "n_status", "step_length")))


@pytest.mark.parametrize("search", SEARCHES)
def test_sliding_at_taumax(bench: Bench, search: str) -> None:  # noqa: F811
    """mu p is 6 and TAUMAX 1.5: the foot slides at TAUMAX. It never backs up."""
    slide = f"*LINE SEARCH, TYPE={search}\n*BOUNDARY\nTOP, 1, 1, 0.05"
    answer = bench.solve("*FRICTION, TAUMAX=1.5\n0.2", step("*BOUNDARY\nTOP, 1, 1\n*DLOAD\n2, P2, 30.") + step(slide, "0.25, 1."))
    assert np.all(answer.status[-1] == 2)
    assert np.mean(answer.shear[-1]) == pytest.approx(-1.5, rel=1e-6)
    found = iterations_of(bench.folder / "job.vtkhdf")
    sliding = found.step == 2
    assert found.scenario[sliding, :2].sum() > 0, "it slips by scenario I or II during the step"
    assert not found.scenario[sliding, 2:].any(), "it never backs up"
    assert found.balanced[-1] == found.status[-1, 2] == 4, "sliding steadily, an increment begins and ends with slip in equilibrium"
    with h5py.File(bench.folder / "job.vtkhdf") as file:
        assert np.asarray(file["VTKHDF/PointData/CSCENARIO"]).max() <= 2


def dragged(mu: float, search: str, drag: float = 1.0) -> str:
    """A block pressed into a softer slab and dragged, in the plane, with large displacements."""
    body, slab = sheet("BODY", between(0, 1, 5), between(0, 1, 4)), sheet("SLAB", between(-1, 3, 16), between(-1, 0, 4))
    press = fix("SLAB_BOTTOM, 1, 2", "BODY_TOP, 1", "BODY_TOP, 2, 2, -0.05")
    head = "*STEP, NLGEOM\n*STATIC\n0.2, 1.\n"
    steps = f"{head}*LINE SEARCH, TYPE={search}\n{press}*END STEP\n{head}{fix(f'BODY_TOP, 1, 1, {drag}')}*END STEP\n"
    return flat_deck([(flatten(body), STEEL), (flatten(slab), SOFT)], "CPE4", pair("BODY_BOTTOM", "SLAB_TOP", mu) + steps)


@pytest.mark.parametrize("search", SEARCHES)
def test_frictionless_nodes(run: Run, tmp_path: Path, search: str) -> None:
    """DR = |Rt|: a frictionless node that slides is in scenario I or II until its tangential imbalance is gone, then in equilibrium."""
    (tmp_path / "job.inp").write_text(dragged(0.0, search))
    done = run(["--quiet", "job.inp"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    found = iterations_of(tmp_path / "job.vtkhdf")
    assert found.scenario[:, :2].sum() > 0
    assert not found.scenario[:, 2:].any(), "there is no friction that is not used up"


def test_frictionless_nodes_in_equilibrium(bench: Bench) -> None:  # noqa: F811
    """A foot that slides without friction and without tangential imbalance is slip in equilibrium."""
    bench.solve("*FRICTION\n0.", step("*BOUNDARY\nTOP, 1, 1\n*DLOAD\n2, P2, 30.") + step("*BOUNDARY\nTOP, 1, 1, 0.05", "0.25, 1."))
    found = iterations_of(bench.folder / "job.vtkhdf")
    assert found.balanced[-1] == found.status[-1, 2] == 4
    assert not found.scenario.any()


@pytest.mark.parametrize("search", ["GLOBAL", "NODAL"])
def test_scenarios_of_a_search_that_evaluates_again(run: Run, tmp_path: Path, search: str) -> None:
    """CSCENARIO shows the scenarios of the iterations also where the line search tried another length and evaluated again."""
    (tmp_path / "job.inp").write_text(dragged(0.3, search, 0.2))
    done = run(["--quiet", "job.inp"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    found = iterations_of(tmp_path / "job.vtkhdf")
    assert found.scenario.any()
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        n = int(file["VTKHDF/NumberOfPoints"][0])
        shown = np.asarray(file["VTKHDF/PointData/CSCENARIO"]).reshape(-1, n)
    for frame, end in enumerate(found.lasts(), start=1):
        rows = (found.step == found.step[end]) & (found.increment == found.increment[end])
        assert bool(found.scenario[rows].any()) == bool(shown[frame].any()), frame


@pytest.mark.parametrize("least", [0.25, 0.05])
def test_auto_keeps_to_the_least_length(run: Run, tmp_path: Path, least: float) -> None:
    """AUTO's halves end at s min of *CONTROLS, LINE SEARCH."""
    body, slab = sheet("BODY", between(-0.5, 0.5, 8), between(0, 0.6, 4)), sheet("SLAB", between(-2, 2, 22), between(-1.5, 0, 6))
    press = fix("SLAB_BOTTOM, 1, 2", "BODY_TOP, 1", "BODY_TOP, 2, 2, -0.01")
    head = f"*STEP\n*STATIC, DIRECT\n0.05, 1.\n*CONTROLS, PARAMETERS=LINE SEARCH\n, 1.01, {least}\n"
    steps = f"{head}{press}*END STEP\n{head}{fix('BODY_TOP, 1, 1, 0.01')}*END STEP\n"
    parts = [(flatten(body), STEEL), (flatten(slab), SOFT)]
    (tmp_path / "job.inp").write_text(flat_deck(parts, "CPE4", pair("BODY_BOTTOM", "SLAB_TOP", 1.0) + steps))
    done = run(["--quiet", "job.inp"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    lengths = iterations_of(tmp_path / "job.vtkhdf").length
    assert (lengths < 0.999).any(), "AUTO shortens some steps"
    assert lengths.min() >= least
