"""The library: its verbs against the program, rollback bit by bit, values by name, errors as statuses.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import os
import re
import shutil
import subprocess
import threading
from pathlib import Path

import h5py
import numpy as np
import pytest

import amontons
from verify.conftest import Run
from verify.library.common import bits, block, cubes, frames, same_results  # noqa: F401

FIELDS = ("U", "RF", "S", "LE", "S_mises", "CPRESS", "CSHEAR", "COPEN", "CSLIP", "CNORMF", "CSHEARF", "CSTATUS")


def fields(job: amontons.Job) -> list[bytes]:
    """All quantities of the library, bit by bit."""
    return [bits(job.get(name)) for name in (*FIELDS, "RESIDUAL", "CONTACTFORCE")] + [
        bits(job.get(name)) for name in ("TIME", "STEP", "INCREMENTS", "FRICTIONWORK", "EXTERNALWORK")
    ]


def test_library_is_the_program(run: Run, block: Path, tmp_path: Path) -> None:
    """A deck run by the library gives bitwise the result file of the program."""
    done = run(["--outdir", tmp_path, block])
    assert done.returncode == 0, done.stdout
    with amontons.Job(block, name="mine", outdir=tmp_path, files=True) as job:
        job.run()
    assert same_results(tmp_path / "block.vtkhdf", tmp_path / "mine.vtkhdf") == []


def test_values_are_those_of_the_file(block: Path, tmp_path: Path) -> None:
    """`get` gives bitwise what the last frame of the result file holds."""
    with amontons.Job(block, outdir=tmp_path, files=True) as job:
        job.advance_to(1.3)
        job.finish()
        last = frames(tmp_path / "block.vtkhdf")[-1]
        for name in FIELDS:
            assert bits(job.get(name).astype(last[name].dtype)) == bits(last[name]), name


def test_text_in_memory(block: Path) -> None:
    """A deck in memory is the deck in the file."""
    with amontons.Job(block) as a, amontons.Job(text=block.read_text()) as b:
        a.advance()
        b.advance()
        assert bits(a.get("U")) == bits(b.get("U"))


def test_rollback_is_exact(block: Path) -> None:
    """Trials with other lengths, loads and friction leave no trace: not in the values, and not in what comes after."""
    with amontons.Job(block) as job, amontons.Job(block) as straight:
        for _ in range(11):
            job.advance()
            straight.advance()
        before = fields(job)
        job.try_step(0.35)
        assert fields(job) != before
        job.rollback()
        assert fields(job)[:12] == before[:12]
        job.set("FRICTION", "", 0.7)
        job.try_step(0.2)
        job.set("FRICTION", "", 0.3)
        job.rollback()
        for _ in range(4):
            job.advance()
            straight.advance()
            assert fields(job)[:12] == fields(straight)[:12]


def test_iterate_by_hand(cubes: Path) -> None:
    """begin, iterate until converged, commit: the same as one increment of the program."""
    with amontons.Job(cubes) as job, amontons.Job(cubes) as straight:
        for _ in range(12):
            job.begin(0.1)
            while (verdict := job.iterate()) is amontons.Verdict.GO_ON:
                assert job.number("IMBALANCE") > 0
            assert verdict is amontons.Verdict.CONVERGED
            job.commit()
            straight.advance()
            assert bits(job.get("U")) == bits(straight.get("U"))


def test_matrices(block: Path) -> None:
    """The Newton correction J v = r of a solved state is small, K is symmetric, and C maps the free unknowns to all."""
    with amontons.Job(block) as job:
        job.advance_to(1.2)
        tangent, residual = job.matrix("TANGENT")
        stiffness, _ = job.matrix("STIFFNESS")
        constraints, _ = job.matrix("MAP")
        whole = stiffness.dense()
        assert np.abs(whole - whole.T).max() <= 1e-9 * np.abs(whole).max()
        assert constraints.shape == (3 * len(job.nodes()), tangent.shape[0])
        correction = np.linalg.solve(tangent.dense(), residual)
        assert np.abs(constraints @ correction).max() < 1e-4 * np.abs(job.get("U")).max()
        reduced = constraints.dense().T @ whole @ constraints.dense()
        assert np.abs(tangent.dense() - reduced).max() < 2 * np.abs(reduced).max()


def test_set_displacement_replaces_the_deck(cubes: Path) -> None:
    """The lid goes where the program says, exactly, and stays there."""
    with amontons.Job(cubes) as job:
        job.set("U3", "LID", -0.0005)
        job.try_step(0.5)
        job.commit()
        assert np.all(job.get("U", "LID")[:, 2] == -0.0005)
        job.try_step(0.2)
        assert np.all(job.get("U", "LID")[:, 2] == -0.0005)


def test_set_force_and_pressure() -> None:
    """Forces and pressures in sum are the reactions of the support."""
    from verify.library import staggered

    with amontons.Job(text=staggered.DECK) as job:
        job.set("CF3", "WET", [1.0, 2.0, 3.0, 4.0])
        job.set("P", "WET", 7.0)
        job.try_step(0.5)
        assert job.get("RF", "BOTTOM")[:, 2].sum() == pytest.approx(-10.0 + 7.0, abs=1e-9)


def test_log_is_heard(cubes: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """What the program would print goes to the callback; nothing goes to the screen."""
    lines: list[str] = []
    with amontons.Job(cubes, log=lines.append) as job:
        job.run()
    with amontons.Job(cubes) as job:
        job.run()
    assert any("increments converged" in line for line in lines)
    assert capfd.readouterr() == ("", "")


def test_errors_are_statuses(cubes: Path, tmp_path: Path) -> None:
    """Each kind of error has its exception and its message; the job stays usable where it says so."""
    with pytest.raises(amontons.DeckError, match=r"deck:1.*not known"):
        amontons.Job(text="*NONSENSE\n")
    with pytest.raises(amontons.FileError, match="nothing"):
        amontons.Job(tmp_path / "nothing.inp")
    with pytest.raises(amontons.FileError, match="nowhere"):
        amontons.Job(cubes, outdir=tmp_path / "nowhere", files=True)
    with amontons.Job(cubes) as job:
        for wrong in (
            lambda: job.get("NONSENSE"),
            lambda: job.get("U", "NONSENSE"),
            lambda: job.set("U1", "CUBE_SOLE", 0.0),
            lambda: job.set("U1", "LID", [1.0, 2.0]),
            lambda: job.set("U1", "LID", float("nan")),
            lambda: job.set("FRICTION", "", -0.1),
            lambda: job.set("P", "LID", 1.0),
            lambda: job.try_step(-1.0),
            lambda: job.iterate(),
            lambda: job.matrix("NONSENSE"),
        ):
            with pytest.raises(amontons.UsageError):
                wrong()
        job.run()
        with pytest.raises(amontons.UsageError, match="done"):
            job.advance()


def test_not_converged_leaves_the_last_commit(cubes: Path) -> None:
    """An impossible displacement: the error names it, and the job continues from its last commit."""
    with amontons.Job(cubes) as job:
        job.advance()
        before = fields(job)[:12]
        job.set("U3", "LID", -50.0)
        with pytest.raises(amontons.NotConvergedError):
            job.try_step(0.1)
        assert fields(job)[:12] == before
        job.set("U3", "LID", -0.0002)
        job.try_step(0.1)
        job.commit()


def test_null_pointers(cubes: Path) -> None:  # noqa: F811
    """No options, no handle, no name, no values, negative sizes: a status, never a crash."""
    import ctypes

    from amontons.binding import library

    calls = library()
    usage = 2
    handle, n = ctypes.c_void_p(), [ctypes.c_int64() for _ in range(3)]
    verdict = ctypes.c_int()
    assert calls.amontons_open(None, ctypes.byref(handle)) == usage
    assert not handle.value
    for verb in ("advance", "commit", "rollback", "finish"):
        assert getattr(calls, f"amontons_{verb}")(None) == usage
    assert calls.amontons_advance_to(None, 1.0) == calls.amontons_try(None, 1.0) == calls.amontons_begin(None, 1.0) == usage
    assert calls.amontons_iterate(None, ctypes.byref(verdict)) == usage
    assert calls.amontons_get(None, b"U", b"", None, 0, n[0], n[1]) == usage
    assert calls.amontons_set(None, b"U", b"", None, 1) == usage
    assert calls.amontons_matrix(None, b"TANGENT", *n) == usage
    assert calls.amontons_is_done(None) == 1
    calls.amontons_close(None)
    with amontons.Job(cubes) as job:
        job.advance()
        inner = job._job
        assert calls.amontons_get(inner, None, None, None, 0, n[0], n[1]) == usage
        assert calls.amontons_get(inner, b"U", None, None, 0, n[0], n[1]) == 0
        few = (ctypes.c_double * 2)()
        assert calls.amontons_get(inner, b"U", None, few, 2, n[0], n[1]) == usage
        assert calls.amontons_set(inner, b"U3", b"LID", None, 5) == usage
        assert calls.amontons_set(inner, b"U3", b"LID", few, -1) == usage
        assert calls.amontons_set(inner, None, None, few, 2) == usage
        assert calls.amontons_matrix(inner, None, *n) == usage


def test_memory_is_given_back(cubes: Path) -> None:  # noqa: F811
    """Jobs opened, solved and closed one after the other: the process stays as large as after the first ones."""
    import resource

    def largest(n_jobs: int) -> int:
        for _ in range(n_jobs):
            with amontons.Job(cubes) as job:
                for _ in range(3):
                    job.advance()
                job.matrix("TANGENT")
                job.get("U")
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    before = largest(8)
    grown = largest(40) - before
    assert grown < 4096  # kilobytes; a job has some 3000


def test_other_binary_interface() -> None:
    """A caller built against another header gets an error."""
    import ctypes

    from amontons.binding import Options, library

    handle = ctypes.c_void_p()
    assert library().amontons_open(ctypes.byref(Options(abi=999)), ctypes.byref(handle)) == amontons.UsageError.status
    assert b"binary interface" in library().amontons_message(handle)
    library().amontons_close(handle)


@pytest.mark.slow
def test_two_jobs_in_two_threads(block: Path, tmp_path: Path) -> None:
    """Two jobs side by side, with files, each bitwise as alone."""
    alone = amontons.Job(block, name="alone", outdir=tmp_path, files=True)
    alone.run()
    alone.finish()

    def work(name: str, threads: int) -> None:
        with amontons.Job(block, name=name, outdir=tmp_path, files=True, threads=threads) as job:
            job.run()

    workers = [threading.Thread(target=work, args=(name, 1)) for name in ("a", "b")]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    for name in ("a", "b"):
        assert same_results(tmp_path / "alone.vtkhdf", tmp_path / f"{name}.vtkhdf") == []


def test_many_jobs_in_four_threads() -> None:
    """Jobs opened, solved and closed by four threads at once: none finds errors in its deck, all find the same. (gfortran keeps lengths of
    strings in static variables; before threads took turns with words, some of these jobs failed.)"""
    from verify.decks import make_decks

    deck = make_decks.block_deck(2)
    found: list[bytes] = []

    def work() -> None:
        for _ in range(25):
            with amontons.Job(text=deck) as job:
                job.advance()
                found.append(bits(job.get("U", "UPPER_TOP")))

    workers = [threading.Thread(target=work) for _ in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(found) == 100
    assert len(set(found)) == 1


#: Modules below Newton's loop that deal with words: in errors before the first increment, in checkpoints, and (reduced) under the turn.
WORDY = {"containers", "restart_file", "facets", "posix", "reduced_system", "text", "user_material", "user_routines"}
#: Variables that outlive a call: locks, signals, whose routine runs (of each thread), the signal handlers of the process while user
#: routines are open and before the main program's, the turn, and what the compiler makes: lengths of strings (slen), types of
#: variables without values (def_init), its own beginnings and ends.
STATIC = re.compile(r"\.?gomp_critical_user_\w+|slen\.[.\d]+|__\w+_MOD___def_init_\w+|completed\.0|__cpu_\w+|words|depth|stop_signal|"
                    r"n_status_requested|is_watching_end|amontons_user_(inside|way_out|place)|(point|fields|statev)_of_call|caught|"
                    r"handlers_before|handlers_lock|n_open_libraries|"
                    r"is_exit_watched|signal_stack|has_signal_stack|access_before|abort_before|"
                    r"mutexes|mutexes_once|is_flushed")  # fmt: skip


@pytest.mark.skipif(not shutil.which("nm"), reason="there is no nm")
def test_nothing_is_kept_outside_a_job(root: Path, library: Path) -> None:
    """The library's variables that outlive a call are those that are known, and solving, for which a thread gives its turn away, has no
    strings with static lengths but where it takes the turn again."""
    build = (root / os.environ.get("AMONTONS_UNITS", "build/unit")).parent
    symbols = subprocess.run(["nm", str(library)], capture_output=True, text=True, check=True).stdout.splitlines()
    names = {line.split()[2] for line in symbols if len(line.split()) == 3 and line.split()[1] in "bB"}
    if any("asan" in line for line in symbols):
        pytest.skip("sanitizers have variables of their own")
    assert "words" in names
    assert {name for name in names if not STATIC.fullmatch(name)} == set()
    uses = dict(re.findall(r"^uses_(\w+) =(.*)$", (root / "src" / "depends.mk").read_text(), re.MULTILINE))
    tree, todo = set(), ["newton"]
    while todo:
        module = todo.pop()
        tree.add(module)
        todo += [other for other in uses[module].split() if other not in tree]
    wordy = {module for module in tree if "slen" in subprocess.run(["nm", str(build / f"{module}.o")], capture_output=True, text=True, check=True).stdout}
    assert wordy <= WORDY


@pytest.mark.slow
def test_library_resumes(block: Path, tmp_path: Path) -> None:
    """An abandoned job with checkpoints resumes bitwise."""
    with amontons.Job(block, name="whole", outdir=tmp_path, files=True) as job:
        job.run()
    job = amontons.Job(block, name="dropped", outdir=tmp_path, checkpoint=True)
    for _ in range(7):
        job.advance()
    job.close()
    with amontons.Job(block, name="dropped", outdir=tmp_path, resume=True, checkpoint=True) as job:
        assert job.time == pytest.approx(0.7)
        job.run()
    assert same_results(tmp_path / "whole.vtkhdf", tmp_path / "dropped.vtkhdf") == []
    assert not (tmp_path / "dropped.restart").exists()


def warm_deck(block: Path) -> str:  # noqa: F811
    """The block with temperatures and thermal strain."""
    deck = block.read_text().replace("*ELASTIC\n", "*EXPANSION\n1.2e-5\n*ELASTIC\n")
    nodes = [line.split(",")[0] for line in deck.split("*NODE", 1)[1].split("\n*", 1)[0].splitlines()[1:]]
    start = "*INITIAL CONDITIONS, TYPE=TEMPERATURE\n" + "\n".join(f"{node}, 20." for node in nodes) + "\n"
    first, rest = deck.split("*STEP", 1)
    return first + start + "*STEP" + rest


def drive(job: amontons.Job, i: int) -> None:
    """What a calling program does in its i-th turn: sets values, tries, rolls back, commits."""
    if i == 1:
        job.set("CF2", "LOWER_TOP", 0.02)
        job.set("P", "LOWER_TOP", 0.5)
    if i == 2:
        job.set("U3", "UPPER_TOP", -0.0011)
        job.set("FRICTION", "", 0.25)
    if i in (3, 6):
        job.set("NT", "UPPER_TOP", 20.0 + 5 * i)
        job.try_step(0.3)
        job.rollback()
    job.try_step(0.1)
    if i == 4:
        job.set("CF2", "LOWER_TOP", -0.03)  # after the solution: it is reached in the next turn
    job.commit()


@pytest.mark.slow
def test_values_that_were_set_are_in_the_checkpoint(block: Path, tmp_path: Path) -> None:  # noqa: F811
    """Forces, pressures, displacements, temperatures and friction, set during the job: an abandoned job resumes bitwise,
    wherever it was dropped, with what stood then."""
    deck = warm_deck(block)
    with amontons.Job(text=deck, name="whole", outdir=tmp_path, files=True) as job:
        for i in range(14):
            drive(job, i)
        assert job.get("NT", "UPPER_TOP").max() == 50.0
        job.advance()
    for last in (1, 2, 4, 9):
        job = amontons.Job(text=deck, name="dropped", outdir=tmp_path, checkpoint=True)
        for i in range(last + 1):
            drive(job, i)
        job.close()
        with amontons.Job(text=deck, name="dropped", outdir=tmp_path, resume=True, checkpoint=True) as job:
            assert job.number("FRICTION") == (0.3 if last < 2 else 0.25)
            for i in range(last + 1, 14):
                drive(job, i)
            job.advance()
        assert same_results(tmp_path / "whole.vtkhdf", tmp_path / "dropped.vtkhdf") == [], last


def test_what_is_set_after_a_trial_waits(cubes: Path) -> None:  # noqa: F811
    """A value set between a trial and its commit is not lost: the next increment reaches it."""
    with amontons.Job(cubes) as job:
        job.set("U3", "LID", -0.0001)
        job.try_step(0.2)
        job.set("U3", "LID", -0.0002)
        job.commit()
        assert np.all(job.get("U", "LID")[:, 2] == -0.0001)
        job.try_step(0.2)
        job.commit()
        assert np.all(job.get("U", "LID")[:, 2] == -0.0002)


@pytest.mark.parametrize("dt", [0.0, -0.1, 1e-30, 1e-10, float("nan")])
def test_steps_that_move_no_time(cubes: Path, dt: float) -> None:  # noqa: F811
    """A step size that is invalid, or negligible against the time, is refused by both verbs; the job continues from its last state."""
    with amontons.Job(cubes) as job:
        job.advance_to(0.3)
        for verb in (job.try_step, job.begin):
            with pytest.raises(amontons.UsageError, match="at least 1e-9"):
                verb(dt)
        job.advance_to(0.5)
        assert job.time == 0.5


def test_friction_is_set_for_all_steps(block: Path) -> None:  # noqa: F811
    """A coefficient that was set holds in later steps too, also where the deck changes it."""
    deck = block.read_text()
    change = "*CHANGE FRICTION, INTERACTION=RUBBING\n*FRICTION\n0.6\n*STATIC"
    head, tail = deck.rsplit("*STATIC", 1)
    with amontons.Job(text=head + change + tail) as changed, amontons.Job(block) as plain:
        for job in (changed, plain):
            job.set("FRICTION", "", 0.2)
            job.advance_to(1.5)
        assert np.abs(changed.get("CSHEAR")).max() > 0
        assert bits(changed.get("U")) == bits(plain.get("U"))


@pytest.mark.slow
def test_old_job(block: Path, tmp_path: Path) -> None:  # noqa: F811
    """RESTART, READ through the library: bitwise the second step of the whole job."""
    first, second = block.read_text().rsplit("*STEP", 1)
    with amontons.Job(text=first.replace("*STATIC", "*RESTART, WRITE\n*STATIC"), name="old", outdir=tmp_path, files=True) as job:
        job.run()
    with amontons.Job(text="*RESTART, READ, STEP=1\n*STEP" + second, old_job=tmp_path / "old") as part, amontons.Job(block) as whole:
        whole.advance_to(1.0)
        assert bits(part.get("U")) == bits(whole.get("U"))
        whole.run()
        part.run()
        assert fields(part)[:12] == fields(whole)[:12]


def test_result_file_while_open(block: Path, tmp_path: Path) -> None:
    """A viewer may read the file between two increments."""
    with amontons.Job(block, outdir=tmp_path, files=True) as job:
        job.advance()
        with h5py.File(tmp_path / "block.vtkhdf", "r", locking=False) as file:
            assert file["VTKHDF/Steps"].attrs["NSteps"] == 2
