"""Contact decks of our own, run by CalculiX and by Amontons, compared block by block.

A block stands on a wider one whose faces do not match; its top is pressed down and then moved along. The generator takes element,
formulation, law, friction and the rest from lists, so that each value of each list is met, in an order given by a fixed seed. Without
CalculiX (`ccx`) on the path the tests are skipped.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os
import random
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest

from verify.readers.dat_frd_files import Deviation, compare, read_dat

HEX = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1), (0, -1, -1), (1, 0, -1), (0, 1, -1),
       (-1, 0, -1), (0, -1, 1), (1, 0, 1), (0, 1, 1), (-1, 0, 1), (-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
SQUARE = [(-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0)]
# A cube in six tetrahedra around the diagonal 1-7.
TETS = [(1, 2, 3, 7), (1, 3, 4, 7), (1, 4, 8, 7), (1, 8, 5, 7), (1, 5, 6, 7), (1, 6, 2, 7)]

LAWS = {
    "linear": "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n2.E5, 1.\n",
    "hard": "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n",
    "exponential": "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL\n1.E-3, 2.\n",
    "tabular": "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n10., 1.E-4\n100., 5.E-4\n1000., 2.E-3\n",
    "tied": "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED\n1.E5\n*FRICTION\n1.E30, 5.E4\n",
}


@dataclass
class Job:
    """What a deck has."""

    kind: str = "C3D8"
    pair: str = "SURFACE TO SURFACE"
    law: str = "linear"
    friction: bool = False
    nlgeom: bool = False
    gap: float = 0.0
    option: str = ""  # ADJUST, CLEARANCE, SMALL SLIDING, MODEL CHANGE
    increments: int = 1
    slide: float = 0.0

    @property
    def name(self) -> str:
        """For the table."""
        words = [self.kind, "s2s" if self.pair.startswith("S") else "n2s", self.law, "friction" if self.friction else "", "nlgeom" if self.nlgeom else "",
                 self.option.split("=")[0].lower().replace(" ", "_"), f"{self.increments}inc"]
        return "-".join(w for w in words if w)


@dataclass
class Mesh:
    """Nodes, elements and the faces of the two surfaces."""

    kind: str
    nodes: dict[tuple[float, ...], int] = field(default_factory=dict)
    elements: list[list[int]] = field(default_factory=list)

    @property
    def is_plane(self) -> bool:
        """Whether it is of plane or axisymmetric elements."""
        return self.kind[:2] == "CP" or self.kind[:3] == "CAX"

    def node(self, body: int, x: np.ndarray) -> int:
        """The node of a body at a place."""
        return self.nodes.setdefault((body, *(round(float(v), 9) for v in x)), len(self.nodes) + 1)

    def block(self, body: int, low: tuple[float, ...], high: tuple[float, ...], n: tuple[int, ...]) -> None:
        """A block of cells."""
        dims = 2 if self.is_plane else 3
        low, high, n = (tuple(v[:1]) + tuple(v[2:]) if dims == 2 else v for v in (low, high, n))
        size = [(b - a) / k for a, b, k in zip(low, high, n, strict=True)]
        for place in np.ndindex(*n[::-1]):
            middle = np.array([a + (p + 0.5) * s for a, p, s in zip(low, place[::-1], size, strict=True)])
            order = int("".join(c for c in self.kind.split("D")[-1] if c.isdigit()) or 0) if dims == 3 else int(self.kind[3])
            if order in (4, 10) and dims == 3:
                for tet in TETS:
                    points = [np.array(HEX[k - 1], float) for k in tet]
                    if order == 10:
                        points += [(points[a] + points[b]) / 2 for a, b in ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))]
                    self.elements.append([self.node(body, middle + 0.5 * p * np.array(size)) for p in points])
            else:
                shape = SQUARE if dims == 2 else HEX
                self.elements.append([self.node(body, middle + 0.5 * np.array(c) * np.array(size)) for c in shape[:order]])

    def surface(self, body: int, value: float) -> list[str]:
        """The faces of a body on the plane x_last = value, as rows of SURFACE."""
        on = {k for x, k in self.nodes.items() if x[0] == body and abs(x[-1] - value) < 1e-8}
        rows = []
        for e, ids in enumerate(self.elements, 1):
            if self.is_plane:
                sides = {1: (0, 1), 2: (1, 2), 3: (2, 3), 4: (3, 0)}
            elif self.kind in ("C3D4", "C3D10"):
                sides = {1: (0, 1, 2), 2: (0, 3, 1), 3: (1, 3, 2), 4: (2, 3, 0)}
            else:
                sides = {1: (0, 1, 2, 3), 2: (4, 5, 6, 7)}
            rows += [f"{e}, S{f}" for f, side in sides.items() if all(ids[k] in on for k in side)]
        return rows

    def on(self, body: int, value: float) -> list[int]:
        """The nodes of a body on the plane x_last = value."""
        return [k for x, k in self.nodes.items() if x[0] == body and abs(x[-1] - value) < 1e-8]


def rows_of(numbers: list[int]) -> str:
    """Numbers in rows."""
    return "".join(", ".join(map(str, numbers[i: i + 10])) + "\n" for i in range(0, len(numbers), 10))


def deck(job: Job) -> str:
    """The input of a job."""
    mesh = Mesh(job.kind)
    x0 = 1.0 if job.kind.startswith("CAX") else 0.0
    mesh.block(1, (x0 - 0.2, -0.3, -0.6), (x0 + 1.5, 1.4, 0.0), (4, 4, 2))
    mesh.block(2, (x0, 0.0, job.gap), (x0 + 1.0, 1.0, 0.5 + job.gap), (3, 3, 2))
    top, floor = mesh.on(2, 0.5 + job.gap), mesh.on(1, -0.6)
    text = "** dialect: calculix\n*NODE, NSET=NALL\n"
    for x, k in mesh.nodes.items():
        text += ", ".join([str(k), *(f"{v:.9g}" for v in x[1:])] + (["0."] if mesh.is_plane else [])) + "\n"
    text += f"*ELEMENT, TYPE={job.kind}, ELSET=EALL\n"
    for e, ids in enumerate(mesh.elements, 1):
        words = [str(v) for v in [e, *ids]]
        text += ", ".join(words[:16]) + (",\n" + ", ".join(words[16:]) if len(words) > 16 else "") + "\n"
    up = 2 if mesh.is_plane else 3
    text += f"*NSET, NSET=TOP\n{rows_of(top)}*NSET, NSET=FLOOR\n{rows_of(floor)}"
    text += "*MATERIAL, NAME=EL\n*ELASTIC\n1.E4, .3\n*SOLID SECTION, ELSET=EALL, MATERIAL=EL\n" + ("1.,\n" if mesh.is_plane else "")
    text += "*SURFACE, NAME=SM\n" + "\n".join(mesh.surface(1, 0.0)) + "\n*SURFACE, NAME=SS\n" + "\n".join(mesh.surface(2, job.gap)) + "\n"
    text += "*SURFACE INTERACTION, NAME=SI\n" + LAWS[job.law] + ("*FRICTION\n.3, 2.E4\n" if job.friction and job.law != "tied" else "")
    on_pair = ", " + job.option if job.option.startswith(("ADJUST", "SMALL")) else ""
    text += f"*CONTACT PAIR, INTERACTION=SI, TYPE={job.pair}{on_pair}\nSS, SM\n"
    if job.option.startswith("CLEARANCE"):
        text += "*CLEARANCE, SLAVE=SS, MASTER=SM, VALUE=-5.E-4\n"
    text += f"*BOUNDARY\nFLOOR, 1, {up}\n"
    nlgeom = ", NLGEOM" if job.nlgeom else ""
    prints = "*NODE PRINT, NSET=NALL\nU\n*NODE PRINT, NSET=TOP, TOTALS=ONLY\nRF\n*CONTACT PRINT\nCDIS, CSTR\n"
    time = f"*STATIC, DIRECT\n{1 / job.increments:.12g}, 1.\n"
    change = "*MODEL CHANGE, TYPE=CONTACT PAIR, {}\nSS, SM\n"
    if job.option == "MODEL CHANGE":
        text += f"*STEP{nlgeom}\n*STATIC, DIRECT\n1., 1.\n{change.format('REMOVE')}*BOUNDARY\nTOP, 1, {up}\n*END STEP\n"
    text += f"*STEP{nlgeom}\n{time}{change.format('ADD') if job.option == 'MODEL CHANGE' else ''}"
    text += f"*BOUNDARY\nTOP, 1, {up - 1}\nTOP, {up}, {up}, {-2e-3 - job.gap:.9g}\n{prints}*END STEP\n"
    if job.slide > 0:
        text += f"*STEP{nlgeom}\n{time}*BOUNDARY\nTOP, 1, 1, {job.slide}\n{prints}*END STEP\n"
    return text


def jobs() -> list[Job]:
    """The decks: a few by hand, then others whose values come from a fixed seed."""
    base = Job()
    chance = random.Random(20)
    found = [replace(base, law=law, pair=pair) for law in LAWS for pair in ("SURFACE TO SURFACE", "NODE TO SURFACE")]
    found = [job for job in found if (job.law, job.pair[0]) not in (("tabular", "S"), ("tied", "N"))]  # CalculiX 2.20: no force, and an error
    found += [replace(base, kind=kind, pair=pair) for kind in ("C3D20", "C3D10", "C3D4", "CPE4", "CPE8", "CAX4", "CAX8")
              for pair in ("SURFACE TO SURFACE", "NODE TO SURFACE")]
    found += [replace(base, friction=True, slide=1e-3, increments=4, pair=pair, nlgeom=nlgeom) for pair in ("SURFACE TO SURFACE", "NODE TO SURFACE")
              for nlgeom in (False, True)]
    found += [replace(base, option=option, gap=gap, pair=pair) for option, gap in
              (("ADJUST=0.002", 1e-3), ("CLEARANCE", 1e-3), ("SMALL SLIDING", 0.0), ("MODEL CHANGE", -1e-3)) for pair in ("SURFACE TO SURFACE", "NODE TO SURFACE")]
    for pair in ("SURFACE TO SURFACE", "NODE TO SURFACE"):
        found += [replace(base, pair=pair, gap=-1e-3, increments=3, nlgeom=True), replace(base, pair=pair, nlgeom=True, friction=True, slide=0.03, increments=10)]
    found += [replace(base, law="tied", gap=gap, nlgeom=True, increments=2, slide=1e-3) for gap in (1e-4, -1e-4)]
    found.append(replace(base, option="MODEL CHANGE", gap=-1e-3, nlgeom=True, increments=4, friction=True, slide=1e-3))
    for _ in range(10):
        kind = chance.choice(["C3D8", "C3D20", "C3D10", "C3D4", "CPE4", "CAX8", "CPE8"])
        found.append(Job(kind, chance.choice(["SURFACE TO SURFACE", "NODE TO SURFACE"]), chance.choice(list(LAWS)), chance.random() < 0.6, chance.random() < 0.5,
                         0.0, "", chance.choice([1, 3, 5]), chance.choice([0.0, 5e-4, 5e-3])))
    return found


def run_peer(text: str, folder: Path) -> Path | None:
    """CalculiX on a deck; its .dat file, None if it did not finish."""
    (folder / "peer.inp").write_text(text)
    done = subprocess.run(["ccx", "peer"], cwd=folder, capture_output=True, text=True, timeout=120, env=dict(os.environ, OMP_NUM_THREADS="1"), check=False)
    return folder / "peer.dat" if done.returncode == 0 and "Job finished" in done.stdout else None


def listed(deviations: list[Deviation]) -> str:
    """All blocks, a line each."""
    return "\n".join(f"{100 * d.deviation:9.4f} %  {d.title} {d.set_name} t={d.time:g} of {d.largest:.3e} at {d.where}" for d in deviations)


def parameters() -> list[object]:
    """One test for each job; most of them are slow."""
    return [pytest.param(job, id=f"{k:02d}-{job.name}", marks=[] if k % 4 == 0 else [pytest.mark.slow]) for k, job in enumerate(jobs())]


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
@pytest.mark.parametrize("job", parameters())
def test_contact(job: Job, run: Callable[..., object], tmp_path: Path) -> None:
    """Every block is within 1 % of its largest value."""
    text = deck(job)
    peer = run_peer(text, tmp_path)
    if peer is None:
        pytest.skip("CalculiX does not finish")
    (tmp_path / "ours.inp").write_text(text)
    done = run(["ours.inp"], cwd=tmp_path)
    assert done.returncode == 0, (done.stdout + done.stderr)[-1500:]
    is_plane = job.kind.startswith(("CP", "CAX"))
    # CalculiX prints the forces of a wedge of two degrees, and slave nodes of plane elements by the numbers of the solids that it makes.
    blocks = [b for b in read_dat(peer) if not (b.title.startswith("total force") and job.kind.startswith("CAX"))
              and not (is_plane and "slave node" in b.head)]
    deviations = compare(read_dat(tmp_path / "ours.dat"), blocks, is_plane)
    bad = [d for d in deviations if not d.deviation <= 0.01]
    assert not bad, "\n" + listed(deviations)
