"""The same decks by amontons and by amontons-mpi on several ranks: statuses, increments, iterations, displacements and reactions.

    python -m verify.distributed.ranks_and_serial [--cases] [--ranks 1 2 4] [--every 1] [--first 0] [--only WORD] [--solver GAMG|HYPRE|MUMPS]
                                                  [--seconds 60] [--rows FILE]

The decks are the generated ones of `verify.decks` (features, mixed, behaviours: all elements, laws, formulations, constraints, outputs),
in the calculix dialect; with --cases those of all verification cases (`verify/cases`), in theirs. Prints a table in Markdown, a row for each number
of ranks, and the decks that differ. With --solver every *STATIC requests that solver on the ranks, and the serial program chooses as ever. Differences
are over the largest value of the job (`scale_of`). Decks on which the serial program takes longer than --seconds are left out and counted. --every N --first K
takes every N-th deck (case) from the K-th on, and --rows appends a line for each comparison to a file, so that the table can be made in pieces:

    python -m verify.distributed.ranks_and_serial --table FILE

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
from inspect import signature
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import h5py
import numpy as np

from verify.decks import behaviour_decks, feature_decks, mixed_decks

ROOT = Path(__file__).resolve().parents[2]
COUNTS = ("step", "increment", "attempt", "is_converged", "n_iterations", "n_status")  #: of the history: equal on all ranks
FIELDS = ("U", "RF")
TOLERANCE = 1e-10  #: of a field over its largest value: sums in another order, times the condition of the job
TIME_LIMIT = 300
EXIT_TIME = -1  #: exit code of a job that was stopped after its time
DIALECT = "--dialect=calculix"  #: of the generated decks


@dataclass
class Outcome:
    """What a run left."""

    code: int
    text: str
    counts: dict[str, np.ndarray] = field(default_factory=dict)
    fields: dict[str, np.ndarray] = field(default_factory=dict)
    strain_energy: float = 0.0  #: the largest of the job
    statuses: np.ndarray = field(default_factory=lambda: np.zeros(0))


def environment() -> dict[str, str]:
    """For mpiexec of OpenMPI: more ranks than processors, root in a container, one thread a rank; messages go through the memory of the one
    machine, so that no rank looks for networks first, which takes a third of the start."""
    return os.environ | {
        "OMP_NUM_THREADS": "1",
        "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        "OMPI_MCA_rmaps_base_oversubscribe": "1",
        "OMPI_MCA_mpi_yield_when_idle": "1",
        "OMPI_MCA_pml": "ob1",
        "OMPI_MCA_btl": "self,vader",
        "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    }


def program(name: str) -> Path:
    """A program of the build."""
    return ROOT / os.environ.get("AMONTONS_BIN", "bin") / name


def run(folder: Path, deck: str, n_ranks: int, *options: str, seconds: float = TIME_LIMIT) -> Outcome:
    """Runs a deck as folder/job.inp: on ranks, or by the serial program (0)."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "job.inp").write_text(deck)
    return execute(folder, n_ranks, *options, seconds=seconds)


def execute(folder: Path, n_ranks: int, *options: str, seconds: float = TIME_LIMIT) -> Outcome:
    """Runs folder/job.inp."""
    command = [str(program("amontons")), *options, "job"]
    if n_ranks:
        command = ["mpiexec", "-n", str(n_ranks), str(program("amontons-mpi")), *options, "job"]
    try:
        done = subprocess.run(command, cwd=folder, env=environment(), capture_output=True, text=True, timeout=seconds, check=False)
    except subprocess.TimeoutExpired:
        return Outcome(EXIT_TIME, f"stopped after {seconds:g} s")
    outcome = Outcome(done.returncode, re.sub(r"\x1b\[\d*[mK]", "", done.stdout + done.stderr))
    path = folder / "job.vtkhdf"
    if path.exists():
        with h5py.File(path) as file:
            outcome.counts = {name: file[f"AMONTONS/history/{name}"][:] for name in COUNTS}
            outcome.fields = {name: file[f"VTKHDF/PointData/{name}"][:] for name in FIELDS}
            outcome.strain_energy = float(np.max(file["AMONTONS/history/strain_energy"][:], initial=0.0))
            outcome.statuses = file["AMONTONS/contact/status"][:]
    return outcome


def ranks_of(process: subprocess.Popen[bytes]) -> list[int]:
    """The processes of the ranks."""
    found = subprocess.run(["pgrep", "-P", str(process.pid)], capture_output=True, text=True, check=False).stdout.split()
    return [int(pid) for pid in found]


def scale_of(job: Outcome, name: str) -> float:
    """The largest value of a field; of reactions no less than a lower bound of the largest nodal force. Twice the strain energy is the
    sum of f'u over the n nodes, so that some node has at least f = 2 W / (n |u|): bodies that hold themselves (a ring that rotates) have
    reactions at the rounding of their forces."""
    largest = float(np.abs(job.fields[name]).max(initial=0.0))
    u = float(np.abs(job.fields["U"]).max(initial=0.0))
    if name == "RF" and u > 0 and largest > 0:
        n_nodes = job.fields["U"].shape[0]  # of all frames: the bound is only lower
        largest = max(largest, 2 * job.strain_energy / (n_nodes * u))
    return largest


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
        scale = scale_of(serial, name)
        if scale > 0:
            worst = max(worst, float(np.abs(values - ranks.fields[name]).max()) / scale)
    return "", worst


def with_solver(deck: str, solver: str) -> str:
    """The deck with a solver on every STATIC card."""
    bare = re.sub(r"^(\*STATIC[^\n]*?), *SOLVER *= *[^,\n]*", r"\1", deck, flags=re.M | re.I)
    return re.sub(r"^\*STATIC", f"*STATIC, SOLVER={solver}", bare, flags=re.M | re.I) if solver else deck


@cache
def all_decks() -> dict[str, str]:
    """The generated decks, made once."""
    return {
        f"{kind}/{name}": text
        for kind, module in (("feature", feature_decks), ("mixed", mixed_decks), ("behaviour", behaviour_decks))
        for name, text in module.cases().items()
    }


@dataclass(frozen=True)
class Row:
    """A comparison."""

    deck: str
    n_ranks: int
    code: int  #: exit code of the serial program
    what: str  #: that differs; "": nothing
    worst: float  #: difference of a field over its largest value


@dataclass
class Comparison:
    """Runs decks both ways and keeps a row for each."""

    folder: Path
    ranks: list[int]
    solver: str
    seconds: float
    record: Path | None
    rows: list[Row] = field(default_factory=list)

    def compare(self, name: str, deck: str, *options: str) -> Path:
        """A deck; the folder of the serial job, which has its results."""
        serial_folder = self.folder / re.sub(r"\W+", "-", name)
        serial = run(serial_folder, deck, 0, *options, seconds=self.seconds)
        if serial.code == EXIT_TIME:
            self.add(Row(name, 0, EXIT_TIME, serial.text, 0.0))
            return serial_folder
        for n in self.ranks:
            what, worst = difference(serial, run(self.folder / "ranks", with_solver(deck, self.solver), n, *options))
            self.add(Row(name, n, serial.code, what, worst))
            shutil.rmtree(self.folder / "ranks")
        return serial_folder

    def add(self, row: Row) -> None:
        """Keeps a row; what differs is printed at once."""
        self.rows.append(row)
        if row.n_ranks and is_unequal(row):
            print(describe(row), file=sys.stderr, flush=True)
        if self.record:
            with self.record.open("a") as file:
                file.write(f"{row.deck}\t{row.n_ranks}\t{row.code}\t{row.what}\t{row.worst:.3e}\n")


def is_unequal(row: Row) -> bool:
    """Whether counts, statuses or fields differ."""
    return row.what != "" or row.worst > TOLERANCE


def describe(row: Row) -> str:
    """A row that differs, in words."""
    return f"{row.deck} on {row.n_ranks}: {row.what or f'fields by {row.worst:.1e}'}"


def read_rows(path: Path) -> list[Row]:
    """The rows of a file; of a comparison that was repeated the last."""
    found: dict[tuple[str, int], Row] = {}
    for line in path.read_text().splitlines():
        deck, n, code, what, worst = line.split("\t")
        found[deck, int(n)] = Row(deck, int(n), int(code), what, float(worst))
    return list(found.values())


def print_table(rows: Sequence[Row]) -> None:
    """The table, the exit codes and what differs."""
    print("| ranks | decks | equal statuses, increments, iterations | largest difference of displacements and reactions |")
    print("|---|---|---|---|")
    for n in sorted({row.n_ranks for row in rows if row.n_ranks}):
        mine = [row for row in rows if row.n_ranks == n]
        print(f"| {n} | {len(mine)} | {sum(row.what == '' for row in mine)} | {max(row.worst for row in mine):.1e} |")
    codes = {row.deck: row.code for row in rows}.values()
    ends = {code: list(codes).count(code) for code in sorted(set(codes))}
    print(f"\nExit codes of the serial program and how often ({EXIT_TIME}: took too long, left out): {ends}")
    print("\n".join(describe(row) for row in rows if row.n_ranks and is_unequal(row)))


def compare_cases(comparison: Comparison, every: int, first: int, only: str) -> None:
    """The decks of all verification cases; a case that fails by itself is printed and left to verify/cases."""
    from verify.cases.proof import Case, Job
    from verify.invariance.test_every_case import cases

    class Compared(Case):
        """A case whose jobs are compared, and whose own checks are not judged again."""

        def run(self, deck: str, name: str = "job", requested: int = 0, threads: int = 1) -> Job:
            """A deck both ways; the job of the serial program."""
            del requested, threads
            folder = comparison.compare(f"{self.name} {name}", deck)
            return Job(folder / "job.vtkhdf", name)

        def done(self) -> None:
            """Nothing: verify/cases judges the case."""

    def run_program(words: Sequence[str | Path], cwd: Path | None = None, threads: int = 1) -> subprocess.CompletedProcess[str]:
        del threads
        command = [str(program("amontons")), *map(str, words)]
        return subprocess.run(command, cwd=cwd, env=environment(), capture_output=True, text=True, timeout=TIME_LIMIT, check=False)

    for case in [case for case in cases() if only in str(case.id)][first::every]:
        function, values = case.values
        with tempfile.TemporaryDirectory() as work:
            comparison.folder = Path(work)
            fixtures = {
                "proof": lambda name, **words: Compared(name, runner=run_program, work=Path(work), pages=None, **words),  # noqa: B023
                "run": run_program, "tmp_path": Path(work), "request": SimpleNamespace(),
            }  # fmt: skip
            try:
                function(**values, **{name: fixture for name, fixture in fixtures.items() if name in signature(function).parameters})
            except Exception as error:  # noqa: BLE001
                print(f"{case.id} ends early: {type(error).__name__}: {str(error)[:120]}", file=sys.stderr, flush=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", action="store_true")
    parser.add_argument("--ranks", nargs="*", type=int, default=[1, 2, 4])
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--only", default="")
    parser.add_argument("--solver", default="")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--rows", type=Path)
    parser.add_argument("--table", type=Path)
    options = parser.parse_args(arguments)
    if options.table:
        print_table(read_rows(options.table))
        return 0
    with tempfile.TemporaryDirectory() as folder:
        comparison = Comparison(Path(folder), options.ranks, options.solver, options.seconds, options.rows)
        if options.cases:
            compare_cases(comparison, options.every, options.first, options.only)
        else:
            for name, deck in list(all_decks().items())[options.first :: options.every]:
                if options.only in name:
                    shutil.rmtree(comparison.compare(name, deck, DIALECT))
    print_table(comparison.rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
