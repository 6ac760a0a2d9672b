"""Newton's iteration on a cube that yields, with and without the line search: residuals and step lengths.

    python -m verify.benchmark.plastic_cube [--edge 24] [--hardening 200] [--searches AUTO NONE]

A cube of C3D8, clamped at both ends, hardens by a thousandth of E or as given and is compressed to three times its yield strain in three increments,
so that almost all of it begins to yield in the second. It prints a line for each increment: the largest residual after each iteration
over the largest force, and behind it the step length where that is not 1. The finer the mesh, the larger the residuals of full steps:
at 24 elements an edge they still converge, at 54 (half a million unknowns, some minutes) they do not, even with ten times the hardening.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from verify.benchmark.estimate_table import cube
from verify.distributed.ranks_and_serial import run
from verify.readers.sta_cvg_files import Iteration, read_cvg

SOLVER = ", SOLVER=ITERATIVE SCALING"
TIME_LIMIT = 3600.0  #: of a job [s]


def compressed_cube(edge: int, hardening: float, search: str = "AUTO") -> str:
    """The deck: isotropic hardening [stress], NLGEOM, three increments that are not cut back."""
    deck = cube(edge, SOLVER).replace("*ELASTIC\n", f"*PLASTIC\n200., 0.\n{200 + 0.1 * hardening:g}, 0.1\n*ELASTIC\n")
    deck = deck.replace("*STEP\n", "*STEP, NLGEOM\n").replace("*CLOAD\nHIGH, 3, -1.", "*BOUNDARY\nHIGH, 3, 3, -0.003")
    return deck.replace(f"*STATIC{SOLVER}\n", f"*STATIC{SOLVER}, DIRECT\n1., 3.\n*LINE SEARCH, TYPE={search}\n")


def residuals(iterations: list[Iteration], increment: int) -> str:
    """Residuals over the largest force of an increment, and lengths."""
    return ", ".join(
        f"{row.residual / 100:.2g}" + ("" if row.step_length == 1 else f" ({row.step_length:.2f})")
        for row in iterations
        if row.increment == increment
    )


def main() -> None:
    """Prints the residuals."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--edge", type=int, default=24)
    parser.add_argument("--hardening", type=float, default=200.0, help="[stress]")
    parser.add_argument("--searches", nargs="*", default=["AUTO", "NONE"])
    options = parser.parse_args()
    for search in options.searches:
        with tempfile.TemporaryDirectory() as folder:
            outcome = run(Path(folder), compressed_cube(options.edge, options.hardening, search), 0, seconds=TIME_LIMIT)
            print(f"{search}: exit code {outcome.code}", flush=True)
            iterations = read_cvg(Path(folder) / "job.cvg")
        for increment in sorted({row.increment for row in iterations}):
            print(f"  increment {increment}: {residuals(iterations, increment)}", flush=True)


if __name__ == "__main__":
    main()
