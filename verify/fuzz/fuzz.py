"""Fuzzer: decks, checkpoints and library calls that are wrong in many respects; nothing may crash, hang or end with a wrong exit code.

    python -m verify.fuzz.fuzz --decks 1000 --seed 1        mutated decks, with a table of how they ended
    python -m verify.fuzz.fuzz --checkpoints 200            damaged checkpoints
    python -m verify.fuzz.fuzz --restarts 200               damaged files of RESTART, WRITE
    python -m verify.fuzz.fuzz --calls 200                  sequences of library calls

The decks are those of input/, of the manual and its examples, of verify/decks, and of the folder AMONTONS_DECKS, up to 60 kB each. A deck is a
finding if the program dies by a signal, ends with an internal error (exit code 8), does not end and does not progress, or
ends with exit code 0 and a NaN or forces that do not balance. A finding is kept with its seed in --keep.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parent.parent.parent
LARGEST = 60_000  # [bytes] of a deck
TIME_LIMIT = 20.0  # [s] of processor time of one job
MEMORY = 3 << 30  # [bytes] of one job
MAX_FILE = 200 << 20  # [bytes] of one result file
ENDS = {0, 2, 3, 4, 5, 6, 7}  # exit codes that are not a finding
#: Fields whose sums of forces need not vanish: constraints and springs to the ground take some; r has no sum around an axis.
UNBALANCED = re.compile(r"^\*(EQUATION|MPC|SPRING|COUPLING|RIGIDBODY|TIE|PRE-TENSION|KINEMATIC|DISTRIBUTING|MODELCHANGE)|TYPE=[CSM]AX", re.M)
NUMBERS = ["0", "0.", "-1", "1", "1e-30", "1e30", "1e308", "-1e308", "1e999", "NaN", "-nan", "Infinity", "1.5d3", "2147483648", "99999999999",
           "-2147483649", "0x10", "1e", "1.2.3", "", " ", "+", "-", "1,2", "1e-320", "0.5", "3", "*", "ALL"]  # fmt: skip


def source_decks() -> dict[str, str]:
    """All decks at hand, by name."""
    decks: dict[str, str] = {}
    for path in [*sorted((ROOT / "input").glob("*.inp")), *sorted((ROOT / "doc" / "manual" / "examples").glob("*.inp"))]:
        decks[path.stem] = path.read_text()
    for page in sorted((ROOT / "doc").rglob("*.md")):
        for i, deck in enumerate(re.findall(r"```abaqus\n(.*?)```", page.read_text(), re.S)):
            decks[f"{page.stem}-{i}"] = deck
    from verify.decks import make_decks

    decks["block2"] = make_decks.block_deck(2)
    folder = os.environ.get("AMONTONS_DECKS")
    if folder:
        for path in sorted(Path(folder).rglob("*.inp")):
            decks[f"{path.parent.name}-{path.stem}"] = path.read_text(errors="replace")
    mesh = (ROOT / "input" / "three_cubes.mesh").read_text()
    decks = {name: text.replace("*INCLUDE, INPUT=three_cubes.mesh\n", mesh) for name, text in decks.items()}
    return {name: text for name, text in decks.items() if len(text) <= LARGEST}


class Mutator:
    """Changes decks, equally for the same seed."""

    def __init__(self, decks: dict[str, str]) -> None:
        """The decks, from which cards are also taken over into others."""
        self.decks = decks
        self.cards = sorted({line for deck in decks.values() for line in deck.splitlines()
                             if line.startswith("*") and not line.startswith("**")})  # fmt: skip
        self.moves = [self.number, self.number, self.number, self.drop, self.double, self.swap, self.card, self.byte, self.field_out,
                      self.cut, self.parameter, self.long_line, self.word, self.block, self.label]  # fmt: skip

    def mutate(self, name: str, chance: random.Random) -> str:
        """A deck with one to four changes."""
        lines = self.decks[name].splitlines()
        for _ in range(chance.choice([1, 1, 1, 2, 2, 3, 4])):
            if lines:
                chance.choice(self.moves)(lines, chance)
        return "\n".join(lines) + chance.choice(["\n", "\n", "\n", "", "\r\n"])

    def place(self, lines: list[str], chance: random.Random, is_card: bool) -> int:
        """A line that is a card, or one that is data; any line otherwise."""
        places = [i for i, line in enumerate(lines) if line.startswith("*") == is_card and line.strip() and not line.startswith("**")]
        return chance.choice(places) if places else chance.randrange(len(lines))

    def number(self, lines: list[str], chance: random.Random) -> None:
        """Another value in a field."""
        i = self.place(lines, chance, False)
        fields = lines[i].split(",")
        k = chance.randrange(len(fields))
        try:
            value = float(fields[k])
            choices = [f"{-value:g}", f"{value * 10.0 ** chance.randint(-12, 12):g}", f"{value + 1:g}", *NUMBERS]
            if chance.random() < 0.6:  # mild: the deck may still run
                choices = [f"{value * chance.uniform(0.5, 2.0):g}", f"{value * chance.uniform(0.9, 1.1):g}", f"{value + 1:g}", f"{-value:g}"]
        except (ValueError, OverflowError):
            choices = NUMBERS
        fields[k] = chance.choice(choices)
        lines[i] = ",".join(fields)

    def label(self, lines: list[str], chance: random.Random) -> None:
        """A first field that is another one's."""
        i, j = self.place(lines, chance, False), self.place(lines, chance, False)
        lines[i] = ",".join([lines[j].split(",")[0], *lines[i].split(",")[1:]])

    def field_out(self, lines: list[str], chance: random.Random) -> None:
        """A field less, or more."""
        i = self.place(lines, chance, False)
        fields = lines[i].split(",")
        if chance.random() < 0.5 and len(fields) > 1:
            del fields[chance.randrange(len(fields))]
        else:
            fields.insert(chance.randrange(len(fields) + 1), chance.choice(NUMBERS))
        lines[i] = ",".join(fields)

    def drop(self, lines: list[str], chance: random.Random) -> None:
        """A line less."""
        del lines[self.place(lines, chance, chance.random() < 0.6)]

    def double(self, lines: list[str], chance: random.Random) -> None:
        """A line twice."""
        i = chance.randrange(len(lines))
        lines.insert(chance.randrange(len(lines) + 1), lines[i])

    def swap(self, lines: list[str], chance: random.Random) -> None:
        """Two lines exchanged."""
        i, j = chance.randrange(len(lines)), chance.randrange(len(lines))
        lines[i], lines[j] = lines[j], lines[i]

    def block(self, lines: list[str], chance: random.Random) -> None:
        """A card with its data lines is taken out, or put elsewhere."""
        first = self.place(lines, chance, True)
        last = first + 1
        while last < len(lines) and not lines[last].startswith("*"):
            last += 1
        taken = lines[first:last]
        del lines[first:last]
        if chance.random() < 0.5:
            place = chance.randrange(len(lines) + 1)
            lines[place:place] = taken

    def card(self, lines: list[str], chance: random.Random) -> None:
        """A card of another deck."""
        lines.insert(chance.randrange(len(lines) + 1), chance.choice(self.cards))

    def parameter(self, lines: list[str], chance: random.Random) -> None:
        """A parameter less, more, or with another value."""
        i = self.place(lines, chance, True)
        words = lines[i].split(",")
        other = chance.choice(self.cards).split(",")
        what = chance.randrange(3)
        if what == 0 and len(words) > 1:
            del words[chance.randrange(1, len(words))]
        elif what == 1 and len(other) > 1:
            words.append(chance.choice(other[1:]))
        elif len(words) > 1:
            k = chance.randrange(1, len(words))
            words[k] = words[k].split("=")[0] + "=" + chance.choice([*NUMBERS, "X" * 300, chance.choice(other)])
        lines[i] = ",".join(words)

    def word(self, lines: list[str], chance: random.Random) -> None:
        """The keyword of another card over the data of this one."""
        i = self.place(lines, chance, True)
        lines[i] = ",".join([chance.choice(self.cards).split(",")[0], *lines[i].split(",")[1:]])

    def byte(self, lines: list[str], chance: random.Random) -> None:
        """One letter is any other."""
        i = chance.randrange(len(lines))
        if lines[i]:
            k = chance.randrange(len(lines[i]))
            lines[i] = lines[i][:k] + chr(chance.choice([chance.randrange(1, 256), chance.randrange(32, 127)])) + lines[i][k + 1 :]

    def cut(self, lines: list[str], chance: random.Random) -> None:
        """The end is missing."""
        if chance.random() < 0.3:
            del lines[chance.randrange(1, len(lines) + 1) :]
        elif lines:
            i = chance.randrange(len(lines))
            lines[i] = lines[i][: chance.randrange(len(lines[i]) + 1)]

    def long_line(self, lines: list[str], chance: random.Random) -> None:
        """A line of many thousand letters or fields."""
        i = chance.randrange(len(lines))
        if chance.random() < 0.2:
            lines[i] += chance.choice([",", "1,", "A", " ", "=", "*"]) * chance.choice([300, 5000, 40000])
        else:
            lines[i] = lines[i].replace(",", ",,", 1) if chance.random() < 0.5 else lines[i] + ","


@dataclass
class Tally:
    """How runs ended, and what was found."""

    ends: Counter[str] = field(default_factory=Counter)
    findings: list[str] = field(default_factory=list)

    def report(self) -> str:
        """A line for each."""
        lines = [f"{number:7d}  {end}" for end, number in sorted(self.ends.items())]
        return "\n".join([*lines, f"{len(self.findings)} findings", *self.findings])


def limit() -> None:
    """What one job may take."""
    resource.setrlimit(resource.RLIMIT_CPU, (int(TIME_LIMIT), int(TIME_LIMIT) + 2))
    if "ASAN_OPTIONS" not in os.environ:  # a program with sanitizers maps terabytes
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_FSIZE, (MAX_FILE, MAX_FILE))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def execute(program: Path, folder: Path, *words: str) -> subprocess.CompletedProcess[bytes]:
    """Runs the program in a folder under its limits."""
    return subprocess.run([str(program), *words], cwd=folder, capture_output=True, preexec_fn=limit, check=False,
                          timeout=30 * TIME_LIMIT, env=os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"})  # fmt: skip


def lie_of(folder: Path, deck: str) -> str:
    """What is wrong with the results of a job that ended with exit code 0; empty: nothing."""
    path = folder / "job.vtkhdf"
    if not path.exists():
        return ""
    with h5py.File(path, "r") as file:
        for group in ("VTKHDF/PointData", "AMONTONS/integration_points", "AMONTONS/history"):
            for name, table in file[group].items():
                if table.dtype.kind == "f" and not np.isfinite(table[()]).all():
                    return f"{group}/{name} has a NaN or an infinite number"
        history = file["AMONTONS/history"]
        is_good = history["is_converged"][:].ravel() == 1
        applied, reaction, contact = (history[name][:][is_good] for name in ("applied_force", "reaction_force", "contact_force"))
        slave = history["slave_force"][:][is_good]
        forces = [np.abs(file[f"VTKHDF/PointData/{name}"][()]).max(initial=0.0) for name in ("RF",)]
    scale = max(np.abs(applied).max(initial=0.0), np.abs(reaction).max(initial=0.0), np.abs(slave).max(initial=0.0), *forces)
    if np.abs(contact).max(initial=0.0) > 1e-5 * scale:
        return f"contact forces do not balance: {np.abs(contact).max():g} of {scale:g}"
    squeezed = deck.upper().replace(" ", "")
    if UNBALANCED.search(squeezed):
        return ""
    rest = np.abs(applied + reaction).max(initial=0.0)
    if rest > 0.006 * scale:  # a residual of 0.5 % is accepted by CONTROLS and by both programs
        return f"forces do not balance: {rest:g} of {scale:g}"
    return ""


def fuzz_decks(program: Path, n: int, seed: int, keep: Path | None, seconds: float) -> Tally:
    """Runs n mutated decks, or as many as fit into the time."""
    decks = source_decks()
    mutator, tally, names = Mutator(decks), Tally(), sorted(decks)
    scratch = Path(tempfile.mkdtemp(prefix="fuzz-", dir="/dev/shm" if Path("/dev/shm").is_dir() else None))
    end = time.monotonic() + seconds
    try:
        for i in range(n):
            if time.monotonic() > end:
                break
            chance = random.Random(seed * 1_000_003 + i)
            name = chance.choice(names)
            deck = mutator.mutate(name, chance)
            folder = scratch / "job"
            folder.mkdir()
            (folder / "job.inp").write_text(deck, errors="surrogateescape")
            what = judge_deck(program, folder, deck, tally)
            if what:
                tally.findings.append(f"seed {seed} deck {i} ({name}): {what}")
                print(tally.findings[-1], flush=True)
                if keep:
                    keep.mkdir(parents=True, exist_ok=True)
                    shutil.copy(folder / "job.inp", keep / f"{seed}-{i}-{name}.inp")
            shutil.rmtree(folder)
            if (i + 1) % 1000 == 0:
                print(f"{i + 1} decks: {dict(tally.ends)}, {len(tally.findings)} findings", flush=True)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    return tally


def judge_deck(program: Path, folder: Path, deck: str, tally: Tally) -> str:
    """Runs one deck; what is wrong, or nothing."""
    words = ["--threads", "1", "--progress", "none", "--no-checkpoint", "job"]
    try:
        done = execute(program, folder, *words)
    except subprocess.TimeoutExpired:
        tally.ends["does not end"] += 1
        return "does not end, and takes no processor time"
    tail = done.stdout.decode(errors="replace").strip().splitlines()[-1:]
    if done.returncode < 0 or done.returncode > 128:
        number = -done.returncode if done.returncode < 0 else done.returncode - 128
        if number in (9, 24):  # processor time is over
            sta = folder / "job.sta"
            gets_on = sta.exists() and len(sta.read_bytes().splitlines()) > 10
            tally.ends["long, gets on" if gets_on else "long"] += 1
            return "" if gets_on else "takes more time than it should"
        tally.ends[f"signal {number}"] += 1
        return f"signal {number}: {tail} {done.stderr[-300:]!r}"
    tally.ends[f"exit {done.returncode}"] += 1
    if done.returncode not in ENDS:
        return f"exit code {done.returncode}: {tail} {done.stderr[-300:]!r}"
    if done.returncode == 0:
        return lie_of(folder, deck)
    if not tail or "*ERROR" not in done.stdout.decode(errors="replace"):
        return f"exit code {done.returncode} without a line that starts with *ERROR"
    return ""


def damaged(good: bytes, chance: random.Random) -> bytes:
    """A file with some bits, numbers or pieces changed, taken out or put in."""
    bad = bytearray(good)
    for _ in range(chance.choice([1, 1, 3, 50])):
        where = chance.randrange(len(bad))
        what = chance.randrange(4)
        if what == 0:
            bad[where] ^= 1 << chance.randrange(8)
        elif what == 1:
            bad[where : where + 8] = chance.randbytes(8)
        elif what == 2:
            del bad[where : where + chance.randrange(1, 64)]
        else:
            bad[where:where] = chance.randbytes(chance.randrange(1, 64))
    return bytes(bad)


def fuzz_checkpoints(program: Path, n: int, seed: int) -> Tally:
    """Damages the checkpoint of a job that was stopped: reported with exit code 7, or unharmed."""
    tally = Tally()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        deck = source_decks()["block2"].replace("*STATIC\n", "*RESTART, WRITE\n*STATIC\n", 1)
        (folder / "job.inp").write_text(deck)
        done = execute(program, folder, "--threads", "1", "job")
        assert done.returncode == 0, done.stdout
        good = (folder / "job.restart").read_bytes()
        for i in range(n):
            bad = damaged(good, random.Random(seed * 1_000_003 + i))
            (folder / "job.restart").write_bytes(bad)
            done = execute(program, folder, "--threads", "1", "--resume", "job")
            tally.ends[f"exit {done.returncode}"] += 1
            if done.returncode != 7 and bad != good:
                tally.findings.append(f"seed {seed} checkpoint {i}: exit code {done.returncode}")
    return tally


def fuzz_restart_files(program: Path, n: int, seed: int) -> Tally:
    """Damages the file of RESTART, WRITE, from which another job reads one state: reported with exit code 7, or the damage is elsewhere in
    the file and the results are those of the file that is whole."""
    tally = Tally()

    def last_u(path: Path) -> bytes:
        with h5py.File(path, "r") as file:
            return bytes(file["VTKHDF/PointData/U"][()].tobytes())

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        first, second = source_decks()["block2"].rsplit("*STEP", 1)
        (folder / "old.inp").write_text(first.replace("*STATIC\n", "*RESTART, WRITE, FREQUENCY=4\n*STATIC\n"))
        (folder / "new.inp").write_text("*RESTART, READ, STEP=1, INC=8\n*STEP" + second)
        for words in (["old"], ["new", "oldjob=old"]):
            done = execute(program, folder, "--threads", "1", *words)
            assert done.returncode == 0, done.stdout
        good, expected = (folder / "old.res").read_bytes(), last_u(folder / "new.vtkhdf")
        for i in range(n):
            bad = damaged(good, random.Random(seed * 1_000_003 + i))
            (folder / "old.res").write_bytes(bad)
            (folder / "new.vtkhdf").unlink(missing_ok=True)
            done = execute(program, folder, "--threads", "1", "--progress", "none", "new", "oldjob=old")
            tally.ends[f"exit {done.returncode}"] += 1
            if done.returncode == 7 or (done.returncode == 0 and last_u(folder / "new.vtkhdf") == expected):
                continue
            tally.findings.append(f"seed {seed} restart file {i}: exit code {done.returncode}")
    return tally


CALLS = '''
import ctypes, random, sys
import numpy as np
import amontons
from amontons.binding import library
calls = library()
deck = open(sys.argv[1]).read()
names = ["U", "U1", "U2", "U3", "RF", "S", "E", "CPRESS", "CF", "CF1", "CF3", "P", "FRICTION", "NT", "TIME", "STEP", "NODES", "X", "SDV1", "", "?",
         "x" * 500, "TEMPERATURE", "RESIDUAL", "CONTACT FORCE", "CSTATUS", "FACE CENTRES", "POINT S", "POINT E", "POINT SDV", "POINT LABEL",
         "ELEMENT S", "ELEMENT PEEQ", "ELEMENT VOLUME", "ELEMENT", "POINT", "ELEMENT LABEL", "STRAIN ENERGY", "IMBALANCE"]
sets = ["", "UPPER_TOP", "UPPER_TOP", "UPPER_BOTTOM", "LOWER_TOP", "LOWER_BOTTOM", "UPPER", "LOWER", "UPPER_E1", "RUBBING", "1", "2", "0",
        "-5", "99999999999", "no", "y" * 300, "ALL"]


def raw(job, chance):
    """Verbs of C as a careless program calls them: no place for an answer, a buffer that is too small, copies before there is a matrix."""
    n = [chance.choice([None, ctypes.byref(ctypes.c_int64())]) for _ in range(3)]
    buffer = (ctypes.c_double * 8)()
    what = chance.randrange(8)
    if what == 0:
        calls.amontons_iterate(job, None)
    elif what == 1:
        calls.amontons_get(job, chance.choice(names).encode(), chance.choice(sets).encode(), buffer, chance.choice([0, 8, -1]), n[0], n[1])
    elif what == 2:
        calls.amontons_set(job, chance.choice([None, b"U3", b"FRICTION"]), chance.choice([None, b"UPPER_TOP"]), buffer, chance.choice([-1, 0, 1, 8]))
    elif what == 3:
        calls.amontons_matrix(job, chance.choice([None, b"TANGENT", b"MAP", b"no"]), *n)
    elif what == 4:
        calls.amontons_matrix_copy(job, None, None, None)
    elif what == 5:
        calls.amontons_residual_copy(job, None)
    elif what == 6:
        calls.amontons_names(job, chance.choice([None, b"NODE SETS", b"no"]), chance.choice([None, ctypes.create_string_buffer(9)]),
                             chance.choice([0, 9]), n[0])
    else:
        assert calls.amontons_message(job) is not None


def sequence(chance):
    """Forty verbs in any order."""
    job = None
    for _ in range(40):
        try:
            what = chance.randrange(18)
            if job is None or what == 0:
                if job is not None:
                    job.close()
                job = None
                job = amontons.Job(text=deck if chance.random() < 0.95 else deck[: chance.randrange(len(deck))])
            elif what == 1:
                job.advance()
            elif what == 2:
                job.try_step(chance.choice([0.1, 0.1, 0.3, 0.5, 0.0, -1.0, 1e300, float("nan"), float("inf"), 1e-30]))
            elif what == 3:
                job.begin(chance.choice([0.1, 0.1, 0.0, float("nan"), 2.0]))
            elif what in (4, 5):
                job.iterate()
            elif what == 6:
                job.commit()
            elif what == 7:
                job.rollback()
            elif what in (8, 9):
                values = np.asarray(job.get(chance.choice(names), chance.choice(sets)))
                assert np.isfinite(values).all()
            elif what in (10, 11):
                size = chance.choice([0, 1, 1, 1, 3, 7, 9, 27])
                value = chance.choice([0.0, 1.0, -1e-3, -1e-3, 2e-3, 1e308, -5.0, float("nan"), float("inf"), 0.3])
                job.set(chance.choice(names[:18]), chance.choice(sets), [value] * size if size else [])
            elif what == 12:
                job.matrix(chance.choice(["TANGENT", "MAP", "STIFFNESS", "", "no"]))
            elif what == 13:
                job.advance_to(chance.choice([0.5, 1.0, -1.0, float("nan"), 0.2]))
            elif what == 14 and chance.random() < 0.2:
                job.finish()
            elif what in (15, 16):
                raw(job._job, chance)
            elif what == 17:
                job.names(chance.choice(["NODE SETS", "ELEMENT SETS", "SURFACES", "INTERACTIONS", "MATERIALS", "QUANTITIES", "no", ""]))
            else:
                job.is_done, job.time
        except amontons.InternalError as error:
            print("internal:", error)
            sys.exit(1)
        except amontons.AmontonsError:
            pass
    if job is not None:
        job.close()


seed, first, last = map(int, sys.argv[2:5])
for i in range(first, last):
    with open(sys.argv[5], "w") as file:
        file.write(str(i))
    sequence(random.Random(seed * 1_000_003 + i))
'''

AT_ONCE = 25  # sequences of calls in one process


def fuzz_calls(n: int, seed: int) -> Tally:
    """Sequences of verbs with wrong names, sizes, numbers and order: a status, never a crash."""
    tally = Tally()
    with tempfile.TemporaryDirectory() as name:
        deck, script, at = (Path(name) / file for file in ("block.inp", "calls.py", "at"))
        deck.write_text(source_decks()["block2"])
        script.write_text(CALLS)
        first, environment = 0, os.environ | {"PYTHONPATH": str(ROOT / "python")}
        while first < n:
            last = min(n, first + AT_ONCE)
            words = [str(script), str(deck), str(seed), str(first), str(last), str(at)]
            try:
                done = subprocess.run([sys.executable, *words], env=environment, capture_output=True, text=True, check=False, timeout=60 * AT_ONCE)
                end, said = f"exit {done.returncode}", done.stdout[-300:] + done.stderr[-3000:]
            except subprocess.TimeoutExpired:
                end, said = "does not end", ""
            if end != "exit 0":
                last = int(at.read_text()) + 1
                tally.findings.append(f"seed {seed} calls {last - 1}: {end} {said}")
                print(tally.findings[-1], flush=True)
                tally.ends[end] += 1
            tally.ends["exit 0"] += last - first - (end != "exit 0")
            first = last
            print(f"{first} of {n} sequences of 40 calls, {len(tally.findings)} findings", flush=True)
    return tally


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    parser.add_argument("--decks", type=int, default=0)
    parser.add_argument("--checkpoints", type=int, default=0)
    parser.add_argument("--restarts", type=int, default=0)
    parser.add_argument("--calls", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=1e9, help="no new deck after this time")
    parser.add_argument("--keep", type=Path, help="folder for the decks that are findings")
    words = parser.parse_args()
    tallies = []
    if words.decks:
        tallies.append(fuzz_decks(words.program.resolve(), words.decks, words.seed, words.keep, words.seconds))
    if words.checkpoints:
        tallies.append(fuzz_checkpoints(words.program.resolve(), words.checkpoints, words.seed))
    if words.restarts:
        tallies.append(fuzz_restart_files(words.program.resolve(), words.restarts, words.seed))
    if words.calls:
        tallies.append(fuzz_calls(words.calls, words.seed))
    for tally in tallies:
        print(tally.report())
    return 1 if any(tally.findings for tally in tallies) else 0


if __name__ == "__main__":
    sys.exit(main())
