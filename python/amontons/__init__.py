"""Amontons from Python: run a job and read its results; or have it in your hands: solve, look, commit or roll back, get and set.

    import amontons

    for increment in amontons.Job("block.inp", files=True):
        print(increment)
    print(amontons.read("block.vtkhdf").pairs)

    with amontons.Job("block.inp") as job:
        job.set("U2", "top", -0.01)
        job.try_step(0.1)
        if abs(job.get("RF", "top")[:, 1].sum()) < limit:
            job.commit()
        else:
            job.rollback()

The verbs and the names of the quantities are listed in doc/manual/library.md, what results hold in doc/manual/python.md.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from amontons.job import (
    AmontonsError,
    DeckError,
    FileError,
    Increment,
    InternalError,
    Job,
    Matrix,
    NotConvergedError,
    SetupError,
    SolverError,
    UsageError,
    Verdict,
    version,
)
from amontons.results import Results, read
from amontons.slip import Slip, classify

__all__ = [
    "AmontonsError",
    "DeckError",
    "FileError",
    "Increment",
    "InternalError",
    "Job",
    "Matrix",
    "NotConvergedError",
    "Results",
    "SetupError",
    "Slip",
    "SolverError",
    "UsageError",
    "Verdict",
    "classify",
    "read",
    "version",
]
