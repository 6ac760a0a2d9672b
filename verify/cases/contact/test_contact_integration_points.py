"""Surface to surface under the calculix dialect: springs at points of the slave faces, against closed forms.

A block of unit cross-section stands on a wider one whose faces do not match. Poisson's ratio is zero, so that the pressure and the
overclosure p/K are uniform and every stress is -p: a contact patch test, which springs at points pass because all integrals are
exact. The law is LINEAR.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.readers.dat_frd_files import read_frd

MODULUS, PRESSURE, STIFFNESS = 1000.0, 2.0, 1.0e5
HEX20 = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1), (0, -1, -1), (1, 0, -1), (0, 1, -1),
         (-1, 0, -1), (0, -1, 1), (1, 0, 1), (0, 1, 1), (-1, 0, 1), (-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]


class Mesh:
    """Blocks of bricks with nodes of their own."""

    def __init__(self, order: int) -> None:
        self.order = order
        self.nodes: dict[tuple[float, ...], int] = {}
        self.elements: list[list[int]] = []

    def block(self, low: tuple[float, ...], high: tuple[float, ...], n: tuple[int, int, int], body: int) -> range:
        """A block of n bricks; the numbers of its elements."""
        first = len(self.elements) + 1
        size = [(b - a) / k for a, b, k in zip(low, high, n, strict=True)]
        for k in range(n[2]):
            for j in range(n[1]):
                for i in range(n[0]):
                    middle = [low[a] + (p + 0.5) * size[a] for a, p in enumerate((i, j, k))]
                    ids = []
                    for corner in HEX20[: self.order]:
                        x = (body, *(round(m + 0.5 * c * s, 12) for m, c, s in zip(middle, corner, size, strict=True)))
                        ids.append(self.nodes.setdefault(x, len(self.nodes) + 1))
                    self.elements.append(ids)
        return range(first, len(self.elements) + 1)

    def at(self, body: int, axis: int, value: float) -> list[int]:
        """The nodes of a body on a plane."""
        return [k for x, k in self.nodes.items() if x[0] == body and abs(x[1 + axis] - value) < 1e-9]


def lines(numbers: list[int]) -> str:
    """Numbers in rows."""
    return "\n".join(", ".join(map(str, numbers[i: i + 12])) for i in range(0, len(numbers), 12))


def deck(order: int, step: str = "*STATIC\n1., 1.\n", nlgeom: str = "", friction: str = "", pair: str = "SURFACE TO SURFACE", gap: float = 0.0) -> str:
    """The two blocks: 3 x 2 faces on 2 x 3 faces."""
    mesh = Mesh(order)
    lower = mesh.block((-0.25, -0.5, -1.0), (1.5, 1.25, 0.0), (2, 3, 1), 1)
    upper = mesh.block((0.0, 0.0, gap), (1.0, 1.0, 1.0 + gap), (3, 2, 1), 2)
    text = "** dialect: calculix\n*NODE, NSET=ALL\n" + "".join(f"{k}, {x[1]}, {x[2]}, {x[3]}\n" for x, k in mesh.nodes.items())
    text += f"*ELEMENT, TYPE=C3D{order}, ELSET=E\n"
    for e, ids in enumerate(mesh.elements, 1):
        words = [str(v) for v in [e, *ids]]
        text += ", ".join(words[:16]) + (",\n" + ", ".join(words[16:]) if len(words) > 16 else "") + "\n"
    text += f"*NSET, NSET=FLOOR\n{lines(mesh.at(1, 2, -1.0))}\n*NSET, NSET=LOWER\n{lines([k for x, k in mesh.nodes.items() if x[0] == 1])}\n"
    text += f"*NSET, NSET=TOP\n{lines(mesh.at(2, 2, 1.0 + gap))}\n*NSET, NSET=UPPER\n{lines([k for x, k in mesh.nodes.items() if x[0] == 2])}\n"
    text += f"*ELSET, ELSET=UP\n{lines(list(upper))}\n"
    text += "*SURFACE, NAME=M\n" + "".join(f"{e}, S2\n" for e in lower) + "*SURFACE, NAME=S\n" + "".join(f"{e}, S1\n" for e in upper)
    text += f"*MATERIAL, NAME=EL\n*ELASTIC\n{MODULUS}, 0.\n*SOLID SECTION, ELSET=E, MATERIAL=EL\n*SURFACE INTERACTION, NAME=I\n"
    text += f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{STIFFNESS}\n{friction}*CONTACT PAIR, INTERACTION=I, TYPE={pair}\nS, M\n"
    return text + f"*STEP{nlgeom}\n{step}"


def blocks(path: Path) -> dict[str, list[np.ndarray]]:
    """The tables of a .dat file by their titles."""
    found: dict[str, list[list[list[float]]]] = {}
    for line in path.read_text().splitlines():
        if re.match(r" +[a-z]", line):
            rows: list[list[float]] = []
            found.setdefault(re.split(r" \(| for ", line.strip())[0], []).append(rows)
        elif re.match(r" +[-0-9]", line):
            rows.append([float(word) for word in line.split()])
    return {title: [np.array(rows) for rows in tables] for title, tables in found.items()}


@pytest.mark.parametrize("order", [8, 20])
@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
def test_patch(order: int, nlgeom: str, run_deck: Run, tmp_path: Path) -> None:
    """Every stress in the pressed block is -p, the pressure at every point p, and the energies are those of the springs.

    With NLGEOM the slave does not grow sideways (nu = 0), so that the nominal pressure is the true one. A master face stays flat only if
    the whole lower block is held: its compliance comes from its top alone.
    """
    prints = "*CONTACT PRINT, TOTALS=YES\nCSTR, CDIS, CELS\n*EL PRINT, ELSET=UP\nS\n*END STEP\n"
    load = "".join(f"{e}, P2, {PRESSURE}\n" for e in range(7, 13))
    text = deck(order, nlgeom=nlgeom) + f"*BOUNDARY\nLOWER, 1, 3\nUPPER, 1, 2\n*DLOAD\n{load}{prints}"
    done = run_deck(text)
    assert done.returncode == 0, done.stdout + done.stderr
    found = blocks(tmp_path / "job.dat")
    assert found["contact stress"][0][:, 2] == pytest.approx(PRESSURE, rel=2e-6)
    assert found["relative contact displacement"][0][:, 2] == pytest.approx(-PRESSURE / STIFFNESS, rel=2e-6)
    assert found["stresses"][0][:, 4] == pytest.approx(-PRESSURE, rel=2e-6)
    assert float(found["total contact spring energy"][0][0, 0]) == pytest.approx(PRESSURE**2 / (2 * STIFFNESS), rel=2e-6)
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        n = int(file["VTKHDF/NumberOfPoints"][0])
        pressure, status = file["VTKHDF/PointData/CPRESS"][-n:], file["VTKHDF/PointData/CSTATUS"][-n:]
        force = file["AMONTONS/contact/force"][-len(status[status > 0]):]
    assert pressure[status > 0] == pytest.approx(PRESSURE, rel=1e-6)
    assert force[:, 2].sum() == pytest.approx(PRESSURE, rel=1e-6)


def test_ramp(run_deck: Run, tmp_path: Path) -> None:
    """In the first step what overlaps at the start of an increment goes over the rest of the step, in each increment anew: with quarters
    of the step and an overlap that stays, a quarter, a third, a half and all of it are felt."""
    overlap = 1e-3
    text = deck(8, "*STATIC, DIRECT\n.25, 1.\n", gap=-overlap)
    text += "*BOUNDARY\nLOWER, 1, 3\nUPPER, 1, 3\n*CONTACT PRINT\nCSTR\n*END STEP\n"
    assert run_deck(text).returncode == 0
    for table, part in zip(blocks(tmp_path / "job.dat")["contact stress"], (1 / 4, 1 / 3, 1 / 2, 1), strict=True):
        assert table[:, 2] == pytest.approx(STIFFNESS * overlap * part, rel=1e-6)


@pytest.mark.parametrize("order", [8, pytest.param(20, marks=pytest.mark.slow)])
def test_slip(order: int, run_deck: Run, tmp_path: Path) -> None:
    """The block is pushed along: up to mu p the shear is the stick slope times the displacement, whatever the faces that the points meet; then mu p."""
    mu, slope, displacement = 0.4, 2.0e3, 2.0e-3
    text = deck(order, "*STATIC, DIRECT\n.125, 1.\n", friction=f"*FRICTION\n{mu}, {slope}\n", gap=-PRESSURE / STIFFNESS)
    text += "*BOUNDARY\nLOWER, 1, 3\nUPPER, 2, 3\n*CONTACT PRINT\nCSTR\n*END STEP\n"
    text += f"*STEP\n*STATIC, DIRECT\n.125, 1.\n*BOUNDARY\nUPPER, 1, 1, {displacement}\n*CONTACT PRINT\nCSTR\n*END STEP\n"
    text = text.replace("UPPER, 2, 3\n", "UPPER, 1, 3\n")
    assert run_deck(text).returncode == 0
    tables = blocks(tmp_path / "job.dat")["contact stress"][8:]
    assert len(tables) == 8
    for k, table in enumerate(tables, 1):
        assert table[:, 2] == pytest.approx(PRESSURE, rel=1e-6)
        assert np.abs(table[:, 3]) == pytest.approx(min(slope * displacement * k / 8, mu * PRESSURE), rel=1e-5)


@pytest.mark.parametrize("pair", ["SURFACE TO SURFACE", "NODE TO SURFACE"])
@pytest.mark.parametrize("order", [8, 20])
def test_touching_without_load(order: int, pair: str, run_deck: Run, tmp_path: Path) -> None:
    """Bodies that touch, turned and far from the origin, without any load: what rounding makes of their gaps is no imbalance."""
    text = deck(order, nlgeom=", NLGEOM", pair=pair) + "*BOUNDARY\nLOWER, 1, 3\nTOP, 1, 2\nTOP, 3\n*END STEP\n"
    cosine, sine = np.cos(0.7), np.sin(0.7)
    turn = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]])

    def turned(line: re.Match[str]) -> str:
        x = turn @ np.array([float(word) for word in line[2].split(",")]) + [7.0, -3.0, 5.0]
        return f"{line[1]}, " + ", ".join(repr(float(v)) for v in x)

    head, tail = text.split("*ELEMENT", 1)
    done = run_deck(re.sub(r"^(\d+), (.*)$", turned, head, flags=re.M) + "*ELEMENT" + tail)
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        assert np.abs(file["VTKHDF/PointData/U"][:]).max() < 1e-13


def test_tilting_on_a_dented_master(run_deck: Run) -> None:
    """A block is pressed by the mortar method on a face whose edge has sunk in, and tilts: it may end with a reason, but contact that had
    converged elsewhere during the attempt is as it is here again (its rows once held no node).
    """
    mesh = Mesh(20)
    mesh.block((0.0, 0.0, -1.0), (1.0, 1.0, 0.0), (1, 1, 1), 1)
    mesh.block((0.0, 0.0, 0.01), (1.0, 1.0, 1.01), (1, 1, 1), 2)
    text = "** dialect: calculix\n*NODE, NSET=ALL\n"
    for x, k in mesh.nodes.items():
        text += f"{k}, {x[1]}, {x[2]}, {x[3] - (0.3 if x == (1, 0.5, 1.0, 0.0) else 0.0)}\n"
    text += "*ELEMENT, TYPE=C3D20, ELSET=E\n"
    for e, ids in enumerate(mesh.elements, 1):
        text += ", ".join(map(str, [e, *ids[:15]])) + ",\n" + ", ".join(map(str, ids[15:])) + "\n"
    text += f"*NSET, NSET=FLOOR\n{lines(mesh.at(1, 2, -1.0))}\n*NSET, NSET=TOP\n{lines(mesh.at(2, 2, 1.01))}\n"
    text += "*SURFACE, NAME=S\n2, S1\n*SURFACE, NAME=M\n1, S2\n*MATERIAL, NAME=EL\n*ELASTIC\n210000., 0.\n*SOLID SECTION, ELSET=E, MATERIAL=EL\n"
    text += "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.E7\n*CONTACT PAIR, INTERACTION=I, TYPE=MORTAR\nS, M\n"
    text += "*BOUNDARY\nFLOOR, 1, 3\nTOP, 1, 2\n*STEP, NLGEOM\n*STATIC\n.5, 1.\n*DLOAD\n2, P2, 100.\n*END STEP\n"
    done = run_deck(text)
    assert done.returncode in (0, 5), done.stdout + done.stderr
    assert done.returncode == 0 or "FREE BODY" in done.stdout, done.stdout


@pytest.mark.parametrize("order", [8, 20])
def test_what_nodes_show(order: int, run_deck: Run, tmp_path: Path) -> None:
    """The field CONTACT of the .frd file, as CalculiX 2.20 writes it (it agreed with that to all digits on faces of C3D8 and C3D20,
    whole, cut into pieces and partly open): the closed points of a face are fitted by the functions of its corners, what comes out at a corner is kept
    between the least and the largest value of the points, and mid-side nodes take the mean of their corners.

    One face on one larger face, all displacements given, the overclosure (1 + x + 2 y + x y)/1000: the fit is exact; at (0, 0) and
    (1, 1) the least and the largest of the points count, each the nearest of its triangle about the middle.
    """
    mesh = Mesh(order)
    mesh.block((-0.5, -0.5, -1.0), (1.5, 1.5, 0.0), (1, 1, 1), 1)
    mesh.block((0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (1, 1, 1), 2)
    text = "** dialect: calculix\n*NODE, NSET=ALL\n" + "".join(f"{k}, {x[1]}, {x[2]}, {x[3]}\n" for x, k in mesh.nodes.items())
    text += f"*ELEMENT, TYPE=C3D{order}, ELSET=E\n"
    for e, ids in enumerate(mesh.elements, 1):
        words = [str(v) for v in [e, *ids]]
        text += ", ".join(words[:16]) + (",\n" + ", ".join(words[16:]) if len(words) > 16 else "") + "\n"
    text += f"*SURFACE, NAME=M\n1, S2\n*SURFACE, NAME=S\n2, S1\n*MATERIAL, NAME=EL\n*ELASTIC\n{MODULUS}, 0.\n*SOLID SECTION, ELSET=E, MATERIAL=EL\n"
    text += "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1000.\n*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\n"
    text += "S, M\n*STEP\n*STATIC\n1., 1.\n*BOUNDARY\nALL, 1, 3\n"

    def pressure(x: float, y: float) -> float:
        return 1 + x + 2 * y + x * y

    foot = {k: (x[1], x[2]) for x, k in mesh.nodes.items() if x[0] == 2 and x[3] == 0.0}
    text += "".join(f"{k}, 3, 3, {-1e-3 * pressure(*at):.15g}\n" for k, at in foot.items())
    assert run_deck(text + "*NODE FILE\nU\n*CONTACT FILE\nCDIS, CSTR\n*END STEP\n").returncode == 0
    share = (9 + 2 * 15**0.5) / 21   # of the corner at its nearest point; the others have (6 - sqrt(15))/21 each
    rest = (6 - 15**0.5) / 21
    next_along = 1.0 if order == 8 else 0.5   # the outline of a quadratic face has its mid-side nodes
    low, high = 0.5 * rest, (0.5 + next_along) * rest   # its place beside (0, 0): in the triangle (middle, corner, next of the outline)
    assert share + 2 * rest == pytest.approx(1.0)
    corners = {(0.0, 0.0): pressure(high, low), (1.0, 0.0): 2.0, (0.0, 1.0): 3.0, (1.0, 1.0): pressure(1 - high, 1 - low)}
    corners[0.0, 0.0] = min(corners[0.0, 0.0], pressure(low, high))
    corners[1.0, 1.0] = max(corners[1.0, 1.0], pressure(1 - low, 1 - high))
    shown = next(b for b in reversed(read_frd(tmp_path / "job.frd")) if b.title == "CONTACT").rows
    for k, (x, y) in foot.items():
        near = [corners[a, b] for a, b in corners if abs(a - x) <= 0.5 and abs(b - y) <= 0.5]
        assert shown[k,][3] == pytest.approx(sum(near) / len(near), rel=2e-5), (x, y)
        assert shown[k,][0] == pytest.approx(-1e-3 * sum(near) / len(near), rel=2e-5), (x, y)
