"""Conjugate gradients on the decks of input/: iterations of an increment, and the difference from Newton's method.

    python -m verify.study.gradients_samples [--decks shear_block ironing] [--preconditioners NODAL FACTOR] [--program bin/amontons]
        [--outdir DIR]

Every step of a deck has SOLVER=CONJUGATE GRADIENTS, its increments are those of the deck. The table says: increments made, failed
attempts, iterations of conjugate gradients in an increment (failed attempts included), in the mean and at most, seconds of the processor,
difference of the displacements at the end from those of Newton's method over the largest, and slave nodes of another status that are not
near their limit.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from pathlib import Path

import numpy as np

from verify.readers.sta_cvg_files import read_sta
from verify.study.contact_table import head
from verify.study.gradients_table import KRYLOV, displacements, other_statuses
from verify.study.ironing_table import ROOT
from verify.study.runs import execute

DECKS = ("three_cubes", "hertz_octant", "shear_block", "ironing")
PRECONDITIONERS = ("NODAL", "FACTOR")


def sample(name: str) -> str:
    """A deck of input/ with its mesh."""
    deck = (ROOT / "input" / f"{name}.inp").read_text()
    return re.sub(r"^\*INCLUDE, INPUT=(\S+)\n", lambda found: (ROOT / "input" / found[1]).read_text(), deck, flags=re.M)


def with_gradients(deck: str, preconditioner: str, numbers: str = "", length: str = "") -> str:
    """A deck with conjugate gradients in all its steps, and a line search."""
    cards = f"*SOLVER CONTROLS, PRECONDITIONER={preconditioner}\n{numbers}" + (f"*LINE SEARCH, TYPE={length}\n" if length else "")
    return re.sub(r"^\*STATIC", cards + "*STATIC, SOLVER=CONJUGATE GRADIENTS", deck, flags=re.M)


def iterations(file: Path) -> list[int]:
    """Of conjugate gradients in each increment of a .cvg file, failed attempts included."""
    counts: dict[tuple[str, ...], int] = {}
    for line in file.read_text().splitlines():
        if re.match(r"\s*\d+\s+\d+\s+\d+\s+\d", line):
            words = line.split()
            counts[tuple(words[:2])] = counts.get(tuple(words[:2]), 0) + int(words[KRYLOV])
    return list(counts.values())


def friction(deck: str) -> float:
    """The coefficient of the deck's only law; 0 without one."""
    found = re.search(r"^\*FRICTION\n([\d.]+)", deck, flags=re.M)
    return float(found[1]) if found else 0.0


def main() -> int:
    """Runs the decks."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--outdir", type=Path)
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    parser.add_argument("--decks", nargs="+", choices=DECKS, default=DECKS)
    parser.add_argument("--preconditioners", nargs="+", choices=PRECONDITIONERS, default=PRECONDITIONERS)
    parser.add_argument("--seconds", type=float, default=600.0, help="most time of a processor for one run")
    options = parser.parse_args()
    folder = options.outdir or Path(tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)
    columns = ("deck", "preconditioner", "increments", "failed attempts", "iterations: mean", "at most", "s", "difference", "other statuses")
    print(*head(*columns), sep="\n")
    for name in options.decks:
        deck, exact = sample(name), folder / f"{name}_newton"
        execute(options.program, folder, exact.name, deck, options.seconds)
        for preconditioner in options.preconditioners:
            file = folder / f"{name}_{preconditioner.lower()}"
            is_done, seconds = execute(options.program, folder, file.name, with_gradients(deck, preconditioner), options.seconds)
            if not is_done:
                print(f"| {name} | {preconditioner} | - | | | | {seconds:.0f} | | |", flush=True)
                continue
            attempts, counts = read_sta(file.with_suffix(".sta")), iterations(file.with_suffix(".cvg"))
            u, v = displacements(exact.with_suffix(".vtkhdf")), displacements(file.with_suffix(".vtkhdf"))
            others = other_statuses(exact.with_suffix(".vtkhdf"), file.with_suffix(".vtkhdf"), friction(deck))
            failed = sum(a.is_failed for a in attempts)
            print(
                f"| {name} | {preconditioner} | {len(attempts) - failed} | {failed} | {np.mean(counts):.1f} | {max(counts)} | {seconds:.0f} "
                f"| {np.abs(u - v).max() / np.abs(u).max():.1g} | {others} |",
                flush=True,
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())
