"""Springs with laws of their own and gaps: one node on springs, whose displacement is written down at once.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from verify.conftest import Run

DIGITS = 2e-6  # seven digits are printed
TABLE = "-10., -.1\n0., 0.\n10., .1\n30., .2\n"


def displacement(folder: Path) -> list[float]:
    """The last row of job.dat."""
    return [float(word) for word in (folder / "job.dat").read_text().split("\n\n")[-1].split()[1:]]


def deck_of(elements: str, held: str, load: str, more: str = "") -> str:
    """Node 1 is fixed, node 2 is loaded; the controls request more digits than are compared."""
    return f"""** dialect: calculix
*NODE
1, 0., 0., 0.
2, 1., 0., 0.
*NSET, NSET=N
2
{elements}*BOUNDARY
1, 1, 3
{held}
{more}*STEP
*STATIC
1., 1.
*CONTROLS, PARAMETERS=FIELD
1e-9, 1e-9
*CLOAD
{load}
*NODE PRINT, NSET=N
U
*END STEP
"""


@pytest.mark.parametrize("kind", ["SPRINGA", "SPRING1", "SPRING2"])
@pytest.mark.parametrize(("force", "expected"), [(20.0, 0.15), (5.0, 0.05), (-7.0, -0.07)])
def test_tables(run_deck: Run, tmp_path: Path, kind: str, force: float, expected: float) -> None:
    """Force over elongation, linear in between."""
    nodes, directions = {"SPRINGA": ("1, 2", ""), "SPRING1": ("2", "1\n"), "SPRING2": ("2, 1", "1, 1\n")}[kind]
    elements = f"*ELEMENT, TYPE={kind}, ELSET=E\n1, {nodes}\n*SPRING, ELSET=E, NONLINEAR\n{directions}{TABLE}"
    done = run_deck(deck_of(elements, "2, 2, 3", f"2, 1, {force}"))
    assert done.returncode == 0, done.stdout
    assert displacement(tmp_path)[0] == pytest.approx(expected, rel=DIGITS)


@pytest.mark.parametrize(("words", "data", "expected"), [
    ("", "100., , 0.\n200., , 100.\n", 6.0 / 150.0),
    (", NONLINEAR", "0., 0., 0.\n100., 1., 0.\n0., 0., 100.\n200., 1., 100.\n", 6.0 / 150.0),
    ("", "100.\n", 6.0 / 100.0),
])  # fmt: skip
def test_temperature(run_deck: Run, tmp_path: Path, words: str, data: str, expected: float) -> None:
    """Constant and table at 50 degrees lie in the middle."""
    elements = f"*ELEMENT, TYPE=SPRINGA, ELSET=E\n1, 1, 2\n*SPRING, ELSET=E{words}\n{data}"
    warm = "*INITIAL CONDITIONS, TYPE=TEMPERATURE\n1, 50.\n2, 50.\n"
    done = run_deck(deck_of(elements, "2, 2, 3", "2, 1, 6.", warm))
    assert done.returncode == 0, done.stdout
    assert displacement(tmp_path)[0] == pytest.approx(expected, rel=DIGITS)


def test_orientation(run_deck: Run, tmp_path: Path) -> None:
    """Two springs along axes turned by 45 degrees: (F/2)(1/k1 + 1/k2) along the force, (F/2)(1/k1 - 1/k2) across."""
    elements = """*ORIENTATION, NAME=TURNED
1., 1., 0., -1., 1., 0.
*ELEMENT, TYPE=SPRING1, ELSET=A
1, 2
*ELEMENT, TYPE=SPRING1, ELSET=B
2, 2
*SPRING, ELSET=A, ORIENTATION=TURNED
1
100.
*SPRING, ELSET=B, ORIENTATION=TURNED
2
400.
"""
    done = run_deck(deck_of(elements, "2, 3", "2, 1, 8."))
    assert done.returncode == 0, done.stdout
    u = displacement(tmp_path)
    assert u[0] == pytest.approx(4.0 * (1 / 100.0 + 1 / 400.0), rel=DIGITS)
    assert u[1] == pytest.approx(4.0 * (1 / 100.0 - 1 / 400.0), rel=DIGITS)


@pytest.mark.parametrize(("data", "axis"), [(".1, 1., 0., 0., , 1000., 1e-3", "1, 0, 0"), (".1, , , , , 1000.", "1, 0, 0"),
                                            (".1, .6, .8, 0., , 1000., 1e-3", ".6, .8, 0")])  # fmt: skip
@pytest.mark.parametrize(("force", "is_closed"), [(-20.0, True), (5.0, False)])
def test_gap(run_deck: Run, tmp_path: Path, data: str, axis: str, force: float, is_closed: bool) -> None:
    """A spring of 100 along the gap: closed, 100 u + 1000 (u + 0.1) = F - p; open, 100 u = F - p, p the pull of an open gap.

    The law k d (1/2 + atan(d/eps)/pi) with eps = pi p / k differs from these lines by p eps/(pi d) at most, 1e-9 here.
    """
    n = [float(word) for word in axis.split(",")]
    x, y = n[0], n[1]
    elements = f"""*ORIENTATION, NAME=ALONG
{axis}, {-y}, {x}, 0.
*ELEMENT, TYPE=SPRING1, ELSET=A
1, 2
*ELEMENT, TYPE=SPRING1, ELSET=B
2, 2
*ELEMENT, TYPE=GAPUNI, ELSET=G
3, 1, 2
*SPRING, ELSET=A, ORIENTATION=ALONG
1
100.
*SPRING, ELSET=B, ORIENTATION=ALONG
2
100.
*GAP, ELSET=G
{data}
"""
    pull = 1e-3
    done = run_deck(deck_of(elements, "2, 3", f"2, 1, {force * x}\n2, 2, {force * y}"))
    assert done.returncode == 0, done.stdout
    u = displacement(tmp_path)
    expected = (force - 100.0 - pull) / 1100.0 if is_closed else (force - pull) / 100.0
    assert math.isclose(u[0] * x + u[1] * y, expected, rel_tol=1e-5)
    assert abs(u[1] * x - u[0] * y) < 1e-7


@pytest.mark.parametrize(("card", "message"), [
    ("*SPRING, ELSET=E, NONLINEAR\n", "data are missing"),
    ("*SPRING, ELSET=E, NONLINEAR\n0., 0.\n1., 0.\n", "elongations of a spring must ascend"),
    ("*SPRING, ELSET=E, NONLINEAR\n0., 0., 5.\n1., 0., 2.\n", "temperatures of a spring must ascend"),
    ("*SPRING, ELSET=E\n1., , 5.\n1., , 2.\n", "temperatures of the spring constants must ascend"),
    ("*GAP, ELSET=E\n.1, 1., 0., 0.\n", "is no gap of type GAPUNI"),
    ("*SPRING, ELSET=E, NONLINEAR\n0., nan\n", "finite number"),
    ("*ELEMENT, TYPE=GAPUNI, ELSET=G\n2, 1, 2\n*SPRING, ELSET=E\n1.\n*GAP, ELSET=G\n", "clearance and direction"),
    ("*ELEMENT, TYPE=GAPUNI, ELSET=G\n2, 1, 2\n*SPRING, ELSET=E\n1.\n*GAP, ELSET=G\n0., 1., 0., 0., , -1.\n", "must be positive"),
    ("*ELEMENT, TYPE=GAPUNI, ELSET=G\n2, 1, 2\n*SPRING, ELSET=E\n1.\n", "no *GAP names a set"),
])  # fmt: skip
def test_refused(run_deck: Run, card: str, message: str) -> None:
    """Messages about wrong cards."""
    done = run_deck(deck_of(f"*ELEMENT, TYPE=SPRINGA, ELSET=E\n1, 1, 2\n{card}", "2, 2, 3", "2, 1, 1."))
    assert done.returncode == 3, done.stdout
    assert message in re.sub(r"\s+", " ", done.stdout + done.stderr)
