"""Time and memory of the results in one file and in partitions: a table in Markdown.

    python -m verify.benchmark.partitions_table [--edge 36] [--ranks 2] [--partitions 2] [--increments 4] [--turns 3]

A linear cube of C3D8 with the given elements an edge (36: 147 852 unknowns) in several increments, each of which is written. The seconds and
the growth of the peak are those of the phase `output` that the first rank prints; without a checkpoint, so that the disk has no part in them but
through its cache. The peaks are those of the ranks by GNU time (apt-get install time). Both ways run in turns; seconds are medians.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import re
import statistics
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

from verify.benchmark.estimate_table import cube
from verify.benchmark.large_cube import phases_of
from verify.distributed.ranks_and_serial import environment, program


def measured(folder: Path, n_ranks: int, *options: str) -> tuple[float, float, list[float]]:
    """Seconds of the output, by how much it raises the peak of the first rank [MB], and the peaks of the ranks in their order [MB]."""
    rank = ["sh", "-c", f'exec /usr/bin/time -o peak.$OMPI_COMM_WORLD_RANK -f %M {program("amontons-mpi")} "$@"', "rank"]
    command = ["mpiexec", "-n", str(n_ranks), *rank, "--progress=none", "--no-checkpoint", *options, "job"]
    done = subprocess.run(command, cwd=folder, env=environment(), capture_output=True, text=True, check=True)
    seconds, growth = phases_of(re.sub(r"\x1b\[\d*[mK]", "", done.stdout))["output"]
    return seconds, growth, [float((folder / f"peak.{r}").read_text()) / 1024 for r in range(n_ranks)]


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--edge", type=int, default=36)
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--partitions", type=int, default=2)
    parser.add_argument("--increments", type=int, default=4)
    parser.add_argument("--turns", type=int, default=3)
    options = parser.parse_args(arguments)
    ways: dict[str, tuple[str, ...]] = {"one file": (), f"{options.partitions} partitions": ("--partitions", str(options.partitions))}
    runs: dict[str, list[tuple[float, float, list[float]]]] = {way: [] for way in ways}
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        step = f", SOLVER=ITERATIVE SCALING, DIRECT\n{1.0 / options.increments!r}, 1."
        (folder / "job.inp").write_text(cube(options.edge, step))
        for _ in range(options.turns):
            for way, words in ways.items():
                runs[way].append(measured(folder, options.ranks, *words))
    print("| results | output [s] | raises the peak of rank 0 by [MB] | peak of " + " | peak of ".join(f"rank {r} [MB]" for r in range(options.ranks)) + " |")
    print("|---" * (3 + options.ranks) + "|")
    for way, rows in runs.items():
        peaks = [statistics.median(row[2][r] for row in rows) for r in range(options.ranks)]
        figures = " | ".join(f"{peak:.0f}" for peak in peaks)
        print(f"| {way} | {statistics.median(row[0] for row in rows):.2f} | {statistics.median(row[1] for row in rows):.0f} | {figures} |")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
