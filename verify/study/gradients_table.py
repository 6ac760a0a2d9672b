"""Conjugate gradients over contact problems: lengths of the slave nodes ALL, NONE, GLOBAL, NODAL, by preconditioner, friction, increments.

    python -m verify.study.gradients_table [--runs gradients.csv] [--preconditioners NODAL FACTOR] [--modes ALL NODAL]
        [--only ball punch] [--sizes 20 5 1] [--program bin/amontons] [--outdir DIR] [--seconds 60] [--seconds-others 4]
    python -m verify.study.gradients_table --show doc/study/gradients.csv [--figure doc/study/gradients.png]

The problems are those of contact_table.py and of ironing_table.py (20, 5, 1 increments a step stand for slides of 0.15, 0.4, 0.75 in an
increment), all steps with SOLVER=CONJUGATE GRADIENTS. A run counts its rounds, its iterations and its
evaluations of the residual, failed attempts included, and the processor's seconds, and compares the displacements at its end with those of
Newton's method. One that fails, makes more than ten times the requested increments and forty, or takes longer than allowed does not
finish. A run of another length is compared with that of ALL up to the time of the load that both reach, finished or not; for that
ALL runs first, in the same folder. Each run is a row of the file of runs, which is kept: runs that are made again take the place of
the old ones.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from verify.study.contact_table import FRICTIONS, SIZES, head
from verify.study.contact_table import PROBLEMS as CONTACT
from verify.study.ironing_table import DRAG, ROOT, count_rows, ironing_deck
from verify.readers.sta_cvg_files import read_sta
from verify.study.runs import execute, read_runs, write_runs

SLIDES = {20: 0.15, 5: 0.4, 1: 0.75}  #: of the indenter in one increment, by the number of increments that stands for it
IRONING = {"ironing curved": "curved", "ironing flat": "flat"}
PROBLEMS = {**CONTACT, **{name: (lambda mu, mode, size, shape=shape: ironing_deck(shape, mu, SLIDES[size], mode), 0) for name, shape in IRONING.items()}}
MODES = ("ALL", "NONE", "GLOBAL", "NODAL")
PRECONDITIONERS = ("NODAL", "FACTOR")
SAME = 1e-5  #: difference of displacements, over the largest, of the same result
NEAR = 1e-4  #: of a limit, over it: a status there depends on rounding and on the tolerance of the residual
KRYLOV, EVALUATIONS = 18, 22  #: columns of .cvg
LIMIT = 4.0  #: processor seconds within which runs of all lengths are counted as finished alike


@dataclass(frozen=True)
class Run:
    """One run, as it stands in the file of runs."""

    preconditioner: str
    problem: str
    mu: float
    size: int  #: requested increments in a step
    mode: str
    is_done: int
    failed: int  #: attempts
    rounds: int
    iterations: int  #: of conjugate gradients, those of failed attempts included
    evaluations: int  #: of the residual
    seconds: float  #: of the processor
    difference: float  #: of the displacements from Newton's method, over the largest; -1: one of both does not finish
    ratio: float  #: iterations up to the time that this run and that of ALL reach, over those of ALL; -1: there is none
    statuses: int  #: slave nodes of another status than by Newton's method that are not near a limit; -1: one of both does not finish

    @property
    def case(self) -> tuple[str, str, float, int]:
        """What is run, but for the lengths."""
        return self.preconditioner, self.problem, self.mu, self.size

    @property
    def requested(self) -> int:
        """Requested increments in all steps."""
        return requested_increments(self.problem, self.size)

    @property
    def is_quick(self) -> bool:
        """Whether it finishes within the time that all lengths have."""
        return bool(self.is_done) and self.seconds <= LIMIT


def requested_increments(problem: str, size: int) -> int:
    """In all steps."""
    return 5 + round(DRAG / SLIDES[size]) if problem in IRONING else PROBLEMS[problem][1] * size


def spent_iterations(folder: Path, name: str) -> list[tuple[float, int]]:
    """Each increment that a run made: the time at its end and the iterations up to it, those of failed attempts included."""
    by_attempt: dict[tuple[int, int, int], int] = {}
    for words in iteration_rows(folder / f"{name}.cvg"):
        key = (int(words[0]), int(words[1]), int(words[2]))
        by_attempt[key] = by_attempt.get(key, 0) + int(words[KRYLOV])
    made, n = [(0.0, 0)], 0
    for a in read_sta(folder / f"{name}.sta"):
        n += by_attempt.get((a.step, a.increment, a.attempt), 0)
        if not a.is_failed:
            made.append((a.time, n))
    return made


def iteration_rows(file: Path) -> list[list[str]]:
    """The words of each whole row of .cvg; a run that was stopped may have written a part of the last."""
    rows = (line.split() for line in file.read_text().splitlines() if re.match(r"\s*\d+\s+\d+\s+\d+\s+\d", line))
    return [words for words in rows if len(words) > EVALUATIONS]


def find_ratio(made: list[tuple[float, int]], by_all: list[tuple[float, int]]) -> float:
    """Iterations over those with one length up to the time that both reach; -1: one of both makes no increment."""
    time = min(made[-1][0], by_all[-1][0])
    if time <= 0.0:
        return -1.0
    here, there = (float(np.interp(time, *zip(*curve, strict=True))) for curve in (made, by_all))
    return float(f"{max(here, 1.0) / max(there, 1.0):.3g}")


def displacements(file: Path) -> np.ndarray:
    """At the end of a run."""
    with h5py.File(file) as results:
        start, n = results["VTKHDF/Steps/PointDataOffsets/U"][-1], results["VTKHDF/NumberOfPoints"][0]
        return np.asarray(results["VTKHDF/PointData/U"][start : start + n])


def slaves(file: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """At the end of a run: status, normal force and friction of the slave nodes."""
    with h5py.File(file) as results:
        contact = results["AMONTONS/contact"]
        n = len(contact["node"])
        force, shear = (np.linalg.norm(contact[name][-n:], axis=1) for name in ("force", "shear"))
        return np.asarray(contact["status"][-n:]).ravel(), force, shear


def other_statuses(exact: Path, file: Path, mu: float) -> int:
    """Slave nodes whose statuses differ, but for those that are within NEAR of the limit at which their status changes in one of both runs."""
    (status, force, shear), (status_too, force_too, shear_too) = slaves(exact), slaves(file)
    largest = max(force.max(), force_too.max())
    both_closed = (status > 0) & (status_too > 0)
    slack = [abs(mu * f - t) / np.maximum(mu * f, 1e-300) for f, t in ((force, shear), (force_too, shear_too))]
    is_near = np.where(both_closed, np.maximum(*slack), np.maximum(force, force_too) / largest) <= NEAR
    return int(((status != status_too) & ~is_near).sum())


def run(program: Path, folder: Path, case: tuple[str, str, float, int], mode: str, seconds: float) -> Run:
    """Runs one deck, and once for all modes the same by Newton's method."""
    preconditioner, problem, mu, size = case
    make_deck, requested = PROBLEMS[problem][0], requested_increments(problem, size)
    exact = f"newton_{problem}_{mu:g}_{size}".replace(" ", "_")
    if not (folder / f"{exact}.sta").exists():
        is_exact, _ = execute(program, folder, exact, make_deck(mu, "AUTO", size), seconds)
        if not is_exact:
            (folder / f"{exact}.vtkhdf").unlink(missing_ok=True)  # nothing to compare with
    cards = f"*SOLVER CONTROLS, PRECONDITIONER={preconditioner}\n*STATIC, SOLVER=CONJUGATE GRADIENTS"
    name = f"{mode}_{preconditioner}_{problem}_{mu:g}_{size}".replace(" ", "_").lower()
    is_done, spent = execute(program, folder, name, re.sub(r"^\*STATIC", cards, make_deck(mu, mode, size), flags=re.M), seconds)
    o = count_rows(folder / f"{name}.sta", requested, is_done)
    rows = iteration_rows(folder / f"{name}.cvg")
    made = spent_iterations(folder, name)
    one_length = "all" + name.removeprefix(mode.lower())
    ratio = find_ratio(made, spent_iterations(folder, one_length)) if (folder / f"{one_length}.cvg").exists() else -1.0
    difference, statuses = -1.0, -1
    if is_done and count_rows(folder / f"{exact}.sta", requested, True).made > 0:
        try:
            u, v = displacements(folder / f"{exact}.vtkhdf"), displacements(folder / f"{name}.vtkhdf")
            difference = float(np.abs(u - v).max() / np.abs(u).max())
            statuses = other_statuses(folder / f"{exact}.vtkhdf", folder / f"{name}.vtkhdf", mu)
        except (OSError, KeyError, IndexError):
            difference, statuses = -1.0, -1
    (folder / f"{name}.vtkhdf").unlink(missing_ok=True)
    return Run(
        preconditioner, problem, mu, size, mode, int(o.is_done), o.failed, len(rows),
        sum(int(w[KRYLOV]) for w in rows), sum(int(w[EVALUATIONS]) for w in rows), round(spent, 2), float(f"{difference:.2g}"), ratio, statuses,
    )


def place(r: Run) -> tuple[int, ...]:
    """Of a run in the file of runs: the order of the tables."""
    return PRECONDITIONERS.index(r.preconditioner), list(PROBLEMS).index(r.problem), FRICTIONS.index(r.mu), SIZES.index(r.size), MODES.index(r.mode)


def by_case(runs: Iterable[Run], preconditioner: str) -> dict[tuple[str, str, float, int], dict[str, Run]]:
    """The runs of a preconditioner by case and mode."""
    table: dict[tuple[str, str, float, int], dict[str, Run]] = {}
    for r in runs:
        if r.preconditioner == preconditioner:
            table.setdefault(r.case, {})[r.mode] = r
    return table


def cell(r: Run | None) -> str:
    """One run in few characters."""
    if r is None:
        return ""
    return f"{r.iterations / r.requested:.0f} ({r.rounds / r.requested:.1f}; {r.failed})" if r.is_done else "-"


def cases_table(runs: list[Run], preconditioner: str) -> Iterator[str]:
    """Iterations, rounds and failed attempts of each run."""
    yield from head("problem", "mu", "increments a step", *MODES)
    for (_, problem, mu, size), row in by_case(runs, preconditioner).items():
        yield f"| {problem} | {mu:g} | {size} | " + " | ".join(cell(row.get(mode)) for mode in MODES) + " |"


def common(runs: list[Run], preconditioner: str) -> list[dict[str, Run]]:
    """The cases that were run with every mode."""
    return [row for row in by_case(runs, preconditioner).values() if all(mode in row for mode in MODES)]


def ratios(rows: list[dict[str, Run]], mode: str) -> list[float]:
    """Iterations over those of ALL, in the cases in which both make an increment."""
    return [row[mode].ratio for row in rows if row[mode].ratio > 0.0]


def sums_table(runs: list[Run]) -> Iterator[str]:
    """Runs finished over the cases run with all modes, in the same time; iterations over the cases that all modes finish, and over those of ALL."""
    yield from head("preconditioner", "", *MODES)
    for preconditioner in PRECONDITIONERS:
        rows = common(runs, preconditioner)
        if not rows:
            continue
        both = [row for row in rows if all(r.is_done for r in row.values())]
        finished = (f"{sum(row[mode].is_quick for row in rows)}" for mode in MODES)
        yield f"| {preconditioner} | runs finished within {LIMIT:g} s, of {len(rows)} | " + " | ".join(finished) + " |"
        for quantity in ("iterations", "evaluations", "seconds"):
            totals = (f"{sum(getattr(row[mode], quantity) for row in both):.0f}" for mode in MODES)
            yield f"| {preconditioner} | {quantity}, {len(both)} cases that all finish | " + " | ".join(totals) + " |"
        found = {mode: ratios(rows, mode) for mode in MODES}
        for words, values in (
            ("cases in which both make an increment", [f"{len(kept)}" for kept in found.values()]),
            ("iterations there over those of ALL: median", [f"{np.median(kept):.2f}" for kept in found.values()]),
            ("least and largest", [f"{min(kept):.2g} to {max(kept):.2g}" for kept in found.values()]),
            ("cases with fewer than 0.95 of ALL", [f"{sum(x < 0.95 for x in kept)}" for kept in found.values()]),
        ):
            yield f"| {preconditioner} | {words} | " + " | ".join(values) + " |"


def problems_table(runs: list[Run]) -> Iterator[str]:
    """The contact problems and ironing apart: runs finished in the same time; in brackets the median of iterations over those of ALL."""
    yield from head("preconditioner", "problems", "cases", *MODES)
    for preconditioner in PRECONDITIONERS:
        for words, is_ironing in (("the six", False), ("ironing", True)):
            rows = [row for row in common(runs, preconditioner) if (row["ALL"].problem in IRONING) == is_ironing]
            if rows:
                cells = (f"{sum(row[mode].is_quick for row in rows)} ({np.median(ratios(rows, mode)):.2f})" for mode in MODES)
                yield f"| {preconditioner} | {words} | {len(rows)} | " + " | ".join(cells) + " |"


def dependence_table(runs: list[Run]) -> Iterator[str]:
    """Iterations of ALL per requested increment by friction and increments, the mean over the problems that finish with all of these."""
    yield from head("preconditioner", "increments a step", *(f"mu = {mu:g}" for mu in FRICTIONS), "problems")
    for preconditioner in PRECONDITIONERS:
        done = {(r.problem, r.mu, r.size): r for r in runs if r.preconditioner == preconditioner and r.mode == "ALL" and r.is_done}
        for size in SIZES:
            problems = [p for p in PROBLEMS if all((p, mu, size) in done for mu in FRICTIONS)]
            if not problems:
                continue
            means = (sum(r.iterations / r.requested for p in problems for r in [done[p, mu, size]]) / len(problems) for mu in FRICTIONS)
            yield f"| {preconditioner} | {size} | " + " | ".join(f"{mean:.0f}" for mean in means) + f" | {len(problems)} |"


def agreement(runs: list[Run]) -> str:
    """How far the finished runs are from Newton's method."""
    same = [r for r in runs if 0 <= r.difference <= SAME and r.statuses == 0]
    others = [r for r in runs if r.difference >= 0 and r not in same]
    words = [f"{r.preconditioner}, {r.problem}, mu {r.mu:g}, {r.size}, {r.mode}: {r.difference:.1g}, {r.statuses} nodes" for r in others]
    return f"Runs with the results of Newton's method: {len(same)} of {len(same) + len(others)}. Others: {'; '.join(words) or 'none'}"


def draw(runs: list[Run], file: Path) -> None:
    """Runs finished in the same time, and iterations over those of ALL up to the time that both reach."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.5, 3.2))
    left, right = figure.subplots(1, 2)
    for i, preconditioner in enumerate(PRECONDITIONERS):
        rows = common(runs, preconditioner)
        places = np.arange(len(MODES)) + 0.4 * (i - 0.5)
        left.bar(places, [100 * sum(row[mode].is_quick for row in rows) / max(len(rows), 1) for mode in MODES], 0.4, label=f"preconditioner {preconditioner}")
        boxes = right.boxplot([ratios(rows, mode) for mode in MODES[1:]], positions=places[1:], widths=0.3, whis=(5, 95), sym="", patch_artist=True)
        for box, line in zip(boxes["boxes"], boxes["medians"], strict=True):
            box.set(facecolor=f"C{i}", edgecolor="black")
            line.set(color="black")
    left.set(ylabel=f"runs finished within {LIMIT:g} s [%]")
    right.set(ylabel="iterations over those of ALL", yscale="log", yticks=[0.5, 1, 2, 5, 10], yticklabels=["0.5", "1", "2", "5", "10"])
    right.axhline(1.0, color="black", linewidth=0.8, linestyle="--")
    for axes, modes, first in ((left, MODES, 0), (right, MODES[1:], 1)):
        axes.set_xticks(range(first, len(MODES)), modes, fontsize=8)
        axes.set_xlabel("length of the slave nodes", fontsize=8)
        axes.spines[["top", "right"]].set_visible(False)
    figure.legend(*left.get_legend_handles_labels(), ncols=2, fontsize=8, frameon=False, loc="upper center")
    figure.tight_layout(rect=(0, 0, 1, 0.93))
    figure.savefig(file, dpi=110, metadata={"Software": None})


def show(runs: list[Run]) -> str:
    """All tables, as they stand in doc/study/line_search.md."""
    parts = [sums_table(runs), problems_table(runs), dependence_table(runs), *(cases_table(runs, p) for p in PRECONDITIONERS)]
    return "\n\n".join("\n".join(part) for part in parts) + f"\n\n{agreement(runs)}"


def main() -> int:
    """Runs the requested cases, or shows the tables of a file of runs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--outdir", type=Path)
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    parser.add_argument("--runs", type=Path, default=Path("gradients.csv"), help="where the runs are kept")
    parser.add_argument("--preconditioners", nargs="+", choices=PRECONDITIONERS, default=PRECONDITIONERS)
    parser.add_argument("--modes", nargs="+", choices=MODES, default=MODES)
    parser.add_argument("--sizes", nargs="+", type=int, choices=SIZES, default=SIZES)
    parser.add_argument("--only", nargs="+", choices=PROBLEMS, default=tuple(PROBLEMS), help="some problems")
    parser.add_argument("--seconds", type=float, default=60.0, help="most time of a processor for one run of ALL, and of Newton's method")
    parser.add_argument("--seconds-others", type=float, default=LIMIT, help="the same of the other lengths")
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
    cases = [(p, q, mu, n) for p in options.preconditioners for q in options.only for mu in FRICTIONS for n in options.sizes]
    for case in cases:
        for mode in options.modes:
            seconds = options.seconds if mode == "ALL" else options.seconds_others
            r = kept[*case, mode] = run(options.program, folder, case, mode, seconds)
            print(*case, mode, cell(r), f"{r.seconds:.1f} s", r.difference, r.statuses, flush=True)
        write_runs(options.runs, sorted(kept.values(), key=place))
    return 0


if __name__ == "__main__":
    sys.exit(main())
