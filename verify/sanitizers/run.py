"""Runs jobs with a program built with sanitizers, and tells what these found: `make sanitize`, `make races`.

SPDX-License-Identifier: GPL-3.0-or-later

The jobs are all decks of the card reference (each card is in one of them), three cubes with friction, the decks of the page on
restarts, and a job with a UMAT: each kind of element, law, load, constraint and output once. With --preload the program is one
built with ThreadSanitizer, and the jobs run on two threads and more elements.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
FINDING = re.compile(r"runtime error: .*|ERROR: AddressSanitizer.*|WARNING: ThreadSanitizer.*|^ +#[0-4] .*", re.MULTILINE)
LIMIT = 1800  #: seconds for a job


def jobs(folder: Path) -> list[list[str]]:
    """The words of each job; decks that are not files of the repository are written into the folder."""
    decks = [*sorted((ROOT / "doc" / "manual" / "examples").glob("*.inp")), ROOT / "input" / "three_cubes.inp"]
    found = [["--outdir", str(folder), str(deck)] for deck in decks]
    page = (ROOT / "doc" / "manual" / "restart.md").read_text()
    for name, deck in zip(("first", "second"), re.findall(r"```abaqus\S*\n(.*?)```", page, re.DOTALL), strict=True):
        (folder / f"{name}.inp").write_text(deck)
    found += [["first"], ["second", "oldjob=first"]]
    page = (ROOT / "doc" / "manual" / "user_routines.md").read_text()
    (folder / "mine.f90").write_text(re.findall(r"```fortran\n(.*?)```", page, re.DOTALL)[0])
    (folder / "mine.inp").write_text(re.findall(r"```abaqus-user\n(.*?)```", page, re.DOTALL)[0])
    return [*found, ["mine", "user=mine.f90"]]


def run(program: Path, words: list[str], folder: Path, preload: Path | None) -> list[str]:
    """The findings of one job, and a line if it did not end well."""
    environment = os.environ | {
        "OMP_NUM_THREADS": "2",
        "ASAN_OPTIONS": "detect_leaks=0:exitcode=99",  # a job that is done leaves its last state to the system
        "UBSAN_OPTIONS": "print_stacktrace=1",
        "TSAN_OPTIONS": "exitcode=99:ignore_noninstrumented_modules=1",
    }
    command = [str(program), "--progress=none", *words]
    if preload:
        command = ["env", f"LD_PRELOAD={preload}", *command]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, errors="replace", timeout=LIMIT)
    output = done.stdout + done.stderr
    found = FINDING.findall(output) if re.search("runtime error|Sanitizer", output) else []
    return found + ([f"exit code {done.returncode}: {output.strip().splitlines()[-1:]}"] if done.returncode != 0 else [])


def main() -> int:
    """Runs all jobs; 1 if anything was found."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, required=True, help="built with BUILD=sanitize or BUILD=races")
    parser.add_argument("--preload", type=Path, help="gomp_order.so, for ThreadSanitizer")
    options = parser.parse_args()
    n_found = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        todo = jobs(folder)
        if options.preload:
            sys.path.insert(0, str(ROOT / "verify" / "decks"))
            import make_decks

            (folder / "block.inp").write_text(make_decks.block_deck(6))
            todo.append(["block"])
        for words in todo:
            found = run(options.program.resolve(), words, folder, options.preload and options.preload.resolve())
            print(f"{Path(words[-1] if words[0] == '--outdir' else words[0]).stem:20s} {'clean' if not found else 'FOUND'}", flush=True)
            print("".join(f"    {line.strip()}\n" for line in found[:40]), end="")
            n_found += bool(found)
    print(f"{len(todo) - n_found} jobs clean, {n_found} with findings")
    return 1 if n_found else 0


if __name__ == "__main__":
    sys.exit(main())
