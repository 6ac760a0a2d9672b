"""Line searches on ironing: NONE, ALL, GLOBAL, NODAL and AUTO, by shape of the indenter, friction and size of the increments.

    python -m verify.study.line_search_table [--outdir DIR] [--program bin/amontons] [--mu 0.3] [--slides 0.15 0.4 0.75]
        [--direction EXACT|SYMMETRIC|LAGGED] [--seconds 60] [--figure line_search.png] [--again]
    python -m verify.study.line_search_table --draw doc/study/line_search.md --figure doc/study/line_search.png

The decks are those of ironing_table.py. For each the table says the Newton iterations per requested increment, failed
attempts included, and in brackets the failed attempts; a run that did not reach its end is marked by the time it reached (of 2).
The last rows count over all runs: runs finished, iterations of the finished ones, failed attempts. With --again nothing is run:
the .sta files that are in DIR are counted. With --draw the figure is made from the table that stands in a page.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from pathlib import Path

from verify.readers.sta_cvg_files import read_sta
from verify.study.ironing_table import DRAG, ROOT, Outcome, count_rows, ironing_deck, run_case

MODES = ("NONE", "ALL", "GLOBAL", "NODAL", "AUTO")


def time_reached(file: Path) -> float:
    """Total time at the end of the last increment that converged."""
    return max((attempt.time for attempt in read_sta(file) if not attempt.is_failed), default=0.0)


def cell(outcome: Outcome, reached: float) -> str:
    """One run in few characters."""
    if not outcome.is_done:
        return f"stopped at {reached:.2f}"
    return f"{outcome.per_requested:.1f} ({outcome.failed})"


def rows_of(page: str) -> tuple[list[str], dict[str, list[float]]]:
    """Cases and iterations per increment by line search, from the table of a page."""
    cases: list[str] = []
    bars: dict[str, list[float]] = {mode: [] for mode in MODES}
    for shape, mu, slide, cells in re.findall(r"^\| (curved|flat) \| ([\d.]+) \| ([\d.]+) \|(.*)\|$", page, re.M):
        cases.append(f"{shape}, mu {mu}\nslides {slide}")
        for mode, text in zip(MODES, cells.split("|"), strict=True):
            found = re.match(r"\s*([\d.]+) \(", text)
            bars[mode].append(float(found[1]) if found else float("nan"))
    return cases, bars


def draw(cases: list[str], bars: dict[str, list[float]], file: Path) -> None:
    """Bars of iterations per requested increment, by case and line search."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.5, 3.8))
    axes = figure.subplots()
    width = 0.8 / len(MODES)
    for i, mode in enumerate(MODES):
        places = [k + (i - (len(MODES) - 1) / 2) * width for k in range(len(cases))]
        axes.bar(places, bars[mode], width, label=mode)
    axes.axhline(12, color="black", lw=0.8, ls="--", label="12")
    axes.set_xticks(range(len(cases)), cases, fontsize=8)
    ticks = [t for t in (1, 2, 3, 5, 10, 20, 30, 50, 100) if t <= 1.2 * max(max(b) for b in bars.values())]
    axes.set(ylabel="Newton iterations per increment", yscale="log")
    axes.set_yticks(ticks, [str(t) for t in ticks])
    axes.minorticks_off()
    axes.legend(ncols=len(MODES) + 1, fontsize=8, frameon=False, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(file, dpi=110, bbox_inches="tight", metadata={"Software": None})


def main() -> int:
    """Runs all cases and prints the table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--outdir", type=Path)
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    parser.add_argument("--mu", type=float, nargs="+", default=[0.3])
    parser.add_argument("--slides", type=float, nargs="+", default=[0.15, 0.4, 0.75])
    parser.add_argument("--direction", choices=["EXACT", "SYMMETRIC", "LAGGED"], default="EXACT", help="DIRECTION of the card")
    parser.add_argument("--seconds", type=float, help="most time of a processor for one run")
    parser.add_argument("--figure", type=Path)
    parser.add_argument("--again", action="store_true", help="count the .sta files in DIR")
    parser.add_argument("--draw", type=Path, metavar="PAGE", help="make the figure from the table of a page")
    options = parser.parse_args()
    if options.draw:
        draw(*rows_of(options.draw.read_text()), options.figure or options.draw.with_suffix(".png"))
        return 0
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
                    requested = 5 + round(DRAG / slide)
                    if options.again:
                        is_done = time_reached(folder / f"{name}.sta") >= 2.0
                        outcome = count_rows(folder / f"{name}.sta", requested, is_done)
                    else:
                        outcome = run_case(options.program, folder, name, ironing_deck(shape, mu, slide, f"{mode}, DIRECTION={options.direction}"), requested,
                                           options.seconds)  # fmt: skip
                    outcomes[mode].append(outcome)
                    cells.append(cell(outcome, time_reached(folder / f"{name}.sta")))
                cases.append(f"{shape}, mu {mu:g}\nslides {slide:g}")
                print(f"| {shape} | {mu:g} | {slide:g} | " + " | ".join(cells) + " |", flush=True)
    for title, count in (
        ("runs finished", lambda runs: sum(o.is_done for o in runs)),
        ("iterations of the finished runs", lambda runs: sum(o.iterations for o in runs if o.is_done)),
        ("failed attempts", lambda runs: sum(o.failed for o in runs)),
    ):
        print(f"| {title} | | | " + " | ".join(str(count(outcomes[mode])) for mode in MODES) + " |")
    if options.figure:
        draw(cases, {mode: [o.per_requested for o in outcomes[mode]] for mode in MODES}, options.figure)
    return 0


if __name__ == "__main__":
    sys.exit(main())
