"""Loose bodies: stacks and walls with gaps, those of the tests and a second set at random, in both formulations. Prints a table.

    python -m verify.study.loose_bodies_table [number of random decks] [--inertia]
    python -m verify.study.loose_bodies_table --growth

With --inertia the steps are *DYNAMIC, APPLICATION=QUASI-STATIC, with all loads at once. With --growth stacks of 2 to 40 blocks run alone: iterations by
number of blocks, and the exponent of their growth by least squares (1: linear).

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

from verify.decks.loose_bodies import Pile, by_inertia, stack, wall

BY_FACES = ", TYPE=SURFACE TO SURFACE"
SECONDS = 60  #: most time for a job


def _result(pile: Pile) -> str:
    """Outcome, iterations and failed attempts of a job; whether the table carries the weight."""
    amontons = Path(os.environ.get("AMONTONS_BIN", "bin")).resolve() / "amontons"
    with tempfile.TemporaryDirectory() as folder:
        deck = by_inertia(pile.deck, "1e-3, 0.5, 1e-9, 0.05", ", AMPLITUDE=STEP") if "--inertia" in sys.argv else pile.deck
        Path(folder, "job.inp").write_text(deck)
        try:
            done = subprocess.run([amontons, "job"], cwd=folder, capture_output=True, text=True, timeout=SECONDS, check=False)
        except subprocess.TimeoutExpired:
            return f"no end in {SECONDS} s | |"
        counts = [re.search(rf"{what} +(\d+)", done.stdout) for what in ("Newton iterations", "attempts that failed")]
        text = " | ".join(found[1] if found else "" for found in counts)
        if done.returncode != 0:
            reason = re.search(r"\*ERROR: .*?: ([A-Z ]+):", done.stdout + done.stderr)
            return f"{reason[1] if reason else 'error'} | {text}"
        with h5py.File(Path(folder, "job.vtkhdf")) as file:
            force = file["AMONTONS/history/reaction_force"][-1]
        is_balanced = abs(force[1] - pile.weight) <= 1e-5 * pile.weight and abs(force[0] + pile.push) <= 1e-5 * pile.weight
        return f"{'finished' if is_balanced else 'WRONG FORCE'} | {text}"


def _fixed() -> list[tuple[str, Pile]]:
    """The set of the tests and its neighbours."""
    cases = []
    for tag, options in (("nodes", ""), ("faces", BY_FACES)):
        for gap in (0.001, 0.01, 0.1, 0.3):
            cases += [(f"stack of {n}, gap {gap:g}, {tag}", stack(n, gap, options=options)) for n in (2, 6, 12, 25, 40)]
        for gap in (0.001, 0.1):
            cases += [(f"wall {n} x {n}, gap {gap:g}, {tag}", wall(n, n, gap, options=options)) for n in (3, 4, 5)]
    return cases


def _random(n_cases: int) -> list[tuple[str, Pile]]:
    """The second set: nothing was tuned to it."""
    draw, cases = random.Random(23), []
    for _ in range(n_cases):
        options, gap, cells, increments = draw.choice(["", BY_FACES]), 10 ** draw.uniform(-3, -0.6), draw.choice([1, 2, 3, 4]), draw.choice([1, 1, 1, 4])
        tag = f"{cells} elements, {increments} increments, {'faces' if options else 'nodes'}"
        if draw.random() < 0.6:
            n = draw.randint(2, 40)
            cases.append((f"stack of {n}, gap {gap:.3f}, {tag}", stack(n, gap, cells=cells, increments=increments, options=options)))
        else:
            rows, columns, gap = draw.randint(2, 6), draw.randint(2, 6), min(gap, 0.1)
            cases.append((f"wall {rows} x {columns}, gap {gap:.3f}, {tag}", wall(rows, columns, gap, cells=min(cells, 2), increments=increments, options=options)))
    return cases


def _growth() -> None:
    """Iterations of stacks by number of blocks."""
    numbers = (2, 4, 8, 12, 16, 20, 25, 30, 35, 40)
    print("| gap | contact by | " + " | ".join(map(str, numbers)) + " | exponent |\n" + "|---" * (len(numbers) + 3) + "|")
    for gap in (0.001, 0.01, 0.1, 0.3):
        for form, options in (("nodes", ""), ("faces", BY_FACES)):
            results = [[word.strip() for word in _result(stack(n, gap, options=options)).split("|")] for n in numbers]
            ended = [(n, int(result[1])) for n, result in zip(numbers, results, strict=True) if result[0] == "finished"]
            exponent = np.polyfit(*np.log(np.array(ended, dtype=float)).T, 1)[0]
            print(f"| {gap:g} | {form} | " + " | ".join(r[1] if r[0] == "finished" else r[0] for r in results) + f" | {exponent:.2f} |", flush=True)


def main() -> None:
    """Prints both tables, or that of the growth."""
    if "--growth" in sys.argv:
        _growth()
        return
    numbers = [word for word in sys.argv[1:] if word.isdigit()]
    n_cases = int(numbers[0]) if numbers else 30
    for title, cases in (("The set of the tests and its neighbours", _fixed()), ("The second set", _random(n_cases))):
        print(f"\n{title}\n\n| case | outcome | iterations | failed attempts |\n|---|---|---|---|")
        n_finished = 0
        for name, pile in cases:
            result = _result(pile)
            n_finished += result.startswith("finished")
            print(f"| {name} | {result} |", flush=True)
        print(f"\n{n_finished} of {len(cases)} finish.")


if __name__ == "__main__":
    main()
