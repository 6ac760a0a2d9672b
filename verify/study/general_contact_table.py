"""Decks with pairs by hand and with general contact: the difference of displacements and stresses, and the ratio of processor time.

The processor time is the least of some runs, which a loaded machine disturbs less than their mean. The runs of both forms take turns.

    python -m verify.study.general_contact_table [--runs 3]          ten decks of a fraction of a second
    python -m verify.study.general_contact_table --large [NAME ...]  twelve decks of one to ten seconds, or those named

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

from verify.decks.general_contact import DECKS, INPUT_DECKS, with_general_contact, with_pairs
from verify.decks.general_contact_large import LARGE_DECKS
from verify.study.runs import execute

ROOT = Path(__file__).resolve().parents[2]


def decks() -> dict[str, str]:
    """The ten decks with pairs by hand; those of the folder input read their meshes there."""
    ours = {name: (ROOT / "input" / f"{name}.inp").read_text() for name in INPUT_DECKS}
    return {name: deck.replace("INPUT=", f"INPUT={ROOT / 'input'}/") for name, deck in ours.items()} | {name: make() for name, make in DECKS.items()}


def fields(file: Path) -> list[np.ndarray]:
    """Displacements and stresses of all increments."""
    with h5py.File(file) as data:
        return [np.asarray(data[f"VTKHDF/PointData/{name}"]) for name in ("U", "S")]


def measure(program: Path, folder: Path, forms: dict[str, str], runs: int) -> list[float]:
    """The least processor time of the runs of each form of a deck; without end if it does not finish."""
    least = [float("inf")] * len(forms)
    for _ in range(runs):
        for k, (name, deck) in enumerate(forms.items()):
            is_done, seconds = execute(program, folder, name, deck, 600.0)
            least[k] = min(least[k], seconds) if is_done else float("inf")
    return least


def main() -> int:
    """Prints a row for each deck, and the sums."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--program", type=Path, default=Path("bin/amontons"))
    options.add_argument("--runs", type=int, default=3)
    options.add_argument("--large", nargs="*", metavar="NAME", help="the larger decks, or some of them")
    given = options.parse_args()
    chosen = decks() if given.large is None else {name: LARGE_DECKS[name]() for name in given.large or LARGE_DECKS}
    print("| deck | by hand [s] | general contact [s] | ratio | largest difference |")
    print("|---|---|---|---|---|")
    total = [0.0, 0.0]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for name, deck in chosen.items():
            forms = {"hand": with_pairs(deck), "general": with_general_contact(deck)}
            seconds = measure(given.program.resolve(), folder, forms, given.runs)
            if float("inf") in seconds:
                print(f"| {name} | {seconds[0]:.2f} | {seconds[1]:.2f} | not finished | |", flush=True)
                continue
            pairs = zip(fields(folder / "hand.vtkhdf"), fields(folder / "general.vtkhdf"), strict=True)
            difference = max(float(np.abs(a - b).max() / np.abs(a).max()) for a, b in pairs)
            print(f"| {name} | {seconds[0]:.2f} | {seconds[1]:.2f} | {seconds[1] / seconds[0]:.2f} | {difference:.0e} |", flush=True)
            total = [t + s for t, s in zip(total, seconds, strict=True)]
    print(f"| all | {total[0]:.2f} | {total[1]:.2f} | {total[1] / total[0]:.2f} | |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
