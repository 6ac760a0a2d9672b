"""Loose against tight convergence criteria: where the displacements differ by more than the loose tolerance promises.

    python -m verify.study.criteria_table [DECK ...] [--program bin/amontons] [--seconds 60] [--all]

Without decks: those of input/ and doc/manual/examples/, CalculiX's where they are (../shared/decks or AMONTONS_DECKS), and
those of verify.decks.soft_decks. Each deck runs with the criteria of the calculix dialect and with 1e-9, all else as it says.
Displacements are compared at the times that both runs have. A correction within C_n = 1 % of the increment in each increment promises an
error within 1 % of the path: the sum of the largest displacements of the increments so far. Where statuses of contact or yielding
depend on the history, the increments of both runs must be the same for that; the table marks where they are not.

The exit code is 1 if a deck differs by more than it may.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import os
import re
import resource
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from verify.decks.soft_decks import cantilever_on_a_rope, spring_beside_bar, strip_bent_both_ways, tied_tee

ROOT = Path(__file__).resolve().parents[2]
DECKS = Path(os.environ.get("AMONTONS_DECKS", ROOT.parent / "shared" / "decks"))
LOOSE = "5e-4, 1e-2, , 2e-2, 1e-8"
TIGHT = "1e-9, 1e-9, , 1e-9, 1e-11"
PROMISED = 0.01  # C_n of LOOSE
SAME_TIME = 1e-6  # times within this fraction of the last one are the same
PROCEDURES = ("*STATIC", "*VISCO")

Floats = NDArray[np.float64]


@dataclass
class Run:
    """Displacements of one run."""

    times: Floats  #: (n_increments)
    u: Floats  #: (n_increments, n_nodes, 3)
    is_done: bool
    n_iterations: int


@dataclass
class Difference:
    """The largest difference of two runs over the path of the tight one, and where both stand."""

    ratio: float
    time: float
    has_same_increments: bool  #: all increments are the same
    loose: Run
    tight: Run


def with_criteria(deck: str, criteria: str) -> str:
    """The deck with *CONTROLS, PARAMETERS=FIELD in each step, in place of its own."""
    lines: list[str] = []
    is_skipped = is_procedure = False
    for line in deck.splitlines():
        if line.lstrip().startswith("*") and not line.lstrip().startswith("**"):
            if is_procedure:
                lines += ["*CONTROLS, PARAMETERS=FIELD", criteria]
            card = line.upper().replace(" ", "")
            is_procedure = card.split(",")[0] in PROCEDURES
            is_skipped = card.startswith("*CONTROLS,PARAMETERS=FIELD")
        if not is_skipped:
            lines.append(line)
    return "\n".join(lines) + "\n"


def run_deck(program: Path, folder: Path, deck: str, options: list[str], seconds: int) -> Run | None:
    """Runs a deck; None if it wrote no result."""
    (folder / "job.inp").write_text(deck)
    for old in folder.glob("job.vtkhdf"):
        old.unlink()
    command = [str(program), "--quiet", "--no-checkpoint", *options, "job"]
    done = subprocess.run(command, cwd=folder, check=False, capture_output=True,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1)))  # noqa: PLW1509
    if not (folder / "job.vtkhdf").exists():
        return None
    try:
        with h5py.File(folder / "job.vtkhdf") as file:
            times = file["VTKHDF/Steps/Values"][:]
            u = file["VTKHDF/PointData/U"][:].reshape(len(times), -1, 3)
            iterations = int(file["AMONTONS/history/n_iterations"][:].sum())
    except (OSError, KeyError, ValueError):
        return None
    return Run(times, u, done.returncode == 0, iterations)


def compare(loose: Run, tight: Run) -> Difference:
    """The largest difference over the path at the times of both."""
    path = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(tight.u, axis=0)).max(axis=(1, 2)))])
    ratio, time = 0.0, 0.0
    for i, t in enumerate(loose.times):
        k = int(np.argmin(np.abs(tight.times - t)))
        if abs(tight.times[k] - t) > SAME_TIME * tight.times[-1] or not path[k] > 0:
            continue
        here = float(np.abs(loose.u[i] - tight.u[k]).max() / path[k])
        if here > ratio:
            ratio, time = here, float(t)
    same = len(loose.times) == len(tight.times) and bool(np.allclose(loose.times, tight.times, rtol=SAME_TIME))
    return Difference(ratio, time, same, loose, tight)


def dialect_of(path: Path) -> list[str]:
    """The option for CalculiX's own decks."""
    return ["--dialect=calculix"] if DECKS in path.parents else []


def own_decks() -> dict[str, str]:
    """Decks with a soft motion beside a stiff part."""
    return {
        "spring beside bar": spring_beside_bar(1e6, 1.5, 4),
        "rope, taut": cantilever_on_a_rope((0, 200, 0), (3, -2, 8), 0.0),
        "rope, stiff beside soft": cantilever_on_a_rope((0, 200, 0), (0.02, -4, 8), 0.01),
        "tied tee": tied_tee(),
        "strip bent both ways": strip_bent_both_ways("C3D20R"),
        "rope, slack": cantilever_on_a_rope((0, 100, 0), (2, -4, 8), 0.05),
    }


def jobs(named: list[Path]) -> list[tuple[str, str, list[str], Path]]:
    """Name, deck, options and folder of its includes."""
    paths = named or sorted([*(ROOT / "input").glob("*.inp"), *(ROOT / "doc/manual/examples").glob("*.inp"),
                             *DECKS.glob("static/*.inp"), *DECKS.glob("contact/*.inp")])
    found = [(path.stem, path.read_text(errors="replace"), dialect_of(path), path.parent) for path in paths]
    return found if named else [(name, deck, [], ROOT) for name, deck in own_decks().items()] + found


def with_includes(deck: str, folder: Path) -> str:
    """Files of *INCLUDE by their full path."""
    return re.sub(r"(?im)^(\*INCLUDE\s*,\s*INPUT\s*=\s*)([^/\n]\S*)", lambda m: f"{m[1]}{folder / m[2]}", deck)


def judge(program: Path, deck: str, options: list[str], seconds: int) -> Difference | None:
    """Both runs of a deck; None if one of them gave no result."""
    with tempfile.TemporaryDirectory() as name:
        runs = [run_deck(program, Path(name), with_criteria(deck, criteria), options, seconds) for criteria in (LOOSE, TIGHT)]
    loose, tight = runs
    return compare(loose, tight) if loose and tight else None


def main(arguments: list[str] | None = None) -> int:
    """Prints a line for each deck that differs; all with --all."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("decks", nargs="*", type=Path)
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    parser.add_argument("--seconds", type=int, default=60, help="of a processor for each run")
    parser.add_argument("--all", action="store_true", help="decks that agree too")
    options = parser.parse_args(arguments)
    print(f"{'deck':28s} {'difference/path':>16s} {'at time':>9s} {'iterations':>12s}")
    n_compared = n_bad = 0
    for name, deck, flags, folder in jobs(options.decks):
        found = judge(options.program.resolve(), with_includes(deck, folder.resolve()), flags, options.seconds)
        if found is None:
            continue
        n_compared += 1
        is_bad = found.ratio > PROMISED or found.loose.is_done != found.tight.is_done
        n_bad += is_bad
        note = "" if found.has_same_increments else "  other increments"
        for run, word in ((found.loose, "loose"), (found.tight, "tight")):
            note += "" if run.is_done else f"  {word} does not finish"
        if is_bad or options.all:
            print(f"{name:28s} {found.ratio:16.2e} {found.time:9.3g} {found.loose.n_iterations:6d}/{found.tight.n_iterations:<5d}{note}",
                  flush=True)
    print(f"{n_compared} decks compared, {n_bad} differ by more than {PROMISED:g} of the path or in their end")
    return int(n_bad > 0)


if __name__ == "__main__":
    sys.exit(main())
