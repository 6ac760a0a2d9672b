"""A short run of the fuzzer; AMONTONS_FUZZ says how many decks a long one has.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from verify.fuzz import fuzz


@pytest.mark.slow
def test_decks(program: Path, tmp_path: Path) -> None:
    """Mutated decks: no crash, no internal error, no NaN and no lost force behind exit code 0."""
    tally = fuzz.fuzz_decks(program, int(os.environ.get("AMONTONS_FUZZ", "40")), 11, tmp_path / "kept", 1e9)
    assert tally.findings == [], tally.report()
    assert sum(tally.ends.values()) >= 40
    assert tally.ends["exit 3"] > 0


def test_decks_that_run_are_looked_at(program: Path, tmp_path: Path) -> None:
    """The eye of the fuzzer: a result file with a reaction that is not that of its loads is a lie."""
    import h5py

    deck = fuzz.source_decks()["block2"]
    (tmp_path / "job.inp").write_text(deck)
    done = fuzz.execute(program, tmp_path, "--threads", "1", "--no-checkpoint", "job")
    assert done.returncode == 0, done.stdout
    assert fuzz.lie_of(tmp_path, deck) == ""
    with h5py.File(tmp_path / "job.vtkhdf", "r+") as file:
        file["AMONTONS/history/reaction_force"][-1] += 0.02 * abs(file["AMONTONS/history/slave_force"][()]).max()
    assert "do not balance" in fuzz.lie_of(tmp_path, deck)


@pytest.mark.slow
def test_checkpoints(program: Path) -> None:
    """Damaged checkpoints are reported."""
    tally = fuzz.fuzz_checkpoints(program, 25, 3)
    assert tally.findings == [], tally.report()


@pytest.mark.slow
def test_restart_files(program: Path) -> None:
    """Damaged restart files are reported, or harmless."""
    tally = fuzz.fuzz_restart_files(program, 15, 4)
    assert tally.findings == [], tally.report()


@pytest.mark.slow
def test_calls(library: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Library calls in any order, with any names and numbers, end with a status."""
    monkeypatch.setenv("AMONTONS_LIBRARY", str(library))
    tally = fuzz.fuzz_calls(50, 5)
    assert tally.findings == [], tally.report()


def test_a_surface_of_elements_with_missing_nodes(program: Path, tmp_path: Path) -> None:
    """Found by the fuzzer: the free faces of elements that name a node that is not there overwrote memory."""
    (tmp_path / "job.inp").write_text("*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 0., 1., 0.\n*ELEMENT, TYPE=C3D4, ELSET=E\n1, 1, 2, 3, 77\n"
                                      "*SURFACE, NAME=S\nE,\n")  # fmt: skip
    done = fuzz.execute(program, tmp_path, "--check", "job")
    assert done.returncode == 3, done.stderr
    assert b"77" in done.stdout
