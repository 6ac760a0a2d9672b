"""Ten decks with pairs by hand and with general contact: the difference of displacements and stresses, and the ratio of processor time.

The processor time is the least of some runs, which a loaded machine disturbs less than their mean.

    python -m verify.study.general_contact_table [--runs 3]

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


def measure(program: Path, folder: Path, name: str, deck: str, runs: int) -> float:
    """The least processor time of the runs of a deck; without end if it does not finish."""
    results = [execute(program, folder, name, deck, 600.0) for _ in range(runs)]
    return min(seconds if is_done else float("inf") for is_done, seconds in results)


def main() -> int:
    """Prints a row for each deck, and the sums."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--program", type=Path, default=Path("bin/amontons"))
    options.add_argument("--runs", type=int, default=3)
    given = options.parse_args()
    print("| deck | by hand [s] | general contact [s] | ratio | largest difference |")
    print("|---|---|---|---|---|")
    total = [0.0, 0.0]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for name, deck in decks().items():
            forms = {"hand": with_pairs(deck), "general": with_general_contact(deck)}
            seconds = [measure(given.program.resolve(), folder, key, text, given.runs) for key, text in forms.items()]
            pairs = zip(fields(folder / "hand.vtkhdf"), fields(folder / "general.vtkhdf"), strict=True)
            difference = max(float(np.abs(a - b).max() / np.abs(a).max()) for a, b in pairs)
            print(f"| {name} | {seconds[0]:.2f} | {seconds[1]:.2f} | {seconds[1] / seconds[0]:.2f} | {difference:.0e} |", flush=True)
            total = [t + s for t, s in zip(total, seconds, strict=True)]
    print(f"| all | {total[0]:.2f} | {total[1]:.2f} | {total[1] / total[0]:.2f} | |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
