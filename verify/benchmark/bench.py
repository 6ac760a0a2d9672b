"""Times Amontons against CalculiX on the same decks, in turn, and writes the table of doc/performance.md.

    python -m verify.benchmark.bench [--cases friction-nlgeom friction linear hertz plastic bracket bracket-limit ironing]
                                     [--sizes 10 15 21] [--runs 3] [--threads 1 2] [--curved] [--surface-to-surface] [--keep FILE] [--kernels FILE] [--write]

All decks are in the calculix dialect: the same element and contact law in both programs.

| case | model |
|---|---|
| friction-nlgeom, friction | a block 1 x 1 x 0.5 is pressed by 0.002 on a block 2 x 2 x 1, dragged by 0.004; ten increments each |
| linear | a cube on a fixed face, pulled sideways and pressed: one increment, one linear system |
| plastic | a cube of an elastic-plastic material upset by a tenth between rough tools: NLGEOM, automatic increments |
| bracket | an angle bracket of C3D10 (verify/decks/brackets.py), plastic, to 0.9 of its limit load: NLGEOM, automatic increments |
| bracket-limit | the same to its limit load, where CalculiX ends at 0.93 |
| hertz, ironing | the decks of input/; they have one size |

The size is the number of elements on an edge; friction has some 6.7 n^3 unknowns, a cube 3 (n + 1)^3, a bracket of
n elements through its thickness some 1400 n^3. Runs alternate, medians are
compared; processor time is the operating system's account of each process, so that other work on the machine disturbs both alike.
Two threads are compared by the time that passes. CalculiX runs on one thread, and once for all threads of ours. --keep remembers
its figures in a file and takes them from there the next time; without CalculiX (ccx) in the path only our own are printed. A program
that does not finish a case has no figures in its row. --kernels runs build/kernels (kernels.f90 beside this file, `make build/kernels`) on a
cube: elements a second, and the factor against dgemm.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import json
import math
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from verify.decks.brackets import Bracket
from verify.decks.make_decks import STEEL, Mesh, block, block_deck, hertz_deck, ironing_deck, material_cards, mesh_cards

ROOT = Path(__file__).resolve().parents[2]


DIALECT = "** dialect: calculix\n"
OUTPUT = "*NODE FILE\nU, RF\n*EL FILE\nS, E\n"
CASES = ["friction-nlgeom", "friction", "linear", "plastic", "bracket", "bracket-limit", "hertz", "ironing"]
ONE_SIZE = {"hertz", "ironing"}
PRESSURES = {"bracket": 2.1, "bracket-limit": 2.36}


@dataclass
class Run:
    """One finished process."""

    seconds: float  #: of the processor
    elapsed: float  #: seconds that passed
    megabytes: float
    text: str


@dataclass
class Theirs:
    """What CalculiX took."""

    seconds: float
    megabytes: float
    force: list[float]


def cube(n: int) -> Mesh:
    """A cube of n elements on each edge."""
    line = np.linspace(0.0, 1.0, n + 1)
    return block(line, line, line, "CUBE")


def linear_deck(n: int) -> str:
    """One linear system: a cube on a fixed face, with a pressure and a force on the other."""
    loads = "*BOUNDARY\nCUBE_BOTTOM, 1, 3\n*DLOAD\nCUBE_E2, P2, 10.\n*CLOAD\nCUBE_TOP, 1, 0.1\n"
    prints = "*NODE PRINT, NSET=CUBE_BOTTOM, TOTALS=ONLY\nRF\n"
    return (
        DIALECT
        + mesh_cards(cube(n))
        + material_cards("STEEL", STEEL, "CUBE")
        + f"*STEP\n*STATIC\n{loads}{prints}{OUTPUT}*END STEP\n"
    )


def plastic_deck(n: int) -> str:
    """Upsetting: a cube with hardening, pressed by a tenth of its height between tools that hold it."""
    steel = "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n*PLASTIC\n300., 0.\n400., 0.1\n500., 1.\n"
    supports = "*BOUNDARY\nCUBE_BOTTOM, 1, 3\nCUBE_TOP, 1, 2\nCUBE_TOP, 3, 3, -0.1\n"
    prints = "*NODE PRINT, NSET=CUBE_TOP, TOTALS=ONLY\nRF\n"
    return (
        DIALECT
        + mesh_cards(cube(n))
        + steel
        + "*SOLID SECTION, ELSET=CUBE, MATERIAL=STEEL\n"
        + f"*STEP, NLGEOM\n*STATIC\n0.1, 1., , 0.1\n{supports}{prints}{OUTPUT}*END STEP\n"
    )


def curve(deck: str) -> str:
    """The deck with all nodes lifted by 0.05 (1 - x^2): both bodies, so that their surfaces still touch."""
    lines, is_node = [], False
    for line in deck.splitlines():
        if line.startswith("*"):
            is_node = line.startswith("*NODE") and "," not in line and line.strip() == "*NODE"
        elif is_node:
            label, x, y, z = line.split(",")
            line = f"{label},{x},{y}, {float(z) + 0.05 * (1 - float(x) ** 2):.10g}"
        lines.append(line)
    return "\n".join(lines) + "\n"


def deck_of(case: str, size: int, options: argparse.Namespace) -> str:
    """The deck of a case."""
    if case == "linear":
        return linear_deck(size)
    if case == "plastic":
        return plastic_deck(size)
    if case in PRESSURES:
        return DIALECT + Bracket("C3D10", size, 10 * size // 3, 20 * size // 3, "300., 0.\n310., 0.2\n", PRESSURES[case], True).deck()
    if case == "hertz":
        return DIALECT + hertz_deck()
    if case == "ironing":
        return DIALECT + ironing_deck()
    text = block_deck(
        size, is_nlgeom=case == "friction-nlgeom", dialect="calculix", surface_to_surface=options.surface_to_surface
    )
    return curve(text) if options.curved else text


def unknowns_of(deck: str) -> int:
    """Three for each node of the deck."""
    nodes, is_node = 0, False
    for line in deck.splitlines():
        if line.startswith("*"):
            is_node = line.split(",")[0].strip() == "*NODE"
        elif is_node:
            nodes += 1
    return 3 * nodes


def timed(command: list[str], folder: Path, threads: int) -> Run:
    """Time and peak memory of one process."""
    environment = os.environ | {
        "OMP_NUM_THREADS": str(threads),
        "CCX_NPROC_STIFFNESS": "1",
        "CCX_NPROC_RESULTS": "1",
        "NUMBER_OF_CPUS": "1",
    }
    start = time.monotonic()
    process = subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    text = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    elapsed = time.monotonic() - start
    if status != 0:
        raise RuntimeError(f"{command[0]} ended with {os.waitstatus_to_exitcode(status)}:\n{text[-500:]}")
    return Run(usage.ru_utime + usage.ru_stime, elapsed, usage.ru_maxrss / 1024.0, text)


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


def run_theirs(ccx: str | None, folder: Path, key: str, runs: int, kept: dict[str, Theirs]) -> Theirs | None:
    """CalculiX on job.inp, or its figures of an earlier time; None without CalculiX, or where it fails."""
    if key in kept:
        return kept[key]
    if not ccx:
        return None
    try:
        done = [timed([ccx, "-i", "job"], folder, 1) for _ in range(runs)]
    except RuntimeError:
        return None
    kept[key] = Theirs(
        statistics.median(run.seconds for run in done),
        max(run.megabytes for run in done),
        reaction(folder / "job.dat"),
    )
    return kept[key]


def bench_case(
    case: str, size: int, ccx: str | None, folder: Path, options: argparse.Namespace, kept: dict[str, Theirs]
) -> list[str]:
    """The rows of one case and size, one for each number of threads."""
    deck = deck_of(case, size, options)
    (folder / "job.inp").write_text(deck)
    key = f"{case}-{size}" + ("-curved" if options.curved else "") + ("-s2s" if options.surface_to_surface else "")
    theirs = run_theirs(ccx, folder, key, options.runs, kept)
    command = [str(options.program.resolve()), "--progress=plain", "--threads"]
    ours: dict[int, list[Run]] = {n: [] for n in options.threads}
    name = case + (", curved" if options.curved else "") + (", surface to surface" if options.surface_to_surface else "")
    try:
        for _ in range(options.runs):
            for n in options.threads:
                ours[n].append(timed([*command, str(n), "job.inp"], folder, n))
    except RuntimeError as error:
        print(error, file=sys.stderr)
        cells = [f"{theirs.seconds:.1f}", f"{theirs.megabytes:.0f}"] if theirs else ["-", "-"]
        return ["| " + " | ".join([name, str(unknowns_of(deck)), *["-"] * 7, *cells, "-", "-"]) + " |"]
    force = reaction(folder / "job.dat")
    rows = []
    for n in options.threads:
        text = ours[n][-1].text
        mine = statistics.median(run.seconds for run in ours[n])
        cells = [
            name,
            str(unknowns_of(deck)),
            str(n),
            f"{mine:.1f}",
            f"{statistics.median(run.elapsed for run in ours[n]):.1f}",
            *(str(number_after(words, text)) for words in ("Newton iterations", "factorisations", "Krylov iterations")),
            f"{max(run.megabytes for run in ours[n]):.0f}",
        ]
        if theirs:
            gap = max((abs(a - b) for a, b in zip(force, theirs.force, strict=False)), default=math.nan)
            size_of = max(map(abs, theirs.force), default=math.nan)
            cells += [f"{theirs.seconds:.1f}", f"{theirs.megabytes:.0f}", f"{theirs.seconds / mine:.1f}"]
            cells += [f"{100 * gap / size_of:.2g} %"]
        else:
            cells += ["-", "-", "-", "-"]
        rows.append("| " + " | ".join(cells) + " |")
    return rows


def growth(measured: dict[str, list[tuple[int, float]]]) -> list[str]:
    """One line a case: the exponent of the processor time over the unknowns, fitted over all sizes."""
    lines = []
    for case, points in measured.items():
        if len(points) > 1:
            slope = np.polyfit(np.log([n for n, _ in points]), np.log([t for _, t in points]), 1)[0]
            lines.append(f"{case}: time grows as unknowns to the power {slope:.2f} (one thread, {len(points)} sizes).")
    return lines


HEAD = (
    "| case | unknowns | threads | s | elapsed | iterations | factorisations | Krylov | MB | CalculiX s | CalculiX MB | ratio "
    "| reactions differ by |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|"
)


def main() -> int:
    """Runs the cases and prints the table; --write puts it into doc/performance.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", type=int, nargs="+", default=[10, 15])
    parser.add_argument("--cases", nargs="+", choices=CASES, default=CASES[:3])
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--threads", type=int, nargs="+", default=[1])
    parser.add_argument("--curved", action="store_true", help="the friction cases on a curved surface")
    parser.add_argument("--surface-to-surface", action="store_true", help="the friction cases with this formulation")
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    parser.add_argument("--keep", type=Path, help="file in which CalculiX's figures are kept")
    parser.add_argument("--kernels", type=Path, help="the program of kernels.f90: also run it, on a cube of 31 elements on an edge")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    kept: dict[str, Theirs] = {}
    if options.keep and options.keep.exists():
        kept = {key: Theirs(**value) for key, value in json.loads(options.keep.read_text()).items()}
    rows = [HEAD]
    print(HEAD)
    measured: dict[str, list[tuple[int, float]]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for case in options.cases:
            for size in options.sizes if case not in ONE_SIZE else [0]:
                found = bench_case(case, size, shutil.which("ccx"), Path(folder), options, kept)
                print("\n".join(found), flush=True)
                rows += found
                cells = found[0].split("|")
                if cells[4].strip() != "-":
                    measured.setdefault(case, []).append((int(cells[2]), float(cells[4])))
                if options.keep:
                    options.keep.write_text(json.dumps({key: vars(value) for key, value in kept.items()}))
        last = ["", *growth(measured)]
        if options.kernels:
            deck = Path(folder) / "cube.inp"
            deck.write_text(linear_deck(31))
            kernels = subprocess.run([options.kernels.resolve(), deck], capture_output=True, text=True, check=True)
            last += ["", "```", *kernels.stdout.splitlines(), "```"]
    print("\n".join(last))
    rows += last
    if options.write:
        page = ROOT / "doc" / "performance.md"
        before, _, rest = page.read_text().partition("<!-- table -->")
        _, _, after = rest.partition("<!-- end -->")
        page.write_text(before + "<!-- table -->\n" + "\n".join(rows) + "\n<!-- end -->" + after)
    return 0


if __name__ == "__main__":
    sys.exit(main())
