"""The cost of reading many constraints grows in proportion to their number.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import resource

import pytest

from verify.conftest import Run

FEW, TIMES = 3000, 4
MAX_GROWTH = 8.0  #: of the processor time for four times as many; linear cost gives 4, quadratic cost 16


def deck(kind: str, n: int) -> str:
    """A chain of trusses through n nodes; beside each a node that a constraint of its own binds."""
    nodes = "".join(f"{i}, {i}., 0., 0.\n{n + i}, {i}., 0., 0.\n" for i in range(1, n + 1))
    bars = "".join(f"{i}, {i}, {i + 1}\n" for i in range(1, n))
    text = f"*NODE, NSET=ALL\n{nodes}*ELEMENT, TYPE=T3D2, ELSET=BAR\n{bars}*NSET, NSET=BESIDE, GENERATE\n{n + 1}, {2 * n}\n"
    text += "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n*SOLID SECTION, ELSET=BAR, MATERIAL=M\n1.\n"
    row = {
        "pin": "*MPC\nPIN, {a}, {b}\n",
        "beam": "*MPC\nBEAM, {a}, {b}\n",
        "equation": "*EQUATION\n2\n{a}, 1, 1., {b}, 1, -1.\n*EQUATION\n2\n{a}, 2, 1., {b}, 2, -1.\n*EQUATION\n2\n{a}, 3, 1., {b}, 3, -1.\n",
    }[kind]
    text += "".join(row.format(a=i, b=n + i) for i in range(1, n + 1))
    return text + f"*BOUNDARY\nBESIDE, 1, {6 if kind == 'beam' else 3}\n*STEP\n*STATIC\n*END STEP\n"


def seconds(run_deck: Run, text: str) -> float:
    """Processor seconds of reading and checking a deck."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = run_deck(text, "--check")
    assert done.returncode == 0, done.stdout + done.stderr
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


@pytest.mark.parametrize("kind", ["pin", "beam", "equation"])
def test_growth(run_deck: Run, kind: str) -> None:
    """*MPC with equations, *MPC with rotation nodes and *EQUATION."""
    few = seconds(run_deck, deck(kind, FEW))
    many = seconds(run_deck, deck(kind, TIMES * FEW))
    assert many < MAX_GROWTH * few, f"{few:.2f} s for {FEW}, {many:.2f} s for {TIMES * FEW}"
