"""Line searches on ironing: NONE, ALL, GLOBAL, NODAL and AUTO, by shape of the indenter, friction and size of the increments.

    python verify/study/line_search_table.py [--outdir DIR] [--program bin/amontons] [--mu 0.3] [--slides 0.15 0.4 0.75]
        [--figure line_search.png] [--again]

The decks are those of ironing_table.py. For each the table says the Newton iterations per increment asked for, failed
attempts included, and in brackets the failed attempts; a run that did not reach its end is marked by the time it reached (of 2).
The last rows count over all runs: runs finished, iterations of the finished ones, failed attempts. With --again nothing is run:
the .sta files that are in DIR are counted.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from ironing_table import DRAG, ROOT, Outcome, count_rows, ironing_deck, run_case  # noqa: E402

MODES = ("NONE", "ALL", "GLOBAL", "NODAL", "AUTO")


def time_reached(file: Path) -> float:
    """Total time at the end of the last increment that converged."""
    rows = [line for line in file.read_text().splitlines()[2:] if "U" not in line]
    return float(rows[-1].split()[4]) if rows else 0.0


def cell(outcome: Outcome, reached: float) -> str:
    """One run in few characters."""
    if not outcome.is_done:
        return f"stopped at {reached:.2f}"
    return f"{outcome.per_asked:.1f} ({outcome.failed})"


def draw(cases: list[str], outcomes: dict[str, list[Outcome]], file: Path) -> None:
    """Bars of iterations per increment asked for, by case and line search."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.5, 3.6))
    axes = figure.subplots()
    width = 0.8 / len(MODES)
    for i, mode in enumerate(MODES):
        places = [k + (i - (len(MODES) - 1) / 2) * width for k in range(len(cases))]
        axes.bar(places, [o.per_asked for o in outcomes[mode]], width, label=mode)
    axes.axhline(12, color="black", lw=0.8, ls="--")
    axes.set_xticks(range(len(cases)), cases)
    axes.set(ylabel="Newton iterations per increment asked for", yscale="log")
    axes.legend(ncols=len(MODES), fontsize=8)
    figure.savefig(file, dpi=110, bbox_inches="tight", metadata={"Software": None})


def main() -> int:
    """Runs all cases and prints the table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--outdir", type=Path)
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    parser.add_argument("--mu", type=float, nargs="+", default=[0.3])
    parser.add_argument("--slides", type=float, nargs="+", default=[0.15, 0.4, 0.75])
    parser.add_argument("--figure", type=Path)
    parser.add_argument("--again", action="store_true", help="count the .sta files in DIR")
    options = parser.parse_args()
    folder = options.outdir or Path(tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)
    print("| indenter | mu | slide | " + " | ".join(MODES) + " |")
    print("|---" * (3 + len(MODES)) + "|", flush=True)
    outcomes: dict[str, list[Outcome]] = {mode: [] for mode in MODES}
    cases: list[str] = []
    for shape in ("curved", "flat"):
        for mu in options.mu:
            for slide in options.slides:
                cells = []
                for mode in MODES:
                    name = f"{mode.lower()}_{shape}_{mu:g}_{slide:g}"
                    asked = 5 + round(DRAG / slide)
                    if options.again:
                        is_done = time_reached(folder / f"{name}.sta") >= 2.0
                        outcome = count_rows(folder / f"{name}.sta", asked, is_done)
                    else:
                        outcome = run_case(options.program, folder, name, ironing_deck(shape, mu, slide, mode), asked)
                    outcomes[mode].append(outcome)
                    cells.append(cell(outcome, time_reached(folder / f"{name}.sta")))
                cases.append(f"{shape}\nmu {mu:g}\n{slide:g}")
                print(f"| {shape} | {mu:g} | {slide:g} | " + " | ".join(cells) + " |", flush=True)
    for title, count in (
        ("runs finished", lambda runs: sum(o.is_done for o in runs)),
        ("iterations of the finished runs", lambda runs: sum(o.iterations for o in runs if o.is_done)),
        ("failed attempts", lambda runs: sum(o.failed for o in runs)),
    ):
        print(f"| {title} | | | " + " | ".join(str(count(outcomes[mode])) for mode in MODES) + " |")
    if options.figure:
        draw(cases, outcomes, options.figure)
    return 0


if __name__ == "__main__":
    sys.exit(main())
