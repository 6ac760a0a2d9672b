"""Timed runs of decks, and the files that keep them: one row for each run.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import csv
import os
import resource
import subprocess
from collections.abc import Iterable, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any, TypeVar

Run = TypeVar("Run")  #: a dataclass of words and numbers


def run_limited(
    command: Sequence[str | Path], seconds: float, folder: Path | None = None, timeout: float | None = None
) -> tuple[subprocess.CompletedProcess[bytes], float]:
    """Runs a program on one thread with a limit of processor time; what it printed and its exit code, and the seconds that it took."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds) + 1))

    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run(command, cwd=folder, check=False, capture_output=True, timeout=timeout, preexec_fn=limit, env=environment)  # noqa: PLW1509 (no threads here)
    return done, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def execute(program: Path, folder: Path, name: str, deck: str, seconds: float, is_logged: bool = False) -> tuple[bool, float]:
    """Runs a deck; whether it finishes, and the processor's seconds. is_logged: what it prints is in NAME.log."""
    (folder / f"{name}.inp").write_text(deck)
    done, spent = run_limited([program, "--quiet", "--no-checkpoint", "--outdir", folder, folder / f"{name}.inp"], seconds)
    if is_logged:
        (folder / f"{name}.log").write_bytes(done.stdout + done.stderr)
    return done.returncode == 0, spent


def read_runs(file: Path, kind: type[Run]) -> list[Run]:
    """The runs of a file, each of the dataclass `kind`."""
    kinds: dict[str, Any] = {"str": str, "float": float, "int": int}
    with file.open(newline="") as rows:
        return [kind(**{f.name: kinds[str(f.type)](row[f.name]) for f in fields(kind) if f.name in row}) for row in csv.DictReader(rows)]  # type: ignore[arg-type]


def write_runs(file: Path, runs: Iterable[Any]) -> None:
    """Runs of one dataclass, at least one, in the order given."""
    dicts = [asdict(r) for r in runs]
    with file.open("w", newline="") as rows:
        table = csv.DictWriter(rows, list(dicts[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(dicts)
