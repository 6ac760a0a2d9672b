"""Every verb in C, Fortran and Python: the same words in the same order have to say the same, to the last bit.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import subprocess
import threading
from pathlib import Path

import numpy as np
import pytest

import amontons
from amontons.binding import ABI, SIGNATURES, Options
from amontons.binding import library as calls
from verify.library.test_library import warm_deck

HERE = Path(__file__).resolve().parent
NODAL = ["NODES", "X", "U", "RF", "S", "E", "NT", "CPRESS", "CSHEAR", "COPEN", "CSLIP", "CNORMF", "CSHEARF", "CSTATUS", "CSCENARIO",
         "CONTACT FORCE", "INTERNAL FORCE", "APPLIED FORCE", "RESIDUAL"]  # fmt: skip
NUMBERS = ["TIME", "STEP TIME", "TIME LEFT", "STEP", "INCREMENTS", "ITERATIONS", "FRICTION", "FRICTION WORK", "EXTERNAL WORK", "STRAIN ENERGY"]
OF_SETS = [("P", "LOWER_TOP"), ("FACE CENTRES", "LOWER_TOP"), ("CF", "LOWER_TOP"), ("U", "UPPER_TOP"), ("POINT S", "UPPER"),
           ("ELEMENT S", "UPPER"), ("ELEMENT LABEL", "UPPER")]  # fmt: skip


@pytest.fixture(scope="module")
def deck(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small block with temperatures, pressed and dragged."""
    from verify.decks import make_decks

    path = tmp_path_factory.mktemp("api_calls") / "block.inp"
    path.write_text(make_decks.block_deck(2))
    path.write_text(warm_deck(path))
    return path


def mixed(array: np.ndarray) -> str:
    """One number of all bits of some numbers, in their order."""
    whole = 0
    for i, bits in enumerate(np.ascontiguousarray(array).view(np.uint64).ravel().tolist()):
        by = i % 63 + 1
        whole ^= (bits << by | bits >> (64 - by)) & (1 << 64) - 1
    return f"{whole:016X}"


class Transcript:
    """What api_calls.c and api_calls.f90 print."""

    def __init__(self) -> None:
        """Nothing yet."""
        self.lines: list[str] = []

    def __call__(self, job: amontons.Job, quantity: str, where: str = "") -> None:
        """A quantity."""
        values = job.get(quantity, where)
        rows, columns = values.shape if values.ndim == 2 else (len(values), 1)
        self.lines.append(f"{quantity} of '{where}': {rows} x {columns} {mixed(values)}")

    def all(self, job: amontons.Job) -> None:
        """All quantities."""
        for name in (*NODAL, *NUMBERS):
            self(job, name)
        for name, where in OF_SETS:
            self(job, name, where)

    def matrix(self, job: amontons.Job, name: str) -> None:
        """A matrix and the residual."""
        matrix, residual = job.matrix(name)
        self.lines.append(f"{name}: {matrix.shape[0]} x {matrix.shape[1]}, {len(matrix.value)} entries {mixed(matrix.first)} "
                          f"{mixed(matrix.column)} {mixed(matrix.value)}, residual {mixed(residual)}")  # fmt: skip


@pytest.fixture(scope="module")
def transcript(deck: Path) -> list[str]:
    """The output of the Python package."""
    transcript = Transcript()
    say = transcript.lines.append
    handle = ctypes.c_void_p()
    say(f"another interface: {calls().amontons_open(ctypes.byref(Options(abi=ABI + 1)), ctypes.byref(handle))}")
    calls().amontons_close(handle)
    slips = np.zeros((2, 5, 3))
    slips[0, 2:4, 0], slips[1, 2:4, 0] = 0.2, (0.1, -0.1)
    scenarios = amontons.classify(np.multiply.outer([[5, 5, 1, 1, 1], [2, 4, 4, 2, 1]], [1, 0, 0]), [[10, 10, 10, 10, -1], 5 * [10]], slips,
                                  np.multiply.outer([0.1, 0.1, -0.1, -0.3, 0.1], [1, 0, 0]), 0.3)  # fmt: skip
    say(f"scenarios: 0 {' '.join(map(str, [*scenarios.scenario, *scenarios.state]))} {mixed(scenarios.length)}")
    assert np.array_equal(scenarios.scenario, [1, 2, 3, 4, 0]), "one node in each"
    assert np.array_equal(scenarios.state, [2, 2, 2, 1, 4]), "IV is cut at zero slip: it sticks; the last one opens"
    assert np.allclose(scenarios.length, [2 / 3, 2, 2 / 3, 2 / 3, 1], rtol=1e-14), "the table of doc/theory/contact.md with mu N = 3"
    with pytest.raises(amontons.UsageError):
        amontons.classify([[[1, 0, 0]]], [[1], [1]], np.zeros((2, 1, 3)), [[0, 0, 0]], 0.3)
    say(f"no nodes: {calls().amontons_classify(1, *8 * [None])}")
    options = Options(abi=ABI, n_threads=1, text=deck.read_bytes())
    say(f"a communicator: {calls().amontons_open_on(ctypes.byref(options), 0, ctypes.byref(handle))}, {calls().amontons_message(handle).decode()}")
    calls().amontons_close(handle)
    heard: list[str] = []
    job = amontons.Job(text=deck.read_text(), log=heard.append)
    for kind in ("NODE SETS", "QUANTITIES"):
        say(f"{kind}: {' '.join(job.names(kind))}")
    job.advance()
    job.advance_to(0.35)
    transcript.all(job)
    job.set("U3", "UPPER_TOP", -0.0011)
    job.set("CF", "LOWER_TOP", [0.0, 0.02, 0.0])
    job.set("P", "LOWER_TOP", 0.5)
    job.set("NT", "UPPER_TOP", 35.0)
    job.set("FRICTION", "RUBBING", 0.25)
    job.try_step(0.2)
    transcript.all(job)
    job.rollback()
    transcript.all(job)
    job.begin(0.1)
    n = 1
    while (verdict := job.iterate()) is amontons.Verdict.GO_ON:
        n += 1
    say(f"verdict {int(verdict)} after {n}")
    job.commit()
    transcript.all(job)
    for name in ("TANGENT", "MAP", "STIFFNESS"):
        transcript.matrix(job, name)
    with pytest.raises(amontons.UsageError) as wrong:
        job.get("NONSENSE")
    say(f"an unknown name: {wrong.value.status}, {wrong.value}")
    job.advance_to(1.2)
    say(f"done: {int(job.is_done)}")
    job.run()
    job.finish()
    transcript.all(job)
    with pytest.raises(amontons.UsageError) as wrong:
        job.advance()
    say(f"after the end: {wrong.value.status}, {wrong.value}")
    job.close()
    say(f"heard: {sum(bool(line) for line in heard)}")
    found = ["", ""]

    def work(i: int) -> None:
        with amontons.Job(deck) as mine:
            mine.advance_to(0.4)
            found[i] = mixed(mine.get("U"))

    workers = [threading.Thread(target=work, args=(i,)) for i in (0, 1)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    transcript.lines += [f"thread {i + 1}: {one}" for i, one in enumerate(found)]
    return transcript.lines


def test_what_python_says_is_right(transcript: list[str]) -> None:
    """What is compared below is worth it: quantities move, a rollback brings all of them back but FRICTION, threads agree."""
    n = len(NODAL) + len(NUMBERS) + len(OF_SETS)
    before, tried, back, after = [transcript[i : i + n] for i, line in enumerate(transcript) if line.startswith("NODES of") and transcript[i + n :]][:4]
    names = [*NODAL, *NUMBERS, *OF_SETS]
    moved = {names[i] for i in range(n) if before[i] != tried[i]}
    assert {"U", "S", "NT", "CNORMF", "CSHEARF", "APPLIED FORCE", "TIME", "FRICTION", ("P", "LOWER_TOP"), ("CF", "LOWER_TOP")} <= moved
    assert [names[i] for i in range(n) if before[i] != back[i]] == ["FRICTION"]
    assert {"U", "TIME", "INCREMENTS"} <= {names[i] for i in range(n) if before[i] != after[i]}
    assert transcript[-1].split(": ")[1] == transcript[-2].split(": ")[1]
    assert int(transcript[-3].split(": ")[1]) > 10
    assert transcript[0].endswith(": 2")


def transcript_of(program: Path, deck: Path) -> list[str]:
    """The output of a program."""
    done = subprocess.run([str(program), str(deck)], capture_output=True, text=True, check=False, timeout=300,
                          env=os.environ | {"OMP_NUM_THREADS": "1"})  # fmt: skip
    assert done.returncode == 0, done.stdout[-500:] + done.stderr
    return done.stdout.splitlines()


@pytest.mark.skipif(not shutil.which("gcc"), reason="there is no C compiler")
def test_c(transcript: list[str], root: Path, library: Path, deck: Path, tmp_path: Path) -> None:
    """api_calls.c."""
    subprocess.run(["gcc", "-std=c11", "-Wall", "-Wextra", "-Werror", f"-I{root / 'src' / 'driver'}", str(HERE / "api_calls.c"), "-o", "api_calls", str(library),
                    f"-Wl,-rpath,{library.parent}", "-lpthread"], cwd=tmp_path, check=True)  # fmt: skip
    assert transcript_of(tmp_path / "api_calls", deck) == transcript


@pytest.mark.skipif(not shutil.which("gfortran"), reason="there is no Fortran compiler")
def test_fortran(transcript: list[str], root: Path, library: Path, deck: Path, tmp_path: Path) -> None:
    """api_calls.f90. Another interface cannot be compiled against, so there is no first line."""
    modules = Path(os.environ.get("AMONTONS_UNITS", "build/unit")).parent
    subprocess.run(["gfortran", "-std=f2018", "-fopenmp", f"-I{root / modules}", str(HERE / "api_calls.f90"), "-o", "api_calls", str(library),
                    f"-Wl,-rpath,{library.parent}"], cwd=tmp_path, check=True)  # fmt: skip
    assert transcript_of(tmp_path / "api_calls", deck) == transcript[1:]


@pytest.mark.skipif(not shutil.which("g++"), reason="there is no C++ compiler")
def test_header_in_cpp(root: Path, tmp_path: Path) -> None:
    """The header is good C++ too."""
    (tmp_path / "a.cpp").write_text('#include "amontons.h"\nint main() { amontons_options o = AMONTONS_OPTIONS; return o.abi != amontons_abi(); }\n')
    subprocess.run(["g++", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fsyntax-only", f"-I{root / 'src' / 'driver'}", "a.cpp"], cwd=tmp_path, check=True)


def test_every_function_of_the_header_is_called(root: Path) -> None:
    """The binding has each function of the header, and api_calls.c calls each; the manual names each."""
    functions = set(re.findall(r"\b(amontons_[a-z_]+)\(", (root / "src" / "driver" / "amontons.h").read_text()))
    assert functions == set(SIGNATURES)
    source = (HERE / "api_calls.c").read_text()
    assert {name for name in functions if f"{name}(" not in source} <= {"amontons_version"}
    page = (root / "doc" / "manual" / "library.md").read_text()
    assert {name for name in functions if f"`{name}`" not in page} == set()


def test_quantities_that_are_listed_are_there(deck: Path) -> None:
    """get knows each name that names("QUANTITIES") lists, and the manual does; STATEV are there with a UMAT alone."""
    page = (HERE.parent.parent / "doc" / "manual" / "library.md").read_text()
    with amontons.Job(deck) as job:
        job.advance()
        for name in job.names("QUANTITIES"):
            assert re.search(rf"(?<![A-Za-z]){name}(?![A-Za-z_])", page), name
            if name.endswith("SDV"):
                with pytest.raises(amontons.UsageError):
                    job.get(name)
            else:
                assert job.get(name, "LOWER_TOP" if name in ("P", "FACE CENTRES") else "").size > 0, name
