"""Iterations, halo and messages of the iteration on two levels over the ranks: tables in Markdown.

    python -m verify.benchmark.ranks_table [--fixed 36] [--ranks 1 2 4 16 64] [--weak 10] [--weak-ranks 1 2 4 8 16]
    python -m verify.benchmark.ranks_table --speed linear plastic [--edge 54]
    python -m verify.benchmark.ranks_table --shares [--ranks 1 2 4] [--edge 54]
    python -m verify.benchmark.ranks_table --estimates 24 54 [--ranks 2 4]
    python -m verify.benchmark.ranks_table --solvers [--ranks 1 2 4 8 16] [--edge 16]
    python -m verify.benchmark.ranks_table --plates 80 [--ranks 2 4]

The first command solves a fixed cube of C3D8 on so many ranks, and cubes whose unknowns grow with the ranks (weak scaling: the edge is
that of one rank times the cube root of the ranks). Iterations and counters are those that the job prints; they do not depend on how
many cores there are. "Paper" is the halo of a cube of so many unknowns: the nodes of its six faces, three numbers of eight bytes each.

With --speed it takes the elapsed time that the job prints on one and on two ranks in turns, three times, on a machine with two free
cores, and prints medians and their ratio: a linear cube, and the same cube with plasticity and NLGEOM in three increments.

With --shares it prints what the rank with most takes for the linear cube: processor seconds, in which it may wait for others, and the
peak of memory (GNU time, apt-get install time). They depend little on what else the machine does.

With --estimates it compares what `amontons --estimate` says of several ranks for linear cubes of so many elements an edge with what
the job then takes: the peak of memory of the first rank, and elapsed seconds, which need as many free cores.

With --solvers it prints the iterations of the program's own two levels and of PETSc's solvers for a fixed cube of C3D8 and for a bar of
C3D20, ten times as long as thick and nearly incompressible (nu = 0.49).

With --plates it compares the wide plates of verify.benchmark.wide_contact, of so many faces an edge, with the serial program: counts,
statuses of contact, displacements and reactions.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import re
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from verify.benchmark.estimate_table import cube
from verify.benchmark.large_cube import krylov_iterations
from verify.benchmark.plastic_cube import SOLVER, compressed_cube
from verify.benchmark.wide_contact import Model, deck_of
from verify.distributed import ranks_and_serial
from verify.distributed.ranks_and_serial import Outcome, difference, run, with_solver
from verify.invariance.test_solvers import cantilever

TIME_LIMIT = 3600.0  #: of a job [s]
HEAD = (
    "| ranks | unknowns | iterations | unknowns of a rank | halo | neighbours | messages an iteration | kB an iteration | kB a product | paper | coarse |\n"
    "|---|---|---|---|---|---|---|---|---|---|---|"
)
COUNTERS = re.compile(
    r"A rank has at most (\d+) unknowns, (\d+) in its halo and (\d+) neighbours; it sends ([\d.]+) messages and ([\d.]+) kilobytes in a "
    r"Krylov iteration\. (\d+) coarse unknowns"
)
EXCHANGES = 4  #: of an iteration: the direction, the residual, what U gives in the halo, and its sum
N_TURNS = 3
HARDENING = 2.0e4  #: of the plastic cube [stress]
SOLVERS = {"two levels": "ITERATIVE SCALING", "GAMG": "GAMG", "hypre": "HYPRE", "BDDC": "BDDC"}


def checked(folder: Path, deck: str, n_ranks: int) -> Outcome:
    """Runs a deck, which must end well."""
    outcome = run(folder, deck, n_ranks, seconds=TIME_LIMIT)
    if outcome.code != 0:
        raise SystemExit(f"The job on {n_ranks} ranks ended with exit code {outcome.code}:\n{outcome.text}")
    return outcome


def row(folder: Path, edge: int, n_ranks: int) -> str:
    """A row of the table."""
    text = checked(folder, cube(edge, SOLVER), n_ranks).text
    unknowns = 3 * edge * (edge + 1) ** 2
    start = f"| {n_ranks} | {unknowns} | {krylov_iterations(text)} | "
    found = COUNTERS.search(text)
    if not found:
        return start + f"{unknowns} | 0 | 0 | 0 | 0 | 0 | - | - |"
    own, halo, neighbours, messages, kilobytes, coarse = found.groups()
    paper = 6 * (int(own) / 3) ** (2 / 3) * 24e-3
    return start + (
        f"{own} | {halo} | {neighbours} | {messages} | {kilobytes} | {float(kilobytes) / EXCHANGES:.1f} | {paper:.0f} | {coarse} |"
    )


def whole_job(text: str) -> tuple[float, float]:
    """Elapsed seconds and peak of memory [MB] that a job prints."""
    found = re.search(r"the whole job +([\d.]+) +(\d+)", text)
    assert found, text
    return float(found[1]), float(found[2])


def estimated_ranks(text: str) -> dict[int, tuple[float, float]]:
    """Seconds and megabytes of each number of ranks in an estimate."""
    found = re.findall(r"(\d+) take some ([\d.]+) s and (\d+) MB each", text)
    return {int(n): (float(seconds), float(megabytes)) for n, seconds, megabytes in found}


def compare_estimates(folder: Path, edge: int, ranks: Sequence[int]) -> None:
    """Prints rows of the table."""
    deck = cube(edge, SOLVER)
    (folder / "job.inp").write_text(deck)
    estimate = estimated_ranks(ranks_and_serial.execute(folder, 0, "--estimate").text)
    for n in ranks:
        seconds, megabytes = whole_job(checked(folder, deck, n).text)
        print(f"| {3 * edge * (edge + 1) ** 2} | {n} | {estimate[n][1]:.0f} | {megabytes:.0f} | {estimate[n][0]:.1f} | {seconds:.1f} |", flush=True)


def speed(folder: Path, name: str, deck: str) -> str:
    """Elapsed seconds of one and two ranks in turns."""
    seconds: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(N_TURNS):
        for n, times in seconds.items():
            times.append(whole_job(checked(folder, deck, n).text)[0])
    one, two = (statistics.median(times) for times in seconds.values())
    return f"| {name} | {one:.1f} | {two:.1f} | {one / two:.2f} |"


def shares(folder: Path, edge: int, n_ranks: int) -> str:
    """Processor seconds and peak of memory of a rank, at most."""
    (folder / "job.inp").write_text(cube(edge, SOLVER))
    command = ["mpiexec", "-n", str(n_ranks), "/usr/bin/time", "-f", "a rank: %U %S %M", str(ranks_and_serial.program("amontons-mpi")), "job"]
    done = subprocess.run(command, cwd=folder, env=ranks_and_serial.environment(), capture_output=True, text=True, check=True)
    lines = [[float(value) for value in found] for found in re.findall(r"a rank: ([\d.]+) ([\d.]+) (\d+)", done.stderr)]
    assert len(lines) == n_ranks
    seconds = max(user + system for user, system, _ in lines)
    return f"| {n_ranks} | {seconds:.1f} | {max(peak for *_, peak in lines) / 1024:.0f} |"


def iterations_of(folder: Path, deck: str, solver: str, n_ranks: int) -> str:
    """Of a linear job; more than the limit: it ended with a factor."""
    text = checked(folder, with_solver(deck, solver), n_ranks).text
    return ("> " if "a factor is used" in text else "") + krylov_iterations(text)


def compare_solvers(folder: Path, edge: int, ranks: Sequence[int]) -> None:
    """Prints the table."""
    print(f"| model | ranks | {' | '.join(SOLVERS)} |\n|{'---|' * (2 + len(SOLVERS))}")
    for name, deck in (("cube", cube(edge, "")), ("bar", cantilever("C3D20", (3, 3, 30), 0.49))):
        for n in ranks:
            print(f"| {name} | {n} | {' | '.join(iterations_of(folder, deck, solver, n) for solver in SOLVERS.values())} |", flush=True)


def compare_plates(folder: Path, size: int, ranks: Sequence[int]) -> None:
    """Prints the table."""
    deck = deck_of(Model(size, increments=2))
    serial = checked(folder, deck, 0)
    counts = " ".join(str(n) for n in re.findall(r"Newton iterations +(\d+)", serial.text))
    print("| faces an edge | ranks | Newton iterations, serial | what differs | largest difference |\n|---|---|---|---|---|")
    for n in ranks:
        what, worst = difference(serial, checked(folder, deck, n))
        print(f"| {size} | {n} | {counts} | {what or 'no count, no status'} | {worst:.1e} |", flush=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fixed", type=int, default=36)
    parser.add_argument("--ranks", nargs="*", type=int, default=[1, 2, 4, 16, 64])
    parser.add_argument("--weak", type=int, default=10)
    parser.add_argument("--weak-ranks", nargs="*", type=int, default=[1, 2, 4, 8, 16])
    parser.add_argument("--speed", nargs="*", choices=["linear", "plastic"], default=[])
    parser.add_argument("--edge", type=int, default=54)
    parser.add_argument("--shares", action="store_true")
    parser.add_argument("--estimates", nargs="*", type=int, default=[])
    parser.add_argument("--solvers", action="store_true")
    parser.add_argument("--plates", type=int, default=0)
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if options.plates:
            compare_plates(folder, options.plates, options.ranks)
            return 0
        if options.solvers:
            compare_solvers(folder, options.edge, options.ranks)
            return 0
        if options.estimates:
            print("| unknowns | ranks | MB each: estimate | taken | s: estimate | elapsed |\n|---|---|---|---|---|---|")
            for edge in options.estimates:
                compare_estimates(folder, edge, [n for n in options.ranks if n in (2, 4, 8, 16)])
            return 0
        if options.shares:
            print("| ranks | processor s of a rank | peak of a rank, MB |\n|---|---|---|")
            for n in options.ranks:
                print(shares(folder, options.edge, n), flush=True)
            return 0
        if options.speed:
            print(f"| {options.edge**3} elements | one rank, s | two ranks, s | ratio |\n|---|---|---|---|")
            decks = {"linear": cube(options.edge, SOLVER), "plastic": compressed_cube(options.edge, HARDENING)}
            for job in options.speed:
                print(speed(folder, job, decks[job]), flush=True)
            return 0
        for title, rows in (
            ("A fixed cube:", [(options.fixed, n) for n in options.ranks]),
            ("A cube that grows with the ranks:", [(round(options.weak * n ** (1 / 3)), n) for n in options.weak_ranks]),
        ):
            print(f"{title}\n\n{HEAD}")
            for edge, n in rows:
                print(row(folder, edge, n), flush=True)
            print()
    return 0


if __name__ == "__main__":
    sys.exit(main())
