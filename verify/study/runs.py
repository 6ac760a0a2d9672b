"""Timed runs of decks, and the files that keep them: one row for each run.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import csv
import os
import resource
import subprocess
from collections.abc import Iterable
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any, TypeVar

Run = TypeVar("Run")  #: a dataclass of words and numbers


def execute(program: Path, folder: Path, name: str, deck: str, seconds: float, is_logged: bool = False) -> tuple[bool, float]:
    """Runs a deck; whether it finishes, and the processor's seconds. is_logged: what it prints is in NAME.log."""
    (folder / f"{name}.inp").write_text(deck)

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds) + 1))

    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    command = [program, "--quiet", "--no-checkpoint", "--outdir", folder, folder / f"{name}.inp"]
    done = subprocess.run(command, check=False, capture_output=True, preexec_fn=limit, env={**os.environ, "OMP_NUM_THREADS": "1"})  # noqa: PLW1509 (no threads here)
    if is_logged:
        (folder / f"{name}.log").write_bytes(done.stdout + done.stderr)
    return done.returncode == 0, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def read_runs(file: Path, kind: type[Run]) -> list[Run]:
    """The runs of a file, each of the dataclass `kind`."""
    kinds: dict[str, Any] = {"str": str, "float": float, "int": int}
    with file.open(newline="") as rows:
        return [kind(**{f.name: kinds[str(f.type)](row[f.name]) for f in fields(kind)}) for row in csv.DictReader(rows)]  # type: ignore[arg-type]


def write_runs(file: Path, runs: Iterable[Any]) -> None:
    """Runs of one dataclass, at least one, in the order given."""
    dicts = [asdict(r) for r in runs]
    with file.open("w", newline="") as rows:
        table = csv.DictWriter(rows, list(dicts[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(dicts)
