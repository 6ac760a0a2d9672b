"""The serial program: solvers of PETSc are errors of the deck.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import pytest

from verify.benchmark.estimate_table import cube
from verify.distributed.ranks_and_serial import run


@pytest.mark.parametrize(("solver", "word"), [("GAMG", "amontons-mpi has (make MPI=1)"), ("HYPRE", "amontons-mpi has"), ("MUMPS", "amontons-mpi has"), ("BDDC", "amontons-mpi has")])
def test_solver_of_petsc(tmp_path: Path, solver: str, word: str) -> None:
    """The error names the card, its line and what is allowed; another name of CalculiX leaves the choice to the program."""
    deck = cube(2, f", SOLVER={solver}")
    outcome = run(tmp_path, deck, 0)
    line = deck.splitlines().index(f"*STATIC, SOLVER={solver}") + 1
    assert outcome.code == 3 and f"job.inp:{line}: *ERROR: SOLVER={solver}" in outcome.text and word in outcome.text
    assert run(tmp_path, cube(2, ", SOLVER=PARDISO"), 0).code == 0
