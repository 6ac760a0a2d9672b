"""RESTART, WRITE and READ: a job continues from the restart file of another one, bitwise as one deck with all steps would.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import random
import re
import shutil
import subprocess
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.library.common import ROOT, bits, block, frames, same_results  # noqa: F401
from verify.library.test_user_routines import J2, ROUTINES, solid_deck

USAGE, DECK, IO = 2, 3, 7

Parts = tuple[str, list[str]]


def parts_of(deck: str) -> Parts:
    """The model and the steps of a deck."""
    first, *steps = re.split(r"(?m)^(?=\*STEP)", deck)
    return first, steps


def write(folder: Path, **decks: str) -> None:
    """Writes decks by their names."""
    for name, text in decks.items():
        (folder / f"{name}.inp").write_text(text)


def run_all(run: Run, folder: Path, *jobs: str) -> None:
    """Runs jobs, each given with all its words."""
    for job in jobs:
        done = run(job.split(), cwd=folder)
        assert done.returncode == 0, done.stdout


def assert_continues(whole: Path, part: Path, n: int) -> None:
    """The last n frames of both are bitwise the same; so are times, and the work that was done."""
    a, b = frames(whole)[-n:], frames(part)[-n:]
    assert len(a) == len(b) == n
    for one, other in zip(a, b, strict=True):
        assert one.keys() == other.keys()
        for name in one:
            assert bits(one[name]) == bits(other[name]), name
    with h5py.File(whole) as one, h5py.File(part) as other:
        assert bits(one["VTKHDF/Steps/Values"][-n:]) == bits(other["VTKHDF/Steps/Values"][-n:])
        for name in ("step", "increment", "n_iterations", "total_time", "external_work", "friction_work", "reaction_force"):
            x, y = one["AMONTONS/history"][name][-n:], other["AMONTONS/history"][name][-n:]
            assert bits(x) == bits(y), name


@pytest.fixture(scope="module")
def friction(run: Run, block: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Parts]:  # noqa: F811
    """A block that is pressed, then sheared with friction: the whole job, and one of the first step that keeps all states."""
    folder = tmp_path_factory.mktemp("friction")
    model, steps = parts_of(block.read_text())
    assert len(steps) == 2
    write(folder, whole=model + "".join(steps), old=model + "*RESTART, WRITE\n" + steps[0])
    run_all(run, folder, "whole", "old")
    return folder, (model, steps)


def test_next_step_bitwise(run: Run, friction: tuple[Path, Parts], tmp_path: Path) -> None:
    """Step 2 in a deck of its own; its first frame is the state at the end of step 1."""
    folder, (_, steps) = friction
    write(tmp_path, new="*HEADING\nshear it\n*RESTART, READ, STEP=1\n" + steps[1])
    run_all(run, tmp_path, f"new oldjob={folder}/old")
    n = len(frames(tmp_path / "new.vtkhdf")) - 1
    assert n == 10
    assert_continues(folder / "whole.vtkhdf", tmp_path / "new.vtkhdf", n)
    before, start = frames(folder / "whole.vtkhdf")[-n - 1], frames(tmp_path / "new.vtkhdf")[0]
    assert bits(before["U"]) == bits(start["U"])
    with h5py.File(tmp_path / "new.vtkhdf") as file:
        assert file["AMONTONS/history/step"][:].ravel().tolist() == [1] + 10 * [2]


@pytest.mark.parametrize("increment", [1, pytest.param(4, marks=pytest.mark.slow)])
def test_middle_of_a_step_bitwise(run: Run, friction: tuple[Path, Parts], tmp_path: Path, increment: int) -> None:
    """From an increment within step 1: the rest of it comes first, then step 2."""
    folder, (_, steps) = friction
    write(tmp_path, new=f"*RESTART, READ, STEP=1, INC={increment}\n" + steps[1])
    run_all(run, tmp_path, f"new --oldjob {folder}/old.res")
    n = len(frames(tmp_path / "new.vtkhdf")) - 1
    assert n == 20 - increment
    assert_continues(folder / "whole.vtkhdf", tmp_path / "new.vtkhdf", n)


@pytest.mark.slow
def test_chain_of_restarts(run: Run, friction: tuple[Path, Parts], tmp_path: Path) -> None:
    """Old, then a job that continues and keeps states itself, then a third one: bitwise the whole job; a card in the middle
    may include a file, and a third step has a set and an amplitude of the new deck."""
    folder, (model, steps) = friction
    (tmp_path / "sheared.txt").write_text("** nothing\n")
    extra = "*NSET, NSET=NEWSET\nUPPER_TOP\n*AMPLITUDE, NAME=BACK\n0., 1., 1., 0.2\n"
    third = re.sub(r"(?s)\*BOUNDARY.*?(?=\n\*)", "*BOUNDARY, AMPLITUDE=BACK\nNEWSET, 1, 1, 0.004", steps[1], count=1)
    assert "NEWSET" in third
    write(tmp_path, whole=model + extra + "".join(steps) + third,
          second="*RESTART, READ\n*RESTART, WRITE, FREQUENCY=3, OVERLAY\n*INCLUDE, INPUT=sheared.txt\n" + steps[1],
          third="*HEADING\nthe third\n*RESTART, READ, STEP=2\n" + extra + third)  # fmt: skip
    run_all(run, tmp_path, "whole", f"second oldjob={folder}/old", "third oldjob=second")
    assert_continues(tmp_path / "whole.vtkhdf", tmp_path / "third.vtkhdf", 10)


def test_end_step(run: Run, friction: tuple[Path, Parts], tmp_path: Path) -> None:
    """END STEP after 4 of 10 increments: what a step of 4 tenths with 4 tenths of its displacement gives, to rounding; the
    next step continues from there."""
    folder, (model, steps) = friction
    static = re.search(r"\*STATIC[^\n]*\n([^\n]*)", steps[0])
    assert static
    first, period = (float(word) for word in static[1].split(",")[:2])
    short = steps[0].replace(static[1], f"{first}, {0.4 * period}, {first}, {first}")
    down = re.search(r"(?m)^(\w+, 3, 3, )(-[\d.eE-]+)$", short)
    assert down
    short = short.replace(down[0], f"{down[1]}{0.4 * float(down[2])!r}")
    write(tmp_path, short=model + short + steps[1], new="*RESTART, READ, STEP=1, INC=4, END STEP\n" + steps[1])
    run_all(run, tmp_path, "short", f"new oldjob={folder}/old")
    a, b = frames(tmp_path / "short.vtkhdf"), frames(tmp_path / "new.vtkhdf")
    assert len(a) == 15
    assert len(b) == 11
    for one, other in zip(a[4:], b, strict=True):
        for name in ("U", "RF", "S"):
            assert np.abs(one[name] - other[name]).max() <= 1e-9 * np.abs(one[name]).max(), name
    with h5py.File(tmp_path / "short.vtkhdf") as one, h5py.File(tmp_path / "new.vtkhdf") as other:
        assert np.allclose(one["VTKHDF/Steps/Values"][4:], other["VTKHDF/Steps/Values"][:], rtol=1e-12)


def test_umat_and_persistent_loads(run: Run, tmp_path: Path) -> None:
    """A user's plasticity at finite strain with local axes, STATEV and all, resumes bitwise."""
    deck = solid_deck("C3D8", J2, nlgeom=True, top=(0.05, -0.05))
    deck = deck.replace("*MATERIAL", "*ORIENTATION, NAME=AXES\n2., 1., 0., -1., 2., 0.\n*MATERIAL")
    deck = deck.replace("MATERIAL=STUFF", "MATERIAL=STUFF, ORIENTATION=AXES")
    model, steps = parts_of(deck)
    write(tmp_path, whole=deck, old=model + steps[0].replace("*STATIC", "*RESTART, WRITE\n*STATIC"),
          new="*RESTART, READ, STEP=1, INC=2\n" + steps[1])  # fmt: skip
    routines = f"user={ROUTINES / 'j2.f'}"
    run_all(run, tmp_path, f"whole {routines}", f"old {routines}", f"new oldjob=old {routines}")
    assert_continues(tmp_path / "whole.vtkhdf", tmp_path / "new.vtkhdf", len(frames(tmp_path / "new.vtkhdf")) - 1)


def test_the_page_of_the_manual(run: Run, tmp_path: Path) -> None:
    """The two decks that are shown: the second one prints the corner at half of the return."""
    page = (ROOT / "doc" / "manual" / "restart.md").read_text()
    decks = re.findall(r"```(abaqus\S*)\n(.*?)```", page, re.DOTALL)
    assert [kind for kind, _ in decks] == ["abaqus", "abaqus-restart"]
    write(tmp_path, first=decks[0][1], second=decks[1][1])
    run_all(run, tmp_path, "first", "second oldjob=first")
    assert frames(tmp_path / "second.vtkhdf")[-1]["U"][:, 2].max() == 0.001
    assert "set CORNER" in (tmp_path / "second.dat").read_text()


def fails(run: Run, folder: Path, words: str, code: int, sentence: str) -> None:
    """A job ends with a code and a sentence, and has begun no result file."""
    done = run(words.split(), cwd=folder)
    assert done.returncode == code, done.stdout
    assert re.search(sentence, done.stdout), done.stdout
    assert not (folder / f"{words.split()[0]}.vtkhdf").exists()


@pytest.mark.slow
def test_which_states_are_kept(run: Run, friction: tuple[Path, Parts], tmp_path: Path) -> None:
    """FREQUENCY=3 of 10 increments: 3, 6, 9 and 10; with OVERLAY the last alone; FREQUENCY=0 none."""
    _, (model, steps) = friction
    write(tmp_path, some=model + "*RESTART, WRITE, FREQUENCY=3\n" + steps[0],
          last=model + "*RESTART, WRITE, FREQUENCY=3, OVERLAY\n" + "".join(steps),
          none=model + "*RESTART, WRITE, FREQUENCY=0\n" + steps[0])  # fmt: skip
    run_all(run, tmp_path, "some", "last", "none")
    assert not (tmp_path / "none.res").exists()
    for increment in (3, 6, 9, 10):
        write(tmp_path, new=f"*RESTART, READ, STEP=1, INC={increment}\n" + steps[1])
        run_all(run, tmp_path, "new --check oldjob=some")
    for words in ("STEP=1, INC=4", "INC=11"):
        write(tmp_path, new=f"*RESTART, READ, {words}\n" + steps[1])
        fails(run, tmp_path, "new oldjob=some", IO, "no state of increment .* Its last one is of step 1, increment 10")
    write(tmp_path, new="*RESTART, READ, STEP=2\n" + steps[1])
    fails(run, tmp_path, "new oldjob=some", IO, "no state of step 2")
    write(tmp_path, new="*RESTART, READ, STEP=1, INC=9\n" + steps[1])
    fails(run, tmp_path, "new oldjob=last", IO, "no state of increment 9 of step 1")
    for step in (1, 2):
        write(tmp_path, new=f"*RESTART, READ, STEP={step}, INC=10\n" + steps[1])
        run_all(run, tmp_path, "new --check oldjob=last")


@pytest.mark.slow
def test_as_with_calculix(run: Run, friction: tuple[Path, Parts], tmp_path: Path) -> None:
    """Under the calculix dialect the last of every n-th step is kept, OVERLAY keeps one state, and without oldjob new.rin is
    read, a copy of old.res; the dialect is that of the old job."""
    _, (model, steps) = friction
    head = "** dialect: calculix\n"
    write(tmp_path, whole=head + model + "".join(steps),
          old=head + model + steps[0].replace("*STATIC", "*RESTART, WRITE\n*STATIC"), new="*RESTART, READ, STEP=1\n" + steps[1],
          over=head + model + "*RESTART, WRITE, OVERLAY\n" + "".join(steps))  # fmt: skip
    run_all(run, tmp_path, "whole", "old")
    shutil.copy(tmp_path / "old.res", tmp_path / "new.rin")
    run_all(run, tmp_path, "new", "over")
    assert_continues(tmp_path / "whole.vtkhdf", tmp_path / "new.vtkhdf", 10)
    write(tmp_path, one="*RESTART, READ, STEP=1\n" + steps[1], five="*RESTART, READ, STEP=1, INC=5\n" + steps[1])
    fails(run, tmp_path, "one oldjob=over", IO, "no state of step 1")
    fails(run, tmp_path, "five oldjob=old", IO, "no state of increment 5")


def test_what_cannot_be_read(run: Run, friction: tuple[Path, Parts], tmp_path: Path) -> None:
    """No file, another file, one bit changed, cut off; cards that would change the model; wrong words. Each is reported."""
    folder, (_, steps) = friction
    write(tmp_path, new="*RESTART, READ, STEP=1\n" + steps[1], plain=steps[1])
    fails(run, tmp_path, "new", IO, r"There is no restart file \S*new.rin. A job writes one")
    fails(run, tmp_path, "new oldjob=nothing", IO, "There is no restart file nothing.res")
    fails(run, tmp_path, f"plain oldjob={folder}/old", USAGE, r"no \*RESTART, READ")
    good = (folder / "old.res").read_bytes()
    chance = random.Random(11)
    for bad in (b"", b"text", good[:64], good[:4000]):
        (tmp_path / "bad.res").write_bytes(bad)
        fails(run, tmp_path, "new oldjob=bad", IO, "is damaged|holds no state")
    starts = [place.start() for place in re.finditer(b"AMONTRES", good)]
    assert len(starts) == 11  # the deck, and ten states
    write(tmp_path, new="*RESTART, READ, STEP=1, INC=10\n" + steps[1])
    for first, last in ((0, starts[1]), (starts[10], len(good)), (starts[5], starts[5] + 16)):  # deck, state, a head between
        for _ in range(4):
            place = chance.randrange(first, last)
            (tmp_path / "bad.res").write_bytes(good[:place] + bytes([good[place] ^ 1 << chance.randrange(8)]) + good[place + 1 :])
            fails(run, tmp_path, "new oldjob=bad", IO, "is damaged|holds no state|another version|does not fit")
    write(tmp_path, new="*RESTART, READ\n*NODE\n1, 0., 0., 0.\n*AMPLITUDE, NAME=A, DEFINITION=USER\n" + steps[1])
    fails(run, tmp_path, f"new oldjob={folder}/old", DECK, r"new.inp:2: .*NODE is not allowed before the steps")
    fails(run, tmp_path, f"new oldjob={folder}/old", DECK, r"new.inp:4: .*must be in the deck of the old job")
    write(tmp_path, new="*RESTART, READ\n" + steps[1].replace("*STATIC", "*NONSENSE\n*STATIC"))
    fails(run, tmp_path, f"new oldjob={folder}/old", DECK, r"new.inp:\d+: .*NONSENSE is not known")


def test_a_torn_state_is_passed_over(run: Run, friction: tuple[Path, Parts], tmp_path: Path) -> None:
    """A file whose last state was torn by a crash serves with the one before."""
    folder, (_, steps) = friction
    good = (folder / "old.res").read_bytes()
    (tmp_path / "old.res").write_bytes(good[:-1000])
    write(tmp_path, new="*RESTART, READ, STEP=1\n" + steps[1])
    run_all(run, tmp_path, "new oldjob=old")
    assert_continues(folder / "whole.vtkhdf", tmp_path / "new.vtkhdf", 11)


@pytest.mark.parametrize("overlay", ["", ", OVERLAY"])
@pytest.mark.slow
def test_killed_jobs_keep_their_states(program: Path, run: Run, friction: tuple[Path, Parts], tmp_path: Path, overlay: str) -> None:
    """kill -9 at random moments of a job that continues and keeps states: resumed, all files are those of one left alone."""
    folder, (_, steps) = friction
    deck = f"*RESTART, READ\n*RESTART, WRITE, FREQUENCY=2{overlay}\n" + steps[1]
    for place in ("whole", "killed"):
        (tmp_path / place).mkdir()
        write(tmp_path / place, new=deck)
    run_all(run, tmp_path / "whole", f"new oldjob={folder}/old")
    chance = random.Random(len(overlay))
    here = tmp_path / "killed"
    for _ in range(6):
        words = ["--resume"] if (here / "new.restart").exists() else []
        job = subprocess.Popen([str(program), *words, "--threads", "1", "new", f"oldjob={folder}/old"], cwd=here,
                               stdout=subprocess.DEVNULL)  # fmt: skip
        time.sleep(chance.uniform(0.1, 0.6))
        job.kill()
        job.wait()
    run_all(run, here, ("--resume " if (here / "new.restart").exists() else "") + f"new oldjob={folder}/old")
    assert same_results(tmp_path / "whole" / "new.vtkhdf", here / "new.vtkhdf") == []
    assert (tmp_path / "whole" / "new.res").read_bytes() == (here / "new.res").read_bytes()
