"""What `amontons --estimate` says of jobs beside what they take: a table in Markdown.

    python -m verify.benchmark.estimate_table [--program bin/amontons] [--edges 12 24 36] [--plates 10 20]

Cubes of C3D8 under a load, solved by a factor (as the program chooses below some 100 thousand unknowns) and by iteration (as SOLVER
requests), and the two plates of `verify.benchmark.wide_contact`. One thread each; memory is the peak of the process, processor time
the operating system's account, and the seconds of the factor are those of the program's table of phases over its factorizations.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import os
import re
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import h5py

from verify.benchmark.wide_contact import Model, deck_of
from verify.decks.make_decks import block, material_cards, mesh_cards

HEAD = ("| job | unknowns | choice | MB: estimate | taken | factor s: estimate | taken | processor s: estimate | taken |\n"
        "|---|---|---|---|---|---|---|---|---|")


def cube(n: int, solver: str) -> str:
    """A cube of n elements per edge, held at its bottom, loaded at its top."""
    axis = [i / n for i in range(n + 1)]
    mesh = block(axis, axis, axis, "CUBE")
    mesh.select("LOW", lambda x: x[:, 2] < 1e-9)
    mesh.select("HIGH", lambda x: x[:, 2] > 1 - 1e-9)
    return (f"{mesh_cards(mesh)}{material_cards('STEEL', (2.1e5, 0.3), 'CUBE')}*BOUNDARY\nLOW, 1, 3\n*STEP\n*STATIC{solver}\n*CLOAD\n"
            "HIGH, 3, -1.\n*END STEP\n")


def run(command: list[str], folder: Path) -> tuple[str, float]:
    """Output and processor seconds of a process."""
    output = folder / "output.txt"
    pid = os.fork()
    if pid == 0:
        with output.open("w") as file:
            os.dup2(file.fileno(), 1)
            os.chdir(folder)
            os.environ["OMP_NUM_THREADS"] = "1"
            os.execv(command[0], command)
    _, status, usage = os.wait4(pid, 0)
    text = output.read_text()
    if status != 0:
        raise SystemExit(f"{' '.join(command)} ended with status {status}:\n{text}")
    return text, usage.ru_utime + usage.ru_stime


def peak_megabytes(output: str) -> float:
    """What a job prints. The kernel's figure would begin with the process from which the job was forked."""
    return float(figure(output, r"the whole job +[\d.]+ +(\d+)"))


def figure(text: str, pattern: str) -> str:
    """The first group of a pattern in the estimate; '-' where it is not said."""
    found = re.search(pattern, text, re.M)
    return found.group(1) if found else "-"


def factor_seconds(path: Path) -> str:
    """Seconds of the factor phase per factorization, from the history of the job."""
    with h5py.File(path) as file:
        history = file["AMONTONS/history"]
        phase = [name.decode().strip() for name in file["AMONTONS/phases"][:]].index("factor")
        seconds, count = history["seconds"][:, phase].sum(), history["n_factorisations"][:].sum()
    return f"{seconds / count:.2f}" if count else "-"


def row(name: str, text: str, program: str, folder: Path) -> str:
    """Estimates a deck, runs it and compares."""
    folder.mkdir()
    (folder / "job.inp").write_text(text)
    estimate, _ = run([program, "--estimate", "job"], folder)
    output, seconds = run([program, "job"], folder)
    megabytes = peak_megabytes(output)
    choice = figure(estimate, r"^  choice +(\w+)")
    is_factor = choice == "factor" and "contact       none" in estimate  # with contact the phase holds the interface, too
    cells = [
        name,
        figure(estimate, r"of them (\d+) free"),
        choice,
        figure(estimate, r"^  memory +(\d+)"),
        f"{megabytes:.0f}",
        figure(estimate, r"^  factor +(?:some )?([\d.]+) s") if is_factor else "-",
        factor_seconds(folder / "job.vtkhdf") if is_factor else "-",
        figure(estimate, r"^  job +some ([\d.]+) s and"),
        f"{seconds:.1f}",
    ]
    return f"| {' | '.join(cells)} |"


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="bin/amontons")
    parser.add_argument("--edges", nargs="*", type=int, default=[12, 24, 36])
    parser.add_argument("--plates", nargs="*", type=int, default=[10, 20])
    options = parser.parse_args(arguments)
    program = str(Path(options.program).resolve())
    print(HEAD)
    with tempfile.TemporaryDirectory() as folder:
        for n in options.edges:
            for solver in ("", ", SOLVER=ITERATIVE SCALING"):
                print(row(f"cube, {n} elements an edge", cube(n, solver), program, Path(folder) / f"{n}{solver[-1:]}"), flush=True)
        for n in options.plates:
            print(row(f"plates, N = {n}", deck_of(Model(n)), program, Path(folder) / f"plates{n}"), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
