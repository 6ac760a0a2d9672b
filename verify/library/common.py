"""What the tests of library, restart, determinism and user routines share: small jobs with friction, comparing results bit by bit, cut-backs.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os
from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.independent.results import read_history

ROOT = Path(__file__).resolve().parent.parent.parent
os.environ["AMONTONS_LIBRARY"] = str(ROOT / os.environ.get("AMONTONS_LIB", "lib") / "libamontons.so")


@pytest.fixture(scope="session")
def cubes() -> Path:
    """Three cubes: presses, then drags; 20 increments in a moment."""
    return ROOT / "input" / "three_cubes.inp"


@pytest.fixture(scope="session")
def block(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small shear block: 20 increments with stick and slip, about a second."""
    from verify.decks import make_decks

    deck = tmp_path_factory.mktemp("block") / "block.inp"
    deck.write_text(make_decks.block_deck(5))
    return deck


def bits(array: np.ndarray) -> bytes:
    """For comparisons bit by bit."""
    return np.ascontiguousarray(array).tobytes()


def frames(path: Path) -> list[dict[str, np.ndarray]]:
    """The point data of all frames."""
    with h5py.File(path, "r", locking=False) as file:
        n = int(file["VTKHDF/NumberOfPoints"][0])
        n_frames = int(file["VTKHDF/Steps"].attrs["NSteps"])
        data = {name: table[:] for name, table in file["VTKHDF/PointData"].items()}
    return [{name: table[k * n : (k + 1) * n] for name, table in data.items()} for k in range(n_frames)]


def data_sets(path: Path) -> dict[str, np.ndarray]:
    """All data sets of a file but the seconds that things took."""
    found: dict[str, np.ndarray] = {}

    def take(name: str, item: h5py.HLObject) -> None:
        if isinstance(item, h5py.Dataset) and not name.endswith("seconds"):
            found[name] = np.asarray(item[()])

    with h5py.File(path, "r", locking=False) as file:
        file.visititems(take)
    return found


def same_results(one: Path, other: Path) -> list[str]:
    """The names of the data sets that are not bitwise the same in both files."""
    a, b = data_sets(one), data_sets(other)
    return sorted(name for name in a.keys() | b.keys() if name not in a or name not in b or bits(a[name]) != bits(b[name]))


def check_shorter_increments(run: Run, tmp_path: Path, deck: str, routine: Path, longest: float) -> None:
    """A routine refuses increments above the longest one by PNEWDT: attempts fail, and none that converges is longer."""
    (tmp_path / "job.inp").write_text(deck)
    done = run(["job", f"user={routine}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    history = read_history(tmp_path / "job.vtkhdf")
    times = history["step_time"][history["is_converged"] > 0]
    assert np.diff(times, prepend=0).max() <= longest + 1e-12
    assert (history["is_converged"] == 0).any()
