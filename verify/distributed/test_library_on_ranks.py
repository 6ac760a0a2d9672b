"""The library and Python on a communicator: the values of the library of one rank, the same on all ranks; errors on all; parts of the ranks.

Needs lib/libamontons-mpi.so (`make MPI=1`) and mpiexec; without them the tests are skipped.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import amontons
from verify.benchmark.estimate_table import cube
from verify.decks.make_decks import block_deck
from verify.distributed.jobs_on_ranks import conversation
from verify.distributed.ranks_and_serial import TOLERANCE, environment
from verify.library.common import ROOT

LIBRARY = ROOT / os.environ.get("AMONTONS_LIB", "lib") / "libamontons-mpi.so"


def on_ranks(n: int, work: str, folder: Path) -> list[dict[str, np.ndarray]]:
    """What each of n ranks got."""
    paths = {"PYTHONPATH": f"{ROOT / 'python'}{os.pathsep}{ROOT}", "AMONTONS_MPI_LIBRARY": str(LIBRARY)}
    command = ["mpiexec", "-n", str(n), sys.executable, "-m", "verify.distributed.jobs_on_ranks", work, str(folder)]
    done = subprocess.run(command, cwd=folder, env=environment() | paths, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0 and done.stdout == "", done.stdout + done.stderr
    return [dict(np.load(folder / f"rank{r}.npz")) for r in range(n)]


def are_close(values: np.ndarray, expected: np.ndarray, tolerance: float, scale: float = 0.0) -> bool:
    """Whether values agree, over their largest or a scale that is larger."""
    return bool(np.abs(values - expected).max(initial=0.0) <= tolerance * max(scale, np.abs(expected).max(initial=0.0)))


@pytest.fixture(scope="module")
def serial() -> dict[str, np.ndarray]:
    """The values of one rank without MPI."""
    with amontons.Job(text=block_deck(2)) as job:
        return conversation(job)


@pytest.mark.parametrize("n", [1, 2, 3])
@pytest.mark.usefixtures("needs")
def test_same_values(tmp_path: Path, serial: dict[str, np.ndarray], n: int) -> None:
    """All quantities between all calls, within an increment too, and the matrices: to 1e-10 of the largest value, on one rank and between the
    ranks to the last bit. Residuals are differences of forces, gaps of displacements. One log, one set of files."""
    ranks = on_ranks(n, "conversation", tmp_path)
    force, displacement = (np.abs(serial[f"end: {name}"]).max() for name in ("INTERNAL FORCE", "U"))
    for name, values in serial.items():
        found = [rank[name] for rank in ranks]
        assert all(found[0].tobytes() == other.tobytes() for other in found[1:]), name
        assert found[0].shape == values.shape, name
        if n == 1:
            assert found[0].tobytes() == values.tobytes(), name
        else:
            scale = force if "residual" in name.lower() else displacement if "COPEN" in name else 0.0
            assert are_close(found[0], values, TOLERANCE, scale), name
    assert [int(rank["heard"]) > 0 for rank in ranks] == [True] + [False] * (n - 1)
    assert (tmp_path / "job.vtkhdf").exists()


@pytest.mark.usefixtures("needs")
def test_parts_of_the_ranks(tmp_path: Path) -> None:
    """Two jobs on two pairs of four ranks at once, then one pair alone, then all four, with all solvers of PETSc: the displacements of one rank."""
    expected = {}
    for n in (3, 4):
        with amontons.Job(text=cube(n, "")) as job:
            job.run()
            expected[n] = job.get("U")
    for r, found in enumerate(on_ranks(4, "half", tmp_path)):
        size = {f"part {r % 2} {solver}": 3 + r % 2 for solver in ("GAMG", "HYPRE", "MUMPS")} | {f"all {solver}": 4 for solver in ("GAMG", "HYPRE", "MUMPS")}
        size |= {"odd ranks alone": 3} if r % 2 else {}
        assert set(found) == set(size)
        for name, values in found.items():
            assert are_close(values, expected[size[name]], 1e-9), name


@pytest.mark.usefixtures("needs")
def test_errors_on_all_ranks(tmp_path: Path) -> None:
    """Each error is the same on both ranks, at once; the job continues after those of its calls."""
    first, second = on_ranks(2, "errors", tmp_path)
    words = {
        "deck": "DeckError: ", "no rank": "UsageError: This process is not in the communicator", "user": "UsageError: User routines run with one rank",
        "different decks": "UsageError: The ranks give different decks.", "alone": "DeckError: ",
        "different partitions": "UsageError: The ranks give different options.", "partitions": "UsageError: The number of partitions is -1;", "folder": "FileError: ",
        "other": "UsageError: A process has one communicator at a time", "step": "UsageError: The ranks give different time steps.",
        "set": "UsageError: The ranks give different values of U3.", "name": "UsageError: ", "not converged": "NotConvergedError: ", "continues": "0.1",
    }  # fmt: skip
    assert set(first) == set(second) == set(words) | {"heard"}
    for name, start in words.items():
        assert str(first[name]) == str(second[name]) and str(first[name]).startswith(start), f"{name}: {first[name]} {second[name]}"
    assert "STATIK" in str(first["deck"]) and "GAMG" in str(first["alone"]) and "wait" not in " ".join(str(first[name]) for name in words)
    assert int(first["heard"]) > 0 and int(second["heard"]) == 0


def test_library_of_one_rank_refuses() -> None:
    """libamontons takes no communicator: a sentence, whatever the handle."""
    import ctypes

    from amontons.binding import ABI, Options, library

    handle = ctypes.c_void_p()
    options = Options(abi=ABI, n_threads=1, text=cube(2, "").encode())
    assert library().amontons_open_on(ctypes.byref(options), 0, ctypes.byref(handle)) == amontons.UsageError.status
    assert b"libamontons-mpi" in library().amontons_message(handle)
    library().amontons_close(handle)


def test_ranks_are_those_of_the_communicator() -> None:
    """petsc_shim.c names MPI_COMM_WORLD only where the program begins and where it ends all processes: a job may have a part of the ranks."""
    source = (ROOT / "src" / "distributed" / "petsc_shim.c").read_text()
    allowed = ("MPI_Comm_dup(MPI_COMM_WORLD, &communicator);", "MPI_Abort(MPI_COMM_WORLD, code);")
    for call in allowed:
        assert call in source
        source = source.replace(call, "")
    assert "MPI_COMM_WORLD" not in source and source.count("PETSC_COMM_WORLD") == 1


@pytest.fixture
def needs() -> None:
    """Skips where there is no library of several ranks."""
    if not LIBRARY.exists():
        pytest.skip("there is no libamontons-mpi.so: make MPI=1 builds it")
    if shutil.which("mpiexec") is None:
        pytest.skip("there is no mpiexec")
