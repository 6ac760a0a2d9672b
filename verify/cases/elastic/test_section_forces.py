"""Section forces and rotations of shells and beams: tables and fields against statics and beam theory.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from verify.cases.proof import Case, Job
from verify.decks.beams import MODULUS, RATIO, beam, circle, rectangle
from verify.decks.shells import Floats, held, section, shell
from verify.readers.dat_frd_files import read_dat

Proof = Callable[..., Case]
TABLES = "*NODE PRINT, NSET=N\nUR\n*EL PRINT, ELSET=E\nSF, SM\n"


def table(job: Job, title: str) -> dict[int, Floats]:
    """The rows of the last table with a title, by label."""
    block = [block for block in read_dat(job.path.with_suffix(".dat")) if block.title.startswith(title)][-1]
    return {key[0]: np.array(values) for key, values in block.rows.items()}


@pytest.mark.parametrize("kind", ["S3", "S4", "S6", "S8", "S8R"])
def test_strip(proof: Proof, kind: str) -> None:
    """A strip of a plate that is pulled, sheared across and bent."""
    case = proof(
        f"section-forces-strip-{kind.lower()}",
        title=f"Section forces of a strip of {kind}",
        model="A strip 8 x 1 x 0.2 of 8 x 1 cells, E = 2.1e5, nu = 0, clamped at x = 0; per length of the other end: a force 3 along x, a force 2 along z, a moment 5 about y.",
        formula="SF1 = 3, SF4 = 2, SM1 = 5 - 2 (8 - x) at the middle of an element; UR2 = (5 8 - 2 8^2/2)/(E I) at the free end, the others zero.",
        source="statics and beam theory",
        proves="Signs, local axes and reference of section forces of shells; rotations of nodes.",
    )
    mesh = shell(kind, (8, 1), lambda u, v: (8 * u, v, 0 * u))
    end = mesh.edge_weights(0, 1.0).items()
    loads = "".join(f"{i + 1}, 1, {3 * w:.15g}\n{i + 1}, 3, {2 * w:.15g}\n{i + 1}, 5, {5 * w:.15g}\n" for i, w in end)
    deck = mesh.cards() + section(210000.0, 0.0, 0.2) + held(mesh.where(0, 0.0), "ENCASTRE")
    job = case.run(deck + f"*STEP\n*STATIC\n*CLOAD\n{loads}{TABLES}*END STEP\n", "the strip")
    forces, moments = table(job, "section forces"), table(job, "section moments")
    labels = sorted(forces)
    middle = np.array([mesh.nodes[mesh.elements[label - 1], 0][: 3 if kind in ("S3", "S6") else 4].mean() for label in labels])
    found = np.array([np.r_[forces[label], moments[label]] for label in labels])
    if kind in ("S3", "S6"):  # the two triangles of a cell share its force
        found, middle = (found[0::2] + found[1::2]) / 2, (middle[0::2] + middle[1::2]) / 2
    inner = (middle > 1) & (middle < 7)
    zero = np.zeros(inner.sum())
    wanted = np.stack([zero + 3, zero, zero, zero + 2, zero, zero, 5 - 2 * (8 - middle[inner]), zero, zero], axis=1)
    case.near("SF1, SF2, SF3", found[inner, :3], wanted[:, :3], 1e-4 if kind == "S6" else 1e-6, why="statics; the shares of the pieces of a cell in S6 differ a little", place="all elements but the end ones",
              time="the end", scale=3.0)  # fmt: skip
    tolerance = {"S3": 0.06, "S6": 0.02}.get(kind, 1e-6)
    case.near("SF4, SF5", found[inner, 3:5], wanted[:, 3:5], tolerance, why="statics; shear strains of triangles alternate", place="all elements but the end ones", time="the end",
              scale=2.0)  # fmt: skip
    case.near("SM1, SM2, SM3", found[inner, 6:], wanted[:, 6:], tolerance, why="statics", place="all elements but the end ones", time="the end", scale=9.0)
    inertia = 0.2**3 / 12
    tip = (5 * 8 - 2 * 8**2 / 2) / (210000 * inertia)
    rotation = table(job, "rotations")
    ends = [i + 1 for i in mesh.where(0, 1.0)]
    case.near("UR of the free end", np.array([rotation[i] for i in ends]), np.tile([0.0, tip, 0.0], (len(ends), 1)), {"S3": 0.02}.get(kind, 5e-3),
              why="shear strains and the load at the end: (t/L)^2, few elements", place="x = 8", time="the end")  # fmt: skip
    field = job.last("UR")[mesh.at(1.0, 0.0)]
    case.near("UR in the result file", field, rotation[mesh.at(1.0, 0.0) + 1], 1e-6, why="the table has seven digits", place="x = 8", time="the end")
    case.done()


@pytest.mark.parametrize("kind", ["B31", "B32"])
@pytest.mark.parametrize("name", ["rect", "circ"])
def test_cantilever(proof: Proof, name: str, kind: str) -> None:
    """A beam with a force and a moment at its end."""
    case = proof(
        f"section-forces-{name}-{kind.lower()}",
        title=f"Section forces of a cantilever of {kind}, {name}",
        model="Length 10 along x, twenty elements, E = 2.1e5, nu = 0.3, direction 1 along y; clamped at x = 0; at the end a force (3, 2, -1) and a moment 4 about x.",
        formula="SF1 = 3, SF3 = 2 along direction 1, SF2 = -1 along direction 2; SM1 = 10 - x, SM2 = 2 (10 - x) from r x F, SM3 = 4; UR changes by M/(E I), "
        "T/(G J).",
        source="statics; S. Timoshenko, Strength of Materials, part I, 3rd edition, Van Nostrand 1955",
        proves="Signs and local axes of section forces of beams; rotations of cross-sections.",
    )
    cross = circle(0.3) if name == "circ" else rectangle(0.4, 0.6)
    loads = "END, 1, 3.\nEND, 2, 2.\nEND, 3, -1.\nEND, 4, 4.\n"
    job = case.run(beam(kind, cross, n=20) + f"*BOUNDARY\n1, ENCASTRE\n*STEP\n*STATIC\n*CLOAD\n{loads}{TABLES}*END STEP\n", "the beam")
    forces, moments = table(job, "section forces"), table(job, "section moments")
    labels = sorted(forces)
    x = (np.arange(20) + 0.5) / 2
    inner = (x > 3) & (x < 7)
    found = np.array([np.r_[forces[label][:3], moments[label]] for label in labels])
    zero = np.zeros(20)
    # M = r x F with r = (10 - x) e_x, F = 2 e_y - e_z: (0, 10 - x, 2 (10 - x)); directions 1 = y, 2 = z
    wanted = np.stack([zero + 3, zero - 1, zero + 2, 10 - x, 2 * (10 - x), zero + 4], axis=1)
    why = "statics; what the ends do has decayed"
    case.near("SF1, SF2, SF3", found[inner, :3], wanted[inner, :3], 2e-3, why=why, place="x = 3 to 7", time="the end")
    case.near("SM1, SM2, SM3", found[inner, 3:], wanted[inner, 3:], 2e-3, why=why, place="x = 3 to 7", time="the end")
    rotation = table(job, "rotations")
    places = {i + 1: job.points[i, 0] for i in range(len(rotation))}
    at = {value: next(label for label in rotation if abs(places[label] - value) < 1e-9) for value in (3.0, 7.0)}
    turn = rotation[at[7.0]] - rotation[at[3.0]]
    change = (10 * 4 - (49 - 9) / 2) / MODULUS  # int (10 - x) dx from 3 to 7
    shear = MODULUS / (2 * (1 + RATIO))
    expected = [4 * 4 / (shear * cross.torsion), change / cross.inertia_2, 2 * change / cross.inertia_1]
    case.near("change of UR", turn, expected, 2e-3, why=why, place="x = 3 to 7", time="the end")
    case.done()
