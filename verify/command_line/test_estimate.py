"""`amontons --estimate`: what a job will take, beside what it then took; nothing is run.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from verify.benchmark.estimate_table import cube, figure, peak_megabytes, run as run_measured
from verify.benchmark.wide_contact import Model, deck_of
from verify.conftest import Run


def estimated(run: Run, folder: Path, deck: str) -> str:
    """The estimate of a deck; there are no result files."""
    (folder / "job.inp").write_text(deck)
    done = run(["--estimate", "job"], cwd=folder)
    assert done.returncode == 0, done.stdout
    assert [path.name for path in folder.iterdir()] == ["job.inp"], "--estimate writes no file"
    return str(done.stdout)


@pytest.mark.parametrize("solver", ["", ", SOLVER=ITERATIVE SCALING"])
def test_linear_job(run: Run, program: Path, tmp_path: Path, solver: str) -> None:
    """A cube of 16 elements an edge: 3 * 17^3 unknowns, of them 3 * 17^2 held. The memory is that of the job within a fifth (doc/performance.md:
    it is within a seventh there); the factor's is known before, the rest was taken by the same process. The job takes what was chosen."""
    text = estimated(run, tmp_path, cube(16, solver))
    assert f"{3 * 17**3}, of them {3 * 17**3 - 3 * 17**2} free; {17**3} nodes, {16**3} elements" in text
    assert "contact       none" in text and "1 increment, linear" in text
    choice = figure(text, r"^  choice +(\w+)")
    assert choice == ("iteration" if solver else "factor")
    ranks = re.search(r"^  ranks +for the job: 2 take some ([\d.]+) s and (\d+) MB each; (.*)$", text, re.M)
    assert ranks and float(ranks[1]) < float(figure(text, r"^  job +some ([\d.]+) s"))
    assert ("16 take some" in ranks[3]) == bool(solver) and ("from 4 ranks on MUMPS may share the factor" in text) == (not solver)
    output, _ = run_measured([str(program), "job"], tmp_path)
    assert ("are solved by iteration" in output) == (choice == "iteration")
    assert abs(float(figure(text, r"^  memory +(\d+)")) - peak_megabytes(output)) < 0.2 * peak_megabytes(output) + 10, "10 MB: files and buffers of the output"


def test_contact(run: Run, tmp_path: Path) -> None:
    """Two plates of 11 x 11 and 14 x 14 nodes that touch: the slave nodes are the upper 121; the interface holds no more unknowns than the
    two faces have. INTERFACE=SKIN is taken."""
    text = estimated(run, tmp_path, deck_of(Model(10)))
    assert "121 slave nodes" in text
    assert 3 * 121 < int(figure(text, r"interface of (\d+) unknowns")) <= 3 * (121 + 14 * 14)
    assert "dense" in text and "factor of the bulk with the interface last" in text and "ranks         for such a Newton iteration: 2 take" in text
    (tmp_path / "job.inp").unlink()
    text = estimated(run, tmp_path, deck_of(Model(10), interface="SKIN"))
    assert "by the contact skin" in text and re.search(r"^  choice +factor of the bulk, which", text, re.M)


def test_a_deck_with_errors(run: Run, tmp_path: Path) -> None:
    """All errors are reported, with the exit code of a job."""
    (tmp_path / "job.inp").write_text("*STATIK\n")
    done = run(["--estimate", "job"], cwd=tmp_path)
    assert done.returncode == 3 and "STATIK" in done.stdout + done.stderr
