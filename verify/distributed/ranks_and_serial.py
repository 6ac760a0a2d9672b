"""The same decks by amontons and by amontons-mpi on several ranks: statuses, increments, iterations, displacements and reactions.

    python -m verify.distributed.ranks_and_serial [--ranks 1 2 4] [--every 1] [--only WORD] [--solver GAMG|HYPRE|MUMPS]

The decks are the generated ones of `verify.decks` (features, mixed, behaviours: all elements, laws, formulations, constraints, outputs),
in the calculix dialect. Prints a table in Markdown, a row for each number of ranks, and the decks that differ. With --solver every *STATIC requests
that solver on the ranks, and the serial program chooses as ever. Differences are over the largest value of the job.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

from verify.decks import behaviour_decks, feature_decks, mixed_decks

ROOT = Path(__file__).resolve().parents[2]
COUNTS = ("step", "increment", "attempt", "is_converged", "n_iterations", "n_status")  #: of the history: equal on all ranks
FIELDS = ("U", "RF")
TOLERANCE = 1e-10  #: of a field over its largest value: sums in another order, times the condition of the job
TIME_LIMIT = 300
DIALECT = "--dialect=calculix"  #: of the generated decks


@dataclass
class Outcome:
    """What a run left."""

    code: int
    text: str
    counts: dict[str, np.ndarray] = field(default_factory=dict)
    fields: dict[str, np.ndarray] = field(default_factory=dict)
    statuses: np.ndarray = field(default_factory=lambda: np.zeros(0))


def environment() -> dict[str, str]:
    """For mpiexec of OpenMPI: more ranks than processors, root in a container, one thread a rank."""
    return os.environ | {
        "OMP_NUM_THREADS": "1",
        "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        "OMPI_MCA_rmaps_base_oversubscribe": "1",
        "OMPI_MCA_mpi_yield_when_idle": "1",
        "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    }


def program(name: str) -> Path:
    """A program of the build."""
    return ROOT / os.environ.get("AMONTONS_BIN", "bin") / name


def run(folder: Path, deck: str, n_ranks: int, *options: str) -> Outcome:
    """Runs a deck as folder/job.inp: on ranks, or by the serial program (0)."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "job.inp").write_text(deck)
    return execute(folder, n_ranks, *options)


def execute(folder: Path, n_ranks: int, *options: str) -> Outcome:
    """Runs folder/job.inp."""
    command = [str(program("amontons")), *options, "job"]
    if n_ranks:
        command = ["mpiexec", "-n", str(n_ranks), str(program("amontons-mpi")), *options, "job"]
    done = subprocess.run(command, cwd=folder, env=environment(), capture_output=True, text=True, timeout=TIME_LIMIT, check=False)
    outcome = Outcome(done.returncode, re.sub(r"\x1b\[\d*[mK]", "", done.stdout + done.stderr))
    path = folder / "job.vtkhdf"
    if path.exists():
        with h5py.File(path) as file:
            outcome.counts = {name: file[f"AMONTONS/history/{name}"][:] for name in COUNTS}
            outcome.fields = {name: file[f"VTKHDF/PointData/{name}"][:] for name in FIELDS}
            outcome.statuses = file["AMONTONS/contact/status"][:]
    return outcome


def difference(serial: Outcome, ranks: Outcome) -> tuple[str, float]:
    """What differs in counts (empty: nothing), and the largest difference of a field over its largest value."""
    if serial.code != ranks.code:
        return f"exit code {ranks.code}, serial {serial.code}", 0.0
    for name, values in serial.counts.items():
        if not np.array_equal(values, ranks.counts.get(name)):
            return name, 0.0
    if not np.array_equal(serial.statuses, ranks.statuses):
        return "statuses of contact", 0.0
    worst = 0.0
    for name, values in serial.fields.items():
        scale = float(np.abs(values).max(initial=0.0))
        if scale > 0:
            worst = max(worst, float(np.abs(values - ranks.fields[name]).max()) / scale)
    return "", worst


def with_solver(deck: str, solver: str) -> str:
    """The deck with a solver on every STATIC card."""
    bare = re.sub(r"^(\*STATIC[^\n]*?), *SOLVER *= *[^,\n]*", r"\1", deck, flags=re.M | re.I)
    return re.sub(r"^\*STATIC", f"*STATIC, SOLVER={solver}", bare, flags=re.M | re.I) if solver else deck


def all_decks() -> dict[str, str]:
    """The generated decks."""
    return {
        f"{kind}/{name}": text
        for kind, module in (("feature", feature_decks), ("mixed", mixed_decks), ("behaviour", behaviour_decks))
        for name, text in module.cases().items()
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ranks", nargs="*", type=int, default=[1, 2, 4])
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--solver", default="")
    options = parser.parse_args(arguments)
    decks = {name: text for name, text in list(all_decks().items())[:: options.every] if options.only in name}
    rows = {n: [0, 0, 0.0] for n in options.ranks}
    unequal = []
    ends: dict[int, int] = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, text in decks.items():
            serial = run(Path(folder) / "serial", text, 0, DIALECT)
            ends[serial.code] = ends.get(serial.code, 0) + 1
            for n in options.ranks:
                what, worst = difference(serial, run(Path(folder) / "ranks", with_solver(text, options.solver), n, DIALECT))
                rows[n][0] += 1
                rows[n][1] += what == ""
                rows[n][2] = max(rows[n][2], worst)
                if what or worst > TOLERANCE:
                    unequal.append(f"{name} on {n}: {what or f'fields by {worst:.1e}'}")
                    print(unequal[-1], file=sys.stderr, flush=True)
                shutil.rmtree(Path(folder) / "ranks")
            shutil.rmtree(Path(folder) / "serial")
    print("| ranks | decks | equal statuses, increments, iterations | largest difference of displacements and reactions |")
    print("|---|---|---|---|")
    for n, (count, equal, worst) in rows.items():
        print(f"| {n} | {count} | {equal} | {worst:.1e} |")
    print("\n".join(["", f"Exit codes of the serial program and how often: {ends}", *unequal]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
