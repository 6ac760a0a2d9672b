"""Automatic increments follow what happened: iterations, failed attempts, cycles, and contact that was not predicted.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.independent.results import read_field, read_history
from verify.readers.dat_frd_files import read_dat
from verify.study.contact_table import ball, cylinder

FAST, SLOW, N_SURE = 6, 12, 4  #: iterations: IG, IL of doc/theory/newton.md, and those after which what was not predicted counts
SHORTER, LONGER, CUTS = 0.75, 1.5, (0.25, 0.5)  #: D_B, D_D, (D_F, D_C)
MAX_LENGTH = 0.2  #: the longest increment that the deck allows


def pressed_into_metal() -> str:
    """A stiff cylinder pressed into a slab that yields, drawn to and fro: contact changes much, and some attempts fail."""
    deck = cylinder(0.3, "AUTO", 5)
    deck = re.sub(r"(\*STATIC\n)[^\n]*\n", rf"\g<1>{MAX_LENGTH}, 1., 1e-6, {MAX_LENGTH}\n", deck)
    yielding = "*MATERIAL, NAME=SLAB\n*ELASTIC\n2000, 0.3\n"
    assert yielding in deck
    return deck.replace(yielding, yielding + "*PLASTIC\n20., 0.\n40., 1.\n")


def wanted(history: dict[str, np.ndarray]) -> tuple[list[tuple[float, ...]], int]:
    """The lengths that the rule allows for each attempt, and how often what happened held back one that the iterations alone would have let grow."""
    allowed, held, dt, fast, fast_alone, has_failed = [], 0, MAX_LENGTH, 0, 0, False
    for i, step in enumerate(history["step"]):
        if i == 0 or step != history["step"][i - 1]:
            dt, fast, fast_alone, has_failed = MAX_LENGTH, 0, 0, False
            allowed.append((dt,))
        elif not history["is_converged"][i - 1]:
            allowed.append(tuple(cut * history["dt"][i - 1] for cut in CUTS))
            dt, fast, fast_alone, has_failed = float(history["dt"][i]), 0, 0, True
        else:
            n, cycles = int(history["n_iterations"][i - 1]), int(history["n_cycles"][i - 1])
            is_predicted = history["n_unpredicted"][i - 1] == 0 or n <= N_SURE
            fast_alone = fast_alone + 1 if n <= FAST else 0
            fast = fast + 1 if n <= FAST and cycles == 0 and (is_predicted or not has_failed) else 0
            held += fast_alone >= 2 and fast < 2
            dt = SHORTER * dt if n > SLOW else min(MAX_LENGTH, LONGER * dt) if fast >= 2 else dt
            allowed.append((dt,))
    return allowed, held


@pytest.mark.slow
def test_increments_follow_what_happened(run: Run, tmp_path: Path) -> None:
    """Each increment is as long as the rule of doc/theory/newton.md says of those before it, and the rule is not that of the iterations alone."""
    (tmp_path / "job.inp").write_text(pressed_into_metal())
    done = run(["job"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    history = read_history(tmp_path / "job.vtkhdf")
    history = {name: column[history["increment"] > 0] for name, column in history.items()}
    allowed, held = wanted(history)
    for i, lengths in enumerate(allowed):
        left = 1.0 - (history["step_time"][i] - history["dt"][i])
        took = history["dt"][i]
        assert any(abs(took - min(length, left)) <= 1e-6 * MAX_LENGTH for length in lengths), f"attempt {i}: {took}, allowed {lengths}, left {left}"
    assert not history["is_converged"].all(), "some attempts fail"
    assert held >= 1, "what happened never held an increment back"


def test_directions_lead_to_the_same(run: Run, tmp_path: Path) -> None:
    """EXACT, SYMMETRIC and LAGGED converge to the same, since they do not change the residual: to 1e-4, with a residual tolerance of 1e-6 of the forces."""
    found = {}
    for direction in ("EXACT", "SYMMETRIC", "LAGGED"):
        (tmp_path / "job.inp").write_text(ball(0.3, f"AUTO, DIRECTION={direction}", 5))
        done = run(["job"], cwd=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
        history = read_history(tmp_path / "job.vtkhdf")
        assert history["is_converged"][history["increment"] > 0].all(), direction
        found[direction] = (read_field(tmp_path / "job.vtkhdf", "U")[-1], int(history["n_iterations"].sum()))
    u, n = found["EXACT"]
    for direction in ("SYMMETRIC", "LAGGED"):
        assert np.abs(found[direction][0] - u).max() <= 1e-4 * np.abs(u).max(), direction
        assert found[direction][1] > n, f"{direction} takes no more iterations: it is not another direction"


def rolled_plate(first_increment: str) -> str:
    """A clamped plate of 4 x 2 S8, which a pressure rolls up."""
    at = [(i, j) for j in range(5) for i in range(9) if not (i % 2 and j % 2)]
    label = {place: k for k, place in enumerate(at, start=1)}
    deck = "*NODE, NSET=N\n" + "".join(f"{k}, {i / 4}, {j / 4}\n" for (i, j), k in label.items())
    deck += "*ELEMENT, TYPE=S8, ELSET=E\n"
    for e, (i, j) in enumerate([(i, j) for j in (0, 2) for i in (0, 2, 4, 6)], start=1):
        corners = [(i, j), (i + 2, j), (i + 2, j + 2), (i, j + 2), (i + 1, j), (i + 2, j + 1), (i + 1, j + 2), (i, j + 1)]
        deck += f"{e}, " + ", ".join(str(label[place]) for place in corners) + "\n"
    deck += "*MATERIAL, NAME=M\n*ELASTIC\n1.E4, 0.3\n*SHELL SECTION, ELSET=E, MATERIAL=M\n0.05\n*NSET, NSET=END\n"
    deck += ", ".join(str(label[0, j]) for j in range(5)) + f"\n*NSET, NSET=TIP\n{label[8, 2]}\n*BOUNDARY\nEND, 1, 6\n"
    return deck + f"*STEP, NLGEOM, INC=500\n*STATIC\n{first_increment}*DLOAD\nE, P, 8.\n*NODE PRINT, NSET=TIP\nU\n*END STEP\n"


def test_cut_backs_lead_as_far_as_in_calculix(run: Run, tmp_path: Path) -> None:
    """The whole pressure in one increment, as the deck requests, needs six cut-backs, more than CalculiX's five, which cut to a quarter.
    The end is that of small increments, within the loose criteria of the dialect."""
    tips = []
    for first in ("", "0.02, 1., 1e-6, 0.02\n"):
        (tmp_path / "job.inp").write_text(rolled_plate(first))
        done = run(["--dialect=calculix", "job"], cwd=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
        tips.append(np.array(next(iter(read_dat(tmp_path / "job.dat")[-1].rows.values()))))
        n_failed = int(re.findall(r"attempts that failed +(\d+)", done.stdout)[0])
        assert (n_failed > 5) == (first == "")
    assert np.abs(tips[1]).max() > 1.0, "half of the length"
    assert tips[0] == pytest.approx(tips[1], abs=0.01 * np.abs(tips[1]).max())
