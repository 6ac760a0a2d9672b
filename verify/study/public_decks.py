"""Decks of others, run here and in CalculiX: who finishes, what stops the rest, and how far the displacements differ.

The decks lie below a folder, one folder for each of their sources; none is part of Amontons. A deck with *STATIC or *VISCO and
without a card of another procedure counts. One of parts and instances or with a user routine is read under the abaqus dialect and not
compared, because CalculiX passes over these cards or lacks the routine; any other is read under the calculix dialect, so that both
mean the same elements. CalculiX gets a copy that requests the displacements in its .frd file. A user routine is taken from the
Fortran file beside the deck that has it; of several from the one whose name is most like the deck's. Displacements are compared at the end of the job, at the nodes with one number
and one place in both, over the largest of CalculiX.

    python -m verify.study.public_decks FOLDER [--seconds 60] [--details]

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from difflib import SequenceMatcher
from pathlib import Path

import h5py
import numpy as np

from verify.readers.dat_frd_files import read_frd, read_frd_places
from verify.study.runs import run_limited

WITHIN = 0.01  #: of the largest displacement: agrees
HAS_PARTS = re.compile(r"^\*(part|assembly|instance)\b", re.I | re.M)
IS_STATIC = re.compile(r"^\*(static|visco)\b", re.I | re.M)
OTHERS = re.compile(r"^\*(dynamic|frequency|buckle|heat\s*transfer|(un)?coupled\s*temperature|modal\s*dynamic|steady\s*state|green|"
                    r"electromagnetics|mass\s*diffusion|soils|geostatic|substructure|complex\s*frequency|no\s*analysis)", re.I | re.M)
FORTRAN = {".for", ".f", ".f90"}
ROUTINES = {"UEL": r"\*user\s*element(?!.*maxdof)", "UMAT": r"\*user\s*material", "USDFLD": r"\*user\s*defined\s*field"}  #: and the cards that need them; MAXDOF: CalculiX's own
COMPILER_ENDED = "signal terminated program"  #: gfortran of its own process: the limit of time ends the compilation of a routine
OUR_CODES = {0: "finishes", 3: "errors in the deck", 4: "model check", 5: "does not converge"}


@dataclass
class Run:
    """A deck in one program."""

    code: int  #: exit code; -1: out of time
    seconds: float
    log: str
    u: dict[int, tuple[np.ndarray, np.ndarray]] | None = None  #: by node: its place, its displacement at the end


@dataclass
class Outcome:
    """A deck in both."""

    source: str
    deck: str
    ours: Run
    theirs: Run
    deviation: float | None = None

    @property
    def cause(self) -> str:
        """What stops Amontons, without numbers and names."""
        return "" if self.ours.code == 0 else cause_of(self.ours)


def cause_of(run: Run) -> str:
    """The first error of a log, without its place, numbers and names."""
    if run.code == -1 or COMPILER_ENDED in run.log:
        return "out of time"
    errors = [line for line in run.log.splitlines() if "*ERROR" in line]
    if not errors:
        return f"exit {run.code} without an error message"
    text = re.sub(r"^.*?\*ERROR:\s*", "", errors[0])
    text = re.sub(r"\b[\w.+-]*\d[\w.+-]*", "#", re.split(r"(?<=[a-z]{2})\. ", text)[0])
    return re.sub(r"\s+", " ", text)[:130]


def execute(command: list[str | Path], folder: Path, seconds: float) -> Run:
    """Runs a program in a folder with a limit of processor time."""
    try:
        done, spent = run_limited(command, seconds, folder, timeout=10 * seconds)
    except subprocess.TimeoutExpired:
        return Run(-1, seconds, "")
    log = (done.stdout + done.stderr).decode(errors="replace")
    return Run(-1 if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL) else done.returncode, spent, log)


def needed_routine(deck: Path) -> str:
    """The first user routine that a deck needs."""
    text = deck.read_text(errors="replace")
    return next((name for name, card in ROUTINES.items() if re.search(f"^{card}", text, re.I | re.M)), "")


def routine_file(deck: Path) -> Path | None:
    """The Fortran file beside a deck with the routine that it needs, of several the one whose name is most like the deck's."""
    begin = re.compile(rf"^\s*subroutine\s+{needed_routine(deck)}\s*\(", re.I | re.M)
    files = [path for path in sorted(deck.parent.iterdir()) if path.suffix.lower() in FORTRAN and begin.search(path.read_text(errors="replace"))]
    return max(files, key=lambda path: SequenceMatcher(None, path.stem.lower(), deck.stem.lower()).ratio(), default=None)


def is_abaqus(deck: Path) -> bool:
    """Whether a deck has cards of parts, which CalculiX does not know, or needs a routine, which it does not have."""
    return bool(HAS_PARTS.search(deck.read_text(errors="replace")) or needed_routine(deck))


def run_ours(program: Path, deck: Path, folder: Path, seconds: float) -> Run:
    """A deck in Amontons."""
    dialect = "abaqus" if is_abaqus(deck) else "calculix"
    routines = routine_file(deck) if needed_routine(deck) else None
    words = [f"user={routines}"] if routines else []
    run = execute([program, "--no-checkpoint", "--progress=none", f"--dialect={dialect}", "--outdir", folder, deck, *words], deck.parent, seconds)
    file = folder / (deck.stem + ".vtkhdf")
    if run.code == 0 and file.exists():
        with h5py.File(file) as data:
            n, labels = int(data["VTKHDF/NumberOfPoints"][-1]), data["AMONTONS/mesh/node_label"][:]
            x, u = data["VTKHDF/Points"][-n:], data["VTKHDF/PointData/U"][-n:]
            run.u = {int(k): (x[i], u[i]) for i, k in enumerate(labels)} if len(set(labels)) == n else None
    return run


def run_theirs(peer: str, deck: Path, folder: Path, seconds: float) -> Run:
    """A deck in CalculiX, in a copy that writes the displacements."""
    shutil.copytree(deck.parent, folder, dirs_exist_ok=True)
    text = deck.read_text(errors="replace")
    (folder / "peer.inp").write_text(re.sub(r"^\*end\s*step", "*NODE FILE, OUTPUT=2D\nU\n*END STEP", text, flags=re.I | re.M))
    run = execute([peer, "peer"], folder, seconds)
    if run.code == 0 and "Job finished" not in run.log:
        run.code = 1
    file = folder / "peer.frd"
    if run.code == 0 and file.exists():
        blocks = [b for b in read_frd(file) if b.title == "DISP"]
        places = read_frd_places(file)
        if blocks:
            run.u = {k[0]: (np.array(places[k[0]]), np.array(row)) for k, row in blocks[-1].rows.items() if k[0] in places}
    return run


def deviation(ours: Run, theirs: Run) -> float | None:
    """The largest difference of displacements at the nodes that both have."""
    if not ours.u or not theirs.u:
        return None
    size = max(float(np.ptp([x for x, _ in ours.u.values()], axis=0).max()), 1e-300)
    both = [k for k in ours.u.keys() & theirs.u.keys() if np.abs(ours.u[k][0] - theirs.u[k][0]).max() < 1e-4 * size]
    if not both:
        return None
    a, b = (np.array([run.u[k][1][:3] for k in both]) for run in (ours, theirs))  # type: ignore[index]
    largest = float(np.abs(b).max())
    return float(np.abs(a - b).max()) / largest if largest > 0 else float(np.abs(a).max() > 0)


def decks_below(folder: Path) -> list[Path]:
    """The static decks below a folder, in the order of their names."""
    def is_static(path: Path) -> bool:
        text = path.read_text(errors="replace")
        return bool(IS_STATIC.search(text)) and not OTHERS.search(text)

    return [path for path in sorted(folder.rglob("*")) if path.suffix.lower() == ".inp" and path.is_file() and is_static(path)]


def run_all(folder: Path, work: Path, program: Path, peer: str, seconds: float) -> Iterator[Outcome]:
    """All decks below a folder, each in both programs."""
    for k, deck in enumerate(decks_below(folder)):
        ours_in, theirs_in = work / f"{k}_ours", work / f"{k}_peer"
        ours_in.mkdir(parents=True)
        ours, theirs = run_ours(program, deck, ours_in, seconds), run_theirs(peer, deck, theirs_in, seconds)
        name = deck.relative_to(folder)
        yield Outcome(name.parts[0], str(name), ours, theirs, None if is_abaqus(deck) else deviation(ours, theirs))
        for place in (ours_in, theirs_in):
            shutil.rmtree(place)


def counts(outcomes: list[Outcome]) -> Iterator[str]:
    """How many finish, agree and differ."""
    both = [o for o in outcomes if o.ours.code == o.theirs.code == 0]
    compared = [o for o in both if o.deviation is not None]
    agree = sum(o.deviation <= WITHIN for o in compared)  # type: ignore[operator]
    sources = len({o.source for o in outcomes})
    yield f"{len(outcomes)} static decks of {sources} sources; finished: {sum(o.ours.code == 0 for o in outcomes)} here, " \
          f"{sum(o.theirs.code == 0 for o in outcomes)} in CalculiX, {len(both)} in both"
    yield f"compared {len(compared)}: {agree} within {WITHIN:.0%}, {len(compared) - agree} differ"
    ours, theirs = (sum(o.__getattribute__(side).seconds for o in both) for side in ("ours", "theirs"))
    yield f"processor seconds where both finish: {ours:.1f} here, {theirs:.1f} in CalculiX"


def causes(outcomes: list[Outcome]) -> Iterator[str]:
    """What stops decks, ranked by decks: decks, sources, those that CalculiX finishes."""
    number, peers = Counter(o.cause for o in outcomes if o.cause), Counter(o.cause for o in outcomes if o.cause and o.theirs.code == 0)
    yield "| decks | sources | finished by CalculiX | what stops them |"
    yield "|---|---|---|---|"
    for cause, n in sorted(number.items(), key=lambda item: (-peers[item[0]], -item[1], item[0])):
        text = cause.replace("*", "\\*").replace("|", "\\|")
        yield f"| {n} | {len({o.source for o in outcomes if o.cause == cause})} | {peers[cause]} | {text} |"


def main() -> int:
    """Runs the decks and prints the tables."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("decks", type=Path)
    options.add_argument("--program", type=Path, default=Path("bin/amontons"))
    options.add_argument("--peer", default="ccx")
    options.add_argument("--seconds", type=float, default=60.0, help="processor time of one deck in one program")
    options.add_argument("--details", action="store_true", help="a line for each deck as well")
    given = options.parse_args()
    outcomes = []
    with tempfile.TemporaryDirectory() as work:
        for o in run_all(given.decks.resolve(), Path(work), given.program.resolve(), given.peer, given.seconds):
            outcomes.append(o)
            if given.details:
                print(o.ours.code, o.theirs.code, "-" if o.deviation is None else f"{o.deviation:.2e}",
                      f"{o.ours.seconds:.1f} {o.theirs.seconds:.1f}", o.deck, o.cause, sep=" | ", flush=True)
    print(*counts(outcomes), "", *causes(outcomes), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
