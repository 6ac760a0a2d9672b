"""Ironing over facets: how many Newton iterations each increment takes, for friction, shape and step size.

    python -m verify.study.ironing_table [--outdir DIR] [--line-search TYPE] [--program bin/amontons]

A stiff indenter, its bottom curved or flat with sharp corners, is pressed 0.25 into a soft slab with facets of 0.3 and
dragged 6 along it, in increments of a half, 1.3 and 2.5 facets. The increments are requested as the first and the
largest; the program may cut back. The table says: requested increments, increments made, failed attempts, Newton iterations
(failed attempts included), iterations per requested increment.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from verify.decks.make_decks import arc_indenter, block, contact_cards, graded, join, material_cards, mesh_cards
from verify.readers.sta_cvg_files import read_sta

ROOT = Path(__file__).resolve().parents[2]


PRESS_DEPTH, DRAG, FACET, GAP = 0.25, 6.0, 0.3, 0.01


@dataclass
class Outcome:
    """What one run did."""

    requested: int
    made: int
    failed: int
    iterations: int
    is_done: bool

    @property
    def per_requested(self) -> float:
        """Newton iterations, failed attempts included, per requested increment."""
        return self.iterations / self.requested


def ironing_deck(shape: str, mu: float, slide: float, line_search: str = "AUTO") -> str:
    """The deck of one run; `slide` is the drag in one increment."""
    slab = block(np.linspace(0.0, 12.0, 41), [0.0, 1.0], 3.0 - graded(3.0, 0.3, 3, 4)[::-1], "SLAB")
    if shape == "curved":
        iron = arc_indenter(2.5, 0.6, 0.75, 3.0 + GAP, 4.2, 8, 6, "IRON")
    else:
        iron = block(np.linspace(1.9, 3.1, 9), [0.0, 1.0], np.linspace(3.0 + GAP, 4.2, 7), "IRON")
    mesh = join([iron, slab])
    mesh.select("PLANE", lambda p: np.full(len(p), True))
    size = slide / DRAG
    return (
        mesh_cards(mesh)
        + material_cards("STIFF", (6896.0, 0.32), "IRON")
        + material_cards("SOFT", (689.6, 0.32), "SLAB")
        + contact_cards("IRON_BOTTOM", "SLAB_TOP", mu)
        + f"*STEP, NLGEOM, INC=1000\n*STATIC\n0.2, 1., 1e-6, 0.2\n*LINE SEARCH, TYPE={line_search}\n"
        + f"*BOUNDARY\nSLAB_BOTTOM, 1\nSLAB_BOTTOM, 3\nPLANE, 2\nIRON_TOP, 1\nIRON_TOP, 3, 3, {-PRESS_DEPTH - GAP}\n*END STEP\n"
        + f"*STEP, NLGEOM, INC=1000\n*STATIC\n{size:.10g}, 1., 1e-6, {size:.10g}\n*BOUNDARY\nIRON_TOP, 1, 1, {DRAG}\n*END STEP\n"
    )


def run_case(program: Path, folder: Path, name: str, deck: str, requested: int, seconds: float | None = None) -> Outcome:
    """Runs one deck, for some seconds of a processor at most, and counts the rows of its .sta file."""
    (folder / f"{name}.inp").write_text(deck)
    command = [program, "--quiet", "--outdir", folder, folder / f"{name}.inp"]

    def limit() -> None:
        if seconds is not None:
            resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds) + 1))

    done = subprocess.run(command, check=False, capture_output=True, preexec_fn=limit)  # noqa: PLW1509 (no threads here)
    return count_rows(folder / f"{name}.sta", requested, done.returncode == 0)


def count_rows(file: Path, requested: int, is_done: bool) -> Outcome:
    """Counts the rows of a .sta file: increments made, failed attempts, iterations of both."""
    attempts = read_sta(file)
    failed = sum(attempt.is_failed for attempt in attempts)
    return Outcome(requested, len(attempts) - failed, failed, sum(attempt.iterations for attempt in attempts), is_done)


def main() -> int:
    """Runs all cases and prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--outdir", type=Path)
    parser.add_argument("--line-search", default="AUTO")
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    parser.add_argument("--only", default="", help="run only the cases whose name contains this")
    options = parser.parse_args()
    folder = options.outdir or Path(tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)
    print("shape    mu  slide  facets  requested  made  failed  iterations  per request")
    is_good = True
    for shape in ("curved", "flat"):
        for mu in (0.0, 0.3, 0.6):
            for slide in (0.15, 0.4, 0.75):
                name = f"ironing_{shape}_{mu:g}_{slide:g}"
                if options.only not in name:
                    continue
                requested = 5 + round(DRAG / slide)
                o = run_case(options.program, folder, name, ironing_deck(shape, mu, slide, options.line_search), requested)
                is_good &= o.is_done and o.per_requested <= 12.0
                print(
                    f"{shape:7s}{mu:4.1f}{slide:7.2f}{slide / FACET:8.1f}{o.requested:11d}{o.made:6d}{o.failed:8d}"
                    f"{o.iterations:12d}{o.per_requested:13.1f}{'' if o.is_done else '   STOPPED'}",
                    flush=True,
                )
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
