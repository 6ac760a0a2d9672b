"""Times Amontons against CalculiX on the same decks, in turn, and writes the table of doc/performance.md.

    python verify/benchmark/bench.py [--sizes 10 15 21] [--runs 3] [--cases friction-nlgeom friction linear] [--write]

The decks are those of verify/decks/make_decks.py in the calculix dialect (the same element and contact law in both
programs): an upper block 1 x 1 x 0.5 is pressed by 0.002 on a lower block 2 x 2 x 1 and dragged by 0.004, ten increments each.
One thread each. Runs alternate, medians are compared; processor time is the operating system's account of each process.
Without CalculiX (ccx) in the path only our own figures are printed.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "verify"))

from decks.make_decks import block_deck, block_mesh  # noqa: E402

CASES = {"friction-nlgeom": True, "friction": False}


@dataclass
class Run:
    """One finished process."""

    seconds: float
    megabytes: float
    text: str


def timed(command: list[str], folder: Path) -> Run:
    """Processor seconds and peak memory of one process."""
    environment = os.environ | {"OMP_NUM_THREADS": "1", "CCX_NPROC_STIFFNESS": "1", "CCX_NPROC_RESULTS": "1"}
    process = subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    text = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise RuntimeError(f"{command[0]} ended with {os.waitstatus_to_exitcode(status)}:\n{text[-500:]}")
    return Run(usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024.0, text)


def number_after(words: str, text: str) -> int:
    """The first number after some words."""
    found = re.search(re.escape(words) + r"\s+(\d+)", text)
    return int(found.group(1)) if found else 0


def reaction(path: Path) -> list[float]:
    """The last total force of a .dat file."""
    numbers: list[float] = []
    lines = path.read_text().splitlines()
    for line, after in zip(lines, lines[2:], strict=False):
        if "total force" in line:
            numbers = [float(word) for word in after.split()]
    return numbers


def bench_case(program: Path, ccx: str | None, folder: Path, size: int, is_nlgeom: bool, runs: int) -> str:
    """One row of the table."""
    deck = folder / "job.inp"
    deck.write_text(block_deck(size, is_nlgeom=is_nlgeom, dialect="calculix"))
    ours, theirs = [], []
    forces: dict[str, list[float]] = {}
    for _ in range(runs):
        ours.append(timed([str(program), "--threads", "1", "--progress=plain", "job.inp"], folder))
        forces["ours"] = reaction(folder / "job.dat")
        if ccx:
            theirs.append(timed([ccx, "-i", "job"], folder))
            forces["theirs"] = reaction(folder / "job.dat")
    text = ours[-1].text
    mine = statistics.median(run.seconds for run in ours)
    row = [
        "friction, NLGEOM" if is_nlgeom else "friction",
        f"{3 * len(block_mesh(size, None).nodes)}",
        f"{mine:.1f}",
        f"{number_after('Newton iterations', text)}",
        f"{number_after('factorisations', text)}",
        f"{number_after('Krylov iterations', text)}",
        f"{max(run.megabytes for run in ours):.0f}",
    ]
    if theirs:
        his = statistics.median(run.seconds for run in theirs)
        gap = max(abs(a - b) for a, b in zip(forces["ours"], forces["theirs"], strict=True))
        row += [f"{his:.1f}", f"{his / mine:.1f}", f"{100 * gap / max(map(abs, forces['theirs'])):.2g} %"]
    else:
        row += ["-", "-", "-"]
    return "| " + " | ".join(row) + " |"


HEAD = (
    "| case | unknowns | s | iterations | factorisations | Krylov | MB | CalculiX s | ratio | reactions differ by |\n"
    "|---|---|---|---|---|---|---|---|---|---|"
)


def main() -> int:
    """Runs the cases and prints the table; --write puts it into doc/performance.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", type=int, nargs="+", default=[10, 15])
    parser.add_argument("--cases", nargs="+", choices=list(CASES), default=list(CASES))
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    rows = [HEAD]
    print(HEAD)
    ccx = shutil.which("ccx")
    with tempfile.TemporaryDirectory() as folder:
        for case in options.cases:
            for size in options.sizes:
                rows.append(bench_case(options.program, ccx, Path(folder), size, CASES[case], options.runs))
                print(rows[-1], flush=True)
    if options.write:
        page = ROOT / "doc" / "performance.md"
        before, _, rest = page.read_text().partition("<!-- table -->")
        _, _, after = rest.partition("<!-- end -->")
        page.write_text(before + "<!-- table -->\n" + "\n".join(rows) + "\n<!-- end -->" + after)
    return 0


if __name__ == "__main__":
    sys.exit(main())
