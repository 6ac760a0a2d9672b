"""Determinism: bitwise from run to run for a number of threads, and 1e-10 between numbers of threads.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import re
from pathlib import Path

import numpy as np
import pytest

import amontons
from verify.conftest import Run
from verify.decks.make_decks import block_deck
from verify.library.common import block, data_sets, frames, same_results  # noqa: F401

AGREE = 1e-10  # of the largest value of a field


def results(run: Run, deck: Path, folder: Path, threads: int) -> Path:
    """The result file of a run."""
    folder.mkdir()
    done = run(["--threads", threads, "--outdir", folder, deck], threads=threads)
    assert done.returncode == 0, done.stdout
    return folder / f"{deck.stem}.vtkhdf"


@pytest.mark.parametrize("threads", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_same_run_twice(run: Run, block: Path, tmp_path: Path, threads: int) -> None:  # noqa: F811
    """Every number of the result file, iterations and Krylov counts included, is bitwise the same."""
    a, b = (results(run, block, tmp_path / name, threads) for name in "ab")
    assert same_results(a, b) == []


@pytest.mark.parametrize("threads", [1, 2])
def test_the_log_says_so(run: Run, block: Path, tmp_path: Path, threads: int) -> None:  # noqa: F811
    """The first line of the log gives the version, the number of threads, and how far results are the same; a library's log sink gets it."""
    done = run(["--threads", str(threads), "--outdir", tmp_path, block])
    first = done.stdout.splitlines()[0]
    assert re.fullmatch(rf"Amontons \S+ with {threads} threads?: run again so, all results are the same to the last bit; .* 1e-10\.", first)
    heard: list[str] = []
    with amontons.Job(block, threads=threads, log=heard.append):
        assert heard[0] == first


def assert_alike(one: Path, two: Path) -> None:
    """Displacements, stresses and contact forces agree to 1e-10 of the largest; states and increments are the same."""
    for a, b in zip(frames(one), frames(two), strict=True):
        for name in ("U", "S", "CNORMF", "CSHEARF", "CSLIP", "CSTATUS"):
            largest = max(np.abs(a[name]).max(), 1e-30)
            assert np.abs(a[name] - b[name]).max() <= AGREE * largest, name
    x, y = data_sets(one), data_sets(two)
    for name in ("history/n_iterations", "history/n_status", "history/total_time"):
        assert np.array_equal(x[f"AMONTONS/{name}"], y[f"AMONTONS/{name}"]), name


@pytest.mark.slow
def test_one_thread_against_two(run: Run, block: Path, tmp_path: Path) -> None:  # noqa: F811
    """Exact contact with friction."""
    assert_alike(*(results(run, block, tmp_path / str(n), n) for n in (1, 2)))


@pytest.mark.slow
@pytest.mark.parametrize("is_nlgeom", [False, True])
def test_springs_with_one_thread_and_two(run: Run, tmp_path: Path, is_nlgeom: bool) -> None:
    """Compliant contact: its interface is factorised in single precision, of which nothing may be seen."""
    deck = tmp_path / "springs.inp"
    deck.write_text(block_deck(9, is_nlgeom=is_nlgeom, dialect="calculix"))
    assert_alike(*(results(run, deck, tmp_path / str(n), n) for n in (1, 2)))


@pytest.mark.slow
def test_shear_block_twice_with_two_threads(run: Run, root: Path, tmp_path: Path) -> None:
    """The same of a job that is large enough for threads in the matrix products."""
    deck = root / "input" / "shear_block.inp"
    a, b = (results(run, deck, tmp_path / name, 2) for name in "ab")
    assert same_results(a, b) == []
