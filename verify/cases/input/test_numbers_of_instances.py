"""Numbers of nodes and elements that an instance does not have are errors, as the user wrote them, and never those of the next instance.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import pytest

from verify.conftest import Run

NODES = "".join(f"{i}, {x}., {y}., {z}.\n" for i, (x, y, z) in enumerate([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], 1))
DECK = f"""*PART, NAME=P
*NODE
{NODES}*ELEMENT, TYPE=C3D8, ELSET=E
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=FIX, GENERATE
1, 4
*SOLID SECTION, ELSET=E, MATERIAL=M
*END PART
*PART, NAME=Q
*NODE
{NODES}*ELEMENT, TYPE=C3D8, ELSET=E
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=FIX
1, 2, 3, 4
*SOLID SECTION, ELSET=E, MATERIAL=M
*END PART
*ASSEMBLY, NAME=Z
*INSTANCE, NAME=A, PART=P
*END INSTANCE
*INSTANCE, NAME=B, PART=Q
5., 0., 0.
*END INSTANCE
*NSET, NSET=END, INSTANCE=A
7
*END ASSEMBLY
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*BOUNDARY
A.FIX, 1, 3
B.FIX, 1, 3
*STEP
*STATIC
*CLOAD
B.7, 1, 1.
*NODE PRINT, NSET=A.FIX
U
*END STEP
"""


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("1, 1, 2, 3, 4, 5, 6, 7, 8\n*NSET, NSET=FIX, GENERATE", "1, 1, 2, 3, 4, 5, 6, 7, 9\n*NSET, NSET=FIX, GENERATE", "it is 'A.9'"),
        ("*NSET, NSET=END, INSTANCE=A\n7", "*NSET, NSET=END, INSTANCE=A\n10", "There is no node set 'A.10'"),
        ("B.7, 1, 1.", "B.9, 1, 1.", "There is no node or node set 'B.9'"),
        ("B.7, 1, 1.", "A.12, 1, 1.", "There is no node or node set 'A.12'"),
        ("*NSET, NSET=FIX, GENERATE\n1, 4", "*ELSET, ELSET=X\n2\n*NSET, NSET=FIX, GENERATE\n1, 4", "There is no element set 'A.2'"),
    ],
)
def test_numbers_that_are_not_there(run_deck: Run, old: str, new: str, words: str) -> None:
    """In elements, sets, loads: 9 of A was node 1 of B."""
    assert DECK.count(old) == 1
    done = run_deck(DECK.replace(old, new), "--check")
    assert done.returncode == 3, done.stdout + done.stderr
    assert words in " ".join((done.stdout + done.stderr).split())


def test_range_ends_with_its_instance(run_deck: Run) -> None:
    """GENERATE skips numbers that are not there, also those that the next instance has: 8 nodes of 20."""
    done = run_deck(DECK.replace("GENERATE\n1, 4", "GENERATE\n1, 20"), "--check")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "36 prescribed in step 1" in done.stdout, "8 of A, 4 of B"
