"""CETOL beside CalculiX: with the same tolerance each program's error against the closed form, and the increments."""

from __future__ import annotations

from pathlib import Path

import pytest

from verify.cases.inelastic.test_cetol import CUBE, material, relaxed, relaxing
from verify.conftest import Run
from verify.peers.test_mixed_decks import run_peer
from verify.readers.dat_frd_files import read_dat


def by_both(run_deck: Run, folder: Path, deck: str, key: tuple[int, ...]) -> list[float]:
    """The first value of a row of the last table: ours, then CalculiX's."""
    done = run_deck(deck, "--dialect=calculix")
    assert done.returncode == 0, done.stdout + done.stderr
    there = folder / f"ccx{len(list(folder.iterdir()))}"
    there.mkdir()
    (there / "job.inp").write_text(deck)
    run_peer(there)
    return [read_dat(place / "job.dat")[-1].rows[key][0] for place in (folder, there)]


def test_relaxing_bar(run_deck: Run, tmp_path: Path) -> None:
    """A relaxing bar: the errors of both fall with CETOL, and ours is at most as large, to the hundredth that increments that
    begin elsewhere make."""
    before = 10.0
    for cetol in (1e-3, 1e-5):
        ours, theirs = by_both(run_deck, tmp_path, relaxing(f", CETOL={cetol}\n.01, 1000., 1e-6"), (1, 1))
        closed = relaxed(1000.0)
        assert abs(ours - closed) <= 1.01 * abs(theirs - closed)
        assert abs(ours - theirs) <= 0.01 * abs(theirs)
        assert abs(ours - closed) < before
        before = abs(ours - closed)


@pytest.mark.parametrize("cetol", [1e-3, 1e-4])
def test_primary_creep_bar(run_deck: Run, tmp_path: Path, cetol: float) -> None:
    """Time hardening under constant stress: CalculiX has t at the end of each increment and misses the closed form by about a
    hundredth; here t is integrated."""
    text = CUBE + material(210000.0, "4.38e-18, 7.27, -.47")
    text += f"*STEP, INC=10000\n*VISCO, CETOL={cetol}\n1., 72000., 1e-8\n*DLOAD\n1, P4, -82.\n*NODE PRINT, NSET=RIGHT, FREQUENCY=10\nU\n*END STEP\n"
    ours, theirs = by_both(run_deck, tmp_path, text, (7,))
    closed = 4.38e-18 * 82**7.27 * 72000**0.53 / 0.53 + 82 / 210000
    assert abs(ours - closed) < 0.02 * abs(theirs - closed)
    assert abs(ours - theirs) < 0.015 * closed
