"""Contact at random, of every shape and element kind, with all controls as they are: it finishes without tuning.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "study"))

from random_contact import run  # noqa: E402

SEEDS = range(1, 31)
MOST_FAILED = 2  # attempts of all jobs: one of them drags in one increment
MOST_PER_INCREMENT = 3.0  # iterations, failed attempts included


def test_random_contact_finishes(program: Path, tmp_path: Path) -> None:
    """Bodies that are led along a table: each of these jobs has a balance in each increment."""
    outcomes = [run(seed, program, tmp_path) for seed in SEEDS]
    assert [o.told for o in outcomes if o.code != 0] == []
    assert sum(o.failed for o in outcomes) <= MOST_FAILED
    assert sum(o.iterations for o in outcomes) <= MOST_PER_INCREMENT * sum(o.increments for o in outcomes)
