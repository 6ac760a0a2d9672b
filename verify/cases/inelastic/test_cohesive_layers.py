"""Cohesive elements: bilinear laws of all kinds, layers between blocks, a beam on an elastic layer, double cantilever beams whose
crack grows as fracture mechanics says, viscosity, a joint that turns, and a crack that jumps from node to node.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.cases.proof import Case, Job
from verify.readers.dat_frd_files import read_dat

RunDeck = Callable[..., subprocess.CompletedProcess[str]]
Proof = Callable[..., Case]
YOUNG, HEIGHT, WIDTH, START = 126000.0, 1.5, 1.0, 30.0  # arms of the double cantilever beams, and their crack
ENERGY = 0.281

QUAD = [(0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0)]
#: Kind to its lower face, area and axes of the traction: normal and first shear.
KINDS = {
    "COH3D8": ([(x, y, 0.0) for x, y in QUAD], 2.0, (3, 1)),
    "COH3D6": ([(x, y, 0.0) for x, y in QUAD[:3]], 1.0, (3, 1)),
    "COH2D4": ([(0.0, 0.0, 0.0), (2.0, 0.0, 0.0)], 2.0, (2, 1)),
    "COHAX4": ([(1.0, 0.0, 0.0), (3.0, 0.0, 0.0)], np.pi * 8, (2, 1)),
}


def one_element(kind: str, law: str, moves: str, section: str = "1.", options: str = "", n: int = 10) -> str:
    """One element whose lower face is held; the upper one moves."""
    face, _, _ = KINDS[kind]
    m = len(face)
    text = "*NODE\n" + "".join(f"{i}, {x}, {y}, {z}\n" for i, (x, y, z) in enumerate(face + face, start=1))
    upper = [*range(m + 1, 2 * m + 1)] if m > 2 else [4, 3]
    text += f"*ELEMENT, TYPE={kind}, ELSET=GLUE\n1, " + ", ".join(str(i) for i in [*range(1, m + 1), *upper]) + "\n"
    text += f"*NSET, NSET=LOW, GENERATE\n1, {m}\n*NSET, NSET=UP, GENERATE\n{m + 1}, {2 * m}\n"
    text += f"*MATERIAL, NAME=LAW\n{law}*COHESIVE SECTION, ELSET=GLUE, MATERIAL=LAW, RESPONSE=TRACTION SEPARATION{options}\n{section}\n"
    text += f"*BOUNDARY\nLOW, 1, 3\n*STEP\n*STATIC, DIRECT\n{1 / n}, 1.\n*BOUNDARY\n{moves}"
    return text + "*NODE PRINT, NSET=UP, TOTALS=ONLY\nRF\n*EL PRINT, ELSET=GLUE\nSDEG, DMICRT\n*END STEP\n"


def forces(folder: Path) -> np.ndarray:
    """Total force on the upper face at the end of each increment."""
    return np.array([next(iter(t.rows.values())) for t in read_dat(folder / "job.dat") if t.title.startswith("total")])


def law_cards(stiffness: str, limits: str, energy: str = f"\n{ENERGY}", criterion: str = "QUADS") -> str:
    """Elasticity, criterion and evolution by energy."""
    return f"*ELASTIC, TYPE=TRACTION\n{stiffness}\n*DAMAGE INITIATION, CRITERION={criterion}\n{limits}\n*DAMAGE EVOLUTION, TYPE=ENERGY{energy}\n"


def bilinear(d: np.ndarray, stiffness: float, limit: float, energy: float) -> np.ndarray:
    """Traction of a separation that grows."""
    end = 2 * energy / limit
    return np.minimum(stiffness * d, np.maximum(limit * (end - d) / (end - limit / stiffness), 0.0))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("mode", [0, 1])
def test_bilinear_law(run_deck: RunDeck, tmp_path: Path, kind: str, mode: int) -> None:
    """Pure opening and pure shear: the force is the area times the closed form; damage is 1 at the end."""
    _, area, axes = KINDS[kind]
    moves = "".join(f"UP, {axis}, {axis}, {0.1 if axis == axes[mode] else 0.0}\n" for axis in (1, 2, 3))
    done = run_deck(one_element(kind, law_cards("1000., 600., 600.", "10., 8., 8.", ", MIXED MODE BEHAVIOR=BK, POWER=2.\n0.3, 0.35, 0.35"), moves))
    assert done.returncode == 0, done.stdout + done.stderr
    d = 0.1 * np.arange(1, 11) / 10
    expected = area * bilinear(d, (1000.0, 600.0)[mode], (10.0, 8.0)[mode], (0.3, 0.35)[mode])
    assert forces(tmp_path)[:, axes[mode] - 1] == pytest.approx(expected, rel=1e-5, abs=1e-6 * expected.max())
    for title in ("damage", "criterion of damage"):
        values = [list(t.rows.values()) for t in read_dat(tmp_path / "job.dat") if t.title.startswith(title)]
        assert np.ravel(values[-1]) == pytest.approx(1.0), title


@pytest.mark.parametrize("options", ["", ", THICKNESS=SPECIFIED"])
def test_thickness_and_width(run_deck: RunDeck, tmp_path: Path, options: str) -> None:
    """Strains are separations over the thickness: stiffness E/T; forces of COH2D4 have the width."""
    law = "*ELASTIC, TYPE=TRACTION\n1000., 600., 600.\n"
    done = run_deck(one_element("COH2D4", law, "UP, 1, 1, 0.01\nUP, 2, 2, -0.02\n", "0.25, 3.", options, n=1))
    assert done.returncode == 0, done.stdout + done.stderr
    assert forces(tmp_path)[-1, :2] == pytest.approx([2 * 3 * 600 * 0.01 / 0.25, -2 * 3 * 1000 * 0.02 / 0.25], rel=1e-6)


#: Of each kind: the upper face, its area with width 3 in the plane, and the axis of the pressure.
UPPER = {"COH3D8": ("2", 2.0, 3), "COH3D6": ("2", 1.0, 3), "COH2D4": ("3", 6.0, 2), "COHAX4": ("3", np.pi * 8, 2)}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("load", ["P", "F"])
def test_loads_on_a_face(run_deck: RunDeck, tmp_path: Path, kind: str, load: str) -> None:
    """A pressure on the upper face, or its foundation: the force is that of the area, whatever the thickness of the law."""
    face, area, axis = UPPER[kind]
    card = {"P": f"*DLOAD\nGLUE, P{face}, 5.\n", "F": f"*BOUNDARY\nUP, {axis}, {axis}, 0.01\n"}[load]
    section = "0.2, 3." if kind == "COH2D4" else "0.2"
    deck = one_element(kind, "*ELASTIC, TYPE=TRACTION\n1000., 600., 600.\n", "", section, n=1).replace("*BOUNDARY\n*NODE", card + "*NODE")
    if load == "F":
        deck = deck.replace("*STEP\n", f"*FOUNDATION\nGLUE, F{face}, 70.\n*STEP\n")
    done = run_deck(deck.replace("*NODE PRINT, NSET=UP, TOTALS=ONLY\nRF", "*NODE PRINT, NSET=LOW, TOTALS=ONLY\nRF\n*NODE PRINT, NSET=UP, TOTALS=ONLY\nRF"))
    assert done.returncode == 0, done.stdout + done.stderr
    low, up = forces(tmp_path)[:, axis - 1]
    if load == "P":
        assert low == pytest.approx(5 * area, rel=1e-6)
    else:
        assert low + up == pytest.approx(70 * 0.01 * area, abs=1e-6 * abs(low))  # of seven digits
        assert low == pytest.approx(-1000 / 0.2 * 0.01 * area, rel=1e-6)


@pytest.mark.parametrize("kind", ["COH2D4", "COHAX4"])
def test_contact_of_a_face(run_deck: RunDeck, tmp_path: Path, kind: str) -> None:
    """The upper face is pushed against a rigid edge through a linear pressure-overclosure law: the force is that of its area."""
    _, area, axis = UPPER[kind]
    solid = kind.replace("COH2D4", "CPE4").replace("COHAX4", "CAX4")
    (left, _, _), (right, _, _) = KINDS[kind][0]
    deck = one_element(kind, "*ELASTIC, TYPE=TRACTION\n1000., 600., 600.\n", "LOW, 2, 2, 0.01\nUP, 2, 2, 0.01\n", "0.2, 3." if kind == "COH2D4" else "0.2", n=1)
    deck = deck.replace("*BOUNDARY\nLOW", f"""*NODE
11, {left - 0.5}, 0.
12, {right + 0.5}, 0.
13, {right + 0.5}, 1.
14, {left - 0.5}, 1.
*ELEMENT, TYPE={solid}, ELSET=BLOCK
2, 11, 12, 13, 14
*NSET, NSET=BLOCK
11, 12, 13, 14
*MATERIAL, NAME=STEEL
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=BLOCK, MATERIAL=STEEL
3.
*SURFACE, NAME=SLAVE
GLUE, S3
*SURFACE, NAME=MASTER
BLOCK, S1
*SURFACE INTERACTION, NAME=PRESS
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
70.
*CONTACT PAIR, INTERACTION=PRESS, TYPE=NODE TO SURFACE
SLAVE, MASTER
*BOUNDARY
BLOCK, 1, 2
LOW""", 1)
    deck = deck.replace("*NODE PRINT, NSET=UP", "*NODE PRINT, NSET=BLOCK")
    done = run_deck(deck.replace("LOW, 1, 3\n*STEP", "LOW, 1, 1\nUP, 1, 1\n*STEP"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert forces(tmp_path)[-1, axis - 1] == pytest.approx(-70 * 0.01 * area, rel=1e-6)


def test_viscosity(run_deck: RunDeck, tmp_path: Path) -> None:
    """A separation that acts at once and is held: D - Dv falls by mu/(mu + dt) in each increment."""
    law = law_cards("1000., 600., 600.", "10., 8., 8.", "\n0.3")
    deck = one_element("COH3D8", law, "UP, 1, 2\nUP, 3, 3, 0.03\n", options=", CONTROLS=SLOW", n=5)
    deck = deck.replace("*MATERIAL", "*SECTION CONTROLS, NAME=SLOW, VISCOSITY=0.3\n*AMPLITUDE, NAME=ONCE\n0., 1., 10., 1.\n*MATERIAL").replace("*STATIC, DIRECT\n0.2, 1.\n*BOUNDARY\n", "*STATIC, DIRECT\n0.2, 1.\n*BOUNDARY, AMPLITUDE=ONCE\n")
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr
    damage = 1 - bilinear(np.array(0.03), 1000.0, 10.0, 0.3) / (1000 * 0.03)
    delayed = damage * (1 - (0.3 / 0.5) ** np.arange(1, 6))
    assert forces(tmp_path)[:, 2] == pytest.approx(2 * 1000 * 0.03 * (1 - delayed), rel=1e-5)


def test_joint_that_turns(run_deck: RunDeck, tmp_path: Path) -> None:
    """NLGEOM: an opened element is turned by 90 degrees; the traction turns with it, its size is that of the opening."""
    face, area, _ = KINDS["COH3D8"]
    deck = one_element("COH3D8", "*ELASTIC, TYPE=TRACTION\n1000., 600., 600.\n", "UP, 1, 1, 0.002\nUP, 2, 2, 0.003\nUP, 3, 3, 0.01\n", n=1)
    deck = deck.replace("*STEP\n", "*STEP, NLGEOM\n").replace("*BOUNDARY\nLOW, 1, 3\n", "*BOUNDARY\nLOW, 1, 3, 0.\n")
    moves = ""
    for i, (x, y, z) in enumerate(face + face, start=1):  # about x, the normal turns from z to -y
        shift = np.array([0.002, 0.003, 0.01]) if i > len(face) else np.zeros(3)
        end = np.array([x, y, z]) + shift
        moved = np.array([end[0], -end[2], end[1]]) - np.array([x, y, z])
        moves += "".join(f"{i}, {k + 1}, {k + 1}, {moved[k]:.12g}\n" for k in range(3))
    deck += f"*STEP, NLGEOM\n*STATIC, DIRECT\n0.05, 1.\n*BOUNDARY\n{moves}*NODE PRINT, NSET=UP, TOTALS=ONLY\nRF\n*END STEP\n"
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr
    force = area * np.array([600 * 0.002, 600 * 0.003, 1000 * 0.01])
    found = forces(tmp_path)
    assert found[0] == pytest.approx(force, rel=1e-3)  # the middle surface turns a little where the upper face is moved in shear
    assert found[-1] == pytest.approx([found[0][0], -found[0][2], found[0][1]], rel=1e-6)


def test_layer_between_blocks(run_deck: RunDeck, tmp_path: Path) -> None:
    """Two blocks with a layer between them, tied to one of them by a surface of the layer: the stress is that of springs in a row."""
    deck = "*NODE\n" + "".join(f"{n}, {x}, {y}, {z}\n" for n, x, y, z in [
        (i + 1 + 4 * k, *QUAD[i], z) for k, z in enumerate([0.0, 1.0, 1.0, 1.0, 3.0]) for i in range(4)])  # fmt: skip
    deck += "*ELEMENT, TYPE=C3D8, ELSET=BLOCKS\n1, " + ", ".join(str(i) for i in range(1, 9)) + "\n2, " + ", ".join(str(i) for i in range(13, 21)) + "\n"
    deck += "*ELEMENT, TYPE=COH3D8, ELSET=GLUE\n3, " + ", ".join(str(i) for i in range(5, 13)) + "\n"
    deck += "*SURFACE, NAME=LAYER\nGLUE, S2\n*SURFACE, NAME=FACE\n2, S1\n*TIE, NAME=T\nLAYER, FACE\n"
    deck += "*NSET, NSET=LOW, GENERATE\n1, 4\n*NSET, NSET=UP, GENERATE\n17, 20\n*MATERIAL, NAME=STEEL\n*ELASTIC\n1000., 0.\n*SOLID SECTION, ELSET=BLOCKS, MATERIAL=STEEL\n"
    deck += "*MATERIAL, NAME=LAW\n*ELASTIC, TYPE=TRACTION\n2000., 600.\n*COHESIVE SECTION, ELSET=GLUE, MATERIAL=LAW, RESPONSE=TRACTION SEPARATION\n"
    deck += "*STEP\n*STATIC\n*BOUNDARY\nLOW, 1, 3\nUP, 1, 2\nUP, 3, 3, 0.01\n*NODE PRINT, NSET=UP, TOTALS=ONLY\nRF\n*END STEP\n"
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr
    assert forces(tmp_path)[-1, 2] == pytest.approx(2 * 0.01 / (3 / 1000 + 1 / 2000), rel=1e-6)


def cantilevers(n: int, length: float, law: str, opening: float, increments: int, nlgeom: str = "") -> tuple[str, list[int]]:
    """A double cantilever beam of C3D8I, two elements over each arm; the ends move apart by `opening`. The nodes that move up."""
    labels: dict[tuple[int, int, int, int], int] = {}
    for part in (0, 1):
        for k in (0, 1):
            for j in range(3):
                for i in range(n + 1):
                    labels[part, i, j, k] = len(labels) + 1
    text = "*NODE\n" + "".join(f"{label}, {i * length / n}, {(part - 1) * HEIGHT + j * HEIGHT / 2}, {k * WIDTH}\n" for (part, i, j, k), label in labels.items())
    text += "*ELEMENT, TYPE=C3D8I, ELSET=ARMS\n"
    element = 0
    for part in (0, 1):
        for j in (0, 1):
            for i in range(n):
                element += 1
                ring = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                text += f"{element}, " + ", ".join(str(labels[part, a, b, k]) for k in (0, 1) for a, b in ring) + "\n"
    text += "*ELEMENT, TYPE=COH3D8, ELSET=GLUE\n"
    for i in range(round(START / length * n), n):
        element += 1
        ring = [(i, 0), (i, 1), (i + 1, 1), (i + 1, 0)]
        text += f"{element}, " + ", ".join(str(labels[part, a, 2 - 2 * part, k]) for part in (0, 1) for a, k in ring) + "\n"
    upper, lower = ([labels[1, 0, 2, k] for k in (0, 1)], [labels[0, 0, 0, k] for k in (0, 1)])
    end = [labels[part, n, j, k] for part in (0, 1) for j in range(3) for k in (0, 1)]
    for name, members in (("UP", upper), ("LOW", lower), ("END", end)):
        text += f"*NSET, NSET={name}\n" + "".join(f"{m},\n" for m in members)
    text += f"*MATERIAL, NAME=STEEL\n*ELASTIC\n{YOUNG}, 0.\n*SOLID SECTION, ELSET=ARMS, MATERIAL=STEEL\n"
    text += f"*MATERIAL, NAME=LAW\n{law}*COHESIVE SECTION, ELSET=GLUE, MATERIAL=LAW, RESPONSE=TRACTION SEPARATION\n1.\n"
    text += f"*STEP, INC=1000{nlgeom}\n*STATIC\n{1 / increments}, 1., 1e-8, {1 / increments}\n*BOUNDARY\nEND, 1\n{labels[0, n, 0, 0]}, 2, 3\n{labels[0, n, 0, 1]}, 2\n"
    text += f"UP, 2, 2, {opening / 2}\nLOW, 2, 2, {-opening / 2}\n*NODE PRINT, NSET=UP, TOTALS=ONLY\nRF\n*END STEP\n"
    return text, [u - 1 for u in upper]


def curve(job: Job, upper: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """Opening and force."""
    return 2 * job.field("U")[1:, upper[0], 1], job.field("RF")[1:, upper, 1].sum(axis=1)


def test_beam_on_elastic_layer(proof: Proof) -> None:
    """The compliance of two beams that an elastic layer joins."""
    case = proof(
        "cohesive-elastic-layer",
        title="Two beams that an elastic layer of cohesive elements joins",
        model=f"A double cantilever beam, arms {HEIGHT} x {WIDTH} of C3D8I with two elements over the height, E = {YOUNG:g}, nu = 0, a crack of {START:g}, 40 more joined by "
        "COH3D8 without damage; small displacements; 70 and 140 elements along the beam.",
        formula="Each arm is a beam on a Winkler foundation of the stiffness k = 2 K b: C = 2 a^3/(3 E I) (1 + 3/(l a) + 3/(l a)^2 + 3/(2 (l a)^3)), l^4 = k/(4 E I), with the shear "
        "of the free arm, 2 a/(5/6 G A).",
        source="M. F. Kanninen, An augmented double cantilever beam model for studying crack propagation and arrest, Int. J. Fracture 9 (1973) 83-92",
        proves="Stiffness of cohesive elements, points at the nodes.",
    )
    stiffness = 200.0
    inertia = WIDTH * HEIGHT**3 / 12
    root = (2 * stiffness * WIDTH / (4 * YOUNG * inertia)) ** 0.25 * START
    compliance = 2 * START**3 / (3 * YOUNG * inertia) * (1 + 3 / root + 3 / root**2 + 1.5 / root**3) + 2 * START / (5 / 6 * YOUNG / 2 * HEIGHT * WIDTH)
    for n in (70, 140):
        deck, upper = cantilevers(n, 70.0, f"*ELASTIC, TYPE=TRACTION\n{stiffness}, {stiffness}\n", 0.2, 1)
        job = case.run(deck, f"{n} elements", requested=1)
        opening, force = curve(job, upper)
        case.near("compliance", opening[-1] / force[-1], compliance, 0.01 if n == 70 else 0.005, why="elements of a quarter and an eighth of the length over which the layer carries; beam theory without the "
                  "shear of the part on the foundation", place="the ends", time="the end")  # fmt: skip
    case.done()


def test_double_cantilever(proof: Proof) -> None:
    """A crack that grows."""
    case = proof(
        "cohesive-double-cantilever",
        title="Crack growth in a double cantilever beam",
        model=f"The beam of the elastic layer, K = 100000, normal strength 20, fracture energy {ENERGY} with linear softening; its ends open to 5 in 25 increments; 140 and 280 "
        "elements along 70.",
        formula="While the crack grows G = 12 P^2 a^2/(E b^2 h^3) and the opening is 8 P a^3/(E b h^3), a with a constant that both share, hence "
        "P^2 = b^2 (E h^3 Gc/12)/a^2, a^2 = opening/8 (12 E h^3/Gc)^(1/2).",
        source="J. G. Williams, Int. J. Fracture 36 (1988) 101-119 (beam theory of delamination)",
        proves="The work of damage is the fracture energy, however fine the mesh; no failed attempt while the crack runs.",
    )
    law = law_cards("100000., 100000., 100000.", "20., 20., 20.")
    for n, band in ((140, 0.008), (280, 0.003)):
        deck, upper = cantilevers(n, 70.0, law, 5.0, 25)
        job = case.run(deck, f"{n} elements", requested=25)
        opening, force = curve(job, upper)
        crack = np.sqrt(opening / 8 * np.sqrt(12 * YOUNG * HEIGHT**3 / ENERGY))
        expected = WIDTH * np.sqrt(YOUNG * HEIGHT**3 * ENERGY / 12) / crack
        grown = opening > 3.5
        case.near("force", force[grown], expected[grown], band, why="the crack advances node by node: the force waves by the length of an element", place="the ends",
                  time="openings from 3.5 on")  # fmt: skip
        case.within("failed attempts", job.n_failed, (0.0, 0.0), why="each increment converges", place="whole model", time="whole job")
    case.done()


def test_mixed_modes(run_deck: RunDeck, tmp_path: Path) -> None:
    """The upper arm alone is loaded, so that modes mix and the tangent is unsymmetric: few attempts fail, and all work is accounted for."""
    deck, _ = cantilevers(60, 50.0, law_cards("100000., 100000., 100000.", "40., 40., 40.", ", MIXED MODE BEHAVIOR=BK, POWER=2.\n0.281, 0.9, 0.9"), 8.0, 40)
    done = run_deck("\n".join(line for line in deck.splitlines() if not line.startswith("LOW, 2")) + "\n")
    assert done.returncode == 0, done.stdout + done.stderr
    job = Job(tmp_path / "job.vtkhdf", "job")
    good = job.history["is_converged"] > 0
    assert job.n_failed <= 12
    work = job.history["external_work"][good][-1]
    assert job.history["strain_energy"][good][-1] + job.history["plastic_work"][good][-1] == pytest.approx(work, rel=2e-3)


def test_crack_that_jumps(run_deck: RunDeck, tmp_path: Path) -> None:
    """Elements that are long beside the zone of damage: the crack jumps from node to node, and each jump ends in the next equilibrium."""
    deck, _ = cantilevers(100, 50.0, law_cards("100000., 100000., 100000.", "57., 57., 57."), 3.0, 15, ", NLGEOM")
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr
    job = Job(tmp_path / "job.vtkhdf", "job")
    damage = job.integration_points("SDEG")[-1]
    assert (damage > 0.999).sum() >= 40  # the crack has grown by ten elements
    force = forces(tmp_path)[-1, 1]
    crack = np.sqrt(3.0 / 8 * np.sqrt(12 * YOUNG * HEIGHT**3 / ENERGY))
    assert force == pytest.approx(WIDTH * np.sqrt(YOUNG * HEIGHT**3 * ENERGY / 12) / crack, rel=0.1)
