"""Every contact quantity of every formulation of contact, against a state that is known: a block pressed and dragged.

A block (nu = 0, a layer of elements high) is pressed on a rigid plane and dragged along it by its top. Its sides transmit the shear that
goes with friction, so that stress, pressure p and friction mu p are uniform whatever the elements, and all forces, moments, centres, slips and
energies follow by hand.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from math import log, pi
from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray

from verify.conftest import Run
from verify.decks import solids
from verify.decks.make_decks import block
from verify.decks.planes import flatten
from verify.decks.sheets import sheet
from verify.readers.dat_frd_files import read_frd

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

YOUNG, MU, PRESSURE, HEIGHT, DRAG = 1000.0, 0.3, 10.0, 0.5, 0.1
SHEAR = MU * PRESSURE
SLIP = DRAG - SHEAR * HEIGHT / (YOUNG / 2)  #: of the foot: the displacement of the top less the shear deformation of the block
LOW = np.array([3.0, 2.0, 0.0])  #: the corner of the block; beside the origin, so that there are moments
LENGTH, WIDTH = 2.0, 1.0  #: of its foot
STIFFNESS, STICK = 1.0e7, 1.0e6
EDGE_SHARES = {2: [1 / 2, 1 / 2], 3: [1 / 6, 1 / 6, 2 / 3]}
FACE_SHARES = {3: [1 / 3] * 3, 4: [1 / 4] * 4, 6: [0.0] * 3 + [1 / 3] * 3, 8: [-1 / 12] * 4 + [1 / 3] * 4}


def arctan_law() -> float:
    """Overclosure under p of CalculiX's LINEAR with its defaults: p = K h (1/2 + atan(h/eps)/pi), eps = pi sigma_inf/K, sigma_inf = E/70000."""
    eps, h = pi * YOUNG / 70000 / STIFFNESS, PRESSURE / STIFFNESS
    for _ in range(100):
        h = PRESSURE / STIFFNESS / (0.5 + np.arctan(h / eps) / pi)
    return float(h)


LINEAR = f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{STIFFNESS}\n"
EXPONENTIAL = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL\n1e-4, 1.\n"
TABULAR = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n1e5, 1e-2\n"


@dataclass(frozen=True)
class Form:
    """A formulation, and what its law gives: overclosure, and energy of the pressure by area as the law and as tables have it."""

    kind: str = "C3D8"
    dialect: str = "abaqus"
    type: str = "NODE TO SURFACE"
    behavior: str = ""
    master: str = "mesh"
    slave: str = "faces"
    overclosure: float = 0.0
    energy: float = 0.0
    printed_energy: float = 0.0

    @property
    def is_soft(self) -> bool:
        """Whether the law is compliant."""
        return self.behavior != ""


def soft(behavior: str, overclosure: float, energy: float, printed: float | None = None, **words: str) -> Form:
    """A formulation with a compliant law under the calculix dialect."""
    form = Form(dialect="calculix", behavior=behavior, overclosure=overclosure, energy=energy, printed_energy=energy if printed is None else printed)
    return Form(**{**form.__dict__, **words})


def straight(**words: str) -> Form:
    """LINEAR without its tension."""
    return soft(LINEAR, PRESSURE / STIFFNESS, PRESSURE**2 / 2 / STIFFNESS, **words)


S2S = "SURFACE TO SURFACE"
H_EXP = 1e-4 * log(PRESSURE) / log(100)
FORMS: dict[str, Form] = {
    "nodes": Form(),
    "nodes-c3d10": Form("C3D10"),
    "nodes-c3d20": Form("C3D20"),
    "nodes-linear": soft(LINEAR, arctan_law(), 0.0, PRESSURE * arctan_law() / 2),
    "nodes-exponential": soft(EXPONENTIAL, H_EXP, (PRESSURE - 0.005) * 1e-4 / log(100)),
    "nodes-tabular": soft(TABULAR, 1e-6, PRESSURE * 1e-6 / 2),
    "nodes-analytic": Form(master="analytic"),
    "nodes-c3d20-analytic": Form("C3D20", master="analytic"),
    "surface-of-nodes": Form(slave="nodes"),
    "mortar": Form(type=S2S),
    "mortar-c3d4": Form("C3D4", type=S2S),
    "mortar-c3d6": Form("C3D6", type=S2S),
    "mortar-c3d10": Form("C3D10", type=S2S),
    "mortar-c3d20": Form("C3D20", type=S2S),
    "mortar-linear": straight(type="MORTAR"),
    "mortar-linear-c3d20": straight(type="MORTAR", kind="C3D20"),
    "points": straight(type=S2S),
    "points-c3d10": straight(type=S2S, kind="C3D10"),
    "points-c3d20": straight(type=S2S, kind="C3D20"),
    "nodes-cpe4": Form("CPE4"),
    "nodes-cps8": Form("CPS8"),
    "nodes-cpe4-tabular": soft(TABULAR, 1e-6, PRESSURE * 1e-6 / 2, kind="CPE4"),
    "nodes-cpe4-analytic": Form("CPE4", master="analytic"),
    "mortar-cpe4": Form("CPE4", type=S2S),
    "mortar-cpe8": Form("CPE8", type=S2S),
    "mortar-cpe8-linear": straight(type="MORTAR", kind="CPE8"),
    "points-cps4": straight(type=S2S, kind="CPS4"),
    "points-cpe8": straight(type=S2S, kind="CPE8"),
    "nodes-cax4": Form("CAX4"),
    "nodes-cax8": Form("CAX8"),
    "nodes-cax4-analytic": Form("CAX4", master="analytic"),
    "mortar-cax4": Form("CAX4", type=S2S),
    "mortar-cax8": Form("CAX8", type=S2S),
    "points-cax4": straight(type=S2S, kind="CAX4"),
}  # fmt: skip


@dataclass
class Block:
    """The mesh of the block with its foot, the consistent forces of its sides, and the axis along which it is pressed."""

    kind: str
    nodes: Floats
    cards: str
    faces: list[tuple[int, int]]  #: of the foot: element, face, from 1
    up: int  #: axis
    sides: Floats = field(default_factory=lambda: np.zeros(0))  #: (n) along the axis

    @property
    def foot(self) -> Ints:
        """Its nodes."""
        return np.flatnonzero(np.abs(self.nodes[:, self.up] - LOW[self.up] * (self.up == 1)) < 1e-9)

    @property
    def top(self) -> Ints:
        """Its nodes."""
        return np.flatnonzero(np.abs(self.nodes[:, self.up] - self.nodes[:, self.up].max()) < 1e-9)

    @property
    def is_round(self) -> bool:
        """A body of revolution is not dragged."""
        return self.kind.startswith("CAX")

    @property
    def area(self) -> float:
        """Of the foot."""
        if self.is_round:
            return float(pi * ((LOW[0] + LENGTH) ** 2 - LOW[0] ** 2))
        return LENGTH * WIDTH


ALONG = LOW[0] + np.array([0.0, 0.5, 1.0, 2.0])


def solid_block(kind: str) -> Block:
    """3 x 2 cells."""
    body = solids.as_kind(block(ALONG, LOW[1] + np.array([0.0, 0.4, 1.0]), [0.0, HEIGHT], "B"), kind)
    corners = {tuple(sorted(pair)): k for k, pair in enumerate(_edges(kind))}
    sides = np.zeros(len(body.nodes))
    for x, sign in ((LOW[0] + LENGTH, 1), (LOW[0], -1)):
        for e, f in body.outer_faces(body.where(0, x)):
            local = list(solids.FACES[kind][f - 1])
            ring = body.nodes[body.elements[e][local]]
            size = np.linalg.norm(np.cross(ring[1] - ring[0], ring[2] - ring[0])) / 2
            size += np.linalg.norm(np.cross(ring[2] - ring[0], ring[-1] - ring[0])) / 2 if len(local) == 4 else 0
            if kind in solids.QUADRATIC:
                n = len({v for pair in corners for v in pair})
                local += [n + corners[tuple(sorted((a, b)))] for a, b in zip(local, [*local[1:], local[0]], strict=True)]
            np.add.at(sides, body.elements[e][local], sign * SHEAR * size * np.array(FACE_SHARES[len(local)]))
    cards = body.cards().replace("ELSET=ALL", "ELSET=BLOCK").replace("*NODE, NSET=NODES", "*NODE")
    return Block(kind, body.nodes, cards, [(e + 1, f) for e, f in body.outer_faces(body.where(2, 0.0))], 2, sides)


def _edges(kind: str) -> list[tuple[int, int]]:
    """The edges of a kind in the order of its mid-side nodes."""
    tet, wedge = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)], [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)]
    hexahedron = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    return {"C3D10": tet, "C3D15": wedge}.get(kind, hexahedron)


def plane_block(kind: str) -> Block:
    """3 cells in a row, as thick as the solid block is wide."""
    part = flatten(sheet("B", ALONG, LOW[1] + np.array([0.0, HEIGHT])), kind[3] == "8")
    sides = np.zeros(len(part.nodes))
    for x, sign in ((LOW[0] + LENGTH, 1), (LOW[0], -1)):
        line = np.flatnonzero(np.abs(part.nodes[:, 0] - x) < 1e-9)
        ends = line[np.argsort(np.abs(part.nodes[line, 1] - LOW[1] - HEIGHT / 2))][::-1]   # the ends, then the middle
        sides[ends] = sign * SHEAR * HEIGHT * WIDTH * np.array(EDGE_SHARES[len(line)])
    cards = "*NODE\n" + "".join(f"{i}, {x[0]:.15g}, {x[1]:.15g}\n" for i, x in enumerate(part.nodes, 1))
    cards += f"*ELEMENT, TYPE={kind}, ELSET=BLOCK\n" + "".join(f"{i}, {', '.join(str(v + 1) for v in e)}\n" for i, e in enumerate(part.elements, 1))
    nodes = np.column_stack([part.nodes[:, :2], np.zeros(len(part.nodes))])
    return Block(kind, nodes, cards, [(i + 1, 1) for i in range(3)], 1, sides)


def plane(body: Block, master: str) -> str:
    """The rigid plane: a mesh whose nodes are held, its faces other than those of the block; or an analytic surface."""
    n, m = len(body.nodes), 100
    if master == "analytic":
        height = 0.0 if body.up == 2 else LOW[1]
        head = "TYPE=CYLINDER\n0., 0., 0., 1., 0., 0.\n0., 1., 0." if body.up == 2 else "TYPE=SEGMENTS"
        profile = f"*SURFACE, NAME=MASTER, {head}\nSTART, -20., {height}\nLINE, 30., {height}\n"
        return f"*NODE, NSET=FLOOR\n{n + 1}, 0., 0., 0.\n{profile}*RIGID BODY, ANALYTICAL SURFACE=MASTER, REF NODE={n + 1}\n"
    if body.up == 2:
        mesh = block(LOW[0] + np.array([-1.0, 0.7, 3.5]), LOW[1] + np.array([-1.0, 2.0]), [-1.0, 0.0], "FLOOR")
        nodes, elements, kind, face = mesh.nodes, mesh.elements, "C3D8", 2
    else:
        part = flatten(sheet("FLOOR", LOW[0] + np.array([-1.0, 0.7, 3.5]), LOW[1] + np.array([-1.0, 0.0])))
        nodes, elements, kind, face = part.nodes, part.elements, body.kind[:3] + "4", 3
    text = "*NODE, NSET=FLOOR\n" + "".join(f"{n + i}, {', '.join(f'{v:.15g}' for v in x)}\n" for i, x in enumerate(nodes, 1))
    text += f"*ELEMENT, TYPE={kind}, ELSET=UNDER\n" + "".join(f"{m + i}, {', '.join(str(n + v + 1) for v in e)}\n" for i, e in enumerate(elements, 1))
    return text + f"*SURFACE, NAME=MASTER\nUNDER, S{face}\n"


def deck(form: Form, body: Block) -> str:
    """Pressed in the first step, dragged in the second."""
    is_drag = not body.is_round
    depth = f"{WIDTH}\n" if body.kind[:2] == "CP" else ""
    text = f"** dialect: {form.dialect}\n" + body.cards + plane(body, form.master)
    if form.slave == "nodes":
        text += solids.node_set("FOOT", body.foot) + "*SURFACE, TYPE=NODE, NAME=SLAVE\nFOOT\n"
    else:
        text += "*SURFACE, NAME=SLAVE\n" + "".join(f"{e}, S{f}\n" for e, f in body.faces)
    text += f"*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, 0.\n*SOLID SECTION, ELSET=BLOCK, MATERIAL=M\n{depth}"
    text += f"*SOLID SECTION, ELSET=UNDER, MATERIAL=M\n{depth}" if form.master == "mesh" else ""
    slope = f", {STICK}" if form.is_soft else ""
    text += f"*SURFACE INTERACTION, NAME=I\n{form.behavior}" + (f"*FRICTION\n{MU}{slope}\n" if is_drag else "")
    text += f"*CONTACT PAIR, INTERACTION=I, TYPE={form.type}\nSLAVE, MASTER\n" + solids.node_set("TOP", body.top)
    up, down = body.up + 1, PRESSURE * HEIGHT / YOUNG + form.overclosure
    held = f"FLOOR, 1, {up}\n" + ("" if form.master == "mesh" else "FLOOR, 4, 6\n" if up == 3 else "FLOOR, 6\n")
    top = f"TOP, 1, {up - 1}\nTOP, {up}, {up}, {-down:.15g}\n"
    tight = "*CONTROLS, PARAMETERS=FIELD\n1e-8, 1e-8\n"
    prints = "*CONTACT PRINT, TOTALS=YES\nCDIS, CSTR, CNUM, CELS, CFN, CFS\n*NODE FILE\nU\n*CONTACT FILE\nCDIS, CSTR\n"
    text += f"*STEP\n*STATIC, DIRECT\n1., 1.\n{tight}*BOUNDARY\n{held}{top}{prints}*END STEP\n"
    if is_drag:
        loads = "".join(f"{k + 1}, {up}, {body.sides[k]:.15g}\n" for k in np.flatnonzero(np.abs(body.sides) > 0))
        text += f"*STEP\n*STATIC, DIRECT\n1., 1.\n*BOUNDARY\nTOP, 1, 1, {DRAG}\n*CLOAD\n{loads}*END STEP\n"
    return text


def last_tables(path: Path) -> dict[str, Floats]:
    """The last table of each title in a .dat file."""
    found: dict[str, list[list[float]]] = {}
    rows: list[list[float]] = []
    pair = ""
    for line in path.read_text().splitlines():
        if re.match(r" +[a-z]", line):
            rows = []
            title = re.split(r" \(| for ", line.strip())[0]
            pair = re.sub(" force.*", "", title) if title.startswith("total normal") or title.startswith("total shear") else pair
            found[title if not title.startswith(("center of g", "moment", "area")) else f"{pair}: {title}"] = rows
        elif re.match(r" +[-0-9]", line):
            rows.append([float(word) for word in line.split()])
    return {title: np.array(values) for title, values in found.items()}


@pytest.mark.parametrize("name", FORMS)
def test_quantities(name: str, run_deck: Run, tmp_path: Path) -> None:
    """All quantities in .dat, .vtkhdf and .frd; six digits where they are printed."""
    form = FORMS[name]
    body = solid_block(form.kind) if form.kind.startswith("C3D") else plane_block(form.kind)
    done = run_deck(deck(form, body), "--frd")
    assert done.returncode == 0, done.stdout + done.stderr
    foot, up = body.foot, body.up
    shear, slip = (0.0, 0.0) if body.is_round else (SHEAR, SLIP)
    normal = np.eye(3)[up]
    shears = np.array([-shear, 0.0, 0.0])
    area = 1.0 if form.slave == "nodes" else body.area
    pressing = PRESSURE * body.area * normal

    with h5py.File(tmp_path / "job.vtkhdf") as file:
        last = {key: values[-int(file["VTKHDF/NumberOfPoints"][0]):][foot] for key, values in file["VTKHDF/PointData"].items()}
        sums = {key: values[-1] for key, values in file["AMONTONS/pair_history"].items()}
        energy = float(file["AMONTONS/history/contact_energy"][-1])
    if form.slave == "faces":
        assert last["CPRESS"] == pytest.approx(PRESSURE, rel=1e-6)
        assert last["CSHEAR"] == pytest.approx(np.tile(shears, (len(foot), 1)), abs=1e-5 * PRESSURE)
    assert last["COPEN"] == pytest.approx(-form.overclosure, abs=1e-6 * form.overclosure + 1e-12)
    assert last["CSLIP"] == pytest.approx(np.tile([slip, 0.0, 0.0], (len(foot), 1)), abs=1e-6 + form.is_soft * SHEAR / STICK)
    assert last["CNORMF"].sum(axis=0) == pytest.approx(pressing, abs=1e-6 * pressing[up])
    assert last["CSHEARF"].sum(axis=0) == pytest.approx(shears * body.area, abs=1e-6 * pressing[up])
    assert set(last["CSTATUS"]) == {2}
    assert set(last["CSCENARIO"]) <= {0, 1, 2, 3, 4}

    far = LOW[0] + LENGTH
    middle = np.array([LOW[0] + LENGTH / 2 + slip, LOW[1] + (WIDTH / 2 if up == 2 else 0.0), 0.0])
    if body.is_round:
        middle[0] = 2 / 3 * (far**3 - LOW[0] ** 3) / (far**2 - LOW[0] ** 2)
    middle[up] -= form.overclosure
    moments = np.cross(middle, [pressing, shears * body.area])
    scale = 1e-6 * PRESSURE * body.area * np.linalg.norm(middle)
    assert sums["CFN"] == pytest.approx(pressing, abs=scale)
    assert sums["CFS"] == pytest.approx(shears * body.area, abs=scale)
    assert sums["CMN"] == pytest.approx(moments[0], abs=scale)
    assert sums["CMS"] == pytest.approx(moments[1], abs=scale)
    assert sums["XN"] == pytest.approx(middle, abs=1e-6)
    assert sums["XS"] == pytest.approx(middle if shear else np.zeros(3), abs=1e-6)
    assert float(sums["CAREA"]) == pytest.approx(area if form.slave == "faces" else len(foot), rel=1e-6)
    assert sums["n_status"][:2].tolist() == [0, 0]

    tables = last_tables(tmp_path / "job.dat")
    count = int(tables["total number of contact elements"][0, 0])
    assert sums["n_status"][2] == count
    if form.slave == "faces":
        # axes of the table: along x, then n x t1, which is y in space and -z in the plane
        assert tables["contact stress"][:, -3:] == pytest.approx(np.tile([PRESSURE, shear, 0.0], (count, 1)), abs=1e-5 * PRESSURE)
    rows = tables["relative contact displacement"][:, -3:]
    assert rows == pytest.approx(np.tile([-form.overclosure, slip, 0.0], (count, 1)), abs=1e-6 + form.is_soft * SHEAR / STICK)
    assert rows[:, 0] == pytest.approx(-form.overclosure, abs=3e-6 * form.overclosure + 1e-12)
    elastic = shear**2 / STICK if form.is_soft else 0.0
    if form.energy:
        assert energy == pytest.approx(area * (form.energy + elastic / 2), rel=1e-5)
    by_law = form.dialect == "calculix" and form.type != "MORTAR"   # CalculiX counts the elastic slip with all of its shear
    part = 1 / 180 if body.is_round and form.dialect == "calculix" else 1.0   # two degrees of the circle, as there
    printed = part * area * (form.printed_energy + elastic * (1 if by_law else 0.5))
    assert float(tables["total contact spring energy"][0, 0]) == pytest.approx(printed, rel=1e-5, abs=1e-12)
    for name, force, moment in (("normal", pressing, moments[0]), ("shear", shears * body.area, moments[1])):
        wanted = part * np.array([*force, *moment])
        assert tables[f"total {name} surface force"][0] == pytest.approx(wanted, abs=part * (3e-6 * np.linalg.norm(moments[0]) + scale))
        if form.slave == "faces":
            assert tables[f"total {name} surface: center of gravity and mean normal"][0] == pytest.approx([*middle, *-normal], abs=1e-5)
            assert float(tables[f"total {name} surface: area,  normal force"][0, 0]) == pytest.approx(part * area, rel=1e-6)

    if form.slave == "faces":
        shown = [b for b in read_frd(tmp_path / "job.frd") if b.title == "CONTACT"][-1].rows
        found = np.array([shown[(int(k) + 1,)] for k in foot])
        row = [-form.overclosure, slip, 0.0, PRESSURE, shear, 0.0]
        assert found == pytest.approx(np.tile(row, (len(foot), 1)), abs=2e-5 * PRESSURE)
