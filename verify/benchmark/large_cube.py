"""Time by phase, memory and Krylov iterations of a large linear cube of C3D8, by number of threads.

    python -m verify.benchmark.large_cube [--edge 54] [--threads 1 2] [--runs 1] [--touch GB] [--program bin/amontons]

A cube of 54 elements an edge has half a million unknowns, one of 70 has 1.07 million. The threads are timed in turns; of several runs
the one with the least elapsed time counts. The machine should have as many free cores as threads. On a virtual machine whose host takes
free memory back, the first use of a GB can take a second or two: with --touch so many GB are used before each job.
SPDX-License-Identifier: GPL-3.0-or-later"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from verify.benchmark.bench import Run, linear_deck, timed, unknowns_of


def phases_of(text: str) -> dict[str, tuple[float, float]]:
    """Elapsed seconds and growth of the peak of memory [MB] by phase, from the table at the end of a job."""
    rows = re.findall(r"^    (\w+) +([\d.]+) +[\d.]+ % +(-?\d+)\.$", text.partition("by phase")[2], re.MULTILINE)
    return {name: (float(seconds), float(megabytes)) for name, seconds, megabytes in rows}


def krylov_iterations(text: str) -> str:
    """Krylov iterations of a job; '-' with a factor."""
    found = re.search(r"Krylov iterations +(\d+)", text)
    return found[1] if found else "-"


def table(best: dict[int, Run]) -> str:
    """The phases as rows, the threads as columns."""
    columns = {threads: phases_of(run.text) for threads, run in best.items()}
    lines = ["| phase | " + " | ".join(f"{n} thread{'s'[: n > 1]} [s] | grows the peak by [MB]" for n in best) + " |", "|---" * (2 * len(best) + 1) + "|"]
    for name in next(iter(columns.values())):
        lines.append(f"| {name} | " + " | ".join(f"{columns[n][name][0]:.2f} | {columns[n][name][1]:.0f}" for n in best) + " |")
    lines.append("| elapsed, peak | " + " | ".join(f"{run.elapsed:.1f} | {run.megabytes:.0f}" for run in best.values()) + " |")
    lines.append("| Krylov iterations | " + " | ".join(f"{krylov_iterations(run.text)} | " for run in best.values()) + " |")
    lines.append("| processor | " + " | ".join(f"{run.seconds:.1f} | " for run in best.values()) + " |")
    return "\n".join(lines)


def touch(gigabytes: float) -> None:
    """Lets another process use memory, so that the peak of the job is its own."""
    if gigabytes > 0:
        subprocess.run([sys.executable, "-c", f"import numpy; numpy.ones({int(gigabytes * 1e9 / 8)})"], check=True)


def main() -> int:
    """Runs the cube and prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--edge", type=int, default=54, help="elements on each edge")
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--runs", type=int, default=1)
    parser.add_argument("--touch", type=float, default=0.0, help="GB to use before each job")
    parser.add_argument("--program", type=Path, default=Path("bin/amontons"))
    options = parser.parse_args()
    best: dict[int, Run] = {}
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        deck = linear_deck(options.edge)
        (folder / "cube.inp").write_text(deck)
        for _ in range(options.runs):
            for threads in options.threads:
                touch(options.touch)
                run = timed([str(options.program.resolve()), "cube", "--progress=none"], folder, threads)
                if threads not in best or run.elapsed < best[threads].elapsed:
                    best[threads] = run
    print(f"{unknowns_of(deck)} unknowns\n")
    print(table(best))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
