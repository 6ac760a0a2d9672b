"""Amontons and CalculiX on the pin in a lug (verify/decks/pin_in_lug.py): a table of their effort, in Markdown.

    python -m verify.benchmark.pin_in_lug [--size 3] [--limit 500] [--program bin/amontons] [--ccx ccx]

One thread each. A job is stopped after the limit in processor seconds. By force the pin is free until it touches; by displacement it
is held from the start. The row "exact" is the abaqus dialect; "law" is the calculix dialect, in which both programs read the same
deck. Processor time is the operating system's account of the process; without CalculiX in the path only our own rows are printed.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from verify.benchmark.bench import reaction
from verify.decks.pin_in_lug import pin_in_lug
from verify.readers.sta_cvg_files import read_cvg, read_sta

#: Load, contact, programs.
ROWS = [
    ("force", "exact", ["amontons"]),
    ("force", "law", ["amontons", "ccx"]),
    ("displacement", "law", ["amontons", "ccx"]),
]
HEAD = "| load | contact | program | processor s | increments | iterations | ends | force at the root |\n|---|---|---|---|---|---|---|---|"


def run_limited(command: list[str], folder: Path, seconds: int) -> tuple[float, int]:
    """Processor seconds of a process and its exit code; negative: ended by a signal, as at the limit."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with (folder / "output.txt").open("w") as output:
        done = subprocess.run(
            command, cwd=folder, env=os.environ | {"OMP_NUM_THREADS": "1"}, stdout=output, stderr=subprocess.STDOUT, check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds)),
        )  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.returncode


def row(load: str, contact: str, name: str, command: list[str], folder: Path, limit: int, deck: str) -> str:
    """Runs a deck and describes it."""
    folder.mkdir()
    (folder / "job.inp").write_text(deck)
    seconds, code = run_limited(command, folder, limit)
    attempts, iterations = read_sta(folder / "job.sta"), read_cvg(folder / "job.cvg")
    good = [attempt for attempt in attempts if not attempt.is_failed]
    done = code == 0 and bool(good) and abs(good[-1].time - 1) < 1e-6
    end = "at the full load" if done else f"after {limit} s" if seconds > limit - 1 else f"with exit code {code}"
    force = f"{abs(reaction(folder / 'job.dat')[0]):.0f}" if done else "-"
    where = end if done else f"{end}, in increment {len(good) + 1}"
    return f"| {load} | {contact} | {name} | {seconds:.1f} | {len(good)} | {len(iterations)} | {where} | {force} |"


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description="Compare Amontons and CalculiX on a pin in a lug.")
    parser.add_argument("--size", type=float, default=3.0, help="length of the edges in the contact")
    parser.add_argument("--limit", type=int, default=500, help="processor seconds of a job")
    parser.add_argument("--program", default="bin/amontons")
    parser.add_argument("--ccx", default="ccx")
    options = parser.parse_args(arguments)
    ccx = shutil.which(options.ccx)
    if not ccx:
        print("There is no ccx here (apt-get install -y calculix-ccx): only the rows of Amontons.", file=sys.stderr)
    print(HEAD, flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for k, (load, contact, programs) in enumerate(ROWS):
            deck = pin_in_lug(options.size, "abaqus" if contact == "exact" else "calculix", load == "displacement")
            for name in programs:
                command = [str(Path(options.program).resolve()), "--threads", "1", "job"] if name == "amontons" else [str(ccx), "-i", "job"]
                if name == "amontons" or ccx:
                    title = "Amontons" if name == "amontons" else "CalculiX"
                    print(row(load, contact, title, command, Path(folder) / f"{k}{name}", options.limit, deck), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
