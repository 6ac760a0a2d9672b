"""Line searches over contact problems: NONE, ALL, GLOBAL, NODAL and AUTO, by direction, friction and size of the increments.

    python -m verify.study.contact_table [--runs runs.csv] [--directions EXACT LAGGED SYMMETRIC] [--modes NONE AUTO]
        [--only ball] [--program bin/amontons] [--outdir DIR] [--seconds 60]
    python -m verify.study.contact_table --show doc/study/runs.csv [--figure doc/study/contact_table.png]

Six small problems: a block sheared on a block and a punch pressed on a slab and drawn (space and plane, small displacements), a block
dragged over a table, a cylinder pressed into a slab and drawn to and fro (plane), a ball pressed on a table and dragged (space, by nodes
and surface to surface); the last four under NLGEOM. Friction 0.05, 0.3 and 1; each step in 20, 5 or 1 requested increments. A run counts
its Newton iterations, failed attempts included, and the processor's seconds; one that fails, makes more than ten times the requested increments
and forty, or takes longer than allowed does not finish. Each run is a row of the file of runs, which is kept: runs that are made again take
the place of the old ones. --show prints the tables of such a file and runs nothing.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from verify.decks.make_decks import Floats, _named_grid, block
from verify.decks.planes import flat_deck, flatten
from verify.decks.sheets import between, fix, pair, sheet, solid_deck
from verify.study.ironing_table import ROOT, count_rows
from verify.study.runs import execute, read_runs, write_runs

MODES = ("NONE", "ALL", "GLOBAL", "NODAL", "AUTO")
DIRECTIONS = ("EXACT", "LAGGED", "SYMMETRIC")
FRICTIONS = (0.05, 0.3, 1.0)
SIZES = (20, 5, 1)
STEEL, SOFT = (210000.0, 0.3), (2000.0, 0.3)


def steps(mode: str, n: int, is_nlgeom: bool, *loads: str) -> str:
    """One step for each load, n requested increments in each."""
    text = ""
    for load in loads:
        text += f"*STEP{', NLGEOM' if is_nlgeom else ''}, INC={10 * n + 40}\n*STATIC\n{1 / n:.10g}, 1., 1e-6, {1 / n:.10g}\n"
        text += f"*LINE SEARCH, TYPE={mode}\n{load}*END STEP\n"
    return text


def shear(mu: float, mode: str, n: int) -> str:
    """A block pressed on a block and sheared, small displacements."""
    wide = between(-0.5, 1.5, 7)
    body, table = block(between(0, 1, 5), between(0, 1, 5), between(0, 0.5, 3), "BODY"), block(wide, wide, [-1, -0.4, 0], "TABLE")
    press = fix("TABLE_BOTTOM, 1, 3", "BODY_TOP, 1, 2", "BODY_TOP, 3, 3, -0.002")
    text = steps(mode, n, False, press, fix("BODY_TOP, 1, 1, 0.004"))
    return solid_deck([(body, STEEL), (table, STEEL)], pair("BODY_BOTTOM", "TABLE_TOP", mu), text)


def punch(mu: float, mode: str, n: int) -> str:
    """A punch with sharp corners pressed on a slab and drawn, small displacements, in the plane."""
    body, slab = sheet("BODY", between(-0.5, 0.5, 8), between(0, 0.6, 4)), sheet("SLAB", between(-2, 2, 22), between(-1.5, 0, 6))
    press = fix("SLAB_BOTTOM, 1, 2", "BODY_TOP, 1", "BODY_TOP, 2, 2, -0.01")
    text = steps(mode, n, False, press, fix("BODY_TOP, 1, 1, 0.01"))
    return flat_deck([(flatten(body), STEEL), (flatten(slab), SOFT)], "CPE4", pair("BODY_BOTTOM", "SLAB_TOP", mu) + text)


def drag(mu: float, mode: str, n: int) -> str:
    """A block pressed on a table and dragged over eight facets."""
    body, table = sheet("BODY", between(0, 1, 6), between(0, 1, 6)), sheet("TABLE", between(-1, 4, 20), between(-1, 0, 4))
    press = fix("TABLE_BOTTOM, 1, 2", "BODY_TOP, 1", "BODY_TOP, 2, 2, -0.05")
    text = steps(mode, n, True, press, fix("BODY_TOP, 1, 1, 2."))
    return flat_deck([(flatten(body), STEEL), (flatten(table), STEEL)], "CPE4", pair("BODY_BOTTOM", "TABLE_TOP", mu) + text)


def cylinder(mu: float, mode: str, n: int) -> str:
    """A cylinder pressed into a slab and drawn to and fro."""

    def place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        angle, radius = np.radians(-50 + 100 * s), 2 * (0.4 + 0.6 * (1 - t))
        return radius * np.sin(angle), 2 - radius * np.cos(angle)

    body, slab = sheet("BODY", between(0, 1, 16), between(0, 1, 4), place), sheet("SLAB", between(-4, 4, 30), between(-3, 0, 8))
    press = fix("SLAB_BOTTOM, 1, 2", "BODY_TOP, 1", "BODY_TOP, 2, 2, -0.3")
    text = steps(mode, n, True, press, fix("BODY_TOP, 1, 1, 1."), fix("BODY_TOP, 1, 1, -1."))
    return flat_deck([(flatten(body), STEEL), (flatten(slab), SOFT)], "CPE4", pair("BODY_BOTTOM", "SLAB_TOP", mu) + text)


def ball(mu: float, mode: str, n: int, options: str = "") -> str:
    """A ball pressed on a table and dragged. options: of its contact pair."""
    line = between(-1, 1, 6)
    u, v, w = (a.ravel(order="F") for a in np.meshgrid(line, line, line, indexing="ij"))
    x = u * np.sqrt(1 - v * v / 2 - w * w / 2 + v * v * w * w / 3)
    y = v * np.sqrt(1 - w * w / 2 - u * u / 2 + w * w * u * u / 3)
    z = w * np.sqrt(1 - u * u / 2 - v * v / 2 + u * u * v * v / 3)
    body = _named_grid(np.stack([x, y, z + 1], axis=1), (6, 6, 6), "BALL")
    table = block(between(-1.5, 2.5, 9), between(-1.5, 1.5, 7), between(-1, 0, 2), "TABLE")
    press = fix("TABLE_BOTTOM, 1, 3", "BALL_TOP, 1, 2", "BALL_TOP, 3, 3, -0.05")
    text = steps(mode, n, True, press, fix("BALL_TOP, 1, 1, 0.8"))
    return solid_deck([(body, STEEL), (table, STEEL)], pair("BALL_BOTTOM", "TABLE_TOP", mu, options), text)


def ball_by_faces(mu: float, mode: str, n: int) -> str:
    """The same, surface to surface."""
    return ball(mu, mode, n, ", TYPE=SURFACE TO SURFACE")


PROBLEMS: dict[str, tuple[Callable[[float, str, int], str], int]] = {
    "block sheared": (shear, 2), "punch": (punch, 2), "block dragged": (drag, 2), "cylinder": (cylinder, 3), "ball": (ball, 2),
    "ball by faces": (ball_by_faces, 2),
}  #: name: (deck, its steps)


@dataclass(frozen=True)
class Run:
    """One run, as it stands in the file of runs."""

    direction: str
    problem: str
    mu: float
    size: int  #: requested increments in a step
    mode: str
    requested: int  #: requested increments in all
    is_done: int
    made: int  #: increments
    failed: int  #: attempts
    iterations: int  #: of Newton's method, those of failed attempts included
    seconds: float  #: of the processor

    @property
    def case(self) -> tuple[str, str, float, int]:
        """What is run, but for the line search."""
        return self.direction, self.problem, self.mu, self.size

    @property
    def per_requested(self) -> float:
        """Newton iterations per requested increment."""
        return self.iterations / self.requested


def run(program: Path, folder: Path, case: tuple[str, str, float, int], mode: str, seconds: float) -> Run:
    """Runs one deck; one that takes too long is stopped and did not finish."""
    direction, problem, mu, size = case
    deck, n_steps = PROBLEMS[problem]
    name = f"{mode}_{direction}_{problem}_{mu:g}_{size}".replace(" ", "_").lower()
    is_done, spent = execute(program, folder, name, deck(mu, f"{mode}, DIRECTION={direction}", size), seconds)
    (folder / f"{name}.vtkhdf").unlink(missing_ok=True)
    o = count_rows(folder / f"{name}.sta", n_steps * size, is_done)
    return Run(direction, problem, mu, size, mode, o.requested, int(o.is_done), o.made, o.failed, o.iterations, round(spent, 2))


def place(r: Run) -> tuple[int, ...]:
    """Of a run in the file of runs: the order of the tables."""
    return DIRECTIONS.index(r.direction), list(PROBLEMS).index(r.problem), FRICTIONS.index(r.mu), SIZES.index(r.size), MODES.index(r.mode)


def head(*words: str) -> Iterator[str]:
    """The first two lines of a table in Markdown."""
    yield "| " + " | ".join(words) + " |"
    yield "|---" * len(words) + "|"


def by_case(runs: Iterable[Run], direction: str) -> dict[tuple[str, str, float, int], dict[str, Run]]:
    """The runs of a direction by case and line search."""
    table: dict[tuple[str, str, float, int], dict[str, Run]] = {}
    for r in runs:
        if r.direction == direction:
            table.setdefault(r.case, {})[r.mode] = r
    return table


def cases_table(runs: list[Run], direction: str) -> Iterator[str]:
    """Iterations per requested increment and failed attempts of each run of a direction."""
    yield from head("problem", "mu", "increments a step", *MODES)
    for (_, problem, mu, size), row in by_case(runs, direction).items():
        cells = [f"{r.per_requested:.1f} ({r.failed})" if r.is_done else "-" for r in (row[mode] for mode in MODES)]
        yield f"| {problem} | {mu:g} | {size} | " + " | ".join(cells) + " |"


def problems_table(runs: list[Run], direction: str) -> Iterator[str]:
    """The same by problem and size of the increments: runs finished of three, mean of their iterations per requested increment."""
    yield from head("problem", "increments a step", *MODES)
    for problem in PROBLEMS:
        for size in SIZES:
            cells = []
            for mode in MODES:
                done = [r for r in runs if (r.direction, r.problem, r.size, r.mode, r.is_done) == (direction, problem, size, mode, 1)]
                cells.append(f"{np.mean([r.per_requested for r in done]):.1f} ({len(done)})" if done else "-")
            yield f"| {problem} | {size} | " + " | ".join(cells) + " |"


def finished_by_all(runs: list[Run]) -> set[tuple[str, float, int]]:
    """The cases that every line search finishes along every direction."""
    lost = {r.case[1:] for r in runs if not r.is_done}
    return {r.case[1:] for r in runs} - lost


def sums(runs: list[Run], direction: str) -> dict[str, list[float]]:
    """By line search: runs finished, failed attempts, and iterations and seconds over the cases that all finish along all directions."""
    common = finished_by_all(runs)
    found = {}
    for mode in MODES:
        made = [r for r in runs if (r.direction, r.mode) == (direction, mode)]
        both = [r for r in made if r.case[1:] in common]
        found[mode] = [sum(r.is_done for r in made), sum(r.failed for r in made), sum(r.iterations for r in both), sum(r.seconds for r in both)]
    return found


def sums_table(runs: list[Run]) -> Iterator[str]:
    """All directions in few lines."""
    yield from head("direction", "", *MODES)
    n, n_common = len({r.case[1:] for r in runs}), len(finished_by_all(runs))
    for direction in DIRECTIONS:
        found = sums(runs, direction)
        for k, words in enumerate((f"runs finished, of {n}", "failed attempts", f"iterations, {n_common} cases", f"seconds, {n_common} cases")):
            yield f"| {direction} | {words} | " + " | ".join(f"{found[mode][k]:.0f}" for mode in MODES) + " |"


def draw(runs: list[Run], file: Path) -> None:
    """Runs finished, and iterations over the cases that all line searches finish along all directions."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.5, 3.2))
    for axes, k, label in zip(figure.subplots(1, 2), (0, 2), ("runs finished", "iterations, cases that all finish"), strict=True):
        for i, direction in enumerate(DIRECTIONS):
            found = sums(runs, direction)
            axes.bar(np.arange(len(MODES)) + 0.27 * (i - 1), [found[mode][k] for mode in MODES], 0.27, label=direction)
        axes.set_xticks(range(len(MODES)), MODES, fontsize=8)
        axes.set(ylabel=label)
        axes.spines[["top", "right"]].set_visible(False)
    figure.legend(*axes.get_legend_handles_labels(), ncols=3, fontsize=8, frameon=False, loc="upper center")
    figure.tight_layout(rect=(0, 0, 1, 0.93))
    figure.savefig(file, dpi=110, metadata={"Software": None})


def show(runs: list[Run]) -> str:
    """All tables, as they stand in doc/study/line_search.md."""
    parts = [sums_table(runs), cases_table(runs, "EXACT"), *(problems_table(runs, d) for d in DIRECTIONS[1:])]
    return "\n\n".join("\n".join(part) for part in parts)


def main() -> int:
    """Runs the requested cases, or shows the tables of a file of runs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--outdir", type=Path)
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    parser.add_argument("--runs", type=Path, default=Path("runs.csv"), help="where the runs are kept")
    parser.add_argument("--directions", nargs="+", choices=DIRECTIONS, default=DIRECTIONS)
    parser.add_argument("--modes", nargs="+", choices=MODES, default=MODES)
    parser.add_argument("--only", choices=PROBLEMS, help="one problem")
    parser.add_argument("--seconds", type=float, default=60.0, help="most time of a processor for one run")
    parser.add_argument("--show", type=Path, metavar="FILE", help="print the tables of a file of runs")
    parser.add_argument("--figure", type=Path)
    options = parser.parse_args()
    if options.show:
        runs = read_runs(options.show, Run)
        print(show(runs))
        if options.figure:
            draw(runs, options.figure)
        return 0
    folder = options.outdir or Path(tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)
    kept = {(*r.case, r.mode): r for r in read_runs(options.runs, Run)} if options.runs.exists() else {}
    cases = [(d, p, mu, n) for d in options.directions for p in PROBLEMS if options.only in (None, p) for mu in FRICTIONS for n in SIZES]
    for case in cases:
        for mode in options.modes:
            r = kept[*case, mode] = run(options.program, folder, case, mode, options.seconds)
            print(*case, mode, f"{r.per_requested:.1f} ({r.failed})" if r.is_done else "-", f"{r.seconds:.1f} s", flush=True)
        write_runs(options.runs, sorted(kept.values(), key=place))
    return 0


if __name__ == "__main__":
    sys.exit(main())
