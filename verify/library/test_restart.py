"""Checkpoints: whatever ends a job, it resumes bitwise from its last checkpoint; and unusable files are reported.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.library.common import block, data_sets, same_results  # noqa: F401
from verify.library.test_faults import needs_preload, preloading

IO, NOT_CONVERGED = 7, 5


@pytest.fixture(scope="module")
def whole(run: Run, block: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:  # noqa: F811
    """The folder of the job that was not interrupted."""
    folder = tmp_path_factory.mktemp("whole")
    done = run(["--outdir", folder, block])
    assert done.returncode == 0, done.stdout
    return folder


def start(program: Path, *words: str | Path) -> subprocess.Popen[str]:
    """Starts a job, with one thread. SIGINT reaches it even where a shell runs the tests in the background and ignores that signal."""
    return subprocess.Popen([str(program), *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
                            env=os.environ | {"OMP_NUM_THREADS": "1"})  # fmt: skip


def assert_same(whole: Path, folder: Path) -> None:
    """All files are what they would have been."""
    assert same_results(whole / "block.vtkhdf", folder / "block.vtkhdf") == []
    for ending in ("sta", "cvg", "dat"):
        assert (whole / f"block.{ending}").read_bytes() == (folder / f"block.{ending}").read_bytes(), ending
    assert not list(folder.glob("*.restart*"))


def wait_for_increments(folder: Path, n: int) -> None:
    """Waits until a checkpoint and some lines of .sta are there."""
    for _ in range(2000):
        sta = folder / "block.sta"
        if (folder / "block.restart").exists() and sta.exists() and len(sta.read_text().splitlines()) >= n + 2:
            return
        time.sleep(0.005)
    pytest.fail("the job does not get on")


def kill_often(program: Path, run: Run, deck: Path, folder: Path, n_kills: int, seed: int, longest: float) -> int:
    """Kills and resumes the job until it has been killed n_kills times or is done; returns the number of kills."""
    chance = random.Random(seed)
    kills = 0
    while kills < n_kills:
        words = ["--resume"] if (folder / "block.restart").exists() else []
        job = start(program, *words, "--outdir", folder, deck)
        try:
            output, _ = job.communicate(timeout=chance.uniform(0.0, longest))
            assert job.returncode == 0, output
            return kills
        except subprocess.TimeoutExpired:
            job.kill()
            job.communicate()
            kills += 1
    words = ["--resume"] if (folder / "block.restart").exists() else []
    done = run([*words, "--outdir", folder, deck])
    assert done.returncode == 0, done.stdout
    return kills


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow), pytest.param(2, marks=pytest.mark.slow)])
def test_killed_jobs_resume_bitwise(program: Path, run: Run, block: Path, whole: Path, tmp_path: Path, seed: int) -> None:  # noqa: F811
    """kill -9 at random moments, again and again."""
    kill_often(program, run, block, tmp_path, 6, seed, 0.5)
    assert_same(whole, tmp_path)


def points_deck() -> str:
    """A block slides over faces with springs at points of its own, which come and go."""
    from verify.cases.contact.test_contact_integration_points import deck

    text = deck(8, "*STATIC, DIRECT\n.25, 1.\n", ", NLGEOM", "*FRICTION\n.3, 1.E4\n") + "*BOUNDARY\nFLOOR, 1, 3\nTOP, 1, 2\nTOP, 3, 3, -.01\n*END STEP\n"
    return text + "*STEP, NLGEOM\n*STATIC, DIRECT\n.05, 1.\n*BOUNDARY\nTOP, 1, 1, .3\n*CONTACT PRINT\nCDIS, CSTR\n*END STEP\n"


def mortar_deck() -> str:
    """A block is pressed on faces that do not match its own and dragged over them, by the dual mortar method."""
    from verify.decks import make_decks, sheets

    ticks = np.linspace(0.0, 3.0, 6)
    below = make_decks.block(ticks, ticks, np.linspace(-1, 0, 3), "BELOW")
    above = make_decks.block(np.linspace(0.7, 2.1, 4), np.linspace(0.6, 1.9, 4), np.linspace(0, 1, 3), "ABOVE")
    steps = ("*STEP, NLGEOM\n*STATIC, DIRECT\n0.25, 1.\n*BOUNDARY\nBELOW_BOTTOM, 1, 3\nABOVE_TOP, 1, 2\nABOVE_TOP, 3, 3, -0.02\n*END STEP\n"
             "*STEP, NLGEOM\n*STATIC, DIRECT\n0.05, 1.\n*BOUNDARY\nABOVE_TOP, 1, 1, 0.3\nABOVE_TOP, 2, 2, 0.1\n*CONTACT PRINT\nCDIS, CSTR\n"
             "*END STEP\n")  # fmt: skip
    pair = sheets.pair("ABOVE_BOTTOM", "BELOW_TOP", 0.3, ", TYPE=MORTAR")
    return sheets.solid_deck([(below, (2000.0, 0.3)), (above, (1000.0, 0.3))], pair, steps)


def falling_deck() -> str:
    """A block falls on a table and comes to rest: velocities, mass and contact from increment to increment."""
    from verify.decks import make_decks, sheets

    body = make_decks.block(np.linspace(0, 1, 3), np.linspace(0, 1, 3), np.linspace(0.1, 1.1, 3), "BODY")
    table = make_decks.block(np.linspace(-1, 2, 5), np.linspace(-1, 2, 5), np.linspace(-1, 0, 2), "TABLE")
    steps = ("*STEP, NLGEOM, AMPLITUDE=STEP\n*DYNAMIC, APPLICATION=QUASI-STATIC\n5e-4, 0.02, 1e-9, 1e-3\n*BOUNDARY\nTABLE_BOTTOM, 1, 3\n"
             "*DLOAD\nBODY, GRAV, 9810., 0.2, 0., -1.\n*CONTACT PRINT\nCDIS, CSTR\n*NODE PRINT, NSET=BODY_TOP\nV\n*END STEP\n")  # fmt: skip
    deck = sheets.solid_deck([(body, (2000.0, 0.3)), (table, (1000.0, 0.3))], sheets.pair("BODY_BOTTOM", "TABLE_TOP", 0.3), steps)
    return deck.replace("*SOLID SECTION", "*DENSITY\n1e-3\n*SOLID SECTION")


def skin_deck() -> str:
    """Domed plates with friction, solved with the contact skin: its bulk solver serves many increments."""
    from verify.benchmark.wide_contact import Model, deck_of

    return deck_of(Model(6, is_nlgeom=True, increments=6), "SKIN")


@pytest.mark.slow
@pytest.mark.parametrize("deck", [points_deck, mortar_deck, skin_deck, falling_deck])
def test_surfaces_on_surfaces_resume_bitwise(program: Path, run: Run, tmp_path: Path, deck: Callable[[], str]) -> None:
    """The same where faces lie on faces."""
    kill_over_and_over(program, run, deck(), tmp_path, 4, 7)


@pytest.mark.slow
def test_failed_attempts_resume_bitwise(program: Path, run: Run, tmp_path: Path) -> None:
    """A block dragged over facets with mu = 1 fails twice and cuts back: a failed attempt does not affect the next."""
    from verify.decks.planes import flat_deck, flatten
    from verify.decks.sheets import between, fix, pair, sheet, step

    body, table = sheet("BODY", between(0, 1, 6), between(0, 1, 6)), sheet("TABLE", between(-1, 4, 20), between(-1, 0, 4))
    press = fix("TABLE_BOTTOM, 1, 2", "BODY_TOP, 1", "BODY_TOP, 2, 2, -0.05")
    cards = pair("BODY_BOTTOM", "TABLE_TOP", 1.0) + step(press, 5, is_nlgeom=True) + step(fix("BODY_TOP, 1, 1, 2."), 5, is_nlgeom=True)
    cards = cards.replace("*END STEP", "*CONTACT PRINT\nCDIS, CSTR\n*END STEP", 1)
    dragged = tmp_path / "block.inp"
    dragged.write_text(flat_deck([(flatten(body), (210000.0, 0.3)), (flatten(table), (210000.0, 0.3))], "CPE4", cards))
    for name in ("whole", "killed"):
        (tmp_path / name).mkdir()
    done = run(["--outdir", tmp_path / "whole", dragged])
    assert done.returncode == 0
    assert "This attempt failed" in done.stdout, "else nothing is shown"
    kill_often(program, run, dragged, tmp_path / "killed", 5, 3, 0.5)
    assert_same(tmp_path / "whole", tmp_path / "killed")


@pytest.mark.slow
@pytest.mark.skipif(not os.environ.get("AMONTONS_KILLS"), reason="AMONTONS_KILLS says how many kills; 200 take some minutes")
@pytest.mark.parametrize("deck", ["node to surface", points_deck, mortar_deck])
def test_many_kills(program: Path, run: Run, block: Path, tmp_path: Path, deck: str | Callable[[], str]) -> None:  # noqa: F811
    """The same many times over, a third of the kills for each job."""
    text = block.read_text() if isinstance(deck, str) else deck()
    kill_over_and_over(program, run, text, tmp_path, (int(os.environ["AMONTONS_KILLS"]) + 2) // 3, 1000)


def kill_over_and_over(program: Path, run: Run, text: str, folder: Path, n_kills: int, seed: int) -> None:
    """Runs a job alone and, until there were so many kills, killed up to twelve times; the files are the same."""
    sliding = folder / "block.inp"
    sliding.write_text(text)
    (folder / "whole").mkdir()
    begin = time.monotonic()
    assert run(["--outdir", folder / "whole", sliding]).returncode == 0
    longest = max(0.3, 0.5 * (time.monotonic() - begin))
    kills = 0
    for attempt in range(2 * n_kills):
        if kills >= n_kills:
            return
        killed = folder / "killed"
        killed.mkdir()
        kills += kill_often(program, run, sliding, killed, min(12, n_kills - kills), seed + attempt, longest)
        assert_same(folder / "whole", killed)
        shutil.rmtree(killed)
    assert kills >= n_kills


@pytest.mark.parametrize("number", [signal.SIGTERM, pytest.param(signal.SIGINT, marks=pytest.mark.slow)])
def test_signals_end_a_job_in_order(program: Path, run: Run, block: Path, whole: Path, tmp_path: Path, number: int) -> None:  # noqa: F811
    """Exit code 5 with a sentence, files whole, and the job resumes bitwise."""
    job = start(program, "--outdir", tmp_path, block)
    wait_for_increments(tmp_path, 3)
    job.send_signal(number)
    output, _ = job.communicate(timeout=60)
    assert job.returncode == NOT_CONVERGED, output
    assert output.splitlines()[-1].startswith(f"*ERROR: The job was stopped by {signal.Signals(number).name}")
    assert "amontons: the job ends after this iteration" in output
    n_frames = len(data_sets(tmp_path / "block.vtkhdf")["VTKHDF/Steps/Values"])
    assert n_frames >= 4
    assert run(["--resume", "--outdir", tmp_path, block]).returncode == 0
    assert_same(whole, tmp_path)


def test_status_is_reported(program: Path, block: Path, tmp_path: Path) -> None:  # noqa: F811
    """SIGUSR1 gives a line and does no harm."""
    job = start(program, "--outdir", tmp_path, block)
    wait_for_increments(tmp_path, 2)
    job.send_signal(signal.SIGUSR1)
    output, _ = job.communicate(timeout=60)
    assert job.returncode == 0
    assert sum(line.startswith("Status: step ") for line in output.splitlines()) == 1


def stopped(program: Path, deck: Path, folder: Path) -> None:
    """Leaves a job that was killed after some increments."""
    job = start(program, "--outdir", folder, deck)
    wait_for_increments(folder, 8)
    job.kill()
    job.communicate()
    assert (folder / "block.restart").exists()


def resume_fails(run: Run, deck: Path, folder: Path, sentence: str) -> None:
    """--resume ends with exit code 7 and a sentence."""
    done = run(["--resume", "--outdir", folder, deck])
    assert done.returncode == IO, done.stdout
    last = done.stdout.splitlines()[-1]
    assert last.startswith("*ERROR"), done.stdout
    assert sentence in last


@pytest.mark.slow
def test_checkpoints_that_cannot_be_used(program: Path, run: Run, block: Path, whole: Path, tmp_path: Path) -> None:  # noqa: F811
    """Not there, empty, cut off, one bit changed anywhere, of another deck: reported, and the files stay as they are."""
    resume_fails(run, block, tmp_path, "There is no checkpoint")
    stopped(program, block, tmp_path)
    checkpoint = tmp_path / "block.restart"
    good = checkpoint.read_bytes()
    results = (tmp_path / "block.vtkhdf").read_bytes()
    chance = random.Random(7)
    wrong = [b"", good[:16], good[:-8], good + b"12345678", b"x" + good[1:]]
    for _ in range(20):
        place = chance.randrange(32, len(good))
        wrong.append(good[:place] + bytes([good[place] ^ 1 << chance.randrange(8)]) + good[place + 1 :])
    for bad in wrong:
        checkpoint.write_bytes(bad)
        resume_fails(run, block, tmp_path, "damaged")
    checkpoint.write_bytes(good[:8] + b"\x63" + good[9:])
    resume_fails(run, block, tmp_path, "another version")
    checkpoint.write_bytes(good)
    other = tmp_path / "other" / "block.inp"
    other.parent.mkdir()
    other.write_text(block.read_text().replace("210000", "210001"))
    resume_fails(run, other, tmp_path, "The deck is not the one of the checkpoint")
    assert (tmp_path / "block.vtkhdf").read_bytes() == results
    assert run(["--resume", "--outdir", tmp_path, block]).returncode == 0
    assert_same(whole, tmp_path)


@pytest.mark.slow
def test_result_files_that_do_not_fit(program: Path, run: Run, block: Path, tmp_path: Path) -> None:  # noqa: F811
    """Missing and truncated result files are reported."""
    stopped(program, block, tmp_path)
    results, sta = tmp_path / "block.vtkhdf", tmp_path / "block.sta"
    whole_results, whole_sta = results.read_bytes(), sta.read_bytes()
    results.write_bytes(whole_results[:5000])
    resume_fails(run, block, tmp_path, "shorter than its checkpoint says")
    results.unlink()
    resume_fails(run, block, tmp_path, "it is not there")
    results.write_bytes(whole_results)
    sta.write_bytes(whole_sta[:100])
    resume_fails(run, block, tmp_path, "shorter than it was")
    sta.unlink()
    resume_fails(run, block, tmp_path, "No such file")
    sta.write_bytes(whole_sta)
    assert run(["--resume", "--outdir", tmp_path, block]).returncode == 0


def test_a_power_cut_between_checkpoint_and_result_file(program: Path, run: Run, block: Path, whole: Path, tmp_path: Path) -> None:  # noqa: F811
    """What the result file holds of the last increment does not matter: the checkpoint brings its pages along."""
    stopped(program, block, tmp_path)
    results = tmp_path / "block.vtkhdf"
    with results.open("ab") as file:
        file.write(b"half an increment that was never committed" * 100)
    assert run(["--resume", "--outdir", tmp_path, block]).returncode == 0
    assert_same(whole, tmp_path)


def test_no_checkpoint(run: Run, block: Path, whole: Path, tmp_path: Path) -> None:  # noqa: F811
    """Without checkpoints the results are the same."""
    assert run(["--no-checkpoint", "--outdir", tmp_path, block]).returncode == 0
    assert_same(whole, tmp_path)


KILLING_RENAME = """
#define _GNU_SOURCE
#include <dlfcn.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
static int is_checkpoint(const char *path)
{
  size_t n = strlen(path);
  return n > 8 && strcmp(path + n - 8, ".restart") == 0;
}
int rename(const char *from, const char *to)
{
  static int n;
  int status = ((int (*)(const char *, const char *))dlsym(RTLD_NEXT, "rename"))(from, to);
  if (is_checkpoint(to) && ++n == atoi(getenv("KILLED_AT"))) raise(SIGKILL);
  return status;
}
static int end(const char *name, const char *path)
{
  if (is_checkpoint(path) && strcmp(getenv("KILLED_AT"), "end") == 0) raise(SIGKILL);
  return ((int (*)(const char *))dlsym(RTLD_NEXT, name))(path);
}
int unlink(const char *path) { return end("unlink", path); }
int remove(const char *path) { return end("remove", path); }
"""


@needs_preload
def test_killed_at_a_checkpoint(program: Path, run: Run, block: Path, whole: Path, tmp_path: Path) -> None:  # noqa: F811
    """Killed as soon as a checkpoint stands, before the pages of the result file, and before the last one, of the job that is done,
    is removed."""
    environment = preloading(tmp_path, KILLING_RENAME) | {"OMP_NUM_THREADS": "1"}
    n_killed = 0
    for moment in ["end", *map(str, range(1, 40))]:
        folder = tmp_path / moment
        folder.mkdir()
        done = subprocess.run([str(program), "--outdir", str(folder), str(block)], capture_output=True, env=environment | {"KILLED_AT": moment})
        if done.returncode == 0:
            assert moment != "end"
            break
        assert done.returncode == -signal.SIGKILL
        n_killed += 1
        again = run(["--resume", "--outdir", folder, block])
        assert again.returncode == 0, again.stdout
        assert_same(whole, folder)
    assert n_killed >= 3


@needs_preload
def test_a_done_job_resumed_by_the_library(root: Path, program: Path, block: Path, tmp_path: Path) -> None:  # noqa: F811
    """The checkpoint of a job that was done lacks stresses: the library says so, and the program completes the files."""
    environment = preloading(tmp_path, KILLING_RENAME) | {"OMP_NUM_THREADS": "1"}
    subprocess.run([str(program), "--outdir", str(tmp_path), str(block)], capture_output=True, env=environment | {"KILLED_AT": "end"})
    assert (tmp_path / "block.restart").exists()
    call = f"import amontons; amontons.Job({str(block)!r}, outdir={str(tmp_path)!r}, resume=True, checkpoint=True)"
    done = subprocess.run([sys.executable, "-c", call], capture_output=True, text=True, env=os.environ | {"PYTHONPATH": str(root / "python")})
    assert "Resume it by the program" in done.stderr, done.stderr


def test_every_committed_field_is_restored(root: Path) -> None:
    """Each component of fields_type that is not fixed stands in exchange_fields: a forgotten one would be lost by a restart."""
    state, restart = ((root / "src" / name).read_text() for name in ("state/state.f90", "output/checkpoint.f90"))
    fields = re.search(r"type :: fields_type\n(.*?)end type fields_type", state, re.S)
    routine = re.search(r"subroutine exchange_fields(.*)end subroutine exchange_points", restart, re.S)
    assert fields and routine
    lines = [line for line in fields[1].splitlines() if "fixed" not in line]
    names = re.findall(r"^    (?:real|type|integer|logical)[^!]*?:: (\w+)", "\n".join(lines), re.M)
    assert {"u", "stress", "slaves", "external_work"} <= set(names)
    assert set(names) == set(re.findall(r"fields%(\w+)", routine[1]))


@pytest.mark.slow
def test_restart_write_keeps_the_checkpoint(run: Run, block: Path, tmp_path: Path) -> None:  # noqa: F811
    """RESTART, WRITE: it stays, and a job that is done and resumed is done at once, with the same files."""
    (tmp_path / "job.inp").write_text(block.read_text().replace("*STATIC\n", "*RESTART, WRITE, FREQUENCY=1\n*STATIC\n", 1))
    assert run(["job"], cwd=tmp_path).returncode == 0
    assert (tmp_path / "job.restart").exists()
    before = data_sets(tmp_path / "job.vtkhdf")
    done = run(["--resume", "job"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    assert data_sets(tmp_path / "job.vtkhdf").keys() == before.keys()
    assert len(data_sets(tmp_path / "job.vtkhdf")["VTKHDF/Steps/Values"]) == 21
