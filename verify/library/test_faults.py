"""Faults: each ends with its exit code and a message, never with a wrong success. The table is doc/developer/reliability.md.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import ctypes
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import h5py
import pytest

from verify.conftest import Run
from verify.decks import make_decks, solids
from verify.library.common import bits, block, cubes, frames, same_results  # noqa: F401
from verify.readers.sta_cvg_files import read_sta

DECK, SETUP, NOT_CONVERGED, SOLVER, IO = 3, 4, 5, 6, 7


def fails(done: subprocess.CompletedProcess[str], code: int, sentence: str) -> None:
    """Exit code, and a sentence somewhere in the output, whose last line starts with *ERROR."""
    assert done.returncode == code, f"exit code {done.returncode}, not {code}\n{done.stdout}{done.stderr}"
    assert re.search(sentence, done.stdout), done.stdout
    assert done.stdout.splitlines()[-1].startswith("*ERROR"), done.stdout


def cube_deck(cubes: Path, folder: Path, *changes: tuple[str, str]) -> Path:  # noqa: F811
    """The three cubes in one file, with some texts replaced."""
    mesh = (cubes.parent / "three_cubes.mesh").read_text()
    text = cubes.read_text().replace("*INCLUDE, INPUT=three_cubes.mesh\n", mesh)
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    deck = folder / "job.inp"
    deck.write_text(text)
    return deck


def test_missing_include(run: Run, cubes: Path, tmp_path: Path) -> None:  # noqa: F811
    """A missing include is reported with its line."""
    (tmp_path / "job.inp").write_text(cubes.read_text())
    done = run(["job"], cwd=tmp_path)
    assert done.returncode in (DECK, IO), done.stdout
    assert "three_cubes.mesh" in done.stdout
    assert not (tmp_path / "job.vtkhdf").exists()


@pytest.mark.slow
def test_a_million_lines(run: Run, tmp_path: Path) -> None:
    """A deck of a million lines is read, and a mistake in its last lines is reported with its line."""
    n = 1_000_000
    cube = "0., 0.;1., 0.;1., 1.;0., 1."
    corners = [f"{4 * k + i}, {place}, {k}." for k in range(2) for i, place in enumerate(cube.split(";"), 1)]
    nodes = [f"{i}, {i % 100}., {i // 100 % 100}., {i // 10000}." for i in range(9, n + 1)]
    end = ["*ELEMENT, TYPE=C3D8, ELSET=BODY", "1, 1, 2, 3, 4, 5, 6, 7, 8", "*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., 0.3",
           "*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL", "*BOUNDARY", "1, 1, 3", "2, 2, 3", "4, 1, 3", "*STEP", "*STATIC",
           "*CLOAD", "7, 3, 1.", "*END STEP", ""]  # fmt: skip
    (tmp_path / "job.inp").write_text("\n".join(["*NODE", *corners, *nodes, *end]))
    done = run(["--check", "job"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    (tmp_path / "job.inp").write_text("\n".join(["*NODE", *corners, *nodes, *end]).replace("7, 3, 1.", "seven, 3, 1."))
    fails(run(["job"], cwd=tmp_path), DECK, rf"job\.inp:{n + 15}: .*seven")


def test_an_included_file_that_changes(program: Path, run: Run, cubes: Path, tmp_path: Path) -> None:  # noqa: F811
    """A job that was stopped does not resume if a file that its deck includes has changed."""
    (tmp_path / "job.inp").write_text(cubes.read_text().replace("*STATIC\n", "*RESTART, WRITE\n*STATIC\n", 1))
    mesh = (cubes.parent / "three_cubes.mesh").read_text()
    (tmp_path / "three_cubes.mesh").write_text(mesh)
    assert run(["job"], cwd=tmp_path).returncode == 0
    (tmp_path / "three_cubes.mesh").write_text(mesh + "** another one\n")
    fails(run(["--resume", "job"], cwd=tmp_path), IO, "it has been changed")
    (tmp_path / "three_cubes.mesh").write_text(mesh)
    assert run(["--resume", "job"], cwd=tmp_path).returncode == 0


@pytest.mark.parametrize("word", ["NaN", "Infinity", "1e999", "-inf", "0x1p3"])
def test_no_number_in_a_deck(run: Run, cubes: Path, tmp_path: Path, word: str) -> None:  # noqa: F811
    """What is no finite number is an error of the deck."""
    cube_deck(cubes, tmp_path, ("-0.001", word))
    fails(run(["job"], cwd=tmp_path), DECK, r"job\.inp:\d+")


def test_element_without_volume(run: Run, cubes: Path, tmp_path: Path) -> None:  # noqa: F811
    """An element squashed flat is found before the first step."""
    deck = cube_deck(cubes, tmp_path)
    lines = deck.read_text().splitlines()
    start = lines.index(next(line for line in lines if line.upper().startswith("*NODE")))
    for i in range(start + 1, start + 21):
        label, x, y, _ = lines[i].split(",")
        lines[i] = f"{label},{x},{y}, 0."
    deck.write_text("\n".join(lines) + "\n")
    fails(run(["job"], cwd=tmp_path), SETUP, "volume|inverted|inside out")


def test_singular_matrix(run: Run, cubes: Path, tmp_path: Path) -> None:  # noqa: F811
    """An unsupported body is reported before the first step or by the solver; it is never solved."""
    cube_deck(cubes, tmp_path, ("FLOOR, 1, 3\n", "FLOOR, 3, 3\n"), ("*FRICTION\n0.3\n", ""))
    done = run(["job"], cwd=tmp_path)
    assert done.returncode in (SETUP, NOT_CONVERGED, SOLVER), done.stdout
    assert done.stdout.splitlines()[-1].startswith("*ERROR")


def as_others() -> None:
    """Root may write everywhere, unless it gives up CAP_DAC_OVERRIDE (1) by prctl(PR_CAPBSET_DROP = 24) before the program starts."""
    if os.geteuid() == 0:
        assert ctypes.CDLL(None, use_errno=True).prctl(24, 1, 0, 0, 0) == 0, os.strerror(ctypes.get_errno())


@pytest.mark.skipif(os.geteuid() == 0 and sys.platform != "linux", reason="root may write everywhere")
def test_unwritable_folder(program: Path, cubes: Path, tmp_path: Path) -> None:  # noqa: F811
    """A folder that may not be written."""
    tmp_path.chmod(0o500)
    done = subprocess.run([str(program), "--outdir", str(tmp_path), str(cubes)], capture_output=True, text=True, preexec_fn=as_others)
    fails(done, IO, "cannot create it")


def test_folder_that_takes_no_files(run: Run, cubes: Path) -> None:  # noqa: F811
    """The same for everyone, root included: /proc takes no files."""
    fails(run(["--outdir", "/proc", cubes]), IO, "cannot create it")


def test_result_file_is_a_folder(run: Run, cubes: Path, tmp_path: Path) -> None:  # noqa: F811
    """A folder stands where the result file should."""
    for name in ("three_cubes.vtkhdf", "three_cubes.restart"):
        folder = tmp_path / name
        folder.mkdir()
        fails(run(["--outdir", tmp_path, cubes]), IO, "annot")
        folder.rmdir()


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 3 megabytes, where mounting is permitted."""
    disk = tmp_path / "disk"
    disk.mkdir()
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=3m", "none", str(disk)], capture_output=True, text=True)
    if done.returncode:
        pytest.skip(f"mounting a small disk is not permitted here: {done.stderr.strip()}")
    yield disk
    subprocess.run(["umount", str(disk)], check=True)


@pytest.mark.slow
def test_full_disk(run: Run, block: Path, small_disk: Path, tmp_path: Path) -> None:  # noqa: F811
    """The job ends with exit code 7; with free space again it resumes bitwise."""
    whole = tmp_path / "whole"
    whole.mkdir()
    assert run(["--outdir", whole, block]).returncode == 0
    fails(run(["--outdir", small_disk, block]), IO, "No space left on device|disk full")
    assert (small_disk / "block.restart").exists()
    target = tmp_path / "target"
    shutil.copytree(small_disk, target)
    assert run(["--resume", "--outdir", target, block]).returncode == 0
    assert same_results(whole / "block.vtkhdf", target / "block.vtkhdf") == []


@pytest.mark.parametrize("kilobytes", [0, 20, 200, 1000])
def test_no_space_for_any_file(program: Path, block: Path, tmp_path: Path, kilobytes: int) -> None:  # noqa: F811
    """Files that may not grow beyond a limit: exit code 7, whichever of them meets it first."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1024 * kilobytes, 1024 * kilobytes))

    done = subprocess.run([str(program), "--outdir", str(tmp_path), str(block)], capture_output=True, text=True,
                          preexec_fn=limit, env=os.environ | {"OMP_NUM_THREADS": "1"})  # fmt: skip
    assert done.returncode == IO, f"exit code {done.returncode}\n{done.stdout}{done.stderr}"
    assert done.stdout.splitlines()[-1].startswith("*ERROR")


@pytest.mark.slow
@pytest.mark.parametrize("megabytes", [200, 240, 280, 320, 400])
def test_no_memory(program: Path, root: Path, tmp_path: Path, megabytes: int) -> None:
    """With too little memory the job ends with exit code 6 (8 if a library ends it by itself), never as if done; or it is done."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (1024 * 1024 * megabytes, 1024 * 1024 * megabytes))

    done = subprocess.run([str(program), "--outdir", str(tmp_path), str(root / "input" / "shear_block.inp")],
                          capture_output=True, text=True, preexec_fn=limit,
                          env=os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"})  # fmt: skip
    if done.returncode == 0:
        assert len(read_sta(tmp_path / "shear_block.sta")) == 20
        return
    assert done.returncode in (SOLVER, 8), f"exit code {done.returncode}\n{done.stdout[-600:]}{done.stderr[-600:]}"
    assert done.stdout.splitlines()[-1].startswith("*ERROR"), done.stdout[-600:]


needs_preload = pytest.mark.skipif(not shutil.which("gcc") or not sys.platform.startswith("linux"),
                                   reason="there is no C compiler, or no LD_PRELOAD")  # fmt: skip


def preloading(folder: Path, source: str) -> dict[str, str]:
    """The environment in which procedures in C take the place of those of the system."""
    (folder / "preload.c").write_text(source)
    subprocess.run(["gcc", "-O1", "-shared", "-fPIC", "preload.c", "-o", "preload.so"], cwd=folder, check=True)
    return os.environ | {"LD_PRELOAD": f"{os.environ.get('LD_PRELOAD', '')} {folder / 'preload.so'}".strip()}


FAILING_MALLOC = """
#include <errno.h>
#include <stdlib.h>
#include <string.h>
extern char **environ;
extern void *__libc_malloc(size_t);
void *malloc(size_t bytes)
{
  static long n_large, failing = -1;
  if (failing < 0 && environ)
    for (char **e = (failing = 0, environ); *e; e++) if (strncmp(*e, "FAILING=", 8) == 0) failing = atol(*e + 8);
  if (bytes >= 2000 && failing > 0 && __atomic_add_fetch(&n_large, 1, __ATOMIC_RELAXED) == failing) {
    errno = ENOMEM;
    return NULL;
  }
  return __libc_malloc(bytes);
}
"""


@needs_preload
def test_each_request_for_memory(program: Path, block: Path, tmp_path: Path) -> None:  # noqa: F811
    """One request for memory that fails, also that of an array temporary, which gfortran does not check: exit code 6 to 8, or done."""
    environment = preloading(tmp_path, FAILING_MALLOC) | {"OMP_NUM_THREADS": "1"}
    codes = []
    for failing in range(50, 1000, 25):
        done = subprocess.run([str(program), "--outdir", str(tmp_path), str(block)], capture_output=True, text=True,
                              env=environment | {"FAILING": str(failing)})  # fmt: skip
        assert done.returncode in (0, SOLVER, IO, 8), f"request {failing}: {done.returncode}\n{done.stdout}{done.stderr[:900]}"
        assert done.returncode == 0 or "*ERROR" in done.stdout, f"request {failing}\n{done.stdout}"
        codes.append(done.returncode)
    assert codes.count(SOLVER) >= 3, codes


LIMITED = """
import resource, sys
import amontons
amontons.version()
size = next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmSize")) * 1024
limit = size + int(sys.argv[2]) * 1024 * 1024
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
try:
    with amontons.Job(sys.argv[1]) as job:
        job.advance()
    print("enough")
except amontons.SolverError as error:
    print(error)
"""


@pytest.mark.slow
@pytest.mark.parametrize("megabytes", [20, 150, 162, 166, 175, 200, 204])
def test_no_memory_in_the_library(root: Path, tmp_path: Path, megabytes: int) -> None:
    """With so many megabytes more than the process has, a call gives a status, and the caller's process continues."""
    done = subprocess.run([sys.executable, "-c", LIMITED, str(root / "input" / "shear_block.inp"), str(megabytes)], capture_output=True, text=True,
                          env=os.environ | {"PYTHONPATH": str(root / "python"), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
                          cwd=tmp_path)  # fmt: skip
    assert done.returncode == 0, done.stderr[-600:]
    assert re.search("ot enough memory|^enough", done.stdout), done.stdout


def test_screen_that_is_gone(program: Path, cubes: Path, tmp_path: Path) -> None:  # noqa: F811
    """A screen that takes no lines does not end the job."""
    with Path("/dev/full").open("w") as full:
        done = subprocess.run([str(program), "--outdir", str(tmp_path), str(cubes)], stdout=full, stderr=subprocess.PIPE)
    assert done.returncode == 0
    assert len(read_sta(tmp_path / "three_cubes.sta")) == 20


def test_long_names(run: Run, cubes: Path, tmp_path: Path) -> None:  # noqa: F811
    """Names of 80 characters."""
    cube_deck(cubes, tmp_path, ("CUBE_SOLE", "S" * 80), ("TABLE_TOP", "T" * 80), ("RUBBING", "R" * 80))
    assert run(["job"], cwd=tmp_path).returncode == 0


def one_cube() -> bytes:
    """A deck of one cube, as bytes."""
    corners = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    return "\n".join([
        "*NODE", *(f"{i}, {x}., {y}., {z}." for i, (x, y, z) in enumerate(corners, 1)), "*ELEMENT, TYPE=C3D8, ELSET=BODY", "1, 1, 2, 3, 4, 5, 6, 7, 8",
        "*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., 0.3", "*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL", "*BOUNDARY", "1, 1, 3", "2, 2, 3",
        "4, 1", "4, 3", "3, 3", "*STEP", "*STATIC", "0.5, 1.", "*CLOAD", "5, 3, 10.", "7, 3, 30.", "*END STEP", ""]).encode()  # fmt: skip


WRITING_STYLES: dict[str, Callable[[bytes], bytes]] = {
    "a mark of UTF-8": lambda text: b"\xef\xbb\xbf" + text,
    "UTF-16": lambda text: text.decode().encode("utf-16"),
    "UTF-16, the other end first": lambda text: b"\xfe\xff" + text.decode().encode("utf-16-be"),
    "lines as on Windows": lambda text: text.replace(b"\n", b"\r\n"),
    "lines as on an old Mac": lambda text: text.replace(b"\n", b"\r"),
    "no end of the last line": lambda text: text.rstrip(b"\n"),
    "tabs": lambda text: text.replace(b", ", b",\t").replace(b"*", b"\t*"),
    "a line of 100 000 characters": lambda text: text.replace(b"*MATERIAL", b"** " + 100_000 * b"x" + b"\n*MATERIAL"),
    "many blanks": lambda text: text.replace(b"*ELASTIC", b"*ELASTIC" + 100_000 * b" "),
}  # fmt: skip


@pytest.mark.parametrize("style", WRITING_STYLES)
def test_decks_as_others_write_them(run: Run, tmp_path: Path, style: str) -> None:
    """The same numbers, whatever editor or system wrote the deck; the file that it includes too."""
    (tmp_path / "plain.inp").write_bytes(one_cube())
    text = WRITING_STYLES[style](one_cube())
    (tmp_path / "job.inp").write_bytes(text)
    (tmp_path / "outer.inp").write_text("*INCLUDE, INPUT=job.inp\n")
    for job in ("plain", "job", "outer"):
        done = run([job], cwd=tmp_path)
        assert done.returncode == 0, done.stdout
    expected = frames(tmp_path / "plain.vtkhdf")[-1]
    for job in ("job", "outer"):
        found = frames(tmp_path / f"{job}.vtkhdf")[-1]
        assert all(bits(found[name]) == bits(expected[name]) for name in expected)


def test_a_deck_through_a_pipe(program: Path, tmp_path: Path) -> None:
    """A deck that another program writes into a pipe."""
    os.mkfifo(tmp_path / "job.inp")
    job = subprocess.Popen([str(program), "job"], cwd=tmp_path, stdout=subprocess.PIPE, text=True)
    (tmp_path / "job.inp").write_bytes(one_cube())
    output, _ = job.communicate(timeout=60)
    assert job.returncode == 0, output


def test_what_is_no_deck(run: Run, program: Path, tmp_path: Path) -> None:
    """A folder, a link to itself, a program, bytes of no meaning, a NUL in a number, a file that includes itself through a link: each is reported,
    and nothing that comes from the file steers the terminal."""
    (tmp_path / "folder.inp").mkdir()
    fails(run(["folder"], cwd=tmp_path), IO, "cannot be read")
    (tmp_path / "loop.inp").symlink_to("loop.inp")
    fails(run(["loop"], cwd=tmp_path), IO, "There is no file")
    (tmp_path / "program.inp").write_bytes(program.read_bytes()[:300_000])
    (tmp_path / "bytes.inp").write_bytes(bytes(random.Random(1).randrange(256) for _ in range(100_000)))
    (tmp_path / "nul.inp").write_bytes(one_cube().replace(b"210000.", b"21\x0000."))
    (tmp_path / "self.inp").write_bytes(b"*INCLUDE, INPUT=link.inp\n" + one_cube())
    (tmp_path / "link.inp").symlink_to("self.inp")
    for name in ("program", "bytes", "nul", "self"):
        done = subprocess.run([str(program), name], cwd=tmp_path, capture_output=True)
        assert done.returncode == DECK, name
        assert done.stdout.splitlines()[-1].startswith(b"*ERROR"), name
        assert not re.search(rb"[\x00-\x08\x0b-\x1f\x7f]", done.stdout), name


@pytest.mark.parametrize("before", ["env LC_ALL=de_DE.UTF-8 LANG=de_DE.UTF-8", "env -i", "env -u HOME TMPDIR=/nowhere", "env OMP_NUM_THREADS=some",
                                    "ulimit -s 512;", "exec <&- >&- 2>&-;"])  # fmt: skip
def test_strange_surroundings(program: Path, tmp_path: Path, before: str) -> None:
    """A comma for the point, no environment at all, no home, no folder for temporary files, threads that are no number, a stack of half a
    megabyte, no streams: the job does not mind."""
    (tmp_path / "job.inp").write_bytes(one_cube())
    done = subprocess.run(["/bin/sh", "-c", f"{before} {program} job"], cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    assert len(read_sta(tmp_path / "job.sta")) == 2


@pytest.mark.parametrize("kind", ["C3D8", "C3D8I", "C3D8R", "C3D10"])
def test_small_stack(program: Path, tmp_path: Path, kind: str) -> None:
    """Half a megabyte for each of two threads, as threads of some systems have: plastic elements in batches and one by one, with inner modes."""
    body = solids.as_kind(make_decks.block(range(6), range(6), range(4), "BLOCK"), kind)
    (tmp_path / "job.inp").write_text(
        f"{body.cards()}{solids.node_set('LOW', body.where(2, 0.0))}{solids.node_set('TOP', body.where(2, 3.0))}*MATERIAL, NAME=M\n*ELASTIC\n2e5, 0.3\n"
        "*PLASTIC\n200., 0.\n400., 0.5\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n*BOUNDARY\nLOW, 1, 3\n*STEP, NLGEOM\n*STATIC\n0.5, 1.\n*BOUNDARY\nTOP, 3, 3, 0.05\n*END STEP\n"
    )
    command = f"ulimit -s 512; OMP_STACKSIZE=512K {program} --threads=2 job"
    done = subprocess.run(["/bin/sh", "-c", command], cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "with 2 threads" in done.stdout


CLOCK = """
#define _GNU_SOURCE
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>
static long jump(void) { static long n; return n++ % 2 ? -300000000L : 300000000L; }
int clock_gettime(clockid_t which, struct timespec *t)
{
  int status = (int)syscall(SYS_clock_gettime, which, t);
  if (which == CLOCK_REALTIME) t->tv_sec += jump();
  return status;
}
int gettimeofday(struct timeval *t, void *zone)
{
  struct timespec now;
  (void)zone;
  clock_gettime(CLOCK_REALTIME, &now);
  t->tv_sec = now.tv_sec;
  t->tv_usec = now.tv_nsec / 1000;
  return 0;
}
time_t time(time_t *t)
{
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (t) *t = now.tv_sec;
  return now.tv_sec;
}
"""


@needs_preload
def test_a_clock_that_jumps(program: Path, run: Run, block: Path, tmp_path: Path) -> None:  # noqa: F811
    """The time of day jumps forward and back by ten years from call to call: results are the same, and no time that something took is
    negative or long, because times are measured by a monotonic clock."""
    whole, place = tmp_path / "whole", tmp_path / "place"
    whole.mkdir()
    place.mkdir()
    environment = preloading(tmp_path, CLOCK) | {"OMP_NUM_THREADS": "2"}
    jumps = subprocess.run([sys.executable, "-c", "import time; print(abs(time.time() - time.time()) > 1e8)"], env=environment,
                           capture_output=True, text=True, check=True)  # fmt: skip
    assert jumps.stdout == "True\n"
    assert run(["--threads", "2", "--outdir", whole, block]).returncode == 0
    done = subprocess.run([str(program), "--threads", "2", "--outdir", str(place), str(block)], env=environment, capture_output=True, text=True,
                          check=False, timeout=300)  # fmt: skip
    assert done.returncode == 0, done.stdout
    assert same_results(whole / "block.vtkhdf", place / "block.vtkhdf") == []
    with h5py.File(place / "block.vtkhdf", "r") as file:
        seconds = file["AMONTONS/history/seconds"][()]
    assert seconds.min() >= 0
    assert seconds.sum() < 300


def wait_for_lines(path: Path, n: int) -> None:
    """Waits until a file has so many lines."""
    for _ in range(4000):
        if path.exists() and len(path.read_text().splitlines()) >= n:
            return
        time.sleep(0.005)
    pytest.fail("the job does not get on")


def test_two_jobs_in_one_place(program: Path, run: Run, block: Path, tmp_path: Path) -> None:  # noqa: F811
    """The second is refused and touches nothing, whether it begins or resumes; the first one's files are what they are alone."""
    whole, place = tmp_path / "whole", tmp_path / "place"
    whole.mkdir()
    place.mkdir()
    assert run(["--outdir", whole, block]).returncode == 0
    first = subprocess.Popen([str(program), "--outdir", str(place), str(block)], stdout=subprocess.PIPE, text=True,
                             env=os.environ | {"OMP_NUM_THREADS": "1"})  # fmt: skip
    wait_for_lines(place / "block.sta", 6)
    first.send_signal(signal.SIGSTOP)  # so that it is there for sure
    for words in ([], ["--resume"]):
        fails(run([*words, "--outdir", place, block]), IO, "another job is writing it")
    first.send_signal(signal.SIGCONT)
    output, _ = first.communicate(timeout=120)
    assert first.returncode == 0, output
    assert same_results(whole / "block.vtkhdf", place / "block.vtkhdf") == []


@pytest.mark.parametrize("harm", ["cut", "longer", "gone"])
def test_result_file_changed_while_the_job_runs(program: Path, block: Path, tmp_path: Path, harm: str) -> None:  # noqa: F811
    """Cut off, made longer, taken away by someone else: the job ends with a sentence, not with a file that looks whole."""
    job = subprocess.Popen([str(program), "--outdir", str(tmp_path), str(block)], stdout=subprocess.PIPE, text=True,
                           env=os.environ | {"OMP_NUM_THREADS": "1"})  # fmt: skip
    wait_for_lines(tmp_path / "block.sta", 6)
    job.send_signal(signal.SIGSTOP)
    path = tmp_path / "block.vtkhdf"
    if harm == "gone":
        path.unlink()
    else:
        os.truncate(path, 100 if harm == "cut" else path.stat().st_size + 4096)
    job.send_signal(signal.SIGCONT)
    output, _ = job.communicate(timeout=120)
    assert job.returncode == IO, output
    assert "it was changed by another program" in output.splitlines()[-1]


@pytest.mark.slow
def test_a_reader_holds_the_result_file(program: Path, run: Run, block: Path, tmp_path: Path) -> None:  # noqa: F811
    """A reader that has the file open with HDF5's lock keeps no job from writing, and no job keeps a reader out."""
    assert run(["--outdir", tmp_path, block]).returncode == 0
    with h5py.File(tmp_path / "block.vtkhdf", "r"):
        assert run(["--outdir", tmp_path, block]).returncode == 0
    job = subprocess.Popen([str(program), "--outdir", str(tmp_path), str(block)], stdout=subprocess.PIPE, text=True,
                           env=os.environ | {"OMP_NUM_THREADS": "1"})  # fmt: skip
    wait_for_lines(tmp_path / "block.sta", 6)
    job.send_signal(signal.SIGSTOP)
    with h5py.File(tmp_path / "block.vtkhdf", "r") as file:
        assert file["VTKHDF/Steps"].attrs["NSteps"] >= 1
    job.send_signal(signal.SIGCONT)
    assert job.wait(timeout=120) == 0
