"""Growth of conjugate gradients with the model: two blocks pressed and sheared with friction, by the cells along an edge.

    python -m verify.study.gradients_growth [--cells 8 16 24 36] [--preconditioner NODAL] [--loads 2] [--program bin/amontons]
        [--outdir DIR]

A block of n x n x n/2 cells lies on a table of n + 2 x n + 2 x n/2 cells, mu = 0.3, small displacements; it is pressed in one increment
and sheared in another. The table says: unknowns, iterations of conjugate gradients and rounds of contact in both increments, failed
attempts, seconds of the processor, and the peak of memory, in all and by unknown; below it the exponent of the iterations.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import os
import re
import sys
import tempfile
from pathlib import Path

import numpy as np

from verify.decks.make_decks import block
from verify.decks.sheets import between, fix, pair, solid_deck
from verify.study.contact_table import STEEL, head, steps
from verify.study.gradients_table import KRYLOV
from verify.study.ironing_table import ROOT

MU = 0.3


def two_blocks(n: int, preconditioner: str, n_loads: int) -> tuple[str, int]:
    """The deck, and its unknowns."""
    layers, edge, wide = n // 2, between(0, 1, n), between(-0.5, 1.5, n + 2)
    body, table = block(edge, edge, between(0, 0.5, layers), "BODY"), block(wide, wide, between(-1, 0, layers), "TABLE")
    loads = [fix("TABLE_BOTTOM, 1, 3", "BODY_TOP, 1, 2", "BODY_TOP, 3, 3, -0.002"), fix("BODY_TOP, 1, 1, 0.004")]
    deck = solid_deck([(body, STEEL), (table, STEEL)], pair("BODY_BOTTOM", "TABLE_TOP", MU), steps("ALL", 1, False, *loads[:n_loads]))
    cards = f"*SOLVER CONTROLS, PRECONDITIONER={preconditioner}\n*STATIC, SOLVER=CONJUGATE GRADIENTS"
    return re.sub(r"^\*STATIC", cards, deck, flags=re.M), 3 * (layers + 1) * ((n + 1) ** 2 + (n + 3) ** 2)


def run(command: list[str | Path]) -> tuple[bool, float, float]:
    """Whether a command ends well, seconds of the processor, and its own peak of memory [MB]."""
    child = os.posix_spawn(command[0], [str(word) for word in command], {**os.environ, "OMP_NUM_THREADS": "1"})
    _, status, usage = os.wait4(child, 0)
    return status == 0, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main() -> int:
    """Runs the sizes, one after the other."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--outdir", type=Path)
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    parser.add_argument("--cells", nargs="+", type=int, default=[8, 16, 24, 36])
    parser.add_argument("--preconditioner", default="NODAL")
    parser.add_argument("--loads", type=int, choices=[1, 2], default=2, help="1: pressed alone")
    options = parser.parse_args()
    folder = options.outdir or Path(tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)
    print(*head("unknowns", "iterations", "rounds", "failed attempts", "s", "MB", "kB by unknown"), sep="\n")
    sizes, counts = [], []
    for n in options.cells:
        deck, unknowns = two_blocks(n, options.preconditioner, options.loads)
        (folder / f"blocks_{n}.inp").write_text(deck)
        is_done, seconds, megabytes = run([options.program, "--quiet", "--no-checkpoint", "--outdir", folder, folder / f"blocks_{n}.inp"])
        lines = (folder / f"blocks_{n}.cvg").read_text().splitlines()
        rows = [line.split() for line in lines if re.match(r"\s*\d+\s+\d+\s+\d+\s+\d+\s+\d", line)]
        failed = len({tuple(w[:3]) for w in rows}) - options.loads
        sizes, counts = [*sizes, unknowns], [*counts, sum(int(w[KRYLOV]) for w in rows)]
        words = [f"{counts[-1]}", f"{len(rows)}", f"{failed}"] if is_done else ["-", "-", "-"]
        print(f"| {unknowns} | {' | '.join(words)} | {seconds:.0f} | {megabytes:.0f} | {1.024**2 * 1e3 * megabytes / unknowns:.2f} |", flush=True)
        (folder / f"blocks_{n}.vtkhdf").unlink(missing_ok=True)
    if len(sizes) > 1:
        print(f"Exponent of the iterations: {np.polyfit(np.log(sizes), np.log(np.maximum(counts, 1)), 1)[0]:.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
