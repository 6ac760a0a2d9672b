"""A lap joint with one bolt against statics: tightened, locked, sheared below and beyond its slip force, pried open.

Two plates on each other with a hole each, a bolt through them that touches under head and nut and, when it has slipped, at the
holes: five pairs with friction, in which nodes at the edges of the shank are slaves of several. All with default settings.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.make_decks import Mesh, block
from verify.decks.solids import FACES, Solids, as_kind, node_set
from verify.readers.sta_cvg_files import read_sta

MU, TENSION = 0.2, 20000.0
SHANK, HOLE, HEAD, THICK, END = 8.0, 8.5, 13.0, 8.0, 40.0  # half widths, thickness of a plate, where the plates end

Place = tuple[float, float, float]
Test = Callable[[float, float, float], bool]


def part(lines: tuple[list[float], list[float], list[float]], kind: str, is_inside: Test) -> Solids:
    """The cells of a grid whose centres are inside."""
    mesh = block(*lines, "PART")
    elements = mesh.elements[[is_inside(*c) for c in mesh.nodes[mesh.elements].mean(axis=1)]]
    used, places = np.unique(elements, return_inverse=True)
    return as_kind(Mesh(mesh.nodes[used], places.reshape(elements.shape)), kind)


def around_hole(low: float, high: float) -> list[float]:
    """Lines of a plate along one direction: two cells across the hole, two or three beside it."""
    left = np.linspace(low, -HOLE, 4 if low < -20 else 3)
    right = np.linspace(HOLE, high, 4 if high > 20 else 3)
    return sorted({*left, 0.0, *right})


def is_near(a: float, b: float) -> bool:
    """Equal but for rounding."""
    return abs(a - b) < 1e-6


class Joint:
    """Nodes and elements of the three bodies, with what the deck says of them."""

    def __init__(self, kind: str) -> None:
        across = around_hole(-16.0, 16.0)
        shank = [-HEAD, -SHANK, 0.0, SHANK, HEAD]

        def in_plate(x: float, y: float, _z: float) -> bool:
            return max(abs(x), abs(y)) > HOLE

        def in_bolt(x: float, y: float, z: float) -> bool:
            return abs(z) > THICK or max(abs(x), abs(y)) < SHANK

        bodies = {
            "LOWER": part((around_hole(-END, 16.0), across, [-THICK, -THICK / 2, 0.0]), kind, in_plate),
            "UPPER": part((around_hole(-16.0, END), across, [0.0, THICK / 2, THICK]), kind, in_plate),
            "BOLT": part((shank, shank, [-13.0, -THICK, -THICK / 2, 0.0, THICK / 2, THICK, 13.0]), kind, in_bolt),
        }
        self.kind = kind
        self.nodes = np.concatenate([body.nodes for body in bodies.values()])
        self.elements: dict[str, list[tuple[int, np.ndarray]]] = {}
        first_node = first_element = 0
        for name, body in bodies.items():
            rows = np.asarray(body.elements) + first_node
            self.elements[name] = [(first_element + k, row) for k, row in enumerate(rows)]
            first_node += len(body.nodes)
            first_element += len(rows)

    def surface(self, name: str, body: str, test: Test, *, of_cut: bool = False) -> str:
        """The outer faces of a body at a place; of a cut the inner faces, those of the elements above it."""
        faces: dict[frozenset[int], list[tuple[int, int]]] = {}
        for element, row in self.elements[body]:
            for face, local in enumerate(FACES[self.kind], start=1):
                if all(test(*self.nodes[n]) for n in row[list(local)]):
                    faces.setdefault(frozenset(row[list(local)]), []).append((element, face))
        above = {e for e, row in self.elements[body] if self.nodes[row][:, 2].mean() > 0}
        rows = [f for shared in faces.values() for f in shared if (f[0] in above if of_cut else len(shared) == 1)]
        assert rows, name
        return f"*SURFACE, NAME={name}\n" + "".join(f"{e + 1}, S{f}\n" for e, f in rows)

    def cards(self) -> str:
        """The mesh and its surfaces."""

        def flat(z: float) -> Test:
            return lambda _x, _y, at: is_near(at, z)

        def wall(half: float) -> Test:
            return lambda x, y, z: is_near(max(abs(x), abs(y)), half) and abs(z) < THICK + 0.1

        text = "*NODE, NSET=NALL\n" + "".join(f"{i}, {x:.9g}, {y:.9g}, {z:.9g}\n" for i, (x, y, z) in enumerate(self.nodes, 1))
        for name, rows in self.elements.items():
            text += f"*ELEMENT, TYPE={self.kind}, ELSET={name}\n"
            text += "".join(f"{e + 1}, " + ", ".join(str(n + 1) for n in row) + "\n" for e, row in rows)
        text += "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n"
        text += "".join(f"*SOLID SECTION, ELSET={name}, MATERIAL=STEEL\n" for name in self.elements)
        return (
            text + self.surface("SEAM", "LOWER", flat(0.0)) + self.surface("UNDER", "UPPER", flat(0.0))
            + self.surface("BASE", "LOWER", flat(-THICK)) + self.surface("TOP", "UPPER", flat(THICK))
            + self.surface("HEAD", "BOLT", flat(THICK)) + self.surface("NUT", "BOLT", flat(-THICK))
            + self.surface("SHANK", "BOLT", wall(SHANK)) + self.surface("HOLE1", "LOWER", wall(HOLE))
            + self.surface("HOLE2", "UPPER", wall(HOLE)) + self.surface("CUT", "BOLT", flat(0.0), of_cut=True)
        )  # fmt: skip


def joint_deck(kind: str, form: str, load: Callable[[int], str]) -> str:
    """Tightened in step 1; in step 2 locked and loaded; `load` has the cards for so many nodes at the end of the upper plate."""
    joint = Joint(kind)
    pilot = len(joint.nodes) + 1
    pull = np.flatnonzero(np.isclose(joint.nodes[:, 0], END))
    pairs = [("UNDER", "SEAM"), ("HEAD", "TOP"), ("NUT", "BASE"), ("SHANK", "HOLE1"), ("SHANK", "HOLE2")]
    step = "*STEP, NLGEOM, INC=100\n*STATIC\n"
    output = "*NODE PRINT, NSET=PILOT\nU, RF\n*NODE PRINT, NSET=PULL, TOTALS=ONLY\nRF\n*NODE PRINT, NSET=FIX, TOTALS=ONLY\nRF\n"
    return (
        joint.cards() + f"*NODE, NSET=PILOT\n{pilot}, 0., 0., 0.\n*PRE-TENSION SECTION, SURFACE=CUT, NODE={pilot}\n"
        + node_set("FIX", np.flatnonzero(np.isclose(joint.nodes[:, 0], -END))) + node_set("PULL", pull)
        + f"*SURFACE INTERACTION, NAME=DRY\n*FRICTION\n{MU}\n"
        + "".join(f"*CONTACT PAIR, INTERACTION=DRY{form}\n{slave}, {master}\n" for slave, master in pairs)
        + f"{step}0.5, 1.\n*BOUNDARY\nFIX, 1, 3\nPULL, 2, 2\n*CLOAD\nPILOT, 1, {TENSION}\n{output}*END STEP\n"
        + f"{step}0.25, 1.\n*BOUNDARY, FIXED\nPILOT, 1\n*CLOAD\n{load(len(pull))}*END STEP\n"
    )  # fmt: skip


def blocks(folder: Path, title: str, name: str) -> list[list[float]]:
    """The last row of each block of a title for a set."""
    found: list[list[float]] = []
    is_inside = False
    for line in (folder / "job.dat").read_text().splitlines():
        if " for set " in line:
            is_inside = title in line and f"set {name} " in line
        elif is_inside and (words := re.findall(r"-?\d\.\d+E[+-]\d+", line)):
            found.append([float(word) for word in words])
            is_inside = False
    return found


def effort(folder: Path) -> tuple[int, int, int]:
    """Increments, attempts that failed, and Newton iterations of all attempts."""
    attempts = read_sta(folder / "job.sta")
    failed = sum(attempt.is_failed for attempt in attempts)
    return len(attempts) - failed, failed, sum(attempt.iterations for attempt in attempts)


FORMS = pytest.mark.parametrize("form", ["", ", TYPE=SURFACE TO SURFACE"], ids=["node to surface", "surface to surface"])


@FORMS
@pytest.mark.parametrize("kind", ["C3D8", "C3D8I"])
@pytest.mark.parametrize("direction", [1, 3])
def test_operating_load(run_deck: Run, tmp_path: Path, kind: str, form: str, direction: int) -> None:
    """Sheared by three quarters of the slip force of the seam, or pried at the end: the support takes the load, the bolt is tightened to the
    prescribed force. Three iterations in each increment are enough."""
    force = (0.75 * MU * TENSION, 0.0, 1500.0)[direction - 1]
    done = run_deck(joint_deck(kind, form, lambda n: f"PULL, {direction}, {force / n}\n"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Swap slave and master" not in done.stdout + done.stderr
    increments, failed, iterations = effort(tmp_path)
    assert failed == 0
    assert iterations <= 3 * increments
    support = blocks(tmp_path, "total force", "FIX")[-1]
    assert support[direction - 1] == pytest.approx(-force, rel=1e-5)
    overlaps = [row[0] for row in blocks(tmp_path, "displacements", "PILOT")]
    assert overlaps[1] > 0.0
    assert overlaps[-1] == pytest.approx(overlaps[1], rel=1e-9)


@pytest.mark.parametrize(("kind", "form"), [
    ("C3D8", ""),
    ("C3D8", ", TYPE=SURFACE TO SURFACE"),
    pytest.param("C3D10", ", TYPE=SURFACE TO SURFACE", marks=pytest.mark.slow),
])  # fmt: skip
def test_slips_into_bearing(run_deck: Run, tmp_path: Path, kind: str, form: str) -> None:
    """Dragged by more than the clearance of both holes. Before the bolt bears, the seam and the path over head, bolt and nut each transmit mu times the
    force in the bolt. In bearing they transmit more; the support takes the applied force."""
    done = run_deck(joint_deck(kind, form, lambda _n: "*BOUNDARY\nPULL, 1, 1, 1.4\n"))
    assert done.returncode == 0, done.stdout + done.stderr
    increments, failed, iterations = effort(tmp_path)
    assert failed <= 1  # one edge of the shank may meet its hole first
    assert iterations <= 4 * increments
    pulls = [row[0] for row in blocks(tmp_path, "total force", "PULL")]
    tension = [TENSION + row[0] for row in blocks(tmp_path, " forces (", "PILOT")]  # the pilot is held beside its load
    for k in (2, 3):  # 0.35 and 0.7 of 1.4
        assert pulls[k] == pytest.approx(2.0 * MU * tension[k], rel=2e-3)
    assert pulls[-1] > 4.0 * pulls[2]
    assert blocks(tmp_path, "total force", "FIX")[-1][0] == pytest.approx(-pulls[-1], rel=1e-5)
