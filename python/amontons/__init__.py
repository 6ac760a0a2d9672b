"""Amontons from Python: a job in your hands; solve, look, commit or roll back; get and set by name.

    import amontons

    with amontons.Job("block.inp") as job:
        job.set("U2", "top", -0.01)
        job.try_step(0.1)
        if abs(job.get("RF", "top")[:, 1].sum()) < limit:
            job.commit()
        else:
            job.rollback()

The verbs and the names of the quantities are listed in doc/manual/library.md.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from amontons.job import (
    AmontonsError,
    DeckError,
    FileError,
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
from amontons.slip import Slip, classify

__all__ = [
    "AmontonsError",
    "DeckError",
    "FileError",
    "InternalError",
    "Job",
    "Matrix",
    "NotConvergedError",
    "SetupError",
    "Slip",
    "SolverError",
    "UsageError",
    "Verdict",
    "classify",
    "version",
]
