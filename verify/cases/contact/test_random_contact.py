"""Contact at random, of every shape and element kind, with all controls as they are: it finishes without tuning.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

from verify.study.random_contact import run

SEEDS = range(1, 31)
MAX_BY_LAWS = 2.0  # iterations per increment of surfaces that give
MAX_FAILED = 2  # attempts of all jobs: one of them drags in one increment
MAX_PER_INCREMENT = 3.0  # iterations, failed attempts included


def test_random_contact_finishes(program: Path, tmp_path: Path) -> None:
    """Bodies that are guided along a table: each of these jobs has an equilibrium in each increment."""
    outcomes = [run(seed, program, tmp_path) for seed in SEEDS]
    assert [o.description for o in outcomes if o.code != 0] == []
    assert sum(o.failed for o in outcomes) <= MAX_FAILED
    assert sum(o.iterations for o in outcomes) <= MAX_PER_INCREMENT * sum(o.increments for o in outcomes)


def test_random_laws_finish(program: Path, tmp_path: Path) -> None:
    """The same with surfaces that give, by laws from one to 100000 times the stiffness of an element, in both dialects."""
    outcomes = [run(seed, program, tmp_path, has_law=True) for seed in SEEDS]
    assert [o.description for o in outcomes if o.code != 0] == []
    assert sum(o.failed for o in outcomes) <= MAX_FAILED
    assert sum(o.iterations for o in outcomes) <= MAX_BY_LAWS * sum(o.increments for o in outcomes)
