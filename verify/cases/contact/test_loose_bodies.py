"""Loose bodies in rows: stacks of blocks and walls of bricks with gaps find their supports, in any number, with friction and a lateral push.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from verify.cases.proof import Case
from verify.decks.loose_bodies import Pile, stack, wall

Proof = Callable[..., Case]
BY_FACES = ", TYPE=SURFACE TO SURFACE"
FORMULATIONS = {"nodes": "", "faces": BY_FACES}


def check_forces(case: Case, pile: Pile, max_iterations: int) -> None:
    """The table carries weight and push; no failed attempt; iterations within the bound."""
    job = case.run(pile.deck, requested=len(pile.blocks))  # what is counted against the limit of a case: a fall for each block
    n_blocks_nodes = sum(len(block.nodes) for block in pile.blocks)
    table = job.last("RF")[n_blocks_nodes:].sum(axis=0)
    case.near("force on the table", table[:2], np.array([-pile.push, pile.weight]), 1e-5, why="equilibrium of all blocks", scale=pile.weight,
              place="foot of the table", time="1")  # fmt: skip
    normal, shear = np.linalg.norm(job.last("CNORMF"), axis=1), np.linalg.norm(job.last("CSHEARF"), axis=1)
    case.within("friction over its limit", float((shear - pile.mu * normal).max() / pile.weight), (-1.0, 1e-6), why="Coulomb", place="all slave nodes", time="1")
    case.true("failed attempts", job.n_failed == 0, why="the search stays in one attempt", place="whole model", time="1")
    case.true(f"iterations: {job.n_iterations} of at most {max_iterations}", job.n_iterations <= max_iterations, why="at most linear in the number of blocks", time="1",
              place="whole model")  # fmt: skip
    case.done()


@pytest.mark.parametrize("formulation", list(FORMULATIONS))
@pytest.mark.parametrize("n_blocks", [2, 4, 8, 12, 20, 30, 40])
def test_stack(proof: Proof, n_blocks: int, formulation: str) -> None:
    """A stack of blocks, each 0.1 above the next."""
    case = proof(
        f"loose-stack-{n_blocks}-{formulation}",
        title=f"A stack of {n_blocks} loose blocks with gaps, contact by {formulation}",
        model=f"{n_blocks} blocks of edge 1 (E = 210000, weight 0.1, 2 x 2 CPE4) one above the other, each 0.1 above the next, over a table; weight and a lateral push "
        "of 0.3 over their number times the weight on each block, in one increment; mu = 0.2, NLGEOM. No block has a support.",
        formula="The table carries all weights and pushes; at no node does friction exceed mu times the pressure.",
        source="statics",
        proves="The search for supports continues as long as bodies come nearer to one: no failed attempt, and at most 3 + 0.7 n iterations for n blocks.",
    )
    check_forces(case, stack(n_blocks, 0.1, options=FORMULATIONS[formulation]), 3 + (7 * n_blocks) // 10)


@pytest.mark.parametrize("formulation", list(FORMULATIONS))
@pytest.mark.parametrize("n", [3, 4])
def test_wall(proof: Proof, n: int, formulation: str) -> None:
    """A wall of bricks with gaps on all sides."""
    case = proof(
        f"loose-wall-{n}-{formulation}",
        title=f"A wall of {n} by {n} loose bricks with gaps, contact by {formulation}",
        model=f"{n} rows of {n} bricks 2 by 1 in running bond (every second row with half bricks at its ends), 0.1 apart on all sides; E = 210000, weight 0.1 per "
        "area, 2 CPE4 per length 1; weight and a lateral push of 0.05 times the weight on each brick, in one increment; mu = 0.2, NLGEOM. No brick has a support.",
        formula="The table carries all weights and pushes; at no node does friction exceed mu times the pressure.",
        source="statics",
        proves="Bodies that find support on two others and beside others.",
    )
    check_forces(case, wall(n, n, 0.1, options=FORMULATIONS[formulation]), 4 * n)
