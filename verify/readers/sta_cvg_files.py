"""Reads .sta and .cvg, ours and CalculiX's, into rows: what each attempt at an increment cost, and each iteration.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Attempt:
    """A row of .sta."""

    step: int
    increment: int
    attempt: int
    is_failed: bool
    iterations: int
    time: float  #: total time reached


@dataclass(frozen=True)
class Iteration:
    """A row of .cvg: the first columns, which are CalculiX's, and the step length of ours."""

    step: int
    increment: int
    attempt: int
    iteration: int
    n_contacts: int
    residual: float  #: of force [percent]
    correction: float  #: of displacement [percent]
    step_length: float = 1.0  #: of the line search [-]


def read_sta(path: Path) -> list[Attempt]:
    """All attempts in their order; none if there is no file. A U behind the attempt's number says that it failed."""
    rows = _rows(path, r"\s*\d+\s+\d+\s+\d+\s*U?\s+\d")
    return [Attempt(int(w[0]), int(w[1]), int(w[2]), is_failed, int(w[3]), float(w[4])) for w, is_failed in rows]


def read_cvg(path: Path) -> list[Iteration]:
    """All iterations in their order; none if there is no file."""
    rows = _rows(path, r"\s*\d+\s+\d+\s+\d+\s+\d+\s+\d")
    return [
        Iteration(*(int(word) for word in w[:5]), float(w[5]), float(w[6]), float(w[19]) if len(w) > 19 else 1.0) for w, _ in rows
    ]


def _rows(path: Path, form: str) -> list[tuple[list[str], bool]]:
    """The words of the lines of a form, and whether there was a U among them."""
    lines = path.read_text().splitlines() if path.exists() else []
    return [(line.replace("U", " ").split(), "U" in line) for line in lines if re.match(form, line)]
